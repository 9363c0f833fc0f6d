/**
 * Learns the energy model while driving, from the measured energy of each segment or leg of a trajectory, and states
 * the uncertainty of forecasts.
 *
 * Robots of a kind differ by few causes: ground, payload, motors. tools/design/learning.py varies them in the robot
 * file and finds the few directions in which the 15 parameters then move. The learner estimates the coordinates x of
 * the robot along these directions, with the prior x ~ N(0, I):
 *
 *   parameters = built-in + D x,    E − E_built-in = f x + noise,    f = Dᵀ φ
 *
 * with φ the regressors of horizon.h, of a leg with its b1 and b2 and `leg` of its transients. Recursive least squares
 * in square-root form (Potter), P = S Sᵀ. Forgetting never exceeds the prior covariance: S ← S (I + (I − SᵀS)/(2
 * memory)), the first step of Newton's iteration from S towards an orthogonal matrix. It keeps every singular value in
 * (0, 1], so that P <= I in fixed point, whatever is driven and for how long; a direction that is not excited keeps its
 * value and returns to the prior uncertainty.
 *
 * J is the unit of the built-in model (energy.h): of the tables, of what is measured and of forecasts.
 */
#ifndef JOULEPATH_LEARNER_H
#define JOULEPATH_LEARNER_H

#include <joulepath/horizon.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_LEARNING_DIRECTIONS 4

/** x saturates here. It is seldom beyond ±2 for a robot within what tools/design/learning.py varies. */
#define JP_LEARNED_MAX JP_Q24(8)

/** A segment further than so many standard deviations from what was expected is an outlier, and counts as if it were so
 *  far; a leg, so many times its spread. */
#define JP_OUTLIER_DEVIATIONS 4

/** Cause of a change of the energy. */
enum jp_cause {
    JP_CAUSE_NONE,   /**< no change so far, or fewer than 10 segments were learned from since; the cause is judged after
                          10 segments, and again up to 40 */
    JP_CAUSE_GROUND, /**< the ground's friction changed */
    JP_CAUSE_PAYLOAD, /**< the payload changed */
    JP_CAUSE_OTHER    /**< neither of them did by more than twice its standard deviation */
};

/** One robot under one controller, for one definition of energy; made by tools/design/learning.py. */
struct jp_learning {
    /** D: change of a1…a13, b1 and b2, each in its unit, per unit of x; |D| <= 4 096. */
    jp_q16 direction[JP_ENERGY_PARAMETERS][JP_LEARNING_DIRECTIONS];
    /** What x tells of two causes when legs taught it; learned from segments it tells them less well. */
    jp_q16 ground[JP_LEARNING_DIRECTIONS];  /**< relative change of the ground's friction per unit of x; ±16 */
    jp_q16 payload[JP_LEARNING_DIRECTIONS]; /**< kg per unit of x; ±256 */
    jp_q16 ground_deviation;  /**< standard deviation of the part of it that x does not explain; above 0, at most 16 */
    jp_q16 payload_deviation; /**< kg; above 0, at most 256 */
    jp_q16 noise_relative;    /**< standard deviation of a segment's energy about the model: share of it, 0…1, */
    jp_q16 noise_transient;   /**< share of what the transients of earlier steps add, 0…16, */
    jp_q16 noise;             /**< and J; above 0, at most 1 024. The three are independent. */
    /** Relative change of what each transient of a leg takes, per unit of x; ±256. */
    jp_q16 leg[JP_LEG_TRANSIENTS][JP_LEARNING_DIRECTIONS];
    jp_q16 leg_noise_relative;  /**< standard deviation of a leg's energy about the model: share of it, 0…1, */
    jp_q16 leg_noise_transient; /**< share of what its transients take, all counted as spent, 0…16, */
    jp_q16 leg_noise;           /**< and J; above 0, at most 1 024. The three are independent. */
    /** What one leg takes too much, the next often takes too little, so that single legs are further from the model
     * than this noise, which makes forecasts of routes: by this factor; 1…16. */
    jp_q16 leg_spread;
    uint32_t memory;   /**< segments after which a measurement counts 1/e; 8…1 024 */
    uint32_t identity; /**< of the numbers above, not 0: a state that was learned with others is invalid */
};

/** What became of a measurement. */
enum jp_learned {
    JP_LEARNED,         /**< taken */
    JP_LEARNED_NOTHING, /**< the segment says nothing about any parameter (a stand): nothing is learned or forgotten */
    JP_LEARNED_OUTLIER, /**< taken, but further from the expectation than it counts. Too many of them in the first
                             8 segments after a start or a change are no change: the noise is taken to be larger,
                             P returns to I, and this measurement is left out */
    JP_LEARNED_CHANGE   /**< too many outliers in a short time: robot or ground changed. x is kept as a first guess, P
                             returns to I, and this measurement is taken, its error limited to 64 deviations */
};

/** What is known. Persistent: hal/storage/parameters.h keeps it. */
struct jp_learned_state {
    jp_q24 x[JP_LEARNING_DIRECTIONS];                          /**< |x| <= JP_LEARNED_MAX */
    int32_t s[JP_LEARNING_DIRECTIONS][JP_LEARNING_DIRECTIONS]; /**< S, Q2.30 */
    jp_q16 noise_scale; /**< standard deviation of the residuals over the one of jp_learning; ¼…256, slowly adapted */
    uint32_t version;   /**< 0: nothing learned; one more with every segment taken, saturating */
    uint32_t identity;  /**< of the jp_learning that it belongs to */
};

/** Whether robot or ground changed. Private. */
struct jp_learned_watch {
    int32_t alarm;
    struct jp_learned_state before_change;
};

/** Private but for the members with a comment. */
struct jp_learner {
    const struct jp_learning *learning;
    const struct jp_energy_model *built_in;
    const struct jp_horizon *horizon;
    struct jp_learned_state state; /**< to be stored */
    uint32_t outliers;             /**< since the start, saturating */
    uint32_t changes;              /**< since the start, saturating */
    enum jp_cause cause;           /**< of the last change */
    uint32_t since_change;
    struct jp_learned_watch watch;
};

/** Sum of forecasts: the uncertainty of the parameters adds up linearly, the noise of the segments in square. All zero
 * at first. Private. */
struct jp_forecast_sum {
    int64_t energy;
    int64_t gradient[JP_LEARNING_DIRECTIONS];
    uint64_t variance;
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. Not
 *  for ISRs. */
enum jp_status jp_learning_check(const struct jp_learning *learning, const char **field);

/** Checks a state but for its identity, as jp_learning_check(). "s": a row is longer than P <= I allows, or so short
 *  that nothing would be learned any more. */
enum jp_status jp_learned_state_check(const struct jp_learned_state *state, const char **field);

/** A state in which nothing is learned, for the jp_learning of this identity; 0: for none, so that no learner restores
 *  it. Constant time. */
void jp_learned_state_start(struct jp_learned_state *state, uint32_t identity);

/** Starts with nothing learned. All three must have passed their checks; their pointers are kept. `horizon` may be
 * null: then only segments of T >= Ts can be forecast. Constant time. */
void jp_learner_start(struct jp_learner *learner, const struct jp_learning *learning,
                      const struct jp_energy_model *built_in, const struct jp_horizon *horizon);

/** Continues from a stored state, after jp_learner_start(). JP_ERR_CONFIG: *field names what is out of range as
 *  jp_learned_state_check(), or is "identity"; the learner stays as it is. JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_learner_restore(struct jp_learner *learner, const struct jp_learned_state *state, const char **field);

/**
 * Learns from a segment that was driven: `measured` J, electronics included, by jp_energy_to_q16(), from `start`. Not
 * for ISRs. *learned says what became of it. JP_ERR_ARGUMENT: null, or as jp_energy_regressors(); JP_ERR_OVERFLOW: the
 * energy or a regressor exceeds its format; nothing is learned and *learned not written. Bounded work:
 * tests/bench/FIGURES.md.
 */
enum jp_status jp_learner_update(struct jp_learner *learner, const struct jp_energy_start *start,
                                 const struct jp_segment_command *segment, jp_q16 measured, enum jp_learned *learned);

/** The same of a leg of a trajectory, whose energy changes with b1, b2 and what its transients take. Failures but for
 *  those of the segment. */
enum jp_status jp_learner_update_leg(struct jp_learner *learner, const struct jp_leg_energy *leg, jp_q16 measured,
                                     enum jp_learned *learned);

/** The energy model as learned: for jp_segment_optimise() and the planner. It passes jp_energy_model_check():
 *  parameters are limited to their ranges. Work: 60 multiplications. */
void jp_learner_model(const struct jp_learner *learner, struct jp_energy_model *model);

/** Ground friction relative to the robot file (1: as there; at least 0) and additional payload in kg (0: none), as
 *  learned. Eight multiplications. */
void jp_learner_causes(const struct jp_learner *learner, jp_q16 *ground, jp_q16 *payload);

/** Standard deviations of both, in their units. Two square roots. */
void jp_learner_cause_deviations(const struct jp_learner *learner, jp_q16 *ground, jp_q16 *payload);

/** Adds a segment of a route to a forecast; *start becomes the motion at its end. Failures as jp_energy_forecast() and
 *  jp_energy_regressors(): then neither *sum nor *start is written. At most 65 536 segments. */
enum jp_status jp_forecast_add(const struct jp_learner *learner, struct jp_forecast_sum *sum,
                               struct jp_energy_start *start, const struct jp_segment_command *segment);

/** Adds a leg of a trajectory. JP_ERR_OVERFLOW: its energy exceeds its format; nothing is written. JP_ERR_ARGUMENT: a
 *  pointer is null. At most 65 536 legs. */
enum jp_status jp_forecast_add_leg(const struct jp_learner *learner, struct jp_forecast_sum *sum,
                                   const struct jp_leg_energy *leg);

/** Expectation and standard deviation of the sum. JP_ERR_OVERFLOW: one of them is above 32 767 J, and saturated; also
 *  the deviation of a sum that a unit of x changes by more than 8 192 J. */
enum jp_status jp_forecast_total(const struct jp_learner *learner, const struct jp_forecast_sum *sum,
                                 struct jp_forecast *forecast);

/**
 * Whether `available` J, by jp_energy_to_q16(), are enough for a forecast at a confidence (one-sided, Q31, ½ to
 * 0.9999): *spare is the energy in J that remains at that confidence, or, if negative, that is missing; saturated. The
 * quantile of the normal distribution is within 0.001 standard deviations. JP_ERR_ARGUMENT: a pointer is null, or the
 * confidence is out of range. Constant time.
 */
enum jp_status jp_forecast_reserve(const struct jp_forecast *forecast, jp_q16 available, jp_q31 confidence,
                                   jp_q16 *spare);

/**
 * Probability that the energy which is left suffices for a way, of two forecasts in the same unit that err
 * independently of each other:
 *
 *   P(left − way >= 0) = Φ((left − way)/√(σ_left² + σ_way²))
 *
 * as Q31, within what 0.001 standard deviations make of it and limited to 0.0001…0.9999: farther out no forecast is
 * normal. It agrees with jp_forecast_reserve(): something is spare at a confidence where that is at most the
 * probability. JP_ERR_ARGUMENT: a pointer is null, or a deviation negative. Work: a square root, a division and 31
 * quantiles.
 */
enum jp_status jp_forecast_suffices(const struct jp_forecast *left, const struct jp_forecast *way, jp_q31 *probability);

#ifdef __cplusplus
}
#endif

#endif
