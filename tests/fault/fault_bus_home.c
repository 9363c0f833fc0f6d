/* Drives over a bus of robots that cells feed, whose ECU knows its way home: the balancer and the differential drive
 * arrive with full cells and turn back with nearly empty ones, the ECU without memory or without a model of its battery
 * says so and drives, a restart on the way loses nothing for good. What it tells is compared with the cells' own truth.
 */
#include <joulepath/tables.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/balancer/rig.h"
#include "sim/bus/bus_drive.h"
#include "sim/bus/local_ecu.h"
#include "sim/files/cell_file.h"
#include "unity.h"

enum { WIDTH = 60, HEIGHT = 40, STREAM_MAX = 200, GOAL_X = 50, GOAL_Y = 30, START = 10 };

#define DRIVE_TICKS 120000
#define CONFIDENCE  (JP_Q31_MAX / 1000 * 999)

static struct local_ecu ecu;
static struct bus_drive drive;
static struct jp_navigation_operator commander;
static uint64_t map_memory[WIDTH * HEIGHT / 8];
static uint8_t stream[STREAM_MAX];
static struct jp_map_stream map;
static const struct jp_map_goal place = {.x = GOAL_X, .y = GOAL_Y};

static void make_map(double cell_m)
{
    const struct jp_terrain_config config = {
        .width = WIDTH, .height = HEIGHT, .resolution = (jp_q16)lround(cell_m * 65536)};
    const jp_q16 start = START * config.resolution + config.resolution / 2;
    const struct jp_place origin = {{start, start}, 0};
    struct jp_terrain terrain;
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &config, map_memory, sizeof map_memory, &field));
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        (void)jp_terrain_set_cell(&terrain, i % WIDTH, i / WIDTH, JP_CELL_FREE);
    }
    map = (struct jp_map_stream){.bytes = stream, .id = 1};
    map.length = (uint16_t)jp_map_encode(&terrain, &origin, stream, sizeof stream);
    TEST_ASSERT_GREATER_THAN_UINT16(0, map.length);
}

static void go(double cell_m)
{
    memset(&commander, 0, sizeof commander);
    drive.navigation = &commander;
    make_map(cell_m);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &place));
}

/** Fed by its cells at this charge, or by a supply; below 0. */
static void start_courier(const struct jp_energy_model *model, double charge)
{
    static struct robot_file robot;
    struct cell_constants cell;
    struct cell_wiring wiring;
    struct jp_can_link link;

    TEST_ASSERT_TRUE(robot_file_load("sim/robots/courier24.cfg", &robot));
    TEST_ASSERT_TRUE(pack_file_load_robot("courier24", &cell, &wiring));
    TEST_ASSERT_TRUE(local_ecu_start(&ecu, rig_find_robot("courier24"), model, &link));
    bus_drive_init(&drive, &robot, 1, &link);
    if (charge >= 0) {
        const struct cell_condition condition = {.charge = charge, .temperature_c = cell.resistance.reference_c};

        world_feed(&drive.plant.world, &cell, &wiring, &condition);
    }
    go(0.1);
}

static void start_burger(double charge)
{
    static struct skid_steer_model model;
    static const struct skid_ground level = {NULL, NULL};
    static const double at = (START + 0.5) * 0.05;
    const struct planar_pose pose = {at, at, 0};
    struct cell_constants cell;
    struct cell_wiring wiring;
    struct jp_can_link link;

    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/burger.cfg", &model));
    TEST_ASSERT_TRUE(pack_file_load_robot("burger", &cell, &wiring));
    TEST_ASSERT_TRUE(local_ecu_start_skid(&ecu, skid_robot_find("burger"), &link));
    bus_drive_init_skid(&drive, &model, &level, &pose, 1, &link);
    const struct cell_condition condition = {.charge = charge, .temperature_c = cell.resistance.reference_c};

    skid_plant_feed(&drive.plant.skid.plant, &cell, &wiring, &condition);
    go(0.05);
}

void setUp(void)
{
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

static void expect_failure(enum jp_navigation_failure failure)
{
    pass_until(JP_NAVIGATION_FAILED);
    TEST_ASSERT_EQUAL_INT_MESSAGE(failure, commander.failure, jp_navigation_failure_text(commander.failure));
}

static void expect_told(enum jp_home_told state)
{
    TEST_ASSERT_EQUAL_UINT8(state, commander.home.home_state);
}

static double told_way(void)
{
    return commander.home.way / 8.0;
}

/** What the cells give down to the reserve of 10 %, from where they are, at next to no load, J. */
static double true_left(const struct cell_pack *pack)
{
    struct cell_pack cells = *pack;
    const double before = cells.ledger.terminal;

    while (cells.charge > 0.1) {
        cell_pack_step(&cells, 0.2, 60);
    }
    return cells.ledger.terminal - before;
}

static void test_the_balancer_arrives_and_knows_what_the_way_home_takes(void)
{
    start_courier(&jp_energy_model_courier24_battery, 0.5);
    ecu_node_turn_back(&ecu.node, CONFIDENCE);
    pass_until(JP_NAVIGATION_DONE);
    expect_told(JP_HOME_TOLD_SUFFICES);
    TEST_ASSERT_GREATER_THAN_UINT16(65000, commander.home.probability);
    const double left = commander.battery.left / 16.0;
    const double deviation = commander.battery.left_deviation / 16.0;

    TEST_ASSERT_DOUBLE_WITHIN(3 * deviation, true_left(&drive.plant.world.pack), left);
    TEST_ASSERT_TRUE(deviation < 0.3 * left);
    /* And home: as it said, give or take. */
    pass(500);
    const double way = told_way();
    const double way_deviation = commander.home.way_deviation / 8.0;
    const double before = drive.plant.drawn_j;
    const struct jp_map_goal home = {.x = START, .y = START};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &home));
    pass_until(JP_NAVIGATION_DONE);
    TEST_ASSERT_TRUE(way > 20 && way_deviation < 0.5 * way);
    TEST_ASSERT_DOUBLE_WITHIN(3 * way_deviation, drive.plant.drawn_j - before, way);
}

static void expect_at_start(double x, double y)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 0, x);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 0, y);
}

static void test_the_balancer_turns_back_in_time(void)
{
    start_courier(&jp_energy_model_courier24_battery, 0.1);
    ecu_node_turn_back(&ecu.node, CONFIDENCE);
    expect_failure(JP_NAVIGATION_CAME_HOME);
    expect_told(JP_HOME_TOLD_TOO_LITTLE);
    TEST_ASSERT_EQUAL_UINT8(JP_GOAL_HOME, commander.navigator.answer);
    TEST_ASSERT_FALSE(drive.plant.world.plant.fallen);
    expect_at_start(drive.plant.world.plant.x, drive.plant.world.plant.y);
}

static void test_the_differential_drive_arrives_or_turns_back(void)
{
    start_burger(0.6);
    ecu_node_turn_back(&ecu.node, CONFIDENCE);
    pass_until(JP_NAVIGATION_DONE);
    expect_told(JP_HOME_TOLD_SUFFICES);
    TEST_ASSERT_TRUE(told_way() > 5);
    start_burger(0.08);
    ecu_node_turn_back(&ecu.node, CONFIDENCE);
    expect_failure(JP_NAVIGATION_CAME_HOME);
}

/* It tells that it is too little, and drives: nobody let it turn back. */
static void test_it_turns_back_only_where_it_shall(void)
{
    start_burger(0.08);
    pass_until(JP_NAVIGATION_DONE);
    expect_told(JP_HOME_TOLD_TOO_LITTLE);
}

/* ---- What the bus has less ---- */

/** Low, after 500 cycles, at -10 °C. */
static struct cell_condition low_old_cold = {0.07, -10, 500};

static uint32_t saturated_until_done(bool knows_its_cells)
{
    pass(2);
    if (!knows_its_cells) {
        ecu.node.lockstep.ecu.internal.battery = NULL;
    }
    pass_until(JP_NAVIGATION_DRIVING);
    const uint32_t before = drive.view.motors.saturated_ticks;

    pass_until(JP_NAVIGATION_DONE);
    return drive.view.motors.saturated_ticks - before;
}

/** Ticks of a drive in which the bus had not the voltage that the robot asked for. */
static uint32_t saturated_of_burger(bool knows_its_cells)
{
    struct cell_constants cell;
    struct cell_wiring wiring;

    start_burger(0.5);
    TEST_ASSERT_TRUE(pack_file_load_robot("burger", &cell, &wiring));
    skid_plant_feed(&drive.plant.skid.plant, &cell, &wiring, &low_old_cold);
    return saturated_until_done(knows_its_cells);
}

static uint32_t saturated_of_courier(bool knows_its_cells)
{
    struct cell_constants cell;
    struct cell_wiring wiring;

    start_courier(&jp_energy_model_courier24_battery, -1);
    TEST_ASSERT_TRUE(pack_file_load_robot("courier24", &cell, &wiring));
    world_feed(&drive.plant.world, &cell, &wiring, &low_old_cold);
    return saturated_until_done(knows_its_cells);
}

static void test_its_plans_ask_for_what_is_there(void)
{
    for (int percent = 2; percent <= 4; percent++) {
        low_old_cold.charge = percent / 100.0;
        const uint32_t without = saturated_of_burger(false);
        const uint32_t with = saturated_of_burger(true);

        (void)printf("burger on an old and cold battery at %d %%: %u ticks without the voltage that it asked for, %u "
                     "where it knows its cells\n",
                     percent, without, with);
        TEST_ASSERT_GREATER_THAN_UINT32(0, without);
        TEST_ASSERT_EQUAL_UINT32(0, with);
    }
}

/* Its balance has a reserve besides. */
static void test_the_balancers_plans_do_so_too(void)
{
    low_old_cold.charge = 0.05;
    TEST_ASSERT_EQUAL_UINT32(0, saturated_of_courier(true));
    TEST_ASSERT_FALSE(drive.plant.world.plant.fallen);
    TEST_ASSERT_TRUE(ecu.node.balancer.robot.pilot.internal.trajectory.voltage <
                     jp_robot_courier24.trajectory.voltage - JP_Q16(3));
}

static void test_what_the_motors_take_says_nothing_of_the_battery(void)
{
    start_courier(&jp_energy_model_courier24, -1);
    pass_until(JP_NAVIGATION_DONE);
    expect_told(JP_HOME_TOLD_UNPOWERED);
    TEST_ASSERT_EQUAL_UINT16(0, commander.home.probability);
    TEST_ASSERT_EQUAL_UINT32(0, commander.battery.left);
}

static void test_an_ecu_without_memory_says_so_and_drives(void)
{
    start_courier(&jp_energy_model_courier24_battery, 0.5);
    pass(2);
    ecu.node.home.size = 8;
    pass_until(JP_NAVIGATION_DONE);
    expect_told(JP_HOME_TOLD_NO_ROOM);
}

/** The way home is known again, and turning back still its own. */
static void test_the_controller_restarts_on_the_way(void)
{
    start_courier(&jp_energy_model_courier24_battery, 0.5);
    ecu_node_turn_back(&ecu.node, CONFIDENCE);
    pass_until(JP_NAVIGATION_DRIVING);
    pass(3000);
    drive.conditions.ecu_reset = true;
    pass(20);
    drive.conditions.ecu_reset = false;
    expect_failure(JP_NAVIGATION_RESTART);
    pass(8000);
    TEST_ASSERT_EQUAL_UINT8(JP_ROBOT_BALANCING, drive.view.status.state);
    TEST_ASSERT_TRUE(ecu.node.home.turns_back);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &place));
    pass_until(JP_NAVIGATION_DONE);
    expect_told(JP_HOME_TOLD_SUFFICES);
}
