#include "tests/bench/plain_search.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/heap.h"

static void *allocate(size_t size)
{
    void *block = malloc(size);
    if (block == NULL) {
        (void)fprintf(stderr, "plain_search: no memory\n");
        exit(1);
    }
    return block;
}

static bool is_occupied(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    return jp_terrain_cell(terrain, x, y) != JP_CELL_FREE;
}

static bool is_swept_clear(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                           const struct jp_primitive *primitive, int32_t x, int32_t y)
{
    for (unsigned i = 0; i < primitive->span_count; i++) {
        const struct jp_span span = lattice->spans[primitive->first_span + i];
        for (int32_t dx = span.first; dx <= span.last; dx++) {
            if (is_occupied(terrain, x + dx, y + span.y)) {
                return false;
            }
        }
    }
    return true;
}

static double evaluate(const struct jp_polynomial *polynomial, double rise)
{
    return (polynomial->constant + polynomial->linear * rise + polynomial->quadratic * rise * rise) / 65536;
}

/** Of one unit step, physical, in cost units; infinite when it is too steep. */
static double move_cost(const struct jp_lattice *lattice, unsigned direction, double rise)
{
    const struct jp_slope_cost *cost = &lattice->move_costs[JP_COST_PHYSICAL][jp_move_kind_of(direction)];

    return fabs(rise) > cost->rise_max
               ? INFINITY
               : fmax(evaluate(rise >= cost->bend ? &cost->climb : &cost->descend, rise), cost->floor);
}

static double primitive_cost(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                             const struct jp_primitive *primitive, int32_t x, int32_t y)
{
    double sum = primitive->base[JP_COST_PHYSICAL];

    for (unsigned i = 0; i < primitive->move_count; i++) {
        const unsigned direction = lattice->moves[primitive->first_move + i];
        const double from = jp_terrain_elevation(terrain, x, y);
        x += jp_move_offsets[direction].dx;
        y += jp_move_offsets[direction].dy;
        sum += move_cost(lattice, direction, jp_terrain_elevation(terrain, x, y) - from);
    }
    return sum;
}

struct search {
    const struct jp_lattice *lattice;
    const struct jp_terrain *terrain;
    const double *left; /**< cost from a cell to the goal at least; null: 0 */
    double *costs;
    struct heap heap;
};

static uint32_t cell_id(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    return (uint32_t)y * terrain->config.width + (uint32_t)x;
}

static double *infinite_costs(size_t count)
{
    double *costs = allocate(count * sizeof *costs);

    for (size_t i = 0; i < count; i++) {
        costs[i] = INFINITY;
    }
    return costs;
}

/* ---- The states ---- */

static uint32_t id_of(const struct jp_terrain *terrain, int32_t x, int32_t y, unsigned heading)
{
    return cell_id(terrain, x, y) * JP_HEADINGS + heading;
}

static double key_of(const struct search *search, uint32_t state)
{
    return search->costs[state] + (search->left == NULL ? 0 : search->left[state / JP_HEADINGS]);
}

static void reach(struct search *search, uint32_t state, double cost)
{
    if (cost < search->costs[state]) {
        search->costs[state] = cost;
        if (isfinite(key_of(search, state))) {
            heap_push(&search->heap, key_of(search, state), state);
        }
    }
}

static void expand(struct search *search, uint32_t state)
{
    const uint32_t cell = state / JP_HEADINGS;
    const unsigned heading = state % JP_HEADINGS;
    const int32_t x = (int32_t)(cell % search->terrain->config.width);
    const int32_t y = (int32_t)(cell / search->terrain->config.width);

    for (unsigned i = search->lattice->first_from[heading]; i < search->lattice->first_from[heading + 1]; i++) {
        const struct jp_primitive *primitive = &search->lattice->primitives[i];
        if (is_swept_clear(search->lattice, search->terrain, primitive, x, y)) {
            reach(search, id_of(search->terrain, x + primitive->dx, y + primitive->dy, primitive->end),
                  search->costs[state] + primitive_cost(search->lattice, search->terrain, primitive, x, y));
        }
    }
}

static bool is_goal(const struct search *search, const struct jp_goal *goal, uint32_t state)
{
    return state / JP_HEADINGS == cell_id(search->terrain, goal->x, goal->y) &&
           ((goal->headings >> state % JP_HEADINGS) & 1) != 0;
}

static double search_states(struct search *search, const struct jp_lattice_pose *start, const struct jp_goal *goal)
{
    double best = INFINITY;

    search->costs =
        infinite_costs((size_t)search->terrain->config.width * search->terrain->config.height * JP_HEADINGS);
    reach(search, id_of(search->terrain, start->x, start->y, start->heading), 0);
    while (search->heap.count > 0 && isinf(best)) {
        const struct heap_entry entry = heap_pop(&search->heap);
        if (is_goal(search, goal, entry.id)) {
            best = search->costs[entry.id];
        } else if (entry.key == key_of(search, entry.id)) {
            expand(search, entry.id);
        }
    }
    free(search->costs);
    free(search->heap.entries);
    return best;
}

double plain_dijkstra(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                      const struct jp_lattice_pose *start, const struct jp_goal *goal)
{
    struct search search = {.lattice = lattice, .terrain = terrain};

    return search_states(&search, start, goal);
}

/* ---- The cells ---- */

/* The steps that lead to a cell. */
static void lower_neighbours(const struct search *search, double *left, struct heap *heap, uint32_t cell)
{
    const struct jp_terrain *terrain = search->terrain;
    const int32_t x = (int32_t)(cell % terrain->config.width);
    const int32_t y = (int32_t)(cell / terrain->config.width);

    for (unsigned direction = 0; direction < JP_MOVE_DIRECTIONS; direction++) {
        const int32_t from_x = x - jp_move_offsets[direction].dx;
        const int32_t from_y = y - jp_move_offsets[direction].dy;
        if (!jp_lattice_is_open(search->lattice, terrain, from_x, from_y)) {
            continue;
        }
        const uint32_t from = cell_id(terrain, from_x, from_y);
        const double rise = (double)jp_terrain_elevation(terrain, x, y) - jp_terrain_elevation(terrain, from_x, from_y);
        const double cost = left[cell] + move_cost(search->lattice, direction, rise);
        if (cost < left[from]) {
            left[from] = cost;
            heap_push(heap, cost, from);
        }
    }
}

static double *cost_left(const struct search *search, const struct jp_goal *goal)
{
    const uint32_t root = cell_id(search->terrain, goal->x, goal->y);
    double *left = infinite_costs((size_t)search->terrain->config.width * search->terrain->config.height);
    struct heap heap = {0};

    left[root] = 0;
    heap_push(&heap, 0, root);
    while (heap.count > 0) {
        const struct heap_entry entry = heap_pop(&heap);
        if (entry.key == left[entry.id]) {
            lower_neighbours(search, left, &heap, entry.id);
        }
    }
    free(heap.entries);
    return left;
}

double plain_astar(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                   const struct jp_lattice_pose *start, const struct jp_goal *goal)
{
    struct search search = {.lattice = lattice, .terrain = terrain};
    double *left = cost_left(&search, goal);

    search.left = left;
    const double best = search_states(&search, start, goal);
    free(left);
    return best;
}
