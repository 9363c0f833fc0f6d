/* Energy of short segments: the check of the tables, and modes worked out by hand. */
#include <joulepath/horizon.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "tests/support/energy_unit.h"
#include "unity.h"

/* 0.001 J, 0.001 V */
#define TOLERANCE 66

#define P28(x) ((int32_t)((x)*268435456.0))

static const struct jp_energy_model *model = &jp_energy_model_published;

/* Ps T alone: the settled energy of a robot that goes on standing. */
static const struct jp_segment_command stand = {{0, 0}, 0, JP_Q16(1)};

static struct jp_horizon horizon;
static struct jp_energy_start start;
static struct jp_energy_start end;
static jp_q16 energy;

/* Travel: a mode that halves every second. Yaw: a pair that also makes a quarter turn in it. */
void setUp(void)
{
    horizon = (struct jp_horizon){
        .duration_min = JP_Q16(0.5),
        .travel = {.count = 1, .mode = {{JP_Q24(1), 0}}},
        .yaw = {.count = 2, .mode = {{JP_Q24(1), JP_Q24(0.25)}, {JP_Q24(1), JP_Q24(0.25)}}},
    };
    start = (struct jp_energy_start){.motion = {0, 0}};
    end = start;
    energy = 0;
}

void tearDown(void)
{
}

/* ---- Check ---- */

static void expect_good(const struct jp_horizon *table)
{
    const char *field = NULL;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_horizon_check(table, &field));
    TEST_ASSERT_NULL(field);
}

static void test_tables_pass_their_check(void)
{
    expect_good(&horizon);
    expect_good(&jp_horizon_gao2018);
    expect_good(&jp_horizon_gao2018_battery);
    expect_good(&jp_horizon_courier24);
    expect_good(&jp_horizon_courier24_battery);
}

static void expect_bad(const char *name)
{
    const char *field = "none";
    TEST_ASSERT_EQUAL_INT32(JP_ERR_CONFIG, jp_horizon_check(&horizon, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
    setUp();
}

static void test_check_of_null_pointers(void)
{
    const char *field = "none";
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_horizon_check(NULL, &field));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_horizon_check(&horizon, NULL));
    TEST_ASSERT_EQUAL_STRING("none", field);
}

static void test_check_of_the_shortest_duration(void)
{
    horizon.duration_min = 0;
    expect_bad("horizon.duration_min");
    horizon.duration_min = -1;
    expect_bad("horizon.duration_min");
    horizon.duration_min = JP_Q16(60) + 1;
    expect_bad("horizon.duration_min");
    horizon.duration_min = JP_Q16(60);
    expect_good(&horizon);
    horizon.duration_min = 1;
    expect_good(&horizon);
}

static void test_check_of_the_rest(void)
{
    horizon.reversal_rest = -1;
    expect_bad("horizon.reversal_rest");
    horizon.reversal_rest = JP_Q16(1000) + 1;
    expect_bad("horizon.reversal_rest");
    horizon.reversal_rest = JP_Q16(1000);
    expect_good(&horizon);
}

static void test_check_of_counts(void)
{
    horizon.travel.count = JP_AXIS_MODES + 1;
    expect_bad("horizon.travel.count");
    horizon.yaw.count = UINT32_MAX;
    expect_bad("horizon.yaw.count");
    horizon.travel.count = 0;
    horizon.yaw.count = 0;
    expect_good(&horizon);
    horizon.travel.count = JP_AXIS_MODES;
    for (int i = 0; i < JP_AXIS_MODES; i++) {
        horizon.travel.mode[i].decay = 1;
    }
    expect_good(&horizon);
}

static void test_check_of_modes(void)
{
    horizon.travel.mode[0].decay = 0;
    expect_bad("horizon.travel.mode");
    horizon.travel.mode[0].decay = -1;
    expect_bad("horizon.travel.mode");
    horizon.travel.mode[0].frequency = -1;
    expect_bad("horizon.travel.mode");
    horizon.yaw.mode[0].frequency = JP_Q24(64) + 1;
    expect_bad("horizon.yaw.mode");
    horizon.travel.mode[0].decay = INT32_MAX;
    horizon.yaw.mode[0].frequency = JP_Q24(64);
    horizon.yaw.mode[1].frequency = JP_Q24(64);
    expect_good(&horizon);
}

static void test_check_of_pairs(void)
{
    /* One without the other. */
    horizon.travel.mode[0].frequency = 1;
    expect_bad("horizon.travel.mode");
    horizon.yaw.count = 1;
    expect_bad("horizon.yaw.mode");
    /* Unequal ones. */
    horizon.yaw.mode[1].frequency = JP_Q24(0.25) + 1;
    expect_bad("horizon.yaw.mode");
    horizon.yaw.mode[1].frequency = 0;
    expect_bad("horizon.yaw.mode");
    horizon.yaw.mode[1].decay = JP_Q24(1) - 1;
    expect_bad("horizon.yaw.mode");
    /* Two pairs of equal frequency; a real mode between two pairs. */
    horizon.yaw.count = 4;
    horizon.yaw.mode[2] = horizon.yaw.mode[0];
    horizon.yaw.mode[3] = horizon.yaw.mode[0];
    expect_good(&horizon);
    horizon.yaw.count = 3;
    expect_bad("horizon.yaw.mode");
    horizon.yaw.count = 5;
    horizon.yaw.mode[2] = (struct jp_mode){JP_Q24(3), 0};
    horizon.yaw.mode[3] = (struct jp_mode){JP_Q24(2), JP_Q24(1)};
    horizon.yaw.mode[4] = horizon.yaw.mode[3];
    expect_good(&horizon);
}

static void test_check_of_steps_and_shares(void)
{
    horizon.travel.step[0][0] = JP_Q16(512) + 1;
    expect_bad("horizon.travel.step");
    horizon.travel.step[1][0] = -JP_Q16(512) - 1;
    expect_bad("horizon.travel.step");
    horizon.yaw.step[0][1] = INT32_MIN;
    expect_bad("horizon.yaw.step");
    horizon.yaw.step[1][1] = INT32_MAX;
    expect_bad("horizon.yaw.step");
    horizon.travel.cross[0][0] = JP_Q16(4096) + 1;
    expect_bad("horizon.travel.cross");
    horizon.travel.cross[1][0] = JP_Q16(4096) + 1;
    expect_bad("horizon.travel.cross");
    horizon.yaw.cross[0][0] = -JP_Q16(4096) - 1;
    expect_bad("horizon.yaw.cross");
    horizon.yaw.cross[1][1] = -JP_Q16(4096) - 1;
    expect_bad("horizon.yaw.cross");
    horizon.travel.steady[0] = JP_Q16(4096) + 1;
    expect_bad("horizon.travel.steady");
    horizon.yaw.steady[1] = -JP_Q16(4096) - 1;
    expect_bad("horizon.yaw.steady");
}

static void test_what_lies_beyond_the_count_is_not_checked(void)
{
    horizon.travel.mode[1].decay = -1;
    horizon.travel.step[0][1] = INT32_MAX;
    horizon.travel.cross[1][1] = INT32_MAX;
    horizon.travel.steady[1] = INT32_MAX;
    expect_good(&horizon);
}

static void test_limits_are_within(void)
{
    horizon.travel.step[0][0] = JP_Q16(512);
    horizon.travel.step[1][0] = -JP_Q16(512);
    horizon.travel.cross[0][0] = JP_Q16(4096);
    horizon.travel.cross[1][0] = -JP_Q16(4096);
    horizon.travel.steady[0] = -JP_Q16(4096);
    expect_good(&horizon);
}

/* ---- Forecast ---- */

static enum jp_status forecast(const struct jp_horizon *table, struct jp_segment_command segment)
{
    return jp_energy_forecast(model, table, &start, &segment, &energy, &end);
}

/** Beyond Ps T. */
static void expect_energy(double joules, struct jp_segment_command segment)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, forecast(&horizon, segment));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(joules) + (int32_t)(6 * (int64_t)segment.duration), energy);
}

static void expect_transient(const jp_q16 *modes, double first, double second)
{
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(first), modes[0]);
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(second), modes[1]);
    for (int i = 2; i < JP_AXIS_MODES; i++) {
        TEST_ASSERT_EQUAL_INT32(0, modes[i]);
    }
}

static void test_a_mode_halves(void)
{
    start.transient.travel[0] = JP_Q16(8);
    expect_energy(0, stand);
    expect_transient(end.transient.travel, 4, 0);
    expect_transient(end.transient.yaw, 0, 0);
    /* 8/√2 */
    expect_energy(0, (struct jp_segment_command){{0, 0}, 0, JP_Q16(0.5)});
    expect_transient(end.transient.travel, 5.656854, 0);
    expect_energy(0, (struct jp_segment_command){{0, 0}, 0, JP_Q16(3)});
    expect_transient(end.transient.travel, 1, 0);
}

static void test_a_pair_turns(void)
{
    start.transient.yaw[0] = JP_Q16(8);
    expect_energy(0, stand);
    expect_transient(end.transient.yaw, 0, 4);
    start = end;
    expect_energy(0, stand);
    expect_transient(end.transient.yaw, -2, 0);
    start = end;
    /* An eighth turn and 2^-½. */
    expect_energy(0, (struct jp_segment_command){{0, 0}, 0, JP_Q16(0.5)});
    expect_transient(end.transient.yaw, -1, -1);
    expect_transient(end.transient.travel, 0, 0);
}

static void test_stored_energy_is_spent(void)
{
    horizon.travel.storage[0] = P28(1.5);
    start.transient.travel[0] = -JP_Q16(8);
    expect_energy(1.5 * (64 - 16), stand);
}

/* P = [[1, −½], [−½, 2]]: of (8, 0) 64 J, of (0, 4) 32 J, of (8, 4) 64 − 32 + 32. */
static void test_storage_is_a_triangle_with_doubled_products(void)
{
    horizon.yaw.storage[0] = P28(1);
    horizon.yaw.storage[1] = P28(-1);
    horizon.yaw.storage[2] = P28(2);
    start.transient.yaw[0] = JP_Q16(8);
    expect_energy(64 - 32, stand);
    start.transient.yaw[1] = JP_Q16(4);
    /* They become (−2, 4): 4 + 8 + 32. */
    expect_energy(64 - 44, stand);
}

/* The triangle of three modes: 1 V each gives the sum of all six. */
static void test_triangle_of_three(void)
{
    horizon.travel.count = 3;
    for (int i = 0; i < 3; i++) {
        horizon.travel.mode[i].decay = JP_Q24(64);
        start.transient.travel[i] = JP_Q16(1);
    }
    for (int i = 0; i < 6; i++) {
        horizon.travel.storage[i] = P28(0.0625) * (1 << i);
    }
    expect_energy(0.0625 * 63, stand);
}

/* a1 Δv² + b1 v² (1 − Ts), with Δv = v = ½. */
#define HALF_STEP_SETTLED (43.05 + 20.83 * 0.25 * (1 - 5.82))

static const struct jp_segment_command half_step = {{JP_Q24(0.5), 0}, 0, JP_Q16(1)};

static void test_segment_shorter_than_the_settling_time(void)
{
    expect_energy(HALF_STEP_SETTLED, half_step);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.5), end.motion.speed);
    TEST_ASSERT_EQUAL_INT32(0, end.motion.turn_rate);
}

/* A step of ½ m/s adds 6 V, of which 3 are left: S = ½ 3² + ½·2·3. */
static void test_step_begins_a_mode(void)
{
    horizon.travel.step[0][0] = JP_Q16(12);
    horizon.travel.storage[0] = P28(0.5);
    horizon.travel.steady[0] = JP_Q16(2);
    expect_energy(HALF_STEP_SETTLED - 4.5 - 3, half_step);
    expect_transient(end.transient.travel, 3, 0);
}

/* 8 V are there: they cost v h m and Δv g m, and what is left of them v h m, too. */
static void test_step_with_a_transient(void)
{
    horizon.travel.cross[0][0] = JP_Q16(3);
    horizon.travel.cross[1][0] = JP_Q16(1000); /* travel knows no σ */
    horizon.travel.steady[0] = JP_Q16(2);
    start.transient.travel[0] = JP_Q16(8);
    expect_energy(HALF_STEP_SETTLED + 0.5 * 2 * 8 + 0.5 * 3 * 8 - 0.5 * 2 * 4, half_step);
    expect_transient(end.transient.travel, 4, 0);
}

/* a2 w² + b2 w² (1 − Ts) + a6 w σ + a3 σ² with w = ¼, σ = −1. */
#define TURN_SETTLED (7.57 * 0.0625 + 0.93 * 0.0625 * (1 - 5.82) - 1.37 * 0.25 + 13.2)

static void test_steps_of_turn_rate_and_heading(void)
{
    const struct jp_segment_command turn = {{0, JP_Q24(0.25)}, JP_Q24(-1), JP_Q16(1)};
    horizon.yaw.step[0][0] = JP_Q16(16);
    horizon.yaw.step[1][1] = JP_Q16(6);
    expect_energy(TURN_SETTLED, turn);
    /* (4, −6), halved and turned by a quarter. */
    expect_transient(end.transient.yaw, 3, 2);
    expect_transient(end.transient.travel, 0, 0);

    horizon.yaw.step[0][0] = 0;
    horizon.yaw.step[1][1] = 0;
    horizon.yaw.cross[0][0] = JP_Q16(3);
    horizon.yaw.cross[1][1] = JP_Q16(5);
    start.transient.yaw[0] = JP_Q16(1);
    start.transient.yaw[1] = JP_Q16(-2);
    expect_energy(TURN_SETTLED + 0.25 * 3 * 1 + (-1.0) * 5 * -2, turn);
}

static void test_settled_start_and_long_segment_are_the_papers_model(void)
{
    const struct jp_segment_command segment = {{JP_Q24(0.7), JP_Q24(-0.2)}, JP_Q24(0.9), JP_Q16(1000)};
    jp_q16 predicted = 0;
    start.motion = (struct jp_motion){JP_Q24(0.3), JP_Q24(0.1)};
    model = &jp_energy_model_gao2018;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_predict(model, &start.motion, &segment, &predicted));
    TEST_ASSERT_EQUAL_INT32(JP_OK, forecast(&jp_horizon_gao2018, segment));
    model = &jp_energy_model_published;
    TEST_ASSERT_EQUAL_INT32(predicted, energy);
    expect_transient(end.transient.travel, 0, 0);
    expect_transient(end.transient.yaw, 0, 0);
}

static void test_modes_vanish_in_the_longest_segment(void)
{
    start.transient.travel[0] = JP_Q16(4096);
    start.transient.yaw[0] = -JP_Q16(4096);
    /* Slow enough that something is left: 2⁻¹⁰ of them. */
    horizon.travel.mode[0].decay = JP_Q24(1) / 1638;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, forecast(&horizon, (struct jp_segment_command){{0, 0}, 0, JP_Q16(16384)}));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), JP_Q16(4), end.transient.travel[0]);
    expect_transient(end.transient.yaw, 0, 0);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, energy);
}

/* A chain of short segments in units of 2⁻² and 2³ J: the same joules, and the transients stay volts. */
static void test_the_unit_is_a_factor(void)
{
    static const struct jp_segment_command chain[] = {{{JP_Q24(0.5), JP_Q24(0.2)}, JP_Q24(0.4), JP_Q16(0.8)},
                                                      {{JP_Q24(0.2), 0}, -JP_Q24(0.6), JP_Q16(1.5)},
                                                      {{JP_Q24(0.6), -JP_Q24(0.3)}, 0, JP_Q16(0.5)}};

    for (int32_t exponent = -2; exponent <= 3; exponent += 5) {
        const struct jp_energy_model other = energy_model_in_unit(&jp_energy_model_gao2018, exponent);
        const struct jp_horizon table = horizon_in_unit(&jp_horizon_gao2018, exponent);
        struct jp_energy_start of_other = start;
        struct jp_energy_start from = start;

        expect_good(&table);
        for (unsigned i = 0; i < sizeof chain / sizeof chain[0]; i++) {
            jp_q16 in_unit = 0;

            TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_forecast(&jp_energy_model_gao2018, &jp_horizon_gao2018, &from,
                                                              &chain[i], &energy, &from));
            TEST_ASSERT_EQUAL_INT32(JP_OK,
                                    jp_energy_forecast(&other, &table, &of_other, &chain[i], &in_unit, &of_other));
            TEST_ASSERT_INT32_WITHIN(2 * TOLERANCE, energy_in_unit(energy, exponent), in_unit);
            TEST_ASSERT_EQUAL_MEMORY(&from, &of_other, sizeof from);
        }
    }
}

/* Of decays 1, 2 and 3 halvings/s, where the second holds the first at half, and the third the second at twice. */
static void make_sums(void)
{
    horizon.travel = (struct jp_axis_modes){
        .count = 3,
        .mode = {{JP_Q24(1), 0}, {JP_Q24(2), 0}, {JP_Q24(3), 0}},
        .passed = {JP_Q16(0.5), JP_Q16(2)},
    };
}

static void test_check_of_sums(void)
{
    make_sums();
    expect_good(&horizon);
    horizon.travel.passed[0] = -1;
    expect_bad("horizon.travel.passed");
    make_sums();
    horizon.travel.passed[1] = JP_Q16(4096) + 1;
    expect_bad("horizon.travel.passed");
    make_sums();
    horizon.travel.passed[2] = 1; /* to whom? */
    expect_bad("horizon.travel.passed");
    make_sums();
    horizon.travel.passed[1] = JP_Q16(4096);
    expect_good(&horizon);
    setUp();
    horizon.yaw.passed[0] = JP_Q16(1); /* inside a pair */
    expect_bad("horizon.yaw.passed");
    horizon.yaw.count = 3;
    horizon.yaw.mode[2].decay = JP_Q24(1);
    horizon.yaw.passed[1] = JP_Q16(1); /* by a pair */
    expect_bad("horizon.yaw.passed");
    horizon.yaw = (struct jp_axis_modes){
        .count = 3,
        .mode = {{JP_Q24(1), 0}, {JP_Q24(1), JP_Q24(0.25)}, {JP_Q24(1), JP_Q24(0.25)}},
        .passed = {JP_Q16(1)}, /* to a pair */
    };
    expect_bad("horizon.yaw.passed");
}

static void test_sums_get_what_is_passed_on(void)
{
    make_sums();
    start.transient.travel[0] = JP_Q16(8);
    start.transient.travel[1] = JP_Q16(3);
    start.transient.travel[2] = JP_Q16(16);
    TEST_ASSERT_EQUAL_INT32(JP_OK, forecast(&horizon, stand)); /* shares ½, ¼ and ⅛ */
    TEST_ASSERT_INT32_WITHIN(2, JP_Q16(4), end.transient.travel[0]);
    TEST_ASSERT_INT32_WITHIN(2, JP_Q16(0.75 + 1), end.transient.travel[1]);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q16(2 + 2 * (1 + 0.375)), end.transient.travel[2]);
}

/* Two modes of one amplitude that cancel, as themselves and as sums: what is left of them is the same. */
static void test_sums_of_modes_are_the_modes(void)
{
    const struct jp_segment_command segment = {{JP_Q24(1), 0}, 0, JP_Q16(1)};
    struct jp_axis_modes modes = {.count = 2,
                                  .mode = {{JP_Q24(1), 0}, {JP_Q24(1.0625), 0}},
                                  .step = {{JP_Q16(64), -JP_Q16(63)}},
                                  .storage = {P28(0.5), P28(1), P28(0.5)},
                                  .steady = {JP_Q16(2), JP_Q16(2)}};
    jp_q16 of_modes = 0;

    horizon.travel = modes;
    TEST_ASSERT_EQUAL_INT32(JP_OK, forecast(&horizon, segment));
    of_modes = energy;
    horizon.travel.passed[0] = JP_Q16(1);
    horizon.travel.step[0][1] = JP_Q16(1);
    horizon.travel.storage[0] = 0;
    horizon.travel.storage[1] = 0;
    horizon.travel.steady[0] = 0;
    TEST_ASSERT_EQUAL_INT32(JP_OK, forecast(&horizon, segment));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, of_modes, energy);
}

/* All as large as it may be, in sums of sums: nothing wraps. */
static void test_extreme_sums(void)
{
    const struct jp_segment_command segment = {{JP_Q24(8), 0}, 0, JP_Q16(0.5)};

    horizon.travel.count = JP_AXIS_MODES;
    for (int i = 0; i < JP_AXIS_MODES; i++) {
        horizon.travel.mode[i] = (struct jp_mode){i % 2 == 0 ? 1 : INT32_MAX, 0};
        horizon.travel.step[0][i] = JP_Q16(512);
        horizon.travel.passed[i] = i + 1 < JP_AXIS_MODES ? JP_Q16(4096) : 0;
        start.transient.travel[i] = JP_Q16(4096);
    }
    expect_good(&horizon);
    start.motion.speed = -JP_Q24(8);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, forecast(&horizon, segment));
    for (int i = 0; i < JP_AXIS_MODES; i++) {
        TEST_ASSERT_EQUAL_INT32(JP_Q16(4096), end.transient.travel[i]);
    }
}

/* Modes of a unit of their own: here volts are so many of it. */
static void count_in(struct jp_axis_modes *axis, const int32_t *units_per_volt)
{
    int32_t *storage = axis->storage;

    for (unsigned i = 0; i < axis->count; i++) {
        for (unsigned k = i; k < axis->count; k++) {
            *storage = *storage / (units_per_volt[i] * units_per_volt[k]);
            storage++;
        }
        axis->step[0][i] *= units_per_volt[i];
        axis->step[1][i] *= units_per_volt[i];
        axis->cross[0][i] /= units_per_volt[i];
        axis->cross[1][i] /= units_per_volt[i];
        axis->steady[i] /= units_per_volt[i];
    }
}

static void test_units_of_modes_change_no_energy(void)
{
    static const int32_t units_of_travel[JP_AXIS_MODES] = {2, 4, 4, 1}; /* a pair in the middle */
    static const int32_t units_of_yaw[JP_AXIS_MODES] = {8, 8};
    const struct jp_energy_model *of_robot = &jp_energy_model_gao2018;
    struct jp_energy_start of_units = start;

    horizon = jp_horizon_gao2018;
    count_in(&horizon.travel, units_of_travel);
    count_in(&horizon.yaw, units_of_yaw);
    expect_good(&horizon);
    for (unsigned i = 0; i < 20U; i++) {
        const struct jp_segment_command segment = {
            {JP_Q24(0.1) * (int32_t)(i % 7U), JP_Q24(0.1) * ((int32_t)(i % 5U) - 2)},
            JP_Q24(0.3) * ((int32_t)(i % 3U) - 1),
            JP_Q16(0.5) + JP_Q16(0.3) * (int32_t)(i % 4U)};
        jp_q16 in_volts = 0;

        TEST_ASSERT_EQUAL_INT32(JP_OK,
                                jp_energy_forecast(of_robot, &jp_horizon_gao2018, &start, &segment, &in_volts, &start));
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_forecast(of_robot, &horizon, &of_units, &segment, &energy, &of_units));
        TEST_ASSERT_INT32_WITHIN(TOLERANCE, in_volts, energy);
        TEST_ASSERT_INT32_WITHIN(8, 2 * start.transient.travel[0], of_units.transient.travel[0]);
    }
}

static void test_without_a_horizon_it_is_the_papers_model(void)
{
    const struct jp_segment_command segment = {{JP_Q24(0.7), JP_Q24(-0.2)}, JP_Q24(0.9), JP_Q16(6)};
    jp_q16 predicted = 0;
    start.motion = (struct jp_motion){JP_Q24(0.3), JP_Q24(0.1)};
    start.transient.travel[0] = INT32_MAX; /* not looked at */
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_predict(model, &start.motion, &segment, &predicted));
    TEST_ASSERT_EQUAL_INT32(JP_OK, forecast(NULL, segment));
    TEST_ASSERT_EQUAL_INT32(predicted, energy);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.7), end.motion.speed);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(-0.2), end.motion.turn_rate);
    expect_transient(end.transient.travel, 0, 0);
    expect_transient(end.transient.yaw, 0, 0);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, forecast(NULL, stand)); /* T < Ts */
}

static void test_end_may_be_start(void)
{
    const struct jp_segment_command segment = {{JP_Q24(0.6), JP_Q24(0.3)}, JP_Q24(-0.4), JP_Q16(0.75)};
    jp_q16 again = 0;
    start.motion = (struct jp_motion){JP_Q24(-0.2), JP_Q24(-0.1)};
    start.transient.travel[1] = JP_Q16(3);
    start.transient.yaw[0] = JP_Q16(-1);
    TEST_ASSERT_EQUAL_INT32(JP_OK, forecast(&jp_horizon_gao2018, segment));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_forecast(model, &jp_horizon_gao2018, &start, &segment, &again, &start));
    TEST_ASSERT_EQUAL_INT32(energy, again);
    TEST_ASSERT_EQUAL_INT32(end.motion.speed, start.motion.speed);
    TEST_ASSERT_EQUAL_INT32(end.motion.turn_rate, start.motion.turn_rate);
    TEST_ASSERT_EQUAL_MEMORY(&end.transient, &start.transient, sizeof end.transient);
}

/* ---- Bad arguments ---- */

static void expect_refused(const struct jp_horizon *table, struct jp_segment_command segment)
{
    jp_q16 regressor[JP_ENERGY_PARAMETERS] = {5};
    jp_q16 rest = 7;
    energy = 77;
    end.motion.speed = 99;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, forecast(table, segment));
    TEST_ASSERT_EQUAL_INT32(77, energy);
    TEST_ASSERT_EQUAL_INT32(99, end.motion.speed);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_regressors(model, table, &start, &segment, regressor, &rest));
    TEST_ASSERT_EQUAL_INT32(5, regressor[0]);
    TEST_ASSERT_EQUAL_INT32(7, rest);
    start = (struct jp_energy_start){.motion = {0, 0}};
}

static void test_segments_out_of_range(void)
{
    expect_refused(&horizon, (struct jp_segment_command){{0, 0}, 0, JP_Q16(0.5) - 1});
    expect_refused(&horizon, (struct jp_segment_command){{0, 0}, 0, JP_Q16(16384) + 1});
    expect_refused(&horizon, (struct jp_segment_command){{JP_Q24(8) + 1, 0}, 0, JP_Q16(1)});
    expect_refused(&horizon, (struct jp_segment_command){{0, -JP_Q24(8) - 1}, 0, JP_Q16(1)});
    expect_refused(&horizon, (struct jp_segment_command){{0, 0}, JP_Q24(6.2831854) + 1, JP_Q16(1)});
    expect_refused(NULL, (struct jp_segment_command){{0, 0}, 0, model->settling_time - 1});
    TEST_ASSERT_EQUAL_INT32(JP_OK, forecast(&horizon, (struct jp_segment_command){{0, 0}, 0, JP_Q16(0.5)}));
}

static void test_starts_out_of_range(void)
{
    start.motion.speed = JP_Q24(8) + 1;
    expect_refused(&horizon, stand);
    start.motion.turn_rate = -JP_Q24(8) - 1;
    expect_refused(&horizon, stand);
    start.transient.travel[0] = JP_Q16(4096) + 1;
    expect_refused(&horizon, stand);
    start.transient.travel[JP_AXIS_MODES - 1] = -JP_Q16(4096) - 1;
    expect_refused(&horizon, stand);
    start.transient.yaw[0] = INT32_MIN;
    expect_refused(&horizon, stand);
}

static void test_null_pointers(void)
{
    jp_q16 regressor[JP_ENERGY_PARAMETERS];
    jp_q16 rest;
    const struct jp_horizon *h = &horizon;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_forecast(NULL, h, &start, &stand, &energy, &end));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_forecast(model, h, NULL, &stand, &energy, &end));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_forecast(model, h, &start, NULL, &energy, &end));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_forecast(model, h, &start, &stand, NULL, &end));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_forecast(model, h, &start, &stand, &energy, NULL));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_regressors(NULL, h, &start, &stand, regressor, &rest));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_regressors(model, h, NULL, &stand, regressor, &rest));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_regressors(model, h, &start, NULL, regressor, &rest));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_regressors(model, h, &start, &stand, NULL, &rest));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_regressors(model, h, &start, &stand, regressor, NULL));
}

/* ---- Overflow ---- */

static void test_energy_of_a_transient_saturates(void)
{
    horizon.travel.storage[0] = P28(7);
    start.transient.travel[0] = JP_Q16(4096);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, forecast(&horizon, stand));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, energy);
    horizon.travel.storage[0] = P28(-7);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, forecast(&horizon, stand));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, energy);
    expect_transient(end.transient.travel, 2048, 0);
}

/* 512 V·s/m times 16 m/s, and as much of a turn rate: 8 192 V and more. */
static void test_transients_are_limited(void)
{
    horizon.travel.step[0][0] = JP_Q16(512);
    horizon.yaw.step[0][0] = JP_Q16(512);
    horizon.yaw.mode[0].decay = 1;
    horizon.yaw.mode[1].decay = 1;
    start.motion = (struct jp_motion){-JP_Q24(8), 0};
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW,
                            forecast(&horizon, (struct jp_segment_command){{JP_Q24(8), 0}, 0, JP_Q16(0.5)}));
    expect_transient(end.transient.travel, 4096, 0);
    start.motion = (struct jp_motion){0, JP_Q24(8)};
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW,
                            forecast(&horizon, (struct jp_segment_command){{0, -JP_Q24(8)}, 0, JP_Q16(0.5)}));
    expect_transient(end.transient.yaw, -4096, -4096);
    TEST_ASSERT_TRUE(energy > 0 && energy < INT32_MAX); /* the settled energy fits */
}

static void store_all(int32_t storage, jp_q16 transient)
{
    for (int i = 0; i < JP_AXIS_MODES * (JP_AXIS_MODES + 1) / 2; i++) {
        horizon.travel.storage[i] = storage;
        horizon.yaw.storage[i] = storage;
    }
    for (int i = 0; i < JP_AXIS_MODES; i++) {
        start.transient.travel[i] = transient;
        start.transient.yaw[i] = transient;
    }
}

/* All as large as it may be: nothing wraps. */
static void test_extreme_tables(void)
{
    const struct jp_segment_command segment = {{JP_Q24(8), JP_Q24(8)}, JP_Q24(6.2831), JP_Q16(0.5)};
    struct jp_axis_modes axis = {.count = JP_AXIS_MODES};
    for (int i = 0; i < JP_AXIS_MODES; i++) {
        axis.mode[i] = (struct jp_mode){1, i + 1 < JP_AXIS_MODES ? JP_Q24(64) : 0}; /* pairs, and one alone */
        axis.step[0][i] = JP_Q16(512);
        axis.step[1][i] = JP_Q16(512);
        axis.cross[0][i] = JP_Q16(4096);
        axis.cross[1][i] = JP_Q16(4096);
        axis.steady[i] = JP_Q16(4096);
        start.transient.travel[i] = JP_Q16(4096);
        start.transient.yaw[i] = JP_Q16(4096);
    }
    for (int i = 0; i < JP_AXIS_MODES * (JP_AXIS_MODES + 1) / 2; i++) {
        axis.storage[i] = INT32_MAX;
    }
    horizon = (struct jp_horizon){JP_Q16(0.5), 0, axis, axis};
    expect_good(&horizon);
    start.motion = (struct jp_motion){-JP_Q24(8), -JP_Q24(8)};
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, forecast(&horizon, segment));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, energy);
    for (int i = 0; i < JP_AXIS_MODES; i++) {
        TEST_ASSERT_EQUAL_INT32(JP_Q16(4096), end.transient.travel[i]);
        TEST_ASSERT_EQUAL_INT32(JP_Q16(4096), end.transient.yaw[i]);
    }
    store_all(INT32_MIN, -JP_Q16(4096));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, forecast(&horizon, segment));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, energy);
}

/* All that is stored is spent, or taken: both axes together would not fit 64 bits. */
static void test_extreme_tables_that_decay_at_once(void)
{
    const struct jp_segment_command segment = {{JP_Q24(8), JP_Q24(8)}, JP_Q24(6.2831), JP_Q16(0.5)};
    struct jp_axis_modes axis = {.count = JP_AXIS_MODES};

    for (int i = 0; i < JP_AXIS_MODES; i++) {
        axis.mode[i].decay = INT32_MAX;
        axis.cross[0][i] = JP_Q16(4096);
        axis.cross[1][i] = JP_Q16(4096);
        axis.steady[i] = JP_Q16(4096);
    }
    horizon = (struct jp_horizon){JP_Q16(0.5), 0, axis, axis};
    start.motion = (struct jp_motion){-JP_Q24(8), -JP_Q24(8)};
    store_all(INT32_MAX, JP_Q16(4096));
    expect_good(&horizon);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, forecast(&horizon, segment));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, energy);
    store_all(INT32_MIN, -JP_Q16(4096));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, forecast(&horizon, segment));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, energy);
}

/* ---- Regressors ---- */

static void expect_regressors(const jp_q16 *expected, const jp_q16 *regressor)
{
    for (int i = 0; i < JP_ENERGY_PARAMETERS; i++) {
        TEST_ASSERT_INT32_WITHIN(TOLERANCE, expected[i], regressor[i]);
    }
}

/* From (½, ¼) to (1, −¼) with σ = ½; cv = 8, cw = 4, Rm = 2: ul₋ = 3, ur₋ = 5, P₋ = 17; T − Ts = −2. */
static void test_regressors_by_hand(void)
{
    const struct jp_energy_model round = {.electronics_power = JP_Q16(6),
                                          .settling_time = JP_Q16(3),
                                          .voltage_per_speed = JP_Q16(8),
                                          .voltage_per_turn_rate = JP_Q16(4),
                                          .motor_resistance = JP_Q16(2)};
    const struct jp_segment_command segment = {{JP_Q24(1), JP_Q24(-0.25)}, JP_Q24(0.5), JP_Q16(1)};
    const jp_q16 expected[JP_ENERGY_PARAMETERS] = {JP_Q16(0.25), JP_Q16(0.25),  JP_Q16(0.25),  JP_Q16(-0.25),
                                                   JP_Q16(0.25), JP_Q16(-0.25), JP_Q16(1.5),   JP_Q16(-1.5),
                                                   JP_Q16(1.5),  JP_Q16(2.5),   JP_Q16(-2.5),  JP_Q16(2.5),
                                                   JP_Q16(17),   JP_Q16(-2),    JP_Q16(-0.125)};
    jp_q16 regressor[JP_ENERGY_PARAMETERS];
    jp_q16 rest;
    start.motion = (struct jp_motion){JP_Q24(0.5), JP_Q24(0.25)};
    start.transient.travel[0] = JP_Q16(8);
    horizon.travel.storage[0] = P28(1);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_regressors(&round, &horizon, &start, &segment, regressor, &rest));
    expect_regressors(expected, regressor);
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(6 + 64 - 16), rest);
}

static int64_t weighted(const struct jp_energy_model *m, const jp_q16 *regressor, jp_q16 rest)
{
    int64_t sum = (int64_t)rest * 65536;
    for (int i = 0; i < JP_ENERGY_TERMS; i++) {
        sum += (int64_t)m->a[i] * regressor[i];
    }
    for (int i = 0; i < 2; i++) {
        sum += (int64_t)m->b[i] * regressor[JP_ENERGY_TERMS + i];
    }
    return sum / 65536;
}

static void expect_sum_is_the_forecast(const struct jp_horizon *table, struct jp_segment_command segment)
{
    jp_q16 regressor[JP_ENERGY_PARAMETERS];
    jp_q16 rest;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_forecast(model, table, &start, &segment, &energy, &end));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_regressors(model, table, &start, &segment, regressor, &rest));
    /* 2⁻¹⁷ times the sum of the published parameters, 262, is 0.002 J. */
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.003), energy, weighted(model, regressor, rest));
}

static void test_weighted_regressors_are_the_forecast(void)
{
    start.motion = (struct jp_motion){JP_Q24(0.4), JP_Q24(-0.3)};
    start.transient.travel[0] = JP_Q16(5);
    start.transient.yaw[1] = JP_Q16(-2);
    expect_sum_is_the_forecast(&jp_horizon_courier24,
                               (struct jp_segment_command){{JP_Q24(0.9), JP_Q24(0.2)}, JP_Q24(-1.1), JP_Q16(0.6)});
    expect_sum_is_the_forecast(&jp_horizon_courier24,
                               (struct jp_segment_command){{JP_Q24(-0.1), JP_Q24(0)}, JP_Q24(1.3), JP_Q16(20)});
    expect_sum_is_the_forecast(NULL, (struct jp_segment_command){{JP_Q24(0.1), JP_Q24(0.3)}, JP_Q24(0.3), JP_Q16(8)});
    start.is_forward = true;
    start.reversal_rest = JP_Q16(1.5);
    expect_sum_is_the_forecast(&jp_horizon_courier24,
                               (struct jp_segment_command){{JP_Q24(-0.8), JP_Q24(0.1)}, JP_Q24(0.4), JP_Q16(3)});
}

static void test_regressors_and_rest_saturate(void)
{
    jp_q16 regressor[JP_ENERGY_PARAMETERS];
    jp_q16 rest;
    const struct jp_segment_command fast = {{JP_Q24(8), 0}, 0, JP_Q16(1000)};
    const struct jp_segment_command longest = {{0, 0}, 0, JP_Q16(16384)};
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_energy_regressors(model, &horizon, &start, &fast, regressor, &rest));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, regressor[13]);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(6000), rest);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_energy_regressors(model, &horizon, &start, &longest, regressor, &rest));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, rest);
    TEST_ASSERT_EQUAL_INT32(0, regressor[13]);
    horizon.travel.step[0][0] = JP_Q16(512);
    start.motion = (struct jp_motion){-JP_Q24(8), 0};
    const struct jp_segment_command jump = {{JP_Q24(8), 0}, 0, JP_Q16(0.5)};
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_energy_regressors(model, &horizon, &start, &jump, regressor, &rest));
    TEST_ASSERT_INT32_WITHIN(1, JP_Q16(256), regressor[0]);
}
