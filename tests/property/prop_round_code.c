/* Rounds as bytes, for random ones: what is read is what was written to the step of the bytes, and reading what it
 * wrote again changes no bit; any bytes are a round that is taken, or whose field is named. */
#include <math.h>
#include <string.h>

#include "hal/can/round_code.h"
#include "sim/base/random.h"
#include "unity.h"

enum { CASES = 2000 };

static struct random source;

void setUp(void)
{
    random_init(&source, 41);
}

void tearDown(void)
{
}

static float draw(double low, double high)
{
    return (float)random_uniform(&source, low, high);
}

static struct jp_plane_pose draw_pose(void)
{
    return (struct jp_plane_pose){draw(-300, 300), draw(-300, 300), draw(-20, 20)};
}

static struct jp_patrol_round_config draw_round(void)
{
    struct jp_patrol_round_config config = {.stop_count = (uint16_t)random_uniform(&source, 1, 15.99),
                                            .charger = draw_pose(),
                                            .full = draw(1, 3e6),
                                            .reserve = draw(0, 3e5),
                                            .deviations = draw(0, 10)};

    for (uint16_t i = 0; i < config.stop_count; i++) {
        config.stops[i] = (struct jp_patrol_stop){draw_pose(), draw(0, 86400)};
    }
    return config;
}

static void expect_near(float expected, float found, double step)
{
    /* A number in single precision has 24 bits, too. */
    const double allowed = step + fabs((double)expected) * 0x1p-22;

    TEST_ASSERT_TRUE(fabs((double)expected - (double)found) <= allowed);
}

static void expect_pose(const struct jp_plane_pose *expected, const struct jp_plane_pose *found)
{
    const double turned = remainder((double)expected->heading - (double)found->heading, 2 * M_PI);

    expect_near(expected->x, found->x, 0x1p-16);
    expect_near(expected->y, found->y, 0x1p-16);
    TEST_ASSERT_TRUE(fabs(turned) < 1e-5);
    TEST_ASSERT_TRUE(fabs((double)found->heading) <= M_PI + 1e-6);
}

static void test_what_is_read_is_what_was_written(void)
{
    for (int k = 0; k < CASES; k++) {
        const struct jp_patrol_round_config config = draw_round();
        struct jp_patrol_round_config found;
        uint8_t bytes[JP_ROUND_BYTES_MAX] = {0};
        const char *field;

        jp_round_encode(&config, bytes);
        jp_round_decode(bytes, (uint8_t)config.stop_count, &found);
        TEST_ASSERT_EQUAL_UINT16(config.stop_count, found.stop_count);
        expect_pose(&config.charger, &found.charger);
        expect_near(config.full, found.full, 0x1p-4);
        expect_near(config.reserve, found.reserve, 0x1p-4);
        expect_near(config.deviations, found.deviations, 0x1p-16);
        for (uint16_t i = 0; i < config.stop_count; i++) {
            expect_pose(&config.stops[i].pose, &found.stops[i].pose);
            expect_near(config.stops[i].dwell, found.stops[i].dwell, 0x1p-8);
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_round_check(&found, &field));
    }
}

static void test_any_bytes_are_a_round_or_a_named_field(void)
{
    int taken = 0;

    for (int k = 0; k < CASES; k++) {
        struct jp_patrol_round_config config;
        uint8_t bytes[JP_ROUND_BYTES_MAX];
        const char *field = NULL;

        for (unsigned i = 0; i < sizeof bytes; i++) {
            bytes[i] = (uint8_t)random_uniform(&source, 0, 255.99);
        }
        bytes[22] = bytes[23] = 0; /* else hardly any deviations are in range */
        for (unsigned i = 0; i < JP_ROUND_STOPS_MAX; i++) {
            bytes[JP_ROUND_BYTES(i) + 15U] = 0; /* nor stays */
        }
        jp_round_decode(bytes, (uint8_t)(1 + k % 15), &config);
        if (jp_patrol_round_check(&config, &field) == JP_OK) {
            taken++;
        } else {
            TEST_ASSERT_NOT_NULL(field);
        }
    }
    TEST_ASSERT_TRUE(taken > CASES / 2);
}

static void test_more_than_the_bytes_hold_is_saturated(void)
{
    const struct jp_patrol_round_config config = {
        .stops = {{{40000.0f, -40000.0f, 3.1415926f}, 2e7f}}, .stop_count = 1, .full = 1e9f, .deviations = 1.0f};
    struct jp_patrol_round_config found;
    uint8_t bytes[JP_ROUND_BYTES_MAX];

    jp_round_encode(&config, bytes);
    jp_round_decode(bytes, 1, &found);
    expect_near(32768.0f, found.stops[0].pose.x, 0.01);
    expect_near(-32768.0f, found.stops[0].pose.y, 0.01);
    expect_near(16777216.0f, found.stops[0].dwell, 1);
    expect_near(268435456.0f, found.full, 16);
    TEST_ASSERT_TRUE(fabs(remainder((double)found.stops[0].pose.heading - M_PI, 2 * M_PI)) < 1e-5);
}
