/* A sensor or the HAL fails at any tick while a robot balances or drives: the motors are off within the ticks of the
 * table below, or the robot rides it out. `fault_sensors` prints what was measured beside each promise. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/balancer/rig.h"
#include "unity.h"

#define SEED    7
#define WINDOW  60   /* the fault begins at each tick of this window */
#define HORIZON 1000 /* ticks watched after the first of them */
#define CALM    200  /* after a glitch */
#define RIDES   0    /* instead of a number of ticks: the motors stay on, the robot upright */

#define RIDE_PITCH  0.1  /* rad */
#define RIDE_SPEED  0.85 /* m/s; driving at 0.6 */
#define GLITCH_DUTY 0.25 /* what one bad tick may make of the duty, 0.14 in the calm */

#define IMU        (CH(PITCH_RATE) | CH(YAW_RATE) | CH(ACCEL_X) | CH(ACCEL_Z))
#define ENCODERS   (CH(ENCODER_LEFT) | CH(ENCODER_RIGHT))
#define CH(name)   (1u << WORLD_##name)
#define CHANNELS   (WORLD_HAL_WRITE + 1)
#define G(value)   ((int32_t)((value)*16777216.0))
#define DPS(value) ((int32_t)((value)*16777216.0 / 360.0))
#define Q16(value) ((int32_t)((value)*65536.0))

enum activity { BALANCING, DRIVING };

struct promise {
    const char *name;
    unsigned channels;
    enum world_fault_kind kind;
    int32_t value;
    int ticks[2];    /* from the first faulty tick until the motors are off: balancing, driving; or RIDES */
    uint16_t faults; /* reported then */
};

/* Faults that last. */
static const struct promise courier24[] = {
    {"HAL read fails", CH(HAL_READ), WORLD_FROZEN, 0, {3, 3}, JP_FAULT_HARDWARE},
    {"HAL write fails", CH(HAL_WRITE), WORLD_FROZEN, 0, {1, 1}, JP_FAULT_HARDWARE},
    {"IMU frozen", IMU, WORLD_FROZEN, 0, {50, 50}, JP_FAULT_IMU_FROZEN},
    {"pitch gyro frozen", CH(PITCH_RATE), WORLD_FROZEN, 0, {50, 50}, JP_FAULT_IMU_FROZEN},
    {"pitch gyro reads 0", CH(PITCH_RATE), WORLD_STUCK, 0, {51, 51}, JP_FAULT_IMU_FROZEN},
    {"pitch gyro +10 deg/s", CH(PITCH_RATE), WORLD_JUMPED, DPS(10), {RIDES, RIDES}, 0},
    {"pitch gyro +50 deg/s", CH(PITCH_RATE), WORLD_JUMPED, DPS(50), {3, 3}, JP_FAULT_IMU_JUMP},
    {"pitch gyro +200 deg/s", CH(PITCH_RATE), WORLD_JUMPED, DPS(200), {3, 3}, JP_FAULT_IMU_JUMP},
    {"pitch gyro -200 deg/s", CH(PITCH_RATE), WORLD_JUMPED, DPS(-200), {3, 3}, JP_FAULT_IMU_JUMP},
    {"pitch gyro reads 500 deg/s", CH(PITCH_RATE), WORLD_STUCK, DPS(500), {3, 3}, JP_FAULT_IMU_RANGE},
    {"pitch gyro reads max", CH(PITCH_RATE), WORLD_STUCK, INT32_MAX, {3, 3}, JP_FAULT_IMU_RANGE},
    {"pitch gyro reads min", CH(PITCH_RATE), WORLD_STUCK, INT32_MIN, {3, 3}, JP_FAULT_IMU_RANGE},
    {"yaw gyro frozen", CH(YAW_RATE), WORLD_FROZEN, 0, {50, 50}, JP_FAULT_IMU_FROZEN},
    {"yaw gyro +10 deg/s", CH(YAW_RATE), WORLD_JUMPED, DPS(10), {RIDES, RIDES}, 0},
    {"yaw gyro +200 deg/s", CH(YAW_RATE), WORLD_JUMPED, DPS(200), {3, 3}, JP_FAULT_IMU_JUMP},
    {"yaw gyro reads min", CH(YAW_RATE), WORLD_STUCK, INT32_MIN, {3, 3}, JP_FAULT_IMU_RANGE},
    {"accelerometer x frozen", CH(ACCEL_X), WORLD_FROZEN, 0, {50, 50}, JP_FAULT_IMU_FROZEN},
    {"accelerometer x +0.2 g", CH(ACCEL_X), WORLD_JUMPED, G(0.2), {RIDES, RIDES}, 0},
    {"accelerometer x reads 4 g", CH(ACCEL_X), WORLD_STUCK, G(4), {52, 52}, JP_FAULT_IMU_RANGE},
    {"accelerometer x reads min", CH(ACCEL_X), WORLD_STUCK, INT32_MIN, {52, 52}, JP_FAULT_IMU_RANGE},
    {"accelerometer z frozen", CH(ACCEL_Z), WORLD_FROZEN, 0, {50, 50}, JP_FAULT_IMU_FROZEN},
    {"accelerometer z +1 g", CH(ACCEL_Z), WORLD_JUMPED, G(1), {RIDES, RIDES}, 0},
    {"accelerometer z -2 g", CH(ACCEL_Z), WORLD_JUMPED, G(-2), {RIDES, RIDES}, 0},
    {"accelerometer z reads 4 g", CH(ACCEL_Z), WORLD_STUCK, G(4), {52, 52}, JP_FAULT_IMU_RANGE},
    {"left encoder frozen", CH(ENCODER_LEFT), WORLD_FROZEN, 0, {RIDES, 200}, JP_FAULT_ENCODER_LEFT},
    {"right encoder frozen", CH(ENCODER_RIGHT), WORLD_FROZEN, 0, {RIDES, 200}, JP_FAULT_ENCODER_RIGHT},
    {"both encoders frozen", ENCODERS, WORLD_FROZEN, 0, {RIDES, 200}, JP_FAULT_ENCODER_RIGHT},
    {"left encoder +300", CH(ENCODER_LEFT), WORLD_JUMPED, 300, {RIDES, RIDES}, 0},
    {"left encoder +5000", CH(ENCODER_LEFT), WORLD_JUMPED, 5000, {3, 3}, JP_FAULT_ENCODER_JUMP},
    {"right encoder -5000", CH(ENCODER_RIGHT), WORLD_JUMPED, -5000, {3, 3}, JP_FAULT_ENCODER_JUMP},
    {"right encoder +2^31-1", CH(ENCODER_RIGHT), WORLD_JUMPED, INT32_MAX, {3, 3}, JP_FAULT_ENCODER_JUMP},
    {"left encoder reads max", CH(ENCODER_LEFT), WORLD_STUCK, INT32_MAX, {3, 3}, JP_FAULT_ENCODER_JUMP},
    {"left current frozen", CH(CURRENT_LEFT), WORLD_FROZEN, 0, {RIDES, RIDES}, 0},
    {"left current +0.3 A", CH(CURRENT_LEFT), WORLD_JUMPED, Q16(0.3), {RIDES, RIDES}, 0},
    {"left current +1 A", CH(CURRENT_LEFT), WORLD_JUMPED, Q16(1), {51, 51}, JP_FAULT_ENCODER_LEFT},
    {"left current +4 A", CH(CURRENT_LEFT), WORLD_JUMPED, Q16(4), {51, 51}, JP_FAULT_ENCODER_LEFT},
    {"right current reads -4 A", CH(CURRENT_RIGHT), WORLD_STUCK, Q16(-4), {51, 51}, JP_FAULT_ENCODER_RIGHT},
    {"right current reads 8 A", CH(CURRENT_RIGHT), WORLD_STUCK, Q16(8), {3, 3}, JP_FAULT_CURRENT_RANGE},
    {"left current reads min", CH(CURRENT_LEFT), WORLD_STUCK, INT32_MIN, {3, 3}, JP_FAULT_CURRENT_RANGE},
    {"bus voltage frozen", CH(BUS_VOLTAGE), WORLD_FROZEN, 0, {RIDES, RIDES}, 0},
    {"bus voltage -5 V", CH(BUS_VOLTAGE), WORLD_JUMPED, Q16(-5), {RIDES, RIDES}, 0},
    {"bus voltage +5 V", CH(BUS_VOLTAGE), WORLD_JUMPED, Q16(5), {RIDES, RIDES}, 0},
    {"bus voltage +10 V", CH(BUS_VOLTAGE), WORLD_JUMPED, Q16(10), {3, 3}, JP_FAULT_BUS_VOLTAGE},
    {"bus voltage reads 0", CH(BUS_VOLTAGE), WORLD_STUCK, 0, {3, 3}, JP_FAULT_BUS_VOLTAGE},
    {"bus voltage reads min", CH(BUS_VOLTAGE), WORLD_STUCK, INT32_MIN, {3, 3}, JP_FAULT_BUS_VOLTAGE},
};

/* The paper's robot has ideal sensors and no limits: only the impossible is a fault. */
static const struct promise gao2018[] = {
    {"HAL read fails", CH(HAL_READ), WORLD_FROZEN, 0, {3, 3}, JP_FAULT_HARDWARE},
    {"HAL write fails", CH(HAL_WRITE), WORLD_FROZEN, 0, {1, 1}, JP_FAULT_HARDWARE},
    {"pitch gyro reads max", CH(PITCH_RATE), WORLD_STUCK, INT32_MAX, {3, 3}, JP_FAULT_IMU_RANGE},
    {"yaw gyro reads min", CH(YAW_RATE), WORLD_STUCK, INT32_MIN, {3, 3}, JP_FAULT_IMU_RANGE},
    {"accelerometer x reads max", CH(ACCEL_X), WORLD_STUCK, INT32_MAX, {52, 52}, JP_FAULT_IMU_RANGE},
    {"right encoder +2^31-1", CH(ENCODER_RIGHT), WORLD_JUMPED, INT32_MAX, {3, 3}, JP_FAULT_ENCODER_JUMP},
    {"left current reads min", CH(CURRENT_LEFT), WORLD_STUCK, INT32_MIN, {3, 3}, JP_FAULT_CURRENT_RANGE},
    {"bus voltage reads 0", CH(BUS_VOLTAGE), WORLD_STUCK, 0, {3, 3}, JP_FAULT_BUS_VOLTAGE},
};

/* What happened in the runs of one row and one activity. */
struct outcome {
    int first_off; /* ticks from the first faulty one until the motors are off */
    int last_off;
    int rides; /* runs that the motors outlasted */
    uint16_t faults_of_all;
    double pitch; /* peaks while the motors run */
    double speed;
    double duty;
    bool finite;
};

/* Worlds point into themselves: a run starts by copying a snapshot back to the same place. */
static struct rig rig;
static struct rig snapshots[2];
static struct robot_file file;

void setUp(void)
{
}

void tearDown(void)
{
}

static void tick(int count)
{
    for (int i = 0; i < count; i++) {
        rig_tick(&rig);
    }
}

static bool motors_run(void)
{
    enum jp_robot_state state = jp_robot_state_now(&rig.robot);

    return state == JP_ROBOT_BALANCING || state == JP_ROBOT_DRIVING;
}

static void take_snapshots(const char *name)
{
    static const struct jp_segment_command segment = {
        .motion = {.speed = JP_Q24(0.6), .turn_rate = JP_Q24(0.1)}, .turn = JP_Q24(0.3), .duration = JP_Q16(60)};
    const struct robot_entry *entry = rig_find_robot(name);
    char path[64];

    (void)snprintf(path, sizeof path, "sim/robots/%s.cfg", name);
    TEST_ASSERT_NOT_NULL(entry);
    TEST_ASSERT_TRUE(robot_file_load(path, &file));
    TEST_ASSERT_TRUE(rig_init(&rig, entry, &file, SEED));
    rig_release(&rig, 0.02);
    tick(3000);
    snapshots[BALANCING] = rig;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&rig.robot, &segment));
    tick(8000);
    snapshots[DRIVING] = rig;
    (void)printf("%s, seed %d: a fault begins at each of %d ticks; ticks until the motors are off\n", name, SEED,
                 WINDOW);
}

/* `length` 0: for ever. */
static void add_faults(const struct promise *promise, uint64_t delay, uint64_t length)
{
    uint64_t from = rig.world.tick + delay;

    for (unsigned channel = 0; channel < CHANNELS; channel++) {
        const struct world_fault fault = {.channel = (enum world_channel)channel,
                                          .kind = promise->kind,
                                          .value = promise->value,
                                          .from = from,
                                          .until = length == 0 ? 0 : from + length};

        if ((promise->channels & (1u << channel)) != 0) {
            TEST_ASSERT_TRUE(world_add_fault(&rig.world, &fault));
        }
    }
}

static void note(double *peak, double value)
{
    *peak = fmax(*peak, fabs(value));
}

static void note_tick(struct outcome *outcome)
{
    const struct plant_state *state = &rig.world.plant.state;

    note(&outcome->pitch, state->pitch);
    note(&outcome->speed, state->wheel_rate * file.wheel.radius_m);
    note(&outcome->duty, rig.world.actuation.duty_left / 2147483648.0);
    note(&outcome->duty, rig.world.actuation.duty_right / 2147483648.0);
    outcome->finite = outcome->finite && isfinite(state->pitch + state->wheel + state->yaw);
}

/* One run; what the bridges get counts, not what the robot believes. */
static void run(struct outcome *outcome, const struct promise *promise, enum activity activity, int delay, int length)
{
    int off = 0;
    int horizon = length == 0 ? HORIZON : CALM;

    rig = snapshots[activity];
    add_faults(promise, (uint64_t)delay, (uint64_t)length);
    tick(delay);
    while (off < horizon && rig.world.actuation.enabled != 0) {
        note_tick(outcome);
        tick(1);
        off++;
    }
    if (rig.world.actuation.enabled != 0) {
        outcome->rides++;
    } else {
        tick(4);
        outcome->first_off = off < outcome->first_off ? off : outcome->first_off;
        outcome->last_off = off > outcome->last_off ? off : outcome->last_off;
        outcome->faults_of_all &= jp_robot_last_tick(&rig.robot)->faults;
        TEST_ASSERT_TRUE_MESSAGE(!motors_run() || length != 0, promise->name);
    }
}

static struct outcome run_window(const struct promise *promise, enum activity activity, int length)
{
    struct outcome outcome = {.first_off = HORIZON, .faults_of_all = UINT16_MAX, .finite = true};

    for (int delay = 0; delay < WINDOW; delay++) {
        run(&outcome, promise, activity, delay, length);
    }
    return outcome;
}

static void print_outcome(const struct promise *promise, enum activity activity, const struct outcome *outcome)
{
    char promised[24] = "rides";
    char measured[32] = "rides";

    if (promise->ticks[activity] != RIDES) {
        (void)snprintf(promised, sizeof promised, "%d", promise->ticks[activity]);
    }
    if (outcome->rides < WINDOW) {
        (void)snprintf(measured, sizeof measured, "%d..%d", outcome->first_off, outcome->last_off);
    }
    (void)printf("%-27s %-9s promised %5s, measured %9s, pitch %5.1f deg, speed %4.2f m/s, duty %4.2f\n", promise->name,
                 activity == DRIVING ? "driving" : "balancing", promised, measured, outcome->pitch * 180 / M_PI,
                 outcome->speed, outcome->duty);
}

static void check_promise(const struct promise *promise, enum activity activity)
{
    struct outcome outcome = run_window(promise, activity, 0);

    print_outcome(promise, activity, &outcome);
    TEST_ASSERT_TRUE_MESSAGE(outcome.finite && outcome.duty <= 1, promise->name);
    if (promise->ticks[activity] == RIDES) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(WINDOW, outcome.rides, promise->name);
        TEST_ASSERT_TRUE_MESSAGE(outcome.pitch <= RIDE_PITCH && outcome.speed <= RIDE_SPEED, promise->name);
    } else {
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, outcome.rides, promise->name);
        TEST_ASSERT_TRUE_MESSAGE(outcome.last_off <= promise->ticks[activity], promise->name);
        TEST_ASSERT_EQUAL_HEX16_MESSAGE(promise->faults, outcome.faults_of_all & promise->faults, promise->name);
    }
}

static void check_promises(const struct promise *promises, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        check_promise(&promises[i], BALANCING);
        check_promise(&promises[i], DRIVING);
    }
}

static void test_lasting_faults_of_courier24(void)
{
    take_snapshots("courier24");
    check_promises(courier24, sizeof courier24 / sizeof courier24[0]);
}

static void test_lasting_faults_of_gao2018(void)
{
    take_snapshots("gao2018");
    check_promises(gao2018, sizeof gao2018 / sizeof gao2018[0]);
}

static bool is_slow(const struct promise *promise)
{
    return promise->ticks[DRIVING] == RIDES || promise->ticks[DRIVING] > 3;
}

/* One bad tick is no fault. A fast one is recognised and not acted upon; a slow one is within what may be true. */
static void check_glitches(const struct promise *promises, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        for (int activity = BALANCING; activity <= DRIVING; activity++) {
            for (int length = 1; length <= 2; length++) {
                struct outcome outcome = run_window(&promises[i], (enum activity)activity, length);
                bool motors_off = (promises[i].channels & CH(HAL_WRITE)) != 0;

                TEST_ASSERT_EQUAL_INT_MESSAGE(motors_off ? 0 : WINDOW, outcome.rides, promises[i].name);
                TEST_ASSERT_TRUE_MESSAGE(outcome.pitch <= RIDE_PITCH, promises[i].name);
                TEST_ASSERT_TRUE_MESSAGE(is_slow(&promises[i]) || outcome.duty <= GLITCH_DUTY, promises[i].name);
            }
        }
    }
}

static void test_glitches_are_ridden_out(void)
{
    take_snapshots("courier24");
    check_glitches(courier24, sizeof courier24 / sizeof courier24[0]);
}

/* The bridges are off for the ticks whose write fails, and on again after them. */
static void test_failed_writes_are_ridden_out(void)
{
    take_snapshots("courier24");
    for (int delay = 0; delay < WINDOW; delay++) {
        rig = snapshots[DRIVING];
        add_faults(&courier24[1], (uint64_t)delay, 2);
        tick(delay + HORIZON);
        TEST_ASSERT_EQUAL_INT(JP_ROBOT_DRIVING, jp_robot_state_now(&rig.robot));
        TEST_ASSERT_EQUAL_INT(1, rig.world.actuation.enabled);
    }
}

/* Set upright by a hand, and enabled. */
static void restart(void)
{
    plant_hold(&rig.world.plant, 0);
    tick(10);
    jp_robot_disable(&rig.robot);
    tick(10);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, jp_robot_state_now(&rig.robot));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&rig.robot));
    plant_release(&rig.world.plant);
    tick(HORIZON);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&rig.robot));
    TEST_ASSERT_TRUE(fabs(rig.world.plant.state.pitch) < RIDE_PITCH);
}

/* After the cause has gone disable and enable suffice, however long it lasted; an encoder that counts from elsewhere
 * is as good as before. */
static void test_robot_can_be_enabled_after_a_fault(void)
{
    take_snapshots("courier24");
    for (size_t i = 0; i < sizeof courier24 / sizeof courier24[0]; i++) {
        const struct promise *promise = &courier24[i];
        bool offset = promise->kind == WORLD_JUMPED && (promise->channels & ENCODERS) != 0;

        if (promise->ticks[DRIVING] != RIDES) {
            (void)printf("%s\n", promise->name);
            rig = snapshots[DRIVING];
            add_faults(promise, 0, offset ? 0 : 3000);
            tick(3000);
            TEST_ASSERT_FALSE(motors_run());
            restart();
        }
    }
}
