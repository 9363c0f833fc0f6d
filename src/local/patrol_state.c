#include "src/local/patrol_state.h"

#include <stddef.h>

void jp_patrol_stand(struct jp_patrol *patrol)
{
    patrol->internal.command = (struct jp_plane_speed){0.0f, 0.0f};
    patrol->internal.sideways = 0.0f;
}

void jp_patrol_enter(struct jp_patrol *patrol, enum jp_patrol_state state, enum jp_patrol_reason reason)
{
    patrol->state = state;
    patrol->reason = reason;
    patrol->internal.is_making_room = false;
    switch (state) {
    case JP_PATROL_DRIVING:
        patrol->internal.sideways = 0.0f;
        return; /* with the command that the band gives */
    case JP_PATROL_GLIDING:
        patrol->counts.glides++;
        jp_teb_clear(&patrol->teb);
        return; /* as it moves */
    case JP_PATROL_TURNING:
        patrol->counts.turns++;
        jp_teb_clear(&patrol->teb);
        break;
    case JP_PATROL_STEPPING:
        patrol->counts.steps++;
        break;
    case JP_PATROL_WAITING:
        patrol->internal.waited = 0;
        patrol->counts.waits++;
        break;
    case JP_PATROL_HELD:
    case JP_PATROL_ARRIVED:
        patrol->internal.path = NULL;
        break;
    case JP_PATROL_STOPPED:
    default:
        break;
    }
    jp_patrol_stand(patrol);
}

void jp_patrol_stop(struct jp_patrol *patrol, enum jp_patrol_reason reason)
{
    jp_patrol_enter(patrol, JP_PATROL_STOPPED, reason);
}

void jp_patrol_wait(struct jp_patrol *patrol, enum jp_patrol_reason reason)
{
    if (patrol->state != JP_PATROL_WAITING) {
        jp_patrol_enter(patrol, JP_PATROL_WAITING, reason);
        patrol->internal.rooms = 0;
    }
    patrol->reason = reason;
    patrol->internal.free_cycles = 0;
    jp_patrol_stand(patrol);
}
