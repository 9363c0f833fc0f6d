// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:20,any_terrain:30,jp_terrain_init:30,is_side:10
/** Any map and prices, any cells on it or beside it, a block of any size, to the end and beyond it; any steps on it. */
#include <joulepath/lattice_way.h>

#include "tests/proof/any_field.h"

static uint64_t block[512];

int main(void)
{
    static struct jp_lattice_way way;
    struct jp_terrain_config config;
    struct jp_way_cell start;
    struct jp_way_cell goal;

    any_terrain_config(&config);
    (void)jp_lattice_way_size(&config);
    any_field_map();
    ANY(start);
    ANY(goal);
    if (jp_lattice_way_start(&way, &field_lattice, field_map, &start, &goal, block, any_unsigned(sizeof block)) !=
        JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        struct jp_way_cell cell = {(int16_t)any_x(), (int16_t)any_y()};

        (void)jp_lattice_way_work(&way, any_unsigned(UINT32_MAX));
        (void)jp_lattice_way_next(&way, &cell);
    }
    ARRIVED();
    return 0;
}
