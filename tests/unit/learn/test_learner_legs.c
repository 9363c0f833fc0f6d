/* Learning from the legs of trajectories: another robot, outliers, what teaches nothing, what is refused. */
#include "tests/support/energy_unit.h"
#include "tests/support/learner_rig.h"

/* So long at 0.5 m/s, and half a joule for the blends. */
static struct jp_leg_energy leg_of(jp_q16 duration, jp_q16 turning)
{
    const jp_q16 steady = jp_q16_multiply(BUILT_IN.electronics_power, duration) +
                          jp_q16_multiply(BUILT_IN.b[0], duration / 4) + jp_q16_multiply(BUILT_IN.b[1], turning);

    return (struct jp_leg_energy){
        .energy = steady + JP_Q16(0.5), .duration = duration, .travel = duration / 4, .turning = turning};
}

static struct jp_leg_energy random_leg(void)
{
    return leg_of(draw(JP_Q16(2), JP_Q16(12)), draw(0, JP_Q16(0.5)));
}

/* What the leg takes of a robot that is x along the directions. */
static jp_q16 energy_as(const jp_q24 x[N], const struct jp_leg_energy *leg)
{
    struct jp_learner robot = learner;
    struct jp_forecast_sum sum = {0, {0}, 0};

    memcpy(robot.state.x, x, sizeof robot.state.x);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_add_leg(&robot, &sum, leg));
    return (jp_q16)sum.energy;
}

static enum jp_learned learn_from(const struct jp_leg_energy *leg, jp_q16 measured)
{
    enum jp_learned learned = JP_LEARNED_NOTHING;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learner_update_leg(&learner, leg, measured, &learned));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learned_state_check(&learner.state, &field));
    return learned;
}

static jp_q16 absolute(jp_q16 value)
{
    return value < 0 ? -value : value;
}

static void test_another_robot_is_learned(void)
{
    static const jp_q24 x[N] = {JP_Q24(0.8), JP_Q24(-0.6)};
    const struct jp_leg_energy leg = leg_of(JP_Q16(10), JP_Q16(0.2));
    const jp_q16 before = absolute(energy_as(x, &leg) - energy_as(learner.state.x, &leg));

    for (unsigned i = 0; i < 40U; i++) {
        const struct jp_leg_energy driven = random_leg();

        TEST_ASSERT_EQUAL_INT(JP_LEARNED, learn_from(&driven, energy_as(x, &driven)));
    }
    TEST_ASSERT_EQUAL_UINT32(40, learner.state.version);
    TEST_ASSERT_TRUE(before > leg.energy / 100);
    TEST_ASSERT_TRUE(absolute(energy_as(x, &leg) - energy_as(learner.state.x, &leg)) < before / 20);
}

/* A leg in another unit. */
static struct jp_leg_energy leg_in_unit(const struct jp_leg_energy *leg, int32_t exponent)
{
    struct jp_leg_energy other = *leg;

    other.energy = energy_in_unit(leg->energy, exponent);
    return other;
}

/* The same robot in units of 2⁻³ and 2² J teaches the same, and is forecast as surely. */
static void test_the_unit_changes_nothing_that_is_learned(void)
{
    static const jp_q24 x[N] = {JP_Q24(0.8), JP_Q24(-0.6)};

    for (int32_t exponent = -3; exponent <= 2; exponent += 5) {
        const struct jp_energy_model model = energy_model_in_unit(&BUILT_IN, exponent);
        const struct jp_learning table = learning_in_unit(&learning, exponent);
        const struct jp_leg_energy next = leg_of(JP_Q16(10), JP_Q16(0.2));
        const struct jp_leg_energy next_in_unit = leg_in_unit(&next, exponent);
        struct jp_forecast_sum sums[2] = {{0, {0}, 0}, {0, {0}, 0}};
        struct jp_forecast forecasts[2];
        struct jp_learner other;
        enum jp_learned learned;

        jp_learner_start(&learner, &learning, &BUILT_IN, &HORIZON);
        jp_learner_start(&other, &table, &model, NULL);
        for (unsigned i = 0; i < 40U; i++) {
            const struct jp_leg_energy driven = random_leg();
            const struct jp_leg_energy in_unit = leg_in_unit(&driven, exponent);
            const jp_q16 measured = energy_as(x, &driven);

            (void)learn_from(&driven, measured);
            TEST_ASSERT_EQUAL_INT(
                JP_OK, jp_learner_update_leg(&other, &in_unit, energy_in_unit(measured, exponent), &learned));
            TEST_ASSERT_EQUAL_INT(JP_LEARNED, learned);
        }
        for (unsigned j = 0; j < N; j++) {
            TEST_ASSERT_INT32_WITHIN(JP_Q24(0.002), learner.state.x[j], other.state.x[j]);
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_add_leg(&learner, &sums[0], &next));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_add_leg(&other, &sums[1], &next_in_unit));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_total(&learner, &sums[0], &forecasts[0]));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_total(&other, &sums[1], &forecasts[1]));
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), energy_in_unit(forecasts[0].energy, exponent), forecasts[1].energy);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), energy_in_unit(forecasts[0].deviation, exponent),
                                 forecasts[1].deviation);
    }
}

static void test_a_robot_of_the_file_teaches_nothing_new(void)
{
    static const jp_q24 none[N] = {0};
    struct jp_energy_model model;

    for (unsigned i = 0; i < 40U; i++) {
        const struct jp_leg_energy driven = random_leg();

        (void)learn_from(&driven, energy_as(none, &driven));
    }
    jp_learner_model(&learner, &model);
    TEST_ASSERT_INT32_WITHIN(BUILT_IN.b[0] / 1000, BUILT_IN.b[0], model.b[0]);
}

/** After twenty legs as expected, one that takes so many deviations of the noise too much. */
static enum jp_learned learn_beyond(jp_q16 spread, double deviations)
{
    const struct jp_leg_energy leg = leg_of(JP_Q16(10), JP_Q16(0.2));

    setUp();
    learning.leg_noise = JP_Q16(0.1);
    learning.leg_noise_relative = 0;
    learning.leg_noise_transient = 0;
    learning.leg_spread = spread;
    for (unsigned i = 0; i < 20U; i++) {
        TEST_ASSERT_EQUAL_INT(JP_LEARNED, learn_from(&leg, leg.energy));
        learner.state.noise_scale = JP_Q16_ONE;
    }
    return learn_from(&leg, leg.energy + JP_Q16(0.1 * deviations));
}

static void test_an_outlier_counts_as_if_it_were_nearer(void)
{
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER, learn_beyond(JP_Q16_ONE, 6));
    TEST_ASSERT_EQUAL_UINT32(1, learner.outliers);
    TEST_ASSERT_EQUAL_UINT32(21, learner.state.version);

    const struct jp_learned_state near = learner.state;

    TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER, learn_beyond(JP_Q16_ONE, 60));
    TEST_ASSERT_EQUAL_INT(0, memcmp(&near, &learner.state, sizeof near));
}

/* The noise of forecasts is the same, and what counts as an outlier is not. */
static void test_legs_of_a_greater_spread_are_outliers_further_away(void)
{
    TEST_ASSERT_EQUAL_INT(JP_LEARNED, learn_beyond(JP_Q16(2), 6));
    TEST_ASSERT_EQUAL_UINT32(0, learner.outliers);
    TEST_ASSERT_TRUE(learner.state.noise_scale > JP_Q16_ONE);
    TEST_ASSERT_EQUAL_INT(JP_LEARNED, learn_beyond(JP_Q16(2), 1.5));
    TEST_ASSERT_TRUE(learner.state.noise_scale < JP_Q16_ONE);
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER, learn_beyond(JP_Q16(2), 12));
}

/* What changes of the speed take tells the directions that b1 and b2 leave out. */
static void test_the_transients_teach_too(void)
{
    jp_q24 x[N] = {0};
    struct jp_leg_energy leg = leg_of(JP_Q16(10), JP_Q16(0.2));

    for (int j = 0; j < N; j++) {
        x[j] = learning.leg[1][j] * 128; /* Q16 to Q24, halved */
    }
    leg.transient[1] = JP_Q16(2);

    const jp_q16 before = absolute(energy_as(x, &leg) - energy_as(learner.state.x, &leg));

    TEST_ASSERT_TRUE(before > JP_Q16(0.02));
    for (unsigned i = 0; i < 20U; i++) {
        TEST_ASSERT_EQUAL_INT(JP_LEARNED, learn_from(&leg, energy_as(x, &leg)));
    }
    TEST_ASSERT_TRUE(absolute(energy_as(x, &leg) - energy_as(learner.state.x, &leg)) < before / 10);
}

/* J, share of the energy and share of what its transients take, as independent parts. */
static void test_legs_have_their_own_noise(void)
{
    struct jp_leg_energy leg = {.energy = JP_Q16(100), .transient = {-JP_Q16(1), JP_Q16(0.75), JP_Q16(0.25)}};
    struct jp_forecast_sum sum = {0, {0}, 0};

    learning.leg_noise = JP_Q16(2);
    learning.leg_noise_relative = JP_Q16(0.03);
    learning.leg_noise_transient = JP_Q16(3);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_add_leg(&learner, &sum, &leg));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.1), JP_Q16(49), (int32_t)sum.variance); /* 2² + 3² + 6² J² */
}

/* All transients count as spent, to the last bit, whichever they are. */
static void test_noise_counts_each_transient(void)
{
    learning.leg_noise = 1;
    learning.leg_noise_relative = 0;
    learning.leg_noise_transient = JP_Q16(16);
    for (unsigned i = 0; i < JP_LEG_TRANSIENTS; i++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            struct jp_leg_energy leg = {.energy = JP_Q16(100)};
            struct jp_forecast_sum sum = {0, {0}, 0};

            leg.transient[i] = sign * JP_Q16(0.5);
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_add_leg(&learner, &sum, &leg));
            TEST_ASSERT_INT32_WITHIN(8, JP_Q16(64), (int32_t)sum.variance);
        }
    }
}

/* A leg's energy changes with x by each transient as the file says. */
static void test_each_transient_has_its_directions(void)
{
    for (unsigned i = 0; i < JP_LEG_TRANSIENTS; i++) {
        for (int j = 0; j < N; j++) {
            struct jp_leg_energy leg = {.energy = JP_Q16(100)};
            jp_q24 x[N] = {0};

            leg.transient[i] = JP_Q16(3);
            x[j] = JP_Q24(0.5);
            TEST_ASSERT_INT32_WITHIN(2, JP_Q16(100) + learning.leg[i][j] * 3 / 2, energy_as(x, &leg));
        }
    }
}

static void test_a_leg_that_stands_teaches_nothing(void)
{
    const struct jp_leg_energy leg = {.energy = JP_Q16(40), .duration = JP_Q16(10)};

    TEST_ASSERT_EQUAL_INT(JP_LEARNED_NOTHING, learn_from(&leg, JP_Q16(41)));
    TEST_ASSERT_EQUAL_UINT32(0, learner.state.version);
}

static void test_what_is_refused_is_not_learned(void)
{
    const struct jp_leg_energy leg = {INT32_MAX, INT32_MAX, INT32_MAX, 0, {0}};
    const struct jp_leg_energy changing = {.energy = JP_Q16(90), .transient = {0, INT32_MAX, 0}};
    enum jp_learned learned = JP_LEARNED_CHANGE;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learner_update_leg(NULL, &leg, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learner_update_leg(&learner, NULL, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learner_update_leg(&learner, &leg, 0, NULL));
    learner.state.x[0] = JP_Q24(2);
    learner.state.x[1] = JP_Q24(2);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_learner_update_leg(&learner, &leg, 0, &learned));
    setUp();
    learning.leg[1][0] = JP_Q16(16);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_learner_update_leg(&learner, &changing, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_CHANGE, learned);
    TEST_ASSERT_EQUAL_UINT32(0, learner.state.version);
}
