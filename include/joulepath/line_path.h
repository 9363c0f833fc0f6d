/**
 * Path (lattice_path.h) along straight lines from target to target, with a turn on the spot towards the first one and
 * at each corner. path_corner.h rounds corners. On ground that is not level, or of several classes, a line is several
 * pieces, each of which rises evenly on one class: as many as there are places for.
 *
 * Integers only: the same bits on every core. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_LINE_PATH_H
#define JOULEPATH_LINE_PATH_H

#include <joulepath/ground.h>
#include <joulepath/lattice_path.h>

#ifdef __cplusplus
extern "C" {
#endif

struct jp_line_route {
    struct jp_point start;
    jp_angle heading;               /**< before the robot turns towards the first target */
    const struct jp_point *targets; /**< none where the line before it begins */
    uint16_t count;                 /**< at least 1 */
    const struct jp_ground *ground; /**< null: level */
    jp_q16 half_track;              /**< of the wheels on it, m; 0…2 */
};

/** Pieces that a path of so many targets takes on level ground at most, and on other ground at least. */
#define JP_LINE_PATH_PIECES(targets) (2U * (targets))

/**
 * Makes the path of a route. JP_ERR_ARGUMENT: a pointer is null, there is no target or no place. JP_ERR_ZERO_LENGTH: a
 * line is shorter than 1 mm. JP_ERR_INFEASIBLE: a line is longer than a piece may be. JP_ERR_MEMORY: it takes more
 * pieces than `places`. Work: a square root and an angle for each line, and the elevation of a point for each `spacing`
 * of it.
 */
enum jp_status jp_line_path(struct jp_lattice_path *path, struct jp_path_piece *pieces, uint16_t places,
                            const struct jp_line_route *route);

/** The path of a turn on the spot, where a route without targets starts. JP_ERR_ARGUMENT: a pointer is null, or there
 * is no place. JP_ERR_ZERO_LENGTH: it has that heading. Constant time. */
enum jp_status jp_turn_path(struct jp_lattice_path *path, struct jp_path_piece *pieces, uint16_t places,
                            const struct jp_line_route *route, jp_angle heading);

#ifdef __cplusplus
}
#endif

#endif
