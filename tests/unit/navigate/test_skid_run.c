/* Routes as paths: arcs in halves, which are driven as the whole arc is, and legs that meet in their middles. */
#include "src/navigate/skid_run.h"

#include <joulepath/tables.h>
#include <stddef.h>
#include <stdlib.h>

#include "unity.h"

#define PLACES 9

static struct jp_path_piece pieces[PLACES];
static struct jp_path_piece whole_pieces[PLACES];
static struct jp_lattice_path whole;
static struct jp_skid_run run;
static struct jp_skid_pilot_config config;

void setUp(void)
{
    config = (struct jp_skid_pilot_config){.model = &jp_skid_energy_zhang2018,
                                           .limits = jp_path_limits_zhang2018,
                                           .corner = JP_Q24(0.5),
                                           .pieces = pieces,
                                           .places = PLACES};
}

void tearDown(void)
{
}

/** Until so many pieces were looked at as corners and have speeds: then arcs are halved. */
static void lay_and_plan(const struct jp_point *targets, uint16_t count)
{
    const struct jp_line_route route = {.targets = targets, .count = count};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_run_lay(&run, &config, &route, 0));
    while (run.paced < run.path.count) {
        TEST_ASSERT_TRUE(jp_skid_run_plan(&run, &config, config.model));
    }
}

static void remember_whole(void)
{
    for (unsigned i = 0; i < run.path.count; i++) {
        whole_pieces[i] = pieces[i];
    }
    whole = run.path;
    whole.pieces = whole_pieces;
}

static void expect_the_same_energy(void)
{
    struct jp_skid_drive before = {.energy = 0};
    struct jp_skid_drive after = {.energy = 0};
    jp_q16 lasted = 0;
    jp_q16 lasts = 0;

    jp_skid_path_energy(config.model, &whole, &before, &lasted);
    jp_skid_path_energy(config.model, &run.path, &after, &lasts);
    TEST_ASSERT_INT32_WITHIN(16, lasted, lasts);
    TEST_ASSERT_TRUE(llabs(after.energy - before.energy) < before.energy / 2000);
}

/** Set-points of both, side by side. */
static void expect_the_same_drive(void)
{
    struct jp_path_drive one;
    struct jp_path_drive other;
    struct jp_path_set_point expected = {.cosine = 0};
    struct jp_path_set_point found = {.cosine = 0};
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_drive_init(&one, &jp_skid_robot_zhang2018.path, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_drive_init(&other, &jp_skid_robot_zhang2018.path, &field));
    jp_path_drive_begin(&one, &whole);
    jp_path_drive_begin(&other, &run.path);
    while (jp_path_drive_advance(&one, &expected)) {
        TEST_ASSERT_TRUE(jp_path_drive_advance(&other, &found) || expected.motion.speed == 0);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.002), expected.pose.position.x, found.pose.position.x);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.002), expected.pose.position.y, found.pose.position.y);
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), expected.motion.speed, found.motion.speed);
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.02), expected.motion.turn_rate, found.motion.turn_rate);
    }
}

static void halve_and_expect_the_same(void)
{
    remember_whole();
    while (jp_skid_run_plan(&run, &config, config.model)) {
    }
    expect_the_same_energy();
    expect_the_same_drive();
}

/* To the left and to the right. */
static void test_halves_of_arcs_are_driven_as_the_arcs(void)
{
    static const struct jp_point targets[] = {{JP_Q16(4), 0}, {JP_Q16(4), JP_Q16(4)}, {JP_Q16(8), JP_Q16(4)}};

    lay_and_plan(targets, 3);
    TEST_ASSERT_EQUAL_UINT16(5, run.path.count);
    halve_and_expect_the_same();
    TEST_ASSERT_EQUAL_UINT16(7, run.path.count);
    for (unsigned i = 1; i < 7; i += 3) {
        TEST_ASSERT_INT32_WITHIN(1, pieces[i].length, pieces[i + 1U].length);
        TEST_ASSERT_EQUAL_INT32(pieces[i].bend, pieces[i + 1U].bend);
    }
    TEST_ASSERT_FALSE(jp_skid_run_plan(&run, &config, config.model));
}

/* A quarter of a circle that passes its corner so far inside has 2.41 times as much of a radius. */
static void test_no_arc_has_an_inner_side_that_may_stand(void)
{
    static const struct jp_point targets[] = {{JP_Q16(4), 0}, {JP_Q16(4), JP_Q16(4)}};
    const int32_t to_clearance = JP_Q16(0.4142136);
    const jp_q24 least = 2 * config.model->half_track;

    for (int32_t more = -JP_Q24(0.01); more <= JP_Q24(0.01); more += JP_Q24(0.02)) {
        config.corner = jp_multiply_shift(least + more, to_clearance, 16);
        lay_and_plan(targets, 2);
        TEST_ASSERT_EQUAL(more > 0, pieces[1].bend != 0);
        if (more > 0) {
            TEST_ASSERT_INT32_WITHIN(JP_Q24(0.02), JP_Q24_ONE, jp_q24_multiply(pieces[1].bend, least));
        }
    }
}

/** A line, an arc by half a turn of radius 1 m, and a line, whose speeds are set by hand. */
static void lay_an_arc(const struct jp_piece_speed *before, const struct jp_piece_speed *on)
{
    const struct jp_piece_speed after = {
        .cruise = JP_Q24(0.2), .acceleration = JP_Q24(0.04), .brake_from = JP_Q24(0.5)};

    run = (struct jp_skid_run){.path = {pieces, PLACES, 3, {{0, JP_Q16(2)}, JP_ANGLE_DEGREES(180)}}};
    pieces[0] =
        (struct jp_path_piece){.begin = {JP_Q16(-1), 0}, .length = JP_Q24(1), .kind = JP_PIECE_CURVE, .speed = *before};
    pieces[1] =
        (struct jp_path_piece){.length = JP_Q24(3.14159265), .bend = JP_Q24(1), .kind = JP_PIECE_CURVE, .speed = *on};
    pieces[2] = (struct jp_path_piece){.begin = {0, JP_Q16(2)},
                                       .heading = JP_ANGLE_DEGREES(180),
                                       .length = JP_Q24(1),
                                       .kind = JP_PIECE_CURVE,
                                       .speed = after};
    run.path.end.position.x = JP_Q16(-1);
    run.rounded = 3;
    run.paced = 3;
}

/* Half of it is not enough to reach the cruise, 0.5 m/s from 0.2 m/s at 0.04 m/s². */
static void test_an_arc_that_speeds_up_beyond_its_middle(void)
{
    const struct jp_piece_speed before = {
        .cruise = JP_Q24(0.2), .end = JP_Q24(0.2), .acceleration = JP_Q24(0.04), .brake_from = JP_Q24(1)};
    const struct jp_piece_speed on = {
        .cruise = JP_Q24(0.5), .end = JP_Q24(0.5), .acceleration = JP_Q24(0.04), .brake_from = JP_Q24(3.14159265)};

    lay_an_arc(&before, &on);
    pieces[2].speed = (struct jp_piece_speed){.cruise = JP_Q24(0.5), .acceleration = JP_Q24(0.125)};
    halve_and_expect_the_same();
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(0.4073), pieces[1].speed.end); /* √(0.2² + 2 · 0.04 · π/2) */
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(1), pieces[2].begin.x);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(1), pieces[2].begin.y);
    TEST_ASSERT_INT32_WITHIN((int32_t)JP_ANGLE_DEGREES(0.1), 0, (int32_t)(pieces[2].heading - JP_ANGLE_DEGREES(90)));
}

/* From 0.5 m/s to 0.2 m/s over the last 2.625 m of it. */
static void test_an_arc_that_brakes_before_its_middle(void)
{
    const struct jp_piece_speed before = {
        .cruise = JP_Q24(0.5), .end = JP_Q24(0.5), .acceleration = JP_Q24(0.125), .brake_from = JP_Q24(1)};
    const struct jp_piece_speed on = {
        .cruise = JP_Q24(0.5), .end = JP_Q24(0.2), .acceleration = JP_Q24(0.04), .brake_from = JP_Q24(0.51659265)};

    lay_an_arc(&before, &on);
    halve_and_expect_the_same();
    TEST_ASSERT_EQUAL_INT32(on.brake_from, pieces[1].speed.brake_from);
    TEST_ASSERT_EQUAL_INT32(0, pieces[2].speed.brake_from);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(0.4070), pieces[1].speed.end); /* √(0.2² + 2 · 0.04 · π/2) */
}

static void test_legs_meet_in_the_middle_of_arcs(void)
{
    static const struct jp_point targets[] = {{JP_Q16(4), 0}, {JP_Q16(4), JP_Q16(4)}, {JP_Q16(8), JP_Q16(4)}};
    static const uint16_t ends[] = {2, 5, 7};
    struct jp_skid_leg leg = {.end = 0};

    lay_and_plan(targets, 3);
    halve_and_expect_the_same();
    for (unsigned i = 0; i < 3; i++) {
        const uint16_t begin = leg.end;

        TEST_ASSERT_TRUE(jp_skid_run_next_leg(&run, &leg));
        TEST_ASSERT_EQUAL_UINT16(begin, leg.begin);
        TEST_ASSERT_EQUAL_UINT16(ends[i], leg.end);
        TEST_ASSERT_EQUAL_INT32(i == 0 ? 0 : pieces[begin - 1U].speed.end, leg.speed);
    }
    TEST_ASSERT_FALSE(jp_skid_run_next_leg(&run, &leg));
    TEST_ASSERT_EQUAL_UINT16(7, leg.end);
}

/** A valley, 4 cm deep for each metre from x = 1 m. */
static jp_q16 valley(const void *context, const struct jp_point *point)
{
    const jp_q16 off = point->x - JP_Q16(1);

    (void)context;
    return (off < 0 ? -off : off) / 25;
}

/* Lines are several pieces there, and one leg each; halves of arcs find room. */
static void test_legs_over_a_valley(void)
{
    static const struct jp_point targets[] = {{JP_Q16(2), 0}, {JP_Q16(2), JP_Q16(2)}};
    static const struct jp_ground ground = {valley, NULL, NULL, JP_Q16(0.2), 0};
    const struct jp_line_route route = {.targets = targets, .count = 2, .ground = &ground};
    struct jp_skid_leg leg = {.end = 0};
    unsigned legs = 0;
    jp_q16 rise = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_run_lay(&run, &config, &route, 0));
    while (jp_skid_run_plan(&run, &config, config.model)) {
    }
    TEST_ASSERT_EQUAL_UINT16(PLACES, run.path.places);
    TEST_ASSERT_GREATER_THAN_UINT16(4, run.path.count);
    TEST_ASSERT_TRUE(pieces[1].is_joined);
    while (jp_skid_run_next_leg(&run, &leg)) {
        legs++;
    }
    TEST_ASSERT_EQUAL_UINT(2, legs);
    for (unsigned i = 0; i < run.path.count; i++) {
        rise += pieces[i].rise;
    }
    TEST_ASSERT_INT32_WITHIN(run.path.count, 0, rise);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), -(pieces[0].length >> 8) / 25, pieces[0].rise);
}

/* ---- Grounds ---- */

static jp_q16 level_at(const void *context, const struct jp_point *point)
{
    (void)context;
    (void)point;
    return 0;
}

/* Beyond 1 m; of a class that the robot does not know beyond 1.8 m. */
static uint8_t mud_at(const void *context, const struct jp_point *point)
{
    const uint8_t mud = point->x > JP_Q16(1) ? 2 : 0;

    (void)context;
    return point->x > JP_Q16(1.8) ? (uint8_t)JP_GROUND_CLASSES : mud;
}

static void test_a_leg_by_the_ground_of_its_pieces(void)
{
    static const struct jp_point target = {JP_Q16(2), 0};
    static const struct jp_ground ground = {level_at, mud_at, NULL, JP_Q16(0.1), 0};
    const struct jp_line_route route = {.targets = &target, .count = 1, .ground = &ground};
    struct jp_skid_learner robot;
    struct jp_skid_grounds grounds;
    const struct jp_skid_knowledge alike = {&robot, NULL};
    const struct jp_skid_knowledge known = {&robot, &grounds};
    struct jp_skid_ground_drive drive = {.on = {{.energy = 0}}};
    struct jp_skid_ground_drive other = drive;
    struct jp_skid_leg leg = {.end = 0};
    jp_q16 duration = 0;

    jp_skid_learner_start(&robot, &jp_skid_learning_zhang2018, config.model);
    jp_skid_grounds_start(&grounds, &jp_ground_learning, &robot);
    grounds.models[2].rolling = 2 * robot.model.rolling;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_run_lay(&run, &config, &route, 0));
    while (jp_skid_run_plan(&run, &config, config.model)) {
    }
    TEST_ASSERT_TRUE(jp_skid_run_next_leg(&run, &leg));
    jp_skid_run_leg_energy(&run, &leg, &alike, &drive, &duration);
    jp_skid_run_leg_energy(&run, &leg, &known, &other, &duration);
    TEST_ASSERT_TRUE(drive.on[0].energy > 0 && drive.on[2].energy > 0);
    TEST_ASSERT_TRUE(drive.on[1].energy == 0 && drive.on[3].energy == 0);
    TEST_ASSERT_TRUE(other.on[0].energy == drive.on[0].energy);
    TEST_ASSERT_TRUE(other.on[2].energy > drive.on[2].energy + drive.on[2].energy / 4);
}

/* To the left of the x axis. */
static uint8_t mud_to_the_left(const void *context, const struct jp_point *point)
{
    (void)context;
    return point->y > 0 ? 1 : 0;
}

static void test_each_side_is_on_its_own_ground(void)
{
    static const struct jp_point target = {JP_Q16(2), 0};
    static const struct jp_ground ground = {level_at, mud_to_the_left, NULL, JP_Q16(0.5), JP_Q16(0.1)};
    struct jp_line_route route = {.targets = &target, .count = 1, .ground = &ground, .half_track = JP_Q16(0.3)};
    struct jp_skid_learner robot;
    const struct jp_skid_knowledge alike = {&robot, NULL};
    struct jp_skid_ground_drive drive = {.at_edges = 0};
    struct jp_skid_leg leg = {.end = 0};
    jp_q16 duration = 0;

    jp_skid_learner_start(&robot, &jp_skid_learning_zhang2018, config.model);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_run_lay(&run, &config, &route, 0));
    while (jp_skid_run_plan(&run, &config, config.model)) {
    }
    TEST_ASSERT_TRUE(jp_skid_run_next_leg(&run, &leg));
    jp_skid_run_leg_energy(&run, &leg, &alike, &drive, &duration);
    TEST_ASSERT_TRUE(drive.on[0].energy > 0 && drive.on[0].energy == drive.on[1].energy && drive.at_edges == 0);
    /* Within the margin of the edge. */
    route.half_track = JP_Q16(0.05);
    drive = (struct jp_skid_ground_drive){.at_edges = 0};
    leg = (struct jp_skid_leg){.end = 0};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_run_lay(&run, &config, &route, 0));
    while (jp_skid_run_plan(&run, &config, config.model)) {
    }
    TEST_ASSERT_TRUE(jp_skid_run_next_leg(&run, &leg));
    jp_skid_run_leg_energy(&run, &leg, &alike, &drive, &duration);
    TEST_ASSERT_TRUE(drive.at_edges > 0);
}
