#include "sim/four_wheel/patrol_config.h"

#include <math.h>

#include "sim/four_wheel/four_wheel_drive.h"
#include "sim/four_wheel/four_wheel_plant.h"
#include "sim/four_wheel/laser.h"

#define RADIANS_PER_DEGREE (M_PI / 180)

/* The localiser takes a laser for no better than this, m. */
#define NOISE_MIN 0.001

/* What the control tick takes for plausible: so many times what the drives can do; shares of the battery's voltage. */
#define BEYOND        2
#define VOLTAGE_LEAST 0.75
#define VOLTAGE_MOST  1.25

/* A drive that is so far behind for so long has failed: a share of the greatest speed, several times what its time
 * constant leaves. */
#define SPEED_LAG     0.25
#define ANGLE_LAG_DEG 20.0
#define LAG_SECONDS   0.5

/* Samples may fail to come for so long; as JP_SAMPLE_HOLD_MS. */
#define HOLD_MS 40

/* A twist lasts for so many cycles. */
#define TWIST_CYCLES 3

static struct jp_footprint footprint(const struct four_wheel_file *robot)
{
    const float half_length = (float)(robot->body.length_m / 2);

    return (struct jp_footprint){half_length, half_length, (float)(robot->body.width_m / 2)};
}

/* Of a second: electronics, and what a second less is worth, W. */
static double second_price(const struct four_wheel_file *robot)
{
    return robot->electronics.power_w + robot->turning.second_w;
}

/* Of a metre, whatever its speed, J/m. */
static double metre_price(const struct four_wheel_file *robot)
{
    return robot->tyre.rolling * robot->body.mass_kg * FOUR_WHEEL_GRAVITY / robot->drive.efficiency;
}

/* Of a metre, by its speed, J·s/m². */
static double drag_price(const struct four_wheel_file *robot)
{
    const double radius = robot->wheel.radius_m;

    return JP_WHEELS * robot->drive.friction_nm_s_per_rad / (radius * radius) / robot->drive.efficiency;
}

/* The speed at which a metre costs least, if the band may be so fast. */
static double best_speed(const struct four_wheel_file *robot)
{
    const double drag = drag_price(robot);

    return drag > 0 ? fmin(robot->band.speed_m_s, sqrt(second_price(robot) / drag)) : robot->band.speed_m_s;
}

static struct jp_teb_weights weights(const struct four_wheel_file *robot)
{
    const double joule = robot->weights.energy_per_j;

    return (struct jp_teb_weights){
        .nonholonomic = (float)robot->weights.nonholonomic_per_m2,
        .speed = (float)robot->weights.speed_s2_per_m2,
        .turn_rate = (float)robot->weights.turn_rate_s2_per_rad2,
        .turn_radius = (float)robot->weights.turn_radius_s2_per_m2,
        .acceleration = (float)robot->weights.acceleration_s4_per_m2,
        .turn_acceleration = (float)robot->weights.turn_acceleration_s4_per_rad2,
        .obstacle = (float)robot->weights.obstacle_per_m2,
        .path = (float)robot->weights.path_per_m2,
        .second = (float)(joule * second_price(robot)),
        .metre = (float)(joule * metre_price(robot)),
        .drag = (float)(joule * drag_price(robot)),
        .no_reversing = (float)robot->weights.no_reversing_s2_per_m2,
        .wheel_odometry = (float)robot->weights.wheel_odometry_per_m2,
        .laser_odometry = (float)robot->weights.laser_odometry_per_m2,
    };
}

static struct jp_teb_config band(const struct four_wheel_file *robot)
{
    return (struct jp_teb_config){
        .speed_max = (float)best_speed(robot),
        .reverse_max = (float)robot->band.reverse_m_s,
        .turn_rate_max = (float)robot->band.turn_rate_rad_s,
        .acceleration = (float)robot->band.acceleration_m_s2,
        .turn_acceleration = (float)robot->band.turn_acceleration_rad_s2,
        .radius_min = (float)robot->steering.radius_min_m,
        .footprint = footprint(robot),
        .clearance = (float)robot->band.clearance_m,
        .interval = (float)robot->band.interval_s,
        .hysteresis = (float)robot->band.hysteresis_s,
        .rounds = (uint8_t)robot->band.rounds,
        .steps = (uint8_t)robot->band.steps,
        .weights = weights(robot),
    };
}

static struct jp_scan_config scan(const struct four_wheel_file *robot)
{
    return (struct jp_scan_config){
        .range_max = (float)robot->scan.range_m,
        .gap = (float)robot->scan.gap_m,
        .tolerance = (float)robot->scan.tolerance_m,
        .beams_min = (uint16_t)robot->scan.beams_min,
    };
}

static struct jp_movers_config movers(const struct four_wheel_file *robot)
{
    return (struct jp_movers_config){
        .extent = (float)robot->movers.extent_m,
        .range = (float)robot->movers.range_m,
        .speed_min = (float)robot->movers.speed_min_m_s,
        .speed_max = (float)robot->movers.speed_max_m_s,
        .margin = (float)robot->movers.margin_m,
    };
}

static struct jp_patrol_people people(const struct four_wheel_file *robot)
{
    return (struct jp_patrol_people){
        .clearance = (float)robot->people.clearance_m,
        .braking = (float)robot->drive.acceleration_m_s2,
        .acceleration = (float)robot->people.acceleration_m_s2,
        .rest = (float)robot->people.rest_s,
        .stays = (float)robot->people.stays_s,
    };
}

static struct jp_patrol_price price(const struct four_wheel_file *robot)
{
    const double arm = hypot(robot->body.wheelbase_m, robot->body.track_m) / 2;
    const double scrub = robot->steering.friction_nm / robot->steering.torque_constant_nm_a;

    const double wheel = robot->steering.friction_nm / robot->steering.efficiency +
                         scrub * scrub * robot->steering.resistance_ohm / robot->steering.rate_rad_s;

    return (struct jp_patrol_price){
        .second = (float)second_price(robot),
        .worth = (float)robot->turning.second_w,
        .turning = (float)(metre_price(robot) * arm),
        .steering = (float)(JP_WHEELS * wheel),
    };
}

struct jp_patrol_config patrol_config(const struct four_wheel_file *robot, enum patrol_method method)
{
    struct jp_patrol_config config = {
        .wheels = four_wheel_config(robot),
        .teb = band(robot),
        .scan = scan(robot),
        .movers = movers(robot),
        .people = people(robot),
        .turns_in_place = true,
        .strategy = method == PATROL_IMPROVED ? JP_PATROL_BY_COST : JP_PATROL_FIXED_ANGLE,
        .price = price(robot),
        .glide_clearance = (float)robot->turning.glide_clearance_m,
        .turn_first = (float)(robot->turning.from_deg * RADIANS_PER_DEGREE),
        .turn_rate = (float)robot->turning.rate_rad_s,
        .turn_acceleration = (float)robot->turning.acceleration_rad_s2,
        .steering_rate = (float)robot->steering.rate_rad_s,
        .turn_clearance = (float)robot->turning.clearance_m,
        .step_speed = (float)robot->turning.step_m_s,
        .horizon = (float)robot->patrol.horizon_m,
        .position_tolerance = (float)robot->patrol.position_tolerance_m,
        .heading_tolerance = (float)(robot->patrol.heading_tolerance_deg * RADIANS_PER_DEGREE),
        .period = 1.0f / PATROL_CYCLE_HZ,
        .latency = (float)robot->patrol.latency_s,
        .jump = (float)robot->patrol.jump_m,
        .waits_max = (uint16_t)lround(robot->patrol.wait_s * PATROL_CYCLE_HZ),
        .dropouts_max = (uint16_t)robot->patrol.dropouts,
        .blind_max = (float)robot->patrol.blind_m,
    };

    if (method == PATROL_PLAIN) {
        config.turns_in_place = false;
        config.teb.weights.no_reversing = 0.0f;
        config.teb.weights.wheel_odometry = 0.0f;
        config.teb.weights.laser_odometry = 0.0f;
    }
    return config;
}

struct jp_localiser_config patrol_localiser_config(const struct four_wheel_file *robot, const struct jp_terrain *map)
{
    return (struct jp_localiser_config){
        .map = map,
        .beams_max = (uint16_t)robot->laser.beams,
        .range_max = (float)robot->laser.range_m,
        .noise = (float)fmax(robot->laser.noise_m, NOISE_MIN),
        .wheels = {.distance = (float)robot->localiser.way_share,
                   .turn = (float)robot->localiser.turn_share,
                   .deviation = (float)robot->localiser.deviation_rad_per_m},
        .start_distance = (float)robot->localiser.start_m,
        .start_turn = (float)(robot->localiser.start_deg * RADIANS_PER_DEGREE),
        .lost_distance = (float)robot->localiser.lost_m,
        .lost_turn = (float)(robot->localiser.lost_deg * RADIANS_PER_DEGREE),
    };
}

struct jp_patrol_scanner patrol_scanner(const struct four_wheel_file *robot)
{
    const struct laser_config laser =
        laser_config_of(robot->laser.beams, robot->laser.field_deg * RADIANS_PER_DEGREE, robot->laser.range_m, 0);

    return (struct jp_patrol_scanner){.beams = (uint16_t)laser.beams,
                                      .first_angle = (float)laser.first,
                                      .angle_step = (float)laser.step,
                                      .place = {(float)robot->laser.x_m, (float)robot->laser.y_m, 0.0f}};
}

/* A. */
static double greatest_current(const struct four_wheel_file *robot)
{
    const double rate = robot->drive.speed_m_s / robot->wheel.radius_m;
    const double winding = robot->drive.torque_nm / robot->drive.torque_constant_nm_a;
    const double wheel =
        robot->drive.torque_nm * rate / robot->drive.efficiency + winding * winding * robot->drive.resistance_ohm;

    return (robot->electronics.power_w + JP_WHEELS * wheel) / robot->electronics.voltage_v;
}

static struct jp_four_wheel_limits robot_limits(const struct four_wheel_file *robot, double count_m)
{
    const double volts = robot->electronics.voltage_v;

    return (struct jp_four_wheel_limits){
        .count_jump = (uint32_t)ceil(BEYOND * robot->drive.speed_m_s / FOUR_WHEEL_RATE_HZ / count_m),
        .current = (jp_q16)lround(BEYOND * greatest_current(robot) * JP_Q16_ONE),
        .voltage_min = (jp_q16)lround(VOLTAGE_LEAST * volts * JP_Q16_ONE),
        .voltage_max = (jp_q16)lround(VOLTAGE_MOST * volts * JP_Q16_ONE),
        .speed_lag = (jp_q24)lround(SPEED_LAG * robot->drive.speed_m_s * JP_Q24_ONE),
        .angle_lag = (int32_t)JP_ANGLE_DEGREES(ANGLE_LAG_DEG),
        .lag_ticks = (uint16_t)(LAG_SECONDS * FOUR_WHEEL_RATE_HZ),
        .confirm_ticks = FOUR_WHEEL_RATE_HZ * HOLD_MS / 1000,
    };
}

struct jp_four_wheel_robot_config patrol_robot_config(const struct four_wheel_file *robot)
{
    const double count_m = 2 * M_PI * robot->wheel.radius_m / robot->encoder.wheel_counts_per_turn;

    return (struct jp_four_wheel_robot_config){
        .wheels = four_wheel_config(robot),
        .tick_rate = FOUR_WHEEL_RATE_HZ,
        .count_speed = (int32_t)lround(count_m * FOUR_WHEEL_RATE_HZ * 0x1p32),
        .piece_ticks = FOUR_WHEEL_PIECE_TICKS,
        .twist_ticks = TWIST_CYCLES * FOUR_WHEEL_RATE_HZ / PATROL_CYCLE_HZ,
        .limits = robot_limits(robot, count_m),
    };
}

static jp_q24 to_q24(double value)
{
    return (jp_q24)lround(value * JP_Q24_ONE);
}

struct jp_pure_pursuit_config patrol_pursuit_config(const struct four_wheel_file *robot)
{
    return (struct jp_pure_pursuit_config){
        .speed = to_q24(robot->pursuit.speed_m_s),
        .lookahead_time = to_q24(robot->pursuit.lookahead_s),
        .lookahead_min = to_q24(robot->pursuit.lookahead_min_m),
        .lookahead_max = to_q24(robot->pursuit.lookahead_max_m),
        .curvature_max = to_q24(1 / robot->steering.radius_min_m),
        .lateral_acceleration = to_q24(robot->pursuit.lateral_acceleration_m_s2),
        .acceleration = to_q24(robot->pursuit.acceleration_m_s2),
        .tolerance = to_q24(robot->pursuit.tolerance_m),
    };
}

enum jp_status patrol_pursue(struct jp_pure_pursuit *pursuit, const struct four_wheel_file *robot,
                             const struct planar_pose *pose, const struct jp_plane_speed *speed, struct jp_twist *twist)
{
    const double latency = robot->patrol.latency_s;
    const struct planar_pose motion = {latency * (double)speed->forward, 0, latency * (double)speed->turn_rate};
    const struct planar_pose there = planar_bend(pose, &motion);
    const struct jp_point position = {(jp_q16)lround(there.x * JP_Q16_ONE), (jp_q16)lround(there.y * JP_Q16_ONE)};
    const jp_angle heading = (jp_angle)llround(there.heading / (2 * M_PI) * 4294967296.0);

    return jp_pure_pursuit_tick(pursuit, &position, heading, to_q24((double)speed->forward),
                                JP_Q24_ONE / PATROL_CYCLE_HZ, twist);
}
