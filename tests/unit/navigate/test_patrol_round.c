/* Hours of patrol in a room: round between places, and home while the energy lasts. */
#include <float.h>
#include <joulepath/patrol_round.h>
#include <joulepath/tables.h>

#include "tests/support/patrol_room.h"
#include "unity.h"

#define BLOCK      262144U
#define SCAN_TICKS 10U
#define PATIENCE   60000U /* ticks */
#define TICK       0.01f

static uint64_t map_block[1024];
static uint64_t block[BLOCK / 8U];
static struct jp_terrain map;
static struct patrol_room room;
static struct jp_four_wheel_robot robot;
static struct jp_patrol_pilot pilot;
static struct jp_patrol_round round_trip;
static struct jp_patrol_round_config config;
static float available;
static float charging; /* J a tick at the charger */
static uint32_t ticks;
static const char *field;

static const struct jp_plane_pose home = {1.0f, 1.0f, 0.0f};

static void prepare(void)
{
    const struct jp_terrain_config size = {.width = ROOM_WIDTH, .height = ROOM_HEIGHT, .resolution = JP_Q16(0.05)};
    const struct jp_patrol_pilot_config tables = {.patrol = &jp_patrol_config_patrol,
                                                  .localiser = &jp_localiser_config_patrol,
                                                  .scanner = &jp_patrol_scanner_patrol,
                                                  .energy = &jp_four_wheel_energy_patrol,
                                                  .learning = &jp_four_wheel_learning_patrol,
                                                  .points_max = 256,
                                                  .turns_max = 32};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map, &size, map_block, sizeof map_block, &field));
    patrol_room_draw(&map);
    patrol_room_start(&room, &home);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_init(&robot, &jp_four_wheel_robot_patrol, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_init(&pilot, &tables, &robot, &field));
}

static void take_map(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_take_map(&pilot, &map, &home, block, sizeof block, &field));
}

void setUp(void)
{
    config = (struct jp_patrol_round_config){
        .stops = {{{4.5f, 1.0f, 0.0f}, 2.0f}, {{4.5f, 3.0f, 3.0f}, 1.0f}, {{1.5f, 3.0f, 3.0f}, 0.0f}},
        .stop_count = 3,
        .charger = home,
        .full = 5000.0f,
        .reserve = 50.0f,
        .deviations = 1.645f,
        .standing_power = 48.0f};
    available = 5000.0f;
    charging = 20.0f;
    ticks = 0;
    prepare();
    take_map();
}

void tearDown(void)
{
}

static void begin(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_round_init(&round_trip, &config, &pilot, &field));
}

static void tick(void)
{
    struct jp_four_wheel_telemetry before;
    struct jp_four_wheel_telemetry after;

    TEST_ASSERT_TRUE(jp_four_wheel_robot_telemetry(&robot, &before));
    jp_four_wheel_robot_control(&robot, JP_OK, &room.sensors, &room.actuation);
    jp_four_wheel_robot_account(&robot);
    TEST_ASSERT_TRUE(jp_four_wheel_robot_telemetry(&robot, &after));
    if (ticks % SCAN_TICKS == 0U) {
        patrol_room_scan(&room, &jp_patrol_scanner_patrol);
        jp_patrol_pilot_see(&pilot, room.ranges, &after.odometry);
    }
    jp_patrol_pilot_work(&pilot);
    available -= (float)(after.energy - before.energy) * 0x1p-32f;
    if (round_trip.state == JP_ROUND_CHARGING) {
        available = jp_plane_smaller(available + charging, config.full);
    }
    (void)jp_patrol_round_work(&round_trip, available, TICK);
    patrol_room_tick(&room, &jp_four_wheel_robot_patrol);
    ticks++;
}

static void switch_on(void)
{
    tick();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_enable(&robot));
    for (unsigned i = 0; i < 20; i++) {
        tick();
    }
}

static void pass_until(enum jp_patrol_round_state state)
{
    const uint32_t end = ticks + PATIENCE;

    while (ticks < end && round_trip.state != state) {
        tick();
    }
    TEST_ASSERT_EQUAL_INT(state, round_trip.state);
}

static void pass_until_not(enum jp_patrol_round_state state)
{
    const uint32_t end = ticks + PATIENCE;

    while (ticks < end && round_trip.state == state) {
        tick();
    }
}

static float distance_to(const struct jp_plane_pose *place)
{
    return jp_plane_length(room.pose.x - place->x, room.pose.y - place->y);
}

/* A pilot that gives up, as if somebody stood in the way. */
static void give_up(void)
{
    while (!jp_patrol_pilot_is_under_way(&pilot)) {
        tick();
    }
    jp_patrol_pilot_stop(&pilot);
    tick();
}

/* The configuration. */

static void expect_refusal(const char *name)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_patrol_round_init(&round_trip, &config, &pilot, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
    setUp();
}

static void test_the_configuration_is_checked(void)
{
    const float none = config.full - config.full;

    config.stop_count = 0;
    expect_refusal("stop_count");
    config.stop_count = JP_PATROL_STOPS_MAX + 1U;
    expect_refusal("stop_count");
    config.stops[2].pose.x = 40000.0f;
    expect_refusal("stops.pose");
    config.stops[1].dwell = -1.0f;
    expect_refusal("stops.dwell");
    config.stops[1].dwell = 90000.0f;
    expect_refusal("stops.dwell");
    config.charger.heading = 2000.0f;
    expect_refusal("charger");
    config.full = 0.0f;
    expect_refusal("full");
    config.full = 2.0f * FLT_MAX;
    expect_refusal("full");
    config.reserve = -1.0f;
    expect_refusal("reserve");
    config.reserve = none / none;
    expect_refusal("reserve");
    config.deviations = -0.1f;
    expect_refusal("deviations");
    config.deviations = 10.1f;
    expect_refusal("deviations");
    config.standing_power = -1.0f;
    expect_refusal("standing_power");
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_round_init(NULL, &config, &pilot, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_round_init(&round_trip, NULL, &pilot, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_round_init(&round_trip, &config, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_round_init(&round_trip, &config, &pilot, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_round_check(NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_round_check(&config, NULL));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_round_check(&config, &field));
}

/* Rounds. */

static void test_it_goes_round_and_stays_at_each_place(void)
{
    begin();
    switch_on();
    for (uint32_t visit = 0; visit < 4; visit++) {
        const struct jp_patrol_stop *stop = &config.stops[visit % 3U];
        uint32_t arrived;

        pass_until(JP_ROUND_DWELLING);
        arrived = ticks;
        TEST_ASSERT_EQUAL_UINT16(visit % 3U, round_trip.stop);
        TEST_ASSERT_EQUAL_UINT32(visit + 1U, round_trip.visits);
        TEST_ASSERT_TRUE(distance_to(&stop->pose) < 0.15f);
        pass_until(JP_ROUND_LEAVING);
        TEST_ASSERT_TRUE(jp_plane_magnitude((float)(ticks - arrived) * TICK - stop->dwell) < 0.03f);
    }
}

static void test_it_is_home_while_the_energy_lasts_and_goes_on(void)
{
    begin();
    switch_on();
    while (round_trip.charges < 3 && ticks < 3U * PATIENCE && round_trip.state != JP_ROUND_FAILED) {
        tick();
        TEST_ASSERT_TRUE(available > 0.0f);
    }
    TEST_ASSERT_EQUAL_UINT32(3, round_trip.charges);
    TEST_ASSERT_TRUE(distance_to(&home) < 0.15f);
    TEST_ASSERT_TRUE(round_trip.least_left >= config.reserve);
    TEST_ASSERT_TRUE(round_trip.visits >= JP_ROUND_JOURNEYS);
    /* It does not come home for nothing either. */
    TEST_ASSERT_TRUE(round_trip.least_left < 1000.0f);
}

/** Joules with which it would just not leave for home from its place, but for who stands in the way. */
static float needed_alone(void)
{
    const struct jp_patrol_leg_forecast *way = &round_trip.internal.home[round_trip.stop];

    return config.reserve + way->energy + config.deviations * way->deviation;
}

static void test_before_it_knows_its_journeys_it_expects_to_wait_on_its_way_home(void)
{
    config.stops[0].dwell = 60.0f;
    config.full = 10000.0f;
    available = config.full;
    begin();
    switch_on();
    pass_until(JP_ROUND_DWELLING);
    available = needed_alone() + JP_ROUND_WAIT * config.standing_power - 50.0f;
    tick();
    TEST_ASSERT_EQUAL_INT(JP_ROUND_HOMING, round_trip.state);
}

static void test_after_journeys_that_met_nobody_it_stays_longer(void)
{
    config.full = 50000.0f;
    available = config.full;
    begin();
    switch_on();
    while (round_trip.visits <= JP_ROUND_JOURNEYS && ticks < 3U * PATIENCE) {
        tick();
    }
    pass_until(JP_ROUND_LEAVING);
    pass_until(JP_ROUND_DWELLING);
    available = 2.0f * needed_alone();
    TEST_ASSERT_TRUE(2.0f * needed_alone() < needed_alone() + JP_ROUND_WAIT * config.standing_power);
    tick();
    TEST_ASSERT_EQUAL_INT(JP_ROUND_DWELLING, round_trip.state);
}

/** On its first journey, as if it had waited; at a later stop it is to stay for long. */
static void take_long_on_the_way_out(uint16_t stay)
{
    config.full = 50000.0f;
    config.stops[stay].dwell = 60.0f;
    available = config.full;
    begin();
    switch_on();
    pass_until(JP_ROUND_LEAVING);
    for (unsigned i = 0; i < 200; i++) {
        tick();
    }
    available -= 5000.0f;
}

static void test_what_one_journey_took_for_who_stood_in_its_way_is_kept_for_the_way_home(void)
{
    take_long_on_the_way_out(0);
    pass_until(JP_ROUND_DWELLING);
    available = needed_alone() + 4500.0f;
    tick();
    TEST_ASSERT_EQUAL_INT(JP_ROUND_HOMING, round_trip.state);
}

static void test_a_journey_that_is_given_up_counts_too(void)
{
    take_long_on_the_way_out(1);
    give_up();
    TEST_ASSERT_EQUAL_INT(JP_ROUND_LEAVING, round_trip.state);
    pass_until(JP_ROUND_DWELLING);
    available = needed_alone() + 4000.0f;
    tick();
    TEST_ASSERT_EQUAL_INT(JP_ROUND_HOMING, round_trip.state);
}

static void test_the_energy_runs_out_faster_than_foretold(void)
{
    begin();
    switch_on();
    pass_until(JP_ROUND_LEAVING);
    for (unsigned i = 0; i < 200; i++) {
        tick();
    }
    available = round_trip.internal.home[0].energy + 60.0f;
    pass_until_not(JP_ROUND_LEAVING);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_HOMING, round_trip.state);
    TEST_ASSERT_EQUAL_UINT16(3, round_trip.stop);
    pass_until(JP_ROUND_CHARGING);
    TEST_ASSERT_TRUE(distance_to(&home) < 0.15f);
    TEST_ASSERT_EQUAL_UINT32(0, round_trip.visits);
}

static void test_a_full_battery_that_does_not_suffice_is_told(void)
{
    config.full = 200.0f;
    available = 150.0f;
    begin();
    switch_on();
    pass_until(JP_ROUND_FAILED);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_NO_ENERGY, round_trip.reason);
    TEST_ASSERT_EQUAL_UINT16(0, round_trip.stop);
    TEST_ASSERT_TRUE(distance_to(&home) < 0.01f);
}

static void test_a_place_where_it_cannot_stand_is_told(void)
{
    config.stops[1].pose.x = 0.2f;
    begin();
    switch_on();
    pass_until(JP_ROUND_FAILED);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_NO_WAY, round_trip.reason);
    TEST_ASSERT_EQUAL_UINT16(1, round_trip.stop);
    tick();
    TEST_ASSERT_EQUAL_INT(JP_ROUND_FAILED, round_trip.state);
}

static void test_a_place_that_no_way_leads_to_is_told(void)
{
    for (int32_t y = 0; y < ROOM_HEIGHT; y++) {
        (void)jp_terrain_set_cell(&map, ROOM_WIDTH / 2, y, JP_CELL_OCCUPIED);
    }
    take_map();
    begin();
    switch_on();
    pass_until(JP_ROUND_FAILED);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_NO_WAY, round_trip.reason);
    TEST_ASSERT_EQUAL_UINT16(0, round_trip.stop);
}

static void test_without_drives_it_does_not_leave(void)
{
    begin();
    for (unsigned i = 0; i < 2000; i++) {
        tick();
    }
    TEST_ASSERT_EQUAL_INT(JP_ROUND_FAILED, round_trip.state);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_DRIVES_OFF, round_trip.reason);
}

static void test_switched_off_under_way_it_gives_up(void)
{
    begin();
    switch_on();
    pass_until(JP_ROUND_LEAVING);
    for (unsigned i = 0; i < 200; i++) {
        tick();
    }
    jp_four_wheel_robot_disable(&robot);
    pass_until_not(JP_ROUND_LEAVING);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_FAILED, round_trip.state);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_DRIVES_OFF, round_trip.reason);
}

static void test_a_place_that_cannot_be_reached_now_is_left_out(void)
{
    begin();
    switch_on();
    pass_until(JP_ROUND_LEAVING);
    give_up();
    TEST_ASSERT_EQUAL_INT(JP_ROUND_LEAVING, round_trip.state);
    TEST_ASSERT_EQUAL_UINT16(1, round_trip.stop);
    TEST_ASSERT_EQUAL_UINT32(1, round_trip.skipped);
    pass_until(JP_ROUND_DWELLING);
    TEST_ASSERT_EQUAL_UINT32(1, round_trip.visits);
}

static void test_with_too_little_for_the_next_place_it_goes_home_instead(void)
{
    begin();
    switch_on();
    pass_until(JP_ROUND_DWELLING);
    pass_until(JP_ROUND_LEAVING);
    available = 600.0f;
    config.full = 600.0f;
    give_up();
    TEST_ASSERT_EQUAL_INT(JP_ROUND_HOMING, round_trip.state);
    give_up(); /* tried again */
    TEST_ASSERT_EQUAL_INT(JP_ROUND_HOMING, round_trip.state);
    pass_until(JP_ROUND_CHARGING);
}

static void test_with_too_little_after_a_stay_it_goes_home(void)
{
    begin();
    switch_on();
    pass_until(JP_ROUND_DWELLING);
    available = 300.0f;
    config.full = 300.0f;
    pass_until_not(JP_ROUND_DWELLING);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_HOMING, round_trip.state);
    pass_until(JP_ROUND_CHARGING);
}

static void test_a_stay_ends_early_when_the_way_there_took_too_much(void)
{
    config.stops[0].dwell = 60.0f;
    config.full = 10000.0f;
    available = config.full;
    begin();
    switch_on();
    pass_until(JP_ROUND_DWELLING);
    const uint32_t since = ticks;
    const float needed = needed_alone() + JP_ROUND_WAIT * config.standing_power;

    available = needed + 100.0f; /* which standing takes within seconds */
    pass_until_not(JP_ROUND_DWELLING);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_HOMING, round_trip.state);
    TEST_ASSERT_TRUE(ticks - since < 1500U);
    TEST_ASSERT_TRUE(available > 0.6f * needed);
    pass_until(JP_ROUND_SURVEYING);
    TEST_ASSERT_TRUE(round_trip.least_left >= config.reserve);
}

static void test_where_it_gets_nowhere_it_waits_and_tries_to_get_home(void)
{
    begin();
    switch_on();
    pass_until(JP_ROUND_DWELLING);
    pass_until(JP_ROUND_LEAVING);
    for (unsigned i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_INT(JP_ROUND_LEAVING, round_trip.state);
        give_up();
    }
    for (unsigned i = 0; i < 2; i++) {
        const uint32_t since = ticks;

        TEST_ASSERT_EQUAL_INT(JP_ROUND_WAITING, round_trip.state);
        TEST_ASSERT_EQUAL_INT(JP_ROUND_NO_WAY, round_trip.reason);
        pass_until_not(JP_ROUND_WAITING);
        TEST_ASSERT_TRUE(ticks - since > (uint32_t)(JP_ROUND_WAIT / TICK) - 10U);
        TEST_ASSERT_EQUAL_INT(JP_ROUND_HOMING, round_trip.state);
        give_up();
    }
    pass_until(JP_ROUND_HOMING);
    pass_until(JP_ROUND_CHARGING);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_NO_REASON, round_trip.reason);
    pass_until(JP_ROUND_DWELLING);
}

/* As if somebody stood before it. */
static void wait_at_the_charger(void)
{
    begin();
    switch_on();
    pass_until(JP_ROUND_LEAVING);
    for (unsigned i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_INT(JP_ROUND_LEAVING, round_trip.state);
        jp_patrol_pilot_stop(&pilot);
        tick();
    }
    TEST_ASSERT_EQUAL_INT(JP_ROUND_WAITING, round_trip.state);
    pass_until_not(JP_ROUND_WAITING);
}

static void expect_to_go_there_first(void)
{
    round_trip.state = JP_ROUND_FAILED; /* of before */
    switch_on();
    begin();
    TEST_ASSERT_EQUAL_INT(JP_ROUND_WAITING, round_trip.state);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_NO_REASON, round_trip.reason);
    pass_until(JP_ROUND_HOMING);
    TEST_ASSERT_TRUE(ticks < 100U);
    pass_until(JP_ROUND_CHARGING);
    TEST_ASSERT_TRUE(distance_to(&config.charger) < 0.15f);
    TEST_ASSERT_TRUE(jp_plane_magnitude(jp_plane_wrap(room.pose.heading - config.charger.heading)) < 0.1f);
    TEST_ASSERT_EQUAL_UINT32(1, round_trip.charges);
    pass_until(JP_ROUND_DWELLING);
    TEST_ASSERT_EQUAL_UINT16(0, round_trip.stop);
}

static void test_who_is_turned_away_from_the_charger_goes_to_it_first(void)
{
    config.charger.heading = 1.0f;
    expect_to_go_there_first();
}

static void test_who_is_not_at_the_charger_goes_to_it_first(void)
{
    config.charger.x = 2.0f;
    expect_to_go_there_first();
}

static void test_who_could_not_leave_the_charger_is_charged(void)
{
    wait_at_the_charger();
    TEST_ASSERT_EQUAL_INT(JP_ROUND_SURVEYING, round_trip.state);
    TEST_ASSERT_EQUAL_UINT32(0, round_trip.charges);
    pass_until(JP_ROUND_CHARGING);
    pass_until(JP_ROUND_DWELLING);
    TEST_ASSERT_EQUAL_INT(JP_ROUND_NO_REASON, round_trip.reason);
}

static void test_what_stood_in_the_way_is_forgotten_at_the_charger(void)
{
    struct jp_terrain *const marked = &pilot.mission.internal.marked;

    begin();
    switch_on();
    pass_until(JP_ROUND_HOMING);
    for (int32_t y = 0; y < ROOM_HEIGHT; y++) { /* as if people had stood across the room */
        (void)jp_terrain_set_cell(marked, 40, y, JP_CELL_OCCUPIED);
    }
    pass_until(JP_ROUND_SURVEYING);
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, jp_terrain_cell(marked, 40, ROOM_HEIGHT / 2));
    pass_until(JP_ROUND_CHARGING);
    TEST_ASSERT_EQUAL_UINT32(1, round_trip.charges);
}

static void test_what_is_surveyed_is_by_what_the_way_home_has_taught(void)
{
    begin();
    switch_on();
    pass_until(JP_ROUND_HOMING);
    const uint32_t learned_from = pilot.ledger.learned_from;

    pass_until(JP_ROUND_CHARGING);
    TEST_ASSERT_EQUAL_UINT32(learned_from + 1U, pilot.ledger.learned_from);
    TEST_ASSERT_TRUE(round_trip.internal.pace == pilot.ledger.robot * jp_patrol_pace_factor(&pilot.ledger.pace, 1.0f));
}

static void test_marks_are_forgotten_by_who_has_a_map_and_does_not_plan(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_forget_marks(NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_mission_forget_marks(NULL));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_forget_marks(&pilot));
    switch_on();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_go(&pilot, &config.stops[0].pose));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_patrol_pilot_forget_marks(&pilot));
    jp_patrol_pilot_stop(&pilot);
    jp_patrol_pilot_forget_map(&pilot);
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_patrol_pilot_forget_marks(&pilot));
}

/* Surveys of the pilot. */

static void test_surveys_are_judged(void)
{
    const struct jp_plane_pose there = {4.5f, 1.0f, 0.0f};
    const struct jp_plane_pose wrong = {0.0f, 0.0f, 2000.0f};
    const struct jp_plane_pose wall = {0.1f, 0.1f, 0.0f};
    struct jp_patrol_leg_forecast forecast = {.energy = -1.0f};

    begin();
    switch_on();
    pass_until(JP_ROUND_LEAVING);
    round_trip.state = JP_ROUND_FAILED;
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_patrol_pilot_survey(&pilot, &home, &there));
    jp_patrol_pilot_stop(&pilot);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_survey(NULL, &home, &there));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_survey(&pilot, NULL, &there));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_survey(&pilot, &home, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_survey(&pilot, &wrong, &there));
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, jp_patrol_pilot_survey(&pilot, &home, &wall));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_survey(&pilot, &home, &there));
    TEST_ASSERT_EQUAL_INT(JP_WORKING, jp_patrol_pilot_surveyed(&pilot, &forecast));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_go(&pilot, &there)); /* in its place */
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_patrol_pilot_surveyed(&pilot, &forecast));
    TEST_ASSERT_TRUE(forecast.energy < 0.0f);
    jp_patrol_pilot_forget_map(&pilot);
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_patrol_pilot_survey(&pilot, &home, &there));
}
