/* Set-points along a path, and the law that steers a robot back to them. */
#include <joulepath/path_drive.h>
#include <joulepath/path_speed.h>

#include "tests/support/config_check.h"
#include "unity.h"

enum { PLACES = 4, TICK_RATE = 750, RATE = 250, SET_POINTS_MAX = 20000 };

static const struct jp_path_drive_config usual = {
    .tick_rate = TICK_RATE,
    .way = JP_Q24(0.5),
    .pace = JP_Q24(2),
    .speed_correction = JP_Q24(0.25),
    .turn_correction = JP_Q24(0.5),
};
static const struct jp_path_limits limits = {
    .speed = JP_Q24(0.5),
    .turn_rate = JP_Q24(1),
    .side_speed = JP_Q24(1),
    .width = JP_Q24(0.5),
    .acceleration = JP_Q24(0.5),
    .turn_acceleration = JP_Q24(2),
};

static struct jp_path_drive_config config;
static struct jp_path_drive drive;
static struct jp_path_piece pieces[PLACES];
static struct jp_lattice_path path;
static struct jp_path_cost cost;
static struct jp_path_set_point at;

static enum jp_status check(const struct jp_path_drive_config *of, const char **field)
{
    return jp_path_drive_init(&drive, of, field);
}

DEFINE_EXPECT_CONFIG_OF(check, usual)

static void init(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_drive_init(&drive, &config, &field));
}

void setUp(void)
{
    config = usual;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_path_start(&path, pieces, PLACES));
    init();
}

void tearDown(void)
{
}

static jp_q16 power(const void *model, const struct jp_motion *motion, jp_q24 grade)
{
    (void)model;
    (void)motion;
    (void)grade;
    return JP_Q16(1);
}

/* After the last piece, which begins at (1, 2) m and looks along x. */
static void add(enum jp_piece_kind kind, double length, double bend, double bend_rate)
{
    struct jp_path_piece *piece = &pieces[path.count];

    *piece = (struct jp_path_piece){
        .kind = kind, .length = JP_Q24(length), .bend = JP_Q24(bend), .bend_rate = JP_Q16(bend_rate)};
    if (path.count == 0U) {
        piece->begin = (struct jp_point){JP_Q16(1), JP_Q16(2)};
    } else {
        piece->begin = path.end.position;
        piece->heading = path.end.heading;
    }
    path.end.heading = piece->heading + jp_angle_from_radians(jp_piece_turned(piece, piece->length));
    path.end.position = piece->begin;
    path.count++;
}

/* A straight line along x. */
static void add_line(double length)
{
    add(JP_PIECE_CURVE, length, 0, 0);
    path.end.position.x += JP_Q16(length);
}

static void begin(void)
{
    const struct jp_motion_price price = {.power = power};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_plan_speeds(&path, &limits, &price, &cost));
    jp_path_drive_begin(&drive, &path);
}

/* Set-points until a piece is driven. */
static unsigned drive_piece(uint16_t piece)
{
    unsigned count = 0;

    while (count < SET_POINTS_MAX && jp_path_drive_piece(&drive) == piece && jp_path_drive_advance(&drive, &at)) {
        count++;
    }
    return count;
}

static void skip(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        TEST_ASSERT_TRUE(jp_path_drive_advance(&drive, &at));
    }
}

static void expect_near(double expected, jp_q24 value)
{
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(expected), value);
}

static void expect_point(double x, double y)
{
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(x), at.pose.position.x);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(y), at.pose.position.y);
}

static void test_config(void)
{
    RANGE("path_drive.", tick_rate, 100, 10000);
    RANGE("path_drive.", way, JP_Q24(0.01), JP_Q24(8));
    RANGE("path_drive.", pace, 0, JP_Q24(64));
    RANGE("path_drive.", speed_correction, 0, JP_Q24(8));
    RANGE("path_drive.", turn_correction, 0, JP_Q24(8));
}

static void test_init_wants_a_drive(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_path_drive_init(NULL, &config, &field));
}

static void test_nothing_to_drive(void)
{
    TEST_ASSERT_FALSE(jp_path_drive_advance(&drive, &at));
    jp_path_drive_begin(&drive, &path);
    TEST_ASSERT_FALSE(jp_path_drive_advance(&drive, &at));
}

/* 0.5 m/s² up to 0.5 m/s, 1 s and 0.25 m; 2 s on; down. */
static void test_straight_line(void)
{
    add_line(1.5);
    begin();
    skip(RATE / 2);
    expect_point(1.0625, 2);
    expect_near(0.25, at.motion.speed);
    expect_near(0.5, at.acceleration);
    skip(RATE);
    expect_point(1.5, 2);
    expect_near(0.5, at.motion.speed);
    TEST_ASSERT_EQUAL_INT32(0, at.acceleration);
    skip(2 * RATE);
    expect_point(1 + 1.5 - 0.0625, 2);
    expect_near(0.25, at.motion.speed);
    expect_near(-0.5, at.acceleration);
    TEST_ASSERT_UINT32_WITHIN(2, RATE / 2, drive_piece(0));
    TEST_ASSERT_EQUAL_INT32(path.end.position.x, at.pose.position.x);
    TEST_ASSERT_EQUAL_INT32(0, at.motion.speed);
    TEST_ASSERT_EQUAL_INT32(0, at.acceleration);
    TEST_ASSERT_EQUAL_UINT(1, jp_path_drive_piece(&drive));
    TEST_ASSERT_FALSE(jp_path_drive_advance(&drive, &at));
}

static void expect_turn(enum jp_piece_kind kind, int32_t sign)
{
    add(kind, 1.5, 0, 0);
    begin();
    skip(RATE / 5);
    expect_point(1, 2);
    TEST_ASSERT_EQUAL_INT32(0, at.motion.speed);
    TEST_ASSERT_EQUAL_INT32(0, at.acceleration);
    expect_near(0.4, sign * at.motion.turn_rate);
    expect_near(2, sign * at.turn_acceleration);
    expect_near(0.04, sign * jp_angle_to_radians(at.pose.heading));
    TEST_ASSERT_UINT32_WITHIN(2, 2 * RATE - RATE / 5, drive_piece(0));
    TEST_ASSERT_EQUAL_UINT32(path.end.heading, at.pose.heading);
    TEST_ASSERT_EQUAL_INT32(0, at.motion.turn_rate);
    TEST_ASSERT_EQUAL_INT32(0, at.turn_acceleration);
}

static void test_turn_to_the_left(void)
{
    expect_turn(JP_PIECE_TURN_LEFT, 1);
}

static void test_turn_to_the_right(void)
{
    expect_turn(JP_PIECE_TURN_RIGHT, -1);
}

/* Half a circle of 1 m. */
static void test_arc(void)
{
    add(JP_PIECE_CURVE, 3.1415927, 1, 0);
    path.end.position = (struct jp_point){JP_Q16(1), JP_Q16(4)};
    begin();
    skip(RATE / 2);
    expect_near(at.motion.speed / 16777216.0, at.motion.turn_rate);
    expect_near(0.5, at.turn_acceleration);
    (void)drive_piece(0);
    expect_point(1, 4);
}

/* The last set-point before the end is where the curve leads. */
static void test_curve_leads_to_its_end(void)
{
    struct jp_path_set_point before = {.cosine = 0};
    unsigned count = 0;

    add(JP_PIECE_CURVE, 1.5707963, 1, 0);
    path.end.position = (struct jp_point){JP_Q16(2), JP_Q16(3)};
    begin();
    while (jp_path_drive_piece(&drive) == 0U && count < SET_POINTS_MAX) {
        before = at;
        skip(1);
        count++;
    }
    at = before;
    expect_point(2, 3);
}

static void test_changing_curvature(void)
{
    add(JP_PIECE_CURVE, 2, 0, 0.5);
    begin();
    skip(RATE);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), jp_q24_multiply(jp_piece_bend(&pieces[0], JP_Q24(0.25)), JP_Q24(0.5)),
                             at.motion.turn_rate);
    skip(RATE / 4);
    expect_near(0.5 * 0.25, at.turn_acceleration); /* κ' v² */
}

/* A jump from 0 to 1/m at 0.5 m/s takes 0.25 m to either side; in the middle it is 1/2. */
static void test_jump_of_the_curvature(void)
{
    jp_turns_per_s last = 0;

    add_line(2);
    add(JP_PIECE_CURVE, 2, 1, 0);
    begin();
    while (jp_path_drive_piece(&drive) < 2U && jp_path_drive_advance(&drive, &at)) {
        TEST_ASSERT_INT32_WITHIN(JP_Q24(2.01) / RATE, last, at.motion.turn_rate);
        last = at.motion.turn_rate;
        if (jp_path_drive_piece(&drive) < 2U && at.pose.position.x > JP_Q16(2.999) &&
            at.pose.position.x < JP_Q16(3.001)) {
            TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.25), at.motion.turn_rate);
            TEST_ASSERT_INT32_WITHIN(JP_Q24(0.01), JP_Q24(0.5), at.turn_acceleration);
        }
    }
    TEST_ASSERT_EQUAL_INT32(0, at.motion.turn_rate);
}

/* What a step leads beyond a piece's end it does on the next. */
static void test_pieces_follow_without_a_gap(void)
{
    jp_q16 last = JP_Q16(1);

    add_line(0.7);
    add_line(0.6);
    begin();
    while (jp_path_drive_piece(&drive) < 2U && jp_path_drive_advance(&drive, &at)) {
        TEST_ASSERT_TRUE(at.pose.position.x >= last);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.0002), (at.motion.speed / RATE) >> 8, at.pose.position.x - last);
        last = at.pose.position.x;
    }
    TEST_ASSERT_EQUAL_INT32(path.end.position.x, at.pose.position.x);
}

static void test_turns_follow_lines(void)
{
    add_line(0.5);
    add(JP_PIECE_TURN_LEFT, 0.5, 0, 0);
    add(JP_PIECE_CURVE, 0.5, 0, 0);
    begin();
    (void)drive_piece(0);
    TEST_ASSERT_EQUAL_INT32(pieces[1].begin.x, at.pose.position.x);
    TEST_ASSERT_EQUAL_INT32(0, at.motion.speed);
    (void)drive_piece(1);
    TEST_ASSERT_EQUAL_UINT32(pieces[2].heading, at.pose.heading);
    TEST_ASSERT_EQUAL_INT32(0, at.motion.turn_rate);
    (void)drive_piece(2);
    TEST_ASSERT_EQUAL_UINT(3, jp_path_drive_piece(&drive));
}

/* ---- The law ---- */

static struct jp_motion track(double x, double y, double radians)
{
    struct jp_path_pose pose = at.pose;
    struct jp_motion motion;

    pose.position.x += JP_Q16(x);
    pose.position.y += JP_Q16(y);
    pose.heading += jp_angle_from_radians(JP_Q24(radians));
    jp_path_drive_track(&drive, &at, &pose, &motion);
    return motion;
}

/* On a line, at (1, 2) m along x or y with 0.5 m/s and 0.1 rad/s. */
static void set_point(bool along_y)
{
    if (path.count == 0U) {
        add_line(4);
    }
    begin();
    at = (struct jp_path_set_point){
        .pose = {{JP_Q16(1), JP_Q16(2)}, along_y ? JP_ANGLE_DEGREES(90) : 0},
        .cosine = along_y ? 0 : JP_Q31_MAX,
        .sine = along_y ? JP_Q31_MAX : 0,
        .motion = {JP_Q24(0.5), JP_Q24(0.1)},
    };
}

static void expect_motion(double speed, double turn_rate, struct jp_motion motion)
{
    expect_near(speed, motion.speed);
    expect_near(turn_rate, motion.turn_rate);
}

static void test_on_the_path(void)
{
    set_point(false);
    expect_motion(0.5, 0.1, track(0, 0, 0));
}

/* 2/s of what it is ahead; at 0.5 m/s and 0.5 m 1/s of the side by the way, and 2/s of the turn. */
static void test_back_to_the_path(void)
{
    set_point(false);
    expect_motion(0.5 - 0.1, 0.1, track(0.05, 0, 0));
    expect_motion(0.5 + 0.1, 0.1, track(-0.05, 0, 0));
    expect_motion(0.5, 0.1 - 0.1, track(0, 0.05, 0));
    expect_motion(0.5, 0.1 + 0.1, track(0, -0.05, 0));
    expect_motion(0.5, 0.1 - 0.2, track(0, 0, 0.1));
    expect_motion(0.5, 0.1 + 0.2, track(0, 0, -0.1));
    set_point(true);
    expect_motion(0.5 - 0.1, 0.1, track(0, 0.05, 0));
    expect_motion(0.5, 0.1 - 0.1, track(-0.05, 0, 0));
}

static void test_corrections_are_bounded(void)
{
    set_point(false);
    expect_motion(0.25, -0.4, track(30, 30, 3));
    expect_motion(0.75, 0.6, track(-3000, -3000, -3));
}

/* ---- Slopes ---- */

/* A grade of 0.2 to the left: 0.2 m to the right a radian, and 0.02 a metre. */
static const struct jp_path_slide aside = {
    .left = JP_Q24(0.2), .by_turn = JP_Q24(1), .most = JP_Q24(0.25), .by_way = JP_Q24(0.1), .per_most = JP_Q24(4)};

/* Of a radian, treads yield so far of what a slope asks of them. */
#define YIELDING 0.8

/* All pieces within twice the way, 1 m, and what it leans. */
static void look_ahead(const struct jp_path_slide *slide)
{
    for (int i = 0; i < 8; i++) {
        jp_path_drive_look_ahead(&drive, slide);
    }
}

/* At rest at the set-point: what it makes up for before, m to the left, is aimed at, at 2/s over twice 0.5 m, and what
 * it leans to the left, rad, at 2/s. */
static void expect_lead_and_lean(double lead, double lean, const struct jp_path_slide *slide)
{
    look_ahead(slide);
    at.motion = (struct jp_motion){0, 0};
    expect_motion(0, 2 * lead + 2 * lean, track(0, 0, 0));
}

static void expect_lean(double lean, const struct jp_path_slide *slide)
{
    expect_lead_and_lean(0, lean, slide);
}

static double progress(void)
{
    return drive.internal.progress / 16777216.0;
}

/* So far to the left of the set-point, at rest. */
static struct jp_motion track_left(double metres)
{
    at.motion = (struct jp_motion){0, 0};
    return track(-metres * at.sine / 2147483648.0, metres * at.cosine / 2147483648.0, 0);
}

/* To a place on the path, m or rad on its piece. */
static void drive_to(uint16_t piece, double way)
{
    while (jp_path_drive_piece(&drive) < piece || progress() < way) {
        skip(1);
    }
}

static void test_line_across_a_slope(void)
{
    add_line(0.6);
    add_line(0.6);
    begin();
    skip(1);
    expect_lean(0.02, &aside);
    drive_to(1, 0.3);
    expect_lean(0.02, &aside);
}

static void test_turn_on_the_spot_ahead(void)
{
    add_line(0.5);
    add(JP_PIECE_TURN_LEFT, 0.5, 0, 0);
    add(JP_PIECE_TURN_RIGHT, 0.25, 0, 0);
    add_line(0.5);
    begin();
    skip(1);
    expect_lead_and_lean(0.1 / (2 + 0.65 * 0.5) + 0.05 / (2 + 0.65 * 0.25), 0.02, &aside);
}

/* ---- Leaning against a slope ---- */

/* A bend that it slides out of: it turns about its front axle, a quarter of a metre ahead. */
static void test_leans_before_a_bend_uphill(void)
{
    add_line(1);
    add(JP_PIECE_CURVE, 1, 1, 0);
    begin();
    drive_to(0, 0.9);
    expect_lean(0.02 + YIELDING * 0.2 / 0.25 * (0.25 - (1 - progress())), &aside);
    drive_to(1, 0.5);
    expect_lean(0.02 + YIELDING * 0.2, &aside);
    drive_to(1, 0.9);
    expect_lean(0.02 + YIELDING * 0.2 / 0.25 * (1 - progress()), &aside);
}

/* A bend that it slides into: it turns about its rear axle, a quarter of a metre behind. */
static void test_leans_after_a_bend_downhill(void)
{
    add(JP_PIECE_CURVE, 1, -1, 0);
    add_line(1);
    begin();
    drive_to(0, 0.1);
    expect_lean(0.02 + YIELDING * 0.2 / 0.25 * progress(), &aside);
    drive_to(0, 0.5);
    expect_lean(0.02 + YIELDING * 0.2, &aside);
    drive_to(1, 0.1);
    expect_lean(0.02 + YIELDING * 0.2 / 0.25 * (0.25 - progress()), &aside);
    drive_to(1, 0.5);
    expect_lean(0.02, &aside);
}

/* No more than it may slide, and no farther than it aims. */
static void test_lean_is_limited(void)
{
    const struct jp_path_slide steep = {
        .left = JP_Q24(0.5), .by_turn = JP_Q24(1), .most = JP_Q24(0.25), .per_most = JP_Q24(4)};

    config.turn_correction = JP_Q24(2);
    init();
    add(JP_PIECE_CURVE, 1, 1, 0);
    add(JP_PIECE_CURVE, 1, 4, 0);
    begin();
    drive_to(0, 0.3);
    expect_lean(YIELDING * 0.25, &steep);
    drive_to(1, 0.5);
    look_ahead(&steep);
    expect_near(0.5, drive.internal.lean);
    expect_near(0.5, jp_q24_divide(track_left(-0.1).turn_rate, config.pace)); /* at 2/s, with what it aims */
}

/* Only what follows at once: not over a turn on the spot, nor beyond the next piece. */
static void test_leans_by_the_next_piece_at_most(void)
{
    add_line(1);
    add(JP_PIECE_CURVE, 0.1, 1, 0);
    add(JP_PIECE_CURVE, 0.1, -1, 0);
    add_line(1);
    begin();
    drive_to(0, 0.95);
    expect_lean(0.02 + YIELDING * 0.2 / 0.25 * 0.1, &aside);
    drive_to(3, 0.05);
    expect_lean(0.02 + YIELDING * 0.2 / 0.25 * 0.1, &aside);
}

/* Also where a longer one follows it, or is before it. */
static void test_leans_by_a_short_piece_between_longer_ones(void)
{
    add_line(1);
    add(JP_PIECE_CURVE, 0.1, 1, 0);
    add(JP_PIECE_CURVE, 0.15, -1, 0);
    add_line(1);
    begin();
    drive_to(0, 0.95);
    expect_lean(0.02 + YIELDING * 0.2 / 0.25 * 0.1, &aside);
    drive_to(3, 0.05);
    expect_lean(0.02 + YIELDING * 0.2 / 0.25 * 0.15, &aside);
}

/* What lies in memory behind the path is none of it. */
static void test_leans_by_nothing_beyond_the_path(void)
{
    add_line(1);
    add(JP_PIECE_CURVE, 0.1, 1, 0);
    begin();
    drive_to(1, 0.05);
    look_ahead(&aside);
    const jp_q24 lean = drive.internal.lean;

    for (unsigned i = 2; i < (unsigned)PLACES; i++) {
        pieces[i] = (struct jp_path_piece){.kind = JP_PIECE_CURVE, .length = JP_Q24(1), .bend = JP_Q24(3)};
    }
    look_ahead(&aside);
    TEST_ASSERT_EQUAL_INT32(lean, drive.internal.lean);
}

static void test_turn_on_the_spot_is_none_to_lean_by(void)
{
    add_line(1);
    add(JP_PIECE_TURN_LEFT, 0.5, 0, 0);
    add_line(1);
    begin();
    drive_to(0, 0.9);
    look_ahead(&aside);
    expect_near(0.02, drive.internal.lean);
    drive_to(1, 0.1);
    look_ahead(&aside);
    TEST_ASSERT_EQUAL_INT32(0, drive.internal.lean);
    drive_to(2, 0.1);
    look_ahead(&aside);
    expect_near(0.02, drive.internal.lean);
}

/* ---- Within a turn on the spot ---- */

/* At the begin of a turn by a radian, along which it slides 0.2 m to the right. */
static void turn(enum jp_piece_kind kind)
{
    path.count = 0;
    add(kind, 1, 0, 0);
    add_line(2);
    begin();
    skip(1);
    look_ahead(&aside);
    at.pose.heading = 0;
    at.cosine = JP_Q31_MAX;
    at.sine = 0;
}

/* How far ahead of its place it goes in the end, when it stays so far to the right of it, m. */
static void expect_move(double expected, enum jp_piece_kind kind, double right)
{
    turn(kind);
    for (int i = 0; i < 300; i++) {
        (void)track(0, -right, 0);
    }
    expect_near(expected, drive.internal.move);
}

/* e is (right + 0.2)/1.65: turning left it slides to the right and so moves back, and turning right ahead. */
static void test_counter_move(void)
{
    static const struct {
        double right;
        double move;
    } cases[] = {
        {0, 0.87 * 0.1212},
        {0.08, 0.87 * 0.1697},
        {0.12, 0.87 * 2 * (0.1939 - 0.12)},
        {-0.04, 0.87 * 0.0970},
        {-0.06, 0.87 * 2 * (0.0848 - 0.06)},
        {-0.08, 0}, /* it comes back by what it slides */
        {0.5, 0},   /* nothing helps */
        {127, 0},
        {-127, 0},
    };

    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        expect_move(-cases[i].move, JP_PIECE_TURN_LEFT, cases[i].right);
        expect_move(cases[i].move, JP_PIECE_TURN_RIGHT, cases[i].right);
    }
    turn(JP_PIECE_TURN_RIGHT);
    look_ahead(&(struct jp_path_slide){.left = JP_Q24(-0.2), .by_turn = JP_Q24(1), .most = JP_Q24(4)});
    for (int i = 0; i < 300; i++) {
        (void)track(0, -0.04, 0);
    }
    expect_near(-0.87 * 0.0970, drive.internal.move);
    turn(JP_PIECE_TURN_RIGHT);
    for (int i = 0; i < 300; i++) {
        (void)track(0, 0, 0);
    }
    expect_near(2 * 0.87 * 0.1212, track(0, 0, 0).speed);
}

/* Ten turns on the spot to the right, on ground as steep as it may be: what pushes it aside there is more than the
 * format holds. It slides to the left. */
static void test_counter_move_of_many_turns(void)
{
    const struct jp_path_slide steep = {.left = JP_Q24(1), .by_left = JP_Q24(8), .most = JP_Q24(4)};

    add(JP_PIECE_TURN_RIGHT, 63.9, 0, 0);
    begin();
    skip(1);
    look_ahead(&steep);
    TEST_ASSERT_TRUE(drive.internal.turn_slides > 0);
}

/* No faster than speeds may be corrected, and back to 0 where the turn ends. */
static void test_counter_move_is_slow_and_ends(void)
{
    turn(JP_PIECE_TURN_LEFT);
    const jp_q24 step = drive.internal.config.speed_correction / (jp_q24)(drive.internal.config.tick_rate / 3U);

    for (int i = 1; i < 5; i++) {
        (void)track(0, 0, 0);
        TEST_ASSERT_INT32_WITHIN(step / 8, -i * step, drive.internal.move);
    }
    (void)drive_piece(0);
    look_ahead(&aside);
    for (int i = 0; i < 400; i++) {
        (void)track(0, 0, 0);
    }
    TEST_ASSERT_EQUAL_INT32(0, drive.internal.move);
}

/* ---- Where it looks ---- */

/* Where it will have turned by a radian, the slope is the other one. */
static void test_slope_turns_with_the_robot(void)
{
    const struct jp_path_slide ahead = {.ahead = JP_Q24(0.2), .by_turn = JP_Q24(1), .most = JP_Q24(4)};

    add(JP_PIECE_CURVE, 0.5, 1, 0);
    add(JP_PIECE_TURN_LEFT, 0.5, 0, 0);
    begin();
    skip(1);
    /* to the left of where it looks it falls: 0.2 · 0.75 · 0.5 */
    expect_lead_and_lean(-0.075 / (2 + 0.65 * 0.5), 0, &ahead);
}

/* Load on the axles behind: a turn to the left pushes to the left, to the right to the right. */
static void test_centre_of_turn_behind_the_middle(void)
{
    const struct jp_path_slide ahead = {
        .ahead = JP_Q24(0.2), .by_left = JP_Q24(1), .most = JP_Q24(0.15), .per_most = JP_Q24(6.6666667)};

    add(JP_PIECE_CURVE, 1, 0.5, 0);
    begin();
    drive_to(0, 0.5);
    expect_lean(-YIELDING * 0.15 * 0.5, &ahead);
    setUp();
    add(JP_PIECE_CURVE, 1, -0.5, 0);
    begin();
    drive_to(0, 0.5);
    expect_lean(YIELDING * 0.15 * 0.5, &ahead);
}

/* In a turn it aims at what comes after it, more and more in its last radian. */
static void test_turn_leads_to_the_way_back(void)
{
    add(JP_PIECE_TURN_LEFT, 1.5, 0, 0);
    add_line(2);
    begin();
    skip(1);
    look_ahead(&aside);
    expect_near(0, track_left(0.1).turn_rate);
    while (drive.internal.progress < JP_Q24(1)) {
        skip(1);
    }
    look_ahead(&(struct jp_path_slide){.by_turn = 0});
    expect_near(-2 * 0.1 * (drive.internal.progress / 16777216.0 - 0.5), track_left(0.1).turn_rate);
}

static void test_last_turn_ends_as_the_path_does(void)
{
    add(JP_PIECE_TURN_LEFT, 0.5, 0, 0);
    begin();
    skip(2);
    look_ahead(&aside);
    expect_motion(0, 0, track_left(0.05));
    (void)drive_piece(0);
    look_ahead(&aside);
    expect_motion(0, 0, track_left(0.05));
}

/* Faster than `pace`, twice the speed by the way; slower, `pace`. */
static void test_pace_of_the_heading(void)
{
    config.turn_correction = JP_Q24(8);
    config.way = JP_Q24(0.1);
    init();
    set_point(false);
    expect_motion(0.5, 0.1 - 1, track(0, 0, 0.1));
    at.motion.speed = 0;
    expect_motion(0, 0.1 - 0.2, track(0, 0, 0.1));
}

/* Begun anew in the midst of it, it is the same drive from the begin on. */
static void test_a_path_begins_anew(void)
{
    static struct jp_path_set_point first[20];

    add_line(0.05);
    add_line(0.05);
    begin();
    for (int i = 0; i < 20; i++) {
        TEST_ASSERT_TRUE(jp_path_drive_advance(&drive, &first[i]));
    }
    for (int i = 0; i < 100; i++) {
        (void)jp_path_drive_advance(&drive, &at);
    }
    TEST_ASSERT_GREATER_THAN_UINT16(0, jp_path_drive_piece(&drive));
    jp_path_drive_begin(&drive, &path);
    TEST_ASSERT_EQUAL_UINT16(0, jp_path_drive_piece(&drive));
    for (int i = 0; i < 20; i++) {
        TEST_ASSERT_TRUE(jp_path_drive_advance(&drive, &at));
        TEST_ASSERT_EQUAL_INT32(first[i].motion.speed, at.motion.speed);
        TEST_ASSERT_EQUAL_INT32(first[i].pose.position.x, at.pose.position.x);
        TEST_ASSERT_EQUAL_INT32(first[i].acceleration, at.acceleration);
    }
}
