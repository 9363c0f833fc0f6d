/** What the tests and the bench judge the grid planner by: a map of its own, lines in double precision, Dijkstra to the
 * eight neighbours, and the shortest way of all by a visibility graph. It shares no code with the planner. */
#ifndef JOULEPATH_TESTS_SUPPORT_GRID_ORACLE_H
#define JOULEPATH_TESTS_SUPPORT_GRID_ORACLE_H

#include <joulepath/grid_planner.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/heap.h"

struct grid_oracle {
    int width;
    int height;
    bool *blocked; /* by rows */
};

/* Cells. Lines come from points in steps of 2⁻¹⁶ m; what is less apart touches. */
#define ORACLE_TOUCH 1e-7

static inline void *oracle_allocate(size_t count, size_t size)
{
    void *block = calloc(count, size);
    if (block == NULL) {
        (void)fprintf(stderr, "grid oracle: no memory\n");
        exit(1);
    }
    return block;
}

/** Everything off the map is blocked. */
static inline bool grid_oracle_is_blocked(const struct grid_oracle *oracle, int x, int y)
{
    return x < 0 || y < 0 || x >= oracle->width || y >= oracle->height || oracle->blocked[y * oracle->width + x];
}

struct oracle_line {
    double x0, y0, dx, dy;
};

/* Cuts the part first…last of a line, from 0 to 1, to where it is within low…high along one axis. */
static inline void oracle_clip(double from, double along, double low, double high, double *first, double *last)
{
    if (fabs(along) < ORACLE_TOUCH) {
        *last = from > low + ORACLE_TOUCH && from < high - ORACLE_TOUCH ? *last : -1;
        return;
    }
    const double a = (low - from) / along;
    const double b = (high - from) / along;
    *first = fmax(*first, fmin(a, b));
    *last = fmin(*last, fmax(a, b));
}

/* Through the open interior, by more than a touch. */
static inline bool enters_cell(const struct oracle_line *line, int x, int y)
{
    double first = 0;
    double last = 1;
    oracle_clip(line->x0, line->dx, x, x + 1, &first, &last);
    oracle_clip(line->y0, line->dy, y, y + 1, &first, &last);
    if (last < first) {
        return false;
    }
    const double middle = (first + last) / 2;
    const double px = line->x0 + middle * line->dx - x;
    const double py = line->y0 + middle * line->dy - y;
    return px > ORACLE_TOUCH && px < 1 - ORACLE_TOUCH && py > ORACLE_TOUCH && py < 1 - ORACLE_TOUCH;
}

static inline bool touches_point(const struct oracle_line *line, double x, double y)
{
    const double square = line->dx * line->dx + line->dy * line->dy;
    const double along = square > 0 ? ((x - line->x0) * line->dx + (y - line->y0) * line->dy) / square : 0;
    const double at = fmin(1, fmax(0, along));
    return hypot(line->x0 + at * line->dx - x, line->y0 + at * line->dy - y) < ORACLE_TOUCH;
}

static inline bool is_pinched(const struct grid_oracle *oracle, int x, int y)
{
    return (grid_oracle_is_blocked(oracle, x - 1, y - 1) && grid_oracle_is_blocked(oracle, x, y)) ||
           (grid_oracle_is_blocked(oracle, x - 1, y) && grid_oracle_is_blocked(oracle, x, y - 1));
}

/* On the border south or west of a cell, when the cell and the one across are both blocked. */
static inline bool runs_between(const struct grid_oracle *oracle, const struct oracle_line *line, int x, int y)
{
    const bool west = fabs(line->dx) < ORACLE_TOUCH && fabs(line->x0 - x) < ORACLE_TOUCH;
    const bool south = fabs(line->dy) < ORACLE_TOUCH && fabs(line->y0 - y) < ORACLE_TOUCH;
    const double low_x = fmin(line->x0, line->x0 + line->dx);
    const double high_x = fmax(line->x0, line->x0 + line->dx);
    const double low_y = fmin(line->y0, line->y0 + line->dy);
    const double high_y = fmax(line->y0, line->y0 + line->dy);
    return (west && high_y > y + ORACLE_TOUCH && low_y < y + 1 - ORACLE_TOUCH &&
            grid_oracle_is_blocked(oracle, x - 1, y) && grid_oracle_is_blocked(oracle, x, y)) ||
           (south && high_x > x + ORACLE_TOUCH && low_x < x + 1 - ORACLE_TOUCH &&
            grid_oracle_is_blocked(oracle, x, y - 1) && grid_oracle_is_blocked(oracle, x, y));
}

static inline bool is_free_at(const struct grid_oracle *oracle, const struct oracle_line *line, int x, int y)
{
    return !(grid_oracle_is_blocked(oracle, x, y) && enters_cell(line, x, y)) &&
           !(is_pinched(oracle, x, y) && touches_point(line, x, y)) && !runs_between(oracle, line, x, y);
}

/** True when a line, its ends in cells, is free: it enters no blocked cell, does not run between two and touches no
 *  point where two meet corner to corner. */
static inline bool grid_oracle_is_line_free(const struct grid_oracle *oracle, double x0, double y0, double x1,
                                            double y1)
{
    const struct oracle_line line = {x0, y0, x1 - x0, y1 - y0};
    for (int y = (int)floor(fmin(y0, y1)) - 1; y <= (int)floor(fmax(y0, y1)) + 1; y++) {
        double first = 0;
        double last = 1;
        oracle_clip(y0, line.dy, y - 1, y + 2, &first, &last);
        if (last < first) {
            continue;
        }
        const double a = x0 + first * line.dx;
        const double b = x0 + last * line.dx;
        for (int x = (int)floor(fmin(a, b)) - 1; x <= (int)floor(fmax(a, b)) + 1; x++) {
            if (!is_free_at(oracle, &line, x, y)) {
                return false;
            }
        }
    }
    return true;
}

/* ---- Dijkstra ---- */

static inline double *unknown_costs(size_t count)
{
    double *costs = oracle_allocate(count, sizeof *costs);
    for (size_t i = 0; i < count; i++) {
        costs[i] = INFINITY;
    }
    return costs;
}

static inline void oracle_relax(struct heap *heap, double *costs, int node, double cost)
{
    if (cost < costs[node]) {
        costs[node] = cost;
        heap_push(heap, cost, (uint32_t)node);
    }
}

static inline void relax_neighbours(const struct grid_oracle *oracle, struct heap *heap, double *costs, int cell)
{
    const int x = cell % oracle->width;
    const int y = cell / oracle->width;
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            if (!grid_oracle_is_blocked(oracle, x + dx, y + dy) && !grid_oracle_is_blocked(oracle, x + dx, y) &&
                !grid_oracle_is_blocked(oracle, x, y + dy)) {
                oracle_relax(heap, costs, cell + dy * oracle->width + dx, costs[cell] + hypot(dx, dy));
            }
        }
    }
}

/** Length of the shortest way to the eight neighbours without corner cutting, cells; infinite: there is none. */
static inline double grid_oracle_octile(const struct grid_oracle *oracle, struct jp_grid_cell start,
                                        struct jp_grid_cell goal)
{
    double *costs = unknown_costs((size_t)oracle->width * (size_t)oracle->height);
    const int target = goal.y * oracle->width + goal.x;
    struct heap heap = {0};
    oracle_relax(&heap, costs, start.y * oracle->width + start.x, 0);
    while (heap.count > 0) {
        const struct heap_entry top = heap_pop(&heap);
        const int node = (int)top.id;
        if (node == target) {
            break;
        }
        if (top.key <= costs[node]) {
            relax_neighbours(oracle, &heap, costs, node);
        }
    }
    const double cost = costs[target];
    free(heap.entries);
    free(costs);
    return cost;
}

/* ---- Visibility graph ---- */

struct oracle_corner {
    double x;
    double y;
};

struct grid_graph {
    const struct grid_oracle *oracle;
    struct oracle_corner *corners;
    int count;
    float *distance; /* count × count; below 0: they do not see each other */
};

/* Only where one of four cells is blocked does a shortest way turn. */
static inline bool is_convex(const struct grid_oracle *oracle, int x, int y)
{
    return grid_oracle_is_blocked(oracle, x, y) + grid_oracle_is_blocked(oracle, x - 1, y) +
               grid_oracle_is_blocked(oracle, x, y - 1) + grid_oracle_is_blocked(oracle, x - 1, y - 1) ==
           1;
}

static inline double oracle_sight(const struct grid_oracle *oracle, const struct oracle_corner *a,
                                  const struct oracle_corner *b)
{
    return grid_oracle_is_line_free(oracle, a->x, a->y, b->x, b->y) ? hypot(a->x - b->x, a->y - b->y) : -1;
}

static inline void find_corners(struct grid_graph *graph)
{
    const struct grid_oracle *oracle = graph->oracle;
    for (int y = 0; y <= oracle->height; y++) {
        for (int x = 0; x <= oracle->width; x++) {
            if (is_convex(oracle, x, y)) {
                graph->corners[graph->count++] = (struct oracle_corner){x, y};
            }
        }
    }
}

/** Which convex corners of the blocked cells see each other. */
static inline struct grid_graph *grid_graph_create(const struct grid_oracle *oracle)
{
    struct grid_graph *graph = oracle_allocate(1, sizeof *graph);
    graph->oracle = oracle;
    graph->corners =
        oracle_allocate((size_t)(oracle->width + 1) * (size_t)(oracle->height + 1), sizeof *graph->corners);
    find_corners(graph);
    graph->distance = oracle_allocate((size_t)graph->count * (size_t)graph->count + 1, sizeof *graph->distance);
    for (int i = 0; i < graph->count; i++) {
        for (int j = 0; j < i; j++) {
            const float distance = (float)oracle_sight(oracle, &graph->corners[i], &graph->corners[j]);
            graph->distance[i * graph->count + j] = distance;
            graph->distance[j * graph->count + i] = distance;
        }
    }
    return graph;
}

static inline void grid_graph_free(struct grid_graph *graph)
{
    free(graph->corners);
    free(graph->distance);
    free(graph);
}

/** Length of the shortest way of all, cells; infinite: there is none. */
static inline double grid_graph_shortest(const struct grid_graph *graph, struct jp_grid_cell start,
                                         struct jp_grid_cell goal)
{
    const struct oracle_corner from = {start.x + 0.5, start.y + 0.5};
    const struct oracle_corner to = {goal.x + 0.5, goal.y + 0.5};
    const double direct = oracle_sight(graph->oracle, &from, &to);
    double best = direct >= 0 ? direct : INFINITY;
    double *costs = unknown_costs((size_t)graph->count + 1);
    struct heap heap = {0};
    for (int i = 0; i < graph->count; i++) {
        const double distance = oracle_sight(graph->oracle, &from, &graph->corners[i]);
        if (distance >= 0) {
            oracle_relax(&heap, costs, i, distance);
        }
    }
    while (heap.count > 0) {
        const struct heap_entry top = heap_pop(&heap);
        const int node = (int)top.id;
        if (top.key > costs[node] || top.key >= best) {
            continue;
        }
        const struct oracle_corner *corner = &graph->corners[node];
        if (top.key + hypot(corner->x - to.x, corner->y - to.y) < best &&
            oracle_sight(graph->oracle, corner, &to) >= 0) {
            best = top.key + hypot(corner->x - to.x, corner->y - to.y);
        }
        for (int i = 0; i < graph->count; i++) {
            const double distance = graph->distance[node * graph->count + i];
            if (distance >= 0) {
                oracle_relax(&heap, costs, i, top.key + distance);
            }
        }
    }
    free(heap.entries);
    free(costs);
    return best;
}

#endif
