#include "sim/files/map_file.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/error.h"

#define FORMAT           "joulepath-map-1"
#define IMPORT           "import the map again with python -m tools.design.import_map"
#define RESOLUTION_MIN_M 0.001
#define RESOLUTION_MAX_M 1000.0

/* Of a ground, against that of the robot file. */
#define GROUND_LEAST  0.0625
#define ROLLING_MOST  16.0
#define FRICTION_MOST 1.0

/* What a file holds; the strings and arrays belong to its JSON. */
struct map_text {
    const char *format;
    const char *name;
    const char *note;
    json_int_t width;
    json_int_t height;
    double resolution_m;
    double origin[3];
    json_t *rows;
    json_t *elevations; /* NULL: level */
    json_t *costs;      /* NULL: none */
    json_int_t cost_shift;
    json_t *classes; /* NULL: all ground is alike */
    json_t *grounds; /* NULL: what they are like is not said */
};

static bool check_keys(const char *path, json_t *root)
{
    static const char *const keys[] = {"format",     "name",  "width",  "height",      "resolution_m",
                                       "origin_m",   "note",  "rows",   "elevation_m", "cost",
                                       "cost_shift", "class", "grounds"};
    const char *key;
    json_t *value;
    if (!json_is_object(root)) {
        error_line("%s: is no JSON object; " IMPORT, path);
        return false;
    }
    json_object_foreach(root, key, value)
    {
        size_t i = 0;
        while (i < sizeof keys / sizeof keys[0] && strcmp(key, keys[i]) != 0) {
            i++;
        }
        if (i == sizeof keys / sizeof keys[0]) {
            error_line("%s: %s: no such key in a map; take it out", path, key);
            return false;
        }
    }
    return true;
}

/* Takes the value of a key apart by a format of json_unpack(). */
static bool unpack(const char *path, json_t *root, const char *key, const char *format, ...)
{
    json_t *value = json_object_get(root, key);
    if (value == NULL) {
        error_line("%s: %s: the key is missing; " IMPORT, path, key);
        return false;
    }
    json_error_t error;
    va_list targets;
    va_start(targets, format);
    const bool unpacked = json_vunpack_ex(value, &error, JSON_STRICT, format, targets) == 0;
    va_end(targets);
    if (!unpacked) {
        error_line("%s: %s: %s; " IMPORT, path, key, error.text);
    }
    return unpacked;
}

static bool unpack_all(const char *path, json_t *root, struct map_text *text)
{
    *text = (struct map_text){.note = "",
                              .elevations = json_object_get(root, "elevation_m"),
                              .costs = json_object_get(root, "cost"),
                              .classes = json_object_get(root, "class"),
                              .grounds = json_object_get(root, "grounds")};
    return check_keys(path, root) && unpack(path, root, "format", "s", &text->format) &&
           unpack(path, root, "name", "s", &text->name) && unpack(path, root, "width", "I", &text->width) &&
           unpack(path, root, "height", "I", &text->height) &&
           unpack(path, root, "resolution_m", "F", &text->resolution_m) &&
           unpack(path, root, "origin_m", "[F,F,F]", &text->origin[0], &text->origin[1], &text->origin[2]) &&
           unpack(path, root, "rows", "o", &text->rows) &&
           (text->costs == NULL || unpack(path, root, "cost_shift", "I", &text->cost_shift)) &&
           (json_object_get(root, "note") == NULL || unpack(path, root, "note", "s", &text->note));
}

static bool check_side(const char *path, const char *key, json_int_t value)
{
    if (value < 1 || value > JP_TERRAIN_SIDE_MAX) {
        error_line("%s: %s: %" JSON_INTEGER_FORMAT " is not in 1…%d cells; " IMPORT, path, key, value,
                   JP_TERRAIN_SIDE_MAX);
        return false;
    }
    return true;
}

static bool check_rows(const char *path, const char *key, const json_t *rows, json_int_t height)
{
    if (!json_is_array(rows) || json_array_size(rows) != (size_t)height) {
        error_line("%s: %s: is no list of %" JSON_INTEGER_FORMAT " rows, the height; " IMPORT, path, key, height);
        return false;
    }
    return true;
}

static bool check_text(const char *path, const struct map_text *text)
{
    if (strcmp(text->format, FORMAT) != 0) {
        error_line("%s: format: '%s' is not '" FORMAT "'; " IMPORT, path, text->format);
        return false;
    }
    if (text->name[0] == '\0' || strlen(text->name) >= MAP_FILE_NAME_SIZE) {
        error_line("%s: name: takes 1…%d characters; " IMPORT, path, MAP_FILE_NAME_SIZE - 1);
        return false;
    }
    if (strlen(text->note) >= MAP_FILE_NOTE_SIZE) {
        error_line("%s: note: takes at most %d characters; shorten it", path, MAP_FILE_NOTE_SIZE - 1);
        return false;
    }
    if (!(text->resolution_m >= RESOLUTION_MIN_M && text->resolution_m <= RESOLUTION_MAX_M)) {
        error_line("%s: resolution_m: %g is not in %g…%g; " IMPORT, path, text->resolution_m, RESOLUTION_MIN_M,
                   RESOLUTION_MAX_M);
        return false;
    }
    if (text->cost_shift < 0 || text->cost_shift > JP_CELL_COST_SHIFT_MAX) {
        error_line("%s: cost_shift: %" JSON_INTEGER_FORMAT " is not in 0…%d; " IMPORT, path, text->cost_shift,
                   JP_CELL_COST_SHIFT_MAX);
        return false;
    }
    return check_side(path, "width", text->width) && check_side(path, "height", text->height) &&
           check_rows(path, "rows", text->rows, text->height) &&
           (text->elevations == NULL || check_rows(path, "elevation_m", text->elevations, text->height)) &&
           (text->costs == NULL || check_rows(path, "cost", text->costs, text->height)) &&
           (text->classes == NULL || check_rows(path, "class", text->classes, text->height));
}

/* The file's rows go from north to south. */
static int32_t y_of(const struct map_text *text, size_t row)
{
    return (int32_t)((size_t)text->height - 1 - row);
}

static bool set_row(const char *path, const struct map_text *text, size_t row, struct jp_terrain *terrain)
{
    const json_t *value = json_array_get(text->rows, row);
    if (!json_is_string(value) || json_string_length(value) != (size_t)text->width) {
        error_line("%s: rows: row %zu is no text of %" JSON_INTEGER_FORMAT " cells, the width; " IMPORT, path, row + 1,
                   text->width);
        return false;
    }
    const char *cells = json_string_value(value);
    for (int32_t x = 0; x < text->width; x++) {
        enum jp_cell cell;
        switch (cells[x]) {
        case '.':
            cell = JP_CELL_FREE;
            break;
        case '#':
            cell = JP_CELL_OCCUPIED;
            break;
        case '?':
            cell = JP_CELL_UNKNOWN;
            break;
        default:
            error_line("%s: rows: row %zu, cell %d: not one of . # ?; " IMPORT, path, row + 1, (int)x + 1);
            return false;
        }
        (void)jp_terrain_set_cell(terrain, x, y_of(text, row), cell);
    }
    return true;
}

static bool check_row(const char *path, const struct map_text *text, const char *key, size_t row, const json_t *values)
{
    if (!json_is_array(values) || json_array_size(values) != (size_t)text->width) {
        error_line("%s: %s: row %zu is no list of %" JSON_INTEGER_FORMAT " numbers, the width; " IMPORT, path, key,
                   row + 1, text->width);
        return false;
    }
    return true;
}

static bool set_elevations(const char *path, const struct map_text *text, size_t row, struct jp_terrain *terrain)
{
    const json_t *values = json_array_get(text->elevations, row);
    if (!check_row(path, text, "elevation_m", row, values)) {
        return false;
    }
    for (int32_t x = 0; x < text->width; x++) {
        const json_t *value = json_array_get(values, (size_t)x);
        const double units = round(json_number_value(value) * JP_ELEVATION_ONE);
        if (!json_is_number(value) || !(fabs(units) <= INT16_MAX)) {
            error_line("%s: elevation_m: row %zu, cell %d: not a number within ±%.3f m; " IMPORT, path, row + 1,
                       (int)x + 1, (double)INT16_MAX / JP_ELEVATION_ONE);
            return false;
        }
        (void)jp_terrain_set_elevation(terrain, x, y_of(text, row), (jp_elevation)units);
    }
    return true;
}

static bool set_costs(const char *path, const struct map_text *text, size_t row, struct jp_terrain *terrain)
{
    const json_t *values = json_array_get(text->costs, row);
    if (!check_row(path, text, "cost", row, values)) {
        return false;
    }
    for (int32_t x = 0; x < text->width; x++) {
        const json_t *value = json_array_get(values, (size_t)x);
        const json_int_t cost = json_integer_value(value);
        if (!json_is_integer(value) || cost < 0 || cost > UINT8_MAX) {
            error_line("%s: cost: row %zu, cell %d: not a whole number from 0 to %d; " IMPORT, path, row + 1,
                       (int)x + 1, UINT8_MAX);
            return false;
        }
        (void)jp_terrain_set_cost(terrain, x, y_of(text, row), (uint8_t)cost);
    }
    return true;
}

static bool set_classes(const char *path, const struct map_text *text, size_t row, struct jp_terrain *terrain)
{
    const json_t *value = json_array_get(text->classes, row);
    if (!json_is_string(value) || json_string_length(value) != (size_t)text->width) {
        error_line("%s: class: row %zu is no text of %" JSON_INTEGER_FORMAT " digits, the width; " IMPORT, path,
                   row + 1, text->width);
        return false;
    }
    const char *digits = json_string_value(value);
    for (int32_t x = 0; x < text->width; x++) {
        const int ground = digits[x] - '0';
        if (ground < 0 || ground >= (int)JP_GROUND_CLASSES) {
            error_line("%s: class: row %zu, cell %d: not a digit from 0 to %u; " IMPORT, path, row + 1, (int)x + 1,
                       JP_GROUND_CLASSES - 1);
            return false;
        }
        (void)jp_terrain_set_class(terrain, x, y_of(text, row), (uint8_t)ground);
    }
    return true;
}

static bool check_ground(const char *path, const struct map_ground *ground, const char *name)
{
    if (strlen(name) >= MAP_FILE_NAME_SIZE) {
        error_line("%s: grounds: a name takes at most %d characters; shorten it", path, MAP_FILE_NAME_SIZE - 1);
        return false;
    }
    if (!(ground->rolling >= GROUND_LEAST && ground->rolling <= ROLLING_MOST)) {
        error_line("%s: grounds: %s: rolling: %g is not in %g…%g times that of the robot file", path, name,
                   ground->rolling, GROUND_LEAST, ROLLING_MOST);
        return false;
    }
    if (!(ground->friction >= GROUND_LEAST && ground->friction <= FRICTION_MOST)) {
        error_line("%s: grounds: %s: friction: %g is not in %g…%g times that of the robot file", path, name,
                   ground->friction, GROUND_LEAST, FRICTION_MOST);
        return false;
    }
    return true;
}

static bool set_ground(const char *path, json_t *value, struct map_ground *ground)
{
    const char *name = "";
    json_error_t error;
    if (json_unpack_ex(value, &error, JSON_STRICT, "{s:s, s:F, s:F}", "name", &name, "rolling", &ground->rolling,
                       "friction", &ground->friction) != 0) {
        error_line("%s: grounds: %s; give each class {\"name\", \"rolling\", \"friction\"}", path, error.text);
        return false;
    }
    if (!check_ground(path, ground, name)) {
        return false;
    }
    (void)snprintf(ground->name, sizeof ground->name, "%s", name);
    return true;
}

static bool set_grounds(const char *path, const struct map_text *text, struct map_file *map)
{
    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        map->grounds[k] = (struct map_ground){.rolling = 1, .friction = 1};
    }
    if (text->grounds == NULL) {
        return true;
    }
    if (text->classes == NULL || !json_is_array(text->grounds) || json_array_size(text->grounds) > JP_GROUND_CLASSES) {
        error_line("%s: grounds: is no list of at most %u grounds beside a key class", path, JP_GROUND_CLASSES);
        return false;
    }
    for (size_t k = 0; k < json_array_size(text->grounds); k++) {
        if (!set_ground(path, json_array_get(text->grounds, k), &map->grounds[k])) {
            return false;
        }
    }
    return true;
}

static bool fill(const char *path, const struct map_text *text, struct jp_terrain *terrain)
{
    for (size_t row = 0; row < (size_t)text->height; row++) {
        if (!set_row(path, text, row, terrain) ||
            (text->elevations != NULL && !set_elevations(path, text, row, terrain)) ||
            (text->costs != NULL && !set_costs(path, text, row, terrain)) ||
            (text->classes != NULL && !set_classes(path, text, row, terrain))) {
            return false;
        }
    }
    return true;
}

static bool make_terrain(const char *path, const struct map_text *text, struct map_file *map)
{
    const struct jp_terrain_config config = {.width = (uint16_t)text->width,
                                             .height = (uint16_t)text->height,
                                             .resolution = (jp_q16)lround(text->resolution_m * JP_Q16_ONE),
                                             .has_elevation = text->elevations != NULL,
                                             .has_costs = text->costs != NULL,
                                             .cost_shift = (uint8_t)text->cost_shift,
                                             .has_classes = text->classes != NULL};
    const size_t size = jp_terrain_size(&config);
    const char *field;
    map->block = malloc(size);
    if (map->block == NULL || jp_terrain_init(&map->terrain, &config, map->block, size, &field) != JP_OK) {
        error_line("%s: no memory for the map", path);
        map_file_free(map);
        return false;
    }
    return true;
}

static bool build(const char *path, json_t *root, struct map_file *map)
{
    struct map_text text;
    if (!unpack_all(path, root, &text) || !check_text(path, &text) || !make_terrain(path, &text, map)) {
        return false;
    }
    if (!fill(path, &text, &map->terrain) || !set_grounds(path, &text, map)) {
        map_file_free(map);
        return false;
    }
    (void)snprintf(map->name, sizeof map->name, "%s", text.name);
    (void)snprintf(map->note, sizeof map->note, "%s", text.note);
    memcpy(map->origin, text.origin, sizeof map->origin);
    return true;
}

/* Open for reading, with something in it; NULL after an error. */
static FILE *open_map(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        error_line("%s: %s; give the path of a map", path, strerror(errno));
        return NULL;
    }
    const int first = getc(file);
    if (first == EOF) {
        error_line("%s: %s; give the path of a map", path, ferror(file) ? strerror(errno) : "the file is empty");
        (void)fclose(file);
        return NULL;
    }
    (void)ungetc(first, file);
    return file;
}

bool map_file_load(const char *path, struct map_file *map)
{
    *map = (struct map_file){0};
    FILE *file = open_map(path);
    if (file == NULL) {
        return false;
    }
    json_error_t error;
    json_t *root = json_loadf(file, JSON_REJECT_DUPLICATES, &error);
    (void)fclose(file);
    if (root == NULL) {
        error_line("%s: line %d: %s; " IMPORT, path, error.line, error.text);
        return false;
    }
    const bool built = build(path, root, map);
    json_decref(root);
    return built;
}

void map_file_free(struct map_file *map)
{
    free(map->block);
    map->block = NULL;
}
