/** A task for the trajectory rule, eight targets in a row ahead of a robot at rest, for the tests of the rule. */
#ifndef JOULEPATH_TESTS_SUPPORT_RULE_RIG_H
#define JOULEPATH_TESTS_SUPPORT_RULE_RIG_H

#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <joulepath/trajectory_rule.h>

#include "unity.h"

enum { LEGS = 8 };

static struct jp_trajectory_config config;
static struct jp_point targets[LEGS];
static struct jp_passage passages[LEGS];
static struct jp_trajectory_task task;
static struct jp_trajectory_leg legs[LEGS];
static struct jp_trajectory trajectory;

void setUp(void)
{
    config = jp_robot_courier24.trajectory;
    for (int i = 0; i < LEGS; i++) {
        targets[i] = (struct jp_point){JP_Q16(3) * (i + 1), 0};
    }
    task = (struct jp_trajectory_task){
        .config = &config, .cruise = JP_Q24(0.5), .targets = targets, .count = 1, .to_stand = true};
}

void tearDown(void)
{
}

static inline enum jp_status plan(void)
{
    return jp_trajectory_by_rule(&task, legs, &trajectory);
}

/** At this target alone a heading, in degrees, and a speed unless it is 0. */
static inline void give(uint16_t target, int degrees, jp_q24 speed)
{
    for (int i = 0; i < LEGS; i++) {
        passages[i] = (struct jp_passage){.given = 0};
    }
    passages[target] =
        (struct jp_passage){.given = (uint8_t)(speed == 0 ? JP_GIVEN_HEADING : JP_GIVEN_HEADING | JP_GIVEN_SPEED),
                            .heading = (jp_angle)(degrees * (int32_t)JP_ANGLE_DEGREES(1)),
                            .speed = speed};
    task.passages = passages;
}

#endif
