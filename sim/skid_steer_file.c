#include <libconfig.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "config_file.h"
#include "error.h"
#include "skid_steer_model.h"

#define RADIANS_PER_DEGREE (3.14159265358979323846 / 180)

struct field {
    const char *key;
    size_t offset; /* of a double in struct skid_steer_model */
    double min;    /* inclusive */
    double max;
    const char *unit;
};

#define FIELD(key, member, min, max, unit)                                                                             \
    {                                                                                                                  \
        key, offsetof(struct skid_steer_model, member), min, max, unit                                                 \
    }

/* The core's formats hold every value (joulepath/skid_steer.h). */
static const struct field fields[] = {
    FIELD("body.length_m", body.length_m, 0.05, 4, "m"),
    FIELD("body.width_m", body.width_m, 0.05, 4, "m"),
    FIELD("body.wheelbase_m", body.wheelbase_m, 0.02, 4, "m"),
    FIELD("body.mass_kg", body.mass_kg, 0.5, 1000, "kg"),
    FIELD("wheel.radius_m", wheel.radius_m, 0.01, 1, "m"),
    FIELD("motor.torque_constant_nm_per_a", motor.torque_constant, 1e-4, 10, "N·m/A"),
    FIELD("motor.resistance_ohm", motor.resistance_ohm, 0.001, 100, "Ω"),
    FIELD("motor.gear_ratio", motor.gear_ratio, 0.1, 2000, "1"),
    FIELD("motor.efficiency", motor.efficiency, 0.1, 1, "1"),
    FIELD("motor.power_w", motor.power_w, 1, 20000, "W"),
    FIELD("motor.recuperation", motor.recuperation, 0, 1, "1"),
    FIELD("ground.friction", ground.friction, 0, 2, "1"),
    FIELD("ground.rolling", ground.rolling, 0.001, 0.5, "1"),
    FIELD("electronics.power_w", electronics.power_w, 0.01, 1000, "W"),
    FIELD("supply.voltage_v", supply.voltage_v, 1, 1000, "V"),
    FIELD("limits.speed_m_s", limits.speed_m_s, 0.01, 8, "m/s"),
    FIELD("limits.slope_deg", limits.slope_deg, 1, 45, "°"),
    FIELD("lattice.speed_m_s", lattice.speed_m_s, 0.01, 8, "m/s"),
    FIELD("lattice.turn_rate_rad_s", lattice.turn_rate_rad_s, 0.01, 8, "rad/s"),
    FIELD("lattice.distance_j_per_m", lattice.distance_j_per_m, 0, 1024, "J/m"),
};

static bool load_field(const char *path, const struct field *field, const config_t *config,
                       struct skid_steer_model *model)
{
    const config_setting_t *setting = config_lookup(config, field->key);
    double value;
    if (setting == NULL || !config_file_number(setting, &value)) {
        error_line("%s: %s: missing, or not a number; write %.10g to %.10g %s", path, field->key, field->min,
                   field->max, field->unit);
        return false;
    }
    if (!(value >= field->min && value <= field->max)) {
        error_line("%s: %s = %.10g: must be %.10g to %.10g %s; correct the value", path, field->key, value, field->min,
                   field->max, field->unit);
        return false;
    }
    memcpy((char *)model + field->offset, &value, sizeof value);
    return true;
}

static bool is_known(const char *group, const char *name)
{
    char key[64];
    (void)snprintf(key, sizeof key, "%s.%s", group, name);
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        if (strcmp(fields[i].key, key) == 0) {
            return true;
        }
    }
    return false;
}

/* All members of all groups are known, and beside the groups there are only the type and the name. */
static bool check_keys(const char *path, const config_t *config)
{
    const config_setting_t *root = config_root_setting(config);

    for (int i = 0; i < config_setting_length(root); i++) {
        const config_setting_t *group = config_setting_get_elem(root, (unsigned)i);
        const char *name = config_setting_name(group);
        if (!config_setting_is_group(group)) {
            if (strcmp(name, "type") == 0 || strcmp(name, "name") == 0) {
                continue;
            }
            error_line("%s: %s (line %u): unknown key; remove it", path, name, config_setting_source_line(group));
            return false;
        }
        for (int j = 0; j < config_setting_length(group); j++) {
            const config_setting_t *member = config_setting_get_elem(group, (unsigned)j);
            if (!is_known(name, config_setting_name(member))) {
                error_line("%s: %s.%s (line %u): unknown key; remove it", path, name, config_setting_name(member),
                           config_setting_source_line(member));
                return false;
            }
        }
    }
    return true;
}

static bool load_name(const char *path, const config_t *config, struct skid_steer_model *model)
{
    const char *type;
    const char *name;
    if (config_lookup_string(config, "type", &type) != CONFIG_TRUE || strcmp(type, "skid_steer") != 0) {
        error_line("%s: type: must be \"skid_steer\"; correct it, or give another robot file", path);
        return false;
    }
    if (config_lookup_string(config, "name", &name) != CONFIG_TRUE) {
        error_line("%s: name: missing, or no text; write name = \"…\";", path);
        return false;
    }
    const size_t length = strlen(name);
    if (length == 0 || length >= sizeof model->name ||
        strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789_") != length) {
        error_line("%s: name = \"%s\": must be 1 to %d small letters, digits or '_'; correct the name", path, name,
                   SKID_STEER_NAME_SIZE - 1);
        return false;
    }
    memcpy(model->name, name, length + 1);
    return true;
}

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

static bool load(const char *path, config_t *config, struct skid_steer_model *model)
{
    if (!config_file_parse(path, config) || !load_name(path, config, model) || !check_keys(path, config)) {
        return false;
    }
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        if (!load_field(path, &fields[i], config, model)) {
            return false;
        }
    }
    return check_together(path, model);
}

bool skid_steer_load(const char *path, struct skid_steer_model *model)
{
    config_t config;
    config_init(&config);
    *model = (struct skid_steer_model){0};
    const bool loaded = load(path, &config, model);
    config_destroy(&config);
    return loaded;
}
