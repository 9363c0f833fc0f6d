/*
 * The grid planner against Dijkstra in double precision on random grids: the optimum of all methods, valid any-angle
 * ways that are no longer, proofs that there is none; random sizes, resolutions, clearances, tubes and slices; lines of
 * sight between random points; small queues; changes of the map while it searches. On some maps the any-angle way is
 * compared with the shortest of all.
 *
 * prop_grid_planner [--count N] [--seed S] [--json FILE]
 * --count is the number of maps.
 */
#include <joulepath/grid_planner.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/grid_oracle.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

enum {
    SIDE_MAX = 40,
    WIDE_MAX = 150,
    CELLS_MAX = 6000,
    TASKS = 4,
    LINES = 60,
    GRAPH_EVERY = 8, /* maps */
    WORK_MAX = 1 << 20,
    UNREACHABLE_MAX_PERCENT = 60
};

struct trial {
    struct jp_terrain_config map;
    struct jp_terrain terrain;
    struct jp_grid_planner_config config;
    struct jp_grid_planner planner;
    struct grid_oracle oracle; /* of cells where the robot fits */
    bool blocked[CELLS_MAX];
    uint64_t terrain_block[CELLS_MAX];
    uint64_t block[CELLS_MAX * 4];
};

struct counts {
    unsigned long maps;
    unsigned long tasks;
    unsigned long wrong;
    unsigned long unreachable;
    unsigned long full;
    unsigned long lines;
    double longest_ratio; /* any angle against the shortest of all */
};

static struct options options = {.count = 400, .seed = 1};
static struct trial trial;
static struct counts counts;
static char problem[200]; /* the first that was found */

void setUp(void)
{
    problem[0] = '\0';
}

void tearDown(void)
{
}

static void report(unsigned long number, const char *what, double found, double expected)
{
    counts.wrong++;
    if (problem[0] == '\0') {
        (void)snprintf(problem, sizeof problem, "map %lu (%d x %d, method %d): %s: %.9g, expected %.9g", number,
                       trial.map.width, trial.map.height, (int)trial.config.method, what, found, expected);
    }
}

/* ---- Maps ---- */

static void put(int x, int y, enum jp_cell cell)
{
    (void)jp_terrain_set_cell(&trial.terrain, x, y, cell);
}

static void put_noise(void)
{
    const uint32_t percent = below(45);
    for (int i = 0; i < trial.map.width * trial.map.height; i++) {
        put(i % trial.map.width, i / trial.map.width,
            below(100) >= percent ? JP_CELL_FREE
            : below(4) == 0       ? JP_CELL_UNKNOWN
                                  : JP_CELL_OCCUPIED);
    }
}

/* Rectangles, some of which touch. */
static void put_blocks(void)
{
    for (uint32_t blocks = below(30); blocks > 0; blocks--) {
        const int x = (int)below(trial.map.width);
        const int y = (int)below(trial.map.height);
        const int width = 1 + (int)below(8);
        const int height = 1 + (int)below(8);
        for (int i = 0; i < width * height; i++) {
            put(x + i % width, y + i / width, JP_CELL_OCCUPIED);
        }
    }
}

static void make_map(void)
{
    const char *field = "";
    const bool wide = below(3) == 0;
    trial.map = (struct jp_terrain_config){.width = (uint16_t)(1 + below(wide ? WIDE_MAX : SIDE_MAX)),
                                           .height = (uint16_t)(1 + below(SIDE_MAX)),
                                           .resolution = JP_GRID_RESOLUTION_MIN + (jp_q16)below(JP_Q16(0.4)),
                                           .unknown_is_free = below(2) == 0};
    if (below(4) == 0) {
        trial.map.resolution = JP_Q16(27);
    }
    TEST_ASSERT_EQUAL_INT(
        JP_OK, jp_terrain_init(&trial.terrain, &trial.map, trial.terrain_block, sizeof trial.terrain_block, &field));
    put_noise();
    if (below(2) == 0) {
        for (int i = 0; i < trial.map.width * trial.map.height; i++) {
            put(i % trial.map.width, i / trial.map.width, JP_CELL_FREE);
        }
        put_blocks();
    }
}

/* Nearest to the centre of a cell at the origin, cells. */
static double distance_to_cell(int dx, int dy)
{
    return hypot(fmax(0, abs(dx) - 0.5), fmax(0, abs(dy) - 0.5));
}

static bool is_closed(int x, int y)
{
    const enum jp_cell cell = jp_terrain_cell(&trial.terrain, x, y);
    return cell == JP_CELL_OCCUPIED || (cell == JP_CELL_UNKNOWN && !trial.map.unknown_is_free);
}

static bool fits(int x, int y, double radius)
{
    const int reach = (int)radius + 1;
    for (int dy = -reach; dy <= reach; dy++) {
        for (int dx = -reach; dx <= reach; dx++) {
            const bool is_near = (dx == 0 && dy == 0) || distance_to_cell(dx, dy) < radius;
            if (is_near && is_closed(x + dx, y + dy)) {
                return false;
            }
        }
    }
    return true;
}

/* Clearances in 3/10 of a cell, so that none is at the edge of a disc. */
static void make_oracle(void)
{
    const uint32_t steps = below(3) == 0 ? below(9) : 0;
    trial.config.clearance = (jp_q16)((int64_t)trial.map.resolution * steps * 3 / 10);
    trial.oracle = (struct grid_oracle){trial.map.width, trial.map.height, trial.blocked};
    for (int i = 0; i < trial.map.width * trial.map.height; i++) {
        trial.blocked[i] = !fits(i % trial.map.width, i / trial.map.width, steps * 0.3);
    }
}

static bool draw_cell(struct jp_grid_cell *cell)
{
    for (int tries = 0; tries < 100; tries++) {
        *cell = (struct jp_grid_cell){(int16_t)below(trial.map.width), (int16_t)below(trial.map.height)};
        if (!grid_oracle_is_blocked(&trial.oracle, cell->x, cell->y)) {
            return true;
        }
    }
    return false;
}

/* ---- Checks ---- */

static void start_planner(enum jp_grid_method method, size_t more)
{
    const char *field = "";
    trial.config.method = method;
    const size_t size = jp_grid_planner_size(&trial.config, &trial.map);
    TEST_ASSERT_TRUE(size > 0 && size + more <= sizeof trial.block);
    TEST_ASSERT_EQUAL_INT(
        JP_OK, jp_grid_planner_init(&trial.planner, &trial.config, &trial.terrain, trial.block, size + more, &field));
}

static enum jp_grid_answer finish(void)
{
    const unsigned slice = 1 + below(300);
    enum jp_grid_answer answer = JP_GRID_SEARCHING;
    for (int i = 0; answer == JP_GRID_SEARCHING; i++) {
        TEST_ASSERT_TRUE(i < WORK_MAX);
        answer = jp_grid_planner_work(&trial.planner, slice);
    }
    return answer;
}

/* Length of the way that was found, cells; every line of it is free. */
static double check_way(unsigned long number, struct jp_grid_cell start, struct jp_grid_cell goal)
{
    const double side = trial.map.resolution;
    size_t points = 0;
    const struct jp_point *way = jp_grid_planner_path(&trial.planner, &points);
    double length = 0;
    TEST_ASSERT_TRUE(points > 0);
    const double off = fmax(hypot(way[0].x / side - start.x - 0.5, way[0].y / side - start.y - 0.5),
                            hypot(way[points - 1].x / side - goal.x - 0.5, way[points - 1].y / side - goal.y - 0.5));
    if (off * side > 1) {
        report(number, "start or goal is off by, cells", off, 0);
    }
    for (size_t i = 1; i < points; i++) {
        length += hypot((way[i].x - way[i - 1].x) / side, (way[i].y - way[i - 1].y) / side);
        if (!grid_oracle_is_line_free(&trial.oracle, way[i - 1].x / side, way[i - 1].y / side, way[i].x / side,
                                      way[i].y / side)) {
            report(number, "a line is not free", (double)i, 0);
        }
    }
    return length;
}

/* What rounding of the octile costs and the points may make of a way, cells. */
static double tolerance(double length)
{
    return 1e-5 + 2e-6 * length;
}

/* Start and goal are rounded to steps of 2⁻¹⁶ m, by half of one along x and y each; cells. */
static double rounding_of_ends(void)
{
    return sqrt(2) / trial.map.resolution;
}

static void check_found(unsigned long number, struct jp_grid_cell start, struct jp_grid_cell goal, double optimum,
                        const struct grid_graph *graph)
{
    const double length = check_way(number, start, goal);
    const double octile = jp_grid_planner_statistics(&trial.planner)->octile_length / (double)JP_Q16_ONE;
    if (fabs(octile - optimum) > tolerance(optimum)) {
        report(number, "octile optimum", octile, optimum);
    }
    if (trial.config.method != JP_GRID_ANY_ANGLE) {
        if (fabs(length - optimum) > tolerance(optimum)) {
            report(number, "length of the octile way", length, optimum);
        }
    } else if (length > optimum + tolerance(optimum)) {
        report(number, "any-angle way is longer", length, optimum);
    } else if (graph != NULL) {
        const double shortest = grid_graph_shortest(graph, start, goal);
        if (length < shortest - tolerance(shortest) - rounding_of_ends()) {
            report(number, "any-angle way is shorter than the shortest of all", length, shortest);
        }
        counts.longest_ratio = fmax(counts.longest_ratio, shortest > 0 ? length / shortest : 1);
    }
}

static void check_task(unsigned long number, const struct grid_graph *graph)
{
    struct jp_grid_cell start;
    struct jp_grid_cell goal;
    if (!draw_cell(&start) || !draw_cell(&goal)) {
        return;
    }
    const double optimum = grid_oracle_octile(&trial.oracle, start, goal);
    counts.tasks++;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_planner_start(&trial.planner, &start, &goal));
    const enum jp_grid_answer answer = finish();
    if (answer == JP_GRID_OUT_OF_MEMORY) {
        counts.full++;
        return;
    }
    counts.unreachable += answer == JP_GRID_UNREACHABLE;
    if ((answer == JP_GRID_FOUND) != (bool)isfinite(optimum)) {
        report(number, "answer", answer, isfinite(optimum) ? JP_GRID_FOUND : JP_GRID_UNREACHABLE);
    } else if (answer == JP_GRID_FOUND) {
        (void)check_found(number, start, goal, optimum, graph);
    }
}

/* Points anywhere, often at borders, corners and centres. */
static jp_q16 draw_coordinate(uint16_t cells)
{
    const jp_q16 side = trial.map.resolution;
    switch (below(4)) {
    case 0:
        return (jp_q16)below(cells + 1U) * side;
    case 1:
        return (jp_q16)below(cells) * side + side / 2;
    case 2:
        return (jp_q16)below(cells + 1U) * side + (jp_q16)below(3) - 1;
    default:
        return (jp_q16)below((uint32_t)(cells * side) + 1U);
    }
}

/* The map's unit is far coarser than a touch; what the oracle cannot tell from a touch is left out. */
static bool is_clear_cut(const struct jp_point *a, const struct jp_point *b)
{
    const double length = hypot((double)b->x - a->x, (double)b->y - a->y);
    return length < 1 || 1 / length > 4 * ORACLE_TOUCH * trial.map.resolution;
}

static void check_lines(unsigned long number)
{
    const double side = trial.map.resolution;
    for (int i = 0; i < LINES; i++) {
        const struct jp_point a = {draw_coordinate(trial.map.width), draw_coordinate(trial.map.height)};
        struct jp_point b = {draw_coordinate(trial.map.width), draw_coordinate(trial.map.height)};
        if (below(4) == 0) {
            b.x = a.x;
        } else if (below(4) == 0) {
            b.y = a.y;
        }
        const bool is_free = jp_grid_planner_line_is_free(&trial.planner, &a, &b);
        const bool expected = grid_oracle_is_line_free(&trial.oracle, a.x / side, a.y / side, b.x / side, b.y / side);
        counts.lines++;
        if (is_free != jp_grid_planner_line_is_free(&trial.planner, &b, &a)) {
            report(number, "a line is free only one way", is_free, !is_free);
        }
        if (is_free != expected && is_clear_cut(&a, &b)) {
            report(number, "a line", is_free, expected);
        }
    }
}

static void check_map(unsigned long number)
{
    begin_random(options.seed, number);
    make_map();
    trial.config.tube = (uint8_t)(1 + below(JP_GRID_TUBE_MAX));
    make_oracle();
    counts.maps++;
    struct grid_graph *graph = number % GRAPH_EVERY == 0 ? grid_graph_create(&trial.oracle) : NULL;
    for (enum jp_grid_method method = JP_GRID_OCTILE; method <= JP_GRID_ANY_ANGLE; method++) {
        start_planner(method, sizeof(uint64_t) * below((uint32_t)trial.map.width * trial.map.height));
        if (method == JP_GRID_OCTILE) {
            check_lines(number);
        }
        for (int i = 0; i < TASKS; i++) {
            check_task(number, graph);
        }
    }
    check_lines(number);
    if (graph != NULL) {
        grid_graph_free(graph);
    }
}

static void test_random_maps(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        check_map(i);
    }
    if (counts.wrong > 0) {
        TEST_FAIL_MESSAGE(problem);
    }
    TEST_ASSERT_TRUE(counts.tasks > 6 * counts.maps);
    TEST_ASSERT_TRUE(counts.unreachable * 100 < counts.tasks * UNREACHABLE_MAX_PERCENT);
    TEST_ASSERT_TRUE(counts.unreachable > 0);
    TEST_ASSERT_TRUE(counts.longest_ratio < 1.5);
    TEST_ASSERT_TRUE(counts.full * 50 < counts.tasks);
}

/* A queue of any size, even of one entry: the answer is the right one, or that memory is out. */
static void test_small_queues(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        struct jp_grid_cell start;
        struct jp_grid_cell goal;
        begin_random(options.seed, options.count + i);
        make_map();
        make_oracle();
        trial.config.tube = (uint8_t)(1 + below(8));
        start_planner((enum jp_grid_method)below(3), 0);
        trial.planner.internal.queue_max = 1 + below(trial.planner.internal.queue_max);
        trial.planner.internal.points_max = 2 + below(20);
        if (!draw_cell(&start) || !draw_cell(&goal)) {
            continue;
        }
        const double optimum = grid_oracle_octile(&trial.oracle, start, goal);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_planner_start(&trial.planner, &start, &goal));
        const enum jp_grid_answer answer = finish();
        if (answer == JP_GRID_FOUND) {
            check_found(i, start, goal, optimum, NULL);
        } else if (answer == JP_GRID_UNREACHABLE && isfinite(optimum)) {
            report(i, "a wrong proof", answer, JP_GRID_FOUND);
        }
    }
    if (counts.wrong > 0) {
        TEST_FAIL_MESSAGE(problem);
    }
}

/* A cell changes after any number of slices: stale at once, and right after the task is set again. */
static void test_changes_while_it_searches(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        struct jp_grid_cell start;
        struct jp_grid_cell goal;
        begin_random(options.seed, 2 * options.count + i);
        make_map();
        make_oracle();
        trial.config.tube = (uint8_t)(1 + below(8));
        start_planner((enum jp_grid_method)below(3), 0);
        if (!draw_cell(&start) || !draw_cell(&goal)) {
            continue;
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_planner_start(&trial.planner, &start, &goal));
        const enum jp_grid_answer before = jp_grid_planner_work(&trial.planner, below(400));
        put((int)below(trial.map.width), (int)below(trial.map.height), JP_CELL_FREE);
        const enum jp_grid_answer after = jp_grid_planner_work(&trial.planner, 1);
        TEST_ASSERT_EQUAL_INT(before == JP_GRID_SEARCHING ? JP_GRID_STALE : before, after);
        for (int k = 0; k < trial.map.width * trial.map.height; k++) {
            trial.blocked[k] =
                !fits(k % trial.map.width, k / trial.map.width, trial.config.clearance / (double)trial.map.resolution);
        }
        check_task(i, NULL);
    }
    if (counts.wrong > 0) {
        TEST_FAIL_MESSAGE(problem);
    }
}

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", (double)counts.wrong, "", equal_to(0),
                "grid planner: wrong ways, proofs or lines of sight on random grids, of %lu tasks and %lu lines",
                counts.tasks, counts.lines);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);

    const int failures = RUN_PROPERTY(options, add_figures);

    (void)printf("%lu tasks, %lu unreachable, %lu out of memory, %lu lines, at most %.4f of the shortest\n",
                 counts.tasks, counts.unreachable, counts.full, counts.lines, counts.longest_ratio);
    return failures;
}
