/* Laser odometry in a room of straight walls: what it corrects, what it says where that is not enough, and what is
 * refused. */
#include <joulepath/scan_match.h>

#include "src/base/plane.h"
#include "tests/support/near.h"
#include "tests/target/random.h"

enum { BEAMS = 240, WALLS_MAX = 12 };

struct wall {
    struct jp_plane_point from;
    struct jp_plane_point to;
};

static struct jp_scan_matcher matcher;
static uint64_t block[8 * BEAMS + 8];
static struct jp_match_result result;
static struct wall walls[WALLS_MAX];
static int wall_count;
static struct jp_plane_pose scanner;
static float ranges[BEAMS];
static struct jp_scan scan;
static uint32_t noise;

static void put_wall(float x1, float y1, float x2, float y2)
{
    TEST_ASSERT_TRUE(wall_count < WALLS_MAX);
    walls[wall_count] = (struct wall){{x1, y1}, {x2, y2}};
    wall_count++;
}

static void start(float x, float y, float heading)
{
    scanner = (struct jp_plane_pose){x, y, heading};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_matcher_start(&matcher, &scanner));
}

/* A room of 6 m × 5 m with a corner cut off and a cupboard, a scanner that looks all around. */
void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_matcher_init(&matcher, BEAMS, block, sizeof block));
    scan = (struct jp_scan){ranges, BEAMS, -JP_PLANE_PI, 2.0f * JP_PLANE_PI / BEAMS};
    noise = 1;
    wall_count = 0;
    put_wall(0.0f, 0.0f, 6.0f, 0.0f);
    put_wall(6.0f, 0.0f, 6.0f, 5.0f);
    put_wall(6.0f, 5.0f, 1.0f, 5.0f);
    put_wall(1.0f, 5.0f, 0.0f, 4.0f);
    put_wall(0.0f, 4.0f, 0.0f, 0.0f);
    put_wall(4.0f, 0.0f, 4.0f, 0.7f);
    put_wall(4.0f, 0.7f, 5.0f, 0.7f);
    put_wall(5.0f, 0.7f, 5.0f, 0.0f);
    start(2.5f, 2.0f, 0.4f);
}

void tearDown(void)
{
}

/* ---- Scans ---- */

/* ±1 cm, even. */
static float next_noise(void)
{
    return 0.01f * ((float)(target_random(&noise) >> 8) * 0x1p-23f - 1.0f);
}

static float distance_to(const struct wall *wall, float bearing)
{
    const struct jp_plane_point along = jp_plane_direction(bearing);
    const struct jp_plane_point there = {wall->from.x - scanner.x, wall->from.y - scanner.y};
    const struct jp_plane_point side = {wall->to.x - wall->from.x, wall->to.y - wall->from.y};
    const float cross = along.x * side.y - along.y * side.x;
    const float distance = (there.x * side.y - there.y * side.x) / cross;
    const float share = (there.x * along.y - there.y * along.x) / cross;

    return jp_plane_magnitude(cross) > 1.0e-6f && distance > 0.0f && share >= 0.0f && share <= 1.0f ? distance : 100.0f;
}

static void take(void)
{
    for (int i = 0; i < (int)scan.count; i++) {
        const float bearing = scanner.heading + scan.first_angle + (float)i * scan.angle_step;
        float range = 8.0f;

        for (int k = 0; k < wall_count; k++) {
            const float distance = distance_to(&walls[k], jp_plane_wrap(bearing));

            range = distance < range ? distance : range;
        }
        ranges[i] = range < 8.0f ? range + next_noise() : 0.0f;
    }
}

static void match(const struct jp_plane_pose *motion)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_match(&matcher, &scan, motion, &result));
}

static void take_and_match(const struct jp_plane_pose *motion)
{
    take();
    match(motion);
}

static void move(float x, float y, float heading)
{
    const struct jp_plane_pose motion = {x, y, heading};

    scanner = jp_plane_compose(&scanner, &motion);
}

static void expect_pose(float distance, float turn)
{
    TEST_ASSERT_NEAR(distance, scanner.x, result.pose.x);
    TEST_ASSERT_NEAR(distance, scanner.y, result.pose.y);
    TEST_ASSERT_NEAR(turn, 0.0f, jp_plane_wrap(result.pose.heading - scanner.heading));
}

/* ---- Matches ---- */

static void test_the_first_scan_is_where_the_caller_says(void)
{
    const struct jp_plane_pose motion = {9.0f, 9.0f, 1.0f};

    take_and_match(&motion);
    TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
    TEST_ASSERT_TRUE(result.is_new_key);
    expect_pose(0.0f, 1.0e-6f);
}

static void test_at_a_stand_it_stays(void)
{
    for (int i = 0; i < 20; i++) {
        take_and_match(NULL);
        TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
        TEST_ASSERT_TRUE(result.is_new_key == (i == 0));
        expect_pose(0.01f, 0.005f);
    }
    TEST_ASSERT_TRUE(result.residual < 0.015f);
    TEST_ASSERT_TRUE(result.inlier_share > 0.7f);
    TEST_ASSERT_FALSE(result.is_degenerate);
    TEST_ASSERT_TRUE(result.iterations > 0U);
}

static void test_wrong_guesses_are_corrected(void)
{
    for (int run = 0; run < 8; run++) {
        const struct jp_plane_point aside = jp_plane_direction((float)run);
        const struct jp_plane_pose guess = {0.1f + 0.05f * aside.x, 0.05f * aside.y, 0.05f * aside.y};

        start(2.5f, 2.0f, 0.8f * (float)run - 3.0f);
        take_and_match(NULL);
        move(0.1f, 0.0f, 0.0f);
        take_and_match(&guess);
        TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
        expect_pose(0.015f, 0.01f);
    }
}

static void test_steady_motion_needs_no_guess(void)
{
    for (int i = 0; i < 25; i++) {
        take_and_match(NULL);
        TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
        expect_pose(0.03f, 0.02f);
        move(0.05f, 0.01f, 0.04f);
    }
}

static void test_key_scans_follow_the_way_and_the_turn(void)
{
    const struct jp_plane_pose ahead = {0.1f, 0.0f, 0.0f};
    const struct jp_plane_pose turn = {0.0f, 0.0f, 0.07f};
    int keys = 0;

    take_and_match(NULL);
    for (int i = 0; i < 6; i++) {
        move(ahead.x, ahead.y, ahead.heading);
        take_and_match(&ahead);
        keys += result.is_new_key ? 1 : 0;
    }
    TEST_ASSERT_EQUAL_INT(1, keys);
    for (int i = 0; i < 5; i++) {
        move(turn.x, turn.y, turn.heading);
        take_and_match(&turn);
        keys += result.is_new_key ? 1 : 0;
    }
    TEST_ASSERT_EQUAL_INT(2, keys);
    expect_pose(0.02f, 0.01f);
}

/* A field of view with ends, and beams that drop out. */
static void test_three_quarters_of_the_room(void)
{
    const struct jp_plane_pose motion = {0.05f, 0.0f, 0.03f};

    scan.count = 180;
    scan.first_angle = -0.75f * JP_PLANE_PI;
    take_and_match(NULL);
    for (int i = 0; i < 15; i++) {
        move(motion.x, motion.y, motion.heading);
        take();
        ranges[7 * i] = -1.0f;
        ranges[7 * i + 1] = 1.0e30f;
        match(&motion);
        TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
        expect_pose(0.03f, 0.02f);
    }
}

/* The normal equations are symmetric, and their weak direction has the length 1. */
static void test_what_it_knows_of_its_certainty(void)
{
    take_and_match(NULL);
    take_and_match(NULL);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < i; j++) {
            TEST_ASSERT_NEAR(1.0e-3f, result.information[i][j], result.information[j][i]);
        }
        TEST_ASSERT_TRUE(result.information[i][i] > 20.0f);
    }
    TEST_ASSERT_NEAR(1.0e-5f, 1.0f,
                     result.weak[0] * result.weak[0] + result.weak[1] * result.weak[1] +
                         result.weak[2] * result.weak[2]);
}

/* ---- Where it is not enough ---- */

static void enter_corridor(void)
{
    wall_count = 0;
    put_wall(-50.0f, 0.0f, 50.0f, 0.0f);
    put_wall(-50.0f, 2.0f, 50.0f, 2.0f);
    start(0.0f, 1.1f, 0.3f);
}

static void test_along_a_corridor_the_guess_stands(void)
{
    const struct jp_plane_pose guess = {0.12f, 0.0f, 0.03f};

    enter_corridor();
    take_and_match(NULL);
    const struct jp_plane_pose guessed = jp_plane_compose(&scanner, &guess);

    move(0.1f, 0.0f, 0.02f);
    take_and_match(&guess);
    TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
    TEST_ASSERT_TRUE(result.is_degenerate);
    TEST_ASSERT_TRUE(result.weakest < JP_SCAN_MATCH_WEAK);
    TEST_ASSERT_NEAR(0.02f, 1.0f, jp_plane_magnitude(result.weak[0]));
    TEST_ASSERT_NEAR(0.005f, guessed.x, result.pose.x);
    TEST_ASSERT_NEAR(0.01f, scanner.y, result.pose.y);
}

/* The weak direction is the other axis of the scanner. */
static void test_across_a_corridor_the_guess_stands(void)
{
    wall_count = 0;
    put_wall(0.0f, -50.0f, 0.0f, 50.0f);
    put_wall(2.0f, -50.0f, 2.0f, 50.0f);
    start(1.1f, 0.0f, 0.3f);
    take_and_match(NULL);
    move(0.0f, 0.1f, 0.02f);
    take_and_match(NULL);
    TEST_ASSERT_TRUE(result.is_degenerate);
    TEST_ASSERT_NEAR(0.02f, 1.0f, jp_plane_magnitude(result.weak[1]));
}

static void test_scans_without_points(void)
{
    const struct jp_plane_pose motion = {0.02f, 0.0f, 0.01f};
    const int walls_there = wall_count;

    wall_count = 0;
    take_and_match(NULL);
    TEST_ASSERT_EQUAL_INT(JP_MATCH_FEW_POINTS, result.match);
    TEST_ASSERT_FALSE(result.is_new_key);
    expect_pose(1.0e-6f, 1.0e-6f);
    wall_count = walls_there;
    take_and_match(NULL);
    TEST_ASSERT_TRUE(result.is_new_key);
    wall_count = 0;
    move(motion.x, motion.y, motion.heading);
    take_and_match(&motion);
    TEST_ASSERT_EQUAL_INT(JP_MATCH_FEW_POINTS, result.match);
    expect_pose(1.0e-5f, 1.0e-5f);
    TEST_ASSERT_NEAR(1.0e-5f, 0.02f, matcher.motion.x);
}

static void test_a_guess_that_jumps(void)
{
    const struct jp_plane_pose guess = {0.35f, 0.0f, 0.0f};

    take_and_match(NULL);
    take_and_match(&guess);
    TEST_ASSERT_EQUAL_INT(JP_MATCH_JUMP, result.match);
    expect_pose(0.03f, 0.02f);
}

/* Carried into another room: too few pairs, or no fit. */
static void test_another_place_does_not_fit(void)
{
    const struct jp_plane_pose none = {0.0f, 0.0f, 0.0f};

    take_and_match(NULL);
    wall_count = 0;
    put_wall(1.9f, -20.0f, 1.9f, 20.0f);
    put_wall(3.3f, -20.0f, 2.3f, 20.0f);
    put_wall(2.0f, 2.6f, 3.2f, 2.3f);
    put_wall(2.0f, 1.2f, 3.2f, 1.6f);
    take_and_match(&none);
    TEST_ASSERT_TRUE(result.match == JP_MATCH_DIVERGED || result.match == JP_MATCH_FEW_POINTS);
    TEST_ASSERT_TRUE(result.is_new_key);
    expect_pose(1.0e-5f, 1.0e-5f);
    take_and_match(&none);
    TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
}

/* Far from every wall of the key scan there are no pairs. */
static void test_no_pairs_are_no_match(void)
{
    const struct jp_plane_pose none = {0.0f, 0.0f, 0.0f};

    take_and_match(NULL);
    for (int i = 0; i < BEAMS; i++) {
        ranges[i] = 0.5f;
    }
    match(&none);
    TEST_ASSERT_EQUAL_INT(JP_MATCH_FEW_POINTS, result.match);
    TEST_ASSERT_TRUE(result.is_new_key);
}

/* ---- What is refused ---- */

static void test_sizes_and_blocks(void)
{
    const size_t size = jp_scan_matcher_size(BEAMS);

    TEST_ASSERT_EQUAL_UINT(0, jp_scan_matcher_size(1));
    TEST_ASSERT_EQUAL_UINT(0, jp_scan_matcher_size(JP_SCAN_MATCH_BEAMS_MAX + 1U));
    TEST_ASSERT_TRUE(size <= 64U * BEAMS);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_matcher_init(&matcher, BEAMS, block, size));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_scan_matcher_init(&matcher, BEAMS, block, size - 1U));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ALIGNMENT, jp_scan_matcher_init(&matcher, BEAMS, (char *)block + 4, size));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_scan_matcher_init(NULL, BEAMS, block, size));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_scan_matcher_init(&matcher, BEAMS, NULL, size));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_scan_matcher_init(&matcher, 1, block, size));
}

static void test_wrong_arguments_change_nothing(void)
{
    const struct jp_plane_pose far = {40000.0f, 0.0f, 0.0f};
    struct jp_scan wrong = scan;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_scan_matcher_start(NULL, &scanner));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_scan_matcher_start(&matcher, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_scan_matcher_start(&matcher, &far));
    take();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_scan_match(NULL, &scan, NULL, &result));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_scan_match(&matcher, NULL, NULL, &result));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_scan_match(&matcher, &scan, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_scan_match(&matcher, &scan, &far, &result));
    wrong.ranges = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_scan_match(&matcher, &wrong, NULL, &result));
    wrong = scan;
    wrong.count = BEAMS + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_scan_match(&matcher, &wrong, NULL, &result));
    match(NULL);
    TEST_ASSERT_TRUE(result.is_new_key);
    expect_pose(1.0e-6f, 1.0e-6f);
}
