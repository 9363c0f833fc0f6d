/* Room around a robot: which turns in place and steps are free, and which is taken. */
#include "tests/support/patrol_rig.h"

#include "src/local/patrol_price.h"
#include "src/local/patrol_room.h"

/* Obstacles look smaller than they are by half of the scan's tolerance. */
#define SHRUNK 0.02f

static const struct jp_plane_pose here = {0.0f, 0.0f, 0.0f};

void setUp(void)
{
    const struct jp_plane_point centre = {0.0f, 0.0f};

    rig_reset();
    jp_obstacles_clear(&patrol.obstacles, &centre);
}

void tearDown(void)
{
}

static void put_box(float left, float bottom, float right, float top)
{
    const struct jp_obstacle box = {
        .vertices = {{left, bottom}, {right, bottom}, {right, top}, {left, top}},
        .vertex_count = 4,
    };

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&patrol.obstacles, &box));
}

/* ---- Clearance ---- */

static void test_clearance(void)
{
    const struct jp_plane_pose across = {0.0f, 0.0f, 0.5f * JP_PLANE_PI};

    TEST_ASSERT_TRUE(jp_patrol_clearance(&patrol, &here) > 1.0e8f);
    put_box(0.9f, -0.5f, 1.0f, 0.5f);
    TEST_ASSERT_NEAR(1e-4f, 0.5f + SHRUNK, jp_patrol_clearance(&patrol, &here));
    TEST_ASSERT_NEAR(1e-4f, 0.6f + SHRUNK, jp_patrol_clearance(&patrol, &across));
    put_box(0.35f, -0.05f, 0.38f, 0.05f);
    TEST_ASSERT_NEAR(1e-4f, -0.05f + SHRUNK, jp_patrol_clearance(&patrol, &here));
}

/* ---- Turns ---- */

static void test_turn_without_obstacles(void)
{
    TEST_ASSERT_TRUE(jp_patrol_is_turn_free(&patrol, &here, 0.0f, patrol.config.turn_clearance));
    TEST_ASSERT_TRUE(jp_patrol_is_turn_free(&patrol, &here, 2.0f * JP_PLANE_PI, patrol.config.turn_clearance));
    TEST_ASSERT_TRUE(jp_patrol_is_turn_free(&patrol, &here, -2.0f * JP_PLANE_PI, patrol.config.turn_clearance));
}

/* The corners reach 0.5 m, the sides 0.3 m. */
static void test_corner_meets_a_wall_beside(void)
{
    put_box(-2.0f, 0.4f, 2.0f, 0.5f);
    TEST_ASSERT_TRUE(jp_patrol_is_turn_free(&patrol, &here, 0.2f, patrol.config.turn_clearance));
    TEST_ASSERT_TRUE(jp_patrol_is_turn_free(&patrol, &here, -0.2f, patrol.config.turn_clearance));
    TEST_ASSERT_FALSE(jp_patrol_is_turn_free(&patrol, &here, 0.6f, patrol.config.turn_clearance));
    TEST_ASSERT_FALSE(jp_patrol_is_turn_free(&patrol, &here, -0.6f, patrol.config.turn_clearance));
    TEST_ASSERT_FALSE(jp_patrol_is_turn_free(&patrol, &here, JP_PLANE_PI, patrol.config.turn_clearance));
}

static void test_turn_keeps_its_clearance(void)
{
    put_box(-2.0f, 0.56f, 2.0f, 0.66f);
    TEST_ASSERT_TRUE(jp_patrol_is_turn_free(&patrol, &here, JP_PLANE_PI, patrol.config.turn_clearance));
    patrol.config.turn_clearance = 0.07f;
    TEST_ASSERT_TRUE(jp_patrol_is_turn_free(&patrol, &here, JP_PLANE_PI, patrol.config.turn_clearance));
    patrol.config.turn_clearance = 0.1f;
    TEST_ASSERT_FALSE(jp_patrol_is_turn_free(&patrol, &here, JP_PLANE_PI, patrol.config.turn_clearance));
}

static void test_turn_that_begins_in_collision_is_not_free(void)
{
    put_box(0.3f, -0.1f, 0.5f, 0.1f);
    TEST_ASSERT_FALSE(jp_patrol_is_turn_free(&patrol, &here, 0.0f, patrol.config.turn_clearance));
}

/* The oracle: thing by thing, whether a point of the footprint passes it, in steps of a tenth of those of the code. */
static bool passes(float x, float y, float angle)
{
    const float distance = jp_plane_length(x, y);
    bool is_in = false;

    for (unsigned i = 0; i <= 1000U; i++) {
        const float bearing = jp_plane_bearing(x, y) - angle * (float)i / 1000.0f;
        const float along = jp_plane_magnitude(distance * jp_plane_cosine(bearing));
        const float across = jp_plane_magnitude(distance * jp_plane_sine(bearing));

        is_in = is_in || (along < 0.4f && across < 0.3f);
    }
    return is_in;
}

static void test_turns_among_things_all_around(void)
{
    for (unsigned i = 0; i < 24U; i++) {
        const struct jp_plane_point along = jp_plane_direction((float)i * JP_PLANE_PI / 12.0f);

        for (unsigned k = 0; k < 6U; k++) {
            const float angle = 0.5f * ((float)k - 2.5f);
            const struct jp_obstacle thing = {
                .vertices = {{0.44f * along.x, 0.44f * along.y}}, .vertex_count = 1, .radius = 0.06f};
            const bool is_hit = passes(0.40f * along.x, 0.40f * along.y, angle);
            const bool is_near = passes(0.36f * along.x, 0.36f * along.y, angle);

            jp_obstacles_clear(&patrol.obstacles, &(struct jp_plane_point){0.0f, 0.0f});
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&patrol.obstacles, &thing));
            if (is_hit) {
                TEST_ASSERT_FALSE(jp_patrol_is_turn_free(&patrol, &here, angle, patrol.config.turn_clearance));
            } else if (!is_near) {
                TEST_ASSERT_TRUE(jp_patrol_is_turn_free(&patrol, &here, angle, patrol.config.turn_clearance));
            }
        }
    }
}

static void expect_turn(float heading, float expected)
{
    float angle = 0.0f;

    TEST_ASSERT_TRUE(jp_patrol_find_turn(&patrol, &here, heading, patrol.config.turn_clearance, &angle));
    TEST_ASSERT_NEAR(1e-4f, expected, angle);
}

static void test_shorter_way_round_is_taken(void)
{
    expect_turn(0.0f, 0.0f);
    expect_turn(2.0f, 2.0f);
    expect_turn(-2.0f, -2.0f);
    expect_turn(4.0f, 4.0f - 2.0f * JP_PLANE_PI);
}

/* A long nose, and a thing beside it. */
static void test_longer_way_round_if_the_shorter_is_not_free(void)
{
    patrol.config.teb.footprint = (struct jp_footprint){0.6f, 0.2f, 0.3f};
    put_box(0.36f, 0.36f, 0.41f, 0.41f);
    expect_turn(1.6f, 1.6f - 2.0f * JP_PLANE_PI);
    expect_turn(-1.6f, -1.6f);
    put_box(0.36f, -0.41f, 0.41f, -0.36f);

    float angle;

    TEST_ASSERT_FALSE(jp_patrol_find_turn(&patrol, &here, 1.6f, patrol.config.turn_clearance, &angle));
    TEST_ASSERT_FALSE(jp_patrol_find_turn(&patrol, &here, -1.6f, patrol.config.turn_clearance, &angle));
}

static void test_longer_way_round_to_the_left(void)
{
    patrol.config.teb.footprint = (struct jp_footprint){0.6f, 0.2f, 0.3f};
    put_box(0.36f, -0.41f, 0.41f, -0.36f);
    expect_turn(-1.6f, 2.0f * JP_PLANE_PI - 1.6f);
}

/* ---- Steps ---- */

static bool is_step_free(float x, float y)
{
    const struct jp_plane_pose step = {x, y, 0.0f};

    return jp_patrol_is_step_free(&patrol, &step, patrol.config.turn_clearance);
}

static void test_step_in_the_frame_of_the_robot(void)
{
    patrol.pose = (struct jp_plane_pose){1.0f, 1.0f, 0.5f * JP_PLANE_PI};
    put_box(0.0f, 2.0f, 2.0f, 2.1f);
    TEST_ASSERT_TRUE(is_step_free(0.5f, 0.0f));
    TEST_ASSERT_FALSE(is_step_free(0.7f, 0.0f));
    TEST_ASSERT_TRUE(is_step_free(0.0f, 0.7f));
    TEST_ASSERT_TRUE(is_step_free(0.0f, -0.7f));
}

static void test_step_over_a_thin_thing_is_not_free(void)
{
    put_box(0.7f, -0.5f, 0.71f, 0.5f);
    TEST_ASSERT_FALSE(is_step_free(1.5f, 0.0f));
}

static void test_step_keeps_its_clearance(void)
{
    put_box(-1.0f, 0.35f, 1.0f, 0.4f);
    TEST_ASSERT_TRUE(is_step_free(0.3f, 0.0f));
    patrol.config.turn_clearance = 0.06f;
    TEST_ASSERT_TRUE(is_step_free(0.3f, 0.0f));
    TEST_ASSERT_FALSE(is_step_free(0.3f, 0.2f));
}

static bool find_step(float heading, struct jp_plane_point *target)
{
    *target = (struct jp_plane_point){9.0f, 9.0f};
    const struct jp_patrol_step_search search = {.heading = heading, .clearance = patrol.config.turn_clearance};

    return jp_patrol_find_step(&patrol, &search, target);
}

/* Somebody who stands against the robot hides no wall from it. */
static void test_what_is_nearest_does_not_hide_the_rest(void)
{
    const struct jp_plane_pose ahead = {0.15f, 0.0f, 0.0f};
    const struct jp_plane_pose back = {-0.15f, 0.0f, 0.0f};
    const struct jp_plane_pose aside = {0.0f, 0.1f, 0.0f};

    put_box(-0.1f, 0.25f, 0.1f, 0.35f);
    TEST_ASSERT_TRUE(jp_patrol_clearance(&patrol, &here) < 0.0f);
    TEST_ASSERT_TRUE(jp_patrol_is_step_free(&patrol, &ahead, 0.05f));
    put_box(0.5f, -1.0f, 0.6f, 1.0f);
    TEST_ASSERT_FALSE(jp_patrol_is_step_free(&patrol, &ahead, 0.05f));
    TEST_ASSERT_TRUE(jp_patrol_is_step_free(&patrol, &back, 0.05f));
    TEST_ASSERT_FALSE(jp_patrol_is_step_free(&patrol, &aside, 0.05f));
}

static void test_shortest_step_ahead_is_taken(void)
{
    struct jp_plane_point target;

    TEST_ASSERT_TRUE(find_step(1.5f, &target));
    TEST_ASSERT_NEAR(1e-4f, 0.15f, target.x);
    TEST_ASSERT_NEAR(1e-4f, 0.0f, target.y);
}

/* Between walls that end ahead. */
static void test_step_to_where_the_walls_end(void)
{
    struct jp_plane_point target;
    float angle;

    put_box(-1.0f, 0.4f, 0.2f, 0.45f);
    put_box(-1.0f, -0.45f, 0.2f, -0.4f);
    TEST_ASSERT_FALSE(jp_patrol_find_turn(&patrol, &here, 1.5f, patrol.config.turn_clearance, &angle));
    TEST_ASSERT_TRUE(find_step(1.5f, &target));
    TEST_ASSERT_TRUE(target.x > 0.3f && target.x <= 0.76f);

    const struct jp_plane_pose there = {target.x, target.y, 0.0f};

    TEST_ASSERT_TRUE(jp_patrol_find_turn(&patrol, &there, 1.5f, patrol.config.turn_clearance, &angle));
}

static void test_step_aside_from_a_wall(void)
{
    struct jp_plane_point target;

    put_box(-2.0f, 0.4f, 2.0f, 0.5f);
    put_box(0.6f, -2.0f, 0.7f, 2.0f);
    TEST_ASSERT_TRUE(find_step(1.5f, &target));
    TEST_ASSERT_TRUE(target.y < -0.05f);
    jp_obstacles_clear(&patrol.obstacles, &(struct jp_plane_point){0.0f, 0.0f});
    put_box(-2.0f, -0.5f, 2.0f, -0.4f);
    put_box(0.6f, -2.0f, 0.7f, 2.0f);
    TEST_ASSERT_TRUE(find_step(1.5f, &target));
    TEST_ASSERT_TRUE(target.y > 0.05f);
}

/* Between two walls that end behind. */
static void put_walls_that_end_behind(void)
{
    put_box(-0.2f, 0.4f, 2.0f, 0.45f);
    put_box(-0.2f, -0.45f, 2.0f, -0.4f);
}

static void test_step_back_only_by_cost(void)
{
    struct jp_plane_point target;

    put_walls_that_end_behind();
    patrol.config.strategy = (uint8_t)JP_PATROL_FIXED_ANGLE;
    TEST_ASSERT_FALSE(find_step(1.5f, &target));
    patrol.config.strategy = (uint8_t)JP_PATROL_BY_COST;
    TEST_ASSERT_TRUE(find_step(1.5f, &target));
    TEST_ASSERT_TRUE(target.x < -0.3f);
    TEST_ASSERT_NEAR(1e-4f, 0.0f, target.y);
}

/* What is behind it is not free. */
static void test_no_step_back_into_a_box(void)
{
    struct jp_plane_point target;

    put_walls_that_end_behind();
    put_box(-0.8f, -0.4f, -0.6f, 0.4f);
    patrol.config.strategy = (uint8_t)JP_PATROL_BY_COST;
    TEST_ASSERT_FALSE(find_step(1.5f, &target));
}

/* Nearer to something than the clearance, it steps away from it. */
static void test_step_leads_away_from_what_is_near(void)
{
    const struct jp_patrol_step_search search = {.heading = 0.0f, .clearance = 0.1f};
    struct jp_plane_point target;

    put_box(0.48f, -1.0f, 0.6f, 1.0f);
    patrol.config.strategy = (uint8_t)JP_PATROL_BY_COST;
    TEST_ASSERT_TRUE(jp_patrol_find_step(&patrol, &search, &target));
    TEST_ASSERT_TRUE(target.x < -0.05f);
}

/* It ends where a second step leads to the goal: within its reach, and free. */
static void test_step_from_where_another_leads_to_the_goal(void)
{
    const struct jp_plane_pose goal = {0.0f, 0.0f, 1.5f};
    struct jp_patrol_step_search search = {.heading = 1.5f, .into = &goal, .into_reach = 0.2f};
    struct jp_plane_point target;

    patrol.config.strategy = (uint8_t)JP_PATROL_BY_COST;
    TEST_ASSERT_TRUE(jp_patrol_find_step(&patrol, &search, &target));
    TEST_ASSERT_TRUE(jp_plane_length(target.x, target.y) < 0.2f);
    search.into_reach = 0.1f;
    TEST_ASSERT_FALSE(jp_patrol_find_step(&patrol, &search, &target));
    /* Nearer to a box than the clearance: what leads in without coming nearer is still free. */
    search.into_reach = 0.2f;
    search.into_clearance = 9.0f;
    put_box(1.0f, -0.1f, 1.1f, 0.1f);
    TEST_ASSERT_TRUE(jp_patrol_find_step(&patrol, &search, &target));
}

static void test_no_step_out_of_a_box(void)
{
    struct jp_plane_point target;

    put_box(-0.6f, 0.4f, 0.6f, 0.45f);
    put_box(-0.6f, -0.45f, 0.6f, -0.4f);
    put_box(0.5f, -0.4f, 0.6f, 0.4f);
    put_box(-0.6f, -0.4f, -0.5f, 0.4f);
    TEST_ASSERT_FALSE(find_step(1.5f, &target));
    TEST_ASSERT_NEAR(1e-6f, 9.0f, target.x);
}

/* ---- Against all that there is ---- */

/* Of what walks it keeps off where that will be, in any direction, and by as much as that may be off. */
static void test_what_moves_is_farther_on_later(void)
{
    for (int i = 0; i < 8; i++) {
        const struct jp_plane_point along = jp_plane_direction(0.25f * JP_PLANE_PI * (float)i);
        const struct jp_plane_pose pose = {0.3f, -0.2f, 0.4f};
        struct jp_plane_pose beside = pose;

        setUp();
        put_box(0.9f, -0.5f, 1.0f, 0.5f);
        patrol.obstacles.shapes[0].velocity = (struct jp_plane_point){0.5f * along.x, 0.5f * along.y};
        patrol.obstacles.shapes[0].margin = 0.04f;
        beside.x -= 0.4f * 0.5f * along.x;
        beside.y -= 0.4f * 0.5f * along.y;
        TEST_ASSERT_NEAR(1.0e-4f, jp_patrol_clearance(&patrol, &beside) - 0.4f * 0.04f,
                         jp_patrol_clearance_later(&patrol, &pose, 0.4f));
    }
}

static float price_of_way(float x, float y)
{
    return jp_patrol_step_price(&patrol.config, jp_plane_magnitude(jp_plane_bearing(x, y)), jp_plane_length(x, y));
}

/* In the open all steps are free: of 0.15 m to 0.75 m, a twelfth of a turn apart, it takes the one that costs least
 * with the turn and the step into the goal. */
static void test_the_step_is_the_cheapest_of_all(void)
{
    for (unsigned run = 0; run < 24U; run++) {
        const float bearing = 0.2618f * (float)run;
        const struct jp_plane_pose into = {0.8f * jp_plane_cosine(bearing), 0.8f * jp_plane_sine(bearing), 0.0f};
        const struct jp_patrol_step_search search = {
            .heading = 0.5f * (float)(run % 5U) - 1.0f, .into = &into, .into_reach = 0.7f};
        const struct jp_plane_point across = jp_plane_direction(search.heading);
        const float turn = jp_patrol_turn_price(&patrol.config, jp_plane_magnitude(search.heading));
        float least = 1.0e9f;
        float found;
        struct jp_plane_point target;

        patrol.config.strategy = (uint8_t)JP_PATROL_BY_COST;
        for (unsigned k = 0; k < 60U; k++) {
            const struct jp_plane_point along = jp_plane_direction(JP_PLANE_PI / 6.0f * (float)(k % 12U));
            const float x = 0.15f * (float)(k / 12U + 1U) * along.x;
            const float y = 0.15f * (float)(k / 12U + 1U) * along.y;
            const float ahead = across.x * (into.x - x) + across.y * (into.y - y);
            const float left = across.x * (into.y - y) - across.y * (into.x - x);

            if (jp_plane_length(ahead, left) < 0.7f) {
                least = jp_plane_smaller(least, price_of_way(x, y) + turn + price_of_way(ahead, left));
            }
        }
        TEST_ASSERT_TRUE(jp_patrol_find_step(&patrol, &search, &target));
        found = price_of_way(target.x, target.y) + turn +
                price_of_way(across.x * (into.x - target.x) + across.y * (into.y - target.y),
                             across.x * (into.y - target.y) - across.y * (into.x - target.x));
        TEST_ASSERT_NEAR(1.0e-3f, least, found);
    }
}
