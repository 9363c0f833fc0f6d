/* The simulated plant against independent derivations, both robots, random states and voltages. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/balancer/plant.h"
#include "sim/balancer/robot_file.h"
#include "sim/base/random.h"
#include "tests/support/check.h"
#include "unity.h"

#define SEED 20180399u
#define TICK 1e-3

static struct robot_file robots[2];
static struct random noise;

void setUp(void)
{
    TEST_ASSERT_TRUE(robot_file_load("sim/robots/gao2018.cfg", &robots[0]));
    TEST_ASSERT_TRUE(robot_file_load("sim/robots/courier24.cfg", &robots[1]));
    random_init(&noise, SEED);
}

void tearDown(void)
{
}

static double square(double a)
{
    return a * a;
}

static struct plant_state random_state(void)
{
    return (struct plant_state){
        .wheel = random_uniform(&noise, -10, 10),
        .pitch = random_uniform(&noise, -1.2, 1.2),
        .yaw = random_uniform(&noise, -3, 3),
        .wheel_rate = random_uniform(&noise, -20, 20),
        .pitch_rate = random_uniform(&noise, -10, 10),
        .yaw_rate = random_uniform(&noise, -10, 10),
    };
}

static struct plant_input random_input(double voltage)
{
    return (struct plant_input){
        .voltage_left = random_uniform(&noise, -voltage, voltage),
        .voltage_right = random_uniform(&noise, -voltage, voltage),
        .driven = true,
    };
}

/* ---- Oracle: the Lagrangian from the speeds of points and bodies, differentiated numerically ---- */

/* q = (θ, ψ, φ); v = their rates. */
static double lagrangian(const struct robot_file *r, const double q[3], const double v[3])
{
    const double half = r->body.width_m / 2.0;
    const double forward = r->wheel.radius_m * v[0];
    const double height = r->body.centre_height_m;
    const double wheel_left = v[0] - half / r->wheel.radius_m * v[2];
    const double wheel_right = v[0] + half / r->wheel.radius_m * v[2];
    const double body_x = forward + height * cos(q[1]) * v[1];
    const double body_y = height * sin(q[1]) * v[2];
    const double body_z = -height * sin(q[1]) * v[1];
    const double wheels = r->wheel.mass_kg * (square(forward - half * v[2]) + square(forward + half * v[2]));
    const double body = r->body.mass_kg * (square(body_x) + square(body_y) + square(body_z));
    const double wheel_spin =
        r->wheel.mass_kg * square(r->wheel.radius_m) / 2.0 * (square(wheel_left) + square(wheel_right));
    const double pitch_spin = r->body.mass_kg * square(height) / 3.0 * square(v[1]);
    const double yaw_spin = r->body.mass_kg * (square(r->body.width_m) + square(r->body.depth_m)) / 12.0 * square(v[2]);
    const double rotors = r->motor.rotor_inertia_kg_m2 * square(r->motor.gear_ratio) *
                          (square(wheel_left - v[1]) + square(wheel_right - v[1]));
    return (wheels + body + wheel_spin + pitch_spin + yaw_spin + rotors) / 2.0 -
           r->body.mass_kg * PLANT_GRAVITY * height * cos(q[1]);
}

/* ∂L/∂v_i; exact up to rounding, for L is quadratic in v. */
static double momentum(const struct robot_file *r, const double q[3], const double v[3], int i)
{
    double high[3] = {v[0], v[1], v[2]};
    double low[3] = {v[0], v[1], v[2]};
    high[i] += 1.0;
    low[i] -= 1.0;
    return (lagrangian(r, q, high) - lagrangian(r, q, low)) / 2.0;
}

/* d/dt ∂L/∂v_i − ∂L/∂q_i along q̈ = a, by central differences of 4th order. */
static double euler_lagrange(const struct robot_file *r, const double q[3], const double v[3], const double a[3], int i)
{
    const double h = 1e-3;
    const double weights[] = {1.0 / 12.0, -8.0 / 12.0, 8.0 / 12.0, -1.0 / 12.0};
    const double places[] = {-2.0, -1.0, 1.0, 2.0};
    double rate = 0.0;
    for (int k = 0; k < 4; k++) {
        const double t = places[k] * h;
        const double later_q[3] = {q[0] + t * v[0], q[1] + t * v[1], q[2] + t * v[2]};
        const double later_v[3] = {v[0] + t * a[0], v[1] + t * a[1], v[2] + t * a[2]};
        double moved[3] = {q[0], q[1], q[2]};
        moved[i] += t;
        rate += weights[k] / h * (momentum(r, later_q, later_v, i) - lagrangian(r, moved, v));
    }
    return rate;
}

/* Virtual work of motors, frictions and push on each coordinate. */
static void generalised_forces(const struct robot_file *r, const double q[3], const double v[3],
                               const struct plant_input *input, double force[3])
{
    const double n = r->motor.gear_ratio;
    const double voltages[2] = {input->voltage_left, input->voltage_right};
    force[0] = input->push_n * r->wheel.radius_m;
    force[1] = input->push_n * r->body.centre_height_m * cos(q[1]);
    force[2] = input->yaw_torque_nm;
    for (int side = 0; side < 2; side++) {
        const double arm = (side == 0 ? -1.0 : 1.0) * r->body.width_m / (2.0 * r->wheel.radius_m);
        const double wheel = v[0] + arm * v[2];
        const double shaft = n * (wheel - v[1]);
        const double ampere = (voltages[side] - r->motor.back_emf * shaft) / r->motor.resistance_ohm;
        const double motor =
            (input->driven ? n * r->motor.torque_constant * ampere : 0.0) - r->motor.friction * (wheel - v[1]);
        const double ground = -r->ground.friction * wheel;
        force[0] += motor + ground;
        force[1] -= motor;
        force[2] += arm * (motor + ground);
    }
}

static void test_equations_follow_from_the_lagrangian(void)
{
    for (int run = 0; run < 2000; run++) {
        const struct robot_file *robot = &robots[run % 2];
        struct plant plant;
        plant_init(&plant, robot);
        plant.state = random_state();
        struct plant_input input = random_input(24.0);
        input.driven = run % 3 != 0;
        input.push_n = random_uniform(&noise, -20, 20);
        input.yaw_torque_nm = random_uniform(&noise, -5, 5);

        const struct plant_acceleration found = plant_acceleration(&plant, &input);
        const double q[3] = {plant.state.wheel, plant.state.pitch, plant.state.yaw};
        const double v[3] = {plant.state.wheel_rate, plant.state.pitch_rate, plant.state.yaw_rate};
        const double a[3] = {found.wheel, found.pitch, found.yaw};
        double force[3];
        generalised_forces(robot, q, v, &input, force);
        for (int i = 0; i < 3; i++) {
            check_near(force[i], euler_lagrange(robot, q, v, a, i), 1e-5, "generalised force");
        }
    }
}

static double lagrangian_energy(const struct robot_file *robot, const struct plant_state *s)
{
    const double q[3] = {s->wheel, s->pitch, s->yaw};
    const double v[3] = {s->wheel_rate, s->pitch_rate, s->yaw_rate};
    const double still[3] = {0};
    return lagrangian(robot, q, v) - 2.0 * lagrangian(robot, q, still);
}

static void test_mechanical_energy_is_that_of_the_lagrangian(void)
{
    for (int run = 0; run < 200; run++) {
        struct plant plant;
        plant_init(&plant, &robots[run % 2]);
        plant.state = random_state();
        const double energy = lagrangian_energy(&robots[run % 2], &plant.state);
        check_near(energy, plant_mechanical_energy(&plant), 1e-9, "mechanical energy, J");
    }
}

/* ---- Energy ledger ---- */

struct ledger_run {
    const char *name;
    double voltage;
    bool driven;
    double push_n;
    bool balanced; /* else it falls */
};

/* Keeps the robot up, roughly. */
static double feedback(const struct plant *plant)
{
    const struct plant_state *s = &plant->state;
    return 150.0 * s->pitch + 20.0 * s->pitch_rate + 2.0 * s->wheel_rate;
}

static struct plant_input ledger_input(const struct ledger_run *run, const struct plant *plant, int tick)
{
    struct plant_input input = random_input(run->voltage);
    const double voltage = run->balanced ? feedback(plant) : 0.0;
    input.voltage_left += voltage;
    input.voltage_right += voltage;
    input.driven = run->driven;
    if (tick % 700 < 50) {
        input.push_n = run->push_n;
        input.yaw_torque_nm = run->push_n / 10.0;
    }
    return input;
}

static void check_balance(const struct plant *plant, double start, const char *what)
{
    const struct plant_ledger *l = &plant->ledger;
    const double residual = plant_mechanical_energy(plant) - (start + l->electrical - l->copper - l->friction -
                                                              l->conversion + l->push - l->impact + l->change);
    const double throughput = fabs(start) + fabs(l->electrical) + l->copper + l->friction + fabs(l->push);
    check_below(fabs(residual) / throughput, 1e-8, what);
}

static void check_ledger(const struct robot_file *robot, const struct ledger_run *run, int ticks)
{
    struct plant plant;
    plant_init(&plant, robot);
    plant.state.pitch = random_uniform(&noise, -0.1, 0.1);
    plant.state.yaw_rate = random_uniform(&noise, -1, 1);
    plant.state.wheel_rate = random_uniform(&noise, -2, 2);
    const double start = plant_mechanical_energy(&plant);
    double motor = 0.0;
    for (int tick = 0; tick < ticks; tick++) {
        const struct plant_input input = ledger_input(run, &plant, tick);
        motor += input.driven
                     ? (square(input.voltage_left) + square(input.voltage_right)) / robot->motor.resistance_ohm * TICK
                     : 0.0;
        plant_step(&plant, &input, TICK);
    }
    const struct plant_ledger *l = &plant.ledger;
    check_balance(&plant, start, run->name);
    check_near(motor, l->motor, 1e-9 * (1.0 + motor), "the paper's motor energy");
    TEST_ASSERT_TRUE_MESSAGE(plant.fallen == !run->balanced, run->name);
    TEST_ASSERT_TRUE_MESSAGE(run->balanced ? l->impact == 0.0 : l->impact > 0.0, "impact");
    TEST_ASSERT_TRUE_MESSAGE(run->driven || (l->electrical == 0.0 && l->copper == 0.0), "coasting draws nothing");
    TEST_ASSERT_TRUE_MESSAGE((robot->motor.back_emf == robot->motor.torque_constant) == (l->conversion == 0.0) ||
                                 !run->driven,
                             "conversion");
}

static void test_ledger_closes(void)
{
    static const struct ledger_run runs[] = {
        {"driven and balanced", 5.0, true, 0.0, true}, {"pushed", 5.0, true, 20.0, true},
        {"driven to a fall", 24.0, true, 0.0, false},  {"coasting to a fall", 0.0, false, 0.0, false},
        {"pushed to a fall", 5.0, false, 20.0, false},
    };
    for (size_t i = 0; i < 2 * sizeof runs / sizeof runs[0]; i++) {
        for (int repeat = 0; repeat < 5; repeat++) {
            check_ledger(&robots[i % 2], &runs[i / 2], 10000);
        }
    }
}

static void test_hand_takes_and_gives_energy(void)
{
    struct plant plant;
    plant_init(&plant, &robots[1]);
    plant.state = random_state();
    const double start = plant_mechanical_energy(&plant);
    plant_hold(&plant, 0.3);
    check_near(start, plant_mechanical_energy(&plant) + plant.ledger.impact, 1e-12, "held");
    const struct plant_state held = plant.state;
    const struct plant_input input = {.voltage_left = 3.0, .voltage_right = -4.0, .driven = true, .push_n = 5.0};
    for (int tick = 0; tick < 1000; tick++) {
        plant_step(&plant, &input, TICK);
    }
    TEST_ASSERT_EQUAL_MEMORY(&held, &plant.state, sizeof held);
    check_near(25.0 / robots[1].motor.resistance_ohm, plant.ledger.copper, 1e-9, "stalled motors heat");
    plant_release(&plant);
    plant_step(&plant, &input, TICK);
    TEST_ASSERT_TRUE(plant.state.pitch != held.pitch);
}

/* ---- Changes in mid-drive ---- */

static void test_change_enters_what_the_payload_carries(void)
{
    for (int run = 0; run < 200; run++) {
        const struct robot_file *robot = &robots[run % 2];
        struct robot_file loaded = *robot;
        loaded.body.mass_kg += 1.0;
        struct plant plant;
        plant_init(&plant, robot);
        plant.state = random_state();
        const struct plant before = plant;

        plant_change(&plant, &loaded);
        TEST_ASSERT_EQUAL_MEMORY(&before.state, &plant.state, sizeof before.state);
        const double carried = lagrangian_energy(&loaded, &plant.state) - lagrangian_energy(robot, &plant.state);
        check_near(carried, plant.ledger.change, 1e-9, "energy that came");
        plant_change(&plant, robot);
        check_near(0.0, plant.ledger.change, 1e-9, "and went");
        TEST_ASSERT_EQUAL_MEMORY(&before.constants, &plant.constants, sizeof before.constants);
    }
}

static void test_change_without_mass_carries_nothing(void)
{
    struct robot_file rough = robots[1];
    rough.ground.friction *= 3.0;
    rough.motor.friction *= 2.0;
    rough.motor.resistance_ohm *= 1.1;
    struct plant plant;
    plant_init(&plant, &robots[1]);
    plant.state = random_state();
    plant_change(&plant, &rough);
    TEST_ASSERT_TRUE(plant.ledger.change == 0.0);
    TEST_ASSERT_TRUE(plant.constants.ground_friction == rough.ground.friction);
    TEST_ASSERT_TRUE(plant.constants.motor_friction == rough.motor.friction);
    TEST_ASSERT_TRUE(plant.constants.resistance == rough.motor.resistance_ohm);
}

static void test_ledger_closes_over_changes(void)
{
    static const struct ledger_run driven = {"with changes", 5.0, true, 20.0, true};
    for (int run = 0; run < 10; run++) {
        const struct robot_file *robot = &robots[run % 2];
        double moved = 0.0;
        struct plant plant;
        plant_init(&plant, robot);
        plant.state.wheel_rate = random_uniform(&noise, -2, 2);
        const double start = plant_mechanical_energy(&plant);
        for (int tick = 0; tick < 10000; tick++) {
            if (tick % 1000 == 500) {
                const double change = plant.ledger.change;
                struct robot_file varied = *robot;
                varied.body.mass_kg += random_uniform(&noise, -0.3, 1.2);
                varied.ground.friction *= random_uniform(&noise, 0.5, 2.0);
                plant_change(&plant, &varied);
                moved += fabs(plant.ledger.change - change);
            }
            const struct plant_input input = ledger_input(&driven, &plant, tick);
            plant_step(&plant, &input, TICK);
        }
        check_balance(&plant, start, driven.name);
        TEST_ASSERT_FALSE(plant.fallen);
        TEST_ASSERT_TRUE_MESSAGE(moved > 1.0, "the changes must weigh in the balance");
    }
}

/* ---- Known motions ---- */

static void test_upright_is_an_unstable_equilibrium(void)
{
    for (int i = 0; i < 2; i++) {
        const struct plant_input off = {0};
        struct plant plant;
        plant_init(&plant, &robots[i]);
        for (int tick = 0; tick < 1000; tick++) {
            plant_step(&plant, &off, TICK);
        }
        const struct plant_state rest = {0};
        TEST_ASSERT_EQUAL_MEMORY(&rest, &plant.state, sizeof rest);

        plant.state.pitch = 1e-6;
        for (int tick = 0; tick < 1000; tick++) {
            plant_step(&plant, &off, TICK);
        }
        TEST_ASSERT_TRUE_MESSAGE(plant.state.pitch > 1e-4, "a small tilt must grow");
    }
}

/* Steady at speed v: friction at the ground balances the motors, gravity their reaction on the body. Found by
 * bisection over the voltage, with current and back-EMF written out. */
static double cruise_voltage(const struct robot_file *r, double speed)
{
    const double rate = speed / r->wheel.radius_m;
    double low = 0.0;
    double high = 100.0;
    for (int i = 0; i < 100; i++) {
        const double middle = (low + high) / 2.0;
        const double shaft_torque = r->motor.torque_constant *
                                    (middle - r->motor.back_emf * r->motor.gear_ratio * rate) / r->motor.resistance_ohm;
        const double surplus = r->motor.gear_ratio * shaft_torque - (r->motor.friction + r->ground.friction) * rate;
        *(surplus > 0.0 ? &high : &low) = middle;
    }
    return low;
}

static void test_steady_cruise(void)
{
    check_near(8.36, cruise_voltage(&robots[0], 1.0), 0.01, "cruising voltage of the reference at 1 m/s");
    for (int i = 0; i < 2; i++) {
        const struct robot_file *r = &robots[i];
        const double rate = 1.0 / r->wheel.radius_m;
        const double lean =
            asin(2.0 * r->ground.friction * rate / (r->body.mass_kg * PLANT_GRAVITY * r->body.centre_height_m));
        const double voltage = cruise_voltage(r, 1.0);
        const struct plant_input input = {.voltage_left = voltage, .voltage_right = voltage, .driven = true};
        struct plant plant;
        plant_init(&plant, r);
        plant.state.wheel_rate = rate;
        plant.state.pitch = lean;
        const struct plant_acceleration a = plant_acceleration(&plant, &input);
        check_below(fabs(a.wheel) + fabs(a.pitch) + fabs(a.yaw), 1e-9, "cruise is steady");
    }
}

static void test_left_and_right_mirror(void)
{
    for (int i = 0; i < 2; i++) {
        struct plant plant;
        struct plant mirror;
        plant_init(&plant, &robots[i]);
        plant_init(&mirror, &robots[i]);
        for (int tick = 0; tick < 3000; tick++) {
            struct plant_input input = random_input(5.0);
            input.voltage_left += feedback(&plant);
            input.voltage_right += feedback(&plant);
            const struct plant_input swapped = {
                .voltage_left = input.voltage_right, .voltage_right = input.voltage_left, .driven = true};
            plant_step(&plant, &input, TICK);
            plant_step(&mirror, &swapped, TICK);
        }
        TEST_ASSERT_TRUE(plant.state.yaw != 0.0);
        check_near(plant.state.wheel, mirror.state.wheel, 1e-9, "wheel");
        check_near(plant.state.pitch, mirror.state.pitch, 1e-9, "pitch");
        check_near(-plant.state.yaw, mirror.state.yaw, 1e-9, "yaw");
        check_near(plant.x, mirror.x, 1e-9, "x");
        check_near(-plant.y, mirror.y, 1e-9, "y");
    }
}

/* ---- Integration ---- */

static struct plant lively_run(const struct robot_file *robot, int steps)
{
    const struct plant_input input = {.voltage_left = 4.0, .voltage_right = -3.0, .driven = true, .push_n = 5.0};
    struct plant plant;
    plant_init(&plant, robot);
    plant.state = (struct plant_state){.pitch = -0.2, .wheel_rate = 3.0, .pitch_rate = 1.0, .yaw_rate = 4.0};
    for (int i = 0; i < steps; i++) {
        plant_step(&plant, &input, 0.256 / steps);
    }
    TEST_ASSERT_FALSE(plant.fallen);
    return plant;
}

static double gap(const struct plant *a, const struct plant *b)
{
    return sqrt(square(a->state.wheel - b->state.wheel) + square(a->state.pitch - b->state.pitch) +
                square(a->state.yaw - b->state.yaw) + square(a->state.wheel_rate - b->state.wheel_rate) +
                square(a->state.pitch_rate - b->state.pitch_rate) + square(a->state.yaw_rate - b->state.yaw_rate));
}

static void test_integration_is_of_fourth_order(void)
{
    for (int i = 0; i < 2; i++) {
        const struct plant exact = lively_run(&robots[i], 8192);
        const struct plant coarse = lively_run(&robots[i], 128);
        const struct plant fine = lively_run(&robots[i], 256);
        check_near(16.0, gap(&coarse, &exact) / gap(&fine, &exact), 1.6, "error ratio of halved steps");
        check_near(16.0,
                   (coarse.ledger.electrical - exact.ledger.electrical) /
                       (fine.ledger.electrical - exact.ledger.electrical),
                   2.0, "error ratio of the ledger");
        check_below(hypot(fine.x - exact.x, fine.y - exact.y), 1e-6, "position, m");
    }
}

static void test_position_follows_an_arc(void)
{
    const struct plant_input off = {0};
    struct robot_file robot = robots[0];
    robot.motor.friction = 0.0;
    robot.ground.friction = 0.0;
    struct plant plant;
    plant_init(&plant, &robot);
    plant.state.wheel_rate = 5.0;
    plant.state.yaw_rate = 2.0;
    for (int tick = 0; tick < 1000; tick++) {
        plant.state.pitch = 0.0;
        plant.state.pitch_rate = 0.0;
        plant_step(&plant, &off, TICK);
    }
    const double radius = robot.wheel.radius_m * plant.state.wheel_rate / plant.state.yaw_rate;
    check_near(2.0, plant.state.yaw, 1e-9, "yaw");
    check_near(radius * sin(2.0), plant.x, 1e-9, "x");
    check_near(radius * (1.0 - cos(2.0)), plant.y, 1e-9, "y");
}

/* The bound that the robot file is checked with: no power iteration of the linear damping finds a faster mode. */
static void test_damping_rate_bounds_the_fastest_mode(void)
{
    for (int i = 0; i < 2; i++) {
        struct plant plant;
        plant_init(&plant, &robots[i]);
        const struct plant_input shorted = {.driven = true};
        double fastest = 0.0;
        struct plant_state s = {.wheel_rate = 1e-3, .pitch_rate = -0.5e-3};
        for (int k = 0; k < 100; k++) {
            plant.state = s;
            const struct plant_acceleration a = plant_acceleration(&plant, &shorted);
            fastest = hypot(a.wheel, a.pitch) / hypot(s.wheel_rate, s.pitch_rate);
            const double scale = 1e-3 / hypot(a.wheel, a.pitch);
            s.wheel_rate = scale * a.wheel;
            s.pitch_rate = scale * a.pitch;
        }
        const double bound = plant_damping_rate(&plant.constants);
        TEST_ASSERT_TRUE(bound >= fastest * 0.999999 && bound < 2.0 * fastest);
    }
}

int main(void)
{
    (void)printf("seed %u\n", SEED);
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
