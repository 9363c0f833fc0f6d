/* The operator: what is obeyed at once and what needs three, gaps, corruption, silence and the way back from it. */
#include "hal/can/operator_link.h"

#include "tests/support/commands.h"

#include "unity.h"

static struct jp_operator_link link;
static uint8_t counter;

static void start(uint32_t tick_rate)
{
    jp_operator_link_start(&link, tick_rate);
    counter = 0;
}

void setUp(void)
{
    start(1000);
}

void tearDown(void)
{
}

static enum jp_operator_result give(uint8_t number, uint8_t mode, uint8_t route)
{
    const struct jp_can_frame frame = operator_command(number, mode, route);

    return jp_operator_link_accept(&link, &frame);
}

/* The next command in sequence. */
static void command(uint8_t mode, uint8_t route)
{
    counter = (counter + 1U) & 15U;
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_OK, give(counter, mode, route));
}

static void expect(enum jp_operator_state state, enum jp_operator_mode mode)
{
    TEST_ASSERT_EQUAL_INT(state, link.state);
    TEST_ASSERT_EQUAL_INT(mode, link.mode);
}

static void make_standing(void)
{
    command(JP_MODE_STAND, 0);
    command(JP_MODE_STAND, 0);
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
}

static void make_driving(uint8_t route)
{
    make_standing();
    for (int i = 0; i < 3; i++) {
        command(JP_MODE_DRIVE, route);
    }
    expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
    TEST_ASSERT_EQUAL_UINT8(route, link.route);
}

/* A packed frame of cantools; those of commands.h are held against it. */
static void test_frames_of_cantools_are_understood(void)
{
    static const uint8_t stand[4] = {0xAD, 0x11, 0x00, 0x00};
    static const uint8_t drive_7[4] = {0xED, 0x22, 0x07, 0x00};
    static const uint8_t off_255[4] = {0xF7, 0x03, 0xFF, 0x00};

    TEST_ASSERT_EQUAL_HEX8_ARRAY(stand, operator_command(1, JP_MODE_STAND, 0).data, 4);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(drive_7, operator_command(2, JP_MODE_DRIVE, 7).data, 4);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(off_255, operator_command(3, JP_MODE_OFF, 255).data, 4);
    TEST_ASSERT_EQUAL_HEX32(0x100, operator_command(1, 0, 0).id);
    TEST_ASSERT_EQUAL_UINT8(4, operator_command(1, 0, 0).length);
}

/* What is obeyed */

static void test_nobody_is_there_at_the_start(void)
{
    expect(JP_OPERATOR_NONE, JP_MODE_OFF);
    TEST_ASSERT_FALSE(jp_operator_link_pass(&link, 1000000));
    expect(JP_OPERATOR_NONE, JP_MODE_OFF);
}

static void test_stand_is_obeyed_at_once_but_for_the_first_message(void)
{
    command(JP_MODE_STAND, 0);
    expect(JP_OPERATOR_NONE, JP_MODE_OFF);
    command(JP_MODE_STAND, 0);
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
}

static void test_stand_is_obeyed_at_once_while_driving(void)
{
    make_driving(4);
    command(JP_MODE_STAND, 0);
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
}

static void test_stand_is_obeyed_after_a_gap(void)
{
    make_driving(4);
    counter = (uint8_t)(counter + JP_E2E_GAP_MAX);
    command(JP_MODE_STAND, 0);
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
}

static void test_drive_needs_three(void)
{
    make_standing();
    command(JP_MODE_DRIVE, 9);
    command(JP_MODE_DRIVE, 9);
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
    command(JP_MODE_DRIVE, 9);
    expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
    TEST_ASSERT_EQUAL_UINT8(9, link.route);
    for (int i = 0; i < 300; i++) {
        command(JP_MODE_DRIVE, 9);
    }
    expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
}

static void test_off_needs_three(void)
{
    make_driving(1);
    command(JP_MODE_OFF, 0);
    command(JP_MODE_OFF, 0);
    expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
    command(JP_MODE_OFF, 0);
    expect(JP_OPERATOR_ALIVE, JP_MODE_OFF);
}

static void test_off_alone_makes_the_operator_known(void)
{
    for (int i = 0; i < 3; i++) {
        command(JP_MODE_OFF, 0);
        expect(JP_OPERATOR_NONE, JP_MODE_OFF);
    }
    command(JP_MODE_OFF, 0);
    expect(JP_OPERATOR_ALIVE, JP_MODE_OFF);
}

static void test_drive_is_not_obeyed_before_stand(void)
{
    for (int i = 0; i < 20; i++) {
        command(JP_MODE_DRIVE, 1);
    }
    expect(JP_OPERATOR_NONE, JP_MODE_OFF);
    for (int i = 0; i < 3; i++) {
        command(JP_MODE_OFF, 0);
    }
    for (int i = 0; i < 20; i++) {
        command(JP_MODE_DRIVE, 1);
    }
    expect(JP_OPERATOR_ALIVE, JP_MODE_OFF);
    command(JP_MODE_STAND, 0);
    command(JP_MODE_DRIVE, 1);
    command(JP_MODE_DRIVE, 1);
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
    command(JP_MODE_DRIVE, 1);
    expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
}

/* What begins the count of three anew */

static void test_a_lost_command_begins_anew(void)
{
    for (unsigned lost = 1; lost <= JP_E2E_GAP_MAX; lost++) {
        setUp();
        make_standing();
        command(JP_MODE_DRIVE, 1);
        command(JP_MODE_DRIVE, 1);
        counter = (uint8_t)(counter + lost);
        command(JP_MODE_DRIVE, 1);
        command(JP_MODE_DRIVE, 1);
        expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
        command(JP_MODE_DRIVE, 1);
        expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
    }
}

static void test_a_long_gap_begins_anew(void)
{
    make_standing();
    command(JP_MODE_DRIVE, 1);
    command(JP_MODE_DRIVE, 1);
    counter = (counter + 9U) & 15U; /* eight were lost */
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_SEQUENCE, give(counter, JP_MODE_DRIVE, 1));
    command(JP_MODE_DRIVE, 1);
    command(JP_MODE_DRIVE, 1);
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
    command(JP_MODE_DRIVE, 1);
    expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
}

static void test_another_route_begins_anew(void)
{
    make_driving(1);
    command(JP_MODE_DRIVE, 2);
    command(JP_MODE_DRIVE, 2);
    TEST_ASSERT_EQUAL_UINT8(1, link.route);
    command(JP_MODE_DRIVE, 2);
    TEST_ASSERT_EQUAL_UINT8(2, link.route);
}

static void test_another_mode_begins_anew(void)
{
    make_standing();
    command(JP_MODE_DRIVE, 1);
    command(JP_MODE_DRIVE, 1);
    command(JP_MODE_OFF, 1);
    command(JP_MODE_OFF, 1);
    command(JP_MODE_DRIVE, 1);
    command(JP_MODE_DRIVE, 1);
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
}

static void test_navigate_is_obeyed_as_drive_is(void)
{
    make_standing();
    command(JP_MODE_NAVIGATE, 9);
    command(JP_MODE_NAVIGATE, 9);
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
    command(JP_MODE_NAVIGATE, 9);
    expect(JP_OPERATOR_ALIVE, JP_MODE_NAVIGATE);
    TEST_ASSERT_EQUAL_UINT8(9, link.route);
    command(JP_MODE_DRIVE, 9);
    command(JP_MODE_DRIVE, 9);
    expect(JP_OPERATOR_ALIVE, JP_MODE_NAVIGATE);
    command(JP_MODE_DRIVE, 9);
    expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
}

static void test_silence_and_the_stand_of_anybody_end_navigate(void)
{
    for (unsigned is_silence = 0; is_silence < 2; is_silence++) {
        make_standing();
        for (unsigned i = 0; i < 3; i++) {
            command(JP_MODE_NAVIGATE, 2);
        }
        expect(JP_OPERATOR_ALIVE, JP_MODE_NAVIGATE);
        if (is_silence == 1U) {
            TEST_ASSERT_TRUE(jp_operator_link_pass(&link, 500));
            expect(JP_OPERATOR_LOST, JP_MODE_STAND);
        } else {
            TEST_ASSERT_EQUAL_INT(JP_OPERATOR_SEQUENCE, give(counter + 9U, JP_MODE_STAND, 0));
            expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
        }
        command(JP_MODE_NAVIGATE, 2);
        command(JP_MODE_NAVIGATE, 2);
        TEST_ASSERT_EQUAL_INT(JP_MODE_STAND, link.mode);
    }
}

static void test_a_malformed_command_begins_anew(void)
{
    make_standing();
    command(JP_MODE_DRIVE, 1);
    command(JP_MODE_DRIVE, 1);
    counter++;
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_MALFORMED, give(counter, 4, 1));
    command(JP_MODE_DRIVE, 1);
    command(JP_MODE_DRIVE, 1);
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
    command(JP_MODE_DRIVE, 1);
    expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
}

static void test_repeated_and_late_commands_neither_count_nor_disturb(void)
{
    make_standing();
    command(JP_MODE_DRIVE, 1);
    for (int i = 0; i < 10; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OPERATOR_SEQUENCE, give(counter, JP_MODE_DRIVE, 1));
    }
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
    command(JP_MODE_DRIVE, 1);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_SEQUENCE, give(1, JP_MODE_OFF, 0));
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
    command(JP_MODE_DRIVE, 1);
    expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
}

static void test_a_stand_of_anybody_stops_the_robot(void)
{
    /* Repeated, late by one to eight, or ahead by more than may be lost. */
    for (unsigned ahead = JP_E2E_GAP_MAX + 2U; ahead <= 16U; ahead++) {
        setUp();
        make_driving(1);
        TEST_ASSERT_EQUAL_INT(JP_OPERATOR_SEQUENCE, give((counter + ahead) & 15U, JP_MODE_STAND, 0));
        expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
        command(JP_MODE_DRIVE, 1);
        command(JP_MODE_DRIVE, 1);
        expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
        command(JP_MODE_DRIVE, 1);
        expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
    }
}

static void test_while_anybody_says_stand_drive_is_not_obeyed(void)
{
    uint8_t others = 3;

    make_driving(1);
    for (int i = 0; i < 100; i++) {
        const struct jp_can_frame frame = operator_command(others++ & 15U, JP_MODE_STAND, 0);

        (void)jp_operator_link_accept(&link, &frame);
        expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
        command(JP_MODE_DRIVE, 1);
        expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
        counter = link.receiver.counter;
    }
}

static void test_a_stand_of_somebody_else_switches_nothing_on(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_OK, give(1, JP_MODE_STAND, 0));
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_SEQUENCE, give(9, JP_MODE_STAND, 0));
    expect(JP_OPERATOR_NONE, JP_MODE_OFF);
    setUp();
    make_standing();
    for (int i = 0; i < 3; i++) {
        command(JP_MODE_OFF, 0);
    }
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_SEQUENCE, give((counter + 9U) & 15U, JP_MODE_STAND, 0));
    expect(JP_OPERATOR_ALIVE, JP_MODE_OFF);
}

static void test_corrupt_commands_neither_count_nor_disturb(void)
{
    struct jp_can_frame frame;

    make_standing();
    command(JP_MODE_DRIVE, 1);
    command(JP_MODE_DRIVE, 1);
    for (unsigned bit = 0; bit < 32; bit++) {
        frame = operator_command(counter + 1U, JP_MODE_OFF, 0);
        frame.data[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
        TEST_ASSERT_EQUAL_INT(JP_OPERATOR_CRC, jp_operator_link_accept(&link, &frame));
    }
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
    command(JP_MODE_DRIVE, 1);
    expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
}

/* Silence */

static void check_timeout(uint32_t tick_rate)
{
    const uint32_t timeout = tick_rate / 2U;

    start(tick_rate);
    make_driving(1);
    for (uint32_t i = 1; i < timeout; i++) {
        TEST_ASSERT_FALSE(jp_operator_link_pass(&link, 1));
    }
    expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
    TEST_ASSERT_TRUE(jp_operator_link_pass(&link, 1));
    expect(JP_OPERATOR_LOST, JP_MODE_STAND);
    for (uint32_t i = 0; i < 2U * timeout; i++) {
        TEST_ASSERT_FALSE(jp_operator_link_pass(&link, 1)); /* it is lost only once */
    }
}

static void test_silence_counts_from_exactly_500_ms(void)
{
    check_timeout(1000);
    check_timeout(100);
    check_timeout(400);
    check_timeout(10000);
}

static void test_time_may_pass_in_one_piece(void)
{
    make_driving(1);
    TEST_ASSERT_FALSE(jp_operator_link_pass(&link, 499));
    TEST_ASSERT_FALSE(jp_operator_link_pass(&link, 0));
    TEST_ASSERT_TRUE(jp_operator_link_pass(&link, UINT32_MAX - 499U));
}

static void test_only_valid_commands_break_the_silence(void)
{
    struct jp_can_frame corrupt;

    make_driving(1);
    TEST_ASSERT_FALSE(jp_operator_link_pass(&link, 499));
    command(JP_MODE_DRIVE, 1);
    TEST_ASSERT_FALSE(jp_operator_link_pass(&link, 499));
    corrupt = operator_command(counter + 1U, JP_MODE_DRIVE, 1);
    corrupt.data[2] ^= 1U;
    (void)jp_operator_link_accept(&link, &corrupt);
    (void)give(counter, JP_MODE_DRIVE, 1);
    (void)give(counter + 1U, 4, 1);
    TEST_ASSERT_TRUE(jp_operator_link_pass(&link, 1));
}

static void test_a_standing_robot_stands_on_and_one_that_is_off_stays_off(void)
{
    make_standing();
    TEST_ASSERT_TRUE(jp_operator_link_pass(&link, 500));
    expect(JP_OPERATOR_LOST, JP_MODE_STAND);
    setUp();
    make_standing();
    for (int i = 0; i < 3; i++) {
        command(JP_MODE_OFF, 0);
    }
    TEST_ASSERT_TRUE(jp_operator_link_pass(&link, 500));
    expect(JP_OPERATOR_LOST, JP_MODE_OFF);
}

static void test_after_a_silence_drive_needs_a_stand(void)
{
    make_driving(1);
    TEST_ASSERT_TRUE(jp_operator_link_pass(&link, 500));
    for (int i = 0; i < 50; i++) {
        command(JP_MODE_DRIVE, 1);
    }
    expect(JP_OPERATOR_LOST, JP_MODE_STAND);
    command(JP_MODE_STAND, 0);
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
    command(JP_MODE_DRIVE, 1);
    command(JP_MODE_DRIVE, 1);
    expect(JP_OPERATOR_ALIVE, JP_MODE_STAND);
    command(JP_MODE_DRIVE, 1);
    expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
}

static void test_after_a_silence_off_does_not_lead_to_drive(void)
{
    make_driving(1);
    TEST_ASSERT_TRUE(jp_operator_link_pass(&link, 500));
    for (int i = 0; i < 3; i++) {
        command(JP_MODE_OFF, 0);
    }
    expect(JP_OPERATOR_ALIVE, JP_MODE_OFF);
    for (int i = 0; i < 20; i++) {
        command(JP_MODE_DRIVE, 1);
    }
    expect(JP_OPERATOR_ALIVE, JP_MODE_OFF);
}

static void test_commands_from_before_a_silence_do_not_count(void)
{
    make_standing();
    command(JP_MODE_OFF, 0);
    command(JP_MODE_OFF, 0);
    TEST_ASSERT_TRUE(jp_operator_link_pass(&link, 500));
    command(JP_MODE_OFF, 0);
    expect(JP_OPERATOR_LOST, JP_MODE_STAND);
    command(JP_MODE_OFF, 0);
    command(JP_MODE_OFF, 0);
    expect(JP_OPERATOR_ALIVE, JP_MODE_OFF);
}

static void test_confirmations_are_counted_no_further_than_needed(void)
{
    make_standing();
    for (int i = 0; i < 600; i++) {
        command(JP_MODE_DRIVE, 4);
        TEST_ASSERT_EQUAL_UINT8(i < 2 ? i + 1 : 3, link.confirmations);
    }
    expect(JP_OPERATOR_ALIVE, JP_MODE_DRIVE);
}

/* What was confirmed before the silence does not count. */
static void test_off_after_silence_needs_three_again(void)
{
    make_standing();
    for (int i = 0; i < 3; i++) {
        command(JP_MODE_OFF, 0);
    }
    expect(JP_OPERATOR_ALIVE, JP_MODE_OFF);
    TEST_ASSERT_TRUE(jp_operator_link_pass(&link, JP_OPERATOR_TIMEOUT_MS));
    command(JP_MODE_OFF, 0);
    command(JP_MODE_OFF, 0);
    expect(JP_OPERATOR_LOST, JP_MODE_OFF);
    command(JP_MODE_OFF, 0);
    expect(JP_OPERATOR_ALIVE, JP_MODE_OFF);
}
