/** A route of the lattice driven by a robot that its sides steer, by its own odometry, over the ground of the map. */
#ifndef JOULEPATH_SIM_MISSIONS_PLAN_SKID_DRIVE_H
#define JOULEPATH_SIM_MISSIONS_PLAN_SKID_DRIVE_H

#include <joulepath/skid_path_energy.h>

#include "sim/missions/navigation_skid.h"
#include "sim/missions/plan_drive.h"

#define PLAN_PIECES_MAX 1024

struct plan_skid_drive {
    struct navigation_skid skid;
    struct navigation_robot robot;
    struct jp_path_piece pieces[PLAN_PIECES_MAX];
    struct jp_lattice_path path;
    struct clearance_pose places[PLAN_PIECES_MAX + 1]; /**< begins of the pieces, and the end */
    struct plan_driven driven;
};

/** Turns a route of at least one step into a path and switches the robot on at its begin; *entry and *drive stay in
 * use. False after one line on stderr: it cannot be driven. */
bool plan_skid_drive_prepare(const struct map_file *map, const struct jp_lattice *lattice,
                             const struct skid_robot_entry *entry, const struct skid_steer_model *model,
                             const struct plan_route *route, struct plan_skid_drive *drive);

/** Drives it: drive->driven and the log, which is that of odometry without its errors. */
void plan_skid_drive_run(const struct map_file *map, struct plan_skid_drive *drive, FILE *log);

#endif
