/** Sound traffic for a controller, spoilt now and then: a robot that does as it should, and an operator. */
#ifndef JOULEPATH_TESTS_SUPPORT_ECU_TRAFFIC_H
#define JOULEPATH_TESTS_SUPPORT_ECU_TRAFFIC_H

#include <math.h>

#include "tests/support/random_frames.h"

enum source { SAMPLES, COMMANDS, ROUTES, GOALS, FOREIGN, SOURCES };

struct traffic {
    uint32_t weights[SOURCES];
    uint32_t spoilt_one_in;
    uint32_t repeated_one_in;
    uint32_t lost_one_in;
    struct jp_can_frame last;

    uint8_t sample_counter;
    unsigned part;
    struct jp_can_frame sample[JP_SAMPLE_PARTS];
    double left;  /**< counts */
    double right; /**< counts */
    uint32_t first_count;

    uint8_t command_counter;
    enum jp_operator_mode mode;
    uint8_t route_id;

    uint8_t offer_counter;
    uint8_t waypoint_counter;
    struct jp_route_message route;
    unsigned sent; /**< frames of the route */

    uint8_t goal_counter;
};

/** What is changed now and then in an episode. */
static uint32_t drawn_rarity(void)
{
    static const uint32_t rarities[] = {NEVER, NEVER, 10000, 1000, 1000, 100, 4};

    return rarities[below(sizeof rarities / sizeof rarities[0])];
}

/** How much of what is on the bus, and how it is spoilt. */
static void draw_rates(struct traffic *traffic)
{
    static const uint32_t usual[SOURCES] = {[SAMPLES] = 8, [COMMANDS] = 2, [ROUTES] = 2};

    for (unsigned i = 0; i < SOURCES; i++) {
        traffic->weights[i] = one_in(8) ? 4U * below(4) : usual[i];
    }
    traffic->weights[FOREIGN] += one_in(4) || traffic->weights[SAMPLES] == 0U ? 1U : 0U;
    traffic->spoilt_one_in = drawn_rarity();
    traffic->repeated_one_in = drawn_rarity();
    traffic->lost_one_in = drawn_rarity();
}

static void traffic_begin(struct traffic *traffic)
{
    *traffic = (struct traffic){.first_count = (uint32_t)random_bits(), .mode = JP_MODE_STAND};
    draw_rates(traffic);
}

/** A way in turns a second, on the reference and back to it. */
static double wanted_rate(jp_q24 rate, jp_phase wanted, jp_phase measured)
{
    return fmin(fmax(rate * 0x1p-24 + 5 * (jp_phase_difference(wanted, measured) * 0x1p-24), -3), 3);
}

static jp_q16 motor_current(const struct jp_monitor_config *motor, jp_q16 voltage, double rate)
{
    const double amperes = (voltage * 0x1p-16 - rate * motor->back_emf * 0x1p-16) / (motor->motor_resistance * 0x1p-16);

    return (jp_q16)(fmin(fmax(amperes, -7), 7) * 0x1p16);
}

static void move_and_measure(struct traffic *traffic, const struct jp_robot *robot, struct jp_sensors *sensors)
{
    const struct jp_tick_telemetry *telemetry = jp_robot_last_tick(robot);
    const struct jp_reference *reference = jp_robot_reference(robot);
    const struct jp_robot_config *config = jp_robot_configuration(robot);
    const double second = 1.0 / config->estimator.tick_rate;
    double wheel = 0;
    double yaw = 0;

    if (telemetry->state == JP_ROBOT_BALANCING || telemetry->state == JP_ROBOT_DRIVING) {
        wheel = wanted_rate(reference->wheel.rate, reference->wheel.angle, telemetry->motion.wheel);
        yaw = wanted_rate(reference->yaw.rate, reference->yaw.angle, telemetry->motion.yaw);
    }

    const double sum = wheel * second * 0x1p56 / (double)config->estimator.wheel_per_count;
    const double difference = yaw * second * 0x1p56 / (double)config->estimator.yaw_per_count;
    const double turning = yaw * config->monitor.half_track * 0x1p-16;

    traffic->left += (sum - difference) / 2;
    traffic->right += (sum + difference) / 2;
    *sensors = (struct jp_sensors){
        .encoder_left = traffic->first_count + (uint32_t)(int64_t)traffic->left,
        .encoder_right = traffic->first_count + (uint32_t)(int64_t)traffic->right,
        .pitch_rate = around(JP_Q24(0.002)),
        .yaw_rate = around(JP_Q24(0.002)),
        .accel_x = around(JP_Q24(0.01)),
        .accel_z = JP_Q24_ONE + around(JP_Q24(0.01)),
        .current_left = motor_current(&config->monitor, telemetry->voltages.left, wheel - turning),
        .current_right = motor_current(&config->monitor, telemetry->voltages.right, wheel + turning),
        .bus_voltage = JP_Q16(24),
    };
}

/** One of the numbers becomes any number. */
static void spoil_sensors(struct jp_sensors *sensors)
{
    uint8_t *bytes = (uint8_t *)sensors;
    const uint32_t any = (uint32_t)random_bits();

    memcpy(bytes + sizeof any * below(sizeof *sensors / sizeof any), &any, sizeof any);
}

static struct jp_can_frame next_sample_part(struct traffic *traffic, const struct jp_robot *robot)
{
    struct jp_sensors sensors;

    if (traffic->part == 0U) {
        move_and_measure(traffic, robot, &sensors);
        if (one_in(traffic->spoilt_one_in)) {
            spoil_sensors(&sensors);
        }
        jp_message_from_sensors(traffic->sample, &traffic->sample_counter, &sensors);
    }

    const struct jp_can_frame frame = traffic->sample[traffic->part];

    traffic->part = (traffic->part + 1U) % JP_SAMPLE_PARTS;
    return frame;
}

static struct jp_can_frame next_command(struct traffic *traffic, const struct jp_robot *robot)
{
    struct jp_can_frame frame = {.id = 0x100, .length = 4};

    if (one_in(jp_robot_state_now(robot) == JP_ROBOT_DRIVING ? 5000 : 20)) {
        traffic->mode = one_in(2) ? JP_MODE_DRIVE : (enum jp_operator_mode)below(4);
    }
    if (one_in(1000)) {
        traffic->route_id = one_in(4) ? (uint8_t)below(256) : one_in(4) ? JP_ROUTE_GOAL : traffic->route.id;
    }
    frame.data[1] = (uint8_t)((unsigned)traffic->mode << 4);
    frame.data[2] = traffic->route_id;
    jp_e2e_protect(&traffic->command_counter, JP_DATA_ID_OPERATOR_COMMAND, frame.data, frame.length);
    return frame;
}

static void put_point(struct jp_can_frame *frame, const struct jp_point *point)
{
    const uint64_t x = (uint32_t)point->x & 0x3FFFFFFU;
    const uint64_t y = (uint32_t)point->y & 0x3FFFFFFU;
    const uint64_t bits = x << 12 | y << 38;

    memcpy(frame->data, &bits, sizeof frame->data);
}

static struct jp_point random_point(const struct jp_robot *robot)
{
    const struct jp_point here = jp_robot_position(robot);
    const int32_t near = one_in(8) ? JP_Q16(500) : JP_Q16(0.2);

    return (struct jp_point){jp_clamp32(here.x + around(near), -JP_Q16(512), JP_Q16(511)),
                             jp_clamp32(here.y + around(near), -JP_Q16(512), JP_Q16(511))};
}

static void draw_route(struct traffic *traffic, const struct jp_robot *robot)
{
    static const uint8_t lengths[] = {0, 1, 2, 3, 4, JP_ROUTE_LENGTH_MAX, JP_ROUTE_LENGTH_MAX + 1, UINT8_MAX};

    traffic->route.id = (uint8_t)below(256);
    traffic->route.length = one_in(4) ? lengths[below(sizeof lengths)] : (uint8_t)(1U + below(8));
    for (unsigned i = 0; i < JP_ROUTE_LENGTH_MAX; i++) {
        traffic->route.points[i] = random_point(robot);
    }
}

static struct jp_can_frame next_offer(struct traffic *traffic, const struct jp_robot *robot)
{
    struct jp_can_frame frame = {.id = 0x101, .length = 8};
    uint32_t crc;

    draw_route(traffic, robot);
    crc = traffic->route.length > JP_ROUTE_LENGTH_MAX || one_in(16) ? (uint32_t)random_bits()
                                                                    : oracle_crc32(&traffic->route);
    frame.data[2] = traffic->route.id;
    frame.data[3] = traffic->route.length;
    memcpy(&frame.data[4], &crc, sizeof crc);
    jp_e2e_protect(&traffic->offer_counter, JP_DATA_ID_ROUTE_OFFER, frame.data, frame.length);
    return frame;
}

static struct jp_can_frame next_route_frame(struct traffic *traffic, const struct jp_robot *robot)
{
    struct jp_can_frame frame = {.id = 0x102, .length = 8};

    if (traffic->sent == 0U) {
        traffic->sent = 1;
        return next_offer(traffic, robot);
    }
    if (traffic->sent > JP_ROUTE_LENGTH_MAX || traffic->sent > traffic->route.length) {
        traffic->sent = one_in(2000) ? 0 : traffic->sent;
        return next_sample_part(traffic, robot);
    }
    put_point(&frame, &traffic->route.points[traffic->sent - 1U]);
    jp_e2e_protect(&traffic->waypoint_counter, JP_DATA_ID_WAYPOINT, frame.data, frame.length);
    traffic->sent++;
    if (traffic->sent > traffic->route.length) {
        traffic->route_id = traffic->route.id;
    }
    return frame;
}

static struct jp_can_frame next_goal(struct traffic *traffic, const struct jp_robot *robot)
{
    struct jp_can_frame frame = {.id = 0x103, .length = 8};
    const struct jp_point goal = random_point(robot);

    put_point(&frame, &goal);
    jp_e2e_protect(&traffic->goal_counter, JP_DATA_ID_GOAL, frame.data, frame.length);
    return frame;
}

static enum source draw_source(const struct traffic *traffic)
{
    uint32_t sum = 0;
    uint32_t place;
    unsigned source = 0;

    for (unsigned i = 0; i < SOURCES; i++) {
        sum += traffic->weights[i];
    }
    place = below(sum);
    while (place >= traffic->weights[source]) {
        place -= traffic->weights[source];
        source++;
    }
    return (enum source)source;
}

static struct jp_can_frame draw_frame(struct traffic *traffic, const struct jp_robot *robot)
{
    switch (draw_source(traffic)) {
    case SAMPLES:
        return next_sample_part(traffic, robot);
    case COMMANDS:
        return next_command(traffic, robot);
    case ROUTES:
        return next_route_frame(traffic, robot);
    case GOALS:
        return next_goal(traffic, robot);
    case FOREIGN:
    case SOURCES:
    default:
        return foreign_frame();
    }
}

static struct jp_can_frame next_frame(struct traffic *traffic, const struct jp_robot *robot)
{
    struct jp_can_frame frame;

    if (one_in(traffic->repeated_one_in)) {
        return traffic->last;
    }
    do {
        frame = draw_frame(traffic, robot);
    } while (one_in(traffic->lost_one_in));
    if (one_in(traffic->spoilt_one_in)) {
        spoil(&frame);
    }
    traffic->last = frame;
    return frame;
}

#endif
