/* Energy of trajectories: steady cruise by hand, modes against the voltages tick by tick, legs of others' models,
 * overflow; the cruise speed. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <joulepath/trajectory_energy.h>
#include <math.h>
#include <stddef.h>

#include "src/trajectory/trajectory_blend.h"
#include "tests/support/energy_unit.h"
#include "unity.h"

static struct jp_trajectory_config config;
static struct jp_energy_model model;
static struct jp_trajectory_leg legs[2];
static struct jp_trajectory trajectory;
static jp_q16 energy;
static const struct jp_back_emf of_voltages = {0, 0};

/* Along x at 0.5 m/s for 20 s. */
void setUp(void)
{
    config = jp_robot_courier24.trajectory;
    model = jp_energy_model_courier24;
    model.b[0] = JP_Q16(14.715036); /* what the voltages take: 2 · 5.424949²/4, */
    model.b[1] = JP_Q16(0.3310915); /* 2 · (5.112894/2π)²/4 */
    legs[0] = (struct jp_trajectory_leg){.speed = JP_Q24(0.5),
                                         .begin = {.set_points = 500},
                                         .middle = {.set_points = 9000},
                                         .end = {.set_points = 500},
                                         .next = {.speed = JP_Q24(0.5)}};
    legs[1] = legs[0];
    trajectory = (struct jp_trajectory){.legs = legs, .places = 2, .count = 1, .start = {.speed = JP_Q24(0.5)}};
    energy = 0;
}

void tearDown(void)
{
}

static void shape(void)
{
    jp_leg_shape(&config, &trajectory.start, &legs[0]);
    jp_leg_shape(&config, &legs[0].next, &legs[1]);
}

static enum jp_status forecast(void)
{
    shape();
    return jp_trajectory_energy(&config, &model, &trajectory, &energy);
}

/* The voltages' energy, tick by tick, J. */
static double summed(void)
{
    struct jp_trajectory_drive drive;
    struct jp_set_point point;
    double squares = 0;
    uint32_t set_points = 0;

    shape();
    jp_trajectory_begin(&drive, &trajectory);
    while (jp_trajectory_advance(&drive, &config, &point)) {
        const double common = point.common / 65536.0;
        const double difference = point.difference / 65536.0;

        squares += common * common + difference * difference;
        set_points++;
    }
    return (2 * squares * 65536 / model.motor_resistance + model.electronics_power / 65536.0 * set_points) *
           JP_TICKS_PER_SET_POINT / config.tick_rate;
}

/* Within so many ten thousandths. */
static void expect_summed(int32_t parts)
{
    const int32_t expected = (int32_t)(summed() * 65536);

    TEST_ASSERT_EQUAL_INT(JP_OK, forecast());
    TEST_ASSERT_INT32_WITHIN(expected / 10000 * parts, expected, energy);
}

static void test_refuses_null_pointers(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_energy(NULL, &model, &trajectory, &energy));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_energy(&config, NULL, &trajectory, &energy));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_energy(&config, &model, NULL, &energy));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_energy(&config, &model, &trajectory, NULL));
}

/* 20 s of 2 · 2.71247² V²/4 Ω + 4 W */
static void test_steady_cruise(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, forecast());
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), JP_Q16(153.5752), energy);
}

static void test_blends_are_the_sum_of_their_voltages(void)
{
    trajectory.count = 2;
    trajectory.start = (struct jp_waypoint_motion){JP_ANGLE_DEGREES(-40), JP_Q24(0.05), JP_Q24(0.2)};
    legs[0].next = (struct jp_waypoint_motion){JP_ANGLE_DEGREES(60), JP_Q24(0.25), JP_Q24(0.3)};
    legs[1] = (struct jp_trajectory_leg){.heading = JP_ANGLE_DEGREES(120),
                                         .speed = JP_Q24(0.4),
                                         .begin = {.set_points = 1000},
                                         .middle = {.set_points = 500},
                                         .end = {.set_points = 700}};
    legs[1].next.heading = legs[1].heading;
    expect_summed(5);
}

static void test_modes_are_the_sum_of_their_voltages(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        trajectory.transient[0] = 16 * (sign * JP_Q24(0.3));
        trajectory.transient[1] = 16 * (sign * -JP_Q24(0.2));
        trajectory.transient[2] = 16 * (sign * JP_Q24(0.4));
        config.modes.volts[0] = JP_Q16(3);
        config.modes.volts[2] = -JP_Q16(4);
        expect_summed(10);
        legs[0].begin.set_points = 20; /* so that they last into the middle */
        expect_summed(10);
    }
}

static void test_modes_that_hardly_end(void)
{
    config.modes.decay[0] = JP_Q16(0.1);
    config.modes.keep[0] = 2147185964; /* 2^-0.0002 */
    config.modes.volts[0] = JP_Q16(2);
    trajectory.transient[0] = 16 * (JP_Q24(0.25));
    expect_summed(10);
    config.modes.decay[0] = 1; /* the least, of which the rate is not 0 either */
    TEST_ASSERT_EQUAL_INT(JP_OK, forecast());
}

/* A turn that begins at 0.1 turn/s, straight on at 0.5 m/s, and by a model that knows better. */
static void test_legs_by_a_model(void)
{
    jp_q24 modes[JP_TRAVEL_MODES] = {0};
    struct jp_leg_energy leg, other;

    legs[0].chord = JP_ANGLE_DEGREES(36);
    legs[0].heading = JP_ANGLE_DEGREES(72);
    legs[0].next.heading = JP_ANGLE_DEGREES(72);
    legs[0].begin.set_points = 1000;
    trajectory.start.turn_rate = JP_Q24(0.1);
    shape();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_leg_energy(&config, &model, &of_voltages, &legs[0], modes, &leg));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(21), leg.duration);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(5.25), leg.travel);
    /* ω = 0.1 (1 − s) + 0.3 s (1 − s): ∫ ω² = 0.01/3 + 0.06/12 + 0.09/30 turn²/s, twice as long, by 39.4784 */
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(0.894844), leg.turning);
    model.b[0] += JP_Q16(3);
    model.b[1] += JP_Q16(2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_leg_energy(&config, &model, &of_voltages, &legs[0], modes, &other));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), leg.energy + 3 * leg.travel + 2 * leg.turning, other.energy);
}

/* Of the voltages that change speed and turn rate, set-point by set-point, J. */
static void expect_transients(const struct jp_leg_energy *leg)
{
    struct jp_trajectory_drive drive;
    struct jp_set_point point;
    double sums[JP_LEG_TRANSIENTS] = {0};

    jp_trajectory_begin(&drive, &trajectory);
    while (jp_trajectory_advance(&drive, &config, &point)) {
        const double steady = config.volts[0] / 65536.0 * point.wheel_rate / config.turns_per_metre;
        const double turning = config.turning[0] / 65536.0 * (point.yaw_rate / 16777216.0);
        const double changing = point.common / 65536.0 - steady;

        sums[0] += 2 * steady * changing;
        sums[1] += changing * changing;
        sums[2] += 2 * turning * (point.difference / 65536.0 - turning);
    }
    for (unsigned i = 0; i < JP_LEG_TRANSIENTS; i++) {
        const double expected =
            2 * sums[i] * 65536 / model.motor_resistance * JP_TICKS_PER_SET_POINT / config.tick_rate;

        TEST_ASSERT_TRUE(fabs(expected) > 0.005);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.002) + (int32_t)(fabs(expected) * 300), (int32_t)(expected * 65536),
                                 leg->transient[i]);
    }
}

static void test_transients_are_the_sum_of_their_voltages(void)
{
    jp_q24 modes[JP_TRAVEL_MODES] = {0};
    struct jp_leg_energy leg;

    trajectory.start = (struct jp_waypoint_motion){JP_ANGLE_DEGREES(-40), JP_Q24(0.05), JP_Q24(0.2)};
    legs[0].next = (struct jp_waypoint_motion){JP_ANGLE_DEGREES(60), JP_Q24(0.25), JP_Q24(0.3)};
    shape();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_leg_energy(&config, &model, &of_voltages, &legs[0], modes, &leg));
    expect_transients(&leg);
}

/* The voltages times the currents that the motors' motion leaves, set-point by set-point, J. */
static double drawn(const struct jp_back_emf *back_emf)
{
    struct jp_trajectory_drive drive;
    struct jp_set_point point;
    double sum = 0;
    uint32_t set_points = 0;

    jp_trajectory_begin(&drive, &trajectory);
    while (jp_trajectory_advance(&drive, &config, &point)) {
        const double speed = (double)point.wheel_rate / config.turns_per_metre;
        const double common = point.common / 65536.0;
        const double difference = point.difference / 65536.0;

        sum += common * (common - back_emf->travel / 65536.0 * speed) +
               difference * (difference - back_emf->turning / 65536.0 * (point.yaw_rate / 16777216.0));
        set_points++;
    }
    return (2 * sum * 65536 / model.motor_resistance + model.electronics_power / 65536.0 * set_points) *
           JP_TICKS_PER_SET_POINT / config.tick_rate;
}

/* From rest into a turn; what decays lasts into the middle. */
static void test_what_the_battery_gives(void)
{
    const struct jp_back_emf back_emf = {JP_Q16(4.687), JP_Q16(3.5)};
    struct jp_leg_energy leg;

    for (uint32_t set_points = 20; set_points <= 500U; set_points += 480U) {
        jp_q24 modes[JP_TRAVEL_MODES] = {JP_Q24(0.2), JP_Q24(-0.3), JP_Q24(-0.4)};

        legs[0].begin.set_points = set_points;
        legs[0].end.set_points = 700;
        legs[0].next.turn_rate = JP_Q24(0.1);
        legs[0].next.heading = JP_ANGLE_DEGREES(30);
        for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
            trajectory.transient[i] = 16 * modes[i];
        }
        shape();
        model.b[0] = JP_Q16(2 * 5.424949 / 4 * (5.424949 - 4.687)); /* as the voltages and the motors' motion say */
        model.b[1] = JP_Q16(2 * 5.112894 / 4 * (5.112894 - 3.5) / 39.4784);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_leg_energy(&config, &model, &back_emf, &legs[0], modes, &leg));
        TEST_ASSERT_INT32_WITHIN(leg.energy / 1000, (int32_t)(drawn(&back_emf) * 65536), leg.energy);
    }
}

/* Motors whose back EMF is above their voltage brake: the sum of the voltages' energy is below 0. */
static void test_what_comes_back_to_the_battery(void)
{
    const struct jp_back_emf back_emf = {JP_Q16(7), JP_Q16(6)};
    jp_q24 modes[JP_TRAVEL_MODES] = {0};
    struct jp_leg_energy leg;

    shape();
    model.b[0] = JP_Q16(0.5);
    model.b[1] = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_leg_energy(&config, &model, &back_emf, &legs[0], modes, &leg));

    const double beyond = (0.5 - 2 * 5.424949 / 4 * (5.424949 - 7)) * (leg.travel / 65536.0);

    TEST_ASSERT_INT32_WITHIN(leg.energy / 1000, (int32_t)((drawn(&back_emf) + beyond) * 65536), leg.energy);
}

/* Toward zero, so that they are of one size in both directions. */
static void test_modes_at_the_start(void)
{
    jp_q24 modes[JP_TRAVEL_MODES];

    trajectory.transient[0] = 16 * JP_Q24(0.3) + 15;
    trajectory.transient[1] = -trajectory.transient[0];
    trajectory.transient[2] = INT32_MIN;
    jp_trajectory_modes(&trajectory, modes);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.3), modes[0]);
    TEST_ASSERT_EQUAL_INT32(-JP_Q24(0.3), modes[1]);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN / 16, modes[2]);
}

static void test_modes_of_a_leg_go_on_in_the_next(void)
{
    jp_q24 modes[JP_TRAVEL_MODES] = {JP_Q24(0.3), JP_Q24(-0.2), JP_Q24(0.1)};
    struct jp_leg_energy first, second;

    trajectory.count = 2;
    legs[0].begin.set_points = 20;
    legs[0].middle.set_points = 20;
    legs[0].end.set_points = 20;
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        trajectory.transient[i] = 16 * modes[i];
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, forecast());
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_leg_energy(&config, &model, &of_voltages, &legs[0], modes, &first));
    TEST_ASSERT_NOT_EQUAL_INT32(0, modes[2]);
    TEST_ASSERT_TRUE(modes[2] < JP_Q24(0.1));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_leg_energy(&config, &model, &of_voltages, &legs[1], modes, &second));
    TEST_ASSERT_EQUAL_INT32(energy, first.energy + second.energy);
}

static void test_legs_refuse_null_pointers(void)
{
    jp_q24 modes[JP_TRAVEL_MODES] = {0};
    struct jp_leg_energy leg;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_leg_energy(NULL, &model, &of_voltages, &legs[0], modes, &leg));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT,
                          jp_trajectory_leg_energy(&config, NULL, &of_voltages, &legs[0], modes, &leg));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_leg_energy(&config, &model, NULL, &legs[0], modes, &leg));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_leg_energy(&config, &model, &of_voltages, NULL, modes, &leg));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT,
                          jp_trajectory_leg_energy(&config, &model, &of_voltages, &legs[0], NULL, &leg));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT,
                          jp_trajectory_leg_energy(&config, &model, &of_voltages, &legs[0], modes, NULL));
}

/* Each member alone. */
static void test_a_leg_beyond_its_format(void)
{
    jp_q24 modes[JP_TRAVEL_MODES] = {0};
    struct jp_leg_energy leg;

    legs[0].begin.set_points = 1U << 24;
    shape();
    legs[0].begin.yaw_rate[0] = JP_Q24(8);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW,
                          jp_trajectory_leg_energy(&config, &model, &of_voltages, &legs[0], modes, &leg));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, leg.turning);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, leg.energy);
    setUp();
    model.electronics_power = 1;
    legs[0].speed = JP_Q24(0.01);
    legs[0].next.speed = JP_Q24(0.01);
    trajectory.start.speed = JP_Q24(0.01);
    legs[0].middle.set_points = 20000000; /* 40 000 s */
    shape();
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW,
                          jp_trajectory_leg_energy(&config, &model, &of_voltages, &legs[0], modes, &leg));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, leg.duration);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(1), JP_Q16(59), leg.energy);
}

/* Of motion that takes nothing. */
static void test_integrals_beyond_their_format(void)
{
    jp_q24 modes[JP_TRAVEL_MODES] = {0};
    struct jp_leg_energy leg;

    for (unsigned i = 0; i < 4U; i++) {
        config.volts[i] = 0;
    }
    config.turning[0] = config.turning[1] = 0;
    model.b[0] = model.b[1] = 0;
    trajectory.start.speed = legs[0].speed = legs[0].next.speed = JP_Q24(8);
    legs[0].middle.set_points = 300000; /* 600 s */
    shape();
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW,
                          jp_trajectory_leg_energy(&config, &model, &of_voltages, &legs[0], modes, &leg));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, leg.travel);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(20), JP_Q16(2408), leg.energy);
    legs[0].middle.set_points = 1;
    legs[0].begin.set_points = 10000; /* 20 s */
    trajectory.start.turn_rate = JP_Q24(32);
    shape();
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW,
                          jp_trajectory_leg_energy(&config, &model, &of_voltages, &legs[0], modes, &leg));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, leg.turning);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(2), JP_Q16(84), leg.energy);
}

static void test_transients_overflow(void)
{
    jp_q24 modes[JP_TRAVEL_MODES] = {0};
    struct jp_leg_energy leg;

    trajectory.start.speed = JP_Q24(0.1);
    shape();
    model.motor_resistance = 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW,
                          jp_trajectory_leg_energy(&config, &model, &of_voltages, &legs[0], modes, &leg));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, leg.transient[0]);
}

/* Tables that pass their checks, and legs in their ranges, of voltages and times that no robot has. */
static void test_what_leaves_64_bits(void)
{
    const char *field;
    struct jp_leg_energy leg;

    for (unsigned i = 0; i < 4U; i++) {
        jp_q24 modes[JP_TRAVEL_MODES] = {-JP_Q24(8), -JP_Q24(8), -JP_Q24(8)};

        setUp();
        config.volts[0] = config.turning[0] = JP_Q16(4096);
        config.turning[1] = -JP_Q16(4096);
        config.modes.volts[0] = config.modes.volts[1] = config.modes.volts[2] = JP_Q16(4096);
        config.modes.decay[i % JP_TRAVEL_MODES] = 1;
        model.motor_resistance = i < 2U ? INT32_MAX : 1;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_check(&config, &field));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_energy_model_check(&model, &field));
        trajectory.start = (struct jp_waypoint_motion){.turn_rate = JP_Q24(8), .speed = JP_Q24(8)};
        legs[0].speed = JP_Q24(8);
        legs[0].begin.set_points = i == 0U ? 1U : 1U << 24;
        legs[0].middle.set_points = i == 0U ? 1U : 1U << 30;
        shape();
        legs[0].speed = i == 3U ? INT32_MIN : JP_Q24(8);
        TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW,
                              jp_trajectory_leg_energy(&config, &model, &of_voltages, &legs[0], modes, &leg));
        TEST_ASSERT_EQUAL_INT32(INT32_MAX, leg.energy);
    }
}

/* Motors that brake with more than what is counted: no energy is told, rather than one that is too high. */
static void test_braking_beyond_64_bits(void)
{
    const struct jp_back_emf back_emf = {JP_Q16(4096), JP_Q16(4096)};
    jp_q24 modes[JP_TRAVEL_MODES] = {0};
    struct jp_leg_energy leg;

    config.volts[0] = JP_Q16(2048);
    trajectory.start.speed = legs[0].speed = legs[0].next.speed = JP_Q24(8);
    shape();
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_trajectory_leg_energy(&config, &model, &back_emf, &legs[0], modes, &leg));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, leg.energy);
}

static void test_overflow(void)
{
    legs[0].middle.set_points = 1U << 30;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, forecast());
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, energy);
    legs[0].middle.set_points = 2100000; /* 32 250 J */
    TEST_ASSERT_EQUAL_INT(JP_OK, forecast());
    TEST_ASSERT_INT32_WITHIN(JP_Q16(30), JP_Q16(32251), energy);
}

/* In units of 2⁻⁴ and 2⁴ J: the same joules, and the same cruise. */
static void test_the_unit_is_a_factor(void)
{
    const struct jp_energy_model in_joules = model;

    trajectory.start.speed = JP_Q24(0.3);
    TEST_ASSERT_EQUAL_INT(JP_OK, forecast());

    const jp_q16 joules = energy;

    for (int32_t exponent = -4; exponent <= 4; exponent += 8) {
        model = energy_model_in_unit(&in_joules, exponent);
        TEST_ASSERT_EQUAL_INT(JP_OK, forecast());
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), energy_in_unit(joules, exponent), energy);
        TEST_ASSERT_INT32_WITHIN(JP_Q24(1e-5), jp_cruise_speed(&in_joules), jp_cruise_speed(&model));
    }
}

static void test_cruise_speed(void)
{
    model.b[0] = JP_Q16(16);
    model.electronics_power = JP_Q16(4);
    TEST_ASSERT_INT32_WITHIN(2, JP_Q24(0.5), jp_cruise_speed(&model));
    model.electronics_power = JP_Q16(25);
    TEST_ASSERT_INT32_WITHIN(2, JP_Q24(1.25), jp_cruise_speed(&model));
    /* √(4 W/14.71673 J·s/m²), √(6/20.86322) */
    TEST_ASSERT_INT32_WITHIN(20, JP_Q24(0.5213846), jp_cruise_speed(&jp_energy_model_courier24));
    TEST_ASSERT_INT32_WITHIN(20, JP_Q24(0.5362835), jp_cruise_speed(&jp_energy_model_gao2018));
}

static void test_cruise_speed_is_clamped(void)
{
    model.b[0] = 1;
    model.electronics_power = JP_Q16(256);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(8), jp_cruise_speed(&model));
    model.b[0] = 0;
    TEST_ASSERT_EQUAL_INT32(JP_Q24(8), jp_cruise_speed(&model));
    model.b[0] = JP_Q16(100);
    model.electronics_power = 0;
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.01), jp_cruise_speed(&model));
}

/* √(Ps/b1) from 0.01 m/s to 8 m/s. */
static void test_cruise_speeds_end_at_eight_metres_a_second(void)
{
    struct jp_energy_model fast = jp_energy_model_courier24;

    fast.b[0] = JP_Q16(1);
    for (int32_t speed = 1; speed <= 10; speed++) {
        fast.electronics_power = JP_Q16(1) * speed * speed;
        TEST_ASSERT_INT32_WITHIN(64, JP_Q24(1) * (speed < 8 ? speed : 8), jp_cruise_speed(&fast));
    }
    fast.electronics_power = JP_Q16(0.0001);
    fast.b[0] = JP_Q16(4);
    TEST_ASSERT_INT32_WITHIN(64, JP_Q24(0.01), jp_cruise_speed(&fast));
}
