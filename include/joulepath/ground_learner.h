/**
 * Learns what grounds take that a map tells apart, from the measured energy of legs on them: of each class (ground.h)
 * two factors against the ground that the robot's energy model was made for.
 *
 * Class 0 is that ground: what it takes, the robot's own learner knows. The factors of each other class are those of
 * factor_learning.h, with a filter of their own:
 *
 *   E − E(x) = Σ f_k Δx_k + noise,    noise² = deviation² + Σ over the other classes (f_j S_j)²
 *
 * where `deviation` is that of the leg's forecast by the robot's learner. So a leg over several classes teaches each of
 * them as a joint filter would that knew nothing of what they have in common; what they have in common then is left
 * out. Where all legs cross the same classes in the same shares, their factors make up for each other, and are surer of
 * themselves than they may be. Whatever the robot's kind, the caller tells the energy of a leg as learned so far, and
 * its changes.
 *
 * All memory is the caller's. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_GROUND_LEARNER_H
#define JOULEPATH_GROUND_LEARNER_H

#include <joulepath/factor_learning.h>
#include <joulepath/ground.h>

#ifdef __cplusplus
extern "C" {
#endif

/** What differs between grounds: their resistance to rolling, and to the slide of wheels that turn the robot. */
enum { JP_GROUND_ROLLING, JP_GROUND_FRICTION, JP_GROUND_FACTORS };

/** Change of a leg's energy by the relative change of the factors of each class, 2ⁿ J, Q16. Those of class 0 are not
 *  read. */
struct jp_ground_change {
    int64_t by_factor[JP_GROUND_CLASSES][JP_GROUND_FACTORS];
};

/** Private but for the members with a comment. */
struct jp_ground_learner {
    const struct jp_factor_learning *learning;
    struct jp_learned_state states[JP_GROUND_CLASSES]; /**< by class, to be stored; that of class 0 learns nothing */
    uint32_t outliers;                                 /**< since the start, of all classes, saturating */
    uint32_t changes;                                  /**< of grounds since the start, saturating */
    struct jp_learned_watch watches[JP_GROUND_CLASSES];
};

/** Of grounds of which nothing is known: factors of 1 ± 1 of rolling and 1 ± ½ of friction. Places of a class differ:
 *  the noise is 1/32 of a leg's energy, whatever the robot's forecast. */
extern const struct jp_factor_learning jp_ground_learning;

/** Starts with nothing learned. The learning must have passed its check; its pointer is kept. Constant time. */
void jp_ground_learner_start(struct jp_ground_learner *learner, const struct jp_factor_learning *learning);

/** Continues with the stored state of a class, after jp_ground_learner_start(). JP_ERR_ARGUMENT also: no such class, or
 *  class 0. Else as jp_learner_restore(). */
enum jp_status jp_ground_learner_restore(struct jp_ground_learner *learner, uint8_t ground,
                                         const struct jp_learned_state *state, const char **field);

/**
 * Learns from a leg that was driven: `expected` of it as learned so far, with the deviation by what is not known of the
 * robot, its changes, and `measured` by jp_energy_to_q16(). *learned says what became of it: the most of what became of
 * it in a class, in the order JP_LEARNED_CHANGE, JP_LEARNED_OUTLIER, JP_LEARNED. JP_ERR_ARGUMENT: a pointer is null.
 * JP_ERR_OVERFLOW: a change exceeds Q16; nothing is learned then and *learned not written. Work: for each class that
 * the leg crosses, that of jp_learner_update_leg().
 */
enum jp_status jp_ground_learner_update(struct jp_ground_learner *learner, const struct jp_forecast *expected,
                                        const struct jp_ground_change *change, jp_q16 measured,
                                        enum jp_learned *learned);

/** The factors of a class, Q16, and their standard deviations; JP_FACTOR_MIN…JP_FACTOR_MAX; of class 0, ones and
 *  zeros. Two multiplications; two square roots. */
void jp_ground_learner_factors(const struct jp_ground_learner *learner, uint8_t ground,
                               jp_q16 factor[JP_GROUND_FACTORS]);
void jp_ground_learner_deviations(const struct jp_ground_learner *learner, uint8_t ground,
                                  jp_q16 deviation[JP_GROUND_FACTORS]);

/** Adds up what legs change by, for jp_ground_learner_widen(). */
void jp_ground_change_add(struct jp_ground_change *sum, const struct jp_ground_change *change);

/** Widens a forecast, whose deviation is that by what is not known of the robot, by what is not known of the grounds.
 *  JP_ERR_OVERFLOW: a change exceeds 8 192 units or the deviation its format; the deviation is INT32_MAX then. Work: a
 *  square root. */
enum jp_status jp_ground_learner_widen(const struct jp_ground_learner *learner, const struct jp_ground_change *change,
                                       struct jp_forecast *forecast);

#ifdef __cplusplus
}
#endif

#endif
