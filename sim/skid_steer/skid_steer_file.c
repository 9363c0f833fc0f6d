#include <math.h>

#include "sim/base/error.h"
#include "sim/files/config_fields.h"
#include "sim/skid_steer/skid_steer_model.h"

#define RADIANS_PER_DEGREE (3.14159265358979323846 / 180)

#define FIELD(key, member, min, max, unit)                                                                             \
    {                                                                                                                  \
        key, offsetof(struct skid_steer_model, member), 1, CONFIG_FIELD_REAL, min, max, unit, false                    \
    }

/* What such a robot can be; what the core's formats hold of it, tools/design/lattice.py checks. */
static const struct config_field fields[] = {
    FIELD("body.length_m", body.length_m, 0.001, 100, "m"),
    FIELD("body.width_m", body.width_m, 0.001, 100, "m"),
    FIELD("body.wheelbase_m", body.wheelbase_m, 0.0005, 100, "m"),
    FIELD("body.mass_kg", body.mass_kg, 0.001, 100000, "kg"),
    FIELD("wheel.radius_m", wheel.radius_m, 0.0005, 5, "m"),
    FIELD("motor.torque_constant_nm_per_a", motor.torque_constant, 1e-6, 100, "N·m/A"),
    FIELD("motor.resistance_ohm", motor.resistance_ohm, 0.001, 100, "Ω"),
    FIELD("motor.gear_ratio", motor.gear_ratio, 0.1, 2000, "1"),
    FIELD("motor.efficiency", motor.efficiency, 0.1, 1, "1"),
    FIELD("motor.power_w", motor.power_w, 0.001, 1e6, "W"),
    FIELD("motor.recuperation", motor.recuperation, 0, 1, "1"),
    FIELD("ground.friction", ground.friction, 0, 2, "1"),
    FIELD("ground.rolling", ground.rolling, 0.001, 0.5, "1"),
    FIELD("electronics.power_w", electronics.power_w, 0.0001, 100000, "W"),
    FIELD("supply.voltage_v", supply.voltage_v, 0.1, 10000, "V"),
    FIELD("limits.speed_m_s", limits.speed_m_s, 0.001, 8, "m/s"),
    FIELD("limits.slope_deg", limits.slope_deg, 1, 45, "°"),
    FIELD("lattice.speed_m_s", lattice.speed_m_s, 0.001, 8, "m/s"),
    FIELD("lattice.turn_rate_rad_s", lattice.turn_rate_rad_s, 0.01, 8, "rad/s"),
    FIELD("lattice.distance_j_per_m", lattice.distance_j_per_m, 0, 1024, "J/m"),
};

static const struct config_kind kind = {"skid_steer", offsetof(struct skid_steer_model, name), fields,
                                        sizeof fields / sizeof fields[0]};

/* What no single field shows: the motors can do what the limits promise. */
static bool check_together(const char *path, const struct skid_steer_model *model)
{
    const struct skid_steer_motion climb = {model->limits.speed_m_s, 0,
                                            tan(model->limits.slope_deg * RADIANS_PER_DEGREE)};
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

bool skid_steer_load(const char *path, struct skid_steer_model *model)
{
    *model = (struct skid_steer_model){0};
    return config_fields_load(path, &kind, model) && check_together(path, model);
}
