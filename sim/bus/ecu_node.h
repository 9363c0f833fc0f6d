/** The firmware's application on a host: what power and memory are to it on a board. */
#ifndef JOULEPATH_SIM_BUS_ECU_NODE_H
#define JOULEPATH_SIM_BUS_ECU_NODE_H

#include <joulepath/balancer_vehicle.h>
#include <joulepath/skid_vehicle.h>

#include "hal/app/ecu_balancer.h"
#include "hal/app/ecu_patrol_round.h"
#include "hal/app/ecu_skid.h"
#include "hal/app/lockstep.h"
#include "hal/app/navigation_memory.h"
#include "hal/app/patrol_memory.h"
#include "hal/linux/can_link.h"
#include "sim/balancer/robots.h"
#include "sim/four_wheel/patrol_robots.h"
#include "sim/skid_steer/skid_robots.h"

/** A balancer as an ECU has it. */
struct ecu_node_balancer {
    const struct robot_entry *entry;
    const struct jp_energy_model *model;
    struct jp_ecu_balancer robot;
    struct jp_balancer_vehicle vehicle;
};

/** The same of a robot that its sides steer. */
struct ecu_node_skid {
    const struct skid_robot_entry *entry;
    struct jp_ecu_skid robot;
    struct jp_skid_vehicle vehicle;
};

/** The same of a robot with four steered wheels. */
struct ecu_node_patrol {
    const struct patrol_robot_entry *entry;
    struct jp_ecu_patrol robot;
    struct jp_ecu_patrol_round round;
    struct jp_patrol_map map;
    struct jp_patrol_block block;
};

struct ecu_node {
    struct jp_lockstep lockstep;
    const char *name;                  /**< of the robot */
    uint32_t identity;                 /**< of its parameters */
    struct ecu_node_balancer balancer; /**< it is this where there is an entry, */
    struct ecu_node_skid skid;         /**< or this, */
    struct ecu_node_patrol patrol;     /**< or this */
    struct jp_retained own_record;     /**< where no other is given */
    struct jp_parameters parameters;   /**< what power-off leaves */
    enum jp_stored stored;             /**< what the last boot found of them */
    const char *path;                  /**< of the file that keeps them; NULL: they end with the process */
    struct jp_navigation navigation;   /**< where the robot has tables for it */
    struct jp_navigation_ground ground;
    struct jp_navigation_block block;
    struct jp_ecu_battery battery;  /**< where the robot has tables for it, and counts what leaves it */
    struct jp_navigation_home home; /**< of the navigator */
    jp_q31 confidence;              /**< with which it turns back by itself; 0: never */
    struct jp_navigation_home_memory home_memory;
    bool ran; /**< the motors did at the last look */
};

/**
 * Boots. retained NULL: a record of its own, empty. `parameters` is the path of a file that keeps what is learned,
 * NULL: none. It learns when the robot has tables for this model, and navigates when it has some for that. Prints one
 * line on stderr and returns false when configuration or model are refused or the file cannot be read. A node must not
 * be moved after it.
 */
bool ecu_node_init(struct ecu_node *node, const struct robot_entry *entry, const struct jp_energy_model *model,
                   const struct jp_can_port *bus, struct jp_retained *retained, const char *parameters);

/** The same of a robot that its sides steer, which always learns. */
bool ecu_node_init_skid(struct ecu_node *node, const struct skid_robot_entry *entry, const struct jp_can_port *bus,
                        struct jp_retained *retained, const char *parameters);

/** The same of a robot with four steered wheels. */
bool ecu_node_init_patrol(struct ecu_node *node, const struct patrol_robot_entry *entry, const struct jp_can_port *bus,
                          struct jp_retained *retained, const char *parameters);

/** From now on it turns back by itself when what is left in its battery brings it home less probably, ½…0.9999. Before
 *  the first tick. */
void ecu_node_turn_back(struct ecu_node *node, jp_q31 confidence);

/** After every tick: when the motors were switched off and there was no fault, what was learned is kept. False after
 * one line on stderr. */
bool ecu_node_watch(struct ecu_node *node);

/** Before the process ends: keeps what was learned unless there was a fault. False after one line on stderr. */
bool ecu_node_end(struct ecu_node *node);

#endif
