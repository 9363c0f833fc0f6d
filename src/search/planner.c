#include <joulepath/planner.h>
#include <string.h>

#include "src/base/block.h"
#include "src/search/planner_bound.h"
#include "src/search/planner_phases.h"
#include "src/search/planner_route.h"
#include "src/search/planner_start.h"
#include "src/search/planner_states.h"

enum {
    STATES_MIN = 64,
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

_Static_assert(STATES_MIN > JP_PLANNER_SPLICE_STEPS + JP_HEADINGS, "a scout holds all that it is seeded with");
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
           jp_planner_states_size(STATES_MIN);
}

/** Scale of the finest guide that leaves most of the block, and enough of it, to the states. */
static unsigned guide_scale(const struct jp_terrain_config *config, size_t size)
{
    const size_t spare = size - ROUTES * route_bytes(config) - jp_planner_states_size(STATES_MIN);
    const size_t most = spare < size / GUIDE_SHARE ? spare : size / GUIDE_SHARE;
    unsigned scale = GUIDE_SCALE_MIN;

    while (scale < JP_GUIDE_SCALE_MAX && jp_guide_field_size(config, scale) > most) {
        scale++;
    }
    return scale;
}

static bool is_schedule(const uint16_t *epsilon)
{
    if (epsilon[0] < JP_EPSILON_ONE || epsilon[0] > JP_EPSILON_MAX) {
        return false;
    }
    for (unsigned i = 1; i < JP_EPSILON_LEVELS && epsilon[i] != 0U; i++) {
        if (epsilon[i] < JP_EPSILON_ONE || epsilon[i] >= epsilon[i - 1U]) {
            return false;
        }
    }
    return true;
}

static const char *field_out_of_range(const struct jp_planner_config *config, const struct jp_terrain *terrain)
{
    if (config->lattice == NULL || config->lattice->resolution != terrain->config.resolution) {
        return "lattice";
    }
    if ((unsigned)config->cost >= (unsigned)JP_COST_KINDS) {
        return "cost";
    }
    if (!is_schedule(config->epsilon)) {
        return "epsilon";
    }
    return jp_planner_size(&terrain->config) == 0U ? "terrain" : NULL;
}

/** Most neighbours that an expansion can add, in either direction. */
static uint16_t neighbours_max(const struct jp_lattice *lattice)
{
    unsigned most = 0;

    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const unsigned leaving = (unsigned)lattice->first_from[heading + 1U] - lattice->first_from[heading];
        const unsigned arriving = (unsigned)lattice->first_to[heading + 1U] - lattice->first_to[heading];
        most = leaving > most ? leaving : most;
        most = arriving > most ? arriving : most;
    }
    return (uint16_t)most;
}

/** Divides the memory of the states. Where the search may become exact, a small part of it is the scout's. */
static void lay_out_states(struct jp_planner_internal *planner, uint8_t *block, size_t size)
{
    const struct jp_terrain_config *map = &planner->terrain->config;
    size_t scout_bytes = 0;

    if (planner->statistics.field_bytes > 0U && size / SCOUT_SHARE >= jp_planner_states_size(STATES_MIN)) {
        scout_bytes = jp_block_align(jp_planner_states_init(&planner->resting, map, block, size / SCOUT_SHARE));
    }
    planner->states_block = &block[scout_bytes];
    planner->states_bytes = size - scout_bytes;
    const size_t bytes = jp_planner_states_init(&planner->search, map, planner->states_block, planner->states_bytes);

    planner->statistics.search_bytes = (uint32_t)(bytes + scout_bytes);
    planner->statistics.states_max = planner->search.state_count_max + planner->resting.state_count_max;
}

/** Divides the block: guide, routes, the energy field if most of the block is left for the states, and the states. */
static void lay_out(struct jp_planner_internal *planner, uint8_t *block, size_t size)
{
    const struct jp_planner_config *config = &planner->config;
    const struct jp_terrain_config *map = &planner->terrain->config;
    const unsigned scale = guide_scale(map, size);
    const size_t guide_bytes = jp_guide_field_size(map, scale);
    const size_t field_bytes = jp_energy_field_size(map, JP_WAVE_3_BYTES);
    size_t used = guide_bytes + ROUTES * route_bytes(map);

    jp_guide_field_init(&planner->guide, config->lattice, config->cost, planner->terrain, &planner->turns, scale,
                        block);
    planner->route = &block[guide_bytes];
    planner->spare_route = &planner->route[route_bytes(map)];
    planner->route_max = (uint16_t)route_bytes(map);
    planner->statistics.guide_bytes = (uint32_t)guide_bytes;
    if (field_bytes <= size / FIELD_SHARE && used + field_bytes + jp_planner_states_size(STATES_MIN) <= size) {
        jp_energy_field_init(&planner->field, config->lattice, config->cost, planner->terrain, JP_WAVE_3_BYTES,
                             JP_COST_MAX, &block[used]);
        planner->statistics.field_bytes = (uint32_t)field_bytes;
        used += field_bytes;
    }
    lay_out_states(planner, &block[used], size - used);
}

enum jp_status jp_planner_init(struct jp_planner *planner, const struct jp_planner_config *config,
                               struct jp_terrain *terrain, void *block, size_t size, const char **field)
{
    if (planner == NULL || config == NULL || terrain == NULL || block == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *field = field_out_of_range(config, terrain);
    if (*field != NULL) {
        return JP_ERR_CONFIG;
    }
    if (!jp_block_is_aligned(block)) {
        return JP_ERR_ALIGNMENT;
    }
    if (size < jp_planner_size(&terrain->config)) {
        return JP_ERR_MEMORY;
    }
    struct jp_planner_internal *inner = &planner->internal;

    (void)memset(inner, 0, sizeof *inner);
    inner->config = *config;
    inner->terrain = terrain;
    inner->terrain_version = terrain->version;
    jp_lattice_turns(config->lattice, config->cost, &inner->turns);
    jp_lattice_straight(config->lattice, config->cost, &inner->straight);
    inner->neighbours_max = neighbours_max(config->lattice);
    lay_out(inner, block, size);
    return JP_OK;
}

/* ---- Work ---- */

enum jp_answer jp_planner_work(struct jp_planner *planner, unsigned expansions)
{
    struct jp_planner_internal *inner = &planner->internal;

    if (inner->terrain_version != inner->terrain->version) {
        return JP_ANSWER_STALE;
    }
    jp_phases_work(inner, expansions);
    return inner->answer;
}

/* ---- Start, goal and costs ---- */

void jp_planner_restart(struct jp_planner *planner)
{
    jp_start_over(&planner->internal);
}

enum jp_status jp_planner_set_lattice(struct jp_planner *planner, const struct jp_lattice *lattice)
{
    if (planner == NULL || lattice == NULL) {
        return JP_ERR_ARGUMENT;
    }
    struct jp_planner_internal *inner = &planner->internal;

    if (lattice->moves != inner->config.lattice->moves) {
        return JP_ERR_CONFIG;
    }
    inner->config.lattice = lattice;
    jp_guide_field_set_lattice(&inner->guide, lattice);
    jp_energy_field_set_lattice(&inner->field, lattice);
    jp_turn_field_set_lattice(&inner->turn_field, lattice);
    jp_lattice_turns(lattice, inner->config.cost, &inner->turns);
    jp_lattice_straight(lattice, inner->config.cost, &inner->straight);
    jp_start_over(inner);
    return JP_OK;
}

static enum jp_status check_start(const struct jp_planner_internal *planner, const struct jp_lattice_pose *start)
{
    if (start->heading >= JP_HEADINGS) {
        return JP_ERR_ARGUMENT;
    }
    if (!jp_terrain_contains(planner->terrain, start->x, start->y)) {
        return JP_ERR_OUTSIDE;
    }
    return jp_lattice_can_stand(planner->config.lattice, planner->terrain, start->x, start->y, start->heading)
               ? JP_OK
               : JP_ERR_BLOCKED;
}

enum jp_status jp_planner_set_start(struct jp_planner *planner, const struct jp_lattice_pose *start)
{
    if (planner == NULL || start == NULL) {
        return JP_ERR_ARGUMENT;
    }
    struct jp_planner_internal *inner = &planner->internal;
    const enum jp_status status = check_start(inner, start);

    if (status == JP_OK) {
        inner->start = *start;
        inner->has_start = true;
        jp_phases_follow_robot(inner);
    }
    return status;
}

static enum jp_status check_goal(const struct jp_planner_internal *planner, const struct jp_goal *goal)
{
    if (goal->headings == 0U) {
        return JP_ERR_ARGUMENT;
    }
    if (!jp_terrain_contains(planner->terrain, goal->x, goal->y)) {
        return JP_ERR_OUTSIDE;
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        if (((goal->headings >> heading) & 1U) != 0U &&
            jp_lattice_can_stand(planner->config.lattice, planner->terrain, goal->x, goal->y, heading)) {
            return JP_OK;
        }
    }
    return JP_ERR_BLOCKED;
}

enum jp_status jp_planner_set_goal(struct jp_planner *planner, const struct jp_goal *goal)
{
    if (planner == NULL || goal == NULL) {
        return JP_ERR_ARGUMENT;
    }
    struct jp_planner_internal *inner = &planner->internal;
    const enum jp_status status = check_goal(inner, goal);

    if (status == JP_OK) {
        jp_bound_drop_turns(inner);
        inner->goal = *goal;
        inner->has_goal = true;
        jp_start_over(inner);
    }
    return status;
}

/* ---- Changes of the map ---- */

enum jp_status jp_planner_set_cell(struct jp_planner *planner, int32_t x, int32_t y, enum jp_cell cell)
{
    struct jp_planner_internal *inner = &planner->internal;
    const bool was_clear = jp_terrain_is_clear(inner->terrain, &(const struct jp_span){0, 0, 0}, 1, x, y);
    const enum jp_status status = jp_terrain_set_cell(inner->terrain, x, y, cell);

    if (status != JP_OK) {
        return status;
    }
    inner->terrain_version++;
    const bool is_clear = jp_terrain_is_clear(inner->terrain, &(const struct jp_span){0, 0, 0}, 1, x, y);
    if (is_clear != was_clear) {
        jp_phases_note_change(inner, x, y, is_clear);
    }
    return JP_OK;
}

enum jp_status jp_planner_set_elevation(struct jp_planner *planner, int32_t x, int32_t y, jp_elevation elevation)
{
    struct jp_planner_internal *inner = &planner->internal;
    const jp_elevation old = jp_terrain_elevation(inner->terrain, x, y);
    const enum jp_status status = jp_terrain_set_elevation(inner->terrain, x, y, elevation);

    if (status != JP_OK) {
        return status;
    }
    inner->terrain_version++;
    if (elevation != old) {
        jp_phases_note_change(inner, x, y, true);
    }
    return JP_OK;
}

enum jp_status jp_planner_set_cost(struct jp_planner *planner, int32_t x, int32_t y, uint8_t cost)
{
    struct jp_planner_internal *inner = &planner->internal;
    const uint8_t old = jp_terrain_cost(inner->terrain, x, y);
    const enum jp_status status = jp_terrain_set_cost(inner->terrain, x, y, cost);

    if (status != JP_OK) {
        return status;
    }
    inner->terrain_version++;
    if (cost != old) {
        jp_phases_note_change(inner, x, y, cost < old);
    }
    return JP_OK;
}

/* ---- What is known ---- */

bool jp_planner_is_idle(const struct jp_planner *planner)
{
    return jp_phases_is_idle(&planner->internal);
}

const struct jp_plan *jp_planner_plan(const struct jp_planner *planner)
{
    return &planner->internal.plan;
}

const struct jp_primitive *jp_planner_step(const struct jp_planner *planner, unsigned index,
                                           struct jp_lattice_pose *pose)
{
    return jp_plan_step(&planner->internal, index, pose);
}

const struct jp_terrain *jp_planner_terrain(const struct jp_planner *planner)
{
    return planner->internal.terrain;
}

const struct jp_lattice *jp_planner_lattice(const struct jp_planner *planner)
{
    return planner->internal.config.lattice;
}

const struct jp_planner_counts *jp_planner_statistics(const struct jp_planner *planner)
{
    return &planner->internal.statistics;
}
