#include "sim/missions/navigation.h"

#include <joulepath/balancer_vehicle.h>
#include <math.h>
#include <stdlib.h>

#include "sim/balancer/energy_unit.h"
#include "sim/base/error.h"

#define Q16     65536.0
#define TURN    4294967296.0
#define PI      3.14159265358979323846
#define JOULE   4294967296.0
#define RADIANS (2 * PI / TURN)

#define LEGS 96

/** Of the planner's block. */
#define ALIGNMENT 8

/** Expansions of a slice: 1.7 ms of a Cortex-M4 at 168 MHz. */
#define SLICE 32

/** Expansions after which the robot drives by the best route that is there. */
#define PATIENCE 20000

/** Slices of background work, looks of the sensor, frames, a second. */
#define WORK_RATE   500
#define SENSOR_RATE 20
#define FRAME_RATE  20

/** The robot stands before it is told where to go, s. */
#define STAND_SECONDS 2.0

/** Clearances are told up to it, m, in such steps. */
#define CLEARANCE_MAX  0.25
#define CLEARANCE_STEP 0.005

struct navigation {
    const struct navigation_task *task;
    struct navigation_result *result;
    struct rig rig;
    struct jp_pilot pilot;
    struct jp_balancer_vehicle balancer;
    struct jp_vehicle vehicle;
    struct jp_planner planner;
    struct jp_navigator navigator;
    struct jp_course_leg legs[LEGS];
    void *reach;
    size_t reach_size;
    struct clearance_robot body;
    struct clearance_pose start;
    struct clearance_pose before;
    double joules_before;
    bool has_forecast;
    bool has_new_course;
};

const char *navigation_state_name(enum jp_navigator_state state)
{
    static const char *const names[] = {"idle",    "planning", "proving", "joining",     "turning",
                                        "driving", "braking",  "arrived", "unreachable", "failed"};
    return names[state];
}

const char *navigation_reason_name(enum jp_navigator_reason reason)
{
    static const char *const names[] = {"-",         "told to stop", "blocked ahead",   "astray",        "hemmed in",
                                        "no memory", "no room",      "course too long", "robot gave up", "motors off"};
    return names[reason];
}

static double cell_of(const struct navigation *navigation)
{
    return navigation->task->map->config.resolution / Q16;
}

static double joules_of(const struct navigation *navigation)
{
    return (double)jp_robot_meter(&navigation->rig.robot)->model / JOULE;
}

/* ---- The world ---- */

/** Where the robot truly is. */
static struct clearance_pose pose_of(const struct navigation *navigation)
{
    const struct plant *plant = &navigation->rig.world.plant;
    const double c = cos(navigation->start.heading);
    const double s = sin(navigation->start.heading);

    return (struct clearance_pose){navigation->start.x + plant->x * c - plant->y * s,
                                   navigation->start.y + plant->x * s + plant->y * c,
                                   navigation->start.heading + plant->state.yaw};
}

static bool is_seen(const struct navigation *navigation, const struct clearance_pose *from, int x, int y)
{
    const double cell = cell_of(navigation);
    const double dx = (x + 0.5) * cell - from->x;
    const double dy = (y + 0.5) * cell - from->y;
    const int steps = (int)ceil(2 * hypot(dx, dy) / cell);

    for (int i = 1; i < steps; i++) {
        const int u = (int)floor((from->x + dx * i / steps) / cell);
        const int v = (int)floor((from->y + dy * i / steps) / cell);

        if ((u != x || v != y) && jp_terrain_cell(navigation->task->world, u, v) == JP_CELL_OCCUPIED) {
            return false;
        }
    }
    return true;
}

static void note_sight(struct navigation *navigation, int x, int y)
{
    const struct navigation_task *task = navigation->task;
    const struct navigation_sight sight = {x, y, navigation->result->seconds};

    navigation->result->seen++;
    if (task->see != NULL) {
        task->see(task->context, &sight);
    }
}

/** Tells the navigator what is otherwise than its map says. */
static void see(struct navigation *navigation)
{
    const struct navigation_task *task = navigation->task;
    const struct clearance_pose from = pose_of(navigation);
    const double cell = cell_of(navigation);
    const int reach = (int)ceil(task->view_m / cell);
    const int x = (int)floor(from.x / cell);
    const int y = (int)floor(from.y / cell);

    for (int v = y - reach; v <= y + reach; v++) {
        for (int u = x - reach; u <= x + reach; u++) {
            const enum jp_cell is = jp_terrain_cell(task->world, u, v);
            const double distance = hypot((u + 0.5) * cell - from.x, (v + 0.5) * cell - from.y);

            if (is != jp_terrain_cell(task->map, u, v) && distance <= task->view_m &&
                is_seen(navigation, &from, u, v)) {
                (void)jp_navigator_set_cell(&navigation->navigator, u, v, is);
                note_sight(navigation, u, v);
            }
        }
    }
}

static void measure_clearance(struct navigation *navigation, const struct clearance_pose *pose)
{
    struct clearance_robot body = navigation->body;
    struct navigation_result *result = navigation->result;

    if (!result->is_touched && !clearance_at(navigation->task->world, &body, pose)) {
        result->is_touched = true;
        result->touched_at = *pose;
        result->clearance_m = 0;
    }
    body.margin_m = result->clearance_m;
    while (result->clearance_m > 0 && !clearance_at(navigation->task->world, &body, pose)) {
        result->clearance_m = fmax(0, result->clearance_m - CLEARANCE_STEP);
        body.margin_m = result->clearance_m;
    }
}

/* ---- The drive ---- */

static void show(struct navigation *navigation)
{
    const struct navigation_frame frame = {.seconds = navigation->result->seconds,
                                           .pose = pose_of(navigation),
                                           .joules = joules_of(navigation) - navigation->joules_before,
                                           .has_new_course = navigation->has_new_course,
                                           .navigator = &navigation->navigator};

    if (navigation->task->watch != NULL) {
        navigation->task->watch(navigation->task->context, &frame);
    }
    navigation->has_new_course = false;
}

static void note_forecast(struct navigation *navigation)
{
    struct jp_progress progress;

    if (!navigation->has_forecast && jp_navigator_progress(&navigation->navigator, &progress) == JP_OK) {
        const struct jp_energy_model *model = navigation->task->entry->energy;

        navigation->has_forecast = true;
        navigation->result->forecast_joules = energy_unit_joules(model, progress.energy.energy);
        navigation->result->deviation_joules = energy_unit_joules(model, progress.energy.deviation);
    }
}

static void tick(struct navigation *navigation, uint64_t tick)
{
    const uint64_t rate = (uint64_t)navigation->task->robot->control.rate_hz;

    rig_tick(&navigation->rig);
    if (tick % (rate / SENSOR_RATE) == 0) {
        const struct clearance_pose pose = pose_of(navigation);

        see(navigation);
        measure_clearance(navigation, &pose);
        navigation->result->length_m += hypot(pose.x - navigation->before.x, pose.y - navigation->before.y);
        navigation->before = pose;
        show(navigation);
    }
    if (rate <= WORK_RATE || tick % (rate / WORK_RATE) == 0) {
        const enum jp_navigator_state before = navigation->navigator.state;
        const enum jp_navigator_state state = jp_navigator_work(&navigation->navigator);

        navigation->has_new_course =
            navigation->has_new_course || (before == JP_NAVIGATOR_JOINING && state == JP_NAVIGATOR_TURNING);
        note_forecast(navigation);
    }
}

static bool is_over(const struct navigation *navigation)
{
    return navigation->navigator.state >= JP_NAVIGATOR_ARRIVED;
}

static void conclude(struct navigation *navigation)
{
    struct navigation_result *result = navigation->result;
    const struct clearance_pose pose = pose_of(navigation);
    const double cell = cell_of(navigation);

    result->state = navigation->navigator.state;
    result->reason = navigation->navigator.reason;
    result->status = navigation->navigator.status;
    result->replans = navigation->navigator.replans;
    result->joules = joules_of(navigation) - navigation->joules_before;
    result->is_late = !is_over(navigation);
    result->goal_error_m =
        hypot(pose.x - (navigation->task->goal.x + 0.5) * cell, pose.y - (navigation->task->goal.y + 0.5) * cell);
    show(navigation);
}

static bool drive(struct navigation *navigation)
{
    const struct navigation_task *task = navigation->task;
    const double rate = task->robot->control.rate_hz;
    const enum jp_status status = jp_navigator_go(&navigation->navigator, &task->goal);

    if (status != JP_OK) {
        error_line("--goal: the robot cannot stand there; give another place");
        return false;
    }
    for (uint64_t i = 0; !is_over(navigation) && navigation->result->seconds < task->patience; i++) {
        tick(navigation, i);
        navigation->result->seconds = (double)i / rate;
    }
    conclude(navigation);
    return true;
}

/* ---- Preparation ---- */

static bool prepare_robot(struct navigation *navigation)
{
    const struct navigation_task *task = navigation->task;
    const struct jp_pilot_config config = {.model = task->entry->energy, .learning = task->entry->learning};
    const char *field;

    if (!rig_init(&navigation->rig, task->entry, task->robot, task->seed)) {
        return false;
    }
    rig_release(&navigation->rig, 0);
    if (jp_pilot_init(&navigation->pilot, &config, &navigation->rig.robot, &field) != JP_OK) {
        error_line("%s: the energy model is refused: %s; run make identify", task->entry->name, field);
        return false;
    }
    (void)jp_balancer_vehicle_init(&navigation->balancer, &navigation->pilot, &navigation->vehicle);
    for (int i = 0; i < (int)(STAND_SECONDS * task->robot->control.rate_hz); i++) {
        rig_tick(&navigation->rig);
    }
    navigation->joules_before = joules_of(navigation);
    return true;
}

static struct jp_place place_of(const struct clearance_pose *pose)
{
    return (struct jp_place){{(jp_q16)lround(pose->x * Q16), (jp_q16)lround(pose->y * Q16)},
                             (jp_angle)(int64_t)llround(pose->heading / RADIANS)};
}

static bool prepare_navigator(struct navigation *navigation, void *block)
{
    const struct navigation_task *task = navigation->task;
    const struct jp_planner_config planner = {task->lattice, JP_COST_PHYSICAL, {JP_EPSILON(1.35), JP_EPSILON_ONE}};
    const struct jp_place origin = place_of(&navigation->start);
    const double radius = hypot(navigation->body.length_m, navigation->body.width_m) / 2;
    const struct jp_navigator_config config = {.planner = &navigation->planner,
                                               .vehicle = &navigation->vehicle,
                                               .radius = (jp_q16)lround(radius * Q16),
                                               .margin = (jp_q16)lround(task->robot->navigation.margin_m / 2 * Q16),
                                               .legs = navigation->legs,
                                               .legs_max = LEGS,
                                               .slice = SLICE,
                                               .patience = PATIENCE,
                                               .reach_block = navigation->reach,
                                               .reach_size = navigation->reach_size};
    const char *field;

    if (jp_planner_init(&navigation->planner, &planner, task->map, block, task->memory, &field) != JP_OK) {
        error_line("--memory %zu: too little for this map; give at least %zu KiB", task->memory / 1024,
                   (jp_planner_size(&task->map->config) + 1023) / 1024);
        return false;
    }
    if (jp_navigator_init(&navigation->navigator, &config, &origin, &field) != JP_OK) {
        error_line("%s: %s is out of the range of the navigator on this map; take other cells", task->entry->name,
                   field);
        return false;
    }
    return true;
}

static void describe(struct navigation *navigation, const struct navigation_task *task,
                     struct navigation_result *result)
{
    const double cell = task->map->config.resolution / Q16;
    const struct robot_file *robot = task->robot;

    *result = (struct navigation_result){.clearance_m = CLEARANCE_MAX};
    navigation->task = task;
    navigation->result = result;
    navigation->body =
        (struct clearance_robot){fmax(2 * robot->wheel.radius_m, robot->body.depth_m), robot->body.width_m, 0};
    navigation->start = (struct clearance_pose){(task->start.x + 0.5) * cell, (task->start.y + 0.5) * cell,
                                                task->lattice->heading[task->start.heading] * RADIANS};
    navigation->before = navigation->start;
    navigation->reach_size = jp_reach_size(&task->map->config);
}

bool navigation_run(const struct navigation_task *task, struct navigation_result *result)
{
    struct navigation *navigation = calloc(1, sizeof *navigation);
    void *block = aligned_alloc(ALIGNMENT, (task->memory + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT);
    bool is_done = false;

    if (navigation != NULL) {
        describe(navigation, task, result);
        navigation->reach = malloc(navigation->reach_size);
    }
    if (navigation == NULL || navigation->reach == NULL || block == NULL) {
        error_line("--memory %zu: this computer has not that much; give less", task->memory / 1024);
    } else {
        is_done = prepare_robot(navigation) && prepare_navigator(navigation, block) && drive(navigation);
    }
    if (navigation != NULL) {
        free(navigation->reach);
    }
    free(navigation);
    free(block);
    return is_done;
}
