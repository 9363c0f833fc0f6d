#include <joulepath/skid_vehicle.h>

#include <stddef.h>
#include <string.h>

#include "src/base/integer.h"
#include "src/base/point.h"
#include "src/navigate/skid_run.h"

static struct jp_skid_vehicle *skid_of(void *context)
{
    return context;
}

static struct jp_skid_robot *robot_of(const struct jp_skid_vehicle *skid)
{
    return skid->pilot->internal.robot;
}

static enum jp_vehicle_phase phase_of(const struct jp_skid_vehicle *skid, enum jp_skid_robot_state state, bool waits)
{
    if (state != JP_SKID_ROBOT_STANDING && state != JP_SKID_ROBOT_DRIVING) {
        return JP_VEHICLE_OFF;
    }
    return waits || state == JP_SKID_ROBOT_DRIVING || skid->pilot->phase != JP_SKID_PILOT_RESTING ? JP_VEHICLE_MOVING
                                                                                                  : JP_VEHICLE_STANDING;
}

static void look(void *context, struct jp_vehicle_view *view)
{
    const struct jp_skid_vehicle *skid = skid_of(context);
    const bool waits = jp_skid_robot_has_next(robot_of(skid));
    struct jp_skid_telemetry telemetry;

    if (jp_skid_robot_telemetry(robot_of(skid), &telemetry)) {
        view->phase = phase_of(skid, telemetry.state, waits);
        view->position.x = jp_saturate32(telemetry.x >> 16);
        view->position.y = jp_saturate32(telemetry.y >> 16);
        view->heading = jp_phase_angle(telemetry.heading);
        view->spent = jp_energy_to_wrapping_q16(telemetry.energy, skid->pilot->config.model->unit_exponent);
    }
}

static enum jp_status work(void *context)
{
    return jp_skid_pilot_work(skid_of(context)->pilot);
}

static bool stands(struct jp_skid_vehicle *skid)
{
    struct jp_vehicle_view view = {.phase = JP_VEHICLE_OFF};

    look(skid, &view);
    return view.phase == JP_VEHICLE_STANDING;
}

static enum jp_status turn(void *context, jp_angle heading, const struct jp_ground *ground)
{
    struct jp_skid_vehicle *skid = skid_of(context);

    return stands(skid) ? jp_skid_pilot_turn(skid->pilot, heading, ground) : JP_ERR_STATE;
}

static enum jp_status follow(void *context, const struct jp_vehicle_run *run)
{
    struct jp_skid_vehicle *skid = skid_of(context);
    const struct jp_skid_pilot_route route = {
        .targets = run->targets, .count = run->count, .slower = run->slower, .ground = run->ground};

    return stands(skid) ? jp_skid_pilot_follow(skid->pilot, &route) : JP_ERR_STATE;
}

static void stop(void *context)
{
    jp_skid_pilot_stop(skid_of(context)->pilot);
}

/* The survey. */

/** As the pilot plans it. */
static enum jp_status survey_run(void *context, const struct jp_vehicle_run *run, bool anew)
{
    struct jp_skid_vehicle *skid = skid_of(context);
    struct jp_skid_survey *survey = &skid->survey;
    const struct jp_line_route route = {.start = run->start,
                                        .heading = run->heading,
                                        .targets = run->targets,
                                        .count = run->count,
                                        .ground = run->ground,
                                        .half_track = jp_skid_run_half_track(&skid->pilot->config)};
    struct jp_skid_pilot_config config = skid->pilot->config;

    if (anew) {
        survey->before = (struct jp_skid_sum){.duration = 0};
    } else if (jp_is_same_point(&run->start, &survey->start)) {
        survey->before = survey->before_last;
    } else {
        /* It is the next one. */
    }
    survey->before_last = survey->before;
    survey->start = run->start;
    config.pieces = survey->pieces;
    if (config.places > JP_SKID_RUN_PIECES_MAX) {
        config.places = (uint16_t)JP_SKID_RUN_PIECES_MAX;
    }
    survey->sum = survey->before;
    survey->leg = (struct jp_skid_leg){.end = 0};

    const enum jp_status status = jp_skid_run_lay(&survey->run, &config, &route, run->slower);

    if (status == JP_OK) {
        while (jp_skid_run_plan(&survey->run, &config, &skid->pilot->learner.model)) {
            /* Slice by slice. */
        }
    }
    return status;
}

/** How far an arc, of which this is a half, passes inside the corner of the lines that it touches, m. */
static jp_q16 inside_of(const struct jp_path_piece *arc)
{
    const jp_q24 turned = jp_absolute32(jp_piece_turned(arc, arc->length));
    const jp_q31 cosine = jp_cos(jp_angle_from_radians(turned));
    const jp_q24 radius = jp_q24_divide(JP_Q24_ONE, jp_absolute32(arc->bend));

    return jp_divide(jp_multiply(radius, JP_Q31_MAX - cosine), cosine) >> 8;
}

/** The most that the robot leaves a leg's line by; turns on the spot keep to it. */
static jp_q16 aside_of(const struct jp_skid_run *run, const struct jp_skid_leg *leg)
{
    jp_q16 most = 0;

    for (unsigned i = leg->begin; i < leg->end; i++) {
        const struct jp_path_piece *piece = &run->path.pieces[i];
        const jp_q16 inside = piece->bend == 0 ? 0 : inside_of(piece);

        most = inside > most ? inside : most;
    }
    return most;
}

/** What exceeds its format is left out. */
static void add_leg(struct jp_skid_vehicle *skid)
{
    struct jp_skid_survey *survey = &skid->survey;
    const struct jp_skid_learner *learner = &skid->pilot->learner;
    const struct jp_skid_knowledge known = {learner, skid->pilot->config.grounds};
    struct jp_skid_ground_drive drive = {.at_edges = 0};

    jp_skid_run_leg_energy(&survey->run, &survey->leg, &known, &drive, &survey->sum.duration);
    (void)jp_skid_grounds_forecast_add(learner, &survey->sum.energy, &drive);
}

static enum jp_status survey_leg(void *context, struct jp_leg_extent *extent)
{
    struct jp_skid_vehicle *skid = skid_of(context);
    struct jp_skid_survey *survey = &skid->survey;

    (void)jp_skid_run_next_leg(&survey->run, &survey->leg);
    *extent = (struct jp_leg_extent){.aside = aside_of(&survey->run, &survey->leg)};
    add_leg(skid);
    if (survey->leg.end == survey->run.path.count) {
        survey->before = survey->sum;
    }
    return JP_OK;
}

static void forecast(void *context, jp_q16 *duration, struct jp_forecast *energy)
{
    const struct jp_skid_vehicle *skid = skid_of(context);
    const struct jp_skid_sum *sum = &skid->survey.before;

    *duration = sum->duration;
    (void)jp_skid_grounds_forecast_total(skid->pilot->config.grounds, &skid->pilot->learner, &sum->energy, energy);
}

enum jp_status jp_skid_vehicle_init(struct jp_skid_vehicle *skid, struct jp_skid_pilot *pilot,
                                    struct jp_vehicle *vehicle)
{
    if (skid == NULL || pilot == NULL || vehicle == NULL) {
        return JP_ERR_ARGUMENT;
    }
    (void)memset(skid, 0, sizeof *skid);
    skid->pilot = pilot;
    *vehicle = (struct jp_vehicle){.context = skid,
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
