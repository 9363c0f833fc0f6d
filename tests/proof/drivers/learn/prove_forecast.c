/** Any sums and forecasts: those that have no meaning are refused. */
#include <joulepath/learner.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_forecast left;
    struct jp_forecast way;
    jp_q31 probability;
    jp_q16 spare;

    ANY(left);
    ANY(way);
    (void)jp_forecast_reserve(&left, any_int(), any_int(), &spare);
    (void)jp_forecast_suffices(&left, &way, &probability);
    ARRIVED();
    return 0;
}
