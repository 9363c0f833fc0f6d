/** Firmware of somebody who uses the library and the HAL: ticks a robot whose board gives nothing. Exit status 0: it
 *  stays off. C and C++. */
#include <joulepath/tables.h>

#include "hal/app/ecu.h"
#include "hal/app/ecu_balancer.h"
#include "hal/hal.h"

static uint8_t switched_on;
static uint32_t frames;

static enum jp_status read_nothing(void *context, struct jp_sensors *sensors)
{
    (void)context;
    (void)sensors;
    return JP_ERR_HARDWARE;
}

static enum jp_status write_nothing(void *context, const struct jp_actuation *actuation)
{
    (void)context;
    switched_on |= actuation->enabled;
    return JP_OK;
}

static enum jp_status send_nothing(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    (void)frame;
    frames++;
    return JP_OK;
}

static enum jp_can_state always_on(void *context)
{
    (void)context;
    return JP_CAN_ON;
}

int main(void)
{
    static const struct jp_hal hal = {NULL, read_nothing, write_nothing};
    static const struct jp_can_port port = {NULL, send_nothing, always_on};
    static struct jp_robot robot;
    static struct jp_ecu ecu;
    static struct jp_ecu_balancer balancer;
    struct jp_ecu_robot of_ecu;
    struct jp_telemetry telemetry;
    enum jp_status written = JP_OK;
    const char *field = "";

    if (jp_robot_init(&robot, &jp_robot_courier24, &field) != JP_OK ||
        jp_ecu_balancer_init(&balancer, &jp_robot_courier24, &jp_energy_model_courier24, &of_ecu, &field) != JP_OK ||
        jp_ecu_init(&ecu, &of_ecu, &port, NULL) != JP_OK) {
        return 1;
    }
    for (int i = 0; i < 1000; i++) {
        jp_hal_tick(&hal, &robot, &written);
        jp_ecu_tick(&ecu);
        jp_ecu_work(&ecu);
    }
    jp_robot_telemetry(&robot, &telemetry);
    return switched_on == 0 && telemetry.state == JP_ROBOT_FAULT && frames > 0 ? 0 : 2;
}
