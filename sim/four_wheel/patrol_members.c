#include "sim/four_wheel/patrol_members.h"

#include <joulepath/patrol_pilot.h>
#include <joulepath/pure_pursuit.h>
#include <stdbool.h>
#include <string.h>

#define TWO_32 4294967296.0

#define MEMBER(type, member, format, unit)                                                                             \
    {                                                                                                                  \
#member, offsetof(struct type, member), sizeof(((struct type *)0)->member), format, unit                       \
    }
#define PATROL(member, format, unit)    MEMBER(jp_patrol_config, member, format, unit)
#define PURSUIT(member, format, unit)   MEMBER(jp_pure_pursuit_config, member, format, unit)
#define LOCALISER(member, format, unit) MEMBER(jp_localiser_config, member, format, unit)
#define SCANNER(member, format, unit)   MEMBER(jp_patrol_scanner, member, format, unit)
#define ROBOT(member, format, unit)     MEMBER(jp_four_wheel_robot_config, member, format, unit)

const char *const patrol_format_names[PATROL_FORMATS] = {"float", "q16", "q24", "q32", "angle", "whole", "flag"};

const struct patrol_member patrol_members[] = {
    PATROL(wheels.wheelbase, PATROL_Q24, "m"),
    PATROL(wheels.track, PATROL_Q24, "m"),
    PATROL(wheels.steering_limit, PATROL_ANGLE, "turn"),
    PATROL(wheels.steering_step, PATROL_ANGLE, "turn"),
    PATROL(wheels.speed_max, PATROL_Q24, "m/s"),
    PATROL(wheels.speed_step, PATROL_Q24, "m/s"),
    PATROL(teb.speed_max, PATROL_FLOAT, "m/s"),
    PATROL(teb.reverse_max, PATROL_FLOAT, "m/s"),
    PATROL(teb.turn_rate_max, PATROL_FLOAT, "rad/s"),
    PATROL(teb.acceleration, PATROL_FLOAT, "m/s²"),
    PATROL(teb.turn_acceleration, PATROL_FLOAT, "rad/s²"),
    PATROL(teb.radius_min, PATROL_FLOAT, "m"),
    PATROL(teb.footprint.front, PATROL_FLOAT, "m"),
    PATROL(teb.footprint.rear, PATROL_FLOAT, "m"),
    PATROL(teb.footprint.half_width, PATROL_FLOAT, "m"),
    PATROL(teb.clearance, PATROL_FLOAT, "m"),
    PATROL(teb.interval, PATROL_FLOAT, "s"),
    PATROL(teb.hysteresis, PATROL_FLOAT, "s"),
    PATROL(teb.rounds, PATROL_WHOLE, "1"),
    PATROL(teb.steps, PATROL_WHOLE, "1"),
    PATROL(teb.weights.nonholonomic, PATROL_FLOAT, "1/m²"),
    PATROL(teb.weights.speed, PATROL_FLOAT, "s²/m²"),
    PATROL(teb.weights.turn_rate, PATROL_FLOAT, "s²/rad²"),
    PATROL(teb.weights.turn_radius, PATROL_FLOAT, "s²/m²"),
    PATROL(teb.weights.acceleration, PATROL_FLOAT, "s⁴/m²"),
    PATROL(teb.weights.turn_acceleration, PATROL_FLOAT, "s⁴/rad²"),
    PATROL(teb.weights.obstacle, PATROL_FLOAT, "1/m²"),
    PATROL(teb.weights.path, PATROL_FLOAT, "1/m²"),
    PATROL(teb.weights.second, PATROL_FLOAT, "1/s"),
    PATROL(teb.weights.metre, PATROL_FLOAT, "1/m"),
    PATROL(teb.weights.drag, PATROL_FLOAT, "s/m²"),
    PATROL(teb.weights.no_reversing, PATROL_FLOAT, "s²/m²"),
    PATROL(teb.weights.wheel_odometry, PATROL_FLOAT, "1/m²"),
    PATROL(teb.weights.laser_odometry, PATROL_FLOAT, "1/m²"),
    PATROL(scan.range_max, PATROL_FLOAT, "m"),
    PATROL(scan.gap, PATROL_FLOAT, "m"),
    PATROL(scan.tolerance, PATROL_FLOAT, "m"),
    PATROL(scan.beams_min, PATROL_WHOLE, "1"),
    PATROL(movers.extent, PATROL_FLOAT, "m"),
    PATROL(movers.range, PATROL_FLOAT, "m"),
    PATROL(movers.speed_min, PATROL_FLOAT, "m/s"),
    PATROL(movers.speed_max, PATROL_FLOAT, "m/s"),
    PATROL(movers.margin, PATROL_FLOAT, "m"),
    PATROL(people.clearance, PATROL_FLOAT, "m"),
    PATROL(people.braking, PATROL_FLOAT, "m/s²"),
    PATROL(people.acceleration, PATROL_FLOAT, "m/s²"),
    PATROL(people.rest, PATROL_FLOAT, "s"),
    PATROL(people.stays, PATROL_FLOAT, "s"),
    PATROL(turns_in_place, PATROL_FLAG, "1"),
    PATROL(strategy, PATROL_WHOLE, "1"),
    PATROL(price.second, PATROL_FLOAT, "W"),
    PATROL(price.worth, PATROL_FLOAT, "W"),
    PATROL(price.turning, PATROL_FLOAT, "J/rad"),
    PATROL(price.steering, PATROL_FLOAT, "J/rad"),
    PATROL(glide_clearance, PATROL_FLOAT, "m"),
    PATROL(turn_first, PATROL_FLOAT, "rad"),
    PATROL(turn_rate, PATROL_FLOAT, "rad/s"),
    PATROL(turn_acceleration, PATROL_FLOAT, "rad/s²"),
    PATROL(steering_rate, PATROL_FLOAT, "rad/s"),
    PATROL(turn_clearance, PATROL_FLOAT, "m"),
    PATROL(step_speed, PATROL_FLOAT, "m/s"),
    PATROL(horizon, PATROL_FLOAT, "m"),
    PATROL(position_tolerance, PATROL_FLOAT, "m"),
    PATROL(heading_tolerance, PATROL_FLOAT, "rad"),
    PATROL(period, PATROL_FLOAT, "s"),
    PATROL(latency, PATROL_FLOAT, "s"),
    PATROL(jump, PATROL_FLOAT, "m"),
    PATROL(waits_max, PATROL_WHOLE, "cycles"),
    PATROL(dropouts_max, PATROL_WHOLE, "cycles"),
    PATROL(blind_max, PATROL_FLOAT, "m"),
};

const size_t patrol_member_count = sizeof patrol_members / sizeof patrol_members[0];

const struct patrol_member patrol_pursuit_members[] = {
    PURSUIT(speed, PATROL_Q24, "m/s"),         PURSUIT(lookahead_time, PATROL_Q24, "s"),
    PURSUIT(lookahead_min, PATROL_Q24, "m"),   PURSUIT(lookahead_max, PATROL_Q24, "m"),
    PURSUIT(curvature_max, PATROL_Q24, "1/m"), PURSUIT(lateral_acceleration, PATROL_Q24, "m/s²"),
    PURSUIT(acceleration, PATROL_Q24, "m/s²"), PURSUIT(tolerance, PATROL_Q24, "m"),
};

const size_t patrol_pursuit_member_count = sizeof patrol_pursuit_members / sizeof patrol_pursuit_members[0];

const struct patrol_member patrol_localiser_members[] = {
    LOCALISER(beams_max, PATROL_WHOLE, "1"),
    LOCALISER(range_max, PATROL_FLOAT, "m"),
    LOCALISER(noise, PATROL_FLOAT, "m"),
    LOCALISER(wheels.distance, PATROL_FLOAT, "m/m"),
    LOCALISER(wheels.turn, PATROL_FLOAT, "rad/rad"),
    LOCALISER(wheels.deviation, PATROL_FLOAT, "rad/m"),
    LOCALISER(start_distance, PATROL_FLOAT, "m"),
    LOCALISER(start_turn, PATROL_FLOAT, "rad"),
    LOCALISER(lost_distance, PATROL_FLOAT, "m"),
    LOCALISER(lost_turn, PATROL_FLOAT, "rad"),
};

const size_t patrol_localiser_member_count = sizeof patrol_localiser_members / sizeof patrol_localiser_members[0];

const struct patrol_member patrol_scanner_members[] = {
    SCANNER(beams, PATROL_WHOLE, "1"),        SCANNER(first_angle, PATROL_FLOAT, "rad"),
    SCANNER(angle_step, PATROL_FLOAT, "rad"), SCANNER(place.x, PATROL_FLOAT, "m"),
    SCANNER(place.y, PATROL_FLOAT, "m"),      SCANNER(place.heading, PATROL_FLOAT, "rad"),
};

const size_t patrol_scanner_member_count = sizeof patrol_scanner_members / sizeof patrol_scanner_members[0];

const struct patrol_member patrol_robot_members[] = {
    ROBOT(wheels.wheelbase, PATROL_Q24, "m"),
    ROBOT(wheels.track, PATROL_Q24, "m"),
    ROBOT(wheels.steering_limit, PATROL_ANGLE, "turn"),
    ROBOT(wheels.steering_step, PATROL_ANGLE, "turn"),
    ROBOT(wheels.speed_max, PATROL_Q24, "m/s"),
    ROBOT(wheels.speed_step, PATROL_Q24, "m/s"),
    ROBOT(tick_rate, PATROL_WHOLE, "1/s"),
    ROBOT(count_speed, PATROL_Q32, "m/s"),
    ROBOT(piece_ticks, PATROL_WHOLE, "ticks"),
    ROBOT(twist_ticks, PATROL_WHOLE, "ticks"),
    ROBOT(limits.count_jump, PATROL_WHOLE, "counts"),
    ROBOT(limits.current, PATROL_Q16, "A"),
    ROBOT(limits.voltage_min, PATROL_Q16, "V"),
    ROBOT(limits.voltage_max, PATROL_Q16, "V"),
    ROBOT(limits.speed_lag, PATROL_Q24, "m/s"),
    ROBOT(limits.angle_lag, PATROL_ANGLE, "turn"),
    ROBOT(limits.lag_ticks, PATROL_WHOLE, "ticks"),
    ROBOT(limits.confirm_ticks, PATROL_WHOLE, "ticks"),
};

const size_t patrol_robot_member_count = sizeof patrol_robot_members / sizeof patrol_robot_members[0];

static double float_at(const char *place)
{
    float value;

    memcpy(&value, place, sizeof value);
    return (double)value;
}

static double integer_at(const char *place)
{
    int32_t value;

    memcpy(&value, place, sizeof value);
    return value;
}

static double whole_at(const char *place, size_t size)
{
    uint8_t byte;
    uint16_t half;
    uint32_t word;

    memcpy(&byte, place, sizeof byte);
    if (size == sizeof byte) {
        return byte;
    }
    memcpy(&half, place, sizeof half);
    if (size == sizeof half) {
        return half;
    }
    memcpy(&word, place, sizeof word);
    return word;
}

static double flag_at(const char *place)
{
    bool value;

    memcpy(&value, place, sizeof value);
    return value;
}

double patrol_member_value(const void *config, const struct patrol_member *member)
{
    const char *place = (const char *)config + member->offset;

    switch (member->format) {
    case PATROL_FLOAT:
        return float_at(place);
    case PATROL_Q16:
    case PATROL_Q24:
    case PATROL_Q32:
    case PATROL_ANGLE:
        return integer_at(place);
    case PATROL_WHOLE:
        return whole_at(place, member->size);
    default:
        return flag_at(place);
    }
}

double patrol_member_quantity(const void *config, const struct patrol_member *member)
{
    const double value = patrol_member_value(config, member);

    switch (member->format) {
    case PATROL_Q16:
        return value / JP_Q16_ONE;
    case PATROL_Q24:
        return value / JP_Q24_ONE;
    case PATROL_Q32:
    case PATROL_ANGLE:
        return value / TWO_32;
    default:
        return value;
    }
}
