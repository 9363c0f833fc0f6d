/** A round of the patrol robot as a file tells it: stops, charger and battery. */
#ifndef JOULEPATH_SIM_MISSIONS_PATROL_ROUND_FILE_H
#define JOULEPATH_SIM_MISSIONS_PATROL_ROUND_FILE_H

#include <joulepath/patrol_round.h>

#include "sim/scenes/patrol_task.h"

struct patrol_round_file {
    double charger[3]; /**< m, m, ° in the map's frame, as the robot stands at it */
    struct {
        struct planar_pose pose; /**< m and rad, likewise */
        double dwell_s;
    } stops[JP_PATROL_STOPS_MAX];
    unsigned stop_count;
    double full_j; /**< of the battery */
    double reserve_j;
    double charger_w;
    double deviations;
};

/** False after one line on stderr: file, key or line, what, what to do. */
bool patrol_round_file_load(const char *path, struct patrol_round_file *file);

struct planar_pose patrol_round_charger(const struct patrol_round_file *file);

/** On the map of a scene, as the round goes over the bus, so that one that does not is the same to the bit. */
struct jp_patrol_round_config patrol_round_config_of(const struct patrol_round_file *file,
                                                     const struct patrol_scene *scene);

#endif
