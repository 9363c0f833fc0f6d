/** The curve of linear curvature between two poses. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_CLOTHOID_H
#define JOULEPATH_TRAJECTORY_CLOTHOID_H

#include <joulepath/fixed.h>
#include <stdbool.h>

/** A curve of which only the ends' headings against the chord are given. */
struct jp_clothoid {
    int32_t chord_share; /**< of the length that the chord is, Q30; above 0 */
    jp_q24 first;        /**< curvature at its begin times the length, rad */
    jp_q24 last;         /**< the same at its end */
};

/** False: it leads back, or takes a detour of four times the chord. `from`, `to`: headings at the begin and at the end
 *  against the chord, 2⁻³² turn. Work: 42 sines and 42 cosines. */
bool jp_clothoid_fit(int32_t from, int32_t to, struct jp_clothoid *curve);

#endif
