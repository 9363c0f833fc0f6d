/* Routes and goals: whole ones, every way of being not whole, the driven route beside the next one. */
#include "hal/can/route_link.h"

#include "tests/support/commands.h"

#include "unity.h"

static struct jp_route_link link;
static uint8_t offers;
static uint8_t goals;

static const struct jp_point points[3] = {{19661, -6554}, {-(1 << 25), (1 << 25) - 1}, {65536, 131072}};

void setUp(void)
{
    jp_route_link_start(&link, 1000U);
    offers = 0;
    goals = 0;
}

void tearDown(void)
{
}

static void expect(enum jp_route_state state, enum jp_route_reason reason)
{
    TEST_ASSERT_EQUAL_INT(state, link.state);
    TEST_ASSERT_EQUAL_INT(reason, link.reason);
}

static void offer(uint8_t route, uint8_t length, uint32_t crc)
{
    const struct jp_can_frame frame = route_offer(++offers & 15U, route, length, crc);
    const enum jp_e2e_result result = jp_route_link_accept_offer(&link, &frame);

    TEST_ASSERT_TRUE(result == JP_E2E_OK || result == JP_E2E_FIRST);
}

static void offer_points(uint8_t route)
{
    offer(route, 3, route_crc(points, 3));
    expect(JP_ROUTE_RECEIVING, JP_REASON_NONE);
}

static enum jp_e2e_result give(uint8_t counter, struct jp_point point)
{
    const struct jp_can_frame frame = waypoint(counter, point);

    return jp_route_link_accept_waypoint(&link, &frame);
}

static void give_points(void)
{
    for (uint8_t i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(i + 1U, points[i]));
        TEST_ASSERT_EQUAL_UINT8(i + 1U, link.received);
    }
}

static enum jp_e2e_result give_goal(struct jp_point point)
{
    const struct jp_can_frame frame = goal(++goals & 15U, point);

    return jp_route_link_accept_goal(&link, &frame);
}

static void make_driving(uint8_t route)
{
    offer_points(route);
    give_points();
    TEST_ASSERT_NOT_NULL(jp_route_link_take(&link, route));
    expect(JP_ROUTE_DRIVING, JP_REASON_NONE);
}

static void expect_points(const struct jp_route_message *route, uint8_t id)
{
    TEST_ASSERT_NOT_NULL(route);
    TEST_ASSERT_EQUAL_UINT8(id, route->id);
    TEST_ASSERT_EQUAL_UINT8(3, route->length);
    TEST_ASSERT_EQUAL_MEMORY(points, route->points, sizeof points);
}

/* Frames that cantools packed; those of commands.h are held against them. */
static void test_frames_of_cantools_are_understood(void)
{
    static const uint8_t offered[8] = {0xFD, 0x01, 0x07, 0x03, 0x78, 0xF8, 0x09, 0x7A};
    static const uint8_t waypoints[3][8] = {
        {0x49, 0xD1, 0xCC, 0x04, 0x80, 0x99, 0xF9, 0xFF},
        {0xF5, 0x02, 0x00, 0x00, 0xE0, 0xFF, 0xFF, 0x7F},
        {0x16, 0x03, 0x00, 0x10, 0x00, 0x00, 0x80, 0x00},
    };
    static const uint8_t goal_1[8] = {0xD6, 0x01, 0x00, 0x10, 0x00, 0x00, 0xE0, 0xFF};

    TEST_ASSERT_EQUAL_HEX8_ARRAY(offered, route_offer(1, 7, 3, route_crc(points, 3)).data, 8);
    TEST_ASSERT_EQUAL_HEX32(0x101, route_offer(1, 7, 3, 0).id);
    for (uint8_t i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_HEX8_ARRAY(waypoints[i], waypoint(i + 1U, points[i]).data, 8);
        TEST_ASSERT_EQUAL_HEX32(0x102, waypoint(1, points[i]).id);
    }
    TEST_ASSERT_EQUAL_HEX8_ARRAY(goal_1, goal(1, (struct jp_point){65536, -32768}).data, 8);
    TEST_ASSERT_EQUAL_HEX32(0x103, goal(1, points[0]).id);
}

/* Whole */

static void test_a_whole_route_is_ready_and_driven_once(void)
{
    expect(JP_ROUTE_NONE, JP_REASON_NONE);
    TEST_ASSERT_NULL(jp_route_link_take(&link, 7));
    offer_points(7);
    TEST_ASSERT_NULL(jp_route_link_take(&link, 7));
    give_points();
    expect(JP_ROUTE_READY, JP_REASON_NONE);
    TEST_ASSERT_NULL(jp_route_link_take(&link, 8));
    expect_points(jp_route_link_take(&link, 7), 7);
    expect(JP_ROUTE_DRIVING, JP_REASON_NONE);
    TEST_ASSERT_NULL(jp_route_link_take(&link, 7));
    jp_route_link_end(&link, JP_ROUTE_DONE, JP_REASON_NONE);
    expect(JP_ROUTE_DONE, JP_REASON_NONE);
    TEST_ASSERT_NULL(jp_route_link_take(&link, 7));
}

static void test_routes_have_1_to_32_waypoints(void)
{
    for (uint8_t length = 1; length <= JP_ROUTE_LENGTH_MAX; length++) {
        uint32_t crc = JP_ROUTE_CRC_START;

        setUp();
        for (uint8_t i = 0; i < length; i++) {
            crc = jp_route_crc(crc, &(struct jp_point){i, -i});
        }
        offer(length, length, crc);
        for (uint8_t i = 0; i < length; i++) {
            expect(JP_ROUTE_RECEIVING, JP_REASON_NONE);
            TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give((i + 5U) & 15U, (struct jp_point){i, -i}));
        }
        expect(JP_ROUTE_READY, JP_REASON_NONE);
        TEST_ASSERT_EQUAL_INT32(1 - length, jp_route_link_take(&link, length)->points[length - 1U].y);
    }
    TEST_ASSERT_EQUAL_UINT(32, JP_ROUTE_LENGTH_MAX);
}

static void test_offers_of_other_lengths_and_of_id_0_are_rejected(void)
{
    static const struct {
        uint8_t id;
        uint8_t length;
    } bad[] = {{1, 0}, {1, 33}, {1, 255}, {0, 1}, {0, 0}};

    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        setUp();
        offer(bad[i].id, bad[i].length, route_crc(points, 1));
        expect(JP_ROUTE_REJECTED, JP_REASON_LENGTH);
        for (uint8_t k = 0; k < 40; k++) {
            (void)give(k & 15U, points[0]);
        }
        expect(JP_ROUTE_REJECTED, JP_REASON_LENGTH);
        TEST_ASSERT_EQUAL_UINT8(0, link.received);
        TEST_ASSERT_NULL(jp_route_link_take(&link, bad[i].id));
    }
}

/* Not whole */

static void test_a_lost_waypoint_rejects_the_route(void)
{
    offer_points(7);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(1, points[0]));
    TEST_ASSERT_EQUAL_INT(JP_E2E_SEQUENCE, give(3, points[2]));
    expect(JP_ROUTE_REJECTED, JP_REASON_SEQUENCE);
    TEST_ASSERT_NULL(jp_route_link_take(&link, 7));

    setUp(); /* after two that follow each other, too */
    offer_points(7);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(1, points[0]));
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(2, points[1]));
    TEST_ASSERT_EQUAL_INT(JP_E2E_SEQUENCE, give(4, points[2]));
    expect(JP_ROUTE_REJECTED, JP_REASON_SEQUENCE);
}

static void test_without_its_first_waypoint_a_route_is_never_ready(void)
{
    offer_points(7);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(2, points[1]));
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(3, points[2]));
    expect(JP_ROUTE_RECEIVING, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(4, points[0])); /* all are there, in another order */
    expect(JP_ROUTE_REJECTED, JP_REASON_ROUTE_CRC);
}

static void test_a_repeated_waypoint_is_ignored(void)
{
    offer_points(7);
    for (uint8_t i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(i + 1U, points[i]));
        TEST_ASSERT_EQUAL_INT(JP_E2E_REPEATED, give(i + 1U, points[i]));
        TEST_ASSERT_EQUAL_UINT8(i + 1U, link.received);
    }
    expect(JP_ROUTE_READY, JP_REASON_NONE);
}

static void test_swapped_waypoints_reject_the_route(void)
{
    offer_points(7);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(1, points[0]));
    TEST_ASSERT_EQUAL_INT(JP_E2E_SEQUENCE, give(3, points[2]));
    TEST_ASSERT_NOT_EQUAL(JP_ROUTE_READY, link.state);
    (void)give(2, points[1]);
    expect(JP_ROUTE_REJECTED, JP_REASON_SEQUENCE);
}

static void test_a_corrupt_waypoint_does_not_count(void)
{
    struct jp_can_frame frame = waypoint(1, points[0]);

    offer_points(7);
    frame.data[4] ^= 2U;
    TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_route_link_accept_waypoint(&link, &frame));
    expect(JP_ROUTE_RECEIVING, JP_REASON_NONE);
    give_points();
    expect(JP_ROUTE_READY, JP_REASON_NONE);
}

static void test_a_wrong_crc_of_the_whole_rejects_the_route(void)
{
    for (unsigned bit = 0; bit < 32; bit++) {
        setUp();
        offer(7, 3, route_crc(points, 3) ^ (1U << bit));
        give_points();
        expect(JP_ROUTE_REJECTED, JP_REASON_ROUTE_CRC);
        TEST_ASSERT_NULL(jp_route_link_take(&link, 7));
    }
}

static void test_another_waypoint_in_the_same_place_rejects_the_route(void)
{
    offer_points(7);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(1, points[0]));
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(2, (struct jp_point){points[1].x + 1, points[1].y}));
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(3, points[2]));
    expect(JP_ROUTE_REJECTED, JP_REASON_ROUTE_CRC);
}

static void test_waypoints_without_an_offer_and_beyond_its_length_do_nothing(void)
{
    for (uint8_t i = 0; i < 3; i++) {
        (void)give(i + 1U, points[i]);
    }
    expect(JP_ROUTE_NONE, JP_REASON_NONE);
    offer_points(7);
    give_points();
    for (uint8_t i = 4; i < 40; i++) {
        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(i & 15U, points[0]));
    }
    expect(JP_ROUTE_READY, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_UINT8(3, link.received);
    expect_points(jp_route_link_take(&link, 7), 7);
}

/* Offers */

static void test_a_rejected_route_can_be_offered_again(void)
{
    offer_points(7);
    (void)give(1, points[0]);
    (void)give(3, points[2]);
    expect(JP_ROUTE_REJECTED, JP_REASON_SEQUENCE);
    offer_points(7);
    TEST_ASSERT_EQUAL_UINT8(0, link.received);
    for (uint8_t i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(i + 4U, points[i]));
    }
    expect(JP_ROUTE_READY, JP_REASON_NONE);
}

static void test_an_offer_replaces_an_earlier_one(void)
{
    offer_points(7);
    (void)give(1, points[0]);
    offer_points(8);
    TEST_ASSERT_EQUAL_UINT8(0, link.received);
    give_points();
    TEST_ASSERT_NULL(jp_route_link_take(&link, 7));
    expect_points(jp_route_link_take(&link, 8), 8);
}

static void test_offers_need_not_follow_each_other(void)
{
    offers = 3;
    offer_points(7);
    offers = 14;
    offer_points(8);
    offers = 9;
    offer_points(9);
    give_points();
    expect_points(jp_route_link_take(&link, 9), 9);
}

/* The first offer of another sender may have the counter of the last one. */
static void test_another_offer_with_the_same_counter_counts(void)
{
    struct jp_can_frame frame = route_offer(1, 8, 3, route_crc(points, 3));

    offer_points(7);
    give_points();
    TEST_ASSERT_NOT_EQUAL(JP_E2E_CRC, jp_route_link_accept_offer(&link, &frame));
    expect(JP_ROUTE_RECEIVING, JP_REASON_NONE);
    give_points();
    expect_points(jp_route_link_take(&link, 8), 8);
}

static void check_offer_timeout(uint32_t tick_rate)
{
    jp_route_link_start(&link, tick_rate);
    offer_points(7);
    for (uint8_t i = 0; i < 2; i++) {
        jp_route_link_pass(&link, tick_rate - 1U);
        expect(JP_ROUTE_RECEIVING, JP_REASON_NONE);
        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(i + 1U, points[i]));
    }
    jp_route_link_pass(&link, tick_rate - 1U);
    expect(JP_ROUTE_RECEIVING, JP_REASON_NONE);
    jp_route_link_pass(&link, 1);
    expect(JP_ROUTE_REJECTED, JP_REASON_TIMEOUT);
    (void)give(3, points[2]);
    expect(JP_ROUTE_REJECTED, JP_REASON_TIMEOUT);
}

static void test_a_second_of_silence_rejects_the_route(void)
{
    check_offer_timeout(1000);
    check_offer_timeout(100);
    check_offer_timeout(10000);
}

static void test_time_does_not_change_a_route_that_is_whole(void)
{
    offer_points(7);
    give_points();
    jp_route_link_pass(&link, 5000);
    expect(JP_ROUTE_READY, JP_REASON_NONE);
    (void)jp_route_link_take(&link, 7);
    jp_route_link_pass(&link, 5000);
    expect(JP_ROUTE_DRIVING, JP_REASON_NONE);
    offer_points(8);
    jp_route_link_pass(&link, 999); /* counts from the offer on */
    expect(JP_ROUTE_RECEIVING, JP_REASON_NONE);
}

static void test_repeated_and_corrupt_offers_do_nothing(void)
{
    struct jp_can_frame frame = route_offer(1, 7, 3, route_crc(points, 3));

    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, jp_route_link_accept_offer(&link, &frame));
    give_points();
    TEST_ASSERT_EQUAL_INT(JP_E2E_REPEATED, jp_route_link_accept_offer(&link, &frame));
    expect(JP_ROUTE_READY, JP_REASON_NONE);
    frame = route_offer(2, 7, 3, 0);
    frame.data[2] ^= 1U;
    TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_route_link_accept_offer(&link, &frame));
    expect(JP_ROUTE_READY, JP_REASON_NONE);
}

static void test_an_offer_leaves_the_driven_route_alone(void)
{
    static const struct jp_point other = {1, 2};

    make_driving(7);
    offer(8, 1, route_crc(&other, 1));
    expect(JP_ROUTE_RECEIVING, JP_REASON_NONE);
    expect_points(&link.driven, 7);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(1, other));
    expect(JP_ROUTE_READY, JP_REASON_NONE);
    expect_points(&link.driven, 7);
    TEST_ASSERT_EQUAL_INT32(2, jp_route_link_take(&link, 8)->points[0].y);
    TEST_ASSERT_EQUAL_UINT8(8, link.driven.id);
}

static void test_the_end_of_a_route_counts_only_while_it_is_driven(void)
{
    offer_points(7);
    jp_route_link_end(&link, JP_ROUTE_DONE, JP_REASON_NONE);
    expect(JP_ROUTE_RECEIVING, JP_REASON_NONE);
    give_points();
    jp_route_link_end(&link, JP_ROUTE_STOPPED, JP_REASON_COMMAND);
    expect(JP_ROUTE_READY, JP_REASON_NONE);
    TEST_ASSERT_NOT_NULL(jp_route_link_take(&link, 7));
    jp_route_link_end(&link, JP_ROUTE_STOPPED, JP_REASON_TIMEOUT);
    expect(JP_ROUTE_STOPPED, JP_REASON_TIMEOUT);
    jp_route_link_end(&link, JP_ROUTE_DONE, JP_REASON_NONE);
    expect(JP_ROUTE_STOPPED, JP_REASON_TIMEOUT);
}

/* Goals */

static const struct jp_point here = {65536, -32768};
static const struct jp_point there = {-65536, 0};

static void test_a_goal_is_a_route_of_one_waypoint(void)
{
    const struct jp_route_message *route;

    TEST_ASSERT_EQUAL_INT(JP_E2E_FIRST, give_goal(here));
    expect(JP_ROUTE_NONE, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_goal(here));
    expect(JP_ROUTE_READY, JP_REASON_NONE);
    route = jp_route_link_take(&link, JP_ROUTE_GOAL);
    TEST_ASSERT_NOT_NULL(route);
    TEST_ASSERT_EQUAL_UINT8(1, route->length);
    TEST_ASSERT_EQUAL_INT32(here.x, route->points[0].x);
    TEST_ASSERT_EQUAL_INT32(here.y, route->points[0].y);
}

static void drive_to_goal(struct jp_point point)
{
    (void)give_goal(point);
    (void)give_goal(point);
    TEST_ASSERT_NOT_NULL(jp_route_link_take(&link, JP_ROUTE_GOAL));
}

static void test_a_goal_sent_again_is_driven_to_once(void)
{
    drive_to_goal(here);
    for (int i = 0; i < 20; i++) {
        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_goal(here));
        expect(JP_ROUTE_DRIVING, JP_REASON_NONE);
    }
    jp_route_link_end(&link, JP_ROUTE_DONE, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_goal(here));
    expect(JP_ROUTE_DONE, JP_REASON_NONE);
}

static void test_another_goal_is_ready_while_the_first_is_driven_to(void)
{
    drive_to_goal(here);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_goal(there));
    expect(JP_ROUTE_READY, JP_REASON_NONE);
    TEST_ASSERT_EQUAL_INT32(here.x, link.driven.points[0].x);
    TEST_ASSERT_EQUAL_INT32(there.x, jp_route_link_take(&link, JP_ROUTE_GOAL)->points[0].x);

    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_goal((struct jp_point){there.x, there.y + 1}));
    expect(JP_ROUTE_READY, JP_REASON_NONE);
}

static void test_a_goal_that_was_reached_and_forgotten_is_ready_again(void)
{
    drive_to_goal(here);
    jp_route_link_forget_goal(&link);
    expect(JP_ROUTE_DRIVING, JP_REASON_NONE);
    jp_route_link_end(&link, JP_ROUTE_DONE, JP_REASON_NONE);
    jp_route_link_forget_goal(&link);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_goal(here));
    expect(JP_ROUTE_READY, JP_REASON_NONE);
}

static void test_a_goal_after_a_stop_is_ready_again(void)
{
    drive_to_goal(here);
    jp_route_link_end(&link, JP_ROUTE_STOPPED, JP_REASON_COMMAND);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_goal(here));
    expect(JP_ROUTE_READY, JP_REASON_NONE);
    TEST_ASSERT_NOT_NULL(jp_route_link_take(&link, JP_ROUTE_GOAL));
}

static void test_a_goal_at_the_waypoint_of_a_route_is_another_task(void)
{
    static const struct jp_point only[1] = {{65536, -32768}};

    offer(7, 1, route_crc(only, 1));
    (void)give(1, only[0]);
    TEST_ASSERT_NOT_NULL(jp_route_link_take(&link, 7));
    (void)give_goal(here);
    (void)give_goal(here);
    expect(JP_ROUTE_READY, JP_REASON_NONE);
}

static void test_corrupt_repeated_and_late_goals_do_nothing(void)
{
    struct jp_can_frame frame;

    drive_to_goal(here);
    frame = goal(goals & 15U, there);
    TEST_ASSERT_EQUAL_INT(JP_E2E_REPEATED, jp_route_link_accept_goal(&link, &frame));
    frame = goal((goals + 12U) & 15U, there);
    TEST_ASSERT_EQUAL_INT(JP_E2E_SEQUENCE, jp_route_link_accept_goal(&link, &frame));
    frame = goal((goals + 1U) & 15U, there);
    frame.data[0] ^= 0x80U;
    TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_route_link_accept_goal(&link, &frame));
    expect(JP_ROUTE_DRIVING, JP_REASON_NONE);
}
