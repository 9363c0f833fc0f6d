/**
 * May the measured energy of a segment be believed? What a learner (learner.h) is fed must have come from a robot that
 * drove as its model assumes, measured by sensors that work.
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

/** The first reason not to believe a measured energy. */
enum jp_evidence {
    JP_EVIDENCE_GOOD,
    JP_EVIDENCE_INCOMPLETE, /**< not this segment and no other ended since it began: a stop, a fall, a fault, or two
                                 ends between two looks; telemetry.segment_energy_… is another one's */
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

/** A segment begins. */
void jp_segment_watch_begin(struct jp_segment_watch *watch, const struct jp_telemetry *telemetry);

/** Keeps what was found in this pass: jp_battery_flag and jp_current_finding bits, 0 where there is nobody to ask. */
void jp_segment_watch_note(struct jp_segment_watch *watch, uint8_t battery_flags, uint8_t current_findings);

/** Judges the segment at its end. `of_battery`: its energy is jp_meter.battery, which needs the currents. */
enum jp_evidence jp_segment_evidence(const struct jp_segment_watch *watch, const struct jp_telemetry *telemetry,
                                     bool of_battery);

#ifdef __cplusplus
}
#endif

#endif
