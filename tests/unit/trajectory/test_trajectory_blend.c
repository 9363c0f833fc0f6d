/* The nodes of blends, and what is left of modes, against what they are of. */
#include "src/trajectory/trajectory_blend.h"

#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "src/base/integer.h"
#include "unity.h"

#define Q30_ONE ((int32_t)1 << 30)

static struct jp_trajectory_config config;

void setUp(void)
{
    config = jp_robot_courier24.trajectory;
}

void tearDown(void)
{
}

/* ---- Nodes ---- */

/* Gauss's and Legendre's lie evenly about the middle and are exact to a power of twice their count less one. */
static void expect_nodes(bool is_plain, unsigned expected)
{
    unsigned count = 0;
    const struct jp_node *nodes = jp_blend_nodes(is_plain, &count);

    TEST_ASSERT_EQUAL_UINT32(expected, count);
    for (unsigned i = 0; i < count; i++) {
        const struct jp_node *opposite = &nodes[count - 1U - i];

        TEST_ASSERT_EQUAL_INT32(Q30_ONE, nodes[i].share + opposite->share);
        TEST_ASSERT_EQUAL_INT32(nodes[i].weight, opposite->weight);
    }
    for (unsigned power = 0; power < 2U * count; power++) {
        double sum = 0.0;

        for (unsigned i = 0; i < count; i++) {
            double term = nodes[i].weight * 0x1p-30;

            for (unsigned k = 0; k < power; k++) {
                term *= nodes[i].share * 0x1p-30;
            }
            sum += term;
        }
        TEST_ASSERT_INT32_WITHIN(6, Q30_ONE / (int32_t)(power + 1U), (int32_t)(sum * 0x1p30));
    }
}

static void test_nodes_integrate_powers(void)
{
    expect_nodes(true, 4);
    expect_nodes(false, JP_NODES_MAX);
}

/* ---- Modes ---- */

/* e^(-x), x >= 0: all terms of its inverse are positive. */
static double falling(double x)
{
    double sum = 1.0;
    double term = 1.0;

    for (int n = 1; n < 100; n++) {
        term *= x / n;
        sum += term;
    }
    return 1.0 / sum;
}

static double seconds_of(uint32_t set_points)
{
    return (double)set_points * JP_TICKS_PER_SET_POINT / config.tick_rate;
}

/* 1/s. */
static double rate_of(unsigned mode)
{
    return config.modes.decay[mode] / 65536.0 * 0.69314718055994531;
}

static void test_modes_decay_with_the_time(void)
{
    static const uint32_t set_points[] = {1, 50, 300, 1000};

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        TEST_ASSERT_INT32_WITHIN(2, (int32_t)(rate_of(i) * 65536), jp_mode_rate(&config, i));
        TEST_ASSERT_EQUAL_INT32(0, jp_mode_after(&config, i, 0, 100, Q30_ONE));
        for (unsigned k = 0; k < 4U; k++) {
            for (int quarter = 0; quarter <= 4; quarter++) {
                const double left = falling(rate_of(i) * seconds_of(set_points[k]) * quarter / 4);

                TEST_ASSERT_INT32_WITHIN(
                    1 + JP_Q24(0.0001), (int32_t)(left * JP_Q24(0.7)),
                    jp_mode_after(&config, i, JP_Q24(0.7), set_points[k], quarter * (Q30_ONE / 4)));
                TEST_ASSERT_INT32_WITHIN(
                    1 + JP_Q24(0.0001), (int32_t)(left * -JP_Q24(0.7)),
                    jp_mode_after(&config, i, -JP_Q24(0.7), set_points[k], quarter * (Q30_ONE / 4)));
            }
        }
    }
}

/* What they decay in seconds is ∫ m e^(-λt) dt of the way, each and together. */
static void test_modes_roll_their_way(void)
{
    static const jp_q24 start[JP_TRAVEL_MODES] = {JP_Q24(0.4), -JP_Q24(0.3), JP_Q24(0.2)};

    for (unsigned i = 0; i <= JP_TRAVEL_MODES; i++) {
        jp_q24 modes[JP_TRAVEL_MODES] = {0, 0, 0};
        double way = 0.0;

        for (unsigned j = 0; j < JP_TRAVEL_MODES; j++) {
            modes[j] = i == j || i == JP_TRAVEL_MODES ? start[j] : 0;
            way += modes[j] * 0x1p-24 * (1.0 - falling(rate_of(j) * seconds_of(400))) / rate_of(j);
        }
        TEST_ASSERT_INT32_WITHIN(256, (int32_t)(way * 0x1p20), jp_modes_way(&config, modes, 400));
        jp_modes_decay(&config, modes, 400);
        for (unsigned j = 0; j < JP_TRAVEL_MODES; j++) {
            const double left = i == j || i == JP_TRAVEL_MODES ? falling(rate_of(j) * seconds_of(400)) : 0.0;

            TEST_ASSERT_INT32_WITHIN(1 + JP_Q24(0.0001), (int32_t)(left * start[j]), modes[j]);
        }
    }
}

static void test_modes_are_gone_below_a_twentieth_of_a_millimetre_a_second(void)
{
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            jp_q24 modes[JP_TRAVEL_MODES] = {0, 0, 0};

            modes[i] = sign * JP_Q24(0.00005);
            TEST_ASSERT_TRUE(jp_modes_are_gone(modes));
            modes[i] = sign * (JP_Q24(0.00005) + 2);
            TEST_ASSERT_FALSE(jp_modes_are_gone(modes));
        }
    }
}

/* ---- The way of a blend ---- */

static double cosine_of(double turn)
{
    return jp_cos((jp_angle)(int32_t)(turn * 0x1p31) * 2U) * 0x1p-31;
}

static double sine_of(double turn)
{
    return jp_sin((jp_angle)(int32_t)(turn * 0x1p31) * 2U) * 0x1p-31;
}

/* By its polynomials, in 256 steps: turn and turn/s; m/s. */
static void expect_way(double turned, double from_rate, double to_rate, double from_speed, double to_speed,
                       double duration)
{
    const struct jp_waypoint_motion from = {JP_ANGLE_DEGREES(30), (jp_q24)(from_rate * 0x1p24),
                                            (jp_q24)(from_speed * 0x1p24)};
    const struct jp_waypoint_motion to = {JP_ANGLE_DEGREES(30) + (jp_angle)(int32_t)(turned * 0x1p31) * 2U,
                                          (jp_q24)(to_rate * 0x1p24), (jp_q24)(to_speed * 0x1p24)};
    static const jp_q24 none[JP_TRAVEL_MODES] = {0, 0, 0};
    const double lag = config.lag * 0x1p-24 / duration / duration;
    struct jp_rolling rolling;
    double x = 0.0;
    double y = 0.0;

    jp_modes_roll(&config, none, 100, false, &rolling);
    for (int i = 0; i < 256; i++) {
        const double s = (i + 0.5) / 256;
        const double heading = 30.0 / 360 + turned * s * s * (3 - 2 * s) +
                               from_rate * duration * s * (1 - s) * (1 - s) - to_rate * duration * s * s * (1 - s);
        const double q = s * s * s * (10 - 15 * s + 6 * s * s);
        const double bend = 60 * s * (1 - s) * (1 - 2 * s);
        const double speed = from_speed + (to_speed - from_speed) * (q - lag * bend);

        x += speed * cosine_of(heading) * duration / 256;
        y += speed * sine_of(heading) * duration / 256;
    }
    const struct jp_way way =
        jp_blend_way(&config, &from, &to, (int32_t)(turned * 0x1p31), (jp_q24)(duration * 0x1p24), &rolling);

    TEST_ASSERT_INT32_WITHIN(60, (int32_t)(x * 0x1p20), way.x);
    TEST_ASSERT_INT32_WITHIN(60, (int32_t)(y * 0x1p20), way.y);
}

static void test_the_way_of_blends(void)
{
    expect_way(0.0, 0.0, 0.0, 0.5, 0.5, 1.5);
    expect_way(0.125, 0.0, 0.0, 0.5, 0.5, 1.5);
    expect_way(-0.125, 0.1, 0.0, 0.5, 0.5, 1.2);
    expect_way(0.1, 0.0, 0.15, 0.5, 0.5, 1.2);
    expect_way(0.0, 0.0, 0.0, 0.2, 0.7, 0.8);
    expect_way(0.05, 0.0, 0.0, 0.7, 0.1, 0.6);
    expect_way(0.15, 0.1, -0.05, 0.1, 0.6, 1.0);
}
