/**
 * What a board gives to the library and takes from it. One struct of functions for each robot, so that several
 * robots run in one process. The functions are called from the control interrupt: they must be bounded and must
 * not block.
 */
#ifndef JOULEPATH_HAL_H
#define JOULEPATH_HAL_H

#include <joulepath/robot.h>
#include <joulepath/skid_robot.h>

#ifdef __cplusplus
extern "C" {
#endif

struct jp_hal {
    void *context; /**< handed to each function */

    /** Fills *sensors with this tick's measurements in the units of sensors.h. JP_ERR_HARDWARE: a device did not
     *  answer; *sensors keeps what could be read. */
    enum jp_status (*read)(void *context, struct jp_sensors *sensors);

    /** Applies both duties at once; `enabled` 0 switches the bridges off. JP_ERR_HARDWARE: the bridges are off. */
    enum jp_status (*write)(void *context, const struct jp_actuation *actuation);
};

/**
 * What the control interrupt does: reads the sensors, ticks the robot, drives the bridges.
 * `written` is the caller's, JP_OK at the start: a failed write counts as a fault in the next tick.
 */
void jp_hal_tick(const struct jp_hal *hal, struct jp_robot *robot, enum jp_status *written);

/** The same for a skid-steered or differential-drive robot. */
void jp_hal_skid_tick(const struct jp_hal *hal, struct jp_skid_robot *robot, enum jp_status *written);

#ifdef __cplusplus
}
#endif

#endif
