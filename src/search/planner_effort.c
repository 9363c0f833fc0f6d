#include "src/search/planner_effort.h"

#include "src/search/planner_route.h"
#include "src/search/planner_search.h"

/* A repair, or a splice, may take one part in so many of a new search before it is given up. */
enum { CHEAP_DIVISOR = 10 };

/** Most expansions at a time, so that the equivalent number of other units fits 32 bits. */
#define SLICE_MAX 0x100000U

uint32_t jp_effort_anew(const struct jp_planner_internal *planner)
{
    const struct jp_planner_effort *effort = &planner->effort;
    const uint64_t fresh = jp_plan_is_current(planner) ? effort->fresh_end : effort->fresh_route;
    const uint64_t cost = planner->plan.cost < effort->fresh_cost ? planner->plan.cost : effort->fresh_cost;

    /* A search spreads over an area. */
    return effort->fresh_cost == 0U ? 0U : (uint32_t)(fresh * cost / effort->fresh_cost * cost / effort->fresh_cost);
}

/** Effort after which a repair is given up; 0: not before its end. What follows a cut takes less than a new search. */
static uint32_t repair_limit(const struct jp_planner_internal *planner)
{
    const uint32_t anew = jp_effort_anew(planner);

    return anew == 0U || planner->effort.has_cut ? 0U : anew / (uint32_t)CHEAP_DIVISOR + 1U;
}

/** True while the scout splices, or a repaired search looks for a route or for the proof of one. What they have found
 * is worth its trace. */
static bool is_repairing(const struct jp_planner_internal *planner)
{
    return planner->phase > JP_PLANNER_CHECK_PLAN && planner->phase != JP_PLANNER_TRACE &&
           planner->lent == JP_PLANNER_LENT_TO_NONE &&
           (planner->is_splicing ||
            (!planner->is_scouting && planner->search.is_repaired && planner->answer != JP_ANSWER_OPTIMAL));
}

unsigned jp_effort_slice(const struct jp_planner_internal *planner, unsigned expansions)
{
    const unsigned slice = expansions < SLICE_MAX ? expansions : SLICE_MAX;
    const uint32_t limit = repair_limit(planner);

    if (!is_repairing(planner) || limit == 0U) {
        return slice;
    }
    const uint32_t left = limit > planner->effort.spent ? limit - planner->effort.spent : 0U;
    return slice < left ? slice : left;
}

void jp_effort_note(struct jp_planner_internal *planner, unsigned spent, bool had_route)
{
    struct jp_planner_effort *effort = &planner->effort;

    effort->spent = effort->has_begun ? 0U : effort->spent + spent;
    if (planner->is_scouting || planner->search.is_repaired || !jp_plan_is_current(planner)) {
        return;
    }
    if (!had_route) {
        effort->fresh_route = effort->spent;
        effort->fresh_cost = planner->plan.cost;
    }
    if (planner->phase == JP_PLANNER_SETTLED) {
        effort->fresh_end = effort->spent;
        effort->fresh_cost = planner->plan.cost;
    }
}
