/**
 * Energy of a skid-steered or differential-drive robot, from parameters that are identified from its drives.
 *
 * A drive is a chain of pieces, in each of which speed v and turn rate w change evenly and the grade stays. With the
 * mean motion of a piece, its acceleration a, its angular acceleration α, and all forces as shares of the weight G:
 *
 *   tread speeds   ul = v − h w, ur = v + h w         h is above half of the width where the wheels slide sideways
 *   effort         e = grade + i a                    slope and kinetic energy of driving
 *   turning        t = k μ w/D · r + z e bank + j α,  D = |w| + μ q m, m = max(|v|, h |w|),
 *                                                     r = 1 − (a1 e² + a2 bank²)/μ², at least 0
 *   force of sides fl = sign(ul) c/2 + e/2 − t, fr = sign(ur) c/2 + e/2 + t
 *   slip           s = e² p (|w| + μ q |v|)/(2 max(μ − |e|, μ/4)) of each side
 *   power          P = Pe + Σ (x G (f u + s) + y f²/(1 + grade²)); standing, Pe
 *
 * Here x is `driving` or `braking` by the sign of f u + s, and y `copper_driving` or `copper_braking` by that of f u; a
 * side that stands is held like one that brakes. The turning
 * moment k μ G B of the seed's formula (skid_steer.h) falls with the turn radius as the treads roll out of their slide:
 * a tread that rolls at m while it slides sideways by the turn gives μ/(1 + μ q m/|w|) of its load (LuGre model, steady
 * slip). The same stiffness lets it slip along under an effort, and so does the turn, by which the treads slide anyway:
 * what turns on the spot slides down a slope and must climb back, which is counted where it turns. On a slope the
 * treads slide downhill as well, which leaves less of their friction against the turn (r), and the load that climbing
 * shifts to the rear turns the robot downhill (z).
 *
 * P is linear in Pe, in x, in y, and for given signs the mechanical power is linear in c, e and k. So energies have
 * regressors, their derivatives by the relative change of what differs between robots and grounds of a kind: rolling c,
 * friction μ, weight G (with which y grows in square) and electronics Pe.
 *
 * Speeds, distances and the grade are those of the map, as in skid_steer.h. Energies in Q16 are in the unit of the
 * model, 2ⁿ J (energy.h). All functions are pure and bounded; an ISR may call them.
 */
#ifndef JOULEPATH_SKID_ENERGY_H
#define JOULEPATH_SKID_ENERGY_H

#include <joulepath/energy.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Parameters of one robot on the ground of its identification; made by tools/design/skid_identify.py. */
struct jp_skid_energy_model {
    jp_q24 half_track;        /**< h, m; 0.01…4 */
    jp_q16 weight;            /**< G, N; 1…16 384 */
    jp_q24 rolling;           /**< c: rolling resistance, gears and bearings, over the weight; 0…0.5 */
    jp_q24 friction;          /**< μ of the ground; 0.02…2 */
    jp_q24 turning;           /**< k: force of each side where the robot turns on the spot, over μ G; 0…4 */
    jp_q24 yielding;          /**< q: how soon turning gets easier with the radius, 1/m; 0…16 */
    jp_q24 scrub;             /**< p: way that the treads slide for a turn by 1 rad, m; 0…4 */
    jp_q24 easing;            /**< a1: how much easier turning is under an effort; 0…4 */
    jp_q24 bank_easing;       /**< a2: and on ground that rises to a side; 0…4 */
    jp_q24 tilting;           /**< z: about the height of the centre of mass over the width; 0…4 */
    jp_q24 inertia;           /**< i: mass with the wheels' share over the weight, s²/m; 0…8 */
    jp_q24 turn_inertia;      /**< j: moment of inertia over weight and width, s²; 0…8 */
    jp_q24 driving;           /**< x of a side that drives: power of the battery over that of the treads; 1…10 */
    jp_q24 braking;           /**< x of a side that brakes: share that comes back; 0…1 */
    jp_q16 copper_driving;    /**< y: power in the windings of a side whose force is the weight, W; 0…16 384 */
    jp_q16 copper_braking;    /**< the same where it brakes; 0…16 384 */
    jp_q16 electronics_power; /**< Pe, W; 0…1 024 */
    int32_t unit_exponent;    /**< n: energies in Q16 are in 2ⁿ J; ±JP_ENERGY_UNIT_EXPONENT_MAX */
};

/** What differs between robots and grounds of a kind. */
enum { JP_SKID_ROLLING, JP_SKID_FRICTION, JP_SKID_WEIGHT, JP_SKID_ELECTRONICS, JP_SKID_FACTORS };

/** A piece of a drive; of a steady motion both ends are alike. */
struct jp_skid_piece {
    struct jp_motion start;
    struct jp_motion end;
    jp_q24 grade;    /**< rise over run along the robot's heading, whichever way it drives; ±1 */
    jp_q24 bank;     /**< rise over run to its left; ±1 */
    jp_q16 duration; /**< s; above 0, up to 256 */
};

/** Energy of a chain of pieces; all zero at first. */
struct jp_skid_drive {
    int64_t energy;                  /**< 2ⁿ J, Q16 */
    int64_t change[JP_SKID_FACTORS]; /**< of the energy by the relative change of each factor, 2ⁿ J, Q16 */
    int64_t slope_work;              /**< G m (|grade| + |bank|) over time, whether up or down, 2ⁿ J, Q16 */
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_skid_energy_check(const struct jp_skid_energy_model *model, const char **field);

/**
 * Power in W, Q16, of a constant motion on ground without bank, not counted in the unit of the model; below 0 where
 * more comes back than is spent. JP_ERR_ARGUMENT: a pointer is null, or the motion or the grade out of its range;
 * *power is not written. JP_ERR_OVERFLOW: it exceeds 32 767 W; *power is saturated. Work: as jp_skid_energy_add().
 */
enum jp_status jp_skid_energy_power(const struct jp_skid_energy_model *model, const struct jp_motion *motion,
                                    jp_q24 grade, jp_q16 *power);

/**
 * Adds a piece to a drive. The model must have passed its check.
 * JP_ERR_ARGUMENT: a pointer is null, or a member of the piece out of its range; *drive is not written.
 * An effort beyond ±2, a force of a side beyond ±8 times the weight, f u + s beyond ±32 m/s, power beyond 4 MW and an
 * energy of a piece beyond 2³⁰ units count as these. At most 65 536 pieces. Work: seven 64-bit divisions.
 * Error against exact arithmetic, where v and w are 0 or from 0.05: at most 3e-5 of the terms' magnitudes, 1e-6 of what
 * the treads would take if their forces were the weight and they 1 m/s faster, 2e-4 W and 2⁻¹⁶ of a unit for each
 * piece.
 */
enum jp_status jp_skid_energy_add(const struct jp_skid_energy_model *model, struct jp_skid_drive *drive,
                                  const struct jp_skid_piece *piece);

/** The model of a robot that differs by factors, Q16, in the order of JP_SKID_ROLLING…; members are limited to their
 *  ranges. */
void jp_skid_energy_scale(const struct jp_skid_energy_model *model, const jp_q16 factor[JP_SKID_FACTORS],
                          struct jp_skid_energy_model *scaled);

#ifdef __cplusplus
}
#endif

#endif
