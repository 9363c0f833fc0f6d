/**
 * Follows the segments that a robot drives, and lets a learner (learner.h) learn from those whose measured energy may
 * be believed (evidence.h).
 *
 *   jp_drive_watch_command()  when a segment was handed to the robot: by jp_robot_drive(), or by jp_robot_work(), which
 *                             then has counted jp_robot_segments_planned() on and shows it by jp_robot_planned()
 *   jp_drive_watch_update()   in every pass of the background loop, with what jp_robot_telemetry() copied
 *
 * Both from one context. How the robot moves when a segment begins is computed from one segment to the next, over
 * stands between them (jp_energy_forecast()). A segment that nobody told, and those that follow it without a stand of
 * model->settling_time, are not learned from. A robot that has just been switched on is taken to be settled.
 */
#ifndef JOULEPATH_DRIVE_WATCH_H
#define JOULEPATH_DRIVE_WATCH_H

#include <joulepath/evidence.h>
#include <joulepath/learner.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Private but for the members with a comment. */
struct jp_drive_watch {
    struct jp_learner *learner;
    uint32_t tick_rate;
    bool of_battery;
    bool driving;              /**< a segment is being driven */
    enum jp_evidence evidence; /**< of the last segment that ended */
    enum jp_learned learned;   /**< what became of the last one that the learner took, once learned_from > 0 */
    uint32_t learned_from;     /**< segments that the learner took, outliers too; saturating */
    uint32_t left_out;         /**< segments that ended otherwise, saturating */
    bool commanded;            /* `next` was handed over and has not begun */
    bool known;                /* start and command are what they say */
    uint32_t begin_tick;
    uint32_t end_tick;
    struct jp_segment_command next;
    struct jp_segment_command command; /* being driven; zero: a stand */
    struct jp_energy_start start;      /* of it */
    struct jp_segment_watch segment;
};

/** Starts with nothing driven. The learner must have been started and must outlive the watch; tick_rate in Hz, above 0.
 *  `of_battery`: it learns from jp_meter.battery, else from jp_meter.model. */
void jp_drive_watch_start(struct jp_drive_watch *watch, struct jp_learner *learner, uint32_t tick_rate,
                          bool of_battery);

/** Notes that this segment was handed to the robot and will begin; it replaces one that has not begun. */
void jp_drive_watch_command(struct jp_drive_watch *watch, const struct jp_segment_command *command);

/**
 * Looks at what the robot does now; true when a segment has begun. `battery_flags` and `current_findings` as
 * jp_segment_watch_note(). When a segment ended: at most one jp_energy_forecast() and one jp_learner_update(). Segments
 * of less than two passes may be left out. Not for ISRs.
 */
bool jp_drive_watch_update(struct jp_drive_watch *watch, const struct jp_telemetry *telemetry, uint8_t battery_flags,
                           uint8_t current_findings);

/** How the robot will move when its next segment begins: after the present one, or now if it stands. False: not known,
 *  and *start is a guess. One jp_energy_forecast(). */
bool jp_drive_watch_next_start(const struct jp_drive_watch *watch, const struct jp_telemetry *telemetry,
                               struct jp_energy_start *start);

#ifdef __cplusplus
}
#endif

#endif
