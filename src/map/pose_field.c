#include <joulepath/pose_field.h>

#include <string.h>

#include "src/base/block.h"
#include "src/base/compiler.h"
#include "src/map/field_unit.h"
#include "src/map/terrain_cells.h"
#include "src/map/unit_step.h"

/** Few enough to be near the order of values, many enough for few sweeps. */
#define STEPS_PER_THRESHOLD 32U

#define WORD_BITS 32U

static uint16_t columns_of(const struct jp_terrain_config *config)
{
    return (uint16_t)(config->width * (unsigned)JP_HEADINGS);
}

static int32_t column_of(int32_t x, unsigned heading)
{
    return x * JP_HEADINGS + (int32_t)heading;
}

static size_t words_of(const struct jp_terrain_config *config)
{
    return ((size_t)config->width + WORD_BITS - 1U) / WORD_BITS;
}

static size_t wave_size(const struct jp_terrain_config *config)
{
    return jp_wavefront_size(columns_of(config), config->height, JP_WAVE_3_BYTES);
}

size_t jp_pose_field_size(const struct jp_terrain_config *config)
{
    return jp_terrain_size(config) == 0U || config->width > JP_POSE_FIELD_WIDTH_MAX
               ? 0U
               : wave_size(config) + words_of(config) * config->height * (size_t)JP_HEADINGS * sizeof(uint32_t);
}

enum jp_status jp_pose_field_init(struct jp_pose_field *field, const struct jp_lattice *lattice, enum jp_cost_kind kind,
                                  const struct jp_terrain *terrain, void *block, size_t size)
{
    if (field == NULL || lattice == NULL || terrain == NULL || block == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (terrain->config.width > JP_POSE_FIELD_WIDTH_MAX) {
        return JP_ERR_OUTSIDE;
    }
    if (size < jp_pose_field_size(&terrain->config)) {
        return JP_ERR_MEMORY;
    }
    if (!jp_block_is_aligned(block)) {
        return JP_ERR_ALIGNMENT;
    }
    (void)memset(field, 0, sizeof *field);
    field->terrain = terrain;
    field->kind = kind;
    field->barred = (uint32_t *)(void *)((uint8_t *)block + wave_size(&terrain->config));
    jp_wavefront_init(&field->wave, columns_of(&terrain->config), terrain->config.height, JP_WAVE_3_BYTES, block);
    jp_pose_field_set_lattice(field, lattice);
    return JP_OK;
}

void jp_pose_field_set_lattice(struct jp_pose_field *field, const struct jp_lattice *lattice)
{
    field->lattice = lattice;
    field->is_done = false;
}

/** True when the robot turns from one heading to another no cheaper by way of a third. */
static bool is_single_turn(const struct jp_turns *turns, unsigned from, unsigned to)
{
    if (from == to || turns->cost[from][to] == UINT16_MAX) {
        return false;
    }
    for (unsigned by = 0; by < JP_HEADINGS; by++) {
        if (by != from && by != to && (uint32_t)turns->cost[from][by] + turns->cost[by][to] <= turns->cost[from][to]) {
            return false;
        }
    }
    return true;
}

/** No turn is for nothing, so that no way goes round in circles. */
static void take_turns(struct jp_pose_field *field)
{
    struct jp_turns turns;

    jp_lattice_turns(field->lattice, field->kind, &turns);
    for (unsigned from = 0; from < JP_HEADINGS; from++) {
        for (unsigned to = 0; to < JP_HEADINGS; to++) {
            const uint16_t cost = turns.cost[from][to] == 0U ? 1U : turns.cost[from][to];

            if (field->sense == JP_POSE_FIELD_FROM_ROOT) {
                field->turns.cost[from][to] = cost;
            } else {
                field->turns.cost[to][from] = cost;
            }
        }
    }
}

/** Nothing on the ground multiplies what motions cost. */
static bool is_plain(const struct jp_terrain *terrain)
{
    return terrain->costs == NULL && terrain->classes == NULL;
}

/** What a step takes at least: on level ground what it takes. */
static jp_cost least_cost(const struct jp_pose_field *field, const struct jp_primitive *step)
{
    const uint8_t *moves = &field->lattice->moves[step->first_move];
    jp_cost sum = step->base[field->kind];

    for (unsigned i = 0; i < step->move_count; i++) {
        const struct jp_slope_cost *move = &field->lattice->move_costs[field->kind][jp_move_kind_of(moves[i])];

        sum = jp_cost_add(sum, field->is_level ? jp_move_cost(move, 0) : move->floor);
    }
    return sum;
}

/** A multiplied cost may be less. */
static bool has_least(const struct jp_pose_field *field, unsigned heading)
{
    return field->step[heading] != NULL && is_plain(field->terrain);
}

static void take_motions(struct jp_pose_field *field)
{
    field->is_level = field->terrain->elevation == NULL && is_plain(field->terrain);
    take_turns(field);
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        field->step[heading] = jp_unit_step(field->lattice, heading);
        field->least[heading] = has_least(field, heading) ? least_cost(field, field->step[heading]) : 0U;
        field->onward[heading] = 0;
        for (unsigned other = 0; other < JP_HEADINGS; other++) {
            const bool is_single = is_single_turn(&field->turns, heading, other);

            field->onward[heading] |= (uint16_t)(is_single ? 1U << other : 0U);
        }
    }
}

enum jp_status jp_pose_field_start(struct jp_pose_field *field, enum jp_pose_field_sense sense, int32_t x, int32_t y,
                                   uint16_t headings, jp_cost limit)
{
    if (field == NULL || headings == 0U || limit >= jp_wavefront_value_max(&field->wave)) {
        return JP_ERR_ARGUMENT;
    }
    if (!terrain_contains(field->terrain, x, y)) {
        return JP_ERR_OUTSIDE;
    }
    field->sense = sense;
    field->root_x = (uint16_t)x;
    field->root_y = (uint16_t)y;
    field->headings = headings;
    field->map_version = field->terrain->version;
    field->is_done = false;
    field->barred_rows = 0;
    take_motions(field);
    jp_wavefront_start_up_to(&field->wave, field_level_step(field->lattice, field->kind) * STEPS_PER_THRESHOLD, limit);
    return JP_OK;
}

/** Clears some poses; after the last the wave has its roots. */
static void clear(struct jp_pose_field *field)
{
    jp_wavefront_clear(&field->wave);
    if (jp_wavefront_is_clear(&field->wave)) {
        for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
            if ((((uint32_t)field->headings >> heading) & 1U) != 0U) {
                jp_wavefront_lower(&field->wave, column_of(field->root_x, heading), field->root_y, 0);
            }
        }
    }
}

/* Where steps cannot begin: 32 cells at a time. */

/** Of a row of the map, what is blocked; beyond its sides all is. */
static uint32_t blocked_word(const struct jp_terrain *terrain, int32_t row, int32_t word)
{
    const int32_t words = (int32_t)words_of(&terrain->config);
    const uint32_t over = (uint32_t)words * WORD_BITS - terrain->config.width;
    const uint32_t beyond = word + 1 == words ? ~(UINT32_MAX >> over) : 0U;

    return word < 0 || word >= words ? UINT32_MAX
                                     : terrain->blocked[(size_t)row * terrain->stride + (size_t)word] | beyond;
}

/** 64 cells of a row from a word on. */
static uint64_t blocked_words(const struct jp_terrain *terrain, int32_t row, int32_t word)
{
    return (uint64_t)blocked_word(terrain, row, word + 1) << WORD_BITS | blocked_word(terrain, row, word);
}

/** That holds a column, which may be off the map. */
static int32_t word_of(int32_t x)
{
    const uint32_t bit = (uint32_t)x % WORD_BITS;

    return (x - (int32_t)bit) / (int32_t)WORD_BITS;
}

/** Where the cells of a span are not all clear, beside the cells of a word. */
static uint32_t barred_by_span(const struct jp_terrain *terrain, const struct jp_span *span, int32_t y, int32_t word)
{
    const int32_t row = y + span->y;
    const int32_t first = word * (int32_t)WORD_BITS;
    int32_t held = word_of(first + (int32_t)span->first);
    uint64_t cells = 0;
    uint32_t barred = 0;

    if (!terrain_contains(terrain, 0, row)) {
        return UINT32_MAX;
    }
    cells = blocked_words(terrain, row, held);
    for (int32_t x = first + (int32_t)span->first; x <= first + (int32_t)span->last; x++) {
        const uint32_t bit = (uint32_t)x % WORD_BITS;

        if (word_of(x) != held) {
            held = word_of(x);
            cells = blocked_words(terrain, row, held);
        }
        barred |= (uint32_t)(cells >> bit);
    }
    return barred;
}

static uint32_t barred_word(const struct jp_pose_field *field, const struct jp_primitive *step, int32_t y, int32_t word)
{
    uint32_t barred = 0;

    for (unsigned i = 0; i < step->span_count; i++) {
        barred |= barred_by_span(field->terrain, &field->lattice->spans[step->first_span + i], y, word);
    }
    return barred;
}

static size_t barred_place(const struct jp_pose_field *field, unsigned heading, int32_t x, int32_t y)
{
    const struct jp_terrain_config *config = &field->terrain->config;

    return ((size_t)heading * config->height + (size_t)y) * words_of(config) + (size_t)x / WORD_BITS;
}

/** Of a row of cells. */
static void make_barred(struct jp_pose_field *field, int32_t y)
{
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        uint32_t *words = &field->barred[barred_place(field, heading, 0, y)];

        for (size_t i = 0; i < words_of(&field->terrain->config) && field->step[heading] != NULL; i++) {
            words[i] = barred_word(field, field->step[heading], y, (int32_t)i);
        }
    }
}

static bool is_barred(const struct jp_pose_field *field, unsigned heading, int32_t x, int32_t y)
{
    return ((field->barred[barred_place(field, heading, x, y)] >> ((uint32_t)x % WORD_BITS)) & 1U) != 0U;
}

/* Motions. */

/** Of the turn by which a way passes from one heading at a cell to another. */
static jp_cost turn_cost(const struct jp_pose_field *field, int32_t x, int32_t y, unsigned near, unsigned far)
{
    const bool is_onward = field->sense == JP_POSE_FIELD_FROM_ROOT;
    struct jp_primitive turn = {.start = (uint8_t)(is_onward ? near : far), .end = (uint8_t)(is_onward ? far : near)};

    turn.base[field->kind] = field->turns.cost[near][far];
    return jp_lattice_energy(field->lattice, field->kind, field->terrain, &turn, x, y);
}

/** The step between a pose and the next one farther from the root. */
struct pose_step {
    const struct jp_primitive *primitive;
    int32_t x; /**< the cell farther off */
    int32_t y;
    int32_t from_x; /**< where it begins */
    int32_t from_y;
};

/** False: there is none on the map. */
static bool find_step(const struct jp_pose_field *field, int32_t x, int32_t y, unsigned heading, struct pose_step *step)
{
    const struct jp_cell_offset offset = jp_move_offsets[heading];
    const bool is_onward = field->sense == JP_POSE_FIELD_FROM_ROOT;

    step->primitive = field->step[heading];
    step->x = is_onward ? x + offset.dx : x - offset.dx;
    step->y = is_onward ? y + offset.dy : y - offset.dy;
    step->from_x = is_onward ? x : step->x;
    step->from_y = is_onward ? y : step->y;
    return step->primitive != NULL && terrain_contains(field->terrain, step->x, step->y);
}

static jp_cost step_cost(const struct jp_pose_field *field, const struct pose_step *step)
{
    if (field->is_level) {
        return field->least[step->primitive->start];
    }
    return jp_lattice_energy(field->lattice, field->kind, field->terrain, step->primitive, step->from_x, step->from_y);
}

static bool is_step_clear(const struct jp_pose_field *field, const struct pose_step *step)
{
    return jp_lattice_is_clear(field->lattice, field->terrain, step->primitive, step->from_x, step->from_y);
}

/** The headings of a cell. */
struct cell_poses {
    int32_t x;
    int32_t y;
    uint32_t value[JP_HEADINGS];
    uint32_t lowered; /**< by turns: bits */
    bool is_plain;    /**< the ground: turns take what they take anywhere */
};

/** Turns from a heading; those that it lowers and that the wave has come to are to be looked at: bits. */
static uint32_t relax_turns(const struct jp_pose_field *field, struct cell_poses *cell, unsigned heading)
{
    const uint32_t here = cell->value[heading];
    uint32_t open = 0;

    for (uint32_t rest = field->onward[heading]; rest != 0U; rest &= rest - 1U) {
        const unsigned other = JP_TRAILING_ZEROS(rest);

        if (cell->value[other] > here) {
            const uint32_t turn =
                cell->is_plain ? field->turns.cost[heading][other] : turn_cost(field, cell->x, cell->y, heading, other);
            const uint32_t value = here + turn;

            if (value < cell->value[other] && value <= field->wave.horizon) {
                cell->value[other] = value;
                cell->lowered |= UINT32_C(1) << other;
                open |= value <= field->wave.threshold ? UINT32_C(1) << other : 0U;
            }
        }
    }
    return open;
}

/** All turns from these headings: bits. Returns the headings from which steps lead on now. */
static uint32_t settle_turns(struct jp_pose_field *field, struct cell_poses *cell, uint32_t headings)
{
    uint32_t settled = headings;
    uint32_t open = headings;

    while (open != 0U) {
        const unsigned heading = JP_TRAILING_ZEROS(open);

        open &= open - 1U;
        const uint32_t more = relax_turns(field, cell, heading);

        open |= more;
        settled |= more;
    }
    for (uint32_t rest = cell->lowered; rest != 0U; rest &= rest - 1U) {
        const unsigned heading = JP_TRAILING_ZEROS(rest);

        if (((settled >> heading) & 1U) != 0U) {
            jp_wavefront_settle(&field->wave, column_of(cell->x, heading), cell->y, cell->value[heading]);
        } else {
            jp_wavefront_lower(&field->wave, column_of(cell->x, heading), cell->y, cell->value[heading]);
        }
    }
    return settled;
}

static void relax_step(struct jp_pose_field *field, int32_t x, int32_t y, unsigned heading, uint32_t here)
{
    struct jp_wavefront *wave = &field->wave;
    struct pose_step step;

    if (!find_step(field, x, y, heading, &step)) {
        return;
    }
    const uint32_t there = jp_wavefront_value(wave, column_of(step.x, heading), step.y);

    if (there <= here + field->least[heading]) {
        return;
    }
    const uint32_t value = here + step_cost(field, &step);

    if (value < there && value <= wave->horizon && !is_barred(field, heading, step.from_x, step.from_y)) {
        jp_wavefront_lower(wave, column_of(step.x, heading), step.y, value);
    }
}

/** From a cell of which a heading was handed out. */
static void relax_cell(struct jp_pose_field *field, int32_t column, int32_t y, unsigned *poses)
{
    struct cell_poses cell = {.x = column / JP_HEADINGS, .y = y, .is_plain = is_plain(field->terrain)};
    const uint32_t taken = jp_wavefront_take_group(&field->wave, column, y);

    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        cell.value[heading] = jp_wavefront_value(&field->wave, column_of(cell.x, heading), y);
    }
    const uint32_t settled = settle_turns(field, &cell, taken);

    for (uint32_t rest = settled; rest != 0U; rest &= rest - 1U) {
        const unsigned heading = JP_TRAILING_ZEROS(rest);

        relax_step(field, cell.x, y, heading, cell.value[heading]);
        *poses -= *poses > 0U ? 1U : 0U;
    }
}

bool jp_pose_field_grow(struct jp_pose_field *field, unsigned *poses)
{
    int32_t column = 0;
    int32_t y = 0;

    while (*poses > 0U && !field->is_done) {
        if (!jp_wavefront_is_clear(&field->wave)) {
            clear(field);
            --*poses;
            continue;
        }
        if (field->barred_rows < field->terrain->config.height) {
            make_barred(field, field->barred_rows);
            field->barred_rows++;
            *poses -= *poses < field->terrain->config.width ? *poses : field->terrain->config.width;
            continue;
        }
        const enum jp_wave_step step = jp_wavefront_next(&field->wave, poses, &column, &y);

        field->is_done = step == JP_WAVE_STOPPED;
        if (step == JP_WAVE_CELL) {
            relax_cell(field, column, y, poses);
        }
    }
    return field->is_done;
}

jp_cost jp_pose_field_cost(const struct jp_pose_field *field, int32_t x, int32_t y, unsigned heading)
{
    if (!field->is_done || !terrain_contains(field->terrain, x, y)) {
        return JP_COST_MAX;
    }
    const uint32_t value = jp_wavefront_value(&field->wave, column_of(x, heading), y);

    return value == field->wave.not_reached ? JP_COST_MAX : value;
}

jp_cost jp_pose_field_least(const struct jp_pose_field *field, int32_t x, int32_t y)
{
    jp_cost least = JP_COST_MAX;

    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const jp_cost cost = jp_pose_field_cost(field, x, y, heading);

        least = cost < least ? cost : least;
    }
    return least;
}

/** The motion by which a pose got its value leads from a pose whose value and cost add up to it. */
static bool next_by_step(const struct jp_pose_field *field, struct jp_lattice_pose *pose, jp_cost here)
{
    const struct jp_cell_offset offset = jp_move_offsets[pose->heading];
    const bool is_onward = field->sense == JP_POSE_FIELD_FROM_ROOT;
    const int32_t x = is_onward ? pose->x - offset.dx : pose->x + offset.dx;
    const int32_t y = is_onward ? pose->y - offset.dy : pose->y + offset.dy;
    const jp_cost there = jp_pose_field_cost(field, x, y, pose->heading);
    struct pose_step step;

    if (there == JP_COST_MAX || !find_step(field, x, y, pose->heading, &step) ||
        there + step_cost(field, &step) != here || !is_step_clear(field, &step)) {
        return false;
    }
    pose->x = (int16_t)x;
    pose->y = (int16_t)y;
    return true;
}

static bool next_by_turn(const struct jp_pose_field *field, struct jp_lattice_pose *pose, jp_cost here)
{
    for (unsigned other = 0; other < JP_HEADINGS; other++) {
        const jp_cost there = jp_pose_field_cost(field, pose->x, pose->y, other);

        if ((((uint32_t)field->onward[other] >> pose->heading) & 1U) != 0U && there != JP_COST_MAX &&
            there + turn_cost(field, pose->x, pose->y, other, pose->heading) == here) {
            pose->heading = (uint8_t)other;
            return true;
        }
    }
    return false;
}

bool jp_pose_field_next(const struct jp_pose_field *field, struct jp_lattice_pose *pose)
{
    const jp_cost here = jp_pose_field_cost(field, pose->x, pose->y, pose->heading);

    return here != JP_COST_MAX && here != 0U && (next_by_step(field, pose, here) || next_by_turn(field, pose, here));
}

bool jp_pose_field_is_outdated(const struct jp_pose_field *field)
{
    return field->map_version != field->terrain->version;
}
