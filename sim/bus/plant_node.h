/**
 * The robot's body as a node on CAN, whatever its kind: samples out, MotorCommand or
 * WheelTarget in. The bridges hold their duty while
 * commands fail to come, and switch off after PLANT_HOLD_MS. A hand holds a balancer upright until the bridges first
 * drive.
 */
#ifndef JOULEPATH_SIM_BUS_PLANT_NODE_H
#define JOULEPATH_SIM_BUS_PLANT_NODE_H

#include "hal/can/messages.h"
#include "sim/balancer/world.h"
#include "sim/bus/patrol_body.h"
#include "sim/skid_steer/skid_world.h"

/** Without a valid MotorCommand for so long the bridges switch off; as joulepath.dbc says. */
#define PLANT_HOLD_MS 40U

enum plant_kind { PLANT_BALANCER, PLANT_SKID, PLANT_PATROL };

struct plant_node {
    enum plant_kind kind;
    struct world world;         /**< a balancer's, */
    struct skid_world skid;     /**< or that of a robot that its sides steer, */
    struct patrol_body *patrol; /**< or the body of one with four steered wheels, */
    struct world_faults faults; /**< and of its sensors and bridges */
    struct jp_e2e_receiver receiver;
    struct jp_actuation actuation; /**< of the last valid command */
    uint8_t sample_counter;
    uint32_t silence;         /**< ticks since the last valid command */
    bool commanded;           /**< a valid command came since the last step */
    double drawn_j;           /**< from the battery's terminals */
    double power_w;           /**< that left them in the last step */
    uint64_t crc_errors;      /**< MotorCommands with a wrong Crc */
    uint64_t sequence_errors; /**< MotorCommands repeated, late or out of order */
    uint64_t malformed;       /**< MotorCommands of a wrong length */
    uint64_t silences;        /**< times that the bridges switched off for want of commands */
};

/** What is so: m, rad, m/s, rad/s, A. */
struct plant_truth {
    double x;
    double y;
    double heading;
    double speed;
    double turn_rate;
    double pitch; /**< of a balancer, forward positive; else 0 */
    double current_left;
    double current_right;
};

/** Held upright at rest. The robot file is copied. A node must not be moved after it. */
void plant_node_init(struct plant_node *node, const struct robot_file *robot, uint64_t seed);

/** The same of a robot that its sides steer, at rest at a pose. The model is copied; what `ground` points to stays in
 *  use. */
void plant_node_init_skid(struct plant_node *node, const struct skid_steer_model *model,
                          const struct skid_ground *ground, const struct planar_pose *pose, uint64_t seed);

/** The same of a robot with four steered wheels, whose body stays in use. */
void plant_node_init_patrol(struct plant_node *node, struct patrol_body *body);

/** Ticks a second, and those that passed. */
double plant_node_rate(const struct plant_node *node);
uint64_t plant_node_tick(const struct plant_node *node);

void plant_node_look(const struct plant_node *node, struct plant_truth *truth);

/** Adds state and ledger to a fingerprint. */
void plant_node_fingerprint(const struct plant_node *node, uint64_t *fingerprint);

/** Measures and sends the sample of this tick; every 100 ms BatteryStatus too, if the robot's
 *  file knows what the battery holds. */
void plant_node_sense(struct plant_node *node, const struct jp_can_port *port);

/** Takes a frame; true when it completed a valid command. Frames of others are ignored. */
bool plant_node_accept(struct plant_node *node, const struct jp_can_frame *frame);

/** One tick of physics under the last valid command. */
void plant_node_step(struct plant_node *node);

#endif
