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
