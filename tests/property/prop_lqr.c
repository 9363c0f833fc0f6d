/*
 * Largest error of controller, estimator, reference, odometry and meter against floating point.
 *
 * prop_lqr [--count N] [--seed S]
 * --count states of the controller for each robot.
 */
#include <joulepath/tables.h>

#include "tests/support/lqr_oracle.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/options.h"
#include "unity.h"

#define TURN_PHASE 0x1p56
#define PI         3.14159265358979323846

struct result {
    const char *name;
    const char *unit;
    double bound;
    double worst;
};

static struct options options = {.count = 50000, .seed = 1};
static struct result results[32];
static size_t result_count;

void setUp(void)
{
}

void tearDown(void)
{
}

static void record(const char *name, const char *unit, double bound, double worst)
{
    results[result_count++] = (struct result){name, unit, bound, worst};
    TEST_ASSERT_TRUE_MESSAGE(worst <= bound, name);
}

static void test_controller(void)
{
    record("gao2018: controller", "mV", 5, lqr_worst_millivolts(&jp_robot_gao2018.lqr, options.count, options.seed));
    record("courier24: controller", "mV", 5,
           lqr_worst_millivolts(&jp_robot_courier24.lqr, options.count, options.seed));
}

/* Estimator */

struct exact_loop {
    double angle, rate;
};

static void exact_track(struct exact_loop *loop, const struct jp_estimator_config *config, double measured)
{
    const double predicted = loop->angle + loop->rate / config->tick_rate;
    const double error = measured - predicted;

    loop->angle = predicted + error * (config->tracking_gain / 65536.0);
    loop->rate += error * (config->tracking_rate_gain / 65536.0);
}

struct exact_estimator {
    double wheel_encoder, yaw_encoder, pitch, bias, pitch_rate;
    struct exact_loop wheel, yaw;
};

static void exact_estimate(struct exact_estimator *exact, const struct jp_estimator_config *config, int32_t left,
                           int32_t right, const struct jp_sensors *sensors)
{
    exact->wheel_encoder += (double)(left + right) * (double)config->wheel_per_count / TURN_PHASE;
    exact->yaw_encoder += (double)(right - left) * (double)config->yaw_per_count / TURN_PHASE;
    exact_track(&exact->wheel, config, exact->wheel_encoder);
    exact_track(&exact->yaw, config, exact->yaw_encoder);
    exact->pitch_rate = lqr_turns(sensors->pitch_rate) - exact->bias;
    exact->pitch += exact->pitch_rate / config->tick_rate;

    const double radians = 2 * PI * exact->pitch;
    const double tilt =
        -(lqr_turns(sensors->accel_x) * cos(radians) + lqr_turns(sensors->accel_z) * sin(radians)) / (2 * PI);

    exact->pitch += tilt * config->tilt_gain / 2147483648.0;
    exact->bias -= tilt * config->bias_gain / 2147483648.0;
}

struct estimator_error {
    double angle, rate, pitch, pitch_rate;
};

/** A minute of rocking, turning and driving both ways, at up to 2 turn/s of the wheels. */
static struct estimator_error drive_estimator(const struct jp_estimator_config *config)
{
    const double counts = 0.5 / ((double)config->wheel_per_count / TURN_PHASE); /* a turn of one wheel */
    struct exact_estimator exact = {0};
    struct estimator_error worst = {0};
    struct jp_sensors sensors = {.encoder_left = 0xFFFFF000U, .encoder_right = 0x7FFFFF00U, .accel_z = JP_Q24_ONE};
    struct jp_motion_state state;
    struct jp_estimator estimator;
    struct random random;
    double speed = 0;

    random_init(&random, options.seed);
    jp_estimator_start(&estimator, config, &sensors);
    for (uint32_t tick = 0; tick < 60 * config->tick_rate; tick++) {
        const double t = (double)tick / config->tick_rate;
        const double tilt = 0.3 * sin(2 * t);

        speed = fmin(fmax(speed + random_uniform(&random, -0.02, 0.02), -2), 2);

        const int32_t left = (int32_t)(speed * counts / config->tick_rate + random_uniform(&random, -2, 2));
        const int32_t right = (int32_t)((speed + 0.3) * counts / config->tick_rate + random_uniform(&random, -2, 2));

        sensors.encoder_left += (uint32_t)left;
        sensors.encoder_right += (uint32_t)right;
        sensors.pitch_rate = (jp_q24)((0.6 * cos(2 * t) / (2 * PI) + 0.001) * 16777216.0);
        sensors.accel_x = (jp_q24)((random_uniform(&random, -0.05, 0.05) - sin(tilt)) * 16777216.0);
        sensors.accel_z = (jp_q24)((random_uniform(&random, -0.05, 0.05) + cos(tilt)) * 16777216.0);
        jp_estimator_update(&estimator, config, &sensors, &state);
        exact_estimate(&exact, config, left, right, &sensors);

        const double wheel = lqr_phase_turns(state.wheel) - exact.wheel.angle - exact.pitch;

        worst.angle = fmax(worst.angle, fabs(remainder(wheel, 256)));
        worst.angle = fmax(worst.angle, fabs(lqr_phase_turns(state.yaw) - exact.yaw.angle));
        worst.rate = fmax(worst.rate, fabs(lqr_turns(state.wheel_rate) - exact.wheel.rate - exact.pitch_rate));
        worst.rate = fmax(worst.rate, fabs(lqr_turns(state.yaw_rate) - exact.yaw.rate));
        worst.pitch = fmax(worst.pitch, fabs(lqr_turns(state.pitch) - exact.pitch));
        worst.pitch_rate = fmax(worst.pitch_rate, fabs(lqr_turns(state.pitch_rate) - exact.pitch_rate));
    }
    return worst;
}

static void test_estimator(void)
{
    const struct estimator_error gao = drive_estimator(&jp_robot_gao2018.estimator);
    const struct estimator_error courier = drive_estimator(&jp_robot_courier24.estimator);

    /* A rate is gained from an error rounded to 2⁻²⁴ turn, times tick_rate without smoothing. */
    record("gao2018: wheel and yaw angle", "turn", 1e-6, gao.angle);
    record("gao2018: wheel and yaw rate", "turn/s", 1e-4, gao.rate);
    record("gao2018: pitch", "turn", 1e-6, gao.pitch);
    record("gao2018: pitch rate", "turn/s", 1e-9, gao.pitch_rate);
    record("courier24: wheel and yaw angle", "turn", 1e-6, courier.angle);
    record("courier24: wheel and yaw rate", "turn/s", 2e-5, courier.rate);
    record("courier24: pitch", "turn", 1e-6, courier.pitch);
    record("courier24: pitch rate", "turn/s", 1e-6, courier.pitch_rate);
}

/* Reference */

struct exact_axis {
    double target, target_rate, angle, rate;
};

static void exact_follow(struct exact_axis *axis, double bandwidth, double dt)
{
    axis->target += axis->target_rate * dt;
    if (bandwidth == 0) {
        axis->angle = axis->target;
        axis->rate = axis->target_rate;
        return;
    }
    axis->rate += bandwidth * (bandwidth * (axis->target - axis->angle) + 2 * (axis->target_rate - axis->rate)) * dt;
    axis->angle += axis->rate * dt;
}

/** The wheels' speed as it was asked for, and since how many ticks the last direction rests. */
struct exact_direction {
    double asked;
    double last; /* speed that was not 0 */
    uint32_t rested;
};

/** The speed of a tick: 0 until a change of direction has rested. */
static double rested_speed(struct exact_direction *direction, double speed, uint32_t rest_ticks)
{
    const bool turns_round = direction->asked * direction->last < 0;

    direction->rested = speed == 0 ? direction->rested + 1 : 0;
    if (turns_round && direction->rested < rest_ticks) {
        return 0;
    }
    direction->last = direction->asked == 0 ? direction->last : direction->asked;
    return direction->asked;
}

static void test_reference_of(const struct jp_reference_config *config, const char *angle_name, const char *rate_name)
{
    const double turns_per_radian = 1 / (2 * PI);
    struct exact_axis wheel = {0}, yaw = {0};
    struct exact_direction direction = {0};
    struct jp_reference reference;
    struct random random;
    double angle = 0, rate = 0, dt;

    random_init(&random, options.seed);
    jp_reference_start(&reference, config, 0, 0);
    dt = (double)reference.phase_per_rate * 0x1p-32; /* a tick of 1 ms is 2⁻³²/3 s short */
    for (int tick = 0; tick < 120000; tick++) {
        if (tick % 4000 == 0) {
            const struct jp_motion motion = {lqr_random_turns(&random, 1), lqr_random_turns(&random, 0.35)};
            const jp_q24 turn = lqr_random_turns(&random, 1.4);
            const struct jp_reference_step step = jp_reference_step_to(config, &motion, turn);

            jp_reference_apply(&reference, &step);
            direction.asked = lqr_turns(motion.speed) * lqr_turns(config->turns_per_metre);
            wheel.target_rate = direction.asked * direction.last < 0 ? 0 : direction.asked;
            yaw.target_rate = lqr_turns(motion.turn_rate) * turns_per_radian;
            yaw.target += lqr_turns(turn) * turns_per_radian;
        }
        jp_reference_update(&reference, config);
        wheel.target_rate = rested_speed(&direction, wheel.target_rate, config->rest_ticks);
        exact_follow(&wheel, config->travel_bandwidth / 65536.0, dt);
        exact_follow(&yaw, config->yaw_bandwidth / 65536.0, dt);
        angle = fmax(angle, fabs(remainder(lqr_phase_turns(reference.wheel.angle) - wheel.angle, 256)));
        angle = fmax(angle, fabs(remainder(lqr_phase_turns(reference.yaw.angle) - yaw.angle, 256)));
        rate = fmax(rate, fabs(lqr_turns(reference.wheel.rate) - wheel.rate));
        rate = fmax(rate, fabs(lqr_turns(reference.yaw.rate) - yaw.rate));
    }
    record(angle_name, "turn", 2e-5, angle);
    record(rate_name, "turn/s", 2e-5, rate);
}

static void test_reference(void)
{
    test_reference_of(&jp_robot_gao2018.reference, "gao2018: reference angle", "gao2018: reference rate");
    test_reference_of(&jp_robot_courier24.reference, "courier24: reference angle", "courier24: reference rate");
}

/* Odometry */

/** An hour at about 1 m/s in random bends. */
static void test_odometry(void)
{
    struct jp_motion_state state = {0};
    struct jp_odometry odometry;
    struct random random;
    double x = 0, y = 0, rate = 0, worst = 0;

    random_init(&random, options.seed);
    jp_odometry_start(&odometry, jp_robot_courier24.metres_per_turn, &state);
    for (int tick = 0; tick < 3600000; tick++) {
        rate = fmin(fmax(rate + random_uniform(&random, -1e-3, 1e-3), -0.1), 0.1);

        const int64_t wheel = (int64_t)(random_uniform(&random, -0.001, 0.005) * TURN_PHASE);
        const double heading = 2 * PI * lqr_phase_turns(state.yaw % JP_PHASE_TURN);
        const int64_t turned = (int64_t)(rate / 1000 * TURN_PHASE);
        const double mean = heading + PI * lqr_phase_turns((jp_phase)turned);
        const double way = lqr_phase_turns((jp_phase)wheel) * lqr_turns(odometry.metres_per_turn);

        state.wheel += (jp_phase)wheel;
        state.yaw += (jp_phase)turned;
        jp_odometry_update(&odometry, &state);
        x += way * cos(mean);
        y += way * sin(mean);
        worst = fmax(worst, hypot((double)odometry.x * 0x1p-32 - x, (double)odometry.y * 0x1p-32 - y));
    }
    record("odometry after an hour", "m", 0.001, worst);
}

/* Meter */

static void test_meter_of(const struct jp_meter_config *config, const char *name, double volts, double bound)
{
    struct jp_meter meter;
    struct random random;
    double model = 0, battery = 0, spent = 0, worst = 0;

    random_init(&random, options.seed);
    jp_meter_start(&meter, config);
    for (uint32_t tick = 1; tick <= 600000; tick++) {
        const struct jp_voltages voltages = {.left = (jp_q16)(random_uniform(&random, -volts, volts) * 65536),
                                             .right = (jp_q16)(random_uniform(&random, -volts, volts) * 65536)};
        const struct jp_sensors sensors = {.current_left = (jp_q16)(random_uniform(&random, -5, 5) * 65536),
                                           .current_right = (jp_q16)(random_uniform(&random, -5, 5) * 65536)};
        const double u[2] = {lqr_volts(voltages.left), lqr_volts(voltages.right)};
        const double power = lqr_volts(config->electronics_power);
        const double motors = (u[0] * u[0] + u[1] * u[1]) / lqr_volts(config->motor_resistance);
        const double delivered = u[0] * lqr_volts(sensors.current_left) + u[1] * lqr_volts(sensors.current_right);

        jp_meter_update(&meter, &voltages, &sensors);
        model += (motors + power) / config->tick_rate;
        battery += (delivered + power) / config->tick_rate;
        spent += (fabs(delivered) + power) / config->tick_rate;

        const double seconds = (double)tick / config->tick_rate;

        worst = fmax(worst, fabs((double)meter.model * 0x1p-32 - model) / fmax(model, 2 * seconds));
        worst = fmax(worst, fabs((double)meter.battery * 0x1p-32 - battery) / fmax(spent, 2 * seconds));
    }
    record(name, "of the sum, or of 2 W", bound, worst);
}

static void test_meter(void)
{
    static const struct jp_meter_config low = {.tick_rate = 10000, .motor_resistance = JP_Q16(0.01)};
    static const struct jp_meter_config high = {.tick_rate = 10000, .motor_resistance = JP_Q16(8000)};

    test_meter_of(&jp_robot_gao2018.meter, "gao2018: meter", 10, 1e-6);
    test_meter_of(&jp_robot_courier24.meter, "courier24: meter", 24, 1e-6);
    test_meter_of(&jp_robot_courier24.meter, "courier24: meter at small voltages", 0.01, 1e-6);
    test_meter_of(&low, "10 mOhm at 10 kHz: meter", 0.05, 1e-6);
    test_meter_of(&high, "8 kOhm at 10 kHz: meter", 1000, 1e-6);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);

    const int failures = RUN_PROPERTY(options, NULL);

    for (size_t i = 0; i < result_count; i++) {
        printf("%-36s %.3g of %g %s\n", results[i].name, results[i].worst, results[i].bound, results[i].unit);
    }
    return failures;
}
