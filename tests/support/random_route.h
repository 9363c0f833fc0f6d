/** Random routes for the property tests of trajectories: of both robots, leg by leg. */
#ifndef JOULEPATH_TESTS_SUPPORT_RANDOM_ROUTE_H
#define JOULEPATH_TESTS_SUPPORT_RANDOM_ROUTE_H

#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "tests/support/decimal.h"
#include "tests/support/random.h"

struct route_robot {
    const char *name;
    const struct jp_robot_config *config;
    const struct jp_energy_model *model;
};

static inline const struct route_robot *draw_robot(void)
{
    static const struct route_robot robots[] = {
        {"gao2018", &jp_robot_gao2018, &jp_energy_model_gao2018},
        {"courier24", &jp_robot_courier24, &jp_energy_model_courier24},
    };

    return &robots[random_word() % 2];
}

/** Where a route has come to. */
struct route_end {
    struct jp_point at;
    double direction; /**< of the last leg, turn */
};

/** The target at the end of one more leg, m, which turns by so much of a turn. */
static inline struct jp_point add_leg(struct route_end *end, double length, double turn)
{
    end->direction += turn;
    end->at.x += to_q16(length * cos(6.283185307179586 * end->direction));
    end->at.y += to_q16(length * sin(6.283185307179586 * end->direction));
    return end->at;
}

#endif
