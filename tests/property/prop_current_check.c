/*
 * The current check against least squares in double over the samples of the past, on random drives of random motors:
 * every fault is found in time and under its name, and sound sensors are left alone.
 *
 * prop_current_check [--count N] [--seed S]
 * --count is the number of samples without a fault.
 */
#include <joulepath/current_check.h>

#include <math.h>
#include <stdio.h>

#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

#define Q16_ONE 65536.0
#define Q24_ONE 16777216.0

#define HISTORY   16384
#define ESTIMATES 150 /* drives whose estimates are compared */
#define FAULTS    150 /* drives with a fault */

#define OFFSET     0.05 /* A */
#define GAIN       0.06
#define RESISTANCE 0.25
#define EXCITATION 0.1 /* A */

/* A fault has its name after so many times the memory: a gain needs currents to show. */
#define NAMED 40

/* When the current changes with the sensor both may look like another fault for a while: so many in a thousand do. */
#define MISNAMED 5

static struct options options = {.count = 500000, .seed = 1};

static int misnamed;
static double worst_offset_time; /* of the memory */
static double worst_gain_time;

void setUp(void)
{
    random_state = options.seed * 0x9E3779B97F4A7C15U;
}

void tearDown(void)
{
}

/* A robot */

struct sensor {
    double offset; /* A */
    double gain;
    double noise; /* A */
};

struct motor {
    double target; /* current that the drive heads for, A */
    double current;
    double rate; /* turn/s */
    struct sensor sensor;
};

struct drive {
    struct jp_current_check_config config;
    struct jp_monitor_config motors;
    struct jp_current_check check;
    struct motor left;
    struct motor right;
    int until_change; /* samples until the drive heads for another current */
    bool stands;
};

static struct sensor sound_sensor(void)
{
    return (struct sensor){uniform(-0.01, 0.01), uniform(0.97, 1.01), uniform(0.002, 0.02)};
}

static void start(struct drive *drive, uint16_t memory)
{
    *drive = (struct drive){.config = {.offset = JP_Q16(OFFSET),
                                       .gain = JP_Q16(GAIN),
                                       .resistance = JP_Q16(RESISTANCE),
                                       .excitation = JP_Q16(EXCITATION),
                                       .memory = memory},
                            .motors = {.motor_resistance = (jp_q16)(uniform(0.2, 10) * Q16_ONE),
                                       .back_emf = (jp_q16)(uniform(0.1, 5) * Q16_ONE),
                                       .half_track = (jp_q16)(uniform(0.5, 4) * Q16_ONE)},
                            .left.sensor = sound_sensor(),
                            .right.sensor = sound_sensor()};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_current_check_check(&drive->config, &field));
    jp_current_check_start(&drive->check, &drive->config, &drive->motors);
}

static void head(struct motor *motor, double low, double high)
{
    motor->target = uniform(low, high);
}

/* Segments of a tenth to twice the memory; a quarter of them are stands. */
static void choose(struct drive *drive)
{
    drive->until_change = (int)uniform(0.1 * drive->config.memory, 2.0 * drive->config.memory);
    drive->stands = random_bits() % 4 == 0;
    head(&drive->left, drive->stands ? -0.02 : -1, drive->stands ? 0.02 : 2);
    head(&drive->right, drive->stands ? -0.02 : -1, drive->stands ? 0.02 : 2);
}

static void move(struct motor *motor)
{
    motor->current += 0.02 * (motor->target - motor->current) + gaussian(0.005);
    motor->rate += 0.01 * (motor->target - motor->rate);
}

static double measure(const struct motor *motor)
{
    return motor->sensor.offset + motor->sensor.gain * motor->current + gaussian(motor->sensor.noise);
}

static jp_q16 voltage(const struct drive *drive, const struct motor *motor)
{
    return (jp_q16)lround(drive->motors.motor_resistance * motor->current + drive->motors.back_emf * motor->rate);
}

static struct jp_motor_sample next_sample(struct drive *drive)
{
    if (drive->until_change-- == 0) {
        choose(drive);
    }
    move(&drive->left);
    move(&drive->right);

    const double turning = (drive->right.rate - drive->left.rate) / 2;

    return (struct jp_motor_sample){
        .voltages = {.left = voltage(drive, &drive->left), .right = voltage(drive, &drive->right)},
        .wheel_rate = (jp_q24)lround((drive->left.rate + drive->right.rate) / 2 * Q24_ONE),
        .yaw_rate = (jp_q24)lround(turning / (drive->motors.half_track / Q16_ONE) * Q24_ONE),
        .current_left = (jp_q16)lround(measure(&drive->left) * Q16_ONE),
        .current_right = (jp_q16)lround(measure(&drive->right) * Q16_ONE),
    };
}

static uint8_t step(struct drive *drive)
{
    const struct jp_motor_sample sample = next_sample(drive);

    return jp_current_check_update(&drive->check, &sample);
}

static uint16_t random_memory(void)
{
    return (uint16_t)(128 << random_bits() % 6);
}

/* The oracle: least squares over all samples since the last change, each weighted by its age. */

static double expected_currents[HISTORY];
static double measured_currents[HISTORY];

/* A new sample takes the share 1/n, at least 1/memory; those before keep the rest. */
static double share(int n, int memory)
{
    return 1.0 / (n < memory ? n : memory);
}

static void check_estimate(const struct jp_current_estimate *estimate, double noise, int count, int memory)
{
    long double weight = 1;
    long double sums[5] = {0};

    for (int n = count; n >= 1; n--) {
        const long double x = expected_currents[n - 1];
        const long double y = measured_currents[n - 1];
        const long double w = weight * (long double)share(n, memory);
        const long double terms[5] = {x, y, x * x, x * y, y * y};

        for (int k = 0; k < 5; k++) {
            sums[k] += w * terms[k];
        }
        weight *= 1 - (long double)share(n, memory);
    }

    const long double variance = sums[2] - sums[0] * sums[0];
    const long double product = sums[3] - sums[0] * sums[1];

    if (variance < 1.05L * EXCITATION * EXCITATION) {
        return;
    }

    const double gain = (double)(product / variance);
    const double residual = sqrt((double)(sums[4] - sums[1] * sums[1] - product * product / variance));
    const double samples = count < memory ? count : memory;
    const double bent = fmax(residual * residual - 1.5 * noise, 0) / 4;
    const double of_mean = residual * residual / samples + bent;
    const double gain_deviation = sqrt(of_mean / (double)variance);
    const double turned = (double)sums[0] * gain_deviation;

    TEST_ASSERT_DOUBLE_WITHIN(2e-4, gain, estimate->gain / Q16_ONE);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, (double)(sums[1] - gain * sums[0]), estimate->offset / Q16_ONE);
    TEST_ASSERT_DOUBLE_WITHIN(3e-4 + 0.01 * gain_deviation, gain_deviation, estimate->gain_deviation / Q16_ONE);
    TEST_ASSERT_DOUBLE_WITHIN(3e-4, sqrt(of_mean + turned * turned), estimate->offset_deviation / Q16_ONE);
}

/* As the check must see it: from what the sample holds. */
static double expected_left(const struct drive *drive, const struct jp_motor_sample *sample)
{
    const double rate = sample->wheel_rate / Q24_ONE - sample->yaw_rate / Q24_ONE * drive->motors.half_track / Q16_ONE;

    return (sample->voltages.left - drive->motors.back_emf * rate) / drive->motors.motor_resistance;
}

static void compare_with_oracle(void)
{
    struct drive drive;
    const uint16_t memory = random_memory();
    int count = 0;

    start(&drive, memory);
    drive.left.sensor = (struct sensor){uniform(-1, 1), uniform(0.5, 1.5), uniform(0.002, 0.05)};
    for (int i = 0; i < 5 * memory && count < HISTORY; i++) {
        const struct jp_motor_sample sample = next_sample(&drive);

        expected_currents[count] = expected_left(&drive, &sample);
        measured_currents[count] = sample.current_left / Q16_ONE;
        (void)jp_current_check_update(&drive.check, &sample);
        count = drive.check.left.moments.count == 0 ? 0 : count + 1; /* all is forgotten */
        if (count >= memory / 4 && i % (memory / 4) == 0) {
            check_estimate(&drive.check.left.estimate, (double)drive.check.left.noise / (Q16_ONE * Q16_ONE), count,
                           memory);
        }
    }
}

static void test_estimates_are_least_squares(void)
{
    for (int i = 0; i < ESTIMATES; i++) {
        compare_with_oracle();
    }
}

/* Faults */

struct fault {
    bool of_gain;
    bool of_right;
    double value;
    uint8_t finding;
};

static double either_sign(double value)
{
    return random_bits() % 2 == 0 ? value : -value;
}

static struct fault random_fault(void)
{
    const bool of_gain = random_bits() % 2 == 0;
    const bool of_right = random_bits() % 2 == 0;
    const unsigned left = of_gain ? JP_CURRENT_GAIN_LEFT : JP_CURRENT_OFFSET_LEFT;
    const double gain = random_bits() % 2 == 0 ? uniform(0.6, 0.87) : uniform(1.13, 1.5);

    return (struct fault){.of_gain = of_gain,
                          .of_right = of_right,
                          .value = of_gain ? gain : either_sign(uniform(0.1, 1)),
                          .finding = (uint8_t)(of_right ? left << 1 : left)};
}

static void inject(struct drive *drive, const struct fault *fault)
{
    struct sensor *sensor = fault->of_right ? &drive->right.sensor : &drive->left.sensor;

    if (fault->of_gain) {
        sensor->gain = fault->value;
    } else {
        sensor->offset = fault->value;
    }
}

/* Drives until exactly this is found. Returns the number of samples. */
static int drive_until(struct drive *drive, uint8_t finding, uint8_t allowed)
{
    bool wrong = false;
    uint8_t found;
    int samples = 0;

    do {
        found = step(drive);
        wrong = wrong || (found & ~(allowed | JP_CURRENT_CHANGING)) != 0;
        samples++;
    } while (found != finding && samples < NAMED * drive->config.memory);
    TEST_ASSERT_EQUAL_HEX8(finding, found);
    misnamed += wrong;
    return samples;
}

/* It stays so. */
static void drive_on(struct drive *drive, uint8_t finding, int samples)
{
    bool wrong = false;

    for (int i = 0; i < samples; i++) {
        wrong = wrong || (step(drive) & ~JP_CURRENT_CHANGING) != finding;
    }
    misnamed += wrong;
}

static void find_fault(void)
{
    struct drive drive;
    const uint16_t memory = (uint16_t)(256 << random_bits() % 4);
    const struct fault fault = random_fault();

    start(&drive, memory);
    for (int i = 0; i < 6 * memory; i++) {
        TEST_ASSERT_EQUAL_HEX8(0, step(&drive));
    }

    const struct drive sound = drive;

    inject(&drive, &fault);

    const double time = (double)drive_until(&drive, fault.finding, fault.finding) / memory;

    if (fault.of_gain) {
        worst_gain_time = fmax(worst_gain_time, time);
    } else {
        worst_offset_time = fmax(worst_offset_time, time);
    }
    drive_on(&drive, fault.finding, 4 * memory);

    const struct jp_current_motor *motor = fault.of_right ? &drive.check.right : &drive.check.left;

    if (!fault.of_gain) {
        TEST_ASSERT_DOUBLE_WITHIN(0.05, fault.value, motor->estimate.offset / Q16_ONE);
    }
    drive.left.sensor = sound.left.sensor;
    drive.right.sensor = sound.right.sensor;
    (void)drive_until(&drive, 0, fault.finding);
}

static void test_every_fault_is_found_and_named(void)
{
    for (int i = 0; i < FAULTS; i++) {
        find_fault();
    }
    printf("%d faults named, offsets after at most %.2f and gains after at most %.2f of the memory, %d misnamed\n",
           FAULTS, worst_offset_time, worst_gain_time, misnamed);
    TEST_ASSERT_TRUE(misnamed <= 2 * FAULTS * MISNAMED / 1000); /* as they come and as they go */
}

/* Motors that are warm alike are never taken for a sensor's fault. */
static void test_warm_motors_are_no_fault(void)
{
    for (int i = 0; i < FAULTS / 10; i++) {
        struct drive drive;
        const uint16_t memory = 512;
        const double warm = uniform(0.8, 0.88);

        start(&drive, memory);
        drive.left.sensor.gain = warm + uniform(-0.01, 0.01);
        drive.right.sensor.gain = warm + uniform(-0.01, 0.01);
        for (int k = 0; k < 20 * memory; k++) {
            TEST_ASSERT_EQUAL_HEX8(0, step(&drive) & ~(JP_CURRENT_RESISTANCE | JP_CURRENT_CHANGING));
        }
        for (int k = 0; k < 20 * memory; k++) {
            TEST_ASSERT_EQUAL_HEX8(JP_CURRENT_RESISTANCE, step(&drive));
        }
    }
}

static void test_no_false_alarm(void)
{
    unsigned long samples = 0;

    while (samples < options.count) {
        struct drive drive;
        const uint16_t memory = random_memory();

        start(&drive, memory);
        for (unsigned long i = 0; i < options.count / 20; i++) {
            TEST_ASSERT_EQUAL_HEX8(0, step(&drive));
        }
        samples += options.count / 20;
    }
    printf("%lu samples of sound sensors, no finding\n", samples);
}

/* A day's stand at 10 Hz. */
static void test_standing_changes_nothing(void)
{
    struct drive drive;

    start(&drive, 512);
    for (unsigned long i = 0; i < 864000; i++) {
        drive.until_change = 1000;
        TEST_ASSERT_EQUAL_HEX8(0, step(&drive));
    }
    TEST_ASSERT_EQUAL_INT32(JP_Q16_ONE, drive.check.left.estimate.gain);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, drive.left.sensor.offset, drive.check.left.estimate.offset / Q16_ONE);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, drive.right.sensor.offset, drive.check.right.estimate.offset / Q16_ONE);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
