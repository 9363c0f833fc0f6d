/**
 * A small lattice with random costs, made in memory: little is swept, so that small maps leave many ways through.
 *
 * Straight steps, arcs to the headings beside, turns in place; the robot is a point or a plus. Some of the arcs and
 * turns are left out, so that ways and their reverses differ.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_TOY_LATTICE_H
#define JOULEPATH_TESTS_SUPPORT_TOY_LATTICE_H

#include <joulepath/lattice.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/random.h"

enum {
    TOY_KINDS = 7, /* of motions at each heading */
    TOY_PRIMITIVES_MAX = JP_HEADINGS * TOY_KINDS,
    TOY_MOVES_MAX = 3,
    TOY_SPANS_MAX = 4096,
    TOY_REACH = 24, /* cells round a start cell */
    TOY_SIDE = 2 * TOY_REACH + 1,
    TOY_KEEP_PERCENT = 80, /* of the arcs and turns */
    TOY_STEP_MAX = 500     /* cost units of a level step */
};

struct toy_lattice {
    struct jp_lattice lattice;
    struct jp_primitive primitives[TOY_PRIMITIVES_MAX];
    uint16_t by_end[TOY_PRIMITIVES_MAX];
    uint8_t moves[TOY_PRIMITIVES_MAX * TOY_MOVES_MAX];
    struct jp_span spans[TOY_SPANS_MAX];
    uint16_t primitive_count;
    uint16_t move_count;
    uint16_t span_count;
    int arm; /* of the plus, cells */
};

/** A set of cells about the start cell. */
struct toy_cells {
    bool has[TOY_SIDE][TOY_SIDE];
};

/** Headings from start to end of each kind of motion, and its unit steps. */
static const struct toy_kind {
    int turn;
    int steps;
} toy_kinds[TOY_KINDS] = {{0, 1}, {1, 2}, {-1, 2}, {2, 3}, {-2, 3}, {1, 0}, {-1, 0}};

static inline void toy_stand(struct toy_cells *cells, int x, int y, int arm)
{
    for (int i = -arm; i <= arm; i++) {
        cells->has[TOY_REACH + y][TOY_REACH + x + i] = true;
        cells->has[TOY_REACH + y + i][TOY_REACH + x] = true;
    }
}

static inline struct jp_cells toy_add_spans(struct toy_lattice *toy, const struct toy_cells *cells)
{
    const uint16_t first_span = toy->span_count;

    for (int y = 0; y < TOY_SIDE; y++) {
        for (int x = 0; x < TOY_SIDE; x++) {
            if (!cells->has[y][x]) {
                continue;
            }
            const int first = x;
            while (x + 1 < TOY_SIDE && cells->has[y][x + 1]) {
                x++;
            }
            toy->spans[toy->span_count++] =
                (struct jp_span){(int8_t)(y - TOY_REACH), (int8_t)(first - TOY_REACH), (int8_t)(x - TOY_REACH)};
        }
    }
    return (struct jp_cells){first_span, (uint16_t)(toy->span_count - first_span)};
}

/** One motion; `reach` takes up its cells. */
static inline void toy_add_primitive(struct toy_lattice *toy, int heading, const struct toy_kind *kind,
                                     struct toy_cells *reach)
{
    struct jp_primitive *primitive = &toy->primitives[toy->primitive_count++];
    struct toy_cells cells;
    int x = 0;
    int y = 0;

    memset(&cells, 0, sizeof cells);
    toy_stand(&cells, 0, 0, toy->arm);
    *primitive = (struct jp_primitive){.start = (uint8_t)heading,
                                       .end = (uint8_t)((heading + kind->turn + JP_HEADINGS) % JP_HEADINGS),
                                       .first_move = toy->move_count,
                                       .move_count = (uint8_t)kind->steps};
    for (int i = 0; i < kind->steps; i++) {
        const int turned = kind->steps > 1 ? kind->turn * i / (kind->steps - 1) : 0;
        const uint8_t direction = (uint8_t)((heading + turned + JP_HEADINGS) % JP_HEADINGS);
        toy->moves[toy->move_count++] = direction;
        toy_stand(&cells, x + jp_move_offsets[direction].dx / 2, y + jp_move_offsets[direction].dy / 2, toy->arm);
        x += jp_move_offsets[direction].dx;
        y += jp_move_offsets[direction].dy;
        toy_stand(&cells, x, y, toy->arm);
    }
    primitive->dx = (int8_t)x;
    primitive->dy = (int8_t)y;
    for (int i = 0; i < JP_COST_KINDS; i++) {
        primitive->base[i] = (uint16_t)(kind->turn == 0 ? below(3) : 1 + below(TOY_STEP_MAX));
    }
    const struct jp_cells spans = toy_add_spans(toy, &cells);
    primitive->first_span = spans.first_span;
    primitive->span_count = (uint8_t)spans.span_count;
    for (int i = 0; i < TOY_SIDE * TOY_SIDE; i++) {
        reach->has[i / TOY_SIDE][i % TOY_SIDE] |= cells.has[i / TOY_SIDE][i % TOY_SIDE];
    }
}

static inline void toy_add_heading(struct toy_lattice *toy, int heading)
{
    struct jp_lattice *lattice = &toy->lattice;
    struct toy_cells reach;
    struct toy_cells footprint;

    memset(&reach, 0, sizeof reach);
    memset(&footprint, 0, sizeof footprint);
    toy_stand(&footprint, 0, 0, toy->arm);
    lattice->heading[heading] = (jp_angle)heading << 28;
    lattice->footprint[heading] = toy_add_spans(toy, &footprint);
    lattice->core = lattice->footprint[heading];
    lattice->first_from[heading] = toy->primitive_count;
    for (int i = 0; i < TOY_KINDS; i++) {
        if (i == 0 || below(100) < TOY_KEEP_PERCENT) {
            toy_add_primitive(toy, heading, &toy_kinds[i], &reach);
        }
    }
    lattice->reach[heading] = toy_add_spans(toy, &reach);
}

static inline void toy_sort_by_end(struct toy_lattice *toy)
{
    uint16_t count = 0;

    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        toy->lattice.first_to[heading] = count;
        for (uint16_t i = 0; i < toy->primitive_count; i++) {
            if (toy->primitives[i].end == heading) {
                toy->by_end[count++] = i;
            }
        }
    }
    toy->lattice.first_to[JP_HEADINGS] = count;
}

/** Convex, dearer uphill than downhill, never below its floor. */
static inline void toy_price(struct toy_lattice *toy)
{
    static const int percent[JP_MOVE_KINDS] = {100, 224, 141};

    for (int kind = 0; kind < JP_COST_KINDS; kind++) {
        const int32_t step = 20 + (int32_t)below(TOY_STEP_MAX);
        const int32_t per_rise = (int32_t)below(40);
        const int32_t square = (int32_t)below(5000);
        for (int move = 0; move < JP_MOVE_KINDS; move++) {
            const struct jp_polynomial climb = {step * percent[move] / 100 * 65536, per_rise * 65536, square};
            const struct jp_polynomial descend = {climb.constant / 2, climb.linear / 3, square};
            toy->lattice.move_costs[kind][move] =
                (struct jp_slope_cost){.climb = climb,
                                       .descend = descend,
                                       .bend = (int16_t) - (int32_t)below(20),
                                       .rise_max = (int16_t)(54 * percent[move] / 100),
                                       .floor = (uint16_t)(1 + below(100))};
        }
    }
}

/** At random; the tables pass jp_lattice_check(). */
static inline void toy_lattice_make(struct toy_lattice *toy, jp_q16 resolution)
{
    memset(toy, 0, sizeof *toy);
    toy->arm = (int)below(2);
    toy->lattice.name = "toy";
    toy->lattice.resolution = resolution;
    toy->lattice.primitives = toy->primitives;
    toy->lattice.by_end = toy->by_end;
    toy->lattice.moves = toy->moves;
    toy->lattice.spans = toy->spans;
    for (int heading = 0; heading < JP_HEADINGS; heading++) {
        toy_add_heading(toy, heading);
    }
    toy->lattice.first_from[JP_HEADINGS] = toy->primitive_count;
    toy_sort_by_end(toy);
    toy_price(toy);
}

#endif
