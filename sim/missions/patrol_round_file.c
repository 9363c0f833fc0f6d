#include "sim/missions/patrol_round_file.h"

#include <math.h>

#include "hal/can/round_code.h"
#include "sim/base/error.h"
#include "sim/files/config_fields.h"
#include "sim/files/config_file.h"
#include "sim/scenes/patrol_scene.h"

#define COORDINATE 10000.0
#define RADIANS    (M_PI / 180)

#define OFFSET(member) offsetof(struct patrol_round_file, member)

static const struct config_field fields[] = {
    {"charger", OFFSET(charger), 3, CONFIG_FIELD_REAL, -COORDINATE, COORDINATE, "m, m, °", false},
    {"stops", 0, JP_PATROL_STOPS_MAX, CONFIG_FIELD_LIST, 0, 0, "m", false},
    {"battery.full_j", OFFSET(full_j), 1, CONFIG_FIELD_REAL, 1, 1e8, "J", false},
    {"battery.reserve_j", OFFSET(reserve_j), 1, CONFIG_FIELD_REAL, 0, 1e8, "J", false},
    {"battery.charger_w", OFFSET(charger_w), 1, CONFIG_FIELD_REAL, 1, 1e5, "W", false},
    {"deviations", OFFSET(deviations), 1, CONFIG_FIELD_REAL, 0, 10, "1", false},
};

static const struct config_kind kind = {NULL, 0, fields, sizeof fields / sizeof fields[0]};

/* What a stop is made of. */
enum { X, Y, HEADING, DWELL, NUMBERS };

static const struct {
    double least;
    double most;
} ranges[NUMBERS] = {
    [X] = {-COORDINATE, COORDINATE}, [Y] = {-COORDINATE, COORDINATE}, [HEADING] = {-360, 360}, [DWELL] = {0, 86400}};

static bool read_stop(const config_setting_t *setting, double value[NUMBERS])
{
    bool is_good = config_setting_length(setting) == NUMBERS;

    for (unsigned k = 0; is_good && k < NUMBERS; k++) {
        is_good = config_file_number(config_setting_get_elem(setting, k), &value[k]) && value[k] >= ranges[k].least &&
                  value[k] <= ranges[k].most;
    }
    return is_good;
}

static bool load_stop(const char *path, const config_setting_t *setting, unsigned index, struct patrol_round_file *file)
{
    double value[NUMBERS];

    if (!read_stop(setting, value)) {
        error_line(
            "%s: stops[%u] (line %u): must be four numbers: x and y within ±%g m, a heading within ±%g°, and how "
            "long it stays, 0 to %g s; write [x, y, heading, stay]",
            path, index, config_setting_source_line(setting), COORDINATE, ranges[HEADING].most, ranges[DWELL].most);
        return false;
    }
    file->stops[index].pose = (struct planar_pose){value[X], value[Y], value[HEADING] * RADIANS};
    file->stops[index].dwell_s = value[DWELL];
    return true;
}

static bool load_stops(const char *path, const config_t *config, struct patrol_round_file *file)
{
    const config_setting_t *list = config_lookup(config, "stops");
    const int count = list == NULL ? 0 : config_setting_length(list);

    if (count < 1 || count > (int)JP_PATROL_STOPS_MAX) {
        error_line("%s: stops: must be a list of 1 to %u places; write ( [x, y, heading, stay], … )", path,
                   JP_PATROL_STOPS_MAX);
        return false;
    }
    file->stop_count = (unsigned)count;
    for (unsigned i = 0; i < file->stop_count; i++) {
        if (!load_stop(path, config_setting_get_elem(list, i), i, file)) {
            return false;
        }
    }
    return true;
}

static bool check(const char *path, const struct patrol_round_file *file)
{
    if (file->reserve_j >= file->full_j) {
        error_line("%s: battery.reserve_j = %g: must be less than battery.full_j = %g; correct one of them", path,
                   file->reserve_j, file->full_j);
        return false;
    }
    return true;
}

bool patrol_round_file_load(const char *path, struct patrol_round_file *file)
{
    config_t config;

    config_init(&config);
    *file = (struct patrol_round_file){.stop_count = 0};

    const bool is_loaded = config_file_parse(path, &config) && config_fields_read(path, &config, &kind, file) &&
                           load_stops(path, &config, file) && check(path, file);

    config_destroy(&config);
    return is_loaded;
}

struct planar_pose patrol_round_charger(const struct patrol_round_file *file)
{
    return (struct planar_pose){file->charger[0], file->charger[1], file->charger[2] * RADIANS};
}

struct jp_patrol_round_config patrol_round_config_of(const struct patrol_round_file *file,
                                                     const struct patrol_scene *scene)
{
    const struct planar_pose charger = patrol_round_charger(file);
    struct jp_patrol_round_config config = {.stop_count = (uint16_t)file->stop_count,
                                            .charger = patrol_scene_place(scene, &charger),
                                            .full = (float)file->full_j,
                                            .reserve = (float)file->reserve_j,
                                            .deviations = (float)file->deviations};
    uint8_t bytes[JP_ROUND_BYTES_MAX];

    for (unsigned i = 0; i < file->stop_count; i++) {
        config.stops[i] =
            (struct jp_patrol_stop){patrol_scene_place(scene, &file->stops[i].pose), (float)file->stops[i].dwell_s};
    }
    jp_round_encode(&config, bytes);
    jp_round_decode(bytes, (uint8_t)file->stop_count, &config);
    return config;
}
