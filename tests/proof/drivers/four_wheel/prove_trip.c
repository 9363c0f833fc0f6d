// eva: -eva-slevel-function main:20
/** Any configuration that passes, any wheels and slopes, for ever. */
#include <joulepath/four_wheel_trip.h>

#include "tests/proof/any.h"

int main(void)
{
    static struct jp_four_wheel_trip trip;
    struct jp_four_wheel_trip_config config;
    struct jp_four_wheel_piece piece;
    struct jp_wheels wheels;
    const char *field;

    ANY(config);
    if (jp_four_wheel_trip_init(&trip, &config, &field) != JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        ANY(wheels);
        (void)jp_four_wheel_trip_tick(&trip, &wheels, any_int(), any_int(), &piece);
        if (any_bool()) {
            (void)jp_four_wheel_trip_end(&trip, &piece);
        }
    }
    ARRIVED();
    return 0;
}
