#include <joulepath/planner.h>
#include <string.h>

#include "planner_repair.h"
#include "planner_route.h"
#include "planner_search.h"
#include "planner_states.h"

enum phase {
    PHASE_IDLE,   /* nothing to do */
    PHASE_FIELD,  /* the energy field grows, or is repaired */
    PHASE_REPAIR, /* states learn of changed cells */
    PHASE_REKEY,  /* the queue is sorted for another ε */
    PHASE_SEARCH
};

enum {
    ALIGNMENT = 8,
    STATES_MIN = 64,
    ROUTE_STEPS_MIN = 256,
    CELLS_PER_ROUTE_STEP = 32, /* of the map: room for a route that winds through all of it */
    /* So much of other work is worth one expansion. */
    FIELD_CELLS_PER_EXPANSION = 8,
    REKEYS_PER_EXPANSION = 32,
    REPAIRS_PER_EXPANSION = 1,
};

static size_t route_bytes(const struct jp_terrain_config *config)
{
    const size_t steps = ROUTE_STEPS_MIN + (size_t)config->width * config->height / CELLS_PER_ROUTE_STEP;

    return (steps + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

static size_t fixed_bytes(const struct jp_terrain_config *config)
{
    return jp_energy_field_size(config) + route_bytes(config);
}

size_t jp_planner_size_min(const struct jp_terrain_config *config)
{
    if (jp_terrain_size(config) == 0 || (uint32_t)config->width * config->height > JP_PLANNER_CELLS_MAX) {
        return 0;
    }
    return fixed_bytes(config) + planner_states_size(STATES_MIN);
}

static bool is_schedule(const uint16_t *epsilon)
{
    if (epsilon[0] < JP_EPSILON_ONE || epsilon[0] > JP_EPSILON_MAX) {
        return false;
    }
    for (unsigned i = 1; i < JP_EPSILON_LEVELS && epsilon[i] != 0; i++) {
        if (epsilon[i] < JP_EPSILON_ONE || epsilon[i] >= epsilon[i - 1]) {
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
    if ((unsigned)config->cost >= JP_COST_KINDS) {
        return "cost";
    }
    if (!is_schedule(config->epsilon)) {
        return "epsilon";
    }
    return jp_planner_size_min(&terrain->config) == 0 ? "terrain" : NULL;
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
    if ((uintptr_t)block % ALIGNMENT != 0) {
        return JP_ERR_ALIGNMENT;
    }
    if (size < jp_planner_size_min(&terrain->config)) {
        return JP_ERR_MEMORY;
    }
    uint8_t *bytes = block;
    const size_t field_bytes = jp_energy_field_size(&terrain->config);

    memset(planner, 0, sizeof *planner);
    planner->config = *config;
    planner->terrain = terrain;
    planner->terrain_version = terrain->version;
    planner->route_max = (uint16_t)route_bytes(&terrain->config);
    planner->statistics.field_bytes = (uint32_t)field_bytes;
    jp_energy_field_init(&planner->field, config->lattice, config->cost, terrain, bytes);
    planner->route = bytes + field_bytes;
    planner_states_init(planner, bytes + fixed_bytes(&terrain->config), size - fixed_bytes(&terrain->config));
    planner_states_clear(planner);
    return JP_OK;
}

static bool is_ready(const struct jp_planner *planner)
{
    return planner->has_start && planner->has_goal;
}

/** Grows the field from the search's target, from scratch; the search follows. */
static void begin(struct jp_planner *planner, bool forward)
{
    const int32_t start_x = planner->start.x;
    const int32_t start_y = planner->start.y;

    planner->forward = forward;
    planner->is_searching = false;
    planner->is_repaired = false;
    planner->change_count = 0;
    planner->phase = PHASE_FIELD;
    if (forward) {
        jp_energy_field_start(&planner->field, JP_FIELD_TO_ROOT, planner->goal.x, planner->goal.y, start_x, start_y);
    } else {
        jp_energy_field_start(&planner->field, JP_FIELD_FROM_ROOT, start_x, start_y, planner->goal.x, planner->goal.y);
    }
}

void jp_planner_restart(struct jp_planner *planner)
{
    planner->terrain_version = planner->terrain->version;
    planner->answer = JP_ANSWER_OUT_OF_BUDGET;
    planner->level = 0;
    planner->epsilon = planner->config.epsilon[0];
    planner->statistics.expansions = 0;
    planner->statistics.restarts++;
    if (is_ready(planner)) {
        begin(planner, false);
    }
}

/** For a search that has not begun. */
static bool is_field_growing(const struct jp_planner *planner)
{
    return planner->phase == PHASE_FIELD && !planner->is_searching && !planner->forward;
}

enum jp_status jp_planner_set_start(struct jp_planner *planner, const struct jp_pose *start)
{
    if (start->heading >= JP_HEADINGS) {
        return JP_ERR_ARGUMENT;
    }
    if (!jp_terrain_contains(planner->terrain, start->x, start->y)) {
        return JP_ERR_OUTSIDE;
    }
    if (!jp_lattice_can_stand(planner->config.lattice, planner->terrain, start->x, start->y, start->heading)) {
        return JP_ERR_BLOCKED;
    }
    planner->start = *start;
    planner->has_start = true;
    planner->answer = JP_ANSWER_OUT_OF_BUDGET;
    if (is_field_growing(planner)) {
        return JP_OK; /* a field rooted where the robot was is a bound too */
    }
    if (!planner->is_searching || planner->forward ||
        jp_energy_field_bound(&planner->field, start->x, start->y) == JP_COST_MAX) {
        jp_planner_restart(planner);
        return JP_OK;
    }
    planner->is_repaired = true;
    if (planner->phase == PHASE_IDLE) {
        planner->phase = PHASE_SEARCH;
    }
    return JP_OK;
}

enum jp_status jp_planner_set_goal(struct jp_planner *planner, const struct jp_goal *goal)
{
    bool fits = false;

    if (goal->headings == 0) {
        return JP_ERR_ARGUMENT;
    }
    if (!jp_terrain_contains(planner->terrain, goal->x, goal->y)) {
        return JP_ERR_OUTSIDE;
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        fits |= ((goal->headings >> heading) & 1) != 0 &&
                jp_lattice_can_stand(planner->config.lattice, planner->terrain, goal->x, goal->y, heading);
    }
    if (!fits) {
        return JP_ERR_BLOCKED;
    }
    planner->goal = *goal;
    planner->has_goal = true;
    jp_planner_restart(planner);
    return JP_OK;
}

static bool is_stale(const struct jp_planner *planner)
{
    return planner->terrain_version != planner->terrain->version;
}

static void finish(struct jp_planner *planner, enum jp_answer answer)
{
    planner->answer = answer;
    planner->phase = PHASE_IDLE;
}

static void field_is_grown(struct jp_planner *planner)
{
    if (planner->is_searching) {
        const struct jp_field_box box = jp_energy_field_take_lowered(&planner->field);
        search_rekey_cells(planner, &box);
        planner->repair_cursor = 0;
        planner->phase = PHASE_REPAIR;
        return;
    }
    const int32_t x = planner->forward ? planner->start.x : planner->goal.x;
    const int32_t y = planner->forward ? planner->start.y : planner->goal.y;
    if (jp_energy_field_bound(&planner->field, x, y) == JP_COST_MAX) {
        finish(planner, JP_ANSWER_UNREACHABLE);
        return;
    }
    (void)jp_energy_field_take_lowered(&planner->field);
    search_start(planner);
    planner->is_searching = true;
    planner->phase = PHASE_SEARCH;
}

/** The next smaller ε of the schedule, or nothing more to do. */
static void go_on(struct jp_planner *planner)
{
    const unsigned next = planner->level + 1U;

    planner->answer = planner->plan.answer;
    planner->phase = PHASE_IDLE;
    if (planner->answer != JP_ANSWER_WITHIN_BOUND || planner->forward || next == JP_EPSILON_LEVELS ||
        planner->config.epsilon[next] == 0) {
        return;
    }
    planner->level = (uint8_t)next;
    planner->epsilon = planner->config.epsilon[next];
    search_rekey(planner, false);
    planner->phase = PHASE_REKEY;
}

/** The states do not fit: keep what there is, else search on with less care, at last from the robot. */
static void table_is_full(struct jp_planner *planner)
{
    if (planner->answer != JP_ANSWER_OUT_OF_BUDGET) {
        planner->phase = PHASE_IDLE;
    } else if (planner->is_repaired) {
        jp_planner_restart(planner);
    } else if (planner->forward) {
        finish(planner, route_publish(planner) ? JP_ANSWER_PARTIAL : JP_ANSWER_OUT_OF_BUDGET);
    } else if (planner->epsilon < JP_EPSILON_MAX) {
        planner->epsilon = (uint16_t)(planner->epsilon > JP_EPSILON_MAX / 2 ? JP_EPSILON_MAX : planner->epsilon * 2);
        search_start(planner);
    } else {
        begin(planner, true);
    }
}

static void search(struct jp_planner *planner, unsigned *budget)
{
    switch (search_expand(planner, budget)) {
    case SEARCH_FOUND:
        if (route_publish(planner)) {
            go_on(planner);
        } else {
            jp_planner_restart(planner);
        }
        break;
    case SEARCH_IMPOSSIBLE:
        finish(planner, JP_ANSWER_UNREACHABLE);
        break;
    case SEARCH_FULL:
        table_is_full(planner);
        break;
    case SEARCH_RANGE:
        search_rekey(planner, true);
        planner->phase = PHASE_REKEY;
        break;
    case SEARCH_WORKING:
        break;
    }
}

static void repair(struct jp_planner *planner, unsigned *budget)
{
    switch (repair_work(planner, budget)) {
    case REPAIR_DONE:
        planner->change_count = 0;
        planner->may_be_cheaper = false;
        planner->phase = planner->rekey_slot < planner->slot_count ? PHASE_REKEY : PHASE_SEARCH;
        break;
    case REPAIR_FULL:
        jp_planner_restart(planner);
        break;
    case REPAIR_WORKING:
        break;
    }
}

/** Does a part of the work that is worth at most `budget` expansions, and says how much is left. */
static unsigned work(struct jp_planner *planner, unsigned budget)
{
    unsigned share = 0;

    switch ((enum phase)planner->phase) {
    case PHASE_FIELD:
        share = budget * FIELD_CELLS_PER_EXPANSION;
        if (jp_energy_field_grow(&planner->field, &share)) {
            field_is_grown(planner);
        }
        return share / FIELD_CELLS_PER_EXPANSION;
    case PHASE_REPAIR:
        repair(planner, &budget);
        return budget;
    case PHASE_REKEY:
        share = budget * REKEYS_PER_EXPANSION;
        if (search_rekey_work(planner, &share)) {
            planner->phase = PHASE_SEARCH;
        }
        return share / REKEYS_PER_EXPANSION;
    case PHASE_SEARCH:
        search(planner, &budget);
        return budget;
    case PHASE_IDLE:
    default:
        return 0;
    }
}

enum jp_answer jp_planner_work(struct jp_planner *planner, unsigned expansions)
{
    if (is_stale(planner)) {
        return JP_ANSWER_STALE;
    }
    while (expansions > 0 && planner->phase != PHASE_IDLE) {
        expansions = work(planner, expansions);
    }
    return planner->answer;
}

/** Does all that the noted changes ask for, so that there is room for another. */
static void finish_repair(struct jp_planner *planner)
{
    while (planner->phase == PHASE_FIELD || planner->phase == PHASE_REPAIR) {
        (void)work(planner, UINT16_MAX);
    }
}

static void note_change(struct jp_planner *planner, int32_t x, int32_t y, bool may_be_cheaper)
{
    planner->answer = JP_ANSWER_OUT_OF_BUDGET;
    if (!is_ready(planner)) {
        return;
    }
    if (!planner->is_searching && planner->phase == PHASE_IDLE) {
        jp_planner_restart(planner);
        return;
    }
    if (planner->is_searching && planner->forward) {
        jp_planner_restart(planner);
        return;
    }
    if (planner->is_searching) {
        if (!repair_fits(planner, x, y)) {
            finish_repair(planner);
        }
        planner->changes[planner->change_count++] = (struct jp_cell_change){(int16_t)x, (int16_t)y};
        planner->may_be_cheaper |= may_be_cheaper;
        planner->is_repaired = true;
        planner->phase = PHASE_FIELD;
    }
    if (may_be_cheaper) {
        jp_energy_field_cell_changed(&planner->field, x, y);
    }
}

enum jp_status jp_planner_set_cell(struct jp_planner *planner, int32_t x, int32_t y, enum jp_cell cell)
{
    const bool was_clear = jp_terrain_is_clear(planner->terrain, &(const struct jp_span){0, 0, 0}, 1, x, y);
    const enum jp_status status = jp_terrain_set_cell(planner->terrain, x, y, cell);

    if (status != JP_OK) {
        return status;
    }
    planner->terrain_version++;
    const bool is_clear = jp_terrain_is_clear(planner->terrain, &(const struct jp_span){0, 0, 0}, 1, x, y);
    if (is_clear != was_clear) {
        note_change(planner, x, y, is_clear);
    }
    return JP_OK;
}

enum jp_status jp_planner_set_elevation(struct jp_planner *planner, int32_t x, int32_t y, jp_elevation elevation)
{
    const jp_elevation old = jp_terrain_elevation(planner->terrain, x, y);
    const enum jp_status status = jp_terrain_set_elevation(planner->terrain, x, y, elevation);

    if (status != JP_OK) {
        return status;
    }
    planner->terrain_version++;
    if (elevation != old) {
        note_change(planner, x, y, true);
    }
    return JP_OK;
}

bool jp_planner_is_idle(const struct jp_planner *planner)
{
    return planner->phase == PHASE_IDLE;
}

const struct jp_plan *jp_planner_plan(const struct jp_planner *planner)
{
    return &planner->plan;
}

const struct jp_primitive *jp_planner_step(const struct jp_planner *planner, unsigned index, struct jp_pose *pose)
{
    const struct jp_lattice *lattice = planner->config.lattice;

    if (index >= planner->plan.step_count) {
        return NULL;
    }
    const struct jp_primitive *primitive =
        &lattice->primitives[lattice->first_from[pose->heading] + planner->route[index]];
    pose->x = (int16_t)(pose->x + primitive->dx);
    pose->y = (int16_t)(pose->y + primitive->dy);
    pose->heading = primitive->end;
    return primitive;
}

const struct jp_planner_statistics *jp_planner_statistics(const struct jp_planner *planner)
{
    return &planner->statistics;
}
