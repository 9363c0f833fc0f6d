/**
 * An arc by x, half its angle in half turns: half the arc angle γ/2 = π x, so that the bits of x are those of γ/2 as a
 * wrapping angle. Private to the core.
 */
#ifndef JOULEPATH_TRAJECTORY_SEGMENT_ARC_H
#define JOULEPATH_TRAJECTORY_SEGMENT_ARC_H

#include <stdint.h>

/** x of JP_ARC_ANGLE_MAX, and sinc there. */
#define JP_HALF_ARC_MAX         ((int32_t)1932735283)
#define JP_SINC_AT_HALF_ARC_MAX ((int32_t)58675913)

/** 1 in the format of sinc. */
#define JP_SINC_ONE ((int32_t)1 << 29)

/** With sinc = sin(πx)/(πx), the chord as a part of the arc's length, and r = 1/sinc. */
struct jp_arc {
    int32_t square;  /**< x² in Q31 */
    int32_t sinc;    /**< Q29 */
    int32_t shape;   /**< r/16 in Q31 */
    int32_t stretch; /**< (dr/dx)/r in Q27 */
};

/** |x| <= JP_HALF_ARC_MAX. */
void jp_arc_at(int32_t x, struct jp_arc *arc);

/** The x of 0…JP_HALF_ARC_MAX where sinc is this, Q29. */
int32_t jp_arc_of_sinc(int32_t sinc);

/** The x of 0…½ where x sinc, which is half the chord of an arc of radius 1/π, is this, Q30. */
int32_t jp_arc_of_half_chord(int32_t half_chord);

#endif
