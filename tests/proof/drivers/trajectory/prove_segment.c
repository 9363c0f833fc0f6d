/** Any model and limits that pass, any start and target; the end of any segment. */
#include <joulepath/segment.h>

#include "tests/proof/any.h"

int main(void)
{
    static struct jp_energy_model model;
    struct jp_segment_limits limits;
    struct jp_motion before;
    struct jp_point start;
    struct jp_point target;
    struct jp_point end;
    struct jp_segment segment;
    jp_angle heading = any_unsigned(UINT32_MAX);
    const char *field;

    ANY(model);
    ANY(limits);
    ANY(before);
    ANY(start);
    ANY(target);
    if (jp_energy_model_check(&model, &field) != JP_OK || jp_segment_limits_check(&limits, &model, &field) != JP_OK) {
        return 0;
    }
    (void)jp_segment_optimise(&model, &limits, &before, &start, heading, &target, &segment);
    ANY(segment);
    (void)jp_segment_end(&segment, &start, heading, &end, &heading);
    (void)jp_segment_turning_point(any_between(1, INT32_MAX), any_int(), &start, heading, any_int());
    ARRIVED();
    return 0;
}
