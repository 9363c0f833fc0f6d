/* Turning while the robot drives: when it pays, when it is free, and how it ends. */
#include "src/local/patrol_glide.h"
#include "src/local/patrol_price.h"

#include "src/local/patrol_path.h"
#include "src/local/patrol_room.h"
#include "src/local/patrol_state.h"
#include "tests/support/patrol_rig.h"

static void expect_within(float tolerance, float expected, float actual)
{
    TEST_ASSERT_TRUE(jp_plane_magnitude(actual - expected) <= tolerance);
}

void setUp(void)
{
    rig_reset();
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    rig_init();
}

void tearDown(void)
{
}

static void expect_pose(float x, float y, float heading)
{
    expect_within(config.position_tolerance, x, robot.x);
    expect_within(config.position_tolerance, y, robot.y);
    expect_within(config.heading_tolerance + 0.01f, 0.0f, jp_plane_wrap(robot.heading - heading));
}

/* ---- Setting off ---- */

static void test_robot_glides_to_a_path_at_its_side(void)
{
    rig_go(1.0f, 2.5f);
    rig_cycle();
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(twist.y > 0);
    TEST_ASSERT_EQUAL_INT32(0, twist.turn_rate);
    (void)rig_until(JP_PATROL_DRIVING, 60);
    expect_within(0.25f, 1.19f, robot.heading);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.turns);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.glides);
}

static void test_to_the_right_as_to_the_left(void)
{
    rig_go(1.0f, -2.5f);
    rig_cycle();
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(twist.y < 0);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.turns);
}

/* Its path leads off more to the side than it can be led: a wheel that points backwards after a turn in place would
 * stay so, and have to be steered round under way. */
static void test_no_wheel_sets_off_backwards(void)
{
    const float sides[] = {-1.0f, 1.0f};

    for (unsigned i = 0; i < 2U; i++) {
        rig_reset();
        rig_go(0.1f, 2.5f * sides[i]);
        patrol.state = JP_PATROL_GLIDING;
        patrol.internal.is_setting_off = true;
        jp_patrol_glide(&patrol);

        const float askew = jp_plane_bearing(patrol.internal.command.forward, patrol.internal.sideways);

        expect_within(1.0e-4f, sides[i] * jp_patrol_askew_max(&config), askew);
        TEST_ASSERT_TRUE(patrol.internal.command.turn_rate == 0.0f);
    }
}

/* As many poses as there is room for, or up to the goal. */
static void test_a_glide_is_foreseen_as_far_as_it_is_asked_for(void)
{
    struct jp_plane_pose poses[40];

    rig_go(1.0f, 2.5f);
    rig_cycle();
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    TEST_ASSERT_EQUAL_UINT(5, jp_patrol_foresee_glide(&patrol, poses, 5));
    expect_within(0.05f, 0.5f, jp_plane_length(poses[4].x, poses[4].y));
    expect_within(0.05f, 0.19f, poses[4].x);

    const unsigned count = jp_patrol_foresee_glide(&patrol, poses, 40);

    TEST_ASSERT_TRUE(count >= 26U && count <= 28U);
    expect_within(0.05f, 1.0f, poses[count - 1U].x);
    expect_within(0.05f, 2.5f, poses[count - 1U].y);
    expect_within(0.05f, jp_plane_bearing(1.0f, 2.5f), poses[count - 1U].heading);
}

/* As far as a glide can take over. */
static void test_robot_turns_part_of_a_great_angle(void)
{
    rig_go(-2.5f, 0.5f);
    rig_cycle();
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_GLIDING, 60);
    expect_within(0.1f, 2.944f - jp_patrol_askew_max(&config), robot.heading);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.turns);
}

static void test_the_papers_rule_turns_first(void)
{
    config.strategy = (uint8_t)JP_PATROL_FIXED_ANGLE;
    rig_init();
    rig_go(1.0f, 2.5f);
    rig_cycle();
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.glides);
}

/* A turn in place, then a glide that begins askew. */
static float set_off_price(float turned, float askew)
{
    return jp_patrol_turn_price(&config, turned) + jp_patrol_steering_price(&config, askew, turned > 0.0f);
}

/* Of all ways to share an angle between the two. */
static float least_price(float angle)
{
    const float most = jp_plane_smaller(angle, jp_patrol_askew_max(&config));
    float least = set_off_price(angle, 0.0f);

    for (unsigned i = 0; i <= 100U; i++) {
        const float askew = most * (float)i / 100.0f;

        least = jp_plane_smaller(least, set_off_price(angle - askew, askew));
    }
    return least;
}

static void test_robot_sets_off_as_costs_least(void)
{
    for (unsigned i = 7; i <= 36U; i++) {
        const float angle = JP_PLANE_PI * (float)i / 36.0f;

        setUp();
        config.price.steering = i % 2U == 0U ? 9.0f : 60.0f;
        rig_init();
        rig_go(2.5f * jp_plane_cosine(angle), 2.5f * jp_plane_sine(angle));
        rig_cycle();
        TEST_ASSERT_TRUE(patrol.state == JP_PATROL_GLIDING || patrol.state == JP_PATROL_TURNING);

        const float turned =
            patrol.state == JP_PATROL_TURNING ? jp_plane_magnitude(patrol.internal.turn_remaining) : 0.0f;

        TEST_ASSERT_TRUE(set_off_price(turned, jp_plane_magnitude(angle - turned)) <= least_price(angle) + 1.0f);
    }
}

/* Where wheels are steered more slowly than the robot turns, what a glide saves of the turn is not worth it. */
static void test_the_cheaper_way_is_taken(void)
{
    config.steering_rate = 0.1f;
    rig_init();
    rig_go(-2.5f, 0.5f);
    rig_cycle();
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_DRIVING, 60);
    expect_within(0.1f, 2.944f, robot.heading);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.glides);
}

/* A wall in the way of the corners that hang out, but not of the robot that has turned. */
static void test_robot_turns_where_a_glide_is_not_free(void)
{
    rig_wall(0.5f, 0.95f, 0.5f, 3.0f);
    rig_wall(-0.5f, 0.95f, -0.5f, 3.0f);
    rig_go(0.0f, 2.5f);
    rig_cycle();
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
}

static void test_less_room_than_wanted_is_not_made_less(void)
{
    rig_wall(-2.0f, -0.35f, 2.0f, -0.35f);
    rig_go(1.0f, 2.5f);
    rig_cycle();
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
}

static void test_what_comes_into_a_glide_stops_it(void)
{
    rig_go(1.0f, 2.5f);
    rig_cycles(12);
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    rig_wall(-2.0f, robot.y + 0.75f, 3.0f, robot.y + 0.75f);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    rig_expect_stand();
    wall_count = 0;
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
}

/* Three free cycles in a row. */
static void test_a_glide_begins_when_the_path_is_to_be_trusted(void)
{
    rig_go(1.0f, 2.5f);
    rig_cycles(12);
    rig_wall(-2.0f, robot.y + 0.75f, 3.0f, robot.y + 0.75f);
    rig_cycle();
    robot.heading = 0.0f;
    patrol.pose = robot;
    wall_count = 0;
    rig_cycles(2);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    rig_expect_stand();
    rig_cycle();
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
}

/* Pushed round, so that no wheel can be steered to the way. */
static void test_what_turns_the_robot_away_ends_the_glide(void)
{
    rig_go(1.0f, 2.5f);
    rig_cycles(8);
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    robot.heading -= 1.2f;
    patrol.pose = robot;
    rig_cycle();
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    rig_expect_stand();
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
}

static void test_a_pause_holds_a_glide(void)
{
    rig_go(1.0f, 2.5f);
    rig_cycles(8);
    jp_patrol_pause(&patrol);
    rig_expect(JP_PATROL_HELD, JP_PATROL_NONE);
}

/* ---- Into the goal ---- */

static void test_robot_comes_to_the_goal_turned(void)
{
    rig_go_to_heading(4.0f, 0.0f, 1.0f);
    (void)rig_until(JP_PATROL_GLIDING, RIG_LONG);
    TEST_ASSERT_TRUE(robot.x > 2.0f && robot.x < 3.5f);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    expect_pose(4.0f, 0.0f, 1.0f);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.turns);
}

static void test_what_a_glide_cannot_turn_is_turned_in_place(void)
{
    rig_go_to_heading(4.0f, 0.0f, -3.0f);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    expect_pose(4.0f, 0.0f, -3.0f);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.turns);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.glides);
}

/* From a stand in one glide: along and round. */
static void test_a_short_way_is_one_glide(void)
{
    rig_go_to_heading(0.5f, 0.7f, 0.9f);
    rig_cycle();
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(patrol.internal.is_gliding_to_goal);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    expect_pose(0.5f, 0.7f, 0.9f);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.glides);
}

static void test_a_goal_of_any_heading_is_driven_to(void)
{
    rig_go(3.0f, 0.0f);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.glides);
}

static void test_a_plain_band_does_not_glide(void)
{
    config.turns_in_place = false;
    rig_init();
    rig_go_to_heading(3.0f, 0.0f, 0.0f);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.glides);
}

/* Beside a wall there is no room for the corners. */
static void test_a_glide_into_a_goal_must_be_free(void)
{
    struct jp_patrol_window window;

    rig_wall(0.5f, 0.42f, 5.0f, 0.42f);
    robot.x = 2.5f;
    rig_init();
    rig_go_to_heading(3.0f, 0.0f, 0.8f);
    rig_cycle();
    jp_patrol_look_ahead(&patrol, config.horizon, &window);
    TEST_ASSERT_FALSE(jp_patrol_glide_in(&patrol, &window));
    wall_count = 0;
    rig_wall(2.95f, -0.5f, 2.95f, 0.5f);
    rig_go_to_heading(3.0f, 0.0f, 0.8f);
    rig_cycle();
    jp_patrol_look_ahead(&patrol, config.horizon, &window);
    TEST_ASSERT_FALSE(jp_patrol_glide_in(&patrol, &window));
}

/* The ends of the glide are free; between them a corner would come too near to a post. */
static void test_a_glide_into_a_goal_must_be_free_on_its_way(void)
{
    struct jp_patrol_window window;

    rig_wall(2.98f, 0.41f, 3.06f, 0.41f);
    robot.x = 2.75f;
    rig_init();
    rig_go_to_heading(3.5f, 0.0f, 1.2f);
    rig_cycle();
    jp_patrol_look_ahead(&patrol, config.horizon, &window);
    TEST_ASSERT_FALSE(jp_patrol_glide_in(&patrol, &window));
    wall_count = 0;
    rig_cycle();
    TEST_ASSERT_TRUE(patrol.state == JP_PATROL_GLIDING || jp_patrol_glide_in(&patrol, &window));
}

/* Whether a glide in begins at a place before the goal (3, 0), at a speed, with a post somewhere or without. */
static bool begins_glide_beside(const struct jp_plane_point *post, float x, float heading, float speed)
{
    struct jp_patrol_window window;

    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    rig_init();
    rig_go_to_heading(3.0f, 0.0f, heading);
    rig_cycle();
    TEST_ASSERT_EQUAL_INT(JP_PATROL_DRIVING, patrol.state);
    robot.x = x;
    patrol.pose.x = x;
    patrol.internal.command.forward = speed;
    (void)jp_patrol_advance(&patrol);
    if (post != NULL) {
        patrol.obstacles.shapes[0] = (struct jp_obstacle){.vertices = {*post}, .vertex_count = 1, .radius = 0.02f};
        patrol.obstacles.count = 1;
    }
    jp_patrol_look_ahead(&patrol, config.horizon, &window);
    return jp_patrol_glide_in(&patrol, &window);
}

static bool begins_glide(float x, float heading, float speed)
{
    return begins_glide_beside(NULL, x, heading, speed);
}

/* A turn that is left at the goal is turned in place, and what a glide takes of it must not slow the robot down. */
static void test_a_glide_in_begins_when_it_is_due(void)
{
    TEST_ASSERT_FALSE(begins_glide(1.5f, 1.0f, 0.8f));
    rig_reset();
    TEST_ASSERT_TRUE(begins_glide(2.2f, 1.0f, 0.8f));
    rig_reset();
    TEST_ASSERT_TRUE(begins_glide(2.2f, 3.0f, 0.0f));
    rig_reset();
    TEST_ASSERT_FALSE(begins_glide(2.9f, 3.0f, 0.0f));
    rig_reset();
    /* Faster than it can brake: there is no time for so great a turn. */
    TEST_ASSERT_FALSE(begins_glide(2.7f, 0.8f, 0.8f));
}

/* A post beyond the goal: the robot may come there askew, but a corner would touch it in the rest of the turn.
 */
static void test_what_is_left_of_a_glide_in_must_be_free(void)
{
    TEST_ASSERT_TRUE(begins_glide(2.2f, 3.0f, 0.0f));
    rig_reset();
    const struct jp_plane_point post = {3.45f, -0.25f};

    TEST_ASSERT_FALSE(begins_glide_beside(&post, 2.2f, 3.0f, 0.0f));
}

static void test_a_goal_behind_is_stepped_to(void)
{
    rig_go_to_heading(-0.2f, 0.05f, 0.0f);
    rig_cycle();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    expect_pose(-0.2f, 0.05f, 0.0f);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.turns);
}

/* Two turns would take longer than the slow step; where any heading will do, one does not. */
static void test_a_goal_behind_is_stepped_to_where_that_costs_less(void)
{
    rig_go_to_heading(-0.7f, 0.0f, 0.0f);
    rig_cycle();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    rig_reset();
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    rig_init();
    rig_go(-1.9f, 0.0f);
    rig_cycle();
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
}

/* With a wall beside its way. */
static void glide_beside_wall(float y, float heading, float speed, float turn_rate)
{
    rig_wall(-2.0f, y, 3.0f, y);
    rig_go(2.5f, 0.0f);
    rig_cycles(3);
    jp_patrol_stand(&patrol);
    patrol.pose.heading = heading;
    patrol.internal.command = (struct jp_plane_speed){speed, turn_rate};
    jp_patrol_enter(&patrol, JP_PATROL_GLIDING, JP_PATROL_NONE);
    jp_patrol_glide(&patrol);
}

/* If it stopped at that speed it would come nearer to the wall than it should. */
static void test_a_glide_that_cannot_stop_well_slows_down(void)
{
    patrol.internal.glide_least = 3.0f;
    glide_beside_wall(1.2f, 0.0f, 0.5f, 0.9f);
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(jp_plane_length(patrol.internal.command.forward, patrol.internal.sideways) < 0.5f);
}

/* Stopping with its wheels as they are it would touch the wall, which the glide leads along. */
static void test_a_glide_that_turns_to_a_wall_brakes_along_its_way(void)
{
    glide_beside_wall(0.85f, 0.6f, 0.8f, 1.5f);
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(jp_plane_length(patrol.internal.command.forward, patrol.internal.sideways) < 0.8f);
    TEST_ASSERT_TRUE(patrol.internal.command.turn_rate < 1.5f);
}

static void test_so_does_a_glide_into_the_goal(void)
{
    patrol.internal.is_gliding_to_goal = true;
    glide_beside_wall(0.85f, 0.6f, 0.8f, 1.5f);
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(jp_plane_length(patrol.internal.command.forward, patrol.internal.sideways) < 0.8f);
}

/* It would touch what it leads to before it stands. */
static void test_a_glide_that_cannot_stop_stops(void)
{
    rig_wall(0.7f, -2.0f, 0.7f, 2.0f);
    glide_beside_wall(0.5f, 0.0f, 0.8f, 1.5f);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
}

/* A post beside the goal: the robot could stand there, but within 0.1 m of it, and could turn there instead. */
static void test_a_glide_into_a_goal_keeps_room_at_its_end(void)
{
    const struct jp_plane_point near = {3.1f, 0.5f};
    const struct jp_plane_point far = {3.2f, 0.8f};

    TEST_ASSERT_FALSE(begins_glide_beside(&near, 2.2f, -2.0f, 0.0f));
    rig_reset();
    TEST_ASSERT_TRUE(begins_glide_beside(&far, 2.2f, -2.0f, 0.0f));
}

/* What it would meet is farther than it takes to stop, but it stands already. */
static void test_a_glide_that_stands_before_a_wall_waits(void)
{
    robot.heading = 0.8f;
    rig_init();
    rig_wall(0.76f, -2.0f, 0.76f, 2.0f);
    rig_cycle();
    rig_go(2.5f, 0.0f);
    jp_patrol_enter(&patrol, JP_PATROL_GLIDING, JP_PATROL_NONE);
    jp_patrol_stand(&patrol);
    jp_patrol_glide(&patrol);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
}

/* A wheel that hardly moves would have to turn far at once. */
static void test_wheels_change_little_in_a_cycle(void)
{
    const float y = 0.22f;
    const float x = 0.25f;

    rig_go(0.5f, 2.5f);
    rig_cycles(8);
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    patrol.internal.command = (struct jp_plane_speed){y + 0.0005f, 1.0f};
    patrol.internal.sideways = -x;
    patrol.internal.is_setting_off = false;
    jp_patrol_glide(&patrol);
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(patrol.internal.command.turn_rate > 0.8f);
}

/* As it comes to the goal it still turns, and its outer wheels go faster than it does. */
static void test_outer_wheels_slow_down_as_they_can(void)
{
    float fastest = 0.0f;
    float hardest = 0.0f;

    config.position_tolerance = 0.05f;
    config.heading_tolerance = 0.035f;
    rig_init();
    rig_go_to_heading(3.0f, 0.0f, 1.3f);
    for (unsigned i = 0; i < RIG_LONG && patrol.state != JP_PATROL_ARRIVED && patrol.state != JP_PATROL_TURNING; i++) {
        const float before = fastest;

        rig_cycle();

        const float forward = patrol.internal.command.forward;
        const float along = forward + 0.22f * jp_plane_magnitude(patrol.internal.command.turn_rate);
        const float across = jp_plane_magnitude(patrol.internal.sideways) +
                             0.25f * jp_plane_magnitude(patrol.internal.command.turn_rate);

        fastest = jp_plane_length(along, across);
        hardest = patrol.state == JP_PATROL_GLIDING ? jp_plane_larger(hardest, before - fastest) : hardest;
    }
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.glides);
    TEST_ASSERT_TRUE(hardest < 1.1f * config.people.braking * config.period);
    TEST_ASSERT_TRUE(hardest > 0.0f);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    expect_pose(3.0f, 0.0f, 1.3f);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.steps);
}

/* A turn by what a turn to its way may be off by would end where it begins. */
static void test_robot_sets_off_where_little_is_left_to_turn(void)
{
    float angle;

    config.position_tolerance = 0.05f;
    config.heading_tolerance = 0.02f;
    rig_init();
    angle = jp_patrol_askew_max(&config) + 0.05f;
    rig_go(2.0f * jp_plane_cosine(angle), 2.0f * jp_plane_sine(angle));
    rig_cycle();
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.turns);
    TEST_ASSERT_TRUE(jp_patrol_set_off_rest(&config, angle, angle - 0.05f) <= 0.0f);
    expect_within(1.0e-6f, 0.1f, jp_patrol_set_off_rest(&config, angle, angle - 0.1f));
}

/* ---- What is foreseen ---- */

/* At its end a glide has no direction, wherever the last of its steps leads. */
static void test_where_a_glide_ends_does_not_forbid_it(void)
{
    for (int i = 0; i < 100; i++) {
        rig_reset();
        config.strategy = (uint8_t)JP_PATROL_BY_COST;
        rig_init();

        const float way = 1.5f + 0.01f * (float)i;

        rig_go_to_heading(way * jp_plane_cosine(0.4f), way * jp_plane_sine(0.4f), 1.7f);
        TEST_ASSERT_TRUE(jp_patrol_can_glide_in(&patrol));
    }
}

static void test_what_a_way_leaves_of_a_glide(void)
{
    const float most = jp_patrol_askew_max(&config);

    expect_within(1.0e-6f, -1.0f, jp_patrol_glide_in_part(&config, -1.0f, 2.0f));
    expect_within(1.0e-6f, most, jp_patrol_glide_in_part(&config, 3.0f, 2.0f));
    expect_within(1.0e-6f, -0.5f, jp_patrol_glide_in_part(&config, -1.0f, 0.3f));
    expect_within(1.0e-6f, 0.0f, jp_patrol_glide_in_part(&config, 1.0f, -0.3f));
    expect_within(1.0e-6f, jp_patrol_set_off_length(1.0f), jp_patrol_set_off_length(-1.0f));
    expect_within(1.0e-6f, 0.0f, jp_patrol_set_off_part(&config, 0.0f));
}

static void test_a_glide_from_the_path_is_foreseen(void)
{
    rig_go_to_heading(4.0f, 0.0f, 1.0f);
    TEST_ASSERT_TRUE(jp_patrol_can_glide_in(&patrol));
    rig_go_to_heading(4.0f, 0.0f, 2.5f);
    TEST_ASSERT_FALSE(jp_patrol_can_glide_in(&patrol));
    rig_go_to_heading(0.3f, 0.0f, 0.3f);
    TEST_ASSERT_TRUE(jp_patrol_can_glide_in(&patrol));
    rig_go_to_heading(0.3f, 0.0f, 0.9f);
    TEST_ASSERT_FALSE(jp_patrol_can_glide_in(&patrol));
    rig_wall(1.0f, 0.45f, 5.0f, 0.45f);
    rig_go_to_heading(2.0f, 0.0f, 1.0f);
    rig_sense();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    TEST_ASSERT_FALSE(jp_patrol_can_glide_in(&patrol));
    patrol.config.strategy = (uint8_t)JP_PATROL_FIXED_ANGLE;
    TEST_ASSERT_FALSE(jp_patrol_can_glide_in(&patrol));
}

/* A path that turns back on itself leads wheels beyond their limit. */
static void test_a_path_that_turns_back_is_not_glided_along(void)
{
    rig_straight(0.0f, 0.0f, 0.2f, 0.55f);
    rig_straight(0.2f, 0.4f, -1.5f, -1.5f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(-1.5f, -1.5f, 0.0f, true));
    rig_cycle();
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.glides);
}

/* Between what a glide may begin with and where the wheels cannot follow. */
static void test_a_glide_at_the_limit_of_its_wheels_goes_on(void)
{
    const struct jp_plane_point along = jp_plane_direction(100.0f * JP_PLANE_PI / 180.0f - 0.01f);

    rig_go(2.0f * along.x, 2.0f * along.y);
    rig_sense();
    patrol.state = JP_PATROL_GLIDING;
    patrol.internal.sideways = 0.3f;
    jp_patrol_glide(&patrol);
    rig_expect(JP_PATROL_GLIDING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(patrol.internal.sideways > 0.0f);
}

static void test_clearance_of_what_moves(void)
{
    const struct jp_plane_point centre = {0.0f, 0.0f};
    struct jp_obstacle shape = {.vertices = {{3.0f, 0.0f}}, .vertex_count = 1, .radius = 0.5f, .margin = 0.1f};

    jp_obstacles_clear(&patrol.obstacles, &centre);
    TEST_ASSERT_TRUE(jp_patrol_clearance_later(&patrol, &robot, 1.0f) > 1.0e6f);
    shape.velocity = (struct jp_plane_point){-0.5f, 0.0f};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&patrol.obstacles, &shape));
    expect_within(0.01f, 3.0f - 0.5f - 0.4f + 0.02f, jp_patrol_clearance_later(&patrol, &robot, 0.0f));
    expect_within(0.01f, 3.0f - 1.0f - 0.5f - 0.4f - 0.2f + 0.02f, jp_patrol_clearance_later(&patrol, &robot, 2.0f));
    shape = (struct jp_obstacle){.vertices = {{0.0f, 9.0f}}, .vertex_count = 1};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&patrol.obstacles, &shape));
    expect_within(0.01f, 3.0f - 0.5f - 0.4f + 0.02f, jp_patrol_clearance_later(&patrol, &robot, 0.0f));
}
