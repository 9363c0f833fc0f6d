/** The arcs of the segment optimiser (src/trajectory/segment_arc.h) for each number that they take, built with
 * -fsanitize=undefined: nothing overflows, and results are within the ranges from which the rest of it is argued. */
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>

#include "src/trajectory/segment_arc.h"
#include "src/trajectory/segment_math.h"

static bool expect(bool holds, const char *what, int32_t input)
{
    if (!holds) {
        (void)fprintf(stderr, "%s: not so for %" PRId32 "\n", what, input);
    }
    return holds;
}

static bool each_arc(void)
{
    for (int64_t x = -JP_HALF_ARC_MAX; x <= JP_HALF_ARC_MAX; x++) {
        struct jp_arc arc;

        jp_arc_at((int32_t)x, &arc);
        if (!expect(arc.sinc > 1 << 25 && arc.sinc <= JP_SINC_ONE, "sinc of an arc", (int32_t)x) ||
            !expect(arc.shape > 0 && arc.shape <= INT32_MAX / 100 * 58, "shape of an arc", (int32_t)x) ||
            !expect(arc.stretch >= -(INT32_MAX / 10 * 7) && arc.stretch <= INT32_MAX / 10 * 7, "stretch of an arc",
                    (int32_t)x)) {
            return false;
        }
    }
    return true;
}

static bool each_sinc(void)
{
    for (int32_t sinc = 0; sinc <= JP_SINC_ONE; sinc++) {
        const int32_t x = jp_arc_of_sinc(sinc);

        if (!expect(x >= 0 && x <= JP_HALF_ARC_MAX, "arc of a sinc", sinc)) {
            return false;
        }
    }
    return true;
}

static bool each_half_chord(void)
{
    for (int64_t half_chord = 0; half_chord <= Q30_ONE; half_chord++) {
        const int32_t x = jp_arc_of_half_chord((int32_t)half_chord);

        if (!expect(x >= 0, "arc of a half chord", (int32_t)half_chord)) {
            return false;
        }
    }
    return true;
}

/** A fraction of the whole is at most 1, for each mantissa of the whole. */
static bool each_fraction(void)
{
    for (uint32_t whole = UINT32_C(1) << 31; whole != 0; whole++) {
        if (!expect(jp_fraction30(whole, whole) <= Q30_ONE, "fraction", (int32_t)whole)) {
            return false;
        }
    }
    return true;
}

int main(void)
{
    return each_fraction() && each_arc() && each_sinc() && each_half_chord() ? 0 : 1;
}
