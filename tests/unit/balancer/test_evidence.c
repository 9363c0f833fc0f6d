/* What may be believed of a segment: each reason at its limit, which one comes first, counters that wrap. */
#include <joulepath/evidence.h>

#include "unity.h"

#define TICKS 5000U

static struct jp_segment_watch watch;
static struct jp_telemetry telemetry;

void setUp(void)
{
    telemetry = (struct jp_telemetry){
        .tick = UINT32_MAX - 1000U, .dropped_frames = UINT32_MAX - 5U, .saturated_ticks = 700, .segments_ended = 3};
    jp_segment_watch_begin(&watch, &telemetry);
}

void tearDown(void)
{
}

static void end_segment(void)
{
    telemetry.tick += TICKS;
    telemetry.segments_ended++;
}

static void expect(enum jp_evidence of_motors, enum jp_evidence of_battery)
{
    TEST_ASSERT_EQUAL_INT(of_motors, jp_segment_evidence(&watch, &telemetry, false));
    TEST_ASSERT_EQUAL_INT(of_battery, jp_segment_evidence(&watch, &telemetry, true));
}

static void test_believes_an_undisturbed_segment(void)
{
    end_segment();
    jp_segment_watch_note(&watch, 0, 0);
    expect(JP_EVIDENCE_GOOD, JP_EVIDENCE_GOOD);
}

static void test_a_segment_must_have_ended(void)
{
    telemetry.tick += TICKS;
    expect(JP_EVIDENCE_INCOMPLETE, JP_EVIDENCE_INCOMPLETE);
}

static void test_only_one_segment_must_have_ended(void)
{
    end_segment();
    telemetry.segments_ended++;
    expect(JP_EVIDENCE_INCOMPLETE, JP_EVIDENCE_INCOMPLETE);
}

/* It counts from 0 again when the robot stood. */
static void test_segments_of_another_drive_are_others(void)
{
    end_segment();
    telemetry.segments_ended = 0;
    expect(JP_EVIDENCE_INCOMPLETE, JP_EVIDENCE_INCOMPLETE);
}

static void test_believes_nothing_once_the_segments_are_no_longer_counted(void)
{
    telemetry.segments_ended = UINT16_MAX;
    jp_segment_watch_begin(&watch, &telemetry);
    telemetry.tick += TICKS;
    expect(JP_EVIDENCE_INCOMPLETE, JP_EVIDENCE_INCOMPLETE);
}

static void test_a_hundredth_of_the_frames_may_be_dropped(void)
{
    end_segment();
    telemetry.dropped_frames += TICKS / 100U;
    expect(JP_EVIDENCE_GOOD, JP_EVIDENCE_GOOD);
    telemetry.dropped_frames++;
    expect(JP_EVIDENCE_DROPPED, JP_EVIDENCE_DROPPED);
}

static void test_a_fiftieth_of_the_ticks_may_be_limited(void)
{
    end_segment();
    telemetry.saturated_ticks += TICKS / 50U;
    expect(JP_EVIDENCE_GOOD, JP_EVIDENCE_GOOD);
    telemetry.saturated_ticks++;
    expect(JP_EVIDENCE_SATURATED, JP_EVIDENCE_SATURATED);
}

static void expect_battery(uint8_t flag)
{
    jp_segment_watch_begin(&watch, &telemetry);
    jp_segment_watch_note(&watch, flag, 0);
    jp_segment_watch_note(&watch, 0, 0);
    end_segment();
    expect(JP_EVIDENCE_BATTERY, JP_EVIDENCE_BATTERY);
}

static void test_any_flag_of_the_battery_counts_however_short(void)
{
    for (unsigned bit = 0; bit < 6U; bit++) {
        expect_battery((uint8_t)(1U << bit));
    }
}

static void expect_findings(uint8_t findings, enum jp_evidence of_battery)
{
    jp_segment_watch_begin(&watch, &telemetry);
    jp_segment_watch_note(&watch, 0, findings);
    jp_segment_watch_note(&watch, 0, 0);
    end_segment();
    expect(JP_EVIDENCE_GOOD, of_battery);
}

static void test_doubtful_currents_spoil_the_energy_of_the_battery(void)
{
    expect_findings(JP_CURRENT_OFFSET_LEFT, JP_EVIDENCE_CURRENT);
    expect_findings(JP_CURRENT_OFFSET_RIGHT, JP_EVIDENCE_CURRENT);
    expect_findings(JP_CURRENT_GAIN_LEFT, JP_EVIDENCE_CURRENT);
    expect_findings(JP_CURRENT_GAIN_RIGHT, JP_EVIDENCE_CURRENT);
    expect_findings(JP_CURRENT_CHANGING, JP_EVIDENCE_CURRENT);
    expect_findings(JP_CURRENT_RESISTANCE, JP_EVIDENCE_GOOD);
    expect_findings(JP_CURRENT_RESISTANCE | JP_CURRENT_OFFSET_LEFT, JP_EVIDENCE_CURRENT);
}

static void test_the_first_reason_is_told(void)
{
    jp_segment_watch_note(&watch, 1, JP_CURRENT_OFFSET_LEFT);
    telemetry.tick += TICKS;
    telemetry.dropped_frames += TICKS;
    telemetry.saturated_ticks += TICKS;
    expect(JP_EVIDENCE_INCOMPLETE, JP_EVIDENCE_INCOMPLETE);
    telemetry.segments_ended++;
    expect(JP_EVIDENCE_DROPPED, JP_EVIDENCE_DROPPED);
    telemetry.dropped_frames -= TICKS;
    expect(JP_EVIDENCE_SATURATED, JP_EVIDENCE_SATURATED);
    telemetry.saturated_ticks -= TICKS;
    expect(JP_EVIDENCE_BATTERY, JP_EVIDENCE_BATTERY);
}

static void test_a_new_segment_begins_without_a_doubt(void)
{
    jp_segment_watch_note(&watch, 1, JP_CURRENT_OFFSET_LEFT);
    end_segment();
    jp_segment_watch_begin(&watch, &telemetry);
    end_segment();
    expect(JP_EVIDENCE_GOOD, JP_EVIDENCE_GOOD);
}
