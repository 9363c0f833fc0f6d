#include "hal/stm32f4/devices.h"

#include "hal/stm32f4/board.h"
#include "hal/stm32f4/timer.h"
#include "hal/stm32f4/wait.h"

#define PULL_UP_US 20U /* of 40 kΩ, with a cable */

static bool is_strapped(void)
{
    jp_pin_input(BOARD_STRAP);
    jp_wait_us(PULL_UP_US);
    return !jp_pin_is_high(BOARD_STRAP);
}

static void start_own(struct jp_devices *devices, const struct jp_clock_hz *hz, uint32_t tick_rate)
{
    jp_bridges_start(&devices->bridges, hz->apb2_timers, tick_rate);
    jp_encoders_start(&devices->encoders);
    devices->analog_status = jp_analog_start(&devices->analog);
    devices->imu_status = jp_imu_start(&devices->imu);
    jp_analog_run();
}

void jp_devices_start(struct jp_devices *devices, uint32_t tick_rate, jp_can_receiver receive, void *context)
{
    struct jp_clock_hz hz;

    *devices = (struct jp_devices){.clock = jp_clock_start()};
    hz = jp_clock_frequencies(devices->clock);
    jp_timer_start(hz.apb1_timers);
    jp_pins_start();
    devices->on_bus = is_strapped();
    /* The other clocks are too inexact for the bus: it would be disturbed. */
    devices->has_can = devices->clock == JP_CLOCK_CRYSTAL && jp_can_controller_start(&devices->can, receive, context);
    if (!devices->on_bus) {
        start_own(devices, &hz, tick_rate);
    }
}

bool jp_devices_on_sample(struct jp_devices *devices)
{
    return jp_analog_on_sample() && jp_imu_request(&devices->imu) != JP_OK;
}

void jp_devices_on_imu(struct jp_devices *devices)
{
    jp_imu_on_transfer(&devices->imu);
}

static enum jp_status read_sensors(void *context, struct jp_sensors *sensors)
{
    struct jp_devices *devices = context;

    jp_encoders_read(&devices->encoders, sensors);
    jp_analog_read(&devices->analog, sensors);
    if (jp_imu_read(&devices->imu, sensors) != JP_OK) {
        return JP_ERR_HARDWARE;
    }
    return devices->analog_status;
}

static enum jp_status write_actuation(void *context, const struct jp_actuation *actuation)
{
    struct jp_devices *devices = context;

    return jp_bridges_write(&devices->bridges, actuation);
}

struct jp_hal jp_devices_hal(struct jp_devices *devices)
{
    return (struct jp_hal){.context = devices, .read = read_sensors, .write = write_actuation};
}
