#include <joulepath/robot.h>

#include <joulepath/count.h>
#include <stddef.h>

#include "src/balancer/path_error.h"
#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/duty.h"
#include "src/base/request.h"
#include "src/base/sequence.h"
#include "src/energy/energy_terms.h"

/** Checks that all parts have one tick rate and one wheel radius. */
static enum jp_status check_relations(const struct jp_robot_config *config, const char **field)
{
    const uint32_t rate = config->estimator.tick_rate;

    if (config->metres_per_turn < JP_Q24(0.0625) || config->metres_per_turn > JP_Q24(4)) {
        return jp_config_refuse("metres_per_turn", field);
    }
    if (config->reference.tick_rate != rate || config->lqr.tick_rate != rate || config->meter.tick_rate != rate ||
        config->trajectory.tick_rate != rate) {
        return jp_config_refuse("estimator.tick_rate", field);
    }
    return JP_OK;
}

static enum jp_status check(const struct jp_robot_config *config, const char **field)
{
    const bool parts_fit =
        jp_estimator_check(&config->estimator, field) == JP_OK &&
        jp_reference_check(&config->reference, field) == JP_OK && jp_lqr_check(&config->lqr, field) == JP_OK &&
        jp_monitor_check(&config->monitor, field) == JP_OK && jp_meter_check(&config->meter, field) == JP_OK &&
        jp_segment_limits_check(&config->limits, NULL, field) == JP_OK &&
        jp_trajectory_check(&config->trajectory, field) == JP_OK;

    return parts_fit ? check_relations(config, field) : JP_ERR_CONFIG;
}

enum jp_status jp_robot_init(struct jp_robot *robot, const struct jp_robot_config *config, const char **field)
{
    if (robot == NULL || config == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }

    enum jp_status status = check(config, field);

    if (status != JP_OK) {
        return status;
    }
    *robot = (struct jp_robot){.internal = {.config = config}};
    jp_monitor_start(&robot->internal.monitor, &config->monitor);
    jp_meter_start(&robot->internal.meter, &config->meter);
    jp_lqr_start(&robot->internal.lqr, &config->lqr);
    return JP_OK;
}

static bool motors_run(enum jp_robot_state state)
{
    return state == JP_ROBOT_BALANCING || state == JP_ROBOT_DRIVING;
}

/* The tick. */

static JP_INLINE_FOR_SPEED void leave_trajectory(struct jp_robot_internal *robot)
{
    if (robot->trajectory != NULL) {
        robot->trajectory = NULL;
        robot->has_set_point = false;
        robot->set_point_is_new = false;
        jp_reference_leave_track(&robot->reference);
    }
}

static JP_INLINE_FOR_SPEED void stand(struct jp_robot_internal *robot)
{
    struct jp_tick_telemetry *telemetry = &robot->telemetry;

    telemetry->state = JP_ROBOT_BALANCING;
    telemetry->segment_ticks_left = 0;
    telemetry->command = (struct jp_motion){0, 0};
    jp_reference_apply(&robot->reference, &(struct jp_reference_step){0, 0, 0});
}

static JP_INLINE_FOR_SPEED void switch_off(struct jp_robot_internal *robot, enum jp_robot_state state)
{
    struct jp_tick_telemetry *telemetry = &robot->telemetry;

    telemetry->state = state;
    telemetry->segment_ticks_left = 0;
    telemetry->command = (struct jp_motion){0, 0};
    telemetry->voltages = (struct jp_voltages){0, 0, false};
    leave_trajectory(robot);
    jp_post(&robot->next_full, 0);
}

static void balance(struct jp_robot_internal *robot)
{
    struct jp_tick_telemetry *telemetry = &robot->telemetry;

    jp_reference_start(&robot->reference, &robot->config->reference, telemetry->motion.wheel, telemetry->motion.yaw);
    jp_lqr_restart(&robot->lqr);
    telemetry->segment = 0;
    telemetry->segments_ended = 0;
    robot->motor_faults = 0;
    jp_post(&robot->next_full, 0); /* a segment handed over while the robot switched off */
    telemetry->state = JP_ROBOT_BALANCING;
}

/** Motors on again after a reset: the reference slows down from the speed that the robot has. */
static void go_on(struct jp_robot_internal *robot, const struct jp_sensors *sensors)
{
    const struct jp_robot_config *config = robot->config;
    struct jp_motion_state *motion = &robot->telemetry.motion;

    jp_estimator_resume(&robot->estimator, &config->estimator, sensors, motion);
    balance(robot);
    jp_reference_coast(&robot->reference, &config->reference, motion->wheel_rate, motion->yaw_rate);
    robot->resuming = false;
}

static void start_motion(struct jp_robot_internal *robot, const struct jp_sensors *sensors)
{
    const struct jp_robot_config *config = robot->config;
    struct jp_motion_state *motion = &robot->telemetry.motion;

    jp_estimator_start(&robot->estimator, &config->estimator, sensors);
    robot->estimator.gyro_bias = robot->known_gyro_bias;
    jp_estimator_update(&robot->estimator, &config->estimator, sensors, motion);
    jp_odometry_start(&robot->odometry, config->metres_per_turn, motion);
    jp_reference_start(&robot->reference, &config->reference, motion->wheel, motion->yaw);
}

/** The first plausible frame. */
static void begin_motion(struct jp_robot_internal *robot, const struct jp_sensors *sensors)
{
    if (robot->resuming) {
        go_on(robot, sensors);
    } else {
        start_motion(robot, sensors);
    }
    robot->started = true;
}

static void count_segment(struct jp_robot_internal *robot, uint32_t ticks)
{
    robot->telemetry.segment = jp_one_more16(robot->telemetry.segment);
    robot->telemetry.segment_ticks_left = ticks;
    robot->segment_began = true;
}

/** The leg to which the set-point of this tick belongs; NULL: none was planned in time. */
static const struct jp_trajectory_leg *next_leg(const struct jp_robot_internal *robot)
{
    return robot->has_set_point ? jp_trajectory_next_leg(&robot->trajectory_drive) : NULL;
}

static void begin_leg(struct jp_robot_internal *robot, const struct jp_trajectory_leg *leg)
{
    robot->telemetry.command = (struct jp_motion){.speed = leg->speed};
    jp_path_error_begin_leg(&robot->path_error, leg->middle.wheel_rate);
    count_segment(robot,
                  JP_TICKS_PER_SET_POINT * (leg->begin.set_points + leg->middle.set_points + leg->end.set_points));
}

static void begin_segment(struct jp_robot_internal *robot)
{
    struct jp_tick_telemetry *telemetry = &robot->telemetry;
    const struct jp_next_segment *segment = &robot->next;

    if (telemetry->state == JP_ROBOT_BALANCING) {
        telemetry->segment = 0;
        telemetry->segments_ended = 0;
    }
    telemetry->state = JP_ROBOT_DRIVING;
    if (segment->trajectory != NULL) {
        if (robot->trajectory == NULL) {
            jp_path_error_start(&robot->path_error);
        }
        robot->trajectory = segment->trajectory;
        jp_trajectory_begin(&robot->trajectory_drive, segment->trajectory);
        begin_leg(robot, &segment->trajectory->legs[0]);
    } else {
        leave_trajectory(robot);
        jp_reference_apply(&robot->reference, &segment->step);
        telemetry->command = segment->motion;
        count_segment(robot, segment->ticks);
    }
    jp_post(&robot->next_full, 0);
}

static void become_idle(struct jp_robot_internal *robot)
{
    struct jp_tick_telemetry *telemetry = &robot->telemetry;

    /* Failed sensors left a pitch and a position that mean nothing. */
    if (telemetry->state == JP_ROBOT_FAULT) {
        robot->started = false;
    }
    telemetry->faults = 0;
    telemetry->state = JP_ROBOT_IDLE;
    jp_monitor_start(&robot->monitor, &robot->config->monitor);
}

/** Idle, fallen and fault: what leads out of them, and into fault. After a reset only a robot that has neither failed
 *  nor been disabled since balances on. */
static void rest(struct jp_robot_internal *robot, uint16_t faults)
{
    struct jp_tick_telemetry *telemetry = &robot->telemetry;

    if (jp_take(&robot->disable_requested)) {
        robot->resuming = false;
        if (telemetry->state != JP_ROBOT_IDLE) {
            become_idle(robot);
        }
    } else if (faults != 0U && telemetry->state == JP_ROBOT_IDLE) {
        robot->resuming = false;
        telemetry->faults |= faults;
        telemetry->state = JP_ROBOT_FAULT;
    } else {
        /* It stays as it is. */
    }
    if (jp_take(&robot->enable_requested) && telemetry->state == JP_ROBOT_IDLE && robot->monitor.started) {
        balance(robot);
    }
    (void)jp_take(&robot->stop_requested);
}

/** Balancing and driving: the reasons to switch off, then the hand-over of segments. */
static void drive(struct jp_robot_internal *robot, uint16_t sensor_faults)
{
    struct jp_tick_telemetry *telemetry = &robot->telemetry;
    const uint16_t faults = sensor_faults | robot->motor_faults;
    jp_q24 pitch = telemetry->motion.pitch;
    jp_q24 limit = robot->config->monitor.tilt_limit;

    if (jp_take(&robot->disable_requested)) {
        switch_off(robot, JP_ROBOT_IDLE);
        jp_monitor_start(&robot->monitor, &robot->config->monitor);
        return;
    }
    if (faults != 0U) {
        telemetry->faults |= faults;
        switch_off(robot, JP_ROBOT_FAULT);
        return;
    }
    if (pitch > limit || pitch < -limit) {
        switch_off(robot, JP_ROBOT_FALLEN);
        return;
    }

    bool stop = jp_take(&robot->stop_requested);
    bool ended = telemetry->state == JP_ROBOT_DRIVING && telemetry->segment_ticks_left == 0U;
    const struct jp_trajectory_leg *leg = ended ? next_leg(robot) : NULL;

    robot->segment_ended = ended;
    if (!stop && leg != NULL) {
        begin_leg(robot, leg);
    } else if (!stop && (ended || telemetry->state == JP_ROBOT_BALANCING) && jp_posted(&robot->next_full) != 0U) {
        begin_segment(robot);
    } else if (stop || ended) {
        leave_trajectory(robot);
        stand(robot);
    }
}

/** The reference's tick. */
static void follow(struct jp_robot_internal *robot)
{
    if (robot->has_set_point) {
        jp_reference_track(&robot->reference, &robot->set_point);
    } else {
        jp_reference_update(&robot->reference, &robot->config->reference);
    }
}

static void control(struct jp_robot_internal *robot, jp_q16 bus_voltage)
{
    struct jp_tick_telemetry *telemetry = &robot->telemetry;

    follow(robot);
    jp_lqr_update(&robot->lqr, &robot->config->lqr, &robot->reference, &telemetry->motion, bus_voltage,
                  &telemetry->voltages);
    if (telemetry->voltages.saturated) {
        telemetry->saturated_ticks = jp_one_more32(telemetry->saturated_ticks);
    }
    if (telemetry->segment_ticks_left > 0U) {
        telemetry->segment_ticks_left--;
    }
}

static JP_OWN_FRAME void actuate(const struct jp_voltages *voltages, jp_q16 bus_voltage, struct jp_actuation *actuation)
{
    const struct jp_bus bus = jp_bus_of(bus_voltage);

    *actuation = (struct jp_actuation){
        .duty_left = jp_duty(voltages->left, &bus),
        .duty_right = jp_duty(voltages->right, &bus),
        .enabled = 1,
    };
}

static void step(struct jp_robot_internal *robot, enum jp_status read, const struct jp_sensors *frame,
                 struct jp_actuation *actuation)
{
    struct jp_tick_telemetry *telemetry = &robot->telemetry;
    const struct jp_sensors *sensors = &robot->monitor.good;
    const uint16_t faults = jp_monitor_sensors(&robot->monitor, &robot->config->monitor, read, frame);

    robot->review_due = robot->monitor.started && robot->started;
    if (robot->review_due) {
        jp_estimator_update(&robot->estimator, &robot->config->estimator, sensors, &telemetry->motion);
    } else if (robot->monitor.started) {
        begin_motion(robot, sensors);
    }
    if (motors_run(telemetry->state)) {
        drive(robot, faults);
    } else {
        rest(robot, faults);
    }
    if (motors_run(telemetry->state)) {
        control(robot, sensors->bus_voltage);
        actuate(&telemetry->voltages, sensors->bus_voltage, actuation);
    } else {
        *actuation = (struct jp_actuation){.enabled = 0};
    }
}

void jp_robot_control(struct jp_robot *robot, enum jp_status read, const struct jp_sensors *sensors,
                      struct jp_actuation *actuation)
{
    jp_sequence_begin(&robot->internal.sequence);
    step(&robot->internal, read, sensors, actuation);
}

/* What is left of the tick. */

/** The interval that this tick's sample ended: the voltages that drove it, and the currents at its end. */
static void review_motors(struct jp_robot_internal *robot)
{
    const bool still_run = robot->motors_ran && motors_run(robot->telemetry.state);

    jp_meter_update(&robot->meter, &robot->applied, &robot->monitor.good);
    if (still_run) {
        robot->motor_faults = jp_monitor_motors(&robot->monitor, &robot->config->monitor, &robot->applied,
                                                robot->estimator.wheel.rate, robot->estimator.yaw.rate);
    }
}

static void account_segments(struct jp_robot_internal *robot)
{
    struct jp_tick_telemetry *telemetry = &robot->telemetry;

    if (robot->segment_ended) {
        telemetry->segment_energy_model = robot->meter.model - robot->segment_start_model;
        telemetry->segment_energy_battery = robot->meter.battery - robot->segment_start_battery;
        telemetry->segments_ended = jp_one_more16(telemetry->segments_ended);
    }
    if (robot->segment_began) {
        robot->segment_start_model = robot->meter.model;
        robot->segment_start_battery = robot->meter.battery;
    }
    robot->segment_ended = false;
    robot->segment_began = false;
}

/** What the next tick follows, which the bridges of this one need not wait for. */
static void look_ahead(struct jp_robot_internal *robot)
{
    const struct jp_trajectory_config *config = &robot->config->trajectory;

    if (robot->trajectory == NULL) {
        return;
    }
    if (robot->set_point_is_new) {
        jp_path_error_correct(&robot->path_error, config, &robot->set_point, &robot->telemetry.motion,
                              &robot->reference);
        robot->set_point_is_new = false;
    } else {
        robot->has_set_point = jp_trajectory_advance(&robot->trajectory_drive, config, &robot->set_point);
        robot->set_point_is_new = robot->has_set_point;
    }
}

void jp_robot_account(struct jp_robot *robot)
{
    struct jp_tick_telemetry *telemetry = &robot->internal.telemetry;

    if (robot->internal.started) {
        jp_odometry_update(&robot->internal.odometry, &telemetry->motion);
    }
    if (robot->internal.review_due) {
        review_motors(&robot->internal);
    }
    account_segments(&robot->internal);
    look_ahead(&robot->internal);
    robot->internal.reviewed = robot->internal.applied;
    robot->internal.applied = telemetry->voltages;
    robot->internal.motors_ran = motors_run(telemetry->state);
    telemetry->tick++;
    jp_sequence_end(&robot->internal.sequence);
}

void jp_robot_tick(struct jp_robot *robot, enum jp_status read, const struct jp_sensors *sensors,
                   struct jp_actuation *actuation)
{
    jp_robot_control(robot, read, sensors, actuation);
    jp_robot_account(robot);
}

void jp_robot_snapshot(const struct jp_robot *robot, struct jp_snapshot *snapshot)
{
    *snapshot = (struct jp_snapshot){
        .estimator = robot->internal.estimator,
        .odometry = robot->internal.odometry,
        .balancing = motors_run(robot->internal.telemetry.state),
    };
}

/* The background. */

void jp_robot_resume(struct jp_robot *robot, const struct jp_snapshot *snapshot)
{
    robot->internal.estimator = snapshot->estimator;
    robot->internal.odometry = snapshot->odometry;
    robot->internal.resuming = snapshot->balancing;
}

void jp_robot_know_gyro_bias(struct jp_robot *robot, int64_t bias)
{
    robot->internal.known_gyro_bias = bias;
}

static bool within(int32_t value, int32_t limit)
{
    return value >= -limit && value <= limit;
}

enum jp_status jp_robot_enable(struct jp_robot *robot)
{
    if (robot == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (jp_robot_state_now(robot) != JP_ROBOT_IDLE || !robot->internal.monitor.started ||
        !within(robot->internal.telemetry.motion.pitch, robot->internal.config->monitor.tilt_limit)) {
        return JP_ERR_STATE;
    }
    jp_post(&robot->internal.enable_requested, 1);
    return JP_OK;
}

void jp_robot_disable(struct jp_robot *robot)
{
    jp_post(&robot->internal.next_full, 0);
    jp_post(&robot->internal.enable_requested, 0);
    jp_post(&robot->internal.disable_requested, 1);
}

void jp_robot_stop(struct jp_robot *robot)
{
    jp_post(&robot->internal.next_full, 0);
    jp_post(&robot->internal.stop_requested, 1);
}

static bool can_be_driven(const struct jp_robot_config *config, const struct jp_segment_command *segment)
{
    return within(segment->motion.speed, config->limits.speed) && jp_segment_in_range(segment, 1);
}

enum jp_status jp_robot_drive(struct jp_robot *robot, const struct jp_segment_command *segment)
{
    if (robot == NULL || segment == NULL || !can_be_driven(robot->internal.config, segment)) {
        return JP_ERR_ARGUMENT;
    }
    if (!motors_run(jp_robot_state_now(robot))) {
        return JP_ERR_STATE;
    }
    if (jp_posted(&robot->internal.next_full) != 0U) {
        return JP_ERR_BUSY;
    }
    robot->internal.next = (struct jp_next_segment){
        .motion = segment->motion,
        .step = jp_reference_step_to(&robot->internal.config->reference, &segment->motion, segment->turn),
        .ticks = (uint32_t)(((uint64_t)(uint32_t)segment->duration * robot->internal.config->estimator.tick_rate +
                             (uint32_t)JP_Q16_ONE / 2U) >>
                            16),
    };
    jp_post(&robot->internal.next_full, 1);
    return JP_OK;
}

/** No leg is faster than the robot may be. */
static bool can_be_followed(const struct jp_robot_config *config, const struct jp_trajectory *trajectory)
{
    for (uint16_t i = 0; i < trajectory->count && i < trajectory->places; i++) {
        if (!within(trajectory->legs[i].speed, config->limits.speed)) {
            return false;
        }
    }
    return true;
}

enum jp_status jp_robot_drive_trajectory(struct jp_robot *robot, const struct jp_trajectory *trajectory)
{
    if (robot == NULL || trajectory == NULL || trajectory->legs == NULL || trajectory->count == 0U ||
        !can_be_followed(robot->internal.config, trajectory)) {
        return JP_ERR_ARGUMENT;
    }
    if (!motors_run(jp_robot_state_now(robot))) {
        return JP_ERR_STATE;
    }
    if (jp_posted(&robot->internal.next_full) != 0U) {
        return JP_ERR_BUSY;
    }
    robot->internal.next = (struct jp_next_segment){.trajectory = trajectory};
    jp_post(&robot->internal.next_full, 1);
    return JP_OK;
}

/** The distance that a balancing robot still has to roll to the place where it will stand, m. */
static jp_q24 distance_to_stand(const struct jp_robot *robot, const struct jp_telemetry *telemetry)
{
    jp_q24 turns = jp_round_shift((int64_t)(telemetry->target_wheel - telemetry->motion.wheel), 32);

    return telemetry->state == JP_ROBOT_BALANCING ? jp_q24_multiply(turns, robot->internal.config->metres_per_turn) : 0;
}

void jp_robot_predict_end(const struct jp_robot *robot, const struct jp_telemetry *telemetry, struct jp_point *position,
                          jp_angle *heading)
{
    int64_t tick_rate = robot->internal.config->estimator.tick_rate;
    int64_t ticks = telemetry->segment_ticks_left;
    jp_q24 left = jp_saturate32(ticks * telemetry->command.speed / tick_rate + distance_to_stand(robot, telemetry));
    jp_angle turned = jp_angle_from_radians(jp_saturate32(ticks * telemetry->command.turn_rate / tick_rate));
    jp_angle now = jp_phase_angle(telemetry->target_yaw);
    jp_angle mean = now + (jp_angle)((int32_t)turned / 2);

    position->x = jp_add(telemetry->position.x, jp_multiply_shift(left, jp_cos(mean), 39));
    position->y = jp_add(telemetry->position.y, jp_multiply_shift(left, jp_sin(mean), 39));
    *heading = now + turned;
}
