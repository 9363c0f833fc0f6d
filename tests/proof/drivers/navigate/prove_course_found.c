// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:50,small_terrain:30,jp_terrain_init:30,jp_course_init:50,join:20
// eva: -eva-slevel-function jp_pose_field_init:20,jp_pose_field_start:20,any_way:20,any_field:20
/** A small map with any cells, any prices, any disc and margin that pass, and any point on the map: a course along a
 * field, and along a way, whose blocks hold anything, to the end and beyond it. */
#include <joulepath/course.h>

#include "tests/proof/any_small_map.h"

#define LEGS 3U

static uint64_t block[512];
static struct jp_course course;
static struct jp_course_leg legs[LEGS];
static struct jp_pose_field field;
static struct jp_lattice_way way;

static void join(void)
{
    ANY_TIMES
    {
        (void)jp_course_work(&course);
    }
}

/** As growing leaves it: any costs. */
static bool any_field(void)
{
    if (jp_pose_field_init(&field, &field_lattice, any_kind_of_cost(), field_map, block, any_unsigned(sizeof block)) !=
            JP_OK ||
        jp_pose_field_start(&field, JP_POSE_FIELD_TO_ROOT, any_int(), any_int(), (uint16_t)any_unsigned(UINT16_MAX),
                            any_unsigned(UINT32_MAX)) != JP_OK) {
        return false;
    }
    ANY(block);
    return true;
}

/** As the search leaves it: any marks. */
static bool any_way(void)
{
    const struct jp_way_cell start = {(int16_t)any_x(), (int16_t)any_y()};
    const struct jp_way_cell goal = {(int16_t)any_x(), (int16_t)any_y()};

    if (jp_lattice_way_start(&way, &field_lattice, field_map, &start, &goal, block, any_unsigned(sizeof block)) !=
        JP_OK) {
        return false;
    }
    ANY(block);
    return true;
}

int main(void)
{
    struct jp_point start;
    const char *wrong;

    small_field_map();

    const struct jp_course_config config = {.terrain = field_map,
                                            .radius = any_int(),
                                            .margin = any_int(),
                                            .legs = legs,
                                            .legs_max = (uint16_t)any_unsigned(LEGS)};

    if (jp_course_init(&course, &config, &wrong) != JP_OK) {
        return 0;
    }
    small_point(&start);
    if (any_bool() && any_field()) {
        const struct jp_lattice_pose from = {(int16_t)any_x(), (int16_t)any_y(), (uint8_t)any_heading()};

        if (jp_course_start_on_field(&course, &field, &from, &start) == JP_OK) {
            join();
        }
    } else if (any_way()) {
        const struct jp_way_cell from = {(int16_t)any_x(), (int16_t)any_y()};

        if (jp_course_start_on_way(&course, &way, &from, &start) == JP_OK) {
            join();
        }
    } else {
        /* There is no room for either. */
    }
    ARRIVED();
    return 0;
}
