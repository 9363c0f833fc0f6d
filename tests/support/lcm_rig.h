/** The gateway between LCM and CAN in a test: memq:// on one side, a bus in memory on the other. */
#ifndef JOULEPATH_TESTS_SUPPORT_LCM_RIG_H
#define JOULEPATH_TESTS_SUPPORT_LCM_RIG_H

#include <jp_energy_t.h>
#include <jp_goal_t.h>
#include <jp_identification_t.h>
#include <jp_navigation_t.h>
#include <jp_plan_t.h>
#include <jp_route_t.h>
#include <jp_state_t.h>
#include <stdlib.h>

#include "sim/base/random.h"
#include "sim/bus/can_bus.h"
#include "sim/lcm/lcm_gateway.h"
#include "unity.h"

#define SEED       20180904u
#define JUNK       5000
#define PACKET_MAX 1024
#define MS         1000u /* in µs */

struct packet {
    uint8_t bytes[PACKET_MAX];
    size_t size;
};

static struct can_bus bus;
static struct jp_can_link robot;
static struct lcm_gateway gateway;
static lcm_t *lcm;
static uint64_t now_us;
static struct random noise;
static struct packet sound_route;
static struct packet sound_goal;

/* What came out. */
static unsigned states, plans, energies, identifications, navigations;
static jp_state_t state;
static jp_energy_t energy;
static jp_plan_t plan;
static jp_identification_t identification;
static jp_navigation_t navigation;

static void take_state(const lcm_recv_buf_t *packet, const char *channel, void *user)
{
    (void)channel;
    (void)user;
    free(state.task_reason);
    TEST_ASSERT_EQUAL_INT(packet->data_size, jp_state_t_decode(packet->data, 0, (int)packet->data_size, &state));
    states++;
}

static void take_energy(const lcm_recv_buf_t *packet, const char *channel, void *user)
{
    (void)channel;
    (void)user;
    TEST_ASSERT_EQUAL_INT(packet->data_size, jp_energy_t_decode(packet->data, 0, (int)packet->data_size, &energy));
    energies++;
}

static void take_plan(const lcm_recv_buf_t *packet, const char *channel, void *user)
{
    (void)channel;
    (void)user;
    free(plan.points);
    free(plan.segments);
    TEST_ASSERT_EQUAL_INT(packet->data_size, jp_plan_t_decode(packet->data, 0, (int)packet->data_size, &plan));
    plans++;
}

static void take_identification(const lcm_recv_buf_t *packet, const char *channel, void *user)
{
    (void)channel;
    (void)user;
    free(identification.residuals);
    TEST_ASSERT_EQUAL_INT(packet->data_size,
                          jp_identification_t_decode(packet->data, 0, (int)packet->data_size, &identification));
    identifications++;
}

static void take_navigation(const lcm_recv_buf_t *packet, const char *channel, void *user)
{
    (void)channel;
    (void)user;
    free(navigation.legs);
    TEST_ASSERT_EQUAL_INT(packet->data_size,
                          jp_navigation_t_decode(packet->data, 0, (int)packet->data_size, &navigation));
    navigations++;
}

static void forget_messages(void)
{
    free(state.task_reason);
    free(plan.points);
    free(plan.segments);
    free(identification.residuals);
    free(navigation.legs);
    state = (jp_state_t){0};
    plan = (jp_plan_t){0};
    energy = (jp_energy_t){0};
    identification = (jp_identification_t){0};
    navigation = (jp_navigation_t){0};
    states = plans = energies = identifications = navigations = 0;
}

void setUp(void)
{
    struct jp_can_link link;

    can_bus_init(&bus);
    robot = can_bus_link(can_bus_attach(&bus));
    link = can_bus_link(can_bus_attach(&bus));
    lcm = lcm_create("memq://");
    TEST_ASSERT_NOT_NULL(lcm);
    TEST_ASSERT_TRUE(lcm_gateway_start(&gateway, &link, lcm));
    (void)lcm_subscribe(lcm, "JP_STATE", take_state, NULL);
    (void)lcm_subscribe(lcm, "JP_ENERGY", take_energy, NULL);
    (void)lcm_subscribe(lcm, "JP_PLAN", take_plan, NULL);
    (void)lcm_subscribe(lcm, "JP_IDENTIFICATION", take_identification, NULL);
    (void)lcm_subscribe(lcm, "JP_NAVIGATION", take_navigation, NULL);
    random_init(&noise, SEED);
    now_us = 5 * MS;
}

void tearDown(void)
{
    forget_messages();
    lcm_gateway_free(&gateway);
    lcm_destroy(lcm);
}

static void make_packets(void)
{
    jp_point_t points[3] = {{10, 20}, {-511.5, 0.25}, {511.5, -0.0625}};
    const jp_route_t route = {.utime = 77, .count = 3, .points = points};
    const jp_goal_t goal = {.utime = 78, .point = {-3.5, 4.75}};

    sound_route.size = (size_t)jp_route_t_encode(sound_route.bytes, 0, PACKET_MAX, &route);
    sound_goal.size = (size_t)jp_goal_t_encode(sound_goal.bytes, 0, PACKET_MAX, &goal);
}

/** Publishes it and lets the gateway take it. Whether the gateway set to work on a task. */
static bool is_taken(const char *channel, const struct packet *packet)
{
    const uint8_t *sent_already = &gateway.operator.commander.command_counter;
    const uint8_t before = *sent_already;

    gateway.operator.commander.phase = JP_OPERATOR_IDLE;
    gateway.operator.commander.commanding = false;
    TEST_ASSERT_EQUAL_INT(0, lcm_publish(lcm, channel, packet->bytes, (unsigned)packet->size));
    now_us += MS;
    lcm_gateway_pass(&gateway, now_us);

    const bool taken = gateway.operator.commander.phase != JP_OPERATOR_IDLE;

    /* A task makes itself heard on the bus at once, and nothing else does. */
    TEST_ASSERT_EQUAL_INT(taken, *sent_already != before);
    return taken;
}

/** Frames that nobody reads shall not fill the robot's queue. */
static void drain(void)
{
    struct jp_can_frame frame;

    while (robot.receive(robot.port.context, &frame)) {
    }
}

#endif
