#include "src/trajectory/trajectory_cost.h"

#include <stddef.h>

#include "src/base/plane.h"

#define TWO_PI 6.28318531f

/** ∫ q², q'², q''², q'''² of the quintic q by which the flat output changes. */
#define SQUARES        (181.0f / 462.0f)
#define SQUARES_FIRST  (10.0f / 7.0f)
#define SQUARES_SECOND (120.0f / 7.0f)
#define SQUARES_THIRD  720.0f

/** Evaluations until the middle leads to the waypoint. What is left aside, m, is made good to first order. */
#define ROUNDS    6U
#define ASIDE_MAX 1.0e-3f

/** The middle's heading from its chord, rad, as the rule has it, and the most that one step turns it. */
#define ASTRAY_MAX (JP_PLANE_PI / 4.0f)
#define STEP_MAX   0.3f

/** Few nodes do for a blend that turns less, rad, and that changes its speed less, by the faster one. */
#define TURN_EVEN   1.25f
#define CHANGE_EVEN 0.5f

/** A blend as its waypoint sees it, with the derivatives by the turn in it and the speed there. */
struct side_blend {
    float turn;   /**< to or from the middle, rad */
    float lead;   /**< what the turn rate at the waypoint would turn in its time, rad */
    float change; /**< of the speed */
    float along;  /**< the way in the direction of the middle, m */
    float along_turn;
    float along_turn2;
    float along_speed;
    float along_both;
    float aside; /**< and across */
    float aside_turn;
    float aside_turn2;
    float aside_speed;
    float aside_both;
    float cost;
    float cost_turn;
    float cost_turn2;
    float cost_speed;
    float cost_speed2;
};

static float of_q16(jp_q16 x)
{
    return (float)x * 0x1p-16f;
}

static float of_q24(jp_q24 x)
{
    return (float)x * 0x1p-24f;
}

void jp_cost_rates_make(struct jp_cost_rates *rates, const struct jp_trajectory_config *config,
                        const struct jp_energy_model *model, const struct jp_back_emf *back_emf, jp_q24 cruise)
{
    const float volts[4] = {of_q16(config->volts[0]), of_q16(config->volts[1]), of_q16(config->volts[2]),
                            of_q16(config->volts[3])};
    const float bend = of_q16(config->turning[1]) / TWO_PI;
    const float travel = of_q16(model->b[0]);
    const float speed = of_q24(cruise);
    const float lag = of_q24(config->lag);
    const float kept = of_q16(back_emf->travel);
    const float power = 2.0f / of_q16(model->motor_resistance);
    const float beyond = travel - power * volts[0] * (volts[0] - kept);
    const float first = power * (volts[1] * volts[1] - 2.0f * volts[0] * volts[2] - kept * (volts[0] * lag - volts[2]));
    const float second = power * (volts[2] * volts[2] - 2.0f * volts[1] * volts[3] + kept * volts[2] * lag);

    rates->travel = travel;
    rates->momentum = power * volts[1] * (volts[0] - 0.5f * kept);
    rates->change[0] = SQUARES_FIRST * (first + 2.0f * beyond * lag);
    rates->change[1] = SQUARES_SECOND * (second + beyond * lag * lag);
    rates->change[2] = SQUARES_THIRD * power * volts[3] * volts[3];
    rates->turn = of_q16(model->b[1]);
    rates->bend = power * bend * bend;
    rates->time = travel * speed * speed;
    rates->lag = lag;
    rates->power = power;
    rates->back_emf = kept;
}

float jp_start_cost(const struct jp_cost_rates *rates, const struct jp_trajectory_config *config,
                    const jp_q24 modes[JP_TRAVEL_MODES], jp_q24 speed)
{
    const float steady = of_q16(config->volts[0]) * of_q24(speed);
    const float kept = steady - rates->back_emf * of_q24(speed);
    float sum = 0.0f;

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        const float volts = of_q16(config->modes.volts[i]);
        const float rate = of_q16(jp_mode_rate(config, i));
        const float mode = of_q24(modes[i]);

        sum += (steady * (volts - rates->back_emf) + volts * kept) * mode / rate;
        for (unsigned j = 0; j < JP_TRAVEL_MODES; j++) {
            sum += volts * (of_q16(config->modes.volts[j]) - rates->back_emf) * mode * of_q24(modes[j]) /
                   (rate + of_q16(jp_mode_rate(config, j)));
        }
    }
    return rates->power * sum;
}

/* Blends. */

/* What a change of speed gains or loses between waypoints counts with the leg, and has no derivatives: it is made good
 * in the next one. What a turn rate does adds up to nothing. */

/** What it costs by its turn: ∫ φ̇² and ∫ φ̈² of a cubic. */
static void add_turning(const struct jp_cost_rates *rates, float duration, struct side_blend *blend)
{
    const float turn = rates->turn / duration;
    const float bend = rates->bend / (duration * duration * duration);
    const float x = blend->turn;
    const float lead = blend->lead;

    blend->cost += turn * (1.2f * x * x + lead * (lead * (2.0f / 15.0f) - 0.2f * x)) +
                   bend * (12.0f * x * (x - lead) + 4.0f * lead * lead);
    blend->cost_turn = turn * (2.4f * x - 0.2f * lead) + bend * (24.0f * x - 12.0f * lead);
    blend->cost_turn2 = 2.4f * turn + 24.0f * bend;
}

/** And by its speed and its time. */
static void add_travel(const struct jp_cost_rates *rates, const struct jp_cost_end *end, struct side_blend *blend)
{
    const float pace = 1.0f / end->duration;
    const float square = pace * pace;
    const float steady = rates->travel * end->duration;
    const float by_change =
        steady * SQUARES + pace * (rates->change[0] + square * (rates->change[1] + square * rates->change[2]));
    const float last = end->speed + blend->change;

    blend->cost += rates->time * end->duration + steady * end->speed * last + by_change * blend->change * blend->change;
    blend->cost_speed = steady * last - 2.0f * by_change * blend->change;
    blend->cost_speed2 = 2.0f * by_change;
}

/** Adds the way of a node; `share` lies between it and the waypoint. */
static void add_node(const struct jp_cost_end *end, float swing, float share, float weight, float rolling,
                     struct side_blend *blend)
{
    const float rest = 1.0f - share;
    const float by_turn = rest * rest * (1.0f + share + share);
    const float angle = blend->turn * by_turn - blend->lead * share * rest * rest;
    const float risen =
        share * share * share * (10.0f + share * (6.0f * share - 15.0f)) - swing * share * rest * (rest - share);
    const float way = weight * (end->speed + blend->change * risen + rolling);
    const float by_speed = weight * (1.0f - risen);
    const float cosine = jp_plane_cosine(angle);
    const float sine = jp_plane_sine(angle);
    const float along = way * cosine;
    const float aside = way * sine;
    const float along_turn = -aside * by_turn;
    const float aside_turn = along * by_turn;

    blend->along += along;
    blend->along_turn += along_turn;
    blend->along_turn2 -= aside_turn * by_turn;
    blend->along_speed += by_speed * cosine;
    blend->along_both -= by_speed * sine * by_turn;
    blend->aside += aside;
    blend->aside_turn += aside_turn;
    blend->aside_turn2 += along_turn * by_turn;
    blend->aside_speed += by_speed * sine;
    blend->aside_both += by_speed * cosine * by_turn;
}

/** An end that follows the middle does not turn from it. */
static void straighten(struct side_blend *blend)
{
    blend->along_turn2 = 0.0f;
    blend->aside_turn = 0.0f;
    blend->aside_both = 0.0f;
    blend->cost_turn2 = 0.0f;
}

static struct side_blend blend_at(const struct jp_cost_rates *rates, const struct jp_cost_end *end, float turn,
                                  float speed)
{
    struct side_blend blend = {.change = speed - end->speed};
    const float swing = 60.0f * rates->lag / (end->duration * end->duration);
    unsigned count;

    if (!end->is_straight) {
        blend.turn = turn;
        blend.lead = end->turn_rate * end->duration;
    }

    const bool is_even = end->rolling == NULL && jp_plane_is_within(blend.turn, TURN_EVEN) &&
                         jp_plane_is_within(blend.change, CHANGE_EVEN * jp_plane_larger(speed, end->speed));
    const struct jp_node *nodes = jp_blend_nodes(is_even, &count);

    for (unsigned k = 0; k < count; k++) {
        add_node(end, swing, (float)nodes[k].share * 0x1p-30f, (float)nodes[k].weight * 0x1p-30f * end->duration,
                 end->rolling == NULL ? 0.0f : of_q24(end->rolling->speed[k]), &blend);
    }
    add_turning(rates, end->duration, &blend);
    add_travel(rates, end, &blend);
    if (end->is_straight) {
        straighten(&blend);
    }
    return blend;
}

/* Legs. */

/** A leg with a heading of its middle: R, the length of the middle, and F, how far beside the waypoint it leads. */
struct middle {
    struct side_blend begin;
    struct side_blend end;
    float cosine;
    float sine;
    float left;  /**< R, m */
    float aside; /**< F, m */
    float lever; /**< F by the heading, m */
};

static struct middle middle_at(const struct jp_cost_rates *rates, const struct jp_cost_leg *leg, float heading)
{
    struct middle middle = {
        .begin = blend_at(rates, &leg->begin, heading - leg->begin.heading, leg->speed),
        .end = blend_at(rates, &leg->end, leg->end.heading - heading, leg->speed),
        .cosine = jp_plane_cosine(heading),
        .sine = jp_plane_sine(heading),
    };

    middle.left = leg->length * middle.cosine - middle.begin.along - middle.end.along - leg->rolled;
    middle.aside = leg->length * middle.sine - middle.begin.aside + middle.end.aside;
    middle.lever = leg->length * middle.cosine - middle.begin.aside_turn - middle.end.aside_turn;
    return middle;
}

/** The middle that leads to the waypoint, by Newton's steps. */
static bool find_middle(const struct jp_cost_rates *rates, const struct jp_cost_leg *leg, float *heading,
                        struct middle *middle)
{
    for (unsigned i = 0; i < ROUNDS; i++) {
        *middle = middle_at(rates, leg, *heading);
        if (!(jp_plane_smaller(middle->left, middle->lever) > 0.0f) || !jp_plane_is_within(*heading, ASTRAY_MAX)) {
            return false;
        }
        if (jp_plane_is_within(middle->aside, ASIDE_MAX)) {
            return true;
        }
        *heading -= jp_plane_clamp(middle->aside / middle->lever, -STEP_MAX, STEP_MAX);
    }
    return false;
}

/** Second derivatives of the Lagrangian E + λ F by a blend's turn and speed, and how they move the middle. */
struct side {
    float slope[JP_COST_VARIABLES];
    float curve[3];                 /**< of turn and turn, turn and speed, speed and speed */
    float moved[JP_COST_VARIABLES]; /**< the middle's heading, by turn and speed of this end */
};

/** `sign`: 1 at the end of a leg, where F grows with what lies aside, and −1 at its begin. */
static void derive_side(const struct side_blend *blend, float price, float multiplier, float sign, float lever,
                        struct side *side)
{
    const float pull = sign * multiplier;

    side->slope[0] = blend->cost_turn - price * blend->along_turn + pull * blend->aside_turn;
    side->slope[1] = blend->cost_speed - price * blend->along_speed + pull * blend->aside_speed;
    side->curve[0] = blend->cost_turn2 - price * blend->along_turn2 + pull * blend->aside_turn2;
    side->curve[1] = -price * blend->along_both + pull * blend->aside_both;
    side->curve[2] = blend->cost_speed2;
    side->moved[0] = -blend->aside_turn / lever;
    side->moved[1] = -sign * blend->aside_speed / lever;
}

/** A curvature by heading and speed at one end: what they do themselves, by the middle, and both. `sign` as above: the
 *  heading of the waypoint and of the middle turn against each other. */
static void curve_of(const struct side *side, float sign, float by_middle, float curve[3])
{
    const float heading = -side->curve[0]; /* of the heading there and the middle's */
    const float speed = -sign * side->curve[1];
    const float *moved = side->moved;

    curve[0] = side->curve[0] + (2.0f * heading + by_middle * moved[0]) * moved[0];
    curve[1] = sign * side->curve[1] + heading * moved[1] + speed * moved[0] + by_middle * moved[0] * moved[1];
    curve[2] = side->curve[2] + (2.0f * speed + by_middle * moved[1]) * moved[1];
}

static void derive(const struct jp_cost_leg *leg, const struct middle *middle, float price, struct jp_leg_cost *result)
{
    const struct side_blend *const b = &middle->begin;
    const struct side_blend *const e = &middle->end;
    const float slope = (b->cost_turn - price * b->along_turn) - (e->cost_turn - price * e->along_turn) -
                        price * leg->length * middle->sine;
    const float multiplier = -slope / middle->lever;
    struct side begin;
    struct side end;

    derive_side(b, price, multiplier, -1.0f, middle->lever, &begin);
    derive_side(e, price, multiplier, 1.0f, middle->lever, &end);

    const float by_middle =
        begin.curve[0] + end.curve[0] - leg->length * (price * middle->cosine + multiplier * middle->sine);
    const float crossed[2][2] = {{-begin.curve[0], begin.curve[1]}, {-end.curve[0], -end.curve[1]}};

    result->cost += multiplier * middle->aside;
    result->slope_begin[0] = -begin.slope[0];
    result->slope_begin[1] = begin.slope[1];
    result->slope_end[0] = end.slope[0];
    result->slope_end[1] = end.slope[1];
    curve_of(&begin, -1.0f, by_middle, result->curve_begin);
    curve_of(&end, 1.0f, by_middle, result->curve_end);
    for (unsigned i = 0; i < JP_COST_VARIABLES; i++) {
        for (unsigned j = 0; j < JP_COST_VARIABLES; j++) {
            result->coupling[i][j] = crossed[0][i] * end.moved[j] + crossed[1][j] * begin.moved[i] +
                                     by_middle * begin.moved[i] * end.moved[j];
        }
    }
}

bool jp_leg_cost(const struct jp_cost_rates *rates, const struct jp_cost_leg *leg, float *middle,
                 struct jp_leg_cost *result)
{
    const float price = rates->travel * leg->speed + rates->time / leg->speed;
    float heading = *middle;
    struct middle found;

    if (!find_middle(rates, leg, &heading, &found)) {
        return false;
    }
    *middle = heading;
    result->cost = found.begin.cost + found.end.cost + price * found.left +
                   rates->momentum * (leg->end.speed * leg->end.speed - leg->begin.speed * leg->begin.speed);
    derive(leg, &found, price, result);
    return true;
}
