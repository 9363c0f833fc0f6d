/** Trajectories whose members are any within their ranges, and what is planned of them. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_TRAJECTORY_H
#define JOULEPATH_TESTS_PROOF_ANY_TRAJECTORY_H

#include <joulepath/trajectory.h>

#include "tests/proof/any.h"

#define ANY_LEGS 3U

static struct jp_trajectory_leg any_legs[ANY_LEGS];

static void any_leg(struct jp_trajectory_leg *leg)
{
    ANY(*leg);
    leg->begin.set_points = any_unsigned((1U << 24) - 1U) + 1U;
    leg->middle.set_points = any_unsigned((1U << 30) - 1U) + 1U;
    leg->end.set_points = any_unsigned((1U << 24) - 1U) + 1U;
}

/** Of as many legs as there are, planned or not. */
static void any_trajectory(struct jp_trajectory *trajectory)
{
    for (unsigned i = 0; i < ANY_LEGS; i++) {
        any_leg(&any_legs[i]);
    }
    ANY(*trajectory);
    trajectory->legs = any_legs;
    trajectory->places = (uint16_t)ANY_LEGS;
    trajectory->count = (uint16_t)any_unsigned(UINT16_MAX);
}

#endif
