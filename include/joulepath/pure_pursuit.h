/**
 * Pure pursuit (Coulter, CMU-RI-TR-92-01): drives forward along the arc that meets the path a lookahead distance ahead.
 *
 *   lookahead L  = lookahead_time × |speed|, within lookahead_min…lookahead_max
 *   curvature κ  = 2 y/L², y the offset to the left of where the path leaves the circle of radius L around the robot;
 *                  |κ| <= curvature_max, which it is when that point lies behind the robot
 *   speed v     <= speed, √(lateral_acceleration/|κ|), what stops at the path's end at `acceleration`, and within
 *                  acceleration × period of the speed now; while v is still too high for κ, κ becomes
 *                  lateral_acceleration/v²
 *
 * Braking for a curve begins one lookahead before it. Where `acceleration` does not suffice for that distance, the
 * robot leaves the path in the curve: such a path needs a lower speed or a longer lookahead.
 *
 * The robot's place on the path is the nearest point within one lookahead from the last place; it never moves back, so
 * a path may cross itself. Beyond its end the path continues along its last chord. A robot farther than L from the path
 * heads for the foot of the perpendicular. Distances along the path are those of its chords.
 *
 * Integers only, the same bits on every core. jp_pure_pursuit_tick() is bounded and may be called from an ISR: it
 * passes at most JP_PURSUIT_STRIDE points and looks at most JP_PURSUIT_AHEAD further; where points stand so close that
 * this is less than the lookahead, the chord reached is extended.
 */
#ifndef JOULEPATH_PURE_PURSUIT_H
#define JOULEPATH_PURE_PURSUIT_H

#include <joulepath/four_wheel.h>
#include <joulepath/point.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_PURSUIT_STRIDE 32
#define JP_PURSUIT_AHEAD  128

struct jp_pure_pursuit_config {
    jp_q24 speed;                /**< m/s; 0.01…16 */
    jp_q24 lookahead_time;       /**< s; 0.05…8 */
    jp_q24 lookahead_min;        /**< m; 0.05…8 */
    jp_q24 lookahead_max;        /**< m; lookahead_min…64 */
    jp_q24 curvature_max;        /**< 1/m; 0.01…16: of the robot's least turn radius */
    jp_q24 lateral_acceleration; /**< m/s²; 0.01…16 */
    jp_q24 acceleration;         /**< forward and braking, m/s²; 0.125…16 */
    jp_q24 tolerance;            /**< remaining distance at which the robot has arrived, m; 0.005…1 */
};

/** The members are private. */
struct jp_pure_pursuit {
    struct jp_pure_pursuit_config config;
    const struct jp_point *path; /* null: none */
    size_t count;
    size_t passed;  /* first point of the chord that the robot is on; count: arrived */
    int64_t beyond; /* length of the chords after that one, m in Q24 */
};

/** Prepares a tracker without a path. JP_ERR_CONFIG: *field names the first field out of range. JP_ERR_ARGUMENT: a null
 *  pointer. After a failure the tracker is not changed. Constant time. */
enum jp_status jp_pure_pursuit_init(struct jp_pure_pursuit *tracker, const struct jp_pure_pursuit_config *config,
                                    const char **field);

/**
 * Follows a path from its first point, near which the robot is; the path must outlive the tracker. JP_ERR_ARGUMENT: a
 * null pointer, fewer than two points, or two neighbours that are equal or farther apart than 64 m; the old path stays.
 * Work: one square root a point.
 */
enum jp_status jp_pure_pursuit_follow(struct jp_pure_pursuit *tracker, const struct jp_point *path, size_t count);

/**
 * The twist for the next tick of `period` s (above 0, at most 1 s), from where the robot is, its heading
 * (counterclockwise from east) and its speed now: the one last asked for, or measured; ±16 m/s. *twist is 0 unless
 * JP_OK. JP_ERR_ARGUMENT: a null pointer, a period or speed out of range. JP_ERR_NO_PLAN: no path. JP_ERR_OUTSIDE: the
 * path is farther away than lookahead_max: stop and plan again. JP_ARRIVED: it stays so until the next path.
 */
enum jp_status jp_pure_pursuit_tick(struct jp_pure_pursuit *tracker, const struct jp_point *position, jp_angle heading,
                                    jp_q24 speed, jp_q24 period, struct jp_twist *twist);

#ifdef __cplusplus
}
#endif

#endif
