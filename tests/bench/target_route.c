/** Instructions of a whole jp_route plan of eight legs: greedy start, all Newton steps, result. The worst of random
 * routes that turn by up to 120°: with legs of 1…15 m of the paper's model, with legs of 0.7…2.1 m with a horizon. */
#include <joulepath/route.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "tests/target/cycles.h"
#include "tests/target/figure.h"

enum { LEGS = 8, ROUTES = 12 };

/* Lengths of legs, m. */
struct lengths {
    jp_q16 shortest;
    jp_q16 range;
};

static struct jp_route_leg legs[LEGS];
static struct jp_route route;
static struct jp_point targets[LEGS];
static uint32_t random_state = 1;

static const struct jp_segment_limits limits = {
    .speed = JP_Q24(1), .turn_rate = JP_Q24(0.35), .turn = JP_Q24(1.3962634), .duration = JP_Q16(600)};

static uint32_t draw(void)
{
    random_state = random_state * 1664525U + 1013904223U;
    return random_state >> 8;
}

static void draw_route(const struct lengths *lengths)
{
    struct jp_point point = {0, 0};
    jp_angle direction = 0;

    for (unsigned k = 0; k < LEGS; k++) {
        const jp_q16 length = lengths->shortest + jp_multiply_shift((int32_t)draw(), lengths->range, 24);

        direction += (jp_angle)(((int64_t)draw() - (1 << 23)) * (int64_t)(JP_ANGLE_DEGREES(120) >> 23));
        point.x += jp_multiply_shift(length, jp_cos(direction), 31);
        point.y += jp_multiply_shift(length, jp_sin(direction), 31);
        targets[k] = point;
    }
}

static void plan(void *unused)
{
    static const struct jp_point origin = {0, 0};
    static const struct jp_energy_start rest = {{0, 0}, {{0}, {0}}};

    (void)unused;
    (void)jp_route_start(&route, &origin, 0, &rest, targets, LEGS);
    while (jp_route_work(&route) == JP_WORKING) {
    }
}

static uint32_t worst_of(const struct jp_route_config *config, const struct lengths *lengths)
{
    const char *field;
    uint32_t worst = 0;

    random_state = 1;
    (void)jp_route_init(&route, config, &field);
    for (unsigned i = 0; i < ROUTES; i++) {
        draw_route(lengths);
        worst = target_count_worst(worst, plan, NULL);
        if (route.internal.status != JP_OK) {
            target_print("a route of the bench cannot be planned\n");
        }
    }
    return worst;
}

int main(void)
{
    static const struct lengths far = {JP_Q16(1), JP_Q16(14)};
    static const struct lengths near = {JP_Q16(0.7), JP_Q16(1.4)};
    const struct jp_route_config settled = {
        .model = &jp_energy_model_published, .limits = &limits, .legs = legs, .leg_count = LEGS};
    const struct jp_route_config unsettled = {.model = &jp_energy_model_gao2018,
                                              .horizon = &jp_horizon_gao2018,
                                              .limits = &limits,
                                              .legs = legs,
                                              .leg_count = LEGS};

    target_print("[\n");
    target_print_figure("route of 8, published model, worst of 12", worst_of(&settled, &far), "instructions", "150000");
    target_print(",\n");
    target_print_figure("route of 8 short segments with transients, worst of 12", worst_of(&unsettled, &near),
                        "instructions", NULL);
    target_print("\n]\n");
    return 0;
}
