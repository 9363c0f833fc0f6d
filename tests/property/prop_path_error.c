/*
 * The way back to the path (src/balancer/path_error.h) on random curves and with random errors of the control, against
 * two poses in double: that of the plan and that of the robot.
 *
 * prop_path_error [--count N] [--seed S]
 */
#include "src/balancer/path_error.h"

#include <joulepath/tables.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>

#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

#define PI  3.14159265358979323846
#define Q24 16777216.0

/* Of the error, where the robot stays beside the path: what the square of its heading's error adds. */
#define ERROR_BAR 0.02

/* Of the lead, some time after curves: the way back is longer than the path. */
#define DETOUR_BAR 0.15

/* Of the lead, beside the path in a curve; it would be all of it after a quarter turn. */
#define CURVE_BAR 0.25

/* In which a robot's lead over the reference changes, s. */
#define CONTROL 0.2

/* In wheel turns; headings in turns. */
struct pose {
    double x, y, heading;
};

static struct options options = {.count = 300, .seed = 1};
static struct jp_trajectory_config config;
static struct jp_reference reference;
static struct jp_path_error error;
static struct jp_motion_state motion;
static struct pose planned;
static struct pose driven;

/* What the robot is ahead of the reference, and is going to be. */
static double wheel_lead;
static double yaw_lead;
static double next_wheel_lead;
static double next_yaw_lead;

void setUp(void)
{
    begin_random(options.seed, 0);
}

void tearDown(void)
{
}

static jp_phase phase(double turns)
{
    return (jp_phase)(int64_t)(turns * (double)JP_PHASE_TURN);
}

static double turns(jp_phase of)
{
    return (double)(int64_t)of / (double)JP_PHASE_TURN;
}

/* Somewhere in the formats, on the path. */
static void begin(const struct jp_trajectory_config *robot)
{
    const jp_phase wheel = phase(uniform(-127, 127));
    const jp_phase yaw = phase(uniform(-127, 127));

    config = *robot;
    jp_reference_start(&reference, &jp_robot_gao2018.reference, wheel, yaw);
    reference.phase_per_rate = jp_phase_per_rate(config.tick_rate);
    jp_path_error_start(&error);
    motion = (struct jp_motion_state){.wheel = wheel, .yaw = yaw};
    planned = (struct pose){0, 0, 0};
    driven = planned;
    wheel_lead = 0;
    yaw_lead = 0;
    next_wheel_lead = 0;
    next_yaw_lead = 0;
}

static void advance(struct pose *pose, double way, double turn)
{
    const double mean = 2 * PI * (pose->heading + turn / 2);

    pose->heading += turn;
    pose->x += way * cos(mean);
    pose->y += way * sin(mean);
}

static double period(void)
{
    return (double)JP_TICKS_PER_SET_POINT / config.tick_rate;
}

/* The robot goes where the reference does, and what it is ahead. */
static void drive_on(const struct jp_set_point *at)
{
    const struct jp_motion_state before = motion;

    for (unsigned k = 0; k < JP_TICKS_PER_SET_POINT; k++) {
        jp_reference_track(&reference, at);
    }
    wheel_lead += (next_wheel_lead - wheel_lead) * period() / CONTROL;
    yaw_lead += (next_yaw_lead - yaw_lead) * period() / CONTROL;
    motion.wheel = reference.wheel.angle + phase(wheel_lead);
    motion.yaw = reference.yaw.angle + phase(yaw_lead);
    motion.wheel_rate = (jp_q24)(turns(motion.wheel - before.wheel) / period() * Q24);
    advance(&driven, turns(motion.wheel - before.wheel), turns(motion.yaw - before.yaw));
    advance(&planned, at->wheel_rate / Q24 * period(), at->yaw_rate / Q24 * period());
    jp_path_error_correct(&error, &config, at, &motion, &reference);
}

static void drive(double seconds, double wheel_rate, double yaw_rate)
{
    const struct jp_set_point at = {.wheel_rate = (jp_q24)(wheel_rate * Q24), .yaw_rate = (jp_q24)(yaw_rate * Q24)};

    jp_path_error_begin_leg(&error, at.wheel_rate);
    for (double t = 0; t < seconds; t += period()) {
        drive_on(&at);
    }
}

/* The robot from the plan: to the left, and ahead. */
static double across(void)
{
    const double heading = 2 * PI * planned.heading;

    return (driven.y - planned.y) * cos(heading) - (driven.x - planned.x) * sin(heading);
}

static double along(void)
{
    const double heading = 2 * PI * planned.heading;

    return (driven.x - planned.x) * cos(heading) + (driven.y - planned.y) * sin(heading);
}

/* 1/T of the design, and the wheels' rate there. */
static double design_time(void)
{
    return 2 * period() * 4294967296.0 / config.steering;
}

static double design_rate(void)
{
    return 1 / (4 * PI * config.aim / Q24 * design_time());
}

static const struct jp_trajectory_config *robot_of(unsigned long i)
{
    return i % 2 == 0 ? &jp_robot_gao2018.trajectory : &jp_robot_courier24.trajectory;
}

/* Curves with leads that come and go; without steering, so that the error grows. */
static void test_the_error_is_that_of_the_poses(void)
{
    double worst = 0;

    for (unsigned long i = 0; i < options.count; i++) {
        begin(robot_of(i));
        config.steering = 0;

        const double rate = uniform(0.3, 2) * design_rate();
        double scale = 0;

        for (int piece = 0; piece < 5; piece++) {
            next_wheel_lead = uniform(-0.1, 0.1);
            next_yaw_lead = uniform(-0.003, 0.003);
            scale = fmax(scale, fabs(next_wheel_lead));
            drive(uniform(0.2, 2), rate, uniform(-0.2, 0.2));
            scale = fmax(scale, hypot(across(), along()));
            worst = fmax(worst, fabs(turns(error.across) - across()) / scale);
            worst = fmax(worst, fabs(turns(error.along) + wheel_lead - along()) / scale);
        }
        TEST_ASSERT_EQUAL_UINT64(0, error.turned);
    }
    printf("error: at most %.4f of it away\n", worst);
    TEST_ASSERT_TRUE(worst <= ERROR_BAR);
}

/* Critically damped at the speed of the design: it never crosses the path. */
static void test_leads_back_without_crossing(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        begin(robot_of(i));

        const double start = uniform(0.05, 0.3);

        error.across = phase(start);
        driven.y = start;
        for (int k = 1; k < 8; k++) {
            drive(design_time(), design_rate(), 0);
            TEST_ASSERT_TRUE(fabs(across() - start * (1 + k) * exp(-k)) < 0.02 * start);
            TEST_ASSERT_TRUE(across() > 0);
        }
        drive(10 * design_time(), design_rate(), 0);
        TEST_ASSERT_TRUE(fabs(across()) < 0.002 * start);
        TEST_ASSERT_TRUE(fabs(driven.heading) < 1e-4);
    }
}

/* Turns as at a waypoint, p = s(1 − s) of the duration; returns the furthest from the path. */
static double turn_round(double seconds, double wheel_rate, double turn)
{
    double worst = 0;

    jp_path_error_begin_leg(&error, (jp_q24)(wheel_rate * Q24));
    for (double t = 0; t < seconds; t += period()) {
        const double share = t / seconds;
        const double yaw_rate = turn * 6 * share * (1 - share) / seconds;

        drive_on(&(struct jp_set_point){(jp_q24)(wheel_rate * Q24), (jp_q24)(yaw_rate * Q24), 0, 0, 0, 0});
        worst = fmax(worst, fabs(across()));
    }
    return worst;
}

/* By up to a third of a turn, late or early by up to a tenth of its duration: where the path does, not when the
 * set-point does. */
static void test_turns_where_the_path_does(void)
{
    double worst = 0;

    for (unsigned long i = 0; i < options.count; i++) {
        begin(robot_of(i));

        const double rate = uniform(0.3, 2) * design_rate();
        const double duration = uniform(0.5, 2) * design_time();
        const double lead = copysign(uniform(0.02, 0.1), uniform(-1, 1)) * duration * rate;

        next_wheel_lead = lead;
        drive(10 * CONTROL, rate, 0);
        worst = fmax(worst, turn_round(duration, rate, uniform(-0.33, 0.33)) / fabs(lead));
    }
    printf("in curves: at most %.4f of the lead away from the path\n", worst);
    TEST_ASSERT_TRUE(worst <= CURVE_BAR);
}

/* At any speed, late or early before any curve: on its place again some time later. */
static void test_is_back_after_curves(void)
{
    double worst = 0;

    for (unsigned long i = 0; i < options.count; i++) {
        begin(robot_of(i));

        const double rate = uniform(0.3, 2) * design_rate();
        double most = 0; /* of the lead */

        for (int piece = 0; piece < 4; piece++) {
            next_wheel_lead = uniform(-0.15, 0.15);
            drive(uniform(0.3, 2), rate, uniform(-0.25, 0.25));
            most = fmax(most, fabs(next_wheel_lead));
        }
        next_wheel_lead = 0;
        drive(12 * design_time() * fmax(1, design_rate() / rate), rate, 0);
        worst = fmax(worst, hypot(across(), along()) / most);
    }
    printf("after curves: at most %.4f of the lead is left\n", worst);
    TEST_ASSERT_TRUE(worst <= DETOUR_BAR);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
