/** The odometry's configuration of a skid-steered or differential-drive robot, in double precision: what
 * tools/design/skid_odometry.py makes. */
#ifndef JOULEPATH_TESTS_SUPPORT_SKID_ODOMETRY_CONFIG_H
#define JOULEPATH_TESTS_SUPPORT_SKID_ODOMETRY_CONFIG_H

#include <joulepath/skid_odometry.h>
#include <math.h>

#include "sim/skid_steer/skid_steer_model.h"

/** Steady turn on the spot on level ground by the tyre's model: where treads slip, and how force makes them creep. */
struct skid_pivot {
    double ratio;       /* turn of the body over that of the wheels */
    double creep_along; /* m per radian and g */
    double creep_across;
    double shift_along;  /* m per radian to the left and g to the left */
    double shift_across; /* the same by g ahead */
    double slide_most;   /* to the side per radian at most, m */
    double creep;        /* slip on a straight way per g */
    double caster_drag;  /* g */
    double growth;       /* of the ratio, share for (m/turn)² of slip aside */
    double force;        /* (right − left) of the sides that turn it, g */
};

struct skid_pivot_sums {
    double moment;     /* of the slip along less those that brake the turn, over weight */
    double hold_along; /* growth of the force with slip, over weight */
    double hold_across;
    double force;      /* along, of both sides */
    double push;       /* of a tread's force across, by the load that moves behind and its distance */
    double slip;       /* m/s */
    double saturation; /* share of the tread's yield that is sliding */
};

static inline double skid_axle_squares(const struct skid_steer_model *model)
{
    double squares = 0;

    for (int axle = 0; axle < model->wheel.axles; axle++) {
        const double place = model->body.wheelbase_m * ((double)axle / (model->wheel.axles - 1) - 0.5);
        squares += place * place;
    }
    return squares;
}

/* Share of the weight on an axle, at `x` ahead of the middle. */
static inline double skid_axle_share(const struct skid_steer_model *model, double x)
{
    if (model->caster.ahead_m != 0) {
        return 1 - model->body.centre_ahead_m / model->caster.ahead_m;
    }
    return 1.0 / model->wheel.axles + model->body.centre_ahead_m * x / skid_axle_squares(model);
}

static inline double skid_caster_drag(const struct skid_steer_model *model)
{
    return model->caster.ahead_m == 0 ? 0 : model->caster.rolling * model->body.centre_ahead_m / model->caster.ahead_m;
}

/* At 1 rad/s, with treads that slip by `slip` m/s along. */
static inline struct skid_pivot_sums skid_pivot_sums(const struct skid_steer_model *model, double slip)
{
    const double half = model->body.width_m / 2;
    const double relaxation = 1.2 / model->tyre.contact_length_m / model->tyre.stiffness_per_m;
    struct skid_pivot_sums sums = {.moment = -skid_caster_drag(model) * fabs(model->caster.ahead_m)};

    for (int axle = 0; axle < model->wheel.axles; axle++) {
        const double x =
            model->wheel.axles == 1 ? 0 : model->body.wheelbase_m * ((double)axle / (model->wheel.axles - 1) - 0.5);
        const double share = skid_axle_share(model, x);
        const double size = hypot(slip, x) + 1e-12;
        const double yield = size / model->ground.friction + relaxation * (half + slip);
        const double fall = 1 / (model->ground.friction * size * yield * yield);
        sums.moment += share * (half * slip - x * x) / yield;
        sums.slip += share * size;
        sums.saturation += share * size / model->ground.friction / yield;
        sums.force += share * slip / yield;
        sums.hold_along += share * (1 / yield - slip * slip * fall);
        sums.push += model->wheel.axles == 1 ? 0 : x * x / skid_axle_squares(model) / yield;
        sums.hold_across += share * (1 / yield - x * x * fall);
    }
    return sums;
}

static inline struct skid_pivot skid_pivot_of(const struct skid_steer_model *model)
{
    const double half = model->body.width_m / 2;
    double low = 0;
    double high = 100 * half;

    for (int i = 0; i < 60; i++) {
        const double middle = (low + high) / 2;
        if (skid_pivot_sums(model, middle).moment < 0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    const struct skid_pivot_sums sums = skid_pivot_sums(model, high);
    const double on_wheels = model->caster.ahead_m == 0 ? 1 : skid_axle_share(model, 0);

    return (struct skid_pivot){
        .ratio = half / (half + high),
        .creep_along = 1 / sums.hold_along,
        .creep_across = 1 / sums.hold_across,
        .slide_most = model->wheel.axles == 1 ? 1 / sums.hold_across : model->body.wheelbase_m / 2,
        .shift_along = model->body.centre_height_m * sums.force / half / sums.hold_along,
        .shift_across = model->body.centre_height_m * sums.push / sums.hold_across,
        .creep = 1.2 / model->tyre.contact_length_m / model->tyre.stiffness_per_m / on_wheels,
        .caster_drag = skid_caster_drag(model),
        .growth = high / (half + high) * pow(sums.saturation / on_wheels / (2 * M_PI * sums.slip / on_wheels), 2),
        .force = sums.force,
    };
}

static inline int32_t skid_fixed(double value, int bits)
{
    return (int32_t)floor(ldexp(value, bits) + 0.5);
}

/* g: of the mean over a step, and of the acceleration that the encoders tell. */
static inline double skid_accel_noise(const struct skid_steer_model *model, double step_ticks, double step)
{
    const double unmodelled = 0.003;
    const double count = 2 * M_PI * model->wheel.radius_m / model->encoder.counts_per_turn;
    const double of_counts = count / sqrt(6) / (step * step * STANDARD_GRAVITY);

    return sqrt(unmodelled * unmodelled + pow(model->accelerometer.noise_rms_g, 2) / step_ticks +
                of_counts * of_counts);
}

static inline struct jp_skid_odometry_config skid_odometry_config_of(const struct skid_steer_model *model)
{
    const struct skid_pivot pivot = skid_pivot_of(model);
    const double rate = model->control.rate_hz;
    const double step_ticks = fmin(fmax(floor(rate / 100 + 0.5), 6), 32);
    const double counts = model->encoder.counts_per_turn;
    const double slipping = 1 - pivot.ratio;
    const double tilt = sin(model->limits.slope_deg * M_PI / 180) / 4;

    return (struct jp_skid_odometry_config){
        .tick_rate = (uint32_t)rate,
        .step_ticks = (uint32_t)step_ticks,
        .way_per_count = skid_fixed(2 * M_PI * model->wheel.radius_m / counts, 40),
        .turn_per_count = skid_fixed(model->wheel.radius_m / (counts * model->body.width_m), 40),
        .ratio = skid_fixed(pivot.ratio, 24),
        .ratio_deviation = skid_fixed(0.002 * pivot.ratio + 0.003 * slipping, 24),
        .scale_deviation = skid_fixed(model->gyro.scale_error, 24),
        .bias_deviation = skid_fixed(fmax(model->gyro.bias_dps, 0.01) / 360, 24),
        .bias_memory = 10000000,
        .gyro_noise = skid_fixed(
            fmax(sqrt(pow(model->gyro.noise_rms_dps, 2) + pow(model->gyro.step_dps, 2) / 12), 0.001) / 360, 24),
        .way_noise = skid_fixed(0.03 / (2 * M_PI), 24),
        .turn_noise = skid_fixed(0.005 + 0.02 * slipping, 24),
        .tilt_deviation = skid_fixed(tilt, 24),
        .tilt_change = skid_fixed(0.8 * tilt, 24),
        .accel_noise = skid_fixed(skid_accel_noise(model, step_ticks, step_ticks / rate), 24),
        .accel_offset = skid_fixed(model->accelerometer.bias_g, 24),
        .ratio_growth = skid_fixed(pivot.growth, 24),
        .creep = skid_fixed(pivot.creep, 24),
        .turn_creep_along = skid_fixed(pivot.creep_along, 24),
        .turn_creep_across = skid_fixed(pivot.creep_across, 24),
        .turn_shift_along = skid_fixed(pivot.shift_along, 24),
        .turn_shift_across = skid_fixed(pivot.shift_across, 24),
        .turn_slide_most = skid_fixed(pivot.slide_most, 24),
        .caster_drag = skid_fixed(pivot.caster_drag, 24),
        .turn_force = skid_fixed(pivot.force, 24),
        .force_per_ampere = skid_fixed(model->motor.torque_constant * model->motor.gear_ratio /
                                           (model->wheel.radius_m * model->body.mass_kg * STANDARD_GRAVITY),
                                       24),
        .efficiency = skid_fixed(model->motor.efficiency, 24),
        .rolling = skid_fixed(model->ground.rolling, 24),
        .way_deviation = skid_fixed(0.002 + 0.3 * pivot.creep * tilt, 24),
        .way_drift = skid_fixed(2 * pivot.creep * tilt, 24),
        .turn_drift = skid_fixed(0.25 * pivot.creep_across * tilt, 24),
    };
}

#endif
