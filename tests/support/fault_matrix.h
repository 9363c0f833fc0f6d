/** The matrix of faults (tests/FAULTS.md): every fault of a robot's table in each of its states, on a transport. Cells
 * go, as lines of JSON, to the file that the environment names in FAULT_CELLS: tools/measure/fault_matrix.py reads
 * them. */
#ifndef JOULEPATH_TESTS_SUPPORT_FAULT_MATRIX_H
#define JOULEPATH_TESTS_SUPPORT_FAULT_MATRIX_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

enum { BOARD, CAN, TRANSPORTS };
enum { MATRIX_TEXT = 160, MATRIX_STATES = 5 };

#define ON_BOARD 1U
#define ON_CAN   2U
#define ON_BOTH  3U

/** The first states of each robot; in its last it has found a fault. */
enum { IDLE, STANDING, DRIVING };

struct matrix_state {
    const char *name;
    void (*reach)(void); /**< by a robot that begins */
};

struct matrix_end {
    int state;
    uint16_t faults;
};

/** A fault, and what is promised of it. */
struct matrix_row {
    const char *fault;
    void (*inject)(void);                  /**< in each tick */
    unsigned on;                           /**< which transports */
    unsigned ticks;                        /**< until the motors are off or brake, on the board; 0: it stops nothing */
    unsigned more_on_can;                  /**< frames that come late are waited for */
    struct matrix_end ends[MATRIX_STATES]; /**< of each state */
};

struct matrix_robot {
    const char *name;
    const struct matrix_state *states; /**< in the order of its enum */
    int state_count;
    const struct matrix_row *rows;
    size_t row_count;
    unsigned ticks; /**< in which each fault has ended */
    void (*begin)(void);
    void (*tick)(void (*inject)(void), int state); /**< with what keeps `state` up */
    int (*state)(void);
    uint16_t (*faults)(void);
};

static const char *const matrix_transports[TRANSPORTS] = {"board", "CAN"};

/* ---- What goes wrong with any robot ---- */

static int transport;
static unsigned failing_ticks;
static bool is_silent; /* no samples come, or the board does not answer */
static enum { SOUND, CORRUPT, SHORT, REPEATED } frames_are;
static enum { OBEYED, SILENT, GARBLED } operator_is;

static inline void fall_silent(void)
{
    is_silent = true;
}

static inline void corrupt_samples(void)
{
    frames_are = CORRUPT;
}

static inline void shorten_samples(void)
{
    frames_are = SHORT;
}

static inline void repeat_samples(void)
{
    frames_are = REPEATED;
}

static inline void forget_operator(void)
{
    operator_is = SILENT;
}

/* ---- Cells ---- */

/** Where a cell is. */
struct matrix_cell {
    const char *robot;
    const char *transport;
    const char *fault;
    const char *state;
};

/** Of words of faults, in the order of their bits. */
static const char *const matrix_faults[] = {
    "IMU_RANGE",     "IMU_JUMP",      "IMU_FROZEN",   "ENCODER_JUMP", "ENCODER_LEFT",
    "ENCODER_RIGHT", "CURRENT_RANGE", "BUS_VOLTAGE",  "HARDWARE",     "OVERSPEED",
    "STALLED_LEFT",  "STALLED_RIGHT", "WHEEL_IN_AIR", "WHEELS_SPIN",  "SLOPE",
};

/** "state: FAULT and FAULT". */
static inline void matrix_describe(char text[MATRIX_TEXT], const char *state, uint16_t faults)
{
    const char *before = ": ";
    int used = snprintf(text, MATRIX_TEXT, "%s", state);

    for (unsigned i = 0; i < sizeof matrix_faults / sizeof matrix_faults[0]; i++) {
        if (((unsigned)faults >> i & 1U) != 0U) {
            used += snprintf(&text[(size_t)used], (size_t)(MATRIX_TEXT - used), "%s%s", before, matrix_faults[i]);
            before = " and ";
        }
    }
}

/** One more cell, as in printf, if anybody collects them. */
static inline void matrix_tell(const char *format, ...)
{
    const char *path = getenv("FAULT_CELLS");
    FILE *cells = path == NULL ? NULL : fopen(path, "a");
    va_list arguments;

    TEST_ASSERT_TRUE_MESSAGE(path == NULL || cells != NULL, "FAULT_CELLS cannot be written");
    if (cells != NULL) {
        va_start(arguments, format);
        (void)vfprintf(cells, format, arguments);
        va_end(arguments);
        (void)fclose(cells);
    }
}

/** What was seen must be what is expected. `ticks`: from the fault until the motors were off or braked; 0: they stayed
 * as they were. */
static inline void matrix_judge(const struct matrix_cell *cell, const char *expected, const char *seen, unsigned ticks)
{
    char where[MATRIX_TEXT];

    matrix_tell("{\"robot\": \"%s\", \"transport\": \"%s\", \"fault\": \"%s\", \"state\": \"%s\", "
                "\"expected\": \"%s\", \"seen\": \"%s\", \"ticks\": %u}\n",
                cell->robot, cell->transport, cell->fault, cell->state, expected, seen, ticks);
    (void)snprintf(where, sizeof where, "%s, %s, %s", cell->transport, cell->fault, cell->state);
    TEST_ASSERT_EQUAL_STRING_MESSAGE(expected, seen, where);
}

/** In no state of that transport. */
static inline void matrix_impossible(const struct matrix_robot *robot, int chosen, const char *fault,
                                     const char *reason)
{
    matrix_tell("{\"robot\": \"%s\", \"transport\": \"%s\", \"fault\": \"%s\", \"impossible\": \"%s\"}\n", robot->name,
                matrix_transports[chosen], fault, reason);
}

static inline void matrix_begin(const struct matrix_robot *robot)
{
    failing_ticks = 0;
    is_silent = false;
    frames_are = SOUND;
    operator_is = OBEYED;
    robot->begin();
}

static inline bool matrix_is_controlled(int state)
{
    return state == STANDING || state == DRIVING;
}

static inline void matrix_check_cell(const struct matrix_robot *robot, const struct matrix_row *row, int state)
{
    const struct matrix_cell cell = {robot->name, matrix_transports[transport], row->fault, robot->states[state].name};
    const struct matrix_end *end = &row->ends[state];
    const bool stops = matrix_is_controlled(state) && row->ticks > 0U && end->state == robot->state_count - 1;
    char expected[MATRIX_TEXT];
    char seen[MATRIX_TEXT];
    unsigned ticks = 1;

    robot->states[state].reach();
    TEST_ASSERT_EQUAL_INT(state, robot->state());
    for (unsigned i = 0; i < robot->ticks; i++) {
        robot->tick(row->inject, state);
        ticks += matrix_is_controlled(robot->state()) ? 1U : 0U;
    }
    matrix_describe(expected, robot->states[end->state].name, end->faults);
    matrix_describe(seen, robot->states[robot->state()].name, robot->faults());
    matrix_judge(&cell, expected, seen, stops ? ticks : 0U);
    if (stops) {
        TEST_ASSERT_LESS_OR_EQUAL_UINT(row->ticks + (transport == CAN ? row->more_on_can : 0U), ticks);
    }
}

static inline bool matrix_is_on(const struct matrix_row *row, int chosen)
{
    return (row->on >> chosen & 1U) != 0U;
}

/** Each fault of that transport in each state. */
static inline void matrix_check(const struct matrix_robot *robot, int chosen)
{
    transport = chosen;
    for (size_t i = 0; i < robot->row_count; i++) {
        for (int state = 0; state < robot->state_count && matrix_is_on(&robot->rows[i], chosen); state++) {
            matrix_begin(robot);
            matrix_check_cell(robot, &robot->rows[i], state);
        }
    }
}

#endif
