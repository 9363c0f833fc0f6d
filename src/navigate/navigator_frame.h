/** Where the robot and its legs are: on the map, and as its odometry counts. Private to the navigator. */
#ifndef JOULEPATH_NAVIGATE_NAVIGATOR_FRAME_H
#define JOULEPATH_NAVIGATE_NAVIGATOR_FRAME_H

#include <joulepath/navigator.h>

/** What the vehicle says of itself; if it says nothing, it moves. */
struct jp_vehicle_view jp_frame_look(const struct jp_navigator *navigator);

/** Its place on the map. */
struct jp_place jp_frame_place(const struct jp_navigator *navigator, const struct jp_vehicle_view *view);

/** A point of the map as odometry counts. */
struct jp_point jp_frame_in_odometry(const struct jp_navigator *navigator, const struct jp_point *point);

/** The ground of its map as its odometry counts. */
struct jp_ground jp_frame_make_ground(const struct jp_navigator *navigator);

/** The same once it was made; null: it is level. */
const struct jp_ground *jp_frame_ground(const struct jp_navigator *navigator);

/** Of one point from another. */
jp_angle jp_frame_direction(const struct jp_point *from, const struct jp_point *to);

/** Of a leg. */
struct jp_point jp_frame_leg_begin(const struct jp_navigator *navigator, unsigned leg);
jp_angle jp_frame_leg_direction(const struct jp_navigator *navigator, unsigned leg);

/** A point as seen along a leg from its end: x ahead, beyond the end, and y to the left of the line. */
struct jp_point jp_frame_along_leg(const struct jp_navigator *navigator, unsigned leg, const struct jp_point *point);

/** The nearest one of the headings in a set of a lattice, which is not empty; of two as near the first. */
uint8_t jp_frame_nearest_heading(const struct jp_lattice *lattice, uint16_t headings, jp_angle heading);

/** Where what is left of a leg begins: beside the robot. */
struct jp_point jp_frame_left_of_leg(const struct jp_navigator *navigator, unsigned leg, const struct jp_point *point);

#endif
