/* The patrol robot's application while things fail. Over a bus in a scene: the operator falls silent, somebody says
 * Stand, samples and scans fail to come, the controller restarts or is off the bus, another one drives the wheels. Each
 * time the robot touches nothing and comes to a stand by itself or goes on, and drives to its goal when it is told to
 * again. On a board of its own: each call of its HAL fails once. */
#include <math.h>
#include <string.h>

#include "hal/app/ecu_patrol_way.h"
#include "sim/bus/bus_drive.h"
#include "sim/bus/local_ecu.h"
#include "sim/four_wheel/four_wheel_file.h"
#include "sim/scenes/patrol_scene.h"
#include "tests/support/commands.h"
#include "tests/support/frame_thief.h"
#include "tests/support/patrol_room.h"
#include "unity.h"

#define STREAM_MAX  8192
#define DRIVE_TICKS 6000
#define STAND_TICKS 300

static struct local_ecu ecu;
static struct bus_drive drive;
static struct patrol_body body;
static struct jp_navigation_operator commander;
static struct four_wheel_file file;
static struct patrol_scene scene;
static uint8_t stream[STREAM_MAX];
static struct jp_map_stream map;
static struct jp_map_goal place;
static struct jp_place origin;

static void begin(enum patrol_scene_kind kind)
{
    struct jp_can_link link;

    patrol_scene_make(kind, 1, &scene);
    origin = (struct jp_place){
        {(jp_q16)lround((double)scene.start.x * 65536), (jp_q16)lround((double)scene.start.y * 65536)},
        (jp_angle)llround((double)scene.start.heading / (2 * M_PI) * 4294967296.0)};
    TEST_ASSERT_TRUE(four_wheel_file_load("sim/robots/patrol.cfg", &file));
    TEST_ASSERT_TRUE(local_ecu_start_patrol(&ecu, patrol_robot_find("patrol"), &link));
    TEST_ASSERT_TRUE(patrol_body_init(&body, &file, &scene, 1));
    body.is_world_moving = true;
    bus_drive_init_patrol(&drive, &body, &link);
    memset(&commander, 0, sizeof commander);
    drive.navigation = &commander;
    map = (struct jp_map_stream){.bytes = stream, .id = 1};
    map.length = (uint16_t)jp_map_encode(&scene.map, &origin, stream, sizeof stream);
    TEST_ASSERT_GREATER_THAN_UINT16(0, map.length);
    place = (struct jp_map_goal){.x = (uint16_t)((double)scene.goal.x / 0.05),
                                 .y = (uint16_t)((double)scene.goal.y / 0.05),
                                 .has_heading = true,
                                 .heading = (jp_angle)llround((double)scene.goal.heading / (2 * M_PI) * 4294967296.0)};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &place));
}

void setUp(void)
{
    begin(PATROL_L_PASSAGE);
}

void tearDown(void)
{
    patrol_body_free(&body);
    patrol_scene_free(&scene);
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
    return hypot(body.plant.state.forward, body.plant.state.left);
}

static void pass_until_it_rolls(void)
{
    pass_until(JP_NAVIGATION_DRIVING);
    for (unsigned i = 0; i < DRIVE_TICKS && speed() < 0.5; i++) {
        pass(1);
    }
    TEST_ASSERT_TRUE(speed() >= 0.5);
}

static void expect_untouched(void)
{
    TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_NONE, body.world.first_touch);
}

static void expect_stand(void)
{
    pass(STAND_TICKS);
    TEST_ASSERT_EQUAL_UINT8(JP_ECU_STANDING, drive.view.status.state);
    TEST_ASSERT_TRUE(speed() < 0.01);
    TEST_ASSERT_EQUAL_UINT16(0, drive.view.errors.faults);
    expect_untouched();
}

static void expect_arrival(void)
{
    pass_until(JP_NAVIGATION_DONE);
    expect_stand();
    TEST_ASSERT_TRUE(
        hypot(body.plant.state.pose.x - (double)scene.goal.x, body.plant.state.pose.y - (double)scene.goal.y) < 0.15);
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

static void steal(uint32_t id, unsigned count, unsigned every)
{
    thief_enter(&drive.link);
    thief_steal(id, count, every);
}

/* Over the bus. */

static void test_arrives_when_nothing_happens(void)
{
    expect_arrival();
    TEST_ASSERT_EQUAL_UINT8(JP_CAN_PATROL_STATUS_PATROL_STATE_ARRIVED_CHOICE, drive.view.patrol.patrol_state);
    TEST_ASSERT_EQUAL_UINT8(JP_CAN_PATROL_STATUS_LOCALISER_STATE_TRACKING_CHOICE, drive.view.patrol.localiser_state);
    TEST_ASSERT_EQUAL_UINT16(0, drive.view.patrol.lost_scans);
    TEST_ASSERT_TRUE(hypot(drive.view.map_pose.x / 8192.0 - body.plant.state.pose.x,
                           drive.view.map_pose.y / 8192.0 - body.plant.state.pose.y) < 0.05);
    TEST_ASSERT_TRUE(drive.view.segment_result.drawn > 0);
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.learner.version);
    /* What the ECU metered is what the plant took since the start, but for a part of the sensor's step. */
    TEST_ASSERT_TRUE(fabs((double)drive.view.drawn.energy / 4294967296.0 - body.plant.ledger.battery) < 3.0);
}

static void test_the_operator_falls_silent(void)
{
    pass_until_it_rolls();
    drive.conditions.operator_silent = true;
    pass(45);
    TEST_ASSERT_TRUE(speed() > 0.1);
    expect_stand();
    TEST_ASSERT_EQUAL_UINT8(JP_OPERATOR_LOST, drive.view.status.operator_state);
    drive.conditions.operator_silent = false;
    expect_failure(JP_NAVIGATION_SILENCE);
    go_again();
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

static void test_samples_that_get_lost_are_ridden_out(void)
{
    steal(JP_CAN_SUPPLY_SENSORS_FRAME_ID, 150, 5);
    expect_arrival();
    TEST_ASSERT_TRUE(drive.view.losses.lost_samples >= 100);
}

static void test_without_samples_it_brakes_with_a_fault(void)
{
    pass_until_it_rolls();
    steal(JP_CAN_SUPPLY_SENSORS_FRAME_ID, 150, 0);
    pass(120);
    TEST_ASSERT_TRUE(speed() < 0.01);
    TEST_ASSERT_EQUAL_UINT8(JP_ECU_FAULT, drive.view.status.state);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, drive.view.errors.faults);
    expect_untouched();
    expect_failure(JP_NAVIGATION_FAULT);
}

static void test_after_a_fault_off_and_stand_let_it_drive_again(void)
{
    struct jp_can_frame frame;

    test_without_samples_it_brakes_with_a_fault();
    pass(60);
    jp_navigation_operator_stop(&commander);
    drive.conditions.operator_silent = true;
    for (uint8_t i = 0; i < 8; i++) {
        frame = operator_command((uint8_t)((commander.command_counter + 1U + i) & 15U), JP_MODE_OFF, 0);
        TEST_ASSERT_EQUAL_INT(JP_OK, drive.link.port.send(drive.link.port.context, &frame));
        pass(5);
    }
    TEST_ASSERT_EQUAL_UINT8(JP_ECU_IDLE, drive.view.status.state);
    drive.conditions.operator_silent = false;
    memset(&commander, 0, sizeof commander);
    go_again();
}

static void test_scans_that_get_lost_are_ridden_out(void)
{
    steal(JP_CAN_SCAN_RANGES_FRAME_ID, 20, 250); /* of 90 in a scan */
    expect_arrival();
    TEST_ASSERT_TRUE(drive.view.patrol.lost_scans >= 10);
}

static void test_without_scans_it_stops_and_goes_on_with_them(void)
{
    pass_until_it_rolls();
    steal(JP_CAN_SCAN_END_FRAME_ID, 25, 0);
    pass(200);
    TEST_ASSERT_TRUE(speed() < 0.01);
    expect_untouched();
    expect_arrival();
}

static void test_wheel_targets_that_do_not_come_stop_the_wheels(void)
{
    pass_until_it_rolls();
    drive.conditions.ecu_bus_off = true;
    pass(60);
    TEST_ASSERT_TRUE(speed() < 0.01);
    TEST_ASSERT_TRUE(drive.plant.silences == 1);
    drive.conditions.ecu_bus_off = false;
    expect_untouched();
    pass(100);
    TEST_ASSERT_EQUAL_UINT8(JP_ECU_FAULT, drive.view.status.state);
    TEST_ASSERT_TRUE(drive.view.errors.bus_offs > 0);
}

static void test_a_short_bus_off_is_ridden_out(void)
{
    pass_until_it_rolls();
    drive.conditions.ecu_bus_off = true;
    pass(3);
    drive.conditions.ecu_bus_off = false;
    expect_arrival();
}

static void test_the_controller_restarts_while_it_drives(void)
{
    pass_until_it_rolls();
    drive.conditions.ecu_reset = true;
    pass(3);
    drive.conditions.ecu_reset = false;
    expect_failure(JP_NAVIGATION_RESTART);
    expect_stand();
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.status.resets);
    TEST_ASSERT_EQUAL_UINT8(JP_MAP_LINK_NONE, drive.view.map.state);
    go_again();
}

static void test_the_record_of_another_robot_is_not_taken_up(void)
{
    union jp_retained_snapshot snapshot = {.skid = {.ran = 1}};

    jp_retained_write(&ecu.node.own_record, JP_RETAINED_SKID, &snapshot, 0);
    drive.conditions.ecu_reset = true;
    pass(3);
    drive.conditions.ecu_reset = false;
    pass(10);
    TEST_ASSERT_EQUAL_UINT8(JP_ECU_IDLE, drive.view.status.state);
}

static void hear_another_controller(void)
{
    const struct jp_four_wheel_actuation off = {.enabled = 0};
    struct jp_can_frame frames[JP_WHEELS];
    uint8_t counter = 7;

    jp_wheel_targets_pack(frames, &counter, &off);
    TEST_ASSERT_EQUAL_INT(JP_OK, drive.link.port.send(drive.link.port.context, &frames[0]));
}

static void test_another_controller_is_noticed(void)
{
    pass_until_it_rolls();
    hear_another_controller();
    pass(15);
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.errors.conflicts);
    TEST_ASSERT_TRUE(speed() >= 0.5);
    expect_arrival();
}

/* Nobody but the test commands the robot. */

static void wake(void)
{
    drive.conditions.operator_silent = true;
    pass(20);
    TEST_ASSERT_EQUAL_UINT8(JP_ECU_IDLE, drive.view.status.state);
}

static void tell_to_stand(void)
{
    static uint8_t counter;

    for (int i = 0; i < 4; i++) {
        const struct jp_can_frame frame = operator_command(++counter & 15U, JP_MODE_STAND, 0);

        TEST_ASSERT_EQUAL_INT(JP_OK, drive.link.port.send(drive.link.port.context, &frame));
        pass(5);
    }
}

static void make_standing(void)
{
    wake();
    tell_to_stand();
    TEST_ASSERT_EQUAL_UINT8(JP_ECU_STANDING, drive.view.status.state);
}

static void expect_conflict(enum jp_ecu_state state, enum jp_refusal refusal, uint16_t faults)
{
    hear_another_controller();
    tell_to_stand();
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.errors.conflicts);
    TEST_ASSERT_EQUAL_UINT8(state, drive.view.status.state);
    TEST_ASSERT_EQUAL_UINT8(refusal, drive.view.losses.stand_refusal);
    TEST_ASSERT_EQUAL_HEX16(faults, drive.view.errors.faults);
    TEST_ASSERT_TRUE(speed() < 0.01);
}

static void test_beside_another_controller_it_leaves_it_the_wheels_and_does_not_stand_up(void)
{
    wake();
    TEST_ASSERT_EQUAL_UINT32(0, drive.plant.silence);
    expect_conflict(JP_ECU_IDLE, JP_REFUSAL_CONFLICT, 0);
    TEST_ASSERT_EQUAL_UINT32(20, drive.plant.silence);
    pass(50);
    TEST_ASSERT_EQUAL_UINT32(0, drive.plant.silence);
    tell_to_stand();
    TEST_ASSERT_EQUAL_UINT8(JP_ECU_STANDING, drive.view.status.state);
}

static void test_beside_another_controller_it_goes_on_standing(void)
{
    make_standing();
    expect_conflict(JP_ECU_STANDING, JP_REFUSAL_NONE, 0);
    TEST_ASSERT_EQUAL_UINT32(0, drive.plant.silence);
}

static void test_beside_another_controller_a_fault_stays(void)
{
    make_standing();
    steal(JP_CAN_SUPPLY_SENSORS_FRAME_ID, 30, 0);
    pass(40);
    expect_conflict(JP_ECU_FAULT, JP_REFUSAL_FAULT, JP_FAULT_HARDWARE);
}

static void test_corrupt_samples_are_counted(void)
{
    struct jp_four_wheel_sensors sensors = {.bus_voltage = 0};
    struct jp_can_frame frames[JP_WHEEL_SAMPLE_FRAMES];
    uint8_t counter = 0;

    pass(20);
    jp_wheel_sample_pack(frames, &counter, &sensors);
    frames[0].data[3] ^= 1U;
    TEST_ASSERT_EQUAL_INT(JP_OK, drive.link.port.send(drive.link.port.context, &frames[0]));
    frames[1].length = 7;
    TEST_ASSERT_EQUAL_INT(JP_OK, drive.link.port.send(drive.link.port.context, &frames[1]));
    pass(15);
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.errors.crc_errors);
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.errors.malformed);
}

static void test_what_was_learned_is_told_and_kept(void)
{
    expect_arrival();
    TEST_ASSERT_EQUAL_UINT8(0, drive.view.learner.left_out);
    TEST_ASSERT_TRUE(ecu_node_watch(&ecu.node));
    TEST_ASSERT_TRUE(ecu_node_end(&ecu.node));
    drive.conditions.ecu_reset = true;
    pass(3);
    drive.conditions.ecu_reset = false;
    pass(120);
    TEST_ASSERT_EQUAL_UINT8(JP_CAN_LEARNER_STATUS_STORED_TAKEN_CHOICE, drive.view.learner.stored);
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.learner.version);
}

/* Routes, by an operator who knows nothing of maps. */

static void drive_route(const struct jp_point *points, size_t count)
{
    drive.navigation = NULL;
    memset(&drive.commander, 0, sizeof drive.commander);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&drive.commander, points, count));
    for (unsigned i = 0;
         i < DRIVE_TICKS && drive.commander.phase != JP_OPERATOR_DONE && drive.commander.phase != JP_OPERATOR_FAILED;
         i++) {
        pass(1);
    }
}

static void test_without_a_map_it_refuses_a_route(void)
{
    const struct jp_point points[1] = {{JP_Q16(0.5), 0}};

    drive_route(points, 1);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_FAILED, drive.commander.phase);
    TEST_ASSERT_TRUE(speed() < 0.01);
    TEST_ASSERT_EQUAL_INT8(JP_ERR_NO_PLAN, drive.view.route.plan_status);
}

static void test_with_a_map_it_drives_a_route_to_its_end(void)
{
    struct jp_point back[1] = {{0, 0}};

    expect_arrival();
    drive_route(back, 1);
    TEST_ASSERT_EQUAL_INT_MESSAGE(JP_OPERATOR_DONE, drive.commander.phase,
                                  jp_operator_failure_text(drive.commander.failure));
    TEST_ASSERT_TRUE(
        hypot(body.plant.state.pose.x - (double)scene.start.x, body.plant.state.pose.y - (double)scene.start.y) < 0.2);
    expect_untouched();
}

static void test_a_goal_in_a_wall_is_refused(void)
{
    place.x = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &place));
    expect_failure(JP_NAVIGATION_GOAL);
    TEST_ASSERT_EQUAL_UINT8(JP_GOAL_BLOCKED, drive.view.navigation.answer);
}

static void test_a_goal_without_a_heading_is_driven_to_as_the_robot_looks(void)
{
    place.has_heading = false;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &place));
    expect_arrival();
}

static void test_another_map_takes_the_place_of_the_first(void)
{
    expect_arrival();
    map.id = 2;
    go_again();
    TEST_ASSERT_EQUAL_UINT8(2, drive.view.map.map_id);
}

static void test_what_another_sensor_sees_is_acknowledged(void)
{
    expect_arrival();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_see(&commander, 3, 3, JP_CELL_FREE));
    pass(100);
    TEST_ASSERT_EQUAL_UINT8(1, drive.view.map.cell_counter);
}

static void test_where_no_way_leads_it_says_so(void)
{
    const struct jp_point points[1] = {{0, 0}};
    const int32_t column = place.x;

    expect_arrival();
    /* Walls close in on it: those of the map, as it were. */
    for (int32_t x = column - 14; x <= column + 14; x++) {
        for (int32_t y = 0; y < scene.map.config.height; y++) {
            const bool is_near = (x - column) * (x - column) + (y - place.y) * (y - place.y) < 170;

            (void)jp_terrain_set_cell(&scene.map, x, y, is_near ? JP_CELL_FREE : JP_CELL_OCCUPIED);
        }
    }
    map.length = (uint16_t)jp_map_encode(&scene.map, &origin, stream, sizeof stream);
    map.id = 3;
    place.x = (uint16_t)((double)scene.start.x / 0.05);
    place.y = (uint16_t)((double)scene.start.y / 0.05);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigation_operator_go(&commander, &map, &place));
    expect_failure(JP_NAVIGATION_GAVE_UP);
    drive_route(points, 1);
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_FAILED, drive.commander.phase);
    TEST_ASSERT_TRUE(speed() < 0.01);
    expect_untouched();
}

/* On a board of its own, whose HAL fails once: at the call of this number, and there once. */

static struct jp_ecu_patrol patrol;
static struct jp_ecu board;
static struct patrol_room room;
static struct jp_terrain ground;
static uint64_t ground_block[1024];
static uint64_t block[32768];
static struct jp_wayfinder finder;

enum { READS, WRITES, SCANS, CALLS };
static unsigned calls[CALLS];
static unsigned fails_at[CALLS];
static bool has_scan;

static bool fails(unsigned call)
{
    return ++calls[call] == fails_at[call];
}

static enum jp_status board_read(void *context, struct jp_four_wheel_sensors *sensors)
{
    (void)context;
    if (fails(READS)) {
        return JP_ERR_HARDWARE;
    }
    *sensors = room.sensors;
    return JP_OK;
}

static enum jp_status board_write(void *context, const struct jp_four_wheel_actuation *actuation)
{
    (void)context;
    if (fails(WRITES)) {
        room.actuation.enabled = 0;
        return JP_ERR_HARDWARE;
    }
    room.actuation = *actuation;
    return JP_OK;
}

static bool board_scan(void *context, float *ranges)
{
    (void)context;
    if (!has_scan || fails(SCANS)) {
        return false;
    }
    has_scan = false;
    memcpy(ranges, room.ranges, sizeof room.ranges);
    return true;
}

static enum jp_status send_nowhere(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    (void)frame;
    return JP_OK;
}

static enum jp_can_state always_on(void *context)
{
    (void)context;
    return JP_CAN_ON;
}

static const struct jp_plane_pose board_start = {1.5f, 1.5f, 0.0f};

static void boot(void)
{
    const struct patrol_robot_entry *entry = patrol_robot_find("patrol");
    const struct jp_terrain_config size = {.width = ROOM_WIDTH, .height = ROOM_HEIGHT, .resolution = JP_Q16(0.05)};
    const struct jp_place began = {{JP_Q16(1.5), JP_Q16(1.5)}, 0};
    const struct jp_patrol_pilot_config pilot = {.patrol = entry->patrol,
                                                 .localiser = entry->localiser,
                                                 .scanner = entry->scanner,
                                                 .energy = entry->energy,
                                                 .learning = entry->learning,
                                                 .points_max = 256,
                                                 .turns_max = 32};
    const struct jp_ecu_patrol_config config = {
        .robot = entry->config, .pilot = &pilot, .block = block, .size = sizeof block, .stored = JP_STORED_NOTHING};
    const struct jp_four_wheel_hal hal = {.read = board_read, .write = board_write, .scan = board_scan};
    const struct jp_can_port port = {.send = send_nowhere, .state = always_on};
    struct jp_ecu_robot robot;
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&ground, &size, ground_block, sizeof ground_block, &field));
    patrol_room_draw(&ground);
    patrol_room_start(&room, &board_start);
    memset(calls, 0, sizeof calls);
    has_scan = false;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ecu_patrol_init(&patrol, &config, &robot, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ecu_init(&board, &robot, &port, NULL));
    jp_ecu_patrol_use_board(&patrol, &hal);
    finder = jp_ecu_patrol_wayfinder(&patrol);
    TEST_ASSERT_EQUAL_INT(JP_OK, finder.prepare(finder.self, &ground, &began));
}

static void board_tick(unsigned tick)
{
    if (tick % 10 == 0) {
        patrol_room_scan(&room, patrol_robot_find("patrol")->scanner);
        has_scan = true;
    }
    jp_ecu_tick(&board);
    if (tick % 10 == 0) {
        jp_ecu_patrol_begin_scan(&patrol);
    }
    (void)finder.work(finder.self);
    patrol_room_tick(&room, jp_four_wheel_robot_configuration(&patrol.robot));
}

static unsigned drive_on_board(void)
{
    const struct jp_map_goal there = {.x = 60, .y = 36, .has_heading = true};
    unsigned tick = 0;

    boot();
    while (tick < 20) {
        board_tick(tick++);
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_enable(&patrol.robot));
    board_tick(tick++);
    if (finder.go(finder.self, &there) != JP_OK) {
        board_tick(tick++);
        TEST_ASSERT_EQUAL_INT(JP_OK, finder.go(finder.self, &there));
    }
    while (tick < 3000 && finder.is_under_way(finder.self)) {
        board_tick(tick++);
    }
    return tick;
}

static void test_each_call_of_the_hal_may_fail_once(void)
{
    memset(fails_at, 0, sizeof fails_at);
    const unsigned ticks = drive_on_board();
    unsigned all[CALLS];

    memcpy(all, calls, sizeof all);
    TEST_ASSERT_TRUE(ticks < 2000);
    for (unsigned call = 0; call < CALLS; call++) {
        for (unsigned n = 1; n < all[call]; n += all[call] / 12 + 1) {
            memset(fails_at, 0, sizeof fails_at);
            fails_at[call] = n;
            (void)drive_on_board();
            TEST_ASSERT_EQUAL_INT(JP_MISSION_ARRIVED, patrol.pilot.mission.state);
            TEST_ASSERT_TRUE(hypot((double)room.pose.x - 3.025, (double)room.pose.y - 1.825) < 0.2);
        }
    }
}

static void test_its_tables_are_checked(void)
{
    const struct patrol_robot_entry *entry = patrol_robot_find("patrol");
    struct jp_patrol_scanner wide = *entry->scanner;
    struct jp_patrol_pilot_config pilot = {.patrol = entry->patrol,
                                           .localiser = entry->localiser,
                                           .scanner = &wide,
                                           .energy = entry->energy,
                                           .learning = entry->learning,
                                           .points_max = 256,
                                           .turns_max = 32};
    struct jp_ecu_patrol_config config = {
        .robot = entry->config, .pilot = &pilot, .block = block, .size = sizeof block, .stored = JP_STORED_TAKEN};
    struct jp_ecu_robot robot;
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_patrol_init(&patrol, &config, &robot, &field));
    config.stored = JP_STORED_NOTHING;
    wide.beams = 721;
    wide.angle_step = 0.008f;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_ecu_patrol_init(&patrol, &config, &robot, &field));
    TEST_ASSERT_EQUAL_STRING("scanner.beams", field);
    wide.beams = 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_ecu_patrol_init(&patrol, &config, &robot, &field));
    config.block = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_patrol_init(&patrol, &config, &robot, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_patrol_init(NULL, &config, &robot, &field));
}
