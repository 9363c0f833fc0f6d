#include "src/search/grid_path.h"

#include <string.h>

#include "src/base/point.h"

enum {
    HALVINGS = 8,   /* steps of the bisection that moves a turning point; each takes a unit of the budget */
    ROUNDING = 4,   /* of the prices of three lines, m, Q24 */
    PASSES_MAX = 12 /* over all turning points, alternately from either end */
};

static bool is_straight(const struct jp_point *a, const struct jp_point *b, const struct jp_point *c)
{
    return (int64_t)(b->x - a->x) * (c->y - b->y) == (int64_t)(b->y - a->y) * (c->x - b->x);
}

/** Price of a line to a point and on to another one. */
static uint64_t price_over(const struct jp_grid_planner_internal *planner, const struct jp_point *from,
                           const struct jp_point *over, const struct jp_point *to)
{
    return jp_grid_line_price(planner, from, over) + jp_grid_line_price(planner, over, to);
}

/** True when the way from one point to another is free without the one between, and costs no more. */
static bool is_shortcut(const struct jp_grid_planner_internal *planner, const struct jp_point *from,
                        const struct jp_point *over, const struct jp_point *to)
{
    return jp_grid_line_is_free(planner, from, to) &&
           (!planner->is_priced ||
            jp_grid_line_price(planner, from, to) <= price_over(planner, from, over, to) + (uint64_t)ROUNDING);
}

bool jp_grid_path_add(const struct jp_grid_planner_internal *planner, struct jp_grid_path *path, struct jp_point point,
                      bool shortcut)
{
    if (path->count >= 2U) {
        const struct jp_point *before = &path->points[path->count - 2U];
        const struct jp_point *last = &path->points[path->count - 1U];
        if (shortcut ? is_shortcut(planner, before, last, &point) : is_straight(before, last, &point)) {
            path->count--;
        }
    }
    if (path->count == planner->points_max) {
        return false;
    }
    path->points[path->count] = point;
    path->count++;
    return true;
}

static void spend(unsigned *budget, unsigned units)
{
    *budget = *budget > units ? *budget - units : 0U;
}

/** Of adding a point to a path. */
static unsigned units_to(const struct jp_grid_planner_internal *planner, const struct jp_grid_path *path,
                         const struct jp_point *point)
{
    return path->count >= 2U ? jp_grid_line_units(planner, &path->points[path->count - 2U], point) : 1U;
}

/** The cursor is the cell that is traced, place_cost its cost along the path. A cell in the middle of a run may have
 * been reached from elsewhere at another cost: the trace then keeps its direction. */
enum jp_grid_progress jp_grid_path_trace(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    const bool shortcut = planner->config.method == JP_GRID_ANY_ANGLE;
    const uint32_t width = planner->terrain->config.width;
    const uint32_t column = planner->cursor % width;
    const uint32_t row = planner->cursor / width;
    int32_t x = (int32_t)column;
    int32_t y = (int32_t)row;

    while (*budget > 0U) {
        const struct jp_point place = jp_grid_centre(planner, x, y);
        spend(budget, units_to(planner, &planner->path, &place));
        if (!jp_grid_path_add(planner, &planner->path, place, shortcut)) {
            return GRID_FULL;
        }
        if (jp_grid_node(planner, x, y)->g == planner->place_cost) {
            planner->cursor_part = jp_grid_search_parent_direction(planner, x, y);
        }
        if (planner->cursor_part == (uint32_t)GRID_NO_DIRECTION) {
            return GRID_DONE;
        }
        x -= jp_grid_directions[planner->cursor_part].dx;
        y -= jp_grid_directions[planner->cursor_part].dy;
        planner->place_cost -= jp_grid_step_cost(planner, x, y, planner->cursor_part);
        planner->cursor = (uint32_t)y * width + (uint32_t)x;
    }
    return GRID_WORKING;
}

void jp_grid_path_reverse(struct jp_grid_path *path)
{
    for (uint32_t i = 0; i < path->count / 2U; i++) {
        const struct jp_point point = path->points[i];
        path->points[i] = path->points[path->count - 1U - i];
        path->points[path->count - 1U - i] = point;
    }
}

uint64_t jp_grid_path_price(const struct jp_grid_planner_internal *planner, const struct jp_grid_path *path)
{
    uint64_t price = 0;

    for (uint32_t i = 1; i < path->count; i++) {
        price += jp_grid_line_price(planner, &path->points[i - 1U], &path->points[i]);
    }
    return price;
}

static struct jp_point middle(const struct jp_point *a, const struct jp_point *b)
{
    return (struct jp_point){a->x + (b->x - a->x) / 2, a->y + (b->y - a->y) / 2};
}

/** Whether a way over a point costs less than `least`, which it then becomes; without prices it is shorter. */
static bool is_cheaper(const struct jp_grid_planner_internal *planner, const struct jp_point *before,
                       const struct jp_point *point, const struct jp_point *next, uint64_t *least)
{
    const uint64_t price = planner->is_priced ? price_over(planner, before, point, next) : 0U;
    const bool is_less = !planner->is_priced || price < *least;

    *least = is_less ? price : *least;
    return is_less;
}

/** By bisection: about the farthest point on the piece from `turn` to `next` that `before` sees, and over which the way
 *  costs less than over the nearer ones. */
static struct jp_point slide(const struct jp_grid_planner_internal *planner, const struct jp_point *before,
                             const struct jp_point *turn, const struct jp_point *next)
{
    struct jp_point near = *turn;
    struct jp_point far = *next;
    uint64_t least = planner->is_priced ? price_over(planner, before, turn, next) : 0U;

    for (unsigned i = 0; i < HALVINGS; i++) {
        const struct jp_point point = middle(&near, &far);
        if (jp_grid_line_is_free(planner, before, &point) && jp_grid_line_is_free(planner, &point, next) &&
            is_cheaper(planner, before, &point, next, &least)) {
            near = point;
        } else {
            far = point;
        }
    }
    return near;
}

/** Removes a turning point when its neighbours see each other and the way costs no more without it; else moves it
 *  towards the next one, which makes the path cheaper. */
static void tighten_at(struct jp_grid_planner_internal *planner, struct jp_grid_path *path, uint32_t index)
{
    struct jp_point *turn = &path->points[index];
    const struct jp_point *before = &path->points[index - 1U];
    struct jp_point *next = &path->points[index + 1U];

    if (is_shortcut(planner, before, turn, next)) {
        path->count--;
        (void)memmove(turn, next, (path->count - index) * sizeof *turn);
        planner->has_changed = true;
        return;
    }
    const struct jp_point point = slide(planner, before, turn, next);

    planner->has_changed = planner->has_changed || !jp_is_same_point(&point, turn);
    *turn = point;
}

/** The cursor is the turning point. After each pass the path is reversed; the work ends when two passes changed
 * nothing.
 */
enum jp_grid_progress jp_grid_path_tighten(struct jp_grid_planner_internal *planner, struct jp_grid_path *path,
                                           unsigned *budget)
{
    while (*budget > 0U) {
        if (planner->cursor + 1U >= path->count) {
            jp_grid_path_reverse(path);
            --*budget;
            planner->passes++;
            planner->cursor = 1;
            if (planner->passes % 2U == 0U) {
                if (!planner->has_changed || planner->passes == (uint8_t)PASSES_MAX) {
                    return GRID_DONE;
                }
                planner->has_changed = false;
            }
        } else {
            const uint32_t count = path->count;
            const struct jp_point *const points = path->points;
            spend(budget,
                  HALVINGS * jp_grid_line_units(planner, &points[planner->cursor - 1U], &points[planner->cursor + 1U]));
            tighten_at(planner, path, planner->cursor);
            planner->cursor += path->count == count ? 1U : 0U;
        }
    }
    return GRID_WORKING;
}
