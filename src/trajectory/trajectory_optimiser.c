#include <joulepath/trajectory_optimiser.h>

#include <stddef.h>

#include "src/base/integer.h"
#include "src/base/plane.h"
#include "src/trajectory/trajectory_corner.h"
#include "src/trajectory/trajectory_cost.h"
#include "src/trajectory/trajectory_newton.h"
#include "src/trajectory/trajectory_outline.h"

#define ANGLE_TO_RADIANS (JP_PLANE_PI * 0x1p-31f)
#define TURNS_TO_RADIANS (2.0f * JP_PLANE_PI * 0x1p-24f)
#define Q24_TO_FLOAT     0x1p-24f

/** The search ends where a step would save less than this share of the cost. */
#define ENOUGH 2.0e-6f

/** Most of a passage's speed, by that of the cruise. */
#define SPEED_MOST 1.25f

/** Largest step of a heading, rad, and of a speed by the cruise. */
#define TURN_MAX   0.3f
#define CHANGE_MAX 0.25f

/** A step is halved so often. */
#define HALVINGS 3U

/** What may be given, m/s. */
#define GIVEN_MIN JP_Q24(0.01)
#define GIVEN_MAX JP_Q24(8)

#define BOTH ((unsigned)JP_GIVEN_HEADING | (unsigned)JP_GIVEN_SPEED)

/* ---- One evaluation, leg by leg ---- */

static enum jp_status begin_plan(struct jp_trajectory_optimiser_internal *internal)
{
    const struct jp_trajectory_task *task = &internal->config.task;
    const struct jp_travel_state *motion = &task->motion;

    internal->cost = 0.0f;
    if (!internal->config.goes_on) {
        return jp_plan_begin(&internal->plan, task);
    }
    internal->plan = (struct jp_trajectory_plan){
        .internal = {.task = {.config = task->config},
                     .waypoint = task->start,
                     .motion = {.heading = task->heading, .turn_rate = motion->turn_rate, .speed = motion->speed}}};
    return jp_trajectory_plan_redirect(&internal->plan, task);
}

static float angle_between(jp_angle from, jp_angle to)
{
    return (float)(int32_t)(to - from) * ANGLE_TO_RADIANS;
}

static struct jp_cost_end end_of(const struct jp_trajectory_plan_internal *plan,
                                 const struct jp_waypoint_motion *motion, uint32_t set_points)
{
    return (struct jp_cost_end){
        .heading = angle_between(plan->chord.direction, motion->heading),
        .turn_rate = (float)motion->turn_rate * TURNS_TO_RADIANS,
        .speed = (float)motion->speed * Q24_TO_FLOAT,
        .duration = (float)jp_seconds(plan->task.config, set_points, 24) * Q24_TO_FLOAT,
    };
}

static float is_free(const struct jp_optimiser_place *place, enum jp_given what)
{
    return (place->is_free & (uint8_t)what) != 0U ? 1.0f : 0.0f;
}

/** What is not free has no derivatives. */
static void add_derivatives(const struct jp_leg_cost *cost, struct jp_optimiser_place *before,
                            struct jp_optimiser_place *place)
{
    const float free[2] = {is_free(place, JP_GIVEN_HEADING), is_free(place, JP_GIVEN_SPEED)};

    place->slope[0] = free[0] * cost->slope_end[0];
    place->slope[1] = free[1] * cost->slope_end[1];
    place->curve[0] = free[0] * cost->curve_end[0];
    place->curve[1] = free[0] * free[1] * cost->curve_end[1];
    place->curve[2] = free[1] * cost->curve_end[2];
    if (before == NULL) {
        return;
    }

    const float free_before[2] = {is_free(before, JP_GIVEN_HEADING), is_free(before, JP_GIVEN_SPEED)};

    before->slope[0] += free_before[0] * cost->slope_begin[0];
    before->slope[1] += free_before[1] * cost->slope_begin[1];
    before->curve[0] += free_before[0] * cost->curve_begin[0];
    before->curve[1] += free_before[0] * free_before[1] * cost->curve_begin[1];
    before->curve[2] += free_before[1] * cost->curve_begin[2];
    for (unsigned i = 0; i < JP_COST_VARIABLES; i++) {
        for (unsigned j = 0; j < JP_COST_VARIABLES; j++) {
            before->coupling[i][j] = free_before[i] * free[j] * cost->coupling[i][j];
        }
    }
}

/** The cost of the leg with this outline. */
static enum jp_status add_leg(struct jp_trajectory_optimiser_internal *internal, const struct jp_leg_outline *outline)
{
    struct jp_trajectory_plan_internal *plan = &internal->plan.internal;
    const struct jp_trajectory_config *config = plan->task.config;
    struct jp_optimiser_place *place = &internal->config.places[internal->leg];
    struct jp_cost_leg leg = {
        .length = (float)plan->chord.distance * 0x1p-22f,
        .speed = (float)plan->chord.speed * Q24_TO_FLOAT,
        .begin = end_of(plan, &plan->motion, outline->begin),
        .end = end_of(plan, &outline->next, outline->end),
    };
    struct jp_rolling rolling;
    struct jp_leg_cost cost;

    leg.end.is_straight = outline->ends_straight;
    if (!jp_modes_are_gone(plan->modes)) {
        jp_modes_roll(config, plan->modes, outline->begin, false, &rolling);
        leg.begin.rolling = &rolling;
        internal->cost += jp_start_cost(&internal->rates, config, plan->modes, plan->chord.speed);
        jp_modes_decay(config, plan->modes, outline->begin);
        leg.rolled = (float)jp_modes_way(config, plan->modes, UINT32_MAX) * 0x1p-20f;
    }
    if (!jp_chord_can_meet(config, &plan->chord, &plan->motion, outline->begin) ||
        !jp_chord_can_meet(config, &plan->chord, &outline->next, outline->end) ||
        !jp_leg_cost(&internal->rates, &leg, &place->middle, &cost)) {
        return JP_ERR_INFEASIBLE;
    }
    add_derivatives(&cost, internal->leg == 0U ? NULL : place - 1, place);
    internal->cost += cost.cost;
    return JP_OK;
}

/** What the rule does by itself at the leg's waypoint. */
static void note_rule(struct jp_optimiser_place *place, const struct jp_chord *chord,
                      const struct jp_waypoint_motion *next)
{
    place->heading = next->heading;
    place->speed = next->speed;
    place->pace = chord->speed;
}

/** A leg that is slower than by the rule alone was made so by the headings that are given at its ends. */
static void compare_pace(struct jp_trajectory_optimiser_internal *internal, struct jp_optimiser_place *place)
{
    if (internal->plan.internal.chord.speed >= place->pace) {
        return;
    }

    struct jp_optimiser_place *const first = internal->leg == 0U ? place : place - 1;

    for (struct jp_optimiser_place *at = first; at <= place; at++) {
        internal->is_slowed = internal->is_slowed || (at->is_free & (uint8_t)JP_GIVEN_HEADING) != 0U;
        at->is_free &= (uint8_t)JP_GIVEN_SPEED;
    }
}

/** The next leg of an evaluation. */
static enum jp_status evaluate_leg(struct jp_trajectory_optimiser_internal *internal)
{
    struct jp_optimiser_place *place = &internal->config.places[internal->leg];
    struct jp_leg_outline outline;
    enum jp_status status = internal->leg == 0U ? begin_plan(internal) : JP_OK;

    if (status == JP_OK) {
        status = jp_leg_outline(&internal->plan, &outline);
    }
    if (status == JP_OK) {
        status = add_leg(internal, &outline);
    }
    if (status == JP_OK) {
        if (internal->phase == JP_OPTIMISER_ASSESS) {
            note_rule(place, &internal->plan.internal.chord, &outline.next);
        }
        if (internal->phase == JP_OPTIMISER_GIVE) {
            compare_pace(internal, place);
        }
        internal->plan.internal.motion = outline.next;
        for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
            internal->plan.internal.modes[i] = 0;
        }
        jp_leg_pass(&internal->plan, &outline);
        internal->leg++;
    }
    return status;
}

/** From the derivatives of the best passages. */
static void solve(struct jp_trajectory_optimiser_internal *internal)
{
    struct jp_optimiser_place *const places = internal->config.places;
    const float cruise = (float)internal->config.task.cruise * Q24_TO_FLOAT;
    float farthest = 1.0f; /* by the largest step */

    internal->foretold = jp_newton_step(places, internal->legs);
    for (uint16_t i = 0; i < internal->legs; i++) {
        farthest = jp_plane_larger(farthest, jp_plane_magnitude(places[i].step[0]) / TURN_MAX);
        farthest = jp_plane_larger(farthest, jp_plane_magnitude(places[i].step[1]) / (CHANGE_MAX * cruise));
    }
    internal->share = 1.0f / farthest;
    internal->halvings = HALVINGS;
}

/* ---- The search ---- */

/** Passages as the task has them. */
static void restore(struct jp_trajectory_optimiser_internal *internal)
{
    static const struct jp_passage nothing = {.given = 0};
    const struct jp_trajectory_optimiser_config *config = &internal->config;

    for (uint16_t i = config->held; i < config->task.count; i++) {
        config->passages[i] = internal->given == NULL ? nothing : internal->given[i];
    }
}

/** The best passages with a share of the step. */
static void give(struct jp_trajectory_optimiser_internal *internal, float share)
{
    const struct jp_trajectory_optimiser_config *config = &internal->config;
    const float most = SPEED_MOST * (float)config->task.cruise;

    restore(internal);
    for (uint16_t i = 0; i < internal->legs; i++) {
        const struct jp_optimiser_place *place = &config->places[i];
        struct jp_passage *passage = &config->passages[i];

        if ((place->is_free & (uint8_t)JP_GIVEN_HEADING) != 0U) {
            passage->heading = place->heading + jp_plane_angle(share * place->step[0]);
        }
        if ((place->is_free & (uint8_t)JP_GIVEN_SPEED) != 0U) {
            const float speed = (float)place->speed + share * place->step[1] * 0x1p24f;

            passage->speed = jp_clamp32((int32_t)jp_plane_clamp(speed, 0.0f, most), GIVEN_MIN, GIVEN_MAX);
        }
        passage->given |= place->is_free;
    }
}

static void begin_evaluation(struct jp_trajectory_optimiser_internal *internal, enum jp_optimiser_phase phase)
{
    internal->phase = phase;
    internal->leg = 0;
}

/** The best passages become those that were tried. */
static void take(struct jp_trajectory_optimiser_internal *internal)
{
    for (uint16_t i = 0; i < internal->legs; i++) {
        struct jp_optimiser_place *place = &internal->config.places[i];
        const struct jp_passage *passage = &internal->config.passages[i];

        place->heading = (place->is_free & (uint8_t)JP_GIVEN_HEADING) != 0U ? passage->heading : place->heading;
        place->speed = (place->is_free & (uint8_t)JP_GIVEN_SPEED) != 0U ? passage->speed : place->speed;
    }
    internal->best = internal->cost;
}

/** The search is over: the rule is to plan with what it found. */
static void finish(struct jp_trajectory_optimiser *optimiser)
{
    struct jp_trajectory_optimiser_internal *internal = &optimiser->internal;

    if (internal->best < optimiser->rule) {
        optimiser->found = internal->best;
        give(internal, 0.0f);
    } else {
        restore(internal);
    }
    begin_evaluation(internal, JP_OPTIMISER_PLAN);
}

static void try_step(struct jp_trajectory_optimiser *optimiser)
{
    struct jp_trajectory_optimiser_internal *internal = &optimiser->internal;

    if (internal->evaluations == 0U || internal->halvings == 0U ||
        !(internal->foretold > ENOUGH * jp_plane_magnitude(internal->best))) {
        finish(optimiser);
        return;
    }
    give(internal, internal->share);
    begin_evaluation(internal, JP_OPTIMISER_TRY);
}

/** Which passages are to be found: not that at the end, nor, where legs follow the last one, that at its begin, which
 *  they feel. */
static void free_places(const struct jp_trajectory_optimiser_internal *internal)
{
    const uint16_t last = internal->legs < internal->config.task.count ? 2U : 1U;

    for (uint16_t i = internal->config.held; i + last < internal->legs; i++) {
        internal->config.places[i].is_free = (uint8_t)(BOTH & ~(unsigned)internal->config.passages[i].given);
    }
}

/** What the rule's passages cost is known: they are given. */
static void begin_search(struct jp_trajectory_optimiser *optimiser)
{
    struct jp_trajectory_optimiser_internal *internal = &optimiser->internal;

    optimiser->rule = internal->cost;
    optimiser->found = internal->cost;
    internal->best = internal->cost;
    free_places(internal);
    give(internal, 0.0f);
    begin_evaluation(internal, JP_OPTIMISER_GIVE);
}

/** The passages that were tried are the best so far. */
static void go_on(struct jp_trajectory_optimiser *optimiser)
{
    take(&optimiser->internal);
    solve(&optimiser->internal);
    try_step(optimiser);
}

/** An evaluation ended; or a leg has no room or cannot be planned, and the rule is to say so. */
static void conclude(struct jp_trajectory_optimiser *optimiser, bool is_possible)
{
    struct jp_trajectory_optimiser_internal *internal = &optimiser->internal;

    internal->evaluations--;
    if (internal->phase == JP_OPTIMISER_TRY) {
        if (is_possible && internal->cost < internal->best) {
            go_on(optimiser);
        } else {
            internal->share *= 0.5f;
            internal->halvings--;
            try_step(optimiser);
        }
    } else if (!is_possible) {
        finish(optimiser);
    } else if (internal->phase == JP_OPTIMISER_ASSESS) {
        begin_search(optimiser);
    } else if (internal->is_slowed) {
        internal->is_slowed = false;
        give(internal, 0.0f);
        begin_evaluation(internal, JP_OPTIMISER_GIVE_LESS);
    } else {
        go_on(optimiser);
    }
}

/** A leg by the rule, with the passages that were found. */
static enum jp_status plan_leg(struct jp_trajectory_optimiser *optimiser)
{
    struct jp_trajectory_optimiser_internal *internal = &optimiser->internal;
    struct jp_trajectory_leg leg;
    enum jp_status status = internal->leg == 0U ? begin_plan(internal) : JP_OK;

    if (status == JP_OK) {
        status = jp_trajectory_plan_leg(&internal->plan, &leg);
    }
    internal->leg++;
    if (status == JP_OK && internal->leg < internal->legs) {
        return JP_WORKING;
    }
    internal->phase = JP_OPTIMISER_ENDED;
    if (status != JP_OK && optimiser->found < optimiser->rule) {
        optimiser->found = optimiser->rule;
        restore(internal);
        return JP_ERR_NO_PLAN;
    }
    return status;
}

static bool is_valid(const struct jp_trajectory_optimiser_config *config)
{
    return config->model != NULL && config->passages != NULL && config->places != NULL && config->place_count > 0U &&
           config->task.config != NULL && config->task.count > 0U && config->held <= config->task.count &&
           (!config->goes_on || jp_is_between(config->task.motion.speed, GIVEN_MIN, GIVEN_MAX));
}

enum jp_status jp_trajectory_optimiser_start(struct jp_trajectory_optimiser *optimiser,
                                             const struct jp_trajectory_optimiser_config *config)
{
    if (optimiser == NULL || config == NULL || !is_valid(config)) {
        return JP_ERR_ARGUMENT;
    }
    *optimiser = (struct jp_trajectory_optimiser){
        .internal = {.config = *config,
                     .given = config->task.passages,
                     .legs = config->task.count < config->place_count ? config->task.count : config->place_count,
                     .evaluations = JP_OPTIMISER_EVALUATIONS}};

    struct jp_trajectory_optimiser_internal *internal = &optimiser->internal;

    internal->config.task.passages = config->passages;
    jp_cost_rates_make(&internal->rates, config->task.config, config->model, &config->back_emf, config->task.cruise);
    for (uint16_t i = 0; i < internal->legs; i++) {
        config->places[i] = (struct jp_optimiser_place){.is_free = 0};
    }
    restore(internal);
    begin_evaluation(internal, JP_OPTIMISER_ASSESS);
    return JP_OK;
}

enum jp_status jp_trajectory_optimiser_work(struct jp_trajectory_optimiser *optimiser)
{
    if (optimiser == NULL) {
        return JP_ERR_ARGUMENT;
    }

    struct jp_trajectory_optimiser_internal *internal = &optimiser->internal;

    if (internal->phase == JP_OPTIMISER_ENDED) {
        return JP_ERR_STATE;
    }
    if (internal->phase == JP_OPTIMISER_PLAN) {
        return plan_leg(optimiser);
    }

    const enum jp_status status = evaluate_leg(internal);

    if (status != JP_OK || internal->leg == internal->legs) {
        conclude(optimiser, status == JP_OK);
    }
    return JP_WORKING;
}
