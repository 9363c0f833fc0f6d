/* A balancing robot in the image. */
#include <joulepath/balancer_vehicle.h>

#include "hal/app/ecu_balancer.h"
#include "hal/firmware/firmware_robot.h"

#define FIRMWARE_ROBOT        ROBOT_SYMBOL(jp_robot_, FIRMWARE_ROBOT_NAME)
#define FIRMWARE_ENERGY_MODEL ROBOT_SYMBOL(jp_energy_model_, FIRMWARE_ROBOT_NAME)

/** It learns if there are tables of the robot: the Makefile says so. */
#ifdef FIRMWARE_LEARNS
#define FIRMWARE_LEARNING ROBOT_SYMBOL(jp_learning_, FIRMWARE_ROBOT_NAME)
#endif

static struct jp_ecu_balancer balancer;

static void start_learning(const struct jp_firmware_start *start)
{
#ifdef FIRMWARE_LEARNS
    const struct jp_ecu_learning learning = {
        .learning = &FIRMWARE_LEARNING, .stored = start->stored, .state = &start->parameters->energy};
    const char *field;

    (void)jp_ecu_balancer_learn(&balancer, &learning, &field);
#else
    (void)start;
#endif
}

static void start_navigating(struct jp_ecu *ecu, const struct jp_firmware_start *start)
{
#ifdef FIRMWARE_NAVIGATES
    static struct jp_balancer_vehicle balancer_vehicle;
    struct jp_vehicle vehicle;
    const char *field;

    if (jp_balancer_vehicle_init(&balancer_vehicle, &balancer.pilot, &vehicle) == JP_OK &&
        jp_navigation_init(start->navigation, start->navigation_config, &vehicle, FIRMWARE_ENERGY_MODEL.unit_exponent,
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
    struct jp_ecu_robot robot;
    enum jp_status status = jp_ecu_balancer_init(&balancer, &FIRMWARE_ROBOT, &FIRMWARE_ENERGY_MODEL, &robot, field);

    if (status == JP_OK) {
        status = jp_ecu_init(ecu, &robot, start->port, start->retained);
    }
    if (status == JP_OK) {
        start_learning(start);
        start_navigating(ecu, start);
    }
    return status;
}

uint32_t jp_firmware_tick_rate(void)
{
    return FIRMWARE_ROBOT.estimator.tick_rate;
}

uint32_t jp_firmware_identity(void)
{
    return jp_robot_identity(&FIRMWARE_ROBOT);
}

void jp_firmware_know_gyro_bias(int64_t bias)
{
    jp_robot_know_gyro_bias(&balancer.robot, bias);
}

int64_t jp_firmware_gyro_bias(void)
{
    struct jp_telemetry telemetry;

    (void)jp_robot_telemetry(&balancer.robot, &telemetry);
    return telemetry.gyro_bias;
}

/** Its heading is that of its wheels. */
struct jp_gyro_scale jp_firmware_gyro_scale(void)
{
    return (struct jp_gyro_scale){0};
}
