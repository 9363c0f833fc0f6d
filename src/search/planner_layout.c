#include "src/search/planner_layout.h"

#include "src/base/block.h"
#include "src/search/planner_states.h"

enum {
    GUIDE_SCALE_MIN = 2,
    GUIDE_SHARE = 4, /* the guide takes at most one part in so many of the block, if it can be that coarse */
    FIELD_SHARE = 3, /* so does the energy field */
    SCOUT_SHARE = 16,
    ROUTE_STEPS_MIN = 256,
    ROUTE_STEPS_MAX = 65528, /* fits 16 bits and is aligned to 8 */
    ROUTES = 2,              /* the plan's and the one that is being traced */
    CELLS_PER_ROUTE_STEP =
        32, /* cells of the map for each step of the longest route: it may wind through all of the map */
};

_Static_assert(JP_LAYOUT_STATES_MIN > JP_PLANNER_SPLICE_STEPS + JP_HEADINGS,
               "a scout holds all that it is seeded with");
_Static_assert(JP_PLANNER_CELLS_MAX / JP_TERRAIN_SIDE_MAX >= JP_TERRAIN_SIDE_MAX, "no map is too large");

static size_t route_bytes(const struct jp_terrain_config *config)
{
    const size_t steps = ROUTE_STEPS_MIN + (size_t)config->width * config->height / CELLS_PER_ROUTE_STEP;

    return jp_block_align(steps < ROUTE_STEPS_MAX ? steps : ROUTE_STEPS_MAX);
}

size_t jp_planner_size(const struct jp_terrain_config *config)
{
    if (jp_terrain_size(config) == 0U) {
        return 0;
    }
    return jp_guide_field_size(config, JP_GUIDE_SCALE_MAX) + ROUTES * route_bytes(config) +
           jp_planner_states_size(JP_LAYOUT_STATES_MIN);
}

/** Scale of the finest guide that leaves most of the block, and enough of it, to the states. */
static unsigned guide_scale(const struct jp_terrain_config *config, size_t size)
{
    const size_t spare = size - ROUTES * route_bytes(config) - jp_planner_states_size(JP_LAYOUT_STATES_MIN);
    const size_t most = spare < size / GUIDE_SHARE ? spare : size / GUIDE_SHARE;
    unsigned scale = GUIDE_SCALE_MIN;

    while (scale < JP_GUIDE_SCALE_MAX && jp_guide_field_size(config, scale) > most) {
        scale++;
    }
    return scale;
}

/** Divides the memory of the states. Where the search may become exact, a small part of it is the scout's. */
static void lay_out_states(struct jp_planner_internal *planner, uint8_t *block, size_t size)
{
    const struct jp_terrain_config *map = &planner->terrain->config;
    size_t scout_bytes = 0;

    planner->resting = (struct jp_planner_search){0};
    if (planner->statistics.field_bytes > 0U && size / SCOUT_SHARE >= jp_planner_states_size(JP_LAYOUT_STATES_MIN)) {
        scout_bytes = jp_block_align(jp_planner_states_init(&planner->resting, map, block, size / SCOUT_SHARE));
    }
    planner->states_block = &block[scout_bytes];
    planner->states_bytes = size - scout_bytes;
    const size_t bytes = jp_planner_states_init(&planner->search, map, planner->states_block, planner->states_bytes);

    planner->statistics.search_bytes = (uint32_t)(bytes + scout_bytes);
    planner->statistics.states_max = planner->search.state_count_max + planner->resting.state_count_max;
}

void jp_layout_routes(struct jp_planner_internal *planner)
{
    const size_t bytes = route_bytes(&planner->terrain->config);

    planner->route = planner->block;
    planner->spare_route = &planner->block[bytes];
    planner->route_max = (uint16_t)bytes;
}

void jp_layout_divide(struct jp_planner_internal *planner, size_t size)
{
    const struct jp_planner_config *config = &planner->config;
    const struct jp_terrain_config *map = &planner->terrain->config;
    uint8_t *block = planner->block;
    const unsigned scale = guide_scale(map, size);
    const size_t guide_bytes = jp_guide_field_size(map, scale);
    const size_t field_bytes = jp_energy_field_size(map, JP_WAVE_3_BYTES);
    const size_t routes = ROUTES * route_bytes(map);
    size_t used = routes + guide_bytes;

    jp_guide_field_init(&planner->guide, config->lattice, config->cost, planner->terrain, &planner->turns, scale,
                        &block[routes]);
    planner->has_guide = false;
    planner->statistics.guide_bytes = (uint32_t)guide_bytes;
    planner->statistics.field_bytes = 0;
    if (field_bytes <= size / FIELD_SHARE &&
        used + field_bytes + jp_planner_states_size(JP_LAYOUT_STATES_MIN) <= size) {
        jp_energy_field_init(&planner->field, config->lattice, config->cost, planner->terrain, JP_WAVE_3_BYTES,
                             JP_COST_MAX, &block[used]);
        planner->statistics.field_bytes = (uint32_t)field_bytes;
        used += field_bytes;
    }
    lay_out_states(planner, &block[used], size - used);
}
