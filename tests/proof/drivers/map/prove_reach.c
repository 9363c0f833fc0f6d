// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:20,any_terrain:30,jp_terrain_init:30,is_side:10
/** Any map, any cells on it or beside it, a block of any size, to the end and beyond it. */
#include <joulepath/reach.h>

#include "tests/proof/any_field.h"

static uint64_t block[512];

int main(void)
{
    struct jp_terrain_config config;
    struct jp_reach reach;

    any_terrain_config(&config);
    (void)jp_reach_size(&config);
    any_field_map();
    if (jp_reach_start(&reach, &field_lattice, field_map, any_int(), any_int(), any_int(), any_int(), block,
                       any_unsigned(sizeof block)) != JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        (void)jp_reach_work(&reach, any_unsigned(UINT32_MAX));
    }
    ARRIVED();
    return 0;
}
