/** The controller against floating point: random states of the driving range, integrators and limits included. */
#ifndef JOULEPATH_TESTS_SUPPORT_LQR_ORACLE_H
#define JOULEPATH_TESTS_SUPPORT_LQR_ORACLE_H

#include <joulepath/robot.h>

#include <math.h>

#include "sim/base/random.h"

/** Ticks after which the integrators start anew. */
#define LQR_RUN_TICKS 1000

struct lqr_oracle {
    double wheel_integral; /**< turn·s */
    double yaw_integral;   /**< turn·s */
};

static double lqr_volts(jp_q16 voltage)
{
    return voltage / 65536.0;
}

static double lqr_turns(jp_q24 turns)
{
    return turns / 16777216.0;
}

static double lqr_phase_turns(jp_phase difference)
{
    return (double)(int64_t)difference * 0x1p-56;
}

static double lqr_clamp(double value, double limit)
{
    return fmin(fmax(value, -limit), limit);
}

static void lqr_integrate(double *integral, double error, double gain, double cut, double dt)
{
    const double push = gain < 0 ? -error : error;

    if (!(cut > 0 && push > 0) && !(cut < 0 && push < 0)) {
        *integral += error * dt;
    }
}

/** lqr.h in floating point; voltages[]: left, right, V. */
static void lqr_exact(struct lqr_oracle *oracle, const struct jp_lqr_config *config,
                      const struct jp_reference *reference, const struct jp_motion_state *state, double limit,
                      double voltages[2])
{
    const double dt = 1.0 / config->tick_rate;
    const double wheel = lqr_phase_turns(reference->wheel.angle - state->wheel);
    const double yaw = lqr_phase_turns(reference->yaw.angle - state->yaw);
    const double reserve = lqr_volts(config->pitch_reserve);

    const double travel = lqr_volts(config->wheel) * wheel +
                          lqr_volts(config->wheel_rate) * lqr_turns(reference->wheel.rate - state->wheel_rate) +
                          lqr_volts(config->wheel_integral) * oracle->wheel_integral;
    const double balance = -lqr_volts(config->pitch) * lqr_turns(state->pitch) -
                           lqr_volts(config->pitch_rate) * lqr_turns(state->pitch_rate);
    const double common = lqr_clamp(lqr_clamp(travel, fmax(limit - reserve, 0)) + balance, limit);
    const double wanted = lqr_volts(config->yaw) * yaw +
                          lqr_volts(config->yaw_rate) * lqr_turns(reference->yaw.rate - state->yaw_rate) +
                          lqr_volts(config->yaw_integral) * oracle->yaw_integral;
    const double difference = lqr_clamp(wanted, limit - fabs(common));

    lqr_integrate(&oracle->wheel_integral, wheel, config->wheel_integral, travel + balance - common, dt);
    lqr_integrate(&oracle->yaw_integral, yaw, config->yaw_integral, wanted - difference, dt);
    voltages[0] = common - difference;
    voltages[1] = common + difference;
}

static jp_q24 lqr_random_turns(struct random *random, double limit)
{
    return (jp_q24)(random_uniform(random, -limit, limit) * 16777216.0);
}

static jp_phase lqr_random_phase(struct random *random, double limit)
{
    return (jp_phase)(int64_t)(random_uniform(random, -limit, limit) * 0x1p56);
}

/** Errors: θ ±1 turn, θ̇ ±2 turn/s, φ ±80°, φ̇ ±0.5 turn/s; ψ ±20°, ψ̇ ±1 turn/s; phases anywhere. */
static void lqr_random_state(struct random *random, struct jp_reference *reference, struct jp_motion_state *state)
{
    state->wheel = lqr_random_phase(random, 128);
    state->yaw = lqr_random_phase(random, 128);
    state->pitch = lqr_random_turns(random, 20.0 / 360.0);
    state->pitch_rate = lqr_random_turns(random, 1);
    state->wheel_rate = lqr_random_turns(random, 2);
    state->yaw_rate = lqr_random_turns(random, 0.25);
    reference->wheel.angle = state->wheel + lqr_random_phase(random, 1);
    reference->wheel.rate = state->wheel_rate + lqr_random_turns(random, 2);
    reference->yaw.angle = state->yaw + lqr_random_phase(random, 80.0 / 360.0);
    reference->yaw.rate = state->yaw_rate + lqr_random_turns(random, 0.5);
}

/** Both integrators at the same random sums of up to 2 turn·s. */
static void lqr_random_integrals(struct random *random, const struct jp_lqr_config *config, struct jp_lqr *lqr,
                                 struct lqr_oracle *oracle)
{
    const double unit = 16777216.0 * config->tick_rate;

    jp_lqr_start(lqr, config);
    lqr->wheel_integral = (int64_t)(random_uniform(random, -2, 2) * unit);
    lqr->yaw_integral = (int64_t)(random_uniform(random, -2, 2) * unit);
    *oracle = (struct lqr_oracle){(double)lqr->wheel_integral / unit, (double)lqr->yaw_integral / unit};
}

/** Largest |Δu| of either motor over `count` states, mV. Half of the runs have so much supply that no limit acts. */
static double lqr_worst_millivolts(const struct jp_lqr_config *config, uint64_t count, uint64_t seed)
{
    struct random random;
    struct jp_reference reference = {0};
    struct jp_motion_state state;
    struct jp_lqr lqr = {0};
    struct lqr_oracle oracle = {0};
    jp_q16 limit = 0;
    double worst = 0;

    random_init(&random, seed);
    for (uint64_t i = 0; i < count; i++) {
        struct jp_voltages voltages;
        double exact[2];

        if (i % LQR_RUN_TICKS == 0) {
            lqr_random_integrals(&random, config, &lqr, &oracle);
            limit = random_uniform(&random, 0, 1) < 0.5 ? INT32_MAX : JP_Q16(24);
        }
        lqr_random_state(&random, &reference, &state);
        jp_lqr_update(&lqr, config, &reference, &state, limit, &voltages);
        lqr_exact(&oracle, config, &reference, &state, lqr_volts(limit), exact);
        worst = fmax(worst, fabs(lqr_volts(voltages.left) - exact[0]));
        worst = fmax(worst, fabs(lqr_volts(voltages.right) - exact[1]));
    }
    return worst * 1000;
}

#endif
