// eva: -eva-slevel-function main:20
/** A navigator on a lattice for the application, with anything null that may not be, and as long as it has no map: it
 * is asked, told and stopped. With a map it has no driver. */
#include "hal/app/navigation.h"
#include "tests/proof/any.h"

static struct jp_navigation navigation;
static uint64_t map[8];
static uint64_t planner[8];
static uint64_t way[8];
static uint8_t seen[8];
static struct jp_course_leg legs[2];
static const struct jp_lattice lattice = {.resolution = JP_Q16(0.05)};
static const struct jp_navigator_body body = {.radius = JP_Q16(0.2)};

int main(void)
{
    const struct jp_navigation_config config = {.lattice = any_bool() ? &lattice : NULL,
                                                .body = any_bool() ? &body : NULL,
                                                .map = any_bool() ? map : NULL,
                                                .map_size = sizeof map,
                                                .planner = any_bool() ? planner : NULL,
                                                .planner_size = sizeof planner,
                                                .way = any_bool() ? way : NULL,
                                                .way_size = sizeof way,
                                                .seen = any_bool() ? seen : NULL,
                                                .seen_size = sizeof seen,
                                                .legs = any_bool() ? legs : NULL,
                                                .legs_max = (uint16_t)any_unsigned(2)};
    const struct jp_vehicle vehicle = {.context = NULL};
    struct jp_can_frame frame;
    const char *field;

    if (jp_navigation_init(&navigation, &config, &vehicle, any_between(-40, 40), &field) != JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        (void)jp_navigation_drive(&navigation, (uint8_t)any_unsigned(UINT8_MAX));
        (void)jp_navigation_is_under_way(&navigation);
        (void)jp_navigation_goes_round(&navigation);
        jp_navigation_stop(&navigation);
        (void)jp_navigation_take_frame(&navigation, &frame);
    }
    ARRIVED();
    return 0;
}
