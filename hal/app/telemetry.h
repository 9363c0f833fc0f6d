/** What the application tells the operator: the frames of joulepath.dbc that are due in a tick. */
#ifndef JOULEPATH_HAL_APP_TELEMETRY_H
#define JOULEPATH_HAL_APP_TELEMETRY_H

#include <joulepath/version.h>

#include "hal/app/ecu_state.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Most frames of one tick: up to 5 of the schedule, which a tick of 10 ms holds, one that announces, and a result.
 * From 1 kHz on no tick holds more than one of the schedule. */
#define JP_TELEMETRY_FRAMES_MAX 7U

/** Fills in the frames that are due in this tick and returns their number. Constant time; for the control ISR. */
unsigned jp_telemetry_due(struct jp_ecu *ecu, struct jp_can_frame frames[JP_TELEMETRY_FRAMES_MAX]);

/** Reports of the background: SegmentMotion, SegmentShape and SegmentForecast; LearnerStatus. */
unsigned jp_telemetry_segment(const struct jp_ecu_segment *segment, struct jp_can_frame frames[JP_ECU_REPORT_FRAMES]);
void jp_telemetry_lessons(const struct jp_ecu_lessons *lessons, struct jp_can_frame *frame);

#ifdef __cplusplus
}
#endif

#endif
