/** Dead reckoning on the plane from wheel angle and yaw. */
#ifndef JOULEPATH_ODOMETRY_H
#define JOULEPATH_ODOMETRY_H

#include <joulepath/estimator.h>
#include <joulepath/segment.h>

#ifdef __cplusplus
extern "C" {
#endif

struct jp_odometry {
    int64_t x;      /**< m, Q32.32 */
    int64_t y;      /**< m, Q32.32 */
    jp_angle wheel; /**< angles at the last tick */
    jp_angle heading;
    jp_q24 metres_per_turn; /**< 2πR */
};

/** Starts at (0, 0); yaw 0 is the heading along x. metres_per_turn is above 0 and at most 4. Constant time. */
void jp_odometry_start(struct jp_odometry *odometry, jp_q24 metres_per_turn, const struct jp_motion_state *state);

/** One tick: the distance rolled, along the mean heading of the tick. Δθ is limited to [−⅛, ⅛) turn. Constant time;
 *  for the ISR. */
void jp_odometry_update(struct jp_odometry *odometry, const struct jp_motion_state *state);

/** Position in m, Q16.16, saturated at ±32 767 m. Constant time. */
struct jp_point jp_odometry_position(const struct jp_odometry *odometry);

#ifdef __cplusplus
}
#endif

#endif
