#include "src/navigate/navigator_state.h"

#include <joulepath/count.h>

#include "src/navigate/navigator_seen.h"

void jp_navigator_enter(struct jp_navigator *navigator, enum jp_navigator_state state, enum jp_navigator_reason reason)
{
    navigator->state = state;
    navigator->reason = reason;
    navigator->internal.was_told = false;
    navigator->internal.turns = 0;
}

void jp_navigator_fail(struct jp_navigator *navigator, enum jp_navigator_reason reason)
{
    jp_navigator_enter(navigator, JP_NAVIGATOR_FAILED, reason);
}

bool jp_navigator_accepts(struct jp_navigator *navigator, enum jp_status status)
{
    if (status != JP_OK) {
        navigator->status = status;
        navigator->config.vehicle->stop(navigator->config.vehicle->context);
        jp_navigator_fail(navigator, JP_NAVIGATOR_VEHICLE);
    }
    return status == JP_OK;
}

void jp_navigator_plan_anew(struct jp_navigator *navigator, enum jp_navigator_reason reason)
{
    navigator->replans = jp_one_more16(navigator->replans);
    jp_navigator_enter(navigator, JP_NAVIGATOR_PLANNING, reason);
}

void jp_navigator_give_up(struct jp_navigator *navigator, enum jp_navigator_state state,
                          enum jp_navigator_reason reason)
{
    if (!jp_seen_may_mislead(navigator)) {
        jp_navigator_enter(navigator, state, reason);
        return;
    }
    jp_seen_forget(navigator);
    jp_navigator_enter(navigator, JP_NAVIGATOR_PLANNING, navigator->reason);
    navigator->internal.was_told = true;
    navigator->internal.spent = 0;
    navigator->internal.search = JP_NAVIGATOR_LOOK_ROUND;
}

void jp_navigator_see_map(struct jp_navigator *navigator)
{
    navigator->internal.map_seen = jp_planner_terrain(navigator->config.planner)->version;
}

bool jp_navigator_has_map_changed(const struct jp_navigator *navigator)
{
    return navigator->internal.map_seen != jp_planner_terrain(navigator->config.planner)->version;
}

bool jp_navigator_has_course(const struct jp_navigator *navigator)
{
    return navigator->state == JP_NAVIGATOR_TURNING || navigator->state == JP_NAVIGATOR_DRIVING;
}
