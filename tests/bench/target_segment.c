/** Instructions of one jp_segment_optimise(): the worst over random inputs. */
#include <joulepath/segment.h>
#include <joulepath/tables.h>

#include "tests/target/cycles.h"
#include "tests/target/random.h"
#include "tests/target/target.h"

enum { COUNT = 5000, SEED = 7 };

#ifdef __ARM_ARCH_7EM__
#define BOUND "{\"op\": \"<=\", \"value\": 8000}"
#else
#define BOUND "null"
#endif

struct input {
    struct jp_segment_limits limits;
    struct jp_motion before;
    struct jp_point target;
    jp_angle heading;
};

static const struct jp_point origin;
static uint32_t random_state = SEED;

static uint32_t random_bits(void)
{
    return target_random(&random_state);
}

static int32_t random_between(int32_t low, int32_t high)
{
    return low + (int32_t)(((uint64_t)random_bits() * (uint32_t)(high - low + 1)) >> 32);
}

/** Evenly over the octaves from 2^low to 2^high. */
static int32_t random_octave(int32_t low, int32_t high)
{
    int32_t octave = random_between(low, high - 1);

    return random_between((int32_t)1 << octave, (int32_t)1 << (octave + 1));
}

/** Half of the inputs have the paper's limits. 0.03 m to 128 m, any bearing, speeds up to 1 m/s. */
static struct input random_input(void)
{
    struct input input = {
        .limits = {JP_Q24(1), JP_Q24(0.35), JP_Q24(1.3962634), JP_Q16(600)},
        .before = {random_between(0, JP_Q24(1)), random_between(-JP_Q24(0.35), JP_Q24(0.35))},
        .heading = random_bits(),
    };
    int32_t scale = random_octave(11, 23);

    input.target.x = random_between(-scale, scale);
    input.target.y = random_between(-scale, scale);
    if (random_bits() & 1) {
        input.limits.speed = random_octave(20, 27);
        input.limits.turn_rate = random_octave(19, 27);
        input.limits.turn = random_between(JP_Q24(0.05), JP_Q24(3.1415926));
        input.limits.duration = random_octave(19, 30);
    }
    return input;
}

static void optimise(void *argument)
{
    const struct input *input = argument;
    struct jp_segment segment;

    (void)jp_segment_optimise(&jp_energy_model_published, &input->limits, &input->before, &origin, input->heading,
                              &input->target, &segment);
}

int main(void)
{
    uint32_t worst = 0;

    for (int i = 0; i < COUNT; i++) {
        struct input input = random_input();

        worst = target_count_worst(worst, optimise, &input);
    }
    target_print("[\n{\"name\": \"" TARGET_CORE ": segment optimiser, worst of ");
    target_print_number(COUNT);
    target_print(" inputs\", \"value\": ");
    target_print_number(worst);
    target_print(", \"unit\": \"instructions\", \"bound\": " BOUND ", \"command\": \"make figures\"}\n]\n");
    return 0;
}
