#include <joulepath/energy_field.h>
#include <string.h>

enum {
    NO_WAY = 0xFFFF,   /* value of a cell that nothing has reached */
    VALUE_MAX = 0xFFFE,
    WORD_BITS = 32,
    ALIGNMENT = 8,
    STEPS_PER_THRESHOLD = 4, /* few enough to be near the order of values, many enough for few sweeps */
};

static size_t cell_count(const struct jp_terrain_config *config)
{
    return (size_t)config->width * config->height;
}

static size_t align(size_t size)
{
    return (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

static size_t dirty_words(const struct jp_terrain_config *config)
{
    return (size_t)config->height * ((config->width + (size_t)WORD_BITS - 1) / WORD_BITS);
}

size_t jp_energy_field_size(const struct jp_terrain_config *config)
{
    return align(cell_count(config) * sizeof(uint16_t)) + align(dirty_words(config) * sizeof(uint32_t));
}

void jp_energy_field_init(struct jp_energy_field *field, const struct jp_lattice *lattice, enum jp_cost_kind kind,
                          const struct jp_terrain *terrain, void *block)
{
    memset(field, 0, sizeof *field);
    field->lattice = lattice;
    field->terrain = terrain;
    field->kind = kind;
    field->values = block;
    field->dirty = (uint32_t *)(void *)((uint8_t *)block + align(cell_count(&terrain->config) * sizeof(uint16_t)));
}

static uint16_t *value_at(const struct jp_energy_field *field, int32_t x, int32_t y)
{
    return &field->values[(size_t)y * field->terrain->config.width + (size_t)x];
}

static jp_cost level_cost(const struct jp_energy_field *field, enum jp_move_kind kind)
{
    return jp_move_cost(&field->lattice->move_costs[field->kind][kind], 0);
}

/** The unit that holds four times the level way across the map. */
static uint8_t shift_for(const struct jp_energy_field *field)
{
    const struct jp_terrain_config *config = &field->terrain->config;
    const uint32_t across = ((uint32_t)config->width + config->height) * level_cost(field, JP_MOVE_AXIS) * 4;
    uint8_t shift = 0;

    while (across >> shift > VALUE_MAX) {
        shift++;
    }
    return shift;
}

static void mark_dirty(struct jp_energy_field *field, int32_t x, int32_t y)
{
    const size_t stride = ((size_t)field->terrain->config.width + WORD_BITS - 1) / WORD_BITS;

    field->dirty[(size_t)y * stride + (size_t)x / WORD_BITS] |= UINT32_C(1) << ((uint32_t)x % WORD_BITS);
    if (y < field->first_row) {
        field->first_row = (uint16_t)y;
    }
    if (y > field->last_row) {
        field->last_row = (uint16_t)y;
    }
}

static void lower(struct jp_energy_field *field, int32_t x, int32_t y, uint16_t value)
{
    struct jp_field_box *box = &field->lowered;

    *value_at(field, x, y) = value;
    mark_dirty(field, x, y);
    box->first_x = x < box->first_x ? x : box->first_x;
    box->last_x = x > box->last_x ? x : box->last_x;
    box->first_y = y < box->first_y ? y : box->first_y;
    box->last_y = y > box->last_y ? y : box->last_y;
}

static void start_sweeps(struct jp_energy_field *field, uint16_t threshold)
{
    field->threshold = threshold;
    field->lowest = NO_WAY;
    field->changed = false;
    field->row = field->first_row;
}

struct jp_field_box jp_energy_field_take_lowered(struct jp_energy_field *field)
{
    const struct jp_field_box box = field->lowered;

    field->lowered = (struct jp_field_box){INT32_MAX, INT32_MIN, INT32_MAX, INT32_MIN};
    return box;
}

void jp_energy_field_start(struct jp_energy_field *field, enum jp_field_direction direction, int32_t root_x,
                           int32_t root_y, int32_t target_x, int32_t target_y)
{
    const struct jp_terrain_config *config = &field->terrain->config;

    memset(field->values, 0xFF, cell_count(config) * sizeof(uint16_t));
    memset(field->dirty, 0, dirty_words(config) * sizeof(uint32_t));
    field->direction = direction;
    field->shift = shift_for(field);
    field->step = (uint16_t)((level_cost(field, JP_MOVE_AXIS) * STEPS_PER_THRESHOLD >> field->shift) + 1);
    field->horizon = VALUE_MAX;
    field->target_x = target_x;
    field->target_y = target_y;
    field->first_row = config->height;
    field->last_row = 0;
    (void)jp_energy_field_take_lowered(field);
    if (jp_lattice_is_open(field->lattice, field->terrain, root_x, root_y)) {
        lower(field, root_x, root_y, 0);
    }
    start_sweeps(field, field->step);
}

static uint16_t add_limited(uint32_t a, uint32_t b)
{
    return (uint16_t)(a + b > VALUE_MAX ? VALUE_MAX : a + b);
}

/** Least cost of the unit step that the robot drives between a cell and its neighbour on the far side of the root. */
static jp_cost step_cost(const struct jp_energy_field *field, unsigned direction, int32_t rise)
{
    const struct jp_move_cost *cost = &field->lattice->move_costs[field->kind][jp_move_kind_of(direction)];

    return jp_move_cost(cost, field->direction == JP_FIELD_FROM_ROOT ? rise : -rise) >> field->shift;
}

/** Tells the neighbours of a cell what it costs by way of it. */
static void relax(struct jp_energy_field *field, int32_t x, int32_t y)
{
    const struct jp_terrain *terrain = field->terrain;
    const uint32_t here = *value_at(field, x, y);
    const int32_t elevation = jp_terrain_elevation(terrain, x, y);

    for (unsigned direction = 0; direction < JP_MOVE_DIRECTIONS; direction++) {
        const int32_t nx = x + jp_move_offsets[direction].dx;
        const int32_t ny = y + jp_move_offsets[direction].dy;

        if (!jp_terrain_contains(terrain, nx, ny)) {
            continue;
        }
        const uint16_t value = *value_at(field, nx, ny);
        if (value <= here) {
            continue;
        }
        const uint32_t step = step_cost(field, direction, jp_terrain_elevation(terrain, nx, ny) - elevation);
        if (step == (JP_COST_MAX >> field->shift)) {
            continue;
        }
        const uint16_t value_by_here = add_limited(here, step);
        if (value_by_here < value && jp_lattice_is_open(field->lattice, terrain, nx, ny)) {
            lower(field, nx, ny, value_by_here);
        }
    }
}

static unsigned lowest_bit(uint32_t word)
{
    return (unsigned)__builtin_ctz(word);
}

/** Relaxes the dirty cells of a row up to the threshold. */
static unsigned sweep_row(struct jp_energy_field *field, int32_t y)
{
    const size_t stride = ((size_t)field->terrain->config.width + WORD_BITS - 1) / WORD_BITS;
    unsigned relaxed = 0;

    for (size_t i = 0; i < stride; i++) {
        uint32_t *word = &field->dirty[(size_t)y * stride + i];

        for (uint32_t rest = *word; rest != 0; rest &= rest - 1) {
            const unsigned bit = lowest_bit(rest);
            const int32_t x = (int32_t)(i * WORD_BITS + bit);
            const uint16_t value = *value_at(field, x, y);

            if (value <= field->threshold) {
                *word &= ~(UINT32_C(1) << bit);
                relax(field, x, y);
                relaxed++;
            } else if (value < field->lowest) {
                field->lowest = value;
            }
        }
    }
    field->changed |= relaxed > 0;
    return relaxed;
}

/** After a sweep: again while values change, else on to the next dirty value. True when nothing is left. */
static bool next_sweep(struct jp_energy_field *field)
{
    uint16_t threshold = field->threshold;

    if (!field->changed) {
        const uint16_t target = *value_at(field, field->target_x, field->target_y);

        if (field->horizon == VALUE_MAX && target <= threshold) {
            field->horizon = add_limited(target, target / 4U + field->step);
        }
        if (field->lowest == NO_WAY || field->lowest > field->horizon) {
            return true;
        }
        threshold = add_limited(field->lowest, field->step);
    }
    start_sweeps(field, threshold);
    return false;
}

bool jp_energy_field_grow(struct jp_energy_field *field, unsigned *cells)
{
    while (*cells > 0) {
        if (field->row > field->last_row) {
            if (next_sweep(field)) {
                return true;
            }
            continue;
        }
        const unsigned relaxed = sweep_row(field, field->row++) + 1;
        *cells -= relaxed < *cells ? relaxed : *cells;
    }
    return false;
}

jp_cost jp_energy_field_bound(const struct jp_energy_field *field, int32_t x, int32_t y)
{
    const uint32_t value = *value_at(field, x, y);

    if (value == NO_WAY && field->lowest == NO_WAY) {
        return JP_COST_MAX;
    }
    return (value < field->horizon ? value : field->horizon) << field->shift;
}

/** A dirty neighbour tells the cell again what it costs by way of it. */
static void ask_neighbours(struct jp_energy_field *field, int32_t x, int32_t y)
{
    for (unsigned direction = 0; direction < JP_MOVE_DIRECTIONS; direction++) {
        const int32_t nx = x + jp_move_offsets[direction].dx;
        const int32_t ny = y + jp_move_offsets[direction].dy;

        if (jp_terrain_contains(field->terrain, nx, ny) && *value_at(field, nx, ny) != NO_WAY) {
            mark_dirty(field, nx, ny);
        }
    }
}

void jp_energy_field_cell_changed(struct jp_energy_field *field, int32_t x, int32_t y)
{
    const struct jp_cells core = field->lattice->core;

    for (unsigned i = 0; i < core.span_count; i++) {
        const struct jp_span span = field->lattice->spans[core.first_span + i];
        for (int32_t dx = span.first; dx <= span.last; dx++) {
            ask_neighbours(field, x - dx, y - span.y);
        }
    }
    if (jp_terrain_contains(field->terrain, x, y) && *value_at(field, x, y) != NO_WAY) {
        mark_dirty(field, x, y);
    }
    start_sweeps(field, field->step);
}
