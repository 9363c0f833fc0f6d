#include "sim/missions/navigation.h"

#include <joulepath/return_map.h>
#include <math.h>
#include <stdlib.h>

#include "hal/app/navigation.h"
#include "sim/base/error.h"
#include "sim/base/strict_math.h"
#include "sim/missions/navigation_sight.h"

#define Q16 65536.0

/** Of the planner's block. */
#define ALIGNMENT 8

/** Expansions of a slice: 1.7 ms of a Cortex-M4 at 168 MHz. */
#define SLICE 32

/** Slices of background work, looks of the sensor, frames, a second. */
#define WORK_RATE   500
#define SENSOR_RATE 20
#define FRAME_RATE  20

/** Drives of a trip. */
#define OUT_AND_HOME 2U

/** Poses of the way home of a slice. */
#define HOME_SLICE 500

struct navigation {
    const struct navigation_task *task;
    const struct navigation_robot *robot;
    struct navigation_result *result;
    struct jp_planner planner;
    struct jp_navigator navigator;
    struct jp_course_leg legs[NAVIGATION_LEGS];
    void *way;
    size_t way_size;
    uint8_t *seen;
    size_t seen_size;
    struct jp_home home;
    struct jp_course_leg home_legs[NAVIGATION_LEGS];
    void *home_block;
    bool was_out;         /* on its way to the goal */
    bool has_noted_leave; /* what the trip is expected to take, and what its battery holds */
    struct clearance_pose start;
    struct clearance_pose before;
    double joules_before;
    double given_before;
    bool has_forecast;
    bool has_new_course;
};

static double joules_of(const struct navigation *navigation)
{
    return navigation->robot->joules(navigation->robot->self);
}

/** Of an energy of the vehicle. */
static double vehicle_joules(const struct navigation *navigation, jp_q16 energy)
{
    return ldexp(energy, navigation->robot->unit_exponent - 16);
}

/* ---- The world ---- */

/** Where the robot truly is. */
static struct clearance_pose pose_of(const struct navigation *navigation)
{
    return navigation->robot->pose(navigation->robot->self);
}

/** Tells the navigator what is otherwise than its map says. */
static bool tell(void *context, int x, int y, enum jp_cell cell)
{
    struct navigation *navigation = context;

    (void)jp_navigator_set_cell(&navigation->navigator, x, y, cell);
    return true;
}

static void look(struct navigation *navigation)
{
    const struct clearance_pose pose = pose_of(navigation);
    const struct jp_place believed = jp_navigator_place(&navigation->navigator);

    navigation_look(navigation->task, &pose, &believed, navigation->result, tell, navigation);
}

/* ---- The battery ---- */

static double given_of(const struct navigation *navigation)
{
    const struct navigation_robot *robot = navigation->robot;

    return robot->given != NULL ? robot->given(robot->self) : robot->joules(robot->self);
}

static double spent_of(const struct navigation *navigation)
{
    return given_of(navigation) - navigation->given_before;
}

static jp_q16 vehicle_energy(const struct navigation *navigation, double joules)
{
    return (jp_q16)lround(ldexp(joules, 16 - navigation->robot->unit_exponent));
}

/** Of cells what the robot knows; else what it has given is metered, and what was in it is not known so well. */
static bool tell_left(void *context, struct jp_forecast *left)
{
    const struct navigation *navigation = context;
    const struct navigation_battery *battery = navigation->task->battery;

    if (battery->pack != NULL) {
        *left = navigation_pack_left(battery->pack);
        return true;
    }
    *left = (struct jp_forecast){vehicle_energy(navigation, battery->believed - spent_of(navigation)),
                                 vehicle_energy(navigation, battery->deviation)};
    return true;
}

static jp_q16 tell_given(void *context)
{
    const struct navigation *navigation = context;
    const struct navigation_battery *battery = navigation->task->battery;

    return battery->pack != NULL ? navigation_pack_given(battery->pack)
                                 : vehicle_energy(navigation, spent_of(navigation));
}

static bool is_empty(const struct navigation *navigation)
{
    const struct navigation_battery *battery = navigation->task->battery;

    return battery->pack != NULL ? navigation_pack_is_empty(battery->pack) : spent_of(navigation) > battery->joules;
}

static double probability_of(const struct navigation *navigation, struct jp_home_answer *answer)
{
    return navigation->task->battery != NULL && jp_home_ask(&navigation->home, answer) == JP_OK
               ? ldexp(answer->probability, -31)
               : NAN;
}

/** It has left the goal, or turns back. */
static void note_turn(struct navigation *navigation)
{
    struct jp_home_answer answer;

    navigation->result->joules_at_turn = spent_of(navigation);
    if (jp_home_ask(&navigation->home, &answer) == JP_OK) {
        navigation->result->way_joules = vehicle_joules(navigation, answer.way.energy);
        navigation->result->way_deviation_joules = vehicle_joules(navigation, answer.way.deviation);
    }
}

/** Of a way of this cost, %; −1: there is none. */
static int8_t percent_of(const struct navigation *navigation, const struct jp_forecast *left, jp_cost cost)
{
    struct jp_forecast way;
    jp_q31 probability = 0;

    if (cost == JP_COST_MAX || jp_home_expect(&navigation->home, cost, OUT_AND_HOME, &way) != JP_OK) {
        return -1;
    }
    (void)jp_forecast_suffices(left, &way, &probability);
    return (int8_t)lround(ldexp(probability, -31) * 100);
}

static void tell_reach(struct navigation *navigation, const struct jp_return_map *map)
{
    const struct jp_terrain_config *cells = &navigation->task->map->config;
    struct jp_forecast left = {0, 0};

    (void)tell_left(navigation, &left);
    for (int32_t i = 0; i < cells->width * cells->height; i++) {
        navigation->task->battery->reach[i] =
            percent_of(navigation, &left, jp_return_map_cost(map, i % cells->width, i / cells->width));
    }
}

/** What the way out and home takes by the return map; 0: there is none, or no memory. */
static struct jp_forecast round_trip(struct navigation *navigation)
{
    const struct navigation_task *task = navigation->task;
    const size_t size = jp_return_map_size(&task->map->config);
    void *block = malloc(size);
    struct jp_return_map map;
    struct jp_forecast way = {0, 0};

    if (block != NULL && jp_return_map_init(&map, task->lattice, task->map, block, size) == JP_OK &&
        jp_return_map_start(&map, &task->start, task->start.x, task->start.y, JP_COST_MAX - 2) == JP_OK) {
        while (!jp_return_map_work(&map, 100000)) {
            /* Slice by slice. */
        }
        const jp_cost cost = jp_return_map_cost(&map, task->goal.x, task->goal.y);

        if (cost != JP_COST_MAX) {
            (void)jp_home_expect(&navigation->home, cost, OUT_AND_HOME, &way);
        }
        if (task->battery->reach != NULL) {
            tell_reach(navigation, &map);
        }
    }
    free(block);
    return way;
}

/** The way home from its goal is known, and what is in the battery not yet asked for. */
static bool is_about_to_leave(const struct navigation *navigation)
{
    struct jp_forecast way;

    return navigation->home.state == JP_HOME_PREPARING && jp_home_expect(&navigation->home, 1, 1, &way) == JP_OK;
}

/** It knows what it can before it drives. */
static void note_leave(struct navigation *navigation)
{
    struct navigation_battery *battery = navigation->task->battery;

    if (battery->leave != NULL || battery->reach != NULL) {
        const struct jp_forecast way = round_trip(navigation);

        navigation->result->trip_joules = vehicle_joules(navigation, way.energy);
        navigation->result->trip_deviation_joules = vehicle_joules(navigation, way.deviation);
    }
    if (battery->leave != NULL) {
        battery->leave(battery->context, battery, navigation->result->trip_joules,
                       navigation->result->trip_deviation_joules);
        battery->believed += spent_of(navigation);
        battery->joules += spent_of(navigation);
    }
    navigation->result->joules_at_leave = spent_of(navigation);
    navigation->has_noted_leave = true;
}

/** The navigator's work and what is beyond it: back from the goal. */
static enum jp_navigator_state work(struct navigation *navigation)
{
    struct navigation_result *result = navigation->result;

    if (navigation->task->battery == NULL) {
        return jp_navigator_work(&navigation->navigator);
    }
    if (!navigation->has_noted_leave && is_about_to_leave(navigation)) {
        note_leave(navigation);
    }
    const enum jp_home_state state = jp_home_work(&navigation->home);

    if (navigation->was_out && state != JP_HOME_OUT) {
        note_turn(navigation);
    }
    if (!navigation->has_noted_leave && state == JP_HOME_OUT) {
        note_leave(navigation);
    }
    navigation->was_out = state == JP_HOME_OUT;
    if (state == JP_HOME_AT_GOAL) {
        (void)jp_home_return(&navigation->home);
    }
    result->is_stranded = result->is_stranded || (state != JP_HOME_HOME && is_empty(navigation));
    return navigation->navigator.state;
}

/* ---- The drive ---- */

static void copy_course(const struct navigation *navigation, struct navigation_course *course)
{
    const struct jp_course_leg *legs = jp_navigator_legs(&navigation->navigator, &course->count);

    for (uint16_t i = 0; i < course->count; i++) {
        course->ends[i] = legs[i].end;
    }
}

static void show(struct navigation *navigation)
{
    struct jp_progress progress = {.length = 0};
    struct navigation_course course;
    struct jp_home_answer answer;
    const double probability = probability_of(navigation, &answer);

    copy_course(navigation, &course);
    (void)jp_navigator_progress(&navigation->navigator, &progress);
    if (navigation->was_out) {
        navigation->result->least_probability = fmin(navigation->result->least_probability, probability);
    }
    const struct navigation_frame frame = {.seconds = navigation->result->seconds,
                                           .pose = pose_of(navigation),
                                           .joules = joules_of(navigation) - navigation->joules_before,
                                           .state = navigation->navigator.state,
                                           .reason = navigation->navigator.reason,
                                           .replans = navigation->navigator.replans,
                                           .left_m = progress.length / Q16,
                                           .left_s = progress.duration / Q16,
                                           .probability = probability,
                                           .new_course = navigation->has_new_course ? &course : NULL};

    if (navigation->task->watch != NULL) {
        navigation->task->watch(navigation->task->context, &frame);
    }
    navigation->has_new_course = false;
}

/** By a route to the goal from where it stands. */
static double planned_joules(const struct navigation *navigation)
{
    const struct jp_plan *plan = jp_planner_plan(&navigation->planner);

    return plan->answer == JP_ANSWER_OPTIMAL || plan->answer == JP_ANSWER_WITHIN_BOUND
               ? (double)plan->cost / JP_COST_PER_JOULE
               : 0;
}

static void note_forecast(struct navigation *navigation)
{
    struct jp_progress progress;

    if (!navigation->has_forecast && jp_navigator_progress(&navigation->navigator, &progress) == JP_OK) {
        navigation->has_forecast = true;
        navigation->result->planned_joules = planned_joules(navigation);
        navigation->result->forecast_joules = vehicle_joules(navigation, progress.energy.energy);
        navigation->result->deviation_joules = vehicle_joules(navigation, progress.energy.deviation);
    }
}

static bool has_pack(const struct navigation *navigation)
{
    return navigation->task->battery != NULL && navigation->task->battery->pack != NULL;
}

static void tick(struct navigation *navigation, uint64_t tick)
{
    const uint64_t rate = (uint64_t)navigation->robot->rate_hz;

    navigation->robot->tick(navigation->robot->self);
    if (has_pack(navigation)) {
        navigation_pack_tick(navigation->task->battery->pack);
    }
    if (tick % (rate / SENSOR_RATE) == 0) {
        const struct clearance_pose pose = pose_of(navigation);
        const struct jp_place believed = jp_navigator_place(&navigation->navigator);

        look(navigation);
        navigation->result->drift_m = fmax(navigation->result->drift_m, strict_hypot(pose.x - believed.point.x / Q16,
                                                                                     pose.y - believed.point.y / Q16));
        navigation_measure(navigation->task, &navigation->robot->body, &pose, navigation->result);
        navigation->result->length_m += strict_hypot(pose.x - navigation->before.x, pose.y - navigation->before.y);
        navigation->before = pose;
        show(navigation);
    }
    if (rate <= WORK_RATE || tick % (rate / WORK_RATE) == 0) {
        const enum jp_navigator_state before = navigation->navigator.state;
        const enum jp_navigator_state state = work(navigation);

        navigation->has_new_course =
            navigation->has_new_course || (before == JP_NAVIGATOR_JOINING && state == JP_NAVIGATOR_TURNING);
        note_forecast(navigation);
    }
}

static bool is_over(const struct navigation *navigation)
{
    if (navigation->task->battery != NULL) {
        return navigation->home.state >= JP_HOME_HOME || navigation->result->is_stranded;
    }
    return navigation->navigator.state >= JP_NAVIGATOR_ARRIVED;
}

static void conclude(struct navigation *navigation)
{
    struct navigation_result *result = navigation->result;
    const struct clearance_pose pose = pose_of(navigation);

    result->state = navigation->navigator.state;
    result->reason = navigation->navigator.reason;
    result->status = navigation->navigator.status;
    result->replans = navigation->navigator.replans;
    result->joules = joules_of(navigation) - navigation->joules_before;
    result->given_joules = spent_of(navigation);
    result->home = navigation->home.state;
    result->home_status = navigation->home.status;
    result->has_turned_back = navigation->home.has_turned_back;
    if (navigation->task->battery != NULL && navigation->task->battery->learned != NULL) {
        *navigation->task->battery->learned = navigation->home.learned;
    }
    if (has_pack(navigation)) {
        result->charge = navigation_pack_charge(navigation->task->battery->pack);
        result->least_bus_v = navigation->task->battery->pack->least_v;
    }
    result->is_late = !is_over(navigation);
    result->goal_error_m = navigation_goal_error(navigation->task, &pose);
    if (navigation->robot->deviation != NULL) {
        result->deviation_m = navigation->robot->deviation(navigation->robot->self);
    }
    show(navigation);
}

/** Why it does not go. */
static void explain(const struct navigation *navigation, enum jp_status status)
{
    if (status == JP_ERR_STATE && has_pack(navigation)) {
        error_line("--charge %g: %s has switched its motors off: its bus falls below the %.2f V that it needs; charge "
                   "the cells",
                   100 * navigation->task->battery->pack->charge, navigation->robot->name,
                   navigation->robot->supply.voltage_min_v);
    } else {
        error_line("--goal: the robot cannot stand there; give another place");
    }
}

static bool drive(struct navigation *navigation)
{
    const struct navigation_task *task = navigation->task;
    const double rate = navigation->robot->rate_hz;
    const enum jp_status status = task->battery != NULL ? jp_home_go(&navigation->home, &task->goal)
                                                        : jp_navigator_go(&navigation->navigator, &task->goal);

    if (status != JP_OK) {
        explain(navigation, status);
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

/** The robot looks at its cells. */
static bool prepare_pack(const struct navigation_task *task, const struct navigation_robot *robot)
{
    return task->battery == NULL || task->battery->pack == NULL ||
           navigation_pack_start(task->battery->pack, robot, task->seed);
}

static void note_charge(struct navigation *navigation)
{
    if (has_pack(navigation)) {
        navigation->result->charge_before = navigation_pack_charge(navigation->task->battery->pack);
        navigation->task->battery->joules = navigation->result->charge_before.joules;
    }
}

/** Where it begins. */
static bool prepare_home(struct navigation *navigation)
{
    const struct navigation_task *task = navigation->task;
    const struct jp_home_config config = {.navigator = &navigation->navigator,
                                          .x = task->start.x,
                                          .y = task->start.y,
                                          .confidence = (jp_q31)(task->battery->confidence * 0x1p31),
                                          .left = tell_left,
                                          .given = tell_given,
                                          .context = navigation,
                                          .legs = navigation->home_legs,
                                          .legs_max = NAVIGATION_LEGS,
                                          .slice = HOME_SLICE,
                                          .block = navigation->home_block,
                                          .size = jp_home_size(&task->map->config)};
    const char *field = "";

    if (jp_home_init(&navigation->home, &config, &field) != JP_OK) {
        error_line("--home: %s is refused; begin where the robot can stand", field != NULL ? field : "the place");
        return false;
    }
    if (task->battery->learned != NULL) {
        navigation->home.learned = *task->battery->learned;
    }
    return true;
}

static bool prepare_navigator(struct navigation *navigation, void *block)
{
    const struct navigation_task *task = navigation->task;
    const struct navigation_robot *robot = navigation->robot;
    const struct jp_planner_config planner = {task->lattice, JP_COST_PHYSICAL, JP_NAVIGATION_EPSILON};
    const struct jp_place origin = navigation_place(&navigation->start);
    const double radius = strict_hypot(robot->body.length_m, robot->body.width_m) / 2;
    const struct jp_navigator_config config = {.planner = &navigation->planner,
                                               .vehicle = &robot->vehicle,
                                               .radius = (jp_q16)lround(radius * Q16),
                                               .margin = (jp_q16)lround(robot->margin_m * Q16),
                                               .legs = navigation->legs,
                                               .legs_max = NAVIGATION_LEGS,
                                               .slice = SLICE,
                                               .patience = JP_NAVIGATION_PATIENCE,
                                               .way_block = navigation->way,
                                               .way_size = navigation->way_size,
                                               .seen = navigation->seen,
                                               .seen_size = navigation->seen_size};
    const char *field;

    if (jp_planner_init(&navigation->planner, &planner, task->map, block, task->memory, &field) != JP_OK) {
        error_line("--memory %zu: too little for this map; give at least %zu KiB", task->memory / 1024,
                   (jp_planner_size(&task->map->config) + 1023) / 1024);
        return false;
    }
    if (jp_navigator_init(&navigation->navigator, &config, &origin, &field) != JP_OK) {
        error_line("%s: %s is out of the range of the navigator on this map; take other cells", robot->name, field);
        return false;
    }
    return task->battery == NULL || prepare_home(navigation);
}

static void describe(struct navigation *navigation, const struct navigation_task *task,
                     const struct navigation_robot *robot, struct navigation_result *result)
{
    *result = (struct navigation_result){.clearance_m = NAVIGATION_CLEARANCE_MAX, .least_probability = 1};
    navigation->task = task;
    navigation->result = result;
    navigation->robot = robot;
    navigation->joules_before = joules_of(navigation);
    navigation->given_before = given_of(navigation);
    navigation->start = navigation_start(task);
    navigation->before = navigation->start;
    navigation->way_size = jp_navigator_way_size(&task->map->config);
    navigation->seen_size = jp_navigator_seen_size(&task->map->config);
    note_charge(navigation);
}

static bool run(const struct navigation_task *task, const struct navigation_robot *robot,
                struct navigation_result *result)
{
    struct navigation *navigation = calloc(1, sizeof *navigation);
    void *block = aligned_alloc(ALIGNMENT, (task->memory + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT);
    bool is_done = false;

    if (navigation != NULL) {
        describe(navigation, task, robot, result);
        navigation->way = malloc(navigation->way_size);
        navigation->seen = malloc(navigation->seen_size);
        navigation->home_block = task->battery != NULL ? malloc(jp_home_size(&task->map->config)) : NULL;
    }
    if (navigation == NULL || navigation->way == NULL || navigation->seen == NULL || block == NULL ||
        (task->battery != NULL && navigation->home_block == NULL)) {
        error_line("--memory %zu: this computer has not that much; give less", task->memory / 1024);
    } else {
        is_done = prepare_navigator(navigation, block) && drive(navigation);
    }
    if (navigation != NULL) {
        free(navigation->way);
        free(navigation->seen);
        free(navigation->home_block);
    }
    free(navigation);
    free(block);
    return is_done;
}

bool navigation_run(const struct navigation_task *task, const struct navigation_robot *robot,
                    struct navigation_result *result)
{
    return prepare_pack(task, robot) && run(task, robot, result);
}
