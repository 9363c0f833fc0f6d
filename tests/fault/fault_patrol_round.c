/* Rounds of the patrol robot's application over a bus in a scene: it goes round, is home while the energy lasts and
 * goes on; and while things fail, the operator falls silent, somebody says Stand, frames and samples fail to come, the
 * controller restarts, what is asked for cannot be. Each time the robot touches nothing and the round ends by name. */
#include <math.h>
#include <string.h>

#include "hal/can/round_code.h"
#include "sim/bus/bus_drive.h"
#include "sim/bus/local_ecu.h"
#include "sim/four_wheel/four_wheel_file.h"
#include "sim/scenes/patrol_scene.h"
#include "tests/support/frame_thief.h"
#include "tests/support/map_frames.h"
#include "tests/support/round_frames.h"
#include "unity.h"

#define STREAM_MAX  8192
#define ROUND_TICKS 30000
#define STAND_TICKS 300
#define FULL        3500.0 /* J, for some stays */
#define CHARGER     300.0  /* W */
#define DWELL       20.0f  /* s */

/* Until all frames of a report have come. */
#define REPORT_TICKS 25U

#define RESERVE 100.0f

static struct local_ecu ecu;
static struct bus_drive drive;
static struct patrol_body body;
static struct patrol_battery battery;
static struct jp_navigation_operator commander;
static struct four_wheel_file file;
static struct patrol_scene scene;
static uint8_t stream[STREAM_MAX];
static struct jp_map_stream map;
static struct jp_patrol_round_config config;
static uint8_t bytes[JP_ROUND_BYTES_MAX];
static struct jp_round_bytes round_bytes;

static void ask_for_round(void)
{
    jp_round_encode(&config, bytes);
    round_bytes = (struct jp_round_bytes){.bytes = bytes, .stops = (uint8_t)config.stop_count};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_patrol(&commander, &map, &round_bytes));
}

static void enter_scene(void)
{
    const struct planar_pose charger = {(double)scene.start.x, (double)scene.start.y, (double)scene.start.heading};
    struct jp_can_link link;

    TEST_ASSERT_TRUE(four_wheel_file_load("sim/robots/patrol.cfg", &file));
    TEST_ASSERT_TRUE(local_ecu_start_patrol(&ecu, patrol_robot_find("patrol"), &link));
    TEST_ASSERT_TRUE(patrol_body_init(&body, &file, &scene, 1));
    patrol_battery_init(&battery, FULL, CHARGER, &charger);
    body.battery = &battery;
    body.is_world_moving = true;
    bus_drive_init_patrol(&drive, &body, &link);
    thief_enter(&drive.link);
    memset(&commander, 0, sizeof commander);
    drive.navigation = &commander;
}

static void set_map(void)
{
    const struct jp_place origin = {
        {(jp_q16)lround((double)scene.start.x * 65536), (jp_q16)lround((double)scene.start.y * 65536)},
        (jp_angle)llround((double)scene.start.heading / (2 * M_PI) * 4294967296.0)};

    map = (struct jp_map_stream){.bytes = stream, .id = 1};
    map.length = (uint16_t)jp_map_encode(&scene.map, &origin, stream, sizeof stream);
    TEST_ASSERT_GREATER_THAN_UINT16(0, map.length);
}

void setUp(void)
{
    patrol_scene_make(PATROL_L_PASSAGE, 1, &scene);
    enter_scene();
    set_map();
    config = (struct jp_patrol_round_config){.stops = {{scene.goal, DWELL}},
                                             .stop_count = 1,
                                             .charger = scene.start,
                                             .full = (float)FULL,
                                             .reserve = RESERVE,
                                             .deviations = 1.645f};
}

void tearDown(void)
{
    patrol_body_free(&body);
    patrol_scene_free(&scene);
}

static void pass(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        TEST_ASSERT_TRUE(bus_drive_lockstep(&drive));
    }
}

static void pass_until(uint8_t round_state)
{
    for (unsigned i = 0; i < ROUND_TICKS && drive.view.round.state != round_state; i++) {
        pass(1);
    }
    TEST_ASSERT_EQUAL_UINT8(round_state, drive.view.round.state);
}

static double speed(void)
{
    return hypot(body.plant.state.forward, body.plant.state.left);
}

static double distance_to(const struct jp_plane_pose *place)
{
    return hypot(body.plant.state.pose.x - (double)place->x, body.plant.state.pose.y - (double)place->y);
}

static void pass_until_it_rolls(void)
{
    pass_until(JP_ROUND_TOLD_LEAVING);
    for (unsigned i = 0; i < ROUND_TICKS && speed() < 0.5; i++) {
        pass(1);
    }
    TEST_ASSERT_TRUE(speed() >= 0.5);
}

static void expect_told(uint8_t round_state, uint8_t reason)
{
    pass(REPORT_TICKS);
    TEST_ASSERT_EQUAL_UINT8(round_state, drive.view.round.state);
    TEST_ASSERT_EQUAL_UINT8(reason, drive.view.round.reason);
}

static void expect_stand(void)
{
    pass(STAND_TICKS);
    TEST_ASSERT_EQUAL_UINT8(JP_ECU_STANDING, drive.view.status.state);
    TEST_ASSERT_TRUE(speed() < 0.01);
    TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_NONE, body.world.first_touch);
}

static void expect_failure(enum jp_navigation_failure failure)
{
    for (unsigned i = 0; i < ROUND_TICKS && commander.phase != JP_NAVIGATION_FAILED; i++) {
        pass(1);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(failure, commander.failure, jp_navigation_failure_text(commander.failure));
}

static void expect_stopped(void)
{
    expect_told(JP_ROUND_TOLD_STOPPED, JP_ROUND_REASON_TOLD);
    expect_stand();
}

static void say_stand(void)
{
    const struct jp_can_frame frame = operator_command((commander.command_counter + 9U) & 15U, JP_MODE_STAND, 0);

    TEST_ASSERT_EQUAL_INT(JP_OK, drive.link.port.send(drive.link.port.context, &frame));
}

/* Nothing fails. */

static void test_it_goes_round_and_is_home_while_the_energy_lasts(void)
{
    ask_for_round();
    pass_until(JP_ROUND_TOLD_SURVEYING);
    TEST_ASSERT_EQUAL_UINT8(JP_GOAL_DRIVEN, drive.view.navigation.answer);
    TEST_ASSERT_EQUAL_UINT8(drive.view.round.round_id, drive.view.navigation.goal_id);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, drive.view.round_battery.least_left);
    for (unsigned charge = 1; charge <= 2; charge++) {
        pass_until(JP_ROUND_TOLD_DWELLING);
        TEST_ASSERT_TRUE(distance_to(&scene.goal) < 0.15);
        TEST_ASSERT_EQUAL_UINT8(0, drive.view.round.stop);
        pass_until(JP_ROUND_TOLD_HOMING);
        TEST_ASSERT_EQUAL_UINT8(1, drive.view.round.stop);
        pass_until(JP_ROUND_TOLD_CHARGING);
        TEST_ASSERT_TRUE(distance_to(&scene.start) < 0.15);
        TEST_ASSERT_EQUAL_UINT8(charge, drive.view.round.charges);
        TEST_ASSERT_TRUE(drive.view.round.visits >= charge);
    }
    TEST_ASSERT_TRUE(drive.view.round_battery.least_left / 16.0 >= (double)RESERVE);
    TEST_ASSERT_TRUE(battery.held_j > (double)RESERVE);
    pass_until(JP_ROUND_TOLD_LEAVING);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATION_DRIVING, commander.phase);
    TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_NONE, body.world.first_touch);
    TEST_ASSERT_EQUAL_UINT8(0, drive.view.losses.rejected);
}

static void test_away_from_the_charger_it_counts_what_the_battery_holds(void)
{
    ask_for_round();
    pass_until(JP_ROUND_TOLD_DWELLING);
    thief_steal(JP_CAN_BATTERY_CHARGE_FRAME_ID, UINT32_MAX, 0); /* there is none to be lost */
    pass(REPORT_TICKS);
    TEST_ASSERT_TRUE(battery.held_j < FULL - 300);
    TEST_ASSERT_TRUE(fabs(drive.view.round_battery.held / 16.0 - battery.held_j) < 20);
    TEST_ASSERT_EQUAL_UINT(0, thief.seen);
}

/* The operator outranks it. */

static void test_the_operator_falls_silent(void)
{
    ask_for_round();
    pass_until_it_rolls();
    drive.conditions.operator_silent = true;
    pass(60);
    expect_stopped();
    TEST_ASSERT_EQUAL_UINT8(JP_OPERATOR_LOST, drive.view.status.operator_state);
}

static void test_anybody_says_stand_and_the_next_round_begins_with_the_way_to_the_charger(void)
{
    ask_for_round();
    pass_until_it_rolls();
    pass(200);
    say_stand();
    expect_failure(JP_NAVIGATION_STOPPED);
    expect_stopped();
    TEST_ASSERT_TRUE(distance_to(&scene.start) > 0.3);
    ask_for_round();
    pass_until(JP_ROUND_TOLD_HOMING);
    pass_until(JP_ROUND_TOLD_CHARGING);
    TEST_ASSERT_TRUE(distance_to(&scene.start) < 0.15);
    pass_until(JP_ROUND_TOLD_DWELLING);
    TEST_ASSERT_TRUE(drive.view.round.visits > 0U);
    TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_NONE, body.world.first_touch);
}

static void test_a_stand_ends_it_in_each_state(void)
{
    static const uint8_t states[] = {JP_ROUND_TOLD_SURVEYING, JP_ROUND_TOLD_DWELLING, JP_ROUND_TOLD_HOMING,
                                     JP_ROUND_TOLD_CHARGING};

    for (unsigned i = 0; i < sizeof states / sizeof states[0]; i++) {
        ask_for_round();
        pass_until(states[i]);
        say_stand();
        expect_failure(JP_NAVIGATION_STOPPED);
        expect_stopped();
    }
}

static void test_a_goal_takes_its_place(void)
{
    const struct jp_map_goal goal = {.x = (uint16_t)((double)scene.goal.x / 0.05),
                                     .y = (uint16_t)((double)scene.goal.y / 0.05)};

    ask_for_round();
    pass_until_it_rolls();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &goal));
    pass(20);
    TEST_ASSERT_EQUAL_UINT8(JP_ROUND_TOLD_STOPPED, drive.view.round.state);
    for (unsigned i = 0; i < ROUND_TICKS && commander.phase != JP_NAVIGATION_DONE; i++) {
        pass(1);
    }
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATION_DONE, commander.phase);
    TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_NONE, body.world.first_touch);
}

/* Frames by hand, while the operator says nothing of rounds. */

static struct sent_round by_hand;

static void send(struct jp_can_frame frame)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, drive.link.port.send(drive.link.port.context, &frame));
    pass(1);
}

static void send_round(uint8_t id)
{
    jp_round_encode(&config, bytes);
    by_hand = (struct sent_round){.bytes = bytes, .stops = (uint8_t)config.stop_count, .map = 1, .id = id};
    send(round_offer(&by_hand));
    for (uint32_t i = 0; i < JP_ROUND_FRAMES(config.stop_count); i++) {
        send(round_data(&by_hand, i));
    }
}

static void send_map(void)
{
    const struct jp_map_goal goal = {.x = (uint16_t)((double)scene.goal.x / 0.05),
                                     .y = (uint16_t)((double)scene.goal.y / 0.05)};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &goal));
    for (unsigned i = 0; i < ROUND_TICKS && commander.phase != JP_NAVIGATION_ASKING; i++) {
        pass(1);
    }
    jp_navigation_operator_stop(&commander);
    pass(20);
}

static void test_under_way_neither_round_nor_map_is_replaced(void)
{
    struct sent_map other = {.bytes = stream, .length = 30, .id = 2};

    ask_for_round();
    pass_until_it_rolls();
    const uint8_t id = drive.view.round.round_id;

    send_round((uint8_t)(id + 100U));
    send(map_offer(&other));
    pass(REPORT_TICKS);
    TEST_ASSERT_EQUAL_UINT8(id, drive.view.round.round_id);
    TEST_ASSERT_EQUAL_UINT8(JP_ROUND_REASON_UNDER_WAY, drive.view.round.reason);
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.map.map_id);
    TEST_ASSERT_EQUAL_UINT8(JP_MAP_REASON_UNDER_WAY, drive.view.map.reason);
    pass_until(JP_ROUND_TOLD_DWELLING);
    say_stand();
    pass(1);
    expect_told(JP_ROUND_TOLD_STOPPED, JP_ROUND_REASON_TOLD);
}

static void test_a_goal_drops_a_round_that_waits_and_a_map_ends_it(void)
{
    const struct jp_map_goal goal = {
        .map = 1, .id = 77, .x = (uint16_t)((double)scene.goal.x / 0.05), .y = (uint16_t)((double)scene.goal.y / 0.05)};
    struct sent_map other = {.bytes = stream, .length = 30, .id = 2};

    send_map();
    send_round(50);
    expect_told(JP_ROUND_TOLD_READY, JP_ROUND_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT8(50, drive.view.navigation.goal_id);
    TEST_ASSERT_EQUAL_UINT8(JP_GOAL_TAKEN, drive.view.navigation.answer);
    send(map_goal(7, &goal));
    send(map_goal(8, &goal));
    expect_told(JP_ROUND_TOLD_STOPPED, JP_ROUND_REASON_TOLD);
    TEST_ASSERT_EQUAL_UINT8(77, drive.view.navigation.goal_id);
    send_round(51);
    expect_told(JP_ROUND_TOLD_READY, JP_ROUND_REASON_NONE);
    send(map_offer(&other));
    expect_told(JP_ROUND_TOLD_STOPPED, JP_ROUND_REASON_MAP_GONE);
    TEST_ASSERT_EQUAL_UINT8(0, drive.view.navigation.goal_id);
}

static void test_a_round_that_is_received_ends_with_its_map(void)
{
    struct sent_map other = {.bytes = stream, .length = 30, .id = 2};

    send_map();
    jp_round_encode(&config, bytes);
    by_hand = (struct sent_round){.bytes = bytes, .stops = 1, .map = 1, .id = 50};
    send(round_offer(&by_hand));
    expect_told(JP_ROUND_TOLD_RECEIVING, JP_ROUND_REASON_NONE);
    send(map_offer(&other));
    expect_told(JP_ROUND_TOLD_REJECTED, JP_ROUND_REASON_MAP_GONE);
}

/* What cannot be. */

static void expect_rejected(enum jp_round_reason reason, enum jp_round_field field, uint8_t stop)
{
    send_round(50);
    expect_told(JP_ROUND_TOLD_REJECTED, (uint8_t)reason);
    TEST_ASSERT_EQUAL_UINT8(field, drive.view.round.field);
    TEST_ASSERT_EQUAL_UINT8(stop, drive.view.round.stop);
    TEST_ASSERT_EQUAL_UINT8(0, drive.view.round.visits);
}

static void test_without_a_map_it_is_refused(void)
{
    pass(20);
    expect_rejected(JP_ROUND_REASON_NO_MAP, JP_ROUND_FIELD_NONE, 0);
}

static void test_what_is_out_of_range_is_named(void)
{
    const struct jp_patrol_round_config good = config;

    send_map();
    config.full = 0;
    expect_rejected(JP_ROUND_REASON_FIELD, JP_ROUND_FIELD_FULL, 0);
    config = good;
    config.deviations = 10.5f;
    expect_rejected(JP_ROUND_REASON_FIELD, JP_ROUND_FIELD_DEVIATIONS, 0);
    config = good;
    config.stops[0].dwell = 90000.0f;
    expect_rejected(JP_ROUND_REASON_FIELD, JP_ROUND_FIELD_STOP_DWELL, 0);
    config = good;
    config.stops[0].pose.x = 32767.5f;
    expect_rejected(JP_ROUND_REASON_FIELD, JP_ROUND_FIELD_STOP_POSE, 0);
    config = good;
    config.charger.y = 32767.5f;
    expect_rejected(JP_ROUND_REASON_FIELD, JP_ROUND_FIELD_CHARGER, 0);
}

static void test_where_it_cannot_stand_is_named(void)
{
    send_map();
    config.stops[1] = (struct jp_patrol_stop){{0.1f, 0.1f, 0.0f}, 0.0f};
    config.stop_count = 2;
    expect_rejected(JP_ROUND_REASON_BLOCKED, JP_ROUND_FIELD_NONE, 1);
    config.stop_count = 1;
    config.charger.x = -1.0f;
    expect_rejected(JP_ROUND_REASON_BLOCKED, JP_ROUND_FIELD_NONE, 1);
}

static void test_a_battery_that_does_not_suffice_is_named(void)
{
    config.full = 300.0f;
    battery.full_j = 300;
    battery.held_j = 300;
    ask_for_round();
    expect_failure(JP_NAVIGATION_ROUND_ENDED);
    expect_told(JP_ROUND_TOLD_FAILED, JP_ROUND_REASON_NO_ENERGY);
    TEST_ASSERT_EQUAL_UINT8(0, drive.view.round.stop);
    expect_stand();
    TEST_ASSERT_TRUE(distance_to(&scene.start) < 0.05);
}

static void test_without_word_of_the_battery_it_does_not_begin(void)
{
    thief_steal(JP_CAN_BATTERY_CHARGE_FRAME_ID, UINT32_MAX, 0);
    ask_for_round();
    expect_failure(JP_NAVIGATION_NO_START);
    TEST_ASSERT_EQUAL_UINT8(JP_ROUND_REASON_NO_BATTERY, commander.round.reason);
    TEST_ASSERT_EQUAL_UINT32(0, drive.view.round_battery.held);
    expect_told(JP_ROUND_TOLD_READY, JP_ROUND_REASON_NO_BATTERY);
    expect_stand();
    thief.count = 0;
    pass(30);
    ask_for_round();
    pass_until(JP_ROUND_TOLD_DWELLING);
}

/* What gets lost. */

static void test_frames_of_the_round_that_get_lost_are_sent_again(void)
{
    thief_steal(JP_CAN_ROUND_DATA_FRAME_ID, 100, 5);
    ask_for_round();
    pass_until(JP_ROUND_TOLD_SURVEYING);
    TEST_ASSERT_TRUE(thief.seen > JP_ROUND_FRAMES(1));
}

static void test_without_samples_it_brakes_with_a_fault(void)
{
    ask_for_round();
    pass_until_it_rolls();
    thief_steal(JP_CAN_SUPPLY_SENSORS_FRAME_ID, 150, 0);
    pass(120);
    TEST_ASSERT_TRUE(speed() < 0.01);
    TEST_ASSERT_EQUAL_UINT8(JP_ECU_FAULT, drive.view.status.state);
    expect_failure(JP_NAVIGATION_FAULT);
    expect_told(JP_ROUND_TOLD_FAILED, JP_ROUND_REASON_FAULT);
    TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_NONE, body.world.first_touch);
}

static void test_without_scans_it_stands_and_tries_to_get_home(void)
{
    ask_for_round();
    pass_until_it_rolls();
    thief_steal(JP_CAN_SCAN_END_FRAME_ID, 600, 0);
    pass(300);
    TEST_ASSERT_TRUE(speed() < 0.01);
    TEST_ASSERT_TRUE(drive.view.round.state < JP_ROUND_TOLD_FAILED);
    thief.count = 0;
    for (unsigned i = 0; i < ROUND_TICKS && drive.view.round.charges == 0U; i++) {
        pass(1);
    }
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.round.charges);
    TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_NONE, body.world.first_touch);
}

static void test_the_controller_restarts_while_it_drives(void)
{
    ask_for_round();
    pass_until_it_rolls();
    drive.conditions.ecu_reset = true;
    pass(2);
    drive.conditions.ecu_reset = false;
    expect_failure(JP_NAVIGATION_RESTART);
    expect_stand();
    TEST_ASSERT_EQUAL_UINT8(JP_ROUND_TOLD_NONE, drive.view.round.state);
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.status.resets);
}
