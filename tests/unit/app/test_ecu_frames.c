/* Frames that the application must not take: unknown, corrupt, too many, and those of another controller. */
#include "tests/support/ecu_rig.h"

static void give(uint32_t id, uint8_t length)
{
    const struct jp_can_frame frame = {.id = id, .length = length};

    TEST_ASSERT_FALSE(jp_ecu_accept(&ecu, &frame));
}

static void test_unknown_remote_and_extended_frames_are_counted(void)
{
    static const uint32_t known[] = {0x10,  0x20,  0x21,  0x22,  0x100, 0x101, 0x102, 0x103,
                                     0x104, 0x107, 0x180, 0x18E, 0x190, 0x193, 0x197};
    uint16_t count = 0;

    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        give(known[i] | JP_CAN_REMOTE, 8);
        give(known[i] | JP_CAN_EXTENDED, 8);
        give(known[i] | JP_CAN_EXTENDED | JP_CAN_REMOTE, 8);
        count = (uint16_t)(count + 3U);
        TEST_ASSERT_EQUAL_UINT16(count, ecu.unknown_frames);
    }
    give(0x000, 8);
    give(0x7FF, 0);
    give(0x1A0, 8);
    TEST_ASSERT_EQUAL_UINT16(count + 3U, ecu.unknown_frames);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.sample_counts.malformed);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.conflicts);
    ecu.unknown_frames = UINT16_MAX;
    give(0x000, 8);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, ecu.unknown_frames);
}

static void test_wrong_lengths_are_counted(void)
{
    static const struct {
        uint32_t id;
        uint8_t length;
    } known[] = {{0x10, 8},  {0x20, 8},  {0x21, 8},  {0x22, 8}, {0x100, 4},
                 {0x101, 8}, {0x102, 8}, {0x103, 8}, {0x180, 8}};
    uint8_t count = 0;

    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        for (uint8_t length = 0; length <= 8; length++) {
            if (length != known[i].length) {
                give(known[i].id, length);
                count++;
            }
            TEST_ASSERT_EQUAL_UINT8(count, ecu.sample_counts.malformed);
        }
    }
    TEST_ASSERT_EQUAL_UINT8(0, ecu.internal.queue_head);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.internal.samples.parts);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.conflicts);
    ecu.sample_counts.malformed = UINT8_MAX;
    give(0x20, 0);
    TEST_ASSERT_EQUAL_UINT8(UINT8_MAX, ecu.sample_counts.malformed);
}

static void test_frames_of_others_are_neither_taken_nor_counted(void)
{
    give(JP_CAN_BATTERY_STATUS_FRAME_ID, 8);
    TEST_ASSERT_EQUAL_UINT16(0, ecu.unknown_frames);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.conflicts);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.internal.queue_head);
}

static void test_frames_with_its_own_ids_are_conflicts(void)
{
    give(JP_CAN_MOTOR_COMMAND_FRAME_ID, 8);
    for (uint32_t id = 0x180; id <= 0x18E; id++) {
        give(id, 8);
    }
    TEST_ASSERT_EQUAL_UINT8(16, ecu.conflicts);
    TEST_ASSERT_EQUAL_UINT16(0, ecu.unknown_frames);
    ecu.conflicts = UINT8_MAX;
    give(JP_CAN_ECU_STATUS_FRAME_ID, 8);
    TEST_ASSERT_EQUAL_UINT8(UINT8_MAX, ecu.conflicts);
}

static void test_off_withdraws_a_stand_that_the_tick_has_not_seen(void)
{
    run(3);
    hold(JP_MODE_OFF, 0, 3);
    command(JP_MODE_STAND, 0);
    jp_ecu_work(&ecu);
    for (unsigned i = 0; i < JP_OPERATOR_CONFIRMATIONS; i++) {
        command(JP_MODE_OFF, 0);
    }
    jp_ecu_work(&ecu);
    jp_ecu_tick(&ecu);
    expect_state(JP_ROBOT_IDLE);
}

static void test_the_bridges_are_left_to_another_controller(void)
{
    unsigned commands;

    run(3);
    give(JP_CAN_MOTOR_COMMAND_FRAME_ID, 8);
    commands = bus.commands;
    run(499);
    TEST_ASSERT_EQUAL_UINT(commands, bus.commands);
    run(1);
    TEST_ASSERT_EQUAL_UINT(commands + 1U, bus.commands);
}

static void test_bridges_of_its_own_are_not_left_to_another_controller(void)
{
    unsigned commands;

    run(3);
    hold(JP_MODE_STAND, 0, 4);
    expect_state(JP_ROBOT_BALANCING);
    give(JP_CAN_MOTOR_COMMAND_FRAME_ID, 8);
    commands = bus.commands;
    run(10);
    TEST_ASSERT_EQUAL_UINT(commands + 10U, bus.commands);
    hold(JP_MODE_OFF, 0, 5);
    expect_state(JP_ROBOT_IDLE);
    commands = bus.commands;
    run(10);
    TEST_ASSERT_EQUAL_UINT(commands + 10U, bus.commands);
}

static void test_beside_another_controller_the_robot_does_not_stand_up(void)
{
    run(3);
    hold(JP_MODE_STAND, 0, 1); /* the first command is not obeyed */
    give(JP_CAN_MOTOR_COMMAND_FRAME_ID, 8);
    hold(JP_MODE_STAND, 0, 4);
    expect_operator(JP_OPERATOR_ALIVE, JP_MODE_STAND);
    expect_state(JP_ROBOT_IDLE);
    /* Each command is refused once, however many slices of work it stays. */
    expect_refused(4, JP_REFUSAL_CONFLICT);
    give(JP_CAN_MOTOR_COMMAND_FRAME_ID, 8); /* it is still there */
    command(JP_MODE_STAND, 0);
    run(499);
    expect_state(JP_ROBOT_IDLE);
    command(JP_MODE_STAND, 0);
    run(2);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_another_controller_does_not_switch_a_standing_robot_off(void)
{
    make_balancing();
    give(JP_CAN_MOTOR_COMMAND_FRAME_ID, 8);
    hold(JP_MODE_STAND, 0, 2);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_corrupt_commands_and_samples_are_counted(void)
{
    struct jp_can_frame frames[JP_SAMPLE_PARTS];
    struct jp_can_frame frame = operator_command(1, JP_MODE_STAND, 0);

    run(2);
    frame.data[2] ^= 1U;
    (void)jp_ecu_accept(&ecu, &frame);
    frame = route_offer(1, 7, 1, 0);
    frame.data[7] ^= 1U;
    (void)jp_ecu_accept(&ecu, &frame);
    run(1);
    TEST_ASSERT_EQUAL_UINT8(2, ecu.operator_counts.crc_errors);
    jp_message_from_sensors(frames, &sample_counter, &sensors);
    frames[0].data[7] ^= 1U;
    for (int part = 0; part < JP_SAMPLE_PARTS; part++) {
        (void)jp_ecu_accept(&ecu, &frames[part]);
    }
    TEST_ASSERT_EQUAL_UINT8(1, ecu.sample_counts.crc_errors);
    command(4, 0);
    command(4, 0);
    run(1);
    TEST_ASSERT_EQUAL_UINT8(1, ecu.operator_counts.malformed);
    command_counter--;
    command(JP_MODE_STAND, 0);
    run(1);
    TEST_ASSERT_EQUAL_UINT8(1, ecu.operator_counts.sequence_errors);
}

static void test_a_flood_of_commands_overflows_the_queue_and_nothing_else(void)
{
    run(2);
    for (unsigned i = 0; i < JP_ECU_QUEUE + 8U; i++) {
        command(JP_MODE_STAND, 0);
    }
    TEST_ASSERT_EQUAL_UINT8(9, ecu.sample_counts.rejected); /* one place always stays free */
    jp_ecu_work(&ecu);
    TEST_ASSERT_EQUAL_UINT8(ecu.internal.queue_head, ecu.internal.queue_tail);
    hold(JP_MODE_STAND, 0, 3);
    expect_state(JP_ROBOT_BALANCING);
    for (unsigned i = 0; i < 400; i++) {
        command(JP_MODE_DRIVE, 9);
    }
    TEST_ASSERT_EQUAL_UINT8(UINT8_MAX, ecu.sample_counts.rejected);
    run(10);
    expect_state(JP_ROBOT_BALANCING);
}
