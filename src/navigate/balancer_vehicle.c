#include <joulepath/balancer_vehicle.h>

#include <stddef.h>

#include "src/base/point.h"

/** A stand: the reference is slower than so many m/s and turn/s, and the robot than so many m/s. */
#define REFERENCE_SPEED_MAX     JP_Q24(0.005)
#define REFERENCE_TURN_RATE_MAX JP_Q24(0.002)
#define ROBOT_SPEED_MAX         JP_Q24(0.03)

/** Time constants of the shaped heading after which a turn has decayed to 1/2 000. */
#define TURN_TIME_CONSTANTS 10

static struct jp_balancer_vehicle *balancer_of(void *context)
{
    return context;
}

static struct jp_robot *robot_of(const struct jp_balancer_vehicle *balancer)
{
    return balancer->pilot->internal.robot;
}

static const struct jp_robot_config *config_of(const struct jp_balancer_vehicle *balancer)
{
    return jp_robot_configuration(robot_of(balancer));
}

static bool is_within(int32_t value, int32_t limit)
{
    return value >= -limit && value <= limit;
}

static bool is_still(const struct jp_balancer_vehicle *balancer, const struct jp_telemetry *telemetry)
{
    const jp_q24 turns_per_metre = config_of(balancer)->trajectory.turns_per_metre;

    return telemetry->state == JP_ROBOT_BALANCING &&
           is_within(telemetry->reference_wheel_rate, jp_q24_multiply(REFERENCE_SPEED_MAX, turns_per_metre)) &&
           is_within(telemetry->motion.wheel_rate, jp_q24_multiply(ROBOT_SPEED_MAX, turns_per_metre)) &&
           is_within(telemetry->reference_yaw_rate, REFERENCE_TURN_RATE_MAX);
}

static enum jp_vehicle_phase phase_of(const struct jp_balancer_vehicle *balancer, const struct jp_telemetry *telemetry,
                                      bool waits)
{
    if (telemetry->state != JP_ROBOT_BALANCING && telemetry->state != JP_ROBOT_DRIVING) {
        return JP_VEHICLE_OFF;
    }
    return waits || balancer->pilot->phase != JP_PILOT_RESTING || !is_still(balancer, telemetry) ? JP_VEHICLE_MOVING
                                                                                                 : JP_VEHICLE_STANDING;
}

/** By the meter that the pilot learns from. */
static jp_q16 spent(const struct jp_balancer_vehicle *balancer, const struct jp_telemetry *telemetry)
{
    const struct jp_pilot_config *config = &balancer->pilot->config;
    const jp_energy energy = config->meter == JP_PILOT_BATTERY ? telemetry->energy_battery : telemetry->energy_model;

    return jp_energy_to_wrapping_q16(energy, config->model->unit_exponent);
}

static void look(void *context, struct jp_vehicle_view *view)
{
    const struct jp_balancer_vehicle *balancer = balancer_of(context);
    const bool waits = jp_robot_has_next(robot_of(balancer));
    struct jp_telemetry telemetry;

    if (jp_robot_telemetry(robot_of(balancer), &telemetry)) {
        view->phase = phase_of(balancer, &telemetry, waits);
        view->position = telemetry.position;
        view->heading = jp_phase_angle(telemetry.motion.yaw);
        view->spent = spent(balancer, &telemetry);
    }
}

static enum jp_status work(void *context)
{
    return jp_pilot_work(balancer_of(context)->pilot);
}

/** Whether it stands, and how. */
static bool stands(const struct jp_balancer_vehicle *balancer, struct jp_telemetry *telemetry)
{
    const bool waits = jp_robot_has_next(robot_of(balancer));

    return jp_robot_telemetry(robot_of(balancer), telemetry) &&
           phase_of(balancer, telemetry, waits) == JP_VEHICLE_STANDING;
}

/** Until a turn has settled, s. */
static jp_q16 turn_duration(const struct jp_balancer_vehicle *balancer)
{
    const jp_q16 bandwidth = config_of(balancer)->reference.yaw_bandwidth;
    const jp_q16 settling = balancer->pilot->config.model->settling_time;
    const jp_q16 shaped = bandwidth == 0 ? settling : jp_q16_divide(JP_Q16(TURN_TIME_CONSTANTS), bandwidth);

    return shaped > JP_SEGMENT_DURATION_MIN ? shaped : JP_SEGMENT_DURATION_MIN;
}

static enum jp_status turn(void *context, jp_angle heading, const struct jp_ground *ground)
{
    (void)ground;

    struct jp_balancer_vehicle *balancer = balancer_of(context);
    const jp_q24 limit = config_of(balancer)->limits.turn;
    struct jp_telemetry telemetry;

    if (!stands(balancer, &telemetry)) {
        return JP_ERR_STATE;
    }
    const struct jp_segment_command segment = {
        .turn = jp_clamp32(jp_angle_to_radians(heading - jp_phase_angle(telemetry.reference_yaw)), -limit, limit),
        .duration = turn_duration(balancer)};

    return jp_robot_drive(robot_of(balancer), &segment);
}

static enum jp_status follow(void *context, const struct jp_vehicle_run *run)
{
    struct jp_balancer_vehicle *balancer = balancer_of(context);
    const struct jp_pilot_route route = {
        .targets = run->targets, .count = run->count, .end = JP_PILOT_STAND, .slower = run->slower};
    struct jp_telemetry telemetry;

    return stands(balancer, &telemetry) ? jp_pilot_follow(balancer->pilot, &route) : JP_ERR_STATE;
}

static void stop(void *context)
{
    jp_pilot_stop(balancer_of(context)->pilot);
}

/* The survey. */

static void add_duration(struct jp_balancer_survey *survey, jp_q16 duration)
{
    survey->sum.duration = jp_add(survey->sum.duration, duration);
}

/** By the model's a3 σ², as a segment at speed 0 takes it, and what the electronics draw meanwhile. */
static void add_turn(struct jp_balancer_vehicle *balancer, jp_angle turned)
{
    struct jp_balancer_survey *survey = &balancer->survey;
    const jp_q24 limit = config_of(balancer)->limits.turn;
    const jp_q16 duration = turn_duration(balancer);
    int64_t left = jp_angle_to_radians(turned);

    left = left < 0 ? -left : left;
    while (left > 0) {
        const jp_q24 part = left < limit ? (jp_q24)left : limit;

        survey->sum.energy.energy += jp_multiply_shift(survey->model.a[2], jp_q24_multiply(part, part), 24);
        survey->sum.energy.energy += jp_q16_multiply(survey->model.electronics_power, duration);
        add_duration(survey, duration);
        left -= part;
    }
}

static jp_q24 slowed_down(jp_q24 cruise, uint8_t times)
{
    for (uint8_t i = 0; i < times; i++) {
        cruise -= cruise / 4;
    }
    return cruise;
}

static enum jp_status start_plan(struct jp_balancer_survey *survey)
{
    const enum jp_status status =
        jp_trajectory_plan_start(&survey->plan, &survey->task, &survey->leg, 1, &survey->trajectory);

    if (status == JP_OK) {
        jp_trajectory_modes(&survey->trajectory, survey->modes);
    }
    return status;
}

/** What a run of one leg cannot have at its pace it has at a slower one, as the pilot drives it. */
static enum jp_status start_slower(struct jp_balancer_survey *survey, enum jp_status status)
{
    for (unsigned i = 0; i < JP_PILOT_SLOWER_MAX && status == JP_ERR_INFEASIBLE && survey->task.count == 1U; i++) {
        survey->task.cruise = slowed_down(survey->task.cruise, 1);
        status = start_plan(survey);
    }
    return status;
}

static enum jp_status survey_run(void *context, const struct jp_vehicle_run *run, bool anew)
{
    struct jp_balancer_vehicle *balancer = balancer_of(context);
    struct jp_balancer_survey *survey = &balancer->survey;
    const struct jp_pilot *pilot = balancer->pilot;

    if (anew) {
        survey->before = (struct jp_balancer_sum){.duration = 0};
    } else if (jp_is_same_point(&run->start, &survey->task.start)) {
        survey->before = survey->before_last;
    } else {
        /* It is the next one. */
    }
    survey->before_last = survey->before;
    survey->sum = survey->before;
    survey->model = *pilot->config.model;
    if (pilot->config.learning != NULL) {
        jp_learner_model(&pilot->learner, &survey->model);
    }
    survey->heading = jp_atan2(jp_sub(run->targets[0].y, run->start.y), jp_sub(run->targets[0].x, run->start.x));
    add_turn(balancer, survey->heading - run->heading);
    survey->task =
        (struct jp_trajectory_task){.config = &pilot->internal.trajectory,
                                    .cruise = slowed_down(jp_pilot_cruise_now(pilot, &survey->model), run->slower),
                                    .start = run->start,
                                    .heading = survey->heading,
                                    .targets = run->targets,
                                    .count = run->count,
                                    .to_stand = true};
    return start_slower(survey, start_plan(survey));
}

static void add_leg(struct jp_balancer_vehicle *balancer)
{
    struct jp_balancer_survey *survey = &balancer->survey;
    const struct jp_pilot *pilot = balancer->pilot;
    struct jp_leg_energy energy;

    /* What exceeds its format is saturated. */
    (void)jp_trajectory_leg_energy(&config_of(balancer)->trajectory, pilot->config.model, &pilot->internal.back_emf,
                                   &survey->leg, survey->modes, &energy);
    add_duration(survey, energy.duration);
    if (pilot->config.learning == NULL || jp_forecast_add_leg(&pilot->learner, &survey->sum.energy, &energy) != JP_OK) {
        survey->sum.energy.energy += energy.energy;
    }
}

static enum jp_status survey_leg(void *context, struct jp_leg_extent *extent)
{
    struct jp_balancer_vehicle *balancer = balancer_of(context);
    struct jp_balancer_survey *survey = &balancer->survey;
    const enum jp_status status = jp_trajectory_plan_leg(&survey->plan, &survey->leg);

    if (status == JP_OK) {
        *extent = jp_trajectory_leg_extent(&config_of(balancer)->trajectory, &survey->leg, survey->heading);
        add_leg(balancer);
        survey->heading = survey->leg.next.heading;
        if (survey->plan.planned == survey->task.count) {
            survey->before = survey->sum;
        }
    }
    return status;
}

static void forecast(void *context, jp_q16 *duration, struct jp_forecast *energy)
{
    const struct jp_balancer_vehicle *balancer = balancer_of(context);
    const struct jp_balancer_sum *sum = &balancer->survey.before;

    *duration = sum->duration;
    *energy = (struct jp_forecast){.energy = jp_saturate32(sum->energy.energy)};
    if (balancer->pilot->config.learning != NULL) {
        (void)jp_forecast_total(&balancer->pilot->learner, &sum->energy, energy);
    }
}

enum jp_status jp_balancer_vehicle_init(struct jp_balancer_vehicle *balancer, struct jp_pilot *pilot,
                                        struct jp_vehicle *vehicle)
{
    if (balancer == NULL || pilot == NULL || vehicle == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *balancer = (struct jp_balancer_vehicle){.pilot = pilot};
    *vehicle = (struct jp_vehicle){.context = balancer,
                                   .look = look,
                                   .work = work,
                                   .turn = turn,
                                   .follow = follow,
                                   .stop = stop,
                                   .survey = survey_run,
                                   .survey_leg = survey_leg,
                                   .forecast = forecast};
    return JP_OK;
}
