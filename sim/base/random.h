/** Seeded random numbers: libc's erand48 on a state of its own, so that every world repeats its noise bit for bit. */
#ifndef JOULEPATH_SIM_BASE_RANDOM_H
#define JOULEPATH_SIM_BASE_RANDOM_H

#include <stdbool.h>
#include <stdint.h>

struct random {
    unsigned short state[3]; /**< 48 bits, as erand48 wants them */
    bool has_spare;          /**< the polar method makes two values at a time */
    double spare;
};

/** Starts a stream; neighbouring seeds give independent ones. */
void random_init(struct random *random, uint64_t seed);

/** Uniform in [low, high). */
double random_uniform(struct random *random, double low, double high);

/** Gaussian with mean 0 and the given standard deviation. */
double random_gaussian(struct random *random, double deviation);

#endif
