/** Where people have walked lately: who walks to and fro comes there again. Private to libjoulepath_float. */
#ifndef JOULEPATH_LOCAL_PATROL_TRODDEN_H
#define JOULEPATH_LOCAL_PATROL_TRODDEN_H

#include <joulepath/patrol.h>
#include <joulepath/terrain.h>

/** Notes where those are who walk now, a cycle after the last call. Work: movers × JP_PATROL_TRODDEN_MAX. */
void jp_patrol_note_steps(struct jp_patrol *patrol);

/** Occupies on a map the cells where people have walked, and those nearer to them than a clearance, m, but not those
 * around the robot and around a goal, so that a path leads out and in. Work: JP_PATROL_TRODDEN_MAX × the cells of a
 * person. */
void jp_patrol_occupy_trodden(const struct jp_patrol *patrol, const struct jp_plane_pose *goal, float clearance,
                              struct jp_terrain *marked);

/** The cells that the call before may have occupied are as on the given map again. Work: as there. */
void jp_patrol_clear_trodden(const struct jp_patrol *patrol, const struct jp_terrain *given, float clearance,
                             struct jp_terrain *marked);

#endif
