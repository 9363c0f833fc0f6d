/* Every fault of a robot that its sides steer in every state, with sensors and bridges on its board and on CAN: where
 * it ends, which fault it reports, and after how many ticks. The table below is the promise; tests/FAULTS.md shows it.
 */
#include "tests/support/ecu_skid_rig.h"
#include "tests/support/fault_matrix_ecu.h"
#include "tests/support/fault_matrix_ends.h"

/* ---- What goes wrong in a tick: of `failing`, which is a good frame ---- */

static void freeze(void)
{
    config.monitor.freeze_ticks = jp_skid_robot_zhang2018.monitor.freeze_ticks;
}

static void contradict_left(void)
{
    failing.current_left += 5 * (config.monitor.current_residual / 4);
}

static void contradict_right(void)
{
    failing.current_right += 5 * (config.monitor.current_residual / 4);
}

/* The sensors show no more current than they can. */
static void limit_currents(void)
{
    const jp_q16 most = config.monitor.current_limit - JP_Q16(0.1);

    failing.current_left = jp_clamp32(failing.current_left, -most, most);
    failing.current_right = jp_clamp32(failing.current_right, -most, most);
}

/* Wheels that seem to stand are given more and more. */
static void jump_and_pull(void)
{
    jump_encoder();
    limit_currents();
}

/* Downhill, faster and faster. */
static void run_away(void)
{
    rolling = jp_clamp32((int32_t)failing_ticks * JP_Q24(0.01), 0, config.monitor.wheel_rate_limit + JP_Q24(0.05));
    limit_currents();
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

static void tick_failing(void (*inject)(void), int state)
{
    move();
    give_failing(inject);
    jp_ecu_tick(&ecu);
    jp_ecu_work(&ecu);
    operate(state);
}

/* ---- States ---- */

static void wake(void)
{
    run(2U * JP_SKID_WAKE_TICKS);
}

static void fail(void)
{
    make_standing();
    sensors.bus_voltage = 0;
    run(config.monitor.confirm_ticks);
    sensors.bus_voltage = JP_Q16(46);
    run(1);
}

static int state_now(void)
{
    return (int)jp_skid_robot_state_now(&skid.robot);
}

static const struct matrix_state states[STATES] = {
    {"idle", wake}, {"standing", make_standing}, {"driving", make_driving}, {"fault", fail}};

/* ---- The matrix ---- */

/* Of one that shows in wheels that are controlled. */
#define IN_WHEELS(bits)                                                                                                \
    {                                                                                                                  \
        {IDLE, 0}, {FAULT, bits}, {FAULT, bits}, FAULT_STAYS                                                           \
    }

/* A side that stalls takes its greatest current at once here, and is found 250 ticks later. Other times are those of
 * the monitor's counts (every second tick of the wheels' ones) after what is smoothed has come, or the wheels have
 * reached their limit; a side in the air is free once the current of before has faded to a quarter of the load, so a
 * load that was 4 % higher is 2 ticks later, and one of a robot that slows down before 32. */
static const struct matrix_row rows[] = {
    {"IMU_RANGE", leave_range, ON_BOTH, 3, 0, STOPS(JP_FAULT_IMU_RANGE | JP_FAULT_IMU_JUMP)},
    {"IMU_JUMP", jump, ON_BOTH, 3, 0, STOPS(JP_FAULT_IMU_JUMP)},
    {"IMU_FROZEN", freeze, ON_BOTH, 25, 0, STOPS(JP_FAULT_IMU_FROZEN)},
    {"ENCODER_JUMP", jump_and_pull, ON_BOTH, 3, 0, STOPS(JP_FAULT_ENCODER_JUMP)},
    {"ENCODER_LEFT", contradict_left, ON_BOTH, 52, 0, IN_WHEELS(JP_FAULT_ENCODER_LEFT)},
    {"ENCODER_RIGHT", contradict_right, ON_BOTH, 52, 0, IN_WHEELS(JP_FAULT_ENCODER_RIGHT)},
    {"CURRENT_RANGE", leave_current_range, ON_BOTH, 3, 0, STOPS(JP_FAULT_CURRENT_RANGE)},
    {"BUS_VOLTAGE", lose_voltage, ON_BOTH, 3, 0, STOPS(JP_FAULT_BUS_VOLTAGE)},
    {"HARDWARE: no samples", fall_silent, ON_BOTH, 3, HOLD_TICKS, STOPS(JP_FAULT_HARDWARE)},
    {"HARDWARE: the bridges do not answer", refuse_writing, ON_BOARD, 4, 0, STOPS(JP_FAULT_HARDWARE)},
    {"HARDWARE: the bus takes no frames", refuse_frames, ON_CAN, 4, HOLD_TICKS, STOPS(JP_FAULT_HARDWARE)},
    {"OVERSPEED", run_away, ON_BOTH, 155, 0, IN_WHEELS(JP_FAULT_OVERSPEED)},
    {"STALLED_LEFT", stall_left, ON_BOTH, 255, 0, IN_MOTION(JP_FAULT_STALLED_LEFT)},
    {"STALLED_RIGHT", stall_right, ON_BOTH, 255, 0, IN_MOTION(JP_FAULT_STALLED_RIGHT)},
    {"WHEEL_IN_AIR", lift_left, ON_BOTH, 340, 0, IN_MOTION(JP_FAULT_WHEEL_IN_AIR)},
    {"WHEELS_SPIN", spin, ON_BOTH, 153, 0, IN_WHEELS(JP_FAULT_WHEELS_SPIN)},
    {"SLOPE", tilt, ON_BOTH, 230, 0, IN_WHEELS(JP_FAULT_SLOPE)},
    {"samples stay away for 40 ms", fall_silent_for_a_while, ON_CAN, 0, 0, RIDDEN_OUT(DRIVING)},
    {"samples are corrupt", corrupt_samples, ON_CAN, 3, HOLD_TICKS, STOPS(JP_FAULT_HARDWARE)},
    {"samples are short", shorten_samples, ON_CAN, 3, HOLD_TICKS, STOPS(JP_FAULT_HARDWARE)},
    {"samples are repeated", repeat_samples, ON_CAN, 3, HOLD_TICKS, STOPS(JP_FAULT_HARDWARE)},
    {"another controller drives the bridges", conflict, ON_CAN, 0, 0, RIDDEN_OUT(DRIVING)},
    {"the operator is silent", forget_operator, ON_BOTH, 0, 0, RIDDEN_OUT(STANDING)},
    {"commands are corrupt", corrupt_commands, ON_BOTH, 0, 0, RIDDEN_OUT(STANDING)},
    {"the controller is reset", reset_once, ON_BOTH, 0, 0, AFTER_RESET},
};

static const struct matrix_robot robot = {.name = "skid steer",
                                          .states = states,
                                          .state_count = STATES,
                                          .rows = rows,
                                          .row_count = sizeof rows / sizeof rows[0],
                                          .ticks = 1500,
                                          .begin = begin,
                                          .tick = tick_failing,
                                          .state = state_now,
                                          .faults = faults};

static void test_on_its_board(void)
{
    check_ecu(&robot, BOARD);
}

static void test_on_can(void)
{
    check_ecu(&robot, CAN);
}
