/* Instruments and world of skid steer and differential drive: what is measured is what happens, with the errors that
 * the robot file states. */
#include <stdio.h>
#include <string.h>

#include "sim/base/fingerprint.h"
#include "sim/skid_steer/skid_world.h"
#include "tests/support/check.h"
#include "tests/support/options.h"
#include "tests/support/skid_hills.h"
#include "unity.h"

#define Q24   16777216.0
#define Q16   65536.0
#define READS 4000

static const struct options defaults = {.count = 12, .seed = 2018};
static struct options options;
static struct random noise;

static struct skid_steer_model zhang;
static struct skid_steer_model burger;
static struct skid_world world;
static struct skid_samples samples;

static const struct planar_pose origin = {0, 0, 0};
static const struct skid_ground level = {NULL, NULL};

void setUp(void)
{
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/zhang2018.cfg", &zhang));
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/burger.cfg", &burger));
    random_init(&noise, options.seed);
    skid_world_init(&world, &zhang, &level, &origin, options.seed);
}

void tearDown(void)
{
}

/* The same robot with sensors that are exact. */
static struct skid_steer_model exact(const struct skid_steer_model *model)
{
    struct skid_steer_model ideal = *model;

    memset(&ideal.gyro, 0, sizeof ideal.gyro);
    memset(&ideal.accelerometer, 0, sizeof ideal.accelerometer);
    ideal.current_sense.bits = 0;
    ideal.current_sense.noise_rms_a = 0;
    ideal.bus_sense.bits = 0;
    ideal.pwm.bits = 0;
    return ideal;
}

static void act(double left, double right)
{
    world.actuation =
        (struct jp_actuation){(jp_q31)lround(left * 2147483647.0), (jp_q31)lround(right * 2147483647.0), 1};
}

static void run_for(double seconds)
{
    for (int tick = 0; tick < (int)(seconds / skid_world_tick_seconds(&world) + 0.5); tick++) {
        skid_world_step(&world);
    }
}

static double radians(jp_turns_per_s rate)
{
    return rate / Q24 * 2 * M_PI;
}

/* ---- World ---- */

static void test_starts_at_rest_with_bridges_off(void)
{
    skid_world_read(&world, &samples);
    TEST_ASSERT_EQUAL_UINT32(0, samples.encoder_left);
    TEST_ASSERT_EQUAL_UINT32(0, samples.encoder_right);
    TEST_ASSERT_EQUAL_INT(0, world.actuation.enabled);
    TEST_ASSERT_TRUE(world.tick == 0);
    run_for(1);
    check_near(0, world.plant.state.forward, 1e-12, "it does not move");
    TEST_ASSERT_TRUE(world.tick == 500);
}

static void test_tick_is_that_of_the_control(void)
{
    check_near(1.0 / 500, skid_world_tick_seconds(&world), 1e-15, "s");
    skid_world_init(&world, &burger, &level, &origin, 1);
    check_near(1.0 / 100, skid_world_tick_seconds(&world), 1e-15, "s");
    run_for(3);
    check_near(3 * burger.electronics.power_w, world.plant.state.ledger.electronics, 1e-6, "J of 3 s");
}

static void test_duties_of_bridges_that_are_off_do_nothing(void)
{
    act(0.5, 0.5);
    world.actuation.enabled = 0;
    run_for(2);
    check_near(0, world.plant.state.x, 1e-12, "way, m");
    world.actuation.enabled = 1;
    run_for(2);
    TEST_ASSERT_TRUE(world.plant.state.x > 0.5);
}

static void test_full_scale_of_both_signs(void)
{
    world.actuation = (struct jp_actuation){INT32_MAX, INT32_MAX, 1};
    run_for(3);
    const double forward = world.plant.state.forward;
    skid_world_init(&world, &zhang, &level, &origin, 1);
    world.actuation = (struct jp_actuation){INT32_MIN, INT32_MIN, 1};
    run_for(3);
    TEST_ASSERT_TRUE(forward > 1);
    check_near(-forward, world.plant.state.forward, 1e-3, "m/s");
}

static void test_duties_have_the_resolution_of_the_timer(void)
{
    struct skid_steer_model coarse = exact(&zhang);
    coarse.pwm.bits = 3; /* eighths */
    double speeds[3];
    static const double duties[] = {0.375, 0.40, 0.45};

    for (int i = 0; i < 3; i++) {
        skid_world_init(&world, &coarse, &level, &origin, 1);
        act(duties[i], duties[i]);
        run_for(2);
        speeds[i] = world.plant.state.forward;
    }
    check_near(speeds[0], speeds[1], 1e-9, "0.40 is rounded to 0.375");
    TEST_ASSERT_TRUE_MESSAGE(speeds[2] > 1.2 * speeds[0], "0.45 is rounded to 0.5");
}

/* ---- Encoders ---- */

static void test_encoders_count_what_the_wheels_turn(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const struct skid_steer_model *model = run % 2 == 0 ? &zhang : &burger;
        skid_world_init(&world, model, &level, &origin, run);
        world.encoder_start[SKID_LEFT] = (uint32_t)random_uniform(&noise, 0, 4294967295.0);
        world.encoder_start[SKID_RIGHT] = 4294967295u - 3; /* wraps soon */
        for (int part = 0; part < 4; part++) {
            act(random_uniform(&noise, -0.6, 0.6), random_uniform(&noise, -0.6, 0.6));
            run_for(1);
            skid_world_read(&world, &samples);
            for (int side = 0; side < SKID_SIDES; side++) {
                const uint32_t read = side == SKID_LEFT ? samples.encoder_left : samples.encoder_right;
                const double counted = (int32_t)(read - world.encoder_start[side]);
                const double turned = world.plant.state.sides[side].angle / (2 * M_PI) * model->encoder.counts_per_turn;
                TEST_ASSERT_TRUE_MESSAGE(counted <= turned + 1e-6 && counted > turned - 1 - 1e-6, "counts");
            }
        }
    }
}

/* Without slip the encoders tell the way; turning on the spot four wheels slip, and they tell too much. */
static void test_encoders_do_not_see_slip(void)
{
    act(0.4, 0.4);
    run_for(5);
    skid_world_read(&world, &samples);
    const double counted =
        (double)samples.encoder_left / zhang.encoder.counts_per_turn * 2 * M_PI * zhang.wheel.radius_m;
    check_near(world.plant.state.x, counted, 0.01 * counted, "way by the wheels, m");

    skid_world_init(&world, &zhang, &level, &origin, 1);
    act(-0.3, 0.3);
    run_for(5);
    skid_world_read(&world, &samples);
    const double arc = (double)samples.encoder_right / zhang.encoder.counts_per_turn * 2 * M_PI * zhang.wheel.radius_m;
    TEST_ASSERT_TRUE(arc / (zhang.body.width_m / 2) > 1.3 * world.plant.state.heading);
}

/* ---- Inertial sensors ---- */

struct mean {
    double sum;
    double squares;
};

static void add(struct mean *mean, double value)
{
    mean->sum += value;
    mean->squares += value * value;
}

static double mean_of(const struct mean *mean)
{
    return mean->sum / READS;
}

static double deviation_of(const struct mean *mean)
{
    return sqrt(fmax(mean->squares / READS - mean_of(mean) * mean_of(mean), 0));
}

/* At rest each axis has its bias and its noise; they differ from read to read and from axis to axis. */
static void test_gyro_at_rest_has_bias_and_noise(void)
{
    struct mean axes[3] = {{0, 0}};
    struct mean product = {0, 0};

    for (int i = 0; i < READS; i++) {
        skid_world_read(&world, &samples);
        const double dps[] = {samples.roll_rate / Q24 * 360, samples.pitch_rate / Q24 * 360,
                              samples.yaw_rate / Q24 * 360};
        for (int axis = 0; axis < 3; axis++) {
            add(&axes[axis], dps[axis]);
        }
        add(&product, (dps[0] - zhang.gyro.bias_dps) * (dps[1] - zhang.gyro.bias_dps));
    }
    for (int axis = 0; axis < 3; axis++) {
        check_near(zhang.gyro.bias_dps, mean_of(&axes[axis]), 5 * zhang.gyro.noise_rms_dps / sqrt(READS), "bias, °/s");
        check_near(zhang.gyro.noise_rms_dps, deviation_of(&axes[axis]), 0.06 * zhang.gyro.noise_rms_dps, "noise, °/s");
    }
    check_near(0, mean_of(&product), 5 * zhang.gyro.noise_rms_dps * zhang.gyro.noise_rms_dps / sqrt(READS),
               "axes are independent");
}

static void test_accelerometer_at_rest_sees_the_slope(void)
{
    for (int degrees = 0; degrees <= 10; degrees += 5) {
        const struct skid_slope slope = skid_slope_towards(degrees, 0);
        const struct skid_ground ground = skid_ground_slope(&slope);
        const struct planar_pose pose = {0, 0, 30 * M_PI / 180};
        const double factor = 1 + burger.accelerometer.scale_error;
        const double angle = degrees * M_PI / 180;
        struct mean axes[3] = {{0, 0}};
        skid_world_init(&world, &burger, &ground, &pose, options.seed);
        world.plant.model.motor.friction_nm = 1; /* holds */
        run_for(2);
        for (int i = 0; i < READS; i++) {
            skid_world_read(&world, &samples);
            add(&axes[0], samples.accel_x / Q24);
            add(&axes[1], samples.accel_y / Q24);
            add(&axes[2], samples.accel_z / Q24);
        }
        const double x = world.plant.attitude.force_ahead / STANDARD_GRAVITY;
        const double y = world.plant.attitude.force_left / STANDARD_GRAVITY;
        check_near(sin(angle), hypot(x, y), 1e-3, "g along the slope");
        check_near(-tan(angle) * sin(world.plant.state.heading), world.plant.attitude.rise_across, 1e-9,
                   "rise to the left");
        const double expected[] = {x, y, cos(angle)};
        for (int axis = 0; axis < 3; axis++) {
            check_near(expected[axis] * factor + burger.accelerometer.bias_g, mean_of(&axes[axis]),
                       5 * burger.accelerometer.noise_rms_g / sqrt(READS) + 2e-5, "mean, g");
            check_near(burger.accelerometer.noise_rms_g, deviation_of(&axes[axis]),
                       0.06 * burger.accelerometer.noise_rms_g, "noise, g");
        }
        TEST_ASSERT_TRUE_MESSAGE(degrees == 0 || (x > 0 && y < 0), "uphill is ahead and to the right");
    }
}

static void test_gyro_reads_the_turn_rate_with_its_scale(void)
{
    struct skid_steer_model model = exact(&burger);
    model.gyro.scale_error = 0.03;
    skid_world_init(&world, &model, &level, &origin, 1);
    act(-0.3, 0.5);
    run_for(3);
    skid_world_read(&world, &samples);
    check_near(1.03 * world.plant.state.turn_rate, radians(samples.yaw_rate), 1e-6, "rad/s");
    TEST_ASSERT_TRUE(radians(samples.yaw_rate) > 0.5);
    check_near(0, radians(samples.roll_rate), 1e-6, "roll");
    check_near(0, radians(samples.pitch_rate), 1e-6, "pitch");
}

/* The integral of exact gyros over hills is the heading about the body's normal, and the pitch. */
static void test_gyro_and_accelerometer_follow_hills(void)
{
    const struct skid_hills wave = {.height = {0.2}, .along_x = {1}};
    const struct skid_ground ground = {skid_on_hills, &wave};
    const struct skid_steer_model model = exact(&zhang);
    double pitch = 0;

    skid_world_init(&world, &model, &ground, &origin, 1);
    const double start = atan(world.plant.attitude.rise_ahead);
    act(0.5, 0.5);
    for (int tick = 0; tick < 2500; tick++) {
        skid_world_step(&world);
        skid_world_read(&world, &samples);
        pitch += radians(samples.pitch_rate) * skid_world_tick_seconds(&world);
        check_near(world.plant.attitude.force_ahead / STANDARD_GRAVITY, samples.accel_x / Q24, 1e-6, "g ahead");
    }
    check_near(start - atan(world.plant.attitude.rise_ahead), pitch, 0.01, "pitch, rad");
}

static void test_readings_have_steps_and_full_scales(void)
{
    struct skid_steer_model model = exact(&zhang);
    model.gyro.step_dps = 5;
    model.gyro.full_scale_dps = 20;
    model.accelerometer.step_g = 0.25;
    model.accelerometer.full_scale_g = 0.5;
    skid_world_init(&world, &model, &level, &origin, 1);
    skid_world_read(&world, &samples);
    check_near(0.5, samples.accel_z / Q24, 1e-6, "1 g beyond the full scale, g");
    act(-0.6, 0.6);
    for (int tick = 0; tick < 1000; tick++) {
        skid_world_step(&world);
        skid_world_read(&world, &samples);
        const double steps = samples.yaw_rate / Q24 * 360 / 5;
        check_near(round(steps), steps, 1e-4, "°/s in steps");
        check_below(fabs(steps), 4 + 1e-4, "full scale");
    }
    check_near(4, samples.yaw_rate / Q24 * 360 / 5, 1e-4, "at its full scale");
}

/* ---- Currents and voltage ---- */

static void test_currents_and_voltage_are_measured(void)
{
    const double step = 2 * zhang.current_sense.full_scale_a / 4096;
    struct mean left = {0, 0};

    act(0.2, 0.7);
    run_for(3);
    for (int i = 0; i < READS; i++) {
        skid_world_read(&world, &samples);
        add(&left, samples.current_left / Q16);
        check_near(world.plant.attitude.current[SKID_RIGHT], samples.current_right / Q16,
                   6 * zhang.current_sense.noise_rms_a + step, "A");
        check_near(world.plant.attitude.bus_voltage, samples.bus_voltage / Q16, zhang.bus_sense.full_scale_v / 4096,
                   "V");
    }
    check_near(world.plant.attitude.current[SKID_LEFT], mean_of(&left), 0.1 * step + 0.001, "mean, A");
    check_near(hypot(zhang.current_sense.noise_rms_a, step / sqrt(12)), deviation_of(&left), 0.1 * step, "noise, A");
    TEST_ASSERT_TRUE(samples.current_left < 0 && samples.current_right > 0);
    TEST_ASSERT_TRUE(samples.bus_voltage / Q16 < zhang.supply.voltage_v);
}

static void test_currents_beyond_the_full_scale_stay_there(void)
{
    struct skid_steer_model model = zhang;
    model.current_sense.full_scale_a = 2;
    model.current_sense.noise_rms_a = 0;
    skid_world_init(&world, &model, &level, &origin, 1);
    act(-0.5, 0.5);
    run_for(1);
    skid_world_read(&world, &samples);
    check_near(-2, samples.current_left / Q16, 1e-4, "A");
    check_near(2 * (1 - 1.0 / 2048), samples.current_right / Q16, 1e-4, "A");
}

/* ---- Determinism ---- */

static uint64_t fingerprint_of(uint64_t seed, double left)
{
    uint64_t fingerprint = FINGERPRINT_START;

    skid_world_init(&world, &zhang, &level, &origin, seed);
    act(left, 0.4);
    for (int tick = 0; tick < 500; tick++) {
        skid_world_step(&world);
        skid_world_read(&world, &samples);
        fingerprint_add(&fingerprint, &samples, sizeof samples);
    }
    return fingerprint;
}

static void test_runs_repeat_bit_for_bit(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const double left = random_uniform(&noise, -1, 1);
        const uint64_t first = fingerprint_of(run + 1, left);
        TEST_ASSERT_TRUE(first == fingerprint_of(run + 1, left));
        TEST_ASSERT_TRUE(first != fingerprint_of(run + 2, left));
    }
}

/* The noise draws from the world's own stream: what one reads does not change another, nor what happens. */
static void test_worlds_do_not_disturb_each_other(void)
{
    struct skid_world other;
    struct skid_samples others;
    const uint64_t alone = fingerprint_of(7, 0.3);
    uint64_t fingerprint = FINGERPRINT_START;

    skid_world_init(&other, &burger, &level, &origin, 7);
    skid_world_init(&world, &zhang, &level, &origin, 7);
    act(0.3, 0.4);
    for (int tick = 0; tick < 500; tick++) {
        skid_world_step(&other);
        skid_world_read(&other, &others);
        skid_world_step(&world);
        skid_world_read(&world, &samples);
        fingerprint_add(&fingerprint, &samples, sizeof samples);
    }
    TEST_ASSERT_TRUE(alone == fingerprint);
}

static void test_reading_does_not_disturb_the_plant(void)
{
    act(0.3, 0.5);
    run_for(1);
    const struct skid_state state = world.plant.state;
    skid_world_init(&world, &zhang, &level, &origin, options.seed);
    act(0.3, 0.5);
    for (int tick = 0; tick < 500; tick++) {
        skid_world_read(&world, &samples);
        skid_world_step(&world);
    }
    TEST_ASSERT_EQUAL_MEMORY(&state, &world.plant.state, offsetof(struct skid_state, treads));
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, defaults);
    return RUN_PROPERTY(options, NULL);
}
