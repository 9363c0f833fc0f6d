/* Following a trajectory: the check of the configuration, the pieces against the formulas in double, the modes. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <joulepath/trajectory.h>
#include <stddef.h>

#include "src/trajectory/trajectory_blend.h"
#include "tests/support/config_check.h"
#include "unity.h"

enum { LEGS = 2 };

static struct jp_trajectory_config config;
static struct jp_trajectory_leg legs[LEGS];
static struct jp_trajectory trajectory;
static struct jp_trajectory_drive drive;
static struct jp_set_point point;

/* From a stand to 0.5 m/s, a corner of 90° at 0.4 m/s, and to a stand. */
void setUp(void)
{
    config = jp_robot_courier24.trajectory;
    legs[0] = (struct jp_trajectory_leg){
        .heading = JP_ANGLE_DEGREES(10),
        .speed = JP_Q24(0.5),
        .begin = {.set_points = 500},
        .middle = {.set_points = 300},
        .end = {.set_points = 800},
        .next = {JP_ANGLE_DEGREES(55), JP_Q24(0.2), JP_Q24(0.4)},
    };
    legs[1] = (struct jp_trajectory_leg){
        .heading = JP_ANGLE_DEGREES(100),
        .speed = JP_Q24(0.45),
        .begin = {.set_points = 700},
        .middle = {.set_points = 1},
        .end = {.set_points = 600},
        .next = {JP_ANGLE_DEGREES(100), 0, 0},
    };
    trajectory = (struct jp_trajectory){.legs = legs, .places = LEGS, .count = LEGS};
}

void tearDown(void)
{
}

/* ---- Check ---- */

DEFINE_EXPECT_CONFIG(trajectory)

#define SYMMETRIC(member, limit, name)                                                                                 \
    do {                                                                                                               \
        FIELD(member, -(limit)-1, name);                                                                               \
        FIELD(member, -(limit), NULL);                                                                                 \
        FIELD(member, limit, NULL);                                                                                    \
        FIELD(member, (limit) + 1, name);                                                                              \
    } while (0)

static void test_checks_every_field_at_its_limits(void)
{
    expect_config(NULL);
    FIELD(tick_rate, 99, "trajectory.tick_rate");
    FIELD(tick_rate, 100, NULL);
    FIELD(tick_rate, 10000, NULL);
    FIELD(tick_rate, 10001, "trajectory.tick_rate");
    FIELD(turns_per_metre, JP_Q24(0.1) - 1, "trajectory.turns_per_metre");
    FIELD(turns_per_metre, JP_Q24(0.1), NULL);
    FIELD(turns_per_metre, JP_Q24(16), NULL);
    FIELD(turns_per_metre, JP_Q24(16) + 1, "trajectory.turns_per_metre");
    FIELD(lag, -1, "trajectory.lag");
    FIELD(lag, 0, NULL);
    FIELD(lag, JP_Q24_ONE, NULL);
    FIELD(lag, JP_Q24_ONE + 1, "trajectory.lag");
    FIELD(voltage, 0, "trajectory.voltage");
    FIELD(voltage, 1, NULL);
    FIELD(voltage, JP_Q16(512), NULL);
    FIELD(voltage, JP_Q16(512) + 1, "trajectory.voltage");
    FIELD(blend, JP_Q16(0.05) - 1, "trajectory.blend");
    FIELD(blend, JP_Q16(0.05), NULL);
    FIELD(blend, JP_Q16(60), NULL);
    FIELD(blend, JP_Q16(60) + 1, "trajectory.blend");
    FIELD(turn_pace, JP_Q24(0.01) - 1, "trajectory.turn_pace");
    FIELD(turn_pace, JP_Q24(0.01), NULL);
    FIELD(turn_pace, JP_Q24(64), NULL);
    FIELD(turn_pace, JP_Q24(64) + 1, "trajectory.turn_pace");
    FIELD(turn_rate, JP_Q24(0.01) - 1, "trajectory.turn_rate");
    FIELD(turn_rate, JP_Q24(0.01), NULL);
    FIELD(turn_rate, JP_Q24(64), NULL);
    FIELD(turn_rate, JP_Q24(64) + 1, "trajectory.turn_rate");
    FIELD(pitch, 0, "trajectory.pitch");
    FIELD(pitch, 1, NULL);
    FIELD(pitch, JP_Q24(0.125), NULL);
    FIELD(pitch, JP_Q24(0.125) + 1, "trajectory.pitch");
}

static void test_checks_every_element_of_the_arrays(void)
{
    for (int i = 0; i < 2; i++) {
        SYMMETRIC(lean[i], JP_Q24(16), "trajectory.lean");
        SYMMETRIC(turning[i], JP_Q16(4096), "trajectory.turning");
    }
    for (int i = 0; i < 4; i++) {
        SYMMETRIC(volts[i], JP_Q16(4096), "trajectory.volts");
    }
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        FIELD(modes.decay[i], 0, "trajectory.modes.decay");
        FIELD(modes.decay[i], 1, NULL);
        FIELD(modes.decay[i], INT32_MAX, NULL);
        FIELD(modes.keep[i], 0, "trajectory.modes.keep");
        FIELD(modes.keep[i], 1, NULL);
        FIELD(modes.keep[i], INT32_MAX, NULL);
        SYMMETRIC(modes.lean[i], JP_Q24(16), "trajectory.modes.lean");
        SYMMETRIC(modes.lean_rate[i], JP_Q24(64), "trajectory.modes.lean_rate");
        SYMMETRIC(modes.volts[i], JP_Q16(4096), "trajectory.modes.volts");
    }
    for (unsigned i = 0; i < 3U * JP_TRAVEL_MODES; i++) {
        SYMMETRIC(modes.share[i], JP_Q16(1024), "trajectory.modes.share");
    }
}

/* ---- Pieces ---- */

static double q16(int32_t x)
{
    return x / 65536.0;
}

static double q24(int32_t x)
{
    return x / 16777216.0;
}

/* Within so many steps of 2⁻²⁴ or 2⁻¹⁶. */
static void expect_near(int32_t steps, double expected, double scale, int32_t actual)
{
    TEST_ASSERT_INT32_WITHIN(steps, (int32_t)(expected * scale), actual);
}

static void begin(void)
{
    const struct jp_waypoint_motion *from = &trajectory.start;

    for (uint16_t i = 0; i < trajectory.count; i++) {
        jp_leg_shape(&config, from, &legs[i]);
        from = &legs[i].next;
    }
    jp_trajectory_begin(&drive, &trajectory);
}

static void advance(uint32_t set_points)
{
    for (uint32_t i = 0; i < set_points; i++) {
        TEST_ASSERT_TRUE(jp_trajectory_advance(&drive, &config, &point));
    }
}

/* The set-point at a share of a blend, from the polynomials. */
static void expect_blend(const struct jp_waypoint_motion *from, const struct jp_waypoint_motion *to, double time,
                         double s)
{
    const double p = s * (1 - s);
    const double change = q24(to->speed - from->speed);
    const double v = q24(from->speed) + change * s * s * s * (10 - 15 * s + 6 * s * s);
    const double v1 = change * 30 * p * p / time;
    const double v2 = change * 60 * p * (1 - 2 * s) / time / time;
    const double v3 = change * 60 * (1 - 6 * p) / time / time / time;
    const double turned = (int32_t)(to->heading - from->heading) / 4294967296.0;
    const double before = q24(from->turn_rate);
    const double after = q24(to->turn_rate);
    const double bend = 6 * turned / time - 3 * (before + after);
    const double w = before + (after - before) * s + bend * p;
    const double w1 = (after - before + bend * (1 - 2 * s)) / time;

    expect_near(60, q24(config.turns_per_metre) * (v - q24(config.lag) * v2), 16777216, point.wheel_rate);
    expect_near(60, q24(config.lean[0]) * v + q24(config.lean[1]) * v1, 16777216, point.pitch);
    expect_near(60, q24(config.lean[0]) * v1 + q24(config.lean[1]) * v2, 16777216, point.pitch_rate);
    expect_near(60, w, 16777216, point.yaw_rate);
    expect_near(20,
                q16(config.volts[0]) * v + q16(config.volts[1]) * v1 + q16(config.volts[2]) * v2 +
                    q16(config.volts[3]) * v3,
                65536, point.common);
    expect_near(20, q16(config.turning[0]) * w + q16(config.turning[1]) * w1, 65536, point.difference);
}

static void expect_piece(const struct jp_waypoint_motion *from, const struct jp_waypoint_motion *to,
                         uint32_t set_points)
{
    for (uint32_t i = 0; i < set_points; i++) {
        advance(1);
        expect_blend(from, to, (double)JP_TICKS_PER_SET_POINT * set_points / config.tick_rate, (double)i / set_points);
    }
}

static void test_pieces_are_the_polynomials(void)
{
    const struct jp_waypoint_motion first = {legs[0].heading, 0, legs[0].speed};
    const struct jp_waypoint_motion second = {legs[1].heading, 0, legs[1].speed};

    trajectory.start = (struct jp_waypoint_motion){JP_ANGLE_DEGREES(-5), JP_Q24(-0.05), JP_Q24(0.1)};
    begin();
    expect_piece(&trajectory.start, &first, legs[0].begin.set_points);
    expect_piece(&first, &first, legs[0].middle.set_points);
    expect_piece(&first, &legs[0].next, legs[0].end.set_points);
    expect_piece(&legs[0].next, &second, legs[1].begin.set_points);
    expect_piece(&second, &second, legs[1].middle.set_points);
    expect_piece(&second, &legs[1].next, legs[1].end.set_points);
    TEST_ASSERT_FALSE(jp_trajectory_advance(&drive, &config, &point));
}

static void expect_motion(const struct jp_waypoint_motion *motion)
{
    advance(1);
    TEST_ASSERT_INT32_WITHIN(2, jp_q24_multiply(config.turns_per_metre, motion->speed), point.wheel_rate);
    TEST_ASSERT_INT32_WITHIN(2, jp_q24_multiply(config.lean[0], motion->speed), point.pitch);
    TEST_ASSERT_INT32_WITHIN(2, motion->turn_rate, point.yaw_rate);
    TEST_ASSERT_INT32_WITHIN(2, 0, point.pitch_rate);
}

static void test_pieces_begin_with_the_motions_of_the_legs(void)
{
    const struct jp_waypoint_motion middle = {legs[0].heading, 0, legs[0].speed};

    begin();
    expect_motion(&trajectory.start);
    advance(legs[0].begin.set_points - 1);
    expect_motion(&middle);
    advance(legs[0].middle.set_points - 1);
    expect_motion(&middle);
    advance(legs[0].end.set_points - 1);
    expect_motion(&legs[0].next);
}

static void test_headings_are_those_of_the_legs(void)
{
    const uint32_t set_points[] = {800, 800, 701, 600};
    const jp_angle headings[] = {legs[0].heading, legs[0].next.heading, legs[1].heading, legs[1].heading};
    int64_t turned = 0; /* twice 2⁻²⁴ turn by set_points */
    jp_turns_per_s before = 0;

    begin();
    advance(1);
    for (int i = 0; i < 4; i++) {
        for (uint32_t k = 0; k < set_points[i]; k++) {
            before = point.yaw_rate;
            if (jp_trajectory_advance(&drive, &config, &point)) {
                turned += (int64_t)before + point.yaw_rate;
            }
        }
        /* 2⁻³² turn: 256/2 by the set-points a second of it, within a thousandth of a degree. */
        TEST_ASSERT_INT32_WITHIN(12000, (int32_t)headings[i],
                                 (int32_t)(turned * 128 * JP_TICKS_PER_SET_POINT / config.tick_rate));
    }
}

static void test_counts_legs_and_ends(void)
{
    begin();
    TEST_ASSERT_EQUAL_UINT16(0, jp_trajectory_leg_now(&drive));
    advance(1599);
    TEST_ASSERT_EQUAL_UINT16(0, jp_trajectory_leg_now(&drive));
    advance(1);
    TEST_ASSERT_EQUAL_UINT16(1, jp_trajectory_leg_now(&drive));
    advance(1300);
    TEST_ASSERT_EQUAL_UINT16(1, jp_trajectory_leg_now(&drive));
    advance(1);
    TEST_ASSERT_EQUAL_UINT16(2, jp_trajectory_leg_now(&drive));

    const struct jp_set_point last = point;

    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_FALSE(jp_trajectory_advance(&drive, &config, &point));
        TEST_ASSERT_EQUAL_MEMORY(&last, &point, sizeof last);
    }
}

static void test_blends_of_one_tick(void)
{
    trajectory.count = 1;
    trajectory.start.speed = JP_Q24(0.5);
    trajectory.start.heading = legs[0].heading;
    legs[0].begin.set_points = 1;
    legs[0].middle.set_points = 1;
    legs[0].end.set_points = 1;
    legs[0].next = (struct jp_waypoint_motion){legs[0].heading, 0, JP_Q24(0.5)};
    begin();
    for (int i = 0; i < 3; i++) {
        expect_motion(&trajectory.start);
        TEST_ASSERT_INT32_WITHIN(2, jp_multiply_shift(config.volts[0], JP_Q24(0.5), 24), point.common);
    }
    TEST_ASSERT_FALSE(jp_trajectory_advance(&drive, &config, &point));
}

/* Polynomials that no configuration of a robot gives do not wrap. */
static void test_blends_saturate(void)
{
    const struct jp_blend blend = {.wheel_rate = {INT32_MAX, INT32_MAX, INT32_MAX},
                                   .pitch = {INT32_MIN, INT32_MIN, INT32_MIN},
                                   .common = {INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX, INT32_MIN},
                                   .yaw_rate = {INT32_MAX, INT32_MAX, INT32_MAX},
                                   .difference = {INT32_MIN, INT32_MIN, INT32_MIN}};
    const int32_t third = (int32_t)((1 << 30) / 3);

    jp_blend_at(&blend, third, &point);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, point.wheel_rate);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, point.pitch);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, point.common);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, point.yaw_rate);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, point.difference);
}

static void test_a_very_long_middle(void)
{
    legs[0].middle.set_points = UINT32_MAX;
    begin();
    advance(legs[0].begin.set_points + 1000);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX - 1000U, drive.internal.set_points_left);
    TEST_ASSERT_EQUAL_INT32(jp_q24_multiply(config.turns_per_metre, legs[0].speed), point.wheel_rate);
    TEST_ASSERT_EQUAL_INT32(0, point.yaw_rate);
}

/* ---- Modes ---- */

/* One leg at constant speed, so that only the mode changes. */
static void begin_mode(unsigned mode, jp_q24 value)
{
    trajectory = (struct jp_trajectory){.legs = legs, .places = 1, .count = 1};
    legs[0] = (struct jp_trajectory_leg){
        .begin = {.set_points = 1}, .middle = {.set_points = 100000}, .end = {.set_points = 1}};
    trajectory.transient[mode] = value * 16; /* Q28 */
    begin();
}

static void test_modes_decay_at_their_rates(void)
{
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        config.modes.keep[i] = 2132649903; /* 2^-0.01: a half in 100 set-points */
        begin_mode(i, JP_Q24(1));
        for (int halving = 0; halving < 8; halving++) {
            advance(1);
            TEST_ASSERT_INT32_WITHIN(1000, config.turns_per_metre >> halving, point.wheel_rate);
            TEST_ASSERT_INT32_WITHIN(2000, config.modes.lean[i] >> halving, point.pitch);
            TEST_ASSERT_INT32_WITHIN(2000, config.modes.lean_rate[i] >> halving, point.pitch_rate);
            TEST_ASSERT_INT32_WITHIN(300, config.modes.volts[i] >> halving, point.common);
            TEST_ASSERT_EQUAL_INT32(0, point.difference);
            advance(99);
        }
    }
}

/* Rounding would hold one at half a step by what it loses in a tick. */
static void test_modes_decay_to_nothing(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        config.modes.keep[0] = 2145995633; /* 2^-0.001 */
        begin_mode(0, sign * JP_Q24(0.5));
        advance(25000);
        TEST_ASSERT_EQUAL_INT32(0, point.wheel_rate);
        TEST_ASSERT_EQUAL_INT32(0, drive.internal.mode[0]);
    }
}

/* ---- Its duration ---- */

static enum jp_status duration_of(uint16_t leg_count, uint32_t middle, jp_q16 *seconds)
{
    static struct jp_trajectory_leg row[2];
    const struct jp_trajectory timed = {.legs = row, .places = 2, .count = leg_count};
    struct jp_trajectory_config at = {.tick_rate = 1000};

    for (int i = 0; i < 2; i++) {
        row[i].begin.set_points = 100;
        row[i].middle.set_points = middle;
        row[i].end.set_points = 50;
    }
    return jp_trajectory_duration(&at, &timed, seconds);
}

static void test_duration(void)
{
    jp_q16 seconds = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, duration_of(1, 350, &seconds));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(1), seconds);
    TEST_ASSERT_EQUAL_INT(JP_OK, duration_of(2, 351, &seconds));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(2.004) + 1, seconds); /* rounded up */
    TEST_ASSERT_EQUAL_INT(JP_OK, duration_of(1, 16383350, &seconds));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(32767), seconds);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, duration_of(1, UINT32_MAX / 2U, &seconds));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, seconds);
}

static void test_duration_refuses_null_pointers(void)
{
    const struct jp_trajectory none = {.count = 0};
    struct jp_trajectory_config at = {.tick_rate = 1000};
    jp_q16 seconds = 0;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_duration(NULL, &none, &seconds));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_duration(&at, NULL, &seconds));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_duration(&at, &none, NULL));
}

/* A part in ten thousand of a bit beyond is the next one. */
static void test_a_duration_is_never_too_short(void)
{
    static const struct jp_trajectory_leg leg = {
        .begin = {.set_points = 100}, .middle = {.set_points = 320}, .end = {.set_points = 50}};
    const struct jp_trajectory timed = {.legs = &leg, .places = 1, .count = 1};
    const struct jp_trajectory_config at = {.tick_rate = 9999};
    jp_q16 seconds = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_duration(&at, &timed, &seconds));
    TEST_ASSERT_EQUAL_INT32(6162, seconds); /* 940/9999 s are 6161.0001 bits */
}
