/** The states of the patrol: what each begins with. Private to the patrol. */
#ifndef JOULEPATH_LOCAL_PATROL_STATE_H
#define JOULEPATH_LOCAL_PATROL_STATE_H

#include <joulepath/patrol.h>

/** The one place that assigns the state. Every state but DRIVING begins with a stand. */
void jp_patrol_enter(struct jp_patrol *patrol, enum jp_patrol_state state, enum jp_patrol_reason reason);

/** Stands in this cycle, in whatever state. */
void jp_patrol_stand(struct jp_patrol *patrol);

/** Gives up. */
void jp_patrol_stop(struct jp_patrol *patrol, enum jp_patrol_reason reason);

/** Waits, or goes on waiting, now for this reason. */
void jp_patrol_wait(struct jp_patrol *patrol, enum jp_patrol_reason reason);

#endif
