#include "src/search/planner_cut.h"

#include "src/search/planner_effort.h"
#include "src/search/planner_search.h"
#include "src/search/planner_states.h"

void jp_cut_begin(struct jp_planner_internal *planner)
{
    planner->effort.has_cut = true;
    planner->cut = (struct jp_planner_cut){
        .least = planner->search.cut_cost,
        .key = jp_cost_add(planner->plan.cost, jp_search_heuristic(planner, &planner->start)),
    };
}

static void look_at(struct jp_planner_cut *cut, const struct jp_planner_state *state)
{
    if (state->g < state->rhs && state->g < cut->least) {
        cut->least = (jp_cost)state->g;
    }
}

/** A state without which the proof cannot be had: no route over it is known to cost more than the plan. */
static bool is_needed(const struct jp_planner_internal *planner, const struct jp_planner_state *state)
{
    const struct jp_lattice_pose pose = jp_search_pose_of(planner, (uint32_t)state->id);

    return jp_cost_add((jp_cost)state->g, jp_search_heuristic(planner, &pose)) <= planner->cut.key;
}

static void forget(struct jp_planner_internal *planner, struct jp_planner_state *state)
{
    if (state->g >= planner->cut.least && state->g != JP_COST_MAX) {
        planner->cut.lost += is_needed(planner, state);
        state->g = JP_COST_MAX;
    }
}

bool jp_cut_work(struct jp_planner_internal *planner, unsigned *slots)
{
    struct jp_planner_cut *cut = &planner->cut;

    for (; *slots > 0U && cut->slot < planner->search.slot_count; --*slots) {
        struct jp_planner_state *state = &planner->search.states[cut->slot];

        if (jp_planner_state_is_used(state) && cut->is_found) {
            forget(planner, state);
        } else if (jp_planner_state_is_used(state)) {
            look_at(cut, state);
        } else {
            /* no state */
        }
        cut->slot++;
    }
    if (cut->slot < planner->search.slot_count) {
        return false;
    }
    if (!cut->is_found) {
        cut->is_found = true;
        cut->slot = 0;
        return false;
    }
    planner->search.cut_cost = cut->least;
    return true;
}

bool jp_cut_is_worth_it(const struct jp_planner_internal *planner)
{
    return planner->cut.lost < jp_effort_anew(planner);
}
