#include "src/map/pose_turns.h"

#include "src/base/compiler.h"

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
static void take_costs(struct jp_pose_field *field)
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

void jp_pose_turns_take(struct jp_pose_field *field)
{
    take_costs(field);
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        field->onward[heading] = 0;
        for (unsigned other = 0; other < JP_HEADINGS; other++) {
            const bool is_single = is_single_turn(&field->turns, heading, other);

            field->onward[heading] |= (uint16_t)(is_single ? 1U << other : 0U);
        }
    }
}

jp_cost jp_pose_turns_cost(const struct jp_pose_field *field, int32_t x, int32_t y, unsigned near, unsigned far)
{
    const bool is_onward = field->sense == JP_POSE_FIELD_FROM_ROOT;
    struct jp_primitive turn = {.start = (uint8_t)(is_onward ? near : far), .end = (uint8_t)(is_onward ? far : near)};

    turn.base[field->kind] = field->turns.cost[near][far];
    return jp_lattice_energy(field->lattice, field->kind, field->terrain, &turn, x, y);
}

/** Turns from a heading to those that are not settled: what costs least is settled first, so that each heading is
 *  looked at once. */
static void relax(const struct jp_pose_field *field, struct jp_cell_poses *cell, unsigned heading)
{
    const uint16_t *costs = field->turns.cost[heading];
    const jp_cost threshold = field->wave.threshold;
    const jp_cost here = cell->value[heading];
    jp_cost *values = cell->value;
    uint32_t lowered = 0;

    for (uint32_t rest = field->onward[heading] & ~cell->settled; rest != 0U; rest &= rest - 1U) {
        const unsigned other = JP_TRAILING_ZEROS(rest);
        jp_cost value = here + costs[other];

        if (value < values[other] && !field->is_plain) {
            value = here + jp_pose_turns_cost(field, cell->x, cell->y, heading, other);
        }
        if (value < values[other]) {
            values[other] = value;
            lowered |= UINT32_C(1) << other;
            cell->open |= value <= threshold ? UINT32_C(1) << other : 0U;
        }
    }
    cell->lowered |= lowered;
}

/** The open heading of the least value. */
static unsigned least_open(const struct jp_cell_poses *cell)
{
    const jp_cost *values = cell->value;
    unsigned least = JP_TRAILING_ZEROS(cell->open);

    for (uint32_t rest = cell->open & (cell->open - 1U); rest != 0U; rest &= rest - 1U) {
        const unsigned heading = JP_TRAILING_ZEROS(rest);

        least = values[heading] < values[least] ? heading : least;
    }
    return least;
}

unsigned jp_pose_turns_settle(const struct jp_pose_field *field, struct jp_cell_poses *cell)
{
    unsigned count = 0;

    while (cell->open != 0U) {
        const unsigned heading = least_open(cell);

        cell->open &= ~(UINT32_C(1) << heading);
        cell->settled |= UINT32_C(1) << heading;
        relax(field, cell, heading);
        count++;
    }
    return count;
}
