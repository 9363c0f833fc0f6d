/* Robots that drive to a goal and home on what is in their battery: how many of those whose goal is at the border of
 * what they can return from with 95 % return, and whether those that turn back by themselves come home, and had to.
 * Prints figures as JSON, progress on stderr.
 *
 * Cases, stated before they were measured. A robot a seed from 930001 on for the border, from 950001 on in use, which
 * nothing was designed on; drawn as in the other benches
 * (skid_random_variation(), variation_draw()), on the dense map of its seed (tests/support/dense_map.h), whose boxes it
 * does not know; of the skid-steered robot on hills up to its limit. It makes TRIPS trips from its home, to goals drawn
 * like that of the map, and keeps what it learns. Before each trip but the first it becomes another robot, on another
 * ground, with a probability of ¼; on a third of the trips of robots that their sides steer the ground resists to
 * rolling by another factor of 0.7…1.5 from a moment on that is drawn evenly over the energy of the trip. The battery's
 * estimate has a deviation of 2 % of what it holds, and errs by it. At the border: it holds what by the return map,
 * before the robot leaves, brings it there and home with 95 %; it does not turn back. In use: it holds 0.5…1.5 times
 * the energy that the return map expects, evenly drawn; the robot turns back at 99.9 %, or does not leave. One that did
 * drives the same trip again without turning back: so it shows whether it would have made it. Trips to goals to which
 * no way leads, or from which none leads home, are counted apart. */
#include <joulepath/learner.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/variation.h"
#include "sim/base/parallel.h"
#include "sim/missions/navigation_sight.h"
#include "sim/skid_steer/skid_route.h"
#include "tests/bench/figures.h"
#include "tests/bench/statistics.h"
#include "tests/support/navigate_trial.h"

#define COMMAND "make bench-home"

#define BORDER_SEED       930001U
#define USE_SEED          950001U
#define MEMORY            ((size_t)4 << 20) /* of the planner, bytes */
#define VIEW              25                /* cells */
#define PATIENCE          3600              /* simulated s */
#define BATTERY_DEVIATION 0.02
#define BORDER            0.95
#define BORDER_QUANTILE   1.6448536
#define CONFIDENCE        0.999

enum { ROBOTS_MAX = 320, TRIPS = 4 };

/* On hills one goal of four has a way. */
static const struct kind {
    const char *name;
    size_t robots; /* at the border, and in use */
} kinds[] = {{"zhang2018", ROBOTS_MAX}, {"courier24", 48}};

/* A trip as it is drawn, before the robot leaves. */
struct trip {
    struct jp_goal goal;
    struct skid_variation skid;
    struct variation balancer;
    uint64_t seed;
    double share;  /* of what the trip takes that is in the battery; 0: at the border */
    double error;  /* of the battery's estimate, deviations */
    double change; /* factor of the rolling resistance; 0: none */
    double when;   /* of the energy of the trip */
    bool can_change;
};

/* What a robot knows. */
struct knowledge {
    struct jp_learned_state state;
    struct jp_home_learned learned;
    struct jp_gyro_scale scale; /* of one that its sides steer */
    bool is_there;
};

struct drive {
    const struct navigate_robot *robot;
    struct navigation_skid *skid;
    const struct trip *trip;
    double expected; /* of the trip, J */
    bool has_changed;
};

struct outcome {
    unsigned trips; /* that ended at home, or without energy */
    unsigned border_returned;
    unsigned border_trips;
    unsigned new_returned; /* of robots on their first trip */
    unsigned new_trips;
    unsigned stranded;
    unsigned turned;
    unsigned needless;    /* turned back and would have made it */
    unsigned lost;        /* trips that failed otherwise */
    unsigned without_way; /* there and home */
    double errors[TRIPS]; /* of what trips at the border took against the return map, share */
};

struct bench {
    struct navigate_robot robot;
    size_t robots;
    struct outcome *outcomes;
};

/* ---- A trip ---- */

static void fill(void *context, struct navigation_battery *battery, double joules, double deviation)
{
    struct drive *drive = context;
    const struct trip *trip = drive->trip;
    double believed = trip->share * joules;

    drive->expected = joules;
    if (trip->share == 0) {
        for (int i = 0; i < 50; i++) {
            believed = joules + BORDER_QUANTILE * hypot(deviation, BATTERY_DEVIATION * believed);
        }
    }
    battery->deviation = BATTERY_DEVIATION * believed;
    battery->believed = believed;
    battery->joules = believed + trip->error * battery->deviation;
}

static void watch(void *context, const struct navigation_frame *frame)
{
    struct drive *drive = context;
    const struct trip *trip = drive->trip;

    if (trip->can_change && !drive->has_changed && trip->change > 0 && drive->expected > 0 &&
        frame->joules > trip->when * drive->expected) {
        drive->has_changed = true;
        drive->skid->world.plant.model.ground.rolling *= trip->change / trip->skid.rolling;
    }
}

/* False: the robot could not be switched on there. */
static bool drive_trip(const struct navigate_robot *robot, const struct dense_map *fresh, const struct trip *trip,
                       double confidence, struct knowledge *knowledge, struct navigation_result *result,
                       struct drive *drive)
{
    struct jp_home_learned learned = knowledge->is_there ? knowledge->learned : jp_home_learned_new;
    struct navigation_battery battery = {.joules = 1e9,
                                         .believed = 20000,
                                         .deviation = 1,
                                         .confidence = confidence,
                                         .learned = &learned,
                                         .leave = fill,
                                         .context = drive};
    struct navigation_task task = {.lattice = robot->lattice,
                                   .map = (struct jp_terrain *)&fresh->map,
                                   .world = &fresh->world,
                                   .solid = &fresh->world,
                                   .start = fresh->start,
                                   .goal = trip->goal,
                                   .view_m = VIEW * round(robot->lattice->resolution / 65.536) / 1000,
                                   .memory = MEMORY,
                                   .patience = PATIENCE,
                                   .seed = trip->seed,
                                   .battery = &battery,
                                   .watch = watch,
                                   .context = drive};
    const struct clearance_pose start = navigation_start(&task);
    struct navigation_skid *skid = calloc(1, sizeof *skid);
    struct navigation_balancer *balancer = calloc(1, sizeof *balancer);
    struct navigation_robot driven;
    const char *field;
    bool is_done;

    *drive = (struct drive){.robot = robot, .skid = skid, .trip = trip};
    if (robot->skid != NULL) {
        const struct skid_steer_model model = skid_varied(&robot->model, &trip->skid);

        is_done = navigation_skid_init_again(skid, robot->skid, &model, &fresh->world, NULL, &start, trip->seed,
                                             &knowledge->scale, &driven);
        if (is_done && knowledge->is_there) {
            (void)jp_skid_learner_restore(&skid->pilot.learner, &knowledge->state, &field);
        }
        is_done = is_done && navigation_run(&task, &driven, result);
        knowledge->state = skid->pilot.learner.state;
        knowledge->scale = navigation_skid_gyro_scale(skid);
    } else {
        struct robot_file file;

        variation_apply(&trip->balancer, &robot->file, &file);
        is_done = navigation_balancer_init(balancer, robot->entry, &file, &start, trip->seed, JP_PILOT_MOTORS, &driven);
        if (is_done && knowledge->is_there) {
            (void)jp_learner_restore(&balancer->pilot.learner, &knowledge->state, &field);
        }
        is_done = is_done && navigation_run(&task, &driven, result);
        knowledge->state = balancer->pilot.learner.state;
    }
    knowledge->learned = learned;
    knowledge->is_there = true;
    free(skid);
    free(balancer);
    return is_done;
}

/* ---- A robot ---- */

static bool draw_goal(struct random *random, const struct navigate_robot *robot, const struct dense_map *dense,
                      struct jp_goal *goal)
{
    struct jp_lattice_pose pose;

    do {
        if (!dense_map_place(random, robot->lattice, &dense->map, &pose)) {
            return false;
        }
    } while (3 * (abs(pose.x - dense->start.x) + abs(pose.y - dense->start.y)) < dense->map.config.width);
    *goal = (struct jp_goal){pose.x, pose.y, JP_ANY_HEADING};
    return true;
}

static void vary(struct random *random, const struct navigate_robot *robot, struct trip *trip)
{
    trip->skid = skid_random_variation(random);
    trip->balancer = variation_none;
    if (robot->skid == NULL) {
        variation_draw(random, &robot->file, &trip->balancer);
    }
}

static void draw_trip(struct random *random, const struct navigate_robot *robot, const struct dense_map *dense,
                      unsigned index, struct trip *trip)
{
    const bool is_another = random_uniform(random, 0, 1) < 0.25;

    if (index == 0 || is_another) {
        vary(random, robot, trip);
    }
    trip->goal = dense->goal;
    if (index > 0) {
        (void)draw_goal(random, robot, dense, &trip->goal);
    }
    trip->share = 0;
    trip->error = random_gaussian(random, 1);
    trip->change = random_uniform(random, 0, 1) < 1.0 / 3 ? random_uniform(random, 0.7, 1.5) : 0;
    trip->when = random_uniform(random, 0, 1);
    trip->can_change = robot->skid != NULL;
    trip->seed++;
}

/* The map as the robot had it before it saw what is in the world: each drive begins so. */
static bool with_fresh_map(const struct navigate_robot *robot, uint64_t seed, struct dense_map *dense)
{
    return dense_map_make(dense, robot->lattice, robot->hills_deg, seed);
}

static bool drive_fresh(const struct navigate_robot *robot, uint64_t map_seed, const struct trip *trip,
                        double confidence, struct knowledge *knowledge, struct navigation_result *result,
                        struct drive *drive)
{
    struct dense_map dense;
    const bool is_done = with_fresh_map(robot, map_seed, &dense) &&
                         drive_trip(robot, &dense, trip, confidence, knowledge, result, drive);

    dense_map_free(&dense);
    return is_done;
}

static bool has_come_home(const struct navigation_result *result)
{
    return result->home == JP_HOME_HOME;
}

static void at_border(const struct bench *bench, uint64_t seed, const struct trip *trip, unsigned index,
                      struct knowledge *knowledge, struct outcome *outcome)
{
    struct navigation_result result;
    struct drive drive;

    if (!drive_fresh(&bench->robot, seed, trip, 0, knowledge, &result, &drive)) {
        return;
    }
    if (drive.expected <= 0 || result.has_turned_back) {
        outcome->without_way++;
        return;
    }
    if (!has_come_home(&result) && !result.is_stranded) {
        outcome->lost++;
        return;
    }
    outcome->border_trips++;
    outcome->border_returned += has_come_home(&result);
    if (index == 0) {
        outcome->new_trips++;
        outcome->new_returned += has_come_home(&result);
    }
    if (has_come_home(&result)) {
        outcome->errors[index] = (result.given_joules - result.joules_at_leave) / drive.expected - 1;
    }
}

static void in_use(const struct bench *bench, uint64_t seed, const struct trip *trip, struct knowledge *knowledge,
                   struct outcome *outcome)
{
    struct knowledge before = *knowledge;
    struct navigation_result result;
    struct drive drive;

    if (!drive_fresh(&bench->robot, seed, trip, CONFIDENCE, knowledge, &result, &drive)) {
        return;
    }
    if (drive.expected <= 0) {
        outcome->without_way++;
        return;
    }
    if (!has_come_home(&result) && !result.is_stranded) {
        outcome->lost++;
        return;
    }
    outcome->trips++;
    outcome->stranded += result.is_stranded;
    if (result.has_turned_back) {
        struct navigation_result other;

        const bool is_driven = drive_fresh(&bench->robot, seed, trip, 0, &before, &other, &drive);
        const bool has_way = is_driven && !other.has_turned_back;

        outcome->turned += has_way;
        outcome->needless += has_way && has_come_home(&other);
    }
}

/* At the border, and then in use. */
static void bench_robot(void *context, size_t index)
{
    const struct bench *bench = context;
    const bool is_in_use = index >= bench->robots;
    const uint64_t seed = is_in_use ? USE_SEED + index - bench->robots : BORDER_SEED + index;
    struct knowledge known = {.is_there = false};
    struct trip trip = {.seed = 100 * seed};
    struct dense_map dense;
    struct random random;

    random_init(&random, seed);
    if (!with_fresh_map(&bench->robot, seed, &dense)) {
        return;
    }
    for (unsigned i = 0; i < TRIPS; i++) {
        draw_trip(&random, &bench->robot, &dense, i, &trip);
        if (is_in_use) {
            trip.share = random_uniform(&random, 0.5, 1.5);
            in_use(bench, seed, &trip, &known, &bench->outcomes[index]);
        } else {
            at_border(bench, seed, &trip, i, &known, &bench->outcomes[index]);
        }
    }
    dense_map_free(&dense);
}

/* ---- Figures ---- */

static double percent(unsigned part, unsigned whole)
{
    return whole == 0 ? 0 : 100.0 * part / whole;
}

static void add(json_t *figures, const char *name, const char *what, double value, const char *unit,
                struct figure_bar bar)
{
    figures_add(figures, COMMAND, value, unit, bar, "home, %s: %s", name, what);
}

static void bench_kind(json_t *figures, const struct kind *kind)
{
    static struct outcome outcomes[2 * ROBOTS_MAX];
    static struct bench bench;
    static double errors[ROBOTS_MAX * TRIPS];
    const char *const name = kind->name;
    struct outcome sum = {0};
    size_t error_count = 0;

    memset(outcomes, 0, sizeof outcomes);
    bench.outcomes = outcomes;
    bench.robots = kind->robots;
    if (!navigate_robot_load(&bench.robot, name)) {
        exit(ERROR_EXIT);
    }
    in_parallel(name, bench_robot, &bench, 2 * kind->robots);
    for (size_t i = 0; i < 2 * kind->robots; i++) {
        sum.trips += outcomes[i].trips;
        sum.border_trips += outcomes[i].border_trips;
        sum.border_returned += outcomes[i].border_returned;
        sum.new_trips += outcomes[i].new_trips;
        sum.new_returned += outcomes[i].new_returned;
        sum.stranded += outcomes[i].stranded;
        sum.turned += outcomes[i].turned;
        sum.needless += outcomes[i].needless;
        sum.lost += outcomes[i].lost;
        sum.without_way += outcomes[i].without_way;
        for (size_t j = 0; j < TRIPS; j++) {
            if (outcomes[i].errors[j] != 0) {
                errors[error_count] = 100 * fabs(outcomes[i].errors[j]);
                error_count++;
            }
        }
    }
    add(figures, name, "trips at the border of the 95 % return map", sum.border_trips, "", no_bar);
    add(figures, name, "of them returned, at least", percent(sum.border_returned, sum.border_trips), "%", at_least(93));
    add(figures, name, "of them returned, at most", percent(sum.border_returned, sum.border_trips), "%", at_most(97));
    add(figures, name, "first trips of robots at the border: returned", percent(sum.new_returned, sum.new_trips), "%",
        no_bar);
    add(figures, name, "energy of trips at the border that were driven to their ends, against the return map, median",
        median(errors, error_count), "%", no_bar);
    add(figures, name, "trips in use", sum.trips, "", no_bar);
    add(figures, name, "stranded", sum.stranded, "", equal_to(0));
    add(figures, name, "turned back", percent(sum.turned, sum.trips), "%", no_bar);
    add(figures, name, "turned back and would have made it", percent(sum.needless, sum.trips), "%", at_most(5));
    add(figures, name, "trips that ended elsewhere with energy left", sum.lost, "", no_bar);
    add(figures, name, "trips drawn to goals without a way there and home", sum.without_way, "", no_bar);
}

/* All kinds, or the one that is named. */
int main(int argc, char **argv)
{
    json_t *figures = json_array();

    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (argc < 2 || strcmp(argv[1], kinds[i].name) == 0) {
            bench_kind(figures, &kinds[i]);
        }
    }
    figures_print(figures);
    return 0;
}
