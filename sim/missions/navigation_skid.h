/** A skid-steered or differential-drive robot that the navigator drives. */
#ifndef JOULEPATH_SIM_MISSIONS_NAVIGATION_SKID_H
#define JOULEPATH_SIM_MISSIONS_NAVIGATION_SKID_H

#include <joulepath/skid_vehicle.h>

#include "hal/hal.h"
#include "sim/files/map_file.h"
#include "sim/missions/navigation_robot.h"
#include "sim/skid_steer/skid_robots.h"
#include "sim/skid_steer/skid_world.h"

struct navigation_skid {
    struct skid_world world;
    struct jp_hal hal;
    struct jp_skid_robot controller;
    enum jp_status written;
    struct jp_path_piece pieces[JP_SKID_RUN_PIECES_MAX];
    struct jp_skid_grounds grounds;
    struct jp_skid_pilot pilot;
    struct jp_skid_vehicle vehicle;
};

/** Its outline. */
struct clearance_robot navigation_skid_body(const struct skid_steer_model *model);

/** What the classes of a map are like, as a surface; *classes and the map stay in use. */
struct skid_surface navigation_skid_surface(const struct jp_terrain *map, const struct map_ground *grounds,
                                            struct skid_classes *classes);

/** Switches on at `start`, on the ground of `terrain`, which is like `surface`, and whose classes it tells apart then;
 * or if that is null as the robot file says. Lets it stand until it knows its gyro. What the pointers show and *skid
 * stay in use. False after one line on stderr: a configuration is refused. */
bool navigation_skid_init(struct navigation_skid *skid, const struct skid_robot_entry *entry,
                          const struct skid_steer_model *model, const struct jp_terrain *terrain,
                          const struct skid_surface *surface, const struct clearance_pose *start, uint64_t seed,
                          struct navigation_robot *robot);

/** The same of a robot that has driven before, and knows so much of its gyro. */
bool navigation_skid_init_again(struct navigation_skid *skid, const struct skid_robot_entry *entry,
                                const struct skid_steer_model *model, const struct jp_terrain *terrain,
                                const struct skid_surface *surface, const struct clearance_pose *start, uint64_t seed,
                                const struct jp_gyro_scale *scale, struct navigation_robot *robot);

/** What it knows of it now, to be kept. */
struct jp_gyro_scale navigation_skid_gyro_scale(const struct navigation_skid *skid);

#endif
