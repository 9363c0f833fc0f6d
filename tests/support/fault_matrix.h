/** The cells of the matrix of faults (tests/FAULTS.md): each printed as a line of JSON that
 * tools/measure/fault_matrix.py collects. */
#ifndef JOULEPATH_TESTS_SUPPORT_FAULT_MATRIX_H
#define JOULEPATH_TESTS_SUPPORT_FAULT_MATRIX_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

enum { MATRIX_TEXT = 160 };

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

/** What was seen must be what is expected. `ticks`: from the fault until the motors were off or braked; 0: they stayed
 * as they were. */
static inline void matrix_judge(const struct matrix_cell *cell, const char *expected, const char *seen, unsigned ticks)
{
    char where[MATRIX_TEXT];

    (void)printf("cell {\"robot\": \"%s\", \"transport\": \"%s\", \"fault\": \"%s\", \"state\": \"%s\", "
                 "\"expected\": \"%s\", \"seen\": \"%s\", \"ticks\": %u}\n",
                 cell->robot, cell->transport, cell->fault, cell->state, expected, seen, ticks);
    (void)snprintf(where, sizeof where, "%s, %s, %s", cell->transport, cell->fault, cell->state);
    TEST_ASSERT_EQUAL_STRING_MESSAGE(expected, seen, where);
}

/** In no state of that transport. */
static inline void matrix_impossible(const char *robot, const char *transport, const char *fault, const char *reason)
{
    (void)printf("cell {\"robot\": \"%s\", \"transport\": \"%s\", \"fault\": \"%s\", \"impossible\": \"%s\"}\n", robot,
                 transport, fault, reason);
}

#endif
