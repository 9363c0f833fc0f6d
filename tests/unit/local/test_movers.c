/* Discs and walls that a synthetic scanner sees: which shapes get their velocity, and what is refused. Which of them
 * are things: test_movers_things.c; how they are tracked: test_movers_track.c; who is known to walk:
 * test_movers_walk.c. */
#include "tests/support/movers_rig.h"

void setUp(void)
{
    movers_rig_start();
}

void tearDown(void)
{
}

/* ---- Shapes ---- */

static void test_shapes_of_a_walker_get_its_velocity(void)
{
    const struct jp_plane_point velocity = {0.5f, 1.0f};
    struct disc *const walker = put_disc(1.0f, -1.5f, RADIUS);

    (void)put_disc(-2.0f, 0.0f, RADIUS);
    walk(walker, velocity, SETTLED);
    see_shapes();
    TEST_ASSERT_TRUE(obstacles.count >= 2);
    for (unsigned i = 0; i < obstacles.count; i++) {
        const struct jp_obstacle *const shape = &obstacles.shapes[i];

        if (shape->vertices[0].x > 0.0f) {
            TEST_ASSERT_NEAR(SPEED_ERROR, velocity.x, shape->velocity.x);
            TEST_ASSERT_NEAR(SPEED_ERROR, velocity.y, shape->velocity.y);
            TEST_ASSERT_TRUE(shape->margin == config.margin);
        } else {
            TEST_ASSERT_FALSE(is_marked(shape));
        }
    }
}

static void test_velocity_is_believed_after_some_sightings(void)
{
    struct disc *const walker = put_disc(2.0f, -1.0f, 0.1f);

    for (unsigned i = 1; i <= SIGHTINGS_MIN; i++) {
        walk(walker, (struct jp_plane_point){0.0f, 1.5f}, 1);
        TEST_ASSERT_TRUE(movers.movers[0].velocity.y > config.speed_min || i < 3U);
        see_shapes();
        TEST_ASSERT_EQUAL_UINT(i < SIGHTINGS_MIN ? 0 : obstacles.count, marked());
    }
    TEST_ASSERT_TRUE(obstacles.count > 0);
}

static void test_slow_things_stand(void)
{
    struct disc *const walker = put_disc(2.0f, -0.5f, RADIUS);

    walk(walker, (struct jp_plane_point){0.0f, 0.15f}, SETTLED);
    see_shapes();
    TEST_ASSERT_EQUAL_UINT(0, marked());
    TEST_ASSERT_FALSE(has_walked(0));
    walk(walker, (struct jp_plane_point){0.0f, 1.0f}, SETTLED);
    see_shapes();
    TEST_ASSERT_EQUAL_UINT(obstacles.count, marked());
    config.speed_min = 1.5f;
    see_shapes();
    TEST_ASSERT_EQUAL_UINT(0, marked());
}

/* Driving past it at 1 m/s, 1.2 m beside it, and turning: what is seen of it changes all the time. */
static void test_standing_pillar_seen_on_the_way_is_not_marked(void)
{
    (void)put_disc(0.0f, 1.2f, 0.3f);
    sensor = (struct jp_plane_pose){-3.0f, 0.0f, 0.0f};
    for (unsigned i = 0; i < 60U; i++) {
        look();
        TEST_ASSERT_EQUAL_UINT(1, movers.count);
        TEST_ASSERT_EQUAL_UINT(i + 1U, movers.movers[0].sightings);
        see_shapes();
        TEST_ASSERT_TRUE(obstacles.count > 0);
        TEST_ASSERT_EQUAL_UINT(0, marked());
        sensor.x += PERIOD;
        sensor.heading += 0.5f * PERIOD;
    }
}

/* A walker at a place, to be put beside shapes that no scan made. */
static void put_walker(void)
{
    movers.movers[0] = (struct jp_mover){.centre = {2.0f, 1.0f},
                                         .velocity = {0.0f, 1.0f},
                                         .radius = 0.2f,
                                         .speed_variance = 0.01f,
                                         .walk = {0.0f, 1.0f},
                                         .pace = 1.0f,
                                         .sightings = SIGHTINGS_MIN};
    movers.count = 1;
}

static bool is_marked_between(struct jp_plane_point a, struct jp_plane_point b, uint8_t vertices)
{
    const struct jp_obstacle shape = {.vertices = {a, b}, .vertex_count = vertices, .radius = 0.01f};

    jp_obstacles_clear(&obstacles, &a);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&obstacles, &shape));
    jp_movers_mark(&movers, &config, &obstacles);
    return is_marked(&obstacles.shapes[0]);
}

static void test_shapes_beside_a_walker_stand(void)
{
    const struct jp_plane_point within = {2.3f, 1.0f};
    const struct jp_plane_point beyond = {2.4f, 1.0f};

    put_walker();
    TEST_ASSERT_TRUE(is_marked_between(within, within, 1));
    TEST_ASSERT_FALSE(is_marked_between(beyond, beyond, 1));
    TEST_ASSERT_TRUE(is_marked_between((struct jp_plane_point){2.3f, 0.8f}, (struct jp_plane_point){2.3f, 1.2f}, 2));
    TEST_ASSERT_FALSE(is_marked_between((struct jp_plane_point){2.4f, 0.8f}, (struct jp_plane_point){2.4f, 1.2f}, 2));
}

static void test_wall_that_a_walker_passes_stands(void)
{
    put_walker();
    TEST_ASSERT_TRUE(is_marked_between((struct jp_plane_point){2.1f, 0.7f}, (struct jp_plane_point){2.1f, 1.3f}, 2));
    TEST_ASSERT_FALSE(is_marked_between((struct jp_plane_point){2.1f, 0.6f}, (struct jp_plane_point){2.1f, 1.4f}, 2));
    TEST_ASSERT_FALSE(is_marked_between((struct jp_plane_point){2.1f, -3.0f}, (struct jp_plane_point){2.1f, 5.0f}, 2));
}

/* ---- What is refused ---- */

/* With a track that any update would change. */
static void expect(enum jp_status status, float period)
{
    put_walker();
    movers.movers[0].misses = WALKER_MISSES_MAX;
    TEST_ASSERT_EQUAL_INT(status, jp_movers_update(&movers, &config, &scan_config, &scan, &sensor, period));
    TEST_ASSERT_EQUAL_UINT(status == JP_OK ? 0 : 1, movers.count);
    TEST_ASSERT_EQUAL_UINT(SIGHTINGS_MIN, movers.movers[0].sightings);
    if (status != JP_OK) {
        TEST_ASSERT_EQUAL_UINT(WALKER_MISSES_MAX, movers.movers[0].misses);
        TEST_ASSERT_TRUE(movers.movers[0].centre.y == 1.0f);
    }
}

static void test_null_pointers_are_refused(void)
{
    take_scan();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_movers_update(NULL, &config, &scan_config, &scan, &sensor, PERIOD));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_movers_update(&movers, NULL, &scan_config, &scan, &sensor, PERIOD));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_movers_update(&movers, &config, NULL, &scan, &sensor, PERIOD));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_movers_update(&movers, &config, &scan_config, NULL, &sensor, PERIOD));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_movers_update(&movers, &config, &scan_config, &scan, NULL, PERIOD));
}

static void test_bad_configurations_are_refused(void)
{
    volatile float large = FLT_MAX; /* the compiler must not see that it overflows */
    const float infinity = large * 2.0f;
    const float not_a_number = infinity - infinity;
    const struct jp_movers_config bad[] = {
        {0.0f, 9.0f, 0.3f, 2.0f, 0.3f},         {not_a_number, 9.0f, 0.3f, 2.0f, 0.3f},
        {0.9f, 0.0f, 0.3f, 2.0f, 0.3f},         {0.9f, not_a_number, 0.3f, 2.0f, 0.3f},
        {0.9f, 1000.1f, 0.3f, 2.0f, 0.3f},      {0.9f, 9.0f, 0.0f, 2.0f, 0.3f},
        {0.9f, 9.0f, not_a_number, 2.0f, 0.3f}, {0.9f, 9.0f, 0.3f, 0.29f, 0.3f},
        {0.9f, 9.0f, 0.3f, not_a_number, 0.3f}, {0.9f, 9.0f, 0.3f, infinity, 0.3f},
        {0.9f, 9.0f, 0.3f, 2.0f, -0.1f},        {0.9f, 9.0f, 0.3f, 2.0f, not_a_number},
        {0.9f, 9.0f, 0.3f, 2.0f, infinity},     {0.9f, 9.0f, 0.3f, 1000.1f, 0.3f},
        {0.9f, 9.0f, 0.3f, 2.0f, 1000.1f},
    };

    take_scan();
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        config = bad[i];
        expect(JP_ERR_ARGUMENT, PERIOD);
    }
    config =
        (struct jp_movers_config){.extent = 0.9f, .range = 9.0f, .speed_min = 0.3f, .speed_max = 0.3f, .margin = 0.0f};
    expect(JP_OK, PERIOD);
}

static void test_bad_periods_are_refused(void)
{
    take_scan();
    expect(JP_ERR_ARGUMENT, 0.0f);
    expect(JP_ERR_ARGUMENT, -PERIOD);
    expect(JP_ERR_ARGUMENT, 0.0009f);
    expect(JP_ERR_ARGUMENT, 10.1f);
    expect(JP_OK, 0.001f);
    expect(JP_OK, 10.0f);
}

static void test_after_a_long_period_nobody_is_known(void)
{
    (void)put_disc(2.0f, 0.0f, RADIUS);
    look();
    take_scan();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_movers_update(&movers, &config, &scan_config, &scan, &sensor, 0.5f));
    TEST_ASSERT_EQUAL_UINT(2, movers.movers[0].sightings);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_movers_update(&movers, &config, &scan_config, &scan, &sensor, 0.51f));
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_EQUAL_UINT(1, movers.movers[0].sightings);
}

static void test_scan_of_dropouts_is_not_trusted(void)
{
    for (unsigned i = 0; i < BEAMS; i++) {
        ranges[i] = -1.0f;
    }
    expect(JP_ERR_UNRELIABLE, PERIOD);
    scan.count = 1;
    expect(JP_ERR_ARGUMENT, PERIOD);
}
