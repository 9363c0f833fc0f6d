/*
 * The navigator of an ECU over its bus, in closed loop on dense maps on which not everything is that is in the world:
 * map, goal and what the sensor sees arrive in frames; it touches nothing, and arrives if and only if the goal can be
 * reached, or says that its memory is too small; and on a bus that loses, repeats, swaps and corrupts frames, too.
 * Equal drives give equal bits.
 *
 * prop_bus_navigation [--count N] [--seed S]
 */
#include "sim/bus/local_ecu.h"
#include "sim/missions/bus_navigation.h"
#include "tests/support/can_fault.h"
#include "tests/support/navigate_trial.h"
#include "tests/support/options.h"

#define VIEW     25 /* cells */
#define PATIENCE 1800

static struct options options = {.count = 5, .seed = 80001};
static struct navigate_robot courier;
static struct navigate_robot burger;
static const struct navigate_robot *robot = &courier;

static struct local_ecu ecu;
static struct can_fault_link faulty;
static struct bus_navigation navigation;

void setUp(void)
{
    robot = &courier;
}

void tearDown(void)
{
}

static bool start_ecu(struct jp_can_link *link)
{
    return robot->skid != NULL ? local_ecu_start_skid(&ecu, robot->skid, link)
                               : local_ecu_start(&ecu, robot->entry, robot->entry->energy, link);
}

static bool drive(const struct dense_map *dense, uint64_t seed, bool has_faults)
{
    static const struct can_fault faults[] = {{CAN_FAULT_LOSS, CAN_FAULT_BOTH, 0.03, 0, 0, UINT64_MAX},
                                              {CAN_FAULT_REPEAT, CAN_FAULT_BOTH, 0.01, 0, 0, UINT64_MAX},
                                              {CAN_FAULT_FLIP, CAN_FAULT_OUT, 0.01, 3, 0, UINT64_MAX},
                                              {CAN_FAULT_SWAP, CAN_FAULT_BOTH, 0.01, 0, 0, UINT64_MAX}};
    struct dense_map copy = *dense;
    const struct navigation_task task = {.lattice = robot->lattice,
                                         .solid = &dense->world,
                                         .map = &copy.map,
                                         .world = &copy.world,
                                         .start = dense->start,
                                         .goal = dense->goal,
                                         .view_m = VIEW * round(robot->lattice->resolution / 65.536) / 1000,
                                         .patience = PATIENCE,
                                         .seed = seed};
    struct jp_can_link link;

    TEST_ASSERT_TRUE(start_ecu(&link));
    can_fault_link_init(&faulty, &link, seed);
    for (size_t i = 0; i < sizeof faults / sizeof faults[0] && has_faults; i++) {
        TEST_ASSERT_TRUE(can_fault_link_add(&faulty, &faults[i]));
    }
    const struct jp_can_link around = can_fault_link(&faulty);

    const struct bus_navigation_robot balancer = {.balancer = &robot->file};
    const struct bus_navigation_robot rover = {.skid = &robot->model};

    return bus_navigation_run(&navigation, &task, robot->skid != NULL ? &rover : &balancer, &around,
                              BUS_DRIVE_PATIENCE);
}

static bool is_right(bool is_reachable)
{
    const struct navigation_result *result = &navigation.result;
    const bool is_short = result->state == JP_NAVIGATOR_FAILED && result->reason == JP_NAVIGATOR_MEMORY;
    const bool is_as_it_must_be = is_reachable ? result->state == JP_NAVIGATOR_ARRIVED && result->goal_error_m < 0.1
                                               : result->state == JP_NAVIGATOR_UNREACHABLE;

    return !result->is_touched && (is_short || is_as_it_must_be);
}

/** The map of a seed, driven; false: it was not as it must be. */
static bool drives_right(uint64_t seed, bool has_faults, unsigned *arrived)
{
    struct dense_map dense;

    TEST_ASSERT_TRUE(dense_map_make(&dense, robot->lattice, robot->hills_deg, seed));
    const bool is_reachable = navigate_is_reachable(robot, &dense.world, &dense.start, &dense.goal);
    const bool was_driven = drive(&dense, seed, has_faults);

    dense_map_free(&dense);
    *arrived += was_driven && navigation.result.state == JP_NAVIGATOR_ARRIVED;
    if (was_driven && is_right(is_reachable)) {
        return true;
    }
    (void)printf("seed %llu: %s, %s, failure %d; reachable %d, touched %d\n", (unsigned long long)seed,
                 navigation_state_name(navigation.result.state), navigation_reason_name(navigation.result.reason),
                 (int)navigation.commander.failure, is_reachable, navigation.result.is_touched);
    return false;
}

static void expect_right(bool has_faults)
{
    unsigned arrived = 0;
    unsigned wrong = 0;

    for (uint64_t seed = options.seed; seed < options.seed + options.count; seed++) {
        wrong += drives_right(seed, has_faults, &arrived) ? 0U : 1U;
    }
    (void)printf("%lu drives from seed %llu: %u arrived\n", options.count, options.seed, arrived);
    TEST_ASSERT_EQUAL_UINT(0, wrong);
    TEST_ASSERT_GREATER_THAN_UINT(0, arrived);
}

static void test_arrives_over_the_bus(void)
{
    expect_right(false);
}

static void test_arrives_over_a_faulty_bus(void)
{
    expect_right(true);
    TEST_ASSERT_GREATER_THAN_UINT(0, (unsigned)faulty.hits[CAN_FAULT_LOSS]);
}

static void test_equal_drives_give_equal_bits(void)
{
    uint64_t fingerprints[2];
    unsigned arrived = 0;

    for (unsigned i = 0; i < 2; i++) {
        TEST_ASSERT_TRUE(drives_right(options.seed, true, &arrived));
        fingerprints[i] = navigation.fingerprint;
    }
    TEST_ASSERT_TRUE(fingerprints[0] == fingerprints[1]);
}

/* The drive, of the seeds of bench_navigate, turns on the spot before its first leg, sees a box a cell off from
 * there, and has no way past it until it looks again. */
static void test_what_drift_has_closed_is_tried_again(void)
{
    unsigned arrived = 0;

    robot = &burger;
    TEST_ASSERT_TRUE(drives_right(900285, false, &arrived));
    TEST_ASSERT_EQUAL_UINT(1, arrived);
    TEST_ASSERT_EQUAL_UINT8(1, navigation.drive.view.navigation.forgets);
}

static void run_tests(void);

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    if (!navigate_robot_load(&courier, "courier24") || !navigate_robot_load(&burger, "burger")) {
        return 2;
    }
    return RUN_PROPERTY(options, NULL);
}
