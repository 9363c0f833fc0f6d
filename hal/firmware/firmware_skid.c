/* A skid-steered or differential-drive robot in the image. */
#include <joulepath/skid_vehicle.h>

#include "hal/app/ecu_skid.h"
#include "hal/firmware/firmware_robot.h"

#define FIRMWARE_SKID        ROBOT_SYMBOL(jp_skid_robot_, FIRMWARE_SKID_NAME)
#define FIRMWARE_SKID_ENERGY ROBOT_SYMBOL(jp_skid_energy_, FIRMWARE_SKID_NAME)
#define FIRMWARE_LESSONS     ROBOT_SYMBOL(jp_skid_learning_, FIRMWARE_SKID_NAME)
#define FIRMWARE_PATH_LIMITS ROBOT_SYMBOL(jp_path_limits_, FIRMWARE_SKID_NAME)

/** It knows its cells if there is a table of its pack: the Makefile says so. */
#ifdef FIRMWARE_KNOWS_CELLS
#define FIRMWARE_CELLS ROBOT_SYMBOL(jp_battery_config_, FIRMWARE_SKID_NAME)
#endif

/** How far inside a corner it passes on the way to a goal: the navigator's margin. */
#ifdef FIRMWARE_NAVIGATES
#define FIRMWARE_GOAL_CORNER (FIRMWARE_NAVIGATION.margin * (JP_Q24_ONE / JP_Q16_ONE))
#else
#define FIRMWARE_GOAL_CORNER 0
#endif

static struct jp_ecu_skid skid;

/** Its plans ask for what its cells give. */
static void know_cells(struct jp_ecu *ecu)
{
#ifdef FIRMWARE_KNOWS_CELLS
    static struct jp_ecu_battery battery;
    const char *field;

    if (jp_ecu_battery_init(&battery, &FIRMWARE_CELLS, FIRMWARE_SKID_ENERGY.unit_exponent, &field) == JP_OK) {
        jp_ecu_use_battery(ecu, &battery);
    }
#else
    (void)ecu;
#endif
}

static void start_navigating(struct jp_ecu *ecu, const struct jp_firmware_start *start)
{
#ifdef FIRMWARE_NAVIGATES
    static struct jp_skid_vehicle skid_vehicle;
    struct jp_vehicle vehicle;
    const char *field;

    if (jp_skid_vehicle_init(&skid_vehicle, &skid.pilot, &vehicle) == JP_OK &&
        jp_navigation_init(start->navigation, start->navigation_config, &vehicle, FIRMWARE_SKID_ENERGY.unit_exponent,
                           &field) == JP_OK) {
        jp_ecu_navigate(ecu, start->navigation);
    }
#else
    (void)ecu;
    (void)start;
#endif
}

enum jp_status jp_firmware_boot(struct jp_ecu *ecu, const struct jp_firmware_start *start, const char **field)
{
    const struct jp_ecu_skid_config config = {.robot = &FIRMWARE_SKID,
                                              .energy = &FIRMWARE_SKID_ENERGY,
                                              .learning = &FIRMWARE_LESSONS,
                                              .limits = &FIRMWARE_PATH_LIMITS,
                                              .corner = FIRMWARE_PATH_LIMITS.width / 2,
                                              .goal_corner = FIRMWARE_GOAL_CORNER,
                                              .stored = start->stored,
                                              .state = &start->parameters->energy,
                                              .scale = &start->parameters->gyro_scale};
    struct jp_ecu_robot robot;
    enum jp_status status = jp_ecu_skid_init(&skid, &config, &robot, field);

    if (status == JP_OK) {
        status = jp_ecu_init(ecu, &robot, start->port, start->retained);
    }
    if (status == JP_OK) {
        know_cells(ecu);
        start_navigating(ecu, start);
    }
    return status;
}

uint32_t jp_firmware_tick_rate(void)
{
    return FIRMWARE_SKID.control.tick_rate;
}

uint32_t jp_firmware_identity(void)
{
    return jp_skid_robot_identity(&FIRMWARE_SKID);
}

/** It finds its bias anew within some seconds of standing. */
void jp_firmware_know_gyro_bias(int64_t bias)
{
    (void)bias;
}

int64_t jp_firmware_gyro_bias(void)
{
    return 0;
}

struct jp_gyro_scale jp_firmware_gyro_scale(void)
{
    return jp_ecu_skid_gyro_scale(&skid);
}
