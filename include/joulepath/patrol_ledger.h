/**
 * What the legs of a patrol will take and have taken: forecasts a leg by its plan, adds up what is driven, and learns
 * from it the robot (four_wheel_learner.h) and what is in its way (patrol_forecast.h).
 *
 *   begin   with the leg's plan, when it sets out
 *   add     each stretch of the control tick (four_wheel_robot.h)
 *   end     when it stands at its goal; or forget, where it did not come there
 *
 * Single-precision floating point: part of libjoulepath_float. Not for ISRs.
 */
#ifndef JOULEPATH_PATROL_LEDGER_H
#define JOULEPATH_PATROL_LEDGER_H

#include <joulepath/four_wheel_learner.h>
#include <joulepath/four_wheel_robot.h>
#include <joulepath/patrol_forecast.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A leg, as it is foretold when it begins. */
struct jp_patrol_leg_forecast {
    float energy;    /**< J */
    float deviation; /**< standard deviation, J */
    float duration;  /**< of a robot alone on its path, s */
};

/** A leg that was driven. */
struct jp_patrol_leg_result {
    struct jp_patrol_leg_forecast forecast;
    jp_energy energy; /**< by the meter */
    enum jp_learned learned;
};

/** The members but `internal` may be read. */
struct jp_patrol_ledger {
    struct jp_four_wheel_learner learner;
    struct jp_patrol_pace pace;
    float robot; /**< how many times as much plans take by what was learned of the robot since the start */
    struct jp_patrol_leg_forecast forecast; /**< of the leg that is driven, or was last */
    struct jp_patrol_leg_result result;     /**< of the last that came to its end */
    uint16_t begun;                         /**< legs, wrapping */
    uint16_t ended;                         /**< of them, that came to their end */
    uint32_t learned_from;                  /**< legs, saturating */
    uint32_t left_out;                      /**< legs, saturating */
    struct {
        struct jp_four_wheel_drive driven;  /* of the leg */
        struct jp_four_wheel_drive planned; /* without what is in the way */
        jp_energy taken;                    /* of the leg so far */
        jp_energy shown;                    /* by the meter at the end of the last stretch */
        bool has_shown;
        bool is_under_way;
    } internal;
};

/** Starts with nothing learned. Both must have passed their checks; their pointers are kept. Constant time. */
void jp_patrol_ledger_start(struct jp_patrol_ledger *ledger, const struct jp_factor_learning *learning,
                            const struct jp_four_wheel_energy_model *built_in);

/** What a plan takes by what is known now. As jp_patrol_plan_energy(). */
enum jp_status jp_patrol_ledger_foretell(const struct jp_patrol_ledger *ledger, const struct jp_patrol_config *config,
                                         const struct jp_patrol_plan *plan, struct jp_patrol_leg_forecast *forecast);

/** A leg begins; one that is under way is forgotten. Failures as jp_patrol_plan_energy(): then it is not. */
enum jp_status jp_patrol_ledger_begin(struct jp_patrol_ledger *ledger, const struct jp_patrol_config *config,
                                      const struct jp_patrol_plan *plan);

/** Takes the next stretch, whether a leg is under way or not. */
void jp_patrol_ledger_add(struct jp_patrol_ledger *ledger, const struct jp_four_wheel_stretch *stretch);

/** The leg has come to its end, of which is learned. Without one under way nothing is done. */
void jp_patrol_ledger_end(struct jp_patrol_ledger *ledger);

/** The leg does not come to its end. */
void jp_patrol_ledger_forget(struct jp_patrol_ledger *ledger);

#ifdef __cplusplus
}
#endif

#endif
