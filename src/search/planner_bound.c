#include "src/search/planner_bound.h"

#include "src/search/planner_states.h"

enum { STATES_MIN = 64 };

static bool is_proof_scheduled(const struct jp_planner_config *config)
{
    for (unsigned level = 0; level < JP_EPSILON_LEVELS; level++) {
        if (config->epsilon[level] == JP_EPSILON_ONE) {
            return true;
        }
    }
    return false;
}

bool jp_bound_is_wanted(const struct jp_planner_internal *planner)
{
    return planner->answer == JP_ANSWER_WITHIN_BOUND && !planner->has_lent_states &&
           planner->statistics.field_bytes == 0U && is_proof_scheduled(&planner->config) &&
           jp_energy_field_size(&planner->terrain->config, JP_WAVE_2_BYTES) <= planner->statistics.search_bytes;
}

void jp_bound_lend_states(struct jp_planner_internal *planner)
{
    const struct jp_terrain_config *map = &planner->terrain->config;
    const size_t field_bytes = jp_energy_field_size(map, JP_WAVE_2_BYTES);
    const size_t left = planner->statistics.search_bytes - field_bytes;

    /* No value that matters is above the cost of the plan. */
    jp_energy_field_init(&planner->field, planner->config.lattice, planner->config.cost, planner->terrain,
                         JP_WAVE_2_BYTES, planner->plan.cost, planner->states_block);
    planner->has_lent_states = true;
    planner->search.direction = JP_PLANNER_FROM_GOAL; /* as the field's bounds are */
    planner->search.state_count = 0;
    planner->search.slot_count = 0;
    if (left >= jp_planner_states_size(STATES_MIN)) {
        (void)jp_planner_states_init(&planner->search, map, &planner->states_block[field_bytes], left);
    }
}

bool jp_bound_has_states(const struct jp_planner_internal *planner)
{
    return planner->search.slot_count > 0U;
}

void jp_bound_return_states(struct jp_planner_internal *planner)
{
    if (planner->has_lent_states) {
        planner->has_lent_states = false;
        (void)jp_planner_states_init(&planner->search, &planner->terrain->config, planner->states_block,
                                     planner->statistics.search_bytes);
    }
}
