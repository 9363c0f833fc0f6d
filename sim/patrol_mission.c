#include "patrol_mission.h"

#include <joulepath/pure_pursuit.h>
#include <stdlib.h>

#include "four_wheel_plant.h"
#include "patrol_path.h"
#include "scan_match.h"

#define TICK   (1.0 / FOUR_WHEEL_RATE_HZ)
#define TICKS  (FOUR_WHEEL_RATE_HZ / PATROL_CYCLE_HZ)
#define PERIOD (1.0 / PATROL_CYCLE_HZ)

/* Slower than this is no motion in a direction, m/s. */
#define MOTION_SPEED 0.03

/* Arrived when the true pose is this near, m and rad. */
#define TRUE_TOLERANCE      0.15
#define TRUE_TURN_TOLERANCE (10 * M_PI / 180)

/* A new path is looked for after so many cycles of waiting, at most so often. */
#define REPLAN_WAIT   8
#define LAST_LEG_WAIT 30
#define REPLANS_MAX   6

/* So long after it has given up the drive is looked at, cycles. */
#define AFTERMATH (2 * PATROL_CYCLE_HZ)

/* The robot comes to the goal straight from here where it cannot turn there, m. */
static const double approaches[] = {0.6, 0.8, 1.0, 1.3, 1.6, 2.0};
#define APPROACHES (sizeof approaches / sizeof approaches[0])

/* Room that a turn in place should have, m: the most that there is. */
static const double turn_margins[] = {0.10, 0.06, 0.03};
#define TURN_MARGINS (sizeof turn_margins / sizeof turn_margins[0])

#define APPROACH_MIN 0.5

/* What the faults' slip is, everywhere. */
#define SLIP_FRICTION        0.3
#define SLIP_STIFFNESS_LEFT  0.1
#define SLIP_STIFFNESS_RIGHT 0.05
static const struct planar_point slip_pull = {-0.1, 0.15}; /* m/s² */

/* So near a path needs no map, m. */
#define STRAIGHT_BELOW 0.15

/* The band can end a path in another heading than the path's last points by so much, rad. */
#define END_TURN   (20 * M_PI / 180)
#define END_POINTS 5

/* The goal is looked at so often, cycles. */
#define WATCH_CYCLES  5
#define STRAIGHT_STEP 0.05 /* m */
#define TURN_STEPS    36

const char *const patrol_method_names[PATROL_METHODS] = {"improved", "plain", "pursuit"};
const char *const patrol_outcome_names[PATROL_OUTCOMES] = {"arrived", "missed the goal", "collided", "gave up",
                                                           "late",    "no path"};
const char *const patrol_reason_names[JP_PATROL_INFEASIBLE + 1] = {
    "", "in collision", "no way", "no scan", "lost", "off the path", "stalled", "wheels infeasible"};
const char *const patrol_state_names[JP_PATROL_STOPPED + 1] = {"held",    "turning", "driving", "stepping",
                                                               "waiting", "arrived", "stopped"};

struct mission {
    const struct patrol_task *task;
    struct patrol_world world;
    struct four_wheel_plant plant;
    struct laser_config laser;
    struct laser_scan scan;
    struct scan_matcher matcher;
    struct random random;
    struct patrol_planner *planner;
    struct patrol_path path;
    struct jp_patrol patrol;
    struct jp_four_wheel_config wheels_config;
    struct jp_wheels wheels; /* asked of the plant */
    struct jp_twist twist;
    struct planar_pose odometry; /* of the wheels */
    struct planar_pose last_odometry;
    struct jp_plane_speed speed; /* as the wheels say */
    struct jp_pure_pursuit pursuit;
    bool is_pursuing;
    bool has_approach; /* the path leads to where the robot turns into the goal */
    struct planar_pose approach;
    bool is_last_leg; /* straight into the goal */
    bool is_pausing;  /* to plan anew */
    unsigned waited;
    unsigned stopped; /* cycles since it gave up */
    int direction;
    double time;
    struct patrol_result *result;
};

static struct planar_pose to_planar(const struct jp_plane_pose *pose)
{
    return (struct planar_pose){(double)pose->x, (double)pose->y, (double)pose->heading};
}

static struct jp_plane_pose to_plane(const struct planar_pose *pose)
{
    return (struct jp_plane_pose){(float)pose->x, (float)pose->y, (float)pose->heading};
}

/* ---- Paths ---- */

static bool can_turn_at(const struct mission *m, struct planar_pose pose, double margin)
{
    for (int i = 0; i < TURN_STEPS; i++) {
        pose.heading = 2 * M_PI * i / TURN_STEPS;
        if (!patrol_planner_fits(m->planner, &pose, margin)) {
            return false;
        }
    }
    return true;
}

static bool is_straight_free(const struct mission *m, const struct planar_pose *goal, double length)
{
    const int steps = (int)(length / STRAIGHT_STEP) + 1;

    for (int i = 0; i < steps; i++) {
        const struct planar_pose behind = {-length * i / steps, 0, 0};
        const struct planar_pose pose = planar_compose(goal, &behind);

        if (!patrol_planner_fits(m->planner, &pose, 0.02)) {
            return false;
        }
    }
    return true;
}

static bool find_approach(struct mission *m, const struct planar_pose *goal, double margin)
{
    for (size_t i = 0; i < APPROACHES; i++) {
        const struct planar_pose behind = {-approaches[i], 0, 0};

        m->approach = planar_compose(goal, &behind);
        if (can_turn_at(m, m->approach, margin) && is_straight_free(m, goal, approaches[i])) {
            return true;
        }
    }
    return false;
}

/* Where the robot cannot turn at the goal it turns before, and drives straight in. */
static bool choose_approach(struct mission *m, const struct planar_pose *goal)
{
    if (m->task->method != PATROL_IMPROVED) {
        return false;
    }
    for (size_t i = 0; i < TURN_MARGINS; i++) {
        if (can_turn_at(m, *goal, turn_margins[i])) {
            return false;
        }
        if (find_approach(m, goal, turn_margins[i])) {
            return true;
        }
    }
    return false;
}

static struct planar_pose believed_pose(const struct mission *m)
{
    return to_planar(&m->patrol.pose);
}

static bool follow_to(struct mission *m, const struct planar_pose *target)
{
    const struct planar_pose from = believed_pose(m);
    const struct jp_patrol_goal goal = {to_plane(target), false};

    if (!patrol_planner_find(m->planner, &(struct planar_point){from.x, from.y},
                             &(struct planar_point){target->x, target->y}, &m->path)) {
        return false;
    }
    return jp_patrol_follow(&m->patrol, m->path.points, (uint16_t)m->path.count, &goal) == JP_OK;
}

/* Straight from the approach into the goal. */
static bool follow_straight(struct mission *m, const struct planar_pose *target)
{
    const struct planar_pose from = believed_pose(m);
    const double length = hypot(target->x - from.x, target->y - from.y);
    const struct jp_patrol_goal goal = {to_plane(target), false};
    const size_t count = (size_t)ceil(length / PATROL_PATH_SPACING) + 1;

    for (size_t i = 0; i < count; i++) {
        const double share = (double)i / (double)(count - 1);

        m->path.points[i] =
            (struct jp_path_point){(jp_q16)lround((from.x + share * (target->x - from.x)) * JP_Q16_ONE),
                                   (jp_q16)lround((from.y + share * (target->y - from.y)) * JP_Q16_ONE)};
    }
    m->path.count = count;
    return jp_patrol_follow(&m->patrol, m->path.points, (uint16_t)count, &goal) == JP_OK;
}

static bool go_to(struct mission *m, const struct planar_pose *target)
{
    const struct planar_pose from = believed_pose(m);

    return hypot(target->x - from.x, target->y - from.y) < STRAIGHT_BELOW ? follow_straight(m, target)
                                                                          : follow_to(m, target);
}

/* Whether the path comes to its end in the heading that is asked for there. */
static bool ends_along(const struct mission *m, const struct planar_pose *goal)
{
    const size_t last = m->path.count - 1;
    const struct jp_path_point *const end = &m->path.points[last];
    const struct jp_path_point *const before = &m->path.points[last > END_POINTS ? last - END_POINTS : 0];
    const double direction = atan2((double)end->y - before->y, (double)end->x - before->x);

    return fabs(planar_wrap(direction - goal->heading)) < END_TURN;
}

static bool plan_route(struct mission *m)
{
    const struct planar_pose goal = to_planar(&m->task->scene->goal);

    m->is_last_leg = false;
    m->is_pausing = false;
    m->has_approach = false;
    if (go_to(m, &goal) && ends_along(m, &goal)) {
        return true;
    }
    m->has_approach = choose_approach(m, &goal);
    return go_to(m, m->has_approach ? &m->approach : &goal);
}

/* ---- Sensors ---- */

static struct planar_pose scanner_on_robot(const struct mission *m)
{
    return (struct planar_pose){m->task->robot->laser.x_m, m->task->robot->laser.y_m, 0};
}

static bool has_laser_jumped(const struct mission *m)
{
    const struct patrol_faults *const faults = &m->task->faults;

    return faults->jump_at >= 0 && m->time >= faults->jump_at &&
           (faults->jump_until == 0 || m->time < faults->jump_until);
}

/* In the one cycle after it. */
static bool do_wheels_jump(const struct mission *m)
{
    const double since = m->time - m->task->faults.jump_at;

    return m->task->faults.jump_at >= 0 && since >= 0 && since < PERIOD;
}

static bool is_scan_missing(const struct mission *m)
{
    return m->time >= m->task->faults.scan_dropout_from && m->time < m->task->faults.scan_dropout_until;
}

/* Takes a scan and matches it; false without a pose to trust. */
static bool sense(struct mission *m, struct jp_plane_pose *laser_pose)
{
    const struct planar_pose mount = scanner_on_robot(m);
    const struct planar_pose scanner = planar_compose(&m->plant.state.pose, &mount);
    const struct planar_pose motion = planar_between(&m->last_odometry, &m->odometry);
    const struct planar_pose back = planar_between(&mount, &(struct planar_pose){0, 0, 0});
    struct scan_match_result match;

    laser_take(&m->laser, &m->world.map, m->world.shapes, m->world.shape_count, &scanner, &m->random, &m->scan);
    scan_match_next(&m->matcher, &m->scan, &motion, &match);
    m->last_odometry = m->odometry;

    struct planar_pose pose = planar_compose(&match.pose, &back);

    if (has_laser_jumped(m)) {
        pose.x += m->task->faults.jump_m;
    }
    *laser_pose = to_plane(&pose);
    return match.status == SCAN_MATCH_OK;
}

static void fill_input(struct mission *m, struct jp_patrol_input *input)
{
    const struct planar_pose mount = scanner_on_robot(m);

    if (do_wheels_jump(m)) {
        m->odometry.x += m->task->faults.wheels_jump_m;
    }
    *input = (struct jp_patrol_input){.wheels = to_plane(&m->odometry), .speed = m->speed, .sensor = to_plane(&mount)};
    if (!is_scan_missing(m)) {
        input->has_laser = sense(m, &input->laser);
        input->scan =
            (struct jp_scan){m->scan.ranges, (uint16_t)m->scan.beams, (float)m->scan.first, (float)m->scan.step};
    }
}

/* ---- Control ---- */

static void integrate_odometry(struct mission *m)
{
    struct jp_twist twist;
    jp_q24 slip;

    jp_four_wheel_forward(&m->wheels_config, &m->plant.measured, &twist, &slip);

    const double seconds = TICK / JP_Q24_ONE;
    const struct planar_pose motion = {twist.x * seconds, twist.y * seconds, twist.turn_rate * seconds};

    m->odometry = planar_bend(&m->odometry, &motion);
    m->speed = (struct jp_plane_speed){(float)twist.x / (float)JP_Q24_ONE, (float)twist.turn_rate / (float)JP_Q24_ONE};
}

static void drive_ticks(struct mission *m)
{
    for (int i = 0; i < TICKS; i++) {
        enum jp_steering steering;
        const double x = m->plant.state.pose.x;
        const double y = m->plant.state.pose.y;

        (void)jp_four_wheel_tick(&m->wheels_config, &m->twist, &m->wheels, &steering);
        four_wheel_plant_tick(&m->plant, &m->wheels);
        patrol_world_step(&m->world, &m->plant.state.pose, TICK);
        integrate_odometry(m);
        m->result->length += hypot(m->plant.state.pose.x - x, m->plant.state.pose.y - y);
        m->result->reversed += m->plant.state.forward < -MOTION_SPEED ? -m->plant.state.forward * TICK : 0;
    }
    m->time += PERIOD;
    m->stopped = m->patrol.state == JP_PATROL_STOPPED ? m->stopped + 1 : 0;
}

static void count_directions(struct mission *m)
{
    const double speed = m->plant.state.forward;
    const int direction = speed > MOTION_SPEED ? 1 : speed < -MOTION_SPEED ? -1 : 0;

    if (direction != 0) {
        m->result->direction_changes += m->direction != 0 && direction != m->direction;
        m->direction = direction;
    }
}

/* The last of the path by pure pursuit; TEB's states tell how it is. */
static void pursue(struct mission *m)
{
    const struct planar_pose pose = believed_pose(m);

    m->is_pursuing = patrol_pursue(&m->pursuit, m->task->robot, &pose, &m->speed, &m->twist) == JP_OK;
}

static void mark_scan(struct mission *m)
{
    const struct planar_pose pose = believed_pose(m);
    const struct planar_pose mount = scanner_on_robot(m);
    const struct planar_pose scanner = planar_compose(&pose, &mount);

    patrol_planner_mark(m->planner, &m->scan, &scanner);
}

static void replan(struct mission *m)
{
    m->waited = 0;
    m->result->replans++;
    mark_scan(m);
    (void)plan_route(m);
}

/* What the laser has seen since may leave no room to turn at the goal. */
static void watch_goal(struct mission *m)
{
    const struct planar_pose pose = believed_pose(m);
    const struct planar_pose goal = to_planar(&m->task->scene->goal);
    const bool is_far = hypot(goal.x - pose.x, goal.y - pose.y) > APPROACH_MIN;

    mark_scan(m);
    if (m->patrol.state == JP_PATROL_DRIVING && is_far && !m->has_approach && !m->is_last_leg && !m->is_pausing &&
        !ends_along(m, &goal) && choose_approach(m, &goal)) {
        jp_patrol_pause(&m->patrol);
        m->is_pausing = true;
    }
}

static bool needs_path(const struct mission *m)
{
    const enum jp_patrol_reason reason = m->patrol.reason;
    const bool is_stuck = m->patrol.state == JP_PATROL_WAITING || m->patrol.state == JP_PATROL_STOPPED;

    return is_stuck && (reason == JP_PATROL_NO_WAY || reason == JP_PATROL_OFF_PATH || reason == JP_PATROL_STALLED) &&
           m->result->replans < REPLANS_MAX;
}

/* What the state of the drive asks of the planner. */
static void follow_up(struct mission *m)
{
    if (m->is_pausing && (m->patrol.state == JP_PATROL_ARRIVED || m->patrol.state == JP_PATROL_HELD)) {
        (void)plan_route(m);
    } else if (m->patrol.state == JP_PATROL_ARRIVED && m->has_approach) {
        const struct planar_pose goal = to_planar(&m->task->scene->goal);

        m->has_approach = false;
        m->is_last_leg = true;
        (void)follow_straight(m, &goal);
    } else if (needs_path(m)) {
        m->waited++;
        if (m->waited > (m->is_last_leg ? LAST_LEG_WAIT : REPLAN_WAIT)) {
            replan(m);
        }
    } else {
        m->waited = 0;
    }
    if (m->patrol.counts.cycles % WATCH_CYCLES == 0) {
        watch_goal(m);
    }
}

static void control(struct mission *m)
{
    struct jp_patrol_input input;

    fill_input(m, &input);
    (void)jp_patrol_cycle(&m->patrol, &input, &m->twist);
    if (m->task->method == PATROL_PURSUIT) {
        if (m->patrol.state != JP_PATROL_TURNING) {
            pursue(m);
        }
    } else {
        follow_up(m);
    }
}
/* ---- The end ---- */

static bool is_over(const struct mission *m)
{
    const bool is_ended_by_touch = m->world.first_touch != PATROL_TOUCH_NONE && !m->task->survives_touches;

    if (is_ended_by_touch || m->time >= m->task->scene->limit_s) {
        return true;
    }
    if (m->task->method == PATROL_PURSUIT) {
        return !m->is_pursuing;
    }
    return m->patrol.state == JP_PATROL_ARRIVED || (m->stopped > AFTERMATH && !needs_path(m));
}

static enum patrol_outcome outcome_of(const struct mission *m)
{
    const bool is_near = m->result->position_error <= TRUE_TOLERANCE &&
                         (m->result->heading_error <= TRUE_TURN_TOLERANCE || m->task->method == PATROL_PURSUIT);

    if (m->world.first_touch != PATROL_TOUCH_NONE) {
        return PATROL_COLLIDED;
    }
    if (m->task->method != PATROL_PURSUIT && m->patrol.state == JP_PATROL_STOPPED) {
        return PATROL_GAVE_UP;
    }
    if (m->time >= m->task->scene->limit_s) {
        return PATROL_LATE;
    }
    return is_near ? PATROL_ARRIVED : PATROL_MISSED;
}

/* Of motors and electronics. */
static double energy_of(const struct mission *m)
{
    return m->plant.ledger.drive + m->plant.ledger.steering + m->task->robot->electronics.power_w * m->time;
}

static void judge(struct mission *m)
{
    const struct planar_pose goal = to_planar(&m->task->scene->goal);
    const struct planar_pose believed = believed_pose(m);
    const struct planar_pose *const pose = &m->plant.state.pose;
    struct patrol_result *const result = m->result;

    result->time = m->time;
    result->energy_j = energy_of(m);
    result->clearance_min = m->world.distance_min;
    result->position_error = hypot(pose->x - goal.x, pose->y - goal.y);
    result->heading_error = fabs(planar_wrap(pose->heading - goal.heading));
    result->odometry_error = hypot(pose->x - believed.x, pose->y - believed.y);
    result->counts = m->patrol.counts;
    result->outcome = outcome_of(m);
    result->reason = m->patrol.reason;
}

static void show(const struct mission *m)
{
    if (m->task->observe != NULL) {
        const struct patrol_view view = {
            .time = m->time,
            .true_pose = to_plane(&m->plant.state.pose),
            .true_speed = {(float)m->plant.state.forward, (float)m->plant.state.turn_rate},
            .believed = m->patrol.pose,
            .state = m->patrol.state,
            .reason = m->patrol.reason,
            .patrol = m->task->method == PATROL_PURSUIT ? NULL : &m->patrol,
            .wheels = &m->plant.measured,
            .way = m->path.way,
            .way_count = m->path.way_count,
            .replans = m->result->replans,
            .world = &m->world,
            .path = m->path.points,
            .path_count = m->path.count,
            .clearance = patrol_world_distance(&m->world, PATROL_DISTANCE_MAX),
            .energy_j = energy_of(m),
        };

        m->task->observe(m->task->context, &view);
    }
}

/* ---- A mission ---- */

static void make_slippery(struct four_wheel_plant *plant)
{
    const struct four_wheel_patch everywhere = {.low = {-INFINITY, -INFINITY},
                                                .high = {INFINITY, INFINITY},
                                                .friction = SLIP_FRICTION,
                                                .stiffness_left = SLIP_STIFFNESS_LEFT,
                                                .stiffness_right = SLIP_STIFFNESS_RIGHT,
                                                .pull = slip_pull};

    (void)four_wheel_plant_add_patch(plant, &everywhere);
}

static void set_up_world(struct mission *m)
{
    const struct four_wheel_file *const robot = m->task->robot;
    const struct planar_pose start = to_planar(&m->task->scene->start);

    (void)patrol_world_init(&m->world, &m->task->scene->ground, robot->body.length_m, robot->body.width_m, &start);
    for (size_t i = 0; i < m->task->scene->mover_count; i++) {
        (void)patrol_world_add(&m->world, &m->task->scene->movers[i]);
    }
    four_wheel_plant_init(&m->plant, robot, &start);
    if (m->task->faults.slip) {
        make_slippery(&m->plant);
    }
    m->laser = laser_config_of(robot->laser.beams, robot->laser.field_deg * M_PI / 180, robot->laser.range_m,
                               robot->laser.noise_m);
    m->laser.dropout = m->task->faults.beam_dropout;
    random_init(&m->random, m->task->seed);

    const struct planar_pose mount = scanner_on_robot(m);
    const struct planar_pose scanner = planar_compose(&start, &mount);

    scan_match_init(&m->matcher, &scanner);
    m->odometry = start;
    m->last_odometry = start;
}

static bool set_up_controller(struct mission *m)
{
    const struct jp_patrol_config config = patrol_config(m->task->robot, m->task->method);
    const struct jp_pure_pursuit_config pursuit = patrol_pursuit_config(m->task->robot);
    const char *field;

    m->wheels_config = four_wheel_config(m->task->robot);
    m->planner = patrol_planner_new(&m->task->scene->map, m->task->robot);
    if (jp_patrol_init(&m->patrol, &config, &field) != JP_OK) {
        m->result->outcome = PATROL_GAVE_UP;
        m->result->reason = JP_PATROL_INFEASIBLE;
        return false;
    }
    if (jp_patrol_set_pose(&m->patrol, &m->task->scene->start) != JP_OK || !plan_route(m)) {
        return false;
    }
    m->is_pursuing = true;
    return jp_pure_pursuit_init(&m->pursuit, &pursuit, &field) == JP_OK &&
           jp_pure_pursuit_follow(&m->pursuit, m->path.points, m->path.count) == JP_OK;
}

void patrol_mission_run(const struct patrol_task *task, struct patrol_result *result)
{
    struct mission *const m = calloc(1, sizeof *m);

    m->task = task;
    m->result = result;
    *result = (struct patrol_result){.outcome = PATROL_NO_PATH};
    set_up_world(m);
    if (set_up_controller(m)) {
        result->path_length = m->path.length;
        result->planner = m->path.counts;
        while (!is_over(m)) {
            control(m);
            show(m);
            drive_ticks(m);
            count_directions(m);
        }
        judge(m);
    }
    patrol_planner_free(m->planner);
    patrol_world_free(&m->world);
    free(m);
}
