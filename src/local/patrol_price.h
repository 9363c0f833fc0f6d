/** What the patrol's ways to turn and to get to a near goal cost: their energy, and the price of their time. Private to
 *  the patrol. Angles are 0 or more, rad; costs J. */
#ifndef JOULEPATH_LOCAL_PATROL_PRICE_H
#define JOULEPATH_LOCAL_PATROL_PRICE_H

#include <joulepath/patrol.h>

/** By which each wheel is steered for a turn in place, rad. */
float jp_patrol_in_place(const struct jp_patrol_config *config);

/** Time of a turn in place, from stand to stand, s. */
float jp_patrol_turn_seconds(const struct jp_patrol_config *config, float angle);

/** A turn in place, with the wheels steered to it from straight on; 0 for none. */
float jp_patrol_turn_price(const struct jp_patrol_config *config, float angle);

/** Steering at a stand to a way that is askew by an angle: from straight on, or after a turn in place. */
float jp_patrol_steering_price(const struct jp_patrol_config *config, float askew, bool has_turned);

/** A way along which the robot turns in place, drives on straight, and stops: from stand to stand, by its length, m. */
float jp_patrol_straight_price(const struct jp_patrol_config *config, float angle, float length);

/** A step of a length, m, in a direction from the heading. */
float jp_patrol_step_price(const struct jp_patrol_config *config, float direction, float length);

/** A goal that is straight ahead of nothing but floor: angles as above. */
struct jp_patrol_near_goal {
    float away;  /**< m */
    float first; /**< from the heading to the way */
    float then;  /**< from the way to the goal's heading; 0: any will do */
    float error; /**< from the heading to the goal's; 0: any will do */
};

/** Of the ways there: a step, which keeps the heading, or a turn, a straight way and what is to be turned then. */
bool jp_patrol_is_step_cheapest(const struct jp_patrol_config *config, const struct jp_patrol_near_goal *goal);

#endif
