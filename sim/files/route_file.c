#include "sim/files/route_file.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/error.h"

#define LINE_SIZE   4096
#define TURN        4294967296.0
#define DEGREES     360.0
#define COLUMNS_MAX 64
#define NONE        COLUMNS_MAX

/* Spreadsheets begin their UTF-8 files with it. */
#define BYTE_ORDER_MARK "\xef\xbb\xbf"

/* Where the columns of a CSV file stand; NONE: nowhere. */
struct columns {
    size_t x;
    size_t y;
    size_t heading;
};

/* ---- Points ---- */

static bool is_within(double value, double limit)
{
    return value >= -limit && value <= limit;
}

static jp_q16 to_q16(double metres)
{
    return (jp_q16)lround(metres * JP_Q16_ONE);
}

/* Appends a point at `place` of the file; the first is the start. */
static bool add_point(const char *path, const char *place, double x, double y, size_t *points, struct route_file *route)
{
    if (!is_within(x, ROUTE_FILE_COORDINATE_MAX) || !is_within(y, ROUTE_FILE_COORDINATE_MAX)) {
        error_line("%s: %s: must be within ±%g m; move the route", path, place, ROUTE_FILE_COORDINATE_MAX);
        return false;
    }
    if (*points > ROUTE_FILE_TARGETS_MAX) {
        error_line("%s: %s: more than %d targets; divide the route", path, place, ROUTE_FILE_TARGETS_MAX);
        return false;
    }

    const struct jp_point point = {to_q16(x), to_q16(y)};

    if (*points == 0) {
        route->start = point;
    } else {
        route->targets[*points - 1] = point;
    }
    (*points)++;
    return true;
}

static bool set_heading(const char *path, double degrees, struct route_file *route)
{
    if (!is_within(degrees, ROUTE_FILE_HEADING_MAX)) {
        error_line("%s: heading_deg: must be within ±%g; correct it", path, ROUTE_FILE_HEADING_MAX);
        return false;
    }
    route->heading = (jp_angle)(int64_t)llround(degrees / DEGREES * TURN);
    return true;
}

static bool finish(const char *path, size_t points, struct route_file *route)
{
    if (points < 2) {
        error_line("%s: a start and at least one target are needed, there are %zu points", path, points);
        return false;
    }
    route->count = points - 1;
    return true;
}

/* ---- CSV ---- */

/* Ends a cell that began with a quote, in which a quote is written twice, at its last one. Returns what follows it. */
static char *unquote(char *cell)
{
    char *to = cell;
    char *from = cell;

    while (*from != '\0' && (*from != '"' || from[1] == '"')) {
        from += *from == '"';
        *to++ = *from++;
    }
    from += *from == '"';
    *to = '\0';
    return from;
}

/* The next cell of a line, ended; NULL: none is left. */
static char *next_cell(char **line)
{
    char *cell = *line;

    if (cell == NULL) {
        return NULL;
    }
    cell += strspn(cell, " \t");
    if (*cell == '"') {
        *line = unquote(++cell);
        (void)strsep(line, ",");
    } else {
        (void)strsep(line, ",");
        cell[strcspn(cell, " \t\r\n")] = '\0';
    }
    return cell;
}

static bool read_header(const char *path, char *line, struct columns *columns)
{
    size_t column = 0;

    *columns = (struct columns){NONE, NONE, NONE};
    for (char *cell = next_cell(&line); cell != NULL && column < COLUMNS_MAX; cell = next_cell(&line)) {
        columns->x = strcmp(cell, "x_m") == 0 ? column : columns->x;
        columns->y = strcmp(cell, "y_m") == 0 ? column : columns->y;
        columns->heading = strcmp(cell, "heading_deg") == 0 ? column : columns->heading;
        column++;
    }
    if (columns->x == NONE || columns->y == NONE) {
        error_line("%s: line 1: must name the columns x_m and y_m", path);
        return false;
    }
    return true;
}

static bool read_number(const char *path, size_t line, const char *cell, double *number)
{
    char *end = NULL;

    *number = strtod(cell, &end);
    if (end == cell || *end != '\0') {
        error_line("%s: line %zu: '%s' is not a number", path, line, cell);
        return false;
    }
    return true;
}

/* The numbers of the columns that count; a place that is missing stays not a number, and a heading 0. */
static bool read_row(const char *path, size_t number, char *line, const struct columns *columns, double row[3])
{
    const size_t wanted[3] = {columns->x, columns->y, columns->heading};
    size_t column = 0;

    row[0] = row[1] = NAN;
    row[2] = 0;
    for (char *cell = next_cell(&line); cell != NULL; cell = next_cell(&line)) {
        for (size_t i = 0; i < 3; i++) {
            if (column == wanted[i] && cell[0] != '\0' && !read_number(path, number, cell, &row[i])) {
                return false;
            }
        }
        column++;
    }
    return true;
}

static bool read_rows(const char *path, FILE *file, const struct columns *columns, struct route_file *route)
{
    char line[LINE_SIZE];
    size_t points = 0;

    for (size_t number = 2; fgets(line, sizeof line, file) != NULL; number++) {
        char place[32];
        double row[3];

        if (line[strspn(line, " \t\r\n")] == '\0') {
            continue;
        }
        (void)snprintf(place, sizeof place, "line %zu", number);
        if (!read_row(path, number, line, columns, row) || (points == 0 && !set_heading(path, row[2], route)) ||
            !add_point(path, place, row[0], row[1], &points, route)) {
            return false;
        }
    }
    return finish(path, points, route);
}

static bool read_csv(const char *path, FILE *file, struct route_file *route)
{
    char line[LINE_SIZE] = "";
    char *header = line;
    struct columns columns;

    if (fgets(line, sizeof line, file) == NULL) {
        error_line("%s: is empty; the first line names the columns x_m and y_m", path);
        return false;
    }
    if (strncmp(line, BYTE_ORDER_MARK, strlen(BYTE_ORDER_MARK)) == 0) {
        header += strlen(BYTE_ORDER_MARK);
    }
    return read_header(path, header, &columns) && read_rows(path, file, &columns, route);
}

static bool load_csv(const char *path, struct route_file *route)
{
    FILE *file = fopen(path, "r");

    if (file == NULL) {
        error_line("%s: cannot be read: %s", path, strerror(errno));
        return false;
    }

    const bool is_read = read_csv(path, file, route);

    (void)fclose(file);
    return is_read;
}

/* ---- JSON ---- */

static bool read_points(const char *path, const json_t *list, struct route_file *route)
{
    size_t points = 0;

    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *point = json_array_get(list, i);
        const json_t *x = json_array_get(point, 0);
        const json_t *y = json_array_get(point, 1);
        char place[32];

        (void)snprintf(place, sizeof place, "points_m[%zu]", i);
        if (json_array_size(point) != 2 || !json_is_number(x) || !json_is_number(y)) {
            error_line("%s: %s: must be [x, y]", path, place);
            return false;
        }
        if (!add_point(path, place, json_number_value(x), json_number_value(y), &points, route)) {
            return false;
        }
    }
    return finish(path, points, route);
}

static bool read_json(const char *path, json_t *root, struct route_file *route)
{
    json_error_t error;
    json_t *list = NULL;
    double heading = 0;

    if (json_unpack_ex(root, &error, JSON_STRICT, "{s:o, s?F}", "points_m", &list, "heading_deg", &heading) != 0) {
        error_line("%s: %s; give points_m and, if it is not 0, heading_deg", path, error.text);
        return false;
    }
    return set_heading(path, heading, route) && read_points(path, list, route);
}

static bool load_json(const char *path, struct route_file *route)
{
    json_error_t error;
    json_t *root = json_load_file(path, JSON_REJECT_DUPLICATES, &error);

    if (root == NULL && error.line < 1) {
        error_line("%s; give a file of a route", error.text);
    } else if (root == NULL) {
        error_line("%s: line %d: %s; a route is a JSON object", path, error.line, error.text);
    }

    const bool is_read = root != NULL && read_json(path, root, route);

    json_decref(root);
    return is_read;
}

bool route_file_load(const char *path, struct route_file *route)
{
    const char *suffix = strrchr(path, '.');

    route->heading = 0;
    return suffix != NULL && strcmp(suffix, ".json") == 0 ? load_json(path, route) : load_csv(path, route);
}
