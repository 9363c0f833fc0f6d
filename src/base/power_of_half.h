/** Powers of ½. Private to the core. */
#ifndef JOULEPATH_BASE_POWER_OF_HALF_H
#define JOULEPATH_BASE_POWER_OF_HALF_H

#include <stdint.h>

/** 2^-x in Q30, for x in Q32; within 2 units. */
int32_t jp_power_of_half(uint64_t x);

#endif
