/** A skid-steered robot with any configuration that passes. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_SKID_H
#define JOULEPATH_TESTS_PROOF_ANY_SKID_H

#include <joulepath/skid_robot.h>

#include "tests/proof/any.h"

static struct jp_skid_robot_config any_skid_config;

/** As jp_skid_robot_init() does, one by one: so the analyser keeps the ranges. */
static bool passes(const struct jp_skid_robot_config *config)
{
    static struct jp_path_drive drive;
    const char *field;

    return jp_path_drive_init(&drive, &config->path, &field) == JP_OK &&
           jp_skid_odometry_check(&config->odometry, &field) == JP_OK &&
           jp_skid_control_check(&config->control, &field) == JP_OK &&
           jp_monitor_check(&config->monitor, &field) == JP_OK &&
           jp_skid_monitor_check(&config->wheels, &field) == JP_OK && jp_meter_check(&config->meter, &field) == JP_OK;
}

/** False: it does not pass. */
static bool any_skid(struct jp_skid_robot *robot)
{
    const char *field;

    ANY(any_skid_config);
    any_skid_config.name = "any";
    return passes(&any_skid_config) && jp_skid_robot_init(robot, &any_skid_config, &field) == JP_OK;
}

#endif
