#include "tests/bench/plain_dijkstra.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct entry {
    double cost;
    uint32_t state;
};

/** A binary heap; a state that becomes cheaper is pushed again. */
struct heap {
    struct entry *entries;
    size_t count;
    size_t size;
};

static void *allocate(void *old, size_t size)
{
    void *block = realloc(old, size);
    if (block == NULL) {
        (void)fprintf(stderr, "plain_dijkstra: no memory\n");
        exit(1);
    }
    return block;
}

static void push(struct heap *heap, struct entry entry)
{
    if (heap->count == heap->size) {
        heap->size = heap->size == 0 ? 1024 : 2 * heap->size;
        heap->entries = allocate(heap->entries, heap->size * sizeof *heap->entries);
    }
    size_t at = heap->count++;
    for (; at > 0 && heap->entries[(at - 1) / 2].cost > entry.cost; at = (at - 1) / 2) {
        heap->entries[at] = heap->entries[(at - 1) / 2];
    }
    heap->entries[at] = entry;
}

static struct entry pop(struct heap *heap)
{
    const struct entry top = heap->entries[0];
    const struct entry last = heap->entries[--heap->count];
    size_t at = 0;

    for (size_t child = 1; child < heap->count; child = 2 * at + 1) {
        child += child + 1 < heap->count && heap->entries[child + 1].cost < heap->entries[child].cost;
        if (heap->entries[child].cost >= last.cost) {
            break;
        }
        heap->entries[at] = heap->entries[child];
        at = child;
    }
    heap->entries[at] = last;
    return top;
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

/** Physical, in cost units; infinite when a step is too steep. */
static double energy(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                     const struct jp_primitive *primitive, int32_t x, int32_t y)
{
    double sum = primitive->base[JP_COST_PHYSICAL];

    for (unsigned i = 0; i < primitive->move_count; i++) {
        const unsigned direction = lattice->moves[primitive->first_move + i];
        const struct jp_slope_cost *cost = &lattice->move_costs[JP_COST_PHYSICAL][jp_move_kind_of(direction)];
        const double from = jp_terrain_elevation(terrain, x, y);
        x += jp_move_offsets[direction].dx;
        y += jp_move_offsets[direction].dy;
        const double rise = jp_terrain_elevation(terrain, x, y) - from;
        if (fabs(rise) > cost->rise_max) {
            return INFINITY;
        }
        sum += fmax(evaluate(rise >= cost->bend ? &cost->climb : &cost->descend, rise), cost->floor);
    }
    return sum;
}

struct search {
    const struct jp_lattice *lattice;
    const struct jp_terrain *terrain;
    double *costs;
    struct heap heap;
};

static uint32_t id_of(const struct jp_terrain *terrain, int32_t x, int32_t y, unsigned heading)
{
    return ((uint32_t)y * terrain->config.width + (uint32_t)x) * JP_HEADINGS + heading;
}

static void reach(struct search *search, uint32_t state, double cost)
{
    if (cost < search->costs[state]) {
        search->costs[state] = cost;
        push(&search->heap, (struct entry){cost, state});
    }
}

static void expand(struct search *search, struct entry entry)
{
    const uint32_t cell = entry.state / JP_HEADINGS;
    const unsigned heading = entry.state % JP_HEADINGS;
    const int32_t x = (int32_t)(cell % search->terrain->config.width);
    const int32_t y = (int32_t)(cell / search->terrain->config.width);

    for (unsigned i = search->lattice->first_from[heading]; i < search->lattice->first_from[heading + 1]; i++) {
        const struct jp_primitive *primitive = &search->lattice->primitives[i];
        if (is_swept_clear(search->lattice, search->terrain, primitive, x, y)) {
            reach(search, id_of(search->terrain, x + primitive->dx, y + primitive->dy, primitive->end),
                  entry.cost + energy(search->lattice, search->terrain, primitive, x, y));
        }
    }
}

static bool is_goal(const struct search *search, const struct jp_goal *goal, uint32_t state)
{
    return state / JP_HEADINGS == id_of(search->terrain, goal->x, goal->y, 0) / JP_HEADINGS &&
           ((goal->headings >> state % JP_HEADINGS) & 1) != 0;
}

double plain_dijkstra(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                      const struct jp_lattice_pose *start, const struct jp_goal *goal)
{
    const size_t states = (size_t)terrain->config.width * terrain->config.height * JP_HEADINGS;
    struct search search = {lattice, terrain, allocate(NULL, states * sizeof(double)), {NULL, 0, 0}};
    double best = INFINITY;

    for (size_t i = 0; i < states; i++) {
        search.costs[i] = INFINITY;
    }
    reach(&search, id_of(terrain, start->x, start->y, start->heading), 0);
    while (search.heap.count > 0) {
        const struct entry entry = pop(&search.heap);
        if (is_goal(&search, goal, entry.state)) {
            best = entry.cost / JP_COST_PER_JOULE;
            break;
        }
        if (entry.cost == search.costs[entry.state]) {
            expand(&search, entry);
        }
    }
    free(search.costs);
    free(search.heap.entries);
    return best;
}
