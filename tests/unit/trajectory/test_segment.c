/* The segment optimiser: the paper's Table 3, every status, symmetry and limits. */
#include <joulepath/segment.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "unity.h"

#define MILLIMETRE JP_Q16(0.001)

static const struct jp_segment_limits paper_limits = {JP_Q24(1), JP_Q24(0.35), JP_Q24(1.3962634), JP_Q16(600)};
static const struct jp_motion rest;
static const struct jp_point origin;

static struct jp_energy_model model;
static struct jp_segment_limits limits;

void setUp(void)
{
    model = jp_energy_model_published;
    limits = paper_limits;
}

void tearDown(void)
{
}

static enum jp_status optimise_from(struct jp_motion before, jp_q16 x, jp_q16 y, struct jp_segment *segment)
{
    const struct jp_point target = {x, y};
    return jp_segment_optimise(&model, &limits, &before, &origin, 0, &target, segment);
}

static enum jp_status optimise(jp_q16 x, jp_q16 y, struct jp_segment *segment)
{
    return optimise_from(rest, x, y, segment);
}

static int32_t magnitude(int32_t a)
{
    return a < 0 ? -a : a;
}

static void expect_limits_met(const struct jp_segment *segment)
{
    const struct jp_segment_command *command = &segment->command;
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, command->motion.speed);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(limits.speed, command->motion.speed);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(limits.turn_rate, magnitude(command->motion.turn_rate));
    TEST_ASSERT_LESS_OR_EQUAL_INT32(limits.turn, magnitude(command->turn));
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(model.settling_time, command->duration);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(limits.duration, command->duration);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(JP_ARC_ANGLE_MAX, magnitude(segment->arc));
}

/* Numbers of the paper in its units, scaled to integers by the test's literals. */
struct row {
    jp_q16 energy, energy_within;     /* 0.4 % */
    jp_q16 duration, duration_within; /* 1 % */
    jp_q24 turn_rate;
    jp_q24 turn;
};

#define ROW(e, t, w, degrees)                                                                                          \
    {                                                                                                                  \
        JP_Q16(e), JP_Q16((e)*0.004), JP_Q16(t), JP_Q16((t)*0.01), JP_Q24(w), JP_Q24((degrees)*0.017453292519943295)   \
    }

static void test_table_3(void)
{
    static const struct jp_point waypoints[] = {
        {JP_Q16(10), JP_Q16(10)}, {JP_Q16(20), JP_Q16(15)}, {JP_Q16(25), JP_Q16(25)}, {JP_Q16(15), JP_Q16(30)}};
    static const struct row paper[] = {ROW(336.97, 28.46, 0.011, 36.28), ROW(252.43, 21.42, -0.011, -20.68),
                                       ROW(256.15, 21.38, 0.017, 33.06), ROW(270.15, 21.62, 0.030, 61.00)};
    struct jp_motion before = rest;
    struct jp_point start = origin;
    jp_angle heading = 0;
    jp_q16 sum = 0;
    for (int i = 0; i < 4; i++) {
        struct jp_segment segment;
        TEST_ASSERT_EQUAL_INT32(
            JP_OK, jp_segment_optimise(&model, &limits, &before, &start, heading, &waypoints[i], &segment));
        TEST_ASSERT_INT32_WITHIN(paper[i].energy_within, paper[i].energy, segment.energy);
        TEST_ASSERT_INT32_WITHIN(paper[i].duration_within, paper[i].duration, segment.command.duration);
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), paper[i].turn_rate, segment.command.motion.turn_rate);
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.1 * 0.017453292519943295), paper[i].turn, segment.command.turn);
        expect_limits_met(&segment);
        sum += segment.energy;
        before = segment.command.motion;
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_segment_end(&segment, &start, heading, &start, &heading));
        TEST_ASSERT_INT32_WITHIN(MILLIMETRE, waypoints[i].x, start.x);
        TEST_ASSERT_INT32_WITHIN(MILLIMETRE, waypoints[i].y, start.y);
    }
    TEST_ASSERT_LESS_OR_EQUAL_INT32(JP_Q16(1114.3), sum);
}

/* Straight ahead from rest nearly nothing but the cubic is left: 2 A/T³ + B/T² = Ps with A = (a1 − b1 Ts) d² and
 * B = b1 d², so T = 20.717 s. The terms a4 to a6 bend the path by 0.2°. */
static void test_straight_ahead(void)
{
    struct jp_segment segment;
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(10), 0, &segment));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.005), 0, segment.command.turn);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.03), JP_Q16(20.717), segment.command.duration);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(10), segment.length);
}

/* What is stored agrees with itself: v T = L, w T = γ, E = jp_energy_predict(). */
static void test_answer_is_consistent(void)
{
    struct jp_segment segment;
    jp_q16 energy;
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(-3), JP_Q16(2), &segment));
    const struct jp_segment_command *command = &segment.command;
    TEST_ASSERT_INT32_WITHIN(4, segment.length, jp_multiply_shift(command->motion.speed, command->duration, 24));
    TEST_ASSERT_INT32_WITHIN(400, segment.arc, jp_multiply_shift(command->motion.turn_rate, command->duration, 16));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_energy_predict(&model, &rest, command, &energy));
    TEST_ASSERT_EQUAL_INT32(energy, segment.energy);
}

static void test_nearest_and_farthest_target(void)
{
    struct jp_segment segment;
    limits.duration = JP_Q16(16384);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ZERO_LENGTH, optimise(0, 0, &segment));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ZERO_LENGTH, optimise(0, JP_SEGMENT_LENGTH_MIN - 1, &segment));
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_SEGMENT_LENGTH_MIN, 0, &segment));
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_SEGMENT_LENGTH_MAX, 0, &segment));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, optimise(JP_SEGMENT_LENGTH_MAX, JP_Q16(1), &segment));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, optimise(JP_SEGMENT_LENGTH_MAX + 1, 0, &segment));
    const struct jp_point far_left = {INT32_MIN, 0};
    const struct jp_point far_right = {INT32_MAX, 0};
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT,
                            jp_segment_optimise(&model, &limits, &rest, &far_left, 0, &far_right, &segment));
}

static void test_previous_motion_out_of_range(void)
{
    struct jp_segment segment;
    const struct jp_motion fast = {JP_Q24(8) + 1, 0};
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, optimise_from(fast, JP_Q16(1), 0, &segment));
}

static void test_infeasible_turn_leaves_the_segment_alone(void)
{
    struct jp_segment segment = {.energy = 77};
    limits.turn = JP_Q24(0.2);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_INFEASIBLE, optimise(JP_Q16(-5), JP_Q16(0.01), &segment));
    TEST_ASSERT_EQUAL_INT32(77, segment.energy);
}

static void test_infeasible_duration(void)
{
    struct jp_segment segment;
    limits.duration = JP_Q16(9);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_INFEASIBLE, optimise(JP_Q16(10), 0, &segment));
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(8.9), 0, &segment));
    expect_limits_met(&segment);
    /* Sideways the arc is too long for its duration. */
    limits.turn = 0;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_INFEASIBLE, optimise(0, JP_Q16(8.9), &segment));
}

/* Without a turn on the spot the arc alone reaches the bearing: γ = 2β. */
static void test_no_turn_allowed(void)
{
    struct jp_segment segment;
    limits.turn = 0;
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(3), JP_Q16(3), &segment));
    TEST_ASSERT_EQUAL_INT32(0, segment.command.turn);
    TEST_ASSERT_INT32_WITHIN(16, JP_Q24(1.5707963), segment.arc);
    expect_limits_met(&segment);
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(3), 0, &segment));
    TEST_ASSERT_INT32_WITHIN(1, 0, segment.arc);
}

static void test_target_exactly_behind(void)
{
    struct jp_segment segment;
    struct jp_segment again;
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(-2), 0, &segment));
    expect_limits_met(&segment);
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(-2), 0, &again));
    TEST_ASSERT_EQUAL_MEMORY(&segment, &again, sizeof segment);
    struct jp_point end;
    jp_angle heading;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_segment_end(&segment, &origin, 0, &end, &heading));
    TEST_ASSERT_INT32_WITHIN(MILLIMETRE, JP_Q16(-2), end.x);
    TEST_ASSERT_INT32_WITHIN(MILLIMETRE, 0, end.y);
}

/* A robot whose left and right differ nowhere drives mirror images. */
static void test_mirror_image(void)
{
    static const struct jp_point targets[] = {{JP_Q16(4), JP_Q16(1)},
                                              {JP_Q16(1), JP_Q16(4)},
                                              {JP_Q16(-3), JP_Q16(2)},
                                              {JP_Q16(0.3), JP_Q16(-0.2)},
                                              {JP_Q16(-0.5), JP_Q16(-2)}};
    static const jp_q16 symmetric[JP_ENERGY_TERMS] = {
        JP_Q16(172.2), JP_Q16(7.57), JP_Q16(13.2), 0,           0,           JP_Q16(1.37), JP_Q16(16.1),
        JP_Q16(-4.3),  JP_Q16(-1.1), JP_Q16(16.1), JP_Q16(4.3), JP_Q16(1.1), JP_Q16(5.82)};
    for (int i = 0; i < JP_ENERGY_TERMS; i++) {
        model.a[i] = symmetric[i];
    }
    for (size_t i = 0; i < sizeof targets / sizeof targets[0]; i++) {
        struct jp_segment left;
        struct jp_segment right;
        const struct jp_motion before = {JP_Q24(0.4), JP_Q24(0.1)};
        const struct jp_motion mirrored = {JP_Q24(0.4), -JP_Q24(0.1)};
        TEST_ASSERT_EQUAL_INT32(JP_OK, optimise_from(before, targets[i].x, targets[i].y, &left));
        TEST_ASSERT_EQUAL_INT32(JP_OK, optimise_from(mirrored, targets[i].x, -targets[i].y, &right));
        TEST_ASSERT_INT32_WITHIN(left.energy >> 16, left.energy, right.energy);
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), left.arc, -right.arc);
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), left.command.turn, -right.command.turn);
    }
}

static void test_each_limit_binds(void)
{
    struct jp_segment segment;
    limits.speed = JP_Q24(0.1);
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(5), JP_Q16(0.5), &segment));
    expect_limits_met(&segment);
    TEST_ASSERT_INT32_WITHIN(16, limits.speed, segment.command.motion.speed);

    limits = paper_limits;
    limits.turn_rate = JP_Q24(0.02);
    limits.turn = JP_Q24(0.5);
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(1), JP_Q16(1), &segment));
    expect_limits_met(&segment);
    TEST_ASSERT_INT32_WITHIN(16, limits.turn_rate, segment.command.motion.turn_rate);
    TEST_ASSERT_INT32_WITHIN(16, limits.turn, segment.command.turn);

    limits = paper_limits;
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(0.1), 0, &segment));
    TEST_ASSERT_EQUAL_INT32(model.settling_time, segment.command.duration);

    limits.duration = JP_Q16(12);
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(10), 0, &segment));
    TEST_ASSERT_EQUAL_INT32(limits.duration, segment.command.duration);
    expect_limits_met(&segment);
}

static void test_without_settling_time(void)
{
    struct jp_segment segment;
    model.settling_time = 0;
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(0.01), 0, &segment));
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(JP_SEGMENT_DURATION_MIN, segment.command.duration);
    expect_limits_met(&segment);
}

/* With a1 < b1 Ts and little friction the energy falls with T: the optimum is on the speed limit. */
static void test_no_minimum_inside_the_limits(void)
{
    struct jp_segment segment;
    model.a[0] = JP_Q16(-20);
    model.b[0] = JP_Q16(1);
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(50), 0, &segment));
    TEST_ASSERT_INT32_WITHIN(64, limits.speed, segment.command.motion.speed);
}

static void test_negative_energy_is_a_model_error(void)
{
    struct jp_segment segment = {.energy = 77};
    model.a[0] = JP_Q16(-4096);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_MODEL, optimise(JP_Q16(50), 0, &segment));
    TEST_ASSERT_EQUAL_INT32(77, segment.energy);
}

static void test_energy_beyond_its_format(void)
{
    struct jp_segment segment;
    model.b[0] = JP_Q16(4096);
    limits.speed = JP_Q24(0.5);
    limits.duration = JP_Q16(2000);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, optimise(JP_Q16(500), 0, &segment));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, segment.energy);
    expect_limits_met(&segment);
}

static void expect_bad_limit(const char *name)
{
    const char *field = "none";
    TEST_ASSERT_EQUAL_INT32(JP_ERR_CONFIG, jp_segment_limits_check(&limits, &model, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
    limits = paper_limits;
}

static void test_check_names_the_bad_limit(void)
{
    const char *field = "none";
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_segment_limits_check(&limits, &model, &field));
    limits.speed = 0;
    expect_bad_limit("limits.speed");
    limits.speed = JP_Q24(8) + 1;
    expect_bad_limit("limits.speed");
    limits.turn_rate = 0;
    expect_bad_limit("limits.turn_rate");
    limits.turn_rate = JP_Q24(8) + 1;
    expect_bad_limit("limits.turn_rate");
    limits.turn = -1;
    expect_bad_limit("limits.turn");
    limits.turn = JP_Q24(3.141592653589793) + 1;
    expect_bad_limit("limits.turn");
    limits.duration = model.settling_time - 1;
    expect_bad_limit("limits.duration");
    limits.duration = JP_Q16(16384) + 1;
    expect_bad_limit("limits.duration");
    model.settling_time = 0;
    limits.duration = JP_SEGMENT_DURATION_MIN - 1;
    expect_bad_limit("limits.duration");
}

static void test_widest_limits_pass_their_check(void)
{
    const char *field = "none";
    limits = (struct jp_segment_limits){JP_Q24(8), JP_Q24(8), JP_Q24(3.141592653589793), JP_Q16(16384)};
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_segment_limits_check(&limits, &model, &field));
    limits = (struct jp_segment_limits){1, 1, 0, model.settling_time};
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_segment_limits_check(&limits, &model, &field));
}

/* A robot that may turn half round first has its target ahead, wherever it is. */
static void test_half_a_turn_allowed(void)
{
    struct jp_segment ahead;
    struct jp_segment behind;
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(5), 0, &ahead));
    limits.turn = JP_Q24(3.141592653589793);
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(-5), JP_Q16(-0.001), &behind));
    expect_limits_met(&behind);
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(JP_Q24(1.5), magnitude(behind.command.turn));
    limits = paper_limits;
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(-5), JP_Q16(-0.001), &ahead));
    TEST_ASSERT_LESS_OR_EQUAL_INT32(ahead.energy, behind.energy);
}

/* A robot that was fast has a minimum at an arc of 272° and spends less yet at the longest one. With a wider limit of
 * the turn the optimum gets no worse, and the longest arc comes within it. */
static void test_longest_arc_is_looked_at(void)
{
    const struct jp_motion fast = {JP_Q24(1.37), JP_Q24(-0.5)};
    struct jp_segment segment;
    jp_q16 least = INT32_MAX;
    limits = (struct jp_segment_limits){JP_Q24(3.4), JP_Q24(1.7), JP_Q24(0.3), JP_Q16(600)};
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise_from(fast, JP_Q16(-0.0744), JP_Q16(-0.1142), &segment));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(-4.745), segment.arc);
    for (limits.turn = 0; limits.turn <= JP_Q24(1.4); limits.turn += JP_Q24(0.05)) {
        TEST_ASSERT_EQUAL_INT32(JP_OK, optimise_from(fast, JP_Q16(-0.0744), JP_Q16(-0.1142), &segment));
        expect_limits_met(&segment);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(least, segment.energy - JP_Q16(0.001));
        least = segment.energy;
    }
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), -JP_ARC_ANGLE_MAX, segment.arc);
}

static void test_null_pointers(void)
{
    const struct jp_point target = {JP_Q16(1), 0};
    struct jp_segment segment = {.energy = 77};
    const char *field = "none";
    struct jp_point end;
    jp_angle heading;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_segment_optimise(NULL, &limits, &rest, &origin, 0, &target, &segment));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_segment_optimise(&model, NULL, &rest, &origin, 0, &target, &segment));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_segment_optimise(&model, &limits, NULL, &origin, 0, &target, &segment));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_segment_optimise(&model, &limits, &rest, NULL, 0, &target, &segment));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_segment_optimise(&model, &limits, &rest, &origin, 0, NULL, &segment));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_segment_optimise(&model, &limits, &rest, &origin, 0, &target, NULL));
    TEST_ASSERT_EQUAL_INT32(77, segment.energy);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_segment_limits_check(NULL, &model, &field));
    limits.duration = model.settling_time - 1;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_CONFIG, jp_segment_limits_check(&limits, &model, &field));
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_segment_limits_check(&limits, NULL, &field));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_segment_limits_check(&limits, &model, NULL));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_segment_end(NULL, &origin, 0, &end, &heading));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_segment_end(&segment, NULL, 0, &end, &heading));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_segment_end(&segment, &origin, 0, NULL, &heading));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_segment_end(&segment, &origin, 0, &end, NULL));
}

static void test_end_of_an_arc(void)
{
    /* A quarter of a circle of radius 1 m to the left, begun along y. */
    const struct jp_segment segment = {
        .command = {.turn = JP_Q24(1.5707963)}, .arc = JP_Q24(1.5707963), .length = JP_Q16(1.5707963)};
    const struct jp_point start = {JP_Q16(3), JP_Q16(-4)};
    struct jp_point end;
    jp_angle heading;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_segment_end(&segment, &start, 0, &end, &heading));
    TEST_ASSERT_INT32_WITHIN(2, JP_Q16(2), end.x);
    TEST_ASSERT_INT32_WITHIN(2, JP_Q16(-3), end.y);
    TEST_ASSERT_INT32_WITHIN(256, 0, (int32_t)(heading - JP_ANGLE_DEGREES(180)));
}

static void test_end_outside_the_plane(void)
{
    const struct jp_segment segment = {.length = JP_Q16(500)};
    const struct jp_point start = {INT32_MAX - JP_Q16(1), 0};
    struct jp_point end;
    jp_angle heading;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_segment_end(&segment, &start, 0, &end, &heading));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, end.x);
    TEST_ASSERT_EQUAL_INT32(0, end.y);
    const struct jp_point far_down = {0, INT32_MIN + JP_Q16(1)};
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW,
                            jp_segment_end(&segment, &far_down, JP_ANGLE_DEGREES(270), &end, &heading));
    TEST_ASSERT_EQUAL_INT32(0, end.x);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, end.y);
}

/* At 0.5 m/s, turning by a quarter to the left with 4 rad/s: 2τ is half a second, a quarter of a metre. */
static void test_the_turning_point_lies_behind_the_turn(void)
{
    const struct jp_point start = {JP_Q16(1), JP_Q16(2)};
    const struct jp_point from =
        jp_segment_turning_point(JP_Q16(4), JP_Q24(0.5), &start, 0, JP_Q24(1.5707963267948966));
    const struct jp_point straight = jp_segment_turning_point(JP_Q16(4), JP_Q24(0.5), &start, 0, 0);

    TEST_ASSERT_INT32_WITHIN(20, JP_Q16(1.25), from.x);
    TEST_ASSERT_INT32_WITHIN(20, JP_Q16(1.75), from.y);
    TEST_ASSERT_INT32_WITHIN(1, start.x, straight.x);
    TEST_ASSERT_INT32_WITHIN(1, start.y, straight.y);
}

/* A straight way ends where it is measured to, rounded to the nearest 2^-16 m. */
static void test_an_end_is_rounded_to_the_nearest(void)
{
    for (int32_t i = 0; i < 40; i++) {
        const struct jp_segment straight = {.length = JP_Q16(1) + 7 * i};
        struct jp_point end;
        jp_angle heading;

        for (int quarter = 0; quarter < 4; quarter++) {
            const int32_t x = quarter == 0 ? straight.length : (quarter == 2 ? -straight.length : 0);
            const int32_t y = quarter == 1 ? straight.length : (quarter == 3 ? -straight.length : 0);

            TEST_ASSERT_EQUAL_INT32(
                JP_OK, jp_segment_end(&straight, &origin, (jp_angle)quarter * JP_ANGLE_DEGREES(90), &end, &heading));
            TEST_ASSERT_EQUAL_INT32(x, end.x);
            TEST_ASSERT_EQUAL_INT32(y, end.y);
        }
    }
}

/* A limit of the turn rate that acts: the arc may not take longer than segments may last. */
static void test_no_arc_lasts_longer_than_it_may(void)
{
    struct jp_segment segment;

    limits = (struct jp_segment_limits){JP_Q24(1), JP_Q24(0.01), JP_Q24(0.3), JP_Q16(100)};
    for (int32_t i = 0; i < 24; i++) {
        const enum jp_status status = optimise(JP_Q16(3), JP_Q16(0.25) * (i - 12), &segment);

        if (status == JP_OK) {
            expect_limits_met(&segment);
        } else {
            TEST_ASSERT_EQUAL_INT32(JP_ERR_INFEASIBLE, status);
            TEST_ASSERT_GREATER_THAN_INT32(6, i < 12 ? 12 - i : i - 12);
        }
    }
}

/* Round the left or round the right: a target just to either side of right behind takes the same, however it turned
 * before. */
static void test_both_ways_round_are_looked_at(void)
{
    for (int i = -3; i <= 3; i++) {
        const struct jp_motion before = {JP_Q24(0.3), i * JP_Q24(0.08)};
        struct jp_segment left;
        struct jp_segment right;

        TEST_ASSERT_EQUAL_INT32(JP_OK, optimise_from(before, JP_Q16(-3), JP_Q16(0.002), &left));
        TEST_ASSERT_EQUAL_INT32(JP_OK, optimise_from(before, JP_Q16(-3), -JP_Q16(0.002), &right));
        TEST_ASSERT_INT32_WITHIN(left.energy / 500, left.energy, right.energy);
    }
}

/* Limits that leave a near target one duration pass their check, and it is taken. */
static void test_the_longest_duration_may_be_the_shortest(void)
{
    struct jp_segment segment;
    const char *field = "none";

    limits.duration = model.settling_time;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_segment_limits_check(&limits, &model, &field));
    TEST_ASSERT_EQUAL_INT32(JP_OK, optimise(JP_Q16(0.1), 0, &segment));
    TEST_ASSERT_EQUAL_INT32(model.settling_time, segment.command.duration);
    TEST_ASSERT_INT32_WITHIN(JP_SEGMENT_LENGTH_MIN, JP_Q16(0.1), segment.length);
}
