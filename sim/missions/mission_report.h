/** Driven missions as tables for people and as the summary that tools/report/report.py reads. */
#ifndef JOULEPATH_SIM_MISSIONS_MISSION_REPORT_H
#define JOULEPATH_SIM_MISSIONS_MISSION_REPORT_H

#include <jansson.h>

#include "sim/missions/mission.h"

/** Short name of a strategy, and the file that its log goes to. */
const char *mission_name(enum mission_strategy strategy);
const char *mission_log_name(enum mission_strategy strategy);

/** Prints the legs of one mission. */
void mission_print(const struct mission *mission);

/** Prints the totals, relative to the first mission. */
void mission_print_comparison(const struct mission *missions, size_t count);

/** The summary; percentages are relative to the first mission. */
json_t *mission_json(const struct scenario *scenario, const struct mission *missions, size_t count);

#endif
