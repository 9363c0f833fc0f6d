/**
 * One robot in its surroundings: plant, instruments, supply, noise and faults. Time runs in control ticks.
 *
 * A world owns all that it needs; worlds in one process do not disturb each other. It must not be copied or moved
 * after world_init().
 */
#ifndef JOULEPATH_SIM_BALANCER_WORLD_H
#define JOULEPATH_SIM_BALANCER_WORLD_H

#include "sim/balancer/instruments.h"
#include "sim/base/cell_pack.h"
#include "sim/base/world_fault.h"

struct world {
    struct robot_file robot;
    struct plant plant;
    struct instruments instruments;
    struct random random;
    struct jp_actuation actuation; /**< as last written */
    struct plant_input input;      /**< of the last step */
    double bus_voltage;            /**< of the last step, V */
    struct cell_pack pack; /**< what feeds it, when has_pack; else supply of the robot file, which never empties */
    bool has_pack;
    uint64_t tick;
    double push_n; /**< acts until push_until */
    double yaw_torque_nm;
    uint64_t push_until; /**< tick */
    struct world_faults faults;
};

/** Upright, at rest, bridges off, no faults, tick 0. The robot file is copied. */
void world_init(struct world *world, const struct robot_file *robot, uint64_t seed);

/**
 * From now on the world's robot is `robot`, which is copied: plant, supply and instruments. Time, state, noise and
 * faults go on, and the plant's ledger closes (plant_change()). False, and nothing changed, when control.rate_hz,
 * encoder.counts_per_turn, wheel.radius_m or body.width_m differ: the encoders would jump.
 */
bool world_change_robot(struct world *world, const struct robot_file *robot);

/** From now on cells feed it. */
void world_feed(struct world *world, const struct cell_constants *cell, const struct cell_wiring *wiring,
                const struct cell_condition *condition);

/** One tick of 1/rate_hz under the last actuation, applied at its PWM's resolution from the sagging supply. */
void world_step(struct world *world);

/** Measures now, with the faults of this tick; false, and *sensors as it was, while WORLD_HAL_READ fails. */
bool world_read(struct world *world, struct jp_sensors *sensors);

/** Sets the actuation of the next steps; false, and the bridges off, while WORLD_HAL_WRITE fails. */
bool world_write(struct world *world, const struct jp_actuation *actuation);

/** From now on for `ticks`: a force forward at the body's centre of mass, N, and a yaw torque, N·m. Replaces the
 *  former push. */
void world_push(struct world *world, double force_n, double yaw_torque_nm, uint64_t ticks);

/** Adds a fault; false when there are WORLD_FAULTS_MAX already. */
bool world_add_fault(struct world *world, const struct world_fault *fault);

/** Length of a tick, s. */
double world_tick_seconds(const struct world *world);

#endif
