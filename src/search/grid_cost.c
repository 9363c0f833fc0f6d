#include "src/search/grid_cost.h"

#include <string.h>

#include "src/base/integer.h"
#include "src/base/point.h"

/* Price of a metre, Q8. */
#define PRICE_ONE 256

/* Along a line, from 0 to 1, Q30. */
#define LINE_ONE ((int64_t)1 << 30)

/* Costs with prices are coarser by this: so there is room for dear ways. */
#define COARSER 4U

#define GRADE_LIMIT JP_Q24(0.5)

/* A length is made more precise in steps of bits. */
#define LENGTH_BITS     4U
#define LENGTH_BITS_MAX 28U

enum {
    CELLS_PER_UNIT = 8,      /* measured for a unit of the budget */
    LINE_CELLS_PER_UNIT = 4, /* of a line that is priced, three times */
    RINGS_PER_CELL_MAX = 64,
    STEP = 5, /* to the next cell, and to a diagonal one, by which distances are counted */
    DIAGONAL_STEP = 7,
    GRADE_BITS = 19,        /* grades that are given are 2⁻⁵ apart, in Q24 */
    SHARE_OF_CORNER = 23170 /* 1/(2√2), Q16: a corner lies √2/2 away, its height is a quarter of a sum */
};

const struct jp_grid_direction jp_grid_directions[GRID_DIRECTIONS] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                                                                      {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

/* ---- Prices ---- */

/** A part of a metre's price in the whole of a level one, Q8; below 0: out of range. */
static int32_t share_of(jp_q16 part, jp_q16 metre)
{
    const int64_t share = (int64_t)part * PRICE_ONE / metre;

    return part < 0 ? -1 : (int32_t)(share < JP_GRID_PART_MAX * PRICE_ONE ? share : JP_GRID_PART_MAX * PRICE_ONE);
}

static bool take(const jp_q16 *parts, size_t count, jp_q16 metre, uint16_t base, uint16_t *prices)
{
    for (size_t i = 0; i < count; i++) {
        const int32_t share = share_of(parts[i], metre);

        if (share < 0) {
            return false;
        }
        prices[i] = (uint16_t)(base + (uint16_t)share);
    }
    return true;
}

static bool take_all(struct jp_grid_planner_internal *planner, const struct jp_grid_prices *prices)
{
    const int64_t resolution = planner->terrain->config.resolution;

    planner->straight = GRID_STRAIGHT >> COARSER;
    planner->diagonal = (GRID_DIAGONAL >> COARSER) + 1U;
    planner->length_max = (uint32_t)JP_GRID_PRICE_MAX * planner->straight;
    planner->grade_per_unit = ((int64_t)1 << 30) / resolution;
    if (prices->metre <= 0 || (int64_t)prices->ring * RINGS_PER_CELL_MAX < resolution) {
        return false;
    }
    planner->metre = prices->metre;
    planner->rise = prices->rise;
    planner->ring_cells = jp_saturate32((int64_t)prices->ring * JP_Q16_ONE / resolution);
    return take(prices->near, JP_GRID_RINGS, prices->metre, PRICE_ONE, &planner->near[1]) &&
           take(prices->slope, JP_GRID_GRADES, prices->metre, 0, planner->slope);
}

bool jp_grid_take_prices(struct jp_grid_planner_internal *planner)
{
    const struct jp_grid_prices *const prices = planner->config.prices;

    planner->near[0] = PRICE_ONE;
    planner->straight = GRID_STRAIGHT;
    planner->diagonal = GRID_DIAGONAL;
    planner->length_max = (uint32_t)JP_GRID_LENGTH_MAX * GRID_STRAIGHT;
    planner->is_priced = prices != NULL;
    planner->config.prices = NULL;
    return prices == NULL || take_all(planner, prices);
}

/* ---- Rings ---- */

/** Beyond every ring, in steps; also from off the map, where everything is blocked. */
static uint32_t distance_at(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y)
{
    return jp_terrain_contains(planner->terrain, x, y) ? jp_grid_node(planner, x, y)->g : 0U;
}

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/** By the four neighbours of which `side` is +1 behind in the order of the cells, −1 ahead. */
static uint32_t distance_over(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y, int32_t side)
{
    const uint32_t straight = least(distance_at(planner, x - side, y), distance_at(planner, x, y - side));
    const uint32_t diagonal = least(distance_at(planner, x - side, y - side), distance_at(planner, x + side, y - side));

    return least(straight + (uint32_t)STEP, diagonal + (uint32_t)DIAGONAL_STEP);
}

/** Beyond it every cell is in the same ring: none. */
static uint32_t farthest(const struct jp_grid_planner_internal *planner)
{
    return (uint32_t)(((int64_t)planner->ring_cells * STEP * (int64_t)JP_GRID_RINGS) >> 16) + 1U;
}

/** Blocked cells are in the first ring, too: lines touch them. */
static uint32_t ring_of(const struct jp_grid_planner_internal *planner, uint32_t distance)
{
    const int64_t width = (int64_t)planner->ring_cells * STEP;
    const int64_t ring = (((int64_t)distance << 16) + width - 1) / width;

    return ring > (int64_t)JP_GRID_RINGS ? 0U : (uint32_t)(ring > 0 ? ring : 1);
}

bool jp_grid_measure(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    const uint32_t cells = jp_grid_cell_count(planner);
    const uint32_t width = planner->terrain->config.width;
    const uint32_t most = farthest(planner);

    for (; *budget > 0U && planner->cursor < cells; --*budget) {
        for (unsigned i = 0; i < (unsigned)CELLS_PER_UNIT && planner->cursor < cells; i++, planner->cursor++) {
            const uint32_t column = planner->cursor % width;
            const uint32_t row = planner->cursor / width;
            const int32_t x = (int32_t)column;
            const int32_t y = (int32_t)row;

            jp_grid_node(planner, x, y)->g =
                jp_grid_is_blocked(planner, x, y) ? 0U : least(distance_over(planner, x, y, 1), most);
        }
    }
    return planner->cursor == cells;
}

bool jp_grid_measure_back(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    const uint32_t cells = jp_grid_cell_count(planner);
    const uint32_t width = planner->terrain->config.width;

    for (; *budget > 0U && planner->cursor < cells; --*budget) {
        for (unsigned i = 0; i < (unsigned)CELLS_PER_UNIT && planner->cursor < cells; i++, planner->cursor++) {
            const uint32_t cell = cells - 1U - planner->cursor;
            const uint32_t column = cell % width;
            const uint32_t row = cell / width;
            struct jp_grid_node *const node = &planner->nodes[cell];

            node->g = least(node->g, distance_over(planner, (int32_t)column, (int32_t)row, -1));
            node->place = ring_of(planner, node->g) << GRID_RING_SHIFT;
        }
    }
    return planner->cursor == cells;
}

/* ---- Slopes ---- */

/** Q8; by a grade in Q24. */
static uint32_t slope_price(const struct jp_grid_planner_internal *planner, int64_t grade)
{
    const int64_t within = grade < -GRADE_LIMIT ? -GRADE_LIMIT : (grade > GRADE_LIMIT ? GRADE_LIMIT : grade);
    const uint32_t at = (uint32_t)(within + GRADE_LIMIT);
    const uint32_t index = at >> GRADE_BITS;
    const int32_t part = (int32_t)(at & ((UINT32_C(1) << GRADE_BITS) - 1U));
    const int32_t first = planner->slope[index];

    if (index + 1U >= JP_GRID_GRADES) {
        return (uint32_t)first;
    }
    return (uint32_t)(first + (int32_t)(((int64_t)(planner->slope[index + 1U] - first) * part) >> GRADE_BITS));
}

/** Sum of a step's two halves, Q8. */
static uint32_t slopes_of_step(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y,
                               const struct jp_grid_direction *d)
{
    const struct jp_terrain *const terrain = planner->terrain;
    const int64_t from = jp_terrain_elevation(terrain, x, y);
    const int64_t to = jp_terrain_elevation(terrain, x + d->dx, y + d->dy);

    if (d->dx == 0 || d->dy == 0) {
        return 2U * slope_price(planner, (to - from) * planner->grade_per_unit);
    }
    const int64_t corners =
        from + to + jp_terrain_elevation(terrain, x + d->dx, y) + jp_terrain_elevation(terrain, x, y + d->dy);
    const int64_t per_unit = (planner->grade_per_unit * SHARE_OF_CORNER) >> 16;
    const int64_t first = corners - 4 * from;
    const int64_t second = 4 * to - corners;

    return slope_price(planner, first * per_unit) + slope_price(planner, second * per_unit);
}

uint32_t jp_grid_step_cost(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y, unsigned direction)
{
    const struct jp_grid_direction *const d = &jp_grid_directions[direction];
    const uint32_t length = direction % 2U != 0U ? planner->diagonal : planner->straight;

    if (!planner->is_priced) {
        return length;
    }
    const uint32_t level = jp_grid_level_price(planner, x, y) + jp_grid_level_price(planner, x + d->dx, y + d->dy);
    const uint32_t slopes = planner->terrain->config.has_elevation ? slopes_of_step(planner, x, y, d) : 0U;

    return length * (level + slopes) / (2U * (uint32_t)PRICE_ONE);
}

/* ---- Lines ---- */

/** A line along an axis. */
struct axis {
    int32_t cell;
    int32_t step;  /* to the next cell */
    int64_t next;  /* where on the line it is entered */
    int64_t width; /* of a cell on the line */
};

static struct axis axis_of(int32_t from, int32_t to, int32_t side)
{
    const int32_t length = to - from;

    if (length == 0) {
        return (struct axis){from / side, 0, INT64_MAX, 0};
    }
    const int32_t cell = length > 0 ? from / side : (from - 1) / side;
    const int32_t left = length > 0 ? (cell + 1) * side - from : from - cell * side;
    const int32_t along = length > 0 ? length : -length;

    return (struct axis){cell, length > 0 ? 1 : -1, left * LINE_ONE / along, side * LINE_ONE / along};
}

static void pass(struct axis *axis, int64_t at)
{
    if (axis->next <= at) {
        axis->cell += axis->step;
        axis->next += axis->width;
    }
}

/** Rounding may lead a line's end off the map. */
static uint32_t price_at(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y)
{
    return jp_terrain_contains(planner->terrain, x, y) ? jp_grid_level_price(planner, x, y) : planner->near[1];
}

static struct jp_point point_at(const struct jp_point *from, const struct jp_point *to, int64_t at)
{
    return (struct jp_point){from->x + (int32_t)(((int64_t)(to->x - from->x) * at) >> 30),
                             from->y + (int32_t)(((int64_t)(to->y - from->y) * at) >> 30)};
}

/** Of a piece of a line of which the height at its end is known; m in Q16. */
static uint32_t slope_of_piece(const struct jp_grid_planner_internal *planner, int64_t rise, int64_t length)
{
    return length > 0 ? slope_price(planner, rise * ((int64_t)1 << 24) / length) : 0U;
}

/** A length as precise as a root is: below 2³², in 2^−bits of the map's unit. */
struct length {
    int64_t value;
    unsigned bits;
};

static struct length length_of(const struct jp_point *from, const struct jp_point *to)
{
    const int64_t dx = (int64_t)to->x - from->x;
    const int64_t dy = (int64_t)to->y - from->y;
    uint64_t square = (uint64_t)(dx * dx) + (uint64_t)(dy * dy); /* at most 2⁵⁸ */
    unsigned bits = 0;

    while (square >> 54 == 0U && bits < LENGTH_BITS_MAX) {
        square <<= 2U * LENGTH_BITS;
        bits += LENGTH_BITS;
    }
    return (struct length){(int64_t)jp_square_root(square), bits};
}

uint64_t jp_grid_line_price(const struct jp_grid_planner_internal *planner, const struct jp_point *from,
                            const struct jp_point *to)
{
    const struct jp_terrain_config *const map = &planner->terrain->config;

    if (!planner->is_priced) {
        return (uint64_t)jp_distance(from, to) * (uint64_t)PRICE_ONE;
    }
    const struct length length = length_of(from, to);
    struct axis x = axis_of(from->x, to->x, map->resolution);
    struct axis y = axis_of(from->y, to->y, map->resolution);
    jp_q16 height = map->has_elevation ? jp_terrain_height(planner->terrain, from) : 0;
    int64_t sum = 0; /* Q38 */
    int64_t at = 0;

    while (at < LINE_ONE) {
        const int64_t before = at;
        const int64_t crossing = x.next < y.next ? x.next : y.next;
        uint32_t price = price_at(planner, x.cell, y.cell);

        at = crossing < LINE_ONE ? crossing : LINE_ONE;
        if (map->has_elevation) {
            const struct jp_point there = point_at(from, to, at);
            const jp_q16 next = jp_terrain_height(planner->terrain, &there);

            price +=
                slope_of_piece(planner, (int64_t)next - height, ((length.value >> length.bits) * (at - before)) >> 30);
            height = next;
        }
        sum += (at - before) * (int64_t)price;
        pass(&x, at);
        pass(&y, at);
    }
    return (uint64_t)(((sum >> 14) * length.value) >> (16U + length.bits));
}

unsigned jp_grid_line_units(const struct jp_grid_planner_internal *planner, const struct jp_point *from,
                            const struct jp_point *to)
{
    const int32_t dx = from->x < to->x ? to->x - from->x : from->x - to->x;
    const int32_t dy = from->y < to->y ? to->y - from->y : from->y - to->y;
    const int32_t cells = (dx + dy) / planner->terrain->config.resolution;
    const int32_t units = cells / (int32_t)LINE_CELLS_PER_UNIT;

    return planner->is_priced ? 1U + (unsigned)units : 1U;
}

uint32_t jp_grid_line_cost(const struct jp_grid_planner_internal *planner, const struct jp_point *from,
                           const struct jp_point *to)
{
    const uint64_t price = jp_grid_line_price(planner, from, to); /* at most 2⁴⁵ */

    return (uint32_t)(price * (planner->straight / (uint32_t)PRICE_ONE) /
                      (uint64_t)planner->terrain->config.resolution);
}
