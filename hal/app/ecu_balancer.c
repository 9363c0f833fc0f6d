#include "hal/app/ecu_balancer.h"

#include <joulepath/count.h>
#include <string.h>

#include "hal/app/signals.h"
#include "hal/can/jp_can.h"

_Static_assert((int)JP_ECU_IDLE == (int)JP_ROBOT_IDLE && (int)JP_ECU_STANDING == (int)JP_ROBOT_BALANCING &&
                   (int)JP_ECU_DRIVING == (int)JP_ROBOT_DRIVING && (int)JP_ECU_FALLEN == (int)JP_ROBOT_FALLEN &&
                   (int)JP_ECU_FAULT == (int)JP_ROBOT_FAULT,
               "the states are those of every kind");

/** Parameters of struct jp_energy_model: a1…a13, b1, b2 and five more. */
#define PARAMETERS (JP_ENERGY_TERMS + 7U)

/* After a reset. */

static bool within(int64_t value, int64_t limit)
{
    return value >= -limit && value <= limit;
}

/** Whether the motors ran, and the record can be this robot's: its check alone may also be right by chance, or because
 *  another firmware wrote it. */
static bool can_go_on(const struct jp_robot_config *config, const struct jp_snapshot *snapshot)
{
    const struct jp_estimator *estimator = &snapshot->estimator;
    const struct jp_odometry *odometry = &snapshot->odometry;
    uint8_t balancing;

    /* A bool must not be read before it is known to be one. */
    memcpy(&balancing, &snapshot->balancing, sizeof balancing);
    return balancing == 1U && estimator->phase_per_rate == jp_phase_per_rate(config->estimator.tick_rate) &&
           within(estimator->gyro_bias, (int64_t)JP_PHASE_TURN) && within(odometry->x, INT64_MAX / 2) &&
           within(odometry->y, INT64_MAX / 2) && odometry->metres_per_turn == config->metres_per_turn;
}

static bool resume(void *self, const union jp_retained_snapshot *snapshot, uint32_t *encoder_left,
                   uint32_t *encoder_right)
{
    struct jp_ecu_balancer *balancer = self;

    if (!can_go_on(jp_robot_configuration(&balancer->robot), &snapshot->balancer)) {
        return false;
    }
    jp_robot_resume(&balancer->robot, &snapshot->balancer);
    *encoder_left = snapshot->balancer.estimator.encoder_left;
    *encoder_right = snapshot->balancer.estimator.encoder_right;
    return true;
}

/* The tick. */

static void tick(void *self, const struct jp_hal *hal, enum jp_status *written)
{
    struct jp_ecu_balancer *balancer = self;

    jp_hal_tick(hal, &balancer->robot, written);
}

static const struct jp_sensors *good_frame(const void *self)
{
    const struct jp_ecu_balancer *balancer = self;

    return jp_robot_good_frame(&balancer->robot);
}

static void take_snapshot(const void *self, union jp_retained_snapshot *snapshot)
{
    const struct jp_ecu_balancer *balancer = self;

    jp_robot_snapshot(&balancer->robot, &snapshot->balancer);
}

/** Wheel rate in turn/s to speed in m/s, both Q24. */
static jp_q24 speed_of(const struct jp_ecu_balancer *balancer, jp_q24 wheel_rate)
{
    return jp_q24_multiply(wheel_rate, jp_robot_configuration(&balancer->robot)->metres_per_turn);
}

static void tell_motion(const void *self, struct jp_ecu_motion *motion)
{
    const struct jp_ecu_balancer *balancer = self;
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&balancer->robot);
    const struct jp_motion_state *measured = &telemetry->motion;
    const struct jp_reference *reference = jp_robot_reference(&balancer->robot);

    *motion = (struct jp_ecu_motion){
        .position = jp_robot_position(&balancer->robot),
        .heading = measured->yaw,
        .speed = speed_of(balancer, measured->wheel_rate),
        .turn_rate = measured->yaw_rate,
        .pitch = measured->pitch,
        .pitch_rate = measured->pitch_rate,
        .reference_speed = speed_of(balancer, reference->wheel.rate),
        .reference_turn_rate = reference->yaw.rate,
        .reference_heading = reference->yaw.angle,
        .segment_ticks_left = telemetry->segment_ticks_left,
        .voltages = telemetry->voltages,
        .saturated_ticks = telemetry->saturated_ticks,
    };
}

static void tell_progress(const void *self, struct jp_ecu_progress *progress)
{
    const struct jp_ecu_balancer *balancer = self;
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&balancer->robot);

    *progress = (struct jp_ecu_progress){.faults = telemetry->faults,
                                         .segment = telemetry->segment,
                                         .segments_ended = telemetry->segments_ended,
                                         .plan = balancer->pilot.status};
}

static void tell_energies(const void *self, jp_energy *spent, jp_energy *drawn)
{
    const struct jp_ecu_balancer *balancer = self;
    const struct jp_meter *meter = jp_robot_meter(&balancer->robot);

    *spent = meter->model;
    *drawn = meter->battery;
}

static bool take_result(void *self, struct jp_ecu_result *result)
{
    struct jp_ecu_balancer *balancer = self;
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&balancer->robot);
    const bool ended = telemetry->segments_ended > balancer->internal.segments_reported;

    balancer->internal.segments_reported = telemetry->segments_ended;
    *result = (struct jp_ecu_result){.segment = telemetry->segments_ended,
                                     .spent = telemetry->segment_energy_model,
                                     .drawn = telemetry->segment_energy_battery};
    return ended;
}

static int32_t parameter(const void *self, uint8_t index)
{
    const struct jp_energy_model *model = jp_ecu_balancer_model(self);
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

/* The background. */

static enum jp_ecu_state state(const void *self)
{
    const struct jp_ecu_balancer *balancer = self;

    return (enum jp_ecu_state)jp_robot_state_now(&balancer->robot);
}

static enum jp_refusal enable(void *self)
{
    struct jp_ecu_balancer *balancer = self;

    return jp_robot_enable(&balancer->robot) == JP_OK ? JP_REFUSAL_NONE : JP_REFUSAL_NOT_UPRIGHT;
}

static void disable(void *self)
{
    struct jp_ecu_balancer *balancer = self;

    jp_robot_disable(&balancer->robot);
}

/** Writes the one of the two models that the tick's telemetry does not read now, and lets it read that from then on. */
static void take_up_lessons(struct jp_ecu_balancer *balancer)
{
    struct jp_energy_model *models = balancer->internal.models;
    struct jp_energy_model *model = &models[balancer->internal.model == &models[0] ? 1 : 0];

    if (balancer->learns) {
        jp_learner_model(&balancer->pilot.learner, model);
        __atomic_store_n(&balancer->internal.model, model, __ATOMIC_RELEASE);
    }
}

static void set_out(void *self, bool to_goal)
{
    (void)to_goal;
    take_up_lessons(self);
}

static enum jp_status follow(void *self, const struct jp_point *targets, uint16_t count)
{
    struct jp_ecu_balancer *balancer = self;
    const struct jp_pilot_route route = {.targets = targets, .count = count, .end = JP_PILOT_PASS};

    return jp_pilot_follow(&balancer->pilot, &route);
}

static void stop(void *self)
{
    struct jp_ecu_balancer *balancer = self;

    jp_pilot_stop(&balancer->pilot);
}

static void work(void *self)
{
    struct jp_ecu_balancer *balancer = self;

    (void)jp_pilot_work(&balancer->pilot);
}

/** What the tick tells of the tick finds. */
static void note(void *self)
{
    (void)self;
}

static bool is_resting(const void *self)
{
    const struct jp_ecu_balancer *balancer = self;

    return balancer->pilot.phase == JP_PILOT_RESTING;
}

static uint16_t segments_begun(const void *self)
{
    const struct jp_ecu_balancer *balancer = self;
    struct jp_telemetry telemetry;

    return jp_robot_telemetry(&balancer->robot, &telemetry) && telemetry.state == JP_ROBOT_DRIVING ? telemetry.segment
                                                                                                   : 0;
}

static uint16_t segments_planned(const void *self)
{
    const struct jp_ecu_balancer *balancer = self;

    return balancer->pilot.targets_planned;
}

static void tell_segment(const void *self, uint16_t begun, struct jp_ecu_segment *segment)
{
    const struct jp_ecu_balancer *balancer = self;
    const struct jp_pilot_leg *leg = &balancer->pilot.leg;

    *segment = (struct jp_ecu_segment){
        .number = jp_one_more16(begun),
        .speed = leg->speed,
        .turn = leg->turn,
        .duration = leg->duration,
        .forecast = jp_energy_from_q16(leg->energy, balancer->pilot.config.model->unit_exponent)};
}

/* What it learns. */

static const struct jp_learned_state *learned_state(const void *self)
{
    const struct jp_ecu_balancer *balancer = self;

    return balancer->learns ? &balancer->pilot.learner.state : NULL;
}

static void tell_lessons(const void *self, struct jp_ecu_lessons *lessons)
{
    const struct jp_ecu_balancer *balancer = self;
    const struct jp_learner *learner = &balancer->pilot.learner;

    *lessons = (struct jp_ecu_lessons){.version = learner->state.version,
                                       .learned_from = balancer->pilot.legs_learned_from,
                                       .left_out = balancer->pilot.legs_left_out,
                                       .changes = learner->changes,
                                       .outliers = learner->outliers,
                                       .cause = learner->cause,
                                       .evidence = balancer->pilot.evidence,
                                       .stored = balancer->stored};
}

static uint8_t tell_learned(const void *self, struct jp_can_frame frames[JP_ECU_LEARNED_FRAMES])
{
    const struct jp_ecu_balancer *balancer = self;
    jp_q16 friction;
    jp_q16 payload;
    jp_q16 friction_deviation;
    jp_q16 payload_deviation;

    jp_learner_causes(&balancer->pilot.learner, &friction, &payload);
    jp_learner_cause_deviations(&balancer->pilot.learner, &friction_deviation, &payload_deviation);

    const struct jp_can_learned_t signals = {
        .friction = jp_signal16u(friction, JP_FACTOR_SHIFT),
        .friction_deviation = jp_signal16u(friction_deviation, JP_FACTOR_SHIFT),
        .payload = jp_signal16(payload, JP_MASS_SHIFT),
        .payload_deviation = jp_signal16u(payload_deviation, JP_MASS_SHIFT),
    };

    frames[0] = (struct jp_can_frame){.id = JP_CAN_LEARNED_FRAME_ID, .length = JP_CAN_LEARNED_LENGTH};
    (void)jp_can_learned_pack(frames[0].data, &signals, sizeof frames[0].data);
    return 1;
}

/** W, of a steady drive straight on at the speed limit. */
static jp_q16 cruise_power(const struct jp_ecu_balancer *balancer)
{
    const struct jp_energy_model *model = balancer->pilot.config.model;
    const jp_q24 speed = jp_robot_configuration(&balancer->robot)->limits.speed;
    const jp_q24 square = jp_q24_multiply(speed, speed);
    const jp_q16 power = jp_add(jp_multiply_shift(model->b[0], square, 24), model->electronics_power);

    return jp_energy_to_q16(jp_energy_from_q16(power, model->unit_exponent), 0);
}

static bool tell_supply(const void *self, struct jp_ecu_supply *supply)
{
    const struct jp_ecu_balancer *balancer = self;
    const struct jp_sensors *good = jp_robot_good_frame(&balancer->robot);
    struct jp_telemetry telemetry;

    if (good == NULL || !jp_robot_telemetry(&balancer->robot, &telemetry)) {
        return false;
    }
    *supply = (struct jp_ecu_supply){.drawn = telemetry.energy_battery,
                                     .voltage = __atomic_load_n(&good->bus_voltage, __ATOMIC_RELAXED),
                                     .cruise = cruise_power(balancer)};
    return true;
}

static void lack(void *self, jp_q16 lacking)
{
    struct jp_ecu_balancer *balancer = self;

    /* Where next to nothing is left it stays as it was: the robot stands, and its monitor switches it off in time. */
    (void)jp_pilot_lack_voltage(&balancer->pilot, lacking);
}

/* Start. */

static const struct jp_ecu_kind balancer_kind = {
    .snapshots = JP_RETAINED_BALANCER,
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
    .segments_planned = segments_planned,
    .segment = tell_segment,
    .learned_state = learned_state,
    .supply = tell_supply,
    .lack = lack,
    .lessons = tell_lessons,
    .tell_learned = tell_learned,
};

enum jp_status jp_ecu_balancer_init(struct jp_ecu_balancer *balancer, const struct jp_robot_config *config,
                                    const struct jp_energy_model *model, struct jp_ecu_robot *robot, const char **field)
{
    enum jp_status status;

    if (balancer == NULL || model == NULL || robot == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *balancer = (struct jp_ecu_balancer){.internal = {.model = model}};
    status = jp_robot_init(&balancer->robot, config, field);
    if (status == JP_OK) {
        status = jp_pilot_init(&balancer->pilot, &(struct jp_pilot_config){.model = model}, &balancer->robot, field);
    }
    if (status == JP_OK) {
        *robot = (struct jp_ecu_robot){.kind = &balancer_kind,
                                       .self = balancer,
                                       .tick_rate = config->estimator.tick_rate,
                                       .monitor = &config->monitor};
    }
    return status;
}

/** jp_parameters_start() has checked the stored state, but not whether it was learned with these tables. */
static enum jp_stored restore(struct jp_ecu_balancer *balancer, const struct jp_ecu_learning *learning)
{
    const char *field;

    if (learning->stored != JP_STORED_TAKEN) {
        return learning->stored;
    }
    if (jp_learner_restore(&balancer->pilot.learner, learning->state, &field) == JP_OK) {
        return JP_STORED_TAKEN;
    }
    return learning->state->identity == 0U ? JP_STORED_NOTHING : JP_STORED_OTHER_TABLES;
}

enum jp_status jp_ecu_balancer_learn(struct jp_ecu_balancer *balancer, const struct jp_ecu_learning *learning,
                                     const char **field)
{
    if (balancer == NULL || learning == NULL || learning->learning == NULL ||
        (learning->stored == JP_STORED_TAKEN && learning->state == NULL)) {
        return JP_ERR_ARGUMENT;
    }

    const struct jp_pilot_config config = {.model = balancer->internal.model,
                                           .learning = learning->learning,
                                           .meter = learning->of_battery ? JP_PILOT_BATTERY : JP_PILOT_MOTORS};
    const enum jp_status status = jp_pilot_init(&balancer->pilot, &config, &balancer->robot, field);

    if (status == JP_OK) {
        balancer->stored = restore(balancer, learning);
        balancer->learns = true;
        take_up_lessons(balancer);
    }
    return status;
}
