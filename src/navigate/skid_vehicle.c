#include <joulepath/skid_vehicle.h>

#include <stddef.h>

#include "src/base/config_check.h"
#include "src/base/integer.h"
#include "src/base/point.h"

#define TIME_MAX   JP_Q16(16384)
#define CORNER_MAX JP_Q24(8)

static struct jp_skid_vehicle *skid_of(void *context)
{
    return context;
}

static struct jp_path_pose pose_of(const struct jp_skid_telemetry *telemetry)
{
    return (struct jp_path_pose){{jp_saturate32(telemetry->x >> 16), jp_saturate32(telemetry->y >> 16)},
                                 jp_phase_angle(telemetry->heading)};
}

static enum jp_vehicle_phase phase_of(enum jp_skid_robot_state state, bool waits)
{
    if (state != JP_SKID_ROBOT_STANDING && state != JP_SKID_ROBOT_DRIVING) {
        return JP_VEHICLE_OFF;
    }
    return waits || state == JP_SKID_ROBOT_DRIVING ? JP_VEHICLE_MOVING : JP_VEHICLE_STANDING;
}

static void look(void *context, struct jp_vehicle_view *view)
{
    const struct jp_skid_robot *robot = skid_of(context)->config.robot;
    const bool waits = jp_skid_robot_has_next(robot);
    struct jp_skid_telemetry telemetry;

    if (jp_skid_robot_telemetry(robot, &telemetry)) {
        const struct jp_path_pose pose = pose_of(&telemetry);

        view->phase = phase_of(telemetry.state, waits);
        view->position = pose.position;
        view->heading = pose.heading;
    }
}

static bool stands(const struct jp_skid_vehicle *skid, struct jp_path_pose *pose)
{
    const bool waits = jp_skid_robot_has_next(skid->config.robot);
    struct jp_skid_telemetry telemetry;

    if (!jp_skid_robot_telemetry(skid->config.robot, &telemetry) ||
        phase_of(telemetry.state, waits) != JP_VEHICLE_STANDING) {
        return false;
    }
    *pose = pose_of(&telemetry);
    return true;
}

static jp_energy spent(const struct jp_skid_vehicle *skid)
{
    return jp_skid_robot_meter(skid->config.robot)->battery;
}

/** The run that was driven to its end teaches. */
static enum jp_status work(void *context)
{
    struct jp_skid_vehicle *skid = skid_of(context);
    struct jp_path_pose pose;

    if (skid->is_learning && stands(skid, &pose)) {
        const int32_t unit = skid->config.learner->built_in->unit_exponent;
        enum jp_learned learned;

        skid->is_learning = false;
        /* What exceeds its format teaches nothing. */
        (void)jp_skid_learner_update(skid->config.learner, &skid->driven.drive,
                                     jp_energy_to_q16(spent(skid) - skid->energy_before, unit), &learned);
    }
    return JP_OK;
}

/* Runs as paths. */

/** Each step of being slower takes a quarter of the speed. */
static struct jp_path_limits slowed_down(const struct jp_path_limits *limits, uint8_t times)
{
    struct jp_path_limits slower = *limits;

    for (uint8_t i = 0; i < times; i++) {
        slower.speed -= slower.speed / 4;
    }
    return slower;
}

/** Speeds of a path, and what it takes. */
static enum jp_status plan_speeds(const struct jp_skid_vehicle *skid, struct jp_skid_run *run,
                                  const struct jp_path_limits *limits)
{
    const struct jp_skid_energy_model *model = &skid->config.learner->model;
    const struct jp_motion_price price = jp_skid_motion_price(model, skid->config.time);
    struct jp_path_cost cost;

    for (uint16_t i = 1; i < run->path.count && skid->config.corner > 0; i++) {
        (void)jp_path_round_corner(&run->path, i, skid->config.corner, limits, &price);
    }

    const enum jp_status status = jp_path_plan_speeds(&run->path, limits, &price, &cost);

    run->drive = (struct jp_skid_drive){.energy = 0};
    run->duration = 0;
    if (status == JP_OK || status == JP_ERR_OVERFLOW) {
        jp_skid_path_energy(model, &run->path, &run->drive, &run->duration);
        return JP_OK;
    }
    return status;
}

static enum jp_status plan_run(const struct jp_skid_vehicle *skid, struct jp_skid_run *run,
                               const struct jp_vehicle_run *task)
{
    const struct jp_line_route route = {.start = task->start,
                                        .heading = task->heading,
                                        .targets = task->targets,
                                        .count = task->count,
                                        .ground = task->ground,
                                        .first = run->first};
    const struct jp_path_limits limits = slowed_down(&skid->config.limits, task->slower);
    const enum jp_status status =
        jp_line_path(&run->path, run->pieces, (uint16_t)JP_SKID_RUN_PIECES, &route);

    run->count = task->count;
    return status == JP_OK ? plan_speeds(skid, run, &limits) : status;
}

/** Drives what was planned. */
static enum jp_status drive(struct jp_skid_vehicle *skid)
{
    skid->energy_before = spent(skid);
    skid->is_learning = true;
    return jp_skid_robot_follow(skid->config.robot, &skid->driven.path);
}

static enum jp_status turn(void *context, jp_angle heading)
{
    struct jp_skid_vehicle *skid = skid_of(context);
    struct jp_skid_run *run = &skid->driven;
    struct jp_path_pose pose;

    if (!stands(skid, &pose)) {
        return JP_ERR_STATE;
    }

    if (jp_turn_path(&run->path, run->pieces, 1, &pose, heading) != JP_OK) {
        return JP_OK; /* it has that heading */
    }

    const enum jp_status status = plan_speeds(skid, run, &skid->config.limits);

    return status == JP_OK ? drive(skid) : status;
}

static enum jp_status follow(void *context, const struct jp_vehicle_run *task)
{
    struct jp_skid_vehicle *skid = skid_of(context);
    struct jp_path_pose pose;

    if (!stands(skid, &pose)) {
        return JP_ERR_STATE;
    }
    const struct jp_vehicle_run from_here = {.start = pose.position,
                                             .heading = pose.heading,
                                             .targets = task->targets,
                                             .count = task->count,
                                             .slower = task->slower,
                                             .ground = task->ground};
    const enum jp_status status = plan_run(skid, &skid->driven, &from_here);

    return status == JP_OK ? drive(skid) : status;
}

static void stop(void *context)
{
    struct jp_skid_vehicle *skid = skid_of(context);

    skid->is_learning = false;
    jp_skid_robot_stop(skid->config.robot);
}

/* The survey. */

static enum jp_status survey(void *context, const struct jp_vehicle_run *task, bool anew)
{
    struct jp_skid_vehicle *skid = skid_of(context);

    if (anew) {
        skid->before = (struct jp_skid_sum){.duration = 0};
    } else if (!jp_is_same_point(&task->start, &skid->survey_start)) {
        skid->before = skid->sum;
    } else {
        /* It takes the place of the last one. */
    }
    skid->survey_start = task->start;
    skid->survey_count = task->count;
    skid->survey_done = 0;
    return plan_run(skid, &skid->surveyed, task);
}

/** How far an arc passes inside the corner of the lines that it touches, m. */
static jp_q16 inside_of(const struct jp_path_piece *arc)
{
    const jp_q24 turned = jp_absolute32(jp_piece_turned(arc, arc->length));
    const jp_q31 cosine = jp_cos(jp_angle_from_radians(turned / 2));
    const jp_q24 radius = jp_q24_divide(JP_Q24_ONE, jp_absolute32(arc->bend));

    return jp_divide(jp_multiply(radius, JP_Q31_MAX - cosine), cosine) >> 8;
}

/** The most that the robot leaves line `index` by: at the corners at its ends, where they are arcs. */
static jp_q16 aside_of(const struct jp_skid_run *run, unsigned index)
{
    jp_q16 most = 0;

    for (unsigned line = index; line <= index + 1U && line < run->count; line++) {
        const struct jp_path_piece *piece = &run->path.pieces[run->first[line]];

        if (piece->kind == JP_PIECE_CURVE && piece->bend != 0) {
            const jp_q16 inside = inside_of(piece);

            most = inside > most ? inside : most;
        }
    }
    return most;
}

static enum jp_status survey_leg(void *context, struct jp_leg_extent *extent)
{
    struct jp_skid_vehicle *skid = skid_of(context);

    *extent = (struct jp_leg_extent){.aside = aside_of(&skid->surveyed, skid->survey_done)};
    skid->survey_done++;
    if (skid->survey_done == skid->survey_count) {
        skid->sum = skid->before;
        skid->sum.duration = jp_add(skid->sum.duration, skid->surveyed.duration);
        /* What exceeds its format is left out. */
        (void)jp_skid_forecast_add(skid->config.learner, &skid->sum.energy, &skid->surveyed.drive);
    }
    return JP_OK;
}

static void forecast(void *context, jp_q16 *duration, struct jp_forecast *energy)
{
    const struct jp_skid_vehicle *skid = skid_of(context);

    *duration = skid->sum.duration;
    (void)jp_skid_forecast_total(skid->config.learner, &skid->sum.energy, energy);
}

static enum jp_status check(const struct jp_skid_vehicle_config *config, const char **field)
{
    if (jp_path_limits_check(&config->limits, field) != JP_OK) {
        return JP_ERR_CONFIG;
    }
    if (!jp_is_between(config->time, 0, TIME_MAX)) {
        return jp_config_refuse("time", field);
    }
    return jp_is_between(config->corner, 0, CORNER_MAX) ? JP_OK : jp_config_refuse("corner", field);
}

enum jp_status jp_skid_vehicle_init(struct jp_skid_vehicle *skid, const struct jp_skid_vehicle_config *config,
                                    struct jp_vehicle *vehicle, const char **field)
{
    if (skid == NULL || config == NULL || vehicle == NULL || field == NULL || config->robot == NULL ||
        config->learner == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = check(config, field);

    if (status != JP_OK) {
        return status;
    }
    *skid = (struct jp_skid_vehicle){.config = *config};
    *vehicle = (struct jp_vehicle){.context = skid,
                                   .look = look,
                                   .work = work,
                                   .turn = turn,
                                   .follow = follow,
                                   .stop = stop,
                                   .survey = survey,
                                   .survey_leg = survey_leg,
                                   .forecast = forecast};
    return JP_OK;
}
