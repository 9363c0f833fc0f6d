/**
 * Decides whether the measured energy of a segment can be believed. A learner (learner.h) must only learn from a robot
 * that drove as its model assumes, measured by sensors that work.
 *
 * From the background loop, with what jp_robot_telemetry() copied:
 *
 *   jp_segment_watch_begin()   when telemetry.segment shows that the segment began
 *   jp_segment_watch_note()    in every pass, with what jp_battery_update() and jp_current_check_update() returned
 *   jp_segment_evidence()      when telemetry.segments_ended shows that it ended
 *
 * The telemetry of a segment's end is that of the next one's begin. Few instructions each, no loop; not for ISRs.
 */
#ifndef JOULEPATH_EVIDENCE_H
#define JOULEPATH_EVIDENCE_H

#include <joulepath/robot.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The first reason not to believe a measured energy, in the order in which they are checked. */
enum jp_evidence {
    JP_EVIDENCE_GOOD,
    JP_EVIDENCE_INCOMPLETE, /**< not exactly one segment ended since it began: a stop, a fall, a fault, or two ends
                                 between two reads; telemetry.segment_energy_… is that of another segment */
    JP_EVIDENCE_DROPPED,    /**< more than 1/JP_EVIDENCE_DROPPED_SHARE of the ticks had no plausible frame */
    JP_EVIDENCE_SATURATED,  /**< in more than 1/JP_EVIDENCE_SATURATED_SHARE of the ticks a voltage was limited */
    JP_EVIDENCE_BATTERY,    /**< the battery was at its limits, or its voltage implausible: any jp_battery_flag */
    JP_EVIDENCE_CURRENT     /**< a current sensor was in doubt: JP_CURRENT_DOUBT; for the battery's energy only */
};
#define JP_EVIDENCES 6

#define JP_EVIDENCE_DROPPED_SHARE   100U
#define JP_EVIDENCE_SATURATED_SHARE 50U

/** Private. */
struct jp_segment_watch {
    uint32_t tick;
    uint32_t dropped_frames;
    uint32_t saturated_ticks;
    uint16_t segments_ended;
    uint8_t battery_flags;
    uint8_t current_findings;
};

/** Begins to watch a segment, with the telemetry of its begin. */
void jp_segment_watch_begin(struct jp_segment_watch *watch, const struct jp_telemetry *telemetry);

/** Keeps what this pass found: jp_battery_flag and jp_current_finding bits, 0 where there is no such check. */
void jp_segment_watch_note(struct jp_segment_watch *watch, uint8_t battery_flags, uint8_t current_findings);

/** Judges the segment at its end. `of_battery`: its energy is jp_meter.battery, which depends on the currents. */
enum jp_evidence jp_segment_evidence(const struct jp_segment_watch *watch, const struct jp_telemetry *telemetry,
                                     bool of_battery);

#ifdef __cplusplus
}
#endif

#endif
