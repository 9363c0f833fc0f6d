/** The legs of a route in real numbers: their geometry, what they spend, what they hand on. Private to
 *  libjoulepath_float. */
#ifndef JOULEPATH_TRAJECTORY_ROUTE_LEGS_H
#define JOULEPATH_TRAJECTORY_ROUTE_LEGS_H

#include <joulepath/route.h>

/** Indices in the Hessian of the settled energy: a leg's motion, its σ, and the motion before it. */
enum { JP_ROUTE_V, JP_ROUTE_W, JP_ROUTE_SIGMA, JP_ROUTE_V_BEFORE, JP_ROUTE_W_BEFORE };

static inline struct jp_route_leg_internal *jp_route_leg_at(const struct jp_route *route, unsigned k)
{
    return &route->config.legs[k].internal;
}

/** The Hessian of the settled energy without the friction of the whole segment. */
void jp_route_hessian(const struct jp_energy_model *model, float hessian[5][5]);

/** Motions and their derivatives by arc and pace, and with a horizon the transients, of all legs. */
void jp_route_evaluate(struct jp_route *route);

/** Gradient of the energy of all later legs by the transient at a leg's end. */
struct jp_route_adjoint {
    float travel[JP_AXIS_MODES]; /* J/V */
    float yaw[JP_AXIS_MODES];
};

/** Gradient of the energy of the transients by a leg's pace and by its steps. */
struct jp_route_handed {
    float pace;
    float v;
    float w;
    float sigma;
};

/** From the last leg to the first: takes the adjoint of leg k's end, leaves that of its start. */
void jp_route_hand_back(const struct jp_route *route, unsigned k, struct jp_route_adjoint *adjoint,
                        struct jp_route_handed *handed);

#endif
