/* A drive to a goal on a map over a bus on which things happen: the operator falls silent, anybody says Stand, the
 * controller restarts while it receives the map and while it drives, the operator restarts, a box stands where the
 * robot goes. Each time the robot stays upright, stands, and goes to the goal when it is told to again. */
#include <math.h>
#include <string.h>

#include "sim/balancer/rig.h"
#include "sim/bus/bus_drive.h"
#include "sim/bus/local_ecu.h"
#include "tests/support/commands.h"
#include "unity.h"

enum { WIDTH = 60, HEIGHT = 40, STREAM_MAX = 2500, GOAL_X = 45, GOAL_Y = 20 };

#define CELL 0.1 /* m */

/** Ticks: of a stand that follows, of a whole drive. */
#define STAND_TICKS 8000
#define DRIVE_TICKS 60000

static struct local_ecu ecu;
static struct bus_drive drive;
static struct jp_navigation_operator commander;
static struct robot_file robot;
static uint64_t map_memory[WIDTH * HEIGHT / 8];
static uint8_t stream[STREAM_MAX];
static struct jp_map_stream map;
static const struct jp_map_goal place = {.x = GOAL_X, .y = GOAL_Y};

static void make_map(void)
{
    const struct jp_terrain_config config = {.width = WIDTH, .height = HEIGHT, .resolution = JP_Q16(0.1)};
    const struct jp_place origin = {{JP_Q16(1.05), JP_Q16(1.05)}, 0};
    struct jp_terrain terrain;
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &config, map_memory, sizeof map_memory, &field));
    /* Rows that differ take many frames. */
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        (void)jp_terrain_set_cell(&terrain, i % WIDTH, i / WIDTH,
                                  i % WIDTH > 52 && i / 3 * i % 7 % 3 == 1 ? JP_CELL_OCCUPIED : JP_CELL_FREE);
    }
    map = (struct jp_map_stream){.bytes = stream, .id = 1};
    map.length = (uint16_t)jp_map_encode(&terrain, &origin, stream, sizeof stream);
    TEST_ASSERT_GREATER_THAN_UINT16(0, map.length);
}

void setUp(void)
{
    const struct robot_entry *entry = rig_find_robot("courier24");
    struct jp_can_link link;

    TEST_ASSERT_NOT_NULL(entry);
    TEST_ASSERT_TRUE(robot_file_load("sim/robots/courier24.cfg", &robot));
    TEST_ASSERT_TRUE(local_ecu_start(&ecu, entry, entry->energy, &link));
    bus_drive_init(&drive, &robot, 1, &link);
    memset(&commander, 0, sizeof commander);
    drive.navigation = &commander;
    make_map();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &place));
}

void tearDown(void)
{
}

static void pass(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        TEST_ASSERT_TRUE(bus_drive_lockstep(&drive));
    }
}

static void pass_until(enum jp_navigation_phase phase)
{
    for (unsigned i = 0; i < DRIVE_TICKS && commander.phase != phase; i++) {
        pass(1);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(phase, commander.phase, jp_navigation_failure_text(commander.failure));
}

static double speed(void)
{
    return drive.plant.world.plant.state.wheel_rate * robot.wheel.radius_m;
}

static void pass_until_it_rolls(void)
{
    pass_until(JP_NAVIGATION_DRIVING);
    for (unsigned i = 0; i < DRIVE_TICKS && speed() < 0.2; i++) {
        pass(1);
    }
    TEST_ASSERT_TRUE(speed() >= 0.2);
}

static void expect_stand(void)
{
    pass(STAND_TICKS);
    TEST_ASSERT_EQUAL_UINT8(JP_ROBOT_BALANCING, drive.view.status.state);
    TEST_ASSERT_TRUE(fabs(speed()) < 0.05);
    TEST_ASSERT_TRUE(fabs(drive.plant.world.plant.state.pitch) < 0.1);
    TEST_ASSERT_EQUAL_UINT16(0, drive.view.errors.faults);
}

static void expect_arrival(void)
{
    const struct plant *plant = &drive.plant.world.plant;

    pass_until(JP_NAVIGATION_DONE);
    expect_stand();
    TEST_ASSERT_TRUE(fabs(plant->x - (GOAL_X + 0.5) * CELL + 1.05) < 0.15);
    TEST_ASSERT_TRUE(fabs(plant->y - (GOAL_Y + 0.5) * CELL + 1.05) < 0.15);
}

static void go_again(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &place));
    expect_arrival();
}

static void expect_failure(enum jp_navigation_failure failure)
{
    pass_until(JP_NAVIGATION_FAILED);
    TEST_ASSERT_EQUAL_INT_MESSAGE(failure, commander.failure, jp_navigation_failure_text(commander.failure));
}

static void test_arrives_when_nothing_happens(void)
{
    expect_arrival();
}

static void test_the_operator_falls_silent(void)
{
    pass_until_it_rolls();
    drive.conditions.operator_silent = true;
    pass(450);
    TEST_ASSERT_TRUE(speed() > 0.1);
    expect_stand();
    TEST_ASSERT_EQUAL_UINT8(JP_OPERATOR_LOST, drive.view.status.operator_state);
    TEST_ASSERT_EQUAL_UINT8(JP_NAVIGATOR_IDLE, drive.view.navigation.state);
    drive.conditions.operator_silent = false;
    expect_failure(JP_NAVIGATION_SILENCE);
    go_again();
}

static void test_the_operator_pauses_for_less(void)
{
    pass_until_it_rolls();
    drive.conditions.operator_silent = true;
    pass(380);
    drive.conditions.operator_silent = false;
    expect_arrival();
}

static void test_anybody_says_stand(void)
{
    struct jp_can_frame frame;

    pass_until_it_rolls();
    frame = operator_command((commander.command_counter + 9U) & 15U, JP_MODE_STAND, 0);
    TEST_ASSERT_EQUAL_INT(JP_OK, drive.link.port.send(drive.link.port.context, &frame));
    expect_failure(JP_NAVIGATION_STOPPED);
    expect_stand();
    go_again();
}

static void pass_until_half_of_the_map_is_there(void)
{
    pass_until(JP_NAVIGATION_SENDING);
    while (drive.view.map.received * JP_MAP_DATA < map.length / 3U) {
        pass(1);
        TEST_ASSERT_EQUAL_INT(JP_NAVIGATION_SENDING, commander.phase);
    }
}

static void reset_ecu(unsigned ticks)
{
    drive.conditions.ecu_reset = true;
    pass(ticks);
    drive.conditions.ecu_reset = false;
}

static void test_the_controller_restarts_while_it_drives(void)
{
    pass_until_it_rolls();
    reset_ecu(20);
    expect_failure(JP_NAVIGATION_RESTART);
    expect_stand();
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.status.resets);
    TEST_ASSERT_EQUAL_UINT8(JP_MAP_LINK_NONE, drive.view.map.state);
    go_again();
}

static void test_the_controller_restarts_while_the_map_arrives(void)
{
    pass_until_half_of_the_map_is_there();
    reset_ecu(20);
    expect_arrival();
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.status.resets);
}

static void test_the_operator_restarts_while_the_map_arrives(void)
{
    pass_until_half_of_the_map_is_there();
    const uint16_t received = drive.view.map.received;

    memset(&commander, 0, sizeof commander);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &place));
    pass(400);
    TEST_ASSERT_GREATER_OR_EQUAL_UINT16(received, drive.view.map.received);
    expect_arrival();
}

static void test_a_map_that_comes_while_it_drives_is_refused(void)
{
    pass_until_it_rolls();
    const struct jp_can_map_offer_t signals = {.map_id = 9, .bytes = 500, .map_crc = 1};
    struct jp_can_frame frame = {.id = JP_CAN_MAP_OFFER_FRAME_ID, .length = JP_CAN_MAP_OFFER_LENGTH};
    uint8_t counter = 7;

    (void)jp_can_map_offer_pack(frame.data, &signals, sizeof frame.data);
    jp_e2e_protect(&counter, JP_DATA_ID_MAP_OFFER, frame.data, frame.length);
    TEST_ASSERT_EQUAL_INT(JP_OK, drive.link.port.send(drive.link.port.context, &frame));
    pass(200);
    TEST_ASSERT_EQUAL_UINT8(JP_MAP_REASON_UNDER_WAY, drive.view.map.reason);
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.map.map_id);
    expect_arrival();
}

/** A box of 4 × 4 cells ahead of the robot. */
static void see_a_box(void)
{
    const struct plant *plant = &drive.plant.world.plant;
    const int x = (int)((plant->x + 1.05 + 1.2 * cos(plant->state.yaw)) / CELL);
    const int y = (int)((plant->y + 1.05 + 1.2 * sin(plant->state.yaw)) / CELL);

    for (int v = y - 2; v < y + 2; v++) {
        for (int u = x - 2; u < x + 2; u++) {
            TEST_ASSERT_EQUAL_INT(JP_OK,
                                  jp_navigation_operator_see(&commander, (uint16_t)u, (uint16_t)v, JP_CELL_OCCUPIED));
        }
    }
}

static void test_it_brakes_before_a_box_and_goes_round_it(void)
{
    pass_until_it_rolls();
    see_a_box();
    pass(150);
    TEST_ASSERT_EQUAL_UINT8(JP_NAVIGATOR_BRAKING, drive.view.navigation.state);
    TEST_ASSERT_EQUAL_UINT8(JP_NAVIGATOR_BLOCKED, drive.view.navigation.reason);
    expect_arrival();
    TEST_ASSERT_GREATER_THAN_UINT8(0, drive.view.navigation.replans);
}

static void test_the_bus_goes_off_for_a_moment(void)
{
    pass_until_it_rolls();
    see_a_box();
    drive.conditions.ecu_bus_off = true;
    pass(35);
    drive.conditions.ecu_bus_off = false;
    expect_arrival();
    TEST_ASSERT_EQUAL_UINT8(0, commander.changes.count);
}
