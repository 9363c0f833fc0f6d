#include "sim/base/random.h"

#include <math.h>

#include "sim/base/strict_math.h"

/* The generator of POSIX' drand48: 48 bits. Here it is inlined, since every sample of a sensor draws from it. */
#define FACTOR    UINT64_C(0x5DEECE66D)
#define INCREMENT 0xBU
#define MASK      ((UINT64_C(1) << 48) - 1)

/* It is linear: streams of neighbouring seeds would stay a constant apart. The finaliser of SplitMix64 parts them.
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
    *random = (struct random){.state = mix(seed) & MASK};
}

double random_uniform(struct random *random, double low, double high)
{
    random->state = (random->state * FACTOR + INCREMENT) & MASK;
    return low + (high - low) * ((double)random->state * 0x1p-48);
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
    const double scale = sqrt(-2.0 * strict_log(square) / square);
    random->spare = b * scale;
    random->has_spare = true;
    return deviation * a * scale;
}
