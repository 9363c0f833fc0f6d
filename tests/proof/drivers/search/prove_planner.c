// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:20,any_terrain:30,jp_terrain_init:30,is_side:10,jp_planner_init:20
/** Any map and prices, any schedule that passes, a block of any size: any starts, goals, changes of map and prices in
 * any order, before the first slice of work; the slices have no driver. */
#include <joulepath/planner.h>

#include "tests/proof/any_field.h"

static uint64_t block[2048];
static struct jp_planner planner;

static void ask(void)
{
    struct jp_lattice_pose start;
    struct jp_goal goal;

    ANY(start);
    ANY(goal);
    (void)jp_planner_set_start(&planner, &start);
    (void)jp_planner_set_goal(&planner, &goal);
}

static void change(void)
{
    const int32_t x = any_int();
    const int32_t y = any_int();

    switch (any_between(0, 5)) {
    case 0:
        (void)jp_planner_set_cell(&planner, x, y, (enum jp_cell)any_between(JP_CELL_FREE, JP_CELL_UNKNOWN + 1));
        break;
    case 1:
        (void)jp_planner_set_elevation(&planner, x, y, (jp_elevation)any_between(INT16_MIN, INT16_MAX));
        break;
    case 2:
        (void)jp_planner_set_cost(&planner, x, y, (uint8_t)any_unsigned(UINT8_MAX));
        break;
    case 3:
        (void)jp_planner_set_class(&planner, x, y, (uint8_t)any_unsigned(UINT8_MAX));
        break;
    case 4:
        (void)jp_planner_set_lattice(&planner, &field_lattice);
        break;
    default:
        jp_planner_restart(&planner);
        break;
    }
}

static void look(void)
{
    struct jp_lattice_pose pose = jp_planner_plan(&planner)->start;
    uint32_t slot = 0;
    bool is_open;
    unsigned step = 0;

    while (jp_planner_step(&planner, step, &pose) != NULL) {
        step++;
    }
    while (jp_planner_next_state(&planner, &slot, &pose, &is_open)) {
        /* The next one. */
    }
    (void)jp_planner_is_idle(&planner);
    (void)jp_planner_terrain(&planner);
    (void)jp_planner_lattice(&planner);
    (void)jp_planner_statistics(&planner);
}

int main(void)
{
    struct jp_planner_config config;
    const char *field;

    any_field_map();
    ANY(config);
    config.lattice = &field_lattice;
    config.cost = any_kind_of_cost();
    if (jp_planner_init(&planner, &config, field_map, block, any_unsigned(sizeof block), &field) != JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        if (any_bool()) {
            ask();
        }
        if (any_bool()) {
            change();
        }
        look();
    }
    ARRIVED();
    return 0;
}
