/** Missions of a robot that its sides steer: skid steer or differential drive. */
#ifndef JOULEPATH_SIM_MISSIONS_MISSION_SKID_H
#define JOULEPATH_SIM_MISSIONS_MISSION_SKID_H

#include "sim/missions/mission.h"

/** As mission_run(), of the strategies from MISSION_ROUNDED on. A leg's plan is that of the pilot when it began. */
bool mission_skid_run(struct mission *mission, enum mission_strategy strategy, const struct scenario *scenario,
                      const struct mission *driven, const struct mission_view *view);

#endif
