#include <joulepath/patrol.h>

#include <string.h>

#include "patrol_path.h"
#include "patrol_room.h"
#include "plane.h"

/* Slower than this the robot stands, m/s and rad/s. */
#define STANDSTILL_SPEED     0.03f
#define STANDSTILL_TURN_RATE 0.05f

/* A turn looks as far ahead as it needs to stop, and this time, s. */
#define TURN_FORESIGHT 0.25f
#define TURN_MARGIN    0.05f /* rad */

/* Obstacles may look this much nearer than they are, m. */
#define DOUBT 0.05f

/* A step ends this near its target; one to the goal is at most so long, m. */
#define STEP_TOLERANCE 0.03f
#define STEP_REACH     0.4f

/* A command is good when the robot could hold it for so many steps, of so many s. */
#define COMMAND_STEPS 3U
#define COMMAND_STEP  0.1f

/* To stop in, beyond what the deceleration takes, m. */
#define STOP_DISTANCE 0.3f

/* Cycles in a row with a way before the robot goes on; twice as many after each time that it did not get on then, so
 * that it does not try again and again where a way comes and goes. */
#define FREE_CYCLES 3U
#define TRIES_MAX   8U

/* Cycles without getting on before the robot counts as stalled, times waits_max. */
#define STALL_WAITS 2U

#define VALUE_MAX  1000.0f
#define SPEED_MAX  16.0f /* that a twist may have, m/s and rad/s */
#define CYCLES_MAX 10000.0f

/* ---- Configuration ---- */

static const char *wrong_field(const struct jp_patrol_config *config)
{
    const float least = 1.0e-3f;
    const struct {
        float value;
        float low;
        float high;
        const char *name;
    } fields[] = {
        {config->scan.range_max, least, VALUE_MAX, "scan.range_max"},
        {config->scan.gap, least, VALUE_MAX, "scan.gap"},
        {config->scan.tolerance, least, VALUE_MAX, "scan.tolerance"},
        {(float)config->scan.beams_min, 1.0f, VALUE_MAX, "scan.beams_min"},
        {config->turn_first, least, JP_PLANE_PI, "turn_first"},
        {config->teb.speed_max, least, SPEED_MAX, "teb.speed_max"},
        {config->teb.reverse_max, least, SPEED_MAX, "teb.reverse_max"},
        {config->teb.turn_rate_max, least, SPEED_MAX, "teb.turn_rate_max"},
        {config->turn_rate, least, SPEED_MAX, "turn_rate"},
        {config->turn_acceleration, least, VALUE_MAX, "turn_acceleration"},
        {config->turn_clearance, 0.0f, VALUE_MAX, "turn_clearance"},
        {config->step_speed, least, SPEED_MAX, "step_speed"},
        {config->horizon, least, VALUE_MAX, "horizon"},
        {config->position_tolerance, least, VALUE_MAX, "position_tolerance"},
        {config->heading_tolerance, least, config->turn_first, "heading_tolerance"},
        {config->period, least, VALUE_MAX, "period"},
        {config->latency, 0.0f, 1.0f, "latency"},
        {config->jump, least, VALUE_MAX, "jump"},
        {config->blind_max, 0.0f, VALUE_MAX, "blind_max"},
        {config->movers.extent, least, VALUE_MAX, "movers.extent"},
        {config->movers.speed_min, least, VALUE_MAX, "movers.speed_min"},
        {config->movers.speed_max, config->movers.speed_min, VALUE_MAX, "movers.speed_max"},
        {config->movers.margin, 0.0f, VALUE_MAX, "movers.margin"},
        {(float)config->waits_max, 1.0f, CYCLES_MAX, "waits_max"},
        {(float)config->dropouts_max, 0.0f, CYCLES_MAX, "dropouts_max"},
    };

    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        if (!jp_plane_is_between(fields[i].value, fields[i].low, fields[i].high)) {
            return fields[i].name;
        }
    }
    return NULL;
}

enum jp_status jp_patrol_init(struct jp_patrol *patrol, const struct jp_patrol_config *config, const char **field)
{
    if (patrol == NULL || config == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (jp_four_wheel_check(&config->wheels, field) != JP_OK) {
        return JP_ERR_CONFIG;
    }
    *field = wrong_field(config);
    if (*field != NULL) {
        return JP_ERR_CONFIG;
    }
    (void)memset(patrol, 0, sizeof *patrol);
    patrol->config = *config;
    patrol->scan_gap = UINT16_MAX; /* nothing is driven before the first scan */
    return jp_teb_init(&patrol->teb, &config->teb, field);
}

/* ---- What is asked for ---- */

static void stand(struct jp_patrol *patrol)
{
    patrol->command = (struct jp_plane_speed){0.0f, 0.0f};
    patrol->sideways = 0.0f;
}

enum jp_status jp_patrol_set_pose(struct jp_patrol *patrol, const struct jp_plane_pose *pose)
{
    if (patrol == NULL || pose == NULL || !jp_plane_is_pose(pose)) {
        return JP_ERR_ARGUMENT;
    }
    patrol->pose = *pose;
    patrol->pose.heading = jp_plane_wrap(pose->heading);
    patrol->jumps = 0;
    patrol->blind = 0.0f;
    jp_teb_clear(&patrol->teb);
    return JP_OK;
}

static float point_distance(const struct jp_plane_pose *pose, float x, float y)
{
    return jp_plane_length(x - pose->x, y - pose->y);
}

enum jp_status jp_patrol_follow(struct jp_patrol *patrol, const struct jp_path_point *path, uint16_t count,
                                const struct jp_patrol_goal *goal)
{
    if (patrol == NULL || path == NULL || goal == NULL || count < 2U || !jp_plane_is_pose(&goal->pose)) {
        return JP_ERR_ARGUMENT;
    }

    const struct jp_plane_point end = jp_patrol_path_point(&path[count - 1U]);

    if (point_distance(&goal->pose, end.x, end.y) > patrol->config.position_tolerance) {
        return JP_ERR_ARGUMENT;
    }
    patrol->path = path;
    patrol->path_count = count;
    patrol->path_next = 0;
    patrol->goal = *goal;
    patrol->state = JP_PATROL_DRIVING;
    patrol->reason = JP_PATROL_NONE;
    patrol->is_arriving = false;
    patrol->waited = 0;
    patrol->unmoved = 0;
    jp_teb_clear(&patrol->teb);
    return JP_OK;
}

void jp_patrol_hold(struct jp_patrol *patrol)
{
    patrol->path = NULL;
    patrol->state = JP_PATROL_HELD;
    patrol->reason = JP_PATROL_NONE;
    stand(patrol);
}

void jp_patrol_pause(struct jp_patrol *patrol)
{
    if (patrol->state == JP_PATROL_DRIVING && !patrol->is_arriving) {
        struct jp_patrol_window window;
        const float speed = patrol->command.forward;

        jp_patrol_look_ahead(patrol, speed * speed / patrol->config.teb.acceleration + STOP_DISTANCE, &window);
        patrol->path_count = (uint16_t)(window.first + window.count);
        patrol->goal = (struct jp_patrol_goal){window.end, true};
    } else if (patrol->path != NULL) {
        jp_patrol_hold(patrol);
    }
}

static void stop(struct jp_patrol *patrol, enum jp_patrol_reason reason)
{
    patrol->state = JP_PATROL_STOPPED;
    patrol->reason = reason;
    stand(patrol);
}

static void wait(struct jp_patrol *patrol, enum jp_patrol_reason reason)
{
    if (patrol->state != JP_PATROL_WAITING) {
        patrol->state = JP_PATROL_WAITING;
        patrol->waited = 0;
        patrol->counts.waits++;
    }
    patrol->reason = reason;
    patrol->free_cycles = 0;
    stand(patrol);
}

/* ---- Where the robot is, and what is around it ---- */

static bool uses_laser(const struct jp_patrol *patrol)
{
    return patrol->config.teb.weights.laser_odometry > 0.0f;
}

/* Saturates: a gap that lasts for hours must not look like a short one. */
static uint16_t one_more(uint16_t count)
{
    return count < UINT16_MAX ? (uint16_t)(count + 1U) : count;
}

static bool is_jump(const struct jp_patrol *patrol, const struct jp_plane_pose *laser)
{
    const struct jp_plane_pose away = jp_plane_relative(&patrol->pose, laser);

    return jp_plane_length(away.x, away.y) > patrol->config.jump ||
           jp_plane_magnitude(away.heading) > patrol->config.jump;
}

static void judge_laser(struct jp_patrol *patrol, const struct jp_patrol_input *input)
{
    patrol->is_measured = false;
    if (!input->has_laser) {
        patrol->counts.laser_missing++;
    } else if (is_jump(patrol, &input->laser)) {
        patrol->counts.laser_rejected++;
        patrol->jumps = one_more(patrol->jumps);
    } else {
        patrol->is_measured = true;
        patrol->seen = input->laser;
        patrol->jumps = 0;
        patrol->blind = 0.0f;
    }
}

/* The wheels' motion since the last cycle, then the laser's judgement of it. */
static void predict_pose(struct jp_patrol *patrol, const struct jp_patrol_input *input)
{
    if (patrol->has_wheels) {
        const struct jp_plane_pose motion = jp_plane_relative(&patrol->wheels, &input->wheels);

        patrol->pose = jp_plane_compose(&patrol->pose, &motion);
        patrol->blind += jp_plane_length(motion.x, motion.y);
    }
    patrol->wheels = input->wheels;
    patrol->has_wheels = true;
    if (uses_laser(patrol)) {
        judge_laser(patrol, input);
    }
}

/* The mean of wheels and laser by the weights of their residuals: where these alone would put the band's first pose. */
static void correct_pose(struct jp_patrol *patrol)
{
    const struct jp_teb_weights *const weights = &patrol->config.teb.weights;

    if (patrol->is_measured) {
        const float share = weights->laser_odometry / (weights->laser_odometry + weights->wheel_odometry);
        const struct jp_plane_pose *const seen = &patrol->seen;

        patrol->pose.x += share * (seen->x - patrol->pose.x);
        patrol->pose.y += share * (seen->y - patrol->pose.y);
        patrol->pose.heading =
            jp_plane_wrap(patrol->pose.heading + share * jp_plane_wrap(seen->heading - patrol->pose.heading));
    }
}

/* The obstacles of the last scan stay when one is missing: they stand in the map's frame. */
static void look(struct jp_patrol *patrol, const struct jp_patrol_input *input)
{
    const struct jp_plane_pose sensor = jp_plane_compose(&patrol->pose, &input->sensor);
    const struct jp_plane_point centre = {patrol->pose.x, patrol->pose.y};
    const float period = patrol->config.period * (float)(patrol->scan_gap + 1U);
    struct jp_obstacles seen;

    jp_obstacles_clear(&seen, &centre);
    if (input->scan.ranges == NULL ||
        jp_obstacles_add_scan(&seen, &patrol->config.scan, &input->scan, &sensor) != JP_OK) {
        patrol->counts.scans_missing++;
        patrol->scan_gap = one_more(patrol->scan_gap);
        return;
    }
    (void)jp_movers_update(&patrol->movers, &patrol->config.movers, &patrol->config.scan, &input->scan, &sensor,
                           period);
    jp_movers_mark(&patrol->movers, &patrol->config.movers, &seen);
    patrol->scan_gap = 0;
    patrol->obstacles = seen;
    patrol->counts.shapes_dropped += seen.dropped;
}

/* ---- Turning in place ---- */

/* The step to the goal, if it is near and not behind. */
static bool find_step_to_goal(struct jp_patrol *patrol)
{
    const struct jp_plane_pose rest = jp_plane_relative(&patrol->pose, &patrol->goal.pose);
    const struct jp_plane_pose step = {rest.x, rest.y, 0.0f};
    const float away = jp_plane_length(rest.x, rest.y);

    patrol->step_target = (struct jp_plane_point){patrol->goal.pose.x, patrol->goal.pose.y};
    return away > STEP_TOLERANCE && away < STEP_REACH && rest.x > -STEP_TOLERANCE &&
           jp_patrol_is_step_free(patrol, &step);
}

/* Where a turn to a heading is free: at the goal itself, if the robot has arrived beside it. */
static bool find_step(struct jp_patrol *patrol, float heading)
{
    return patrol->is_arriving ? find_step_to_goal(patrol) : jp_patrol_find_step(patrol, heading, &patrol->step_target);
}

/* Whether there has been a way for long enough; to be asked once in a cycle with one. */
static bool may_go_on(struct jp_patrol *patrol)
{
    if (patrol->state != JP_PATROL_WAITING) {
        return true;
    }
    patrol->free_cycles++;
    if (patrol->free_cycles < FREE_CYCLES << patrol->tries) {
        return false;
    }
    if (patrol->tries < TRIES_MAX) {
        patrol->tries++;
    }
    return true;
}

static void begin_step(struct jp_patrol *patrol)
{
    if (may_go_on(patrol)) {
        patrol->state = JP_PATROL_STEPPING;
        patrol->reason = JP_PATROL_NONE;
        patrol->counts.steps++;
    }
    stand(patrol);
}

static void begin_turn(struct jp_patrol *patrol, float heading, float angle)
{
    if (may_go_on(patrol)) {
        patrol->state = JP_PATROL_TURNING;
        patrol->reason = JP_PATROL_NONE;
        patrol->turn_target = heading;
        patrol->turn_rest = angle;
        patrol->counts.turns++;
        jp_teb_clear(&patrol->teb);
    }
    stand(patrol);
}

/* Turns in place, from where there is room for it. */
static void turn_to(struct jp_patrol *patrol, float heading)
{
    float angle;

    if (jp_patrol_find_turn(patrol, &patrol->pose, heading, &angle)) {
        begin_turn(patrol, heading, angle);
    } else if (find_step(patrol, heading)) {
        begin_step(patrol);
    } else {
        patrol->counts.infeasible++;
        wait(patrol, JP_PATROL_NO_WAY);
    }
}

/* What is left of the turn. Of the angles to its heading it is the one nearest to what was left before: the turn may be
 * the longer way round. */
static float rest_of_turn(struct jp_patrol *patrol)
{
    const float rest = patrol->turn_target - patrol->pose.heading;

    patrol->turn_rest += jp_plane_wrap(rest - patrol->turn_rest);
    return patrol->turn_rest;
}

static void end_turn(struct jp_patrol *patrol)
{
    stand(patrol);
    if (patrol->is_arriving) {
        patrol->state = JP_PATROL_ARRIVED;
        patrol->path = NULL;
    } else {
        patrol->state = JP_PATROL_DRIVING;
    }
}

static void turn(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    const struct jp_patrol_config *const config = &patrol->config;
    const float rest = rest_of_turn(patrol);
    const float angle = jp_plane_magnitude(rest);
    const bool is_there = angle < 0.5f * config->heading_tolerance;

    if (is_there && jp_plane_magnitude(speed->turn_rate) < STANDSTILL_TURN_RATE) {
        end_turn(patrol);
        return;
    }
    /* What is in the way now stops the turn. */
    const float rate_now = jp_plane_magnitude(patrol->command.turn_rate);
    const float ahead = rate_now * (TURN_FORESIGHT + 0.5f * rate_now / config->turn_acceleration) + TURN_MARGIN;

    if (!jp_patrol_is_turn_free(patrol, &patrol->pose, jp_plane_clamp(rest, -ahead, ahead))) {
        wait(patrol, JP_PATROL_NO_WAY);
        return;
    }

    /* Half of the deceleration leaves room for the wheels' lag. */
    const float stopping = jp_plane_square_root(config->turn_acceleration * angle);
    const float rising = jp_plane_magnitude(patrol->command.turn_rate) + config->turn_acceleration * config->period;
    const float slower = stopping < config->turn_rate ? stopping : config->turn_rate;
    const float rate = is_there ? 0.0f : slower < rising ? slower : rising;

    patrol->command = (struct jp_plane_speed){0.0f, rest < 0.0f ? -rate : rate};
}

static bool is_standing(const struct jp_plane_speed *speed)
{
    return jp_plane_magnitude(speed->forward) < STANDSTILL_SPEED &&
           jp_plane_magnitude(speed->turn_rate) < STANDSTILL_TURN_RATE;
}

/* ---- A step ---- */

static void go_step(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    const struct jp_plane_pose target = {patrol->step_target.x, patrol->step_target.y, patrol->pose.heading};
    const struct jp_plane_pose rest = jp_plane_relative(&patrol->pose, &target);
    const float away = jp_plane_length(rest.x, rest.y);

    stand(patrol);
    if (away < STEP_TOLERANCE) {
        patrol->state = is_standing(speed) ? JP_PATROL_DRIVING : JP_PATROL_STEPPING;
    } else if (!jp_patrol_is_step_free(patrol, &rest)) {
        wait(patrol, JP_PATROL_NO_WAY);
    } else {
        const float stopping = away / (2.0f * patrol->config.period);
        const float rate = (stopping < patrol->config.step_speed ? stopping : patrol->config.step_speed) / away;

        patrol->command.forward = rate * rest.x;
        patrol->sideways = rate * rest.y;
    }
}

/* ---- Driving ---- */

static float goal_heading_error(const struct jp_patrol *patrol)
{
    return patrol->goal.is_heading_free
               ? 0.0f
               : jp_plane_magnitude(jp_plane_wrap(patrol->goal.pose.heading - patrol->pose.heading));
}

/* As near as it gets: within a third of the tolerance, or within it and past the goal or at a stand. Once there the
 * robot stands before anything else. */
static bool is_at_goal(const struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    const struct jp_plane_pose there = jp_plane_relative(&patrol->pose, &patrol->goal.pose);
    const float away = jp_plane_length(there.x, there.y);
    const float tolerance = patrol->config.position_tolerance;
    const bool is_heading_due =
        !patrol->config.turns_in_place && goal_heading_error(patrol) > patrol->config.heading_tolerance;

    return patrol->is_arriving ||
           (!is_heading_due && away < tolerance && (3.0f * away < tolerance || there.x <= 0.0f || is_standing(speed)));
}

/* Whether any heading will do to reach the end of the window: the robot turns there afterwards. */
static bool may_turn_at_goal(const struct jp_patrol *patrol, const struct jp_patrol_window *window)
{
    const struct jp_plane_pose there = {patrol->goal.pose.x, patrol->goal.pose.y, window->end.heading};
    float angle;

    return patrol->goal.is_heading_free ||
           (patrol->config.turns_in_place && jp_patrol_find_turn(patrol, &there, patrol->goal.pose.heading, &angle));
}

/* Where a pose will be when the wheels do what is asked of them now. */
static struct jp_plane_pose after_latency(const struct jp_patrol *patrol, const struct jp_plane_pose *pose,
                                          const struct jp_plane_speed *speed)
{
    const float latency = patrol->config.latency;
    const struct jp_plane_pose half_turn = {0.0f, 0.0f, 0.5f * latency * speed->turn_rate};
    const struct jp_plane_pose way = {latency * speed->forward, 0.0f, half_turn.heading};
    const struct jp_plane_pose middle = jp_plane_compose(pose, &half_turn);

    return jp_plane_compose(&middle, &way);
}

static struct jp_teb_task task_of(const struct jp_patrol *patrol, const struct jp_patrol_window *window,
                                  const struct jp_plane_speed *speed)
{
    struct jp_teb_task task = {
        .start = after_latency(patrol, &patrol->pose, speed),
        .measured = after_latency(patrol, &patrol->seen, speed),
        .is_measured = patrol->is_measured,
        .speed = *speed,
        .goal = window->end,
        .goal_speed = window->is_goal ? 0.0f : patrol->config.teb.speed_max,
        .path = &patrol->path[window->first],
        .path_count = window->count,
    };

    if (window->is_goal) {
        task.is_heading_free = may_turn_at_goal(patrol, window);
        if (!task.is_heading_free) {
            task.goal = patrol->goal.pose;
        } else {
            task.goal.x = patrol->goal.pose.x;
            task.goal.y = patrol->goal.pose.y;
        }
    }
    return task;
}

/* Whether the way is free at this speed until the next cycle's command can act. */
static bool is_command_free(const struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    const struct jp_plane_pose step = {speed->forward * COMMAND_STEP, 0.0f, speed->turn_rate * COMMAND_STEP};
    struct jp_plane_pose pose = patrol->pose;

    for (unsigned i = 0; i < COMMAND_STEPS; i++) {
        pose = jp_plane_compose(&pose, &step);
        if (jp_patrol_clearance(patrol, &pose) < 0.0f) {
            return false;
        }
    }
    return true;
}

/* Fastest forward or backward speed now: speeding up takes a while, and at the goal the robot must stop with half of
 * the deceleration that the band may use, as the wheels lag behind. */
static float speed_limit(const struct jp_patrol *patrol)
{
    const float acceleration = patrol->config.teb.acceleration;
    const float rising = jp_plane_magnitude(patrol->command.forward) + acceleration * patrol->config.period;
    const float away = point_distance(&patrol->pose, patrol->goal.pose.x, patrol->goal.pose.y);
    const float stopping = jp_plane_square_root(acceleration * away);

    return rising < stopping ? rising : stopping;
}

/* On the same curve. */
static struct jp_plane_speed reachable(const struct jp_patrol *patrol, const struct jp_plane_speed *wanted)
{
    const float limit = speed_limit(patrol);
    const float speed = jp_plane_magnitude(wanted->forward);

    if (speed <= limit) {
        return *wanted;
    }
    return (struct jp_plane_speed){wanted->forward * (limit / speed), wanted->turn_rate * (limit / speed)};
}

/* Plans the band and takes its speed; false, and the reason, when there is no way. */
static bool plan_band(struct jp_patrol *patrol, const struct jp_patrol_window *window,
                      const struct jp_plane_speed *speed, enum jp_patrol_reason *reason)
{
    /* While it waited the wheels slowed down by themselves. */
    if (patrol->state == JP_PATROL_WAITING) {
        patrol->command = *speed;
    }

    const struct jp_teb_task task = task_of(patrol, window, speed);
    const enum jp_status status = jp_teb_plan(&patrol->teb, &task, &patrol->obstacles, &patrol->band);

    correct_pose(patrol);
    if (status == JP_OK) {
        const struct jp_plane_speed next = reachable(patrol, &patrol->band.speed);

        if (is_command_free(patrol, &next)) {
            patrol->command = next;
            return true;
        }
    }
    patrol->counts.infeasible++;
    *reason = status == JP_ERR_BLOCKED ? JP_PATROL_IN_COLLISION : JP_PATROL_NO_WAY;
    return false;
}

static bool must_turn_first(const struct jp_patrol *patrol, const struct jp_patrol_window *window,
                            const struct jp_plane_speed *speed)
{
    return patrol->config.turns_in_place && is_standing(speed) &&
           jp_plane_magnitude(jp_plane_wrap(window->direction - patrol->pose.heading)) > patrol->config.turn_first;
}

static void arrive(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    patrol->is_arriving = true;
    stand(patrol);
    if (!is_standing(speed)) {
        return;
    }
    if (goal_heading_error(patrol) <= patrol->config.heading_tolerance) {
        patrol->state = JP_PATROL_ARRIVED;
        patrol->path = NULL;
    } else {
        turn_to(patrol, patrol->goal.pose.heading);
    }
}

static void drive(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    struct jp_patrol_window window;
    enum jp_patrol_reason reason = JP_PATROL_NONE;

    if (is_at_goal(patrol, speed)) {
        correct_pose(patrol);
        arrive(patrol, speed);
        return;
    }
    if (jp_patrol_progress(patrol)) {
        patrol->unmoved = 0;
        patrol->tries = 0;
    }
    jp_patrol_look_ahead(patrol, patrol->config.horizon, &window);
    if (window.distance > patrol->config.horizon) {
        wait(patrol, JP_PATROL_OFF_PATH);
    } else if (must_turn_first(patrol, &window, speed)) {
        correct_pose(patrol);
        if (find_step_to_goal(patrol)) {
            begin_step(patrol);
        } else {
            turn_to(patrol, window.direction);
        }
    } else if (!plan_band(patrol, &window, speed, &reason)) {
        wait(patrol, reason);
    } else if (!may_go_on(patrol)) {
        stand(patrol);
    } else {
        patrol->state = JP_PATROL_DRIVING;
        patrol->reason = JP_PATROL_NONE;
    }
}

/* ---- A cycle ---- */

/* What forbids any motion now. */
static enum jp_patrol_reason obstruction(const struct jp_patrol *patrol)
{
    if (uses_laser(patrol) &&
        (patrol->jumps > patrol->config.dropouts_max || patrol->blind > patrol->config.blind_max)) {
        return JP_PATROL_LOST;
    }
    if (patrol->scan_gap > patrol->config.dropouts_max) {
        return JP_PATROL_NO_SCAN;
    }
    /* A step leads out of what may be a collision. */
    const float least = patrol->state == JP_PATROL_STEPPING ? -DOUBT : 0.0f;

    return jp_patrol_clearance(patrol, &patrol->pose) < least ? JP_PATROL_IN_COLLISION : JP_PATROL_NONE;
}

static bool is_under_way(const struct jp_patrol *patrol)
{
    return patrol->state == JP_PATROL_TURNING || patrol->state == JP_PATROL_DRIVING ||
           patrol->state == JP_PATROL_STEPPING || patrol->state == JP_PATROL_WAITING;
}

static void count_patience(struct jp_patrol *patrol)
{
    patrol->unmoved++;
    if (patrol->state == JP_PATROL_WAITING && ++patrol->waited > patrol->config.waits_max) {
        stop(patrol, patrol->reason);
    } else if (patrol->unmoved > STALL_WAITS * patrol->config.waits_max) {
        stop(patrol, JP_PATROL_STALLED);
    }
}

/* Stands where scans see it in a collision that may be none, and can step aside. */
static bool can_get_clear(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    return patrol->config.turns_in_place && is_standing(speed) && jp_patrol_clearance(patrol, &patrol->pose) > -DOUBT &&
           jp_patrol_find_step(patrol, patrol->pose.heading, &patrol->step_target);
}

static void go_on(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    const enum jp_patrol_reason reason = obstruction(patrol);

    if (reason == JP_PATROL_IN_COLLISION && can_get_clear(patrol, speed)) {
        correct_pose(patrol);
        begin_step(patrol);
    } else if (reason != JP_PATROL_NONE) {
        correct_pose(patrol);
        wait(patrol, reason);
    } else if (patrol->state == JP_PATROL_TURNING) {
        correct_pose(patrol);
        turn(patrol, speed);
    } else if (patrol->state == JP_PATROL_STEPPING) {
        correct_pose(patrol);
        go_step(patrol, speed);
    } else {
        drive(patrol, speed);
    }
    if (is_under_way(patrol)) {
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

    *twist =
        (struct jp_twist){to_q24(patrol->command.forward), to_q24(patrol->sideways), to_q24(patrol->command.turn_rate)};
    if (jp_four_wheel_inverse(&patrol->config.wheels, twist, &wheels) != JP_OK) {
        stop(patrol, JP_PATROL_INFEASIBLE);
        *twist = (struct jp_twist){0, 0, 0};
    }
}

static bool is_input_sound(const struct jp_patrol_input *input)
{
    return jp_plane_is_pose(&input->wheels) && (!input->has_laser || jp_plane_is_pose(&input->laser)) &&
           jp_plane_is_pose(&input->sensor) && jp_plane_is_between(input->speed.forward, -VALUE_MAX, VALUE_MAX) &&
           jp_plane_is_between(input->speed.turn_rate, -VALUE_MAX, VALUE_MAX);
}

enum jp_status jp_patrol_cycle(struct jp_patrol *patrol, const struct jp_patrol_input *input, struct jp_twist *twist)
{
    if (patrol == NULL || input == NULL || twist == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *twist = (struct jp_twist){0, 0, 0};
    if (!is_input_sound(input)) {
        stop(patrol, JP_PATROL_LOST);
        return JP_ERR_ARGUMENT;
    }
    patrol->counts.cycles++;
    predict_pose(patrol, input);
    look(patrol, input);
    if (is_under_way(patrol)) {
        go_on(patrol, &input->speed);
        give_command(patrol, twist);
    } else {
        correct_pose(patrol);
    }
    return JP_OK;
}
