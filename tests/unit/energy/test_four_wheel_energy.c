/* The energy model of four steered wheels: its check, motions worked out by hand, its limits, its derivatives. */
#include <joulepath/four_wheel_energy.h>
#include <stddef.h>

#include "tests/support/config_check.h"
#include "unity.h"

/* 0.002 in Q16 */
#define TOLERANCE 131

/* Round numbers: 1000 N on a 3-4-5 triangle, so that the wheels are 0.5 m from the centre. */
static const struct jp_four_wheel_energy_model round_numbers = {
    .wheelbase = JP_Q24(0.6),
    .track = JP_Q24(0.8),
    .weight = JP_Q16(1000),
    .rolling = JP_Q24(0.02),
    .drag = JP_Q24(0.005),
    .cornering = JP_Q24(0.001),
    .inertia = JP_Q24(0.1),
    .turn_inertia = JP_Q24(0.02),
    .driving = JP_Q24(2),
    .braking = JP_Q24(0.5),
    .copper_driving = JP_Q16(4000),
    .copper_braking = JP_Q16(1000),
    .steering = JP_Q16(3),
    .contact = JP_Q24(0.03),
    .electronics_power = JP_Q16(20),
};

static const struct jp_four_wheel_energy_model greatest = {
    .wheelbase = JP_Q24(4),
    .track = JP_Q24(4),
    .weight = JP_Q16(16384),
    .rolling = JP_Q24(0.5),
    .drag = JP_Q24(1),
    .cornering = JP_Q24(1),
    .inertia = JP_Q24(8),
    .turn_inertia = JP_Q24(8),
    .driving = JP_Q24(10),
    .braking = JP_Q24(1),
    .copper_driving = JP_Q16(16384),
    .copper_braking = JP_Q16(16384),
    .steering = JP_Q16(1024),
    .contact = JP_Q24(0.5),
    .electronics_power = JP_Q16(1024),
    .unit_exponent = -JP_ENERGY_UNIT_EXPONENT_MAX,
};

static struct jp_four_wheel_energy_model config;
static struct jp_four_wheel_drive drive;
static struct jp_four_wheel_piece piece;

void setUp(void)
{
    config = round_numbers;
    drive = (struct jp_four_wheel_drive){0};
    piece = (struct jp_four_wheel_piece){{JP_Q24_ONE, 0, 0}, {JP_Q24_ONE, 0, 0}, 0, 0, 0, JP_Q16_ONE};
}

void tearDown(void)
{
}

/* ---- Check ---- */

DEFINE_EXPECT_CONFIG_OF(jp_four_wheel_energy_check, round_numbers)

static void test_check_names_each_field_at_both_limits(void)
{
    expect_config(NULL);
    RANGE("four_wheel_energy.", wheelbase, JP_Q24(0.05), JP_Q24(4));
    RANGE("four_wheel_energy.", track, JP_Q24(0.05), JP_Q24(4));
    RANGE("four_wheel_energy.", weight, JP_Q16(1), JP_Q16(16384));
    RANGE("four_wheel_energy.", rolling, 0, JP_Q24(0.5));
    RANGE("four_wheel_energy.", drag, 0, JP_Q24(1));
    RANGE("four_wheel_energy.", cornering, 0, JP_Q24(1));
    RANGE("four_wheel_energy.", inertia, 0, JP_Q24(8));
    RANGE("four_wheel_energy.", turn_inertia, 0, JP_Q24(8));
    RANGE("four_wheel_energy.", driving, JP_Q24(1), JP_Q24(10));
    RANGE("four_wheel_energy.", braking, 0, JP_Q24(1));
    RANGE("four_wheel_energy.", copper_driving, 0, JP_Q16(16384));
    RANGE("four_wheel_energy.", copper_braking, 0, JP_Q16(16384));
    RANGE("four_wheel_energy.", steering, 0, JP_Q16(1024));
    RANGE("four_wheel_energy.", contact, 0, JP_Q24(0.5));
    RANGE("four_wheel_energy.", electronics_power, 0, JP_Q16(1024));
    RANGE("four_wheel_energy.", unit_exponent, -JP_ENERGY_UNIT_EXPONENT_MAX, JP_ENERGY_UNIT_EXPONENT_MAX);
}

static void test_the_table_passes_its_check(void)
{
    const char *field = "none";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_energy_check(&jp_four_wheel_energy_patrol, &field));
}

/* ---- Motions ---- */

static void add(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_energy_add(&config, &drive, &piece));
}

static void expect_steady(jp_q24 x, jp_q24 y, jp_q24 turn_rate, int32_t expected)
{
    piece.start = piece.end = (struct jp_twist){x, y, turn_rate};
    drive = (struct jp_four_wheel_drive){0};
    add();
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, expected, (int32_t)drive.energy);
}

/* Of each wheel 0.005 + 0.005 · 1 of the weight: 10 N, and 0.4 W in its windings. */
static void test_straight_and_level(void)
{
    expect_steady(JP_Q24_ONE, 0, 0, JP_Q16(20 + 4 * (2 * 10 + 0.4)));
    expect_steady(-JP_Q24_ONE, 0, 0, JP_Q16(20 + 4 * (2 * 10 + 0.4)));
}

static void test_any_direction_takes_the_same(void)
{
    expect_steady(0, JP_Q24_ONE, 0, JP_Q16(20 + 4 * (2 * 10 + 0.4)));
    expect_steady(JP_Q24(0.6), -JP_Q24(0.8), 0, JP_Q16(20 + 4 * (2 * 10 + 0.4)));
}

/* 7.5 N at 0.5 m/s. */
static void test_on_the_spot(void)
{
    expect_steady(0, 0, JP_Q24_ONE, JP_Q16(20 + 4 * (2 * 3.75 + 4000 * 0.0075 * 0.0075)));
    expect_steady(0, 0, -JP_Q24_ONE, JP_Q16(20 + 4 * (2 * 3.75 + 4000 * 0.0075 * 0.0075)));
}

static void test_standing_takes_the_electronics(void)
{
    piece.grade = JP_Q24(0.1);
    expect_steady(0, 0, 0, JP_Q16(20));
}

/* 25 N more a wheel; 35 N against 20 N down. */
static void test_slopes(void)
{
    piece.grade = JP_Q24(0.1);
    expect_steady(JP_Q24_ONE, 0, 0, JP_Q16(20 + 4 * (2 * 35 + 4000 * 0.035 * 0.035)));
    expect_steady(-JP_Q24_ONE, 0, 0, JP_Q16(20 + 4 * (-0.5 * 15 + 1000 * 0.015 * 0.015)));
    piece.grade = 0;
    piece.bank = JP_Q24(0.1);
    expect_steady(0, JP_Q24_ONE, 0, JP_Q16(20 + 4 * (2 * 35 + 4000 * 0.035 * 0.035)));
}

/* Wheels at √(0.6² + 0.3²) and √(1.4² + 0.3²) m/s; what bends take is small. */
static void test_a_bend(void)
{
    const double inner = 0.67082039;
    const double outer = 1.43178211;
    const double inner_force = 0.005 + 0.005 * inner;
    const double outer_force = 0.005 + 0.005 * outer;

    expect_steady(JP_Q24_ONE, 0, JP_Q24_ONE,
                  JP_Q16(20 + 2000 * 0.001 + 2 * (2000 * inner_force * inner + 4000 * inner_force * inner_force) +
                         2 * (2000 * outer_force * outer + 4000 * outer_force * outer_force)));
}

/* 0.5 m/s² at 0.5 m/s: 0.0125 of the weight more a wheel, and 0.0025 of drag, for 2 s. */
static void test_speeding_up_takes_kinetic_energy(void)
{
    piece = (struct jp_four_wheel_piece){{0, 0, 0}, {JP_Q24_ONE, 0, 0}, 0, 0, 0, JP_Q16(2)};
    add();
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(2 * (20 + 4 * (2000 * 0.02 * 0.5 + 4000 * 0.02 * 0.02))),
                             (int32_t)drive.energy);
}

/* 1 rad/s² at 0.5 rad/s: 0.01 m/s of effort over 0.25 m/s. */
static void test_turning_faster_takes_kinetic_energy(void)
{
    piece = (struct jp_four_wheel_piece){{0, 0, 0}, {0, 0, JP_Q24_ONE}, 0, 0, 0, JP_Q16_ONE};
    add();
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(20 + 4 * (2000 * 0.01625 * 0.25 + 4000 * 0.01625 * 0.01625)),
                             (int32_t)drive.energy);
}

/* −1 m/s² at 0.5 m/s: 0.0075 − 0.025. */
static void test_braking_gives_a_share_back(void)
{
    piece = (struct jp_four_wheel_piece){{JP_Q24_ONE, 0, 0}, {0, 0, 0}, 0, 0, 0, JP_Q16_ONE};
    add();
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(20 + 4 * (-500 * 0.0175 * 0.5 + 1000 * 0.0175 * 0.0175)),
                             (int32_t)drive.energy);
}

/* ---- Steering ---- */

static void test_steering_at_a_stand(void)
{
    piece.travel = JP_Q16(4);
    expect_steady(0, 0, 0, JP_Q16(20 + 12));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(12), (int32_t)drive.change[JP_FOUR_WHEEL_STEERING]);
}

/* 1 rad/s a wheel scrubs at 0.03 m/s, 0.04 m/s it rolls: 3/5. */
static void test_a_wheel_that_rolls_steers_for_less(void)
{
    piece.travel = JP_Q16(4);
    expect_steady(JP_Q24(0.04), 0, 0, JP_Q16(20 + 4 * (2000 * 0.0052 * 0.04 + 4000 * 0.0052 * 0.0052) + 12 * 0.6));
}

static void test_energies_are_in_the_models_unit(void)
{
    config.unit_exponent = 4;
    piece.travel = JP_Q16(4);
    expect_steady(0, 0, 0, JP_Q16(32.0 / 16));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(20.0 / 16), (int32_t)drive.change[JP_FOUR_WHEEL_ELECTRONICS]);
    config.unit_exponent = -4;
    piece.travel = 0;
    expect_steady(0, 0, 0, JP_Q16(20.0 * 16));
}

static void test_pieces_add_up(void)
{
    add();
    piece.duration = JP_Q16(2);
    add();
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(3 * (20 + 4 * (2 * 10 + 0.4))), (int32_t)drive.energy);
}

/* ---- Limits ---- */

static void expect_refused(void)
{
    static const struct jp_four_wheel_piece usual = {{JP_Q24_ONE, 0, 0}, {JP_Q24_ONE, 0, 0}, 0, 0, 0, JP_Q16_ONE};

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_energy_add(&config, &drive, &piece));
    TEST_ASSERT_TRUE(drive.energy == 0);
    piece = usual;
}

static void test_a_piece_out_of_range_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_energy_add(NULL, &drive, &piece));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_energy_add(&config, NULL, &piece));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_energy_add(&config, &drive, NULL));
    piece.start.x = JP_Q24(8) + 1;
    expect_refused();
    piece.start.y = -JP_Q24(8) - 1;
    expect_refused();
    piece.start.turn_rate = JP_Q24(8) + 1;
    expect_refused();
    piece.end.turn_rate = -JP_Q24(8) - 1;
    expect_refused();
    piece.grade = JP_Q24_ONE + 1;
    expect_refused();
    piece.bank = -JP_Q24_ONE - 1;
    expect_refused();
    piece.travel = -1;
    expect_refused();
    piece.travel = JP_Q16(256) + 1;
    expect_refused();
    piece.duration = 0;
    expect_refused();
    piece.duration = JP_Q16(256) + 1;
    expect_refused();
}

/* No sum of 65 536 pieces leaves 64 bits. */
static void expect_bounded(void)
{
    const int64_t bound = (int64_t)1 << 47;

    drive = (struct jp_four_wheel_drive){0};
    add();
    TEST_ASSERT_TRUE(drive.energy >= -bound && drive.energy <= bound);
    for (int factor = 0; factor < (int)JP_FOUR_WHEEL_FACTORS; factor++) {
        TEST_ASSERT_TRUE(drive.change[factor] >= -bound && drive.change[factor] <= bound);
    }
}

static void test_extremes_stay_in_their_formats(void)
{
    static const jp_q24 ends[] = {JP_Q24(8), -JP_Q24(8), 1, 0};

    config = greatest;
    for (unsigned i = 0; i < 4U * 4U * 4U * 4U; i++) {
        for (unsigned j = 0; j < 4U; j++) {
            piece.start = (struct jp_twist){ends[i % 4U], ends[j], ends[i / 4U % 4U]};
            piece.end = (struct jp_twist){ends[i / 16U % 4U], ends[3U - j], ends[i / 64U]};
            piece.grade = j < 2U ? JP_Q24_ONE : -JP_Q24_ONE;
            piece.bank = i % 3U == 0U ? JP_Q24_ONE : -JP_Q24_ONE;
            piece.travel = i % 5U == 0U ? JP_Q16(256) : 1;
            piece.duration = j % 2U == 0U ? 1 : JP_Q16(256);
            expect_bounded();
        }
    }
}

/* ---- Factors ---- */

static int64_t energy_scaled(int number, jp_q16 value)
{
    jp_q16 factor[JP_FOUR_WHEEL_FACTORS] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE};
    struct jp_four_wheel_energy_model scaled;
    struct jp_four_wheel_drive sum = {0};

    factor[number] = value;
    jp_four_wheel_energy_scale(&config, factor, &scaled);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_energy_add(&scaled, &sum, &piece));
    return sum.energy;
}

/* Central differences by 1/64 either way. */
static void expect_changes(void)
{
    drive = (struct jp_four_wheel_drive){0};
    add();
    for (int factor = 0; factor < (int)JP_FOUR_WHEEL_FACTORS; factor++) {
        const int64_t above = energy_scaled(factor, JP_Q16_ONE + JP_Q16_ONE / 64);
        const int64_t below = energy_scaled(factor, JP_Q16_ONE - JP_Q16_ONE / 64);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.2), (int32_t)((above - below) * 32), (int32_t)drive.change[factor]);
    }
}

static void test_changes_are_the_derivatives(void)
{
    expect_changes();
    piece.grade = JP_Q24(0.1);
    expect_changes();
    piece.grade = -JP_Q24(0.1);
    expect_changes();
    piece.end = (struct jp_twist){JP_Q24(0.7), JP_Q24(0.2), JP_Q24(0.8)};
    piece.travel = JP_Q16(2);
    expect_changes();
    piece.start = piece.end = (struct jp_twist){0, 0, -JP_Q24_ONE};
    expect_changes();
}

static void test_scaling_keeps_the_ranges(void)
{
    static const jp_q16 least[JP_FOUR_WHEEL_FACTORS] = {JP_Q16(0.25), JP_Q16(0.25), JP_Q16(0.25), JP_Q16(0.25)};
    static const jp_q16 most[JP_FOUR_WHEEL_FACTORS] = {JP_Q16(4), JP_Q16(4), JP_Q16(4), JP_Q16(4)};
    struct jp_four_wheel_energy_model scaled;
    const char *field = NULL;

    config = greatest;
    config.drag = JP_Q24_ONE;
    jp_four_wheel_energy_scale(&config, least, &scaled);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_energy_check(&scaled, &field));
    TEST_ASSERT_EQUAL_INT32(JP_Q24_ONE, scaled.drag);
    jp_four_wheel_energy_scale(&config, most, &scaled);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_energy_check(&scaled, &field));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(16384), scaled.weight);
    config.weight = JP_Q16_ONE;
    jp_four_wheel_energy_scale(&config, least, &scaled);
    TEST_ASSERT_EQUAL_INT32(JP_Q16_ONE, scaled.weight);
}

/* ---- A metre ---- */

static jp_q16 metre_at(jp_q24 speed, jp_q24 grade)
{
    jp_q16 joules = -1;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_energy_metre(&config, speed, grade, &joules));
    return joules;
}

/* Each wheel pushes with 0.01 of the weight: 20 W and 0.4 W in its windings; by a grade with a quarter of that more, or
 * less: then all brake. */
static void test_a_metre(void)
{
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(101.6), metre_at(JP_Q24_ONE, 0));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(319.6), metre_at(JP_Q24_ONE, JP_Q24(0.1)));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(-9.1), metre_at(JP_Q24_ONE, -JP_Q24(0.1)));
    /* At half the speed the wheels push with 0.0075, for two seconds. */
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(40 + 8 * (7.5 + 0.225)), metre_at(JP_Q24(0.5), 0));
}

static void test_a_metre_is_in_joules_in_every_unit(void)
{
    for (int32_t exponent = -4; exponent <= 4; exponent++) {
        config = round_numbers;
        config.unit_exponent = exponent;
        TEST_ASSERT_INT32_WITHIN(16 * TOLERANCE, JP_Q16(101.6), metre_at(JP_Q24_ONE, 0));
    }
}

static void test_a_metre_arguments(void)
{
    jp_q16 joules = 7;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_energy_metre(NULL, JP_Q24_ONE, 0, &joules));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_energy_metre(&config, JP_Q24_ONE, 0, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_energy_metre(&config, JP_Q24(1.0 / 256) - 1, 0, &joules));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_energy_metre(&config, JP_Q24(8) + 1, 0, &joules));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_energy_metre(&config, JP_Q24_ONE, JP_Q24_ONE + 1, &joules));
    TEST_ASSERT_EQUAL_INT32(7, joules);
    TEST_ASSERT_TRUE(metre_at(JP_Q24(1.0 / 256), 0) > JP_Q16(5120));
    TEST_ASSERT_TRUE(metre_at(JP_Q24(8), -JP_Q24_ONE) < 0);
}

static void test_a_metre_beyond_its_format(void)
{
    jp_q16 joules = 0;

    config = greatest;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_four_wheel_energy_metre(&config, JP_Q24_ONE, JP_Q24_ONE, &joules));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, joules);
}

static void test_nothing_scaled_is_nothing(void)
{
    static const jp_q16 ones[JP_FOUR_WHEEL_FACTORS] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE};
    struct jp_four_wheel_energy_model none = config;
    struct jp_four_wheel_energy_model scaled;

    none.rolling = 0;
    none.drag = 0;
    none.copper_driving = 0;
    none.copper_braking = 0;
    none.steering = 0;
    none.electronics_power = 0;
    jp_four_wheel_energy_scale(&none, ones, &scaled);
    TEST_ASSERT_EQUAL_MEMORY(&none, &scaled, sizeof scaled);
}

static int64_t energy_of_change(struct jp_twist from, struct jp_twist to, jp_q24 grade, jp_q24 bank)
{
    drive = (struct jp_four_wheel_drive){0};
    piece = (struct jp_four_wheel_piece){.start = from, .end = to, .grade = grade, .bank = bank, .duration = JP_Q16(2)};
    add();
    return drive.energy;
}

/* Wheels that are steered to all sides: to become faster takes the same in each direction, slope and all. */
static void test_a_change_of_speed_takes_the_same_in_any_direction(void)
{
    static const jp_q24 speeds[][2] = {{0, JP_Q24(1)}, {JP_Q24(1), JP_Q24(0.25)}, {JP_Q24(0.5), JP_Q24(0.75)}};

    config.inertia = JP_Q24(1);
    for (unsigned i = 0; i < sizeof speeds / sizeof speeds[0]; i++) {
        const jp_q24 a = speeds[i][0];
        const jp_q24 b = speeds[i][1];
        const jp_q24 slope = JP_Q24(0.05);
        const int64_t ahead = energy_of_change((struct jp_twist){.x = a}, (struct jp_twist){.x = b}, slope, 0);

        TEST_ASSERT_INT64_WITHIN(64, ahead,
                                 energy_of_change((struct jp_twist){.x = -a}, (struct jp_twist){.x = -b}, -slope, 0));
        TEST_ASSERT_INT64_WITHIN(64, ahead,
                                 energy_of_change((struct jp_twist){.y = a}, (struct jp_twist){.y = b}, 0, slope));
        TEST_ASSERT_INT64_WITHIN(64, ahead,
                                 energy_of_change((struct jp_twist){.y = -a}, (struct jp_twist){.y = -b}, 0, -slope));
    }
}
