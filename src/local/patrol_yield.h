/** Whether, and how fast, the robot goes on among people. Private to libjoulepath_float. */
#ifndef JOULEPATH_LOCAL_PATROL_YIELD_H
#define JOULEPATH_LOCAL_PATROL_YIELD_H

#include <joulepath/patrol.h>

/**
 * Slows the command of this cycle down, with its curve kept, to what is safe in time: among a few speeds it takes the
 * highest at which the robot keeps its clearance, all along what it plans for some seconds, from where people may be
 * then: on their lines from where they would be if they turned round, to where they will be a rest later. At none of
 * them: it brakes. What is no nearer to people than standing still is free. Who has waited for long is content with
 * fewer seconds; who stays for long is passed the slower the nearer.
 *
 * Before, it slows the command down to what stops before things, and after, counts how long it has stood for people.
 * Work: speeds × instants × people at most, two distances each.
 */
void jp_patrol_yield(struct jp_patrol *patrol, const struct jp_plane_speed *speed);

/** How fast it drives past things at a distance of its footprint, m; m/s: it creeps where it has less than it keeps
 * from what it drives towards. */
float jp_patrol_speed_beside(const struct jp_patrol_config *config, float distance);

#endif
