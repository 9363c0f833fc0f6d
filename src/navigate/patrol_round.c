#include <joulepath/patrol_round.h>

#include <joulepath/count.h>

#include "src/base/config_check.h"
#include "src/base/plane.h"

#define DWELL_MAX      86400.0f
#define DEVIATIONS_MAX 10.0f

/* Start. */

static bool is_at_least(float value, float least)
{
    return value >= least && value <= FLT_MAX;
}

static enum jp_status check_stop(const struct jp_patrol_stop *stop, const char **field)
{
    if (!jp_plane_is_pose(&stop->pose)) {
        return jp_config_refuse("stops.pose", field);
    }
    return is_at_least(stop->dwell, 0.0f) && stop->dwell <= DWELL_MAX ? JP_OK : jp_config_refuse("stops.dwell", field);
}

static enum jp_status check_stops(const struct jp_patrol_round_config *config, const char **field)
{
    if (config->stop_count == 0U || config->stop_count > JP_PATROL_STOPS_MAX) {
        return jp_config_refuse("stop_count", field);
    }
    for (uint16_t i = 0; i < config->stop_count; i++) {
        const enum jp_status status = check_stop(&config->stops[i], field);

        if (status != JP_OK) {
            return status;
        }
    }
    return jp_plane_is_pose(&config->charger) ? JP_OK : jp_config_refuse("charger", field);
}

enum jp_status jp_patrol_round_check(const struct jp_patrol_round_config *config, const char **field)
{
    if (config == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const enum jp_status status = check_stops(config, field);

    if (status != JP_OK) {
        return status;
    }
    if (!is_at_least(config->full, FLT_MIN)) {
        return jp_config_refuse("full", field);
    }
    if (!is_at_least(config->reserve, 0.0f)) {
        return jp_config_refuse("reserve", field);
    }
    if (!is_at_least(config->deviations, 0.0f) || config->deviations > DEVIATIONS_MAX) {
        return jp_config_refuse("deviations", field);
    }
    return is_at_least(config->standing_power, 0.0f) ? JP_OK : jp_config_refuse("standing_power", field);
}

/** Of legs, by what was learned of the robot and of what is in its way. */
static float learned_pace(const struct jp_patrol_round *round)
{
    const struct jp_patrol_ledger *ledger = &round->internal.pilot->ledger;

    return ledger->robot * jp_patrol_pace_factor(&ledger->pace, 1.0f);
}

static void begin_survey(struct jp_patrol_round *round)
{
    round->state = JP_ROUND_SURVEYING;
    round->internal.surveyed = 0;
    round->internal.is_asked = false;
    round->internal.is_at_charger = true;
    (void)jp_patrol_pilot_forget_marks(round->internal.pilot);
}

static bool is_at_charger(const struct jp_patrol_round *round)
{
    const struct jp_plane_pose *charger = &round->internal.config.charger;
    const struct jp_patrol_config *config = &round->internal.pilot->mission.patrol.config;
    const struct jp_plane_pose pose = jp_patrol_pilot_pose(round->internal.pilot);

    return jp_plane_length(pose.x - charger->x, pose.y - charger->y) <= config->position_tolerance &&
           jp_plane_magnitude(jp_plane_wrap(pose.heading - charger->heading)) <= config->heading_tolerance;
}

/** Elsewhere than at the charger it goes there at once. */
static void begin(struct jp_patrol_round *round)
{
    if (is_at_charger(round)) {
        begin_survey(round);
    } else {
        round->state = JP_ROUND_WAITING;
        round->internal.stayed = JP_ROUND_WAIT;
    }
}

enum jp_status jp_patrol_round_init(struct jp_patrol_round *round, const struct jp_patrol_round_config *config,
                                    struct jp_patrol_pilot *pilot, const char **field)
{
    if (round == NULL || pilot == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const enum jp_status status = jp_patrol_round_check(config, field);

    if (status == JP_OK) {
        *round = (struct jp_patrol_round){.least_left = FLT_MAX, .internal = {.config = *config, .pilot = pilot}};
        begin(round);
    }
    return status;
}

static void fail(struct jp_patrol_round *round, enum jp_patrol_round_reason reason)
{
    round->state = JP_ROUND_FAILED;
    round->reason = reason;
}

/* Surveys: of each stop the way from the charger, from the stop before, and home. */

#define OUT    0U
#define ONWARD 1U
#define WAYS   3U

static const struct jp_plane_pose *pose_before(const struct jp_patrol_round *round, uint16_t stop)
{
    const struct jp_patrol_round_config *config = &round->internal.config;

    return &config->stops[(stop + config->stop_count - 1U) % config->stop_count].pose;
}

static enum jp_status ask(struct jp_patrol_round *round, uint16_t stop, unsigned way)
{
    const struct jp_patrol_round_config *config = &round->internal.config;
    const struct jp_plane_pose *there = &config->stops[stop].pose;
    struct jp_patrol_pilot *pilot = round->internal.pilot;

    round->internal.is_asked = true;
    if (way == OUT) {
        return jp_patrol_pilot_survey(pilot, &config->charger, there);
    }
    return way == ONWARD ? jp_patrol_pilot_survey(pilot, pose_before(round, stop), there)
                         : jp_patrol_pilot_survey(pilot, there, &config->charger);
}

static struct jp_patrol_leg_forecast *forecast_of(struct jp_patrol_round *round, uint16_t stop, unsigned way)
{
    if (way == OUT) {
        return &round->internal.out[stop];
    }
    return way == ONWARD ? &round->internal.onward[stop] : &round->internal.home[stop];
}

static void survey(struct jp_patrol_round *round)
{
    const uint16_t stop = (uint16_t)(round->internal.surveyed / WAYS);
    const unsigned way = round->internal.surveyed % WAYS;
    enum jp_status status;

    if (round->internal.pilot->internal.is_ended) {
        return; /* what the way home has taken is still to be learned from */
    }
    if (!round->internal.is_asked) {
        round->internal.pace = learned_pace(round);
        status = ask(round, stop, way);
        if (status != JP_OK) {
            round->stop = stop;
            fail(round, JP_ROUND_NO_WAY);
        }
        return;
    }
    status = jp_patrol_pilot_surveyed(round->internal.pilot, forecast_of(round, stop, way));
    if (status == JP_OK) {
        round->internal.is_asked = false;
        round->internal.surveyed++;
        if (round->internal.surveyed == round->internal.config.stop_count * WAYS) {
            round->state = JP_ROUND_CHARGING;
        }
    } else if (status != JP_WORKING) {
        round->stop = stop;
        fail(round, JP_ROUND_NO_WAY);
    } else {
        /* The pilot works on it. */
    }
}

/* Energy. */

/** By what legs have taken beyond their plans since. */
static float pace_since(const struct jp_patrol_round *round)
{
    return learned_pace(round) / round->internal.pace;
}

static float bound_of(const struct jp_patrol_round *round, const struct jp_patrol_leg_forecast *forecast)
{
    return pace_since(round) * (forecast->energy + round->internal.config.deviations * forecast->deviation);
}

/** What a journey may take beyond its forecast, for who stands in the way. */
static float excess_expected(const struct jp_patrol_round *round)
{
    const bool is_known = round->internal.journeys >= JP_ROUND_JOURNEYS;
    float most = is_known ? 0.0f : JP_ROUND_WAIT * round->internal.config.standing_power;

    for (uint32_t i = 0; i < JP_ROUND_JOURNEYS; i++) {
        most = jp_plane_larger(most, round->internal.excesses[i]);
    }
    return most;
}

/** From the stop. */
static float needed_home(const struct jp_patrol_round *round, uint16_t stop)
{
    return round->internal.config.reserve + bound_of(round, &round->internal.home[stop]) + excess_expected(round);
}

/** To the stop, there, and home again. */
static float needed_for(const struct jp_patrol_round *round, uint16_t stop)
{
    const struct jp_patrol_round_config *config = &round->internal.config;
    const struct jp_patrol_leg_forecast *leg =
        round->internal.is_at_charger ? &round->internal.out[stop] : &round->internal.onward[stop];

    return bound_of(round, leg) + config->standing_power * config->stops[stop].dwell + needed_home(round, stop);
}

/* Journeys. */

static void begin_journey(struct jp_patrol_round *round, float available)
{
    round->internal.set_out_with = available;
    round->internal.is_foretold = false;
}

/** By its first plan. */
static void foretell_journey(struct jp_patrol_round *round, const struct jp_patrol_leg_forecast *left, float available)
{
    if (!round->internal.is_foretold) {
        round->internal.foretold = round->internal.set_out_with - available + left->energy;
        round->internal.is_foretold = true;
    }
}

/** It ends, or is broken off where so much of it was left, J. */
static void end_journey(struct jp_patrol_round *round, float left, float available)
{
    const float taken = round->internal.set_out_with - available + left;

    if (round->internal.is_foretold) {
        round->internal.excesses[round->internal.journeys % JP_ROUND_JOURNEYS] =
            jp_plane_larger(taken - round->internal.foretold, 0.0f);
        round->internal.journeys = jp_one_more32(round->internal.journeys);
    }
}

/* Legs. */

static void go(struct jp_patrol_round *round, uint16_t stop, enum jp_patrol_round_state state)
{
    const struct jp_patrol_round_config *config = &round->internal.config;
    const struct jp_plane_pose *goal = stop < config->stop_count ? &config->stops[stop].pose : &config->charger;

    round->stop = stop;
    round->state = state;
    if (jp_patrol_pilot_go(round->internal.pilot, goal) != JP_OK) {
        fail(round, JP_ROUND_DRIVES_OFF);
    }
}

/** Where somebody stands in its way as it leaves, it may not have left. */
static void go_home(struct jp_patrol_round *round)
{
    if (is_at_charger(round)) {
        jp_patrol_pilot_stop(round->internal.pilot);
        begin_survey(round);
    } else {
        go(round, round->internal.config.stop_count, JP_ROUND_HOMING);
    }
}

static void set_out_home(struct jp_patrol_round *round, float available)
{
    begin_journey(round, available);
    go_home(round);
}

static uint16_t next_stop(const struct jp_patrol_round *round)
{
    return (uint16_t)((round->stop + 1U) % round->internal.config.stop_count);
}

/** To this stop if the energy suffices, else home; at the charger the battery is full. */
static void leave_for(struct jp_patrol_round *round, uint16_t stop, float available)
{
    if (available >= needed_for(round, stop)) {
        begin_journey(round, available);
        go(round, stop, JP_ROUND_LEAVING);
    } else if (!round->internal.is_at_charger) {
        set_out_home(round, available);
    } else {
        round->stop = stop;
        fail(round, JP_ROUND_NO_ENERGY);
    }
}

static void charge(struct jp_patrol_round *round, float available)
{
    const uint16_t count = round->internal.config.stop_count;

    if (available >= round->internal.config.full) {
        leave_for(round, (uint16_t)(round->visits + round->skipped) % count, available);
    }
}

static bool has_reached(const struct jp_patrol_round *round)
{
    uint16_t of;

    return jp_patrol_pilot_reached(round->internal.pilot, &of) == 1U;
}

static void arrive(struct jp_patrol_round *round, float available)
{
    end_journey(round, 0.0f, available);
    round->internal.failures = 0;
    round->reason = JP_ROUND_NO_REASON;
    if (round->state == JP_ROUND_LEAVING) {
        round->internal.is_at_charger = false;
        round->internal.stayed = 0.0f;
        round->visits = jp_one_more32(round->visits);
        round->state = JP_ROUND_DWELLING;
    } else {
        round->charges = jp_one_more32(round->charges);
        round->least_left = jp_plane_smaller(round->least_left, available);
        begin_survey(round);
    }
}

static void wait(struct jp_patrol_round *round)
{
    round->state = JP_ROUND_WAITING;
    round->reason = JP_ROUND_NO_WAY;
    round->internal.stayed = 0.0f;
}

static void try_again(struct jp_patrol_round *round, float seconds)
{
    round->internal.stayed += seconds;
    if (round->internal.stayed >= JP_ROUND_WAIT) {
        (void)jp_patrol_pilot_forget_marks(round->internal.pilot);
        go_home(round);
    }
}

/** A place that cannot be reached now, as somebody stands in the way, is left out; home is tried again. */
static void pass_over(struct jp_patrol_round *round, float available)
{
    const bool is_home = round->state == JP_ROUND_HOMING;

    round->internal.failures = jp_one_more16(round->internal.failures);
    if (!is_home) {
        end_journey(round, 0.0f, available);
        begin_journey(round, available);
    }
    if (jp_four_wheel_robot_state_now(round->internal.pilot->internal.robot) == JP_FOUR_WHEEL_ROBOT_IDLE) {
        fail(round, JP_ROUND_DRIVES_OFF);
    } else if (round->internal.failures > round->internal.config.stop_count) {
        wait(round);
    } else if (is_home || available < needed_for(round, next_stop(round))) {
        go_home(round);
    } else {
        round->skipped = jp_one_more32(round->skipped);
        round->internal.is_at_charger = false;
        go(round, next_stop(round), JP_ROUND_LEAVING);
    }
}

/** On its way: to a stop it turns back when what is left, and home from there, would take more than there is. */
static void be_under_way(struct jp_patrol_round *round, float available)
{
    struct jp_patrol_leg_forecast left;
    float length;

    if (jp_patrol_pilot_progress(round->internal.pilot, &length, &left) != JP_OK) {
        return;
    }
    foretell_journey(round, &left, available);
    if (round->state == JP_ROUND_LEAVING && available < bound_of(round, &left) + needed_home(round, round->stop)) {
        end_journey(round, left.energy, available);
        set_out_home(round, available);
    }
}

static void drive(struct jp_patrol_round *round, float available)
{
    if (jp_patrol_pilot_is_under_way(round->internal.pilot)) {
        be_under_way(round, available);
    } else if (has_reached(round)) {
        arrive(round, available);
    } else {
        pass_over(round, available);
    }
}

static void dwell(struct jp_patrol_round *round, float available, float seconds)
{
    round->internal.stayed += seconds;
    if (available < needed_home(round, round->stop)) {
        set_out_home(round, available);
    } else if (round->internal.stayed >= round->internal.config.stops[round->stop].dwell) {
        leave_for(round, next_stop(round), available);
    }
}

enum jp_patrol_round_state jp_patrol_round_work(struct jp_patrol_round *round, float available, float seconds)
{
    switch (round->state) {
    case JP_ROUND_SURVEYING:
        survey(round);
        break;
    case JP_ROUND_CHARGING:
        charge(round, available);
        break;
    case JP_ROUND_LEAVING:
    case JP_ROUND_HOMING:
        drive(round, available);
        break;
    case JP_ROUND_DWELLING:
        dwell(round, available, seconds);
        break;
    case JP_ROUND_WAITING:
        try_again(round, seconds);
        break;
    case JP_ROUND_FAILED:
    default:
        break;
    }
    return round->state;
}
