/** The tables of a robot in another unit of energy: what they say of a robot stays the same. */
#ifndef JOULEPATH_TESTS_SUPPORT_ENERGY_UNIT_H
#define JOULEPATH_TESTS_SUPPORT_ENERGY_UNIT_H

#include <joulepath/learner.h>

/** A number of units of 1 J in units of 2^exponent J, ±15, rounded; it fits. */
static inline int32_t energy_in_unit(int32_t number, int32_t exponent)
{
    return (int32_t)(exponent > 0 ? ((int64_t)number + ((int64_t)1 << (exponent - 1))) >> exponent
                                  : number * ((int64_t)1 << -exponent));
}

static inline struct jp_energy_model energy_model_in_unit(const struct jp_energy_model *model, int32_t exponent)
{
    struct jp_energy_model other = *model;

    for (unsigned i = 0; i < JP_ENERGY_TERMS - 1U; i++) { /* a13 is a time */
        other.a[i] = energy_in_unit(model->a[i], exponent);
    }
    other.b[0] = energy_in_unit(model->b[0], exponent);
    other.b[1] = energy_in_unit(model->b[1], exponent);
    other.electronics_power = energy_in_unit(model->electronics_power, exponent);
    other.motor_resistance = energy_in_unit(model->motor_resistance, -exponent);
    other.unit_exponent = exponent;
    return other;
}

static inline void energy_axis_in_unit(struct jp_axis_modes *axis, int32_t exponent)
{
    for (unsigned i = 0; i < axis->count * (axis->count + 1U) / 2U; i++) {
        axis->storage[i] = energy_in_unit(axis->storage[i], exponent);
    }
    for (unsigned i = 0; i < axis->count; i++) {
        axis->cross[0][i] = energy_in_unit(axis->cross[0][i], exponent);
        axis->cross[1][i] = energy_in_unit(axis->cross[1][i], exponent);
        axis->steady[i] = energy_in_unit(axis->steady[i], exponent);
    }
}

static inline struct jp_horizon horizon_in_unit(const struct jp_horizon *horizon, int32_t exponent)
{
    struct jp_horizon other = *horizon;

    energy_axis_in_unit(&other.travel, exponent);
    energy_axis_in_unit(&other.yaw, exponent);
    return other;
}

static inline struct jp_learning learning_in_unit(const struct jp_learning *learning, int32_t exponent)
{
    struct jp_learning other = *learning;

    for (unsigned i = 0; i < JP_ENERGY_PARAMETERS; i++) {
        for (unsigned j = 0; i != JP_ENERGY_TERMS - 1U && j < JP_LEARNING_DIRECTIONS; j++) {
            other.direction[i][j] = energy_in_unit(learning->direction[i][j], exponent);
        }
    }
    other.noise = energy_in_unit(learning->noise, exponent);
    other.leg_noise = energy_in_unit(learning->leg_noise, exponent);
    return other;
}

#endif
