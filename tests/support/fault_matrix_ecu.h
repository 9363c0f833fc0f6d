/** What goes wrong with a controller whose sensors and bridges are on its board or on CAN. It is that of ecu_rig.h or
 * ecu_skid_rig.h: one of them comes before. */
#ifndef JOULEPATH_TESTS_SUPPORT_FAULT_MATRIX_ECU_H
#define JOULEPATH_TESTS_SUPPORT_FAULT_MATRIX_ECU_H

#include "tests/support/fault_matrix.h"

static struct jp_sensors failing;
static enum jp_status written;

/* ---- The board ---- */

static inline enum jp_status read_board(void *context, struct jp_sensors *frame)
{
    (void)context;
    *frame = failing_ticks > 0U ? failing : sensors;
    return is_silent ? JP_ERR_HARDWARE : JP_OK;
}

static inline enum jp_status write_board(void *context, const struct jp_actuation *actuation)
{
    (void)context;
    bus.actuation = *actuation;
    return written;
}

static const struct jp_hal hal = {NULL, read_board, write_board};

/* ---- What goes wrong in a tick: of `failing`, which is a good frame ---- */

static inline void leave_range(void)
{
    failing.pitch_rate = config.monitor.gyro_limit + JP_Q24(0.01);
}

static inline void jump(void)
{
    failing.yaw_rate += config.monitor.gyro_jump + JP_Q24(0.01);
}

static inline void jump_encoder(void)
{
    failing.encoder_right += config.monitor.encoder_jump + 10U;
}

static inline void leave_current_range(void)
{
    failing.current_left = config.monitor.current_limit + JP_Q16(0.1);
}

static inline void lose_voltage(void)
{
    failing.bus_voltage = config.monitor.voltage_min - JP_Q16(1);
}

static inline void refuse_writing(void)
{
    written = JP_ERR_HARDWARE;
}

static inline void refuse_frames(void)
{
    bus.answer = JP_ERR_BUSY;
}

static inline unsigned ticks_in(unsigned milliseconds)
{
    return milliseconds * jp_ecu_tick_rate(&ecu) / 1000U;
}

static inline void fall_silent_for_a_while(void)
{
    is_silent = failing_ticks <= ticks_in(JP_SAMPLE_HOLD_MS);
}

static inline void conflict(void)
{
    const struct jp_can_frame frame = {.id = JP_CAN_MOTOR_COMMAND_FRAME_ID, .length = 8};

    (void)jp_ecu_accept(&ecu, &frame);
}

static inline void corrupt_commands(void)
{
    operator_is = GARBLED;
}

static inline void boot(void)
{
    bus.commands = 0;
    bus.receiver = (struct jp_e2e_receiver){.synchronised = false};
    init();
    if (transport == BOARD) {
        jp_ecu_use_board(&ecu, &hal);
    }
}

static inline void reset_once(void)
{
    if (failing_ticks == 1U) {
        boot();
    }
}

/* ---- A tick ---- */

static inline void send_failing(void)
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

/** The frame of this tick: that of `sensors`, spoilt. */
static inline void give_failing(void (*inject)(void))
{
    failing = sensors;
    failing_ticks++;
    inject();
    if (transport == CAN && !is_silent) {
        send_failing();
    }
}

/** What keeps a state up. */
static inline void operate(int state)
{
    const bool drives = state == DRIVING;
    struct jp_can_frame frame;

    if (operator_is == SILENT || !matrix_is_controlled(state) || failing_ticks % ticks_in(100) != 0U) {
        return;
    }
    frame = operator_command(++command_counter & 15U, drives ? JP_MODE_DRIVE : JP_MODE_STAND, drives ? 7U : 0U);
    frame.data[2] ^= operator_is == GARBLED ? 1U : 0U;
    (void)jp_ecu_accept(&ecu, &frame);
}

/* ---- The matrix ---- */

static inline void begin(void)
{
    written = JP_OK;
    setUp();
    boot();
}

/** What no test can do, and why. */
static inline void tell_impossible(const struct matrix_robot *robot, int chosen)
{
    const char *const other = chosen == BOARD ? "no such frames: sensors and bridges are on the board"
                                              : "no such call: the bridges are on the bus";

    for (size_t i = 0; i < robot->row_count; i++) {
        if (!matrix_is_on(&robot->rows[i], chosen)) {
            matrix_impossible(robot, chosen, robot->rows[i].fault, other);
        }
    }
}

static inline void check_ecu(const struct matrix_robot *robot, int chosen)
{
    tell_impossible(robot, chosen);
    matrix_check(robot, chosen);
}

#endif
