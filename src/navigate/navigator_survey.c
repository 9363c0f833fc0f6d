#include "src/navigate/navigator_survey.h"

#include "src/base/integer.h"
#include "src/navigate/navigator_frame.h"

/** m. A leg that leaves its line by less needs no room for it. */
#define ASIDE_MIN JP_Q16(0.002)

void jp_survey_start(struct jp_navigator *navigator)
{
    navigator->internal.survey = (struct jp_navigator_survey){.first = 0};
}

static uint16_t count_of_run(const struct jp_course_leg *legs)
{
    uint16_t count = 1;

    while (count < JP_NAVIGATOR_RUN_MAX && !legs[count - 1U].is_stop) {
        count++;
    }
    return count;
}

uint16_t jp_survey_write_run(struct jp_navigator *navigator, unsigned first)
{
    struct jp_course_leg *legs = &navigator->config.legs[first];
    const uint16_t count = count_of_run(legs);

    legs[count - 1U].is_stop = true;
    for (uint16_t i = 0; i < count; i++) {
        navigator->internal.targets[i] = jp_frame_in_odometry(navigator, &legs[i].end);
    }
    return count;
}

static enum jp_status begin_run(struct jp_navigator *navigator, const struct jp_place *place)
{
    struct jp_navigator_survey *survey = &navigator->internal.survey;
    const struct jp_vehicle *vehicle = navigator->config.vehicle;
    const struct jp_point begin = jp_frame_leg_begin(navigator, survey->first);
    const jp_angle heading =
        survey->first == 0U ? place->heading : jp_frame_leg_direction(navigator, survey->first - 1U);

    survey->count = jp_survey_write_run(navigator, survey->first);
    survey->done = 0;
    survey->has_begun = true;

    const struct jp_vehicle_run run = {
        .start = jp_frame_in_odometry(navigator, &begin),
        .heading = heading - navigator->internal.origin.heading,
        .targets = navigator->internal.targets,
        .count = survey->count,
        .slower = navigator->config.legs[survey->first + survey->count - 1U].slower,
        .ground = jp_frame_ground(navigator),
    };

    return vehicle->survey(vehicle->context, &run, survey->first == 0U);
}

static uint32_t turn_at_end(const struct jp_navigator *navigator, unsigned leg)
{
    return jp_magnitude32(
        (int32_t)(jp_frame_leg_direction(navigator, leg + 1U) - jp_frame_leg_direction(navigator, leg)));
}

/** The robot shall stand at one end of a leg, where it turns more. False: it does at both. */
static bool add_stop(struct jp_navigator *navigator, unsigned leg)
{
    struct jp_course_leg *legs = navigator->config.legs;
    const bool has_begin = leg > navigator->internal.survey.first;
    const bool has_end = !legs[leg].is_stop;

    if (has_begin && (!has_end || turn_at_end(navigator, leg - 1U) > turn_at_end(navigator, leg))) {
        legs[leg - 1U].is_stop = true;
    } else {
        legs[leg].is_stop = true;
    }
    return has_begin || has_end;
}

/** The slower a run, the less its robot goes beyond the end, until the margin is enough. JP_WORKING: it begins anew.
 *  JP_ERR_BLOCKED: there is no room to stand there. */
static enum jp_status slow_down(struct jp_navigator_survey *survey, struct jp_course_leg *last, bool is_within_margin)
{
    if (last->slower < JP_VEHICLE_SLOWER_MAX) {
        last->slower++;
        survey->has_begun = false;
        return JP_WORKING;
    }
    return is_within_margin ? JP_OK : JP_ERR_BLOCKED;
}

/** A leg as the robot drives it. JP_ERR_INFEASIBLE also where there is no room for it. */
static enum jp_status survey_leg(struct jp_navigator *navigator)
{
    struct jp_navigator_internal *internal = &navigator->internal;
    struct jp_navigator_survey *survey = &internal->survey;
    const struct jp_vehicle *vehicle = navigator->config.vehicle;
    const unsigned index = (unsigned)survey->first + survey->done;
    struct jp_course_leg *leg = &navigator->config.legs[index];
    const struct jp_point begin = jp_frame_leg_begin(navigator, index);
    struct jp_leg_extent extent = {.aside = 0};
    enum jp_status result = vehicle->survey_leg(vehicle->context, &extent);

    if (result != JP_OK) {
        return result;
    }
    /* Between two stands it keeps to the line. */
    leg->aside = extent.aside > ASIDE_MIN && survey->count > 1U ? extent.aside : 0;
    leg->beyond = 0;
    if (leg->aside > 0 && !jp_course_is_clear(&internal->course, index, &begin)) {
        return JP_ERR_INFEASIBLE;
    }
    leg->beyond = leg->is_stop ? extent.beyond : 0;
    if (leg->beyond > 0 && !jp_course_is_clear(&internal->course, index, &begin)) {
        leg->beyond = 0;
        result = slow_down(survey, leg, extent.beyond <= navigator->config.margin);
    }
    survey->done = (uint16_t)(survey->done + 1U);
    return result;
}

static enum jp_status end_run(struct jp_navigator *navigator)
{
    struct jp_navigator_internal *internal = &navigator->internal;
    struct jp_navigator_survey *survey = &internal->survey;
    const struct jp_vehicle *vehicle = navigator->config.vehicle;

    survey->first = (uint16_t)(survey->first + survey->count);
    survey->has_begun = false;
    if (survey->first < internal->course.count) {
        return JP_WORKING;
    }
    vehicle->forecast(vehicle->context, &internal->duration, &internal->energy);
    return JP_OK;
}

enum jp_status jp_survey_work(struct jp_navigator *navigator, const struct jp_place *place)
{
    struct jp_navigator_survey *survey = &navigator->internal.survey;
    const unsigned leg = (unsigned)survey->first + (survey->has_begun ? survey->done : 0U);
    const enum jp_status status = survey->has_begun ? survey_leg(navigator) : begin_run(navigator, place);

    if (status == JP_ERR_INFEASIBLE && add_stop(navigator, leg)) {
        survey->has_begun = false;
        return JP_WORKING;
    }
    if (status != JP_OK) {
        return status;
    }
    return survey->done == survey->count ? end_run(navigator) : JP_WORKING;
}
