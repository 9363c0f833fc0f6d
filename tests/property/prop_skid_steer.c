/*
 * joulepath/skid_steer.h against the model in double, over random robots and motions; the robot file's calibration; the
 * lattice's sum of base and moves against the model along the way.
 */
#include <joulepath/skid_steer.h>
#include <joulepath/tables.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "sim/base/random.h"
#include "sim/lattice/lattice_costs.h"
#include "sim/lattice/lattice_generate.h"
#include "sim/skid_steer/skid_steer_model.h"
#include "unity.h"

#define SEED    2018
#define MOTIONS 200000
#define Q16     65536.0
#define Q24     16777216.0

/* Stated in joulepath/skid_steer.h. */
#define ERROR_J     0.001
#define ERROR_SHARE 1e-5

#define ROBOT_FILE "sim/robots/zhang2018.cfg"

static struct lattice_robot robot;

void setUp(void)
{
}

void tearDown(void)
{
}

static jp_q24 q24(double x)
{
    return (jp_q24)lround(x * Q24);
}

static jp_q16 q16(double x)
{
    return (jp_q16)lround(x * Q16);
}

/* The double model of the same numbers that the core has. */
static struct skid_steer_model model_of(const struct jp_skid_steer_config *config)
{
    return (struct skid_steer_model){
        .body = {.width_m = config->width / Q24,
                 .wheelbase_m = config->wheelbase / Q24,
                 .mass_kg = config->weight / Q16 / STANDARD_GRAVITY},
        .wheel = {.radius_m = config->wheel_radius / Q24},
        .motor = {.torque_constant = config->torque_per_ampere / Q16 / (config->efficiency / Q24),
                  .resistance_ohm = config->resistance / Q24,
                  .gear_ratio = 1,
                  .efficiency = config->efficiency / Q24,
                  .recuperation = config->recuperation / Q24},
        .ground = {.friction = config->friction / Q24, .rolling = config->rolling / Q24},
        .electronics = {.power_w = config->electronics_power / Q16},
        .lattice = {.distance_j_per_m = config->distance_energy / Q16},
    };
}

/* From a model car to a tractor; motors that such a robot could have. */
static struct jp_skid_steer_config random_config(struct random *random)
{
    const double weight = exp(random_uniform(random, log(10), log(8000)));
    const double radius = random_uniform(random, 0.03, 0.4);

    return (struct jp_skid_steer_config){
        .wheel_radius = q24(radius),
        .width = q24(random_uniform(random, 0.1, 2)),
        .wheelbase = q24(random_uniform(random, 0.1, 2)),
        .weight = q16(weight),
        .rolling = q24(random_uniform(random, 0.005, 0.2)),
        .friction = q24(random_uniform(random, 0.1, 1.2)),
        .torque_per_ampere = q16(weight * radius / random_uniform(random, 5, 20)),
        .resistance = q24(random_uniform(random, 0.02, 2)),
        .efficiency = q24(random_uniform(random, 0.3, 1)),
        .recuperation = q24(random_uniform(random, 0, 1)),
        .electronics_power = q16(random_uniform(random, 0.1, 50)),
        .distance_energy = q16(random_uniform(random, 0, 500)),
    };
}

static double random_speed(struct random *random, double least, double most)
{
    const double size = exp(random_uniform(random, log(least), log(most)));
    return random_uniform(random, 0, 1) < 0.5 ? -size : size;
}

/* A tenth of them straight, a tenth on the spot. */
static struct jp_motion random_motion(struct random *random)
{
    const double choice = random_uniform(random, 0, 1);
    struct jp_motion motion = {q24(random_speed(random, 0.01, 2)), q24(random_speed(random, 0.01, 2))};
    if (choice < 0.1) {
        motion.turn_rate = 0;
    } else if (choice < 0.2) {
        motion.speed = 0;
    }
    return motion;
}

/* The magnitudes of the terms that make the energy, J. */
static double terms_of(const struct skid_steer_model *model, const struct skid_steer_motion *motion, double duration)
{
    const struct skid_steer_sides torques = skid_steer_torques(model, motion);
    const struct skid_steer_sides speeds = skid_steer_wheel_speeds(model, motion);
    const double kt = model->motor.torque_constant * model->motor.gear_ratio * model->motor.efficiency;
    const double loss = (torques.left * torques.left + torques.right * torques.right) / (kt * kt);
    const double work = fabs(torques.left * speeds.left) + fabs(torques.right * speeds.right);
    const double way = fabs(motion->speed) * duration;
    const double weight = model->body.mass_kg * STANDARD_GRAVITY;

    return (work / model->motor.efficiency + loss * model->motor.resistance_ohm + model->electronics.power_w) *
               duration +
           model->lattice.distance_j_per_m * way + model->ground.friction * weight * fabs(motion->grade) * way;
}

/* Worst share of the stated bound. */
static double compare(const struct jp_skid_steer_config *config, struct random *random, unsigned *counted)
{
    const struct skid_steer_model model = model_of(config);
    const struct jp_motion motion = random_motion(random);
    const jp_q16 duration = q16(random_uniform(random, 0.05, 20));
    const double seconds = duration / Q16;
    const double way = fabs(motion.speed / Q24) * seconds;
    const jp_q24 rise = q24(random_uniform(random, -0.3, 0.3) * way);
    const struct skid_steer_motion exact = {motion.speed / Q24, motion.turn_rate / Q24, way > 0 ? rise / Q24 / way : 0};
    const double bound = ERROR_J + ERROR_SHARE * terms_of(&model, &exact, seconds);
    double worst = 0;

    for (enum jp_cost_kind kind = JP_COST_PHYSICAL; kind <= JP_COST_PAPER; kind++) {
        jp_q16 energy = 0;
        const enum jp_status status = jp_skid_steer_energy(config, kind, &motion, rise, duration, &energy);
        if (status == JP_OK) {
            worst = fmax(worst, fabs(energy / Q16 - skid_steer_energy(&model, kind, &exact, seconds)) / bound);
            (*counted)++;
        } else {
            TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, status);
        }
    }
    return worst;
}

static void test_energy_of_random_robots(void)
{
    struct random random;
    double worst = 0;
    unsigned counted = 0;

    random_init(&random, SEED);
    for (int i = 0; i < MOTIONS; i++) {
        const struct jp_skid_steer_config config = random_config(&random);
        const char *field = NULL;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_steer_check(&config, &field));
        worst = fmax(worst, compare(&config, &random, &counted));
    }
    printf("seed %d: %u energies of random robots, worst error %.3f of the bound\n", SEED, counted, worst);
    TEST_ASSERT_TRUE(counted > MOTIONS);
    TEST_ASSERT_TRUE(worst <= 1);
}

static void test_energy_of_zhang2018(void)
{
    struct random random;
    double worst = 0;
    unsigned counted = 0;

    random_init(&random, SEED + 1);
    for (int i = 0; i < MOTIONS; i++) {
        worst = fmax(worst, compare(&jp_skid_steer_zhang2018, &random, &counted));
    }
    printf("seed %d: %u energies of zhang2018, worst error %.3f of the bound\n", SEED + 1, counted, worst);
    TEST_ASSERT_TRUE(worst <= 1);
}

static void test_wheel_speeds_and_torques(void)
{
    struct random random;

    random_init(&random, SEED + 2);
    for (int i = 0; i < MOTIONS; i++) {
        const struct jp_skid_steer_config config = random_config(&random);
        const struct skid_steer_model model = model_of(&config);
        const struct jp_motion motion = random_motion(&random);
        const jp_q24 grade = q24(random_uniform(&random, -0.3, 0.3));
        const struct skid_steer_motion exact = {motion.speed / Q24, motion.turn_rate / Q24, grade / Q24};
        const struct skid_steer_sides speeds = skid_steer_wheel_speeds(&model, &exact);
        const struct skid_steer_sides torques = skid_steer_torques(&model, &exact);
        struct jp_skid_steer_sides core;

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_steer_wheel_speeds(&config, &motion, &core));
        TEST_ASSERT_TRUE(fabs(core.left / Q16 - speeds.left) <= 2e-5);
        TEST_ASSERT_TRUE(fabs(core.right / Q16 - speeds.right) <= 2e-5);
        if (fabs(speeds.left) > 1e-4 && fabs(speeds.right) > 1e-4) { /* else a side may stand in one of the two */
            const double turning = model.body.wheelbase_m / model.body.width_m;
            const double bound =
                1e-4 + 2e-5 * (1 + turning) * model.body.mass_kg * STANDARD_GRAVITY * model.wheel.radius_m;
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_steer_torques(&config, &motion, grade, &core));
            TEST_ASSERT_TRUE(fabs(core.left / Q16 - torques.left) <= bound);
            TEST_ASSERT_TRUE(fabs(core.right / Q16 - torques.right) <= bound);
        }
    }
}

/* The file's calibrated values follow from its others. */
static void test_calibration(void)
{
    const struct skid_steer_model *model = &robot.skid_steer;
    const struct skid_steer_motion climb = {model->limits.speed_m_s, 0, robot.grade_max};
    const struct skid_steer_motion level = {model->lattice.speed_m_s, 0, 0};
    struct skid_steer_model longer = *model;
    longer.motor.gear_ratio *= 1.001;

    TEST_ASSERT_DOUBLE_WITHIN(1e-4, model->supply.voltage_v, skid_steer_voltages(model, &climb).left);
    TEST_ASSERT_TRUE(skid_steer_voltages(&longer, &climb).left > model->supply.voltage_v);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 2632.32 / 37.48, skid_steer_power(model, JP_COST_PHYSICAL, &level) / level.speed);
}

static void test_turning_costs_more_than_driving_straight(void)
{
    for (int i = 1; i <= 100; i++) {
        const struct skid_steer_motion turn = {0.5, i * 0.004, 0};
        const struct skid_steer_motion straight = {0.5, 0, 0};
        TEST_ASSERT_TRUE(skid_steer_power(&robot.skid_steer, JP_COST_PHYSICAL, &turn) >
                         skid_steer_power(&robot.skid_steer, JP_COST_PHYSICAL, &straight));
    }
}

/* The model's energy along a path on a plane, J, before any floor; gradients are rises over run. */
static double energy_along(const struct lattice *lattice, const struct lattice_primitive *primitive,
                           enum jp_cost_kind kind, double gradient_x, double gradient_y)
{
    const struct lattice_path *path = &primitive->path;
    const double speed = primitive->length_m / primitive->duration_s;
    double sum = 0;

    for (size_t i = 1; i < path->count; i++) {
        const struct lattice_pose *from = &path->poses[i - 1];
        const struct lattice_pose *to = &path->poses[i];
        const double dx = (to->x - from->x) * lattice->resolution_m;
        const double dy = (to->y - from->y) * lattice->resolution_m;
        const double duration = hypot(dx, dy) / speed;
        sum += robot.energy(&robot, kind,
                            &(struct lattice_motion){speed, (to->heading - from->heading) / duration,
                                                     gradient_x * dx + gradient_y * dy, duration});
    }
    return sum;
}

static const struct jp_primitive *entry_of(const struct lattice_primitive *primitive)
{
    const struct jp_lattice *table = &jp_lattice_zhang2018;

    for (unsigned i = table->first_from[primitive->start]; i < table->first_from[primitive->start + 1]; i++) {
        const struct jp_primitive *entry = &table->primitives[i];
        if (entry->end == primitive->end && entry->dx == primitive->dx && entry->dy == primitive->dy) {
            return entry;
        }
    }
    return NULL;
}

enum { PLANE = 16 };

/* A plane that rises by whole units of elevation a cell, so that nothing is rounded. */
static void make_plane(struct jp_terrain *terrain, void *block, size_t size, int rise_x, int rise_y)
{
    const struct jp_terrain_config config = {
        .width = PLANE, .height = PLANE, .resolution = JP_Q16(0.2), .has_elevation = true, .unknown_is_free = true};
    const char *field = NULL;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(terrain, &config, block, size, &field));
    for (int y = 0; y < PLANE; y++) {
        for (int x = 0; x < PLANE; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK,
                                  jp_terrain_set_elevation(terrain, x, y, (jp_elevation)(rise_x * x + rise_y * y)));
        }
    }
}

/* None of its steps leads down, where floors set in. */
static bool climbs(const struct jp_primitive *entry, int rise_x, int rise_y)
{
    for (unsigned i = 0; i < entry->move_count; i++) {
        const struct jp_cell_offset offset = jp_move_offsets[jp_lattice_zhang2018.moves[entry->first_move + i]];
        if (rise_x * offset.dx + rise_y * offset.dy < 0) {
            return false;
        }
    }
    return true;
}

struct error {
    double straight;
    double paper;
    double climbing;
    double least_climbing;
};

/* Errors of the table's sums, in cost units for straight primitives and else as shares. */
static void compare_sums(const struct lattice *lattice, int rise_x, int rise_y, struct error *worst)
{
    static uint64_t block[PLANE * PLANE];
    struct jp_terrain terrain;
    const double units_per_gradient = lattice->resolution_m * JP_ELEVATION_ONE;

    make_plane(&terrain, block, sizeof block, rise_x, rise_y);
    for (size_t i = 0; i < lattice->count; i++) {
        const struct lattice_primitive *primitive = &lattice->primitives[i];
        const struct jp_primitive *entry = entry_of(primitive);
        double sum[2];
        double exact[2];
        TEST_ASSERT_NOT_NULL(entry);
        if (entry->move_count == 0) {
            continue;
        }
        for (enum jp_cost_kind kind = JP_COST_PHYSICAL; kind <= JP_COST_PAPER; kind++) {
            const double energy =
                energy_along(lattice, primitive, kind, rise_x / units_per_gradient, rise_y / units_per_gradient);
            sum[kind] = jp_lattice_energy(&jp_lattice_zhang2018, kind, &terrain, entry, PLANE / 2, PLANE / 2);
            exact[kind] = JP_COST_PER_JOULE * energy;
        }
        const double floor = JP_COST_PER_JOULE * robot.electronics_power * primitive->duration_s;
        if (entry->move_count == 1 && entry->start == entry->end) {
            worst->straight = fmax(worst->straight, fabs(sum[0] - fmax(exact[0], floor)));
            worst->straight = fmax(worst->straight, fabs(sum[1] - fmax(exact[1], 1)));
        } else if (climbs(entry, rise_x, rise_y)) {
            worst->paper = fmax(worst->paper, fabs(sum[1] / exact[1] - 1));
            worst->climbing = fmax(worst->climbing, sum[0] / exact[0] - 1);
            worst->least_climbing = fmin(worst->least_climbing, sum[0] / exact[0] - 1);
        }
    }
}

/*
 * On a slope the sum differs from the model where turning is slower than straight driving, because the windings' loss
 * up the slope then lasts longer, and where a side that brakes on level ground does not brake uphill.
 */
static void test_sum_of_base_and_moves(void)
{
    struct lattice lattice = {.robot = &robot, .resolution_m = 0.2};
    struct error worst = {0};

    TEST_ASSERT_TRUE(lattice_generate(&lattice));
    for (int rise_x = -36; rise_x <= 36; rise_x += 4) {
        for (int rise_y = -36; rise_y <= 36; rise_y += 4) {
            compare_sums(&lattice, rise_x, rise_y, &worst);
        }
    }
    free(lattice.primitives);
    printf("sums of base and moves on planes: straight within %.3f cost units; turning uphill within %.2f %% (paper), "
           "%+.2f…%+.2f %% (physical)\n",
           worst.straight, 100 * worst.paper, 100 * worst.least_climbing, 100 * worst.climbing);
    TEST_ASSERT_TRUE(worst.straight <= 1.01);
    TEST_ASSERT_TRUE(worst.paper <= 0.085);
    TEST_ASSERT_TRUE(worst.climbing <= 0.17 && worst.least_climbing >= -0.075);
}

int main(void)
{
    UNITY_BEGIN();
    TEST_ASSERT_TRUE(lattice_robot_load(ROBOT_FILE, &robot));
    run_tests();
    return UNITY_END();
}
