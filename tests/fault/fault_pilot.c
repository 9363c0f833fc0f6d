/* Whatever happens to a robot that a pilot drives, on the simulated plant: it never falls by itself, stands where it
 * cannot go on, says why, and drives the next route. */
#include <joulepath/pilot.h>
#include <math.h>

#include "sim/balancer/rig.h"
#include "unity.h"

#define LEGS            4
#define SECONDS_MAX     120
#define STAND_MARGIN    0.05 /* m */
#define ODOMETRY_MARGIN 0.25 /* m, after a minute of turns */

/* Enough to make it fall. */
#define PUSH_N 60

/* A robot that stands still: m/s. */
#define STILL 0.05

static const struct jp_point slalom[] = {
    {JP_Q16(1.4), JP_Q16(0.3)}, {JP_Q16(2.6), JP_Q16(1.2)}, {JP_Q16(4.0), JP_Q16(1.0)}, {JP_Q16(5.2), JP_Q16(1.9)},
    {JP_Q16(6.6), JP_Q16(1.6)}, {JP_Q16(7.8), JP_Q16(2.4)}, {JP_Q16(9.2), JP_Q16(2.2)}};
#define SLALOM (sizeof slalom / sizeof slalom[0])
static const struct jp_point aside[] = {{JP_Q16(3.0), JP_Q16(3.0)}, {JP_Q16(4.5), JP_Q16(4.2)}};

static const char *const names[] = {"gao2018", "courier24"};
#define ROBOTS (sizeof names / sizeof names[0])

static struct robot_file file;
static struct rig rig;
static struct jp_pilot pilot;
static uint64_t every; /* ticks from one slice of work to the next */

static void start(const char *name)
{
    const struct robot_entry *entry = rig_find_robot(name);
    char path[64];
    const char *field = "";

    TEST_ASSERT_NOT_NULL(entry);
    (void)snprintf(path, sizeof path, "sim/robots/%s.cfg", name);
    TEST_ASSERT_TRUE(robot_file_load(path, &file));
    TEST_ASSERT_TRUE(rig_init(&rig, entry, &file, 1));

    const struct jp_pilot_config config = {.model = entry->energy, .learning = entry->learning};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pilot_init(&pilot, &config, &rig.robot, &field));
    rig_release(&rig, 0);
    every = 1;
}

void setUp(void)
{
    start("courier24");
}

void tearDown(void)
{
}

static enum jp_robot_state state(void)
{
    return jp_robot_state_now(&rig.robot);
}

static enum jp_status tick(void)
{
    enum jp_status status = pilot.status;

    if (rig.world.tick % every == 0) {
        status = jp_pilot_work(&pilot);
    }
    rig_tick(&rig);
    return status;
}

static void run(double seconds)
{
    const uint64_t end = rig.world.tick + (uint64_t)(seconds * 1000);

    while (rig.world.tick < end) {
        (void)tick();
    }
}

/* Until the pilot rests; what it said last. */
static enum jp_status run_to_rest(void)
{
    const uint64_t end = rig.world.tick + (uint64_t)SECONDS_MAX * 1000;
    enum jp_status status = JP_OK;

    while (pilot.phase != JP_PILOT_RESTING && rig.world.tick < end) {
        status = tick();
        TEST_ASSERT_TRUE(state() != JP_ROBOT_FALLEN && state() != JP_ROBOT_FAULT);
    }
    TEST_ASSERT_EQUAL_INT(JP_PILOT_RESTING, pilot.phase);
    return status;
}

static void run_into_segment(uint16_t segment)
{
    while (jp_robot_last_tick(&rig.robot)->segment < segment) {
        (void)tick();
    }
    run(0.5);
}

static double speed(void)
{
    return rig.world.plant.state.wheel_rate * file.wheel.radius_m;
}

static double distance(const struct jp_point *target)
{
    return hypot(rig.world.plant.x - target->x / 65536.0, rig.world.plant.y - target->y / 65536.0);
}

static double distance_by_odometry(const struct jp_point *target)
{
    const struct jp_point position = jp_robot_position(&rig.robot);

    return hypot(position.x - target->x, position.y - target->y) / 65536.0;
}

static void expect_stand(void)
{
    run(8);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, state());
    TEST_ASSERT_EQUAL_INT(JP_PILOT_RESTING, pilot.phase);
    TEST_ASSERT_DOUBLE_WITHIN(STILL, 0, speed());
}

static void follow(const struct jp_point *targets, uint16_t count)
{
    TEST_ASSERT_EQUAL_INT(JP_OK,
                          jp_pilot_follow(&pilot, &(struct jp_pilot_route){targets, count, JP_PILOT_STAND, NULL, 0}));
}

/* Drives a route from wherever it is, to show that nothing is left of what went wrong. */
static void expect_drives_on(void)
{
    follow(aside, 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, run_to_rest());
    TEST_ASSERT_DOUBLE_WITHIN(STAND_MARGIN, 0, distance(&aside[1]));
    expect_stand();
}

/* Targets as they are passed, for both robots. */
static void test_each_target_is_passed(void)
{
    for (size_t i = 0; i < ROBOTS; i++) {
        start(names[i]);
        follow(slalom, SLALOM);
        for (uint16_t k = 0; k < SLALOM; k++) {
            while (jp_robot_last_tick(&rig.robot)->segments_ended <= k) {
                TEST_ASSERT_EQUAL_INT(JP_OK, tick());
            }
            TEST_ASSERT_DOUBLE_WITHIN(STAND_MARGIN, 0, distance(&slalom[k]));
        }
        expect_stand();
        TEST_ASSERT_EQUAL_UINT32(SLALOM, pilot.legs_learned_from);
    }
}

static void test_stop_in_mid_segment(void)
{
    follow(slalom, SLALOM);
    run_into_segment(2);
    jp_pilot_stop(&pilot);
    expect_stand();
    expect_drives_on();
}

/* Somebody else's stop ends the route, whether a segment waits or not. */
static void test_stop_beside_the_pilot(void)
{
    for (int waits = 0; waits < 2; waits++) {
        follow(slalom, SLALOM);
        run_into_segment(2);
        while (waits == 1 && pilot.targets_planned < 3) {
            (void)tick();
        }
        jp_robot_stop(&rig.robot);
        run(1);
        TEST_ASSERT_EQUAL_INT(JP_PILOT_RESTING, pilot.phase);
        TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, pilot.status);
        run(8);
        TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, state());
    }
    expect_drives_on();
}

static void expect_motors_off(enum jp_robot_state expected)
{
    const uint32_t learned_from = pilot.legs_learned_from;

    TEST_ASSERT_EQUAL_INT(expected, state());
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_pilot_work(&pilot));
    TEST_ASSERT_EQUAL_INT(JP_PILOT_RESTING, pilot.phase);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE,
                          jp_pilot_follow(&pilot, &(struct jp_pilot_route){slalom, SLALOM, JP_PILOT_STAND, NULL, 0}));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE,
                          jp_pilot_ask(&pilot, &(struct jp_pilot_route){slalom, 1, JP_PILOT_STAND, NULL, 0}));
    TEST_ASSERT_EQUAL_UINT32(learned_from, pilot.legs_learned_from);
}

static void set_upright_again(void)
{
    plant_hold(&rig.world.plant, 0);
    jp_robot_disable(&rig.robot);
    run(3);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, state());
    rig_release(&rig, 0);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, state());
}

/* A thrust that no motor can hold; the wheels run away under the robot, which the monitor sees first. */
static void test_pushed_over(void)
{
    follow(slalom, SLALOM);
    run_into_segment(2);
    world_push(&rig.world, PUSH_N, 0, 500);
    for (unsigned i = 0; i < 5000 && state() == JP_ROBOT_DRIVING; i++) {
        (void)tick();
    }
    expect_motors_off(JP_ROBOT_FAULT);
    set_upright_again();
}

static void test_fall(void)
{
    follow(slalom, SLALOM);
    run_into_segment(2);
    rig.robot.internal.estimator.pitch = JP_PHASE_TURN / 4;
    (void)tick();
    expect_motors_off(JP_ROBOT_FALLEN);
    set_upright_again();
    run(8);
    expect_drives_on();
}

static void test_disable_in_mid_plan(void)
{
    follow(slalom, SLALOM);
    while (jp_robot_last_tick(&rig.robot)->segment == 0) {
        (void)tick();
    }
    follow(aside, 2);
    (void)tick();
    jp_robot_disable(&rig.robot);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, (tick(), jp_pilot_work(&pilot)));
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, state());
    TEST_ASSERT_EQUAL_INT(JP_PILOT_RESTING, pilot.phase);
    rig_release(&rig, 0);
    expect_drives_on();
}

static void test_new_route_while_driving(void)
{
    follow(slalom, SLALOM);
    run_into_segment(2);
    follow(aside, 2);
    while (jp_robot_last_tick(&rig.robot)->segments_ended < 2) {
        (void)tick();
    }
    TEST_ASSERT_DOUBLE_WITHIN(STAND_MARGIN, 0, distance(&slalom[1]));
    TEST_ASSERT_EQUAL_INT(JP_OK, run_to_rest());
    TEST_ASSERT_DOUBLE_WITHIN(STAND_MARGIN, 0, distance(&aside[1]));
    expect_stand();
}

/* At any moment, also when a plan is in the making or a segment waits. */
static void test_new_routes_again_and_again(void)
{
    for (unsigned i = 0; i < 40; i++) {
        if (i % 2 == 0) {
            follow(slalom, SLALOM);
        } else {
            follow(aside, 2);
        }
        run(0.37 + 0.013 * i);
        TEST_ASSERT_TRUE(state() == JP_ROBOT_BALANCING || state() == JP_ROBOT_DRIVING);
    }
    follow(aside, 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, run_to_rest());
    TEST_ASSERT_DOUBLE_WITHIN(STAND_MARGIN, 0, distance_by_odometry(&aside[1]));
    TEST_ASSERT_DOUBLE_WITHIN(ODOMETRY_MARGIN, 0, distance(&aside[1]));
}

/* Plans come late, so the robot stands at targets; it still arrives. */
static void test_work_is_called_too_rarely(void)
{
    for (size_t i = 0; i < ROBOTS; i++) {
        for (uint64_t ticks = 20; ticks <= 2000; ticks *= 10) {
            start(names[i]);
            every = ticks;
            follow(slalom, 4);
            TEST_ASSERT_EQUAL_INT(JP_OK, run_to_rest());
            every = 1;
            run(8);
            TEST_ASSERT_DOUBLE_WITHIN(0.4, 0, distance(&slalom[3]));
            expect_stand();
        }
    }
}

/* At the rate that the header asks for the robot never stands on its way. */
static void test_slices_that_suffice(void)
{
    for (size_t i = 0; i < ROBOTS; i++) {
        start(names[i]);
        every = 100;
        follow(slalom, SLALOM);
        while (jp_robot_last_tick(&rig.robot)->segment == 0) {
            (void)tick();
        }
        while (jp_robot_last_tick(&rig.robot)->segments_ended < SLALOM) {
            TEST_ASSERT_EQUAL_INT(JP_OK, tick());
            TEST_ASSERT_TRUE(state() == JP_ROBOT_DRIVING || jp_robot_last_tick(&rig.robot)->segments_ended == SLALOM);
        }
    }
}

static void expect_refused(const struct jp_point *targets, uint16_t count, enum jp_status expected)
{
    follow(targets, count);
    TEST_ASSERT_EQUAL_INT(expected, run_to_rest());
    TEST_ASSERT_EQUAL_UINT16(0, jp_robot_last_tick(&rig.robot)->segment);
    expect_stand();
    TEST_ASSERT_EQUAL_INT(expected, pilot.status);
    expect_drives_on();
}

static void test_target_where_the_robot_stands(void)
{
    const struct jp_point here = jp_robot_position(&rig.robot);

    expect_refused(&here, 1, JP_ERR_ZERO_LENGTH);
}

static void test_target_twice(void)
{
    const struct jp_point twice[] = {slalom[0], slalom[1], slalom[1], slalom[2]};

    expect_refused(twice, 4, JP_ERR_ZERO_LENGTH);
}

static void test_target_too_far_away(void)
{
    const struct jp_point far = {JP_Q16(600), 0};

    expect_refused(&far, 1, JP_ERR_ARGUMENT);
}

static void test_ask_while_driving(void)
{
    struct jp_forecast forecast;

    follow(slalom, SLALOM);
    run_into_segment(1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE,
                          jp_pilot_ask(&pilot, &(struct jp_pilot_route){aside, 2, JP_PILOT_STAND, NULL, 0}));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pilot_answer(&pilot, &forecast));
    TEST_ASSERT_EQUAL_INT(JP_OK, run_to_rest());
    TEST_ASSERT_DOUBLE_WITHIN(STAND_MARGIN, 0, distance(&slalom[SLALOM - 1]));
}

/* The answer comes while the robot balances on the spot, and is what the route then takes. */
static void test_ask_then_drive(void)
{
    struct jp_forecast forecast;
    enum jp_status status = jp_pilot_ask(&pilot, &(struct jp_pilot_route){slalom, LEGS, JP_PILOT_STAND, NULL, 0});
    double measured = 0;
    uint16_t ended = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, status);
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE,
                          jp_pilot_ask(&pilot, &(struct jp_pilot_route){aside, 2, JP_PILOT_STAND, NULL, 0}));
    do {
        (void)tick();
        status = jp_pilot_answer(&pilot, &forecast);
    } while (status == JP_WORKING);
    TEST_ASSERT_EQUAL_INT(JP_OK, status);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, state());
    follow(slalom, LEGS);
    while (ended < LEGS) {
        (void)tick();
        if (jp_robot_last_tick(&rig.robot)->segments_ended != ended) {
            ended = jp_robot_last_tick(&rig.robot)->segments_ended;
            measured += (double)jp_robot_last_tick(&rig.robot)->segment_energy_model / 4294967296.0;
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * measured, measured, forecast.energy / 65536.0);
}
