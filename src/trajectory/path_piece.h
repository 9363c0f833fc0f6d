/** What path and speeds ask of a piece. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_PATH_PIECE_H
#define JOULEPATH_TRAJECTORY_PATH_PIECE_H

#include <joulepath/lattice_path.h>

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

/** `next` becomes a part of the piece before it. */
static inline void jp_piece_lengthen(struct jp_path_piece *last, const struct jp_path_piece *next)
{
    last->length += next->length;
    last->rise += next->rise;
}

#endif
