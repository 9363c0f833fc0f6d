/*
 * joulepath/teb.h over random tasks: limits, cycle after cycle along the way, equal bits, and how far from the least cost
 * that a general optimiser finds for the same band.
 *
 * prop_teb [--count N] [--seed S] [--json FILE]
 * --count is the number of tasks.
 */
#include <joulepath/teb.h>

#include <math.h>
#include <nlopt.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "options.h"
#include "sim/patrol_band.h"
#include "sim/random.h"
#include "tests/float/teb_formulas.h"
#include "unity.h"

#define PERIOD 0.1 /* of a cycle, s */

enum { PATH_POINTS = 40, CYCLES = 30 };

static unsigned long count = 100;
static uint64_t seed = 1;
static struct random rng;

static struct jp_teb teb;
static struct jp_obstacles obstacles;
static struct jp_path_point path[PATH_POINTS];
static struct jp_teb_task task;
static struct jp_teb_result result;

static struct {
    double speed;
    double turn_rate;
    double radius;
    double jump;
    double excess;
} worst;

void setUp(void)
{
}

void tearDown(void)
{
}

static double uniform(double low, double high)
{
    return random_uniform(&rng, low, high);
}

static void init(void)
{
    const struct jp_footprint footprint = {0.4f, 0.4f, 0.3f};
    const struct jp_teb_config config = patrol_band_config(&footprint, 0.5f, 1.0f);
    const struct jp_plane_point centre = {0.0f, 0.0f};
    const char *field = NULL;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_teb_init(&teb, &config, &field));
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
        path[i] = (struct jp_path_point){(jp_q16)lround(x * JP_Q16_ONE), (jp_q16)lround(y * JP_Q16_ONE)};
        task.goal = (struct jp_plane_pose){(float)x, (float)y, (float)remainder(heading, 2 * EXACT_PI)};
        x += spacing * cos(heading);
        y += spacing * sin(heading);
        heading += spacing * bend * sin(i * spacing + phase);
    }
    task.speed = (struct jp_plane_speed){(float)uniform(0, 1), (float)uniform(-0.3, 0.3)};
}

/* Discs beside the path, which leave room to pass. */
static void random_obstacles(void)
{
    for (int i = 0; i < 12; i++) {
        const struct jp_path_point *const at = &path[(int)uniform(0, PATH_POINTS)];
        const double radius = uniform(0.02, 0.15);
        const double away = uniform(0.4, 1.2) + radius;
        const double direction = uniform(0, 2 * EXACT_PI);
        const struct jp_obstacle disc = {
            .vertices = {{(float)((double)at->x / JP_Q16_ONE + away * cos(direction)),
                          (float)((double)at->y / JP_Q16_ONE + away * sin(direction))}},
            .vertex_count = 1,
            .radius = (float)radius,
        };

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&obstacles, &disc));
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

static double left(void)
{
    return hypot((double)(task.goal.x - task.start.x), (double)(task.goal.y - task.start.y));
}
/* ---- An optimiser that knows nothing of bands ---- */

enum { SMALL_POSES_MAX = 9 };

static void poses_of(const double *x, struct exact_pose *poses)
{
    for (unsigned i = 0; i < teb.count; i++) {
        const struct jp_teb_pose *const fixed = &teb.poses[i];
        const bool is_end = i == 0U || i + 1U == teb.count;
        struct exact_pose *const pose = &poses[i];

        *pose = (struct exact_pose){(double)fixed->pose.x, (double)fixed->pose.y, (double)fixed->pose.heading, .interval = 1};
        if (!is_end) {
            pose->x = *x++;
            pose->y = *x++;
            pose->heading = *x++;
        }
        if (i + 1U < teb.count) {
            pose->interval = *x++;
        }
        pose->cosine = cos(pose->heading);
        pose->sine = sin(pose->heading);
    }
}

static unsigned unknowns_of(double *x)
{
    double *next = x;

    for (unsigned i = 0; i + 1U < teb.count; i++) {
        if (i > 0U) {
            *next++ = (double)teb.poses[i].pose.x;
            *next++ = (double)teb.poses[i].pose.y;
            *next++ = (double)teb.poses[i].pose.heading;
        }
        *next++ = (double)teb.poses[i].interval;
    }
    return (unsigned)(next - x);
}

static double band_cost(unsigned n, const double *x, double *gradient, void *data)
{
    struct exact_pose poses[SMALL_POSES_MAX];
    double point[4 * SMALL_POSES_MAX];
    (void)data;
    memcpy(point, x, n * sizeof x[0]);
    for (unsigned i = 0; gradient != NULL && i < n; i++) {
        double costs[2];
        for (int side = 0; side < 2; side++) {
            point[i] = x[i] + (side == 0 ? -1e-6 : 1e-6);
            poses_of(point, poses);
            costs[side] = exact_cost(&teb, poses);
        }
        point[i] = x[i];
        gradient[i] = (costs[1] - costs[0]) / 2e-6;
    }
    poses_of(point, poses);
    return exact_cost(&teb, poses);
}

static double least_cost(const double *from, unsigned n)
{
    double x[4 * SMALL_POSES_MAX];
    double cost = 0;
    double best = INFINITY;
    static const nlopt_algorithm algorithms[] = {NLOPT_LD_LBFGS, NLOPT_LD_SLSQP, NLOPT_LN_SBPLX};
    for (int run = 0; run < 9; run++) {
        double low[4 * SMALL_POSES_MAX];
        nlopt_opt optimiser = nlopt_create(algorithms[run % 3], n);
        for (unsigned i = 0; i < n; i++) {
            x[i] = from[i] + (run < 3 ? 0 : uniform(-0.03, 0.03));
            low[i] = -100;
            if ((i % 4)==0) { low[i] = 0.025; if(x[i]<low[i])x[i]=low[i]; }
        }
        (void)nlopt_set_lower_bounds(optimiser, low);
        (void)nlopt_set_min_objective(optimiser, band_cost, NULL);
        (void)nlopt_set_maxeval(optimiser, 3000);
        (void)nlopt_set_ftol_rel(optimiser, 1e-10);
        (void)nlopt_optimize(optimiser, x, &cost);
        nlopt_destroy(optimiser);
        best = fmin(best, band_cost(n, x, NULL, NULL));
    }
    return best;
}
