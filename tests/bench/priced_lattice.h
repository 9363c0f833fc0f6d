/** Prices of length on top of the energy: the trade-off between the two. */
#ifndef JOULEPATH_TESTS_BENCH_PRICED_LATTICE_H
#define JOULEPATH_TESTS_BENCH_PRICED_LATTICE_H

#include "tests/bench/plan_runs.h"

/** J/m. */
static const double prices[] = {0, 15, 30, 60, 120, 240, 480};
enum { PRICES = sizeof prices / sizeof prices[0] };

struct priced_lattice {
    struct jp_lattice lattice;
    struct jp_primitive *primitives;
};

/** A lattice whose physical cost is the energy and a price for length: distance costs are in millimetres. */
static inline struct priced_lattice price_length(double price)
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

/** What a plan takes by the lattice's own tables. */
struct route {
    double energy; /**< J, physical */
    double length; /**< m */
};

/** Of the plan that a planner has found on a lattice with the same primitives. */
static inline struct route route_of(const struct jp_planner *planner)
{
    const struct jp_plan *plan = jp_planner_plan(planner);
    struct jp_lattice_pose pose = plan->start;
    struct route route = {0, 0};

    for (unsigned i = 0; i < plan->step_count; i++) {
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *step = jp_planner_step(planner, i, &pose);
        const struct jp_primitive *own = &lattice->primitives[step - jp_planner_lattice(planner)->primitives];
        route.energy += jp_lattice_energy(lattice, JP_COST_PHYSICAL, jp_planner_terrain(planner), own, from.x, from.y) /
                        (double)JP_COST_PER_JOULE;
        route.length += own->length / 1000.0;
    }
    return route;
}

/** Mean over the scenes, against the distance-optimal routes. */
struct saving {
    double energy; /**< less, % */
    double length; /**< more, % */
};

/** On the line between two points of the curve. */
static inline double energy_at_length(const struct saving *curve, double length)
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

#endif
