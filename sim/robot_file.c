#include "robot_file.h"

#include <ctype.h>
#include <errno.h>
#include <libconfig.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "config_file.h"
#include "error.h"
#include "plant.h"

#define FIELD(member) offsetof(struct robot_file, member)
#define REAL(key, member, min, max, unit)                                                                              \
    {                                                                                                                  \
        key, FIELD(member), 1, ROBOT_FIELD_REAL, min, max, unit                                                        \
    }
#define WHOLE(key, member, min, max, unit)                                                                             \
    {                                                                                                                  \
        key, FIELD(member), 1, ROBOT_FIELD_WHOLE, min, max, unit                                                       \
    }

const struct robot_field robot_fields[] = {
    REAL("body.mass_kg", body.mass_kg, 0.05, 200, "kg"),
    REAL("body.width_m", body.width_m, 0.02, 2, "m"),
    REAL("body.depth_m", body.depth_m, 0.001, 2, "m"),
    REAL("body.centre_height_m", body.centre_height_m, 0.01, 2, "m"),
    REAL("wheel.radius_m", wheel.radius_m, 0.01, 1, "m"),
    REAL("wheel.mass_kg", wheel.mass_kg, 0.001, 20, "kg"),
    REAL("motor.resistance_ohm", motor.resistance_ohm, 0.01, 256, "Ω"),
    REAL("motor.torque_constant_nm_per_a", motor.torque_constant, 1e-4, 10, "N·m/A"),
    REAL("motor.back_emf_v_s_per_rad", motor.back_emf, 1e-4, 10, "V·s/rad"),
    REAL("motor.gear_ratio", motor.gear_ratio, 0.1, 1000, "1"),
    REAL("motor.rotor_inertia_kg_m2", motor.rotor_inertia_kg_m2, 0, 0.1, "kg·m²"),
    REAL("motor.friction_nm_s_per_rad", motor.friction, 0, 10, "N·m·s/rad"),
    REAL("ground.friction_nm_s_per_rad", ground.friction, 0, 10, "N·m·s/rad"),
    REAL("electronics.power_w", electronics.power_w, 0.001, 256, "W"),
    REAL("supply.voltage_v", supply.voltage_v, 1, 1000, "V"),
    REAL("supply.resistance_ohm", supply.resistance_ohm, 0, 10, "Ω"),
    REAL("supply.capacity_wh", supply.capacity_wh, 0.1, 250, "Wh"),
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
    REAL("current_sense.full_scale_a", current_sense.full_scale_a, 0.01, 32767, "A"),
    REAL("current_sense.noise_rms_a", current_sense.noise_rms_a, 0, 100, "A"),
    WHOLE("bus_sense.bits", bus_sense.bits, 0, 24, "bit"),
    REAL("bus_sense.full_scale_v", bus_sense.full_scale_v, 0.1, 32767, "V"),
    WHOLE("control.rate_hz", control.rate_hz, 100, 20000, "Hz"),
    {"control.weights", FIELD(control.weights), ROBOT_WEIGHTS, ROBOT_FIELD_REAL, 0, 1e12, "1"},
    REAL("control.input_weight", control.input_weight, 1e-9, 1e12, "1/V²"),
    REAL("control.travel_shaping_s", control.travel_shaping_s, 0, 60, "s"),
    REAL("control.yaw_shaping_s", control.yaw_shaping_s, 0, 60, "s"),
    REAL("control.encoder_bandwidth_rad_s", control.encoder_bandwidth_rad_s, 0, 10000, "rad/s"),
    REAL("control.tilt_time_constant_s", control.tilt_time_constant_s, 0, 1000, "s"),
    REAL("control.bias_time_constant_s", control.bias_time_constant_s, 0, 10000, "s"),
    REAL("control.pitch_reserve_share", control.pitch_reserve_share, 0, 1, "1"),
    REAL("control.tilt_limit_deg", control.tilt_limit_deg, 1, 75, "°"),
    WHOLE("control.freeze_ticks", control.freeze_ticks, 0, 65535, "tick"),
    REAL("control.gyro_jump_dps", control.gyro_jump_dps, 0, 45000, "°/s"),
    REAL("control.current_residual_a", control.current_residual_a, 0, 32767, "A"),
    REAL("control.voltage_min_v", control.voltage_min_v, 0, 1000, "V"),
    REAL("control.voltage_max_v", control.voltage_max_v, 0, 1000, "V"),
    REAL("limits.speed_m_s", limits.speed_m_s, 0.01, 8, "m/s"),
    REAL("limits.turn_rate_rad_s", limits.turn_rate_rad_s, 0.01, 8, "rad/s"),
    REAL("limits.turn_deg", limits.turn_deg, 0, 180, "°"),
    REAL("limits.duration_s", limits.duration_s, 0.1, 16384, "s"),
};

const size_t robot_field_count = sizeof robot_fields / sizeof robot_fields[0];

void robot_field_label(const struct robot_field *field, size_t index, char label[ROBOT_LABEL_SIZE])
{
    if (field->count > 1) {
        (void)snprintf(label, ROBOT_LABEL_SIZE, "%s[%zu]", field->key, index);
    } else {
        (void)snprintf(label, ROBOT_LABEL_SIZE, "%s", field->key);
    }
}

double robot_field_value(const struct robot_file *robot, const struct robot_field *field, size_t index)
{
    const char *base = (const char *)robot + field->offset;
    if (field->type == ROBOT_FIELD_WHOLE) {
        int whole;
        memcpy(&whole, base + index * sizeof whole, sizeof whole);
        return whole;
    }
    double real;
    memcpy(&real, base + index * sizeof real, sizeof real);
    return real;
}

static void store(struct robot_file *robot, const struct robot_field *field, size_t index, double value)
{
    char *base = (char *)robot + field->offset;
    if (field->type == ROBOT_FIELD_WHOLE) {
        const int whole = (int)value;
        memcpy(base + index * sizeof whole, &whole, sizeof whole);
    } else {
        memcpy(base + index * sizeof value, &value, sizeof value);
    }
}

/* Levenshtein's distance; keys longer than the table count as far apart. */
static size_t edit_distance(const char *a, const char *b)
{
    enum { LENGTH_MAX = 64 };
    const size_t length = strlen(b);
    size_t row[LENGTH_MAX + 1];
    if (length > LENGTH_MAX) {
        return SIZE_MAX;
    }
    for (size_t j = 0; j <= length; j++) {
        row[j] = j;
    }
    for (size_t i = 0; a[i] != '\0'; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < length; j++) {
            const size_t replaced = diagonal + (a[i] != b[j]);
            const size_t shorter = (row[j] < row[j + 1] ? row[j] : row[j + 1]) + 1;
            diagonal = row[j + 1];
            row[j + 1] = replaced < shorter ? replaced : shorter;
        }
    }
    return row[length];
}

static const char *nearest_key(const char *key)
{
    const char *nearest = "name";
    size_t least = edit_distance(key, nearest);
    for (size_t i = 0; i < robot_field_count; i++) {
        const size_t distance = edit_distance(key, robot_fields[i].key);
        if (distance < least) {
            least = distance;
            nearest = robot_fields[i].key;
        }
    }
    return nearest;
}

static bool is_key(const char *key)
{
    for (size_t i = 0; i < robot_field_count; i++) {
        if (strcmp(key, robot_fields[i].key) == 0) {
            return true;
        }
    }
    return strcmp(key, "name") == 0;
}

static bool is_group(const char *key)
{
    const size_t length = strlen(key);
    for (size_t i = 0; i < robot_field_count; i++) {
        if (strncmp(key, robot_fields[i].key, length) == 0 && robot_fields[i].key[length] == '.') {
            return true;
        }
    }
    return false;
}

/* One setting of the file: known, and a group exactly where one belongs. */
static bool check_setting(const char *path, config_setting_t *setting, const char *key)
{
    const unsigned line = config_setting_source_line(setting);
    if (is_group(key)) {
        if (config_setting_is_group(setting)) {
            return true;
        }
        error_line("%s: %s (line %u): must be a group; write %s: { … };", path, key, line, key);
        return false;
    }
    if (is_key(key)) {
        return true;
    }
    error_line("%s: %s (line %u): unknown key; remove it, or write %s", path, key, line, nearest_key(key));
    return false;
}

static bool check_keys(const char *path, config_setting_t *root)
{
    for (int i = 0; i < config_setting_length(root); i++) {
        config_setting_t *group = config_setting_get_elem(root, (unsigned)i);
        const char *name = config_setting_name(group);
        if (!check_setting(path, group, name)) {
            return false;
        }
        for (int j = 0; is_group(name) && j < config_setting_length(group); j++) {
            config_setting_t *setting = config_setting_get_elem(group, (unsigned)j);
            char key[128];
            (void)snprintf(key, sizeof key, "%s.%s", name, config_setting_name(setting));
            if (!check_setting(path, setting, key)) {
                return false;
            }
        }
    }
    return true;
}

/* `source` says where the value comes from. */
static bool check_value(const char *source, const struct robot_field *field, size_t index, double value)
{
    const char *kind = field->type == ROBOT_FIELD_WHOLE ? "a whole number" : "a number";
    const bool fits = field->type == ROBOT_FIELD_REAL || value == floor(value);
    if (fits && value >= field->min && value <= field->max) {
        return true;
    }
    char key[ROBOT_LABEL_SIZE];
    robot_field_label(field, index, key);
    error_line("%s: %s = %.10g: must be %s from %.10g to %.10g %s; correct the value", source, key, value, kind,
               field->min, field->max, field->unit);
    return false;
}

static bool load_element(const char *path, struct robot_file *robot, const struct robot_field *field,
                         config_setting_t *setting, size_t index)
{
    double value;
    if (!config_file_number(setting, &value)) {
        char key[ROBOT_LABEL_SIZE];
        robot_field_label(field, index, key);
        error_line("%s: %s (line %u): must be %s in %s; correct the value", path, key,
                   config_setting_source_line(setting),
                   field->type == ROBOT_FIELD_WHOLE ? "a whole number" : "a number", field->unit);
        return false;
    }
    if (!check_value(path, field, index, value)) {
        return false;
    }
    store(robot, field, index, value);
    return true;
}

static bool load_field(const char *path, struct robot_file *robot, const struct robot_field *field,
                       const config_t *config)
{
    config_setting_t *setting = config_lookup(config, field->key);
    if (setting == NULL) {
        error_line("%s: %s: missing; add it, %.10g to %.10g %s", path, field->key, field->min, field->max, field->unit);
        return false;
    }
    if (field->count == 1) {
        return load_element(path, robot, field, setting, 0);
    }
    if (!(config_setting_is_array(setting) || config_setting_is_list(setting)) ||
        config_setting_length(setting) != (int)field->count) {
        error_line("%s: %s (line %u): must be an array of %zu numbers; write [a, b, …]", path, field->key,
                   config_setting_source_line(setting), field->count);
        return false;
    }
    for (size_t i = 0; i < field->count; i++) {
        if (!load_element(path, robot, field, config_setting_get_elem(setting, (unsigned)i), i)) {
            return false;
        }
    }
    return true;
}

static bool load_name(const char *path, struct robot_file *robot, const config_t *config)
{
    const char *name;
    if (config_lookup_string(config, "name", &name) != CONFIG_TRUE) {
        error_line("%s: name: missing or no text; add name = \"…\";", path);
        return false;
    }
    const size_t length = strlen(name);
    const char *allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
    if (length == 0 || length >= ROBOT_NAME_SIZE || strspn(name, allowed) != length) {
        error_line("%s: name = \"%s\": must be 1 to %d letters, digits, '_', '-' or '.'; correct the name", path, name,
                   ROBOT_NAME_SIZE - 1);
        return false;
    }
    memcpy(robot->name, name, length + 1);
    return true;
}

/* What no single field shows. */
static bool check_together(const char *path, const struct robot_file *robot)
{
    const double low = robot->control.voltage_min_v;
    const double high = robot->control.voltage_max_v;
    const double voltage = robot->supply.voltage_v;
    if (!(low < voltage && voltage < high)) {
        error_line("%s: supply.voltage_v = %g: must lie between control.voltage_min_v = %g and control.voltage_max_v "
                   "= %g; correct one of them",
                   path, voltage, low, high);
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

bool robot_file_check(const char *source, const struct robot_file *robot)
{
    for (size_t i = 0; i < robot_field_count; i++) {
        for (size_t j = 0; j < robot_fields[i].count; j++) {
            if (!check_value(source, &robot_fields[i], j, robot_field_value(robot, &robot_fields[i], j))) {
                return false;
            }
        }
    }
    return check_together(source, robot);
}

static bool load(const char *path, struct robot_file *robot, config_t *config)
{
    if (!config_file_parse(path, config) || !check_keys(path, config_root_setting(config)) ||
        !load_name(path, robot, config)) {
        return false;
    }
    for (size_t i = 0; i < robot_field_count; i++) {
        if (!load_field(path, robot, &robot_fields[i], config)) {
            return false;
        }
    }
    return check_together(path, robot);
}

bool robot_file_load(const char *path, struct robot_file *robot)
{
    config_t config;
    config_init(&config);
    *robot = (struct robot_file){0};
    const bool loaded = load(path, robot, &config);
    config_destroy(&config);
    return loaded;
}
