#include "hal/app/ecu_patrol.h"

#include <stddef.h>

#include "hal/app/ecu_factors.h"
#include "hal/app/float_signals.h"
#include "hal/can/jp_can.h"

/** Numbers of struct jp_four_wheel_energy_model, with its unit. */
#define PARAMETERS 16U

/** 1/(2π) */
#define TURNS_PER_RADIAN JP_Q24(0.15915494309189535)

static const struct jp_four_wheel_telemetry *shown(const struct jp_ecu_patrol *patrol)
{
    return jp_four_wheel_robot_shown(&patrol->robot);
}

/* Wheels and scanner on the bus. */

static enum jp_status read_wheels(void *context, struct jp_four_wheel_sensors *sensors)
{
    struct jp_ecu_patrol *patrol = context;

    return jp_wheel_link_read(&patrol->internal.wheels, sensors);
}

static enum jp_status write_wheels(void *context, const struct jp_four_wheel_actuation *actuation)
{
    struct jp_ecu_patrol *patrol = context;
    struct jp_can_frame frames[JP_WHEELS];

    jp_wheel_targets_pack(frames, &patrol->internal.target_counter, actuation);
    return patrol->internal.bus.command(patrol->internal.bus.context, frames, JP_WHEELS);
}

static float metres(uint16_t raw)
{
    return raw == JP_SCAN_RANGE_DROPPED ? -1.0f : (float)raw / (float)JP_SCAN_RANGE_ONE;
}

static bool take_scan(void *context, float *ranges)
{
    struct jp_ecu_patrol *patrol = context;
    uint16_t raw[JP_SCAN_LINK_BEAMS];

    if (!jp_scan_link_waits(&patrol->internal.scans)) {
        return false;
    }
    patrol->internal.scan_used = patrol->internal.scan_whole; /* which stays as long as the scan waits */
    (void)jp_scan_link_take(&patrol->internal.scans, raw);
    for (uint16_t i = 0; i < patrol->internal.tables.scanner->beams; i++) {
        ranges[i] = metres(raw[i]);
    }
    return true;
}

static void attach(void *self, const struct jp_ecu_bus *bus)
{
    struct jp_ecu_patrol *patrol = self;

    patrol->internal.bus = *bus;
}

/** Where the wheels are when it begins the sample of the same tick shows. */
static void note_scan_begun(struct jp_ecu_patrol *patrol)
{
    if (patrol->internal.scan_begins) {
        patrol->internal.scan_begins = false;
        patrol->internal.scan_begun = shown(patrol)->odometry;
    }
}

static enum jp_e2e_result begin_scan(struct jp_ecu_patrol *patrol, const struct jp_can_frame *frame)
{
    bool has_begun;
    const enum jp_e2e_result result = jp_scan_link_accept_begin(&patrol->internal.scans, frame, &has_begun);

    patrol->internal.scan_begins = patrol->internal.scan_begins || has_begun;
    return result;
}

static enum jp_e2e_result end_scan(struct jp_ecu_patrol *patrol, const struct jp_can_frame *frame)
{
    bool is_whole;
    const enum jp_e2e_result result = jp_scan_link_accept_end(&patrol->internal.scans, frame, &is_whole);

    note_scan_begun(patrol);
    if (is_whole) {
        patrol->internal.scan_whole = patrol->internal.scan_begun;
    }
    return result;
}

static enum jp_e2e_result accept_wheels(struct jp_ecu_patrol *patrol, const struct jp_can_frame *frame, bool *is_sample)
{
    const bool was_fresh = patrol->internal.wheels.is_fresh;
    const enum jp_e2e_result result = jp_wheel_link_accept(&patrol->internal.wheels, frame);

    *is_sample = !was_fresh && patrol->internal.wheels.is_fresh;
    return result;
}

static enum jp_e2e_result accept(void *self, const struct jp_can_frame *frame, bool *is_sample)
{
    struct jp_ecu_patrol *patrol = self;

    *is_sample = false;
    if (patrol->internal.has_board) {
        return JP_E2E_OK;
    }
    switch (frame->id) {
    case JP_CAN_SCAN_BEGIN_FRAME_ID:
        return begin_scan(patrol, frame);
    case JP_CAN_SCAN_RANGES_FRAME_ID:
        jp_scan_link_accept_ranges(&patrol->internal.scans, frame);
        return JP_E2E_OK;
    case JP_CAN_SCAN_END_FRAME_ID:
        return end_scan(patrol, frame);
    default:
        return accept_wheels(patrol, frame, is_sample);
    }
}

static bool has_started(const void *self)
{
    const struct jp_ecu_patrol *patrol = self;

    return patrol->internal.has_board || patrol->internal.wheels.has_started;
}

static uint16_t lost_samples(const void *self)
{
    const struct jp_ecu_patrol *patrol = self;

    return patrol->internal.wheels.lost;
}

/* After a reset. */

/** Its samples hold enough of the counts, so that they need not go on. */
static bool resume(void *self, const union jp_retained_snapshot *snapshot, uint32_t *encoder_left,
                   uint32_t *encoder_right)
{
    struct jp_ecu_patrol *patrol = self;

    *encoder_left = 0;
    *encoder_right = 0;
    return jp_four_wheel_robot_resume(&patrol->robot, &snapshot->four_wheel);
}

static void take_snapshot(const void *self, union jp_retained_snapshot *snapshot)
{
    const struct jp_ecu_patrol *patrol = self;

    jp_four_wheel_robot_snapshot(&patrol->robot, &snapshot->four_wheel);
}

/* The tick. */

/** Its drives are not those of struct jp_hal. */
static void tick(void *self, const struct jp_hal *hal, enum jp_status *written)
{
    struct jp_ecu_patrol *patrol = self;

    (void)hal;
    jp_hal_four_wheel_tick(&patrol->internal.hal, &patrol->robot, written);
    note_scan_begun(patrol);
}

/** Likewise its sensors. */
static const struct jp_sensors *good_frame(const void *self)
{
    (void)self;
    return NULL;
}

static jp_q16 q16_of(int64_t q32)
{
    return jp_round_shift(q32, 16);
}

static void tell_motion(const void *self, struct jp_ecu_motion *motion)
{
    const struct jp_ecu_patrol *patrol = self;
    const struct jp_four_wheel_telemetry *now = shown(patrol);

    *motion = (struct jp_ecu_motion){
        .position = {q16_of(now->odometry.x), q16_of(now->odometry.y)},
        .heading = now->odometry.heading,
        .speed = now->odometry.twist.x,
        .turn_rate = jp_q24_multiply(now->odometry.twist.turn_rate, TURNS_PER_RADIAN),
        .reference_speed = now->reference.x,
        .reference_turn_rate = jp_q24_multiply(now->reference.turn_rate, TURNS_PER_RADIAN),
        .reference_heading = now->odometry.heading,
        .saturated_ticks = now->standstills,
    };
}

static void tell_progress(const void *self, struct jp_ecu_progress *progress)
{
    const struct jp_ecu_patrol *patrol = self;

    *progress = (struct jp_ecu_progress){.faults = shown(patrol)->faults,
                                         .segment = patrol->pilot.ledger.begun,
                                         .segments_ended = patrol->pilot.ledger.ended,
                                         .plan = patrol->internal.plan};
}

/** Its model is of what leaves the battery. */
static void tell_energies(const void *self, jp_energy *spent, jp_energy *drawn)
{
    const struct jp_ecu_patrol *patrol = self;

    *drawn = shown(patrol)->energy;
    *spent = *drawn;
}

static bool take_result(void *self, struct jp_ecu_result *result)
{
    return jp_ecu_result_take(&((struct jp_ecu_patrol *)self)->internal.result, result);
}

/** Of the built-in model: what is learned of it LearnedFactors tells. */
static int32_t parameter(const void *self, uint8_t index)
{
    const struct jp_ecu_patrol *patrol = self;
    const struct jp_four_wheel_energy_model *model = patrol->internal.tables.energy;
    const int32_t numbers[PARAMETERS] = {
        model->wheelbase,      model->track,          model->weight,       model->rolling, model->drag,
        model->cornering,      model->inertia,        model->turn_inertia, model->driving, model->braking,
        model->copper_driving, model->copper_braking, model->steering,     model->contact, model->electronics_power,
        model->unit_exponent,
    };

    return numbers[index];
}

static void tell_pose(const struct jp_ecu_patrol_view *view, struct jp_can_frame *frame)
{
    const float turns = view->pose.heading * JP_TURNS_PER_RADIAN * 65536.0f;
    const struct jp_can_map_pose_t signals = {.x = (int32_t)(view->pose.x * 8192.0f),
                                              .y = (int32_t)(view->pose.y * 8192.0f),
                                              .heading = (int16_t)jp_saturate_bits((int32_t)turns, 16)};

    frame->id = JP_CAN_MAP_POSE_FRAME_ID;
    (void)jp_can_map_pose_pack(frame->data, &signals, sizeof frame->data);
}

static uint16_t deviation(float value)
{
    const float scaled = value * 4096.0f;

    return scaled < 65535.0f ? (uint16_t)scaled : UINT16_MAX;
}

static void tell_patrol(const struct jp_ecu_patrol *patrol, const struct jp_ecu_patrol_view *view,
                        struct jp_can_frame *frame)
{
    const struct jp_can_patrol_status_t signals = {.patrol_state = view->patrol_state,
                                                   .patrol_reason = view->patrol_reason,
                                                   .localiser_state = view->localiser_state,
                                                   .localiser_reason = view->localiser_reason,
                                                   .lost_scans = patrol->internal.scans.lost,
                                                   .position_deviation = deviation(view->position_deviation),
                                                   .heading_deviation = deviation(view->heading_deviation)};

    frame->id = JP_CAN_PATROL_STATUS_FRAME_ID;
    (void)jp_can_patrol_status_pack(frame->data, &signals, sizeof frame->data);
}

static bool tell_own(const void *self, uint8_t index, struct jp_can_frame *frame)
{
    const struct jp_ecu_patrol *patrol = self;
    const uint8_t view = __atomic_load_n(&patrol->internal.view, __ATOMIC_ACQUIRE);

    if (view == 0U) {
        return false;
    }
    if (index == 0U) {
        tell_pose(&patrol->internal.views[view - 1U], frame);
    } else {
        tell_patrol(patrol, &patrol->internal.views[view - 1U], frame);
    }
    return true;
}

/* The background. */

static enum jp_ecu_state state(const void *self)
{
    static const enum jp_ecu_state states[] = {[JP_FOUR_WHEEL_ROBOT_IDLE] = JP_ECU_IDLE,
                                               [JP_FOUR_WHEEL_ROBOT_STANDING] = JP_ECU_STANDING,
                                               [JP_FOUR_WHEEL_ROBOT_DRIVING] = JP_ECU_DRIVING,
                                               [JP_FOUR_WHEEL_ROBOT_FAULT] = JP_ECU_FAULT};
    const struct jp_ecu_patrol *patrol = self;

    return states[jp_four_wheel_robot_state_now(&patrol->robot)];
}

/** Refused only before the first plausible sample. */
static enum jp_refusal enable(void *self)
{
    struct jp_ecu_patrol *patrol = self;

    return jp_four_wheel_robot_enable(&patrol->robot) == JP_OK ? JP_REFUSAL_NONE : JP_REFUSAL_STEEP;
}

static void disable(void *self)
{
    struct jp_ecu_patrol *patrol = self;

    jp_four_wheel_robot_disable(&patrol->robot);
}

/** What it has learned it plans with at once. */
static void set_out(void *self, bool to_goal)
{
    (void)self;
    (void)to_goal;
}

static enum jp_status follow(void *self, const struct jp_point *targets, uint16_t count)
{
    struct jp_ecu_patrol *patrol = self;

    patrol->internal.is_to_goal = false;
    patrol->internal.plan = jp_patrol_pilot_follow(&patrol->pilot, targets, count);
    return patrol->internal.plan;
}

static void stop(void *self)
{
    struct jp_ecu_patrol *patrol = self;

    jp_patrol_pilot_stop(&patrol->pilot);
}

static void look(struct jp_ecu_patrol *patrol)
{
    if (patrol->internal.hal.scan(patrol->internal.hal.context, patrol->internal.ranges)) {
        jp_patrol_pilot_see(&patrol->pilot, patrol->internal.ranges, &patrol->internal.scan_used);
    }
}

void jp_ecu_patrol_work(struct jp_ecu_patrol *patrol)
{
    look(patrol);
    jp_patrol_pilot_work(&patrol->pilot);
}

static void work(void *self)
{
    jp_ecu_patrol_work(self);
}

static bool is_resting(const void *self)
{
    const struct jp_ecu_patrol *patrol = self;

    return !jp_patrol_pilot_is_under_way(&patrol->pilot);
}

static uint16_t segments_begun(const void *self)
{
    const struct jp_ecu_patrol *patrol = self;

    return patrol->pilot.ledger.begun;
}

/** Planned when it begins. */
static void tell_segment(const void *self, uint16_t begun, struct jp_ecu_segment *segment)
{
    const struct jp_ecu_patrol *patrol = self;
    const struct jp_patrol_leg_forecast *forecast = &patrol->pilot.ledger.forecast;

    (void)begun;
    *segment = (struct jp_ecu_segment){.number = patrol->pilot.ledger.begun,
                                       .speed = jp_fixed_of(patrol->internal.tables.patrol->teb.speed_max, 0x1p24f),
                                       .duration = jp_fixed_of(forecast->duration, 0x1p16f),
                                       .forecast = jp_energy_from_q16(jp_fixed_of(forecast->energy, 0x1p16f), 0)};
}

/* What it learns. */

static const struct jp_learned_state *learned_state(const void *self)
{
    const struct jp_ecu_patrol *patrol = self;

    return &patrol->pilot.ledger.learner.state;
}

static void tell_lessons(const void *self, struct jp_ecu_lessons *lessons)
{
    const struct jp_ecu_patrol *patrol = self;
    const struct jp_patrol_ledger *ledger = &patrol->pilot.ledger;

    *lessons = (struct jp_ecu_lessons){.version = ledger->learner.state.version,
                                       .learned_from = ledger->learned_from,
                                       .left_out = ledger->left_out,
                                       .changes = ledger->learner.changes,
                                       .outliers = ledger->learner.outliers,
                                       .stored = patrol->stored};
}

static struct jp_ecu_factors factors_of(const jp_q16 numbers[JP_FOUR_WHEEL_FACTORS])
{
    return (struct jp_ecu_factors){.rolling = numbers[JP_FOUR_WHEEL_ROLLING],
                                   .friction = numbers[JP_FOUR_WHEEL_STEERING],
                                   .weight = numbers[JP_FOUR_WHEEL_WEIGHT],
                                   .electronics = numbers[JP_FOUR_WHEEL_ELECTRONICS]};
}

static uint8_t tell_learned(const void *self, struct jp_can_frame frames[JP_ECU_LEARNED_FRAMES])
{
    const struct jp_ecu_patrol *patrol = self;
    jp_q16 factors[JP_FOUR_WHEEL_FACTORS];
    jp_q16 deviations[JP_FOUR_WHEEL_FACTORS];

    jp_four_wheel_learner_factors(&patrol->pilot.ledger.learner, factors);
    jp_four_wheel_learner_deviations(&patrol->pilot.ledger.learner, deviations);

    const struct jp_ecu_factors learned = factors_of(factors);
    const struct jp_ecu_factors uncertain = factors_of(deviations);

    return jp_ecu_tell_factors(&learned, &uncertain, frames);
}

/* Between work and tick. */

static void hand_over_result(struct jp_ecu_patrol *patrol)
{
    const struct jp_patrol_ledger *ledger = &patrol->pilot.ledger;
    const struct jp_ecu_result result = {
        .segment = ledger->begun, .spent = ledger->result.energy, .drawn = ledger->result.energy};

    if (ledger->ended == patrol->internal.ended || jp_ecu_result_waits(&patrol->internal.result)) {
        return;
    }
    patrol->internal.ended = ledger->ended;
    jp_ecu_result_put(&patrol->internal.result, &result);
}

static void show_view(struct jp_ecu_patrol *patrol)
{
    const struct jp_patrol_pilot *pilot = &patrol->pilot;
    const uint8_t next = patrol->internal.view == 1U ? 2U : 1U;

    if (!pilot->has_map) {
        __atomic_store_n(&patrol->internal.view, 0, __ATOMIC_RELEASE);
        return;
    }
    patrol->internal.views[next - 1U] =
        (struct jp_ecu_patrol_view){.pose = pilot->mission.patrol.pose,
                                    .position_deviation = pilot->localiser.position_deviation,
                                    .heading_deviation = pilot->localiser.heading_deviation,
                                    .patrol_state = (uint8_t)pilot->mission.patrol.state,
                                    .patrol_reason = (uint8_t)pilot->mission.patrol.reason,
                                    .localiser_state = (uint8_t)pilot->localiser.state,
                                    .localiser_reason = (uint8_t)pilot->localiser.reason};
    __atomic_store_n(&patrol->internal.view, next, __ATOMIC_RELEASE);
}

/** A route that ended before its last waypoint has no plan. */
static void note(void *self)
{
    struct jp_ecu_patrol *patrol = self;

    if (patrol->pilot.has_map && patrol->pilot.mission.state == JP_MISSION_GIVEN_UP) {
        patrol->internal.plan = JP_ERR_BLOCKED;
    }
    hand_over_result(patrol);
    show_view(patrol);
}

/* Start. */

static const struct jp_ecu_kind patrol_kind = {
    .snapshots = JP_RETAINED_FOUR_WHEEL,
    .parameters = PARAMETERS,
    .resume = resume,
    .attach = attach,
    .accept = accept,
    .has_started = has_started,
    .lost_samples = lost_samples,
    .tell_own = tell_own,
    .tick = tick,
    .good_frame = good_frame,
    .snapshot = take_snapshot,
    .motion = tell_motion,
    .progress = tell_progress,
    .energies = tell_energies,
    .take_result = take_result,
    .parameter = parameter,
    .state = state,
    .enable = enable,
    .disable = disable,
    .set_out = set_out,
    .follow = follow,
    .stop = stop,
    .work = work,
    .note = note,
    .is_resting = is_resting,
    .segments_begun = segments_begun,
    .segments_planned = segments_begun,
    .segment = tell_segment,
    .learned_state = learned_state,
    .lessons = tell_lessons,
    .tell_learned = tell_learned,
};

static enum jp_status prepare(struct jp_ecu_patrol *patrol, const struct jp_ecu_patrol_config *config,
                              const char **field)
{
    enum jp_status status = jp_four_wheel_robot_init(&patrol->robot, config->robot, field);

    if (status == JP_OK) {
        status = jp_patrol_pilot_init(&patrol->pilot, config->pilot, &patrol->robot, field);
    }
    if (status == JP_OK && config->pilot->scanner->beams > JP_SCAN_LINK_BEAMS) {
        *field = "scanner.beams";
        status = JP_ERR_CONFIG;
    }
    return status;
}

/** jp_parameters_start() has checked the stored state, but not whether it was learned with these tables. */
static enum jp_stored restore(struct jp_ecu_patrol *patrol, const struct jp_ecu_patrol_config *config)
{
    const char *field;

    if (config->stored != JP_STORED_TAKEN) {
        return config->stored;
    }
    if (jp_four_wheel_learner_restore(&patrol->pilot.ledger.learner, config->state, &field) == JP_OK) {
        return JP_STORED_TAKEN;
    }
    return config->state->identity == 0U ? JP_STORED_NOTHING : JP_STORED_OTHER_TABLES;
}

enum jp_status jp_ecu_patrol_init(struct jp_ecu_patrol *patrol, const struct jp_ecu_patrol_config *config,
                                  struct jp_ecu_robot *robot, const char **field)
{
    enum jp_status status;

    if (patrol == NULL || config == NULL || robot == NULL || field == NULL || config->pilot == NULL ||
        config->block == NULL || (config->stored == JP_STORED_TAKEN && config->state == NULL)) {
        return JP_ERR_ARGUMENT;
    }
    *patrol = (struct jp_ecu_patrol){.internal = {.block = config->block, .size = config->size}};
    status = prepare(patrol, config, field);
    if (status != JP_OK) {
        return status;
    }
    patrol->internal.tables = *config->pilot;
    patrol->stored = restore(patrol, config);
    patrol->internal.hal =
        (struct jp_four_wheel_hal){.context = patrol, .read = read_wheels, .write = write_wheels, .scan = take_scan};
    jp_scan_link_start(&patrol->internal.scans, config->pilot->scanner->beams);
    *robot = (struct jp_ecu_robot){.kind = &patrol_kind, .self = patrol, .tick_rate = config->robot->tick_rate};
    return JP_OK;
}

void jp_ecu_patrol_use_board(struct jp_ecu_patrol *patrol, const struct jp_four_wheel_hal *hal)
{
    patrol->internal.hal = *hal;
    patrol->internal.has_board = true;
}

void jp_ecu_patrol_begin_scan(struct jp_ecu_patrol *patrol)
{
    patrol->internal.scan_used = shown(patrol)->odometry;
}
