/** Whether a robot's rectangular footprint fits between the obstacles of a map: exact for a pose, sampled along an arc.
 */
#ifndef JOULEPATH_SIM_BASE_CLEARANCE_H
#define JOULEPATH_SIM_BASE_CLEARANCE_H

#include <joulepath/terrain.h>

/** In m from the south-west corner of the map, rad from its x axis. */
struct clearance_pose {
    double x;
    double y;
    double heading;
};

/** A footprint, centred on the pose, with `margin_m` added on all its sides; in all at most 120 cells across. */
struct clearance_robot {
    double length_m;
    double width_m;
    double margin_m;
};

/** An arc from `start`: `length_m` long while the heading turns by `angle`. A straight chord has angle 0. */
struct clearance_arc {
    struct clearance_pose start;
    double length_m;
    double angle; /**< rad */
};

/** True when the footprint touches no cell that is blocked or off the map. */
bool clearance_at(const struct jp_terrain *terrain, const struct clearance_robot *robot,
                  const struct clearance_pose *pose);

/** How many steps to cut an arc into, so that no point of the footprint moves farther than a tenth of a cell in one. */
unsigned clearance_steps(const struct jp_terrain *terrain, const struct clearance_robot *robot,
                         const struct clearance_arc *arc);

/** Pose at a share, 0…1, of an arc. */
struct clearance_pose clearance_arc_pose(const struct clearance_arc *arc, double share);

#endif
