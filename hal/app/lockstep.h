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

struct jp_lockstep {
    struct jp_ecu ecu;
    const struct jp_robot_config *config;
    const struct jp_energy_model *model;
    struct jp_can_port bus; /**< as it is */
    struct jp_retained *retained;
    struct jp_ecu_learning learning;
    struct jp_navigation *navigation; /**< NULL: none */
    struct jp_navigation_config navigation_config;
    void (*tick)(struct jp_ecu *ecu); /**< runs jp_ecu_tick(), on a target in the control interrupt */
    bool running;                     /**< has power and is not held in reset */
    bool bus_off;
    bool answered; /**< last_tick holds */
    uint32_t last_tick;
    bool other_answers; /**< another ECU has answered the last tick */
};

/** Boots. What the pointers show must stay, and *lockstep must not be moved after it. As jp_ecu_init(). */
enum jp_status jp_lockstep_start(struct jp_lockstep *lockstep, const struct jp_robot_config *config,
                                 const struct jp_energy_model *model, const struct jp_can_port *bus,
                                 struct jp_retained *retained, void (*tick)(struct jp_ecu *ecu), const char **field);

/** At every boot the ECU begins to learn, from the state that stands there then. Right after jp_lockstep_start(); as
 *  jp_ecu_learn(), but that the state must stay, too. */
enum jp_status jp_lockstep_learn(struct jp_lockstep *lockstep, const struct jp_ecu_learning *learning,
                                 const char **field);

/** At every boot the ECU has this navigator, without a map. Right after jp_lockstep_start(), and jp_lockstep_learn() if
 *  it learns; as jp_navigation_init(). What the pointers show must stay. */
enum jp_status jp_lockstep_navigate(struct jp_lockstep *lockstep, struct jp_navigation *navigation,
                                    const struct jp_navigation_config *config, const char **field);

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
