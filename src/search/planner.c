#include <joulepath/planner.h>
#include <string.h>

#include "src/base/block.h"
#include "src/search/planner_bound.h"
#include "src/search/planner_layout.h"
#include "src/search/planner_phases.h"
#include "src/search/planner_route.h"
#include "src/search/planner_search.h"
#include "src/search/planner_start.h"
#include "src/search/planner_states.h"

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
    inner->block = block;
    inner->block_size = size;
    jp_layout_routes(inner);
    jp_layout_divide(inner, size);
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
    planner->internal.has_guide = false;
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
    inner->has_guide = false;
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
        inner->has_guide = false;
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

/** True when one class of ground may take less than another. */
static bool may_be_cheaper(const struct jp_lattice *lattice, uint8_t ground, uint8_t than)
{
    const struct jp_ground_price *a = &lattice->ground[ground];
    const struct jp_ground_price *b = &lattice->ground[than];

    return a->straight < b->straight || a->turning < b->turning;
}

enum jp_status jp_planner_set_class(struct jp_planner *planner, int32_t x, int32_t y, uint8_t ground)
{
    struct jp_planner_internal *inner = &planner->internal;
    const uint8_t old = jp_terrain_class(inner->terrain, x, y);
    const enum jp_status status = jp_terrain_set_class(inner->terrain, x, y, ground);

    if (status != JP_OK) {
        return status;
    }
    inner->terrain_version++;
    if (ground != old) {
        jp_phases_note_change(inner, x, y, may_be_cheaper(inner->config.lattice, ground, old));
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

/* ---- What the search holds ---- */

/** Slots that hold states: before the search begins, and while fields have its memory, none does. */
static uint32_t slots_of_search(const struct jp_planner_internal *planner)
{
    const bool has_begun = planner->phase >= JP_PLANNER_CHECK_PLAN;

    return has_begun && planner->lent == JP_PLANNER_LENT_TO_NONE ? planner->search.slot_count : 0U;
}

bool jp_planner_next_state(const struct jp_planner *planner, uint32_t *slot, struct jp_lattice_pose *pose,
                           bool *is_open)
{
    const struct jp_planner_internal *inner = &planner->internal;
    const uint32_t slots = slots_of_search(inner);

    while (*slot < slots) {
        const struct jp_planner_state *state = &inner->search.states[*slot];

        *slot += 1U;
        if (jp_planner_state_is_used(state)) {
            *pose = jp_search_pose_of(inner, (uint32_t)state->id);
            *is_open = state->queued != 0U;
            return true;
        }
    }
    return false;
}
