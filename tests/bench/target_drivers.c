/**
 * Instructions of the STM32F405's part of a tick, registers to measurements and duties to compare values: the worst
 * over random readings, on memory in the place of the registers.
 */
#include "hal/stm32f4/devices.h"

#include <stddef.h>

#include "tests/bench/random_registers.h"
#include "tests/support/stm32_fake.h"
#include "tests/target/cycles.h"
#include "tests/target/random.h"
#include "tests/target/target.h"

enum { READINGS = 300, SEED = 20261121 };

/* What jp_robot_tick() leaves of the bar of 1 200. */
#ifdef __ARM_ARCH_7EM__
#define BOUND "{\"op\": \"<=\", \"value\": 200}"
#else
#define BOUND "null"
#endif

static struct jp_devices devices;
static struct jp_hal hal;
static struct jp_sensors sensors;
static struct jp_actuation actuation;
static uint32_t random_state = SEED;

static uint32_t random_bits(void)
{
    return target_random(&random_state);
}

static void prepare(void *argument)
{
    (void)argument;
    devices.imu.state = JP_IMU_FRESH;
}

static void read_sensors(void *argument)
{
    (void)argument;
    devices.imu.state = JP_IMU_FRESH;
    (void)hal.read(hal.context, &sensors);
}

static uint32_t worst_read(void)
{
    uint32_t worst = 0;

    for (int i = 0; i < READINGS; i++) {
        randomise_registers(&devices, &random_state);
        worst = target_count_worst(worst, read_sensors, NULL);
    }
    return worst - target_count_instructions(prepare, NULL);
}

static void write_duties(void *argument)
{
    (void)argument;
    (void)hal.write(hal.context, &actuation);
}

static uint32_t worst_write(void)
{
    uint32_t worst = 0;

    for (int i = 0; i < READINGS; i++) {
        actuation = (struct jp_actuation){
            .duty_left = (jp_q31)random_bits(), .duty_right = (jp_q31)random_bits(), .enabled = i % 8 != 0};

        worst = target_count_worst(worst, write_duties, NULL);
    }
    return worst;
}

static void receive(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    (void)frame;
}

static void print_figure(const char *name, uint32_t instructions, const char *bound)
{
    target_print("{\"name\": \"" TARGET_CORE ": STM32F405, ");
    target_print(name);
    target_print("\", \"value\": ");
    target_print_number(instructions);
    target_print(", \"unit\": \"instructions\", \"bound\": ");
    target_print(bound);
    target_print(", \"command\": \"make figures\"}");
}

int main(void)
{
    uint32_t read, write;

    stm32_fake_reset();
    jp_devices_start(&devices, 1000, receive, NULL);
    hal = jp_devices_hal(&devices);
    read = worst_read();
    write = worst_write();
    target_print("[\n");
    print_figure("sensors read and decoded", read, "null");
    target_print(",\n");
    print_figure("duties written", write, "null");
    target_print(",\n");
    print_figure("sensors and bridges, a tick", read + write, BOUND);
    target_print("\n]\n");
    return 0;
}
