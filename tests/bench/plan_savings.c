#include "tests/bench/plan_savings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/progress.h"
#include "tests/bench/figures.h"
#include "tests/bench/statistics.h"

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

void plan_savings(const struct scene *scenes, json_t *figures, json_t *curve_rows)
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
    figures_add(figures, COMMAND, curve[0].energy, "%", at_least(PAPER_SAVING),
                "energy-optimal against distance-optimal routes, 20 scenes: energy saved, mean");
    figures_add(figures, COMMAND, curve[0].length, "%", no_bar,
                "energy-optimal against distance-optimal routes, 20 scenes: longer by, mean");
    figures_add(figures, COMMAND, energy_at_length(curve, PAPER_LENGTH), "%", at_least(PAPER_SAVING),
                "the same with length priced so that routes are 3.7 %% longer: energy saved, mean");
}
