#include <joulepath/skid_monitor.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/in_a_row.h"
#include "src/base/integer.h"

/** 1/g, s²/m. */
#define G_PER_ACCELERATION JP_Q24(0.10197162129779283)

#define AMPERES_MAX JP_Q16(2047)

#define FIELD(member, low, high) JP_CONFIG_FIELD("wheels.", struct jp_skid_monitor_config, member, low, high)

enum jp_status jp_skid_monitor_check(const struct jp_skid_monitor_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(upright, 0, JP_Q24_ONE),
        FIELD(smoothing, 1, INT32_MAX),
        FIELD(stall_current, 1, INT32_MAX),
        FIELD(stall_rate, 1, INT32_MAX),
        FIELD(friction, 0, AMPERES_MAX),
        FIELD(carried, 1, AMPERES_MAX),
        FIELD(turn_per_wheel, 1, JP_Q24(8)),
        FIELD(spin_rate, 1, INT32_MAX),
        FIELD(slope_calls, 1, UINT16_MAX),
        FIELD(stall_calls, 1, UINT16_MAX),
        FIELD(contradicted_calls, 1, UINT16_MAX),
    };

    return jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);
}

void jp_skid_monitor_start(struct jp_skid_monitor *monitor, jp_q24 tilt_limit)
{
    *monitor = (struct jp_skid_monitor){.steepest = jp_sin((jp_angle)tilt_limit << 8) >> 7};
}

static JP_INLINE_FOR_SPEED int32_t smoothed(int32_t past, int32_t now, jp_q31 share)
{
    return jp_add(past, jp_share(jp_sub(now, past), share, 31));
}

/* The ground. */

bool jp_skid_monitor_is_steep(const struct jp_skid_monitor *monitor, const struct jp_skid_monitor_config *config)
{
    return !monitor->started || jp_is_beyond(monitor->rise, monitor->steepest) || monitor->upright < config->upright;
}

uint16_t jp_skid_monitor_ground(struct jp_skid_monitor *monitor, const struct jp_skid_monitor_config *config,
                                const struct jp_sensors *sensors, jp_q24 acceleration)
{
    const jp_q24 rise = jp_sub(sensors->accel_x, jp_share(acceleration, G_PER_ACCELERATION, 24));

    monitor->rise = monitor->started ? smoothed(monitor->rise, rise, config->smoothing) : rise;
    monitor->upright =
        monitor->started ? smoothed(monitor->upright, sensors->accel_z, config->smoothing) : sensors->accel_z;
    monitor->started = true;

    const bool steep = jp_skid_monitor_is_steep(monitor, config);
    const bool fault = jp_count_in_a_row(&monitor->slope_calls, steep, config->slope_calls);

    return fault ? (uint16_t)JP_FAULT_SLOPE : 0U;
}

/* The wheels. */

/** By what the encoder counted: the tracked rate goes along with each change of the reference. */
static bool is_stalled(const struct jp_skid_monitor_config *config, const struct jp_skid_motion *motion, unsigned side)
{
    const int64_t rolled = (int64_t)motion->control->sides[side].rolled;
    const int64_t stalled = (int64_t)jp_phase_step(config->stall_rate, motion->control->phase_per_rate);

    return jp_magnitude32(motion->current[side]) >= (uint32_t)config->stall_current && jp_absolute64(rolled) < stalled;
}

/** Of a current, what the ground takes when the wheel turns as `reference` says, A. */
static jp_q16 of_the_ground(const struct jp_skid_monitor_config *config, jp_q16 current, jp_turns_per_s reference)
{
    return jp_sub(reference < 0 ? jp_sub(0, current) : current, config->friction);
}

/** Parts of what the ground should take from the motor, A. */
struct burden {
    bool judged;
    bool free;    /**< less than a quarter of it */
    bool carries; /**< more than a half of it */
};

static struct burden burden_of(const struct jp_skid_monitor *monitor, const struct jp_skid_monitor_config *config,
                               unsigned side, jp_turns_per_s reference)
{
    const jp_q16 expected = of_the_ground(config, monitor->load[side], reference);
    const jp_q16 taken = of_the_ground(config, monitor->current[side], reference);

    return (struct burden){
        .judged = reference != 0 && expected >= config->carried,
        .free = (taken < expected / 4),
        .carries = (taken > expected / 2),
    };
}

static bool is_in_the_air(const struct jp_skid_monitor *monitor, const struct jp_skid_monitor_config *config,
                          const struct jp_skid_control *control)
{
    const struct burden left = burden_of(monitor, config, JP_SKID_LEFT, control->sides[JP_SKID_LEFT].reference);
    const struct burden right = burden_of(monitor, config, JP_SKID_RIGHT, control->sides[JP_SKID_RIGHT].reference);

    return left.judged && right.judged && ((left.free && right.carries) || (left.carries && right.free));
}

static bool contradicts(const struct jp_skid_monitor_config *config, const struct jp_skid_motion *motion)
{
    const struct jp_skid_side *sides = motion->control->sides;
    const jp_q24 ahead = jp_sub(sides[JP_SKID_RIGHT].rate, sides[JP_SKID_LEFT].rate);
    const jp_turns_per_s turning = jp_q24_multiply(jp_q24_multiply(ahead, config->turn_per_wheel), motion->steering);
    const uint32_t size = jp_magnitude32(turning);

    return jp_magnitude32(jp_sub(motion->turn_rate, turning)) > (uint32_t)config->spin_rate + (size - size / 4U);
}

/** Of one side: its fault, or none. */
static unsigned stall_of(struct jp_skid_monitor *monitor, const struct jp_skid_monitor_config *config,
                         const struct jp_skid_motion *motion, unsigned side)
{
    const bool stalled = is_stalled(config, motion, side);
    const unsigned fault =
        side == (unsigned)JP_SKID_LEFT ? (unsigned)JP_FAULT_STALLED_LEFT : (unsigned)JP_FAULT_STALLED_RIGHT;

    return jp_count_in_a_row(&monitor->stalled_calls[side], stalled, config->stall_calls) ? fault : 0U;
}

uint16_t jp_skid_monitor_wheels(struct jp_skid_monitor *monitor, const struct jp_skid_monitor_config *config,
                                const struct jp_skid_motion *motion)
{
    const struct jp_skid_control *control = motion->control;
    unsigned faults = 0;

    for (unsigned side = 0; side < (unsigned)JP_SKID_SIDES; side++) {
        monitor->load[side] = smoothed(monitor->load[side], control->sides[side].load, config->smoothing);
        monitor->current[side] = smoothed(monitor->current[side], motion->current[side], config->smoothing);
        faults |= stall_of(monitor, config, motion, side);
    }
    if (jp_count_in_a_row(&monitor->air_calls, motion->straight && is_in_the_air(monitor, config, control),
                          config->contradicted_calls)) {
        faults |= JP_FAULT_WHEEL_IN_AIR;
    }
    if (jp_count_in_a_row(&monitor->spin_calls, contradicts(config, motion), config->contradicted_calls)) {
        faults |= JP_FAULT_WHEELS_SPIN;
    }
    return (uint16_t)faults;
}
