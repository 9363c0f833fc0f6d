/**
 * Corners of a path: a turn on the spot between two straight lines becomes an arc where that costs less and the ground
 * beside the corner has room for it.
 *
 * An arc of radius R that joins the two lines touches them R tan(θ/2) before and after the corner, and passes it at a
 * distance of R (1/cos(θ/2) − 1), which is the clearance that it needs inside the corner. Of each line half may go, so
 * that its other end has as much, and goes at least 1 cm; R is at least 1 cm, and at most 100 m.
 */
#ifndef JOULEPATH_PATH_CORNER_H
#define JOULEPATH_PATH_CORNER_H

#include <joulepath/path_speed.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Radii that are tried: the greatest, and even shares of it. */
#define JP_CORNER_RADII 4

/** Arcs that may round a corner. */
struct jp_corner_room {
    jp_q24 clearance;  /**< how far inside the corner the middle of the robot may pass it, m */
    jp_q24 radius_min; /**< of an arc, m */
};

/**
 * Rounds the corner at piece `turn`, before the speeds of the path are planned, by the cheapest of JP_CORNER_RADII
 * arcs that have room. Costs are those of path_speed.h from a stand at the begin of the line before to one at the end
 * of the line after, and of time by its price. False, and the path stays as it is: a pointer is null, there is no turn
 * on the spot between straight lines, it turns by more than 150°, there is no room, or no arc costs less. Work: as
 * jp_path_plan_speeds() of 3 (JP_CORNER_RADII + 1) pieces. Not for ISRs.
 */
bool jp_path_round_corner(struct jp_lattice_path *path, uint16_t turn, const struct jp_corner_room *room,
                          const struct jp_path_limits *limits, const struct jp_motion_price *price);

#ifdef __cplusplus
}
#endif

#endif
