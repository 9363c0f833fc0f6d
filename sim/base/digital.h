/** What a digital sensor, a converter, a counter and a timer make of exact values. */
#ifndef JOULEPATH_SIM_BASE_DIGITAL_H
#define JOULEPATH_SIM_BASE_DIGITAL_H

#include <joulepath/fixed.h>
#include <stdint.h>

#include "sim/base/random.h"

/** To the nearest of `one` steps a unit, saturated. */
int32_t digital_fixed(double value, double one);

/** A digital sensor's value: noise, full scale, step; each is left out when 0. */
double digital_sense(double value, double noise, double step, double full_scale, struct random *random);

/** An ADC's value: 2^bits equal steps from `low` to `high`, the last one below `high`; `bits` 0: exact. */
double digital_convert(double value, double low, double high, int bits);

/** A counter of `counts_per_turn` that wraps at 32 bits, from `start` at angle 0, rad. */
uint32_t digital_count(double angle, int counts_per_turn, uint32_t start);

/** The duty that a timer of 2^bits steps gives, −1…1; `bits` 0: exact. */
double digital_duty(jp_q31 duty, int bits);

#endif
