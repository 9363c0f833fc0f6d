/* Energy of trajectories: steady cruise by hand, modes against the voltages tick by tick, overflow; the cruise speed.
 */
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <joulepath/trajectory_energy.h>
#include <stddef.h>

#include "src/trajectory/trajectory_blend.h"
#include "unity.h"

static struct jp_trajectory_config config;
static struct jp_energy_model model;
static struct jp_trajectory_leg legs[2];
static struct jp_trajectory trajectory;
static jp_q16 energy;

/* Along x at 0.5 m/s for 20 s. */
void setUp(void)
{
    config = jp_robot_courier24.trajectory;
    model = jp_energy_model_courier24;
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

static void test_overflow(void)
{
    legs[0].middle.set_points = UINT32_MAX / 2U;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, forecast());
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, energy);
    legs[0].middle.set_points = 2100000; /* 32 250 J */
    TEST_ASSERT_EQUAL_INT(JP_OK, forecast());
    TEST_ASSERT_INT32_WITHIN(JP_Q16(30), JP_Q16(32251), energy);
}

static void test_cruise_speed(void)
{
    model.b[0] = JP_Q16(16);
    model.electronics_power = JP_Q16(4);
    TEST_ASSERT_INT32_WITHIN(2, JP_Q24(0.5), jp_cruise_speed(&model));
    model.electronics_power = JP_Q16(25);
    TEST_ASSERT_INT32_WITHIN(2, JP_Q24(1.25), jp_cruise_speed(&model));
    /* √(4 W/14.71673 J·s/m²), √(6/20.86322) */
    TEST_ASSERT_INT32_WITHIN(20, JP_Q24(0.5213443), jp_cruise_speed(&jp_energy_model_courier24));
    TEST_ASSERT_INT32_WITHIN(20, JP_Q24(0.5362723), jp_cruise_speed(&jp_energy_model_gao2018));
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
