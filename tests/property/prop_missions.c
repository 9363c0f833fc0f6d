/* Random missions of courier24 with tilted starts and pushes: no fall, and out of saturation in normal driving.
 * prop_missions --count N [--seed S] [--verbose] drives N of them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/options.h"
#include "tests/support/trial.h"
#include "unity.h"

#define ROBOT_FILE "sim/robots/courier24.cfg"

static struct options options = {.count = 10, .seed = 1};

void setUp(void)
{
}

void tearDown(void)
{
}

static void describe(const struct trial *trial)
{
    static const char *const ends[] = {"done", "fell", "unplanned", "late"};

    (void)printf("seed %llu: %s, faults 0x%x, %zu targets, tilt %+.0f deg, %u pushes, %.1f s, saturated ticks %llu, "
                 "in normal driving %llu (first at %.2f s), peak %.2f V, pitch %.1f deg (pushed %.1f), off %.3f m\n",
                 (unsigned long long)trial->seed, ends[trial->end], trial->last.faults, trial->target_count,
                 trial->tilt_deg, trial->pushes, (double)trial->ticks / 1000,
                 (unsigned long long)trial->saturated_ticks, (unsigned long long)trial->normal_saturated_ticks,
                 trial->first_saturated_s, trial->peak_voltage, trial->peak_pitch_deg, trial->peak_pitch_pushed_deg,
                 trial->end_error);
}

static void drive_missions(enum trial_strategy strategy)
{
    const struct robot_entry *entry = rig_find_robot("courier24");
    struct robot_file file;
    unsigned long bad = 0;

    TEST_ASSERT_NOT_NULL(entry);
    TEST_ASSERT_TRUE(robot_file_load(ROBOT_FILE, &file));
    (void)printf("%lu random missions from seed %llu\n", options.count, options.seed);
    for (unsigned long i = 0; i < options.count; i++) {
        struct trial trial;

        TEST_ASSERT_TRUE(trial_run(&trial, strategy, entry, &file, options.seed + i));

        bool good = trial.end == TRIAL_DONE && trial.normal_saturated_ticks == 0;

        if (options.verbose || !good) {
            describe(&trial);
        }
        bad += good ? 0 : 1;
    }
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, (uint32_t)bad, "missions with a fall, an unplanned target or saturation");
}

static void test_random_missions_of_segments(void)
{
    drive_missions(TRIAL_SEGMENTS);
}

static void test_random_missions_of_cruise_and_transients(void)
{
    drive_missions(TRIAL_CRUISE);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
