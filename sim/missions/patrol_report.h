/** What drives of the patrol robot are shown as: a table for people, summary.json for programs. */
#ifndef JOULEPATH_SIM_MISSIONS_PATROL_REPORT_H
#define JOULEPATH_SIM_MISSIONS_PATROL_REPORT_H

#include <jansson.h>

#include "sim/missions/patrol_record.h"

struct patrol_run {
    enum patrol_method method;
    struct patrol_result result;
    struct patrol_record record;
};

struct patrol_report {
    const struct four_wheel_file *robot;
    const struct patrol_scene *scene;
    const char *map_path; /**< NULL: a scene from a seed */
    uint64_t seed;        /**< of the noise */
    struct patrol_faults faults;
    bool turns_by_fixed_angle; /**< the improved band, by the paper's rule */
    bool plans_by_length;      /**< likewise */
    struct patrol_run runs[PATROL_METHODS];
    size_t run_count;
};

/** Name of the file with a method's log. */
const char *patrol_report_log(enum patrol_method method);

void patrol_report_print(const struct patrol_report *report);

/** What is there on a scene's map, and what is not on it; a new reference. The path may be NULL. */
json_t *patrol_report_map(const struct patrol_scene *scene, const char *map_path);

/** A new reference. */
json_t *patrol_report_json(const struct patrol_report *report);

#endif
