#include <joulepath/grid_prices.h>
#include <stddef.h>

#include "src/base/integer.h"

#define SECOND_MAX JP_Q16(1024)
#define METRE_MAX  JP_Q16(16384)

enum {
    LEVEL = (int)JP_GRID_GRADES / 2, /* the entry of level ground */
    GRADES_PER_ONE = 32
};

/** Energy by grade, J in Q16; what does not fit is saturated. */
static enum jp_status measure(const struct jp_four_wheel_energy_model *model, jp_q24 speed,
                              jp_q16 energy[JP_GRID_GRADES])
{
    for (int i = 0; i < (int)JP_GRID_GRADES; i++) {
        const enum jp_status status =
            jp_four_wheel_energy_metre(model, speed, (i - LEVEL) * (JP_Q24_ONE / GRADES_PER_ONE), &energy[i]);

        if (status == JP_ERR_ARGUMENT) {
            return status;
        }
    }
    return JP_OK;
}

/** The derivative on level ground; where motors begin to brake there, one of those that there are. */
static int64_t rise_of(const jp_q16 energy[JP_GRID_GRADES])
{
    return ((int64_t)energy[LEVEL + 1] - energy[LEVEL - 1]) * (GRADES_PER_ONE / 2);
}

static void set_slopes(const jp_q16 energy[JP_GRID_GRADES], int64_t rise, struct jp_grid_prices *prices)
{
    for (int i = 0; i < (int)JP_GRID_GRADES; i++) {
        const int64_t more = (int64_t)energy[i] - energy[LEVEL] - (i - LEVEL) * rise / GRADES_PER_ONE;

        prices->slope[i] = more > 0 ? jp_saturate32(more) : 0;
    }
}

enum jp_status jp_grid_prices_set(const struct jp_four_wheel_energy_model *model, jp_q24 speed, jp_q16 second,
                                  struct jp_grid_prices *prices)
{
    jp_q16 energy[JP_GRID_GRADES] = {0};

    if (prices == NULL || !jp_is_between(second, 0, SECOND_MAX)) {
        return JP_ERR_ARGUMENT;
    }
    const enum jp_status status = measure(model, speed, energy);

    if (status != JP_OK) {
        return status;
    }
    const int64_t metre = energy[LEVEL] + (int64_t)second * JP_Q24_ONE / speed;

    if (metre >= METRE_MAX) {
        return JP_ERR_OVERFLOW;
    }
    const int64_t rise = rise_of(energy);

    *prices = (struct jp_grid_prices){.metre = (jp_q16)metre, .rise = jp_saturate32(rise), .ring = JP_Q16_ONE};
    set_slopes(energy, rise, prices);
    return JP_OK;
}
