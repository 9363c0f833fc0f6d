/** What ground takes more than the prices of a lattice. Private to the core. */
#ifndef JOULEPATH_MAP_GROUND_SHARE_H
#define JOULEPATH_MAP_GROUND_SHARE_H

#include <joulepath/lattice.h>

/** A cost of 16 bits, or JP_COST_MAX, with a share of another one of 16 bits, in 1/(2 JP_GROUND_ONE): at most 65 535,
 *  or JP_COST_MAX. */
static inline jp_cost ground_with_share(jp_cost cost, jp_cost of, uint32_t share)
{
    const uint32_t sum = cost + (of * share) / (2U * JP_GROUND_ONE);

    if (cost == JP_COST_MAX) {
        return cost;
    }
    return sum < (uint32_t)UINT16_MAX ? sum : (uint32_t)UINT16_MAX;
}

#endif
