/**
 * Heading and speed at the waypoints of a route, by which the rule's trajectory (trajectory_rule.h) takes the least
 * energy, for cores with single-precision hardware.
 *
 * A waypoint is coupled with its neighbours alone: each of Newton's steps solves a block-tridiagonal system of two
 * unknowns a waypoint. The cost is that of trajectory_energy.h, in closed form, and a price of time at which the task's
 * cruise is the best speed; limits are those of the rule. A step that does not make the route cheaper is shortened. The
 * result are passages, which the rule and the pilot take: there is one way to plan and to drive.
 *
 * Over a long route, or anew on the way, the horizon recedes: only the first `places` legs are optimised, from a
 * waypoint that the route passes, and of the first targets, for which the robot has planned, what was found stays.
 */
#ifndef JOULEPATH_TRAJECTORY_OPTIMISER_H
#define JOULEPATH_TRAJECTORY_OPTIMISER_H

#include <joulepath/energy.h>
#include <joulepath/trajectory_energy.h>
#include <joulepath/trajectory_rule.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Evaluations of the route in one search, at most. */
#define JP_OPTIMISER_EVALUATIONS 7U

/** Private: a waypoint, and the leg that leads to it. Derivatives are J by rad and by m/s. */
struct jp_optimiser_place {
    jp_angle heading; /**< of the best so far */
    jp_q24 speed;
    jp_q24 pace;          /**< of the leg where nothing more is given, m/s */
    uint8_t is_free;      /**< enum jp_given: what is searched */
    float middle;         /**< heading of the leg's middle from its chord, rad */
    float step[2];        /**< of heading, rad, and speed, m/s */
    float slope[2];       /**< by them */
    float curve[3];       /**< by them, and both; then its factors */
    float coupling[2][2]; /**< with those at the next waypoint */
};

struct jp_trajectory_optimiser_config {
    struct jp_trajectory_task task;      /**< as for the rule; what its passages give stays */
    const struct jp_energy_model *model; /**< which passed its check */
    struct jp_back_emf back_emf;         /**< as of the meter that counts (trajectory_energy.h) */
    bool goes_on;  /**< the task's start is a waypoint that a trajectory passes with its heading, turn rate
                    * and speed, the last above 0; false: the robot is there in any motion */
    uint16_t held; /**< of so many targets, the first ones, what `passages` has at the start stays */
    struct jp_passage *passages;       /**< found: one for each target; the caller's memory */
    struct jp_optimiser_place *places; /**< one for each leg that is optimised; the caller's memory */
    uint16_t place_count;              /**< at least 1; more than targets are not used */
};

/** Private: what the next slice does. */
enum jp_optimiser_phase {
    JP_OPTIMISER_ENDED,
    JP_OPTIMISER_ASSESS,    /**< what the rule's own passages cost */
    JP_OPTIMISER_GIVE,      /**< and the same, given */
    JP_OPTIMISER_GIVE_LESS, /**< without the headings that slow a leg down */
    JP_OPTIMISER_TRY,       /**< passages of a step */
    JP_OPTIMISER_PLAN       /**< the rule plans with what was found */
};

/** Private: of a robot. J is the unit of its energy model. */
struct jp_cost_rates {
    float travel;    /**< by ν², J·s/m² */
    float momentum;  /**< by the square of the speed that is gained, J·s²/m² */
    float change[3]; /**< by the square of a change of speed in a blend of h s: by 1/h, 1/h³, 1/h⁵ */
    float turn;      /**< by φ̇², J·s/rad² */
    float bend;      /**< by φ̈², J·s³/rad² */
    float time;      /**< W */
    float lag;       /**< s² */
    float power;     /**< by the square of a voltage, W/V² */
    float back_emf;  /**< V·s/m */
};

/** Private. */
struct jp_trajectory_optimiser_internal {
    struct jp_trajectory_optimiser_config config;
    const struct jp_passage *given; /**< of the task */
    struct jp_trajectory_plan plan;
    struct jp_cost_rates rates;
    enum jp_optimiser_phase phase;
    uint16_t legs;       /**< that are optimised */
    uint16_t leg;        /**< of them, next */
    uint8_t evaluations; /**< left */
    uint8_t halvings;    /**< of the step, left */
    bool is_slowed;      /**< a leg is, by headings that are given */
    float share;         /**< of the step that is tried */
    float foretold;      /**< what the whole step saves, J */
    float cost;          /**< of this evaluation so far, J */
    float best;
};

/** `rule` and `found` may be read. */
struct jp_trajectory_optimiser {
    float rule;  /**< what the legs cost with the rule's own passages, by the closed form, J */
    float found; /**< and with those that were found; the same where none are better */
    struct jp_trajectory_optimiser_internal internal;
};

/**
 * Begins a search and keeps the configuration; targets, passages and places must stay until it ends. Passages are those
 * of the task, and those that are held, until the search ends; meanwhile nothing may be planned with them.
 * JP_ERR_ARGUMENT: a pointer is null, place_count or the count is 0, more are held than there are targets, or of a
 * start that goes on the speed is not above 0. O(count); not for ISRs.
 */
enum jp_status jp_trajectory_optimiser_start(struct jp_trajectory_optimiser *optimiser,
                                             const struct jp_trajectory_optimiser_config *config);

/**
 * One slice: a leg, or a step of the search, O(legs). JP_WORKING: there is more to do, call again.
 * JP_OK: the passages are found, and the rule plans the legs with them. Where none are better than the rule's own they
 * are as the task has them.
 * With all else the passages are as the task has them, and those that are held. JP_ERR_NO_PLAN: with those that were
 * found the rule plans no trajectory. JP_ERR_STATE: nothing was begun, or the search has ended. JP_ERR_ARGUMENT: a null
 * pointer. JP_ERR_ZERO_LENGTH, JP_ERR_ARGUMENT, JP_ERR_INFEASIBLE of the task: as jp_trajectory_by_rule().
 * Seen on 3 000 random routes of short and long legs, a third of them with little voltage: 0.02 % worse than the rule's
 * own at most (tests/property/prop_trajectory_optimiser.c). At most (JP_OPTIMISER_EVALUATIONS + 1) legs slices in all:
 * tests/bench/FIGURES.md has their instructions. Not for ISRs.
 */
enum jp_status jp_trajectory_optimiser_work(struct jp_trajectory_optimiser *optimiser);

#ifdef __cplusplus
}
#endif

#endif
