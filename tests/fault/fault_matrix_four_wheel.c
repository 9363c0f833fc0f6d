/* Every fault of a robot with four steered wheels in every state of its tick, with frames of its board and of CAN:
 * where it ends, which fault it reports, and after how many ticks. The table below is the promise; tests/FAULTS.md
 * shows it. */
#include <joulepath/four_wheel_robot.h>
#include <joulepath/tables.h>

#include "hal/can/jp_can.h"
#include "hal/can/wheel_link.h"
#include "tests/support/fault_matrix_ends.h"

/* Faster than limits.speed_lag, below which a wheel may lag by all of its speed. */
static const struct jp_twist ahead = {.x = JP_Q24(0.6)};

static const struct jp_four_wheel_robot_config *const config = &jp_four_wheel_robot_patrol;
static struct jp_four_wheel_robot robot;
static struct jp_four_wheel_sensors sensors;
static struct jp_four_wheel_sensors failing;
static struct jp_four_wheel_actuation actuation;
static struct jp_wheel_link link;
static uint8_t sample_counter;
static int64_t rolled[JP_WHEELS]; /* 2⁻²⁴ of a count */

void setUp(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_init(&robot, config, &field));
    sensors = (struct jp_four_wheel_sensors){
        .bus_voltage = (config->limits.voltage_min + config->limits.voltage_max) / 2, .bus_current = JP_Q16(2)};
    memset(&actuation, 0, sizeof actuation);
    memset(&link, 0, sizeof link);
    memset(rolled, 0, sizeof rolled);
    sample_counter = 0;
}

void tearDown(void)
{
}

/* ---- What goes wrong in a tick: of `failing`, which is a good frame ---- */

static void jump(void)
{
    failing.count[JP_FRONT_LEFT] += 100U * config->limits.count_jump;
}

static void leave_angle_left(void)
{
    failing.angle[JP_REAR_LEFT] = JP_ANGLE_DEGREES(170);
}

static void leave_angle_right(void)
{
    failing.angle[JP_FRONT_RIGHT] = -(int32_t)JP_ANGLE_DEGREES(170);
}

static void leave_current(void)
{
    failing.bus_current = config->limits.current + JP_Q16(0.1);
}

static void lose_voltage(void)
{
    failing.bus_voltage = config->limits.voltage_min - JP_Q16(0.5);
}

static void fall_silent_for_a_while(void)
{
    is_silent = failing_ticks < config->limits.confirm_ticks;
}

static void block(unsigned wheel)
{
    static uint32_t stopped;

    stopped = failing_ticks == 1U ? failing.count[wheel] : stopped;
    failing.count[wheel] = stopped;
}

static void block_left(void)
{
    block(JP_FRONT_LEFT);
}

static void block_right(void)
{
    block(JP_REAR_RIGHT);
}

static void reset_once(void)
{
    struct jp_four_wheel_snapshot snapshot;
    const char *field = "";

    if (failing_ticks == 1U) {
        jp_four_wheel_robot_snapshot(&robot, &snapshot);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_init(&robot, config, &field));
        (void)jp_four_wheel_robot_resume(&robot, &snapshot);
        operator_is = SILENT;
    }
}

/* ---- A tick ---- */

/* Drives that do at once what they are told. */
static void obey(void)
{
    for (int i = 0; i < JP_WHEELS && actuation.enabled != 0U; i++) {
        rolled[i] += (int64_t)actuation.wheels.speed[i] * ((int64_t)1 << 32) / config->count_speed;
        sensors.count[i] = (uint32_t)(uint64_t)(rolled[i] >> 24);
        sensors.angle[i] = actuation.wheels.angle[i];
    }
}

static enum jp_status read_bus(struct jp_four_wheel_sensors *frame)
{
    struct jp_can_frame frames[JP_WHEEL_SAMPLE_FRAMES];

    sample_counter = (uint8_t)(sample_counter - (frames_are == REPEATED ? 1U : 0U));
    jp_wheel_sample_pack(frames, &sample_counter, frame);
    for (unsigned i = 0; i < JP_WHEEL_SAMPLE_FRAMES && !is_silent; i++) {
        frames[i].data[2] ^= frames_are == CORRUPT ? 1U : 0U;
        if (frames_are != SHORT) { /* others are not given to the link */
            (void)jp_wheel_link_accept(&link, &frames[i]);
        }
    }
    return jp_wheel_link_read(&link, frame);
}

static void tick(void (*inject)(void))
{
    enum jp_status read = JP_OK;

    obey();
    failing = sensors;
    if (inject != NULL) {
        failing_ticks++;
        inject();
    }
    if (transport == CAN) {
        read = read_bus(&failing);
    } else if (is_silent) {
        read = JP_ERR_HARDWARE;
    }
    jp_four_wheel_robot_control(&robot, read, &failing, &actuation);
    jp_four_wheel_robot_account(&robot);
}

static void tick_failing(void (*inject)(void), int state)
{
    if (state == DRIVING && operator_is != SILENT) {
        (void)jp_four_wheel_robot_drive(&robot, &ahead);
    }
    tick(inject);
}

static void run(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        tick(NULL);
    }
}

/* ---- States ---- */

static void wake(void)
{
    run(3);
}

static void stand(void)
{
    wake();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_enable(&robot));
    run(3);
}

static void drive(void)
{
    stand();
    for (int i = 0; i < 100; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_drive(&robot, &ahead));
        run(1);
    }
}

static void fail(void)
{
    const jp_q16 good = sensors.bus_voltage;

    stand();
    sensors.bus_voltage = 0;
    run(config->limits.confirm_ticks);
    sensors.bus_voltage = good;
    run(1);
}

static int state_now(void)
{
    return (int)jp_four_wheel_robot_state_now(&robot);
}

static uint16_t faults(void)
{
    struct jp_four_wheel_telemetry telemetry;

    TEST_ASSERT_TRUE(jp_four_wheel_robot_telemetry(&robot, &telemetry));
    return telemetry.faults;
}

static const struct matrix_state states[STATES] = {
    {"idle", wake}, {"standing", stand}, {"driving", drive}, {"fault", fail}};

/* ---- The matrix ---- */

static const struct matrix_row rows[] = {
    {"ENCODER_JUMP", jump, ON_BOTH, 4, 0, STOPS(JP_FAULT_ENCODER_JUMP)},
    {"ENCODER_LEFT", leave_angle_left, ON_BOTH, 4, 0, STOPS(JP_FAULT_ENCODER_LEFT)},
    {"ENCODER_RIGHT", leave_angle_right, ON_BOTH, 4, 0, STOPS(JP_FAULT_ENCODER_RIGHT)},
    {"CURRENT_RANGE", leave_current, ON_BOTH, 4, 0, STOPS(JP_FAULT_CURRENT_RANGE)},
    {"BUS_VOLTAGE", lose_voltage, ON_BOTH, 4, 0, STOPS(JP_FAULT_BUS_VOLTAGE)},
    {"HARDWARE: no samples", fall_silent, ON_BOTH, 4, 0, STOPS(JP_FAULT_HARDWARE)},
    {"STALLED_LEFT", block_left, ON_BOTH, 51, 0, IN_MOTION(JP_FAULT_STALLED_LEFT)},
    {"STALLED_RIGHT", block_right, ON_BOTH, 51, 0, IN_MOTION(JP_FAULT_STALLED_RIGHT)},
    {"samples stay away for 40 ms", fall_silent_for_a_while, ON_CAN, 0, 0, RIDDEN_OUT(DRIVING)},
    {"samples are corrupt", corrupt_samples, ON_CAN, 4, 0, STOPS(JP_FAULT_HARDWARE)},
    {"samples are short", shorten_samples, ON_CAN, 4, 0, STOPS(JP_FAULT_HARDWARE)},
    {"samples are repeated", repeat_samples, ON_CAN, 4, 0, STOPS(JP_FAULT_HARDWARE)},
    {"the operator is silent", forget_operator, ON_BOTH, 0, 0, RIDDEN_OUT(STANDING)},
    {"the controller is reset", reset_once, ON_BOTH, 0, 0, AFTER_RESET},
};

static const struct matrix_robot four_wheels = {.name = "four wheels",
                                                .states = states,
                                                .state_count = STATES,
                                                .rows = rows,
                                                .row_count = sizeof rows / sizeof rows[0],
                                                .ticks = 300,
                                                .begin = setUp,
                                                .tick = tick_failing,
                                                .state = state_now,
                                                .faults = faults};

static void test_with_frames_of_its_board(void)
{
    matrix_check(&four_wheels, BOARD);
}

static void test_with_frames_of_can(void)
{
    matrix_check(&four_wheels, CAN);
}
