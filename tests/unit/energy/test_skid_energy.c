/* The energy model of skid steer and differential drive: its check, motions worked out by hand, its limits. */
#include <joulepath/skid_energy.h>
#include <stddef.h>
#include <string.h>

#include "tests/support/config_check.h"
#include "unity.h"

/* 0.002 in Q16 */
#define TOLERANCE 131

/* Round numbers: 1000 N, treads at ±0.5 m that do not yield. */
static const struct jp_skid_energy_model round_numbers = {
    .half_track = JP_Q24(0.5),
    .weight = JP_Q16(1000),
    .rolling = JP_Q24(0.1),
    .friction = JP_Q24(0.8),
    .turning = JP_Q24(0.25),
    .inertia = JP_Q24(0.1),
    .turn_inertia = JP_Q24(0.2),
    .driving = JP_Q24(2),
    .braking = JP_Q24(0.5),
    .copper_driving = JP_Q16(100),
    .copper_braking = JP_Q16(25),
    .electronics_power = JP_Q16(20),
};

static const struct jp_skid_energy_model greatest = {
    .half_track = JP_Q24(4),
    .weight = JP_Q16(16384),
    .rolling = JP_Q24(0.5),
    .friction = JP_Q24(2),
    .turning = JP_Q24(4),
    .yielding = JP_Q24(16),
    .scrub = JP_Q24(4),
    .easing = JP_Q24(4),
    .bank_easing = JP_Q24(4),
    .tilting = JP_Q24(4),
    .inertia = JP_Q24(8),
    .turn_inertia = JP_Q24(8),
    .driving = JP_Q24(10),
    .braking = JP_Q24(1),
    .copper_driving = JP_Q16(16384),
    .copper_braking = JP_Q16(16384),
    .electronics_power = JP_Q16(1024),
    .unit_exponent = -JP_ENERGY_UNIT_EXPONENT_MAX,
};

static struct jp_skid_energy_model config;
static struct jp_skid_drive drive;
static struct jp_skid_piece piece;

void setUp(void)
{
    config = round_numbers;
    drive = (struct jp_skid_drive){0};
    piece = (struct jp_skid_piece){{JP_Q24_ONE, 0}, {JP_Q24_ONE, 0}, 0, 0, JP_Q16_ONE};
}

void tearDown(void)
{
}

/* ---- Check ---- */

DEFINE_EXPECT_CONFIG_OF(jp_skid_energy_check, round_numbers)

static void test_check_names_each_field_at_both_limits(void)
{
    expect_config(NULL);
    RANGE("skid_energy.", half_track, JP_Q24(0.01), JP_Q24(4));
    RANGE("skid_energy.", weight, JP_Q16(1), JP_Q16(16384));
    RANGE("skid_energy.", rolling, 0, JP_Q24(0.5));
    RANGE("skid_energy.", friction, JP_Q24(0.02), JP_Q24(2));
    RANGE("skid_energy.", turning, 0, JP_Q24(4));
    RANGE("skid_energy.", yielding, 0, JP_Q24(16));
    RANGE("skid_energy.", scrub, 0, JP_Q24(4));
    RANGE("skid_energy.", easing, 0, JP_Q24(4));
    RANGE("skid_energy.", bank_easing, 0, JP_Q24(4));
    RANGE("skid_energy.", tilting, 0, JP_Q24(4));
    RANGE("skid_energy.", inertia, 0, JP_Q24(8));
    RANGE("skid_energy.", turn_inertia, 0, JP_Q24(8));
    RANGE("skid_energy.", driving, JP_Q24(1), JP_Q24(10));
    RANGE("skid_energy.", braking, 0, JP_Q24(1));
    RANGE("skid_energy.", copper_driving, 0, JP_Q16(16384));
    RANGE("skid_energy.", copper_braking, 0, JP_Q16(16384));
    RANGE("skid_energy.", electronics_power, 0, JP_Q16(1024));
    RANGE("skid_energy.", unit_exponent, -JP_ENERGY_UNIT_EXPONENT_MAX, JP_ENERGY_UNIT_EXPONENT_MAX);
}

static void test_tables_pass_their_check(void)
{
    const char *field = "none";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_check(&jp_skid_energy_zhang2018, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_check(&jp_skid_energy_burger, &field));
}

/* ---- Power of steady motion ---- */

#define EXPECT_POWER(expected, speed, turn_rate, grade)                                                                \
    do {                                                                                                               \
        const struct jp_motion motion = {JP_Q24(speed), JP_Q24(turn_rate)};                                            \
        jp_q16 power = 0;                                                                                              \
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_power(&config, &motion, JP_Q24(grade), &power));                   \
        TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(expected), power);                                                  \
    } while (0)

/* 50 N a side: 2 · 50 W and 100 · 0.05² W of copper. */
static void test_straight_and_level(void)
{
    EXPECT_POWER(220.5, 1, 0, 0);
    EXPECT_POWER(220.5, -1, 0, 0);
    EXPECT_POWER(120.5, 0.5, 0, 0);
}

/* 150 N a side; what the windings take is that of the slope's own length. */
static void test_uphill(void)
{
    EXPECT_POWER(624.3269, 1, 0, 0.2);
    EXPECT_POWER(624.3269, -1, 0, -0.2);
}

/* −50 N a side, half of it comes back. */
static void test_downhill_half_comes_back(void)
{
    EXPECT_POWER(-29.8798, 1, 0, -0.2);
    EXPECT_POWER(-29.8798, -1, 0, 0.2);
}

/* 200 N against the turn and 50 N of rolling, each along the side's own motion at 0.5 m/s. */
static void test_on_the_spot(void)
{
    EXPECT_POWER(532.5, 0, 1, 0);
    EXPECT_POWER(532.5, 0, -1, 0);
}

/* The inner side stands and is held. */
static void test_about_one_side(void)
{
    EXPECT_POWER(527.25, 0.5, 1, 0);
    EXPECT_POWER(527.25, 0.5, -1, 0);
}

/* D = 1 + 0.8 · 0.5 on the spot, 1 + 0.8 · 2 at 2 m/s. */
static void test_treads_that_yield_turn_for_less(void)
{
    config.yielding = JP_Q24_ONE;
    EXPECT_POWER(413.1531, 0, 1, 0);
    /* Forces 0.05 ∓ 0.2/2.6 at 1.5 and 2.5 m/s; the inner side brakes. */
    EXPECT_POWER(20 - 0.5 * 40.38462 + 25 * 0.000724852 + 2 * 317.30769 + 100 * 0.01610947, 2, 1, 0);
}

/* s = 0.2² · 0.1 · 0.8/(2 · 0.6) m/s a side. */
static void test_treads_slip_under_an_effort(void)
{
    config.yielding = JP_Q24_ONE;
    config.scrub = JP_Q24(0.1);
    EXPECT_POWER(634.9936, 1, 0, 0.2);
}

/* What is left of the friction is not less than a quarter of it: 2 · 0.2. */
static void test_slip_under_a_great_effort_is_limited(void)
{
    config.yielding = JP_Q24_ONE;
    config.scrub = JP_Q24(0.1);
    config.rolling = 0;
    config.copper_driving = 0;
    EXPECT_POWER(20 + 2 * 2000 * (0.375 + 0.5625 * 0.1 * 0.8 / 0.4), 1, 0, 0.75);
}

/* r = 1 − 0.2²/0.8²: 0.1875 against the turn. */
static void test_turning_is_easier_on_slopes(void)
{
    config.easing = JP_Q24_ONE;
    EXPECT_POWER(507.7704, 0, 1, 0.2);
}

static void test_standing_takes_the_electronics(void)
{
    EXPECT_POWER(20, 0, 0, 0.2);
    EXPECT_POWER(20, 0, 0, 0);
}

static void test_power_that_does_not_fit_is_saturated(void)
{
    const struct jp_motion motion = {JP_Q24(7), 0};
    jp_q16 power = 0;

    config.weight = JP_Q16(16384);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_skid_energy_power(&config, &motion, JP_Q24_ONE, &power));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, power);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_skid_energy_power(&config, &motion, -JP_Q24_ONE, &power));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, power);
}

static void test_power_wants_pointers_and_ranges(void)
{
    struct jp_motion motion = {0, 0};
    jp_q16 power = 7;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_power(NULL, &motion, 0, &power));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_power(&config, NULL, 0, &power));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_power(&config, &motion, 0, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_power(&config, &motion, JP_Q24_ONE + 1, &power));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_power(&config, &motion, -JP_Q24_ONE - 1, &power));
    motion.speed = JP_Q24(8) + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_power(&config, &motion, 0, &power));
    TEST_ASSERT_EQUAL_INT32(7, power);
}

/* ---- Drives ---- */

static void add(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(&config, &drive, &piece));
}

static void expect_energy(int32_t expected)
{
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, expected, (int32_t)drive.energy);
}

static void test_pieces_add_up(void)
{
    add();
    expect_energy(JP_Q16(220.5));
    piece.grade = JP_Q24(0.2);
    piece.duration = JP_Q16(2);
    add();
    expect_energy(JP_Q16(220.5 + 2 * 624.3269));
}

/* 0.5 m/s²: an effort of 0.05 at 0.5 m/s. */
static void test_speeding_up_takes_kinetic_energy(void)
{
    piece = (struct jp_skid_piece){{0, 0}, {JP_Q24_ONE, 0}, 0, 0, JP_Q16(2)};
    add();
    expect_energy(JP_Q16(342.25));
}

/* −2 m/s² against an effort of 0.2: 0.05 − 0.1 a side at 0.5 m/s. */
static void test_braking_gives_a_share_back(void)
{
    piece = (struct jp_skid_piece){{JP_Q24_ONE, 0}, {0, 0}, 0, 0, JP_Q16(0.5)};
    add();
    expect_energy(JP_Q16(0.5 * (20 - 2 * 12.5 + 2 * 25 * 0.0025)));
}

/* 1 rad/s²: 0.2 of turning and 0.2 of the inertia, at 0.25 m/s. */
static void test_turning_faster_takes_kinetic_energy(void)
{
    piece = (struct jp_skid_piece){{0, 0}, {0, JP_Q24_ONE}, 0, 0, JP_Q16_ONE};
    add();
    expect_energy(JP_Q16(510.5));
    piece.end.turn_rate = -JP_Q24_ONE;
    add();
    expect_energy(JP_Q16(1021));
}

/* Rising to the side: r as above, no effort. */
static void test_turning_is_easier_on_a_bank(void)
{
    config.bank_easing = JP_Q24_ONE;
    piece.start = piece.end = (struct jp_motion){0, JP_Q24_ONE};
    piece.bank = JP_Q24(0.2);
    add();
    expect_energy(JP_Q16(506.2813));
}

/* All of the friction is gone: rolling alone. */
static void test_turning_takes_no_less_than_nothing(void)
{
    config.bank_easing = JP_Q24(4);
    piece.start = piece.end = (struct jp_motion){0, JP_Q24_ONE};
    piece.bank = JP_Q24(0.5);
    add();
    expect_energy(JP_Q16(20 + 2 * (2000 * 0.025 + 0.25)));
}

/* Forces 0.1 ∓ 0.22 at 0.5 and 1.5 m/s; the left side brakes. */
static void test_turning_uphill_takes_more(void)
{
    config.tilting = JP_Q24_ONE;
    piece.start = piece.end = (struct jp_motion){JP_Q24_ONE, JP_Q24_ONE};
    piece.grade = JP_Q24(0.1);
    piece.bank = JP_Q24(0.2);
    add();
    expect_energy(JP_Q16(960.4950));
}

/* On a slope of 0.3 in all, by the faster of driving and turning. */
static void test_work_of_slopes_counts_both_ways(void)
{
    piece.start = piece.end = (struct jp_motion){-JP_Q24_ONE, 0};
    piece.grade = JP_Q24(0.1);
    piece.bank = JP_Q24(-0.2);
    add();

    const int64_t driven = jp_multiply_shift(config.weight, piece.duration, 16) * 3 / 10;
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, (int32_t)driven, (int32_t)drive.slope_work);
    piece.start = piece.end = (struct jp_motion){0, JP_Q24(2)};
    piece.grade = -piece.grade;
    add();

    const int64_t turned = 2 * jp_multiply_shift(config.half_track, (int32_t)driven, 24);
    TEST_ASSERT_INT32_WITHIN(2 * TOLERANCE, (int32_t)(driven + turned), (int32_t)drive.slope_work);
}

static void test_energies_are_in_the_models_unit(void)
{
    config.unit_exponent = 4;
    add();
    expect_energy(JP_Q16(220.5 / 16));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(20.0 / 16), (int32_t)drive.change[JP_SKID_ELECTRONICS]);
    config.unit_exponent = -4;
    drive.energy = 0;
    add();
    TEST_ASSERT_INT32_WITHIN(16 * TOLERANCE, JP_Q16(220.5 * 16), (int32_t)drive.energy);
}

static void test_a_piece_out_of_range_is_refused(void)
{
    const struct jp_skid_piece usual = piece;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_add(NULL, &drive, &piece));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_add(&config, NULL, &piece));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_add(&config, &drive, NULL));
    piece.start.speed = JP_Q24(8) + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_add(&config, &drive, &piece));
    piece = usual;
    piece.end.turn_rate = -JP_Q24(8) - 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_add(&config, &drive, &piece));
    piece = usual;
    piece.grade = JP_Q24_ONE + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_add(&config, &drive, &piece));
    piece = usual;
    piece.bank = -JP_Q24_ONE - 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_add(&config, &drive, &piece));
    piece = usual;
    piece.duration = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_add(&config, &drive, &piece));
    piece.duration = JP_Q16(256) + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_energy_add(&config, &drive, &piece));
    TEST_ASSERT_EQUAL_INT32(0, (int32_t)drive.energy);
}

/* No sum of 65 536 pieces leaves 64 bits. */
static void expect_bounded(void)
{
    const int64_t bound = (int64_t)1 << 46;

    drive = (struct jp_skid_drive){0};
    add();
    TEST_ASSERT_TRUE(drive.energy >= -bound && drive.energy <= bound);
    for (int factor = 0; factor < (int)JP_SKID_FACTORS; factor++) {
        TEST_ASSERT_TRUE(drive.change[factor] >= -bound && drive.change[factor] <= bound);
    }
}

static void test_extremes_stay_in_their_formats(void)
{
    static const jp_q24 ends[] = {JP_Q24(8), -JP_Q24(8), 1, 0};
    static const jp_q16 durations[] = {1, JP_Q16(256)};

    config = greatest;
    for (unsigned i = 0; i < 4U * 4U * 4U * 4U; i++) {
        for (unsigned j = 0; j < 4U; j++) {
            piece.start = (struct jp_motion){ends[i % 4U], ends[i / 4U % 4U]};
            piece.end = (struct jp_motion){ends[i / 16U % 4U], ends[i / 64U]};
            piece.grade = j < 2U ? JP_Q24_ONE : -JP_Q24_ONE;
            piece.bank = i % 3U == 0U ? JP_Q24_ONE : -JP_Q24_ONE;
            piece.duration = durations[j % 2U];
            expect_bounded();
        }
    }
}

static void test_a_ground_without_grip_stays_in_its_formats(void)
{
    config = greatest;
    config.friction = JP_Q24(0.02);
    piece =
        (struct jp_skid_piece){{JP_Q24(8), JP_Q24(8)}, {JP_Q24(8), JP_Q24(8)}, JP_Q24_ONE, -JP_Q24_ONE, JP_Q16(256)};
    expect_bounded();
}

/* ---- Factors ---- */

static int64_t energy_scaled(int number, jp_q16 value)
{
    jp_q16 factor[JP_SKID_FACTORS] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE};
    struct jp_skid_energy_model scaled;
    struct jp_skid_drive sum = {0};

    factor[number] = value;
    jp_skid_energy_scale(&config, factor, &scaled);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(&scaled, &sum, &piece));
    return sum.energy;
}

/* Central differences by 1/64 either way. */
static void expect_changes(void)
{
    drive = (struct jp_skid_drive){0};
    add();
    for (int factor = 0; factor < (int)JP_SKID_FACTORS; factor++) {
        const int64_t above = energy_scaled(factor, JP_Q16_ONE + JP_Q16_ONE / 64);
        const int64_t below = energy_scaled(factor, JP_Q16_ONE - JP_Q16_ONE / 64);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.2), (int32_t)((above - below) * 32), (int32_t)drive.change[factor]);
    }
}

static void test_changes_are_the_derivatives(void)
{
    config.yielding = JP_Q24_ONE;
    config.scrub = JP_Q24(0.1);
    config.easing = JP_Q24(0.5);
    config.bank_easing = JP_Q24_ONE;
    config.tilting = JP_Q24(0.3);
    piece.bank = JP_Q24(0.15);
    expect_changes();
    piece.grade = JP_Q24(0.2);
    expect_changes();
    piece.grade = -JP_Q24(0.2);
    expect_changes();
    piece.start.turn_rate = JP_Q24(0.5);
    piece.end.turn_rate = JP_Q24(0.7);
    expect_changes();
    piece.end.speed = JP_Q24(0.8);
    piece.grade = JP_Q24(0.1);
    expect_changes();
    piece.start = piece.end = (struct jp_motion){0, -JP_Q24_ONE};
    expect_changes();
}

static void test_scaling_keeps_the_ranges(void)
{
    static const jp_q16 least[JP_SKID_FACTORS] = {0, 0, 0, 0};
    static const jp_q16 most[JP_SKID_FACTORS] = {JP_Q16(4), JP_Q16(4), JP_Q16(4), JP_Q16(4)};
    struct jp_skid_energy_model scaled;
    const char *field = "none";

    jp_skid_energy_scale(&greatest, most, &scaled);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_check(&scaled, &field));
    jp_skid_energy_scale(&round_numbers, least, &scaled);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_check(&scaled, &field));
}

static void test_factors_of_one_change_nothing(void)
{
    static const jp_q16 ones[JP_SKID_FACTORS] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE};
    struct jp_skid_energy_model scaled;

    jp_skid_energy_scale(&round_numbers, ones, &scaled);
    TEST_ASSERT_EQUAL_MEMORY(&round_numbers, &scaled, sizeof scaled);
}

static void test_the_windings_take_the_square_of_the_weight(void)
{
    static const jp_q16 heavy[JP_SKID_FACTORS] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16(1.5), JP_Q16_ONE};
    struct jp_skid_energy_model scaled;

    jp_skid_energy_scale(&round_numbers, heavy, &scaled);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(1500), scaled.weight);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(225), scaled.copper_driving);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(56.25), scaled.copper_braking);
}

static void test_nothing_scaled_is_nothing(void)
{
    static const jp_q16 ones[JP_SKID_FACTORS] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE};
    struct jp_skid_energy_model none = round_numbers;
    struct jp_skid_energy_model scaled;

    none.rolling = 0;
    none.copper_driving = 0;
    none.copper_braking = 0;
    none.electronics_power = 0;
    jp_skid_energy_scale(&none, ones, &scaled);
    TEST_ASSERT_EQUAL_MEMORY(&none, &scaled, sizeof scaled);
}
