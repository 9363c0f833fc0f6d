/* Single-precision arithmetic of the plane: angles wrap, and sines have the same bits everywhere. */
#include "src/base/plane.h"

#include "tests/support/near.h"

#define ANGLE_MAX 1000.0f

enum { SAMPLES = 20001 };

void setUp(void)
{
}

void tearDown(void)
{
}

static float sample(int index)
{
    return ANGLE_MAX * ((float)index / (SAMPLES / 2) - 1.0f);
}

static void test_angles_within_half_a_turn_stay(void)
{
    const float angles[] = {0.0f, 1.0f, -1.0f, JP_PLANE_PI, -JP_PLANE_PI, 3.0f};

    for (unsigned i = 0; i < sizeof angles / sizeof angles[0]; i++) {
        TEST_ASSERT_TRUE(jp_plane_wrap(angles[i]) == angles[i]);
    }
}

static void test_angles_wrap_by_whole_turns(void)
{
    TEST_ASSERT_NEAR(1e-6f, 4.0f - 6.28318531f, jp_plane_wrap(4.0f));
    TEST_ASSERT_NEAR(1e-6f, 6.28318531f - 4.0f, jp_plane_wrap(-4.0f));
    TEST_ASSERT_NEAR(1e-6f, 0.973535f, jp_plane_wrap(1000.0f)); /* 1 000 − 159 · 2π */
    TEST_ASSERT_NEAR(1e-6f, -0.973535f, jp_plane_wrap(-1000.0f));
}

static void test_no_wrapped_angle_is_beyond_half_a_turn(void)
{
    const float beyond = JP_PLANE_PI + 1.0e-6f;

    for (int i = 0; i < SAMPLES; i++) {
        const float angle = jp_plane_wrap(sample(i));

        TEST_ASSERT_TRUE(angle >= -beyond && angle <= beyond);
    }
}

static void test_sines_of_known_angles(void)
{
    TEST_ASSERT_NEAR(1e-6f, 0.0f, jp_plane_sine(0.0f));
    TEST_ASSERT_NEAR(1e-6f, 1.0f, jp_plane_cosine(0.0f));
    TEST_ASSERT_NEAR(1e-6f, 0.479425539f, jp_plane_sine(0.5f));
    TEST_ASSERT_NEAR(1e-6f, 0.877582562f, jp_plane_cosine(0.5f));
    TEST_ASSERT_NEAR(1e-6f, -0.479425539f, jp_plane_sine(-0.5f));
    TEST_ASSERT_NEAR(1e-6f, 0.0f, jp_plane_sine(JP_PLANE_PI));
    TEST_ASSERT_NEAR(1e-6f, -1.0f, jp_plane_cosine(JP_PLANE_PI));
    TEST_ASSERT_NEAR(1e-6f, -1.0f, jp_plane_cosine(-JP_PLANE_PI));
    TEST_ASSERT_NEAR(2e-6f, 0.826879541f, jp_plane_sine(1000.0f));
    TEST_ASSERT_NEAR(2e-6f, 0.562379076f, jp_plane_cosine(1000.0f));
}

static void test_sine_and_cosine_stand_on_the_unit_circle(void)
{
    for (int i = 0; i < SAMPLES; i++) {
        const float sine = jp_plane_sine(sample(i));
        const float cosine = jp_plane_cosine(sample(i));

        TEST_ASSERT_NEAR(1e-6f, 1.0f, sine * sine + cosine * cosine);
    }
}

static void test_square_root(void)
{
    TEST_ASSERT_TRUE(jp_plane_square_root(0.0f) == 0.0f);
    TEST_ASSERT_TRUE(jp_plane_square_root(2.25f) == 1.5f);
    TEST_ASSERT_TRUE(jp_plane_square_root(2.0f) == 1.41421356f);
}

static void test_length_magnitude_and_limits(void)
{
    TEST_ASSERT_TRUE(jp_plane_length(3.0f, -4.0f) == 5.0f);
    TEST_ASSERT_TRUE(jp_plane_magnitude(-1.5f) == 1.5f);
    TEST_ASSERT_TRUE(jp_plane_magnitude(1.5f) == 1.5f);
    TEST_ASSERT_TRUE(jp_plane_clamp(-2.0f, -1.0f, 1.0f) == -1.0f);
    TEST_ASSERT_TRUE(jp_plane_clamp(0.5f, -1.0f, 1.0f) == 0.5f);
    TEST_ASSERT_TRUE(jp_plane_clamp(2.0f, -1.0f, 1.0f) == 1.0f);
}

static void test_bearings(void)
{
    TEST_ASSERT_TRUE(jp_plane_bearing(0.0f, 0.0f) == 0.0f);
    TEST_ASSERT_TRUE(jp_plane_bearing(-0x1p-120f, 0x1p-110f) == 0.0f);
    TEST_ASSERT_NEAR(1e-6f, 0.5f * JP_PLANE_PI, jp_plane_bearing(0.0f, 0x1p-95f));
    TEST_ASSERT_NEAR(1e-6f, 0.5f * JP_PLANE_PI, jp_plane_bearing(0.0f, 0.001f));
    TEST_ASSERT_NEAR(1e-6f, -0.5f * JP_PLANE_PI, jp_plane_bearing(0.0f, -30000.0f));
    TEST_ASSERT_NEAR(1e-6f, 0.643501109f, jp_plane_bearing(4.0f, 3.0f));
    TEST_ASSERT_NEAR(1e-6f, JP_PLANE_PI - 0.643501109f, jp_plane_bearing(-4.0f, 3.0f));
    for (int i = 0; i < SAMPLES; i++) {
        const struct jp_plane_point direction = jp_plane_direction(sample(i));
        const float difference = jp_plane_wrap(jp_plane_bearing(direction.x, direction.y) - jp_plane_wrap(sample(i)));

        TEST_ASSERT_NEAR(3e-6f, 0.0f, difference);
    }
}

static void test_poses_in_other_frames(void)
{
    const struct jp_plane_pose frame = {1.0f, 2.0f, 0.5f * JP_PLANE_PI};
    const struct jp_plane_pose pose = {0.5f, -0.25f, 3.0f};
    const struct jp_plane_pose composed = jp_plane_compose(&frame, &pose);
    const struct jp_plane_pose back = jp_plane_relative(&frame, &composed);

    TEST_ASSERT_NEAR(1e-6f, 1.25f, composed.x);
    TEST_ASSERT_NEAR(1e-6f, 2.5f, composed.y);
    TEST_ASSERT_NEAR(1e-6f, 3.0f - 1.5f * JP_PLANE_PI, composed.heading);
    TEST_ASSERT_NEAR(1e-6f, pose.x, back.x);
    TEST_ASSERT_NEAR(1e-6f, pose.y, back.y);
    TEST_ASSERT_NEAR(1e-6f, pose.heading, back.heading);
}

static void test_what_is_finite(void)
{
    volatile float large = FLT_MAX; /* the compiler must not see that it overflows */
    const float infinity = large * 2.0f;

    TEST_ASSERT_TRUE(jp_plane_is_finite(0.0f));
    TEST_ASSERT_TRUE(jp_plane_is_finite(FLT_MAX));
    TEST_ASSERT_TRUE(jp_plane_is_finite(-FLT_MAX));
    TEST_ASSERT_FALSE(jp_plane_is_finite(infinity));
    TEST_ASSERT_FALSE(jp_plane_is_finite(-infinity));
    TEST_ASSERT_FALSE(jp_plane_is_finite(infinity - infinity));
}

static void test_same_bits_everywhere(void)
{
    uint32_t hash = BITS_HASH_START;

    for (int i = 0; i < SAMPLES; i++) {
        hash = hash_bits(hash, jp_plane_sine(sample(i)));
        hash = hash_bits(hash, jp_plane_square_root(jp_plane_wrap(sample(i)) + 4.0f));
    }
    TEST_ASSERT_EQUAL_HEX32(0x36B54AA7U, hash);
}
