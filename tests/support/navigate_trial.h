/** A drive of the navigator on a dense map of a seed, and whether what became of it is right. */
#ifndef JOULEPATH_TESTS_SUPPORT_NAVIGATE_TRIAL_H
#define JOULEPATH_TESTS_SUPPORT_NAVIGATE_TRIAL_H

#include "sim/missions/navigation.h"
#include "sim/missions/navigation_balancer.h"
#include "sim/missions/navigation_skid.h"
#include "tests/support/dense_map.h"

struct navigate_robot {
    const struct jp_lattice *lattice;
    const struct robot_entry *entry; /**< of a balancer, or NULL */
    struct robot_file file;
    const struct skid_robot_entry *skid; /**< of one that its sides steer */
    struct skid_steer_model model;
    double hills_deg;           /**< of its maps, at most; 0: level */
    struct jp_gyro_scale scale; /**< as it knows it when a drive begins; all zero: nothing */
};

struct navigate_trial {
    bool is_reachable;          /**< in the world, by a planner that has memory for all of it */
    bool is_right;              /**< it touched nothing, and arrived, or said so where no route leads to the goal */
    double radius_m;            /**< of the disc in which the robot turns */
    struct jp_gyro_scale scale; /**< as it knows it at the end */
    struct navigation_result result;
};

/** courier24, burger, or zhang2018 on hills up to its limit. False after one line on stderr. */
bool navigate_robot_load(struct navigate_robot *robot, const char *name);

/** True when a route leads to the goal in the world; false also without memory. */
bool navigate_is_reachable(const struct navigate_robot *robot, struct jp_terrain *world,
                           const struct jp_lattice_pose *start, const struct jp_goal *goal);

/** Of a seed, with so much sight, m, and so much memory of the planner, bytes. False: no map, or no drive. */
bool navigate_trial_run(struct navigate_trial *trial, const struct navigate_robot *robot, uint64_t seed, double view_m,
                        size_t memory);

#endif
