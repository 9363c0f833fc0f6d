/**
 * Energy of a robot with four steered and driven wheels, from parameters that are identified from its drives.
 *
 * A drive is a chain of pieces, in each of which the twist changes evenly and the slope stays. With the mean twist
 * (x, y, w) of a piece, its accelerations ax, ay and α, and all forces as shares of the weight G:
 *
 *   wheels   ui = |(x − w yi, y + w xi)|, u their mean
 *   effort   e = grade x + bank y + i (x ax + y ay) + j w α      power of slope and kinetic energy over the weight, m/s
 *   forces   fi = c/4 + b ui + e/(4 u)                           of wheel i, along its motion
 *   bends    s = l (x² + y²) w²                                  what the tyres lose as they lead the robot round
 *   steering S = k · travel · q/√(q² + u²), q = a · travel/(4 T) energy of the steering motors over a piece of T
 *   energy   (Pe + Σ (d G fi ui + m fi²) + driving G s) T + S;  where the wheels stand, Pe T + S
 *
 * Here d is `driving` or `braking` and m `copper_driving` or `copper_braking`, by the sign of fi. Steering takes most
 * at a stand: a wheel that rolls faster than its contact scrubs, at q, hardly scrubs.
 *
 * Regressors are derivatives by the relative change of what differs between robots and grounds of a kind: rolling c,
 * weight G (with which m grows in square, and b falls), steering k and electronics Pe.
 *
 * Energies in Q16 are in the unit of the model, 2ⁿ J (energy.h). All functions are pure and bounded; an ISR may call
 * them.
 */
#ifndef JOULEPATH_FOUR_WHEEL_ENERGY_H
#define JOULEPATH_FOUR_WHEEL_ENERGY_H

#include <joulepath/energy.h>
#include <joulepath/twist.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Parameters of one robot on the ground of its identification; made by tools/design/four_wheel_identify.py. */
struct jp_four_wheel_energy_model {
    jp_q24 wheelbase;         /**< axle to axle, m; 0.05…4 */
    jp_q24 track;             /**< left to right contact, m; 0.05…4 */
    jp_q16 weight;            /**< G, N; 1…16 384 */
    jp_q24 rolling;           /**< c: rolling resistance over the weight; 0…0.5 */
    jp_q24 drag;              /**< b: bearings and gear of a wheel over weight and speed, s/m; 0…1 */
    jp_q24 cornering;         /**< l: loss in bends, s³/m²; 0…1 */
    jp_q24 inertia;           /**< i: mass with the wheels' share over the weight, s²/m; 0…8 */
    jp_q24 turn_inertia;      /**< j: moment of inertia with the wheels' share over the weight, s²·m; 0…8 */
    jp_q24 driving;           /**< d: power of the battery over that of the wheels; 1…10 */
    jp_q24 braking;           /**< the same where they brake: share that comes back; 0…1 */
    jp_q16 copper_driving;    /**< m: power in the windings of a wheel whose force is the weight, W; 0…16 384 */
    jp_q16 copper_braking;    /**< the same where it brakes; 0…16 384 */
    jp_q16 steering;          /**< k: of a wheel that is steered at a stand, J/rad; 0…1 024 */
    jp_q24 contact;           /**< a: mean radius of a wheel's contact, m; 0…0.5 */
    jp_q16 electronics_power; /**< Pe, W; 0…1 024 */
    int32_t unit_exponent;    /**< n: energies in Q16 are in 2ⁿ J; ±JP_ENERGY_UNIT_EXPONENT_MAX */
};

/** What differs between robots and grounds of a kind. */
enum {
    JP_FOUR_WHEEL_ROLLING,
    JP_FOUR_WHEEL_WEIGHT,
    JP_FOUR_WHEEL_STEERING,
    JP_FOUR_WHEEL_ELECTRONICS,
    JP_FOUR_WHEEL_FACTORS
};

/** A piece of a drive; of a steady motion both ends are alike. */
struct jp_four_wheel_piece {
    struct jp_twist start; /**< |x|, |y| <= 8 m/s, |turn rate| <= 8 rad/s */
    struct jp_twist end;
    jp_q24 grade;    /**< rise over run along the robot's heading, whichever way it drives; ±1 */
    jp_q24 bank;     /**< rise over run to its left; ±1 */
    jp_q16 travel;   /**< of steering, the sum of all four wheels, rad; 0…256 */
    jp_q16 duration; /**< s; above 0, up to 256 */
};

/** Energy of a chain of pieces; all zero at first. */
struct jp_four_wheel_drive {
    int64_t energy;                        /**< 2ⁿ J, Q16 */
    int64_t change[JP_FOUR_WHEEL_FACTORS]; /**< of the energy by the relative change of each factor, 2ⁿ J, Q16 */
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_four_wheel_energy_check(const struct jp_four_wheel_energy_model *model, const char **field);

/**
 * Adds a piece to a drive. The model must have passed its check.
 * JP_ERR_ARGUMENT: a pointer is null, or a member of the piece out of its range; *drive is not written.
 * An effort beyond ±32 m/s, a force of a wheel beyond the weight, a power beyond 4 MW and an energy of a piece
 * beyond 2³⁰ units count as these. At most 65 536 pieces. Work: five square roots and seven 64-bit divisions.
 */
enum jp_status jp_four_wheel_energy_add(const struct jp_four_wheel_energy_model *model,
                                        struct jp_four_wheel_drive *drive, const struct jp_four_wheel_piece *piece);

/**
 * Energy of a metre along the heading at a steady speed, above 0, on a grade; J, not the model's unit. The model must
 * have passed its check. JP_ERR_ARGUMENT: a null pointer, a speed outside 1/256…8 m/s or a grade outside ±1.
 * JP_ERR_OVERFLOW: beyond ±32 767 J; *joules is saturated. Work: as jp_four_wheel_energy_add().
 */
enum jp_status jp_four_wheel_energy_metre(const struct jp_four_wheel_energy_model *model, jp_q24 speed, jp_q24 grade,
                                          jp_q16 *joules);

/** The model of a robot that differs by factors, Q16, above 0, in the order of JP_FOUR_WHEEL_ROLLING…; members are
 *  limited to their ranges. */
void jp_four_wheel_energy_scale(const struct jp_four_wheel_energy_model *model,
                                const jp_q16 factor[JP_FOUR_WHEEL_FACTORS], struct jp_four_wheel_energy_model *scaled);

#ifdef __cplusplus
}
#endif

#endif
