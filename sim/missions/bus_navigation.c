#include "sim/missions/bus_navigation.h"

#include <math.h>
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/base/fingerprint.h"
#include "sim/base/strict_math.h"
#include "sim/bus/course_view.h"
#include "sim/missions/navigation_sight.h"
#include "sim/missions/navigation_skid.h"

/** Looks of the sensor, a second. */
#define SENSOR_RATE 20

#define MAP_ID 1

/* Of the signals. */
#define JOULE     4294967296.0
#define Q3_ONE    8.0
#define Q4_ONE    16.0
#define Q6_ONE    64.0
#define Q16_ONE   65536.0
#define POSE_TURN 4096.0

struct run {
    struct bus_navigation *navigation;
    const struct navigation_task *task;
    double rate_hz; /**< of the ticks */
    struct clearance_robot body;
    struct clearance_pose start;
    struct clearance_pose before;
    struct course_view course;
    uint8_t *uploaded; /**< cells of the map, row by row */
    uint8_t forgets;   /**< of the ECU, when it was looked at last */
    int shown;         /**< number of the course that was, or -1 */
    bool has_begun;    /**< to drive */
    bool has_forecast;
    uint32_t begin_tick;
    int64_t begin_energy;
};

/** A robot that its sides steer is where it is on the map; a balancer where it was switched on, and on from there. */
static struct clearance_pose pose_of(const struct run *run)
{
    const struct plant_node *node = &run->navigation->drive.plant;
    struct plant_truth truth;

    if (node->kind == PLANT_BALANCER) {
        return navigation_pose(&run->start, &node->world.plant);
    }
    plant_node_look(node, &truth);
    return (struct clearance_pose){truth.x, truth.y, truth.heading};
}

/** Where the ECU takes the robot to be on the map. */
static struct jp_place believed_of(const struct run *run)
{
    const struct jp_can_pose_t *told = &run->navigation->drive.view.pose;
    const double c = strict_cos(run->start.heading);
    const double s = strict_sin(run->start.heading);
    const double x = told->x / Q16_ONE;
    const double y = told->y / Q16_ONE;

    return navigation_place(&(struct clearance_pose){run->start.x + x * c - y * s, run->start.y + x * s + y * c,
                                                     run->start.heading + told->heading / POSE_TURN * 2 * M_PI});
}

/* What the ECU tells. */

/** True when all of its legs have come for the first time. */
static bool has_new_course(struct run *run, struct navigation_course *course)
{
    struct jp_point ends[COURSE_VIEW_LEGS];
    const unsigned count = course_view_read(&run->course, &run->navigation->drive.view.navigation, ends);

    if (run->shown == run->course.course || count == 0 || count > NAVIGATION_LEGS) {
        return false;
    }
    course->count = (uint16_t)count;
    for (unsigned i = 0; i < count; i++) {
        course->ends[i] = ends[i];
    }
    run->shown = run->course.course;
    return true;
}

static void take_forecast(struct run *run)
{
    const struct jp_can_navigation_progress_t *left = &run->navigation->drive.view.left;

    if (!run->has_forecast && left->energy > 0) {
        run->has_forecast = true;
        run->navigation->result.forecast_joules = left->energy / Q3_ONE;
        run->navigation->result.deviation_joules = left->deviation / Q3_ONE;
    }
}

static void take_events(struct run *run)
{
    struct ecu_view *view = &run->navigation->drive.view;

    if (view->leg_told) {
        course_view_take(&run->course, &view->leg);
    }
    if (view->left_told && run->has_begun) {
        take_forecast(run);
    }
    view->leg_told = false;
    view->left_told = false;
}

/* The drive. */

static double joules_of(const struct run *run)
{
    return (double)(run->navigation->drive.view.spent.energy - run->begin_energy) / JOULE;
}

/** That it comes home; NaN: the ECU does not know. */
static double probability_of(const struct run *run)
{
    const struct jp_can_home_status_t *home = &run->navigation->drive.view.home;

    return home->probability > 0 ? home->probability / Q16_ONE : NAN;
}

static void show(struct run *run)
{
    const struct ecu_view *view = &run->navigation->drive.view;
    struct navigation_course course;
    const bool is_new = has_new_course(run, &course);
    const struct navigation_frame frame = {.seconds = run->navigation->result.seconds,
                                           .pose = pose_of(run),
                                           .joules = joules_of(run),
                                           .state = (enum jp_navigator_state)view->navigation.state,
                                           .reason = (enum jp_navigator_reason)view->navigation.reason,
                                           .replans = view->navigation.replans,
                                           .left_m = view->left.distance / Q6_ONE,
                                           .left_s = view->left.duration / Q4_ONE,
                                           .probability = probability_of(run),
                                           .new_course = is_new ? &course : NULL};

    if (run->task->watch != NULL) {
        run->task->watch(run->task->context, &frame);
    }
}

static size_t cells_of(const struct run *run)
{
    const struct jp_terrain_config *map = &run->task->map->config;

    return (size_t)map->width * map->height;
}

static enum jp_cell cell_now(const struct run *run, size_t i)
{
    const size_t width = run->task->map->config.width;

    return jp_terrain_cell(run->task->map, (int32_t)(i % width), (int32_t)(i / width));
}

static bool note_map(struct run *run)
{
    run->uploaded = malloc(cells_of(run));
    for (size_t i = 0; run->uploaded != NULL && i < cells_of(run); i++) {
        run->uploaded[i] = (uint8_t)cell_now(run, i);
    }
    return run->uploaded != NULL;
}

/** What the robot has forgotten is told again. */
static void follow_forgetting(struct run *run)
{
    const uint8_t forgets = run->navigation->drive.view.navigation.forgets;
    const size_t width = run->task->map->config.width;

    if (forgets == run->forgets) {
        return;
    }
    run->forgets = forgets;
    for (size_t i = 0; i < cells_of(run); i++) {
        (void)jp_terrain_set_cell(run->task->map, (int32_t)(i % width), (int32_t)(i / width),
                                  (enum jp_cell)run->uploaded[i]);
    }
}

/** What is handed to the operator the robot knows, or will. */
static bool tell(void *context, int x, int y, enum jp_cell cell)
{
    struct run *run = context;

    return jp_navigation_operator_see(&run->navigation->commander, (uint16_t)x, (uint16_t)y, cell) == JP_OK &&
           jp_terrain_set_cell(run->task->map, x, y, cell) == JP_OK;
}

static void look(struct run *run)
{
    struct navigation_result *result = &run->navigation->result;
    const struct clearance_pose pose = pose_of(run);

    const struct jp_place believed = believed_of(run);

    follow_forgetting(run);
    navigation_look(run->task, &pose, &believed, result, tell, run);
    navigation_measure(run->task, &run->body, &pose, result);
    result->length_m += strict_hypot(pose.x - run->before.x, pose.y - run->before.y);
    run->before = pose;
    show(run);
}

static void begin(struct run *run)
{
    run->has_begun = true;
    run->begin_tick = run->navigation->drive.tick;
    run->begin_energy = run->navigation->drive.view.spent.energy;
    run->before = pose_of(run);
}

static void note_fingerprint(struct run *run)
{
    const struct ecu_view *view = &run->navigation->drive.view;
    uint64_t *fingerprint = &run->navigation->fingerprint;

    plant_node_fingerprint(&run->navigation->drive.plant, fingerprint);
    fingerprint_add(fingerprint, &view->spent.energy, sizeof view->spent.energy);
}

static bool pass_tick(struct run *run)
{
    struct bus_navigation *navigation = run->navigation;
    struct bus_drive *bus = &navigation->drive;
    const uint32_t ticks = (uint32_t)run->rate_hz;

    if (!bus_drive_lockstep(bus)) {
        error_line("the ECU does not answer: is it on the bus, and built with a navigator?");
        return false;
    }
    note_fingerprint(run);
    take_events(run);
    if (navigation->commander.phase == JP_NAVIGATION_SENDING) {
        navigation->upload_s += 1 / run->rate_hz;
    }
    if (navigation->commander.phase == JP_NAVIGATION_DRIVING && !run->has_begun) {
        begin(run);
    }
    if (run->has_begun && (bus->tick - run->begin_tick) % (ticks / SENSOR_RATE) == 0) {
        navigation->result.seconds = (bus->tick - run->begin_tick) / run->rate_hz;
        look(run);
    }
    return true;
}

static bool is_over(const struct run *run)
{
    const enum jp_navigation_phase phase = run->navigation->commander.phase;

    return phase == JP_NAVIGATION_DONE || phase == JP_NAVIGATION_FAILED;
}

/** False: the drive has ended otherwise than by what the navigator decided. */
static bool conclude(struct run *run)
{
    const struct jp_navigation_operator *commander = &run->navigation->commander;
    struct navigation_result *result = &run->navigation->result;
    const struct clearance_pose pose = pose_of(run);

    if (commander->phase == JP_NAVIGATION_FAILED && commander->failure != JP_NAVIGATION_UNREACHABLE &&
        commander->failure != JP_NAVIGATION_GAVE_UP && commander->failure != JP_NAVIGATION_CAME_HOME) {
        error_line("%s", jp_navigation_failure_text(commander->failure));
        return false;
    }
    result->state = (enum jp_navigator_state)commander->navigator.state;
    result->reason = (enum jp_navigator_reason)commander->navigator.reason;
    result->status = (enum jp_status)commander->navigator.vehicle_status;
    result->replans = commander->navigator.replans;
    result->joules = joules_of(run);
    result->has_turned_back = commander->failure == JP_NAVIGATION_CAME_HOME;
    result->is_late = !is_over(run);
    result->goal_error_m = navigation_goal_error(run->task, &pose);
    show(run);
    return true;
}

static bool drive(struct run *run)
{
    while (!is_over(run) && run->navigation->result.seconds < run->task->patience) {
        if (!pass_tick(run)) {
            return false;
        }
    }
    return conclude(run);
}

/* Preparation. */

/** As the goal of the task, with the first of its headings unless it allows all. */
static struct jp_map_goal goal_of(const struct navigation_task *task)
{
    struct jp_map_goal goal = {
        .x = (uint16_t)task->goal.x, .y = (uint16_t)task->goal.y, .has_heading = task->goal.headings != JP_ANY_HEADING};

    for (unsigned i = JP_HEADINGS; i-- > 0 && goal.has_heading;) {
        goal.heading = (task->goal.headings >> i & 1) != 0 ? task->lattice->heading[i] : goal.heading;
    }
    return goal;
}

/** Bytes of the map, which the caller frees; NULL after one line on stderr. */
static uint8_t *encode(const struct run *run, struct jp_map_stream *stream)
{
    const struct jp_terrain *map = run->task->map;
    const size_t size = jp_map_code_size(&map->config);
    const struct jp_place origin = navigation_place(&run->start);
    uint8_t *bytes = malloc(size);
    const size_t length = bytes != NULL ? jp_map_encode(map, &origin, bytes, size) : 0;

    if (length == 0 || length > UINT16_MAX) {
        error_line("the map takes %zu bytes, at most %d go over the bus; import a smaller window", length, UINT16_MAX);
        free(bytes);
        return NULL;
    }
    *stream = (struct jp_map_stream){.bytes = bytes, .length = (uint16_t)length, .id = MAP_ID};
    return bytes;
}

static void feed(struct plant_node *plant, const struct bus_navigation_cells *cells)
{
    if (plant->kind == PLANT_BALANCER) {
        world_feed(&plant->world, &cells->cell, &cells->wiring, &cells->condition);
    } else {
        skid_plant_feed(&plant->skid.plant, &cells->cell, &cells->wiring, &cells->condition);
    }
}

static void switch_on(struct run *run, const struct bus_navigation_robot *robot, const struct jp_can_link *link)
{
    const struct jp_terrain *world = run->task->world;
    const struct skid_ground level = {NULL, NULL};
    const struct skid_ground ground = world->config.has_elevation ? skid_ground_map(world) : level;
    const struct planar_pose place = {run->start.x, run->start.y, run->start.heading};
    struct bus_drive *bus = &run->navigation->drive;

    if (robot->skid != NULL) {
        bus_drive_init_skid(bus, robot->skid, &ground, &place, run->task->seed, link);
        run->body = navigation_skid_body(robot->skid);
    } else {
        bus_drive_init(bus, robot->balancer, run->task->seed, link);
        run->body = navigation_body(robot->balancer);
    }
    run->rate_hz = plant_node_rate(&bus->plant);
    if (robot->cells != NULL) {
        feed(&bus->plant, robot->cells);
    }
}

bool bus_navigation_run(struct bus_navigation *navigation, const struct navigation_task *task,
                        const struct bus_navigation_robot *robot, const struct jp_can_link *link, unsigned patience)
{
    struct run run = {.navigation = navigation, .task = task, .shown = -1};
    const struct jp_map_goal goal = goal_of(task);
    struct jp_map_stream stream;

    run.start = navigation_start(task);
    run.before = run.start;
    *navigation =
        (struct bus_navigation){.fingerprint = FINGERPRINT_START, .result = {.clearance_m = NAVIGATION_CLEARANCE_MAX}};
    switch_on(&run, robot, link);
    navigation->drive.patience = patience;
    navigation->drive.navigation = &navigation->commander;
    uint8_t *bytes = encode(&run, &stream);

    if (bytes == NULL || !note_map(&run)) {
        free(bytes);
        return false;
    }
    navigation->stream_bytes = stream.length;
    (void)jp_navigation_operator_go(&navigation->commander, &stream, &goal);
    const bool is_done = drive(&run);

    free(bytes);
    free(run.uploaded);
    return is_done;
}
