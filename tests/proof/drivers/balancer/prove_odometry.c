/** Any radius that the header allows, any motion, for ever. */
#include <joulepath/odometry.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_odometry odometry;
    struct jp_motion_state motion;
    struct jp_point position = {0, 0};

    ANY(motion);
    jp_odometry_start(&odometry, any_between(1, JP_Q24(4)), &motion);
    ANY_TIMES
    {
        ANY(motion);
        jp_odometry_update(&odometry, &motion);
        position = jp_odometry_position(&odometry);
    }
    ARRIVED();
    return position.x > position.y ? 1 : 0;
}
