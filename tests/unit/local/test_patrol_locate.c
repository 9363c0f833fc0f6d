/* A patrol whose pose a localiser gives. */
#include <joulepath/patrol.h>

#include "tests/support/localiser_rig.h"

static struct jp_patrol_input seen;

void setUp(void)
{
    rig_reset();
    memset(&seen, 0, sizeof seen);
}

void tearDown(void)
{
}

static enum jp_status locate(void)
{
    rig_scan();
    seen.scan = input.scan;
    seen.wheels = input.wheels;
    return jp_patrol_locate(&localiser, &seen);
}

static void test_a_robot_that_is_lost_and_finds_itself(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, locate());
    TEST_ASSERT_TRUE(seen.is_lost);
    TEST_ASSERT_FALSE(seen.has_laser);
    rig_search();
    TEST_ASSERT_EQUAL_INT(JP_OK, locate());
    TEST_ASSERT_TRUE(seen.has_laser);
    TEST_ASSERT_TRUE(seen.is_new_place);
    TEST_ASSERT_FALSE(seen.is_lost);
    TEST_ASSERT_NEAR(0.05f, robot.x, seen.laser.x);
    TEST_ASSERT_EQUAL_INT(JP_OK, locate());
    TEST_ASSERT_FALSE(seen.is_new_place);
}

static void test_wrong_arguments(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_locate(NULL, &seen));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_locate(&localiser, NULL));
    input.wheels.x = 1.0e6f;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, locate());
    TEST_ASSERT_TRUE(seen.is_lost);
}
