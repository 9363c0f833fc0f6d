/* The application with sensors and bridges of its own board: commands come from the bus, motion does not. */
#include <joulepath/tables.h>

#include "tests/support/ecu_start.h"

#include "hal/can/jp_can.h"
#include "tests/support/commands.h"

#include "unity.h"

/* A board whose wheels are held: currents are those of its voltages. */
static struct board {
    struct jp_sensors sensors;
    struct jp_actuation actuation;
    enum jp_status read;
    enum jp_status write;
    unsigned reads;
    unsigned writes;
} board;

static struct jp_robot_config config;
static struct jp_ecu ecu;
static struct jp_ecu_balancer balancer;
static struct jp_retained retained;
static unsigned motor_commands;
static uint8_t command_counter;

static enum jp_status read_board(void *context, struct jp_sensors *sensors)
{
    struct board *from = context;
    const struct jp_voltages *voltages = &jp_robot_last_tick(&balancer.robot)->voltages;

    from->reads++;
    from->sensors.current_left = jp_q16_divide(voltages->left, config.monitor.motor_resistance);
    from->sensors.current_right = jp_q16_divide(voltages->right, config.monitor.motor_resistance);
    *sensors = from->sensors;
    return from->read;
}

static enum jp_status write_board(void *context, const struct jp_actuation *actuation)
{
    struct board *to = context;

    to->writes++;
    to->actuation = *actuation;
    return to->write;
}

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    motor_commands += frame->id == JP_CAN_MOTOR_COMMAND_FRAME_ID ? 1U : 0U;
    return JP_OK;
}

static enum jp_can_state always_on(void *context)
{
    (void)context;
    return JP_CAN_ON;
}

static void boot(void)
{
    static const struct jp_can_port port = {NULL, send, always_on};
    static const struct jp_hal hal = {&board, read_board, write_board};
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK,
                          ecu_start(&ecu, &balancer, &config, &jp_energy_model_courier24, &port, &retained, &field));
    jp_ecu_use_board(&ecu, &hal);
}

void setUp(void)
{
    config = jp_robot_courier24;
    config.monitor.freeze_ticks = 0;
    board = (struct board){.sensors = {.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)}};
    retained = (struct jp_retained){0};
    motor_commands = 0;
    command_counter = 0;
    boot();
}

void tearDown(void)
{
}

static void run(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        jp_ecu_tick(&ecu);
        jp_ecu_work(&ecu);
    }
}

static void command(uint8_t mode)
{
    const struct jp_can_frame frame = operator_command(++command_counter & 15U, mode, 0);

    TEST_ASSERT_FALSE(jp_ecu_accept(&ecu, &frame));
    run(100);
}

/** The first command only begins the sequence. */
static void stand_up(void)
{
    run(3);
    command(JP_MODE_STAND);
    command(JP_MODE_STAND);
}

static void expect(enum jp_robot_state state, uint8_t enabled)
{
    TEST_ASSERT_EQUAL_INT(state, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_EQUAL_UINT8(enabled, board.actuation.enabled);
}

static void test_every_tick_reads_and_writes_the_board(void)
{
    run(7);
    TEST_ASSERT_EQUAL_UINT(7, board.reads);
    TEST_ASSERT_EQUAL_UINT(7, board.writes);
    expect(JP_ROBOT_IDLE, 0);
}

static void test_a_command_from_the_bus_switches_the_board_on_and_off(void)
{
    stand_up();
    expect(JP_ROBOT_BALANCING, 1);
    for (int i = 0; i < 3; i++) {
        command(JP_MODE_OFF);
    }
    expect(JP_ROBOT_IDLE, 0);
}

static void test_no_motor_command_is_on_the_bus(void)
{
    stand_up();
    TEST_ASSERT_EQUAL_UINT(0, motor_commands);
}

static void test_samples_on_the_bus_mean_nothing(void)
{
    const struct jp_sensors others = {.encoder_left = 5, .pitch_rate = JP_Q24(0.5), .accel_z = JP_Q24_ONE};
    struct jp_can_frame frames[JP_SAMPLE_PARTS];
    uint8_t counter = 0;

    run(3);
    jp_message_from_sensors(frames, &counter, &others);
    for (int part = 0; part < JP_SAMPLE_PARTS; part++) {
        (void)jp_ecu_accept(&ecu, &frames[part]);
    }
    run(1);
    TEST_ASSERT_EQUAL_UINT32(0, balancer.robot.internal.monitor.good.encoder_left);
    TEST_ASSERT_EQUAL_INT32(0, balancer.robot.internal.monitor.good.pitch_rate);
}

static void test_sensors_that_do_not_answer_switch_off(void)
{
    stand_up();
    board.read = JP_ERR_HARDWARE;
    run(config.monitor.confirm_ticks);
    expect(JP_ROBOT_FAULT, 0);
    TEST_ASSERT_BITS(JP_FAULT_HARDWARE, JP_FAULT_HARDWARE, jp_robot_last_tick(&balancer.robot)->faults);
}

static void test_bridges_that_do_not_answer_switch_off(void)
{
    stand_up();
    board.write = JP_ERR_HARDWARE;
    run(config.monitor.confirm_ticks + 1U);
    expect(JP_ROBOT_FAULT, 0);
}

static void test_a_silent_bus_ends_in_a_balanced_stand(void)
{
    stand_up();
    run(5000);
    expect(JP_ROBOT_BALANCING, 1);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_LOST, ecu.internal.operator_link.state);
}

static void test_a_reset_goes_on_balancing_without_the_bus(void)
{
    board.sensors.encoder_left = 1000;
    board.sensors.encoder_right = 1000;
    stand_up();
    boot();
    run(1);
    expect(JP_ROBOT_BALANCING, 1);
    TEST_ASSERT_EQUAL_UINT32(1, ecu.resets);
}
