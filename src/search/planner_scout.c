#include "src/search/planner_scout.h"

/** ε of a search of the whole way, where the schedule has none for searches by the guide. */
#define WHOLE_WAY_EPSILON ((uint16_t)346) /* 1.35 */

/** The way around what is blocked is not far: any will do at first. */
#define SPLICE_EPSILON ((uint16_t)512) /* 2 */

static void swap_searches(struct jp_planner_internal *planner)
{
    const struct jp_planner_search at_work = planner->search;

    planner->search = planner->resting;
    planner->resting = at_work;
    planner->is_scouting = !planner->is_scouting;
}

void jp_scout_call(struct jp_planner_internal *planner, bool is_splicing)
{
    swap_searches(planner);
    planner->search.direction = JP_PLANNER_FROM_GOAL;
    planner->search.level = 0;
    planner->search.epsilon = SPLICE_EPSILON;
    planner->search.is_repaired = false;
    planner->is_splicing = is_splicing;
    if (!is_splicing) {
        jp_scout_take_whole_way(planner);
    }
}

uint16_t jp_scout_whole_way_epsilon(const struct jp_planner_internal *planner)
{
    const uint16_t epsilon = planner->config.epsilon[0];

    return epsilon > JP_EPSILON_ONE ? epsilon : WHOLE_WAY_EPSILON;
}

void jp_scout_take_whole_way(struct jp_planner_internal *planner)
{
    planner->is_splicing = false;
    planner->search.epsilon = jp_scout_whole_way_epsilon(planner);
}

void jp_scout_dismiss(struct jp_planner_internal *planner)
{
    if (planner->is_scouting) {
        swap_searches(planner);
        planner->is_splicing = false;
    }
}
