/* Random missions of robots that their sides steer, over a bus on which things go wrong, with sensors and bodies that
 * fail: each ends at its target or with a named fault, and none moves without a command or beyond the stated distance.
 * prop_skid_bus --count N [--seed S] [--verbose] drives N of them. */
#include <inttypes.h>
#include <stdio.h>

#include "sim/balancer/fault_names.h"
#include "tests/support/options.h"
#include "tests/support/skid_bus_trial.h"
#include "unity.h"

static struct options options = {.count = 10, .seed = 1};

void setUp(void)
{
}

void tearDown(void)
{
}

static void describe(const struct skid_bus_trial *trial)
{
    char found[FAULTS_NAME_SIZE];

    faults_name(trial->robot_faults, found);
    (void)printf("seed %" PRIu64 ", %s: %s, tick %" PRIu32 ", off %.3f m, stop %.2f of the stated, faults: %s;",
                 trial->seed, trial->robot->name, skid_bus_end_name(trial->end), trial->ticks, trial->end_error,
                 trial->stop, found);
    for (size_t i = 0; i < trial->fault_count; i++) {
        (void)printf(" %s %" PRIu64, skid_bus_fault_name(trial->faults[i].kind), trial->faults[i].from);
    }
    (void)printf("\n");
}

static unsigned long drive(const char *name, unsigned long count)
{
    const struct skid_robot_entry *robot = skid_robot_find(name);
    struct skid_steer_model model;
    char path[64];
    unsigned long bad = 0;

    (void)snprintf(path, sizeof path, "sim/robots/%s.cfg", name);
    TEST_ASSERT_NOT_NULL(robot);
    TEST_ASSERT_TRUE(skid_robot_load(path, &model));
    for (unsigned long i = 0; i < count; i++) {
        struct skid_bus_trial trial;

        skid_bus_trial_draw(&trial, options.seed + i, robot, &model);
        TEST_ASSERT_TRUE(skid_bus_trial_run(&trial));

        const bool good = trial.end == SKID_BUS_DONE || trial.end == SKID_BUS_NAMED || trial.thrown;

        if (options.verbose || !good) {
            describe(&trial);
        }
        bad += good ? 0 : 1;
    }
    return bad;
}

static void test_random_missions_with_faults(void)
{
    (void)printf("%lu random missions of each robot from seed %llu\n", options.count, options.seed);
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, (uint32_t)drive("zhang2018", options.count), "missions that ended badly");
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, (uint32_t)drive("burger", options.count), "missions that ended badly");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
