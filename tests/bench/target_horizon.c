/** Instructions of jp_energy_forecast() and jp_energy_regressors(): the worst over random segments. */
#include <joulepath/horizon.h>
#include <joulepath/tables.h>

#include "tests/target/cycles.h"
#include "tests/target/random.h"
#include "tests/target/target.h"

enum { COUNT = 2000, SEED = 9 };

/* Of the robots here the one with the most modes. */

struct input {
    struct jp_energy_start start;
    struct jp_segment_command segment;
};

static uint32_t random_state = SEED;

static int32_t random_between(int32_t low, int32_t high)
{
    return low + (int32_t)(((uint64_t)target_random(&random_state) * (uint32_t)(high - low + 1)) >> 32);
}

static struct jp_motion random_motion(void)
{
    return (struct jp_motion){random_between(0, JP_Q24(1)), random_between(-JP_Q24(0.35), JP_Q24(0.35))};
}

static void random_transient(jp_q16 modes[JP_AXIS_MODES])
{
    for (int i = 0; i < JP_AXIS_MODES; i++) {
        modes[i] = random_between(-JP_Q16(50), JP_Q16(50));
    }
}

static struct input random_input(void)
{
    struct input input = {
        .start.motion = random_motion(),
        .segment = {random_motion(), random_between(-JP_Q24(1.3962634), JP_Q24(1.3962634)),
                    random_between(JP_Q16(0.5), JP_Q16(10))},
    };

    random_transient(input.start.transient.travel);
    random_transient(input.start.transient.yaw);
    return input;
}

static void forecast(void *argument)
{
    const struct input *input = argument;
    struct jp_energy_start end;
    jp_q16 energy;

    (void)jp_energy_forecast(&jp_energy_model_courier24, &jp_horizon_courier24, &input->start, &input->segment, &energy,
                             &end);
}

static void regressors(void *argument)
{
    const struct input *input = argument;
    jp_q16 regressor[JP_ENERGY_PARAMETERS];
    jp_q16 rest;

    (void)jp_energy_regressors(&jp_energy_model_courier24, &jp_horizon_courier24, &input->start, &input->segment,
                               regressor, &rest);
}

static void print_figure(const char *before, const char *name, uint32_t instructions)
{
    target_print(before);
    target_print("\n{\"name\": \"" TARGET_CORE ": ");
    target_print(name);
    target_print(", worst of ");
    target_print_number(COUNT);
    target_print(" segments\", \"value\": ");
    target_print_number(instructions);
    target_print(", \"unit\": \"instructions\", \"bound\": null, \"command\": \"make figures\"}");
}

int main(void)
{
    uint32_t worst_forecast = 0;
    uint32_t worst_regressors = 0;

    for (int i = 0; i < COUNT; i++) {
        struct input input = random_input();

        worst_forecast = target_count_worst(worst_forecast, forecast, &input);
        worst_regressors = target_count_worst(worst_regressors, regressors, &input);
    }
    print_figure("[", "energy forecast", worst_forecast);
    print_figure(",", "energy regressors", worst_regressors);
    target_print("\n]\n");
    return 0;
}
