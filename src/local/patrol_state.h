/** The states of the patrol: what each begins with. Private to the patrol. */
#ifndef JOULEPATH_LOCAL_PATROL_STATE_H
#define JOULEPATH_LOCAL_PATROL_STATE_H

#include <joulepath/patrol.h>

/** The one place that assigns the state. Every state but DRIVING begins with a stand. */
void jp_patrol_enter(struct jp_patrol *patrol, enum jp_patrol_state state, enum jp_patrol_reason reason);

/** Sets the command of this cycle to a standstill, in any state. */
void jp_patrol_stand(struct jp_patrol *patrol);

/** Gives up: enters STOPPED. */
void jp_patrol_stop(struct jp_patrol *patrol, enum jp_patrol_reason reason);

/** Enters WAITING, or keeps waiting, for this reason. */
void jp_patrol_wait(struct jp_patrol *patrol, enum jp_patrol_reason reason);

#endif
