/**
 * Skid-steered robot at constant speed and turn rate: wheel speeds, torques, power and energy (eq. 1–10 and 14 of Zhang
 * et al., doi 10.6041/j.issn.1000-1298.2018.09.002), in double: the oracle of joulepath/skid_steer.h, whose header
 * states the equations.
 */
#ifndef JOULEPATH_SIM_SKID_STEER_SKID_STEER_MODEL_H
#define JOULEPATH_SIM_SKID_STEER_SKID_STEER_MODEL_H

#include <joulepath/lattice.h>

#include "sim/files/config_fields.h"

#define STANDARD_GRAVITY 9.80665

struct skid_steer_model {
    char name[CONFIG_NAME_SIZE];
    struct {
        double length_m;
        double width_m; /**< B, between the tracks of the two sides */
        double wheelbase_m;
        double mass_kg;
    } body;
    struct {
        double radius_m;
    } wheel;
    struct {
        double torque_constant; /**< K_T, N·m/A at the motor shaft */
        double resistance_ohm;
        double gear_ratio;
        double efficiency;
        double power_w;
        double recuperation;
    } motor;
    struct {
        double friction;
        double rolling;
    } ground;
    struct {
        double power_w;
    } electronics;
    struct {
        double voltage_v;
    } supply;
    struct {
        double speed_m_s;
        double slope_deg;
    } limits;
    struct {
        double speed_m_s;
        double turn_rate_rad_s;
        double distance_j_per_m;
    } lattice;
};

/** What the ground and the motors do at a speed (m/s), turn rate (rad/s) and grade (rise over run). */
struct skid_steer_motion {
    double speed;
    double turn_rate;
    double grade;
};

struct skid_steer_sides {
    double left;
    double right;
};

/** rad/s (inverse of eq. 1). */
struct skid_steer_sides skid_steer_wheel_speeds(const struct skid_steer_model *model,
                                                const struct skid_steer_motion *motion);

/** N·m at the wheels of each side (eq. 3 without acceleration). */
struct skid_steer_sides skid_steer_torques(const struct skid_steer_model *model,
                                           const struct skid_steer_motion *motion);

/** V at each motor. */
struct skid_steer_sides skid_steer_voltages(const struct skid_steer_model *model,
                                            const struct skid_steer_motion *motion);

/** W out of the battery (eq. 8, 9); the electronics are part of the physical one. */
double skid_steer_power(const struct skid_steer_model *model, enum jp_cost_kind kind,
                        const struct skid_steer_motion *motion);

/** J for a motion that lasts `duration` s, before any floor: may be negative downhill. */
double skid_steer_unlimited_energy(const struct skid_steer_model *model, enum jp_cost_kind kind,
                                   const struct skid_steer_motion *motion, double duration);

/** J, at least what the electronics draw (physical) or 0 (paper). */
double skid_steer_energy(const struct skid_steer_model *model, enum jp_cost_kind kind,
                         const struct skid_steer_motion *motion, double duration);

/**
 * Reads and checks a robot file whose type is "skid_steer". On failure prints one line on stderr (file, key or line,
 * what, what to do), returns false, and *model is not to be used.
 */
bool skid_steer_load(const char *path, struct skid_steer_model *model);

#endif
