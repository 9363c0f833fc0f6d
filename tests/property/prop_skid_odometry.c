/* Odometry of skid steer and differential drive: against exact kinematics, and on random drives of robots and grounds
 * that nobody has seen. */
#include <stdio.h>

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
        const double wheels = model->wheel.radius_m * (plant.state.sides[SKID_RIGHT].rate -
                                                       plant.state.sides[SKID_LEFT].rate) / model->body.width_m;
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
        const double error = hypot(odometry.x / METRE - exact.x, odometry.y / METRE - exact.y);
        check_below(error, 0.001 * way + steps, "position, m");
        check_below(fabs(remainder(heading_of(&odometry) - exact.heading, 2 * M_PI)),
                    0.002 + model->lattice.turn_rate_rad_s * config.step_ticks * tick, "heading, rad");
    }
}

/* ---- Random drives ---- */

struct result {
    double error; /* m */
    double heading;
    double way;
};

static struct result drive(const struct skid_steer_model *file, uint64_t seed)
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
    }
    TEST_ASSERT_FALSE(trip.world.plant.tipped);
    const struct planar_pose pose = skid_plant_pose(&trip.world.plant);
    return (struct result){
        .error = hypot(odometry.x / METRE - pose.x, odometry.y / METRE - pose.y),
        .heading = remainder(heading_of(&odometry) - pose.heading, 2 * M_PI),
        .way = trip.way,
    };
}
