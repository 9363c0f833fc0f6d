/* The same trajectory, set-points and energy on every core: a hash over all, equal to a known one. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <joulepath/trajectory_energy.h>
#include <joulepath/trajectory_rule.h>

#include "tests/support/bits_hash.h"
#include "unity.h"

enum { LEGS = 5, SET_POINTS = 6000 };

static const struct jp_point targets[LEGS] = {
    {JP_Q16(1.3), JP_Q16(0.4)}, {JP_Q16(2), JP_Q16(2)},     {JP_Q16(1.7), JP_Q16(1.9)},
    {JP_Q16(-1), JP_Q16(2.5)},  {JP_Q16(-1.3), JP_Q16(-3)},
};

static struct jp_trajectory_leg legs[LEGS];
static struct jp_trajectory trajectory;

static void mix_motion(const struct jp_waypoint_motion *motion)
{
    mix(motion->heading);
    mix((uint32_t)motion->turn_rate);
    mix((uint32_t)motion->speed);
}

static void mix_plan(const struct jp_trajectory_task *task)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_by_rule(task, legs, &trajectory));
    mix_motion(&trajectory.start);
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        mix((uint32_t)trajectory.transient[i]);
    }
    for (int i = 0; i < LEGS; i++) {
        mix(legs[i].heading);
        mix((uint32_t)legs[i].speed);
        mix(legs[i].begin.set_points);
        mix(legs[i].middle.set_points);
        mix(legs[i].end.set_points);
        mix_motion(&legs[i].next);
    }
}

static void mix_set_points(const struct jp_trajectory_config *config)
{
    struct jp_trajectory_drive drive;
    struct jp_set_point point;

    jp_trajectory_begin(&drive, &trajectory);
    for (int i = 0; i < SET_POINTS; i++) {
        TEST_ASSERT_TRUE(jp_trajectory_advance(&drive, config, &point));
        mix((uint32_t)point.wheel_rate);
        mix((uint32_t)point.yaw_rate);
        mix((uint32_t)point.pitch);
        mix((uint32_t)point.pitch_rate);
        mix((uint32_t)point.common);
        mix((uint32_t)point.difference);
    }
}

static void drive(const struct jp_trajectory_config *config, const struct jp_energy_model *model, bool to_stand)
{
    const struct jp_trajectory_task task = {
        .config = config,
        .cruise = jp_cruise_speed(model),
        .heading = JP_ANGLE_DEGREES(-30),
        .motion = {JP_Q24(0.1), JP_Q24(0.005), JP_Q24(-0.02), JP_Q24(0.03)},
        .targets = targets,
        .count = LEGS,
        .to_stand = to_stand,
    };
    jp_q16 energy;

    mix_plan(&task);
    mix_set_points(config);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_energy(config, model, &trajectory, &energy));
    mix((uint32_t)energy);
}

static void test_gao2018(void)
{
    drive(&jp_robot_gao2018.trajectory, &jp_energy_model_gao2018, true);
    TEST_ASSERT_EQUAL_HEX32(0x5503359B, hash);
}

static void test_courier24(void)
{
    drive(&jp_robot_courier24.trajectory, &jp_energy_model_courier24, false);
    TEST_ASSERT_EQUAL_HEX32(0x19836BF5, hash);
}
