/*
 * Bad input while a robot learns what its battery spends: currents with offset or gain, dropped samples, a battery at
 * its limits. Each is named, and the model that was learned before serves the segments after it as well as before.
 */
#include <joulepath/battery.h>
#include <joulepath/drive_watch.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/balancer/evidence_names.h"
#include "sim/balancer/rig.h"
#include "sim/balancer/variation.h"
#include "tests/support/chain.h"
#include "unity.h"

static const uint64_t seeds[] = {11, 4};

#define SEEDS (sizeof seeds / sizeof seeds[0])

#define PASS_TICKS 10 /* the background loop runs at 100 Hz */

#define LEARNING 60 /* segments before the fault, */
#define FAULTY   12 /* with it */
#define AFTER    16 /* and after it */
#define RECOVERY 8  /* segments after it until the findings are gone */

#define WORSE_MAX 0.01 /* of the energy: mean error of the model after the fault less that of the model before */

#define Q16(value) ((int32_t)((value)*65536.0))

static const struct jp_current_check_config current_check = {
    .offset = JP_Q16(0.05),
    .gain = JP_Q16(0.06),
    .resistance = JP_Q16(0.25),
    .excitation = JP_Q16(0.1),
    .memory = 512,
};

static const struct jp_battery_config lithium = {
    .capacity = 8595,
    .voltage_empty = JP_Q16(18),
    .voltage_nominal = JP_Q16(22.2),
    .voltage_full = JP_Q16(25.2),
    .voltage_min = JP_Q16(18),
    .voltage_max = JP_Q16(26),
    .voltage_jump = JP_Q16(6),
    .charge_efficiency = JP_Q16_ONE,
    .reserve = JP_Q31_MAX / 10,
};

/* What goes wrong in the segments of a period: the first of each `period`. */
struct injection {
    const char *name;
    struct world_fault fault; /* of the sensors, always */
    int drop_every;           /* ticks; 0: no sample is dropped */
    double supply;            /* V; 0: as it is */
    bool empties;             /* the battery is down to its reserve */
    int period;
    uint8_t findings;          /* of the current check: all of them are made */
    enum jp_evidence evidence; /* is found, too */
};

#define LEFT(of_kind, of_value)                                                                                        \
    .fault = {.channel = WORLD_CURRENT_LEFT, .kind = WORLD_##of_kind, .value = Q16(of_value)}
#define RIGHT(of_kind, of_value)                                                                                       \
    .fault = {.channel = WORLD_CURRENT_RIGHT, .kind = WORLD_##of_kind, .value = Q16(of_value)}
#define FOUND(finding) .findings = JP_CURRENT_##finding, .evidence = JP_EVIDENCE_CURRENT

static const struct injection injections[] = {
    {.name = "nothing", .period = 1},
    {.name = "left current +0.1 A", LEFT(JUMPED, 0.1), .period = 1, FOUND(OFFSET_LEFT)},
    {.name = "right current -0.3 A", RIGHT(JUMPED, -0.3), .period = 1, FOUND(OFFSET_RIGHT)},
    {.name = "left current +0.4 A, each 2nd", LEFT(JUMPED, 0.4), .period = 2, FOUND(OFFSET_LEFT)},
    {.name = "right current -0.1 A, each 3rd", RIGHT(JUMPED, -0.1), .period = 3, FOUND(OFFSET_RIGHT)},
    {.name = "left current x 0.8", LEFT(SCALED, 0.8), .period = 1, FOUND(GAIN_LEFT)},
    {.name = "right current x 0.9", RIGHT(SCALED, 0.9), .period = 1, FOUND(GAIN_RIGHT)},
    {.name = "left current x 1.2", LEFT(SCALED, 1.2), .period = 1, FOUND(GAIN_LEFT)},
    {.name = "right current x 0.5, each 2nd", RIGHT(SCALED, 0.5), .period = 2, .evidence = JP_EVIDENCE_CURRENT},
    {.name = "left current x 0.9, each 3rd", LEFT(SCALED, 0.9), .period = 3, .evidence = JP_EVIDENCE_CURRENT},
    {.name = "0.5 % of the samples dropped", .drop_every = 200, .period = 1},
    {.name = "1.1 % of the samples dropped", .drop_every = 90, .period = 1, .evidence = JP_EVIDENCE_DROPPED},
    {.name = "10 % of the samples dropped", .drop_every = 10, .period = 1, .evidence = JP_EVIDENCE_DROPPED},
    {.name = "10 % dropped, each 3rd", .drop_every = 10, .period = 3, .evidence = JP_EVIDENCE_DROPPED},
    {.name = "battery empty", .supply = 19, .empties = true, .period = 1, .evidence = JP_EVIDENCE_BATTERY},
    {.name = "battery over full", .supply = 27, .period = 1, .evidence = JP_EVIDENCE_BATTERY},
};

/* Everything, so that a copy to the same place goes on from there. */
struct scene {
    struct rig rig;
    struct robot_file file;
    struct jp_learner learner;
    struct jp_drive_watch watch;
    struct jp_current_check check;
    struct jp_battery battery;
    struct random random;
};

struct counts {
    uint8_t findings;
    unsigned evidences; /* bits of enum jp_evidence */
    int believed;
};

/* Of two models, on the same segments. */
struct comparison {
    struct jp_energy_model before;
    struct jp_energy_model after;
    double error_before; /* sums of relative errors */
    double error_after;
    int segments;
};

static const struct robot_entry *entry;
static struct scene scene;
static struct scene learned;

void setUp(void)
{
}

void tearDown(void)
{
}

/* The background loop. */

static struct jp_telemetry telemetry(void)
{
    struct jp_telemetry copy;

    jp_robot_telemetry(&scene.rig.robot, &copy);
    return copy;
}

static uint8_t check_currents(void)
{
    struct jp_motor_sample sample;

    return jp_robot_motors(&scene.rig.robot, &sample) ? jp_current_check_update(&scene.check, &sample) : 0;
}

static void hand_over(void)
{
    static const struct chain_ranges ranges = {0.9, 0.8, 0.5, 2, 5};
    struct chain_record record;

    chain_draw(&record, 1, &scene.file, &ranges, &scene.random);

    const struct jp_segment_command command =
        experiment_command(&record.command, record.commanded_ticks * world_tick_seconds(&scene.rig.world));

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&scene.rig.robot, &command));
    jp_drive_watch_command(&scene.watch, &command);
}

/* A pass; true when a segment has begun. */
static bool look(struct counts *counts)
{
    const struct jp_telemetry now = telemetry();
    const uint8_t findings = check_currents();
    const uint8_t flags = jp_battery_update(&scene.battery, &lithium, now.energy_battery,
                                            scene.rig.robot.internal.monitor.good.bus_voltage);

    counts->findings |= findings;
    return jp_drive_watch_update(&scene.watch, &now, flags, findings);
}

/* Faults */

static void inject(const struct injection *injection)
{
    struct world *world = &scene.rig.world;

    world->fault_count = 0;
    if (injection == NULL) {
        return;
    }
    if (injection->fault.value != 0) {
        (void)world_add_fault(world, &injection->fault);
    }
    if (injection->drop_every != 0 && world->tick % (uint64_t)injection->drop_every == 0) {
        (void)world_add_fault(world, &(struct world_fault){.channel = WORLD_HAL_READ});
    }
}

static void supply(double volts)
{
    struct robot_file changed = scene.rig.world.robot;

    changed.supply.voltage_v = volts;
    TEST_ASSERT_TRUE(world_change_robot(&scene.rig.world, &changed));
}

static void change_battery(const struct injection *injection)
{
    if (injection->supply != 0) {
        supply(injection->supply);
    }
    if (injection->empties) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&scene.battery, &lithium, (jp_charge)lithium.capacity << 28,
                                                      jp_robot_meter(&scene.rig.robot)->battery));
    }
}

static void restore_battery(void)
{
    supply(scene.file.supply.voltage_v);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&scene.battery, &lithium, (jp_charge)lithium.capacity << 31,
                                                  jp_robot_meter(&scene.rig.robot)->battery));
}

/* Segments */

/* Until the next segment begins, so that all of one is driven; false when the robot no longer drives. */
static bool drive_segment(const struct injection *injection, struct counts *counts)
{
    for (;;) {
        for (int i = 0; i < PASS_TICKS; i++) {
            inject(injection);
            rig_tick(&scene.rig);
        }
        if (jp_robot_state_now(&scene.rig.robot) != JP_ROBOT_DRIVING) {
            (void)look(counts);
            return false;
        }
        if (look(counts)) {
            hand_over();
            return true;
        }
    }
}

static void note(struct counts *counts)
{
    counts->evidences |= 1U << scene.watch.evidence;
    counts->believed += scene.watch.evidence == JP_EVIDENCE_GOOD;
}

static double measured_energy(void)
{
    const struct jp_telemetry now = telemetry();

    return (double)(scene.watch.of_battery ? now.segment_energy_battery : now.segment_energy_model) / 4294967296.0;
}

static double error_of(const struct jp_energy_model *model, const struct jp_energy_start *start,
                       const struct jp_segment_command *command, double measured)
{
    struct jp_energy_start end;
    jp_q16 predicted;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_energy_forecast(model, scene.learner.horizon, start, command, &predicted, &end));
    return fabs(predicted / 65536.0 / measured - 1);
}

static void drive_sound(int segments, struct counts *counts, struct comparison *comparison)
{
    for (int i = 0; i < segments; i++) {
        const struct jp_energy_start start = scene.watch.start;
        const struct jp_segment_command command = scene.watch.command;

        TEST_ASSERT_TRUE(drive_segment(NULL, counts));
        note(counts);
        if (comparison != NULL && scene.watch.evidence == JP_EVIDENCE_GOOD) {
            const double measured = measured_energy();

            comparison->error_before += error_of(&comparison->before, &start, &command, measured);
            comparison->error_after += error_of(&comparison->after, &start, &command, measured);
            comparison->segments++;
        }
    }
}

/* The fault, in the segments that it is for. */
static void drive_faulty(const struct injection *injection, struct counts *counts)
{
    change_battery(injection);
    for (int i = 0; i < FAULTY; i++) {
        TEST_ASSERT_TRUE_MESSAGE(drive_segment(i % injection->period == 0 ? injection : NULL, counts), injection->name);
        note(counts);
    }
    inject(NULL);
    restore_battery();
}

static void begin(bool of_battery, uint64_t seed)
{
    const struct variation variation = {1.3, 0.5, 1, 1, 1};
    struct robot_file varied;

    memset(&scene, 0, sizeof scene);
    entry = rig_find_robot("courier24");
    TEST_ASSERT_TRUE(entry != NULL && entry->learning_battery != NULL && entry->horizon_battery != NULL);
    TEST_ASSERT_TRUE(robot_file_load("sim/robots/courier24.cfg", &scene.file));
    variation_apply(&variation, &scene.file, &varied);
    TEST_ASSERT_TRUE(rig_init(&scene.rig, entry, &varied, seed));
    random_init(&scene.random, seed);
    jp_learner_start(&scene.learner, of_battery ? entry->learning_battery : entry->learning,
                     of_battery ? entry->energy_battery : entry->energy,
                     of_battery ? entry->horizon_battery : entry->horizon);
    jp_drive_watch_start(&scene.watch, &scene.learner, entry->config->estimator.tick_rate, of_battery);
    jp_current_check_start(&scene.check, &current_check, &entry->config->monitor);
    restore_battery();
    rig_release(&scene.rig, 0);
    hand_over();
}

static void learn(bool of_battery, uint64_t seed)
{
    struct counts counts = {0};

    begin(of_battery, seed);
    (void)drive_segment(NULL, &counts);
    drive_sound(LEARNING, &counts, NULL);
    TEST_ASSERT_EQUAL_HEX8(0, counts.findings);
    TEST_ASSERT_TRUE(counts.believed >= LEARNING - 1);
    learned = scene;
}

static void check_injection(const struct injection *injection)
{
    struct counts during = {0};
    struct counts after = {0};
    struct comparison comparison = {0};
    char findings[CURRENT_FINDINGS_SIZE];

    scene = learned;
    jp_learner_model(&scene.learner, &comparison.before);
    drive_faulty(injection, &during);
    jp_learner_model(&scene.learner, &comparison.after);
    drive_sound(AFTER, &after, &comparison);

    const double before = comparison.error_before / comparison.segments;
    const double worse = comparison.error_after / comparison.segments - before;

    current_findings_name(during.findings, findings);
    printf("%-31s %2d of %d believed, %-24s error %5.2f %% before, %+5.2f %% after (%d segments); %s\n",
           injection->name, during.believed, FAULTY, evidence_name(injection->evidence), 100 * before, 100 * worse,
           comparison.segments, findings);
    TEST_ASSERT_TRUE_MESSAGE((during.evidences & (1U << injection->evidence)) != 0, injection->name);
    TEST_ASSERT_EQUAL_HEX8_MESSAGE(injection->findings, during.findings & injection->findings, injection->name);
    TEST_ASSERT_TRUE_MESSAGE(comparison.segments >= AFTER - RECOVERY, injection->name);
    TEST_ASSERT_TRUE_MESSAGE(worse <= WORSE_MAX, injection->name);
}

static void test_the_last_good_model_of_the_battery_is_kept(void)
{
    for (size_t k = 0; k < SEEDS; k++) {
        printf("seed %u\n", (unsigned)seeds[k]);
        learn(true, seeds[k]);
        for (size_t i = 0; i < sizeof injections / sizeof injections[0]; i++) {
            check_injection(&injections[i]);
        }
    }
}

/* The motors' energy is voltage and resistance alone. */
static void test_currents_do_not_matter_to_the_energy_of_the_motors(void)
{
    static const struct injection offset = {.name = "motors: left current +0.4 A",
                                            LEFT(JUMPED, 0.4),
                                            .period = 1,
                                            .findings = JP_CURRENT_OFFSET_LEFT,
                                            .evidence = JP_EVIDENCE_GOOD};
    static const struct injection dropped = {
        .name = "motors: 10 % dropped", .drop_every = 10, .period = 1, .evidence = JP_EVIDENCE_DROPPED};

    learn(false, seeds[0]);
    check_injection(&offset);
    check_injection(&dropped);
}

/* Ends the segment half way; nothing is learned of it. */
static void expect_incomplete(const struct injection *injection)
{
    struct counts counts = {0};

    for (uint32_t i = 0; i < 1500 / PASS_TICKS; i++) {
        for (int k = 0; k < PASS_TICKS; k++) {
            inject(injection);
            rig_tick(&scene.rig);
        }
        (void)look(&counts);
    }
    TEST_ASSERT_EQUAL_INT(JP_EVIDENCE_INCOMPLETE, scene.watch.evidence);
    TEST_ASSERT_EQUAL_UINT32(learned.watch.learned_from, scene.watch.learned_from);
    TEST_ASSERT_EQUAL_MEMORY(&learned.learner.state, &scene.learner.state, sizeof scene.learner.state);
}

static void test_learns_nothing_from_a_segment_that_was_stopped(void)
{
    learn(true, seeds[0]);
    jp_robot_stop(&scene.rig.robot);
    expect_incomplete(NULL);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&scene.rig.robot));
}

/* So far off that the robot switches off. */
static void test_learns_nothing_from_a_segment_that_ends_in_a_fault(void)
{
    static const struct injection current = {LEFT(JUMPED, 1)};
    static const struct injection frames = {.drop_every = 1};

    scene = learned;
    expect_incomplete(&current);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_FAULT, jp_robot_state_now(&scene.rig.robot));
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_ENCODER_LEFT, jp_robot_last_tick(&scene.rig.robot)->faults);
    scene = learned;
    expect_incomplete(&frames);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, jp_robot_last_tick(&scene.rig.robot)->faults);
}

int main(void)
{
    printf("courier24: a fault in %d segments after %d without\n", FAULTY, LEARNING);
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
