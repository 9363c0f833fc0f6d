/* The rule's trajectories, driven set-point by set-point: where they lead, and what of voltage, lean and turn rate they
 * take where a robot has little. */
#include "src/base/integer.h"
#include "src/trajectory/trajectory_blend.h"
#include "tests/support/rule_rig.h"

/* Sums of set-points: 2⁻⁴⁰ m. */
struct place {
    int64_t x;
    int64_t y;
};

/* Where the robot is, and a set-point later. */
static struct place position;
static jp_angle heading;

static void begin_at_start(void)
{
    position = (struct place){(int64_t)task.start.x * (1 << 24), (int64_t)task.start.y * (1 << 24)};
    heading = task.heading;
}

/* A set-point's time along a chord in the mean heading, at the mean speed. */
static void step(const struct jp_set_point *from, const struct jp_set_point *to)
{
    const int64_t rate = (int64_t)config.tick_rate / (int64_t)JP_TICKS_PER_SET_POINT;
    const int64_t turn = ((int64_t)from->yaw_rate + to->yaw_rate) * (1 << 7) / rate; /* 2⁻³² turn */
    const jp_angle middle = heading + (jp_angle)(turn / 2);
    const int64_t rolled = (int64_t)from->wheel_rate + to->wheel_rate;
    const int32_t way = (int32_t)(rolled * ((int64_t)1 << 32) / config.turns_per_metre * (1 << 7) / rate); /* 2⁻⁴⁰ m */

    position.x += jp_multiply(way, jp_cos(middle)) >> 31;
    position.y += jp_multiply(way, jp_sin(middle)) >> 31;
    heading += (jp_angle)turn;
}

/* Within 3 mm and what it covers in a set-point. */
static void expect_passed(uint16_t target)
{
    const struct jp_waypoint_motion *next = &legs[target].next;
    const int32_t within = JP_Q16(0.003) + next->speed / (int32_t)config.tick_rate / 128;

    TEST_ASSERT_INT32_WITHIN(within, targets[target].x, (int32_t)(position.x >> 24));
    TEST_ASSERT_INT32_WITHIN(within, targets[target].y, (int32_t)(position.y >> 24));
    TEST_ASSERT_INT32_WITHIN(JP_ANGLE_DEGREES(0.4), 0, (int32_t)(heading - next->heading));
}

static void drive_to_the_end(void)
{
    struct jp_trajectory_drive drive;
    struct jp_set_point from;
    struct jp_set_point to;

    jp_trajectory_begin(&drive, &trajectory);
    begin_at_start();
    TEST_ASSERT_TRUE(jp_trajectory_advance(&drive, &config, &from));
    for (uint16_t leg = 0; leg < task.count;) {
        const bool is_driven = !jp_trajectory_advance(&drive, &config, &to);

        if (is_driven) {
            to = (struct jp_set_point){.wheel_rate = jp_q24_multiply(legs[leg].next.speed, config.turns_per_metre),
                                       .yaw_rate = legs[leg].next.turn_rate};
        }
        step(&from, &to);
        from = to;
        /* The first set-point of a leg is its waypoint's. */
        if (is_driven || (jp_trajectory_leg_now(&drive) > leg && drive.internal.share == legs[leg + 1U].begin.step)) {
            expect_passed(leg);
            leg++;
        }
    }
}

/* ---- Where it leads ---- */

static uint32_t state;

static int32_t any(int32_t low, int32_t high)
{
    state = state * 1664525U + 1013904223U;
    return low + (int32_t)(((uint64_t)state * (uint32_t)(high - low + 1)) >> 32);
}

/* 1.2 m to 3 m each, by up to 110° to either side. */
static void any_targets(uint16_t count)
{
    jp_angle direction = task.heading;
    struct jp_point at = task.start;

    for (unsigned i = 0; i < count; i++) {
        const jp_q16 length = any(JP_Q16(1.2), JP_Q16(3));

        direction += (jp_angle)(any(-110, 110) * (int32_t)JP_ANGLE_DEGREES(1));
        at.x += jp_multiply_shift(length, jp_cos(direction), 31);
        at.y += jp_multiply_shift(length, jp_sin(direction), 31);
        targets[i] = at;
    }
    task.count = count;
}

static void drive_routes(unsigned count)
{
    unsigned driven = 0;

    for (unsigned i = 0; i < count; i++) {
        task.start = (struct jp_point){any(-JP_Q16(5), JP_Q16(5)), any(-JP_Q16(5), JP_Q16(5))};
        task.heading = (jp_angle)any(-180, 180) * JP_ANGLE_DEGREES(1);
        task.to_stand = any(0, 1) == 1;
        any_targets(3);
        if (plan() == JP_OK) {
            drive_to_the_end();
            driven++;
        }
    }
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(count - 1U, driven);
}

static void test_leads_through_its_targets_from_rest(void)
{
    state = 1;
    drive_routes(4);
    config = jp_robot_gao2018.trajectory;
    drive_routes(4);
}

static void test_leads_through_its_targets_from_any_motion(void)
{
    state = 2;
    for (int i = 0; i < 6; i++) {
        config = i < 3 ? jp_robot_courier24.trajectory : jp_robot_gao2018.trajectory;
        task.motion = (struct jp_travel_state){.speed = any(-JP_Q24(0.4), JP_Q24(0.9)),
                                               .pitch = any(-JP_Q24(0.01), JP_Q24(0.01)),
                                               .pitch_rate = any(-JP_Q24(0.05), JP_Q24(0.05)),
                                               .turn_rate = any(-JP_Q24(0.1), JP_Q24(0.1))};
        drive_routes(1);
    }
}

/* Near targets: what the start left is not gone at the first of them. */
static void test_leads_on_while_the_start_decays(void)
{
    unsigned driven = 0;

    for (int i = 0; i < 12; i++) {
        config = i % 2 == 0 ? jp_robot_courier24.trajectory : jp_robot_gao2018.trajectory;
        targets[0] = (struct jp_point){JP_Q16(0.6) + i * JP_Q16(0.1), 0};
        targets[1] = (struct jp_point){targets[0].x + JP_Q16(1), JP_Q16(0.2)};
        targets[2] = (struct jp_point){targets[1].x + JP_Q16(1), -JP_Q16(0.1)};
        task.count = 3;
        task.motion.speed = JP_Q24(0.2) * (i % 4);
        if (plan() == JP_OK) {
            drive_to_the_end();
            driven++;
        }
    }
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(8, driven);
}

static void test_leads_through_what_is_given(void)
{
    state = 3;
    for (int i = 0; i < 6; i++) {
        config = i % 2 == 0 ? jp_robot_courier24.trajectory : jp_robot_gao2018.trajectory;
        task.to_stand = i < 3;
        any_targets(3);
        for (unsigned k = 0; k < 3U; k++) {
            passages[k] = (struct jp_passage){.given = (uint8_t)any(0, 3), .speed = any(JP_Q24(0.2), JP_Q24(0.6))};
            passages[k].heading = jp_atan2(targets[k].y, targets[k].x) + (jp_angle)any(-40, 40) * JP_ANGLE_DEGREES(1);
        }
        task.passages = passages;
        TEST_ASSERT_EQUAL_INT(JP_OK, plan());
        drive_to_the_end();
    }
}

/* ---- What it takes ---- */

struct peaks {
    int32_t volts; /* of one side */
    int32_t pitch;
    int32_t yaw_rate;
};

static int32_t larger(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

static void note_blend(const struct jp_blend *blend, struct peaks *most)
{
    struct jp_set_point at;

    for (int32_t i = 0; i <= 64; i++) {
        jp_blend_at(blend, i * (1 << 24), &at);
        most->volts = larger(most->volts, jp_absolute32(at.common) + jp_absolute32(at.difference));
        most->pitch = larger(most->pitch, jp_absolute32(at.pitch));
        most->yaw_rate = larger(most->yaw_rate, jp_absolute32(at.yaw_rate));
    }
}

static struct peaks peaks_of(uint16_t leg)
{
    struct peaks most = {0, 0, 0};

    note_blend(&legs[leg].begin, &most);
    note_blend(&legs[leg].end, &most);
    return most;
}

/* A robot that needs nothing for its motion, with much of everything, in motion already. */
static void be_strong(void)
{
    for (unsigned i = 0; i < 4U; i++) {
        config.volts[i] = 0;
    }
    config.lean[0] = 0;
    config.lean[1] = 0;
    config.turning[0] = 0;
    config.turning[1] = 0;
    config.voltage = JP_Q16(512);
    config.pitch = JP_Q24(0.125);
    config.turn_rate = JP_Q24(64);
    config.blend = JP_Q16(1);
    for (unsigned i = 0; i < 3U * JP_TRAVEL_MODES; i++) {
        config.modes.share[i] = 0;
    }
}

/* As fast as the limit allows: not above it, and slower than the cruise not much below it. */
static void expect_near(int32_t limit, int32_t peak, int32_t percent)
{
    TEST_ASSERT_LESS_OR_EQUAL_INT32(limit + limit / 500 + 2, peak);
    TEST_ASSERT_GREATER_OR_EQUAL_INT32((int32_t)((int64_t)limit * percent / 100), peak);
}

/* A robot that needs voltage for one derivative of its speed alone. */
static void stop_with(unsigned derivative, jp_q16 volts, int32_t percent)
{
    be_strong();
    config.volts[derivative] = volts;
    for (int i = 0; i < 8; i++) {
        targets[0].x = JP_Q16(0.5) + i * JP_Q16(0.07);
        config.voltage = JP_Q16(1) + i * JP_Q16(0.05);
        TEST_ASSERT_EQUAL_INT(JP_OK, plan());
        TEST_ASSERT_LESS_THAN_INT32(task.cruise, legs[0].speed);
        expect_near(config.voltage, peaks_of(0).volts, percent);
    }
}

static void test_a_leg_stops_with_the_voltage_there_is(void)
{
    task.cruise = JP_Q24(0.9);
    stop_with(1, JP_Q16(1.1), 90);
    stop_with(2, JP_Q16(0.3), 85);
    stop_with(3, JP_Q16(0.04), 80);
}

static void test_a_leg_stops_with_the_lean_there_is(void)
{
    task.cruise = JP_Q24(0.9);
    be_strong();
    config.lean[1] = JP_Q24(0.1);
    for (int i = 0; i < 8; i++) {
        targets[0].x = JP_Q16(0.5) + i * JP_Q16(0.07);
        config.pitch = JP_Q24(0.09) + i * JP_Q24(0.003);
        TEST_ASSERT_EQUAL_INT(JP_OK, plan());
        TEST_ASSERT_LESS_THAN_INT32(task.cruise, legs[0].speed);
        expect_near(config.pitch, peaks_of(0).pitch, 90);
    }
}

/* At a slow passage, the faster of two legs. */
static void test_a_leg_leaves_a_slow_passage_with_what_there_is(void)
{
    task.cruise = JP_Q24(0.9);
    be_strong();
    task.count = 2;
    config.volts[1] = JP_Q16(1.1);
    for (int i = 0; i < 8; i++) {
        targets[1].x = targets[0].x + JP_Q16(0.5) + i * JP_Q16(0.07);
        task.to_stand = false;
        give(0, 0, JP_Q24(0.1));
        config.voltage = JP_Q16(0.8) + i * JP_Q16(0.04);
        TEST_ASSERT_EQUAL_INT(JP_OK, plan());
        TEST_ASSERT_LESS_THAN_INT32(task.cruise, legs[1].speed);
        expect_near(config.voltage, peaks_of(1).volts, 90);
    }
}

/* A square corner between legs that are too short for it at the cruise. The line between their blends is up to 10° off
 * the chord, for which voltage is looked at: it takes `most` % of that, and of an acceleration the more. */
static void turn_with(unsigned derivative, jp_q16 volts, int32_t most)
{
    task.cruise = JP_Q24(0.9);
    be_strong();
    config.turning[derivative] = volts;
    task.count = 2;
    task.to_stand = false;
    for (int i = 0; i < 6; i++) {
        targets[0] = (struct jp_point){JP_Q16(3), 0};
        targets[1] = (struct jp_point){JP_Q16(3), JP_Q16(0.3) + i * JP_Q16(0.02)};
        config.voltage = JP_Q16(1) + i * JP_Q16(0.1);
        TEST_ASSERT_EQUAL_INT(JP_OK, plan());
        TEST_ASSERT_LESS_THAN_INT32(task.cruise, legs[1].speed);
        expect_near(config.voltage * most / 100, peaks_of(1).volts, 85 * 100 / most);
    }
}

static void test_a_corner_is_turned_with_the_voltage_there_is(void)
{
    turn_with(0, JP_Q16(4), 113);
    turn_with(1, JP_Q16(1.5), 150);
}

static void test_a_corner_is_turned_as_fast_as_gyro_and_wheels_can(void)
{
    task.cruise = JP_Q24(0.9);
    be_strong();
    task.count = 2;
    task.to_stand = false;
    for (int i = 0; i < 6; i++) {
        targets[0] = (struct jp_point){JP_Q16(3), 0};
        targets[1] = (struct jp_point){JP_Q16(3), JP_Q16(0.3) + i * JP_Q16(0.02)};
        config.turn_rate = JP_Q24(0.25) + i * JP_Q24(0.03);
        TEST_ASSERT_EQUAL_INT(JP_OK, plan());
        TEST_ASSERT_LESS_THAN_INT32(task.cruise, legs[1].speed);
        expect_near(config.turn_rate * 9 / 8, peaks_of(1).yaw_rate, 75);
    }
}
