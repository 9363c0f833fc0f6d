/** Where nothing was a while ago. Private to libjoulepath_float. */
#ifndef JOULEPATH_LOCAL_MOVERS_PAST_H
#define JOULEPATH_LOCAL_MOVERS_PAST_H

#include "src/local/movers_things.h"

/** Remembers a scan that is `period` s later than the last one, if that is due. Work: beams. */
void jp_movers_keep_scan(struct jp_movers *movers, const struct jp_scan_view *view, float period);

/** Whether all that is seen of a thing is where nothing was, clearly, in a scan of a second or two ago. False without
 * one. */
bool jp_movers_has_come(const struct jp_movers *movers, const struct jp_scan_config *config,
                        const struct jp_mover_thing *thing);

#endif
