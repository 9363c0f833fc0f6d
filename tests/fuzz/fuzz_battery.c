/**
 * The battery and the meters with any configuration that passes its check, from any energies and voltages: the charge
 * stays between none and the capacity, and the energy left is never below 0.
 */
#include <joulepath/battery.h>
#include <joulepath/bus_meter.h>
#include <joulepath/energy.h>
#include <joulepath/tables.h>

#include "tests/fuzz/fuzz_input.h"

static const struct jp_battery_config usual = {.capacity = 36000,
                                               .voltage_empty = JP_Q16(20),
                                               .voltage_nominal = JP_Q16(24),
                                               .voltage_full = JP_Q16(28),
                                               .voltage_min = JP_Q16(16),
                                               .voltage_max = JP_Q16(30),
                                               .voltage_jump = JP_Q16(4),
                                               .charge_efficiency = JP_Q16(0.95),
                                               .reserve = (jp_q31)1 << 27};

static struct jp_battery_cells cells;

static void check_battery(const struct jp_battery *battery, const struct jp_battery_config *config)
{
    const jp_charge capacity = battery->capacity;

    fuzz_require(battery->charge >= 0 && battery->charge <= capacity, "a charge beyond the capacity");
    fuzz_require(jp_battery_level(battery) >= 0, "a state of charge below 0");
    fuzz_require(jp_battery_energy_left(battery, config) >= 0, "an energy left below 0");
}

static void use_meter(struct fuzz_input *input)
{
    struct jp_bus_meter meter;

    if (jp_bus_meter_start(&meter, fuzz_below(input, 16384)) != JP_OK) {
        return;
    }
    for (unsigned left = fuzz_below(input, 16); left > 0U; left--) {
        jp_bus_meter_update(&meter, (jp_q16)fuzz_u32(input), (jp_q16)fuzz_u32(input));
    }
    (void)jp_energy_to_q16(meter.energy, fuzz_range(input, -JP_ENERGY_UNIT_EXPONENT_MAX, JP_ENERGY_UNIT_EXPONENT_MAX));
    (void)jp_energy_from_q16((jp_q16)fuzz_u32(input),
                             fuzz_range(input, -JP_ENERGY_UNIT_EXPONENT_MAX, JP_ENERGY_UNIT_EXPONENT_MAX));
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct jp_battery_config config = usual;
    struct jp_battery battery;
    jp_energy energy = 0;
    jp_charge charge = 0;
    const char *field = NULL;

    use_meter(&input);
    FUZZ_CHANGE(&input, config);
    cells = fuzz_bool(&input) ? jp_battery_cells_courier24 : jp_battery_cells_patrol;
    FUZZ_CHANGE(&input, cells);
    config.cells = fuzz_bool(&input) ? &cells : NULL;
    if (jp_battery_check(&config, &field) != JP_OK) {
        fuzz_require(field != NULL && field[0] != '\0', "a nameless field");
        return 0;
    }
    if (jp_battery_estimate(&config, fuzz_range(&input, 0, JP_Q16(60)), &charge) == JP_OK) {
        fuzz_require(charge >= 0 && charge <= (jp_charge)config.capacity << 32, "an estimate beyond the capacity");
    }
    if (jp_battery_start(&battery, &config, fuzz_bool(&input) ? charge : (jp_charge)fuzz_u64(&input), energy) !=
        JP_OK) {
        return 0;
    }
    check_battery(&battery, &config);
    while (fuzz_more(&input)) {
        const uint8_t kind = fuzz_u8(&input);
        const jp_q16 voltage = kind % 2U == 0U ? config.voltage_nominal : (jp_q16)fuzz_u32(&input);

        if (kind % 8U == 7U) {
            energy = (jp_energy)fuzz_u64(&input);
        } else {
            energy = (jp_energy)((uint64_t)energy + (uint64_t)((int64_t)(int32_t)fuzz_u32(&input) * 65536));
        }
        fuzz_require((jp_battery_update(&battery, &config, energy, voltage) & ~127U) == 0U, "a flag that there is not");
        check_battery(&battery, &config);
    }
    return 0;
}
