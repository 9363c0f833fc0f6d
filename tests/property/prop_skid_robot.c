/* The robot kind of skid steer and differential drive in closed loop with the plant: it follows speeds and turn rates,
 * stands, stops within the stated distance, keeps the motors' currents within their limit, names what is wrong and does
 * not move without a command; the robots of the project, and random ones that their designer has not seen. */
#include <stdio.h>

#include "sim/balancer/fault_names.h"
#include "tests/support/check.h"
#include "tests/support/options.h"
#include "tests/support/skid_drive.h"
#include "tests/support/skid_hills.h"
#include "tests/support/skid_robot_design.h"
#include "unity.h"

static const struct options defaults = {.count = 10, .seed = 2018};
static struct options options;
static struct random noise;

struct kind {
    struct skid_steer_model model;
    struct jp_skid_robot_config config;
};

enum { ZHANG, BURGER, KINDS };

static struct kind kinds[KINDS];
static struct skid_drive drive;

static const struct planar_pose origin = {0, 0, 0};
static const struct skid_ground level = {NULL, NULL};

static void load(struct kind *kind, const char *path, const struct jp_skid_robot_config *config)
{
    TEST_ASSERT_TRUE(skid_robot_load(path, &kind->model));
    kind->config = *config;
}

void setUp(void)
{
    load(&kinds[ZHANG], "sim/robots/zhang2018.cfg", &jp_skid_robot_zhang2018);
    load(&kinds[BURGER], "sim/robots/burger.cfg", &jp_skid_robot_burger);
    random_init(&noise, options.seed);
}

void tearDown(void)
{
}

static double uniform(double low, double high)
{
    return random_uniform(&noise, low, high);
}

static double radians(double degrees)
{
    return degrees * M_PI / 180;
}

/* ---- Grounds ---- */

struct place {
    struct skid_slope slope;
    struct skid_hills hills;
    struct skid_ground ground;
    double heading;
};

static void make_slope(struct place *place, double degrees, double heading)
{
    place->slope = skid_slope_towards(degrees, 0);
    place->ground = skid_ground_slope(&place->slope);
    place->heading = heading;
}

static void make_hills(struct place *place, double steepest_degrees)
{
    place->hills = skid_random_hills(&noise, tan(radians(steepest_degrees)));
    place->ground = (struct skid_ground){skid_on_hills, &place->hills};
    place->heading = uniform(-M_PI, M_PI);
}

/* Level, a slope in any direction, hills. */
static void make_place(struct place *place, const struct skid_steer_model *model, unsigned long number)
{
    if (number % 3 == 0) {
        make_slope(place, 0, 0);
    } else if (number % 3 == 1) {
        make_slope(place, uniform(0, model->limits.slope_deg), uniform(-M_PI, M_PI));
    } else {
        make_hills(place, model->limits.slope_deg);
    }
}

static void start_at(const struct kind *kind, const struct place *place)
{
    const struct planar_pose pose = {uniform(-5, 5), uniform(-5, 5), place->heading};

    skid_drive_start(&drive, &kind->model, &kind->config, &place->ground, &pose, (uint64_t)uniform(1, 1e9));
    skid_drive_enable(&drive);
}

/* ---- Tracking ---- */

struct errors {
    double sum;
    double worst;
    unsigned long count;
};

static void add(struct errors *errors, double error)
{
    errors->sum += fabs(error);
    errors->worst = fmax(errors->worst, fabs(error));
    errors->count++;
}

static double mean_of(const struct errors *errors)
{
    return errors->count == 0 ? 0 : errors->sum / (double)errors->count;
}

/* What the figures tell. */
static struct {
    struct errors speed;     /* of the lattice's speed */
    struct errors turn_rate; /* of the lattice's turn rate */
    double standing;         /* m in 10 s */
    double stopping;         /* of the stated distance */
    double current;          /* of the limit */
    double named;            /* s */
    double fault_stop;       /* of the stated distance */
} found[KINDS];

/* A motion within the lattice's that the robot takes. */
static void command_any(const struct kind *kind, double seconds, double *speed, double *turn_rate)
{
    *speed = uniform(-1, 1) * kind->model.lattice.speed_m_s;
    *turn_rate = uniform(-1, 1) * kind->model.lattice.turn_rate_rad_s;
    while (skid_drive_command(&drive, *speed, *turn_rate, seconds) == JP_ERR_INFEASIBLE) {
        *speed *= 0.9;
        *turn_rate *= 0.9;
    }
    skid_drive_tick(&drive);
    TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_DRIVING, skid_drive_state(&drive));
}

static void expect_no_fault(void)
{
    char names[FAULTS_NAME_SIZE];
    const uint16_t faults = skid_drive_telemetry(&drive).faults;

    faults_name(faults, names);
    TEST_ASSERT_EQUAL_HEX16_MESSAGE(0, faults, names);
    TEST_ASSERT_FALSE_MESSAGE(drive.world.plant.tipped, "tipped");
}

/* Mean of the last half of a command of 6 s. */
static void follow_one(int which)
{
    const struct kind *kind = &kinds[which];
    double speed;
    double turn_rate;
    double forward = 0;
    double turning = 0;
    command_any(kind, 6, &speed, &turn_rate);
    skid_drive_for(&drive, 3);
    const int ticks = skid_drive_ticks(&drive, 2.9);
    for (int i = 0; i < ticks; i++) {
        skid_drive_tick(&drive);
        forward += drive.world.plant.state.forward / ticks;
        turning += drive.world.plant.state.turn_rate / ticks;
    }
    if (options.verbose) {
        printf("%s: %.3f m/s is %.3f, %.3f rad/s is %.3f, ratio %.3f, rise %.3f\n", kind->config.name, speed, forward,
               turn_rate, turning, drive.robot.internal.odometry.steering_ratio / 16777216.0,
               drive.robot.internal.wheels.rise / 16777216.0);
    }
    expect_no_fault();
    add(&found[which].speed, (forward - speed) / kind->model.lattice.speed_m_s);
    add(&found[which].turn_rate, (turning - turn_rate) / kind->model.lattice.turn_rate_rad_s);
}

static void test_follows_speed_and_turn_rate(void)
{
    for (int which = 0; which < KINDS; which++) {
        found[which].speed = (struct errors){0};
        found[which].turn_rate = (struct errors){0};
        for (unsigned long run = 0; run < options.count; run++) {
            struct place place;
            make_place(&place, &kinds[which].model, run);
            start_at(&kinds[which], &place);
            for (int i = 0; i < 6; i++) {
                follow_one(which);
            }
            TEST_ASSERT_TRUE(drive.greatest_current <= kinds[which].model.motor.current_limit_a);
        }
        printf("%s: off by %.2f %% of the lattice's speed, worst %.2f %%; by %.2f %% of its turn rate, worst %.2f %%\n",
               kinds[which].config.name, 100 * mean_of(&found[which].speed), 100 * found[which].speed.worst,
               100 * mean_of(&found[which].turn_rate), 100 * found[which].turn_rate.worst);
        check_below(mean_of(&found[which].speed), 0.02, "mean error of the speed");
        check_below(mean_of(&found[which].turn_rate), 0.02, "mean error of the turn rate");
    }
}

/* ---- Standing and stopping ---- */

static void start_on_slope(const struct kind *kind, double degrees, double heading)
{
    static struct place place;

    make_slope(&place, degrees, heading);
    start_at(kind, &place);
}

/* On its steepest slope, in any direction, for 10 s. */
static void test_stands_on_its_steepest_slope(void)
{
    for (int which = 0; which < KINDS; which++) {
        const struct kind *kind = &kinds[which];
        double worst = 0;
        for (unsigned long run = 0; run < options.count; run++) {
            start_on_slope(kind, kind->model.limits.slope_deg, run < 2 ? (double)run * M_PI : uniform(-M_PI, M_PI));
            const struct planar_pose before = skid_plant_pose(&drive.world.plant);
            skid_drive_for(&drive, 10);
            const struct planar_pose after = skid_plant_pose(&drive.world.plant);
            expect_no_fault();
            worst = fmax(worst, skid_drive_way(&before, &after));
        }
        printf("%s: moves by %.3g mm in 10 s of standing at worst\n", kind->config.name, 1000 * worst);
        found[which].standing = worst;
        check_below(worst, 0.001, "m in 10 s");
    }
}

/* With what the treads give. */
static double stated_distance(const struct kind *kind, double speed)
{
    return jp_skid_robot_stopping_distance(&kind->config, Q24_OF(speed)) / 16777216.0 +
           kind->model.ground.friction / kind->model.tyre.stiffness_per_m;
}

/* From a random speed on any ground, at the end of a command or on request: stands within the stated distance. */
static void test_stops_within_the_stated_distance(void)
{
    for (int which = 0; which < KINDS; which++) {
        const struct kind *kind = &kinds[which];
        double worst = 0;
        for (unsigned long run = 0; run < options.count; run++) {
            struct place place;
            make_place(&place, &kind->model, run);
            start_at(kind, &place);
            const double speed = uniform(-1, 1) * kind->model.lattice.speed_m_s;
            TEST_ASSERT_EQUAL_INT(JP_OK, skid_drive_command(&drive, speed, 0, 3));
            skid_drive_for(&drive, run % 2 == 0 ? 3 : 2.5);
            const struct planar_pose before = skid_plant_pose(&drive.world.plant);
            if (run % 2 != 0) {
                jp_skid_robot_stop(&drive.robot);
            }
            skid_drive_for(&drive, 2);
            TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_STANDING, skid_drive_state(&drive));
            const struct planar_pose after = skid_plant_pose(&drive.world.plant);
            worst = fmax(worst, skid_drive_way(&before, &after) / stated_distance(kind, speed));
        }
        printf("%s: stops within %.3f of the stated distance at worst\n", kind->config.name, worst);
        found[which].stopping = worst;
        check_below(worst, 1, "of the stated distance");
    }
}

/* Reversals as fast as the limits permit, on the steepest slope. */
static void test_currents_stay_within_their_limit(void)
{
    for (int which = 0; which < KINDS; which++) {
        const struct kind *kind = &kinds[which];
        double worst = 0;
        for (unsigned long run = 0; run < options.count; run++) {
            start_on_slope(kind, kind->model.limits.slope_deg, uniform(-M_PI, M_PI));
            for (int i = 0; i < 6; i++) {
                double speed;
                double turn_rate;
                command_any(kind, 2, &speed, &turn_rate);
                skid_drive_for(&drive, uniform(0.1, 1));
            }
            expect_no_fault();
            worst = fmax(worst, drive.greatest_current);
        }
        printf("%s: takes %.3g A at most, of %.3g\n", kind->config.name, worst, kind->model.motor.current_limit_a);
        found[which].current = worst / kind->model.motor.current_limit_a;
        check_below(worst, kind->model.motor.current_limit_a, "A");
    }
}

/* With twice what the motor can do. */
static void jam(int side)
{
    const struct skid_steer_model *model = &drive.world.plant.model;

    drive.world.plant.jam[side] =
        2 * model->motor.torque_constant * model->motor.gear_ratio * model->motor.current_limit_a;
}

/* A jammed side at full command: the controller itself keeps the current below the bridges' limit. */
static void test_current_of_a_jammed_side_is_limited(void)
{
    for (int which = 0; which < KINDS; which++) {
        const struct kind *kind = &kinds[which];
        start_on_slope(kind, 0, 0);
        jam(SKID_LEFT);
        TEST_ASSERT_EQUAL_INT(JP_OK, skid_drive_command(&drive, kind->model.lattice.speed_m_s, 0, 5));
        skid_drive_for(&drive, 0.4);
        check_below(drive.greatest_current, 0.98 * kind->model.motor.current_limit_a, "A");
    }
}

/* ---- Nothing moves by itself ---- */

static double moved(const struct planar_pose *before)
{
    const struct planar_pose now = skid_plant_pose(&drive.world.plant);

    return skid_drive_way(before, &now);
}

static void test_level_ground_moves_nothing_without_a_command(void)
{
    for (int which = 0; which < KINDS; which++) {
        const struct kind *kind = &kinds[which];
        for (unsigned long run = 0; run < options.count; run++) {
            skid_drive_start(&drive, &kind->model, &kind->config, &level, &origin, run + 1);
            for (int i = 0; i < 10; i++) {
                const double chance = uniform(0, 3);
                if (chance < 1) {
                    (void)jp_skid_robot_enable(&drive.robot);
                } else if (chance < 2) {
                    jp_skid_robot_disable(&drive.robot);
                } else {
                    jp_skid_robot_stop(&drive.robot);
                }
                skid_drive_for(&drive, uniform(0.01, 0.5));
            }
            check_below(moved(&origin), 0.0005, "m without a command");
        }
    }
}

/* Of shorted motors on the steepest slope, m/s. */
static double stated_creep(const struct kind *kind)
{
    const struct skid_steer_model *model = &kind->model;
    const double constant = model->motor.torque_constant * model->motor.gear_ratio;
    const double force = model->body.mass_kg * STANDARD_GRAVITY * sin(radians(model->limits.slope_deg));

    return model->motor.resistance_ohm * force * pow(model->wheel.radius_m / constant, 2) / 2;
}

/* Idle on its steepest slope: the shorted motors let it creep no faster than the header says. */
static void test_idle_creeps_as_stated(void)
{
    for (int which = 0; which < KINDS; which++) {
        const struct kind *kind = &kinds[which];
        const struct skid_steer_model *model = &kind->model;
        const double stated = stated_creep(kind);
        static struct place place;
        make_slope(&place, model->limits.slope_deg, 0);
        skid_drive_start(&drive, model, &kind->config, &place.ground, &origin, 1);
        skid_drive_for(&drive, 5);
        TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_IDLE, skid_drive_state(&drive));
        printf("%s: creeps at %.3g mm/s, stated %.3g\n", kind->config.name, -1000 * skid_drive_speed(&drive),
               1000 * stated);
        check_below(fabs(skid_drive_speed(&drive)), stated, "m/s");
    }
}

/* A reset of the controller in motion. */
static void test_a_reset_in_motion_brakes(void)
{
    for (int which = 0; which < KINDS; which++) {
        const struct kind *kind = &kinds[which];
        double worst = 0;
        for (unsigned long run = 0; run < options.count; run++) {
            const double speed = uniform(-1, 1) * kind->model.lattice.speed_m_s;
            const char *field = "";
            start_on_slope(kind, kind->model.limits.slope_deg / 2, uniform(-M_PI, M_PI));
            TEST_ASSERT_EQUAL_INT(JP_OK, skid_drive_command(&drive, speed, 0, 3));
            skid_drive_for(&drive, 2);
            const struct planar_pose before = skid_plant_pose(&drive.world.plant);
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_init(&drive.robot, &kind->config, &field));
            skid_drive_for(&drive, 1);
            TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_IDLE, skid_drive_state(&drive));
            TEST_ASSERT_FALSE(drive.world.plant.tipped);
            const double waking = (JP_SKID_WAKE_TICKS + 2) * skid_world_tick_seconds(&drive.world);
            const double pulled = STANDARD_GRAVITY * sin(radians(kind->model.limits.slope_deg / 2)) * waking;
            const double creeping = 0.03;
            const double most =
                stated_distance(kind, fabs(speed) + pulled) + waking * (fabs(speed) + pulled) + creeping;
            worst = fmax(worst, moved(&before) / most);
        }
        printf("%s: after a reset in motion it stands within %.3f of the stated distance at worst\n", kind->config.name,
               worst);
        check_below(worst, 1, "of the stated distance");
    }
}

/* ---- Faults ---- */

static unsigned long disturbed_ticks;

static void imu_beyond_range(struct jp_sensors *sensors)
{
    sensors->yaw_rate = INT32_MAX;
}

static void imu_jumps(struct jp_sensors *sensors)
{
    sensors->pitch_rate += (disturbed_ticks++ & 1U) == 0 ? JP_Q24(0.6) : JP_Q24(-0.6);
}

static void imu_freezes(struct jp_sensors *sensors)
{
    sensors->accel_x = JP_Q24(0.01);
}

static void left_encoder_jumps(struct jp_sensors *sensors)
{
    sensors->encoder_left += 0x10000000U * (uint32_t)disturbed_ticks++;
}

static uint32_t stuck_at[JP_SKID_SIDES];

static void left_encoder_sticks(struct jp_sensors *sensors)
{
    if (disturbed_ticks++ == 0) {
        stuck_at[JP_SKID_LEFT] = sensors->encoder_left;
    }
    sensors->encoder_left = stuck_at[JP_SKID_LEFT];
}

static void right_encoder_sticks(struct jp_sensors *sensors)
{
    if (disturbed_ticks++ == 0) {
        stuck_at[JP_SKID_RIGHT] = sensors->encoder_right;
    }
    sensors->encoder_right = stuck_at[JP_SKID_RIGHT];
}

static void current_beyond_range(struct jp_sensors *sensors)
{
    sensors->current_right = INT32_MIN;
}

static void bus_breaks_down(struct jp_sensors *sensors)
{
    sensors->bus_voltage = JP_Q16(2);
}

static void bus_is_too_high(struct jp_sensors *sensors)
{
    sensors->bus_voltage = 2 * sensors->bus_voltage;
}

static void fail_to_read(void)
{
    drive.disturbance.read = JP_ERR_HARDWARE;
}

static void fail_to_write(void)
{
    drive.disturbance.write = JP_ERR_HARDWARE;
}

static void jam_left(void)
{
    jam(SKID_LEFT);
}

static void jam_right(void)
{
    jam(SKID_RIGHT);
}

static void lift(int side)
{
    for (int i = 0; i < drive.world.plant.contact_count; i++) {
        if (drive.world.plant.contacts[i].side == side) {
            drive.world.plant.contacts[i].lifted = true;
        }
    }
}

static void lift_left(void)
{
    lift(SKID_LEFT);
}

static void lift_right(void)
{
    lift(SKID_RIGHT);
}

/* Ice under all wheels, when the robot shall turn the other way. */
static void lose_grip(void)
{
    const double turn_rate = -drive.world.plant.model.lattice.turn_rate_rad_s;

    TEST_ASSERT_EQUAL_INT(JP_OK, skid_drive_command(&drive, 0, turn_rate, 100));
    drive.world.plant.step /= 20; /* treads that slide so easily are stiff equations */
    for (int i = 0; i < drive.world.plant.contact_count; i++) {
        drive.world.plant.contacts[i].friction = 0.005;
    }
}

struct fault_case {
    const char *name;
    uint16_t expected; /* any of them */
    void (*sensors)(struct jp_sensors *sensors);
    void (*happen)(void);
    double speed; /* of the lattice's */
    double turn_rate;
    bool holds; /* afterwards the place is held */
    bool rolls; /* bridges that are off brake nothing */
};

static const struct fault_case fault_cases[] = {
    {"IMU beyond its range", JP_FAULT_IMU_RANGE | JP_FAULT_IMU_JUMP, imu_beyond_range, NULL, 1, 0, true, false},
    {"IMU jumps", JP_FAULT_IMU_JUMP | JP_FAULT_IMU_RANGE, imu_jumps, NULL, 1, 0, true, false},
    {"IMU freezes", JP_FAULT_IMU_FROZEN, imu_freezes, NULL, 1, 0, true, false},
    {"left encoder jumps", JP_FAULT_ENCODER_JUMP, left_encoder_jumps, NULL, 1, 0, false, false},
    {"left encoder sticks", JP_FAULT_ENCODER_LEFT, left_encoder_sticks, NULL, 1, 0, false, false},
    {"right encoder sticks", JP_FAULT_ENCODER_RIGHT, right_encoder_sticks, NULL, 1, 0, false, false},
    {"current beyond its range", JP_FAULT_CURRENT_RANGE, current_beyond_range, NULL, 1, 0, false, false},
    {"bus voltage breaks down", JP_FAULT_BUS_VOLTAGE, bus_breaks_down, NULL, 1, 0, false, false},
    {"bus voltage too high", JP_FAULT_BUS_VOLTAGE, bus_is_too_high, NULL, 1, 0, false, false},
    {"sensors do not answer", JP_FAULT_HARDWARE, NULL, fail_to_read, 1, 0, false, false},
    {"bridges do not answer", JP_FAULT_HARDWARE, NULL, fail_to_write, 1, 0, false, true},
    {"left side jams", JP_FAULT_STALLED_LEFT, NULL, jam_left, 1, 0, true, false},
    {"right side jams", JP_FAULT_STALLED_RIGHT, NULL, jam_right, -1, 0, true, false},
    {"left side jams in a turn", JP_FAULT_STALLED_LEFT, NULL, jam_left, 0, 1, true, false},
    {"ice under a turn on the spot", JP_FAULT_WHEELS_SPIN, NULL, lose_grip, 0, 1, true, false},
};

/* A wheel in the air shows by its current where the ground takes more than the gear, otherwise by the turn. */
static const struct fault_case air_cases[] = {
    {"left side in the air", JP_FAULT_WHEEL_IN_AIR | JP_FAULT_WHEELS_SPIN, NULL, lift_left, 1, 0, true, false},
    {"right side in the air", JP_FAULT_WHEEL_IN_AIR | JP_FAULT_WHEELS_SPIN, NULL, lift_right, 1, 0, true, false},
};

#define FAULT_CASES (sizeof fault_cases / sizeof fault_cases[0])
#define AIR_CASES   (sizeof air_cases / sizeof air_cases[0])

struct fault_result {
    bool thrown;    /* a wheel that jammed at speed threw the robot over before anything could be done */
    double seconds; /* until it is named */
    double way;     /* from then to the stand, of the stated distance */
};

static bool is_jam(const struct fault_case *fault_case)
{
    return fault_case->happen == jam_left || fault_case->happen == jam_right;
}

static struct fault_result meet_fault(const struct kind *kind, const struct fault_case *fault_case)
{
    const double speed = fault_case->speed * kind->model.lattice.speed_m_s;
    const double turn_rate = fault_case->turn_rate * kind->model.lattice.turn_rate_rad_s;
    struct fault_result result = {0};
    char what[FAULTS_NAME_SIZE + 128];
    char names[FAULTS_NAME_SIZE];

    TEST_ASSERT_EQUAL_INT_MESSAGE(JP_OK, skid_drive_command(&drive, speed, turn_rate, 100), fault_case->name);
    skid_drive_for(&drive, 2.5);
    expect_no_fault();
    disturbed_ticks = 0;
    drive.disturbance.sensors = fault_case->sensors;
    if (fault_case->happen != NULL) {
        fault_case->happen();
    }
    const uint64_t tick = drive.world.tick;
    for (int i = skid_drive_ticks(&drive, 5); i > 0 && skid_drive_state(&drive) != JP_SKID_ROBOT_FAULT; i--) {
        skid_drive_tick(&drive);
    }
    result.seconds = (double)(drive.world.tick - tick) * skid_world_tick_seconds(&drive.world);
    faults_name(skid_drive_telemetry(&drive).faults, names);
    (void)snprintf(what, sizeof what, "%s, %s: named %s", kind->config.name, fault_case->name, names);
    TEST_ASSERT_EQUAL_INT_MESSAGE(JP_SKID_ROBOT_FAULT, skid_drive_state(&drive), what);
    if (drive.world.plant.tipped && is_jam(fault_case)) {
        return (struct fault_result){.thrown = true};
    }
    TEST_ASSERT_TRUE_MESSAGE((skid_drive_telemetry(&drive).faults & fault_case->expected) != 0, what);
    TEST_ASSERT_TRUE_MESSAGE((skid_drive_telemetry(&drive).faults & ~fault_case->expected) == 0, what);

    const struct planar_pose before = skid_plant_pose(&drive.world.plant);
    const double crept = fault_case->holds ? 0 : 2 * stated_creep(kind);
    skid_drive_for(&drive, 2);
    result.way = speed != 0 ? moved(&before) / (stated_distance(kind, speed) + crept) : 0;
    TEST_ASSERT_EQUAL_INT_MESSAGE(JP_SKID_ROBOT_FAULT, skid_drive_state(&drive), what);

    TEST_ASSERT_FALSE_MESSAGE(drive.world.plant.tipped, what);

    const struct planar_pose stood = skid_plant_pose(&drive.world.plant);
    skid_drive_for(&drive, 3);
    if (options.verbose) {
        printf("%s, %s, after %.3f s, way %.3f of the stated, then %.2g mm\n", what,
               drive.robot.internal.holds ? "holds" : "brakes", result.seconds, result.way, 1000 * moved(&stood));
    }
    if (fault_case->holds) {
        check_below(moved(&stood), 0.001, fault_case->name);
    }
    return result;
}

static void meet_faults(const struct kind *kind, const struct fault_case *cases, size_t count, double slope)
{
    struct fault_result worst = {0};

    for (size_t i = 0; i < count; i++) {
        start_on_slope(kind, slope, 0);
        const struct fault_result result = meet_fault(kind, &cases[i]);
        worst.seconds = fmax(worst.seconds, result.seconds);
        worst.way = fmax(worst.way, cases[i].rolls ? 0 : result.way);
    }
    printf("%s: %zu faults at %g°: named within %.3f s, then stands within %.3f of the stated distance\n",
           kind->config.name, count, slope, worst.seconds, worst.way);
    check_below(worst.way, cases == air_cases ? 2 : 1, "of the stated distance");
}

static void test_every_fault_is_named_and_the_robot_stands(void)
{
    for (int which = 0; which < KINDS; which++) {
        meet_faults(&kinds[which], fault_cases, FAULT_CASES, 0);
        meet_faults(&kinds[which], air_cases, AIR_CASES, 0);
        meet_faults(&kinds[which], air_cases, AIR_CASES, kinds[which].model.limits.slope_deg / 2);
    }
}

/* Any fault but ice, the last, on any ground that the robot may drive, at any speed. Where nothing is held it then
 * creeps as when idle. */
static void test_faults_on_any_ground(void)
{
    for (int which = 0; which < KINDS; which++) {
        const struct kind *kind = &kinds[which];
        struct fault_result worst = {0};
        unsigned long thrown = 0;
        for (unsigned long run = 0; run < 2 * options.count; run++) {
            struct fault_case fault_case = fault_cases[(size_t)(uniform(0, 1) * (FAULT_CASES - 1))];
            struct place place;
            make_place(&place, &kind->model, run);
            start_at(kind, &place);
            fault_case.speed *= uniform(0, 1) < 0.5 ? uniform(0.5, 1) : uniform(-1, -0.5);
            fault_case.turn_rate *= uniform(0, 1) < 0.5 ? 1 : -1;
            const struct fault_result result = meet_fault(kind, &fault_case);
            thrown += result.thrown;
            worst.seconds = fmax(worst.seconds, result.seconds);
            worst.way = fmax(worst.way, fault_case.rolls ? 0 : result.way);
        }
        printf("%s: %lu faults on any ground: named within %.3f s, then stands within %.3f of the stated distance; %lu "
               "jams threw it over\n",
               kind->config.name, 2 * options.count, worst.seconds, worst.way, thrown);
        TEST_ASSERT_TRUE(thrown <= options.count / 10 + 1);
        found[which].named = worst.seconds;
        found[which].fault_stop = worst.way;
        check_below(worst.way, 1, "of the stated distance");
    }
}

/* Hills that become steeper than the robot may drive: it stops before they tip it, and is named. */
static struct skid_ground_point on_a_bend(const void *context, double x, double y)
{
    const double *steepest = context;
    const double rise = *steepest * fmin(fmax(x / 3, 0), 1); /* over 3 m */
    const double height = x < 0 ? 0 : x < 3 ? *steepest * x * x / 6 : *steepest * (x - 1.5);

    (void)y;
    return (struct skid_ground_point){height, rise, 0};
}

static void test_a_slope_that_is_too_steep_stops_it(void)
{
    static double steepest;

    for (int which = 0; which < KINDS; which++) {
        const struct kind *kind = &kinds[which];
        for (int way = 0; way < 2; way++) {
            const struct planar_pose pose = {-0.5, 0, way == 0 ? 0 : M_PI};
            const struct skid_ground bend = {on_a_bend, &steepest};
            const double speed = (way == 0 ? 1 : -1) * kind->model.lattice.speed_m_s;
            steepest = tan(radians(kind->model.limits.slope_deg + (which == ZHANG ? 9 : 6)));
            skid_drive_start(&drive, &kind->model, &kind->config, &bend, &pose, 7);
            skid_drive_enable(&drive);
            TEST_ASSERT_EQUAL_INT(JP_OK, skid_drive_command(&drive, speed, 0, 100));
            skid_drive_for(&drive, 4.5 / kind->model.lattice.speed_m_s);
            TEST_ASSERT_EQUAL_HEX16(JP_FAULT_SLOPE, skid_drive_telemetry(&drive).faults);
            TEST_ASSERT_FALSE(drive.world.plant.tipped);
            const double degrees = atan(fabs(drive.world.plant.attitude.rise_ahead)) * 180 / M_PI;
            const struct planar_pose stood = skid_plant_pose(&drive.world.plant);
            printf("%s: stopped by the slope at %.2f°, limits.slope_deg %g°\n", kind->config.name, degrees,
                   kind->model.limits.slope_deg);
            skid_drive_for(&drive, 3);
            check_below(moved(&stood), 0.001, "m in 3 s");
            jp_skid_robot_disable(&drive.robot);
            skid_drive_for(&drive, 0.7);
            TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_enable(&drive.robot));
        }
    }
}

/* ---- Whatever comes ---- */

static int32_t any_word(void)
{
    static const int32_t special[] = {0, 1, -1, INT32_MAX, INT32_MIN, JP_Q24_ONE, JP_Q16_ONE};

    return uniform(0, 1) < 0.3 ? special[(size_t)(uniform(0, 1) * 7)] : (int32_t)uniform(-2147483648.0, 2147483647.0);
}

/* Words of any value in some of its members, so that many frames are plausible but for one. */
static void spoil(struct jp_sensors *sensors)
{
    int32_t *members[] = {&sensors->pitch_rate,   &sensors->yaw_rate,      &sensors->accel_x,    &sensors->accel_z,
                          &sensors->current_left, &sensors->current_right, &sensors->bus_voltage};

    if (uniform(0, 1) < 0.9) {
        return;
    }
    *members[(size_t)(uniform(0, 1) * 7)] = any_word();
    if (uniform(0, 1) < 0.3) {
        sensors->encoder_left += (uint32_t)any_word();
    }
    drive.disturbance.read = uniform(0, 1) < 0.2 ? JP_ERR_HARDWARE : JP_OK;
}

static void request_anything(void)
{
    const struct jp_skid_command command = {
        .motion = {any_word() / 16, any_word() / 16},
        .acceleration = uniform(0, 1) < 0.5 ? 0 : any_word() / 1000,
        .turn_acceleration = uniform(0, 1) < 0.5 ? 0 : any_word() / 1000,
        .duration = any_word(),
    };
    const double chance = uniform(0, 5);

    if (chance < 1) {
        (void)jp_skid_robot_enable(&drive.robot);
    } else if (chance < 2) {
        jp_skid_robot_disable(&drive.robot);
    } else if (chance < 2.2) {
        jp_skid_robot_stop(&drive.robot);
    } else {
        (void)jp_skid_robot_drive(&drive.robot, &command);
    }
}

static bool is_moving(const struct jp_motion *motion)
{
    return motion->speed != 0 || motion->turn_rate != 0;
}

/* Nothing overflows, which the sanitizers watch; what is not under control does not move but for braking. */
static void test_any_frames_and_requests_are_survived(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const struct kind *kind = &kinds[run % KINDS];
        skid_drive_start(&drive, &kind->model, &kind->config, &level, &origin, run + 1);
        drive.disturbance.sensors = spoil;
        for (int i = 0; i < 500; i++) {
            if (uniform(0, 1) < 0.2) {
                request_anything();
            }
            const bool slows = is_moving(&drive.robot.internal.reference);
            skid_drive_tick(&drive);
            if (!drive.robot.internal.controlled && !slows) {
                TEST_ASSERT_EQUAL_INT32(0, drive.world.actuation.duty_left);
                TEST_ASSERT_EQUAL_INT32(0, drive.world.actuation.duty_right);
            }
        }
    }
}

/* ---- Robots that nobody has seen ---- */

static double factor(double most)
{
    return pow(most, uniform(-1, 1));
}

/* One of the two with another mass, size, motor and supply; what hangs together is scaled together. */
static bool make_robot(struct kind *kind)
{
    struct skid_steer_model *model = &kind->model;
    const double size = factor(1.5);
    const double mass = factor(1.5) * size * size * size;
    const double gear = factor(1.3);

    *kind = kinds[uniform(0, 1) < 0.5 ? ZHANG : BURGER];
    model->body.length_m *= size;
    model->body.width_m *= size * factor(1.2);
    model->body.wheelbase_m *= size;
    model->body.centre_ahead_m *= size;
    model->body.centre_height_m *= size * factor(1.2);
    model->body.mass_kg *= mass;
    model->body.yaw_inertia_kg_m2 *= mass * size * size;
    model->caster.ahead_m *= size;
    model->wheel.radius_m *= size;
    model->wheel.inertia_kg_m2 *= mass * size * size;
    model->tyre.contact_length_m *= size;
    model->motor.gear_ratio *= gear;
    model->motor.torque_constant *= mass * size / gear * factor(1.2);
    model->motor.rotor_inertia_kg_m2 *= mass * size * size / (gear * gear) * factor(1.5);
    model->supply.voltage_v *= 1.6 * mass * factor(1.2);
    model->bus_sense.full_scale_v = 1.6 * model->supply.voltage_v;
    model->motor.resistance_ohm *= mass * mass * factor(1.3);
    model->supply.resistance_ohm *= mass;
    model->motor.friction_nm *= mass * size;
    model->limits.slope_deg *= factor(1.3);
    model->ground.friction *= factor(1.2);
    model->ground.rolling *= factor(1.5);
    model->control.rate_hz = (int)uniform(100, 1000);
    model->encoder.counts_per_turn = (int)(model->encoder.counts_per_turn * factor(4));

    const struct skid_steer_motion climb = {model->limits.speed_m_s, 0, tan(radians(model->limits.slope_deg))};
    return skid_plant_rate(model) < 60000 && skid_steer_voltages(model, &climb).left < 0.95 * model->supply.voltage_v;
}

static void test_robots_that_nobody_has_seen(void)
{
    struct errors speed = {0};
    struct errors turn_rate = {0};
    unsigned long refused = 0;
    const char *field = "";

    for (unsigned long run = 0; run < options.count; run++) {
        static struct kind kind;
        if (!make_robot(&kind)) {
            continue;
        }
        kind.config = skid_robot_design(&kind.model);
        if (jp_skid_robot_init(&drive.robot, &kind.config, &field) != JP_OK) {
            refused++; /* beyond the formats */
            continue;
        }
        struct place place;
        make_place(&place, &kind.model, run);
        start_at(&kind, &place);
        for (int i = 0; i < 3; i++) {
            double v;
            double w;
            command_any(&kind, 5, &v, &w);
            skid_drive_for(&drive, 4.5);
            expect_no_fault();
            add(&speed, (skid_drive_speed(&drive) - v) / kind.model.lattice.speed_m_s);
            add(&turn_rate, (drive.world.plant.state.turn_rate - w) / kind.model.lattice.turn_rate_rad_s);
        }
        jp_skid_robot_stop(&drive.robot);
        skid_drive_for(&drive, 3);
        TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_STANDING, skid_drive_state(&drive));
        const struct planar_pose stood = skid_plant_pose(&drive.world.plant);
        skid_drive_for(&drive, 3);
        check_below(moved(&stood), 0.001, "m in 3 s");
        TEST_ASSERT_TRUE(drive.greatest_current <= kind.model.motor.current_limit_a);
    }
    TEST_ASSERT_TRUE(refused <= options.count / 10);
    printf("unseen robots: off by %.2f %% of the speed, worst %.2f %%; by %.2f %% of the turn rate, worst %.2f %%\n",
           100 * mean_of(&speed), 100 * speed.worst, 100 * mean_of(&turn_rate), 100 * turn_rate.worst);
}

/* Gaps of a structure are 0 in a table: whole words, and the upper halves of some. */
static bool is_same(int32_t made, int32_t in_table)
{
    const bool half = in_table > 0 && in_table <= UINT16_MAX && (uint16_t)made == (uint16_t)in_table;

    return in_table == 0 || half || abs(made - in_table) <= 1 + abs(in_table) / 1000000;
}

/* The tool and its counterpart make the same robot. */
static void test_design_is_that_of_the_tool(void)
{
    for (int which = 0; which < KINDS; which++) {
        const struct jp_skid_robot_config made = skid_robot_design(&kinds[which].model);
        const struct jp_skid_robot_config *table = &kinds[which].config;
        const int32_t *a = (const int32_t *)&made.odometry;
        const int32_t *b = (const int32_t *)&table->odometry;
        const size_t words = (sizeof made - offsetof(struct jp_skid_robot_config, odometry)) / sizeof(int32_t);
        for (size_t i = 0; i < words; i++) {
            TEST_ASSERT_TRUE(is_same(a[i], b[i]));
        }
        TEST_ASSERT_EQUAL_INT32(table->control.turning, made.control.turning);
        TEST_ASSERT_EQUAL_INT32(table->control.proportional, made.control.proportional);
        TEST_ASSERT_EQUAL_INT32(table->wheels.friction, made.wheels.friction);
    }
}

static void add_figures(json_t *figures)
{
    const char *command = "make figures";

    for (int which = 0; which < KINDS; which++) {
        const char *name = kinds[which].config.name;
        figures_add(figures, command, 100 * mean_of(&found[which].speed), "%", no_bar,
                    "%s in closed loop: mean error of the speed, of lattice.speed_m_s", name);
        figures_add(figures, command, 100 * found[which].speed.worst, "%", no_bar,
                    "%s in closed loop: worst error of the speed, of lattice.speed_m_s", name);
        figures_add(figures, command, 100 * mean_of(&found[which].turn_rate), "%", no_bar,
                    "%s in closed loop: mean error of the turn rate, of lattice.turn_rate_rad_s", name);
        figures_add(figures, command, 100 * found[which].turn_rate.worst, "%", no_bar,
                    "%s in closed loop: worst error of the turn rate, of lattice.turn_rate_rad_s", name);
        figures_add(figures, command, 1000 * found[which].standing, "mm", at_most(1),
                    "%s in closed loop: moves in 10 s of standing on its steepest slope", name);
        figures_add(figures, command, 100 * found[which].stopping, "%", at_most(100),
                    "%s in closed loop: way to a stand, of the stated one", name);
        figures_add(figures, command, 100 * found[which].current, "%", at_most(100),
                    "%s in closed loop: greatest current, of motor.current_limit_a", name);
        figures_add(figures, command, found[which].named, "s", no_bar,
                    "%s in closed loop: time until a fault is named, worst of %lu faults on any ground", name,
                    2 * options.count);
        figures_add(figures, command, 100 * found[which].fault_stop, "%", at_most(100),
                    "%s in closed loop: way to a stand after a fault, of the stated one", name);
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, defaults);
    return RUN_PROPERTY(options, add_figures);
}
