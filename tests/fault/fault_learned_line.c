/* What jp-ecu says when a learner has noticed a change: of each kind of robot, by its cause. */
#include <joulepath/tables.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "sim/balancer/rig.h"
#include "sim/bus/can_bus.h"
#include "sim/bus/learned_line.h"
#include "unity.h"

static struct ecu_node node;
static struct can_bus bus;
static struct jp_can_link bus_link;
static struct learned_line last;

void setUp(void)
{
    /* What no robot of the other kind has written must not be read. */
    memset(&node, 0xA5, sizeof node);
    last = (struct learned_line){0};
    can_bus_init(&bus);
    bus_link = can_bus_link(can_bus_attach(&bus));
}

void tearDown(void)
{
}

static char said[512];

/** What is told of the node now. */
static void listen(void)
{
    FILE *file = tmpfile();

    TEST_ASSERT_NOT_NULL(file);
    (void)fflush(stdout);

    const int before = dup(STDOUT_FILENO);

    (void)dup2(fileno(file), STDOUT_FILENO);
    learned_line_print(&last, &node);
    (void)fflush(stdout);
    (void)dup2(before, STDOUT_FILENO);
    (void)close(before);
    rewind(file);
    said[fread(said, 1, sizeof said - 1, file)] = '\0';
    (void)fclose(file);
}

static void expect_said(const char *text)
{
    listen();
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, text), said);
    listen();
    TEST_ASSERT_EQUAL_STRING("", said); /* once */
}

static void test_a_robot_that_its_sides_steer_tells_that_something_changed(void)
{
    static const char *const names[] = {"burger", "zhang2018"};

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        setUp();
        TEST_ASSERT_TRUE(ecu_node_init_skid(&node, skid_robot_find(names[i]), &bus_link.port, NULL, NULL));
        listen();
        TEST_ASSERT_EQUAL_STRING("", said);
        node.skid.robot.pilot.learner.changes = 1;
        expect_said("surface or robot changed, learning anew\n");
    }
}

static void test_a_balancer_tells_what_changed(void)
{
    static const struct {
        enum jp_cause cause;
        const char *text;
    } cases[] = {{JP_CAUSE_NONE, "surface or robot changed, learning anew\n"},
                 {JP_CAUSE_GROUND, "surface changed, friction 1.00 ± "},
                 {JP_CAUSE_PAYLOAD, "payload changed, +0.00 ± "},
                 {JP_CAUSE_OTHER, "robot changed, neither surface nor payload\n"}};
    const struct robot_entry *entry = rig_find_robot("courier24");
    struct jp_learner *learner = &node.balancer.robot.pilot.learner;

    TEST_ASSERT_TRUE(ecu_node_init(&node, entry, entry->energy, &bus_link.port, NULL, NULL));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        learner->changes++;
        learner->cause = cases[i].cause;
        expect_said(cases[i].text);
    }
}
