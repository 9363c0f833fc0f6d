/*
 * Headings and speeds found for random routes of both robots, also with less voltage than theirs, with passages that
 * are given, from a stand or in motion, over all legs or the first of them. The rule plans with what is found, and what
 * is given stays; by the energy and the time of that plan, in integers, no route costs more than with the rule's own
 * passages, and a compass search over headings and speeds, which knows no derivative, finds nothing better, but for a
 * tolerance. Where nothing is found the rule finds nothing either, or the passages are as they were.
 *
 * prop_trajectory_optimiser [--count N] [--seed S] [--verbose]
 * --count is the number of routes.
 */
#include <joulepath/trajectory_optimiser.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/options.h"
#include "tests/support/random_route.h"
#include "unity.h"

/* As a share of the cost of the rule's own passages: a plan ends its legs at whole set-points. */
#define WORSE 2e-4

/* What the compass may find beyond that, in the mean: with the robots' own voltage, and with little, with which the
 * cost jumps where legs become slower. */
#define LEFT      2e-4
#define LEFT_WEAK 5e-3

#define ROUNDS 10

enum { LEGS = 6 };

static struct jp_trajectory_config config;
static struct jp_point targets[LEGS];
static struct jp_passage given[LEGS];
static struct jp_passage found[LEGS];
static struct jp_optimiser_place places[LEGS];
static struct jp_trajectory_optimiser_config asked;
static struct jp_trajectory_optimiser optimiser;
static const struct route_robot *robot;
static bool is_weak;

static struct {
    unsigned long ok;
    unsigned long unchanged; /* of these: nothing is better than the rule's own */
    unsigned long infeasible;
    unsigned long no_plan;
    unsigned long compared[2]; /* of robots as they are, and weak ones */
    double saved[2];           /* sums of shares of the cost */
    double left[2];
    double worse; /* the most */
} seen;

static struct options options = {.count = 300, .seed = 14};

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- Random routes ---- */

static double draw_turn(void)
{
    switch (random_word() % 12) {
    case 0:
        return 0;
    case 1:
        return 0.5;
    default:
        return uniform(-0.4, 0.4);
    }
}

static void draw_targets(void)
{
    struct route_end end = {.direction = uniform(-0.5, 0.5)};

    for (unsigned i = 0; i < LEGS; i++) {
        const double length = log_uniform(0.6, 15);

        targets[i] = add_leg(&end, length, draw_turn());
        given[i] = (struct jp_passage){.given = random_word() % 4 == 0 ? (uint8_t)(random_word() % 4) : 0,
                                       .heading = (jp_angle)((end.direction + uniform(-0.1, 0.1)) * 4294967296.0),
                                       .speed = to_q24(uniform(0.2, 0.5))};
    }
}

static void draw(void)
{
    const bool moves = random_word() % 4 == 0;

    robot = draw_robot();
    config = robot->config->trajectory;
    is_weak = random_word() % 3 == 0;
    if (is_weak) {
        config.voltage = to_q16(q16(config.volts[0]) * uniform(0.5, 1.5)); /* of that for 1 m/s */
    }
    draw_targets();
    asked = (struct jp_trajectory_optimiser_config){
        .task = {.config = &config,
                 .cruise = random_word() % 2 == 0 ? jp_cruise_speed(robot->model) : to_q24(uniform(0.2, 0.9)),
                 .motion = {.speed = moves ? to_q24(uniform(0.1, 0.6)) : 0},
                 .targets = targets,
                 .passages = random_word() % 2 == 0 ? given : NULL,
                 .count = (uint16_t)(1 + random_word() % LEGS),
                 .to_stand = random_word() % 2 == 0},
        .model = robot->model,
        .goes_on = moves && random_word() % 2 == 0,
        .passages = found,
        .places = places,
        .place_count = (uint16_t)(random_word() % 4 == 0 ? 3 : LEGS),
    };
}

/* ---- What the rule's plan costs ---- */

/* Energy, and the price of time at which the cruise is the best speed; the way that is left at the end for whole
 * set-points is made good. Infinite: there is no plan. */
static double cost_with(const struct jp_passage *passages)
{
    struct jp_trajectory_task task = asked.task;
    struct jp_trajectory trajectory;
    struct jp_trajectory_leg legs[LEGS];
    struct jp_trajectory_plan plan;
    const double per_second = q16(robot->model->b[0]) * q24(task.cruise) * q24(task.cruise);
    jp_q16 energy;
    double set_points = 0;

    task.passages = passages;
    if (asked.goes_on) {
        struct jp_trajectory_plan before = {
            .internal = {.task = {.config = &config}, .motion = {.heading = task.heading, .speed = task.motion.speed}}};

        trajectory = (struct jp_trajectory){.legs = legs, .places = LEGS, .start = before.internal.motion};
        plan = before;
        if (jp_trajectory_plan_redirect(&plan, &task) != JP_OK) {
            return INFINITY;
        }
    } else if (jp_trajectory_plan_start(&plan, &task, legs, LEGS, &trajectory) != JP_OK) {
        return INFINITY;
    }
    while (plan.planned < task.count) {
        if (jp_trajectory_plan_leg(&plan, &legs[plan.planned]) != JP_OK) {
            return INFINITY;
        }
    }
    trajectory.count = plan.planned;
    (void)jp_trajectory_energy(&config, robot->model, &trajectory, &energy);
    for (unsigned i = 0; i < trajectory.count; i++) {
        set_points += (double)legs[i].begin.set_points + legs[i].middle.set_points + legs[i].end.set_points;
    }

    const struct jp_trajectory_leg *last = &legs[task.count - 1U];
    const double angle = last->heading * (6.283185307179586 / 4294967296.0);
    const double ahead = (plan.internal.ahead.x * cos(angle) + plan.internal.ahead.y * sin(angle)) / 1048576.0;
    const double price = q16(robot->model->b[0]) * q24(last->speed) + per_second / q24(last->speed);

    return q16(energy) +
           (per_second - q16(robot->model->electronics_power)) * set_points * JP_TICKS_PER_SET_POINT /
               config.tick_rate -
           price * ahead;
}

/* ---- The compass ---- */

/* Both ways; kept if it is better. */
static void try_step(double *best, struct jp_passage *passage, const struct jp_passage *passages, double turn,
                     double change)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        const struct jp_passage before = *passage;

        passage->heading += (jp_angle)(int32_t)(sign * turn * 4294967296.0);
        passage->speed += (jp_q24)(sign * change * asked.task.cruise);

        const double cost = cost_with(passages);

        if (cost < *best) {
            *best = cost;
        } else {
            *passage = before;
        }
    }
}

/* From what was found, in all directions that were free, with steps that are halved. */
static double compass(void)
{
    const unsigned legs = asked.task.count < asked.place_count ? asked.task.count : asked.place_count;
    struct jp_passage passages[LEGS];
    double best = cost_with(found);

    memcpy(passages, found, sizeof passages);
    for (unsigned round = 0; round < ROUNDS; round++) {
        const double share = ldexp(1, -(int)round / 2);

        for (unsigned i = 0; i + 1 < legs; i++) {
            const uint8_t free = (uint8_t)(found[i].given & ~(asked.task.passages == NULL ? 0U : given[i].given));

            if ((free & (unsigned)JP_GIVEN_HEADING) != 0) {
                try_step(&best, &passages[i], passages, share * 0.02, 0);
            }
            if ((free & (unsigned)JP_GIVEN_SPEED) != 0) {
                try_step(&best, &passages[i], passages, 0, share * 0.1);
            }
        }
    }
    return best;
}

/* ---- The search ---- */

static enum jp_status search(void)
{
    const unsigned most = (JP_OPTIMISER_EVALUATIONS + 1U) * LEGS;
    enum jp_status status = jp_trajectory_optimiser_start(&optimiser, &asked);
    unsigned slices = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, status);
    do {
        status = jp_trajectory_optimiser_work(&optimiser);
        slices++;
        TEST_ASSERT_TRUE(slices <= most);
    } while (status == JP_WORKING);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_trajectory_optimiser_work(&optimiser));
    return status;
}

/* As the task has them. */
static bool is_unchanged(void)
{
    bool same = true;

    for (unsigned i = 0; i < asked.task.count; i++) {
        same = same && found[i].given == (asked.task.passages == NULL ? 0 : given[i].given);
    }
    return same;
}

/* What is given stays. */
static bool are_kept(void)
{
    bool kept = true;

    for (unsigned i = 0; i < asked.task.count && asked.task.passages != NULL; i++) {
        const uint8_t bits = given[i].given;

        kept = kept && (found[i].given & bits) == bits &&
               ((bits & (unsigned)JP_GIVEN_HEADING) == 0 || found[i].heading == given[i].heading) &&
               ((bits & (unsigned)JP_GIVEN_SPEED) == 0 || found[i].speed == given[i].speed);
    }
    return kept;
}

static bool check_found(double rule)
{
    const double cost = cost_with(found);
    const double least = compass();
    const double worse = cost / rule - 1;
    const double left = 1 - least / cost;

    seen.ok++;
    seen.unchanged += is_unchanged() ? 1 : 0;
    if (!isfinite(rule) || !isfinite(cost)) {
        return true; /* of legs behind the horizon */
    }
    seen.compared[is_weak]++;
    seen.saved[is_weak] -= worse;
    seen.left[is_weak] += left;
    seen.worse = fmax(seen.worse, worse);
    if (options.verbose) {
        printf("saved %.4f %%, claimed %.4f %%, the compass %.4f %% more; ", -100 * worse,
               100 * ((double)optimiser.rule - (double)optimiser.found) / rule, 100 * left);
    }
    return worse < WORSE;
}

static bool try_route(unsigned long index)
{
    bool good = true;
    enum jp_status status;
    double rule;

    draw();
    rule = cost_with(asked.task.passages);
    status = search();
    if (status == JP_OK) {
        good = are_kept() && check_found(rule);
    } else if (status == JP_ERR_NO_PLAN) {
        seen.no_plan++;
        good = is_unchanged();
    } else {
        seen.infeasible++;
        good = status == JP_ERR_INFEASIBLE && is_unchanged() && !isfinite(rule);
    }
    if (options.verbose || !good) {
        printf("case %lu: %s, %u legs of %u, %.2f V, cruise %.3f m/s, rule %.3f J: status %d, evaluations left %u\n",
               index, robot->name, asked.task.count, asked.place_count, q16(config.voltage), q24(asked.task.cruise),
               rule, (int)status, optimiser.internal.evaluations);
    }
    return good;
}

static void test_random_routes(void)
{
    unsigned long bad = 0;

    random_state = options.seed;
    for (unsigned long k = 0; k < options.count; k++) {
        bad += try_route(k) ? 0 : 1;
    }
    printf("%lu routes, %lu bad; %lu found, of which %lu are the rule's own, %lu infeasible, %lu that the rule cannot "
           "plan; %.4f %% worse at most\n",
           options.count, bad, seen.ok, seen.unchanged, seen.infeasible, seen.no_plan, 100 * seen.worse);
    for (unsigned weak = 0; weak < 2; weak++) {
        const double count = (double)seen.compared[weak];

        printf("%s: saved %.4f %%, and the compass %.4f %% more, in the mean of %.0f\n",
               weak == 0 ? "with the robots' voltage" : "with little voltage", 100 * seen.saved[weak] / count,
               100 * seen.left[weak] / count, count);
        TEST_ASSERT_TRUE(seen.saved[weak] > 0);
        TEST_ASSERT_TRUE(seen.left[weak] < (weak == 0 ? LEFT : LEFT_WEAK) * count);
    }
    TEST_ASSERT_EQUAL_UINT32(0, bad);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
