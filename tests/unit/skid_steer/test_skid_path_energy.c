/* What a path takes: the sum of its parts by hand, and prices of a model. */
#include <joulepath/skid_path_energy.h>
#include <joulepath/tables.h>
#include <stddef.h>
#include <stdlib.h>

#include "unity.h"

#define PIECES 3

static const struct jp_skid_energy_model *const model = &jp_skid_energy_zhang2018;

static struct jp_path_piece pieces[PIECES];
static struct jp_lattice_path path;
static struct jp_skid_drive drive;
static jp_q16 duration;

void setUp(void)
{
    path = (struct jp_lattice_path){.pieces = pieces, .places = PIECES, .count = 1};
    drive = (struct jp_skid_drive){.energy = 0};
    duration = 0;
}

void tearDown(void)
{
}

static void add(struct jp_skid_drive *sum, jp_q24 from, jp_q24 to, jp_q24 bend, jp_q24 grade, jp_q16 seconds)
{
    const struct jp_skid_piece piece = {.start = {from, jp_q24_multiply(from, bend)},
                                        .end = {to, jp_q24_multiply(to, bend)},
                                        .grade = grade,
                                        .duration = seconds};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(model, sum, &piece));
}

/** Half a second at 0.5 m/s. */
static void add_bend(struct jp_skid_drive *sum, jp_q24 from, jp_q24 to)
{
    const struct jp_skid_piece piece = {
        .start = {JP_Q24(0.5), from / 2}, .end = {JP_Q24(0.5), to / 2}, .duration = JP_Q16(0.5)};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(model, sum, &piece));
}

static void expect_drive(const struct jp_skid_drive *expected)
{
    TEST_ASSERT_TRUE(drive.energy > 0);
    TEST_ASSERT_TRUE(llabs(drive.energy - expected->energy) < 2000);
    for (unsigned i = 0; i < JP_SKID_FACTORS; i++) {
        TEST_ASSERT_TRUE(llabs(drive.change[i] - expected->change[i]) < 2000);
    }
}

/* 64 m at 0.05 m/s: 1 280 s, more than skid_energy.h takes at once. */
static void test_a_line_that_takes_long(void)
{
    struct jp_skid_drive expected = {.energy = 0};

    pieces[0] = (struct jp_path_piece){
        .length = JP_Q24(64),
        .kind = JP_PIECE_CURVE,
        .speed = {.cruise = JP_Q24(0.05), .acceleration = JP_Q24(0.25), .brake_from = JP_Q24(64) - JP_Q24(0.005)}};
    jp_skid_path_energy(model, &path, &drive, &duration);
    TEST_ASSERT_INT32_WITHIN(64, JP_Q16(1280.2), duration);
    for (int i = 0; i < 5; i++) {
        add(&expected, JP_Q24(0.05), JP_Q24(0.05), 0, 0, JP_Q16(256));
    }
    TEST_ASSERT_TRUE(llabs(drive.energy - expected.energy) < expected.energy / 1000);
}

/* 4 m at 0.5 m/s up 0.1, from a stand to a stand at 0.25 m/s²: 2 s and 0.5 m each to speed up and to brake. */
static void test_a_line_of_three_parts(void)
{
    struct jp_skid_drive expected = {.energy = 0};

    pieces[0] = (struct jp_path_piece){
        .length = JP_Q24(4),
        .rise = JP_Q16(0.4),
        .kind = JP_PIECE_CURVE,
        .speed = {.cruise = JP_Q24(0.5), .acceleration = JP_Q24(0.25), .brake_from = JP_Q24(3.5)}};
    jp_skid_path_energy(model, &path, &drive, &duration);
    TEST_ASSERT_INT32_WITHIN(16, JP_Q16(10), duration);
    add(&expected, 0, JP_Q24(0.5), 0, JP_Q24(0.1), JP_Q16(2));
    add(&expected, JP_Q24(0.5), JP_Q24(0.5), 0, JP_Q24(0.1), JP_Q16(6));
    add(&expected, JP_Q24(0.5), 0, 0, JP_Q24(0.1), JP_Q16(2));
    expect_drive(&expected);
}

/* A turn by 2 rad at 0.5 rad/s and 0.5 rad/s², right as left. */
static void test_turns_on_the_spot(void)
{
    struct jp_skid_drive left;

    pieces[0] = (struct jp_path_piece){
        .length = JP_Q24(2),
        .rise = JP_Q16(9), /* of no meaning */
        .kind = JP_PIECE_TURN_LEFT,
        .speed = {.cruise = JP_Q24(0.5), .acceleration = JP_Q24(0.5), .brake_from = JP_Q24(1.75)}};
    jp_skid_path_energy(model, &path, &drive, &duration);
    TEST_ASSERT_INT32_WITHIN(16, JP_Q16(5), duration);
    left = drive;
    setUp();
    pieces[0].kind = JP_PIECE_TURN_RIGHT;
    jp_skid_path_energy(model, &path, &drive, &duration);
    expect_drive(&left);
}

/* The least angle there is: before it has a speed it is there. */
static void test_a_turn_of_one_step_takes_nothing(void)
{
    pieces[0] = (struct jp_path_piece){
        .length = 1, .kind = JP_PIECE_TURN_RIGHT, .speed = {.cruise = 3982, .acceleration = 15861908, .brake_from = 1}};
    jp_skid_path_energy(model, &path, &drive, &duration);
    TEST_ASSERT_EQUAL_INT64(0, drive.energy);
    TEST_ASSERT_EQUAL_INT32(0, duration);
}

/* Pieces that follow each other hand on their speed; a part without length takes nothing. */
static void test_an_arc_between_lines(void)
{
    struct jp_skid_drive expected = {.energy = 0};
    const struct jp_piece_speed through = {.cruise = JP_Q24(0.5), .end = JP_Q24(0.5), .acceleration = JP_Q24(0.25)};

    path.count = PIECES;
    pieces[0] = (struct jp_path_piece){.length = JP_Q24(1), .kind = JP_PIECE_CURVE, .speed = through};
    pieces[1] =
        (struct jp_path_piece){.length = JP_Q24(1), .bend = JP_Q24(0.5), .kind = JP_PIECE_CURVE, .speed = through};
    pieces[2] = (struct jp_path_piece){.length = JP_Q24(1), .kind = JP_PIECE_CURVE, .speed = through};
    pieces[0].speed.brake_from = JP_Q24(1);
    pieces[1].speed.brake_from = JP_Q24(1);
    pieces[2].speed.brake_from = JP_Q24(0.5);
    pieces[2].speed.end = 0;
    jp_skid_path_energy(model, &path, &drive, &duration);
    TEST_ASSERT_INT32_WITHIN(32, JP_Q16(2 + 1 + 2 + 1 + 2), duration);
    add(&expected, 0, JP_Q24(0.5), 0, 0, JP_Q16(2));
    add(&expected, JP_Q24(0.5), JP_Q24(0.5), 0, 0, JP_Q16(1));
    add(&expected, JP_Q24(0.5), JP_Q24(0.5), JP_Q24(0.5), 0, JP_Q16(2));
    add(&expected, JP_Q24(0.5), JP_Q24(0.5), 0, 0, JP_Q16(1));
    add(&expected, JP_Q24(0.5), 0, 0, 0, JP_Q16(2));
    expect_drive(&expected);
}

/* One arc and its line at 0.5 m/s that bend evenly over 0.25 m on either side of where they meet. */
static void test_curvature_that_changes_evenly(void)
{
    struct jp_skid_drive expected = {.energy = 0};
    struct jp_piece_speed through = {.cruise = JP_Q24(0.5), .end = JP_Q24(0.5), .acceleration = JP_Q24(0.25)};

    through.brake_from = JP_Q24(1);
    path.count = 2;
    pieces[0] = (struct jp_path_piece){.length = JP_Q24(1), .kind = JP_PIECE_CURVE, .speed = through};
    through.blend = JP_Q24(0.25);
    through.blend_rate = JP_Q16(1);
    pieces[1] =
        (struct jp_path_piece){.length = JP_Q24(1), .bend = JP_Q24(0.5), .kind = JP_PIECE_CURVE, .speed = through};
    jp_skid_piece_energy(model, &pieces[0], &pieces[1], JP_Q24(0.5), &drive, &duration);
    jp_skid_piece_energy(model, &pieces[1], NULL, JP_Q24(0.5), &drive, &duration);
    TEST_ASSERT_INT32_WITHIN(32, JP_Q16(4), duration);
    add(&expected, JP_Q24(0.5), JP_Q24(0.5), 0, 0, JP_Q16(1.5));
    add_bend(&expected, 0, JP_Q24(0.25));
    add_bend(&expected, JP_Q24(0.25), JP_Q24(0.5));
    add(&expected, JP_Q24(0.5), JP_Q24(0.5), JP_Q24(0.5), 0, JP_Q16(1.5));
    expect_drive(&expected);
}

/* From a stand: it bends while it speeds up, and brakes while it bends back. */
static void test_speed_and_curvature_that_change_together(void)
{
    struct jp_skid_drive whole = {.energy = 0};

    path.count = 2;
    pieces[0] = (struct jp_path_piece){
        .length = JP_Q24(1),
        .bend = JP_Q24(0.5),
        .kind = JP_PIECE_CURVE,
        .speed = {
            .cruise = JP_Q24(0.5), .end = JP_Q24(0.25), .acceleration = JP_Q24(0.25), .brake_from = JP_Q24(0.625)}};
    pieces[1] = (struct jp_path_piece){
        .length = JP_Q24(1),
        .kind = JP_PIECE_CURVE,
        .speed = {.cruise = JP_Q24(0.25), .end = JP_Q24(0.25), .acceleration = JP_Q24(0.25), .brake_from = JP_Q24(1)}};
    jp_skid_piece_energy(model, &pieces[0], &pieces[1], 0, &whole, &duration);
    pieces[1].speed.blend = JP_Q24(0.125);
    pieces[1].speed.blend_rate = -JP_Q16(2);
    jp_skid_piece_energy(model, &pieces[0], &pieces[1], 0, &drive, &duration);
    TEST_ASSERT_INT32_WITHIN(64, 2 * JP_Q16(2 + 0.25 + 1), duration);
    TEST_ASSERT_TRUE(drive.energy < whole.energy);
    TEST_ASSERT_TRUE(drive.energy > whole.energy / 2);
}

static void expect_equal(const struct jp_skid_drive *expected)
{
    TEST_ASSERT_TRUE(drive.energy > 0);
    TEST_ASSERT_EQUAL_MEMORY(expected, &drive, sizeof drive);
}

/* To the last bit, whatever its rise and whichever way: 64 s at one rate. */
static void test_a_steady_turn_is_one_part(void)
{
    for (int i = 0; i < 16; i++) {
        const jp_q24 rate = JP_Q24(1) + i * 123456;
        const struct jp_skid_piece part = {.start = {0, rate}, .end = {0, rate}, .duration = JP_Q16(64)};
        struct jp_skid_drive expected = {.energy = 0};

        setUp();
        pieces[0] = (struct jp_path_piece){
            .length = 64 * rate,
            .rise = JP_Q16(9),
            .kind = i % 2 == 0 ? JP_PIECE_TURN_LEFT : JP_PIECE_TURN_RIGHT,
            .speed = {.cruise = rate, .end = rate, .acceleration = JP_Q24(1), .brake_from = 64 * rate}};
        jp_skid_piece_energy(model, &pieces[0], NULL, rate, &drive, &duration);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_add(model, &expected, &part));
        TEST_ASSERT_EQUAL_INT32(JP_Q16(64), duration);
        expect_equal(&expected);
    }
}

/* 2⁻²² m at 2⁻²⁴ m/s in the mean: 4 s. */
static void test_what_is_slow_takes_its_time(void)
{
    pieces[0] = (struct jp_path_piece){
        .length = 4, .kind = JP_PIECE_CURVE, .speed = {.cruise = 2, .end = 0, .acceleration = 1, .brake_from = 0}};
    jp_skid_piece_energy(model, &pieces[0], NULL, 2, &drive, &duration);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(4), duration);
}

/* From 0.25 to 0.5 m/s at 0.25 m/s²: a second, 0.375 m; then 2 s. */
static void test_a_line_that_begins_in_motion(void)
{
    struct jp_skid_drive expected = {.energy = 0};

    pieces[0] = (struct jp_path_piece){
        .length = JP_Q24(1.375),
        .kind = JP_PIECE_CURVE,
        .speed = {
            .cruise = JP_Q24(0.5), .end = JP_Q24(0.5), .acceleration = JP_Q24(0.25), .brake_from = JP_Q24(1.375)}};
    jp_skid_piece_energy(model, &pieces[0], NULL, JP_Q24(0.25), &drive, &duration);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(3), duration);
    add(&expected, JP_Q24(0.25), JP_Q24(0.5), 0, 0, JP_Q16(1));
    add(&expected, JP_Q24(0.5), JP_Q24(0.5), 0, 0, JP_Q16(2));
    expect_equal(&expected);
}

/* From a stand, each with the one after it; what is kept behind its end is none of it. */
static void test_a_path_is_the_sum_of_its_pieces(void)
{
    struct jp_skid_drive expected = {.energy = 0};
    const jp_q24 cruise = JP_Q24(0.5) + 1;
    jp_q16 lasts = 0;

    path.count = 2;
    for (unsigned i = 0; i < PIECES; i++) {
        pieces[i] = (struct jp_path_piece){
            .length = JP_Q24(32),
            .bend = i == 1U ? JP_Q24(0.5) : 0,
            .rise = JP_Q16(8),
            .kind = JP_PIECE_CURVE,
            .speed = {.cruise = cruise, .end = cruise, .acceleration = JP_Q24_ONE / 256, .brake_from = JP_Q24(32)}};
    }
    pieces[1].speed.blend = JP_Q24(0.25);
    pieces[1].speed.blend_rate = JP_Q16(1);
    pieces[2].speed.blend = JP_Q24(0.125);
    pieces[2].speed.blend_rate = -JP_Q16(2);
    jp_skid_path_energy(model, &path, &drive, &duration);
    jp_skid_piece_energy(model, &pieces[0], &pieces[1], 0, &expected, &lasts);
    jp_skid_piece_energy(model, &pieces[1], NULL, cruise, &expected, &lasts);
    TEST_ASSERT_EQUAL_INT32(lasts, duration);
    expect_equal(&expected);
}

static void test_a_robot_that_gets_nothing_back_has_no_recovery(void)
{
    struct jp_skid_energy_model wasteful = *model;

    wasteful.braking = 0;
    TEST_ASSERT_EQUAL_INT32(0, jp_skid_motion_price(&wasteful, 0).recovery);
    wasteful.weight = JP_Q16(16384);
    wasteful.inertia = JP_Q24(8);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(16384), jp_skid_motion_price(&wasteful, 0).gain);
}

static void test_prices_of_a_model(void)
{
    const struct jp_motion_price price = jp_skid_motion_price(model, JP_Q16(3));
    const struct jp_motion motion = {JP_Q24(0.5), JP_Q24(0.2)};
    const struct jp_motion fast = {JP_Q24(9), 0};
    jp_q16 power;

    TEST_ASSERT_EQUAL_INT32(JP_Q16(3), price.time);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_energy_power(model, &motion, JP_Q24(0.1), &power));
    TEST_ASSERT_EQUAL_INT32(power, price.power(price.model, &motion, JP_Q24(0.1)));
    TEST_ASSERT_EQUAL_INT32(0, price.power(price.model, &fast, 0));
    /* 92 kg and what turns with them, over 2, driven and braked. */
    TEST_ASSERT_TRUE(price.gain > JP_Q16(46) && price.gain < JP_Q16(120));
    TEST_ASSERT_TRUE(price.recovery >= 0 && price.recovery < price.gain);
}
