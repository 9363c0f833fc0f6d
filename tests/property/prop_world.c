/* Instruments, supply, bridges, noise and faults of the simulated world, through its HAL. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/balancer/hal_sim.h"
#include "tests/support/check.h"
#include "unity.h"

#define SEED 20180400u

static struct robot_file ideal;   /* gao2018 */
static struct robot_file courier; /* courier24 */
static struct random noise;

void setUp(void)
{
    TEST_ASSERT_TRUE(robot_file_load("sim/robots/gao2018.cfg", &ideal));
    TEST_ASSERT_TRUE(robot_file_load("sim/robots/courier24.cfg", &courier));
    random_init(&noise, SEED);
}

void tearDown(void)
{
}

static double from_q24(jp_q24 value)
{
    return value / 16777216.0;
}

static double from_q16(jp_q16 value)
{
    return value / 65536.0;
}

static struct jp_actuation duties(double left, double right)
{
    return (struct jp_actuation){
        .duty_left = (jp_q31)(left * 2147483647.0), .duty_right = (jp_q31)(right * 2147483647.0), .enabled = 1};
}

static struct jp_sensors read_ok(struct world *world)
{
    struct jp_sensors sensors = {0};
    const struct jp_hal hal = jp_hal_sim(world);
    TEST_ASSERT_EQUAL_INT(JP_OK, hal.read(hal.context, &sensors));
    return sensors;
}

static void write_ok(struct world *world, struct jp_actuation actuation)
{
    const struct jp_hal hal = jp_hal_sim(world);
    TEST_ASSERT_EQUAL_INT(JP_OK, hal.write(hal.context, &actuation));
}

/* ---- Instruments ---- */

static void test_accelerometer_reads_the_tilt_at_rest(void)
{
    struct world world;
    world_init(&world, &ideal, SEED);
    for (int degree = -70; degree <= 70; degree += 5) {
        const double pitch = degree * M_PI / 180.0;
        plant_hold(&world.plant, pitch);
        const struct jp_sensors sensors = read_ok(&world);
        check_near(-sin(pitch), from_q24(sensors.accel_x), 1e-7, "x");
        check_near(cos(pitch), from_q24(sensors.accel_z), 1e-7, "z");
        TEST_ASSERT_EQUAL_INT32(0, sensors.pitch_rate);
    }
}

/* The sensor's place on the robot, in (x, y, up). */
static void sensor_place(const struct plant *plant, double height, double place[3])
{
    const struct plant_state *s = &plant->state;
    place[0] = plant->x + height * sin(s->pitch) * cos(s->yaw);
    place[1] = plant->y + height * sin(s->pitch) * sin(s->yaw);
    place[2] = height * cos(s->pitch);
}

/* Second difference of the sensor's place, turned into the body's axes. */
static void test_accelerometer_and_gyro_in_motion(void)
{
    const double h = 1e-4;
    struct robot_file robot = ideal;
    robot.accelerometer.height_m = 0.3;
    for (int run = 0; run < 200; run++) {
        struct world world;
        world_init(&world, &robot, SEED);
        world.plant.state = (struct plant_state){.pitch = random_uniform(&noise, -1.0, 1.0),
                                                 .yaw = random_uniform(&noise, -3.0, 3.0),
                                                 .wheel_rate = random_uniform(&noise, -5.0, 5.0),
                                                 .pitch_rate = random_uniform(&noise, -4.0, 4.0),
                                                 .yaw_rate = random_uniform(&noise, -4.0, 4.0)};
        const struct plant_input input = {.voltage_left = random_uniform(&noise, -20.0, 20.0),
                                          .voltage_right = random_uniform(&noise, -20.0, 20.0),
                                          .driven = true};
        double places[3][3];
        struct plant plant = world.plant;
        for (int k = 0; k < 3; k++) {
            if (k == 1) {
                world.plant = plant;
                world.input = input;
            }
            sensor_place(&plant, robot.accelerometer.height_m, places[k]);
            plant_step(&plant, &input, h);
        }
        const struct plant_state *s = &world.plant.state;
        const double x_axis[3] = {cos(s->pitch) * cos(s->yaw), cos(s->pitch) * sin(s->yaw), -sin(s->pitch)};
        const double z_axis[3] = {sin(s->pitch) * cos(s->yaw), sin(s->pitch) * sin(s->yaw), cos(s->pitch)};
        double x = 0.0;
        double z = 0.0;
        for (int i = 0; i < 3; i++) {
            const double acceleration = (places[0][i] - 2.0 * places[1][i] + places[2][i]) / (h * h);
            const double force = acceleration / PLANT_GRAVITY + (i == 2 ? 1.0 : 0.0);
            x += force * x_axis[i];
            z += force * z_axis[i];
        }
        const struct jp_sensors sensors = read_ok(&world);
        check_near(x, from_q24(sensors.accel_x), 1e-4, "x");
        check_near(z, from_q24(sensors.accel_z), 1e-4, "z");
        check_near(s->pitch_rate / (2.0 * M_PI), from_q24(sensors.pitch_rate), 1e-7, "pitch rate");
        check_near(s->yaw_rate * cos(s->pitch) / (2.0 * M_PI), from_q24(sensors.yaw_rate), 1e-7, "yaw rate");
    }
}

static void test_encoders_wrap_and_count_the_wheel_against_the_body(void)
{
    struct world world;
    world_init(&world, &courier, SEED);
    world.instruments.encoder_start_left = 0xfffffff0u;
    world.instruments.encoder_start_right = 0x7ffffff0u;
    const struct jp_sensors start = read_ok(&world);
    TEST_ASSERT_EQUAL_UINT32(0xfffffff0u, start.encoder_left);

    const double turns[] = {1.0, -1.0, 0.25, 1e6, -1e6};
    for (size_t i = 0; i < sizeof turns / sizeof turns[0]; i++) {
        world.plant.state.wheel = 2.0 * M_PI * turns[i] + 0.1 + 1e-7;
        world.plant.state.pitch = 0.1;
        const struct jp_sensors sensors = read_ok(&world);
        const uint32_t counts = (uint32_t)(int64_t)floor(turns[i] * 19200.0);
        TEST_ASSERT_EQUAL_UINT32(counts, sensors.encoder_left - start.encoder_left);
        TEST_ASSERT_EQUAL_UINT32(counts, sensors.encoder_right - start.encoder_right);
    }
    world.plant.state = (struct plant_state){.wheel = -1e-9};
    TEST_ASSERT_EQUAL_UINT32(start.encoder_left - 1u, read_ok(&world).encoder_left);

    /* A quarter turn to the left: each wheel rolls a quarter of the track's circle, the right one forward. */
    world.plant.state = (struct plant_state){.yaw = M_PI / 2.0};
    const struct jp_sensors turned = read_ok(&world);
    const double counts = courier.body.width_m / (courier.wheel.radius_m * 8.0) * 19200.0;
    check_near(counts, (int32_t)(turned.encoder_right - start.encoder_right), 1.0, "right wheel");
    check_near(-counts, (int32_t)(turned.encoder_left - start.encoder_left), 1.0, "left wheel");
}

static void test_noise_bias_and_steps_are_those_of_the_file(void)
{
    enum { COUNT = 20000 };
    const double step = courier.gyro.step_dps / 360.0;
    struct world world;
    world_init(&world, &courier, SEED);
    double sum = 0.0;
    double squares = 0.0;
    double accel_squares = 0.0;
    for (int i = 0; i < COUNT; i++) {
        const struct jp_sensors sensors = read_ok(&world);
        const double rate = from_q24(sensors.pitch_rate);
        check_near(round(rate / step) * step, rate, 1e-7, "gyro step");
        sum += rate * 360.0;
        squares += pow(rate * 360.0 - courier.gyro.bias_dps, 2.0);
        accel_squares += pow(from_q24(sensors.accel_x), 2.0);
    }
    check_near(courier.gyro.bias_dps, sum / COUNT, 0.005, "gyro bias");
    check_near(courier.gyro.noise_rms_dps, sqrt(squares / COUNT), 0.003, "gyro noise");
    check_near(courier.accelerometer.noise_rms_g, sqrt(accel_squares / COUNT), 0.0002, "accelerometer noise");
}

static void test_instruments_saturate_at_full_scale(void)
{
    struct world world;
    world_init(&world, &courier, SEED);
    world.plant.state.pitch_rate = 1000.0;
    world.plant.state.yaw_rate = -1000.0;
    world.input = (struct plant_input){.voltage_left = 1e4, .voltage_right = -1e4, .driven = true};
    world.bus_voltage = 100.0;
    const struct jp_sensors sensors = read_ok(&world);
    check_near(500.0 / 360.0, from_q24(sensors.pitch_rate), 1e-4, "gyro, high");
    check_near(-500.0 / 360.0, from_q24(sensors.yaw_rate), 1e-4, "gyro, low");
    check_near(-4.0, from_q24(sensors.accel_z), 1e-3, "accelerometer");
    check_near(8.0 - 16.0 / 4096.0, from_q16(sensors.current_left), 1e-4, "current, high");
    check_near(-8.0, from_q16(sensors.current_right), 1e-4, "current, low");
    check_near(36.0 - 36.0 / 4096.0, from_q16(sensors.bus_voltage), 1e-4, "bus voltage");

    struct world unlimited;
    world_init(&unlimited, &ideal, SEED);
    unlimited.plant.state.pitch_rate = 1e6;
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, read_ok(&unlimited).pitch_rate);
}

/* ---- Supply and bridges ---- */

static void test_supply_sags_with_the_current(void)
{
    for (int run = 0; run < 200; run++) {
        struct world world;
        world_init(&world, &courier, SEED);
        world.plant.state.wheel_rate = random_uniform(&noise, -30.0, 30.0);
        world.plant.state.yaw_rate = random_uniform(&noise, -5.0, 5.0);
        const struct plant before = world.plant;
        write_ok(&world, duties(random_uniform(&noise, -1, 1), random_uniform(&noise, -1, 1)));
        world_step(&world);
        const double left = plant_current_left(&before, &world.input);
        const double right = plant_current_right(&before, &world.input);
        const double power = world.input.voltage_left * left + world.input.voltage_right * right;
        const double ampere = power / world.bus_voltage + courier.electronics.power_w / courier.supply.voltage_v;
        check_near(24.0 - 0.1 * ampere, world.bus_voltage, 1e-9, "bus voltage");
    }
}

static void test_duty_has_the_resolution_of_the_pwm(void)
{
    struct world world;
    world_init(&world, &courier, SEED);
    write_ok(&world, duties(100.4 / 4096.0, -1.0));
    world_step(&world);
    check_near(100.0 / 4096.0, world.input.voltage_left / world.bus_voltage, 1e-12, "left");
    check_near(-1.0, world.input.voltage_right / world.bus_voltage, 1e-12, "right");

    struct world fine;
    world_init(&fine, &ideal, SEED);
    write_ok(&fine, duties(100.4 / 4096.0, 0.0));
    world_step(&fine);
    check_near(100.4 / 4096.0 * 256.0, fine.input.voltage_left, 1e-6, "ideal");
}

static void test_disabled_bridges_coast(void)
{
    struct world world;
    world_init(&world, &courier, SEED);
    world.plant.state.wheel_rate = 20.0;
    struct jp_actuation off = duties(0.5, 0.5);
    off.enabled = 0;
    write_ok(&world, off);
    world_step(&world);
    TEST_ASSERT_TRUE(world.plant.ledger.electrical == 0.0 && world.plant.ledger.copper == 0.0);
    check_near(0.0, from_q16(read_ok(&world).current_left), 0.06, "no current flows, but for noise");
}

static void test_push_lasts_its_ticks(void)
{
    struct world world;
    world_init(&world, &courier, SEED);
    world_push(&world, 10.0, 0.5, 3);
    for (int tick = 0; tick < 6; tick++) {
        world_step(&world);
        check_near(tick < 3 ? 10.0 : 0.0, world.input.push_n, 0.0, "push");
        check_near(tick < 3 ? 0.5 : 0.0, world.input.yaw_torque_nm, 0.0, "torque");
    }
}

/* ---- Repeatability ---- */

static struct jp_sensors driven_tick(struct world *world, int tick)
{
    write_ok(world, duties(0.2 * sin(tick * 0.01), 0.1 * cos(tick * 0.02)));
    world_step(world);
    return read_ok(world);
}

static void test_seed_repeats_every_bit_and_worlds_are_apart(void)
{
    enum { TICKS = 2000 };
    static struct jp_sensors alone[TICKS];
    struct world world;
    world_init(&world, &courier, SEED);
    for (int tick = 0; tick < TICKS; tick++) {
        alone[tick] = driven_tick(&world, tick);
    }
    struct world same;
    struct world other;
    world_init(&same, &courier, SEED);
    world_init(&other, &courier, SEED + 1u);
    int equal = 0;
    for (int tick = 0; tick < TICKS; tick++) {
        const struct jp_sensors different = driven_tick(&other, tick);
        const struct jp_sensors repeated = driven_tick(&same, tick);
        TEST_ASSERT_EQUAL_MEMORY(&alone[tick], &repeated, sizeof repeated);
        equal += different.pitch_rate == repeated.pitch_rate;
    }
    TEST_ASSERT_TRUE_MESSAGE(equal < TICKS / 5, "another seed must make other noise");
}

/* The first draws of neighbouring seeds are as far apart as those of any two: 1/3 on average, sign at random. */
static void test_neighbouring_seeds_are_independent(void)
{
    enum { COUNT = 2000 };
    double difference = 0.0;
    double product = 0.0;
    for (uint64_t seed = 0; seed < COUNT; seed++) {
        struct random first;
        struct random second;
        random_init(&first, seed);
        random_init(&second, seed + 1u);
        const double a = random_uniform(&first, -1.0, 1.0);
        const double b = random_uniform(&second, -1.0, 1.0);
        difference += fabs(a - b) / 2.0;
        product += a * b;
    }
    check_near(1.0 / 3.0, difference / COUNT, 0.04, "distance");
    check_near(0.0, product / COUNT, 0.04, "correlation");
}

/* ---- Faults ---- */

static void test_faults_act_in_their_ticks(void)
{
    struct world world;
    world_init(&world, &ideal, SEED);
    const struct world_fault faults[] = {
        {.channel = WORLD_PITCH_RATE, .kind = WORLD_FROZEN, .from = 10, .until = 20},
        {.channel = WORLD_ACCEL_X, .kind = WORLD_STUCK, .value = INT32_MIN, .from = 10, .until = 20},
        {.channel = WORLD_ACCEL_Z, .kind = WORLD_JUMPED, .value = INT32_MAX, .from = 10, .until = 20},
        {.channel = WORLD_ENCODER_LEFT, .kind = WORLD_JUMPED, .value = -5, .from = 10},
        {.channel = WORLD_CURRENT_LEFT, .kind = WORLD_SCALED, .value = JP_Q16(0.5), .from = 10, .until = 20},
        {.channel = WORLD_CURRENT_RIGHT, .kind = WORLD_SCALED, .value = INT32_MIN, .from = 10, .until = 20},
    };
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        TEST_ASSERT_TRUE(world_add_fault(&world, &faults[i]));
    }
    struct world sound;
    world_init(&sound, &ideal, SEED);
    struct jp_sensors last = {0};
    for (uint64_t tick = 0; tick < 30; tick++) {
        const struct jp_sensors expected = read_ok(&sound);
        const struct jp_sensors faulty = read_ok(&world);
        const bool active = tick >= 10 && tick < 20;
        if (tick < 10) {
            last = expected;
        }
        TEST_ASSERT_EQUAL_INT32(active ? last.pitch_rate : expected.pitch_rate, faulty.pitch_rate);
        TEST_ASSERT_EQUAL_INT32(active ? INT32_MIN : expected.accel_x, faulty.accel_x);
        TEST_ASSERT_EQUAL_INT32(active ? INT32_MAX : expected.accel_z, faulty.accel_z);
        TEST_ASSERT_EQUAL_UINT32(expected.encoder_left - (tick >= 10 ? 5u : 0u), faulty.encoder_left);
        TEST_ASSERT_EQUAL_UINT32(expected.encoder_right, faulty.encoder_right);
        TEST_ASSERT_INT32_WITHIN(1, expected.current_left / (active ? 2 : 1), faulty.current_left);
        TEST_ASSERT_EQUAL_INT32(active ? INT32_MIN : expected.current_right, faulty.current_right);
        write_ok(&world, duties(0.05, 0.05));
        write_ok(&sound, duties(0.05, 0.05));
        world_step(&world);
        world_step(&sound);
    }
    TEST_ASSERT_TRUE(last.pitch_rate != 0);
}

static void test_hal_failures(void)
{
    struct world world;
    world_init(&world, &courier, SEED);
    const struct world_fault read = {.channel = WORLD_HAL_READ, .from = 1, .until = 2};
    const struct world_fault write = {.channel = WORLD_HAL_WRITE, .from = 2, .until = 3};
    TEST_ASSERT_TRUE(world_add_fault(&world, &read) && world_add_fault(&world, &write));
    const struct jp_hal hal = jp_hal_sim(&world);
    const struct jp_actuation drive = duties(0.1, 0.1);
    for (uint64_t tick = 0; tick < 4; tick++) {
        struct jp_sensors sensors;
        TEST_ASSERT_EQUAL_INT(tick == 1 ? JP_ERR_HARDWARE : JP_OK, hal.read(hal.context, &sensors));
        TEST_ASSERT_EQUAL_INT(tick == 2 ? JP_ERR_HARDWARE : JP_OK, hal.write(hal.context, &drive));
        world_step(&world);
        TEST_ASSERT_TRUE(world.input.driven == (tick != 2));
    }
    while (world.faults.count < WORLD_FAULTS_MAX) {
        TEST_ASSERT_TRUE(world_add_fault(&world, &read));
    }
    TEST_ASSERT_FALSE(world_add_fault(&world, &read));
}

/* ---- Changes of the robot ---- */

static void test_changed_robot_is_that_of_the_new_file(void)
{
    struct robot_file other = courier;
    other.body.mass_kg += 1.0;
    other.supply.voltage_v = 22.0;
    other.gyro.bias_dps = 5.0;
    struct world world;
    world_init(&world, &courier, SEED);
    for (int tick = 0; tick < 100; tick++) {
        (void)driven_tick(&world, tick);
    }
    const struct plant before = world.plant;
    const struct jp_sensors sensors = read_ok(&world);
    TEST_ASSERT_TRUE(world_change_robot(&world, &other));

    struct world fresh;
    world_init(&fresh, &other, SEED);
    TEST_ASSERT_EQUAL_MEMORY(&fresh.plant.constants, &world.plant.constants, sizeof fresh.plant.constants);
    TEST_ASSERT_EQUAL_MEMORY(&before.state, &world.plant.state, sizeof before.state);
    TEST_ASSERT_TRUE(world.plant.ledger.electrical == before.ledger.electrical);
    TEST_ASSERT_EQUAL_UINT64(100u, world.tick);

    const struct jp_sensors after = read_ok(&world);
    TEST_ASSERT_EQUAL_UINT32(sensors.encoder_left, after.encoder_left);
    TEST_ASSERT_EQUAL_UINT32(sensors.encoder_right, after.encoder_right);
    check_near(4.5, (from_q24(after.pitch_rate) - from_q24(sensors.pitch_rate)) * 360.0, 1.0, "gyro bias");
    write_ok(&world, duties(0.0, 0.0));
    world_step(&world);
    check_near(22.0 - 0.1 * 4.0 / 22.0, world.bus_voltage, 1e-9, "bus voltage");
}

static void test_change_that_would_move_the_encoders_is_refused(void)
{
    struct robot_file others[4] = {courier, courier, courier, courier};
    others[0].control.rate_hz *= 2;
    others[1].encoder.counts_per_turn *= 2;
    others[2].wheel.radius_m *= 1.01;
    others[3].body.width_m *= 1.01;
    struct world world;
    world_init(&world, &courier, SEED);
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        const struct world before = world;
        others[i].body.mass_kg += 1.0;
        TEST_ASSERT_FALSE(world_change_robot(&world, &others[i]));
        TEST_ASSERT_EQUAL_MEMORY(&before, &world, sizeof world);
    }
}

int main(void)
{
    (void)printf("seed %u\n", SEED);
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
