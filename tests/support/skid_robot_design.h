/** The configuration of a skid-steered or differential-drive robot from its file, in double: what
 * tools/design/skid_robot.py makes; for robots that are made up. */
#ifndef JOULEPATH_TESTS_SUPPORT_SKID_ROBOT_DESIGN_H
#define JOULEPATH_TESTS_SUPPORT_SKID_ROBOT_DESIGN_H

#include <joulepath/skid_robot.h>

#include "tests/support/skid_odometry_config.h"

/** Currents of a side's motor, A. */
struct skid_loads {
    double friction;
    double rolling;
    double climbing;
    double turning;
    double acceleration;
    double turn_acceleration;
    double inertia; /* kg·m² at the wheels */
};

static inline double skid_caster_share(const struct skid_steer_model *model)
{
    return model->caster.ahead_m == 0 ? 0 : model->body.centre_ahead_m / model->caster.ahead_m;
}

static inline double skid_motor_constant(const struct skid_steer_model *model)
{
    return model->motor.torque_constant * model->motor.gear_ratio;
}

static inline struct skid_loads skid_loads_of(const struct skid_steer_model *model, double steering)
{
    const double radius = model->wheel.radius_m;
    const double width = model->body.width_m;
    const double per_torque = 1 / (skid_motor_constant(model) * model->motor.efficiency);
    const double per_force = radius * per_torque;
    const double rotating = model->wheel.axles * model->wheel.inertia_kg_m2 +
                            model->motor.gear_ratio * model->motor.gear_ratio * model->motor.rotor_inertia_kg_m2;
    const double caster = skid_caster_share(model);
    const double rolls = (1 - caster) * model->ground.rolling + caster * model->caster.rolling;
    const double half_weight = model->body.mass_kg * STANDARD_GRAVITY / 2;

    return (struct skid_loads){
        .friction = model->motor.friction_nm * per_torque,
        .rolling = rolls * half_weight * per_force,
        .climbing = half_weight * per_force,
        .turning = model->ground.friction * half_weight * model->body.wheelbase_m / 2 / 0.925 / width * per_force,
        .acceleration = (model->body.mass_kg / 2 + rotating / (radius * radius)) * per_force,
        .turn_acceleration =
            (model->body.yaw_inertia_kg_m2 / width + rotating * width / (2 * steering * radius * radius)) * per_force,
        .inertia = rotating + model->body.mass_kg * radius * radius / 2,
    };
}

static inline double skid_tipping_acceleration(const struct skid_steer_model *model, double slope)
{
    const double half = model->body.wheelbase_m / 2;
    const double front = fmax(half, model->caster.ahead_m);
    const double rear = fmin(-half, model->caster.ahead_m);
    const double reach = fmin(front - model->body.centre_ahead_m, model->body.centre_ahead_m - rear);
    const double height = model->body.centre_height_m;

    return height == 0 ? INFINITY : STANDARD_GRAVITY * (reach / height * cos(slope) - sin(slope));
}

static inline double skid_acceleration_limit(const struct skid_steer_model *model, const struct skid_loads *load)
{
    const double slope = model->limits.slope_deg * M_PI / 180;
    const double driven = 1 - skid_caster_share(model);
    const double grip = STANDARD_GRAVITY * (model->ground.friction * driven * cos(slope) - sin(slope));
    const double spare =
        0.95 * model->motor.current_limit_a - load->rolling - load->friction - load->climbing * sin(slope);

    return 0.25 * fmin(fmin(grip, skid_tipping_acceleration(model, slope)), spare / load->acceleration);
}

/** V·s/rad and V/rad. */
static inline void skid_loop_gains(const struct skid_steer_model *model, const struct skid_loads *load,
                                   double *proportional, double *integral)
{
    const double constant = skid_motor_constant(model);
    const double time = load->inertia * model->motor.resistance_ohm / (constant * constant);
    const double bandwidth = fmin(25, model->control.rate_hz / 20.0);
    const bool slow = 2 * bandwidth * time > 1;

    *proportional = slow ? (2 * bandwidth * time - 1) * constant : 0;
    *integral = slow ? bandwidth * bandwidth * time * constant : bandwidth * (1 - bandwidth * time) * constant;
}

/** 1/s; steps of the counts are noise of the rate. */
static inline double skid_tracking_bandwidth(const struct skid_steer_model *model)
{
    const double rate = model->control.rate_hz;
    const double noise = 0.01 * 0.95 * model->motor.current_limit_a * model->motor.resistance_ohm /
                         (2 * M_PI * skid_motor_constant(model));
    const double quiet = cbrt(48 * rate * pow(noise * model->encoder.counts_per_turn, 2));

    return fmin(fmax(quiet, 4 * fmin(25, rate / 20)), 2 * rate);
}

static inline struct jp_skid_control_config skid_control_of(const struct skid_steer_model *model,
                                                            const struct skid_loads *load)
{
    const double rate = model->control.rate_hz;
    const double around = 2 * M_PI * model->wheel.radius_m;
    const double constant = 2 * M_PI * skid_motor_constant(model);
    const double pole = exp(-skid_tracking_bandwidth(model) / rate);
    const double creep = 0.02 * model->limits.speed_m_s;
    double proportional;
    double integral;

    skid_loop_gains(model, load, &proportional, &integral);
    return (struct jp_skid_control_config){
        .tick_rate = (uint32_t)rate,
        .wheel_per_count = (jp_phase)floor(ldexp(1.0 / model->encoder.counts_per_turn, 56) + 0.5),
        .tracking_gain = skid_fixed(1 - pole * pole, 16),
        .tracking_rate_gain = skid_fixed((1 - pole) * (1 - pole) * rate, 16),
        .turns_per_metre = skid_fixed(1 / around, 24),
        .turns_per_radian = skid_fixed(model->body.width_m / 2 / around, 24),
        .back_emf = skid_fixed(constant, 16),
        .resistance = skid_fixed(model->motor.resistance_ohm, 16),
        .current_limit = skid_fixed(0.95 * model->motor.current_limit_a, 16),
        .rolling = skid_fixed(load->rolling + load->friction, 16),
        .creep = skid_fixed(creep / around, 24),
        .climbing = skid_fixed(load->climbing, 16),
        .acceleration = skid_fixed(load->acceleration, 16),
        .turn_acceleration = skid_fixed(load->turn_acceleration, 16),
        .turning = skid_fixed(load->turning, 16),
        .turning_decrease = skid_fixed(0.15 / 0.925 / model->body.width_m, 24),
        .turning_creep = skid_fixed(2 * creep / model->body.width_m, 24),
        .braking = skid_fixed(model->motor.efficiency * model->motor.efficiency, 24),
        .proportional = skid_fixed(2 * M_PI * proportional, 16),
        .integral = skid_fixed(2 * M_PI * integral, 16),
    };
}

/** What an accelerometer may show of a slope, g. */
static inline double skid_accelerometer_margin(const struct skid_steer_model *model)
{
    return 2 * fabs(model->accelerometer.bias_g) + fabs(model->accelerometer.scale_error) +
           model->accelerometer.noise_rms_g;
}

/** Of what every second tick does. */
static inline uint16_t skid_calls(const struct skid_steer_model *model, double seconds)
{
    return (uint16_t)fmax(nearbyint(seconds * model->control.rate_hz / 2), 1);
}

static inline uint16_t skid_freeze_ticks(const struct skid_steer_model *model)
{
    const bool moves = model->gyro.noise_rms_dps >= model->gyro.step_dps / 2 && model->gyro.step_dps > 0 &&
                       model->accelerometer.noise_rms_g >= model->accelerometer.step_g / 2 &&
                       model->accelerometer.step_g > 0;

    return moves ? (uint16_t)fmax(nearbyint(0.05 * model->control.rate_hz), 10) : 0;
}

/** turn/s in a tick: all grip turns the robot, or it drives at full speed over the top of its steepest slope. */
static inline double skid_gyro_jump(const struct skid_steer_model *model)
{
    const double moment = model->ground.friction * model->body.mass_kg * STANDARD_GRAVITY * model->body.width_m / 2;
    const double turning = moment / model->body.yaw_inertia_kg_m2 / model->control.rate_hz;
    const double length = fmax(model->body.wheelbase_m, fabs(model->caster.ahead_m));
    const double tilting = 2 * sin(model->limits.slope_deg * M_PI / 180) * model->limits.speed_m_s / length;
    const double most = fmax(1.5 * turning, tilting) / (2 * M_PI) + 6 * model->gyro.noise_rms_dps / 360;

    return model->gyro.full_scale_dps == 0 ? 127 : fmin(most, 127);
}

static inline struct jp_monitor_config skid_monitor_of(const struct skid_steer_model *model)
{
    const double supply = model->supply.voltage_v;
    const double constant = skid_motor_constant(model);
    const double free_counts = supply / constant / (2 * M_PI) * model->encoder.counts_per_turn / model->control.rate_hz;
    const double steepest = sin(model->limits.slope_deg * M_PI / 180) + skid_accelerometer_margin(model);
    const double gyro = model->gyro.full_scale_dps;
    const double accel = model->accelerometer.full_scale_g;

    return (struct jp_monitor_config){
        .tilt_limit = skid_fixed(asin(fmin(steepest, 1)) / (2 * M_PI), 24),
        .gyro_limit = skid_fixed(gyro > 0 ? 0.99 * gyro / 360 : 100, 24),
        .gyro_jump = skid_fixed(skid_gyro_jump(model), 24),
        .accel_limit = skid_fixed(accel > 0 ? 0.99 * accel : 100, 24),
        .encoder_jump = (uint32_t)(ceil(4 * free_counts) + 16),
        .current_limit = skid_fixed(0.99 * model->current_sense.full_scale_a, 16),
        .voltage_min = skid_fixed(0.75 * supply, 16),
        .voltage_max = skid_fixed(1.25 * supply, 16),
        .motor_resistance = skid_fixed(model->motor.resistance_ohm, 16),
        .back_emf = skid_fixed(2 * M_PI * constant, 16),
        .half_track = JP_Q16_ONE,
        .wheel_rate_limit = skid_fixed(1.25 * model->limits.speed_m_s / (2 * M_PI * model->wheel.radius_m), 24),
        .current_residual =
            skid_fixed(0.1 * supply / model->motor.resistance_ohm + 6 * model->current_sense.noise_rms_a, 16),
        .confirm_ticks = 3,
        .freeze_ticks = skid_freeze_ticks(model),
        .residual_ticks = skid_calls(model, 0.1),
    };
}

static inline struct jp_skid_monitor_config skid_wheels_of(const struct skid_steer_model *model,
                                                           const struct skid_loads *load)
{
    const double by_voltage = 0.75 * model->supply.voltage_v / model->motor.resistance_ohm;
    const double noise = (4 * fabs(model->gyro.bias_dps) + 6 * model->gyro.noise_rms_dps) / 360;
    const double creep = 0.02 * model->limits.speed_m_s / (2 * M_PI * model->wheel.radius_m);

    return (struct jp_skid_monitor_config){
        .upright = skid_fixed(cos(model->limits.slope_deg * M_PI / 180) - skid_accelerometer_margin(model), 24),
        .smoothing = skid_fixed(1 - exp(-2 / (0.2 * model->control.rate_hz)), 31),
        .stall_current = skid_fixed(0.8 * fmin(0.95 * model->motor.current_limit_a, by_voltage), 16),
        .stall_rate = skid_fixed(creep, 24),
        .friction = skid_fixed(load->friction, 16),
        .carried = skid_fixed(fmax(fmax(load->rolling / 2, load->friction), 6 * model->current_sense.noise_rms_a), 16),
        .turn_per_wheel = skid_fixed(model->wheel.radius_m / model->body.width_m, 24),
        .spin_rate = skid_fixed(fmax(model->lattice.turn_rate_rad_s / 8 / (2 * M_PI), noise), 24),
        .slope_calls = skid_calls(model, 0.2),
        .stall_calls = skid_calls(model, 0.5),
        .contradicted_calls = skid_calls(model, 0.3),
    };
}

static inline struct jp_skid_robot_config skid_robot_design(const struct skid_steer_model *model)
{
    const double steering = skid_pivot_of(model).ratio;
    const struct skid_loads load = skid_loads_of(model, steering);
    const double acceleration = skid_acceleration_limit(model, &load);

    return (struct jp_skid_robot_config){
        .name = model->name,
        .odometry = skid_odometry_config_of(model),
        .control = skid_control_of(model, &load),
        .monitor = skid_monitor_of(model),
        .wheels = skid_wheels_of(model, &load),
        .meter = {.tick_rate = (uint32_t)model->control.rate_hz,
                  .motor_resistance = skid_fixed(model->motor.resistance_ohm, 16),
                  .electronics_power = skid_fixed(model->electronics.power_w, 16)},
        .burnt = skid_fixed(1 - model->motor.recuperation, 16),
        .limits = {.speed = skid_fixed(model->limits.speed_m_s, 24),
                   .acceleration = skid_fixed(acceleration, 24),
                   .turn_acceleration = skid_fixed(acceleration * steering / model->body.width_m, 24)},
        .path = {.tick_rate = (uint32_t)model->control.rate_hz,
                 .way = skid_fixed(0.7 * model->lattice.speed_m_s, 24),
                 .pace = skid_fixed(2.5, 24),
                 .speed_correction = skid_fixed(model->lattice.speed_m_s / 4, 24),
                 .turn_correction = skid_fixed(model->lattice.turn_rate_rad_s, 24)},
        .heading_gain = skid_fixed(2, 24),
    };
}

#endif
