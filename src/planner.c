#include <joulepath/planner.h>
#include <string.h>

#include "planner_repair.h"
#include "planner_route.h"
#include "planner_search.h"
#include "planner_states.h"

enum phase {
    PHASE_IDLE,   /* nothing to do */
    PHASE_GUIDE,  /* the guide field grows */
    PHASE_FIELD,  /* the energy field grows, or is repaired */
    PHASE_REPAIR, /* states learn of changed cells */
    PHASE_REKEY,  /* the queue is sorted for another ε */
    PHASE_SEARCH
};

enum {
    ALIGNMENT = 8,
    STATES_MIN = 64,
    EPSILON_RAISE_DIVISOR = 4,
    GUIDE_SCALE_MIN = 2,
    GUIDE_SHARE = 4, /* the guide takes at most this part of the block, if it can be that coarse */
    ROUTE_STEPS_MIN = 256,
    ROUTES = 2,                /* the plan's and the one that is being traced */
    CELLS_PER_ROUTE_STEP = 32, /* of the map: room for a route that winds through all of it */
    /* So much of other work is worth one expansion. */
    FIELD_CELLS_PER_EXPANSION = 8,
    GUIDE_CELLS_PER_EXPANSION = 1,
    REKEYS_PER_EXPANSION = 32,
    REPAIRS_PER_EXPANSION = 1,
};

_Static_assert(JP_PLANNER_CELLS_MAX / JP_TERRAIN_SIDE_MAX >= JP_TERRAIN_SIDE_MAX, "no map is too large");

static size_t route_bytes(const struct jp_terrain_config *config)
{
    const size_t steps = ROUTE_STEPS_MIN + (size_t)config->width * config->height / CELLS_PER_ROUTE_STEP;

    return (steps + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

size_t jp_planner_size_min(const struct jp_terrain_config *config)
{
    if (jp_terrain_size(config) == 0U) {
        return 0;
    }
    return jp_guide_field_size(config, JP_GUIDE_SCALE_MAX) + ROUTES * route_bytes(config) +
           jp_planner_states_size(STATES_MIN);
}

/** The finest guide that leaves most of the block to the states, and enough of them. */
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
    return jp_planner_size_min(&terrain->config) == 0U ? "terrain" : NULL;
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

/** Guide, route, and if a state for every cell fits too, the energy field; the states get the rest. */
static void lay_out(struct jp_planner *planner, uint8_t *block, size_t size)
{
    const struct jp_planner_config *config = &planner->config;
    const struct jp_terrain_config *map = &planner->terrain->config;
    const unsigned scale = guide_scale(map, size);
    const size_t guide_bytes = jp_guide_field_size(map, scale);
    const size_t field_bytes = jp_energy_field_size(map);
    size_t used = guide_bytes + ROUTES * route_bytes(map);

    jp_guide_field_init(&planner->guide, config->lattice, config->cost, planner->terrain, &planner->turns, scale,
                        block);
    planner->route = &block[guide_bytes];
    planner->spare_route = &planner->route[route_bytes(map)];
    planner->route_max = (uint16_t)route_bytes(map);
    planner->statistics.guide_bytes = (uint32_t)guide_bytes;
    if (used + field_bytes + jp_planner_states_size((uint32_t)map->width * map->height) <= size) {
        jp_energy_field_init(&planner->field, config->lattice, config->cost, planner->terrain, &block[used]);
        planner->statistics.field_bytes = (uint32_t)field_bytes;
        used += field_bytes;
    }
    jp_planner_states_init(planner, &block[used], size - used);
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
    (void)memset(planner, 0, sizeof *planner);
    planner->config = *config;
    planner->terrain = terrain;
    planner->terrain_version = terrain->version;
    jp_lattice_turns(config->lattice, config->cost, &planner->turns);
    planner->neighbours_max = neighbours_max(config->lattice);
    lay_out(planner, block, size);
    jp_planner_states_clear(planner);
    return JP_OK;
}

static bool is_ready(const struct jp_planner *planner)
{
    return planner->has_start && planner->has_goal;
}

static bool has_field(const struct jp_planner *planner)
{
    return planner->statistics.field_bytes > 0U;
}

static void begin_field(struct jp_planner *planner)
{
    planner->is_field_begun = true;
    planner->field_heading = planner->start.heading;
    jp_energy_field_start(&planner->field, planner->start.x, planner->start.y, planner->goal.x, planner->goal.y);
    planner->phase = PHASE_FIELD;
}

/** Grows the guide from the search's target. */
static void begin_guide(struct jp_planner *planner)
{
    const struct jp_pose *start = &planner->start;
    const struct jp_goal *goal = &planner->goal;

    if (planner->forward) {
        const struct jp_guide_root root = {(uint16_t)goal->x, (uint16_t)goal->y, goal->headings};
        jp_guide_field_start(&planner->guide, JP_GUIDE_TO_ROOT, &root, (uint16_t)start->x, (uint16_t)start->y);
    } else {
        const struct jp_guide_root root = {(uint16_t)start->x, (uint16_t)start->y, (uint16_t)(1U << start->heading)};
        jp_guide_field_start(&planner->guide, JP_GUIDE_FROM_ROOT, &root, (uint16_t)goal->x, (uint16_t)goal->y);
    }
    planner->phase = PHASE_GUIDE;
}

/** From scratch; the search follows when its field has grown. */
static void begin(struct jp_planner *planner, bool forward)
{
    planner->forward = forward;
    planner->is_searching = false;
    planner->is_repaired = false;
    planner->is_field_begun = false;
    planner->is_exact = false;
    planner->change_count = 0;
    planner->may_be_cheaper = false;
    if (planner->epsilon == JP_EPSILON_ONE && has_field(planner)) {
        begin_field(planner);
    } else {
        begin_guide(planner);
    }
}

void jp_planner_restart(struct jp_planner *planner)
{
    planner->terrain_version = planner->terrain->version;
    planner->answer = JP_ANSWER_OUT_OF_BUDGET;
    planner->level = 0;
    planner->epsilon = planner->config.epsilon[0];
    if (is_ready(planner)) {
        planner->statistics.restarts++;
        begin(planner, false);
    }
}

enum jp_status jp_planner_set_lattice(struct jp_planner *planner, const struct jp_lattice *lattice)
{
    if (planner == NULL || lattice == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (lattice->moves != planner->config.lattice->moves) {
        return JP_ERR_CONFIG;
    }
    planner->config.lattice = lattice;
    planner->guide.lattice = lattice;
    planner->field.lattice = lattice;
    jp_lattice_turns(lattice, planner->config.cost, &planner->turns);
    jp_planner_restart(planner);
    return JP_OK;
}

/** Sorts the queue anew where the energy field takes over, or where states wait to be looked at again. */
static void resume(struct jp_planner *planner)
{
    const bool is_exact = planner->is_field_begun && planner->epsilon == JP_EPSILON_ONE;

    if (is_exact != planner->is_exact || !is_exact) {
        planner->is_exact = is_exact;
        jp_search_rekey(planner, false);
    }
    planner->phase = planner->rekey_slot < planner->slot_count ? PHASE_REKEY : PHASE_SEARCH;
}

/** True when the search's field is rooted, and the search has not begun. */
static bool is_beginning(const struct jp_planner *planner)
{
    return planner->phase != PHASE_IDLE && !planner->is_searching && !planner->forward;
}

/** True when the robot is where the energy field's root cannot get to: the field says nothing of its ways. */
static bool is_cut_off(const struct jp_planner *planner)
{
    return planner->is_field_begun &&
           jp_energy_field_bound(&planner->field, planner->start.x, planner->start.y) == JP_COST_MAX;
}

enum jp_status jp_planner_set_start(struct jp_planner *planner, const struct jp_pose *start)
{
    if (planner == NULL || start == NULL || start->heading >= JP_HEADINGS) {
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
    if (is_beginning(planner)) {
        return JP_OK; /* a field rooted where the robot was serves too */
    }
    if (!planner->is_searching || planner->forward || (planner->phase != PHASE_FIELD && is_cut_off(planner))) {
        jp_planner_restart(planner);
        return JP_OK;
    }
    planner->is_repaired = true;
    if (planner->phase == PHASE_IDLE || planner->phase == PHASE_SEARCH) {
        resume(planner);
    }
    return JP_OK;
}

enum jp_status jp_planner_set_goal(struct jp_planner *planner, const struct jp_goal *goal)
{
    bool fits = false;

    if (planner == NULL || goal == NULL || goal->headings == 0U) {
        return JP_ERR_ARGUMENT;
    }
    if (!jp_terrain_contains(planner->terrain, goal->x, goal->y)) {
        return JP_ERR_OUTSIDE;
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        fits |= ((goal->headings >> heading) & 1U) != 0U &&
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

static void begin_search(struct jp_planner *planner)
{
    planner->is_exact = planner->is_field_begun && planner->epsilon == JP_EPSILON_ONE;
    planner->is_searching = true;
    planner->is_alone = true;
    jp_search_start(planner);
    planner->phase = PHASE_SEARCH;
}

/** Where the guide sees no way the energy field can prove that there is none. */
static void guide_is_grown(struct jp_planner *planner)
{
    if (!planner->forward && has_field(planner) &&
        !jp_guide_field_reaches(&planner->guide, planner->goal.x, planner->goal.y)) {
        begin_field(planner);
    } else {
        begin_search(planner);
    }
}

static void field_is_grown(struct jp_planner *planner)
{
    const struct jp_cell_box lowered = jp_energy_field_take_lowered(&planner->field);

    if (is_cut_off(planner)) {
        jp_planner_restart(planner);
    } else if (planner->is_searching) {
        if (planner->is_exact) {
            jp_search_rekey_cells(planner, &lowered);
        }
        planner->repair_cursor = 0;
        planner->phase = PHASE_REPAIR;
    } else if (jp_energy_field_bound(&planner->field, planner->goal.x, planner->goal.y) == JP_COST_MAX) {
        finish(planner, JP_ANSWER_UNREACHABLE);
    } else {
        begin_search(planner);
    }
}

/** The next smaller ε of the schedule. False when there is none, or nothing can be better. */
static bool take_next_epsilon(struct jp_planner *planner)
{
    const unsigned next = planner->level + 1U;

    if (planner->answer != JP_ANSWER_WITHIN_BOUND || planner->forward || next == JP_EPSILON_LEVELS ||
        planner->config.epsilon[next] == 0U) {
        return false;
    }
    planner->level = (uint8_t)next;
    planner->epsilon = planner->config.epsilon[next];
    return true;
}

/** After a plan: on with the states that there are. */
static void improve(struct jp_planner *planner)
{
    planner->answer = planner->plan.answer;
    planner->phase = PHASE_IDLE;
    if (!take_next_epsilon(planner)) {
        return;
    }
    planner->is_alone = false;
    if (planner->epsilon == JP_EPSILON_ONE && has_field(planner) && !planner->is_field_begun) {
        begin_field(planner);
    } else {
        resume(planner);
    }
}

/** The states do not fit, and there is a plan: this ε once more without the states of those before it, then the next.
 */
static void improve_from_scratch(struct jp_planner *planner)
{
    if (!planner->is_exact && (!planner->is_alone || take_next_epsilon(planner))) {
        begin_search(planner);
    } else {
        planner->phase = PHASE_IDLE;
    }
}

/** The states do not fit: search with less care, at last from the robot. */
static void table_is_full(struct jp_planner *planner)
{
    if (planner->answer != JP_ANSWER_OUT_OF_BUDGET) {
        improve_from_scratch(planner);
    } else if (planner->is_repaired) {
        jp_planner_restart(planner);
    } else if (planner->forward) {
        finish(planner, jp_route_publish(planner) ? planner->plan.answer : JP_ANSWER_OUT_OF_BUDGET);
    } else if (planner->epsilon < JP_EPSILON_MAX) {
        const unsigned epsilon = planner->epsilon + planner->epsilon / EPSILON_RAISE_DIVISOR;
        planner->epsilon = (uint16_t)(epsilon < JP_EPSILON_MAX ? epsilon : JP_EPSILON_MAX);
        begin_search(planner);
    } else {
        begin(planner, true);
    }
}

static void search(struct jp_planner *planner, unsigned *budget)
{
    switch (jp_search_expand(planner, budget)) {
    case SEARCH_FOUND:
        if (jp_route_publish(planner)) {
            improve(planner);
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
        jp_search_rekey(planner, true);
        planner->phase = PHASE_REKEY;
        break;
    case SEARCH_WORKING:
    default:
        break;
    }
}

/** When the proved route is lost, the guide finds the next one sooner than the proof does. */
static void states_are_repaired(struct jp_planner *planner)
{
    planner->change_count = 0;
    planner->may_be_cheaper = false;
    if (planner->is_exact && !jp_route_is_intact(planner)) {
        planner->level = 0;
        planner->epsilon = planner->config.epsilon[0];
        planner->is_alone = false;
    }
    resume(planner);
}

static void repair(struct jp_planner *planner, unsigned *budget)
{
    switch (planner->change_count == 0U ? REPAIR_DONE : jp_repair_work(planner, budget)) {
    case REPAIR_DONE:
        states_are_repaired(planner);
        break;
    case REPAIR_FULL:
        jp_planner_restart(planner);
        break;
    case REPAIR_WORKING:
    default:
        break;
    }
}

/** Does a part of the work that is worth at most `budget` expansions, and says how much is left. */
static unsigned work(struct jp_planner *planner, unsigned budget)
{
    unsigned share = 0;

    switch ((enum phase)planner->phase) {
    case PHASE_GUIDE:
        share = budget * GUIDE_CELLS_PER_EXPANSION;
        if (jp_guide_field_grow(&planner->guide, &share)) {
            guide_is_grown(planner);
        }
        return share / GUIDE_CELLS_PER_EXPANSION;
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
        if (jp_search_rekey_work(planner, &share)) {
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
    while (expansions > 0U) {
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
    if (planner->is_searching && !jp_repair_fits(planner, x, y)) {
        finish_repair(planner); /* begins anew when the states do not fit */
    }
    planner->answer = JP_ANSWER_OUT_OF_BUDGET;
    if (!is_ready(planner)) {
        return;
    }
    if (planner->forward || (!planner->is_searching && planner->phase == PHASE_IDLE)) {
        jp_planner_restart(planner);
        return;
    }
    if (planner->is_searching) {
        planner->changes[planner->change_count] = (struct jp_cell_change){(int16_t)x, (int16_t)y};
        planner->change_count++;
        planner->may_be_cheaper |= may_be_cheaper;
        planner->is_repaired = true;
        planner->repair_cursor = 0;
        planner->phase = planner->is_field_begun ? PHASE_FIELD : PHASE_REPAIR;
    }
    if (may_be_cheaper && planner->is_field_begun) {
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

const struct jp_planner_counts *jp_planner_statistics(const struct jp_planner *planner)
{
    return &planner->statistics;
}
