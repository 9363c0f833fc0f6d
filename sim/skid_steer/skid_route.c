#include "sim/skid_steer/skid_route.h"

#include <math.h>

#include "sim/base/digital.h"
#include "sim/base/strict_math.h"

/* From rest to limits.speed_m_s takes so long, s. */
#define RAMP_SECONDS 2.0

#define TREAD_SHARE 0.8 /* of limits.speed_m_s */
#define TURN_SHARE  2   /* of lattice.turn_rate_rad_s */

double skid_half_track(const struct skid_steer_model *model)
{
    const double ratio = model->body.wheelbase_m / model->body.width_m;

    return model->body.width_m / 2 * (1 + ratio * ratio);
}

double skid_tread_speed_max(const struct skid_steer_model *model)
{
    return TREAD_SHARE * model->limits.speed_m_s;
}

/* ---- Pieces ---- */

void skid_route_start(struct skid_route *route, const struct skid_steer_model *model, const struct skid_ground *ground,
                      const struct planar_pose *pose)
{
    *route = (struct skid_route){.model = model, .ground = ground, .pose = *pose};
}

struct planar_pose skid_route_pose(const struct planar_pose *pose, double speed, double turn_rate, double seconds)
{
    const double turn = turn_rate * seconds;
    const double shrink = fabs(turn) > 1e-6 ? strict_sin(turn / 2) / (turn / 2) : 1;
    const struct planar_pose motion = {speed * seconds * shrink, 0, turn};

    return planar_bend(pose, &motion);
}

/* Rise over run in the direction `turned` from a pose's heading. */
static double rise_at(const struct skid_ground *ground, const struct planar_pose *pose, double turned)
{
    if (ground->at == NULL) {
        return 0;
    }
    const struct skid_ground_point point = ground->at(ground->context, pose->x, pose->y);

    return point.slope_x * strict_cos(pose->heading + turned) + point.slope_y * strict_sin(pose->heading + turned);
}

/* The ramp to another motion, s: a whole number of pieces. */
static double ramp_seconds(const struct skid_route *route, const struct skid_leg *leg)
{
    const double acceleration = route->model->limits.speed_m_s / RAMP_SECONDS;
    const double change =
        fmax(fabs(leg->speed - route->speed), fabs(leg->turn_rate - route->turn_rate) * skid_half_track(route->model));

    return ceil(change / acceleration / SKID_PIECE_SECONDS - 1e-9) * SKID_PIECE_SECONDS;
}

/* To a motion, evenly. */
static struct skid_piece add_piece(struct skid_route *route, double speed, double turn_rate, bool is_ramp)
{
    const double mean_speed = (route->speed + speed) / 2;
    const double mean_rate = (route->turn_rate + turn_rate) / 2;
    const struct planar_pose middle = skid_route_pose(&route->pose, mean_speed, mean_rate, SKID_PIECE_SECONDS / 2);
    const double grade = rise_at(route->ground, &middle, 0);
    const struct skid_piece piece = {
        .start = {route->speed, route->turn_rate, grade},
        .end = {speed, turn_rate, grade},
        .bank = rise_at(route->ground, &middle, M_PI / 2),
        .seconds = SKID_PIECE_SECONDS,
        .is_ramp = is_ramp,
    };

    route->pose = skid_route_pose(&route->pose, mean_speed, mean_rate, SKID_PIECE_SECONDS);
    route->speed = speed;
    route->turn_rate = turn_rate;
    return piece;
}

size_t skid_route_add(struct skid_route *route, const struct skid_leg *leg, struct skid_piece *pieces)
{
    const struct skid_route start = *route;
    const double ramp = ramp_seconds(route, leg);
    const size_t ramps = (size_t)lround(ramp / SKID_PIECE_SECONDS);
    const size_t count = (size_t)fmax(round(leg->seconds / SKID_PIECE_SECONDS), (double)ramps);

    for (size_t i = 0; i < count && i < SKID_LEG_PIECES_MAX; i++) {
        const double share = i < ramps ? (double)(i + 1) / (double)ramps : 1;
        pieces[i] = add_piece(route, start.speed + share * (leg->speed - start.speed),
                              start.turn_rate + share * (leg->turn_rate - start.turn_rate), i < ramps);
    }
    return count < SKID_LEG_PIECES_MAX ? count : SKID_LEG_PIECES_MAX;
}

/* ---- At random ---- */

struct skid_leg skid_random_leg(const struct skid_steer_model *model, struct random *random)
{
    const double tread = skid_tread_speed_max(model) * random_uniform(random, 0.3, 1);
    const double half = skid_half_track(model);
    const double rate_max = TURN_SHARE * model->lattice.turn_rate_rad_s;
    const double side = random_uniform(random, -1, 1) < 0 ? -1 : 1;
    const double way = random_uniform(random, 0, 1) < 0.85 ? 1 : -1;
    const double kind = random_uniform(random, 0, 3);
    const double radius = random_uniform(random, 0.5, 10) * half; /* of a bend */
    const double rate = kind < 1 ? 0 : fmin(kind < 2 ? tread / (radius + half) : tread / half, rate_max);
    const double speed = kind < 1 ? tread : kind < 2 ? fmin(rate * radius, tread) : 0;

    const double turn = random_uniform(random, 0.1, 1) * M_PI;
    const double seconds = random_uniform(random, 3, 8);

    return (struct skid_leg){way * speed, side * rate, speed == 0 ? turn / rate + SKID_PIECE_SECONDS : seconds};
}

struct skid_variation skid_random_variation(struct random *random)
{
    struct skid_variation variation;

    variation.rolling = random_uniform(random, 0.7, 1.5);
    variation.friction = random_uniform(random, 0.6, 1.2);
    variation.mass = random_uniform(random, 0.9, 1.3);
    variation.electronics = random_uniform(random, 0.8, 1.2);
    variation.resistance = random_uniform(random, 0.9, 1.1);
    return variation;
}

struct skid_steer_model skid_varied(const struct skid_steer_model *model, const struct skid_variation *variation)
{
    struct skid_steer_model varied = *model;

    varied.ground.rolling *= variation->rolling;
    varied.ground.friction *= variation->friction;
    varied.body.mass_kg *= variation->mass;
    varied.body.yaw_inertia_kg_m2 *= variation->mass;
    varied.electronics.power_w *= variation->electronics;
    varied.motor.resistance_ohm *= variation->resistance;
    return varied;
}

/* ---- For the core ---- */

static struct jp_motion core_motion(const struct skid_steer_motion *motion)
{
    return (struct jp_motion){digital_fixed(motion->speed, JP_Q24_ONE), digital_fixed(motion->turn_rate, JP_Q24_ONE)};
}

struct jp_skid_piece skid_core_piece(const struct skid_piece *piece)
{
    return (struct jp_skid_piece){
        .start = core_motion(&piece->start),
        .end = core_motion(&piece->end),
        .grade = digital_fixed(piece->start.grade, JP_Q24_ONE),
        .bank = digital_fixed(piece->bank, JP_Q24_ONE),
        .duration = digital_fixed(piece->seconds, JP_Q16_ONE),
    };
}
