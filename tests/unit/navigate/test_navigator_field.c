/* The navigator on a field of the ways to its goal, in place of a search: when it takes it, and when it does not. */
#include "tests/support/navigator_rig.h"

#include <joulepath/pose_field.h>

#include "tests/support/level_map.h"

enum { WIDTH = 10, HEIGHT = 6, POSES_MAX = 100000, LIMIT = JP_COST_MAX - 2 };

static const struct jp_goal goal = {7, 3, JP_ANY_HEADING};
static struct jp_pose_field field;

void setUp(void)
{
    rig_reset();
    map.width = WIDTH;
    map.height = HEIGHT;
    make_level_map(&map);
    origin = (struct jp_place){centre(2, 2), 0};
}

void tearDown(void)
{
}

/* The planner and the field share the rig's block. */
static void start(jp_cost limit)
{
    const char *name = "";

    make_planner(sizeof block / 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_init(&navigator, &config, &origin, &name));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pose_field_init(&field, &jp_lattice_courier24, JP_COST_PHYSICAL, &terrain,
                                                    &block[BLOCK_BYTES / 16], sizeof block / 2));
    TEST_ASSERT_EQUAL_INT(JP_OK,
                          jp_pose_field_start(&field, JP_POSE_FIELD_TO_ROOT, goal.x, goal.y, goal.headings, limit));
}

static void grow(void)
{
    unsigned poses = POSES_MAX;

    TEST_ASSERT_TRUE(jp_pose_field_grow(&field, &poses));
}

static void go(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_go_along(&navigator, &goal, &field));
}

static void work(unsigned slices, enum jp_navigator_state state)
{
    for (unsigned i = 0; i < slices; i++) {
        TEST_ASSERT_EQUAL_INT(state, jp_navigator_work(&navigator));
    }
}

static void test_drives_along_a_field_without_a_search(void)
{
    start(LIMIT);
    grow();
    go();
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_FIELD, navigator.internal.search);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OUT_OF_BUDGET, jp_planner_plan(&planner)->answer);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(goal.x, goal.y);
    TEST_ASSERT_GREATER_THAN_UINT32(0, robot.follows);
    TEST_ASSERT_EQUAL_UINT32(0, navigator.replans);
}

/* The lines come from the field: the planner has none. */
static void test_its_course_is_of_the_field(void)
{
    start(LIMIT);
    grow();
    go();
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_TURNING));
    TEST_ASSERT_EQUAL_PTR(&field, navigator.internal.course.internal.field);
}

/* What it drove before is not driven again instead. */
static void test_a_field_that_is_begun_anew_while_it_joins_is_given_up(void)
{
    start(LIMIT);
    grow();
    go();
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    robot.view.position = (struct jp_point){0, 0};
    go();
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_FIELD, navigator.internal.search);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pose_field_start(&field, JP_POSE_FIELD_TO_ROOT, goal.x, goal.y, goal.headings, 1));
    work(1, JP_NAVIGATOR_PLANNING);
    TEST_ASSERT_NULL(navigator.internal.field);
}

static void test_waits_until_the_robot_has_stood_for_its_patience(void)
{
    config.patience = 10U * config.slice;
    start(LIMIT);
    grow();
    go();
    work(9, JP_NAVIGATOR_PLANNING);
    work(1, JP_NAVIGATOR_JOINING);
}

static void test_a_robot_that_sways_waits_anew(void)
{
    config.patience = 10U * config.slice;
    start(LIMIT);
    grow();
    go();
    work(9, JP_NAVIGATOR_PLANNING);
    robot.view.position.x += JP_Q16(0.003);
    robot.view.position.y = 0;
    work(1, JP_NAVIGATOR_JOINING);

    go();
    work(9, JP_NAVIGATOR_PLANNING);
    robot.view.position.x += JP_Q16(0.0031);
    work(1, JP_NAVIGATOR_PLANNING);
    work(9, JP_NAVIGATOR_PLANNING);
    work(1, JP_NAVIGATOR_JOINING);
}

static void test_searches_while_the_field_grows(void)
{
    start(LIMIT);
    go();
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    TEST_ASSERT_NOT_EQUAL(JP_NAVIGATOR_FIELD, navigator.internal.search);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(goal.x, goal.y);
}

static void test_searches_where_the_field_does_not_reach(void)
{
    start(1);
    grow();
    go();
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    TEST_ASSERT_NOT_EQUAL(JP_NAVIGATOR_FIELD, navigator.internal.search);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
}

static void test_searches_without_a_field(void)
{
    start(LIMIT);
    grow();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_go_along(&navigator, &goal, NULL));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    TEST_ASSERT_NOT_EQUAL(JP_NAVIGATOR_FIELD, navigator.internal.search);
}

/* Its next goal has none. */
static void test_a_field_is_of_one_goal(void)
{
    start(LIMIT);
    grow();
    go();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_go(&navigator, &goal));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    TEST_ASSERT_NOT_EQUAL(JP_NAVIGATOR_FIELD, navigator.internal.search);
}

static void test_a_goal_that_is_refused_leaves_the_field_as_it_was(void)
{
    const struct jp_goal outside = {WIDTH, 3, JP_ANY_HEADING};

    start(LIMIT);
    grow();
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_navigator_go_along(&navigator, &outside, &field));
    TEST_ASSERT_NULL(navigator.internal.field);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_navigator_go_along(NULL, &goal, &field));
}

/* A robot that leaves its lines by more than there is room for cannot take those of the field; then the planner is
 * asked, and what it finds has no room either. */
static void test_a_field_whose_lines_have_no_room_is_given_up(void)
{
    start(LIMIT);
    grow();
    go();
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    robot.aside = JP_Q16(1);
    robot.beyond = JP_Q16(1);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PLANNING));
    TEST_ASSERT_NULL(navigator.internal.field);
    robot.aside = 0;
    robot.beyond = 0;
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    expect_at(goal.x, goal.y);
}
