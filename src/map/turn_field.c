#include <joulepath/turn_field.h>
#include <string.h>

#include "src/map/field_unit.h"
#include "src/map/terrain_cells.h"

enum {
    UNITS_PER_TURN = 16, /* of a value, at least, in the cheapest turn */
    CORNERS = 4,
    LOOKS_PER_SWEEP = 16, /* what a primitive sweeps takes as long to look at as so many values */
    LOOKS_PER_CELL = 16,  /* so does the wave's step to its next cell */
};

static uint16_t rows_of(const struct jp_terrain_config *config, unsigned scale)
{
    return (uint16_t)(field_coarse(config->height, scale) * (unsigned)JP_HEADINGS);
}

size_t jp_turn_field_size(const struct jp_terrain_config *config, unsigned scale)
{
    return jp_wavefront_size(field_coarse(config->width, scale), rows_of(config, scale), JP_WAVE_2_BYTES);
}

void jp_turn_field_init(struct jp_turn_field *field, const struct jp_lattice *lattice, enum jp_cost_kind kind,
                        const struct jp_terrain *terrain, unsigned scale, void *block)
{
    const struct jp_terrain_config *config = &terrain->config;

    (void)memset(field, 0, sizeof *field);
    field->lattice = lattice;
    field->terrain = terrain;
    field->kind = kind;
    field->scale = (uint8_t)scale;
    jp_wavefront_init(&field->wave, field_coarse(config->width, scale), rows_of(config, scale), JP_WAVE_2_BYTES, block);
}

void jp_turn_field_set_lattice(struct jp_turn_field *field, const struct jp_lattice *lattice)
{
    field->lattice = lattice;
}

static int32_t row_of(const struct jp_turn_field *field, int32_t y, unsigned heading)
{
    return y / (int32_t)field->scale * JP_HEADINGS + (int32_t)heading;
}

static int32_t smaller(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static int32_t larger(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

/** Lowers a value; (x, y) is coarse. */
static void lower(struct jp_turn_field *field, int32_t x, int32_t y, unsigned heading, uint32_t value)
{
    const int32_t scale = field->scale;
    struct jp_cell_box *box = &field->lowered;

    jp_wavefront_lower(&field->wave, x, y * JP_HEADINGS + (int32_t)heading, value);
    box->first_x = smaller(box->first_x, x * scale);
    box->last_x = larger(box->last_x, smaller(x * scale + scale, field->terrain->config.width) - 1);
    box->first_y = smaller(box->first_y, y * scale);
    box->last_y = larger(box->last_y, smaller(y * scale + scale, field->terrain->config.height) - 1);
}

struct jp_cell_box jp_turn_field_take_lowered(struct jp_turn_field *field)
{
    const struct jp_cell_box box = field->lowered;

    field->lowered = (struct jp_cell_box){INT32_MAX, INT32_MIN, INT32_MAX, INT32_MIN};
    return box;
}

static uint32_t cheapest_turn(const struct jp_turns *turns)
{
    uint32_t least = UINT16_MAX;

    for (unsigned from = 0; from < JP_HEADINGS; from++) {
        for (unsigned to = 0; to < JP_HEADINGS; to++) {
            const uint32_t cost = turns->cost[from][to];
            least = cost > 0U && cost < least ? cost : least;
        }
    }
    return least;
}

void jp_turn_field_start(struct jp_turn_field *field, const struct jp_turns *turns, int32_t root_x, int32_t root_y,
                         unsigned root_heading, int32_t target_x, int32_t target_y, unsigned target_heading)
{
    const uint32_t turn = cheapest_turn(turns);
    const int32_t target_column = target_x / (int32_t)field->scale;

    field->shift = 0;
    while (turn >> (field->shift + 1U) >= (uint32_t)UNITS_PER_TURN) {
        field->shift++;
    }
    field->root_x = (uint16_t)root_x;
    field->root_y = (uint16_t)root_y;
    field->root_heading = (uint8_t)root_heading;
    field->scan.is_active = false;
    field->debt = 0;
    jp_wavefront_start(&field->wave, (turn >> field->shift) + 1U, (uint16_t)target_column,
                       (uint16_t)row_of(field, target_y, target_heading));
}

/** Clears some values; after the last the wave has its root. */
static void clear(struct jp_turn_field *field)
{
    const int32_t scale = field->scale;

    jp_wavefront_clear(&field->wave);
    if (jp_wavefront_is_clear(&field->wave)) {
        (void)jp_turn_field_take_lowered(field);
        lower(field, (int32_t)field->root_x / scale, (int32_t)field->root_y / scale, field->root_heading, 0);
    }
}

static struct jp_turn_leap leap(int32_t distance, int32_t scale)
{
    const int32_t offset = distance >= 0 ? distance / scale : -((scale - 1 - distance) / scale);

    const int32_t farther_from = scale - (distance - offset * scale);

    return (struct jp_turn_leap){(int8_t)offset, (uint8_t)farther_from};
}

/** The next primitive from the heading, or the end of the scan. */
static void begin_primitive(struct jp_turn_field *field)
{
    struct jp_turn_scan *scan = &field->scan;
    const struct jp_primitive *primitive = &field->lattice->primitives[scan->primitive];

    scan->is_active = scan->primitive < field->lattice->first_from[scan->heading + 1U];
    if (scan->is_active) {
        scan->corner = 0;
        scan->across = leap(primitive->dx, field->scale);
        scan->along = leap(primitive->dy, field->scale);
    }
}

static void begin_scan(struct jp_turn_field *field, int32_t x, int32_t row)
{
    const int32_t heading = row % JP_HEADINGS;

    field->scan = (struct jp_turn_scan){
        .x = x,
        .y = row / JP_HEADINGS,
        .value = jp_wavefront_value(&field->wave, x, row),
        .primitive = field->lattice->first_from[heading],
        .heading = (uint8_t)heading,
    };
    begin_primitive(field);
}

static void next_corner(struct jp_turn_field *field)
{
    struct jp_turn_scan *scan = &field->scan;

    scan->row = 0;
    scan->column = 0;
    scan->corner++;
    if (scan->corner == (uint8_t)CORNERS) {
        scan->primitive++;
        begin_primitive(field);
    }
}

/** Cells of a coarse one, along an axis, from which a primitive leads to a corner. */
struct near_cells {
    int32_t first;
    int32_t end;
};

static struct near_cells part_of(const struct jp_turn_leap *of, int32_t scale, bool is_farther)
{
    return is_farther ? (struct near_cells){of->farther_from, scale} : (struct near_cells){0, of->farther_from};
}

/** The coarse cell that the scan is at a primitive to. */
static int32_t corner_x(const struct jp_turn_scan *scan)
{
    const bool is_farther = scan->corner % 2U != 0U;

    return scan->x + (int32_t)scan->across.offset + (is_farther ? 1 : 0);
}

static int32_t corner_y(const struct jp_turn_scan *scan)
{
    const bool is_farther = scan->corner / 2U != 0U;

    return scan->y + (int32_t)scan->along.offset + (is_farther ? 1 : 0);
}

/** Whether the primitive can be driven to the corner from the cell that the scan is at; then on to the next cell or
 *  corner. */
static void try_cell(struct jp_turn_field *field, const struct jp_primitive *primitive, uint32_t value)
{
    struct jp_turn_scan *scan = &field->scan;
    const int32_t scale = field->scale;
    const bool is_farther_x = scan->corner % 2U != 0U;
    const bool is_farther_y = scan->corner / 2U != 0U;
    const struct near_cells across = part_of(&scan->across, scale, is_farther_x);
    const struct near_cells along = part_of(&scan->along, scale, is_farther_y);
    const int32_t x = across.first + (int32_t)scan->column;
    const int32_t y = along.first + (int32_t)scan->row;

    if (x >= across.end || y >= along.end) {
        next_corner(field);
    } else if (jp_lattice_is_clear(field->lattice, field->terrain, primitive, scan->x * scale + x,
                                   scan->y * scale + y)) {
        lower(field, corner_x(scan), corner_y(scan), primitive->end, value);
        next_corner(field);
    } else if (x + 1 < across.end) {
        scan->column++;
    } else {
        scan->column = 0;
        scan->row++;
    }
}

/** Looks at a coarse cell that a primitive may lead to and, where its value could fall, at what the primitive sweeps
 * from one cell. Returns the looks that it has taken. */
static unsigned look(struct jp_turn_field *field)
{
    const struct jp_turn_scan *scan = &field->scan;
    const struct jp_primitive *primitive = &field->lattice->primitives[scan->primitive];
    const int32_t x = corner_x(scan);
    const int32_t row = corner_y(scan) * JP_HEADINGS + (int32_t)primitive->end;
    const uint32_t value =
        field_value(&field->wave, scan->value + ((uint32_t)primitive->base[field->kind] >> field->shift));

    if ((uint32_t)x >= field->wave.width || (uint32_t)row >= field->wave.height ||
        value >= jp_wavefront_value(&field->wave, x, row)) {
        next_corner(field);
        return 1;
    }
    try_cell(field, primitive, value);
    return LOOKS_PER_SWEEP;
}

/** Goes on to the next cell of the wave. True when there is none left. */
static bool advance(struct jp_turn_field *field)
{
    int32_t x = 0;
    int32_t row = 0;
    unsigned cells = 1;
    const enum jp_wave_step step = jp_wavefront_next(&field->wave, &cells, &x, &row);

    if (step == JP_WAVE_CELL) {
        begin_scan(field, x, row);
    }
    return step == JP_WAVE_STOPPED;
}

bool jp_turn_field_grow(struct jp_turn_field *field, unsigned *looks)
{
    while (*looks > 0U) {
        if (field_pays(&field->debt, looks)) {
            continue;
        }
        field->debt = LOOKS_PER_CELL;
        if (field->scan.is_active) {
            field->debt = look(field);
        } else if (!jp_wavefront_is_clear(&field->wave)) {
            clear(field);
        } else if (advance(field)) {
            field->debt = 0;
            return true;
        } else {
            /* a cell to scan, or nothing found for a while */
        }
    }
    return false;
}

/** Hands out again what leads from the cells of a row at a heading. */
static void touch(struct jp_turn_field *field, int32_t first_x, int32_t last_x, int32_t y, unsigned heading)
{
    const int32_t scale = field->scale;
    const int32_t first = larger(first_x, 0) / scale;
    const int32_t last = smaller(last_x, (int32_t)field->terrain->config.width - 1) / scale;

    if (last_x < 0 || y < 0 || y >= (int32_t)field->terrain->config.height) {
        return;
    }
    for (int32_t x = first; x <= last; x++) {
        jp_wavefront_touch(&field->wave, x, row_of(field, y, heading));
    }
}

void jp_turn_field_cell_changed(struct jp_turn_field *field, int32_t x, int32_t y)
{
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const struct jp_cells reach = field->lattice->reach[heading];
        for (unsigned i = 0; i < reach.span_count; i++) {
            const struct jp_span *span = &field->lattice->spans[reach.first_span + i];
            touch(field, x - span->last, x - span->first, y - span->y, heading);
        }
    }
    jp_wavefront_resume(&field->wave);
}

jp_cost jp_turn_field_bound(const struct jp_turn_field *field, int32_t x, int32_t y, unsigned heading)
{
    const struct jp_wavefront *wave = &field->wave;
    const uint32_t value = jp_wavefront_value(wave, x / (int32_t)field->scale, row_of(field, y, heading));

    if (value == wave->not_reached && jp_wavefront_is_exhausted(wave)) {
        return JP_COST_MAX;
    }
    return jp_cost_add((value < wave->horizon ? value : wave->horizon) << field->shift, 0);
}
