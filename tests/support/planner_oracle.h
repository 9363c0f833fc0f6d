/**
 * Dijkstra over all states of a lattice on a small map, in double precision, with a map, swept cells and costs of its
 * own: what the planner's answers are compared with.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_PLANNER_ORACLE_H
#define JOULEPATH_TESTS_SUPPORT_PLANNER_ORACLE_H

#include <joulepath/planner.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/heap.h"

enum {
    ORACLE_SIDE_MAX = 48,
    ORACLE_MARGIN = 48, /* blocked cells round the map, so that no look-up leaves the arrays */
    ORACLE_STRIDE = ORACLE_SIDE_MAX + 2 * ORACLE_MARGIN,
    ORACLE_CELLS = ORACLE_STRIDE * ORACLE_STRIDE,
    ORACLE_STATES = ORACLE_SIDE_MAX * ORACLE_SIDE_MAX * JP_HEADINGS,
    ORACLE_PRIMITIVES = 256,
    ORACLE_SWEPT = 1 << 15,
};

struct oracle_map {
    int width;
    int height;
    bool is_blocked[ORACLE_CELLS];
    int elevation[ORACLE_CELLS];
    int cell_cost[ORACLE_CELLS];
    int ground[ORACLE_CELLS]; /* class */
    bool has_classes;
    int cost_shift;
};

struct oracle {
    const struct jp_lattice *lattice;
    enum jp_cost_kind kind;
    int swept[ORACLE_SWEPT]; /* cells of each primitive, as offsets in a map */
    int first_swept[ORACLE_PRIMITIVES + 1];
    double distance[ORACLE_STATES];
};

static inline int oracle_cell(int x, int y)
{
    return (y + ORACLE_MARGIN) * ORACLE_STRIDE + x + ORACLE_MARGIN;
}

static inline int oracle_state(const struct oracle_map *map, int x, int y, int heading)
{
    return (y * map->width + x) * JP_HEADINGS + heading;
}

/** All blocked, at elevation 0. */
static inline void oracle_map_clear(struct oracle_map *map, int width, int height)
{
    map->width = width;
    map->height = height;
    memset(map->elevation, 0, sizeof map->elevation);
    memset(map->cell_cost, 0, sizeof map->cell_cost);
    memset(map->ground, 0, sizeof map->ground);
    map->has_classes = false;
    map->cost_shift = 0;
    memset(map->is_blocked, 1, sizeof map->is_blocked);
}

/** Writes out the swept cells of every primitive once. */
static inline void oracle_init(struct oracle *oracle, const struct jp_lattice *lattice, enum jp_cost_kind kind)
{
    int count = 0;

    oracle->lattice = lattice;
    oracle->kind = kind;
    for (int i = 0; i < lattice->first_from[JP_HEADINGS]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];
        oracle->first_swept[i] = count;
        for (int k = 0; k < primitive->span_count; k++) {
            const struct jp_span *span = &lattice->spans[primitive->first_span + k];
            for (int x = span->first; x <= span->last; x++) {
                oracle->swept[count++] = span->y * ORACLE_STRIDE + x;
            }
        }
        oracle->first_swept[i + 1] = count;
    }
}

/** The polynomial in 2⁻¹⁶ units, rounded down, at least the floor. */
static inline double oracle_move_cost(const struct jp_slope_cost *cost, int rise)
{
    if (abs(rise) > cost->rise_max) {
        return INFINITY;
    }
    const struct jp_polynomial *side = rise < cost->bend ? &cost->descend : &cost->climb;
    const int64_t exact = side->constant + (int64_t)side->linear * rise + (int64_t)side->quadratic * rise * rise;
    return fmax(floor((double)exact / 65536.0), cost->floor);
}

/** What the ground takes more under the wheels of both sides on a cell, the mean; 1: as much again. */
struct oracle_ground {
    double straight;
    double turning;
};

static inline struct oracle_ground oracle_ground(const struct oracle *oracle, const struct oracle_map *map, int cell,
                                                 unsigned direction)
{
    const struct jp_cell_offset left = oracle->lattice->sides[direction];
    const int off = left.dy * ORACLE_STRIDE + left.dx;
    const struct jp_ground_price *a = &oracle->lattice->ground[map->ground[cell + off]];
    const struct jp_ground_price *b = &oracle->lattice->ground[map->ground[cell - off]];
    const double unit = oracle->kind == JP_COST_PHYSICAL && map->has_classes ? 2.0 * JP_GROUND_ONE : INFINITY;

    return (struct oracle_ground){(a->straight + b->straight) / unit, (a->turning + b->turning) / unit};
}

static inline double oracle_with_share(double cost, double of, double share)
{
    return isinf(cost) ? cost : fmin(cost + floor(of * share), UINT16_MAX);
}

/** A cost on a cell, or a step on the dearer of two. */
static inline double oracle_charged(const struct oracle_map *map, double cost, int cell_cost)
{
    return floor(cost * (1 + ldexp(cell_cost, -map->cost_shift)));
}

static inline int oracle_larger(int a, int b)
{
    return a > b ? a : b;
}

/** Cost of a primitive from (x, y); INFINITY when it cannot be driven. */
static inline double oracle_edge(const struct oracle *oracle, const struct oracle_map *map, int primitive, int x, int y)
{
    static const int kinds[JP_MOVE_DIRECTIONS] = {0, 1, 2, 1, 0, 1, 2, 1, 0, 1, 2, 1, 0, 1, 2, 1};
    static const int steps[JP_MOVE_DIRECTIONS][2] = {{1, 0},  {2, 1},  {1, 1},  {1, 2},   {0, 1},   {-1, 2},
                                                     {-1, 1}, {-2, 1}, {-1, 0}, {-2, -1}, {-1, -1}, {-1, -2},
                                                     {0, -1}, {1, -2}, {1, -1}, {2, -1}};
    const struct jp_primitive *p = &oracle->lattice->primitives[primitive];
    int cell = oracle_cell(x, y);

    for (int i = oracle->first_swept[primitive]; i < oracle->first_swept[primitive + 1]; i++) {
        if (map->is_blocked[cell + oracle->swept[i]]) {
            return INFINITY;
        }
    }
    double cost = 0;
    int largest = map->cell_cost[cell];
    double turning = oracle_ground(oracle, map, cell, p->start).turning;
    for (int i = 0; i < p->move_count; i++) {
        const int direction = oracle->lattice->moves[p->first_move + i];
        const int next = cell + steps[direction][1] * ORACLE_STRIDE + steps[direction][0];
        const struct jp_slope_cost *costs = &oracle->lattice->move_costs[oracle->kind][kinds[direction]];
        const struct oracle_ground begin = oracle_ground(oracle, map, cell, (unsigned)direction);
        const struct oracle_ground end = oracle_ground(oracle, map, next, (unsigned)direction);
        const double share = (begin.straight + end.straight) / 2;
        const double move = oracle_with_share(oracle_move_cost(costs, map->elevation[next] - map->elevation[cell]),
                                              oracle_move_cost(costs, 0), share);
        cost += oracle_charged(map, move, oracle_larger(map->cell_cost[cell], map->cell_cost[next]));
        turning = fmax(turning, end.turning);
        largest = oracle_larger(largest, map->cell_cost[next]);
        cell = next;
    }
    const double base = p->base[oracle->kind];

    return cost + oracle_charged(map, oracle_with_share(base, base, turning), largest);
}

static inline void oracle_expand(struct oracle *oracle, const struct oracle_map *map, struct heap *heap, int state)
{
    const int heading = state % JP_HEADINGS;
    const int x = state / JP_HEADINGS % map->width;
    const int y = state / JP_HEADINGS / map->width;

    for (int i = oracle->lattice->first_from[heading]; i < oracle->lattice->first_from[heading + 1]; i++) {
        const struct jp_primitive *p = &oracle->lattice->primitives[i];
        const double cost = oracle->distance[state] + oracle_edge(oracle, map, i, x, y);
        if (isinf(cost)) {
            continue; /* also when the end is off the map, as the robot stands on it */
        }
        const int next = oracle_state(map, x + p->dx, y + p->dy, p->end);
        if (cost < oracle->distance[next]) {
            oracle->distance[next] = cost;
            heap_push(heap, cost, (uint32_t)next);
        }
    }
}

/** Cost of the cheapest route to the goal; INFINITY when there is none. Without a goal the distances of all states are
 *  found. */
static inline double oracle_shortest(struct oracle *oracle, const struct oracle_map *map,
                                     const struct jp_lattice_pose *start, const struct jp_goal *goal)
{
    const int first = oracle_state(map, start->x, start->y, start->heading);
    struct heap heap = {0};
    double found = INFINITY;

    for (int i = 0; i < map->width * map->height * JP_HEADINGS; i++) {
        oracle->distance[i] = INFINITY;
    }
    oracle->distance[first] = 0;
    heap_push(&heap, 0, (uint32_t)first);
    while (heap.count > 0 && isinf(found)) {
        const struct heap_entry top = heap_pop(&heap);
        const int state = (int)top.id;
        if (top.key > oracle->distance[state]) {
            continue;
        }
        if (goal != NULL && state / JP_HEADINGS == goal->y * map->width + goal->x &&
            (goal->headings >> state % JP_HEADINGS & 1) != 0) {
            found = top.key;
        } else {
            oracle_expand(oracle, map, &heap, state);
        }
    }
    free(heap.entries);
    return found;
}

#endif
