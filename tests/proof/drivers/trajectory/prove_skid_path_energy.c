// eva: -eva-slevel-function main:20
/** Any model that passes, any path; the prices of any motion. */
#include <joulepath/skid_path_energy.h>

#include "tests/proof/any_path.h"

int main(void)
{
    static struct jp_skid_energy_model model;
    struct jp_lattice_path path;
    struct jp_skid_drive drive = {0};
    struct jp_motion_price price;
    struct jp_motion motion;
    jp_q16 duration;
    const char *field;

    ANY(model);
    if (jp_skid_energy_check(&model, &field) != JP_OK) {
        return 0;
    }
    any_path(&path);
    duration = any_between(0, INT32_MAX);
    jp_skid_path_energy(&model, &path, &drive, &duration);
    jp_skid_piece_energy(&model, &any_pieces[0], any_bool() ? &any_pieces[1] : NULL, any_between(0, JP_Q24(8)), &drive,
                         &duration);
    price = jp_skid_motion_price(&model, any_between(0, JP_Q16(16384)));
    ANY(motion);
    (void)price.power(price.model, &motion, any_between(-JP_Q24_ONE, JP_Q24_ONE));
    ARRIVED();
    return 0;
}
