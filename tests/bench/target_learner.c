/** Instructions of one jp_learner_update(), the worst over random segments of which some are outliers and changes, and
 * of one jp_forecast_add(). */
#include <joulepath/learner.h>
#include <joulepath/tables.h>

#include <stddef.h>

#include "tests/target/cycles.h"
#include "tests/target/figure.h"
#include "tests/target/random.h"

#ifdef __ARM_ARCH_7EM__
#define BOUND "20000"
#else
#define BOUND NULL
#endif

enum { UPDATES = 2000, SEED = 5, OUTLIER_SHARE = 8 };

static struct jp_learner learner;
static struct jp_learner before;
static struct jp_energy_start start;
static struct jp_segment_command segment;
static jp_q16 measured;
static uint32_t random_state = SEED;

static int32_t random_between(int32_t low, int32_t high)
{
    return low + (int32_t)(((uint64_t)target_random(&random_state) * (uint32_t)(high - low + 1)) >> 32);
}

static void draw(void)
{
    jp_q16 energy;
    struct jp_energy_start end;

    segment = (struct jp_segment_command){{random_between(0, JP_Q24(1)), random_between(-JP_Q24(0.35), JP_Q24(0.35))},
                                          random_between(-JP_Q24(1.3), JP_Q24(1.3)),
                                          random_between(JP_Q16(0.5), JP_Q16(10))};
    (void)jp_energy_forecast(learner.built_in, learner.horizon, &start, &segment, &energy, &end);
    measured = random_between(0, OUTLIER_SHARE) == 0 ? 2 * energy : energy;
}

/* From the same state each time. */
static void update(void *unused)
{
    enum jp_learned learned;

    (void)unused;
    learner = before;
    (void)jp_learner_update(&learner, &start, &segment, measured, &learned);
}

static void forecast(void *unused)
{
    struct jp_forecast_sum sum = {0, {0}, 0};
    struct jp_energy_start end = start;

    (void)unused;
    (void)jp_forecast_add(&learner, &sum, &end, &segment);
}

int main(void)
{
    uint32_t worst_update = 0;
    uint32_t worst_forecast = 0;
    jp_q16 energy;

    jp_learner_start(&learner, &jp_learning_courier24, &jp_energy_model_courier24, &jp_horizon_courier24);
    for (int i = 0; i < UPDATES; i++) {
        draw();
        before = learner;
        worst_update = target_count_worst(worst_update, update, NULL);
        worst_forecast = target_count_worst(worst_forecast, forecast, NULL);
        (void)jp_energy_forecast(learner.built_in, learner.horizon, &start, &segment, &energy, &start);
    }
    target_print("[\n");
    target_print_figure("learner: update, worst of 2000", worst_update, "instructions", BOUND);
    target_print(",\n");
    target_print_figure("learner: forecast of a segment, worst of 2000", worst_forecast, "instructions", NULL);
    target_print("\n]\n");
    return 0;
}
