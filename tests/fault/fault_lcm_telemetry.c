/* Frames on CAN at the gateway to LCM: they arrive in the units of the types, whatever is lost, late or wrong. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/lcm_rig.h"

#define HEADINGS (2 * M_PI)

static void put(uint32_t id, const void *data, uint8_t length)
{
    struct jp_can_frame frame = {.id = id, .length = length};

    memcpy(frame.data, data, length);
    TEST_ASSERT_EQUAL_INT(JP_OK, robot.port.send(robot.port.context, &frame));
}

/** Long enough for all messages to be taken. */
static void pass(void)
{
    for (int i = 0; i < 4; i++) {
        now_us += MS;
        lcm_gateway_pass(&gateway, now_us);
    }
}

#define PUT(NAME, name, ...)                                                                                           \
    do {                                                                                                               \
        const struct jp_can_##name##_t signals = {__VA_ARGS__};                                                        \
        uint8_t data[JP_CAN_LENGTH_MAX] = {0};                                                                         \
        (void)jp_can_##name##_pack(data, &signals, sizeof data);                                                       \
        put(JP_CAN_##NAME##_FRAME_ID, data, JP_CAN_##NAME##_LENGTH);                                                   \
    } while (0)

static void test_telemetry_arrives_in_the_units_of_the_types(void)
{
    PUT(POSE, pose, .x = JP_Q16(-12.5), .y = JP_Q16(3.25), .heading = -1024);
    PUT(MOTION, motion, .speed = 4096, .yaw_rate = -2048, .pitch = 655, .pitch_rate = 8192);
    PUT(REFERENCE, reference, .speed = 2048, .yaw_rate = 1024, .heading = 16384, .segment_time_left = 96);
    PUT(ECU_STATUS, ecu_status, .state = 2, .mode = 2, .operator_state = 1, .resets = 3);
    PUT(ECU_ERRORS, ecu_errors, .faults = 0x204);
    PUT(ROUTE_STATUS, route_status, .route_id = 9, .state = 3, .length = 7, .segment = 4, .segments_ended = 3,
        .plan_status = -4);
    PUT(CURRENT_SENSORS, current_sensors, .current_left = 512, .current_right = -128);
    PUT(MOTORS, motors, .voltage_left = 640, .voltage_right = -64, .saturated_ticks = 4000000000u);
    pass();
    TEST_ASSERT_EQUAL_UINT(1, states);
    TEST_ASSERT_EQUAL_INT64(6 * MS, state.utime);
    TEST_ASSERT_EQUAL_DOUBLE(-12.5, state.x);
    TEST_ASSERT_EQUAL_DOUBLE(3.25, state.y);
    TEST_ASSERT_EQUAL_DOUBLE(-0.25 * HEADINGS, state.heading);
    TEST_ASSERT_EQUAL_DOUBLE(1, state.speed);
    TEST_ASSERT_EQUAL_DOUBLE(-0.5 * HEADINGS, state.turn_rate);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 655 / 65536.0 * HEADINGS, state.pitch);
    TEST_ASSERT_EQUAL_DOUBLE(2 * HEADINGS, state.pitch_rate);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, state.reference_speed);
    TEST_ASSERT_EQUAL_DOUBLE(0.25 * HEADINGS, state.reference_turn_rate);
    TEST_ASSERT_EQUAL_DOUBLE(0.25 * HEADINGS, state.reference_heading);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, state.segment_time_left);
    TEST_ASSERT_EQUAL_DOUBLE(5, state.voltage_left);
    TEST_ASSERT_EQUAL_DOUBLE(-0.5, state.voltage_right);
    TEST_ASSERT_EQUAL_DOUBLE(2, state.current_left);
    TEST_ASSERT_EQUAL_DOUBLE(-0.5, state.current_right);
    TEST_ASSERT_EQUAL_INT64(4000000000, state.saturated_ticks);
    TEST_ASSERT_EQUAL_INT(2, state.robot_state);
    TEST_ASSERT_EQUAL_INT(1, state.operator_state);
    TEST_ASSERT_EQUAL_INT(3, state.resets);
    TEST_ASSERT_EQUAL_INT(0x204, state.faults);
    TEST_ASSERT_EQUAL_INT(9, state.route_id);
    TEST_ASSERT_EQUAL_INT(3, state.route_state);
    TEST_ASSERT_EQUAL_INT(7, state.route_length);
    TEST_ASSERT_EQUAL_INT(3, state.segments_ended);
    TEST_ASSERT_EQUAL_INT(-4, state.plan_status);
    TEST_ASSERT_EQUAL_STRING("", state.task_reason);
}

static void put_leg(uint8_t course, uint8_t after, double x, double y)
{
    PUT(COURSE_LEG, course_leg, .course = course, .after = after, .x = (uint16_t)(x * 128), .y = (uint16_t)(y * 128));
}

static void put_progress(uint8_t course, uint8_t legs)
{
    PUT(MAP_STATUS, map_status, .map_id = 3, .state = 2);
    PUT(NAVIGATION_STATUS, navigation_status, .goal_id = 200, .state = 5, .reason = 2, .answer = 6,
        .has_course = legs > 0, .forgets = 13, .vehicle_status = -7, .replans = 4, .course = course, .legs_left = legs);
    PUT(HOME_STATUS, home_status, .home_state = 6, .probability = 49152, .way = 404, .way_deviation = 20);
    PUT(HOME_BATTERY, home_battery, .left = 3200000, .left_deviation = 8);
    PUT(NAVIGATION_PROGRESS, navigation_progress, .distance = 160, .duration = 24, .energy = 324, .deviation = 12);
    pass();
}

static void test_what_the_navigator_does(void)
{
    put_progress(7, 2);
    TEST_ASSERT_EQUAL_UINT(1, navigations);
    TEST_ASSERT_EQUAL_INT(0, navigation.leg_count);
    TEST_ASSERT_EQUAL_INT(3, navigation.map_id);
    TEST_ASSERT_EQUAL_INT(2, navigation.map_state);
    TEST_ASSERT_EQUAL_INT(200, navigation.goal_id);
    TEST_ASSERT_EQUAL_INT(6, navigation.answer);
    TEST_ASSERT_EQUAL_INT(5, navigation.state);
    TEST_ASSERT_EQUAL_INT(2, navigation.reason);
    TEST_ASSERT_EQUAL_INT(-7, navigation.vehicle_status);
    TEST_ASSERT_EQUAL_INT(4, navigation.replans);
    TEST_ASSERT_EQUAL_INT(7, navigation.course);
    TEST_ASSERT_EQUAL_INT(13, navigation.forgets);
    TEST_ASSERT_EQUAL_DOUBLE(2.5, navigation.distance);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, navigation.duration);
    TEST_ASSERT_EQUAL_DOUBLE(40.5, navigation.energy);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, navigation.deviation);
    TEST_ASSERT_EQUAL_INT(6, navigation.home_state);
    TEST_ASSERT_EQUAL_DOUBLE(0.75, navigation.home_probability);
    TEST_ASSERT_EQUAL_DOUBLE(50.5, navigation.home_energy);
    TEST_ASSERT_EQUAL_DOUBLE(2.5, navigation.home_deviation);
    TEST_ASSERT_EQUAL_DOUBLE(200000, navigation.battery_energy);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, navigation.battery_deviation);
}

static void test_a_course_is_told_when_all_of_it_has_come(void)
{
    put_leg(7, 0, 12, 3.5);
    put_progress(7, 2);
    TEST_ASSERT_EQUAL_INT(0, navigation.leg_count);
    put_leg(7, 1, 4.25, 511.5);
    put_progress(7, 2);
    TEST_ASSERT_EQUAL_INT(2, navigation.leg_count);
    TEST_ASSERT_EQUAL_DOUBLE(4.25, navigation.legs[0].x);
    TEST_ASSERT_EQUAL_DOUBLE(511.5, navigation.legs[0].y);
    TEST_ASSERT_EQUAL_DOUBLE(12, navigation.legs[1].x);
    put_progress(7, 1);
    TEST_ASSERT_EQUAL_INT(1, navigation.leg_count);
    TEST_ASSERT_EQUAL_DOUBLE(12, navigation.legs[0].x);
    put_progress(7, 0);
    TEST_ASSERT_EQUAL_INT(0, navigation.leg_count);
    put_leg(8, 0, 1, 1);
    put_progress(7, 1);
    TEST_ASSERT_EQUAL_INT(0, navigation.leg_count);
    put_leg(8, 255, 1, 1);
    put_progress(8, 1);
    TEST_ASSERT_EQUAL_INT(1, navigation.leg_count);
    TEST_ASSERT_EQUAL_DOUBLE(1, navigation.legs[0].y);
}

static void put_plan(uint8_t segment, int32_t energy_raw)
{
    PUT(SEGMENT_MOTION, segment_motion, .segment = segment, .speed = JP_Q24(0.5), .turn_rate = -JP_Q24(0.25));
    PUT(SEGMENT_SHAPE, segment_shape, .segment = segment, .turn = JP_Q24(1.5), .duration = JP_Q16(20));
    PUT(SEGMENT_FORECAST, segment_forecast, .segment = segment, .energy = energy_raw);
}

static void test_plans_results_and_residuals(void)
{
    put_plan(1, JP_Q16(100));
    pass();
    TEST_ASSERT_EQUAL_UINT(1, plans);
    TEST_ASSERT_EQUAL_INT(0, plan.point_count);
    TEST_ASSERT_EQUAL_INT(1, plan.segment_count);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, plan.segments[0].speed);
    TEST_ASSERT_EQUAL_DOUBLE(-0.25, plan.segments[0].turn_rate);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, plan.segments[0].turn);
    TEST_ASSERT_EQUAL_DOUBLE(20, plan.segments[0].duration);
    TEST_ASSERT_EQUAL_DOUBLE(100, plan.segments[0].energy);
    for (uint8_t i = 0; i < 20; i++) {
        PUT(ENERGY_PARAMETER, energy_parameter, .index = i, .count = 20, .value = i * 65536 + 32768);
    }
    pass();
    TEST_ASSERT_EQUAL_UINT(1, identifications);
    TEST_ASSERT_EQUAL_DOUBLE(12.5, identification.a[12]);
    TEST_ASSERT_EQUAL_DOUBLE(13.5, identification.b[0]);
    TEST_ASSERT_EQUAL_DOUBLE(15.5, identification.electronics_power);
    TEST_ASSERT_EQUAL_DOUBLE(19.5, identification.motor_resistance);
    TEST_ASSERT_EQUAL_INT(0, identification.segment_count);
    put_plan(2, JP_Q16(50));
    PUT(SEGMENT_RESULT, segment_result, .segment = 1, .spent = (uint32_t)JP_Q16(101.5) / 16, .drawn = -JP_Q16(2) / 16);
    pass();
    TEST_ASSERT_EQUAL_UINT(2, identifications);
    TEST_ASSERT_EQUAL_INT(1, identification.segment_count);
    TEST_ASSERT_EQUAL_DOUBLE(100, identification.residuals[0].forecast);
    TEST_ASSERT_EQUAL_DOUBLE(-1.5, identification.residuals[0].residual);
    TEST_ASSERT_EQUAL_UINT(1, energies);
    TEST_ASSERT_EQUAL_INT(1, energy.segment);
    TEST_ASSERT_EQUAL_DOUBLE(101.5, energy.segment_spent);
    TEST_ASSERT_EQUAL_DOUBLE(-2, energy.segment_drawn);
    put_plan(1, JP_Q16(7));
    now_us += 1000 * MS;
    PUT(ENERGY_SPENT, energy_spent, .energy = (int64_t)3 << 31);
    pass();
    TEST_ASSERT_EQUAL_INT(1, plan.segment_count);
    TEST_ASSERT_EQUAL_INT(0, energy.segment);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, energy.spent);
}

static void test_lost_frames_of_a_plan_show_as_unknown(void)
{
    put_plan(1, JP_Q16(100));
    PUT(SEGMENT_SHAPE, segment_shape, .segment = 2, .turn = JP_Q24(1), .duration = JP_Q16(20));
    PUT(SEGMENT_FORECAST, segment_forecast, .segment = 4, .energy = JP_Q16(30));
    pass();
    TEST_ASSERT_EQUAL_UINT(2, plans);
    TEST_ASSERT_EQUAL_INT(4, plan.segment_count);
    TEST_ASSERT_EQUAL_DOUBLE(100, plan.segments[0].energy);
    TEST_ASSERT_EQUAL_DOUBLE(1, plan.segments[1].turn);
    TEST_ASSERT_DOUBLE_IS_NAN(plan.segments[1].speed);
    TEST_ASSERT_DOUBLE_IS_NAN(plan.segments[1].energy);
    TEST_ASSERT_EQUAL_INT(3, plan.segments[2].index);
    TEST_ASSERT_DOUBLE_IS_NAN(plan.segments[2].turn);
    TEST_ASSERT_DOUBLE_IS_NAN(plan.segments[3].speed);
    TEST_ASSERT_EQUAL_DOUBLE(30, plan.segments[3].energy);
    PUT(SEGMENT_RESULT, segment_result, .segment = 9, .spent = 4096);
    pass();
    TEST_ASSERT_EQUAL_INT(9, energy.segment);
    TEST_ASSERT_DOUBLE_IS_NAN(energy.segment_forecast);
}

static void test_segment_numbers_and_parameters_out_of_range(void)
{
    put_plan(0, JP_Q16(1));
    put_plan(255, JP_Q16(1));
    for (int i = 0; i < 300; i++) {
        PUT(SEGMENT_RESULT, segment_result, .segment = 255, .spent = 4096);
        PUT(SEGMENT_RESULT, segment_result, .segment = 0, .spent = 4096);
        pass();
    }
    for (unsigned i = 0; i < 256; i++) {
        PUT(ENERGY_PARAMETER, energy_parameter, .index = (uint8_t)i, .count = 21, .value = 65536);
        PUT(ENERGY_PARAMETER, energy_parameter, .index = (uint8_t)(i | 0x20u), .count = 20, .value = 65536);
        pass();
    }
    TEST_ASSERT_EQUAL_UINT(1, plans);
    TEST_ASSERT_EQUAL_INT(255, plan.segment_count);
    TEST_ASSERT_EQUAL_UINT(0, identifications);
}

static void test_a_flood_is_published_at_most_50_times_a_second(void)
{
    for (int i = 0; i < 3000; i++) {
        PUT(MOTORS, motors, .voltage_left = 1);
        PUT(ENERGY_SPENT, energy_spent, .energy = i);
        now_us += MS;
        lcm_gateway_pass(&gateway, now_us);
    }
    pass();
    TEST_ASSERT_UINT_WITHIN(2, 150, states);
    TEST_ASSERT_UINT_WITHIN(2, 150, energies);
}

static void test_jittering_frames_all_count(void)
{
    const uint64_t start_us = now_us;

    for (unsigned i = 1; i <= 500; i++) {
        now_us = start_us + i * 20 * MS + (uint64_t)random_uniform(&noise, 0, 15 * MS);
        PUT(MOTORS, motors, .voltage_left = 1);
        lcm_gateway_pass(&gateway, now_us);
    }
    pass();
    TEST_ASSERT_EQUAL_UINT(500, states);
}

static void test_any_frame_is_borne(void)
{
    static const uint32_t ids[] = {0x10,  0x20,  0x21,  0x22,  0x100, 0x101, 0x102, 0x103, 0x180,
                                   0x181, 0x182, 0x183, 0x184, 0x185, 0x186, 0x187, 0x188, 0x189,
                                   0x18a, 0x18b, 0x18c, 0x18d, 0x18e, 0x190, 0x7f1, 0x7ff, 0x40000183};

    for (int i = 0; i < 10 * JUNK; i++) {
        const uint32_t id = ids[(size_t)random_uniform(&noise, 0, sizeof ids / sizeof ids[0])];
        uint8_t data[8];

        for (size_t at = 0; at < sizeof data; at++) {
            data[at] = (uint8_t)random_uniform(&noise, 0, 256);
        }
        put(id, data, (uint8_t)random_uniform(&noise, 0, 9));
        now_us += MS;
        lcm_gateway_pass(&gateway, now_us);
        drain();
    }
    TEST_ASSERT_GREATER_THAN_UINT(100, states);
    TEST_ASSERT_GREATER_THAN_UINT(10, plans);
    TEST_ASSERT_EQUAL_UINT64(0, gateway.telemetry.unsent);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_IDLE, gateway.operator.commander.phase);
}

static void simulate_at(uint16_t rate, uint32_t from, uint32_t until)
{
    for (uint32_t tick = from; tick < until; tick++) {
        PUT(SIM_TIME, sim_time, .tick = tick, .power = 1, .rate = rate);
        if (tick % 20 == 0) {
            PUT(MOTORS, motors, .voltage_left = 1);
        }
        lcm_gateway_pass(&gateway, now_us);
        drain();
    }
}

static void simulate(uint32_t from, uint32_t until)
{
    simulate_at(1000, from, until);
}

static void test_in_lockstep_time_is_that_of_the_simulation(void)
{
    simulate(1000000, 1001000); /* the wall stands still */
    pass();
    TEST_ASSERT_EQUAL_UINT(50, states);
    TEST_ASSERT_EQUAL_INT64(1000980000, state.utime);
}

static void test_in_lockstep_a_tick_lasts_as_long_as_it_says(void)
{
    simulate_at(100, 1000, 1100);
    pass();
    TEST_ASSERT_EQUAL_INT64(10800000, state.utime);
}

static void test_ticks_that_do_not_say_how_long_they_last_are_no_time(void)
{
    simulate_at(0, 1000, 1100);
    TEST_ASSERT_FALSE(gateway.lockstep);
    pass();
    TEST_ASSERT_TRUE(state.utime <= (int64_t)now_us);
}

static void test_another_simulation_begins_at_0_again_and_the_task_outlasts_it(void)
{
    simulate(50000, 50100);
    put_plan(1, JP_Q16(1));
    pass();
    TEST_ASSERT_EQUAL_INT(0, lcm_publish(lcm, "JP_ROUTE", sound_route.bytes, (unsigned)sound_route.size));
    pass();
    PUT(SIM_TIME, sim_time, .tick = UINT32_MAX, .power = 0, .rate = 1000);
    simulate(0, 1000);
    pass();
    TEST_ASSERT_EQUAL_UINT(5 + 50, states);
    TEST_ASSERT_EQUAL_INT64(980000, state.utime);
    TEST_ASSERT_EQUAL_INT(0, gateway.telemetry.planned);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, gateway.operator.commander.phase);
}

static void test_a_failed_task_is_told_with_its_reason(void)
{
    TEST_ASSERT_TRUE(is_taken("JP_ROUTE", &sound_route));
    PUT(ECU_STATUS, ecu_status, .state = 3);
    PUT(ECU_STATUS, ecu_status, .state = 3);
    PUT(MOTORS, motors, .voltage_left = 1);
    pass();
    TEST_ASSERT_EQUAL_INT(JP_STATE_T_TASK_FAILED, state.task);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(state.task_reason, "fallen"), state.task_reason);
}

int main(void)
{
    printf("seed %u\n", SEED);
    make_packets();
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
