/* The grid planner on the MovingAI maps of --data DIR (each NAME.map with its NAME.scen), on the 20 scenes as uniform
 * grids and on open ground: whether its ways are valid and optimal, how many turning points it saves, what jump points
 * save. Judged by tests/support/grid_oracle.h. Prints figures as JSON; a table on stderr. Exit status 2: bad input,
 * nothing was written. */
#include <argp.h>
#include <dirent.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/error.h"
#include "sim/base/progress.h"
#include "sim/base/random.h"
#include "tests/bench/figures.h"
#include "tests/bench/statistics.h"
#include "tests/support/grid_oracle.h"
#include "tests/support/scene.h"

#define COMMAND "build/bench/bench_grid"

/* Cells, between lengths of one way. */
#define TOLERANCE 1e-3

#define RESOLUTION      JP_Q16(0.2)
#define SCENE_CLEARANCE JP_Q16(0.5)
#define PAPER_FEWER     39 /* %, turning points */

enum {
    METHODS = 3,
    TUBE = 8,
    SLICE = 64,
    TASKS_MAX = 4096,
    TASKS_PER_SCENE = 10,
    OPEN_SIDE = 256,
    OPEN_TASKS = 100,
    TASK_SEED = 1,
    MAPS_MAX = 64,
    GRAPH_CELLS_MAX = 64 * 64 /* the visibility graph of a larger map takes long */
};

struct task {
    struct jp_grid_cell start;
    struct jp_grid_cell goal;
    double optimum; /* to the eight neighbours, cells */
};

/* A map and its tasks. */
struct course {
    char name[128];
    struct jp_terrain terrain;
    struct grid_oracle oracle; /* of cells where the robot fits */
    jp_q16 clearance;
    struct task tasks[TASKS_MAX];
    size_t task_count;
};

/* Sums over tasks. */
struct totals {
    size_t tasks;
    size_t unsolved;
    size_t invalid;
    size_t longer;
    size_t not_optimal;
    double turns[METHODS];
    double length[METHODS]; /* cells */
    double expansions[METHODS];
    double optimum;         /* of those below that have one, by the visibility graph, cells */
    double length_of_those; /* any angle */
    double *fewer;          /* turning points, %, of each task where plain A* has some */
    size_t fewer_count;
};

static json_t *figures;

static void *allocate(size_t size)
{
    void *block = calloc(1, size);
    if (block == NULL) {
        error_line("bench_grid: no memory");
        exit(1);
    }
    return block;
}

/* ---- Courses ---- */

static void create_map(struct course *course, int width, int height)
{
    const struct jp_terrain_config config = {
        .width = (uint16_t)width, .height = (uint16_t)height, .resolution = RESOLUTION};
    const size_t size = jp_terrain_size(&config);
    const char *field = "";
    if (jp_terrain_init(&course->terrain, &config, allocate(size + 1), size, &field) != JP_OK) {
        error_line("%s: %s is out of range: make the map at most %d cells wide and high", course->name, field,
                   JP_TERRAIN_SIDE_MAX);
        exit(ERROR_EXIT);
    }
    course->oracle = (struct grid_oracle){width, height, allocate((size_t)width * (size_t)height * sizeof(bool))};
}

static void free_course(struct course *course)
{
    free(course->terrain.blocked);
    free(course->oracle.blocked);
    free(course);
}

static void put(struct course *course, int x, int y, bool blocked)
{
    course->oracle.blocked[y * course->oracle.width + x] = blocked;
    (void)jp_terrain_set_cell(&course->terrain, x, y, blocked ? JP_CELL_OCCUPIED : JP_CELL_FREE);
}

static void refuse(const char *path, int line, const char *what)
{
    error_line("%s: line %d: %s: expected a file in MovingAI's format", path, line, what);
    exit(ERROR_EXIT);
}

static FILE *open_or_exit(const char *path)
{
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        error_line("%s: cannot be read: give --data a folder in which each NAME.map has its NAME.scen", path);
        exit(ERROR_EXIT);
    }
    return file;
}

/* Rows from the top, as the scenarios count them: a mirrored map has the same ways. */
static void load_map(struct course *course, const char *path)
{
    enum { HEADER_LINES = 4 };
    FILE *file = open_or_exit(path);
    char row[2 * JP_TERRAIN_SIDE_MAX];
    int width = 0;
    int height = 0;
    if (fscanf(file, "type octile height %d width %d map ", &height, &width) != 2 || width < 1 || height < 1) {
        refuse(path, 1, "no header");
    }
    create_map(course, width, height);
    for (int y = 0; y < height; y++) {
        if (fgets(row, sizeof row, file) == NULL || (int)strcspn(row, "\r\n") != width) {
            refuse(path, HEADER_LINES + 1 + y, "not as wide as the header says");
        }
        for (int x = 0; x < width; x++) {
            put(course, x, y, row[x] != '.' && row[x] != 'G');
        }
    }
    (void)fclose(file);
}

static bool is_free(const struct course *course, int x, int y)
{
    return !grid_oracle_is_blocked(&course->oracle, x, y);
}

static void load_tasks(struct course *course, const char *path)
{
    FILE *file = open_or_exit(path);
    char line[512];
    int number = 1;
    if (fgets(line, sizeof line, file) == NULL || strncmp(line, "version 1", strlen("version 1")) != 0) {
        refuse(path, number, "no version 1");
    }
    while (course->task_count < TASKS_MAX && fgets(line, sizeof line, file) != NULL) {
        int start_x;
        int start_y;
        int goal_x;
        int goal_y;
        double optimum;
        number++;
        if (sscanf(line, "%*d %*s %*d %*d %d %d %d %d %lf", &start_x, &start_y, &goal_x, &goal_y, &optimum) != 5) {
            refuse(path, number, "not five numbers after the map");
        }
        if (!is_free(course, start_x, start_y) || !is_free(course, goal_x, goal_y)) {
            refuse(path, number, "start or goal is blocked");
        }
        course->tasks[course->task_count++] =
            (struct task){{(int16_t)start_x, (int16_t)start_y}, {(int16_t)goal_x, (int16_t)goal_y}, optimum};
    }
    (void)fclose(file);
}

static struct course *load_course(const char *directory, const char *name)
{
    struct course *course = allocate(sizeof *course);
    char path[4096];
    (void)snprintf(course->name, sizeof course->name, "%s", name);
    (void)snprintf(path, sizeof path, "%s/%s.map", directory, name);
    load_map(course, path);
    (void)snprintf(path, sizeof path, "%s/%s.scen", directory, name);
    load_tasks(course, path);
    return course;
}

static struct jp_grid_cell draw_cell(const struct course *course, struct random *random)
{
    for (;;) {
        const int x = (int)random_uniform(random, 0, course->oracle.width);
        const int y = (int)random_uniform(random, 0, course->oracle.height);
        if (is_free(course, x, y)) {
            return (struct jp_grid_cell){(int16_t)x, (int16_t)y};
        }
    }
}

/* Tasks that can be solved. */
static void draw_tasks(struct course *course, size_t count, uint64_t seed)
{
    struct random random;
    random_init(&random, seed);
    while (course->task_count < count) {
        struct task task = {draw_cell(course, &random), draw_cell(course, &random), 0};
        task.optimum = grid_oracle_octile(&course->oracle, task.start, task.goal);
        if (isfinite(task.optimum)) {
            course->tasks[course->task_count++] = task;
        }
    }
}

static struct course *open_course(void)
{
    struct course *course = allocate(sizeof *course);
    (void)snprintf(course->name, sizeof course->name, "open, %d x %d cells", OPEN_SIDE, OPEN_SIDE);
    create_map(course, OPEN_SIDE, OPEN_SIDE);
    for (int i = 0; i < OPEN_SIDE * OPEN_SIDE; i++) {
        put(course, i % OPEN_SIDE, i / OPEN_SIDE, false);
    }
    draw_tasks(course, OPEN_TASKS, TASK_SEED);
    return course;
}

/* Nearest to the centre of a cell at the origin. */
static double distance_to_cell(int dx, int dy)
{
    return hypot(fmax(0, abs(dx) - 0.5), fmax(0, abs(dy) - 0.5));
}

static bool fits(const struct jp_terrain *terrain, int x, int y, double radius)
{
    const int reach = (int)radius + 1;
    for (int dy = -reach; dy <= reach; dy++) {
        for (int dx = -reach; dx <= reach; dx++) {
            if (distance_to_cell(dx, dy) < radius && jp_terrain_cell(terrain, x + dx, y + dy) != JP_CELL_FREE) {
                return false;
            }
        }
    }
    return true;
}

static struct course *scene_course(uint32_t seed)
{
    struct course *course = allocate(sizeof *course);
    struct scene_task task;
    const char *field = "";
    (void)snprintf(course->name, sizeof course->name, "scene %u", seed);
    course->clearance = SCENE_CLEARANCE;
    (void)jp_terrain_init(&course->terrain, &scene_terrain_config, allocate(SCENE_TERRAIN_SIZE), SCENE_TERRAIN_SIZE,
                          &field);
    scene_generate(seed, &course->terrain, &task);
    course->oracle = (struct grid_oracle){SCENE_SIDE, SCENE_SIDE, allocate(SCENE_SIDE * SCENE_SIDE * sizeof(bool))};
    for (int i = 0; i < SCENE_SIDE * SCENE_SIDE; i++) {
        course->oracle.blocked[i] = !fits(&course->terrain, i % SCENE_SIDE, i / SCENE_SIDE,
                                          SCENE_CLEARANCE / (double)scene_terrain_config.resolution);
    }
    draw_tasks(course, TASKS_PER_SCENE, seed);
    return course;
}

/* ---- Measuring ---- */

static void create_planner(struct jp_grid_planner *planner, const struct course *course, enum jp_grid_method method)
{
    const struct jp_grid_planner_config config = {.method = method, .clearance = course->clearance, .tube = TUBE};
    const size_t size = jp_grid_planner_size(&config, &course->terrain.config);
    const char *field = "";
    if (jp_grid_planner_init(planner, &config, &course->terrain, allocate(size), size, &field) != JP_OK) {
        error_line("%s: the planner refuses the map: %s is out of range", course->name, field);
        exit(1);
    }
}

static bool solve(struct jp_grid_planner *planner, const struct task *task)
{
    enum jp_grid_answer answer = JP_GRID_NO_TASK;
    if (jp_grid_planner_start(planner, &task->start, &task->goal) == JP_OK) {
        do {
            answer = jp_grid_planner_work(planner, SLICE);
        } while (answer == JP_GRID_SEARCHING);
    }
    return answer == JP_GRID_FOUND;
}

/* A way as the judge sees it. */
struct way {
    double length; /* cells */
    double turns;  /* without start and goal */
    bool is_valid;
};

static bool is_centre(const struct course *course, const struct jp_point *point, struct jp_grid_cell cell)
{
    const double side = course->terrain.config.resolution;
    return fabs(point->x / side - cell.x - 0.5) < TOLERANCE && fabs(point->y / side - cell.y - 0.5) < TOLERANCE;
}

static struct way judge(const struct course *course, const struct task *task, const struct jp_grid_planner *planner)
{
    const double side = course->terrain.config.resolution;
    size_t count = 0;
    const struct jp_point *points = jp_grid_planner_path(planner, &count);
    struct way way = {0, count > 2 ? (double)(count - 2) : 0,
                      is_centre(course, &points[0], task->start) && is_centre(course, &points[count - 1], task->goal)};
    for (size_t i = 1; i < count; i++) {
        const struct jp_point *a = &points[i - 1];
        const struct jp_point *b = &points[i];
        way.length += hypot((b->x - a->x) / side, (b->y - a->y) / side);
        way.is_valid &= grid_oracle_is_line_free(&course->oracle, a->x / side, a->y / side, b->x / side, b->y / side);
    }
    return way;
}

static void measure_task(const struct course *course, const struct task *task, struct jp_grid_planner *planners,
                         const struct grid_graph *graph, struct totals *totals)
{
    struct way ways[METHODS];
    totals->tasks++;
    for (int method = 0; method < METHODS; method++) {
        if (!solve(&planners[method], task)) {
            totals->unsolved++;
            return;
        }
        ways[method] = judge(course, task, &planners[method]);
        totals->invalid += !ways[method].is_valid;
        totals->length[method] += ways[method].length;
        totals->turns[method] += ways[method].turns;
        totals->expansions[method] += jp_grid_planner_statistics(&planners[method])->expansions;
    }
    totals->not_optimal += fabs(ways[JP_GRID_OCTILE].length - task->optimum) > TOLERANCE;
    totals->not_optimal += fabs(ways[JP_GRID_JUMP_POINTS].length - task->optimum) > TOLERANCE;
    totals->longer += ways[JP_GRID_ANY_ANGLE].length > task->optimum + TOLERANCE;
    if (ways[JP_GRID_OCTILE].turns > 0) {
        totals->fewer[totals->fewer_count++] = 100 * (1 - ways[JP_GRID_ANY_ANGLE].turns / ways[JP_GRID_OCTILE].turns);
    }
    if (graph != NULL) {
        totals->optimum += grid_graph_shortest(graph, task->start, task->goal);
        totals->length_of_those += ways[JP_GRID_ANY_ANGLE].length;
    }
}

static void measure(const struct course *course, struct totals *totals)
{
    struct jp_grid_planner planners[METHODS];
    struct grid_graph *graph =
        course->oracle.width * course->oracle.height <= GRAPH_CELLS_MAX ? grid_graph_create(&course->oracle) : NULL;
    totals->fewer = realloc(totals->fewer, (totals->fewer_count + course->task_count) * sizeof *totals->fewer);
    for (int method = 0; method < METHODS; method++) {
        create_planner(&planners[method], course, (enum jp_grid_method)method);
    }
    for (size_t i = 0; i < course->task_count; i++) {
        measure_task(course, &course->tasks[i], planners, graph, totals);
        progress_show(course->name, i + 1, course->task_count);
    }
    progress_end();
    for (int method = 0; method < METHODS; method++) {
        free(planners[method].internal.nodes); /* begins the block */
    }
    if (graph != NULL) {
        grid_graph_free(graph);
    }
}

static void add(struct totals *sum, const struct totals *part)
{
    sum->tasks += part->tasks;
    sum->unsolved += part->unsolved;
    sum->invalid += part->invalid;
    sum->longer += part->longer;
    sum->not_optimal += part->not_optimal;
    for (int method = 0; method < METHODS; method++) {
        sum->turns[method] += part->turns[method];
        sum->length[method] += part->length[method];
        sum->expansions[method] += part->expansions[method];
    }
    sum->optimum += part->optimum;
    sum->length_of_those += part->length_of_those;
    sum->fewer = realloc(sum->fewer, (sum->fewer_count + part->fewer_count + 1) * sizeof *sum->fewer);
    memcpy(&sum->fewer[sum->fewer_count], part->fewer, part->fewer_count * sizeof *sum->fewer);
    sum->fewer_count += part->fewer_count;
}

/* ---- Figures ---- */

static void add_figure(const char *group, const char *what, double value, const char *unit, struct figure_bar bar)
{
    figures_add(figures, COMMAND, value, unit, bar, "grid planner, %s: %s", group, what);
}

static void show_head(void)
{
    (void)fprintf(stderr, "%-26s %6s %8s %8s %8s %9s %9s %11s %11s %7s\n", "map", "tasks", "turns", "any", "fewer %",
                  "octile", "any", "expansions", "jump pts", "factor");
}

static void show(const char *name, struct totals *totals)
{
    (void)fprintf(stderr, "%-26s %6zu %8.0f %8.0f %8.1f %9.1f %9.1f %11.0f %11.0f %7.1f\n", name, totals->tasks,
                  totals->turns[JP_GRID_OCTILE], totals->turns[JP_GRID_ANY_ANGLE],
                  median(totals->fewer, totals->fewer_count), totals->length[JP_GRID_OCTILE],
                  totals->length[JP_GRID_ANY_ANGLE], totals->expansions[JP_GRID_OCTILE],
                  totals->expansions[JP_GRID_JUMP_POINTS],
                  totals->expansions[JP_GRID_OCTILE] / totals->expansions[JP_GRID_JUMP_POINTS]);
}

static void add_factor(const char *name, const struct totals *totals)
{
    add_figure(name, "expansions without jump points against with",
               totals->expansions[JP_GRID_OCTILE] / totals->expansions[JP_GRID_JUMP_POINTS], "×", no_bar);
}

static void add_figures(const char *group, struct totals *totals)
{
    add_figure(group, "tasks not solved", (double)totals->unsolved, "", equal_to(0));
    add_figure(group, "optimum missed, with and without jump points", (double)totals->not_optimal, "", equal_to(0));
    add_figure(group, "ways that are not valid", (double)totals->invalid, "", equal_to(0));
    add_figure(group, "any-angle ways longer than the octile optimum", (double)totals->longer, "", equal_to(0));
    add_figure(group, "turning points, fewer than by 8-neighbour A*, median",
               median(totals->fewer, totals->fewer_count), "%", at_least(PAPER_FEWER));
    add_figure(group, "any-angle ways, shorter than the octile optimum, all together",
               100 * (1 - totals->length[JP_GRID_ANY_ANGLE] / totals->length[JP_GRID_OCTILE]), "%", no_bar);
    if (totals->optimum > 0) {
        add_figure(group, "any-angle ways on maps up to 64 x 64, longer than the shortest of all, all together",
                   100 * (totals->length_of_those / totals->optimum - 1), "%", no_bar);
    }
}

/* ---- Groups ---- */

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Names of the maps in a folder, sorted. */
static size_t find_maps(const char *path, char *names[MAPS_MAX])
{
    DIR *directory = opendir(path);
    const struct dirent *entry;
    size_t count = 0;
    while (directory != NULL && count < MAPS_MAX && (entry = readdir(directory)) != NULL) {
        const char *dot = strrchr(entry->d_name, '.');
        if (dot != NULL && strcmp(dot, ".map") == 0) {
            names[count++] = strndup(entry->d_name, (size_t)(dot - entry->d_name));
        }
    }
    if (directory != NULL) {
        (void)closedir(directory);
    }
    if (count == 0) {
        error_line("%s: no MovingAI maps there: give --data a folder in which each NAME.map has its NAME.scen", path);
        exit(ERROR_EXIT);
    }
    qsort(names, count, sizeof *names, compare_names);
    return count;
}

static void bench_given(const char *directory)
{
    char *names[MAPS_MAX];
    char group[64];
    const size_t count = find_maps(directory, names);
    struct totals all = {0};
    for (size_t i = 0; i < count; i++) {
        struct course *course = load_course(directory, names[i]);
        struct totals totals = {0};
        measure(course, &totals);
        show(course->name, &totals);
        add_factor(course->name, &totals);
        add(&all, &totals);
        free(totals.fewer);
        free_course(course);
        free(names[i]);
    }
    (void)snprintf(group, sizeof group, "%zu MovingAI maps, %zu tasks", count, all.tasks);
    show("all of them", &all);
    add_figures(group, &all);
    free(all.fewer);
}

static void bench_open(void)
{
    struct course *course = open_course();
    struct totals totals = {0};
    measure(course, &totals);
    show(course->name, &totals);
    add_factor(course->name, &totals);
    free(totals.fewer);
    free_course(course);
}

static void bench_scenes(void)
{
    struct totals totals = {0};
    char group[64];
    for (uint32_t i = 0; i < SCENE_BENCH_COUNT; i++) {
        struct course *course = scene_course(SCENE_BENCH_FIRST + i);
        measure(course, &totals);
        free_course(course);
    }
    (void)snprintf(group, sizeof group, "%d scenes, %zu tasks", SCENE_BENCH_COUNT, totals.tasks);
    show("20 scenes", &totals);
    add_figures(group, &totals);
    add_factor("20 scenes", &totals);
    free(totals.fewer);
}

/* ---- Program ---- */

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    if (key != 'd') {
        return ARGP_ERR_UNKNOWN;
    }
    *(const char **)state->input = argument;
    return 0;
}

static const char *parse(int argc, char **argv)
{
    static const struct argp_option options[] = {{"data", 'd', "DIR", 0, "MovingAI maps and their scenarios", 0}, {0}};
    static const struct argp parser = {options, parse_option, NULL, "Measures the grid planner.", NULL, NULL, NULL};
    const char *directory = NULL;
    argp_err_exit_status = ERROR_EXIT;
    (void)argp_parse(&parser, argc, argv, 0, NULL, &directory);
    return directory;
}

int main(int argc, char **argv)
{
    const char *directory = parse(argc, argv);
    figures = json_array();
    show_head();
    if (directory != NULL) {
        bench_given(directory);
    } else {
        error_line("bench_grid: no --data DIR: the rows of the MovingAI maps are left out");
    }
    bench_scenes();
    bench_open();
    figures_print(figures);
    return 0;
}
