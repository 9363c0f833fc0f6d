#include "sim/missions/navigation_task.h"

const char *navigation_state_name(enum jp_navigator_state state)
{
    static const char *const names[] = {"idle",    "planning", "proving", "joining",     "turning",
                                        "driving", "braking",  "arrived", "unreachable", "failed"};
    return names[state];
}

const char *navigation_reason_name(enum jp_navigator_reason reason)
{
    static const char *const names[] = {"-",         "told to stop", "blocked ahead",   "astray",        "hemmed in",
                                        "no memory", "no room",      "course too long", "robot gave up", "motors off"};
    return names[reason];
}
