/** The application of a balancing robot, as a firmware starts it. */
#ifndef JOULEPATH_TESTS_SUPPORT_ECU_START_H
#define JOULEPATH_TESTS_SUPPORT_ECU_START_H

#include <joulepath/balancer_vehicle.h>

#include "hal/app/ecu.h"
#include "hal/app/ecu_balancer.h"

static inline enum jp_status ecu_start(struct jp_ecu *ecu, struct jp_ecu_balancer *balancer,
                                       const struct jp_robot_config *config, const struct jp_energy_model *model,
                                       const struct jp_can_port *port, struct jp_retained *retained, const char **field)
{
    struct jp_ecu_robot robot;
    const enum jp_status status = jp_ecu_balancer_init(balancer, config, model, &robot, field);

    return status == JP_OK ? jp_ecu_init(ecu, &robot, port, retained) : status;
}

/** Its navigator; `pilot` null: no vehicle. */
static inline enum jp_status navigation_start(struct jp_navigation *navigation,
                                              const struct jp_navigation_config *config, struct jp_pilot *pilot,
                                              const char **field)
{
    static struct jp_balancer_vehicle balancer;
    struct jp_vehicle vehicle;

    if (jp_balancer_vehicle_init(&balancer, pilot, &vehicle) != JP_OK) {
        return jp_navigation_init(navigation, config, NULL, 0, field);
    }
    return jp_navigation_init(navigation, config, &vehicle, pilot->config.model->unit_exponent, field);
}

#endif
