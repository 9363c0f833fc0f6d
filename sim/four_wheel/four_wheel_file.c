#include "sim/four_wheel/four_wheel_file.h"

#include <math.h>
#include <string.h>

#include "sim/base/error.h"
#include "sim/base/strict_math.h"
#include "sim/four_wheel/four_wheel_plant.h"
#include "sim/four_wheel/laser.h"

#define DEGREES_PER_RADIAN (180 / M_PI)
#define TURN_2_32          4294967296.0

#define WEIGHT_MAX 1e6

/* Bounds of the hysteresis as a share of the interval. Above the lower one the halves of an interval that was split are
 * not joined again; below the upper one poses do not pile up. */
#define HYSTERESIS_SHARE_MIN (1.0 / 3)
#define HYSTERESIS_SHARE_MAX 0.8

#define REAL(member, min, max, unit)                                                                                   \
    {                                                                                                                  \
#member, offsetof(struct four_wheel_file, member), 1, CONFIG_FIELD_REAL, min, max, unit, false                 \
    }
#define WHOLE(member, min, max, unit)                                                                                  \
    {                                                                                                                  \
#member, offsetof(struct four_wheel_file, member), 1, CONFIG_FIELD_WHOLE, min, max, unit, false                \
    }

/* The core's formats hold every value (joulepath/four_wheel.h, pure_pursuit.h, teb.h, patrol.h). */
static const struct config_field fields[] = {
    REAL(body.length_m, 0.1, 4, "m"),
    REAL(body.width_m, 0.1, 4, "m"),
    REAL(body.wheelbase_m, 0.05, 4, "m"),
    REAL(body.track_m, 0.05, 4, "m"),
    REAL(body.mass_kg, 1, 1000, "kg"),
    REAL(body.inertia_kg_m2, 0.01, 2000, "kg·m²"),
    REAL(wheel.radius_m, 0.02, 1, "m"),
    REAL(wheel.inertia_kg_m2, 1e-4, 20, "kg·m²"),
    REAL(steering.limit_deg, 10, 120, "°"),
    REAL(steering.rate_rad_s, 0.1, 50, "rad/s"),
    REAL(steering.time_constant_s, 0.005, 1, "s"),
    REAL(steering.friction_nm, 0, 100, "N·m"),
    REAL(steering.contact_m, 0.001, 0.2, "m"),
    REAL(steering.efficiency, 0.1, 1, "1"),
    REAL(steering.torque_constant_nm_a, 0.01, 1000, "N·m/A"),
    REAL(steering.resistance_ohm, 0.001, 100, "Ω"),
    REAL(steering.radius_min_m, 0.1, 10, "m"),
    REAL(drive.speed_m_s, 0.01, 16, "m/s"),
    REAL(drive.acceleration_m_s2, 0.03, 20, "m/s²"),
    REAL(drive.torque_nm, 0.01, 1000, "N·m"),
    REAL(drive.time_constant_s, 0.01, 2, "s"),
    REAL(drive.friction_nm_s_per_rad, 0, 10, "N·m·s/rad"),
    REAL(drive.efficiency, 0.1, 1, "1"),
    REAL(drive.torque_constant_nm_a, 0.01, 1000, "N·m/A"),
    REAL(drive.resistance_ohm, 0.001, 100, "Ω"),
    REAL(tyre.stiffness_n_s_per_m, 10, 100000, "N·s/m"),
    REAL(tyre.friction, 0.05, 2, "1"),
    REAL(tyre.rolling, 0, 0.2, "1"),
    REAL(electronics.voltage_v, 1, 1000, "V"),
    REAL(electronics.power_w, 0.01, 1000, "W"),
    REAL(laser.x_m, -4, 4, "m"),
    REAL(laser.y_m, -4, 4, "m"),
    WHOLE(laser.beams, 8, LASER_BEAMS_MAX, "1"),
    REAL(laser.field_deg, 10, 360, "°"),
    REAL(laser.range_m, 0.5, 100, "m"),
    REAL(laser.noise_m, 0, 0.5, "m"),
    REAL(laser.rate_hz, 1, FOUR_WHEEL_RATE_HZ, "Hz"),
    WHOLE(encoder.wheel_counts_per_turn, 16, 16777216, "1/turn"),
    WHOLE(encoder.steering_counts_per_turn, 360, 16777216, "1/turn"),
    REAL(scan.range_m, 0.5, 100, "m"),
    REAL(scan.gap_m, 0.01, 10, "m"),
    REAL(scan.tolerance_m, 0.001, 1, "m"),
    WHOLE(scan.beams_min, 1, 100, "1"),
    REAL(movers.extent_m, 0.05, 10, "m"),
    REAL(movers.range_m, 0.1, 100, "m"),
    REAL(movers.speed_min_m_s, 0.01, 10, "m/s"),
    REAL(movers.speed_max_m_s, 0.01, 10, "m/s"),
    REAL(movers.margin_m, 0, 10, "m"),
    REAL(people.clearance_m, 0, 10, "m"),
    REAL(people.acceleration_m_s2, 0.1, 100, "m/s²"),
    REAL(people.rest_s, 0, 10, "s"),
    REAL(people.stays_s, 0, 1000, "s"),
    REAL(band.speed_m_s, 0.01, 16, "m/s"),
    REAL(band.reverse_m_s, 0.01, 16, "m/s"),
    REAL(band.turn_rate_rad_s, 0.01, 16, "rad/s"),
    REAL(band.acceleration_m_s2, 0.01, 20, "m/s²"),
    REAL(band.turn_acceleration_rad_s2, 0.01, 100, "rad/s²"),
    REAL(band.clearance_m, 0, 10, "m"),
    REAL(band.interval_s, 0.05, 10, "s"),
    REAL(band.hysteresis_s, 0.01, 10, "s"),
    WHOLE(band.rounds, 1, 8, "1"),
    WHOLE(band.steps, 1, 16, "1"),
    REAL(weights.nonholonomic_per_m2, 0, WEIGHT_MAX, "1/m²"),
    REAL(weights.speed_s2_per_m2, 0, WEIGHT_MAX, "s²/m²"),
    REAL(weights.turn_rate_s2_per_rad2, 0, WEIGHT_MAX, "s²/rad²"),
    REAL(weights.turn_radius_s2_per_m2, 0, WEIGHT_MAX, "s²/m²"),
    REAL(weights.acceleration_s4_per_m2, 0, WEIGHT_MAX, "s⁴/m²"),
    REAL(weights.turn_acceleration_s4_per_rad2, 0, WEIGHT_MAX, "s⁴/rad²"),
    REAL(weights.obstacle_per_m2, 0, WEIGHT_MAX, "1/m²"),
    REAL(weights.path_per_m2, 0, WEIGHT_MAX, "1/m²"),
    REAL(weights.energy_per_j, 0, 1, "1/J"),
    REAL(weights.no_reversing_s2_per_m2, 0, WEIGHT_MAX, "s²/m²"),
    REAL(weights.wheel_odometry_per_m2, 0, WEIGHT_MAX, "1/m²"),
    REAL(weights.laser_odometry_per_m2, 0, WEIGHT_MAX, "1/m²"),
    REAL(turning.from_deg, 1, 179, "°"),
    REAL(turning.rate_rad_s, 0.01, 16, "rad/s"),
    REAL(turning.acceleration_rad_s2, 0.01, 100, "rad/s²"),
    REAL(turning.clearance_m, 0, 10, "m"),
    REAL(turning.glide_clearance_m, 0, 10, "m"),
    REAL(turning.second_w, 0, 1024, "W"),
    REAL(turning.step_m_s, 0.01, 16, "m/s"),
    REAL(patrol.horizon_m, 0.1, 100, "m"),
    REAL(patrol.position_tolerance_m, 0.005, 10, "m"),
    REAL(patrol.heading_tolerance_deg, 0.1, 179, "°"),
    REAL(patrol.latency_s, 0, 1, "s"),
    REAL(patrol.jump_m, 0.01, 10, "m"),
    REAL(patrol.wait_s, 0.1, 1000, "s"),
    WHOLE(patrol.dropouts, 0, 1000, "1"),
    REAL(patrol.blind_m, 0, 1000, "m"),
    REAL(localiser.way_share, 0.001, 1, "1"),
    REAL(localiser.turn_share, 0.001, 1, "1"),
    REAL(localiser.deviation_rad_per_m, 0.001, 1, "rad/m"),
    REAL(localiser.start_m, 0.001, 10, "m"),
    REAL(localiser.start_deg, 0.1, 57, "°"),
    REAL(localiser.lost_m, 0.01, 10, "m"),
    REAL(localiser.lost_deg, 0.6, 57, "°"),
    REAL(pursuit.speed_m_s, 0.01, 16, "m/s"),
    REAL(pursuit.lookahead_s, 0.05, 8, "s"),
    REAL(pursuit.lookahead_min_m, 0.05, 8, "m"),
    REAL(pursuit.lookahead_max_m, 0.05, 64, "m"),
    REAL(pursuit.lateral_acceleration_m_s2, 0.01, 16, "m/s²"),
    REAL(pursuit.acceleration_m_s2, 0.125, 16, "m/s²"),
    REAL(pursuit.tolerance_m, 0.005, 1, "m"),
};

const struct config_kind four_wheel_kind = {"four_wheel", offsetof(struct four_wheel_file, name), fields,
                                            sizeof fields / sizeof fields[0]};

/* A field that must be at most another one. */
struct bound {
    const char *key;
    size_t offset; /* of a double, as the other one */
    const char *limit_key;
    size_t limit_offset;
};

#define BOUND(member, limit)                                                                                           \
    {                                                                                                                  \
#member, offsetof(struct four_wheel_file, member), #limit, offsetof(struct four_wheel_file, limit)             \
    }

static const struct bound bounds[] = {
    BOUND(scan.range_m, laser.range_m),
    BOUND(movers.range_m, laser.range_m),
    BOUND(movers.speed_min_m_s, movers.speed_max_m_s),
    BOUND(band.speed_m_s, drive.speed_m_s),
    BOUND(band.reverse_m_s, drive.speed_m_s),
    BOUND(band.acceleration_m_s2, drive.acceleration_m_s2),
    BOUND(turning.step_m_s, drive.speed_m_s),
    BOUND(patrol.heading_tolerance_deg, turning.from_deg),
    BOUND(pursuit.speed_m_s, drive.speed_m_s),
    BOUND(pursuit.acceleration_m_s2, drive.acceleration_m_s2),
    BOUND(pursuit.lookahead_min_m, pursuit.lookahead_max_m),
};

static double number_at(const struct four_wheel_file *robot, size_t offset)
{
    double number;

    memcpy(&number, (const char *)robot + offset, sizeof number);
    return number;
}

static bool check_bounds(const char *path, const struct four_wheel_file *robot)
{
    for (size_t i = 0; i < sizeof bounds / sizeof bounds[0]; i++) {
        const struct bound *bound = &bounds[i];
        const double value = number_at(robot, bound->offset);
        const double limit = number_at(robot, bound->limit_offset);

        if (value > limit) {
            error_line("%s: %s = %.10g: must be at most %s = %.10g; correct one of them", path, bound->key, value,
                       bound->limit_key, limit);
            return false;
        }
    }
    return true;
}

static bool check_hysteresis(const char *path, const struct four_wheel_file *robot)
{
    const double share = robot->band.hysteresis_s / robot->band.interval_s;

    if (!(share >= HYSTERESIS_SHARE_MIN && share <= HYSTERESIS_SHARE_MAX)) {
        error_line("%s: band.hysteresis_s = %.4g: must be %.4g to %.4g of band.interval_s = %.4g; correct one of them",
                   path, robot->band.hysteresis_s, HYSTERESIS_SHARE_MIN, HYSTERESIS_SHARE_MAX, robot->band.interval_s);
        return false;
    }
    return true;
}

static bool check_radius(const char *path, const struct four_wheel_file *robot)
{
    const struct jp_four_wheel_config config = four_wheel_config(robot);
    const double least = (double)jp_four_wheel_radius_min(&config) / JP_Q24_ONE;

    if (robot->steering.radius_min_m < least) {
        error_line("%s: steering.radius_min_m = %.4g: at steering.limit_deg = %.4g the least is %.4g m; correct one of "
                   "them",
                   path, robot->steering.radius_min_m, robot->steering.limit_deg, least);
        return false;
    }
    return true;
}

static bool check_steering(const char *path, const struct four_wheel_file *robot)
{
    const double in_place = strict_atan(robot->body.wheelbase_m / robot->body.track_m) * DEGREES_PER_RADIAN;

    if (robot->steering.limit_deg < in_place) {
        error_line("%s: steering.limit_deg = %.4g: turning in place takes %.4g°, by body.wheelbase_m and body.track_m; "
                   "correct one of them",
                   path, robot->steering.limit_deg, in_place);
        return false;
    }
    return true;
}

static bool check_drive(const char *path, const struct four_wheel_file *robot)
{
    const double spin = robot->wheel.inertia_kg_m2 / (robot->wheel.radius_m * robot->wheel.radius_m);
    const double resistance = robot->tyre.rolling * robot->body.mass_kg * FOUR_WHEEL_GRAVITY / JP_WHEELS;
    const double force =
        (robot->body.mass_kg / JP_WHEELS + spin) * robot->drive.acceleration_m_s2 + resistance +
        robot->drive.friction_nm_s_per_rad * robot->drive.speed_m_s / (robot->wheel.radius_m * robot->wheel.radius_m);
    const double torque = force * robot->wheel.radius_m;

    if (torque > robot->drive.torque_nm) {
        error_line("%s: drive.torque_nm = %.4g: drive.acceleration_m_s2 = %.4g takes %.4g N·m; correct one of them",
                   path, robot->drive.torque_nm, robot->drive.acceleration_m_s2, torque);
        return false;
    }
    return true;
}

static bool check_footprint(const char *path, const struct four_wheel_file *robot)
{
    if (robot->body.wheelbase_m > robot->body.length_m || robot->body.track_m > robot->body.width_m) {
        error_line(
            "%s: body.wheelbase_m = %.4g, body.track_m = %.4g: wheels must stand within body.length_m = %.4g and "
            "body.width_m = %.4g; correct one of them",
            path, robot->body.wheelbase_m, robot->body.track_m, robot->body.length_m, robot->body.width_m);
        return false;
    }
    return true;
}

static bool check_laser(const char *path, const struct four_wheel_file *robot)
{
    const double ticks = FOUR_WHEEL_RATE_HZ / robot->laser.rate_hz;

    if (fabs(ticks - round(ticks)) > 1e-9 * ticks) {
        error_line("%s: laser.rate_hz = %.10g: must divide the %d ticks of a second, such as 10; correct the value",
                   path, robot->laser.rate_hz, FOUR_WHEEL_RATE_HZ);
        return false;
    }
    return true;
}

static bool check_step(const char *path, const struct four_wheel_file *robot)
{
    const double rate = four_wheel_plant_damping_rate(robot);

    if (rate * FOUR_WHEEL_STEP > FOUR_WHEEL_STEP_RATE_MAX) {
        error_line("%s: tyre.stiffness_n_s_per_m = %.4g: with these masses slip dies out at %.4g/s, the simulator "
                   "follows %.4g/s; lower it, or correct wheel.inertia_kg_m2",
                   path, robot->tyre.stiffness_n_s_per_m, rate, FOUR_WHEEL_STEP_RATE_MAX / FOUR_WHEEL_STEP);
        return false;
    }
    return true;
}

bool four_wheel_file_load(const char *path, struct four_wheel_file *robot)
{
    *robot = (struct four_wheel_file){0};
    return config_fields_load(path, &four_wheel_kind, robot) && check_footprint(path, robot) &&
           check_steering(path, robot) && check_drive(path, robot) && check_laser(path, robot) &&
           check_step(path, robot) && check_radius(path, robot) && check_bounds(path, robot) &&
           check_hysteresis(path, robot);
}

static jp_q24 to_q24(double value)
{
    return (jp_q24)lround(value * JP_Q24_ONE);
}

struct jp_four_wheel_config four_wheel_config(const struct four_wheel_file *robot)
{
    return (struct jp_four_wheel_config){
        .wheelbase = to_q24(robot->body.wheelbase_m),
        .track = to_q24(robot->body.track_m),
        .steering_limit = (int32_t)lround(robot->steering.limit_deg / 360 * TURN_2_32),
        .steering_step = (int32_t)lround(robot->steering.rate_rad_s / FOUR_WHEEL_RATE_HZ / (2 * M_PI) * TURN_2_32),
        .speed_max = to_q24(robot->drive.speed_m_s),
        .speed_step = to_q24(robot->drive.acceleration_m_s2 / FOUR_WHEEL_RATE_HZ),
    };
}
