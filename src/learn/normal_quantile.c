#include "src/learn/normal_quantile.h"

#define STEP_BITS  3U /* entries an octave of the tail probability */
#define FRACTION   (30U - STEP_BITS)
#define Q14_TO_Q16 2U
#define ONE_OCTAVE ((uint32_t)1 << 30)

jp_q16 jp_normal_quantile(jp_q31 probability)
{
    /* Quantiles in Q14 where the tail probability is (8 + j)/16 · 2^−octave, at 8 octave − j; by
     * tools/design/normal_quantile.py.
     */
    static const uint16_t quantiles[] = {
        0,     1285,  2577,  3886,  5221,  6590,  8008,  9489,  11051, 11870, 12721, 13607, 14535, 15512, 16548,
        17654, 18847, 19483, 20150, 20852, 21594, 22384, 23229, 24141, 25135, 25669, 26231, 26826, 27459, 28135,
        28863, 29653, 30519, 30986, 31479, 32003, 32562, 33161, 33809, 34514, 35289, 35708, 36153, 36625, 37130,
        37673, 38260, 38902, 39609, 39993, 40399, 40832, 41296, 41795, 42337, 42929, 43583, 43937, 44314, 44716,
        45147, 45611, 46115, 46668, 47278, 47610, 47963, 48339, 48743, 49178, 49652, 50171, 50746, 51058, 51391,
        51746, 52127, 52538, 52986, 53477, 54021, 54317, 54633, 54969, 55331, 55722, 56148, 56615, 57133, 57415,
        57715, 58036, 58381, 58754, 59160, 59607, 60102, 60372, 60659, 60966, 61297, 61654, 62043, 62471, 62946,
    };
    uint32_t tail = ((uint32_t)1 << 31) - (uint32_t)probability;
    uint32_t entry = 0;

    if (tail == ONE_OCTAVE) {
        return 0;
    }
    while (tail < ONE_OCTAVE) {
        tail <<= 1;
        entry += (uint32_t)1 << STEP_BITS;
    }
    tail -= ONE_OCTAVE;
    entry -= tail >> FRACTION;

    const uint32_t share = tail & (((uint32_t)1 << FRACTION) - 1U);
    const uint32_t step = quantiles[entry] - (uint32_t)quantiles[entry - 1U];
    const uint32_t below = (uint32_t)(((uint64_t)step * share) >> (FRACTION - Q14_TO_Q16));

    const uint32_t quantile = ((uint32_t)quantiles[entry] << Q14_TO_Q16) - below;

    return (jp_q16)quantile;
}

/** At least ½, of deviations that are not negative. */
static jp_q31 upper_probability(jp_q16 deviations)
{
    jp_q31 low = JP_PROBABILITY_MIN;
    jp_q31 high = JP_PROBABILITY_MAX;

    while (low < high) {
        const jp_q31 middle = low + (high - low) / 2 + (high - low) % 2;

        if (jp_normal_quantile(middle) <= deviations) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    return low;
}

jp_q31 jp_normal_probability(jp_q16 deviations)
{
    if (deviations >= 0) {
        return upper_probability(deviations);
    }
    const int64_t above = upper_probability(jp_saturate32(-(int64_t)deviations));

    return jp_saturate32(((int64_t)1 << 31) - above);
}
