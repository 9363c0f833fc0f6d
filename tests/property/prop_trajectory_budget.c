/*
 * Trajectories within a budget on random routes of both robots, also with less voltage than theirs, against all cruises
 * of a fine grid: what is returned keeps the budget, by set-points counted one by one, and no cruise of the grid that
 * keeps it is better by more than a tolerance. Where nothing is returned, none of the grid needs less by more than
 * that.
 *
 * prop_trajectory_budget [--count N] [--seed S] [--verbose]
 * --count is the number of routes.
 */
#include <joulepath/trajectory_budget.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/options.h"
#include "tests/support/random_route.h"
#include "unity.h"

/* As a share of the energy or time of the grid's best. */
#define TOLERANCE 0.001

/* Where the robot slows down to turn or stop, energy and time jump from a cruise to the next, and the best may be in a
 * gap between the cruises that are tried: in at most this share of the routes. */
#define MISSED 0.02

enum { LEGS = 6, GRID = 300 };

struct figures {
    double seconds; /* infinite where the rule finds no trajectory */
    double joules;
};

static struct jp_trajectory_config config;
static struct jp_point targets[LEGS];
static struct jp_trajectory_leg legs[LEGS];
static struct jp_trajectory trajectory;
static struct jp_trajectory_budget_config asked;
static struct jp_trajectory_budget budget;
static const struct route_robot *robot;
static struct figures grid[GRID];

static struct {
    unsigned long kept;
    unsigned long infeasible;
    unsigned long missed;
    double worse;  /* than the grid's best, as a share */
    double needed; /* what is said to be needed, beyond what the grid needs */
} seen;

static struct options options = {.count = 200, .seed = 1};

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- Random requests ---- */

static void draw_targets(void)
{
    struct route_end end = {.direction = uniform(-0.5, 0.5)};

    for (unsigned i = 0; i < LEGS; i++) {
        const double length = log_uniform(0.4, 15);

        targets[i] = add_leg(&end, length, uniform(-0.4, 0.4));
    }
}

static void draw(void)
{
    const bool moves = random_word() % 3 == 0;

    robot = draw_robot();
    config = robot->config->trajectory;
    if (random_word() % 3 == 0) {
        config.voltage = to_q16(q16(config.volts[0]) * uniform(0.5, 1.5)); /* of that for 1 m/s */
    }
    draw_targets();
    asked = (struct jp_trajectory_budget_config){
        .task = {.config = &config,
                 .cruise = to_q24(uniform(0.3, 1.2)),
                 .motion = {.speed = moves ? to_q24(uniform(0, 0.6)) : 0},
                 .targets = targets,
                 .count = (uint16_t)(1 + random_word() % LEGS),
                 .to_stand = random_word() % 2 == 0},
        .model = robot->model,
        .kind = random_word() % 2 == 0 ? JP_BUDGET_SECONDS : JP_BUDGET_JOULES,
        .legs = legs,
        .trajectory = &trajectory,
    };
}

/* ---- The grid ---- */

static double grid_cruise(unsigned k)
{
    const double least = fmin(q24(jp_cruise_speed(robot->model)), q24(asked.task.cruise)) / 5;

    return least + (q24(asked.task.cruise) - least) * k / (GRID - 1);
}

static double set_points_of(const struct jp_trajectory *of)
{
    double sum = 0;

    for (unsigned i = 0; i < of->count; i++) {
        sum += (double)of->legs[i].begin.set_points + of->legs[i].middle.set_points + of->legs[i].end.set_points;
    }
    return sum;
}

static struct figures figures_with(double cruise)
{
    struct jp_trajectory_task task = asked.task;
    jp_q16 energy;

    task.cruise = to_q24(cruise);
    if (jp_trajectory_by_rule(&task, legs, &trajectory) != JP_OK ||
        jp_trajectory_energy(&config, robot->model, &trajectory, &energy) != JP_OK) {
        return (struct figures){INFINITY, INFINITY};
    }
    return (struct figures){set_points_of(&trajectory) * JP_TICKS_PER_SET_POINT / config.tick_rate, q16(energy)};
}

static double limited(const struct figures *of)
{
    return asked.kind == JP_BUDGET_SECONDS ? of->seconds : of->joules;
}

static double wanted(const struct figures *of)
{
    return asked.kind == JP_BUDGET_SECONDS ? of->joules : of->seconds;
}

static double least_limited(void)
{
    double least = INFINITY;

    for (unsigned k = 0; k < GRID; k++) {
        least = fmin(least, limited(&grid[k]));
    }
    return least;
}

static double best_wanted(double limit)
{
    double best = INFINITY;

    for (unsigned k = 0; k < GRID; k++) {
        best = limited(&grid[k]) <= limit ? fmin(best, wanted(&grid[k])) : best;
    }
    return best;
}

/* Some budgets are too small, some do for every cruise; most bind. */
static bool choose_limit(void)
{
    double greatest = 0;

    for (unsigned k = 0; k < GRID; k++) {
        grid[k] = figures_with(grid_cruise(k));
        greatest = isfinite(limited(&grid[k])) ? fmax(greatest, limited(&grid[k])) : greatest;
    }
    asked.limit =
        to_q16(isfinite(least_limited()) ? least_limited() + (greatest - least_limited()) * uniform(-0.05, 1) : 10);
    return asked.limit > 0;
}

/* ---- The search ---- */

/* Set-points driven one by one. */
static double driven_seconds(void)
{
    struct jp_trajectory_drive drive;
    struct jp_set_point point;
    double set_points = 0;

    jp_trajectory_begin(&drive, &trajectory);
    while (jp_trajectory_advance(&drive, &config, &point)) {
        set_points++;
    }
    return set_points * JP_TICKS_PER_SET_POINT / config.tick_rate;
}

static enum jp_status search(void)
{
    enum jp_status status = jp_trajectory_budget_start(&budget, &asked);

    TEST_ASSERT_EQUAL_INT(JP_OK, status);
    for (unsigned i = 0; i < JP_BUDGET_SLICES; i++) {
        status = jp_trajectory_budget_work(&budget);
        TEST_ASSERT_TRUE(status != JP_WORKING || i + 1 < JP_BUDGET_SLICES);
    }
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_trajectory_budget_work(&budget));
    return status;
}

static void note(double worse, double *worst)
{
    *worst = fmax(*worst, worse);
    seen.missed += worse > TOLERANCE ? 1 : 0;
}

/* The trajectory is what the figures say, and keeps the budget. */
static bool check_kept(void)
{
    const struct figures found = {driven_seconds(), q16(budget.best.energy)};
    const double best = best_wanted(q16(asked.limit));
    jp_q16 energy = 0;

    (void)jp_trajectory_energy(&config, robot->model, &trajectory, &energy);
    seen.kept++;
    note(isfinite(best) ? wanted(&found) / best - 1 : -1, &seen.worse);
    return energy == budget.best.energy && fabs(found.seconds - q16(budget.best.seconds)) < 2e-5 &&
           limited(&found) <= q16(asked.limit) && budget.best.cruise <= asked.task.cruise;
}

/* What is said to be needed is more than the budget. */
static bool check_infeasible(void)
{
    const struct figures needed = {q16(budget.best.seconds), q16(budget.best.energy)};
    const double least = least_limited();

    seen.infeasible++;
    note(isfinite(least) ? limited(&needed) / least - 1 : -1, &seen.needed);
    return limited(&needed) > q16(asked.limit);
}

static bool try_route(unsigned long index)
{
    enum jp_status status;
    bool good = true;

    draw();
    if (!choose_limit()) {
        return true;
    }
    status = search();
    if (status == JP_OK) {
        good = check_kept();
    } else {
        good = status == JP_ERR_INFEASIBLE && check_infeasible();
    }
    if (options.verbose || !good) {
        printf(
            "case %lu: %s, %u legs, %.2f V, cruise up to %.3f m/s, within %.3f %s: status %d, cruise %.4f m/s, %.3f s, "
            "%.3f J; of the grid %.3f %s\n",
            index, robot->name, asked.task.count, q16(config.voltage), q24(asked.task.cruise), q16(asked.limit),
            asked.kind == JP_BUDGET_SECONDS ? "s" : "J", (int)status, q24(budget.best.cruise), q16(budget.best.seconds),
            q16(budget.best.energy), status == JP_OK ? best_wanted(q16(asked.limit)) : least_limited(),
            (asked.kind == JP_BUDGET_SECONDS) == (status == JP_OK) ? "J" : "s");
    }
    return good;
}

static void test_random_requests(void)
{
    unsigned long bad = 0;

    random_state = options.seed;
    seen.worse = seen.needed = -1;
    for (unsigned long k = 0; k < options.count; k++) {
        bad += try_route(k) ? 0 : 1;
    }
    printf("%lu routes, %lu bad; %lu keep the budget, at worst %.4f %% above the grid's best; %lu cannot, and need at "
           "worst %.4f %% more than the grid; %lu are above by more than %g %%\n",
           options.count, bad, seen.kept, 100 * seen.worse, seen.infeasible, 100 * seen.needed, seen.missed,
           100 * TOLERANCE);
    TEST_ASSERT_EQUAL_UINT32(0, bad);
    TEST_ASSERT_TRUE((double)seen.missed <= MISSED * (double)options.count);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
