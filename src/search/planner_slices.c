#include "src/search/planner_slices.h"

#include "src/search/planner_cut.h"
#include "src/search/planner_route.h"
#include "src/search/planner_search.h"
#include "src/search/planner_states.h"

/** Units of work that take about as long as one expansion. */
enum {
    FIELD_CELLS = 2,
    GUIDE_UNITS = 150,
    TURN_LOOKS = 32,
    CLEARED_SLOTS = 256,
    CHECKED_STEPS = 8,
    REKEYED_SLOTS = 32,
    CUT_SLOTS = 128,
};

static bool grow_energy_field(struct jp_planner_internal *planner, unsigned *budget)
{
    unsigned cells = *budget * FIELD_CELLS;
    const bool is_done = jp_energy_field_grow(&planner->field, &cells);

    *budget = cells / FIELD_CELLS;
    return is_done;
}

bool jp_slice_grow_turns(struct jp_planner_internal *planner, unsigned *budget)
{
    unsigned looks = *budget * TURN_LOOKS;
    const bool is_done = jp_turn_field_grow(&planner->turn_field, &looks);

    *budget = looks / TURN_LOOKS;
    return is_done;
}

bool jp_slice_grow_fields(struct jp_planner_internal *planner, unsigned *budget)
{
    planner->are_fields_grown =
        grow_energy_field(planner, budget) && (!planner->has_turn_field || jp_slice_grow_turns(planner, budget));
    return planner->are_fields_grown;
}

/** The states' memory, where they are cleared when the guide has grown: all but those that rest while the scout
 * searches.
 */
static void lend_states(struct jp_planner_internal *planner)
{
    if (!planner->is_scouting && !planner->has_turn_field &&
        jp_guide_field_loan(&planner->terrain->config) <= planner->states_bytes) {
        jp_guide_field_lend(&planner->guide, planner->states_block);
    }
}

void jp_slice_begin_guide(struct jp_planner_internal *planner)
{
    const struct jp_lattice_pose *start = &planner->start;
    const struct jp_goal *goal = &planner->goal;

    planner->has_guide = false;
    planner->is_guide_old = false;
    if (jp_search_is_forward(planner)) {
        const struct jp_guide_root root = {(uint16_t)goal->x, (uint16_t)goal->y, goal->headings};
        jp_guide_field_start(&planner->guide, JP_GUIDE_TO_ROOT, &root, (uint16_t)start->x, (uint16_t)start->y);
    } else {
        const struct jp_guide_root root = {(uint16_t)start->x, (uint16_t)start->y, (uint16_t)(1U << start->heading)};
        jp_guide_field_start(&planner->guide, JP_GUIDE_FROM_ROOT, &root, (uint16_t)goal->x, (uint16_t)goal->y);
    }
    lend_states(planner);
}

bool jp_slice_grow_guide(struct jp_planner_internal *planner, unsigned *budget)
{
    unsigned units = *budget * GUIDE_UNITS;
    const bool is_done = jp_guide_field_grow(&planner->guide, &units);

    *budget = units / GUIDE_UNITS;
    planner->has_guide = is_done && !jp_search_is_forward(planner);
    return is_done;
}

bool jp_slice_clear(struct jp_planner_internal *planner, unsigned *budget)
{
    unsigned slots = *budget * CLEARED_SLOTS;
    const bool is_done = jp_planner_states_clear(&planner->search, &slots);

    *budget = slots / CLEARED_SLOTS;
    return is_done;
}

bool jp_slice_check_plan(struct jp_planner_internal *planner, unsigned *budget)
{
    unsigned steps = *budget * CHECKED_STEPS;
    const bool is_done = jp_plan_check(planner, &steps);

    *budget = steps / CHECKED_STEPS;
    return is_done;
}

bool jp_slice_rekey(struct jp_planner_internal *planner, unsigned *budget)
{
    unsigned slots = *budget * REKEYED_SLOTS;
    const bool is_done = jp_search_rekey_work(planner, &slots);

    *budget = slots / REKEYED_SLOTS;
    return is_done;
}

bool jp_slice_cut(struct jp_planner_internal *planner, unsigned *budget)
{
    unsigned slots = *budget * CUT_SLOTS;
    const bool is_done = jp_cut_work(planner, &slots);

    *budget = slots / CUT_SLOTS;
    return is_done;
}
