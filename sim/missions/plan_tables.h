/** What a plan is shown as: a table for people, summary.json for programs. */
#ifndef JOULEPATH_SIM_MISSIONS_PLAN_TABLES_H
#define JOULEPATH_SIM_MISSIONS_PLAN_TABLES_H

#include <jansson.h>

#include "sim/missions/plan_drive.h"
#include "sim/missions/plan_search.h"

/** What is planned: energy-optimal, then distance-optimal. */
enum plan_aim { PLAN_ENERGY, PLAN_DISTANCE, PLAN_AIMS };

struct plan_report {
    const struct map_file *map;
    const char *map_path;
    const struct jp_lattice *lattice;
    const char *lattice_path;    /**< NULL: built in */
    const char *parameters_path; /**< of what the lattice is charged by; NULL: its own tables */
    struct plan_task task;
    size_t memory; /**< bytes */
    struct plan_search searches[PLAN_AIMS];
    const struct plan_driven *drive; /**< NULL: nothing is driven */
};

extern const char *const plan_route_files[PLAN_AIMS];

void plan_print(const struct plan_report *report);

/** A new reference. */
json_t *plan_json(const struct plan_report *report);

#endif
