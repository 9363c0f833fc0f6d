// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:200,any_terrain:30,jp_terrain_init:30,is_side:10,jp_planner_init:100
// eva: -eva-slevel-function jp_navigator_init:200,prepare:500,jp_pose_field_init:50
/** Any map, a robot that does and tells anything, memory of any size: any goals, with a field that leads there or
 *  without, stops and cells that change, before the first slice of work; the slices have no driver. */
#include <joulepath/navigator.h>

#include "tests/proof/any_field.h"
#include "tests/proof/any_vehicle.h"

#define LEGS 3U

static uint64_t block[2048];
static uint64_t way[256];
static uint8_t seen[512];
static uint64_t field_block[1024];
static struct jp_planner planner;
static struct jp_navigator navigator;
static struct jp_pose_field field;
static struct jp_course_leg legs[LEGS];

static bool prepare(void)
{
    const struct jp_planner_config config = {
        .lattice = &field_lattice, .cost = any_kind_of_cost(), .epsilon = {JP_EPSILON_ONE}};
    struct jp_navigator_config own = {.planner = &planner,
                                      .vehicle = &any_vehicle,
                                      .radius = any_int(),
                                      .margin = any_int(),
                                      .legs = legs,
                                      .legs_max = (uint16_t)any_unsigned(LEGS),
                                      .slice = (uint16_t)any_unsigned(UINT16_MAX),
                                      .patience = any_unsigned(UINT32_MAX),
                                      .way_block = any_bool() ? way : NULL,
                                      .way_size = any_unsigned(sizeof way),
                                      .seen = any_bool() ? seen : NULL,
                                      .seen_size = any_unsigned(sizeof seen)};
    struct jp_place origin;
    const char *name;

    ANY(origin);
    return jp_planner_init(&planner, &config, field_map, block, any_unsigned(sizeof block), &name) == JP_OK &&
           jp_navigator_init(&navigator, &own, &origin, &name) == JP_OK;
}

static void ask(void)
{
    struct jp_goal goal;

    ANY(goal);
    switch (any_between(0, 2)) {
    case 0:
        (void)jp_navigator_go(&navigator, &goal);
        break;
    case 1:
        (void)jp_navigator_go_along(&navigator, &goal, &field);
        break;
    default:
        jp_navigator_stop(&navigator);
        break;
    }
}

static void look(void)
{
    struct jp_progress progress;
    uint16_t count;

    (void)jp_navigator_place(&navigator);
    (void)jp_navigator_legs(&navigator, &count);
    (void)jp_navigator_progress(&navigator, &progress);
}

int main(void)
{
    any_field_map();
    if (jp_pose_field_init(&field, &field_lattice, any_kind_of_cost(), field_map, field_block, sizeof field_block) !=
        JP_OK) {
        return 0;
    }
    if (!prepare()) {
        return 0;
    }
    ANY_TIMES
    {
        ask();
        (void)jp_navigator_set_cell(&navigator, any_int(), any_int(),
                                    (enum jp_cell)any_between(JP_CELL_FREE, JP_CELL_UNKNOWN + 1));
        look();
    }
    ARRIVED();
    return 0;
}
