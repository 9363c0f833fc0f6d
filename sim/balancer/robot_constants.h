/**
 * A robot's physical constants and controller settings.
 *
 * Everything that depends on the robot comes from here: the simulator, the gains, the energy model, the firmware's
 * const structs.
 */
#ifndef JOULEPATH_SIM_BALANCER_ROBOT_CONSTANTS_H
#define JOULEPATH_SIM_BALANCER_ROBOT_CONSTANTS_H

#include "sim/files/config_fields.h"

#define ROBOT_WEIGHTS 8

struct robot_file {
    char name[CONFIG_NAME_SIZE];
    struct {
        double mass_kg;         /**< M, without the wheels */
        double width_m;         /**< W, between the wheels' contact points */
        double depth_m;         /**< D */
        double centre_height_m; /**< L, wheel axis to the body's centre of mass */
    } body;
    struct {
        double radius_m; /**< R */
        double mass_kg;  /**< m, one wheel; its inertia is m R²/2 */
    } wheel;
    struct {
        double resistance_ohm;      /**< Rm */
        double torque_constant;     /**< Kt, N·m/A at the motor shaft */
        double back_emf;            /**< Kb, V·s/rad at the motor shaft */
        double gear_ratio;          /**< n, motor turns a wheel turn */
        double rotor_inertia_kg_m2; /**< Jm, at the motor shaft */
        double friction;            /**< fm, N·m·s/rad, on the wheel's speed relative to the body */
    } motor;
    struct {
        double friction; /**< fw, N·m·s/rad, on each wheel's speed over the ground */
    } ground;
    struct {
        double power_w; /**< Ps */
    } electronics;
    struct {
        double voltage_v;      /**< without load */
        double resistance_ohm; /**< 0: ideal */
        double capacity_wh;    /**< of the full battery */
    } supply;
    struct {
        int bits; /**< steps of the duty are 2^-bits; 0: ideal */
    } pwm;
    struct {
        int counts_per_turn; /**< of the wheel */
    } encoder;
    struct {
        double noise_rms_dps;
        double bias_dps;       /**< of both axes */
        double step_dps;       /**< 0: ideal */
        double full_scale_dps; /**< 0: none */
    } gyro;
    struct {
        double noise_rms_g;
        double step_g;       /**< 0: ideal */
        double full_scale_g; /**< 0: none */
        double height_m;     /**< of the sensor, above the wheel axis along the body */
    } accelerometer;
    struct {
        int bits;            /**< of the ADC; 0: ideal */
        double full_scale_a; /**< measures ±full scale */
        double noise_rms_a;
    } current_sense;
    struct {
        int bits;            /**< of the ADC; 0: ideal */
        double full_scale_v; /**< measures 0…full scale */
    } bus_sense;
    /* Of the controller, by its numbers; the tools find what is left out. The simulator needs the rate alone. */
    struct {
        int rate_hz;
        double weights[ROBOT_WEIGHTS];  /**< LQR weights of [θ ψ φ θ̇ ψ̇ φ̇ ∫θ ∫φ] */
        double input_weight;            /**< LQR weight of each motor voltage */
        double travel_shaping_s;        /**< 0: none */
        double yaw_shaping_s;           /**< 0: none */
        double encoder_bandwidth_rad_s; /**< 0: plain difference */
        double tilt_time_constant_s;    /**< 0: off */
        double bias_time_constant_s;    /**< 0: off */
        double pitch_reserve_share;     /**< of the supply, 0…1 */
        double tilt_limit_deg;
        int freeze_ticks;          /**< 0: off */
        double gyro_jump_dps;      /**< change a tick that is implausible; 0: off */
        double current_residual_a; /**< 0: off */
        double voltage_min_v;
        double voltage_max_v;
    } control;
    /* Of the controller, by what it shall do; the tools find what is left out. */
    struct {
        double settling_s;      /**< until 2 % of a displacement of the wheels are left */
        double lean_deg;        /**< largest, of planned changes of the speed */
        double voltage_reserve; /**< share of the supply that travel leaves to balance */
        double sensor_delay_s;  /**< of the inertial sensor's filter */
    } specification;
    struct {
        double speed_m_s;
        double turn_rate_rad_s;
        double turn_deg;
        double duration_s;
        double payload_kg[2]; /**< least and most that the body carries beside its mass; the least may be below 0 */
    } limits;
    struct {
        double cell_m;   /**< of its maps; may be left out */
        double margin_m; /**< round the disc in which it turns; left out: it is planned for by its rectangle */
    } navigation;
};

#endif
