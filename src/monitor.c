#include <joulepath/monitor.h>

#include <stddef.h>

static const char *first_bad_field(const struct jp_monitor_config *config)
{
    if (config->tilt_limit < JP_Q24(0.01) || config->tilt_limit > JP_Q24(0.25)) {
        return "monitor.tilt_limit";
    }
    if (config->gyro_limit <= 0) {
        return "monitor.gyro_limit";
    }
    if (config->gyro_jump <= 0) {
        return "monitor.gyro_jump";
    }
    if (config->accel_limit <= JP_Q24_ONE) {
        return "monitor.accel_limit";
    }
    if (config->encoder_jump == 0U || config->encoder_jump > (uint32_t)INT32_MAX) {
        return "monitor.encoder_jump";
    }
    if (config->current_limit <= 0) {
        return "monitor.current_limit";
    }
    if (config->voltage_min <= 0) {
        return "monitor.voltage_min";
    }
    if (config->voltage_max <= config->voltage_min) {
        return "monitor.voltage_max";
    }
    if (config->motor_resistance < JP_Q16(0.01) || config->motor_resistance > JP_Q16(256)) {
        return "monitor.motor_resistance";
    }
    if (config->back_emf <= 0) {
        return "monitor.back_emf";
    }
    if (config->half_track <= 0 || config->half_track > JP_Q16(64)) {
        return "monitor.half_track";
    }
    if (config->wheel_rate_limit <= 0) {
        return "monitor.wheel_rate_limit";
    }
    if (config->current_residual <= 0) {
        return "monitor.current_residual";
    }
    if (config->confirm_ticks == 0U) {
        return "monitor.confirm_ticks";
    }
    if (config->residual_ticks == 0U) {
        return "monitor.residual_ticks";
    }
    return NULL;
}

enum jp_status jp_monitor_check(const struct jp_monitor_config *config, const char **field)
{
    *field = first_bad_field(config);
    return *field == NULL ? JP_OK : JP_ERR_CONFIG;
}

void jp_monitor_start(struct jp_monitor *monitor)
{
    *monitor = (struct jp_monitor){.started = false};
}

static bool beyond(int32_t value, int32_t limit)
{
    return value > limit || value < -limit;
}

/** |a − b| > limit for wrapping counts. */
static bool counts_jump(uint32_t a, uint32_t b, uint32_t limit)
{
    uint32_t forward = a - b;
    uint32_t backward = b - a;

    return forward > limit && backward > limit;
}

static uint16_t ranges(const struct jp_monitor_config *config, const struct jp_sensors *sensors)
{
    unsigned faults = 0;

    if (beyond(sensors->pitch_rate, config->gyro_limit) || beyond(sensors->yaw_rate, config->gyro_limit) ||
        beyond(sensors->accel_x, config->accel_limit) || beyond(sensors->accel_z, config->accel_limit)) {
        faults |= JP_FAULT_IMU_RANGE;
    }
    if (beyond(sensors->current_left, config->current_limit) || beyond(sensors->current_right, config->current_limit)) {
        faults |= JP_FAULT_CURRENT_RANGE;
    }
    if (sensors->bus_voltage < config->voltage_min || sensors->bus_voltage > config->voltage_max) {
        faults |= JP_FAULT_BUS_VOLTAGE;
    }
    return (uint16_t)faults;
}

static uint16_t jumps(const struct jp_monitor_config *config, const struct jp_sensors *before,
                      const struct jp_sensors *sensors)
{
    unsigned faults = 0;

    if (beyond(jp_sub(sensors->pitch_rate, before->pitch_rate), config->gyro_jump) ||
        beyond(jp_sub(sensors->yaw_rate, before->yaw_rate), config->gyro_jump)) {
        faults |= JP_FAULT_IMU_JUMP;
    }
    if (counts_jump(sensors->encoder_left, before->encoder_left, config->encoder_jump) ||
        counts_jump(sensors->encoder_right, before->encoder_right, config->encoder_jump)) {
        faults |= JP_FAULT_ENCODER_JUMP;
    }
    return (uint16_t)faults;
}

/** Counts ticks in a row; true once there are `limit`. */
static bool persists(uint16_t *ticks, bool condition, uint16_t limit)
{
    if (!condition) {
        *ticks = 0;
        return false;
    }
    if (*ticks < limit) {
        (*ticks)++;
    }
    return *ticks >= limit;
}

/** True once one channel has repeated itself to the bit for so long. */
static bool imu_frozen(struct jp_monitor *monitor, const struct jp_monitor_config *config,
                       const struct jp_sensors *sensors)
{
    const struct jp_sensors *before = &monitor->good;
    const bool repeats[JP_IMU_CHANNELS] = {sensors->pitch_rate == before->pitch_rate,
                                           sensors->yaw_rate == before->yaw_rate, sensors->accel_x == before->accel_x,
                                           sensors->accel_z == before->accel_z};
    bool frozen = false;

    for (unsigned i = 0; i < JP_IMU_CHANNELS; i++) {
        if (persists(&monitor->frozen_ticks[i], config->freeze_ticks != 0U && repeats[i], config->freeze_ticks)) {
            frozen = true;
        }
    }
    return frozen;
}

uint16_t jp_monitor_sensors(struct jp_monitor *monitor, const struct jp_monitor_config *config, enum jp_status read,
                            struct jp_sensors *sensors)
{
    unsigned suspected = read == JP_OK ? ranges(config, sensors) : (unsigned)JP_FAULT_HARDWARE;
    bool frozen = false;

    if (read == JP_OK && monitor->started) {
        suspected |= jumps(config, &monitor->good, sensors);
        frozen = imu_frozen(monitor, config, sensors);
    }

    bool confirmed = persists(&monitor->implausible_ticks, suspected != 0U, config->confirm_ticks);

    if (suspected == 0U) {
        monitor->good = *sensors;
        monitor->started = true;
    } else if (monitor->started) {
        *sensors = monitor->good;
    }
    return (uint16_t)((confirmed ? suspected : 0U) | (frozen ? (unsigned)JP_FAULT_IMU_FROZEN : 0U));
}

static bool contradicts(const struct jp_monitor_config *config, jp_q16 current, jp_q16 voltage, jp_q24 rate)
{
    jp_q16 back_emf = jp_multiply_shift(rate, config->back_emf, 24);

    /* Compared as voltages: no division. */
    jp_q16 residual = jp_sub(jp_q16_multiply(current, config->motor_resistance), jp_sub(voltage, back_emf));

    return beyond(residual, jp_q16_multiply(config->current_residual, config->motor_resistance));
}

uint16_t jp_monitor_motors(struct jp_monitor *monitor, const struct jp_monitor_config *config,
                           const struct jp_sensors *sensors, const jp_q16 voltages[2], jp_q24 wheel_rate,
                           jp_q24 yaw_rate)
{
    jp_q24 turning = jp_q16_multiply(yaw_rate, config->half_track);
    bool left = contradicts(config, sensors->current_left, voltages[0], jp_sub(wheel_rate, turning));
    bool right = contradicts(config, sensors->current_right, voltages[1], jp_add(wheel_rate, turning));
    unsigned faults = 0;

    if (persists(&monitor->residual_ticks[0], left, config->residual_ticks)) {
        faults |= JP_FAULT_ENCODER_LEFT;
    }
    if (persists(&monitor->residual_ticks[1], right, config->residual_ticks)) {
        faults |= JP_FAULT_ENCODER_RIGHT;
    }
    if (persists(&monitor->overspeed_ticks, beyond(wheel_rate, config->wheel_rate_limit), config->confirm_ticks)) {
        faults |= JP_FAULT_OVERSPEED;
    }
    return (uint16_t)faults;
}
