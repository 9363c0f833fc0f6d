/* What learners of every kind do with a measurement: from how little they learn, how fast the noise follows, mirror
 * images, what a stored state may be. */
#include "src/learn/learned_state.h"
#include "src/learn/learner_filter.h"
#include "unity.h"

#define N      JP_LEARNING_DIRECTIONS
#define S_ONE  ((int32_t)1 << 30)
#define MEMORY 256U

static struct jp_learned_state state;
static struct jp_learned_watch watch;
static struct jp_expectation expected;

/* A drive of 10 J that tells of all directions, with a noise of 1 J. */
void setUp(void)
{
    jp_learned_state_start(&state, 7);
    watch = (struct jp_learned_watch){0};
    expected = (struct jp_expectation){.energy = JP_Q16(10), .noise = JP_Q16_ONE, .spread = JP_Q16_ONE};
    for (int j = 0; j < N; j++) {
        expected.sensitivity[j] = JP_Q16(0.7) - j * JP_Q16(0.4);
    }
}

void tearDown(void)
{
}

static enum jp_learned measure(jp_q16 error)
{
    return jp_learned_state_update(&state, &watch, MEMORY, &expected, expected.energy + error);
}

static void forget_sensitivities(void)
{
    for (int j = 0; j < N; j++) {
        expected.sensitivity[j] = 0;
    }
}

/* ---- How much it takes ---- */

/* 64 segments of an eighth of the noise give as much as the prior; of less nothing is learned. */
static void test_the_least_to_learn_from_is_an_eighth_of_the_noise(void)
{
    for (int j = 0; j < N; j++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            setUp();
            forget_sensitivities();
            expected.sensitivity[j] = sign * (JP_Q16(0.125) - 1);
            TEST_ASSERT_EQUAL_INT(JP_LEARNED_NOTHING, measure(JP_Q16_ONE));
            TEST_ASSERT_EQUAL_UINT32(0, state.version);
            expected.sensitivity[j] = sign * JP_Q16(0.125);
            TEST_ASSERT_EQUAL_INT(JP_LEARNED, measure(JP_Q16_ONE));
            TEST_ASSERT_EQUAL_UINT32(1, state.version);
        }
    }
}

/* A sixteenth in each of four is an eighth. */
static void test_directions_tell_together(void)
{
    forget_sensitivities();
    for (int j = 0; j < N; j++) {
        expected.sensitivity[j] = JP_Q16(0.0625) - 1;
    }
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_NOTHING, measure(0));
    expected.sensitivity[N - 1] = JP_Q16(0.0625) + 5;
    TEST_ASSERT_EQUAL_INT(JP_LEARNED, measure(0));
}

/* A thousand times the noise is the most that has a format: the noise is taken for more, in whichever direction. */
static void test_sensitivities_beyond_the_format_make_noise(void)
{
    for (int j = 0; j < N; j++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            setUp();
            forget_sensitivities();
            expected.noise = 1;
            expected.sensitivity[j] = sign * JP_Q16(4096);
            TEST_ASSERT_EQUAL_INT(JP_LEARNED, measure(JP_Q16(2048)));
            TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), sign * JP_Q24(0.5), state.x[j]);
        }
    }
}

/* ---- What is learned ---- */

/* Of one number and a prior of variance 1, exactly known: x = h e/(h² + 1). */
static void test_one_measurement_is_weighed_against_the_prior(void)
{
    for (int j = 0; j < N; j++) {
        setUp();
        forget_sensitivities();
        expected.sensitivity[j] = JP_Q16(2);
        TEST_ASSERT_EQUAL_INT(JP_LEARNED, measure(JP_Q16(1.5)));
        for (int i = 0; i < N; i++) {
            TEST_ASSERT_INT32_WITHIN(128, i == j ? JP_Q24(0.6) : 0, state.x[i]);
        }
        /* What is left of the variance: 1/(h² + 1). */
        TEST_ASSERT_INT32_WITHIN(4096, 480191554, state.s[j][j]);
    }
}

/* An error to the other side teaches the mirror image, to the bit: nothing drifts by rounding. */
static void test_errors_to_both_sides_are_mirror_images(void)
{
    unsigned unlike = 0;

    for (int32_t k = 1; k <= 12; k++) {
        jp_q24 x[N];

        setUp();
        expected.sensitivity[0] += 977 * k;
        (void)measure(7919 * k);
        for (int j = 0; j < N; j++) {
            x[j] = state.x[j];
        }
        jp_learned_state_start(&state, 7);
        (void)measure(-7919 * k);
        for (int j = 0; j < N; j++) {
            TEST_ASSERT_INT32_WITHIN(1, -x[j], state.x[j]);
            unlike += state.x[j] == -x[j] ? 0U : 1U;
        }
    }
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(2, unlike);
}

/* A direction of the other sign, too. */
static void test_the_filter_has_no_side(void)
{
    int32_t s[N][N];
    int32_t h[N];
    int32_t mirrored[N];
    struct jp_filter_step step;
    struct jp_filter_step other;
    unsigned unlike = 0;

    jp_filter_start(s);
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            s[i][j] = S_ONE / (3 + i + j) - (i < j ? S_ONE / 5 : 0);
        }
        h[i] = 1000003 * (i + 1) - 2500000;
        mirrored[i] = -h[i];
    }
    jp_filter_expect(s, h, &step);
    jp_filter_expect(s, mirrored, &other);
    TEST_ASSERT_EQUAL_UINT32(step.deviation, other.deviation);
    for (int j = 0; j < N; j++) {
        unlike += step.v[j] == -other.v[j] ? 0U : 1U;
    }
    TEST_ASSERT_EQUAL_UINT32(0, unlike);
}

/* After a change the measurement that told of it is weighed against the prior, as the first one. */
static void test_a_change_is_learned_from_as_from_the_first_measurement(void)
{
    enum jp_learned learned = JP_LEARNED;
    jp_q24 before = 0;

    forget_sensitivities();
    expected.sensitivity[0] = JP_Q16(2);
    for (int i = 0; i < 30; i++) {
        (void)measure(0);
    }
    for (int i = 0; i < 4 && learned != JP_LEARNED_CHANGE; i++) {
        before = state.x[0];
        learned = measure(JP_Q16(7.5));
    }
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_CHANGE, learned);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), before + JP_Q24(3), state.x[0]);
    TEST_ASSERT_EQUAL_INT32(0, watch.alarm);
}

/* ---- Noise ---- */

/* Errors of twice what is expected, to both sides: their excess moves the scale by 1/128 each. */
static void test_the_noise_follows_over_128_segments(void)
{
    forget_sensitivities();
    expected.sensitivity[0] = JP_Q16(0.125); /* of which hardly anything is learned */
    for (int i = 0; i < 8; i++) {
        expected.noise = JP_Q16_ONE;
        (void)measure(i % 2 == 0 ? JP_Q16(1.5) : -JP_Q16(1.5));
    }
    /* 1.25/128 of itself each, less what the uncertainty of x explains: 1.6 % of it, and less and less. */
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.004), JP_Q16(1.077), state.noise_scale);
}

static void test_a_deviation_is_scaled_and_never_none(void)
{
    state.noise_scale = JP_Q16(2.5);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(7.5), jp_learned_noise(&state, jp_square(JP_Q16(3))));
    TEST_ASSERT_EQUAL_INT32(1, jp_learned_noise(&state, 0));
    state.noise_scale = JP_Q16(8);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_learned_noise(&state, jp_square(INT32_MAX)));
}

/* ---- What is stored ---- */

static void expect_stored(enum jp_status status)
{
    const char *field = "none";

    TEST_ASSERT_EQUAL_INT(status, jp_learned_state_check(&state, &field));
    if (status != JP_OK) {
        TEST_ASSERT_EQUAL_STRING("state.s", field);
    }
    setUp();
}

/* No row is longer than 1 + 2^-10 nor shorter than 2^-17, whichever it is. */
static void test_rows_have_their_lengths(void)
{
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            state.s[i][i] = 0;
            state.s[i][j] = S_ONE + (S_ONE >> 10) - 512;
            expect_stored(JP_OK);
            state.s[i][i] = 0;
            state.s[i][j] = -(S_ONE + (S_ONE >> 10));
            expect_stored(JP_ERR_CONFIG);
            state.s[i][i] = 0;
            state.s[i][j] = S_ONE >> 17;
            expect_stored(JP_OK);
            state.s[i][i] = 0;
            state.s[i][j] = 1 - (S_ONE >> 17);
            expect_stored(JP_ERR_CONFIG);
        }
    }
}

static void test_any_version_and_identity_can_be_stored(void)
{
    state.version = UINT32_MAX / 2U;
    state.identity = UINT32_MAX / 2U;
    expect_stored(JP_OK);
}
