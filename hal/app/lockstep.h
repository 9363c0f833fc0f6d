/**
 * The application under the simulator's time: in lockstep SimTime is its timer, and says whether it has power, is held
 * in reset, and its controller is on the bus. The same on a host and in a firmware image whose sensors and bridges are
 * simulated.
 *
 * SimTime is not protected, so it counts in lockstep only. In real time the frames go to jp_ecu_accept(), which does
 * not know it.
 */
#ifndef JOULEPATH_HAL_APP_LOCKSTEP_H
#define JOULEPATH_HAL_APP_LOCKSTEP_H

#include "hal/app/ecu.h"

#ifdef __cplusplus
extern "C" {
#endif

struct jp_lockstep_config {
    /** Prepares the robot, and the application on this port, with all that it has: at every boot. JP_OK, or *field
     * names what is out of range; it succeeds again once it has succeeded. */
    enum jp_status (*boot)(void *context, struct jp_ecu *ecu, const struct jp_can_port *port, const char **field);
    void *context;
    void (*tick)(struct jp_ecu *ecu); /**< runs jp_ecu_tick(), on a target in the control interrupt */
    struct jp_can_port bus;
    struct jp_retained *retained;
};

struct jp_lockstep {
    struct jp_ecu ecu;
    struct jp_lockstep_config config;
    bool running; /**< has power and is not held in reset */
    bool bus_off;
    bool answered; /**< last_tick holds */
    uint32_t last_tick;
    bool other_answers; /**< another ECU has answered the last tick */
};

/** Boots. *config is copied; what it shows must stay, and *lockstep must not be moved after it. JP_ERR_ARGUMENT: a
 *  pointer is null. Else as the boot. */
enum jp_status jp_lockstep_start(struct jp_lockstep *lockstep, const struct jp_lockstep_config *config,
                                 const char **field);

/**
 * Takes a frame. SimTime runs a tick, which SimDone ends: background work, then control. Beside another ECU that
 * answers, one that does not drive the bridges leaves the answer to it: the tick is done when the one that drives them
 * is. True when a sample is complete. From the loop that also runs jp_ecu_work(); at most one of it.
 */
bool jp_lockstep_accept(struct jp_lockstep *lockstep, const struct jp_can_frame *frame);

#ifdef __cplusplus
}
#endif

#endif
