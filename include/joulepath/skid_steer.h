/**
 * Skid-steered robot at constant speed v and turn rate w: wheel speeds, torques, power and energy of a motion
 * (Zhang et al., doi 10.6041/j.issn.1000-1298.2018.09.002, eq. 1–10 and 14).
 *
 *   wheel speeds    ωl = (v − w B/2)/r, ωr = (v + w B/2)/r           (inverse of eq. 1; eq. 2 as printed is not)
 *   force of a side F = sign(ω) c G/2 + sign(v) grade G/2 ∓ M/B      (rolling, gravity, turning), torque τ = F r
 *   turning moment  M = μt G l/4, μt = μ/(0.925 + 0.15 R/B), R = |v/w|
 *   power of a side eq. 8, 9: τω/η + (τ/(K_T g η))² R_e; physical: a side that brakes (τω < 0) returns the share s η τω
 *   energy          physical: (Pl + Pr + Pe) T, at least Pe T
 *                   paper: eq. 14, α|v|T + (Pl + Pr) T + μ G rise, at least 0
 *
 * M is the saturated lateral resistance of a skid-steered vehicle (Yu, Chuy, Collins and Hollis, IEEE T-RO 26(2), 2010)
 * with its empirical decrease over the turn radius (Steeds; Maclaurin).
 *
 * Speeds, distances and the grade (rise over run) are those of the map. So the work of rolling and of gravity is exact,
 * and the loss in the motors' windings is at most 7 % too high on slopes up to 15°.
 *
 * All functions are pure and bounded, at most nine 64-bit divisions; an ISR may call them.
 */
#ifndef JOULEPATH_SKID_STEER_H
#define JOULEPATH_SKID_STEER_H

#include <joulepath/energy.h>
#include <joulepath/lattice.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Constants of one robot; made by tools/design/lattice.py from sim/robots/. */
struct jp_skid_steer_config {
    jp_q24 wheel_radius;      /**< r, m; 0.01…1 */
    jp_q24 width;             /**< B, m; 0.05…4 */
    jp_q24 wheelbase;         /**< l, m; 0…4; of one axle, a differential drive, 0 */
    jp_q16 weight;            /**< G, N; 1…16 384 */
    jp_q24 rolling;           /**< c; 0…0.5 */
    jp_q24 friction;          /**< μ; 0…2 */
    jp_q16 torque_per_ampere; /**< K_T g η at the wheels of a side, N·m/A; 0.01…16 384 */
    jp_q24 resistance;        /**< R_e, Ω; 0…100 */
    jp_q24 efficiency;        /**< η; 0.1…1 */
    jp_q24 recuperation;      /**< s; 0…1 */
    jp_q16 electronics_power; /**< Pe, W; 0…1 024 */
    jp_q16 distance_energy;   /**< α, J/m; 0…1 024 */
};

/** A value for the wheels of each side. */
struct jp_skid_steer_sides {
    jp_q16 left;
    jp_q16 right;
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_skid_steer_check(const struct jp_skid_steer_config *config, const char **field);

/** ω of each side, rad/s (inverse of eq. 1). JP_ERR_ARGUMENT: a pointer is null or the motion out of its range. */
enum jp_status jp_skid_steer_wheel_speeds(const struct jp_skid_steer_config *config, const struct jp_motion *motion,
                                          struct jp_skid_steer_sides *speeds);

/**
 * τ of each side, N·m (eq. 3 without acceleration), uphill for grade > 0; |grade| <= 1.
 * JP_ERR_ARGUMENT: a pointer is null, or the motion or the grade out of its range.
 * JP_ERR_OVERFLOW: a force exceeds 32 767 N; *torques is saturated.
 */
enum jp_status jp_skid_steer_torques(const struct jp_skid_steer_config *config, const struct jp_motion *motion,
                                     jp_q24 grade, struct jp_skid_steer_sides *torques);

/**
 * Power out of the battery, W: of the motors for JP_COST_PAPER, and of the electronics too for JP_COST_PHYSICAL.
 * Below 0 where more comes back than is spent.
 * JP_ERR_ARGUMENT: as above, or another kind; *power is not written.
 * JP_ERR_OVERFLOW: a force exceeds 32 767 N, a current 2 047 A or the power 32 767 W; *power is saturated.
 */
enum jp_status jp_skid_steer_power(const struct jp_skid_steer_config *config, enum jp_cost_kind kind,
                                   const struct jp_motion *motion, jp_q24 grade, jp_q16 *power);

/** The physical power of a `config` that passed its check, as jp_motion_price.power (path_speed.h): 0 where
 *  jp_skid_steer_power() refuses its arguments. */
jp_q16 jp_skid_steer_power_of(const void *config, const struct jp_motion *motion, jp_q24 grade);

/**
 * Energy in J of a motion that lasts `duration` s (0…256) and rises by `rise` m.
 * JP_ERR_ARGUMENT: as above; the duration is out of range, or the rise exceeds the horizontal distance.
 * JP_ERR_OVERFLOW: as above, or the energy exceeds 32 767 J; *energy is saturated.
 * Error against exact arithmetic: at most 0.001 J + 1e-5 of the terms' magnitudes for |v| or |w| from 0.01.
 */
enum jp_status jp_skid_steer_energy(const struct jp_skid_steer_config *config, enum jp_cost_kind kind,
                                    const struct jp_motion *motion, jp_q24 rise, jp_q16 duration, jp_q16 *energy);

#ifdef __cplusplus
}
#endif

#endif
