/**
 * The trajectory of least energy within a time, or the fastest within an energy.
 *
 * Let a second that is saved be worth p watts: the least of E + p T is then at a cruise of √((Ps + p)/b1), so that one
 * number is left to find, and the rule does the rest. Where p is 0, at jp_cruise_speed(), the energy is least; faster
 * takes more, and slower takes more of both. Transients, legs that are slowed for their turns or for a stop, and
 * cruises for which the rule finds nothing make exceptions, so none of it is taken for granted: cruises from a quarter
 * of that up to the task's are tried in equal steps, then about the best of them in steps that are halved each time.
 *
 * The best is, of the trajectories that keep the budget, the one of least energy or of least time; where none keeps it,
 * the one that comes nearest.
 */
#ifndef JOULEPATH_TRAJECTORY_BUDGET_H
#define JOULEPATH_TRAJECTORY_BUDGET_H

#include <joulepath/trajectory_energy.h>
#include <joulepath/trajectory_rule.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Slices of one search; each plans once. */
#define JP_BUDGET_SLICES 50U

enum jp_budget_kind {
    JP_BUDGET_SECONDS, /**< least energy within a time */
    JP_BUDGET_JOULES   /**< least time within an energy */
};

struct jp_trajectory_budget_config {
    struct jp_trajectory_task task;      /**< its cruise is the greatest that may be taken: the robot's limits.speed */
    const struct jp_energy_model *model; /**< which passed its check */
    enum jp_budget_kind kind;
    jp_q16 limit;                   /**< s, or J in the model's unit (energy.h); above 0 */
    struct jp_trajectory_leg *legs; /**< one for each target; the caller's memory */
    struct jp_trajectory *trajectory;
};

/** A cruise, and what the trajectory with it takes. */
struct jp_budget_plan {
    jp_q24 cruise; /**< m/s */
    jp_q16 seconds;
    jp_q16 energy; /**< J in the model's unit */
};

/** Private. */
struct jp_trajectory_budget_internal {
    struct jp_trajectory_budget_config config;
    jp_q24 low; /**< m/s */
    unsigned slices_left;
};

/** `best` may be read. */
struct jp_trajectory_budget {
    struct jp_budget_plan best; /**< so far; seconds and energy are INT32_MAX where they are above 32 767 */
    struct jp_trajectory_budget_internal internal;
};

/**
 * Begins a search and keeps the configuration. Its targets stay until the search ends, its legs as long as the
 * trajectory; every slice writes to legs and trajectory, so they are none that is being driven. JP_ERR_ARGUMENT: a
 * pointer is null, or the limit, the kind or the task's cruise is out of its range. Constant time; not for ISRs.
 */
enum jp_status jp_trajectory_budget_start(struct jp_trajectory_budget *budget,
                                          const struct jp_trajectory_budget_config *config);

/**
 * One slice: a trajectory by the rule, its energy and its time. JP_WORKING: there is more to do, call again.
 * JP_OK: the trajectory is planned, and `best` says what it takes: not more than the limit.
 * JP_ERR_INFEASIBLE: none keeps the budget. `best` says how much it must be at least, and the trajectory is that one;
 * where the rule finds none at any cruise, both figures of `best` are INT32_MAX and the trajectory is not to be driven.
 * JP_ERR_OVERFLOW: the best one takes more than 32 767 s or J.
 * JP_ERR_STATE: nothing was begun, or the search has ended. JP_ERR_ARGUMENT: a null pointer. Else what
 * jp_trajectory_by_rule() says of the task, which is then not planned.
 * Seen against 300 cruises on each of 4 000 random routes: 7 times more than 0.1 % above the best of them, 1.5 % at
 * most; 34 times and 12 % where also the voltage is drawn, down to hardly enough
 * (tests/property/prop_trajectory_budget.c). JP_BUDGET_SLICES slices in all, each of O(count): tests/bench/FIGURES.md
 * has the instructions of a trajectory and of its energy. Not for ISRs.
 */
enum jp_status jp_trajectory_budget_work(struct jp_trajectory_budget *budget);

#ifdef __cplusplus
}
#endif

#endif
