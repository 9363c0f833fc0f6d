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

/** Axles that a robot can have. */
#define SKID_STEER_AXLES_MAX 16

struct skid_steer_model {
    char name[CONFIG_NAME_SIZE];
    struct {
        double length_m;
        double width_m;         /**< B, between the tracks of the two sides */
        double overall_width_m; /**< of its outline */
        double middle_ahead_m;  /**< of its outline, ahead of the middle between the axles */
        double wheelbase_m;     /**< from the first to the last axle; of a differential drive 0 */
        double mass_kg;         /**< with the wheels */
        double centre_height_m; /**< of mass, above the ground */
        double centre_ahead_m;  /**< of mass, ahead of the middle between the axles */
        double yaw_inertia_kg_m2;
    } body;
    struct {
        double radius_m;
        double inertia_kg_m2; /**< of one wheel about its axle */
        int axles;            /**< of two wheels each; of a differential drive 1 */
    } wheel;
    struct {
        double ahead_m; /**< of the middle between the axles; 0: the robot has no caster */
        double rolling; /**< resistance over load */
    } caster;
    struct {
        double stiffness_per_m;  /**< σ0: force over load that a metre of the tread's deflection gives */
        double damping_s_per_m;  /**< σ1: force over load of a deflection of 1 m/s */
        double contact_length_m; /**< of the patch that a tyre touches the ground with */
    } tyre;
    struct {
        double torque_constant; /**< K_T, N·m/A at the motor shaft */
        double resistance_ohm;
        double gear_ratio;
        double efficiency;
        double power_w;
        double recuperation;
        double rotor_inertia_kg_m2; /**< at the motor shaft */
        double friction_nm;         /**< dry, at the wheels of a side, whatever the load */
        double current_limit_a;     /**< of a side's bridge */
    } motor;
    struct {
        double friction;
        double rolling;
    } ground;
    struct {
        double power_w;
    } electronics;
    struct {
        double voltage_v; /**< without load */
        double resistance_ohm;
    } supply;
    struct {
        int bits; /**< steps of the duty are 2^-bits; 0: ideal */
    } pwm;
    struct {
        int counts_per_turn; /**< of a wheel */
    } encoder;
    struct {
        double noise_rms_dps;
        double bias_dps;       /**< of each axis */
        double scale_error;    /**< it reads 1 + this times the rate */
        double step_dps;       /**< 0: ideal */
        double full_scale_dps; /**< 0: none */
    } gyro;
    struct {
        double noise_rms_g;
        double bias_g; /**< of each axis */
        double scale_error;
        double step_g;       /**< 0: ideal */
        double full_scale_g; /**< 0: none */
    } accelerometer;
    struct {
        int bits; /**< 0: ideal */
        double full_scale_a;
        double noise_rms_a;
    } current_sense;
    struct {
        int bits; /**< 0: ideal */
        double full_scale_v;
    } bus_sense;
    struct {
        int rate_hz;
    } control;
    struct {
        double speed_m_s;
        double slope_deg;
    } limits;
    struct {
        double speed_m_s;
        double turn_rate_rad_s;
        double distance_j_per_m;
    } lattice;
    struct {
        double cell_m;   /**< of its maps; NaN: not given */
        double margin_m; /**< that it keeps round itself where it finds its own way; NaN: it is not made for that */
    } navigation;
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

/** The fields of their files. */
extern const struct config_kind skid_steer_kind;
extern const struct config_kind differential_drive_kind;

/**
 * Reads and checks a robot file whose type is "skid_steer". On failure prints one line on stderr (file, key or line,
 * what, what to do), returns false, and *model is not to be used.
 */
bool skid_steer_load(const char *path, struct skid_steer_model *model);

/** The same of a file whose type is "differential_drive": one axle and a caster. */
bool differential_drive_load(const char *path, struct skid_steer_model *model);

/** The same of a file of either type. */
bool skid_robot_load(const char *path, struct skid_steer_model *model);

#endif
