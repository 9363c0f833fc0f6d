/* The cost of a leg in closed form: against the energy of the rule's plan, its derivatives against differences, legs
 * without room. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <joulepath/trajectory_energy.h>
#include <stddef.h>

#include "src/trajectory/trajectory_cost.h"
#include "tests/support/near.h"
#include "unity.h"

/* Of heading and speed, for differences: rad, m/s. */
#define STEP 0.02f

static struct jp_cost_rates rates;
static struct jp_cost_leg leg;
static float middle;

static void make_rates(const struct jp_robot_config *robot, const struct jp_energy_model *model)
{
    static const struct jp_back_emf of_voltages = {0, 0};

    jp_cost_rates_make(&rates, &robot->trajectory, model, &of_voltages, jp_cruise_speed(model));
}

/* Turned to from the left, and left to the left. */
void setUp(void)
{
    make_rates(&jp_robot_gao2018, &jp_energy_model_gao2018);
    leg = (struct jp_cost_leg){
        .length = 4.0f,
        .speed = 0.5f,
        .begin = {.heading = -0.5f, .turn_rate = 0.8f, .speed = 0.45f, .duration = 1.4f},
        .end = {.heading = 0.6f, .turn_rate = 1.0f, .speed = 0.4f, .duration = 1.2f},
    };
    middle = 0.0f;
}

void tearDown(void)
{
}

static float *variable(unsigned index)
{
    float *const variables[] = {&leg.begin.heading, &leg.begin.speed, &leg.end.heading, &leg.end.speed};

    return variables[index];
}

static float slope_of(const struct jp_leg_cost *cost, unsigned index)
{
    return index < 2U ? cost->slope_begin[index] : cost->slope_end[index - 2U];
}

static float curve_of(const struct jp_leg_cost *cost, unsigned i, unsigned j)
{
    if (i > j) {
        return curve_of(cost, j, i);
    }
    if (i < 2U && j >= 2U) {
        return cost->coupling[i][j - 2U];
    }
    return j < 2U ? cost->curve_begin[i + j] : cost->curve_end[i + j - 4U];
}

static struct jp_leg_cost cost_at(unsigned index, float step)
{
    struct jp_leg_cost cost;
    const float before = *variable(index);

    *variable(index) += step;
    TEST_ASSERT_TRUE(jp_leg_cost(&rates, &leg, &middle, &cost));
    *variable(index) = before;
    return cost;
}

static void expect_derivatives(void)
{
    const struct jp_leg_cost here = cost_at(0, 0.0f);

    for (unsigned i = 0; i < 4; i++) {
        const struct jp_leg_cost more = cost_at(i, STEP);
        const struct jp_leg_cost less = cost_at(i, -STEP);

        TEST_ASSERT_NEAR(0.03f, (more.cost - less.cost) / (2.0f * STEP), slope_of(&here, i));
        for (unsigned j = 0; j < 4; j++) {
            const float curve = (slope_of(&more, j) - slope_of(&less, j)) / (2.0f * STEP);

            TEST_ASSERT_NEAR(0.2f, curve, curve_of(&here, i, j));
        }
    }
}

static void test_derivatives_are_those_of_the_cost(void)
{
    rates.momentum = 0.0f; /* it has none: another leg makes it good */
    expect_derivatives();
    leg.begin.heading = 1.2f;
    leg.begin.turn_rate = -0.5f;
    expect_derivatives();
}

/* Of changes of speed that count, too: every part of a curvature is there. */
static void test_derivatives_beside_great_changes_of_speed(void)
{
    rates.momentum = 0.0f;
    leg.speed = 0.6f;
    leg.begin.speed = 0.2f;
    leg.end.speed = 0.25f;
    expect_derivatives();
    leg.begin.speed = 0.9f;
    leg.end.speed = 0.8f;
    leg.begin.heading = 0.7f;
    leg.begin.turn_rate = -0.9f;
    expect_derivatives();
}

static void test_a_straight_end_follows_the_middle(void)
{
    struct jp_leg_cost cost;

    leg.end.is_straight = true;
    leg.end.speed = leg.speed;
    TEST_ASSERT_TRUE(jp_leg_cost(&rates, &leg, &middle, &cost));
    TEST_ASSERT_NEAR(0.0f, 0.0f, cost.slope_end[0]);
    TEST_ASSERT_NEAR(0.0f, 0.0f, cost.curve_end[0]);
    TEST_ASSERT_NEAR(0.0f, 0.0f, cost.coupling[0][0]);

    const float before = cost.cost;

    leg.end.heading = 1.0f;
    TEST_ASSERT_TRUE(jp_leg_cost(&rates, &leg, &middle, &cost));
    TEST_ASSERT_NEAR(0.0f, before, cost.cost);
}

static void expect_no_room(void)
{
    struct jp_leg_cost cost;
    const float before = middle;

    TEST_ASSERT_FALSE(jp_leg_cost(&rates, &leg, &middle, &cost));
    TEST_ASSERT_NEAR(0.0f, before, middle);
}

static void test_legs_without_room(void)
{
    leg.length = 1.0f;
    expect_no_room();
}

static void test_a_middle_that_leads_astray(void)
{
    leg.length = 2.0f;
    leg.begin = (struct jp_cost_end){.heading = 1.5f, .speed = 0.5f, .duration = 4.0f};
    expect_no_room();
}

static void test_a_search_that_begins_too_far_away(void)
{
    leg.length = 2.0f;
    leg.begin = (struct jp_cost_end){.heading = 2.5f, .speed = 0.5f, .duration = 3.0f};
    middle = 0.78f;
    expect_no_room();
}

/* ---- Against the rule's plan ---- */

static struct jp_trajectory_leg legs[3];
static struct jp_trajectory trajectory;

static float energy_by_rule(const struct jp_trajectory_task *task, const struct jp_energy_model *model)
{
    jp_q16 energy;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_by_rule(task, legs, &trajectory));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_energy(task->config, model, &trajectory, &energy));
    return (float)energy * 0x1p-16f;
}

/* At the cruise of least energy a second costs the power of the electronics: the cost is the energy. */
static void test_a_start_and_a_stop_are_those_of_the_energy(void)
{
    static const struct jp_point target = {JP_Q16(4), 0};
    const struct jp_robot_config *robot = &jp_robot_courier24;
    const struct jp_energy_model *model = &jp_energy_model_courier24;
    const struct jp_trajectory_task task = {.config = &robot->trajectory,
                                            .cruise = jp_cruise_speed(model),
                                            .targets = &target,
                                            .count = 1,
                                            .to_stand = true};
    const float energy = energy_by_rule(&task, model);
    jp_q24 modes[JP_TRAVEL_MODES];
    struct jp_rolling rolling;
    struct jp_leg_cost cost;

    jp_trajectory_modes(&trajectory, modes);
    jp_modes_roll(task.config, modes, legs[0].begin.set_points, false, &rolling);
    make_rates(robot, model);

    const float start = jp_start_cost(&rates, task.config, modes, legs[0].speed);

    jp_modes_decay(task.config, modes, legs[0].begin.set_points);
    leg = (struct jp_cost_leg){
        .length = 4.0f,
        .speed = (float)legs[0].speed * 0x1p-24f,
        .rolled = (float)jp_modes_way(task.config, modes, UINT32_MAX) * 0x1p-20f,
        .begin = {.speed = (float)legs[0].speed * 0x1p-24f,
                  .duration = (float)legs[0].begin.set_points * 0.002f,
                  .rolling = &rolling},
        .end = {.duration = (float)legs[0].end.set_points * 0.002f, .is_straight = true},
    };
    TEST_ASSERT_TRUE(jp_leg_cost(&rates, &leg, &middle, &cost));
    TEST_ASSERT_NEAR(0.01f, energy, cost.cost + start); /* but for whole set-points */
}

static struct jp_cost_end end_at(jp_q24 speed, uint32_t set_points)
{
    return (struct jp_cost_end){.speed = (float)speed * 0x1p-24f, .duration = (float)set_points * 0.002f};
}

/* Straight on, past a slow waypoint: what the changes of speed take, of voltages and of currents, with a lag as the
 * robot's and a longer one. */
static void test_changes_of_speed_are_those_of_the_energy(void)
{
    static const struct jp_point ahead[2] = {{JP_Q16(3), 0}, {JP_Q16(6), 0}};
    static const struct jp_passage slow[2] = {{.given = JP_GIVEN_SPEED, .speed = JP_Q24(0.3)}, {.given = 0}};
    const struct jp_energy_model *model = &jp_energy_model_courier24;

    for (int i = 0; i < 6; i++) {
        struct jp_trajectory_config config = jp_robot_courier24.trajectory;
        const struct jp_back_emf back_emf = {i < 3 ? 0 : config.volts[0] / 2, 0};
        const jp_q24 cruise = jp_cruise_speed(model);
        const struct jp_trajectory_task task = {
            .config = &config,
            .cruise = cruise,
            .motion = {.speed = cruise, .pitch = jp_q24_multiply(config.lean[0], cruise)},
            .targets = ahead,
            .passages = slow,
            .count = 2};
        jp_q24 modes[JP_TRAVEL_MODES];
        float costs = 0.0f;
        float energies = 0.0f;

        config.lag = i % 3 == 2 ? JP_Q24(0.04) : config.lag * (1 + i % 3);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_by_rule(&task, legs, &trajectory));
        jp_trajectory_modes(&trajectory, modes);
        jp_cost_rates_make(&rates, &config, model, &back_emf, cruise);
        for (unsigned k = 0; k < 2U; k++) {
            struct jp_leg_energy energy;
            struct jp_leg_cost cost;

            leg =
                (struct jp_cost_leg){.length = 3.0f,
                                     .speed = (float)legs[k].speed * 0x1p-24f,
                                     .begin = end_at(k == 0U ? legs[0].speed : slow[0].speed, legs[k].begin.set_points),
                                     .end = end_at(legs[k].next.speed, legs[k].end.set_points)};
            middle = 0.0f;
            TEST_ASSERT_TRUE(jp_leg_cost(&rates, &leg, &middle, &cost));
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_leg_energy(&config, model, &back_emf, &legs[k], modes, &energy));
            costs += cost.cost;
            energies += (float)energy.energy * 0x1p-16f;
            TEST_ASSERT_NEAR(0.02f, energies, costs); /* but for whole set-points */
        }
    }
}

/* e^(-x), x >= 0. */
static double falling(double x)
{
    double sum = 1.0;
    double term = 1.0;

    for (int n = 1; n < 40; n++) {
        term *= x / n;
        sum += term;
    }
    return 1.0 / sum;
}

/* ∫ of what voltages by currents are more than in the steady motion, in small steps. */
static float start_cost_in_steps(const struct jp_trajectory_config *config, const jp_q24 modes[JP_TRAVEL_MODES],
                                 jp_q24 speed)
{
    const double step = 0.005;
    const double steady = config->volts[0] * 0x1p-16 * (speed * 0x1p-24);
    const double kept = (double)rates.back_emf;
    double left[JP_TRAVEL_MODES];
    double keep[JP_TRAVEL_MODES];
    double sum = 0.0;

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        const double factor = falling(jp_mode_rate(config, i) * 0x1p-16 * step / 2);

        keep[i] = factor * factor;
        left[i] = modes[i] * 0x1p-24 * factor; /* in the middle of the step */
    }
    for (int k = 0; k < 4000; k++) {
        double volts = steady;
        double motion = speed * 0x1p-24;

        for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
            volts += config->modes.volts[i] * 0x1p-16 * left[i];
            motion += left[i];
            left[i] *= keep[i];
        }
        sum += volts * (volts - kept * motion) - steady * (steady - kept * speed * 0x1p-24);
    }
    return (float)(sum * step * (double)rates.power);
}

static void test_a_start_takes_what_its_modes_do(void)
{
    const struct jp_trajectory_config *config = &jp_robot_courier24.trajectory;

    for (int e = 0; e < 2; e++) {
        const struct jp_back_emf back_emf = {e == 0 ? 0 : config->volts[0] / 2, 0};

        jp_cost_rates_make(&rates, config, &jp_energy_model_courier24, &back_emf, JP_Q24(0.5));
        for (unsigned i = 0; i <= JP_TRAVEL_MODES; i++) {
            jp_q24 modes[JP_TRAVEL_MODES];

            for (unsigned j = 0; j < JP_TRAVEL_MODES; j++) {
                modes[j] = i == j || i == JP_TRAVEL_MODES ? JP_Q24(0.3) - (jp_q24)j * JP_Q24(0.2) : 0;
            }
            const float cost = jp_start_cost(&rates, config, modes, JP_Q24(0.5));
            const float expected = start_cost_in_steps(config, modes, JP_Q24(0.5));

            TEST_ASSERT_NEAR(0.02f, expected, cost);
        }
    }
}

/* ∫ φ̇² dt or ∫ φ̈² dt of the cubic that turns so far in a blend, from a turn rate to another. */
static float turning_in_steps(bool is_bend, float turn, float from, float to, float duration)
{
    enum { STEPS = 400 };
    float sum = 0.0f;

    for (int i = 0; i < STEPS; i++) {
        const float u = ((float)i + 0.5f) / STEPS;
        const float rate = turn * 6.0f * u * (1.0f - u) + duration * (from * (1.0f - u) * (1.0f - 3.0f * u)) +
                           duration * to * u * (3.0f * u - 2.0f);
        const float bend = turn * (6.0f - 12.0f * u) + duration * (from * (6.0f * u - 4.0f) + to * (6.0f * u - 2.0f));
        const float value = is_bend ? bend / duration : rate;

        sum += value * value / (duration * STEPS);
    }
    return sum;
}

/* By the turn rate alone, and by what changes it alone, of blends that are not alike. */
static void test_a_turn_takes_what_its_cubics_do(void)
{
    for (int i = 0; i < 8; i++) {
        const bool is_bend = i % 2 == 1;
        const float side = i < 4 ? 1.0f : -1.0f;
        struct jp_leg_cost cost;

        rates = (struct jp_cost_rates){.turn = is_bend ? 0.0f : 1.0f, .bend = is_bend ? 1.0f : 0.0f};
        leg = (struct jp_cost_leg){
            .length = 4.0f,
            .speed = 0.5f,
            .begin = {.heading = side * 0.4f, .turn_rate = -side * 0.3f, .speed = 0.5f, .duration = 1.2f},
            .end = {.heading = side * 0.3f,
                    .turn_rate = side * (i % 4 < 2 ? 0.5f : 0.0f),
                    .speed = 0.5f,
                    .duration = 0.9f}};
        middle = 0.0f;
        TEST_ASSERT_TRUE(jp_leg_cost(&rates, &leg, &middle, &cost));

        const float begin = turning_in_steps(is_bend, middle - leg.begin.heading, leg.begin.turn_rate, 0.0f, 1.2f);
        const float end = turning_in_steps(is_bend, leg.end.heading - middle, 0.0f, leg.end.turn_rate, 0.9f);

        TEST_ASSERT_NEAR(0.001f * (begin + end), begin + end, cost.cost);
    }
}
