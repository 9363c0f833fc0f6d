/* An operator that sends a map and a goal: what it sends and when, what gets lost on the way, and a silent, fallen,
 * restarted or unwilling ECU, played by hand. prop_bus_navigation.c has the real one. */
#include "hal/app/navigation_operator.h"

#include <string.h>

#include <joulepath/robot.h>

#include "hal/storage/crc32.h"
#include "unity.h"

enum { LENGTH = 103, FRAMES = 21, SENT_MAX = 64 };

static struct jp_navigation_operator commander;
static struct jp_can_frame sent[SENT_MAX];
static unsigned sent_count;
static enum jp_status answer; /* of the port */
static uint32_t now_ms;
static uint8_t stream[LENGTH];
static struct jp_map_stream map;
static struct jp_map_goal goal;

static enum jp_status take(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    if (answer == JP_OK) {
        TEST_ASSERT_LESS_THAN_UINT(SENT_MAX, sent_count);
        sent[sent_count++] = *frame;
    }
    return answer;
}

static const struct jp_can_port port = {.send = take};

void setUp(void)
{
    memset(&commander, 0, sizeof commander);
    for (unsigned i = 0; i < LENGTH; i++) {
        stream[i] = (uint8_t)(17U * i + 3U);
    }
    map = (struct jp_map_stream){.bytes = stream, .length = LENGTH, .id = 4};
    goal = (struct jp_map_goal){.x = 30, .y = 2, .has_heading = true, .heading = JP_ANGLE_DEGREES(90)};
    sent_count = 0;
    answer = JP_OK;
    now_ms = UINT32_MAX - 2000U; /* it wraps on the way */
}

void tearDown(void)
{
}

/* What the ECU says. */

static void say_ecu_once(enum jp_robot_state state, enum jp_operator_state heard)
{
    const struct jp_can_ecu_status_t signals = {.state = (uint8_t)state, .operator_state = (uint8_t)heard};
    struct jp_can_frame frame = {.id = JP_CAN_ECU_STATUS_FRAME_ID, .length = JP_CAN_ECU_STATUS_LENGTH};

    (void)jp_can_ecu_status_pack(frame.data, &signals, sizeof frame.data);
    jp_navigation_operator_accept(&commander, &frame);
}

static void say_ecu(enum jp_robot_state state, enum jp_operator_state heard)
{
    say_ecu_once(state, heard);
    say_ecu_once(state, heard);
}

static void say_map_once(enum jp_map_link_state state, enum jp_map_reason reason, uint16_t received, uint8_t cells)
{
    const bool has_map = state != JP_MAP_LINK_NONE;
    const struct jp_can_map_status_t signals = {.map_id = has_map ? 4U : 0U,
                                                .state = (uint8_t)state,
                                                .reason = (uint8_t)reason,
                                                .cell_counter = cells,
                                                .received = received,
                                                .map_crc = has_map ? jp_crc32(0, stream, LENGTH) : 0U};
    struct jp_can_frame frame = {.id = JP_CAN_MAP_STATUS_FRAME_ID, .length = JP_CAN_MAP_STATUS_LENGTH};

    (void)jp_can_map_status_pack(frame.data, &signals, sizeof frame.data);
    jp_navigation_operator_accept(&commander, &frame);
}

static void say_map(enum jp_map_link_state state, enum jp_map_reason reason, uint16_t received)
{
    say_map_once(state, reason, received, 0);
    say_map_once(state, reason, received, 0);
}

static void say_cells(uint8_t counter)
{
    say_map_once(JP_MAP_LINK_READY, JP_MAP_REASON_NONE, FRAMES, counter);
}

static void say_navigator_once(uint8_t id, enum jp_goal_answer said, enum jp_navigator_state state)
{
    const struct jp_can_navigation_status_t signals = {.goal_id = id, .answer = (uint8_t)said, .state = (uint8_t)state};
    struct jp_can_frame frame = {.id = JP_CAN_NAVIGATION_STATUS_FRAME_ID, .length = JP_CAN_NAVIGATION_STATUS_LENGTH};

    (void)jp_can_navigation_status_pack(frame.data, &signals, sizeof frame.data);
    jp_navigation_operator_accept(&commander, &frame);
}

static void say_navigator(uint8_t id, enum jp_goal_answer said, enum jp_navigator_state state)
{
    say_navigator_once(id, said, state);
    say_navigator_once(id, said, state);
}

/* What it sends. */

/** So many ms; what is sent then is left to be looked at, the newest at most. */
static void pass(unsigned duration_ms)
{
    for (unsigned i = 0; i < duration_ms; i++) {
        sent_count = sent_count > SENT_MAX - 2U ? 0 : sent_count;
        jp_navigation_operator_tick(&commander, now_ms, &port);
        now_ms++;
    }
}

static unsigned count_of(uint32_t id)
{
    unsigned count = 0;

    for (unsigned i = 0; i < sent_count; i++) {
        count += sent[i].id == id ? 1U : 0U;
    }
    return count;
}

static const struct jp_can_frame *last_of(uint32_t id)
{
    for (unsigned i = sent_count; i > 0U; i--) {
        if (sent[i - 1U].id == id) {
            return &sent[i - 1U];
        }
    }
    TEST_FAIL_MESSAGE("no such frame was sent");
    return NULL;
}

static void expect_command(enum jp_operator_mode mode, uint8_t id)
{
    struct jp_can_operator_command_t command;

    sent_count = 0;
    pass(100);
    (void)jp_can_operator_command_unpack(&command, last_of(JP_CAN_OPERATOR_COMMAND_FRAME_ID)->data, 4);
    TEST_ASSERT_EQUAL_UINT8(mode, command.mode);
    TEST_ASSERT_EQUAL_UINT8(id, command.route_id);
    TEST_ASSERT_EQUAL_UINT(1, count_of(JP_CAN_OPERATOR_COMMAND_FRAME_ID));
}

static void expect_phase(enum jp_navigation_phase phase)
{
    TEST_ASSERT_EQUAL_INT(phase, commander.phase);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATION_NO_FAILURE, commander.failure);
}

static void expect_failure(enum jp_navigation_failure failure)
{
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATION_FAILED, commander.phase);
    TEST_ASSERT_EQUAL_INT(failure, commander.failure);
    TEST_ASSERT_GREATER_THAN_UINT(20, strlen(jp_navigation_failure_text(failure)));
    expect_command(JP_MODE_STAND, 0);
}

static void go(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &goal));
}

static void make_sending(void)
{
    go();
    expect_phase(JP_NAVIGATION_STANDING_UP);
    say_map(JP_MAP_LINK_NONE, JP_MAP_REASON_NONE, 0);
    pass(1);
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    expect_phase(JP_NAVIGATION_SENDING);
}

static void make_asking(void)
{
    make_sending();
    say_map(JP_MAP_LINK_READY, JP_MAP_REASON_NONE, FRAMES);
    expect_phase(JP_NAVIGATION_ASKING);
}

static void make_driving(void)
{
    make_asking();
    say_navigator(commander.goal.id, JP_GOAL_TAKEN, JP_NAVIGATOR_IDLE);
    expect_phase(JP_NAVIGATION_DRIVING);
}

static void make_under_way(void)
{
    make_driving();
    say_navigator(commander.goal.id, JP_GOAL_DRIVEN, JP_NAVIGATOR_PLANNING);
    expect_phase(JP_NAVIGATION_DRIVING);
}

/* Before. */

static void test_says_nothing_unasked(void)
{
    pass(5000);
    TEST_ASSERT_EQUAL_UINT(0, sent_count);
    jp_navigation_operator_stop(&commander);
    pass(5000);
    TEST_ASSERT_EQUAL_UINT(0, sent_count);
    expect_phase(JP_NAVIGATION_IDLE);
}

static void test_what_it_refuses(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_go(NULL, &map, &goal));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_go(&commander, NULL, &goal));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_go(&commander, &map, NULL));
    map.id = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_go(&commander, &map, &goal));
    map.id = 16;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_go(&commander, &map, &goal));
    map.id = 15;
    map.length = 21;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_go(&commander, &map, &goal));
    map.length = LENGTH;
    map.bytes = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_go(&commander, &map, &goal));
    expect_phase(JP_NAVIGATION_IDLE);
}

static void test_commands_stand_until_the_robot_stands(void)
{
    go();
    say_map(JP_MAP_LINK_NONE, JP_MAP_REASON_NONE, 0);
    expect_command(JP_MODE_STAND, 0);
    say_ecu(JP_ROBOT_IDLE, JP_OPERATOR_ALIVE);
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_LOST);
    expect_phase(JP_NAVIGATION_STANDING_UP);
    say_ecu_once(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    expect_phase(JP_NAVIGATION_STANDING_UP);
    say_ecu_once(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    expect_phase(JP_NAVIGATION_SENDING);
    expect_command(JP_MODE_STAND, 0);
}

/* The map. */

static void test_offers_the_map_until_it_is_received(void)
{
    struct jp_can_map_offer_t offer;

    make_sending();
    sent_count = 0;
    pass(300);
    TEST_ASSERT_UINT_WITHIN(1, 3, count_of(JP_CAN_MAP_OFFER_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT(0, count_of(JP_CAN_MAP_DATA_FRAME_ID));
    (void)jp_can_map_offer_unpack(&offer, last_of(JP_CAN_MAP_OFFER_FRAME_ID)->data, 8);
    TEST_ASSERT_EQUAL_UINT8(4, offer.map_id);
    TEST_ASSERT_EQUAL_UINT16(LENGTH, offer.bytes);
    TEST_ASSERT_EQUAL_HEX32(jp_crc32(0, stream, LENGTH), offer.map_crc);
    say_map(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE, 0);
    sent_count = 0;
    pass(50);
    TEST_ASSERT_EQUAL_UINT(0, count_of(JP_CAN_MAP_OFFER_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT(FRAMES, count_of(JP_CAN_MAP_DATA_FRAME_ID));
}

/** In order, from a frame on; the last is filled up with 0. */
static void expect_data_from(unsigned first)
{
    unsigned index = first;

    for (unsigned i = 0; i < sent_count; i++) {
        struct jp_can_map_data_t data;

        if (sent[i].id != JP_CAN_MAP_DATA_FRAME_ID) {
            continue;
        }
        (void)jp_can_map_data_unpack(&data, sent[i].data, 8);
        TEST_ASSERT_EQUAL_UINT16(index, data.index);
        for (unsigned byte = 0; byte < JP_MAP_DATA; byte++) {
            const unsigned place = index * JP_MAP_DATA + byte;

            TEST_ASSERT_EQUAL_HEX8(place < LENGTH ? stream[place] : 0U, sent[i].data[3U + byte]);
        }
        index++;
    }
    TEST_ASSERT_EQUAL_UINT(FRAMES, index);
}

static void test_sends_the_map_in_its_order(void)
{
    make_sending();
    pass(5);
    say_map(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE, 0);
    sent_count = 0;
    pass(60);
    expect_data_from(0);
}

static void test_goes_back_to_what_is_missing(void)
{
    make_sending();
    pass(5);
    say_map(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE, 0);
    pass(60);
    say_map_once(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE, 6, 0);
    sent_count = 0;
    pass(60);
    TEST_ASSERT_EQUAL_UINT(0, count_of(JP_CAN_MAP_DATA_FRAME_ID));
    say_map_once(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE, 6, 0);
    sent_count = 0;
    pass(60);
    expect_data_from(6);
}

static void test_goes_on_where_another_has_stopped(void)
{
    go();
    say_map(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE, 9);
    pass(1);
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    sent_count = 0;
    pass(60);
    TEST_ASSERT_EQUAL_UINT(0, count_of(JP_CAN_MAP_OFFER_FRAME_ID));
    expect_data_from(9);
}

static void test_begins_anew_when_the_ecu_has_restarted(void)
{
    make_sending();
    pass(5);
    say_map(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE, 12);
    pass(60);
    say_map(JP_MAP_LINK_NONE, JP_MAP_REASON_NONE, 0);
    sent_count = 0;
    pass(101);
    TEST_ASSERT_UINT_WITHIN(1, 1, count_of(JP_CAN_MAP_OFFER_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT(0, count_of(JP_CAN_MAP_DATA_FRAME_ID));
    say_map(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE, 0);
    sent_count = 0;
    pass(60);
    expect_data_from(0);
}

static void test_a_map_that_is_there_is_not_sent(void)
{
    go();
    say_map(JP_MAP_LINK_READY, JP_MAP_REASON_NONE, FRAMES);
    pass(1);
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    say_map(JP_MAP_LINK_READY, JP_MAP_REASON_NONE, FRAMES);
    expect_phase(JP_NAVIGATION_ASKING);
    sent_count = 0;
    pass(50);
    TEST_ASSERT_EQUAL_UINT(0, count_of(JP_CAN_MAP_OFFER_FRAME_ID) + count_of(JP_CAN_MAP_DATA_FRAME_ID));
}

static void test_a_map_that_came_damaged_is_offered_again(void)
{
    make_sending();
    pass(5);
    say_map(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE, FRAMES);
    say_map(JP_MAP_LINK_REJECTED, JP_MAP_REASON_CRC, FRAMES);
    expect_phase(JP_NAVIGATION_SENDING);
    sent_count = 0;
    pass(200);
    TEST_ASSERT_EQUAL_UINT(0, count_of(JP_CAN_MAP_OFFER_FRAME_ID));
    pass(110);
    TEST_ASSERT_EQUAL_UINT(1, count_of(JP_CAN_MAP_OFFER_FRAME_ID));
}

static void test_a_map_that_is_refused(void)
{
    static const enum jp_map_reason reasons[] = {JP_MAP_REASON_TOO_LARGE, JP_MAP_REASON_CELL_SIZE};

    for (unsigned i = 0; i < sizeof reasons / sizeof reasons[0]; i++) {
        setUp();
        make_sending();
        pass(5);
        say_map(JP_MAP_LINK_REJECTED, reasons[i], 5);
        expect_failure(JP_NAVIGATION_MAP);
    }
}

static void test_a_map_that_stays_damaged(void)
{
    make_sending();
    for (unsigned i = 0; i < 60 && commander.phase == JP_NAVIGATION_SENDING; i++) {
        say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
        pass(310);
        say_map(JP_MAP_LINK_REJECTED, JP_MAP_REASON_FORMAT, 5);
    }
    expect_failure(JP_NAVIGATION_MAP);
}

static void test_a_map_while_another_is_driven_on(void)
{
    make_sending();
    pass(5);
    say_map(JP_MAP_LINK_NONE, JP_MAP_REASON_UNDER_WAY, 0);
    expect_failure(JP_NAVIGATION_MAP);
}

static void test_a_map_that_never_arrives(void)
{
    make_sending();
    for (unsigned i = 0; i < 1300 && commander.phase == JP_NAVIGATION_SENDING; i++) {
        say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
        say_map(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE, 3);
        pass(100);
    }
    expect_failure(JP_NAVIGATION_LOST);
}

/* The goal. */

static void test_asks_until_the_goal_is_named(void)
{
    struct jp_can_map_goal_t asked;

    make_asking();
    sent_count = 0;
    pass(300);
    TEST_ASSERT_UINT_WITHIN(1, 3, count_of(JP_CAN_MAP_GOAL_FRAME_ID));
    (void)jp_can_map_goal_unpack(&asked, last_of(JP_CAN_MAP_GOAL_FRAME_ID)->data, 8);
    TEST_ASSERT_EQUAL_UINT8(4, asked.map_id);
    TEST_ASSERT_EQUAL_UINT8(commander.goal.id, asked.goal_id);
    TEST_ASSERT_EQUAL_UINT16(30, asked.column);
    TEST_ASSERT_EQUAL_UINT16(2, asked.row);
    TEST_ASSERT_EQUAL_UINT8(1, asked.has_heading);
    TEST_ASSERT_EQUAL_INT16(1024, asked.heading);
    say_navigator(77, JP_GOAL_TAKEN, JP_NAVIGATOR_IDLE);
    expect_phase(JP_NAVIGATION_ASKING);
}

static void test_each_task_has_another_goal_id(void)
{
    uint8_t before = 0;

    for (unsigned i = 0; i < 600; i++) {
        make_asking();
        TEST_ASSERT_NOT_EQUAL_UINT8(before, commander.goal.id);
        TEST_ASSERT_NOT_EQUAL_UINT8(0, commander.goal.id);
        before = commander.goal.id;
    }
}

static void test_its_goal_id_is_none_that_the_ecu_has(void)
{
    say_navigator(1, JP_GOAL_DRIVEN, JP_NAVIGATOR_ARRIVED);
    make_asking();
    TEST_ASSERT_EQUAL_UINT8(2, commander.goal.id);
}

static void test_a_goal_that_is_refused(void)
{
    for (enum jp_goal_answer refusal = JP_GOAL_NO_MAP; refusal <= JP_GOAL_BLOCKED; refusal++) {
        setUp();
        make_asking();
        say_navigator(commander.goal.id, refusal, JP_NAVIGATOR_IDLE);
        expect_failure(JP_NAVIGATION_GOAL);
        TEST_ASSERT_EQUAL_UINT8(refusal, commander.navigator.answer);
    }
}

/* The drive. */

static void test_commands_navigate(void)
{
    make_driving();
    expect_command(JP_MODE_NAVIGATE, commander.goal.id);
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_LOST);
    expect_command(JP_MODE_STAND, 0);
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    say_navigator(commander.goal.id, JP_GOAL_DRIVEN, JP_NAVIGATOR_DRIVING);
    expect_command(JP_MODE_NAVIGATE, commander.goal.id);
    expect_phase(JP_NAVIGATION_DRIVING);
}

static void test_arrives(void)
{
    make_under_way();
    say_navigator_once(commander.goal.id, JP_GOAL_DRIVEN, JP_NAVIGATOR_ARRIVED);
    expect_phase(JP_NAVIGATION_DRIVING);
    say_navigator_once(commander.goal.id, JP_GOAL_DRIVEN, JP_NAVIGATOR_ARRIVED);
    expect_phase(JP_NAVIGATION_DONE);
    expect_command(JP_MODE_STAND, 0);
}

static void test_how_a_drive_can_fail(void)
{
    static const struct {
        enum jp_navigator_state state;
        enum jp_navigation_failure failure;
    } ends[] = {{JP_NAVIGATOR_UNREACHABLE, JP_NAVIGATION_UNREACHABLE},
                {JP_NAVIGATOR_FAILED, JP_NAVIGATION_GAVE_UP},
                {JP_NAVIGATOR_IDLE, JP_NAVIGATION_STOPPED}};

    for (unsigned i = 0; i < sizeof ends / sizeof ends[0]; i++) {
        setUp();
        make_under_way();
        say_navigator(commander.goal.id, JP_GOAL_DRIVEN, ends[i].state);
        expect_failure(ends[i].failure);
    }
}

static void test_it_comes_home_instead(void)
{
    static const struct {
        enum jp_navigator_state state;
        enum jp_navigation_failure failure;
    } ends[] = {{JP_NAVIGATOR_ARRIVED, JP_NAVIGATION_CAME_HOME},
                {JP_NAVIGATOR_IDLE, JP_NAVIGATION_NO_WAY_HOME},
                {JP_NAVIGATOR_UNREACHABLE, JP_NAVIGATION_NO_WAY_HOME},
                {JP_NAVIGATOR_FAILED, JP_NAVIGATION_NO_WAY_HOME}};

    for (unsigned i = 0; i < sizeof ends / sizeof ends[0]; i++) {
        setUp();
        make_driving();
        say_navigator(commander.goal.id, JP_GOAL_HOME, JP_NAVIGATOR_DRIVING);
        expect_phase(JP_NAVIGATION_DRIVING);
        expect_command(JP_MODE_NAVIGATE, commander.goal.id);
        say_navigator(commander.goal.id, JP_GOAL_HOME, ends[i].state);
        expect_failure(ends[i].failure);
    }
}

static void test_it_is_stopped_on_its_way_home(void)
{
    const struct jp_can_navigation_status_t signals = {
        .answer = JP_GOAL_HOME, .state = JP_NAVIGATOR_IDLE, .reason = JP_NAVIGATOR_TOLD};

    make_under_way();
    struct jp_can_navigation_status_t stopped = signals;
    struct jp_can_frame frame = {.id = JP_CAN_NAVIGATION_STATUS_FRAME_ID, .length = JP_CAN_NAVIGATION_STATUS_LENGTH};

    stopped.goal_id = commander.goal.id;
    (void)jp_can_navigation_status_pack(frame.data, &stopped, sizeof frame.data);
    jp_navigation_operator_accept(&commander, &frame);
    jp_navigation_operator_accept(&commander, &frame);
    expect_failure(JP_NAVIGATION_STOPPED);
}

static void test_hears_of_the_way_home(void)
{
    const struct jp_can_home_status_t home = {
        .home_state = JP_HOME_TOLD_SUFFICES, .probability = 65000, .way = 1000000, .way_deviation = 77};
    const struct jp_can_home_battery_t battery = {.left = 3000000000U, .left_deviation = 5};
    struct jp_can_frame frame = {.id = JP_CAN_HOME_STATUS_FRAME_ID, .length = JP_CAN_HOME_STATUS_LENGTH};

    (void)jp_can_home_status_pack(frame.data, &home, sizeof frame.data);
    jp_navigation_operator_accept(&commander, &frame);
    frame.id = JP_CAN_HOME_BATTERY_FRAME_ID;
    (void)jp_can_home_battery_pack(frame.data, &battery, sizeof frame.data);
    jp_navigation_operator_accept(&commander, &frame);
    TEST_ASSERT_EQUAL_UINT8(JP_HOME_TOLD_SUFFICES, commander.home.home_state);
    TEST_ASSERT_EQUAL_UINT32(1000000, commander.home.way);
    TEST_ASSERT_EQUAL_UINT32(77, commander.home.way_deviation);
    TEST_ASSERT_EQUAL_UINT32(3000000000U, commander.battery.left);
    TEST_ASSERT_EQUAL_UINT32(5, commander.battery.left_deviation);
    /* Of a wrong length they are ignored. */
    memset(frame.data, 0, sizeof frame.data);
    frame.length = 7;
    jp_navigation_operator_accept(&commander, &frame);
    frame.id = JP_CAN_HOME_STATUS_FRAME_ID;
    jp_navigation_operator_accept(&commander, &frame);
    TEST_ASSERT_EQUAL_UINT16(65000, commander.home.probability);
    TEST_ASSERT_EQUAL_UINT32(5, commander.battery.left_deviation);
}

static void test_a_goal_that_is_blocked_when_it_is_to_be_driven_to(void)
{
    make_driving();
    say_navigator(commander.goal.id, JP_GOAL_BLOCKED, JP_NAVIGATOR_IDLE);
    expect_failure(JP_NAVIGATION_GOAL);
}

static void test_another_goal_or_map_takes_its_place(void)
{
    make_under_way();
    say_navigator(99, JP_GOAL_TAKEN, JP_NAVIGATOR_DRIVING);
    expect_failure(JP_NAVIGATION_RESTART);
    setUp();
    make_under_way();
    say_map(JP_MAP_LINK_NONE, JP_MAP_REASON_NONE, 0);
    expect_failure(JP_NAVIGATION_RESTART);
    setUp();
    make_asking();
    say_map(JP_MAP_LINK_RECEIVING, JP_MAP_REASON_NONE, 1);
    expect_failure(JP_NAVIGATION_RESTART);
}

static void test_a_robot_that_falls_or_fails(void)
{
    make_under_way();
    say_ecu(JP_ROBOT_FALLEN, JP_OPERATOR_ALIVE);
    expect_failure(JP_NAVIGATION_FALLEN);
    setUp();
    make_sending();
    say_ecu(JP_ROBOT_FAULT, JP_OPERATOR_ALIVE);
    expect_failure(JP_NAVIGATION_FAULT);
}

static void test_stop_ends_the_task(void)
{
    make_under_way();
    jp_navigation_operator_stop(&commander);
    expect_phase(JP_NAVIGATION_IDLE);
    expect_command(JP_MODE_STAND, 0);
    say_ecu(JP_ROBOT_FALLEN, JP_OPERATOR_ALIVE);
    say_navigator(commander.goal.id, JP_GOAL_DRIVEN, JP_NAVIGATOR_FAILED);
    expect_phase(JP_NAVIGATION_IDLE);
}

/* Silence. */

static void test_nobody_answers(void)
{
    go();
    pass(10100);
    expect_failure(JP_NAVIGATION_SILENCE);
}

static void test_a_robot_that_does_not_stand_up(void)
{
    go();
    for (unsigned i = 0; i < 105; i++) {
        say_ecu(JP_ROBOT_IDLE, JP_OPERATOR_ALIVE);
        say_map(JP_MAP_LINK_NONE, JP_MAP_REASON_NONE, 0);
        pass(100);
    }
    expect_failure(JP_NAVIGATION_STAND_UP);
}

static void test_the_ecu_falls_silent(void)
{
    make_under_way();
    pass(900);
    expect_phase(JP_NAVIGATION_DRIVING);
    pass(200);
    expect_failure(JP_NAVIGATION_SILENCE);
}

static void test_an_ecu_without_a_navigator(void)
{
    go();
    for (unsigned i = 0; i < 105; i++) {
        say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
        pass(100);
    }
    expect_failure(JP_NAVIGATION_SILENCE);
}

static void test_an_ecu_that_does_not_begin(void)
{
    make_driving();
    for (unsigned i = 0; i < 52; i++) {
        say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
        say_map(JP_MAP_LINK_READY, JP_MAP_REASON_NONE, FRAMES);
        say_navigator(commander.goal.id, JP_GOAL_TAKEN, JP_NAVIGATOR_IDLE);
        pass(100);
    }
    expect_failure(JP_NAVIGATION_NO_START);
}

static void test_a_bus_that_takes_nothing_is_tried_again(void)
{
    go();
    answer = JP_ERR_BUSY;
    pass(50);
    TEST_ASSERT_EQUAL_UINT(0, sent_count);
    answer = JP_OK;
    pass(1);
    TEST_ASSERT_EQUAL_UINT(1, sent_count);
    TEST_ASSERT_EQUAL_UINT8(1, sent[0].data[1] & 15U);
}

static void test_frames_of_others_and_of_a_wrong_length(void)
{
    struct jp_can_frame frame = {.id = JP_CAN_POSE_FRAME_ID, .length = 8};

    make_asking();
    const struct jp_navigation_operator before = commander;

    jp_navigation_operator_accept(&commander, &frame);
    for (uint32_t id = JP_CAN_MAP_STATUS_FRAME_ID; id <= JP_CAN_NAVIGATION_STATUS_FRAME_ID; id++) {
        frame = (struct jp_can_frame){.id = id, .length = 7};
        jp_navigation_operator_accept(&commander, &frame);
    }
    frame = (struct jp_can_frame){.id = JP_CAN_ECU_STATUS_FRAME_ID, .length = 7};
    jp_navigation_operator_accept(&commander, &frame);
    TEST_ASSERT_EQUAL_MEMORY(&before, &commander, sizeof before);
}

/* Changes. */

static struct jp_can_cell_changes_t change_at(unsigned index)
{
    struct jp_can_cell_changes_t changes = {.cells = 0};

    for (unsigned i = 0; i < sent_count; i++) {
        if (sent[i].id == JP_CAN_CELL_CHANGES_FRAME_ID && index-- == 0U) {
            (void)jp_can_cell_changes_unpack(&changes, sent[i].data, 8);
            return changes;
        }
    }
    TEST_FAIL_MESSAGE("no such change was sent");
    return changes;
}

static void see(uint16_t x, uint16_t y, enum jp_cell cell)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_see(&commander, x, y, cell));
}

static void test_cells_of_a_row_share_a_frame(void)
{
    make_driving();
    see(5, 9, JP_CELL_OCCUPIED);
    see(7, 9, JP_CELL_UNKNOWN);
    see(16, 9, JP_CELL_FREE);
    see(17, 9, JP_CELL_OCCUPIED);
    see(17, 10, JP_CELL_OCCUPIED);
    sent_count = 0;
    pass(10);
    TEST_ASSERT_EQUAL_UINT(3, count_of(JP_CAN_CELL_CHANGES_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT8(4, change_at(0).map_id);
    TEST_ASSERT_EQUAL_UINT16(5, change_at(0).column);
    TEST_ASSERT_EQUAL_UINT16(9, change_at(0).row);
    TEST_ASSERT_EQUAL_HEX32(0x3FFFED, change_at(0).cells);
    TEST_ASSERT_EQUAL_UINT16(17, change_at(1).column);
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFD, change_at(1).cells);
    TEST_ASSERT_EQUAL_UINT16(10, change_at(2).row);
}

static void test_changes_wait_for_the_map(void)
{
    make_sending();
    see(5, 9, JP_CELL_OCCUPIED);
    pass(20);
    TEST_ASSERT_EQUAL_UINT(0, count_of(JP_CAN_CELL_CHANGES_FRAME_ID));
    say_map(JP_MAP_LINK_READY, JP_MAP_REASON_NONE, FRAMES);
    pass(5);
    TEST_ASSERT_EQUAL_UINT(1, count_of(JP_CAN_CELL_CHANGES_FRAME_ID));
}

static void see_rows(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        see(3, (uint16_t)i, JP_CELL_OCCUPIED);
    }
}

static void test_no_more_are_on_their_way_than_the_counter_can_tell(void)
{
    make_driving();
    see_rows(20);
    sent_count = 0;
    pass(50);
    TEST_ASSERT_EQUAL_UINT(8, count_of(JP_CAN_CELL_CHANGES_FRAME_ID));
    say_cells(8);
    sent_count = 0;
    pass(50);
    TEST_ASSERT_EQUAL_UINT(8, count_of(JP_CAN_CELL_CHANGES_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT16(8, change_at(0).row);
    say_cells(0);
    sent_count = 0;
    pass(50);
    TEST_ASSERT_EQUAL_UINT(4, count_of(JP_CAN_CELL_CHANGES_FRAME_ID));
    say_cells(4);
    TEST_ASSERT_EQUAL_UINT8(0, commander.changes.count);
}

static void test_what_is_lost_is_sent_again(void)
{
    make_driving();
    see_rows(6);
    pass(20);
    say_cells(2);
    sent_count = 0;
    pass(200);
    say_cells(2);
    TEST_ASSERT_EQUAL_UINT(0, count_of(JP_CAN_CELL_CHANGES_FRAME_ID));
    pass(100);
    say_cells(2);
    sent_count = 0;
    pass(20);
    TEST_ASSERT_EQUAL_UINT(4, count_of(JP_CAN_CELL_CHANGES_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT8(3, change_at(0).counter);
    TEST_ASSERT_EQUAL_UINT16(2, change_at(0).row);
    say_cells(6);
    TEST_ASSERT_EQUAL_UINT8(0, commander.changes.count);
}

static void test_counts_on_from_where_the_ecu_is(void)
{
    make_sending();
    say_cells(11);
    say_cells(11);
    see(1, 1, JP_CELL_OCCUPIED);
    sent_count = 0;
    pass(5);
    TEST_ASSERT_EQUAL_UINT8(12, change_at(0).counter);
}

static void test_too_many_changes_are_left_to_the_caller(void)
{
    make_driving();
    see_rows(JP_CHANGES_WAITING);
    TEST_ASSERT_EQUAL_INT(JP_ERR_BUSY, jp_navigation_operator_see(&commander, 3, 999, JP_CELL_FREE));
    pass(10);
    say_cells(8);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_see(&commander, 3, 999, JP_CELL_FREE));
}

static void test_changes_of_another_map_are_forgotten(void)
{
    make_driving();
    see_rows(10);
    pass(5);
    go();
    TEST_ASSERT_EQUAL_UINT8(10, commander.changes.count);
    map.id = 5;
    go();
    TEST_ASSERT_EQUAL_UINT8(0, commander.changes.count);
}

static void test_a_bus_that_takes_no_changes(void)
{
    make_driving();
    see(1, 1, JP_CELL_OCCUPIED);
    answer = JP_ERR_BUSY;
    pass(5);
    answer = JP_OK;
    sent_count = 0;
    pass(5);
    TEST_ASSERT_EQUAL_UINT8(1, change_at(0).counter);
}
