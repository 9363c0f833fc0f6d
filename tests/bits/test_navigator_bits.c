/* The same searches, courses, turns and drives of the navigator on every core: a hash over drives through walls with
 * gaps, with robots that drift, slide and roll on, and cells that change on the way. */
#include "tests/support/navigator_rig.h"

enum { DRIVES = 24, SLICES = 3000, WALL = 5 };

static uint32_t hash;
static uint32_t state;

void setUp(void)
{
    hash = 2166136261u;
    state = 1;
}

void tearDown(void)
{
}

static void mix(uint32_t value)
{
    hash = (hash ^ value) * 16777619u;
}

/* Below `range`. */
static int32_t below(int32_t range)
{
    state = state * 1664525U + 1013904223U;
    return (int32_t)((uint64_t)state * (uint32_t)range >> 32);
}

static void mix_point(struct jp_point point)
{
    mix((uint32_t)point.x);
    mix((uint32_t)point.y);
}

static void mix_robot(void)
{
    mix_point(robot.view.position);
    mix(robot.view.heading);
    mix(robot.heading);
    mix(robot.stops + 16U * robot.turns + 256U * robot.follows);
    mix(robot.slowest);
    for (uint16_t i = 0; i < robot.count; i++) {
        mix_point(robot.targets[i]);
    }
}

static void mix_run(void)
{
    mix_point(robot.run.start);
    mix(robot.run.heading);
    mix(robot.run.count + 256U * robot.run.slower);
    mix(robot.surveyed);
}

static void mix_legs(void)
{
    uint16_t count = 0;
    const struct jp_course_leg *leg = jp_navigator_legs(&navigator, &count);
    struct jp_progress progress;

    mix(count);
    for (uint16_t i = 0; i < count; i++) {
        mix_point(leg[i].end);
        mix((uint32_t)leg[i].aside);
        mix((uint32_t)leg[i].beyond);
        mix(leg[i].is_stop ? 1U : 0U);
    }
    if (jp_navigator_progress(&navigator, &progress) == JP_OK) {
        mix((uint32_t)progress.length);
        mix((uint32_t)progress.duration);
        mix((uint32_t)progress.energy.energy);
        mix((uint32_t)progress.energy.deviation);
    }
}

static void build_walls(void)
{
    for (int32_t x = 7 + below(2); x < SIDE - 5; x += WALL + below(3)) {
        const int32_t gap = below(SIDE - 8);

        for (int32_t y = 0; y < SIDE; y++) {
            if (y < gap || y >= gap + 7) {
                put_column(x, y, y, JP_CELL_OCCUPIED);
            }
        }
    }
}

static void make_robot(int drive)
{
    rig_reset();
    build_walls();
    origin.point.x += below(map.resolution) - map.resolution / 2;
    origin.point.y += below(map.resolution) - map.resolution / 2;
    if (drive % 3 == 0) { /* nearer than the planner likes */
        put_column(4 + below(2), 6, 6, JP_CELL_OCCUPIED);
    }
    origin.heading = (jp_angle)below(INT32_MAX) * 2U;
    robot.drift = drive % 4 == 1 ? JP_Q16(0.002) : 0;
    robot.slide = drive % 4 == 2 ? JP_Q16(0.01) : 0;
    robot.beyond = drive % 3 == 1 ? JP_Q16(0.15) : 0;
    robot.aside = drive % 3 == 2 ? JP_Q16(0.02) : 0;
    robot.turned_by = drive % 5 == 4 ? JP_ANGLE_DEGREES(2) : 0;
    robot.infeasible = (uint16_t)below(4);
    config.patience = (uint32_t)below(400);
    config.way_size = drive % 7 == 6 ? 0U : sizeof way_block;
    config.way_block = drive % 7 == 6 ? NULL : way_block;
}

static void drive_once(int drive)
{
    const struct jp_goal goal = {(int16_t)(18 + below(4)), (int16_t)(3 + below(18)),
                                 (uint16_t)(drive % 2 != 0 ? JP_ANY_HEADING : 1U << below(16))};

    make_robot(drive);
    init();
    mix((uint32_t)jp_navigator_go(&navigator, &goal));
    for (int i = 0; i < SLICES && navigator.state < JP_NAVIGATOR_ARRIVED; i++) {
        mix((uint32_t)jp_navigator_work(&navigator) + 256U * (uint32_t)navigator.reason);
        mix(navigator.replans);
        mix_robot();
        mix_run();
        mix_legs();
        if (i % 500 == 499) {
            mix((uint32_t)jp_navigator_set_cell(&navigator, below(SIDE), below(SIDE), JP_CELL_OCCUPIED));
        }
    }
    mix((uint32_t)navigator.status);
}

static void test_drives(void)
{
    for (int i = 0; i < DRIVES; i++) {
        drive_once(i);
    }
    TEST_ASSERT_EQUAL_HEX32(0xEAF828BD, hash);
}
