/*
 * Driving for ever: no jump and no drift when counters and phases wrap, and no dependence on where they start.
 *
 * prop_wrap [--count N]
 * --count computes every tick of that many days of the courier; the default is some minutes of each robot.
 */
#include <joulepath/tables.h>

#include "tests/support/wrap_drive.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/rig.h"
#include "tests/support/options.h"
#include "unity.h"

/** A millimetre of the way and a tenth of a degree. */
#define WHEEL_BOUND_TURNS 0.001
#define YAW_BOUND_TURNS   (0.1 / 360)

static const struct wrap_geometry gao2018 = {&jp_robot_gao2018, 7, 6, 1 << 22};
static const struct wrap_geometry courier24 = {&jp_robot_courier24, 5, 3, 19200};
static const struct jp_motion forward = {JP_Q24(1), JP_Q24(0.35)};
static const struct jp_motion backward = {-JP_Q24(1), -JP_Q24(0.35)};
static const struct jp_motion fast = {JP_Q24(8), JP_Q24(-2)};
static struct options options; /* count: days */

void setUp(void)
{
}

void tearDown(void)
{
}

static void check(const char *name, struct wrap_drive *drive)
{
    wrap_run(drive);
    printf("%s, %.0f s: jump %.3g wheel, %.3g yaw; reference - measured drifts %.3g wheel, %.3g yaw; measured - exact "
           "%.3g wheel, %.3g yaw (turns)\n",
           name, (double)drive->ticks / drive->geometry->config->estimator.tick_rate, drive->wheel_jump,
           drive->yaw_jump, drive->wheel_drift, drive->yaw_drift, drive->wheel_measured_drift,
           drive->yaw_measured_drift);
    TEST_ASSERT_TRUE(drive->exact);
    TEST_ASSERT_TRUE(drive->wheel_jump <= WHEEL_BOUND_TURNS);
    TEST_ASSERT_TRUE(drive->yaw_jump <= YAW_BOUND_TURNS);
    TEST_ASSERT_TRUE(fabs(drive->wheel_drift) <= WHEEL_BOUND_TURNS);
    TEST_ASSERT_TRUE(fabs(drive->yaw_drift) <= YAW_BOUND_TURNS);
    TEST_ASSERT_TRUE(fabs(drive->wheel_measured_drift) <= WHEEL_BOUND_TURNS);
    TEST_ASSERT_TRUE(fabs(drive->yaw_measured_drift) <= YAW_BOUND_TURNS);
}

static void test_drives_through_encoder_and_phase_wraps(void)
{
    /* gao2018 counts 4.45 million a second: 2³² after 965 s; the wheel's phase wraps every 241 s. */
    struct wrap_drive near_wrap = {.geometry = &gao2018, .motion = forward, .first = 850000, .ticks = 300000};
    struct wrap_drive speeding = {.geometry = &gao2018, .motion = fast, .ticks = 600000};
    struct wrap_drive courier = {.geometry = &courier24, .motion = backward, .first = 126300000, .ticks = 600000};
    struct wrap_drive tenth_day = {.geometry = &courier24, .motion = forward, .first = 864000000, .ticks = 600000};

    check("gao2018 forward", &near_wrap);
    check("gao2018 at 8 m/s", &speeding);
    check("courier24 backward", &courier);
    check("courier24 on the tenth day", &tenth_day);
}

static void test_drives_for_days(void)
{
    if (options.count > 0) {
        struct wrap_drive drive = {.geometry = &courier24, .motion = forward, .ticks = options.count * 86400 * 1000};

        check("courier24", &drive);
    }
}

/* Closed loop */

#define DRIVE_TICKS 20000

struct trace {
    struct jp_voltages voltages[DRIVE_TICKS];
    struct jp_telemetry last;
    uint32_t sign_changes; /**< of the left encoder: its count passed 2³¹ or 2³² */
};

static void drive_rig(const struct robot_entry *entry, const struct robot_file *file, uint32_t left, uint32_t right,
                      struct trace *trace)
{
    static const struct jp_segment_command segments[] = {{{JP_Q24(0.8), JP_Q24(0.2)}, JP_Q24(0.6), JP_Q16(8)},
                                                         {{JP_Q24(-0.3), JP_Q24(-0.3)}, JP_Q24(-1), JP_Q16(6)}};
    static struct rig rig;
    uint32_t before = left;

    TEST_ASSERT_TRUE(rig_init(&rig, entry, file, 7));
    rig.world.instruments.encoder_start_left = left;
    rig.world.instruments.encoder_start_right = right;
    rig_release(&rig, 0.02);
    trace->sign_changes = 0;
    for (int tick = 0; tick < DRIVE_TICKS; tick++) {
        if (tick == 100 || tick == 5000) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&rig.robot, &segments[tick == 5000]));
        }
        rig_tick(&rig);
        trace->voltages[tick] = jp_robot_last_tick(&rig.robot)->voltages;
        trace->sign_changes += (rig.world.faults.last_read.encoder_left ^ before) >> 31;
        before = rig.world.faults.last_read.encoder_left;
    }
    jp_robot_telemetry(&rig.robot, &trace->last);
    TEST_ASSERT_EQUAL_UINT16(2, trace->last.segments_ended);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, trace->last.state);
}

static void check_offsets(const char *name)
{
    static struct trace expected, actual;
    static const uint32_t starts[][2] = {
        {0xFFFFFF00U, 0xFFFFFF80U}, {0U - 40000U, 0U - 70000U}, {0x7FFFF000U, 0x80000FFFU}, {123456789U, 987654321U}};
    const struct robot_entry *entry = rig_find_robot(name);
    struct robot_file file;
    char path[64];

    TEST_ASSERT_NOT_NULL(entry);
    (void)snprintf(path, sizeof path, "sim/robots/%s.cfg", name);
    TEST_ASSERT_TRUE(robot_file_load(path, &file));
    drive_rig(entry, &file, 0x10000000U, 0x10000000U, &expected);
    for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++) {
        drive_rig(entry, &file, starts[i][0], starts[i][1], &actual);
        TEST_ASSERT_TRUE(i == 3 || actual.sign_changes > 0);
        for (int tick = 0; tick < DRIVE_TICKS; tick++) {
            TEST_ASSERT_EQUAL_INT32(expected.voltages[tick].left, actual.voltages[tick].left);
            TEST_ASSERT_EQUAL_INT32(expected.voltages[tick].right, actual.voltages[tick].right);
        }
        TEST_ASSERT_EQUAL_INT64(expected.last.energy_battery, actual.last.energy_battery);
        TEST_ASSERT_EQUAL_INT32(expected.last.position.x, actual.last.position.x);
        TEST_ASSERT_EQUAL_INT32(expected.last.position.y, actual.last.position.y);
    }
}

static void test_start_counts_do_not_change_a_bit_of_the_closed_loop(void)
{
    check_offsets("gao2018");
    check_offsets("courier24");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
