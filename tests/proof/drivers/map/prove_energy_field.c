// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:20,any_terrain:30,jp_terrain_init:30,is_side:10
/** Any map and prices, any cells as root and target, any changes of the map, for ever. */
#include <joulepath/energy_field.h>

#include "tests/proof/any_field.h"

static uint64_t block[512];
static struct jp_energy_field field;

static void change(void)
{
    any_cell(field_map);
    jp_energy_field_cell_changed(&field, any_x(), any_y());
}

static void look(void)
{
    (void)jp_energy_field_bound(&field, any_x(), any_y());
    (void)jp_energy_field_take_lowered(&field);
}

int main(void)
{
    const enum jp_wave_format format = any_bool() ? JP_WAVE_2_BYTES : JP_WAVE_3_BYTES;

    any_field_map();
    if (jp_energy_field_size(&field_map->config, format) > sizeof block) {
        return 0;
    }
    jp_energy_field_init(&field, &field_lattice, any_kind_of_cost(), field_map, format, any_unsigned(JP_COST_MAX),
                         block);
    jp_energy_field_start(&field, any_x(), any_y(), any_x(), any_y());
    ANY_TIMES
    {
        unsigned cells = any_unsigned(UINT16_MAX);

        if (any_bool()) {
            jp_energy_field_set_lattice(&field, &field_lattice);
            jp_energy_field_start(&field, any_x(), any_y(), any_x(), any_y());
        }
        change();
        (void)jp_energy_field_grow(&field, &cells);
        look();
    }
    ARRIVED();
    return 0;
}
