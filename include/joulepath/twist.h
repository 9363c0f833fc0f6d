/** Velocity of a chassis that can also move sideways. */
#ifndef JOULEPATH_TWIST_H
#define JOULEPATH_TWIST_H

#include <joulepath/fixed.h>

/** Q8.24: forward (x) and to the left (y), m/s, and the turn rate, rad/s, counterclockwise. */
struct jp_twist {
    jp_q24 x;
    jp_q24 y;
    jp_q24 turn_rate;
};

#endif
