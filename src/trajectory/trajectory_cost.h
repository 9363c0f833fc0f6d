/** What a leg costs by heading and speed at its ends, with derivatives, in single precision: the energy of
 *  trajectory_energy.h and a price of time, in closed form, but for the way of the blends. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_TRAJECTORY_COST_H
#define JOULEPATH_TRAJECTORY_TRAJECTORY_COST_H

#include <joulepath/trajectory_optimiser.h>
#include <stdbool.h>

#include "src/trajectory/trajectory_blend.h"

/** Of heading and speed at one waypoint. */
#define JP_COST_VARIABLES 2U

/** One end of a leg: the blend between the motion there and the middle. */
struct jp_cost_end {
    float heading;                    /**< from the chord, rad */
    float turn_rate;                  /**< rad/s */
    float speed;                      /**< m/s */
    float duration;                   /**< s */
    const struct jp_rolling *rolling; /**< what modes add; null: nothing */
    bool is_straight;                 /**< in the heading of the middle, whatever it is */
};

struct jp_cost_leg {
    float length; /**< of its chord, m */
    float speed;  /**< of its middle, m/s */
    float rolled; /**< what modes roll after its first blend, m */
    struct jp_cost_end begin;
    struct jp_cost_end end;
};

/** Derivatives by heading and speed at a waypoint; a curvature holds (0,0), (0,1) and (1,1). */
struct jp_leg_cost {
    float cost; /**< J */
    float slope_begin[JP_COST_VARIABLES];
    float slope_end[JP_COST_VARIABLES];
    float curve_begin[3];
    float curve_end[3];
    float coupling[JP_COST_VARIABLES][JP_COST_VARIABLES]; /**< of a variable at the begin and one at the end */
};

/** A second costs so much that `cruise`, m/s, is the best
 * speed. */
void jp_cost_rates_make(struct jp_cost_rates *rates, const struct jp_trajectory_config *config,
                        const struct jp_energy_model *model, const struct jp_back_emf *back_emf, jp_q24 cruise);

/** The cost of a leg whose blends and middle lead to its waypoint. `middle`: the heading of the middle from the chord,
 *  rad, where the search begins and ends. False: there is no room for a middle, or it leads astray; nothing is
 *  written. */
bool jp_leg_cost(const struct jp_cost_rates *rates, const struct jp_cost_leg *leg, float *middle,
                 struct jp_leg_cost *result);

/** What the difference to the first leg's motion at `speed` takes at a start, until it is gone, J. */
float jp_start_cost(const struct jp_cost_rates *rates, const struct jp_trajectory_config *config,
                    const jp_q24 modes[JP_TRAVEL_MODES], jp_q24 speed);

#endif
