/* The plant of skid steer and differential drive: its energy ledger over random drives, and known motions. */
#include <stdio.h>

#include "sim/base/fingerprint.h"
#include "sim/base/random.h"
#include "sim/skid_steer/skid_plant.h"
#include "tests/support/check.h"
#include "tests/support/options.h"
#include "unity.h"

#define TICK 0.002

/* Of the turnover. */
#define LEDGER_ERROR 1e-3

static struct options options = {.count = 60, .seed = 2018};
static struct random noise;
static double worst_ledger;

static struct skid_steer_model zhang;
static struct skid_plant plant;

static const struct planar_pose origin = {0, 0, 0};
static const struct skid_ground level = {NULL, NULL};

void setUp(void)
{
    TEST_ASSERT_TRUE(skid_steer_load("sim/robots/zhang2018.cfg", &zhang));
    random_init(&noise, options.seed);
    skid_plant_init(&plant, &zhang, &level, &origin);
}

void tearDown(void)
{
}

static void drive(const struct skid_input *input, double seconds)
{
    for (int tick = 0; tick < (int)(seconds / TICK + 0.5); tick++) {
        skid_plant_step(&plant, input, TICK);
    }
}

/* ---- Energy ledger ---- */

/* Hills of 4 to 12 m with slopes up to 20°. */
struct hills {
    double height[3];
    double number[3]; /* rad/m */
    double turn[3];
};

static struct skid_ground_point on_hills(const void *context, double x, double y)
{
    const struct hills *hills = context;
    struct skid_ground_point point = {0, 0, 0};

    for (int i = 0; i < 3; i++) {
        const double ahead = hills->number[i] * cos(hills->turn[i]);
        const double across = hills->number[i] * sin(hills->turn[i]);
        const double phase = ahead * x + across * y;
        point.elevation += hills->height[i] * sin(phase);
        point.slope_x += hills->height[i] * ahead * cos(phase);
        point.slope_y += hills->height[i] * across * cos(phase);
    }
    return point;
}

static struct hills random_hills(double steepest)
{
    struct hills hills;

    for (int i = 0; i < 3; i++) {
        hills.number[i] = 2 * M_PI / random_uniform(&noise, 4, 12);
        hills.turn[i] = random_uniform(&noise, -M_PI, M_PI);
        hills.height[i] = random_uniform(&noise, 0, steepest / 3) / hills.number[i];
    }
    return hills;
}

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
           l->rolling + l->impact + fabs(skid_plant_potential_energy(&plant));
}

static void test_ledger_closes_over_random_drives(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const struct hills hills = random_hills(run % 4 == 0 ? 1.2 : 0.35);
        const struct skid_ground ground = {on_hills, &hills};
        const struct planar_pose pose = {0, 0, random_uniform(&noise, -M_PI, M_PI)};
        struct skid_input input = random_input();

        skid_plant_init(&plant, &zhang, &ground, &pose);
        plant.state.forward = random_uniform(&noise, -1, 1);
        plant.state.left = random_uniform(&noise, -0.5, 0.5);
        plant.state.turn_rate = random_uniform(&noise, -1, 1);
        const double start = skid_plant_kinetic_energy(&plant);
        for (int tick = 0; tick < 5000; tick++) {
            if (tick % 500 == 0) {
                input = random_input();
            }
            const struct skid_ledger before = plant.state.ledger;
            skid_plant_step(&plant, &input, TICK);
            const struct skid_ledger *l = &plant.state.ledger;
            TEST_ASSERT_TRUE_MESSAGE(l->copper >= before.copper && l->bridge >= before.bridge &&
                                         l->supply >= before.supply && l->electronics > before.electronics,
                                     "what is heat does not come back");
        }
        const double error = fabs(skid_plant_residual(&plant, start)) / turnover();
        worst_ledger = fmax(worst_ledger, error);
        check_below(error, LEDGER_ERROR, "energy lost or won, of the turnover");
    }
}

static void test_at_rest_it_stays(void)
{
    const struct skid_input shorted = {.driven = true};
    const struct skid_state start = plant.state;

    drive(&shorted, 5);
    check_near(start.x, plant.state.x, 1e-12, "x");
    check_near(5 * zhang.electronics.power_w, plant.state.ledger.electronics, 1e-6, "J of the electronics");
}

static void add_figures(json_t *figures)
{
    figures_add(
        figures, "make figures", worst_ledger, "", at_most(LEDGER_ERROR),
        "skid steer and differential drive: energy that the plant's ledger misses, of the turnover, worst of %lu "
        "drives",
        options.count);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);

    const int failures = RUN_PROPERTY(options, add_figures);

    printf("seed %llu: ledger misses at most %.3g of the turnover\n", options.seed, worst_ledger);
    return failures;
}
