#include <joulepath/odometry.h>

/** An eighth of a turn in a tick, far beyond any robot, so that the distance fits 32 bits. */
#define ROLLED_BITS 30

void jp_odometry_start(struct jp_odometry *odometry, jp_q24 metres_per_turn, const struct jp_motion_state *state)
{
    *odometry = (struct jp_odometry){
        .wheel = jp_phase_angle(state->wheel),
        .heading = jp_phase_angle(state->yaw),
        .metres_per_turn = metres_per_turn,
    };
}

/** component · distance with the component in Q31 and the distance in Q32 m. */
static int64_t along(jp_q31 component, int32_t distance)
{
    return jp_multiply(component, distance) >> 31;
}

void jp_odometry_update(struct jp_odometry *odometry, const struct jp_motion_state *state)
{
    jp_angle wheel = jp_phase_angle(state->wheel);
    jp_angle heading = jp_phase_angle(state->yaw);
    int32_t rolled = jp_saturate_bits((int32_t)(wheel - odometry->wheel), ROLLED_BITS);
    int32_t distance = (int32_t)(jp_multiply(rolled, odometry->metres_per_turn) >> 24);
    jp_angle mean = odometry->heading + (jp_angle)((int32_t)(heading - odometry->heading) / 2);

    odometry->wheel = wheel;
    odometry->heading = heading;
    odometry->x += along(jp_cos(mean), distance);
    odometry->y += along(jp_sin(mean), distance);
}

struct jp_point jp_odometry_position(const struct jp_odometry *odometry)
{
    return (struct jp_point){jp_round_shift(odometry->x, 16), jp_round_shift(odometry->y, 16)};
}
