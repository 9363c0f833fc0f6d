/** Instructions of a tick of the skid-steered robot's odometry, for each thing that it can do: the worst over random
 * states. */
#include <joulepath/skid_odometry.h>
#include <stddef.h>

#include "tests/target/cycles.h"
#include "tests/target/random.h"
#include "tests/target/target.h"

enum { STATES = 1000, SEED = 19 };

/* A bar of 0 is none. */
#if defined __ARM_ARCH_7EM__
enum { TICK_BAR = 450 };
#else
enum { TICK_BAR = 0 };
#endif

/* zhang2018. */
static const struct jp_skid_odometry_config config = {
    .tick_rate = 500,
    .step_ticks = 6,
    .way_per_count = 7510463,
    .turn_per_count = 1707611,
    .ratio = JP_Q24(0.662),
    .ratio_deviation = JP_Q24(0.012),
    .scale_deviation = JP_Q24(0.01),
    .bias_deviation = JP_Q24(0.00139),
    .bias_memory = 1000000,
    .gyro_noise = JP_Q24(0.00028),
    .way_noise = JP_Q24(0.0048),
    .turn_noise = JP_Q24(0.044),
    .tilt_deviation = JP_Q24(0.129),
    .tilt_change = JP_Q24(0.104),
    .accel_noise = JP_Q24(0.0047),
    .creep = JP_Q24(0.0826),
    .turn_creep_along = JP_Q24(0.7),
    .turn_creep_across = JP_Q24(1.3),
    .accel_offset = JP_Q24(0.02),
    .turn_force = JP_Q24(0.36),
    .force_per_ampere = JP_Q24(0.0478),
    .efficiency = JP_Q24(0.78),
    .rolling = JP_Q24(0.0426),
};

static uint32_t random_state = SEED;
static struct jp_skid_odometry before;
static struct jp_skid_odometry odometry;
static struct jp_sensors sensors;

static int32_t random_within(int32_t limit)
{
    return (int32_t)(((uint64_t)target_random(&random_state) * (2U * (uint32_t)limit + 1U)) >> 32) - limit;
}

static void restore(void *argument)
{
    (void)argument;
    odometry = before;
}

static void restore_and_tick(void *argument)
{
    restore(argument);
    jp_skid_odometry_update(&odometry, &config, &sensors);
}

/* In motion; a quarter of the states are far beyond it, so that limits act. */
static void change_sensors(void)
{
    const int32_t scale = (target_random(&random_state) & 3U) == 0U ? 50 : 1;

    sensors.encoder_left += (uint32_t)random_within(150 * scale);
    sensors.encoder_right += (uint32_t)random_within(150 * scale);
    sensors.yaw_rate = random_within(JP_Q24(0.1) * scale);
    sensors.pitch_rate = random_within(JP_Q24(0.02) * scale);
    sensors.accel_x = random_within(JP_Q24(0.3) * scale);
    sensors.current_left = random_within(JP_Q16(15) * scale);
    sensors.current_right = random_within(JP_Q16(15) * scale);
}

/* The worst of the ticks that come `tick` ticks after a step. */
static uint32_t worst_tick(uint32_t tick)
{
    const uint32_t restoring = target_count_instructions(restore, NULL);
    uint32_t worst = 0;

    for (int i = 0; i < STATES; i++) {
        change_sensors();
        for (uint32_t j = 0; j < config.step_ticks; j++) {
            jp_skid_odometry_update(&before, &config, &sensors);
            change_sensors();
        }
        for (uint32_t j = 0; j < tick; j++) {
            jp_skid_odometry_update(&before, &config, &sensors);
            change_sensors();
        }
        worst = target_count_worst(worst + restoring, restore_and_tick, NULL) - restoring;
        while (before.internal.ticks != 0U) {
            jp_skid_odometry_update(&before, &config, &sensors);
        }
    }
    return worst;
}

static void print_figure(const char *name, uint32_t instructions, uint32_t bar)
{
    target_print("{\"name\": \"" TARGET_CORE ": tick of the skid-steered robot's odometry");
    target_print(name);
    target_print("\", \"value\": ");
    target_print_number(instructions);
    target_print(", \"unit\": \"instructions\", \"bound\": ");
    if (bar == 0) {
        target_print("null");
    } else {
        target_print("{\"op\": \"<=\", \"value\": ");
        target_print_number(bar);
        target_print("}");
    }
    target_print(", \"command\": \"make figures\"}");
}

int main(void)
{
    static const char *const names[] = {" that finds the slip",      " that moves the pose",
                                        " that filters the heading", " that corrects the pose",
                                        " that filters the tilt",    " that takes a step"};
    uint32_t longest = 0;

    jp_skid_odometry_start(&before, &config, &sensors);
    target_print("[\n");
    for (uint32_t tick = 0; tick < config.step_ticks; tick++) {
        const uint32_t worst = worst_tick(tick);

        longest = worst > longest ? worst : longest;
        print_figure(names[tick], worst, 0);
        target_print(",\n");
    }
    print_figure(", worst", longest, TICK_BAR);
    target_print("\n]\n");
    return 0;
}
