#include "hal/app/telemetry.h"

#include "hal/can/jp_can.h"

/* Fraction bits that a signal leaves out. */
#define RATE_SHIFT    12U /* Q24 to Q12 */
#define ANGLE_SHIFT   8U  /* Q24 to Q16 */
#define VOLTAGE_SHIFT 9U  /* Q16 to Q7 */
#define FACTOR_SHIFT  4U  /* Q16 to Q12 */
#define MASS_SHIFT    9U  /* Q16 to Q7 */

/** Of a tick, as jp_ecu_internal.schedule_wait counts. */
#define THOUSANDTHS 1000U

/** Parameters of struct jp_energy_model: a1…a13, b1, b2 and five more. */
#define PARAMETERS (JP_ENERGY_TERMS + 7U)

/** A function that fills in one message from the application's state. */
typedef void fill_function(const struct jp_ecu *ecu, struct jp_can_frame *frame);

static int16_t signal16(int32_t value, unsigned shift)
{
    return (int16_t)jp_saturate_bits(jp_round_shift(value, shift), 16);
}

/** Of a value that is at least 0. */
static uint16_t signal16u(int32_t value, unsigned shift)
{
    return (uint16_t)jp_clamp32(jp_round_shift(value, shift), 0, UINT16_MAX);
}

static uint8_t count8(uint32_t value)
{
    return (uint8_t)(value > UINT8_MAX ? UINT8_MAX : value);
}

/** Low bits of a phase in 2⁻⁵⁶ turn, rounded down: an angle within ±½ turn. */
static int16_t phase_signal(jp_phase phase, unsigned bits)
{
    const uint32_t angle = jp_phase_angle(phase);

    return (int16_t)((int32_t)angle >> (32U - bits));
}

static void status(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_can_ecu_status_t signals = {
        .state = (uint8_t)jp_robot_state_now(&ecu->robot),
        .mode = (uint8_t)ecu->internal.operator_link.mode,
        .operator_state = (uint8_t)ecu->internal.operator_link.state,
        .resets = count8(ecu->resets),
        .version_major = JP_VERSION_MAJOR,
        .version_minor = JP_VERSION_MINOR,
        .version_patch = JP_VERSION_PATCH,
        .uptime = (ecu->tick / jp_robot_configuration(&ecu->robot)->estimator.tick_rate) & 0xFFFFFFU,
    };

    frame->id = JP_CAN_ECU_STATUS_FRAME_ID;
    (void)jp_can_ecu_status_pack(frame->data, &signals, sizeof frame->data);
}

static void errors(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_ecu_counts *a = &ecu->sample_counts;
    const struct jp_ecu_counts *b = &ecu->operator_counts;
    const struct jp_can_ecu_errors_t signals = {
        .faults = jp_robot_last_tick(&ecu->robot)->faults,
        .crc_errors = count8((uint32_t)a->crc_errors + b->crc_errors),
        .sequence_errors = count8((uint32_t)a->sequence_errors + b->sequence_errors),
        .operator_timeouts = ecu->operator_timeouts,
        .bus_offs = ecu->bus_offs,
        .conflicts = ecu->conflicts,
        .malformed = count8((uint32_t)a->malformed + b->malformed),
    };

    frame->id = JP_CAN_ECU_ERRORS_FRAME_ID;
    (void)jp_can_ecu_errors_pack(frame->data, &signals, sizeof frame->data);
}

static void losses(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_can_ecu_losses_t signals = {
        .lost_samples = ecu->internal.samples.lost,
        .unknown_frames = ecu->unknown_frames,
        .rejected = count8((uint32_t)ecu->sample_counts.rejected + ecu->operator_counts.rejected),
        .send_errors = ecu->send_errors,
        .stand_refusal = ecu->internal.refusal,
    };

    frame->id = JP_CAN_ECU_LOSSES_FRAME_ID;
    (void)jp_can_ecu_losses_pack(frame->data, &signals, sizeof frame->data);
}

static void route_status(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_route_link *routes = &ecu->internal.routes;
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&ecu->robot);
    const bool offered =
        routes->state == JP_ROUTE_RECEIVING || routes->state == JP_ROUTE_READY || routes->state == JP_ROUTE_REJECTED;
    const struct jp_can_route_status_t signals = {
        .route_id = offered ? routes->offered.id : routes->driven.id,
        .state = (uint8_t)routes->state,
        .reason = (uint8_t)routes->reason,
        .received = routes->received,
        .length = offered ? routes->offered.length : routes->driven.length,
        .segment = count8(telemetry->segment),
        .segments_ended = count8(telemetry->segments_ended),
        .plan_status = (int8_t)ecu->pilot.status,
    };

    frame->id = JP_CAN_ROUTE_STATUS_FRAME_ID;
    (void)jp_can_route_status_pack(frame->data, &signals, sizeof frame->data);
}

static void pose(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_point position = jp_robot_position(&ecu->robot);
    const int32_t limit = (int32_t)1 << 25;
    const struct jp_can_pose_t signals = {
        .x = jp_clamp32(position.x, -limit, limit - 1),
        .y = jp_clamp32(position.y, -limit, limit - 1),
        .heading = phase_signal(jp_robot_last_tick(&ecu->robot)->motion.yaw, 12),
    };

    frame->id = JP_CAN_POSE_FRAME_ID;
    (void)jp_can_pose_pack(frame->data, &signals, sizeof frame->data);
}

/** Wheel rate in turn/s to speed in m/s, both Q24. */
static jp_q24 speed_of(const struct jp_ecu *ecu, jp_q24 wheel_rate)
{
    return jp_q24_multiply(wheel_rate, jp_robot_configuration(&ecu->robot)->metres_per_turn);
}

static void motion(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_motion_state *state = &jp_robot_last_tick(&ecu->robot)->motion;
    const struct jp_can_motion_t signals = {
        .speed = signal16(speed_of(ecu, state->wheel_rate), RATE_SHIFT),
        .yaw_rate = signal16(state->yaw_rate, RATE_SHIFT),
        .pitch = signal16(state->pitch, ANGLE_SHIFT),
        .pitch_rate = signal16(state->pitch_rate, RATE_SHIFT),
    };

    frame->id = JP_CAN_MOTION_FRAME_ID;
    (void)jp_can_motion_pack(frame->data, &signals, sizeof frame->data);
}

static void reference(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&ecu->robot);
    const struct jp_reference *shaped = jp_robot_reference(&ecu->robot);
    const uint64_t left =
        ((uint64_t)telemetry->segment_ticks_left << 6) / jp_robot_configuration(&ecu->robot)->estimator.tick_rate;
    const struct jp_can_reference_t signals = {
        .speed = signal16(speed_of(ecu, shaped->wheel.rate), RATE_SHIFT),
        .yaw_rate = signal16(shaped->yaw.rate, RATE_SHIFT),
        .heading = phase_signal(shaped->yaw.angle, 16),
        .segment_time_left = (uint16_t)(left > UINT16_MAX ? UINT16_MAX : left),
    };

    frame->id = JP_CAN_REFERENCE_FRAME_ID;
    (void)jp_can_reference_pack(frame->data, &signals, sizeof frame->data);
}

static void motors(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&ecu->robot);
    const struct jp_can_motors_t signals = {
        .voltage_left = signal16(telemetry->voltages.left, VOLTAGE_SHIFT),
        .voltage_right = signal16(telemetry->voltages.right, VOLTAGE_SHIFT),
        .saturated_ticks = telemetry->saturated_ticks,
    };

    frame->id = JP_CAN_MOTORS_FRAME_ID;
    (void)jp_can_motors_pack(frame->data, &signals, sizeof frame->data);
}

static void energy_spent(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_can_energy_spent_t signals = {.energy = jp_robot_meter(&ecu->robot)->model};

    frame->id = JP_CAN_ENERGY_SPENT_FRAME_ID;
    (void)jp_can_energy_spent_pack(frame->data, &signals, sizeof frame->data);
}

static void energy_drawn(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_can_energy_drawn_t signals = {.energy = jp_robot_meter(&ecu->robot)->battery};

    frame->id = JP_CAN_ENERGY_DRAWN_FRAME_ID;
    (void)jp_can_energy_drawn_pack(frame->data, &signals, sizeof frame->data);
}

/** As the model holds it, in its unit of energy, which the robot's built-in tables tell: so no digit is lost. */
static jp_q16 parameter(const struct jp_energy_model *model, uint8_t index)
{
    const jp_q16 rest[PARAMETERS - JP_ENERGY_TERMS] = {
        model->b[0],
        model->b[1],
        model->electronics_power,
        model->settling_time,
        model->voltage_per_speed,
        model->voltage_per_turn_rate,
        model->motor_resistance,
    };

    return index < JP_ENERGY_TERMS ? model->a[index] : rest[index - JP_ENERGY_TERMS];
}

static void energy_parameter(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_energy_model *model = __atomic_load_n(&ecu->internal.model, __ATOMIC_ACQUIRE);
    const struct jp_can_energy_parameter_t signals = {
        .index = ecu->internal.parameter, .count = PARAMETERS, .value = parameter(model, ecu->internal.parameter)};

    frame->id = JP_CAN_ENERGY_PARAMETER_FRAME_ID;
    (void)jp_can_energy_parameter_pack(frame->data, &signals, sizeof frame->data);
}

static void reset_report(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_reset_report *report = ecu->internal.reset_report;
    const struct jp_can_reset_report_t signals = {
        .cause = (uint8_t)report->cause,
        .crashes = count8(report->crashes),
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

#define SCHEDULE_MS 100U

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
                ecu->internal.parameter = (uint8_t)((ecu->internal.parameter + 1U) % PARAMETERS);
            }
            return true;
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
        ecu->internal.schedule_wait += jp_robot_configuration(&ecu->robot)->estimator.tick_rate;
    }
    ecu->internal.schedule_wait -= THOUSANDTHS;
    return count;
}

/* What is sent once, when it happens. */

static void segment_motion(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const int32_t limit = (int32_t)1 << 27;
    const struct jp_can_segment_motion_t signals = {
        .segment = ecu->internal.plan.segment,
        .speed = jp_clamp32(ecu->pilot.leg.speed, -limit, limit - 1),
        .turn_rate = jp_clamp32(jp_q16_divide(ecu->pilot.leg.turn, ecu->pilot.leg.duration), -limit, limit - 1),
    };

    frame->id = JP_CAN_SEGMENT_MOTION_FRAME_ID;
    (void)jp_can_segment_motion_pack(frame->data, &signals, sizeof frame->data);
}

static void segment_shape(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_can_segment_shape_t signals = {
        .segment = ecu->internal.plan.segment,
        .turn = ecu->pilot.leg.turn,
        .duration = (uint32_t)jp_clamp32(ecu->pilot.leg.duration, 0, (1 << 28) - 1),
    };

    frame->id = JP_CAN_SEGMENT_SHAPE_FRAME_ID;
    (void)jp_can_segment_shape_pack(frame->data, &signals, sizeof frame->data);
}

static void segment_forecast(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const jp_energy energy = jp_energy_from_q16(ecu->pilot.leg.energy, ecu->pilot.config.model->unit_exponent);
    const struct jp_can_segment_forecast_t signals = {.segment = ecu->internal.plan.segment,
                                                      .energy = jp_energy_to_q16(energy, 0)};

    frame->id = JP_CAN_SEGMENT_FORECAST_FRAME_ID;
    (void)jp_can_segment_forecast_pack(frame->data, &signals, sizeof frame->data);
}

static bool take_plan(struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    static fill_function *const fill[] = {segment_forecast, segment_shape, segment_motion};
    const uint8_t left = __atomic_load_n(&ecu->internal.plan.frames_left, __ATOMIC_ACQUIRE);

    if (left == 0U) {
        return false;
    }
    blank(frame);
    fill[left - 1U](ecu, frame);
    __atomic_store_n(&ecu->internal.plan.frames_left, (uint8_t)(left - 1U), __ATOMIC_RELEASE);
    return true;
}

static void learned_causes(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_ecu_learned *learned = &ecu->internal.learned;
    const struct jp_can_learned_t signals = {
        .friction = signal16u(learned->friction, FACTOR_SHIFT),
        .friction_deviation = signal16u(learned->friction_deviation, FACTOR_SHIFT),
        .payload = signal16(learned->payload, MASS_SHIFT),
        .payload_deviation = signal16u(learned->payload_deviation, MASS_SHIFT),
    };

    frame->id = JP_CAN_LEARNED_FRAME_ID;
    (void)jp_can_learned_pack(frame->data, &signals, sizeof frame->data);
}

static void learner_status(const struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_ecu_learned *learned = &ecu->internal.learned;
    const struct jp_can_learner_status_t signals = {
        .version = (uint16_t)(learned->version > UINT16_MAX ? UINT16_MAX : learned->version),
        .changes = count8(learned->changes),
        .outliers = count8(learned->outliers),
        .left_out = count8(learned->left_out),
        .cause = (uint8_t)learned->cause,
        .evidence = (uint8_t)learned->evidence,
        .stored = (uint8_t)ecu->stored,
    };

    frame->id = JP_CAN_LEARNER_STATUS_FRAME_ID;
    (void)jp_can_learner_status_pack(frame->data, &signals, sizeof frame->data);
}

static bool take_learned(struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const uint8_t left = __atomic_load_n(&ecu->internal.learned.frames_left, __ATOMIC_ACQUIRE);

    if (left == 0U) {
        return false;
    }
    blank(frame);
    if (left == 1U) {
        learner_status(ecu, frame);
    } else {
        learned_causes(ecu, frame);
    }
    __atomic_store_n(&ecu->internal.learned.frames_left, (uint8_t)(left - 1U), __ATOMIC_RELEASE);
    return true;
}

static bool take_navigation(struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    return ecu->internal.navigation != NULL && jp_navigation_take_frame(ecu->internal.navigation, frame);
}

static bool take_result(struct jp_ecu *ecu, struct jp_can_frame *frame)
{
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&ecu->robot);
    const int32_t limit = (int32_t)1 << 27;
    const bool ended = telemetry->segments_ended > ecu->internal.segments_reported;
    const struct jp_can_segment_result_t signals = {
        .segment = count8(telemetry->segments_ended),
        .spent = (uint32_t)jp_clamp32(jp_energy_to_q16(telemetry->segment_energy_model, 0), 0, 2 * limit - 1),
        .drawn = jp_clamp32(jp_energy_to_q16(telemetry->segment_energy_battery, 0), -limit, limit - 1),
    };

    ecu->internal.segments_reported = telemetry->segments_ended;
    if (!ended) {
        return false;
    }
    blank(frame);
    frame->id = JP_CAN_SEGMENT_RESULT_FRAME_ID;
    (void)jp_can_segment_result_pack(frame->data, &signals, sizeof frame->data);
    return true;
}

unsigned jp_telemetry_due(struct jp_ecu *ecu, struct jp_can_frame frames[JP_TELEMETRY_FRAMES_MAX])
{
    unsigned count = take_scheduled(ecu, frames);

    count += take_plan(ecu, &frames[count]) || take_learned(ecu, &frames[count]) || take_navigation(ecu, &frames[count])
                 ? 1U
                 : 0U;
    count += take_result(ecu, &frames[count]) ? 1U : 0U;
    return count;
}
