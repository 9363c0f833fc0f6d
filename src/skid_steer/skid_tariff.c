#include <joulepath/skid_tariff.h>
#include <stddef.h>

/* Powers that prices are made of, W in Q16. */
struct powers {
    jp_q16 straight;
    jp_q16 uphill;
    jp_q16 on_the_spot;
    jp_q16 in_a_bend;
};

/* What the factors compare. */
enum { KINDS = 4 };

struct probe {
    struct jp_motion motion;
    jp_q24 grade;
    jp_q16 *power;
};

static enum jp_status probe_all(const struct jp_skid_steer_config *priced, const struct jp_skid_energy_model *learned,
                                const struct jp_motion *usual, struct powers *powers)
{
    const struct probe probes[KINDS] = {
        {{usual->speed, 0}, 0, &powers->straight},
        {{usual->speed, 0}, JP_SKID_TARIFF_GRADE, &powers->uphill},
        {{0, usual->turn_rate}, 0, &powers->on_the_spot},
        {*usual, 0, &powers->in_a_bend},
    };
    enum jp_status status = JP_OK;

    for (int i = 0; i < (int)KINDS && status == JP_OK; i++) {
        const struct probe *probe = &probes[i];
        status = learned != NULL
                     ? jp_skid_energy_power(learned, &probe->motion, probe->grade, probe->power)
                     : jp_skid_steer_power(priced, JP_COST_PHYSICAL, &probe->motion, probe->grade, probe->power);
    }
    return status;
}

static int64_t turning(const struct powers *powers)
{
    return (int64_t)powers->on_the_spot + powers->in_a_bend - powers->straight;
}

static int64_t climbing(const struct powers *powers)
{
    return (int64_t)powers->uphill - powers->straight;
}

static jp_q16 factor(int64_t learned, int64_t priced)
{
    const jp_q16 ratio = jp_divide(learned * JP_Q16_ONE, jp_saturate32(priced));

    return jp_clamp32(ratio, JP_TARIFF_FACTOR_MIN, JP_TARIFF_FACTOR_MAX);
}

enum jp_status jp_skid_tariff_factors(const struct jp_skid_steer_config *priced,
                                      const struct jp_skid_energy_model *learned, const struct jp_motion *usual,
                                      uint32_t version, struct jp_tariff_factors *factors)
{
    struct powers before;
    struct powers now;

    if (priced == NULL || learned == NULL || usual == NULL || factors == NULL || usual->speed <= 0 ||
        usual->turn_rate <= 0) {
        return JP_ERR_ARGUMENT;
    }

    enum jp_status status = probe_all(priced, NULL, usual, &before);

    if (status == JP_OK) {
        status = probe_all(priced, learned, usual, &now);
    }
    if (status != JP_OK) {
        return status;
    }
    *factors = (struct jp_tariff_factors){
        .version = version,
        .straight = factor(now.straight, before.straight),
        .turning = factor(turning(&now), turning(&before)),
        .mass = factor(climbing(&now), climbing(&before)),
    };
    return JP_OK;
}
