/* A path that is begun while another is followed begins at rest, with its first set-point. */
#include "src/skid_steer/skid_follow.h"

#include <joulepath/tables.h>

#include "unity.h"

static struct jp_skid_follow follow;

void setUp(void)
{
    follow = (struct jp_skid_follow){.next = JP_SKID_FOLLOW_TRACK,
                                     .motion = {JP_Q24(1), JP_Q24(1)},
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
    TEST_ASSERT_EQUAL_INT32(0, follow.at.acceleration);
    TEST_ASSERT_EQUAL_INT32(0, follow.at.turn_acceleration);
    jp_skid_follow_end(&follow);
    TEST_ASSERT_FALSE(jp_skid_follow_is_under_way(&follow));
}
