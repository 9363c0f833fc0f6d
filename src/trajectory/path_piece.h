/** What path and speeds ask of a piece. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_PATH_PIECE_H
#define JOULEPATH_TRAJECTORY_PATH_PIECE_H

#include <joulepath/lattice_path.h>

static inline bool jp_piece_is_straight(const struct jp_path_piece *piece)
{
    return piece->kind == JP_PIECE_CURVE && piece->bend == 0 && piece->bend_rate == 0;
}

/** Rise over run, of a curve. */
static inline jp_q24 jp_piece_grade(const struct jp_path_piece *piece)
{
    return jp_divide((int64_t)piece->rise * ((int64_t)1 << 32), piece->length);
}

#endif
