/** Where faults end, of a robot that stands by itself: it is idle, stands, drives, or has found a fault. */
#ifndef JOULEPATH_TESTS_SUPPORT_FAULT_MATRIX_ENDS_H
#define JOULEPATH_TESTS_SUPPORT_FAULT_MATRIX_ENDS_H

#include <joulepath/monitor.h>

#include "tests/support/fault_matrix.h"

enum { FAULT = DRIVING + 1, STATES };

#define FAULT_STAYS                                                                                                    \
    {                                                                                                                  \
        FAULT, JP_FAULT_BUS_VOLTAGE                                                                                    \
    }

/** Of one that ends every motion; faults add up. */
#define STOPS(bits)                                                                                                    \
    {                                                                                                                  \
        {FAULT, bits}, {FAULT, bits}, {FAULT, bits},                                                                   \
        {                                                                                                              \
            FAULT, (bits) | JP_FAULT_BUS_VOLTAGE                                                                       \
        }                                                                                                              \
    }

/** Of one that shows in motion only. */
#define IN_MOTION(bits)                                                                                                \
    {                                                                                                                  \
        {IDLE, 0}, {STANDING, 0}, {FAULT, bits}, FAULT_STAYS                                                           \
    }

/** Of one that the robot rides out, driving in the state `driving`. */
#define RIDDEN_OUT(driving)                                                                                            \
    {                                                                                                                  \
        {IDLE, 0}, {STANDING, 0}, {driving, 0}, FAULT_STAYS                                                            \
    }

/** Of a reset: what was driven ends in a stand; a fault is over. */
#define AFTER_RESET                                                                                                    \
    {                                                                                                                  \
        {IDLE, 0}, {STANDING, 0}, {STANDING, 0},                                                                       \
        {                                                                                                              \
            IDLE, 0                                                                                                    \
        }                                                                                                              \
    }

#endif
