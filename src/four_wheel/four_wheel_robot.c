#include <joulepath/four_wheel_robot.h>

#include <joulepath/count.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/integer.h"
#include "src/base/request.h"
#include "src/base/sequence.h"

/** 2³²/(2π) */
#define TURNS_PER_RADIAN 683565276

#define TWIST_MAX JP_Q24(16)
#define POWER_MAX 32767

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_four_wheel_robot_config, member, low, high)

/* Start. */

static enum jp_status check_own(const struct jp_four_wheel_robot_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(tick_rate, JP_TICK_RATE_MIN, JP_TICK_RATE_MAX),
        FIELD(count_speed, 1, INT32_MAX),
        FIELD(twist_ticks, 1, 10000),
        FIELD(limits.count_jump, 1, UINT16_MAX),
        FIELD(limits.current, 1, INT32_MAX),
        FIELD(limits.voltage_min, 1, INT32_MAX),
        FIELD(limits.voltage_max, 1, JP_Q16(1000)),
        FIELD(limits.speed_lag, 1, INT32_MAX),
        FIELD(limits.angle_lag, 1, INT32_MAX),
        FIELD(limits.lag_ticks, 1, UINT16_MAX),
        FIELD(limits.confirm_ticks, 1, 100),
    };
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status == JP_OK && config->limits.voltage_max <= config->limits.voltage_min) {
        return jp_config_refuse("limits.voltage_max", field);
    }
    if (status == JP_OK &&
        jp_multiply(config->limits.current, config->limits.voltage_max) > ((int64_t)POWER_MAX << 32)) {
        return jp_config_refuse("limits.current", field);
    }
    return status;
}

enum jp_status jp_four_wheel_robot_init(struct jp_four_wheel_robot *robot,
                                        const struct jp_four_wheel_robot_config *config, const char **field)
{
    if (robot == NULL || config == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    enum jp_status status = jp_four_wheel_check(&config->wheels, field);

    if (status == JP_OK) {
        status = check_own(config, field);
    }
    if (status != JP_OK) {
        return status;
    }
    const struct jp_four_wheel_trip_config trip = {
        .wheels = config->wheels, .tick_rate = config->tick_rate, .piece_ticks = config->piece_ticks};
    const int32_t rate = (int32_t)config->tick_rate;

    *robot = (struct jp_four_wheel_robot){.internal = {.config = config}};
    robot->internal.turn_per_rate = (TURNS_PER_RADIAN + rate / 2) / rate;
    (void)jp_bus_meter_start(&robot->internal.meter, config->tick_rate);
    return jp_four_wheel_trip_init(&robot->internal.trip, &trip, field);
}

/* The tick: sensors. */

static bool are_counts_plausible(const struct jp_four_wheel_robot_internal *robot,
                                 const struct jp_four_wheel_sensors *sensors)
{
    const uint32_t limit = robot->config->limits.count_jump * (robot->missed + 1U);
    bool are_plausible = true;

    for (int i = 0; i < (int)JP_WHEELS; i++) {
        const int32_t counted = (int32_t)(sensors->count[i] - robot->good.count[i]);

        are_plausible = are_plausible && jp_magnitude32(counted) <= limit;
    }
    return are_plausible || !robot->has_frame;
}

static unsigned fault_of_side(int wheel, enum jp_fault left, enum jp_fault right)
{
    const bool is_left = wheel == (int)JP_FRONT_LEFT || wheel == (int)JP_REAR_LEFT;

    return is_left ? (unsigned)left : (unsigned)right;
}

static unsigned angle_faults(const struct jp_four_wheel_robot_internal *robot,
                             const struct jp_four_wheel_sensors *sensors)
{
    const int64_t limit = (int64_t)robot->config->wheels.steering_limit + robot->config->limits.angle_lag;
    unsigned faults = 0;

    for (int i = 0; i < (int)JP_WHEELS; i++) {
        if (jp_absolute64(sensors->angle[i]) > limit) {
            faults |= fault_of_side(i, JP_FAULT_ENCODER_LEFT, JP_FAULT_ENCODER_RIGHT);
        }
    }
    return faults;
}

/** What is implausible of a frame. */
static unsigned suspicions(const struct jp_four_wheel_robot_internal *robot, enum jp_status read,
                           const struct jp_four_wheel_sensors *sensors)
{
    const struct jp_four_wheel_limits *limits = &robot->config->limits;
    unsigned faults;

    if (read != JP_OK) {
        return (unsigned)JP_FAULT_HARDWARE;
    }
    faults = angle_faults(robot, sensors);
    if (!are_counts_plausible(robot, sensors)) {
        faults |= (unsigned)JP_FAULT_ENCODER_JUMP;
    }
    if (!jp_is_between(sensors->bus_voltage, limits->voltage_min, limits->voltage_max)) {
        faults |= (unsigned)JP_FAULT_BUS_VOLTAGE;
    }
    if (!jp_is_between(sensors->bus_current, -limits->current, limits->current)) {
        faults |= (unsigned)JP_FAULT_CURRENT_RANGE;
    }
    return faults;
}

/** As the counts since the frame before say, of a time of `ticks`. */
static void measure(struct jp_four_wheel_robot_internal *robot, const struct jp_four_wheel_sensors *sensors,
                    uint32_t ticks)
{
    for (int i = 0; i < (int)JP_WHEELS; i++) {
        const int32_t counted = robot->has_frame ? (int32_t)(sensors->count[i] - robot->good.count[i]) : 0;
        const int64_t speed = jp_multiply(counted, robot->config->count_speed) / (int64_t)ticks;

        robot->measured.speed[i] = jp_clamp32(jp_round_shift(speed, 8), -TWIST_MAX, TWIST_MAX);
        robot->measured.angle[i] = sensors->angle[i];
    }
}

/** Confirmed faults of the frame; the good one is kept. */
static unsigned take_frame(struct jp_four_wheel_robot_internal *robot, enum jp_status read,
                           const struct jp_four_wheel_sensors *sensors)
{
    const unsigned suspected = suspicions(robot, read, sensors);

    robot->is_fresh = suspected == 0U;
    if (robot->is_fresh) {
        measure(robot, sensors, robot->missed + 1U);
        robot->good = *sensors;
        robot->has_frame = true;
        return 0;
    }
    robot->shown.dropped_frames = jp_one_more32(robot->shown.dropped_frames);
    return robot->missed + 1U >= robot->config->limits.confirm_ticks ? suspected : 0U;
}

static bool lags_behind(const struct jp_four_wheel_robot_internal *robot, int wheel)
{
    const struct jp_four_wheel_limits *limits = &robot->config->limits;
    const int64_t angle = (int64_t)robot->measured.angle[wheel] - robot->shown.wheels.angle[wheel];
    const int32_t speed = jp_sub(robot->measured.speed[wheel], robot->shown.wheels.speed[wheel]);

    return jp_magnitude32(speed) > (uint32_t)limits->speed_lag || jp_absolute64(angle) > limits->angle_lag;
}

/** Drives that have not done for a while what they were told. */
static unsigned lag_faults(struct jp_four_wheel_robot_internal *robot)
{
    unsigned faults = 0;

    for (int i = 0; i < (int)JP_WHEELS; i++) {
        if (!robot->was_controlled || !lags_behind(robot, i)) {
            robot->lags[i] = 0;
        } else if (robot->is_fresh) {
            robot->lags[i] = jp_one_more16(robot->lags[i]);
        } else {
            /* Nothing new is known of it. */
        }
        if (robot->lags[i] >= robot->config->limits.lag_ticks) {
            faults |= fault_of_side(i, JP_FAULT_STALLED_LEFT, JP_FAULT_STALLED_RIGHT);
        }
    }
    return faults;
}

/* The tick: states. */

static bool is_running(enum jp_four_wheel_robot_state state)
{
    return state == JP_FOUR_WHEEL_ROBOT_STANDING || state == JP_FOUR_WHEEL_ROBOT_DRIVING;
}

static bool are_stopped(const struct jp_wheels *wheels)
{
    bool are = true;

    for (int i = 0; i < (int)JP_WHEELS; i++) {
        are = are && wheels->speed[i] == 0;
    }
    return are;
}

static bool is_rest(const struct jp_twist *twist)
{
    return twist->x == 0 && twist->y == 0 && twist->turn_rate == 0;
}

static void set_state(struct jp_four_wheel_robot_internal *robot, enum jp_four_wheel_robot_state state)
{
    JP_STORE(&robot->shown.state, state);
}

/** What was ordered before counts no more. */
static void forget_orders(struct jp_four_wheel_robot_internal *robot)
{
    robot->orders_taken = jp_posted(&robot->orders);
    robot->shown.reference = (struct jp_twist){0, 0, 0};
}

static void fail(struct jp_four_wheel_robot_internal *robot, unsigned faults)
{
    robot->shown.faults |= (uint16_t)faults;
    forget_orders(robot);
    set_state(robot, JP_FOUR_WHEEL_ROBOT_FAULT);
}

static void switch_off(struct jp_four_wheel_robot_internal *robot)
{
    robot->shown.faults = 0;
    /* Another plausible frame must come. */
    robot->has_frame = robot->has_frame && robot->is_fresh;
    forget_orders(robot);
    set_state(robot, JP_FOUR_WHEEL_ROBOT_IDLE);
}

static void take_order(struct jp_four_wheel_robot_internal *robot)
{
    const uint8_t orders = jp_posted(&robot->orders);

    if (orders != robot->orders_taken) {
        robot->orders_taken = orders;
        robot->twist_age = 0;
        robot->shown.reference = robot->twists[orders & 1U];
    } else if (robot->twist_age >= robot->config->twist_ticks) {
        robot->shown.reference = (struct jp_twist){0, 0, 0};
    } else {
        robot->twist_age++;
    }
}

static void change_state(struct jp_four_wheel_robot_internal *robot, unsigned faults)
{
    const enum jp_four_wheel_robot_state state = robot->shown.state;

    if (jp_take(&robot->disable_requested)) {
        switch_off(robot);
    } else if (faults != 0U) {
        fail(robot, faults);
    } else if (state == JP_FOUR_WHEEL_ROBOT_IDLE && jp_posted(&robot->enable_requested) != 0U) {
        forget_orders(robot);
        set_state(robot, JP_FOUR_WHEEL_ROBOT_STANDING);
    } else if (is_running(state)) {
        take_order(robot);
    } else {
        /* It stays as it is. */
    }
    (void)jp_take(&robot->enable_requested);
}

/* The tick: wheels. */

/** Off, they are told where they are, so that nothing jumps when they are switched on. */
static void follow_wheels(struct jp_four_wheel_robot_internal *robot)
{
    for (int i = 0; i < (int)JP_WHEELS; i++) {
        robot->shown.wheels.angle[i] = jp_clamp32(robot->measured.angle[i], -robot->config->wheels.steering_limit,
                                                  robot->config->wheels.steering_limit);
        robot->shown.wheels.speed[i] = 0;
    }
}

static void lead_wheels(struct jp_four_wheel_robot_internal *robot)
{
    enum jp_steering steering;

    (void)jp_four_wheel_tick(&robot->config->wheels, &robot->shown.reference, &robot->shown.wheels, &steering);
    if (steering == JP_STEERING_STANDSTILL) {
        robot->shown.standstills = jp_one_more32(robot->shown.standstills);
    }
    if (is_running(robot->shown.state)) {
        const bool stands = is_rest(&robot->shown.reference) && are_stopped(&robot->shown.wheels);

        set_state(robot, stands ? JP_FOUR_WHEEL_ROBOT_STANDING : JP_FOUR_WHEEL_ROBOT_DRIVING);
    }
}

void jp_four_wheel_robot_control(struct jp_four_wheel_robot *self, enum jp_status read,
                                 const struct jp_four_wheel_sensors *sensors, struct jp_four_wheel_actuation *actuation)
{
    struct jp_four_wheel_robot_internal *robot = &self->internal;

    jp_sequence_begin(&robot->sequence);
    unsigned faults = take_frame(robot, read, sensors);

    /* Idle, before the first frame there is nothing to fail. */
    faults = robot->has_frame || is_running(robot->shown.state) ? faults | lag_faults(robot) : 0U;
    change_state(robot, faults);

    const enum jp_four_wheel_robot_state state = robot->shown.state;

    robot->was_controlled =
        is_running(state) || (state == JP_FOUR_WHEEL_ROBOT_FAULT && !are_stopped(&robot->shown.wheels));
    if (robot->was_controlled) {
        lead_wheels(robot);
    } else {
        follow_wheels(robot);
    }
    *actuation =
        (struct jp_four_wheel_actuation){.wheels = robot->shown.wheels, .enabled = robot->was_controlled ? 1U : 0U};
}

/* The rest of the tick. */

/** Of a motion, what goes along an axis: so much of what goes ahead, less so much of what goes to the left. */
static int64_t along_axis(jp_q31 of_ahead, jp_q31 of_left, int32_t ahead, int32_t left)
{
    return jp_round_shift64(jp_multiply(of_ahead, ahead) - jp_multiply(of_left, left), 31);
}

/** 2³¹ m on it begins from the other end: what a reset left may be anything. */
static int64_t moved(int64_t from, int64_t by)
{
    return (int64_t)((uint64_t)from + (uint64_t)by);
}

/** By the mean twist of so many ticks. */
static void integrate(struct jp_four_wheel_robot_internal *robot, uint32_t ticks)
{
    struct jp_four_wheel_odometry *odometry = &robot->shown.odometry;
    const int32_t rate = (int32_t)robot->config->tick_rate;
    jp_q24 slip;

    jp_four_wheel_forward(&robot->config->wheels, &robot->measured, &odometry->twist, &slip);

    const jp_phase turn = ticks * (jp_phase)jp_multiply(odometry->twist.turn_rate, robot->turn_per_rate);
    const jp_angle middle = jp_phase_angle(odometry->heading + (jp_phase)((int64_t)turn / 2));
    const jp_q31 cosine = jp_cos(middle);
    const jp_q31 sine = jp_sin(middle);
    /* Q32 of a tick */
    const int32_t ahead = jp_divide((int64_t)odometry->twist.x * 256, rate);
    const int32_t left = jp_divide((int64_t)odometry->twist.y * 256, rate);

    odometry->x = moved(odometry->x, (int64_t)ticks * along_axis(cosine, sine, ahead, left));
    odometry->y = moved(odometry->y, (int64_t)ticks * along_axis(sine, cosine, ahead, -left));
    odometry->heading += turn;
}

static void hand_on(struct jp_four_wheel_robot_internal *robot, const struct jp_four_wheel_piece *piece)
{
    const uint8_t head = robot->stretches_head;
    const uint8_t next = (uint8_t)((head + 1U) % JP_FOUR_WHEEL_STRETCHES);

    if (next == JP_LOAD_ACQUIRE(&robot->stretches_tail)) {
        robot->stretches_lost = jp_one_more32(robot->stretches_lost);
        return;
    }
    robot->stretches[head] = (struct jp_four_wheel_stretch){.piece = *piece, .energy = robot->meter.energy};
    JP_STORE_RELEASE(&robot->stretches_head, next);
}

/** Energy and pieces: each tick, by the last good frame where this one failed. */
static void keep_books(struct jp_four_wheel_robot_internal *robot)
{
    struct jp_four_wheel_piece piece;

    jp_bus_meter_update(&robot->meter, robot->good.bus_voltage, robot->good.bus_current);
    robot->shown.energy = robot->meter.energy;
    if (jp_four_wheel_trip_tick(&robot->trip, &robot->measured, 0, 0, &piece)) {
        hand_on(robot, &piece);
    }
}

void jp_four_wheel_robot_account(struct jp_four_wheel_robot *self)
{
    struct jp_four_wheel_robot_internal *robot = &self->internal;

    if (robot->is_fresh) {
        integrate(robot, robot->missed + 1U);
        robot->missed = 0;
    } else {
        robot->missed = jp_one_more16(robot->missed);
    }
    if (robot->has_frame) {
        keep_books(robot);
    }
    robot->shown.tick++;
    jp_sequence_end(&robot->sequence);
}

/* After a reset. */

void jp_four_wheel_robot_snapshot(const struct jp_four_wheel_robot *self, struct jp_four_wheel_snapshot *snapshot)
{
    const struct jp_four_wheel_robot_internal *robot = &self->internal;

    *snapshot = (struct jp_four_wheel_snapshot){.odometry = robot->shown.odometry,
                                                .wheels = robot->shown.wheels,
                                                .energy = robot->meter.energy,
                                                .tick_rate = robot->config->tick_rate,
                                                .count_speed = robot->config->count_speed,
                                                .ran = robot->was_controlled ? 1U : 0U};
}

static bool is_of(const struct jp_four_wheel_robot_config *config, const struct jp_four_wheel_snapshot *snapshot)
{
    bool is_possible =
        snapshot->ran == 1U && snapshot->tick_rate == config->tick_rate && snapshot->count_speed == config->count_speed;

    for (int i = 0; i < (int)JP_WHEELS; i++) {
        is_possible = is_possible && jp_absolute64(snapshot->wheels.angle[i]) <= config->wheels.steering_limit &&
                      jp_absolute64(snapshot->wheels.speed[i]) <= config->wheels.speed_max;
    }
    return is_possible;
}

bool jp_four_wheel_robot_resume(struct jp_four_wheel_robot *self, const struct jp_four_wheel_snapshot *snapshot)
{
    struct jp_four_wheel_robot_internal *robot = &self->internal;

    if (!is_of(robot->config, snapshot)) {
        return false;
    }
    robot->shown.odometry = snapshot->odometry;
    robot->shown.odometry.twist = (struct jp_twist){0, 0, 0};
    robot->shown.wheels = snapshot->wheels;
    robot->meter.energy = snapshot->energy;
    robot->shown.energy = snapshot->energy;
    set_state(robot, JP_FOUR_WHEEL_ROBOT_DRIVING);
    return true;
}

/* The background. */

enum jp_status jp_four_wheel_robot_enable(struct jp_four_wheel_robot *robot)
{
    if (robot == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (jp_four_wheel_robot_state_now(robot) != JP_FOUR_WHEEL_ROBOT_IDLE || !JP_LOAD(&robot->internal.has_frame)) {
        return JP_ERR_STATE;
    }
    jp_post(&robot->internal.enable_requested, 1);
    return JP_OK;
}

void jp_four_wheel_robot_disable(struct jp_four_wheel_robot *robot)
{
    jp_post(&robot->internal.enable_requested, 0);
    jp_post(&robot->internal.disable_requested, 1);
}

static bool is_twist(const struct jp_twist *twist)
{
    return jp_is_between(twist->x, -TWIST_MAX, TWIST_MAX) && jp_is_between(twist->y, -TWIST_MAX, TWIST_MAX) &&
           jp_is_between(twist->turn_rate, -TWIST_MAX, TWIST_MAX);
}

enum jp_status jp_four_wheel_robot_drive(struct jp_four_wheel_robot *robot, const struct jp_twist *twist)
{
    if (robot == NULL || twist == NULL || !is_twist(twist)) {
        return JP_ERR_ARGUMENT;
    }
    if (!is_running(jp_four_wheel_robot_state_now(robot))) {
        return JP_ERR_STATE;
    }
    const uint8_t orders = (uint8_t)(robot->internal.orders + 1U);

    robot->internal.twists[orders & 1U] = *twist;
    jp_post(&robot->internal.orders, orders);
    return JP_OK;
}

bool jp_four_wheel_robot_telemetry(const struct jp_four_wheel_robot *robot, struct jp_four_wheel_telemetry *telemetry)
{
    uint32_t begun;

    if (!jp_sequence_begin_copy(&robot->internal.sequence, &begun)) {
        return false;
    }
    *telemetry = robot->internal.shown;
    return jp_sequence_is_whole(&robot->internal.sequence, begun);
}

enum jp_four_wheel_robot_state jp_four_wheel_robot_state_now(const struct jp_four_wheel_robot *robot)
{
    return JP_LOAD(&robot->internal.shown.state);
}

bool jp_four_wheel_robot_take_stretch(struct jp_four_wheel_robot *robot, struct jp_four_wheel_stretch *stretch)
{
    const uint8_t tail = robot->internal.stretches_tail;

    if (tail == JP_LOAD_ACQUIRE(&robot->internal.stretches_head)) {
        return false;
    }
    *stretch = robot->internal.stretches[tail];
    JP_STORE_RELEASE(&robot->internal.stretches_tail, (uint8_t)((tail + 1U) % JP_FOUR_WHEEL_STRETCHES));
    return true;
}

uint32_t jp_four_wheel_robot_stretches_lost(const struct jp_four_wheel_robot *robot)
{
    return JP_LOAD(&robot->internal.stretches_lost);
}

const struct jp_four_wheel_sensors *jp_four_wheel_robot_good_frame(const struct jp_four_wheel_robot *robot)
{
    return robot->internal.has_frame ? &robot->internal.good : NULL;
}
