/* A path that is begun while another is followed begins at rest, with its first set-point; and the parts of a drive,
 * one a tick. */
#include "src/skid_steer/skid_follow.h"

#include <joulepath/tables.h>

#include "unity.h"

static struct jp_skid_follow follow;

void setUp(void)
{
    follow = (struct jp_skid_follow){.next = JP_SKID_FOLLOW_TRACK,
                                     .motion = {JP_Q24(1), JP_Q24(1)},
                                     .acceleration = JP_Q24(1),
                                     .at = {.acceleration = JP_Q24(1), .turn_acceleration = JP_Q24(1)}};
}

void tearDown(void)
{
}

static void test_a_path_begins_at_rest(void)
{
    static const struct jp_lattice_path path = {0};

    TEST_ASSERT_FALSE(jp_skid_follow_is_under_way(&follow));
    jp_skid_follow_begin(&follow, &path);
    TEST_ASSERT_TRUE(jp_skid_follow_is_under_way(&follow));
    TEST_ASSERT_EQUAL_INT(JP_SKID_FOLLOW_ADVANCE, follow.next);
    TEST_ASSERT_EQUAL_INT32(0, follow.motion.speed);
    TEST_ASSERT_EQUAL_INT32(0, follow.motion.turn_rate);
    TEST_ASSERT_EQUAL_INT32(0, follow.acceleration);
    TEST_ASSERT_EQUAL_INT32(0, follow.at.acceleration);
    TEST_ASSERT_EQUAL_INT32(0, follow.at.turn_acceleration);
    jp_skid_follow_end(&follow);
    TEST_ASSERT_FALSE(jp_skid_follow_is_under_way(&follow));
}

static void test_without_a_path_nothing_is_done(void)
{
    const struct jp_skid_follow before = follow;
    const struct jp_skid_odometry odometry = {0};
    const struct jp_skid_odometry_config config = {.tick_rate = 500, .step_ticks = 20};

    jp_skid_follow_work(&follow, &odometry, &config);
    TEST_ASSERT_EQUAL_MEMORY(&before, &follow, sizeof before);
}

/** Of a slope that changes from one set-point to the next. */
static void set_slope(struct jp_skid_odometry *odometry, int i)
{
    odometry->internal.tilt.state[JP_SKID_TILT_AHEAD] = JP_Q24(0.01) * (i % 5 - 2);
    odometry->internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.02) * (i % 3 + 1);
    odometry->internal.slip.creep_across = JP_Q24(1) + JP_Q24(0.1) * (i % 4);
}

/* Set-point, what is ahead on the slope that the odometry knows, and the way back: as a drive that is told the same. */
static void test_its_parts_are_those_of_a_drive(void)
{
    struct jp_path_piece bend = {
        .length = JP_Q24(2),
        .bend = JP_Q24(0.5),
        .kind = JP_PIECE_CURVE,
        .speed = {.cruise = JP_Q24(0.5), .acceleration = JP_Q24(0.25), .brake_from = JP_Q24(1.5)}};
    const struct jp_lattice_path path = {.pieces = &bend, .places = 1, .count = 1};
    const struct jp_skid_odometry_config config = {.tick_rate = 500, .step_ticks = 20, .creep = JP_Q24(0.125)};
    struct jp_skid_odometry odometry = {.internal = {.slip = {.per_most = JP_Q16(1)}}};
    const struct jp_path_pose pose = {.heading = 0};
    struct jp_path_set_point at;
    struct jp_path_drive twin;
    struct jp_path_slide slide;
    struct jp_motion motion;
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_drive_init(&twin, &jp_path_drive_zhang2018, &field));
    follow.drive = twin;
    jp_path_drive_begin(&twin, &path);
    jp_skid_follow_begin(&follow, &path);
    for (int i = 0; i < 100; i++) {
        jp_skid_follow_work(&follow, &odometry, &config);
        TEST_ASSERT_TRUE(jp_path_drive_advance(&twin, &at));
        TEST_ASSERT_EQUAL_INT32(at.acceleration, follow.at.acceleration);
        TEST_ASSERT_EQUAL_MEMORY(&twin, &follow.drive, sizeof twin);

        set_slope(&odometry, i);
        jp_skid_follow_work(&follow, &odometry, &config);
        jp_skid_odometry_slide(&odometry, &config, &slide);
        jp_path_drive_look_ahead(&twin, &slide);
        TEST_ASSERT_EQUAL_INT32(twin.internal.lean, follow.drive.internal.lean);
        TEST_ASSERT_EQUAL_MEMORY(&twin, &follow.drive, sizeof twin);

        jp_skid_follow_work(&follow, &odometry, &config);
        jp_path_drive_track(&twin, &at, &pose, &motion);
        TEST_ASSERT_EQUAL_INT32(motion.speed, follow.motion.speed);
        TEST_ASSERT_EQUAL_INT32(motion.turn_rate, follow.motion.turn_rate);
    }
    TEST_ASSERT_TRUE(twin.internal.lean != 0);
}
