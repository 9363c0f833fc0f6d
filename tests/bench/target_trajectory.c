/** Instructions of a trajectory of eight legs by rule, and of its energy: the worst of random routes with legs of 1…15
 * m that turn by up to 120°. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <joulepath/trajectory_energy.h>
#include <joulepath/trajectory_rule.h>
#include <stddef.h>

#include "tests/bench/random_legs.h"
#include "tests/target/cycles.h"
#include "tests/target/figure.h"

enum { ROUTES = 12 };

#ifdef __ARM_ARCH_7EM__
#define BAR "80000"
#else
#define BAR NULL
#endif

static struct jp_trajectory_leg legs[RANDOM_LEGS];
static struct jp_trajectory trajectory;
static struct jp_point targets[RANDOM_LEGS];
static enum jp_status status;
static uint32_t random_state = 1;

static void plan(void *unused)
{
    const struct jp_trajectory_task task = {.config = &jp_robot_courier24.trajectory,
                                            .cruise = jp_cruise_speed(&jp_energy_model_courier24),
                                            .targets = targets,
                                            .count = RANDOM_LEGS,
                                            .to_stand = true};

    (void)unused;
    status = jp_trajectory_by_rule(&task, legs, &trajectory);
}

static void foretell(void *unused)
{
    jp_q16 energy;

    (void)unused;
    status = jp_trajectory_energy(&jp_robot_courier24.trajectory, &jp_energy_model_courier24, &trajectory, &energy);
}

static bool worst_of(void (*work)(void *), uint32_t *worst)
{
    random_state = 1;
    *worst = 0;
    for (unsigned i = 0; i < ROUTES; i++) {
        draw_legs(&random_state, targets);
        plan(NULL);
        *worst = target_count_worst(*worst, work, NULL);
        if (status != JP_OK) {
            target_print("a route of the bench cannot be planned\n");
            return false;
        }
    }
    return true;
}

int main(void)
{
    uint32_t planning;
    uint32_t foretelling;

    if (!worst_of(plan, &planning) || !worst_of(foretell, &foretelling)) {
        return 1;
    }
    target_print("[\n");
    target_print_figure("trajectory of eight legs by rule, worst of random routes", planning, "instructions", BAR);
    target_print(",\n");
    target_print_figure("energy of a trajectory of eight legs, worst of random routes", foretelling, "instructions",
                        NULL);
    target_print("\n]\n");
    return 0;
}
