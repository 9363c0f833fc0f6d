/** Following the path by the elastic band, until the goal is there. Private to the patrol. */
#ifndef JOULEPATH_LOCAL_PATROL_DRIVE_H
#define JOULEPATH_LOCAL_PATROL_DRIVE_H

#include <joulepath/patrol.h>

/** A cycle of the states DRIVING and WAITING. */
void jp_patrol_drive(struct jp_patrol *patrol, const struct jp_plane_speed *speed);

#endif
