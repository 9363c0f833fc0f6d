/** An energy that is not known exactly: what a drive will take, what a battery still has. */
#ifndef JOULEPATH_FORECAST_H
#define JOULEPATH_FORECAST_H

#include <joulepath/fixed.h>

/** Energy as expected and how sure that is, in the unit of an energy model, 2^unit_exponent J. */
struct jp_forecast {
    jp_q16 energy;    /**< J */
    jp_q16 deviation; /**< standard deviation, J */
};

#endif
