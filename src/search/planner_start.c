#include "src/search/planner_start.h"

#include "src/base/compiler.h"
#include "src/search/planner_bound.h"
#include "src/search/planner_fields.h"
#include "src/search/planner_rehearsal.h"
#include "src/search/planner_scout.h"
#include "src/search/planner_search.h"
#include "src/search/planner_slices.h"
#include "src/search/planner_stage.h"

/** An old guide serves a robot that is no farther from where it began to grow than so many parts of the way. */
enum { GUIDE_SHARE = 8 };

void jp_start_field(struct jp_planner_internal *planner, enum jp_planner_phase phase)
{
    jp_fields_start(planner);
    jp_stage_enter(planner, phase);
}

void jp_start_guide(struct jp_planner_internal *planner)
{
    jp_slice_begin_guide(planner);
    jp_stage_enter(planner, JP_PLANNER_GROW_GUIDE);
}

static jp_cost estimate(const struct jp_planner_internal *planner, int32_t x, int32_t y, unsigned heading)
{
    return jp_guide_field_estimate(&planner->guide, x, y, heading);
}

static unsigned first_heading(const struct jp_goal *goal)
{
    return JP_TRAILING_ZEROS((uint32_t)goal->headings);
}

/** True when the guide of the search before does for one from where the robot is. It may not know of the last changes
 *  of the map: it is an estimate, and takes most of the time of a new search. */
static bool guide_serves(const struct jp_planner_internal *planner)
{
    const struct jp_lattice_pose *start = &planner->start;
    const struct jp_goal *goal = &planner->goal;

    return planner->has_guide && !jp_search_is_forward(planner) &&
           estimate(planner, start->x, start->y, start->heading) <=
               estimate(planner, goal->x, goal->y, first_heading(goal)) / (jp_cost)GUIDE_SHARE;
}

void jp_start_anew(struct jp_planner_internal *planner, enum jp_planner_direction direction)
{
    jp_scout_dismiss(planner);
    planner->search.direction = direction;
    planner->is_field_rooted = false;
    if (!jp_rehearsal_is_on(planner)) {
        jp_bound_return_states(planner);
    }
    planner->search.is_exact = false;
    planner->search.is_repaired = false;
    planner->effort.spent = 0;
    planner->effort.fresh_end = 0;
    planner->effort.has_cut = false;
    planner->effort.has_begun = true;
    planner->changes.count = 0;
    planner->changes.may_be_cheaper = false;
    if (planner->search.epsilon == JP_EPSILON_ONE && jp_stage_has_field(planner)) {
        planner->has_guide = false;
        jp_start_field(planner, JP_PLANNER_GROW_FIELD);
    } else if (guide_serves(planner)) {
        planner->is_guide_old = true;
        jp_start_search(planner);
    } else {
        jp_start_guide(planner);
    }
}

void jp_start_over(struct jp_planner_internal *planner)
{
    planner->terrain_version = planner->terrain->version;
    jp_scout_dismiss(planner);
    jp_rehearsal_end(planner);
    planner->least = 0;
    planner->answer = JP_ANSWER_OUT_OF_BUDGET;
    planner->search.level = 0;
    planner->search.epsilon = planner->config.epsilon[0];
    if (jp_stage_is_ready(planner)) {
        planner->statistics.restarts++;
        planner->effort.fresh_route = 0;
        jp_start_anew(planner, JP_PLANNER_FROM_GOAL);
    }
}

/** The heuristic: the energy field at ε = 1 if it has a root, else the guide. */
static void choose_heuristic(struct jp_planner_internal *planner)
{
    planner->search.is_exact = planner->is_field_rooted && planner->search.epsilon == JP_EPSILON_ONE;
}

void jp_start_search(struct jp_planner_internal *planner)
{
    choose_heuristic(planner);
    planner->search.is_of_one_level = true;
    planner->search.clear_slot = 0;
    jp_stage_enter(planner, JP_PLANNER_CLEAR);
}

void jp_start_resume(struct jp_planner_internal *planner)
{
    const bool was_exact = jp_search_is_exact(planner);

    choose_heuristic(planner);
    if (!was_exact) {
        jp_search_rekey(planner, false);
    }
    jp_stage_enter(planner,
                   planner->search.rekey_slot < planner->search.slot_count ? JP_PLANNER_REKEY : JP_PLANNER_SEARCH);
}
