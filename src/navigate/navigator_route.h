/** How the navigator comes to a course: a route is searched, or proved that there is none, and joined. Private to the
 * navigator. */
#ifndef JOULEPATH_NAVIGATE_NAVIGATOR_ROUTE_H
#define JOULEPATH_NAVIGATE_NAVIGATOR_ROUTE_H

#include <joulepath/navigator.h>

/** Plans from the cell where the robot is, or from one near it when it stands nearer to obstacles than the planner lets
 *  it. False: there is none. */
bool jp_route_begin(struct jp_navigator *navigator, const struct jp_place *place);

/** A slice of the planner. */
enum jp_answer jp_route_think(struct jp_navigator *navigator);

/** A slice of the state PLANNING, */
void jp_route_search(struct jp_navigator *navigator, const struct jp_place *place);

/** of PROVING, */
void jp_route_prove(struct jp_navigator *navigator);

/** and of JOINING. */
void jp_route_join(struct jp_navigator *navigator, const struct jp_place *place);

#endif
