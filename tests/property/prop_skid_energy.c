/*
 * What the plant of skid steer and differential drive spends, against the formulas of the paper (skid_steer_model.h):
 * alike where what they assume holds, apart where it does not. The tables are printed.
 */
#include <stdio.h>

#include "tests/support/options.h"
#include "tests/support/skid_rig.h"
#include "unity.h"

/* Of the power that the formulas foretell. */
#define LEVEL_ERROR 0.002
#define CLIMB_ERROR 0.035
#define PIVOT_ERROR 0.06

/* Of the torque that Coulomb's friction asks for, integrated over the contacts. */
#define COULOMB_ERROR 0.005

/* Tyres so short of compliance that any slip gives the whole friction. */
#define COULOMB_CONTACT 5

static const struct options defaults = {.count = 12, .seed = 2018};
static struct options options;
static struct random noise;
static double worst_level;
static double worst_climb;
static double worst_pivot;

static struct skid_steer_model zhang;
static struct skid_steer_model burger;
static struct skid_rig rig;

void setUp(void)
{
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/zhang2018.cfg", &zhang));
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/burger.cfg", &burger));
    random_init(&noise, options.seed);
}

void tearDown(void)
{
}

static double square(double a)
{
    return a * a;
}

/* ---- Straight on ---- */

static struct skid_steady drive_up(const struct skid_steer_model *model, double degrees, double speed)
{
    const struct skid_slope slope = skid_slope_towards(degrees, 0);
    const struct skid_ground ground = skid_ground_slope(&slope);

    skid_rig_start(&rig, model, &ground, 0);
    return skid_rig_measure(&rig, speed, speed);
}

static double grade_of(double degrees)
{
    return tan(degrees * M_PI / 180);
}

static void test_level_driving_costs_what_the_formula_says(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        struct skid_steer_model model = zhang;
        model.ground.rolling = random_uniform(&noise, 0.01, 0.1);
        model.body.mass_kg = random_uniform(&noise, 60, 120);
        model.motor.efficiency = random_uniform(&noise, 0.5, 1);
        const double speed = random_uniform(&noise, 0.1, 0.9);
        const struct skid_steady steady = drive_up(&model, 0, speed);
        const double error = fabs(steady.power / skid_foretold(&model, &steady, 0) - 1);
        worst_level = fmax(worst_level, error);
        check_below(error, LEVEL_ERROR, "level, of the formula's power");
    }
}

/* The tyres' slip is what the formula lacks; its share of the work is the slip itself. */
static void test_climbing_costs_what_the_formula_says(void)
{
    (void)printf("\nstraight on, W        formula    plant    ratio    tyres' slip\n");
    for (int degrees = 0; degrees <= 15; degrees += 5) {
        for (int step = 1; step <= 3; step++) {
            const struct skid_steady steady = drive_up(&zhang, degrees, 0.28 * step);
            const double foretold = skid_foretold(&zhang, &steady, grade_of(degrees));
            (void)printf("  up %2d° at %.2f m/s  %8.2f %8.2f %8.4f %10.2f\n", degrees, steady.speed, foretold,
                         steady.power, steady.power / foretold, steady.scrub);
            worst_climb = fmax(worst_climb, fabs(steady.power / foretold - 1));
            check_below(fabs(steady.power / foretold - 1), CLIMB_ERROR, "uphill, of the formula's power");
            check_near(foretold, steady.power - steady.scrub / zhang.motor.efficiency, 0.01 * foretold,
                       "what is left without slip, W");
        }
    }
}

static void test_random_climbs_without_slip_cost_what_the_formula_says(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        struct skid_steer_model model = zhang;
        model.tyre.contact_length_m = COULOMB_CONTACT; /* adhesion holds: nothing slips */
        model.motor.current_limit_a = 40;
        model.motor.efficiency = random_uniform(&noise, 0.6, 1);
        const double degrees = random_uniform(&noise, 1, 14);
        const struct skid_steady steady = drive_up(&model, degrees, random_uniform(&noise, 0.1, 0.8));
        const double foretold = skid_foretold(&model, &steady, grade_of(degrees));
        /* The formula takes the rise over the run for the rise over the way, which adds to the windings' loss. */
        check_near(foretold, steady.power, 0.025 * foretold, "uphill without slip, W");
    }
}

/* Downhill the formula keeps the current of driving, τ/(K g η); a motor that brakes behind a gear that loses needs η²
 * of it. What it generates is alike. */
static void test_braking_downhill_costs_what_its_current_says(void)
{
    const double constant = zhang.motor.torque_constant * zhang.motor.gear_ratio;

    (void)printf("\nstraight on, W        formula    plant    with the current of braking\n");
    for (int degrees = -15; degrees <= -5; degrees += 5) {
        for (int step = 1; step <= 3; step++) {
            const struct skid_steady steady = drive_up(&zhang, degrees, 0.28 * step);
            const struct skid_steer_motion motion = {steady.speed, 0, grade_of(degrees)};
            const struct skid_steer_sides torques = skid_steer_torques(&zhang, &motion);
            const struct skid_steer_sides rates = skid_steer_wheel_speeds(&zhang, &motion);
            const double eta = zhang.motor.efficiency;
            const double side = zhang.motor.recuperation * eta * torques.left * rates.left +
                                square(eta * torques.left / constant) * zhang.motor.resistance_ohm;
            const double expected = 2 * side + zhang.electronics.power_w;
            const double foretold = skid_foretold(&zhang, &steady, grade_of(degrees));
            (void)printf("  %3d° at %.2f m/s    %8.2f %8.2f %8.2f\n", degrees, steady.speed, foretold, steady.power,
                         expected);
            TEST_ASSERT_TRUE(torques.left < 0);
            check_near(expected, steady.power, 0.02 * fabs(torques.left * rates.left) * 2 + 0.3, "downhill, W");
            TEST_ASSERT_TRUE_MESSAGE(steady.power < foretold, "the formula foretells too much downhill");
        }
    }
}

/* A differential drive has no turning resistance: its caster and its gears' friction are what the formula lacks. */
static void test_differential_drive_costs_rolling_gears_and_caster(void)
{
    const double weight = burger.body.mass_kg * STANDARD_GRAVITY;
    const double on_caster = burger.body.centre_ahead_m / burger.caster.ahead_m;
    const double eta = burger.motor.efficiency;
    const double constant = burger.motor.torque_constant * burger.motor.gear_ratio;

    for (int step = 1; step <= 3; step++) {
        const struct skid_steady steady = drive_up(&burger, 0, 0.05 * step);
        const double force = weight * (burger.ground.rolling * (1 - on_caster) + burger.caster.rolling * on_caster);
        const double torque = force / 2 * burger.wheel.radius_m + burger.motor.friction_nm;
        const double rate = steady.speed / burger.wheel.radius_m;
        const double expected =
            2 * (torque * rate / eta + square(torque / eta / constant) * burger.motor.resistance_ohm) +
            burger.electronics.power_w;
        check_near(expected, steady.power, 0.002 * expected, "differential drive, W");
        TEST_ASSERT_TRUE(steady.power > skid_foretold(&burger, &steady, 0));
    }
}

static void test_differential_drive_turns_as_its_wheels_say(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const double speed = random_uniform(&noise, -0.1, 0.1);
        const double turn = random_uniform(&noise, -1, 1);
        const double across = turn * burger.body.width_m / 2;
        skid_rig_start(&rig, &burger, &skid_level, 0);
        const struct skid_steady steady = skid_rig_measure(&rig, speed - across, speed + across);
        check_near(turn, steady.turn_rate, 0.02 * fabs(turn) + 1e-4, "turn rate, rad/s");
        check_below(steady.scrub, 0.1, "lost by slip, W");
    }
}

/* ---- Turning ---- */

/* The robot with its load spread evenly over the length of its tracks, on `axles` axles. */
static struct skid_steer_model spread(const struct skid_steer_model *model, int axles)
{
    struct skid_steer_model even = *model;

    even.wheel.axles = axles;
    even.wheel.inertia_kg_m2 = model->wheel.inertia_kg_m2 * model->wheel.axles / axles;
    even.body.wheelbase_m = model->body.wheelbase_m * (axles - 1) / axles;
    return even;
}

static struct skid_steady turn_with(const struct skid_steer_model *model, double speed, double turn_rate)
{
    const double across = turn_rate * model->body.width_m / 2;

    skid_rig_start(&rig, model, &skid_level, 0);
    return skid_rig_measure(&rig, speed - across, speed + across);
}

/* N·m of what turns the body over that of tracks which slide sideways, μ G l/4. */
static double moment_ratio(const struct skid_steer_model *model, const struct skid_steady *steady)
{
    const double weight = model->body.mass_kg * STANDARD_GRAVITY;
    const double force = steady->torque[SKID_RIGHT] * model->motor.efficiency / model->wheel.radius_m -
                         model->ground.rolling * weight / 2;

    return force * model->body.width_m / (model->ground.friction * weight * zhang.body.wheelbase_m / 4);
}

/* Even load, Coulomb's friction: the turning moment is the paper's within its empirical factor, 1/0.925. */
static void test_even_load_turns_on_the_spot_for_what_the_formula_says(void)
{
    struct skid_steer_model model = spread(&zhang, SKID_STEER_AXLES_MAX);
    model.tyre.contact_length_m = COULOMB_CONTACT;

    for (int step = 1; step <= 4; step++) {
        const struct skid_steady steady = turn_with(&model, 0, 0.25 * step);
        const double weight = model.body.mass_kg * STANDARD_GRAVITY;
        const double tracks = model.ground.friction * weight * zhang.body.wheelbase_m / 4 * steady.turn_rate;
        const double error = fabs(steady.scrub / (tracks / 0.925) - 1);
        worst_pivot = fmax(worst_pivot, error);
        check_below(error, PIVOT_ERROR, "scrubbing on the spot, of the formula's");
        check_near(1, moment_ratio(&model, &steady), 0.06, "moment over μ G l/4");
        check_near(1, steady.power / skid_foretold(&zhang, &steady, 0), 0.12, "power over the formula's");
    }
}

/* The tread's slip along, as a share of w B/2, at which Coulomb's friction balances the moments; an oracle of its own.
 */
static double coulomb_slip(const struct skid_steer_model *model)
{
    double low = 0;
    double high = 100;

    for (int i = 0; i < 200; i++) {
        const double slip = (low + high) / 2;
        double moment = 0;
        for (int axle = 0; axle < model->wheel.axles; axle++) {
            const double x = model->body.wheelbase_m * ((double)axle / (model->wheel.axles - 1) - 0.5);
            const double along = slip * model->body.width_m / 2;
            const double speed = hypot(along, x);
            moment += (along * model->body.width_m / 2 - x * x) / speed;
        }
        if (moment > 0) {
            high = slip;
        } else {
            low = slip;
        }
    }
    return low;
}

static void check_coulomb(int axles, double turn_rate)
{
    struct skid_steer_model model = axles == 2 ? zhang : spread(&zhang, axles);
    model.tyre.contact_length_m = COULOMB_CONTACT;
    const double slip = coulomb_slip(&model);
    const struct skid_steady steady = turn_with(&model, 0, turn_rate);
    double force = 0;
    double lost = 0;

    for (int axle = 0; axle < axles; axle++) {
        const double x = model.body.wheelbase_m * ((double)axle / (axles - 1) - 0.5);
        const double along = slip * model.body.width_m / 2;
        const double grip = model.ground.friction * model.body.mass_kg * STANDARD_GRAVITY / (2 * axles);
        force += grip * along / hypot(along, x);
        lost += 2 * grip * hypot(along, x) * fabs(steady.turn_rate);
    }
    const double rolling = model.ground.rolling * model.body.mass_kg * STANDARD_GRAVITY / 2;
    const double torque = (force + rolling) * model.wheel.radius_m / model.motor.efficiency;
    check_near(turn_rate / (1 + slip), steady.turn_rate, COULOMB_ERROR * fabs(turn_rate),
               "turn rate by Coulomb, rad/s");
    check_near(lost, steady.scrub, COULOMB_ERROR * lost, "scrubbing by Coulomb, W");
    check_near(copysign(torque, turn_rate), steady.torque[SKID_RIGHT], COULOMB_ERROR * torque,
               "torque by Coulomb, N·m");
    check_near(-copysign(torque, turn_rate), steady.torque[SKID_LEFT], COULOMB_ERROR * torque,
               "torque by Coulomb, N·m");
}

static void test_turning_on_the_spot_balances_coulombs_friction(void)
{
    static const int axles[] = {2, 4, 6, 16};

    for (size_t i = 0; i < sizeof axles / sizeof axles[0]; i++) {
        check_coulomb(axles[i], 0.2);
        check_coulomb(axles[i], 0.8);
        check_coulomb(axles[i], -0.5);
    }
}

/* Four wheels stand at the ends of what the formula takes for evenly loaded: their arms are twice as long. */
static void test_four_wheels_turn_for_more_than_the_formula_says(void)
{
    (void)printf("\non the spot                        formula    plant    ratio   moment/(μ G l/4)\n");
    static const struct {
        const char *name;
        int axles;
        double contact;
    } kinds[] = {{"4 wheels, tyres", 2, 0},
                 {"4 wheels, Coulomb", 2, COULOMB_CONTACT},
                 {"32 wheels, tyres", 16, 0},
                 {"32 wheels, Coulomb", 16, COULOMB_CONTACT}};

    for (size_t kind = 0; kind < sizeof kinds / sizeof kinds[0]; kind++) {
        struct skid_steer_model model = kinds[kind].axles == 2 ? zhang : spread(&zhang, kinds[kind].axles);
        model.tyre.contact_length_m = kinds[kind].contact > 0 ? kinds[kind].contact : model.tyre.contact_length_m;
        for (int step = 0; step < 3; step++) {
            static const double rates[] = {0.1, 0.39269908, 1};
            const struct skid_steady steady = turn_with(&model, 0, rates[step]);
            const double foretold = skid_foretold(&zhang, &steady, 0);
            const double ratio = moment_ratio(&model, &steady);
            (void)printf("  %-19s %.3f rad/s %8.2f %8.2f %8.3f %8.3f\n", kinds[kind].name, steady.turn_rate, foretold,
                         steady.power, steady.power / foretold, ratio);
            TEST_ASSERT_TRUE(kinds[kind].axles == 2 ? ratio > 1.4 : ratio < 1);
            check_below(fabs(steady.speed), 1e-3, "drift, m/s");
        }
    }
}

static void test_radius_and_cost_of_bends(void)
{
    (void)printf("\nbends at 0.4 m/s of the wheels: radius by the wheels, driven;  formula    plant    ratio\n");
    double last_ratio = 10;
    for (int step = 0; step < 6; step++) {
        static const double radii[] = {0.5, 1, 2, 5, 10, 20};
        const double turn_rate = 0.4 / radii[step];
        const struct skid_steady steady = turn_with(&zhang, 0.4, turn_rate);
        const double radius = steady.speed / steady.turn_rate;
        const double foretold = skid_foretold(&zhang, &steady, 0);
        (void)printf("  %5.1f m %8.2f m %27.2f %8.2f %8.3f\n", radii[step], radius, foretold, steady.power,
                     steady.power / foretold);
        TEST_ASSERT_TRUE_MESSAGE(radius > 1.3 * radii[step], "slip widens the bend");
        TEST_ASSERT_TRUE_MESSAGE(radius < 2 * radii[step], "not without bound");
        TEST_ASSERT_TRUE_MESSAGE(steady.power / foretold < last_ratio, "wider bends are nearer to the formula");
        last_ratio = steady.power / foretold;
    }
}

/* A load that moves from the middle makes turning cheaper: two wheels slide with little on them. */
static void test_load_that_is_shifted_turns_for_less(void)
{
    (void)printf("\non the spot, centre of mass ahead    formula    plant    ratio\n");
    double last = 1e9;
    for (int step = 0; step <= 4; step++) {
        struct skid_steer_model model = zhang;
        model.body.centre_ahead_m = 0.05 * step;
        const struct skid_steady steady = turn_with(&model, 0, 0.4);
        const double foretold = skid_foretold(&zhang, &steady, 0);
        const double for_each = (steady.power - zhang.electronics.power_w) / steady.turn_rate;
        (void)printf("  %.2f m %30.2f %8.2f %8.3f\n", 0.05 * step, foretold, steady.power, steady.power / foretold);
        TEST_ASSERT_TRUE_MESSAGE(for_each < last, "J/rad falls as the load moves from the middle");
        last = for_each;
    }
}

/* Backwards, to the other side, and with the axes turned: the same. */
static void test_costs_are_alike_both_ways(void)
{
    for (unsigned long run = 0; run < options.count / 3; run++) {
        const double speed = random_uniform(&noise, 0, 0.4);
        const double turn = random_uniform(&noise, 0.1, 0.6);
        const struct skid_steady left = turn_with(&zhang, speed, turn);
        const struct skid_steady right = turn_with(&zhang, speed, -turn);
        const struct skid_steady back = turn_with(&zhang, -speed, turn);
        check_near(left.power, right.power, 1e-6 * left.power, "to the right, W");
        check_near(left.power, back.power, 1e-3 * left.power, "backwards, W");
        check_near(left.turn_rate, -right.turn_rate, 1e-9, "to the right, rad/s");
    }
}

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", worst_level, "", at_most(LEVEL_ERROR),
                "skid-steer plant against the paper's formula, straight and level: error of the power, worst of %lu",
                options.count);
    figures_add(figures, "make figures", worst_climb, "", at_most(CLIMB_ERROR),
                "skid-steer plant against the paper's formula, straight up 0 to 15°: error of the power, worst of 12");
    figures_add(
        figures, "make figures", worst_pivot, "", at_most(PIVOT_ERROR),
        "skid-steer plant against the paper's formula, on the spot, even load: error of the scrubbing, worst of "
        "4");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, defaults);

    const int failures = RUN_PROPERTY(options, add_figures);

    (void)printf("of the formula: level within %.3g, uphill %.3g, on the spot with even load %.3g\n", worst_level,
                 worst_climb, worst_pivot);
    return failures;
}
