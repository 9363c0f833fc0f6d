/** What is kept of a drive of the patrol robot: a line of a log each cycle, and for pictures its plans and, once a
 *  second, its band and what moves. */
#ifndef JOULEPATH_SIM_MISSIONS_PATROL_RECORD_H
#define JOULEPATH_SIM_MISSIONS_PATROL_RECORD_H

#include <jansson.h>
#include <stdio.h>

#include "sim/missions/patrol_mission.h"

struct patrol_record {
    FILE *log;
    json_t *plans;     /**< the grid planner's path and the smoothed one, and since when they were followed */
    json_t *snapshots; /**< band and moving obstacles */
    unsigned replans;  /**< as last seen */
    double next_snapshot;
};

/** Writes the header of the log. */
void patrol_record_init(struct patrol_record *record, FILE *log);

/** Of struct patrol_task; the context is the record. */
void patrol_record_observe(void *context, const struct patrol_view *view);

void patrol_record_free(struct patrol_record *record);

#endif
