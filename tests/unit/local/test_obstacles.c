/* Distances of a footprint from shapes worked out by hand, and which shapes are kept. */
#include <joulepath/obstacles.h>

#include "src/base/plane.h"
#include "src/local/obstacle_distance.h"

#include "tests/support/near.h"

#define TOLERANCE 2e-6f
#define HALF_TURN JP_PLANE_PI

static const struct jp_footprint footprint = {.front = 0.5f, .rear = 0.25f, .half_width = 0.25f};
static const struct jp_plane_pose origin = {0.0f, 0.0f, 0.0f};

static struct jp_obstacles obstacles;

void setUp(void)
{
    jp_obstacles_clear(&obstacles, &(struct jp_plane_point){0.0f, 0.0f});
}

void tearDown(void)
{
}

static struct jp_obstacle disc(float x, float y, float radius)
{
    return (struct jp_obstacle){.vertices = {{x, y}}, .vertex_count = 1, .radius = radius};
}

static struct jp_obstacle capsule(float x0, float y0, float x1, float y1, float radius)
{
    return (struct jp_obstacle){.vertices = {{x0, y0}, {x1, y1}}, .vertex_count = 2, .radius = radius};
}

static struct jp_obstacle box(float x0, float y0, float x1, float y1)
{
    return (struct jp_obstacle){.vertices = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, .vertex_count = 4};
}

static void expect(float distance, struct jp_plane_pose gradient, const struct jp_plane_pose *pose,
                   const struct jp_obstacle *shape)
{
    struct jp_plane_pose actual;

    TEST_ASSERT_NEAR(TOLERANCE, distance, jp_obstacle_distance(&footprint, pose, shape, &actual));
    TEST_ASSERT_NEAR(TOLERANCE, distance, jp_obstacle_distance(&footprint, pose, shape, NULL));
    TEST_ASSERT_NEAR(TOLERANCE, gradient.x, actual.x);
    TEST_ASSERT_NEAR(TOLERANCE, gradient.y, actual.y);
    TEST_ASSERT_NEAR(TOLERANCE, gradient.heading, actual.heading);
}

/* ---- Apart ---- */

static void test_disc_beyond_each_side_of_the_footprint(void)
{
    const struct jp_obstacle ahead = disc(2.5f, 0.125f, 0.5f);
    const struct jp_obstacle behind = disc(-1.25f, 0.0f, 0.5f);
    const struct jp_obstacle left = disc(0.25f, 1.25f, 0.5f);
    const struct jp_obstacle right = disc(0.0f, -1.25f, 0.5f);

    expect(1.5f, (struct jp_plane_pose){-1.0f, 0.0f, 0.125f}, &origin, &ahead);
    expect(0.5f, (struct jp_plane_pose){1.0f, 0.0f, 0.0f}, &origin, &behind);
    expect(0.5f, (struct jp_plane_pose){0.0f, -1.0f, -0.25f}, &origin, &left);
    expect(0.5f, (struct jp_plane_pose){0.0f, 1.0f, 0.0f}, &origin, &right);
}

static void test_disc_off_a_corner(void)
{
    const struct jp_obstacle shape = disc(0.5f + 0.3f, 0.25f + 0.4f, 0.1f);

    expect(0.4f, (struct jp_plane_pose){-0.6f, -0.8f, 0.5f * -0.8f + 0.25f * 0.6f}, &origin, &shape);
}

static void test_turned_robot_measures_with_its_sides(void)
{
    const struct jp_plane_pose north = {1.0f, 1.0f, HALF_TURN / 2.0f};
    const struct jp_plane_pose also_north = {1.0f, 1.0f, -1.5f * HALF_TURN};
    const struct jp_obstacle ahead = disc(1.0f, 3.0f, 0.5f);

    expect(1.0f, (struct jp_plane_pose){0.0f, -1.0f, 0.0f}, &north, &ahead);
    expect(1.0f, (struct jp_plane_pose){0.0f, -1.0f, 0.0f}, &also_north, &ahead);
}

static void test_corner_is_nearest_to_a_wall(void)
{
    /* The wall y = 1 + x; the left rear corner (−0.25, 0.25) is nearest. */
    const struct jp_obstacle wall = capsule(-5.0f, -4.0f, 5.0f, 6.0f, 0.0f);
    const struct jp_obstacle backward = capsule(5.0f, 6.0f, -5.0f, -4.0f, 0.0f);
    const float root = 0.707106781f;

    /* It turns about the pose along the wall. */
    expect(0.5f * root, (struct jp_plane_pose){root, -root, 0.0f}, &origin, &wall);
    expect(0.5f * root, (struct jp_plane_pose){root, -root, 0.0f}, &origin, &backward);
}

static void test_end_of_a_wall_is_nearest(void)
{
    const struct jp_obstacle wall = capsule(1.0f, 0.0f, 4.0f, 3.0f, 0.125f);

    expect(0.375f, (struct jp_plane_pose){-1.0f, 0.0f, 0.0f}, &origin, &wall);
}

static void test_wall_in_line_with_the_axis(void)
{
    const struct jp_obstacle wall = capsule(2.0f, 0.0f, 5.0f, 0.0f, 0.0f);

    expect(1.5f, (struct jp_plane_pose){-1.0f, 0.0f, 0.0f}, &origin, &wall);
}

static void test_polygon_apart(void)
{
    const struct jp_obstacle east = box(1.0f, -1.0f, 2.0f, 1.0f);
    const struct jp_obstacle diamond = {
        .vertices = {{2.0f, 0.0f}, {3.0f, 1.0f}, {2.0f, 2.0f}, {1.0f, 1.0f}}, .vertex_count = 4, .radius = 0.125f};
    const float root = 0.707106781f;

    TEST_ASSERT_NEAR(TOLERANCE, 0.5f, jp_obstacle_distance(&footprint, &origin, &east, NULL));
    /* The left front corner (0.5, 0.25) under the side x + y = 2. */
    expect(1.25f * root - 0.125f, (struct jp_plane_pose){-root, -root, 0.5f * -root - 0.25f * -root}, &origin,
           &diamond);
}

/* ---- Overlapping ---- */

static void test_nose_through_a_wall_goes_back(void)
{
    /* Forward it would be less, but the pose is on this side. */
    const struct jp_obstacle wall = capsule(0.0625f, -3.0f, 0.0625f, 3.0f, 0.125f);
    const struct jp_obstacle turned = capsule(0.0625f, 3.0f, 0.0625f, -3.0f, 0.125f);

    TEST_ASSERT_NEAR(TOLERANCE, -0.4375f - 0.125f, jp_obstacle_distance(&footprint, &origin, &wall, NULL));
    TEST_ASSERT_NEAR(TOLERANCE, -0.4375f - 0.125f, jp_obstacle_distance(&footprint, &origin, &turned, NULL));

    struct jp_plane_pose gradient;

    (void)jp_obstacle_distance(&footprint, &origin, &wall, &gradient);
    TEST_ASSERT_NEAR(TOLERANCE, -1.0f, gradient.x);
    TEST_ASSERT_NEAR(TOLERANCE, 0.0f, gradient.y);
}

static void test_tail_through_a_wall_goes_forward(void)
{
    const struct jp_obstacle wall = capsule(-0.0625f, -3.0f, -0.125f, 3.0f, 0.0f);
    struct jp_plane_pose gradient;

    TEST_ASSERT_TRUE(jp_obstacle_distance(&footprint, &origin, &wall, &gradient) < -0.125f);
    TEST_ASSERT_TRUE(gradient.x > 0.99f);
}

static void test_post_inside_goes_out_by_the_nearest_side(void)
{
    const struct jp_obstacle left = disc(0.125f, 0.125f, 0.0f);
    const struct jp_obstacle right = disc(0.125f, -0.125f, 0.0f);
    const struct jp_obstacle ahead = disc(0.4375f, 0.0f, 0.0625f);
    const struct jp_obstacle behind = disc(-0.1875f, 0.0f, 0.0f);

    expect(-0.125f, (struct jp_plane_pose){0.0f, -1.0f, -0.125f}, &origin, &left);
    expect(-0.125f, (struct jp_plane_pose){0.0f, 1.0f, 0.125f}, &origin, &right);
    expect(-0.125f, (struct jp_plane_pose){-1.0f, 0.0f, 0.0f}, &origin, &ahead);
    expect(-0.0625f, (struct jp_plane_pose){1.0f, 0.0f, 0.0f}, &origin, &behind);
}

static void test_end_of_a_wall_inside(void)
{
    const struct jp_obstacle wall = capsule(0.25f, 0.1875f, 0.25f, 3.0f, 0.0f);

    expect(-0.0625f, (struct jp_plane_pose){0.0f, -1.0f, -0.25f}, &origin, &wall);
}

static void test_pose_inside_a_polygon_takes_the_least_way(void)
{
    const struct jp_obstacle shape = box(-0.125f, -1.0f, 5.0f, 7.0f);
    struct jp_plane_pose gradient;

    TEST_ASSERT_NEAR(TOLERANCE, -0.625f, jp_obstacle_distance(&footprint, &origin, &shape, &gradient));
    TEST_ASSERT_NEAR(TOLERANCE, -1.0f, gradient.x);
}

static void test_footprint_pierced_by_a_corner(void)
{
    /* Its left side x + y = 0.5 is nearest to the left front corner's way out. */
    const struct jp_obstacle diamond = {.vertices = {{0.25f, 0.25f}, {1.25f, -0.75f}, {2.25f, 0.25f}, {1.25f, 1.25f}},
                                        .vertex_count = 4};
    struct jp_plane_pose gradient;
    const float distance = jp_obstacle_distance(&footprint, &origin, &diamond, &gradient);

    TEST_ASSERT_NEAR(TOLERANCE, -0.25f * 0.707106781f, distance);
    TEST_ASSERT_NEAR(TOLERANCE, -0.707106781f, gradient.x);
    TEST_ASSERT_NEAR(TOLERANCE, -0.707106781f, gradient.y);
}

static void test_touching_has_a_gradient(void)
{
    const struct jp_obstacle wall = capsule(0.5f, -3.0f, 0.5f, 3.0f, 0.0f);
    const struct jp_obstacle corner = disc(0.5f, 0.25f, 0.0f);
    struct jp_plane_pose gradient;

    expect(0.0f, (struct jp_plane_pose){-1.0f, 0.0f, -0.25f}, &origin, &wall);
    TEST_ASSERT_NEAR(TOLERANCE, 0.0f, jp_obstacle_distance(&footprint, &origin, &corner, &gradient));
    TEST_ASSERT_NEAR(TOLERANCE, 1.0f, gradient.x * gradient.x + gradient.y * gradient.y);
}

static void test_all_but_touching_has_the_gradient_of_a_side(void)
{
    const struct jp_obstacle ahead = disc(0.50005f, 0.0f, 0.0f);

    expect(0.00005f, (struct jp_plane_pose){-1.0f, 0.0f, 0.0f}, &origin, &ahead);
}

static void test_vertices_may_coincide(void)
{
    const struct jp_obstacle twice = capsule(0.125f, 0.125f, 0.125f, 0.125f, 0.0f);
    const struct jp_obstacle far = capsule(2.5f, 0.0f, 2.5f, 0.0f, 0.5f);

    expect(-0.125f, (struct jp_plane_pose){0.0f, -1.0f, -0.125f}, &origin, &twice);
    expect(1.5f, (struct jp_plane_pose){-1.0f, 0.0f, 0.0f}, &origin, &far);
}

/* ---- The set ---- */

static void test_nothing_is_near_an_empty_set(void)
{
    TEST_ASSERT_TRUE(jp_obstacles_distance(&obstacles, &footprint, &origin) == JP_OBSTACLE_NONE);
}

static void add(const struct jp_obstacle *shape)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&obstacles, shape));
}

static void test_shapes_are_kept_in_order_of_distance(void)
{
    const struct jp_obstacle far = disc(5.0f, 0.0f, 1.0f);
    const struct jp_obstacle near = disc(0.0f, 2.0f, 1.0f);
    const struct jp_obstacle around = box(-1.0f, -1.0f, 1.0f, 1.0f);

    add(&far);
    add(&near);
    add(&around);
    TEST_ASSERT_EQUAL_UINT(3, obstacles.count);
    TEST_ASSERT_NEAR(TOLERANCE, -1.0f, obstacles.distance[0]);
    TEST_ASSERT_NEAR(TOLERANCE, 1.0f, obstacles.distance[1]);
    TEST_ASSERT_NEAR(TOLERANCE, 4.0f, obstacles.distance[2]);
    TEST_ASSERT_EQUAL_UINT(4, obstacles.shapes[0].vertex_count);
    TEST_ASSERT_NEAR(TOLERANCE, 2.0f, obstacles.shapes[1].vertices[0].y);
    TEST_ASSERT_NEAR(TOLERANCE, 5.0f, obstacles.shapes[2].vertices[0].x);
    TEST_ASSERT_EQUAL_UINT32(0, obstacles.dropped);
}

static void test_the_farthest_is_dropped_and_counted(void)
{
    for (int i = 0; i < JP_OBSTACLES_MAX; i++) {
        const struct jp_obstacle shape = disc(10.0f + (float)i, 0.0f, 1.0f);

        add(&shape);
    }

    const struct jp_obstacle farther = disc(100.0f, 0.0f, 1.0f);
    const struct jp_obstacle nearer = disc(5.0f, 0.0f, 1.0f);

    add(&farther);
    TEST_ASSERT_EQUAL_UINT(JP_OBSTACLES_MAX, obstacles.count);
    TEST_ASSERT_EQUAL_UINT32(1, obstacles.dropped);
    TEST_ASSERT_NEAR(TOLERANCE, 28.0f, obstacles.distance[JP_OBSTACLES_MAX - 1]);
    add(&nearer);
    TEST_ASSERT_EQUAL_UINT(JP_OBSTACLES_MAX, obstacles.count);
    TEST_ASSERT_EQUAL_UINT32(2, obstacles.dropped);
    TEST_ASSERT_NEAR(TOLERANCE, 4.0f, obstacles.distance[0]);
    TEST_ASSERT_NEAR(TOLERANCE, 27.0f, obstacles.distance[JP_OBSTACLES_MAX - 1]);

    jp_obstacles_clear(&obstacles, &(struct jp_plane_point){1.0f, 0.0f});
    TEST_ASSERT_EQUAL_UINT(0, obstacles.count);
    TEST_ASSERT_EQUAL_UINT32(0, obstacles.dropped);
    add(&nearer);
    TEST_ASSERT_NEAR(TOLERANCE, 3.0f, obstacles.distance[0]);
}

static void test_only_shape_is_the_nearest(void)
{
    const struct jp_obstacle far = disc(0.0f, 50.0f, 1.0f);

    add(&far);
    TEST_ASSERT_NEAR(10 * TOLERANCE, 48.75f, jp_obstacles_distance(&obstacles, &footprint, &origin));
}

static void test_first_of_two_near_shapes_is_the_nearest(void)
{
    const struct jp_obstacle first = disc(0.0f, 2.0f, 1.0f);
    const struct jp_obstacle second = disc(0.0f, -2.25f, 1.0f);

    add(&first);
    add(&second);
    TEST_ASSERT_NEAR(TOLERANCE, 0.75f, jp_obstacles_distance(&obstacles, &footprint, &origin));
}

static void test_nearest_of_all_shapes(void)
{
    const struct jp_obstacle first = disc(0.0f, 4.0f, 1.0f);
    const struct jp_obstacle second = disc(5.0f, 0.0f, 1.0f);
    const struct jp_obstacle third = disc(0.0f, 50.0f, 1.0f);
    const struct jp_plane_pose beside_second = {3.0f, 0.0f, 0.0f};
    const struct jp_plane_pose backward = {3.0f, 0.0f, HALF_TURN};
    const struct jp_footprint tail = {0.25f, 0.5f, 0.25f};
    const struct jp_plane_pose in_second = {5.0f, 0.0f, 0.0f};

    add(&first);
    add(&second);
    add(&third);
    TEST_ASSERT_NEAR(TOLERANCE, 2.75f, jp_obstacles_distance(&obstacles, &footprint, &origin));
    TEST_ASSERT_NEAR(TOLERANCE, 0.5f, jp_obstacles_distance(&obstacles, &footprint, &beside_second));
    TEST_ASSERT_NEAR(TOLERANCE, 0.5f, jp_obstacles_distance(&obstacles, &tail, &backward));
    TEST_ASSERT_NEAR(TOLERANCE, -1.25f, jp_obstacles_distance(&obstacles, &footprint, &in_second));
}

/* ---- What is no shape ---- */

static void refuse(const struct jp_obstacle *shape)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_obstacles_add(&obstacles, shape));
    TEST_ASSERT_EQUAL_UINT(0, obstacles.count);
}

static void test_values_out_of_range_are_refused(void)
{
    volatile float large = FLT_MAX; /* the compiler must not see that it overflows */
    const float not_a_number = large * 2.0f - large * 2.0f;
    struct jp_obstacle shape = disc(0.0f, 0.0f, -0.001f);

    refuse(&shape);
    shape = disc(0.0f, 0.0f, 32768.0f);
    refuse(&shape);
    shape = disc(0.0f, 0.0f, not_a_number);
    refuse(&shape);
    shape = disc(-32768.0f, 0.0f, 0.0f);
    refuse(&shape);
    shape = disc(0.0f, 32768.0f, 0.0f);
    refuse(&shape);
    shape = disc(0.0f, not_a_number, 0.0f);
    refuse(&shape);
    shape = capsule(0.0f, 0.0f, not_a_number, 0.0f, 0.0f);
    refuse(&shape);
    shape = disc(-32767.0f, 32767.0f, 32767.0f);
    add(&shape);
}

static void refuse_motion(float x, float y, float margin)
{
    struct jp_obstacle shape = disc(1.0f, 0.0f, 0.1f);

    shape.velocity = (struct jp_plane_point){x, y};
    shape.margin = margin;
    refuse(&shape);
}

static void test_motions_out_of_range_are_refused(void)
{
    volatile float large = FLT_MAX;
    const float not_a_number = large * 2.0f - large * 2.0f;
    const float speed_max = JP_OBSTACLE_SPEED_MAX;
    const float margin_max = JP_OBSTACLE_MARGIN_MAX;
    struct jp_obstacle shape = disc(1.0f, 0.0f, 0.1f);

    refuse_motion(not_a_number, 0.0f, 0.0f);
    refuse_motion(0.0f, not_a_number, 0.0f);
    refuse_motion(1.0e30f, 0.0f, 0.0f);
    refuse_motion(0.0f, -1.001f * speed_max, 0.0f);
    refuse_motion(0.0f, 0.0f, not_a_number);
    refuse_motion(0.0f, 0.0f, -0.001f);
    refuse_motion(0.0f, 0.0f, 1.001f * margin_max);
    shape.velocity = (struct jp_plane_point){-speed_max, speed_max};
    shape.margin = margin_max;
    add(&shape);
}

static void test_no_vertices_or_too_many_are_refused(void)
{
    struct jp_obstacle shape = disc(0.0f, 0.0f, 1.0f);

    shape.vertex_count = 0;
    refuse(&shape);
    shape.vertex_count = JP_OBSTACLE_VERTICES_MAX + 1;
    refuse(&shape);
}

static void test_polygons_must_be_convex_and_counterclockwise(void)
{
    const struct jp_obstacle clockwise = {.vertices = {{0.0f, 0.0f}, {0.0f, 1.0f}, {1.0f, 0.0f}}, .vertex_count = 3};
    const struct jp_obstacle dart = {.vertices = {{0.0f, 0.0f}, {2.0f, 0.0f}, {0.5f, 0.5f}, {0.0f, 2.0f}},
                                     .vertex_count = 4};
    const struct jp_obstacle triangle = {.vertices = {{1.0f, 0.0f}, {2.0f, 0.0f}, {1.0f, 1.0f}}, .vertex_count = 3};

    refuse(&clockwise);
    refuse(&dart);
    add(&triangle);
}

static void test_null_pointers_are_refused(void)
{
    const struct jp_obstacle shape = disc(0.0f, 0.0f, 1.0f);

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_obstacles_add(NULL, &shape));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_obstacles_add(&obstacles, NULL));
}

/* ---- The feature that was nearest ---- */

/* On a way past a shape and through it, remembering the feature gives the same distances. */
static void pass(const struct jp_obstacle *shape)
{
    uint8_t feature = JP_FEATURE_UNKNOWN;
    unsigned changes = 0;

    for (int i = 0; i < 2000; i++) {
        const struct jp_plane_pose pose = {2.0f * jp_plane_sine(0.011f * (float)i),
                                           1.5f * jp_plane_sine(0.017f * (float)i), 0.02f * (float)i};
        const struct jp_plane_point direction = jp_plane_direction(pose.heading);
        const uint8_t last = feature;
        struct jp_plane_pose expected;
        struct jp_plane_pose gradient;
        const float distance = jp_obstacle_distance(&footprint, &pose, shape, &expected);

        TEST_ASSERT_NEAR(TOLERANCE, distance,
                         jp_obstacle_distance_along(&footprint, &pose, direction, shape, &feature, &gradient));
        TEST_ASSERT_NEAR(1e-3f, expected.x, gradient.x);
        TEST_ASSERT_NEAR(1e-3f, expected.y, gradient.y);
        TEST_ASSERT_NEAR(1e-3f, expected.heading, gradient.heading);
        TEST_ASSERT_TRUE((feature == JP_FEATURE_UNKNOWN) == (distance + shape->radius < 1e-4f));
        changes += feature != last ? 1U : 0U;
    }
    TEST_ASSERT_TRUE(changes > 0U && changes < 400U);
}

static void test_remembered_features_change_no_distance(void)
{
    const struct jp_obstacle shapes[] = {disc(0.3f, 0.4f, 0.0f),
                                         capsule(-0.6f, 0.4f, 0.5f, -0.2f, 0.05f),
                                         box(-0.4f, -0.3f, 0.3f, 0.1f),
                                         {.vertices = {{0.4f, 0.0f}, {0.6f, 0.5f}, {-0.2f, 0.3f}}, .vertex_count = 3}};

    for (unsigned i = 0; i < sizeof shapes / sizeof shapes[0]; i++) {
        pass(&shapes[i]);
    }
}

static void test_touching_is_no_feature(void)
{
    const struct jp_obstacle corner = box(0.5f, 0.25f, 1.0f, 1.0f);
    uint8_t feature = 4; /* the vertex that touches */

    (void)jp_obstacle_distance_along(&footprint, &origin, (struct jp_plane_point){1.0f, 0.0f}, &corner, &feature, NULL);
    TEST_ASSERT_EQUAL_UINT(JP_FEATURE_UNKNOWN, feature);
}

/* ---- Bits ---- */

static void test_same_bits_everywhere(void)
{
    const struct jp_obstacle shapes[] = {disc(0.3f, 0.9f, 0.2f), capsule(-1.1f, 0.4f, 0.9f, 0.7f, 0.05f),
                                         box(0.4f, -0.8f, 1.3f, 0.1f)};
    uint32_t hash = BITS_HASH_START;

    for (int i = 0; i < 1000; i++) {
        const struct jp_plane_pose pose = {0.003f * (float)(i % 300) - 0.4f, 0.002f * (float)i - 1.0f,
                                           0.13f * (float)i};

        for (unsigned k = 0; k < sizeof shapes / sizeof shapes[0]; k++) {
            struct jp_plane_pose gradient;

            hash = hash_bits(hash, jp_obstacle_distance(&footprint, &pose, &shapes[k], &gradient));
            hash = hash_bits(hash, gradient.x);
            hash = hash_bits(hash, gradient.y);
            hash = hash_bits(hash, gradient.heading);
        }
    }
    TEST_ASSERT_EQUAL_HEX32(0x5B46657CU, hash);
}
