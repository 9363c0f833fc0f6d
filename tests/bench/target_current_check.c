/** Instructions of one jp_current_check_update(), the worst over a drive with currents that vary, stands and sensors
 *  that change. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include <stddef.h>

#include "tests/target/cycles.h"
#include "tests/target/figure.h"
#include "tests/target/random.h"

enum { SAMPLES = 3000, SEED = 6, MEMORY = 512, CHANGE = 400 };

static const struct jp_current_check_config config = {
    .offset = JP_Q16(0.05),
    .gain = JP_Q16(0.06),
    .resistance = JP_Q16(0.25),
    .excitation = JP_Q16(0.1),
    .memory = MEMORY,
};

static struct jp_current_check check;
static struct jp_current_check before;
static struct jp_motor_sample sample;
static uint32_t random_state = SEED;

static int32_t random_within(int32_t limit)
{
    return (int32_t)(((uint64_t)target_random(&random_state) * (2U * (uint32_t)limit + 1U)) >> 32) - limit;
}

/** With noise; in every second part the wheels are held and the motors loaded, and the left sensor has an offset. */
static void draw(int i)
{
    const bool other = i / CHANGE % 2 != 0;
    const jp_q16 current = random_within(other ? JP_Q16(3) : JP_Q16(0.05));
    const jp_q16 voltage = jp_q16_multiply(current, jp_robot_courier24.monitor.motor_resistance);

    sample = (struct jp_motor_sample){
        .voltages = {.left = voltage, .right = voltage},
        .wheel_rate = random_within(JP_Q24(0.001)),
        .yaw_rate = random_within(JP_Q24(0.001)),
        .current_left = current + random_within(JP_Q16(0.02)) + (other ? JP_Q16(0.4) : 0),
        .current_right = current + random_within(JP_Q16(0.02)),
    };
}

/** From the same state each time. */
static void update(void *unused)
{
    (void)unused;
    check = before;
    (void)jp_current_check_update(&check, &sample);
}

int main(void)
{
    uint32_t worst = 0;

    jp_current_check_start(&check, &config, &jp_robot_courier24.monitor);
    for (int i = 0; i < SAMPLES; i++) {
        draw(i);
        before = check;
        worst = target_count_worst(worst, update, NULL);
    }
    target_print("[\n");
    target_print_figure("current check: update, worst of 3000", worst, "instructions", NULL);
    target_print("\n]\n");
    return 0;
}
