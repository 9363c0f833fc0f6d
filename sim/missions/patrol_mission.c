#include "sim/missions/patrol_mission.h"

#include <joulepath/pure_pursuit.h>
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/four_wheel/four_wheel_plant.h"
#include "sim/four_wheel/laser.h"

#define TICK   (1.0 / FOUR_WHEEL_RATE_HZ)
#define TICKS  (FOUR_WHEEL_RATE_HZ / PATROL_CYCLE_HZ)
#define PERIOD (1.0 / PATROL_CYCLE_HZ)

/* Slower than this is no motion in a direction, m/s. */
#define MOTION_SPEED 0.03

/* Arrived when the true pose is this near, m and rad. */
#define TRUE_TOLERANCE      0.15
#define TRUE_TURN_TOLERANCE (10 * M_PI / 180)

/* So long after it has given up the drive is looked at, cycles. */
#define AFTERMATH (2 * PATROL_CYCLE_HZ)

/* What the faults' slip is, everywhere. */
#define SLIP_FRICTION        0.3
#define SLIP_STIFFNESS_LEFT  0.1
#define SLIP_STIFFNESS_RIGHT 0.05
static const struct planar_point slip_pull = {-0.1, 0.15}; /* m/s² */

/* A path shorter than this has no direction to pursue, m. */
#define PURSUED_MIN 0.001

/* Expansions of the planner at a time, and what it has room for. */
#define SLICE        100000
#define SEARCH_SLICE 20000 /* of the localiser, in a cycle: some 10 M instructions */
#define POINTS_MAX   4096
#define TURNS_MAX    1024

const char *const patrol_method_names[PATROL_METHODS] = {"improved", "plain", "pursuit"};
const char *const patrol_outcome_names[PATROL_OUTCOMES] = {"arrived", "missed the goal", "collided", "gave up",
                                                           "late",    "no path"};
const char *const patrol_reason_names[JP_PATROL_INFEASIBLE + 1] = {
    "", "in collision", "no way", "no scan", "lost", "off the path", "stalled", "wheels infeasible"};
const char *const patrol_state_names[JP_PATROL_STOPPED + 1] = {"held",    "turning", "driving", "stepping",
                                                               "gliding", "waiting", "arrived", "stopped"};

struct patrol_mission {
    const struct patrol_task *task;
    struct patrol_world world;
    struct four_wheel_plant plant;
    struct laser_config laser;
    struct laser_scan scan;
    struct jp_localiser localiser;
    void *localiser_block;
    struct random random;
    struct jp_patrol_mission navigator;
    void *block; /* the navigator's */
    struct jp_four_wheel_config wheels_config;
    struct jp_wheels wheels; /* asked of the plant */
    struct jp_twist twist;
    struct planar_pose odometry; /* of the wheels */
    struct jp_plane_speed speed; /* as the wheels say */
    struct jp_pure_pursuit pursuit;
    bool is_pursuing;
    unsigned stopped; /* cycles since it gave up */
    int direction;
    double time;
    struct patrol_energy energy;
    size_t legs; /* that have come to their end */
    struct patrol_result *result;
    bool is_under_way;
};

static struct planar_pose to_planar(const struct jp_plane_pose *pose)
{
    return (struct planar_pose){(double)pose->x, (double)pose->y, (double)pose->heading};
}

static struct jp_plane_pose to_plane(const struct planar_pose *pose)
{
    return (struct jp_plane_pose){(float)pose->x, (float)pose->y, (float)pose->heading};
}

static struct planar_pose believed_pose(const struct patrol_mission *m)
{
    return to_planar(&m->navigator.patrol.pose);
}

/* ---- Paths ---- */

static double path_length(const struct jp_patrol_mission *navigator)
{
    double length = 0;

    for (size_t i = 1; i < navigator->path_count; i++) {
        length += hypot((double)navigator->path[i].x - navigator->path[i - 1].x,
                        (double)navigator->path[i].y - navigator->path[i - 1].y) /
                  JP_Q16_ONE;
    }
    return length;
}

/* The world stands still meanwhile. */
static enum jp_patrol_mission_state plan(struct patrol_mission *m)
{
    while (jp_patrol_mission_work(&m->navigator, SLICE) == JP_MISSION_PLANNING) {
    }
    return m->navigator.state;
}

/* ---- Sensors ---- */

static struct planar_pose scanner_on_robot(const struct patrol_mission *m)
{
    return (struct planar_pose){m->task->robot->laser.x_m, m->task->robot->laser.y_m, 0};
}

static bool has_laser_jumped(const struct patrol_mission *m)
{
    const struct patrol_faults *const faults = &m->task->faults;

    return faults->jump_at >= 0 && m->time >= faults->jump_at &&
           (faults->jump_until == 0 || m->time < faults->jump_until);
}

/* In the one cycle after it. */
static bool do_wheels_jump(const struct patrol_mission *m)
{
    const double since = m->time - m->task->faults.jump_at;

    return m->task->faults.jump_at >= 0 && since >= 0 && since < PERIOD;
}

/* In one cycle, with all wheels off the ground. */
static void carry(struct patrol_mission *m)
{
    const double since = m->time - m->task->faults.carried_at;

    if (m->task->faults.carried_at > 0 && since >= 0 && since < PERIOD) {
        m->plant.state.pose = to_planar(&m->task->faults.carried_to);
    }
}

static bool is_scan_missing(const struct patrol_mission *m)
{
    return m->time >= m->task->faults.scan_dropout_from && m->time < m->task->faults.scan_dropout_until;
}

static struct jp_scan scan_of(const struct laser_scan *scan)
{
    return (struct jp_scan){scan->ranges, (uint16_t)scan->beams, (float)scan->first, (float)scan->step};
}

static void take_scan(struct patrol_mission *m)
{
    const struct planar_pose mount = scanner_on_robot(m);
    const struct planar_pose scanner = planar_compose(&m->plant.state.pose, &mount);

    laser_take(&m->laser, &m->world.map, m->world.shapes, m->world.shape_count, &scanner, &m->random, &m->scan);
}

static void fill_input(struct patrol_mission *m, struct jp_patrol_input *input)
{
    const struct planar_pose mount = scanner_on_robot(m);

    if (do_wheels_jump(m)) {
        m->odometry.x += m->task->faults.wheels_jump_m;
    }
    *input = (struct jp_patrol_input){.wheels = to_plane(&m->odometry), .speed = m->speed, .sensor = to_plane(&mount)};
    if (!is_scan_missing(m)) {
        take_scan(m);
        input->scan = scan_of(&m->scan);
    }
    (void)jp_patrol_locate(&m->localiser, input);
    (void)jp_localiser_work(&m->localiser, SEARCH_SLICE);
    if (has_laser_jumped(m)) {
        input->laser.x += (float)m->task->faults.jump_m;
    }
}

/* ---- Control ---- */

static void integrate_odometry(struct patrol_mission *m)
{
    struct jp_twist twist;
    jp_q24 slip;

    jp_four_wheel_forward(&m->wheels_config, &m->plant.measured, &twist, &slip);

    const double seconds = TICK / JP_Q24_ONE;
    const struct planar_pose motion = {twist.x * seconds, twist.y * seconds, twist.turn_rate * seconds};

    m->odometry = planar_bend(&m->odometry, &motion);
    m->speed = (struct jp_plane_speed){(float)twist.x / (float)JP_Q24_ONE, (float)twist.turn_rate / (float)JP_Q24_ONE};
}

static void drive_ticks(struct patrol_mission *m)
{
    for (int i = 0; i < TICKS; i++) {
        enum jp_steering steering;
        const double x = m->plant.state.pose.x;
        const double y = m->plant.state.pose.y;

        (void)jp_four_wheel_tick(&m->wheels_config, &m->twist, &m->wheels, &steering);
        four_wheel_plant_tick(&m->plant, &m->wheels);
        patrol_world_step(&m->world, &m->plant.state.pose, TICK);
        integrate_odometry(m);
        patrol_energy_tick(&m->energy, &m->plant);
        m->result->length += hypot(m->plant.state.pose.x - x, m->plant.state.pose.y - y);
        m->result->reversed += m->plant.state.forward < -MOTION_SPEED ? -m->plant.state.forward * TICK : 0;
    }
    m->time += PERIOD;
    m->stopped = m->navigator.patrol.state == JP_PATROL_STOPPED ? m->stopped + 1 : 0;
}

static void count_directions(struct patrol_mission *m)
{
    const double speed = m->plant.state.forward;
    const int direction = speed > MOTION_SPEED ? 1 : speed < -MOTION_SPEED ? -1 : 0;

    if (direction != 0) {
        m->result->direction_changes += m->direction != 0 && direction != m->direction;
        m->direction = direction;
    }
}

/* The last of the path by pure pursuit; TEB's states tell how it is. */
static void pursue(struct patrol_mission *m)
{
    const struct planar_pose pose = believed_pose(m);

    m->is_pursuing = patrol_pursue(&m->pursuit, m->task->robot, &pose, &m->speed, &m->twist) == JP_OK;
}

static void control(struct patrol_mission *m)
{
    struct jp_patrol_input input;

    carry(m);
    fill_input(m, &input);
    if (m->task->method != PATROL_PURSUIT) {
        (void)jp_patrol_mission_cycle(&m->navigator, &input, &m->twist);
        (void)plan(m);
        return;
    }
    (void)jp_patrol_cycle(&m->navigator.patrol, &input, &m->twist);
    if (m->navigator.patrol.state != JP_PATROL_TURNING) {
        pursue(m);
    }
}

/* ---- Legs ---- */

static const struct jp_plane_pose *goal_of(const struct patrol_mission *m)
{
    return m->legs == 0 || m->task->round_count == 0 ? &m->task->scene->goal
                                                     : &m->task->round[(m->legs - 1) % m->task->round_count];
}

/* The way to the scene's goal, and those of the round. */
static size_t leg_index(const struct patrol_mission *m)
{
    return m->legs == 0 || m->task->round_count == 0 ? 0 : 1 + (m->legs - 1) % m->task->round_count;
}

static void begin_leg(struct patrol_mission *m)
{
    const struct jp_patrol_plan leg = {.start = m->navigator.patrol.pose,
                                       .path = m->navigator.path,
                                       .path_count = m->navigator.path_count,
                                       .goal = {*goal_of(m), false},
                                       .tick_rate = FOUR_WHEEL_RATE_HZ,
                                       .ground = &m->task->scene->map};

    patrol_energy_begin(&m->energy, leg_index(m), &m->navigator.config.patrol, &leg, m->time);
}

/* Where a mark tells the robot its place. */
static bool set_pose(struct patrol_mission *m)
{
    const struct jp_plane_pose pose = to_plane(&m->plant.state.pose);

    return jp_patrol_set_pose(&m->navigator.patrol, &pose) == JP_OK &&
           jp_localiser_start(&m->localiser, &pose) == JP_OK;
}

static bool is_leg_over(const struct patrol_mission *m)
{
    return m->task->method != PATROL_PURSUIT && m->navigator.state == JP_MISSION_ARRIVED;
}

static void end_leg(struct patrol_mission *m)
{
    patrol_energy_end(&m->energy, m->time);
    if (m->task->legs_learned == 0 || m->legs < m->task->legs_learned) {
        patrol_energy_learn(&m->energy, leg_index(m));
    }
    m->result->leg = m->energy.leg;
    m->legs++;
    if (m->task->keep_leg != NULL) {
        m->task->keep_leg(m->task->context, &m->energy.leg);
    }
}

/* False: there is none, or no way. */
static bool next_leg(struct patrol_mission *m)
{
    if (m->legs >= m->task->legs_max || !set_pose(m) || jp_patrol_mission_start(&m->navigator, goal_of(m)) != JP_OK ||
        plan(m) != JP_MISSION_UNDER_WAY) {
        return false;
    }
    begin_leg(m);
    return true;
}

/* ---- The end ---- */

static bool is_over(const struct patrol_mission *m)
{
    const bool is_ended_by_touch = m->world.first_touch != PATROL_TOUCH_NONE && !m->task->survives_touches;

    if (is_ended_by_touch || m->time >= m->task->scene->limit_s) {
        return true;
    }
    if (m->task->method == PATROL_PURSUIT) {
        return !m->is_pursuing;
    }
    const bool has_stopped = m->navigator.patrol.state == JP_PATROL_STOPPED;

    return m->navigator.state == JP_MISSION_ARRIVED ||
           (m->navigator.state == JP_MISSION_GIVEN_UP && (!has_stopped || m->stopped > AFTERMATH));
}

static enum patrol_outcome outcome_of(const struct patrol_mission *m)
{
    const bool is_near = m->result->position_error <= TRUE_TOLERANCE &&
                         (m->result->heading_error <= TRUE_TURN_TOLERANCE || m->task->method == PATROL_PURSUIT);

    if (m->world.first_touch != PATROL_TOUCH_NONE) {
        return PATROL_COLLIDED;
    }
    if (m->task->method != PATROL_PURSUIT && m->navigator.patrol.state == JP_PATROL_STOPPED) {
        return PATROL_GAVE_UP;
    }
    if (m->time >= m->task->scene->limit_s) {
        return PATROL_LATE;
    }
    if (m->task->method != PATROL_PURSUIT && m->navigator.state == JP_MISSION_GIVEN_UP) {
        return PATROL_NO_PATH;
    }
    return is_near ? PATROL_ARRIVED : PATROL_MISSED;
}

/* What the battery has given. */
static double energy_of(const struct patrol_mission *m)
{
    return m->plant.ledger.battery;
}

static void judge(struct patrol_mission *m)
{
    const struct planar_pose goal =
        to_planar(m->legs > 1 ? &m->task->round[(m->legs - 2) % m->task->round_count] : &m->task->scene->goal);
    const struct planar_pose believed = believed_pose(m);
    const struct planar_pose *const pose = &m->plant.state.pose;
    struct patrol_result *const result = m->result;

    result->time = m->time;
    result->energy_j = energy_of(m);
    result->clearance_min = m->world.distance_min;
    result->person_clearance_min = m->world.person_distance_min;
    result->contacts = m->world.contacts;
    result->position_error = hypot(pose->x - goal.x, pose->y - goal.y);
    result->heading_error = fabs(planar_wrap(pose->heading - goal.heading));
    result->odometry_error = hypot(pose->x - believed.x, pose->y - believed.y);
    result->replans = m->navigator.replans;
    result->counts = m->navigator.patrol.counts;
    result->outcome = outcome_of(m);
    result->reason = m->navigator.patrol.reason;
}

static void show(const struct patrol_mission *m)
{
    if (m->task->observe != NULL) {
        size_t grid_path_count;
        const struct jp_point *const grid_path = jp_patrol_mission_grid_path(&m->navigator, &grid_path_count);
        const struct patrol_view view = {
            .time = m->time,
            .true_pose = to_plane(&m->plant.state.pose),
            .true_speed = {(float)m->plant.state.forward, (float)m->plant.state.turn_rate},
            .believed = m->navigator.patrol.pose,
            .state = m->navigator.patrol.state,
            .reason = m->navigator.patrol.reason,
            .patrol = m->task->method == PATROL_PURSUIT ? NULL : &m->navigator.patrol,
            .wheels = &m->plant.measured,
            .grid_path = grid_path,
            .grid_path_count = grid_path_count,
            .replans = m->navigator.replans,
            .world = &m->world,
            .path = m->navigator.path,
            .path_count = m->navigator.path_count,
            .clearance = patrol_world_distance(&m->world, PATROL_DISTANCE_MAX),
            .energy_j = energy_of(m),
            .leg = &m->energy.leg,
            .scan = &m->scan,
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

/* False without memory. */
static bool set_up_world(struct patrol_mission *m)
{
    const struct four_wheel_file *const robot = m->task->robot;
    const struct planar_pose start = to_planar(&m->task->scene->start);

    if (!patrol_scene_enter(m->task->scene, robot, &m->world)) {
        return false;
    }
    four_wheel_plant_init(&m->plant, robot, &start);
    patrol_energy_init(&m->energy, robot);
    if (m->task->faults.slip) {
        make_slippery(&m->plant);
    }
    m->laser = laser_config_of(robot->laser.beams, robot->laser.field_deg * M_PI / 180, robot->laser.range_m,
                               robot->laser.noise_m);
    m->laser.dropout = m->task->faults.beam_dropout;
    random_init(&m->random, m->task->seed);

    m->odometry = start;
    return true;
}

/* False without memory. */
static bool set_up_localiser(struct patrol_mission *m)
{
    const struct jp_localiser_config config = patrol_localiser_config(m->task->robot, &m->task->scene->map);
    const size_t size = jp_localiser_size(&config);
    const char *field;

    m->localiser_block = malloc(size);
    return m->localiser_block != NULL &&
           jp_localiser_init(&m->localiser, &config, m->localiser_block, size, &field) == JP_OK &&
           jp_localiser_start(&m->localiser, &m->task->scene->start) == JP_OK;
}

/* By pure pursuit a robot that is at its goal has nothing to pursue. */
static bool set_up_pursuit(struct patrol_mission *m)
{
    const struct jp_pure_pursuit_config pursuit = patrol_pursuit_config(m->task->robot);
    const char *field;

    m->is_pursuing = path_length(&m->navigator) > PURSUED_MIN;
    return !m->is_pursuing ||
           (jp_pure_pursuit_init(&m->pursuit, &pursuit, &field) == JP_OK &&
            jp_pure_pursuit_follow(&m->pursuit, m->navigator.path, m->navigator.path_count) == JP_OK);
}

/* What it learns changes its prices. */
static const struct jp_four_wheel_energy_model *prices_of(const struct patrol_mission *m)
{
    const bool is_by_length =
        m->task->plans_by_length || m->task->method != PATROL_IMPROVED || m->energy.built_in == NULL;

    return is_by_length ? NULL : &m->energy.learner.model;
}

static struct jp_patrol_mission_config navigator_config(const struct patrol_mission *m)
{
    const struct patrol_task *const task = m->task;
    struct jp_patrol_mission_config config = {.patrol = patrol_config(task->robot, task->method),
                                              .map = &task->scene->map,
                                              .energy = prices_of(m),
                                              .turns_before_goal = task->method == PATROL_IMPROVED,
                                              .points_max = POINTS_MAX,
                                              .turns_max = TURNS_MAX};

    if (task->turns_by_fixed_angle) {
        config.patrol.strategy = (uint8_t)JP_PATROL_FIXED_ANGLE;
    }
    return config;
}

static bool set_up_controller(struct patrol_mission *m, const struct jp_patrol_mission_config *config, size_t size)
{
    const char *field;

    m->wheels_config = four_wheel_config(m->task->robot);
    if (jp_patrol_mission_init(&m->navigator, config, m->block, size, &field) != JP_OK) {
        m->result->outcome = PATROL_GAVE_UP;
        m->result->reason = JP_PATROL_INFEASIBLE;
        return false;
    }
    return jp_patrol_set_pose(&m->navigator.patrol, &m->task->scene->start) == JP_OK &&
           jp_patrol_mission_start(&m->navigator, &m->task->scene->goal) == JP_OK && plan(m) == JP_MISSION_UNDER_WAY &&
           set_up_pursuit(m);
}

static void begin(struct patrol_mission *m)
{
    m->result->path_length = path_length(&m->navigator);
    m->result->path_price = (double)m->navigator.price;
    m->result->planner = m->navigator.counts;
    begin_leg(m);
}

/* False without memory. */
static bool set_up(struct patrol_mission *m)
{
    if (!set_up_localiser(m) || !set_up_world(m)) {
        return false;
    }
    const struct jp_patrol_mission_config config = navigator_config(m);
    const size_t size = jp_patrol_mission_size(&config);

    m->block = malloc(size);
    if (m->block == NULL) {
        return false;
    }
    m->is_under_way = set_up_controller(m, &config, size);
    if (m->is_under_way) {
        begin(m);
    }
    return true;
}

struct patrol_mission *patrol_mission_begin(const struct patrol_task *task, struct patrol_result *result)
{
    struct patrol_mission *const m = calloc(1, sizeof *m);

    *result = (struct patrol_result){.outcome = PATROL_NO_PATH};
    if (m != NULL) {
        m->task = task;
        m->result = result;
    }
    if (m == NULL || !set_up(m)) {
        error_line("%s: no memory for a drive over it; give a smaller map", task->scene->name);
        patrol_mission_free(m);
        return NULL;
    }
    return m;
}

bool patrol_mission_step(struct patrol_mission *m)
{
    if (!m->is_under_way) {
        return false;
    }
    if (is_over(m)) {
        judge(m);
        m->is_under_way = false;
        return false;
    }
    control(m);
    show(m);
    drive_ticks(m);
    count_directions(m);
    if (is_leg_over(m)) {
        end_leg(m);
        (void)next_leg(m);
    }
    return true;
}

struct patrol_world *patrol_mission_world(struct patrol_mission *m)
{
    return &m->world;
}

void patrol_mission_free(struct patrol_mission *m)
{
    if (m != NULL) {
        patrol_world_free(&m->world);
        free(m->localiser_block);
        free(m->block);
    }
    free(m);
}

bool patrol_mission_run(const struct patrol_task *task, struct patrol_result *result)
{
    struct patrol_mission *const m = patrol_mission_begin(task, result);

    if (m != NULL) {
        while (patrol_mission_step(m)) {
        }
    }
    patrol_mission_free(m);
    return m != NULL;
}
