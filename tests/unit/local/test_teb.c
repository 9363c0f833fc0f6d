/* A cycle of the TEB: what is refused, where the robot drives, and what it keeps off. */
#include <string.h>

#include "tests/support/teb_rig.h"

#include "src/local/teb_band.h"

#define PERIOD 0.1f /* of a cycle, s */

static struct jp_teb_config config;
static struct jp_teb_result result;
static const char *field;

void setUp(void)
{
    rig_reset();
    config = rig_band();
    memset(&result, 0, sizeof result);
    field = NULL;
}

void tearDown(void)
{
}

static void init(void)
{
    rig_init(&config);
}

static enum jp_status plan(void)
{
    return jp_teb_plan(&teb, &task, &obstacles, &result);
}

static bool is_pose_finite(const struct jp_plane_pose *pose)
{
    return jp_plane_is_finite(pose->x) && jp_plane_is_finite(pose->y) && jp_plane_is_finite(pose->heading);
}

static void assert_finite(void)
{
    TEST_ASSERT_TRUE(is_pose_finite(&result.start));
    TEST_ASSERT_TRUE(jp_plane_is_finite(result.speed.forward) && jp_plane_is_finite(result.speed.turn_rate));
    TEST_ASSERT_TRUE(jp_plane_is_finite(result.clearance) && jp_plane_is_finite(result.duration));
    TEST_ASSERT_TRUE(jp_plane_is_finite(result.cost));
    for (unsigned i = 0; i < teb.count; i++) {
        TEST_ASSERT_TRUE(is_pose_finite(&teb.poses[i].pose));
        TEST_ASSERT_TRUE(jp_plane_is_finite(teb.poses[i].interval) && teb.poses[i].interval >= 0.0f);
    }
}

static void plan_well(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    assert_finite();
}

/* ---- Driving ---- */

/* Where the robot is a period later, on the arc of its speed. */
static struct jp_plane_pose moved(const struct jp_plane_pose *from, const struct jp_plane_speed *speed)
{
    const float turn = speed->turn_rate * PERIOD;
    const struct jp_plane_pose half = {from->x, from->y, from->heading + 0.5f * turn};
    const struct jp_plane_pose way = {speed->forward * PERIOD, 0.0f, 0.5f * turn};

    return jp_plane_compose(&half, &way);
}

static float distance_from_goal(void)
{
    return jp_plane_length(task.goal.x - task.start.x, task.goal.y - task.start.y);
}

struct drive {
    bool has_arrived; /* within 5 cm of the goal */
    unsigned cycles;
    float top_speed;
    float least_speed;
    float clearance; /* least */
    float aside;     /* farthest from the x axis */
};

/* Follows the band until the robot is at the goal. */
static struct drive drive(unsigned cycles_max)
{
    struct drive driven = {.clearance = JP_OBSTACLE_NONE};

    while (!driven.has_arrived && driven.cycles < cycles_max) {
        plan_well();

        const float away = jp_obstacles_distance(&obstacles, &config.footprint, &task.start);

        driven.clearance = away < driven.clearance ? away : driven.clearance;
        driven.top_speed = result.speed.forward > driven.top_speed ? result.speed.forward : driven.top_speed;
        driven.least_speed = result.speed.forward < driven.least_speed ? result.speed.forward : driven.least_speed;
        driven.aside =
            jp_plane_magnitude(task.start.y) > driven.aside ? jp_plane_magnitude(task.start.y) : driven.aside;
        task.start = moved(&task.start, &result.speed);
        task.speed = result.speed;
        driven.has_arrived = distance_from_goal() < 0.05f;
        driven.cycles++;
    }
    return driven;
}

static void test_straight_way_is_driven_at_full_speed(void)
{
    const struct drive driven = drive(100);

    TEST_ASSERT_TRUE(driven.has_arrived);
    TEST_ASSERT_NEAR(0.03f, 1.0f, driven.top_speed);
    TEST_ASSERT_TRUE(driven.least_speed >= 0.0f);
    TEST_ASSERT_NEAR(1e-3f, 0.0f, driven.aside);
    /* 5 m at 1 m/s, and 0.6 s more at each end for the acceleration of 0.8 m/s². */
    TEST_ASSERT_TRUE(driven.cycles >= 55U && driven.cycles <= 80U);
}

static void test_robot_slows_down_for_the_goal(void)
{
    const struct drive driven = drive(100);

    TEST_ASSERT_TRUE(driven.has_arrived);
    /* The way left, 5 cm, is that of braking from 0.28 m/s at 0.8 m/s². */
    TEST_ASSERT_TRUE(task.speed.forward < 0.4f);
}

static void test_goal_speed_is_kept(void)
{
    task.goal_speed = 1.0f;

    const struct drive driven = drive(100);

    TEST_ASSERT_TRUE(driven.has_arrived);
    TEST_ASSERT_TRUE(task.speed.forward > 0.8f);
}

static void test_first_speed_is_the_acceleration_s(void)
{
    plan_well();
    TEST_ASSERT_TRUE(result.speed.forward > 0.1f && result.speed.forward < 0.7f);
    TEST_ASSERT_NEAR(1e-3f, 0.0f, result.speed.turn_rate);
    task.speed.forward = 1.0f;
    jp_teb_clear(&teb);
    plan_well();
    TEST_ASSERT_TRUE(result.speed.forward > 0.85f);
}

static void test_duration_is_that_of_the_drive(void)
{
    plan_well();
    for (unsigned i = 0; i < 20U; i++) {
        plan_well();
    }
    /* 5 m at 1 m/s and 1.25 s of acceleration. */
    TEST_ASSERT_NEAR(0.5f, 6.25f, result.duration);
    TEST_ASSERT_TRUE(result.clearance == JP_OBSTACLE_NONE);
}

static void test_steps_are_counted(void)
{
    plan_well();
    TEST_ASSERT_EQUAL_UINT(12, result.steps);
    TEST_ASSERT_TRUE(result.steps_rejected < result.steps);
}

static void test_corner_is_driven_without_leaving_the_path_far(void)
{
    const struct jp_plane_point corner[] = {{0.0f, 0.0f}, {3.0f, 0.0f}, {3.0f, 3.0f}};

    rig_path(corner, 3);

    const struct drive driven = drive(150);

    TEST_ASSERT_TRUE(driven.has_arrived);
    TEST_ASSERT_TRUE(driven.least_speed >= 0.0f);
}

static void test_other_heading_at_the_goal(void)
{
    task.goal.heading = 0.6f;
    TEST_ASSERT_TRUE(drive(150).has_arrived);
    TEST_ASSERT_NEAR(0.15f, 0.6f, task.start.heading);
}

static void test_free_heading_at_the_goal(void)
{
    task.goal.heading = 2.0f;
    task.is_heading_free = true;

    const struct drive driven = drive(150);

    TEST_ASSERT_TRUE(driven.has_arrived);
    TEST_ASSERT_NEAR(0.2f, 0.0f, task.start.heading);
    TEST_ASSERT_TRUE(driven.aside < 0.1f);
}

/* ---- Obstacles ---- */

static void test_box_on_the_way_is_passed(void)
{
    rig_box(2.0f, -0.6f, 2.5f, -0.1f);

    const struct drive driven = drive(200);

    TEST_ASSERT_TRUE(driven.has_arrived);
    TEST_ASSERT_TRUE(driven.clearance > 0.03f);
    TEST_ASSERT_TRUE(driven.aside > 0.25f);
}

static void test_robot_keeps_off_a_wall(void)
{
    rig_box(1.0f, -1.0f, 4.0f, -0.35f); /* 5 cm from the footprint of a robot on the path */

    const struct drive driven = drive(200);

    TEST_ASSERT_TRUE(driven.has_arrived);
    TEST_ASSERT_TRUE(driven.clearance > 0.07f);
}

/* 0.08 m to both sides, less than is wanted: the middle is kept, and the robot gets on. */
static void test_narrow_corridor_is_driven_in_its_middle(void)
{
    rig_box(-1.0f, 0.38f, 6.0f, 0.6f);
    rig_box(-1.0f, -0.6f, 6.0f, -0.38f);

    const struct drive driven = drive(150);

    TEST_ASSERT_TRUE(driven.has_arrived);
    TEST_ASSERT_TRUE(driven.clearance > 0.05f);
    TEST_ASSERT_TRUE(driven.top_speed > 0.8f);
}

static void test_clearance_is_that_of_the_band(void)
{
    rig_disc(0.0f, 0.9f, 0.1f); /* 0.5 m from the footprint */
    plan_well();
    TEST_ASSERT_NEAR(2e-3f, 0.5f, result.clearance);
}

/* Whatever drives away is no wall. */
static void test_clearance_is_that_of_what_stands(void)
{
    static const struct jp_plane_point velocities[] = {{-0.1f, 0.0f}, {0.1f, 0.0f}, {0.0f, -0.1f}, {0.0f, 0.1f}};

    for (unsigned i = 0; i < sizeof velocities / sizeof velocities[0]; i++) {
        const struct jp_obstacle mover = {
            .vertices = {{0.0f, 0.9f}}, .vertex_count = 1, .radius = 0.1f, .velocity = velocities[i]};

        rig_reset();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&obstacles, &mover));
        plan_well();
        TEST_ASSERT_TRUE(result.clearance == JP_OBSTACLE_NONE);
        rig_disc(0.0f, -1.1f, 0.1f); /* 0.7 m from the footprint, farther than the mover */
        plan_well();
        TEST_ASSERT_NEAR(2e-3f, 0.7f, result.clearance);
    }
}

static void test_far_end_of_the_band_may_still_be_blocked(void)
{
    rig_box(4.0f, -2.0f, 4.5f, 2.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    TEST_ASSERT_TRUE(result.clearance > 0.0f);
}

static void test_start_within_an_obstacle_is_blocked(void)
{
    plan_well();
    rig_disc(0.3f, 0.0f, 0.1f);
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, plan());
    TEST_ASSERT_EQUAL_UINT(0, teb.count);
    TEST_ASSERT_TRUE(result.speed.forward == 0.0f && result.speed.turn_rate == 0.0f);
}

/* The front is at 0.4 m in the rig; scans make walls look a little nearer than they are. */
static void test_start_may_overlap_as_much_as_the_header_says(void)
{
    const float front = config.footprint.front;

    rig_disc(front + 0.1f - 0.95f * JP_TEB_OVERLAP_MAX, 1.0e-3f, 0.1f);
    TEST_ASSERT_NOT_EQUAL_INT(JP_ERR_BLOCKED, plan());
    jp_obstacles_clear(&obstacles, &(struct jp_plane_point){0.0f, 0.0f});
    rig_disc(front + 0.1f - 1.05f * JP_TEB_OVERLAP_MAX, 1.0e-3f, 0.1f);
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, plan());
}

/* A margin that jp_obstacles_add() would refuse asks for turns beyond all that can be wrapped. */
static void test_steps_that_no_heading_can_take(void)
{
    rig_disc(1.0f, 0.2f, 0.1f);
    obstacles.shapes[0].margin = 1.0e30f;
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
    TEST_ASSERT_EQUAL_UINT(0, teb.count);
}

static void test_blocked_way_is_infeasible(void)
{
    rig_box(0.5f, -3.0f, 1.0f, 3.0f);
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
    TEST_ASSERT_EQUAL_UINT(0, teb.count);
    TEST_ASSERT_TRUE(result.speed.forward == 0.0f && result.speed.turn_rate == 0.0f);
    TEST_ASSERT_TRUE(result.clearance < 0.0f);
}

static void test_robot_goes_on_when_the_way_is_free_again(void)
{
    rig_box(0.5f, -3.0f, 1.0f, 3.0f);
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
    jp_obstacles_clear(&obstacles, &(struct jp_plane_point){0.0f, 0.0f});
    TEST_ASSERT_TRUE(drive(100).has_arrived);
}

/* ---- Reversing ---- */

static void test_robot_may_reverse_where_that_costs_nothing(void)
{
    config.weights.no_reversing = 0.0f;
    init();
    task.start.heading = 2.4f;

    const struct drive driven = drive(10);

    TEST_ASSERT_TRUE(driven.least_speed < -0.1f);
    TEST_ASSERT_TRUE(driven.least_speed >= -config.reverse_max);
}

static void test_robot_never_reverses_where_that_costs(void)
{
    const float headings[] = {0.0f, 0.8f, 1.6f, 2.4f, 3.1f, -1.0f, -2.0f};

    for (unsigned i = 0; i < sizeof headings / sizeof headings[0]; i++) {
        rig_reset();
        task.start.heading = headings[i];
        for (unsigned cycle = 0; cycle < 20U; cycle++) {
            plan_well();
            TEST_ASSERT_TRUE(result.speed.forward >= 0.0f);
            task.start = moved(&task.start, &result.speed);
            task.speed = result.speed;
        }
    }
}

/* ---- Speeds that are asked for ---- */

static void test_speeds_keep_their_limits(void)
{
    for (unsigned run = 0; run < 30U; run++) {
        rig_reset();
        random_state = run + 1U;
        task.start = (struct jp_plane_pose){rig_random(0.3f), rig_random(0.3f), rig_random(3.0f)};
        task.goal.heading = rig_random(3.0f);
        task.speed = (struct jp_plane_speed){rig_random(1.0f), rig_random(1.0f)};
        plan_well();
        TEST_ASSERT_TRUE(result.speed.forward >= 0.0f && result.speed.forward <= config.speed_max);
        TEST_ASSERT_TRUE(jp_plane_magnitude(result.speed.turn_rate) <= config.turn_rate_max);
        TEST_ASSERT_TRUE(jp_plane_magnitude(result.speed.turn_rate) * config.radius_min <=
                         result.speed.forward + 1e-5f);
    }
}

static void test_robot_that_turns_in_place_has_no_least_radius(void)
{
    const struct jp_plane_point back[] = {{0.0f, 0.0f}, {0.0f, 2.0f}};

    config.radius_min = 0.0f;
    init();
    rig_path(back, 2);
    task.start.heading = 0.0f;
    plan_well();
    TEST_ASSERT_TRUE(result.speed.turn_rate > 0.05f);
    TEST_ASSERT_TRUE(result.speed.turn_rate <= config.turn_rate_max);
}

/* ---- Odometry ---- */

static void plan_with_odometry(float wheel, float laser)
{
    config.weights.wheel_odometry = wheel;
    config.weights.laser_odometry = laser;
    init();
    task.start = (struct jp_plane_pose){0.0f, 0.0f, 0.0f};
    task.measured = (struct jp_plane_pose){0.06f, 0.03f, 0.04f};
    task.is_measured = true;
    plan_well();
}

/* By the share of the laser's weight. */
static void test_first_pose_is_between_wheels_and_laser(void)
{
    plan_with_odometry(1.0e4f, 3.0e4f);
    TEST_ASSERT_NEAR(3e-3f, 0.045f, result.start.x);
    TEST_ASSERT_NEAR(3e-3f, 0.0225f, result.start.y);
    TEST_ASSERT_NEAR(3e-3f, 0.03f, result.start.heading);
}

static void test_odometry_of_more_weight_wins(void)
{
    plan_with_odometry(1.0f, 1.0e5f);
    TEST_ASSERT_NEAR(1e-3f, 0.06f, result.start.x);
    setUp();
    plan_with_odometry(1.0e5f, 1.0f);
    TEST_ASSERT_NEAR(1e-3f, 0.0f, result.start.x);
}

static void test_without_the_laser_the_start_is_the_wheels(void)
{
    task.measured = (struct jp_plane_pose){0.06f, 0.03f, 0.04f};
    plan_well();
    TEST_ASSERT_TRUE(result.start.x == 0.0f && result.start.y == 0.0f && result.start.heading == 0.0f);
    plan_with_odometry(1000.0f, 0.0f);
    TEST_ASSERT_TRUE(result.start.x == 0.0f && result.start.y == 0.0f && result.start.heading == 0.0f);
}

/* ---- The next cycle ---- */

static void test_next_cycle_goes_on_with_the_band(void)
{
    float cost = 0.0f;

    rig_box(2.0f, -0.6f, 2.5f, -0.1f);
    for (unsigned cycle = 0; cycle < 15U; cycle++) {
        plan_well();
        if (cycle > 5U) {
            TEST_ASSERT_TRUE(result.cost < 1.3f * cost + 0.1f);
        }
        cost = result.cost;
        task.start = moved(&task.start, &result.speed);
        task.speed = result.speed;
    }
}

static void test_same_task_has_the_same_bits(void)
{
    struct jp_teb_result first;

    rig_box(2.0f, -0.6f, 2.5f, -0.1f);
    plan_well();
    first = result;
    init();
    memset(&result, 0xA5, sizeof result);
    plan_well();
    TEST_ASSERT_TRUE(first.speed.forward == result.speed.forward);
    TEST_ASSERT_TRUE(first.speed.turn_rate == result.speed.turn_rate);
    TEST_ASSERT_TRUE(first.cost == result.cost && first.duration == result.duration);
    TEST_ASSERT_EQUAL_UINT(first.steps_rejected, result.steps_rejected);
}

static void test_same_bits_everywhere(void)
{
    uint32_t hash = BITS_HASH_START;

    rig_box(2.0f, -0.6f, 2.5f, -0.1f);
    rig_disc(3.5f, 0.5f, 0.1f);
    task.measured = (struct jp_plane_pose){0.02f, -0.01f, 0.02f};
    task.is_measured = true;
    for (unsigned cycle = 0; cycle < 5U; cycle++) {
        plan_well();
        hash = hash_bits(hash, result.cost);
        for (unsigned i = 0; i < teb.count; i++) {
            hash = hash_bits(hash, teb.poses[i].pose.x);
            hash = hash_bits(hash, teb.poses[i].pose.y);
            hash = hash_bits(hash, teb.poses[i].pose.heading);
            hash = hash_bits(hash, teb.poses[i].interval);
        }
        task.start = moved(&result.start, &result.speed);
        task.measured = task.start;
        task.speed = result.speed;
    }
    TEST_ASSERT_EQUAL_HEX32(0x0D5B77DFU, hash);
}

/* ---- What is refused ---- */

static void test_null_pointers_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_teb_init(NULL, &config, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_teb_init(&teb, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_teb_init(&teb, &config, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_teb_plan(NULL, &task, &obstacles, &result));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_teb_plan(&teb, NULL, &obstacles, &result));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_teb_plan(&teb, &task, NULL, &result));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_teb_plan(&teb, &task, &obstacles, NULL));
}

static float not_a_number(void)
{
    volatile float large = FLT_MAX; /* the compiler must not see that it overflows */
    const float infinity = large * 2.0f;

    return infinity - infinity;
}

static void assert_refused(float *value, float wrong)
{
    const float right = *value;

    *value = wrong;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, plan());
    *value = right;
    plan_well();
}

static void test_values_out_of_their_ranges_are_refused(void)
{
    float *const poses[] = {&task.start.x, &task.start.y,    &task.goal.x,
                            &task.goal.y,  &task.measured.x, &task.measured.y};
    float *const headings[] = {&task.start.heading, &task.goal.heading, &task.measured.heading};
    float *const speeds[] = {&task.speed.forward, &task.speed.turn_rate};

    task.is_measured = true;
    for (unsigned i = 0; i < sizeof poses / sizeof poses[0]; i++) {
        assert_refused(poses[i], 40000.0f);
        assert_refused(poses[i], -40000.0f);
        assert_refused(poses[i], not_a_number());
    }
    for (unsigned i = 0; i < sizeof headings / sizeof headings[0]; i++) {
        assert_refused(headings[i], 1001.0f);
        assert_refused(headings[i], -1001.0f);
        assert_refused(headings[i], not_a_number());
    }
    for (unsigned i = 0; i < sizeof speeds / sizeof speeds[0]; i++) {
        assert_refused(speeds[i], 2.0e6f);
        assert_refused(speeds[i], -2.0e6f);
        assert_refused(speeds[i], not_a_number());
    }
    assert_refused(&task.goal_speed, -0.1f);
    assert_refused(&task.goal_speed, 1.1f);
    assert_refused(&task.goal_speed, not_a_number());
}

static void test_measurement_that_is_none_may_be_anything(void)
{
    task.measured.x = not_a_number();
    plan_well();
}

static void test_path_too_short_is_refused(void)
{
    task.path_count = 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, plan());
    task.path_count = 2;
    task.path = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, plan());
}

static void test_start_at_the_goal_has_zero_length(void)
{
    task.goal = (struct jp_plane_pose){0.0009f, 0.0f, 1.0f};
    result.speed.forward = 1.0f;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, plan());
    TEST_ASSERT_TRUE(result.speed.forward == 0.0f);
    task.goal.x = 0.0011f;
    plan_well();
}

/* ---- Settings ---- */

#define FIELD(member)                                                                                                  \
    {                                                                                                                  \
        offsetof(struct jp_teb_config, member), #member                                                                \
    }

static const struct field {
    size_t offset;
    const char *name;
} positive_fields[] =
    {
        FIELD(speed_max),         FIELD(reverse_max),          FIELD(turn_rate_max), FIELD(acceleration),
        FIELD(turn_acceleration), FIELD(footprint.half_width), FIELD(interval),      FIELD(hysteresis),
},
  fields_from_0[] = {
      FIELD(radius_min),
      FIELD(footprint.front),
      FIELD(footprint.rear),
      FIELD(clearance),
      FIELD(weights.nonholonomic),
      FIELD(weights.speed),
      FIELD(weights.turn_rate),
      FIELD(weights.turn_radius),
      FIELD(weights.acceleration),
      FIELD(weights.turn_acceleration),
      FIELD(weights.obstacle),
      FIELD(weights.path),
      FIELD(weights.second),
      FIELD(weights.metre),
      FIELD(weights.drag),
      FIELD(weights.no_reversing),
      FIELD(weights.wheel_odometry),
      FIELD(weights.laser_odometry),
};

static void assert_wrong(const char *name)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_teb_init(&teb, &config, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
}

static void assert_wrong_value(const struct field *member, float wrong)
{
    float *const value = (float *)(void *)((char *)&config + member->offset);
    const float right = *value;

    *value = wrong;
    assert_wrong(member->name);
    *value = right;
}

static void assert_right_value(const struct field *member, float right)
{
    float *const value = (float *)(void *)((char *)&config + member->offset);
    const float before = *value;

    *value = right;
    init();
    *value = before;
}

/* So long an interval leaves the hysteresis nearly all of its range. */
static void test_settings_at_both_ends_of_their_ranges(void)
{
    config.hysteresis = 1.0e-3f;
    config.interval = 1.0e6f;
    for (unsigned i = 0; i < sizeof positive_fields / sizeof positive_fields[0]; i++) {
        assert_wrong_value(&positive_fields[i], 0.999e-3f);
        assert_wrong_value(&positive_fields[i], 1.001e6f);
        assert_wrong_value(&positive_fields[i], not_a_number());
        if (strcmp(positive_fields[i].name, "interval") != 0) {
            assert_right_value(&positive_fields[i], 1.0e-3f);
        }
        if (strcmp(positive_fields[i].name, "hysteresis") != 0) {
            assert_right_value(&positive_fields[i], 1.0e6f);
        }
    }
    for (unsigned i = 0; i < sizeof fields_from_0 / sizeof fields_from_0[0]; i++) {
        assert_wrong_value(&fields_from_0[i], -0.001f);
        assert_wrong_value(&fields_from_0[i], 1.001e6f);
        assert_wrong_value(&fields_from_0[i], not_a_number());
        assert_right_value(&fields_from_0[i], 0.0f);
        assert_right_value(&fields_from_0[i], 1.0e6f);
    }
    init();
}

static void test_hysteresis_is_below_the_interval(void)
{
    config.hysteresis = config.interval;
    assert_wrong("hysteresis");
}

static void test_rounds_and_steps_have_their_ranges(void)
{
    const struct jp_teb_config right = config;

    config.rounds = 0;
    assert_wrong("rounds");
    config.rounds = 9;
    assert_wrong("rounds");
    config = right;
    config.steps = 0;
    assert_wrong("steps");
    config.steps = 17;
    assert_wrong("steps");
    config = right;
    config.rounds = 8;
    config.steps = 16;
    init();
}

/* ---- Extremes ---- */

static void test_no_settings_or_tasks_make_anything_but_numbers(void)
{
    for (unsigned run = 0; run < 60U; run++) {
        struct jp_teb_weights *const weights = &config.weights;
        float *const all[] = {&weights->second,      &weights->nonholonomic, &weights->speed,    &weights->turn_rate,
                              &weights->turn_radius, &weights->acceleration, &weights->obstacle, &weights->path,
                              &weights->metre,       &weights->no_reversing, &weights->drag};

        setUp();
        random_state = run + 1U;
        for (unsigned i = 0; i < sizeof all / sizeof all[0]; i++) {
            const uint32_t which = target_random(&random_state) % 4U;

            *all[i] = which == 0U ? 0.0f : which == 1U ? 1.0e6f : *all[i];
        }
        config.interval = run % 3U == 0U ? 0.002f : 0.25f;
        config.hysteresis = config.interval * 0.5f;
        init();
        rig_straight(run % 4U == 0U ? 3000.0f : 2.0f);
        task.start = (struct jp_plane_pose){rig_random(30.0f), rig_random(30.0f), rig_random(900.0f)};
        task.measured = (struct jp_plane_pose){rig_random(3.0e4f), rig_random(3.0e4f), rig_random(900.0f)};
        task.is_measured = run % 2U == 0U;
        task.speed = (struct jp_plane_speed){rig_random(1.0e5f), rig_random(1.0e5f)};
        for (unsigned i = 0; i < 6U; i++) {
            rig_disc(rig_random(5.0f), rig_random(5.0f), 0.2f);
        }
        for (unsigned cycle = 0; cycle < 3U; cycle++) {
            (void)plan();
            assert_finite();
        }
    }
}

/* Twenty boxes one on the other: what they take is spared at the steps, and what was found is told. */
static void test_work_on_obstacles_is_bounded(void)
{
    for (unsigned i = 0; i < JP_OBSTACLES_MAX; i++) {
        rig_box(1.5f + 0.01f * (float)i, -0.3f, 60.0f, 0.3f);
    }
    rig_straight(30.0f);
    config.rounds = 8;
    config.steps = 16;
    init();
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
    TEST_ASSERT_TRUE(result.steps > 0U && result.steps < 16U);
    TEST_ASSERT_TRUE(teb.internal.work < JP_TEB_WORK_MAX + 4U * 3U * JP_TEB_POSES_MAX);
}

/* No settings lead there. */
static void test_equations_that_overflow_move_nothing_and_are_infeasible(void)
{
    teb.internal.root_nonholonomic = 1.0e30f;
    task.start.heading = 0.1f;
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
    TEST_ASSERT_EQUAL_UINT(result.steps, result.steps_rejected);
    TEST_ASSERT_TRUE(teb.poses[1].pose.y == 0.0f && teb.poses[1].pose.heading == 0.0f);
    TEST_ASSERT_EQUAL_UINT(0, teb.count);
    TEST_ASSERT_TRUE(result.speed.forward == 0.0f && result.speed.turn_rate == 0.0f);
}
