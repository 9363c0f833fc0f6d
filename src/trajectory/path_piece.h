/** What path and speeds ask of a piece. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_PATH_PIECE_H
#define JOULEPATH_TRAJECTORY_PATH_PIECE_H

#include <joulepath/lattice_path.h>
#include <stddef.h>

#include "src/base/integer.h"

/** Grades of straight lines that become one piece, rise over run: a power of the motors that follows the grade bends by
 *  little between them. */
#define JP_PIECE_GRADE_SPREAD_MAX JP_Q24(0.03125)

static inline bool jp_piece_is_straight(const struct jp_path_piece *piece)
{
    return piece->kind == JP_PIECE_CURVE && piece->bend == 0 && piece->bend_rate == 0;
}

/** Rise over run, of a curve. */
static inline jp_q24 jp_piece_grade(const struct jp_path_piece *piece)
{
    return jp_divide((int64_t)piece->rise * ((int64_t)1 << 32), piece->length);
}

static inline bool jp_piece_is_on_the_same(const struct jp_path_piece *a, const struct jp_path_piece *b)
{
    return a->ground_left == b->ground_left && a->ground_right == b->ground_right && a->is_at_edge == b->is_at_edge;
}

/** On the same ground, that rises alike. */
static inline bool jp_piece_lies_alike(const struct jp_path_piece *a, const struct jp_path_piece *b)
{
    return jp_piece_is_on_the_same(a, b) &&
           jp_absolute64((int64_t)jp_piece_grade(a) - jp_piece_grade(b)) <= JP_PIECE_GRADE_SPREAD_MAX;
}

/** Curvature, and how it changes. */
struct jp_path_bend {
    jp_q24 bend; /**< 1/m */
    jp_q16 rate; /**< 1/m² */
};

/** So far on a piece; where it jumps to that of the next piece, which may be null, evenly. */
static inline struct jp_path_bend jp_piece_bend_at(const struct jp_path_piece *piece, const struct jp_path_piece *next,
                                                   jp_q24 way)
{
    struct jp_path_bend at = {jp_piece_bend(piece, way), piece->bend_rate};

    if (way < piece->speed.blend) {
        at.bend -= jp_multiply_shift(piece->speed.blend_rate, piece->speed.blend - way, 16);
        at.rate = jp_add(at.rate, piece->speed.blend_rate);
    }
    if (next != NULL) {
        const jp_q24 into = way - (piece->length - next->speed.blend);

        if (into > 0) {
            at.bend += jp_multiply_shift(next->speed.blend_rate, into, 16);
            at.rate = jp_add(at.rate, next->speed.blend_rate);
        }
    }
    return at;
}

/** v² in Q48 is so much more after a way. */
static inline int64_t jp_piece_change_of_square(jp_q24 acceleration, jp_q24 way)
{
    return 2 * (int64_t)acceleration * way;
}

/** Of a robot that begins a piece at a speed, after `way` on it: on its way to the cruise, or braking. */
static inline jp_q24 jp_piece_speed_after(const struct jp_piece_speed *speed, jp_q24 begin, jp_q24 way)
{
    const int64_t cruise = (int64_t)speed->cruise * speed->cruise;
    const int64_t gained = (int64_t)begin * begin + jp_piece_change_of_square(speed->acceleration, way);
    const int64_t lost = cruise - jp_piece_change_of_square(speed->acceleration, way - speed->brake_from);
    const int64_t before = gained < cruise ? gained : cruise;

    return (jp_q24)jp_square_root((uint64_t)(way <= speed->brake_from ? before : lost));
}

/** `next` becomes a part of the piece before it. */
static inline void jp_piece_lengthen(struct jp_path_piece *last, const struct jp_path_piece *next)
{
    last->length += next->length;
    last->rise += next->rise;
}

#endif
