/* A robot with four steered wheels in the image. */
#include "hal/app/ecu_patrol_round.h"
#include "hal/app/patrol_memory.h"
#include "hal/firmware/firmware_robot.h"

#define FIRMWARE_PATROL ROBOT_SYMBOL(jp_four_wheel_robot_, FIRMWARE_PATROL_NAME)

static struct jp_ecu_patrol patrol;
static struct jp_ecu_patrol_round round_trips;
static struct jp_navigation navigation;
static struct jp_patrol_map map;
static struct jp_patrol_block block;

static const struct jp_patrol_pilot_config tables = {
    .patrol = &ROBOT_SYMBOL(jp_patrol_config_, FIRMWARE_PATROL_NAME),
    .localiser = &ROBOT_SYMBOL(jp_localiser_config_, FIRMWARE_PATROL_NAME),
    .scanner = &ROBOT_SYMBOL(jp_patrol_scanner_, FIRMWARE_PATROL_NAME),
    .energy = &ROBOT_SYMBOL(jp_four_wheel_energy_, FIRMWARE_PATROL_NAME),
    .learning = &ROBOT_SYMBOL(jp_four_wheel_learning_, FIRMWARE_PATROL_NAME),
    .points_max = JP_PATROL_POINTS_MAX,
    .turns_max = JP_PATROL_TURNS_MAX,
};

static enum jp_status start_navigating(struct jp_ecu *ecu)
{
    const struct jp_map_room room = jp_patrol_map_room(&map);
    const struct jp_wayfinder finder = jp_ecu_patrol_round_wayfinder(&round_trips, &patrol);
    const enum jp_status status = jp_navigation_init_with(&navigation, &finder, &room);

    jp_ecu_navigate(ecu, &navigation);
    return status;
}

enum jp_status jp_firmware_boot(struct jp_ecu *ecu, const struct jp_firmware_start *start, const char **field)
{
    const struct jp_ecu_patrol_config config = {.robot = &FIRMWARE_PATROL,
                                                .pilot = &tables,
                                                .block = block.words,
                                                .size = sizeof block.words,
                                                .stored = start->stored,
                                                .state = &start->parameters->energy};
    struct jp_ecu_robot robot;
    enum jp_status status = jp_ecu_patrol_init(&patrol, &config, &robot, field);

    if (status == JP_OK) {
        status = jp_ecu_init(ecu, &robot, start->port, start->retained);
    }
    return status == JP_OK ? start_navigating(ecu) : status;
}
