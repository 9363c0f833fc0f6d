/* Parts of laser odometry against brute force in double precision: the lines of the key scan, the nearest points that
 * are paired, and the information that walls give. */
#include <joulepath/scan_match.h>

#include "src/base/plane.h"
#include "tests/support/near.h"
#include "tests/target/random.h"

enum { BEAMS = 160, WALLS_MAX = 10, WINDOW = 12 };

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
static uint32_t state;
static float noise;

static void put_wall(float x1, float y1, float x2, float y2)
{
    walls[wall_count] = (struct wall){{x1, y1}, {x2, y2}};
    wall_count++;
}

static void look_around(bool is_around)
{
    const float step = (is_around ? 2.0f : 1.3f) * JP_PLANE_PI / BEAMS;

    scan = (struct jp_scan){ranges, BEAMS, is_around ? -JP_PLANE_PI : -2.0f, step};
}

static void start(float x, float y, float heading)
{
    scanner = (struct jp_plane_pose){x, y, heading};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_matcher_start(&matcher, &scanner));
}

/* A room without a right angle between most of its walls, and a pillar. */
void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_matcher_init(&matcher, BEAMS, block, sizeof block));
    look_around(true);
    state = 3;
    noise = 0.0f;
    wall_count = 0;
    put_wall(0.0f, 0.0f, 6.0f, 0.3f);
    put_wall(6.0f, 0.3f, 5.5f, 5.0f);
    put_wall(5.5f, 5.0f, 1.0f, 4.6f);
    put_wall(1.0f, 4.6f, 0.0f, 0.0f);
    put_wall(3.6f, 3.0f, 4.1f, 3.2f);
    put_wall(4.1f, 3.2f, 3.8f, 3.6f);
    put_wall(3.8f, 3.6f, 3.6f, 3.0f);
    start(2.3f, 1.9f, 0.4f);
}

void tearDown(void)
{
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

static void take_and_match(const struct jp_plane_pose *motion)
{
    for (int i = 0; i < BEAMS; i++) {
        const float bearing = scanner.heading + scan.first_angle + (float)i * scan.angle_step;
        const float off = (float)(target_random(&state) % 2001U) * 0.001f - 1.0f;
        float range = 100.0f;

        for (int k = 0; k < wall_count; k++) {
            range = jp_plane_smaller(range, distance_to(&walls[k], jp_plane_wrap(bearing)));
        }
        ranges[i] = range < 99.0f ? range + noise * off : 0.0f;
        if (noise > 0.0f && target_random(&state) % 8U == 0U) {
            ranges[i] = -1.0f;
        }
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_match(&matcher, &scan, motion, &result));
}

/* ---- Lines ---- */

struct spot {
    double x;
    double y;
};

static struct spot spot_of(int beam)
{
    const struct jp_plane_point along = jp_plane_direction(scan.first_angle + (float)beam * scan.angle_step);

    return (struct spot){(double)(ranges[beam] * along.x), (double)(ranges[beam] * along.y)};
}

static double square_between(struct spot a, struct spot b)
{
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

/* Of the beam and its neighbours without a gap to either side. False: it is a matter of rounding who they are. */
static bool gather(int beam, bool is_around, struct spot found[], int *count)
{
    const struct spot centre = spot_of(beam);
    const double reach = 0.1 + 4.0 * (double)ranges[beam] * (double)scan.angle_step;
    bool is_clear = true;

    found[0] = centre;
    *count = 1;
    for (int side = -1; side <= 1; side += 2) {
        struct spot last = centre;
        bool goes_on = true;

        for (int i = 1; i <= WINDOW && goes_on; i++) {
            const int wrapped = (beam + side * i + BEAMS) % BEAMS;

            goes_on = is_around || (beam + side * i >= 0 && beam + side * i < BEAMS);
            if (goes_on && ranges[wrapped] > 0.0f) {
                const struct spot spot = spot_of(wrapped);
                const double from_centre = square_between(spot, centre) - reach * reach;
                const double from_last = square_between(spot, last) - reach * reach;

                is_clear = is_clear && (from_centre > 1.0e-4 || from_centre < -1.0e-4) &&
                           (from_last > 1.0e-4 || from_last < -1.0e-4);
                goes_on = from_centre <= 0.0 && from_last <= 0.0;
                if (goes_on) {
                    found[*count] = spot;
                    (*count)++;
                    last = spot;
                }
            }
        }
    }
    return is_clear;
}

/* A line goes through the middle of its points; across it they spread least, and not along with it. */
static void expect_line(int beam, const struct spot found[], int count)
{
    const struct jp_match_line *const line = &matcher.internal.lines[beam];
    const double nx = (double)line->normal.x;
    const double ny = (double)line->normal.y;
    struct spot mean = {0.0, 0.0};
    double across = 0.0;
    double along = 0.0;
    double mixed = 0.0;

    for (int i = 0; i < count; i++) {
        mean.x += found[i].x / count;
        mean.y += found[i].y / count;
    }
    for (int i = 0; i < count; i++) {
        const double a = nx * (found[i].x - mean.x) + ny * (found[i].y - mean.y);
        const double b = nx * (found[i].y - mean.y) - ny * (found[i].x - mean.x);

        across += a * a / count;
        along += b * b / count;
        mixed += a * b / count;
    }
    TEST_ASSERT_NEAR(1.0e-4f, (float)mean.x, line->centre.x);
    TEST_ASSERT_NEAR(1.0e-4f, (float)mean.y, line->centre.y);
    TEST_ASSERT_NEAR(1.0e-5f, (float)found[0].x, line->point.x);
    TEST_ASSERT_NEAR(1.0e-5f, (float)found[0].y, line->point.y);
    TEST_ASSERT_NEAR(1.0e-5f, 1.0f, (float)(nx * nx + ny * ny));
    TEST_ASSERT_TRUE(across <= along + 1.0e-6);
    TEST_ASSERT_NEAR(1.0e-5f, 0.0f, (float)mixed);
    if (across < 3.8e-4 || across > 4.2e-4 || count < 4) {
        TEST_ASSERT_EQUAL_INT(count >= 4 && across < 4.0e-4, line->is_fitted);
    }
}

static void test_lines_are_the_least_squares_of_their_neighbours(void)
{
    for (int run = 0; run < 4; run++) {
        unsigned judged = 0;

        setUp();
        look_around(run % 2 == 0);
        noise = run < 2 ? 0.01f : 0.03f;
        take_and_match(NULL);
        TEST_ASSERT_TRUE(result.is_new_key);
        for (int i = 0; i < BEAMS; i++) {
            struct spot found[2 * WINDOW + 1];
            int count;

            if (!(ranges[i] > 0.0f)) {
                TEST_ASSERT_FALSE(matcher.internal.lines[i].is_fitted);
            } else if (gather(i, run % 2 == 0, found, &count)) {
                expect_line(i, found, count);
                judged++;
            } else {
                /* Rounding says. */
            }
        }
        TEST_ASSERT_GREATER_THAN_UINT(100, judged);
    }
}

/* Of few beams there are few neighbours. */
static void test_a_line_needs_four_points(void)
{
    take_and_match(NULL);
    for (int i = 0; i < BEAMS; i++) {
        ranges[i] = i < 40 || (i > 60 && i < 64) || (i > 80 && i < 85) ? ranges[i] : 0.0f;
    }
    start(2.3f, 1.9f, 0.4f);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_match(&matcher, &scan, NULL, &result));
    TEST_ASSERT_TRUE(result.is_new_key);
    for (int i = 61; i < 64; i++) {
        TEST_ASSERT_FALSE(matcher.internal.lines[i].is_fitted);
    }
    for (int i = 81; i < 85; i++) {
        TEST_ASSERT_TRUE(matcher.internal.lines[i].is_fitted);
    }
}

/* ---- Pairs ---- */

/* In the key's frame, of all its points. */
static int nearest_line(struct spot point, const float key_ranges[], double *best, double *second)
{
    int nearest = -1;

    *best = 1.0e9;
    *second = 1.0e9;
    for (int i = 0; i < BEAMS; i++) {
        const struct jp_match_line *const line = &matcher.internal.lines[i];
        const struct spot spot = {(double)line->point.x, (double)line->point.y};
        const double square = square_between(spot, point);

        if (key_ranges[i] > 0.0f && square < *best) {
            *second = *best;
            *best = square;
            nearest = i;
        } else if (key_ranges[i] > 0.0f && square < *second) {
            *second = square;
        } else {
            /* It is farther. */
        }
    }
    return nearest;
}

/* Where it ends, each pair is of a point and the line of the nearest one, unless two are about as near. */
static unsigned expect_pairs(void)
{
    const struct jp_plane_pose pose = jp_plane_relative(&matcher.internal.key, &result.pose);
    unsigned judged = 0;

    for (int k = 0; k < matcher.internal.cloud_count / 2; k++) {
        const struct jp_match_pair *const pair = &matcher.internal.pairs[k];
        const struct spot point = {(double)(pose.x + pair->arm.x), (double)(pose.y + pair->arm.y)};
        double best;
        double second;
        const int i = nearest_line(point, matcher.internal.ranges, &best, &second);
        const struct jp_match_line *const line = &matcher.internal.lines[i];
        const double residual = (double)line->normal.x * (point.x - (double)line->centre.x) +
                                (double)line->normal.y * (point.y - (double)line->centre.y);

        if (second > best + 1.0e-3) {
            TEST_ASSERT_NEAR(1.0e-6f, line->normal.x, pair->normal.x);
            TEST_ASSERT_NEAR(1.0e-6f, line->normal.y, pair->normal.y);
            TEST_ASSERT_NEAR(5.0e-4f, (float)residual, pair->residual);
            judged++;
        }
    }
    return judged;
}

static void test_points_are_paired_with_the_line_of_the_nearest(void)
{
    unsigned judged = 0;

    for (int run = 0; run < 6; run++) {
        const struct jp_plane_pose motion = {0.09f - 0.03f * (float)run, 0.05f * (float)(run % 3) - 0.05f,
                                             0.12f - 0.05f * (float)run};

        setUp();
        look_around(run % 2 == 0);
        noise = 0.004f;
        take_and_match(NULL);
        scanner = jp_plane_compose(&scanner, &motion);
        take_and_match(&motion);
        TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
        TEST_ASSERT_FALSE(result.is_new_key);
        TEST_ASSERT_NEAR(5.0e-3f, scanner.x, result.pose.x);
        TEST_ASSERT_NEAR(5.0e-3f, scanner.y, result.pose.y);
        TEST_ASSERT_NEAR(4.0e-3f, scanner.heading, result.pose.heading);
        judged += expect_pairs();
    }
    TEST_ASSERT_GREATER_THAN_UINT(200, judged);
}

/* ---- Information ---- */

/* Two walls, as far as they are seen; a pair gives its normal, and as much of the heading as its arm is along it. */
static void test_information_is_the_sum_over_what_walls_show(void)
{
    float exact[3][3] = {{0.0f}};
    unsigned points = 0;

    wall_count = 0;
    put_wall(3.0f, -2.0f, 3.5f, 2.0f);
    put_wall(-2.0f, 2.5f, 1.5f, 3.0f);
    start(0.2f, 0.1f, 0.7f);
    take_and_match(NULL);
    take_and_match(NULL);
    TEST_ASSERT_EQUAL_INT(JP_MATCH_FITS, result.match);
    for (int i = 0; i < BEAMS; i++) {
        const float bearing = jp_plane_wrap(scanner.heading + scan.first_angle + (float)i * scan.angle_step);
        const struct jp_plane_point along = jp_plane_direction(bearing);

        for (int k = 0; k < wall_count && matcher.internal.lines[i].is_fitted; k++) {
            const struct jp_plane_point side = {walls[k].to.x - walls[k].from.x, walls[k].to.y - walls[k].from.y};
            const float length = jp_plane_length(side.x, side.y);
            const float range = distance_to(&walls[k], bearing);
            const float row[3] = {-side.y / length, side.x / length,
                                  range * (along.x * side.x + along.y * side.y) / length};

            for (int m = 0; m < 9 && range < 99.0f; m++) {
                exact[m / 3][m % 3] += row[m / 3] * row[m % 3];
            }
            points += range < 99.0f ? 1U : 0U;
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT(40, points);
    for (int m = 0; m < 9; m++) {
        TEST_ASSERT_NEAR(0.2f, exact[m / 3][m % 3], result.information[m / 3][m % 3]);
    }
    TEST_ASSERT_NEAR(1.0e-3f, 0.0f, result.residual);
    TEST_ASSERT_FALSE(result.is_degenerate);
    /* What the weakest direction has is its information, for each pair. */
    for (int j = 0; j < 3; j++) {
        float product = 0.0f;

        for (int k = 0; k < 3; k++) {
            product += exact[j][k] * result.weak[k];
        }
        TEST_ASSERT_NEAR(0.2f, result.weakest * (float)points * result.weak[j], product);
    }
}

/* ---- The block ---- */

static void test_nothing_beyond_the_block_is_written(void)
{
    const size_t size = jp_scan_matcher_size(BEAMS);
    uint8_t *const bytes = (uint8_t *)block;

    TEST_ASSERT_TRUE(size < sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_matcher_init(&matcher, BEAMS, block, size));
    for (size_t i = size; i < sizeof block; i++) {
        bytes[i] = 0x5AU;
    }
    start(2.3f, 1.9f, 0.4f);
    take_and_match(NULL);
    take_and_match(NULL);
    for (size_t i = size; i < sizeof block; i++) {
        TEST_ASSERT_EQUAL_UINT8(0x5AU, bytes[i]);
    }
    for (int i = 0; i < BEAMS; i++) {
        TEST_ASSERT_NEAR(1.0e-6f, ranges[i], matcher.internal.ranges[i]);
    }
    TEST_ASSERT_EQUAL_INT32(BEAMS, matcher.internal.cloud_count);
}
