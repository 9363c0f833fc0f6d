#include "tests/bench/patrol_rounds.h"

#include <joulepath/patrol_round.h>
#include <math.h>
#include <stdlib.h>

#include "sim/base/clearance.h"
#include "sim/bus/patrol_body.h"
#include "sim/four_wheel/four_wheel_drive.h"
#include "sim/four_wheel/patrol_robots.h"
#include "sim/scenes/patrol_scene.h"

#define BATTERY    12000.0 /* J */
#define CHARGING   50.0    /* J a tick: 5 kW, so that the time goes into driving */
#define RESERVE    200.0
#define DEVIATIONS 1.645
#define SPARE      0.1 /* m */

#define PERSON_RADIUS 0.25 /* m */
#define PERSON_SPARE  0.5
#define WALK_MIN      3.0

enum { STOPS = 4, PEOPLE = 3, POINTS_MAX = 4096, TURNS_MAX = 1024 };

#define TICK (1.0 / FOUR_WHEEL_RATE_HZ)

struct run {
    struct four_wheel_file robot;
    struct patrol_scene scene;
    struct patrol_body body;
    struct jp_four_wheel_robot controller;
    struct jp_patrol_pilot pilot;
    struct jp_patrol_round round;
    void *block;
    float ranges[LASER_BEAMS_MAX];
    double battery; /* J left */
    struct jp_plane_pose stops[STOPS];
    bool was_touching; /* a thing */
    enum jp_patrol_round_state before;
};

static bool is_free(const struct run *run, double x, double y, double radius)
{
    const struct clearance_robot shape = {2 * radius, 2 * radius, 0};
    const struct clearance_pose place = {x, y, 0};

    return clearance_at(&run->scene.map, &shape, &place) && clearance_at(&run->scene.ground, &shape, &place);
}

static bool is_roomy(const struct run *run, const struct jp_plane_pose *pose)
{
    const double radius = hypot(run->robot.body.length_m, run->robot.body.width_m) / 2 + SPARE;

    return is_free(run, (double)pose->x, (double)pose->y, radius);
}

static struct jp_plane_pose draw_place(const struct run *run, struct random *random)
{
    const double cell = run->scene.map.config.resolution / 65536.0;
    struct jp_plane_pose pose;

    do {
        pose.x = (float)random_uniform(random, 0, run->scene.map.config.width * cell);
        pose.y = (float)random_uniform(random, 0, run->scene.map.config.height * cell);
        pose.heading = (float)random_uniform(random, -M_PI, M_PI);
    } while (!is_roomy(run, &pose));
    return pose;
}

static bool is_walkable(const struct run *run, const struct planar_point *from, const struct planar_point *to)
{
    const int steps = (int)ceil(hypot(to->x - from->x, to->y - from->y) / 0.1);

    for (int i = 0; i <= steps; i++) {
        const double share = (double)i / steps;

        if (!is_free(run, from->x + share * (to->x - from->x), from->y + share * (to->y - from->y), PERSON_SPARE)) {
            return false;
        }
    }
    return true;
}

static struct walker draw_person(const struct run *run, struct random *random)
{
    struct walker person = {.radius = PERSON_RADIUS};

    do {
        const struct jp_plane_pose from = draw_place(run, random);
        const struct jp_plane_pose to = draw_place(run, random);

        person.from = (struct planar_point){(double)from.x, (double)from.y};
        person.to = (struct planar_point){(double)to.x, (double)to.y};
    } while (hypot(person.to.x - person.from.x, person.to.y - person.from.y) < WALK_MIN ||
             !is_walkable(run, &person.from, &person.to));
    person.speed = random_uniform(random, 0.6, 1.5);
    person.pause = random_uniform(random, 5, 60);
    return person;
}

static struct jp_patrol_round_config config_of(struct run *run, struct random *random)
{
    struct jp_patrol_round_config config = {.stop_count = STOPS,
                                            .charger = run->scene.start,
                                            .full = (float)BATTERY,
                                            .reserve = (float)RESERVE,
                                            .deviations = (float)DEVIATIONS,
                                            .standing_power = (float)run->robot.electronics.power_w};

    for (int i = 0; i < STOPS; i++) {
        run->stops[i] = draw_place(run, random);
        config.stops[i].pose = run->stops[i];
        config.stops[i].dwell = (float)random_uniform(random, 5, 30);
    }
    return config;
}

static bool prepare(struct run *run, const struct four_wheel_file *file, uint64_t seed)
{
    const struct patrol_robot_entry *entry = patrol_robot_find("patrol");
    const struct jp_patrol_pilot_config tables = {.patrol = entry->patrol,
                                                  .localiser = entry->localiser,
                                                  .scanner = entry->scanner,
                                                  .energy = entry->energy,
                                                  .learning = entry->learning,
                                                  .points_max = POINTS_MAX,
                                                  .turns_max = TURNS_MAX};
    struct random random;
    const char *field;

    random_init(&random, seed);
    const struct four_wheel_variation variation = four_wheel_random_variation(&random);

    run->robot = four_wheel_varied(file, &variation);
    patrol_scene_make(PATROL_WAREHOUSE, seed, &run->scene);
    for (; run->scene.people_count < PEOPLE; run->scene.people_count++) {
        run->scene.people[run->scene.people_count] = draw_person(run, &random);
    }
    run->battery = BATTERY;
    if (!patrol_body_init(&run->body, &run->robot, &run->scene, seed) ||
        jp_four_wheel_robot_init(&run->controller, entry->config, &field) != JP_OK ||
        jp_patrol_pilot_init(&run->pilot, &tables, &run->controller, &field) != JP_OK) {
        return false;
    }
    const size_t size = jp_patrol_pilot_size(&run->pilot, &run->scene.map);
    const struct jp_patrol_round_config config = config_of(run, &random);

    run->body.is_world_moving = true;
    run->block = malloc(size);
    return run->block != NULL &&
           jp_patrol_pilot_take_map(&run->pilot, &run->scene.map, &run->scene.start, run->block, size, &field) ==
               JP_OK &&
           jp_patrol_round_init(&run->round, &config, &run->pilot, &field) == JP_OK;
}

static void look(struct run *run)
{
    const struct planar_pose mount = {run->robot.laser.x_m, run->robot.laser.y_m, 0};
    const struct planar_pose scanner = planar_compose(&run->body.plant.state.pose, &mount);

    laser_take(&run->body.laser, &run->body.world.map, run->body.world.shapes, run->body.world.shape_count, &scanner,
               &run->body.random, &run->body.scan);
    jp_patrol_pilot_see(&run->pilot, run->body.scan.ranges, &jp_four_wheel_robot_shown(&run->controller)->odometry);
}

static void tick(struct run *run, uint64_t number, struct patrol_rounds_outcome *outcome)
{
    struct jp_four_wheel_sensors sensors;
    const double x = run->body.plant.state.pose.x;
    const double y = run->body.plant.state.pose.y;
    const double before = run->body.plant.ledger.battery;

    patrol_body_read(&run->body, &sensors);
    jp_four_wheel_robot_control(&run->controller, JP_OK, &sensors, &run->body.actuation);
    jp_four_wheel_robot_account(&run->controller);
    if (number == 5) {
        (void)jp_four_wheel_robot_enable(&run->controller);
    }
    if (number % 10 == 0) {
        look(run);
    }
    jp_patrol_pilot_work(&run->pilot);
    run->before = run->round.state;
    (void)jp_patrol_round_work(&run->round, (float)run->battery, (float)TICK);
    patrol_body_step(&run->body);
    run->battery -= run->body.plant.ledger.battery - before;
    if (run->round.state == JP_ROUND_CHARGING || run->round.state == JP_ROUND_SURVEYING) { /* at the charger */
        run->battery = fmin(run->battery + CHARGING, BATTERY);
    }
    outcome->length += hypot(run->body.plant.state.pose.x - x, run->body.plant.state.pose.y - y);
}

/* Of where it stands from the place at which it says that it is. */
static struct patrol_rounds_error error_of(const struct run *run, const struct jp_plane_pose *stop)
{
    const struct planar_pose *const pose = &run->body.plant.state.pose;
    const double heading = remainder(pose->heading - (double)stop->heading, 2 * M_PI);

    return (struct patrol_rounds_error){hypot(pose->x - (double)stop->x, pose->y - (double)stop->y),
                                        fabs(heading) * 180 / M_PI};
}

static void widen(struct patrol_rounds_error *worst, const struct patrol_rounds_error *error)
{
    worst->position = fmax(worst->position, error->position);
    worst->heading = fmax(worst->heading, error->heading);
}

static void note(struct run *run, bool is_last_hour, struct patrol_rounds_outcome *outcome)
{
    const bool touches = run->body.world.touch == PATROL_TOUCH_MAP || run->body.world.touch == PATROL_TOUCH_OBSTACLE;

    outcome->collisions += touches && !run->was_touching;
    run->was_touching = touches;
    if (run->before == JP_ROUND_HOMING && run->round.state == JP_ROUND_SURVEYING) {
        outcome->below_reserve += run->battery < RESERVE;
    }
    if (run->before == JP_ROUND_LEAVING && run->round.state == JP_ROUND_DWELLING) {
        const struct patrol_rounds_error error = error_of(run, &run->stops[run->round.stop]);

        widen(&outcome->worst, &error);
        if (is_last_hour) {
            widen(&outcome->worst_of_last_hour, &error);
        }
    }
}

static void patrol(struct run *run, double hours, struct patrol_rounds_outcome *outcome)
{
    const uint64_t ticks = (uint64_t)(hours * 3600 / TICK);
    uint64_t i;

    for (i = 0; i < ticks && run->battery > 0 && run->round.state != JP_ROUND_FAILED; i++) {
        tick(run, i, outcome);
        note(run, (double)(ticks - i) * TICK <= 3600, outcome);
    }
    outcome->hours = (double)i * TICK / 3600;
    outcome->visits = run->round.visits;
    outcome->charges = run->round.charges;
    outcome->skipped = run->round.skipped;
    outcome->stranded = run->battery <= 0;
    outcome->failed = run->round.state == JP_ROUND_FAILED;
    outcome->energy = run->body.plant.ledger.battery;
    outcome->collisions += run->body.world.contacts.collisions;
    outcome->walked_into = run->body.world.contacts.touches - run->body.world.contacts.collisions;
}

bool patrol_rounds_run(const struct four_wheel_file *robot, uint64_t seed, double hours,
                       struct patrol_rounds_outcome *outcome)
{
    struct run *run = calloc(1, sizeof *run);
    const bool is_ready = run != NULL && prepare(run, robot, seed);

    *outcome = (struct patrol_rounds_outcome){0};
    if (is_ready) {
        patrol(run, hours, outcome);
        patrol_body_free(&run->body);
        free(run->block);
        patrol_scene_free(&run->scene);
    }
    free(run);
    return is_ready;
}

struct patrol_rounds_outcome patrol_rounds_sum(const struct patrol_rounds_outcome *outcomes, int count)
{
    struct patrol_rounds_outcome sum = {0};

    for (int i = 0; i < count; i++) {
        const struct patrol_rounds_outcome *one = &outcomes[i];

        sum.visits += one->visits;
        sum.charges += one->charges;
        sum.skipped += one->skipped;
        sum.below_reserve += one->below_reserve;
        sum.stranded += one->stranded;
        sum.failed += one->failed;
        sum.collisions += one->collisions;
        sum.walked_into += one->walked_into;
        sum.energy += one->energy;
        sum.length += one->length;
        sum.hours += one->hours;
        widen(&sum.worst, &one->worst);
        widen(&sum.worst_of_last_hour, &one->worst_of_last_hour);
    }
    return sum;
}

json_t *patrol_rounds_row(const struct patrol_rounds_outcome *outcome, uint64_t seed)
{
    return json_pack(
        "{s:I, s:f, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:f, s:f, s:f, s:f, s:f, s:f}", "seed", (json_int_t)seed,
        "hours", outcome->hours, "visits", (int)outcome->visits, "charges", (int)outcome->charges, "skipped",
        (int)outcome->skipped, "below_reserve", (int)outcome->below_reserve, "stranded", (int)outcome->stranded,
        "failed", (int)outcome->failed, "collisions", (int)outcome->collisions, "walked_into",
        (int)outcome->walked_into, "energy_j", outcome->energy, "length_m", outcome->length, "position_error_m",
        outcome->worst.position, "heading_error_deg", outcome->worst.heading, "last_hour_position_error_m",
        outcome->worst_of_last_hour.position, "last_hour_heading_error_deg", outcome->worst_of_last_hour.heading);
}
