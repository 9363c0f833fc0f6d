#include "sim/missions/scenario.h"

#include <libgen.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/base/error.h"
#include "sim/base/strict_math.h"
#include "sim/files/config_fields.h"
#include "sim/files/config_file.h"

#define PATH_SIZE  1024
#define COORDINATE 10000.0

/** Waypoints nearer than this, m, coincide. */
#define DISTANCE_MIN 0.01

/* As the file has it. */
struct texts {
    char name[SCENARIO_NAME_SIZE];
    char robot[PATH_SIZE];
    char model[SCENARIO_NAME_SIZE];
    char energy[SCENARIO_NAME_SIZE];
    char end[SCENARIO_NAME_SIZE];
    int seed;
    double within_seconds;
    double within_joules;
};

#define TEXT(key, member, is_optional)                                                                                 \
    {                                                                                                                  \
        key, offsetof(struct texts, member), sizeof((struct texts *)0)->member, CONFIG_FIELD_TEXT, 0, 0, "",           \
            is_optional                                                                                                \
    }

#define BUDGET(key, member, most, unit)                                                                                \
    {                                                                                                                  \
        key, offsetof(struct texts, member), 1, CONFIG_FIELD_REAL, 0.001, most, unit, true                             \
    }

static const struct config_field fields[] = {
    TEXT("name", name, false),
    TEXT("robot", robot, false),
    TEXT("energy_model", model, false),
    TEXT("energy", energy, true),
    TEXT("end", end, true),
    {"seed", offsetof(struct texts, seed), 1, CONFIG_FIELD_WHOLE, 0, 1e9, "1", false},
    BUDGET("within_seconds", within_seconds, 32767, "s"),
    BUDGET("within_joules", within_joules, 1e9, "J"),
    {"waypoints", 0, BEZIER_WAYPOINTS_MAX, CONFIG_FIELD_LIST, 0, 0, "m", false},
};

static const struct config_kind kind = {NULL, 0, fields, sizeof fields / sizeof fields[0]};

static bool load_robot_of_a_kind(const char *path, struct scenario *scenario)
{
    char type[CONFIG_NAME_SIZE];

    if (!config_fields_type(path, type)) {
        return false;
    }
    if (strcmp(type, CONFIG_BALANCER) == 0) {
        return robot_file_load(path, &scenario->robot);
    }
    if (strcmp(type, skid_steer_kind.type) == 0 || strcmp(type, differential_drive_kind.type) == 0) {
        scenario->kind = SCENARIO_SKID;
        return skid_robot_load(path, &scenario->skid);
    }
    config_fields_refuse_type(path, type, "balancer, a skid_steer or a differential_drive");
    return false;
}

/** The robot's path is relative to the scenario's folder. */
static bool load_robot(const char *path, const char *robot, struct scenario *scenario)
{
    char folder[PATH_SIZE];
    char robot_path[2 * PATH_SIZE];

    (void)snprintf(folder, sizeof folder, "%s", path);
    (void)snprintf(robot_path, sizeof robot_path, "%s%s%s", robot[0] == '/' ? "" : dirname(folder),
                   robot[0] == '/' ? "" : "/", robot);
    return load_robot_of_a_kind(robot_path, scenario);
}

static bool set_model(const char *path, const char *model, struct scenario *scenario)
{
    if (strcmp(model, "identified") != 0 && strcmp(model, "published") != 0) {
        error_line("%s: energy_model = \"%s\": must be \"identified\" or \"published\"; correct the value", path,
                   model);
        return false;
    }
    scenario->model = strcmp(model, "published") == 0 ? SCENARIO_PUBLISHED : SCENARIO_IDENTIFIED;
    return true;
}

static bool set_end(const char *path, const char *end, struct scenario *scenario)
{
    if (end[0] == '\0') {
        scenario->to_stand = scenario->kind == SCENARIO_SKID;
        return true;
    }
    if (strcmp(end, "segment") != 0 && strcmp(end, "stand") != 0) {
        error_line("%s: end = \"%s\": must be \"segment\" or \"stand\"; correct the value", path, end);
        return false;
    }
    scenario->to_stand = strcmp(end, "stand") == 0;
    return true;
}

static bool set_energy(const char *path, const char *energy, struct scenario *scenario)
{
    if (energy[0] == '\0') {
        scenario->energy = scenario->kind == SCENARIO_SKID ? ENERGY_BATTERY : ENERGY_MOTOR;
        return true;
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

static bool set_budget(const char *path, const struct texts *texts, struct scenario *scenario)
{
    if (texts->within_seconds > 0 && texts->within_joules > 0) {
        error_line("%s: within_joules: there is within_seconds, too; leave one of them out", path);
        return false;
    }
    scenario->within_seconds = texts->within_seconds;
    scenario->within_joules = texts->within_joules;
    return true;
}

/** What a waypoint is made of. */
enum { X, Y, HEADING, SPEED, NUMBERS };

static const struct {
    double least;
    double most;
} ranges[NUMBERS] = {
    [X] = {-COORDINATE, COORDINATE}, [Y] = {-COORDINATE, COORDINATE}, [HEADING] = {-360, 360}, [SPEED] = {0.01, 8}};

static bool read_waypoint(const config_setting_t *setting, unsigned count, double value[NUMBERS])
{
    bool is_good = count == 2 || count == 3 || count == 4;

    for (unsigned k = 0; is_good && k < count; k++) {
        is_good = config_file_number(config_setting_get_elem(setting, k), &value[k]) && value[k] >= ranges[k].least &&
                  value[k] <= ranges[k].most;
    }
    return is_good;
}

static bool load_waypoint(const char *path, const config_setting_t *setting, unsigned index, struct scenario *scenario)
{
    const unsigned count = (unsigned)config_setting_length(setting);
    struct jp_passage *passage = &scenario->passages[index];
    double value[NUMBERS] = {0};

    if (!read_waypoint(setting, count, value)) {
        error_line("%s: waypoints[%u] (line %u): must be two numbers within ±%g m, which a heading within ±%g° and a "
                   "speed of %g to %g m/s may follow; write [x, y], [x, y, heading] or [x, y, heading, speed]",
                   path, index, config_setting_source_line(setting), COORDINATE, ranges[HEADING].most,
                   ranges[SPEED].least, ranges[SPEED].most);
        return false;
    }
    if (index == 0 && count > 2) {
        error_line("%s: waypoints[0]: the robot starts at a stand, looking along x; write [0.0, 0.0]", path);
        return false;
    }
    scenario->waypoints[index] = (struct bezier_point){value[X], value[Y]};
    if (count > HEADING) {
        passage->given |= JP_GIVEN_HEADING;
        passage->heading = (jp_angle)llround(value[HEADING] / 360 * 4294967296.0);
    }
    if (count > SPEED) {
        passage->given |= JP_GIVEN_SPEED;
        passage->speed = (jp_q24)lround(value[SPEED] * JP_Q24_ONE);
    }
    return true;
}

static bool check_distance(const char *path, const struct scenario *scenario, unsigned index)
{
    const struct bezier_point *a = &scenario->waypoints[index - 1];
    const struct bezier_point *b = &scenario->waypoints[index];
    double distance = strict_hypot(b->x - a->x, b->y - a->y);

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
        if (!load_waypoint(path, config_setting_get_elem(list, i), i, scenario) ||
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

/** What only balancers do. */
static bool suits_kind(const char *path, const struct scenario *scenario)
{
    const char *wrong = NULL;

    if (scenario->kind == SCENARIO_BALANCER) {
        return true;
    }
    if (scenario->model == SCENARIO_PUBLISHED) {
        wrong = "energy_model = \"published\"";
    } else if (scenario->energy != ENERGY_BATTERY) {
        wrong = "energy = \"motor\"";
    } else if (!scenario->to_stand) {
        wrong = "end = \"segment\"";
    } else if (scenario->within_seconds > 0 || scenario->within_joules > 0) {
        wrong = "a budget";
    }
    for (size_t i = 0; wrong == NULL && i < scenario->waypoint_count; i++) {
        wrong = scenario->passages[i].given == 0 ? NULL : "a heading at a waypoint";
    }
    if (wrong != NULL) {
        error_line("%s: %s is for balancers, and %s is none; leave it out", path, wrong, scenario->skid.name);
    }
    return wrong == NULL;
}

static bool load(const char *path, config_t *config, struct scenario *scenario)
{
    struct texts texts = {.within_seconds = 0};

    if (!config_file_parse(path, config) || !config_fields_read(path, config, &kind, &texts) ||
        !load_robot(path, texts.robot, scenario) || !set_model(path, texts.model, scenario) ||
        !set_energy(path, texts.energy, scenario) || !set_end(path, texts.end, scenario) ||
        !set_budget(path, &texts, scenario) || !load_waypoints(path, config, scenario) || !suits_kind(path, scenario)) {
        return false;
    }
    memcpy(scenario->name, texts.name, sizeof scenario->name);
    scenario->seed = (uint64_t)texts.seed;
    return true;
}

bool scenario_load(const char *path, struct scenario *scenario)
{
    config_t config;

    config_init(&config);
    *scenario = (struct scenario){0};

    const bool loaded = load(path, &config, scenario);

    config_destroy(&config);
    return loaded;
}

bool scenario_load_balancer(const char *path, struct scenario *scenario)
{
    if (!scenario_load(path, scenario)) {
        return false;
    }
    if (scenario->kind != SCENARIO_BALANCER) {
        error_line("%s: %s is no balancer, which this program is for; drive it with jp-mission", path,
                   scenario->skid.name);
        return false;
    }
    return true;
}

struct scenario_robot scenario_robot(const struct scenario *scenario)
{
    const struct robot_file *balancer = &scenario->robot;
    const struct skid_steer_model *skid = &scenario->skid;

    return scenario->kind == SCENARIO_SKID
               ? (struct scenario_robot){skid->name, skid->control.rate_hz, skid->electronics.power_w}
               : (struct scenario_robot){balancer->name, balancer->control.rate_hz, balancer->electronics.power_w};
}
