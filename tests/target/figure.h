/** A figure of a bench on an emulated microcontroller, as tools/measure/figures.py reads it. */
#ifndef TARGET_FIGURE_H
#define TARGET_FIGURE_H

#include "tests/target/target.h"

/** `bound` is the largest value allowed, a number; null: there is none. */
static inline void target_print_figure(const char *name, uint32_t value, const char *unit, const char *bound)
{
    target_print("{\"name\": \"" TARGET_CORE ": ");
    target_print(name);
    target_print("\", \"value\": ");
    target_print_number(value);
    target_print(", \"unit\": \"");
    target_print(unit);
    target_print("\", \"bound\": ");
    if (bound) {
        target_print("{\"op\": \"<=\", \"value\": ");
        target_print(bound);
        target_print("}");
    } else {
        target_print("null");
    }
    target_print(", \"command\": \"make figures\"}");
}

#endif
