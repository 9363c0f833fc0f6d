/** Who walks, and who has walked. Private to libjoulepath_float. */
#ifndef JOULEPATH_LOCAL_MOVERS_WALK_H
#define JOULEPATH_LOCAL_MOVERS_WALK_H

#include "src/local/movers_things.h"

/** What is seen is larger than somebody alone by so much: somebody else is seen with them as one, m. */
#define JP_MOVER_SHARED 0.05f

bool jp_mover_has_walked(const struct jp_mover *mover);

/** Remembers how it walks, if it does, by what is seen of it now. */
void jp_mover_note_walk(struct jp_mover *mover, const struct jp_movers_config *config,
                        const struct jp_mover_thing *thing, const struct jp_scan_view *view);

/** Who was taken for one who walks because somebody else does stands, if it is no faster than a thing once it has been
 * seen alone often enough to tell. */
void jp_mover_judge_companion(struct jp_mover *mover, const struct jp_movers_config *config);

/** Who walks beside a thing, in a group that was seen as one; null: nobody. Work: movers. */
const struct jp_mover *jp_movers_companion(const struct jp_movers *movers, const struct jp_mover_thing *thing);

/** What is seen of a walker and a stander together remembers how the walker walks: who walks out of it on any side is
 * then known. Work: movers². */
void jp_movers_join(struct jp_movers *movers);

#endif
