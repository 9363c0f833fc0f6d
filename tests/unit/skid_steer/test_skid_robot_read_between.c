/* A tick between a copy and the look whether it is whole: in a test with threads it comes by chance only. */
#include "src/base/compiler.h"

static void pass_between(void);

#undef JP_FENCE_ACQUIRE
#define JP_FENCE_ACQUIRE() pass_between()
#include "src/skid_steer/skid_robot_read.c"
#include "tests/support/skid_robot_rig.h"

static unsigned ticks_to_come; /* during the next copies */

static void pass_between(void)
{
    if (ticks_to_come > 0) {
        ticks_to_come--;
        run(1);
    }
}

static void test_telemetry_is_copied_again(void)
{
    make_driving();
    const struct jp_skid_telemetry before = telemetry();
    struct jp_skid_telemetry after;

    ticks_to_come = 2;
    TEST_ASSERT_TRUE(jp_skid_robot_telemetry(&robot, &after));
    TEST_ASSERT_EQUAL_UINT(0, ticks_to_come);
    TEST_ASSERT_EQUAL_UINT32(before.tick + 2, after.tick);
    TEST_ASSERT_EQUAL_UINT32(before.command_ticks_left - 2, after.command_ticks_left);
}
