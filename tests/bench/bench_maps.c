/* The planner on maps and lattices from elsewhere: when routes are published, what is proved, how tight its bounds are,
 * what more memory changes, and what a replan costs beside a search begun anew. A map is drawn with the cells of the
 * lattice, as far as CELLS_MAX allow. Prints figures as JSON; --rows FILE gets every task. Progress on stderr. */
#include <argp.h>
#include <jansson.h>

#include "sim/base/progress.h"
#include "sim/base/random.h"
#include "sim/files/lattice_file.h"
#include "sim/files/map_file.h"
#include "src/search/planner_search.h"
#include "src/search/planner_states.h"
#include "tests/bench/figures.h"
#include "tests/bench/plan_runs.h"
#include "tests/bench/statistics.h"

#undef COMMAND
#define COMMAND "make bench-maps"

enum {
    LATTICES_MAX = 16,
    TASKS_OF_MAP = 3, /* each with the next lattice */
    TRIES = 10,       /* for a task with a route */
    REPLANS = 4,      /* of a task */
    AHEAD = 12,       /* primitives from the robot to an obstacle on its way */
    AHEAD_MIN = 6,
    NEAR_CELLS = 20, /* from the robot to a change that may not be on its way */
    SAMPLES_MAX = 4096,
    CELLS_MAX = 1000000,
    SEED = 1,
};

static const unsigned blocks_kib[] = {64, 128, 256, 512, 1024, 2048, 4096, 8192};
enum { BLOCKS = sizeof blocks_kib / sizeof blocks_kib[0] };

static const struct jp_planner_config schedule = {
    NULL, JP_COST_PHYSICAL, {JP_EPSILON(1.35), JP_EPSILON(1.2), JP_EPSILON(1.1), JP_EPSILON_ONE}};

struct samples {
    double values[SAMPLES_MAX];
    size_t count;
};

/* In percent of a search begun anew. */
struct replans {
    struct samples first_expansions;
    struct samples first_time;
    struct samples expansions;
    struct samples time;
};

static struct {
    size_t tasks;
    size_t late; /* routes published after more than twice the expansions after which they existed */
    size_t proved;
    size_t wrong; /* claims that a proved optimum or a new search contradicts */
    size_t pairs;
    size_t dearer_pairs;
    struct samples bounds_256;
    struct samples bounds_512;
    struct replans on_route;
    struct replans near;
} found;

static void add(struct samples *samples, double value)
{
    if (samples->count == SAMPLES_MAX) {
        fail("too many samples");
    }
    samples->values[samples->count++] = value;
}

/* ---- A search ---- */

/* Work until there is a route, and until the search is done. */
struct effort {
    double first_s;
    double total_s;
    uint32_t first;
    uint32_t total;
    uint32_t existed; /* expansions after which the search had reached the robot; 0: never seen */
};

static bool has_reached_robot(const struct jp_planner_internal *internal)
{
    if (internal->phase != JP_PLANNER_SEARCH || internal->is_splicing || jp_search_is_forward(internal)) {
        return false;
    }
    const uint32_t target = jp_search_target(internal);
    return target != NO_SLOT && internal->search.states[target].g != JP_COST_MAX;
}

static struct effort work_to_end(struct jp_planner *planner, double begin_s, unsigned slice)
{
    const uint32_t before = jp_planner_statistics(planner)->expansions;
    struct effort effort = {.first_s = NAN};

    while (!jp_planner_is_idle(planner)) {
        const enum jp_answer answer = jp_planner_work(planner, isnan(effort.first_s) ? slice : SLICE);
        const uint32_t spent = jp_planner_statistics(planner)->expansions - before;
        if (effort.existed == 0U && has_reached_robot(&planner->internal)) {
            effort.existed = spent;
        }
        if (isnan(effort.first_s) && answer != JP_ANSWER_OUT_OF_BUDGET) {
            effort.first_s = now_s() - begin_s;
            effort.first = spent;
        }
    }
    effort.total_s = now_s() - begin_s;
    effort.total = jp_planner_statistics(planner)->expansions - before;
    if (isnan(effort.first_s)) {
        effort.first_s = effort.total_s;
        effort.first = effort.total;
    }
    return effort;
}

static bool is_route(const struct jp_planner *planner)
{
    const enum jp_answer answer = jp_planner_plan(planner)->answer;
    return answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_WITHIN_BOUND;
}

/* ---- Blocks ---- */

static void note_pair(double smaller, double larger)
{
    if (!isnan(smaller)) {
        found.pairs++;
        found.dearer_pairs += larger > smaller;
    }
}

/* `full` is the plan in the largest block, the truth its cost if that is proved, or NaN. */
static void bench_blocks(const struct jp_planner_config *config, const struct task *task, const struct jp_plan *full)
{
    const double truth = full->answer == JP_ANSWER_OPTIMAL ? full->cost : (double)NAN;
    double smaller = NAN;

    for (unsigned i = 0; i < BLOCKS; i++) {
        if (jp_planner_size(&task->terrain->config) > blocks_kib[i] * KIB) {
            continue;
        }
        const struct outcome outcome = plan(config, task, blocks_kib[i] * KIB);
        if (outcome.answer != JP_ANSWER_OPTIMAL && outcome.answer != JP_ANSWER_WITHIN_BOUND) {
            continue;
        }
        note_pair(smaller, outcome.plan.cost);
        smaller = outcome.plan.cost;
        const double bound = outcome.plan.bound == JP_BOUND_NONE ? INFINITY : outcome.plan.bound / 256.0;
        const double ratio = outcome.plan.cost / truth;
        found.wrong += ratio < 1 || ratio > bound;
        if (!isnan(truth) && blocks_kib[i] == 256) {
            add(&found.bounds_256, bound / ratio);
        }
        if (!isnan(truth) && blocks_kib[i] == 512) {
            add(&found.bounds_512, bound / ratio);
        }
    }
    note_pair(smaller, full->cost);
}

/* ---- Replans ---- */

static void note_replan(struct replans *replans, const struct effort *repair, const struct effort *fresh)
{
    add(&replans->first_expansions, 100.0 * repair->first / fresh->first);
    add(&replans->first_time, 100 * repair->first_s / fresh->first_s);
    add(&replans->expansions, 100.0 * repair->total / fresh->total);
    add(&replans->time, 100 * repair->total_s / fresh->total_s);
}

/* False when the change leaves no task that a new search could be measured on. */
static bool replan(struct jp_planner *planner, const struct task *task, struct jp_lattice_pose place, void *spare,
                   struct replans *replans)
{
    struct jp_planner anew;
    const char *field = "";
    const double begin_s = now_s();

    toggle_square(planner, task->terrain, place);
    const struct effort repair = work_to_end(planner, begin_s, SLICE);
    const double fresh_s = now_s();
    if (jp_planner_init(&anew, &planner->internal.config, task->terrain, spare, FULL_KIB * KIB, &field) != JP_OK ||
        jp_planner_set_start(&anew, &task->start) != JP_OK || jp_planner_set_goal(&anew, &task->goal) != JP_OK) {
        return false;
    }
    const struct effort fresh = work_to_end(&anew, fresh_s, SLICE);
    if (!is_route(&anew) || fresh.first == 0U) {
        return false;
    }
    const bool are_proved =
        jp_planner_plan(&anew)->answer == JP_ANSWER_OPTIMAL && jp_planner_plan(planner)->answer == JP_ANSWER_OPTIMAL;
    found.wrong += are_proved && jp_planner_plan(&anew)->cost != jp_planner_plan(planner)->cost;
    note_replan(replans, &repair, &fresh);
    return true;
}

static struct jp_lattice_pose place_near(struct random *random, const struct jp_lattice_pose *robot)
{
    struct jp_lattice_pose place = *robot;
    place.x = (int16_t)(robot->x + (int32_t)random_uniform(random, -NEAR_CELLS, NEAR_CELLS));
    place.y = (int16_t)(robot->y + (int32_t)random_uniform(random, -NEAR_CELLS, NEAR_CELLS));
    return place;
}

/* The robot drives a step; then cells change, in turn on its way and anywhere near it. */
static void bench_replans(struct jp_planner *planner, struct task task, struct random *random)
{
    void *spare = allocate(FULL_KIB * KIB);

    memset(spare, 0, FULL_KIB * KIB);
    for (unsigned i = 0; i < REPLANS && is_route(planner) && jp_planner_plan(planner)->step_count > AHEAD_MIN; i++) {
        const unsigned steps = jp_planner_plan(planner)->step_count;
        const unsigned ahead = steps > 2 * AHEAD ? AHEAD : AHEAD_MIN;
        const bool is_on_route = i % 2 == 0;
        const struct jp_lattice_pose robot = pose_after(planner, 1);
        const struct jp_lattice_pose place = is_on_route ? pose_after(planner, ahead + 1U) : place_near(random, &robot);
        task.start = robot;
        if (jp_planner_set_start(planner, &robot) != JP_OK) {
            break;
        }
        (void)work_until_idle(planner);
        if (!replan(planner, &task, place, spare, is_on_route ? &found.on_route : &found.near)) {
            break;
        }
    }
    free(spare);
}

/* ---- Tasks ---- */

static json_t *row_of(const struct task *task, const char *lattice_name, enum jp_cost_kind cost,
                      const struct jp_planner *planner, const struct effort *effort)
{
    const struct jp_plan *best = jp_planner_plan(planner);
    return json_pack("{s:s, s:s, s:i, s:i, s:i, s:f, s:f, s:i, s:i, s:i, s:f, s:f}", "map", task->name, "lattice",
                     lattice_name, "cost_kind", (int)cost, "answer", (int)best->answer, "steps", (int)best->step_count,
                     "cost", best->cost / (double)JP_COST_PER_JOULE, "bound", best->bound / 256.0, "existed",
                     (int)effort->existed, "first", (int)effort->first, "total", (int)effort->total, "first_ms",
                     1e3 * effort->first_s, "total_s", effort->total_s);
}

/* False when there is no route, or nothing to drive. */
static bool bench_task(const struct jp_planner_config *config, const char *lattice_name, const struct task *task,
                       struct random *random, json_t *rows)
{
    struct jp_planner planner;
    void *block = allocate(FULL_KIB * KIB);

    memset(block, 0, FULL_KIB * KIB);
    const double begin_s = now_s();
    start_planner(&planner, config, task, block, FULL_KIB * KIB);
    const struct effort effort = work_to_end(&planner, begin_s, 1);
    const bool is_task = is_route(&planner) && jp_planner_plan(&planner)->step_count > 0U;
    if (is_task) {
        const struct jp_plan full = *jp_planner_plan(&planner);
        found.tasks++;
        found.late += effort.existed > 0U && effort.first > 2U * effort.existed;
        found.proved += full.answer == JP_ANSWER_OPTIMAL;
        (void)json_array_append_new(rows, row_of(task, lattice_name, config->cost, &planner, &effort));
        bench_blocks(config, task, &full);
        bench_replans(&planner, *task, random);
    }
    free(block);
    return is_task;
}

/* How many cells of the lattice a cell of the map is wide. */
static int32_t scale_of(const struct jp_terrain_config *map, const struct jp_lattice *of)
{
    const double most = sqrt(CELLS_MAX / ((double)map->width * map->height));
    const double wanted = round((double)map->resolution / of->resolution);

    return (int32_t)fmax(1, fmin(wanted, most));
}

/* The map with the cells of the lattice, in a block of its own. */
static void *draw(struct jp_terrain *drawn, const struct jp_terrain *map, const struct jp_lattice *of)
{
    const int32_t scale = scale_of(&map->config, of);
    struct jp_terrain_config config = map->config;
    const char *field = "";

    config.width = (uint16_t)(config.width * scale);
    config.height = (uint16_t)(config.height * scale);
    config.resolution = of->resolution;
    const size_t size = jp_terrain_size(&config);
    void *block = allocate(size);
    if (jp_terrain_init(drawn, &config, block, size, &field) != JP_OK) {
        fail(field);
    }
    for (int32_t y = 0; y < config.height; y++) {
        for (int32_t x = 0; x < config.width; x++) {
            (void)jp_terrain_set_cell(drawn, x, y, jp_terrain_cell(map, x / scale, y / scale));
            if (config.has_elevation) {
                (void)jp_terrain_set_elevation(drawn, x, y, jp_terrain_elevation(map, x / scale, y / scale));
            }
        }
    }
    return block;
}

static void bench_lattice(const struct map_file *map, const struct lattice_file *file, enum jp_cost_kind cost,
                          struct random *random, json_t *rows)
{
    struct jp_planner_config config = schedule;

    config.lattice = &file->lattice;
    config.cost = cost;
    struct jp_terrain terrain;
    void *block = draw(&terrain, &map->terrain, &file->lattice);
    bool is_done = false;
    for (unsigned i = 0; i < TRIES && !is_done; i++) {
        struct task task = {.name = map->name, .terrain = &terrain};
        struct jp_lattice_pose goal;
        if (!random_pose(random, &file->lattice, &terrain, &task.start) ||
            !random_pose(random, &file->lattice, &terrain, &goal)) {
            break;
        }
        task.goal = (struct jp_goal){goal.x, goal.y, (uint16_t)(1U << goal.heading)};
        is_done = bench_task(&config, file->name, &task, random, rows);
    }
    free(block);
}

/* ---- Figures ---- */

static void add_replan_figures(json_t *figures, const char *what, struct replans *replans)
{
    static const char *const names[] = {"expansions to a route", "time to a route", "expansions to the end",
                                        "time to the end"};
    struct samples *const samples[] = {&replans->first_expansions, &replans->first_time, &replans->expansions,
                                       &replans->time};

    for (unsigned i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (samples[i]->count > 0) {
            figures_add(figures, COMMAND, median(samples[i]->values, samples[i]->count), "%", at_most(15),
                        "planner, maps from elsewhere, %s: %s, of a search begun anew, median", what, names[i]);
            figures_add(figures, COMMAND, greatest(samples[i]->values, samples[i]->count), "%", at_most(110),
                        "planner, maps from elsewhere, %s: %s, of a search begun anew, most", what, names[i]);
        }
    }
}

static void add_bound_figure(json_t *figures, const char *block, struct samples *bounds, double bar)
{
    if (bounds->count > 0) {
        figures_add(figures, COMMAND, median(bounds->values, bounds->count), "×", at_most(bar),
                    "planner, maps from elsewhere, %s: proved bound against the truth, median", block);
    }
}

static void add_figures(json_t *figures)
{
    figures_add(figures, COMMAND, (double)found.late, "", equal_to(0),
                "planner, maps from elsewhere: routes published after more than twice the expansions after which they "
                "existed, of %zu",
                found.tasks);
    figures_add(figures, COMMAND, (double)found.proved, "", equal_to((double)found.tasks),
                "planner, maps from elsewhere, 24 MiB: optimum proved, of %zu", found.tasks);
    figures_add(figures, COMMAND, (double)found.wrong, "", equal_to(0), "planner, maps from elsewhere: wrong claims");
    figures_add(figures, COMMAND, (double)found.dearer_pairs, "", equal_to(0),
                "planner, maps from elsewhere: more memory gave a dearer route, of %zu pairs of blocks", found.pairs);
    add_bound_figure(figures, "256 KiB", &found.bounds_256, 1.2);
    add_bound_figure(figures, "512 KiB", &found.bounds_512, 1.1);
    add_replan_figures(figures, "obstacle on the way", &found.on_route);
    add_replan_figures(figures, "change near the robot", &found.near);
}

/* ---- Program ---- */

struct arguments {
    const char *rows_path;
    const char *lattices[LATTICES_MAX];
    unsigned lattice_count;
    char **maps;
    unsigned map_count;
};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;
    switch (key) {
    case 'r':
        arguments->rows_path = argument;
        return 0;
    case 'l':
        if (arguments->lattice_count == LATTICES_MAX) {
            argp_error(state, "at most %d lattices", LATTICES_MAX);
        }
        arguments->lattices[arguments->lattice_count++] = argument;
        return 0;
    case ARGP_KEY_ARGS:
        arguments->maps = state->argv + state->next;
        arguments->map_count = (unsigned)(state->argc - state->next);
        return 0;
    case ARGP_KEY_END:
        if (arguments->lattice_count == 0 || arguments->map_count == 0) {
            argp_error(state, "needs maps and lattices");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static struct arguments parse(int argc, char **argv)
{
    static const struct argp_option options[] = {
        {"rows", 'r', "FILE", 0, "write every task to FILE", 0},
        {"lattice", 'l', "FILE", 0, "lattice of tools/design/lattice.py --json; may be repeated", 0},
        {0}};
    static const struct argp parser = {options, parse_option, "MAP.json…", "Measures the planner on maps and lattices.",
                                       NULL,    NULL,         NULL};
    struct arguments arguments = {0};
    (void)argp_parse(&parser, argc, argv, 0, NULL, &arguments);
    return arguments;
}

static void bench_map(const char *path, unsigned index, const struct arguments *arguments, json_t *rows)
{
    struct random random;

    for (unsigned i = 0; i < TASKS_OF_MAP; i++) {
        const unsigned task = index * TASKS_OF_MAP + i;
        struct map_file map;
        struct lattice_file file;
        if (!map_file_load(path, &map) ||
            !lattice_file_load(arguments->lattices[task % arguments->lattice_count], &file)) {
            exit(2);
        }
        random_init(&random, SEED + task);
        bench_lattice(&map, &file, task % 2 == 0 ? JP_COST_PHYSICAL : JP_COST_DISTANCE, &random, rows);
        progress_show("maps", task + 1, arguments->map_count * TASKS_OF_MAP);
        lattice_file_free(&file);
        map_file_free(&map);
    }
}

int main(int argc, char **argv)
{
    const struct arguments arguments = parse(argc, argv);
    json_t *figures = json_array();
    json_t *rows = json_array();

    for (unsigned i = 0; i < arguments.map_count; i++) {
        bench_map(arguments.maps[i], i, &arguments, rows);
    }
    progress_end();
    add_figures(figures);
    figures_write_rows(rows, arguments.rows_path);
    figures_print(figures);
    return 0;
}
