#include "sim/missions/trip.h"

#include <joulepath/pilot.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/balancer/energy_unit.h"
#include "sim/base/error.h"
#include "sim/base/strict_math.h"
#include "sim/missions/random_targets.h"

/* The way back is this much to the left of the way out, m. */
#define BACK_ASIDE 2.0

/* Beyond it a robot does not finish, s. */
#define SECONDS_MAX 3600.0

/* A stand before a route begins, s. */
#define STAND_SECONDS 8.0

/* The available energy is this share of what the built-in model predicts. */
#define AVAILABLE_MIN 0.8
#define AVAILABLE_MAX 1.4

#define CONFIDENCE 0.95

#define PUSH_SECONDS  4.0 /* mean time between two */
#define PUSH_N        3.0
#define PUSH_TICKS    100
#define DROP_SECONDS  0.5 /* mean time between two */
#define OFFSET_A      0.3
#define GROUND_CHANGE 1.5
#define PAYLOAD_SHARE (2.0 / 3) /* of the range that the robot file allows */

struct drive {
    struct trip *trip;
    struct rig rig;
    struct jp_pilot pilot;
    struct jp_pilot unlearned; /* asked only */
    struct jp_point targets[TRIP_LEARNING_TARGETS];
    struct random random;
    struct random disturbance;
    const struct robot_file *file;
    uint16_t segments_ended;
    unsigned segments; /* ended, of this route */
    double energy;     /* of them, J */
};

static double joules(jp_energy energy)
{
    return (double)energy / 4294967296.0;
}

static double from_q16(jp_q16 value)
{
    return (double)value / JP_Q16_ONE;
}

/* The world. */

static uint64_t ticks_of(const struct drive *drive, double seconds)
{
    return (uint64_t)lround(seconds / world_tick_seconds(&drive->rig.world));
}

static bool draw_event(struct drive *drive, double mean_seconds)
{
    return random_uniform(&drive->disturbance, 0, mean_seconds) < world_tick_seconds(&drive->rig.world);
}

static void disturb(struct drive *drive)
{
    struct world *world = &drive->rig.world;

    if (drive->trip->fault == TRIP_FAULT_PUSHES && draw_event(drive, PUSH_SECONDS)) {
        world_push(world, random_uniform(&drive->disturbance, -PUSH_N, PUSH_N), 0, PUSH_TICKS);
    } else if (drive->trip->fault == TRIP_FAULT_DROPPED_SAMPLES && draw_event(drive, DROP_SECONDS)) {
        world->faults.count = 0;
        (void)world_add_fault(
            world, &(struct world_fault){.channel = WORLD_HAL_READ, .from = world->tick, .until = world->tick + 1});
    }
}

static void begin_fault(struct drive *drive)
{
    if (drive->trip->fault == TRIP_FAULT_CURRENT_OFFSET) {
        (void)world_add_fault(&drive->rig.world, &(struct world_fault){.channel = WORLD_CURRENT_LEFT,
                                                                       .kind = WORLD_JUMPED,
                                                                       .value = JP_Q16(OFFSET_A),
                                                                       .from = drive->rig.world.tick});
    }
}

static void change_robot(struct drive *drive)
{
    struct trip *trip = drive->trip;
    struct robot_file varied;

    if (trip->change == TRIP_CHANGE_GROUND) {
        trip->variation.ground_friction *= GROUND_CHANGE;
    } else if (trip->change == TRIP_CHANGE_PAYLOAD) {
        const double *range = drive->file->limits.payload_kg;

        trip->variation.payload_kg += (range[1] - range[0]) * PAYLOAD_SHARE;
    }
    variation_apply(&trip->variation, drive->file, &varied);
    (void)world_change_robot(&drive->rig.world, &varied);
}

/* Driving. */

static void tick(struct drive *drive)
{
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(&drive->rig.robot);
    const struct world *world = &drive->rig.world;
    const double electrical = world->plant.ledger.electrical;

    disturb(drive);
    (void)jp_pilot_work(&drive->pilot);
    rig_tick(&drive->rig);
    if (telemetry->segments_ended != drive->segments_ended) {
        drive->segments_ended = telemetry->segments_ended;
        if (telemetry->segments_ended != 0) {
            drive->segments++;
            drive->energy += joules(telemetry->segment_energy_model);
        }
    }
    drive->trip->charge +=
        (world->plant.ledger.electrical - electrical + world->robot.electronics.power_w * world_tick_seconds(world)) /
        world->bus_voltage;
}

static bool stands(const struct drive *drive)
{
    return jp_robot_state_now(&drive->rig.robot) == JP_ROBOT_BALANCING;
}

static void stand(struct drive *drive)
{
    const uint64_t end = drive->rig.world.tick + ticks_of(drive, STAND_SECONDS);

    while (drive->rig.world.tick < end) {
        tick(drive);
    }
}

/* Until the pilot rests or half of the targets are passed; what stops the robot is the outcome. */
static void drive_on(struct drive *drive, unsigned until_segment)
{
    const uint64_t end = ticks_of(drive, SECONDS_MAX);

    while (drive->pilot.phase != JP_PILOT_RESTING && drive->segments < until_segment && drive->rig.world.tick < end) {
        tick(drive);
    }

    const enum jp_robot_state state = jp_robot_state_now(&drive->rig.robot);

    if (state == JP_ROBOT_FALLEN) {
        drive->trip->outcome = TRIP_FELL;
    } else if (state == JP_ROBOT_FAULT || drive->pilot.status != JP_OK || drive->rig.world.tick >= end) {
        drive->trip->outcome = TRIP_STOPPED;
    }
}

static void follow(struct drive *drive, uint16_t count)
{
    drive->segments = 0;
    drive->segments_ended = jp_robot_last_tick(&drive->rig.robot)->segments_ended;
    drive->energy = 0;
    (void)jp_pilot_follow(&drive->pilot, &(struct jp_pilot_route){.targets = drive->targets, .count = count});
}

/* Routes. */

static void learn(struct drive *drive)
{
    random_targets_draw(&drive->random, &drive->rig, drive->targets, TRIP_LEARNING_TARGETS);
    follow(drive, TRIP_LEARNING_TARGETS);
    if (drive->trip->change != TRIP_CHANGE_NONE) {
        drive_on(drive, 1);
        change_robot(drive);
    }
    drive_on(drive, TRIP_LEARNING_TARGETS + 1);
}

/* Out, then back beside the way out, to where it stands now; the number of targets. */
static uint16_t draw_route(struct drive *drive)
{
    const uint16_t out = (uint16_t)random_uniform(&drive->random, TRIP_OUT_MIN, TRIP_OUT_MAX + 1);
    const struct jp_point home = jp_robot_position(&drive->rig.robot);
    const double heading = drive->rig.world.plant.state.yaw;
    const jp_q16 aside_x = (jp_q16)lround(-BACK_ASIDE * strict_sin(heading) * JP_Q16_ONE);
    const jp_q16 aside_y = (jp_q16)lround(BACK_ASIDE * strict_cos(heading) * JP_Q16_ONE);

    random_targets_draw(&drive->random, &drive->rig, drive->targets, out);
    for (uint16_t i = 0; i < out; i++) {
        const struct jp_point *target = &drive->targets[out - 1 - i];

        drive->targets[out + i] = (struct jp_point){target->x + aside_x, target->y + aside_y};
    }
    drive->targets[2 * out] = home;
    return (uint16_t)(2 * out + 1);
}

/* What the route takes; false: nobody can tell, and the trip ends. */
static bool foresee(struct drive *drive, struct jp_pilot *pilot, uint16_t count, struct jp_forecast *forecast)
{
    enum jp_status status = jp_pilot_ask(pilot, &(struct jp_pilot_route){.targets = drive->targets, .count = count});

    while (status == JP_OK && jp_pilot_answer(pilot, forecast) == JP_WORKING) {
        (void)jp_pilot_work(pilot);
    }
    if (status == JP_OK) {
        status = jp_pilot_answer(pilot, forecast);
    }
    if (status != JP_OK) {
        drive->trip->outcome = TRIP_STOPPED;
    }
    return status == JP_OK;
}

static void ask(struct drive *drive, uint16_t count)
{
    struct trip *trip = drive->trip;
    const struct jp_energy_model *model = drive->pilot.config.model;
    struct jp_forecast forecast = {0};
    jp_q16 spare = 0;

    if (!foresee(drive, &drive->unlearned, count, &forecast)) {
        return;
    }
    trip->unlearned = energy_unit_joules(model, forecast.energy);
    if (!foresee(drive, &drive->pilot, count, &forecast)) {
        return;
    }
    trip->predicted = energy_unit_joules(model, forecast.energy);
    trip->deviation = energy_unit_joules(model, forecast.deviation);
    trip->available = trip->unlearned * random_uniform(&drive->random, AVAILABLE_MIN, AVAILABLE_MAX);
    (void)jp_forecast_reserve(&forecast, (jp_q16)lround(fmin(INT32_MAX, energy_unit_number(model, trip->available))),
                              (jp_q31)lround(CONFIDENCE * 2147483648.0), &spare);
    trip->answer = spare >= 0;
}

static void go(struct drive *drive)
{
    const uint16_t count = draw_route(drive);

    ask(drive, count);
    if (drive->trip->outcome != TRIP_DONE) {
        return;
    }
    follow(drive, count);
    drive_on(drive, count + 1U);
    drive->trip->measured = drive->energy;
    drive->trip->segments = drive->segments;
}

/* The whole. */

static void draw_disturbance(struct trip *trip, struct random *random, bool disturbed)
{
    const double fault = random_uniform(random, 0, TRIP_FAULTS);
    const double change = random_uniform(random, 0, TRIP_CHANGES);

    trip->fault = disturbed ? (enum trip_fault)fault : TRIP_FAULT_NONE;
    trip->change = disturbed ? (enum trip_change)change : TRIP_CHANGE_NONE;
}

static bool prepare(struct drive *drive, const struct robot_entry *entry)
{
    const struct jp_pilot_config config = {.model = entry->energy, .learning = entry->learning};
    const struct jp_pilot_config plain = {.model = entry->energy};
    struct robot_file varied;
    const char *field = "";

    variation_apply(&drive->trip->variation, drive->file, &varied);
    if (!rig_init(&drive->rig, entry, &varied, drive->trip->seed)) {
        return false;
    }
    if (entry->learning == NULL || jp_pilot_init(&drive->pilot, &config, &drive->rig.robot, &field) != JP_OK ||
        jp_pilot_init(&drive->unlearned, &plain, &drive->rig.robot, &field) != JP_OK) {
        error_line("%s: no tables for learning %s; run make learning ROBOT=%s", entry->name, field, entry->name);
        return false;
    }
    return true;
}

static void finish(struct drive *drive)
{
    jp_q16 ground;
    jp_q16 payload;

    jp_learner_causes(&drive->pilot.learner, &ground, &payload);
    drive->trip->ground = from_q16(ground);
    drive->trip->payload = from_q16(payload);
    drive->trip->outliers = drive->pilot.learner.outliers;
    drive->trip->version = drive->pilot.learner.state.version;
    jp_learner_model(&drive->pilot.learner, &drive->trip->learned);
    drive->trip->seconds = (double)drive->rig.world.tick * world_tick_seconds(&drive->rig.world);
}

bool trip_run(struct trip *trip, const struct robot_entry *entry, const struct robot_file *file, uint64_t seed,
              bool disturbed)
{
    struct drive drive = {.trip = trip, .file = file};

    *trip = (struct trip){.seed = seed};
    random_init(&drive.random, seed);
    random_init(&drive.disturbance, seed + ((uint64_t)1 << 40));
    variation_draw(&drive.random, file, &trip->variation);
    draw_disturbance(trip, &drive.random, disturbed);
    if (!prepare(&drive, entry)) {
        return false;
    }
    rig_release(&drive.rig, 0);
    stand(&drive);
    begin_fault(&drive);
    learn(&drive);
    if (trip->outcome == TRIP_DONE) {
        stand(&drive);
        if (stands(&drive)) {
            go(&drive);
        }
    }
    finish(&drive);
    return true;
}
