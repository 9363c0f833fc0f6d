/*
 * The operator against the firmware's application on a bus where its frames, and those that it hears, are lost,
 * repeated, delayed, swapped or flipped at random: it drives the routes that it was given or says that it failed, and
 * the robot never drives another one.
 *
 * prop_operator [--count N] [--seed S]
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/app/operator.h"
#include "sim/balancer/rig.h"
#include "sim/balancer/robot_file.h"
#include "sim/bus/can_bus.h"
#include "sim/bus/plant_node.h"
#include "tests/support/can_fault.h"
#include "tests/support/ecu_start.h"
#include "tests/support/options.h"
#include "unity.h"

#define ROBOT      "gao2018"
#define ROUTES_MAX 3
#define TICKS_MAX  120000u /* of 1 ms */
#define NEAR_M     0.5 /* the robot stands so near to the last point; sharp turns of short segments cost up to 0.35 */
#define SHARE_MAX  0.3
#define FAULTS_MAX 3
#define FOR_EVER   UINT64_MAX

struct given {
    struct jp_point points[JP_ROUTE_LENGTH_MAX];
    size_t count;
    uint64_t tick; /**< when it is given */
};

/** The bus with all that is on it. */
struct stage {
    struct can_bus bus;
    struct jp_can_link plant_link;
    struct jp_can_link ecu_link;
    struct can_fault_link faults;
    struct jp_can_link operator_link;
    struct plant_node plant;
    struct jp_ecu ecu;
    struct jp_ecu_balancer balancer;
    struct jp_operator commander;
    struct random random;
    uint64_t tick;
    struct given given[ROUTES_MAX];
    size_t given_count;
    size_t given_now; /**< routes that the operator was given so far */
    size_t driven;    /**< of these the number of the one that the robot drives, from 1; 0: none yet */
};

static struct options options = {.count = 30, .seed = 20180905};
static struct robot_file robot_file;
static struct stage stage;

void setUp(void)
{
}

void tearDown(void)
{
}

static void start(unsigned long long stage_seed)
{
    const struct robot_entry *entry = rig_find_robot(ROBOT);
    struct jp_can_link link;
    const char *field = NULL;

    TEST_ASSERT_NOT_NULL(entry);
    memset(&stage, 0, sizeof stage);
    random_init(&stage.random, stage_seed);
    can_bus_init(&stage.bus);
    stage.plant_link = can_bus_link(can_bus_attach(&stage.bus));
    stage.ecu_link = can_bus_link(can_bus_attach(&stage.bus));
    link = can_bus_link(can_bus_attach(&stage.bus));
    can_fault_link_init(&stage.faults, &link, stage_seed);
    stage.operator_link = can_fault_link(&stage.faults);
    plant_node_init(&stage.plant, &robot_file, stage_seed);
    TEST_ASSERT_EQUAL_INT(JP_OK, ecu_start(&stage.ecu, &stage.balancer, entry->config, entry->energy,
                                           &stage.ecu_link.port, NULL, &field));
}

/** Two or more seconds of driving each, so that a later route often comes while the one before is driven. */
static void give_routes(size_t routes)
{
    uint64_t tick = 0;

    stage.given_count = routes;
    for (size_t r = 0; r < routes; r++) {
        struct given *given = &stage.given[r];

        tick += (uint64_t)random_uniform(&stage.random, 100, 9000);
        given->tick = tick;
        given->count = (size_t)random_uniform(&stage.random, 1, 6);
        for (size_t i = 0; i < given->count; i++) {
            given->points[i] = (struct jp_point){.x = JP_Q16(random_uniform(&stage.random, -1.5, 1.5)),
                                                 .y = JP_Q16(random_uniform(&stage.random, -1.5, 1.5))};
        }
    }
}

static void add_faults(void)
{
    const size_t faults = (size_t)random_uniform(&stage.random, 1, FAULTS_MAX + 1);

    for (size_t i = 0; i < faults; i++) {
        const double share = random_uniform(&stage.random, 0, 1);
        const struct can_fault fault = {.kind =
                                            (enum can_fault_kind)(int)random_uniform(&stage.random, 0, CAN_FAULT_KINDS),
                                        .direction = (enum can_fault_direction)(int)random_uniform(&stage.random, 1, 4),
                                        .share = SHARE_MAX * share * share,
                                        .strength = (uint32_t)random_uniform(&stage.random, 1, 60),
                                        .until = FOR_EVER};

        TEST_ASSERT_TRUE(can_fault_link_add(&stage.faults, &fault));
    }
}

/* A tick. */

static void run_operator(void)
{
    const struct jp_can_link *link = &stage.operator_link;
    struct jp_can_frame frame;

    can_fault_link_set_tick(&stage.faults, stage.tick);
    while (link->receive(link->port.context, &frame)) {
        jp_operator_accept(&stage.commander, &frame);
    }
    if (stage.given_now < stage.given_count && stage.tick == stage.given[stage.given_now].tick) {
        const struct given *given = &stage.given[stage.given_now++];

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_operator_route(&stage.commander, given->points, given->count));
    }
    /* A clock that wraps on the way. */
    jp_operator_tick(&stage.commander, (uint32_t)stage.tick - 5000U, &link->port);
}

static void run_ecu(void)
{
    const struct jp_can_link *link = &stage.ecu_link;
    struct jp_can_frame frame;

    while (link->receive(link->port.context, &frame)) {
        (void)jp_ecu_accept(&stage.ecu, &frame);
    }
    jp_ecu_work(&stage.ecu);
    jp_ecu_tick(&stage.ecu);
}

static void run_plant(void)
{
    const struct jp_can_link *link = &stage.plant_link;
    struct jp_can_frame frame;

    while (link->receive(link->port.context, &frame)) {
        (void)plant_node_accept(&stage.plant, &frame);
    }
    plant_node_step(&stage.plant);
}

static bool is_given(const struct jp_route_message *route, const struct given *given)
{
    return route->length == given->count &&
           memcmp(route->points, given->points, given->count * sizeof given->points[0]) == 0;
}

/** The robot drives nothing but the routes that were given, and never an older one again. */
static void check_driven(void)
{
    const struct jp_robot *robot = &stage.balancer.robot;
    size_t now = 0;

    if (jp_robot_state_now(robot) != JP_ROBOT_DRIVING) {
        return;
    }
    TEST_ASSERT_EQUAL_PTR(stage.ecu.internal.routes.driven.points, stage.balancer.pilot.internal.route.targets);
    for (size_t r = 0; r < stage.given_now; r++) {
        now = is_given(&stage.ecu.internal.routes.driven, &stage.given[r]) ? r + 1 : now;
    }
    TEST_ASSERT_GREATER_THAN_MESSAGE(0, now, "a route that nobody gave");
    TEST_ASSERT_GREATER_OR_EQUAL_MESSAGE(stage.driven, now, "an older route again");
    stage.driven = now;
}

static void run_tick(void)
{
    run_operator();
    plant_node_sense(&stage.plant, &stage.plant_link.port);
    run_ecu();
    run_plant();
    check_driven();
    stage.tick++;
}

static bool is_over(void)
{
    return stage.given_now == stage.given_count &&
           (stage.commander.phase == JP_OPERATOR_DONE || stage.commander.phase == JP_OPERATOR_FAILED);
}

static double distance_to_the_end(void)
{
    const struct given *last = &stage.given[stage.given_count - 1];
    const struct jp_point *end = &last->points[last->count - 1];

    return hypot(stage.plant.world.plant.x - end->x / 65536.0, stage.plant.world.plant.y - end->y / 65536.0);
}

static void check_end(void)
{
    char where[160];

    (void)snprintf(where, sizeof where, "%.3f m from the end, tick %llu, state %d, reason %s", distance_to_the_end(),
                   (unsigned long long)stage.tick, (int)stage.commander.phase,
                   jp_operator_failure_text(stage.commander.failure) ? jp_operator_failure_text(stage.commander.failure)
                                                                     : "-");
    TEST_ASSERT_TRUE_MESSAGE(is_over(), where);
    if (stage.commander.phase == JP_OPERATOR_DONE) {
        TEST_ASSERT_EQUAL_MESSAGE(JP_ROUTE_DONE, stage.ecu.internal.routes.state, where);
        TEST_ASSERT_EQUAL_MESSAGE(stage.given_count, stage.driven, where);
        TEST_ASSERT_TRUE_MESSAGE(distance_to_the_end() < NEAR_M, where);
        TEST_ASSERT_NULL(jp_operator_failure_text(stage.commander.failure));
    } else {
        TEST_ASSERT_NOT_NULL(jp_operator_failure_text(stage.commander.failure));
    }
}

static void run_to_the_end(void)
{
    while (stage.tick < TICKS_MAX && !is_over()) {
        run_tick();
    }
}

static void test_without_faults_every_route_is_driven(void)
{
    for (unsigned i = 0; i < 5; i++) {
        start(options.seed + i);
        give_routes(1 + i % ROUTES_MAX);
        run_to_the_end();
        check_end();
        TEST_ASSERT_EQUAL_INT(JP_OPERATOR_DONE, stage.commander.phase);
        TEST_ASSERT_EQUAL_UINT(0, stage.ecu.operator_counts.crc_errors);
        TEST_ASSERT_EQUAL_UINT(0, stage.ecu.operator_counts.sequence_errors);
    }
}

static void test_with_faults_given_routes_are_driven_or_a_failure_is_told(void)
{
    unsigned long done = 0;

    for (unsigned long i = 0; i < options.count; i++) {
        start(options.seed + 1000 + i);
        give_routes(1 + i % ROUTES_MAX);
        add_faults();
        run_to_the_end();
        check_end();
        done += stage.commander.phase == JP_OPERATOR_DONE;
        /* Whatever became of it, the robot comes to stand and still does not drive anything else. */
        for (unsigned t = 0; t < 3000; t++) {
            run_tick();
        }
    }
    printf("%lu of %lu drives done, the others failed with a reason\n", done, options.count);
    TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(options.count / 2, done, "the faults leave nothing to test");
}

/** The operator falls silent for good at a random moment: nothing moves a second and the braking later. */
static void test_an_operator_that_dies_leaves_the_robot_standing(void)
{
    for (unsigned i = 0; i < 5; i++) {
        const struct can_fault silence = {
            .kind = CAN_FAULT_LOSS, .direction = CAN_FAULT_OUT, .share = 1, .from = 3000 + 1500 * i, .until = FOR_EVER};

        start(options.seed + 2000 + i);
        give_routes(1);
        stage.given[0].tick = 500;
        stage.given[0].points[0].x = JP_Q16(30);
        TEST_ASSERT_TRUE(can_fault_link_add(&stage.faults, &silence));
        while (stage.tick < silence.from + 8000) {
            run_tick();
        }
        TEST_ASSERT_EQUAL_INT(JP_OPERATOR_FAILED, stage.commander.phase);
        TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&stage.balancer.robot));
        TEST_ASSERT_TRUE(fabs(stage.plant.world.plant.state.wheel_rate) < 0.01);
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    if (!robot_file_load("sim/robots/" ROBOT ".cfg", &robot_file)) {
        return 2;
    }
    return RUN_PROPERTY(options, NULL);
}
