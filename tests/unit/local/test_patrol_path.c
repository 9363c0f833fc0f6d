/* Where a robot is along its path: how it gets on, and what lies ahead of it. */
#include <string.h>

#include "tests/support/patrol_rig.h"

#include "src/local/patrol_path.h"

static struct jp_patrol_window window;

void setUp(void)
{
    rig_reset();
    memset(&window, 0, sizeof window);
}

void tearDown(void)
{
}

static void be_at(float x, float y)
{
    patrol.pose = (struct jp_plane_pose){x, y, 0.0f};
}

/* East for `east` points, then north for as many more, 1 m apart. */
static void follow_corner(unsigned east, unsigned north)
{
    for (unsigned i = 0; i < east; i++) {
        rig_point((float)i, 0.0f);
    }
    for (unsigned i = 1; i <= north; i++) {
        rig_point((float)(east - 1U), (float)i);
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow((float)(east - 1U), (float)north, 0.0f, true));
}

static void look(float horizon)
{
    jp_patrol_look_ahead(&patrol, horizon, &window);
}

static void test_point_in_metres(void)
{
    const struct jp_point point = {3 * JP_Q16_ONE / 2, -JP_Q16_ONE / 4};
    const struct jp_plane_point metres = jp_patrol_path_point(&point);

    TEST_ASSERT_NEAR(1e-6f, 1.5f, metres.x);
    TEST_ASSERT_NEAR(1e-6f, -0.25f, metres.y);
}

/* ---- Progress ---- */

static void test_no_progress_without_motion(void)
{
    follow_corner(5, 0);
    TEST_ASSERT_FALSE(jp_patrol_advance(&patrol));
    be_at(0.4f, 0.2f);
    TEST_ASSERT_FALSE(jp_patrol_advance(&patrol));
    TEST_ASSERT_EQUAL_UINT16(0, patrol.internal.path_next);
}

static void test_next_point_is_the_nearest_one(void)
{
    follow_corner(5, 0);
    be_at(0.6f, 0.2f);
    TEST_ASSERT_TRUE(jp_patrol_advance(&patrol));
    TEST_ASSERT_EQUAL_UINT16(1, patrol.internal.path_next);
    TEST_ASSERT_FALSE(jp_patrol_advance(&patrol));
    be_at(1.9f, -0.2f);
    TEST_ASSERT_TRUE(jp_patrol_advance(&patrol));
    TEST_ASSERT_EQUAL_UINT16(2, patrol.internal.path_next);
}

static void test_robot_does_not_go_back_along_its_path(void)
{
    follow_corner(5, 0);
    be_at(2.0f, 0.0f);
    TEST_ASSERT_TRUE(jp_patrol_advance(&patrol));
    be_at(0.0f, 0.0f);
    TEST_ASSERT_FALSE(jp_patrol_advance(&patrol));
    TEST_ASSERT_EQUAL_UINT16(2, patrol.internal.path_next);
}

static void test_progress_ends_at_the_last_point(void)
{
    follow_corner(3, 0);
    be_at(2.5f, 0.0f);
    TEST_ASSERT_TRUE(jp_patrol_advance(&patrol));
    TEST_ASSERT_EQUAL_UINT16(2, patrol.internal.path_next);
    be_at(7.0f, 0.0f);
    TEST_ASSERT_FALSE(jp_patrol_advance(&patrol));
}

/* A path that comes back beside itself: what is beyond the horizon does not count, however near it is. */
static void test_robot_does_not_jump_to_where_its_path_comes_back(void)
{
    rig_point(0.0f, 0.0f);
    rig_point(3.0f, 0.0f);
    rig_point(3.0f, 0.2f);
    rig_point(0.0f, 0.2f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.2f, 0.0f, true));
    be_at(0.0f, 0.2f);
    TEST_ASSERT_FALSE(jp_patrol_advance(&patrol));
    TEST_ASSERT_EQUAL_UINT16(0, patrol.internal.path_next);
}

/* ---- Ahead ---- */

static void test_window_from_the_start(void)
{
    follow_corner(5, 0);
    look(2.0f);
    TEST_ASSERT_EQUAL_UINT16(0, window.first);
    TEST_ASSERT_EQUAL_UINT16(3, window.count);
    TEST_ASSERT_FALSE(window.is_goal);
    TEST_ASSERT_NEAR(1e-5f, 2.0f, window.end.x);
    TEST_ASSERT_NEAR(1e-5f, 0.0f, window.end.y);
    TEST_ASSERT_NEAR(1e-5f, 0.0f, window.end.heading);
    TEST_ASSERT_NEAR(1e-5f, 0.0f, window.distance);
    TEST_ASSERT_NEAR(1e-5f, 0.0f, window.direction);
}

static void test_window_begins_at_the_point_behind(void)
{
    follow_corner(8, 0);
    be_at(2.2f, 0.5f);
    TEST_ASSERT_TRUE(jp_patrol_advance(&patrol));
    look(2.5f);
    TEST_ASSERT_EQUAL_UINT16(1, window.first);
    TEST_ASSERT_EQUAL_UINT16(4, window.count);
    TEST_ASSERT_NEAR(1e-5f, 4.0f, window.end.x);
    TEST_ASSERT_NEAR(1e-3f, jp_plane_length(0.2f, 0.5f), window.distance);
}

static void test_window_has_two_points_at_least(void)
{
    follow_corner(5, 0);
    look(0.001f);
    TEST_ASSERT_EQUAL_UINT16(2, window.count);
    TEST_ASSERT_NEAR(1e-5f, 1.0f, window.end.x);
}

static void test_window_at_the_goal(void)
{
    follow_corner(3, 2);
    be_at(2.0f, 2.0f);
    (void)jp_patrol_advance(&patrol);
    patrol.internal.path_next = 4;
    look(10.0f);
    TEST_ASSERT_EQUAL_UINT16(3, window.first);
    TEST_ASSERT_EQUAL_UINT16(2, window.count);
    TEST_ASSERT_TRUE(window.is_goal);
    TEST_ASSERT_NEAR(1e-5f, 2.0f, window.end.y);
    TEST_ASSERT_NEAR(1e-5f, 0.5f * JP_PLANE_PI, window.end.heading);
}

static void test_end_has_the_direction_of_the_path_there(void)
{
    follow_corner(3, 2);
    look(3.0f);
    TEST_ASSERT_EQUAL_UINT16(4, window.count);
    TEST_ASSERT_NEAR(1e-5f, 0.5f * JP_PLANE_PI, window.end.heading);
    TEST_ASSERT_NEAR(1e-5f, 1.0f, window.end.y);
}

/* Along fine points the direction is that to half a metre ahead; along coarse ones to the next point. */
static void test_direction_from_the_robot_to_its_path(void)
{
    rig_straight(0.0f, 0.0f, 0.4f, 0.0f);
    rig_straight(0.4f, 0.1f, 0.4f, 3.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.4f, 3.0f, 0.0f, true));
    look(2.0f);
    TEST_ASSERT_NEAR(0.05f, jp_plane_bearing(0.4f, 0.1f), window.direction);
    be_at(0.4f, -0.4f);
    look(2.0f);
    TEST_ASSERT_TRUE(window.direction > 1.4f && window.direction < 1.6f);
}

static void test_points_in_one_place(void)
{
    rig_point(1.0f, 1.0f);
    rig_point(1.0f, 1.0f);
    rig_point(1.0f, 1.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(1.0f, 1.0f, 0.0f, true));
    look(2.0f);
    TEST_ASSERT_EQUAL_UINT16(3, window.count);
    TEST_ASSERT_TRUE(window.is_goal);
    TEST_ASSERT_NEAR(1e-5f, 0.0f, window.end.heading);
    be_at(1.0f, 1.0f);
    TEST_ASSERT_TRUE(jp_patrol_advance(&patrol));
    TEST_ASSERT_EQUAL_UINT16(2, patrol.internal.path_next);
}
