/* What a slice of the navigator does, and what it looks at: shares of time, and the legs ahead when the map changes. */
#include "src/navigate/navigator_frame.h"
#include "tests/support/navigator_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

static unsigned slices_until(enum jp_navigator_state state)
{
    unsigned slices = 0;

    while (navigator.state != state) {
        TEST_ASSERT_LESS_THAN_UINT(WORK_MAX, slices);
        (void)jp_navigator_work(&navigator);
        slices++;
    }
    return slices;
}

/* ---- Shares of time ---- */

/** Cells x = 8 and 16, each open at one end. */
static void build_maze(void)
{
    put_column(8, 0, 17, JP_CELL_OCCUPIED);
    put_column(16, 6, SIDE - 1, JP_CELL_OCCUPIED);
}

/** Slices of an expansion until it leaves, when it would wait for the best route, or so long. */
static unsigned slices_with(uint32_t patience, unsigned *first)
{
    rig_reset();
    build_maze();
    config.slice = 1;
    config.patience = patience;
    config.way_block = NULL;
    begin(20, 18);
    for (*first = 0; !navigator.internal.has_route; (*first)++) {
        (void)jp_navigator_work(&navigator);
    }
    return *first + slices_until(JP_NAVIGATOR_JOINING);
}

/* The first expansion is in the call that begins the search. */
static void test_before_it_begins_it_waits_four_times_its_patience(void)
{
    unsigned first;
    const unsigned best = slices_with(100000000, &first);
    const uint32_t patience = (first + best) / 2U / 4U;

    TEST_ASSERT_GREATER_THAN_UINT32(first, 4U * patience);
    TEST_ASSERT_LESS_THAN_UINT32(best - 4U, 4U * patience);
    TEST_ASSERT_EQUAL_UINT32(4U * patience, slices_with(patience, &first));
}

/** Slices of its course, and then of its survey. */
static void join_in_slices_of(uint16_t slice, unsigned *lines, unsigned *survey)
{
    rig_reset();
    build_maze();
    config.slice = slice;
    begin(20, 18);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_JOINING));
    *lines = 0;
    do {
        (void)jp_navigator_work(&navigator);
        (*lines)++;
    } while (navigator.internal.course.answer == JP_COURSE_JOINING);
    *survey = 1U + slices_until(JP_NAVIGATOR_TURNING);
}

/* A line of the course, or a leg of the survey, takes as long as five expansions. */
static void test_a_slice_of_five_does_two_lines_or_legs(void)
{
    unsigned lines[2];
    unsigned survey[2];

    join_in_slices_of(4, &lines[0], &survey[0]);
    join_in_slices_of(5, &lines[1], &survey[1]);
    TEST_ASSERT_GREATER_THAN_UINT32(2, lines[0]);
    TEST_ASSERT_GREATER_THAN_UINT32(2, survey[0]);
    TEST_ASSERT_EQUAL_UINT32((lines[0] + 1U) / 2U, lines[1]);
    TEST_ASSERT_EQUAL_UINT32((survey[0] + 1U) / 2U, survey[1]);
}

/* Twenty looks for a way take as long as an expansion. */
static void test_a_slice_of_one_looks_twenty_times_for_a_way(void)
{
    const struct jp_way_cell from = {4, 4};
    const struct jp_way_cell to = {20, 18};
    const char *field = "";
    struct jp_lattice_way way;
    unsigned expected = 1;

    build_maze();
    TEST_ASSERT_EQUAL_INT(
        JP_OK, jp_lattice_way_start(&way, &jp_lattice_courier24, &terrain, &from, &to, way_block, sizeof way_block));
    while (jp_lattice_way_work(&way, 20) == JP_WAY_WORKING) {
        expected++;
    }
    config.slice = 1;
    make_planner(jp_planner_size(&map));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_init(&navigator, &config, &origin, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(20, 18, JP_ANY_HEADING));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_PROVING));
    TEST_ASSERT_EQUAL_UINT32(expected, slices_until(JP_NAVIGATOR_PLANNING));
}

/* ---- The legs ahead ---- */

/** Drives for so many slices along y = 4. */
static void drive_on(unsigned slices)
{
    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    for (unsigned i = 0; i < slices; i++) {
        TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_DRIVING, jp_navigator_work(&navigator));
    }
}

/** As nobody tells the navigator. */
static void occupy_silently(int32_t x, int32_t y)
{
    const uint32_t version = terrain.version;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, JP_CELL_OCCUPIED));
    terrain.version = version;
}

static void test_looks_at_the_legs_once_a_change_only(void)
{
    drive_on(4);
    occupy_silently(13, 4);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_DRIVING, jp_navigator_work(&navigator));
    rig_reset();
    drive_on(4);
    occupy(13, 20);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_DRIVING, jp_navigator_work(&navigator));
    occupy_silently(13, 4);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_DRIVING, jp_navigator_work(&navigator));
    occupy(13, 21);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_BRAKING, jp_navigator_work(&navigator));
}

/* What lies behind the last leg in memory is no leg. */
static void test_looks_at_no_more_legs_than_there_are(void)
{
    drive_on(4);
    legs[navigator.internal.course.count] = (struct jp_course_leg){.end = centre(18, 20)};
    occupy(18, 20);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_DRIVING, jp_navigator_work(&navigator));
    occupy_silently(13, 4);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_DRIVING, jp_navigator_work(&navigator));
}

static void test_what_appears_behind_it_does_not_matter(void)
{
    drive_on(30);
    occupy(5, 4);
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_DRIVING, jp_navigator_work(&navigator));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_UINT32(0, navigator.replans);
}

/* ---- Where it drives ---- */

/** The robot is so far to the left of its leg. */
static enum jp_navigator_state work_aside(jp_q16 aside)
{
    struct jp_place place;

    rig_reset();
    drive_on(4);
    robot.count = 0;
    robot.turning = 10;
    robot.view.position.y = aside - 4;
    do {
        robot.view.position.y++;
        place = jp_navigator_place(&navigator);
    } while (jp_frame_along_leg(&navigator, 0, &place.point).y != aside);
    return jp_navigator_work(&navigator);
}

static void test_brakes_when_it_leaves_its_line_by_more_than_its_margin(void)
{
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_DRIVING, work_aside(config.margin));
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_BRAKING, work_aside(config.margin + 1));
}

/** So far ahead of the end of the first leg. */
static void place_beyond(jp_q16 beyond)
{
    const struct jp_point end = jp_frame_in_odometry(&navigator, &legs[0].end);

    for (jp_q16 i = 0; i < 17 * 17; i++) {
        struct jp_place place;

        robot.view.position = (struct jp_point){end.x + i % 17 - 8, end.y + i / 17 - 8};
        place = jp_navigator_place(&navigator);
        if (jp_frame_along_leg(&navigator, 0, &place.point).x == beyond) {
            return;
        }
    }
    TEST_FAIL();
}

/* A leg is left once its end lies behind. */
static void test_the_next_leg_begins_beyond_the_end_of_one(void)
{
    for (jp_q16 beyond = 0; beyond <= 1; beyond++) {
        rig_reset();
        build_maze();
        begin(20, 18);
        TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
        (void)jp_navigator_work(&navigator);
        TEST_ASSERT_GREATER_THAN_UINT16(1, navigator.internal.run_end);
        robot.count = 0;
        robot.turning = 10;
        place_beyond(beyond);
        (void)jp_navigator_work(&navigator);
        TEST_ASSERT_EQUAL_UINT16(beyond, navigator.internal.leg);
    }
}

/* ---- A robot that does something else ---- */

static void test_motors_that_are_off_are_told_nothing(void)
{
    drive_on(4);
    robot.view.phase = JP_VEHICLE_OFF;
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_FAILED, jp_navigator_work(&navigator));
    TEST_ASSERT_EQUAL_UINT32(0, robot.stops);
}

/** A robot that drives the first of several legs, and stands. */
static void stand_on_first_leg(void)
{
    build_maze();
    begin(20, 18);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    (void)jp_navigator_work(&navigator);
    TEST_ASSERT_GREATER_THAN_UINT16(2, navigator.internal.course.count);
    robot.count = 0;
}

static void test_a_waypoint_where_it_is_already_ends_one_leg(void)
{
    stand_on_first_leg();

    const unsigned turns = robot.turns;

    robot.work_status = JP_ERR_ZERO_LENGTH;
    robot.view.heading += (jp_angle)1 << 30;
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_TURNING, jp_navigator_work(&navigator));
    TEST_ASSERT_EQUAL_UINT16(1, navigator.internal.leg);
    TEST_ASSERT_EQUAL_UINT32(turns, robot.turns);
}

/* It is where its last course began to have legs. */
static void test_where_it_is_already_no_leg_is_left(void)
{
    uint16_t count = 1;

    begin(18, 4);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(18, 4, 1U << 4));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_TURNING));
    (void)jp_navigator_legs(&navigator, &count);
    TEST_ASSERT_EQUAL_UINT16(0, count);
}
