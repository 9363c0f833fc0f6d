#include <joulepath/home.h>

#include <joulepath/count.h>
#include <stddef.h>

#include "src/base/integer.h"
#include "src/base/point.h"
#include "src/learn/normal_quantile.h"
#include "src/navigate/navigator_frame.h"
#include "src/navigate/navigator_ledger.h"
#include "src/navigate/navigator_survey.h"

/** Steps on level ground; a way of more tells what others take. */
#define PRICE_STEPS 10

/** Directions in which it may leave. */
#define OUTSIDE_TRIES 8U
#define EIGHTH_TURN   ((jp_angle)1 << 29)

static const struct jp_forecast nothing = {0, 0};

static const struct jp_terrain *terrain_of(const struct jp_home *home)
{
    return jp_planner_terrain(home->config.navigator->config.planner);
}

/* Where the robot is in the field. */

/** Its pose on the field; where it stands nearer to obstacles than the lattice lets it, the pose beside it that is
 *  nearest to home. */
static jp_cost pose_here(const struct jp_home *home, const struct jp_place *place, struct jp_lattice_pose *pose)
{
    const struct jp_pose_field *field = &home->internal.field;
    const jp_q16 cell = terrain_of(home)->config.resolution;
    const uint8_t heading = jp_frame_nearest_heading(field->lattice, JP_ANY_HEADING, place->heading);

    *pose = (struct jp_lattice_pose){(int16_t)(place->point.x / cell), (int16_t)(place->point.y / cell), heading};

    const struct jp_lattice_pose centre = *pose;
    jp_cost least = jp_pose_field_cost(field, centre.x, centre.y, heading);

    if (least == JP_COST_MAX) {
        for (int16_t i = 0; i < 9; i++) {
            const struct jp_lattice_pose beside = {(int16_t)(centre.x + i % 3 - 1), (int16_t)(centre.y + i / 3 - 1),
                                                   heading};
            const jp_cost cost = jp_pose_field_cost(field, beside.x, beside.y, heading);

            if (cost < least) {
                least = cost;
                *pose = beside;
            }
        }
    }
    return least;
}

/* The way home. */

static jp_q16 given_now(const struct jp_home *home)
{
    return home->config.given(home->config.context);
}

/** Across a wrap, too. */
static jp_q16 given_since(const struct jp_home *home, jp_q16 before)
{
    return (int32_t)((uint32_t)given_now(home) - (uint32_t)before);
}

static void grow_anew(struct jp_home *home)
{
    home->internal.phase = JP_HOME_GROWS;
    /* Checked by jp_home_init(). */
    (void)jp_pose_field_start(&home->internal.field, JP_POSE_FIELD_TO_ROOT, home->config.x, home->config.y,
                              JP_ANY_HEADING, JP_COST_MAX - 2U);
}

static void grow(struct jp_home *home)
{
    unsigned poses = home->config.slice;

    if (jp_pose_field_grow(&home->internal.field, &poses)) {
        home->internal.phase = JP_HOME_JOINS;
        home->internal.survey.internal.course.answer = JP_COURSE_NO_ROUTE;
    }
}

static jp_cost level_step(const struct jp_home *home)
{
    return jp_move_cost(&home->internal.field.lattice->move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS], 0);
}

static void keep_way(struct jp_home *home, const struct jp_forecast *energy)
{
    struct jp_home_internal *internal = &home->internal;
    const struct jp_home_way way = {
        .energy = *energy, .cost = internal->cost, .given = given_now(home), .is_known = true};

    if (internal->start != JP_HOME_FROM_OUTSIDE && way.cost > (jp_cost)PRICE_STEPS * level_step(home)) {
        internal->price = way;
    }
    if (internal->start == JP_HOME_FROM_ROBOT) {
        home->ways = jp_one_more32(home->ways);
        internal->way = way;
    } else if (internal->start == JP_HOME_FROM_GOAL) {
        internal->is_goal_known = true;
    } else {
        internal->is_outside_known = true;
        internal->outside = *energy;
    }
}

static void join_anew(struct jp_home *home)
{
    home->internal.phase = JP_HOME_JOINS;
    home->internal.survey.internal.course.answer = JP_COURSE_NO_ROUTE;
}

/** Where it arrives at the goal. */
static struct jp_point goal_point(const struct jp_home *home)
{
    const struct jp_goal *goal = &home->internal.goal;
    const jp_q16 cell = terrain_of(home)->config.resolution;

    return (struct jp_point){goal->x * cell + cell / 2, goal->y * cell + cell / 2};
}

/** Eighths of a turn to the left: first towards the goal, then ever farther from there. */
static jp_angle outside_turn(unsigned tries)
{
    const jp_angle turn = ((jp_angle)tries + 1U) / 2U * EIGHTH_TURN;

    return tries % 2U == 0U ? turn : 0U - turn;
}

/** Ten steps from where it is, or as far as its goal. */
static struct jp_point outside_point(const struct jp_home *home)
{
    const struct jp_point from = jp_navigator_place(home->config.navigator).point;
    const struct jp_point goal = goal_point(home);
    const jp_angle direction = jp_frame_direction(&from, &goal) + outside_turn(home->internal.outside_tries);
    const jp_q16 way = jp_distance(&from, &goal);
    const jp_q16 steps = PRICE_STEPS * terrain_of(home)->config.resolution;
    const jp_q16 out = way < steps ? way : steps;

    return (struct jp_point){jp_add(from.x, jp_multiply_shift(out, jp_cos(direction), 31)),
                             jp_add(from.y, jp_multiply_shift(out, jp_sin(direction), 31))};
}

/** There, looking away from home. */
static struct jp_place place_at(const struct jp_home *home, const struct jp_point *point)
{
    const jp_q16 cell = terrain_of(home)->config.resolution;
    const struct jp_point at_home = {home->config.x * cell + cell / 2, home->config.y * cell + cell / 2};

    return (struct jp_place){.point = *point, .heading = jp_frame_direction(&at_home, point)};
}

static enum jp_home_start next_start(const struct jp_home *home)
{
    const struct jp_home_internal *internal = &home->internal;

    if (home->state != JP_HOME_PREPARING || !internal->way.is_known) {
        return JP_HOME_FROM_ROBOT;
    }
    return internal->is_goal_known ? JP_HOME_FROM_OUTSIDE : JP_HOME_FROM_GOAL;
}

static struct jp_place place_of(const struct jp_home *home, enum jp_home_start start)
{
    if (start == JP_HOME_FROM_ROBOT) {
        return jp_navigator_place(home->config.navigator);
    }
    const struct jp_point point = start == JP_HOME_FROM_GOAL ? goal_point(home) : outside_point(home);

    return place_at(home, &point);
}

static void begin_course(struct jp_home *home)
{
    struct jp_navigator *survey = &home->internal.survey;

    home->internal.start = next_start(home);

    const struct jp_place place = place_of(home, home->internal.start);
    struct jp_lattice_pose pose;

    home->internal.cost = pose_here(home, &place, &pose);
    survey->internal.stand = place.point;
    home->internal.heading = place.heading;
    (void)jp_course_start_on_field(&survey->internal.course, &home->internal.field, &pose, &place.point);
}

/** From there no course leads home. */
static void try_another_way_out(struct jp_home_internal *internal)
{
    internal->outside_tries++;
    internal->is_outside_known = internal->outside_tries == OUTSIDE_TRIES;
}

/** What has no course home: a goal is left to the planner; where the map has changed the field may be wrong. */
static void end_join(struct jp_home *home, bool is_stuck)
{
    struct jp_home_internal *internal = &home->internal;

    if (is_stuck && internal->start == JP_HOME_FROM_GOAL) {
        internal->is_goal_known = true;
    } else if (is_stuck && internal->start == JP_HOME_FROM_OUTSIDE) {
        try_another_way_out(internal);
    } else {
        /* It has one, or there is none. */
    }
    internal->is_stuck = internal->start == JP_HOME_FROM_ROBOT && is_stuck;
    if (is_stuck && jp_pose_field_is_outdated(&internal->field)) {
        internal->is_stuck = false;
        grow_anew(home);
    }
}

static void join(struct jp_home *home)
{
    struct jp_navigator *survey = &home->internal.survey;
    struct jp_course *course = &survey->internal.course;

    if (course->answer != JP_COURSE_JOINING) {
        begin_course(home);
    }
    const enum jp_course_answer answer = jp_course_work(course);

    if (answer != JP_COURSE_FOUND) {
        end_join(home, answer != JP_COURSE_JOINING);
        return;
    }
    end_join(home, false);
    if (course->count == 0U) {
        keep_way(home, &nothing);
        join_anew(home);
    } else {
        home->internal.phase = JP_HOME_SURVEYS;
        jp_survey_start(survey);
    }
}

static void survey_leg(struct jp_home *home)
{
    struct jp_navigator *survey = &home->internal.survey;
    const struct jp_place from = {.point = survey->internal.stand, .heading = home->internal.heading};
    const enum jp_status status = jp_survey_work(survey, &from);

    if (status == JP_OK) {
        keep_way(home, &survey->internal.energy);
    }
    if (status != JP_WORKING) {
        join_anew(home);
    }
}

/** The vehicle surveys one thing at a time. */
static void work_on_way(struct jp_home *home)
{
    const bool is_surveyed = home->config.navigator->state == JP_NAVIGATOR_JOINING;

    if (home->internal.phase == JP_HOME_GROWS) {
        grow(home);
    } else if (home->internal.phase == JP_HOME_JOINS) {
        join(home);
    } else if (is_surveyed) {
        join_anew(home);
    } else {
        survey_leg(home);
    }
}

/* What drives take. */

static void begin_drive(struct jp_home *home)
{
    home->internal.drive = (struct jp_home_drive){.given = given_now(home)};
}

/** The forecast of its first course counts for the drive, as it did for those who asked before. */
static void watch_drive(struct jp_home *home)
{
    struct jp_home_drive *drive = &home->internal.drive;
    struct jp_progress progress;

    if (!drive->has_forecast && jp_ledger_left(home->config.navigator, &progress)) {
        drive->forecast = progress.energy;
        drive->has_forecast = true;
    }
}

/* What is asked. */

static struct jp_forecast scaled(const struct jp_home_way *way, jp_cost cost)
{
    return (struct jp_forecast){jp_saturate32((int64_t)way->energy.energy * (int64_t)cost / (int64_t)way->cost),
                                jp_saturate32((int64_t)way->energy.deviation * (int64_t)cost / (int64_t)way->cost)};
}

/** The last one, as much longer or shorter as the field says; where it says nothing, with all that was spent since. */
static struct jp_forecast way_now(const struct jp_home *home)
{
    const struct jp_home_way *way = &home->internal.way;
    const struct jp_place place = jp_navigator_place(home->config.navigator);
    struct jp_lattice_pose pose;
    const jp_cost cost = pose_here(home, &place, &pose);
    struct jp_forecast now = way->energy;

    if (cost == JP_COST_MAX || way->cost == 0U) {
        const jp_q16 spent = given_since(home, way->given);

        now.energy = jp_add(now.energy, spent > 0 ? spent : 0);
    } else {
        now = scaled(way, cost);
    }
    return now;
}

/** What a drive takes beside its way: braking, turning round, standing. */
static jp_q16 begin_energy(const struct jp_home *home)
{
    const struct jp_home_way *price = &home->internal.price;

    return price->is_known ? scaled(price, (jp_cost)PRICE_STEPS * level_step(home)).energy : 0;
}

/** A way of drives of a kind, with what home has learned of them. */
static struct jp_forecast driven(const struct jp_home *home, const struct jp_home_factor *factor,
                                 const struct jp_forecast *forecast, unsigned drives)
{
    const jp_q16 begin = begin_energy(home);
    const struct jp_forecast whole = {jp_saturate32((int64_t)forecast->energy + (int64_t)drives * begin),
                                      forecast->deviation};

    return jp_home_factor_way(factor, &whole, begin);
}

/** No way takes nothing. */
static struct jp_forecast way_back(const struct jp_home *home, const struct jp_forecast *forecast)
{
    return forecast->energy > 0 ? driven(home, &home->learned.back, forecast, 1) : *forecast;
}

static struct jp_forecast share_of(const struct jp_forecast *forecast, unsigned part, unsigned whole)
{
    return (struct jp_forecast){jp_saturate32((int64_t)forecast->energy * (int64_t)part / (int64_t)whole),
                                jp_saturate32((int64_t)forecast->deviation * (int64_t)part / (int64_t)whole)};
}

/** Before it leaves, nothing of the way was driven: what the map does not show is on the way home as on the way out,
 * and the learner is wrong on both. */
static struct jp_forecast way_of(const struct jp_home *home, const struct jp_forecast *forecast, unsigned drives)
{
    const unsigned out = drives / 2U;
    const struct jp_forecast away = share_of(forecast, out, drives);
    const struct jp_forecast home_again = share_of(forecast, drives - out, drives);
    const struct jp_forecast goes = driven(home, &home->learned.out, &away, out);
    const struct jp_forecast comes = driven(home, &home->learned.back, &home_again, drives - out);

    return (struct jp_forecast){jp_add(goes.energy, comes.energy), jp_add(goes.deviation, comes.deviation)};
}

enum jp_status jp_home_expect(const struct jp_home *home, jp_cost cost, unsigned drives, struct jp_forecast *way)
{
    if (home == NULL || way == NULL || drives == 0U || drives > JP_HOME_DRIVES_MAX) {
        return JP_ERR_ARGUMENT;
    }
    if (!home->internal.price.is_known) {
        return JP_ERR_NO_PLAN;
    }
    const struct jp_forecast forecast = scaled(&home->internal.price, cost);

    *way = way_of(home, &forecast, drives);
    return JP_OK;
}

enum jp_status jp_home_farthest(const struct jp_home *home, const struct jp_forecast *left, jp_q31 confidence,
                                unsigned drives, jp_cost *cost)
{
    if (home == NULL || left == NULL || cost == NULL || drives == 0U || drives > JP_HOME_DRIVES_MAX ||
        !jp_is_between(confidence, JP_PROBABILITY_MIN, JP_PROBABILITY_MAX)) {
        return JP_ERR_ARGUMENT;
    }
    if (!home->internal.price.is_known) {
        return JP_ERR_NO_PLAN;
    }
    *cost = 0;
    for (jp_cost bit = (JP_COST_MAX + 1U) / 2U; bit > 0U; bit /= 2U) {
        struct jp_forecast way;
        jp_q31 probability = 0;

        (void)jp_home_expect(home, *cost + bit, drives, &way);
        (void)jp_forecast_suffices(left, &way, &probability);
        *cost += probability >= confidence ? bit : 0U;
    }
    return JP_OK;
}

enum jp_status jp_home_ask(const struct jp_home *home, struct jp_home_answer *answer)
{
    if (home == NULL || answer == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (!home->internal.way.is_known) {
        return JP_ERR_NO_PLAN;
    }
    if (!home->config.left(home->config.context, &answer->left)) {
        return JP_ERR_EMPTY;
    }
    const struct jp_forecast way = way_now(home);

    answer->way = way_back(home, &way);
    return jp_forecast_suffices(&answer->left, &answer->way, &answer->probability);
}

/* The drive. */

static void end_drive(struct jp_home *home, struct jp_home_factor *factor)
{
    const struct jp_home_drive *drive = &home->internal.drive;
    const jp_q16 begin = begin_energy(home);
    const struct jp_forecast forecast = {jp_add(drive->forecast.energy, begin), drive->forecast.deviation};

    /* A drive without a course teaches nothing, nor one that took nothing or before any way was surveyed. */
    if (drive->forecast.energy > 0) {
        (void)jp_home_factor_learn(factor, given_since(home, drive->given), &forecast, begin);
    }
}

static void fail(struct jp_home *home, enum jp_status status)
{
    home->state = JP_HOME_FAILED;
    home->status = status;
}

/** Of a navigator that has failed. */
static enum jp_status failure_of(enum jp_navigator_reason reason)
{
    return reason == JP_NAVIGATOR_OFF ? JP_ERR_STATE : JP_OK;
}

enum jp_status jp_home_return(struct jp_home *home)
{
    if (home == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const struct jp_goal goal = {.x = home->config.x, .y = home->config.y, .headings = JP_ANY_HEADING};
    const enum jp_status status = jp_navigator_go_along(home->config.navigator, &goal, &home->internal.field);

    if (status == JP_OK) {
        begin_drive(home);
        home->state = JP_HOME_RETURNING;
    }
    return status;
}

static bool must_return(const struct jp_home *home)
{
    struct jp_home_answer answer;

    return home->config.confidence > 0 && jp_home_ask(home, &answer) == JP_OK &&
           answer.probability < home->config.confidence;
}

static void turn_back(struct jp_home *home)
{
    home->has_turned_back = true;
    const enum jp_status status = jp_home_return(home);

    if (status != JP_OK) {
        fail(home, status);
    }
}

/** What is left takes it outside, for which it may have to turn as much as for the way back, and home, or nobody knows.
 */
static bool may_leave(const struct jp_home *home)
{
    const struct jp_forecast *outside = &home->internal.outside;
    const struct jp_forecast there_and_back = {jp_add(outside->energy, outside->energy),
                                               jp_add(outside->deviation, outside->deviation)};
    const struct jp_forecast way = way_of(home, &there_and_back, 2);
    struct jp_forecast left;
    jp_q31 probability = 0;

    if (home->config.confidence == 0 || !home->config.left(home->config.context, &left)) {
        return true;
    }
    (void)jp_forecast_suffices(&left, &way, &probability); /* no pointer is null, no deviation negative */
    return probability >= home->config.confidence;
}

static void go(struct jp_home *home)
{
    home->state = JP_HOME_OUT;
    begin_drive(home);
    const enum jp_status status = jp_navigator_go(home->config.navigator, &home->internal.goal);

    if (status != JP_OK) {
        fail(home, status);
    }
}

static void leave(struct jp_home *home)
{
    const struct jp_home_internal *internal = &home->internal;

    if (internal->is_stuck) {
        fail(home, JP_ERR_NO_PLAN);
    } else if (!internal->way.is_known || !internal->is_goal_known || !internal->is_outside_known) {
        /* It waits. */
    } else if (may_leave(home)) {
        go(home);
    } else {
        turn_back(home);
    }
}

/** A goal that cannot be had is no reason to stay out. */
static void go_out(struct jp_home *home, enum jp_navigator_state state)
{
    if (state == JP_NAVIGATOR_ARRIVED) {
        end_drive(home, &home->learned.out);
        home->state = JP_HOME_AT_GOAL;
    } else if (state > JP_NAVIGATOR_ARRIVED || must_return(home)) {
        turn_back(home);
    } else {
        /* On its way. */
    }
}

static void come_home(struct jp_home *home, enum jp_navigator_state state)
{
    if (state == JP_NAVIGATOR_ARRIVED) {
        end_drive(home, &home->learned.back);
        home->state = JP_HOME_HOME;
    } else if (state > JP_NAVIGATOR_ARRIVED) {
        fail(home, failure_of(home->config.navigator->reason));
    } else {
        /* On its way. */
    }
}

enum jp_home_state jp_home_work(struct jp_home *home)
{
    const enum jp_navigator_state state = jp_navigator_work(home->config.navigator);

    watch_drive(home);
    work_on_way(home);
    switch (home->state) {
    case JP_HOME_PREPARING:
        leave(home);
        break;
    case JP_HOME_OUT:
        go_out(home, state);
        break;
    case JP_HOME_RETURNING:
        come_home(home, state);
        break;
    default:
        break;
    }
    return home->state;
}

enum jp_status jp_home_go(struct jp_home *home, const struct jp_goal *goal)
{
    if (home == NULL || goal == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (jp_frame_look(home->config.navigator).phase == JP_VEHICLE_OFF) {
        return JP_ERR_STATE;
    }
    home->internal.goal = *goal;
    home->internal.is_goal_known = false;
    home->internal.is_outside_known = false;
    home->internal.outside_tries = 0;
    home->internal.outside = nothing;
    home->has_turned_back = false;
    home->status = JP_OK;
    home->state = JP_HOME_PREPARING;
    return JP_OK;
}

void jp_home_stop(struct jp_home *home)
{
    home->state = JP_HOME_IDLE;
    jp_navigator_stop(home->config.navigator);
}

bool jp_home_is_cut_off(const struct jp_home *home)
{
    return home->internal.is_stuck;
}

/* Preparation. */

size_t jp_home_size(const struct jp_terrain_config *config)
{
    return jp_pose_field_size(config);
}

static const char *wrong_field(const struct jp_home_config *config)
{
    if (config->navigator == NULL) {
        return "navigator";
    }
    if (config->confidence != 0 && !jp_is_between(config->confidence, JP_PROBABILITY_MIN, JP_PROBABILITY_MAX)) {
        return "confidence";
    }
    if (config->left == NULL) {
        return "left";
    }
    if (config->given == NULL) {
        return "given";
    }
    if (config->legs == NULL) {
        return "legs";
    }
    if (config->legs_max == 0U) {
        return "legs_max";
    }
    return config->slice == 0U ? "slice" : NULL;
}

/** As the navigator's, with legs of its own. */
static void prepare_survey(struct jp_home *home)
{
    const struct jp_navigator *navigator = home->config.navigator;
    struct jp_navigator *survey = &home->internal.survey;

    *survey = (struct jp_navigator){.config = navigator->config, .internal = {.origin = navigator->internal.origin}};
    survey->config.legs = home->config.legs;
    survey->config.legs_max = home->config.legs_max;
    survey->internal.ground = jp_frame_make_ground(survey);
    survey->internal.course = navigator->internal.course;
    survey->internal.course.config.legs = home->config.legs;
    survey->internal.course.config.legs_max = home->config.legs_max;
}

enum jp_status jp_home_init(struct jp_home *home, const struct jp_home_config *config, const char **field)
{
    if (home == NULL || config == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *field = wrong_field(config);
    if (*field != NULL) {
        return JP_ERR_CONFIG;
    }
    *home = (struct jp_home){.config = *config, .learned = jp_home_learned_new};

    const struct jp_lattice *lattice = jp_planner_lattice(config->navigator->config.planner);
    const struct jp_terrain *terrain = terrain_of(home);

    if (!jp_terrain_contains(terrain, config->x, config->y)) {
        return JP_ERR_OUTSIDE;
    }
    if (!jp_lattice_is_open(lattice, terrain, config->x, config->y)) {
        return JP_ERR_BLOCKED;
    }
    const enum jp_status status = jp_pose_field_init(&home->internal.field, lattice, JP_COST_PHYSICAL, terrain,
                                                     home->config.block, home->config.size);

    if (status == JP_OK) {
        prepare_survey(home);
        grow_anew(home);
    }
    return status;
}

void jp_home_set_lattice(struct jp_home *home, const struct jp_lattice *lattice)
{
    jp_pose_field_set_lattice(&home->internal.field, lattice);
    grow_anew(home);
}
