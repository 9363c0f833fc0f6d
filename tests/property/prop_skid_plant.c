/* The plant of skid steer and differential drive: its energy ledger over random drives on random ground, known motions,
 * and its integrator. */
#include <stdio.h>

#include "sim/base/fingerprint.h"
#include "tests/support/options.h"
#include "tests/support/skid_hills.h"
#include "tests/support/skid_rig.h"
#include "unity.h"

#define TICK SKID_RIG_TICK

/* Of the turnover: 0.1 % would do, but a force that is forgotten may lose less. */
#define LEDGER_ERROR 1e-5

/* Of the place after 10 s, m, against half the step. */
#define STEP_ERROR 1e-4

static const struct options defaults = {.count = 8, .seed = 2018};
static struct options options;
static struct random noise;
static double worst_ledger;
static double worst_step;

static struct skid_steer_model zhang;
static struct skid_steer_model burger;
static struct skid_plant plant;
static struct skid_rig rig;
static struct jp_terrain map;

static const struct skid_input off = {.driven = false};
static const struct skid_input shorted = {.driven = true};

void setUp(void)
{
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/zhang2018.cfg", &zhang));
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/burger.cfg", &burger));
    random_init(&noise, options.seed);
    skid_plant_init(&plant, &zhang, &skid_level, &skid_origin);
}

void tearDown(void)
{
}

static double square(double a)
{
    return a * a;
}

static void drive(const struct skid_input *input, double seconds)
{
    for (int tick = 0; tick < (int)(seconds / TICK + 0.5); tick++) {
        skid_plant_step(&plant, input, TICK);
    }
}

static struct skid_input duties(double left, double right)
{
    return (struct skid_input){.duty = {left, right}, .driven = true};
}

/* On a slope that rises along x, heading so many degrees from it. */
static void stand(const struct skid_steer_model *model, struct skid_slope *slope, double degrees, double heading_deg)
{
    const struct planar_pose pose = {0, 0, heading_deg * M_PI / 180};
    *slope = skid_slope_towards(degrees, 0);
    const struct skid_ground ground = skid_ground_slope(slope);
    skid_plant_init(&plant, model, &ground, &pose);
}

static double weight(void)
{
    return plant.model.body.mass_kg * STANDARD_GRAVITY;
}

/* What moves with the body, kg: wheels and rotors turn. */
static double moving_mass(void)
{
    return plant.model.body.mass_kg + 2 * plant.side_inertia / square(plant.model.wheel.radius_m);
}

/* ---- Energy ledger ---- */

static struct skid_input random_input(void)
{
    return (struct skid_input){
        .duty = {random_uniform(&noise, -1, 1), random_uniform(&noise, -1, 1)},
        .driven = random_uniform(&noise, 0, 1) < 0.8,
    };
}

static double turnover(void)
{
    const struct skid_ledger *l = &plant.state.ledger;

    return fabs(l->battery) + l->copper + l->bridge + l->gear + fabs(l->slip_along) + fabs(l->slip_across) +
           l->rolling + l->caster + l->impact + fabs(skid_plant_potential_energy(&plant));
}

/* What is heat does not come back; what treads and gears are strained by may. */
static void check_losses(const struct skid_ledger *before)
{
    const struct skid_ledger *l = &plant.state.ledger;

    TEST_ASSERT_TRUE_MESSAGE(l->copper >= before->copper, "copper");
    TEST_ASSERT_TRUE_MESSAGE(l->bridge >= before->bridge - 1e-12, "bridge");
    TEST_ASSERT_TRUE_MESSAGE(l->supply >= before->supply, "supply");
    TEST_ASSERT_TRUE_MESSAGE(l->electronics > before->electronics, "electronics");
    TEST_ASSERT_TRUE_MESSAGE(l->impact >= before->impact, "impact");
}

/* Ten seconds of random duties from a random motion. */
static void check_random_drive(const struct skid_steer_model *model, const struct skid_ground *ground)
{
    const struct planar_pose pose = {random_uniform(&noise, 8, 16), random_uniform(&noise, 8, 16),
                                     random_uniform(&noise, -M_PI, M_PI)};
    const double speed = model->limits.speed_m_s;
    struct skid_input input = random_input();

    skid_plant_init(&plant, model, ground, &pose);
    plant.state.forward = random_uniform(&noise, -speed, speed);
    plant.state.left = random_uniform(&noise, -speed / 2, speed / 2);
    plant.state.turn_rate = random_uniform(&noise, -1, 1);
    const double start = skid_plant_kinetic_energy(&plant);
    for (int tick = 0; tick < 5000; tick++) {
        if (tick % 500 == 0) {
            input = random_input();
        }
        const struct skid_ledger before = plant.state.ledger;
        skid_plant_step(&plant, &input, TICK);
        check_losses(&before);
    }
    const double error = fabs(skid_plant_residual(&plant, start)) / turnover();
    worst_ledger = fmax(worst_ledger, error);
    check_below(error, LEDGER_ERROR, "energy lost or won, of the turnover");
    TEST_ASSERT_TRUE_MESSAGE(isfinite(plant.state.x) && isfinite(plant.state.turn_rate), "finite");
}

/* Every fourth ground is steeper than tyres hold. */
static void test_ledger_closes_over_random_drives_on_hills(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const struct skid_hills hills = skid_random_hills(&noise, run % 4 == 0 ? 1.2 : 0.35);
        const struct skid_ground ground = {skid_on_hills, &hills};
        check_random_drive(run % 2 == 0 ? &zhang : &burger, &ground);
    }
}

/* Slopes jump from cell to cell. */
static void test_ledger_closes_over_random_drives_on_maps(void)
{
    for (unsigned long run = 0; run < options.count / 2; run++) {
        const struct skid_hills hills = skid_random_hills(&noise, 0.35);
        skid_make_map(&map, &hills);
        const struct skid_ground ground = skid_ground_map(&map);
        check_random_drive(run % 2 == 0 ? &zhang : &burger, &ground);
    }
}

static struct skid_steer_model random_model(void)
{
    struct skid_steer_model model = random_uniform(&noise, 0, 1) < 0.7 ? zhang : burger;
    const double scale = exp(random_uniform(&noise, -1, 1));

    model.body.mass_kg *= scale;
    model.body.yaw_inertia_kg_m2 *= scale * random_uniform(&noise, 0.7, 1.5);
    model.body.centre_height_m *= random_uniform(&noise, 0, 1.3);
    model.body.centre_ahead_m += random_uniform(&noise, -0.1, 0.1) * model.body.wheelbase_m;
    model.ground.friction = random_uniform(&noise, 0.05, 1.2);
    model.ground.rolling = random_uniform(&noise, 0.002, 0.2);
    model.tyre.stiffness_per_m *= random_uniform(&noise, 0.3, 3);
    model.tyre.damping_s_per_m *= random_uniform(&noise, 0, 5);
    model.tyre.contact_length_m *= random_uniform(&noise, 0.3, 3);
    model.motor.efficiency = random_uniform(&noise, 0.3, 1);
    model.motor.recuperation = random_uniform(&noise, 0, 1);
    model.motor.rotor_inertia_kg_m2 *= random_uniform(&noise, 0.2, 5);
    model.motor.friction_nm = random_uniform(&noise, 0, 0.02) * model.body.mass_kg * model.wheel.radius_m;
    model.supply.resistance_ohm *= random_uniform(&noise, 0, 3);
    if (model.wheel.axles > 1) {
        model.wheel.axles = 2 + (int)random_uniform(&noise, 0, 4);
    }
    return model;
}

static void test_ledger_closes_for_random_robots(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const struct skid_steer_model model = random_model();
        const struct skid_hills hills = skid_random_hills(&noise, 0.4);
        const struct skid_ground ground = {skid_on_hills, &hills};
        check_random_drive(&model, &ground);
    }
}

/* A closed loop over hills brings the potential energy back. */
static void test_potential_energy_is_of_the_place(void)
{
    const struct skid_hills hills = skid_random_hills(&noise, 0.3);
    const struct skid_ground ground = {skid_on_hills, &hills};
    const struct skid_input input = duties(0.5, 0.3);

    skid_plant_init(&plant, &zhang, &ground, &skid_origin);
    drive(&input, 7);
    const struct skid_ground_point here = skid_on_hills(&hills, plant.state.x, plant.state.y);
    const struct skid_ground_point start = skid_on_hills(&hills, 0, 0);
    check_near(weight() * (here.elevation - start.elevation), skid_plant_potential_energy(&plant), 0.04 * weight(),
               "J, but for what four wheels bridge");
}

/* ---- At rest ---- */

static void test_at_rest_it_stays(void)
{
    const struct skid_state start = plant.state;

    drive(&shorted, 5);
    check_near(start.x, plant.state.x, 1e-12, "x");
    check_near(start.heading, plant.state.heading, 1e-12, "heading");
    check_near(5 * zhang.electronics.power_w, plant.state.ledger.electronics, 1e-6, "J of the electronics");
    check_near(0, plant.state.ledger.copper + plant.state.ledger.gear + plant.state.ledger.rolling, 1e-12, "J");
}

/* Way in the last 5 s of 10. */
static double creep(const struct skid_input *input)
{
    drive(input, 5);
    const struct skid_state middle = plant.state;
    drive(input, 5);
    return hypot(plant.state.x - middle.x, plant.state.y - middle.y);
}

/* Rolling resistance holds it up to atan(0.0426), 2.4°; beyond it rolls. */
static void test_with_bridges_off_rolling_resistance_holds_it(void)
{
    struct skid_slope slope;

    for (int degrees = 0; degrees <= 2; degrees++) {
        stand(&zhang, &slope, degrees, 0);
        check_below(creep(&off), 1e-6, "creep where rolling resistance holds, m");
        check_below(hypot(plant.state.x, plant.state.y), 0.006, "way into the treads, m");
    }
    stand(&zhang, &slope, 3, 0);
    TEST_ASSERT_TRUE_MESSAGE(creep(&off) > 1, "it rolls away");
}

/* Nothing turns the wheels across a slope; the treads hold up to atan(0.69), 34.6°. */
static void test_tyres_hold_across_a_slope_without_creep(void)
{
    struct skid_slope slope;

    for (int degrees = 5; degrees <= 30; degrees += 5) {
        stand(&zhang, &slope, degrees, 90);
        check_below(creep(&shorted), 1e-6, "creep across, m");
        TEST_ASSERT_FALSE(plant.tipped);
    }
    stand(&zhang, &slope, 38, 90);
    TEST_ASSERT_TRUE_MESSAGE(creep(&shorted) > 1, "it slides");
}

/* Shorted motors let it down at the speed at which they brake as gravity drives, behind a gear that helps. */
static void test_shorted_motors_creep_down_as_their_torque_says(void)
{
    struct skid_slope slope;

    for (int degrees = 5; degrees <= 15; degrees += 5) {
        stand(&zhang, &slope, degrees, 0);
        drive(&shorted, 10);
        const double angle = degrees * M_PI / 180;
        const double force = weight() * (sin(angle) - zhang.ground.rolling * cos(angle));
        const double torque = force / 2 * zhang.wheel.radius_m * zhang.motor.efficiency;
        const double constant = zhang.motor.torque_constant * zhang.motor.gear_ratio;
        const double rate = torque * zhang.motor.resistance_ohm / square(constant);
        check_near(-rate * zhang.wheel.radius_m, plant.state.forward, 0.05 * rate * zhang.wheel.radius_m, "creep, m/s");
        check_near(-torque / constant, -plant.attitude.current[SKID_LEFT], 0.01 * torque / constant, "A");
        check_near(0, plant.state.ledger.bridge, 1e-9, "J of the bridges");
        check_near(10 * zhang.electronics.power_w, plant.state.ledger.battery, 0.1, "J: shorted motors draw nothing");
    }
}

/* The actuators' gears hold a light robot on 5° with the bridges off. */
static void test_dry_friction_of_the_gears_holds_a_light_robot(void)
{
    struct skid_slope slope;
    struct skid_steer_model stiff = burger;

    stiff.motor.friction_nm = 0.03;
    stand(&stiff, &slope, 8, 0);
    check_below(creep(&off), 1e-6, "creep, m");
    stiff.motor.friction_nm = 0.01;
    stand(&stiff, &slope, 8, 0);
    TEST_ASSERT_TRUE_MESSAGE(creep(&off) > 0.05, "it rolls");
}

/* ---- Rolling and sliding ---- */

static void test_coasting_stops_by_rolling(void)
{
    for (int step = 1; step <= 4; step++) {
        skid_plant_init(&plant, &zhang, &skid_level, &skid_origin);
        const double speed = 0.25 * step;
        plant.state.forward = speed;
        plant.state.sides[SKID_LEFT].rate = plant.state.sides[SKID_RIGHT].rate = speed / zhang.wheel.radius_m;
        const double way = moving_mass() * square(speed) / 2 / (zhang.ground.rolling * weight());
        drive(&off, 20);
        check_near(way, plant.state.x, 0.01 * way + 0.005, "way until it stands, m");
        check_near(0, plant.state.forward, 1e-6, "speed, m/s");
        const double energy = moving_mass() * square(speed) / 2;
        check_near(energy, plant.state.ledger.rolling, 0.005 * energy, "J of rolling");
    }
}

static void test_it_rolls_down_as_its_inertia_says(void)
{
    struct skid_slope slope;

    for (int degrees = 4; degrees <= 14; degrees += 2) {
        stand(&zhang, &slope, degrees, 0);
        const double angle = degrees * M_PI / 180;
        const double force = weight() * (sin(angle) - zhang.ground.rolling * cos(angle));
        const double acceleration = force / moving_mass();
        drive(&off, 1);
        const double before = plant.state.forward;
        drive(&off, 1);
        check_near(-acceleration, plant.state.forward - before, 0.03 * acceleration, "m/s²");
    }
}

/* Across the ground's plane, whatever the heading on it. */
static void test_it_slides_down_too_steep_a_slope(void)
{
    struct skid_slope slope;
    struct skid_steer_model low = zhang;

    low.body.centre_height_m = 0.05;
    for (int heading = 0; heading <= 90; heading += 30) {
        stand(&low, &slope, 45, heading);
        drive(&shorted, 2);
        const double before = hypot(plant.state.forward, plant.state.left);
        drive(&shorted, 1);
        const double gained = hypot(plant.state.forward, plant.state.left) - before;
        const double acceleration = STANDARD_GRAVITY * (sin(M_PI / 4) - zhang.ground.friction * cos(M_PI / 4));
        check_near(acceleration, gained, 0.05 * acceleration, "m/s²");
        TEST_ASSERT_FALSE(plant.tipped);
    }
}

/* Wheels that cannot turn: friction alone stops the body. */
static void test_stuck_wheels_slide_to_a_stop(void)
{
    struct skid_steer_model stuck = zhang;

    stuck.motor.friction_nm = 500;
    for (int step = 0; step < 6; step++) {
        const double direction = step * M_PI / 6;
        skid_plant_init(&plant, &stuck, &skid_level, &skid_origin);
        plant.state.forward = cos(direction);
        plant.state.left = sin(direction);
        drive(&off, 2);
        const double way = 1 / (2 * zhang.ground.friction * STANDARD_GRAVITY);
        check_near(way, hypot(plant.state.x, plant.state.y), 0.1 * way, "way, m");
        const struct skid_ledger *l = &plant.state.ledger;
        check_near(zhang.body.mass_kg / 2, l->slip_along + l->slip_across, 0.02 * zhang.body.mass_kg, "J of slip");
        check_near(zhang.body.mass_kg / 2 * square(cos(direction)), l->slip_along, 0.15 * zhang.body.mass_kg,
                   "J along the wheels");
    }
}

/* Along and across together stay within the circle, whatever the motors do. */
static void test_force_stays_within_the_circle(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        struct skid_steer_model model = zhang;
        model.tyre.damping_s_per_m = random_uniform(&noise, 0, 50);
        skid_plant_init(&plant, &model, &skid_level, &skid_origin);
        plant.state.forward = random_uniform(&noise, -2, 2);
        plant.state.left = random_uniform(&noise, -2, 2);
        struct skid_input input = random_input();
        for (int tick = 0; tick < 1500; tick++) {
            if (tick % 100 == 0) {
                input = random_input();
            }
            skid_plant_step(&plant, &input, TICK);
            check_below(hypot(plant.attitude.force_ahead, plant.attitude.force_left),
                        zhang.ground.friction * STANDARD_GRAVITY * (1 + 1e-9), "specific force, m/s²");
        }
    }
}

/* On the steepest slope that the paper climbs it climbs, and no tyre holds it on one beyond friction. */
static void test_it_climbs_what_it_must(void)
{
    struct skid_slope slope;
    const struct skid_input full = duties(1, 1);

    stand(&zhang, &slope, zhang.limits.slope_deg, 0);
    drive(&full, 10);
    check_near(zhang.limits.speed_m_s, plant.state.forward, 0.1 * zhang.limits.speed_m_s, "m/s up 15°");
    stand(&zhang, &slope, 38, 0);
    drive(&full, 10);
    TEST_ASSERT_TRUE_MESSAGE(plant.state.x < 0 || plant.tipped, "38° are too steep");
}

/* On a slope of ice the body falls along the plane in a parabola, however it turns meanwhile; and what it turns by
 * about the plane's normal is its heading after each whole turn. */
static void test_on_ice_it_falls_in_a_parabola(void)
{
    struct skid_slope slope;
    struct skid_steer_model smooth = zhang;
    const double angle = 20 * M_PI / 180;

    smooth.ground.friction = 0.01;
    smooth.ground.rolling = 0.001;
    smooth.tyre.stiffness_per_m = 20;
    for (int step = 0; step < 6; step++) {
        const double heading = step * M_PI / 3;
        stand(&smooth, &slope, 20, heading * 180 / M_PI);
        plant.state.forward = 1;
        plant.state.turn_rate = 5;
        const double along = hypot(1, tan(angle) * cos(heading));
        double seconds = 0;
        double turned = atan2(sin(heading) * cos(angle), cos(heading)); /* in the plane, from uphill */
        for (; seconds < 1.5; seconds += TICK) {
            const double before = plant.state.turn_rate;
            skid_plant_step(&plant, &off, TICK);
            turned += TICK * (before + plant.state.turn_rate) / 2;
            const double expected = atan2(sin(turned) / cos(angle), cos(turned));
            check_near(0, planar_wrap(plant.state.heading - expected), 1e-4, "heading, rad");
        }
        const double start_x = 1 / along * cos(heading); /* m/s on the map */
        const double start_y = 1 / along * sin(heading);
        const double fall = STANDARD_GRAVITY * sin(angle) * cos(angle); /* m/s² on the map */
        const double friction = smooth.ground.friction * STANDARD_GRAVITY * seconds * seconds / 2;
        check_near(start_x * seconds - fall * seconds * seconds / 2, plant.state.x, 1.2 * friction, "x, m");
        check_near(start_y * seconds, plant.state.y, 1.2 * friction, "y, m");
    }
}

/* ---- Loads ---- */

static void check_loads(double rear_left, double rear_right, double front_left, double front_right)
{
    const double expected[] = {rear_left, rear_right, front_left, front_right};

    for (int i = 0; i < 4; i++) {
        check_near(expected[i], plant.attitude.load[i], 0.02 * weight() / 4, "load of a wheel, N");
    }
}

static void test_loads_follow_slope_and_height(void)
{
    struct skid_slope slope;
    const double quarter = zhang.body.mass_kg * STANDARD_GRAVITY / 4;

    drive(&shorted, 0.5);
    check_loads(quarter, quarter, quarter, quarter);
    for (int degrees = 5; degrees <= 30; degrees += 5) {
        const double angle = degrees * M_PI / 180;
        const double along = quarter * sin(angle) * zhang.body.centre_height_m / zhang.body.wheelbase_m * 2;
        const double across = quarter * sin(angle) * zhang.body.centre_height_m / zhang.body.width_m * 2;
        const double flat = quarter * cos(angle);
        stand(&zhang, &slope, degrees, 90); /* the left side is the lower one */
        drive(&shorted, 3);
        check_loads(flat + across, flat - across, flat + across, flat - across);
        stand(&zhang, &slope, degrees, 180);
        drive(&shorted, 3);
        check_loads(flat - along, flat - along, flat + along, flat + along);
    }
}

static void test_loads_follow_the_acceleration(void)
{
    const struct skid_input full = duties(1, 1);
    const double quarter = zhang.body.mass_kg * STANDARD_GRAVITY / 4;
    double most = 0;

    for (int tick = 0; tick < 500; tick++) {
        skid_plant_step(&plant, &full, TICK);
        const struct skid_attitude *seen = &plant.attitude;
        const double sum = seen->load[0] + seen->load[1] + seen->load[2] + seen->load[3];
        check_near(4 * quarter, sum, 1e-9 * quarter, "N of all");
        most = fmax(most, seen->load[0] - seen->load[2]);
        check_near(seen->load[0], seen->load[1], 1e-9 * quarter, "left and right");
    }
    TEST_ASSERT_TRUE_MESSAGE(most > 0.2 * quarter, "the rear wheels carry more");
}

static void test_caster_carries_its_share(void)
{
    skid_plant_init(&plant, &burger, &skid_level, &skid_origin);
    drive(&shorted, 0.5);
    const double caster = weight() * burger.body.centre_ahead_m / burger.caster.ahead_m;
    check_near(caster, plant.attitude.load[2], 1e-6, "N of the caster");
    check_near((weight() - caster) / 2, plant.attitude.load[0], 1e-6, "N of a wheel");
    check_near((weight() - caster) / 2, plant.attitude.load[1], 1e-6, "N of a wheel");
}

static void test_axles_share_the_load_evenly(void)
{
    for (int axles = 2; axles <= SKID_STEER_AXLES_MAX; axles++) {
        struct skid_steer_model model = zhang;
        model.wheel.axles = axles;
        skid_plant_init(&plant, &model, &skid_level, &skid_origin);
        drive(&shorted, 0.02);
        TEST_ASSERT_EQUAL_INT(2 * axles, plant.contact_count);
        for (int i = 0; i < plant.contact_count; i++) {
            check_near(weight() / (2 * axles), plant.attitude.load[i], 1e-6, "N of a wheel");
        }
        check_near(-model.body.wheelbase_m / 2, plant.contacts[0].place.x, 1e-12, "rear axle, m");
        check_near(model.body.wheelbase_m / 2, plant.contacts[2 * axles - 1].place.x, 1e-12, "front axle, m");
    }
}

/* ---- Tipping ---- */

static void test_tall_robot_tips(void)
{
    struct skid_slope slope;
    struct skid_steer_model tall = zhang;

    tall.body.centre_height_m = 1; /* tips at atan(0.25/1) = 14.0° along, atan(0.35/1) = 19.3° across */
    stand(&tall, &slope, 13.5, 0);
    TEST_ASSERT_FALSE(plant.tipped);
    stand(&tall, &slope, 14.5, 0);
    TEST_ASSERT_TRUE(plant.tipped);
    stand(&tall, &slope, 14.5, 180);
    TEST_ASSERT_TRUE(plant.tipped);
    stand(&tall, &slope, 18.8, 90);
    TEST_ASSERT_FALSE(plant.tipped);
    stand(&tall, &slope, 19.8, -90);
    TEST_ASSERT_TRUE(plant.tipped);
}

static void test_caster_tips_where_it_does_not_reach(void)
{
    struct skid_slope slope;
    const double ahead = -burger.body.centre_ahead_m;

    stand(&burger, &slope, atan(ahead / burger.body.centre_height_m) * 180 / M_PI - 0.5, 180); /* downhill */
    TEST_ASSERT_FALSE(plant.tipped);
    stand(&burger, &slope, atan(ahead / burger.body.centre_height_m) * 180 / M_PI + 0.5, 180);
    TEST_ASSERT_TRUE(plant.tipped);
    const double half = burger.body.width_m / 2 * (1 - ahead / -burger.caster.ahead_m);
    stand(&burger, &slope, atan(half / burger.body.centre_height_m) * 180 / M_PI - 0.5, 90);
    TEST_ASSERT_FALSE(plant.tipped);
    stand(&burger, &slope, atan(half / burger.body.centre_height_m) * 180 / M_PI + 0.5, 90);
    TEST_ASSERT_TRUE(plant.tipped);

    struct skid_steer_model front = burger; /* the same with its caster ahead */
    front.caster.ahead_m = -burger.caster.ahead_m;
    front.body.centre_ahead_m = ahead;
    stand(&front, &slope, atan(ahead / burger.body.centre_height_m) * 180 / M_PI + 0.5, 0);
    TEST_ASSERT_TRUE(plant.tipped);
    stand(&front, &slope, atan(ahead / burger.body.centre_height_m) * 180 / M_PI - 0.5, 0);
    TEST_ASSERT_FALSE(plant.tipped);
}

/* Reversing at full speed throws it on its nose; then it lies, and its motors are off. */
static void test_tipped_robot_lies_still_and_its_ledger_closes(void)
{
    struct skid_steer_model tall = zhang;
    const struct skid_input ahead = duties(1, 1);
    const struct skid_input back = duties(-1, -1);

    tall.body.centre_height_m = 0.9;
    tall.motor.current_limit_a = 60;
    skid_plant_init(&plant, &tall, &skid_level, &skid_origin);
    plant.state.forward = 1;
    plant.state.sides[SKID_LEFT].rate = plant.state.sides[SKID_RIGHT].rate = 1 / tall.wheel.radius_m;
    const double start = skid_plant_kinetic_energy(&plant);
    drive(&ahead, 0.5);
    TEST_ASSERT_FALSE(plant.tipped);
    drive(&back, 1);
    TEST_ASSERT_TRUE(plant.tipped);
    const struct skid_state lying = plant.state;
    drive(&ahead, 1);
    check_near(lying.x, plant.state.x, 0, "x");
    check_near(lying.sides[SKID_LEFT].angle, plant.state.sides[SKID_LEFT].angle, 0, "wheels");
    TEST_ASSERT_TRUE(lying.ledger.impact > 0);
    check_near(lying.ledger.electronics + tall.electronics.power_w, plant.state.ledger.electronics, 1e-6, "J");
    check_near(0, plant.attitude.current[SKID_LEFT], 0, "A");
    check_below(fabs(skid_plant_residual(&plant, start)) / turnover(), 1e-6, "ledger");
}

/* ---- Motors and battery ---- */

static void test_speed_without_load_is_that_of_the_voltage(void)
{
    struct skid_steer_model free = zhang;
    const double constant = zhang.motor.torque_constant * zhang.motor.gear_ratio;

    free.ground.rolling = 0.001;
    free.motor.efficiency = 1;
    skid_plant_init(&plant, &free, &skid_level, &skid_origin);
    for (int step = -4; step <= 4; step++) {
        const struct skid_input input = duties(0.2 * step, 0.2 * step);
        drive(&input, 3);
        check_near(0.2 * step * plant.attitude.bus_voltage / constant, plant.state.sides[SKID_LEFT].rate, 0.02,
                   "rad/s");
    }
}

static void test_current_stays_within_its_limit(void)
{
    double most = 0;

    for (int tick = 0; tick < 2000; tick++) {
        const struct skid_input input = tick / 250 % 2 == 0 ? duties(1, -1) : duties(-1, 1);
        skid_plant_step(&plant, &input, TICK);
        for (int side = 0; side < SKID_SIDES; side++) {
            check_below(fabs(plant.attitude.current[side]), zhang.motor.current_limit_a, "A");
            most = fmax(most, fabs(plant.attitude.current[side]));
        }
    }
    check_near(zhang.motor.current_limit_a, most, 1e-9, "the limit acts");
}

static void test_battery_sags_and_is_charged(void)
{
    struct skid_steer_model weak = zhang;
    struct skid_slope slope;
    const struct skid_input hold = duties(0.4, 0.4);

    weak.supply.resistance_ohm = 0.5;
    skid_plant_init(&plant, &weak, &skid_level, &skid_origin);
    drive(&hold, 0.1);
    TEST_ASSERT_TRUE_MESSAGE(plant.attitude.bus_voltage < weak.supply.voltage_v - 1, "sags while it starts");

    weak.motor.recuperation = 1;
    weak.electronics.power_w = 1;
    stand(&weak, &slope, -12, 0);
    drive(&hold, 5);
    const double before = plant.state.ledger.battery;
    drive(&hold, 1);
    TEST_ASSERT_TRUE_MESSAGE(plant.state.ledger.battery < before, "charged downhill");
    TEST_ASSERT_TRUE_MESSAGE(plant.attitude.bus_voltage > weak.supply.voltage_v, "above its open voltage");
    check_near(0, plant.state.ledger.bridge, 1e-9, "nothing is burnt");
}

static void test_bridges_burn_what_they_do_not_return(void)
{
    struct skid_slope slope;
    const struct skid_input hold = duties(0.4, 0.4);
    double last = 1e9;

    for (int step = 0; step <= 4; step++) {
        struct skid_steer_model model = zhang;
        model.motor.recuperation = 0.25 * step;
        stand(&model, &slope, -12, 0);
        drive(&hold, 5);
        const struct skid_ledger before = plant.state.ledger;
        drive(&hold, 2);
        const double drawn = plant.state.ledger.battery - before.battery;
        TEST_ASSERT_TRUE_MESSAGE(drawn < last, "the more comes back, the less is drawn");
        TEST_ASSERT_TRUE_MESSAGE(step > 0 || fabs(drawn - 2 * model.electronics.power_w) < 0.1,
                                 "without recuperation the electronics draw alone");
        last = drawn;
    }
}

/* ---- Turning ---- */

static void test_wheels_turn_it_the_right_way(void)
{
    const struct skid_input left = duties(-0.3, 0.3);
    const struct skid_input bend = duties(0.3, 0.5);

    drive(&left, 3);
    TEST_ASSERT_TRUE(plant.state.turn_rate > 0.1 && plant.state.heading > 0.3);
    check_near(0, hypot(plant.state.x, plant.state.y), 1e-9, "on the spot, m");
    skid_plant_init(&plant, &zhang, &skid_level, &skid_origin);
    drive(&bend, 3);
    TEST_ASSERT_TRUE(plant.state.y > 0.1 && plant.state.heading > 0.1);
}

/* In a bend the ground pushes the centre of mass towards the middle. */
static void test_bend_needs_its_centripetal_force(void)
{
    skid_rig_start(&rig, &burger, &skid_level, 0);
    skid_rig_drive(&rig, 0.08, 0.14, 4);
    const struct skid_state *state = &rig.plant.state;
    const double speed = hypot(state->forward, state->left);
    const double towards =
        rig.plant.attitude.force_left * state->forward / speed - rig.plant.attitude.force_ahead * state->left / speed;
    check_near(speed * state->turn_rate, towards, 0.01 * fabs(towards), "m/s²");
}

static void test_middle_of_the_axle_is_what_the_pose_says(void)
{
    const struct planar_pose pose = {3, -2, 1};
    skid_plant_init(&plant, &burger, &skid_level, &pose);
    const struct planar_pose start = skid_plant_pose(&plant);
    check_near(pose.x, start.x, 1e-12, "x");
    check_near(pose.y, start.y, 1e-12, "y");
    check_near(pose.x + burger.body.centre_ahead_m * cos(1), plant.state.x, 1e-12, "x of the centre of mass");
    const struct skid_input spin = duties(-0.4, 0.4);
    drive(&spin, 8);
    const struct planar_pose end = skid_plant_pose(&plant);
    check_near(0, hypot(end.x - pose.x, end.y - pose.y), 0.003, "the axle turns on the spot, m");
}

/* ---- Symmetry ---- */

static void test_left_and_right_mirror(void)
{
    for (int kind = 0; kind < 2; kind++) {
        const struct skid_steer_model *model = kind == 0 ? &zhang : &burger;
        const struct skid_input bend = duties(0.2, 0.5);
        const struct skid_input other = duties(0.5, 0.2);
        skid_plant_init(&plant, model, &skid_level, &skid_origin);
        drive(&bend, 5);
        const struct skid_state state = plant.state;
        skid_plant_init(&plant, model, &skid_level, &skid_origin);
        drive(&other, 5);
        check_near(state.x, plant.state.x, 1e-9, "x");
        check_near(-state.y, plant.state.y, 1e-9, "y");
        check_near(-state.heading, plant.state.heading, 1e-9, "heading");
        check_near(state.ledger.battery, plant.state.ledger.battery, 1e-6, "battery, J");
    }
}

/* Place and heading of the start change nothing but place and heading, on a slope turned with them. */
static void test_motion_is_the_same_everywhere(void)
{
    const struct planar_pose start = {12, -7, 2.5};
    const struct skid_slope slope = skid_slope_towards(8, 0.3);
    const struct skid_slope turned = skid_slope_towards(8, 0.3 + start.heading);
    const struct skid_ground ground = skid_ground_slope(&slope);
    const struct skid_ground turned_ground = skid_ground_slope(&turned);
    const struct skid_input bend = duties(0.5, 0.4);

    skid_plant_init(&plant, &zhang, &ground, &skid_origin);
    drive(&bend, 5);
    const struct planar_pose end = skid_plant_pose(&plant);
    const struct planar_pose expected = planar_compose(&start, &end);
    skid_plant_init(&plant, &zhang, &turned_ground, &start);
    drive(&bend, 5);
    const struct planar_pose found = skid_plant_pose(&plant);
    check_near(expected.x, found.x, 1e-7, "x");
    check_near(expected.y, found.y, 1e-7, "y");
    check_near(0, planar_wrap(expected.heading - found.heading), 1e-7, "heading");
}

/* ---- Attitude ---- */

static void test_slopes_pitch_and_roll_the_body(void)
{
    struct skid_slope slope;
    const double rise = tan(10 * M_PI / 180);

    stand(&zhang, &slope, 10, 0);
    check_near(rise, plant.attitude.rise_ahead, 1e-12, "uphill");
    check_near(0, plant.attitude.rise_across, 1e-12, "uphill");
    stand(&zhang, &slope, 10, 90);
    check_near(0, plant.attitude.rise_ahead, 1e-12, "across");
    check_near(-rise, plant.attitude.rise_across, 1e-12, "across: the left side is lower");
    stand(&zhang, &slope, 10, 180);
    check_near(-rise, plant.attitude.rise_ahead, 1e-12, "downhill");
    check_near(cos(10 * M_PI / 180), plant.attitude.normal[2], 1e-12, "normal");
    check_near(-sin(10 * M_PI / 180), plant.attitude.normal[0], 1e-12, "normal");
}

/* A plane does not turn the body out of itself, whatever the heading does; hills do, by what their slope changes. */
static void test_tilt_rates_are_those_of_the_ground(void)
{
    struct skid_slope slope;
    const struct skid_input spin = duties(-0.4, 0.5);

    stand(&zhang, &slope, 10, 40);
    for (int tick = 0; tick < 1000; tick++) {
        skid_plant_step(&plant, &spin, TICK);
        check_below(hypot(plant.attitude.roll_rate, plant.attitude.pitch_rate), 1e-6, "rad/s on a plane");
    }
    const struct skid_hills wave = {.height = {0.2}, .along_x = {1}};
    const struct skid_ground ground = {skid_on_hills, &wave};
    const struct skid_input ahead = duties(0.5, 0.5);
    double turned = 0;
    skid_plant_init(&plant, &zhang, &ground, &skid_origin);
    const double pitch = atan(plant.attitude.rise_ahead);
    for (int tick = 0; tick < 2000; tick++) {
        skid_plant_step(&plant, &ahead, TICK);
        turned += TICK * plant.attitude.pitch_rate;
        check_near(0, plant.attitude.roll_rate, 1e-9, "roll, rad/s");
    }
    check_near(pitch - atan(plant.attitude.rise_ahead), turned, 0.01, "pitch, rad, forward positive");
}

/* ---- Integrator ---- */

/* A drive over hills with bends, jumps of the duties and slip. */
static void drive_with_step(double step)
{
    static const struct skid_hills hills = {.height = {0.1, 0.05}, .along_x = {0.76, -0.17}, .along_y = {0.24, 1.29}};
    const struct skid_ground ground = {skid_on_hills, &hills};

    skid_plant_init(&plant, &zhang, &ground, &skid_origin);
    plant.step = step;
    for (int part = 0; part < 5; part++) {
        const struct skid_input input = duties(0.2 + 0.1 * part, 0.7 - 0.15 * part);
        drive(&input, 2);
    }
}

/* A brake with kinks where slip begins and wheels turn round: halving the step must bring it closer. */
static void test_halving_the_step_changes_little(void)
{
    drive_with_step(SKID_STEP / 8);
    const struct skid_state exact = plant.state;
    double last = 1;
    for (int halvings = 0; halvings < 3; halvings++) {
        drive_with_step(SKID_STEP / (1 << halvings));
        const double error = hypot(plant.state.x - exact.x, plant.state.y - exact.y);
        const double battery = fabs(plant.state.ledger.battery / exact.ledger.battery - 1);
        (void)printf("step %.4g ms: place off by %.3g m, battery by %.3g\n", 1e3 * SKID_STEP / (1 << halvings), error,
                     battery);
        check_below(error, halvings == 0 ? STEP_ERROR : last, "place, m");
        check_below(battery, 1e-4, "battery, of its energy");
        worst_step = fmax(worst_step, error);
        last = error;
    }
}

static void test_step_is_short_enough_for_each_robot(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const struct skid_steer_model model = random_model();
        skid_plant_init(&plant, &model, &skid_level, &skid_origin);
        check_below(plant.step * skid_plant_rate(&model), SKID_STEP_RATE_MAX * (1 + 1e-12), "rate of a step");
        check_below(plant.step, SKID_STEP, "step, s");
    }
}

static uint64_t fingerprint_of_a_drive(void)
{
    uint64_t fingerprint = FINGERPRINT_START;

    drive_with_step(SKID_STEP);
    fingerprint_add(&fingerprint, &plant.state, offsetof(struct skid_state, treads));
    fingerprint_add(&fingerprint, plant.attitude.current, sizeof plant.attitude.current);
    return fingerprint;
}

static void test_runs_repeat_bit_for_bit(void)
{
    const uint64_t first = fingerprint_of_a_drive();
    const struct skid_input other = duties(0.9, -0.3);

    drive(&other, 1);
    TEST_ASSERT_TRUE(first == fingerprint_of_a_drive());
    zhang.body.mass_kg *= 1 + 1e-12;
    TEST_ASSERT_TRUE(first != fingerprint_of_a_drive());
}

/* A copy goes on as its original does. */
static void test_copies_go_on_alike(void)
{
    const struct skid_input bend = duties(0.6, 0.3);

    drive(&bend, 1);
    struct skid_plant copy = plant;
    drive(&bend, 1);
    for (int tick = 0; tick < (int)(1 / TICK + 0.5); tick++) {
        skid_plant_step(&copy, &bend, TICK);
    }
    TEST_ASSERT_EQUAL_MEMORY(&copy.state, &plant.state, offsetof(struct skid_state, treads));
}

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", worst_ledger, "", at_most(LEDGER_ERROR),
                "plant of skid steer and differential drive: energy that its ledger misses, of the turnover, worst of "
                "%lu drives",
                options.count * 5 / 2);
    figures_add(figures, "make figures", worst_step, "m", at_most(STEP_ERROR),
                "plant of skid steer: place after 10 s over hills, against an eighth of the step");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, defaults);

    const int failures = RUN_PROPERTY(options, add_figures);

    (void)printf("ledger misses at most %.3g of the turnover\n", worst_ledger);
    return failures;
}
