/** Tasks of trajectories (trajectory_rule.h) from anywhere to anywhere, also those that are refused. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_TASK_H
#define JOULEPATH_TESTS_PROOF_ANY_TASK_H

#include <joulepath/trajectory_rule.h>

#include "tests/proof/any.h"

#define ANY_TARGETS 3U

static struct jp_point any_targets[ANY_TARGETS];
static struct jp_passage any_passages[ANY_TARGETS];

/** Once: they stay. */
static void any_places(void)
{
    ANY(any_targets);
    ANY(any_passages);
}

static void any_task(struct jp_trajectory_task *task, const struct jp_trajectory_config *config)
{
    ANY(*task);
    task->config = config;
    task->targets = any_targets;
    task->passages = any_bool() ? any_passages : NULL;
    task->count = (uint16_t)any_unsigned(ANY_TARGETS);
    task->to_stand = any_bool();
}

#endif
