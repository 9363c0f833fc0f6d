/* The pilot: what a route will take, asked before and while it is driven. */
#include <joulepath/trajectory_energy.h>
#include <stddef.h>

#include "tests/support/pilot_rig.h"

static void test_question(void)
{
    struct jp_trajectory_leg legs[SLALOM];
    struct jp_trajectory trajectory;
    const struct jp_trajectory_task task = {.config = &robot_config.trajectory,
                                            .cruise = jp_cruise_speed(&model),
                                            .targets = slalom,
                                            .count = SLALOM,
                                            .to_stand = true};
    enum jp_status status;
    jp_q16 energy;

    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_trajectory_by_rule(&task, legs, &trajectory));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_trajectory_energy(&robot_config.trajectory, &model, &trajectory, &energy));
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK,
                            jp_pilot_ask(&pilot, &(struct jp_pilot_route){slalom, SLALOM, JP_PILOT_STAND, NULL, 0}));
    TEST_ASSERT_EQUAL_INT32(JP_WORKING, jp_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_EQUAL_INT32(-1, forecast.energy);
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), energy, forecast.energy);
    TEST_ASSERT_GREATER_THAN_INT32(0, forecast.deviation);
    jp_pilot_stop(&pilot);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_answer(&pilot, &forecast));
    ticks(100);
    expect_rest();
    TEST_ASSERT_EQUAL_UINT16(0, telemetry().segment);
    TEST_ASSERT_EQUAL_INT32(0, telemetry().position.x);
}

static void test_forecast_of_the_route_that_is_driven(void)
{
    struct jp_forecast asked;
    enum jp_status status;

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, &(struct jp_pilot_route){slalom, 2, JP_PILOT_STAND, NULL, 0}));
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_answer(&pilot, &asked));
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, 2));
    TEST_ASSERT_EQUAL_INT32(JP_WORKING, jp_pilot_answer(&pilot, &forecast));
    drive(slalom, 2);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_EQUAL_INT32(asked.energy, forecast.energy);
    TEST_ASSERT_EQUAL_INT32(asked.deviation, forecast.deviation);
}

/* Legs that take about 8 kJ each, and a sum that has no format: it is driven all the same. */
static void test_forecast_that_overflows(void)
{
    const struct jp_point far[] = {
        {JP_Q16(500), 0}, {JP_Q16(1000), 0}, {JP_Q16(1500), 0}, {JP_Q16(1000), JP_Q16(1)}, {JP_Q16(600), 0}};
    enum jp_status status;

    for (int pass = 0; pass < 2; pass++) {
        init();
        balance();
        TEST_ASSERT_EQUAL_INT32(JP_OK, follow(far, 5));
        (void)work_while(JP_PILOT_PLANNING, &status);
        TEST_ASSERT_EQUAL_INT32(JP_OK, status);
        TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_pilot_answer(&pilot, &forecast));
        TEST_ASSERT_EQUAL_INT32(INT32_MAX, forecast.energy);
        work_until_driving();
        jp_robot_disable(&robot);
        tick();
        config.learning = NULL;
    }
}

/* At a speed at which the electronics take most. */
static void test_leg_whose_energy_overflows(void)
{
    const struct jp_point far = {JP_Q16(500), 0};
    enum jp_status status;

    robot_config.limits.speed = JP_Q24(0.05);
    init();
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, &(struct jp_pilot_route){&far, 1, JP_PILOT_STAND, NULL, 0}));
    (void)work_while(JP_PILOT_PLANNING, &status);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_pilot_answer(&pilot, &forecast));
}

static void test_question_in_the_wrong_moment(void)
{
    const struct jp_segment_command other = {{JP_Q24(0.1), 0}, 0, JP_Q16(1)};

    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, &(struct jp_pilot_route){slalom, 1, JP_PILOT_STAND, NULL, 0}));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE,
                            jp_pilot_ask(&pilot, &(struct jp_pilot_route){slalom, 1, JP_PILOT_STAND, NULL, 0}));
    jp_pilot_stop(&pilot);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_robot_drive(&robot, &other));
    ticks(2);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE,
                            jp_pilot_ask(&pilot, &(struct jp_pilot_route){slalom, 1, JP_PILOT_STAND, NULL, 0}));
}

/* Nobody is to take the last plan's energy for the answer. */
static void test_question_that_is_given_up(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, &(struct jp_pilot_route){slalom, 2, JP_PILOT_STAND, NULL, 0}));
    jp_pilot_stop(&pilot);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_NO_PLAN, jp_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_EQUAL_INT32(-1, forecast.energy);
}

static void test_question_of_a_robot_that_falls(void)
{
    balance();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_ask(&pilot, &(struct jp_pilot_route){slalom, 2, JP_PILOT_STAND, NULL, 0}));
    robot.internal.estimator.pitch = JP_PHASE_TURN / 4;
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, jp_pilot_answer(&pilot, &forecast));
}
