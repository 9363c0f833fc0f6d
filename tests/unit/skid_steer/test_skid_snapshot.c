/* What a reset of the controller leaves of a skid-steered robot: all of it is kept, and nothing that cannot be its own
 * is taken up. */
#include <string.h>

#include "tests/support/skid_robot_rig.h"

#define ONE         ((int32_t)1 << 30) /* Q30 */
#define FARTHEST    (INT64_MAX / 2)
#define MOST_NODDED (INT32_MAX / 2)

static struct jp_skid_snapshot snapshot;

/** Another number in each of its members. */
static void fill(void)
{
    snapshot = (struct jp_skid_snapshot){
        .x = -((int64_t)3 << 33),
        .y = (int64_t)5 << 31,
        .heading = JP_PHASE_TURN / 3,
        .tick_rate = config.odometry.tick_rate,
        .way_per_count = config.odometry.way_per_count,
        .gyro_bias = JP_Q24(0.001),
        .steering_ratio = JP_Q24(0.61),
        .bias = 100001,
        .pitch_bias = -2002,
        .ratio = ONE / 2 + 3,
        .scale = ONE - 4005,
        .bias_bias = 506,
        .bias_ratio = -67,
        .ratio_ratio = 708,
    };
}

static struct jp_skid_snapshot snapshot_now(void)
{
    struct jp_skid_snapshot now;

    jp_skid_robot_snapshot(&robot, &now);
    return now;
}

static void test_what_is_resumed_is_what_was_kept(void)
{
    fill();
    TEST_ASSERT_TRUE(jp_skid_robot_resume(&robot, &snapshot));
    const struct jp_skid_snapshot now = snapshot_now();

    TEST_ASSERT_EQUAL_INT64(snapshot.x, now.x);
    TEST_ASSERT_EQUAL_INT64(snapshot.y, now.y);
    TEST_ASSERT_EQUAL_UINT64(snapshot.heading, now.heading);
    TEST_ASSERT_EQUAL_UINT32(snapshot.tick_rate, now.tick_rate);
    TEST_ASSERT_EQUAL_INT32(snapshot.way_per_count, now.way_per_count);
    TEST_ASSERT_EQUAL_INT32(snapshot.gyro_bias, now.gyro_bias);
    TEST_ASSERT_EQUAL_INT32(snapshot.steering_ratio, now.steering_ratio);
    TEST_ASSERT_EQUAL_INT32(snapshot.bias, now.bias);
    TEST_ASSERT_EQUAL_INT32(snapshot.pitch_bias, now.pitch_bias);
    TEST_ASSERT_EQUAL_INT32(snapshot.ratio, now.ratio);
    TEST_ASSERT_EQUAL_INT32(snapshot.scale, now.scale);
    TEST_ASSERT_EQUAL_INT32(snapshot.bias_bias, now.bias_bias);
    TEST_ASSERT_EQUAL_INT32(snapshot.bias_ratio, now.bias_ratio);
    TEST_ASSERT_EQUAL_INT32(snapshot.ratio_ratio, now.ratio_ratio);
}

static void test_the_robot_is_where_the_snapshot_says_and_knows_what_it_learned(void)
{
    const struct jp_skid_odometry *odometry = jp_skid_robot_odometry(&robot);

    fill();
    TEST_ASSERT_TRUE(jp_skid_robot_resume(&robot, &snapshot));
    TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_IDLE, jp_skid_robot_state_now(&robot));
    TEST_ASSERT_EQUAL_INT64(snapshot.x, telemetry().x);
    TEST_ASSERT_EQUAL_INT64(snapshot.y, telemetry().y);
    TEST_ASSERT_EQUAL_UINT64(snapshot.heading, telemetry().heading);
    TEST_ASSERT_EQUAL_INT32(snapshot.steering_ratio, telemetry().steering_ratio);
    TEST_ASSERT_EQUAL_INT32(snapshot.gyro_bias, odometry->bias_rate);
}

/* The counts that it goes on from, and whether its motors ran. */
static void test_a_snapshot_tells_of_the_last_frame_and_of_the_motors(void)
{
    wake();
    sensors.encoder_left = 1000;
    sensors.encoder_right = 0U - 77U;
    jp_skid_robot_tick(&robot, JP_OK, &sensors, &actuation);
    TEST_ASSERT_EQUAL_UINT32(1000, snapshot_now().encoder_left);
    TEST_ASSERT_EQUAL_UINT32(0U - 77U, snapshot_now().encoder_right);
    TEST_ASSERT_EQUAL_UINT32(0, snapshot_now().ran);
    set_up_rig();
    make_standing();
    TEST_ASSERT_EQUAL_UINT32(1, snapshot_now().ran);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &one_second));
    run(1);
    expect_state(JP_SKID_ROBOT_DRIVING);
    TEST_ASSERT_EQUAL_UINT32(1, snapshot_now().ran);
    set_up_rig();
    make_fault();
    TEST_ASSERT_EQUAL_UINT32(0, snapshot_now().ran);
}

/** A snapshot that is refused changes nothing. */
static void expect_refused(void)
{
    static struct jp_skid_odometry before;

    before = *jp_skid_robot_odometry(&robot);
    TEST_ASSERT_FALSE(jp_skid_robot_resume(&robot, &snapshot));
    TEST_ASSERT_EQUAL_MEMORY(&before, jp_skid_robot_odometry(&robot), sizeof before);
    fill();
}

static void expect_taken(void)
{
    TEST_ASSERT_TRUE(jp_skid_robot_resume(&robot, &snapshot));
    init();
    fill();
}

#define TAKEN(member, value)                                                                                           \
    do {                                                                                                               \
        snapshot.member = (value);                                                                                     \
        expect_taken();                                                                                                \
    } while (0)

#define REFUSED(member, value)                                                                                         \
    do {                                                                                                               \
        snapshot.member = (value);                                                                                     \
        expect_refused();                                                                                              \
    } while (0)

#define AT_LEAST(member, low)                                                                                          \
    do {                                                                                                               \
        TAKEN(member, low);                                                                                            \
        REFUSED(member, (low)-1);                                                                                      \
    } while (0)

#define AT_MOST(member, high)                                                                                          \
    do {                                                                                                               \
        TAKEN(member, high);                                                                                           \
        REFUSED(member, (high) + 1);                                                                                   \
    } while (0)

static void test_numbers_that_cannot_be_its_own_are_refused(void)
{
    fill();
    AT_LEAST(x, -FARTHEST);
    AT_MOST(x, FARTHEST);
    AT_LEAST(y, -FARTHEST);
    AT_MOST(y, FARTHEST);
    AT_LEAST(gyro_bias, -JP_Q24_ONE);
    AT_MOST(gyro_bias, JP_Q24_ONE);
    AT_LEAST(steering_ratio, JP_Q24(0.01));
    AT_MOST(steering_ratio, JP_Q24(8));
    AT_LEAST(bias, -INT32_MAX);
    TAKEN(bias, INT32_MAX);
    AT_LEAST(pitch_bias, -MOST_NODDED);
    AT_MOST(pitch_bias, MOST_NODDED);
    AT_LEAST(ratio, ONE / 16);
    TAKEN(ratio, INT32_MAX);
    AT_LEAST(scale, ONE / 2);
    AT_MOST(scale, ONE / 2 * 3);
    AT_LEAST(bias_bias, 1);
    AT_MOST(bias_bias, ONE);
    AT_LEAST(bias_ratio, -ONE);
    AT_MOST(bias_ratio, ONE);
    AT_LEAST(ratio_ratio, 1);
    AT_MOST(ratio_ratio, ONE);
    TAKEN(ran, 0);
    AT_MOST(ran, 1);
}

static void test_what_is_another_robots_is_refused(void)
{
    fill();
    REFUSED(tick_rate, config.odometry.tick_rate + 1U);
    REFUSED(tick_rate, config.odometry.tick_rate - 1U);
    REFUSED(way_per_count, config.odometry.way_per_count + 1);
    REFUSED(way_per_count, config.odometry.way_per_count - 1);
    expect_taken();
}

/* Snapshots of a drive: the robot goes on from there. */
static void test_a_drive_goes_on_where_it_was(void)
{
    make_driving();
    run(RATE);
    const struct jp_skid_snapshot kept = snapshot_now();

    TEST_ASSERT_TRUE(kept.x > (int64_t)1 << 30);
    init();
    TEST_ASSERT_TRUE(jp_skid_robot_resume(&robot, &kept));
    make_driving();
    run(RATE);
    TEST_ASSERT_INT64_WITHIN((int64_t)1 << 26, 2 * kept.x, telemetry().x);
}
