/* The whole application on a bus: from idle over a route to its end, the operator's silence, cycle times. */
#include "tests/support/ecu_rig.h"

/* Start */

static void test_init_refuses_what_jp_robot_init_does(void)
{
    const struct jp_energy_model *model = &jp_energy_model_courier24;
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, ecu_start(&ecu, NULL, &config, model, &port, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, ecu_start(&ecu, &balancer, NULL, model, &port, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, ecu_start(&ecu, &balancer, &config, NULL, &port, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, ecu_start(&ecu, &balancer, &config, model, &port, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_balancer_init(&balancer, &config, model, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, ecu_start(NULL, &balancer, &config, model, &port, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, ecu_start(&ecu, &balancer, &config, model, NULL, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_init(&ecu, NULL, &port, NULL));
    config.monitor.tilt_limit = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, ecu_start(&ecu, &balancer, &config, model, &port, NULL, &field));
    TEST_ASSERT_EQUAL_STRING("monitor.tilt_limit", field);
}

static void test_before_the_first_sample_it_only_reports(void)
{
    run_without_samples(1000);
    TEST_ASSERT_EQUAL_UINT(0, bus.commands);
    TEST_ASSERT_EQUAL_UINT16(10, bus.counts[0]);
    TEST_ASSERT_EQUAL_UINT16(50, bus.counts[4]);
    TEST_ASSERT_EQUAL_HEX16(0, jp_robot_last_tick(&balancer.robot)->faults);
    TEST_ASSERT_EQUAL_UINT16(0, jp_ecu_lost_samples(&ecu));
    TEST_ASSERT_NULL(jp_retained_newest(&retained));
}

static void test_the_tick_may_begin_when_a_sample_is_complete(void)
{
    TEST_ASSERT_FALSE(give_sample()); /* the first is not used */
    TEST_ASSERT_TRUE(give_sample());
    TEST_ASSERT_FALSE(give_sample()); /* the one before still waits */
    tick();
    TEST_ASSERT_TRUE(give_sample());
}

static void test_works_without_retained_memory(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, ecu_start(&ecu, &balancer, &config, &jp_energy_model_courier24, &port, NULL, &field));
    make_balancing();
    TEST_ASSERT_EQUAL_UINT32(0, ecu.resets);
}

/* The way of a route */

static void test_from_idle_over_a_route_to_its_end(void)
{
    make_driving();
    for (int i = 0; i < 100 && ecu.internal.routes.state == JP_ROUTE_DRIVING; i++) {
        hold(JP_MODE_DRIVE, 7, 1);
    }
    expect_route(JP_ROUTE_DONE, JP_REASON_NONE);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(2, jp_robot_last_tick(&balancer.robot)->segments_ended);
    for (unsigned kind = 0xA; kind <= 0xD; kind++) { /* plan and result of each segment */
        TEST_ASSERT_EQUAL_UINT16(2, bus.counts[kind]);
        TEST_ASSERT_EQUAL_UINT8(2, bus.last[kind][0]);
    }
    TEST_ASSERT_EQUAL_UINT8(7, bus.last[3][0]);
    TEST_ASSERT_EQUAL_UINT8(JP_ROUTE_DONE, bus.last[3][1]);
    hold(JP_MODE_DRIVE, 7, 5); /* driven once */
    expect_state(JP_ROBOT_BALANCING);
    hold(JP_MODE_OFF, 0, 3);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_HEX16(0, jp_robot_last_tick(&balancer.robot)->faults);
    TEST_ASSERT_LESS_OR_EQUAL_UINT(4, bus.most_in_a_tick);
}

static void test_status_frames_show_what_is_so(void)
{
    make_driving();
    TEST_ASSERT_EQUAL_HEX8(JP_ROBOT_DRIVING | JP_MODE_DRIVE << 3 | JP_OPERATOR_ALIVE << 5, bus.last[0][0]);
    TEST_ASSERT_EQUAL_HEX8(JP_ROUTE_DRIVING, bus.last[3][1]);
}

static void test_stand_stops_a_route(void)
{
    make_driving();
    command(JP_MODE_STAND, 0);
    run(2);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_COMMAND);
    expect_state(JP_ROBOT_BALANCING);
    hold(JP_MODE_DRIVE, 7, 5); /* a stopped route is not taken up again */
    expect_state(JP_ROBOT_BALANCING);
}

static void test_stand_of_a_second_node_stops_a_route(void)
{
    const uint8_t others = (uint8_t)(3U + JP_E2E_GAP_MAX);
    struct jp_can_frame frame;

    make_driving();
    frame = operator_command((command_counter + others) & 15U, JP_MODE_STAND, 0);
    (void)jp_ecu_accept(&ecu, &frame);
    command(JP_MODE_DRIVE, 7);
    run(2);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_COMMAND);
    expect_state(JP_ROBOT_BALANCING);
    hold(JP_MODE_DRIVE, 7, 5);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_off_switches_off_from_driving(void)
{
    make_driving();
    command(JP_MODE_OFF, 0);
    command(JP_MODE_OFF, 0);
    run(3);
    expect_state(JP_ROBOT_DRIVING);
    command(JP_MODE_OFF, 0);
    run(3);
    expect_state(JP_ROBOT_IDLE);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_SWITCHED_OFF);
}

static void test_a_fall_ends_the_route(void)
{
    make_driving();
    balancer.robot.internal.estimator.pitch = JP_PHASE_TURN / 8;
    run(2);
    expect_state(JP_ROBOT_FALLEN);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_SWITCHED_OFF);
    hold(JP_MODE_STAND, 0, 3);
    expect_state(JP_ROBOT_FALLEN);
    expect_refused(3, JP_REFUSAL_FALLEN);
    hold(JP_MODE_OFF, 0, 3);
    balancer.robot.internal.estimator.pitch = JP_PHASE_TURN / 8;
    hold(JP_MODE_STAND, 0, 1);
    expect_state(JP_ROBOT_IDLE);
    expect_refused(4, JP_REFUSAL_NOT_UPRIGHT);
    balancer.robot.internal.estimator.pitch = 0;
    hold(JP_MODE_STAND, 0, 2);
    expect_state(JP_ROBOT_BALANCING);
    expect_refused(4, JP_REFUSAL_NONE);
}

static void test_the_next_route_is_received_while_one_is_driven(void)
{
    static const struct jp_point other = {JP_Q16(0.5), 0};

    make_driving();
    offer(8, &other, 1);
    expect_route(JP_ROUTE_READY, JP_REASON_NONE);
    expect_state(JP_ROBOT_DRIVING);
    TEST_ASSERT_EQUAL_UINT8(7, ecu.internal.routes.driven.id);
    hold(JP_MODE_DRIVE, 8, 3);
    expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT8(8, ecu.internal.routes.driven.id);
    for (int i = 0; i < 100 && ecu.internal.routes.state == JP_ROUTE_DRIVING; i++) {
        hold(JP_MODE_DRIVE, 8, 1);
    }
    expect_route(JP_ROUTE_DONE, JP_REASON_NONE);
}

static void test_a_goal_is_driven_to_and_changed_on_the_way(void)
{
    static const struct jp_point first = {JP_Q16(0.3), 0};
    static const struct jp_point second = {0, JP_Q16(0.3)};
    struct jp_can_frame frame;
    uint8_t goals = 0;

    make_balancing();
    for (unsigned i = 0; i < 150 && ecu.internal.routes.state != JP_ROUTE_DONE; i++) {
        frame = goal(++goals & 15U, i < 8U ? first : second);
        (void)jp_ecu_accept(&ecu, &frame);
        hold(JP_MODE_DRIVE, JP_ROUTE_GOAL, 1);
        if (i >= 3U && i < 8U) {
            TEST_ASSERT_EQUAL_INT32(first.x, ecu.internal.routes.driven.points[0].x);
        }
        if (i >= 8U) {
            TEST_ASSERT_EQUAL_INT32(second.y, ecu.internal.routes.driven.points[0].y);
        }
    }
    expect_route(JP_ROUTE_DONE, JP_REASON_NONE);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_a_route_that_cannot_be_planned_stops_with_the_reason(void)
{
    static const struct jp_point here = {0, 0};

    make_balancing();
    offer(7, &here, 1);
    hold(JP_MODE_DRIVE, 7, 3);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_PLAN);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_INT8(JP_ERR_ZERO_LENGTH, (int8_t)bus.last[3][6]);
}

static void test_a_late_plan_is_not_the_end_of_the_route(void)
{
    make_driving();
    for (int i = 0; i < 10000 && jp_robot_state_now(&balancer.robot) == JP_ROBOT_DRIVING; i++) {
        (void)give_sample(); /* the background is busy */
        tick();
    }
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT16(1, jp_robot_last_tick(&balancer.robot)->segments_ended);
    ecu.internal.worked_tick = ecu.tick; /* not so long that the operator counts as lost */
    jp_ecu_work(&ecu);
    expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
    run(2);
    expect_state(JP_ROBOT_DRIVING);
    for (int i = 0; i < 100 && ecu.internal.routes.state == JP_ROUTE_DRIVING; i++) {
        hold(JP_MODE_DRIVE, 7, 1);
    }
    expect_route(JP_ROUTE_DONE, JP_REASON_NONE);
}

/* The operator's silence */

static void test_silence_stops_a_driving_robot_within_500_ms(void)
{
    make_driving();
    command(JP_MODE_DRIVE, 7);
    run(498);
    expect_operator(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
    expect_state(JP_ROBOT_DRIVING);
    run(3);
    expect_operator(JP_OPERATOR_LOST, JP_MODE_STAND);
    expect_state(JP_ROBOT_BALANCING);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_TIMEOUT);
    TEST_ASSERT_EQUAL_UINT8(1, ecu.operator_timeouts);
    run(2000);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT8(1, ecu.operator_timeouts);
}

static void test_after_a_silence_only_stand_and_then_drive_set_it_moving(void)
{
    static const struct jp_point other = {JP_Q16(0.5), 0};

    make_driving();
    run(600);
    offer(8, &other, 1);
    hold(JP_MODE_DRIVE, 8, 10);
    expect_state(JP_ROBOT_BALANCING);
    expect_route(JP_ROUTE_READY, JP_REASON_NONE);
    command(JP_MODE_STAND, 0);
    hold(JP_MODE_DRIVE, 8, 3);
    expect_state(JP_ROBOT_DRIVING);
}

static void test_a_lost_operator_does_not_switch_an_idle_robot_on(void)
{
    make_balancing();
    run(600);
    expect_operator(JP_OPERATOR_LOST, JP_MODE_STAND);
    jp_robot_disable(&balancer.robot);
    run(100);
    expect_state(JP_ROBOT_IDLE);
}

static void test_a_fault_stays_until_the_operator_switches_off(void)
{
    run(3);
    sensors.bus_voltage = 0;
    run(10);
    sensors.bus_voltage = JP_Q16(24);
    expect_state(JP_ROBOT_FAULT);
    run(1000); /* nobody is there */
    expect_state(JP_ROBOT_FAULT);
    expect_refused(0, JP_REFUSAL_NONE);
    hold(JP_MODE_STAND, 0, 3); /* the first command is not obeyed */
    expect_state(JP_ROBOT_FAULT);
    expect_refused(2, JP_REFUSAL_FAULT);
    TEST_ASSERT_EQUAL_HEX8(JP_FAULT_BUS_VOLTAGE, bus.last[1][0]);
    hold(JP_MODE_OFF, 0, 4);
    expect_state(JP_ROBOT_IDLE);
    TEST_ASSERT_EQUAL_HEX8(0, bus.last[1][0]);
}

/* Cycle times */

static void check_a_second(uint32_t tick_rate)
{
    static const uint16_t expected[32] = {10, 10, 10, 10, 50, 50, 50, 50, 50, 10, 0, 0, 0, 0, 10, 0};

    start(tick_rate);
    (void)give_sample();
    run(tick_rate);
    TEST_ASSERT_EQUAL_UINT(tick_rate, bus.commands);
    TEST_ASSERT_EQUAL_UINT16_ARRAY(expected, bus.counts, 32);
}

static void test_a_second_has_the_frames_of_the_dbc(void)
{
    check_a_second(1000);
    TEST_ASSERT_EQUAL_UINT(2, bus.most_in_a_tick);
    check_a_second(100);
    check_a_second(400);
    check_a_second(500);
    check_a_second(2000);
}
