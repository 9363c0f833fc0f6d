/* Speeds along a path: limits, the cheapest speed, passes, blends and what it takes. */
#include <joulepath/path_speed.h>
#include <stddef.h>

#include "tests/support/config_check.h"
#include "tests/target/random.h"
#include "unity.h"

enum { PLACES = 4 };

static struct jp_path_limits config;
static const struct jp_path_limits usual = {
    .speed = JP_Q24(1),
    .turn_rate = JP_Q24(2),
    .side_speed = JP_Q24(1.5),
    .width = JP_Q24(0.5),
    .acceleration = JP_Q24(0.5),
    .turn_acceleration = JP_Q24(4),
};

DEFINE_EXPECT_CONFIG_OF(jp_path_limits_check, usual)

static struct jp_path_piece pieces[PLACES];
static struct jp_lattice_path path;
static struct jp_path_cost cost;

/* W by m/s and by (m/s)²; of a turn on the spot by rad/s. */
struct model {
    jp_q16 still;
    jp_q16 linear;
    jp_q16 quadratic;
    jp_q16 turning;
    jp_q16 climbing; /* by a grade of 1 */
};

static struct model model;

static jp_q16 power(const void *context, const struct jp_motion *motion, jp_q24 grade)
{
    const struct model *of = context;
    const jp_q24 w = motion->turn_rate < 0 ? -motion->turn_rate : motion->turn_rate;

    return of->still + jp_multiply_shift(of->linear, motion->speed, 24) +
           jp_multiply_shift(of->quadratic, jp_q24_multiply(motion->speed, motion->speed), 24) +
           jp_multiply_shift(of->turning, w, 24) + jp_multiply_shift(of->climbing, grade, 24);
}

static struct jp_motion_price price = {.power = power, .model = &model};

void setUp(void)
{
    config = usual;
    model = (struct model){.still = JP_Q16(1)};
    price.time = price.gain = price.recovery = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_path_start(&path, pieces, PLACES));
}

void tearDown(void)
{
}

static struct jp_path_piece *add(enum jp_piece_kind kind, double length, double bend, double bend_rate)
{
    struct jp_path_piece *piece = &pieces[path.count];

    *piece = (struct jp_path_piece){
        .kind = kind, .length = JP_Q24(length), .bend = JP_Q24(bend), .bend_rate = JP_Q16(bend_rate)};
    path.count++;
    return piece;
}

static void plan(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_plan_speeds(&path, &config, &price, &cost));
}

static void expect_speed(double expected, jp_q24 speed)
{
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0001), JP_Q24(expected), speed);
}

static void test_limits(void)
{
    RANGE("", speed, JP_Q24(0.01), JP_Q24(8));
    RANGE("", turn_rate, JP_Q24(0.01), JP_Q24(8));
    RANGE("", side_speed, JP_Q24(0.01), JP_Q24(16));
    RANGE("", width, JP_Q24(0.05), JP_Q24(4));
    RANGE("", acceleration, JP_Q24(0.01), JP_Q24(16));
    RANGE("", turn_acceleration, JP_Q24(0.01), JP_Q24(64));
}

static void expect_refused(struct jp_lattice_path *of, const struct jp_path_limits *limits,
                           const struct jp_motion_price *by, struct jp_path_cost *takes)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_path_plan_speeds(of, limits, by, takes));
}

static void test_refuses(void)
{
    struct jp_motion_price without = price;

    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_path_plan_speeds(&path, &config, &price, &cost));
    (void)add(JP_PIECE_CURVE, 1, 0, 0);
    without.power = NULL;
    expect_refused(NULL, &config, &price, &cost);
    expect_refused(&path, NULL, &price, &cost);
    expect_refused(&path, &config, NULL, &cost);
    expect_refused(&path, &config, &price, NULL);
    expect_refused(&path, &config, &without, &cost);
    price.time = -1;
    expect_refused(&path, &config, &price, &cost);
    price.time = JP_Q16(16384) + 1;
    expect_refused(&path, &config, &price, &cost);
    price.time = 0;
    price.gain = -1;
    expect_refused(&path, &config, &price, &cost);
    price.gain = 0;
    price.recovery = JP_Q16(16384) + 1;
    expect_refused(&path, &config, &price, &cost);
}

/* 1 m/s costs 9 J, and 4 J of it come back; turns on the spot cost nothing of the kind. */
static void test_changes_of_the_speed(void)
{
    (void)add(JP_PIECE_CURVE, 5, 0, 0);
    price.gain = JP_Q16(9);
    price.recovery = JP_Q16(4);
    plan();
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(7 + 9 - 4), cost.energy);
    pieces[0].kind = JP_PIECE_TURN_LEFT;
    pieces[0].length = JP_Q24(3);
    plan();
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(2), cost.energy);
}

/* 0.5 m/s² to 1 m/s takes 1 m and 2 s. */
static void test_straight_line(void)
{
    const struct jp_path_piece *line = add(JP_PIECE_CURVE, 5, 0, 0);

    plan();
    expect_speed(1, line->speed.cruise);
    expect_speed(0, line->speed.end);
    expect_speed(0.5, line->speed.acceleration);
    expect_speed(4, line->speed.brake_from);
    TEST_ASSERT_EQUAL_INT32(0, line->speed.blend);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(7), cost.duration);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(7), cost.energy);
}

/* Half of it up, half of it down. */
static void test_line_too_short_for_its_cruise(void)
{
    const struct jp_path_piece *line = add(JP_PIECE_CURVE, 0.5, 0, 0);

    plan();
    expect_speed(0.5, line->speed.cruise);
    expect_speed(0.25, line->speed.brake_from);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(2), cost.duration);
}

/* 1 W and 4 W by the square of the speed: a metre costs least at 0.5 m/s, and with 3 W for a second at 1 m/s. */
static void test_cheapest_speed(void)
{
    const struct jp_path_piece *line = add(JP_PIECE_CURVE, 5, 0, 0);

    model.quadratic = JP_Q16(4);
    plan();
    expect_speed(0.5, line->speed.cruise);
    price.time = JP_Q16(3);
    plan();
    expect_speed(1, line->speed.cruise);
    model.quadratic = JP_Q16(16);
    plan();
    expect_speed(0.5, line->speed.cruise);
}

/* What comes back where it leads down is the more the slower, and the slope is the piece's. */
static void test_grade(void)
{
    struct jp_path_piece *line = add(JP_PIECE_CURVE, 5, 0, 0);

    model.climbing = JP_Q16(10);
    line->rise = JP_Q16(1);
    plan();
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), JP_Q16(7 * 3), cost.energy);
    line->rise = JP_Q16(-50);
    plan();
    TEST_ASSERT_TRUE(cost.energy < 0);
}

/* A curve of 4/m: 2 rad/s at 0.5 m/s; the outer side at twice its speed. */
static void test_speed_by_the_turn_rate(void)
{
    const struct jp_path_piece *arc = add(JP_PIECE_CURVE, 5, -4, 0);

    plan();
    expect_speed(0.5, arc->speed.cruise);
    config.side_speed = JP_Q24(0.6);
    plan();
    expect_speed(0.3, arc->speed.cruise);
}

/* A quarter of 4 rad/s² is 4/m² at 0.5 m/s, and 0.5 m/s² at 2/m. */
static void test_speed_and_acceleration_by_the_turn_acceleration(void)
{
    const struct jp_path_piece *curve = add(JP_PIECE_CURVE, 1, -2, 4);

    plan();
    expect_speed(0.5, curve->speed.cruise);
    expect_speed(0.5, curve->speed.acceleration);
    pieces[0].bend = JP_Q24(0);
    plan();
    expect_speed(0.25, curve->speed.acceleration);
}

/* Its power is that of the mean turn rate, here 1 rad/s by 1 m/s. */
static void test_power_along_a_curve(void)
{
    (void)add(JP_PIECE_CURVE, 2, 0.5, 0.5);
    model = (struct model){.turning = JP_Q16(6)};
    config.acceleration = JP_Q24(16);
    config.turn_acceleration = JP_Q24(64);
    plan();
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.1), JP_Q16(12), cost.energy);
}

static void expect_turn(enum jp_piece_kind kind)
{
    const struct jp_path_piece *turn = add(kind, 3, 0, 0);

    model.turning = JP_Q16(1);
    plan();
    expect_speed(2, turn->speed.cruise);
    expect_speed(0, turn->speed.end);
    expect_speed(4, turn->speed.acceleration);
    expect_speed(2.5, turn->speed.brake_from);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(2), cost.duration);
}

static void test_turn_to_the_left(void)
{
    expect_turn(JP_PIECE_TURN_LEFT);
}

static void test_turn_to_the_right(void)
{
    expect_turn(JP_PIECE_TURN_RIGHT);
}

/* 0.25 m/s of the sides at half of 0.5 m. */
static void test_turn_rate_by_the_sides(void)
{
    const struct jp_path_piece *turn = add(JP_PIECE_TURN_LEFT, 3, 0, 0);

    config.side_speed = JP_Q24(0.25);
    plan();
    expect_speed(1, turn->speed.cruise);
}

static void test_it_stops_before_and_after_a_turn(void)
{
    (void)add(JP_PIECE_CURVE, 2, 0, 0);
    (void)add(JP_PIECE_TURN_LEFT, 1, 0, 0);
    (void)add(JP_PIECE_CURVE, 2, 0, 0);
    plan();
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT32(0, pieces[i].speed.end);
        TEST_ASSERT_EQUAL_INT32(0, pieces[i].speed.blend);
    }
}

/* From 1 m/s to an arc at 0.5 m/s and on: 0.75 m of braking, and no more than that again. */
static void test_passes(void)
{
    (void)add(JP_PIECE_CURVE, 5, 0, 0);
    (void)add(JP_PIECE_CURVE, 1, 4, 0);
    (void)add(JP_PIECE_CURVE, 0.2, 0, 0);
    config.turn_acceleration = JP_Q24(64);
    plan();
    expect_speed(0.5, pieces[0].speed.end);
    expect_speed(4.25, pieces[0].speed.brake_from);
    expect_speed(0.4472136, pieces[1].speed.end); /* to a stop over 0.2 m */
    expect_speed(0.5, pieces[1].speed.cruise);
    expect_speed(0, pieces[2].speed.end);
    expect_speed(0, pieces[2].speed.brake_from);
    expect_speed(0.4472136, pieces[2].speed.cruise);
}

/* The first piece is so short that the robot cannot be faster at its end. */
static void test_pass_from_the_begin(void)
{
    (void)add(JP_PIECE_CURVE, 0.25, 0, 0);
    (void)add(JP_PIECE_CURVE, 5, 0, 0);
    plan();
    expect_speed(0.5, pieces[0].speed.end);
    expect_speed(1, pieces[1].speed.cruise);
}

/* A jump by 2/m: at 0.5 m/s it takes 0.25 m on either side of the joint. */
static void test_blend_of_a_jump_of_the_curvature(void)
{
    (void)add(JP_PIECE_CURVE, 2, 2, 0);
    (void)add(JP_PIECE_CURVE, 2, 4, 0);
    plan();
    expect_speed(0.5, pieces[0].speed.end);
    expect_speed(0.25, pieces[1].speed.blend);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), JP_Q16(4), pieces[1].speed.blend_rate);
    pieces[0].bend = -JP_Q24(2);
    pieces[1].bend = -JP_Q24(4);
    plan();
    expect_speed(0.25, pieces[1].speed.blend);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), -JP_Q16(4), pieces[1].speed.blend_rate);
}

/* Half of 0.1 m: √(4 · 0.05/(2 · 4)) m/s. */
static void test_jump_in_little_room(void)
{
    (void)add(JP_PIECE_CURVE, 2, 0, 0);
    (void)add(JP_PIECE_CURVE, 0.1, 4, 0);
    config.acceleration = JP_Q24(16);
    config.turn_acceleration = JP_Q24(4);
    plan();
    expect_speed(0.1581139, pieces[0].speed.end);
    expect_speed(0.05, pieces[1].speed.blend);
}

static void test_time_beyond_the_format(void)
{
    for (int i = 0; i < PLACES; i++) {
        (void)add(JP_PIECE_CURVE, 64, 0, 0);
    }
    config.speed = JP_Q24(0.01);
    plan();
    model.still = JP_Q16(20000);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_path_plan_speeds(&path, &config, &price, &cost));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, cost.energy);
    config.turn_rate = JP_Q24(0.01);
    model.still = 0;
    pieces[0].bend = JP_Q24(100);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_path_plan_speeds(&path, &config, &price, &cost));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, cost.duration);
}

/* From a line onto an arc, fast to slow, in motion: what gains of speed take, less what losses give back. */
static void test_changes_of_the_speed_where_pieces_meet(void)
{
    const struct jp_path_piece *line = add(JP_PIECE_CURVE, 5, 0, 0);
    const struct jp_path_piece *arc = add(JP_PIECE_CURVE, 5, 4, 0);

    price.gain = JP_Q16(9);
    price.recovery = JP_Q16(4);
    plan();
    const double first = line->speed.cruise * 0x1p-24;
    const double meeting = line->speed.end * 0x1p-24;
    const double second = arc->speed.cruise * 0x1p-24;
    const double gained = first * first + second * second - meeting * meeting;

    TEST_ASSERT_TRUE(0.2 < meeting && meeting < 0.8 * first);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.002), JP_Q16((9 - 4) * gained), cost.energy - cost.duration);
}

/* What nothing but its speed costs is driven slowly, but driven. */
static void test_the_slowest_speed(void)
{
    const struct jp_path_piece *line = add(JP_PIECE_CURVE, 0.1, 0, 0);

    model = (struct model){.quadratic = JP_Q16(8000)};
    config.speed = JP_Q24(0.004);
    plan();
    TEST_ASSERT_INT32_WITHIN(1, JP_Q24(0.001), line->speed.cruise);
}

/* Where the robot stands, no curvature jumps, whatever a turn's piece says of it. */
static void test_a_turn_has_no_curvature_that_jumps(void)
{
    (void)add(JP_PIECE_TURN_LEFT, 1, 50, 0);
    (void)add(JP_PIECE_CURVE, 2, 0, 0);
    (void)add(JP_PIECE_CURVE, 2, 0.001, 0);
    (void)add(JP_PIECE_TURN_RIGHT, 1, 50, 0);
    plan();
    expect_speed(0.5, pieces[1].speed.acceleration);
    expect_speed(0.5, pieces[2].speed.acceleration);
}

/* ---- Of any path ---- */

static uint32_t state = 9;

static double random_between(double low, double high)
{
    return low + (high - low) * (double)(target_random(&state) >> 8) * 0x1p-24;
}

static double of_q24(jp_q24 value)
{
    return (double)value * 0x1p-24;
}

/* What a piece takes, and that its speeds are those of one who speeds up, keeps on and brakes. */
static double seconds_of(const struct jp_path_piece *piece, jp_q24 begin)
{
    const double length = of_q24(piece->length);
    const double first = of_q24(begin);
    const double cruise = of_q24(piece->speed.cruise);
    const double last = of_q24(piece->speed.end);
    const double twice = 2.0 * of_q24(piece->speed.acceleration);
    const double up = (cruise * cruise - first * first) / twice;
    const double down = (cruise * cruise - last * last) / twice;

    TEST_ASSERT_TRUE(first <= cruise + 1.0e-6 && last <= cruise + 1.0e-6);
    TEST_ASSERT_TRUE(up + down <= length + 1.0e-4);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(1.0e-4), JP_Q24(length - down), piece->speed.brake_from);
    return 2.0 * (cruise - first + cruise - last) / twice + (length - up - down) / cruise;
}

/* Of power that rises with speed alone each metre takes the same, and each second; of kinetic energy what is gained is
 * paid for, and some of it comes back. */
static void expect_cost(void)
{
    double seconds = 0.0;
    double metres = 0.0;
    double radians = 0.0;
    double gained = 0.0;
    double lost = 0.0;
    jp_q24 begin = 0;

    plan();
    for (unsigned i = 0; i < path.count; i++) {
        const double cruise = of_q24(pieces[i].speed.cruise);
        const double first = of_q24(begin);
        const double last = of_q24(pieces[i].speed.end);

        seconds += seconds_of(&pieces[i], begin);
        if (pieces[i].kind == JP_PIECE_CURVE) {
            metres += of_q24(pieces[i].length);
            gained += cruise * cruise - first * first;
            lost += cruise * cruise - last * last;
        } else {
            radians += of_q24(pieces[i].length);
        }
        begin = pieces[i].speed.end;
    }
    TEST_ASSERT_EQUAL_INT32(0, begin);
    TEST_ASSERT_INT32_WITHIN(64, JP_Q16(seconds), cost.duration);
    TEST_ASSERT_INT32_WITHIN(400, JP_Q16(7.0 * seconds + 3.0 * metres + 2.0 * radians + 5.0 * gained - 4.0 * lost),
                             cost.energy);
}

static void test_cost_of_random_paths(void)
{
    for (unsigned run = 0; run < 60U; run++) {
        setUp();
        model = (struct model){.still = JP_Q16(7), .linear = JP_Q16(3), .turning = JP_Q16(2)};
        price.gain = JP_Q16(5);
        price.recovery = JP_Q16(4);
        price.time = (jp_q16)(run % 3U) * JP_Q16(20);
        config.acceleration = JP_Q24(random_between(0.1, 0.9));
        for (unsigned i = 0; i < 1U + run % PLACES; i++) {
            if (target_random(&state) % 4U == 0U) {
                (void)add(JP_PIECE_TURN_LEFT, random_between(0.3, 3.0), 0, 0);
            } else {
                (void)add(JP_PIECE_CURVE, random_between(0.2, 3.0), 0, 0);
            }
        }
        expect_cost();
    }
}

/* There and back the speeds are the same. */
static void test_a_path_backwards_takes_as_long(void)
{
    for (unsigned run = 0; run < 20U; run++) {
        struct jp_path_cost there;

        setUp();
        for (unsigned i = 0; i < PLACES; i++) {
            (void)add(JP_PIECE_CURVE, random_between(0.2, 2.0), random_between(-1.5, 1.5), 0);
        }
        plan();
        there = cost;
        for (unsigned i = 0; i < PLACES / 2U; i++) {
            const struct jp_path_piece piece = pieces[i];

            pieces[i] = pieces[PLACES - 1U - i];
            pieces[PLACES - 1U - i] = piece;
        }
        for (unsigned i = 0; i < PLACES; i++) {
            pieces[i].bend = -pieces[i].bend;
        }
        plan();
        TEST_ASSERT_INT32_WITHIN(64, there.duration, cost.duration);
        TEST_ASSERT_INT32_WITHIN(64, there.energy, cost.energy);
    }
}
