// eva: -eva-precision 0 -eva-auto-loop-unroll 24
// eva: -eva-slevel-function main:200,any_terrain:30,jp_terrain_init:30,is_side:10,jp_planner_init:100
// eva: -eva-slevel-function jp_navigator_init:200,prepare:500,jp_home_init:200
/** Any map, a robot that does and tells anything, a battery that says anything or nothing, a block of any size,
 * anything learned within its ranges: any goals, questions and stops, whatever the slices of work have found of the way
 * home; the slices have no driver. */
#include <joulepath/home.h>

#include "tests/proof/any_field.h"
#include "tests/proof/any_vehicle.h"

#define LEGS 3U

static uint64_t planner_block[2048];
static uint64_t home_block[1024];
static struct jp_planner planner;
static struct jp_navigator navigator;
static struct jp_home home;
static struct jp_course_leg legs[LEGS];
static struct jp_course_leg home_legs[LEGS];

static bool left_now(void *context, struct jp_forecast *left)
{
    (void)context;
    ANY(*left);
    return any_bool();
}

static jp_q16 given_now(void *context)
{
    (void)context;
    return any_int();
}

static bool prepare(void)
{
    const struct jp_planner_config config = {
        .lattice = &field_lattice, .cost = any_kind_of_cost(), .epsilon = {JP_EPSILON_ONE}};
    const struct jp_navigator_config own = {.planner = &planner,
                                            .vehicle = &any_vehicle,
                                            .radius = any_int(),
                                            .margin = any_int(),
                                            .legs = legs,
                                            .legs_max = LEGS,
                                            .slice = 1,
                                            .patience = any_unsigned(UINT32_MAX)};
    const struct jp_home_config of_home = {.navigator = &navigator,
                                           .x = (int16_t)any_between(INT16_MIN, INT16_MAX),
                                           .y = (int16_t)any_between(INT16_MIN, INT16_MAX),
                                           .confidence = any_int(),
                                           .left = left_now,
                                           .given = given_now,
                                           .legs = home_legs,
                                           .legs_max = (uint16_t)any_unsigned(LEGS),
                                           .slice = (uint16_t)any_unsigned(UINT16_MAX),
                                           .block = home_block,
                                           .size = any_unsigned(sizeof home_block)};
    struct jp_place origin;
    const char *name;

    ANY(origin);
    return jp_planner_init(&planner, &config, field_map, planner_block, sizeof planner_block, &name) == JP_OK &&
           jp_navigator_init(&navigator, &own, &origin, &name) == JP_OK &&
           jp_home_init(&home, &of_home, &name) == JP_OK;
}

static void any_factor(struct jp_home_factor *factor)
{
    factor->mean = any_between(JP_Q16_ONE / 2, 2 * JP_Q16_ONE);
    factor->deviation = any_between(1, JP_Q16(0.1));
    factor->noise = any_between(JP_Q16_ONE / 64, 2 * JP_Q16_ONE);
}

static void any_way(struct jp_home_way *way)
{
    ANY(way->energy);
    way->cost = any_unsigned(UINT32_MAX);
    way->given = any_int();
    way->is_known = any_bool();
}

/** What slices of work find. */
static void pass(void)
{
    any_factor(&home.learned.out);
    any_factor(&home.learned.back);
    any_way(&home.internal.way);
    any_way(&home.internal.price);
    home.internal.price.cost = any_unsigned(UINT32_MAX - 1U) + 1U; /* it is long enough */
    home.internal.is_stuck = any_bool();
    home.internal.is_goal_known = any_bool();
}

static void ask(void)
{
    struct jp_goal goal;

    ANY(goal);
    switch (any_between(0, 3)) {
    case 0:
        (void)jp_home_go(&home, &goal);
        break;
    case 1:
        (void)jp_home_return(&home);
        break;
    case 2:
        jp_home_set_lattice(&home, &field_lattice);
        break;
    default:
        jp_home_stop(&home);
        break;
    }
}

static void look(void)
{
    struct jp_home_answer answer;
    struct jp_forecast forecast;
    jp_cost cost;

    ANY(forecast);
    (void)jp_home_ask(&home, &answer);
    (void)jp_home_is_cut_off(&home);
    (void)jp_home_farthest(&home, &forecast, any_int(), any_unsigned(UINT32_MAX), &cost);
    (void)jp_home_expect(&home, any_unsigned(UINT32_MAX), any_unsigned(UINT32_MAX), &forecast);
}

int main(void)
{
    any_field_map();
    if (!prepare()) {
        return 0;
    }
    ANY_TIMES
    {
        pass();
        ask();
        look();
    }
    ARRIVED();
    return 0;
}
