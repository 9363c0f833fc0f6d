/** A balancing robot with any configuration that passes. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_BALANCER_H
#define JOULEPATH_TESTS_PROOF_ANY_BALANCER_H

#include <joulepath/robot.h>

#include "tests/proof/any.h"

static struct jp_robot_config any_balancer_config;

/** As jp_robot_init() does, one by one: so the analyser keeps the ranges. */
static bool passes(const struct jp_robot_config *config)
{
    const char *field;

    return jp_estimator_check(&config->estimator, &field) == JP_OK &&
           jp_reference_check(&config->reference, &field) == JP_OK && jp_lqr_check(&config->lqr, &field) == JP_OK &&
           jp_monitor_check(&config->monitor, &field) == JP_OK && jp_meter_check(&config->meter, &field) == JP_OK &&
           jp_segment_limits_check(&config->limits, NULL, &field) == JP_OK &&
           jp_trajectory_check(&config->trajectory, &field) == JP_OK;
}

/** False: it does not pass. */
static bool any_balancer(struct jp_robot *robot)
{
    const char *field;

    ANY(any_balancer_config);
    any_balancer_config.name = "any";
    return passes(&any_balancer_config) && jp_robot_init(robot, &any_balancer_config, &field) == JP_OK;
}

#endif
