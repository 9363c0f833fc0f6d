/**
 * Non-uniform cubic spline through the turning points of a way: C2, its knots at the chord lengths, curvature 0 at both
 * ends. Knots on the way on both sides of a turning point keep the curve from swinging out beyond its surroundings.
 * Where a piece would leave the free space, its chord, which is free, gets a knot in its middle, so that the curve
 * draws near the way, until it is free. A piece that can have no knot, for want of scratch memory or because its chord
 * touches blocked cells on both sides, stays straight, with points at its ends only.
 *
 * So the curve keeps the clearance that the way has. Integers only: the same bits on every core. Nothing here is for
 * ISRs.
 */
#ifndef JOULEPATH_PATH_SPLINE_H
#define JOULEPATH_PATH_SPLINE_H

#include <joulepath/grid_planner.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Smooths `count` >= 2 turning points to `*smooth_count` points at most about `spacing` m apart in `smooth` (room for
 * `smooth_max`), from the first turning point to the last, with `scratch` of jp_path_spline_size(count) bytes or more,
 * aligned to 8; more of it lets more pieces have knots. Every line between neighbouring points is free. Turning points
 * that repeat the one before are left out.
 * JP_ERR_ARGUMENT: a null pointer, fewer than two turning points, or a spacing below 2⁻⁸ m. JP_ERR_ALIGNMENT.
 * JP_ERR_ZERO_LENGTH: all turning points coincide. JP_ERR_MEMORY: the scratch is too small, or the points do not fit.
 * JP_ERR_BLOCKED: the way itself is not free. *smooth_count is 0 unless JP_OK.
 * Work: rounds over the knots and the points, each point as jp_grid_planner_line_is_free(). Each round but the last
 * adds a knot or makes a piece straight: at most twice as many rounds as knots fit, as a rule less than ten.
 */
enum jp_status jp_path_spline(const struct jp_grid_planner *planner, const struct jp_point *way, size_t count,
                              jp_q16 spacing, void *scratch, size_t scratch_size, struct jp_point *smooth,
                              size_t smooth_max, size_t *smooth_count);

/** Bytes of scratch memory: 28 for each of five knots a turning point, and of eight more. */
size_t jp_path_spline_size(size_t count);

#ifdef __cplusplus
}
#endif

#endif
