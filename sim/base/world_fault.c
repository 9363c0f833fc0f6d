#include "sim/base/world_fault.h"

#include <joulepath/fixed.h>
#include <string.h>

/* Offset of each channel; all are 32 bits wide. */
static const size_t channel_offsets[] = {
    [WORLD_ENCODER_LEFT] = offsetof(struct jp_sensors, encoder_left),
    [WORLD_ENCODER_RIGHT] = offsetof(struct jp_sensors, encoder_right),
    [WORLD_PITCH_RATE] = offsetof(struct jp_sensors, pitch_rate),
    [WORLD_YAW_RATE] = offsetof(struct jp_sensors, yaw_rate),
    [WORLD_ACCEL_X] = offsetof(struct jp_sensors, accel_x),
    [WORLD_ACCEL_Z] = offsetof(struct jp_sensors, accel_z),
    [WORLD_CURRENT_LEFT] = offsetof(struct jp_sensors, current_left),
    [WORLD_CURRENT_RIGHT] = offsetof(struct jp_sensors, current_right),
    [WORLD_BUS_VOLTAGE] = offsetof(struct jp_sensors, bus_voltage),
};

bool world_faults_add(struct world_faults *faults, const struct world_fault *fault)
{
    if (faults->count == WORLD_FAULTS_MAX) {
        return false;
    }
    faults->list[faults->count++] = *fault;
    return true;
}

static bool is_active(const struct world_fault *fault, uint64_t tick)
{
    return tick >= fault->from && (fault->until == 0 || tick < fault->until);
}

bool world_faults_fail(const struct world_faults *faults, enum world_channel channel, uint64_t tick)
{
    for (size_t i = 0; i < faults->count; i++) {
        if (faults->list[i].channel == channel && is_active(&faults->list[i], tick)) {
            return true;
        }
    }
    return false;
}

static uint32_t faulty_value(const struct world_fault *fault, uint32_t measured, uint32_t last)
{
    switch (fault->kind) {
    case WORLD_FROZEN:
        return last;
    case WORLD_STUCK:
        return (uint32_t)fault->value;
    case WORLD_SCALED:
        return (uint32_t)jp_multiply_shift((int32_t)measured, fault->value, 16);
    default:
        break;
    }
    if (fault->channel == WORLD_ENCODER_LEFT || fault->channel == WORLD_ENCODER_RIGHT) {
        return measured + (uint32_t)fault->value;
    }
    return (uint32_t)jp_saturate32((int64_t)(int32_t)measured + fault->value);
}

void world_faults_apply(struct world_faults *faults, uint64_t tick, struct jp_sensors *sensors)
{
    for (size_t i = 0; i < faults->count; i++) {
        const struct world_fault *fault = &faults->list[i];

        if (fault->channel > WORLD_BUS_VOLTAGE || !is_active(fault, tick)) {
            continue;
        }

        const size_t offset = channel_offsets[fault->channel];
        uint32_t value;
        uint32_t last_value;

        memcpy(&value, (const char *)sensors + offset, sizeof value);
        memcpy(&last_value, (const char *)&faults->last_read + offset, sizeof last_value);
        value = faulty_value(fault, value, last_value);
        memcpy((char *)sensors + offset, &value, sizeof value);
    }
    faults->last_read = *sensors;
}
