/* The planner on rough scenes, and on maps that are given: how good its routes are in blocks of several sizes, how fast
 * it is beside its peers, what a replan costs, what energy is saved at what length. Prints figures as JSON;
 * --rows FILE gets every run. Progress on stderr. */
#include <argp.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>

#include "sim/base/progress.h"
#include "sim/base/random.h"
#include "sim/files/map_file.h"
#include "tests/bench/figures.h"
#include "tests/bench/plain_search.h"
#include "tests/bench/plan_peers.h"
#include "tests/bench/plan_replans.h"
#include "tests/bench/plan_runs.h"
#include "tests/bench/plan_savings.h"
#include "tests/bench/statistics.h"

enum {
    AMPLE_KIB = 8192,
    MAP_TASKS = 3,
    MAP_SEED = 1,
};

static const unsigned sizes_kib[] = {64, 128, 256, 512, AMPLE_KIB};
enum { SIZES = sizeof sizes_kib / sizeof sizes_kib[0] };

static const char *answer_name(enum jp_answer answer)
{
    static const char *const names[] = {"out of budget", "optimal", "within bound", "partial", "unreachable", "stale"};
    return names[answer];
}

static bool is_route(enum jp_answer answer)
{
    return answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_WITHIN_BOUND;
}

static bool is_honest(const struct outcome *outcome, double optimum)
{
    const double ratio = outcome->plan.cost / optimum;
    return isnan(optimum) || outcome->answer == JP_ANSWER_PARTIAL ||
           (is_route(outcome->answer) && ratio >= 1 &&
            (ratio <= outcome->plan.bound / (double)JP_EPSILON_ONE || outcome->plan.bound == JP_BOUND_NONE));
}

/* An unknown optimum is NaN. */
static json_t *json_known(double value)
{
    return isnan(value) ? json_null() : json_real(value);
}

static void add_row(json_t *rows, const struct task *task, unsigned kib, const struct outcome *outcome, double optimum)
{
    const struct jp_planner_counts *statistics = &outcome->statistics;
    const struct jp_terrain_config *map = &task->terrain->config;
    json_t *row =
        json_pack("{s:s, s:i, s:i, s:i, s:s, s:f, s:f, s:o, s:o, s:f, s:i, s:i, s:i, s:f, s:f, s:b}", "map", task->name,
                  "width", (int)map->width, "height", (int)map->height, "block_kib", (int)kib, "answer",
                  answer_name(outcome->answer), "cost_j", outcome->plan.cost / (double)JP_COST_PER_JOULE, "left_j",
                  outcome->plan.cost_left / (double)JP_COST_PER_JOULE, "optimum_j",
                  json_known(optimum / JP_COST_PER_JOULE), "ratio", json_known(outcome->plan.cost / optimum), "bound",
                  outcome->plan.bound / (double)JP_EPSILON_ONE, "states", (int)statistics->states, "states_max",
                  (int)statistics->states_max, "expansions", (int)statistics->expansions, "first_ms",
                  1e3 * outcome->first_s, "total_ms", 1e3 * outcome->total_s, "honest", is_honest(outcome, optimum));
    if (row == NULL || json_array_append_new(rows, row) != 0) {
        fail("no memory");
    }
}

/* ---- Scenes ---- */

static void find_optimum(struct scene *scene)
{
    const struct jp_planner_config config = {lattice, JP_COST_PHYSICAL, {JP_EPSILON_ONE}};
    const struct outcome exact = plan(&config, &scene->task, FULL_KIB * KIB);
    const double begin = now_s();
    const double oracle = plain_dijkstra(lattice, scene->task.terrain, &scene->task.start, &scene->task.goal);

    scene->dijkstra_s = now_s() - begin;
    scene->optimum = exact.plan.cost;
    if (exact.answer != JP_ANSWER_OPTIMAL || fabs(scene->optimum / oracle - 1) > ROUNDING_TOLERANCE) {
        fail("the plan that is said to be optimal is not Dijkstra's");
    }
}

static void add_size_figure(json_t *figures, unsigned kib, const char *what, double value, const char *unit,
                            struct figure_bar bar)
{
    figures_add(figures, COMMAND, value, unit, bar, "planner, 20 scenes in %u KiB: %s", kib, what);
}

static void add_speed_figures(json_t *figures, unsigned kib, double *first, double *total)
{
    add_size_figure(figures, kib, "first route, times faster than plain Dijkstra, median",
                    median(first, SCENE_BENCH_COUNT), "×", at_least(50));
    add_size_figure(figures, kib, "first route, times faster than plain Dijkstra, least",
                    least(first, SCENE_BENCH_COUNT), "×", no_bar);
    add_size_figure(figures, kib, "proved optimum, times faster than plain Dijkstra, median",
                    median(total, SCENE_BENCH_COUNT), "×", at_least(5));
    add_size_figure(figures, kib, "proved optimum, times faster than plain Dijkstra, least",
                    least(total, SCENE_BENCH_COUNT), "×", no_bar);
}

static void bench_size(const struct scene *scenes, unsigned kib, json_t *figures, json_t *rows)
{
    const struct jp_planner_config config = {lattice, JP_COST_PHYSICAL, SCHEDULE};
    const bool is_mcu = kib == 256;
    double ratio[SCENE_BENCH_COUNT];
    double slack[SCENE_BENCH_COUNT];
    double first[SCENE_BENCH_COUNT];
    double total[SCENE_BENCH_COUNT];
    double bytes = 0;
    size_t routes = 0;
    size_t dishonest = 0;

    for (size_t i = 0; i < SCENE_BENCH_COUNT; i++) {
        const struct outcome outcome = plan(&config, &scenes[i].task, kib * KIB);
        add_row(rows, &scenes[i].task, kib, &outcome, scenes[i].optimum);
        first[i] = scenes[i].dijkstra_s / outcome.first_s;
        total[i] = scenes[i].dijkstra_s / outcome.total_s;
        dishonest += !is_honest(&outcome, scenes[i].optimum);
        bytes = (double)outcome.statistics.search_bytes / outcome.statistics.states_max;
        if (is_route(outcome.answer)) {
            ratio[routes] = outcome.plan.cost / scenes[i].optimum;
            slack[routes] = outcome.plan.bound / (double)JP_EPSILON_ONE / ratio[routes];
            routes++;
        }
        progress_show("blocks", i + 1, SCENE_BENCH_COUNT);
    }
    progress_end();
    add_size_figure(figures, kib, "solved", (double)routes, "", is_mcu ? equal_to(SCENE_BENCH_COUNT) : no_bar);
    add_size_figure(figures, kib, "wrong claims", (double)dishonest, "", equal_to(0));
    add_size_figure(figures, kib, "bytes a state, all counted", bytes, "B", at_most(18));
    if (routes > 0) {
        add_size_figure(figures, kib, "cost against the optimum, median", median(ratio, routes), "×",
                        is_mcu ? at_most(1.10) : no_bar);
        add_size_figure(figures, kib, "cost against the optimum, worst", greatest(ratio, routes), "×",
                        is_mcu ? at_most(1.25) : no_bar);
        add_size_figure(figures, kib, "proved bound against the truth, median", median(slack, routes), "×",
                        is_mcu       ? at_most(1.2)
                        : kib == 512 ? at_most(1.1)
                                     : no_bar);
    }
    if (kib == AMPLE_KIB) {
        add_speed_figures(figures, kib, first, total);
    }
}

/* ---- Maps that are given ---- */

static void bench_task(const struct task *task, json_t *rows)
{
    const struct jp_planner_config exact = {lattice, JP_COST_PHYSICAL, {JP_EPSILON(1.35), JP_EPSILON_ONE}};
    const struct jp_planner_config config = {lattice, JP_COST_PHYSICAL, SCHEDULE};
    const struct outcome best = plan(&exact, task, 4 * FULL_KIB * KIB);

    for (unsigned i = 0; i < SIZES; i++) {
        if (jp_planner_size(&task->terrain->config) <= sizes_kib[i] * KIB) {
            const struct outcome outcome = plan(&config, task, sizes_kib[i] * KIB);
            add_row(rows, task, sizes_kib[i], &outcome,
                    best.answer == JP_ANSWER_OPTIMAL ? (double)best.plan.cost : (double)NAN);
        }
    }
}

static void bench_map(const char *path, json_t *rows)
{
    struct map_file map;
    struct random random;

    if (!map_file_load(path, &map)) {
        exit(1);
    }
    random_init(&random, MAP_SEED);
    for (unsigned i = 0; i < MAP_TASKS; i++) {
        struct task task = {.name = map.name, .terrain = &map.terrain};
        struct jp_lattice_pose goal;
        if (!random_pose(&random, lattice, &map.terrain, &task.start) ||
            !random_pose(&random, lattice, &map.terrain, &goal)) {
            break;
        }
        task.goal = (struct jp_goal){goal.x, goal.y, JP_ANY_HEADING};
        bench_task(&task, rows);
        progress_show(map.name, i + 1, MAP_TASKS);
    }
    progress_end();
    map_file_free(&map);
}

/* ---- Program ---- */

struct arguments {
    const char *rows_path;
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
    case ARGP_KEY_ARGS:
        arguments->maps = state->argv + state->next;
        arguments->map_count = (unsigned)(state->argc - state->next);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static struct arguments parse(int argc, char **argv)
{
    static const struct argp_option options[] = {{"rows", 'r', "FILE", 0, "write every run to FILE", 0}, {0}};
    static const struct argp parser = {options, parse_option, "[MAP.json…]", "Measures the planner.", NULL, NULL, NULL};
    struct arguments arguments = {0};
    (void)argp_parse(&parser, argc, argv, 0, NULL, &arguments);
    return arguments;
}

/* A map of 15 x 15 cells, level and free but for a corner, in blocks of any size: the time must be the search's, not
 * the block's. */
static void bench_small_map(json_t *figures)
{
    enum { SIDE = 15, SMALLEST_KIB = 16, TIMES = 20 };
    static const struct jp_planner_config config = {&jp_lattice_zhang2018, JP_COST_PHYSICAL, SCHEDULE};
    const struct jp_terrain_config level = {.width = SIDE, .height = SIDE, .resolution = JP_Q16(0.2)};
    static uint64_t memory[SIDE];
    struct jp_terrain terrain;
    const char *field = "";
    double most_s = 0;

    if (jp_terrain_init(&terrain, &level, memory, sizeof memory, &field) != JP_OK) {
        fail(field);
    }
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        (void)jp_terrain_set_cell(&terrain, i % SIDE, i / SIDE, i == 0 ? JP_CELL_OCCUPIED : JP_CELL_FREE);
    }
    const struct task task = {"small", &terrain, {4, 4, 0}, {10, 10, 1U << 8U}};
    for (size_t kib = SMALLEST_KIB; kib <= FULL_KIB; kib *= 2) {
        double least_s = INFINITY;
        for (unsigned i = 0; i < TIMES; i++) {
            least_s = fmin(least_s, plan(&config, &task, kib * KIB).total_s);
        }
        most_s = fmax(most_s, least_s);
    }
    figures_add(figures, COMMAND, 1e3 * most_s, "ms", at_most(0.2),
                "planner, map of 15 x 15 cells in blocks of 16 KiB to 16 MiB: time to the proved optimum, most");
}

int main(int argc, char **argv)
{
    static struct scene scenes[SCENE_BENCH_COUNT];
    const struct arguments arguments = parse(argc, argv);
    json_t *figures = json_array();
    json_t *rows = json_array();
    json_t *map_rows = json_array();
    json_t *curve = json_array();

    for (unsigned i = 0; i < SCENE_BENCH_COUNT; i++) {
        make_scene(&scenes[i], SCENE_BENCH_FIRST + i);
        find_optimum(&scenes[i]);
        progress_show("plain Dijkstra", i + 1, SCENE_BENCH_COUNT);
    }
    progress_end();
    for (unsigned i = 0; i < SIZES; i++) {
        bench_size(scenes, sizes_kib[i], figures, rows);
    }
    plan_peers(scenes, figures);
    plan_savings(scenes, figures, curve);
    plan_replans(scenes, figures);
    bench_small_map(figures);
    for (unsigned i = 0; i < arguments.map_count; i++) {
        bench_map(arguments.maps[i], map_rows);
    }
    figures_write_rows(json_pack("{s:o, s:o, s:o}", "scenes", rows, "curve", curve, "maps", map_rows),
                       arguments.rows_path);
    figures_print(figures);
    for (unsigned i = 0; i < SCENE_BENCH_COUNT; i++) {
        free(scenes[i].block);
    }
    return 0;
}
