/** How a trajectory by rule rounds a waypoint. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_TRAJECTORY_CORNER_H
#define JOULEPATH_TRAJECTORY_TRAJECTORY_CORNER_H

#include <joulepath/trajectory_rule.h>
#include <stddef.h>

/** Of a motion whose speed is not given. */
#define JP_SPEED_FREE (-1)

/** How a leg begins. */
struct jp_leg_begin {
    jp_angle heading; /**< of the robot or, at a corner, of the leg before */
    jp_q24 speed;     /**< that is given, m/s; or JP_SPEED_FREE */
    bool is_corner;   /**< the leg before takes half of the turn */
};

/** What is given at target `index`. */
static inline const struct jp_passage *jp_passage_at(const struct jp_trajectory_task *task, uint16_t index)
{
    static const struct jp_passage nothing_given = {.given = 0};

    return task->passages == NULL ? &nothing_given : &task->passages[index];
}

/** How a leg begins after one to target `index`. */
struct jp_leg_begin jp_begin_after(const struct jp_trajectory_task *task, uint16_t index,
                                   const struct jp_chord *before);

/** The leg to target `index`, at the speed that leaves its blends time enough for what the motion at its ends asks for.
 * JP_ERR_ZERO_LENGTH, JP_ERR_ARGUMENT: as jp_segment_polar(), or what is given is out of range. JP_ERR_INFEASIBLE: no
 * speed does. */
enum jp_status jp_chord_to(const struct jp_trajectory_task *task, uint16_t index, const struct jp_leg_begin *begin,
                           struct jp_chord *chord);

/** Slows the faster of two legs down to where it can change to the speed of the other at the waypoint `index` between
 * them. */
void jp_chords_meet(const struct jp_trajectory_task *task, uint16_t index, struct jp_chord *before,
                    struct jp_chord *after);

/** Whether voltage and lean are enough for a blend of so many set-points between a leg's middle and that motion. */
bool jp_chord_can_meet(const struct jp_trajectory_config *config, const struct jp_chord *chord,
                       const struct jp_waypoint_motion *motion, uint32_t set_points);

/** Set-points of a blend beside another beyond the waypoint. Twice as long it would turn past the waypoint's heading
 * and back. */
static inline uint32_t jp_blend_beside(uint32_t blend, uint32_t other)
{
    return blend / 2U < other ? blend : 2U * other;
}

/** The motion at the waypoint `index` between two chords. */
struct jp_waypoint_motion jp_corner_between(const struct jp_trajectory_task *task, uint16_t index,
                                            const struct jp_chord *before, const struct jp_chord *after);

/** The motion at the last target, to which a chord leads; the heading, where none is given, is the chord's. */
struct jp_waypoint_motion jp_last_motion(const struct jp_trajectory_task *task, const struct jp_chord *chord);

#endif
