#include <joulepath/pose_field.h>

#include <string.h>

#include "src/base/block.h"
#include "src/base/compiler.h"
#include "src/map/field_unit.h"
#include "src/map/terrain_cells.h"
#include "src/map/unit_step.h"

/** Few enough to be near the order of values, many enough for few sweeps. */
#define STEPS_PER_THRESHOLD 32U

static uint16_t rows_of(const struct jp_terrain_config *config)
{
    return (uint16_t)(config->height * (unsigned)JP_HEADINGS);
}

static int32_t row_of(int32_t y, unsigned heading)
{
    return y * JP_HEADINGS + (int32_t)heading;
}

size_t jp_pose_field_size(const struct jp_terrain_config *config)
{
    return jp_terrain_size(config) == 0U || config->height > JP_POSE_FIELD_HEIGHT_MAX
               ? 0U
               : jp_wavefront_size(config->width, rows_of(config), JP_WAVE_3_BYTES);
}

enum jp_status jp_pose_field_init(struct jp_pose_field *field, const struct jp_lattice *lattice, enum jp_cost_kind kind,
                                  const struct jp_terrain *terrain, void *block, size_t size)
{
    if (field == NULL || lattice == NULL || terrain == NULL || block == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (terrain->config.height > JP_POSE_FIELD_HEIGHT_MAX) {
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
    jp_wavefront_init(&field->wave, terrain->config.width, rows_of(&terrain->config), JP_WAVE_3_BYTES, block);
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
    jp_lattice_turns(field->lattice, field->kind, &field->turns);
    for (unsigned from = 0; from < JP_HEADINGS; from++) {
        for (unsigned to = 0; to < JP_HEADINGS; to++) {
            if (field->turns.cost[from][to] == 0U) {
                field->turns.cost[from][to] = 1;
            }
        }
    }
}

static void take_motions(struct jp_pose_field *field)
{
    take_turns(field);
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        field->step[heading] = jp_unit_step(field->lattice, heading);
        field->onward[heading] = 0;
        for (unsigned other = 0; other < JP_HEADINGS; other++) {
            const bool is_single = field->sense == JP_POSE_FIELD_FROM_ROOT
                                       ? is_single_turn(&field->turns, heading, other)
                                       : is_single_turn(&field->turns, other, heading);

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
                jp_wavefront_lower(&field->wave, field->root_x, row_of(field->root_y, heading), 0);
            }
        }
    }
}

/** Of the turn by which a way passes from one heading at a cell to another. */
static jp_cost turn_cost(const struct jp_pose_field *field, int32_t x, int32_t y, unsigned near, unsigned far)
{
    const bool is_onward = field->sense == JP_POSE_FIELD_FROM_ROOT;
    struct jp_primitive turn = {.start = (uint8_t)(is_onward ? near : far), .end = (uint8_t)(is_onward ? far : near)};

    turn.base[field->kind] = field->turns.cost[turn.start][turn.end];
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
    return jp_lattice_energy(field->lattice, field->kind, field->terrain, step->primitive, step->from_x, step->from_y);
}

static bool is_step_clear(const struct jp_pose_field *field, const struct pose_step *step)
{
    return jp_lattice_is_clear(field->lattice, field->terrain, step->primitive, step->from_x, step->from_y);
}

static void relax_turns(struct jp_pose_field *field, int32_t x, int32_t y, unsigned heading, uint32_t here)
{
    struct jp_wavefront *wave = &field->wave;

    for (uint32_t rest = field->onward[heading]; rest != 0U; rest &= rest - 1U) {
        const unsigned other = JP_TRAILING_ZEROS(rest);
        const uint32_t there = jp_wavefront_value(wave, x, row_of(y, other));

        if (there > here) {
            const uint32_t value = here + turn_cost(field, x, y, heading, other);

            if (value < there && value <= wave->horizon) {
                jp_wavefront_lower(wave, x, row_of(y, other), value);
            }
        }
    }
}

static void relax_step(struct jp_pose_field *field, int32_t x, int32_t y, unsigned heading, uint32_t here)
{
    struct jp_wavefront *wave = &field->wave;
    struct pose_step step;

    if (!find_step(field, x, y, heading, &step)) {
        return;
    }
    const uint32_t there = jp_wavefront_value(wave, step.x, row_of(step.y, heading));

    if (there <= here) {
        return;
    }
    const uint32_t value = here + step_cost(field, &step);

    if (value < there && value <= wave->horizon && is_step_clear(field, &step)) {
        jp_wavefront_lower(wave, step.x, row_of(step.y, heading), value);
    }
}

bool jp_pose_field_grow(struct jp_pose_field *field, unsigned *poses)
{
    int32_t x = 0;
    int32_t row = 0;

    while (*poses > 0U && !field->is_done) {
        if (!jp_wavefront_is_clear(&field->wave)) {
            clear(field);
            --*poses;
            continue;
        }
        const enum jp_wave_step step = jp_wavefront_next(&field->wave, poses, &x, &row);

        field->is_done = step == JP_WAVE_STOPPED;
        if (step == JP_WAVE_CELL) {
            const uint32_t here = jp_wavefront_value(&field->wave, x, row);
            const unsigned heading = (unsigned)row % (unsigned)JP_HEADINGS;

            relax_step(field, x, row / JP_HEADINGS, heading, here);
            relax_turns(field, x, row / JP_HEADINGS, heading, here);
        }
    }
    return field->is_done;
}

jp_cost jp_pose_field_cost(const struct jp_pose_field *field, int32_t x, int32_t y, unsigned heading)
{
    if (!field->is_done || !terrain_contains(field->terrain, x, y)) {
        return JP_COST_MAX;
    }
    const uint32_t value = jp_wavefront_value(&field->wave, x, row_of(y, heading));

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
