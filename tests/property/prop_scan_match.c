/*
 * Laser odometry: its drift in offices, and what it says where walls, scans or guesses are not enough.
 *
 * prop_scan_match [--count N] [--seed S] [--json FILE]
 */
#include <joulepath/scan_match.h>

#include <math.h>
#include <stdio.h>

#include "sim/four_wheel/laser.h"
#include "tests/support/check.h"
#include "tests/support/office_map.h"
#include "tests/support/options.h"
#include "unity.h"

#define RANGE         8.0 /* m */
#define NOISE         0.01
#define SCAN_PERIOD   0.1 /* s */
#define STEP          0.01
#define SPEED         0.8   /* m/s */
#define DRIFT         0.005 /* of the way */
#define COMPANY_DRIFT 0.02
#define SINGLE        1e-5 /* of single precision, m and rad */

static struct random noise;
static double worst_drift;

static struct options options = {.count = 4, .seed = 30};
static struct office office;
static struct solid_map map;
static struct jp_scan_matcher matcher;
static uint64_t matcher_block[8 * LASER_BEAMS_MAX + 8];
static struct jp_match_result result;
static struct laser_scan scan;
static struct planar_pose scanner;

void setUp(void)
{
    random_init(&noise, options.seed);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_matcher_init(&matcher, LASER_BEAMS_MAX, matcher_block, sizeof matcher_block));
}

void tearDown(void)
{
    solid_map_free(&map);
}

static void use_map(void)
{
    solid_map_free(&map);
    TEST_ASSERT_TRUE(solid_map_init(&map, &office.terrain));
}

static struct jp_plane_pose to_plane(const struct planar_pose *pose)
{
    return (struct jp_plane_pose){(float)pose->x, (float)pose->y, (float)pose->heading};
}

static void start_matcher(void)
{
    const struct jp_plane_pose pose = to_plane(&scanner);

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_matcher_start(&matcher, &pose));
}

/* Without a guess: the motion before. */
static void match_scan(const struct planar_pose *guess)
{
    const struct jp_plane_pose motion = guess != NULL ? to_plane(guess) : (struct jp_plane_pose){0, 0, 0};
    const struct jp_scan beams = {scan.ranges, (uint16_t)scan.beams, (float)scan.first, (float)scan.step};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_match(&matcher, &beams, guess != NULL ? &motion : NULL, &result));
}

/* Starts in a new office at a pose. */
static void enter_office(double x, double y, double heading)
{
    TEST_ASSERT_TRUE(office_make(&office, &noise));
    use_map();
    scanner = (struct planar_pose){x, y, heading};
    start_matcher();
}

static void take(double dropout, const struct planar_shape *shapes, size_t shape_count)
{
    struct laser_config config = laser_config_of(360, 2 * M_PI, RANGE, NOISE);
    config.dropout = dropout;
    laser_take(&config, &map, shapes, shape_count, &scanner, &noise, &scan);
}

static double pose_error(void)
{
    return hypot((double)result.pose.x - scanner.x, (double)result.pose.y - scanner.y);
}

static double heading_error(void)
{
    return fabs(planar_wrap((double)result.pose.heading - scanner.heading));
}

/* ---- Driving ---- */

struct drive {
    double dropout;
    bool pedestrians;
    bool guessless;     /* the motion before is the guess */
    double guess_error; /* of the guessed motion, a share */
};

/* Out of a room, along the corridor, in and out of two other rooms. */
static const struct planar_point way[] = {{3, 2}, {3, 7}, {9, 7}, {9, 12}, {9, 7}, {15, 7}, {15, 2}, {15, 7}, {21, 7}};
#define WAY_POINTS (sizeof way / sizeof way[0])

/* Two that walk ahead of the robot and behind it. */
static void walk(const struct planar_pose *robot, double time, struct planar_shape pedestrians[2])
{
    for (int i = 0; i < 2; i++) {
        const double bearing = robot->heading + (i == 0 ? 0.4 : M_PI) + 0.5 * sin(time + i);
        pedestrians[i] =
            (struct planar_shape){.kind = PLANAR_DISC,
                                  .pose = {robot->x + 1.2 * cos(bearing), robot->y + 1.2 * sin(bearing), 0},
                                  .radius = 0.25};
    }
}

/* Turns towards a point, then drives to it; the motion of a step. */
static struct planar_pose step_towards(struct planar_point goal)
{
    const double bearing = atan2(goal.y - scanner.y, goal.x - scanner.x);
    const double error = planar_wrap(bearing - scanner.heading);
    const double turn_rate = fmax(fmin(3 * error, 1), -1);
    const double speed = fabs(error) > 0.5 ? 0 : SPEED;
    return (struct planar_pose){speed * STEP * cos(turn_rate * STEP / 2), speed * STEP * sin(turn_rate * STEP / 2),
                                turn_rate * STEP};
}

static void match_now(const struct drive *drive, double time, struct planar_pose *guess)
{
    struct planar_shape pedestrians[2];
    walk(&scanner, time, pedestrians);
    take(drive->dropout, pedestrians, drive->pedestrians ? 2 : 0);
    match_scan(drive->guessless ? NULL : guess);
    TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
    *guess = (struct planar_pose){0, 0, 0};
}

/* The drive through an office; the drift over the way. */
static double drift_of(const struct drive *drive)
{
    struct planar_pose guess = {0, 0, 0};
    double length = 0;
    size_t goal = 1;
    enter_office(way[0].x, way[0].y, M_PI / 2);
    for (int step = 0; goal < WAY_POINTS; step++) {
        if (step % (int)(SCAN_PERIOD / STEP + 0.5) == 0) {
            match_now(drive, step * STEP, &guess);
        }
        const struct planar_pose motion = step_towards(way[goal]);
        const struct planar_pose guessed = {motion.x * (1 + drive->guess_error), motion.y,
                                            motion.heading * (1 + drive->guess_error)};
        scanner = planar_compose(&scanner, &motion);
        guess = planar_compose(&guess, &guessed);
        length += hypot(motion.x, motion.y);
        goal += hypot(way[goal].x - scanner.x, way[goal].y - scanner.y) < 0.05;
    }
    take(drive->dropout, NULL, 0);
    match_scan(&guess);
    return pose_error() / length;
}

static void test_drift_in_offices(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const struct drive drive = {.guess_error = random_uniform(&noise, -0.03, 0.03)};
        const double drift = drift_of(&drive);
        worst_drift = fmax(worst_drift, drift);
        check_below(drift, DRIFT, "drift, of the way");
        check_below(heading_error(), 0.03, "heading, rad");
    }
}

/* Two who walk along with the robot, which looks as if it stood. */
static void test_drift_with_company_and_dropouts(void)
{
    for (unsigned long run = 0; run < (options.count + 3) / 4; run++) {
        const struct drive drive = {.pedestrians = true, .dropout = 0.05, .guess_error = 0.02};
        check_below(drift_of(&drive), COMPANY_DRIFT, "drift, of the way");
    }
}

/* ---- In one room ---- */

static void test_first_scan_is_the_first_key(void)
{
    enter_office(3, 3, 1);
    take(0, NULL, 0);
    match_scan(&(struct planar_pose){9, 9, 9});
    TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
    TEST_ASSERT_TRUE(result.is_new_key);
    check_near(0, pose_error() + heading_error(), SINGLE, "the first scan is where the caller says");
}

static void test_standing_still_does_not_drift(void)
{
    enter_office(3, 3, 1);
    for (int i = 0; i < 200; i++) {
        take(0, NULL, 0);
        match_scan(NULL);
        TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
        TEST_ASSERT_TRUE(result.is_new_key == (i == 0));
        check_below(pose_error(), 0.01, "m");
        check_below(heading_error(), 0.005, "rad");
    }
    check_below(result.residual, 1.5 * NOISE, "residual, m");
    TEST_ASSERT_TRUE(result.inlier_share > 0.8);
    TEST_ASSERT_FALSE(result.is_degenerate);
}

/* Within a room the motion before is guess enough. */
static void test_steady_motion_needs_no_guess(void)
{
    const struct planar_pose motion = {0.05, 0.01, 0.04};
    enter_office(3, 1.5, 0.3);
    for (int i = 0; i < 60; i++) {
        take(0, NULL, 0);
        match_scan(NULL);
        TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
        check_below(pose_error(), 0.03, "m");
        scanner = planar_compose(&scanner, &motion);
    }
}

/* Single matches from wrong guesses: the error is that of the noise. */
static void test_wrong_guesses_are_corrected(void)
{
    double squares = 0;
    for (int run = 0; run < 100; run++) {
        const struct planar_pose motion = {random_uniform(&noise, -0.2, 0.2), random_uniform(&noise, -0.2, 0.2),
                                           random_uniform(&noise, -0.15, 0.15)};
        const struct planar_pose guess = {motion.x + random_uniform(&noise, -0.05, 0.05),
                                          motion.y + random_uniform(&noise, -0.05, 0.05),
                                          motion.heading + random_uniform(&noise, -0.05, 0.05)};
        enter_office(3, 3, random_uniform(&noise, -M_PI, M_PI));
        take(0, NULL, 0);
        match_scan(NULL);
        scanner = planar_compose(&scanner, &motion);
        take(0, NULL, 0);
        match_scan(&guess);
        TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
        check_below(pose_error(), 0.02, "m");
        check_below(heading_error(), 0.01, "rad");
        squares += pose_error() * pose_error();
    }
    check_below(sqrt(squares / 100), 0.005, "root mean square, m");
}

static void test_new_key_after_half_a_metre_or_fifteen_degrees(void)
{
    const struct planar_pose ahead = {0.1, 0, 0};
    const struct planar_pose turn = {0, 0, 4 * M_PI / 180};
    const struct planar_pose motions[] = {ahead, ahead, ahead, ahead, ahead, ahead, turn, turn, turn, turn};
    int keys = 0;
    enter_office(3, 2, M_PI / 2);
    take(0, NULL, 0);
    match_scan(NULL);
    for (int i = 0; i < 10; i++) {
        scanner = planar_compose(&scanner, &motions[i]);
        take(0, NULL, 0);
        match_scan(&motions[i]);
        keys += result.is_new_key;
        TEST_ASSERT_TRUE_MESSAGE(i < 5 || keys >= 1, "after half a metre");
    }
    TEST_ASSERT_TRUE_MESSAGE(keys >= 2, "after fifteen degrees");
}

/* What it tells of its certainty is what errors are: about noise²·information⁻¹, and symmetric. */
static void test_information(void)
{
    enter_office(3, 3, 0.5);
    for (int i = 0; i < 2; i++) {
        take(0, NULL, 0);
        match_scan(NULL);
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            check_near(result.information[i][j], result.information[j][i], 1e-3, "symmetry");
        }
        TEST_ASSERT_TRUE(result.information[i][i] > 30);
    }
    const double trace = result.information[0][0] + result.information[1][1];
    check_near(220, trace, 80, "a weighted normal a point");
    check_near(1, result.weak[0] * result.weak[0] + result.weak[1] * result.weak[1] + result.weak[2] * result.weak[2],
               SINGLE, "length of the weak direction");
}

/* ---- Where it is not enough ---- */

/* A corridor without ends or doorways, along a bearing in the scanner's frame. */
static void enter_corridor(double heading)
{
    TEST_ASSERT_TRUE(office_empty(&office));
    office_fill(&office, 0, 100, OFFICE_WIDTH - 1, 102, JP_CELL_OCCUPIED);
    office_fill(&office, 0, 145, OFFICE_WIDTH - 1, 147, JP_CELL_OCCUPIED);
    use_map();
    scanner = (struct planar_pose){10, 6.1, heading};
    start_matcher();
    take(0, NULL, 0);
    match_scan(NULL);
}

static void test_corridor_is_weak_along_its_axis(void)
{
    for (int run = 0; run < 20; run++) {
        const struct planar_pose motion = {0.1 * cos(run), -0.1 * sin(run), 0.02};
        const struct planar_pose guess = {motion.x * 1.2, motion.y * 1.2, 0.03};
        enter_corridor(run);
        const struct planar_pose guessed = planar_compose(&scanner, &guess);
        scanner = planar_compose(&scanner, &motion);
        take(0, NULL, 0);
        match_scan(&guess);
        TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
        TEST_ASSERT_TRUE_MESSAGE(result.is_degenerate && result.weakest < JP_SCAN_MATCH_WEAK, "degenerate");
        check_near(1, fabs(result.weak[0]), 0.02, "weak along x");
        check_near(guessed.x, result.pose.x, 0.005, "the guess stands along the corridor, m");
        check_near(scanner.y, result.pose.y, 0.01, "corrected across it, m");
        check_below(heading_error(), 0.01, "corrected heading, rad");
    }
}

static void test_long_drive_in_a_corridor_keeps_the_guess(void)
{
    const struct planar_pose motion = {0.08, 0, 0};
    enter_corridor(0);
    scanner.x -= 5;
    start_matcher();
    for (int i = 0; i < 100; i++) {
        take(0, NULL, 0);
        match_scan(i == 0 ? NULL : &motion);
        scanner = planar_compose(&scanner, &motion);
    }
    scanner = planar_compose(&scanner, &(struct planar_pose){-0.08, 0, 0});
    check_below(pose_error(), 0.05, "m after 8 m");
}

/* Nothing in range: the guess is all there is, and then the old key fits again. */
static void test_empty_scans(void)
{
    const struct planar_pose motion = {0.02, 0, 0.01};
    enter_office(3, 3, 1);
    take(0, NULL, 0);
    match_scan(NULL);
    for (int i = 0; i < 5; i++) {
        scanner = planar_compose(&scanner, &motion);
        take(1, NULL, 0);
        match_scan(&motion);
        TEST_ASSERT_EQUAL_INT(JP_MATCH_FEW_POINTS, result.match);
        TEST_ASSERT_FALSE(result.is_new_key);
        check_below(pose_error() + heading_error(), SINGLE, "the guess");
    }
    take(0, NULL, 0);
    match_scan(NULL);
    TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
    scanner = planar_compose(&scanner, &motion); /* the motion before was the guess */
    scanner = planar_compose(&scanner, &(struct planar_pose){-0.02, 0, -0.01});
    check_below(pose_error(), 0.06, "m");
}

static void test_first_scan_may_be_empty(void)
{
    enter_office(3, 3, 1);
    take(1, NULL, 0);
    match_scan(NULL);
    TEST_ASSERT_EQUAL_INT(JP_MATCH_FEW_POINTS, result.match);
    check_below(pose_error() + heading_error(), SINGLE, "the start");
    take(0, NULL, 0);
    match_scan(NULL);
    TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
    TEST_ASSERT_TRUE(result.is_new_key);
}

/* The wheels say 0.6 m, the walls say no. */
static void test_jump_of_the_guess(void)
{
    int jumps = 0;
    for (int run = 0; run < 40; run++) {
        const double bearing = random_uniform(&noise, -M_PI, M_PI);
        const struct planar_pose guess = {0.4 * cos(bearing), 0.4 * sin(bearing), 0};
        enter_office(3, 3, bearing);
        take(0, NULL, 0);
        match_scan(NULL);
        take(0, NULL, 0);
        match_scan(&guess);
        TEST_ASSERT_TRUE_MESSAGE(result.match != JP_MATCH_FITS, "a jump must not pass unseen");
        if (result.match == JP_MATCH_JUMP) {
            jumps++;
            check_below(pose_error(), 0.05, "the pose is the fit, m");
        }
    }
    TEST_ASSERT_TRUE_MESSAGE(jumps >= 30, "most jumps are seen as such");
}

/* Carried to another place between two scans: no fit, or no pairs, the guess, and on from there. */
static void test_another_place_diverges(void)
{
    int lost = 0;
    for (int run = 0; run < 30; run++) {
        enter_office(3, 2, 0.4);
        take(0, NULL, 0);
        match_scan(NULL);
        scanner = (struct planar_pose){12, 7, 2};
        take(0, NULL, 0);
        match_scan(&(struct planar_pose){0, 0, 0});
        if (result.match != JP_MATCH_JUMP) {
            lost++;
            check_near(3, result.pose.x, SINGLE, "x of the guess");
            TEST_ASSERT_TRUE(result.is_new_key);
        }
        take(0, NULL, 0);
        match_scan(&(struct planar_pose){0, 0, 0});
        TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
    }
    TEST_ASSERT_TRUE_MESSAGE(lost >= 20, "most are seen as such");
}

/* Half a turn's field of view has ends. */
static void test_half_a_field_of_view(void)
{
    const struct laser_config half = laser_config_of(181, M_PI, RANGE, NOISE);
    const struct planar_pose motion = {0.05, 0, 0.03};
    enter_office(3, 1.5, M_PI / 2);
    for (int i = 0; i < 40; i++) {
        laser_take(&half, &map, NULL, 0, &scanner, &noise, &scan);
        match_scan(i == 0 ? NULL : &motion);
        TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
        check_below(pose_error(), 0.05, "m");
        scanner = planar_compose(&scanner, &motion);
    }
}

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", 100 * worst_drift, "%", at_most(100 * DRIFT),
                "laser odometry: drift over 43 m in an office, worst of %lu", options.count);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);

    const int failures = RUN_PROPERTY(options, add_figures);

    printf("drift: worst %.3f %% of the way\n", 100 * worst_drift);
    return failures;
}
