#include <joulepath/pose_field.h>

#include <string.h>

#include "src/base/block.h"
#include "src/base/compiler.h"
#include "src/map/barred_steps.h"
#include "src/map/field_unit.h"
#include "src/map/pose_turns.h"
#include "src/map/pose_wave.h"
#include "src/map/terrain_cells.h"
#include "src/map/unit_step.h"

/** Few enough to be near the order of values, many enough for few sweeps. */
#define STEPS_PER_THRESHOLD 32U

/** Of a heading, that are prepared while a pose is dealt with. */
#define CELLS_PER_POSE 8U

static size_t barred_size(const struct jp_terrain_config *map)
{
    return jp_block_align((size_t)map->width * map->height * sizeof(uint16_t));
}

size_t jp_pose_field_size(const struct jp_terrain_config *config)
{
    return jp_terrain_size(config) == 0U ? 0U : jp_pose_wave_size(config) + barred_size(config);
}

enum jp_status jp_pose_field_init(struct jp_pose_field *field, const struct jp_lattice *lattice, enum jp_cost_kind kind,
                                  const struct jp_terrain *terrain, void *block, size_t size)
{
    if (field == NULL || lattice == NULL || terrain == NULL || block == NULL) {
        return JP_ERR_ARGUMENT;
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
    field->barred = (uint16_t *)(void *)((uint8_t *)block + jp_pose_wave_size(&terrain->config));
    jp_pose_wave_init(&field->wave, &terrain->config, block);
    jp_pose_field_set_lattice(field, lattice);
    return JP_OK;
}

void jp_pose_field_set_lattice(struct jp_pose_field *field, const struct jp_lattice *lattice)
{
    field->lattice = lattice;
    field->is_done = false;
}

/** The step of a heading, without what it costs. */
static struct jp_pose_step step_of(const struct jp_pose_field *field, unsigned heading)
{
    const struct jp_cell_offset offset = jp_move_offsets[heading];
    const struct jp_cell_offset back = {(int8_t)-offset.dx, (int8_t)-offset.dy};
    const bool is_onward = field->sense == JP_POSE_FIELD_FROM_ROOT;
    const struct jp_cell_offset end = is_onward ? offset : back;

    return (struct jp_pose_step){
        .primitive = jp_unit_step(field->lattice, heading),
        .move = &field->lattice->move_costs[field->kind][jp_move_kind_of(heading)],
        .outward = end.dy * (int32_t)field->terrain->config.width + end.dx,
        .end = end,
        .begin = is_onward ? (struct jp_cell_offset){0, 0} : back,
    };
}

/** What a step takes at least, on level ground what it takes: a cost that the ground multiplies is not less. */
static jp_cost least_cost(const struct jp_pose_field *field, const struct jp_pose_step *step)
{
    return step->primitive->base[field->kind] + (field->is_level ? jp_move_cost(step->move, 0) : step->move->floor);
}

static void take_motions(struct jp_pose_field *field)
{
    field->is_plain = field->terrain->costs == NULL && field->terrain->classes == NULL;
    field->is_level = field->is_plain && field->terrain->elevation == NULL;
    jp_pose_turns_take(field);
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        struct jp_pose_step *step = &field->step[heading];

        *step = step_of(field, heading);
        step->least = step->primitive != NULL ? least_cost(field, step) : 0U;
    }
}

enum jp_status jp_pose_field_start(struct jp_pose_field *field, enum jp_pose_field_sense sense, int32_t x, int32_t y,
                                   uint16_t headings, jp_cost limit)
{
    if (field == NULL || headings == 0U || limit >= JP_COST_MAX - 1U) {
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
    field->prepared = 0;
    take_motions(field);
    jp_pose_wave_start(&field->wave, field_level_step(field->lattice, field->kind) * STEPS_PER_THRESHOLD, limit);
    return JP_OK;
}

static void set_roots(struct jp_pose_field *field)
{
    const size_t cell = pose_cell(&field->wave, field->root_x, field->root_y);

    for (uint32_t rest = field->headings; rest != 0U; rest &= rest - 1U) {
        pose_lower(&field->wave, cell, field->root_y, JP_TRAILING_ZEROS(rest), 0);
    }
}

static bool is_prepared(const struct jp_pose_field *field)
{
    return field->prepared == (uint32_t)field->terrain->config.height * (uint32_t)JP_HEADINGS;
}

/** The next heading of a row of the map. After the last one the wave has its roots. */
static void prepare(struct jp_pose_field *field, unsigned *poses)
{
    const unsigned cost = field->terrain->config.width / CELLS_PER_POSE + 1U;
    const uint16_t row = (uint16_t)(field->prepared / (uint32_t)JP_HEADINGS);
    const unsigned heading = field->prepared % (uint32_t)JP_HEADINGS;
    uint16_t *barred = &field->barred[pose_cell(&field->wave, 0, row)];

    if (heading == 0U) {
        jp_pose_wave_clear_row(&field->wave, row);
        (void)memset(barred, 0, field->terrain->config.width * sizeof *barred);
    }
    jp_barred_steps(field->lattice, field->terrain, &field->step[heading], row, (uint16_t)(1U << heading), barred);
    field->prepared++;
    if (is_prepared(field)) {
        set_roots(field);
    }
    *poses -= *poses < cost ? *poses : cost;
}

/** Of a step over ground that multiplies no cost. */
static jp_cost plain_step_cost(const struct jp_pose_field *field, const struct jp_pose_step *step, int32_t x, int32_t y)
{
    const jp_elevation *here = &field->terrain->elevation[pose_cell(&field->wave, x, y)];
    const int32_t rise = here[step->outward] - here[0];
    const jp_cost move = jp_move_cost(step->move, field->sense == JP_POSE_FIELD_FROM_ROOT ? rise : -rise);

    return jp_cost_add(step->primitive->base[field->kind], move);
}

/** Of the step from a pose outward. */
static jp_cost step_cost(const struct jp_pose_field *field, int32_t x, int32_t y, unsigned heading)
{
    const struct jp_pose_step *step = &field->step[heading];

    if (field->is_level) {
        return step->least;
    }
    return field->is_plain ? plain_step_cost(field, step, x, y)
                           : jp_lattice_energy(field->lattice, field->kind, field->terrain, step->primitive,
                                               x + step->begin.dx, y + step->begin.dy);
}

static void load_cell(const struct jp_pose_field *field, const struct jp_pose_group *group, struct jp_cell_poses *cell)
{
    cell->cell = pose_cell(&field->wave, group->x, group->y);
    cell->x = group->x;
    cell->y = group->y;
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        cell->value[heading] = pose_value(&field->wave, cell->cell, heading);
    }
    cell->open = group->headings;
    cell->lowered = 0;
    cell->settled = 0;
}

static void store_turns(struct jp_pose_field *field, const struct jp_cell_poses *cell)
{
    for (uint32_t rest = cell->lowered & cell->settled; rest != 0U; rest &= rest - 1U) {
        const unsigned heading = JP_TRAILING_ZEROS(rest);

        pose_settle(&field->wave, cell->cell, heading, cell->value[heading]);
    }
    for (uint32_t rest = cell->lowered & ~cell->settled; rest != 0U; rest &= rest - 1U) {
        const unsigned heading = JP_TRAILING_ZEROS(rest);

        pose_lower(&field->wave, cell->cell, cell->y, heading, cell->value[heading]);
    }
    pose_deal(&field->wave, cell->cell, cell->settled);
}

static void relax_step(struct jp_pose_field *field, const struct jp_cell_poses *cell, unsigned heading)
{
    const struct jp_pose_step *step = &field->step[heading];
    const int32_t end = (int32_t)cell->cell + step->outward;
    const jp_cost here = cell->value[heading];
    const jp_cost there = pose_value(&field->wave, (size_t)end, heading);

    if (here + step->least < there) {
        const jp_cost value = here + step_cost(field, cell->x, cell->y, heading);

        if (value < there) {
            pose_lower(&field->wave, (size_t)end, cell->y + step->end.dy, heading, value);
        }
    }
}

static void relax_steps(struct jp_pose_field *field, const struct jp_cell_poses *cell)
{
    const uint32_t barred = field->barred[cell->cell];

    for (uint32_t rest = cell->settled & ~barred; rest != 0U; rest &= rest - 1U) {
        relax_step(field, cell, JP_TRAILING_ZEROS(rest));
    }
}

/** Motions from poses of a cell that were handed out. */
static void relax_group(struct jp_pose_field *field, const struct jp_pose_group *group, unsigned *poses)
{
    struct jp_cell_poses cell;

    load_cell(field, group, &cell);
    const unsigned settled = jp_pose_turns_settle(field, &cell);

    store_turns(field, &cell);
    relax_steps(field, &cell);
    *poses -= *poses < settled ? *poses : settled;
}

bool jp_pose_field_grow(struct jp_pose_field *field, unsigned *poses)
{
    while (*poses > 0U && !field->is_done) {
        struct jp_pose_group group;

        if (!is_prepared(field)) {
            prepare(field, poses);
            continue;
        }
        const enum jp_pose_wave_step step = jp_pose_wave_next(&field->wave, poses, &group);

        field->is_done = step == JP_POSE_WAVE_STOPPED;
        if (step == JP_POSE_WAVE_CELL) {
            relax_group(field, &group, poses);
        }
    }
    return field->is_done;
}

jp_cost jp_pose_field_cost(const struct jp_pose_field *field, int32_t x, int32_t y, unsigned heading)
{
    if (!field->is_done || !terrain_contains(field->terrain, x, y)) {
        return JP_COST_MAX;
    }
    const jp_cost value = pose_value(&field->wave, pose_cell(&field->wave, x, y), heading);

    return value <= field->wave.limit ? value : JP_COST_MAX;
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
    const struct jp_pose_step *step = &field->step[pose->heading];
    const int32_t x = pose->x - step->end.dx;
    const int32_t y = pose->y - step->end.dy;
    const jp_cost there = jp_pose_field_cost(field, x, y, pose->heading);

    if (there == JP_COST_MAX || step->primitive == NULL || there + step_cost(field, x, y, pose->heading) != here ||
        !jp_lattice_is_clear(field->lattice, field->terrain, step->primitive, x + step->begin.dx, y + step->begin.dy)) {
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
            there + jp_pose_turns_cost(field, pose->x, pose->y, other, pose->heading) == here) {
            pose->heading = (uint8_t)other;
            return true;
        }
    }
    return false;
}

bool jp_pose_field_next(const struct jp_pose_field *field, struct jp_lattice_pose *pose)
{
    const jp_cost here = jp_pose_field_cost(field, pose->x, pose->y, pose->heading);

    /* No motion is for nothing: none leads on from a root. */
    return here != JP_COST_MAX && (next_by_step(field, pose, here) || next_by_turn(field, pose, here));
}

bool jp_pose_field_is_outdated(const struct jp_pose_field *field)
{
    return field->map_version != field->terrain->version;
}
