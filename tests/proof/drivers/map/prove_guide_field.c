// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:20,any_terrain:30,jp_terrain_init:30,is_side:10
/** Any map and prices, coarse cells of any scale, any root and target, with memory lent or not, for ever. */
#include <joulepath/guide_field.h>

#include "tests/proof/any_field.h"

static uint64_t block[512];
static uint64_t loan[64];
static struct jp_guide_field field;

static void start(void)
{
    const struct jp_guide_root root = {(uint16_t)any_x(), (uint16_t)any_y(), (uint16_t)any_between(1, UINT16_MAX)};

    jp_guide_field_start(&field, any_bool() ? JP_GUIDE_FROM_ROOT : JP_GUIDE_TO_ROOT, &root, (uint16_t)any_x(),
                         (uint16_t)any_y());
    if (jp_guide_field_loan(&field_map->config) <= sizeof loan) {
        jp_guide_field_lend(&field, loan);
    }
}

static void look(void)
{
    (void)jp_guide_field_reaches(&field, any_x(), any_y());
    (void)jp_guide_field_estimate(&field, any_x(), any_y(), any_heading());
}

int main(void)
{
    static struct jp_turns turns;
    const enum jp_cost_kind kind = any_kind_of_cost();
    const unsigned scale = any_unsigned(JP_GUIDE_SCALE_MAX - 1U) + 1U;

    any_field_map();
    if (jp_guide_field_size(&field_map->config, scale) > sizeof block) {
        return 0;
    }
    jp_lattice_turns(&field_lattice, kind, &turns);
    jp_guide_field_init(&field, &field_lattice, kind, field_map, &turns, scale, block);
    start();
    ANY_TIMES
    {
        unsigned units = any_unsigned(UINT16_MAX);

        if (any_bool()) {
            jp_guide_field_set_lattice(&field, &field_lattice);
            start();
        }
        (void)jp_guide_field_grow(&field, &units);
        look();
    }
    ARRIVED();
    return 0;
}
