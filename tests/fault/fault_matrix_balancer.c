/* Every fault of a balancer in every state, with sensors and bridges on its board and on CAN: where it ends, which
 * fault it reports, and after how many ticks the motors are off. The table below is the promise; tests/FAULTS.md shows
 * it. */
#include "tests/support/ecu_rig.h"
#include "tests/support/fault_matrix.h"

enum { BOARD, CAN, TRANSPORTS };
enum { STATES = JP_ROBOT_FAULT + 1, LONG_ENOUGH = 800, COMMAND_TICKS = 100 };

#define ON_BOARD 1U
#define ON_CAN   2U
#define ON_BOTH  3U

static const char *const transports[TRANSPORTS] = {"board", "CAN"};
static const char *const states[STATES] = {"idle", "balancing", "driving", "fallen", "fault"};

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
    config.monitor.freeze_ticks = jp_robot_courier24.monitor.freeze_ticks;
}

static void jump_encoder(void)
{
    failing.encoder_right += config.monitor.encoder_jump + 10U;
}

static void contradict_left(void)
{
    failing.current_left += 4 * config.monitor.current_residual;
}

static void contradict_right(void)
{
    failing.current_right += 4 * config.monitor.current_residual;
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
    is_silent = failing_ticks <= JP_SAMPLE_HOLD_MS;
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

static void run_away(void)
{
    const uint32_t counts = config.monitor.encoder_jump - 1U;

    failing.encoder_left += counts * failing_ticks;
    failing.encoder_right += counts * failing_ticks;
}

/* ---- A tick ---- */

static void make_failing(void (*inject)(void))
{
    const struct jp_voltages *voltages = &jp_robot_last_tick(&balancer.robot)->voltages;

    sensors.current_left = jp_q16_divide(voltages->left, config.monitor.motor_resistance);
    sensors.current_right = jp_q16_divide(voltages->right, config.monitor.motor_resistance);
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
static void operate(enum jp_robot_state state)
{
    const bool drives = state == JP_ROBOT_DRIVING;
    struct jp_can_frame frame;

    if (operator_is == SILENT || (state != JP_ROBOT_BALANCING && !drives) || failing_ticks % COMMAND_TICKS != 0U) {
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
    tick();
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

static void fall(void)
{
    make_balancing();
    for (int i = 0; i < 1000 && jp_robot_state_now(&balancer.robot) != JP_ROBOT_FALLEN; i++) {
        sensors.pitch_rate += i < 8 ? config.monitor.gyro_jump / 2 : 0;
        run(1);
    }
    while (sensors.pitch_rate > 0) {
        sensors.pitch_rate -= config.monitor.gyro_jump / 2;
        run(1);
    }
}

static void fail(void)
{
    make_balancing();
    sensors.bus_voltage = 0;
    run(config.monitor.confirm_ticks);
    sensors.bus_voltage = JP_Q16(24);
    run(1);
}

static void reach(enum jp_robot_state state)
{
    static void (*const ways[STATES])(void) = {NULL, make_balancing, make_driving, fall, fail};

    run(3);
    if (ways[state] != NULL) {
        begin_on(transport);
        ways[state]();
    }
    TEST_ASSERT_EQUAL_INT(state, jp_robot_state_now(&balancer.robot));
}

/* ---- The matrix ---- */

struct end {
    enum jp_robot_state state;
    uint16_t faults;
};

struct row {
    const char *fault;
    void (*inject)(void);
    unsigned on;          /* which transports */
    unsigned ticks;       /* until the motors are off, on the board */
    unsigned more_on_can; /* frames that come late are waited for */
    struct end ends[STATES];
};

/* Of a reset: what was driven ends in a balanced stand; a fall and a fault are found anew or over. */
#define AFTER_RESET                                                                                                    \
    {                                                                                                                  \
        {JP_ROBOT_IDLE, 0}, {JP_ROBOT_BALANCING, 0}, {JP_ROBOT_BALANCING, 0}, {JP_ROBOT_IDLE, 0},                      \
        {                                                                                                              \
            JP_ROBOT_IDLE, 0                                                                                           \
        }                                                                                                              \
    }

/* Of one that switches the motors off; the first fault of a state without them stays. */
#define SWITCHES_OFF(bits)                                                                                             \
    {                                                                                                                  \
        {JP_ROBOT_FAULT, bits}, {JP_ROBOT_FAULT, bits}, {JP_ROBOT_FAULT, bits}, {JP_ROBOT_FALLEN, 0}, FAULT_STAYS      \
    }

/* Of one that shows in motors that run. */
#define IN_MOTORS(bits)                                                                                                \
    {                                                                                                                  \
        {JP_ROBOT_IDLE, 0}, {JP_ROBOT_FAULT, bits}, {JP_ROBOT_FAULT, bits}, {JP_ROBOT_FALLEN, 0}, FAULT_STAYS          \
    }

/* Of one that the robot rides out, driving in the state `driving`. */
#define RIDDEN_OUT(driving)                                                                                            \
    {                                                                                                                  \
        {JP_ROBOT_IDLE, 0}, {JP_ROBOT_BALANCING, 0}, {driving, 0}, {JP_ROBOT_FALLEN, 0}, FAULT_STAYS                   \
    }

#define FAULT_STAYS                                                                                                    \
    {                                                                                                                  \
        JP_ROBOT_FAULT, JP_FAULT_BUS_VOLTAGE                                                                           \
    }

/* Motors are off after `confirm_ticks`, `freeze_ticks`, or `residual_ticks` and one; what a write missed shows in the
 * tick after it; a rate is known four ticks late. */
static const struct row rows[] = {
    {"IMU_RANGE", leave_range, ON_BOTH, 3, 0, SWITCHES_OFF(JP_FAULT_IMU_RANGE | JP_FAULT_IMU_JUMP)},
    {"IMU_JUMP", jump, ON_BOTH, 3, 0, SWITCHES_OFF(JP_FAULT_IMU_JUMP)},
    {"IMU_FROZEN", freeze, ON_BOTH, 50, 0, SWITCHES_OFF(JP_FAULT_IMU_FROZEN)},
    {"ENCODER_JUMP", jump_encoder, ON_BOTH, 3, 0, SWITCHES_OFF(JP_FAULT_ENCODER_JUMP)},
    {"ENCODER_LEFT", contradict_left, ON_BOTH, 51, 0, IN_MOTORS(JP_FAULT_ENCODER_LEFT)},
    {"ENCODER_RIGHT", contradict_right, ON_BOTH, 51, 0, IN_MOTORS(JP_FAULT_ENCODER_RIGHT)},
    {"CURRENT_RANGE", leave_current_range, ON_BOTH, 3, 0, SWITCHES_OFF(JP_FAULT_CURRENT_RANGE)},
    {"BUS_VOLTAGE", lose_voltage, ON_BOTH, 3, 0, SWITCHES_OFF(JP_FAULT_BUS_VOLTAGE)},
    {"HARDWARE: no samples", fall_silent, ON_BOTH, 3, JP_SAMPLE_HOLD_MS, SWITCHES_OFF(JP_FAULT_HARDWARE)},
    {"HARDWARE: the bridges do not answer", refuse_writing, ON_BOARD, 4, 0, SWITCHES_OFF(JP_FAULT_HARDWARE)},
    {"HARDWARE: the bus takes no frames", refuse_frames, ON_CAN, 4, JP_SAMPLE_HOLD_MS, SWITCHES_OFF(JP_FAULT_HARDWARE)},
    {"OVERSPEED", run_away, ON_BOTH, 7, 0, IN_MOTORS(JP_FAULT_OVERSPEED)},
    {"samples stay away for 40 ms", fall_silent_for_a_while, ON_CAN, 0, 0, RIDDEN_OUT(JP_ROBOT_DRIVING)},
    {"samples are corrupt", corrupt_samples, ON_CAN, 3, JP_SAMPLE_HOLD_MS, SWITCHES_OFF(JP_FAULT_HARDWARE)},
    {"samples are short", shorten_samples, ON_CAN, 3, JP_SAMPLE_HOLD_MS, SWITCHES_OFF(JP_FAULT_HARDWARE)},
    {"samples are repeated", repeat_samples, ON_CAN, 3, JP_SAMPLE_HOLD_MS, SWITCHES_OFF(JP_FAULT_HARDWARE)},
    {"another controller drives the bridges", conflict, ON_CAN, 0, 0, RIDDEN_OUT(JP_ROBOT_DRIVING)},
    {"the operator is silent", forget_operator, ON_BOTH, 0, 0, RIDDEN_OUT(JP_ROBOT_BALANCING)},
    {"commands are corrupt", corrupt_commands, ON_BOTH, 0, 0, RIDDEN_OUT(JP_ROBOT_BALANCING)},
    {"the controller is reset", reset_once, ON_BOTH, 0, 0, AFTER_RESET},
};

static bool motors_run(void)
{
    const enum jp_robot_state state = jp_robot_state_now(&balancer.robot);

    return state == JP_ROBOT_BALANCING || state == JP_ROBOT_DRIVING;
}

static void check_cell(const struct row *row, enum jp_robot_state state)
{
    const struct matrix_cell cell = {"balancer", transports[transport], row->fault, states[state]};
    char expected[MATRIX_TEXT];
    char seen[MATRIX_TEXT];
    unsigned ticks = 0;

    reach(state);
    const bool ran = motors_run();

    is_failing = true;
    for (unsigned i = 0; i < LONG_ENOUGH; i++) {
        tick_failing(row->inject);
        operate(state);
        ticks += motors_run() ? 1U : 0U;
    }
    matrix_describe(expected, states[row->ends[state].state], row->ends[state].faults);
    matrix_describe(seen, states[jp_robot_state_now(&balancer.robot)], jp_robot_last_tick(&balancer.robot)->faults);
    const bool ends = ran && row->ticks > 0U && row->ends[state].state == JP_ROBOT_FAULT;

    matrix_judge(&cell, expected, seen, ends ? ticks + 1U : 0U);
    if (ends) {
        TEST_ASSERT_LESS_OR_EQUAL_UINT(row->ticks + (transport == CAN ? row->more_on_can : 0U), ticks + 1U);
    }
}

/* What no test can do, and why. */
static void tell_impossible(void)
{
    static const char *const wheels[] = {"STALLED_LEFT", "STALLED_RIGHT", "WHEEL_IN_AIR", "WHEELS_SPIN", "SLOPE"};
    const char *const other = transport == BOARD ? "no such frames: sensors and bridges are on the board"
                                                 : "no such call: the bridges are on the bus";

    for (size_t i = 0; i < sizeof wheels / sizeof wheels[0]; i++) {
        matrix_impossible("balancer", transports[transport], wheels[i], "found by robots that their sides steer only");
    }
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        if ((rows[i].on >> transport & 1U) == 0U) {
            matrix_impossible("balancer", transports[transport], rows[i].fault, other);
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
                check_cell(&rows[i], (enum jp_robot_state)state);
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
