/**
 * Natural cubic spline through the turning points of a path, with the chord lengths as parameter: C2, curvature 0 at
 * both ends. Knots on the path on both sides of a turning point keep the curve from overshooting there. Where a piece
 * of the curve leaves the free space, its chord, which is free, gets a knot in its middle, until the curve is free. A
 * piece that can have no knot, because the scratch memory is full or its chord touches blocked cells on both sides,
 * becomes straight, with points at its ends only.
 *
 * So the curve keeps the clearance of the path. Integers only: the same bits on every core. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_PATH_SPLINE_H
#define JOULEPATH_PATH_SPLINE_H

#include <joulepath/grid_planner.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Smooths the `count` >= 2 turning points of `path`, m on the planner's map, and writes `*smooth_count` points, at most
 * about `spacing` m apart, to `smooth`, which has room for `smooth_max`. The first and the last point are those of the
 * path. Every line between neighbouring points is free. A turning point that repeats the one before it is left out.
 * `scratch` has at least jp_path_spline_size(count) bytes and is aligned to 8; more of it lets more pieces have knots.
 * JP_ERR_ARGUMENT: a null pointer, fewer than two turning points, or a spacing below 2⁻⁸ m. JP_ERR_ALIGNMENT: `scratch`
 * is not aligned to 8 bytes. JP_ERR_ZERO_LENGTH: all turning points coincide. JP_ERR_MEMORY: the scratch is too small,
 * or the points do not fit. JP_ERR_BLOCKED: the path itself is not free. *smooth_count is 0 unless JP_OK. Work: rounds
 * over the knots and the points, each point as jp_grid_planner_line_is_free(). Each round but the last adds a knot or
 * makes a piece straight: at most twice as many rounds as knots fit, as a rule less than ten.
 */
enum jp_status jp_path_spline(const struct jp_grid_planner *planner, const struct jp_point *path, size_t count,
                              jp_q16 spacing, void *scratch, size_t scratch_size, struct jp_point *smooth,
                              size_t smooth_max, size_t *smooth_count);

/** Least bytes of scratch memory for `count` turning points: 28 for each of 5 count + 8 knots. Constant time. */
size_t jp_path_spline_size(size_t count);

#ifdef __cplusplus
}
#endif

#endif
