#include <joulepath/skid_tariff.h>
#include <stddef.h>

/* What the factors compare. */
enum { STRAIGHT, UPHILL, ON_THE_SPOT, IN_A_BEND, KINDS };

/* Powers of one model, W in Q16; of the learned one if there is one. */
struct pricing {
    const struct jp_skid_steer_config *priced;
    const struct jp_skid_energy_model *learned;
    jp_q16 power[KINDS];
};

static enum jp_status find_powers(struct pricing *pricing, const struct jp_motion *usual)
{
    const struct jp_motion motions[KINDS] = {
        [STRAIGHT] = {usual->speed, 0},
        [UPHILL] = {usual->speed, 0},
        [ON_THE_SPOT] = {0, usual->turn_rate},
        [IN_A_BEND] = {usual->speed, usual->turn_rate},
    };
    enum jp_status status = JP_OK;

    for (int i = 0; i < (int)KINDS && status == JP_OK; i++) {
        const jp_q24 grade = i == (int)UPHILL ? JP_Q24(0.125) : 0;
        status = pricing->learned != NULL
                     ? jp_skid_energy_power(pricing->learned, &motions[i], grade, &pricing->power[i])
                     : jp_skid_steer_power(pricing->priced, JP_COST_PHYSICAL, &motions[i], grade, &pricing->power[i]);
    }
    return status;
}

static int64_t turning(const struct pricing *pricing)
{
    return (int64_t)pricing->power[ON_THE_SPOT] + pricing->power[IN_A_BEND] - pricing->power[STRAIGHT];
}

static int64_t climbing(const struct pricing *pricing)
{
    return (int64_t)pricing->power[UPHILL] - pricing->power[STRAIGHT];
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
    struct pricing before = {.priced = priced};
    struct pricing now = {.learned = learned};

    if (usual == NULL || factors == NULL || usual->speed <= 0 || usual->turn_rate <= 0) {
        return JP_ERR_ARGUMENT;
    }

    /* Powers of a model that is null are refused. */
    enum jp_status status = find_powers(&before, usual);

    if (status == JP_OK) {
        status = find_powers(&now, usual);
    }
    if (status != JP_OK) {
        return status;
    }
    *factors = (struct jp_tariff_factors){
        .version = version,
        .straight = factor(now.power[STRAIGHT], before.power[STRAIGHT]),
        .turning = factor(turning(&now), turning(&before)),
        .mass = factor(climbing(&now), climbing(&before)),
    };
    return JP_OK;
}
