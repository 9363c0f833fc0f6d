#include "tests/bench/plan_savings.h"

#include <math.h>
#include <stdlib.h>

#include "sim/base/progress.h"
#include "tests/bench/figures.h"
#include "tests/bench/priced_lattice.h"
#include "tests/bench/statistics.h"

static struct route measure(const struct jp_planner_config *config, const struct task *task)
{
    struct jp_planner planner;
    void *block = allocate(FULL_KIB * KIB);

    start_planner(&planner, config, task, block, FULL_KIB * KIB);
    (void)work_until_idle(&planner);
    const struct route route = route_of(&planner);
    free(block);
    return route;
}

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
