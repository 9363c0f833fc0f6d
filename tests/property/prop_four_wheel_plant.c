/*
 * The four-wheel plant against what physics says of it: energy, known motions, sliding; random commands and ground.
 *
 * prop_four_wheel_plant [--count N] [--seed S] [--json FILE]
 */
#include <math.h>
#include <stdio.h>

#include "sim/base/random.h"
#include "sim/four_wheel/four_wheel_file.h"
#include "sim/four_wheel/four_wheel_plant.h"
#include "tests/support/check.h"
#include "tests/support/options.h"
#include "unity.h"

#define TICK           (1.0 / FOUR_WHEEL_RATE_HZ)
#define ENERGY_ERROR   1e-4 /* of what the ledger turned over */
#define SUPPLY_ERROR   1e-9 /* of what the battery gave */
#define TURN_2_32      4294967296.0
#define NORMAL_SLIP    0.01 /* of the speed, in gentle driving on firm ground */
#define DRY_FRICTION_N 0.8  /* of the shipped robot */

struct twist {
    double forward;
    double left;
    double turn_rate;
};

static struct options options = {.count = 60, .seed = 6};
static struct four_wheel_file robot;
static struct four_wheel_plant plant;
static struct random noise;
static double worst_energy_error;
static double worst_supply_error;

void setUp(void)
{
    static const struct planar_pose origin = {0, 0, 0};
    TEST_ASSERT_TRUE(four_wheel_file_load("sim/robots/patrol.cfg", &robot));
    random_init(&noise, options.seed);
    four_wheel_plant_init(&plant, &robot, &origin);
}

void tearDown(void)
{
}

/* ---- Oracle: a wheel rolls where the rigid body carries it ---- */

static double wheel_x(int wheel)
{
    return (wheel < JP_REAR_LEFT ? 0.5 : -0.5) * robot.body.wheelbase_m;
}

static double wheel_y(int wheel)
{
    return (wheel % 2 == 0 ? 0.5 : -0.5) * robot.body.track_m;
}

static int32_t turns(double angle)
{
    return (int32_t)lround(angle / (2 * M_PI) * TURN_2_32);
}

/* Wheels that roll without slip under a twist; a wheel that points backwards is reversed. */
static struct jp_wheels wheels_of(const struct twist *twist)
{
    struct jp_wheels wheels;
    for (int i = 0; i < JP_WHEELS; i++) {
        const double x = twist->forward - twist->turn_rate * wheel_y(i);
        const double y = twist->left + twist->turn_rate * wheel_x(i);
        const bool back = x < 0;
        wheels.angle[i] = turns(back ? atan2(-y, -x) : atan2(y, x));
        wheels.speed[i] = (jp_q24)lround((back ? -1 : 1) * hypot(x, y) * JP_Q24_ONE);
    }
    return wheels;
}

/* Wheels turned at a stand, then the speed ramped up in a second and held. */
static void drive(const struct twist *twist, double seconds)
{
    const struct jp_wheels goal = wheels_of(twist);
    for (int tick = 0; tick < (int)(seconds / TICK); tick++) {
        struct jp_wheels targets = goal;
        for (int i = 0; i < JP_WHEELS; i++) {
            targets.speed[i] = (jp_q24)(goal.speed[i] * fmin(fmax((tick - 100) * TICK, 0), 1));
        }
        four_wheel_plant_tick(&plant, &targets);
    }
}

static double turnover(void)
{
    const struct four_wheel_ledger *l = &plant.ledger;
    return fabs(l->drive) + fabs(l->pull) + l->slip + l->rolling + l->friction;
}

static double energy_error(double start)
{
    const struct four_wheel_ledger *l = &plant.ledger;
    const double kept = four_wheel_plant_kinetic_energy(&plant) - start;
    return fabs(l->drive + l->pull - l->slip - l->rolling - l->friction - kept) / turnover();
}

/* ---- Energy ---- */

static struct four_wheel_patch random_patch(void)
{
    const struct planar_point low = {random_uniform(&noise, -4, 2), random_uniform(&noise, -4, 2)};
    return (struct four_wheel_patch){
        .low = low,
        .high = {low.x + random_uniform(&noise, 0.2, 4), low.y + random_uniform(&noise, 0.2, 4)},
        .friction = random_uniform(&noise, 0.02, 1),
        .stiffness_left = random_uniform(&noise, 0.02, 1),
        .stiffness_right = random_uniform(&noise, 0.02, 1),
        .pull = {random_uniform(&noise, -1, 1), random_uniform(&noise, -1, 1)},
    };
}

/* Any angles and speeds, also such that the wheels fight each other. */
static struct jp_wheels random_wheels(void)
{
    struct jp_wheels wheels;
    for (int i = 0; i < JP_WHEELS; i++) {
        wheels.angle[i] = turns(random_uniform(&noise, -2.5, 2.5));
        wheels.speed[i] = (jp_q24)(random_uniform(&noise, -1.5, 1.5) * JP_Q24_ONE);
    }
    return wheels;
}

static void test_ledger_closes(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        static const struct planar_pose origin = {0, 0, 0};
        four_wheel_plant_init(&plant, &robot, &origin);
        for (int i = 0; i < (int)(run % 4) * 2; i++) {
            const struct four_wheel_patch patch = random_patch();
            TEST_ASSERT_TRUE(four_wheel_plant_add_patch(&plant, &patch));
        }
        plant.state.forward = random_uniform(&noise, -1, 1);
        plant.state.left = random_uniform(&noise, -1, 1);
        plant.state.turn_rate = random_uniform(&noise, -2, 2);
        const double start = four_wheel_plant_kinetic_energy(&plant);
        struct jp_wheels wheels = random_wheels();
        for (int tick = 0; tick < 1000; tick++) {
            if (tick % 60 == 0) {
                wheels = random_wheels();
            }
            const struct four_wheel_ledger before = plant.ledger;
            four_wheel_plant_tick(&plant, &wheels);
            TEST_ASSERT_TRUE_MESSAGE(plant.ledger.slip >= before.slip && plant.ledger.rolling >= before.rolling &&
                                         plant.ledger.friction >= before.friction &&
                                         plant.ledger.steering >= before.steering &&
                                         plant.ledger.copper >= before.copper && plant.ledger.gear >= before.gear &&
                                         plant.ledger.electronics > before.electronics,
                                     "losses must not come back");
        }
        worst_energy_error = fmax(worst_energy_error, energy_error(start));
        worst_supply_error =
            fmax(worst_supply_error, fabs(four_wheel_plant_supply_error(&plant)) / plant.ledger.battery);
        check_below(energy_error(start), ENERGY_ERROR, "energy lost or won, of the turnover");
        check_below(worst_supply_error, SUPPLY_ERROR, "energy lost or won in the motors, of what the battery gave");
        check_below(hypot(plant.state.forward, plant.state.left), 3, "speed, m/s");
    }
}

/* What the body carries away is what its mass and the wheels' inertia say. */
static void test_kinetic_energy(void)
{
    plant.state.forward = 1;
    plant.state.left = 2;
    plant.state.turn_rate = 3;
    plant.state.wheels[JP_REAR_RIGHT].rate = 10;
    check_near(45 * 5 / 2.0 + 3.75 * 9 / 2 + 0.035 * 100 / 2, four_wheel_plant_kinetic_energy(&plant), 1e-9, "J");
}

/* ---- Known motions ---- */

static void test_at_rest_it_stays(void)
{
    const struct jp_wheels straight = {{0}, {0}};
    for (int tick = 0; tick < 500; tick++) {
        four_wheel_plant_tick(&plant, &straight);
    }
    check_near(0, hypot(plant.state.pose.x, plant.state.pose.y), 0, "way, m");
    check_near(0, turnover() + plant.ledger.steering, 0, "energy, J");
    TEST_ASSERT_EQUAL_MEMORY(&straight, &plant.measured, sizeof straight);
}

/* Forward, sideways, turning in place and all between: the body does what its wheels say, and hardly slips. */
static void test_wheels_without_slip_carry_the_twist(void)
{
    for (int run = 0; run < 200; run++) {
        static const struct planar_pose origin = {0, 0, 0};
        const struct twist twist = {random_uniform(&noise, -0.8, 0.8), random_uniform(&noise, -0.5, 0.5),
                                    random_uniform(&noise, -0.5, 0.5)};
        four_wheel_plant_init(&plant, &robot, &origin);
        drive(&twist, 4);
        const double speed = hypot(twist.forward, twist.left) + fabs(twist.turn_rate);
        check_near(twist.forward, plant.state.forward, NORMAL_SLIP * speed, "forward, m/s");
        check_near(twist.left, plant.state.left, NORMAL_SLIP * speed, "left, m/s");
        check_near(twist.turn_rate, plant.state.turn_rate, NORMAL_SLIP * speed, "turn rate, rad/s");
        check_below(plant.slip_max, NORMAL_SLIP * speed, "slip, m/s");
    }
}

static void test_full_circle_comes_back(void)
{
    const struct twist twist = {0.5, 0, 0.5};
    drive(&twist, 2); /* settled */
    const struct planar_pose start = plant.state.pose;
    const struct jp_wheels wheels = wheels_of(&twist);
    for (int tick = 0; tick < (int)(2 * M_PI / 0.5 / TICK); tick++) {
        four_wheel_plant_tick(&plant, &wheels);
    }
    check_near(start.x, plant.state.pose.x, 0.03, "x, m");
    check_near(start.y, plant.state.pose.y, 0.03, "y, m");
    check_near(start.heading + 2 * M_PI, plant.state.pose.heading, 0.02, "heading, rad");
}

static void test_turning_in_place(void)
{
    const struct twist twist = {0, 0, 1};
    drive(&twist, 6);
    check_near(1, plant.state.turn_rate, 0.01, "turn rate, rad/s");
    check_below(hypot(plant.state.pose.x, plant.state.pose.y), 0.001, "drift, m");
}

/* At a steady speed the motors give what rolling and bearings take. */
static void test_steady_drive_pays_the_resistances(void)
{
    const struct twist twist = {1, 0, 0};
    drive(&twist, 5);
    const double before = plant.ledger.drive;
    const double x = plant.state.pose.x;
    drive(&(struct twist){1, 0, 0}, 0); /* no time, no work */
    check_near(before, plant.ledger.drive, 0, "J");
    const struct jp_wheels wheels = wheels_of(&twist);
    for (int tick = 0; tick < 200; tick++) {
        four_wheel_plant_tick(&plant, &wheels);
    }
    const double rolling = 0.015 * 45 * FOUR_WHEEL_GRAVITY;
    const double bearings = 4 * 0.01 / (0.1 * 0.1);
    check_near(rolling + bearings, (plant.ledger.drive - before) / (plant.state.pose.x - x), 0.02, "N");
}

/* Force at each wheel at a steady speed, N; `rise` adds a share of the weight. */
static double wheel_force(double rise)
{
    const double weight = 45 * FOUR_WHEEL_GRAVITY;

    return (0.015 + rise / sqrt(1 + rise * rise)) * weight / 4 + 0.01 / (0.1 * 0.1);
}

/* Power of the battery at 1 m/s on a slope, W. */
static double steady_power(double rise)
{
    const struct twist twist = {1, 0, 0};
    const struct four_wheel_patch slope = four_wheel_slope(rise, 0);
    static const struct planar_pose origin = {0, 0, 0};

    four_wheel_plant_init(&plant, &robot, &origin);
    TEST_ASSERT_TRUE(four_wheel_plant_add_patch(&plant, &slope));
    drive(&twist, 5);
    const double before = plant.ledger.battery;
    const struct jp_wheels wheels = wheels_of(&twist);
    for (int tick = 0; tick < 200; tick++) {
        four_wheel_plant_tick(&plant, &wheels);
    }
    return (plant.ledger.battery - before) / 2;
}

/* Gear of 0.8, 1 N·m/A at the wheel, 0.5 Ω, electronics of 25 W. */
static void test_motors_pay_for_gear_and_windings(void)
{
    const double level = wheel_force(0);
    const double up = wheel_force(0.1);

    check_near(25 + 4 * (level / 0.8 + 0.5 * pow(level * 0.1, 2)), steady_power(0), 0.05, "W");
    check_near(25 + 4 * (up / 0.8 + 0.5 * pow(up * 0.1, 2)), steady_power(0.1), 0.5, "W uphill");
}

/* Downhill the gear's and the windings' losses are what does not come back. */
static void test_a_slope_gives_back(void)
{
    const double down = wheel_force(-0.1);

    check_near(25 + 4 * (down * 0.8 + 0.5 * pow(down * 0.1 * 0.64, 2)), steady_power(-0.1), 0.5, "W downhill");
}

static double steering_work(double speed)
{
    static const struct planar_pose origin = {0, 0, 0};
    struct jp_wheels targets = {{0}, {0}};

    four_wheel_plant_init(&plant, &robot, &origin);
    drive(&(struct twist){speed, 0, 0}, 4);
    const double before = plant.ledger.steering;
    for (int i = 0; i < JP_WHEELS; i++) {
        targets.angle[i] = turns(0.5);
        targets.speed[i] = (jp_q24)(speed * JP_Q24_ONE);
    }
    for (int tick = 0; tick < 50; tick++) {
        four_wheel_plant_tick(&plant, &targets);
    }
    return plant.ledger.steering - before;
}

/* The wheels turn at 3 rad/s, 1 cm off the contact's middle. */
static void test_wheels_that_roll_steer_for_less(void)
{
    check_near(4 * 0.5, steering_work(0), 0.01, "J at a stand");
    check_below(steering_work(0.5), 4 * 0.5 * 0.03 / hypot(0.03, 0.5), "J at 0.5 m/s");
}

static void test_steering_keeps_its_rate_and_limit(void)
{
    struct jp_wheels targets = {{0}, {0}};
    for (int i = 0; i < JP_WHEELS; i++) {
        targets.angle[i] = i % 2 == 0 ? turns(M_PI * 0.9) : turns(-M_PI * 0.9);
    }
    double angle = 0;
    for (int tick = 0; tick < 200; tick++) {
        four_wheel_plant_tick(&plant, &targets);
        check_below(plant.state.wheels[0].angle - angle, 3.0 * TICK + 1e-9, "steering in a tick, rad");
        angle = plant.state.wheels[0].angle;
    }
    check_near(100 * M_PI / 180, plant.state.wheels[0].angle, 1e-3, "rad");
    check_near(-100 * M_PI / 180, plant.state.wheels[1].angle, 1e-3, "rad");
    check_near(4 * 1.0 * 100 * M_PI / 180, plant.ledger.steering, 0.01, "J of scrubbing");
}

static struct twist mirrored(const struct twist *twist)
{
    return (struct twist){twist->forward, -twist->left, -twist->turn_rate};
}

static void test_left_and_right_mirror(void)
{
    static const struct planar_pose origin = {0, 0, 0};
    const struct twist twist = {0.6, 0.2, 0.7};
    const struct twist other = mirrored(&twist);
    drive(&twist, 5);
    const struct four_wheel_state state = plant.state;
    four_wheel_plant_init(&plant, &robot, &origin);
    drive(&other, 5);
    check_near(state.pose.x, plant.state.pose.x, 1e-6, "x");
    check_near(-state.pose.y, plant.state.pose.y, 1e-6, "y");
    check_near(-state.pose.heading, plant.state.pose.heading, 1e-6, "heading");
}

/* The start's place and heading change nothing but place and heading. */
static void test_motion_is_the_same_everywhere(void)
{
    const struct planar_pose start = {12, -7, 2.5};
    const struct twist twist = {0.6, 0.2, 0.7};
    drive(&twist, 5);
    const struct planar_pose expected = planar_compose(&start, &plant.state.pose);
    four_wheel_plant_init(&plant, &robot, &start);
    drive(&twist, 5);
    check_near(expected.x, plant.state.pose.x, 1e-6, "x");
    check_near(expected.y, plant.state.pose.y, 1e-6, "y");
    check_near(0, planar_wrap(expected.heading - plant.state.pose.heading), 1e-6, "heading");
}

/* ---- Encoders ---- */

static void test_encoders_count_what_the_wheels_roll(void)
{
    const double step = 2 * M_PI * 0.1 / 51200;
    double way[JP_WHEELS] = {0};
    for (int tick = 0; tick < 1000; tick++) {
        const struct twist twist = {sin(tick * 0.01), 0.3, cos(tick * 0.02)};
        const struct jp_wheels wheels = wheels_of(&twist);
        four_wheel_plant_tick(&plant, &wheels);
        for (int i = 0; i < JP_WHEELS; i++) {
            const struct four_wheel_contact *wheel = &plant.state.wheels[i];
            way[i] += (double)plant.measured.speed[i] / JP_Q24_ONE * TICK;
            check_near(wheel->roll * 0.1, way[i], step + 1e-6, "rolled, m");
            check_near(wheel->angle, plant.measured.angle[i] / TURN_2_32 * 2 * M_PI, M_PI / 16384 + 1e-9, "angle, rad");
        }
    }
}

/* ---- Other ground ---- */

static void add_everywhere(double friction, double stiffness, double pull_x, double pull_y)
{
    const struct four_wheel_patch patch = {{-100, -100}, {100, 100}, friction, stiffness, stiffness, {pull_x, pull_y}};
    TEST_ASSERT_TRUE(four_wheel_plant_add_patch(&plant, &patch));
}

/* Locked wheels on wet ground: friction alone stops the robot, v²/(2 μ g). */
static void test_braking_distance_on_wet_ground(void)
{
    const double grip = 0.1;
    const struct jp_wheels stop = {{0}, {0}};
    add_everywhere(grip, 1, 0, 0);
    plant.state.forward = 1;
    for (int tick = 0; tick < 300; tick++) {
        four_wheel_plant_tick(&plant, &stop);
    }
    check_near(0, plant.state.forward, 1e-3, "speed, m/s");
    check_near(1 / (2 * DRY_FRICTION_N * grip * FOUR_WHEEL_GRAVITY), plant.state.pose.x, 0.02, "braking distance, m");
    check_near(45 / 2.0, plant.ledger.slip, 0.5, "J lost by sliding");
}

/* Without grip the body keeps its momentum, whatever the wheels do. */
static void test_ice_keeps_the_momentum(void)
{
    const struct twist twist = {-1, 0.5, 2};
    add_everywhere(1e-9, 1, 0, 0);
    plant.state.forward = 0.6;
    plant.state.left = -0.3;
    plant.state.turn_rate = 0.9;
    drive(&twist, 3);
    check_near(0.9, plant.state.turn_rate, 1e-6, "turn rate, rad/s");
    check_near(1.8, plant.state.pose.x, 1e-5, "x, m");
    check_near(-0.9, plant.state.pose.y, 1e-5, "y, m");
    check_near(2.7, plant.state.pose.heading, 1e-5, "heading, rad");
}

/* Across a slope every contact creeps at mass · pull / (4 stiffness). */
static void test_creep_across_a_slope(void)
{
    const struct twist twist = {1, 0, 0};
    add_everywhere(0.5, 0.02, 0, 0.3);
    drive(&twist, 5);
    check_near(45 * 0.3 / (4 * 3000 * 0.02), plant.state.left, 1e-3, "creep, m/s");
    check_near(1, plant.state.forward, 0.01, "forward, m/s");
}

/* Odometry by the wheels alone, from what the encoders say and the least-squares twist. */
static void integrate_wheels(struct planar_pose *pose)
{
    double x = 0;
    double y = 0;
    double turn = 0;
    double arms = 0;
    for (int i = 0; i < JP_WHEELS; i++) {
        const double speed = (double)plant.measured.speed[i] / JP_Q24_ONE;
        const double angle = plant.measured.angle[i] / TURN_2_32 * 2 * M_PI;
        x += speed * cos(angle) / JP_WHEELS;
        y += speed * sin(angle) / JP_WHEELS;
        turn += wheel_x(i) * speed * sin(angle) - wheel_y(i) * speed * cos(angle);
        arms += wheel_x(i) * wheel_x(i) + wheel_y(i) * wheel_y(i);
    }
    const double heading = turn / arms * TICK;
    const struct planar_pose motion = {(x * cos(heading / 2) - y * sin(heading / 2)) * TICK,
                                       (x * sin(heading / 2) + y * cos(heading / 2)) * TICK, heading};
    *pose = planar_compose(pose, &motion);
}

/* Drives 20 m of bends; how far off the wheels' odometry is, over the way. */
static double odometry_error(void)
{
    struct planar_pose pose = plant.state.pose;
    double way = 0;
    while (way < 20) {
        const struct twist twist = {fmin(1, 0.2 + way), 0, 0.4 * sin(way)};
        const struct jp_wheels wheels = wheels_of(&twist);
        four_wheel_plant_tick(&plant, &wheels);
        integrate_wheels(&pose);
        way += hypot(plant.state.forward, plant.state.left) * TICK;
    }
    return hypot(pose.x - plant.state.pose.x, pose.y - plant.state.pose.y) / way;
}

static void test_wheel_odometry_holds_on_firm_ground_only(void)
{
    static const struct planar_pose origin = {0, 0, 0};
    check_below(odometry_error(), 0.01, "firm ground");
    four_wheel_plant_init(&plant, &robot, &origin);
    const struct four_wheel_patch loose = {{-100, -100}, {100, 100}, 0.3, 0.1, 0.05, {-0.1, 0.15}};
    TEST_ASSERT_TRUE(four_wheel_plant_add_patch(&plant, &loose));
    const double wrong = odometry_error();
    check_near(0.06, wrong, 0.04, "loose slope");
}

/* Straight on at 0.5 m/s. */
static void drive_to(double x)
{
    const struct jp_wheels wheels = wheels_of(&(struct twist){0.5, 0, 0});
    for (int tick = 0; tick < 1000 && plant.state.pose.x < x; tick++) {
        four_wheel_plant_tick(&plant, &wheels);
    }
    check_near(x, plant.state.pose.x, 0.01, "x, m");
}

static void test_patches_end_at_their_borders_and_the_first_counts(void)
{
    const struct four_wheel_patch first = {{1, -1}, {2, 1}, 1, 1, 1, {0, 0}};
    const struct four_wheel_patch second = {{1, -1}, {3, 1}, 0.1, 0.01, 0.01, {0, 0.2}};
    TEST_ASSERT_TRUE(four_wheel_plant_add_patch(&plant, &first));
    TEST_ASSERT_TRUE(four_wheel_plant_add_patch(&plant, &second));
    drive_to(1.5);
    check_near(0, plant.state.left, 1e-6, "no creep on the first one, m/s");
    drive_to(2.6);
    check_near(45 * 0.2 / (4 * 3000 * 0.01), plant.state.left, 0.02, "creep on the second one, m/s");
    drive_to(4);
    check_near(0, plant.state.turn_rate, 5e-3, "no creep beyond, rad/s");
}

static void test_patches_are_bounded(void)
{
    for (int i = 0; i < FOUR_WHEEL_PATCHES_MAX; i++) {
        add_everywhere(1, 1, 0, 0);
    }
    const struct four_wheel_patch patch = random_patch();
    TEST_ASSERT_FALSE(four_wheel_plant_add_patch(&plant, &patch));
    TEST_ASSERT_EQUAL_INT(FOUR_WHEEL_PATCHES_MAX, (int)plant.patch_count);
}

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", worst_energy_error, "", at_most(ENERGY_ERROR),
                "four-wheel plant: energy that its ledger misses, of the turnover, worst of %lu drives", options.count);
    figures_add(
        figures, "make figures", worst_supply_error, "", at_most(SUPPLY_ERROR),
        "four-wheel plant: energy that the motors' ledger misses, of what the battery gave, worst of %lu drives",
        options.count);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);

    const int failures = RUN_PROPERTY(options, add_figures);

    printf("energy error: worst %.3g of the turnover\n", worst_energy_error);
    return failures;
}
