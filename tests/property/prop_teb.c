/*
 * joulepath/teb.h over random tasks: limits, cycle after cycle along the way, equal bits, and how far from the least
 * cost that a general optimiser finds for the same band.
 *
 * prop_teb [--count N] [--seed S] [--json FILE]
 * --count is the number of tasks.
 */
#include <joulepath/patrol.h>
#include <joulepath/tables.h>

#include <math.h>
#include <nlopt.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/teb_formulas.h"
#include "unity.h"

#define PERIOD 0.1 /* of a cycle, s */

/* Least distance of obstacles, m: from the path half the robot's width, the clearance wanted and what it cuts in bends;
 * from where it stands its corners. */
#define ROOM       0.45
#define START_ROOM 0.65

/* Within this time the band's steps must keep the limits, which are soft, to these bars: beyond what is allowed. */
#define FORESIGHT     1.5 /* s */
#define SPEED_BAR     0.2 /* of the greatest */
#define TURN_RATE_BAR 0.1 /* of the greatest */
#define RADIUS_BAR    0.1 /* m/s that a step is too slow for its turn */

/* From cycle to cycle, once the new band has settled. */
#define SETTLING     4   /* cycles */
#define JUMP_BAR     4.0 /* of the cost; a new band costs a hundred */
#define DURATION_BAR 0.4 /* of the time to the goal, s */

/* Of bands in free space against the general optimiser, after so many cycles at one place. */
#define STANDING_CYCLES 10
#define EXCESS_BAR      0.25
#define SHARE_BAR       0.75 /* of the bands cost no more than that; the others had just got a pose more or less */

/* Tasks that end before the goal: what looked passable is not. */
#define STOPPED_BAR 0.03

enum { PATH_POINTS = 40, CYCLES = 30, SMALL_POSES_MAX = 16, UNKNOWNS_MAX = JP_TEB_BLOCK * SMALL_POSES_MAX };

static struct jp_teb teb;
static struct jp_obstacles obstacles;
static struct jp_point path[PATH_POINTS];
static struct jp_teb_task task;
static struct jp_teb_result result;

static struct options options = {.count = 30, .seed = 1};
static struct {
    double speed;
    double turn_rate;
    double radius;
    double jump;
    double duration;
    double share;
    unsigned long stopped;
} worst;

void setUp(void)
{
}

void tearDown(void)
{
}

static void init(void)
{
    const struct jp_plane_point centre = {0.0f, 0.0f};
    const char *field = NULL;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_teb_init(&teb, &jp_patrol_config_patrol.teb, &field));
    jp_obstacles_clear(&obstacles, &centre);
}

/* A way that bends now and then, of `length`. */
static void random_path(double length)
{
    const double spacing = length / (PATH_POINTS - 1);
    const double bend = uniform(-0.8, 0.8);
    const double phase = uniform(0, 6);
    double x = 0;
    double y = 0;
    double heading = uniform(-3, 3);

    task = (struct jp_teb_task){.path = path, .path_count = PATH_POINTS};
    task.start = (struct jp_plane_pose){(float)uniform(-0.05, 0.05), (float)uniform(-0.05, 0.05),
                                        (float)(heading + uniform(-0.3, 0.3))};
    for (int i = 0; i < PATH_POINTS; i++) {
        path[i] = (struct jp_point){(jp_q16)lround(x * JP_Q16_ONE), (jp_q16)lround(y * JP_Q16_ONE)};
        task.goal = (struct jp_plane_pose){(float)x, (float)y, (float)remainder(heading, 2 * EXACT_PI)};
        x += spacing * cos(heading);
        y += spacing * sin(heading);
        heading += spacing * bend * sin(i * spacing + phase);
    }
    task.speed = (struct jp_plane_speed){(float)uniform(0, 1), (float)uniform(-0.3, 0.3)};
}

static double distance_from_path(double x, double y)
{
    double least = INFINITY;

    for (int i = 0; i < PATH_POINTS; i++) {
        least = fmin(least, hypot((double)path[i].x / JP_Q16_ONE - x, (double)path[i].y / JP_Q16_ONE - y));
    }
    return least;
}

/* Discs that leave room to pass, as those do which a path was planned around. */
static void random_obstacles(void)
{
    for (int i = 0; i < 30; i++) {
        const struct jp_point *const at = &path[(int)uniform(0, PATH_POINTS)];
        const double radius = uniform(0.02, 0.15);
        const double x = (double)at->x / JP_Q16_ONE + uniform(-1.5, 1.5);
        const double y = (double)at->y / JP_Q16_ONE + uniform(-1.5, 1.5);
        const struct jp_obstacle disc = {
            .vertices = {{(float)x, (float)y}}, .vertex_count = 1, .radius = (float)radius};

        if (distance_from_path(x, y) > ROOM + radius && hypot(x, y) > START_ROOM + radius) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&obstacles, &disc));
        }
    }
}

static enum jp_status plan(void)
{
    return jp_teb_plan(&teb, &task, &obstacles, &result);
}

/* The robot drives as it was told until the next cycle. */
static void drive(void)
{
    const double turn = (double)result.speed.turn_rate * PERIOD;
    const double heading = (double)task.start.heading + turn / 2;

    task.start.x += (float)((double)result.speed.forward * PERIOD * cos(heading));
    task.start.y += (float)((double)result.speed.forward * PERIOD * sin(heading));
    task.start.heading = (float)remainder((double)task.start.heading + turn, 2 * EXACT_PI);
    task.speed = result.speed;
}

static double way_left(void)
{
    return hypot((double)(task.goal.x - task.start.x), (double)(task.goal.y - task.start.y));
}

static void random_task(double shortest, double longest)
{
    init();
    random_path(uniform(shortest, longest));
}

/* ---- Limits, and cycle after cycle ---- */

static void measure_step(const struct jp_teb_pose *from, const struct jp_teb_pose *to)
{
    const struct jp_teb_config *const config = &teb.config;
    const double dx = (double)(to->pose.x - from->pose.x);
    const double dy = (double)(to->pose.y - from->pose.y);
    const double c = ((double)from->cosine + (double)to->cosine) / 2;
    const double s = ((double)from->sine + (double)to->sine) / 2;
    const double speed = (c * dx + s * dy) / (double)from->interval;
    const double turn = remainder((double)(to->pose.heading - from->pose.heading), 2 * EXACT_PI);
    const double turn_rate = fabs(turn) / (double)from->interval;

    worst.speed = fmax(worst.speed, speed / (double)config->speed_max - 1);
    worst.turn_rate = fmax(worst.turn_rate, turn_rate / (double)config->turn_rate_max - 1);
    worst.radius = fmax(worst.radius, turn_rate * (double)config->radius_min - fabs(speed));
}

static void measure_band(void)
{
    double time = 0;

    for (unsigned i = 0; i + 1U < teb.count && time < FORESIGHT; i++) {
        measure_step(&teb.poses[i], &teb.poses[i + 1U]);
        time += (double)teb.poses[i].interval;
    }
}

static void assert_speed_within_limits(void)
{
    const struct jp_teb_config *const config = &teb.config;
    const float turn_rate = fabsf(result.speed.turn_rate);

    TEST_ASSERT_TRUE(result.speed.forward >= 0 && result.speed.forward <= config->speed_max);
    TEST_ASSERT_TRUE(turn_rate <= config->turn_rate_max);
    TEST_ASSERT_TRUE(turn_rate * config->radius_min <= result.speed.forward + 1e-5f);
}

static void drive_task(void)
{
    double cost = INFINITY;
    double duration = INFINITY;

    for (int cycle = 0; cycle < CYCLES && way_left() > 0.3; cycle++) {
        if (plan() != JP_OK) {
            TEST_ASSERT_TRUE(result.speed.forward == 0 && result.speed.turn_rate == 0);
            worst.stopped++;
            return;
        }
        assert_speed_within_limits();
        measure_band();
        if (cycle >= SETTLING) {
            worst.jump = fmax(worst.jump, (double)result.cost - cost);
            worst.duration = fmax(worst.duration, (double)result.duration - duration);
        }
        cost = (double)result.cost;
        duration = (double)result.duration;
        drive();
    }
}

static void test_cycle_after_cycle_keeps_limits_and_gets_on(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        random_task(2, 14);
        random_obstacles();
        drive_task();
    }
    printf("speed %+.3f, turn rate %+.3f, radius %.4f m/s; cost %+.3f, duration %+.3f s\n", worst.speed,
           worst.turn_rate, worst.radius, worst.jump, worst.duration);
    TEST_ASSERT_TRUE(worst.speed <= SPEED_BAR);
    TEST_ASSERT_TRUE(worst.turn_rate <= TURN_RATE_BAR);
    TEST_ASSERT_TRUE(worst.radius <= RADIUS_BAR);
    TEST_ASSERT_TRUE(worst.jump <= JUMP_BAR);
    TEST_ASSERT_TRUE(worst.duration <= DURATION_BAR);
    TEST_ASSERT_TRUE((double)worst.stopped <= STOPPED_BAR * (double)options.count);
}

/* ---- Equal bits ---- */

static void plan_cycles(struct jp_teb_pose *poses, struct jp_teb_result *last)
{
    const struct jp_teb_task first = task;

    init();
    random_obstacles();
    for (int cycle = 0; cycle < 4; cycle++) {
        (void)plan();
        drive();
    }
    memcpy(poses, teb.poses, sizeof teb.poses);
    *last = result;
    task = first;
}

static void test_the_same_task_has_the_same_bits(void)
{
    static struct jp_teb_pose once[JP_TEB_POSES_MAX];
    static struct jp_teb_pose again[JP_TEB_POSES_MAX];
    struct jp_teb_result results[2];

    for (unsigned long i = 0; i < options.count / 4 + 1; i++) {
        random_task(2, 14);

        const uint64_t before = random_state;

        plan_cycles(once, &results[0]);
        memset(&teb, 0x5A, sizeof teb);
        random_state = before;
        plan_cycles(again, &results[1]);
        TEST_ASSERT_EQUAL_INT(0, memcmp(&results[0].speed, &results[1].speed, sizeof results[0].speed));
        TEST_ASSERT_EQUAL_INT(0, memcmp(&results[0].cost, &results[1].cost, sizeof results[0].cost));
        TEST_ASSERT_EQUAL_INT(0, memcmp(once, again, teb.count * sizeof once[0]));
    }
}

/* ---- An optimiser that knows nothing of bands ---- */

/* What may move: all but start and goal; and every interval. */
static unsigned unknowns(double *x, double *low)
{
    const double least = 0.1 * (double)teb.config.interval;
    unsigned n = 0;

    for (unsigned i = 0; i + 1U < teb.count; i++) {
        const struct jp_teb_pose *const pose = &teb.poses[i];

        low[n] = least;
        x[n++] = (double)pose->interval;
        if (i > 0U) {
            const double position[] = {(double)pose->pose.x, (double)pose->pose.y, (double)pose->pose.heading};

            for (int k = 0; k < 3; k++) {
                low[n] = -HUGE_VAL;
                x[n++] = position[k];
            }
        }
    }
    return n;
}

static double cost_of(const double *x)
{
    struct exact_pose poses[SMALL_POSES_MAX];

    for (unsigned i = 0; i < teb.count; i++) {
        const struct jp_plane_pose *const at = &teb.poses[i].pose;
        struct exact_pose *const pose = &poses[i];

        *pose = (struct exact_pose){(double)at->x, (double)at->y, (double)at->heading, .interval = 0};
        if (i + 1U < teb.count) {
            pose->interval = *x++;
            if (i > 0U) {
                pose->x = *x++;
                pose->y = *x++;
                pose->heading = *x++;
            }
        }
        pose->cosine = cos(pose->heading);
        pose->sine = sin(pose->heading);
    }
    return exact_cost(&teb, poses);
}

static double objective(unsigned n, const double *x, double *gradient, void *data)
{
    const double way = 1e-6;
    double point[UNKNOWNS_MAX];

    (void)data;
    memcpy(point, x, n * sizeof x[0]);
    for (unsigned i = 0; gradient != NULL && i < n; i++) {
        point[i] = x[i] + way;
        gradient[i] = cost_of(point);
        point[i] = x[i] - way;
        gradient[i] = (gradient[i] - cost_of(point)) / (2 * way);
        point[i] = x[i];
    }
    return cost_of(x);
}

/* x is where it begins and ends. */
static double minimise(nlopt_algorithm algorithm, unsigned n, const double *low, double *x)
{
    nlopt_opt optimiser = nlopt_create(algorithm, n);
    double cost = 0;

    (void)nlopt_set_lower_bounds(optimiser, low);
    (void)nlopt_set_min_objective(optimiser, objective, NULL);
    (void)nlopt_set_maxeval(optimiser, 3000);
    (void)nlopt_set_ftol_rel(optimiser, 1e-10);
    /* Where it says that it failed it could not get lower. */
    (void)nlopt_optimize(optimiser, x, &cost);
    nlopt_destroy(optimiser);
    return cost_of(x);
}

/* The least of several ways from the band and from places near it. */
static double least_cost(unsigned n, const double *low, const double *from)
{
    static const nlopt_algorithm algorithms[] = {NLOPT_LD_LBFGS, NLOPT_LD_SLSQP, NLOPT_LN_SBPLX};
    double least = HUGE_VAL;

    for (unsigned run = 0; run < 6; run++) {
        const double scatter = run < 3 ? 0 : 0.03;
        double x[UNKNOWNS_MAX];

        for (unsigned i = 0; i < n; i++) {
            x[i] = fmax(from[i] + uniform(-scatter, scatter), low[i]);
        }
        least = fmin(least, minimise(algorithms[run % 3], n, low, x));
    }
    return least;
}

/* How much more than the least the band costs, as a share. */
static double excess(void)
{
    double x[UNKNOWNS_MAX];
    double low[UNKNOWNS_MAX];
    const unsigned n = unknowns(x, low);
    const double cost = cost_of(x);

    TEST_ASSERT_TRUE(fabs(cost - (double)result.cost) <= 1e-3 * (1 + cost));
    return cost / least_cost(n, low, x) - 1;
}

static void test_bands_cost_little_more_than_the_least(void)
{
    unsigned long good = 0;

    for (unsigned long i = 0; i < options.count; i++) {
        random_task(0.5, 1.2);
        for (int cycle = 0; cycle < STANDING_CYCLES; cycle++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, plan());
        }
        TEST_ASSERT_TRUE(teb.count <= SMALL_POSES_MAX);
        good += excess() <= EXCESS_BAR ? 1 : 0;
    }
    worst.share = (double)good / (double)options.count;
    printf("%.2f %% of the bands cost at most %g %% more than the least\n", 100 * worst.share, 100 * EXCESS_BAR);
    TEST_ASSERT_TRUE(worst.share >= SHARE_BAR);
}

/* ---- Figures ---- */

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", 100 * worst.share, "%", at_least(100 * SHARE_BAR),
                "TEB: short bands that cost at most 25 %% more than the least that NLopt finds");
    figures_add(figures, "make figures", 100 * worst.speed, "%", at_most(100 * SPEED_BAR),
                "TEB: largest speed of a step above the limit");
    figures_add(figures, "make figures", 100 * worst.turn_rate, "%", at_most(100 * TURN_RATE_BAR),
                "TEB: largest turn rate of a step above the limit");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    begin_random(options.seed, 0);
    return RUN_PROPERTY(options, add_figures);
}
