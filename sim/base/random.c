#include "sim/base/random.h"

#include <math.h>
#include <stdlib.h>

/* erand48 is linear: streams of neighbouring seeds would stay a constant apart. The finaliser of SplitMix64 parts them.
 */
static uint64_t mix(uint64_t seed)
{
    uint64_t z = seed + 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

void random_init(struct random *random, uint64_t seed)
{
    const uint64_t mixed = mix(seed);
    *random = (struct random){.state = {(unsigned short)(mixed & 0xffffu), (unsigned short)(mixed >> 16 & 0xffffu),
                                        (unsigned short)(mixed >> 32 & 0xffffu)}};
}

double random_uniform(struct random *random, double low, double high)
{
    return low + (high - low) * erand48(random->state);
}

/* Marsaglia's polar method. */
double random_gaussian(struct random *random, double deviation)
{
    if (random->has_spare) {
        random->has_spare = false;
        return deviation * random->spare;
    }
    double a;
    double b;
    double square;
    do {
        a = random_uniform(random, -1.0, 1.0);
        b = random_uniform(random, -1.0, 1.0);
        square = a * a + b * b;
    } while (square >= 1.0 || square == 0.0);
    const double scale = sqrt(-2.0 * log(square) / square);
    random->spare = b * scale;
    random->has_spare = true;
    return deviation * a * scale;
}
