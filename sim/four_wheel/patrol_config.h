/** The controller's configuration for a robot and a method. */
#ifndef JOULEPATH_SIM_FOUR_WHEEL_PATROL_CONFIG_H
#define JOULEPATH_SIM_FOUR_WHEEL_PATROL_CONFIG_H

#include <joulepath/patrol_pilot.h>
#include <joulepath/pure_pursuit.h>

#include "sim/base/planar.h"
#include "sim/four_wheel/four_wheel_file.h"

/** Cycles in a second; each has FOUR_WHEEL_RATE_HZ / PATROL_CYCLE_HZ ticks. */
#define PATROL_CYCLE_HZ 10

enum patrol_method {
    PATROL_IMPROVED, /**< improved TEB */
    PATROL_PLAIN,    /**< the same band without turning in place, odometry residual and no-reversing term */
    PATROL_PURSUIT,  /**< pure pursuit of the path, blind to obstacles */
    PATROL_METHODS
};

/** For PATROL_PURSUIT as for PATROL_IMPROVED, but that it turns first by a fixed angle. */
struct jp_patrol_config patrol_config(const struct four_wheel_file *robot, enum patrol_method method);

/** `map` is kept. */
struct jp_localiser_config patrol_localiser_config(const struct four_wheel_file *robot, const struct jp_terrain *map);

struct jp_patrol_scanner patrol_scanner(const struct four_wheel_file *robot);

/** Of its control tick. */
struct jp_four_wheel_robot_config patrol_robot_config(const struct four_wheel_file *robot);

struct jp_pure_pursuit_config patrol_pursuit_config(const struct four_wheel_file *robot);

/** A cycle of pure pursuit, from where the robot will be after its latency: jp_pure_pursuit_tick(). */
enum jp_status patrol_pursue(struct jp_pure_pursuit *pursuit, const struct four_wheel_file *robot,
                             const struct planar_pose *pose, const struct jp_plane_speed *speed,
                             struct jp_twist *twist);

#endif
