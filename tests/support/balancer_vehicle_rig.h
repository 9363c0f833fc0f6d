/** A balancer as a vehicle, with its pilot and a toy of a robot, for its tests. */
#ifndef JOULEPATH_TESTS_SUPPORT_BALANCER_VEHICLE_RIG_H
#define JOULEPATH_TESTS_SUPPORT_BALANCER_VEHICLE_RIG_H

#include <joulepath/balancer_vehicle.h>
#include <stddef.h>
#include <string.h>

#include "tests/support/pilot_rig.h"

#define DEGREE  JP_ANGLE_DEGREES(1)
#define UNKNOWN ((enum jp_vehicle_phase)77) /* that look() has left as it was */

static const struct jp_point straight[] = {{JP_Q16(1.5), 0}};
static const struct jp_point bend[] = {{JP_Q16(1.5), 0}, {JP_Q16(2.5), JP_Q16(1)}, {JP_Q16(4), JP_Q16(1.2)}};
static const struct jp_point zigzag[] = {
    {JP_Q16(0.05), 0}, {JP_Q16(0.05), JP_Q16(0.05)}, {0, JP_Q16(0.05)}, {0, 0}, {JP_Q16(0.05), 0}};
static const struct jp_point origin;

static struct jp_balancer_vehicle balancer;
static struct jp_vehicle vehicle;
static jp_q16 duration;

static inline enum jp_status follow_run(const struct jp_point *targets, uint16_t count)
{
    const struct jp_vehicle_run run = {.targets = targets, .count = count};

    return vehicle.follow(vehicle.context, &run);
}

/* ---- The rig ---- */

static inline void begin(void)
{
    init();
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_balancer_vehicle_init(&balancer, &pilot, &vehicle));
    duration = -1;
}

static inline void begin_balancing(void)
{
    begin();
    balance();
}

/* As that of a robot that can be built: it takes a while to brake and to turn. */
static inline void shape_reference(void)
{
    robot_config.reference.travel_bandwidth = JP_Q16(1);
    robot_config.reference.yaw_bandwidth = JP_Q16(4);
}

static inline struct jp_vehicle_view look(void)
{
    struct jp_vehicle_view view = {.phase = UNKNOWN};

    vehicle.look(vehicle.context, &view);
    return view;
}

static inline void expect_phase(enum jp_vehicle_phase phase)
{
    TEST_ASSERT_EQUAL_INT(phase, look().phase);
}

static inline void expect_refusal(void)
{
    const uint16_t planned = pilot.targets_planned;

    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, vehicle.turn(vehicle.context, JP_ANGLE_DEGREES(30), NULL));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_STATE, follow_run(aside, 2));
    TEST_ASSERT_EQUAL_UINT16(planned, pilot.targets_planned);
}

static inline void live(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, vehicle.work(vehicle.context));
    tick();
}

static inline unsigned live_until_stand(void)
{
    unsigned count = 0;

    while (look().phase == JP_VEHICLE_MOVING && count < PATIENCE) {
        live();
        count++;
    }
    expect_phase(JP_VEHICLE_STANDING);
    return count;
}

static inline void live_until_driving(void)
{
    for (unsigned i = 0; i < PATIENCE && telemetry().state != JP_ROBOT_DRIVING; i++) {
        live();
    }
    TEST_ASSERT_EQUAL_INT32(JP_ROBOT_DRIVING, telemetry().state);
}

static inline void expect_heading(jp_angle heading)
{
    TEST_ASSERT_INT32_WITHIN(DEGREE / 2, 0, (int32_t)(look().heading - heading));
}

#endif
