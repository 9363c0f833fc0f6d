/** Instructions of jp_battery_update(): of one that counts, and of one that ends a second, with the filter's step; of
 * jp_battery_forecast_left(), and of the voltage that a power leaves. The worst over a drive of random currents. */
#include <joulepath/battery.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "tests/target/cycles.h"
#include "tests/target/figure.h"
#include "tests/target/random.h"

#ifdef __ARM_ARCH_7EM__
#define BOUND "30000"
#else
#define BOUND NULL
#endif

enum { SECONDS = 600, SEED = 7 };

static const struct jp_battery_config config = {
    .capacity = 10080,
    .voltage_empty = JP_Q16(18),
    .voltage_nominal = JP_Q16(22),
    .voltage_full = JP_Q16(25.2),
    .voltage_min = JP_Q16(12),
    .voltage_max = JP_Q16(30),
    .voltage_jump = JP_Q16(6),
    .charge_efficiency = JP_Q16_ONE,
    .reserve = JP_Q31_MAX / 10,
    .charge_deviation = JP_Q31_MAX / 20,
    .load = JP_Q16_ONE,
    .update_rate = 2,
    .cells = &jp_battery_cells_courier24,
    .unit_exponent = 3,
};

static struct jp_battery battery;
static struct jp_battery before;
static jp_energy energy;
static jp_q16 voltage;
static uint32_t random_state = SEED;

/** In half a second, J in Q32: -1 A to 4 A. */
static void draw(void)
{
    const int32_t milliwatts = (int32_t)(target_random(&random_state) % 55000U) - 11000;

    energy += (jp_energy)milliwatts * 4294967 / 2;
    voltage = JP_Q16(22) - milliwatts / 2;
}

/* From the same state each time. */
static void update(void *unused)
{
    (void)unused;
    battery = before;
    (void)jp_battery_update(&battery, &config, energy, voltage);
}

static void forecast(void *unused)
{
    struct jp_forecast left;

    (void)unused;
    (void)jp_battery_forecast_left(&battery, &config, &left);
}

static void headroom(void *unused)
{
    jp_q16 under;

    (void)unused;
    (void)jp_battery_voltage_under(&battery, &config, JP_Q16(50), &under);
}

int main(void)
{
    uint32_t counting = 0;
    uint32_t filtering = 0;
    uint32_t forecasting = 0;
    uint32_t looking = 0;

    (void)jp_battery_start(&battery, &config, (jp_charge)5040 << 32, 0);
    for (int i = 0; i < SECONDS; i++) {
        draw();
        before = battery;
        counting = target_count_worst(counting, update, NULL);
        draw();
        before = battery;
        filtering = target_count_worst(filtering, update, NULL);
        forecasting = target_count_worst(forecasting, forecast, NULL);
        looking = target_count_worst(looking, headroom, NULL);
    }
    target_print("[\n");
    target_print_figure("battery: update that counts, worst of 600", counting, "instructions", NULL);
    target_print(",\n");
    target_print_figure("battery: update that ends a second, with the filter, worst of 600", filtering, "instructions",
                        BOUND);
    target_print(",\n");
    target_print_figure("battery: forecast of what is left, worst of 600", forecasting, "instructions", NULL);
    target_print(",\n");
    target_print_figure("battery: voltage under a power, worst of 600", looking, "instructions", NULL);
    target_print("\n]\n");
    return 0;
}
