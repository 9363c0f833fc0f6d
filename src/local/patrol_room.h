/** Room around the robot: what turns and steps are free. Private to the patrol. */
#ifndef JOULEPATH_LOCAL_PATROL_ROOM_H
#define JOULEPATH_LOCAL_PATROL_ROOM_H

#include <joulepath/patrol.h>

/** What the robot keeps from things that it drives towards, m. */
#define JP_PATROL_CLEARANCE 0.1f

/** Of clearances between scans, m. */
#define JP_PATROL_CLEARANCE_NOISE 0.01f

/** Distance of the footprint at a pose from what the last scan saw, m: the shapes are larger by about
 *  half of its tolerance. */
float jp_patrol_clearance(const struct jp_patrol *patrol, const struct jp_plane_pose *pose);

/** That a turn on the spot, a curve and the way to a stand keep, m: three quarters of the scans' tolerance, for what
 *  laser and pose may be off by; where it is nearer already, no nearer by the same scan. */
float jp_patrol_least_clearance(const struct jp_patrol *patrol);

/** The distance when the robot will be there, so much later, s: what moves goes on, and may be off by its margin. */
float jp_patrol_clearance_later(const struct jp_patrol *patrol, const struct jp_plane_pose *pose, float time);

/** Whether the footprint keeps a clearance while it turns in place by an angle, which has a sign. */
bool jp_patrol_is_turn_free(const struct jp_patrol *patrol, const struct jp_plane_pose *from, float angle,
                            float clearance);

/** The turn in place to a heading: the shorter way round if it is free, else the longer. False when neither is. */
bool jp_patrol_find_turn(const struct jp_patrol *patrol, const struct jp_plane_pose *from, float heading,
                         float clearance, float *angle);

/** Whether the robot can step by `step`, in its own frame, with its heading as it is: it keeps the clearance from each
 *  thing, or where it has less now, does not get nearer to that. */
bool jp_patrol_is_step_free(const struct jp_patrol *patrol, const struct jp_plane_pose *step, float clearance);

/** The same from another pose. */
bool jp_patrol_is_step_free_from(const struct jp_patrol *patrol, const struct jp_plane_pose *from,
                                 const struct jp_plane_pose *step, float clearance);

/** What a step is looked for. */
struct jp_patrol_step_search {
    float heading;                    /**< in which the robot is to stand after a turn at its end, rad */
    float clearance;                  /**< to be kept in step and turn, m */
    const struct jp_plane_pose *into; /**< another step then leads from there to this place; null: none */
    float into_clearance;             /**< to be kept in that, m */
    float into_reach;                 /**< its length at most, m */
};

/** Of some steps after which the turn to a heading is free the one of least cost, all in all; by the paper's strategy
 *  the shortest, and none backwards. None comes nearer to what is nearer than the clearance. False: none is free. */
bool jp_patrol_find_step(const struct jp_patrol *patrol, const struct jp_patrol_step_search *search,
                         struct jp_plane_point *target);

#endif
