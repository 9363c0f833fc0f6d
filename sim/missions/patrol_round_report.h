/** What hours of patrol are shown as: a table of journeys for people, summary.json for programs. */
#ifndef JOULEPATH_SIM_MISSIONS_PATROL_ROUND_REPORT_H
#define JOULEPATH_SIM_MISSIONS_PATROL_ROUND_REPORT_H

#include <jansson.h>

#include "sim/missions/patrol_round_drive.h"

#define PATROL_ROUND_LOG "log_round.csv"

void patrol_round_print(const struct patrol_round_task *task, const struct patrol_round_result *result);

/** A new reference. `map_path` is that of the map's file. */
json_t *patrol_round_json(const struct patrol_round_task *task, const struct patrol_round_result *result,
                          const char *map_path);

#endif
