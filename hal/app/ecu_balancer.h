/** A balancing robot and its pilot, as the application of a controller on CAN drives it. */
#ifndef JOULEPATH_HAL_APP_ECU_BALANCER_H
#define JOULEPATH_HAL_APP_ECU_BALANCER_H

#include <joulepath/pilot.h>

#include "hal/app/ecu_robot.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What a robot learns with, and from where it goes on. */
struct jp_ecu_learning {
    const struct jp_learning *learning;
    bool of_battery;                      /**< model and learning are of jp_meter.battery */
    enum jp_stored stored;                /**< what jp_parameters_start() found */
    const struct jp_learned_state *state; /**< taken with JP_STORED_TAKEN, else it may be null */
};

/** The members but `internal` may be read: the robot as its accessors say, the others from the background. */
struct jp_ecu_balancer {
    struct jp_robot robot;
    struct jp_pilot pilot;
    bool learns;
    enum jp_stored stored; /**< what of the stored state is in use, or why not */
    struct {
        const struct jp_energy_model *model; /* that the telemetry tells */
        struct jp_energy_model models[2];    /* one of them, as learned when the last route began */
        uint16_t segments_reported;          /* of the tick */
    } internal;
};

/** Prepares robot and pilot for jp_ecu_init(). What the pointers show must stay. JP_ERR_ARGUMENT, JP_ERR_CONFIG: as
 *  jp_robot_init(). Not for ISRs. */
enum jp_status jp_ecu_balancer_init(struct jp_ecu_balancer *balancer, const struct jp_robot_config *config,
                                    const struct jp_energy_model *model, struct jp_ecu_robot *robot,
                                    const char **field);

/**
 * The ECU learns the energy model from what it drives, and plans each route with what it knows when the route begins.
 * Right after jp_ecu_balancer_init(); what the pointers show must stay, but for the state, which is copied.
 * JP_ERR_CONFIG: *field names the first field of learning out of range; JP_ERR_ARGUMENT: a pointer is null that may not
 * be. Then it does not learn.
 */
enum jp_status jp_ecu_balancer_learn(struct jp_ecu_balancer *balancer, const struct jp_ecu_learning *learning,
                                     const char **field);

/** The energy model as its telemetry tells it: the built-in one or, once it learns, the learned one of the last route.
 * From any context. */
static inline const struct jp_energy_model *jp_ecu_balancer_model(const struct jp_ecu_balancer *balancer)
{
    return __atomic_load_n(&balancer->internal.model, __ATOMIC_ACQUIRE);
}

#ifdef __cplusplus
}
#endif

#endif
