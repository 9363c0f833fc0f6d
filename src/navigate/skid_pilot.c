#include <joulepath/skid_pilot.h>

#include <joulepath/count.h>
#include <stddef.h>

#include "src/base/config_check.h"
#include "src/navigate/skid_run.h"
#include "src/trajectory/path_piece.h"

/** Of the speed that the robot was designed for, so much must be left. */
#define LEAST_SHARE 8

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_skid_pilot_config, member, low, high)

static enum jp_status check_own(const struct jp_skid_pilot_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(time, 0, JP_Q16(16384)),
        FIELD(corner, 0, JP_Q24(8)),
    };

    if (config->model == NULL) {
        return jp_config_refuse("model", field);
    }
    if (config->learning == NULL) {
        return jp_config_refuse("learning", field);
    }
    if (config->pieces == NULL) {
        return jp_config_refuse("pieces", field);
    }
    if (config->grounds != NULL && config->ground_learning == NULL) {
        return jp_config_refuse("ground_learning", field);
    }
    return config->places < JP_SKID_PILOT_PIECES(1U) ? jp_config_refuse("places", field)
                                                     : jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);
}

static enum jp_status check(const struct jp_skid_pilot_config *config, const char **field)
{
    const bool parts_fit =
        check_own(config, field) == JP_OK && jp_skid_energy_check(config->model, field) == JP_OK &&
        jp_skid_learning_check(config->learning, field) == JP_OK &&
        jp_path_limits_check(&config->limits, field) == JP_OK &&
        (config->grounds == NULL || jp_factor_learning_check(config->ground_learning, field) == JP_OK);

    return parts_fit ? JP_OK : JP_ERR_CONFIG;
}

enum jp_status jp_skid_pilot_init(struct jp_skid_pilot *pilot, const struct jp_skid_pilot_config *config,
                                  struct jp_skid_robot *robot, const char **field)
{
    if (pilot == NULL || config == NULL || robot == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = check(config, field);

    if (status == JP_OK) {
        *pilot = (struct jp_skid_pilot){.config = *config, .internal = {.robot = robot, .designed = config->limits}};
        jp_skid_learner_start(&pilot->learner, config->learning, config->model);
    }
    if (status == JP_OK && config->grounds != NULL) {
        jp_skid_grounds_start(pilot->config.grounds, pilot->config.ground_learning, &pilot->learner);
    }
    return status;
}

/** What volts turn the wheels of a side, m/s. */
static jp_q24 speed_of(const struct jp_skid_control_config *control, jp_q16 volts)
{
    return jp_q24_divide(jp_divide((int64_t)volts * JP_Q24_ONE, control->back_emf), control->turns_per_metre);
}

enum jp_status jp_skid_pilot_lack_voltage(struct jp_skid_pilot *pilot, jp_q16 lacking)
{
    if (pilot == NULL || lacking < 0) {
        return JP_ERR_ARGUMENT;
    }

    const struct jp_path_limits *const designed = &pilot->internal.designed;
    const jp_q24 slower = speed_of(&jp_skid_robot_configuration(pilot->internal.robot)->control, lacking);

    if (slower > designed->speed - designed->speed / LEAST_SHARE) {
        return JP_ERR_INFEASIBLE;
    }
    pilot->config.limits.speed = designed->speed - slower;
    pilot->config.limits.side_speed = designed->side_speed - slower;
    return JP_OK;
}

static struct jp_skid_knowledge known_to(const struct jp_skid_pilot *pilot)
{
    return (struct jp_skid_knowledge){&pilot->learner, pilot->config.grounds};
}

/** The phase changes here alone. */
static void enter(struct jp_skid_pilot *pilot, enum jp_skid_pilot_phase phase)
{
    pilot->phase = phase;
    if (phase != JP_SKID_PILOT_PLANNING && pilot->internal.question == JP_SKID_PILOT_ASKED) {
        pilot->internal.question = JP_SKID_PILOT_ANSWERED;
    }
}

/** Ends a route, or answers what was asked. */
static void rest(struct jp_skid_pilot *pilot, enum jp_status status)
{
    pilot->status = status;
    enter(pilot, JP_SKID_PILOT_RESTING);
}

static bool motors_run(enum jp_skid_robot_state state)
{
    return state == JP_SKID_ROBOT_STANDING || state == JP_SKID_ROBOT_DRIVING;
}

/* What the robot does. */

static void leave_out(struct jp_skid_pilot *pilot, enum jp_evidence evidence)
{
    pilot->evidence = evidence;
    pilot->legs_left_out = jp_one_more32(pilot->legs_left_out);
}

/** A leg that was handed over does not come to its end. */
static void cut_leg(struct jp_skid_pilot *pilot)
{
    if (pilot->phase == JP_SKID_PILOT_DRIVING && pilot->legs_begun > pilot->legs_ended) {
        leave_out(pilot, JP_EVIDENCE_INCOMPLETE);
    }
}

/** What is told of the leg that begins. */
static void describe(struct jp_skid_pilot *pilot)
{
    const struct jp_skid_pilot_watch *watch = &pilot->internal.watch;
    const struct jp_skid_knowledge known = known_to(pilot);
    struct jp_skid_ground_drive drive = {.at_edges = 0};
    struct jp_skid_drive total;
    jp_q16 duration = 0;

    jp_skid_run_leg_energy(&pilot->internal.run, &watch->leg, &known, &drive, &duration);
    jp_skid_ground_drive_total(&drive, &total);
    pilot->leg = (struct jp_skid_pilot_leg){.duration = duration, .energy = jp_saturate32(total.energy)};
    for (unsigned i = watch->leg.begin; i < watch->leg.end; i++) {
        const struct jp_path_piece *piece = &pilot->internal.run.path.pieces[i];

        pilot->leg.turn += jp_piece_turned(piece, piece->length);
        pilot->leg.speed = jp_piece_is_straight(piece) ? piece->speed.cruise : pilot->leg.speed;
    }
}

/** The part of a leg from its begin that is learned from alone. */
static struct jp_skid_leg part_of(const struct jp_skid_pilot *pilot, const struct jp_skid_leg *leg)
{
    struct jp_skid_leg part = *leg;

    if (pilot->config.grounds != NULL) {
        part.end = jp_skid_run_end_of_ground(&pilot->internal.run, leg);
    }
    return part;
}

/** What is left of the leg after the part that is watched. */
static struct jp_skid_leg rest_of_leg(const struct jp_skid_pilot *pilot)
{
    const struct jp_skid_pilot_watch *watch = &pilot->internal.watch;

    return (struct jp_skid_leg){.begin = watch->part.end,
                                .end = watch->leg.end,
                                .speed = pilot->internal.run.path.pieces[watch->part.end - 1U].speed.end};
}

static void begin_part(struct jp_skid_pilot *pilot, const struct jp_skid_leg *part,
                       const struct jp_skid_telemetry *telemetry, bool is_mixed)
{
    struct jp_skid_pilot_watch *watch = &pilot->internal.watch;
    const struct jp_skid_knowledge known = known_to(pilot);
    jp_q16 duration = 0;

    watch->part = *part;
    watch->drive = (struct jp_skid_ground_drive){.at_edges = 0};
    watch->is_mixed = is_mixed;
    watch->energy = telemetry->energy;
    watch->tick = telemetry->tick;
    watch->dropped_frames = telemetry->dropped_frames;
    watch->saturated_ticks = telemetry->saturated_ticks;
    watch->battery_flags = 0;
    jp_skid_run_leg_energy(&pilot->internal.run, part, &known, &watch->drive, &duration);
}

static void begin_leg(struct jp_skid_pilot *pilot, const struct jp_skid_leg *leg,
                      const struct jp_skid_telemetry *telemetry, bool is_mixed)
{
    struct jp_skid_pilot_watch *watch = &pilot->internal.watch;
    const struct jp_skid_leg part = part_of(pilot, leg);

    watch->leg = *leg;
    watch->leg_energy = telemetry->energy;
    watch->leg_tick = telemetry->tick;
    begin_part(pilot, &part, telemetry, is_mixed);
    pilot->legs_begun++;
    describe(pilot);
}

static enum jp_evidence evidence_of(const struct jp_skid_pilot_watch *watch, const struct jp_skid_telemetry *telemetry)
{
    const uint32_t ticks = telemetry->tick - watch->tick;

    if (watch->is_mixed) {
        return JP_EVIDENCE_INCOMPLETE;
    }
    if (telemetry->dropped_frames - watch->dropped_frames > ticks / JP_EVIDENCE_DROPPED_SHARE) {
        return JP_EVIDENCE_DROPPED;
    }
    if (telemetry->saturated_ticks - watch->saturated_ticks > ticks / JP_EVIDENCE_SATURATED_SHARE) {
        return JP_EVIDENCE_SATURATED;
    }
    return watch->battery_flags == 0U ? JP_EVIDENCE_GOOD : JP_EVIDENCE_BATTERY;
}

/** From the part that is over. What exceeds its format teaches nothing. */
static void learn(struct jp_skid_pilot *pilot, const struct jp_skid_telemetry *telemetry)
{
    const struct jp_skid_pilot_watch *watch = &pilot->internal.watch;
    const enum jp_evidence evidence = evidence_of(watch, telemetry);
    const jp_q16 measured = jp_energy_to_q16(telemetry->energy - watch->energy, pilot->config.model->unit_exponent);

    if (evidence == JP_EVIDENCE_GOOD && jp_skid_grounds_update(pilot->config.grounds, &pilot->learner, &watch->drive,
                                                               measured, &pilot->learned) == JP_OK) {
        pilot->evidence = evidence;
        pilot->legs_learned_from = jp_one_more32(pilot->legs_learned_from);
    } else {
        leave_out(pilot, evidence);
    }
}

static void end_leg(struct jp_skid_pilot *pilot, const struct jp_skid_telemetry *telemetry)
{
    const struct jp_skid_pilot_watch *watch = &pilot->internal.watch;

    pilot->legs_ended++;
    pilot->result = (struct jp_skid_pilot_result){.leg = pilot->legs_ended,
                                                  .energy = telemetry->energy - watch->leg_energy,
                                                  .ticks = telemetry->tick - watch->leg_tick};
    learn(pilot, telemetry);
}

/** Parts that end before their leg does: of one that ends in a call after another one, what they took cannot be told
 *  apart. */
static void watch_parts(struct jp_skid_pilot *pilot, const struct jp_skid_telemetry *telemetry)
{
    struct jp_skid_pilot_watch *watch = &pilot->internal.watch;

    while (watch->part.end < watch->leg.end && telemetry->path_piece >= watch->part.end) {
        const struct jp_skid_leg rest_of = rest_of_leg(pilot);
        const struct jp_skid_leg next = part_of(pilot, &rest_of);
        const bool is_over = telemetry->path_piece >= next.end;

        watch->is_mixed = watch->is_mixed || is_over;
        learn(pilot, telemetry);
        begin_part(pilot, &next, telemetry, is_over);
    }
}

/** One leg ends in a call; where the next one has ended, too, what they took cannot be told apart. */
static void watch_leg(struct jp_skid_pilot *pilot, const struct jp_skid_telemetry *telemetry)
{
    struct jp_skid_pilot_watch *watch = &pilot->internal.watch;
    struct jp_skid_leg next = watch->leg;

    watch->battery_flags |= pilot->battery_flags;
    if (pilot->legs_begun == pilot->legs_ended) {
        return;
    }
    watch_parts(pilot, telemetry);
    if (telemetry->path_piece < watch->leg.end) {
        return;
    }
    const bool goes_on = jp_skid_run_next_leg(&pilot->internal.run, &next);
    const bool is_over = goes_on && telemetry->path_piece >= next.end;

    watch->is_mixed = watch->is_mixed || is_over;
    end_leg(pilot, telemetry);
    if (goes_on) {
        begin_leg(pilot, &next, telemetry, is_over);
    }
}

/** `waits`: the path was handed over and waits. JP_ERR_STATE: it was stopped, or the robot drives something else. */
static enum jp_status watch_drive(struct jp_skid_pilot *pilot, const struct jp_skid_telemetry *telemetry, bool waits)
{
    const uint16_t taken_up = (uint16_t)(telemetry->commands - pilot->internal.commands_before);

    if (taken_up == 0U && waits) {
        return JP_OK;
    }
    if (taken_up != 1U) {
        return JP_ERR_STATE;
    }
    watch_leg(pilot, telemetry);
    if (telemetry->state == JP_SKID_ROBOT_DRIVING) {
        return JP_OK;
    }
    if (telemetry->path_piece < pilot->internal.run.path.count) {
        return JP_ERR_STATE;
    }
    if (pilot->legs_ended == pilot->legs_begun) {
        rest(pilot, JP_OK);
    }
    return JP_OK;
}

/* Planning. */

static struct jp_path_pose pose_of(const struct jp_skid_telemetry *telemetry)
{
    return (struct jp_path_pose){{jp_saturate32(telemetry->x >> 16), jp_saturate32(telemetry->y >> 16)},
                                 jp_phase_angle(telemetry->heading)};
}

/** From where the robot stands. */
static enum jp_status lay(struct jp_skid_pilot *pilot, const struct jp_skid_telemetry *telemetry)
{
    struct jp_skid_pilot_internal *internal = &pilot->internal;
    const struct jp_skid_pilot_route *route = &internal->route;
    const struct jp_path_pose start = pose_of(telemetry);

    internal->is_laid = true;
    internal->sum = (struct jp_skid_ground_sum){.robot = {.energy = 0}};
    internal->forecast_status = JP_OK;
    internal->surveyed = (struct jp_skid_leg){.end = 0};
    const struct jp_line_route lines = {.start = start.position,
                                        .heading = start.heading,
                                        .targets = route->targets,
                                        .count = route->count,
                                        .ground = route->ground,
                                        .half_track = jp_skid_run_half_track(&pilot->config)};

    if (route->count == 0U) {
        jp_skid_run_lay_turn(&internal->run, &pilot->config, &lines, internal->heading);
        return JP_OK;
    }
    return jp_skid_run_lay(&internal->run, &pilot->config, &lines, route->slower);
}

/** What a leg takes; what has no format is told with the answer. */
static void survey_leg(struct jp_skid_pilot *pilot)
{
    struct jp_skid_pilot_internal *internal = &pilot->internal;
    const struct jp_skid_knowledge known = known_to(pilot);
    struct jp_skid_ground_drive drive = {.at_edges = 0};

    jp_skid_run_leg_energy(&internal->run, &internal->surveyed, &known, &drive, &pilot->duration);
    if (jp_skid_grounds_forecast_add(&pilot->learner, &internal->sum, &drive) != JP_OK) {
        internal->forecast_status = JP_ERR_OVERFLOW;
    }
    pilot->legs_surveyed++;
}

static enum jp_status hand_over(struct jp_skid_pilot *pilot, const struct jp_skid_telemetry *telemetry)
{
    struct jp_skid_pilot_internal *internal = &pilot->internal;
    struct jp_skid_leg first = {.end = 0};

    if (!jp_skid_run_next_leg(&internal->run, &first)) {
        rest(pilot, JP_OK); /* it has the heading that it was to turn to */
        return JP_OK;
    }
    enter(pilot, JP_SKID_PILOT_DRIVING);
    internal->commands_before = telemetry->commands;
    begin_leg(pilot, &first, telemetry, false);
    return jp_skid_robot_follow(internal->robot, &internal->run.path);
}

static enum jp_status finish_survey(struct jp_skid_pilot *pilot, const struct jp_skid_telemetry *telemetry)
{
    struct jp_skid_pilot_internal *internal = &pilot->internal;
    const enum jp_status total =
        jp_skid_grounds_forecast_total(pilot->config.grounds, &pilot->learner, &internal->sum, &internal->forecast);

    internal->forecast_status = total == JP_OK ? internal->forecast_status : total;
    if (internal->is_question) {
        rest(pilot, JP_OK);
        return JP_OK;
    }
    return hand_over(pilot, telemetry);
}

/** A robot that still brakes from what it drove before is waited for: it reads the path that it drove. */
static enum jp_status look_ahead(struct jp_skid_pilot *pilot, const struct jp_skid_telemetry *telemetry, bool waits)
{
    struct jp_skid_pilot_internal *internal = &pilot->internal;

    if (waits || telemetry->state == JP_SKID_ROBOT_DRIVING) {
        return JP_OK;
    }
    if (!internal->is_laid) {
        return lay(pilot, telemetry);
    }
    if (jp_skid_run_plan(&internal->run, &pilot->config, &pilot->learner.model)) {
        return JP_OK;
    }
    if (jp_skid_run_next_leg(&internal->run, &internal->surveyed)) {
        survey_leg(pilot);
        return JP_OK;
    }
    return finish_survey(pilot, telemetry);
}

static enum jp_status go_on(struct jp_skid_pilot *pilot, const struct jp_skid_telemetry *telemetry, bool waits)
{
    if (!motors_run(telemetry->state)) {
        return JP_ERR_STATE;
    }
    return pilot->phase == JP_SKID_PILOT_PLANNING ? look_ahead(pilot, telemetry, waits)
                                                  : watch_drive(pilot, telemetry, waits);
}

enum jp_status jp_skid_pilot_work(struct jp_skid_pilot *pilot)
{
    struct jp_skid_telemetry telemetry;

    if (pilot == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const bool waits = jp_skid_robot_has_next(pilot->internal.robot);

    if (pilot->phase == JP_SKID_PILOT_RESTING || !jp_skid_robot_telemetry(pilot->internal.robot, &telemetry)) {
        return pilot->status;
    }

    const enum jp_status status = go_on(pilot, &telemetry, waits);

    if (status != JP_OK) {
        cut_leg(pilot);
        rest(pilot, status);
    }
    return pilot->status;
}

/* Requests. */

static enum jp_status request(const struct jp_skid_pilot *pilot, const struct jp_skid_pilot_route *route)
{
    if (pilot == NULL || route == NULL || route->targets == NULL || route->count == 0U ||
        route->slower > JP_SKID_PILOT_SLOWER_MAX) {
        return JP_ERR_ARGUMENT;
    }
    if (route->count > pilot->config.places / JP_SKID_PILOT_PIECES(1U)) {
        return JP_ERR_MEMORY;
    }
    return motors_run(jp_skid_robot_state_now(pilot->internal.robot)) ? JP_OK : JP_ERR_STATE;
}

static void accept(struct jp_skid_pilot *pilot, const struct jp_skid_pilot_route *route, bool is_question)
{
    cut_leg(pilot);
    pilot->internal.route = *route;
    pilot->internal.is_question = is_question;
    pilot->internal.is_laid = false;
    pilot->internal.question = JP_SKID_PILOT_ASKED;
    pilot->legs_surveyed = 0;
    pilot->duration = 0;
    pilot->legs_begun = 0;
    pilot->legs_ended = 0;
    pilot->status = JP_OK;
    enter(pilot, JP_SKID_PILOT_PLANNING);
}

enum jp_status jp_skid_pilot_follow(struct jp_skid_pilot *pilot, const struct jp_skid_pilot_route *route)
{
    const enum jp_status status = request(pilot, route);

    if (status == JP_OK) {
        jp_skid_robot_stop(pilot->internal.robot);
        accept(pilot, route, false);
    }
    return status;
}

enum jp_status jp_skid_pilot_turn(struct jp_skid_pilot *pilot, jp_angle heading, const struct jp_ground *ground)
{
    if (pilot == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (!motors_run(jp_skid_robot_state_now(pilot->internal.robot))) {
        return JP_ERR_STATE;
    }
    jp_skid_robot_stop(pilot->internal.robot);
    pilot->internal.heading = heading;
    accept(pilot, &(struct jp_skid_pilot_route){.count = 0, .ground = ground}, false);
    return JP_OK;
}

enum jp_status jp_skid_pilot_ask(struct jp_skid_pilot *pilot, const struct jp_skid_pilot_route *route)
{
    const enum jp_status status = request(pilot, route);

    if (status != JP_OK) {
        return status;
    }
    if (pilot->phase != JP_SKID_PILOT_RESTING ||
        jp_skid_robot_state_now(pilot->internal.robot) != JP_SKID_ROBOT_STANDING) {
        return JP_ERR_STATE;
    }
    accept(pilot, route, true);
    return JP_OK;
}

enum jp_status jp_skid_pilot_answer(const struct jp_skid_pilot *pilot, struct jp_forecast *forecast)
{
    if (pilot == NULL || forecast == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (pilot->internal.question == JP_SKID_PILOT_NOTHING_ASKED) {
        return JP_ERR_NO_PLAN;
    }
    if (pilot->internal.question == JP_SKID_PILOT_ASKED) {
        return JP_WORKING;
    }
    *forecast = pilot->internal.forecast;
    return pilot->status == JP_OK ? pilot->internal.forecast_status : pilot->status;
}

void jp_skid_pilot_stop(struct jp_skid_pilot *pilot)
{
    if (pilot->internal.question == JP_SKID_PILOT_ASKED) {
        pilot->internal.question = JP_SKID_PILOT_NOTHING_ASKED;
    }
    cut_leg(pilot);
    rest(pilot, JP_OK);
    jp_skid_robot_stop(pilot->internal.robot);
}
