/** The command line of programs that go from a place to another on a map: options that are common, the map, the two
 *  places, and the planner's memory. */
#ifndef JOULEPATH_SIM_MISSIONS_PLAN_ARGUMENTS_H
#define JOULEPATH_SIM_MISSIONS_PLAN_ARGUMENTS_H

#include "sim/base/command_line.h"
#include "sim/missions/plan_task.h"

enum {
    PLAN_OPTION_START = COMMAND_LINE_OWN,
    PLAN_OPTION_GOAL,
    PLAN_OPTION_MEMORY,
    PLAN_OPTION_OWN /**< the first key of a program's own options without a letter */
};

#define PLAN_OPTION_PLACES                                                                                              \
    {                                                                                                                   \
        "start", PLAN_OPTION_START, "X,Y,DEG", 0, "m in the map's frame; the nearest of 16 headings (default: chosen)", \
        0},                                                                                                             \
    {                                                                                                                   \
        "goal", PLAN_OPTION_GOAL, "X,Y[,DEG]", 0, "likewise; any heading unless one is given (default: chosen)", 0      \
    }
#define PLAN_OPTION_BLOCK(comment)                                                                                     \
    {                                                                                                                  \
        "memory", PLAN_OPTION_MEMORY, "KIB", 0, "the planner's block" comment, 0                                       \
    }

struct plan_arguments {
    struct command_line common;
    const char *map_path;
    struct plan_place start;
    struct plan_place goal;
    bool has_start;
    bool has_goal;
    size_t memory; /**< bytes */
};

/** Argp's parser into these arguments, which are the first member of a program's own. */
error_t plan_arguments_take(int key, char *argument, struct argp_state *state);

/** The places that were given, or chosen ones. False after one line on stderr. */
bool plan_arguments_task(const struct plan_arguments *arguments, const struct map_file *map,
                         const struct jp_lattice *lattice, struct plan_task *task);

#endif
