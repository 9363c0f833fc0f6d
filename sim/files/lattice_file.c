#include "sim/files/lattice_file.h"

#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/error.h"

#define FORMAT "joulepath-lattice-1"
#define MAKE   "make it with python -m tools.design.lattice ROBOT --json FILE, from primitives of others with --import"

#define POOL_MAX (UINT16_MAX + 1)

enum { COLUMNS_MAX = 13 };

struct range {
    int64_t low;
    int64_t high;
};

/** A member of the file: rows of whole numbers, plain numbers where there is one column. */
struct table {
    const char *key;
    size_t rows_min;
    size_t rows_max;
    size_t columns;
    struct range ranges[COLUMNS_MAX];
};

#define BYTE                                                                                                           \
    {                                                                                                                  \
        0, UINT8_MAX                                                                                                   \
    }
#define UINT16                                                                                                         \
    {                                                                                                                  \
        0, UINT16_MAX                                                                                                  \
    }
#define INT32                                                                                                          \
    {                                                                                                                  \
        INT32_MIN, INT32_MAX                                                                                           \
    }
#define CELL                                                                                                           \
    {                                                                                                                  \
        -INT8_MAX, INT8_MAX                                                                                            \
    }
#define HEADING                                                                                                        \
    {                                                                                                                  \
        0, JP_HEADINGS - 1                                                                                             \
    }
#define POLYNOMIAL INT32, INT32, INT32
#define BASES      UINT16, UINT16, UINT16

enum member { RESOLUTION, HEADINGS, PRIMITIVES, MOVES, SPANS, FOOTPRINT, REACH, CORE, MOVE_COSTS, MEMBERS };

/* Of `struct jp_lattice`, in its units. */
static const struct table tables[MEMBERS] = {
    [RESOLUTION] = {"resolution", 1, 1, 1, {{1, INT32_MAX}}},
    [HEADINGS] = {"heading", JP_HEADINGS, JP_HEADINGS, 1, {{0, UINT32_MAX}}},
    [PRIMITIVES] = {"primitives",
                    1,
                    (size_t)JP_HEADINGS *JP_PRIMITIVES_PER_HEADING_MAX,
                    COLUMNS_MAX,
                    {CELL, CELL, HEADING, HEADING, BASES, UINT16, UINT16, UINT16, UINT16, BYTE, BYTE}},
    [MOVES] = {"moves", 1, POOL_MAX, 1, {{0, JP_MOVE_DIRECTIONS - 1}}},
    [SPANS] = {"spans", 1, POOL_MAX, 3, {CELL, CELL, CELL}},
    [FOOTPRINT] = {"footprint", JP_HEADINGS, JP_HEADINGS, 2, {UINT16, UINT16}},
    [REACH] = {"reach", JP_HEADINGS, JP_HEADINGS, 2, {UINT16, UINT16}},
    [CORE] = {"core", 1, 1, 2, {UINT16, UINT16}},
    [MOVE_COSTS] = {"move_costs",
                    (size_t)JP_COST_KINDS *JP_MOVE_KINDS,
                    (size_t)JP_COST_KINDS *JP_MOVE_KINDS,
                    9,
                    {POLYNOMIAL, POLYNOMIAL, {INT16_MIN, INT16_MAX}, {1, INT16_MAX}, {1, UINT16_MAX}}},
};

/* ---- Numbers ---- */

static bool check_table(const char *path, const struct table *table, const json_t *rows)
{
    const size_t count = json_array_size(rows);
    if (!json_is_array(rows) || count < table->rows_min || count > table->rows_max) {
        error_line("%s: %s: must be a list of %zu to %zu rows; " MAKE, path, table->key, table->rows_min,
                   table->rows_max);
        return false;
    }
    for (size_t row = 0; row < count; row++) {
        const json_t *values = json_array_get(rows, row);
        const bool is_row = table->columns == 1 || (json_is_array(values) && json_array_size(values) == table->columns);
        for (size_t column = 0; column < table->columns; column++) {
            const json_t *value = table->columns == 1 ? values : json_array_get(values, column);
            const struct range *range = &table->ranges[column];
            if (!is_row || !json_is_integer(value) || json_integer_value(value) < range->low ||
                json_integer_value(value) > range->high) {
                error_line("%s: %s: row %zu: needs %zu whole numbers, number %zu from %lld to %lld; " MAKE, path,
                           table->key, row, table->columns, column + 1, (long long)range->low, (long long)range->high);
                return false;
            }
        }
    }
    return true;
}

static int64_t number(const json_t *root, enum member member, size_t row, size_t column)
{
    const json_t *values = json_array_get(json_object_get(root, tables[member].key), row);

    return json_integer_value(tables[member].columns == 1 ? values : json_array_get(values, column));
}

static size_t rows_of(const json_t *root, enum member member)
{
    return json_array_size(json_object_get(root, tables[member].key));
}

/* ---- Members ---- */

static struct jp_primitive read_primitive(const json_t *root, size_t row)
{
    int64_t n[COLUMNS_MAX];

    for (size_t column = 0; column < COLUMNS_MAX; column++) {
        n[column] = number(root, PRIMITIVES, row, column);
    }
    return (struct jp_primitive){.dx = (int8_t)n[0],
                                 .dy = (int8_t)n[1],
                                 .start = (uint8_t)n[2],
                                 .end = (uint8_t)n[3],
                                 .base = {(uint16_t)n[4], (uint16_t)n[5], (uint16_t)n[6]},
                                 .length = (uint16_t)n[7],
                                 .duration = (uint16_t)n[8],
                                 .first_move = (uint16_t)n[9],
                                 .first_span = (uint16_t)n[10],
                                 .move_count = (uint8_t)n[11],
                                 .span_count = (uint8_t)n[12]};
}

static struct jp_polynomial read_polynomial(const json_t *root, size_t row, size_t column)
{
    return (struct jp_polynomial){(int32_t)number(root, MOVE_COSTS, row, column),
                                  (int32_t)number(root, MOVE_COSTS, row, column + 1),
                                  (int32_t)number(root, MOVE_COSTS, row, column + 2)};
}

static struct jp_cells read_cells(const json_t *root, enum member member, size_t row)
{
    return (struct jp_cells){(uint16_t)number(root, member, row, 0), (uint16_t)number(root, member, row, 1)};
}

static void read_members(const json_t *root, struct jp_lattice *lattice)
{
    lattice->resolution = (jp_q16)number(root, RESOLUTION, 0, 0);
    lattice->core = read_cells(root, CORE, 0);
    for (size_t heading = 0; heading < JP_HEADINGS; heading++) {
        lattice->heading[heading] = (jp_angle)number(root, HEADINGS, heading, 0);
        lattice->footprint[heading] = read_cells(root, FOOTPRINT, heading);
        lattice->reach[heading] = read_cells(root, REACH, heading);
    }
    for (size_t row = 0; row < tables[MOVE_COSTS].rows_max; row++) {
        lattice->move_costs[row / JP_MOVE_KINDS][row % JP_MOVE_KINDS] = (struct jp_slope_cost){
            read_polynomial(root, row, 0), read_polynomial(root, row, 3), (int16_t)number(root, MOVE_COSTS, row, 6),
            (int16_t)number(root, MOVE_COSTS, row, 7), (uint16_t)number(root, MOVE_COSTS, row, 8)};
    }
}

static void read_lists(const json_t *root, struct lattice_file *file)
{
    for (size_t i = 0; i < rows_of(root, PRIMITIVES); i++) {
        file->primitives[i] = read_primitive(root, i);
    }
    for (size_t i = 0; i < rows_of(root, MOVES); i++) {
        file->moves[i] = (uint8_t)number(root, MOVES, i, 0);
    }
    for (size_t i = 0; i < rows_of(root, SPANS); i++) {
        file->spans[i] = (struct jp_span){(int8_t)number(root, SPANS, i, 0), (int8_t)number(root, SPANS, i, 1),
                                          (int8_t)number(root, SPANS, i, 2)};
    }
}

/* The primitives by their start, which is their order, and by their end. */
static void index_primitives(struct lattice_file *file, uint16_t count)
{
    struct jp_lattice *lattice = &file->lattice;
    uint16_t from = 0;
    uint16_t to = 0;

    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        lattice->first_from[heading] = from;
        lattice->first_to[heading] = to;
        for (uint16_t i = 0; i < count; i++) {
            if (file->primitives[i].start == heading) {
                from++;
            }
            if (file->primitives[i].end == heading) {
                file->by_end[to++] = i;
            }
        }
    }
    lattice->first_from[JP_HEADINGS] = from;
    lattice->first_to[JP_HEADINGS] = to;
}

/* ---- What jp_lattice_check() takes for granted ---- */

static bool are_pooled(const struct jp_lattice *lattice, size_t moves, size_t spans)
{
    bool pooled = (size_t)lattice->core.first_span + lattice->core.span_count <= spans;

    for (unsigned i = 0; i < lattice->first_from[JP_HEADINGS]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];
        pooled = pooled && (size_t)primitive->first_move + primitive->move_count <= moves &&
                 (size_t)primitive->first_span + primitive->span_count <= spans;
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const struct jp_cells cells[] = {lattice->footprint[heading], lattice->reach[heading]};
        for (size_t i = 0; i < sizeof cells / sizeof cells[0]; i++) {
            pooled = pooled && (size_t)cells[i].first_span + cells[i].span_count <= spans;
        }
    }
    return pooled;
}

static bool are_spans(const struct jp_span *spans, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (spans[i].first > spans[i].last) {
            return false;
        }
    }
    return true;
}

/* Whether a primitive sweeps the core put on a cell. */
static bool sweeps_core(const struct jp_lattice *lattice, const struct jp_primitive *primitive, int x, int y)
{
    for (unsigned i = 0; i < lattice->core.span_count; i++) {
        const struct jp_span *core = &lattice->spans[lattice->core.first_span + i];
        bool found = false;
        for (unsigned j = 0; j < primitive->span_count && !found; j++) {
            const struct jp_span *swept = &lattice->spans[primitive->first_span + j];
            found = swept->y == core->y + y && swept->first <= core->first + x && swept->last >= core->last + x;
        }
        if (!found) {
            return false;
        }
    }
    return true;
}

static bool is_core_of(const struct jp_lattice *lattice, const struct jp_primitive *primitive)
{
    int x = 0;
    int y = 0;
    bool swept = sweeps_core(lattice, primitive, x, y);

    for (unsigned i = 0; i < primitive->move_count && swept; i++) {
        const struct jp_cell_offset offset = jp_move_offsets[lattice->moves[primitive->first_move + i]];
        x += offset.dx;
        y += offset.dy;
        swept = sweeps_core(lattice, primitive, x, y);
    }
    return swept;
}

/* The cells of the moves are swept with the core, which holds its own cell. */
static bool is_core(const struct jp_lattice *lattice)
{
    bool holds_origin = false;

    for (unsigned i = 0; i < lattice->core.span_count; i++) {
        const struct jp_span *span = &lattice->spans[lattice->core.first_span + i];
        holds_origin = holds_origin || (span->y == 0 && span->first <= 0 && span->last >= 0);
    }
    for (unsigned i = 0; i < lattice->first_from[JP_HEADINGS]; i++) {
        if (!is_core_of(lattice, &lattice->primitives[i])) {
            return false;
        }
    }
    return holds_origin;
}

static bool check_lattice(const char *path, const struct lattice_file *file, size_t moves, size_t spans)
{
    const struct jp_lattice *lattice = &file->lattice;
    const char *field = NULL;

    if (!are_pooled(lattice, moves, spans)) {
        field = "first_move or first_span";
    } else if (!are_spans(file->spans, spans)) {
        field = "spans";
    } else if (jp_lattice_check(lattice, &field) == JP_OK && !is_core(lattice)) {
        field = "core";
    }
    if (field != NULL) {
        error_line("%s: %s: does not fit the rest of the lattice; " MAKE, path, field);
    }
    return field == NULL;
}

/* ---- The file ---- */

static bool check_head(const char *path, json_t *root, struct lattice_file *file)
{
    const char *format = json_string_value(json_object_get(root, "format"));
    const json_t *robot = json_object_get(root, "robot");
    const size_t length = json_string_length(robot);

    if (format == NULL || strcmp(format, FORMAT) != 0) {
        error_line("%s: is no " FORMAT "; " MAKE, path);
        return false;
    }
    if (length == 0 || length >= sizeof file->name) {
        error_line("%s: robot: takes 1…%zu characters; " MAKE, path, sizeof file->name - 1);
        return false;
    }
    (void)snprintf(file->name, sizeof file->name, "%s", json_string_value(robot));
    for (size_t i = 0; i < MEMBERS; i++) {
        if (!check_table(path, &tables[i], json_object_get(root, tables[i].key))) {
            return false;
        }
    }
    return true;
}

static bool build(const char *path, json_t *root, struct lattice_file *file)
{
    if (!check_head(path, root, file)) {
        return false;
    }
    const size_t count = rows_of(root, PRIMITIVES);
    file->primitives = calloc(count, sizeof *file->primitives);
    file->by_end = calloc(count, sizeof *file->by_end);
    file->moves = calloc(rows_of(root, MOVES), sizeof *file->moves);
    file->spans = calloc(rows_of(root, SPANS), sizeof *file->spans);
    if (file->primitives == NULL || file->by_end == NULL || file->moves == NULL || file->spans == NULL) {
        error_line("%s: no memory for the lattice", path);
        return false;
    }
    file->lattice = (struct jp_lattice){.name = file->name,
                                        .primitives = file->primitives,
                                        .by_end = file->by_end,
                                        .moves = file->moves,
                                        .spans = file->spans};
    read_members(root, &file->lattice);
    read_lists(root, file);
    index_primitives(file, (uint16_t)count);
    return check_lattice(path, file, rows_of(root, MOVES), rows_of(root, SPANS));
}

/* NULL after an error. */
static json_t *read_json(const char *path)
{
    FILE *stream = fopen(path, "rb");
    if (stream == NULL) {
        error_line("%s: %s; give the path of a lattice", path, strerror(errno));
        return NULL;
    }
    json_error_t error;
    json_t *root = json_loadf(stream, JSON_REJECT_DUPLICATES, &error);
    (void)fclose(stream);
    if (root == NULL) {
        error_line("%s: line %d: %s: is no " FORMAT "; " MAKE, path, error.line, error.text);
    }
    return root;
}

bool lattice_file_load(const char *path, struct lattice_file *file)
{
    json_t *root = read_json(path);

    *file = (struct lattice_file){.primitives = NULL};
    const bool built = root != NULL && build(path, root, file);
    json_decref(root);
    if (!built) {
        lattice_file_free(file);
    }
    return built;
}

void lattice_file_free(struct lattice_file *file)
{
    free(file->primitives);
    free(file->by_end);
    free(file->moves);
    free(file->spans);
    *file = (struct lattice_file){.primitives = NULL};
}
