/* Poses of the band: laid along the path, cut to the next task, more or fewer of them, and what is near them. */
#include "src/local/teb_band.h"

#include "src/local/obstacle_distance.h"
#include "tests/support/teb_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

static void fit(void)
{
    teb.internal.task = task;
    teb.internal.obstacles = &obstacles;
    jp_teb_fit_band(&teb);
}

static const struct jp_plane_pose *pose(unsigned i)
{
    return &teb.poses[i].pose;
}

static const struct jp_plane_pose *last_pose(void)
{
    return pose(teb.count - 1U);
}

static void set_pose(unsigned i, float x, float y, float heading, float interval)
{
    jp_teb_set_pose(&teb.poses[i], &(struct jp_plane_pose){x, y, heading});
    teb.poses[i].interval = interval;
}

static void assert_pose(const struct jp_plane_pose *expected, const struct jp_plane_pose *actual)
{
    TEST_ASSERT_NEAR(1e-5f, expected->x, actual->x);
    TEST_ASSERT_NEAR(1e-5f, expected->y, actual->y);
    TEST_ASSERT_NEAR(1e-5f, expected->heading, actual->heading);
}

static void assert_band(void)
{
    TEST_ASSERT_TRUE(teb.count >= JP_TEB_POSES_MIN && teb.count <= JP_TEB_POSES_MAX);
    for (unsigned i = 0; i < teb.count; i++) {
        TEST_ASSERT_TRUE(jp_plane_is_finite(pose(i)->x) && jp_plane_is_finite(pose(i)->y));
        TEST_ASSERT_NEAR(1e-6f, jp_plane_cosine(pose(i)->heading), teb.poses[i].cosine);
        TEST_ASSERT_NEAR(1e-6f, jp_plane_sine(pose(i)->heading), teb.poses[i].sine);
        TEST_ASSERT_TRUE(i + 1U == teb.count || teb.poses[i].interval > 0.0f);
    }
}

static float duration(void)
{
    float sum = 0.0f;

    for (unsigned i = 0; i + 1U < teb.count; i++) {
        sum += teb.poses[i].interval;
    }
    return sum;
}

/* ---- Along the path ---- */

static void test_new_band_lies_on_the_path(void)
{
    fit();
    assert_band();
    TEST_ASSERT_EQUAL_UINT(22, teb.count); /* 5 m at 1 m/s in intervals of 0.25 s, and one more */
    assert_pose(&task.start, pose(0));
    assert_pose(&task.goal, last_pose());
    for (unsigned i = 0; i + 1U < teb.count; i++) {
        TEST_ASSERT_NEAR(1e-5f, 5.0f / 21.0f, pose(i + 1U)->x - pose(i)->x);
        TEST_ASSERT_TRUE(pose(i)->y == 0.0f && pose(i)->heading == 0.0f);
        TEST_ASSERT_NEAR(1e-5f, 5.0f / 21.0f, teb.poses[i].interval);
    }
}

static void test_new_band_turns_with_the_path(void)
{
    const struct jp_plane_point corner[] = {{0.0f, 0.0f}, {2.0f, 0.0f}, {2.0f, 3.0f}};

    rig_path(corner, 3);
    fit();
    assert_band();
    for (unsigned i = 1; i + 1U < teb.count; i++) {
        const bool is_before = pose(i)->x < 1.999f;

        TEST_ASSERT_NEAR(1e-5f, is_before ? 0.0f : 2.0f, is_before ? pose(i)->y : pose(i)->x);
        TEST_ASSERT_NEAR(1e-5f, is_before ? 0.0f : JP_PLANE_PI / 2.0f, pose(i)->heading);
    }
    /* The turn of 90° takes longer than the way. */
    TEST_ASSERT_TRUE(duration() > 5.0f + JP_PLANE_PI / 2.0f / 1.2f - 0.5f);
}

static void test_new_band_begins_where_the_robot_is_on_the_path(void)
{
    task.start = (struct jp_plane_pose){2.0f, 0.1f, 0.2f};
    fit();
    assert_band();
    assert_pose(&task.start, pose(0));
    TEST_ASSERT_EQUAL_UINT(14, teb.count);
    TEST_ASSERT_NEAR(1e-5f, 2.0f + 3.0f / 13.0f, pose(1)->x);
    TEST_ASSERT_NEAR(1e-5f, 0.0f, pose(1)->y);
}

static void test_new_band_begins_on_a_later_chord(void)
{
    const struct jp_plane_point points[] = {{0.0f, 0.0f}, {1.0f, 0.0f}, {2.0f, 0.0f}, {2.0f, 0.0f}, {5.0f, 0.0f}};

    rig_path(points, 5);
    task.start = (struct jp_plane_pose){3.0f, 0.0f, 0.0f};
    fit();
    assert_band();
    TEST_ASSERT_EQUAL_UINT(10, teb.count);
    TEST_ASSERT_NEAR(1e-5f, 3.0f + 2.0f / 9.0f, pose(1)->x);
}

static void test_long_path_has_all_poses(void)
{
    rig_straight(100.0f);
    fit();
    assert_band();
    TEST_ASSERT_EQUAL_UINT(JP_TEB_POSES_MAX, teb.count);
    assert_pose(&task.goal, last_pose());
}

static void test_path_between_has_its_number_of_poses(void)
{
    rig_straight(11.9f);
    fit();
    TEST_ASSERT_EQUAL_UINT(49, teb.count);
    jp_teb_clear(&teb);
    rig_straight(12.1f);
    fit();
    TEST_ASSERT_EQUAL_UINT(50, teb.count);
}

static void test_short_path_has_three_poses(void)
{
    rig_straight(0.02f);
    fit();
    assert_band();
    TEST_ASSERT_EQUAL_UINT(JP_TEB_POSES_MIN, teb.count);
    TEST_ASSERT_NEAR(1e-5f, 0.3f, duration()); /* two intervals of the least */
}

static void test_path_without_length_is_a_band_at_one_place(void)
{
    rig_straight(0.0f);
    task.goal.x = 0.05f;
    fit();
    assert_band();
    TEST_ASSERT_EQUAL_UINT(JP_TEB_POSES_MIN, teb.count);
    TEST_ASSERT_NEAR(1e-5f, 0.0f, pose(1)->x);
    assert_pose(&task.goal, last_pose());
}

static void test_robot_beyond_the_end_of_the_path(void)
{
    const struct jp_plane_point points[] = {{0.0f, 0.0f}, {1.0f, 0.0f}, {2.0f, 0.0f}};

    rig_path(points, 3);
    task.start.x = 2.5f;
    fit();
    assert_band();
    TEST_ASSERT_EQUAL_UINT(JP_TEB_POSES_MIN, teb.count);
    TEST_ASSERT_NEAR(1e-5f, 2.0f, pose(1)->x);
}

/* ---- From the last cycle ---- */

static void test_band_is_kept_for_the_next_cycle(void)
{
    fit();
    set_pose(5, 1.2f, 0.07f, 0.1f, 0.3f);
    fit();
    assert_band();
    TEST_ASSERT_EQUAL_UINT(22, teb.count);
    TEST_ASSERT_NEAR(1e-5f, 0.07f, pose(5)->y);
    TEST_ASSERT_NEAR(1e-5f, 0.3f, teb.poses[5].interval);
}

static void test_cleared_band_is_laid_anew(void)
{
    fit();
    set_pose(5, 1.2f, 0.07f, 0.1f, 0.3f);
    jp_teb_clear(&teb);
    fit();
    TEST_ASSERT_TRUE(pose(5)->y == 0.0f);
}

static void test_passed_poses_are_dropped(void)
{
    fit();

    const struct jp_plane_pose fourth = *pose(4);

    task.start.x = pose(3)->x + 0.05f; /* nearer to pose 3 than to 4 */
    fit();
    assert_band();
    TEST_ASSERT_EQUAL_UINT(19, teb.count);
    assert_pose(&task.start, pose(0));
    assert_pose(&fourth, pose(1));
    assert_pose(&task.goal, last_pose());
}

static void test_three_poses_remain(void)
{
    rig_straight(0.6f);
    fit();
    TEST_ASSERT_EQUAL_UINT(4, teb.count);
    task.start.x = 0.55f;
    fit();
    assert_band();
    TEST_ASSERT_EQUAL_UINT(JP_TEB_POSES_MIN, teb.count);
}

static void test_first_step_of_a_kept_band_is_as_fast_as_before(void)
{
    fit();
    task.start.x = 0.06f; /* a quarter of the first step */
    fit();
    TEST_ASSERT_EQUAL_UINT(22, teb.count);
    TEST_ASSERT_NEAR(1e-5f, 5.0f / 21.0f - 0.06f, teb.poses[0].interval);
    task.start.x = -0.04f;
    fit();
    TEST_ASSERT_NEAR(1e-5f, 5.0f / 21.0f + 0.04f, teb.poses[0].interval);
}

static void test_first_step_without_length_keeps_its_time(void)
{
    rig_straight(0.0f);
    task.goal.x = 0.05f;
    fit();
    fit();
    assert_band();
    TEST_ASSERT_NEAR(1e-5f, 0.15f, teb.poses[0].interval);
}

static void test_robot_far_from_the_band_starts_anew(void)
{
    fit();
    set_pose(5, 1.2f, 0.07f, 0.1f, 0.3f);
    task.start.y = 0.6f;
    fit();
    TEST_ASSERT_TRUE(pose(5)->y == 0.0f);
}

static void test_goal_that_moves_a_little_takes_the_band_along(void)
{
    fit();
    set_pose(5, 1.2f, 0.07f, 0.1f, 0.3f);

    const float before = duration();

    task.goal = (struct jp_plane_pose){5.5f, 0.2f, 0.5f};
    fit();
    assert_band();
    TEST_ASSERT_NEAR(1e-5f, 0.07f, pose(5)->y);
    assert_pose(&task.goal, last_pose());
    TEST_ASSERT_TRUE(duration() > before + 0.5f);
}

static void test_goal_that_jumps_starts_anew(void)
{
    const struct jp_plane_pose jumps[] = {{5.0f, 1.1f, 0.0f}, {5.0f, 0.0f, 1.1f}, {5.0f, 0.0f, -1.1f}};

    for (unsigned i = 0; i < sizeof jumps / sizeof jumps[0]; i++) {
        rig_reset();
        fit();
        set_pose(5, 1.2f, 0.07f, 0.1f, 0.3f);
        task.goal = jumps[i];
        fit();
        TEST_ASSERT_TRUE(pose(5)->y == 0.0f);
        assert_pose(&jumps[i], last_pose());
    }
}

static void test_free_heading_of_the_goal_is_the_last_band_s(void)
{
    task.is_heading_free = true;
    fit();
    set_pose(teb.count - 1U, 5.0f, 0.0f, -0.3f, 0.25f);
    fit();
    TEST_ASSERT_NEAR(1e-5f, -0.3f, last_pose()->heading);
}

/* It may be anything: the band is not laid anew for it. */
static void test_free_heading_of_the_goal_is_no_jump(void)
{
    task.is_heading_free = true;
    task.goal.heading = 2.0f;
    fit();
    set_pose(5, 1.2f, 0.07f, 0.1f, 0.3f);
    set_pose(teb.count - 1U, 5.0f, 0.0f, -0.3f, 0.25f);
    fit();
    TEST_ASSERT_NEAR(1e-5f, 0.07f, pose(5)->y);
    TEST_ASSERT_NEAR(1e-5f, -0.3f, last_pose()->heading);
}

/* ---- More or fewer poses ---- */

static void set_intervals(const float *intervals, unsigned count)
{
    teb.count = (uint8_t)(count + 1U);
    for (unsigned i = 0; i <= count; i++) {
        set_pose(i, (float)i, 0.5f * (float)i, 0.1f * (float)i, i < count ? intervals[i] : 0.0f);
    }
}

static void test_intervals_within_the_hysteresis_stay(void)
{
    const float intervals[] = {0.16f, 0.25f, 0.34f, 0.2f};

    set_intervals(intervals, 4);
    jp_teb_resize(&teb);
    TEST_ASSERT_EQUAL_UINT(5, teb.count);
    for (unsigned i = 0; i < 4U; i++) {
        TEST_ASSERT_TRUE(teb.poses[i].interval == intervals[i]);
    }
}

static void test_long_interval_is_split_in_its_middle(void)
{
    const float intervals[] = {0.25f, 0.6f, 0.25f};

    set_intervals(intervals, 3);
    jp_teb_resize(&teb);
    assert_band();
    TEST_ASSERT_EQUAL_UINT(5, teb.count);
    assert_pose(&(struct jp_plane_pose){1.5f, 0.75f, 0.15f}, pose(2));
    TEST_ASSERT_NEAR(1e-6f, 0.3f, teb.poses[1].interval);
    TEST_ASSERT_NEAR(1e-6f, 0.3f, teb.poses[2].interval);
    TEST_ASSERT_NEAR(1e-5f, 1.1f, duration());
}

static void test_split_takes_the_shorter_way_round(void)
{
    const float intervals[] = {0.25f, 0.6f};

    set_intervals(intervals, 2);
    set_pose(1, 0.0f, 0.0f, 3.0f, 0.6f);
    set_pose(2, 1.0f, 0.0f, -3.0f, 0.0f);
    jp_teb_resize(&teb);
    TEST_ASSERT_EQUAL_UINT(4, teb.count);
    TEST_ASSERT_NEAR(1e-4f, JP_PLANE_PI, jp_plane_magnitude(pose(2)->heading));
}

static void test_very_long_interval_is_split_again(void)
{
    const float intervals[] = {1.2f, 0.25f};

    set_intervals(intervals, 2);
    jp_teb_resize(&teb);
    assert_band();
    TEST_ASSERT_EQUAL_UINT(6, teb.count);
    TEST_ASSERT_NEAR(1e-5f, 1.45f, duration());
    for (unsigned i = 0; i + 1U < teb.count; i++) {
        TEST_ASSERT_TRUE(teb.poses[i].interval <= 0.35f);
    }
}

static void test_no_more_than_all_poses(void)
{
    float intervals[JP_TEB_POSES_MAX - 2];

    for (unsigned i = 0; i < JP_TEB_POSES_MAX - 2U; i++) {
        intervals[i] = 0.5f;
    }
    set_intervals(intervals, JP_TEB_POSES_MAX - 2U);
    jp_teb_resize(&teb);
    assert_band();
    TEST_ASSERT_EQUAL_UINT(JP_TEB_POSES_MAX, teb.count);
    TEST_ASSERT_NEAR(1e-4f, 24.0f, duration());
}

static void test_short_intervals_are_joined(void)
{
    const float intervals[] = {0.25f, 0.1f, 0.1f, 0.1f, 0.25f};

    set_intervals(intervals, 5);
    jp_teb_resize(&teb);
    assert_band();
    TEST_ASSERT_EQUAL_UINT(4, teb.count);
    TEST_ASSERT_NEAR(1e-6f, 0.2f, teb.poses[1].interval);
    TEST_ASSERT_NEAR(1e-6f, 0.35f, teb.poses[2].interval);
    TEST_ASSERT_NEAR(1e-5f, 0.8f, duration());
    TEST_ASSERT_NEAR(1e-6f, 5.0f, last_pose()->x);
}

static void test_short_last_interval_stays(void)
{
    const float intervals[] = {0.25f, 0.25f, 0.1f};

    set_intervals(intervals, 3);
    jp_teb_resize(&teb);
    TEST_ASSERT_EQUAL_UINT(4, teb.count);
    TEST_ASSERT_NEAR(1e-6f, 0.1f, teb.poses[2].interval);
}

static void test_no_fewer_than_three_poses(void)
{
    const float intervals[] = {0.01f, 0.01f, 0.01f, 0.01f};

    set_intervals(intervals, 4);
    jp_teb_resize(&teb);
    assert_band();
    TEST_ASSERT_EQUAL_UINT(JP_TEB_POSES_MIN, teb.count);
    TEST_ASSERT_NEAR(1e-6f, 0.04f, duration());
}

/* ---- What is near ---- */

static void associate(void)
{
    teb.internal.task = task;
    teb.internal.obstacles = &obstacles;
    teb.internal.work = 0;
    jp_teb_find_feet(&teb);
    jp_teb_find_obstacles(&teb);
}

static void test_feet_stand_on_the_path_below_the_poses(void)
{
    const struct jp_plane_point corner[] = {{0.0f, 0.0f}, {2.0f, 0.0f}, {2.0f, 3.0f}};

    rig_path(corner, 3);
    teb.count = 4;
    set_pose(0, 0.5f, 0.3f, 0.0f, 0.25f);
    set_pose(1, 1.0f, -0.2f, 0.0f, 0.25f);
    set_pose(2, 2.3f, 1.0f, 1.5f, 0.25f);
    set_pose(3, 1.9f, 3.4f, 1.5f, 0.0f);
    associate();
    TEST_ASSERT_NEAR(1e-5f, 0.5f, teb.internal.feet[0].point.x);
    TEST_ASSERT_NEAR(1e-5f, 0.0f, teb.internal.feet[0].point.y);
    TEST_ASSERT_NEAR(1e-5f, 0.0f, teb.internal.feet[0].normal.x);
    TEST_ASSERT_NEAR(1e-5f, 1.0f, teb.internal.feet[0].normal.y);
    TEST_ASSERT_NEAR(1e-5f, 1.0f, teb.internal.feet[1].point.x);
    TEST_ASSERT_NEAR(1e-5f, 2.0f, teb.internal.feet[2].point.x);
    TEST_ASSERT_NEAR(1e-5f, 1.0f, teb.internal.feet[2].point.y);
    TEST_ASSERT_NEAR(1e-5f, -1.0f, teb.internal.feet[2].normal.x);
    TEST_ASSERT_NEAR(1e-5f, 0.0f, teb.internal.feet[2].normal.y);
    TEST_ASSERT_NEAR(1e-5f, 2.0f, teb.internal.feet[3].point.x);
    TEST_ASSERT_NEAR(1e-5f, 3.0f, teb.internal.feet[3].point.y);
}

static void test_feet_on_a_path_without_length(void)
{
    rig_straight(0.0f);
    teb.count = 3;
    for (unsigned i = 0; i < 3U; i++) {
        set_pose(i, 0.1f * (float)i, 0.3f, 0.0f, 0.25f);
    }
    associate();
    for (unsigned i = 0; i < 3U; i++) {
        TEST_ASSERT_TRUE(teb.internal.feet[i].point.x == 0.0f && teb.internal.feet[i].point.y == 0.0f);
        TEST_ASSERT_TRUE(teb.internal.feet[i].normal.x == 0.0f && teb.internal.feet[i].normal.y == 0.0f);
    }
}

/* A path that comes back near itself: no foot jumps to the way back. */
static void test_feet_do_not_jump_to_another_part_of_the_path(void)
{
    const struct jp_plane_point hairpin[] = {{0.0f, 0.0f}, {3.0f, 0.0f}, {3.0f, 0.5f}, {0.0f, 0.5f}};

    rig_path(hairpin, 4);
    teb.count = 3;
    for (unsigned i = 0; i < 3U; i++) {
        set_pose(i, 0.5f * (float)i, 0.3f, 0.0f, 0.25f);
    }
    associate();
    for (unsigned i = 0; i < 3U; i++) {
        TEST_ASSERT_NEAR(1e-5f, 0.0f, teb.internal.feet[i].point.y);
    }
}

static void lay_standing_band(void)
{
    teb.count = 3;
    for (unsigned i = 0; i < 3U; i++) {
        set_pose(i, 0.0f, 0.0f, 0.0f, 0.25f);
    }
}

static void test_obstacles_within_reach_are_near(void)
{
    lay_standing_band();
    rig_disc(0.0f, 0.69f, 0.0f); /* 0.39 m from the footprint; reach is 0.1 m + 0.3 m */
    rig_disc(0.0f, -0.71f, 0.0f);
    associate();
    for (unsigned i = 0; i < 3U; i++) {
        TEST_ASSERT_EQUAL_UINT(1, teb.internal.near[i].count);
        TEST_ASSERT_EQUAL_UINT(0, teb.internal.near[i].shape[0]);
        TEST_ASSERT_NEAR(1e-5f, 0.39f, teb.internal.near[i].distance[0]);
    }
}

static void test_nearest_four_are_kept_in_order(void)
{
    static const float distances[] = {0.2f, 0.05f, 0.3f, 0.1f, 0.25f, 0.15f};
    static const float nearest[] = {0.05f, 0.1f, 0.15f, 0.2f};

    lay_standing_band();
    obstacles.centre = (struct jp_plane_point){0.0f, -3.0f}; /* so that their own order is another one */
    for (unsigned i = 0; i < sizeof distances / sizeof distances[0]; i++) {
        const float side = i % 2U == 0U ? 1.0f : -1.0f;

        rig_disc(0.0f, side * (0.3f + distances[i]), 0.0f);
    }
    associate();
    for (unsigned i = 0; i < 3U; i++) {
        TEST_ASSERT_EQUAL_UINT(JP_TEB_NEAR_MAX, teb.internal.near[i].count);
        for (unsigned k = 0; k < JP_TEB_NEAR_MAX; k++) {
            TEST_ASSERT_NEAR(1e-5f, nearest[k], teb.internal.near[i].distance[k]);
            TEST_ASSERT_NEAR(1e-5f, nearest[k],
                             jp_obstacle_distance(&teb.config.footprint, pose(i),
                                                  &obstacles.shapes[teb.internal.near[i].shape[k]], NULL));
        }
    }
}

/* Where it will be when the robot is there, not where it is. */
static void test_obstacle_that_moves_is_near_where_it_meets_the_robot(void)
{
    rig_disc(2.0f, 2.0f, 0.1f);
    obstacles.shapes[0].velocity = (struct jp_plane_point){0.0f, -1.0f};
    fit();
    associate();
    for (unsigned i = 0; i < teb.count; i++) {
        const float x = pose(i)->x;
        const float ahead = jp_plane_magnitude(2.0f - x) - 0.4f; /* the disc is at y = 2 − x then */
        const float aside = jp_plane_magnitude(2.0f - x) - 0.3f;
        const float away = jp_plane_length(ahead > 0.0f ? ahead : 0.0f, aside > 0.0f ? aside : 0.0f) - 0.1f;

        TEST_ASSERT_NEAR(1e-4f, x, teb.internal.near[i].time);
        if (jp_plane_magnitude(away - 0.4f) > 0.01f) {
            TEST_ASSERT_EQUAL_UINT(away < 0.4f ? 1 : 0, teb.internal.near[i].count);
        }
    }
}

/* Sparing the far ones leaves the same neighbours as looking at all. */
static void test_no_obstacle_near_a_pose_is_missed(void)
{
    for (unsigned run = 0; run < 20U; run++) {
        rig_reset();
        random_state = run + 1U;
        for (unsigned i = 0; i < JP_OBSTACLES_MAX; i++) {
            rig_disc(3.0f + rig_random(3.0f), rig_random(1.5f), 0.1f);
        }
        fit();
        for (unsigned i = 1; i + 1U < teb.count; i++) {
            set_pose(i, pose(i)->x, rig_random(0.3f), rig_random(1.0f), 0.25f);
        }
        associate();
        for (unsigned i = 0; i < teb.count; i++) {
            unsigned near = 0;

            for (unsigned k = 0; k < obstacles.count; k++) {
                near +=
                    jp_obstacle_distance(&teb.config.footprint, pose(i), &obstacles.shapes[k], NULL) < 0.4f ? 1U : 0U;
            }
            TEST_ASSERT_EQUAL_UINT(near < JP_TEB_NEAR_MAX ? near : (unsigned)JP_TEB_NEAR_MAX,
                                   teb.internal.near[i].count);
        }
    }
}

/* An uncertain one grows for a second. */
static void test_obstacle_that_may_move_comes_into_reach(void)
{
    rig_straight(1.2f);
    rig_disc(0.6f, 0.95f, 0.0f); /* 0.65 m aside */
    obstacles.shapes[0].margin = 0.5f;
    fit();
    associate();
    for (unsigned i = 0; i < teb.count; i++) {
        TEST_ASSERT_EQUAL_UINT(teb.internal.near[i].time > 0.55f ? 1 : 0, teb.internal.near[i].count);
    }
}

static void test_where_the_work_is_used_up_neighbours_stay(void)
{
    lay_standing_band();
    rig_disc(0.0f, 0.5f, 0.0f);
    associate();
    set_pose(1, 0.0f, 0.1f, 0.0f, 0.25f);
    teb.internal.work = JP_TEB_WORK_MAX;
    jp_teb_find_obstacles(&teb);
    TEST_ASSERT_NEAR(1e-5f, 0.2f, teb.internal.near[1].distance[0]);
    TEST_ASSERT_TRUE(teb.internal.near[1].pose.y == 0.0f);
    TEST_ASSERT_EQUAL_UINT(JP_TEB_WORK_MAX, teb.internal.work);
    teb.internal.work = JP_TEB_WORK_MAX - 1U;
    jp_teb_find_obstacles(&teb);
    TEST_ASSERT_NEAR(1e-5f, 0.2f, teb.internal.near[1].distance[0]);
    TEST_ASSERT_TRUE(teb.internal.work >= JP_TEB_WORK_MAX);
    associate();
    TEST_ASSERT_NEAR(1e-5f, 0.1f, teb.internal.near[1].distance[0]);
}

static void test_work_counts_searches_and_overlaps(void)
{
    uint8_t feature = JP_FEATURE_UNKNOWN;

    lay_standing_band();
    rig_disc(0.0f, 0.5f, 0.0f);
    rig_disc(0.0f, 0.0f, 0.1f);
    teb.internal.obstacles = &obstacles;
    teb.internal.work = 0;
    (void)jp_teb_distance(&teb, 0, 1, 0.0f, &feature, NULL);
    TEST_ASSERT_EQUAL_UINT(2, teb.internal.work);
    (void)jp_teb_distance(&teb, 0, 1, 0.0f, &feature, NULL);
    TEST_ASSERT_EQUAL_UINT(3, teb.internal.work);
    (void)jp_teb_distance(&teb, 0, 0, 0.0f, &feature, NULL);
    TEST_ASSERT_EQUAL_UINT(6, teb.internal.work);
}

/* No distance changes by more than the sweep. */
static void test_sweep_bounds_how_much_nearer_an_obstacle_comes(void)
{
    const struct jp_footprint footprints[] = {{0.4f, 0.4f, 0.3f}, {0.7f, 0.1f, 0.2f}, {0.1f, 0.7f, 0.2f}};

    rig_disc(0.5f, 0.8f, 0.05f);
    for (unsigned run = 0; run < 300U; run++) {
        const struct jp_footprint *const footprint = &footprints[run % 3U];
        const struct jp_plane_pose a = {rig_random(2.0f), rig_random(2.0f), rig_random(3.0f)};
        const struct jp_plane_pose b = {a.x + rig_random(0.2f), a.y + rig_random(0.2f), a.heading + rig_random(0.5f)};
        const float before = jp_obstacle_distance(footprint, &a, &obstacles.shapes[0], NULL);
        const float after = jp_obstacle_distance(footprint, &b, &obstacles.shapes[0], NULL);

        if (before > 0.0f && after > 0.0f) {
            TEST_ASSERT_TRUE(jp_plane_magnitude(before - after) <= jp_teb_sweep(footprint, &a, &b) + 1e-5f);
        }
    }
}
