/* An operator that sends a map and a round (navigation_operator.h): what it sends and commands, and an ECU, played by
 * hand, that takes the round, refuses it, gives it up or stops. */
#include <joulepath/robot.h>
#include <string.h>

#include "hal/app/navigation_operator.h"
#include "hal/storage/crc32.h"
#include "unity.h"

enum { LENGTH = 40, STOPS = 1, MAP = 4 };

static struct jp_navigation_operator commander;
static struct jp_round_link link; /* the ECU's */
static uint8_t told;              /* state, once it is whole */
static uint8_t reason;
static uint8_t mode; /* last commanded */
static uint8_t route;
static unsigned goals;
static uint32_t now_ms;
static uint8_t stream[LENGTH];
static uint8_t bytes[JP_ROUND_BYTES_MAX];
static const struct jp_map_stream map = {.bytes = stream, .length = LENGTH, .id = MAP};
static const struct jp_round_bytes round_bytes = {.bytes = bytes, .stops = STOPS};

static enum jp_status take(void *context, const struct jp_can_frame *frame)
{
    struct jp_can_operator_command_t command;

    (void)context;
    switch (frame->id) {
    case JP_CAN_OPERATOR_COMMAND_FRAME_ID:
        (void)jp_can_operator_command_unpack(&command, frame->data, frame->length);
        mode = command.mode;
        route = command.route_id;
        break;
    case JP_CAN_ROUND_OFFER_FRAME_ID:
        (void)jp_round_link_accept_offer(&link, frame, MAP, true);
        break;
    case JP_CAN_ROUND_DATA_FRAME_ID:
        (void)jp_round_link_accept_data(&link, frame);
        break;
    case JP_CAN_MAP_GOAL_FRAME_ID:
        goals++;
        break;
    default:
        break;
    }
    return JP_OK;
}

static const struct jp_can_port port = {.send = take};

static void say(uint32_t id, const uint8_t *data)
{
    struct jp_can_frame frame = {.id = id, .length = JP_CAN_LENGTH_MAX};

    memcpy(frame.data, data, JP_CAN_LENGTH_MAX);
    jp_navigation_operator_accept(&commander, &frame);
}

static void say_ecu(void)
{
    const struct jp_can_ecu_status_t ecu = {.state = JP_CAN_ECU_STATUS_STATE_STANDING_CHOICE,
                                            .operator_state = JP_OPERATOR_ALIVE};
    const struct jp_can_map_status_t maps = {
        .map_id = MAP, .state = (uint8_t)JP_MAP_LINK_READY, .map_crc = jp_crc32(0, stream, LENGTH)};
    uint8_t data[JP_CAN_LENGTH_MAX];

    (void)jp_can_ecu_status_pack(data, &ecu, sizeof data);
    say(JP_CAN_ECU_STATUS_FRAME_ID, data);
    (void)jp_can_map_status_pack(data, &maps, sizeof data);
    say(JP_CAN_MAP_STATUS_FRAME_ID, data);
}

static void say_round(uint8_t id, uint8_t state)
{
    const struct jp_can_round_status_t status = {
        .round_id = id, .state = state, .reason = reason, .received = link.frames};
    uint8_t data[JP_CAN_LENGTH_MAX];

    (void)jp_can_round_status_pack(data, &status, sizeof data);
    say(JP_CAN_ROUND_STATUS_FRAME_ID, data);
}

static void say_state(void)
{
    static const uint8_t states[] = {[JP_ROUND_LINK_NONE] = JP_CAN_ROUND_STATUS_STATE_NONE_CHOICE,
                                     [JP_ROUND_LINK_RECEIVING] = JP_CAN_ROUND_STATUS_STATE_RECEIVING_CHOICE,
                                     [JP_ROUND_LINK_REJECTED] = JP_CAN_ROUND_STATUS_STATE_REJECTED_CHOICE};

    say_round(link.id, link.state == JP_ROUND_LINK_WHOLE ? told : states[link.state]);
}

void setUp(void)
{
    for (unsigned i = 0; i < sizeof bytes; i++) {
        bytes[i] = (uint8_t)(3U * i);
    }
    memset(&commander, 0, sizeof commander);
    memset(&link, 0, sizeof link);
    told = JP_CAN_ROUND_STATUS_STATE_READY_CHOICE;
    reason = JP_CAN_ROUND_STATUS_REASON_NONE_CHOICE;
    mode = UINT8_MAX;
    goals = 0;
    now_ms = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_patrol(&commander, &map, &round_bytes));
}

void tearDown(void)
{
}

static void pass(unsigned ms)
{
    for (unsigned i = 0; i < ms; i++) {
        now_ms++;
        jp_navigation_operator_tick(&commander, now_ms, &port);
        if (now_ms % 100U == 0U) {
            say_ecu();
            say_state();
        }
    }
}

static void pass_until(enum jp_navigation_phase phase)
{
    for (unsigned i = 0; i < 8000U && commander.phase != phase; i++) {
        pass(1);
    }
    TEST_ASSERT_EQUAL_INT(phase, commander.phase);
}

static void pass_until_driving(void)
{
    pass_until(JP_NAVIGATION_DRIVING);
    told = JP_CAN_ROUND_STATUS_STATE_SURVEYING_CHOICE;
    pass(300);
    TEST_ASSERT_EQUAL_UINT8(JP_MODE_NAVIGATE, mode);
    TEST_ASSERT_EQUAL_UINT8(link.id, route);
}

static void expect_failure(enum jp_navigation_failure failure)
{
    pass_until(JP_NAVIGATION_FAILED);
    TEST_ASSERT_EQUAL_INT(failure, commander.failure);
    pass(200);
    TEST_ASSERT_EQUAL_UINT8(JP_MODE_STAND, mode);
}

static void test_it_sends_the_round_and_lets_it_be_driven(void)
{
    pass(50);
    TEST_ASSERT_EQUAL_UINT8(JP_MODE_STAND, mode);
    pass_until_driving();
    TEST_ASSERT_EQUAL_MEMORY(bytes, link.bytes, JP_ROUND_BYTES(STOPS));
    TEST_ASSERT_EQUAL_UINT(0, goals);
    told = JP_CAN_ROUND_STATUS_STATE_DWELLING_CHOICE;
    pass(10000);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATION_DRIVING, commander.phase);
    jp_navigation_operator_stop(&commander);
    pass(200);
    TEST_ASSERT_EQUAL_UINT8(JP_MODE_STAND, mode);
}

static void test_what_the_navigator_says_of_single_goals_is_of_no_account(void)
{
    const struct jp_can_navigation_status_t arrived = {.goal_id = 1, .answer = 6, .state = 7};
    uint8_t data[JP_CAN_LENGTH_MAX];

    pass_until_driving();
    (void)jp_can_navigation_status_pack(data, &arrived, sizeof data);
    say(JP_CAN_NAVIGATION_STATUS_FRAME_ID, data);
    say(JP_CAN_NAVIGATION_STATUS_FRAME_ID, data);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATION_DRIVING, commander.phase);
}

static void test_the_next_round_has_another_id(void)
{
    const uint8_t battery[JP_CAN_LENGTH_MAX] = {16};

    pass_until_driving();
    const uint8_t before = link.id;

    told = JP_CAN_ROUND_STATUS_STATE_STOPPED_CHOICE;
    expect_failure(JP_NAVIGATION_STOPPED);
    told = JP_CAN_ROUND_STATUS_STATE_READY_CHOICE;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_patrol(&commander, &map, &round_bytes));
    pass_until_driving();
    TEST_ASSERT_NOT_EQUAL_UINT8(before, link.id);
    say(JP_CAN_ROUND_BATTERY_FRAME_ID, battery);
    TEST_ASSERT_EQUAL_UINT32(16, commander.round_battery.held);
}

static void test_a_round_that_is_refused(void)
{
    pass_until(JP_NAVIGATION_ASKING);
    told = JP_CAN_ROUND_STATUS_STATE_REJECTED_CHOICE;
    reason = JP_CAN_ROUND_STATUS_REASON_BLOCKED_CHOICE;
    expect_failure(JP_NAVIGATION_ROUND);
    TEST_ASSERT_EQUAL_UINT8(JP_CAN_ROUND_STATUS_REASON_BLOCKED_CHOICE, commander.round.reason);
    TEST_ASSERT_EQUAL_STRING("the ECU refuses the round: see Reason, Field and Stop in RoundStatus",
                             jp_navigation_failure_text(commander.failure));
}

static void test_a_round_that_does_not_begin(void)
{
    pass_until(JP_NAVIGATION_DRIVING);
    expect_failure(JP_NAVIGATION_NO_START);
}

static void test_a_round_that_is_given_up(void)
{
    pass_until_driving();
    told = JP_CAN_ROUND_STATUS_STATE_FAILED_CHOICE;
    reason = JP_CAN_ROUND_STATUS_REASON_NO_ENERGY_CHOICE;
    expect_failure(JP_NAVIGATION_ROUND_ENDED);
    TEST_ASSERT_EQUAL_STRING("the robot has given the round up: see Reason and Stop in RoundStatus",
                             jp_navigation_failure_text(commander.failure));
}

static void test_an_ecu_that_has_lost_the_round(void)
{
    pass_until_driving();
    link.id = 0;
    expect_failure(JP_NAVIGATION_RESTART);
}

static void test_who_sends_a_goal_does_not_mind_rounds(void)
{
    const struct jp_map_goal goal = {.x = 3, .y = 2};

    memset(&commander, 0, sizeof commander);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &goal));
    pass_until(JP_NAVIGATION_ASKING);
    say_round(9, JP_CAN_ROUND_STATUS_STATE_FAILED_CHOICE);
    say_round(9, JP_CAN_ROUND_STATUS_STATE_FAILED_CHOICE);
    pass(200);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATION_ASKING, commander.phase);
    TEST_ASSERT_EQUAL_UINT(2, goals);
}

static void test_wrong_arguments(void)
{
    struct jp_map_stream wrong = map;
    struct jp_round_bytes none = round_bytes;

    memset(&commander, 0, sizeof commander);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_patrol(NULL, &map, &round_bytes));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_patrol(&commander, NULL, &round_bytes));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_patrol(&commander, &map, NULL));
    wrong.id = 16;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_patrol(&commander, &wrong, &round_bytes));
    none.bytes = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_patrol(&commander, &map, &none));
    none = round_bytes;
    none.stops = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_patrol(&commander, &map, &none));
    none.stops = JP_ROUND_STOPS_MAX + 1U;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigation_operator_patrol(&commander, &map, &none));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATION_IDLE, commander.phase);
}
