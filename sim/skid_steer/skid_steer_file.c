#include <math.h>
#include <string.h>

#include "sim/base/error.h"
#include "sim/base/strict_math.h"
#include "sim/files/config_fields.h"
#include "sim/skid_steer/skid_plant.h"
#include "sim/skid_steer/skid_steer_model.h"

#define SKID_STEER         "skid_steer"
#define DIFFERENTIAL_DRIVE "differential_drive"

/* The plant's equations, 1/s: a control tick of a thousand steps at most. */
#define RATE_MAX 60000.0

#define RADIANS_PER_DEGREE (3.14159265358979323846 / 180)

#define FIELD(key, member, min, max, unit)                                                                             \
    {                                                                                                                  \
        key, offsetof(struct skid_steer_model, member), 1, CONFIG_FIELD_REAL, min, max, unit, false                    \
    }
#define WHOLE(key, member, min, max, unit)                                                                             \
    {                                                                                                                  \
        key, offsetof(struct skid_steer_model, member), 1, CONFIG_FIELD_WHOLE, min, max, unit, false                   \
    }

#define SETTING(key, member, min, max, unit)                                                                           \
    {                                                                                                                  \
        key, offsetof(struct skid_steer_model, member), 1, CONFIG_FIELD_REAL, min, max, unit, true                     \
    }

/* What such a robot can be; what the core's formats hold of it, tools/design/lattice.py checks. */
#define COMMON_FIELDS                                                                                                  \
    FIELD("body.length_m", body.length_m, 0.001, 100, "m"), FIELD("body.width_m", body.width_m, 0.001, 100, "m"),      \
        SETTING("body.overall_width_m", body.overall_width_m, 0.001, 100, "m"),                                        \
        SETTING("body.middle_ahead_m", body.middle_ahead_m, -50, 50, "m"),                                             \
        FIELD("body.mass_kg", body.mass_kg, 0.001, 100000, "kg"),                                                      \
        FIELD("body.centre_height_m", body.centre_height_m, 0, 10, "m"),                                               \
        FIELD("body.centre_ahead_m", body.centre_ahead_m, -50, 50, "m"),                                               \
        FIELD("body.yaw_inertia_kg_m2", body.yaw_inertia_kg_m2, 1e-9, 1e8, "kg·m²"),                                   \
        FIELD("wheel.radius_m", wheel.radius_m, 0.0005, 5, "m"),                                                       \
        FIELD("wheel.inertia_kg_m2", wheel.inertia_kg_m2, 0, 10000, "kg·m²"),                                          \
        FIELD("tyre.stiffness_per_m", tyre.stiffness_per_m, 10, 10000, "1/m"),                                         \
        FIELD("tyre.damping_s_per_m", tyre.damping_s_per_m, 0, 1000, "s/m"),                                           \
        FIELD("tyre.contact_length_m", tyre.contact_length_m, 0.0001, 2, "m"),                                         \
        FIELD("motor.torque_constant_nm_per_a", motor.torque_constant, 1e-6, 100, "N·m/A"),                            \
        FIELD("motor.resistance_ohm", motor.resistance_ohm, 0.001, 100, "Ω"),                                          \
        FIELD("motor.gear_ratio", motor.gear_ratio, 0.1, 2000, "1"),                                                   \
        FIELD("motor.efficiency", motor.efficiency, 0.1, 1, "1"),                                                      \
        FIELD("motor.power_w", motor.power_w, 0.001, 1e6, "W"),                                                        \
        FIELD("motor.recuperation", motor.recuperation, 0, 1, "1"),                                                    \
        FIELD("motor.rotor_inertia_kg_m2", motor.rotor_inertia_kg_m2, 1e-12, 100, "kg·m²"),                            \
        FIELD("motor.friction_nm", motor.friction_nm, 0, 10000, "N·m"),                                                \
        FIELD("motor.current_limit_a", motor.current_limit_a, 0.001, 2047, "A"),                                       \
        FIELD("ground.friction", ground.friction, 0.01, 2, "1"),                                                       \
        FIELD("ground.rolling", ground.rolling, 0.001, 0.5, "1"),                                                      \
        FIELD("electronics.power_w", electronics.power_w, 0.0001, 100000, "W"),                                        \
        FIELD("supply.voltage_v", supply.voltage_v, 0.1, 10000, "V"),                                                  \
        FIELD("supply.resistance_ohm", supply.resistance_ohm, 0, 1000, "Ω"),                                           \
        WHOLE("pwm.bits", pwm.bits, 0, 24, "bit"),                                                                     \
        WHOLE("encoder.counts_per_turn", encoder.counts_per_turn, 16, 16777216, "1/turn"),                             \
        FIELD("gyro.noise_rms_dps", gyro.noise_rms_dps, 0, 100, "°/s"),                                                \
        FIELD("gyro.bias_dps", gyro.bias_dps, -100, 100, "°/s"),                                                       \
        FIELD("gyro.scale_error", gyro.scale_error, -0.5, 0.5, "1"),                                                   \
        FIELD("gyro.step_dps", gyro.step_dps, 0, 10, "°/s"),                                                           \
        FIELD("gyro.full_scale_dps", gyro.full_scale_dps, 0, 45000, "°/s"),                                            \
        FIELD("accelerometer.noise_rms_g", accelerometer.noise_rms_g, 0, 1, "g"),                                      \
        FIELD("accelerometer.bias_g", accelerometer.bias_g, -1, 1, "g"),                                               \
        FIELD("accelerometer.scale_error", accelerometer.scale_error, -0.5, 0.5, "1"),                                 \
        FIELD("accelerometer.step_g", accelerometer.step_g, 0, 0.1, "g"),                                              \
        FIELD("accelerometer.full_scale_g", accelerometer.full_scale_g, 0, 127, "g"),                                  \
        WHOLE("current_sense.bits", current_sense.bits, 0, 24, "bit"),                                                 \
        FIELD("current_sense.full_scale_a", current_sense.full_scale_a, 0.001, 32767, "A"),                            \
        FIELD("current_sense.noise_rms_a", current_sense.noise_rms_a, 0, 100, "A"),                                    \
        WHOLE("bus_sense.bits", bus_sense.bits, 0, 24, "bit"),                                                         \
        FIELD("bus_sense.full_scale_v", bus_sense.full_scale_v, 0.1, 32767, "V"),                                      \
        WHOLE("control.rate_hz", control.rate_hz, 10, 20000, "Hz"),                                                    \
        FIELD("limits.speed_m_s", limits.speed_m_s, 0.001, 8, "m/s"),                                                  \
        FIELD("limits.slope_deg", limits.slope_deg, 1, 45, "°"),                                                       \
        FIELD("lattice.speed_m_s", lattice.speed_m_s, 0.001, 8, "m/s"),                                                \
        FIELD("lattice.turn_rate_rad_s", lattice.turn_rate_rad_s, 0.01, 8, "rad/s"),                                   \
        FIELD("lattice.distance_j_per_m", lattice.distance_j_per_m, 0, 1024, "J/m"),                                   \
        SETTING("navigation.cell_m", navigation.cell_m, 0.01, 10, "m"),                                                \
        SETTING("navigation.margin_m", navigation.margin_m, 0.001, 10, "m")

static const struct config_field skid_steer_fields[] = {
    COMMON_FIELDS,
    FIELD("body.wheelbase_m", body.wheelbase_m, 0.0005, 100, "m"),
    WHOLE("wheel.axles", wheel.axles, 2, SKID_STEER_AXLES_MAX, "1"),
};

static const struct config_field differential_drive_fields[] = {
    COMMON_FIELDS,
    FIELD("caster.ahead_m", caster.ahead_m, -50, 50, "m"),
    FIELD("caster.rolling", caster.rolling, 0.001, 0.5, "1"),
};

#define KIND(type, fields)                                                                                             \
    {                                                                                                                  \
        type, offsetof(struct skid_steer_model, name), fields, sizeof(fields) / sizeof(fields)[0]                      \
    }

const struct config_kind skid_steer_kind = KIND(SKID_STEER, skid_steer_fields);
const struct config_kind differential_drive_kind = KIND(DIFFERENTIAL_DRIVE, differential_drive_fields);

/* What no single field shows: the motors can do what the limits promise. */
static bool check_together(const char *path, const struct skid_steer_model *model)
{
    const struct skid_steer_motion climb = {model->limits.speed_m_s, 0,
                                            strict_tan(model->limits.slope_deg * RADIANS_PER_DEGREE)};
    const double volts = skid_steer_voltages(model, &climb).left;
    const double watts = (skid_steer_power(model, JP_COST_PHYSICAL, &climb) - model->electronics.power_w) / 2;

    if (volts > model->supply.voltage_v * (1 + 1e-6)) {
        error_line("%s: motor.gear_ratio = %.10g: %.3g m/s up %.3g° take %.4g V, supply.voltage_v is %.4g; correct one "
                   "of them",
                   path, model->motor.gear_ratio, climb.speed, model->limits.slope_deg, volts, model->supply.voltage_v);
        return false;
    }
    if (watts > model->motor.power_w) {
        error_line("%s: motor.power_w = %.4g: %.3g m/s up %.3g° take %.4g W; correct one of them", path,
                   model->motor.power_w, climb.speed, model->limits.slope_deg, watts);
        return false;
    }
    if (model->lattice.speed_m_s > model->limits.speed_m_s) {
        error_line("%s: lattice.speed_m_s = %.3g: must be at most limits.speed_m_s = %.3g; correct one of them", path,
                   model->lattice.speed_m_s, model->limits.speed_m_s);
        return false;
    }
    return true;
}

static bool check_stance(const char *path, const struct skid_steer_model *model)
{
    const struct planar_pose pose = {0, 0, 0};
    const struct skid_ground level = {NULL, NULL};
    const struct skid_slope rise = skid_slope_towards(model->limits.slope_deg, 0);
    const struct skid_slope fall = skid_slope_towards(-model->limits.slope_deg, 0);
    const struct skid_ground grounds[] = {level, skid_ground_slope(&rise), skid_ground_slope(&fall)};
    struct skid_plant plant;

    if (model->wheel.axles == 1 && model->caster.ahead_m == 0) {
        error_line("%s: caster.ahead_m = 0: must be ahead of the axle or, below 0, behind it; correct the value", path);
        return false;
    }
    for (size_t i = 0; i < sizeof grounds / sizeof grounds[0]; i++) {
        skid_plant_init(&plant, model, &grounds[i], &pose);
        if (plant.tipped) {
            error_line("%s: body.centre_height_m = %g, body.centre_ahead_m = %g: on %s it tips over; correct them or "
                       "limits.slope_deg",
                       path, model->body.centre_height_m, model->body.centre_ahead_m,
                       i == 0 ? "level ground" : "limits.slope_deg");
            return false;
        }
    }
    return true;
}

/* What the simulator needs. */
static bool check_plant(const char *path, const struct skid_steer_model *model)
{
    const double most = 2 * model->motor.current_limit_a * model->supply.voltage_v + model->electronics.power_w;
    const double rate = skid_plant_rate(model);

    if (4 * model->supply.resistance_ohm * most > model->supply.voltage_v * model->supply.voltage_v) {
        error_line("%s: supply.resistance_ohm = %g: the battery cannot give both motors their motor.current_limit_a; "
                   "correct one of them",
                   path, model->supply.resistance_ohm);
        return false;
    }
    if (rate > RATE_MAX) {
        error_line("%s: the robot's fastest mode, %.0f 1/s, cannot be simulated; correct the masses, inertias, tyre, "
                   "ground.friction and limits.speed_m_s",
                   path, rate);
        return false;
    }
    return check_stance(path, model);
}

/* The outline is that of the tracks, and its middle that of the axles, where the file says nothing else. */
static void complete_outline(struct skid_steer_model *model)
{
    if (isnan(model->body.overall_width_m)) {
        model->body.overall_width_m = model->body.width_m;
    }
    if (isnan(model->body.middle_ahead_m)) {
        model->body.middle_ahead_m = 0;
    }
}

static bool load(const char *path, const struct config_kind *kind, struct skid_steer_model *model)
{
    config_fields_leave_out(kind, model);
    if (!config_fields_load(path, kind, model)) {
        return false;
    }
    complete_outline(model);
    return check_together(path, model) && check_plant(path, model);
}

bool skid_steer_load(const char *path, struct skid_steer_model *model)
{
    *model = (struct skid_steer_model){0};
    return load(path, &skid_steer_kind, model);
}

bool differential_drive_load(const char *path, struct skid_steer_model *model)
{
    *model = (struct skid_steer_model){.wheel = {.axles = 1}};
    return load(path, &differential_drive_kind, model);
}

bool skid_robot_load(const char *path, struct skid_steer_model *model)
{
    char type[CONFIG_NAME_SIZE];

    if (!config_fields_type(path, type)) {
        return false;
    }
    if (strcmp(type, SKID_STEER) == 0) {
        return skid_steer_load(path, model);
    }
    if (strcmp(type, DIFFERENTIAL_DRIVE) == 0) {
        return differential_drive_load(path, model);
    }
    config_fields_refuse_type(path, type, SKID_STEER " or a " DIFFERENTIAL_DRIVE);
    return false;
}
