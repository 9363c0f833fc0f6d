/* Scans worked out by hand: which points make one shape, and which scans are refused. */
#include <string.h>

#include <joulepath/obstacles.h>

#include "src/base/plane.h"

#include "tests/support/near.h"

#define TOLERANCE 1e-5f

enum { BEAMS = 181, MANY = 1500 };

static const struct jp_plane_pose origin = {0.0f, 0.0f, 0.0f};

static float ranges[MANY];
static struct jp_scan scan;
static struct jp_scan_config config;
static struct jp_obstacles obstacles;

/* A scan of a half turn to the north that has seen nothing. */
void setUp(void)
{
    for (int i = 0; i < MANY; i++) {
        ranges[i] = 0.0f;
    }
    scan = (struct jp_scan){ranges, BEAMS, 0.0f, JP_PLANE_PI / (BEAMS - 1)};
    config = (struct jp_scan_config){.range_max = 10.0f, .gap = 0.5f, .tolerance = 0.03125f, .beams_min = 3};
    jp_obstacles_clear(&obstacles, &(struct jp_plane_point){0.0f, 0.0f});
}

void tearDown(void)
{
}

static float angle_of(int beam)
{
    return (float)beam * scan.angle_step;
}

/* Beams that see the line y = distance. */
static void see_wall(int first, int last, float distance)
{
    for (int i = first; i <= last; i++) {
        ranges[i] = distance / jp_plane_sine(angle_of(i));
    }
}

static void see_circle(int first, int last, float radius)
{
    for (int i = first; i <= last; i++) {
        ranges[i] = radius;
    }
}

static void add(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add_scan(&obstacles, &config, &scan, &origin));
}

static void test_nothing_seen_is_nothing_near(void)
{
    add();
    TEST_ASSERT_EQUAL_UINT(0, obstacles.count);
}

static void test_wall_is_one_capsule(void)
{
    see_wall(45, 135, 2.0f);
    add();
    TEST_ASSERT_EQUAL_UINT(1, obstacles.count);
    TEST_ASSERT_EQUAL_UINT(2, obstacles.shapes[0].vertex_count);
    TEST_ASSERT_NEAR(TOLERANCE, 2.0f, obstacles.shapes[0].vertices[0].x);
    TEST_ASSERT_NEAR(TOLERANCE, 2.0f, obstacles.shapes[0].vertices[0].y);
    TEST_ASSERT_NEAR(TOLERANCE, -2.0f, obstacles.shapes[0].vertices[1].x);
    TEST_ASSERT_NEAR(TOLERANCE, 2.0f, obstacles.shapes[0].vertices[1].y);
    TEST_ASSERT_NEAR(TOLERANCE, 0.0f, obstacles.shapes[0].radius);
}

/* Two of three points are nearer by the same: the chord lies at their mean, a third of the way from them. */
static void test_chord_lies_in_the_middle_of_its_points(void)
{
    const float near = 2.0f;
    const float far = 2.03f;

    for (int i = 61; i <= 119; i++) {
        see_wall(i, i, i % 3 == 0 ? far : near);
    }
    add();
    TEST_ASSERT_EQUAL_UINT(1, obstacles.count);
    for (int i = 0; i < 2; i++) {
        TEST_ASSERT_NEAR(1e-3f, near + (far - near) / 3.0f, obstacles.shapes[0].vertices[i].y);
    }
    TEST_ASSERT_NEAR(1e-3f, (far - near) * 2.0f / 3.0f, obstacles.shapes[0].radius);
}

static bool is_in_a_shape(struct jp_plane_point place)
{
    const struct jp_footprint point = {0.0f, 0.0f, 0.0f};
    const struct jp_plane_pose pose = {place.x, place.y, 0.0f};

    return jp_obstacles_distance(&obstacles, &point, &pose) < TOLERANCE;
}

static void expect_all_points_in_shapes(void)
{
    for (int i = 0; i < scan.count; i++) {
        if (ranges[i] > 0.0f) {
            const float angle = scan.first_angle + angle_of(i);

            TEST_ASSERT_TRUE(is_in_a_shape(
                (struct jp_plane_point){ranges[i] * jp_plane_cosine(angle), ranges[i] * jp_plane_sine(angle)}));
        }
    }
}

/* A wall seen along itself: noise moves points over the ends of the chord. */
static void test_points_beyond_the_ends_of_a_chord_are_in_its_shape(void)
{
    const float noisy[] = {2.0f, 2.03f, 1.985f, 2.01f};

    scan.count = 4;
    scan.angle_step = 0.001f;
    memcpy(ranges, noisy, sizeof noisy);
    add();
    TEST_ASSERT_EQUAL_UINT(1, obstacles.count);
    TEST_ASSERT_EQUAL_UINT(2, obstacles.shapes[0].vertex_count);
    TEST_ASSERT_TRUE(obstacles.shapes[0].radius <= config.tolerance);
    expect_all_points_in_shapes();
}

/* Beams so narrow that they all have one direction. */
static void test_points_around_one_place_are_a_disc(void)
{
    scan.count = 3;
    scan.first_angle = 1.0f;
    scan.angle_step = 1e-9f;
    ranges[0] = 1.0f;
    ranges[1] = 1.02f;
    ranges[2] = 1.0f;
    add();
    TEST_ASSERT_EQUAL_UINT(1, obstacles.count);
    TEST_ASSERT_EQUAL_UINT(1, obstacles.shapes[0].vertex_count);
    TEST_ASSERT_NEAR(TOLERANCE, config.tolerance + 0.02f, obstacles.shapes[0].radius);
    expect_all_points_in_shapes();
}

static void test_scan_is_seen_from_the_sensor(void)
{
    const struct jp_plane_pose sensor = {10.0f, -5.0f, 0.5f * JP_PLANE_PI};

    scan.first_angle = 0.25f * JP_PLANE_PI;
    ranges[0] = 2.0f;
    config.beams_min = 1;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add_scan(&obstacles, &config, &scan, &sensor));
    TEST_ASSERT_EQUAL_UINT(1, obstacles.count);
    TEST_ASSERT_EQUAL_UINT(1, obstacles.shapes[0].vertex_count);
    TEST_ASSERT_TRUE(obstacles.shapes[0].radius == config.tolerance);
    TEST_ASSERT_NEAR(TOLERANCE, 10.0f - 1.41421356f, obstacles.shapes[0].vertices[0].x);
    TEST_ASSERT_NEAR(TOLERANCE, -5.0f + 1.41421356f, obstacles.shapes[0].vertices[0].y);
}

static void test_corner_of_a_room_is_split(void)
{
    /* y = 2 to the left of the diagonal, x = 2 to the right of it. */
    see_wall(45, 90, 2.0f);
    for (int i = 1; i < 45; i++) {
        ranges[i] = 2.0f / jp_plane_cosine(angle_of(i));
    }
    add();
    TEST_ASSERT_EQUAL_UINT(2, obstacles.count);
    for (int i = 0; i < 2; i++) {
        const struct jp_plane_point *const corner =
            &obstacles.shapes[i].vertices[obstacles.shapes[i].vertices[0].y < 1.0f];

        TEST_ASSERT_NEAR(TOLERANCE, 2.0f, corner->x);
        TEST_ASSERT_NEAR(TOLERANCE, 2.0f, corner->y);
    }
}

static void test_gap_separates_shapes(void)
{
    see_wall(60, 80, 2.0f);
    see_wall(100, 120, 2.0f);
    add();
    TEST_ASSERT_EQUAL_UINT(2, obstacles.count);

    setUp();
    see_wall(60, 80, 2.0f);
    see_wall(100, 120, 2.0f);
    config.gap = 1.0f;
    add();
    TEST_ASSERT_EQUAL_UINT(1, obstacles.count);
}

static void test_jump_in_range_separates_shapes(void)
{
    see_wall(60, 90, 2.0f);
    see_wall(91, 120, 3.0f);
    add();
    TEST_ASSERT_EQUAL_UINT(2, obstacles.count);
}

static void test_dropouts_and_free_beams_between_points_are_passed_over(void)
{
    see_wall(60, 120, 2.0f);
    ranges[70] = 0.0f;
    ranges[80] = -1.0f;
    add();
    TEST_ASSERT_EQUAL_UINT(1, obstacles.count);
}

static void test_few_points_are_noise(void)
{
    see_wall(60, 61, 2.0f);
    see_wall(90, 92, 2.0f);
    add();
    TEST_ASSERT_EQUAL_UINT(1, obstacles.count);
    TEST_ASSERT_NEAR(0.1f, 0.0f, obstacles.shapes[0].vertices[0].x);
}

static void test_far_points_are_left_out(void)
{
    see_wall(60, 120, 2.0f);
    config.range_max = 1.99f;
    add();
    TEST_ASSERT_EQUAL_UINT(0, obstacles.count);
}

static void test_circle_becomes_chords_within_the_tolerance(void)
{
    see_circle(0, BEAMS - 1, 2.0f);
    add();
    TEST_ASSERT_TRUE(obstacles.count >= 5 && obstacles.count <= 16);
    TEST_ASSERT_EQUAL_UINT32(0, obstacles.dropped);
    for (unsigned i = 0; i < obstacles.count; i++) {
        TEST_ASSERT_TRUE(obstacles.distance[i] > 2.0f - config.tolerance);
        TEST_ASSERT_TRUE(obstacles.shapes[i].radius > 0.0f && obstacles.shapes[i].radius <= config.tolerance);
    }
    expect_all_points_in_shapes();
}

/* Each tooth is higher than the one before, so that each split cuts off one tooth only. */
static void test_what_splits_do_not_straighten_gets_the_radius_it_needs(void)
{
    scan.count = 101;
    scan.angle_step = 0.01f;
    config = (struct jp_scan_config){.range_max = 10.0f, .gap = 10.0f, .tolerance = 0.001f, .beams_min = 1};
    for (int i = 0; i < scan.count; i++) {
        ranges[i] = i % 2 == 0 ? 1.0f : 1.1f + 0.05f * (float)i;
    }
    add();

    bool is_wide = false;

    for (unsigned i = 0; i < obstacles.count; i++) {
        is_wide = is_wide || obstacles.shapes[i].radius > 0.01f;
    }
    TEST_ASSERT_TRUE(obstacles.dropped > 0);
    TEST_ASSERT_TRUE(is_wide);
}

/* ---- What is refused ---- */

static void expect(enum jp_status status)
{
    TEST_ASSERT_EQUAL_INT(status, jp_obstacles_add_scan(&obstacles, &config, &scan, &origin));
    TEST_ASSERT_EQUAL_UINT(0, obstacles.count);
}

static void test_scan_of_dropouts_is_not_trusted(void)
{
    volatile float large = FLT_MAX; /* the compiler must not see that it overflows */
    const float infinity = large * 2.0f;

    scan.count = 8;
    ranges[0] = 1.0f;
    ranges[1] = 0.0f;
    for (int i = 2; i < 8; i++) {
        const float dropouts[] = {-1.0f, infinity, infinity - infinity};

        ranges[i] = dropouts[i % 3];
    }
    expect(JP_OK);
    ranges[1] = infinity;
    expect(JP_ERR_UNRELIABLE);
}

static void test_null_pointers_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_obstacles_add_scan(NULL, &config, &scan, &origin));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_obstacles_add_scan(&obstacles, NULL, &scan, &origin));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_obstacles_add_scan(&obstacles, &config, NULL, &origin));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_obstacles_add_scan(&obstacles, &config, &scan, NULL));
    scan.ranges = NULL;
    expect(JP_ERR_ARGUMENT);
}

static void test_bad_configurations_are_refused(void)
{
    const struct jp_scan_config good = config;
    const struct jp_scan_config bad[] = {
        {0.0f, good.gap, good.tolerance, 1},           {1001.0f, good.gap, good.tolerance, 1},
        {good.range_max, 0.0f, good.tolerance, 1},     {good.range_max, 1001.0f, good.tolerance, 1},
        {good.range_max, good.gap, 0.0009f, 1},        {good.range_max, good.gap, 1001.0f, 1},
        {good.range_max, good.gap, good.tolerance, 0},
    };

    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        config = bad[i];
        expect(JP_ERR_ARGUMENT);
    }
}

static void test_bad_scans_are_refused(void)
{
    const struct jp_scan bad[] = {
        {ranges, 1, 0.0f, 0.01f},    {ranges, BEAMS, 7.1f, 0.01f}, {ranges, BEAMS, -7.1f, 0.01f},
        {ranges, BEAMS, 0.0f, 0.0f}, {ranges, 701, 0.0f, 0.01f},
    };

    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        scan = bad[i];
        expect(JP_ERR_ARGUMENT);
    }
}

static void test_bad_sensors_are_refused(void)
{
    const struct jp_plane_pose bad[] = {{31768.0f, 0.0f, 0.0f}, {0.0f, -31768.0f, 0.0f}, {0.0f, 0.0f, 1001.0f}};

    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_obstacles_add_scan(&obstacles, &config, &scan, &bad[i]));
    }
}
