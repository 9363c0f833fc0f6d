/** The mission's map with what scans show on it, made in slices. Private to the mission. */
#ifndef JOULEPATH_LOCAL_PATROL_MARKING_H
#define JOULEPATH_LOCAL_PATROL_MARKING_H

#include <joulepath/patrol_mission.h>

/** The map as it is given. Work: its cells. */
void jp_patrol_marking_start(struct jp_patrol_mission *mission);

/** Forgets all marks at once. Work: the cells of the map. */
void jp_patrol_marking_forget_now(struct jp_patrol_mission *mission);

/** All marks are to be forgotten, before others are made and the next path is looked for. */
void jp_patrol_marking_forget(struct jp_patrol_mission *mission);

/** Marks are to be made of what the scan shows, if there is one, and then is done what they are for. A map must not
 * change while a path is looked for: but to watch the goal the state is PLANNING from now on. */
void jp_patrol_marking_begin(struct jp_patrol_mission *mission, const struct jp_patrol_input *input,
                             enum jp_patrol_marks marks);

/** The rest of the marks is of a scan that comes meanwhile, from where the robot is by then. */
void jp_patrol_marking_see(struct jp_patrol_mission *mission, const struct jp_patrol_input *input);

/** Whether anything is to be forgotten or marked. */
bool jp_patrol_marking_is_due(const struct jp_patrol_mission *mission);

/** A part of it, of the work of so many expansions. True: all marks are made. */
bool jp_patrol_marking_work(struct jp_patrol_mission *mission, unsigned expansions);

#endif
