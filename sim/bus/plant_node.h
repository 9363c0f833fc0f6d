/**
 * The robot's body as a node on CAN: samples out, MotorCommand in. The bridges hold their duty while commands fail to
 * come, and switch off after PLANT_HOLD_TICKS. A hand holds the robot upright until the bridges first drive.
 */
#ifndef JOULEPATH_SIM_BUS_PLANT_NODE_H
#define JOULEPATH_SIM_BUS_PLANT_NODE_H

#include "hal/can/messages.h"
#include "sim/balancer/world.h"

/** Ticks without a valid MotorCommand after which the bridges switch off; as joulepath.dbc says. */
#define PLANT_HOLD_TICKS 40U

struct plant_node {
    struct world world;
    struct jp_e2e_receiver receiver;
    struct jp_actuation actuation; /**< of the last valid command */
    uint8_t sample_counter;
    uint32_t silence;         /**< ticks since the last valid command */
    bool commanded;           /**< a valid command came since the last step */
    double drawn_j;           /**< from the battery */
    uint64_t crc_errors;      /**< MotorCommands with a wrong Crc */
    uint64_t sequence_errors; /**< MotorCommands repeated, late or out of order */
    uint64_t malformed;       /**< MotorCommands of a wrong length */
    uint64_t silences;        /**< times that the bridges switched off for want of commands */
};

/** Held upright at rest. The robot file is copied. A node must not be moved after it. */
void plant_node_init(struct plant_node *node, const struct robot_file *robot, uint64_t seed);

/** Measures and sends the sample of this tick; every 100 ms BatteryStatus too. */
void plant_node_sense(struct plant_node *node, const struct jp_can_port *port);

/** Takes a frame; true when it was a valid MotorCommand. Frames of others are ignored. */
bool plant_node_accept(struct plant_node *node, const struct jp_can_frame *frame);

/** One tick of physics under the last valid command. */
void plant_node_step(struct plant_node *node);

/** Power that leaves the battery, W. */
double plant_node_power(const struct plant_node *node);

#endif
