/* What the application tells of its way home: without a map, without memory or a battery, while it looks for the way,
 * when what is left suffices and when it does not, and that it comes home by itself where it shall. The wheels are
 * held: fault_bus_home.c has the drives. */
#include "hal/app/navigation.h"

#include <string.h>

#include "tests/support/ecu_rig.h"
#include "tests/support/map_frames.h"

enum { SIDE = 10, BLOCK_BYTES = 2400, LEGS_MAX = 4, STREAM_MAX = 48 };

#define FIELD_BYTES (SIDE * SIDE * (JP_HEADINGS * 3 + 4) + SIDE * 4)
#define CONFIDENCE  (JP_Q31_MAX / 1000 * 999)

static uint64_t map_memory[SIDE];
static uint64_t way_memory[(3 * SIDE + 1) / 2];
static uint8_t seen_memory[(SIDE + 3) / 4 * SIDE];
static uint64_t block[BLOCK_BYTES / 8];
static uint64_t field_memory[FIELD_BYTES / 8];
static struct jp_course_leg legs[LEGS_MAX];
static struct jp_course_leg home_legs[LEGS_MAX];
static struct jp_navigation navigation;
static struct jp_navigation_home home_config;
static struct jp_home home;
static struct jp_ecu_battery battery;
static struct sent_map sent;
static uint8_t stream[STREAM_MAX];
static uint8_t goal_counter;

/** A room of free cells; the robot is switched on at the cell (x, 5). */
static void make_stream(int32_t x)
{
    const struct jp_terrain_config ground = {.width = SIDE, .height = SIDE, .resolution = JP_Q16(0.1)};
    const struct jp_place place = {{x * JP_Q16(0.1) + JP_Q16(0.05), JP_Q16(0.55)}, 0};
    struct jp_terrain map;
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map, &ground, map_memory, sizeof map_memory, &field));
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        (void)jp_terrain_set_cell(&map, i % SIDE, i / SIDE, JP_CELL_FREE);
    }
    sent = (struct sent_map){.bytes = stream, .id = 2};
    sent.length = (uint16_t)jp_map_encode(&map, &place, stream, sizeof stream);
    TEST_ASSERT_GREATER_THAN_UINT16(0, sent.length);
}

static void make_with(const struct jp_navigation_home *kept)
{
    const struct jp_navigation_config memory = {.lattice = &jp_lattice_courier24,
                                                .body = &jp_navigation_courier24,
                                                .map = map_memory,
                                                .map_size = sizeof map_memory,
                                                .planner = block,
                                                .planner_size = sizeof block,
                                                .way = way_memory,
                                                .way_size = sizeof way_memory,
                                                .seen = seen_memory,
                                                .seen_size = sizeof seen_memory,
                                                .legs = legs,
                                                .legs_max = LEGS_MAX,
                                                .home = kept};
    const char *field = "";

    goal_counter = 0;
    make_stream(SIDE / 2);
    battery = (struct jp_ecu_battery){.has_started = false};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ecu_battery_init(&battery, &jp_battery_config_courier24, 0, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, navigation_start(&navigation, &memory, &balancer.pilot, &field));
    jp_ecu_navigate(&ecu, &navigation);
}

static void make(void)
{
    home_config = (struct jp_navigation_home){.home = &home,
                                              .block = field_memory,
                                              .size = sizeof field_memory,
                                              .legs = home_legs,
                                              .legs_max = LEGS_MAX,
                                              .battery = &battery,
                                              .confidence = CONFIDENCE};
    make_with(&home_config);
}

static void give(struct jp_can_frame frame)
{
    TEST_ASSERT_FALSE(jp_ecu_accept(&ecu, &frame));
}

static void send_map(void)
{
    give(map_offer(&sent));
    run(1);
    for (uint32_t i = 0; i * JP_MAP_DATA < sent.length; i++) {
        give(map_data(&sent, i));
        run(1);
    }
    run(SIDE + 5);
    TEST_ASSERT_TRUE(navigation.is_prepared);
}

static void go_to(uint8_t id, uint16_t x, uint16_t y)
{
    const struct jp_map_goal goal = {.map = 2, .id = id, .x = x, .y = y};

    give(map_goal(++goal_counter & 15U, &goal));
    give(map_goal(++goal_counter & 15U, &goal));
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_GOAL_TAKEN, navigation.answer);
    hold(JP_MODE_NAVIGATE, id, 3);
}

static struct jp_can_home_status_t told(void)
{
    struct jp_can_home_status_t status;

    run(210);
    TEST_ASSERT_EQUAL_INT(0, jp_can_home_status_unpack(&status, bus.last[0x1C], JP_CAN_LENGTH_MAX));
    return status;
}

static struct jp_can_home_battery_t told_battery(void)
{
    struct jp_can_home_battery_t status;

    run(210);
    TEST_ASSERT_EQUAL_INT(0, jp_can_home_battery_unpack(&status, bus.last[0x1D], JP_CAN_LENGTH_MAX));
    return status;
}

/* What drives take is of the robot, not of a map. */
static void test_what_drives_have_taught_stays_when_maps_change(void)
{
    const struct jp_home_learned learned = {{JP_Q16(1.2), JP_Q16(0.05), JP_Q16(0.3)},
                                            {JP_Q16(1.1), JP_Q16(0.04), JP_Q16(0.2)}};

    make();
    TEST_ASSERT_EQUAL_MEMORY(&jp_home_learned_new, &home.learned, sizeof learned);
    home.learned = learned;
    for (uint8_t id = 2; id <= 3; id++) {
        sent.id = id;
        send_map();
        TEST_ASSERT_EQUAL_UINT8(id, navigation.maps.id);
        TEST_ASSERT_EQUAL_MEMORY(&learned, &home.learned, sizeof learned);
    }
}

static void expect_nothing_known(enum jp_home_told state)
{
    const struct jp_can_home_status_t status = told();

    TEST_ASSERT_EQUAL_UINT8(state, status.home_state);
    TEST_ASSERT_EQUAL_UINT16(0, status.probability);
    TEST_ASSERT_EQUAL_UINT32(0, status.way);
    TEST_ASSERT_EQUAL_UINT32(0, status.way_deviation);
}

static struct jp_can_navigation_status_t navigation_status(void)
{
    struct jp_can_navigation_status_t status;

    run(210);
    TEST_ASSERT_EQUAL_INT(0, jp_can_navigation_status_unpack(&status, bus.last[0x15], JP_CAN_LENGTH_MAX));
    return status;
}

/* What there is not. */

static void test_without_a_map_there_is_no_home(void)
{
    make();
    expect_nothing_known(JP_HOME_TOLD_NONE);
    send_map();
    run(100);
    TEST_ASSERT_EQUAL_INT(JP_OK, navigation.home_status);
    sent.id = 3;
    give(map_offer(&sent));
    run(1);
    expect_nothing_known(JP_HOME_TOLD_NONE);
}

static void test_an_ecu_without_memory_says_so(void)
{
    make_with(NULL);
    expect_nothing_known(JP_HOME_TOLD_NONE);
    send_map();
    expect_nothing_known(JP_HOME_TOLD_NO_ROOM);
    TEST_ASSERT_EQUAL_UINT32(0, told_battery().left);
    make();
    home_config.size = sizeof field_memory - 8U;
    send_map();
    expect_nothing_known(JP_HOME_TOLD_NO_ROOM);
}

/* And it navigates all the same. */
static void test_without_a_home_it_navigates(void)
{
    make_with(NULL);
    make_balancing();
    send_map();
    go_to(7, 7, 5);
    TEST_ASSERT_TRUE(jp_navigation_is_under_way(&navigation));
    TEST_ASSERT_EQUAL_INT(JP_GOAL_DRIVEN, navigation.answer);
    hold(JP_MODE_STAND, 0, 2);
    TEST_ASSERT_FALSE(jp_navigation_is_under_way(&navigation));
}

static void test_a_home_where_it_cannot_stand(void)
{
    make();
    make_stream(0);
    send_map();
    expect_nothing_known(JP_HOME_TOLD_CLOSED);
}

static void test_a_home_that_is_refused(void)
{
    make();
    home_config.confidence = 1;
    home_config.turns_back = true;
    send_map();
    expect_nothing_known(JP_HOME_TOLD_NONE);
}

/** And for ever. */
static void seek_anew(void)
{
    home.config.slice = 0;
    home.internal.way.is_known = false;
    jp_home_set_lattice(&home, &jp_lattice_courier24);
}

/* What is known. */

static void test_a_way_is_sought_first(void)
{
    make();
    jp_ecu_use_battery(&ecu, &battery);
    send_map();
    TEST_ASSERT_EQUAL_INT(JP_OK, navigation.home_status);
    seek_anew();
    expect_nothing_known(JP_HOME_TOLD_SEEKING);
    home.internal.is_stuck = true;
    expect_nothing_known(JP_HOME_TOLD_NO_WAY);
}

static void test_without_a_battery_it_does_not_know(void)
{
    make();
    send_map();
    run(200);
    expect_nothing_known(JP_HOME_TOLD_UNPOWERED);
    TEST_ASSERT_EQUAL_UINT32(0, told_battery().left);
}

static void test_what_is_left_suffices(void)
{
    struct jp_home_answer answer;
    jp_energy left;
    jp_energy deviation;

    make();
    jp_ecu_use_battery(&ecu, &battery);
    send_map();
    run(300);
    const struct jp_can_home_status_t status = told();
    const struct jp_can_home_battery_t battery_status = told_battery();

    TEST_ASSERT_EQUAL_UINT8(JP_HOME_TOLD_SUFFICES, status.home_state);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_home_ask(&home, &answer));
    TEST_ASSERT_EQUAL_UINT16((uint32_t)answer.probability >> 15, status.probability);
    jp_ecu_battery_tell(&battery, &left, &deviation);
    TEST_ASSERT_UINT32_WITHIN(64, (uint32_t)(left >> 28), battery_status.left);
    TEST_ASSERT_UINT32_WITHIN(64, (uint32_t)(deviation >> 28), battery_status.left_deviation);
}

/** A way of 100 units that was surveyed. */
static void know_a_way(int32_t unit_exponent)
{
    make();
    jp_ecu_use_battery(&ecu, &battery);
    send_map();
    run(300);
    navigation.unit_exponent = unit_exponent;
    seek_anew();
    home.internal.way = (struct jp_home_way){
        .energy = {JP_Q16(100), JP_Q16(2)}, .given = jp_ecu_battery_given(&battery), .is_known = true};
}

static void test_what_the_way_takes(void)
{
    know_a_way(1);
    const struct jp_can_home_status_t status = told();

    TEST_ASSERT_UINT32_WITHIN(40, 2 * 107 * 8, status.way); /* J / 8, by the factor of a new robot */
    /* 0.06 of it by what a new robot knows of drives, and 2 of the learner. */
    TEST_ASSERT_UINT32_WITHIN(6, 102, status.way_deviation);
    know_a_way(15);
    TEST_ASSERT_EQUAL_UINT32((1U << 20) - 1U, told().way);
}

static void test_what_is_left_is_too_little(void)
{
    know_a_way(0);
    battery.battery.charge = battery.battery.reserve + ((jp_charge)1 << 31);
    TEST_ASSERT_EQUAL_UINT8(JP_HOME_TOLD_TOO_LITTLE, told().home_state);
    TEST_ASSERT_LESS_THAN_UINT16(40000, told().probability);
}

/* Where it shall turn back by itself. */

static void make_turning_back(void)
{
    make();
    jp_ecu_use_battery(&ecu, &battery);
    make_balancing();
    home_config.turns_back = true;
    send_map();
    run(300);
}

static void test_it_leaves_when_it_knows_its_way_home(void)
{
    make_turning_back();
    seek_anew();
    go_to(7, 7, 5);
    TEST_ASSERT_EQUAL_INT(JP_HOME_PREPARING, home.state);
    TEST_ASSERT_TRUE(jp_navigation_is_under_way(&navigation));
    TEST_ASSERT_EQUAL_UINT8(JP_NAVIGATOR_PLANNING, navigation_status().state);
    home.config.slice = JP_NAVIGATION_HOME_SLICE;
    for (unsigned i = 0; i < 10 && home.state == JP_HOME_PREPARING; i++) {
        hold(JP_MODE_NAVIGATE, 7, 1);
    }
    TEST_ASSERT_EQUAL_INT(JP_HOME_OUT, home.state);
    TEST_ASSERT_EQUAL_INT(JP_GOAL_DRIVEN, navigation.answer);
    hold(JP_MODE_STAND, 0, 2);
    TEST_ASSERT_EQUAL_INT(JP_HOME_IDLE, home.state);
    TEST_ASSERT_FALSE(jp_navigation_is_under_way(&navigation));
}

static void test_it_turns_back(void)
{
    make_turning_back();
    go_to(7, 7, 5);
    for (unsigned i = 0; i < 10 && home.state == JP_HOME_PREPARING; i++) {
        hold(JP_MODE_NAVIGATE, 7, 1);
    }
    TEST_ASSERT_EQUAL_INT(JP_HOME_OUT, home.state);
    battery.battery.charge = 0;
    hold(JP_MODE_NAVIGATE, 7, 1);
    TEST_ASSERT_EQUAL_INT(JP_HOME_RETURNING, home.state);
    TEST_ASSERT_TRUE(home.has_turned_back);
    TEST_ASSERT_EQUAL_INT(JP_GOAL_HOME, navigation.answer);
    TEST_ASSERT_EQUAL_UINT8(JP_GOAL_HOME, navigation_status().answer);
    TEST_ASSERT_EQUAL_UINT8(JP_HOME_TOLD_TURNING_BACK, told().home_state);
}

static void test_it_does_not_leave_without_a_way_home(void)
{
    make_turning_back();
    seek_anew();
    home.internal.is_stuck = true;
    go_to(7, 7, 5);
    TEST_ASSERT_EQUAL_INT(JP_HOME_FAILED, home.state);
    TEST_ASSERT_EQUAL_INT(JP_GOAL_HOME, navigation.answer);
    TEST_ASSERT_FALSE(jp_navigation_is_under_way(&navigation));
    TEST_ASSERT_EQUAL_UINT8(JP_NAVIGATOR_IDLE, navigation_status().state);
}

static void test_a_goal_that_is_blocked_since(void)
{
    make_turning_back();
    navigation.goal = (struct jp_map_goal){.map = 2, .id = 7, .x = 0, .y = 5};
    navigation.answer = JP_GOAL_TAKEN;
    hold(JP_MODE_NAVIGATE, 7, 3);
    TEST_ASSERT_EQUAL_INT(JP_GOAL_BLOCKED, navigation.answer);
    TEST_ASSERT_EQUAL_INT(JP_HOME_IDLE, home.state);
}

static void test_motors_that_are_off(void)
{
    make();
    jp_ecu_use_battery(&ecu, &battery);
    home_config.turns_back = true;
    send_map();
    navigation.goal = (struct jp_map_goal){.map = 2, .id = 7, .x = 7, .y = 5};
    navigation.answer = JP_GOAL_TAKEN;
    TEST_ASSERT_FALSE(jp_navigation_drive(&navigation, 7));
    TEST_ASSERT_EQUAL_INT(JP_GOAL_TAKEN, navigation.answer);
}
