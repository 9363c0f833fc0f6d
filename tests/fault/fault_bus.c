/* The longest outage that is promised to be ridden out, of each kind, at times spread over standing up, setting off,
 * driving, braking and standing; and the worst of them that are not: what the robot does then is what hal/can/README.md
 * says.
 */
#include <string.h>

#include "sim/balancer/rig.h"
#include "tests/support/bus_trial.h"
#include "unity.h"

#define ROBOT_FILE "sim/robots/courier24.cfg"

#define FIRST_TICK 160U
#define STRIDE     503U /* prime: no period of the messages divides it */
#define TIMES      17U

static const struct robot_entry *entry;
static struct robot_file file;

void setUp(void)
{
    entry = rig_find_robot("courier24");
    TEST_ASSERT_NOT_NULL(entry);
    TEST_ASSERT_TRUE(robot_file_load(ROBOT_FILE, &file));
}

void tearDown(void)
{
}

static struct bus_trial one_fault(enum bus_fault_kind kind, uint64_t from, uint64_t ticks)
{
    struct bus_trial trial = {.seed = from,
                              .target_count = 1,
                              .targets = {{JP_Q16(2), JP_Q16(0.7)}},
                              .fault_count = 1,
                              .faults = {{.kind = kind, .from = from, .until = from + ticks, .share = 1}}};

    TEST_ASSERT_TRUE(bus_trial_run(&trial, entry, &file));
    return trial;
}

static void check_ridden_out(enum bus_fault_kind kind)
{
    for (unsigned i = 0; i < TIMES; i++) {
        const uint64_t from = FIRST_TICK + (uint64_t)i * STRIDE;
        const struct bus_trial trial = one_fault(kind, from, BUS_TRIAL_OUTAGE_MAX);
        char what[96];

        (void)snprintf(what, sizeof what, "%s from tick %u: %s", bus_fault_name(kind), (unsigned)from,
                       bus_trial_end_name(trial.end));
        TEST_ASSERT_EQUAL_INT_MESSAGE(BUS_TRIAL_DONE, trial.end, what);
        TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, trial.robot_faults, what);
    }
}

static void test_blackout_is_ridden_out_at_any_time(void)
{
    check_ridden_out(BUS_FAULT_BLACKOUT);
}

static void test_bus_off_is_ridden_out_at_any_time(void)
{
    check_ridden_out(BUS_FAULT_BUS_OFF);
}

static void test_reset_of_the_controller_is_ridden_out_at_any_time(void)
{
    check_ridden_out(BUS_FAULT_ECU_RESET);
}

static void test_pause_of_the_plant_is_ridden_out_at_any_time(void)
{
    check_ridden_out(BUS_FAULT_PLANT_PAUSE);
}

static void test_a_long_blackout_ends_with_motors_off_and_a_named_fault(void)
{
    const struct bus_trial trial = one_fault(BUS_FAULT_BLACKOUT, 3000, 2000);

    TEST_ASSERT_EQUAL_INT(BUS_TRIAL_FELL, trial.end);
}

static void test_a_silent_operator_stops_the_robot_and_the_route_goes_on_after_it(void)
{
    const struct bus_trial trial = one_fault(BUS_FAULT_SILENCE, 3000, 4000);

    TEST_ASSERT_EQUAL_INT(BUS_TRIAL_DONE, trial.end);
    TEST_ASSERT_EQUAL_UINT32(2, trial.attempts);
    TEST_ASSERT_TRUE(trial.stop_seconds > 0.5);
    TEST_ASSERT_TRUE(trial.stop_seconds < BUS_TRIAL_STOP_MAX);
}

static void test_strange_frames_do_not_move_a_standing_robot(void)
{
    struct bus_trial trial = one_fault(BUS_FAULT_STRANGE, 150, 20000);

    TEST_ASSERT_EQUAL_INT(BUS_TRIAL_DONE, trial.end);
}
