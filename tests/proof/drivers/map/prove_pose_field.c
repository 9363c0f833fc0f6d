// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:20,any_terrain:30,jp_terrain_init:30,is_side:10,find_poses:20,find_returns:20,start:20
// eva: -eva-slevel-function jp_pose_field_init:20,jp_pose_field_start:20,jp_return_map_init:20,jp_return_map_start:20
/** Any map and prices, a block of any size, any root, headings and limit, grown to the end and beyond it; any poses on
 * the map and beside it; the way out and home by two of it. */
#include <joulepath/return_map.h>

#include "tests/proof/any_field.h"

static uint64_t block[1024];

static void start(struct jp_pose_field *field)
{
    jp_pose_field_set_lattice(field, &field_lattice);
    while (jp_pose_field_start(field, any_bool() ? JP_POSE_FIELD_FROM_ROOT : JP_POSE_FIELD_TO_ROOT, any_int(),
                               any_int(), (uint16_t)any_unsigned(UINT16_MAX), any_unsigned(UINT32_MAX)) != JP_OK) {
        /* Another root. */
    }
}

static void look(const struct jp_pose_field *field)
{
    struct jp_lattice_pose pose = {(int16_t)any_x(), (int16_t)any_y(), (uint8_t)any_heading()};

    (void)jp_pose_field_cost(field, any_int(), any_int(), any_heading());
    (void)jp_pose_field_least(field, any_int(), any_int());
    (void)jp_pose_field_next(field, &pose);
    (void)jp_pose_field_is_outdated(field);
}

static void find_poses(void)
{
    static struct jp_pose_field field;

    if (jp_pose_field_init(&field, &field_lattice, any_kind_of_cost(), field_map, block, any_unsigned(sizeof block)) !=
        JP_OK) {
        return;
    }
    start(&field);
    ANY_TIMES
    {
        unsigned poses = any_unsigned(UINT32_MAX);

        if (any_bool()) {
            start(&field);
        }
        (void)jp_pose_field_grow(&field, &poses);
        look(&field);
    }
}

static void find_returns(void)
{
    static struct jp_return_map returns;
    struct jp_lattice_pose from;

    ANY(from);
    if (jp_return_map_init(&returns, &field_lattice, field_map, block, any_unsigned(sizeof block)) != JP_OK ||
        jp_return_map_start(&returns, &from, any_int(), any_int(), any_unsigned(UINT32_MAX)) != JP_OK) {
        return;
    }
    ANY_TIMES
    {
        (void)jp_return_map_work(&returns, any_unsigned(UINT32_MAX));
        (void)jp_return_map_cost(&returns, any_int(), any_int());
    }
}

int main(void)
{
    struct jp_terrain_config config;

    any_terrain_config(&config);
    (void)jp_pose_field_size(&config);
    (void)jp_return_map_size(&config);
    any_field_map();
    find_poses();
    find_returns();
    ARRIVED();
    return 0;
}
