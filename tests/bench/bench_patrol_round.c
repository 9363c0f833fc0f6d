/* Hours of patrol: robots that differ from their tables go round between places of a hall among people, and home to the
 * charger while the energy in the battery lasts. Prints figures as JSON.
 *
 * Cases, stated before they were measured: the warehouse of seeds 4001 on; four places drawn evenly where a robot that
 * turns has 0.1 m to spare on map and ground; stays of 5…30 s; a robot drawn by four_wheel_random_variation(); a
 * battery of 12 kJ, of which 200 J shall be left; a quarter of an hour each. */
#include <joulepath/patrol_round.h>
#include <math.h>
#include <stdlib.h>

#include "sim/base/clearance.h"
#include "sim/base/parallel.h"
#include "sim/bus/patrol_body.h"
#include "sim/four_wheel/four_wheel_drive.h"
#include "sim/four_wheel/four_wheel_file.h"
#include "sim/four_wheel/patrol_robots.h"
#include "sim/scenes/patrol_scene.h"
#include "tests/bench/figures.h"

#define COMMAND "make bench-patrol-round"

#define FIRST_SEED 4001U
#define HOURS      0.25
#define BATTERY    12000.0 /* J */
#define CHARGING   50.0    /* J a tick: 5 kW, so that the time goes into driving */
#define RESERVE    200.0
#define DEVIATIONS 1.645
#define SPARE      0.1 /* m */

enum { RUNS = 12, STOPS = 4, POINTS_MAX = 4096, TURNS_MAX = 1024 };

struct outcome {
    uint32_t visits;
    uint32_t charges;
    uint32_t skipped;
    uint32_t below_reserve; /* homecomings with less than the reserve */
    uint32_t stranded;      /* 1: the battery ran out before it was home */
    uint32_t touches;
    uint32_t failed;
    double energy;
    double length;
};

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
    bool was_touching;
    enum jp_patrol_round_state before;
};

static bool is_roomy(const struct run *run, const struct jp_plane_pose *pose)
{
    const double side = 2 * (hypot(run->robot.body.length_m, run->robot.body.width_m) / 2 + SPARE);
    const struct clearance_robot shape = {side, side, 0};
    const struct clearance_pose place = {(double)pose->x, (double)pose->y, 0};

    return clearance_at(&run->scene.map, &shape, &place) && clearance_at(&run->scene.ground, &shape, &place);
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

static struct jp_patrol_round_config config_of(const struct run *run, struct random *random)
{
    struct jp_patrol_round_config config = {.stop_count = STOPS,
                                            .charger = run->scene.start,
                                            .full = (float)BATTERY,
                                            .reserve = (float)RESERVE,
                                            .deviations = (float)DEVIATIONS,
                                            .standing_power = (float)run->robot.electronics.power_w};

    for (int i = 0; i < STOPS; i++) {
        config.stops[i].pose = draw_place(run, random);
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

static void tick(struct run *run, uint64_t number, struct outcome *outcome)
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
    (void)jp_patrol_round_work(&run->round, (float)run->battery, 0.01f);
    patrol_body_step(&run->body);
    run->battery -= run->body.plant.ledger.battery - before;
    if (run->round.state == JP_ROUND_CHARGING || run->round.state == JP_ROUND_SURVEYING) { /* at the charger */
        run->battery = fmin(run->battery + CHARGING, BATTERY);
    }
    outcome->length += hypot(run->body.plant.state.pose.x - x, run->body.plant.state.pose.y - y);
}

static void note(struct run *run, struct outcome *outcome)
{
    const bool touches = run->body.world.touch != PATROL_TOUCH_NONE;

    outcome->touches += touches && !run->was_touching;
    run->was_touching = touches;
    if (run->before == JP_ROUND_HOMING && run->round.state == JP_ROUND_SURVEYING) {
        outcome->below_reserve += run->battery < RESERVE;
    }
}

static void patrol(struct run *run, struct outcome *outcome)
{
    const uint64_t ticks = (uint64_t)(HOURS * 3600 * FOUR_WHEEL_RATE_HZ);

    for (uint64_t i = 0; i < ticks && run->battery > 0 && run->round.state != JP_ROUND_FAILED; i++) {
        tick(run, i, outcome);
        note(run, outcome);
    }
    outcome->visits = run->round.visits;
    outcome->charges = run->round.charges;
    outcome->skipped = run->round.skipped;
    outcome->stranded = run->battery <= 0;
    outcome->failed = run->round.state == JP_ROUND_FAILED;
    outcome->energy = run->body.plant.ledger.battery;
}

struct bench {
    struct four_wheel_file robot;
    struct outcome outcomes[RUNS];
};

static void run_one(void *context, size_t index)
{
    struct bench *bench = context;
    struct run *run = calloc(1, sizeof *run);

    if (run != NULL && prepare(run, &bench->robot, FIRST_SEED + index)) {
        patrol(run, &bench->outcomes[index]);
        patrol_body_free(&run->body);
        free(run->block);
        patrol_scene_free(&run->scene);
    }
    free(run);
}

/* ---- Figures ---- */

static struct outcome sum_of(const struct bench *bench)
{
    struct outcome sum = {0};

    for (int i = 0; i < RUNS; i++) {
        const struct outcome *one = &bench->outcomes[i];

        sum.visits += one->visits;
        sum.charges += one->charges;
        sum.skipped += one->skipped;
        sum.below_reserve += one->below_reserve;
        sum.stranded += one->stranded;
        sum.touches += one->touches;
        sum.failed += one->failed;
        sum.energy += one->energy;
        sum.length += one->length;
    }
    return sum;
}

static json_t *figures_of(const struct outcome *sum)
{
    json_t *figures = json_array();
    const double homecomings = sum->charges + sum->stranded;

    figures_add(figures, COMMAND, 100.0 * (sum->charges - sum->below_reserve) / fmax(homecomings, 1), "%", at_least(95),
                "patrol round: homecomings with the reserve or more");
    figures_add(figures, COMMAND, sum->stranded, "", equal_to(0), "patrol round: robots whose battery ran out");
    figures_add(figures, COMMAND, sum->failed, "", equal_to(0), "patrol round: robots that gave up");
    figures_add(figures, COMMAND, sum->touches, "", equal_to(0), "patrol round: touches");
    figures_add(figures, COMMAND, sum->charges, "", no_bar, "patrol round: homecomings");
    figures_add(figures, COMMAND, sum->visits, "", no_bar, "patrol round: places visited");
    figures_add(figures, COMMAND, sum->skipped, "", no_bar, "patrol round: places left out");
    figures_add(figures, COMMAND, sum->length, "m", no_bar, "patrol round: driven");
    return figures;
}

int main(int argc, char **argv)
{
    static struct bench bench;
    const char *rows_path = figures_rows_path(argc, argv, "Measures hours of patrol on a battery.");
    json_t *rows = json_array();

    if (!four_wheel_file_load("sim/robots/patrol.cfg", &bench.robot)) {
        return 2;
    }
    in_parallel("rounds", run_one, &bench, RUNS);
    for (int i = 0; i < RUNS; i++) {
        const struct outcome *one = &bench.outcomes[i];

        (void)json_array_append_new(
            rows, json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:f}", "seed",
                            (json_int_t)(FIRST_SEED + (unsigned)i), "visits", (json_int_t)one->visits, "charges",
                            (json_int_t)one->charges, "skipped", (json_int_t)one->skipped, "below_reserve",
                            (json_int_t)one->below_reserve, "stranded", (json_int_t)one->stranded, "touches",
                            (json_int_t)one->touches, "failed", (json_int_t)one->failed, "energy_j", one->energy,
                            "length_m", one->length));
    }
    const struct outcome sum = sum_of(&bench);

    figures_write_rows(rows, rows_path);
    figures_print(figures_of(&sum));
    return 0;
}
