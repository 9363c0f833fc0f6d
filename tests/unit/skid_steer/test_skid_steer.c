/* The skid-steer model: its check, motions worked out by hand, and its limits. */
#include <joulepath/skid_steer.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "unity.h"

/* 0.002 in Q16 */
#define TOLERANCE 131

static const struct jp_skid_steer_config *const zhang = &jp_skid_steer_zhang2018;

/* Round numbers: 1000 N, B = 1 m, l = 0.925 m, so that M/B = 1000 · 0.8 · 0.925/(4 · 0.925) = 200 N on the spot. */
static const struct jp_skid_steer_config round_numbers = {
    .wheel_radius = JP_Q24(0.5),
    .width = JP_Q24(1),
    .wheelbase = JP_Q24(0.925),
    .weight = JP_Q16(1000),
    .rolling = JP_Q24(0.1),
    .friction = JP_Q24(0.8),
    .torque_per_ampere = JP_Q16(10),
    .resistance = JP_Q24(2),
    .efficiency = JP_Q24(0.5),
    .recuperation = JP_Q24(0.5),
    .electronics_power = JP_Q16(20),
    .distance_energy = JP_Q16(300),
};

void setUp(void)
{
}

void tearDown(void)
{
}

static struct jp_motion motion(double speed, double turn_rate)
{
    return (struct jp_motion){JP_Q24(speed), JP_Q24(turn_rate)};
}

static void test_zhang2018_passes_its_check(void)
{
    const char *field = "none";
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_check(zhang, &field));
    TEST_ASSERT_NULL(field);
}

static void expect_bad(const struct jp_skid_steer_config *config, const char *name)
{
    const char *field = "none";
    TEST_ASSERT_EQUAL_INT32(JP_ERR_CONFIG, jp_skid_steer_check(config, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
}

#define EXPECT_RANGE(member, low, high)                                                                                \
    do {                                                                                                               \
        struct jp_skid_steer_config config = round_numbers;                                                            \
        const char *field = "none";                                                                                    \
        config.member = (low);                                                                                         \
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_check(&config, &field));                                          \
        config.member = (high);                                                                                        \
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_check(&config, &field));                                          \
        config.member = (low)-1;                                                                                       \
        expect_bad(&config, #member);                                                                                  \
        config.member = (high) + 1;                                                                                    \
        expect_bad(&config, #member);                                                                                  \
    } while (0)

static void test_check_names_each_field_at_both_limits(void)
{
    EXPECT_RANGE(wheel_radius, JP_Q24(0.01), JP_Q24(1));
    EXPECT_RANGE(width, JP_Q24(0.05), JP_Q24(4));
    EXPECT_RANGE(wheelbase, 0, JP_Q24(4));
    EXPECT_RANGE(weight, JP_Q16(1), JP_Q16(16384));
    EXPECT_RANGE(rolling, 0, JP_Q24(0.5));
    EXPECT_RANGE(friction, 0, JP_Q24(2));
    EXPECT_RANGE(torque_per_ampere, JP_Q16(0.01), JP_Q16(16384));
    EXPECT_RANGE(resistance, 0, JP_Q24(100));
    EXPECT_RANGE(efficiency, JP_Q24(0.1), JP_Q24(1));
    EXPECT_RANGE(recuperation, 0, JP_Q24(1));
    EXPECT_RANGE(electronics_power, 0, JP_Q16(1024));
    EXPECT_RANGE(distance_energy, 0, JP_Q16(1024));
}

static void test_check_wants_pointers(void)
{
    const char *field = "none";
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_check(NULL, &field));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_check(zhang, NULL));
}

/* (0.5 ∓ 0.4 · 0.35)/0.136 */
static void test_wheel_speeds(void)
{
    const struct jp_motion turning = motion(0.5, 0.4);
    struct jp_skid_steer_sides speeds;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_wheel_speeds(zhang, &turning, &speeds));
    TEST_ASSERT_INT32_WITHIN(2, JP_Q16(2.6470588), speeds.left);
    TEST_ASSERT_INT32_WITHIN(2, JP_Q16(4.7058824), speeds.right);
}

static void test_wheel_speeds_are_the_nearest(void)
{
    const int64_t radius = zhang->wheel_radius;
    struct jp_skid_steer_sides speeds;

    for (int32_t i = 0; i < 200; i++) {
        const struct jp_motion ahead = {JP_Q24(0.01) + 12345 * i, 0};
        const struct jp_motion back = {-ahead.speed, 0};
        const int64_t doubled = 2 * (int64_t)ahead.speed * JP_Q16_ONE;

        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_wheel_speeds(zhang, &ahead, &speeds));
        TEST_ASSERT_EQUAL_INT32((doubled + radius) / (2 * radius), speeds.left);
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_wheel_speeds(zhang, &back, &speeds));
        TEST_ASSERT_EQUAL_INT32(-((doubled + radius) / (2 * radius)), speeds.right);
    }
}

static void expect_torques(struct jp_motion driven, double grade, double left, double right)
{
    struct jp_skid_steer_sides torques;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_torques(&round_numbers, &driven, JP_Q24(grade), &torques));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(left), torques.left);
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(right), torques.right);
}

/* Rolling is 50 N a side, a slope of 0.2 adds 100 N a side; wheels of 0.5 m. */
static void test_torques_of_straight_driving(void)
{
    expect_torques(motion(1, 0), 0, 25, 25);
    expect_torques(motion(1, 0), 0.2, 75, 75);
    expect_torques(motion(1, 0), -0.2, -25, -25);
    expect_torques(motion(-1, 0), 0, -25, -25);
    expect_torques(motion(-1, 0), 0.2, -75, -75);
}

/* On the spot 200 N against the turn and 50 N of rolling, each along the side's own motion. */
static void test_torques_on_the_spot(void)
{
    expect_torques(motion(0, 1), 0, -125, 125);
    expect_torques(motion(0, -1), 0, 125, -125);
}

/* R = 10 m: 200 · 0.925/(0.925 + 1.5) = 76.2887 N, both sides rolling forwards. */
static void test_torques_of_a_wide_turn(void)
{
    expect_torques(motion(2, 0.2), 0, (50 - 76.28866) / 2, (50 + 76.28866) / 2);
    expect_torques(motion(2, -0.2), 0, (50 + 76.28866) / 2, (50 - 76.28866) / 2);
}

/** On wheels of 1 m, whose torque is the force. */
static struct jp_skid_steer_config on_wheels_of_a_metre(void)
{
    struct jp_skid_steer_config config = round_numbers;

    config.wheel_radius = JP_Q24_ONE;
    return config;
}

static void expect_forces(const struct jp_skid_steer_config *config, struct jp_motion driven, jp_q24 grade, jp_q16 left,
                          jp_q16 right)
{
    struct jp_skid_steer_sides torques;

    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_torques(config, &driven, grade, &torques));
    TEST_ASSERT_EQUAL_INT32(left, torques.left);
    TEST_ASSERT_EQUAL_INT32(right, torques.right);
}

static void test_no_motion_takes_no_torque(void)
{
    const struct jp_skid_steer_config config = on_wheels_of_a_metre();

    expect_forces(&config, motion(0, 0), 0, 0, 0);
    expect_forces(&config, motion(0, 0), JP_Q24(0.5), 0, 0);
}

/* The least motion there is rolls. */
static void test_the_slowest_motion_takes_a_torque(void)
{
    struct jp_skid_steer_config config = on_wheels_of_a_metre();

    config.rolling = JP_Q24(0.125);
    expect_forces(&config, (struct jp_motion){1, 0}, 0, JP_Q16(62.5), JP_Q16(62.5));
    expect_forces(&config, (struct jp_motion){-1, 0}, 0, -JP_Q16(62.5), -JP_Q16(62.5));
    expect_forces(&config, (struct jp_motion){1, 0}, JP_Q24(0.25), JP_Q16(187.5), JP_Q16(187.5));
}

/* Half of 1 N up odd grades of 2^-17: halves of 2^-16 N go away from zero, uphill as downhill. */
static void test_forces_are_the_nearest(void)
{
    struct jp_skid_steer_config config = on_wheels_of_a_metre();

    config.rolling = 0;
    config.weight = JP_Q16(1);
    for (int32_t i = 0; i < 100; i++) {
        const jp_q24 half = 512 * (2 * i + 1) / 2;

        expect_forces(&config, motion(1, 0), half, i + 1, i + 1);
        expect_forces(&config, motion(1, 0), half - 1, i, i);
        expect_forces(&config, motion(1, 0), -half, -i - 1, -i - 1);
        expect_forces(&config, motion(1, 0), -half + 1, -i, -i);
    }
}

/* F = μ G l |w|/(4 (0.925 B |w| + 0.15 |v|)), without rolling. */
static void test_turning_forces_are_the_nearest(void)
{
    struct jp_skid_steer_config config = on_wheels_of_a_metre();

    config.rolling = 0;
    config.weight = JP_Q16(16);
    config.friction = JP_Q24(0.5);
    config.wheelbase = JP_Q24(1);
    for (int32_t i = 0; i < 100; i++) {
        const struct jp_motion driven = {JP_Q24(0.1) + 54321 * i, JP_Q24(0.3) + 98765 * (i % 7)};
        const double slip = 0.925 * driven.turn_rate + 0.15 * driven.speed;
        const double force = 16 * 0.5 / 4 * driven.turn_rate / slip * JP_Q16_ONE;
        struct jp_skid_steer_sides torques;

        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_torques(&config, &driven, 0, &torques));
        TEST_ASSERT_TRUE(torques.right - force < 0.52 && force - torques.right < 0.52);
        TEST_ASSERT_EQUAL_INT32(-torques.right, torques.left);
    }
}

static jp_q16 power_of(enum jp_cost_kind kind, struct jp_motion driven, double grade)
{
    jp_q16 power = 0;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_power(&round_numbers, kind, &driven, JP_Q24(grade), &power));
    return power;
}

/* A side: 50 N · 1 m/s / 0.5 + (25/10)² · 2 = 112.5 W. */
static void test_power_of_straight_driving(void)
{
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(225), power_of(JP_COST_PAPER, motion(1, 0), 0));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(245), power_of(JP_COST_PHYSICAL, motion(1, 0), 0));
}

/* Downhill each side takes −50 N: as printed −50/0.5 + 12.5, physically −50 · 0.5 · 0.5 + 12.5. */
static void test_power_downhill(void)
{
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(-175), power_of(JP_COST_PAPER, motion(1, 0), -0.2));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(20), power_of(JP_COST_PHYSICAL, motion(1, 0), -0.2));
}

/* The price of the paper knows no electronics. */
static void test_power_of_a_stand(void)
{
    TEST_ASSERT_EQUAL_INT32(0, power_of(JP_COST_PAPER, motion(0, 0), 0));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(20), power_of(JP_COST_PHYSICAL, motion(0, 0), 0));
}

static void test_power_as_a_price(void)
{
    const struct jp_motion straight = motion(1, 0);
    const struct jp_motion fast = {JP_Q24(8) + 1, 0};
    TEST_ASSERT_EQUAL_INT32(power_of(JP_COST_PHYSICAL, straight, 0.1),
                            jp_skid_steer_power_of(&round_numbers, &straight, JP_Q24(0.1)));
    TEST_ASSERT_EQUAL_INT32(0, jp_skid_steer_power_of(&round_numbers, &fast, 0));
}

/* In a wide turn the inner side brakes: −26.28866 N at 1.9 m/s, 126.28866 N at 2.1 m/s outside. */
static void test_power_with_a_braking_side(void)
{
    const double outer = 126.28866 * 2.1 / 0.5 + 6.314433 * 6.314433 * 2;
    const double inner = -26.28866 * 1.9 * 0.25 + 1.314433 * 1.314433 * 2;
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(outer + inner + 20), power_of(JP_COST_PHYSICAL, motion(2, 0.2), 0));
}

static jp_q16 energy_of(enum jp_cost_kind kind, struct jp_motion driven, double rise, double duration)
{
    jp_q16 energy = 0;
    TEST_ASSERT_EQUAL_INT32(
        JP_OK, jp_skid_steer_energy(&round_numbers, kind, &driven, JP_Q24(rise), JP_Q16(duration), &energy));
    return energy;
}

/* 2 m: 245 W for 2 s; eq. 14 adds 300 J/m and 0.8 · 1000 N of rise. Up 0.2 a side takes 150/0.5 + 7.5² · 2 W. */
static void test_energy(void)
{
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(490), energy_of(JP_COST_PHYSICAL, motion(1, 0), 0, 2));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(600 + 450), energy_of(JP_COST_PAPER, motion(1, 0), 0, 2));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(600 + 2 * 825 + 320), energy_of(JP_COST_PAPER, motion(1, 0), 0.4, 2));
}

static void test_energy_backwards_is_that_forwards(void)
{
    TEST_ASSERT_EQUAL_INT32(energy_of(JP_COST_PHYSICAL, motion(1, 0.3), 0.1, 2),
                            energy_of(JP_COST_PHYSICAL, motion(-1, -0.3), 0.1, 2));
}

/* At −0.1 the rolling is balanced, so only the electronics draw; steeper, what comes back cannot outweigh them. */
static void test_energy_is_at_least_the_electronics(void)
{
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(40), energy_of(JP_COST_PHYSICAL, motion(1, 0), -0.2, 2));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(40), energy_of(JP_COST_PHYSICAL, motion(1, 0), -0.3, 2));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(40), energy_of(JP_COST_PHYSICAL, motion(0, 0), 0, 2));
}

static void test_paper_energy_is_at_least_nothing(void)
{
    TEST_ASSERT_EQUAL_INT32(0, energy_of(JP_COST_PAPER, motion(1, 0), -1.9, 2));
}

static void expect_refused(struct jp_motion driven, enum jp_cost_kind kind, jp_q24 rise, jp_q16 duration)
{
    jp_q16 energy = 77;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_energy(zhang, kind, &driven, rise, duration, &energy));
    TEST_ASSERT_EQUAL_INT32(77, energy);
}

static void test_arguments_out_of_range(void)
{
    const struct jp_motion fast = {JP_Q24(8) + 1, 0};
    const struct jp_motion spin = {0, -JP_Q24(8) - 1};
    expect_refused(fast, JP_COST_PHYSICAL, 0, JP_Q16(1));
    expect_refused(spin, JP_COST_PHYSICAL, 0, JP_Q16(1));
    expect_refused(motion(1, 0), JP_COST_DISTANCE, 0, JP_Q16(1));
    expect_refused(motion(1, 0), JP_COST_KINDS, 0, JP_Q16(1));
    expect_refused(motion(1, 0), JP_COST_PHYSICAL, 0, -1);
    expect_refused(motion(1, 0), JP_COST_PHYSICAL, 0, JP_Q16(256) + 1);
    expect_refused(motion(1, 0), JP_COST_PHYSICAL, JP_Q24(1) + 1, JP_Q16(1));
    expect_refused(motion(0, 1), JP_COST_PHYSICAL, 1, JP_Q16(1));
}

static void test_motions_out_of_range(void)
{
    const struct jp_motion fast = {JP_Q24(8) + 1, 0};
    const struct jp_motion spin = {0, -JP_Q24(8) - 1};
    const struct jp_motion driven = motion(1, 0);
    struct jp_skid_steer_sides sides = {77, 77};
    jp_q16 power = 77;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_wheel_speeds(zhang, &fast, &sides));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_torques(zhang, &spin, 0, &sides));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_power(zhang, JP_COST_PHYSICAL, &fast, 0, &power));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT,
                            jp_skid_steer_power(zhang, JP_COST_PHYSICAL, &driven, -JP_Q24_ONE - 1, &power));
    TEST_ASSERT_EQUAL_INT32(77, sides.left);
    TEST_ASSERT_EQUAL_INT32(77, sides.right);
    TEST_ASSERT_EQUAL_INT32(77, power);
}

static void test_null_pointers(void)
{
    const struct jp_motion driven = motion(1, 0);
    struct jp_skid_steer_sides sides;
    jp_q16 value;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_wheel_speeds(NULL, &driven, &sides));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_wheel_speeds(zhang, NULL, &sides));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_wheel_speeds(zhang, &driven, NULL));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_torques(NULL, &driven, 0, &sides));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_torques(zhang, NULL, 0, &sides));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_torques(zhang, &driven, 0, NULL));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_torques(zhang, &driven, JP_Q24_ONE + 1, &sides));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_power(NULL, JP_COST_PAPER, &driven, 0, &value));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_power(zhang, JP_COST_PAPER, NULL, 0, &value));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_power(zhang, JP_COST_PAPER, &driven, 0, NULL));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_energy(NULL, JP_COST_PAPER, &driven, 0, 1, &value));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_energy(zhang, JP_COST_PAPER, NULL, 0, 1, &value));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_skid_steer_energy(zhang, JP_COST_PAPER, &driven, 0, 1, NULL));
}

/* 708 kN against the turn; no intermediate value overflows. */
static void test_forces_saturate(void)
{
    struct jp_skid_steer_config heavy = round_numbers;
    heavy.weight = JP_Q16(16384);
    heavy.friction = JP_Q24(2);
    heavy.wheelbase = JP_Q24(4);
    heavy.width = JP_Q24(0.05);
    heavy.wheel_radius = JP_Q24(1);
    const struct jp_motion spin = motion(0, 8);
    struct jp_skid_steer_sides torques;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_skid_steer_torques(&heavy, &spin, 0, &torques));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, torques.right);
    jp_q16 energy = 0;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW,
                            jp_skid_steer_energy(&heavy, JP_COST_PHYSICAL, &spin, 0, JP_Q16(256), &energy));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, energy);
}

/* Up a slope of 1 at 16 384 N, 30 kN more turn it: a side alone pushes 38 kN. */
static void test_the_force_of_one_side_saturates(void)
{
    struct jp_skid_steer_config heavy = on_wheels_of_a_metre();
    struct jp_skid_steer_sides torques;

    heavy.weight = JP_Q16(16384);
    heavy.friction = JP_Q24(2);
    heavy.wheelbase = JP_Q24(4);
    heavy.width = JP_Q24(1.17);
    const struct jp_motion left = motion(0.01, 8);
    const struct jp_motion right = motion(0.01, -8);

    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_skid_steer_torques(&heavy, &left, JP_Q24_ONE, &torques));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, torques.right);
    TEST_ASSERT_TRUE(torques.left > INT32_MIN);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_skid_steer_torques(&heavy, &right, JP_Q24_ONE, &torques));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, torques.left);
    TEST_ASSERT_TRUE(torques.right > INT32_MIN);
}

/* 2 047 N of a side at 1 N·m/A and 1 m; then 2^-16 N more. */
static void test_a_current_may_be_2047_A(void)
{
    struct jp_skid_steer_config strong = on_wheels_of_a_metre();
    const struct jp_motion slow = motion(0.01, 0);
    jp_q16 power = 0;

    strong.weight = JP_Q16(8188);
    strong.rolling = JP_Q24(0.5);
    strong.torque_per_ampere = JP_Q16(1);
    strong.resistance = 0;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_power(&strong, JP_COST_PAPER, &slow, 0, &power));
    strong.weight += 4;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_skid_steer_power(&strong, JP_COST_PAPER, &slow, 0, &power));
}

/* Of a power that just fits: a motion that takes no time is level, and takes nothing. */
static void test_a_motion_without_duration_takes_nothing(void)
{
    struct jp_skid_steer_config full = round_numbers;
    const struct jp_motion fast = motion(8, 0);
    jp_q16 power = 0;
    jp_q16 energy = 77;

    full.weight = JP_Q16(16384);
    full.rolling = JP_Q24(0.2499);
    full.torque_per_ampere = JP_Q16(16384);
    full.resistance = 0;
    full.efficiency = JP_Q24_ONE;
    full.electronics_power = 0;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_power(&full, JP_COST_PHYSICAL, &fast, 0, &power));
    full.electronics_power = INT32_MAX - power;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_energy(&full, JP_COST_PHYSICAL, &fast, 0, 0, &energy));
    TEST_ASSERT_EQUAL_INT32(0, energy);
}

static void test_currents_and_powers_saturate(void)
{
    struct jp_skid_steer_config weak = round_numbers;
    weak.torque_per_ampere = JP_Q16(0.01);
    weak.resistance = JP_Q24(100);
    const struct jp_motion driven = motion(8, 0);
    jp_q16 power = 0;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_skid_steer_power(&weak, JP_COST_PAPER, &driven, JP_Q24_ONE, &power));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, power);
}

/* What a current beyond its range does not show in the power is an overflow all the same. */
static void test_currents_alone_saturate(void)
{
    struct jp_skid_steer_config weak = round_numbers;
    weak.torque_per_ampere = JP_Q16(0.01);
    weak.weight = JP_Q16(16384);
    weak.resistance = 0;
    const struct jp_motion driven = motion(0.01, 0);
    jp_q16 power = 0;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_skid_steer_power(&weak, JP_COST_PAPER, &driven, JP_Q24_ONE, &power));
    TEST_ASSERT_TRUE(power < INT32_MAX);
}

/* 16384 N · (0.5 + 1) · 8 m/s, at currents and forces within their range. */
static void test_power_alone_saturates(void)
{
    struct jp_skid_steer_config heavy = round_numbers;
    heavy.weight = JP_Q16(16384);
    heavy.rolling = JP_Q24(0.5);
    heavy.torque_per_ampere = JP_Q16(16384);
    heavy.resistance = 0;
    const struct jp_motion driven = motion(8, 0);
    struct jp_skid_steer_sides torques;
    jp_q16 power = 0;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_torques(&heavy, &driven, JP_Q24_ONE, &torques));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_skid_steer_power(&heavy, JP_COST_PAPER, &driven, JP_Q24_ONE, &power));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, power);
}

static void test_long_motions_saturate(void)
{
    const struct jp_motion driven = motion(8, 0);
    jp_q16 energy = 0;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW,
                            jp_skid_steer_energy(&round_numbers, JP_COST_PAPER, &driven, 0, JP_Q16(256), &energy));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, energy);
}

/* Table 3: 2632.32 J / 37.48 m. */
static void test_zhang2018_costs_what_table_3_implies(void)
{
    const struct jp_motion driven = motion(0.5, 0);
    jp_q16 energy = 0;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_skid_steer_energy(zhang, JP_COST_PHYSICAL, &driven, 0, JP_Q16(2), &energy));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), JP_Q16(70.2327), energy);
}
