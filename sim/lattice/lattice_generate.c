#include "sim/lattice/lattice_generate.h"

#include <math.h>
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/base/strict_math.h"
#include "sim/lattice/lattice_costs.h"
#include "sim/lattice/lattice_curve.h"
#include "sim/lattice/lattice_moves.h"
#include "sim/lattice/lattice_sweep.h"
#include "sim/lattice/lattice_symmetry.h"

/* Controls tried from each heading. */
#define SAMPLES 20000

/* Arc lengths of the samples, which stand for their simulated times, cells. */
#define SHORTEST 1.0
#define LONGEST  6.5

/* Farthest end, cells along each axis. */
#define EXTENT 6

/* Curves slower than this are worse than a turn in place; share of the full speed. */
#define SLOWEST_SHARE 0.3

enum { CANDIDATES_MAX = 512, HEADING_CHANGE_MAX = 2 };

/* An end state and the curve that leads there. */
struct candidate {
    int dx, dy;
    int turn; /* headings, to the left above 0 */
    struct lattice_curve curve;
    double cost; /* physical */
};

struct candidates {
    struct candidate list[CANDIDATES_MAX];
    size_t count;
};

static double halton(unsigned index, unsigned base)
{
    double value = 0;
    double digit = 1;

    for (; index > 0; index /= base) {
        digit /= base;
        value += digit * (index % base);
    }
    return value;
}

static unsigned wrap_heading(int heading)
{
    return (unsigned)(heading + JP_HEADINGS) % JP_HEADINGS;
}

/* The heading nearest to an angle, as a change from the start. */
static int nearest_turn(const struct lattice *lattice, unsigned start, double change)
{
    int best = 0;
    double least = INFINITY;

    for (int turn = -HEADING_CHANGE_MAX - 1; turn <= HEADING_CHANGE_MAX + 1; turn++) {
        const double difference =
            remainder(lattice->headings[wrap_heading((int)start + turn)] - lattice->headings[start], 2 * LATTICE_PI);
        if (fabs(difference - change) < least) {
            least = fabs(difference - change);
            best = turn;
        }
    }
    return best;
}

static bool is_known(const struct candidates *candidates, int dx, int dy, int turn)
{
    for (size_t i = 0; i < candidates->count; i++) {
        const struct candidate *known = &candidates->list[i];
        if (known->dx == dx && known->dy == dy && known->turn == turn) {
            return true;
        }
    }
    return false;
}

/* Not so sharp that it takes a crawl, and no loop. */
static bool is_valid(const struct lattice *lattice, const struct lattice_curve *curve)
{
    const double rate = lattice_curve_sharpest(curve) / lattice->resolution_m * lattice->robot->speed_max;

    return curve->length <= 2 * EXTENT && rate * SLOWEST_SHARE <= lattice->robot->turn_rate_max;
}

/* A sample of (v, w) and time as a curve of constant curvature. */
static struct lattice_curve draw(const struct lattice *lattice, unsigned start, unsigned index)
{
    const struct lattice_robot *robot = lattice->robot;
    const double speed = robot->speed_max * (1 - halton(index, 2));
    const double rate = robot->turn_rate_max * (2 * halton(index, 3) - 1);
    const double length = SHORTEST + (LONGEST - SHORTEST) * halton(index, 5);

    return (struct lattice_curve){lattice->headings[start], rate / speed * lattice->resolution_m, 0, length};
}

static double physical_cost(const struct lattice *lattice, const struct lattice_curve *curve)
{
    static struct lattice_primitive primitive;

    primitive.dx = 1; /* it does not turn in place */
    primitive.factor = 1;
    if (!lattice_curve_path(curve, LATTICE_SPACING, LATTICE_TURN, &primitive.path)) {
        return INFINITY;
    }
    lattice_drive(lattice, &primitive, lattice_curve_sharpest(curve));
    return primitive.cost[JP_COST_PHYSICAL];
}

/* Snaps the sample's end and solves for the control that leads there. */
static void consider(const struct lattice *lattice, unsigned start, struct lattice_curve curve,
                     struct candidates *candidates)
{
    const struct lattice_pose reached = lattice_curve_end(&curve);
    const int dx = (int)round(reached.x);
    const int dy = (int)round(reached.y);
    const int turn = nearest_turn(lattice, start, reached.heading - curve.heading);
    const double change =
        remainder(lattice->headings[wrap_heading((int)start + turn)] - lattice->headings[start], 2 * LATTICE_PI);
    const struct lattice_pose end = {dx, dy, curve.heading + change};

    if ((dx == 0 && dy == 0) || abs(dx) > EXTENT || abs(dy) > EXTENT || abs(turn) > HEADING_CHANGE_MAX ||
        candidates->count == CANDIDATES_MAX || is_known(candidates, dx, dy, turn)) {
        return;
    }
    if (lattice_curve_solve(&curve, &end) && is_valid(lattice, &curve)) {
        candidates->list[candidates->count++] = (struct candidate){dx, dy, turn, curve, physical_cost(lattice, &curve)};
    }
}

static void gather(const struct lattice *lattice, unsigned start, struct candidates *candidates)
{
    candidates->count = 0;
    for (unsigned i = 1; i <= SAMPLES; i++) {
        consider(lattice, start, draw(lattice, start, i), candidates);
    }
}

/* Above 0: the end lies to the left of the straight line. */
static double side(const struct candidate *candidate)
{
    return strict_cos(candidate->curve.heading) * candidate->dy - strict_sin(candidate->curve.heading) * candidate->dx;
}

/* A kind of curve that a heading should have. */
struct wish {
    int turn; /* headings */
    int side; /* of the end: 1 left, −1 right */
};

static bool fulfils(const struct candidate *candidate, const struct wish *wish)
{
    return candidate->turn == wish->turn && side(candidate) * wish->side > 1e-9;
}

/* The cheapest candidate that fulfils a wish, or NULL. */
static const struct candidate *choose(const struct candidates *candidates, const struct wish *wish)
{
    const struct candidate *best = NULL;

    for (size_t i = 0; i < candidates->count; i++) {
        const struct candidate *candidate = &candidates->list[i];
        if (fulfils(candidate, wish) && (best == NULL || candidate->cost < best->cost)) {
            best = candidate;
        }
    }
    return best;
}

static struct lattice_primitive *append(struct lattice *lattice, int dx, int dy, unsigned start, unsigned end)
{
    struct lattice_primitive *primitive = &lattice->primitives[lattice->count++];

    *primitive = (struct lattice_primitive){.dx = dx, .dy = dy, .start = start, .end = end, .factor = 1};
    return primitive;
}

static bool append_curve(struct lattice *lattice, unsigned start, const struct candidate *candidate)
{
    struct lattice_primitive *primitive =
        append(lattice, candidate->dx, candidate->dy, start, wrap_heading((int)start + candidate->turn));

    if (!lattice_curve_path(&candidate->curve, LATTICE_SPACING, LATTICE_TURN, &primitive->path) ||
        !lattice_find_moves(primitive)) {
        error_line("%s: no primitive from heading %u to cell (%d, %d); correct the limits of the robot",
                   lattice->robot->name, start, candidate->dx, candidate->dy);
        return false;
    }
    lattice_drive(lattice, primitive, lattice_curve_sharpest(&candidate->curve));
    return true;
}

static bool append_straight(struct lattice *lattice, unsigned start)
{
    const struct jp_cell_offset offset = jp_move_offsets[start];
    const struct candidate straight = {
        offset.dx, offset.dy, 0, {lattice->headings[start], 0, 0, lattice_move_length(jp_move_kind_of(start))}, 0};

    return append_curve(lattice, start, &straight);
}

static void append_pivot(struct lattice *lattice, unsigned start, int turn)
{
    const unsigned end = wrap_heading((int)start + turn);
    const double change = remainder(lattice->headings[end] - lattice->headings[start], 2 * LATTICE_PI);
    const size_t pieces = (size_t)ceil(fabs(change) / LATTICE_TURN);
    struct lattice_primitive *primitive = append(lattice, 0, 0, start, end);

    for (size_t i = 0; i <= pieces; i++) {
        primitive->path.poses[i].heading = lattice->headings[start] + change * (double)i / (double)pieces;
    }
    primitive->path.count = pieces + 1;
    lattice_drive(lattice, primitive, 0);
}

/* The curves that a heading wishes for, to one side. */
static bool append_side(struct lattice *lattice, unsigned start, const struct candidates *candidates, int to)
{
    const struct wish wishes[] = {{to, to}, {0, to}, {2 * to, to}};

    for (size_t i = 0; i < sizeof wishes / sizeof wishes[0]; i++) {
        const struct candidate *candidate = choose(candidates, &wishes[i]);
        if (candidate == NULL) {
            error_line("%s: no curve turns by %d headings from heading %u within %d cells; correct the limits of the "
                       "robot",
                       lattice->robot->name, wishes[i].turn, start, EXTENT);
            return false;
        }
        if (!append_curve(lattice, start, candidate)) {
            return false;
        }
    }
    append_pivot(lattice, start, to);
    return true;
}

/* Reflected across the diagonal, then turned by quarters to the left. */
static void append_image(struct lattice *lattice, const struct lattice_primitive *source, bool reflected,
                         unsigned quarters)
{
    struct lattice_primitive *image = &lattice->primitives[lattice->count++];

    *image = *source;
    if (reflected) {
        lattice_reflect(image);
    }
    for (unsigned i = 0; i < quarters; i++) {
        lattice_turn_quarter(image);
    }
}

/* Appends images of the primitives first…last − 1. */
static void append_images(struct lattice *lattice, size_t first, size_t last, bool reflected, unsigned quarters)
{
    for (size_t i = first; i < last; i++) {
        append_image(lattice, &lattice->primitives[i], reflected, quarters);
    }
}

/* Headings 0 and 2 are their own mirror images; heading 3 is that of heading 1. */
static bool generate_first_quarter(struct lattice *lattice)
{
    static struct candidates candidates;
    size_t first[4];

    gather(lattice, 0, &candidates);
    if (!append_straight(lattice, 0) || !append_side(lattice, 0, &candidates, 1)) {
        return false;
    }
    append_images(lattice, 1, lattice->count, true, 3);

    first[1] = lattice->count;
    gather(lattice, 1, &candidates);
    if (!append_straight(lattice, 1) || !append_side(lattice, 1, &candidates, 1) ||
        !append_side(lattice, 1, &candidates, -1)) {
        return false;
    }

    first[2] = lattice->count;
    gather(lattice, 2, &candidates);
    if (!append_straight(lattice, 2) || !append_side(lattice, 2, &candidates, 1)) {
        return false;
    }
    append_images(lattice, first[2] + 1, lattice->count, true, 0);
    append_images(lattice, first[1], first[2], true, 0);
    return true;
}

bool lattice_generate(struct lattice *lattice)
{
    lattice->primitives = calloc((size_t)JP_HEADINGS * (LATTICE_BRANCHES + 2), sizeof *lattice->primitives);
    if (lattice->primitives == NULL) {
        error_line("%s: no memory for the primitives", lattice->robot->name);
        return false;
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        lattice->headings[heading] = lattice_direction_angle(heading);
    }
    if (!generate_first_quarter(lattice)) {
        return false;
    }
    const size_t quarter = lattice->count;
    for (unsigned quarters = 1; quarters < 4; quarters++) {
        append_images(lattice, 0, quarter, false, quarters);
    }
    return true;
}
