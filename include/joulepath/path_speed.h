/**
 * Speeds along a path (lattice_path.h) that take the least energy, and time by its price.
 *
 * Each piece is driven at the speed v that a metre costs least at, or a turn on the spot at the least-cost rate,
 *
 *   (P(v, κ v, grade) + price) / v
 *
 * of JP_SPEED_STEPS even steps up to the limits: of speed, turn rate and the speed of the outer side, and of the turn
 * rate's change where the curvature changes. Where it jumps from one piece to the next by Δκ it changes over a way of
 * 2 h = 4 Δκ v²/α about their meeting, half of α being left for the rest; pieces too short for it are met slower. So
 * the robot leaves the path by hardly more than Δκ h²/6, which path_drive.h steers back.
 * While it blends towards a sharper piece its outer side may be faster than its limit, by 5 % at most on random paths.
 *
 * Then two passes keep each change of speed within the acceleration, from the begin, where the robot stands, and from
 * the end, where it stops. It stops before and after each turn on the spot. A piece is driven with one acceleration,
 * which leaves the turn rate its share: up or down to its cruise, on, and to its end.
 */
#ifndef JOULEPATH_PATH_SPEED_H
#define JOULEPATH_PATH_SPEED_H

#include <joulepath/energy.h>
#include <joulepath/lattice_path.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Speeds that are tried of a piece. */
#define JP_SPEED_STEPS 16

/** What the robot can do, whatever the energy. */
struct jp_path_limits {
    jp_q24 speed;               /**< m/s; 0.01…8 */
    jp_radians_per_s turn_rate; /**< rad/s; 0.01…8 */
    jp_q24 side_speed;          /**< of the wheels of a side, m/s; 0.01…16 */
    jp_q24 width;               /**< between the tracks of the two sides, m; 0.05…4 */
    jp_q24 acceleration;        /**< m/s²; 0.01…16 */
    jp_q24 turn_acceleration;   /**< α, rad/s²; 0.01…64 */
};

/** What a motion costs. */
struct jp_motion_price {
    /** Power of a steady motion out of the battery, W, up a grade (rise over run, |grade| <= 1). */
    jp_q16 (*power)(const void *model, const struct jp_motion *motion, jp_q24 grade);
    const void *model; /**< handed to it */
    jp_q16 time;       /**< what a second less is worth, W; 0…16 384 */
    jp_q16 gain; /**< what it takes to be faster along the path, by the square of the speed, J·s²/m²; 0…16 384 */
    jp_q16 recovery; /**< what comes back when it gets slower, by the same; 0…16 384 */
};

/** What a path takes as planned: of the steady motions, and of the changes of the speed along it. */
struct jp_path_cost {
    jp_q16 duration; /**< s */
    jp_q16 energy;   /**< J */
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_path_limits_check(const struct jp_path_limits *limits, const char **field);

/**
 * Plans the speeds of a whole path, which is made of jp_lattice_path_add(); the limits passed their check.
 * JP_ERR_ARGUMENT: a pointer is null, or a price is out of its range. JP_ERR_NO_PLAN: the path has no piece.
 * JP_ERR_OVERFLOW: it takes more than 32 767 s or J, which is what *cost then is; the path can be driven. Work: of each
 * piece up to 3 JP_SPEED_STEPS + 9 powers and 20 divisions of 64 bits. Not for ISRs.
 */
enum jp_status jp_path_plan_speeds(struct jp_lattice_path *path, const struct jp_path_limits *limits,
                                   const struct jp_motion_price *price, struct jp_path_cost *cost);

#ifdef __cplusplus
}
#endif

#endif
