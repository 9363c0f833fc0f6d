#include "hal/app/ecu.h"

#include <joulepath/count.h>

#include "hal/app/telemetry.h"
#include "hal/can/jp_can.h"

/** Without a frame of another controller for so long it is gone, ms. */
#define CONFLICT_MS 500U

/** From the start until sensors on the bus must have come, s. */
#define SENSORS_START 1U

/** What was learned is reported at least so often, s⁻¹. */
#define LEARNED_RATE 1U

static void count8(uint8_t *count)
{
    *count = jp_one_more8(*count);
}

static uint32_t tick_rate(const struct jp_ecu *ecu)
{
    return ecu->internal.robot.tick_rate;
}

/* The board, as the robot's tick sees it. */

static void send(struct jp_ecu *ecu, const struct jp_can_frame *frame, bool *sent)
{
    *sent = ecu->internal.port.send(ecu->internal.port.context, frame) == JP_OK;
    if (!*sent) {
        ecu->send_errors = jp_one_more16(ecu->send_errors);
    }
}

static enum jp_status read_sample(void *context, struct jp_sensors *sensors)
{
    struct jp_ecu *ecu = context;
    const struct jp_sensors *good = ecu->internal.robot.kind->good_frame(ecu->internal.robot.self);

    return jp_sample_link_read(&ecu->internal.samples, good != NULL ? good : &ecu->internal.samples.sample, sensors);
}

/** The bridges hold their duty for as long as the samples are held, so a short silence is no failure. Those that
 * another controller drives are left to it: the bridges take a command of either. */
static bool may_command(struct jp_ecu *ecu)
{
    ecu->internal.owns_bridges = ecu->internal.owns_bridges || jp_ecu_runs(ecu);
    return ecu->internal.owns_bridges || ecu->internal.conflict_ticks == 0U;
}

static enum jp_status command(struct jp_ecu *ecu, const struct jp_can_frame *frames, unsigned count)
{
    bool are_sent = true;
    bool sent;

    for (unsigned i = 0; i < count; i++) {
        send(ecu, &frames[i], &sent);
        are_sent = are_sent && sent;
    }
    if (are_sent) {
        ecu->internal.unsent = 0;
    } else {
        ecu->internal.unsent = jp_one_more16(ecu->internal.unsent);
    }
    return ecu->internal.unsent > ecu->internal.samples.hold_ticks ? JP_ERR_HARDWARE : JP_OK;
}

static enum jp_status write_motor_command(void *context, const struct jp_actuation *actuation)
{
    struct jp_ecu *ecu = context;
    struct jp_can_frame frame;

    if (!may_command(ecu)) {
        return JP_OK;
    }
    jp_message_from_actuation(&frame, &ecu->internal.motor_counter, actuation);
    return command(ecu, &frame, 1);
}

static enum jp_status write_frames(void *context, const struct jp_can_frame *frames, unsigned count)
{
    struct jp_ecu *ecu = context;

    return may_command(ecu) ? command(ecu, frames, count) : JP_OK;
}

/* Start. */

/** After a reset in motion nobody has commanded anything yet: the robot stands and waits. */
static void resume(struct jp_ecu *ecu, const struct jp_retained_slot *record)
{
    uint32_t encoder_left;
    uint32_t encoder_right;

    ecu->resets = record->resets + 1U;
    if (record->kind != (uint32_t)ecu->internal.robot.kind->snapshots ||
        !ecu->internal.robot.kind->resume(ecu->internal.robot.self, &record->snapshot, &encoder_left, &encoder_right)) {
        return;
    }
    /* A sample holds only the low bits of the counts; they go on from those of the record. */
    jp_sample_link_resume(&ecu->internal.samples, encoder_left, encoder_right);
    ecu->internal.operator_link.mode = JP_MODE_STAND;
    ecu->internal.operator_link.state = JP_OPERATOR_LOST;
}

enum jp_status jp_ecu_init(struct jp_ecu *ecu, const struct jp_ecu_robot *robot, const struct jp_can_port *port,
                           struct jp_retained *retained)
{
    const struct jp_retained_slot *record;

    if (ecu == NULL || robot == NULL || port == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *ecu = (struct jp_ecu){.internal = {.robot = *robot, .port = *port, .retained = retained}};
    ecu->internal.hal = (struct jp_hal){.context = ecu, .read = read_sample, .write = write_motor_command};
    jp_sample_link_start(&ecu->internal.samples, robot->monitor, robot->tick_rate);
    jp_operator_link_start(&ecu->internal.operator_link, robot->tick_rate);
    jp_route_link_start(&ecu->internal.routes, robot->tick_rate);
    if (robot->kind->attach != NULL) {
        const struct jp_ecu_bus bus = {.context = ecu, .command = write_frames};

        robot->kind->attach(robot->self, &bus);
    }
    record = retained == NULL ? NULL : jp_retained_newest(retained);
    if (record != NULL) {
        resume(ecu, record);
    }
    return JP_OK;
}

void jp_ecu_use_board(struct jp_ecu *ecu, const struct jp_hal *board)
{
    ecu->internal.hal = *board;
    ecu->internal.has_board = true;
}

void jp_ecu_report_reset(struct jp_ecu *ecu, const struct jp_reset_report *report)
{
    ecu->internal.reset_report = report;
}

void jp_ecu_navigate(struct jp_ecu *ecu, struct jp_navigation *navigation)
{
    ecu->internal.navigation = navigation;
}

void jp_ecu_use_battery(struct jp_ecu *ecu, struct jp_ecu_battery *battery)
{
    ecu->internal.battery = battery;
}

const struct jp_learned_state *jp_ecu_learned_state(const struct jp_ecu *ecu)
{
    return ecu->internal.robot.kind->learned_state(ecu->internal.robot.self);
}

void jp_ecu_read_lessons(const struct jp_ecu *ecu, struct jp_ecu_lessons *lessons)
{
    ecu->internal.robot.kind->lessons(ecu->internal.robot.self, lessons);
}

enum jp_ecu_state jp_ecu_state_now(const struct jp_ecu *ecu)
{
    return ecu->internal.robot.kind->state(ecu->internal.robot.self);
}

static bool runs(enum jp_ecu_state state)
{
    return state == JP_ECU_STANDING || state == JP_ECU_DRIVING;
}

bool jp_ecu_runs(const struct jp_ecu *ecu)
{
    return runs(jp_ecu_state_now(ecu));
}

/* Frames that arrive. */

/** Every data frame of joulepath.dbc that this node receives or sends. */
static const struct {
    uint32_t id;
    uint8_t length;
    enum { SAMPLE_WHEELS, SAMPLE_BALANCE, SAMPLE_CURRENTS, OF_KIND, OPERATOR, OWN, OTHERS } kind;
} known[] = {
    {JP_CAN_MOTOR_COMMAND_FRAME_ID, JP_CAN_MOTOR_COMMAND_LENGTH, OWN},
    {JP_CAN_WHEEL_SENSORS_FRAME_ID, JP_CAN_WHEEL_SENSORS_LENGTH, SAMPLE_WHEELS},
    {JP_CAN_BALANCE_SENSORS_FRAME_ID, JP_CAN_BALANCE_SENSORS_LENGTH, SAMPLE_BALANCE},
    {JP_CAN_CURRENT_SENSORS_FRAME_ID, JP_CAN_CURRENT_SENSORS_LENGTH, SAMPLE_CURRENTS},
    {JP_CAN_WHEEL_TARGET_FRAME_ID, JP_CAN_WHEEL_TARGET_LENGTH, OWN},
    {JP_CAN_WHEEL_FEEDBACK_FRAME_ID, JP_CAN_WHEEL_FEEDBACK_LENGTH, OF_KIND},
    {JP_CAN_SUPPLY_SENSORS_FRAME_ID, JP_CAN_SUPPLY_SENSORS_LENGTH, OF_KIND},
    {JP_CAN_SCAN_BEGIN_FRAME_ID, JP_CAN_SCAN_BEGIN_LENGTH, OF_KIND},
    {JP_CAN_SCAN_RANGES_FRAME_ID, JP_CAN_SCAN_RANGES_LENGTH, OF_KIND},
    {JP_CAN_SCAN_END_FRAME_ID, JP_CAN_SCAN_END_LENGTH, OF_KIND},
    {JP_CAN_BATTERY_CHARGE_FRAME_ID, JP_CAN_BATTERY_CHARGE_LENGTH, OPERATOR},
    {JP_CAN_OPERATOR_COMMAND_FRAME_ID, JP_CAN_OPERATOR_COMMAND_LENGTH, OPERATOR},
    {JP_CAN_ROUTE_OFFER_FRAME_ID, JP_CAN_ROUTE_OFFER_LENGTH, OPERATOR},
    {JP_CAN_WAYPOINT_FRAME_ID, JP_CAN_WAYPOINT_LENGTH, OPERATOR},
    {JP_CAN_GOAL_FRAME_ID, JP_CAN_GOAL_LENGTH, OPERATOR},
    {JP_CAN_MAP_OFFER_FRAME_ID, JP_CAN_MAP_OFFER_LENGTH, OPERATOR},
    {JP_CAN_MAP_DATA_FRAME_ID, JP_CAN_MAP_DATA_LENGTH, OPERATOR},
    {JP_CAN_CELL_CHANGES_FRAME_ID, JP_CAN_CELL_CHANGES_LENGTH, OPERATOR},
    {JP_CAN_MAP_GOAL_FRAME_ID, JP_CAN_MAP_GOAL_LENGTH, OPERATOR},
    {JP_CAN_ROUND_OFFER_FRAME_ID, JP_CAN_ROUND_OFFER_LENGTH, OPERATOR},
    {JP_CAN_ROUND_DATA_FRAME_ID, JP_CAN_ROUND_DATA_LENGTH, OPERATOR},
    {JP_CAN_ECU_STATUS_FRAME_ID, JP_CAN_ECU_STATUS_LENGTH, OWN},
    {JP_CAN_ECU_ERRORS_FRAME_ID, JP_CAN_ECU_ERRORS_LENGTH, OWN},
    {JP_CAN_ECU_LOSSES_FRAME_ID, JP_CAN_ECU_LOSSES_LENGTH, OWN},
    {JP_CAN_ROUTE_STATUS_FRAME_ID, JP_CAN_ROUTE_STATUS_LENGTH, OWN},
    {JP_CAN_POSE_FRAME_ID, JP_CAN_POSE_LENGTH, OWN},
    {JP_CAN_MOTION_FRAME_ID, JP_CAN_MOTION_LENGTH, OWN},
    {JP_CAN_REFERENCE_FRAME_ID, JP_CAN_REFERENCE_LENGTH, OWN},
    {JP_CAN_MOTORS_FRAME_ID, JP_CAN_MOTORS_LENGTH, OWN},
    {JP_CAN_ENERGY_SPENT_FRAME_ID, JP_CAN_ENERGY_SPENT_LENGTH, OWN},
    {JP_CAN_ENERGY_DRAWN_FRAME_ID, JP_CAN_ENERGY_DRAWN_LENGTH, OWN},
    {JP_CAN_SEGMENT_MOTION_FRAME_ID, JP_CAN_SEGMENT_MOTION_LENGTH, OWN},
    {JP_CAN_SEGMENT_SHAPE_FRAME_ID, JP_CAN_SEGMENT_SHAPE_LENGTH, OWN},
    {JP_CAN_SEGMENT_FORECAST_FRAME_ID, JP_CAN_SEGMENT_FORECAST_LENGTH, OWN},
    {JP_CAN_SEGMENT_RESULT_FRAME_ID, JP_CAN_SEGMENT_RESULT_LENGTH, OWN},
    {JP_CAN_ENERGY_PARAMETER_FRAME_ID, JP_CAN_ENERGY_PARAMETER_LENGTH, OWN},
    {JP_CAN_RESET_REPORT_FRAME_ID, JP_CAN_RESET_REPORT_LENGTH, OWN},
    {JP_CAN_CRASH_REPORT_FRAME_ID, JP_CAN_CRASH_REPORT_LENGTH, OWN},
    {JP_CAN_BATTERY_STATUS_FRAME_ID, JP_CAN_BATTERY_STATUS_LENGTH, OTHERS},
    {JP_CAN_LEARNED_FRAME_ID, JP_CAN_LEARNED_LENGTH, OWN},
    {JP_CAN_LEARNER_STATUS_FRAME_ID, JP_CAN_LEARNER_STATUS_LENGTH, OWN},
    {JP_CAN_LEARNED_FACTORS_FRAME_ID, JP_CAN_LEARNED_FACTORS_LENGTH, OWN},
    {JP_CAN_LEARNED_DEVIATIONS_FRAME_ID, JP_CAN_LEARNED_DEVIATIONS_LENGTH, OWN},
    {JP_CAN_MAP_STATUS_FRAME_ID, JP_CAN_MAP_STATUS_LENGTH, OWN},
    {JP_CAN_NAVIGATION_STATUS_FRAME_ID, JP_CAN_NAVIGATION_STATUS_LENGTH, OWN},
    {JP_CAN_NAVIGATION_PROGRESS_FRAME_ID, JP_CAN_NAVIGATION_PROGRESS_LENGTH, OWN},
    {JP_CAN_COURSE_LEG_FRAME_ID, JP_CAN_COURSE_LEG_LENGTH, OWN},
    {JP_CAN_MAP_POSE_FRAME_ID, JP_CAN_MAP_POSE_LENGTH, OWN},
    {JP_CAN_PATROL_STATUS_FRAME_ID, JP_CAN_PATROL_STATUS_LENGTH, OWN},
    {JP_CAN_HOME_STATUS_FRAME_ID, JP_CAN_HOME_STATUS_LENGTH, OWN},
    {JP_CAN_HOME_BATTERY_FRAME_ID, JP_CAN_HOME_BATTERY_LENGTH, OWN},
    {JP_CAN_ROUND_STATUS_FRAME_ID, JP_CAN_ROUND_STATUS_LENGTH, OWN},
    {JP_CAN_ROUND_BATTERY_FRAME_ID, JP_CAN_ROUND_BATTERY_LENGTH, OWN},
};
#define KNOWN (sizeof known / sizeof known[0])

static void count_result(struct jp_ecu_counts *counts, enum jp_e2e_result result)
{
    if (result == JP_E2E_CRC) {
        count8(&counts->crc_errors);
    } else if (result == JP_E2E_REPEATED || result == JP_E2E_SEQUENCE) {
        count8(&counts->sequence_errors);
    }
}

static void note_conflict(struct jp_ecu *ecu)
{
    count8(&ecu->conflicts);
    ecu->internal.conflict_ticks = (uint16_t)(tick_rate(ecu) * CONFLICT_MS / 1000U);
}

static void enqueue(struct jp_ecu *ecu, const struct jp_can_frame *frame)
{
    const uint8_t head = ecu->internal.queue_head;
    const uint8_t next = (uint8_t)((head + 1U) % JP_ECU_QUEUE);

    if (next == __atomic_load_n(&ecu->internal.queue_tail, __ATOMIC_ACQUIRE)) {
        count8(&ecu->sample_counts.rejected);
        return;
    }
    ecu->internal.queue[head] = *frame;
    __atomic_store_n(&ecu->internal.queue_head, next, __ATOMIC_RELEASE);
}

static void take_sample_part(struct jp_ecu *ecu, enum jp_sample_part part, const struct jp_can_frame *frame)
{
    count_result(&ecu->sample_counts, jp_sample_link_accept(&ecu->internal.samples, part, frame));
}

/** Of a kind that has sensors of its own. True when a sample is complete. */
static bool take_own(struct jp_ecu *ecu, const struct jp_can_frame *frame)
{
    const struct jp_ecu_robot *robot = &ecu->internal.robot;
    bool is_sample = false;

    if (robot->kind->accept != NULL) {
        const enum jp_e2e_result result = robot->kind->accept(robot->self, frame, &is_sample);

        count_result(&ecu->sample_counts, result);
    }
    return is_sample;
}

/** True when a sample is complete. */
static bool accept_known(struct jp_ecu *ecu, size_t index, const struct jp_can_frame *frame)
{
    const bool was_fresh = ecu->internal.samples.fresh;

    if (frame->length != known[index].length) {
        count8(&ecu->sample_counts.malformed);
        return false;
    }
    switch (known[index].kind) {
    case SAMPLE_WHEELS:
        take_sample_part(ecu, JP_SAMPLE_WHEELS, frame);
        break;
    case SAMPLE_BALANCE:
        take_sample_part(ecu, JP_SAMPLE_BALANCE, frame);
        break;
    case SAMPLE_CURRENTS:
        take_sample_part(ecu, JP_SAMPLE_CURRENTS, frame);
        break;
    case OF_KIND:
        return take_own(ecu, frame);
    case OPERATOR:
        enqueue(ecu, frame);
        break;
    case OWN:
        note_conflict(ecu);
        break;
    case OTHERS:
    default:
        break;
    }
    return !was_fresh && ecu->internal.samples.fresh;
}

bool jp_ecu_accept(struct jp_ecu *ecu, const struct jp_can_frame *frame)
{
    for (size_t i = 0; i < KNOWN; i++) {
        if (known[i].id == frame->id) {
            return accept_known(ecu, i, frame);
        }
    }
    ecu->unknown_frames = jp_one_more16(ecu->unknown_frames);
    return false;
}

/* The tick. */

static void watch_bus(struct jp_ecu *ecu)
{
    const bool bus_off = ecu->internal.port.state(ecu->internal.port.context) == JP_CAN_BUS_OFF;

    if (bus_off && !ecu->internal.was_bus_off) {
        count8(&ecu->bus_offs);
    }
    ecu->internal.was_bus_off = bus_off;
    if (ecu->internal.conflict_ticks > 0U) {
        ecu->internal.conflict_ticks--;
    }
}

static void retain(struct jp_ecu *ecu)
{
    union jp_retained_snapshot snapshot;

    if (ecu->internal.retained != NULL) {
        ecu->internal.robot.kind->snapshot(ecu->internal.robot.self, &snapshot);
        jp_retained_write(ecu->internal.retained, ecu->internal.robot.kind->snapshots, &snapshot, ecu->resets);
    }
}

static void send_telemetry(struct jp_ecu *ecu)
{
    struct jp_can_frame frames[JP_TELEMETRY_FRAMES_MAX];
    const unsigned count = jp_telemetry_due(ecu, frames);
    bool sent;

    for (unsigned i = 0; i < count; i++) {
        send(ecu, &frames[i], &sent);
    }
}

static bool has_samples(const struct jp_ecu *ecu)
{
    const struct jp_ecu_robot *robot = &ecu->internal.robot;

    return ecu->internal.has_board ||
           (robot->kind->has_started != NULL ? robot->kind->has_started(robot->self) : ecu->internal.samples.started);
}

void jp_ecu_tick(struct jp_ecu *ecu)
{
    watch_bus(ecu);
    /* Before the first sample there is nothing to control, and that is no fault until it shall stand. */
    if (has_samples(ecu) || ecu->internal.lacks_samples) {
        ecu->internal.robot.kind->tick(ecu->internal.robot.self, &ecu->internal.hal, &ecu->internal.written);
        retain(ecu);
    }
    send_telemetry(ecu);
    ecu->tick++;
}

/* The background. */

static void take_operator_command(struct jp_ecu *ecu, const struct jp_can_frame *frame)
{
    switch (jp_operator_link_accept(&ecu->internal.operator_link, frame)) {
    case JP_OPERATOR_CRC:
        count8(&ecu->operator_counts.crc_errors);
        break;
    case JP_OPERATOR_SEQUENCE:
        count8(&ecu->operator_counts.sequence_errors);
        break;
    case JP_OPERATOR_MALFORMED:
        count8(&ecu->operator_counts.malformed);
        break;
    case JP_OPERATOR_OK:
    default:
        ecu->internal.told_to_stand = ecu->internal.operator_link.heard == JP_MODE_STAND;
        break;
    }
}

static bool is_of_round(const struct jp_can_frame *frame)
{
    return frame->id == JP_CAN_ROUND_OFFER_FRAME_ID || frame->id == JP_CAN_ROUND_DATA_FRAME_ID ||
           frame->id == JP_CAN_BATTERY_CHARGE_FRAME_ID;
}

/** An ECU without a navigator, or without rounds, refuses what is meant for one; what the battery holds is no command.
 */
static void take_for_navigator(struct jp_ecu *ecu, const struct jp_can_frame *frame)
{
    struct jp_navigation *navigation = ecu->internal.navigation;

    if (navigation != NULL && (!is_of_round(frame) || jp_navigation_goes_round(navigation))) {
        count_result(&ecu->operator_counts, jp_navigation_accept(navigation, frame));
    } else if (frame->id != JP_CAN_BATTERY_CHARGE_FRAME_ID) {
        count8(&ecu->operator_counts.rejected);
    } else {
        /* Nobody here asks for it. */
    }
}

static void take_command(struct jp_ecu *ecu, const struct jp_can_frame *frame)
{
    switch (frame->id) {
    case JP_CAN_OPERATOR_COMMAND_FRAME_ID:
        take_operator_command(ecu, frame);
        break;
    case JP_CAN_ROUTE_OFFER_FRAME_ID:
        count_result(&ecu->operator_counts, jp_route_link_accept_offer(&ecu->internal.routes, frame));
        break;
    case JP_CAN_WAYPOINT_FRAME_ID:
        count_result(&ecu->operator_counts, jp_route_link_accept_waypoint(&ecu->internal.routes, frame));
        break;
    case JP_CAN_GOAL_FRAME_ID:
        count_result(&ecu->operator_counts, jp_route_link_accept_goal(&ecu->internal.routes, frame));
        break;
    default:
        take_for_navigator(ecu, frame);
        break;
    }
}

static void take_commands(struct jp_ecu *ecu)
{
    for (unsigned i = 0; i < JP_ECU_QUEUE; i++) {
        const uint8_t tail = ecu->internal.queue_tail;

        if (tail == __atomic_load_n(&ecu->internal.queue_head, __ATOMIC_ACQUIRE)) {
            return;
        }
        take_command(ecu, &ecu->internal.queue[tail]);
        __atomic_store_n(&ecu->internal.queue_tail, (uint8_t)((tail + 1U) % JP_ECU_QUEUE), __ATOMIC_RELEASE);
    }
}

static void pass_time(struct jp_ecu *ecu)
{
    const uint32_t now = __atomic_load_n(&ecu->tick, __ATOMIC_RELAXED);

    if (jp_operator_link_pass(&ecu->internal.operator_link, now - ecu->internal.worked_tick)) {
        count8(&ecu->operator_timeouts);
    }
    jp_route_link_pass(&ecu->internal.routes, now - ecu->internal.worked_tick);
    ecu->internal.worked_tick = now;
}

static bool is_navigating(const struct jp_ecu *ecu)
{
    return ecu->internal.navigation != NULL && jp_navigation_is_under_way(ecu->internal.navigation);
}

static void end_navigation(struct jp_ecu *ecu)
{
    if (ecu->internal.navigation != NULL) {
        jp_navigation_stop(ecu->internal.navigation);
    }
}

static void end_route(struct jp_ecu *ecu, enum jp_route_reason reason)
{
    ecu->internal.robot.kind->stop(ecu->internal.robot.self);
    ecu->internal.has_route = false;
    jp_route_link_end(&ecu->internal.routes, JP_ROUTE_STOPPED, reason);
}

static void stop(struct jp_ecu *ecu)
{
    const bool lost = ecu->internal.operator_link.state == JP_OPERATOR_LOST;

    end_navigation(ecu);
    end_route(ecu, lost ? JP_REASON_TIMEOUT : JP_REASON_COMMAND);
}

static void switch_off(struct jp_ecu *ecu)
{
    end_navigation(ecu);
    end_route(ecu, JP_REASON_SWITCHED_OFF);
    ecu->internal.robot.kind->disable(ecu->internal.robot.self);
}

/** Motors on, or why not. */
static enum jp_refusal stand_up(struct jp_ecu *ecu, enum jp_ecu_state state)
{
    if (state == JP_ECU_FALLEN) {
        return JP_REFUSAL_FALLEN;
    }
    if (state == JP_ECU_FAULT) {
        return JP_REFUSAL_FAULT;
    }
    if (ecu->internal.conflict_ticks > 0U) {
        return JP_REFUSAL_CONFLICT;
    }
    return ecu->internal.robot.kind->enable(ecu->internal.robot.self);
}

/** Each command is refused anew. */
static void try_to_stand_up(struct jp_ecu *ecu, enum jp_ecu_state state)
{
    const enum jp_refusal refusal = stand_up(ecu, state);

    ecu->internal.lacks_samples = ecu->internal.worked_tick >= SENSORS_START * tick_rate(ecu);

    ecu->internal.refusal = (uint8_t)refusal;
    if (refusal != JP_REFUSAL_NONE && ecu->internal.told_to_stand) {
        count8(&ecu->operator_counts.rejected);
    }
}

static void stand(struct jp_ecu *ecu, enum jp_ecu_state state)
{
    jp_route_link_forget_goal(&ecu->internal.routes);
    if (state == JP_ECU_DRIVING || ecu->internal.has_route || is_navigating(ecu)) {
        stop(ecu);
    } else if (state != JP_ECU_STANDING && ecu->internal.operator_link.state == JP_OPERATOR_ALIVE) {
        try_to_stand_up(ecu, state);
    }
}

static void drive(struct jp_ecu *ecu, enum jp_ecu_state state)
{
    const struct jp_route_message *route;

    if (!runs(state)) {
        return;
    }
    end_navigation(ecu);
    route = jp_route_link_take(&ecu->internal.routes, ecu->internal.operator_link.route);
    if (route != NULL) {
        ecu->internal.robot.kind->set_out(ecu->internal.robot.self, false);
        ecu->internal.has_route =
            ecu->internal.robot.kind->follow(ecu->internal.robot.self, route->points, route->length) == JP_OK;
        if (!ecu->internal.has_route) {
            jp_route_link_end(&ecu->internal.routes, JP_ROUTE_STOPPED, JP_REASON_PLAN);
        }
    }
}

static void navigate(struct jp_ecu *ecu, enum jp_ecu_state state)
{
    if (!runs(state)) {
        return;
    }
    if (ecu->internal.has_route) {
        end_route(ecu, JP_REASON_COMMAND);
    }
    if (ecu->internal.navigation != NULL &&
        jp_navigation_drive(ecu->internal.navigation, ecu->internal.operator_link.route)) {
        ecu->internal.robot.kind->set_out(ecu->internal.robot.self, true);
    }
}

static void obey(struct jp_ecu *ecu, enum jp_ecu_state state)
{
    switch (ecu->internal.operator_link.mode) {
    case JP_MODE_STAND:
        stand(ecu, state);
        break;
    case JP_MODE_DRIVE:
        drive(ecu, state);
        break;
    case JP_MODE_NAVIGATE:
        navigate(ecu, state);
        break;
    case JP_MODE_OFF:
    default:
        /* Also while the robot is idle: the next tick may be about to switch the motors on. */
        if (ecu->internal.operator_link.state != JP_OPERATOR_NONE) {
            switch_off(ecu);
        }
        break;
    }
}

static enum jp_status plan_of(const struct jp_ecu *ecu)
{
    struct jp_ecu_progress progress;

    ecu->internal.robot.kind->progress(ecu->internal.robot.self, &progress);
    return progress.plan;
}

/** Notices that the route has ended. */
static void watch_route(struct jp_ecu *ecu)
{
    if (!jp_ecu_runs(ecu)) {
        ecu->internal.has_route = false;
        jp_route_link_end(&ecu->internal.routes, JP_ROUTE_STOPPED, JP_REASON_SWITCHED_OFF);
    } else if (ecu->internal.has_route && ecu->internal.robot.kind->is_resting(ecu->internal.robot.self)) {
        const bool is_done = plan_of(ecu) == JP_OK;

        ecu->internal.has_route = false;
        jp_route_link_end(&ecu->internal.routes, is_done ? JP_ROUTE_DONE : JP_ROUTE_STOPPED,
                          is_done ? JP_REASON_NONE : JP_REASON_PLAN);
    }
}

/** A slice of what drives the robot. */
static void work(struct jp_ecu *ecu)
{
    struct jp_navigation *navigation = ecu->internal.navigation;

    if (navigation == NULL || !jp_navigation_work(navigation, ecu->internal.worked_tick, tick_rate(ecu))) {
        ecu->internal.robot.kind->work(ecu->internal.robot.self);
    }
}

static bool was_sent(const struct jp_ecu_report *report)
{
    return __atomic_load_n(&report->left, __ATOMIC_ACQUIRE) == 0U;
}

static void hand_over(struct jp_ecu_report *report, unsigned frames)
{
    __atomic_store_n(&report->left, (uint8_t)frames, __ATOMIC_RELEASE);
}

/** Drives on, and announces each segment that was planned. */
static void pilot(struct jp_ecu *ecu)
{
    const uint16_t planned = ecu->internal.robot.kind->segments_planned(ecu->internal.robot.self);
    const uint16_t begun = ecu->internal.robot.kind->segments_begun(ecu->internal.robot.self);
    struct jp_ecu_segment segment;

    if (!was_sent(&ecu->internal.plan)) {
        return;
    }
    work(ecu);
    ecu->internal.robot.kind->note(ecu->internal.robot.self);
    if (ecu->internal.robot.kind->segments_planned(ecu->internal.robot.self) > planned) {
        ecu->internal.robot.kind->segment(ecu->internal.robot.self, begun, &segment);
        hand_over(&ecu->internal.plan, jp_telemetry_segment(&segment, ecu->internal.plan.frames));
    }
}

static void report_learned(struct jp_ecu *ecu, const struct jp_ecu_lessons *lessons)
{
    struct jp_ecu_report *report = &ecu->internal.learned;
    struct jp_can_frame own[JP_ECU_LEARNED_FRAMES];
    const unsigned count = ecu->internal.robot.kind->tell_learned(ecu->internal.robot.self, own);

    jp_telemetry_lessons(lessons, &report->frames[0]);
    for (unsigned i = 0; i < count; i++) {
        report->frames[count - i] = own[i];
    }
    hand_over(report, count + 1U);
}

/** Reports what was learned when a segment has ended, and at LEARNED_RATE. */
static void tell_learned(struct jp_ecu *ecu)
{
    struct jp_ecu_lessons lessons;

    jp_ecu_read_lessons(ecu, &lessons);

    const uint32_t segments = lessons.learned_from + lessons.left_out;

    if (segments == ecu->internal.segments_told &&
        ecu->internal.worked_tick - ecu->internal.told_tick < tick_rate(ecu) / LEARNED_RATE) {
        return;
    }
    if (was_sent(&ecu->internal.learned)) {
        report_learned(ecu, &lessons);
        ecu->internal.segments_told = segments;
        ecu->internal.told_tick = ecu->internal.worked_tick;
    }
}

static void follow_battery(struct jp_ecu *ecu)
{
    const struct jp_ecu_robot *robot = &ecu->internal.robot;
    struct jp_ecu_supply supply;

    if (ecu->internal.battery != NULL && robot->kind->supply != NULL && robot->kind->supply(robot->self, &supply)) {
        if (jp_ecu_battery_pass(ecu->internal.battery, &supply, ecu->internal.worked_tick, tick_rate(ecu))) {
            robot->kind->lack(robot->self, jp_ecu_battery_lacks(ecu->internal.battery, &supply));
        }
    }
}

void jp_ecu_work(struct jp_ecu *ecu)
{
    ecu->internal.told_to_stand = false;
    take_commands(ecu);
    pass_time(ecu);
    follow_battery(ecu);
    obey(ecu, jp_ecu_state_now(ecu));
    pilot(ecu);
    watch_route(ecu);
    if (jp_ecu_learned_state(ecu) != NULL) {
        tell_learned(ecu);
    }
}
