/**
 * Eight-state LQR-PID (paper eq. 4–5, Fig. 3).
 *
 * The robot is symmetric, so the optimal 2 × 8 gain has one row for what both motors share and one for their
 * difference:
 *
 *   common = kθ eθ + kψ eψ + kθ̇ eθ̇ + kψ̇ eψ̇ + k∫θ ∫eθ        ul = common − difference
 *   difference = kφ eφ + kφ̇ eφ̇ + k∫φ ∫eφ                      ur = common + difference
 *
 * Saturation favours balance: the voltage for θ is limited so that `pitch_reserve` volts remain for ψ, and yaw gets
 * what the common part leaves. Anti-windup: an integrator stops while its own limit is active.
 */
#ifndef JOULEPATH_LQR_H
#define JOULEPATH_LQR_H

#include <joulepath/estimator.h>
#include <joulepath/reference.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Gains in V per turn, V·s per turn and V per turn·s. The magnitudes of each row add up to at most 32 767 V; an
 *  integral gain is at most 32 767 · tick_rate / 1 024 V per turn·s. */
struct jp_lqr_config {
    uint32_t tick_rate; /**< calls a second; 100…10 000 */
    jp_q16 wheel;
    jp_q16 pitch;
    jp_q16 wheel_rate;
    jp_q16 pitch_rate;
    jp_q16 wheel_integral;
    jp_q16 yaw;
    jp_q16 yaw_rate;
    jp_q16 yaw_integral;
    jp_q16 pitch_reserve; /**< V kept for pitch; 0…the supply */
};

struct jp_lqr {
    int64_t wheel_integral;     /**< Σ eθ, 2⁻²⁴ turn·tick */
    int64_t yaw_integral;       /**< Σ eφ, 2⁻²⁴ turn·tick */
    jp_q16 integral_gain_wheel; /**< V per 2⁻¹⁴ turn·tick, from the configuration */
    jp_q16 integral_gain_yaw;
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range, of a row that adds up to 0 or to
 *  too much its first gain. JP_ERR_ARGUMENT: a pointer is null. Not for ISRs. */
enum jp_status jp_lqr_check(const struct jp_lqr_config *config, const char **field);

/** Takes the gains from the configuration and resets the integrators. Two 64-bit divisions. */
void jp_lqr_start(struct jp_lqr *lqr, const struct jp_lqr_config *config);

/** Resets the integrators. Constant time; for the control ISR. */
void jp_lqr_restart(struct jp_lqr *lqr);

/**
 * One tick: errors, integrators, gain product, limits. |ul|, |ur| <= `limit` (V, >= 0).
 * Errors are limited to [−64, 64) turns. Within 5 mV of exact arithmetic while no error exceeds its format.
 * Cannot fail; constant time; for the control ISR.
 */
void jp_lqr_update(struct jp_lqr *lqr, const struct jp_lqr_config *config, const struct jp_reference *reference,
                   const struct jp_motion_state *state, jp_q16 limit, struct jp_voltages *voltages);

#ifdef __cplusplus
}
#endif

#endif
