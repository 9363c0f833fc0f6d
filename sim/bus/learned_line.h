/** What the ECU learned, in a line when it notices that robot or ground changed. */
#ifndef JOULEPATH_SIM_BUS_LEARNED_LINE_H
#define JOULEPATH_SIM_BUS_LEARNED_LINE_H

#include <jansson.h>

#include "sim/bus/ecu_node.h"

/** What was printed last; all zero at first but for `told`. */
struct learned_line {
    uint32_t changes;
    enum jp_cause cause;
    json_t *told; /**< array: an object for each line */
};

/** What a start found of stored parameters, after the name of their file. */
void learned_line_start(const struct ecu_node *node, const char *path);

/** Prints a line on stdout, and appends to `told`, if there is a new change or a cause of it: time (s), cause (none as
 * long as it is unknown), and of a balancer the friction and payload that its learner takes it for, with deviations. */
void learned_line_print(struct learned_line *last, const struct ecu_node *node);

#endif
