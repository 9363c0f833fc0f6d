/**
 * What a metre costs on a grid (grid_planner.h), in joules and in what is priced like them: time that is saved, and
 * clearance.
 *
 *   metre + slope(grade) + near(ring)      J for each metre of a path; and `rise` for each metre that it climbs in all
 *
 * What climbing costs and descending gives back depends on the ends of a path alone, but for what is lost on the way:
 * windings by the square of the grade, and what motors that brake do not give back. So the energy by grade is taken
 * apart: f(g) = f(0) + rise g + slope(g), with `rise` its derivative on level ground. f is convex, so no slope is below
 * 0, and the least price of a metre is that of level ground: what the planner's heuristic needs.
 *
 * Rings lie around the ground on which the robot does not fit, the first beside it; what is farther away than the last
 * one costs nothing more.
 */
#ifndef JOULEPATH_GRID_PRICES_H
#define JOULEPATH_GRID_PRICES_H

#include <joulepath/four_wheel_energy.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_GRID_RINGS 7U

/** Grades for which slopes are given: −½…½, 1/32 apart; steeper ground costs as these do, between them it is linear. */
#define JP_GRID_GRADES 33U

/** Largest part of a metre's price, in `metre`: what costs more counts as this. */
#define JP_GRID_PART_MAX 31

struct jp_grid_prices {
    jp_q16 metre;                 /**< on level ground, far from things, J; above 0 */
    jp_q16 rise;                  /**< of a metre upwards, J */
    jp_q16 slope[JP_GRID_GRADES]; /**< J; 0 or more */
    jp_q16 ring;                  /**< width of a ring, m; above 0 */
    jp_q16 near[JP_GRID_RINGS];   /**< in a ring, J; 0 or more */
};

/**
 * What a metre takes a robot with four steered wheels at a steady speed, with nothing near: its energy and the price of
 * its time, by what a second less is worth beyond its energy, W, 0…1 024. The model must have passed its check.
 * JP_ERR_ARGUMENT: a null pointer, a value out of its range, or a speed outside 1/256…8 m/s; *prices is not written.
 * JP_ERR_OVERFLOW: a metre takes 16 384 J or more; likewise. A rise beyond ±32 767 J is saturated. Work: JP_GRID_GRADES
 * times jp_four_wheel_energy_metre().
 */
enum jp_status jp_grid_prices_set(const struct jp_four_wheel_energy_model *model, jp_q24 speed, jp_q16 second,
                                  struct jp_grid_prices *prices);

#ifdef __cplusplus
}
#endif

#endif
