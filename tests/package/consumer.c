/** A program of somebody who uses the library: plans a segment. Exit status 0: it got a sensible one. C and C++. */
#include <joulepath/robot.h>
#include <joulepath/tables.h>

int main(void)
{
    static struct jp_robot robot;
    const struct jp_motion rest = {0, 0};
    const struct jp_point start = {0, 0};
    const struct jp_point target = {JP_Q16(4), JP_Q16(1.5)};
    struct jp_segment segment;
    const char *field = "";

    if (jp_robot_init(&robot, &jp_robot_courier24, &field) != JP_OK) {
        return 1;
    }
    if (jp_segment_optimise(&jp_energy_model_courier24, &jp_robot_courier24.limits, &rest, &start, 0, &target,
                            &segment) != JP_OK) {
        return 2;
    }
    return segment.energy > 0 && segment.length >= JP_Q16(4.27) ? 0 : 3;
}
