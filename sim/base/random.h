/** Seeded random numbers, those of POSIX' erand48, so that every world repeats its noise bit for bit on every machine.
 */
#ifndef JOULEPATH_SIM_BASE_RANDOM_H
#define JOULEPATH_SIM_BASE_RANDOM_H

#include <stdbool.h>
#include <stdint.h>

struct random {
    uint64_t state; /**< 48 bits */
    bool has_spare; /**< the polar method makes two values at a time */
    double spare;
};

/** Starts a stream; neighbouring seeds give independent ones. */
void random_init(struct random *random, uint64_t seed);

/** Uniform in [low, high). */
double random_uniform(struct random *random, double low, double high);

/** Gaussian with mean 0 and the given standard deviation. */
double random_gaussian(struct random *random, double deviation);

#endif
