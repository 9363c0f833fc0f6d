/* What goes wrong around an operator on the bus: a silent, fallen, restarted or unwilling ECU, a bus that takes no
 * frames, another commander. The ECU is played by hand; prop_operator.c has the real one. */
#include <string.h>

#include <joulepath/robot.h>

#include "hal/app/operator.h"
#include "unity.h"

#define SENT_MAX 256

static struct jp_operator commander;
static struct jp_can_frame sent[SENT_MAX];
static unsigned sent_count;
static enum jp_status answer; /* of the port */
static uint32_t now_ms;
static const struct jp_point points[3] = {{JP_Q16(1), 0}, {JP_Q16(2), JP_Q16(-1)}, {JP_Q16(3), JP_Q16(1)}};

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
    sent_count = 0;
    answer = JP_OK;
    now_ms = UINT32_MAX - 3000U; /* it wraps on the way */
}

void tearDown(void)
{
}

/** A frame of an id as the ECU would send it, but for its length. */
static void say_short(uint32_t id, uint8_t length)
{
    const struct jp_can_frame frame = {.id = id, .length = length};

    jp_operator_accept(&commander, &frame);
}

static void say_ecu(enum jp_robot_state state, enum jp_operator_state heard)
{
    const struct jp_can_ecu_status_t signals = {.state = (uint8_t)state, .operator_state = (uint8_t)heard};
    struct jp_can_frame frame = {.id = JP_CAN_ECU_STATUS_FRAME_ID, .length = JP_CAN_ECU_STATUS_LENGTH};

    (void)jp_can_ecu_status_pack(frame.data, &signals, sizeof frame.data);
    jp_operator_accept(&commander, &frame);
}

static void say_route(uint8_t id, enum jp_route_state state, enum jp_route_reason reason)
{
    const struct jp_can_route_status_t signals = {.route_id = id, .state = (uint8_t)state, .reason = (uint8_t)reason};
    struct jp_can_frame frame = {.id = JP_CAN_ROUTE_STATUS_FRAME_ID, .length = JP_CAN_ROUTE_STATUS_LENGTH};

    (void)jp_can_route_status_pack(frame.data, &signals, sizeof frame.data);
    jp_operator_accept(&commander, &frame);
}

static void pass(uint32_t ms)
{
    for (uint32_t i = 0; i < ms; i++) {
        const unsigned before = sent_count;

        jp_operator_tick(&commander, now_ms++, &port);
        TEST_ASSERT_LESS_OR_EQUAL_UINT(before + 1, sent_count);
    }
}

/** Both statuses every 100 ms, as the ECU sends them. */
static void pass_telling(uint32_t ms, enum jp_robot_state robot, uint8_t id, enum jp_route_state route,
                         enum jp_route_reason reason)
{
    for (uint32_t i = 0; i < ms; i += 100) {
        pass(50);
        say_ecu(robot, JP_OPERATOR_ALIVE);
        say_route(id, route, reason);
        pass(50);
    }
}

static unsigned count_sent(uint32_t id)
{
    unsigned found = 0;

    for (unsigned i = 0; i < sent_count; i++) {
        found += sent[i].id == id;
    }
    return found;
}

static struct jp_can_operator_command_t last_command(void)
{
    struct jp_can_operator_command_t command = {0};

    for (unsigned i = 0; i < sent_count; i++) {
        if (sent[i].id == JP_CAN_OPERATOR_COMMAND_FRAME_ID) {
            (void)jp_can_operator_command_unpack(&command, sent[i].data, sent[i].length);
        }
    }
    return command;
}

/** Each id's frames count on without a gap. */
static void check_counters(uint32_t id)
{
    int last = -1;

    for (unsigned i = 0; i < sent_count; i++) {
        const int counter = sent[i].data[1] & 0x0F;

        if (sent[i].id == id) {
            TEST_ASSERT_TRUE(last < 0 || counter == (last + 1) % 16);
            last = counter;
        }
    }
}

static void start_uploading(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, points, 3));
    pass_telling(300, JP_ROBOT_BALANCING, 0, JP_ROUTE_NONE, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
}

static void start_driving(void)
{
    start_uploading();
    pass_telling(200, JP_ROBOT_BALANCING, commander.task.id, JP_ROUTE_READY, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DRIVING, commander.phase);
    pass_telling(500, JP_ROBOT_DRIVING, commander.task.id, JP_ROUTE_DRIVING, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT(JP_MODE_DRIVE, last_command().mode);
    TEST_ASSERT_EQUAL_UINT(commander.task.id, last_command().route_id);
}

static void check_failed(enum jp_operator_failure failure)
{
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_FAILED, commander.phase);
    TEST_ASSERT_EQUAL_INT(failure, commander.failure);
    pass(150);
    TEST_ASSERT_EQUAL_UINT(JP_MODE_STAND, last_command().mode);
}

static void test_without_a_task_nothing_is_sent(void)
{
    pass_telling(2000, JP_ROBOT_BALANCING, 3, JP_ROUTE_DONE, JP_REASON_NONE);
    jp_operator_stop(&commander);
    pass_telling(2000, JP_ROBOT_DRIVING, 4, JP_ROUTE_DRIVING, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT(0, sent_count);
    TEST_ASSERT_EQUAL_INT(JP_FAILURE_NONE, commander.failure);
}

static void test_routes_that_cannot_be_sent_are_refused(void)
{
    static struct jp_point many[JP_ROUTE_LENGTH_MAX + 1U];
    const struct jp_point far[] = {{1 << 25, 0}, {-(1 << 25) - 1, 0}, {0, 1 << 25}, {0, INT32_MIN}};

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_operator_route(&commander, points, 0));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_operator_route(&commander, many, JP_ROUTE_LENGTH_MAX + 1U));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_operator_route(&commander, NULL, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_operator_route(NULL, points, 1));
    for (size_t i = 0; i < sizeof far / sizeof far[0]; i++) {
        TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_operator_goal(&commander, &far[i]));
    }
    pass(1000);
    TEST_ASSERT_EQUAL_UINT(0, sent_count);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, many, JP_ROUTE_LENGTH_MAX));
}

static void test_a_whole_drive(void)
{
    start_driving();
    TEST_ASSERT_EQUAL_UINT(1, count_sent(JP_CAN_ROUTE_OFFER_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT(3, count_sent(JP_CAN_WAYPOINT_FRAME_ID));
    pass_telling(300, JP_ROBOT_BALANCING, commander.task.id, JP_ROUTE_DONE, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DONE, commander.phase);
    pass(5000);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DONE, commander.phase);
    TEST_ASSERT_EQUAL_UINT(JP_MODE_STAND, last_command().mode);
    TEST_ASSERT_UINT_WITHIN(3, 66, count_sent(JP_CAN_OPERATOR_COMMAND_FRAME_ID));
    check_counters(JP_CAN_OPERATOR_COMMAND_FRAME_ID);
    check_counters(JP_CAN_WAYPOINT_FRAME_ID);
}

static void test_a_bus_without_an_ecu(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, points, 3));
    pass(9900);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, commander.phase);
    pass(200);
    check_failed(JP_FAILURE_SILENCE);
}

static void test_a_robot_that_does_not_stand_up(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, points, 3));
    pass_telling(10200, JP_ROBOT_IDLE, 0, JP_ROUTE_NONE, JP_REASON_NONE);
    check_failed(JP_FAILURE_STAND_UP);
    TEST_ASSERT_EQUAL_UINT(0, count_sent(JP_CAN_ROUTE_OFFER_FRAME_ID));
}

static void test_a_fall_and_a_fault_at_each_stage(void)
{
    static void (*const starts[])(void) = {start_uploading, start_driving};
    static const struct {
        enum jp_robot_state state;
        enum jp_operator_failure failure;
    } ends[] = {{JP_ROBOT_FALLEN, JP_FAILURE_FALLEN}, {JP_ROBOT_FAULT, JP_FAILURE_FAULT}};

    for (size_t i = 0; i < 4; i++) {
        setUp();
        starts[i / 2]();
        pass_telling(200, ends[i % 2].state, commander.progress.route_id, (enum jp_route_state)commander.progress.state,
                     JP_REASON_NONE);
        check_failed(ends[i % 2].failure);
    }
}

static void test_one_corrupt_status_is_not_believed(void)
{
    start_driving();
    say_ecu(JP_ROBOT_FALLEN, JP_OPERATOR_ALIVE);
    say_route(commander.task.id, JP_ROUTE_DONE, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DRIVING, commander.phase);
    pass_telling(1000, JP_ROBOT_DRIVING, commander.task.id, JP_ROUTE_DRIVING, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DRIVING, commander.phase);
}

static void test_an_ecu_that_falls_silent(void)
{
    start_uploading();
    pass(1000);
    check_failed(JP_FAILURE_SILENCE);
    setUp();
    start_driving();
    pass(1000);
    check_failed(JP_FAILURE_SILENCE);
}

static void test_why_a_route_stopped(void)
{
    static const struct {
        enum jp_route_reason reason;
        enum jp_operator_failure failure;
    } stops[] = {{JP_REASON_PLAN, JP_FAILURE_PLAN},       {JP_REASON_COMMAND, JP_FAILURE_COMMAND},
                 {JP_REASON_TIMEOUT, JP_FAILURE_TIMEOUT}, {JP_REASON_LENGTH, JP_FAILURE_LENGTH},
                 {JP_REASON_NONE, JP_FAILURE_STOPPED},    {JP_REASON_SWITCHED_OFF, JP_FAILURE_SWITCHED_OFF}};

    for (size_t i = 0; i < sizeof stops / sizeof stops[0]; i++) {
        setUp();
        start_driving();
        pass_telling(200, JP_ROBOT_BALANCING, commander.task.id, JP_ROUTE_STOPPED, stops[i].reason);
        check_failed(stops[i].failure);
    }
}

static void test_an_ecu_that_restarts_and_another_operator(void)
{
    start_driving();
    pass_telling(200, JP_ROBOT_BALANCING, 0, JP_ROUTE_NONE, JP_REASON_NONE);
    check_failed(JP_FAILURE_RESTART);
    setUp();
    start_driving();
    pass_telling(200, JP_ROBOT_DRIVING, (uint8_t)(commander.task.id + 100U), JP_ROUTE_DRIVING, JP_REASON_NONE);
    check_failed(JP_FAILURE_REPLACED);
}

static void test_a_rejected_route_is_offered_again_under_another_id(void)
{
    uint8_t first;

    start_uploading();
    first = commander.task.id;
    pass_telling(200, JP_ROBOT_BALANCING, first, JP_ROUTE_REJECTED, JP_REASON_SEQUENCE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
    TEST_ASSERT_NOT_EQUAL(first, commander.task.id);
    pass_telling(200, JP_ROBOT_BALANCING, commander.task.id, JP_ROUTE_READY, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DRIVING, commander.phase);
    TEST_ASSERT_EQUAL_UINT(2, count_sent(JP_CAN_ROUTE_OFFER_FRAME_ID));
    check_counters(JP_CAN_ROUTE_OFFER_FRAME_ID);
}

static void test_an_upload_that_never_succeeds(void)
{
    start_uploading();
    pass_telling(4000, JP_ROBOT_BALANCING, 0, JP_ROUTE_NONE, JP_REASON_NONE);
    check_failed(JP_FAILURE_UPLOAD);
    TEST_ASSERT_EQUAL_UINT(5, count_sent(JP_CAN_ROUTE_OFFER_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT(15, count_sent(JP_CAN_WAYPOINT_FRAME_ID));
}

static void test_a_length_that_the_ecu_does_not_take(void)
{
    start_uploading();
    pass_telling(200, JP_ROBOT_BALANCING, commander.task.id, JP_ROUTE_REJECTED, JP_REASON_LENGTH);
    check_failed(JP_FAILURE_LENGTH);
}

static void test_an_ecu_that_does_not_begin(void)
{
    start_uploading();
    pass_telling(5300, JP_ROBOT_BALANCING, commander.task.id, JP_ROUTE_READY, JP_REASON_NONE);
    check_failed(JP_FAILURE_NO_START);
}

static void test_an_ecu_that_lost_its_operator_hears_stand_before_drive(void)
{
    start_uploading();
    pass(50);
    for (int i = 0; i < 4; i++) {
        say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_LOST);
        say_route(commander.task.id, JP_ROUTE_READY, JP_REASON_NONE);
        pass(100);
    }
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DRIVING, commander.phase);
    TEST_ASSERT_EQUAL_UINT(JP_MODE_STAND, last_command().mode);
    pass_telling(200, JP_ROBOT_BALANCING, commander.task.id, JP_ROUTE_READY, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT(JP_MODE_DRIVE, last_command().mode);
}

static void test_a_port_that_is_busy_leaves_no_gap(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, points, 3));
    pass(250);
    for (int i = 0; i < 6; i++) {
        answer = i % 2 == 0 ? JP_ERR_BUSY : JP_OK;
        say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
        say_route(0, JP_ROUTE_NONE, JP_REASON_NONE);
        pass(7);
    }
    answer = JP_ERR_HARDWARE;
    pass(120);
    answer = JP_OK;
    pass(300);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
    TEST_ASSERT_EQUAL_UINT(1, count_sent(JP_CAN_ROUTE_OFFER_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT(3, count_sent(JP_CAN_WAYPOINT_FRAME_ID));
    check_counters(JP_CAN_OPERATOR_COMMAND_FRAME_ID);
    check_counters(JP_CAN_WAYPOINT_FRAME_ID);
}

static void test_a_new_route_while_driving_needs_no_stand(void)
{
    uint8_t old;

    start_driving();
    old = commander.task.id;
    sent_count = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_goal(&commander, &points[2]));
    pass_telling(300, JP_ROBOT_DRIVING, old, JP_ROUTE_DRIVING, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
    TEST_ASSERT_EQUAL_UINT(old, last_command().route_id);
    TEST_ASSERT_NOT_EQUAL(old, commander.task.id);
    pass_telling(300, JP_ROBOT_DRIVING, commander.task.id, JP_ROUTE_READY, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT(commander.task.id, last_command().route_id);
    for (unsigned i = 0; i < sent_count; i++) {
        TEST_ASSERT_TRUE(sent[i].id != JP_CAN_OPERATOR_COMMAND_FRAME_ID || (sent[i].data[1] >> 4 & 3) == JP_MODE_DRIVE);
    }
}

static void test_stop_is_said_at_once(void)
{
    start_driving();
    pass(30);
    sent_count = 0;
    jp_operator_stop(&commander);
    pass(1);
    TEST_ASSERT_EQUAL_UINT(1, sent_count);
    TEST_ASSERT_EQUAL_UINT(JP_MODE_STAND, last_command().mode);
    pass_telling(2000, JP_ROBOT_BALANCING, commander.task.id, JP_ROUTE_STOPPED, JP_REASON_COMMAND);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_IDLE, commander.phase);
    TEST_ASSERT_EQUAL_INT(JP_FAILURE_NONE, commander.failure);
}

static void test_an_id_of_the_ecus_last_route_is_not_taken_again(void)
{
    for (unsigned id = 0; id <= 255; id++) {
        setUp();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, points, 1));
        pass_telling(300, JP_ROBOT_BALANCING, (uint8_t)id, JP_ROUTE_DONE, JP_REASON_NONE);
        TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
        TEST_ASSERT_NOT_EQUAL(id, commander.task.id);
        TEST_ASSERT_NOT_EQUAL(0, commander.task.id);
    }
}

static void test_frames_of_a_wrong_length_or_kind_are_not_heard(void)
{
    struct jp_can_frame frame = {.id = JP_CAN_ECU_STATUS_FRAME_ID, .data = {JP_ROBOT_FALLEN}};

    start_driving();
    for (frame.length = 0; frame.length < 8; frame.length++) {
        jp_operator_accept(&commander, &frame);
        jp_operator_accept(&commander, &frame);
    }
    frame.length = 8;
    frame.id |= JP_CAN_REMOTE;
    jp_operator_accept(&commander, &frame);
    jp_operator_accept(&commander, &frame);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DRIVING, commander.phase);
}

static void test_a_route_status_of_a_wrong_length_is_not_heard(void)
{
    start_driving();
    for (uint8_t length = 0; length < 8; length++) {
        if (length != JP_CAN_ROUTE_STATUS_LENGTH) {
            say_short(JP_CAN_ROUTE_STATUS_FRAME_ID, length);
            say_short(JP_CAN_ROUTE_STATUS_FRAME_ID, length);
        }
    }
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DRIVING, commander.phase);
    TEST_ASSERT_EQUAL_UINT(commander.task.id, commander.progress.route_id);
}

static void test_the_route_arrives_as_it_was_asked_for(void)
{
    unsigned next = 0;
    uint32_t crc = JP_ROUTE_CRC_START;

    start_driving();
    for (unsigned i = 0; i < sent_count; i++) {
        struct jp_can_waypoint_t waypoint;

        if (sent[i].id == JP_CAN_WAYPOINT_FRAME_ID) {
            TEST_ASSERT_EQUAL_INT(0, jp_can_waypoint_unpack(&waypoint, sent[i].data, sent[i].length));
            TEST_ASSERT_EQUAL_INT32(points[next].x, waypoint.x);
            TEST_ASSERT_EQUAL_INT32(points[next].y, waypoint.y);
            crc = jp_route_crc(crc, &points[next]);
            next++;
        }
    }
    TEST_ASSERT_EQUAL_UINT(3, next);
    for (unsigned i = 0; i < sent_count; i++) {
        struct jp_can_route_offer_t offer;

        if (sent[i].id == JP_CAN_ROUTE_OFFER_FRAME_ID) {
            TEST_ASSERT_EQUAL_INT(0, jp_can_route_offer_unpack(&offer, sent[i].data, sent[i].length));
            TEST_ASSERT_EQUAL_UINT(commander.task.id, offer.route_id);
            TEST_ASSERT_EQUAL_UINT(3, offer.length);
            TEST_ASSERT_EQUAL_HEX32(crc, offer.route_crc);
        }
    }
}

/** Ms until the next frame of an id. */
static unsigned ms_until(uint32_t id)
{
    const unsigned before = count_sent(id);
    unsigned ms = 0;

    while (count_sent(id) == before && ms < 20000) {
        pass(1);
        ms++;
    }
    return ms;
}

static void test_commands_and_frames_of_a_route_keep_their_periods(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, points, 3));
    TEST_ASSERT_EQUAL_UINT(1, ms_until(JP_CAN_OPERATOR_COMMAND_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT(100, ms_until(JP_CAN_OPERATOR_COMMAND_FRAME_ID));
    for (int i = 0; i < 2; i++) {
        say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
        say_route(0, JP_ROUTE_NONE, JP_REASON_NONE);
    }
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
    TEST_ASSERT_EQUAL_UINT(1, ms_until(JP_CAN_ROUTE_OFFER_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT(5, ms_until(JP_CAN_WAYPOINT_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT(5, ms_until(JP_CAN_WAYPOINT_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT(5, ms_until(JP_CAN_WAYPOINT_FRAME_ID));
    TEST_ASSERT_EQUAL_UINT(84, ms_until(JP_CAN_OPERATOR_COMMAND_FRAME_ID));
}

/** In ms since the phase began, at which it fails. */
static unsigned ms_until_failed(void (*telling)(void))
{
    unsigned ms = 0;

    while (commander.phase != JP_OPERATOR_FAILED && ms < 20000) {
        telling();
        pass(1);
        ms++;
    }
    return ms;
}

static void tell_nothing(void)
{
}

static void tell_ready(void)
{
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    say_route(commander.task.id, JP_ROUTE_READY, JP_REASON_NONE);
}

static void tell_idle(void)
{
    say_ecu(JP_ROBOT_IDLE, JP_OPERATOR_ALIVE);
    say_route(0, JP_ROUTE_NONE, JP_REASON_NONE);
}

static void test_patience_to_the_millisecond(void)
{
    pass(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, points, 3));
    TEST_ASSERT_EQUAL_UINT(10000, ms_until_failed(tell_idle));
    TEST_ASSERT_EQUAL_INT(JP_FAILURE_STAND_UP, commander.failure);
    setUp();
    start_uploading();
    TEST_ASSERT_EQUAL_UINT(950, ms_until_failed(tell_nothing)); /* 50 ms ago both were heard */
    TEST_ASSERT_EQUAL_INT(JP_FAILURE_SILENCE, commander.failure);
    setUp();
    start_uploading();
    tell_ready();
    tell_ready();
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DRIVING, commander.phase);
    TEST_ASSERT_EQUAL_UINT(5000, ms_until_failed(tell_ready));
    TEST_ASSERT_EQUAL_INT(JP_FAILURE_NO_START, commander.failure);
}

/** An upload of which nothing is heard is tried again half a second after its last frame. */
static void test_an_upload_is_tried_again_after_half_a_second(void)
{
    const int frames = 4;
    unsigned ms = 0;

    pass(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, points, 3));
    tell_idle();
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
    while (commander.sent < frames) {
        pass(1);
    }
    while (commander.attempts == 1 && ms < 2000) {
        tell_idle();
        pass(1);
        ms++;
    }
    TEST_ASSERT_EQUAL_UINT(500, ms);
    TEST_ASSERT_EQUAL_UINT(2, commander.attempts);
}

static void test_both_statuses_must_be_heard_before_a_route_is_sent(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, points, 3));
    for (int i = 0; i < 4; i++) {
        pass(10);
        say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    }
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, commander.phase);
    say_route(0, JP_ROUTE_NONE, JP_REASON_NONE);
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
    pass(950);
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    pass(100);
    check_failed(JP_FAILURE_SILENCE);
}

static void test_an_ecu_that_does_not_obey_yet_is_waited_for(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, points, 3));
    for (int i = 0; i < 4; i++) {
        pass(10);
        say_route(0, JP_ROUTE_NONE, JP_REASON_NONE);
        say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_LOST);
    }
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, commander.phase);
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, commander.phase);
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
}

/** Until it has begun there is no old route to go on with. */
static void test_a_new_route_before_the_first_has_begun_needs_a_stand(void)
{
    start_uploading();
    tell_ready();
    tell_ready();
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DRIVING, commander.phase);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_goal(&commander, &points[2]));
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, commander.phase);
    pass(1);
    TEST_ASSERT_EQUAL_UINT(JP_MODE_STAND, last_command().mode);
}

static void test_a_third_route_while_the_second_is_uploaded_goes_on_with_the_first(void)
{
    uint8_t old;

    start_driving();
    old = commander.task.id;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_goal(&commander, &points[2]));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_goal(&commander, &points[1]));
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
    pass_telling(200, JP_ROBOT_DRIVING, old, JP_ROUTE_DRIVING, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT(old, last_command().route_id);
    /* Not so of one that was being uploaded while the robot stood. */
    setUp();
    start_uploading();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_goal(&commander, &points[1]));
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, commander.phase);
}

static void test_a_status_that_changes_in_one_word_counts_only_when_it_is_repeated(void)
{
    start_uploading();
    say_route(commander.task.id, JP_ROUTE_REJECTED, JP_REASON_LENGTH);
    say_route(commander.task.id, JP_ROUTE_REJECTED, JP_REASON_SEQUENCE);
    say_route((uint8_t)(commander.task.id + 1U), JP_ROUTE_REJECTED, JP_REASON_SEQUENCE);
    say_route(commander.task.id, JP_ROUTE_REJECTED, JP_REASON_SEQUENCE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
    TEST_ASSERT_EQUAL_UINT(1, commander.attempts);
    say_route(commander.task.id, JP_ROUTE_REJECTED, JP_REASON_SEQUENCE);
    TEST_ASSERT_EQUAL_UINT(2, commander.attempts);
}

/** A length may be the reason why the route that is driven has ended, not this upload. */
static void test_a_route_that_is_not_rejected_is_waited_for(void)
{
    start_uploading();
    for (int i = 0; i < 3; i++) {
        say_route(commander.task.id, JP_ROUTE_STOPPED, JP_REASON_LENGTH);
    }
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
    TEST_ASSERT_EQUAL_UINT(1, commander.attempts);
}

static void test_reasons_of_an_upload_or_of_nobody_are_no_reason_to_have_stopped(void)
{
    const uint8_t reasons[] = {JP_REASON_SEQUENCE, JP_REASON_ROUTE_CRC, 15};

    for (size_t i = 0; i < sizeof reasons; i++) {
        setUp();
        start_driving();
        pass_telling(200, JP_ROBOT_BALANCING, commander.task.id, JP_ROUTE_STOPPED, (enum jp_route_reason)reasons[i]);
        check_failed(JP_FAILURE_STOPPED);
    }
}

static void test_ids_begin_again_after_the_last(void)
{
    commander.task.id = UINT8_MAX;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, points, 3));
    pass_telling(300, JP_ROBOT_BALANCING, 7, JP_ROUTE_DONE, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
    TEST_ASSERT_EQUAL_UINT(1, commander.task.id);
    setUp();
    commander.task.id = UINT8_MAX - 1U;
    start_uploading();
    TEST_ASSERT_EQUAL_UINT(UINT8_MAX, commander.task.id);
}

static void test_a_failure_is_forgotten_with_the_next_route(void)
{
    start_driving();
    pass(30);
    say_ecu(JP_ROBOT_FALLEN, JP_OPERATOR_ALIVE);
    say_ecu(JP_ROBOT_FALLEN, JP_OPERATOR_ALIVE);
    TEST_ASSERT_EQUAL_INT(JP_FAILURE_FALLEN, commander.failure);
    sent_count = 0;
    pass(1);
    TEST_ASSERT_EQUAL_UINT(1, sent_count); /* Stand, at once */
    TEST_ASSERT_EQUAL_UINT(JP_MODE_STAND, last_command().mode);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_goal(&commander, &points[0]));
    TEST_ASSERT_EQUAL_INT(JP_FAILURE_NONE, commander.failure);
}

static void test_a_rejected_route_is_offered_again_at_once(void)
{
    start_uploading();
    while (count_sent(JP_CAN_WAYPOINT_FRAME_ID) < 3) {
        pass(1);
    }
    say_route(commander.task.id, JP_ROUTE_REJECTED, JP_REASON_ROUTE_CRC);
    say_route(commander.task.id, JP_ROUTE_REJECTED, JP_REASON_ROUTE_CRC);
    commander.since_command_ms = 0; /* no command comes between */
    TEST_ASSERT_EQUAL_UINT(1, ms_until(JP_CAN_ROUTE_OFFER_FRAME_ID));
}

static void fail_to_upload(void)
{
    uint8_t last;

    pass_telling(4000, JP_ROBOT_BALANCING, 0, JP_ROUTE_NONE, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_FAILURE_UPLOAD, commander.failure);
    TEST_ASSERT_EQUAL_UINT(5, commander.attempts);
    last = commander.task.id;
    pass(100);
    TEST_ASSERT_EQUAL_UINT(last, commander.task.id);
}

static void test_each_route_has_its_attempts(void)
{
    start_uploading();
    fail_to_upload();
    start_uploading();
    TEST_ASSERT_EQUAL_UINT(1, commander.attempts);
    fail_to_upload();
}

static void test_every_point_of_a_route_is_looked_at_and_taken(void)
{
    const struct jp_point far[] = {points[0], points[1], {1 << 25, 0}};

    commander.task.points[2] = (struct jp_point){77, 78};
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_operator_route(&commander, far, 3));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, points, 2));
    TEST_ASSERT_EQUAL_INT32(points[1].x, commander.task.points[1].x);
    TEST_ASSERT_EQUAL_INT32(77, commander.task.points[2].x);
    TEST_ASSERT_EQUAL_INT32(78, commander.task.points[2].y);
}

/** The route that was driven is not gone on with when its successor has failed. */
static void test_after_a_failed_upload_the_next_route_needs_a_stand(void)
{
    start_driving();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_goal(&commander, &points[2]));
    say_route(commander.task.id, JP_ROUTE_REJECTED, JP_REASON_LENGTH);
    say_route(commander.task.id, JP_ROUTE_REJECTED, JP_REASON_LENGTH);
    TEST_ASSERT_EQUAL_INT(JP_FAILURE_LENGTH, commander.failure);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_goal(&commander, &points[1]));
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, commander.phase);
}

static void test_the_second_route_must_begin_too(void)
{
    start_driving();
    pass_telling(300, JP_ROBOT_BALANCING, commander.task.id, JP_ROUTE_DONE, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DONE, commander.phase);
    start_uploading();
    pass_telling(5300, JP_ROBOT_BALANCING, commander.task.id, JP_ROUTE_READY, JP_REASON_NONE);
    check_failed(JP_FAILURE_NO_START);
}

static void test_a_fall_after_the_task_is_no_failure_of_it(void)
{
    start_driving();
    pass_telling(300, JP_ROBOT_BALANCING, commander.task.id, JP_ROUTE_DONE, JP_REASON_NONE);
    pass_telling(300, JP_ROBOT_FALLEN, commander.task.id, JP_ROUTE_DONE, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DONE, commander.phase);
    TEST_ASSERT_EQUAL_INT(JP_FAILURE_NONE, commander.failure);
}

static void test_another_route_that_is_ready_is_not_this_one(void)
{
    start_uploading();
    for (int i = 0; i < 3; i++) {
        say_route((uint8_t)(commander.task.id + 1U), JP_ROUTE_READY, JP_REASON_NONE);
    }
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
}

/** No time has passed before the first tick. */
static void test_time_begins_with_the_first_tick(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, points, 3));
    TEST_ASSERT_EQUAL_UINT(10001, ms_until_failed(tell_idle));
}

static void test_an_ecu_that_tells_of_routes_alone_is_silent(void)
{
    start_uploading();
    tell_ready();
    tell_ready();
    for (int i = 0; i < 11; i++) {
        say_route(commander.task.id, JP_ROUTE_READY, JP_REASON_NONE);
        pass(100);
    }
    check_failed(JP_FAILURE_SILENCE);
}

/** A bus that is busy makes an upload long, which is no failure to begin. */
static void test_a_long_upload_is_waited_for(void)
{
    static const struct jp_point many[20];

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&commander, many, 20));
    tell_idle();
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
    for (int i = 0; commander.sent <= 20; i++) {
        answer = i % 400 == 399 ? JP_OK : JP_ERR_BUSY;
        commander.since_command_ms = 0; /* that commands do not take the bus */
        tell_idle();
        say_ecu(JP_ROBOT_BALANCING, JP_OPERATOR_ALIVE);
        pass(1);
        TEST_ASSERT_EQUAL_INT(JP_OPERATOR_UPLOADING, commander.phase);
    }
    TEST_ASSERT_GREATER_THAN_UINT32(5000, commander.in_phase_ms);
}

/** As a flipped bit of the memory would leave it. */
static void test_a_phase_that_is_none_does_nothing(void)
{
    start_driving();
    sent_count = 0;
    commander.phase = (enum jp_operator_phase)99;
    pass(20000);
    TEST_ASSERT_EQUAL_INT(99, commander.phase);
    TEST_ASSERT_EQUAL_UINT(JP_MODE_STAND, last_command().mode);
}

static void test_every_failure_has_words(void)
{
    TEST_ASSERT_NULL(jp_operator_failure_text(JP_FAILURE_NONE));
    for (int failure = JP_FAILURE_NONE + 1; failure < JP_FAILURES; failure++) {
        const char *text = jp_operator_failure_text((enum jp_operator_failure)failure);

        TEST_ASSERT_NOT_NULL(text);
        for (int other = JP_FAILURE_NONE + 1; other < failure; other++) {
            TEST_ASSERT_TRUE(text != jp_operator_failure_text((enum jp_operator_failure)other));
        }
    }
}
