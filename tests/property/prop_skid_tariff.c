/*
 * Prices of a lattice that follow what a skid-steered robot has learned, against what its plant takes on ground that is
 * not the file's: straight primitives up and down slopes, bends and turns on the spot.
 *
 * prop_skid_tariff [--count N] [--seed S] [--json FILE]
 * --count is the number of robots.
 */
#include <joulepath/skid_tariff.h>
#include <joulepath/tables.h>
#include <math.h>
#include <stdio.h>

#include "tests/support/check.h"
#include "tests/support/options.h"
#include "tests/support/skid_trial.h"

enum { PRIMITIVES_MAX = 160, GROUPS = 3 };

#define SETTLE_SECONDS 5.0
#define HOLD_SECONDS   2.0

/* Of what primitives take, mean over the robots. */
#define CHARGED_BAR 0.15

static const char *const group_names[GROUPS] = {"straight on", "bends", "turns on the spot"};

static const struct jp_motion usual = {JP_Q24(0.5), JP_Q24(0.39269908)};

static struct options options = {.count = 6, .seed = 5};
static const struct jp_lattice *const lattice = &jp_lattice_zhang2018;
static struct skid_kind kind;
static struct jp_primitive primitives[PRIMITIVES_MAX];
static struct jp_tariff tariff;

/* Sums over primitives of |price − taken| and of what was taken, J. */
static double missed_before[GROUPS];
static double missed_after[GROUPS];
static double taken[GROUPS];

void setUp(void)
{
    kind = (struct skid_kind){.energy = &jp_skid_energy_zhang2018, .learning = &jp_skid_learning_zhang2018};
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/zhang2018.cfg", &kind.model));
    tariff = (struct jp_tariff){.primitives = primitives, .primitives_max = PRIMITIVES_MAX};
}

void tearDown(void)
{
}

/* J that a primitive costs where each of its moves rises by the grade. */
static double price(const struct jp_lattice *of, unsigned index, double grade)
{
    static const double lengths[] = {
        [JP_MOVE_AXIS] = 1, [JP_MOVE_KNIGHT] = 2.23606797749979, [JP_MOVE_DIAGONAL] = M_SQRT2};
    const struct jp_primitive *primitive = &of->primitives[index];
    double cost = primitive->base[JP_COST_PHYSICAL];

    for (unsigned i = 0; i < primitive->move_count; i++) {
        const enum jp_move_kind move = jp_move_kind_of(of->moves[primitive->first_move + i]);
        const double rise = grade * lengths[move] * of->resolution / 65536.0 * JP_ELEVATION_ONE;
        cost += jp_move_cost(&of->move_costs[JP_COST_PHYSICAL][move], (int32_t)lround(rise));
    }
    return cost / JP_COST_PER_JOULE;
}

static double turn_of(const struct jp_primitive *primitive)
{
    const int32_t turn = (int32_t)(lattice->heading[primitive->end] - lattice->heading[primitive->start]);

    return turn * (2 * M_PI / 4294967296.0);
}

/* J that the primitive takes at its mean motion, steady, up a grade. */
static double driven(const struct skid_steer_model *model, const struct jp_primitive *primitive, double grade)
{
    const double seconds = primitive->duration / 1000.0;
    const struct skid_leg settle = {primitive->length / 1000.0 / seconds, turn_of(primitive) / seconds, SETTLE_SECONDS};
    const struct skid_leg hold = {settle.speed, settle.turn_rate, HOLD_SECONDS};
    const struct skid_slope slope = {grade, 0};
    const struct planar_pose pose = {0, 0, 0};
    struct skid_trial trial = {.is_sound = true};
    struct skid_trial_run run = {.kind = &kind, .trial = &trial, .ground = skid_ground_slope(&slope)};
    struct skid_piece pieces[SKID_LEG_PIECES_MAX];

    skid_drive_start(&run.drive, model, &run.ground, &pose, 1);
    skid_route_start(&run.route, &kind.model, &run.ground, &pose);
    (void)skid_trial_drive(&run, pieces, skid_route_add(&run.route, &settle, pieces));
    return skid_trial_drive(&run, pieces, skid_route_add(&run.route, &hold, pieces)) / HOLD_SECONDS * seconds;
}

static void compare(const struct skid_steer_model *model, unsigned index, double grade)
{
    const struct jp_primitive *primitive = &lattice->primitives[index];
    const int group = primitive->move_count == 0 ? 2 : primitive->start != primitive->end;
    const double energy = driven(model, primitive, grade);

    taken[group] += energy;
    missed_before[group] += fabs(price(lattice, index, grade) - energy);
    missed_after[group] += fabs(price(&tariff.lattice, index, grade) - energy);
}

/* All moves alike. */
static bool is_straight(const struct jp_primitive *primitive)
{
    const uint8_t *moves = &lattice->moves[primitive->first_move];
    bool is = primitive->move_count > 0 && primitive->start == primitive->end;

    for (unsigned i = 1; i < primitive->move_count; i++) {
        is = is && moves[i] == moves[0];
    }
    return is;
}

/* From the heading along x. A bend that turns back has no mean motion to drive. */
static void compare_all(const struct skid_steer_model *model)
{
    for (unsigned index = lattice->first_from[0]; index < lattice->first_from[1]; index++) {
        const struct jp_primitive *primitive = &lattice->primitives[index];
        if (is_straight(primitive)) {
            compare(model, index, 0);
            compare(model, index, 0.1);
            compare(model, index, -0.1);
        } else if (primitive->start != primitive->end) {
            compare(model, index, 0);
        }
    }
}

static void drive_robot(uint64_t seed)
{
    struct skid_trial trial;
    struct skid_trial_run run;
    struct random random;
    struct jp_tariff_factors factors;
    struct skid_trial_leg leg = {.took = 0};
    const char *field = "";

    skid_trial_start(&run, &kind, seed, &random, &trial);
    for (int lesson = 0; lesson < SKID_TRIAL_LESSONS; lesson++) {
        skid_trial_learn(&run, &random, &leg);
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_tariff_factors(&jp_skid_steer_zhang2018, &run.learner.model, &usual,
                                                        run.learner.state.version, &factors));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_factors(&tariff, lattice, &factors, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_check(&tariff.lattice, &field));
    TEST_ASSERT_EQUAL_UINT32(run.learner.state.version, tariff.lattice.version);
    compare_all(&run.drive.world.plant.model);
}

static void test_charged_prices_are_what_the_changed_ground_takes(void)
{
    double all_taken = 0;
    double all_before = 0;
    double all_after = 0;

    for (unsigned long i = 0; i < options.count; i++) {
        drive_robot(options.seed * 1000 + i);
    }
    for (int group = 0; group < GROUPS; group++) {
        all_taken += taken[group];
        all_before += missed_before[group];
        all_after += missed_after[group];
        (void)printf("%s: prices off by %.1f %% as built in, by %.1f %% charged\n", group_names[group],
                     100 * missed_before[group] / taken[group], 100 * missed_after[group] / taken[group]);
    }
    check_below(all_after / all_taken, CHARGED_BAR, "charged prices, mean error");
    check_below(all_after, all_before, "charged prices, against those built in, J");
}

static void add_figures(json_t *figures)
{
    for (int group = 0; group < GROUPS; group++) {
        figures_add(figures, "make figures", 100 * missed_before[group] / taken[group], "%", no_bar,
                    "prices of the lattice of zhang2018, %s, %lu robots: off by, as built in", group_names[group],
                    options.count);
        figures_add(figures, "make figures", 100 * missed_after[group] / taken[group], "%", no_bar,
                    "prices of the lattice of zhang2018, %s, %lu robots: off by, after 20 legs", group_names[group],
                    options.count);
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
