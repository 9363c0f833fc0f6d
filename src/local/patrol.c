#include <joulepath/patrol.h>

#include <string.h>

#include "src/base/config_float_check.h"
#include "src/base/plane.h"
#include "src/local/patrol_drive.h"
#include "src/local/patrol_glide.h"
#include "src/local/patrol_path.h"
#include "src/local/patrol_room.h"
#include "src/local/patrol_sense.h"
#include "src/local/patrol_state.h"
#include "src/local/patrol_turn.h"
#include "src/local/patrol_yield.h"

/* Obstacles may look this much nearer than they are, m. */
#define DOUBT 0.05f

/* To stop in, beyond what the deceleration takes, m. */
#define STOP_DISTANCE 0.3f

/* Cycles without getting on before the robot counts as stalled, times waits_max. */
#define STALL_WAITS 2U

#define LEAST      1.0e-3f
#define VALUE_MAX  1000.0f
#define PRICE_MAX  1.0e9f
#define WORTH_MAX  1024.0f
#define SPEED_MAX  16.0f /* that a twist may have, m/s and rad/s */
#define CYCLES_MAX 10000.0f

/* ---- Configuration ---- */

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_patrol_config, member, low, high)

static enum jp_status check(const struct jp_patrol_config *config, const char **field)
{
    static const struct jp_config_float_field fields[] = {
        FIELD(scan.range_max, LEAST, VALUE_MAX),
        FIELD(scan.gap, LEAST, VALUE_MAX),
        FIELD(scan.tolerance, LEAST, VALUE_MAX),
        FIELD(scan.beams_min, 1.0f, VALUE_MAX),
        FIELD(price.second, LEAST, PRICE_MAX),
        FIELD(price.worth, 0.0f, WORTH_MAX),
        FIELD(price.turning, 0.0f, PRICE_MAX),
        FIELD(price.steering, 0.0f, PRICE_MAX),
        FIELD(glide_clearance, 0.0f, VALUE_MAX),
        FIELD(turn_first, LEAST, JP_PLANE_PI),
        FIELD(teb.speed_max, LEAST, SPEED_MAX),
        FIELD(teb.reverse_max, LEAST, SPEED_MAX),
        FIELD(teb.turn_rate_max, LEAST, SPEED_MAX),
        FIELD(turn_rate, LEAST, SPEED_MAX),
        FIELD(turn_acceleration, LEAST, VALUE_MAX),
        FIELD(steering_rate, LEAST, VALUE_MAX),
        FIELD(turn_clearance, 0.0f, VALUE_MAX),
        FIELD(step_speed, LEAST, SPEED_MAX),
        FIELD(horizon, LEAST, VALUE_MAX),
        FIELD(position_tolerance, LEAST, VALUE_MAX),
        FIELD(heading_tolerance, LEAST, JP_PLANE_PI),
        FIELD(period, LEAST, VALUE_MAX),
        FIELD(latency, 0.0f, 1.0f),
        FIELD(jump, LEAST, VALUE_MAX),
        FIELD(blind_max, 0.0f, VALUE_MAX),
        FIELD(movers.extent, LEAST, VALUE_MAX),
        FIELD(movers.range, LEAST, VALUE_MAX),
        FIELD(movers.speed_min, LEAST, VALUE_MAX),
        FIELD(movers.speed_max, LEAST, VALUE_MAX),
        FIELD(movers.margin, 0.0f, VALUE_MAX),
        FIELD(people.clearance, 0.0f, VALUE_MAX),
        FIELD(people.braking, LEAST, VALUE_MAX),
        FIELD(people.acceleration, LEAST, VALUE_MAX),
        FIELD(people.rest, 0.0f, VALUE_MAX),
        FIELD(people.stays, 0.0f, VALUE_MAX),
        FIELD(waits_max, 1.0f, CYCLES_MAX),
        FIELD(dropouts_max, 0.0f, CYCLES_MAX),
    };
    const enum jp_status status = jp_config_float_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status == JP_OK && config->strategy > (uint8_t)JP_PATROL_BY_COST) {
        return jp_config_refuse("strategy", field);
    }
    if (status == JP_OK && config->heading_tolerance > config->turn_first) {
        return jp_config_refuse("heading_tolerance", field);
    }
    if (status == JP_OK && config->movers.speed_max < config->movers.speed_min) {
        return jp_config_refuse("movers.speed_max", field);
    }
    return status;
}

enum jp_status jp_patrol_init(struct jp_patrol *patrol, const struct jp_patrol_config *config, const char **field)
{
    if (patrol == NULL || config == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }

    enum jp_status status = jp_four_wheel_check(&config->wheels, field);

    if (status == JP_OK) {
        status = check(config, field);
    }
    if (status != JP_OK) {
        return status;
    }
    (void)memset(patrol, 0, sizeof *patrol);
    patrol->config = *config;
    patrol->internal.scan_gap = UINT16_MAX; /* nothing is driven before the first scan */
    return jp_teb_init(&patrol->teb, &config->teb, field);
}

/* ---- What is asked for ---- */

enum jp_status jp_patrol_set_pose(struct jp_patrol *patrol, const struct jp_plane_pose *pose)
{
    if (patrol == NULL || pose == NULL || !jp_plane_is_pose(pose)) {
        return JP_ERR_ARGUMENT;
    }
    patrol->pose = *pose;
    patrol->pose.heading = jp_plane_wrap(pose->heading);
    patrol->internal.jumps = 0;
    patrol->internal.blind = 0.0f;
    jp_teb_clear(&patrol->teb);
    return JP_OK;
}

enum jp_status jp_patrol_follow(struct jp_patrol *patrol, const struct jp_point *path, uint16_t count,
                                const struct jp_patrol_goal *goal)
{
    if (patrol == NULL || path == NULL || goal == NULL || count < 2U || !jp_plane_is_pose(&goal->pose)) {
        return JP_ERR_ARGUMENT;
    }

    const struct jp_plane_point end = jp_patrol_path_point(&path[count - 1U]);

    if (jp_plane_length(end.x - goal->pose.x, end.y - goal->pose.y) > patrol->config.position_tolerance) {
        return JP_ERR_ARGUMENT;
    }
    patrol->internal.path = path;
    patrol->internal.path_count = count;
    patrol->internal.path_next = 0;
    patrol->internal.room_next = 0;
    patrol->internal.goal = *goal;
    patrol->internal.is_arriving = false;
    patrol->internal.waited = 0;
    patrol->internal.unmoved = 0;
    jp_teb_clear(&patrol->teb);
    jp_patrol_enter(patrol, JP_PATROL_DRIVING, JP_PATROL_NONE);
    return JP_OK;
}

void jp_patrol_hold(struct jp_patrol *patrol)
{
    jp_patrol_enter(patrol, JP_PATROL_HELD, JP_PATROL_NONE);
}

void jp_patrol_pause(struct jp_patrol *patrol)
{
    if (patrol->state == JP_PATROL_DRIVING && !patrol->internal.is_arriving) {
        struct jp_patrol_window window;
        const float speed = patrol->internal.command.forward;

        jp_patrol_look_ahead(patrol, speed * speed / patrol->config.teb.acceleration + STOP_DISTANCE, &window);
        patrol->internal.path_count = (uint16_t)(window.first + window.count);
        patrol->internal.goal = (struct jp_patrol_goal){window.end, true};
    } else if (patrol->internal.path != NULL) {
        jp_patrol_hold(patrol);
    }
}

/* ---- A cycle ---- */

static bool is_under_way(const struct jp_patrol *patrol)
{
    return patrol->state == JP_PATROL_TURNING || patrol->state == JP_PATROL_DRIVING ||
           patrol->state == JP_PATROL_STEPPING || patrol->state == JP_PATROL_GLIDING ||
           patrol->state == JP_PATROL_WAITING;
}

/* What forbids any motion now. */
static enum jp_patrol_reason obstruction(const struct jp_patrol *patrol, bool is_lost)
{
    if (jp_patrol_uses_laser(patrol) && (is_lost || patrol->internal.jumps > patrol->config.dropouts_max ||
                                         patrol->internal.blind > patrol->config.blind_max)) {
        return JP_PATROL_LOST;
    }
    if (patrol->internal.scan_gap > patrol->config.dropouts_max) {
        return JP_PATROL_NO_SCAN;
    }
    /* A step leads out of what may be a collision. */
    const float least = patrol->state == JP_PATROL_STEPPING ? -DOUBT : 0.0f;

    return jp_patrol_clearance(patrol, &patrol->pose) < least ? JP_PATROL_IN_COLLISION : JP_PATROL_NONE;
}

static void count_patience(struct jp_patrol *patrol)
{
    /* Who yields gets on when people let it. */
    patrol->internal.unmoved = (uint16_t)(patrol->internal.unmoved + (patrol->internal.is_yielding ? 0U : 1U));
    if (patrol->state == JP_PATROL_WAITING && !patrol->internal.is_yielding &&
        ++patrol->internal.waited > patrol->config.waits_max) {
        jp_patrol_stop(patrol, patrol->reason);
    } else if (patrol->internal.unmoved > STALL_WAITS * patrol->config.waits_max) {
        jp_patrol_stop(patrol, JP_PATROL_STALLED);
    }
}

/* The step out of what scans see as a collision and may be none, of a robot that stands: to where there is room, else
 * to where there is some. */
static bool find_step_aside(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    struct jp_patrol_step_search search = {.heading = patrol->pose.heading, .clearance = patrol->config.teb.clearance};

    patrol->internal.step_clearance = jp_patrol_step_clearance(&patrol->config);
    if (!patrol->config.turns_in_place || !jp_patrol_is_standing(speed) ||
        jp_patrol_clearance(patrol, &patrol->pose) <= -DOUBT) {
        return false;
    }
    if (jp_patrol_find_step(patrol, &search, &patrol->internal.step_target)) {
        return true;
    }
    search.clearance = patrol->config.turn_clearance;
    return jp_patrol_find_step(patrol, &search, &patrol->internal.step_target);
}

static void act(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    switch (patrol->state) {
    case JP_PATROL_TURNING:
        jp_patrol_correct_pose(patrol);
        jp_patrol_turn(patrol, speed);
        break;
    case JP_PATROL_STEPPING:
        jp_patrol_correct_pose(patrol);
        jp_patrol_step(patrol, speed);
        break;
    case JP_PATROL_GLIDING:
        jp_patrol_correct_pose(patrol);
        jp_patrol_glide(patrol);
        break;
    case JP_PATROL_DRIVING:
    case JP_PATROL_WAITING:
    default:
        jp_patrol_drive(patrol, speed);
        break;
    }
}

static void go_on(struct jp_patrol *patrol, const struct jp_patrol_input *input)
{
    const struct jp_plane_speed *const speed = &input->speed;
    const enum jp_patrol_reason reason = obstruction(patrol, input->is_lost);

    if (reason == JP_PATROL_NONE) {
        act(patrol, speed);
    } else if (reason == JP_PATROL_IN_COLLISION && find_step_aside(patrol, speed)) {
        jp_patrol_correct_pose(patrol);
        jp_patrol_begin_step(patrol);
    } else {
        jp_patrol_correct_pose(patrol);
        jp_patrol_wait(patrol, reason);
    }
    if (is_under_way(patrol)) {
        jp_patrol_yield(patrol, speed);
        count_patience(patrol);
    }
}

static jp_q24 to_q24(float value)
{
    return (jp_q24)(value * (float)JP_Q24_ONE);
}

/* Wheels that cannot do it are not asked to. */
static void give_command(struct jp_patrol *patrol, struct jp_twist *twist)
{
    struct jp_wheels wheels = {{0}, {0}};

    *twist = (struct jp_twist){to_q24(patrol->internal.command.forward), to_q24(patrol->internal.sideways),
                               to_q24(patrol->internal.command.turn_rate)};
    if (jp_four_wheel_inverse(&patrol->config.wheels, twist, &wheels) != JP_OK) {
        jp_patrol_stop(patrol, JP_PATROL_INFEASIBLE);
        *twist = (struct jp_twist){0, 0, 0};
    }
}

static bool is_input_sound(const struct jp_patrol_input *input)
{
    return jp_plane_is_pose(&input->wheels) && (!input->has_laser || jp_plane_is_pose(&input->laser)) &&
           jp_plane_is_pose(&input->sensor) && jp_plane_is_between(input->deviation, 0.0f, VALUE_MAX) &&
           jp_plane_is_between(input->speed.forward, -VALUE_MAX, VALUE_MAX) &&
           jp_plane_is_between(input->speed.turn_rate, -VALUE_MAX, VALUE_MAX);
}

enum jp_status jp_patrol_cycle(struct jp_patrol *patrol, const struct jp_patrol_input *input, struct jp_twist *twist)
{
    if (patrol == NULL || input == NULL || twist == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *twist = (struct jp_twist){0, 0, 0};
    if (!is_input_sound(input)) {
        jp_patrol_stop(patrol, JP_PATROL_LOST);
        return JP_ERR_ARGUMENT;
    }
    patrol->counts.cycles++;
    jp_patrol_predict_pose(patrol, input);
    jp_patrol_look(patrol, input);
    if (is_under_way(patrol)) {
        go_on(patrol, input);
        give_command(patrol, twist);
    } else {
        jp_patrol_correct_pose(patrol);
    }
    return JP_OK;
}
