#include "src/search/grid_search.h"

#include "src/base/compiler.h"

enum { STEPS_PER_UNIT = 16 /* of diagonal runs, for a unit of the budget */ };

static uint32_t distance_along(int32_t a, int32_t b)
{
    return (uint32_t)(a < b ? b - a : a - b);
}

/** Octile distance to the goal at the least price. */
static uint32_t heuristic(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y)
{
    const uint32_t dx = distance_along(x, planner->goal.x);
    const uint32_t dy = distance_along(y, planner->goal.y);

    return dx < dy ? dx * planner->diagonal + (dy - dx) * planner->straight
                   : dy * planner->diagonal + (dx - dy) * planner->straight;
}

static bool is_goal(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y)
{
    return x == planner->goal.x && y == planner->goal.y;
}

/** Runs of several steps cost the same on every cell. */
static bool uses_runs(const struct jp_grid_planner_internal *planner)
{
    return planner->config.method != JP_GRID_OCTILE && !planner->is_priced;
}

/** Level cells, Q16. */
static jp_q16 octile_length(const struct jp_grid_planner_internal *planner, uint32_t cost)
{
    return jp_saturate32((int64_t)cost * (int64_t)(GRID_STRAIGHT / planner->straight));
}

/** True when a step from a cell is free: a diagonal one also needs both cells beside it. */
static bool can_step(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y,
                     const struct jp_grid_direction *d)
{
    return !jp_grid_is_blocked(planner, x + d->dx, y + d->dy) && !jp_grid_is_blocked(planner, x + d->dx, y) &&
           !jp_grid_is_blocked(planner, x, y + d->dy);
}

/* ---- Runs ---- */

/** A plane of blocked cells and its words a row. */
struct plane {
    const uint32_t *words;
    uint32_t stride;
};

/** A word of a row of the plane, shifted so that each bit shows the cell before it in the direction of the run. */
static uint32_t bits_behind(const uint32_t *row, uint32_t word, uint32_t stride, bool ascending)
{
    if (ascending) {
        return (row[word] << 1) | (word > 0U ? row[word - 1U] >> (GRID_WORD_BITS - 1U) : 1U);
    }
    return (row[word] >> 1) | ((word + 1U < stride ? row[word + 1U] & 1U : 1U) << (GRID_WORD_BITS - 1U));
}

/** Free cells of a row whose cell before them is blocked: beside a run they are forced neighbours. */
static uint32_t openings(const uint32_t *row, uint32_t word, uint32_t stride, bool ascending)
{
    return bits_behind(row, word, stride, ascending) & ~row[word];
}

/** The first cell from bit `from` of a row on that ends a run: it is blocked or has a forced neighbour. The border of
 *  the map ends every run. */
static uint32_t run_end(const struct plane *plane, int32_t row_index, uint32_t from, bool ascending)
{
    const uint32_t line = (uint32_t)(row_index + 1);
    const uint32_t *below = &plane->words[(line - 1U) * plane->stride];
    const uint32_t *row = &plane->words[line * plane->stride];
    const uint32_t *above = &plane->words[(line + 1U) * plane->stride];
    uint32_t word = from / GRID_WORD_BITS;
    uint32_t mask =
        ascending ? UINT32_MAX << (from % GRID_WORD_BITS) : UINT32_MAX >> (GRID_WORD_BITS - 1U - from % GRID_WORD_BITS);

    for (;;) {
        const uint32_t ends = (row[word] | openings(below, word, plane->stride, ascending) |
                               openings(above, word, plane->stride, ascending)) &
                              mask;
        if (ends != 0U) {
            const uint32_t bit = ascending ? JP_TRAILING_ZEROS(ends) : GRID_WORD_BITS - 1U - JP_LEADING_ZEROS(ends);
            return word * GRID_WORD_BITS + bit;
        }
        word = ascending ? word + 1U : word - 1U;
        mask = UINT32_MAX;
    }
}

/** The next jump point along a row of a plane from `at`; below 0: there is none. */
static int32_t run_along(const struct plane *plane, int32_t row, int32_t at, int32_t step, int32_t goal_row,
                         int32_t goal_at)
{
    const int32_t end = (int32_t)run_end(plane, row, (uint32_t)(at + 1 + step), step > 0) - 1;
    const bool passes_goal = row == goal_row && (goal_at - at) * step > 0 && (end - goal_at) * step > 0;

    if (passes_goal) {
        return goal_at;
    }
    const uint32_t column = (uint32_t)(end + 1);
    const uint32_t line = (uint32_t)(row + 1);
    const uint32_t word = plane->words[line * plane->stride + column / GRID_WORD_BITS];

    return ((word >> (column % GRID_WORD_BITS)) & 1U) != 0U ? -1 : end;
}

static bool run_straight(const struct jp_grid_planner_internal *planner, int32_t *x, int32_t *y,
                         const struct jp_grid_direction *d)
{
    const struct plane rows = {planner->rows, planner->row_words};
    const struct plane columns = {planner->columns, planner->column_words};
    const int32_t at = d->dy == 0 ? run_along(&rows, *y, *x, d->dx, planner->goal.y, planner->goal.x)
                                  : run_along(&columns, *x, *y, d->dy, planner->goal.x, planner->goal.y);

    if (at < 0) {
        return false;
    }
    *(d->dy == 0 ? x : y) = at;
    return true;
}

static bool has_straight_run(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y, int8_t dx, int8_t dy)
{
    const struct jp_grid_direction d = {dx, dy};

    return run_straight(planner, &x, &y, &d);
}

static bool run_diagonal(const struct jp_grid_planner_internal *planner, int32_t *x, int32_t *y,
                         const struct jp_grid_direction *d, uint32_t *steps)
{
    while (can_step(planner, *x, *y, d)) {
        *x += d->dx;
        *y += d->dy;
        ++*steps;
        if (is_goal(planner, *x, *y) || has_straight_run(planner, *x, *y, d->dx, 0) ||
            has_straight_run(planner, *x, *y, 0, d->dy)) {
            return true;
        }
    }
    return false;
}

/* ---- Expansion ---- */

/** The natural and forced neighbours of a cell that was reached in a direction, a bit for each direction. All others
 * are reached as cheaply without this cell. */
static unsigned directions_on(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y, unsigned direction)
{
    const unsigned around = GRID_DIRECTIONS - 1U;
    unsigned set = 1U << direction;

    if (direction % 2U != 0U) {
        return set | (1U << (direction - 1U)) | (1U << ((direction + 1U) & around));
    }
    const struct jp_grid_direction *d = &jp_grid_directions[direction];

    for (unsigned side = 0; side < 2U; side++) {
        const unsigned turn = side == 0U ? 1U : around;
        const struct jp_grid_direction *across = &jp_grid_directions[(direction + 2U * turn) & around];
        if (jp_grid_is_blocked(planner, x - d->dx + across->dx, y - d->dy + across->dy)) {
            set |= (1U << ((direction + turn) & around)) | (1U << ((direction + 2U * turn) & around));
        }
    }
    return set;
}

unsigned jp_grid_search_parent_direction(const struct jp_grid_planner_internal *planner, int32_t x, int32_t y)
{
    return (unsigned)((jp_grid_node(planner, x, y)->place & GRID_DIRECTION_MASK) >> GRID_DIRECTION_SHIFT);
}

/** Takes a cheaper path to a cell. False: the queue is full. */
static bool relax(struct jp_grid_planner_internal *planner, int32_t x, int32_t y, uint32_t g, unsigned direction)
{
    struct jp_grid_node *node = jp_grid_node(planner, x, y);

    if (g >= node->g) {
        return true;
    }
    if (g > planner->length_max) {
        planner->is_too_long = true;
        return true;
    }
    node->g = g;
    node->place = (node->place & ~GRID_DIRECTION_MASK) | ((uint32_t)direction << GRID_DIRECTION_SHIFT);
    return jp_grid_queue_put(planner, x, y, heuristic(planner, x, y));
}

/** The next cell to expand in a direction: the neighbour or the jump point. False: there is none. */
static bool find_next(const struct jp_grid_planner_internal *planner, int32_t *x, int32_t *y, unsigned direction,
                      uint32_t *steps)
{
    const struct jp_grid_direction *d = &jp_grid_directions[direction];

    if (!uses_runs(planner)) {
        const bool is_free = can_step(planner, *x, *y, d);
        *x += d->dx;
        *y += d->dy;
        return is_free;
    }
    return direction % 2U != 0U ? run_diagonal(planner, x, y, d, steps) : run_straight(planner, x, y, d);
}

static bool expand(struct jp_grid_planner_internal *planner, int32_t x, int32_t y, uint32_t *steps)
{
    const uint32_t g = jp_grid_node(planner, x, y)->g;
    const unsigned arrived = jp_grid_search_parent_direction(planner, x, y);
    const bool is_pruned = arrived != (unsigned)GRID_NO_DIRECTION && uses_runs(planner);
    const unsigned set = is_pruned ? directions_on(planner, x, y, arrived) : (1U << GRID_DIRECTIONS) - 1U;

    planner->counts.expansions++;
    for (unsigned direction = 0; direction < (unsigned)GRID_DIRECTIONS; direction++) {
        int32_t next_x = x;
        int32_t next_y = y;
        if (((set >> direction) & 1U) == 0U || !find_next(planner, &next_x, &next_y, direction, steps)) {
            continue;
        }
        const uint32_t along_x = distance_along(x, next_x);
        const uint32_t along_y = distance_along(y, next_y);
        const uint32_t length = along_x > along_y ? along_x : along_y;
        if (!relax(planner, next_x, next_y, g + length * jp_grid_step_cost(planner, x, y, direction), direction)) {
            return false;
        }
    }
    return true;
}

void jp_grid_search_start(struct jp_grid_planner_internal *planner)
{
    struct jp_grid_node *node = jp_grid_node(planner, planner->start.x, planner->start.y);

    planner->queue_count = 0;
    planner->is_too_long = false;
    node->g = 0;
    node->place |= (uint32_t)GRID_NO_DIRECTION << GRID_DIRECTION_SHIFT;
    (void)jp_grid_queue_put(planner, planner->start.x, planner->start.y, 0);
}

enum jp_grid_progress jp_grid_search_work(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    while (*budget > 0U) {
        int32_t x;
        int32_t y;
        uint32_t steps = 0;
        if (!jp_grid_queue_take(planner, &x, &y)) {
            return planner->is_too_long ? GRID_FULL : GRID_IMPOSSIBLE;
        }
        if (is_goal(planner, x, y)) {
            planner->counts.octile_length = octile_length(planner, jp_grid_node(planner, x, y)->g);
            return GRID_DONE;
        }
        if (!expand(planner, x, y, &steps)) {
            return GRID_FULL;
        }
        const unsigned units = 1U + steps / STEPS_PER_UNIT;
        *budget = *budget > units ? *budget - units : 0U;
    }
    return GRID_WORKING;
}
