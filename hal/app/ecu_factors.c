#include "hal/app/ecu_factors.h"

#include "hal/app/signals.h"
#include "hal/can/jp_can.h"

uint8_t jp_ecu_tell_factors(const struct jp_ecu_factors *learned, const struct jp_ecu_factors *deviations,
                            struct jp_can_frame frames[JP_ECU_LEARNED_FRAMES])
{
    const struct jp_can_learned_factors_t factors = {
        .rolling = jp_signal16u(learned->rolling, JP_FACTOR_SHIFT),
        .friction = jp_signal16u(learned->friction, JP_FACTOR_SHIFT),
        .weight = jp_signal16u(learned->weight, JP_FACTOR_SHIFT),
        .electronics = jp_signal16u(learned->electronics, JP_FACTOR_SHIFT),
    };
    const struct jp_can_learned_deviations_t uncertain = {
        .rolling = jp_signal16u(deviations->rolling, JP_FACTOR_SHIFT),
        .friction = jp_signal16u(deviations->friction, JP_FACTOR_SHIFT),
        .weight = jp_signal16u(deviations->weight, JP_FACTOR_SHIFT),
        .electronics = jp_signal16u(deviations->electronics, JP_FACTOR_SHIFT),
    };

    frames[0] = (struct jp_can_frame){.id = JP_CAN_LEARNED_FACTORS_FRAME_ID, .length = JP_CAN_LEARNED_FACTORS_LENGTH};
    frames[1] =
        (struct jp_can_frame){.id = JP_CAN_LEARNED_DEVIATIONS_FRAME_ID, .length = JP_CAN_LEARNED_DEVIATIONS_LENGTH};
    (void)jp_can_learned_factors_pack(frames[0].data, &factors, sizeof frames[0].data);
    (void)jp_can_learned_deviations_pack(frames[1].data, &uncertain, sizeof frames[1].data);
    return 2;
}
