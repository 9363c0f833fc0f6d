/* Pieces that were driven, by the encoders: their ends, their length, slope and steering. */
#include <joulepath/four_wheel_trip.h>
#include <stddef.h>

#include "tests/support/config_check.h"
#include "unity.h"

#define DEGREES(x) ((int32_t)JP_ANGLE_DEGREES(x))

static const struct jp_four_wheel_trip_config usual = {
    .wheels = {.wheelbase = JP_Q24(0.6),
               .track = JP_Q24(0.8),
               .steering_limit = DEGREES(100),
               .steering_step = DEGREES(2),
               .speed_max = JP_Q24(4),
               .speed_step = JP_Q24(0.05)},
    .tick_rate = 100,
    .piece_ticks = 20,
};

static struct jp_four_wheel_trip_config config;
static struct jp_four_wheel_trip trip;
static struct jp_four_wheel_piece piece;
static const char *refused;

void setUp(void)
{
    config = usual;
    piece = (struct jp_four_wheel_piece){.duration = -1};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_trip_init(&trip, &config, &refused));
}

void tearDown(void)
{
}

static enum jp_status check(const struct jp_four_wheel_trip_config *of, const char **field)
{
    return jp_four_wheel_trip_init(&trip, of, field);
}

DEFINE_EXPECT_CONFIG_OF(check, usual)

static void test_the_configuration_is_checked(void)
{
    expect_config(NULL);
    RANGE("four_wheel_trip.", tick_rate, 10, 10000);
    RANGE("four_wheel_trip.", piece_ticks, 1, 1000);
    config.tick_rate = 20;
    config.piece_ticks = 500;
    expect_config(NULL);
    config.tick_rate = 20;
    config.piece_ticks = 501;
    expect_config("four_wheel_trip.piece_ticks");
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_trip_init(NULL, &usual, &refused));
}

static struct jp_wheels straight(jp_q24 speed)
{
    return (struct jp_wheels){{0}, {speed, speed, speed, speed}};
}

static bool tick(const struct jp_wheels *wheels)
{
    return jp_four_wheel_trip_tick(&trip, wheels, JP_Q24(0.1), -JP_Q24(0.05), &piece);
}

static void test_a_piece_has_the_motion_of_its_ends(void)
{
    for (int i = 0; i < 20; i++) {
        const struct jp_wheels wheels = straight(i * JP_Q24(0.01));

        TEST_ASSERT_FALSE(tick(&wheels));
    }
    const struct jp_wheels wheels = straight(JP_Q24(0.2));

    TEST_ASSERT_TRUE(tick(&wheels));
    TEST_ASSERT_INT32_WITHIN(16, 0, piece.start.x);
    TEST_ASSERT_INT32_WITHIN(16, JP_Q24(0.2), piece.end.x);
    TEST_ASSERT_INT32_WITHIN(16, 0, piece.end.turn_rate);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.1), piece.grade);
    TEST_ASSERT_EQUAL_INT32(-JP_Q24(0.05), piece.bank);
    TEST_ASSERT_EQUAL_INT32(0, piece.travel);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.2), piece.duration);
}

static void test_the_next_piece_begins_where_one_ends(void)
{
    const struct jp_wheels slow = straight(JP_Q24(0.1));
    const struct jp_wheels fast = straight(JP_Q24(0.3));

    for (int i = 0; i < 21; i++) {
        (void)tick(&slow);
    }
    for (int i = 0; i < 19; i++) {
        TEST_ASSERT_FALSE(tick(&fast));
    }
    TEST_ASSERT_TRUE(tick(&fast));
    TEST_ASSERT_INT32_WITHIN(16, JP_Q24(0.1), piece.start.x);
    TEST_ASSERT_INT32_WITHIN(16, JP_Q24(0.3), piece.end.x);
}

/* Nothing of a piece is left in the next one, however it ended. */
static void test_pieces_alike_are_alike(void)
{
    struct jp_wheels wheels = straight(JP_Q24(0.3));
    struct jp_four_wheel_piece first;

    (void)tick(&wheels);
    for (int i = 0; i < 20; i++) {
        wheels.angle[1] = i % 2 == 0 ? DEGREES(1) : 0;
        (void)tick(&wheels);
    }
    first = piece;
    TEST_ASSERT_INT32_WITHIN(16, JP_Q16(20 * 6.283185307 / 360), first.travel);
    for (int i = 0; i < 20; i++) {
        wheels.angle[1] = i % 2 == 0 ? DEGREES(1) : 0;
        (void)tick(&wheels);
    }
    TEST_ASSERT_EQUAL_MEMORY(&first, &piece, sizeof piece);
    for (int i = 0; i < 6; i++) {
        wheels.angle[1] = i % 2 == 0 ? DEGREES(1) : 0;
        (void)tick(&wheels);
    }
    TEST_ASSERT_TRUE(jp_four_wheel_trip_end(&trip, &piece));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.06), piece.duration);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.1), piece.grade);
    TEST_ASSERT_EQUAL_INT32(-JP_Q24(0.05), piece.bank);
    wheels = straight(JP_Q24(0.4));
    TEST_ASSERT_FALSE(jp_four_wheel_trip_tick(&trip, &wheels, 0, 0, &piece));
    TEST_ASSERT_TRUE(jp_four_wheel_trip_end(&trip, &piece));
    TEST_ASSERT_EQUAL_INT32(0, piece.grade);
    TEST_ASSERT_EQUAL_INT32(0, piece.bank);
    TEST_ASSERT_INT32_WITHIN(16, JP_Q24(0.4), piece.end.x);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.01), piece.duration);
}

/* Sideways too: wheels at right angles. */
static void test_a_piece_backwards_is_its_mirror_image(void)
{
    for (int i = 0; i < 21; i++) {
        const struct jp_wheels wheels = straight(-JP_Q24(0.01) * i);

        (void)tick(&wheels);
    }
    TEST_ASSERT_INT32_WITHIN(16, 0, piece.start.x);
    TEST_ASSERT_INT32_WITHIN(16, -JP_Q24(0.2), piece.end.x);
    for (int sign = -1; sign <= 1; sign += 2) {
        struct jp_wheels wheels = straight(sign * JP_Q24(0.3));

        setUp();
        for (int k = 0; k < (int)JP_WHEELS; k++) {
            wheels.angle[k] = DEGREES(90);
        }
        for (int i = 0; i < 21; i++) {
            (void)tick(&wheels);
        }
        TEST_ASSERT_INT32_WITHIN(16, 0, piece.end.x);
        TEST_ASSERT_INT32_WITHIN(16, sign * JP_Q24(0.3), piece.end.y);
    }
}

/* Wheel by wheel, either way. */
static void test_steering_travel_is_summed_up(void)
{
    struct jp_wheels wheels = straight(0);

    (void)tick(&wheels);
    wheels.angle[JP_FRONT_LEFT] = DEGREES(90);
    wheels.angle[JP_REAR_RIGHT] = -DEGREES(45);
    (void)tick(&wheels);
    wheels.angle[JP_FRONT_LEFT] = DEGREES(45);
    (void)tick(&wheels);
    TEST_ASSERT_TRUE(jp_four_wheel_trip_end(&trip, &piece));
    TEST_ASSERT_INT32_WITHIN(8, JP_Q16(3.14159265), piece.travel);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.02), piece.duration);
}

static void test_what_exceeds_the_formats_is_limited(void)
{
    struct jp_wheels wheels = straight(JP_Q24(16));

    config.tick_rate = 100;
    config.piece_ticks = 1000;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_trip_init(&trip, &config, &refused));
    for (int i = 0; i < 200; i++) {
        wheels.angle[0] = i % 2 == 0 ? DEGREES(100) : -DEGREES(100);
        (void)tick(&wheels);
    }
    TEST_ASSERT_TRUE(jp_four_wheel_trip_end(&trip, &piece));
    TEST_ASSERT_EQUAL_INT32(JP_Q24(8), piece.end.x);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(256), piece.travel);
}

static void test_nothing_to_end(void)
{
    const struct jp_wheels wheels = straight(0);

    TEST_ASSERT_FALSE(jp_four_wheel_trip_end(&trip, &piece));
    (void)tick(&wheels);
    TEST_ASSERT_FALSE(jp_four_wheel_trip_end(&trip, &piece));
    TEST_ASSERT_EQUAL_INT32(-1, piece.duration);
}

/* Where the wheels stand when a trip begins is no way that they were steered. */
static void test_a_trip_begins_with_the_wheels_as_they_stand(void)
{
    struct jp_wheels wheels = straight(JP_Q24(0.3));

    wheels.angle[0] = DEGREES(45);
    (void)tick(&wheels);
    (void)tick(&wheels);
    TEST_ASSERT_TRUE(jp_four_wheel_trip_end(&trip, &piece));
    TEST_ASSERT_EQUAL_INT32(0, piece.travel);
}
