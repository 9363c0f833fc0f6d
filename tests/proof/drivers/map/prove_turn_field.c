// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:20,any_terrain:30,jp_terrain_init:30,is_side:10
/** Any map and prices, coarse cells of any scale, any poses as root and target, any changes of the map, for ever. */
#include <joulepath/turn_field.h>

#include "tests/proof/any_field.h"

static uint64_t block[512];
static struct jp_turn_field field;

static void start(void)
{
    static struct jp_turns turns;

    jp_lattice_turns(&field_lattice, field.kind, &turns);
    jp_turn_field_start(&field, &turns, any_x(), any_y(), any_heading(), any_x(), any_y(), any_heading());
}

static void look(void)
{
    (void)jp_turn_field_bound(&field, any_x(), any_y(), any_heading());
    (void)jp_turn_field_take_lowered(&field);
}

int main(void)
{
    const unsigned scale = any_unsigned(JP_TURN_SCALE_MAX - JP_TURN_SCALE_MIN) + JP_TURN_SCALE_MIN;

    any_field_map();
    if (jp_turn_field_size(&field_map->config, scale) > sizeof block) {
        return 0;
    }
    jp_turn_field_init(&field, &field_lattice, any_kind_of_cost(), field_map, scale, block);
    start();
    ANY_TIMES
    {
        unsigned looks = any_unsigned(UINT16_MAX);

        if (any_bool()) {
            jp_turn_field_set_lattice(&field, &field_lattice);
            start();
        }
        any_cell(field_map);
        jp_turn_field_cell_changed(&field, any_x(), any_y());
        (void)jp_turn_field_grow(&field, &looks);
        look();
    }
    ARRIVED();
    return 0;
}
