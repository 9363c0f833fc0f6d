#include <joulepath/guide_field.h>
#include <string.h>

#include "src/base/block.h"
#include "src/map/field_unit.h"
#include "src/map/open_plane.h"
#include "src/map/terrain_cells.h"

enum {
    LEVEL_PATHS_PER_RANGE = 6, /* range of the values, in costs of a level path across the map */
    /* What takes how long, in units of work. */
    PASS = 1,          /* a neighbour that is not nearer */
    RELAX = 4,         /* one that may be */
    LOOK = 4,          /* at a cell of the map */
    LOOK_AT_PLANE = 1, /* at a row of it */
    WAVE_CELL = 64,    /* the wave's step to its next cell */
    STEP_BITS = 4,
    STEP_MASK = 15,
};

static size_t steps_size(uint16_t width, uint16_t height)
{
    return jp_block_align((size_t)width * height / 2U + 1U);
}

size_t jp_guide_field_size(const struct jp_terrain_config *config, unsigned scale)
{
    const uint16_t width = field_coarse(config->width, scale);
    const uint16_t height = field_coarse(config->height, scale);

    return jp_wavefront_size(width, height, JP_WAVE_2_BYTES) + steps_size(width, height);
}

void jp_guide_field_init(struct jp_guide_field *field, const struct jp_lattice *lattice, enum jp_cost_kind kind,
                         const struct jp_terrain *terrain, const struct jp_turns *turns, unsigned scale, void *block)
{
    const uint16_t width = field_coarse(terrain->config.width, scale);
    const uint16_t height = field_coarse(terrain->config.height, scale);

    (void)memset(field, 0, sizeof *field);
    field->lattice = lattice;
    field->terrain = terrain;
    field->turns = turns;
    field->kind = kind;
    field->scale = (uint8_t)scale;
    jp_wavefront_init(&field->wave, width, height, JP_WAVE_2_BYTES, block);
    field->steps = (uint8_t *)block + jp_wavefront_size(width, height, JP_WAVE_2_BYTES);
}

static unsigned step_at(const struct jp_guide_field *field, int32_t x, int32_t y)
{
    const size_t index = (size_t)y * field->wave.width + (size_t)x;

    return (unsigned)(field->steps[index / 2U] >> (index % 2U * STEP_BITS)) & STEP_MASK;
}

static void set_step(struct jp_guide_field *field, int32_t x, int32_t y, unsigned step)
{
    const size_t index = (size_t)y * field->wave.width + (size_t)x;
    const unsigned low = (unsigned)(index % 2U) * STEP_BITS;
    const unsigned kept = field->steps[index / 2U] & ~((unsigned)STEP_MASK << low);

    field->steps[index / 2U] = (uint8_t)(kept | (step << low));
}

void jp_guide_field_set_lattice(struct jp_guide_field *field, const struct jp_lattice *lattice)
{
    field->lattice = lattice;
}

void jp_guide_field_start(struct jp_guide_field *field, enum jp_guide_direction direction,
                          const struct jp_guide_root *root, uint16_t target_x, uint16_t target_y)
{
    const uint16_t scale = field->scale;

    field->direction = direction;
    field->root = *root;
    field->cell.directions_left = 0;
    field->debt = 0;
    field->shift =
        field_shift(&field->wave, field->lattice, field->kind, &field->terrain->config, LEVEL_PATHS_PER_RANGE);
    field->open = NULL;
    field->open_rows = 0;
    const uint32_t step = ((field_level_step(field->lattice, field->kind) * scale) >> field->shift) + 1U;

    jp_wavefront_start(&field->wave, field_value(&field->wave, step), target_x / scale, target_y / scale);
}

size_t jp_guide_field_loan(const struct jp_terrain_config *config)
{
    return jp_open_plane_size(config);
}

void jp_guide_field_lend(struct jp_guide_field *field, void *block)
{
    field->open = block;
}

/** Coordinate of the middle of a coarse cell, cells of the map. */
static int32_t middle(int32_t coarse_cell, unsigned scale, uint16_t cells)
{
    const int32_t cell = coarse_cell * (int32_t)scale + (int32_t)scale / 2;

    return cell < (int32_t)cells ? cell : (int32_t)cells - 1;
}

static int32_t elevation_of(const struct jp_guide_field *field, int32_t x, int32_t y)
{
    const struct jp_terrain_config *config = &field->terrain->config;

    return terrain_elevation(field->terrain, middle(x, field->scale, config->width),
                             middle(y, field->scale, config->height));
}

/** True when the robot can make `scale` steps in a row from a cell of the map. */
static bool is_chain_open(struct jp_guide_field *field, int32_t x, int32_t y, unsigned direction)
{
    for (unsigned i = 0; i < field->scale; i++) {
        x += jp_move_offsets[direction].dx;
        y += jp_move_offsets[direction].dy;
        field->debt += LOOK;
        if (!jp_lattice_is_open(field->lattice, field->terrain, x, y)) {
            return false;
        }
    }
    return true;
}

/** True when is_chain_open() holds from any cell of a row of a coarse cell. */
static bool is_any_chain_open(struct jp_guide_field *field, int32_t x, int32_t y, unsigned direction)
{
    for (int32_t i = (int32_t)field->scale - 1; i >= 0; i--) {
        if (is_chain_open(field, x + i, y, direction)) {
            return true;
        }
    }
    return false;
}

/** The same for all cells of the row at once, where it is known what is open. */
static bool are_chains_open(struct jp_guide_field *field, int32_t x, int32_t y, unsigned direction)
{
    uint32_t chains = (UINT32_C(1) << field->scale) - 1U;

    for (unsigned i = 0; i < field->scale && chains != 0U; i++) {
        x += jp_move_offsets[direction].dx;
        y += jp_move_offsets[direction].dy;
        field->debt += LOOK_AT_PLANE;
        chains &= jp_open_plane_look(field->open, field->terrain, x, y);
    }
    return chains != 0U;
}

/** True when is_chain_open() holds from any cell of a coarse one. */
static bool is_step_open(struct jp_guide_field *field, int32_t coarse_x, int32_t coarse_y, unsigned direction)
{
    const int32_t scale = field->scale;
    const int32_t x = coarse_x * scale;

    /* From the far corner on: the middle of a coarse cell of 2 × 2 is there. */
    for (int32_t y = (coarse_y + 1) * scale - 1; y >= coarse_y * scale; y--) {
        if (field->open != NULL ? are_chains_open(field, x, y, direction) : is_any_chain_open(field, x, y, direction)) {
            return true;
        }
    }
    return false;
}

/** Least cost of turning between two headings, of which the first is nearer to the root. */
static uint32_t turn_between(const struct jp_guide_field *field, unsigned near, unsigned far)
{
    return field->direction == JP_GUIDE_FROM_ROOT ? field->turns->cost[near][far] : field->turns->cost[far][near];
}

/** Least cost of turning between any of the root's headings and another. */
static uint32_t turn_at_root(const struct jp_guide_field *field, unsigned heading)
{
    uint32_t least = UINT16_MAX;

    for (unsigned i = 0; i < JP_HEADINGS; i++) {
        if (((field->root.headings >> i) & 1U) != 0U) {
            const uint32_t turn = turn_between(field, i, heading);
            least = turn < least ? turn : least;
        }
    }
    return least;
}

/** Cost of turning between the step at a coarse cell and a heading farther from the root. */
static uint32_t turn_at(const struct jp_guide_field *field, int32_t x, int32_t y, unsigned heading)
{
    if (jp_wavefront_value(&field->wave, x, y) == 0U) {
        return turn_at_root(field, heading);
    }
    return turn_between(field, step_at(field, x, y), heading);
}

/** Relaxes the neighbour of a coarse cell in one direction away from the root. */
static void relax_step(struct jp_guide_field *field, const struct jp_guide_cell *cell, unsigned away)
{
    const bool from_root = field->direction == JP_GUIDE_FROM_ROOT;
    const int32_t nx = cell->x + jp_move_offsets[away].dx;
    const int32_t ny = cell->y + jp_move_offsets[away].dy;

    if ((uint32_t)nx >= field->wave.width || (uint32_t)ny >= field->wave.height) {
        return;
    }
    const uint32_t there = jp_wavefront_value(&field->wave, nx, ny);
    if (there <= cell->value) {
        return;
    }
    field->debt += RELAX;
    const unsigned heading = from_root ? away : (away + JP_HEADINGS / 2) % JP_HEADINGS;
    const int32_t rise = elevation_of(field, nx, ny) - cell->elevation;
    const jp_cost step = jp_move_cost(&field->lattice->move_costs[field->kind][jp_move_kind_of(heading)],
                                      (from_root ? rise : -rise) / (int32_t)field->scale);
    const uint32_t sum =
        cell->value + ((step * field->scale + turn_at(field, cell->x, cell->y, heading)) >> field->shift);
    const uint32_t value = field_value(&field->wave, sum);

    if (step == JP_COST_MAX || value >= there ||
        !is_step_open(field, from_root ? cell->x : nx, from_root ? cell->y : ny, heading)) {
        return;
    }
    set_step(field, nx, ny, heading);
    jp_wavefront_lower(&field->wave, nx, ny, value);
}

/** Clears some cells; after the last the wave has its root. */
static void clear(struct jp_guide_field *field)
{
    jp_wavefront_clear(&field->wave);
    if (jp_wavefront_is_clear(&field->wave)) {
        jp_wavefront_lower(&field->wave, field->root.x / field->scale, field->root.y / field->scale, 0);
    }
}

/** Relaxes the next neighbour of the cell. */
static void relax_next(struct jp_guide_field *field)
{
    struct jp_guide_cell *cell = &field->cell;

    relax_step(field, cell, (unsigned)JP_MOVE_DIRECTIONS - cell->directions_left);
    cell->directions_left--;
}

/** Goes on to the next cell of the wave. True when there is none left. */
static bool advance(struct jp_guide_field *field)
{
    int32_t x = 0;
    int32_t y = 0;
    unsigned cells = 1;
    const enum jp_wave_step step = jp_wavefront_next(&field->wave, &cells, &x, &y);

    if (step == JP_WAVE_CELL) {
        field->cell = (struct jp_guide_cell){x, y, jp_wavefront_value(&field->wave, x, y), elevation_of(field, x, y),
                                             JP_MOVE_DIRECTIONS};
    }
    return step == JP_WAVE_STOPPED;
}

/** Finds out what is open in the next row of the map. */
static void look_at_row(struct jp_guide_field *field)
{
    field->debt = LOOK_AT_PLANE * jp_open_plane_make_row(field->open, field->lattice, field->terrain, field->open_rows);
    field->open_rows++;
}

static bool has_rows_left(const struct jp_guide_field *field)
{
    return field->open != NULL && field->open_rows < field->terrain->config.height;
}

bool jp_guide_field_grow(struct jp_guide_field *field, unsigned *units)
{
    while (*units > 0U) {
        if (field_pays(&field->debt, units)) {
            continue;
        }
        if (field->cell.directions_left > 0U) {
            field->debt = PASS;
            relax_next(field);
        } else if (has_rows_left(field)) {
            look_at_row(field);
        } else if (!jp_wavefront_is_clear(&field->wave)) {
            clear(field);
            field->debt = WAVE_CELL;
        } else if (advance(field)) {
            return true;
        } else {
            field->debt = WAVE_CELL; /* for a cell, or for looking where there was none */
        }
    }
    return false;
}

bool jp_guide_field_reaches(const struct jp_guide_field *field, int32_t x, int32_t y)
{
    return jp_wavefront_value(&field->wave, x / (int32_t)field->scale, y / (int32_t)field->scale) !=
           field->wave.not_reached;
}

jp_cost jp_guide_field_estimate(const struct jp_guide_field *field, int32_t x, int32_t y, unsigned heading)
{
    const int32_t coarse_x = x / (int32_t)field->scale;
    const int32_t coarse_y = y / (int32_t)field->scale;
    const uint32_t value = jp_wavefront_value(&field->wave, coarse_x, coarse_y);

    if (value >= field->wave.horizon) {
        return jp_cost_add((jp_cost)field->wave.horizon << field->shift, 0);
    }
    return jp_cost_add(value << field->shift, turn_at(field, coarse_x, coarse_y, heading));
}
