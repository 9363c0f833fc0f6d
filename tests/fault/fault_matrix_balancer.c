/* Every fault of a balancer in every state, with sensors and bridges on its board and on CAN: where it ends, which
 * fault it reports, and after how many ticks the motors are off. The table below is the promise; tests/FAULTS.md shows
 * it. */
#include "tests/support/ecu_rig.h"
#include "tests/support/fault_matrix_ecu.h"

/* ---- What goes wrong in a tick: of `failing`, which is a good frame ---- */

static void freeze(void)
{
    config.monitor.freeze_ticks = jp_robot_courier24.monitor.freeze_ticks;
}

static void contradict_left(void)
{
    failing.current_left += 4 * config.monitor.current_residual;
}

static void contradict_right(void)
{
    failing.current_right += 4 * config.monitor.current_residual;
}

static void run_away(void)
{
    const uint32_t counts = config.monitor.encoder_jump - 1U;

    failing.encoder_left += counts * failing_ticks;
    failing.encoder_right += counts * failing_ticks;
}

/* ---- A tick ---- */

static void tick_failing(void (*inject)(void), int state)
{
    hold_wheels();
    give_failing(inject);
    tick();
    jp_ecu_work(&ecu);
    operate(state);
}

/* ---- States ---- */

static void wake(void)
{
    run(3);
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

static int state_now(void)
{
    return (int)jp_robot_state_now(&balancer.robot);
}

static uint16_t faults(void)
{
    return jp_robot_last_tick(&balancer.robot)->faults;
}

static const struct matrix_state states[] = {
    {"idle", wake}, {"balancing", make_balancing}, {"driving", make_driving}, {"fallen", fall}, {"fault", fail}};

/* ---- The matrix ---- */

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
static const struct matrix_row rows[] = {
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

static const struct matrix_robot robot = {.name = "balancer",
                                          .states = states,
                                          .state_count = JP_ROBOT_FAULT + 1,
                                          .rows = rows,
                                          .row_count = sizeof rows / sizeof rows[0],
                                          .ticks = 800,
                                          .begin = begin,
                                          .tick = tick_failing,
                                          .state = state_now,
                                          .faults = faults};

static void tell_wheels(int chosen)
{
    static const char *const found[] = {"STALLED_LEFT", "STALLED_RIGHT", "WHEEL_IN_AIR", "WHEELS_SPIN", "SLOPE"};

    for (size_t i = 0; i < sizeof found / sizeof found[0]; i++) {
        matrix_impossible(&robot, chosen, found[i], "found by robots that their sides steer only");
    }
}

static void test_on_its_board(void)
{
    tell_wheels(BOARD);
    check_ecu(&robot, BOARD);
}

static void test_on_can(void)
{
    tell_wheels(CAN);
    check_ecu(&robot, CAN);
}
