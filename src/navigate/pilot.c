#include <joulepath/pilot.h>
#include <stddef.h>

#include "src/balancer/robot_route.h"
#include "src/base/plane.h"

/* The next plan begins this long before the present segment ends: s⁻¹. */
#define PLAN_LEAD_RATE 5U

/* Standard deviation of what a leg takes when it is planned anew in mid-drive, about what it was to take before, as a
 * share: with it 95 % of 400 trips of courier24 (jp-trip, seeds 5 000 to 5 399) end within 1.96 deviations. */
#define REPLAN_DEVIATION 0.0047f

static bool motors_run(enum jp_robot_state state)
{
    return state == JP_ROBOT_BALANCING || state == JP_ROBOT_DRIVING;
}

static const char *missing_field(const struct jp_pilot_config *config)
{
    if (config->model == NULL) {
        return "model";
    }
    if (config->horizon == NULL) {
        return "horizon";
    }
    if (config->learning == NULL) {
        return "learning";
    }
    if (config->legs == NULL) {
        return "legs";
    }
    return config->leg_count == 0U || config->leg_count > JP_ROUTE_LEGS_MAX ? "leg_count" : NULL;
}

static enum jp_status check(const struct jp_pilot_config *config, const struct jp_robot *robot, const char **field)
{
    enum jp_status status;

    *field = missing_field(config);
    if (*field != NULL) {
        return JP_ERR_CONFIG;
    }
    status = jp_energy_model_check(config->model, field);

    if (status == JP_OK) {
        status = jp_horizon_check(config->horizon, field);
    }
    if (status == JP_OK) {
        status = jp_learning_check(config->learning, field);
    }
    if (status == JP_OK) {
        status = jp_segment_limits_check(&jp_robot_configuration(robot)->limits, config->model, field);
    }
    return status;
}

enum jp_status jp_pilot_init(struct jp_pilot *pilot, const struct jp_pilot_config *config, struct jp_robot *robot,
                             const char **field)
{
    if (pilot == NULL || config == NULL || robot == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = check(config, robot, field);

    if (status == JP_OK) {
        *pilot = (struct jp_pilot){.config = *config, .internal = {.robot = robot, .model = *config->model}};
        jp_learner_start(&pilot->learner, config->learning, config->model, config->horizon);
        jp_drive_watch_start(&pilot->internal.watch, &pilot->learner,
                             jp_robot_configuration(robot)->estimator.tick_rate, config->meter == JP_PILOT_BATTERY);
    }
    return status;
}

/* The phase changes here alone. A pilot that rests waits for nothing, and what was asked is answered. */
static void enter(struct jp_pilot *pilot, enum jp_pilot_phase phase)
{
    pilot->phase = phase;
    if (phase == JP_PILOT_RESTING) {
        pilot->internal.is_waiting = false;
        if (pilot->internal.question == JP_PILOT_ASKED) {
            pilot->internal.question = JP_PILOT_ANSWERED;
        }
    }
}

/* Ends a route, or answers what was asked. */
static void rest(struct jp_pilot *pilot, enum jp_status status)
{
    pilot->status = status;
    enter(pilot, JP_PILOT_RESTING);
}

/* Learning */

/* Follows what the robot does, and learns from each segment that ended. False: one was cut short, by a fall, a fault or
 * somebody's jp_robot_stop(). */
static bool watch(struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    const bool drove = pilot->internal.watch.driving;

    if (jp_drive_watch_update(&pilot->internal.watch, telemetry, pilot->battery_flags, pilot->current_findings)) {
        pilot->internal.is_waiting = false;
    }
    pilot->learned = pilot->internal.watch.learned;
    pilot->segments_learned_from = pilot->internal.watch.learned_from;
    return !drove || pilot->internal.watch.driving || pilot->internal.watch.evidence != JP_EVIDENCE_INCOMPLETE;
}

/* Planning */

/* What the segments of the plan take. */
static enum jp_status expect(const struct jp_pilot *pilot, struct jp_forecast *forecast)
{
    struct jp_energy_start start = pilot->next.start;
    struct jp_forecast_sum sum = {0};
    enum jp_status status = JP_OK;

    for (unsigned k = 0; k < pilot->route.length && status == JP_OK; k++) {
        status = jp_forecast_add(&pilot->learner, &sum, &start, &pilot->config.legs[k].segment.command);
    }
    return status == JP_OK ? jp_forecast_total(&pilot->learner, &sum, forecast) : status;
}

/* Each leg but the first will be planned anew from where the robot is by then. */
static enum jp_status foresee(struct jp_pilot *pilot)
{
    const enum jp_status status = expect(pilot, &pilot->forecast);

    if (status == JP_OK) {
        const float leg = (float)pilot->forecast.energy / (float)pilot->route.length;
        const float replanned = REPLAN_DEVIATION * leg;
        const float deviation = (float)pilot->forecast.deviation;

        pilot->forecast.deviation = (jp_q16)jp_plane_square_root(
            deviation * deviation + (float)(pilot->route.length - 1U) * replanned * replanned);
    }
    return status;
}

static enum jp_status begin_plan(struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    const struct jp_pilot_config *config = &pilot->config;
    const struct jp_robot_config *robot = jp_robot_configuration(pilot->internal.robot);
    const struct jp_route_config route = {.model = &pilot->internal.model,
                                          .horizon = config->horizon,
                                          .limits = &robot->limits,
                                          .yaw_bandwidth = robot->reference.yaw_bandwidth,
                                          .legs = config->legs,
                                          .leg_count = config->leg_count};
    const char *field;
    struct jp_point point;
    jp_angle heading;

    (void)jp_drive_watch_next_start(&pilot->internal.watch, telemetry, &pilot->next.start);
    jp_robot_predict_end(pilot->internal.robot, telemetry, &point, &heading);
    jp_learner_model(&pilot->learner, &pilot->internal.model);
    pilot->model_version = pilot->learner.state.version;
    enter(pilot, JP_PILOT_PLANNING);
    (void)jp_route_init(&pilot->route, &route, &field);
    return jp_route_start(&pilot->route, &point, heading, &pilot->next.start,
                          &pilot->internal.targets[pilot->targets_planned],
                          (uint16_t)(pilot->internal.target_count - pilot->targets_planned));
}

static enum jp_status hand_over(struct jp_pilot *pilot)
{
    pilot->next.command = pilot->config.legs[0].segment.command;
    pilot->targets_planned++;
    enter(pilot, JP_PILOT_DRIVING);
    pilot->internal.is_waiting = true;
    jp_drive_watch_command(&pilot->internal.watch, &pilot->next.command);
    return jp_robot_drive(pilot->internal.robot, &pilot->next.command);
}

static enum jp_status work_on_plan(struct jp_pilot *pilot)
{
    enum jp_status status = jp_route_work(&pilot->route);

    if (status == JP_WORKING) {
        return JP_OK;
    }
    if (status == JP_OK) {
        status = foresee(pilot);
    }
    if (pilot->internal.question == JP_PILOT_ASKED) {
        rest(pilot, status);
        return status;
    }
    return status == JP_OK ? hand_over(pilot) : status;
}

/* Nothing waits for the robot, and the present segment nears its end. */
static bool plan_is_due(const struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    const uint32_t tick_rate = jp_robot_configuration(pilot->internal.robot)->estimator.tick_rate;

    return !pilot->internal.is_waiting && telemetry->segment_ticks_left <= tick_rate / PLAN_LEAD_RATE;
}

static enum jp_status go_on(struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    if (pilot->phase == JP_PILOT_PLANNING) {
        return work_on_plan(pilot);
    }
    if (pilot->targets_planned == pilot->internal.target_count) {
        if (!pilot->internal.is_waiting && !pilot->internal.watch.driving) {
            rest(pilot, JP_OK);
        }
        return JP_OK;
    }
    return plan_is_due(pilot, telemetry) ? begin_plan(pilot, telemetry) : JP_OK;
}

enum jp_status jp_pilot_work(struct jp_pilot *pilot)
{
    struct jp_telemetry telemetry;

    if (pilot == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (!jp_robot_telemetry(pilot->internal.robot, &telemetry)) {
        return pilot->status;
    }

    const bool drives_as_told = watch(pilot, &telemetry) && motors_run(telemetry.state);

    if (pilot->phase != JP_PILOT_RESTING) {
        const enum jp_status status = drives_as_told ? go_on(pilot, &telemetry) : JP_ERR_STATE;

        if (status != JP_OK) {
            rest(pilot, status);
        }
    }
    return pilot->status;
}

/* Requests */

static enum jp_status request(const struct jp_pilot *pilot, const struct jp_point *targets, uint16_t count)
{
    if (pilot == NULL || targets == NULL || count == 0U) {
        return JP_ERR_ARGUMENT;
    }
    return motors_run(jp_robot_state_now(pilot->internal.robot)) ? JP_OK : JP_ERR_STATE;
}

static void accept(struct jp_pilot *pilot, const struct jp_point *targets, uint16_t count)
{
    pilot->internal.targets = targets;
    pilot->internal.target_count = count;
    pilot->targets_planned = 0;
    pilot->status = JP_OK;
    enter(pilot, JP_PILOT_DRIVING);
}

enum jp_status jp_pilot_follow(struct jp_pilot *pilot, const struct jp_point *targets, uint16_t count)
{
    const enum jp_status status = request(pilot, targets, count);

    if (status == JP_OK) {
        pilot->internal.question = JP_PILOT_NOTHING_ASKED;
        accept(pilot, targets, count);
    }
    return status;
}

enum jp_status jp_pilot_ask(struct jp_pilot *pilot, const struct jp_point *targets, uint16_t count)
{
    const enum jp_status status = request(pilot, targets, count);

    if (status != JP_OK) {
        return status;
    }
    if (pilot->phase != JP_PILOT_RESTING || pilot->internal.watch.driving) {
        return JP_ERR_STATE;
    }
    if (count > pilot->config.leg_count) {
        return JP_ERR_MEMORY;
    }
    pilot->internal.question = JP_PILOT_ASKED;
    accept(pilot, targets, count);
    return JP_OK;
}

enum jp_status jp_pilot_answer(const struct jp_pilot *pilot, struct jp_forecast *forecast)
{
    if (pilot == NULL || forecast == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (pilot->internal.question == JP_PILOT_NOTHING_ASKED) {
        return JP_ERR_NO_PLAN;
    }
    if (pilot->internal.question == JP_PILOT_ASKED) {
        return JP_WORKING;
    }
    *forecast = pilot->forecast;
    return pilot->status;
}

void jp_pilot_stop(struct jp_pilot *pilot)
{
    if (pilot->internal.question == JP_PILOT_ASKED) {
        pilot->internal.question = JP_PILOT_NOTHING_ASKED;
    }
    rest(pilot, JP_OK);
    jp_robot_stop(pilot->internal.robot);
}
