#include <joulepath/skid_robot.h>

#include <joulepath/count.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/duty.h"
#include "src/base/integer.h"
#include "src/base/request.h"
#include "src/base/sequence.h"
#include "src/skid_steer/skid_follow.h"

#define MOTION_MAX   JP_Q24(8)
#define DURATION_MAX JP_Q16(16384)

#define TWO_PI JP_Q24(6.283185307179586)

/** The heading that a command may have missed, rad: beyond it the robot does not make up for it. */
#define HEADING_ERROR_MAX JP_Q24(0.25)

#define IMU_FAULTS ((unsigned)JP_FAULT_IMU_RANGE | (unsigned)JP_FAULT_IMU_JUMP | (unsigned)JP_FAULT_IMU_FROZEN)

/** Frames of which anything else is suspected still tell of the wheels. */
#define WHEEL_SUSPICIONS ((unsigned)JP_FAULT_HARDWARE | (unsigned)JP_FAULT_ENCODER_JUMP)

/** The wheels can be controlled all the same. */
#define HOLDING_FAULTS                                                                                                 \
    (IMU_FAULTS | (unsigned)JP_FAULT_STALLED_LEFT | (unsigned)JP_FAULT_STALLED_RIGHT |                                 \
     (unsigned)JP_FAULT_WHEEL_IN_AIR | (unsigned)JP_FAULT_WHEELS_SPIN | (unsigned)JP_FAULT_SLOPE)

#define STALLED_FAULTS ((unsigned)JP_FAULT_STALLED_LEFT | (unsigned)JP_FAULT_STALLED_RIGHT)

/** Ticks from a request until the wheels slow down. */
#define REACTION_TICKS 4

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_skid_robot_config, member, low, high)

static enum jp_status check_own(const struct jp_skid_robot_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(limits.speed, 1, MOTION_MAX),
        FIELD(limits.acceleration, JP_Q24(0.01), JP_Q24(64)),
        FIELD(limits.turn_acceleration, JP_Q24(0.01), JP_Q24(64)),
        FIELD(burnt, 0, JP_Q16_ONE),
        FIELD(heading_gain, 0, JP_Q24(16)),
        FIELD(monitor.half_track, JP_Q16_ONE, JP_Q16_ONE),
    };
    const uint32_t rate = config->control.tick_rate;
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status == JP_OK &&
        (config->odometry.tick_rate != rate || config->meter.tick_rate != rate || config->path.tick_rate != rate)) {
        return jp_config_refuse("control.tick_rate", field);
    }
    return status;
}

static enum jp_status check(const struct jp_skid_robot_config *config, const char **field)
{
    const bool parts_fit =
        jp_skid_odometry_check(&config->odometry, field) == JP_OK &&
        jp_skid_control_check(&config->control, field) == JP_OK && jp_monitor_check(&config->monitor, field) == JP_OK &&
        jp_skid_monitor_check(&config->wheels, field) == JP_OK && jp_meter_check(&config->meter, field) == JP_OK;

    return parts_fit ? check_own(config, field) : JP_ERR_CONFIG;
}

/** Of a tick, rounded up; above 0. */
static jp_q24 step_of(jp_q24 acceleration, uint32_t tick_rate)
{
    const uint32_t change = ((uint32_t)acceleration + tick_rate - 1U) / tick_rate;

    return (jp_q24)change;
}

enum jp_status jp_skid_robot_init(struct jp_skid_robot *robot, const struct jp_skid_robot_config *config,
                                  const char **field)
{
    if (robot == NULL || config == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = check(config, field);

    if (status != JP_OK) {
        return status;
    }
    *robot = (struct jp_skid_robot){.internal = {.config = config}};
    robot->internal.wake_ticks = JP_SKID_WAKE_TICKS;
    robot->internal.braking = (struct jp_skid_next){
        .speed_step = step_of(config->limits.acceleration, config->control.tick_rate),
        .turn_step = step_of(config->limits.turn_acceleration, config->control.tick_rate),
    };
    robot->internal.command = robot->internal.braking;
    jp_skid_odometry_start(&robot->internal.odometry, &config->odometry, &(struct jp_sensors){0});
    jp_monitor_start(&robot->internal.monitor, &config->monitor);
    jp_skid_control_start(&robot->internal.control, &config->control, config->odometry.ratio);
    if (jp_path_drive_init(&robot->internal.follow.drive, &config->path, field) != JP_OK) {
        return JP_ERR_CONFIG;
    }
    jp_skid_monitor_start(&robot->internal.wheels, config->monitor.tilt_limit);
    jp_meter_start(&robot->internal.meter, &config->meter);
    return JP_OK;
}

void jp_skid_robot_know_gyro_scale(struct jp_skid_robot *robot, const struct jp_gyro_scale *scale)
{
    jp_skid_odometry_know_scale(&robot->internal.odometry, &robot->internal.config->odometry, scale);
}

static bool motors_run(enum jp_skid_robot_state state)
{
    return state == JP_SKID_ROBOT_STANDING || state == JP_SKID_ROBOT_DRIVING;
}

/* The tick: states. */

/** Goes on to a stand, and forgets what waits. */
static void give_up(struct jp_skid_robot_internal *robot)
{
    robot->command = robot->braking;
    jp_skid_follow_end(&robot->follow);
    jp_post(&robot->next_full, 0);
}

static void stand_still(struct jp_skid_robot_internal *robot)
{
    robot->reference = (struct jp_motion){0, 0};
    jp_skid_control_forget(&robot->control);
}

static void begin_to_stand(struct jp_skid_robot_internal *robot)
{
    give_up(robot); /* a command handed over while the robot switched off */
    jp_skid_control_forget(&robot->control);
    robot->state = JP_SKID_ROBOT_STANDING;
}

/** Begins or goes on with a fault; what was controlled stays so as long as the faults permit. */
static void fail(struct jp_skid_robot_internal *robot, unsigned faults)
{
    const bool controlled = motors_run(robot->state) || robot->holds;

    robot->faults |= (uint16_t)faults;
    robot->holds = controlled && (robot->faults & ~HOLDING_FAULTS) == 0U;
    robot->state = JP_SKID_ROBOT_FAULT;
    give_up(robot);
    if ((faults & STALLED_FAULTS) != 0U) {
        stand_still(robot);
    }
}

/** The last good frame stays: what is left of the tick still reads it. */
static void forget_suspicions(struct jp_skid_robot_internal *robot)
{
    const struct jp_sensors good = robot->monitor.good;

    jp_monitor_start(&robot->monitor, &robot->config->monitor);
    robot->monitor.good = good;
}

static void switch_off(struct jp_skid_robot_internal *robot)
{
    /* What failed left speeds that mean nothing. */
    if (robot->state == JP_SKID_ROBOT_FAULT) {
        robot->started = false;
    }
    robot->state = JP_SKID_ROBOT_IDLE;
    robot->faults = 0;
    robot->found = 0;
    robot->holds = false;
    give_up(robot);
    forget_suspicions(robot);
}

/** Idle and fault: what leads out of them, and into fault. */
static void rest(struct jp_skid_robot_internal *robot, unsigned faults)
{
    if (jp_take(&robot->disable_requested) && robot->state != JP_SKID_ROBOT_IDLE) {
        switch_off(robot);
    } else if (faults != 0U) {
        fail(robot, faults);
    } else {
        /* It stays as it is. */
    }
    if (jp_take(&robot->enable_requested) && robot->state == JP_SKID_ROBOT_IDLE) {
        begin_to_stand(robot);
    }
    (void)jp_take(&robot->stop_requested);
}

static bool is_at_rest(const struct jp_motion *motion)
{
    return motion->speed == 0 && motion->turn_rate == 0;
}

static void begin_command(struct jp_skid_robot_internal *robot)
{
    robot->command = robot->next;
    robot->commands++;
    robot->state = JP_SKID_ROBOT_DRIVING;
    if (robot->next.path != NULL) {
        jp_skid_follow_begin(&robot->follow, robot->next.path);
    } else {
        jp_skid_follow_end(&robot->follow);
    }
    jp_post(&robot->next_full, 0);
}

/** Standing and driving: the reasons to switch off, then the hand-over of commands. */
static void drive(struct jp_skid_robot_internal *robot, unsigned faults)
{
    if (jp_take(&robot->disable_requested)) {
        switch_off(robot);
        return;
    }
    if (faults != 0U) {
        fail(robot, faults);
        return;
    }
    if (jp_take(&robot->stop_requested)) {
        robot->command = robot->braking;
        jp_skid_follow_end(&robot->follow);
    } else if (jp_posted(&robot->next_full) != 0U) {
        begin_command(robot);
    } else {
        /* It goes on with what it does. */
    }
    if (jp_skid_follow_is_under_way(&robot->follow)) {
        return;
    }
    if (robot->command.ticks > 0U) {
        robot->command.ticks--;
    } else {
        robot->command = robot->braking;
        robot->state = is_at_rest(&robot->reference) ? JP_SKID_ROBOT_STANDING : JP_SKID_ROBOT_DRIVING;
    }
}

/* The tick: control. */

static JP_INLINE_FOR_SPEED int32_t limited_motion(int32_t rate)
{
    return jp_clamp32(rate, -MOTION_MAX, MOTION_MAX);
}

static jp_q24 approached(jp_q24 from, jp_q24 to, jp_q24 step)
{
    return jp_clamp32(to, from - step, from + step);
}

/** Turn rate that makes up for the heading that the command has missed. */
static jp_radians_per_s heading_correction(struct jp_skid_robot_internal *robot)
{
    const jp_radians_per_s turning = jp_q24_multiply(robot->odometry.turn_rate, TWO_PI);
    const jp_radians_per_s missed = jp_sub(robot->reference.turn_rate, turning);
    const jp_q24 error = jp_add(robot->heading_error, jp_multiply_shift(missed, robot->control.phase_per_rate, 32));

    robot->heading_error = jp_clamp32(error, -HEADING_ERROR_MAX, HEADING_ERROR_MAX);
    return jp_q24_multiply(robot->config->heading_gain, robot->heading_error);
}

/** Sine of the slope ahead, of those that the robot may drive: an accelerometer that fails says anything. */
static jp_q24 climb(const struct jp_skid_robot_internal *robot)
{
    return jp_clamp32(robot->wheels.rise, -robot->wheels.steepest, robot->wheels.steepest);
}

/** Speed of the treads, which creep as the slope pulls (skid_odometry.h). */
static jp_q24 tread_speed(const struct jp_skid_robot_internal *robot, jp_q24 rise)
{
    const struct jp_skid_odometry_config *config = &robot->config->odometry;
    const struct jp_motion *reference = &robot->reference;
    const jp_q24 yielding = jp_add(jp_share(jp_absolute32(reference->speed), config->creep, 24),
                                   jp_q24_multiply(jp_absolute32(reference->turn_rate), config->turn_creep_along));

    return jp_add(reference->speed, jp_share(yielding, rise, 24));
}

/** The reference's tick on a path: its errors are corrected there. */
static void guide_on_path(struct jp_skid_robot_internal *robot, struct jp_skid_set_point *set_point)
{
    const struct jp_skid_follow *follow = &robot->follow;
    const jp_q24 rise = climb(robot);

    robot->reference = follow->motion;
    robot->acceleration = follow->acceleration;
    *set_point = (struct jp_skid_set_point){
        .speed = tread_speed(robot, rise),
        .turn_rate = robot->reference.turn_rate,
        .acceleration = follow->at.acceleration,
        .turn_acceleration = follow->at.turn_acceleration,
        .rise = rise,
    };
}

/** The reference's tick to a commanded motion. */
static void guide_to_command(struct jp_skid_robot_internal *robot, struct jp_skid_set_point *set_point)
{
    const struct jp_skid_next *command = &robot->command;
    const struct jp_motion before = robot->reference;
    const int32_t rate = (int32_t)robot->config->control.tick_rate;
    const jp_q24 rise = climb(robot);
    jp_radians_per_s correction = 0;

    robot->reference.speed = approached(before.speed, command->motion.speed, command->speed_step);
    robot->reference.turn_rate = approached(before.turn_rate, command->motion.turn_rate, command->turn_step);
    robot->acceleration = (robot->reference.speed - before.speed) * rate;
    if (robot->state == JP_SKID_ROBOT_DRIVING && !is_at_rest(&robot->reference)) {
        correction = heading_correction(robot);
    } else {
        robot->heading_error = 0;
    }
    *set_point = (struct jp_skid_set_point){
        .speed = tread_speed(robot, rise),
        .turn_rate = limited_motion(robot->reference.turn_rate + correction),
        .acceleration = robot->acceleration,
        .turn_acceleration = (robot->reference.turn_rate - before.turn_rate) * rate,
        .rise = rise,
    };
}

static void guide(struct jp_skid_robot_internal *robot, struct jp_skid_set_point *set_point)
{
    if (jp_skid_follow_is_under_way(&robot->follow)) {
        guide_on_path(robot, set_point);
    } else {
        guide_to_command(robot, set_point);
    }
}

static void set_duties(const struct jp_skid_robot_internal *robot, struct jp_actuation *actuation)
{
    const struct jp_bus bus = jp_bus_of(robot->bus_voltage);

    actuation->duty_left = jp_duty(robot->voltages.left, &bus);
    actuation->duty_right = jp_duty(robot->voltages.right, &bus);
}

static void control_wheels(struct jp_skid_robot_internal *robot, struct jp_actuation *actuation)
{
    struct jp_skid_set_point set_point;

    robot->bus_voltage = robot->monitor.good.bus_voltage;
    guide(robot, &set_point);
    jp_skid_control_update(&robot->control, &robot->config->control, &set_point, robot->bus_voltage, &robot->voltages);
    if (robot->voltages.saturated) {
        robot->saturated_ticks = jp_one_more32(robot->saturated_ticks);
    }
    set_duties(robot, actuation);
}

/** Brakes by the voltages that the motion takes: shorted at speed the motors could tip the robot over. */
static void slow_down(struct jp_skid_robot_internal *robot, struct jp_actuation *actuation)
{
    struct jp_skid_set_point set_point;

    guide(robot, &set_point);
    jp_skid_control_blindly(&robot->control, &robot->config->control, &set_point, robot->bus_voltage, &robot->voltages);
    set_duties(robot, actuation);
}

/** Bridges off; in the end the reference is what the wheels do. */
static void wake(struct jp_skid_robot_internal *robot, struct jp_actuation *actuation)
{
    const struct jp_skid_control *control = &robot->control;
    const jp_turns_per_s left = control->sides[JP_SKID_LEFT].rate / 2;
    const jp_turns_per_s right = control->sides[JP_SKID_RIGHT].rate / 2;

    robot->wake_ticks--;
    if (robot->wake_ticks == 0U && robot->started) {
        robot->bus_voltage = robot->monitor.good.bus_voltage;
        robot->reference = (struct jp_motion){
            .speed = limited_motion(jp_q24_divide(left + right, robot->config->control.turns_per_metre)),
            .turn_rate = limited_motion(jp_q24_divide(right - left, control->spread)),
        };
    }
    robot->voltages = (struct jp_voltages){0, 0, false};
    *actuation = (struct jp_actuation){.enabled = 0};
}

/** Both motors shorted. */
static void short_motors(struct jp_skid_robot_internal *robot, struct jp_actuation *actuation)
{
    robot->acceleration = 0;
    robot->voltages = (struct jp_voltages){0, 0, false};
    actuation->duty_left = 0;
    actuation->duty_right = 0;
}

static void measure(struct jp_skid_robot_internal *robot, const struct jp_sensors *frame)
{
    struct jp_sensors *good = &robot->monitor.good;

    /* The monitor drops the whole frame: wheels that turn would seem to stand. */
    if (robot->monitor.suspected != 0U && (robot->monitor.suspected & WHEEL_SUSPICIONS) == 0U) {
        good->encoder_left = frame->encoder_left;
        good->encoder_right = frame->encoder_right;
    }
    jp_skid_control_measure(&robot->control, &robot->config->control, good->encoder_left, good->encoder_right);
}

static void step(struct jp_skid_robot_internal *robot, enum jp_status read, const struct jp_sensors *frame,
                 struct jp_actuation *actuation)
{
    const unsigned seen = jp_monitor_sensors(&robot->monitor, &robot->config->monitor, read, frame);
    const unsigned faults = seen | robot->found;

    measure(robot, frame);
    if (motors_run(robot->state)) {
        drive(robot, faults);
    } else {
        rest(robot, faults);
    }
    robot->reviewed = robot->controlled;
    robot->controlled = motors_run(robot->state) || robot->holds;
    actuation->enabled = 1;
    if (robot->controlled) {
        control_wheels(robot, actuation);
    } else if (robot->wake_ticks > 0U) {
        wake(robot, actuation);
    } else if (!is_at_rest(&robot->reference)) {
        slow_down(robot, actuation);
    } else {
        short_motors(robot, actuation);
    }
}

void jp_skid_robot_control(struct jp_skid_robot *robot, enum jp_status read, const struct jp_sensors *sensors,
                           struct jp_actuation *actuation)
{
    jp_sequence_begin(&robot->internal.sequence);
    step(&robot->internal, read, sensors, actuation);
}

/* What is left of the tick. */

/** The interval that this tick's sample ended: the voltages that drove it, and the currents at its end. */
static uint16_t review_motors(struct jp_skid_robot_internal *robot)
{
    const struct jp_skid_side *sides = robot->control.sides;
    const jp_turns_per_s left = sides[JP_SKID_LEFT].rate / 2;
    const jp_turns_per_s right = sides[JP_SKID_RIGHT].rate / 2;

    return jp_monitor_motors(&robot->monitor, &robot->config->monitor, &robot->applied, left + right, right - left);
}

static uint16_t review_wheels(struct jp_skid_robot_internal *robot)
{
    const struct jp_sensors *sensors = &robot->monitor.good;
    const struct jp_skid_motion motion = {
        .control = &robot->control,
        .current = {sensors->current_left, sensors->current_right},
        .turn_rate = robot->odometry.turn_rate,
        .steering = robot->odometry.steering_ratio,
        .straight = robot->reference.turn_rate == 0,
    };

    return jp_skid_monitor_wheels(&robot->wheels, &robot->config->wheels, &motion);
}

/** Half of the checks in each tick. What wheels do in a fault names no other one. */
static void review(struct jp_skid_robot_internal *robot)
{
    const bool under_control = robot->controlled && robot->reviewed;
    unsigned found = 0;

    if ((robot->tick & 1U) == 0U) {
        jp_meter_burn(&robot->meter, robot->config->meter.motor_resistance, robot->config->burnt, &robot->applied,
                      &robot->monitor.good);
        /* Currents of a frame that was dropped tell nothing of the voltages. */
        found = under_control && robot->monitor.implausible_ticks == 0U ? review_motors(robot) : 0U;
        jp_skid_control_steer(&robot->control, &robot->config->control, robot->odometry.steering_ratio);
    } else {
        const uint16_t steep =
            jp_skid_monitor_ground(&robot->wheels, &robot->config->wheels, &robot->monitor.good, robot->acceleration);

        if (under_control && motors_run(robot->state)) {
            found = (unsigned)steep | (unsigned)review_wheels(robot);
        }
    }
    robot->found = (uint16_t)found;
}

/** After the first plausible frame. */
static void begin(struct jp_skid_robot_internal *robot)
{
    const struct jp_sensors *sensors = &robot->monitor.good;

    robot->not_counted[JP_SKID_LEFT] = sensors->encoder_left - robot->counted[JP_SKID_LEFT];
    robot->not_counted[JP_SKID_RIGHT] = sensors->encoder_right - robot->counted[JP_SKID_RIGHT];
    jp_skid_control_count_from(&robot->control, sensors->encoder_left, sensors->encoder_right);
    robot->wake_ticks = JP_SKID_WAKE_TICKS;
    robot->started = true;
}

/** Not in a fault, whose frames may tell anything. */
static void reckon(struct jp_skid_robot_internal *robot)
{
    struct jp_sensors sensors = robot->monitor.good;

    if (robot->state != JP_SKID_ROBOT_FAULT) {
        sensors.encoder_left -= robot->not_counted[JP_SKID_LEFT];
        sensors.encoder_right -= robot->not_counted[JP_SKID_RIGHT];
        robot->counted[JP_SKID_LEFT] = sensors.encoder_left;
        robot->counted[JP_SKID_RIGHT] = sensors.encoder_right;
        jp_skid_odometry_update(&robot->odometry, &robot->config->odometry, &sensors);
    }
}

void jp_skid_robot_account(struct jp_skid_robot *robot)
{
    struct jp_skid_robot_internal *internal = &robot->internal;

    if (internal->started) {
        reckon(internal);
        jp_skid_follow_work(&internal->follow, &internal->odometry, &internal->config->odometry);
        jp_meter_update_battery(&internal->meter, &internal->applied, &internal->monitor.good);
        review(internal);
    } else if (internal->monitor.started) {
        begin(internal);
    } else {
        /* There is nothing to account for. */
    }
    internal->applied = internal->voltages;
    internal->tick++;
    jp_sequence_end(&internal->sequence);
}

void jp_skid_robot_tick(struct jp_skid_robot *robot, enum jp_status read, const struct jp_sensors *sensors,
                        struct jp_actuation *actuation)
{
    jp_skid_robot_control(robot, read, sensors, actuation);
    jp_skid_robot_account(robot);
}

/* The background. */

static bool is_awake(const struct jp_skid_robot_internal *robot)
{
    return robot->started && robot->wake_ticks == 0U;
}

enum jp_status jp_skid_robot_enable(struct jp_skid_robot *robot)
{
    if (robot == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const struct jp_skid_robot_internal *internal = &robot->internal;

    if (jp_skid_robot_state_now(robot) != JP_SKID_ROBOT_IDLE || !is_awake(internal) || !internal->monitor.started ||
        jp_skid_monitor_is_steep(&internal->wheels, &internal->config->wheels)) {
        return JP_ERR_STATE;
    }
    jp_post(&robot->internal.enable_requested, 1);
    return JP_OK;
}

void jp_skid_robot_disable(struct jp_skid_robot *robot)
{
    jp_post(&robot->internal.next_full, 0);
    jp_post(&robot->internal.enable_requested, 0);
    jp_post(&robot->internal.disable_requested, 1);
}

void jp_skid_robot_stop(struct jp_skid_robot *robot)
{
    jp_post(&robot->internal.next_full, 0);
    jp_post(&robot->internal.stop_requested, 1);
}

static bool is_command(const struct jp_skid_limits *limits, const struct jp_skid_command *command)
{
    return jp_is_between(command->motion.speed, -MOTION_MAX, MOTION_MAX) &&
           jp_is_between(command->motion.turn_rate, -MOTION_MAX, MOTION_MAX) &&
           jp_is_between(command->acceleration, 0, limits->acceleration) &&
           jp_is_between(command->turn_acceleration, 0, limits->turn_acceleration) &&
           jp_is_between(command->duration, 1, DURATION_MAX);
}

/** No tread is faster than it may be: compared as turns of a wheel. */
static bool can_be_driven(const struct jp_skid_robot_internal *robot, const struct jp_motion *motion)
{
    const struct jp_skid_control_config *config = &robot->config->control;
    const int64_t ahead = jp_multiply(jp_absolute32(motion->speed), config->turns_per_metre);
    const int64_t across = jp_multiply(jp_absolute32(motion->turn_rate), JP_LOAD(&robot->control.spread));

    return ahead + across <= jp_multiply(robot->config->limits.speed, config->turns_per_metre);
}

static jp_q24 step_or(jp_q24 acceleration, jp_q24 otherwise, uint32_t tick_rate)
{
    return acceleration == 0 ? otherwise : step_of(acceleration, tick_rate);
}

enum jp_status jp_skid_robot_drive(struct jp_skid_robot *robot, const struct jp_skid_command *command)
{
    if (robot == NULL || command == NULL || !is_command(&robot->internal.config->limits, command)) {
        return JP_ERR_ARGUMENT;
    }
    if (!motors_run(jp_skid_robot_state_now(robot))) {
        return JP_ERR_STATE;
    }
    if (!can_be_driven(&robot->internal, &command->motion)) {
        return JP_ERR_INFEASIBLE;
    }

    const uint32_t tick_rate = robot->internal.config->control.tick_rate;
    const uint64_t ticks = ((uint64_t)(uint32_t)command->duration * tick_rate + (uint32_t)JP_Q16_ONE / 2U) >> 16;

    jp_post(&robot->internal.next_full, 0);
    robot->internal.next = (struct jp_skid_next){
        .motion = command->motion,
        .speed_step = step_or(command->acceleration, robot->internal.braking.speed_step, tick_rate),
        .turn_step = step_or(command->turn_acceleration, robot->internal.braking.turn_step, tick_rate),
        .ticks = (uint32_t)ticks,
    };
    jp_post(&robot->internal.next_full, 1);
    return JP_OK;
}

enum jp_status jp_skid_robot_follow(struct jp_skid_robot *robot, const struct jp_lattice_path *path)
{
    if (robot == NULL || path == NULL || path->count == 0U) {
        return JP_ERR_ARGUMENT;
    }
    if (jp_skid_robot_state_now(robot) != JP_SKID_ROBOT_STANDING) {
        return JP_ERR_STATE;
    }
    jp_post(&robot->internal.next_full, 0);
    robot->internal.next = (struct jp_skid_next){.path = path};
    jp_post(&robot->internal.next_full, 1);
    return JP_OK;
}

jp_q24 jp_skid_robot_stopping_distance(const struct jp_skid_robot_config *config, jp_q24 speed)
{
    const jp_q24 size = jp_absolute32(speed);
    const jp_q24 braking =
        jp_divide(jp_multiply(size, size) / 8 * 9, jp_add(config->limits.acceleration, config->limits.acceleration));
    const jp_q24 reacting = jp_divide((int64_t)size * REACTION_TICKS, (int32_t)config->control.tick_rate);

    return jp_add(braking, reacting);
}
