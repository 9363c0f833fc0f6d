/** What goes wrong with the sensors and bridges of a simulated robot, channel by channel. */
#ifndef JOULEPATH_SIM_BASE_WORLD_FAULT_H
#define JOULEPATH_SIM_BASE_WORLD_FAULT_H

#include <joulepath/sensors.h>
#include <stdbool.h>
#include <stddef.h>

#define WORLD_FAULTS_MAX 8

enum world_channel {
    WORLD_ENCODER_LEFT,
    WORLD_ENCODER_RIGHT,
    WORLD_PITCH_RATE,
    WORLD_YAW_RATE,
    WORLD_ACCEL_X,
    WORLD_ACCEL_Z,
    WORLD_CURRENT_LEFT,
    WORLD_CURRENT_RIGHT,
    WORLD_BUS_VOLTAGE,
    WORLD_HAL_READ, /**< the HAL's read fails, whatever the kind */
    WORLD_HAL_WRITE /**< the HAL's write fails, whatever the kind, and switches the bridges off */
};

enum world_fault_kind {
    WORLD_FROZEN, /**< keeps the value of the last read before the fault */
    WORLD_JUMPED, /**< `value` is added: counters wrap, the others saturate */
    WORLD_SCALED, /**< reads `value`, Q16, times what is measured, saturated; no counter */
    WORLD_STUCK   /**< reads `value` */
};

/** What goes wrong with one channel in the ticks from…until − 1. */
struct world_fault {
    enum world_channel channel;
    enum world_fault_kind kind;
    int32_t value;  /**< in the channel's format of sensors.h, but where its kind says else */
    uint64_t from;  /**< tick */
    uint64_t until; /**< tick; 0: for ever */
};

/** Those of a robot; zero-initialised: none. */
struct world_faults {
    struct world_fault list[WORLD_FAULTS_MAX];
    size_t count;
    struct jp_sensors last_read;
};

/** False when there are WORLD_FAULTS_MAX already. */
bool world_faults_add(struct world_faults *faults, const struct world_fault *fault);

/** WORLD_HAL_READ or WORLD_HAL_WRITE fails at this tick. */
bool world_faults_fail(const struct world_faults *faults, enum world_channel channel, uint64_t tick);

/** Spoils what was read at this tick. */
void world_faults_apply(struct world_faults *faults, uint64_t tick, struct jp_sensors *sensors);

#endif
