/** What kinds whose energy has factors tell of those that were learned: LearnedFactors and LearnedDeviations. */
#ifndef JOULEPATH_HAL_APP_ECU_FACTORS_H
#define JOULEPATH_HAL_APP_ECU_FACTORS_H

#include "hal/app/ecu_robot.h"

#ifdef __cplusplus
extern "C" {
#endif

struct jp_ecu_factors {
    jp_q16 rolling;
    jp_q16 friction; /**< of treads that scrub, or of wheels that are steered */
    jp_q16 weight;
    jp_q16 electronics;
};

/** Returns the number of frames. As jp_ecu_kind.tell_learned. */
uint8_t jp_ecu_tell_factors(const struct jp_ecu_factors *learned, const struct jp_ecu_factors *deviations,
                            struct jp_can_frame frames[JP_ECU_LEARNED_FRAMES]);

#ifdef __cplusplus
}
#endif

#endif
