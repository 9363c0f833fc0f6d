/**
 * Primitives of a state lattice while they are made. Lengths are in cells of the map, positions relative to the centre
 * of the start cell; cell (i, j) covers [i − ½, i + ½] × [j − ½, j + ½].
 */
#ifndef JOULEPATH_SIM_LATTICE_LATTICE_PRIMITIVE_H
#define JOULEPATH_SIM_LATTICE_LATTICE_PRIMITIVE_H

#include <joulepath/lattice.h>

#include "sim/lattice/lattice_robot.h"

#define LATTICE_PI 3.14159265358979323846

/** Farthest cell of any set from its origin: what struct jp_span holds. */
#define LATTICE_REACH 127
#define LATTICE_SIDE  (2 * LATTICE_REACH + 1)

#define LATTICE_POSES_MAX 2048
#define LATTICE_MOVES_MAX 255

struct lattice_pose {
    double x;
    double y;
    double heading; /**< rad, not wrapped along a curve */
};

/** The poses of a primitive, close enough that straight lines and even turns join them. */
struct lattice_path {
    struct lattice_pose poses[LATTICE_POSES_MAX];
    size_t count;
};

/** A set of cells round an origin. */
struct lattice_cells {
    bool at[LATTICE_SIDE][LATTICE_SIDE]; /**< [y + LATTICE_REACH][x + LATTICE_REACH] */
};

struct lattice_primitive {
    int dx;
    int dy;
    unsigned start; /**< heading */
    unsigned end;
    struct lattice_path path;
    double factor; /**< of its costs, at least 1 */
    double length_m;
    double duration_s;
    double cost[JP_COST_KINDS]; /**< on level ground, cost units */
    unsigned base[JP_COST_KINDS];
    uint8_t moves[LATTICE_MOVES_MAX];
    size_t move_count;
    struct lattice_cells *swept;
};

/** A lattice for one robot. */
struct lattice {
    const struct lattice_robot *robot;
    double resolution_m;
    double headings[JP_HEADINGS]; /**< rad */
    struct lattice_primitive *primitives;
    size_t count;
    bool counts_rounding; /**< bases make up for what the steps lose by rounding, much over long ways on small cells */
    struct jp_slope_cost move_costs[JP_COST_KINDS][JP_MOVE_KINDS];
    double ratio[JP_COST_KINDS]; /**< of the moves' level costs to those of driving straight, at most 1 */
    struct lattice_cells *footprint[JP_HEADINGS];
    struct lattice_cells *reach[JP_HEADINGS];
    struct lattice_cells *core;
};

static inline bool lattice_has_cell(const struct lattice_cells *cells, int x, int y)
{
    return x >= -LATTICE_REACH && x <= LATTICE_REACH && y >= -LATTICE_REACH && y <= LATTICE_REACH &&
           cells->at[y + LATTICE_REACH][x + LATTICE_REACH];
}

/** Direction of a unit step, rad. */
double lattice_direction_angle(unsigned direction);

#endif
