/** Instructions of the search for headings and speeds of eight legs, the rule's plan with them included: the worst of
 *  random routes; of its longest slice; and the memory of a leg. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <joulepath/trajectory_optimiser.h>
#include <stddef.h>

#include "tests/bench/random_legs.h"
#include "tests/target/cycles.h"
#include "tests/target/figure.h"

enum { ROUTES = 12 };

#ifdef __ARM_ARCH_7EM__
#define BAR "400000"
#else
#define BAR NULL
#endif

static struct jp_point targets[RANDOM_LEGS];
static struct jp_passage passages[RANDOM_LEGS];
static struct jp_optimiser_place places[RANDOM_LEGS];
static struct jp_trajectory_optimiser optimiser;
static enum jp_status status;

static void start(void)
{
    const struct jp_trajectory_optimiser_config config = {
        .task = {.config = &jp_robot_courier24.trajectory,
                 .cruise = jp_cruise_speed(&jp_energy_model_courier24),
                 .targets = targets,
                 .count = RANDOM_LEGS,
                 .to_stand = true},
        .model = &jp_energy_model_courier24,
        .passages = passages,
        .places = places,
        .place_count = RANDOM_LEGS,
    };

    status = jp_trajectory_optimiser_start(&optimiser, &config);
}

static void work(void *unused)
{
    (void)unused;
    status = jp_trajectory_optimiser_work(&optimiser);
}

static void search(void *unused)
{
    start();
    do {
        work(unused);
    } while (status == JP_WORKING);
}

/** False: a route cannot be planned. */
static bool measure(uint32_t *whole, uint32_t *slice)
{
    uint32_t random_state = 1;

    for (unsigned i = 0; i < ROUTES; i++) {
        draw_legs(&random_state, targets);
        *whole = target_count_worst(*whole, search, NULL);
        if (status != JP_OK) {
            return false;
        }
        start();
        do {
            const uint32_t count = target_count_once(work, NULL);

            *slice = count > *slice ? count : *slice;
        } while (status == JP_WORKING);
    }
    return true;
}

int main(void)
{
    const uint32_t memory = (uint32_t)(sizeof(struct jp_trajectory_leg) + sizeof places[0] + sizeof passages[0]);
    uint32_t whole = 0;
    uint32_t slice = 0;

    if (!measure(&whole, &slice)) {
        target_print("a route of the bench cannot be planned\n");
        return 1;
    }
    target_print("[\n");
    target_print_figure("optimised passages of eight legs, worst of random routes", whole, "instructions", BAR);
    target_print(",\n");
    target_print_figure("optimised passages, longest slice", slice, "instructions", NULL);
    target_print(",\n");
    target_print_figure("memory of a leg with an optimised passage", memory, "B", "300");
    target_print("\n]\n");
    return 0;
}
