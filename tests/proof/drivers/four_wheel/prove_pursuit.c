// eva: -eva-slevel-function main:20
/** Any configuration that passes, any path, any poses, speeds and periods, for ever. */
#include <joulepath/pure_pursuit.h>

#include "tests/proof/any.h"

#define POINTS 300U

int main(void)
{
    static struct jp_point path[POINTS];
    static struct jp_pure_pursuit tracker;
    struct jp_pure_pursuit_config config;
    struct jp_point position;
    struct jp_twist twist;
    const char *field;

    ANY(config);
    ANY(path);
    if (jp_pure_pursuit_init(&tracker, &config, &field) != JP_OK ||
        jp_pure_pursuit_follow(&tracker, path, any_unsigned(POINTS)) != JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        ANY(position);
        (void)jp_pure_pursuit_tick(&tracker, &position, any_unsigned(UINT32_MAX), any_int(), any_int(), &twist);
    }
    ARRIVED();
    return 0;
}
