#include "sim/lattice/lattice_costs.h"

#include <math.h>

#include "sim/base/error.h"
#include "sim/base/strict_math.h"
#include "sim/lattice/lattice_moves.h"

#define UNITS_PER_METRE 1000.0 /* of JP_COST_DISTANCE */
#define FRACTION        65536.0

/* Steepest step, m·2⁻¹⁰ (joulepath/lattice.h). */
#define RISE_MAX 4096.0

/* A base this much below the next whole unit is rounding error of the arithmetic. */
#define EXACT 1e-6

static double signed_step(const struct lattice_pose *from, const struct lattice_pose *to)
{
    const double middle = (from->heading + to->heading) / 2;
    const double step = strict_hypot(to->x - from->x, to->y - from->y);

    return (to->x - from->x) * strict_cos(middle) + (to->y - from->y) * strict_sin(middle) < 0 ? -step : step;
}

static void add(const struct lattice *lattice, struct lattice_primitive *primitive, const struct lattice_motion *motion)
{
    const struct lattice_robot *robot = lattice->robot;
    const double length = fabs(motion->speed) * motion->duration;

    primitive->length_m += length;
    primitive->duration_s += motion->duration;
    primitive->cost[JP_COST_PHYSICAL] += JP_COST_PER_JOULE * lattice_robot_energy(robot, motion);
    primitive->cost[JP_COST_PAPER] += JP_COST_PER_JOULE * robot->energy(robot, JP_COST_PAPER, motion);
    primitive->cost[JP_COST_DISTANCE] += UNITS_PER_METRE * length;
}

/* Its distance is that of its sides, and so of its wheels, which turn it as they drive it. */
static void turn_in_place(const struct lattice *lattice, struct lattice_primitive *primitive)
{
    const struct lattice_path *path = &primitive->path;
    const double turn = path->poses[path->count - 1].heading - path->poses[0].heading;
    const double rate = lattice_robot_pivot_rate(lattice->robot, turn);

    add(lattice, primitive, &(struct lattice_motion){0, rate, 0, turn / rate});
    primitive->cost[JP_COST_DISTANCE] = UNITS_PER_METRE * lattice->robot->track_m / 2 * fabs(turn);
}

static void follow(const struct lattice *lattice, struct lattice_primitive *primitive, double sharpest)
{
    const struct lattice_path *path = &primitive->path;
    const double speed = lattice_robot_speed(lattice->robot, sharpest / lattice->resolution_m);

    for (size_t i = 1; i < path->count; i++) {
        const double step = signed_step(&path->poses[i - 1], &path->poses[i]) * lattice->resolution_m;
        const double duration = fabs(step) / speed;
        const double turn = path->poses[i].heading - path->poses[i - 1].heading;
        add(lattice, primitive, &(struct lattice_motion){copysign(speed, step), turn / duration, 0, duration});
    }
}

void lattice_drive(const struct lattice *lattice, struct lattice_primitive *primitive, double sharpest)
{
    primitive->length_m = 0;
    primitive->duration_s = 0;
    for (int kind = 0; kind < JP_COST_KINDS; kind++) {
        primitive->cost[kind] = 0;
    }
    if (primitive->dx == 0 && primitive->dy == 0) {
        turn_in_place(lattice, primitive);
    } else {
        follow(lattice, primitive, sharpest);
    }
    for (int kind = 0; kind < JP_COST_KINDS; kind++) {
        primitive->cost[kind] *= primitive->factor;
    }
}

/* Cost of driving a unit step straight up a rise in units of jp_elevation, before any floor. */
static double straight_cost(const struct lattice *lattice, enum jp_cost_kind cost_kind, enum jp_move_kind move,
                            double rise)
{
    const double length = lattice_move_length(move) * lattice->resolution_m;
    if (cost_kind == JP_COST_DISTANCE) {
        return UNITS_PER_METRE * length;
    }
    const struct lattice_robot *robot = lattice->robot;
    const double speed = lattice_robot_speed(robot, 0);

    return JP_COST_PER_JOULE *
           robot->energy(robot, cost_kind, &(struct lattice_motion){speed, 0, rise / JP_ELEVATION_ONE, length / speed});
}

/* constant + linear·rise + quadratic·rise², as the tables hold them. */
struct parabola {
    double constant;
    double linear;
    double quadratic;
};

/* The parabola through the costs of three rises. */
static struct parabola fit(const struct lattice *lattice, enum jp_cost_kind kind, enum jp_move_kind move,
                           const double rise[3])
{
    double constant = 0;
    double linear = 0;
    double quadratic = 0;

    for (int i = 0; i < 3; i++) {
        const double a = rise[(i + 1) % 3];
        const double b = rise[(i + 2) % 3];
        const double weight = straight_cost(lattice, kind, move, rise[i]) / ((rise[i] - a) * (rise[i] - b));
        constant += weight * a * b;
        linear -= weight * (a + b);
        quadratic += weight;
    }
    /* The ratio lowers the cost of level driving only, not what a slope adds to it. */
    const double level = straight_cost(lattice, kind, move, 0);
    return (struct parabola){floor((constant - level * (1 - lattice->ratio[kind])) * FRACTION),
                             round(linear * FRACTION), round(quadratic * FRACTION)};
}

static double least_cost(const struct lattice *lattice, enum jp_cost_kind kind, enum jp_move_kind move)
{
    if (kind != JP_COST_PHYSICAL) {
        return 1;
    }
    const double duration = lattice_move_length(move) * lattice->resolution_m / lattice_robot_speed(lattice->robot, 0);
    return fmax(1, floor(JP_COST_PER_JOULE * lattice->robot->electronics_power * duration));
}

/* The share of 32 bits that a parabola takes up to a rise, with all its parts. */
static double share(const struct parabola *parabola, double rise)
{
    const double product = (fabs(parabola->linear) + fabs(parabola->quadratic) * rise) * rise;

    return (fabs(parabola->constant) + product) / INT32_MAX;
}

static struct jp_polynomial polynomial(const struct parabola *parabola)
{
    return (struct jp_polynomial){(int32_t)parabola->constant, (int32_t)parabola->linear, (int32_t)parabola->quadratic};
}

/* Returns the share that the cost takes of what its members hold; above 1 it does not fit, and *cost is as before. */
static double move_cost(const struct lattice *lattice, enum jp_cost_kind kind, enum jp_move_kind move,
                        struct jp_slope_cost *cost)
{
    const double run = lattice_move_length(move) * lattice->resolution_m * JP_ELEVATION_ONE;
    const double steepest = lattice->robot->grade_max * run;
    const double bend = lattice->robot->grade_bend * run;
    const double climb[] = {bend, (bend + steepest) / 2, steepest};
    const double descend[] = {-2 * steepest, (bend - 2 * steepest) / 2, bend};
    const struct parabola up = fit(lattice, kind, move, climb);
    const struct parabola down = fit(lattice, kind, move, descend);
    const double floor_cost = least_cost(lattice, kind, move);
    const double taken =
        fmax(fmax(share(&up, steepest), share(&down, steepest)), fmax(steepest / RISE_MAX, floor_cost / UINT16_MAX));

    if (taken <= 1) {
        *cost = (struct jp_slope_cost){polynomial(&up), polynomial(&down), (int16_t)ceil(bend),
                                       (int16_t)fmax(1, floor(steepest)), (uint16_t)floor_cost};
    }
    return taken;
}

static double level_cost(const struct lattice *lattice, enum jp_cost_kind kind,
                         const struct lattice_primitive *primitive)
{
    double sum = 0;

    for (size_t i = 0; i < primitive->move_count; i++) {
        sum += straight_cost(lattice, kind, jp_move_kind_of(primitive->moves[i]), 0);
    }
    return sum;
}

/* The largest ratio that leaves no base below 0. */
static double ratio(const struct lattice *lattice, enum jp_cost_kind kind)
{
    double least = 1;

    for (size_t i = 0; i < lattice->count; i++) {
        const struct lattice_primitive *primitive = &lattice->primitives[i];
        if (primitive->move_count > 0) {
            least = fmin(least, primitive->cost[kind] / level_cost(lattice, kind, primitive));
        }
    }
    return least;
}

/* What the steps cost by the tables, which round each of them down. */
static double counted_cost(const struct lattice *lattice, enum jp_cost_kind kind,
                           const struct lattice_primitive *primitive)
{
    double sum = 0;

    for (size_t i = 0; i < primitive->move_count; i++) {
        sum += jp_move_cost(&lattice->move_costs[kind][jp_move_kind_of(primitive->moves[i])], 0);
    }
    return sum;
}

static unsigned base(const struct lattice *lattice, enum jp_cost_kind kind, const struct lattice_primitive *primitive)
{
    const double moves = lattice->counts_rounding ? counted_cost(lattice, kind, primitive)
                                                  : lattice->ratio[kind] * level_cost(lattice, kind, primitive);

    return (unsigned)fmin(UINT32_MAX, fmax(0, ceil(primitive->cost[kind] - moves - EXACT)));
}

static bool price_moves(struct lattice *lattice, enum jp_cost_kind kind)
{
    for (enum jp_move_kind move = 0; move < JP_MOVE_KINDS; move++) {
        const double taken = move_cost(lattice, kind, move, &lattice->move_costs[kind][move]);
        if (taken > 1) {
            error_line(
                "%s: a step of %.3g m takes %.3g times the energy or rises %.3g times as high as the tables hold; "
                "choose cells of at most %.2g m instead of %.3g m",
                lattice->robot->name, lattice_move_length(move) * lattice->resolution_m, taken, taken,
                0.95 * lattice->resolution_m / taken, lattice->resolution_m);
            return false;
        }
    }
    return true;
}

bool lattice_price(struct lattice *lattice)
{
    for (enum jp_cost_kind kind = 0; kind < JP_COST_KINDS; kind++) {
        lattice->ratio[kind] = ratio(lattice, kind);
        if (!price_moves(lattice, kind)) {
            return false;
        }
        for (size_t i = 0; i < lattice->count; i++) {
            lattice->primitives[i].base[kind] = base(lattice, kind, &lattice->primitives[i]);
        }
    }
    return true;
}
