/** What home learns of drives: any factor within its ranges, any drives, for ever. */
#include <joulepath/home.h>

#include "tests/proof/any_terrain.h"

static void any_factor(struct jp_home_factor *factor)
{
    factor->mean = any_between(JP_Q16_ONE / 2, 2 * JP_Q16_ONE);
    factor->deviation = any_between(1, JP_Q16(0.1));
    factor->noise = any_between(JP_Q16_ONE / 64, 2 * JP_Q16_ONE);
}

int main(void)
{
    struct jp_home_factor factor;
    struct jp_terrain_config config;

    any_terrain_config(&config);
    (void)jp_home_size(&config);
    any_factor(&factor);
    ANY_TIMES
    {
        struct jp_forecast forecast;

        ANY(forecast);
        (void)jp_home_factor_learn(&factor, any_int(), &forecast, any_int());
        (void)jp_home_factor_way(&factor, &forecast, any_int());
    }
    ARRIVED();
    return 0;
}
