#include "sim/skid_steer/skid_instruments.h"

#include "sim/base/digital.h"

static jp_turns_per_s gyro(const struct skid_steer_model *model, double rad_s, struct random *random)
{
    const double dps = rad_s * 180 / M_PI * (1 + model->gyro.scale_error) + model->gyro.bias_dps;
    const double digital =
        digital_sense(dps, model->gyro.noise_rms_dps, model->gyro.step_dps, model->gyro.full_scale_dps, random);

    return digital_fixed(digital / 360, JP_Q24_ONE);
}

static jp_q24 accelerometer(const struct skid_steer_model *model, double m_s2, struct random *random)
{
    const double g = m_s2 / STANDARD_GRAVITY * (1 + model->accelerometer.scale_error) + model->accelerometer.bias_g;

    return digital_fixed(digital_sense(g, model->accelerometer.noise_rms_g, model->accelerometer.step_g,
                                       model->accelerometer.full_scale_g, random),
                         JP_Q24_ONE);
}

static jp_q16 current(const struct skid_steer_model *model, double ampere, struct random *random)
{
    const double full_scale = model->current_sense.full_scale_a;
    const double noisy = digital_sense(ampere, model->current_sense.noise_rms_a, 0, 0, random);

    return digital_fixed(digital_convert(noisy, -full_scale, full_scale, model->current_sense.bits), JP_Q16_ONE);
}

void skid_instruments_read(const struct skid_plant *plant, const uint32_t start[SKID_SIDES], struct random *random,
                           struct skid_samples *samples)
{
    const struct skid_steer_model *model = &plant->model;
    const struct skid_attitude *seen = &plant->attitude;
    const struct skid_side *sides = plant->state.sides;
    const int counts = model->encoder.counts_per_turn;

    samples->encoder_left = digital_count(sides[SKID_LEFT].angle, counts, start[SKID_LEFT]);
    samples->encoder_right = digital_count(sides[SKID_RIGHT].angle, counts, start[SKID_RIGHT]);
    samples->roll_rate = gyro(model, seen->roll_rate, random);
    samples->pitch_rate = gyro(model, seen->pitch_rate, random);
    samples->yaw_rate = gyro(model, plant->state.turn_rate, random);
    samples->accel_x = accelerometer(model, seen->force_ahead, random);
    samples->accel_y = accelerometer(model, seen->force_left, random);
    samples->accel_z = accelerometer(model, STANDARD_GRAVITY * seen->normal[2], random);
    samples->current_left = current(model, seen->current[SKID_LEFT], random);
    samples->current_right = current(model, seen->current[SKID_RIGHT], random);
    samples->bus_voltage = digital_fixed(
        digital_convert(seen->bus_voltage, 0, model->bus_sense.full_scale_v, model->bus_sense.bits), JP_Q16_ONE);
}
