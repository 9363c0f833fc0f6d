#include "sim/missions/route_plan.h"

#include "sim/base/error.h"

/* Where a plan has come to. */
struct place {
    struct jp_point point;
    jp_angle heading;
    struct jp_energy_start start;
};

static bool accept(enum jp_status status, const char *source, size_t target)
{
    const char *reason = "its energy model is not physical or exceeds its format; give another model";

    if (status == JP_OK) {
        return true;
    }
    if (status == JP_ERR_ZERO_LENGTH) {
        reason = "coincides with the point before it; leave it out";
    } else if (status == JP_ERR_ARGUMENT) {
        reason = "is more than 512 m from the point before it, or no segment there is long enough for the horizon; add "
                 "a point between them, or try --settled";
    } else if (status == JP_ERR_INFEASIBLE) {
        reason = "cannot be reached within the limits of the robot file; move it or widen them";
    }
    error_line("%s: target %zu: %s", source, target + 1, reason);
    return false;
}

/* Drives a segment: sets its energy and where it ends. */
static enum jp_status advance(const struct route_planner *planner, struct jp_segment *segment, struct place *place)
{
    const enum jp_status status = jp_energy_forecast(planner->model, planner->horizon, &place->start, &segment->command,
                                                     &segment->energy, &place->start);

    if (status == JP_OK) {
        (void)jp_segment_end(segment, &place->point, place->heading, &place->point, &place->heading);
    }
    return status;
}

static bool plan_greedily(const struct route_planner *planner, const char *source, const struct route_file *route,
                          struct jp_segment *segments)
{
    struct place place = {.point = route->start, .heading = route->heading};

    for (size_t i = 0; i < route->count; i++) {
        enum jp_status status = jp_segment_optimise(planner->model, planner->limits, &place.start.motion, &place.point,
                                                    place.heading, &route->targets[i], &segments[i]);

        if (status == JP_OK) {
            status = advance(planner, &segments[i], &place);
        }
        if (!accept(status, source, i)) {
            return false;
        }
    }
    return true;
}

/* Plans the targets from `first` on, as many as there are legs. */
static enum jp_status plan_ahead(struct jp_route *planned, const struct route_file *route, size_t first,
                                 const struct place *place)
{
    const size_t left = route->count - first;
    const uint16_t count = (uint16_t)(left < JP_ROUTE_LEGS_MAX ? left : JP_ROUTE_LEGS_MAX);
    enum jp_status status =
        jp_route_start(planned, &place->point, place->heading, &place->start, &route->targets[first], count);

    if (status == JP_OK) {
        do {
            status = jp_route_work(planned);
        } while (status == JP_WORKING);
    }
    return status;
}

/* The last plan is driven to its end, of those before only the first segment. */
static bool plan_jointly(const struct route_planner *planner, const char *source, const struct route_file *route,
                         struct jp_segment *segments)
{
    static struct jp_route_leg legs[JP_ROUTE_LEGS_MAX];
    const struct jp_route_config config = {.model = planner->model,
                                           .horizon = planner->horizon,
                                           .limits = planner->limits,
                                           .legs = legs,
                                           .leg_count = planner->legs};
    struct place place = {.point = route->start, .heading = route->heading};
    struct jp_route planned;
    const char *field;
    size_t i = 0;
    enum jp_status status = jp_route_init(&planned, &config, &field);

    while (status == JP_OK && i < route->count) {
        const size_t driven = route->count - i <= planner->legs ? route->count - i : 1;

        status = plan_ahead(&planned, route, i, &place);
        if (status != JP_OK) {
            return accept(status, source, i + planned.planned);
        }
        for (size_t k = 0; k < driven && status == JP_OK; k++) {
            segments[i] = legs[k].segment;
            status = advance(planner, &segments[i], &place);
            i++;
        }
    }
    return accept(status, source, i - 1);
}

bool route_plan_make(const struct route_planner *planner, const char *source, const struct route_file *route,
                     struct route_plan *plan)
{
    return plan_greedily(planner, source, route, plan->greedy) && plan_jointly(planner, source, route, plan->joint);
}
