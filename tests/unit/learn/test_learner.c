/* The learner: its checks, what it takes and what it leaves out, changes and their causes. */
#include "src/learn/learner_filter.h"
#include "src/learn/normal_quantile.h"
#include "tests/support/learner_rig.h"

#define S_ONE ((int32_t)1 << 30)

static const struct jp_segment_command stand = {{0, 0}, 0, JP_Q16(10)};

/* ---- Checks ---- */

static void test_the_tables_pass_their_check(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learning_check(&jp_learning_gao2018, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learning_check(&jp_learning_gao2018_battery, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learning_check(&jp_learning_courier24, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learning_check(&jp_learning_courier24_battery, &field));
    TEST_ASSERT_TRUE(jp_learning_gao2018.identity != jp_learning_courier24.identity);
    TEST_ASSERT_TRUE(jp_learning_courier24_battery.identity != jp_learning_courier24.identity);
}

#define REFUSED(member, value, name)                                                                                   \
    do {                                                                                                               \
        setUp();                                                                                                       \
        learning.member = (value);                                                                                     \
        TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_learning_check(&learning, &field));                                    \
        TEST_ASSERT_EQUAL_STRING((name), field);                                                                       \
    } while (0)

#define TAKEN(member, value)                                                                                           \
    do {                                                                                                               \
        setUp();                                                                                                       \
        learning.member = (value);                                                                                     \
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_learning_check(&learning, &field));                                            \
    } while (0)

static void test_check_names_the_first_bad_field(void)
{
    REFUSED(direction[0][0], JP_Q16(4096) + 1, "learning.direction");
    REFUSED(direction[14][3], -JP_Q16(4096) - 1, "learning.direction");
    REFUSED(ground[3], JP_Q16(16) + 1, "learning.ground");
    REFUSED(payload[0], -JP_Q16(256) - 1, "learning.payload");
    REFUSED(ground_deviation, 0, "learning.ground_deviation");
    REFUSED(ground_deviation, JP_Q16(16) + 1, "learning.ground_deviation");
    REFUSED(payload_deviation, 0, "learning.payload_deviation");
    REFUSED(payload_deviation, JP_Q16(256) + 1, "learning.payload_deviation");
    REFUSED(noise_relative, -1, "learning.noise_relative");
    REFUSED(noise_relative, JP_Q16_ONE + 1, "learning.noise_relative");
    REFUSED(noise_transient, -1, "learning.noise_transient");
    REFUSED(noise_transient, JP_Q16(16) + 1, "learning.noise_transient");
    REFUSED(noise, 0, "learning.noise");
    REFUSED(noise, JP_Q16(1024) + 1, "learning.noise");
    REFUSED(leg[0][0], JP_Q16(256) + 1, "learning.leg");
    REFUSED(leg[2][3], -JP_Q16(256) - 1, "learning.leg");
    REFUSED(leg_noise_relative, -1, "learning.leg_noise_relative");
    REFUSED(leg_noise_relative, JP_Q16_ONE + 1, "learning.leg_noise_relative");
    REFUSED(leg_noise_transient, -1, "learning.leg_noise_transient");
    REFUSED(leg_noise_transient, JP_Q16(16) + 1, "learning.leg_noise_transient");
    REFUSED(leg_spread, JP_Q16_ONE - 1, "learning.leg_spread");
    REFUSED(leg_spread, JP_Q16(16) + 1, "learning.leg_spread");
    REFUSED(leg_noise, 0, "learning.leg_noise");
    REFUSED(leg_noise, JP_Q16(1024) + 1, "learning.leg_noise");
    REFUSED(memory, 7, "learning.memory");
    REFUSED(memory, 1025, "learning.memory");
    REFUSED(identity, 0, "learning.identity");
}

static void test_check_takes_the_edges(void)
{
    TAKEN(direction[14][3], JP_Q16(4096));
    TAKEN(direction[0][0], -JP_Q16(4096));
    TAKEN(ground[0], -JP_Q16(16));
    TAKEN(payload[3], JP_Q16(256));
    TAKEN(ground_deviation, 1);
    TAKEN(payload_deviation, JP_Q16(256));
    TAKEN(noise_relative, 0);
    TAKEN(noise_relative, JP_Q16_ONE);
    TAKEN(noise_transient, JP_Q16(16));
    TAKEN(noise, 1);
    TAKEN(noise, JP_Q16(1024));
    TAKEN(leg[2][3], JP_Q16(256));
    TAKEN(leg[0][0], -JP_Q16(256));
    TAKEN(leg_noise_relative, 0);
    TAKEN(leg_noise_relative, JP_Q16_ONE);
    TAKEN(leg_noise_transient, 0);
    TAKEN(leg_noise_transient, JP_Q16(16));
    TAKEN(leg_spread, JP_Q16_ONE);
    TAKEN(leg_spread, JP_Q16(16));
    TAKEN(leg_noise, 1);
    TAKEN(leg_noise, JP_Q16(1024));
    TAKEN(memory, 8);
    TAKEN(memory, 1024);
}

#define STATE_REFUSED(member, value, name)                                                                             \
    do {                                                                                                               \
        setUp();                                                                                                       \
        state.member = (value);                                                                                        \
        TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_learner_restore(&learner, &state, &field));                            \
        TEST_ASSERT_EQUAL_STRING((name), field);                                                                       \
        TEST_ASSERT_EQUAL_INT32(0, learner.state.x[0]);                                                                \
        TEST_ASSERT_EQUAL_INT32(S_ONE, learner.state.s[0][0]);                                                         \
    } while (0)

#define STATE_TAKEN(member, value)                                                                                     \
    do {                                                                                                               \
        setUp();                                                                                                       \
        state.member = (value);                                                                                        \
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_learner_restore(&learner, &state, &field));                                    \
        TEST_ASSERT_EQUAL_INT(0, memcmp(&state, &learner.state, sizeof state));                                        \
    } while (0)

static void test_only_a_possible_state_is_restored(void)
{
    STATE_REFUSED(x[0], JP_LEARNED_MAX + 1, "state.x");
    STATE_REFUSED(x[3], -JP_LEARNED_MAX - 1, "state.x");
    STATE_REFUSED(s[0][0], 0, "state.s");
    STATE_REFUSED(s[3][3], 1 << 12, "state.s");
    STATE_REFUSED(s[3][3], S_ONE + (1 << 21), "state.s");
    STATE_REFUSED(s[2][1], INT32_MIN, "state.s");
    STATE_REFUSED(noise_scale, JP_Q16(0.25) - 1, "state.noise_scale");
    STATE_REFUSED(noise_scale, JP_Q16(256) + 1, "state.noise_scale");
    STATE_REFUSED(identity, LEARNING.identity + 1U, "state.identity");
    STATE_TAKEN(x[0], JP_LEARNED_MAX);
    STATE_TAKEN(x[3], -JP_LEARNED_MAX);
    STATE_TAKEN(s[3][3], 1 << 13);
    STATE_TAKEN(s[3][3], S_ONE + 1);
    STATE_TAKEN(noise_scale, JP_Q16(0.25));
    STATE_TAKEN(noise_scale, JP_Q16(256));
    STATE_TAKEN(version, UINT32_MAX);
}

static void test_null_is_an_argument(void)
{
    const struct jp_segment_command segment = stand;
    struct jp_forecast forecast = {0, 0};
    struct jp_forecast_sum sum = {0, {0}, 0};
    enum jp_learned learned;
    jp_q16 spare;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learning_check(NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learning_check(&learning, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learned_state_check(NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learned_state_check(&state, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learner_restore(NULL, &state, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learner_restore(&learner, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learner_restore(&learner, &state, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learner_update(NULL, &start, &segment, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learner_update(&learner, NULL, &segment, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learner_update(&learner, &start, NULL, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learner_update(&learner, &start, &segment, 0, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_add(NULL, &sum, &start, &segment));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_add(&learner, NULL, &start, &segment));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_add(&learner, &sum, NULL, &segment));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_add(&learner, &sum, &start, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_total(NULL, &sum, &forecast));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_total(&learner, NULL, &forecast));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_total(&learner, &sum, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_reserve(NULL, 0, JP_PROBABILITY_MIN, &spare));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_forecast_reserve(&forecast, 0, JP_PROBABILITY_MIN, NULL));
    TEST_ASSERT_EQUAL_UINT32(0, learner.state.version);
}

/* ---- Learning ---- */

static void test_a_robot_of_the_file_teaches_nothing_new(void)
{
    static const jp_q24 none[N] = {0};
    unsigned taken;

    taken = drive_as(none, 100);
    for (unsigned i = 0; i < N; i++) {
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), 0, learner.state.x[i]);
    }
    TEST_ASSERT_TRUE(taken > 90 && taken == learner.state.version);
    TEST_ASSERT_EQUAL_UINT32(0, learner.changes);
    TEST_ASSERT_EQUAL_UINT32(0, learner.outliers);
    TEST_ASSERT_EQUAL_INT(JP_CAUSE_NONE, learner.cause);
}

static void test_another_robot_is_learned(void)
{
    static const jp_q24 x[N] = {JP_Q24(1.5), JP_Q24(-1), JP_Q24(0.5), JP_Q24(1)};

    TEST_ASSERT_TRUE(drive_as(x, 200) > 190);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.02), x[0], learner.state.x[0]);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.02), x[1], learner.state.x[1]);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.2), x[2], learner.state.x[2]);
    for (unsigned i = 0; i < 20; i++) {
        const struct jp_segment_command segment = random_segment();
        const jp_q16 energy = energy_of(x, &segment);

        TEST_ASSERT_INT32_WITHIN(energy / 500 + JP_Q16(0.02), energy, energy_of(learner.state.x, &segment));
        (void)drive(&segment, energy);
    }
}

/* The residuals are 0: the scale falls to its least. */
static void test_noise_is_followed_downward(void)
{
    static const jp_q24 none[N] = {0};

    (void)drive_as(none, 400);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.25), learner.state.noise_scale);
}

/* More than twice the stated noise off, up and down by turns. */
static void drive_noisily(unsigned segments)
{
    static const jp_q24 none[N] = {0};

    for (unsigned i = 0; i < segments; i++) {
        const struct jp_segment_command segment = {{JP_Q24(0.5), 0}, 0, JP_Q16(10)};
        const jp_q16 energy = energy_of(none, &segment);
        const jp_q16 noise = energy / 100;

        (void)drive(&segment, i % 2U == 0U ? energy + noise : energy - noise);
    }
}

static void test_noise_is_followed_upward(void)
{
    drive_noisily(600);
    TEST_ASSERT_TRUE(learner.state.noise_scale > JP_Q16(1.5));
    TEST_ASSERT_TRUE(learner.state.noise_scale <= JP_Q16(8));
}

static void test_what_was_learned_makes_a_model(void)
{
    struct jp_energy_model model;

    learner.state.x[0] = JP_Q24(1);
    learner.state.x[3] = JP_Q24(-2);
    jp_learner_model(&learner, &model);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_energy_model_check(&model, &field));
    for (unsigned i = 0; i < JP_ENERGY_TERMS; i++) {
        TEST_ASSERT_EQUAL_INT32(BUILT_IN.a[i] + LEARNING.direction[i][0] - 2 * LEARNING.direction[i][3], model.a[i]);
    }
    TEST_ASSERT_EQUAL_INT32(BUILT_IN.b[0] + LEARNING.direction[13][0] - 2 * LEARNING.direction[13][3], model.b[0]);
    TEST_ASSERT_EQUAL_INT32(BUILT_IN.b[1] + LEARNING.direction[14][0] - 2 * LEARNING.direction[14][3], model.b[1]);
    TEST_ASSERT_EQUAL_INT32(BUILT_IN.electronics_power, model.electronics_power);
    TEST_ASSERT_EQUAL_INT32(BUILT_IN.settling_time, model.settling_time);
    TEST_ASSERT_EQUAL_INT32(BUILT_IN.voltage_per_speed, model.voltage_per_speed);
}

static void test_a_learned_model_keeps_its_ranges(void)
{
    struct jp_energy_model model;

    for (int sign = -1; sign <= 1; sign += 2) {
        learning.direction[0][0] = JP_Q16(4096);
        learning.direction[14][1] = JP_Q16(4096);
        for (unsigned i = 0; i < N; i++) {
            learner.state.x[i] = sign * JP_LEARNED_MAX;
        }
        jp_learner_model(&learner, &model);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_energy_model_check(&model, &field));
        TEST_ASSERT_EQUAL_INT32(sign * JP_Q16(4096), model.a[0]);
        TEST_ASSERT_EQUAL_INT32(sign > 0 ? JP_Q16(4096) : 0, model.b[1]);
    }
}

static void test_x_saturates(void)
{
    static const jp_q24 far[N] = {JP_LEARNED_MAX, 0, 0, 0};

    for (unsigned i = 0; i < 60; i++) {
        const struct jp_segment_command segment = random_segment();

        (void)drive(&segment, 2 * energy_of(far, &segment));
    }
    TEST_ASSERT_EQUAL_INT32(JP_LEARNED_MAX, learner.state.x[0]);
}

/* ---- What is left out ---- */

static void test_a_stand_teaches_nothing_and_forgets_nothing(void)
{
    static const jp_q24 x[N] = {JP_Q24(0.5), 0, 0, 0};

    (void)drive_as(x, 50);
    (void)drive(&stand, energy_of(x, &stand));
    (void)drive(&stand, energy_of(x, &stand));
    state = learner.state;
    for (unsigned i = 0; i < 1000; i++) {
        TEST_ASSERT_EQUAL_INT(JP_LEARNED_NOTHING, drive(&stand, i % 2U == 0U ? JP_Q16(40) : INT32_MAX));
    }
    TEST_ASSERT_EQUAL_INT(0, memcmp(&state, &learner.state, sizeof state));
}

static void test_an_outlier_counts_as_if_it_were_nearer(void)
{
    static const jp_q24 x[N] = {JP_Q24(0.5), 0, 0, 0};

    (void)drive_as(x, 50);
    for (uint32_t i = 0; i < 10; i++) {
        const struct jp_segment_command segment = random_segment();
        const struct jp_learner before = learner;
        const struct jp_energy_start from = start;

        TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER,
                              drive(&segment, i % 2U == 0U ? 3 * energy_of(x, &segment) + JP_Q16(5) : INT32_MIN / 2));
        state = learner.state;
        learner = before;
        start = from;
        TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER, drive(&segment, i % 2U == 0U ? INT32_MAX : INT32_MIN));
        TEST_ASSERT_EQUAL_INT(0, memcmp(&state, &learner.state, sizeof state));
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.05), before.state.x[0], learner.state.x[0]);
        TEST_ASSERT_EQUAL_UINT32(i + 1U, learner.outliers);
        TEST_ASSERT_EQUAL_UINT32(before.state.version + 1U, learner.state.version);
        TEST_ASSERT_TRUE(learner.state.noise_scale > before.state.noise_scale);
        TEST_ASSERT_TRUE(drive_as(x, 20) >= 18);
    }
    TEST_ASSERT_EQUAL_UINT32(0, learner.changes);
}

static void test_counters_saturate(void)
{
    static const jp_q24 x[N] = {0};
    const struct jp_segment_command segment = {{JP_Q24(0.5), 0}, 0, JP_Q16(10)};

    (void)drive_as(x, 20);
    learner.outliers = UINT32_MAX;
    learner.changes = UINT32_MAX;
    learner.state.version = UINT32_MAX;
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER, drive(&segment, INT32_MAX));
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER, drive(&segment, INT32_MAX));
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_CHANGE, drive(&segment, INT32_MAX));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, learner.outliers);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, learner.changes);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, learner.state.version);
}

static void test_what_the_model_refuses_is_not_learned(void)
{
    struct jp_segment_command segment = {{JP_Q24(0.5), 0}, 0, JP_Q16(0.4)};
    enum jp_learned learned = JP_LEARNED_CHANGE;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learner_update(&learner, &start, &segment, 0, &learned));
    segment = (struct jp_segment_command){{JP_Q24(8), JP_Q24(8)}, 0, JP_Q16(16384)};
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_learner_update(&learner, &start, &segment, 0, &learned));
    /* Here the model's energy alone does not fit, and then what x makes of it. */
    segment = (struct jp_segment_command){{JP_Q24(1), 0}, 0, JP_Q16(6000)};
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_learner_update(&learner, &start, &segment, 0, &learned));
    segment.duration = JP_Q16(1000);
    learning.direction[13][2] = JP_Q16(100);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_learner_update(&learner, &start, &segment, 0, &learned));
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_CHANGE, learned);
    TEST_ASSERT_EQUAL_UINT32(0, learner.state.version);
}

static void test_without_a_horizon_segments_must_settle(void)
{
    struct jp_segment_command segment = {{JP_Q24(0.5), 0}, 0, BUILT_IN.settling_time - 1};
    enum jp_learned learned = JP_LEARNED_NOTHING;
    jp_q16 energy = 0;

    jp_learner_start(&learner, &learning, &BUILT_IN, NULL);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_learner_update(&learner, &start, &segment, 0, &learned));
    segment.duration++;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_energy_predict(&BUILT_IN, &start.motion, &segment, &energy));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learner_update(&learner, &start, &segment, energy, &learned));
    TEST_ASSERT_EQUAL_INT(JP_LEARNED, learned);
}

/* Of so little noise that what x changes is beyond the filter's format. */
static void test_tiny_noise_is_taken_for_more(void)
{
    static const jp_q24 x[N] = {JP_Q24(1), JP_Q24(-1), 0, 0};

    learning.noise = 1;
    learning.noise_relative = 0;
    learning.noise_transient = 0;
    learner.state.noise_scale = JP_Q16(0.25);
    (void)drive_as(x, 300);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.02), x[0], learner.state.x[0]);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.02), x[1], learner.state.x[1]);
}

/* Of so much that its format holds no more, and the deviation's even less. */
static void test_huge_noise_saturates(void)
{
    const struct jp_segment_command segment = {{JP_Q24(1), 0}, 0, JP_Q16(1000)};
    struct jp_forecast_sum sum = {0, {0}, 0};

    learning.noise_relative = JP_Q16_ONE;
    learner.state.noise_scale = JP_Q16(8);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_forecast_add(&learner, &sum, &start, &segment));
    TEST_ASSERT_TRUE(sum.variance == (uint64_t)((int64_t)INT32_MAX * INT32_MAX) >> 16);
    learning.direction[13][0] = JP_Q16(30);
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER - 2, drive(&segment, INT32_MIN));
}

/* ---- Changes ---- */

/* x of a robot on other ground or with a payload, by what the table says of them. */
static void test_a_change_is_noticed_and_learned(void)
{
    static const jp_q24 before[N] = {0};
    static const jp_q24 after[N] = {JP_Q24(1.2), JP_Q24(-1), JP_Q24(0.2), 0};
    unsigned noticed = 0;

    (void)drive_as(before, 50);
    for (unsigned i = 1; i <= 20; i++) {
        const struct jp_segment_command segment = random_segment();

        if (drive(&segment, energy_of(after, &segment)) == JP_LEARNED_CHANGE) {
            noticed = i;
        }
    }
    TEST_ASSERT_TRUE(noticed >= 2 && noticed <= 8);
    TEST_ASSERT_EQUAL_UINT32(1, learner.changes);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.05), after[0], learner.state.x[0]);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.05), after[1], learner.state.x[1]);
}

/* Uncertain again, but from what was known. */
static void test_a_change_keeps_x_and_begins_anew(void)
{
    static const jp_q24 x[N] = {JP_Q24(0.5), JP_Q24(0.5), 0, 0};
    struct jp_segment_command segment;
    enum jp_learned learned;

    (void)drive_as(x, 100);
    state = learner.state;
    do {
        segment = random_segment();
        learned = drive(&segment, 2 * energy_of(x, &segment));
    } while (learned == JP_LEARNED_OUTLIER);
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_CHANGE, learned);
    TEST_ASSERT_EQUAL_UINT32(2, learner.outliers);
    TEST_ASSERT_EQUAL_UINT32(state.version + 3U, learner.state.version);
    TEST_ASSERT_EQUAL_UINT32(state.version + 2U, learner.watch.before_change.version);
    TEST_ASSERT_TRUE(learner.state.noise_scale >= JP_Q16_ONE);
}

static void test_a_change_keeps_a_larger_noise(void)
{
    const struct jp_segment_command segment = {{JP_Q24(0.5), 0}, 0, JP_Q16(10)};
    static const jp_q24 x[N] = {0};
    unsigned outliers = 0;

    (void)drive_as(x, 8);
    learner.state.noise_scale = JP_Q16(3);
    while (drive(&segment, INT32_MAX) == JP_LEARNED_OUTLIER) {
        outliers++;
    }
    TEST_ASSERT_EQUAL_UINT32(2, outliers);
    TEST_ASSERT_TRUE(learner.state.noise_scale >= JP_Q16(3));
}

/* What the first segments take too much is no change but noise: by so much that the alarm is not raised by it again. */
static void test_noise_that_is_larger_than_believed(void)
{
    static const jp_q24 x[N] = {0};
    const struct jp_segment_command segment = {{JP_Q24(0.5), 0}, 0, JP_Q16(10)};

    for (unsigned settled = 7; settled <= 8; settled++) {
        enum jp_learned learned = JP_LEARNED;
        jp_q16 scale;

        setUp();
        (void)drive_as(x, settled - 2U);
        for (unsigned i = 0; i < 3; i++) {
            scale = learner.state.noise_scale;
            learned = drive(&segment, INT32_MAX);
        }
        TEST_ASSERT_EQUAL(settled == 7U ? JP_LEARNED_OUTLIER : JP_LEARNED_CHANGE, learned);
        TEST_ASSERT_EQUAL_UINT32(settled == 7U ? 0 : 1, learner.changes);
        TEST_ASSERT_EQUAL_UINT32(settled == 7U ? 7 : 9, learner.state.version);
        TEST_ASSERT_EQUAL_INT32(0, learner.watch.alarm);
        TEST_ASSERT_EQUAL(settled == 7U, learner.state.s[0][0] == S_ONE);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), settled == 7U ? jp_q16_multiply(scale, JP_Q16(3.39)) : scale,
                                 learner.state.noise_scale);
    }
}

static void test_noise_has_a_limit(void)
{
    const struct jp_segment_command segment = {{JP_Q24(0.5), 0}, 0, JP_Q16(10)};

    learner.state.noise_scale = JP_Q16(255);
    for (unsigned i = 0; i < 4; i++) {
        (void)drive(&segment, i % 2U == 0U ? INT32_MAX : INT32_MIN);
        TEST_ASSERT_TRUE(learner.state.noise_scale <= JP_Q16(256));
    }
}

/* A table whose x tells ground and payload well. */
static void tell_causes(void)
{
    static const jp_q16 ground[N] = {JP_Q16(0.26), JP_Q16(-0.13), JP_Q16(0.02), 0};
    static const jp_q16 payload[N] = {JP_Q16(0.38), JP_Q16(0.41), JP_Q16(-0.16), JP_Q16(0.07)};

    memcpy(learning.ground, ground, sizeof ground);
    memcpy(learning.payload, payload, sizeof payload);
    learning.ground_deviation = JP_Q16(0.028);
    learning.payload_deviation = JP_Q16(0.158);
}

/* Moves x by what most changes a cause and least the other one, and returns what is told of it. */
static enum jp_cause cause_after(const jp_q24 x[N], unsigned segments)
{
    static const jp_q24 before[N] = {0};

    (void)drive_as(before, 40);
    (void)drive_as(x, 8);
    TEST_ASSERT_EQUAL_UINT32(1, learner.changes);
    TEST_ASSERT_EQUAL_INT(JP_CAUSE_NONE, learner.cause);
    (void)drive_as(x, segments);
    return learner.cause;
}

static void test_ground_is_told_as_the_cause(void)
{
    static const jp_q24 rough[N] = {JP_Q24(1.4), JP_Q24(-1.5), 0, 0};
    jp_q16 ground, payload;

    tell_causes();
    TEST_ASSERT_EQUAL_INT(JP_CAUSE_GROUND, cause_after(rough, 12));
    jp_learner_causes(&learner, &ground, &payload);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.1), JP_Q16(1.56), ground);
}

static void test_payload_is_told_as_the_cause(void)
{
    static const jp_q24 laden[N] = {JP_Q24(1), JP_Q24(1.6), 0, 0};
    jp_q16 ground, payload;

    tell_causes();
    TEST_ASSERT_EQUAL_INT(JP_CAUSE_PAYLOAD, cause_after(laden, 12));
    jp_learner_causes(&learner, &ground, &payload);
    TEST_ASSERT_TRUE(payload > JP_Q16(0.8));
}

/* At first those of x ~ N(0, I), at last those of what x does not tell. */
static void test_causes_have_deviations(void)
{
    static const jp_q24 none[N] = {0};
    jp_q16 ground, payload;
    jp_q16 last_ground, last_payload;
    int64_t variance;

    tell_causes();
    variance = (int64_t)learning.payload_deviation * learning.payload_deviation;
    jp_learner_cause_deviations(&learner, &ground, &payload);
    for (unsigned i = 0; i < N; i++) {
        variance += (int64_t)learning.payload[i] * learning.payload[i];
    }
    TEST_ASSERT_INT32_WITHIN(2, (int32_t)jp_square_root((uint64_t)variance), payload);
    (void)drive_as(none, 200);
    jp_learner_cause_deviations(&learner, &last_ground, &last_payload);
    TEST_ASSERT_TRUE(last_ground < ground / 2 && last_ground >= learning.ground_deviation);
    TEST_ASSERT_TRUE(last_payload < payload / 2 && last_payload >= learning.payload_deviation);
}

static void test_neither_is_told_as_another_cause(void)
{
    static const jp_q24 laden[N] = {JP_Q24(1), JP_Q24(1.6), 0, 0};

    tell_causes();
    learning.ground_deviation = JP_Q16(16);
    learning.payload_deviation = JP_Q16(256);
    TEST_ASSERT_EQUAL_INT(JP_CAUSE_OTHER, cause_after(laden, 12));
    learning.payload_deviation = 1;
    (void)drive_as(laden, 10);
    TEST_ASSERT_EQUAL_INT(JP_CAUSE_PAYLOAD, learner.cause);
    learning.payload_deviation = JP_Q16(256);
    (void)drive_as(laden, 60);
    TEST_ASSERT_EQUAL_INT(JP_CAUSE_OTHER, learner.cause);
    learning.payload_deviation = 1;
    (void)drive_as(laden, 60);
    TEST_ASSERT_EQUAL_INT(JP_CAUSE_OTHER, learner.cause);
}

/* A change to less is told by its size, too. */
static void test_ground_gets_smoother(void)
{
    static const jp_q24 smooth[N] = {JP_Q24(-1.4), JP_Q24(1.5), 0, 0};
    jp_q16 ground, payload;

    TEST_ASSERT_EQUAL_INT(JP_CAUSE_GROUND, cause_after(smooth, 12));
    learner.state.x[0] = -JP_LEARNED_MAX;
    jp_learner_causes(&learner, &ground, &payload);
    TEST_ASSERT_EQUAL_INT32(0, ground);
}

/* ---- The filter ---- */

static void test_forgetting_ends_at_what_was_known_first(void)
{
    jp_square_root_matrix s = {{S_ONE / 1000, S_ONE / 3000, -S_ONE / 2000, 0},
                               {0, S_ONE / 5000, S_ONE / 4000, S_ONE / 9000},
                               {S_ONE / 7000, 0, S_ONE / 2, 0},
                               {0, S_ONE / 8000, 0, S_ONE / 16000}};

    for (uint32_t i = 0; i < 400; i++) {
        jp_filter_forget(s, 8);
    }
    for (unsigned i = 0; i < N; i++) {
        for (unsigned j = 0; j < N; j++) {
            int64_t sum = 0;

            for (unsigned k = 0; k < N; k++) {
                sum += (int64_t)s[i][k] * s[j][k];
            }
            TEST_ASSERT_INT32_WITHIN(64, i == j ? S_ONE : 0, (int32_t)(sum >> 30));
        }
    }
}

/* After `memory` segments information is down to 1/e. */
static void test_memory_is_what_it_says(void)
{
    static const uint32_t memories[] = {8, 64, 1024};

    for (unsigned m = 0; m < 3; m++) {
        jp_square_root_matrix s;

        jp_filter_start(s);
        s[2][2] = S_ONE / 1024;
        for (uint32_t i = 0; i < memories[m]; i++) {
            jp_filter_forget(s, memories[m]);
        }
        TEST_ASSERT_INT32_WITHIN(S_ONE / 1024 / 40, (int32_t)(1.6487 / 1024 * S_ONE), s[2][2]);
        TEST_ASSERT_EQUAL_INT32(S_ONE, s[0][0]);
    }
}

static void test_a_measurement_is_weighed_by_what_is_known(void)
{
    static const int32_t h[N] = {JP_FILTER_ONE, 0, -JP_FILTER_ONE, 0};
    struct jp_filter_step step;
    jp_square_root_matrix s;
    jp_q24 x[N] = {0};

    jp_filter_start(s);
    jp_filter_expect(s, h, &step);
    TEST_ASSERT_INT32_WITHIN(2, (int32_t)(1.7320508 * JP_FILTER_ONE), (int32_t)step.deviation);
    TEST_ASSERT_INT32_WITHIN(20000, S_ONE / 3, jp_filter_noise_share(&step));
    /* √3 deviations are an error of 3, of which P h/(h P h + 1) = 1/3 goes to each. */
    jp_filter_take(s, x, &step, (int32_t)(1.7320508 * JP_FILTER_ONE));
    TEST_ASSERT_INT32_WITHIN(64, JP_Q24(1), x[0]);
    TEST_ASSERT_INT32_WITHIN(64, -JP_Q24(1), x[2]);
    TEST_ASSERT_EQUAL_INT32(0, x[1]);

    /* P = I − h hᵀ/3 */
    const int32_t unit[N] = {JP_Q16_ONE, 0, 0, 0};
    const int32_t both[N] = {JP_Q16_ONE, 0, -JP_Q16_ONE, 0};
    const int32_t other[N] = {0, JP_Q16_ONE, 0, 0};

    TEST_ASSERT_INT32_WITHIN(20000, S_ONE / 3 * 2, (int32_t)(jp_filter_variance(s, unit) >> 2));
    TEST_ASSERT_INT32_WITHIN(20000, S_ONE / 3 * 2, (int32_t)(jp_filter_variance(s, both) >> 2));
    TEST_ASSERT_INT32_WITHIN(20000, S_ONE, (int32_t)(jp_filter_variance(s, other) >> 2));
}
