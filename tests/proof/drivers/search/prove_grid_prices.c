// eva: -eva-slevel 100
/** Any model that passes, any speed and any price of time. */
#include <joulepath/grid_prices.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_four_wheel_energy_model model;
    struct jp_grid_prices prices;
    const char *field;

    ANY(model);
    if (jp_four_wheel_energy_check(&model, &field) != JP_OK) {
        return 0;
    }
    (void)jp_grid_prices_set(&model, any_between(INT32_MIN, INT32_MAX), any_between(INT32_MIN, INT32_MAX), &prices);
    ARRIVED();
    return 0;
}
