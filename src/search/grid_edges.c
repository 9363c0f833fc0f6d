#include "src/search/grid_edges.h"

enum {
    ONE = 65536,       /* a cell, Q16 */
    ROOT_HALF = 46341, /* 1/√2, Q16 */
    STEEPEST = 64512,  /* greatest slope of the cost-to-go, in that of a way on level ground, Q16 */
    MARGIN = 1024,     /* least distance of a point within an edge from the edge's nodes, cells, Q16 */
    SIDES = 4,         /* of a square of four nodes */
    PLACE_WORK = 8,    /* of a place of the descent, for which up to sixteen edges are interpolated, expansions */
};

/* ---- Tube ---- */

static int32_t cell_of(const struct jp_grid_planner_internal *planner, int32_t metres)
{
    return metres / planner->terrain->config.resolution;
}

/** Marks the free cells of one row of the tube around cell (x, y). */
static void mark_row(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y)
{
    const int32_t tube = planner->config.tube;

    for (int32_t i = x - tube; i <= x + tube; i++) {
        if (jp_terrain_contains(planner->terrain, i, y) && !jp_grid_is_blocked(planner, i, y)) {
            jp_grid_node(planner, i, y)->place |= GRID_IN_TUBE;
        }
    }
}

/** The point at part/parts of a piece of the path. */
static struct jp_point part_of(const struct jp_point *from, const struct jp_point *to, int32_t part, int32_t parts)
{
    return (struct jp_point){from->x + (int32_t)((int64_t)(to->x - from->x) * part / parts),
                             from->y + (int32_t)((int64_t)(to->y - from->y) * part / parts)};
}

static int32_t cells_along(const struct jp_grid_planner_internal *planner, const struct jp_point *from,
                           const struct jp_point *to)
{
    const int32_t dx = to->x < from->x ? from->x - to->x : to->x - from->x;
    const int32_t dy = to->y < from->y ? from->y - to->y : to->y - from->y;

    return cell_of(planner, dx > dy ? dx : dy) + 1;
}

/** The cursor is the piece of the path; cursor_part counts the rows of the squares around its points. */
enum jp_grid_progress jp_grid_edges_mark(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    const uint32_t rows = 2U * planner->config.tube + 1U;

    for (; planner->cursor + 1U < planner->path.count; planner->cursor++, planner->cursor_part = 0) {
        const struct jp_point *from = &planner->path.points[planner->cursor];
        const struct jp_point *to = &planner->path.points[planner->cursor + 1U];
        const int32_t parts = cells_along(planner, from, to);

        for (; planner->cursor_part < ((uint32_t)parts + 1U) * rows; planner->cursor_part++, --*budget) {
            if (*budget == 0U) {
                return GRID_WORKING;
            }
            const uint32_t part = planner->cursor_part / rows;
            const uint32_t row = planner->cursor_part % rows;
            const struct jp_point at = part_of(from, to, (int32_t)part, parts);
            mark_row(planner, cell_of(planner, at.x),
                     cell_of(planner, at.y) + (int32_t)row - (int32_t)planner->config.tube);
        }
    }
    return GRID_DONE;
}

/* ---- Cost-to-go ---- */

static uint32_t settled_cost(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y)
{
    if (!jp_terrain_contains(planner->terrain, x, y)) {
        return GRID_COST_MAX;
    }
    const struct jp_grid_node *node = jp_grid_node(planner, x, y);

    return jp_grid_is_settled(node) ? node->g : GRID_COST_MAX;
}

/** Half of a square: from a node over the edge between a straight and a diagonal neighbour. */
struct triangle {
    uint32_t straight; /* cost-to-go of the neighbours, GRID_COST_MAX: not settled; at least one is */
    uint32_t diagonal;
    uint32_t straight_step; /* cost of the steps to them */
    uint32_t diagonal_step;
};

static uint32_t sum(uint32_t cost, uint32_t step)
{
    return cost == GRID_COST_MAX ? GRID_COST_MAX : cost + step;
}

/** Least cost over the edge: g1 + √(c² − d²) with d = g1 − g2 and the mean price c of a cell's width, or the straight
 *  or the diagonal step where the minimum is at an end of the edge. */
static uint32_t cost_over_edge(const struct triangle *triangle)
{
    const uint32_t straight = sum(triangle->straight, triangle->straight_step);
    const uint32_t diagonal = sum(triangle->diagonal, triangle->diagonal_step);
    const uint32_t least = straight < diagonal ? straight : diagonal;

    if (triangle->straight == GRID_COST_MAX || triangle->straight <= triangle->diagonal) {
        return least;
    }
    const uint64_t d = triangle->straight - triangle->diagonal;
    const uint64_t c = (triangle->straight_step + (((uint64_t)triangle->diagonal_step * ROOT_HALF) >> 16)) / 2U;

    if (2U * d * d >= c * c) {
        return least;
    }
    const uint32_t within = triangle->straight + jp_square_root(c * c - d * d);

    return within < least ? within : least;
}

/** Off the map, where nothing is settled, any. */
static uint32_t step_cost(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y, unsigned direction)
{
    const struct jp_grid_direction *const d = &jp_grid_directions[direction];

    return jp_terrain_contains(planner->terrain, x + d->dx, y + d->dy) ? jp_grid_step_cost(planner, x, y, direction)
                                                                       : 0U;
}

/** Least cost of a node over the two edges that its settled neighbour in a direction is part of. */
static uint32_t cost_over_neighbour(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y,
                                    unsigned direction)
{
    const unsigned around = GRID_DIRECTIONS - 1U;
    uint32_t least = GRID_COST_MAX;

    for (unsigned side = 0; side < 2U; side++) {
        const unsigned partner = (direction + (side == 0U ? 1U : around)) & around;
        const unsigned along = direction % 2U == 0U ? direction : partner;
        const unsigned across = direction % 2U == 0U ? partner : direction;
        const struct jp_grid_direction *straight = &jp_grid_directions[along];
        const struct jp_grid_direction *diagonal = &jp_grid_directions[across];
        if (jp_grid_is_blocked(planner, x + straight->dx, y + straight->dy)) {
            continue;
        }
        const struct triangle triangle = {settled_cost(planner, x + straight->dx, y + straight->dy),
                                          settled_cost(planner, x + diagonal->dx, y + diagonal->dy),
                                          step_cost(planner, x, y, along), step_cost(planner, x, y, across)};
        const uint32_t cost = cost_over_edge(&triangle);
        least = cost < least ? cost : least;
    }
    return least;
}

void jp_grid_edges_start(struct jp_grid_planner_internal *planner)
{
    planner->queue_count = 0;
    jp_grid_node(planner, planner->goal.x, planner->goal.y)->g = 0;
    (void)jp_grid_queue_put(planner, planner->goal.x, planner->goal.y, 0);
}

/** Lowers the cost-to-go of a node whose neighbour in a direction has been settled. False: the queue is full. */
static bool relax(struct jp_grid_planner_internal *planner, int32_t x, int32_t y, unsigned direction)
{
    struct jp_grid_node *node = jp_grid_node(planner, x, y);
    const uint32_t cost = cost_over_neighbour(planner, x, y, direction);

    if (cost >= node->g) {
        return true;
    }
    node->g = cost;
    return jp_grid_queue_put(planner, x, y, 0);
}

static bool relax_neighbours(struct jp_grid_planner_internal *planner, int32_t x, int32_t y)
{
    for (unsigned direction = 0; direction < (unsigned)GRID_DIRECTIONS; direction++) {
        const struct jp_grid_direction *d = &jp_grid_directions[direction];
        const int32_t next_x = x + d->dx;
        const int32_t next_y = y + d->dy;

        if (!jp_terrain_contains(planner->terrain, next_x, next_y)) {
            continue;
        }
        const struct jp_grid_node *node = jp_grid_node(planner, next_x, next_y);
        if ((node->place & GRID_IN_TUBE) != 0U && !jp_grid_is_settled(node) &&
            !relax(planner, next_x, next_y, (direction + GRID_DIRECTIONS / 2U) & (GRID_DIRECTIONS - 1U))) {
            return false;
        }
    }
    return true;
}

enum jp_grid_progress jp_grid_edges_propagate(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    while (*budget > 0U) {
        int32_t x;
        int32_t y;
        --*budget;
        if (!jp_grid_queue_take(planner, &x, &y)) {
            return GRID_IMPOSSIBLE;
        }
        planner->counts.edge_nodes++;
        if (x == planner->start.x && y == planner->start.y) {
            return GRID_DONE;
        }
        if (!relax_neighbours(planner, x, y)) {
            return GRID_FULL;
        }
    }
    return GRID_WORKING;
}

/* ---- Descent ---- */

/** Where a step of the descent may lead. */
struct successor {
    struct jp_point place; /* cells, Q16 */
    uint32_t cost;         /* interpolated cost-to-go from it */
    uint32_t total;        /* the same and that of the line to it */
};

/** An edge between two neighbouring nodes: from (x, y) east or north. */
struct grid_edge {
    int32_t x;
    int32_t y;
    bool is_northward;
    uint32_t first; /* cost-to-go of its ends */
    uint32_t second;
};

/** Change of the cost-to-go along an edge. */
static jp_q16 slope_of(const struct grid_edge *edge)
{
    return (int32_t)(edge->second - edge->first);
}

static struct jp_point point_of(const struct jp_grid_planner_internal *planner, const struct jp_point *place)
{
    const int32_t side = planner->terrain->config.resolution;

    return (struct jp_point){jp_q16_multiply(place->x, side) + side / 2, jp_q16_multiply(place->y, side) + side / 2};
}

/** What a cell's width costs on level ground at the middle of an edge whose ends are known. */
static int32_t width_cost(const struct jp_grid_planner_internal *planner, const struct grid_edge *edge)
{
    const uint32_t first = jp_grid_level_price(planner, edge->x, edge->y);
    const uint32_t second =
        jp_grid_level_price(planner, edge->x + (edge->is_northward ? 0 : 1), edge->y + (edge->is_northward ? 1 : 0));

    return (int32_t)(planner->straight * (first + second) / 512U);
}

/** The point of an edge over which the cost from a place is least: along − slope·across/√(1 − slope²). The place is at
 *  `along` and at the distance `across` from the edge; `slope` is that of the cost-to-go by what a width costs. */
static jp_q16 best_along(jp_q16 along, jp_q16 across, jp_q16 relative)
{
    const jp_q16 slope = jp_clamp32(relative, -STEEPEST, STEEPEST);
    const jp_q16 shift =
        jp_q16_divide(jp_q16_multiply(slope, across), jp_q16_square_root(ONE - jp_q16_multiply(slope, slope)));

    return jp_clamp32(jp_sub(along, shift), MARGIN, ONE - MARGIN);
}

/** A successor at a point of an edge, but for its total. At the edge's second end it is exact even when the cost of the
 *  first end is not known (GRID_COST_MAX): the unsigned sums wrap. */
static struct successor successor_at(const struct grid_edge *edge, jp_q16 along)
{
    const jp_q16 x = edge->x * ONE + (edge->is_northward ? 0 : along);
    const jp_q16 y = edge->y * ONE + (edge->is_northward ? along : 0);

    return (struct successor){.place = {x, y}, .cost = edge->first + (uint32_t)jp_q16_multiply(along, slope_of(edge))};
}

/** Only a successor of lower cost-to-go will do: so the descent cannot cycle. */
static void consider(const struct jp_grid_planner_internal *planner, const struct grid_edge *edge, jp_q16 along,
                     struct successor *best)
{
    struct successor successor = successor_at(edge, along);

    if (successor.cost >= planner->place_cost || successor.cost >= best->total) {
        return;
    }
    const struct jp_point from = point_of(planner, &planner->place);
    const struct jp_point to = point_of(planner, &successor.place);

    successor.total = successor.cost + jp_grid_line_cost(planner, &from, &to);
    if (successor.total < best->total && jp_grid_line_is_free(planner, &from, &to)) {
        *best = successor;
    }
}

/** Considers an edge: its best point and its ends. */
static void consider_edge(const struct jp_grid_planner_internal *planner, struct grid_edge *edge,
                          struct successor *best)
{
    const jp_q16 along = edge->is_northward ? planner->place.y - edge->y * ONE : planner->place.x - edge->x * ONE;
    const jp_q16 across = edge->is_northward ? planner->place.x - edge->x * ONE : planner->place.y - edge->y * ONE;

    edge->first = settled_cost(planner, edge->x, edge->y);
    edge->second =
        settled_cost(planner, edge->x + (edge->is_northward ? 0 : 1), edge->y + (edge->is_northward ? 1 : 0));
    if (across == 0) {
        return;
    }
    if (edge->first != GRID_COST_MAX) {
        consider(planner, edge, 0, best);
    }
    if (edge->second != GRID_COST_MAX) {
        consider(planner, edge, ONE, best);
    }
    if (edge->first != GRID_COST_MAX && edge->second != GRID_COST_MAX) {
        const jp_q16 slope = jp_q16_divide(slope_of(edge), width_cost(planner, edge));
        consider(planner, edge, best_along(along, across < 0 ? -across : across, slope), best);
    }
}

/** The four edges of the square whose south-west node is (x, y). */
static void consider_square(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y,
                            struct successor *best)
{
    for (int32_t side = 0; side < SIDES; side++) {
        struct grid_edge edge = {.x = x + (side == 3 ? 1 : 0), .y = y + (side == 1 ? 1 : 0), .is_northward = side >= 2};
        consider_edge(planner, &edge, best);
    }
}

/** The next place from a node, among the edges of the four squares around it, or from an edge, of the two beside it. */
static struct successor next_place(const struct jp_grid_planner_internal *planner)
{
    const int32_t x = planner->place.x / ONE;
    const int32_t y = planner->place.y / ONE;
    const int32_t first_x = planner->place.x % ONE == 0 ? x - 1 : x;
    const int32_t first_y = planner->place.y % ONE == 0 ? y - 1 : y;
    struct successor best = {.total = GRID_COST_MAX};

    for (int32_t j = first_y; j <= y; j++) {
        for (int32_t i = first_x; i <= x; i++) {
            consider_square(planner, i, j, &best);
        }
    }
    return best;
}

enum jp_grid_progress jp_grid_edges_descend(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    const unsigned work = (unsigned)PLACE_WORK;

    while (*budget > 0U) {
        *budget -= *budget < work ? *budget : work;
        if (!jp_grid_path_add(planner, &planner->candidate, point_of(planner, &planner->place), true)) {
            return GRID_FULL;
        }
        if (planner->place_cost == 0U) {
            return GRID_DONE;
        }
        const struct successor next = next_place(planner);
        if (next.total == GRID_COST_MAX) {
            return GRID_IMPOSSIBLE;
        }
        planner->place = next.place;
        planner->place_cost = next.cost;
    }
    return GRID_WORKING;
}
