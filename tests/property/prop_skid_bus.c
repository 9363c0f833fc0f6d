/* Random missions of robots that their sides steer, over a bus on which things go wrong, with sensors and bodies that
 * fail: each ends at its target or with a named fault, and none moves without a command or beyond the stated distance.
 * prop_skid_bus --count N [--seed S] [--verbose] drives N of them. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/balancer/fault_names.h"
#include "sim/bus/local_ecu.h"
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
        (void)printf(" %s %" PRIu64, bus_fault_name(trial->faults[i].kind), trial->faults[i].from);
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

/* ---- Records ---- */

#define RECORDS_EACH 5U /* of a mission */

static struct random noise;

static uint32_t any_bits(void)
{
    return (uint32_t)random_uniform(&noise, 0, 4294967296.0);
}

/** Any bits, but for what says whose it is; now and then that too. */
static union jp_retained_snapshot any_record(const struct jp_skid_robot_config *config)
{
    union jp_retained_snapshot record = {.skid = {.x = 0}};
    uint32_t words[sizeof record.skid / sizeof(uint32_t)];

    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        words[i] = any_bits() >> (any_bits() & 31U);
    }
    memcpy(&record.skid, words, sizeof words);
    if (random_uniform(&noise, 0, 1) < 0.9) {
        record.skid.tick_rate = config->odometry.tick_rate;
        record.skid.way_per_count = config->odometry.way_per_count;
        record.skid.steering_ratio = (jp_q24)(JP_Q24(0.01) + (int32_t)(any_bits() % (uint32_t)JP_Q24(7.9)));
        record.skid.scale = (1 << 29) + (int32_t)(any_bits() >> 2);
        record.skid.ratio = (1 << 26) + (int32_t)(any_bits() >> 2);
        record.skid.gyro_bias >>= 8;
        record.skid.x >>= 1;
        record.skid.y >>= 1;
        record.skid.ran = 1;
    }
    return record;
}

static void pass(struct bus_drive *drive, unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        TEST_ASSERT_TRUE(bus_drive_lockstep(drive));
    }
}

/** A reset with the record in memory, of a robot that stands. */
static bool go_on_from(struct local_ecu *ecu, struct bus_drive *drive, const union jp_retained_snapshot *record)
{
    drive->conditions.ecu_reset = true;
    pass(drive, 2);
    jp_retained_write(&ecu->node.own_record, JP_RETAINED_SKID, record, 0);
    drive->conditions.ecu_reset = false;
    pass(drive, 100);
    return jp_ecu_runs(&ecu->node.lockstep.ecu);
}

/* Whatever the record holds, the robot does not move: it stands, or is idle where the record cannot be its own. */
static void test_any_record_moves_nothing(void)
{
    static const struct skid_ground level = {NULL, NULL};
    static const struct planar_pose origin = {0, 0, 0};
    static struct local_ecu ecu;
    static struct bus_drive drive;
    const struct skid_robot_entry *robot = skid_robot_find("burger");
    struct skid_steer_model model;
    struct jp_can_link link;
    unsigned long stood = 0;

    random_init(&noise, options.seed);
    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/burger.cfg", &model));
    TEST_ASSERT_TRUE(local_ecu_start_skid(&ecu, robot, &link));
    bus_drive_init_skid(&drive, &model, &level, &origin, options.seed, &link);
    for (unsigned long i = 0; i < RECORDS_EACH * options.count; i++) {
        const union jp_retained_snapshot record = any_record(robot->config);

        stood += go_on_from(&ecu, &drive, &record) ? 1U : 0U;

        const struct planar_pose pose = skid_plant_pose(&drive.plant.skid.plant);

        TEST_ASSERT_TRUE_MESSAGE(hypot(pose.x, pose.y) < 0.002, "it moved");
    }
    (void)printf("%lu of %lu records taken up\n", stood, RECORDS_EACH * options.count);
    TEST_ASSERT_TRUE(stood > 0 && stood < RECORDS_EACH * options.count);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
