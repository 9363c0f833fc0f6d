/* What is learned of a drive: which segments, from which start, and what is left out. The learner must end up as one
 * that is fed by hand. */
#include <joulepath/drive_watch.h>
#include <joulepath/tables.h>

#include <string.h>

#include "unity.h"

#define MODEL    jp_energy_model_courier24
#define HORIZON  jp_horizon_courier24
#define LEARNING jp_learning_courier24

#define RATE 1000U
#define PASS 20U /* ticks from one look to the next */

#define IMPLAUSIBLE 64U /* any jp_battery_flag */

static struct jp_learner learner;
static struct jp_drive_watch watch;
static struct jp_telemetry telemetry;

/* By hand. */
static struct jp_learner expected;
static struct jp_energy_start start;
static uint32_t learned_from;
static uint32_t left_out;

static const struct jp_energy_start settled = {{0, 0}, {{0}, {0}}};
static const struct jp_segment_command straight = {{JP_Q24(0.6), 0}, 0, JP_Q16(3)};
static const struct jp_segment_command curve = {{JP_Q24(0.4), JP_Q24(0.25)}, JP_Q24(0.3), JP_Q16(2.5)};
static const struct jp_segment_command back = {{-JP_Q24(0.5), 0}, JP_Q24(0.8), JP_Q16(4)};

static bool look_with(uint8_t battery_flags, uint8_t current_findings)
{
    return jp_drive_watch_update(&watch, &telemetry, battery_flags, current_findings);
}

static bool look(void)
{
    return look_with(0, 0);
}

static void begin_with(const struct jp_horizon *horizon, bool of_battery)
{
    jp_learner_start(&learner, &LEARNING, &MODEL, horizon);
    jp_drive_watch_start(&watch, &learner, RATE, of_battery);
    expected = learner;
    start = settled;
    learned_from = 0;
    left_out = 0;
    telemetry = (struct jp_telemetry){.state = JP_ROBOT_BALANCING, .tick = UINT32_MAX - 2U * RATE};
    TEST_ASSERT_FALSE(look());
}

void setUp(void)
{
    begin_with(&HORIZON, false);
}

void tearDown(void)
{
}

/* The robot */

static void pass_time(uint32_t ticks)
{
    for (uint32_t passed = 0; passed < ticks; passed += PASS) {
        telemetry.tick += PASS;
        telemetry.segment_ticks_left -= telemetry.state == JP_ROBOT_DRIVING ? PASS : 0U;
        TEST_ASSERT_FALSE(look());
    }
}

/* At the tick after the last look. */
static void begin(const struct jp_segment_command *command)
{
    if (telemetry.state != JP_ROBOT_DRIVING) {
        telemetry.segment = 0;
        telemetry.segments_ended = 0;
    }
    telemetry.state = JP_ROBOT_DRIVING;
    telemetry.segment++;
    telemetry.command = command->motion;
    telemetry.segment_ticks_left = (uint32_t)(command->duration >> 8) * RATE >> 8;
}

static void go_to_end(void)
{
    pass_time(telemetry.segment_ticks_left - telemetry.segment_ticks_left % PASS);
    telemetry.tick += telemetry.segment_ticks_left;
    telemetry.segment_ticks_left = 0;
}

static void end(jp_q16 energy)
{
    telemetry.segments_ended++;
    telemetry.segment_energy_model = (jp_energy)energy * JP_Q16_ONE;
    telemetry.segment_energy_battery = (jp_energy)energy * (JP_Q16_ONE / 2);
}

static void stand(void)
{
    telemetry.state = JP_ROBOT_BALANCING;
    telemetry.segment_ticks_left = 0;
    telemetry.command = settled.motion;
}

/* What the learner expects and more. */
static jp_q16 energy_of(const struct jp_segment_command *command)
{
    struct jp_energy_start after = start;
    jp_q16 energy = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_energy_forecast(&MODEL, &HORIZON, &start, command, &energy, &after));
    return jp_add(energy, energy / 16);
}

static void drive(const struct jp_segment_command *command)
{
    jp_drive_watch_command(&watch, command);
    begin(command);
    TEST_ASSERT_TRUE(look());
    go_to_end();
    end(energy_of(command));
}

static void drive_and_stand(const struct jp_segment_command *command)
{
    drive(command);
    stand();
    TEST_ASSERT_FALSE(look());
}

/* By hand */

static void pass_by_hand(const struct jp_segment_command *command)
{
    jp_q16 energy;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_energy_forecast(&MODEL, &HORIZON, &start, command, &energy, &start));
}

static void learn_by_hand(const struct jp_segment_command *command)
{
    enum jp_learned learned;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learner_update(&expected, &start, command, energy_of(command), &learned));
    TEST_ASSERT_EQUAL_INT(JP_LEARNED, learned);
    learned_from++;
    pass_by_hand(command);
}

static void stand_by_hand(jp_q16 duration)
{
    const struct jp_segment_command still = {{0, 0}, 0, duration};

    pass_by_hand(&still);
}

static void expect_learned(void)
{
    TEST_ASSERT_EQUAL_UINT32(learned_from, watch.learned_from);
    TEST_ASSERT_EQUAL_UINT32(left_out, watch.left_out);
    TEST_ASSERT_EQUAL_MEMORY(&expected.state, &learner.state, sizeof expected.state);
    if (learned_from > 0U) {
        TEST_ASSERT_EQUAL_INT(JP_LEARNED, watch.learned);
    }
}

static void expect_left_out(enum jp_evidence evidence)
{
    left_out++;
    TEST_ASSERT_EQUAL_INT(evidence, watch.evidence);
    expect_learned();
}

static void expect_next_start(bool known)
{
    struct jp_energy_start next;

    TEST_ASSERT_EQUAL_INT(known, jp_drive_watch_next_start(&watch, &telemetry, &next));
    if (known) {
        TEST_ASSERT_EQUAL_MEMORY(&start, &next, sizeof start);
    }
}

/* ---- What is learned ---- */

static void test_nothing_is_learned_from_a_stand(void)
{
    pass_time(10U * RATE);
    expect_learned();
    TEST_ASSERT_FALSE(watch.driving);
}

static void test_a_segment_is_learned_when_it_has_ended(void)
{
    jp_drive_watch_command(&watch, &straight);
    begin(&straight);
    TEST_ASSERT_TRUE(look());
    TEST_ASSERT_TRUE(watch.driving);
    go_to_end();
    expect_learned();
    end(energy_of(&straight));
    stand();
    TEST_ASSERT_FALSE(look());
    TEST_ASSERT_FALSE(watch.driving);
    learn_by_hand(&straight);
    expect_learned();
    TEST_ASSERT_EQUAL_INT(JP_EVIDENCE_GOOD, watch.evidence);
}

/* Each begins with what the one before has left. */
static void test_a_chain_of_segments(void)
{
    drive(&straight);
    learn_by_hand(&straight);
    TEST_ASSERT_NOT_EQUAL(0, start.transient.travel[0]);
    drive(&curve);
    learn_by_hand(&curve);
    drive(&back);
    learn_by_hand(&back);
    drive_and_stand(&straight);
    learn_by_hand(&straight);
    expect_learned();
}

static void test_a_stand_between_segments_is_part_of_the_chain(void)
{
    drive_and_stand(&straight);
    learn_by_hand(&straight);
    pass_time(RATE + 5U * PASS);
    stand_by_hand((jp_q16)((RATE + 5U * PASS) * 65536ULL / RATE));
    TEST_ASSERT_NOT_EQUAL(0, start.transient.travel[0]);
    drive_and_stand(&curve);
    learn_by_hand(&curve);
    expect_learned();
}

/* Shorter than what the horizon tells, it is taken for so long. */
static void test_a_short_stand(void)
{
    drive_and_stand(&straight);
    learn_by_hand(&straight);
    pass_time(2U * PASS);
    stand_by_hand(HORIZON.duration_min);
    drive_and_stand(&curve);
    learn_by_hand(&curve);
    expect_learned();
}

static void test_after_a_long_stand_nothing_is_left(void)
{
    drive_and_stand(&straight);
    learn_by_hand(&straight);
    telemetry.tick += 0xF0000000U;
    start = settled;
    drive_and_stand(&curve);
    learn_by_hand(&curve);
    expect_learned();
}

/* The plan came late, and the robot stood for less than a pass: its counts are as before. */
static void test_a_stand_that_nobody_saw(void)
{
    drive(&straight);
    pass_by_hand(&straight);
    stand();
    drive(&curve);
    expect_left_out(JP_EVIDENCE_INCOMPLETE);
    stand();
    (void)look();
    learn_by_hand(&curve);
    expect_learned();
}

static void test_the_command_told_last_counts(void)
{
    jp_drive_watch_command(&watch, &back);
    drive_and_stand(&straight);
    learn_by_hand(&straight);
    expect_learned();
}

static void test_the_battery_has_an_energy_of_its_own(void)
{
    enum jp_learned learned;

    begin_with(&HORIZON, true);
    drive_and_stand(&straight);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learner_update(&expected, &settled, &straight, energy_of(&straight) / 2, &learned));
    TEST_ASSERT_EQUAL_INT(learned, watch.learned);
    TEST_ASSERT_EQUAL_UINT32(1, watch.learned_from);
    TEST_ASSERT_EQUAL_MEMORY(&expected.state, &learner.state, sizeof expected.state);
}

static void test_an_outlier_is_the_learners_business(void)
{
    drive(&straight);
    telemetry.segment_energy_model *= 3;
    stand();
    (void)look();
    TEST_ASSERT_EQUAL_INT(JP_LEARNED_OUTLIER, watch.learned);
    TEST_ASSERT_EQUAL_UINT32(1, watch.learned_from);
    TEST_ASSERT_EQUAL_UINT32(1, learner.rejected);
}

/* ---- What is left out ---- */

static void drive_untold(const struct jp_segment_command *command)
{
    begin(command);
    TEST_ASSERT_TRUE(look());
    go_to_end();
    end(JP_Q16(20));
}

static void stand_and_look(void)
{
    stand();
    (void)look();
}

static void test_a_segment_that_nobody_told(void)
{
    drive_untold(&straight);
    stand_and_look();
    expect_left_out(JP_EVIDENCE_GOOD);
}

static void test_another_segment_than_was_told(void)
{
    jp_drive_watch_command(&watch, &straight);
    drive_untold(&curve);
    stand_and_look();
    expect_left_out(JP_EVIDENCE_GOOD);
    pass_time(10U * RATE);
    jp_drive_watch_command(&watch, &curve);
    drive_untold(&(struct jp_segment_command){{JP_Q24(0.4), JP_Q24(0.2)}, 0, JP_Q16(2)});
    stand_and_look();
    expect_left_out(JP_EVIDENCE_GOOD);
}

/* How the ones after it begin nobody knows, until the robot has stood for long enough. */
static void test_what_follows_an_unknown_segment(void)
{
    drive_untold(&straight);
    (void)look();
    drive(&curve);
    expect_left_out(JP_EVIDENCE_GOOD);
    expect_next_start(false);
    stand_and_look();
    expect_left_out(JP_EVIDENCE_GOOD);
    expect_next_start(false);
    pass_time((uint32_t)(MODEL.settling_time >> 16) * RATE - PASS);
    expect_next_start(false);
    pass_time(RATE + PASS);
    start = settled;
    expect_next_start(true);
    drive_and_stand(&straight);
    learn_by_hand(&straight);
    expect_learned();
}

static void test_a_stop(void)
{
    jp_drive_watch_command(&watch, &straight);
    begin(&straight);
    (void)look();
    pass_time(RATE);
    stand_and_look();
    expect_left_out(JP_EVIDENCE_INCOMPLETE);
    pass_by_hand(&(struct jp_segment_command){straight.motion, 0, JP_Q16(1)});
    pass_time(RATE);
    stand_by_hand(JP_Q16(1));
    expect_next_start(true);
    drive_and_stand(&curve);
    learn_by_hand(&curve);
    expect_learned();
}

static void test_a_fall_and_a_new_start(void)
{
    drive(&straight);
    learn_by_hand(&straight);
    drive(&curve);
    telemetry.segments_ended--;
    telemetry.state = JP_ROBOT_FALLEN;
    telemetry.segment_ticks_left = 0;
    TEST_ASSERT_FALSE(look());
    expect_left_out(JP_EVIDENCE_INCOMPLETE);
    telemetry.state = JP_ROBOT_IDLE;
    pass_time(PASS);
    stand();
    pass_time(PASS);
    start = settled;
    stand_by_hand(JP_Q16(0.5));
    drive_and_stand(&back);
    learn_by_hand(&back);
    expect_learned();
}

static void test_evidence_that_is_not_good(void)
{
    drive(&straight);
    telemetry.dropped_frames = 1000;
    stand_and_look();
    expect_left_out(JP_EVIDENCE_DROPPED);
    drive(&straight);
    telemetry.saturated_ticks = 1000;
    stand_and_look();
    expect_left_out(JP_EVIDENCE_SATURATED);
}

/* Bits of any pass count, also of the last one; those before the segment do not. */
static void test_flags_of_battery_and_currents(void)
{
    (void)look_with(IMPLAUSIBLE, JP_CURRENT_OFFSET_LEFT);
    drive(&straight);
    stand_and_look();
    learn_by_hand(&straight);
    expect_learned();
    pass_time(RATE);
    stand_by_hand(JP_Q16(1));
    drive(&curve);
    (void)look_with(IMPLAUSIBLE, 0);
    stand_and_look();
    expect_left_out(JP_EVIDENCE_BATTERY);
    begin_with(&HORIZON, true);
    drive(&straight);
    stand();
    (void)look_with(0, JP_CURRENT_OFFSET_LEFT);
    expect_left_out(JP_EVIDENCE_CURRENT);
}

/* The learner refuses it; the next start is not known. */
static void test_a_segment_too_short_for_the_horizon(void)
{
    static const struct jp_segment_command brief = {{JP_Q24(0.2), 0}, 0, JP_Q16(0.25)};

    jp_drive_watch_command(&watch, &brief);
    begin(&brief);
    (void)look();
    go_to_end();
    end(JP_Q16(2));
    (void)look();
    expect_next_start(false);
    drive(&straight);
    expect_left_out(JP_EVIDENCE_GOOD);
    stand_and_look();
    expect_left_out(JP_EVIDENCE_GOOD);
}

static void test_counts_saturate(void)
{
    watch.left_out = UINT32_MAX;
    watch.learned_from = UINT32_MAX - 1U;
    drive_untold(&straight);
    stand_and_look();
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, watch.left_out);
    pass_time(60U * RATE);
    drive_and_stand(&straight);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, watch.learned_from);
    pass_time(60U * RATE);
    drive_and_stand(&straight);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, watch.learned_from);
}

/* ---- Without a horizon ---- */

static void learn_settled(const struct jp_segment_command *command, jp_q16 energy)
{
    enum jp_learned learned;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_learner_update(&expected, &start, command, energy, &learned));
    learned_from++;
    start.motion = command->motion;
}

static void drive_for(const struct jp_segment_command *command, jp_q16 energy)
{
    jp_drive_watch_command(&watch, command);
    begin(command);
    (void)look();
    go_to_end();
    end(energy);
}

static void test_without_a_horizon_segments_that_settle_are_learned(void)
{
    const struct jp_segment_command one = {{JP_Q24(0.6), 0}, 0, MODEL.settling_time + JP_Q16(1)};
    const struct jp_segment_command two = {{JP_Q24(0.4), JP_Q24(0.2)}, JP_Q24(0.3), MODEL.settling_time};

    begin_with(NULL, false);
    pass_time(20U * RATE);
    drive_for(&one, JP_Q16(50));
    drive_for(&two, JP_Q16(30));
    stand_and_look();
    learn_settled(&one, JP_Q16(50));
    learn_settled(&two, JP_Q16(30));
    TEST_ASSERT_EQUAL_UINT32(learned_from, watch.learned_from);
    TEST_ASSERT_EQUAL_MEMORY(&expected.state, &learner.state, sizeof expected.state);
    start = settled;
    expect_next_start(false); /* it has only just stopped */
    pass_time(20U * RATE);
    expect_next_start(true);
    drive_for(&one, JP_Q16(50));
    stand_and_look();
    learn_settled(&one, JP_Q16(50));
    TEST_ASSERT_EQUAL_UINT32(learned_from, watch.learned_from);
    TEST_ASSERT_EQUAL_MEMORY(&expected.state, &learner.state, sizeof expected.state);
    TEST_ASSERT_EQUAL_UINT32(0, watch.left_out);
}

static void test_without_a_horizon_short_segments_are_left_out(void)
{
    const struct jp_segment_command brief = {{JP_Q24(0.4), 0}, 0, JP_Q16(1)};

    begin_with(NULL, false);
    pass_time(20U * RATE);
    drive_for(&brief, JP_Q16(5));
    (void)look();
    stand_and_look();
    TEST_ASSERT_EQUAL_UINT32(0, watch.learned_from);
    TEST_ASSERT_EQUAL_UINT32(1, watch.left_out);
}

/* ---- The next start ---- */

static void test_the_next_start_is_known_while_driving(void)
{
    jp_drive_watch_command(&watch, &straight);
    begin(&straight);
    (void)look();
    pass_by_hand(&straight);
    expect_next_start(true);
    pass_time(RATE);
    expect_next_start(true);
}

/* What is not known is guessed: settled at the motion of the present segment. */
static void test_a_guess_has_the_motion(void)
{
    struct jp_energy_start next;

    begin(&curve);
    (void)look();
    TEST_ASSERT_FALSE(jp_drive_watch_next_start(&watch, &telemetry, &next));
    TEST_ASSERT_EQUAL_INT32(curve.motion.speed, next.motion.speed);
    TEST_ASSERT_EQUAL_INT32(curve.motion.turn_rate, next.motion.turn_rate);
}
