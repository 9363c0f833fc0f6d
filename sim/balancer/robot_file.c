#include "sim/balancer/robot_file.h"

#include <math.h>

#include "sim/balancer/plant.h"
#include "sim/base/error.h"

/* Of the robot's mass: a lighter battery, and a load. */
#define PAYLOAD_LEAST (-0.075)
#define PAYLOAD_MOST  0.3

#define FIELD(member) offsetof(struct robot_file, member)
#define REAL(key, member, min, max, unit)                                                                              \
    {                                                                                                                  \
        key, FIELD(member), 1, CONFIG_FIELD_REAL, min, max, unit, false                                                \
    }
/* Not a number when it is left out: tools/design/specification.py finds it, and who does not need it goes without. */
#define SETTING(key, member, min, max, unit)                                                                           \
    {                                                                                                                  \
        key, FIELD(member), 1, CONFIG_FIELD_REAL, min, max, unit, true                                                 \
    }
#define WHOLE(key, member, min, max, unit)                                                                             \
    {                                                                                                                  \
        key, FIELD(member), 1, CONFIG_FIELD_WHOLE, min, max, unit, false                                               \
    }

static const struct config_field fields[] = {
    REAL("body.mass_kg", body.mass_kg, 0.05, 200, "kg"),
    REAL("body.width_m", body.width_m, 0.02, 2, "m"),
    REAL("body.depth_m", body.depth_m, 0.001, 2, "m"),
    REAL("body.centre_height_m", body.centre_height_m, 0.01, 2, "m"),
    REAL("wheel.radius_m", wheel.radius_m, 0.01, 1, "m"),
    REAL("wheel.mass_kg", wheel.mass_kg, 0.001, 20, "kg"),
    REAL("motor.resistance_ohm", motor.resistance_ohm, 0.01, 30000, "Ω"),
    REAL("motor.torque_constant_nm_per_a", motor.torque_constant, 1e-4, 1000, "N·m/A"),
    REAL("motor.back_emf_v_s_per_rad", motor.back_emf, 1e-4, 1000, "V·s/rad"),
    REAL("motor.gear_ratio", motor.gear_ratio, 0.1, 1000, "1"),
    REAL("motor.rotor_inertia_kg_m2", motor.rotor_inertia_kg_m2, 0, 0.1, "kg·m²"),
    REAL("motor.friction_nm_s_per_rad", motor.friction, 0, 10, "N·m·s/rad"),
    REAL("ground.friction_nm_s_per_rad", ground.friction, 0, 10, "N·m·s/rad"),
    REAL("electronics.power_w", electronics.power_w, 0.001, 256, "W"),
    REAL("supply.voltage_v", supply.voltage_v, 1, 1000, "V"),
    REAL("supply.resistance_ohm", supply.resistance_ohm, 0, 1000, "Ω"),
    REAL("supply.capacity_wh", supply.capacity_wh, 0.01, 100000, "Wh"),
    WHOLE("pwm.bits", pwm.bits, 0, 24, "bit"),
    WHOLE("encoder.counts_per_turn", encoder.counts_per_turn, 16, 16777216, "1/turn"),
    REAL("gyro.noise_rms_dps", gyro.noise_rms_dps, 0, 100, "°/s"),
    REAL("gyro.bias_dps", gyro.bias_dps, -100, 100, "°/s"),
    REAL("gyro.step_dps", gyro.step_dps, 0, 10, "°/s"),
    REAL("gyro.full_scale_dps", gyro.full_scale_dps, 0, 45000, "°/s"),
    REAL("accelerometer.noise_rms_g", accelerometer.noise_rms_g, 0, 1, "g"),
    REAL("accelerometer.step_g", accelerometer.step_g, 0, 0.1, "g"),
    REAL("accelerometer.full_scale_g", accelerometer.full_scale_g, 0, 127, "g"),
    REAL("accelerometer.height_m", accelerometer.height_m, -2, 2, "m"),
    WHOLE("current_sense.bits", current_sense.bits, 0, 24, "bit"),
    REAL("current_sense.full_scale_a", current_sense.full_scale_a, 0.001, 32767, "A"),
    REAL("current_sense.noise_rms_a", current_sense.noise_rms_a, 0, 100, "A"),
    WHOLE("bus_sense.bits", bus_sense.bits, 0, 24, "bit"),
    REAL("bus_sense.full_scale_v", bus_sense.full_scale_v, 0.1, 32767, "V"),
    WHOLE("control.rate_hz", control.rate_hz, 100, 20000, "Hz"),
    {"control.weights", FIELD(control.weights), ROBOT_WEIGHTS, CONFIG_FIELD_REAL, 0, 1e12, "1", true},
    SETTING("control.input_weight", control.input_weight, 1e-9, 1e12, "1/V²"),
    SETTING("control.travel_shaping_s", control.travel_shaping_s, 0, 60, "s"),
    SETTING("control.yaw_shaping_s", control.yaw_shaping_s, 0, 60, "s"),
    SETTING("control.encoder_bandwidth_rad_s", control.encoder_bandwidth_rad_s, 0, 10000, "rad/s"),
    SETTING("control.tilt_time_constant_s", control.tilt_time_constant_s, 0, 1000, "s"),
    SETTING("control.bias_time_constant_s", control.bias_time_constant_s, 0, 10000, "s"),
    SETTING("control.pitch_reserve_share", control.pitch_reserve_share, 0, 1, "1"),
    SETTING("control.tilt_limit_deg", control.tilt_limit_deg, 1, 75, "°"),
    {"control.freeze_ticks", FIELD(control.freeze_ticks), 1, CONFIG_FIELD_WHOLE, 0, 65535, "tick", true},
    SETTING("control.gyro_jump_dps", control.gyro_jump_dps, 0, 45000, "°/s"),
    SETTING("control.current_residual_a", control.current_residual_a, 0, 32767, "A"),
    SETTING("control.voltage_min_v", control.voltage_min_v, 0, 1000, "V"),
    SETTING("control.voltage_max_v", control.voltage_max_v, 0, 1000, "V"),
    SETTING("specification.settling_s", specification.settling_s, 0.01, 600, "s"),
    SETTING("specification.lean_deg", specification.lean_deg, 0.1, 30, "°"),
    SETTING("specification.voltage_reserve", specification.voltage_reserve, 0, 0.9, "1"),
    SETTING("specification.sensor_delay_s", specification.sensor_delay_s, 0, 1, "s"),
    REAL("limits.speed_m_s", limits.speed_m_s, 0.01, 8, "m/s"),
    REAL("limits.turn_rate_rad_s", limits.turn_rate_rad_s, 0.01, 8, "rad/s"),
    REAL("limits.turn_deg", limits.turn_deg, 0, 180, "°"),
    REAL("limits.duration_s", limits.duration_s, 0.1, 16384, "s"),
    SETTING("navigation.cell_m", navigation.cell_m, 0.01, 10, "m"),
    SETTING("navigation.margin_m", navigation.margin_m, 0.001, 10, "m"),
    {"limits.payload_kg", FIELD(limits.payload_kg), 2, CONFIG_FIELD_REAL, -200, 1000, "kg", true},
};

const struct config_kind robot_kind = {CONFIG_BALANCER, FIELD(name), fields, sizeof fields / sizeof fields[0]};

/* What no single field shows. */
static bool check_together(const char *path, const struct robot_file *robot)
{
    const double low = robot->control.voltage_min_v;
    const double high = robot->control.voltage_max_v;
    const double voltage = robot->supply.voltage_v;
    /* Neither holds of a limit that is left out. */
    if (low >= voltage || voltage >= high) {
        error_line("%s: supply.voltage_v = %g: must lie between control.voltage_min_v = %g and control.voltage_max_v "
                   "= %g; correct one of them",
                   path, voltage, low, high);
        return false;
    }
    if (!(-robot->body.mass_kg < robot->limits.payload_kg[0] &&
          robot->limits.payload_kg[0] <= robot->limits.payload_kg[1])) {
        error_line("%s: limits.payload_kg = [%g, %g]: the second must not be below the first, and a mass of %g kg must "
                   "be left; correct them",
                   path, robot->limits.payload_kg[0], robot->limits.payload_kg[1], robot->body.mass_kg);
        return false;
    }
    struct plant plant;
    plant_init(&plant, robot);
    const double fastest = plant_damping_rate(&plant.constants);
    if (fastest > PLANT_STEP_RATE_MAX * robot->control.rate_hz) {
        error_line("%s: control.rate_hz = %d: the robot's fastest mode, %.0f 1/s, cannot be simulated at this rate; "
                   "raise it, or correct the masses, motor and frictions",
                   path, robot->control.rate_hz, fastest);
        return false;
    }
    return true;
}

/* What is left out that the simulator needs. */
static void complete(struct robot_file *robot)
{
    const double mass = robot->body.mass_kg + 2 * robot->wheel.mass_kg;

    if (isnan(robot->limits.payload_kg[0])) {
        robot->limits.payload_kg[0] = PAYLOAD_LEAST * mass;
        robot->limits.payload_kg[1] = PAYLOAD_MOST * mass;
    }
}

bool robot_file_check(const char *source, const struct robot_file *robot)
{
    return config_fields_check(source, &robot_kind, robot) && check_together(source, robot);
}

bool robot_file_load(const char *path, struct robot_file *robot)
{
    *robot = (struct robot_file){0};
    config_fields_leave_out(&robot_kind, robot);
    if (!config_fields_load(path, &robot_kind, robot)) {
        return false;
    }
    complete(robot);
    return check_together(path, robot);
}
