/* The rule: what it refuses, single turns and legs, starts in any motion, and legs that are planned one by one. */
#include <stddef.h>

#include "src/base/integer.h"
#include "tests/support/rule_rig.h"

/* 2⁻²⁴ turn·tick, or m·tick by 2⁻²⁴ turn/m: where set-points lead, straight east or west only. */
static int64_t way_of(uint16_t leg_count)
{
    struct jp_trajectory_drive drive;
    struct jp_set_point point;
    int64_t way = 0;

    jp_trajectory_begin(&drive, &trajectory);
    while (jp_trajectory_leg_now(&drive) < leg_count && jp_trajectory_advance(&drive, &config, &point)) {
        way += point.wheel_rate;
    }
    return way;
}

/* Within 2 mm. */
static void expect_way(jp_q16 metres)
{
    const int64_t way =
        way_of(task.count) * (JP_TICKS_PER_SET_POINT * JP_Q16_ONE) / config.turns_per_metre / (int32_t)config.tick_rate;

    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.002), metres, (int32_t)way);
}

/* ---- What it refuses ---- */

#define REFUSED(member, value, good)                                                                                   \
    do {                                                                                                               \
        setUp();                                                                                                       \
        task.member = (value);                                                                                         \
        TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, plan());                                                                \
        task.member = (good);                                                                                          \
        TEST_ASSERT_NOT_EQUAL_INT(JP_ERR_ARGUMENT, plan());                                                            \
    } while (0)

static void test_refuses_bad_arguments(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_by_rule(NULL, legs, &trajectory));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_by_rule(&task, NULL, &trajectory));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_by_rule(&task, legs, NULL));
    REFUSED(config, NULL, &config);
    REFUSED(targets, NULL, targets);
    REFUSED(count, 0, 1);
    REFUSED(cruise, JP_Q24(0.01) - 1, JP_Q24(0.01));
    REFUSED(cruise, JP_Q24(8) + 1, JP_Q24(8));
    REFUSED(motion.speed, JP_Q24(8) + 1, JP_Q24(8));
    REFUSED(motion.speed, -JP_Q24(8) - 1, -JP_Q24(8));
    REFUSED(motion.pitch, JP_Q24(0.125) + 1, JP_Q24(0.125));
    REFUSED(motion.pitch, -JP_Q24(0.125) - 1, -JP_Q24(0.125));
    REFUSED(motion.pitch_rate, JP_Q24(2) + 1, JP_Q24(2));
    REFUSED(motion.pitch_rate, -JP_Q24(2) - 1, -JP_Q24(2));
    REFUSED(motion.turn_rate, JP_Q24(2) + 1, JP_Q24(2));
    REFUSED(motion.turn_rate, -JP_Q24(2) - 1, -JP_Q24(2));
}

static void expect_status_of_targets(enum jp_status status, struct jp_point first, struct jp_point second)
{
    targets[0] = first;
    targets[1] = second;
    task.count = 2;
    TEST_ASSERT_EQUAL_INT(status, plan());
}

static void test_refuses_targets_that_are_too_near_or_too_far(void)
{
    const struct jp_point near = {JP_Q16(3), 0};
    const struct jp_point beside = {JP_Q16(3), 20};
    const struct jp_point far = {JP_Q16(600), 0};

    expect_status_of_targets(JP_ERR_ZERO_LENGTH, (struct jp_point){0, 10}, near);
    expect_status_of_targets(JP_ERR_ZERO_LENGTH, near, beside);
    expect_status_of_targets(JP_ERR_ARGUMENT, far, near);
    expect_status_of_targets(JP_ERR_ARGUMENT, near, far);
    targets[2] = (struct jp_point){targets[1].x, 1};
    targets[1] = (struct jp_point){JP_Q16(6), 0};
    targets[2] = targets[1];
    task.count = 3;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, plan());
}

static void test_no_voltage_for_turns_is_infeasible(void)
{
    config.voltage = JP_Q16(2.72); /* the cruise takes 2.712 V */
    targets[0] = (struct jp_point){0, JP_Q16(0.1)};
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
}

static void test_hardly_any_voltage_for_turns_is_infeasible(void)
{
    config.voltage = jp_multiply_shift(config.volts[0], task.cruise, 24) + 1;
    targets[0] = (struct jp_point){0, JP_Q16(3)};
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
}

/* Tables that pass, and of which no robot has the like: what they make saturates. */

static void test_voltage_that_a_cruise_gives_saturates(void)
{
    config.volts[0] = -JP_Q16(4096);
    task.cruise = JP_Q24(8);
    targets[0] = (struct jp_point){0, JP_Q16(0.1)};
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
}

static void test_modes_that_lead_beyond_the_map_are_infeasible(void)
{
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        config.modes.decay[i] = 1;
        config.modes.share[JP_TRAVEL_MODES * i] = JP_Q16(1024);
    }
    config.blend = JP_Q16(60);
    for (int sign = -1; sign <= 1; sign += 2) {
        task.cruise = JP_Q24(4);
        task.motion.speed = sign * JP_Q24(8);
        targets[0] = (struct jp_point){-JP_Q16(360), sign * JP_Q16(360)};
        TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
    }
}

static void test_a_lean_that_saturates(void)
{
    config.lean[0] = JP_Q24(16);
    config.volts[0] = 0;
    task.cruise = JP_Q24(8);
    task.motion.pitch = -JP_Q24(0.125);
    task.to_stand = false;
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
}

static void test_a_change_of_speed_that_saturates(void)
{
    config.lag = JP_Q24_ONE;
    config.lean[0] = 0;
    config.lean[1] = 0;
    for (unsigned i = 0; i < sizeof config.volts / sizeof config.volts[0]; i++) {
        config.volts[i] = 0;
    }
    config.tick_rate = 10000;
    config.blend = JP_Q16(0.05);
    task.cruise = JP_Q24(8);
    task.motion.speed = JP_Q24(8);
    targets[0].x = JP_Q16(2);
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, legs[0].end.wheel_rate[2]);
}

static void test_a_leg_too_short_to_brake_is_infeasible(void)
{
    targets[0].x = JP_Q16(0.4);
    task.motion.speed = JP_Q24(3);
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
}

/* No line of it leads there. */
static void test_a_leg_shorter_than_the_turn_into_it_is_infeasible(void)
{
    for (int32_t i = 1; i <= 24; i++) {
        task.heading = (jp_angle)i * JP_ANGLE_DEGREES(15);
        task.motion.turn_rate = JP_Q24(0.1) * (i % 5 - 2);
        task.motion.speed = JP_Q24(0.1) * (i % 8);
        targets[0] = (struct jp_point){JP_Q16(0.002) * i, 0};
        (void)plan();
    }
    task.motion.speed = JP_Q24(0.9);
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
}

/* Fast and turning, 6 cm before a corner: the secants do not settle. */
static void test_a_line_that_is_not_found_is_infeasible(void)
{
    task.cruise = JP_Q24(1.01);
    task.heading = JP_ANGLE_DEGREES(84);
    task.motion.speed = JP_Q24(1);
    task.motion.turn_rate = -JP_Q24(0.1);
    task.count = 2;
    targets[0] = (struct jp_point){3930, 0};
    targets[1] = (struct jp_point){-20960, 191260};
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
}

/* The way rolled while turning round wants a turn of more than 180°. */
static void test_a_target_right_behind(void)
{
    task.heading = JP_ANGLE_DEGREES(180);
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    TEST_ASSERT_INT32_WITHIN((int32_t)JP_ANGLE_DEGREES(10), 0, (int32_t)legs[0].heading);
    TEST_ASSERT_TRUE(jp_magnitude32(legs[0].begin.yaw_rate[2]) > (uint32_t)JP_Q24(1.5));
}

/* ---- Legs ---- */

static void test_one_leg_straight_ahead(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    TEST_ASSERT_EQUAL_UINT16(1, trajectory.count);
    TEST_ASSERT_TRUE(trajectory.legs == legs);
    TEST_ASSERT_EQUAL_INT32(task.cruise, legs[0].speed);
    TEST_ASSERT_INT32_WITHIN(2000, 0, (int32_t)legs[0].heading);
    TEST_ASSERT_EQUAL_HEX32(legs[0].heading, legs[0].next.heading);
    TEST_ASSERT_EQUAL_INT32(0, legs[0].next.speed);
    TEST_ASSERT_EQUAL_INT32(0, legs[0].next.turn_rate);
    expect_way(JP_Q16(3));
}

static void test_passes_the_last_target_at_cruise(void)
{
    task.to_stand = false;
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    TEST_ASSERT_EQUAL_UINT32(1, legs[0].end.set_points);
    TEST_ASSERT_EQUAL_INT32(task.cruise, legs[0].next.speed);
    expect_way(JP_Q16(3));
}

static void test_a_row_of_legs(void)
{
    task.count = LEGS;
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    for (int i = 0; i + 1 < LEGS; i++) {
        TEST_ASSERT_EQUAL_INT32(task.cruise, legs[i].next.speed);
        TEST_ASSERT_INT32_WITHIN(2000, 0, (int32_t)legs[i].next.heading);
        TEST_ASSERT_INT32_WITHIN(2000, 0, legs[i].next.turn_rate);
    }
    expect_way(JP_Q16(24));
}

static void test_a_corner_is_passed_at_its_mean_heading(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        targets[1] = (struct jp_point){JP_Q16(3), sign * JP_Q16(3)};
        task.count = 2;
        TEST_ASSERT_EQUAL_INT(JP_OK, plan());
        TEST_ASSERT_INT32_WITHIN(2000, sign * (int32_t)JP_ANGLE_DEGREES(45), (int32_t)legs[0].next.heading);
        TEST_ASSERT_INT32_WITHIN(2000, sign * jp_multiply_shift(config.turn_pace, JP_Q16(0.25), 16),
                                 legs[0].next.turn_rate);
        TEST_ASSERT_EQUAL_INT32(task.cruise, legs[0].next.speed);
    }
}

static void test_there_and_back(void)
{
    targets[1] = (struct jp_point){JP_Q16(1), 0};
    task.count = 2;
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    const int32_t heading = (int32_t)legs[0].next.heading;

    TEST_ASSERT_INT32_WITHIN(2000, (int32_t)JP_ANGLE_DEGREES(90), heading < 0 ? -heading : heading);
}

static void test_a_blend_is_at_most_twice_its_neighbour(void)
{
    targets[0] = (struct jp_point){JP_Q16(4), 0};
    targets[1] = (struct jp_point){JP_Q16(4), JP_Q16(0.4)};
    targets[2] = (struct jp_point){JP_Q16(0), JP_Q16(0.4)};
    task.count = 3;
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    TEST_ASSERT_EQUAL_UINT32(2U * legs[1].begin.set_points, legs[0].end.set_points);
    TEST_ASSERT_EQUAL_UINT32(2U * legs[1].end.set_points, legs[2].begin.set_points);
}

/* From rest into a turn: heading and time of the middle pull at each other, and may differ by a tick for ever. */
static void test_first_legs_of_all_lengths(void)
{
    config = jp_robot_gao2018.trajectory;
    task.count = 2;
    task.heading = JP_ANGLE_DEGREES(17);
    for (int i = 0; i < 150; i++) {
        targets[0] = (struct jp_point){JP_Q16(0.8) + 10 * i, 0};
        targets[1] = (struct jp_point){JP_Q16(2), -JP_Q16(5)};
        TEST_ASSERT_EQUAL_INT(JP_OK, plan());
        TEST_ASSERT_EQUAL_INT32(task.cruise, legs[0].speed);
    }
}

/* Where the voltage does not do for `turn_pace`, the corner is as smooth as it can be. */
static void test_corners_turn_no_faster_than_the_voltage_allows(void)
{
    targets[1] = (struct jp_point){JP_Q16(3), JP_Q16(3)};
    task.count = 2;
    config.voltage = JP_Q16(4);
    config.blend = JP_Q16(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    TEST_ASSERT_LESS_THAN_INT32(jp_multiply_shift(config.turn_pace, JP_Q16(0.25), 16), legs[0].next.turn_rate);
}

static void test_a_blend_is_a_tick_at_least(void)
{
    config.tick_rate = 100;
    config.blend = JP_Q16(0.05);
    task.cruise = JP_Q24(8);
    config.voltage = JP_Q16(512);
    targets[0].x = JP_Q16(0.1);
    task.motion = (struct jp_travel_state){.speed = task.cruise, .pitch = jp_q24_multiply(config.lean[0], task.cruise)};
    task.to_stand = false;
    (void)plan();
    targets[0].x = JP_Q16(0.01);
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
}

/* ---- The start ---- */

static struct jp_set_point first_point(void)
{
    struct jp_trajectory_drive drive;
    struct jp_set_point point;

    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    jp_trajectory_begin(&drive, &trajectory);
    TEST_ASSERT_TRUE(jp_trajectory_advance(&drive, &config, &point));
    return point;
}

/* The shares are known to 2⁻¹⁶: hundreds of steps of 2⁻²⁴. */
static void expect_start(const struct jp_travel_state *motion)
{
    task.motion = *motion;

    const struct jp_set_point point = first_point();

    TEST_ASSERT_INT32_WITHIN(3000, jp_q24_multiply(config.turns_per_metre, motion->speed), point.wheel_rate);
    TEST_ASSERT_INT32_WITHIN(1000, motion->pitch, point.pitch);
    TEST_ASSERT_INT32_WITHIN(5000, motion->pitch_rate, point.pitch_rate);
    TEST_ASSERT_EQUAL_INT32(motion->turn_rate, point.yaw_rate);
}

static void test_begins_with_the_motion_of_the_robot(void)
{
    expect_start(&(struct jp_travel_state){0});
    expect_start(&(struct jp_travel_state){.speed = JP_Q24(-0.3)});
    expect_start(&(struct jp_travel_state){.pitch = JP_Q24(0.02)});
    expect_start(&(struct jp_travel_state){.pitch_rate = JP_Q24(-0.2)});
    expect_start(&(struct jp_travel_state){.turn_rate = JP_Q24(0.3)});
    expect_start(&(struct jp_travel_state){JP_Q24(0.8), JP_Q24(-0.01), JP_Q24(0.05), JP_Q24(-0.2)});
}

static void test_a_start_in_motion_covers_the_way(void)
{
    task.motion = (struct jp_travel_state){.speed = JP_Q24(-0.3), .pitch = JP_Q24(0.01)};
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    expect_way(JP_Q16(3));
}

static void test_no_transient_from_cruise(void)
{
    task.motion = (struct jp_travel_state){.speed = task.cruise, .pitch = jp_q24_multiply(config.lean[0], task.cruise)};
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        TEST_ASSERT_EQUAL_INT32(0, trajectory.transient[i]);
    }
    expect_way(JP_Q16(3));
}

/* Targets all round, near ones too: the robot goes there, or it is refused; never by a detour. */
static void go_all_round(unsigned *planned, unsigned *refused)
{
    for (jp_q16 distance = JP_Q16(0.01); distance < JP_Q16(1); distance = 3 * distance / 2) {
        for (unsigned i = 0; i < 16U; i++) {
            const jp_angle direction = i * JP_ANGLE_DEGREES(22.5);

            targets[0] = (struct jp_point){jp_multiply_shift(distance, jp_cos(direction), 31),
                                           jp_multiply_shift(distance, jp_sin(direction), 31)};
            targets[1] = (struct jp_point){targets[0].x + JP_Q16(0.3), targets[0].y - JP_Q16(0.6)};

            const enum jp_status status = plan();

            if (status == JP_OK) {
                TEST_ASSERT_INT32_WITHIN(JP_ANGLE_DEGREES(45), 0, (int32_t)(legs[0].heading - legs[0].chord));
                (*planned)++;
            } else {
                TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, status);
                (*refused)++;
            }
        }
    }
}

static void test_targets_all_round_a_robot_in_motion(void)
{
    static const jp_q24 speeds[] = {JP_Q24(0.5), -JP_Q24(0.35), -JP_Q24(0.45), -JP_Q24(0.65)};
    unsigned planned = 0;
    unsigned refused = 0;

    task.count = 2;
    for (unsigned k = 0; k < sizeof speeds / sizeof speeds[0]; k++) {
        task.motion = (struct jp_travel_state){.speed = speeds[k], .turn_rate = JP_Q24(-0.2)};
        task.cruise = JP_Q24(0.95);
        config = jp_robot_gao2018.trajectory;
        go_all_round(&planned, &refused);
        config = jp_robot_courier24.trajectory;
        go_all_round(&planned, &refused);
    }
    TEST_ASSERT_GREATER_THAN_UINT32(100, planned);
    TEST_ASSERT_GREATER_THAN_UINT32(100, refused);
}

/* ---- Leg by leg ---- */

static struct jp_trajectory_plan onward;

static enum jp_status start_in_places(uint16_t places)
{
    return jp_trajectory_plan_start(&onward, &task, legs, places, &trajectory);
}

static void test_a_plan_refuses_bad_arguments(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_plan_start(NULL, &task, legs, 2, &trajectory));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_plan_start(&onward, NULL, legs, 2, &trajectory));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_plan_start(&onward, &task, NULL, 2, &trajectory));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_plan_start(&onward, &task, legs, 2, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, start_in_places(0));
    TEST_ASSERT_EQUAL_INT(JP_OK, start_in_places(1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_plan_leg(NULL, &legs[0]));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_plan_leg(&onward, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_plan_redirect(NULL, &task));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_plan_redirect(&onward, NULL));
    task.count = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_trajectory_plan_redirect(&onward, &task));
}

/* In places for two, the legs are those that are planned at once. */
static void test_legs_one_by_one(void)
{
    struct jp_trajectory_leg whole[LEGS];
    struct jp_trajectory all;

    for (int i = 0; i < LEGS; i++) {
        targets[i].y = i % 2 == 0 ? JP_Q16(0.4) : -JP_Q16(0.3);
    }
    task.count = LEGS;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_by_rule(&task, whole, &all));
    TEST_ASSERT_EQUAL_UINT16(LEGS, all.count);
    TEST_ASSERT_EQUAL_INT(JP_OK, start_in_places(2));
    TEST_ASSERT_EQUAL_UINT16(0, trajectory.count);
    TEST_ASSERT_EQUAL_MEMORY(&all.start, &trajectory.start, sizeof all.start);
    for (uint16_t i = 0; i < LEGS; i++) {
        TEST_ASSERT_EQUAL_UINT16(i, onward.planned);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_leg(&onward, &legs[i % 2U]));
        TEST_ASSERT_EQUAL_MEMORY(&whole[i], &legs[i % 2U], sizeof whole[i]);
    }
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_trajectory_plan_leg(&onward, &legs[0]));
}

static void test_a_leg_that_fails_writes_nothing(void)
{
    struct jp_trajectory_leg before;

    targets[4] = targets[3];
    task.count = 5;
    TEST_ASSERT_EQUAL_INT(JP_OK, start_in_places(2));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_leg(&onward, &legs[0]));
    before = legs[0];
    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, jp_trajectory_plan_leg(&onward, &legs[0]));
    TEST_ASSERT_EQUAL_MEMORY(&before, &legs[0], sizeof before);
    TEST_ASSERT_EQUAL_UINT16(1, onward.planned);
}

/* From the second target towards the left, as a plan that begins there in that motion would go. */
static void test_other_targets_on_the_way(void)
{
    const struct jp_point left[] = {{JP_Q16(8), JP_Q16(3)}, {JP_Q16(8), JP_Q16(6)}};
    struct jp_trajectory_task to_left = task;

    task.count = 4;
    to_left.targets = left;
    to_left.count = 2;
    TEST_ASSERT_EQUAL_INT(JP_OK, start_in_places(2));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_leg(&onward, &legs[0]));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_leg(&onward, &legs[1]));
    targets[0] = targets[1] = targets[2] = (struct jp_point){0, 0}; /* nobody reads them any more */
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_redirect(&onward, &to_left));
    TEST_ASSERT_EQUAL_UINT16(0, onward.planned);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_leg(&onward, &legs[2]));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_leg(&onward, &legs[3]));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_trajectory_plan_leg(&onward, &legs[4]));
    /* From (6, 0) to (8, 3): 56.3°, then 90°. */
    TEST_ASSERT_INT32_WITHIN(1000, 0, (int32_t)(legs[2].chord - jp_angle_from_radians(JP_Q24(0.9827937))));
    TEST_ASSERT_INT32_WITHIN(JP_ANGLE_DEGREES(8), 0, (int32_t)(legs[2].heading - legs[2].chord));
    TEST_ASSERT_INT32_WITHIN(JP_ANGLE_DEGREES(4), JP_ANGLE_DEGREES(73), (int32_t)legs[2].next.heading);
    TEST_ASSERT_INT32_WITHIN(JP_ANGLE_DEGREES(4), JP_ANGLE_DEGREES(90), (int32_t)legs[3].next.heading);
    TEST_ASSERT_EQUAL_INT32(0, legs[3].next.speed);
}

static void test_other_targets_before_the_first_leg(void)
{
    struct jp_trajectory_leg direct;

    TEST_ASSERT_EQUAL_INT(JP_OK, start_in_places(1));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_leg(&onward, &direct));
    TEST_ASSERT_EQUAL_INT(JP_OK, start_in_places(1));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_redirect(&onward, &task));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_leg(&onward, &legs[0]));
    TEST_ASSERT_EQUAL_MEMORY(&direct, &legs[0], sizeof direct);
}

/* From a waypoint that is passed slowly the new route cannot be fast at once. */
static void test_other_targets_begin_at_the_speed_of_the_waypoint(void)
{
    const struct jp_point near[] = {{JP_Q16(3.3), 0}, {JP_Q16(6), 0}};
    struct jp_trajectory_task onto = {.cruise = JP_Q24(0.9), .targets = near, .count = 2};

    task.count = 2;
    give(0, 0, JP_Q24(0.05));
    config.pitch = JP_Q24(0.01);
    TEST_ASSERT_EQUAL_INT(JP_OK, start_in_places(2));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_leg(&onward, &legs[0]));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_redirect(&onward, &onto));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_leg(&onward, &legs[1]));
    TEST_ASSERT_LESS_THAN_INT32(JP_Q24(0.6), legs[1].speed);
}

static void test_no_other_targets_after_a_stand(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, start_in_places(1));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_leg(&onward, &legs[0]));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_trajectory_plan_redirect(&onward, &task));
}

static void test_other_targets_that_are_refused(void)
{
    const struct jp_point here = {JP_Q16(3), 0};
    const struct jp_trajectory_task back = {.cruise = JP_Q24(0.5), .targets = &here, .count = 1};
    struct jp_trajectory_plan before;

    task.count = 2;
    TEST_ASSERT_EQUAL_INT(JP_OK, start_in_places(2));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_plan_leg(&onward, &legs[0]));
    before = onward;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, jp_trajectory_plan_redirect(&onward, &back));
    TEST_ASSERT_EQUAL_MEMORY(&before, &onward, sizeof before);
}
