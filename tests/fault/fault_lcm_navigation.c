/* A team on LCM sends a robot over a map: through the gateway, over CAN, to a controller with a navigator and the
 * robot's body, all in this process. What happens on the way leaves the robot upright, and it goes to the goal when it
 * is told to again. */
#include <jp_goal_t.h>
#include <jp_navigation_t.h>
#include <jp_route_t.h>
#include <jp_state_t.h>
#include <lcm/lcm.h>
#include <math.h>
#include <string.h>

#include "sim/balancer/rig.h"
#include "sim/bus/bus_drive.h"
#include "sim/bus/local_ecu.h"
#include "sim/lcm/lcm_gateway.h"
#include "tests/support/lcm_maps.h"
#include "unity.h"

enum { WIDTH = 60, HEIGHT = 40, GOAL_X = 45, GOAL_Y = 20 };

#define CELL    0.1 /* m */
#define ORIGIN  1.05
#define WALL_US 1000

/** Ticks: of a stand that follows, of a whole drive. */
#define STAND_TICKS 8000
#define DRIVE_TICKS 60000

static struct local_ecu ecu;
static struct bus_drive drive;
static struct lcm_gateway gateway;
static struct robot_file robot;
static lcm_t *lcm;
static uint64_t wall_us;
static bool gateway_is_gone;
static jp_map_t map;

/* What JP_STATE and JP_NAVIGATION tell. */
static int8_t task;
static char reason[256];
static jp_navigation_t told;

static void hear_state(const lcm_recv_buf_t *packet, const char *channel, void *user)
{
    jp_state_t state;

    (void)channel;
    (void)user;
    TEST_ASSERT_EQUAL_INT(packet->data_size, jp_state_t_decode(packet->data, 0, (int)packet->data_size, &state));
    task = state.task;
    (void)snprintf(reason, sizeof reason, "%s", state.task_reason);
    (void)jp_state_t_decode_cleanup(&state);
}

static void hear_navigation(const lcm_recv_buf_t *packet, const char *channel, void *user)
{
    (void)channel;
    (void)user;
    free(told.legs);
    TEST_ASSERT_EQUAL_INT(packet->data_size, jp_navigation_t_decode(packet->data, 0, (int)packet->data_size, &told));
}

void setUp(void)
{
    const struct robot_entry *entry = rig_find_robot("courier24");
    struct jp_can_link plant_side;
    struct jp_can_link gateway_side;

    TEST_ASSERT_NOT_NULL(entry);
    TEST_ASSERT_TRUE(robot_file_load("sim/robots/courier24.cfg", &robot));
    TEST_ASSERT_TRUE(local_ecu_start(&ecu, entry, entry->energy, &plant_side));
    bus_drive_init(&drive, &robot, 1, &plant_side);
    gateway_side = can_bus_link(can_bus_attach(&ecu.bus));
    lcm = lcm_create("memq://");
    TEST_ASSERT_NOT_NULL(lcm);
    TEST_ASSERT_TRUE(lcm_gateway_start(&gateway, &gateway_side, lcm));
    (void)lcm_subscribe(lcm, "JP_STATE", hear_state, NULL);
    (void)lcm_subscribe(lcm, "JP_NAVIGATION", hear_navigation, NULL);
    gateway_is_gone = false;
    task = JP_STATE_T_TASK_IDLE;
    reason[0] = '\0';
    map = free_map(WIDTH, HEIGHT);
}

void tearDown(void)
{
    free_cells(&map);
    free(told.legs);
    told = (jp_navigation_t){.utime = 0};
    lcm_gateway_free(&gateway);
    lcm_destroy(lcm);
}

static void pass(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        TEST_ASSERT_TRUE(bus_drive_lockstep(&drive));
        wall_us += WALL_US;
        if (!gateway_is_gone) {
            lcm_gateway_pass(&gateway, wall_us);
        }
    }
}

static void pass_until(int8_t wanted)
{
    for (unsigned i = 0; i < DRIVE_TICKS && task != wanted; i++) {
        pass(1);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(wanted, task, reason);
}

static double speed(void)
{
    return drive.plant.world.plant.state.wheel_rate * robot.wheel.radius_m;
}

static void pass_until_it_rolls(void)
{
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

static void expect_arrival_at(double x, double y)
{
    const struct plant *plant = &drive.plant.world.plant;

    pass(100);
    pass_until(JP_STATE_T_TASK_DONE);
    expect_stand();
    TEST_ASSERT_TRUE(fabs(plant->x + ORIGIN - x) < 0.15);
    TEST_ASSERT_TRUE(fabs(plant->y + ORIGIN - y) < 0.15);
}

static void expect_arrival(void)
{
    expect_arrival_at((GOAL_X + 0.5) * CELL, (GOAL_Y + 0.5) * CELL);
    TEST_ASSERT_EQUAL_INT8(JP_NAVIGATOR_ARRIVED, told.state);
}

static void send_goal(void)
{
    publish_goal(lcm, map.map_id, (GOAL_X + 0.5) * CELL, (GOAL_Y + 0.5) * CELL);
}

static void go(void)
{
    publish_map(lcm, &map);
    send_goal();
}

static void test_arrives_when_nothing_happens(void)
{
    go();
    expect_arrival();
    TEST_ASSERT_EQUAL_INT16(1, told.map_id);
    TEST_ASSERT_EQUAL_INT8(JP_MAP_LINK_READY, told.map_state);
}

/** A box of 4 × 4 cells ahead of the robot. */
static void see_a_box(void)
{
    const struct plant *plant = &drive.plant.world.plant;
    const int x = (int)((plant->x + ORIGIN + 1.2 * cos(plant->state.yaw)) / CELL);
    const int y = (int)((plant->y + ORIGIN + 1.2 * sin(plant->state.yaw)) / CELL);

    for (int v = y - 2; v < y + 2; v++) {
        publish_row(lcm, map.map_id, (int16_t)(x - 2), (int16_t)v, 4, JP_CELL_OCCUPIED);
    }
}

static void test_it_goes_round_a_box_that_a_sensor_sees(void)
{
    go();
    pass_until_it_rolls();
    see_a_box();
    pass(150);
    TEST_ASSERT_EQUAL_UINT8(JP_NAVIGATOR_BRAKING, drive.view.navigation.state);
    expect_arrival();
    TEST_ASSERT_GREATER_THAN_INT16(0, told.replans);
    TEST_ASSERT_EQUAL_UINT(0, gateway.operator.map.untold_count);
}

static void expect_failure(const char *words)
{
    pass(200);
    pass_until(JP_STATE_T_TASK_FAILED);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(reason, words), reason);
    TEST_ASSERT_NULL_MESSAGE(strchr(reason, '\n'), reason);
    expect_stand();
}

static uint64_t all_dropped(void)
{
    uint64_t all = 0;

    for (int i = 0; i < LCM_TASK_RESULTS; i++) {
        all += gateway.dropped[i];
    }
    return all;
}

static uint8_t known_to_ecu(int x, int y)
{
    return (uint8_t)jp_terrain_cell(&ecu.node.navigation.maps.decoder.terrain, x, y);
}

/* What the robot refuses. */

static void send_other_map(int16_t width, int16_t height, double resolution)
{
    jp_map_t other = free_map(width, height);

    other.map_id = 2;
    other.resolution = resolution;
    publish_map(lcm, &other);
    publish_goal(lcm, 2, 1.5, 1.5);
    free_cells(&other);
}

static void test_a_map_that_is_too_large_for_the_robot(void)
{
    send_other_map(600, 600, CELL);
    expect_failure("the map is too large for the robot's memory");
    TEST_ASSERT_EQUAL_INT8(JP_MAP_LINK_REJECTED, told.map_state);
    TEST_ASSERT_EQUAL_INT16(2, told.map_id);
    go();
    expect_arrival();
}

static void test_a_map_of_other_cells_than_the_lattices(void)
{
    send_other_map(40, 40, 0.05);
    expect_failure("the map's resolution is not that of the robot's lattice");
    TEST_ASSERT_EQUAL_INT8(JP_MAP_LINK_REJECTED, told.map_state);
    go();
    expect_arrival();
}

static void test_a_goal_where_the_robot_cannot_stand(void)
{
    map.cells[GOAL_Y][GOAL_X] = JP_CELL_OCCUPIED;
    go();
    expect_failure("the robot cannot stand at the goal");
    TEST_ASSERT_EQUAL_INT8(JP_GOAL_BLOCKED, told.answer);
    publish_goal(lcm, 1, 2.55, 2.05);
    expect_arrival_at(2.55, 2.05);
}

static void test_a_goal_to_which_no_way_leads(void)
{
    for (int y = 0; y < HEIGHT; y++) {
        map.cells[y][30] = JP_CELL_OCCUPIED;
    }
    go();
    expect_failure("no way leads to the goal");
    TEST_ASSERT_EQUAL_INT8(JP_NAVIGATOR_UNREACHABLE, told.state);
    for (int16_t y = 0; y < HEIGHT; y++) {
        publish_row(lcm, 1, 30, y, 1, JP_CELL_FREE);
    }
    send_goal();
    expect_arrival();
}

static void test_unknown_cells_are_driven_over_only_where_the_map_allows_it(void)
{
    for (int y = 0; y < HEIGHT; y++) {
        map.cells[y][30] = JP_CELL_UNKNOWN;
    }
    go();
    expect_failure("no way leads to the goal");
    map.unknown_is_free = 1;
    go();
    expect_arrival();
}

static void test_a_robot_without_an_answer(void)
{
    drive.conditions.ecu_bus_off = true;
    go();
    pass(200);
    for (unsigned i = 0; i < DRIVE_TICKS && lcm_operator_phase(&gateway.operator) != JP_OPERATOR_FAILED; i++) {
        pass(1);
    }
    TEST_ASSERT_EQUAL_STRING(jp_navigation_failure_text(JP_NAVIGATION_SILENCE),
                             lcm_operator_failure_text(&gateway.operator));
}

/* What replaces what. */

static void test_another_goal_replaces_the_one_that_is_driven_to(void)
{
    go();
    pass_until_it_rolls();
    publish_goal(lcm, 1, 2.05, 3.05);
    expect_arrival_at(2.05, 3.05);
    TEST_ASSERT_EQUAL_INT16(2, told.goal_id);
    TEST_ASSERT_EQUAL_UINT64(0, all_dropped());
}

static void test_a_goal_with_a_heading(void)
{
    const jp_map_goal_t goal = {.map_id = 1, .point = {3.05, 2.05}, .has_heading = 1, .heading = M_PI / 2 - 4 * M_PI};

    publish_map(lcm, &map);
    TEST_ASSERT_EQUAL_INT(0, jp_map_goal_t_publish(lcm, "JP_MAP_GOAL", &goal));
    expect_arrival_at(3.05, 2.05);
    TEST_ASSERT_TRUE(fabs(remainder(drive.plant.world.plant.state.yaw - M_PI / 2, 2 * M_PI)) < 0.2);
}

static void test_where_the_robot_was_switched_on_turns_the_map(void)
{
    const struct plant *plant = &drive.plant.world.plant;

    map.origin_heading = M_PI / 2;
    publish_map(lcm, &map);
    publish_goal(lcm, 1, 1.05, 3.05);
    pass(100);
    pass_until(JP_STATE_T_TASK_DONE);
    expect_stand();
    TEST_ASSERT_TRUE(fabs(plant->x - 2) < 0.15);
    TEST_ASSERT_TRUE(fabs(plant->y) < 0.15);
}

static void test_another_map_halts_the_robot_until_a_goal_on_it_comes(void)
{
    go();
    pass_until_it_rolls();
    map.map_id = 7;
    map.cells[0][0] = JP_CELL_OCCUPIED;
    publish_map(lcm, &map);
    pass(1);
    expect_stand();
    TEST_ASSERT_EQUAL_INT8(JP_STATE_T_TASK_IDLE, task);
    TEST_ASSERT_EQUAL_INT16(1, told.map_id);
    send_goal();
    expect_arrival();
    TEST_ASSERT_EQUAL_INT16(7, told.map_id);
}

static void test_the_same_map_again_changes_nothing(void)
{
    go();
    pass_until_it_rolls();
    see_a_box();
    for (int i = 0; i < 50; i++) {
        map.utime++;
        publish_map(lcm, &map);
        pass(100);
        TEST_ASSERT_TRUE(task == JP_STATE_T_TASK_DRIVING || task == JP_STATE_T_TASK_DONE);
    }
    expect_arrival();
    TEST_ASSERT_GREATER_THAN_INT16(0, told.replans);
}

static void send_plain_goal(double x, double y)
{
    const jp_goal_t goal = {.point = {x, y}};

    TEST_ASSERT_EQUAL_INT(0, jp_goal_t_publish(lcm, "JP_GOAL", &goal));
}

static void test_a_goal_without_a_map_replaces_one_on_a_map_and_the_other_way_round(void)
{
    go();
    pass_until_it_rolls();
    send_plain_goal(0.5, 1.5);
    expect_arrival_at(ORIGIN + 0.5, ORIGIN + 1.5);
    TEST_ASSERT_FALSE(gateway.operator.navigates);
    send_plain_goal(2.5, 0.5);
    pass(STAND_TICKS / 4);
    pass_until_it_rolls();
    see_a_box();
    send_goal();
    expect_arrival();
    TEST_ASSERT_TRUE(gateway.operator.navigates);
    TEST_ASSERT_EQUAL_UINT16(0, drive.view.errors.faults);
}

/* What sensors see. */

static void test_cells_before_the_goal_are_part_of_the_map(void)
{
    publish_map(lcm, &map);
    publish_row(lcm, 1, 30, 0, 1, JP_CELL_OCCUPIED);
    for (int16_t y = 1; y < HEIGHT; y++) {
        publish_row(lcm, 1, 30, y, 1, JP_CELL_OCCUPIED);
        pass(1);
    }
    send_goal();
    expect_failure("no way leads to the goal");
    TEST_ASSERT_EQUAL_UINT8(JP_CELL_OCCUPIED, known_to_ecu(30, 0));
}

static void test_more_cells_than_the_bus_takes_at_once_all_arrive(void)
{
    go();
    pass_until_it_rolls();
    for (int16_t y = 0; y < HEIGHT; y++) {
        jp_cell_t row[3];
        const jp_cells_t cells = {.map_id = 1, .count = 3, .cells = row};

        for (int16_t i = 0; i < 3; i++) {
            /* Apart, so that each takes a frame. */
            row[i] = (jp_cell_t){.x = (int16_t)(54 + 2 * i), .y = y, .cell = JP_CELL_OCCUPIED};
        }
        TEST_ASSERT_EQUAL_INT(0, jp_cells_t_publish(lcm, "JP_CELLS", &cells));
        publish_row(lcm, 1, 0, y, 1, y % 2 == 0 ? JP_CELL_OCCUPIED : JP_CELL_UNKNOWN);
    }
    expect_arrival();
    for (int y = 0; y < HEIGHT; y++) {
        TEST_ASSERT_EQUAL_UINT8(JP_CELL_OCCUPIED, known_to_ecu(54, y));
        TEST_ASSERT_EQUAL_UINT8(JP_CELL_FREE, known_to_ecu(55, y));
        TEST_ASSERT_EQUAL_UINT8(JP_CELL_OCCUPIED, known_to_ecu(58, y));
        TEST_ASSERT_EQUAL_UINT8(y % 2 == 0 ? JP_CELL_OCCUPIED : JP_CELL_UNKNOWN, known_to_ecu(0, y));
    }
    TEST_ASSERT_EQUAL_UINT(0, gateway.operator.map.untold_count);
    TEST_ASSERT_EQUAL_UINT64(0, all_dropped());
}

/* What goes wrong. */

static void test_the_gateway_falls_silent(void)
{
    go();
    pass_until_it_rolls();
    gateway_is_gone = true;
    pass(450);
    TEST_ASSERT_TRUE(speed() > 0.1);
    expect_stand();
    TEST_ASSERT_EQUAL_UINT8(JP_OPERATOR_LOST, drive.view.status.operator_state);
    TEST_ASSERT_EQUAL_UINT8(JP_NAVIGATOR_IDLE, drive.view.navigation.state);
}

static void test_a_new_gateway_finds_the_map_there(void)
{
    struct jp_can_link link = gateway.link;

    go();
    expect_arrival();
    lcm_gateway_free(&gateway);
    lcm_destroy(lcm);
    lcm = lcm_create("memq://");
    TEST_ASSERT_TRUE(lcm_gateway_start(&gateway, &link, lcm));
    (void)lcm_subscribe(lcm, "JP_STATE", hear_state, NULL);
    (void)lcm_subscribe(lcm, "JP_NAVIGATION", hear_navigation, NULL);
    publish_goal(lcm, 1, 2.05, 2.05);
    pass(STAND_TICKS / 4);
    TEST_ASSERT_EQUAL_UINT64(1, gateway.dropped[LCM_TASK_NO_MAP]);
    TEST_ASSERT_EQUAL_UINT8(JP_ROBOT_BALANCING, drive.view.status.state);
    publish_map(lcm, &map);
    publish_goal(lcm, 1, 2.05, 2.05);
    expect_arrival_at(2.05, 2.05);
}

static void test_the_controller_restarts_and_is_told_again_what_was_seen(void)
{
    go();
    pass_until_it_rolls();
    see_a_box();
    publish_row(lcm, 1, 5, 35, 3, JP_CELL_OCCUPIED);
    pass(500);
    drive.conditions.ecu_reset = true;
    pass(20);
    drive.conditions.ecu_reset = false;
    expect_failure("the ECU has restarted");
    TEST_ASSERT_EQUAL_INT8(JP_MAP_LINK_NONE, told.map_state);
    send_goal();
    expect_arrival();
    TEST_ASSERT_EQUAL_UINT8(JP_CELL_OCCUPIED, known_to_ecu(5, 35));
}

static void test_junk_disturbs_no_drive(void)
{
    static const char *const channels[] = {"JP_MAP", "JP_CELLS", "JP_MAP_GOAL"};
    uint8_t junk[200];

    go();
    pass_until_it_rolls();
    for (unsigned i = 0; i < 600; i++) {
        memset(junk, (int)(i & 0xFFU), sizeof junk);
        TEST_ASSERT_EQUAL_INT(0, lcm_publish(lcm, channels[i % 3], junk, i % sizeof junk));
        pass(2);
    }
    publish_row(lcm, 3, 1, 1, 1, JP_CELL_OCCUPIED);
    publish_goal(lcm, 3, 1, 1);
    publish_goal(lcm, 1, 6.01, 1);
    publish_goal(lcm, 1, -0.01, 1);
    expect_arrival();
    TEST_ASSERT_EQUAL_UINT64(604, all_dropped());
    TEST_ASSERT_EQUAL_UINT64(2, gateway.dropped[LCM_TASK_OTHER_MAP]);
    TEST_ASSERT_EQUAL_UINT64(2, gateway.dropped[LCM_TASK_OUTSIDE]);
}
