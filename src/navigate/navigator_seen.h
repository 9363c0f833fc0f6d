/** What a robot has seen otherwise than its map, so that it can be forgotten. Without memory for it nothing is. Private
 *  to the navigator. */
#ifndef JOULEPATH_NAVIGATE_NAVIGATOR_SEEN_H
#define JOULEPATH_NAVIGATE_NAVIGATOR_SEEN_H

#include <joulepath/navigator.h>

/** It has seen nothing yet. Work: the memory. */
void jp_seen_start(struct jp_navigator *navigator);

/** Sees a cell. As jp_planner_set_cell(). */
enum jp_status jp_seen_set_cell(struct jp_navigator *navigator, int32_t x, int32_t y, enum jp_cell cell);

/** Whether what it has seen may be why it does not reach its goal: it has moved since it last knew no more than its
 *  map, and has not forgotten too often on the way to this goal. Constant time. */
bool jp_seen_may_mislead(const struct jp_navigator *navigator);

/** Takes the map as it was. Work: the cells, and jp_planner_set_cell() of those that it saw otherwise. */
void jp_seen_forget(struct jp_navigator *navigator);

#endif
