/**
 * How late samples, duties and ticks may be: what hal/README.md promises to those who port the library. The balancer
 * stands, drives and is pushed while the samples are old or ticks are left out.
 */
#include <math.h>
#include <stdio.h>

#include "sim/balancer/rig.h"
#include "sim/base/random.h"
#include "unity.h"

#define SEED    41
#define AGE_MAX 100

/* The promises, ticks of 1 ms. */
#define AGE      10
#define JITTER   2
#define LEFT_OUT 0.1 /* of all ticks */

/* Peak without any of it is 11.8° after the push; half of the tilt limit is 20°. */
#define PITCH_MAX 0.35 /* rad */

struct lateness {
    unsigned age;    /* of each sample, ticks */
    unsigned jitter; /* up to so much more, drawn for each sample, ticks */
    double left_out; /* share of the ticks that do not come: the bridges hold their duty */
};

/* The simulated board behind it. */
struct late_board {
    struct jp_hal board;
    struct lateness lateness;
    struct random random;
    struct jp_sensors samples[AGE_MAX + 1];
    unsigned count;
};

static struct rig rig;
static struct robot_file file;
static struct late_board late;

void setUp(void)
{
}

void tearDown(void)
{
}

static unsigned age_of_sample(struct late_board *board)
{
    const struct lateness *lateness = &board->lateness;
    const unsigned age = lateness->age + (unsigned)random_uniform(&board->random, 0, lateness->jitter + 1.0);

    return age < board->count ? age : board->count - 1U;
}

static enum jp_status read_late(void *context, struct jp_sensors *sensors)
{
    struct late_board *board = context;
    const enum jp_status status = board->board.read(board->board.context, sensors);

    board->samples[board->count++ % (AGE_MAX + 1U)] = *sensors;
    *sensors = board->samples[(board->count - 1U - age_of_sample(board)) % (AGE_MAX + 1U)];
    return status;
}

static enum jp_status write_now(void *context, const struct jp_actuation *actuation)
{
    const struct late_board *board = context;

    return board->board.write(board->board.context, actuation);
}

static void start(const struct lateness *lateness)
{
    const struct robot_entry *entry = rig_find_robot("courier24");

    TEST_ASSERT_NOT_NULL(entry);
    TEST_ASSERT_TRUE(robot_file_load("sim/robots/courier24.cfg", &file));
    TEST_ASSERT_TRUE(rig_init(&rig, entry, &file, SEED));
    rig_release(&rig, 0.02);
    late = (struct late_board){.board = rig.hal, .lateness = *lateness};
    random_init(&late.random, SEED);
    rig.hal = (struct jp_hal){.context = &late, .read = read_late, .write = write_now};
}

/* Returns the peak of the pitch, rad. */
static double run(int ticks)
{
    double peak = 0;

    for (int i = 0; i < ticks; i++) {
        if (random_uniform(&late.random, 0, 1) < late.lateness.left_out) {
            world_step(&rig.world);
        } else {
            rig_tick(&rig);
        }
        peak = fmax(peak, fabs(rig.world.plant.state.pitch));
    }
    return peak;
}

/* Returns the peak of the pitch, rad. */
static double stand_drive_and_push(const struct lateness *lateness)
{
    static const struct jp_segment_command segment = {
        .motion = {.speed = JP_Q24(0.6), .turn_rate = JP_Q24(0.1)}, .turn = JP_Q24(0.3), .duration = JP_Q16(60)};
    double peak;

    start(lateness);
    peak = run(3000);
    (void)jp_robot_drive(&rig.robot, &segment);
    peak = fmax(peak, run(5000));
    world_push(&rig.world, 20, 0, 50);
    return fmax(peak, run(5000));
}

static struct jp_telemetry telemetry(void)
{
    struct jp_telemetry copy;

    jp_robot_telemetry(&rig.robot, &copy);
    return copy;
}

static void check_rides(const struct lateness *lateness)
{
    const double peak = stand_drive_and_push(lateness);

    (void)printf("samples %u..%u ticks old, %2.0f %% of the ticks left out: pitch at most %.2f deg\n", lateness->age,
                 lateness->age + lateness->jitter, 100 * lateness->left_out, peak * 180 / M_PI);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_DRIVING, telemetry().state);
    TEST_ASSERT_EQUAL_HEX16(0, telemetry().faults);
    TEST_ASSERT_TRUE(peak < PITCH_MAX);
}

static void test_samples_may_be_old(void)
{
    for (unsigned age = 0; age <= AGE; age++) {
        check_rides(&(struct lateness){.age = age});
    }
}

static void test_samples_may_jitter(void)
{
    check_rides(&(struct lateness){.jitter = JITTER});
    check_rides(&(struct lateness){.age = AGE - JITTER, .jitter = JITTER});
}

static void test_ticks_may_be_left_out(void)
{
    check_rides(&(struct lateness){.left_out = LEFT_OUT});
    check_rides(&(struct lateness){.left_out = LEFT_OUT, .age = AGE});
}

/* Whatever makes the loop too slow ends as a named fault. */
static void test_more_than_the_controller_can_bear_ends_with_motors_off(void)
{
    static const struct lateness too_late[] = {{.age = AGE_MAX - 1}, {.jitter = 50}, {.left_out = 0.9}};

    for (size_t i = 0; i < sizeof too_late / sizeof too_late[0]; i++) {
        (void)stand_drive_and_push(&too_late[i]);
        TEST_ASSERT_EQUAL_INT(JP_ROBOT_FAULT, telemetry().state);
        TEST_ASSERT_NOT_EQUAL(0, telemetry().faults);
        TEST_ASSERT_EQUAL_INT(0, rig.world.actuation.enabled);
    }
}
