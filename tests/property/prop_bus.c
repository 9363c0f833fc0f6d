/* Random missions over a bus on which things go wrong: no fall, no motion without a command, a stop in time, and the
 * route driven once the bus is well. prop_bus --count N [--seed S] [--verbose] drives N of them. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/rig.h"
#include "tests/support/bus_trial.h"
#include "tests/support/options.h"
#include "unity.h"

#define ROBOT_FILE "sim/robots/courier24.cfg"

static struct options options = {.count = 12, .seed = 1};

void setUp(void)
{
}

void tearDown(void)
{
}

static void describe(const struct bus_trial *trial)
{
    (void)printf("seed %" PRIu64
                 ": %s%s, %.1f s, %u attempts, stop %.2f s %.2f m, off %.3f m, pitch %.1f deg, faults 0x%x;",
                 trial->seed, bus_trial_end_name(trial->end), trial->excused ? " (sensors alone do it)" : "",
                 trial->ticks / 1000.0, trial->attempts, trial->stop_seconds, trial->stop_metres, trial->end_error,
                 trial->peak_pitch_deg, trial->robot_faults);
    for (size_t i = 0; i < trial->fault_count; i++) {
        const struct bus_trial_fault *fault = &trial->faults[i];

        (void)printf(" %s %" PRIu64 "-%" PRIu64 " %.2f", bus_fault_name(fault->kind), fault->from, fault->until,
                     fault->share);
    }
    (void)printf("\n");
}

static void test_random_missions_with_faults(void)
{
    const struct robot_entry *entry = rig_find_robot("courier24");
    struct robot_file file;
    unsigned long bad = 0;

    TEST_ASSERT_NOT_NULL(entry);
    TEST_ASSERT_TRUE(robot_file_load(ROBOT_FILE, &file));
    (void)printf("%lu random missions from seed %llu\n", options.count, options.seed);
    for (unsigned long i = 0; i < options.count; i++) {
        struct bus_trial trial;

        bus_trial_draw(&trial, options.seed + i);
        TEST_ASSERT_TRUE(bus_trial_run(&trial, entry, &file));

        const bool good = trial.end == BUS_TRIAL_DONE || trial.excused;

        if (options.verbose || !good) {
            describe(&trial);
        }
        bad += good ? 0 : 1;
    }
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, (uint32_t)bad, "missions that ended badly");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
