#include "sim/base/digital.h"

#include <math.h>

static double clamp(double value, double low, double high)
{
    return fmin(fmax(value, low), high);
}

int32_t digital_fixed(double value, double one)
{
    return (int32_t)clamp(floor(value * one + 0.5), INT32_MIN, INT32_MAX);
}

double digital_sense(double value, double noise, double step, double full_scale, struct random *random)
{
    double digital = noise > 0.0 ? value + random_gaussian(random, noise) : value;
    if (full_scale > 0.0) {
        digital = clamp(digital, -full_scale, full_scale);
    }
    return step > 0.0 ? step * floor(digital / step + 0.5) : digital;
}

double digital_convert(double value, double low, double high, int bits)
{
    if (bits == 0) {
        return value;
    }
    const double codes = ldexp(1.0, bits);
    const double step = (high - low) / codes;
    return low + step * clamp(floor((value - low) / step + 0.5), 0.0, codes - 1.0);
}

/* Converting through 64 bits wraps at 32 as a counter does. */
uint32_t digital_count(double angle, int counts_per_turn, uint32_t start)
{
    const int64_t counts = (int64_t)floor(angle / (2.0 * M_PI) * counts_per_turn);
    return (uint32_t)counts + start;
}

double digital_duty(jp_q31 duty, int bits)
{
    const double exact = duty / 2147483648.0;
    if (bits == 0) {
        return exact;
    }
    const double steps = (double)(1 << bits);
    return round(exact * steps) / steps;
}
