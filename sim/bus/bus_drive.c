#include "sim/bus/bus_drive.h"

#include "hal/linux/periodic.h"
#include "sim/bus/can_bus.h"

/** An ECU that does not answer is asked again so often. */
#define ASK_AGAIN_US 100000

void bus_drive_init(struct bus_drive *drive, const struct robot_file *robot, uint64_t seed,
                    const struct jp_can_link *link)
{
    *drive = (struct bus_drive){.link = *link, .patience = BUS_DRIVE_PATIENCE};
    plant_node_init(&drive->plant, robot, seed);
}

void bus_drive_init_skid(struct bus_drive *drive, const struct skid_steer_model *model,
                         const struct skid_ground *ground, const struct planar_pose *pose, uint64_t seed,
                         const struct jp_can_link *link)
{
    *drive = (struct bus_drive){.link = *link, .patience = BUS_DRIVE_PATIENCE};
    plant_node_init_skid(&drive->plant, model, ground, pose, seed);
}

void bus_drive_init_patrol(struct bus_drive *drive, struct patrol_body *body, const struct jp_can_link *link)
{
    *drive = (struct bus_drive){.link = *link, .patience = BUS_DRIVE_PATIENCE};
    plant_node_init_patrol(&drive->plant, body);
}

static uint32_t time_ms(const struct bus_drive *drive)
{
    return (uint32_t)((uint64_t)drive->tick * 1000U / (uint64_t)plant_node_rate(&drive->plant));
}

static void operator_hears(struct bus_drive *drive, const struct jp_can_frame *frame)
{
    if (drive->navigation != NULL) {
        jp_navigation_operator_accept(drive->navigation, frame);
    } else {
        jp_operator_accept(&drive->commander, frame);
    }
}

static void operator_speaks(struct bus_drive *drive)
{
    if (drive->navigation != NULL) {
        jp_navigation_operator_tick(drive->navigation, time_ms(drive), &drive->link.port);
    } else {
        jp_operator_tick(&drive->commander, time_ms(drive), &drive->link.port);
    }
}

static void take(struct bus_drive *drive, const struct jp_can_frame *frame)
{
    (void)plant_node_accept(&drive->plant, frame);
    if (!drive->conditions.operator_silent) {
        operator_hears(drive, frame);
    }
    ecu_view_accept(&drive->view, frame);
}

/** Of a tick before the first: the ECU is switched off, so that it begins the first one afresh. */
#define TICK_POWER_OFF UINT32_MAX

static void send_time(struct bus_drive *drive, uint32_t tick)
{
    const struct jp_can_sim_time_t signals = {.tick = tick,
                                              .power = tick != TICK_POWER_OFF,
                                              .reset = drive->conditions.ecu_reset,
                                              .bus_off = drive->conditions.ecu_bus_off,
                                              .rate = (uint16_t)plant_node_rate(&drive->plant)};
    struct jp_can_frame frame = {.id = JP_CAN_SIM_TIME_FRAME_ID, .length = JP_CAN_SIM_TIME_LENGTH};

    (void)jp_can_sim_time_pack(frame.data, &signals, sizeof frame.data);
    (void)drive->link.port.send(drive->link.port.context, &frame);
}

static bool is_answer(const struct jp_can_frame *frame, uint32_t tick)
{
    struct jp_can_sim_done_t done;

    return frame->id == JP_CAN_SIM_DONE_FRAME_ID && frame->length == JP_CAN_SIM_DONE_LENGTH &&
           jp_can_sim_done_unpack(&done, frame->data, frame->length) == 0 && done.tick == tick;
}

/** True when the answer is among the frames that have come; in a flood, among so many as an end of a bus holds. */
static bool has_come(struct bus_drive *drive, uint32_t tick)
{
    const struct jp_can_link *link = &drive->link;
    struct jp_can_frame frame;

    for (unsigned i = 0; i < CAN_BUS_QUEUE && link->receive(link->port.context, &frame); i++) {
        if (is_answer(&frame, tick)) {
            return true;
        }
        take(drive, &frame);
    }
    return false;
}

/** Frames of others must not pass for the ECU's: the clock says when it is time to ask again. What has come by then is
 * looked at, so that an ECU in this process is asked once, however busy the machine is. */
static bool await_answer(struct bus_drive *drive, uint32_t tick)
{
    const struct jp_can_link *link = &drive->link;
    const int64_t end_us = jp_monotonic_us() + ASK_AGAIN_US;

    while (!has_come(drive, tick)) {
        if (jp_monotonic_us() >= end_us || !link->wait(link->port.context, ASK_AGAIN_US)) {
            return false;
        }
    }
    return true;
}

/** Lets the ECU have the tick, and asks again while it does not answer. */
static bool give_tick(struct bus_drive *drive, uint32_t tick)
{
    for (int64_t waited = 0; waited < drive->patience * INT64_C(1000000); waited += ASK_AGAIN_US) {
        send_time(drive, tick);
        if (await_answer(drive, tick)) {
            return true;
        }
    }
    return false;
}

static void step(struct bus_drive *drive)
{
    const bool driven = drive->plant.actuation.enabled != 0U;

    drive->ticks_driven += driven;
    drive->late += driven && !drive->plant.commanded;
    plant_node_step(&drive->plant);
}

bool bus_drive_lockstep(struct bus_drive *drive)
{
    if (drive->tick == 0 && !give_tick(drive, TICK_POWER_OFF)) {
        return false;
    }
    if (!drive->conditions.operator_silent) {
        operator_speaks(drive);
    }
    if (!drive->conditions.plant_paused) {
        plant_node_sense(&drive->plant, &drive->link.port);
    }
    if (!give_tick(drive, drive->tick)) {
        return false;
    }
    if (!drive->conditions.plant_paused) {
        step(drive);
    }
    drive->tick++;
    return true;
}

void bus_drive_real_time(struct bus_drive *drive)
{
    const struct jp_can_link *link = &drive->link;
    struct jp_can_frame frame;

    while (link->receive(link->port.context, &frame)) {
        take(drive, &frame);
    }
    step(drive);
    drive->tick++;
    operator_speaks(drive);
    plant_node_sense(&drive->plant, &link->port);
}
