/* Every fault of a robot that its sides steer in every state, with sensors and bridges on its board and on CAN: where
 * it ends, which fault it reports, and after how many ticks. The table below is the promise; tests/FAULTS.md shows it.
 */
#include "tests/support/ecu_skid_rig.h"
#include "tests/support/fault_matrix.h"

enum { BOARD, CAN, TRANSPORTS };
enum { STATES = JP_SKID_ROBOT_FAULT + 1, LONG_ENOUGH = 1500, COMMAND_TICKS = 50 };

#define ON_BOARD 1U
#define ON_CAN   2U
#define ON_BOTH  3U

static const char *const transports[TRANSPORTS] = {"board", "CAN"};
static const char *const states[STATES] = {"idle", "standing", "driving", "fault"};

static int transport;
static bool is_failing;
static bool is_silent; /* no samples come, or the board does not answer */
static enum jp_status written;
static enum { SOUND, CORRUPT, SHORT, REPEATED } frames_are;
static enum { OBEYED, SILENT, GARBLED } operator_is;
static struct jp_sensors failing;
static unsigned failing_ticks;

/* ---- The board ---- */

static enum jp_status read_board(void *context, struct jp_sensors *frame)
{
    (void)context;
    *frame = is_failing ? failing : sensors;
    return is_silent ? JP_ERR_HARDWARE : JP_OK;
}

static enum jp_status write_board(void *context, const struct jp_actuation *actuation)
{
    (void)context;
    bus.actuation = *actuation;
    return written;
}

static const struct jp_hal hal = {NULL, read_board, write_board};

/* ---- What goes wrong in a tick: of `failing`, which is a good frame ---- */

static void leave_range(void)
{
    failing.pitch_rate = config.monitor.gyro_limit + JP_Q24(0.01);
}

static void jump(void)
{
    failing.yaw_rate += config.monitor.gyro_jump + JP_Q24(0.01);
}

static void freeze(void)
{
    config.monitor.freeze_ticks = jp_skid_robot_zhang2018.monitor.freeze_ticks;
}

static void jump_encoder(void)
{
    failing.encoder_right += config.monitor.encoder_jump + 10U;
}

static void contradict_left(void)
{
    failing.current_left += 5 * (config.monitor.current_residual / 4);
}

static void contradict_right(void)
{
    failing.current_right += 5 * (config.monitor.current_residual / 4);
}

static void leave_current_range(void)
{
    failing.current_left = config.monitor.current_limit + JP_Q16(0.1);
}

static void lose_voltage(void)
{
    failing.bus_voltage = config.monitor.voltage_min - JP_Q16(1);
}

static void fall_silent(void)
{
    is_silent = true;
}

static void refuse_writing(void)
{
    written = JP_ERR_HARDWARE;
}

static void refuse_frames(void)
{
    bus.answer = JP_ERR_BUSY;
}

static void fall_silent_for_a_while(void)
{
    is_silent = failing_ticks <= HOLD_TICKS;
}

static void corrupt_samples(void)
{
    frames_are = CORRUPT;
}

static void shorten_samples(void)
{
    frames_are = SHORT;
}

static void repeat_samples(void)
{
    frames_are = REPEATED;
}

static void conflict(void)
{
    const struct jp_can_frame frame = {.id = JP_CAN_MOTOR_COMMAND_FRAME_ID, .length = 8};

    (void)jp_ecu_accept(&ecu, &frame);
}

static void forget_operator(void)
{
    operator_is = SILENT;
}

static void corrupt_commands(void)
{
    operator_is = GARBLED;
}

static void boot(void)
{
    bus.commands = 0;
    bus.receiver = (struct jp_e2e_receiver){.synchronised = false};
    init();
    if (transport == BOARD) {
        jp_ecu_use_board(&ecu, &hal);
    }
}

static void reset_once(void)
{
    if (failing_ticks == 1U) {
        boot();
    }
}

/* Downhill, faster and faster; the sensors show no more current than they can. */
static void run_away(void)
{
    const jp_q16 most = config.monitor.current_limit - JP_Q16(0.1);

    rolling = jp_clamp32((int32_t)failing_ticks * JP_Q24(0.01), 0, config.monitor.wheel_rate_limit + JP_Q24(0.05));
    failing.current_left = jp_clamp32(failing.current_left, -most, most);
    failing.current_right = jp_clamp32(failing.current_right, -most, most);
}

/* What the gyro sees of a robot that one side alone turns. */
static jp_turns_per_s turned_by(int side)
{
    const jp_turns_per_s turn = jp_q24_multiply(wheel_rate(side), config.wheels.turn_per_wheel);

    return jp_q24_multiply(side == JP_SKID_RIGHT ? turn : -turn, config.odometry.ratio);
}

/* A side that takes its greatest current and does not turn, once it is asked for current. */
static void stall(uint32_t *encoder, jp_q16 *current)
{
    static uint32_t stopped;

    stopped = failing_ticks == 1U ? *encoder : stopped;
    *encoder = stopped;
    *current = failing_ticks > 20U && *current > JP_Q16(1) ? config.wheels.stall_current + JP_Q16(1) : *current;
}

static void stall_left(void)
{
    stall(&failing.encoder_left, &failing.current_left);
    failing.yaw_rate = turned_by(JP_SKID_RIGHT);
}

static void stall_right(void)
{
    stall(&failing.encoder_right, &failing.current_right);
    failing.yaw_rate = turned_by(JP_SKID_LEFT);
}

/* Uphill one side carries all, of a robot that is commanded straight on: along a path its reference always turns a
 * little, and WHEELS_SPIN has to find it. */
static void lift_left(void)
{
    const struct jp_skid_command straight = {.motion = {JP_Q24(0.3), 0}, .duration = JP_Q16(8)};

    if (jp_skid_robot_state_now(&skid.robot) == JP_SKID_ROBOT_DRIVING && failing_ticks == 1U) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&skid.robot, &straight));
    }
    failing.accel_x = JP_Q24(0.1);
    failing.current_left = 0;
    failing.current_right = skid.robot.internal.control.sides[JP_SKID_RIGHT].load;
}

static void spin(void)
{
    failing.yaw_rate += JP_Q24(0.1);
}

static void tilt(void)
{
    failing.accel_x = JP_Q24(0.5);
}

/* ---- A tick ---- */

static void make_failing(void (*inject)(void))
{
    move();
    failing = sensors;
    failing_ticks++;
    inject();
}

static void send_failing(void)
{
    struct jp_can_frame frames[JP_SAMPLE_PARTS];

    sample_counter = (uint8_t)(sample_counter - (frames_are == REPEATED ? 1U : 0U));
    jp_message_from_sensors(frames, &sample_counter, &failing);
    for (int part = 0; part < JP_SAMPLE_PARTS; part++) {
        frames[part].data[3] ^= frames_are == CORRUPT ? 1U : 0U;
        frames[part].length = frames_are == SHORT ? 7U : frames[part].length;
        (void)jp_ecu_accept(&ecu, &frames[part]);
    }
}

/* What keeps a state up. */
static void operate(enum jp_skid_robot_state state)
{
    const bool drives = state == JP_SKID_ROBOT_DRIVING;
    struct jp_can_frame frame;

    if (operator_is == SILENT || (state != JP_SKID_ROBOT_STANDING && !drives) || failing_ticks % COMMAND_TICKS != 0U) {
        return;
    }
    frame = operator_command(++command_counter & 15U, drives ? JP_MODE_DRIVE : JP_MODE_STAND, drives ? 7U : 0U);
    frame.data[2] ^= operator_is == GARBLED ? 1U : 0U;
    (void)jp_ecu_accept(&ecu, &frame);
}

static void tick_failing(void (*inject)(void))
{
    make_failing(inject);
    if (transport == CAN && !is_silent) {
        send_failing();
    }
    jp_ecu_tick(&ecu);
    jp_ecu_work(&ecu);
}

/* ---- States ---- */

static void begin_on(int chosen)
{
    transport = chosen;
    is_failing = false;
    is_silent = false;
    written = JP_OK;
    frames_are = SOUND;
    operator_is = OBEYED;
    failing_ticks = 0;
    setUp();
    boot();
}

static void fail(void)
{
    make_standing();
    sensors.bus_voltage = 0;
    run(config.monitor.confirm_ticks);
    sensors.bus_voltage = JP_Q16(46);
    run(1);
}

static void reach(enum jp_skid_robot_state state)
{
    static void (*const ways[STATES])(void) = {NULL, make_standing, make_driving, fail};

    run(2U * JP_SKID_WAKE_TICKS);
    if (ways[state] != NULL) {
        begin_on(transport);
        ways[state]();
    }
    TEST_ASSERT_EQUAL_INT(state, jp_skid_robot_state_now(&skid.robot));
}

/* ---- The matrix ---- */

struct end {
    enum jp_skid_robot_state state;
    uint16_t faults;
};

struct row {
    const char *fault;
    void (*inject)(void);
    unsigned on;          /* which transports */
    unsigned ticks;       /* until its motion ends, on the board */
    unsigned more_on_can; /* frames that come late are waited for */
    struct end ends[STATES];
};

/* Of a reset: what was driven ends in a stand; a fault is over. */
#define AFTER_RESET                                                                                                    \
    {                                                                                                                  \
        {JP_SKID_ROBOT_IDLE, 0}, {JP_SKID_ROBOT_STANDING, 0}, {JP_SKID_ROBOT_STANDING, 0},                             \
        {                                                                                                              \
            JP_SKID_ROBOT_IDLE, 0                                                                                      \
        }                                                                                                              \
    }

/* Of one that ends every motion; faults add up. */
#define STOPS(bits)                                                                                                    \
    {                                                                                                                  \
        {JP_SKID_ROBOT_FAULT, bits}, {JP_SKID_ROBOT_FAULT, bits}, {JP_SKID_ROBOT_FAULT, bits},                         \
        {                                                                                                              \
            JP_SKID_ROBOT_FAULT, (bits) | JP_FAULT_BUS_VOLTAGE                                                         \
        }                                                                                                              \
    }

/* Of one that shows in wheels that are controlled. */
#define IN_WHEELS(bits)                                                                                                \
    {                                                                                                                  \
        {JP_SKID_ROBOT_IDLE, 0}, {JP_SKID_ROBOT_FAULT, bits}, {JP_SKID_ROBOT_FAULT, bits}, FAULT_STAYS                 \
    }

/* Of one that shows in motion only. */
#define IN_MOTION(bits)                                                                                                \
    {                                                                                                                  \
        {JP_SKID_ROBOT_IDLE, 0}, {JP_SKID_ROBOT_STANDING, 0}, {JP_SKID_ROBOT_FAULT, bits}, FAULT_STAYS                 \
    }

/* Of one that the robot rides out, driving in the state `driving`. */
#define RIDDEN_OUT(driving)                                                                                            \
    {                                                                                                                  \
        {JP_SKID_ROBOT_IDLE, 0}, {JP_SKID_ROBOT_STANDING, 0}, {driving, 0}, FAULT_STAYS                                \
    }

#define FAULT_STAYS                                                                                                    \
    {                                                                                                                  \
        JP_SKID_ROBOT_FAULT, JP_FAULT_BUS_VOLTAGE                                                                      \
    }

/* Times are those of the monitor's counts (every second tick of the wheels' ones) after what is smoothed has come, or
 * the wheels have reached their limit. */
static const struct row rows[] = {
    {"IMU_RANGE", leave_range, ON_BOTH, 3, 0, STOPS(JP_FAULT_IMU_RANGE | JP_FAULT_IMU_JUMP)},
    {"IMU_JUMP", jump, ON_BOTH, 3, 0, STOPS(JP_FAULT_IMU_JUMP)},
    {"IMU_FROZEN", freeze, ON_BOTH, 25, 0, STOPS(JP_FAULT_IMU_FROZEN)},
    {"ENCODER_JUMP", jump_encoder, ON_BOTH, 3, 0, STOPS(JP_FAULT_ENCODER_JUMP)},
    {"ENCODER_LEFT", contradict_left, ON_BOTH, 52, 0, IN_WHEELS(JP_FAULT_ENCODER_LEFT)},
    {"ENCODER_RIGHT", contradict_right, ON_BOTH, 52, 0, IN_WHEELS(JP_FAULT_ENCODER_RIGHT)},
    {"CURRENT_RANGE", leave_current_range, ON_BOTH, 3, 0, STOPS(JP_FAULT_CURRENT_RANGE)},
    {"BUS_VOLTAGE", lose_voltage, ON_BOTH, 3, 0, STOPS(JP_FAULT_BUS_VOLTAGE)},
    {"HARDWARE: no samples", fall_silent, ON_BOTH, 3, HOLD_TICKS, STOPS(JP_FAULT_HARDWARE)},
    {"HARDWARE: the bridges do not answer", refuse_writing, ON_BOARD, 4, 0, STOPS(JP_FAULT_HARDWARE)},
    {"HARDWARE: the bus takes no frames", refuse_frames, ON_CAN, 4, HOLD_TICKS, STOPS(JP_FAULT_HARDWARE)},
    {"OVERSPEED", run_away, ON_BOTH, 155, 0, IN_WHEELS(JP_FAULT_OVERSPEED)},
    {"STALLED_LEFT", stall_left, ON_BOTH, 620, 0, IN_MOTION(JP_FAULT_STALLED_LEFT)},
    {"STALLED_RIGHT", stall_right, ON_BOTH, 620, 0, IN_MOTION(JP_FAULT_STALLED_RIGHT)},
    {"WHEEL_IN_AIR", lift_left, ON_BOTH, 300, 0, IN_MOTION(JP_FAULT_WHEEL_IN_AIR)},
    {"WHEELS_SPIN", spin, ON_BOTH, 153, 0, IN_WHEELS(JP_FAULT_WHEELS_SPIN)},
    {"SLOPE", tilt, ON_BOTH, 230, 0, IN_WHEELS(JP_FAULT_SLOPE)},
    {"samples stay away for 40 ms", fall_silent_for_a_while, ON_CAN, 0, 0, RIDDEN_OUT(JP_SKID_ROBOT_DRIVING)},
    {"samples are corrupt", corrupt_samples, ON_CAN, 3, HOLD_TICKS, STOPS(JP_FAULT_HARDWARE)},
    {"samples are short", shorten_samples, ON_CAN, 3, HOLD_TICKS, STOPS(JP_FAULT_HARDWARE)},
    {"samples are repeated", repeat_samples, ON_CAN, 3, HOLD_TICKS, STOPS(JP_FAULT_HARDWARE)},
    {"another controller drives the bridges", conflict, ON_CAN, 0, 0, RIDDEN_OUT(JP_SKID_ROBOT_DRIVING)},
    {"the operator is silent", forget_operator, ON_BOTH, 0, 0, RIDDEN_OUT(JP_SKID_ROBOT_STANDING)},
    {"commands are corrupt", corrupt_commands, ON_BOTH, 0, 0, RIDDEN_OUT(JP_SKID_ROBOT_STANDING)},
    {"the controller is reset", reset_once, ON_BOTH, 0, 0, AFTER_RESET},
};

static bool is_moved(void)
{
    const enum jp_skid_robot_state state = jp_skid_robot_state_now(&skid.robot);

    return state == JP_SKID_ROBOT_STANDING || state == JP_SKID_ROBOT_DRIVING;
}

static void check_cell(const struct row *row, enum jp_skid_robot_state state)
{
    const struct matrix_cell cell = {"skid steer", transports[transport], row->fault, states[state]};
    char expected[MATRIX_TEXT];
    char seen[MATRIX_TEXT];
    unsigned ticks = 0;

    reach(state);
    const bool moved = is_moved();

    is_failing = true;
    for (unsigned i = 0; i < LONG_ENOUGH; i++) {
        tick_failing(row->inject);
        operate(state);
        ticks += is_moved() ? 1U : 0U;
    }
    matrix_describe(expected, states[row->ends[state].state], row->ends[state].faults);
    matrix_describe(seen, states[jp_skid_robot_state_now(&skid.robot)], faults());
    const bool ends = moved && row->ticks > 0U && row->ends[state].state == JP_SKID_ROBOT_FAULT;

    matrix_judge(&cell, expected, seen, ends ? ticks + 1U : 0U);
    if (ends) {
        TEST_ASSERT_LESS_OR_EQUAL_UINT(row->ticks + (transport == CAN ? row->more_on_can : 0U), ticks + 1U);
    }
}

/* What no test can do, and why. */
static void tell_impossible(void)
{
    const char *const other = transport == BOARD ? "no such frames: sensors and bridges are on the board"
                                                 : "no such call: the bridges are on the bus";

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        if ((rows[i].on >> transport & 1U) == 0U) {
            matrix_impossible("skid steer", transports[transport], rows[i].fault, other);
        }
    }
}

static void check_all(int chosen)
{
    transport = chosen;
    tell_impossible();
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        for (int state = 0; state < STATES; state++) {
            if ((rows[i].on >> chosen & 1U) != 0U) {
                begin_on(chosen);
                check_cell(&rows[i], (enum jp_skid_robot_state)state);
            }
        }
    }
}

static void test_on_its_board(void)
{
    check_all(BOARD);
}

static void test_on_can(void)
{
    check_all(CAN);
}
