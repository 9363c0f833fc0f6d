/* The patrol's pose by wheels and laser, and the pace of what moves, one function at a time. */
#include "src/local/patrol_sense.h"

#include "tests/support/patrol_rig.h"

static struct jp_plane_pose before;

void setUp(void)
{
    rig_reset();
    patrol.pose = (struct jp_plane_pose){2.0f, -1.0f, 3.0f};
    before = patrol.pose;
    patrol.config.teb.weights.laser_odometry = 3.0f;
    patrol.config.teb.weights.wheel_odometry = 1.0f;
    patrol.config.jump = 0.3f;
    input = (struct jp_patrol_input){.wheels = {5.0f, 4.0f, 0.5f}};
}

void tearDown(void)
{
}

static void see(float x, float y, float heading)
{
    input.has_laser = true;
    input.laser = (struct jp_plane_pose){x, y, heading};
    jp_patrol_predict_pose(&patrol, &input);
}

static void expect_pose(float x, float y, float heading)
{
    TEST_ASSERT_NEAR(2.0e-6f, x, patrol.pose.x);
    TEST_ASSERT_NEAR(2.0e-6f, y, patrol.pose.y);
    TEST_ASSERT_NEAR(2.0e-6f, 0.0f, jp_plane_wrap(heading - patrol.pose.heading));
}

/* ---- Wheels ---- */

static void test_the_pose_moves_as_the_wheels_do(void)
{
    const struct jp_plane_pose motion = {0.3f, -0.4f, 0.25f};
    const struct jp_plane_pose after = jp_plane_compose(&before, &motion);

    patrol.internal.has_wheels = false;
    patrol.internal.blind = 0.0f;
    input.deviation = 0.2f;
    jp_patrol_predict_pose(&patrol, &input);
    expect_pose(before.x, before.y, before.heading);
    input.wheels = jp_plane_compose(&input.wheels, &motion);
    jp_patrol_predict_pose(&patrol, &input);
    expect_pose(after.x, after.y, after.heading);
    TEST_ASSERT_NEAR(2.0e-6f, 0.5f, patrol.internal.blind);
    TEST_ASSERT_NEAR(1.0e-6f, 0.2f, patrol.internal.deviation);
    TEST_ASSERT_EQUAL_UINT32(2, patrol.counts.laser_missing);
}

static void test_without_weight_the_laser_is_not_looked_at(void)
{
    patrol.config.teb.weights.laser_odometry = 0.0f;
    TEST_ASSERT_FALSE(jp_patrol_uses_laser(&patrol));
    see(2.0f, -1.0f, 3.0f);
    TEST_ASSERT_FALSE(patrol.internal.is_measured);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.laser_missing);
}

/* ---- Laser ---- */

/* Between both by their weights, the heading the short way round. */
static void test_a_measured_pose_counts_by_its_weight(void)
{
    patrol.internal.blind = 0.7f;
    patrol.internal.jumps = 3;
    see(2.12f, -1.2f, -3.1f);
    TEST_ASSERT_TRUE(patrol.internal.is_measured);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, patrol.internal.blind);
    TEST_ASSERT_EQUAL_UINT16(0, patrol.internal.jumps);
    jp_patrol_correct_pose(&patrol);
    expect_pose(2.0f + 0.75f * 0.12f, -1.0f - 0.75f * 0.2f, 3.0f + 0.75f * (2.0f * JP_PLANE_PI - 6.1f));
    TEST_ASSERT_TRUE(jp_plane_magnitude(patrol.pose.heading) <= JP_PLANE_PI);
}

static void test_what_was_not_measured_corrects_nothing(void)
{
    see(2.1f, -1.1f, 3.0f);
    input.has_laser = false;
    jp_patrol_predict_pose(&patrol, &input);
    jp_patrol_correct_pose(&patrol);
    expect_pose(2.0f, -1.0f, 3.0f);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.laser_missing);
}

/* Farther off, or turned by more, than `jump` says, in any direction. */
static void test_a_jump_is_refused(void)
{
    for (int i = 0; i < 8; i++) {
        const struct jp_plane_point along = jp_plane_direction(0.25f * JP_PLANE_PI * (float)i);

        setUp();
        see(2.0f + 0.29f * along.x, -1.0f + 0.29f * along.y, 3.0f);
        TEST_ASSERT_TRUE(patrol.internal.is_measured);
        setUp();
        see(2.0f + 0.31f * along.x, -1.0f + 0.31f * along.y, 3.0f);
        TEST_ASSERT_FALSE(patrol.internal.is_measured);
        TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.laser_rejected);
        TEST_ASSERT_EQUAL_UINT16(1, patrol.internal.jumps);
        setUp();
        see(2.0f, -1.0f, 3.0f + (i % 2 == 0 ? 0.31f : -0.31f));
        TEST_ASSERT_FALSE(patrol.internal.is_measured);
        setUp();
        see(2.0f, -1.0f, 3.0f + (i % 2 == 0 ? 0.29f : -0.29f));
        TEST_ASSERT_TRUE(patrol.internal.is_measured);
    }
}

static void test_a_new_place_is_taken_and_who_moved_there_forgotten(void)
{
    patrol.movers.count = 2;
    input.is_new_place = true;
    see(9.0f, 8.0f, 1.0f);
    expect_pose(9.0f, 8.0f, 1.0f);
    TEST_ASSERT_EQUAL_UINT8(0, patrol.movers.count);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.laser_rejected);
}

/* ---- Scans ---- */

static void put_post(float x)
{
    for (unsigned i = 0; i < RIG_BEAMS; i++) {
        const float bearing = -JP_PLANE_PI + 2.0f * JP_PLANE_PI / (float)RIG_BEAMS * (float)i;

        ranges[i] = jp_plane_magnitude(bearing) < 0.09f ? x : 0.0f;
    }
    input.scan = (struct jp_scan){ranges, RIG_BEAMS, -JP_PLANE_PI, 2.0f * JP_PLANE_PI / (float)RIG_BEAMS};
    input.sensor = (struct jp_plane_pose){0.2f, 0.0f, 0.0f};
    jp_patrol_look(&patrol, &input);
}

/* A post that comes by 0.1 m from scan to scan, every so many-th of which is there. */
static float speed_with_gaps(unsigned gap)
{
    setUp();
    patrol.pose = (struct jp_plane_pose){0.0f, 0.0f, 0.0f};
    jp_movers_clear(&patrol.movers);
    for (unsigned i = 0; i < 12U; i++) {
        put_post(4.0f - 0.1f * (float)i);
        for (unsigned k = 0; k < gap; k++) {
            input.scan.ranges = NULL;
            jp_patrol_look(&patrol, &input);
        }
        TEST_ASSERT_EQUAL_UINT16(gap, patrol.internal.scan_gap);
    }
    TEST_ASSERT_EQUAL_UINT32(12U * gap, patrol.counts.scans_missing);
    TEST_ASSERT_EQUAL_UINT8(1, patrol.movers.count);
    return patrol.movers.movers[0].velocity.x;
}

/* The same way takes as many periods more as scans were missing. */
static void test_speeds_are_by_the_time_between_scans(void)
{
    for (unsigned gap = 0; gap < 3U; gap++) {
        TEST_ASSERT_NEAR(0.15f, -0.1f / (RIG_PERIOD * (float)(gap + 1U)), speed_with_gaps(gap));
    }
}

/* The shapes that it keeps know how fast they are, and where the sensor is. */
static void test_shapes_move_as_who_is_seen_does(void)
{
    (void)speed_with_gaps(0);
    TEST_ASSERT_TRUE(patrol.obstacles.count > 0U);
    TEST_ASSERT_NEAR(0.2f, -1.0f, patrol.obstacles.shapes[0].velocity.x);
    TEST_ASSERT_NEAR(0.05f, 4.0f - 1.1f + 0.2f, patrol.movers.movers[0].centre.x);
}
