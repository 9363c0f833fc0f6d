#include <joulepath/pilot.h>

#include <joulepath/count.h>
#include <joulepath/trajectory_energy.h>
#include <stddef.h>

#include "src/base/compiler.h"

/** The next leg is planned this long before the present one ends: s⁻¹. */
#define PLAN_LEAD_RATE 5U

/** Of the voltage that motion was designed for, so much must be left. */
#define LEAST_SHARE 8

/** A robot stands that is slower than this share of its cruising speed. */
#define STILL_SHARE 10

#define TURNS_PER_RADIAN JP_Q24(0.15915494309)
#define RADIANS_PER_TURN JP_Q24(6.28318530718)

static bool motors_run(enum jp_robot_state state)
{
    return state == JP_ROBOT_BALANCING || state == JP_ROBOT_DRIVING;
}

static const char *missing_field(const struct jp_pilot_config *config)
{
    return config->model == NULL ? "model" : NULL;
}

static enum jp_status check(const struct jp_pilot_config *config, const char **field)
{
    *field = missing_field(config);
    if (*field != NULL) {
        return JP_ERR_CONFIG;
    }

    const enum jp_status status = jp_energy_model_check(config->model, field);

    return status == JP_OK && config->learning != NULL ? jp_learning_check(config->learning, field) : status;
}

jp_q24 jp_pilot_cruise(const struct jp_robot_config *robot, const struct jp_energy_model *model)
{
    const jp_q24 cruise = jp_cruise_speed(model);

    return cruise < robot->limits.speed ? cruise : robot->limits.speed;
}

struct jp_back_emf jp_pilot_back_emf(const struct jp_robot_config *robot, enum jp_pilot_meter meter)
{
    struct jp_back_emf back_emf = {0, 0};

    if (meter == JP_PILOT_BATTERY) {
        back_emf.travel = jp_multiply_shift(robot->monitor.back_emf, robot->trajectory.turns_per_metre, 24);
        back_emf.turning = jp_q16_multiply(robot->monitor.back_emf, robot->monitor.half_track);
    }
    return back_emf;
}

enum jp_status jp_pilot_lack_voltage(struct jp_pilot *pilot, jp_q16 lacking)
{
    if (pilot == NULL || lacking < 0) {
        return JP_ERR_ARGUMENT;
    }

    const jp_q16 designed = jp_robot_configuration(pilot->internal.robot)->trajectory.voltage;

    if (lacking > designed - designed / LEAST_SHARE) {
        return JP_ERR_INFEASIBLE;
    }
    pilot->internal.trajectory.voltage = designed - lacking;
    return JP_OK;
}

jp_q24 jp_pilot_cruise_now(const struct jp_pilot *pilot, const struct jp_energy_model *model)
{
    const struct jp_robot_config *robot = jp_robot_configuration(pilot->internal.robot);
    const jp_q24 share = jp_q24_divide(pilot->internal.trajectory.voltage, robot->trajectory.voltage);
    const jp_q24 most = jp_q24_multiply(robot->limits.speed, share);
    const jp_q24 cruise = jp_pilot_cruise(robot, model);

    return cruise < most ? cruise : most;
}

enum jp_status jp_pilot_init(struct jp_pilot *pilot, const struct jp_pilot_config *config, struct jp_robot *robot,
                             const char **field)
{
    if (pilot == NULL || config == NULL || robot == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = check(config, field);

    if (status == JP_OK) {
        *pilot = (struct jp_pilot){.config = *config, .internal = {.robot = robot, .model = *config->model}};
        pilot->internal.trajectory = jp_robot_configuration(robot)->trajectory;
        pilot->internal.back_emf = jp_pilot_back_emf(jp_robot_configuration(robot), config->meter);
        if (config->learning != NULL) {
            jp_learner_start(&pilot->learner, config->learning, config->model, NULL);
        }
    }
    return status;
}

/** The phase changes here alone. */
static void enter(struct jp_pilot *pilot, enum jp_pilot_phase phase)
{
    pilot->phase = phase;
    pilot->internal.is_surveying = false;
    if (phase != JP_PILOT_PLANNING && pilot->internal.question == JP_PILOT_ASKED) {
        pilot->internal.question = JP_PILOT_ANSWERED;
    }
}

/** Ends a route, or answers what was asked. */
static void rest(struct jp_pilot *pilot, enum jp_status status)
{
    pilot->status = status;
    enter(pilot, JP_PILOT_RESTING);
}

/* What the robot does. */

static void end_leg(struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    const struct jp_pilot_drive *drive = &pilot->internal.drive;
    const bool of_battery = pilot->config.meter == JP_PILOT_BATTERY;
    const jp_energy measured = of_battery ? telemetry->segment_energy_battery : telemetry->segment_energy_model;
    const jp_q16 measured_in_unit = jp_energy_to_q16(measured, pilot->config.model->unit_exponent);
    const struct jp_leg_energy *energy = &drive->energy[(drive->begun - 1U) % JP_PILOT_PLACES];

    pilot->evidence = jp_segment_evidence(&drive->watch, telemetry, of_battery);
    if (pilot->config.learning == NULL) {
        return;
    }
    if (pilot->evidence == JP_EVIDENCE_GOOD &&
        jp_learner_update_leg(&pilot->learner, energy, measured_in_unit, &pilot->learned) == JP_OK) {
        pilot->legs_learned_from = jp_one_more32(pilot->legs_learned_from);
    } else {
        pilot->legs_left_out = jp_one_more32(pilot->legs_left_out);
    }
}

/** Legs of the trajectory that the robot has begun; 0: it drives no trajectory of the pilot's. */
static uint16_t legs_begun(const struct jp_pilot_drive *drive, const struct jp_telemetry *telemetry)
{
    const bool is_ours = drive->is_waiting || drive->is_driven;

    return is_ours && telemetry->state == JP_ROBOT_DRIVING ? (uint16_t)(telemetry->segment - drive->segment_before)
                                                           : 0U;
}

/** Follows what the robot does, and learns from each leg that ended. False: a leg was cut short, by a fall, a fault or
 *  somebody else's jp_robot_stop(). `waits`: a trajectory was handed over and waits. */
static bool watch(struct jp_pilot *pilot, const struct jp_telemetry *telemetry, bool waits)
{
    struct jp_pilot_drive *drive = &pilot->internal.drive;
    const uint16_t begun = legs_begun(drive, telemetry);
    const bool is_stopped = drive->is_stopped;
    bool was_cut = drive->is_waiting && begun == 0U && !waits;

    jp_segment_watch_note(&drive->watch, pilot->battery_flags, pilot->current_findings);
    if (drive->is_driven && begun != drive->begun) {
        end_leg(pilot, telemetry);
        was_cut = begun == 0U && pilot->evidence == JP_EVIDENCE_INCOMPLETE;
    }
    if (begun > 0U && (drive->is_waiting || begun != drive->begun)) {
        jp_segment_watch_begin(&drive->watch, telemetry);
        drive->is_waiting = false;
        drive->is_driven = true;
    }
    if (begun == 0U && !waits) {
        drive->is_waiting = false;
        drive->is_driven = false;
        drive->is_stopped = false;
    }
    drive->begun = begun;
    return is_stopped || !was_cut;
}

/* Planning. */

/** Where and as the reference is that a balancing robot follows, which is where it will be. */
static void begin_at_reference(const struct jp_robot_config *robot, const struct jp_telemetry *telemetry,
                               struct jp_trajectory_task *task)
{
    const jp_q24 turns = jp_phase_difference(telemetry->reference_wheel, telemetry->motion.wheel);
    const jp_q24 left = jp_q24_multiply(turns, robot->metres_per_turn);

    task->heading = jp_phase_angle(telemetry->reference_yaw);
    task->start.x = jp_add(telemetry->position.x, jp_multiply_shift(left, jp_cos(task->heading), 39));
    task->start.y = jp_add(telemetry->position.y, jp_multiply_shift(left, jp_sin(task->heading), 39));
    task->motion.speed = jp_q24_multiply(telemetry->reference_wheel_rate, robot->metres_per_turn);
    task->motion.turn_rate = telemetry->reference_yaw_rate;
}

/** Where and as the robot will end the segment that it drives. */
static void begin_at_end(const struct jp_robot *robot, const struct jp_telemetry *telemetry,
                         struct jp_trajectory_task *task)
{
    jp_robot_predict_end(robot, telemetry, &task->start, &task->heading);
    task->motion.speed = telemetry->command.speed;
    task->motion.turn_rate = jp_q24_multiply(telemetry->command.turn_rate, TURNS_PER_RADIAN);
}

/** The speed of least energy; less where legs have no room for it. */
static jp_q24 cruise_of(const struct jp_pilot *pilot)
{
    jp_q24 cruise = jp_pilot_cruise_now(pilot, &pilot->internal.model);

    for (uint8_t i = 0; i < pilot->internal.slower; i++) {
        cruise -= cruise / 4;
    }
    return cruise;
}

/** From where and as the robot will be when what it drives ends. */
static struct jp_trajectory_task task_of(const struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    const struct jp_pilot_internal *internal = &pilot->internal;
    const struct jp_robot_config *robot = jp_robot_configuration(internal->robot);
    const struct jp_pilot_route *route = &internal->route;
    const uint16_t done = pilot->targets_planned;
    struct jp_trajectory_task task = {
        .config = &internal->trajectory,
        .cruise = cruise_of(pilot),
        .targets = &route->targets[done],
        .passages = route->passages == NULL ? NULL : &route->passages[done],
        .count = (uint16_t)(route->count - done),
        .to_stand = route->end == JP_PILOT_STAND,
    };

    if (telemetry->state == JP_ROBOT_DRIVING) {
        begin_at_end(internal->robot, telemetry, &task);
    } else {
        begin_at_reference(robot, telemetry, &task);
    }
    task.motion.pitch = jp_q24_multiply(robot->trajectory.lean[0], task.motion.speed);
    return task;
}

static enum jp_status start_plan(const struct jp_trajectory_task *task, struct jp_trajectory_plan *plan,
                                 struct jp_trajectory_leg *legs, uint16_t places, struct jp_trajectory *trajectory,
                                 jp_q24 modes[JP_TRAVEL_MODES])
{
    const enum jp_status status = jp_trajectory_plan_start(plan, task, legs, places, trajectory);

    if (status == JP_OK) {
        jp_trajectory_modes(trajectory, modes);
    }
    return status;
}

/* The survey: the route as it will be driven, for its forecast. */

/** It begins where the leg ends that the robot drives or is to drive; where it cannot go on in motion, from the stand
 *  there. */
static enum jp_status begin_survey(struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    struct jp_pilot_internal *internal = &pilot->internal;
    struct jp_pilot_survey *survey = &internal->survey;
    const struct jp_pilot_drive *drive = &internal->drive;
    enum jp_status status;

    internal->is_onward = drive->is_waiting || drive->is_driven;
    if (internal->is_onward && (drive->is_stopped || internal->needs_stand)) {
        return JP_OK;
    }
    if (pilot->config.learning != NULL) {
        jp_learner_model(&pilot->learner, &internal->model);
    }

    const struct jp_trajectory_task task = task_of(pilot, telemetry);

    if (internal->is_onward) {
        survey->plan = drive->plan;
        for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
            survey->modes[i] = drive->modes[i];
        }
        status = jp_trajectory_plan_redirect(&survey->plan, &task);
    } else {
        status = start_plan(&task, &survey->plan, &survey->leg, 1, &survey->trajectory, survey->modes);
    }
    survey->sum = (struct jp_forecast_sum){.energy = 0};
    internal->forecast_status = JP_OK;
    internal->is_surveying = status == JP_OK;
    return status;
}

/** What a leg takes; what has no format is told with the answer. */
static void add_to_forecast(struct jp_pilot *pilot, const struct jp_leg_energy *energy, enum jp_status status)
{
    struct jp_pilot_internal *internal = &pilot->internal;
    enum jp_status added = JP_OK;

    if (pilot->config.learning != NULL) {
        added = jp_forecast_add_leg(&pilot->learner, &internal->survey.sum, energy);
    } else {
        internal->survey.sum.energy += energy->energy;
    }
    if (status != JP_OK || added != JP_OK) {
        internal->forecast_status = JP_ERR_OVERFLOW;
    }
}

static enum jp_status survey_leg(struct jp_pilot *pilot)
{
    struct jp_pilot_internal *internal = &pilot->internal;
    struct jp_pilot_survey *survey = &internal->survey;
    const struct jp_trajectory_config *config = &internal->trajectory;
    const enum jp_status status = jp_trajectory_plan_leg(&survey->plan, &survey->leg);
    struct jp_leg_energy energy;

    if (status == JP_OK) {
        const enum jp_status format = jp_trajectory_leg_energy(config, pilot->config.model, &internal->back_emf,
                                                               &survey->leg, survey->modes, &energy);

        add_to_forecast(pilot, &energy, format);
        pilot->targets_surveyed = survey->plan.planned;
    }
    return status;
}

static void finish_forecast(struct jp_pilot *pilot)
{
    struct jp_pilot_internal *internal = &pilot->internal;
    const int64_t energy = internal->survey.sum.energy;
    enum jp_status status = energy > INT32_MAX ? JP_ERR_OVERFLOW : JP_OK;

    if (pilot->config.learning != NULL) {
        status = jp_forecast_total(&pilot->learner, &internal->survey.sum, &internal->forecast);
    } else {
        internal->forecast = (struct jp_forecast){.energy = jp_saturate32(energy)};
    }
    internal->forecast_status = status == JP_OK ? internal->forecast_status : status;
}

/** The whole route can be driven: a robot that drives goes on to it from the end of its leg. */
static enum jp_status finish_survey(struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    struct jp_pilot_drive *drive = &pilot->internal.drive;
    enum jp_status status = JP_OK;

    finish_forecast(pilot);
    if (pilot->internal.is_question) {
        rest(pilot, JP_OK);
        return JP_OK;
    }
    if (drive->is_waiting || drive->is_driven) {
        const struct jp_trajectory_task task = task_of(pilot, telemetry);

        status = jp_trajectory_plan_redirect(&drive->plan, &task);
    }
    /* Not before: else the legs of the old route would be planned on. */
    if (status == JP_OK) {
        enter(pilot, JP_PILOT_DRIVING);
    }
    return status;
}

static enum jp_status look_ahead_on(struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    if (!pilot->internal.is_surveying) {
        return begin_survey(pilot, telemetry);
    }
    return pilot->internal.survey.plan.planned < pilot->internal.route.count ? survey_leg(pilot)
                                                                             : finish_survey(pilot, telemetry);
}

/** What cannot be driven on is driven from a stand, and what cannot be driven from a stand, slower. */
static enum jp_status look_ahead(struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    struct jp_pilot_internal *internal = &pilot->internal;
    const enum jp_status status = look_ahead_on(pilot, telemetry);

    if (internal->is_onward && (status == JP_ERR_INFEASIBLE || status == JP_ERR_STATE)) {
        internal->needs_stand = true;
    } else if (status == JP_ERR_INFEASIBLE && internal->slower < JP_PILOT_SLOWER_MAX) {
        internal->slower++;
    } else {
        return status;
    }
    internal->is_surveying = false;
    return JP_OK;
}

/* The drive. */

/** What is told of the leg that comes next. */
static void describe(struct jp_pilot *pilot, const struct jp_trajectory_leg *leg, const struct jp_leg_energy *energy)
{
    struct jp_pilot_drive *drive = &pilot->internal.drive;
    struct jp_forecast_sum sum = {.energy = energy->energy};

    if (pilot->config.learning != NULL) {
        sum.energy = 0;
        (void)jp_forecast_add_leg(&pilot->learner, &sum, energy);
    }
    pilot->leg = (struct jp_pilot_leg){
        .speed = leg->speed,
        .turn = jp_multiply_shift((int32_t)(leg->next.heading - drive->heading), RADIANS_PER_TURN, 32),
        .duration = energy->duration,
        .energy = jp_saturate32(sum.energy),
    };
    drive->heading = leg->next.heading;
}

static enum jp_status plan_leg(struct jp_pilot *pilot)
{
    struct jp_pilot_drive *drive = &pilot->internal.drive;
    const struct jp_trajectory_config *config = &pilot->internal.trajectory;
    const uint16_t place = drive->trajectory.count % JP_PILOT_PLACES;
    const enum jp_status status = jp_trajectory_plan_leg(&drive->plan, &drive->legs[place]);

    if (status == JP_OK) {
        (void)jp_trajectory_leg_energy(config, pilot->config.model, &pilot->internal.back_emf, &drive->legs[place],
                                       drive->modes, &drive->energy[place]);
        describe(pilot, &drive->legs[place], &drive->energy[place]);
        JP_STORE_RELEASE(&drive->trajectory.count, (uint16_t)(drive->trajectory.count + 1U));
        pilot->targets_planned++;
    }
    return status;
}

static enum jp_status begin_drive(struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    struct jp_pilot_drive *drive = &pilot->internal.drive;
    const struct jp_trajectory_task task = task_of(pilot, telemetry);
    enum jp_status status =
        start_plan(&task, &drive->plan, drive->legs, JP_PILOT_PLACES, &drive->trajectory, drive->modes);

    if (status == JP_OK) {
        drive->heading = task.heading;
        status = plan_leg(pilot);
    }
    if (status == JP_OK) {
        status = jp_robot_drive_trajectory(pilot->internal.robot, &drive->trajectory);
    }
    if (status == JP_OK) {
        drive->is_waiting = true;
        drive->segment_before = telemetry->state == JP_ROBOT_DRIVING ? telemetry->segment : 0U;
    }
    return status;
}

/** What the robot drives nears its end. */
static bool is_due(const struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    const uint32_t tick_rate = jp_robot_configuration(pilot->internal.robot)->estimator.tick_rate;

    return telemetry->segment_ticks_left <= tick_rate / PLAN_LEAD_RATE;
}

/** A robot that balances begins when it stands still: its plan does, and a robot that rolls is elsewhere soon. */
static bool can_begin(const struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    const struct jp_robot_config *robot = jp_robot_configuration(pilot->internal.robot);
    const jp_q24 still =
        jp_q24_multiply(jp_cruise_speed(&pilot->internal.model), robot->trajectory.turns_per_metre) / STILL_SHARE;

    return is_due(pilot, telemetry) &&
           (telemetry->state == JP_ROBOT_DRIVING ||
            (telemetry->motion.wheel_rate < still && telemetry->motion.wheel_rate > -still));
}

static enum jp_status drive_on(struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    const struct jp_pilot_drive *drive = &pilot->internal.drive;
    const bool is_ours = drive->is_waiting || drive->is_driven;

    if (pilot->targets_planned == pilot->internal.route.count) {
        if (!is_ours) {
            rest(pilot, JP_OK);
        }
        return JP_OK;
    }
    if (!is_ours) {
        return can_begin(pilot, telemetry) ? begin_drive(pilot, telemetry) : JP_OK;
    }

    const bool has_place = !drive->is_waiting && drive->trajectory.count == drive->begun;

    return has_place && drive->begun < UINT16_MAX && is_due(pilot, telemetry) ? plan_leg(pilot) : JP_OK;
}

static enum jp_status go_on(struct jp_pilot *pilot, const struct jp_telemetry *telemetry)
{
    return pilot->phase == JP_PILOT_PLANNING ? look_ahead(pilot, telemetry) : drive_on(pilot, telemetry);
}

enum jp_status jp_pilot_work(struct jp_pilot *pilot)
{
    struct jp_telemetry telemetry;

    if (pilot == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const bool waits = jp_robot_has_next(pilot->internal.robot);

    if (!jp_robot_telemetry(pilot->internal.robot, &telemetry)) {
        return pilot->status;
    }

    const bool drives_as_told = watch(pilot, &telemetry, waits) && motors_run(telemetry.state);

    if (pilot->phase != JP_PILOT_RESTING) {
        const enum jp_status status = drives_as_told ? go_on(pilot, &telemetry) : JP_ERR_STATE;

        if (status != JP_OK) {
            rest(pilot, status);
        }
    }
    return pilot->status;
}

/* Requests. */

static enum jp_status request(const struct jp_pilot *pilot, const struct jp_pilot_route *route)
{
    if (pilot == NULL || route == NULL || route->targets == NULL || route->count == 0U ||
        route->slower > JP_PILOT_SLOWER_MAX) {
        return JP_ERR_ARGUMENT;
    }
    return motors_run(jp_robot_state_now(pilot->internal.robot)) ? JP_OK : JP_ERR_STATE;
}

static void accept(struct jp_pilot *pilot, const struct jp_pilot_route *route, bool is_question)
{
    pilot->internal.route = *route;
    pilot->internal.is_question = is_question;
    pilot->internal.needs_stand = false;
    pilot->internal.slower = route->slower;
    pilot->internal.question = JP_PILOT_ASKED;
    pilot->targets_surveyed = 0;
    pilot->targets_planned = 0;
    pilot->status = JP_OK;
    enter(pilot, JP_PILOT_PLANNING);
}

enum jp_status jp_pilot_follow(struct jp_pilot *pilot, const struct jp_pilot_route *route)
{
    const enum jp_status status = request(pilot, route);

    if (status == JP_OK) {
        accept(pilot, route, false);
    }
    return status;
}

enum jp_status jp_pilot_ask(struct jp_pilot *pilot, const struct jp_pilot_route *route)
{
    const enum jp_status status = request(pilot, route);

    if (status != JP_OK) {
        return status;
    }
    if (pilot->phase != JP_PILOT_RESTING || jp_robot_state_now(pilot->internal.robot) != JP_ROBOT_BALANCING) {
        return JP_ERR_STATE;
    }
    accept(pilot, route, true);
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
    *forecast = pilot->internal.forecast;
    return pilot->status == JP_OK ? pilot->internal.forecast_status : pilot->status;
}

void jp_pilot_stop(struct jp_pilot *pilot)
{
    struct jp_pilot_drive *drive = &pilot->internal.drive;

    if (pilot->internal.question == JP_PILOT_ASKED) {
        pilot->internal.question = JP_PILOT_NOTHING_ASKED;
    }
    drive->is_stopped = drive->is_waiting || drive->is_driven;
    rest(pilot, JP_OK);
    jp_robot_stop(pilot->internal.robot);
}
