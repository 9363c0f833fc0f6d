#include "src/local/patrol_price.h"

#include "src/base/plane.h"

float jp_patrol_in_place(const struct jp_patrol_config *config)
{
    return jp_plane_bearing((float)config->wheels.track, (float)config->wheels.wheelbase);
}

float jp_patrol_turn_seconds(const struct jp_patrol_config *config, float angle)
{
    const float ramps = config->turn_rate / config->turn_acceleration; /* both, over a turn at the full rate */
    const float short_turn = 2.0f * jp_plane_square_root(angle / config->turn_acceleration);

    return angle < ramps * config->turn_rate ? short_turn : angle / config->turn_rate + ramps;
}

/* By the mean angle of the wheels, and that of the wheel that has farthest to go. */
static float steering_price(const struct jp_patrol_config *config, float mean, float farthest)
{
    return mean * config->price.steering + farthest / config->steering_rate * config->price.second;
}

float jp_patrol_turn_price(const struct jp_patrol_config *config, float angle)
{
    const float in_place = jp_patrol_in_place(config);

    return angle > 0.0f ? steering_price(config, in_place, in_place) + angle * config->price.turning +
                              jp_patrol_turn_seconds(config, angle) * config->price.second
                        : 0.0f;
}

/* After a turn in place half of the wheels stand to one side, half to the other. */
float jp_patrol_steering_price(const struct jp_patrol_config *config, float askew, bool has_turned)
{
    const float in_place = has_turned ? jp_patrol_in_place(config) : 0.0f;

    return steering_price(config, jp_plane_larger(askew, in_place), askew + in_place);
}

/* Rolling costs as much on every way of the same length. */
float jp_patrol_straight_price(const struct jp_patrol_config *config, float angle, float length)
{
    const float speed = config->teb.speed_max;
    const float acceleration = config->teb.acceleration;
    const float ramps = speed / acceleration;
    const float seconds =
        length < ramps * speed ? 2.0f * jp_plane_square_root(length / acceleration) : length / speed + ramps;

    return jp_patrol_turn_price(config, angle) + jp_patrol_steering_price(config, 0.0f, angle > 0.0f) +
           seconds * config->price.second;
}

/* A wheel that points backwards rolls backwards. */
float jp_patrol_step_price(const struct jp_patrol_config *config, float direction, float length)
{
    const float back = JP_PLANE_PI - direction;

    return jp_patrol_steering_price(config, direction < back ? direction : back, false) +
           length / config->step_speed * config->price.second;
}

bool jp_patrol_is_step_cheapest(const struct jp_patrol_config *config, const struct jp_patrol_near_goal *goal)
{
    return jp_patrol_step_price(config, goal->first, goal->away) + jp_patrol_turn_price(config, goal->error) <
           jp_patrol_straight_price(config, goal->first, goal->away) + jp_patrol_turn_price(config, goal->then);
}
