#include <joulepath/energy_field.h>
#include <string.h>

#include "src/map/field_unit.h"
#include "src/map/terrain_cells.h"

enum {
    STEP_MAX = 2,            /* cells, along an axis */
    STEPS_PER_THRESHOLD = 4, /* few enough to be near the order of values, many enough for few sweeps */
};

size_t jp_energy_field_size(const struct jp_terrain_config *config, enum jp_wave_format format)
{
    return jp_wavefront_size(config->width, config->height, format);
}

void jp_energy_field_init(struct jp_energy_field *field, const struct jp_lattice *lattice, enum jp_cost_kind kind,
                          const struct jp_terrain *terrain, enum jp_wave_format format, jp_cost range, void *block)
{
    (void)memset(field, 0, sizeof *field);
    field->lattice = lattice;
    field->terrain = terrain;
    field->kind = kind;
    jp_wavefront_init(&field->wave, terrain->config.width, terrain->config.height, format, block);
    while (format == JP_WAVE_2_BYTES && range >> field->shift > jp_wavefront_value_max(&field->wave)) {
        field->shift++;
    }
}

static void lower(struct jp_energy_field *field, int32_t x, int32_t y, uint32_t value)
{
    struct jp_cell_box *box = &field->lowered;

    jp_wavefront_lower(&field->wave, x, y, value);
    box->first_x = x < box->first_x ? x : box->first_x;
    box->last_x = x > box->last_x ? x : box->last_x;
    box->first_y = y < box->first_y ? y : box->first_y;
    box->last_y = y > box->last_y ? y : box->last_y;
}

struct jp_cell_box jp_energy_field_take_lowered(struct jp_energy_field *field)
{
    const struct jp_cell_box box = field->lowered;

    field->lowered = (struct jp_cell_box){INT32_MAX, INT32_MIN, INT32_MAX, INT32_MIN};
    return box;
}

void jp_energy_field_set_lattice(struct jp_energy_field *field, const struct jp_lattice *lattice)
{
    field->lattice = lattice;
}

void jp_energy_field_start(struct jp_energy_field *field, int32_t root_x, int32_t root_y, int32_t target_x,
                           int32_t target_y)
{
    const uint32_t step = (field_level_step(field->lattice, field->kind) * STEPS_PER_THRESHOLD) >> field->shift;

    jp_wavefront_start(&field->wave, step + 1U, (uint16_t)target_x, (uint16_t)target_y);
    field->root_x = (uint16_t)root_x;
    field->root_y = (uint16_t)root_y;
}

/** Clears some cells; after the last the wave has its root. */
static void clear(struct jp_energy_field *field)
{
    jp_wavefront_clear(&field->wave);
    if (jp_wavefront_is_clear(&field->wave)) {
        (void)jp_energy_field_take_lowered(field);
        lower(field, field->root_x, field->root_y, 0);
    }
}

/** Relaxes the neighbours of a cell. */
static void relax(struct jp_energy_field *field, int32_t x, int32_t y)
{
    const struct jp_terrain *terrain = field->terrain;
    const uint32_t here = jp_wavefront_value(&field->wave, x, y);
    const int32_t elevation = terrain_elevation(terrain, x, y);

    for (unsigned direction = 0; direction < JP_MOVE_DIRECTIONS; direction++) {
        const int32_t nx = x + jp_move_offsets[direction].dx;
        const int32_t ny = y + jp_move_offsets[direction].dy;

        if (!terrain_contains(terrain, nx, ny)) {
            continue;
        }
        const uint32_t there = jp_wavefront_value(&field->wave, nx, ny);
        if (there <= here) {
            continue;
        }
        const jp_cost step = jp_move_cost(&field->lattice->move_costs[field->kind][jp_move_kind_of(direction)],
                                          terrain_elevation(terrain, nx, ny) - elevation);
        const uint32_t value = field_value(&field->wave, here + (step >> field->shift));
        if (value < there && step != JP_COST_MAX && jp_lattice_is_open(field->lattice, terrain, nx, ny)) {
            lower(field, nx, ny, value);
        }
    }
}

bool jp_energy_field_grow(struct jp_energy_field *field, unsigned *cells)
{
    int32_t x = 0;
    int32_t y = 0;

    while (*cells > 0U) {
        if (!jp_wavefront_is_clear(&field->wave)) {
            clear(field);
            --*cells;
            continue;
        }
        const enum jp_wave_step step = jp_wavefront_next(&field->wave, cells, &x, &y);
        if (step == JP_WAVE_STOPPED) {
            return true;
        }
        if (step == JP_WAVE_CELL) {
            relax(field, x, y);
        }
    }
    return false;
}

/** After a change of cell (x, y): hands out again the cells whose steps lead over it or start from it. */
static void touch_around(struct jp_energy_field *field, int32_t x, int32_t y)
{
    for (unsigned direction = 0; direction < JP_MOVE_DIRECTIONS; direction++) {
        const int32_t nx = x + jp_move_offsets[direction].dx;
        const int32_t ny = y + jp_move_offsets[direction].dy;

        if (terrain_contains(field->terrain, nx, ny)) {
            jp_wavefront_touch(&field->wave, nx, ny);
        }
    }
    if (terrain_contains(field->terrain, x, y)) {
        jp_wavefront_touch(&field->wave, x, y);
    }
}

void jp_energy_field_cell_changed(struct jp_energy_field *field, int32_t x, int32_t y)
{
    const struct jp_cells core = field->lattice->core;

    for (unsigned i = 0; i < core.span_count; i++) {
        const struct jp_span span = field->lattice->spans[core.first_span + i];
        const int32_t last = x - span.first;
        for (int32_t cell_x = x - span.last; cell_x <= last; cell_x++) {
            touch_around(field, cell_x, y - span.y);
        }
    }
    touch_around(field, x, y);
    jp_wavefront_resume(&field->wave);
}

jp_cost jp_energy_field_bound(const struct jp_energy_field *field, int32_t x, int32_t y)
{
    const struct jp_wavefront *wave = &field->wave;
    const uint32_t value = jp_wavefront_value(wave, x, y);

    if (value == wave->not_reached && jp_wavefront_is_exhausted(wave)) {
        return JP_COST_MAX;
    }
    return jp_cost_add((value < wave->horizon ? value : wave->horizon) << field->shift, 0);
}
