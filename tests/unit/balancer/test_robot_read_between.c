/* A tick between a copy and the look whether it is whole: in a test with threads it comes by chance only. */
#include "src/base/compiler.h"

static void pass_between(void);

#undef JP_FENCE_ACQUIRE
#define JP_FENCE_ACQUIRE() pass_between()
#include "src/balancer/robot_read.c"
#include "tests/support/robot_rig.h"

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
    const struct jp_telemetry before = telemetry();
    struct jp_telemetry after;

    ticks_to_come = 2;
    TEST_ASSERT_TRUE(jp_robot_telemetry(&robot, &after));
    TEST_ASSERT_EQUAL_UINT(0, ticks_to_come);
    TEST_ASSERT_EQUAL_UINT32(before.tick + 2, after.tick);
    TEST_ASSERT_EQUAL_UINT32(before.segment_ticks_left - 2, after.segment_ticks_left);
}

static void test_currents_are_copied_again(void)
{
    struct jp_motor_sample sample;

    make_balancing();
    sensors.pitch_rate = JP_Q24(0.01);
    run(2);
    ticks_to_come = 2;
    TEST_ASSERT_TRUE(jp_robot_motors(&robot, &sample));
    TEST_ASSERT_EQUAL_UINT(0, ticks_to_come);
    TEST_ASSERT_EQUAL_INT32(sensors.current_left, sample.current_left);
    TEST_ASSERT_EQUAL_INT32(jp_q16_divide(sample.voltages.left, config.monitor.motor_resistance), sample.current_left);
    TEST_ASSERT_NOT_EQUAL(0, sample.current_left);
}

static void test_motors_that_are_switched_off_between_have_no_sample(void)
{
    struct jp_motor_sample sample;

    make_balancing();
    jp_robot_disable(&robot);
    ticks_to_come = 1;
    TEST_ASSERT_FALSE(jp_robot_motors(&robot, &sample));
}
