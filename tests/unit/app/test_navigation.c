/* The application with a navigator on a bus: maps, changes, goals and commands in frames, each refusal, and that Stand,
 * a silent operator and Off end what it does. The wheels are held: sim/missions and tests/firmware have the drives. */
#include "hal/app/navigation.h"

#include <string.h>

#include "tests/support/ecu_rig.h"
#include "tests/support/map_frames.h"
#include "tests/support/round_frames.h"

enum { SIDE = 20, BLOCK_BYTES = 2272, LEGS_MAX = 4, STREAM_MAX = 60 };

static uint64_t map_memory[SIDE];
static uint64_t way_memory[(3 * ((SIDE * SIDE + 31) / 32) + 1) / 2];
static uint8_t seen_memory[SIDE * SIDE / 4];
static uint64_t block[BLOCK_BYTES / 8];
static struct jp_course_leg legs[LEGS_MAX];
static struct jp_navigation navigation;
static struct jp_navigation_config navigator_config;
static struct sent_map sent;
static uint8_t stream[STREAM_MAX];
static uint8_t goal_counter;
static uint8_t change_counter;

/** A room of free cells round the robot, which looks along x from its middle. */
static void make_stream(bool has_wall)
{
    const struct jp_terrain_config ground = {.width = SIDE, .height = SIDE, .resolution = JP_Q16(0.1)};
    const struct jp_place place = {{JP_Q16(0.55), JP_Q16(0.55)}, 0};
    struct jp_terrain map;
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map, &ground, map_memory, sizeof map_memory, &field));
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        (void)jp_terrain_set_cell(&map, i % SIDE, i / SIDE,
                                  has_wall && i % SIDE == 11 ? JP_CELL_OCCUPIED : JP_CELL_FREE);
    }
    memset(&sent, 0, sizeof sent);
    sent = (struct sent_map){.bytes = stream, .id = 2};
    sent.length = (uint16_t)jp_map_encode(&map, &place, stream, sizeof stream);
    TEST_ASSERT_GREATER_THAN_UINT16(0, sent.length);
}

static void make(void)
{
    const char *field = "";

    navigator_config = (struct jp_navigation_config){.lattice = &jp_lattice_courier24,
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
                                                     .legs_max = LEGS_MAX};
    goal_counter = 0;
    change_counter = 0;
    make_stream(false);
    TEST_ASSERT_EQUAL_INT(JP_OK, navigation_start(&navigation, &navigator_config, &balancer.pilot, &field));
    TEST_ASSERT_NULL(field);
    jp_ecu_navigate(&ecu, &navigation);
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
}

static void send_goal_on(uint8_t map, uint8_t id, uint16_t x, uint16_t y)
{
    const struct jp_map_goal goal = {.map = map, .id = id, .x = x, .y = y};

    /* The first is never used: nothing came before to compare it with. */
    give(map_goal(++goal_counter & 15U, &goal));
    give(map_goal(++goal_counter & 15U, &goal));
    run(1);
}

static void send_goal(uint8_t id, uint16_t x, uint16_t y)
{
    send_goal_on(2, id, x, y);
}

static void change(uint8_t map, uint16_t x, uint16_t y, uint32_t cells)
{
    const struct jp_cell_changes changes = {.map = map, .x = x, .y = y, .cells = cells};

    give(cell_changes(++change_counter & 15U, &changes));
    run(1);
}

static struct jp_can_map_status_t map_status(void)
{
    struct jp_can_map_status_t status;

    run(110);
    TEST_ASSERT_EQUAL_INT(0, jp_can_map_status_unpack(&status, bus.last[0x14], JP_CAN_LENGTH_MAX));
    return status;
}

static struct jp_can_navigation_status_t navigation_status(void)
{
    struct jp_can_navigation_status_t status;

    run(110);
    TEST_ASSERT_EQUAL_INT(0, jp_can_navigation_status_unpack(&status, bus.last[0x15], JP_CAN_LENGTH_MAX));
    return status;
}

static void expect_map(enum jp_map_link_state state, enum jp_map_reason reason)
{
    const struct jp_can_map_status_t status = map_status();

    TEST_ASSERT_EQUAL_UINT8(state, status.state);
    TEST_ASSERT_EQUAL_UINT8(reason, status.reason);
}

static void expect_goal(uint8_t id, enum jp_goal_answer answer)
{
    const struct jp_can_navigation_status_t status = navigation_status();

    TEST_ASSERT_EQUAL_UINT8(id, status.goal_id);
    TEST_ASSERT_EQUAL_UINT8(answer, status.answer);
}

static void expect_navigator(enum jp_navigator_state state, enum jp_navigator_reason reason)
{
    const struct jp_can_navigation_status_t status = navigation_status();

    TEST_ASSERT_EQUAL_UINT8(state, status.state);
    TEST_ASSERT_EQUAL_UINT8(reason, status.reason);
}

static void make_ready(void)
{
    make();
    make_balancing();
    send_map();
    TEST_ASSERT_EQUAL_INT(JP_MAP_LINK_READY, navigation.maps.state);
    TEST_ASSERT_TRUE(navigation.is_prepared);
}

static void make_under_way(void)
{
    make_ready();
    send_goal(7, 14, 5);
    TEST_ASSERT_EQUAL_INT(JP_GOAL_TAKEN, navigation.answer);
    hold(JP_MODE_NAVIGATE, 7, 3);
    TEST_ASSERT_TRUE(jp_navigation_is_under_way(&navigation));
    TEST_ASSERT_EQUAL_INT(JP_GOAL_DRIVEN, navigation.answer);
}

/* Preparation. */

static void expect_refused_config(const char *member)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, navigation_start(&navigation, &navigator_config, &balancer.pilot, &field));
    TEST_ASSERT_EQUAL_STRING(member, field);
    make();
}

static void test_what_it_cannot_do_without(void)
{
    const char *field;

    make();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, navigation_start(NULL, &navigator_config, &balancer.pilot, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, navigation_start(&navigation, NULL, &balancer.pilot, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, navigation_start(&navigation, &navigator_config, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, navigation_start(&navigation, &navigator_config, &balancer.pilot, NULL));
    navigator_config.lattice = NULL;
    expect_refused_config("lattice");
    navigator_config.body = NULL;
    expect_refused_config("body");
    navigator_config.map = NULL;
    expect_refused_config("map");
    navigator_config.planner = NULL;
    expect_refused_config("planner");
    navigator_config.way = NULL;
    expect_refused_config("way");
    navigator_config.seen = NULL;
    expect_refused_config("seen");
    navigator_config.legs = NULL;
    expect_refused_config("legs");
    navigator_config.legs_max = 0;
    expect_refused_config("legs");
}

static void test_an_ecu_without_a_navigator_refuses_all(void)
{
    make();
    jp_ecu_navigate(&ecu, NULL);
    make_balancing();
    send_map();
    send_goal(1, 10, 10);
    hold(JP_MODE_NAVIGATE, 1, 5);
    expect_state(JP_ROBOT_BALANCING);
    TEST_ASSERT_EQUAL_UINT8(1 + (sent.length + JP_MAP_DATA - 1) / JP_MAP_DATA + 2, ecu.operator_counts.rejected);
    TEST_ASSERT_EQUAL_UINT16(0, bus.counts[0x14]);
}

/* Maps. */

static void test_a_map_arrives(void)
{
    make();
    run(3);
    expect_map(JP_MAP_LINK_NONE, JP_MAP_REASON_NONE);
    make_ready();
    const struct jp_can_map_status_t status = map_status();

    TEST_ASSERT_EQUAL_UINT8(2, status.map_id);
    TEST_ASSERT_EQUAL_UINT8(JP_MAP_LINK_READY, status.state);
    TEST_ASSERT_EQUAL_HEX32(jp_crc32(0, stream, sent.length), status.map_crc);
    TEST_ASSERT_EQUAL_UINT16((sent.length + JP_MAP_DATA - 1) / JP_MAP_DATA, status.received);
    expect_navigator(JP_NAVIGATOR_IDLE, JP_NAVIGATOR_NO_REASON);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.operator_counts.rejected);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.operator_counts.sequence_errors);
}

/* What drives take is of the robot, not of a map. */
static void test_what_it_has_learned_of_drives_stays_when_maps_change(void)
{
    const struct jp_stand_energy learned = {JP_Q16(12), JP_Q16(3), 40, 9};

    make();
    send_map();
    TEST_ASSERT_EQUAL_UINT16(0, navigation.navigator.stand.stands);
    navigation.navigator.stand = learned;
    sent.id = 3;
    send_map();
    TEST_ASSERT_EQUAL_INT(JP_MAP_LINK_READY, navigation.maps.state);
    TEST_ASSERT_EQUAL_UINT8(3, navigation.maps.id);
    TEST_ASSERT_EQUAL_MEMORY(&learned, &navigation.navigator.stand, sizeof learned);
}

static void test_a_map_for_which_the_planner_has_no_room(void)
{
    make();
    navigation.config.planner_size = 1024;
    make_balancing();
    send_map();
    expect_map(JP_MAP_LINK_REJECTED, JP_MAP_REASON_TOO_LARGE);
    send_goal(1, 10, 10);
    expect_goal(1, JP_GOAL_NO_MAP);
}

static void test_a_map_for_which_the_flood_has_no_room(void)
{
    make();
    navigation.config.way_size = 8;
    make_balancing();
    send_map();
    expect_map(JP_MAP_LINK_REJECTED, JP_MAP_REASON_TOO_LARGE);
}

static void test_a_map_for_which_what_is_seen_has_no_room(void)
{
    make();
    navigation.config.seen_size = sizeof seen_memory - 1;
    make_balancing();
    send_map();
    expect_map(JP_MAP_LINK_REJECTED, JP_MAP_REASON_TOO_LARGE);
    navigation.config.seen_size = sizeof seen_memory;
    sent.id = 4;
    send_map();
    expect_map(JP_MAP_LINK_READY, JP_MAP_REASON_NONE);
}

static void test_a_corrupt_map_leaves_none(void)
{
    make_ready();
    sent.id = 3;
    sent.crc_error = 1;
    send_map();
    expect_map(JP_MAP_LINK_REJECTED, JP_MAP_REASON_CRC);
    send_goal_on(3, 1, 10, 10);
    expect_goal(1, JP_GOAL_NO_MAP);
    hold(JP_MODE_NAVIGATE, 1, 4);
    expect_state(JP_ROBOT_BALANCING);
    expect_navigator(JP_NAVIGATOR_IDLE, JP_NAVIGATOR_NO_REASON);
    sent.crc_error = 0;
    send_map();
    expect_map(JP_MAP_LINK_READY, JP_MAP_REASON_NONE);
}

static void test_a_map_while_it_is_under_way_is_refused(void)
{
    make_under_way();
    sent.id = 3;
    give(map_offer(&sent));
    expect_map(JP_MAP_LINK_READY, JP_MAP_REASON_UNDER_WAY);
    TEST_ASSERT_EQUAL_UINT8(2, map_status().map_id);
    TEST_ASSERT_TRUE(jp_navigation_is_under_way(&navigation));
    hold(JP_MODE_STAND, 0, 2);
    send_map();
    expect_map(JP_MAP_LINK_READY, JP_MAP_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT8(3, map_status().map_id);
    expect_goal(0, JP_GOAL_NONE);
}

static void test_a_route_is_driven_while_a_map_arrives(void)
{
    make();
    make_driving();
    send_map();
    expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_MAP_LINK_READY, navigation.maps.state);
    TEST_ASSERT_EQUAL_INT(JP_PILOT_DRIVING, balancer.pilot.phase);
}

/* Goals. */

static void test_goals_are_answered(void)
{
    make();
    make_balancing();
    expect_goal(0, JP_GOAL_NONE);
    send_goal(1, 10, 10);
    expect_goal(1, JP_GOAL_NO_MAP);
    send_map();
    send_goal(1, 10, 10);
    expect_goal(1, JP_GOAL_TAKEN);
    send_goal_on(5, 2, 10, 10);
    expect_goal(2, JP_GOAL_OTHER_MAP);
    send_goal(3, SIDE, 10);
    expect_goal(3, JP_GOAL_OUTSIDE);
    send_goal(4, 0, 10);
    expect_goal(4, JP_GOAL_BLOCKED);
    send_goal(0, 10, 10);
    expect_goal(4, JP_GOAL_BLOCKED);
}

static void test_a_heading_is_the_nearest_of_the_lattice(void)
{
    const struct jp_map_goal goal = {.map = 2,
                                     .id = 9,
                                     .x = 10,
                                     .y = 10,
                                     .has_heading = true,
                                     .heading = jp_lattice_courier24.heading[5] + JP_ANGLE_DEGREES(2)};

    make_ready();
    give(map_goal(++goal_counter & 15U, &goal));
    give(map_goal(++goal_counter & 15U, &goal));
    run(1);
    expect_goal(9, JP_GOAL_TAKEN);
    hold(JP_MODE_NAVIGATE, 9, 3);
    TEST_ASSERT_EQUAL_HEX16(1U << 5, navigation.navigator.internal.goal.headings);
}

static void test_only_the_goal_that_is_named_is_driven_to(void)
{
    make_ready();
    send_goal(7, 14, 5);
    hold(JP_MODE_NAVIGATE, 8, 5);
    TEST_ASSERT_FALSE(jp_navigation_is_under_way(&navigation));
    expect_goal(7, JP_GOAL_TAKEN);
    hold(JP_MODE_NAVIGATE, 7, 3);
    TEST_ASSERT_TRUE(jp_navigation_is_under_way(&navigation));
}

static void test_a_goal_is_driven_to_once(void)
{
    make_under_way();
    hold(JP_MODE_STAND, 0, 2);
    expect_navigator(JP_NAVIGATOR_IDLE, JP_NAVIGATOR_TOLD);
    send_goal(7, 14, 5);
    hold(JP_MODE_NAVIGATE, 7, 5);
    expect_navigator(JP_NAVIGATOR_IDLE, JP_NAVIGATOR_TOLD);
    send_goal(8, 14, 5);
    hold(JP_MODE_NAVIGATE, 8, 3);
    TEST_ASSERT_TRUE(jp_navigation_is_under_way(&navigation));
}

static void test_a_goal_that_is_blocked_since_is_not_driven_to(void)
{
    make_ready();
    send_goal(7, 14, 5);
    expect_goal(7, JP_GOAL_TAKEN);
    change(2, 14, 5, 0xFFFFFD);
    hold(JP_MODE_NAVIGATE, 7, 3);
    expect_goal(7, JP_GOAL_BLOCKED);
    expect_navigator(JP_NAVIGATOR_IDLE, JP_NAVIGATOR_NO_REASON);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_it_says_that_no_way_leads_there(void)
{
    make();
    make_stream(true);
    make_balancing();
    send_map();
    send_goal(7, 15, 5);
    hold(JP_MODE_NAVIGATE, 7, 10);
    expect_navigator(JP_NAVIGATOR_UNREACHABLE, JP_NAVIGATOR_NO_REASON);
    expect_state(JP_ROBOT_BALANCING);
}

/* Changes. */

static enum jp_cell cell(int32_t x, int32_t y)
{
    return jp_terrain_cell(&navigation.maps.decoder.terrain, x, y);
}

static void test_cells_change(void)
{
    make_ready();
    /* Of twelve: occupied, as it was, unknown, free, and occupied beyond the map. */
    change(2, SIDE - 4, 9, 0xFFFD2D);
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, cell(SIDE - 4, 9));
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell(SIDE - 3, 9));
    TEST_ASSERT_EQUAL_INT(JP_CELL_UNKNOWN, cell(SIDE - 2, 9));
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell(SIDE - 1, 9));
    TEST_ASSERT_EQUAL_UINT8(1, map_status().cell_counter);
    change(2, SIDE - 4, 9, 0xFFFFFC);
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell(SIDE - 4, 9));
    change(2, 4095, 4095, 0x555555);
    TEST_ASSERT_EQUAL_UINT8(3, map_status().cell_counter);
}

/* A wall, on its way: what it saw may be elsewhere than where its odometry has put it. */
static void test_it_says_when_it_has_forgotten_what_was_seen(void)
{
    make_under_way();
    for (unsigned i = 0; i < 3000 && navigation.navigator.state != JP_NAVIGATOR_DRIVING; i += 100) {
        hold(JP_MODE_NAVIGATE, 7, 1);
    }
    hold(JP_MODE_NAVIGATE, 7, 1);
    for (uint16_t y = 0; y < SIDE; y++) {
        change(2, 11, y, 0xFFFFFD);
    }
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, cell(11, 9));
    TEST_ASSERT_EQUAL_UINT8(0, navigation_status().forgets);
    for (unsigned i = 0; i < 30000 && navigation.navigator.forgets == 0; i += 100) {
        hold(JP_MODE_NAVIGATE, 7, 1);
    }
    hold(JP_MODE_NAVIGATE, 7, 2);
    TEST_ASSERT_EQUAL_UINT8(1, navigation_status().forgets);
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell(11, 9));
    navigation.navigator.forgets = 17;
    hold(JP_MODE_NAVIGATE, 7, 2);
    TEST_ASSERT_EQUAL_UINT8(1, navigation_status().forgets);
}

static void test_changes_of_another_map_change_nothing(void)
{
    make_ready();
    change(3, 5, 9, 0x555555);
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell(5, 9));
    TEST_ASSERT_EQUAL_UINT8(1, map_status().cell_counter);
}

static void test_changes_before_there_is_a_map(void)
{
    make();
    run(2);
    change(0, 5, 9, 0x555555);
    change(2, 5, 9, 0x555555);
    TEST_ASSERT_EQUAL_UINT8(2, map_status().cell_counter);
    expect_map(JP_MAP_LINK_NONE, JP_MAP_REASON_NONE);
}

static void test_corrupt_frames_change_nothing(void)
{
    const struct jp_cell_changes changes = {.map = 2, .x = 5, .y = 9, .cells = 0x555555};
    struct jp_can_frame frame = cell_changes(1, &changes);

    make_ready();
    for (unsigned bit = 0; bit < 64; bit++) {
        frame.data[bit / 8] ^= (uint8_t)(1U << (bit % 8));
        give(frame);
        run(1);
        frame.data[bit / 8] ^= (uint8_t)(1U << (bit % 8));
    }
    TEST_ASSERT_EQUAL_UINT8(64, ecu.operator_counts.crc_errors);
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell(5, 9));
}

static void test_frames_of_a_wrong_length_are_counted(void)
{
    make_ready();
    for (uint32_t id = JP_CAN_MAP_OFFER_FRAME_ID; id <= JP_CAN_MAP_GOAL_FRAME_ID; id++) {
        give((struct jp_can_frame){.id = id, .length = 7});
    }
    run(1);
    TEST_ASSERT_EQUAL_UINT8(4, ecu.sample_counts.malformed);
    TEST_ASSERT_EQUAL_INT(JP_MAP_LINK_READY, navigation.maps.state);
}

static void test_a_navigator_that_does_not_go_round_refuses_rounds(void)
{
    static const uint8_t bytes[JP_ROUND_BYTES_MAX] = {1};
    struct sent_round sent_round = {.bytes = bytes, .stops = 1, .map = 2, .id = 9};

    make_ready();
    give(round_offer(&sent_round));
    give(round_data(&sent_round, 0));
    give(battery_charge(&sent_round, 160)); /* is no command */
    run(1);
    TEST_ASSERT_EQUAL_UINT8(2, ecu.operator_counts.rejected);
    TEST_ASSERT_EQUAL_UINT8(0, ecu.operator_counts.crc_errors);
    TEST_ASSERT_FALSE(jp_navigation_goes_round(&navigation));
    send_goal(7, 5, 14);
    expect_goal(7, JP_GOAL_TAKEN);
    expect_map(JP_MAP_LINK_READY, JP_MAP_REASON_NONE);
}

/* Under way. */

static void test_it_plans_and_turns(void)
{
    make_ready();
    send_goal(7, 5, 14);
    hold(JP_MODE_NAVIGATE, 7, 10);
    const struct jp_can_navigation_status_t status = navigation_status();

    TEST_ASSERT_EQUAL_UINT8(JP_NAVIGATOR_TURNING, status.state);
    TEST_ASSERT_EQUAL_UINT8(1, status.has_course);
    TEST_ASSERT_EQUAL_UINT8(1, status.course);
    TEST_ASSERT_GREATER_THAN_UINT8(0, status.legs_left);
    expect_state(JP_ROBOT_DRIVING);

    struct jp_can_navigation_progress_t progress;
    struct jp_can_course_leg_t leg;

    (void)jp_can_navigation_progress_unpack(&progress, bus.last[0x16], JP_CAN_LENGTH_MAX);
    TEST_ASSERT_UINT_WITHIN(6, 58, progress.distance); /* 0.9 m */
    TEST_ASSERT_GREATER_THAN_UINT16(0, progress.duration);
    TEST_ASSERT_GREATER_THAN_UINT32(0, progress.energy);
    (void)jp_can_course_leg_unpack(&leg, bus.last[0x17], JP_CAN_LENGTH_MAX);
    TEST_ASSERT_EQUAL_UINT8(1, leg.course);
    TEST_ASSERT_LESS_THAN_UINT8(status.legs_left, leg.after);
}

static void test_stand_ends_it(void)
{
    make_under_way();
    hold(JP_MODE_STAND, 0, 1);
    expect_navigator(JP_NAVIGATOR_IDLE, JP_NAVIGATOR_TOLD);
    run(3000);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_the_stand_of_anybody_ends_it(void)
{
    struct jp_can_frame frame;

    make_under_way();
    frame = operator_command((command_counter + 9U) & 15U, JP_MODE_STAND, 0);
    give(frame);
    hold(JP_MODE_NAVIGATE, 7, 5);
    expect_navigator(JP_NAVIGATOR_IDLE, JP_NAVIGATOR_TOLD);
    run(3000);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_a_silent_operator_ends_it(void)
{
    make_under_way();
    run(380);
    TEST_ASSERT_TRUE(jp_navigation_is_under_way(&navigation));
    run(140);
    TEST_ASSERT_FALSE(jp_navigation_is_under_way(&navigation));
    TEST_ASSERT_EQUAL_UINT8(1, ecu.operator_timeouts);
    expect_operator(JP_OPERATOR_LOST, JP_MODE_STAND);
    expect_navigator(JP_NAVIGATOR_IDLE, JP_NAVIGATOR_TOLD);
    run(3000);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_off_ends_it(void)
{
    make_under_way();
    hold(JP_MODE_OFF, 0, 3);
    expect_navigator(JP_NAVIGATOR_IDLE, JP_NAVIGATOR_TOLD);
    expect_state(JP_ROBOT_IDLE);
}

static void test_a_robot_that_is_off_does_not_go(void)
{
    make();
    run(3);
    send_map();
    send_goal(7, 14, 5);
    command(JP_MODE_STAND, 0);
    hold(JP_MODE_NAVIGATE, 7, 5);
    expect_state(JP_ROBOT_IDLE);
    expect_goal(7, JP_GOAL_TAKEN);
}

static void test_a_fault_ends_it(void)
{
    make_under_way();
    run_without_samples(60);
    expect_state(JP_ROBOT_FAULT);
    run(1);
    expect_navigator(JP_NAVIGATOR_FAILED, JP_NAVIGATOR_OFF);
}

static void test_a_route_replaces_it(void)
{
    make_under_way();
    offer(9, near_route, 2);
    hold(JP_MODE_DRIVE, 9, 3);
    expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
    expect_navigator(JP_NAVIGATOR_IDLE, JP_NAVIGATOR_TOLD);
    TEST_ASSERT_NOT_EQUAL_INT(JP_PILOT_RESTING, balancer.pilot.phase);
}

static void test_drive_ends_it_also_without_a_route(void)
{
    make_under_way();
    hold(JP_MODE_DRIVE, 9, 2);
    TEST_ASSERT_TRUE(jp_navigation_is_under_way(&navigation));
    hold(JP_MODE_DRIVE, 9, 1);
    expect_navigator(JP_NAVIGATOR_IDLE, JP_NAVIGATOR_TOLD);
    run(3000);
    expect_state(JP_ROBOT_BALANCING);
}

static void test_navigate_ends_a_route_also_without_a_goal(void)
{
    make();
    make_driving();
    hold(JP_MODE_NAVIGATE, 7, 3);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_COMMAND);
    TEST_ASSERT_EQUAL_INT(JP_PILOT_RESTING, balancer.pilot.phase);
    expect_navigator(JP_NAVIGATOR_IDLE, JP_NAVIGATOR_NO_REASON);
}

static void test_it_replaces_a_route(void)
{
    make();
    make_driving();
    send_map();
    send_goal(7, 14, 5);
    expect_route(JP_ROUTE_DRIVING, JP_REASON_NONE);
    hold(JP_MODE_NAVIGATE, 7, 3);
    expect_route(JP_ROUTE_STOPPED, JP_REASON_COMMAND);
    TEST_ASSERT_TRUE(jp_navigation_is_under_way(&navigation));
}

static void test_another_goal_replaces_it(void)
{
    make_under_way();
    send_goal(8, 5, 14);
    TEST_ASSERT_TRUE(jp_navigation_is_under_way(&navigation));
    TEST_ASSERT_EQUAL_INT16(14, navigation.navigator.internal.goal.x);
    hold(JP_MODE_NAVIGATE, 8, 3);
    TEST_ASSERT_EQUAL_INT16(5, navigation.navigator.internal.goal.x);
    expect_goal(8, JP_GOAL_DRIVEN);
}

/* The report. */

static void test_reports_come_at_their_rate_in_single_frames(void)
{
    make_under_way();
    memset(bus.counts, 0, sizeof bus.counts);
    bus.most_in_a_tick = 0;
    for (unsigned i = 0; i < 10; i++) {
        hold(JP_MODE_NAVIGATE, 7, 1);
    }
    for (uint32_t place = 0x14; place < 0x17; place++) {
        TEST_ASSERT_UINT_WITHIN(1, 10, bus.counts[place]);
    }
    TEST_ASSERT_LESS_OR_EQUAL_UINT(10U * JP_NAVIGATION_REPORT_LEGS + JP_NAVIGATION_REPORT_LEGS, bus.counts[0x17]);
    TEST_ASSERT_LESS_OR_EQUAL_UINT(4, bus.most_in_a_tick);
}
