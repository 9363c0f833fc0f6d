/* The planner on rough scenes, and on maps that are given: how good its routes are in blocks of several sizes, how fast
 * it is beside a plain Dijkstra, what a replan costs, what energy is saved at what length. Prints figures as JSON;
 * --rows FILE gets every run. Progress on stderr. */
#include <joulepath/tables.h>

#include <argp.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "sim/base/progress.h"
#include "sim/base/random.h"
#include "sim/files/map_file.h"
#include "tests/bench/plain_dijkstra.h"
#include "tests/support/scene.h"

static const struct jp_lattice *const lattice = &jp_lattice_zhang2018;

#define COMMAND "make bench-plan"
#define KIB     ((size_t)1024)

/* The schedule of the example in src/search/README.md. */
#define SCHEDULE                                                                                                       \
    {                                                                                                                  \
        JP_EPSILON(1.35), JP_EPSILON(1.2), JP_EPSILON(1.1), JP_EPSILON_ONE                                             \
    }

enum {
    SLICE = 32, /* expansions */
    AMPLE_KIB = 8192,
    FULL_KIB = 24576, /* holds every search to the optimum */
    REPLANS = 10,     /* a scene */
    AHEAD = 12,       /* primitives from the robot to the change */
    SQUARE_SIDE = 3,  /* cells that change together */
    NEAR_CELLS = 15,
    UNDER_CELLS = 6, /* from the robot's middle to cells that it does not cover */
    REPLAN_SEED = 1,
    MAP_TASKS = 3,
    MAP_SEED = 1,
    ROUNDS = 5, /* of each timing; the median counts */
};

static const unsigned sizes_kib[] = {64, 128, 256, 512, AMPLE_KIB};
enum { SIZES = sizeof sizes_kib / sizeof sizes_kib[0] };

struct task {
    const char *name;
    struct jp_terrain *terrain;
    struct jp_lattice_pose start;
    struct jp_goal goal;
};

/* One plan, from nothing until the planner is idle. */
struct outcome {
    struct jp_plan plan;
    enum jp_answer answer;
    struct jp_planner_counts statistics;
    double first_s; /* to the first route */
    double total_s;
};

static void fail(const char *what)
{
    (void)fprintf(stderr, "bench_plan: %s\n", what);
    exit(1);
}

static void *allocate(size_t size)
{
    void *block = malloc(size);
    if (block == NULL) {
        fail("no memory");
    }
    return block;
}

static double now_s(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int compare(const void *a, const void *b)
{
    const double difference = *(const double *)a - *(const double *)b;
    return (difference > 0) - (difference < 0);
}

static double median(double *values, size_t count)
{
    qsort(values, count, sizeof *values, compare);
    return count % 2 != 0 ? values[count / 2] : (values[count / 2 - 1] + values[count / 2]) / 2;
}

static double least(const double *values, size_t count)
{
    double least_value = values[0];
    for (size_t i = 1; i < count; i++) {
        least_value = fmin(least_value, values[i]);
    }
    return least_value;
}

static double greatest(const double *values, size_t count)
{
    double greatest_value = values[0];
    for (size_t i = 1; i < count; i++) {
        greatest_value = fmax(greatest_value, values[i]);
    }
    return greatest_value;
}

static double mean(const double *values, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        sum += values[i];
    }
    return sum / (double)count;
}

/* ---- Planning ---- */

static void start_planner(struct jp_planner *planner, const struct jp_planner_config *config, const struct task *task,
                          void *block, size_t size)
{
    const char *field = "";
    if (jp_planner_init(planner, config, task->terrain, block, size, &field) != JP_OK ||
        jp_planner_set_start(planner, &task->start) != JP_OK || jp_planner_set_goal(planner, &task->goal) != JP_OK) {
        fail(task->name);
    }
}

static double work_until_idle(struct jp_planner *planner)
{
    const double begin = now_s();
    while (!jp_planner_is_idle(planner)) {
        (void)jp_planner_work(planner, SLICE);
    }
    return now_s() - begin;
}

static struct outcome plan(const struct jp_planner_config *config, const struct task *task, size_t size)
{
    struct jp_planner planner;
    struct outcome outcome = {.first_s = NAN};
    void *block = allocate(size);
    memset(block, 0, size); /* pages are there before the clock runs */
    const double begin = now_s();

    start_planner(&planner, config, task, block, size);
    do {
        outcome.answer = jp_planner_work(&planner, SLICE);
        if (isnan(outcome.first_s) && outcome.answer != JP_ANSWER_OUT_OF_BUDGET) {
            outcome.first_s = now_s() - begin;
        }
    } while (!jp_planner_is_idle(&planner));
    outcome.total_s = now_s() - begin;
    outcome.first_s = isnan(outcome.first_s) ? outcome.total_s : outcome.first_s;
    outcome.plan = *jp_planner_plan(&planner);
    outcome.statistics = *jp_planner_statistics(&planner);
    free(block);
    return outcome;
}

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

/* ---- Figures ---- */

static json_t *figures;

static void add_figure(const char *name, double value, const char *unit, const char *op, double bound)
{
    json_t *limit = op == NULL ? json_null() : json_pack("{s:s, s:f}", "op", op, "value", bound);
    json_t *figure = json_pack("{s:s, s:f, s:s, s:o, s:s}", "name", name, "value", value, "unit", unit, "bound", limit,
                               "command", COMMAND);
    if (figure == NULL || json_array_append_new(figures, figure) != 0) {
        fail("no memory");
    }
}

static void add_size_figure(unsigned kib, const char *what, double value, const char *unit, const char *op,
                            double bound)
{
    char name[128];
    (void)snprintf(name, sizeof name, "planner, 20 scenes in %u KiB: %s", kib, what);
    add_figure(name, value, unit, op, bound);
}

/* ---- Scenes ---- */

struct scene {
    struct task task;
    struct jp_terrain terrain;
    void *block;
    double optimum; /* cost units */
    double dijkstra_s;
};

static void make_scene(struct scene *scene, uint32_t seed)
{
    static char names[SCENE_BENCH_COUNT][16];
    struct scene_task task;
    const char *field = "";
    char *name = names[seed - SCENE_BENCH_FIRST];

    scene->block = allocate(SCENE_TERRAIN_SIZE);
    if (jp_terrain_init(&scene->terrain, &scene_terrain_config, scene->block, SCENE_TERRAIN_SIZE, &field) != JP_OK) {
        fail(field);
    }
    scene_generate(seed, &scene->terrain, &task);
    (void)snprintf(name, sizeof names[0], "scene %u", seed);
    scene->task = (struct task){
        .name = name,
        .terrain = &scene->terrain,
        .start = {(int16_t)task.start.x, (int16_t)task.start.y, task.start.heading},
        .goal = {(int16_t)task.goal.x, (int16_t)task.goal.y, (uint16_t)(1U << task.goal.heading)},
    };
}

/* Both agree but for the rounding of every edge. */
#define DIJKSTRA_TOLERANCE 0.01

static void find_optimum(struct scene *scene)
{
    const struct jp_planner_config config = {lattice, JP_COST_PHYSICAL, {JP_EPSILON_ONE}};
    const struct outcome exact = plan(&config, &scene->task, FULL_KIB * KIB);
    const double begin = now_s();
    const double oracle = plain_dijkstra(lattice, scene->task.terrain, &scene->task.start, &scene->task.goal);

    scene->dijkstra_s = now_s() - begin;
    scene->optimum = exact.plan.cost;
    if (exact.answer != JP_ANSWER_OPTIMAL ||
        fabs(scene->optimum / JP_COST_PER_JOULE / oracle - 1) > DIJKSTRA_TOLERANCE) {
        fail("the plan that is said to be optimal is not Dijkstra's");
    }
}

static void bench_size(const struct scene *scenes, unsigned kib, json_t *rows)
{
    const struct jp_planner_config config = {lattice, JP_COST_PHYSICAL, SCHEDULE};
    double ratio[SCENE_BENCH_COUNT];
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
            ratio[routes++] = outcome.plan.cost / scenes[i].optimum;
        }
        progress_show("blocks", i + 1, SCENE_BENCH_COUNT);
    }
    progress_end();
    const bool is_mcu = kib == 256;
    add_size_figure(kib, "solved", (double)routes, "", is_mcu ? "==" : NULL, SCENE_BENCH_COUNT);
    add_size_figure(kib, "wrong claims", (double)dishonest, "", "==", 0);
    add_size_figure(kib, "bytes a state, all counted", bytes, "B", "<=", 20);
    if (routes > 0) {
        add_size_figure(kib, "cost against the optimum, median", median(ratio, routes), "×", is_mcu ? "<=" : NULL,
                        1.10);
        add_size_figure(kib, "cost against the optimum, worst", greatest(ratio, routes), "×", is_mcu ? "<=" : NULL,
                        1.25);
    }
    if (kib == AMPLE_KIB) {
        add_size_figure(kib, "first route, times faster than plain Dijkstra, median", median(first, SCENE_BENCH_COUNT),
                        "×", ">=", 50);
        add_size_figure(kib, "first route, times faster than plain Dijkstra, least", least(first, SCENE_BENCH_COUNT),
                        "×", NULL, 0);
        add_size_figure(kib, "proved optimum, times faster than plain Dijkstra, median",
                        median(total, SCENE_BENCH_COUNT), "×", ">=", 5);
        add_size_figure(kib, "proved optimum, times faster than plain Dijkstra, least", least(total, SCENE_BENCH_COUNT),
                        "×", NULL, 0);
    }
}

/* ---- Replanning ---- */

static struct jp_lattice_pose pose_after(const struct jp_planner *planner, unsigned steps)
{
    struct jp_lattice_pose pose = jp_planner_plan(planner)->start;
    for (unsigned i = 0; i < steps; i++) {
        (void)jp_planner_step(planner, i, &pose);
    }
    return pose;
}

/* In percent of a fresh search to the proved optimum. */
struct replan {
    double expansions;
    double time;
    double first_expansions; /* until there is a route again */
    double first_time;
};

/* A square of cells becomes occupied, or free where it was not. */
static void change_square(struct jp_planner *planner, const struct jp_terrain *terrain, struct jp_lattice_pose place)
{
    const bool was_free = jp_terrain_cell(terrain, place.x, place.y) == JP_CELL_FREE;

    for (int32_t i = 0; i < SQUARE_SIDE * SQUARE_SIDE; i++) {
        (void)jp_planner_set_cell(planner, place.x + i % SQUARE_SIDE, place.y + i / SQUARE_SIDE,
                                  was_free ? JP_CELL_OCCUPIED : JP_CELL_FREE);
    }
}

/* The robot stands at the start of the planner, which has its route; then something changes. */
static struct replan replan_after_change(struct jp_planner *planner, const struct task *task,
                                         struct jp_lattice_pose place)
{
    static const struct jp_planner_config config = {&jp_lattice_zhang2018, JP_COST_PHYSICAL, {JP_EPSILON_ONE}};
    const uint32_t expanded = jp_planner_statistics(planner)->expansions;
    const double begin = now_s();

    change_square(planner, task->terrain, place);
    while (jp_planner_work(planner, SLICE) == JP_ANSWER_OUT_OF_BUDGET && !jp_planner_is_idle(planner)) {
    }
    const double first_s = now_s() - begin;
    const uint32_t first = jp_planner_statistics(planner)->expansions - expanded;
    (void)work_until_idle(planner);
    const double repaired_s = now_s() - begin;
    const uint32_t repaired = jp_planner_statistics(planner)->expansions - expanded;
    const struct outcome fresh = plan(&config, task, FULL_KIB * KIB);

    if (fresh.plan.cost != jp_planner_plan(planner)->cost || fresh.answer != JP_ANSWER_OPTIMAL) {
        fail("a replan is not what a fresh search finds");
    }
    const double percent = 100 / (double)fresh.statistics.expansions;
    return (struct replan){percent * repaired, 100 * repaired_s / fresh.total_s, percent * first,
                           100 * first_s / fresh.total_s};
}

/* On the route, some primitives ahead of the robot. */
static struct jp_lattice_pose place_on_route(const struct jp_planner *planner, struct random *random)
{
    (void)random;
    return pose_after(planner, AHEAD);
}

/* Anywhere near the robot but under it. */
static struct jp_lattice_pose place_near(const struct jp_planner *planner, struct random *random)
{
    const struct jp_lattice_pose robot = jp_planner_plan(planner)->start;
    struct jp_lattice_pose place;
    double distance = 0;

    do {
        const double x = random_uniform(random, -NEAR_CELLS, NEAR_CELLS);
        const double y = random_uniform(random, -NEAR_CELLS, NEAR_CELLS);
        place = (struct jp_lattice_pose){(int16_t)(robot.x + x), (int16_t)(robot.y + y), 0};
        distance = hypot(x, y);
    } while (distance < UNDER_CELLS || distance > NEAR_CELLS);
    return place;
}

struct replans {
    double expansions[SCENE_BENCH_COUNT * REPLANS];
    double times[SCENE_BENCH_COUNT * REPLANS];
    double first_expansions[SCENE_BENCH_COUNT * REPLANS];
    double first_times[SCENE_BENCH_COUNT * REPLANS];
    size_t count;
};

/* The robot drives a step between changes, for as long as there is a route. */
static void replan_scene(const struct scene *scene, struct replans *replans, struct random *random,
                         struct jp_lattice_pose (*choose)(const struct jp_planner *, struct random *))
{
    const struct jp_planner_config config = {lattice, JP_COST_PHYSICAL, {JP_EPSILON(1.35), JP_EPSILON_ONE}};
    void *block = allocate(FULL_KIB * KIB);
    struct jp_planner planner;

    start_planner(&planner, &config, &scene->task, block, FULL_KIB * KIB);
    (void)work_until_idle(&planner);
    for (unsigned n = 0; n < REPLANS && jp_planner_plan(&planner)->step_count > AHEAD; n++) {
        const struct jp_lattice_pose robot = pose_after(&planner, 1);
        if (jp_planner_set_start(&planner, &robot) != JP_OK) {
            break;
        }
        (void)work_until_idle(&planner);
        const struct task task = {scene->task.name, scene->task.terrain, robot, scene->task.goal};
        const struct replan replan = replan_after_change(&planner, &task, choose(&planner, random));
        replans->expansions[replans->count] = replan.expansions;
        replans->times[replans->count] = replan.time;
        replans->first_expansions[replans->count] = replan.first_expansions;
        replans->first_times[replans->count++] = replan.first_time;
    }
    free(block);
}

static void bench_replans(struct scene *scenes, const char *what, bool has_bar,
                          struct jp_lattice_pose (*choose)(const struct jp_planner *, struct random *))
{
    static struct replans replans;
    struct random random;
    char name[128];

    replans.count = 0;
    random_init(&random, REPLAN_SEED);
    for (unsigned i = 0; i < SCENE_BENCH_COUNT; i++) {
        free(scenes[i].block);
        make_scene(&scenes[i], SCENE_BENCH_FIRST + i);
        replan_scene(&scenes[i], &replans, &random, choose);
        progress_show(what, i + 1, SCENE_BENCH_COUNT);
    }
    progress_end();
    (void)snprintf(name, sizeof name, "planner, %s: expansions against a fresh search, median of %zu", what,
                   replans.count);
    add_figure(name, median(replans.expansions, replans.count), "%", has_bar ? "<=" : NULL, 3);
    (void)snprintf(name, sizeof name, "planner, %s: time against a fresh search, median", what);
    add_figure(name, median(replans.times, replans.count), "%", has_bar ? "<=" : NULL, 5);
    (void)snprintf(name, sizeof name, "planner, %s: expansions against a fresh search, mean", what);
    add_figure(name, mean(replans.expansions, replans.count), "%", NULL, 0);
    (void)snprintf(name, sizeof name, "planner, %s: expansions until there is a route, median", what);
    add_figure(name, median(replans.first_expansions, replans.count), "%", NULL, 0);
    (void)snprintf(name, sizeof name, "planner, %s: time until there is a route, median", what);
    add_figure(name, median(replans.first_times, replans.count), "%", NULL, 0);
}

/* ---- Energy against length ---- */

/* Prices of length on top of the energy, J/m. */
static const double prices[] = {0, 15, 30, 60, 120, 240, 480};
enum { PRICES = sizeof prices / sizeof prices[0] };

struct priced_lattice {
    struct jp_lattice lattice;
    struct jp_primitive *primitives;
};

/* A lattice whose physical cost is the energy and a price for length: distance costs are in millimetres. */
static struct priced_lattice price_length(double price)
{
    const size_t count = lattice->first_from[JP_HEADINGS];
    const double units = price * JP_COST_PER_JOULE / 1000;
    struct priced_lattice priced = {*lattice, allocate(count * sizeof *priced.primitives)};

    memcpy(priced.primitives, lattice->primitives, count * sizeof *priced.primitives);
    for (size_t i = 0; i < count; i++) {
        uint16_t *base = priced.primitives[i].base;
        base[JP_COST_PHYSICAL] = (uint16_t)lrint(base[JP_COST_PHYSICAL] + units * base[JP_COST_DISTANCE]);
    }
    for (unsigned kind = 0; kind < JP_MOVE_KINDS; kind++) {
        struct jp_slope_cost *cost = &priced.lattice.move_costs[JP_COST_PHYSICAL][kind];
        const double length = units * lattice->move_costs[JP_COST_DISTANCE][kind].climb.constant;
        cost->climb.constant += (int32_t)lrint(length);
        cost->descend.constant += (int32_t)lrint(length);
        cost->floor = (uint16_t)(cost->floor + lrint(length / 65536));
    }
    priced.lattice.primitives = priced.primitives;
    return priced;
}

struct route {
    double energy; /* J, physical */
    double length; /* m */
};

static struct route measure(const struct jp_planner_config *config, const struct task *task)
{
    struct jp_planner planner;
    struct route route = {0};
    void *block = allocate(FULL_KIB * KIB);

    start_planner(&planner, config, task, block, FULL_KIB * KIB);
    (void)work_until_idle(&planner);
    struct jp_lattice_pose pose = jp_planner_plan(&planner)->start;
    for (unsigned i = 0; i < jp_planner_plan(&planner)->step_count; i++) {
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *step = jp_planner_step(&planner, i, &pose);
        const struct jp_primitive *own = &lattice->primitives[step - config->lattice->primitives];
        route.energy += jp_lattice_energy(lattice, JP_COST_PHYSICAL, task->terrain, own, from.x, from.y) /
                        (double)JP_COST_PER_JOULE;
        route.length += own->length / 1000.0;
    }
    free(block);
    return route;
}

struct saving {
    double energy; /* %, mean of the scenes */
    double length;
};

static struct saving save_at(const struct scene *scenes, const struct route *shortest, double price)
{
    const struct priced_lattice priced = price_length(price);
    const struct jp_planner_config config = {&priced.lattice, JP_COST_PHYSICAL, {JP_EPSILON(1.35), JP_EPSILON_ONE}};
    double energy[SCENE_BENCH_COUNT];
    double length[SCENE_BENCH_COUNT];

    for (size_t i = 0; i < SCENE_BENCH_COUNT; i++) {
        const struct route route = measure(&config, &scenes[i].task);
        energy[i] = 100 * (1 - route.energy / shortest[i].energy);
        length[i] = 100 * (route.length / shortest[i].length - 1);
    }
    free(priced.primitives);
    return (struct saving){mean(energy, SCENE_BENCH_COUNT), mean(length, SCENE_BENCH_COUNT)};
}

/* On the line between two points of the curve. */
static double energy_at_length(const struct saving *curve, double length)
{
    for (size_t i = 1; i < PRICES; i++) {
        if (curve[i].length <= length && curve[i - 1].length >= length) {
            const double share = (length - curve[i].length) / (curve[i - 1].length - curve[i].length);
            return curve[i].energy + share * (curve[i - 1].energy - curve[i].energy);
        }
    }
    return NAN;
}

#define PAPER_SAVING 16.1 /* % */
#define PAPER_LENGTH 3.7  /* % */

static void bench_savings(const struct scene *scenes, json_t *curve_rows)
{
    const struct jp_planner_config shortest_config = {lattice, JP_COST_DISTANCE, {JP_EPSILON(1.35), JP_EPSILON_ONE}};
    struct route shortest[SCENE_BENCH_COUNT];
    struct saving curve[PRICES];

    for (size_t i = 0; i < SCENE_BENCH_COUNT; i++) {
        shortest[i] = measure(&shortest_config, &scenes[i].task);
    }
    for (size_t i = 0; i < PRICES; i++) {
        curve[i] = save_at(scenes, shortest, prices[i]);
        (void)json_array_append_new(curve_rows,
                                    json_pack("{s:f, s:f, s:f}", "price_j_per_m", prices[i], "saved_percent",
                                              curve[i].energy, "longer_percent", curve[i].length));
        progress_show("energy against length", i + 1, PRICES);
    }
    progress_end();
    add_figure("energy-optimal against distance-optimal routes, 20 scenes: energy saved, mean", curve[0].energy, "%",
               ">=", PAPER_SAVING);
    add_figure("energy-optimal against distance-optimal routes, 20 scenes: longer by, mean", curve[0].length, "%", NULL,
               0);
    add_figure("the same with length priced so that routes are 3.7 % longer: energy saved, mean",
               energy_at_length(curve, PAPER_LENGTH), "%", ">=", PAPER_SAVING);
}

/* ---- Maps that are given ---- */

static bool random_pose(struct random *random, const struct jp_terrain *terrain, struct jp_lattice_pose *pose)
{
    enum { TRIES = 100000 };

    for (unsigned i = 0; i < TRIES; i++) {
        pose->x = (int16_t)random_uniform(random, 0, terrain->config.width);
        pose->y = (int16_t)random_uniform(random, 0, terrain->config.height);
        pose->heading = (uint8_t)random_uniform(random, 0, JP_HEADINGS);
        if (jp_lattice_can_stand(lattice, terrain, pose->x, pose->y, pose->heading)) {
            return true;
        }
    }
    return false;
}

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
        if (!random_pose(&random, &map.terrain, &task.start) || !random_pose(&random, &map.terrain, &goal)) {
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

int main(int argc, char **argv)
{
    static struct scene scenes[SCENE_BENCH_COUNT];
    const struct arguments arguments = parse(argc, argv);
    json_t *rows = json_array();
    json_t *map_rows = json_array();
    json_t *curve = json_array();

    figures = json_array();
    for (unsigned i = 0; i < SCENE_BENCH_COUNT; i++) {
        make_scene(&scenes[i], SCENE_BENCH_FIRST + i);
        find_optimum(&scenes[i]);
        progress_show("plain Dijkstra", i + 1, SCENE_BENCH_COUNT);
    }
    progress_end();
    for (unsigned i = 0; i < SIZES; i++) {
        bench_size(scenes, sizes_kib[i], rows);
    }
    bench_savings(scenes, curve);
    bench_replans(scenes, "replan after a change within 3 m of the robot", true, place_near);
    bench_replans(scenes, "replan after an obstacle appeared on the route", false, place_on_route);
    for (unsigned i = 0; i < arguments.map_count; i++) {
        bench_map(arguments.maps[i], map_rows);
    }
    json_t *all = json_pack("{s:o, s:o, s:o}", "scenes", rows, "curve", curve, "maps", map_rows);
    if (arguments.rows_path != NULL && json_dump_file(all, arguments.rows_path, JSON_INDENT(1)) != 0) {
        fail("cannot write the rows");
    }
    if (json_dumpf(figures, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(10)) != 0) {
        fail("cannot write the figures");
    }
    (void)printf("\n");
    for (unsigned i = 0; i < SCENE_BENCH_COUNT; i++) {
        free(scenes[i].block);
    }
    json_decref(all);
    json_decref(figures);
    return 0;
}
