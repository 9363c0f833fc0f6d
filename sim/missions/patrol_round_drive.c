#include "sim/missions/patrol_round_drive.h"

#include <stdlib.h>

#include "hal/app/patrol_memory.h"
#include "hal/can/round_code.h"
#include "sim/base/error.h"
#include "sim/base/fingerprint.h"
#include "sim/bus/bus_drive.h"
#include "sim/four_wheel/patrol_robots.h"
#include "sim/missions/patrol_bus.h"

#define TICK (1.0 / FOUR_WHEEL_RATE_HZ)

/* The drives are switched on in this tick, and the round begins in that one. */
#define ENABLE_TICK 5
#define BEGIN_TICK  20

/* Of the signals. */
#define JOULE   16.0
#define JOULE_3 8.0

const char *const patrol_round_outcomes[PATROL_ROUND_OUTCOMES] = {
    [PATROL_ROUND_WENT_ON] = "went on",
    [PATROL_ROUND_GAVE_UP] = "gave up",
    [PATROL_ROUND_COLLIDED] = "collided",
    [PATROL_ROUND_STRANDED] = "stranded",
};

const char *const patrol_round_reasons[JP_ROUND_REASON_MAP_GONE + 1] = {
    [JP_ROUND_REASON_NONE] = "none",
    [JP_ROUND_REASON_UNDER_WAY] = "another round is under way",
    [JP_ROUND_REASON_NO_MAP] = "there is no map",
    [JP_ROUND_REASON_OTHER_MAP] = "it is of another map",
    [JP_ROUND_REASON_CRC] = "it came damaged",
    [JP_ROUND_REASON_FIELD] = "a field is out of range",
    [JP_ROUND_REASON_BLOCKED] = "the robot cannot stand there",
    [JP_ROUND_REASON_NO_BATTERY] = "what the battery holds is not known",
    [JP_ROUND_REASON_NO_WAY] = "there is no way",
    [JP_ROUND_REASON_NO_ENERGY] = "a full battery does not suffice",
    [JP_ROUND_REASON_DRIVES_OFF] = "the drives were switched off",
    [JP_ROUND_REASON_FAULT] = "the robot has a fault",
    [JP_ROUND_REASON_TOLD] = "it was told to stop, or heard no commands",
    [JP_ROUND_REASON_MAP_GONE] = "its map is gone",
};

/* Both ways. */

static bool is_over(const struct patrol_round_task *task, const struct patrol_round_result *result,
                    const struct patrol_body *body)
{
    return result->record.time_s >= task->hours * 3600 || body->battery->held_j <= 0 ||
           body->world.first_touch != PATROL_TOUCH_NONE || result->record.told.state >= JP_ROUND_TOLD_FAILED;
}

static void conclude(struct patrol_round_result *result, const struct patrol_body *body)
{
    patrol_round_record_end(&result->record, body);
    if (body->world.first_touch != PATROL_TOUCH_NONE) {
        result->outcome = PATROL_ROUND_COLLIDED;
    } else if (body->battery->held_j <= 0) {
        result->outcome = PATROL_ROUND_STRANDED;
    } else {
        result->outcome =
            result->record.told.state >= JP_ROUND_TOLD_FAILED ? PATROL_ROUND_GAVE_UP : PATROL_ROUND_WENT_ON;
    }
}

/* A full battery at the charger. False after one line. */
static bool enter(const struct patrol_round_task *task, struct patrol_body *body, struct patrol_battery *battery)
{
    const struct jp_plane_pose *start = &task->scene->start;
    const struct planar_pose charger = {(double)start->x, (double)start->y, (double)start->heading};

    patrol_battery_init(battery, task->file->full_j, task->file->charger_w, &charger);
    if (!patrol_body_init(body, task->robot, task->scene, task->seed)) {
        error_line("%s: no memory for a drive over it; give a smaller map", task->scene->name);
        return false;
    }
    body->battery = battery;
    body->is_world_moving = true;
    return true;
}

/* By the library. */

struct alone {
    const struct patrol_round_task *task;
    struct patrol_round_result *result;
    struct patrol_body body;
    struct patrol_battery battery;
    struct jp_four_wheel_robot robot;
    struct jp_patrol_pilot pilot;
    struct jp_patrol_round round;
    struct jp_patrol_round_config config;
    void *block;
    double account_j; /* what the battery held when the charger told it, and what had left it */
    bool has_begun;
};

static bool prepare(struct alone *alone)
{
    const struct patrol_robot_entry *entry = patrol_robot_find(alone->task->robot->name);
    const char *field = "";

    if (entry == NULL) {
        return false;
    }
    const struct jp_patrol_pilot_config tables = {.patrol = entry->patrol,
                                                  .localiser = entry->localiser,
                                                  .scanner = entry->scanner,
                                                  .energy = entry->energy,
                                                  .learning = entry->learning,
                                                  .points_max = JP_PATROL_POINTS_MAX,
                                                  .turns_max = JP_PATROL_TURNS_MAX};
    const struct patrol_scene *scene = alone->task->scene;

    if (jp_four_wheel_robot_init(&alone->robot, entry->config, &field) != JP_OK ||
        jp_patrol_pilot_init(&alone->pilot, &tables, &alone->robot, &field) != JP_OK) {
        error_line("%s: %s is out of range; make its tables anew: make robot ROBOT=%s", alone->task->robot->name, field,
                   alone->task->robot->name);
        return false;
    }
    const size_t size = jp_patrol_pilot_size(&alone->pilot, &scene->map);

    alone->block = malloc(size);
    if (alone->block == NULL ||
        jp_patrol_pilot_take_map(&alone->pilot, &scene->map, &scene->start, alone->block, size, &field) != JP_OK) {
        error_line("%s: no memory for a drive over it; give a smaller map", scene->name);
        return false;
    }
    alone->config = patrol_round_config_of(alone->task->file, scene);
    alone->config.standing_power = (float)entry->energy->electronics_power / (float)JP_Q16_ONE;
    return true;
}

static void look(struct alone *alone)
{
    const struct patrol_body *body = &alone->body;
    const struct planar_pose mount = {body->robot->laser.x_m, body->robot->laser.y_m, 0};
    const struct planar_pose scanner = planar_compose(&body->plant.state.pose, &mount);

    if (body->tick % (uint64_t)(FOUR_WHEEL_RATE_HZ / body->robot->laser.rate_hz) == 0) {
        laser_take(&body->laser, &body->world.map, body->world.shapes, body->world.shape_count, &scanner,
                   &alone->body.random, &alone->body.scan);
        jp_patrol_pilot_see(&alone->pilot, body->scan.ranges, &jp_four_wheel_robot_shown(&alone->robot)->odometry);
    }
}

static double metered(const struct alone *alone)
{
    return (double)jp_four_wheel_robot_shown(&alone->robot)->energy / 4294967296.0;
}

/* As the controller on a bus has it. */
static double held(struct alone *alone)
{
    if (alone->battery.is_at_charger) {
        alone->account_j = alone->battery.held_j + metered(alone);
    }
    return alone->account_j - metered(alone);
}

static void control(struct alone *alone)
{
    struct jp_four_wheel_sensors sensors;
    const char *field;

    patrol_body_read(&alone->body, &sensors);
    jp_four_wheel_robot_control(&alone->robot, JP_OK, &sensors, &alone->body.actuation);
    jp_four_wheel_robot_account(&alone->robot);
    if (alone->body.tick == ENABLE_TICK) {
        (void)jp_four_wheel_robot_enable(&alone->robot);
    }
    look(alone);
    jp_patrol_pilot_work(&alone->pilot);
    if (alone->body.tick == BEGIN_TICK) {
        alone->has_begun = jp_patrol_round_init(&alone->round, &alone->config, &alone->pilot, &field) == JP_OK;
    }
    if (alone->has_begun) {
        (void)jp_patrol_round_work(&alone->round, (float)held(alone), (float)TICK);
    }
}

static struct patrol_round_told told_alone(struct alone *alone)
{
    const struct jp_patrol_round *round = &alone->round;
    struct jp_patrol_leg_forecast left = {.energy = 0};
    float length;

    (void)jp_patrol_pilot_progress(&alone->pilot, &length, &left);
    return (struct patrol_round_told){.state = jp_round_told_of(round->state),
                                      .reason = jp_round_reason_of(round->reason),
                                      .stop = round->stop,
                                      .visits = round->visits,
                                      .charges = round->charges,
                                      .skipped = round->skipped,
                                      .held_j = held(alone),
                                      .least_left_j = (double)round->least_left,
                                      .left_j = (double)left.energy,
                                      .deviation_j = (double)left.deviation};
}

static void pass(struct alone *alone)
{
    control(alone);
    patrol_body_step(&alone->body);
    if (alone->has_begun) {
        const struct patrol_round_told told = told_alone(alone);

        patrol_round_record_tick(&alone->result->record, &told, &alone->body, alone->task->file->reserve_j);
    }
    fingerprint_add(&alone->result->fingerprint, &alone->body.plant.state, sizeof alone->body.plant.state);
}

bool patrol_round_drive(const struct patrol_round_task *task, struct patrol_round_result *result)
{
    struct alone *alone = calloc(1, sizeof *alone);
    bool is_done = false;

    *result = (struct patrol_round_result){.fingerprint = FINGERPRINT_START};
    if (alone == NULL) {
        error_line("%s: no memory for a drive over it", task->scene->name);
        return false;
    }
    alone->task = task;
    alone->result = result;
    if (enter(task, &alone->body, &alone->battery)) {
        is_done = prepare(alone);
        patrol_round_record_init(&result->record, task->log, task->file->stop_count, &alone->body);
        while (is_done && !is_over(task, result, &alone->body)) {
            pass(alone);
        }
        conclude(result, &alone->body);
        patrol_body_free(&alone->body);
    }
    free(alone->block);
    free(alone);
    return is_done;
}

/* Over a bus. */

struct on_bus {
    const struct patrol_round_task *task;
    struct patrol_round_result *result;
    struct bus_drive drive;
    struct patrol_body body;
    struct patrol_battery battery;
    struct jp_navigation_operator commander;
};

static struct patrol_round_told told_on_bus(const struct ecu_view *view)
{
    const bool has_plan = view->left.energy > 0;

    return (struct patrol_round_told){.state = (enum jp_round_told)view->round.state,
                                      .reason = (enum jp_round_reason)view->round.reason,
                                      .stop = view->round.stop,
                                      .visits = view->round.visits,
                                      .charges = view->round.charges,
                                      .skipped = view->round.skipped,
                                      .held_j = view->round_battery.held / JOULE,
                                      .least_left_j = view->round_battery.least_left / JOULE,
                                      .left_j = has_plan ? view->left.energy / JOULE_3 : 0,
                                      .deviation_j = view->left.deviation / JOULE_3};
}

static bool pass_on_bus(struct on_bus *run)
{
    struct bus_drive *drive = &run->drive;

    if (!bus_drive_lockstep(drive)) {
        error_line("the ECU does not answer: is it on the bus, and of a robot with four steered wheels?");
        return false;
    }
    plant_node_fingerprint(&drive->plant, &run->result->fingerprint);
    fingerprint_add(&run->result->fingerprint, &drive->view.spent.energy, sizeof drive->view.spent.energy);
    if (drive->view.round.state >= JP_ROUND_TOLD_SURVEYING) {
        const struct patrol_round_told told = told_on_bus(&drive->view);

        patrol_round_record_tick(&run->result->record, &told, &run->body, run->task->file->reserve_j);
    }
    return true;
}

/* False after one line: it did not come to be driven. */
static bool has_its_task(const struct on_bus *run)
{
    const struct jp_navigation_operator *commander = &run->commander;

    if (commander->phase != JP_NAVIGATION_FAILED || commander->failure == JP_NAVIGATION_ROUND_ENDED) {
        return true;
    }
    if (commander->failure == JP_NAVIGATION_ROUND || commander->failure == JP_NAVIGATION_NO_START) {
        error_line("%s: %s, stop %u", jp_navigation_failure_text(commander->failure),
                   patrol_round_reasons[commander->round.reason], commander->round.stop);
    } else {
        error_line("%s", jp_navigation_failure_text(commander->failure));
    }
    return false;
}

static bool drive_on_bus(struct on_bus *run)
{
    while (!is_over(run->task, run->result, &run->body)) {
        if (!pass_on_bus(run) || !has_its_task(run)) {
            return false;
        }
    }
    return true;
}

/* To the end. False after one line. */
static bool go_on_bus(struct on_bus *run, const struct jp_can_link *link, unsigned patience)
{
    const struct patrol_round_task *task = run->task;
    const struct jp_patrol_round_config config = patrol_round_config_of(task->file, task->scene);
    uint8_t round_bytes[JP_ROUND_BYTES_MAX];
    const struct jp_round_bytes round = {.bytes = round_bytes, .stops = (uint8_t)config.stop_count};
    struct jp_map_stream stream;
    uint8_t *map_bytes = patrol_bus_encode(task->scene, &stream);
    bool is_done = false;

    jp_round_encode(&config, round_bytes);
    if (map_bytes == NULL) {
        return false;
    }
    if (enter(task, &run->body, &run->battery)) {
        bus_drive_init_patrol(&run->drive, &run->body, link);
        run->drive.patience = patience;
        run->drive.navigation = &run->commander;
        run->result->map_bytes = stream.length;
        (void)jp_navigation_operator_patrol(&run->commander, &stream, &round);
        patrol_round_record_init(&run->result->record, task->log, task->file->stop_count, &run->body);
        is_done = drive_on_bus(run);
        conclude(run->result, &run->body);
        run->result->late = run->drive.late;
        patrol_body_free(&run->body);
    }
    free(map_bytes);
    return is_done;
}

bool patrol_round_drive_on_bus(const struct patrol_round_task *task, const struct jp_can_link *link, unsigned patience,
                               struct patrol_round_result *result)
{
    struct on_bus *run = calloc(1, sizeof *run);
    bool is_done = false;

    *result = (struct patrol_round_result){.fingerprint = FINGERPRINT_START};
    if (run == NULL) {
        error_line("%s: no memory for a drive over it", task->scene->name);
        return false;
    }
    run->task = task;
    run->result = result;
    is_done = go_on_bus(run, link, patience);
    free(run);
    return is_done;
}
