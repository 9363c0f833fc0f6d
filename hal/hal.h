/**
 * What a board gives to the library and takes from it. One struct of functions for each robot, so that several
 * robots run in one process. The functions are called from the control interrupt: they must be bounded and must
 * not block.
 */
#ifndef JOULEPATH_HAL_H
#define JOULEPATH_HAL_H

#include <joulepath/four_wheel_robot.h>
#include <joulepath/robot.h>
#include <joulepath/skid_robot.h>

#ifdef __cplusplus
extern "C" {
#endif

struct jp_hal {
    void *context; /**< handed to each function */

    /** Fills *sensors with this tick's measurements in the units of sensors.h. JP_HELD: none came, and *sensors goes on
     *  from the last one; as on a bus that lost a frame. JP_ERR_HARDWARE: a device did not answer; *sensors keeps what
     *  could be read. */
    enum jp_status (*read)(void *context, struct jp_sensors *sensors);

    /** Applies both duties at once; `enabled` 0 switches the bridges off. JP_ERR_HARDWARE: the bridges are off. */
    enum jp_status (*write)(void *context, const struct jp_actuation *actuation);
};

/** The same of a robot with four steered and driven wheels, whose drives follow angles and speeds by themselves, and
 * its laser scanner. */
struct jp_four_wheel_hal {
    void *context; /**< handed to each function */

    /** As of struct jp_hal; it never holds: nothing new is JP_ERR_HARDWARE, which the robot rides out for a while. */
    enum jp_status (*read)(void *context, struct jp_four_wheel_sensors *sensors);

    /** Applies the set-points of all wheels at once; `enabled` 0 switches the drives off. JP_ERR_HARDWARE: they are
     * off.
     */
    enum jp_status (*write)(void *context, const struct jp_four_wheel_actuation *actuation);

    /** From the background: a whole scan that has come since the last call, of the scanner's beams, in m; 0: nothing
     *  was seen, below 0: the beam dropped out. False: none has come. */
    bool (*scan)(void *context, float *ranges);
};

/**
 * What the control interrupt does: reads the sensors, ticks the robot, drives the bridges.
 * `written` is the caller's, JP_OK at the start: a failed write counts as a fault in the next tick.
 */
void jp_hal_tick(const struct jp_hal *hal, struct jp_robot *robot, enum jp_status *written);

/** The same for a skid-steered or differential-drive robot. */
void jp_hal_skid_tick(const struct jp_hal *hal, struct jp_skid_robot *robot, enum jp_status *written);

/** The same for a robot with four steered wheels. */
void jp_hal_four_wheel_tick(const struct jp_four_wheel_hal *hal, struct jp_four_wheel_robot *robot,
                            enum jp_status *written);

#ifdef __cplusplus
}
#endif

#endif
