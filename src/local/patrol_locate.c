#include <joulepath/patrol.h>

enum jp_status jp_patrol_locate(struct jp_localiser *localiser, struct jp_patrol_input *input)
{
    enum jp_status status = JP_ERR_ARGUMENT;

    if (localiser != NULL && input != NULL) {
        const struct jp_localiser_input seen = {.wheels = input->wheels, .scan = input->scan, .sensor = input->sensor};

        status = jp_localiser_update(localiser, &seen);
        input->is_lost = status != JP_OK || localiser->state == JP_LOCALISER_LOST;
        input->has_laser = !input->is_lost;
        input->laser = localiser->pose;
        input->deviation = localiser->position_deviation;
        input->is_new_place = input->has_laser && localiser->is_new_place;
    }
    return status;
}
