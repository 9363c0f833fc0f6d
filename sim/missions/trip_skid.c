#include "sim/missions/trip_skid.h"

#include <math.h>
#include <string.h>

#include "sim/base/error.h"
#include "sim/base/strict_math.h"
#include "sim/missions/navigation_skid.h"

/* Lines last so long at the usual speed, s; turns from line to line in rad. */
#define LINE_SECONDS_MIN 2.0
#define LINE_SECONDS_MAX 20.0
#define TURN_MAX         1.6

/* The way back is beside the way out by what is driven in so long, s. */
#define BACK_ASIDE_SECONDS 4.0

/* Beyond it a robot does not finish, s. */
#define SECONDS_MAX 7200.0

/* The available energy is this share of what the built-in model predicts. */
#define AVAILABLE_MIN 0.8
#define AVAILABLE_MAX 1.4

#define CONFIDENCE 0.95

#define Q16   65536.0
#define JOULE 4294967296.0
#define ANGLE (2 * M_PI / 4294967296.0)

struct drive {
    struct trip *trip;
    struct navigation_skid skid;
    struct navigation_robot robot;
    struct jp_skid_pilot unlearned; /* asked only */
    struct jp_point targets[TRIP_LEARNING_TARGETS];
    struct jp_path_piece pieces[JP_SKID_PILOT_PIECES(TRIP_LEARNING_TARGETS)]; /* of the robot's pilot */
    struct jp_path_piece asked[JP_SKID_PILOT_PIECES(TRIP_LEARNING_TARGETS)];  /* of the other one */
    struct random random;
    double speed;  /* usual, m/s */
    double energy; /* of the legs of this route, J */
};

static double seconds_of(const struct drive *drive)
{
    return (double)drive->skid.world.tick * skid_world_tick_seconds(&drive->skid.world);
}

static double joules(const struct drive *drive, jp_q16 energy)
{
    return ldexp(energy / Q16, drive->robot.unit_exponent);
}

static struct jp_vehicle_view seen(const struct drive *drive)
{
    struct jp_vehicle_view view = {.phase = JP_VEHICLE_OFF};

    drive->robot.vehicle.look(drive->robot.vehicle.context, &view);
    return view;
}

/* Routes, as odometry counts. */

static struct jp_point point_of(double x, double y)
{
    return (struct jp_point){(jp_q16)lround(x * Q16), (jp_q16)lround(y * Q16)};
}

static void draw_targets(struct drive *drive, unsigned count)
{
    const struct jp_vehicle_view view = seen(drive);
    double x = view.position.x / Q16;
    double y = view.position.y / Q16;
    double heading = (int32_t)view.heading * ANGLE;

    for (unsigned i = 0; i < count; i++) {
        const double length = drive->speed * random_uniform(&drive->random, LINE_SECONDS_MIN, LINE_SECONDS_MAX);

        heading += random_uniform(&drive->random, -TURN_MAX, TURN_MAX);
        x += length * strict_cos(heading);
        y += length * strict_sin(heading);
        drive->targets[i] = point_of(x, y);
    }
}

/* Out, then back beside the way out, to where it stands now; the number of targets. */
static uint16_t draw_route(struct drive *drive)
{
    const unsigned out = (unsigned)random_uniform(&drive->random, TRIP_OUT_MIN, TRIP_OUT_MAX + 1);
    const struct jp_vehicle_view view = seen(drive);
    const double heading = (int32_t)view.heading * ANGLE;
    const double aside = drive->speed * BACK_ASIDE_SECONDS;
    const struct jp_point off = point_of(-aside * strict_sin(heading), aside * strict_cos(heading));

    draw_targets(drive, out);
    for (unsigned i = 0; i < out; i++) {
        const struct jp_point *target = &drive->targets[out - 1 - i];

        drive->targets[out + i] = (struct jp_point){target->x + off.x, target->y + off.y};
    }
    drive->targets[2 * out] = view.position;
    return (uint16_t)(2 * out + 1);
}

/* Driving. */

static void tick(struct drive *drive)
{
    struct jp_skid_pilot *pilot = &drive->skid.pilot;
    const uint16_t ended = pilot->legs_ended;

    drive->robot.tick(drive->robot.self);
    (void)jp_skid_pilot_work(pilot);
    if (pilot->legs_ended > ended) {
        drive->energy += (double)pilot->result.energy / JOULE;
    }
}

/* Until the pilot rests; what stops the robot is the outcome. */
static void follow(struct drive *drive, uint16_t count)
{
    const struct jp_skid_pilot_route route = {.targets = drive->targets, .count = count};
    struct jp_skid_pilot *pilot = &drive->skid.pilot;

    drive->energy = 0;
    (void)jp_skid_pilot_follow(pilot, &route);
    while (pilot->phase != JP_SKID_PILOT_RESTING && seconds_of(drive) < SECONDS_MAX) {
        tick(drive);
    }
    if (pilot->phase != JP_SKID_PILOT_RESTING || pilot->status != JP_OK || drive->skid.world.plant.tipped) {
        drive->trip->outcome = TRIP_STOPPED;
    }
}

/* What the route takes; false: nobody can tell, and the trip ends. */
static bool foresee(struct drive *drive, struct jp_skid_pilot *pilot, uint16_t count, struct jp_forecast *forecast)
{
    const struct jp_skid_pilot_route route = {.targets = drive->targets, .count = count};
    enum jp_status status = jp_skid_pilot_ask(pilot, &route);

    while (status == JP_OK && pilot->phase == JP_SKID_PILOT_PLANNING) {
        status = jp_skid_pilot_work(pilot);
    }
    if (status == JP_OK) {
        status = jp_skid_pilot_answer(pilot, forecast);
    }
    if (status != JP_OK) {
        drive->trip->outcome = TRIP_STOPPED;
    }
    return status == JP_OK;
}

static void ask(struct drive *drive, uint16_t count)
{
    struct trip *trip = drive->trip;
    struct jp_forecast forecast = {0};
    jp_q16 spare = 0;

    if (!foresee(drive, &drive->unlearned, count, &forecast)) {
        return;
    }
    trip->unlearned = joules(drive, forecast.energy);
    if (!foresee(drive, &drive->skid.pilot, count, &forecast)) {
        return;
    }
    trip->predicted = joules(drive, forecast.energy);
    trip->deviation = joules(drive, forecast.deviation);
    trip->available = trip->unlearned * random_uniform(&drive->random, AVAILABLE_MIN, AVAILABLE_MAX);
    (void)jp_forecast_reserve(
        &forecast, (jp_q16)lround(fmin(INT32_MAX, ldexp(trip->available, -drive->robot.unit_exponent) * Q16)),
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
    drive->trip->measured = drive->energy;
    drive->trip->segments = drive->skid.pilot.legs_ended;
}

/* The whole. */

/* Corners as jp-mission rounds them. */
static bool prepare_pilot(struct drive *drive, struct jp_skid_pilot *pilot, struct jp_path_piece *pieces)
{
    struct jp_skid_pilot_config config = drive->skid.pilot.config;
    const char *field = "";

    config.corner = config.limits.width / 2;
    config.pieces = pieces;
    config.places = JP_SKID_PILOT_PIECES(TRIP_LEARNING_TARGETS);
    if (jp_skid_pilot_init(pilot, &config, &drive->skid.controller, &field) != JP_OK) {
        error_line("%s: %s is out of range; run make identify ROBOT=%s", drive->robot.name, field, drive->robot.name);
        return false;
    }
    return true;
}

static bool prepare(struct drive *drive, const struct skid_robot_entry *entry, const struct skid_steer_model *varied)
{
    const struct jp_terrain level = {.config = {.has_elevation = false}};
    const struct clearance_pose origin = {0, 0, 0};

    drive->speed = varied->lattice.speed_m_s;
    return navigation_skid_init(&drive->skid, entry, varied, &level, NULL, &origin, drive->trip->seed, &drive->robot) &&
           prepare_pilot(drive, &drive->skid.pilot, drive->pieces) &&
           prepare_pilot(drive, &drive->unlearned, drive->asked);
}

static void finish(const struct drive *drive, struct trip_skid *skid)
{
    const struct jp_skid_learner *learner = &drive->skid.pilot.learner;
    struct trip *trip = &skid->trip;
    jp_q16 factor[JP_SKID_FACTORS];

    jp_skid_learner_factors(learner, factor);
    for (unsigned i = 0; i < JP_SKID_FACTORS; i++) {
        skid->factor[i] = factor[i] / Q16;
    }
    trip->outliers = learner->outliers;
    trip->version = learner->state.version;
    trip->charge = drive->skid.world.plant.state.ledger.battery / drive->skid.world.plant.model.supply.voltage_v;
    trip->seconds = seconds_of(drive);
}

bool trip_skid_run(struct trip_skid *skid, const struct skid_robot_entry *entry, const struct skid_steer_model *model,
                   uint64_t seed)
{
    struct drive drive = {.trip = &skid->trip};

    *skid = (struct trip_skid){.trip = {.seed = seed}};
    random_init(&drive.random, seed);
    skid->variation = skid_random_variation(&drive.random);

    const struct skid_steer_model varied = skid_varied(model, &skid->variation);

    if (!prepare(&drive, entry, &varied)) {
        return false;
    }
    draw_targets(&drive, TRIP_LEARNING_TARGETS);
    follow(&drive, TRIP_LEARNING_TARGETS);
    if (skid->trip.outcome == TRIP_DONE) {
        go(&drive);
    }
    finish(&drive, skid);
    return true;
}
