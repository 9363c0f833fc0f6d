#include "hal/app/telemetry.h"

#include "hal/app/signals.h"
#include "hal/can/jp_can.h"

/** Of a tick, as jp_ecu_internal.schedule_wait counts. */
#define THOUSANDTHS 1000U

/** A function that fills in one message from the application's state. */
typedef void fill_function(const struct jp_ecu *ecu, struct jp_can_frame *frame);

static void tell_motion(const struct jp_ecu *ecu, struct jp_ecu_motion *motion)
{
    ecu->internal.robot.kind->motion(ecu->internal.robot.self, motion);
}

static void tell_progress(const struct jp_ecu *ecu, struct jp_ecu_progress *progress)
{
    ecu->internal.robot.kind->progress(ecu->internal.robot.self, progress);
}

static void status(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_can_ecu_status_t signals = {
        .state = (uint8_t)ecu->internal.robot.kind->state(ecu->internal.robot.self),
        .mode = (uint8_t)ecu->internal.operator_link.mode,
        .operator_state = (uint8_t)ecu->internal.operator_link.state,
        .resets = jp_signal_count8(ecu->resets),
        .version_major = JP_VERSION_MAJOR,
        .version_minor = JP_VERSION_MINOR,
        .version_patch = JP_VERSION_PATCH,
        .uptime = (ecu->tick / ecu->internal.robot.tick_rate) & 0xFFFFFFU,
    };

    frame->id = JP_CAN_ECU_STATUS_FRAME_ID;
    (void)jp_can_ecu_status_pack(frame->data, &signals, sizeof frame->data);
}

static void errors(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_ecu_counts *a = &ecu->sample_counts;
    const struct jp_ecu_counts *b = &ecu->operator_counts;
    struct jp_ecu_progress progress;

    tell_progress(ecu, &progress);

    const struct jp_can_ecu_errors_t signals = {
        .faults = progress.faults,
        .crc_errors = jp_signal_count8((uint32_t)a->crc_errors + b->crc_errors),
        .sequence_errors = jp_signal_count8((uint32_t)a->sequence_errors + b->sequence_errors),
        .operator_timeouts = ecu->operator_timeouts,
        .bus_offs = ecu->bus_offs,
        .conflicts = ecu->conflicts,
        .malformed = jp_signal_count8((uint32_t)a->malformed + b->malformed),
    };

    frame->id = JP_CAN_ECU_ERRORS_FRAME_ID;
    (void)jp_can_ecu_errors_pack(frame->data, &signals, sizeof frame->data);
}

static void losses(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_can_ecu_losses_t signals = {
        .lost_samples = jp_ecu_lost_samples(ecu),
        .unknown_frames = ecu->unknown_frames,
        .rejected = jp_signal_count8((uint32_t)ecu->sample_counts.rejected + ecu->operator_counts.rejected),
        .send_errors = ecu->send_errors,
        .stand_refusal = ecu->internal.refusal,
    };

    frame->id = JP_CAN_ECU_LOSSES_FRAME_ID;
    (void)jp_can_ecu_losses_pack(frame->data, &signals, sizeof frame->data);
}

static void route_status(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_route_link *routes = &ecu->internal.routes;
    const bool offered =
        routes->state == JP_ROUTE_RECEIVING || routes->state == JP_ROUTE_READY || routes->state == JP_ROUTE_REJECTED;
    struct jp_ecu_progress progress;

    tell_progress(ecu, &progress);

    const struct jp_can_route_status_t signals = {
        .route_id = offered ? routes->offered.id : routes->driven.id,
        .state = (uint8_t)routes->state,
        .reason = (uint8_t)routes->reason,
        .received = routes->received,
        .length = offered ? routes->offered.length : routes->driven.length,
        .segment = jp_signal_count8(progress.segment),
        .segments_ended = jp_signal_count8(progress.segments_ended),
        .plan_status = (int8_t)progress.plan,
    };

    frame->id = JP_CAN_ROUTE_STATUS_FRAME_ID;
    (void)jp_can_route_status_pack(frame->data, &signals, sizeof frame->data);
}

static void pose(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const int32_t limit = (int32_t)1 << 25;
    struct jp_ecu_motion told;

    tell_motion(ecu, &told);

    const struct jp_can_pose_t signals = {
        .x = jp_clamp32(told.position.x, -limit, limit - 1),
        .y = jp_clamp32(told.position.y, -limit, limit - 1),
        .heading = jp_signal_phase(told.heading, 12),
    };

    frame->id = JP_CAN_POSE_FRAME_ID;
    (void)jp_can_pose_pack(frame->data, &signals, sizeof frame->data);
}

static void motion(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    struct jp_ecu_motion told;

    tell_motion(ecu, &told);

    const struct jp_can_motion_t signals = {
        .speed = jp_signal16(told.speed, JP_RATE_SHIFT),
        .yaw_rate = jp_signal16(told.turn_rate, JP_RATE_SHIFT),
        .pitch = jp_signal16(told.pitch, JP_ANGLE_SHIFT),
        .pitch_rate = jp_signal16(told.pitch_rate, JP_RATE_SHIFT),
    };

    frame->id = JP_CAN_MOTION_FRAME_ID;
    (void)jp_can_motion_pack(frame->data, &signals, sizeof frame->data);
}

static void reference(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    struct jp_ecu_motion told;

    tell_motion(ecu, &told);

    const uint64_t left = ((uint64_t)told.segment_ticks_left << 6) / ecu->internal.robot.tick_rate;
    const struct jp_can_reference_t signals = {
        .speed = jp_signal16(told.reference_speed, JP_RATE_SHIFT),
        .yaw_rate = jp_signal16(told.reference_turn_rate, JP_RATE_SHIFT),
        .heading = jp_signal_phase(told.reference_heading, 16),
        .segment_time_left = (uint16_t)(left > UINT16_MAX ? UINT16_MAX : left),
    };

    frame->id = JP_CAN_REFERENCE_FRAME_ID;
    (void)jp_can_reference_pack(frame->data, &signals, sizeof frame->data);
}

static void motors(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    struct jp_ecu_motion told;

    tell_motion(ecu, &told);

    const struct jp_can_motors_t signals = {
        .voltage_left = jp_signal16(told.voltages.left, JP_VOLTAGE_SHIFT),
        .voltage_right = jp_signal16(told.voltages.right, JP_VOLTAGE_SHIFT),
        .saturated_ticks = told.saturated_ticks,
    };

    frame->id = JP_CAN_MOTORS_FRAME_ID;
    (void)jp_can_motors_pack(frame->data, &signals, sizeof frame->data);
}

static void energy_spent(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    jp_energy spent;
    jp_energy drawn;

    ecu->internal.robot.kind->energies(ecu->internal.robot.self, &spent, &drawn);

    const struct jp_can_energy_spent_t signals = {.energy = spent};

    frame->id = JP_CAN_ENERGY_SPENT_FRAME_ID;
    (void)jp_can_energy_spent_pack(frame->data, &signals, sizeof frame->data);
}

static void energy_drawn(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    jp_energy spent;
    jp_energy drawn;

    ecu->internal.robot.kind->energies(ecu->internal.robot.self, &spent, &drawn);

    const struct jp_can_energy_drawn_t signals = {.energy = drawn};

    frame->id = JP_CAN_ENERGY_DRAWN_FRAME_ID;
    (void)jp_can_energy_drawn_pack(frame->data, &signals, sizeof frame->data);
}

static void energy_parameter(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_ecu_robot *robot = &ecu->internal.robot;
    const struct jp_can_energy_parameter_t signals = {.index = ecu->internal.parameter,
                                                      .count = robot->kind->parameters,
                                                      .value =
                                                          robot->kind->parameter(robot->self, ecu->internal.parameter)};

    frame->id = JP_CAN_ENERGY_PARAMETER_FRAME_ID;
    (void)jp_can_energy_parameter_pack(frame->data, &signals, sizeof frame->data);
}

static void reset_report(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_reset_report *report = ecu->internal.reset_report;
    const struct jp_can_reset_report_t signals = {
        .cause = (uint8_t)report->cause,
        .crashes = jp_signal_count8(report->crashes),
        .exception = (uint16_t)report->crash.exception,
        .tick = report->crash.tick,
    };

    frame->id = JP_CAN_RESET_REPORT_FRAME_ID;
    (void)jp_can_reset_report_pack(frame->data, &signals, sizeof frame->data);
}

static void crash_report(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_crash *crash = &ecu->internal.reset_report->crash;
    const struct jp_can_crash_report_t signals = {.program_counter = crash->pc, .fault_status = crash->status};

    frame->id = JP_CAN_CRASH_REPORT_FRAME_ID;
    (void)jp_can_crash_report_pack(frame->data, &signals, sizeof frame->data);
}

/** Of a kind's own; without a length there is nothing to tell. */
static void own(const struct jp_ecu *ecu, uint8_t index, struct jp_can_frame *frame)
{
    const struct jp_ecu_robot *robot = &ecu->internal.robot;

    if (robot->kind->tell_own == NULL || !robot->kind->tell_own(robot->self, index, frame)) {
        frame->length = 0;
    }
}

static void own_first(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    own(ecu, 0, frame);
}

static void own_second(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    own(ecu, 1, frame);
}

#define SCHEDULE_MS JP_ECU_OWN_MS

/** When each cyclic message is sent, ms; no two in the same millisecond. Periods divide SCHEDULE_MS. */
static const struct cyclic {
    fill_function *fill;
    uint8_t period;
    uint8_t phase;
    bool of_reset; /**< sent where the reset is known */
} schedule[] = {
    {pose, 20, 1, false},
    {motion, 20, 5, false},
    {reference, 20, 9, false},
    {motors, 20, 13, false},
    {energy_spent, 20, 17, false},
    {status, 100, 3, false},
    {errors, 100, 23, false},
    {losses, 100, 43, false},
    {route_status, 100, 63, false},
    {energy_drawn, 100, 83, false},
    {energy_parameter, 100, 7, false},
    {reset_report, 100, 27, true},
    {crash_report, 100, 47, true},
    {own_first, SCHEDULE_MS, 67, false},
    {own_second, SCHEDULE_MS, 87, false},
};

static bool is_due(const struct jp_ecu *ecu, const struct cyclic *cyclic)
{
    return ecu->internal.schedule_ms % cyclic->period == cyclic->phase &&
           (!cyclic->of_reset || ecu->internal.reset_report != NULL);
}

static void blank(struct jp_can_frame *frame)
{
    *frame = (struct jp_can_frame){.length = JP_CAN_LENGTH_MAX};
}

/** The message of one millisecond, if it has one. */
static bool take_millisecond(struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    for (unsigned i = 0; i < sizeof schedule / sizeof schedule[0]; i++) {
        if (is_due(ecu, &schedule[i])) {
            blank(frame);
            schedule[i].fill(ecu, frame);
            if (schedule[i].fill == energy_parameter) {
                ecu->internal.parameter =
                    (uint8_t)((ecu->internal.parameter + 1U) % ecu->internal.robot.kind->parameters);
            }
            return frame->length > 0U;
        }
    }
    return false;
}

/** The messages of the milliseconds that begin in this tick, whatever the tick rate. */
static unsigned take_scheduled(struct jp_ecu *ecu, struct jp_can_frame *frames)
{
    unsigned count = 0;

    while (ecu->internal.schedule_wait < THOUSANDTHS) {
        if (take_millisecond(ecu, &frames[count])) {
            count++;
        }
        ecu->internal.schedule_ms = (uint8_t)((ecu->internal.schedule_ms + 1U) % SCHEDULE_MS);
        /* A millisecond is tick_rate / 1000 ticks. */
        ecu->internal.schedule_wait += ecu->internal.robot.tick_rate;
    }
    ecu->internal.schedule_wait -= THOUSANDTHS;
    return count;
}

/* What is sent once, when it happens. */

static void segment_motion(const struct jp_ecu_segment *segment, struct jp_can_frame *frame)
{
    const int32_t limit = (int32_t)1 << 27;
    const struct jp_can_segment_motion_t signals = {
        .segment = jp_signal_count8(segment->number),
        .speed = jp_clamp32(segment->speed, -limit, limit - 1),
        .turn_rate = jp_clamp32(jp_q16_divide(segment->turn, segment->duration), -limit, limit - 1),
    };

    blank(frame);
    frame->id = JP_CAN_SEGMENT_MOTION_FRAME_ID;
    (void)jp_can_segment_motion_pack(frame->data, &signals, sizeof frame->data);
}

static void segment_shape(const struct jp_ecu_segment *segment, struct jp_can_frame *frame)
{
    const struct jp_can_segment_shape_t signals = {
        .segment = jp_signal_count8(segment->number),
        .turn = segment->turn,
        .duration = (uint32_t)jp_clamp32(segment->duration, 0, (1 << 28) - 1),
    };

    blank(frame);
    frame->id = JP_CAN_SEGMENT_SHAPE_FRAME_ID;
    (void)jp_can_segment_shape_pack(frame->data, &signals, sizeof frame->data);
}

static void segment_forecast(const struct jp_ecu_segment *segment, struct jp_can_frame *frame)
{
    const struct jp_can_segment_forecast_t signals = {.segment = jp_signal_count8(segment->number),
                                                      .energy = jp_energy_to_q16(segment->forecast, 0)};

    blank(frame);
    frame->id = JP_CAN_SEGMENT_FORECAST_FRAME_ID;
    (void)jp_can_segment_forecast_pack(frame->data, &signals, sizeof frame->data);
}

unsigned jp_telemetry_segment(const struct jp_ecu_segment *segment, struct jp_can_frame frames[JP_ECU_REPORT_FRAMES])
{
    segment_forecast(segment, &frames[0]);
    segment_shape(segment, &frames[1]);
    segment_motion(segment, &frames[2]);
    return JP_ECU_REPORT_FRAMES;
}

void jp_telemetry_lessons(const struct jp_ecu_lessons *lessons, struct jp_can_frame *frame)
{
    const struct jp_can_learner_status_t signals = {
        .version = (uint16_t)(lessons->version > UINT16_MAX ? UINT16_MAX : lessons->version),
        .changes = jp_signal_count8(lessons->changes),
        .outliers = jp_signal_count8(lessons->outliers),
        .left_out = jp_signal_count8(lessons->left_out),
        .cause = (uint8_t)lessons->cause,
        .evidence = (uint8_t)lessons->evidence,
        .stored = (uint8_t)lessons->stored,
    };

    blank(frame);
    frame->id = JP_CAN_LEARNER_STATUS_FRAME_ID;
    (void)jp_can_learner_status_pack(frame->data, &signals, sizeof frame->data);
}

static bool take_report(struct jp_ecu_report *report, struct jp_can_frame *frame)
{
    const uint8_t left = __atomic_load_n(&report->left, __ATOMIC_ACQUIRE);

    if (left == 0U) {
        return false;
    }
    *frame = report->frames[left - 1U];
    __atomic_store_n(&report->left, (uint8_t)(left - 1U), __ATOMIC_RELEASE);
    return true;
}

static bool take_navigation(struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    return ecu->internal.navigation != NULL && jp_navigation_take_frame(ecu->internal.navigation, frame);
}

static bool take_result(struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const int32_t limit = (int32_t)1 << 27;
    struct jp_ecu_result result;

    if (!ecu->internal.robot.kind->take_result(ecu->internal.robot.self, &result)) {
        return false;
    }

    const struct jp_can_segment_result_t signals = {
        .segment = jp_signal_count8(result.segment),
        .spent = (uint32_t)jp_clamp32(jp_energy_to_q16(result.spent, JP_SEGMENT_RESULT_EXPONENT), 0, 2 * limit - 1),
        .drawn = jp_clamp32(jp_energy_to_q16(result.drawn, JP_SEGMENT_RESULT_EXPONENT), -limit, limit - 1),
    };

    blank(frame);
    frame->id = JP_CAN_SEGMENT_RESULT_FRAME_ID;
    (void)jp_can_segment_result_pack(frame->data, &signals, sizeof frame->data);
    return true;
}

unsigned jp_telemetry_due(struct jp_ecu *ecu, struct jp_can_frame frames[JP_TELEMETRY_FRAMES_MAX])
{
    unsigned count = take_scheduled(ecu, frames);

    count += take_report(&ecu->internal.plan, &frames[count]) || take_report(&ecu->internal.learned, &frames[count]) ||
                     take_navigation(ecu, &frames[count])
                 ? 1U
                 : 0U;
    count += take_result(ecu, &frames[count]) ? 1U : 0U;
    return count;
}
