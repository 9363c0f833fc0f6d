/* The patrol without scans or poses of the laser. */
#include "tests/support/patrol_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

/* ---- Scans that are missing ---- */

static void test_nothing_is_driven_before_the_first_scan(void)
{
    is_blind = true;
    rig_go(4.0f, 0.0f);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_SCAN);
    rig_expect_stand();
    is_blind = false;
    rig_cycles(3);
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
}

static void test_few_missing_scans_do_no_harm(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);
    is_blind = true;
    rig_cycles(config.dropouts_max);
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    TEST_ASSERT_EQUAL_UINT32(config.dropouts_max, patrol.counts.scans_missing);
    is_blind = false;
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.waits);
}

static void test_obstacles_stay_while_scans_are_missing(void)
{
    rig_wall_ahead();
    rig_cycle();

    const uint8_t count = patrol.obstacles.count;

    TEST_ASSERT_TRUE(count > 0);
    is_blind = true;
    rig_cycles(2);
    TEST_ASSERT_EQUAL_UINT8(count, patrol.obstacles.count);
}

static void test_too_many_missing_scans_stop_the_robot(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);
    is_blind = true;
    rig_cycles(config.dropouts_max + 1U);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_SCAN);
    rig_expect_stand();
    (void)rig_until(JP_PATROL_STOPPED, config.waits_max + 1U);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_NO_SCAN);
}

static void test_scan_of_beams_that_dropped_out_is_missing(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);
    for (unsigned i = 0; i <= config.dropouts_max; i++) {
        rig_sense();
        for (unsigned k = 0; k < RIG_BEAMS; k++) {
            ranges[k] = k % 5U == 0U ? 3.0f : -1.0f;
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    }
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_SCAN);
}

static void test_gap_of_hours_is_not_taken_for_a_short_one(void)
{
    is_blind = true;
    laser_shift = 5.0f;
    rig_sense();
    for (unsigned i = 0; i < 65536U + 2U; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    }
    rig_go(4.0f, 0.0f);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_LOST);
    laser_shift = 0.0f;
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_SCAN);
}

/* More shapes than fit: the nearest are kept, the others counted. */
static void test_more_obstacles_than_fit(void)
{
    config.scan.gap = 0.12f;
    rig_init();
    for (unsigned i = 0; i < 30U; i++) {
        const struct jp_plane_point along = jp_plane_direction((float)i * 2.0f * JP_PLANE_PI / 30.0f);
        const float distance = i % 3U == 0U ? 3.0f : 2.0f + 0.01f * (float)i;
        const float x = distance * along.x;
        const float y = distance * along.y;

        rig_wall(x - 0.12f * along.y, y + 0.12f * along.x, x + 0.12f * along.y, y - 0.12f * along.x);
    }
    rig_cycle();
    TEST_ASSERT_EQUAL_UINT8(JP_OBSTACLES_MAX, patrol.obstacles.count);
    TEST_ASSERT_EQUAL_UINT32(10, patrol.counts.shapes_dropped);
    for (unsigned i = 0; i < JP_OBSTACLES_MAX; i++) {
        TEST_ASSERT_TRUE(patrol.obstacles.distance[i] < 2.5f);
    }
    rig_cycle();
    TEST_ASSERT_EQUAL_UINT32(20, patrol.counts.shapes_dropped);
}

/* ---- Poses of the laser ---- */

static void test_laser_corrects_the_wheels(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(3);
    input.wheels.x += 0.2f; /* they slip */
    rig_cycles(4);
    TEST_ASSERT_NEAR(0.01f, robot.x - input.speed.forward * RIG_PERIOD, patrol.pose.x);
}

static void test_jump_is_rejected(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);
    laser_shift = 0.5f;
    rig_cycles(config.dropouts_max);
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    TEST_ASSERT_NEAR(0.02f, robot.x - input.speed.forward * RIG_PERIOD, patrol.pose.x);
    TEST_ASSERT_EQUAL_UINT32(config.dropouts_max, patrol.counts.laser_rejected);
    laser_shift = 0.0f;
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.waits);
}

static void test_jump_of_the_heading_is_rejected(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);
    laser_turn = -0.5f;
    rig_cycle();
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.laser_rejected);
    TEST_ASSERT_NEAR(0.02f, 0.0f, patrol.pose.heading);
}

static void test_lasting_jump_stops_the_robot(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);
    laser_shift = 0.5f;
    rig_cycles(config.dropouts_max + 1U);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_LOST);
    rig_expect_stand();
    (void)rig_until(JP_PATROL_STOPPED, config.waits_max + 1U);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_LOST);
}

static void test_robot_drives_some_way_without_the_laser(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);

    const float from = robot.x;

    is_lost = true;
    (void)rig_until(JP_PATROL_WAITING, RIG_LONG);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_LOST);
    TEST_ASSERT_NEAR(0.15f, from + config.blind_max, robot.x);
    is_lost = false;
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.waits);
}

/* ---- A localiser ---- */

static void test_a_robot_that_is_lost_stands(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);
    for (int i = 0; i < 3; i++) {
        rig_sense();
        input.is_lost = true;
        input.has_laser = false;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
        rig_expect(JP_PATROL_WAITING, JP_PATROL_LOST);
        rig_expect_stand();
    }
    input.is_lost = false;
    rig_cycles(5);
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
}

static void test_a_new_place_is_taken_however_far(void)
{
    rig_cycle();
    rig_sense();
    input.laser.x += 3.0f;
    input.is_new_place = true;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    TEST_ASSERT_NEAR(1.0e-5f, input.laser.x, patrol.pose.x);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.laser_rejected);
    input.is_new_place = false;
}
