#include <joulepath/route.h>
#include <stddef.h>

#include "src/base/config_check.h"
#include "src/base/plane.h"
#include "src/trajectory/route_legs.h"
#include "src/trajectory/route_step.h"
#include "src/trajectory/segment_arc.h"
#include "src/trajectory/segment_geometry.h"

#define Q16_ONE 65536.0f
#define Q22_ONE 4194304.0f
#define Q24_ONE 16777216.0f
#define Q30_ONE 1073741824.0f

/* The barrier begins and ends at these shares of a leg's mean energy. */
#define BARRIER_START 1e-2f
#define BARRIER_END   1e-5f

/* Largest speed of any limits, m/s; iterates may exceed it. */
#define SPEED_MAX 8.0f

/* Bandwidth of a shaped reference, rad/s. */
#define BANDWIDTH_MIN JP_Q16(0.1)
#define BANDWIDTH_MAX JP_Q16(100)

/* Least energy for the barrier, J: a route that costs nothing has a barrier too. */
#define ENERGY_MIN 1e-3f

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_route_config, member, low, high)

static enum jp_status check(const struct jp_route_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(yaw_bandwidth, 0, BANDWIDTH_MAX),
        FIELD(leg_count, 1, JP_ROUTE_LEGS_MAX),
    };
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status != JP_OK) {
        return status;
    }
    if (config->model == NULL) {
        return jp_config_refuse("model", field);
    }
    if (config->limits == NULL) {
        return jp_config_refuse("limits", field);
    }
    if (config->yaw_bandwidth != 0 && config->yaw_bandwidth < BANDWIDTH_MIN) {
        return jp_config_refuse("yaw_bandwidth", field);
    }
    return config->legs == NULL ? jp_config_refuse("legs", field) : JP_OK;
}

enum jp_status jp_route_init(struct jp_route *route, const struct jp_route_config *config, const char **field)
{
    if (route == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const enum jp_status status = check(config, field);
    if (status != JP_OK) {
        return status;
    }
    *route = (struct jp_route){.config = *config, .internal.status = JP_ERR_STATE};
    jp_route_hessian(config->model, route->internal.hessian);
    return JP_OK;
}

enum jp_status jp_route_start(struct jp_route *route, const struct jp_point *start, jp_angle heading,
                              const struct jp_energy_start *before, const struct jp_point *targets, uint16_t count)
{
    if (!route || !start || !before || !targets || count == 0U) {
        return JP_ERR_ARGUMENT;
    }
    route->internal.start = *start;
    route->internal.heading = heading;
    route->internal.before = *before;
    route->internal.targets = targets;
    route->length = count < route->config.leg_count ? count : route->config.leg_count;
    route->planned = 0;
    route->internal.iterations = 0;
    route->internal.status = JP_WORKING;
    return JP_OK;
}

static const struct jp_point *target_before(const struct jp_route *route, unsigned k)
{
    return k > 0U ? &route->internal.targets[k - 1U] : &route->internal.start;
}

/* Where leg k begins to follow its arc when the robot comes with this speed and heading. */
static struct jp_point start_of(const struct jp_route *route, unsigned k, jp_q24 speed, jp_angle heading, jp_q24 turn)
{
    return jp_segment_turning_point(route->config.yaw_bandwidth, speed, target_before(route, k), heading, turn);
}

static jp_angle half_arc(const struct jp_segment *segment)
{
    return jp_angle_from_radians(segment->arc / 2);
}

/* The heading when leg k begins, by the greedy segments up to it or by those of the plan. */
static jp_angle heading_before(const struct jp_route *route, unsigned k, bool greedy)
{
    if (k == 0U) {
        return route->internal.heading;
    }

    const struct jp_route_leg *last = &route->config.legs[k - 1U];

    return last->internal.direction + half_arc(greedy ? &last->internal.greedy : &last->segment);
}

static jp_q16 least_duration(const struct jp_route_config *config)
{
    return config->horizon ? config->horizon->duration_min : config->model->settling_time;
}

static jp_q16 shortest(const struct jp_route *route, const struct jp_route_leg_internal *leg)
{
    return jp_segment_shortest(least_duration(&route->config), route->config.limits, leg->distance);
}

/* The greedy start */

static enum jp_status plan_greedily(struct jp_route *route)
{
    const unsigned k = route->planned;
    struct jp_route_leg_internal *leg = jp_route_leg_at(route, k);
    const struct jp_motion *before =
        k > 0U ? &jp_route_leg_at(route, k - 1U)->greedy.command.motion : &route->internal.before.motion;
    const jp_angle heading = heading_before(route, k, true);
    struct jp_point start = *target_before(route, k);
    enum jp_status status = jp_segment_optimise(route->config.model, route->config.limits, before, &start, heading,
                                                &route->internal.targets[k], &leg->greedy);

    if (status == JP_OK && before->speed != 0 && route->config.yaw_bandwidth != 0) {
        start = start_of(route, k, before->speed, heading, leg->greedy.command.turn);
        status = jp_segment_optimise(route->config.model, route->config.limits, before, &start, heading,
                                     &route->internal.targets[k], &leg->greedy);
    }
    if (status != JP_OK) {
        return status;
    }
    route->planned++;
    return jp_segment_polar(&start, &route->internal.targets[k], &leg->distance, &leg->direction);
}

/* The energy of a row of segments, each kept in its segment; saturated it is the worst. False: it cannot be forecast.
 */
static bool total_energy(const struct jp_route *route, bool greedy, jp_q16 *total)
{
    struct jp_energy_start start = route->internal.before;

    *total = 0;
    for (unsigned k = 0; k < route->length; k++) {
        struct jp_route_leg *leg = &route->config.legs[k];
        struct jp_segment *segment = greedy ? &leg->internal.greedy : &leg->segment;

        if (jp_energy_forecast(route->config.model, route->config.horizon, &start, &segment->command, &segment->energy,
                               &start) == JP_ERR_ARGUMENT) {
            return false;
        }
        *total = jp_add(*total, segment->energy);
    }
    return true;
}

static void measure(const struct jp_route *route, struct jp_route_leg_internal *leg)
{
    leg->chord = (float)leg->distance * (1.0f / Q22_ONE);
    leg->pace_max = Q16_ONE / (float)shortest(route, leg);
}

/* Converts the greedy segments to real numbers. */
static void enter_legs(struct jp_route *route)
{
    float arc_before = 0.0f;

    for (unsigned k = 0; k < route->length; k++) {
        struct jp_route_leg_internal *leg = jp_route_leg_at(route, k);

        measure(route, leg);
        leg->arc = (float)leg->greedy.arc * (1.0f / Q24_ONE);
        leg->pace = Q16_ONE / (float)leg->greedy.command.duration;
        leg->turn = (float)leg->greedy.command.turn * (1.0f / Q24_ONE) + 0.5f * (arc_before + leg->arc);
        arc_before = leg->arc;
        if (jp_plane_magnitude(leg->turn) > JP_PLANE_PI) {
            /* The greedy segment turns by the longer side; no Newton step leads from there to the shorter one. */
            leg->turn = jp_plane_wrap(leg->turn);
            leg->arc = 0.0f;
        }
    }
}

static enum jp_status enter(struct jp_route *route)
{
    if (!total_energy(route, true, &route->greedy_energy)) {
        return JP_ERR_ARGUMENT;
    }

    const float total = jp_plane_magnitude((float)route->greedy_energy) * (1.0f / Q16_ONE) + ENERGY_MIN;
    const float mean = total / (float)route->length;

    route->internal.barrier = BARRIER_START * mean;
    route->internal.barrier_min = BARRIER_END * mean;
    enter_legs(route);
    jp_route_evaluate(route);
    jp_route_enter(route);
    return JP_WORKING;
}

/* Recomputes the chords: with a reference that lags, each arc begins elsewhere than on the greedy route. */
static void turn_anew(struct jp_route *route)
{
    jp_angle heading = route->internal.heading;
    jp_q24 speed = route->internal.before.motion.speed;
    jp_angle turned_before = 0;

    for (unsigned k = 0; k < route->length; k++) {
        struct jp_route_leg_internal *leg = jp_route_leg_at(route, k);
        const jp_angle old = leg->direction;
        const struct jp_point start = start_of(route, k, speed, heading, (jp_q24)(leg->sigma * Q24_ONE));

        /* A target that is too near or too far from there keeps its distance. */
        (void)jp_segment_polar(&start, &route->internal.targets[k], &leg->distance, &leg->direction);
        measure(route, leg);

        const jp_angle turned = leg->direction - old;

        leg->turn += (float)(int32_t)(turned - turned_before) * (JP_PLANE_PI * 0x1p-31f);
        turned_before = turned;
        heading = leg->direction + jp_plane_angle(0.5f * leg->arc);
        speed = (jp_q24)(jp_plane_clamp(leg->v, 0.0f, SPEED_MAX) * Q24_ONE);
    }
    jp_route_evaluate(route);
}

/* The result */

/* Half the arc as a binary angle, so that σ stays within its limit. */
static int32_t half_arc_within(const struct jp_route *route, const struct jp_route_leg_internal *leg, jp_angle bearing)
{
    const int32_t wanted = (int32_t)jp_plane_angle(0.5f * leg->arc);
    const int32_t turn = (int32_t)(bearing - (jp_angle)wanted);
    const jp_angle limit = jp_angle_from_radians(route->config.limits->turn);
    const int32_t turn_max = limit > (jp_angle)INT32_MAX ? INT32_MAX : (int32_t)limit;
    const int32_t allowed = jp_clamp32(turn, -turn_max, turn_max);

    return (int32_t)(bearing - (jp_angle)allowed);
}

static bool store_leg(struct jp_route *route, unsigned k)
{
    struct jp_route_leg_internal *leg = jp_route_leg_at(route, k);
    const jp_angle bearing = leg->direction - heading_before(route, k, false);
    const int32_t half = half_arc_within(route, leg, bearing);

    if (jp_clamp32(half, -JP_HALF_ARC_MAX, JP_HALF_ARC_MAX) != half) {
        return false;
    }
    jp_segment_store(route->config.limits, leg->distance, bearing, shortest(route, leg), half,
                     (int32_t)(leg->pace / leg->pace_max * Q30_ONE), &route->config.legs[k].segment);
    return true;
}

static bool store(struct jp_route *route)
{
    for (unsigned k = 0; k < route->length; k++) {
        if (!store_leg(route, k)) {
            return false;
        }
    }
    return true;
}

/* True when every segment is long enough for its arc within the limits; at the longest duration that may fail. */
static bool arrives(const struct jp_route *route)
{
    for (unsigned k = 0; k < route->length; k++) {
        const struct jp_segment *segment = &route->config.legs[k].segment;

        if (segment->command.duration >= route->config.limits->duration) {
            return false;
        }
    }
    return true;
}

static enum jp_status finish(struct jp_route *route)
{
    if (store(route) && arrives(route)) {
        (void)total_energy(route, false, &route->energy);
        if (route->energy < route->greedy_energy) {
            return JP_OK;
        }
    }
    for (unsigned k = 0; k < route->length; k++) {
        route->config.legs[k].segment = route->config.legs[k].internal.greedy;
    }
    route->energy = route->greedy_energy;
    return JP_OK;
}

enum jp_status jp_route_work(struct jp_route *route)
{
    if (route->internal.status != JP_WORKING) {
        return route->internal.status;
    }
    if (route->planned < route->length) {
        const enum jp_status status = plan_greedily(route);

        route->internal.status = status == JP_OK ? JP_WORKING : status;
        if (route->internal.status == JP_WORKING && route->planned == route->length) {
            route->internal.status = enter(route);
        }
    } else if (route->internal.iterations < JP_ROUTE_ITERATIONS) {
        jp_route_step(route);
        route->internal.iterations++;
        if (route->config.yaw_bandwidth != 0 && route->internal.iterations == JP_ROUTE_ITERATIONS / 2) {
            turn_anew(route);
        }
    } else {
        route->internal.status = finish(route);
    }
    return route->internal.status;
}
