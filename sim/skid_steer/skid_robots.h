/** The skid-steered and differential-drive robots whose tables are built in. The Makefile writes the list. */
#ifndef JOULEPATH_SIM_SKID_STEER_SKID_ROBOTS_H
#define JOULEPATH_SIM_SKID_STEER_SKID_ROBOTS_H

#include <joulepath/battery.h>
#include <joulepath/lattice.h>
#include <joulepath/navigator_body.h>
#include <joulepath/path_speed.h>
#include <joulepath/skid_learner.h>
#include <joulepath/skid_robot.h>
#include <joulepath/skid_steer.h>

struct skid_robot_entry {
    const char *name;
    const struct jp_skid_robot_config *config;
    const struct jp_skid_energy_model *energy;
    const struct jp_skid_learning *learning;
    const struct jp_path_limits *limits;
    const struct jp_lattice *lattice;
    const struct jp_skid_steer_config *priced;   /**< by whose formulas its lattices are priced */
    const struct jp_navigator_body *navigation;  /**< these three: NULL when there is no table */
    const struct jp_lattice *navigation_lattice; /**< of the disc in which it turns */
    const struct jp_battery_config *battery;     /**< of its cells */
};

/** The last has no name. */
extern const struct skid_robot_entry skid_robots[];

/** The robot of this name, or NULL. */
const struct skid_robot_entry *skid_robot_built_in(const char *name);

/** The same, or NULL after one line on stderr that tells how to make its tables. */
const struct skid_robot_entry *skid_robot_find(const char *name);

#endif
