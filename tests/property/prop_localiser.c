/*
 * Localisation in offices against the true pose: over wheels that err, among walkers and boxes, without scans, and
 * after the robot was carried away.
 *
 * prop_localiser [--count N] [--seed S]
 */
#include <string.h>

#include "tests/support/check.h"
#include "tests/support/localiser_drive.h"
#include "tests/support/office_map.h"
#include "tests/support/options.h"
#include "unity.h"

#define LENGTH        20.0 /* m */
#define ERROR_MAX     0.05 /* m */
#define TURN_MAX      0.035
#define DEVIATIONS    4.0
#define CARRIED_ERROR 0.1 /* m */

enum { SLICE = 20000, CARRIED_SCANS = 300 };

static struct options options = {.count = 1, .seed = 1};
static struct random noise;
static struct office office;
static struct drive drive;
static struct jp_localiser localiser;
static void *block;

void setUp(void)
{
    random_init(&noise, options.seed);
}

void tearDown(void)
{
    drive_end(&drive);
    free(block);
    block = NULL;
}

static void locate(void)
{
    const struct jp_localiser_input input = drive_input(&drive);

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_update(&localiser, &input));
    (void)jp_localiser_work(&localiser, SLICE);
}

/* In a new office, at a pose that it is told. */
static void begin(const struct drive_trouble *trouble, unsigned long run)
{
    const struct jp_localiser_config config = drive_localiser(&office.terrain);
    const char *field;

    TEST_ASSERT_TRUE(office_make(&office, &noise));
    if (block != NULL) {
        tearDown();
    }
    drive_begin(&drive, &office.terrain, options.seed + run, trouble);

    const size_t size = jp_localiser_size(&config);
    const struct jp_plane_pose start = drive_plane(&drive.pose);

    block = malloc(size);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_init(&localiser, &config, block, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &start));
    drive_step(&drive, true);
    locate();
}

/* Where the last scan fitted it is near; where it did not, it is where the uncertainty says. */
static void check_pose(void)
{
    const double error = drive_distance(&drive, &localiser.pose);

    TEST_ASSERT_TRUE_MESSAGE(localiser.state != JP_LOCALISER_LOST, "lost");
    check_below(error, DEVIATIONS * (double)localiser.position_deviation + 0.01, "error by the uncertainty, m");
    if (localiser.state == JP_LOCALISER_TRACKING && (double)localiser.position_deviation < ERROR_MAX / 2) {
        check_below(error, ERROR_MAX, "error, m");
        check_below(drive_turn(&drive, &localiser.pose), TURN_MAX, "error of the heading, rad");
    }
}

static void drive_under(const struct drive_trouble *trouble)
{
    for (unsigned long run = 0; run < options.count; run++) {
        begin(trouble, run);
        while (drive.length < LENGTH) {
            drive_step(&drive, false);
            locate();
            check_pose();
        }
    }
}

static void test_on_slippery_ground(void)
{
    drive_under(&(struct drive_trouble){.slip = 0.1});
}

static void test_among_walkers_and_boxes(void)
{
    drive_under(&(struct drive_trouble){.slip = 0.03, .has_walkers = true, .box_spacing = 2});
}

static void test_with_scans_and_beams_that_fail(void)
{
    drive_under(&(struct drive_trouble){.slip = 0.03, .dropout = 0.3, .outage = 1});
}

/* Lost by name; then found where it is, or lost still: never elsewhere. */
static void test_carried_away(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        begin(&(struct drive_trouble){.slip = 0.03}, run);
        drive_kidnap(&drive);
        for (int i = 0; i < CARRIED_SCANS && !(localiser.counts.losses > 0 && localiser.state == JP_LOCALISER_TRACKING);
             i++) {
            drive_step(&drive, true);
            locate();
        }
        TEST_ASSERT_TRUE_MESSAGE(localiser.counts.losses > 0, "lost unseen");
        if (localiser.state == JP_LOCALISER_TRACKING) {
            check_below(drive_distance(&drive, &localiser.pose), CARRIED_ERROR, "found elsewhere, m");
        }
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
