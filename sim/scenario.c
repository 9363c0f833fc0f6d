#include "scenario.h"

#include <libgen.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "config_file.h"
#include "error.h"

#define PATH_SIZE  1024
#define COORDINATE 10000.0

/** Waypoints nearer than this, m, coincide. */
#define DISTANCE_MIN 0.01

static const char *const keys[] = {"name", "robot", "energy_model", "energy", "seed", "waypoints"};

static bool check_keys(const char *path, const config_setting_t *root)
{
    for (int i = 0; i < config_setting_length(root); i++) {
        const config_setting_t *setting = config_setting_get_elem(root, (unsigned)i);
        bool known = false;

        for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++) {
            known = known || strcmp(keys[k], config_setting_name(setting)) == 0;
        }
        if (!known) {
            error_line("%s: %s (line %u): unknown key; the keys are name, robot, energy_model, energy, seed, waypoints",
                       path, config_setting_name(setting), config_setting_source_line(setting));
            return false;
        }
    }
    return true;
}

static bool text(const char *path, const config_t *config, const char *key, size_t size, const char **value)
{
    if (config_lookup_string(config, key, value) == CONFIG_TRUE && (*value)[0] != '\0' && strlen(*value) < size) {
        return true;
    }
    error_line("%s: %s: missing or no text of 1 to %zu characters; add %s = \"…\";", path, key, size - 1, key);
    return false;
}

static bool load_name(const char *path, const config_t *config, struct scenario *scenario)
{
    const char *name;

    if (!text(path, config, "name", SCENARIO_NAME_SIZE, &name)) {
        return false;
    }
    memcpy(scenario->name, name, strlen(name) + 1);
    return true;
}

/** The robot's path is relative to the scenario's folder. */
static bool load_robot(const char *path, const config_t *config, struct scenario *scenario)
{
    char folder[PATH_SIZE];
    char robot_path[2 * PATH_SIZE];
    const char *robot;

    if (!text(path, config, "robot", PATH_SIZE, &robot)) {
        return false;
    }
    (void)snprintf(folder, sizeof folder, "%s", path);
    (void)snprintf(robot_path, sizeof robot_path, "%s%s%s", robot[0] == '/' ? "" : dirname(folder),
                   robot[0] == '/' ? "" : "/", robot);
    return robot_file_load(robot_path, &scenario->robot);
}

static bool load_model(const char *path, const config_t *config, struct scenario *scenario)
{
    const char *model;

    if (!text(path, config, "energy_model", SCENARIO_NAME_SIZE, &model)) {
        return false;
    }
    if (strcmp(model, "identified") != 0 && strcmp(model, "published") != 0) {
        error_line("%s: energy_model = \"%s\": must be \"identified\" or \"published\"; correct the value", path,
                   model);
        return false;
    }
    scenario->model = strcmp(model, "published") == 0 ? SCENARIO_PUBLISHED : SCENARIO_IDENTIFIED;
    return true;
}

/** Optional: without it the paper's. */
static bool load_energy(const char *path, const config_t *config, struct scenario *scenario)
{
    const char *energy;

    if (config_lookup(config, "energy") == NULL) {
        return true;
    }
    if (!text(path, config, "energy", SCENARIO_NAME_SIZE, &energy)) {
        return false;
    }
    if (!energy_kind_parse(energy, &scenario->energy)) {
        error_line("%s: energy = \"%s\": must be \"motor\" or \"battery\"; correct the value", path, energy);
        return false;
    }
    if (scenario->energy == ENERGY_BATTERY && scenario->model == SCENARIO_PUBLISHED) {
        error_line("%s: energy = \"battery\": the published model is of the motors' energy; choose energy_model = "
                   "\"identified\"",
                   path);
        return false;
    }
    return true;
}

static bool load_seed(const char *path, const config_t *config, struct scenario *scenario)
{
    const config_setting_t *setting = config_lookup(config, "seed");
    double seed;

    if (setting == NULL || !config_file_number(setting, &seed) || !(seed >= 0 && seed <= 1e9) || seed != floor(seed)) {
        error_line("%s: seed: must be a whole number from 0 to 1000000000; add seed = 1;", path);
        return false;
    }
    scenario->seed = (uint64_t)seed;
    return true;
}

static bool load_waypoint(const char *path, const config_setting_t *setting, unsigned index,
                          struct bezier_point *waypoint)
{
    double value[2];

    for (unsigned k = 0; k < 2; k++) {
        const config_setting_t *number =
            config_setting_length(setting) == 2 ? config_setting_get_elem(setting, k) : NULL;

        if (number == NULL || !config_file_number(number, &value[k]) || !(fabs(value[k]) <= COORDINATE)) {
            error_line("%s: waypoints[%u] (line %u): must be two numbers within ±%g m; write [x, y]", path, index,
                       config_setting_source_line(setting), COORDINATE);
            return false;
        }
    }
    *waypoint = (struct bezier_point){value[0], value[1]};
    return true;
}

static bool check_distance(const char *path, const struct scenario *scenario, unsigned index)
{
    const struct bezier_point *a = &scenario->waypoints[index - 1];
    const struct bezier_point *b = &scenario->waypoints[index];
    double distance = hypot(b->x - a->x, b->y - a->y);

    if (distance < DISTANCE_MIN) {
        error_line("%s: waypoints[%u]: coincides with the one before it; remove one of them", path, index);
        return false;
    }
    if (distance > (double)JP_SEGMENT_LENGTH_MAX / JP_Q16_ONE) {
        error_line("%s: waypoints[%u]: %.0f m from the one before it, at most %d m are possible; add one between", path,
                   index, distance, JP_SEGMENT_LENGTH_MAX / JP_Q16_ONE);
        return false;
    }
    return true;
}

static bool load_waypoints(const char *path, const config_t *config, struct scenario *scenario)
{
    const config_setting_t *list = config_lookup(config, "waypoints");
    int count = list == NULL ? 0 : config_setting_length(list);

    if (count < 2 || count > BEZIER_WAYPOINTS_MAX) {
        error_line("%s: waypoints: must be a list of 2 to %d points; write ( [0.0, 0.0], [x, y] )", path,
                   BEZIER_WAYPOINTS_MAX);
        return false;
    }
    scenario->waypoint_count = (size_t)count;
    for (unsigned i = 0; i < (unsigned)count; i++) {
        if (!load_waypoint(path, config_setting_get_elem(list, i), i, &scenario->waypoints[i]) ||
            (i > 0 && !check_distance(path, scenario, i))) {
            return false;
        }
    }
    if (scenario->waypoints[0].x != 0 || scenario->waypoints[0].y != 0) {
        error_line("%s: waypoints[0]: odometry starts at [0.0, 0.0]; begin there and shift the others", path);
        return false;
    }
    return true;
}

bool scenario_load(const char *path, struct scenario *scenario)
{
    config_t config;

    config_init(&config);
    *scenario = (struct scenario){0};

    bool loaded = config_file_parse(path, &config) && check_keys(path, config_root_setting(&config)) &&
                  load_name(path, &config, scenario) && load_robot(path, &config, scenario) &&
                  load_model(path, &config, scenario) && load_energy(path, &config, scenario) &&
                  load_seed(path, &config, scenario) && load_waypoints(path, &config, scenario);

    config_destroy(&config);
    return loaded;
}
