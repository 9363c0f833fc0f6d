/*
 * Telemetry read while another thread ticks: whatever the moment, all of it is of one tick.
 *
 * prop_telemetry [--count N]
 * --count is the number of reads.
 */
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "tests/support/options.h"
#include "unity.h"

/* Of the ticks that go by, and of the reads that begin within one: where both threads share a core they are rare. */
enum { TICKS_MIN = 1000, WITHIN_MIN = 20 };

static struct options options = {.count = 50000, .seed = 1};
static struct jp_robot_config config;
static struct jp_robot robot;
static atomic_bool stop;

void setUp(void)
{
}

void tearDown(void)
{
}

/* The wheels are held, the body trembles, and the currents are those of the voltages. */
static void tick(void)
{
    const jp_q24 trembling = jp_robot_last_tick(&robot)->tick % 2U == 0 ? JP_Q24(0.003) : -JP_Q24(0.003);
    struct jp_sensors sensors = {.pitch_rate = trembling, .accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)};
    struct jp_actuation actuation;

    sensors.current_left = jp_q16_divide(jp_robot_last_tick(&robot)->voltages.left, config.monitor.motor_resistance);
    sensors.current_right = jp_q16_divide(jp_robot_last_tick(&robot)->voltages.right, config.monitor.motor_resistance);
    jp_robot_tick(&robot, JP_OK, &sensors, &actuation);
}

/* So slow that the held wheels do not matter. */
static const struct jp_segment_command segment = {{0, 0}, 0, JP_Q16(16384)};

#define SEGMENT_TICKS (16384U * 1000U)

/* One segment after the other: how many ticks go by while somebody reads, the machine decides. */
static void *keep_ticking(void *unused)
{
    while (!atomic_load(&stop)) {
        tick();
        if (jp_robot_last_tick(&robot)->segment_ticks_left == 1U) {
            (void)jp_robot_drive(&robot, &segment);
        }
    }
    return unused;
}

static void drive_for_long(void)
{
    const char *field = "";

    config = jp_robot_courier24;
    config.monitor.freeze_ticks = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_init(&robot, &config, &field));
    tick();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    tick();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &segment));
    tick();
}

/* While segments are driven, the ticks gone by and those to come have one sum, which grows by a segment with each. */
static void test_telemetry_is_of_one_tick(void)
{
    struct jp_telemetry telemetry;
    pthread_t thread;

    drive_for_long();
    jp_robot_telemetry(&robot, &telemetry);
    const uint32_t first = telemetry.tick;
    const uint32_t sum = first + telemetry.segment_ticks_left;
    unsigned long torn = 0;
    unsigned within = 0;

    atomic_store(&stop, false);
    TEST_ASSERT_EQUAL_INT(0, pthread_create(&thread, NULL, keep_ticking, NULL));
    for (unsigned long i = 0; i < options.count || telemetry.tick - first < TICKS_MIN || within < WITHIN_MIN; i++) {
        within += __atomic_load_n(&robot.internal.sequence, __ATOMIC_RELAXED) & 1U;
        while (!jp_robot_telemetry(&robot, &telemetry)) {
        }
        torn += (telemetry.tick + telemetry.segment_ticks_left - sum) % SEGMENT_TICKS != 0U;
    }
    atomic_store(&stop, true);
    TEST_ASSERT_EQUAL_INT(0, pthread_join(thread, NULL));
    printf("%lu reads over %u ticks, torn %lu\n", options.count, (unsigned)(telemetry.tick - first), torn);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_DRIVING, telemetry.state);
    TEST_ASSERT_EQUAL_UINT64(0, torn);
}

/* The currents of the sensors are those of the voltages that drove the motors. */
static void test_motors_are_of_one_tick(void)
{
    struct jp_motor_sample sample;
    pthread_t thread;
    unsigned long torn = 0;
    unsigned long driven = 0;
    unsigned within = 0;

    drive_for_long();
    atomic_store(&stop, false);
    TEST_ASSERT_EQUAL_INT(0, pthread_create(&thread, NULL, keep_ticking, NULL));
    for (unsigned long i = 0; i < options.count || driven < TICKS_MIN || within < WITHIN_MIN; i++) {
        within += __atomic_load_n(&robot.internal.sequence, __ATOMIC_RELAXED) & 1U;
        while (!jp_robot_motors(&robot, &sample)) {
        }
        torn += sample.current_left != jp_q16_divide(sample.voltages.left, config.monitor.motor_resistance);
        torn += sample.current_right != jp_q16_divide(sample.voltages.right, config.monitor.motor_resistance);
        driven += sample.voltages.left != 0;
    }
    atomic_store(&stop, true);
    TEST_ASSERT_EQUAL_INT(0, pthread_join(thread, NULL));
    printf("%lu reads of the motors, %lu of them driven, torn %lu\n", options.count, driven, torn);
    TEST_ASSERT_EQUAL_UINT64(0, torn);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
