// eva: -eva-precision 0
// eva: -eva-slevel-function main:20,any_terrain:30,jp_terrain_init:30,is_side:10
/** Any map, any primitives from any cells of it, until all places are taken; the path in any frame. */
#include <joulepath/lattice_path.h>

#include "tests/proof/any_field.h"

#define PLACES 4U

int main(void)
{
    static struct jp_path_piece pieces[PLACES];
    struct jp_lattice_path path;
    struct jp_path_pose origin;

    any_field_map();
    if (jp_lattice_path_start(&path, pieces, (uint16_t)any_unsigned(PLACES)) != JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        const struct jp_lattice_pose from = {(int16_t)any_x(), (int16_t)any_y(), (uint8_t)any_heading()};

        (void)jp_lattice_path_add(&path, &field_lattice, field_map, &from,
                                  &field_lattice.primitives[any_unsigned(field_lattice.first_from[JP_HEADINGS] - 1U)]);
    }
    ANY(origin);
    jp_lattice_path_in_frame(&path, &origin);
    ARRIVED();
    return 0;
}
