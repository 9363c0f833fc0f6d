/** The fields whose sum is the heuristic of the exact search: what the ground costs at least, and what turning does. */
#ifndef JOULEPATH_SEARCH_PLANNER_FIELDS_H
#define JOULEPATH_SEARCH_PLANNER_FIELDS_H

#include <joulepath/planner.h>

/** Roots them at the robot; they must grow next. */
void jp_fields_start(struct jp_planner_internal *planner);

/** Roots the turn field alone, in the memory where it is, at the robot; it must grow next. */
void jp_fields_start_turns(struct jp_planner_internal *planner);

/** Lower bound of the cost from the root to a pose; JP_COST_MAX: no path leads there. */
jp_cost jp_fields_bound(const struct jp_planner_internal *planner, const struct jp_lattice_pose *pose);

/** The least of the goal's headings. */
jp_cost jp_fields_bound_at_goal(const struct jp_planner_internal *planner);

/** Lower bound of what turning costs between the robot and the goal, without the fields that are there. */
jp_cost jp_fields_turns_to_goal(const struct jp_planner_internal *planner);

/** True when the root cannot reach the robot: the fields bound none of its routes then. */
bool jp_fields_are_cut_off(const struct jp_planner_internal *planner);

/** The cells where bounds may have fallen since the last such call. */
struct jp_cell_box jp_fields_take_lowered(struct jp_planner_internal *planner);

/** A cell of the map has changed, and the robot may drive cheaper. */
void jp_fields_cell_changed(struct jp_planner_internal *planner, int32_t x, int32_t y);

#endif
