#include <joulepath/lattice.h>

#include "src/map/terrain_cells.h"

const struct jp_cell_offset jp_move_offsets[JP_MOVE_DIRECTIONS] = {
    {1, 0},  {2, 1},   {1, 1},   {1, 2},   {0, 1},  {-1, 2}, {-1, 1}, {-2, 1},
    {-1, 0}, {-2, -1}, {-1, -1}, {-1, -2}, {0, -1}, {1, -2}, {1, -1}, {2, -1},
};

enum { FRACTION_BITS = 16, RISE_MAX = 4096 };

jp_cost jp_move_cost(const struct jp_slope_cost *cost, int32_t rise)
{
    if (rise > cost->rise_max || rise < -cost->rise_max) {
        return JP_COST_MAX;
    }
    /* 32 bits are enough: jp_slope_cost_is_valid(). */
    const struct jp_polynomial *side = rise >= cost->bend ? &cost->climb : &cost->descend;
    const int32_t value = (side->constant + (side->linear + side->quadratic * rise) * rise) >> FRACTION_BITS;

    return value < (int32_t)cost->floor ? cost->floor : (jp_cost)value;
}

/** Least cost over all rises of a unit step less slope · rise; in 2⁻¹⁶ cost units. */
static int64_t least_level_part(const struct jp_slope_cost *cost, int32_t slope)
{
    int64_t least = INT64_MAX;

    for (int32_t rise = -cost->rise_max; rise <= cost->rise_max; rise++) {
        const int64_t part = ((int64_t)jp_move_cost(cost, rise) << FRACTION_BITS) - (int64_t)slope * rise;
        least = part < least ? part : least;
    }
    return least;
}

void jp_lattice_straight(const struct jp_lattice *lattice, enum jp_cost_kind kind, struct jp_straight *straight)
{
    static const int64_t lengths[JP_MOVE_KINDS] = {65536, 146543, 92682}; /* 1, √5, √2 cells in Q16, rounded up */
    const struct jp_slope_cost *costs = lattice->move_costs[kind];

    straight->per_rise = costs[JP_MOVE_AXIS].climb.linear;
    straight->per_cell = INT64_MAX;
    for (unsigned move = 0; move < (unsigned)JP_MOVE_KINDS; move++) {
        const int64_t part = least_level_part(&costs[move], straight->per_rise) * (1 << FRACTION_BITS) / lengths[move];
        straight->per_cell = part < straight->per_cell ? part : straight->per_cell;
    }
}

jp_cost jp_straight_bound(const struct jp_straight *straight, int32_t dx, int32_t dy, int32_t rise)
{
    if (straight->per_cell < 0) {
        return 0;
    }
    const int64_t square = (int64_t)dx * dx + (int64_t)dy * dy;
    const int64_t cells = jp_square_root((uint64_t)square << FRACTION_BITS); /* Q8 */
    const int64_t level = (straight->per_cell * cells) >> (FRACTION_BITS / 2);
    const int64_t bound = (level + (int64_t)straight->per_rise * rise) >> FRACTION_BITS;

    return bound < 0 ? 0U : bound < (int64_t)JP_COST_MAX ? (jp_cost)bound : JP_COST_MAX - 1U;
}

/** A cost of 16 bits, or JP_COST_MAX, times the factor of a cell, which is at most 256: below JP_COST_MAX. */
static jp_cost times_factor(const struct jp_terrain *terrain, jp_cost cost, uint32_t cell_cost)
{
    const unsigned shift = terrain->config.cost_shift;

    return cost == JP_COST_MAX ? cost : (cost * ((UINT32_C(1) << shift) + cell_cost)) >> shift;
}

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

/** A cost of 16 bits, or JP_COST_MAX, with a share of another one of 16 bits, in 1/(4 JP_GROUND_ONE): at most 65 535,
 *  or JP_COST_MAX. */
static jp_cost with_share(jp_cost cost, jp_cost of, uint32_t share)
{
    const uint32_t sum = cost + (of * share) / (4U * JP_GROUND_ONE);

    if (cost == JP_COST_MAX) {
        return cost;
    }
    return sum < (uint32_t)UINT16_MAX ? sum : (uint32_t)UINT16_MAX;
}

/** What the ground takes more under the wheels of both sides of a robot on a cell that looks along a direction: the sum
 *  of both, in 1/JP_GROUND_ONE. */
struct ground_charge {
    uint32_t straight;
    uint32_t turning;
};

static struct ground_charge charge_of(const struct jp_lattice *lattice, enum jp_cost_kind kind,
                                      const struct jp_terrain *terrain, int32_t x, int32_t y, unsigned direction)
{
    const struct jp_cell_offset side = lattice->sides[direction];
    const struct jp_ground_price *left = &lattice->ground[terrain_class(terrain, x + side.dx, y + side.dy)];
    const struct jp_ground_price *right = &lattice->ground[terrain_class(terrain, x - side.dx, y - side.dy)];

    if (terrain->classes == NULL || kind != JP_COST_PHYSICAL) {
        return (struct ground_charge){0, 0};
    }
    return (struct ground_charge){(uint32_t)left->straight + right->straight, (uint32_t)left->turning + right->turning};
}

static jp_cost charged_energy(const struct jp_lattice *lattice, enum jp_cost_kind kind,
                              const struct jp_terrain *terrain, const struct jp_primitive *primitive, int32_t x,
                              int32_t y)
{
    const uint8_t *move = &lattice->moves[primitive->first_move];
    const uint8_t *end = &move[primitive->move_count];
    uint32_t largest = terrain_cost(terrain, x, y);
    uint32_t turning = charge_of(lattice, kind, terrain, x, y, primitive->start).turning;
    jp_cost sum = 0;

    for (; move != end; move++) {
        const struct jp_slope_cost *costs = &lattice->move_costs[kind][jp_move_kind_of(*move)];
        const int32_t elevation = terrain_elevation(terrain, x, y);
        const uint32_t before = terrain_cost(terrain, x, y);
        const uint32_t begin = charge_of(lattice, kind, terrain, x, y, *move).straight;
        x += jp_move_offsets[*move].dx;
        y += jp_move_offsets[*move].dy;
        const struct ground_charge here = charge_of(lattice, kind, terrain, x, y, *move);
        const uint32_t dearer = larger(before, terrain_cost(terrain, x, y));
        const int32_t rise = terrain_elevation(terrain, x, y) - elevation;
        const jp_cost cost = with_share(jp_move_cost(costs, rise), jp_move_cost(costs, 0), begin + here.straight);
        sum = jp_cost_add(sum, times_factor(terrain, cost, dearer));
        largest = larger(largest, dearer);
        turning = larger(turning, here.turning);
    }
    const uint16_t base = primitive->base[kind];

    return jp_cost_add(sum, times_factor(terrain, with_share(base, base, 2U * turning), largest));
}

jp_cost jp_lattice_energy(const struct jp_lattice *lattice, enum jp_cost_kind kind, const struct jp_terrain *terrain,
                          const struct jp_primitive *primitive, int32_t x, int32_t y)
{
    if (terrain->costs != NULL || terrain->classes != NULL) {
        return charged_energy(lattice, kind, terrain, primitive, x, y);
    }
    const uint8_t *moves = &lattice->moves[primitive->first_move];
    jp_cost sum = primitive->base[kind];
    int32_t elevation = terrain_elevation(terrain, x, y);

    for (unsigned i = 0; i < primitive->move_count; i++) {
        const struct jp_cell_offset offset = jp_move_offsets[moves[i]];
        x += offset.dx;
        y += offset.dy;
        const int32_t next = terrain_elevation(terrain, x, y);
        sum = jp_cost_add(sum, jp_move_cost(&lattice->move_costs[kind][jp_move_kind_of(moves[i])], next - elevation));
        elevation = next;
    }
    return sum;
}

void jp_lattice_turns(const struct jp_lattice *lattice, enum jp_cost_kind kind, struct jp_turns *turns)
{
    for (unsigned from = 0; from < JP_HEADINGS; from++) {
        for (unsigned to = 0; to < JP_HEADINGS; to++) {
            turns->cost[from][to] = from == to ? 0U : UINT16_MAX;
        }
    }
    for (unsigned i = 0; i < lattice->first_from[JP_HEADINGS]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];
        uint16_t *cost = &turns->cost[primitive->start][primitive->end];
        *cost = primitive->base[kind] < *cost ? primitive->base[kind] : *cost;
    }
    for (unsigned by = 0; by < JP_HEADINGS; by++) {
        for (unsigned from = 0; from < JP_HEADINGS; from++) {
            for (unsigned to = 0; to < JP_HEADINGS; to++) {
                const uint32_t cost = (uint32_t)turns->cost[from][by] + turns->cost[by][to];
                if (cost < turns->cost[from][to]) {
                    turns->cost[from][to] = (uint16_t)cost;
                }
            }
        }
    }
}

static bool is_clear(const struct jp_lattice *lattice, const struct jp_terrain *terrain, struct jp_cells cells,
                     int32_t x, int32_t y)
{
    return jp_terrain_is_clear(terrain, &lattice->spans[cells.first_span], cells.span_count, x, y);
}

bool jp_lattice_is_clear(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                         const struct jp_primitive *primitive, int32_t x, int32_t y)
{
    const struct jp_cells swept = {primitive->first_span, primitive->span_count};

    return is_clear(lattice, terrain, swept, x, y);
}

jp_cost jp_lattice_cost(const struct jp_lattice *lattice, enum jp_cost_kind kind, const struct jp_terrain *terrain,
                        const struct jp_primitive *primitive, int32_t x, int32_t y)
{
    return jp_lattice_is_clear(lattice, terrain, primitive, x, y)
               ? jp_lattice_energy(lattice, kind, terrain, primitive, x, y)
               : JP_COST_MAX;
}

bool jp_lattice_can_stand(const struct jp_lattice *lattice, const struct jp_terrain *terrain, int32_t x, int32_t y,
                          unsigned heading)
{
    return is_clear(lattice, terrain, lattice->footprint[heading], x, y);
}

/** True when cell (dx, dy) is one of them. */
static bool hold(const struct jp_lattice *lattice, struct jp_cells cells, int32_t dx, int32_t dy)
{
    for (unsigned i = 0; i < cells.span_count; i++) {
        const struct jp_span *span = &lattice->spans[cells.first_span + i];
        if (span->y == dy && span->first <= dx && span->last >= dx) {
            return true;
        }
    }
    return false;
}

bool jp_lattice_core_holds(const struct jp_lattice *lattice, int32_t dx, int32_t dy)
{
    return hold(lattice, lattice->core, dx, dy);
}

bool jp_lattice_is_open(const struct jp_lattice *lattice, const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    return is_clear(lattice, terrain, lattice->core, x, y);
}

static bool is_32_bits(int64_t value)
{
    return value >= INT32_MIN && value <= INT32_MAX;
}

/** True when no part of the sum leaves 32 bits, in the order in which jp_move_cost() computes it. */
static bool fits(const struct jp_polynomial *polynomial, int32_t rise)
{
    const int64_t quadratic = (int64_t)polynomial->quadratic * rise;
    const int64_t factor = polynomial->linear + quadratic;
    const int64_t product = factor * rise;

    return is_32_bits(quadratic) && is_32_bits(factor) && is_32_bits(product) &&
           is_32_bits(polynomial->constant + product);
}

bool jp_slope_cost_is_valid(const struct jp_slope_cost *cost)
{
    if (cost->rise_max < 1 || cost->rise_max > RISE_MAX || cost->floor < 1U) {
        return false;
    }
    for (int32_t rise = -cost->rise_max; rise <= cost->rise_max; rise++) {
        if (!fits(rise >= cost->bend ? &cost->climb : &cost->descend, rise)) {
            return false;
        }
    }
    return true;
}

static bool are_move_costs(const struct jp_lattice *lattice)
{
    for (unsigned kind = 0; kind < (unsigned)JP_COST_KINDS; kind++) {
        for (unsigned move = 0; move < (unsigned)JP_MOVE_KINDS; move++) {
            if (!jp_slope_cost_is_valid(&lattice->move_costs[kind][move])) {
                return false;
            }
        }
    }
    return true;
}

static bool are_ground_prices(const struct jp_lattice *lattice)
{
    for (unsigned i = 0; i < JP_GROUND_CLASSES; i++) {
        if (lattice->ground[i].straight > JP_GROUND_SHARE_MAX || lattice->ground[i].turning > JP_GROUND_SHARE_MAX) {
            return false;
        }
    }
    return true;
}

/** Their cells are swept, so that changes of their classes count. */
static bool are_sides(const struct jp_lattice *lattice)
{
    for (unsigned i = 0; i < (unsigned)JP_MOVE_DIRECTIONS; i++) {
        if (!jp_lattice_core_holds(lattice, lattice->sides[i].dx, lattice->sides[i].dy) ||
            !jp_lattice_core_holds(lattice, -lattice->sides[i].dx, -lattice->sides[i].dy)) {
            return false;
        }
    }
    return true;
}

static bool are_headings(const struct jp_lattice *lattice)
{
    for (unsigned heading = 1; heading < JP_HEADINGS; heading++) {
        if (lattice->heading[heading] <= lattice->heading[heading - 1U]) {
            return false;
        }
    }
    return lattice->heading[0] == 0U;
}

/** True when the moves of a primitive lead from its start to its end and its cost is above 0. */
static bool is_primitive(const struct jp_lattice *lattice, const struct jp_primitive *primitive)
{
    int32_t dx = 0;
    int32_t dy = 0;

    if (primitive->start >= JP_HEADINGS || primitive->end >= JP_HEADINGS) {
        return false;
    }
    for (unsigned i = 0; i < primitive->move_count; i++) {
        const uint8_t direction = lattice->moves[primitive->first_move + i];
        if (direction >= JP_MOVE_DIRECTIONS) {
            return false;
        }
        dx += jp_move_offsets[direction].dx;
        dy += jp_move_offsets[direction].dy;
    }
    for (unsigned kind = 0; kind < (unsigned)JP_COST_KINDS; kind++) {
        if (primitive->move_count == 0U && primitive->base[kind] == 0U) {
            return false;
        }
    }
    return dx == primitive->dx && dy == primitive->dy;
}

static bool are_starts(const struct jp_lattice *lattice)
{
    if (lattice->first_from[0] != 0U) {
        return false;
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        if (lattice->first_from[heading + 1U] - lattice->first_from[heading] > JP_PRIMITIVES_PER_HEADING_MAX) {
            return false;
        }
        for (unsigned i = lattice->first_from[heading]; i < lattice->first_from[heading + 1U]; i++) {
            if (!is_primitive(lattice, &lattice->primitives[i]) || lattice->primitives[i].start != heading) {
                return false;
            }
        }
    }
    return true;
}

static bool are_ends(const struct jp_lattice *lattice)
{
    const unsigned count = lattice->first_from[JP_HEADINGS];

    if (lattice->first_to[0] != 0U || lattice->first_to[JP_HEADINGS] != count) {
        return false;
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        for (unsigned i = lattice->first_to[heading]; i < lattice->first_to[heading + 1U]; i++) {
            if (lattice->by_end[i] >= count || lattice->primitives[lattice->by_end[i]].end != heading) {
                return false;
            }
        }
    }
    return true;
}

/** True when one span of the cells holds all of another. */
static bool holds(const struct jp_lattice *lattice, struct jp_cells cells, const struct jp_span *span)
{
    for (unsigned i = 0; i < cells.span_count; i++) {
        const struct jp_span *other = &lattice->spans[cells.first_span + i];
        if (other->y == span->y && other->first <= span->first && other->last >= span->last) {
            return true;
        }
    }
    return false;
}

/** True when the reach of a heading holds all cells that its primitives sweep. */
static bool is_reach(const struct jp_lattice *lattice, unsigned heading)
{
    const struct jp_cells reach = lattice->reach[heading];

    for (unsigned i = 0; i < reach.span_count; i++) {
        const struct jp_span *span = &lattice->spans[reach.first_span + i];
        if (span->first > span->last) {
            return false;
        }
    }
    for (unsigned i = lattice->first_from[heading]; i < lattice->first_from[heading + 1U]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];
        for (unsigned span = 0; span < primitive->span_count; span++) {
            if (!holds(lattice, reach, &lattice->spans[primitive->first_span + span])) {
                return false;
            }
        }
    }
    return true;
}

/** True when all primitives sweep the cells where they begin and end, so that none leads off the map. */
static bool are_ends_swept(const struct jp_lattice *lattice)
{
    for (unsigned i = 0; i < lattice->first_from[JP_HEADINGS]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];
        const struct jp_cells swept = {primitive->first_span, primitive->span_count};

        if (!hold(lattice, swept, 0, 0) || !hold(lattice, swept, primitive->dx, primitive->dy)) {
            return false;
        }
    }
    return true;
}

static bool are_spans(const struct jp_lattice *lattice)
{
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        if (!is_reach(lattice, heading)) {
            return false;
        }
    }
    return lattice->core.span_count > 0U && are_ends_swept(lattice);
}

enum jp_status jp_lattice_check(const struct jp_lattice *lattice, const char **field)
{
    if (lattice == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *field = lattice->resolution <= 0                              ? "resolution"
             : !are_headings(lattice)                              ? "heading"
             : lattice->primitives == NULL || !are_starts(lattice) ? "primitives"
             : lattice->by_end == NULL || !are_ends(lattice)       ? "by_end"
             : lattice->spans == NULL || !are_spans(lattice)       ? "spans"
             : !are_move_costs(lattice)                            ? "move_costs"
             : !are_ground_prices(lattice)                         ? "ground"
             : !are_sides(lattice)                                 ? "sides"
                                                                   : NULL;
    return *field == NULL ? JP_OK : JP_ERR_CONFIG;
}
