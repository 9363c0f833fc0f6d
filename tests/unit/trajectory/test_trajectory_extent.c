/* How far a leg leaves its line: what is said, against where the set-points lead. */
#include "src/trajectory/trajectory_blend.h"
#include "tests/support/rule_rig.h"
#include "tests/target/random.h"

/** Of metres here. */
#define METRE  ((int32_t)1 << 20)
#define MM(mm) ((mm)*METRE / 1000)

/* ---- Where the set-points lead ---- */

/** As the set-points say, without a mistake. */
struct robot {
    struct jp_trajectory_drive drive;
    int64_t x; /* 2⁻⁴⁰ turn/s, summed over set-points */
    int64_t y;
    int64_t turned; /* 2⁻²⁴ turn/s, likewise */
};

static struct robot robot_at_start(void)
{
    struct robot robot = {.x = 0};

    jp_trajectory_begin(&robot.drive, &trajectory);
    return robot;
}

static bool go_on(struct robot *robot)
{
    struct jp_set_point point;

    if (!jp_trajectory_advance(&robot->drive, &config, &point)) {
        return false;
    }
    const int64_t halfway = 2 * robot->turned + point.yaw_rate;
    const int64_t angle = halfway * (128 * (int64_t)JP_TICKS_PER_SET_POINT) / config.tick_rate;
    const jp_angle heading = task.heading + (jp_angle)angle;

    robot->x += jp_multiply(point.wheel_rate, jp_cos(heading)) >> 15;
    robot->y += jp_multiply(point.wheel_rate, jp_sin(heading)) >> 15;
    robot->turned += point.yaw_rate;
    return true;
}

static int32_t in_metres(int64_t sum)
{
    return (int32_t)((sum >> 16) * (JP_TICKS_PER_SET_POINT * (int64_t)METRE) / config.turns_per_metre /
                     (int32_t)config.tick_rate);
}

static bool is_in_leg(const struct robot *robot, uint16_t leg)
{
    return jp_trajectory_leg_now(&robot->drive) == leg;
}

/** Drives a leg twice: to its end, and then along the line from its begin to there. */
static int32_t measured_aside(struct robot *robot)
{
    const uint16_t leg = jp_trajectory_leg_now(&robot->drive);
    const struct robot begin = *robot;
    int32_t largest = 0;

    while (is_in_leg(robot, leg) && go_on(robot)) {
    }
    const jp_angle line = jp_atan2(in_metres(robot->y - begin.y), in_metres(robot->x - begin.x));

    *robot = begin;
    while (is_in_leg(robot, leg) && go_on(robot)) {
        const int64_t off = jp_multiply(in_metres(robot->y - begin.y), jp_cos(line)) -
                            jp_multiply(in_metres(robot->x - begin.x), jp_sin(line));
        const int32_t aside = (int32_t)(off >> 31);

        largest = aside > largest ? aside : largest;
        largest = -aside > largest ? -aside : largest;
    }
    return largest;
}

static int32_t said_aside(uint16_t leg)
{
    const jp_angle heading = leg == 0U ? task.heading : legs[leg - 1U].next.heading;

    return jp_trajectory_leg_extent(&config, &legs[leg], heading).aside * (METRE / JP_Q16_ONE);
}

/* ---- Random ---- */

enum { ROUTES = 40 };

static uint32_t state;

static int32_t between(int32_t low, int32_t high)
{
    return low + (int32_t)(target_random(&state) % (uint32_t)(high - low + 1));
}

/* Begun at a stand, facing the first target. */
static void random_route(void)
{
    struct jp_point at = {0, 0};
    jp_angle direction = target_random(&state);

    task.count = (uint16_t)between(2, 6);
    task.to_stand = between(0, 1) != 0;
    task.cruise = between(JP_Q24(0.2), JP_Q24(0.9));
    task.motion = (struct jp_travel_state){0};
    for (uint16_t i = 0; i < task.count; i++) {
        const jp_q16 length = between(JP_Q16(0.4), JP_Q16(3));

        at.x += jp_multiply_shift(length, jp_cos(direction), 31);
        at.y += jp_multiply_shift(length, jp_sin(direction), 31);
        targets[i] = at;
        direction += (jp_angle)(between(-90, 90) * (int32_t)JP_ANGLE_DEGREES(1));
    }
    task.heading = jp_atan2(targets[0].y, targets[0].x);
}

/* False: it is refused, as a few are. */
static bool plan_route(void)
{
    const enum jp_status status = plan();

    TEST_ASSERT_TRUE(status == JP_OK || status == JP_ERR_INFEASIBLE);
    return status == JP_OK;
}

static bool begins_without_difference(void)
{
    return trajectory.transient[0] == 0 && trajectory.transient[1] == 0 && trajectory.transient[2] == 0;
}

/* At the speed of the first leg, which may be slower than the cruise. */
static bool plan_route_in_motion(void)
{
    if (!plan_route()) {
        return false;
    }
    task.cruise = legs[0].speed;
    task.motion = (struct jp_travel_state){.speed = task.cruise, .pitch = jp_q24_multiply(config.lean[0], task.cruise)};
    return plan_route() && begins_without_difference();
}

/* Of all legs. */
static unsigned measured_in_motion(void)
{
    unsigned measured = 0;

    for (int i = 0; i < ROUTES; i++) {
        random_route();
        if (plan_route_in_motion()) {
            struct robot robot = robot_at_start();

            for (uint16_t leg = 0; leg < task.count; leg++) {
                const int32_t aside = measured_aside(&robot);

                TEST_ASSERT_INT32_WITHIN(MM(2) + aside / 100, aside, said_aside(leg));
            }
            measured++;
        }
    }
    return measured;
}

static void test_all_legs_of_routes_begun_at_the_speed_of_the_first(void)
{
    state = UINT32_C(20180900);
    config = jp_robot_gao2018.trajectory;
    TEST_ASSERT_GREATER_THAN_UINT32(ROUTES * 3 / 4, measured_in_motion());
    config = jp_robot_courier24.trajectory;
    TEST_ASSERT_GREATER_THAN_UINT32(ROUTES * 3 / 4, measured_in_motion());
}

/* Of legs that begin when the difference is gone; before that the robot is slower than they want, and turns more on the
 * spot: its first leg leaves the line by less than is said. */
static unsigned measured_from_a_stand(uint32_t seconds)
{
    unsigned planned = 0;

    for (int i = 0; i < ROUTES; i++) {
        random_route();
        if (plan_route()) {
            struct robot robot = robot_at_start();
            uint32_t set_points = 0;

            for (uint16_t leg = 0; leg < task.count; leg++) {
                const int32_t aside = measured_aside(&robot);
                const int32_t allowed = MM(2) + aside / 100;

                if (leg == 0U) {
                    TEST_ASSERT_GREATER_OR_EQUAL_INT32(aside - allowed, said_aside(leg));
                } else if (set_points * JP_TICKS_PER_SET_POINT >= seconds * config.tick_rate) {
                    TEST_ASSERT_INT32_WITHIN(allowed, aside, said_aside(leg));
                }
                set_points += legs[leg].begin.set_points + legs[leg].middle.set_points + legs[leg].end.set_points;
            }
            planned++;
        }
    }
    return planned;
}

static void test_routes_begun_at_a_stand(void)
{
    state = UINT32_C(20180901);
    config = jp_robot_gao2018.trajectory;
    TEST_ASSERT_GREATER_THAN_UINT32(ROUTES * 9 / 10, measured_from_a_stand(4));
    config = jp_robot_courier24.trajectory;
    TEST_ASSERT_GREATER_THAN_UINT32(ROUTES * 9 / 10, measured_from_a_stand(4));
}

/* To the last target, at a stand: the wheels get ahead of the body to slow it down. */
static int32_t measured_beyond(void)
{
    struct robot robot = robot_at_start();
    int32_t farthest = 0;

    while (go_on(&robot)) {
        const int32_t along = in_metres(robot.x);

        farthest = along > farthest ? along : farthest;
    }
    return farthest - in_metres(robot.x);
}

static void test_how_far_it_goes_beyond_a_stand(void)
{
    for (int i = 0; i < 6; i++) {
        config = i % 2 == 0 ? jp_robot_gao2018.trajectory : jp_robot_courier24.trajectory;
        task.count = 1;
        task.heading = 0;
        targets[0] = (struct jp_point){JP_Q16(4), 0};
        task.motion = (struct jp_travel_state){0};
        task.cruise = JP_Q24(0.2) * (1 + i / 2);
        TEST_ASSERT_EQUAL_INT(JP_OK, plan());

        const struct jp_leg_extent extent = jp_trajectory_leg_extent(&config, &legs[0], 0);
        TEST_ASSERT_INT32_WITHIN(MM(1), measured_beyond(), extent.beyond * (METRE / JP_Q16_ONE));
        TEST_ASSERT_GREATER_THAN_INT32(JP_Q16(0.001), extent.beyond);
    }
}

/* ---- One by one ---- */

/* Three metres ahead, then three more after a turn of so many degrees to the left. */
static void plan_corner(int degrees)
{
    const jp_angle turn = (jp_angle)(degrees * (int32_t)JP_ANGLE_DEGREES(1));

    targets[1].x = targets[0].x + jp_multiply_shift(JP_Q16(3), jp_cos(turn), 31);
    targets[1].y = targets[0].y + jp_multiply_shift(JP_Q16(3), jp_sin(turn), 31);
    task.count = 2;
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
}

static void test_straight_ahead(void)
{
    for (int robot = 0; robot < 2; robot++) {
        config = robot == 0 ? jp_robot_gao2018.trajectory : jp_robot_courier24.trajectory;
        task.count = LEGS;
        TEST_ASSERT_EQUAL_INT(JP_OK, plan());
        for (uint16_t leg = 0; leg < LEGS; leg++) {
            TEST_ASSERT_LESS_THAN_INT32(MM(1), said_aside(leg));
        }
    }
}

static void test_to_the_left_and_to_the_right_alike(void)
{
    for (int degrees = 10; degrees <= 90; degrees += 20) {
        plan_corner(degrees);

        const int32_t first = said_aside(0);
        const int32_t last = said_aside(1);

        plan_corner(-degrees);
        TEST_ASSERT_INT32_WITHIN(MM(1), first, said_aside(0));
        TEST_ASSERT_INT32_WITHIN(MM(1), last, said_aside(1));
    }
}

static void test_sharper_corners_leave_the_line_farther(void)
{
    int32_t first = 0;
    int32_t last = 0;

    for (int degrees = 10; degrees <= 90; degrees += 10) {
        plan_corner(degrees);
        TEST_ASSERT_GREATER_THAN_INT32(first + MM(1), said_aside(0));
        TEST_ASSERT_GREATER_THAN_INT32(last + MM(1), said_aside(1));
        first = said_aside(0);
        last = said_aside(1);
    }
}

/* A middle that takes longer than can be counted here: for hours along the line. */
static void test_a_leg_for_hours(void)
{
    targets[0].x = JP_Q16(500);
    task.cruise = JP_Q24(0.01);
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    TEST_ASSERT_LESS_THAN_INT32(MM(10), said_aside(0));
}

/* Nothing is nearer to the chord than it is said to be: what is rolled straight away from it, in 2⁻²⁰ m. */
static void test_what_is_aside_is_rounded_up(void)
{
    const struct jp_trajectory_config *of = &jp_robot_courier24.trajectory;

    for (int32_t i = 0; i < 32; i++) {
        const struct jp_trajectory_leg leg = {.heading = JP_ANGLE_DEGREES(90),
                                              .middle = {.set_points = 100, .wheel_rate = JP_Q24(0.1) + 37 * i}};
        const int64_t rolled = (int64_t)leg.middle.wheel_rate * jp_seconds(of, 100, 20) / of->turns_per_metre;
        const struct jp_leg_extent extent = jp_trajectory_leg_extent(of, &leg, leg.heading);

        TEST_ASSERT_GREATER_OR_EQUAL_INT32((int32_t)rolled - 1, 16 * extent.aside);
        TEST_ASSERT_LESS_THAN_INT32((int32_t)rolled + 16, 16 * extent.aside);
    }
}
