#include <joulepath/path_corner.h>

#include <stddef.h>

#include "src/trajectory/path_piece.h"

enum { LINE_BEFORE, CORNER, LINE_AFTER, PIECES };

/** Sharpest corner that is rounded, rad. */
#define TURN_MAX JP_Q24(2.6179939)

/** Of an arc that a piece can be, m. */
#define RADIUS_MIN JP_Q24(0.0101)
#define RADIUS_MAX JP_Q24(100)

/** Of each line an arc takes so much at least, m: it is no shorter than what the robot drives in a few set-points. */
#define TANGENT_MIN JP_Q24(0.01)

static bool is_corner(const struct jp_lattice_path *path, uint16_t turn)
{
    return turn > 0U && turn + 1U < path->count && path->pieces[turn].kind != JP_PIECE_CURVE &&
           path->pieces[turn].length <= TURN_MAX && jp_piece_is_straight(&path->pieces[turn - 1U]) &&
           jp_piece_is_straight(&path->pieces[turn + 1U]);
}

/** Of half a corner's turn. */
struct half_turn {
    jp_q31 sine;
    jp_q31 cosine;
};

static jp_q24 smaller(jp_q24 a, jp_q24 b)
{
    return a < b ? a : b;
}

/** Where an arc of this radius touches the lines, m before and after the corner. */
static jp_q24 tangent_of(jp_q24 radius, const struct half_turn *half)
{
    return jp_divide(jp_multiply(radius, half->sine), half->cosine);
}

/** Where the arcs touch the lines, at most, m before and after the corner. */
static jp_q24 tangent_max(const struct jp_path_piece *corner, const struct half_turn *half, jp_q24 clearance)
{
    const jp_q24 before = corner[-1].length / 2;
    const jp_q24 after = corner[1].length / 2;
    const jp_q31 bow = JP_Q31_MAX - half->cosine;
    const jp_q24 by_clearance = jp_divide(jp_multiply(clearance, half->sine), bow);
    const jp_q24 room = before < after ? before : after;

    return smaller(smaller(by_clearance, tangent_of(RADIUS_MAX, half)), room);
}

static struct jp_point ahead_of(const struct jp_point *point, jp_angle heading, jp_q24 way)
{
    return (struct jp_point){jp_add(point->x, jp_multiply_shift(way, jp_cos(heading), 39)),
                             jp_add(point->y, jp_multiply_shift(way, jp_sin(heading), 39))};
}

/** A line that is shorter at its begin, `from_begin`, or at its end. */
static void shorten(struct jp_path_piece *line, jp_q24 way, bool from_begin)
{
    const jp_q24 left = line->length - way;

    if (from_begin) {
        line->begin = ahead_of(&line->begin, line->heading, way);
    }
    line->rise = jp_divide((int64_t)line->rise * left, line->length);
    line->length = left;
}

/** The lines and the arc between them that touches them so far from the corner. */
static void round_by(struct jp_path_piece pieces[PIECES], const struct half_turn *half, jp_q24 tangent)
{
    struct jp_path_piece *arc = &pieces[CORNER];
    const jp_q16 rise_before = pieces[LINE_BEFORE].rise;
    const jp_q16 rise_after = pieces[LINE_AFTER].rise;
    const jp_q24 radius = jp_divide(jp_multiply(tangent, half->cosine), half->sine);
    const jp_q24 bend = jp_q24_divide(JP_Q24_ONE, radius);

    shorten(&pieces[LINE_BEFORE], tangent, false);
    shorten(&pieces[LINE_AFTER], tangent, true);
    arc->begin = ahead_of(&arc->begin, arc->heading, -tangent);
    arc->bend = arc->kind == JP_PIECE_TURN_LEFT ? bend : -bend;
    arc->length = jp_q24_multiply(arc->length, radius);
    arc->rise = jp_add(rise_before - pieces[LINE_BEFORE].rise, rise_after - pieces[LINE_AFTER].rise);
    arc->kind = JP_PIECE_CURVE;
}

static int64_t cost_of(struct jp_path_piece pieces[PIECES], const struct jp_path_limits *limits,
                       const struct jp_motion_price *price)
{
    struct jp_lattice_path path = {.pieces = pieces, .places = PIECES, .count = PIECES};
    struct jp_path_cost cost;

    if (jp_path_plan_speeds(&path, limits, price, &cost) != JP_OK) {
        return INT64_MAX;
    }
    return cost.energy + (jp_multiply(cost.duration, price->time) >> 16);
}

static void copy(struct jp_path_piece to[PIECES], const struct jp_path_piece from[PIECES])
{
    for (unsigned i = 0; i < (unsigned)PIECES; i++) {
        to[i] = from[i];
    }
}

/** Where the arcs touch the lines, at least. */
static jp_q24 tangent_min(jp_q24 radius, const struct half_turn *half)
{
    const jp_q24 tangent = tangent_of(radius > RADIUS_MIN ? radius : RADIUS_MIN, half);

    return tangent > TANGENT_MIN ? tangent : TANGENT_MIN;
}

bool jp_path_round_corner(struct jp_lattice_path *path, uint16_t turn, const struct jp_corner_room *room,
                          const struct jp_path_limits *limits, const struct jp_motion_price *price)
{
    if (path == NULL || room == NULL || limits == NULL || price == NULL || !is_corner(path, turn)) {
        return false;
    }
    struct jp_path_piece *lines = &path->pieces[turn - 1U];
    const jp_angle angle = jp_angle_from_radians(lines[CORNER].length / 2);
    const struct half_turn half = {jp_sin(angle), jp_cos(angle)};
    const jp_q24 most = tangent_max(&lines[CORNER], &half, room->clearance);
    const jp_q24 least_tangent = tangent_min(room->radius_min, &half);
    struct jp_path_piece pieces[PIECES];
    jp_q24 best = 0;

    copy(pieces, lines);
    int64_t least = cost_of(pieces, limits, price);

    for (int32_t share = JP_CORNER_RADII; share > 0; share--) {
        const jp_q24 tangent = (jp_q24)((int64_t)most * share / JP_CORNER_RADII);

        if (tangent < least_tangent) {
            break;
        }
        copy(pieces, lines);
        round_by(pieces, &half, tangent);

        const int64_t cost = cost_of(pieces, limits, price);

        if (cost < least) {
            least = cost;
            best = tangent;
        }
    }
    if (best > 0) {
        round_by(lines, &half, best);
    }
    return best > 0;
}
