/* Ends of beams, their match with a wall and what the map says of them, against closed forms. */
#include "src/local/localiser_match.h"

#include "src/base/plane.h"
#include "src/local/eigen.h"
#include "src/local/wall_field.h"
#include "tests/support/near.h"

enum { WIDTH = 64, HEIGHT = 40, POINTS = 48 };

#define CELL  0.125f
#define NOISE 0.04f

/* Beams side by side count for one by so many. */
#define ALIKE 8.0f

static struct jp_terrain map;
static uint64_t map_block[HEIGHT * 2];
static int8_t cells[WIDTH * HEIGHT];
static int8_t column[HEIGHT];
static struct jp_wall_field field;
static struct jp_plane_point points[POINTS];
static struct jp_localiser_cloud cloud;
static struct jp_localiser_fit fit;
static struct jp_localiser_view view;
static float ranges[POINTS];

static void occupy(int x0, int y0, int x1, int y1)
{
    for (int y = y0; y < y1; y++) {
        for (int x = x0; x < x1; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&map, x, y, JP_CELL_OCCUPIED));
        }
    }
    jp_wall_field_make(&field, &map, column);
}

void setUp(void)
{
    const struct jp_terrain_config config = {.width = WIDTH, .height = HEIGHT, .resolution = JP_Q16(0.125)};
    const char *name;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map, &config, map_block, sizeof map_block, &name));
    field = (struct jp_wall_field){cells, WIDTH, HEIGHT, CELL};
    cloud = (struct jp_localiser_cloud){.points = points, .stride = 1};
    jp_wall_field_make(&field, &map, column);
}

void tearDown(void)
{
}

static void add(float x, float y)
{
    points[cloud.count] = (struct jp_plane_point){x, y};
    cloud.count++;
}

/* ---- Ends of beams ---- */

static const struct jp_scan scan = {ranges, POINTS, -1.0f, 0.05f};

static void test_ends_are_where_their_beams_lead_from_the_sensor(void)
{
    const struct jp_plane_pose sensor = {0.3f, -0.2f, 0.6f};

    for (int i = 0; i < POINTS; i++) {
        ranges[i] = 1.0f + 0.1f * (float)i;
    }
    jp_localiser_collect(&cloud, POINTS, &scan, &sensor, 100.0f);
    TEST_ASSERT_EQUAL_INT32(POINTS, cloud.count);
    TEST_ASSERT_EQUAL_INT32(1, cloud.stride);
    TEST_ASSERT_NEAR(1.0e-6f, 0.3f, cloud.sensor.x);
    TEST_ASSERT_NEAR(1.0e-6f, -0.2f, cloud.sensor.y);
    for (int i = 0; i < POINTS; i++) {
        const float bearing = 0.6f - 1.0f + 0.05f * (float)i;

        TEST_ASSERT_NEAR(1.0e-5f, 0.3f + ranges[i] * jp_plane_cosine(bearing), points[i].x);
        TEST_ASSERT_NEAR(1.0e-5f, -0.2f + ranges[i] * jp_plane_sine(bearing), points[i].y);
    }
}

/* The least n of which every n-th are few enough. */
static void test_as_many_ends_are_taken_as_there_is_room_for(void)
{
    const struct jp_plane_pose none = {0.0f, 0.0f, 0.0f};

    for (int hits = 0; hits <= POINTS; hits++) {
        for (int i = 0; i < POINTS; i++) {
            ranges[i] = i < hits ? 1.0f + 0.1f * (float)i : 0.0f;
        }
        for (int most = 5; most <= POINTS; most += 6) {
            int stride = 1;

            while ((hits + stride - 1) / stride > most) {
                stride++;
            }
            jp_localiser_collect(&cloud, most, &scan, &none, 100.0f);
            TEST_ASSERT_EQUAL_INT32(stride, cloud.stride);
            TEST_ASSERT_EQUAL_INT32((hits + stride - 1) / stride, cloud.count);
            for (int i = 0; i < cloud.count; i++) {
                const float range = jp_plane_length(points[i].x, points[i].y);

                TEST_ASSERT_NEAR(1.0e-4f, 1.0f + 0.1f * (float)(i * stride), range);
            }
        }
    }
}

static void test_what_is_no_hit_is_not_taken(void)
{
    const struct jp_plane_pose none = {0.0f, 0.0f, 0.0f};
    const float failed[] = {0.0f, -1.0f, 3.001f, __builtin_inff(), __builtin_nanf("")};

    for (int i = 0; i < POINTS; i++) {
        ranges[i] = failed[i % 5];
    }
    ranges[0] = 0.001f;
    ranges[POINTS - 1] = 3.0f;
    jp_localiser_collect(&cloud, POINTS, &scan, &none, 3.0f);
    TEST_ASSERT_EQUAL_INT32(2, cloud.count);
    TEST_ASSERT_NEAR(1.0e-5f, 3.0f, jp_plane_length(points[1].x, points[1].y));
}

/* ---- A match with one wall ---- */

#define WALL 5.0f /* its western face */
#define FAR  2.0f /* the robot from it */

/* Beams of a robot that looks along x at a wall square to it, and where it is by the prior. */
static struct jp_localiser_prior before_wall(float off)
{
    const struct jp_plane_pose pose = {WALL - FAR + off, 2.5f, 0.0f};

    occupy(40, 0, 44, HEIGHT);
    for (int i = -8; i <= 8; i++) {
        add(FAR, 0.1f * (float)i + 0.05f);
    }
    return (struct jp_localiser_prior){.pose = pose, .start = pose, .noise = NOISE};
}

static void know(struct jp_localiser_prior *prior, float x, float y, float heading)
{
    prior->information[0][0] = x;
    prior->information[1][1] = y;
    prior->information[2][2] = heading;
}

/* What all of the ends weigh where they are at the wall. */
static float weight_of_all(void)
{
    return (float)cloud.count / (ALIKE * NOISE * NOISE);
}

static void match(const struct jp_localiser_prior *prior)
{
    jp_localiser_match(&field, &cloud, prior, &fit);
}

/* Nothing is known before: the wall tells its distance and the heading, each end by its arm. */
static void test_a_wall_tells_its_distance_and_the_heading(void)
{
    struct jp_localiser_prior prior = before_wall(0.03f);
    float arms = 0.0f;
    float squares = 0.0f;

    prior.start.heading = 0.04f;
    prior.pose.heading = 0.04f;
    know(&prior, 0.0f, 1.0f, 0.0f);
    match(&prior);
    for (int i = 0; i < cloud.count; i++) {
        arms += points[i].y;
        squares += points[i].y * points[i].y;
    }

    const float unit = weight_of_all() / (float)cloud.count;

    TEST_ASSERT_NEAR(2.0e-3f, WALL - FAR, fit.pose.x);
    TEST_ASSERT_NEAR(1.0e-3f, 2.5f, fit.pose.y);
    TEST_ASSERT_NEAR(1.0e-3f, 0.0f, fit.pose.heading);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, fit.inliers);
    TEST_ASSERT_NEAR(0.02f * weight_of_all(), weight_of_all(), fit.information[0][0]);
    TEST_ASSERT_NEAR(0.02f * unit * squares, unit * squares, fit.information[2][2]);
    TEST_ASSERT_NEAR(0.02f * unit * squares, -unit * arms, fit.information[0][2]);
    TEST_ASSERT_NEAR(0.5f, 1.0f, fit.information[1][1]);
    TEST_ASSERT_NEAR(1.0e-3f, fit.information[0][2], fit.information[2][0]);
}

/* Between the wall and what was known, by the information of each. */
static void test_what_was_known_counts_by_its_information(void)
{
    for (int i = 1; i <= 3; i++) {
        struct jp_localiser_prior prior;
        float share;

        setUp();
        prior = before_wall(0.02f);
        know(&prior, (float)i * weight_of_all(), 1.0e4f, 1.0e6f);
        match(&prior);
        share = 1.0f / (1.0f + (float)i);
        TEST_ASSERT_NEAR(6.0e-4f, WALL - FAR + 0.02f * (1.0f - share), fit.pose.x);
        TEST_ASSERT_NEAR(0.06f, 1.0f + (float)i, fit.information[0][0] / weight_of_all());
        TEST_ASSERT_NEAR(0.05f, (float)i * weight_of_all() * 0.0004f * share * share, fit.surprise);
    }
}

static void test_a_heading_that_is_known_is_pulled_to_as_well(void)
{
    struct jp_localiser_prior prior = before_wall(0.0f);

    prior.pose.heading = 0.02f;
    prior.start.heading = 2.0f * JP_PLANE_PI + 0.02f;
    know(&prior, 1.0e6f, 1.0e6f, 1.0e6f);
    match(&prior);
    TEST_ASSERT_NEAR(2.0e-3f, 0.02f, fit.pose.heading);
}

/* The start is where steps begin; what was known is elsewhere. */
static void test_the_start_is_not_what_was_known(void)
{
    struct jp_localiser_prior prior = before_wall(0.0f);

    prior.start.x += 0.05f;
    prior.start.y += 0.3f;
    know(&prior, 100.0f, 100.0f, 1.0e4f);
    match(&prior);
    TEST_ASSERT_NEAR(1.0e-3f, WALL - FAR, fit.pose.x);
    TEST_ASSERT_NEAR(1.0e-3f, 2.5f, fit.pose.y);
    TEST_ASSERT_NEAR(1.0e-3f, 0.0f, fit.surprise);
}

/* From farther off than three deviations of the noise the influence must begin as wide as the spread. */
static void test_a_spread_draws_it_from_afar(void)
{
    struct jp_localiser_prior prior = before_wall(-0.5f);

    prior.spread = 0.5f;
    know(&prior, 1.0f, 100.0f, 1.0e6f);
    match(&prior);
    TEST_ASSERT_NEAR(5.0e-3f, WALL - FAR, fit.pose.x);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, fit.inliers);
}

/* Who stands before the wall is no wall: half of the ends, and they neither pull nor count. */
static void test_ends_before_the_wall_hardly_pull(void)
{
    struct jp_localiser_prior prior = before_wall(0.01f);

    for (int i = 0; i < 17; i++) {
        add(FAR - 0.9f, 0.1f * (float)(i - 8) + 0.05f);
    }
    know(&prior, 1.0f, 100.0f, 1.0e6f);
    match(&prior);
    TEST_ASSERT_NEAR(2.0e-3f, WALL - FAR + 0.0015f, fit.pose.x);
    TEST_ASSERT_NEAR(1.0e-6f, 0.5f, fit.inliers);
}

/* An end three deviations away has a quarter of the weight, and is no inlier any more. */
static void test_the_influence_of_an_end_falls_with_its_distance(void)
{
    struct jp_localiser_prior prior = before_wall(0.0f);

    for (int i = 0; i < cloud.count; i++) {
        points[i].x = FAR - 3.02f * NOISE;
    }
    know(&prior, 1.0e9f, 1.0e9f, 1.0e9f);
    match(&prior);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, fit.inliers);
    for (int i = 0; i < cloud.count; i++) {
        points[i].x = FAR - 2.98f * NOISE;
    }
    know(&prior, 1.0e5f, 1.0e9f, 1.0e9f);
    match(&prior);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, fit.inliers);
    TEST_ASSERT_NEAR(0.04f, 0.25f, (fit.information[0][0] - 1.0e5f) / weight_of_all());
}

/* A beam does not see a wall from behind. */
static void test_the_far_face_of_a_wall_is_not_seen(void)
{
    struct jp_localiser_prior prior;

    occupy(30, 0, 32, HEIGHT);
    prior = before_wall(0.0f);
    prior.start.x = 32.0f * CELL - FAR;
    prior.pose.x = prior.start.x;
    know(&prior, 1.0f, 1.0f, 1.0f);
    match(&prior);
    TEST_ASSERT_NEAR(1.0e-6f, 0.0f, fit.inliers);
    TEST_ASSERT_NEAR(1.0e-5f, prior.start.x, fit.pose.x);
    TEST_ASSERT_NEAR(1.0e-4f, 1.0f, fit.information[0][0]);
    /* From a sensor beyond it does: the beam is from there. */
    cloud.sensor = (struct jp_plane_point){FAR + 1.0f, 0.0f};
    match(&prior);
    TEST_ASSERT_NEAR(1.0e-6f, 1.0f, fit.inliers);
}

/* A few ends at a wall across are left out where few may not tell. */
static void test_few_ends_do_not_tell_a_direction(void)
{
    struct jp_localiser_prior prior = before_wall(0.0f);

    occupy(0, 36, 40, HEIGHT);
    add(0.0f, 36.0f * CELL - 2.5f - 0.05f);
    know(&prior, 0.1f, 0.1f, 1.0f);
    match(&prior);
    TEST_ASSERT_NEAR(3.0e-3f, 2.55f, fit.pose.y);
    prior.weak = 0.2f;
    match(&prior);
    TEST_ASSERT_NEAR(3.0e-3f, 2.5f, fit.pose.y);
    TEST_ASSERT_NEAR(3.0e-3f, WALL - FAR, fit.pose.x);
    TEST_ASSERT_NEAR(0.01f * weight_of_all(), 0.0f, fit.information[1][1]);
    TEST_ASSERT_NEAR(0.01f * weight_of_all(), 17.0f / 18.0f * weight_of_all(), fit.information[0][0]);
}

static float along(const float vector[3], const struct jp_plane_pose *pose, const struct jp_plane_pose *from)
{
    return vector[0] * (pose->x - from->x) + vector[1] * (pose->y - from->y) +
           vector[2] * (pose->heading - from->heading);
}

/* A direction is one of x, y and the heading together: along it all stays as it was known, and no more is known. */
static void test_a_direction_that_few_ends_tell_may_be_any(void)
{
    struct jp_localiser_prior prior = before_wall(0.02f);
    struct jp_eigen eigen;
    float known[3];

    occupy(0, 36, 40, HEIGHT);
    for (int i = 0; i < 17; i++) {
        points[i].y -= 0.4f;
    }
    add(1.0f, 36.0f * CELL - 2.5f - 0.05f);
    know(&prior, 1.0f, 1.0f, 1.0f);
    match(&prior);
    jp_eigen_find(fit.information, &eigen);
    TEST_ASSERT_TRUE(eigen.values[0] < 0.08f * weight_of_all() && eigen.values[1] > 0.12f * weight_of_all());
    TEST_ASSERT_TRUE(jp_plane_magnitude(along(eigen.vectors[0], &fit.pose, &prior.pose)) > 0.02f);
    prior.weak = 0.1f;
    match(&prior);
    TEST_ASSERT_NEAR(2.0e-3f, 0.0f, along(eigen.vectors[0], &fit.pose, &prior.pose));
    jp_eigen_find(fit.information, &eigen);
    TEST_ASSERT_NEAR(0.05f, 1.0f, eigen.values[0]);
    for (int i = 0; i < 3; i++) {
        known[i] = eigen.vectors[0][0] * fit.information[0][i] + eigen.vectors[0][1] * fit.information[1][i] +
                   eigen.vectors[0][2] * fit.information[2][i];
        TEST_ASSERT_NEAR(0.05f, eigen.vectors[0][i], known[i]);
    }
}

/* By how many deviations it is off the prior, squared: each of x, y and the heading by its own. */
static void test_the_surprise_is_the_square_of_deviations_from_the_prior(void)
{
    for (int i = 0; i < 2; i++) {
        struct jp_localiser_prior prior;
        float y;
        float turn;

        setUp();
        prior = before_wall(0.02f);
        occupy(0, 36, 40, HEIGHT);
        for (int k = -4; k <= 4; k++) {
            add(0.1f * (float)k - 0.3f, 36.0f * CELL - 2.5f - 0.01f);
        }
        prior.pose.heading = i == 0 ? 0.03f : -0.02f;
        prior.start.heading = prior.pose.heading;
        know(&prior, 30.0f, 20.0f, 10.0f);
        prior.information[0][1] = 5.0f;
        prior.information[1][0] = 5.0f;
        prior.information[1][2] = -4.0f;
        prior.information[2][1] = -4.0f;
        match(&prior);
        y = fit.pose.y - prior.pose.y;
        turn = fit.pose.heading - prior.pose.heading;

        const float x = fit.pose.x - prior.pose.x;

        TEST_ASSERT_NEAR(3.0e-3f, 0.01f, y);
        TEST_ASSERT_NEAR(3.0e-3f, -prior.pose.heading, turn);
        TEST_ASSERT_NEAR(1.0e-6f, 30.0f * x * x + 20.0f * y * y + 10.0f * turn * turn + 10.0f * x * y - 8.0f * y * turn,
                         fit.surprise);
    }
}

/* Turned by a quarter, and all of the map with it, the match is the same. */
static void test_a_match_turns_with_the_map(void)
{
    struct jp_localiser_prior prior;

    occupy(0, 30, WIDTH, 34);
    for (int i = -8; i <= 8; i++) {
        add(1.5f, 0.1f * (float)i + 0.05f);
    }
    prior =
        (struct jp_localiser_prior){.pose = {4.0f, 30.0f * CELL - 1.48f, 0.5f * JP_PLANE_PI + 0.03f}, .noise = NOISE};
    prior.start = prior.pose;
    know(&prior, 1.0f, 0.0f, 0.0f);
    match(&prior);
    TEST_ASSERT_NEAR(1.0e-3f, 4.0f, fit.pose.x);
    TEST_ASSERT_NEAR(2.0e-3f, 30.0f * CELL - 1.5f, fit.pose.y);
    TEST_ASSERT_NEAR(1.0e-3f, 0.5f * JP_PLANE_PI, fit.pose.heading);
    TEST_ASSERT_NEAR(0.02f * weight_of_all(), weight_of_all(), fit.information[1][1]);
}

/* Without any information there is no step, and nothing is said of the fit. */
static void test_without_information_it_stays_where_it_began(void)
{
    struct jp_localiser_prior prior = before_wall(0.02f);

    match(&prior);
    TEST_ASSERT_NEAR(0.0f, prior.start.x, fit.pose.x);
    TEST_ASSERT_NEAR(0.0f, prior.start.y, fit.pose.y);
    TEST_ASSERT_NEAR(0.0f, 0.0f, fit.inliers);
    TEST_ASSERT_NEAR(0.0f, 0.0f, fit.surprise);
}

/* ---- What the map says of beams ---- */

/* Two walls across x, at 3 m and 5 m; the robot looks along x from 1 m. */
static void between_walls(void)
{
    occupy(24, 0, 26, HEIGHT);
    occupy(40, 0, 42, HEIGHT);
}

static void compare(int32_t stride)
{
    const struct jp_plane_pose pose = {1.0f, 2.5f, 0.0f};

    jp_localiser_compare(&field, &cloud, stride, &pose, NOISE, &view);
}

static void expect_view(int explained, int behind, int beyond)
{
    TEST_ASSERT_EQUAL_UINT16(cloud.count, view.beams);
    TEST_ASSERT_EQUAL_UINT16(explained, view.explained);
    TEST_ASSERT_EQUAL_UINT16(behind, view.behind);
    TEST_ASSERT_EQUAL_UINT16(beyond, view.beyond);
    TEST_ASSERT_EQUAL_UINT16(0, view.empty);
    TEST_ASSERT_EQUAL_UINT16(0, view.open);
}

static void test_beams_end_at_the_first_wall_or_do_not(void)
{
    between_walls();
    add(2.0f, 0.1f);
    compare(1);
    expect_view(1, 0, 0);
    add(2.0f + 3.9f * NOISE, 0.2f);
    add(2.0f - 3.9f * NOISE, 0.3f);
    compare(1);
    expect_view(3, 0, 0);
    add(2.0f - 4.1f * NOISE, 0.0f);
    add(1.0f, 0.0f);
    compare(1);
    expect_view(3, 0, 0);
    add(4.0f, -0.2f);
    compare(1);
    expect_view(3, 1, 0);
    add(3.4f, -0.3f);
    add(3.2f, -0.3f);
    compare(1);
    expect_view(3, 1, 2);
}

/* Up to three cells behind the first face of a wall it is that wall, as after a step of the ray. */
static void test_so_far_behind_a_wall_a_beam_has_passed_through_it(void)
{
    occupy(24, 0, 60, HEIGHT);
    for (int i = 0; i < 2; i++) {
        const bool is_through = i == 1;

        cloud.count = 0;
        add(2.0f + (is_through ? 4.2f : 2.6f) * CELL, 0.1f);
        compare(1);
        expect_view(0, 0, is_through ? 1 : 0);
    }
}

static void test_every_so_many_th_end_is_compared(void)
{
    between_walls();
    for (int i = 0; i < 30; i++) {
        add(i % 3 == 0 ? 2.0f : 1.0f, 0.02f * (float)i);
    }
    for (int32_t stride = 1; stride < 8; stride++) {
        unsigned at_wall = 0;

        for (int32_t i = 0; i < 30; i += stride) {
            at_wall += i % 3 == 0 ? 1U : 0U;
        }
        compare(stride);
        TEST_ASSERT_EQUAL_UINT16((30 + stride - 1) / stride, view.beams);
        TEST_ASSERT_EQUAL_UINT16(at_wall, view.explained);
    }
}

/* Beams come from the sensor, which turns with the robot. */
static void test_beams_come_from_where_the_sensor_is(void)
{
    const struct jp_plane_pose turned = {3.6f, 2.5f, JP_PLANE_PI};

    between_walls();
    cloud.sensor = (struct jp_plane_point){-0.1f, 0.2f};
    add(-1.4f, 0.3f);
    jp_localiser_compare(&field, &cloud, 1, &turned, NOISE, &view);
    expect_view(1, 0, 0);
    cloud.sensor = (struct jp_plane_point){1.4f, 0.2f};
    jp_localiser_compare(&field, &cloud, 1, &turned, NOISE, &view);
    expect_view(0, 1, 0);
}

/* ---- What sees nothing ---- */

static void test_beams_that_see_nothing_are_told_apart_from_those_that_failed(void)
{
    const struct jp_plane_pose pose = {1.0f, 1.0f, 0.3f};
    const float told[] = {0.0f, -1.0f, 3.001f, __builtin_inff(), 1.0f, __builtin_nanf("")};
    struct jp_localiser_input input = {.scan = scan};

    for (int i = 0; i < POINTS; i++) {
        ranges[i] = told[i % 6];
    }
    for (int32_t stride = 1; stride < 7; stride++) {
        view = (struct jp_localiser_view){0};
        jp_localiser_compare_empty(&field, &input, 3.0f, stride, &pose, &view);
        TEST_ASSERT_EQUAL_UINT16((POINTS / 3 + stride - 1) / stride, view.empty);
    }
}

/* From between walls at 0 and at `high`. */
static float way_to(float from, float share, float high)
{
    if (share > 0.001f) {
        return (high - from) / share;
    }
    return share < -0.001f ? from / -share : 100.0f;
}

/* The map shows a wall on the way of those that look at it; where it is about at the end of the range none look. */
static void test_the_map_shows_nothing_in_the_open(void)
{
    struct jp_localiser_input input = {.sensor = {0.2f, 0.1f, -0.4f}, .scan = {ranges, POINTS, -2.4f, 0.1f}};
    const struct jp_plane_pose pose = {1.7f, 1.3f, 0.1f};
    unsigned open = 0;

    between_walls();
    for (int i = 0; i < POINTS; i++) {
        const float bearing = 0.1f - 0.4f - 2.4f + 0.1f * (float)i;
        const struct jp_plane_pose scanner = jp_plane_compose(&pose, &input.sensor);
        const struct jp_plane_point along_beam = jp_plane_direction(bearing);
        const float x = way_to(scanner.x, along_beam.x, 3.0f);
        const float way = jp_plane_smaller(x, way_to(scanner.y, along_beam.y, (float)HEIGHT * CELL));

        ranges[i] = way > 2.2f || way < 1.7f ? 0.0f : -1.0f;
        open += way > 2.2f ? 1U : 0U;
    }
    view = (struct jp_localiser_view){0};
    jp_localiser_compare_empty(&field, &input, 2.0f, 1, &pose, &view);
    TEST_ASSERT_TRUE(open > 5U && open < view.empty);
    TEST_ASSERT_EQUAL_UINT16(open, view.open);
}
