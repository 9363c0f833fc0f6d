/* The energy model: its check, and predictions worked out by hand. */
#include <joulepath/energy.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "tests/support/energy_unit.h"
#include "unity.h"

/* 0.001 J */
#define TOLERANCE 66

static const struct jp_motion rest;

void setUp(void)
{
}

void tearDown(void)
{
}

static jp_q16 predict(struct jp_motion before, struct jp_segment_command segment)
{
    jp_q16 energy = 0;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_predict(&jp_energy_model_published, &before, &segment, &energy));
    return energy;
}

/* What has no fraction is not rounded. */
static void test_a_stand_takes_what_the_electronics_take(void)
{
    struct jp_energy_model model = jp_energy_model_published;
    const struct jp_segment_command stand = {{0, 0}, 0, JP_Q16(20)};
    jp_q16 energy = 0;

    model.electronics_power = JP_Q16(5.75);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_predict(&model, &rest, &stand, &energy));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(115), energy);
    model.electronics_power = JP_Q16(5.75) - 1; /* 20 bits of 2⁻¹⁶ J less */
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_predict(&model, &rest, &stand, &energy));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(115) - 20, energy);
}

static void test_published_model_passes_its_check(void)
{
    const char *field = NULL;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_model_check(&jp_energy_model_published, &field));
}

static void expect_bad_field(const struct jp_energy_model *model, const char *name)
{
    const char *field = "none";
    TEST_ASSERT_EQUAL_INT32(JP_ERR_CONFIG, jp_energy_model_check(model, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
}

#define EXPECT_RANGE(member, low, high, name)                                                                          \
    do {                                                                                                               \
        struct jp_energy_model model = jp_energy_model_published;                                                      \
        const char *field = "none";                                                                                    \
        model.member = (low);                                                                                          \
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_model_check(&model, &field));                                         \
        model.member = (high);                                                                                         \
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_model_check(&model, &field));                                         \
        model.member = (low)-1;                                                                                        \
        expect_bad_field(&model, name);                                                                                \
        model.member = (high) + 1;                                                                                     \
        expect_bad_field(&model, name);                                                                                \
    } while (0)

static void test_check_names_each_field_at_both_limits(void)
{
    EXPECT_RANGE(a[0], -JP_Q16(4096), JP_Q16(4096), "model.a");
    EXPECT_RANGE(a[12], -JP_Q16(4096), JP_Q16(4096), "model.a");
    EXPECT_RANGE(b[0], 0, JP_Q16(4096), "model.b");
    EXPECT_RANGE(b[1], 0, JP_Q16(4096), "model.b");
    EXPECT_RANGE(electronics_power, 1, JP_Q16(4096), "model.electronics_power");
    EXPECT_RANGE(settling_time, 0, JP_Q16(60), "model.settling_time");
    EXPECT_RANGE(voltage_per_speed, 0, JP_Q16(256), "model.voltage_per_speed");
    EXPECT_RANGE(voltage_per_turn_rate, 0, JP_Q16(256), "model.voltage_per_turn_rate");
    EXPECT_RANGE(unit_exponent, -15, 15, "model.unit_exponent");
}

static void test_any_resistance_above_nothing(void)
{
    struct jp_energy_model model = jp_energy_model_published;
    const char *field = "none";

    model.motor_resistance = INT32_MAX;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_model_check(&model, &field));
    model.motor_resistance = 0;
    expect_bad_field(&model, "model.motor_resistance");
}

static void test_standing_costs_the_electronics(void)
{
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(60), predict(rest, (struct jp_segment_command){rest, 0, JP_Q16(10)}));
}

/* a1 0.25 + b1 0.25 (20 − 5.82) + 6·20 */
static void test_start_from_rest(void)
{
    struct jp_segment_command segment = {{JP_Q24(0.5), 0}, 0, JP_Q16(20)};
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(43.05 + 73.84235 + 120), predict(rest, segment));
}

/* a3 σ² + Ps T */
static void test_turn_on_the_spot(void)
{
    struct jp_segment_command segment = {rest, JP_Q24(-1), JP_Q16(10)};
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(13.2 + 60), predict(rest, segment));
}

/* a2 0.09 + b2 0.09 (10 − 5.82) + a6 0.3·0.5 + a3 0.25 + 60 */
static void test_cross_term_of_turn_and_turn_rate(void)
{
    struct jp_segment_command segment = {{0, JP_Q24(0.3)}, JP_Q24(0.5), JP_Q16(10)};
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(0.6813 + 0.349866 + 0.2055 + 3.3 + 60), predict(rest, segment));
}

/* Steady: a13 P₋ + b1 (T − Ts) + Ps T, where P₋ = 2 cv²/Rm = 20.86286 W. */
static void test_steady_motion(void)
{
    struct jp_motion cruise = {JP_Q24(1), 0};
    struct jp_segment_command segment = {cruise, 0, JP_Q16(10)};
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(121.42184 + 87.0694 + 60), predict(cruise, segment));
}

/* Braking adds a1 − cv (a7 + a10) to the stand. */
static void test_braking(void)
{
    struct jp_motion cruise = {JP_Q24(1), 0};
    struct jp_segment_command segment = {rest, 0, JP_Q16(10)};
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(121.42184 + 172.2 - 269.24352 + 60), predict(cruise, segment));
}

static void expect_out_of_range(struct jp_motion before, struct jp_segment_command segment)
{
    jp_q16 energy = 77;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_predict(&jp_energy_model_published, &before, &segment, &energy));
    TEST_ASSERT_EQUAL_INT32(77, energy);
}

static void test_arguments_out_of_range(void)
{
    const struct jp_motion fast = {JP_Q24(8) + 1, 0};
    const struct jp_motion spin = {0, -JP_Q24(8) - 1};
    const jp_q16 settled = jp_energy_model_published.settling_time;
    expect_out_of_range(fast, (struct jp_segment_command){rest, 0, JP_Q16(10)});
    expect_out_of_range(spin, (struct jp_segment_command){rest, 0, JP_Q16(10)});
    expect_out_of_range(rest, (struct jp_segment_command){fast, 0, JP_Q16(10)});
    expect_out_of_range(rest, (struct jp_segment_command){spin, 0, JP_Q16(10)});
    expect_out_of_range(rest, (struct jp_segment_command){rest, JP_Q24(6.3), JP_Q16(10)});
    expect_out_of_range(rest, (struct jp_segment_command){rest, 0, settled - 1});
    expect_out_of_range(rest, (struct jp_segment_command){rest, 0, JP_Q16(16384) + 1});
}

static void test_null_pointers(void)
{
    const struct jp_energy_model *model = &jp_energy_model_published;
    const struct jp_segment_command segment = {rest, 0, JP_Q16(10)};
    const char *field = "none";
    jp_q16 energy = 77;

    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_model_check(NULL, &field));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_model_check(model, NULL));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_predict(NULL, &rest, &segment, &energy));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_predict(model, NULL, &segment, &energy));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_predict(model, &rest, NULL, &energy));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_energy_predict(model, &rest, &segment, NULL));
    TEST_ASSERT_EQUAL_STRING("none", field);
    TEST_ASSERT_EQUAL_INT32(77, energy);
}

static void test_overflow_saturates(void)
{
    struct jp_segment_command segment = {rest, 0, JP_Q16(16384)};
    jp_q16 energy = 0;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_energy_predict(&jp_energy_model_published, &rest, &segment, &energy));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, energy);
}

/* One robot in units of 2⁻³ to 2⁵ J: the same joules. */
static void test_the_unit_is_a_factor(void)
{
    const struct jp_motion before = {JP_Q24(0.3), JP_Q24(-0.2)};
    const struct jp_segment_command segment = {{JP_Q24(0.6), JP_Q24(0.3)}, JP_Q24(0.8), JP_Q16(12)};
    const jp_q16 joules = predict(before, segment);

    for (int32_t exponent = -3; exponent <= 5; exponent++) {
        const struct jp_energy_model model = energy_model_in_unit(&jp_energy_model_published, exponent);
        const char *field = "none";
        jp_q16 energy = 0;

        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_model_check(&model, &field));
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_predict(&model, &before, &segment, &energy));
        TEST_ASSERT_INT32_WITHIN(TOLERANCE, energy_in_unit(joules, exponent), energy);
    }
}

/* What 16 384 s of standing take fits a unit of 4 J. */
static void test_a_greater_unit_holds_more(void)
{
    const struct jp_energy_model model = energy_model_in_unit(&jp_energy_model_published, 2);
    const struct jp_segment_command segment = {rest, 0, JP_Q16(16384)};
    jp_q16 energy = 0;

    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_predict(&model, &rest, &segment, &energy));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(24576), energy);
}

/* The largest numbers that pass the checks overflow nothing but the result. */
static void test_extreme_model(void)
{
    struct jp_energy_model model = {
        .electronics_power = JP_Q16(4096),
        .settling_time = 0,
        .voltage_per_speed = JP_Q16(256),
        .voltage_per_turn_rate = JP_Q16(256),
        .motor_resistance = 1,
        .b = {JP_Q16(4096), JP_Q16(4096)},
    };
    for (int i = 0; i < JP_ENERGY_TERMS; i++) {
        model.a[i] = JP_Q16(4096);
    }
    const struct jp_motion back = {-JP_Q24(8), -JP_Q24(8)};
    struct jp_segment_command segment = {{JP_Q24(8), JP_Q24(8)}, JP_Q24(6.28), JP_Q16(16384)};
    jp_q16 energy = 0;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_energy_predict(&model, &back, &segment, &energy));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, energy);
    for (int i = 0; i < JP_ENERGY_TERMS; i++) {
        model.a[i] = -JP_Q16(4096);
    }
    segment.duration = 0;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_energy_predict(&model, &back, &segment, &energy));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, energy);
}
