#include "src/search/planner_phases.h"

#include "src/search/planner_repair.h"
#include "src/search/planner_route.h"
#include "src/search/planner_search.h"

enum {
    EPSILON_RAISE_DIVISOR = 4,
    /* Units of other work that take about as long as one expansion. */
    FIELD_CELLS_PER_EXPANSION = 8,
    GUIDE_CELLS_PER_EXPANSION = 1,
    REKEYS_PER_EXPANSION = 32,
};

/** Most expansions at a time, so that the equivalent number of other units fits 32 bits. */
#define SLICE_MAX 0x100000U

/** The one place that assigns the phase. */
static void enter(struct jp_planner_internal *planner, enum jp_planner_phase phase)
{
    planner->phase = phase;
}

bool jp_phases_is_idle(const struct jp_planner_internal *planner)
{
    return planner->phase == JP_PLANNER_EMPTY || planner->phase == JP_PLANNER_SETTLED;
}

/** True when there is a search that can be repaired and continued. */
static bool has_search(const struct jp_planner_internal *planner)
{
    return planner->phase >= JP_PLANNER_UPDATE_FIELD;
}

static bool is_ready(const struct jp_planner_internal *planner)
{
    return planner->has_start && planner->has_goal;
}

static bool has_field(const struct jp_planner_internal *planner)
{
    return planner->statistics.field_bytes > 0U;
}

static bool is_field_rooted(const struct jp_planner_internal *planner)
{
    return planner->field_use != JP_FIELD_UNUSED;
}

/** Roots the energy field at the robot; it grows in `phase`, before or within a search. */
static void begin_field(struct jp_planner_internal *planner, enum jp_planner_phase phase)
{
    planner->field_use = JP_FIELD_ROOTED;
    planner->field_heading = planner->start.heading;
    jp_energy_field_start(&planner->field, planner->start.x, planner->start.y, planner->goal.x, planner->goal.y);
    enter(planner, phase);
}

/** Grows the guide from the search's target. */
static void begin_guide(struct jp_planner_internal *planner)
{
    const struct jp_lattice_pose *start = &planner->start;
    const struct jp_goal *goal = &planner->goal;

    if (jp_search_is_forward(planner)) {
        const struct jp_guide_root root = {(uint16_t)goal->x, (uint16_t)goal->y, goal->headings};
        jp_guide_field_start(&planner->guide, JP_GUIDE_TO_ROOT, &root, (uint16_t)start->x, (uint16_t)start->y);
    } else {
        const struct jp_guide_root root = {(uint16_t)start->x, (uint16_t)start->y, (uint16_t)(1U << start->heading)};
        jp_guide_field_start(&planner->guide, JP_GUIDE_FROM_ROOT, &root, (uint16_t)goal->x, (uint16_t)goal->y);
    }
    enter(planner, JP_PLANNER_GROW_GUIDE);
}

/** Begins from scratch; the search follows when its field has grown. */
static void begin(struct jp_planner_internal *planner, enum jp_planner_direction direction)
{
    planner->direction = direction;
    planner->field_use = JP_FIELD_UNUSED;
    planner->is_repaired = false;
    planner->changes.count = 0;
    planner->changes.may_be_cheaper = false;
    if (planner->epsilon == JP_EPSILON_ONE && has_field(planner)) {
        begin_field(planner, JP_PLANNER_GROW_FIELD);
    } else {
        begin_guide(planner);
    }
}

void jp_phases_restart(struct jp_planner_internal *planner)
{
    planner->terrain_version = planner->terrain->version;
    planner->answer = JP_ANSWER_OUT_OF_BUDGET;
    planner->level = 0;
    planner->epsilon = planner->config.epsilon[0];
    if (is_ready(planner)) {
        planner->statistics.restarts++;
        begin(planner, JP_PLANNER_FROM_GOAL);
    }
}

/** The heuristic: the energy field at ε = 1 if it has a root, else the guide. */
static void choose_heuristic(struct jp_planner_internal *planner)
{
    if (is_field_rooted(planner)) {
        planner->field_use = planner->epsilon == JP_EPSILON_ONE ? JP_FIELD_STEERS : JP_FIELD_ROOTED;
    }
}

static void begin_search(struct jp_planner_internal *planner)
{
    choose_heuristic(planner);
    planner->is_of_one_level = true;
    jp_search_start(planner);
    enter(planner, JP_PLANNER_SEARCH);
}

/** Continues a search; all keys are computed anew when the heuristic changes or states wait for this ε. */
static void resume(struct jp_planner_internal *planner)
{
    const bool was_exact = jp_search_is_exact(planner);

    choose_heuristic(planner);
    if (!was_exact || !jp_search_is_exact(planner)) {
        jp_search_rekey(planner, false);
    }
    enter(planner, planner->rekey_slot < planner->slot_count ? JP_PLANNER_REKEY : JP_PLANNER_SEARCH);
}

/** Ends a search with its answer. */
static void settle(struct jp_planner_internal *planner, enum jp_answer answer)
{
    planner->answer = answer;
    enter(planner, JP_PLANNER_SETTLED);
}

/** True when the energy field's root cannot reach the robot: the field bounds none of its routes then. */
static bool is_cut_off(const struct jp_planner_internal *planner)
{
    return is_field_rooted(planner) &&
           jp_energy_field_bound(&planner->field, planner->start.x, planner->start.y) == JP_COST_MAX;
}

/** After the guide has grown. Where it finds no path, the energy field can prove that there is none. */
static void leave_guide(struct jp_planner_internal *planner)
{
    if (!jp_search_is_forward(planner) && has_field(planner) &&
        !jp_guide_field_reaches(&planner->guide, planner->goal.x, planner->goal.y)) {
        begin_field(planner, JP_PLANNER_GROW_FIELD);
    } else {
        begin_search(planner);
    }
}

/** After the energy field has grown for a search that has not begun. */
static void leave_new_field(struct jp_planner_internal *planner)
{
    (void)jp_energy_field_take_lowered(&planner->field);
    if (is_cut_off(planner)) {
        jp_phases_restart(planner);
    } else if (jp_energy_field_bound(&planner->field, planner->goal.x, planner->goal.y) == JP_COST_MAX) {
        planner->answer = JP_ANSWER_UNREACHABLE;
        enter(planner, JP_PLANNER_EMPTY);
    } else {
        begin_search(planner);
    }
}

/** After the energy field has grown for a search in progress, or has taken in changes of the map. */
static void leave_field(struct jp_planner_internal *planner)
{
    const struct jp_cell_box lowered = jp_energy_field_take_lowered(&planner->field);

    if (is_cut_off(planner)) {
        jp_phases_restart(planner);
        return;
    }
    if (jp_search_is_exact(planner)) {
        jp_search_rekey_cells(planner, &lowered);
    }
    planner->changes.cursor = 0;
    enter(planner, JP_PLANNER_REPAIR);
}

/** After the repair. When the proved route is lost, the guide finds the next one sooner than the exact search does. */
static void leave_repair(struct jp_planner_internal *planner)
{
    planner->changes.count = 0;
    planner->changes.may_be_cheaper = false;
    if (jp_search_is_exact(planner) && !jp_plan_is_intact(planner)) {
        planner->level = 0;
        planner->epsilon = planner->config.epsilon[0];
        planner->is_of_one_level = false;
    }
    resume(planner);
}

/** The next smaller ε of the schedule. False when there is none, or nothing can be better. */
static bool take_next_epsilon(struct jp_planner_internal *planner)
{
    const unsigned next = planner->level + 1U;

    if (planner->answer != JP_ANSWER_WITHIN_BOUND || jp_search_is_forward(planner) || next == JP_EPSILON_LEVELS ||
        planner->config.epsilon[next] == 0U) {
        return false;
    }
    planner->level = (uint8_t)next;
    planner->epsilon = planner->config.epsilon[next];
    return true;
}

/** After a plan: continues with the next ε and the present states. */
static void improve(struct jp_planner_internal *planner)
{
    settle(planner, planner->plan.answer);
    if (!take_next_epsilon(planner)) {
        return;
    }
    planner->is_of_one_level = false;
    if (planner->epsilon == JP_EPSILON_ONE && has_field(planner) && !is_field_rooted(planner)) {
        begin_field(planner, JP_PLANNER_UPDATE_FIELD);
    } else {
        resume(planner);
    }
}

/** The states do not fit, and there is a plan: tries this ε once more without the states of earlier ones, then the
 * next.
 */
static void improve_from_scratch(struct jp_planner_internal *planner)
{
    if (!jp_search_is_exact(planner) && (!planner->is_of_one_level || take_next_epsilon(planner))) {
        begin_search(planner);
    } else {
        settle(planner, planner->answer);
    }
}

/** The states do not fit. Without a plan: raises ε, which needs fewer states, and at last searches from the robot. */
static void save_memory(struct jp_planner_internal *planner)
{
    if (planner->answer != JP_ANSWER_OUT_OF_BUDGET) {
        improve_from_scratch(planner);
    } else if (planner->is_repaired) {
        jp_phases_restart(planner);
    } else if (jp_search_is_forward(planner)) {
        settle(planner, jp_plan_publish(planner) ? planner->plan.answer : JP_ANSWER_OUT_OF_BUDGET);
    } else if (planner->epsilon < JP_EPSILON_MAX) {
        const unsigned epsilon = planner->epsilon + planner->epsilon / EPSILON_RAISE_DIVISOR;
        planner->epsilon = (uint16_t)(epsilon < JP_EPSILON_MAX ? epsilon : JP_EPSILON_MAX);
        begin_search(planner);
    } else {
        begin(planner, JP_PLANNER_FROM_ROBOT);
    }
}

static void search(struct jp_planner_internal *planner, unsigned *budget)
{
    switch (jp_search_expand(planner, budget)) {
    case SEARCH_FOUND:
        if (jp_plan_publish(planner)) {
            improve(planner);
        } else {
            jp_phases_restart(planner);
        }
        break;
    case SEARCH_IMPOSSIBLE:
        settle(planner, JP_ANSWER_UNREACHABLE);
        break;
    case SEARCH_FULL:
        save_memory(planner);
        break;
    case SEARCH_RANGE:
        jp_search_rekey(planner, true);
        enter(planner, JP_PLANNER_REKEY);
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
        jp_phases_restart(planner);
        break;
    case REPAIR_WORKING:
    default:
        break;
    }
}

/** Grows the energy field; true when it is done. */
static bool grow_field(struct jp_planner_internal *planner, unsigned *budget)
{
    unsigned cells = *budget * FIELD_CELLS_PER_EXPANSION;
    const bool is_grown = jp_energy_field_grow(&planner->field, &cells);

    *budget = cells / FIELD_CELLS_PER_EXPANSION;
    return is_grown;
}

static bool grow_guide(struct jp_planner_internal *planner, unsigned *budget)
{
    unsigned cells = *budget * GUIDE_CELLS_PER_EXPANSION;
    const bool is_grown = jp_guide_field_grow(&planner->guide, &cells);

    *budget = cells / GUIDE_CELLS_PER_EXPANSION;
    return is_grown;
}

static bool rekey(struct jp_planner_internal *planner, unsigned *budget)
{
    unsigned slots = *budget * REKEYS_PER_EXPANSION;
    const bool is_sorted = jp_search_rekey_work(planner, &slots);

    *budget = slots / REKEYS_PER_EXPANSION;
    return is_sorted;
}

/** Does work that is worth at most `budget` expansions and returns what is left of the budget. */
static unsigned work(struct jp_planner_internal *planner, unsigned budget)
{
    switch (planner->phase) {
    case JP_PLANNER_GROW_GUIDE:
        if (grow_guide(planner, &budget)) {
            leave_guide(planner);
        }
        return budget;
    case JP_PLANNER_GROW_FIELD:
        if (grow_field(planner, &budget)) {
            leave_new_field(planner);
        }
        return budget;
    case JP_PLANNER_UPDATE_FIELD:
        if (grow_field(planner, &budget)) {
            leave_field(planner);
        }
        return budget;
    case JP_PLANNER_REPAIR:
        repair(planner, &budget);
        return budget;
    case JP_PLANNER_REKEY:
        if (rekey(planner, &budget)) {
            enter(planner, JP_PLANNER_SEARCH);
        }
        return budget;
    case JP_PLANNER_SEARCH:
        search(planner, &budget);
        return budget;
    case JP_PLANNER_EMPTY:
    case JP_PLANNER_SETTLED:
    default:
        return 0;
    }
}

void jp_phases_work(struct jp_planner_internal *planner, unsigned expansions)
{
    while (expansions > 0U) {
        const unsigned slice = expansions < SLICE_MAX ? expansions : SLICE_MAX;
        expansions -= slice - work(planner, slice);
    }
}

/* ---- What changes ---- */

void jp_phases_follow_robot(struct jp_planner_internal *planner)
{
    if (jp_search_is_forward(planner) || planner->phase == JP_PLANNER_EMPTY) {
        jp_phases_restart(planner);
        return;
    }
    if (!has_search(planner)) {
        return; /* the field that is rooted where the robot was bounds these routes too */
    }
    if (planner->phase != JP_PLANNER_UPDATE_FIELD && is_cut_off(planner)) {
        jp_phases_restart(planner);
        return;
    }
    planner->is_repaired = true;
    if (planner->phase == JP_PLANNER_SETTLED || planner->phase == JP_PLANNER_SEARCH) {
        resume(planner);
    }
}

/** Repairs all noted changes at once, so that there is room for another one. Begins anew when the states do not fit. */
static void finish_repair(struct jp_planner_internal *planner)
{
    while (planner->phase == JP_PLANNER_GROW_FIELD || planner->phase == JP_PLANNER_UPDATE_FIELD ||
           planner->phase == JP_PLANNER_REPAIR) {
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
    planner->is_repaired = true;
    enter(planner, is_field_rooted(planner) ? JP_PLANNER_UPDATE_FIELD : JP_PLANNER_REPAIR);
}

void jp_phases_note_change(struct jp_planner_internal *planner, int32_t x, int32_t y, bool may_be_cheaper)
{
    if (has_search(planner) && !jp_repair_fits(planner, x, y)) {
        finish_repair(planner);
    }
    planner->answer = JP_ANSWER_OUT_OF_BUDGET;
    if (!is_ready(planner)) {
        return;
    }
    if (jp_search_is_forward(planner) || planner->phase == JP_PLANNER_EMPTY) {
        jp_phases_restart(planner);
        return;
    }
    if (has_search(planner)) {
        add_change(planner, x, y, may_be_cheaper);
    }
    if (may_be_cheaper && is_field_rooted(planner)) {
        jp_energy_field_cell_changed(&planner->field, x, y);
    }
}
