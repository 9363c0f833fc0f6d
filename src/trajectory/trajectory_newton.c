#include "src/trajectory/trajectory_newton.h"

#include <stddef.h>

#include "src/base/plane.h"
#include "src/trajectory/trajectory_cost.h"

/** A curvature is taken to be positive, and at least so large. */
#define CURVE_LEAST 1.0e-12f

/* L D Lᵀ of the blocks, with positive pivots. */

static float positive(float pivot)
{
    return jp_plane_larger(jp_plane_magnitude(pivot), CURVE_LEAST);
}

/** Takes a place out of the next one's equations; its factors stay in it. */
static void eliminate(struct jp_optimiser_place *place, struct jp_optimiser_place *next)
{
    const float first = positive(place->curve[0]);
    const float lower = place->curve[1] / first;
    const float second = positive(place->curve[2] - lower * place->curve[1]);

    place->curve[0] = 1.0f / first;
    place->curve[1] = lower;
    place->curve[2] = 1.0f / second;
    place->step[0] = -place->slope[0];
    place->step[1] = -place->slope[1] - lower * place->step[0];
    for (unsigned j = 0; j < JP_COST_VARIABLES && next != NULL; j++) {
        place->coupling[1][j] -= lower * place->coupling[0][j];
        next->slope[j] += place->coupling[0][j] * place->curve[0] * place->step[0] +
                          place->coupling[1][j] * place->curve[2] * place->step[1];
    }
    if (next != NULL) {
        const float *const heading = place->coupling[0];
        const float *const speed = place->coupling[1];

        next->curve[0] -= heading[0] * heading[0] * place->curve[0] + speed[0] * speed[0] * place->curve[2];
        next->curve[1] -= heading[0] * heading[1] * place->curve[0] + speed[0] * speed[1] * place->curve[2];
        next->curve[2] -= heading[1] * heading[1] * place->curve[0] + speed[1] * speed[1] * place->curve[2];
    }
}

static void substitute_backward(struct jp_optimiser_place *place, const struct jp_optimiser_place *next)
{
    float heading = place->step[0];
    float speed = place->step[1];

    for (unsigned j = 0; j < JP_COST_VARIABLES && next != NULL; j++) {
        heading -= place->coupling[0][j] * next->step[j];
        speed -= place->coupling[1][j] * next->step[j];
    }
    place->step[1] = speed * place->curve[2];
    place->step[0] = heading * place->curve[0] - place->curve[1] * place->step[1];
}

float jp_newton_step(struct jp_optimiser_place *places, uint16_t count)
{
    float saved = 0.0f;

    for (uint16_t i = 0; i < count; i++) {
        struct jp_optimiser_place *place = &places[i];

        eliminate(place, i + 1U < count ? place + 1 : NULL);
        saved += 0.5f * (place->step[0] * place->step[0] * place->curve[0] +
                         place->step[1] * place->step[1] * place->curve[2]);
    }
    for (uint16_t i = count; i > 0U; i--) {
        struct jp_optimiser_place *place = &places[i - 1U];

        substitute_backward(place, i < count ? place + 1 : NULL);
    }
    return saved;
}
