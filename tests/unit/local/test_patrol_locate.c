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

/* Without scans it grows with the way. */
static void test_how_sure_the_place_is(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &robot));
    TEST_ASSERT_EQUAL_INT(JP_OK, locate());

    const float sure = seen.deviation;

    TEST_ASSERT_TRUE(sure > 0.0f && sure < 0.05f);
    for (unsigned i = 0; i < 10U; i++) {
        seen.wheels.x += 0.1f;
        seen.scan.ranges = NULL;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_locate(&localiser, &seen));
    }
    TEST_ASSERT_TRUE(seen.deviation > 0.1f);
    TEST_ASSERT_NEAR(1.0e-6f, localiser.position_deviation, seen.deviation);
}

static void test_wrong_arguments(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_locate(NULL, &seen));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_locate(&localiser, NULL));
    input.wheels.x = 1.0e6f;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, locate());
    TEST_ASSERT_TRUE(seen.is_lost);
}
