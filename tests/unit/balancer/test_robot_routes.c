/* Routes that a robot plans and drives: to their end, failures, and what forgets or replaces them. */
#include "tests/support/robot_rig.h"

static void test_follow_refuses(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_follow(&robot, route, 2));
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_follow(&robot, NULL, 2));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_follow(&robot, route, 0));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
    setUp();
    make_fallen();
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_robot_follow(&robot, route, 2));
}

static void test_route_is_driven_to_its_end(void)
{
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    run(1);
    expect_state(JP_ROBOT_DRIVING);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    TEST_ASSERT_EQUAL_UINT16(1, robot.internal.route_planned); /* the next one when this one nears its end */

    uint32_t left = telemetry().segment_ticks_left;

    work(left - 100U);
    TEST_ASSERT_EQUAL_UINT16(1, robot.internal.route_planned);
    work(102);
    TEST_ASSERT_EQUAL_UINT16(2, robot.internal.route_planned);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segment);
    work(telemetry().segment_ticks_left + 1U);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segments_ended);
    work(10);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_planning_failure_stops_the_robot(void)
{
    static const struct jp_point far[] = {{JP_Q16(0.3), 0}, {JP_Q16(1000), 0}};
    static const struct jp_point again[] = {{JP_Q16(2), 0}};

    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, far, 2));
    work(1);

    uint32_t left = telemetry().segment_ticks_left;

    work(left - 100U);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_work(&robot));
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_robot_work(&robot)); /* the first failure stays */
    expect_state(JP_ROBOT_DRIVING);
    run(100);
    expect_state(JP_ROBOT_BALANCING);
    jp_robot_stop(&robot);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_work(&robot));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, again, 1));
    work(2); /* the stop comes first */
    expect_state(JP_ROBOT_DRIVING);
}

static void test_infeasible_and_empty_targets_are_failures(void)
{
    static const struct jp_point behind = {JP_Q16(-1), 0};
    static const struct jp_point here = {0, 0};

    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, &here, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, jp_robot_work(&robot));
    config.limits.turn = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, &behind, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, jp_robot_work(&robot));
    run(10);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_stop_and_disable_forget_the_route(void)
{
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
    work(1);
    jp_robot_stop(&robot);
    work(RATE);
    expect_state(JP_ROBOT_BALANCING);

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
    work(1);
    disable();
    work(RATE);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_a_fall_forgets_the_route(void)
{
    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
    work(1);
    robot.internal.estimator.pitch = JP_PHASE_TURN / 8;
    work(1);
    expect_state(JP_ROBOT_FALLEN);
    work(1);
    robot.internal.estimator.pitch = 0;
    run(1);
    disable();
    work(RATE);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_follow_replaces_the_waiting_segment(void)
{
    static const struct jp_point other = {JP_Q16(0.5), 0};

    make_balancing();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, route, 2));
    work(1);
    work(telemetry().segment_ticks_left - 50U);
    TEST_ASSERT_EQUAL_UINT16(2, robot.internal.route_planned);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_follow(&robot, &other, 1));
    work(1);
    TEST_ASSERT_EQUAL_UINT16(1, robot.internal.route_planned);
    work(60);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segment);
    work(telemetry().segment_ticks_left + 5U);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(2, telemetry().segments_ended);
}
