/* What part of a turn a glide takes, by the steering limit and the length of the way. */
#include "src/local/patrol_glide.h"

#include "src/local/patrol_price.h"
#include "tests/support/patrol_rig.h"

#define DEGREE (JP_PLANE_PI / 180.0f)

void setUp(void)
{
    rig_reset();
    patrol.config = rig_config();
}

void tearDown(void)
{
}

static void limit_steering(unsigned degrees)
{
    patrol.config.wheels.steering_limit = (int32_t)((uint64_t)degrees * UINT32_MAX / 360U);
}

/* A wheel that is steered by less than a quarter turn keeps 0.25 rad from its limit; beyond that the way must not lead
 * a wheel to where it would rather roll backwards. */
static void test_how_far_askew_a_glide_begins(void)
{
    for (unsigned degrees = 30; degrees < 130U; degrees += 5U) {
        const float limit = (float)degrees * DEGREE;
        const float by_limit = limit - 0.1f - 0.15f;
        const float by_backwards = JP_PLANE_PI - (limit - 0.1f) - 0.1f - 0.04f;

        limit_steering(degrees);
        TEST_ASSERT_NEAR(1.0e-4f, jp_plane_smaller(by_limit, by_backwards), jp_patrol_askew_max(&patrol.config));
    }
}

/* 0.6 m for each radian at least, as far as wheels can be askew, to either side. */
static void test_a_glide_into_a_goal_turns_by_its_length(void)
{
    const float most = jp_patrol_askew_max(&patrol.config);

    for (int i = -20; i <= 20; i++) {
        const float angle = 0.1f * (float)i;

        for (int k = -1; k < 12; k++) {
            const float length = 0.1f * (float)k;
            const float allowed = jp_plane_smaller(most, jp_plane_larger(length, 0.0f) / 0.6f);
            const float expected = jp_plane_clamp(angle, -allowed, allowed);

            TEST_ASSERT_NEAR(1.0e-5f, expected, jp_patrol_glide_in_part(&patrol.config, angle, length));
        }
    }
}

static void test_a_glide_from_a_stand_takes_a_way_for_each_radian(void)
{
    for (int i = -10; i <= 10; i++) {
        const float part = 0.1f * (float)i;

        TEST_ASSERT_NEAR(1.0e-5f, 0.09f * (float)(i < 0 ? -i : i), jp_patrol_set_off_length(part));
    }
}

/* What is left of an angle, but for what a turn to the way may be off by. */
static void test_what_is_left_to_turn_in_place(void)
{
    patrol.config.heading_tolerance = 0.3f;
    TEST_ASSERT_NEAR(1.0e-5f, 0.4f, jp_patrol_set_off_rest(&patrol.config, 1.2f, 0.8f));
    TEST_ASSERT_NEAR(1.0e-5f, 0.4f, jp_patrol_set_off_rest(&patrol.config, -1.2f, -0.8f));
    TEST_ASSERT_NEAR(1.0e-5f, 0.31f, jp_patrol_set_off_rest(&patrol.config, 0.31f, 0.0f));
    TEST_ASSERT_NEAR(1.0e-5f, 0.0f, jp_patrol_set_off_rest(&patrol.config, 0.29f, 0.0f));
    TEST_ASSERT_NEAR(1.0e-5f, 0.0f, jp_patrol_set_off_rest(&patrol.config, -1.0f, -0.8f));
}

static float price_of(float angle, float part)
{
    const float rest = jp_patrol_set_off_rest(&patrol.config, angle, part);

    return jp_patrol_turn_price(&patrol.config, rest) +
           jp_patrol_steering_price(&patrol.config, jp_plane_magnitude(part), rest > 0.0f);
}

/* Of nothing, all that it can, and what wheels that have turned in place stand askew, the cheapest. */
static void test_the_part_that_it_glides_is_the_cheapest(void)
{
    unsigned parts[3] = {0, 0, 0};

    for (int i = -31; i <= 31; i++) {
        for (unsigned k = 0; k < 3U; k++) {
            const float angle = 0.1f * (float)i;
            float most;
            float alike;
            float chosen;
            float least;

            setUp();
            patrol.config.price.turning = k == 0U ? 3.0f : 0.1f;
            patrol.config.price.steering = k == 2U ? 60.0f : 9.0f;
            most = jp_patrol_askew_max(&patrol.config);
            most = jp_plane_clamp(angle, -most, most);
            alike = jp_patrol_in_place(&patrol.config);
            alike = jp_plane_clamp(most, -alike, alike);
            least = jp_plane_smaller(price_of(angle, 0.0f),
                                     jp_plane_smaller(price_of(angle, most), price_of(angle, alike)));
            chosen = jp_patrol_set_off_part(&patrol.config, angle);
            TEST_ASSERT_NEAR(1.0e-4f, least, price_of(angle, chosen));
            parts[chosen == 0.0f ? 0 : chosen == most ? 1 : 2]++;
        }
    }
    TEST_ASSERT_TRUE(parts[0] > 0U && parts[1] > 0U);
}
