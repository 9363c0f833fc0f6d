#include <joulepath/home.h>

#include <stddef.h>

#include "src/base/integer.h"

#define RATIO_MIN     JP_Q16(0.5)
#define RATIO_MAX     JP_Q16(2)
#define NOISE_MIN     JP_Q16(0.015625)
#define NOISE_MAX     JP_Q16(2)
#define DEVIATION_MAX JP_Q16(0.1)

/** Mean and noise are taken to be no better known than by so many drives: robots and their ground change. Few drives
 *  meet what is in the way, and those take far more: a noise that follows single drives is too low before most of
 *  these. */
#define MEMORY 16U

/* Way out: planning, ways round what the map does not show. Way home: along what was driven. As drives of courier24 on
 * dense maps with hidden boxes have them. */
const struct jp_home_learned jp_home_learned_new = {
    .out = {.mean = JP_Q16(1.1), .deviation = JP_Q16(0.1), .noise = JP_Q16(0.89)},
    .back = {.mean = JP_Q16(1.07), .deviation = JP_Q16(0.06), .noise = JP_Q16(0.25)}};

/** Of Q16, in Q32. */
static int64_t square(jp_q16 x)
{
    return (int64_t)x * x;
}

static jp_q16 root(int64_t variance)
{
    return jp_saturate32((int64_t)jp_square_root((uint64_t)variance));
}

/** Of deviations that do not depend on each other; the sum of their squares may take 64 bits. */
static jp_q16 root_of_squares(jp_q16 a, jp_q16 b, jp_q16 c)
{
    const uint64_t sum = (uint64_t)square(a) + (uint64_t)square(b) + (uint64_t)square(c);

    return jp_saturate32((int64_t)jp_square_root(sum));
}

static jp_q16 clamped_ratio(int64_t over, int64_t under)
{
    const int64_t ratio = over * JP_Q16_ONE / under;

    return ratio < RATIO_MIN ? RATIO_MIN : (jp_q16)(ratio < RATIO_MAX ? ratio : RATIO_MAX);
}

/** The relative deviation of a forecast, up to that of one of which nothing is known. */
static jp_q16 relative_deviation(const struct jp_forecast *forecast)
{
    const int64_t ratio = (int64_t)forecast->deviation * JP_Q16_ONE / forecast->energy;

    return (jp_q16)(ratio < JP_Q16_ONE ? ratio : JP_Q16_ONE);
}

/** Variance of a drive by its noise, of the square of what it takes: Q32. */
static int64_t noise_of(const struct jp_home_factor *factor, jp_q16 energy, jp_q16 steps)
{
    const int64_t share = (int64_t)steps * JP_Q16_ONE / energy;

    return (square(factor->noise) >> 16) * (share < JP_Q16_ONE ? share : JP_Q16_ONE);
}

/** Variance by a drive. What takes more than is thought strands a robot, and drives that do are far off: the noise is
 *  that of the normal distribution whose upper half is as wide. */
static int64_t above(jp_q16 innovation)
{
    return innovation > 0 ? 2 * square(innovation) : 0;
}

enum jp_status jp_home_factor_learn(struct jp_home_factor *factor, jp_q16 taken, const struct jp_forecast *forecast,
                                    jp_q16 steps)
{
    if (factor == NULL || forecast == NULL || taken <= 0 || forecast->energy <= 0 || forecast->deviation < 0 ||
        steps <= 0) {
        return JP_ERR_ARGUMENT;
    }
    const jp_q16 innovation = clamped_ratio(taken, forecast->energy) - factor->mean;
    const int64_t known = square(factor->deviation);
    const int64_t unsure = known + square(relative_deviation(forecast));
    const int64_t noise = noise_of(factor, forecast->energy, steps);
    const int64_t least = noise / (int64_t)MEMORY;
    const int64_t total = unsure + noise > JP_Q16_ONE ? unsure + noise : JP_Q16_ONE;
    const int64_t left = known - (known >> 16) * (known / (total >> 16));
    const int64_t seen = above(innovation) > unsure ? above(innovation) - unsure : 0;
    /* A forecast that is not sure says as little of the noise. */
    const int64_t change = (seen - noise) / (int64_t)MEMORY / (total >> 16) * (square(factor->noise) >> 16);

    factor->mean = jp_clamp32(factor->mean + jp_saturate32((int64_t)innovation * (known >> 8) / (total >> 8)),
                              RATIO_MIN, RATIO_MAX);
    factor->deviation = jp_clamp32(root(left > least ? left : least), 1, DEVIATION_MAX);
    factor->noise = jp_clamp32(root(square(factor->noise) + change), NOISE_MIN, NOISE_MAX);
    return JP_OK;
}

struct jp_forecast jp_home_factor_way(const struct jp_home_factor *factor, const struct jp_forecast *forecast,
                                      jp_q16 steps)
{
    const jp_q16 energy = jp_q16_multiply(forecast->energy, factor->mean);
    const jp_q16 of_learner = jp_q16_multiply(forecast->deviation, factor->mean);
    const jp_q16 of_mean = jp_q16_multiply(forecast->energy, factor->deviation);
    const jp_q16 of_drive = jp_q16_multiply(root((int64_t)forecast->energy * steps), factor->noise);

    return (struct jp_forecast){energy, root_of_squares(of_learner, of_mean, of_drive)};
}
