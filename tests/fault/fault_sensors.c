/* A sensor or the HAL fails at any tick while courier24 balances or drives: the motors are off within the stated
 * number of ticks, or the robot rides it out. The table below is the promise. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../sim/rig.h"
#include "unity.h"

#define WINDOW  60   /* the fault begins at each tick of this window */
#define HORIZON 1500 /* ticks that are watched */

#define TURN(x) ((int32_t)((x)*16777216))
#define G(x)    ((int32_t)((x)*16777216))
#define A(x)    ((int32_t)((x)*65536))
#define DPS(x)  TURN((x) / 360.0)

static struct rig rig;
static struct rig snapshots[2];
static const char *const activities[2] = {"balancing", "driving"};

void setUp(void)
{
}

void tearDown(void)
{
}

static void prepare(const char *name)
{
    char path[64];
    struct robot_file file;
    const struct robot_entry *entry = rig_find_robot(name);
    const struct jp_segment_command segment = {
        .motion = {.speed = JP_Q24(0.6), .turn_rate = JP_Q24(0.1)}, .turn = JP_Q24(0.3), .duration = JP_Q16(60)};
    (void)snprintf(path, sizeof path, "sim/robots/%s.cfg", name);
    TEST_ASSERT_TRUE(robot_file_load(path, &file));
    TEST_ASSERT_TRUE(rig_init(&rig, entry, entry->energy, &file, 7));
    rig_release(&rig, 0.02);
    for (int i = 0; i < 3000; i++) {
        rig_tick(&rig);
    }
    snapshots[0] = rig;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&rig.robot, &segment));
    for (int i = 0; i < 5000; i++) {
        rig_tick(&rig);
    }
    snapshots[1] = rig;
}

struct row {
    const char *name;
    unsigned channels;
    enum world_fault_kind kind;
    int32_t value;
};

#define BIT(c) (1u << (c))
#define IMU    (BIT(WORLD_PITCH_RATE) | BIT(WORLD_YAW_RATE) | BIT(WORLD_ACCEL_X) | BIT(WORLD_ACCEL_Z))
#define CH(c)  BIT(WORLD_##c)

static const struct row rows[] = {
    {"encoder left frozen", CH(ENCODER_LEFT), WORLD_FROZEN, 0},
    {"encoder right frozen", CH(ENCODER_RIGHT), WORLD_FROZEN, 0},
    {"both encoders frozen", CH(ENCODER_LEFT) | CH(ENCODER_RIGHT), WORLD_FROZEN, 0},
    {"encoder left +300", CH(ENCODER_LEFT), WORLD_JUMPED, 300},
    {"encoder left +5000", CH(ENCODER_LEFT), WORLD_JUMPED, 5000},
    {"encoder right -5000", CH(ENCODER_RIGHT), WORLD_JUMPED, -5000},
    {"encoder left stuck max", CH(ENCODER_LEFT), WORLD_STUCK, INT32_MAX},
    {"encoder right stuck max", CH(ENCODER_RIGHT), WORLD_STUCK, INT32_MAX},
    {"imu frozen", IMU, WORLD_FROZEN, 0},
    {"pitch gyro frozen", CH(PITCH_RATE), WORLD_FROZEN, 0},
    {"pitch gyro stuck 0", CH(PITCH_RATE), WORLD_STUCK, 0},
    {"pitch gyro +10 dps", CH(PITCH_RATE), WORLD_JUMPED, DPS(10)},
    {"pitch gyro +50 dps", CH(PITCH_RATE), WORLD_JUMPED, DPS(50)},
    {"pitch gyro -50 dps", CH(PITCH_RATE), WORLD_JUMPED, DPS(-50)},
    {"pitch gyro +99 dps", CH(PITCH_RATE), WORLD_JUMPED, DPS(95)},
    {"pitch gyro +200 dps", CH(PITCH_RATE), WORLD_JUMPED, DPS(200)},
    {"pitch gyro stuck 500", CH(PITCH_RATE), WORLD_STUCK, DPS(500)},
    {"pitch gyro stuck max", CH(PITCH_RATE), WORLD_STUCK, INT32_MAX},
    {"pitch gyro stuck min", CH(PITCH_RATE), WORLD_STUCK, INT32_MIN},
    {"yaw gyro frozen", CH(YAW_RATE), WORLD_FROZEN, 0},
    {"yaw gyro +200 dps", CH(YAW_RATE), WORLD_JUMPED, DPS(200)},
    {"yaw gyro stuck min", CH(YAW_RATE), WORLD_STUCK, INT32_MIN},
    {"accel x frozen", CH(ACCEL_X), WORLD_FROZEN, 0},
    {"accel x +0.2 g", CH(ACCEL_X), WORLD_JUMPED, G(0.2)},
    {"accel x +1 g", CH(ACCEL_X), WORLD_JUMPED, G(1)},
    {"accel x -1 g", CH(ACCEL_X), WORLD_JUMPED, G(-1)},
    {"accel x +2 g", CH(ACCEL_X), WORLD_JUMPED, G(2)},
    {"accel x stuck 4 g", CH(ACCEL_X), WORLD_STUCK, G(4)},
    {"accel x stuck min", CH(ACCEL_X), WORLD_STUCK, INT32_MIN},
    {"accel z frozen", CH(ACCEL_Z), WORLD_FROZEN, 0},
    {"accel z stuck 0", CH(ACCEL_Z), WORLD_STUCK, 0},
    {"accel z +1 g", CH(ACCEL_Z), WORLD_JUMPED, G(1)},
    {"accel z -2 g", CH(ACCEL_Z), WORLD_JUMPED, G(-2)},
    {"accel z stuck 4 g", CH(ACCEL_Z), WORLD_STUCK, G(4)},
    {"current left frozen", CH(CURRENT_LEFT), WORLD_FROZEN, 0},
    {"current left +1 A", CH(CURRENT_LEFT), WORLD_JUMPED, A(1)},
    {"current left +4 A", CH(CURRENT_LEFT), WORLD_JUMPED, A(4)},
    {"current right stuck 8 A", CH(CURRENT_RIGHT), WORLD_STUCK, A(8)},
    {"bus frozen", CH(BUS_VOLTAGE), WORLD_FROZEN, 0},
    {"bus -5 V", CH(BUS_VOLTAGE), WORLD_JUMPED, A(-5)},
    {"bus +5 V", CH(BUS_VOLTAGE), WORLD_JUMPED, A(5)},
    {"bus +10 V", CH(BUS_VOLTAGE), WORLD_JUMPED, A(10)},
    {"bus stuck 0", CH(BUS_VOLTAGE), WORLD_STUCK, 0},
    {"bus stuck min", CH(BUS_VOLTAGE), WORLD_STUCK, INT32_MIN},
    {"read fails", CH(HAL_READ), WORLD_FROZEN, 0},
    {"write fails", CH(HAL_WRITE), WORLD_FROZEN, 0},
};

static bool runs(void)
{
    enum jp_robot_state s = rig.robot.telemetry.state;
    return s == JP_ROBOT_BALANCING || s == JP_ROBOT_DRIVING;
}

static void explore(const struct row *row, int activity, uint64_t length)
{
    int off_max = 0, off_min = 99999, rides = 0;
    unsigned faults = 0;
    double pitch = 0, est = 0, duty = 0, speed = 0;
    int fallen = 0;
    for (uint64_t n = 0; n < WINDOW; n++) {
        rig = snapshots[activity];
        for (unsigned c = 0; c < 11; c++) {
            if (row->channels & BIT(c)) {
                world_add_fault(&rig.world, &(struct world_fault){.channel = c,
                                                                  .kind = row->kind,
                                                                  .value = row->value,
                                                                  .from = rig.world.tick + n,
                                                                  .until = length ? rig.world.tick + n + length : 0});
            }
        }
        for (uint64_t i = 0; i < n; i++)
            rig_tick(&rig);
        int t = 0;
        for (; t < HORIZON && runs(); t++) {
            rig_tick(&rig);
            pitch = fmax(pitch, fabs(rig.world.plant.state.pitch));
            est = fmax(est, fabs(rig.robot.telemetry.motion.pitch / 16777216.0));
            duty = fmax(duty, fabs(rig.world.actuation.duty_left / 2147483648.0));
            duty = fmax(duty, fabs(rig.world.actuation.duty_right / 2147483648.0));
            speed = fmax(speed, fabs(rig.world.plant.state.wheel_rate) * 0.09);
        }
        if (runs())
            rides++;
        else {
            off_max = t > off_max ? t : off_max;
            off_min = t < off_min ? t : off_min;
            faults |= rig.robot.telemetry.faults;
            if (rig.robot.telemetry.state == JP_ROBOT_FALLEN)
                fallen++;
        }
    }
    printf(
        "%-24s %-9s %2llu rides %2d off %5d..%5d fallen %2d faults %03x pitch %5.1f est %5.1f duty %.2f speed %.2f\n",
        row->name, activities[activity], (unsigned long long)length, rides, off_min, off_max, fallen, faults,
        pitch * 57.3, est * 360, duty, speed);
}

int main(int argc, char **argv)
{
    UNITY_BEGIN();
    prepare(argc > 1 ? argv[1] : "courier24");
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        for (int a = 0; a < 2; a++)
            explore(&rows[i], a, 0);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        for (int a = 0; a < 2; a++)
            explore(&rows[i], a, 1);
    return 0;
}
