#include "hal/app/ecu_skid.h"

#include <stddef.h>
#include <string.h>

#include "hal/app/ecu_factors.h"

/** Numbers of struct jp_skid_energy_model, with its unit. */
#define PARAMETERS 18U

/** 1/(2π) */
#define TURNS_PER_RADIAN JP_Q24(0.15915494309189535)

/** From the first sample after a reset in motion: the robot must be awake, and may have missed some samples. */
#define WAKING_TICKS (4U * (unsigned)JP_SKID_WAKE_TICKS)

static const struct jp_skid_robot_config *config_of(const struct jp_ecu_skid *skid)
{
    return jp_skid_robot_configuration(&skid->robot);
}

/* After a reset. */

/** Where it was it knows after a fault, too. */
static bool resume(void *self, const union jp_retained_snapshot *snapshot, uint32_t *encoder_left,
                   uint32_t *encoder_right)
{
    struct jp_ecu_skid *skid = self;

    if (!jp_skid_robot_resume(&skid->robot, &snapshot->skid) || snapshot->skid.ran == 0U) {
        return false;
    }
    skid->internal.waking_ticks = WAKING_TICKS;
    *encoder_left = snapshot->skid.encoder_left;
    *encoder_right = snapshot->skid.encoder_right;
    return true;
}

/* The tick. */

/** As soon as it knows how fast it is it brakes under control, to stand. */
static void go_on(struct jp_ecu_skid *skid)
{
    const bool is_idle = jp_skid_robot_state_now(&skid->robot) == JP_SKID_ROBOT_IDLE;

    skid->internal.waking_ticks = is_idle ? (uint8_t)(skid->internal.waking_ticks - 1U) : 0;
    (void)jp_skid_robot_enable(&skid->robot);
}

static void tick(void *self, const struct jp_hal *hal, enum jp_status *written)
{
    struct jp_ecu_skid *skid = self;

    jp_hal_skid_tick(hal, &skid->robot, written);
    if (skid->internal.waking_ticks > 0U) {
        go_on(skid);
    }
}

static const struct jp_sensors *good_frame(const void *self)
{
    const struct jp_ecu_skid *skid = self;

    return jp_skid_robot_good_frame(&skid->robot);
}

static void take_snapshot(const void *self, union jp_retained_snapshot *snapshot)
{
    const struct jp_ecu_skid *skid = self;

    jp_skid_robot_snapshot(&skid->robot, &snapshot->skid);
    /* Reset again before it was enabled, it still is to brake and to stand. */
    if (skid->internal.waking_ticks > 0U) {
        snapshot->skid.ran = 1;
    }
}

static uint32_t ticks_left(const struct jp_ecu_skid *skid, const struct jp_skid_telemetry *telemetry)
{
    const uint32_t left = skid->internal.end_tick - telemetry->tick;

    return telemetry->state == JP_SKID_ROBOT_DRIVING && left <= (uint32_t)INT32_MAX ? left : 0;
}

static void tell_motion(const void *self, struct jp_ecu_motion *motion)
{
    const struct jp_ecu_skid *skid = self;
    const struct jp_skid_odometry *odometry = jp_skid_robot_odometry(&skid->robot);
    const struct jp_sensors *frame = jp_skid_robot_good_frame(&skid->robot);
    struct jp_skid_telemetry telemetry;
    jp_angle heading;

    (void)jp_skid_robot_telemetry(&skid->robot, &telemetry);
    *motion = (struct jp_ecu_motion){
        .speed = odometry->speed,
        .turn_rate = odometry->turn_rate,
        .pitch = jp_skid_robot_pitch(&skid->robot),
        .pitch_rate = frame == NULL ? 0 : frame->pitch_rate,
        .reference_speed = telemetry.reference.speed,
        .reference_turn_rate = jp_q24_multiply(telemetry.reference.turn_rate, TURNS_PER_RADIAN),
        .segment_ticks_left = ticks_left(skid, &telemetry),
        .voltages = telemetry.voltages,
        .saturated_ticks = telemetry.saturated_ticks,
    };
    jp_skid_odometry_now(odometry, &config_of(skid)->odometry, &motion->position, &heading);
    motion->heading = (jp_phase)heading << 24;
    motion->reference_heading = motion->heading;
}

static void tell_progress(const void *self, struct jp_ecu_progress *progress)
{
    const struct jp_ecu_skid *skid = self;
    struct jp_skid_telemetry telemetry;

    (void)jp_skid_robot_telemetry(&skid->robot, &telemetry);
    *progress = (struct jp_ecu_progress){.faults = telemetry.faults,
                                         .segment = skid->pilot.legs_begun,
                                         .segments_ended = skid->pilot.legs_ended,
                                         .plan = skid->pilot.status};
}

/** Its model is of what leaves the battery. */
static void tell_energies(const void *self, jp_energy *spent, jp_energy *drawn)
{
    const struct jp_ecu_skid *skid = self;

    *drawn = jp_skid_robot_meter(&skid->robot)->battery;
    *spent = *drawn;
}

static bool take_result(void *self, struct jp_ecu_result *result)
{
    return jp_ecu_result_take(&((struct jp_ecu_skid *)self)->internal.result, result);
}

static int32_t parameter(const void *self, uint8_t index)
{
    const struct jp_ecu_skid *skid = self;
    const struct jp_skid_energy_model *model = __atomic_load_n(&skid->internal.model, __ATOMIC_ACQUIRE);
    const int32_t numbers[PARAMETERS] = {
        model->half_track,        model->weight,        model->rolling,        model->friction,
        model->turning,           model->yielding,      model->scrub,          model->easing,
        model->bank_easing,       model->tilting,       model->inertia,        model->turn_inertia,
        model->driving,           model->braking,       model->copper_driving, model->copper_braking,
        model->electronics_power, model->unit_exponent,
    };

    return numbers[index];
}

/* The background. */

static enum jp_ecu_state state(const void *self)
{
    static const enum jp_ecu_state states[] = {[JP_SKID_ROBOT_IDLE] = JP_ECU_IDLE,
                                               [JP_SKID_ROBOT_STANDING] = JP_ECU_STANDING,
                                               [JP_SKID_ROBOT_DRIVING] = JP_ECU_DRIVING,
                                               [JP_SKID_ROBOT_FAULT] = JP_ECU_FAULT};
    const struct jp_ecu_skid *skid = self;

    return states[jp_skid_robot_state_now(&skid->robot)];
}

static enum jp_refusal enable(void *self)
{
    struct jp_ecu_skid *skid = self;

    return jp_skid_robot_enable(&skid->robot) == JP_OK ? JP_REFUSAL_NONE : JP_REFUSAL_STEEP;
}

static void disable(void *self)
{
    struct jp_ecu_skid *skid = self;

    skid->internal.waking_ticks = 0;
    jp_skid_robot_disable(&skid->robot);
}

/** Writes the one of the two models that the tick's telemetry does not read now, and lets it read that from then on. */
static void take_up_lessons(struct jp_ecu_skid *skid)
{
    struct jp_skid_energy_model *models = skid->internal.models;
    struct jp_skid_energy_model *model = &models[skid->internal.model == &models[0] ? 1 : 0];

    *model = skid->pilot.learner.model;
    __atomic_store_n(&skid->internal.model, model, __ATOMIC_RELEASE);
}

static void set_out(void *self, bool to_goal)
{
    struct jp_ecu_skid *skid = self;

    take_up_lessons(skid);
    jp_skid_pilot_pass_corners(&skid->pilot, to_goal ? skid->internal.goal_corner : skid->internal.corner);
}

static enum jp_status follow(void *self, const struct jp_point *targets, uint16_t count)
{
    struct jp_ecu_skid *skid = self;
    const struct jp_skid_pilot_route route = {.targets = targets, .count = count};

    return jp_skid_pilot_follow(&skid->pilot, &route);
}

static void stop(void *self)
{
    struct jp_ecu_skid *skid = self;

    jp_skid_pilot_stop(&skid->pilot);
}

static void work(void *self)
{
    struct jp_ecu_skid *skid = self;

    (void)jp_skid_pilot_work(&skid->pilot);
}

static bool is_resting(const void *self)
{
    const struct jp_ecu_skid *skid = self;

    return skid->pilot.phase == JP_SKID_PILOT_RESTING;
}

static uint16_t segments_begun(const void *self)
{
    const struct jp_ecu_skid *skid = self;

    return skid->pilot.legs_begun;
}

/** A route is planned whole; a leg is told when it begins. */
static void tell_segment(const void *self, uint16_t begun, struct jp_ecu_segment *segment)
{
    const struct jp_ecu_skid *skid = self;
    const struct jp_skid_pilot_leg *leg = &skid->pilot.leg;

    (void)begun;
    *segment =
        (struct jp_ecu_segment){.number = skid->pilot.legs_begun,
                                .speed = leg->speed,
                                .turn = leg->turn,
                                .duration = leg->duration,
                                .forecast = jp_energy_from_q16(leg->energy, skid->pilot.config.model->unit_exponent)};
}

/* What it learns. */

static const struct jp_learned_state *learned_state(const void *self)
{
    const struct jp_ecu_skid *skid = self;

    return &skid->pilot.learner.state;
}

static void tell_lessons(const void *self, struct jp_ecu_lessons *lessons)
{
    const struct jp_ecu_skid *skid = self;
    const struct jp_skid_learner *learner = &skid->pilot.learner;

    *lessons = (struct jp_ecu_lessons){.version = learner->state.version,
                                       .learned_from = skid->pilot.legs_learned_from,
                                       .left_out = skid->pilot.legs_left_out,
                                       .changes = learner->changes,
                                       .outliers = learner->outliers,
                                       .evidence = skid->pilot.evidence,
                                       .stored = skid->stored};
}

static struct jp_ecu_factors factors_of(const jp_q16 numbers[JP_SKID_FACTORS])
{
    return (struct jp_ecu_factors){.rolling = numbers[JP_SKID_ROLLING],
                                   .friction = numbers[JP_SKID_FRICTION],
                                   .weight = numbers[JP_SKID_WEIGHT],
                                   .electronics = numbers[JP_SKID_ELECTRONICS]};
}

static uint8_t tell_learned(const void *self, struct jp_can_frame frames[JP_ECU_LEARNED_FRAMES])
{
    const struct jp_ecu_skid *skid = self;
    jp_q16 factors[JP_SKID_FACTORS];
    jp_q16 deviations[JP_SKID_FACTORS];

    jp_skid_learner_factors(&skid->pilot.learner, factors);
    jp_skid_learner_deviations(&skid->pilot.learner, deviations);

    const struct jp_ecu_factors learned = factors_of(factors);
    const struct jp_ecu_factors uncertain = factors_of(deviations);

    return jp_ecu_tell_factors(&learned, &uncertain, frames);
}

/* Between work and tick. */

/** Of the leg that began last, as planned. */
static void note_end(struct jp_ecu_skid *skid)
{
    const uint64_t duration = ((uint64_t)(uint32_t)skid->pilot.leg.duration * config_of(skid)->control.tick_rate) >> 16;
    struct jp_skid_telemetry telemetry;

    if (jp_skid_robot_telemetry(&skid->robot, &telemetry)) {
        skid->internal.end_tick = telemetry.tick + (uint32_t)duration;
    }
}

static void hand_over_result(struct jp_ecu_skid *skid)
{
    const struct jp_skid_pilot_result *last = &skid->pilot.result;
    const struct jp_ecu_result result = {.segment = last->leg, .spent = last->energy, .drawn = last->energy};

    if (jp_ecu_result_waits(&skid->internal.result)) {
        return;
    }
    skid->internal.ended = skid->pilot.legs_ended;
    if (skid->pilot.legs_ended > 0U) {
        jp_ecu_result_put(&skid->internal.result, &result);
    }
}

static void note(void *self)
{
    struct jp_ecu_skid *skid = self;

    if (skid->pilot.legs_begun != skid->internal.begun) {
        skid->internal.begun = skid->pilot.legs_begun;
        note_end(skid);
    }
    if (skid->pilot.legs_ended != skid->internal.ended) {
        hand_over_result(skid);
    }
}

static bool tell_supply(const void *self, struct jp_ecu_supply *supply)
{
    const struct jp_ecu_skid *skid = self;
    const struct jp_sensors *good = jp_skid_robot_good_frame(&skid->robot);
    struct jp_skid_telemetry telemetry;

    if (good == NULL || !jp_skid_robot_telemetry(&skid->robot, &telemetry)) {
        return false;
    }
    *supply = (struct jp_ecu_supply){.drawn = telemetry.energy,
                                     .voltage = __atomic_load_n(&good->bus_voltage, __ATOMIC_RELAXED),
                                     .cruise = skid->internal.cruise};
    return true;
}

static void lack(void *self, jp_q16 lacking)
{
    struct jp_ecu_skid *skid = self;

    /* Where next to nothing is left it stays as it was: the robot stands, and its monitor switches it off in time. */
    (void)jp_skid_pilot_lack_voltage(&skid->pilot, lacking);
}

/* Start. */

static const struct jp_ecu_kind skid_kind = {
    .snapshots = JP_RETAINED_SKID,
    .parameters = PARAMETERS,
    .resume = resume,
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
    .supply = tell_supply,
    .lack = lack,
    .lessons = tell_lessons,
    .tell_learned = tell_learned,
};

static enum jp_status prepare(struct jp_ecu_skid *skid, const struct jp_ecu_skid_config *config, const char **field)
{
    struct jp_skid_pilot_config pilot = {.model = config->energy,
                                         .learning = config->learning,
                                         .corner = config->corner,
                                         .pieces = skid->internal.pieces,
                                         .places = sizeof skid->internal.pieces / sizeof skid->internal.pieces[0]};
    const enum jp_status status = jp_skid_robot_init(&skid->robot, config->robot, field);

    if (status != JP_OK) {
        return status;
    }
    pilot.limits = *config->limits;
    return jp_skid_pilot_init(&skid->pilot, &pilot, &skid->robot, field);
}

/** jp_parameters_start() has checked the stored state, but not whether it was learned with these tables. */
static enum jp_stored restore(struct jp_ecu_skid *skid, const struct jp_ecu_skid_config *config)
{
    const char *field;

    if (config->stored != JP_STORED_TAKEN) {
        return config->stored;
    }
    if (jp_skid_learner_restore(&skid->pilot.learner, config->state, &field) == JP_OK) {
        return JP_STORED_TAKEN;
    }
    return config->state->identity == 0U ? JP_STORED_NOTHING : JP_STORED_OTHER_TABLES;
}

/** The gyro is the same when its energy was learned with other tables. */
static void know_gyro(struct jp_ecu_skid *skid, const struct jp_ecu_skid_config *config)
{
    if (config->stored == JP_STORED_TAKEN) {
        jp_skid_robot_know_gyro_scale(&skid->robot, config->scale);
    }
}

/** W, of a steady drive straight on at the highest speed that is planned, on level ground. */
static jp_q16 cruise_power(const struct jp_ecu_skid_config *config)
{
    const struct jp_motion motion = {.speed = config->limits->speed};
    jp_q16 power = 0;

    (void)jp_skid_energy_power(config->energy, &motion, 0, &power);
    return power;
}

enum jp_status jp_ecu_skid_init(struct jp_ecu_skid *skid, const struct jp_ecu_skid_config *config,
                                struct jp_ecu_robot *robot, const char **field)
{
    enum jp_status status;

    if (skid == NULL || config == NULL || config->limits == NULL || robot == NULL ||
        (config->stored == JP_STORED_TAKEN && (config->state == NULL || config->scale == NULL))) {
        return JP_ERR_ARGUMENT;
    }
    (void)memset(skid, 0, sizeof *skid);
    skid->internal.model = config->energy;
    skid->internal.corner = config->corner;
    skid->internal.goal_corner = config->goal_corner;
    status = prepare(skid, config, field);
    if (status == JP_OK) {
        skid->stored = restore(skid, config);
        know_gyro(skid, config);
        take_up_lessons(skid);
        skid->internal.cruise = cruise_power(config);
        *robot = (struct jp_ecu_robot){.kind = &skid_kind,
                                       .self = skid,
                                       .tick_rate = config->robot->control.tick_rate,
                                       .monitor = &config->robot->monitor};
    }
    return status;
}

struct jp_gyro_scale jp_ecu_skid_gyro_scale(const struct jp_ecu_skid *skid)
{
    struct jp_gyro_scale scale;

    jp_skid_odometry_scale(jp_skid_robot_odometry(&skid->robot), &config_of(skid)->odometry, &scale);
    return scale;
}
