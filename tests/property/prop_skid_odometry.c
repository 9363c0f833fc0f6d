/* Odometry of skid steer and differential drive: against exact kinematics, and on random drives of robots and grounds
 * that nobody has seen. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "tests/bench/statistics.h"
#include "tests/support/check.h"
#include "tests/support/options.h"
#include "tests/support/skid_odometry_config.h"
#include "tests/support/skid_random_drive.h"
#include "unity.h"

#define METRE 4294967296.0
#define Q24   16777216.0
#define TURN  72057594037927936.0

/* Way of a drive, m, and its bar, share of it. */
#define WAY       100
#define ERROR_MAX 0.01
#define WORST_MAX 0.04

/* Drives whose mean is asked for. */
#define MANY 20

#define DRIVES_MAX 1000

static const struct options defaults = {.count = 1, .seed = 2018};
static struct options options;

static struct skid_steer_model zhang;
static struct skid_steer_model burger;
static struct jp_skid_odometry_config config;
static struct jp_skid_odometry odometry;
static struct jp_sensors sensors;

void setUp(void)
{
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/zhang2018.cfg", &zhang));
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/burger.cfg", &burger));
}

void tearDown(void)
{
}

/* Of Q32. */
static double metres(int64_t fixed)
{
    return (double)fixed / METRE;
}

static double heading_of(const struct jp_skid_odometry *from)
{
    return (double)from->heading / TURN * 2 * M_PI;
}

/* ---- Configuration ---- */

static void test_configurations_of_both_robots_are_sound(void)
{
    const struct skid_steer_model *models[] = {&zhang, &burger};

    for (int i = 0; i < 2; i++) {
        const char *field = "";
        config = skid_odometry_config_of(models[i]);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_odometry_check(&config, &field));
    }
}

/* On the spot the plant turns by the ratio that the configuration foretells. */
static void test_ratio_is_that_of_the_plant(void)
{
    const struct skid_steer_model *models[] = {&zhang, &burger};
    static const struct planar_pose origin = {0, 0, 0};
    static const struct skid_ground level = {NULL, NULL};

    for (int i = 0; i < 2; i++) {
        const struct skid_steer_model *model = models[i];
        const double duty = 0.3;
        struct skid_plant plant;
        struct skid_input input = {.duty = {-duty, duty}, .driven = true};
        skid_plant_init(&plant, model, &level, &origin);
        skid_plant_step(&plant, &input, 3);
        const double wheels = model->wheel.radius_m *
                              (plant.state.sides[SKID_RIGHT].rate - plant.state.sides[SKID_LEFT].rate) /
                              model->body.width_m;
        check_near(plant.state.turn_rate / wheels, skid_pivot_of(model).ratio, 0.003, "ratio on the spot");
    }
}

/* ---- Exact kinematics ---- */

/* A robot without slip that has the configured ratio or another one: what encoders and gyro show of a motion. */
struct exact {
    double x;
    double y;
    double heading;
    double left; /* way of the treads, m */
    double right;
};

static void exact_move(struct exact *exact, double width, double ratio, double speed, double turn_rate, double seconds)
{
    const int parts = 16;

    for (int i = 0; i < parts; i++) {
        const double h = seconds / parts;
        const double mean = exact->heading + turn_rate * h / 2;
        exact->x += speed * cos(mean) * h;
        exact->y += speed * sin(mean) * h;
        exact->heading += turn_rate * h;
    }
    exact->left += (speed - turn_rate / ratio * width / 2) * seconds;
    exact->right += (speed + turn_rate / ratio * width / 2) * seconds;
}

static void exact_sense(const struct exact *exact, double counts_per_metre, double turn_rate, double bias)
{
    sensors = (struct jp_sensors){
        .encoder_left = (uint32_t)(int64_t)floor(exact->left * counts_per_metre),
        .encoder_right = (uint32_t)(int64_t)floor(exact->right * counts_per_metre),
        .yaw_rate = (jp_turns_per_s)lround((turn_rate / (2 * M_PI) + bias) * Q24),
        .accel_z = JP_Q24_ONE,
    };
}

/* Level ground, no creep: the pose is that of the exact kinematics, whatever ratio and bias are. */
static void test_pose_is_exact_without_slip(void)
{
    struct random noise;

    random_init(&noise, options.seed);
    for (unsigned long run = 0; run < 20 * options.count; run++) {
        const struct skid_steer_model *model = run % 2 == 0 ? &zhang : &burger;
        struct exact exact = {.x = 0};
        config = skid_odometry_config_of(model);
        config.creep = 0;
        config.turn_creep_along = 0;
        config.turn_creep_across = 0;
        config.scale_deviation = 0;
        config.ratio_deviation = JP_Q24(0.1);
        const double ratio = config.ratio / Q24 * random_uniform(&noise, 0.8, 1.2);
        const double bias = random_uniform(&noise, -1, 1) * config.bias_deviation / Q24;
        const double counts = model->encoder.counts_per_turn / (2 * M_PI * model->wheel.radius_m);
        const double tick = 1.0 / model->control.rate_hz;
        double way = 0;
        exact_sense(&exact, counts, 0, bias);
        jp_skid_odometry_start(&odometry, &config, &sensors);
        for (int piece = 0; piece < 12; piece++) {
            const double speed = piece == 0 ? 0 : random_uniform(&noise, -0.2, 1) * model->lattice.speed_m_s;
            const double rate = piece == 0 ? 0 : random_uniform(&noise, -1, 1) * model->lattice.turn_rate_rad_s;
            for (int i = 0; i < 4 * model->control.rate_hz; i++) {
                exact_move(&exact, model->body.width_m, ratio, speed, rate, tick);
                exact_sense(&exact, counts, rate, bias);
                jp_skid_odometry_update(&odometry, &config, &sensors);
                way += fabs(speed) * tick;
            }
        }
        const double steps = config.step_ticks * tick * model->lattice.speed_m_s; /* it may be a step late */
        const double error = hypot(metres(odometry.x) - exact.x, metres(odometry.y) - exact.y);
        check_below(error, 0.001 * way + steps, "position, m");
        check_below(fabs(remainder(heading_of(&odometry) - exact.heading, 2 * M_PI)),
                    0.002 + model->lattice.turn_rate_rad_s * config.step_ticks * tick, "heading, rad");
    }
}

/* ---- Any numbers ---- */

struct field {
    int32_t low;
    int32_t high;
    size_t offset;
};

#define FIELD(member, low, high)                                                                                       \
    {                                                                                                                  \
        (low), (high), offsetof(struct jp_skid_odometry_config, member)                                                \
    }

/* As the header has them. */
static const struct field fields[] = {
    FIELD(tick_rate, 100, 10000),
    FIELD(step_ticks, 6, 32),
    FIELD(way_per_count, 1 << 12, 1 << 30),
    FIELD(turn_per_count, 1 << 12, 1 << 30),
    FIELD(ratio, JP_Q24(0.1), JP_Q24(1.5)),
    FIELD(ratio_deviation, JP_Q24(0.0001), JP_Q24(0.5)),
    FIELD(scale_deviation, 0, JP_Q24(0.1)),
    FIELD(bias_deviation, 256, JP_Q24(0.1)),
    FIELD(bias_memory, 1000, 100000000),
    FIELD(gyro_noise, 16, JP_Q24(0.1)),
    FIELD(way_noise, 256, JP_Q24(0.1)),
    FIELD(turn_noise, JP_Q24(0.001), JP_Q24(1)),
    FIELD(tilt_deviation, JP_Q24(0.005), JP_Q24(0.5)),
    FIELD(tilt_change, JP_Q24(0.001), JP_Q24(1)),
    FIELD(accel_noise, JP_Q24(0.0005), JP_Q24(0.1)),
    FIELD(accel_offset, 0, JP_Q24(0.5)),
    FIELD(ratio_growth, 0, JP_Q24(16)),
    FIELD(creep, 0, JP_Q24(1)),
    FIELD(turn_creep_along, 0, JP_Q24(8)),
    FIELD(turn_creep_across, 0, JP_Q24(8)),
    FIELD(turn_shift_along, 0, JP_Q24(8)),
    FIELD(turn_shift_across, 0, JP_Q24(8)),
    FIELD(turn_slide_most, 0, JP_Q24(4)),
    FIELD(caster_drag, 0, JP_Q24(0.2)),
    FIELD(turn_force, 0, JP_Q24(2)),
    FIELD(force_per_ampere, 0, JP_Q24(16)),
    FIELD(efficiency, JP_Q24(0.1), JP_Q24(1)),
    FIELD(rolling, 0, JP_Q24(0.5)),
    FIELD(way_deviation, 0, JP_Q24(0.1)),
    FIELD(way_drift, 0, JP_Q24(0.5)),
    FIELD(turn_drift, 0, JP_Q24(0.5)),
};

/* Now and then an end of the range, else any number whose size has any order. */
static int32_t any_between(struct random *noise, int32_t low, int32_t high)
{
    const double kind = random_uniform(noise, 0, 4);
    const double span = (double)high - low;

    if (kind < 2) {
        return kind < 1 ? low : high;
    }
    return low + (int32_t)fmin(span * pow(2, -random_uniform(noise, 0, 24)), span);
}

static int32_t any_reading(struct random *noise)
{
    const double size = pow(2, random_uniform(noise, 0, 31));

    return (int32_t)skid_either(noise, size);
}

/* The sanitizers watch. */
static void test_any_numbers_do_not_overflow(void)
{
    struct random noise;
    struct jp_skid_estimate estimate;

    random_init(&noise, options.seed);
    for (unsigned long run = 0; run < 300 * options.count; run++) {
        const char *field = "";
        for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
            const int32_t value = any_between(&noise, fields[i].low, fields[i].high);
            memcpy((char *)&config + fields[i].offset, &value, sizeof value);
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_odometry_check(&config, &field));
        sensors = (struct jp_sensors){.accel_x = any_reading(&noise)};
        jp_skid_odometry_start(&odometry, &config, &sensors);
        for (int tick = 0; tick < 2000; tick++) {
            sensors.encoder_left += (uint32_t)any_reading(&noise);
            sensors.encoder_right += (uint32_t)any_reading(&noise);
            sensors.yaw_rate = any_reading(&noise);
            sensors.pitch_rate = any_reading(&noise);
            sensors.accel_x = any_reading(&noise);
            sensors.current_left = any_reading(&noise);
            sensors.current_right = any_reading(&noise);
            jp_skid_odometry_update(&odometry, &config, &sensors);
        }
        jp_skid_odometry_estimate(&odometry, &config, &estimate);
        TEST_ASSERT_TRUE(estimate.gyro_bias_deviation >= 0 && estimate.steering_ratio_deviation >= 0);
        TEST_ASSERT_TRUE(estimate.xx >= 0 && estimate.yy >= 0);
    }
}

/* ---- Random drives ---- */

/* What a drive of a robot led to. */
struct results {
    const char *name;
    double error[DRIVES_MAX]; /* share of the way */
    double heading[DRIVES_MAX];
    double normalised;    /* sum of squares of the position's error over its covariance: 2 a drive */
    unsigned long inside; /* drives in the ellipse that holds 95 % */
    unsigned long count;
};

static struct results of_zhang = {.name = "zhang2018"};
static struct results of_burger = {.name = "burger"};

/* χ² of two degrees of freedom, 95 %. */
#define INSIDE 5.991

static void add_result(struct results *results, double x, double y, double heading, double way)
{
    struct jp_skid_estimate estimate;

    jp_skid_odometry_estimate(&odometry, &config, &estimate);
    const double xx = metres(estimate.xx);
    const double xy = metres(estimate.xy);
    const double yy = metres(estimate.yy);
    const double normalised = (yy * x * x - 2 * xy * x * y + xx * y * y) / (xx * yy - xy * xy);

    results->error[results->count] = hypot(x, y) / way;
    results->heading[results->count] = fabs(heading);
    results->normalised += normalised;
    results->inside += normalised <= INSIDE;
    results->count++;
    if (options.verbose) {
        (void)printf("%s: %.3f %% of the way, heading %.4f rad, normalised square %.2f\n", results->name,
                     100 * hypot(x, y) / way, heading, normalised);
        (void)fflush(stdout);
    }
}

static void drive(const struct skid_steer_model *file, uint64_t seed, struct results *results)
{
    static struct skid_drive trip;
    struct random noise;

    random_init(&noise, seed);
    const struct skid_steer_model model = skid_random_robot(file, &noise);
    config = skid_odometry_config_of(file);
    skid_drive_start(&trip, &model, config.ratio / Q24, file->limits.slope_deg / 2, seed);
    /* As long as the plant's fastest rate allows. */
    trip.world.plant.step = SKID_STEP_RATE_MAX / skid_plant_rate(&model);
    skid_drive_tick(&trip, &sensors);
    jp_skid_odometry_start(&odometry, &config, &sensors);
    while (trip.way < WAY) {
        skid_drive_tick(&trip, &sensors);
        jp_skid_odometry_update(&odometry, &config, &sensors);
        TEST_ASSERT_TRUE(odometry.internal.tilt.variance[JP_SKID_TILT_AHEAD] > 0 &&
                         odometry.internal.tilt.variance[JP_SKID_TILT_LEFT] > 0);
    }
    TEST_ASSERT_FALSE(trip.world.plant.tipped);
    const struct planar_pose pose = skid_plant_pose(&trip.world.plant);
    add_result(results, metres(odometry.x) - pose.x, metres(odometry.y) - pose.y,
               remainder(heading_of(&odometry) - pose.heading, 2 * M_PI), trip.way);
}

static double part_of(double *values, size_t count, double part)
{
    qsort(values, count, sizeof *values, statistics_compare);
    return values[(size_t)(part * (double)(count - 1) + 0.5)];
}

static void drive_all(const struct skid_steer_model *file, struct results *results)
{
    results->count = 0;
    results->inside = 0;
    results->normalised = 0;
    for (unsigned long run = 0; run < options.count && run < DRIVES_MAX; run++) {
        drive(file, options.seed + 1000 * run, results);
    }
    (void)printf(
        "%s, %lu drives of %d m: position mean %.3f %%, 95 %% %.3f %%, worst %.3f %% of the way; heading mean %.4f, "
        "worst %.4f rad; normalised square %.2f of 2, %lu inside the 95 %% ellipse\n",
        results->name, results->count, WAY, 100 * mean(results->error, results->count),
        100 * part_of(results->error, results->count, 0.95), 100 * part_of(results->error, results->count, 1),
        mean(results->heading, results->count), part_of(results->heading, results->count, 1),
        results->normalised / (double)results->count, results->inside);
    if (results->count >= MANY) {
        check_below(mean(results->error, results->count), ERROR_MAX, "position, share of the way, mean");
    }
    check_below(part_of(results->error, results->count, 1), WORST_MAX, "position, share of the way, worst");
}

static void test_random_drives_of_zhang2018(void)
{
    drive_all(&zhang, &of_zhang);
}

static void test_random_drives_of_burger(void)
{
    drive_all(&burger, &of_burger);
}

static void add_figures_of(json_t *figures, struct results *results)
{
    const char *command = "make figures";

    figures_add(figures, command, 100 * mean(results->error, results->count), "%", at_most(100 * ERROR_MAX),
                "%s, position after 100 m by wheels and gyro: error over the way, mean of %lu random drives",
                results->name, results->count);
    figures_add(figures, command, 100 * part_of(results->error, results->count, 0.95), "%", no_bar,
                "%s, position after 100 m by wheels and gyro: error over the way, 95 %% of %lu random drives",
                results->name, results->count);
    figures_add(figures, command, 100 * part_of(results->error, results->count, 1), "%", at_most(100 * ERROR_MAX),
                "%s, position after 100 m by wheels and gyro: error over the way, worst of %lu random drives",
                results->name, results->count);
    figures_add(figures, command, 100 * (double)results->inside / (double)results->count, "%", at_least(93),
                "%s, position after 100 m by wheels and gyro: inside the stated 95 %% ellipse, of %lu random drives",
                results->name, results->count);
}

static void add_figures(json_t *figures)
{
    add_figures_of(figures, &of_zhang);
    add_figures_of(figures, &of_burger);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, defaults);
    return RUN_PROPERTY(options, add_figures);
}
