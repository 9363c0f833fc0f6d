#include "sim/missions/patrol_bus.h"

#include <math.h>
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/base/fingerprint.h"
#include "sim/base/strict_math.h"

#define MAP_ID 1

/* Of the signals. */
#define Q16_ONE   65536.0
#define TURN_32   4294967296.0
#define MAP_METRE 8192.0

/* So long after it has given up the drive is looked at, s. */
#define AFTERMATH 2.0

/* Arrived when the true pose is this near, m and rad. */
#define TRUE_TOLERANCE      0.15
#define TRUE_TURN_TOLERANCE (10 * M_PI / 180)

struct run {
    struct patrol_bus *bus;
    const struct patrol_scene *scene;
    bool has_begun;
    uint32_t begin_tick;
    double begin_battery;
    struct planar_pose before;
    struct jp_plane_pose goal;
};

static struct jp_map_goal goal_of(const struct patrol_scene *scene)
{
    const double cell = scene->map.config.resolution / Q16_ONE;

    return (struct jp_map_goal){.x = (uint16_t)((double)scene->goal.x / cell),
                                .y = (uint16_t)((double)scene->goal.y / cell),
                                .has_heading = true,
                                .heading = (jp_angle)llround((double)scene->goal.heading / (2 * M_PI) * TURN_32)};
}

static struct jp_place place_of(const struct jp_plane_pose *pose)
{
    return (struct jp_place){{(jp_q16)lround((double)pose->x * Q16_ONE), (jp_q16)lround((double)pose->y * Q16_ONE)},
                             (jp_angle)llround((double)pose->heading / (2 * M_PI) * TURN_32)};
}

uint8_t *patrol_bus_encode(const struct patrol_scene *scene, struct jp_map_stream *stream)
{
    const size_t size = jp_map_code_size(&scene->map.config);
    const struct jp_place start = place_of(&scene->start);
    uint8_t *bytes = malloc(size);
    const size_t length = bytes != NULL ? jp_map_encode(&scene->map, &start, bytes, size) : 0;

    if (length == 0 || length > UINT16_MAX) {
        error_line("%s: its map takes %zu bytes, at most %d go over the bus; give a smaller one", scene->name, length,
                   UINT16_MAX);
        free(bytes);
        return NULL;
    }
    *stream = (struct jp_map_stream){.bytes = bytes, .length = (uint16_t)length, .id = MAP_ID};
    return bytes;
}

/* The drive. */

static double seconds(const struct run *run)
{
    return run->has_begun ? (double)(run->bus->drive.tick - run->begin_tick) / FOUR_WHEEL_RATE_HZ : 0;
}

static void begin(struct run *run)
{
    run->has_begun = true;
    run->begin_tick = run->bus->drive.tick;
    run->begin_battery = run->bus->body.plant.ledger.battery;
    run->bus->body.is_world_moving = true;
}

static void take_events(struct run *run)
{
    struct ecu_view *view = &run->bus->drive.view;

    if (view->segment_planned) {
        run->bus->forecast_j = view->segment_forecast.energy / Q16_ONE;
    }
    if (view->segment_ended) {
        run->bus->metered_j = segment_joules(view->segment_result.drawn);
    }
    if (view->left_told && run->bus->deviation_j <= 0) {
        run->bus->deviation_j = view->left.deviation / 8.0;
    }
    view->segment_planned = view->segment_ended = view->left_told = view->segment_begins = view->leg_told = false;
}

static void keep_books(struct run *run)
{
    const struct four_wheel_state *state = &run->bus->body.plant.state;
    const struct ecu_view *view = &run->bus->drive.view;

    plant_node_fingerprint(&run->bus->drive.plant, &run->bus->fingerprint);
    fingerprint_add(&run->bus->fingerprint, &view->spent.energy, sizeof view->spent.energy);
    take_events(run);
    run->bus->result.length += strict_hypot(state->pose.x - run->before.x, state->pose.y - run->before.y);
    run->bus->result.reversed += state->forward < -0.03 ? -state->forward / FOUR_WHEEL_RATE_HZ : 0;
    run->before = state->pose;
}

static bool pass_tick(struct run *run)
{
    struct patrol_bus *bus = run->bus;

    if (!bus_drive_lockstep(&bus->drive)) {
        error_line("the ECU does not answer: is it on the bus, and of a robot with four steered wheels?");
        return false;
    }
    if (bus->commander.phase == JP_NAVIGATION_SENDING) {
        bus->upload_s += 1.0 / FOUR_WHEEL_RATE_HZ;
    }
    if (bus->commander.phase == JP_NAVIGATION_DRIVING && !run->has_begun) {
        begin(run);
    }
    keep_books(run);
    return true;
}

static bool is_over(const struct run *run)
{
    const enum jp_navigation_phase phase = run->bus->commander.phase;

    return phase == JP_NAVIGATION_DONE || phase == JP_NAVIGATION_FAILED ||
           run->bus->body.world.first_touch != PATROL_TOUCH_NONE || seconds(run) >= run->scene->limit_s;
}

/* What it does by itself then, and what it says of the leg. */
static bool look_on(struct run *run)
{
    const uint32_t end = run->bus->drive.tick + (uint32_t)(AFTERMATH * FOUR_WHEEL_RATE_HZ);

    while (run->bus->drive.tick < end) {
        if (!pass_tick(run)) {
            return false;
        }
    }
    return true;
}

/* The end. */

static enum patrol_outcome outcome_of(const struct run *run)
{
    const struct patrol_result *result = &run->bus->result;
    const bool is_near = result->position_error <= TRUE_TOLERANCE && result->heading_error <= TRUE_TURN_TOLERANCE;

    if (run->bus->body.world.first_touch != PATROL_TOUCH_NONE) {
        return PATROL_COLLIDED;
    }
    if (run->bus->commander.phase == JP_NAVIGATION_FAILED) {
        return PATROL_GAVE_UP;
    }
    if (run->bus->commander.phase != JP_NAVIGATION_DONE) {
        return PATROL_LATE;
    }
    return is_near ? PATROL_ARRIVED : PATROL_MISSED;
}

static void judge(struct run *run, double time)
{
    const struct planar_pose *const pose = &run->bus->body.plant.state.pose;
    const struct jp_can_map_pose_t *believed = &run->bus->drive.view.map_pose;
    struct patrol_result *result = &run->bus->result;

    result->time = time;
    result->clearance_min = run->bus->body.world.distance_min;
    result->position_error = strict_hypot(pose->x - (double)run->goal.x, pose->y - (double)run->goal.y);
    result->heading_error = fabs(planar_wrap(pose->heading - (double)run->goal.heading));
    result->odometry_error = strict_hypot(pose->x - believed->x / MAP_METRE, pose->y - believed->y / MAP_METRE);
    result->replans = run->bus->drive.view.navigation.replans;
    result->reason = (enum jp_patrol_reason)run->bus->drive.view.patrol.patrol_reason;
    result->outcome = outcome_of(run);
}

static bool conclude(struct run *run)
{
    const struct jp_navigation_operator *commander = &run->bus->commander;
    const double time = seconds(run);

    run->bus->result.energy_j = run->bus->body.plant.ledger.battery - run->begin_battery;
    if (commander->phase == JP_NAVIGATION_FAILED && commander->failure != JP_NAVIGATION_GAVE_UP) {
        error_line("%s", jp_navigation_failure_text(commander->failure));
        return false;
    }
    if (!look_on(run)) {
        return false;
    }
    judge(run, time);
    return true;
}

static bool drive(struct run *run)
{
    while (!is_over(run)) {
        if (!pass_tick(run)) {
            return false;
        }
    }
    return conclude(run);
}

bool patrol_bus_run(struct patrol_bus *bus, const struct four_wheel_file *robot, const struct patrol_scene *scene,
                    uint64_t seed, const struct jp_can_link *link, unsigned patience)
{
    const struct jp_map_goal goal = goal_of(scene);
    struct run run = {.bus = bus, .scene = scene, .goal = scene->goal};
    struct jp_map_stream stream;
    uint8_t *bytes = NULL;
    bool is_done = false;

    *bus = (struct patrol_bus){.fingerprint = FINGERPRINT_START};
    if (!patrol_body_init(&bus->body, robot, scene, seed)) {
        error_line("%s: no memory for a drive over it; give a smaller map", scene->name);
        return false;
    }
    run.before = bus->body.plant.state.pose;
    bus_drive_init_patrol(&bus->drive, &bus->body, link);
    bus->drive.patience = patience;
    bus->drive.navigation = &bus->commander;
    bytes = patrol_bus_encode(scene, &stream);
    if (bytes != NULL) {
        bus->stream_bytes = stream.length;
        (void)jp_navigation_operator_go(&bus->commander, &stream, &goal);
        is_done = drive(&run);
    }
    free(bytes);
    patrol_body_free(&bus->body);
    return is_done;
}
