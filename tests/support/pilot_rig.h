/** A pilot and its robot, a toy that follows its reference with a little lag, for the tests of the pilot. */
#ifndef JOULEPATH_TESTS_SUPPORT_PILOT_RIG_H
#define JOULEPATH_TESTS_SUPPORT_PILOT_RIG_H

#include <joulepath/pilot.h>
#include <joulepath/tables.h>

#include "unity.h"

#define BUS      JP_Q16(300)
#define LAG      32 /* ticks */
#define ASIDE    JP_Q16(0.05)
#define PATIENCE 60000 /* ticks */

static const struct jp_point slalom[] = {{JP_Q16(1.2), JP_Q16(0.4)}, {JP_Q16(2.4), JP_Q16(0.1)},
                                         {JP_Q16(3.6), JP_Q16(0.5)}, {JP_Q16(4.9), JP_Q16(0.4)},
                                         {JP_Q16(6.0), JP_Q16(1.1)}, {JP_Q16(7.2), JP_Q16(1.0)}};
#define SLALOM (sizeof slalom / sizeof slalom[0])
static const struct jp_point aside[] = {{JP_Q16(2.6), JP_Q16(1.2)}, {JP_Q16(3.0), JP_Q16(2.6)}};

static struct jp_robot_config robot_config;
static struct jp_robot robot;
static struct jp_sensors sensors;
static jp_phase wheel;
static jp_phase yaw;

static struct jp_energy_model model;
static struct jp_learning learning;
static struct jp_pilot_config config;
static struct jp_pilot pilot;
static struct jp_forecast forecast;

static inline struct jp_telemetry telemetry(void)
{
    struct jp_telemetry copy;

    jp_robot_telemetry(&robot, &copy);
    return copy;
}

static inline jp_phase nearer(jp_phase angle, jp_phase reference)
{
    return angle + (jp_phase)((int64_t)(reference - angle) / LAG);
}

static inline void tick(void)
{
    const struct jp_telemetry now = telemetry();
    struct jp_actuation actuation;

    wheel = nearer(wheel, now.reference_wheel);
    yaw = nearer(yaw, now.reference_yaw);

    const int64_t sum = (int64_t)wheel / (int64_t)robot_config.estimator.wheel_per_count;
    const int64_t difference = (int64_t)yaw / (int64_t)robot_config.estimator.yaw_per_count;

    sensors.encoder_left = (uint32_t)((sum - difference) / 2);
    sensors.encoder_right = (uint32_t)((sum + difference) / 2);
    sensors.current_left = jp_q16_divide(now.voltages.left, robot_config.monitor.motor_resistance);
    sensors.current_right = jp_q16_divide(now.voltages.right, robot_config.monitor.motor_resistance);
    jp_robot_tick(&robot, JP_OK, &sensors, &actuation);
}

static inline void ticks(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        tick();
    }
}

static inline void init(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_robot_init(&robot, &robot_config, &field));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_init(&pilot, &config, &robot, &field));
}

static inline void rig_reset(void)
{
    robot_config = jp_robot_gao2018;
    model = jp_energy_model_gao2018;
    learning = jp_learning_gao2018;
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE, .bus_voltage = BUS};
    wheel = 0;
    yaw = 0;
    config = (struct jp_pilot_config){.model = &model, .learning = &learning};
    forecast = (struct jp_forecast){-1, -1};
    init();
}

static inline void balance(void)
{
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_robot_enable(&robot));
    tick();
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_BALANCING, telemetry().state);
}

static inline void expect_near(const struct jp_point *target)
{
    const struct jp_point position = telemetry().position;

    TEST_ASSERT_INT32_WITHIN(ASIDE, target->x, position.x);
    TEST_ASSERT_INT32_WITHIN(ASIDE, target->y, position.y);
}

static inline void work_and_tick(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    tick();
}

/** Works without letting time pass until a plan is made or fails; the slices that it took. */
static inline unsigned work_while(enum jp_pilot_phase phase, enum jp_status *status)
{
    unsigned slices = 0;

    do {
        *status = jp_pilot_work(&pilot);
        slices++;
    } while (pilot.phase == phase && *status == JP_OK && slices < 1000U);
    return slices;
}

/** Until so many segments have ended, each of which is to end near its target. */
static inline void drive(const struct jp_point *targets, uint16_t count)
{
    unsigned patience = PATIENCE;

    while (telemetry().state != JP_ROBOT_DRIVING && patience > 0U) {
        work_and_tick();
        patience--;
    }
    for (uint16_t k = 0; k < count; k++) {
        while (telemetry().segments_ended <= k && patience > 0U) {
            work_and_tick();
            patience--;
        }
        expect_near(&targets[k]);
    }
    TEST_ASSERT_GREATER_THAN_UINT32(0, patience);
}

static inline void expect_rest(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT32(JP_PILOT_RESTING, pilot.phase);
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_BALANCING, telemetry().state);
}

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

static inline enum jp_status follow(const struct jp_point *targets, uint16_t count)
{
    return jp_pilot_follow(&pilot, &(struct jp_pilot_route){targets, count, JP_PILOT_STAND, NULL, 0});
}

static inline void follow_slalom(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, follow(slalom, SLALOM));
}

static inline void work_until_driving(void)
{
    while (telemetry().segment == 0U) {
        work_and_tick();
    }
}

#endif
