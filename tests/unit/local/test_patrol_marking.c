/* The copy of the map with marks: what it begins as, and that making and forgetting marks in slices is done in as many
 * calls as the work of each allows. */
#include "src/local/patrol_marking.h"

#include "src/base/plane.h"
#include "tests/support/near.h"

enum { WIDTH = 40, HEIGHT = 23, BEAMS = 30 };

static struct jp_terrain given;
static uint64_t given_block[HEIGHT * 2 + (WIDTH * HEIGHT + 7)];
static uint64_t marked_block[sizeof given_block / sizeof(uint64_t)];
static struct jp_patrol_mission mission;
static struct jp_patrol_input input;
static float ranges[BEAMS];

static void make(struct jp_terrain *map, uint64_t *block)
{
    const struct jp_terrain_config config = {
        .width = WIDTH, .height = HEIGHT, .resolution = JP_Q16(0.125), .has_elevation = true};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(map, &config, block, sizeof given_block, &field));
}

static enum jp_cell cell_of(int i)
{
    static const enum jp_cell kinds[] = {JP_CELL_FREE, JP_CELL_OCCUPIED, JP_CELL_UNKNOWN};

    return kinds[i * 7 % 11 % 3];
}

void setUp(void)
{
    make(&given, given_block);
    make(&mission.internal.marked, marked_block);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&given, i % WIDTH, i / WIDTH, cell_of(i)));
        TEST_ASSERT_EQUAL_INT(
            JP_OK, jp_terrain_set_elevation(&given, i % WIDTH, i / WIDTH, (jp_elevation)(i * 37 % 1000 - 500)));
    }
    mission.config.map = &given;
    mission.config.patrol.scan.tolerance = 0.04f;
    mission.internal.marks = JP_MARKS_NONE;
    mission.internal.rows_stale = 3;
    mission.state = JP_MISSION_UNDER_WAY;
    mission.patrol.pose = (struct jp_plane_pose){2.5f, 1.44f, 0.0f};
    input = (struct jp_patrol_input){.scan = {ranges, BEAMS, -JP_PLANE_PI, 2.0f * JP_PLANE_PI / BEAMS},
                                     .sensor = {0.01f, 0.02f, 0.3f}};
    for (int i = 0; i < BEAMS; i++) {
        ranges[i] = 0.7f;
    }
}

void tearDown(void)
{
}

static void expect_rows(int first)
{
    for (int i = first * WIDTH; i < WIDTH * HEIGHT; i++) {
        TEST_ASSERT_EQUAL_INT(cell_of(i), jp_terrain_cell(&mission.internal.marked, i % WIDTH, i / WIDTH));
    }
}

static void fill(enum jp_cell cell)
{
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&mission.internal.marked, i % WIDTH, i / WIDTH, cell));
    }
}

static void test_it_begins_as_the_map_that_is_given(void)
{
    fill(JP_CELL_OCCUPIED);
    jp_patrol_marking_start(&mission);
    expect_rows(0);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        TEST_ASSERT_EQUAL_INT(jp_terrain_elevation(&given, i % WIDTH, i / WIDTH),
                              jp_terrain_elevation(&mission.internal.marked, i % WIDTH, i / WIDTH));
    }
    TEST_ASSERT_FALSE(jp_patrol_marking_is_due(&mission));
}

static void test_marks_are_forgotten_at_once(void)
{
    fill(JP_CELL_FREE);
    jp_patrol_marking_forget_now(&mission);
    expect_rows(0);
    TEST_ASSERT_FALSE(jp_patrol_marking_is_due(&mission));
}

/* 64 cells in an expansion's time, whole rows, and one at least. */
static void test_marks_are_forgotten_in_slices(void)
{
    static const unsigned expansions[] = {0, 1, 2, 5, 10};

    for (unsigned i = 0; i < 5U; i++) {
        const unsigned rows = expansions[i] * 64U / WIDTH + 1U;
        unsigned calls = 0;

        fill(JP_CELL_OCCUPIED);
        jp_patrol_marking_forget(&mission);
        mission.internal.marks = JP_MARKS_NONE;
        while (jp_patrol_marking_is_due(&mission)) {
            TEST_ASSERT_FALSE(jp_patrol_marking_work(&mission, expansions[i]));
            calls++;
            expect_rows(calls * rows < HEIGHT ? (int)(HEIGHT - calls * rows) : 0);
            TEST_ASSERT_EQUAL_UINT16(calls * rows < HEIGHT ? HEIGHT - calls * rows : 0U, mission.internal.rows_stale);
        }
        TEST_ASSERT_EQUAL_UINT((HEIGHT + rows - 1U) / rows, calls);
    }
}

static unsigned marks_on_open_map(void)
{
    unsigned count = 0;

    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        count += jp_terrain_cell(&mission.internal.marked, i % WIDTH, i / WIDTH) == JP_CELL_OCCUPIED ? 1U : 0U;
    }
    return count;
}

static void open_maps(void)
{
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&given, i % WIDTH, i / WIDTH, JP_CELL_FREE));
    }
    jp_patrol_marking_forget_now(&mission);
}

/* The work of an expansion is that of a quarter of a beam, and one is looked at in any case; what is made in slices is
 * what is made at once. */
static void test_marks_are_made_in_slices(void)
{
    static const unsigned expansions[] = {0, 3, 4, 20, 23, 24, 1000};

    open_maps();
    for (unsigned i = 0; i < 7U; i++) {
        const unsigned beams = expansions[i] / 4U + 1U;
        unsigned calls = 1;

        jp_patrol_marking_forget_now(&mission);
        jp_patrol_marking_begin(&mission, &input, JP_MARKS_PLAN);
        TEST_ASSERT_TRUE(jp_patrol_marking_is_due(&mission));
        while (!jp_patrol_marking_work(&mission, expansions[i])) {
            TEST_ASSERT_EQUAL_UINT16(calls * beams, mission.internal.beam);
            TEST_ASSERT_EQUAL_UINT(0, marks_on_open_map());
            calls++;
        }
        TEST_ASSERT_EQUAL_UINT((BEAMS + beams - 1U) / beams, calls);
        TEST_ASSERT_EQUAL_UINT16(BEAMS, mission.internal.beam);
        TEST_ASSERT_GREATER_THAN_UINT(20, marks_on_open_map());
    }
}

static bool is_marked_at(float range, float bearing)
{
    const struct jp_plane_pose scanner = jp_plane_compose(&mission.patrol.pose, &input.sensor);
    const struct jp_plane_point along = jp_plane_direction(scanner.heading + bearing);
    const float x = (scanner.x + range * along.x) / 0.125f;
    const float y = (scanner.y + range * along.y) / 0.125f;

    return jp_terrain_cell(&mission.internal.marked, (int32_t)x, (int32_t)y) == JP_CELL_OCCUPIED;
}

static void expect_marks(float range)
{
    for (int i = 0; i < BEAMS; i++) {
        TEST_ASSERT_TRUE(is_marked_at(range + 0.04f, input.scan.first_angle + (float)i * input.scan.angle_step));
    }
}

/* By the pose of the robot when the scan came, and that of the scanner on it. */
static void test_marks_are_where_beams_end(void)
{
    open_maps();
    jp_patrol_marking_begin(&mission, &input, JP_MARKS_PLAN);
    mission.patrol.pose.x += 0.7f;
    while (!jp_patrol_marking_work(&mission, 8)) {
    }
    mission.patrol.pose.x -= 0.7f;
    expect_marks(0.7f);
}

/* The rest is of the next scan, from where the robot is then, unless it is lost. */
static void test_a_scan_that_comes_meanwhile_is_marked(void)
{
    open_maps();
    jp_patrol_marking_begin(&mission, &input, JP_MARKS_PLAN);
    mission.patrol.pose.x += 0.5f;
    mission.patrol.pose.heading = 0.4f;
    for (int i = 0; i < BEAMS; i++) {
        ranges[i] = 0.9f;
    }
    jp_patrol_marking_see(&mission, &input);
    while (!jp_patrol_marking_work(&mission, 8)) {
    }
    expect_marks(0.9f);
    jp_patrol_marking_begin(&mission, &input, JP_MARKS_PLAN);
    input.is_lost = true;
    mission.patrol.pose.x += 0.3f;
    jp_patrol_marking_see(&mission, &input);
    input.is_lost = false;
    input.scan.ranges = NULL;
    jp_patrol_marking_see(&mission, &input);
    input.scan.ranges = ranges;
    jp_patrol_marking_forget_now(&mission);
    while (!jp_patrol_marking_work(&mission, 8)) {
    }
    mission.patrol.pose.x -= 0.3f;
    expect_marks(0.9f);
}

/* Nothing is marked of a robot that is lost, or without a scan, but what marks are for is done. */
static void test_without_a_scan_all_marks_are_made(void)
{
    open_maps();
    for (int i = 0; i < 2; i++) {
        input.is_lost = i == 0;
        input.scan.ranges = i == 1 ? NULL : ranges;
        jp_patrol_marking_begin(&mission, &input, JP_MARKS_DETOUR);
        TEST_ASSERT_EQUAL_INT(JP_MARKS_DETOUR, mission.internal.marks);
        TEST_ASSERT_TRUE(jp_patrol_marking_work(&mission, 0));
        TEST_ASSERT_EQUAL_UINT(0, marks_on_open_map());
    }
}

/* The goal is watched while it drives; a path is not driven while another is planned. */
static void test_only_a_watch_leaves_it_under_way(void)
{
    mission.internal.beam = 9;
    jp_patrol_marking_begin(&mission, &input, JP_MARKS_WATCH);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
    TEST_ASSERT_EQUAL_UINT16(0, mission.internal.beam);
    jp_patrol_marking_begin(&mission, &input, JP_MARKS_DETOUR);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, mission.state);
    mission.state = JP_MISSION_UNDER_WAY;
    jp_patrol_marking_begin(&mission, &input, JP_MARKS_PLAN);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, mission.state);
}

/* The last row that is stale is due as well. */
static void test_a_row_that_is_stale_is_due(void)
{
    mission.internal.rows_stale = 1;
    TEST_ASSERT_TRUE(jp_patrol_marking_is_due(&mission));
    mission.internal.rows_stale = 0;
    TEST_ASSERT_FALSE(jp_patrol_marking_is_due(&mission));
    mission.internal.marks = JP_MARKS_WATCH;
    TEST_ASSERT_TRUE(jp_patrol_marking_is_due(&mission));
}
