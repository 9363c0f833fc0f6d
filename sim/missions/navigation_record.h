/** What is kept of a drive of the navigator: a log, its courses, and what it saw that the map did not show. */
#ifndef JOULEPATH_SIM_MISSIONS_NAVIGATION_RECORD_H
#define JOULEPATH_SIM_MISSIONS_NAVIGATION_RECORD_H

#include <jansson.h>
#include <stdio.h>

#include "sim/files/map_file.h"
#include "sim/missions/navigation_task.h"

struct navigation_record {
    FILE *log;
    const struct map_file *map;
    json_t *courses; /**< when each was begun, and its waypoints in the map's frame */
    json_t *seen;    /**< cells, and when */
    enum jp_navigator_state state;
    double next_line; /**< s */
    bool is_live;     /**< a line on the terminal */
};

/** Writes the header of the log. */
void navigation_record_init(struct navigation_record *record, const struct map_file *map, FILE *log);

/** Of struct navigation_task; the context is the record. */
void navigation_record_watch(void *context, const struct navigation_frame *frame);

/** A cell was seen to be otherwise. */
void navigation_record_see(void *context, const struct navigation_sight *sight);

/** Ends the line on the terminal. */
void navigation_record_end(struct navigation_record *record);

void navigation_record_free(struct navigation_record *record);

#endif
