/** Where a navigator goes to: its goal or, where that is blocked, a place that still covers it. Private to the
 * navigator. */
#ifndef JOULEPATH_NAVIGATE_NAVIGATOR_GOAL_H
#define JOULEPATH_NAVIGATE_NAVIGATOR_GOAL_H

#include <joulepath/navigator.h>

/** The cell nearest to the goal that was asked for on which the robot can stand, among those from which its disc covers
 *  it, and of cells as near the first of the lowest row; that goal itself where there is none. Work: a look for room at
 *  each of these cells and headings. */
struct jp_goal jp_navigator_choose_goal(const struct jp_navigator *navigator);

#endif
