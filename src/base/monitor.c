#include <joulepath/monitor.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/in_a_row.h"
#include "src/base/integer.h"

/** Rm i fits Q16 volts, V in Q32. */
#define RESISTIVE_LIMIT ((int64_t)JP_Q16(32767) * JP_Q16_ONE)

/** What an impact can explain. */
#define IMU_FAULTS ((unsigned)JP_FAULT_IMU_RANGE | (unsigned)JP_FAULT_IMU_JUMP)

#define FIELD(member, low, high) JP_CONFIG_FIELD("monitor.", struct jp_monitor_config, member, low, high)

enum jp_status jp_monitor_check(const struct jp_monitor_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(tilt_limit, JP_Q24(0.01), JP_Q24(0.25)),
        FIELD(gyro_limit, 1, INT32_MAX),
        FIELD(gyro_jump, 1, INT32_MAX),
        FIELD(accel_limit, JP_Q24_ONE + 1, INT32_MAX),
        FIELD(encoder_jump, 1, INT32_MAX),
        FIELD(current_limit, 1, INT32_MAX),
        FIELD(voltage_min, 1, INT32_MAX),
        FIELD(voltage_max, 1, JP_Q16(1000)),
        FIELD(motor_resistance, JP_Q16(0.01), INT32_MAX),
        FIELD(back_emf, 1, JP_Q16(256) - 1),
        FIELD(half_track, 1, JP_Q16(64)),
        FIELD(wheel_rate_limit, 1, INT32_MAX),
        FIELD(current_residual, 1, INT32_MAX),
        FIELD(confirm_ticks, 1, UINT16_MAX),
        FIELD(residual_ticks, 1, UINT16_MAX),
    };
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status != JP_OK) {
        return status;
    }
    if (config->voltage_max <= config->voltage_min) {
        return jp_config_refuse("monitor.voltage_max", field);
    }
    if ((int64_t)config->current_limit * config->motor_resistance > RESISTIVE_LIMIT) {
        return jp_config_refuse("monitor.current_limit", field);
    }
    return JP_OK;
}

void jp_monitor_start(struct jp_monitor *monitor, const struct jp_monitor_config *config)
{
    *monitor = (struct jp_monitor){
        .residual_limit = jp_q16_multiply(config->current_residual, config->motor_resistance),
    };
}

static JP_INLINE_FOR_SPEED bool either_beyond(int32_t a, int32_t b, int32_t limit)
{
    return jp_is_beyond(a, limit) || jp_is_beyond(b, limit);
}

static bool gyro_beyond(const struct jp_monitor_config *config, const struct jp_sensors *sensors)
{
    return either_beyond(sensors->pitch_rate, sensors->yaw_rate, config->gyro_limit);
}

static bool accel_beyond(const struct jp_monitor_config *config, const struct jp_sensors *sensors)
{
    return either_beyond(sensors->accel_x, sensors->accel_z, config->accel_limit);
}

static uint16_t ranges(const struct jp_monitor_config *config, const struct jp_sensors *sensors)
{
    unsigned faults = 0;

    if (gyro_beyond(config, sensors) || accel_beyond(config, sensors)) {
        faults |= JP_FAULT_IMU_RANGE;
    }
    if (either_beyond(sensors->current_left, sensors->current_right, config->current_limit)) {
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

    if (either_beyond(jp_sub(sensors->pitch_rate, before->pitch_rate), jp_sub(sensors->yaw_rate, before->yaw_rate),
                      config->gyro_jump)) {
        faults |= JP_FAULT_IMU_JUMP;
    }
    if (either_beyond((int32_t)(sensors->encoder_left - before->encoder_left),
                      (int32_t)(sensors->encoder_right - before->encoder_right), (int32_t)config->encoder_jump)) {
        faults |= JP_FAULT_ENCODER_JUMP;
    }
    return (uint16_t)faults;
}

/** What motors and tyres cannot do within a tick: specific force that changes by more than the weight, or leaves the
 *  range, which `ranges` then has found. */
static bool feels_impact(const struct jp_monitor_config *config, const struct jp_sensors *before,
                         const struct jp_sensors *sensors, unsigned ranges)
{
    return either_beyond(jp_sub(sensors->accel_x, before->accel_x), jp_sub(sensors->accel_z, before->accel_z),
                         JP_Q24_ONE) ||
           ((ranges & (unsigned)JP_FAULT_IMU_RANGE) != 0U && accel_beyond(config, sensors));
}

/** True from the tick after an impact until there was none for so long. */
static bool is_shaken(struct jp_monitor *monitor, uint16_t limit, bool impact)
{
    const bool was_shaken = monitor->shaken;

    if (!was_shaken && !impact) {
        return false;
    }
    if (!was_shaken) {
        monitor->explained_ticks = 0;
    }
    monitor->shaken = !jp_count_in_a_row(&monitor->calm_ticks, !impact, limit);
    return was_shaken && monitor->shaken;
}

/** True once one channel has repeated itself to the bit for so long. */
static bool watch_for_frozen_imu(struct jp_monitor *monitor, uint16_t limit, const struct jp_sensors *sensors)
{
    const struct jp_sensors *before = &monitor->good;
    uint16_t *ticks = monitor->frozen_ticks;
    bool pitch_rate = jp_count_in_a_row(&ticks[0], sensors->pitch_rate == before->pitch_rate, limit);
    bool yaw_rate = jp_count_in_a_row(&ticks[1], sensors->yaw_rate == before->yaw_rate, limit);
    bool accel_x = jp_count_in_a_row(&ticks[2], sensors->accel_x == before->accel_x, limit);
    bool accel_z = jp_count_in_a_row(&ticks[3], sensors->accel_z == before->accel_z, limit);

    return pitch_rate || yaw_rate || accel_x || accel_z;
}

/** Whether an impact explains all that is wrong with the IMU, which it does two times fewer than `residual_ticks`; what
 *  it drives out of its range is the range's end. */
static bool is_explained(struct jp_monitor *monitor, const struct jp_monitor_config *config,
                         const struct jp_sensors *sensors, unsigned suspected)
{
    const bool impact = feels_impact(config, &monitor->good, sensors, suspected);

    if (!is_shaken(monitor, config->residual_ticks, impact) || (suspected & IMU_FAULTS) == 0U ||
        gyro_beyond(config, sensors)) {
        return false;
    }
    return !jp_count_in_a_row(&monitor->explained_ticks, true, (uint16_t)(config->residual_ticks - 1U));
}

static void limit_forces(struct jp_sensors *sensors, jp_q24 limit)
{
    sensors->accel_x = jp_clamp32(sensors->accel_x, -limit, limit);
    sensors->accel_z = jp_clamp32(sensors->accel_z, -limit, limit);
}

/** Of what is suspected, what lasts: a frame that is held ends nothing. */
static unsigned confirmed(struct jp_monitor *monitor, uint16_t limit, bool is_held)
{
    const unsigned suspected = monitor->suspected;

    if (suspected == 0U && is_held) {
        return 0U;
    }
    return jp_count_in_a_row(&monitor->implausible_ticks, suspected != 0U, limit) ? suspected : 0U;
}

uint16_t jp_monitor_sensors(struct jp_monitor *monitor, const struct jp_monitor_config *config, enum jp_status read,
                            const struct jp_sensors *sensors)
{
    const bool is_held = read == JP_HELD;
    const bool is_read = read == JP_OK || is_held;
    unsigned suspected = is_read ? ranges(config, sensors) : (unsigned)JP_FAULT_HARDWARE;
    bool explained = false;
    bool frozen = false;

    if (is_read && monitor->started) {
        suspected |= jumps(config, &monitor->good, sensors);
        explained = is_explained(monitor, config, sensors, suspected);
        suspected &= explained ? ~IMU_FAULTS : ~0U;
        frozen = !is_held && config->freeze_ticks != 0U && watch_for_frozen_imu(monitor, config->freeze_ticks, sensors);
    }

    monitor->suspected = (uint16_t)suspected;

    const unsigned faults = confirmed(monitor, config->confirm_ticks, is_held);

    if (suspected == 0U) {
        monitor->good = *sensors;
        monitor->started = true;
        if (explained) {
            limit_forces(&monitor->good, config->accel_limit);
        }
    } else {
        monitor->dropped_frames++;
    }
    return (uint16_t)(faults | (frozen ? (unsigned)JP_FAULT_IMU_FROZEN : 0U));
}

/** Rm i − (u − kb ω): compared as a voltage there is no division. */
static JP_INLINE_FOR_SPEED jp_q16 voltage_residual(const struct jp_monitor_config *config, jp_q16 current,
                                                   jp_q16 voltage, jp_q24 rate)
{
    /* Neither saturates: the checked configuration leaves no room for it. */
    jp_q16 back_emf = (jp_q16)((jp_multiply(rate, config->back_emf) + JP_Q24_ONE / 2) >> 24);
    jp_q16 resistive = (jp_q16)((jp_multiply(current, config->motor_resistance) + JP_Q16_ONE / 2) >> 16);

    return jp_sub(resistive, jp_sub(voltage, back_emf));
}

uint16_t jp_monitor_motors(struct jp_monitor *monitor, const struct jp_monitor_config *config,
                           const struct jp_voltages *voltages, jp_q24 wheel_rate, jp_q24 yaw_rate)
{
    const struct jp_sensors *sensors = &monitor->good;
    jp_q16 limit = monitor->residual_limit;
    jp_q24 turning = jp_q16_multiply(yaw_rate, config->half_track);
    bool left = jp_is_beyond(
        voltage_residual(config, sensors->current_left, voltages->left, jp_sub(wheel_rate, turning)), limit);
    bool right = jp_is_beyond(
        voltage_residual(config, sensors->current_right, voltages->right, jp_add(wheel_rate, turning)), limit);
    unsigned faults = 0;

    if (jp_count_in_a_row(&monitor->residual_ticks[0], left, config->residual_ticks)) {
        faults |= JP_FAULT_ENCODER_LEFT;
    }
    if (jp_count_in_a_row(&monitor->residual_ticks[1], right, config->residual_ticks)) {
        faults |= JP_FAULT_ENCODER_RIGHT;
    }
    if (jp_count_in_a_row(&monitor->overspeed_ticks, jp_is_beyond(wheel_rate, config->wheel_rate_limit),
                          config->confirm_ticks)) {
        faults |= JP_FAULT_OVERSPEED;
    }
    return (uint16_t)faults;
}
