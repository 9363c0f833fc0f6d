#include "src/search/planner_phases.h"

#include "src/search/planner_bound.h"
#include "src/search/planner_cut.h"
#include "src/search/planner_effort.h"
#include "src/search/planner_fields.h"
#include "src/search/planner_rehearsal.h"
#include "src/search/planner_repair.h"
#include "src/search/planner_route.h"
#include "src/search/planner_scout.h"
#include "src/search/planner_search.h"
#include "src/search/planner_slices.h"
#include "src/search/planner_splice.h"
#include "src/search/planner_stage.h"
#include "src/search/planner_start.h"
#include "src/search/planner_states.h"
#include "src/search/planner_trace.h"

enum { EPSILON_RAISE_DIVISOR = 4 };

/** What a search from the robot is after, in place of the level of ε. */
#define FORWARD_WHOLE ((uint8_t)0)
#define FORWARD_PART  ((uint8_t)1)

bool jp_phases_is_idle(const struct jp_planner_internal *planner)
{
    return planner->phase == JP_PLANNER_EMPTY || planner->phase == JP_PLANNER_SETTLED;
}

/** After the states of the search before have been cleared. */
static void leave_clear(struct jp_planner_internal *planner)
{
    jp_search_start(planner);
    if (planner->is_splicing) {
        jp_splice_begin(planner);
    }
    jp_stage_enter(planner, JP_PLANNER_SEARCH);
}

/** After a change, before the search begins: what has been found out about its field is found out anew. */
static void look_at_new_field(struct jp_planner_internal *planner)
{
    if ((planner->phase == JP_PLANNER_CLEAR || planner->phase == JP_PLANNER_GROW_TURNS) && planner->is_field_rooted) {
        jp_stage_enter(planner, JP_PLANNER_GROW_FIELD);
    }
}

/** Ends a search with its answer. */
static void settle(struct jp_planner_internal *planner, enum jp_answer answer)
{
    planner->answer = answer;
    jp_stage_enter(planner, JP_PLANNER_SETTLED);
}

/** Begins anew where that is cheaper than to go on. A route that is there stays; only its proof begins anew. */
static void give_up_repair(struct jp_planner_internal *planner)
{
    if (!jp_plan_is_current(planner)) {
        jp_start_over(planner);
    } else {
        planner->statistics.restarts++;
        jp_rehearsal_end(planner);
        jp_start_anew(planner, JP_PLANNER_FROM_GOAL);
    }
}

/** After the cut. */
static void leave_cut(struct jp_planner_internal *planner)
{
    if (jp_cut_is_worth_it(planner)) {
        jp_search_rekey(planner, false);
        jp_stage_enter(planner, JP_PLANNER_REKEY);
    } else {
        give_up_repair(planner);
    }
}

/** There are no states to take in the changes. Where these have only blocked the map, plan and bound still hold, and
 * what has the states' memory goes on; but for a rehearsal, whose states cannot be repaired. */
static void take_in_changes_without_states(struct jp_planner_internal *planner)
{
    if (!jp_plan_is_current(planner) || planner->changes.may_be_cheaper) {
        give_up_repair(planner);
        return;
    }
    planner->changes.count = 0;
    planner->search.is_exact = false;
    if (planner->lent == JP_PLANNER_LENT_TO_TURNS) {
        jp_stage_enter(planner, JP_PLANNER_GROW_TURNS);
    } else if (planner->lent == JP_PLANNER_LENT_TO_FIELD) {
        jp_stage_enter(planner, JP_PLANNER_GROW_BOUND);
    } else {
        jp_rehearsal_end(planner);
        settle(planner, planner->answer);
    }
}

/** The search takes in the changes of the map, from the energy field on if it has a root. */
static void take_in_changes(struct jp_planner_internal *planner)
{
    if (planner->lent != JP_PLANNER_LENT_TO_NONE) {
        take_in_changes_without_states(planner);
    } else {
        jp_stage_enter(planner, planner->is_field_rooted ? JP_PLANNER_UPDATE_FIELD : JP_PLANNER_REPAIR);
    }
}

/** The scout searches from the goal to the robot, on the present map, as a new search would; the other one is left as
 *  it is meanwhile. */
static void scout_whole_way(struct jp_planner_internal *planner)
{
    jp_scout_take_whole_way(planner);
    jp_start_guide(planner);
}

/** The scout looks for a way from the robot to what is left of the plan. The guide may have grown from where the robot
 *  was before, and on an older map: it is an estimate. */
static void send_scout(struct jp_planner_internal *planner)
{
    jp_scout_call(planner, jp_plan_leads_to_goal(planner));
    if (planner->is_splicing && planner->has_guide) {
        jp_start_search(planner);
    } else {
        jp_start_guide(planner);
    }
}

/** With the scout's route, or without one, the exact search goes on. */
static void leave_scout(struct jp_planner_internal *planner)
{
    jp_scout_dismiss(planner);
    planner->effort.spent = 0;
    planner->effort.has_begun = true;
    take_in_changes(planner);
}

/** After the guide has grown. Where it finds no path, the energy field can prove that there is none. */
static void leave_guide(struct jp_planner_internal *planner)
{
    const bool is_blind = !jp_search_is_forward(planner) && jp_stage_has_field(planner) &&
                          !jp_guide_field_reaches(&planner->guide, planner->goal.x, planner->goal.y);

    if (is_blind && planner->is_scouting) {
        leave_scout(planner);
    } else if (is_blind) {
        jp_start_field(planner, JP_PLANNER_GROW_FIELD);
    } else {
        jp_start_search(planner);
    }
}

/** After the energy field has grown for a search that has not begun. */
static void leave_new_field(struct jp_planner_internal *planner)
{
    (void)jp_fields_take_lowered(planner);
    if (jp_fields_are_cut_off(planner)) {
        jp_start_over(planner);
    } else if (jp_fields_bound_at_goal(planner) == JP_COST_MAX) {
        planner->answer = JP_ANSWER_UNREACHABLE;
        jp_stage_enter(planner, JP_PLANNER_EMPTY);
    } else {
        jp_start_search(planner);
    }
}

/** After the energy field has grown for a search in progress, or has taken in changes of the map. */
static void leave_field(struct jp_planner_internal *planner)
{
    const struct jp_cell_box lowered = jp_fields_take_lowered(planner);

    if (jp_fields_are_cut_off(planner)) {
        jp_start_over(planner);
        return;
    }
    if (jp_search_is_exact(planner)) {
        jp_search_rekey_cells(planner, &lowered);
    }
    planner->changes.cursor = 0;
    jp_stage_enter(planner, JP_PLANNER_REPAIR);
}

/** After the repair. */
static void leave_repair(struct jp_planner_internal *planner)
{
    planner->changes.count = 0;
    planner->changes.may_be_cheaper = false;
    if (planner->answer == JP_ANSWER_OPTIMAL) {
        settle(planner, JP_ANSWER_OPTIMAL);
        return;
    }
    jp_start_resume(planner);
}

/** The next smaller ε of the schedule. False when there is none, or nothing can be better. */
static bool take_next_epsilon(struct jp_planner_internal *planner)
{
    const unsigned next = planner->search.level + 1U;

    if (planner->answer != JP_ANSWER_WITHIN_BOUND || jp_search_is_forward(planner) || next == JP_EPSILON_LEVELS ||
        planner->config.epsilon[next] == 0U) {
        return false;
    }
    planner->search.level = (uint8_t)next;
    planner->search.epsilon = planner->config.epsilon[next];
    return true;
}

/** When all of the block has done what it can: a smaller part of it may yet find a cheaper route. */
static void rehearse(struct jp_planner_internal *planner)
{
    if (planner->answer == JP_ANSWER_WITHIN_BOUND && jp_bound_is_scheduled(planner) && jp_rehearsal_next(planner)) {
        jp_start_anew(planner, JP_PLANNER_FROM_GOAL);
    } else {
        jp_rehearsal_end(planner);
        settle(planner, planner->answer);
    }
}

/** Ends the search; the fields may yet tighten the bound of the plan. */
static void end_search(struct jp_planner_internal *planner)
{
    if (jp_bound_is_wanted(planner)) {
        jp_bound_lend_to_turns(planner);
        jp_stage_enter(planner, JP_PLANNER_GROW_TURNS);
    } else {
        rehearse(planner);
    }
}

/** After the turn field has grown in the place of states. */
static void leave_turns(struct jp_planner_internal *planner)
{
    if (planner->has_turn_field) {
        jp_start_search(planner);
        return;
    }
    jp_bound_take_turns(planner);
    if (jp_bound_fits_field(planner)) {
        jp_bound_lend_to_field(planner);
        jp_start_field(planner, JP_PLANNER_GROW_BOUND);
    } else {
        jp_plan_tighten(planner);
        rehearse(planner);
    }
}

/** After the energy field has grown in the states' place: what is left of it may do for the first part of an exact
 *  search, or for all of it. */
static void leave_bound(struct jp_planner_internal *planner)
{
    jp_plan_tighten(planner);
    if (planner->answer != JP_ANSWER_OPTIMAL && jp_bound_has_states(planner)) {
        planner->search.epsilon = JP_EPSILON_ONE;
        planner->search.is_repaired = false;
        jp_start_search(planner);
    } else {
        rehearse(planner);
    }
}

/** Goes on to an exact search; but not in a rehearsal, before which all of the block has tried to prove its route. */
static void prove(struct jp_planner_internal *planner)
{
    if (jp_rehearsal_is_on(planner)) {
        rehearse(planner);
    } else {
        jp_start_field(planner, JP_PLANNER_UPDATE_FIELD);
    }
}

/** After a plan: continues with the next ε and the present states. */
static void improve(struct jp_planner_internal *planner)
{
    planner->answer = planner->plan.answer;
    if (!take_next_epsilon(planner)) {
        end_search(planner);
        return;
    }
    planner->search.is_of_one_level = false;
    if (planner->search.epsilon == JP_EPSILON_ONE && jp_stage_has_field(planner)) {
        prove(planner);
    } else {
        jp_start_resume(planner);
    }
}

/** The states do not fit, and there is a plan: tries this ε once more without the states of earlier ones, then the
 * next.
 */
static void improve_from_scratch(struct jp_planner_internal *planner)
{
    if (!jp_search_is_exact(planner) && (!planner->search.is_of_one_level || take_next_epsilon(planner))) {
        jp_start_search(planner);
    } else if (planner->search.is_repaired) {
        give_up_repair(planner); /* states of the map before fill the table */
    } else {
        jp_plan_tighten(planner);
        end_search(planner);
    }
}

/** A larger ε needs fewer states. After an exact search there is no guide yet. */
static void raise_epsilon(struct jp_planner_internal *planner)
{
    const unsigned epsilon = planner->search.epsilon + planner->search.epsilon / EPSILON_RAISE_DIVISOR;
    const bool was_exact = jp_search_is_exact(planner);

    planner->search.epsilon = (uint16_t)(epsilon < JP_EPSILON_MAX ? epsilon : JP_EPSILON_MAX);
    if (was_exact) {
        jp_bound_drop_turns(planner);
        jp_start_anew(planner, JP_PLANNER_FROM_GOAL);
    } else {
        jp_start_search(planner);
    }
}

/** The scout's states do not fit. */
static void save_scout_memory(struct jp_planner_internal *planner)
{
    if (planner->is_splicing) {
        scout_whole_way(planner);
    } else if (jp_plan_is_current(planner) || planner->search.epsilon == JP_EPSILON_MAX) {
        leave_scout(planner);
    } else {
        raise_epsilon(planner);
    }
}

/** Follows the route that the search has found. */
static void begin_trace(struct jp_planner_internal *planner, bool has_ended)
{
    if (jp_trace_begin(planner, has_ended)) {
        jp_stage_enter(planner, JP_PLANNER_TRACE);
    } else {
        rehearse(planner);
    }
}

/** True when a forward search has found a state nearer to the goal than the robot is. */
static bool has_come_nearer(const struct jp_planner_internal *planner)
{
    return planner->search.nearest != NO_SLOT &&
           planner->search.nearest_heuristic < jp_search_heuristic(planner, &planner->start);
}

/** The states of a search from the robot do not fit. The greediest one has shown that no whole route does: the first
 *  part of a good one is worth more than most of a bad one. */
static void save_forward_memory(struct jp_planner_internal *planner)
{
    if (planner->search.level == FORWARD_WHOLE) {
        planner->search.level = FORWARD_PART;
        planner->search.epsilon = jp_scout_whole_way_epsilon(planner);
        jp_start_search(planner);
    } else if (has_come_nearer(planner) || planner->search.epsilon == JP_EPSILON_MAX) {
        begin_trace(planner, true);
    } else {
        raise_epsilon(planner);
    }
}

/** True when the guide has led a search astray that does not fit: it may be too old. */
static bool has_old_guide(const struct jp_planner_internal *planner)
{
    return planner->is_guide_old && !jp_search_is_exact(planner);
}

/** The states do not fit. Without a plan: raises ε, which needs fewer states, and at last searches from the robot. */
static void save_memory(struct jp_planner_internal *planner)
{
    if (has_old_guide(planner)) {
        jp_start_guide(planner);
    } else if (!jp_rehearsal_awaits_route(planner)) {
        improve_from_scratch(planner);
    } else if (planner->search.is_repaired) {
        jp_start_over(planner);
    } else if (jp_search_is_forward(planner)) {
        save_forward_memory(planner);
    } else if (planner->search.epsilon < JP_EPSILON_MAX) {
        raise_epsilon(planner);
    } else {
        planner->search.level = FORWARD_WHOLE;
        jp_start_anew(planner, JP_PLANNER_FROM_ROBOT);
    }
}

/** The search's route does not fit, or its states are of another map. */
static void give_up_trace(struct jp_planner_internal *planner)
{
    if (planner->is_splicing) {
        scout_whole_way(planner);
    } else if (jp_search_is_forward(planner)) {
        rehearse(planner);
    } else {
        jp_start_over(planner);
    }
}

/** After a route has been published; the search goes on where it has not ended. */
static void leave_trace(struct jp_planner_internal *planner)
{
    planner->rehearsal.has_route = true;
    if (!planner->trace.has_ended && planner->plan.answer != JP_ANSWER_OPTIMAL) {
        planner->answer = planner->plan.answer;
        jp_stage_enter(planner, JP_PLANNER_SEARCH);
    } else if (planner->is_scouting) {
        planner->answer = planner->plan.answer;
        leave_scout(planner);
    } else {
        improve(planner);
    }
}

static void trace(struct jp_planner_internal *planner, unsigned *budget)
{
    switch (jp_trace_work(planner, budget)) {
    case TRACE_PUBLISHED:
        leave_trace(planner);
        break;
    case TRACE_FAILED:
        give_up_trace(planner);
        break;
    case TRACE_WORKING:
    default:
        break;
    }
}

/** No state is left to expand. Of the scout that proves nothing: the exact search has a better heuristic. */
static void leave_empty_search(struct jp_planner_internal *planner)
{
    if (planner->is_scouting) {
        leave_scout(planner);
    } else {
        settle(planner, JP_ANSWER_UNREACHABLE);
    }
}

static void leave_full_search(struct jp_planner_internal *planner)
{
    if (planner->is_scouting) {
        save_scout_memory(planner);
    } else if (jp_search_is_exact(planner) && !planner->search.is_repaired && jp_bound_can_share(planner)) {
        jp_bound_share_with_turns(planner);
        jp_stage_enter(planner, JP_PLANNER_GROW_TURNS);
    } else {
        save_memory(planner);
    }
}

static void search(struct jp_planner_internal *planner, unsigned *budget)
{
    switch (jp_search_expand(planner, budget)) {
    case SEARCH_ROUTE:
        begin_trace(planner, false);
        break;
    case SEARCH_FOUND:
        begin_trace(planner, true);
        break;
    case SEARCH_IMPOSSIBLE:
        leave_empty_search(planner);
        break;
    case SEARCH_FULL:
        leave_full_search(planner);
        break;
    case SEARCH_RANGE:
        jp_search_rekey(planner, true);
        jp_stage_enter(planner, JP_PLANNER_REKEY);
        break;
    case SEARCH_WORKING:
    default:
        break;
    }
}

static void repair(struct jp_planner_internal *planner, unsigned *budget)
{
    switch (planner->changes.count == 0U ? REPAIR_DONE : jp_repair_work(planner, budget)) {
    case REPAIR_DONE:
        leave_repair(planner);
        break;
    case REPAIR_FULL:
        jp_start_over(planner);
        break;
    case REPAIR_WORKING:
    default:
        break;
    }
}

/** After the plan has been checked, or where there is none. */
static void leave_plan(struct jp_planner_internal *planner)
{
    if (!jp_plan_is_current(planner) && jp_scout_exists(planner)) {
        send_scout(planner);
    } else {
        take_in_changes(planner);
    }
}

/** Does work that is worth at most `budget` expansions and returns what is left of the budget. */
static unsigned work(struct jp_planner_internal *planner, unsigned budget)
{
    switch (planner->phase) {
    case JP_PLANNER_GROW_GUIDE:
        if (jp_slice_grow_guide(planner, &budget)) {
            leave_guide(planner);
        }
        return budget;
    case JP_PLANNER_GROW_FIELD:
        if (jp_slice_grow_fields(planner, &budget)) {
            leave_new_field(planner);
        }
        return budget;
    case JP_PLANNER_CLEAR:
        if (jp_slice_clear(planner, &budget)) {
            leave_clear(planner);
        }
        return budget;
    case JP_PLANNER_CHECK_PLAN:
        if (jp_slice_check_plan(planner, &budget)) {
            leave_plan(planner);
        }
        return budget;
    case JP_PLANNER_UPDATE_FIELD:
        if (jp_slice_grow_fields(planner, &budget)) {
            leave_field(planner);
        }
        return budget;
    case JP_PLANNER_REPAIR:
        repair(planner, &budget);
        return budget;
    case JP_PLANNER_CUT:
        if (jp_slice_cut(planner, &budget)) {
            leave_cut(planner);
        }
        return budget;
    case JP_PLANNER_REKEY:
        if (jp_slice_rekey(planner, &budget)) {
            jp_stage_enter(planner, JP_PLANNER_SEARCH);
        }
        return budget;
    case JP_PLANNER_GROW_TURNS:
        if (jp_slice_grow_turns(planner, &budget)) {
            leave_turns(planner);
        }
        return budget;
    case JP_PLANNER_GROW_BOUND:
        if (jp_slice_grow_fields(planner, &budget)) {
            leave_bound(planner);
        }
        return budget;
    case JP_PLANNER_TRACE:
        trace(planner, &budget);
        return budget;
    case JP_PLANNER_SEARCH:
    default:
        search(planner, &budget);
        return budget;
    }
}

/** What has become too dear makes way for a new search. */
static void give_up(struct jp_planner_internal *planner)
{
    if (planner->is_splicing) {
        scout_whole_way(planner);
    } else if (planner->phase > JP_PLANNER_REPAIR && jp_search_is_exact(planner)) {
        jp_cut_begin(planner);
        jp_stage_enter(planner, JP_PLANNER_CUT);
    } else {
        give_up_repair(planner);
    }
}

void jp_phases_work(struct jp_planner_internal *planner, unsigned expansions)
{
    while (expansions > 0U && !jp_phases_is_idle(planner)) {
        const unsigned slice = jp_effort_slice(planner, expansions);

        if (slice == 0U) {
            give_up(planner);
            continue;
        }
        const bool had_route = jp_plan_is_current(planner);

        planner->effort.has_begun = false;
        const unsigned spent = slice - work(planner, slice);
        expansions -= spent;
        jp_effort_note(planner, spent, had_route);
    }
    planner->statistics.states = planner->search.state_count + planner->resting.state_count;
}

/* ---- What changes ---- */

/** True when a change begins the search anew, whatever there is: the states are of a search from the robot, or none. */
static bool has_no_use_of_states(const struct jp_planner_internal *planner)
{
    return (jp_search_is_forward(planner) && !jp_rehearsal_is_on(planner)) || planner->phase == JP_PLANNER_EMPTY;
}

/** A change meets the whole search, or none. */
static void finish_cut(struct jp_planner_internal *planner)
{
    while (planner->phase == JP_PLANNER_CUT) {
        (void)work(planner, UINT16_MAX);
    }
}

/** Finds out what is left of the plan, as it is now on the map; then the scout, or the repair, sees to the rest. */
static void look_at_plan(struct jp_planner_internal *planner)
{
    if (jp_plan_leads_to_goal(planner)) {
        jp_plan_begin_check(planner);
        jp_stage_enter(planner, JP_PLANNER_CHECK_PLAN);
    } else {
        leave_plan(planner);
    }
}

void jp_phases_follow_robot(struct jp_planner_internal *planner)
{
    finish_cut(planner);
    if (jp_plan_is_current(planner) && jp_plan_follow(planner)) {
        planner->answer = planner->plan.answer;
        if (jp_rehearsal_is_on(planner) && jp_search_is_forward(planner)) {
            rehearse(planner); /* this one began where the robot was */
        } else if (jp_stage_is_searching(planner)) {
            jp_start_resume(planner);
        } else {
            /* it goes on */
        }
        return;
    }
    if (jp_plan_is_current(planner)) {
        planner->effort.spent = 0;
    }
    planner->effort.has_cut = false;
    planner->answer = JP_ANSWER_OUT_OF_BUDGET;
    planner->least = 0;
    if (planner->is_scouting) {
        leave_scout(planner);
    }
    if (has_no_use_of_states(planner)) {
        jp_start_over(planner);
        return;
    }
    if (!jp_stage_has_search(planner)) {
        look_at_new_field(planner); /* rooted where the robot was, it bounds these routes too */
        return;
    }
    if (planner->lent != JP_PLANNER_LENT_TO_NONE) {
        jp_start_over(planner);
        return;
    }
    if (planner->phase == JP_PLANNER_CHECK_PLAN) {
        take_in_changes(planner);
    }
    if (planner->phase != JP_PLANNER_UPDATE_FIELD && jp_fields_are_cut_off(planner)) {
        jp_start_over(planner);
        return;
    }
    planner->search.is_repaired = true;
    if (planner->phase == JP_PLANNER_SETTLED || jp_stage_is_searching(planner)) {
        jp_start_resume(planner);
    }
    if (planner->phase != JP_PLANNER_SEARCH || !jp_search_has_arrived(planner)) {
        look_at_plan(planner);
    }
}

/** Repairs all noted changes at once, so that there is room for another one. Begins anew when the states do not fit. */
static void finish_repair(struct jp_planner_internal *planner)
{
    if (planner->phase == JP_PLANNER_CHECK_PLAN) {
        unsigned steps = UINT16_MAX;
        (void)jp_plan_check(planner, &steps);
        take_in_changes(planner);
    }
    while (planner->phase == JP_PLANNER_UPDATE_FIELD || planner->phase == JP_PLANNER_REPAIR) {
        (void)work(planner, UINT16_MAX);
    }
}

static void add_change(struct jp_planner_internal *planner, int32_t x, int32_t y, bool may_be_cheaper)
{
    struct jp_planner_changes *changes = &planner->changes;

    changes->cells[changes->count] = (struct jp_cell_change){(int16_t)x, (int16_t)y};
    changes->count++;
    changes->may_be_cheaper |= may_be_cheaper;
    changes->cursor = 0;
    planner->search.is_repaired = true;
    planner->effort.has_cut = false;
    if (jp_plan_is_current(planner)) {
        planner->effort.spent = 0;
    }
    look_at_plan(planner);
}

void jp_phases_note_change(struct jp_planner_internal *planner, int32_t x, int32_t y, bool may_be_cheaper)
{
    finish_cut(planner);
    if (planner->is_scouting) {
        leave_scout(planner);
    }
    if (jp_stage_has_search(planner) && !jp_repair_fits(planner, x, y)) {
        finish_repair(planner);
    }
    if (!jp_stage_is_ready(planner)) {
        return;
    }
    if (has_no_use_of_states(planner)) {
        jp_start_over(planner);
        return;
    }
    if (may_be_cheaper) {
        planner->least = 0;
        planner->turns_to_goal = 0;
        planner->has_guide = false;
    }
    if (jp_stage_has_search(planner)) {
        add_change(planner, x, y, may_be_cheaper);
    }
    planner->answer = JP_ANSWER_OUT_OF_BUDGET;
    if (may_be_cheaper && planner->is_field_rooted) {
        jp_fields_cell_changed(planner, x, y);
        look_at_new_field(planner);
    }
}
