/**
 * The body of a robot with four steered wheels on CAN, among what moves in a scene: samples and scans out, WheelTarget
 * in. A scan is taken at one instant and goes out over some ticks.
 */
#ifndef JOULEPATH_SIM_BUS_PATROL_BODY_H
#define JOULEPATH_SIM_BUS_PATROL_BODY_H

#include "hal/can/scan_link.h"
#include "hal/can/wheel_link.h"
#include "sim/bus/patrol_battery.h"
#include "sim/four_wheel/four_wheel_plant.h"
#include "sim/four_wheel/laser.h"
#include "sim/scenes/patrol_task.h"

/** Frames of a scan that go out in a tick: with the rest of it less than the half of 1 Mbit/s. */
#define PATROL_BODY_SCAN_FRAMES 31U

struct patrol_body {
    const struct four_wheel_file *robot;
    struct patrol_world world;
    struct four_wheel_plant plant;
    struct laser_config laser;
    struct laser_scan scan;
    uint16_t ranges[JP_SCAN_LINK_BEAMS]; /**< of it, raw */
    struct random random;
    bool is_world_moving; /**< else who walks waits */
    uint64_t tick;
    struct jp_wheel_targets targets;
    struct jp_four_wheel_actuation actuation; /**< of the last whole command */
    double last_battery;                      /**< of the plant's ledger before the last tick, J */
    double current;                           /**< mean of the last tick, as the sensor has it, A */
    uint8_t sample_counter;
    struct jp_scan_counters scan_counters;
    unsigned scan_next;             /**< frame of the scan that goes out next */
    struct patrol_battery *battery; /**< that it lives on; NULL: one without an end */
};

/** At rest where the scene starts. Scene and robot stay in use. False without memory. */
bool patrol_body_init(struct patrol_body *body, const struct four_wheel_file *robot, const struct patrol_scene *scene,
                      uint64_t seed);

void patrol_body_free(struct patrol_body *body);

/** What the sensors of wheels and supply measure in this tick. */
void patrol_body_read(const struct patrol_body *body, struct jp_four_wheel_sensors *sensors);

/** Sends the sample of this tick, and frames of a scan. */
void patrol_body_sense(struct patrol_body *body, const struct jp_can_port *port);

/** Takes a WheelTarget of the right length; *is_whole: the drives have got new set-points. */
enum jp_e2e_result patrol_body_accept(struct patrol_body *body, const struct jp_can_frame *frame, bool *is_whole);

/** One tick of physics under the last command. */
void patrol_body_step(struct patrol_body *body);

#endif
