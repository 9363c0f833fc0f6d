/* Every fault of a robot with four steered wheels in every state of its tick, with frames of its board and of CAN:
 * where it ends, which fault it reports, and after how many ticks. The table below is the promise; tests/FAULTS.md
 * shows it. */
#include <joulepath/four_wheel_robot.h>
#include <joulepath/tables.h>

#include "hal/can/jp_can.h"
#include "hal/can/wheel_link.h"
#include "tests/support/fault_matrix.h"

enum { BOARD, CAN, TRANSPORTS };
enum { STATES = JP_FOUR_WHEEL_ROBOT_FAULT + 1, LONG_ENOUGH = 300 };

#define ON_BOARD 1U
#define ON_CAN   2U
#define ON_BOTH  3U

static const char *const transports[TRANSPORTS] = {"board", "CAN"};
static const char *const states[STATES] = {"idle", "standing", "driving", "fault"};
/* Faster than limits.speed_lag, below which a wheel may lag by all of its speed. */
static const struct jp_twist ahead = {.x = JP_Q24(0.6)};

static int transport;
static bool is_silent;
static bool is_forgotten; /* nobody renews the twist */
static enum { SOUND, CORRUPT, SHORT, REPEATED } frames_are;
static unsigned failing_ticks;
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
    is_silent = false;
    is_forgotten = false;
    frames_are = SOUND;
    failing_ticks = 0;
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

static void fall_silent(void)
{
    is_silent = true;
}

static void fall_silent_for_a_while(void)
{
    is_silent = failing_ticks < config->limits.confirm_ticks;
}

static void corrupt(void)
{
    frames_are = CORRUPT;
}

static void shorten(void)
{
    frames_are = SHORT;
}

static void repeat(void)
{
    frames_are = REPEATED;
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

static void forget(void)
{
    is_forgotten = true;
}

static void reset_once(void)
{
    struct jp_four_wheel_snapshot snapshot;
    const char *field = "";

    if (failing_ticks == 1U) {
        jp_four_wheel_robot_snapshot(&robot, &snapshot);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_init(&robot, config, &field));
        (void)jp_four_wheel_robot_resume(&robot, &snapshot);
        is_forgotten = true;
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

static void run(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        tick(NULL);
    }
}

/* ---- States ---- */

static void stand(void)
{
    run(3);
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

static void reach(enum jp_four_wheel_robot_state state)
{
    static void (*const ways[STATES])(void) = {NULL, stand, drive, fail};

    if (ways[state] != NULL) {
        ways[state]();
    } else {
        run(3);
    }
    TEST_ASSERT_EQUAL_INT(state, jp_four_wheel_robot_state_now(&robot));
}

/* ---- The matrix ---- */

struct end {
    enum jp_four_wheel_robot_state state;
    uint16_t faults;
};

struct row {
    const char *fault;
    void (*inject)(void);
    unsigned on; /* which transports */
    unsigned ticks;
    struct end ends[STATES];
};

#define FAULT_STAYS                                                                                                    \
    {                                                                                                                  \
        JP_FOUR_WHEEL_ROBOT_FAULT, JP_FAULT_BUS_VOLTAGE                                                                \
    }

/* Of one that ends every motion; faults add up. */
#define STOPS(bits)                                                                                                    \
    {                                                                                                                  \
        {JP_FOUR_WHEEL_ROBOT_FAULT, bits}, {JP_FOUR_WHEEL_ROBOT_FAULT, bits}, {JP_FOUR_WHEEL_ROBOT_FAULT, bits},       \
        {                                                                                                              \
            JP_FOUR_WHEEL_ROBOT_FAULT, (bits) | JP_FAULT_BUS_VOLTAGE                                                   \
        }                                                                                                              \
    }

/* Of one that shows in motion only. */
#define IN_MOTION(bits)                                                                                                \
    {                                                                                                                  \
        {JP_FOUR_WHEEL_ROBOT_IDLE, 0}, {JP_FOUR_WHEEL_ROBOT_STANDING, 0}, {JP_FOUR_WHEEL_ROBOT_FAULT, bits},           \
            FAULT_STAYS                                                                                                \
    }

/* Of one that the robot rides out, driving in the state `driving`. */
#define RIDDEN_OUT(driving)                                                                                            \
    {                                                                                                                  \
        {JP_FOUR_WHEEL_ROBOT_IDLE, 0}, {JP_FOUR_WHEEL_ROBOT_STANDING, 0}, {driving, 0}, FAULT_STAYS                    \
    }

/* Of a reset: a robot that drove brakes and stands; a fault is over. */
#define AFTER_RESET                                                                                                    \
    {                                                                                                                  \
        {JP_FOUR_WHEEL_ROBOT_IDLE, 0}, {JP_FOUR_WHEEL_ROBOT_STANDING, 0}, {JP_FOUR_WHEEL_ROBOT_STANDING, 0},           \
        {                                                                                                              \
            JP_FOUR_WHEEL_ROBOT_IDLE, 0                                                                                \
        }                                                                                                              \
    }

static const struct row rows[] = {
    {"ENCODER_JUMP", jump, ON_BOTH, 4, STOPS(JP_FAULT_ENCODER_JUMP)},
    {"ENCODER_LEFT", leave_angle_left, ON_BOTH, 4, STOPS(JP_FAULT_ENCODER_LEFT)},
    {"ENCODER_RIGHT", leave_angle_right, ON_BOTH, 4, STOPS(JP_FAULT_ENCODER_RIGHT)},
    {"CURRENT_RANGE", leave_current, ON_BOTH, 4, STOPS(JP_FAULT_CURRENT_RANGE)},
    {"BUS_VOLTAGE", lose_voltage, ON_BOTH, 4, STOPS(JP_FAULT_BUS_VOLTAGE)},
    {"HARDWARE: no samples", fall_silent, ON_BOTH, 4, STOPS(JP_FAULT_HARDWARE)},
    {"STALLED_LEFT", block_left, ON_BOTH, 51, IN_MOTION(JP_FAULT_STALLED_LEFT)},
    {"STALLED_RIGHT", block_right, ON_BOTH, 51, IN_MOTION(JP_FAULT_STALLED_RIGHT)},
    {"samples stay away for 40 ms", fall_silent_for_a_while, ON_CAN, 0, RIDDEN_OUT(JP_FOUR_WHEEL_ROBOT_DRIVING)},
    {"samples are corrupt", corrupt, ON_CAN, 4, STOPS(JP_FAULT_HARDWARE)},
    {"samples are short", shorten, ON_CAN, 4, STOPS(JP_FAULT_HARDWARE)},
    {"samples are repeated", repeat, ON_CAN, 4, STOPS(JP_FAULT_HARDWARE)},
    {"the operator is silent", forget, ON_BOTH, 0, RIDDEN_OUT(JP_FOUR_WHEEL_ROBOT_STANDING)},
    {"the controller is reset", reset_once, ON_BOTH, 0, AFTER_RESET},
};

static uint16_t faults(void)
{
    struct jp_four_wheel_telemetry telemetry;

    TEST_ASSERT_TRUE(jp_four_wheel_robot_telemetry(&robot, &telemetry));
    return telemetry.faults;
}

static bool is_moved(void)
{
    const enum jp_four_wheel_robot_state state = jp_four_wheel_robot_state_now(&robot);

    return state == JP_FOUR_WHEEL_ROBOT_STANDING || state == JP_FOUR_WHEEL_ROBOT_DRIVING;
}

static void check_cell(const struct row *row, enum jp_four_wheel_robot_state state)
{
    const struct matrix_cell cell = {"four wheels", transports[transport], row->fault, states[state]};
    char expected[MATRIX_TEXT];
    char seen[MATRIX_TEXT];
    unsigned ticks = 0;

    reach(state);
    const bool ends = is_moved() && row->ticks > 0U && row->ends[state].state == JP_FOUR_WHEEL_ROBOT_FAULT;

    for (unsigned i = 0; i < LONG_ENOUGH; i++) {
        if (state == JP_FOUR_WHEEL_ROBOT_DRIVING && !is_forgotten) {
            (void)jp_four_wheel_robot_drive(&robot, &ahead);
        }
        tick(row->inject);
        ticks += is_moved() ? 1U : 0U;
    }
    matrix_describe(expected, states[row->ends[state].state], row->ends[state].faults);
    matrix_describe(seen, states[jp_four_wheel_robot_state_now(&robot)], faults());
    matrix_judge(&cell, expected, seen, ends ? ticks + 1U : 0U);
    if (ends) {
        TEST_ASSERT_LESS_OR_EQUAL_UINT(row->ticks, ticks + 1U);
    }
}

static void check_all(int chosen)
{
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        for (int state = 0; state < STATES; state++) {
            if ((rows[i].on >> chosen & 1U) != 0U) {
                setUp();
                transport = chosen;
                check_cell(&rows[i], (enum jp_four_wheel_robot_state)state);
            }
        }
    }
}

static void test_with_frames_of_its_board(void)
{
    check_all(BOARD);
}

static void test_with_frames_of_can(void)
{
    check_all(CAN);
}
