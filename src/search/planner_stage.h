/** What a planner is at: conditions that several of its phases ask for. */
#ifndef JOULEPATH_SEARCH_PLANNER_STAGE_H
#define JOULEPATH_SEARCH_PLANNER_STAGE_H

#include <joulepath/planner.h>

/** True while the search expands states, or has found what is traced. */
static inline bool jp_stage_is_searching(const struct jp_planner_internal *planner)
{
    return planner->phase == JP_PLANNER_SEARCH || planner->phase == JP_PLANNER_TRACE;
}

/** True when there is a search, or a plan with a bound, that changes must be taken into. */
static inline bool jp_stage_has_search(const struct jp_planner_internal *planner)
{
    return planner->lent != JP_PLANNER_LENT_TO_NONE || planner->phase >= JP_PLANNER_CHECK_PLAN;
}

static inline bool jp_stage_is_ready(const struct jp_planner_internal *planner)
{
    return planner->has_start && planner->has_goal;
}

static inline bool jp_stage_has_field(const struct jp_planner_internal *planner)
{
    return planner->statistics.field_bytes > 0U;
}

/** The one place that assigns the phase. */
static inline void jp_stage_enter(struct jp_planner_internal *planner, enum jp_planner_phase phase)
{
    planner->phase = phase;
}

#endif
