#include "src/search/planner_bound.h"

#include "src/search/planner_fields.h"
#include "src/search/planner_layout.h"
#include "src/search/planner_rehearsal.h"
#include "src/search/planner_scout.h"
#include "src/search/planner_states.h"

enum {
    TURN_SHARE = 4, /* the turn field takes at most one part in so many of the states' memory where it shares it */
};

/** Of the finest turn field that leaves most of the states. The coarsest does, where there is room for an energy field.
 */
static unsigned shared_turn_scale(const struct jp_planner_internal *planner)
{
    const size_t most = planner->states_bytes / TURN_SHARE;
    unsigned scale = JP_TURN_SCALE_MIN;

    while (jp_turn_field_size(&planner->terrain->config, scale) > most) {
        scale++;
    }
    return scale;
}

static void give_states_all(struct jp_planner_internal *planner)
{
    (void)jp_planner_states_init(&planner->search, &planner->terrain->config, planner->states_block,
                                 planner->states_bytes);
}

static void lay_out_turns(struct jp_planner_internal *planner, unsigned scale, uint8_t *block)
{
    jp_turn_field_init(&planner->turn_field, planner->config.lattice, planner->config.cost, planner->terrain, scale,
                       block);
    jp_fields_start_turns(planner);
}

bool jp_bound_is_scheduled(const struct jp_planner_internal *planner)
{
    for (unsigned level = 0; level < JP_EPSILON_LEVELS; level++) {
        if (planner->config.epsilon[level] == JP_EPSILON_ONE) {
            return true;
        }
    }
    return false;
}

bool jp_bound_can_share(const struct jp_planner_internal *planner)
{
    return planner->statistics.field_bytes > 0U && !planner->has_turn_field;
}

void jp_bound_share_with_turns(struct jp_planner_internal *planner)
{
    const struct jp_terrain_config *map = &planner->terrain->config;
    const unsigned scale = shared_turn_scale(planner);
    const size_t turn_bytes = jp_turn_field_size(map, scale);

    planner->has_turn_field = true;
    lay_out_turns(planner, scale, planner->states_block);
    (void)jp_planner_states_init(&planner->search, map, &planner->states_block[turn_bytes],
                                 planner->states_bytes - turn_bytes);
}

void jp_bound_drop_turns(struct jp_planner_internal *planner)
{
    if (planner->has_turn_field) {
        planner->has_turn_field = false;
        jp_scout_dismiss(planner);
        give_states_all(planner);
    }
}

bool jp_bound_fits_field(const struct jp_planner_internal *planner)
{
    return jp_energy_field_size(&planner->terrain->config, JP_WAVE_2_BYTES) <= planner->states_bytes;
}

bool jp_bound_is_wanted(const struct jp_planner_internal *planner)
{
    return planner->answer == JP_ANSWER_WITHIN_BOUND && planner->lent == JP_PLANNER_LENT_TO_NONE &&
           planner->statistics.field_bytes == 0U && jp_bound_is_scheduled(planner) &&
           jp_turn_field_size(&planner->terrain->config, JP_TURN_SCALE_MAX) <= planner->states_bytes;
}

void jp_bound_lend_to_turns(struct jp_planner_internal *planner)
{
    planner->lent = JP_PLANNER_LENT_TO_TURNS;
    planner->search.state_count = 0;
    planner->search.slot_count = 0;
    lay_out_turns(planner, JP_TURN_SCALE_MAX,
                  planner->states_block); /* a finer one bounds little better, and takes long */
}

void jp_bound_take_turns(struct jp_planner_internal *planner)
{
    planner->turns_to_goal = JP_COST_MAX;
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const jp_cost turns = jp_turn_field_bound(&planner->turn_field, planner->goal.x, planner->goal.y, heading);

        if ((planner->goal.headings & (1U << heading)) != 0U && turns < planner->turns_to_goal) {
            planner->turns_to_goal = turns;
        }
    }
}

void jp_bound_lend_to_field(struct jp_planner_internal *planner)
{
    const struct jp_terrain_config *map = &planner->terrain->config;
    const size_t field_bytes = jp_energy_field_size(map, JP_WAVE_2_BYTES);
    const size_t left = planner->states_bytes - field_bytes;

    planner->lent = JP_PLANNER_LENT_TO_FIELD;
    /* No value that matters is above the cost of the plan. */
    jp_energy_field_init(&planner->field, planner->config.lattice, planner->config.cost, planner->terrain,
                         JP_WAVE_2_BYTES, planner->plan.cost, planner->states_block);
    planner->search.direction = JP_PLANNER_FROM_GOAL; /* as the field's bounds are */
    if (left >= jp_planner_states_size(JP_LAYOUT_STATES_MIN)) {
        (void)jp_planner_states_init(&planner->search, map, &planner->states_block[field_bytes], left);
    }
}

bool jp_bound_has_states(const struct jp_planner_internal *planner)
{
    return planner->search.slot_count > 0U;
}

void jp_bound_return_states(struct jp_planner_internal *planner)
{
    planner->turns_to_goal = 0;
    if (planner->lent != JP_PLANNER_LENT_TO_NONE) {
        planner->lent = JP_PLANNER_LENT_TO_NONE;
        jp_rehearsal_end(planner);
        give_states_all(planner);
    }
}
