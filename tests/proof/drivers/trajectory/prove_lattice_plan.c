// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:50,small_terrain:30,jp_terrain_init:30,jp_lattice_path_of_plan:60
/** A small map with any cells, and any plan of a few steps of a lattice with nine primitives a heading, which is all
 * that a path reads of a planner: the path of the plan. */
#include <joulepath/lattice_path.h>

#include "tests/proof/any_small_map.h"

#define STEPS  3U
#define PLACES 2U

static struct jp_path_piece pieces[PLACES];
static struct jp_planner planner;
static uint8_t route[STEPS];

/** As the slices of work leave it. */
static void any_plan(void)
{
    struct jp_plan *plan = &planner.internal.plan;

    planner.internal.config.lattice = &field_lattice;
    planner.internal.terrain = field_map;
    planner.internal.route = route;
    for (unsigned i = 0; i < STEPS; i++) {
        route[i] = (uint8_t)any_unsigned(8U);
    }
    ANY(*plan);
    plan->answer = (enum jp_answer)any_between(JP_ANSWER_OUT_OF_BUDGET, JP_ANSWER_UNREACHABLE);
    plan->start = (struct jp_lattice_pose){(int16_t)any_x(), (int16_t)any_y(), (uint8_t)any_heading()};
    plan->step_count = (uint16_t)any_unsigned(STEPS);
}

int main(void)
{
    struct jp_lattice_path path;

    small_field_map();
    any_plan();
    (void)jp_lattice_path_of_plan(&path, &planner, pieces, (uint16_t)any_unsigned(PLACES));
    ARRIVED();
    return 0;
}
