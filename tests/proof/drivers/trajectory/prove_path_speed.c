// eva: -eva-slevel-function main:20
/** Any limits that pass, any path, any price, of which the powers are any; corners of it rounded. */
#include <joulepath/path_corner.h>
#include <joulepath/path_speed.h>

#include "tests/proof/any_path.h"

static jp_q16 any_power(const void *model, const struct jp_motion *motion, jp_q24 grade)
{
    (void)model;
    (void)motion;
    (void)grade;
    return any_int();
}

int main(void)
{
    struct jp_path_limits limits;
    struct jp_motion_price price;
    struct jp_path_cost cost;
    struct jp_lattice_path path;
    struct jp_corner_room room;
    const char *field;

    ANY(limits);
    if (jp_path_limits_check(&limits, &field) != JP_OK) {
        return 0;
    }
    ANY(price);
    price.power = any_power;
    price.model = NULL;
    any_path(&path);
    ANY(room);
    (void)jp_path_round_corner(&path, (uint16_t)any_unsigned(UINT16_MAX), &room, &limits, &price);
    (void)jp_path_plan_speeds(&path, &limits, &price, &cost);
    ARRIVED();
    return 0;
}
