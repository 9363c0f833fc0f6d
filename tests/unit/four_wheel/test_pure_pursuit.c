/* Pure pursuit: the check, arcs worked out by hand, speed limits, and where on the path the robot is. */
#include <joulepath/pure_pursuit.h>
#include <stddef.h>

#include "tests/support/config_check.h"
#include "unity.h"

#define TOLERANCE JP_Q24(0.0005) /* points stand on a grid of 15 µm */
#define PERIOD    JP_Q24(0.02)
#define EAST      ((jp_angle)0)
#define NORTH     JP_ANGLE_DEGREES(90)
#define WEST      JP_ANGLE_DEGREES(180)
#define SOUTH     JP_ANGLE_DEGREES(270)
#define COUNT(a)  (sizeof(a) / sizeof(a)[0])

/* Lookahead of 1 m at 1 m/s; nothing but the configured speed limits it on a long straight. */
static const struct jp_pure_pursuit_config settings = {
    .speed = JP_Q24(1),
    .lookahead_time = JP_Q24(1),
    .lookahead_min = JP_Q24(0.5),
    .lookahead_max = JP_Q24(2),
    .curvature_max = JP_Q24(4),
    .lateral_acceleration = JP_Q24(2),
    .acceleration = JP_Q24(1),
    .tolerance = JP_Q24(0.05),
};

/* 20 m to the east. */
static const struct jp_point straight[] = {{0, 0}, {JP_Q16(5), 0}, {JP_Q16(10), 0}, {JP_Q16(20), 0}};

static struct jp_pure_pursuit tracker;
static struct jp_twist twist;

static void use(const struct jp_pure_pursuit_config *config)
{
    const char *field = "none";
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pure_pursuit_init(&tracker, config, &field));
}

static void follow(const struct jp_point *path, size_t count)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pure_pursuit_follow(&tracker, path, count));
}

void setUp(void)
{
    use(&settings);
    follow(straight, COUNT(straight));
}

void tearDown(void)
{
}

/* The check */

static enum jp_status init(const struct jp_pure_pursuit_config *tried, const char **field)
{
    return jp_pure_pursuit_init(&tracker, tried, field);
}

static struct jp_pure_pursuit_config config;

/* With room for each lookahead. */
static struct jp_pure_pursuit_config roomy(void)
{
    struct jp_pure_pursuit_config wide = settings;

    wide.lookahead_max = JP_Q24(64);
    return wide;
}

DEFINE_EXPECT_CONFIG_OF(init, roomy())

static void test_init_names_each_field_at_both_limits(void)
{
    config = settings;
    expect_config(NULL);
    RANGE("", speed, JP_Q24(0.01), JP_Q24(16));
    RANGE("", lookahead_time, JP_Q24(0.05), JP_Q24(8));
    RANGE("", lookahead_min, JP_Q24(0.05), JP_Q24(8));
    RANGE("", lookahead_max, settings.lookahead_min, JP_Q24(64));
    RANGE("", curvature_max, JP_Q24(0.01), JP_Q24(16));
    RANGE("", lateral_acceleration, JP_Q24(0.01), JP_Q24(16));
    RANGE("", acceleration, JP_Q24(0.125), JP_Q24(16));
    RANGE("", tolerance, JP_Q24(0.005), JP_Q24(1));
}

static void test_init_wants_pointers(void)
{
    const char *field = "none";
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pure_pursuit_init(NULL, &settings, &field));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pure_pursuit_init(&tracker, NULL, &field));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pure_pursuit_init(&tracker, &settings, NULL));
}

static void test_refused_settings_change_nothing(void)
{
    const char *field = "none";

    config = settings;
    config.speed = 0;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_CONFIG, jp_pure_pursuit_init(&tracker, &config, &field));
    TEST_ASSERT_EQUAL_INT32(settings.speed, tracker.config.speed);
    TEST_ASSERT_NOT_NULL(tracker.path);
}

/* Paths */

static enum jp_status follow_two(jp_q16 x0, jp_q16 y0, jp_q16 x1, jp_q16 y1)
{
    static struct jp_point points[2];
    points[0] = (struct jp_point){x0, y0};
    points[1] = (struct jp_point){x1, y1};
    return jp_pure_pursuit_follow(&tracker, points, 2);
}

static void test_follow_refuses(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pure_pursuit_follow(NULL, straight, COUNT(straight)));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pure_pursuit_follow(&tracker, NULL, COUNT(straight)));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pure_pursuit_follow(&tracker, straight, 1));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pure_pursuit_follow(&tracker, straight, 0));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, follow_two(5, 5, 5, 5));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, follow_two(0, 0, JP_Q16(64) + 1, 0));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, follow_two(0, 0, -JP_Q16(64) - 1, 0));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, follow_two(0, 0, 0, JP_Q16(64) + 1));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, follow_two(0, 0, 0, -JP_Q16(64) - 1));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, follow_two(0, 0, JP_Q16(46), JP_Q16(46)));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, follow_two(INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX));
    TEST_ASSERT_TRUE(tracker.path == straight);
}

static void test_follow_accepts_the_longest_and_the_shortest_chord(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow_two(0, 0, JP_Q16(64), 0));
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow_two(JP_Q16(-20), 0, JP_Q16(-20), -1));
}

/* A refused second chord leaves the old path too. */
static void test_follow_looks_at_every_chord(void)
{
    static const struct jp_point points[] = {{0, 0}, {JP_Q16(1), 0}, {JP_Q16(1), 0}, {JP_Q16(2), 0}};
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pure_pursuit_follow(&tracker, points, COUNT(points)));
    TEST_ASSERT_TRUE(tracker.path == straight);
}

/* Ticks */

static enum jp_status tick(jp_q16 x, jp_q16 y, jp_angle heading, jp_q24 speed)
{
    const struct jp_point position = {x, y};
    return jp_pure_pursuit_tick(&tracker, &position, heading, speed, PERIOD, &twist);
}

static void expect_stopped(enum jp_status expected, enum jp_status status)
{
    TEST_ASSERT_EQUAL_INT32(expected, status);
    TEST_ASSERT_EQUAL_INT32(0, twist.x);
    TEST_ASSERT_EQUAL_INT32(0, twist.y);
    TEST_ASSERT_EQUAL_INT32(0, twist.turn_rate);
}

static void expect_twist(jp_q24 speed, jp_q24 turn_rate)
{
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, speed, twist.x);
    TEST_ASSERT_EQUAL_INT32(0, twist.y);
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, turn_rate, twist.turn_rate);
}

static void test_tick_refuses(void)
{
    const struct jp_point position = {0, 0};
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_pure_pursuit_tick(&tracker, &position, EAST, 0, PERIOD, NULL));
    expect_stopped(JP_ERR_ARGUMENT, jp_pure_pursuit_tick(NULL, &position, EAST, 0, PERIOD, &twist));
    expect_stopped(JP_ERR_ARGUMENT, jp_pure_pursuit_tick(&tracker, NULL, EAST, 0, PERIOD, &twist));
    expect_stopped(JP_ERR_ARGUMENT, jp_pure_pursuit_tick(&tracker, &position, EAST, JP_Q24(16) + 1, PERIOD, &twist));
    expect_stopped(JP_ERR_ARGUMENT, jp_pure_pursuit_tick(&tracker, &position, EAST, -JP_Q24(16) - 1, PERIOD, &twist));
    expect_stopped(JP_ERR_ARGUMENT, jp_pure_pursuit_tick(&tracker, &position, EAST, 0, 0, &twist));
    expect_stopped(JP_ERR_ARGUMENT, jp_pure_pursuit_tick(&tracker, &position, EAST, 0, JP_Q24_ONE + 1, &twist));
}

static void test_without_a_path(void)
{
    use(&settings);
    expect_stopped(JP_ERR_NO_PLAN, tick(0, 0, EAST, 0));
}

static void test_straight_ahead(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(0, 0, EAST, JP_Q24(1)));
    expect_twist(JP_Q24(1), 0);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(7), 0, EAST, JP_Q24(1)));
    expect_twist(JP_Q24(1), 0);
}

/* 0.6 m beside the path with L = 1 m: y = 0.6 to the path's side, κ = 2 · 0.6/1². */
static void test_parallel_to_the_path(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), JP_Q16(-0.6), EAST, JP_Q24(1)));
    expect_twist(JP_Q24(1), JP_Q24(1.2));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), JP_Q16(0.6), EAST, JP_Q24(1)));
    expect_twist(JP_Q24(1), JP_Q24(-1.2));
}

/* On it and 30° off: y = −sin 30°. */
static void test_at_an_angle_to_the_path(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), 0, JP_ANGLE_DEGREES(30), JP_Q24(1)));
    expect_twist(JP_Q24(1), JP_Q24(-1));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), 0, JP_ANGLE_DEGREES(-30), JP_Q24(1)));
    expect_twist(JP_Q24(1), JP_Q24(1));
}

/* L is 0.5 m below 0.5 m/s, and 2 m from 2 m/s: κ = 2 · 0.3/L². */
static void test_lookahead_grows_with_speed_within_its_limits(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), JP_Q16(-0.3), EAST, JP_Q24(0.1)));
    expect_twist(JP_Q24(0.12), JP_Q24(0.12 * 2.4));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), JP_Q16(-0.3), EAST, JP_Q24(-0.1)));
    expect_twist(JP_Q24(-0.08), JP_Q24(-0.08 * 2.4));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), JP_Q16(-0.3), EAST, JP_Q24(0.8)));
    expect_twist(JP_Q24(0.82), JP_Q24(0.82 * 0.9375));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), JP_Q16(-0.3), EAST, JP_Q24(3)));
    expect_twist(JP_Q24(2.98), JP_Q24(2.98 * 0.15));
}

/* 1.5 m off, more than L: towards the foot of the perpendicular. */
static void test_from_farther_than_the_lookahead(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), JP_Q16(-1.5), NORTH, JP_Q24(1)));
    expect_twist(JP_Q24(1), 0);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), JP_Q16(1.5), JP_ANGLE_DEGREES(300), JP_Q24(1)));
    expect_twist(JP_Q24(1), JP_Q24(-0.66667)); /* y = −1.5 sin 30° */
}

static void test_farther_than_the_largest_lookahead(void)
{
    expect_stopped(JP_ERR_OUTSIDE, tick(JP_Q16(2), JP_Q16(-2.1), NORTH, JP_Q24(1)));
    expect_stopped(JP_ERR_OUTSIDE, tick(JP_Q16(-2.1), 0, EAST, JP_Q24(1)));
    expect_stopped(JP_ERR_OUTSIDE, tick(INT32_MIN, INT32_MAX, EAST, JP_Q24(1)));
    expect_stopped(JP_ERR_OUTSIDE, tick(INT32_MAX, INT32_MIN, EAST, JP_Q24(1)));
    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)tracker.passed);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), JP_Q16(-1.9), NORTH, JP_Q24(1)));
}

static void test_before_the_path(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(-1.5), 0, EAST, JP_Q24(1)));
    expect_twist(JP_Q24(1), 0);
}

/* At rest, so that the speed of a tick, 0.02 m/s, lets the curvature be what it is. */
static void test_curvature_is_limited(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), 0, JP_ANGLE_DEGREES(89), 0));
    expect_twist(JP_Q24(0.02), JP_Q24(-0.08));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), 0, JP_ANGLE_DEGREES(-89), 0));
    expect_twist(JP_Q24(0.02), JP_Q24(0.08));
}

/* 2 y/L² would be small there, and 0 the wrong way round. */
static void test_a_path_behind_is_turned_to_as_tightly_as_can_be(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), 0, WEST, 0));
    expect_twist(JP_Q24(0.02), JP_Q24(0.08));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), 0, JP_ANGLE_DEGREES(170), 0));
    expect_twist(JP_Q24(0.02), JP_Q24(-0.08));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), 0, JP_ANGLE_DEGREES(190), 0));
    expect_twist(JP_Q24(0.02), JP_Q24(0.08));
}

/* Speed */

static void test_speed_changes_by_the_acceleration(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), 0, EAST, JP_Q24(0.5)));
    expect_twist(JP_Q24(0.52), 0);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), 0, EAST, JP_Q24(1.5)));
    expect_twist(JP_Q24(1.48), 0);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), 0, EAST, JP_Q24(-0.5)));
    expect_twist(JP_Q24(-0.48), 0);
}

/* κ = 2 · 0.4/0.5² = 3.2 at L = 0.5 m: √(2/3.2) = 0.790569 m/s. Faster, it takes κ = 2/v². */
static void test_speed_in_a_curve(void)
{
    config = settings;
    config.lookahead_max = config.lookahead_min;
    config.acceleration = JP_Q24(16);
    use(&config);
    follow(straight, COUNT(straight));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), JP_Q16(-0.4), EAST, JP_Q24(0.8)));
    expect_twist(JP_Q24(0.790569), JP_Q24(2.529822));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), JP_Q16(-0.4), EAST, JP_Q24(2.32)));
    expect_twist(JP_Q24(2), JP_Q24(1));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), JP_Q16(0.4), EAST, JP_Q24(2.32)));
    expect_twist(JP_Q24(2), JP_Q24(-1));
}

/* v² + 2 v · 0.02 = 2 · 0.5: 0.5 m before the end of the path. */
static void test_speed_that_stops_at_the_end(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(9.5), 0, EAST, JP_Q24(1)));
    expect_twist(JP_Q24(1), 0);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(19.5), 0, EAST, JP_Q24(0.98)));
    expect_twist(JP_Q24(0.9802), 0);
}

static void test_fast_robots_are_not_limited_far_from_the_end(void)
{
    static struct jp_point points[40];
    config = settings;
    config.speed = JP_Q24(16);
    config.lookahead_max = JP_Q24(64);
    config.acceleration = JP_Q24(0.125);
    for (int i = 0; i < 40; i++) {
        points[i] = (struct jp_point){JP_Q16(64) * i, 0};
    }
    use(&config);
    follow(points, COUNT(points));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(1), 0, EAST, JP_Q24(16)));
    expect_twist(JP_Q24(16), 0);
}

/* Arrival */

static void test_arrival_stays(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(19.9), 0, EAST, JP_Q24(0.3)));
    expect_stopped(JP_ARRIVED, tick(JP_Q16(19.96), 0, EAST, JP_Q24(0.2)));
    expect_stopped(JP_ARRIVED, tick(JP_Q16(19.9), 0, EAST, 0));
    expect_stopped(JP_ARRIVED, tick(0, 0, EAST, 0));
    follow(straight, COUNT(straight));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(0, 0, EAST, 0));
}

static void test_arrival_past_the_end(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(19.5), 0, EAST, JP_Q24(1)));
    expect_stopped(JP_ARRIVED, tick(JP_Q16(20.2), JP_Q16(0.3), EAST, JP_Q24(0.2)));
}

/* The path goes on along its last chord: beside the end the robot does not turn to the last point. */
static void test_beyond_the_end_the_path_goes_on(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(19.9), JP_Q16(-0.3), EAST, JP_Q24(0.1)));
    expect_twist(JP_Q24(0.12), JP_Q24(0.12 * 2.4));
}

/* Where on the path */

/* A square whose end is its start. */
static const struct jp_point loop[] = {{0, 0}, {JP_Q16(3), 0}, {JP_Q16(3), JP_Q16(3)}, {0, JP_Q16(3)}, {0, 0}};

static void test_a_loop_is_driven_all_round(void)
{
    follow(loop, COUNT(loop));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(0, 0, EAST, JP_Q24(0.5)));
    expect_twist(JP_Q24(0.52), 0);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(3), JP_Q16(0.1), NORTH, JP_Q24(0.5)));
    expect_twist(JP_Q24(0.52), 0);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2.9), JP_Q16(3), WEST, JP_Q24(0.5)));
    expect_twist(JP_Q24(0.52), 0);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(0, JP_Q16(2.9), SOUTH, JP_Q24(0.5)));
    expect_twist(JP_Q24(0.52), 0);
    expect_stopped(JP_ARRIVED, tick(0, JP_Q16(0.04), SOUTH, JP_Q24(0.5)));
}

/* 0.3 m before the corner the circle of 0.5 m meets the next side at 0.4 m: y = 0.4, κ = 2 · 0.4/0.25. */
static void test_a_corner_is_cut(void)
{
    follow(loop, COUNT(loop));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2.7), 0, EAST, 0));
    expect_twist(JP_Q24(0.02), JP_Q24(0.02 * 3.2));
}

/* Inside the corner the next side is nearer than the one the robot comes from. */
static void test_the_nearest_side_of_a_corner_counts(void)
{
    follow(loop, COUNT(loop));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2.9), JP_Q16(0.3), NORTH, 0));
    TEST_ASSERT_EQUAL_UINT32(1, (uint32_t)tracker.passed);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2.7), JP_Q16(0.1), NORTH, 0));
    TEST_ASSERT_EQUAL_UINT32(1, (uint32_t)tracker.passed);
}

/* A robot that was moved finds the nearest chord ahead. */
static void test_a_leap_ahead(void)
{
    follow(loop, COUNT(loop));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(1.5), JP_Q16(4), SOUTH, 0));
    TEST_ASSERT_EQUAL_UINT32(2, (uint32_t)tracker.passed);
}

/* Points 1 mm apart: a tick passes JP_PURSUIT_STRIDE of them and looks JP_PURSUIT_AHEAD ahead. */
static void test_dense_points(void)
{
    static struct jp_point points[1000];
    for (int i = 0; i < 1000; i++) {
        points[i] = (struct jp_point){i * 66, 0};
    }
    follow(points, COUNT(points));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(0.1), JP_Q16(-0.3), EAST, 0));
    TEST_ASSERT_EQUAL_UINT32(JP_PURSUIT_STRIDE, (uint32_t)tracker.passed);
    expect_twist(JP_Q24(0.02), JP_Q24(0.02 * 2.4));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(0.1), JP_Q16(-0.3), EAST, 0));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(0.1), JP_Q16(-0.3), EAST, 0));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(0.1), JP_Q16(-0.3), EAST, 0));
    TEST_ASSERT_EQUAL_UINT32(99, (uint32_t)tracker.passed);
    /* 999 · 66 units are 1.006 m, less the tenth that is passed; each chord is a whole number of units */
    TEST_ASSERT_TRUE(tracker.beyond == (int64_t)899 * 66 * 256);
}

/* The same 30 km to the south-west and to the north-east. */
static void test_far_from_the_origin(void)
{
    static const jp_q16 places[] = {JP_Q16(-30000), JP_Q16(30000)};
    for (size_t i = 0; i < COUNT(places); i++) {
        const jp_q16 far = places[i];
        TEST_ASSERT_EQUAL_INT32(JP_OK, follow_two(far, far, far + JP_Q16(10), far));
        TEST_ASSERT_EQUAL_INT32(JP_OK, tick(far + JP_Q16(2), far - JP_Q16(0.6), EAST, JP_Q24(1)));
        expect_twist(JP_Q24(1), JP_Q24(1.2));
    }
}

static uint32_t hashed(uint32_t hash, int32_t value)
{
    return (hash ^ (uint32_t)value) * 16777619U; /* FNV-1a by words */
}

/* Whole drive in integers, with the speed as it was asked for: on a circle of 2 m, chords of 6°. The same bits on every
 * core and compiler. */
static void test_drives_along_a_circle(void)
{
    static struct jp_point points[61];
    int64_t x = 0;
    int64_t y = -(int64_t)JP_Q24(2) * 256; /* m in Q32 */
    jp_angle heading = EAST;
    jp_q24 speed = 0;
    int ticks = 0;
    uint32_t hash = 2166136261U;
    enum jp_status status;
    struct jp_point position = {0, JP_Q16(-2)};

    for (int i = 0; i < 61; i++) {
        const jp_angle angle = JP_ANGLE_DEGREES(6) * (jp_angle)i;
        points[i] = (struct jp_point){jp_multiply_shift(JP_Q16(2), jp_sin(angle), 31),
                                      -jp_multiply_shift(JP_Q16(2), jp_cos(angle), 31)};
    }
    follow(points, COUNT(points));
    while ((status = jp_pure_pursuit_tick(&tracker, &position, heading, speed, PERIOD, &twist)) == JP_OK) {
        const jp_q24 moved = jp_q24_multiply(twist.x, PERIOD);
        heading += jp_angle_from_radians(jp_q24_multiply(twist.turn_rate, PERIOD));
        hash = hashed(hashed(hash, twist.x), twist.turn_rate);
        speed = twist.x;
        x += jp_multiply(moved, jp_cos(heading)) >> 23;
        y += jp_multiply(moved, jp_sin(heading)) >> 23;
        position = (struct jp_point){(jp_q16)(x >> 16), (jp_q16)(y >> 16)};
        const uint64_t square = (uint64_t)((x >> 16) * (x >> 16)) + (uint64_t)((y >> 16) * (y >> 16));
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.08), JP_Q16(2), (int32_t)jp_square_root(square));
        ticks++;
    }
    TEST_ASSERT_EQUAL_INT32(JP_ARRIVED, status);
    TEST_ASSERT_INT32_WITHIN(60, 690, ticks); /* 12.6 m at 1 m/s, a second more to start and to stop */
    TEST_ASSERT_EQUAL_HEX32(0xDCB2354F, hash);
}

/* The corner is just where the lookahead ends: the way there is straight. */
static void test_a_corner_at_the_lookahead_is_not_beyond_it(void)
{
    static const struct jp_point hook[] = {{0, 0}, {JP_Q16(1), 0}, {JP_Q16(0.5), JP_Q16(1)}};

    follow(hook, COUNT(hook));
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(0, 0, EAST, JP_Q24(1)));
    TEST_ASSERT_EQUAL_INT32(0, twist.turn_rate);
    TEST_ASSERT_GREATER_THAN_INT32(0, twist.x);
}

/* Right beside the robot: the arc through it has half the distance as its radius. */
static void test_a_target_right_beside(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), 0, NORTH, JP_Q24(1)));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), -2 * twist.x, twist.turn_rate);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(2), 0, SOUTH, JP_Q24(1)));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), 2 * twist.x, twist.turn_rate);
}

/* What lies behind the last point in the memory is not of the path. */
static void test_a_path_ends_with_its_last_point(void)
{
    static const struct jp_point more[] = {{0, 0},           {JP_Q16(2), 0},  {JP_Q16(4), 0}, {JP_Q16(4), JP_Q16(0.6)},
                                           {0, JP_Q16(0.6)}, {0, JP_Q16(0.7)}};
    struct jp_twist alone;

    follow(more, 3);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(3.7), JP_Q16(0.5), EAST, JP_Q24(1)));
    alone = twist;
    TEST_ASSERT_LESS_THAN_INT32(0, alone.turn_rate);
    follow(&more[1], 2);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(3.7), JP_Q16(0.5), EAST, JP_Q24(1)));
    TEST_ASSERT_EQUAL_INT32(alone.x, twist.x);
    TEST_ASSERT_EQUAL_INT32(alone.turn_rate, twist.turn_rate);
}

static void test_the_shortest_period(void)
{
    const struct jp_point position = {0, 0};

    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pure_pursuit_tick(&tracker, &position, EAST, JP_Q24(0.5), 1, &twist));
}

/* As near as the tolerance it has arrived, and not before. */
static void test_arrives_at_the_tolerance(void)
{
    config = settings;
    config.tolerance = JP_Q24(0.0625);
    use(&config);
    follow(&straight[2], 2);
    TEST_ASSERT_EQUAL_INT32(JP_OK, tick(JP_Q16(19.9375) - 1, 0, EAST, JP_Q24(0.1)));
    TEST_ASSERT_GREATER_THAN_INT32(0, twist.x);
    (void)tick(JP_Q16(19.9375), 0, EAST, JP_Q24(0.1));
    TEST_ASSERT_EQUAL_INT32(0, twist.x);
}
