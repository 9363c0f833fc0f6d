#include <joulepath/evidence.h>

void jp_segment_watch_begin(struct jp_segment_watch *watch, const struct jp_telemetry *telemetry)
{
    *watch = (struct jp_segment_watch){
        .tick = telemetry->tick,
        .dropped_frames = telemetry->dropped_frames,
        .saturated_ticks = telemetry->saturated_ticks,
        .segments_ended = telemetry->segments_ended,
    };
}

void jp_segment_watch_note(struct jp_segment_watch *watch, uint8_t battery_flags, uint8_t current_findings)
{
    watch->battery_flags |= battery_flags;
    watch->current_findings |= current_findings;
}

enum jp_evidence jp_segment_evidence(const struct jp_segment_watch *watch, const struct jp_telemetry *telemetry,
                                     bool of_battery)
{
    const uint32_t ticks = telemetry->tick - watch->tick;

    if (telemetry->segments_ended != watch->segments_ended + 1U) {
        return JP_EVIDENCE_INCOMPLETE;
    }
    if (telemetry->dropped_frames - watch->dropped_frames > ticks / JP_EVIDENCE_DROPPED_SHARE) {
        return JP_EVIDENCE_DROPPED;
    }
    if (telemetry->saturated_ticks - watch->saturated_ticks > ticks / JP_EVIDENCE_SATURATED_SHARE) {
        return JP_EVIDENCE_SATURATED;
    }
    if (watch->battery_flags != 0U) {
        return JP_EVIDENCE_BATTERY;
    }
    return of_battery && (watch->current_findings & JP_CURRENT_DOUBT) != 0U ? JP_EVIDENCE_CURRENT : JP_EVIDENCE_GOOD;
}
