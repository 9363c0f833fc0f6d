/*
 * joulepath/skid_energy.h against the same model in double, over random robots and pieces: energies, their derivatives
 * by each factor, chains, and the seed's formulas where both say the same.
 *
 * prop_skid_energy_model [--count N] [--seed S]
 * --count is the number of robots.
 */
#include <joulepath/skid_steer.h>
#include <joulepath/tables.h>
#include <math.h>
#include <stdio.h>

#include "tests/support/check.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/skid_energy_oracle.h"

enum { PIECES = 100 };

/* Stated in joulepath/skid_energy.h; of a unit. */
#define ERROR_SHARE     3e-5
#define ERROR_BY_WEIGHT 1e-6
#define ERROR_POWER     2e-4
#define ERROR_UNIT      0x1p-16
#define LEAST_SPEED     0.05

/* Of a factor, for differences; what they may miss. Where the energy bends more within a step, a side begins to brake.
 */
#define STEP         0.01
#define CHANGE_SHARE 5e-3

static struct options options = {.count = 2000, .seed = 1};
static struct jp_skid_energy_model model;
static double worst;

void setUp(void)
{
    begin_random(options.seed, 0);
}

void tearDown(void)
{
}

/* From a model car to a tractor. */
static struct jp_skid_energy_model random_model(void)
{
    const double efficiency = uniform(0.5, 0.95);
    const double weight = log_uniform(5, 8000);

    return (struct jp_skid_energy_model){
        .half_track = to_q24(uniform(0.05, 1.5)),
        .weight = to_q16(weight),
        .rolling = to_q24(uniform(0.005, 0.2)),
        .friction = to_q24(uniform(0.1, 1.2)),
        .turning = to_q24(uniform(0, 0.6)),
        .yielding = to_q24(uniform(0, 2)),
        .scrub = to_q24(uniform(0, 0.6)),
        .easing = to_q24(uniform(0, 3)),
        .bank_easing = to_q24(uniform(0, 3)),
        .tilting = to_q24(uniform(0, 1)),
        .inertia = to_q24(uniform(0.1, 0.2)),
        .turn_inertia = to_q24(uniform(0, 0.05)),
        .driving = to_q24(1 / efficiency),
        .braking = to_q24(uniform(0, efficiency)),
        .copper_driving = to_q16(weight * uniform(0.1, 2)),
        .copper_braking = to_q16(weight * uniform(0.05, 1)),
        .electronics_power = to_q16(log_uniform(0.5, 100)),
        .unit_exponent = (int32_t)below(9) - 4,
    };
}

static struct jp_motion random_motion(void)
{
    return (struct jp_motion){one_in(4) ? 0 : to_q24(uniform(-2, 2)), one_in(4) ? 0 : to_q24(uniform(-2, 2))};
}

static struct jp_skid_piece any_piece(void)
{
    struct jp_skid_piece piece = {.start = random_motion(),
                                  .grade = to_q24(uniform(-0.4, 0.4)),
                                  .bank = to_q24(uniform(-0.4, 0.4)),
                                  .duration = to_q16(log_uniform(0.05, 20))};

    piece.end = piece.start;
    if (one_in(3)) {
        piece.end.speed += to_q24(uniform(-0.5, 0.5) * q16(piece.duration));
        piece.end.turn_rate += to_q24(uniform(-0.5, 0.5) * q16(piece.duration));
        piece.end.speed = jp_clamp32(piece.end.speed, -JP_Q24(2), JP_Q24(2));
        piece.end.turn_rate = jp_clamp32(piece.end.turn_rate, -JP_Q24(2), JP_Q24(2));
    }
    return piece;
}

static double error_bound(const struct jp_skid_piece *piece)
{
    const struct oracle_energy expected = oracle_energy_of(&model, piece);

    return ERROR_SHARE * expected.terms + ERROR_BY_WEIGHT * expected.by_weight + ERROR_POWER * q16(piece->duration) +
           ldexp(ERROR_UNIT, model.unit_exponent);
}

/* The error is stated of speeds that are not next to 0. */
static bool is_stated(const struct jp_skid_piece *piece)
{
    const double v = fabs(q24(piece->start.speed) + q24(piece->end.speed)) / 2;
    const double w = fabs(q24(piece->start.turn_rate) + q24(piece->end.turn_rate)) / 2;

    return (v == 0 || v >= LEAST_SPEED) && (w == 0 || w >= LEAST_SPEED);
}

static struct jp_skid_piece random_piece(void)
{
    struct jp_skid_piece piece = any_piece();

    while (!is_stated(&piece)) {
        piece = any_piece();
    }
    return piece;
}

static double joules(int64_t units)
{
    return ldexp((double)units, model.unit_exponent - 16);
}

/* ---- Energies ---- */

/* Next to where a side stands rounding decides whether it is held or driven. */
static bool stands_on_one_side(const struct jp_skid_piece *piece)
{
    const double v = (q24(piece->start.speed) + q24(piece->end.speed)) / 2;
    const double across = q24(model.half_track) * (q24(piece->start.turn_rate) + q24(piece->end.turn_rate)) / 2;

    return fabs(fabs(v) - fabs(across)) < 1e-6;
}

static void check_piece(const struct jp_skid_piece *piece)
{
    const struct oracle_energy expected = oracle_energy_of(&model, piece);
    const double bound = error_bound(piece);
    struct jp_skid_drive drive = {0};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(&model, &drive, piece));
    worst = fmax(worst, fabs(joules(drive.energy) - expected.energy) / bound);
    check_near(expected.energy, joules(drive.energy), bound, "energy, J");
}

static void test_energies_are_those_of_exact_arithmetic(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        model = random_model();
        for (int j = 0; j < PIECES; j++) {
            const struct jp_skid_piece piece = random_piece();
            if (!stands_on_one_side(&piece)) {
                check_piece(&piece);
            }
        }
    }
    (void)printf("worst error of the core's energy: %.3f of what is stated\n", worst);
}

static void test_chains_are_sums_of_their_pieces(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        struct jp_skid_drive chain = {0};
        int64_t sum = 0;
        model = random_model();
        for (int j = 0; j < 10; j++) {
            const struct jp_skid_piece piece = random_piece();
            struct jp_skid_drive alone = {0};
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(&model, &chain, &piece));
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(&model, &alone, &piece));
            sum += alone.energy;
        }
        TEST_ASSERT_TRUE(chain.energy == sum);
    }
}

static void test_power_is_the_energy_of_a_second(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        const struct jp_motion motion = random_motion();
        const struct jp_skid_piece piece = {motion, motion, to_q24(uniform(-0.4, 0.4)), 0, JP_Q16_ONE};
        struct jp_skid_drive drive = {0};
        jp_q16 power = 0;
        model = random_model();
        model.unit_exponent = 0;
        const enum jp_status status = jp_skid_energy_power(&model, &motion, piece.grade, &power);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(&model, &drive, &piece));
        if (status == JP_OK) {
            TEST_ASSERT_TRUE(drive.energy == power);
        } else {
            TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, status);
            TEST_ASSERT_TRUE(drive.energy > INT32_MAX || drive.energy < INT32_MIN);
        }
    }
}

/* Backwards up a slope is as forwards up it; the other way round takes as much. */
static void test_both_ways_and_both_sides_cost_alike(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        const struct jp_skid_piece piece = random_piece();
        struct jp_skid_piece mirrored = piece;
        struct jp_skid_piece back = piece;
        struct jp_skid_drive drives[3] = {{0}, {0}, {0}};
        model = random_model();
        mirrored.start.turn_rate = -piece.start.turn_rate;
        mirrored.end.turn_rate = -piece.end.turn_rate;
        mirrored.bank = -piece.bank;
        back.start.speed = -piece.start.speed;
        back.end.speed = -piece.end.speed;
        back.grade = -piece.grade;
        back.bank = -piece.bank;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(&model, &drives[0], &piece));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(&model, &drives[1], &mirrored));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(&model, &drives[2], &back));
        const double bound = 2 * error_bound(&piece);
        check_near(joules(drives[0].energy), joules(drives[1].energy), bound, "to the other side, J");
        check_near(joules(drives[0].energy), joules(drives[2].energy), bound, "backwards, J");
    }
}

/* ---- Derivatives ---- */

/* The model's numbers with one factor, in double. */
static double scaled_energy(const struct jp_skid_piece *piece, int number, double factor)
{
    struct jp_skid_energy_model scaled = model;

    switch (number) {
    case JP_SKID_ROLLING:
        scaled.rolling = to_q24(q24(model.rolling) * factor);
        break;
    case JP_SKID_FRICTION:
        scaled.friction = to_q24(q24(model.friction) * factor);
        break;
    case JP_SKID_WEIGHT:
        scaled.weight = to_q16(q16(model.weight) * factor);
        scaled.copper_driving = to_q16(q16(model.copper_driving) * factor * factor);
        scaled.copper_braking = to_q16(q16(model.copper_braking) * factor * factor);
        break;
    default:
        scaled.electronics_power = to_q16(q16(model.electronics_power) * factor);
        break;
    }
    return oracle_energy_of(&scaled, piece).energy;
}

/* Central. */
static double difference(const struct jp_skid_piece *piece, int factor, double step)
{
    return (scaled_energy(piece, factor, 1 + step) - scaled_energy(piece, factor, 1 - step)) / (2 * step);
}

/* False: the energy bends within the step, or the change is another one. */
static bool check_changes(const struct jp_skid_piece *piece)
{
    const struct oracle_energy expected = oracle_energy_of(&model, piece);
    const double bound = CHANGE_SHARE * expected.terms + ldexp(2 * ERROR_UNIT, model.unit_exponent);
    struct jp_skid_drive drive = {0};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(&model, &drive, piece));
    for (int factor = 0; factor < (int)JP_SKID_FACTORS; factor++) {
        const double wide = difference(piece, factor, STEP);
        const double narrow = difference(piece, factor, STEP / 2);
        if (fabs(wide - narrow) > bound / 8 || fabs(narrow - joules(drive.change[factor])) > bound) {
            return false;
        }
    }
    return true;
}

static void test_changes_are_the_derivatives(void)
{
    unsigned long bends = 0;

    for (unsigned long i = 0; i < options.count; i++) {
        model = random_model();
        for (int j = 0; j < PIECES / 10; j++) {
            const struct jp_skid_piece piece = random_piece();
            bends += !check_changes(&piece);
        }
    }
    (void)printf("%lu of %lu pieces bend\n", bends, options.count * PIECES / 10);
    TEST_ASSERT_TRUE(bends * 15 < options.count * PIECES / 10);
}

/* ---- The seed's formulas ---- */

/* Straight on and on the spot the formulas of skid_steer.h are this model without slip. */
static void test_the_seeds_formulas_are_a_case_of_it(void)
{
    const struct jp_skid_steer_config *seed = &jp_skid_steer_zhang2018;
    const double efficiency = q24(seed->efficiency);
    const double per_newton = q24(seed->wheel_radius) / q16(seed->torque_per_ampere);
    const double copper = per_newton * per_newton * q24(seed->resistance) * q16(seed->weight) * q16(seed->weight);

    model = (struct jp_skid_energy_model){
        .half_track = seed->width / 2,
        .weight = seed->weight,
        .rolling = seed->rolling,
        .friction = seed->friction,
        .turning = to_q24(q24(seed->wheelbase) / (4 * 0.925 * q24(seed->width))),
        .driving = to_q24(1 / efficiency),
        .braking = to_q24(q24(seed->recuperation) * efficiency),
        .copper_driving = to_q16(copper),
        .copper_braking = to_q16(copper),
        .electronics_power = seed->electronics_power,
    };
    for (unsigned long i = 0; i < options.count; i++) {
        const bool turns = one_in(2);
        const struct jp_motion motion = {turns ? 0 : to_q24(uniform(0.05, 1)),
                                         turns ? to_q24(uniform(LEAST_SPEED, 1)) : 0};
        const jp_q24 grade = turns ? 0 : to_q24(uniform(-0.27, 0.27));
        jp_q16 expected = 0;
        jp_q16 power = 0;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_steer_power(seed, JP_COST_PHYSICAL, &motion, grade, &expected));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_power(&model, &motion, grade, &power));
        /* The formulas take the rise over the run for the sine: their windings take up to 7 % more. */
        const double level =
            2 * copper * pow(fabs(q24(grade)) / 2 + q24(seed->rolling) / 2, 2) * q24(grade) * q24(grade);
        check_near(q16(expected), q16(power), 0.002 + 3e-4 * fabs(q16(expected)) + 1.01 * level, "power, W");
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
