#include <joulepath/lattice_path.h>

#include "src/base/integer.h"
#include "src/trajectory/clothoid.h"
#include "src/trajectory/path_piece.h"

/** A unit of jp_elevation in Q16. */
#define RISE_STEP (JP_Q16_ONE / JP_ELEVATION_ONE)

#define LENGTH_MIN JP_Q24(0.001)

enum jp_status jp_lattice_path_start(struct jp_lattice_path *path, struct jp_path_piece *pieces, uint16_t places)
{
    if (path == NULL || pieces == NULL || places == 0U) {
        return JP_ERR_ARGUMENT;
    }
    *path = (struct jp_lattice_path){.pieces = pieces, .places = places};
    return JP_OK;
}

static struct jp_point centre_of(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    const jp_q16 cell = terrain->config.resolution;

    return (struct jp_point){(jp_q16)(((int64_t)2 * x + 1) * cell / 2), (jp_q16)(((int64_t)2 * y + 1) * cell / 2)};
}

/** Turns by less than half a turn. */
static void set_turn(struct jp_path_piece *piece, jp_angle end)
{
    const int32_t turn = (int32_t)(end - piece->heading);

    piece->kind = turn < 0 ? JP_PIECE_TURN_RIGHT : JP_PIECE_TURN_LEFT;
    piece->length = jp_absolute32(jp_angle_to_radians(end - piece->heading));
}

static bool is_curve(const struct jp_path_piece *piece)
{
    const jp_q24 last = jp_piece_bend(piece, piece->length);

    return jp_is_between(piece->length, LENGTH_MIN, JP_PIECE_LENGTH_MAX) &&
           jp_is_between(piece->bend, -JP_PIECE_BEND_MAX, JP_PIECE_BEND_MAX) &&
           jp_is_between(last, -JP_PIECE_BEND_MAX, JP_PIECE_BEND_MAX);
}

/** The curve from the begin of a piece over so many cells. False: it is none that a piece can be. */
static bool set_curve(struct jp_path_piece *piece, int32_t dx, int32_t dy, jp_q16 cell, jp_angle end)
{
    const jp_angle chord = jp_atan2(dy, dx);
    const uint32_t cells = jp_square_root((uint64_t)(dx * dx + dy * dy) << 48); /* Q24 */
    struct jp_clothoid curve;

    piece->kind = JP_PIECE_CURVE;
    if (!jp_clothoid_fit((int32_t)(piece->heading - chord), (int32_t)(end - chord), &curve)) {
        return false;
    }

    const int64_t distance = ((int64_t)cells * cell) >> 16; /* Q24 */

    piece->length = jp_divide(jp_saturate32(distance) * ((int64_t)1 << 30), curve.chord_share);
    piece->bend = jp_q24_divide(curve.first, piece->length);
    piece->bend_rate = jp_q16_divide(jp_sub(jp_q24_divide(curve.last, piece->length), piece->bend), piece->length);
    return is_curve(piece);
}

static bool set_piece(struct jp_path_piece *piece, const struct jp_primitive *primitive, jp_q16 cell, jp_angle end)
{
    if (primitive->move_count == 0U) {
        set_turn(piece, end);
        return true;
    }
    return set_curve(piece, primitive->dx, primitive->dy, cell, end);
}

/** True when a piece goes on as the one before it. */
static bool goes_on(const struct jp_path_piece *last, const struct jp_path_piece *piece)
{
    if (last->kind != piece->kind || (int64_t)last->length + piece->length > JP_PIECE_LENGTH_MAX) {
        return false;
    }
    if (piece->kind != JP_PIECE_CURVE) {
        return jp_piece_is_on_the_same(last, piece);
    }
    return jp_piece_is_straight(last) && jp_piece_is_straight(piece) && jp_piece_lies_alike(last, piece);
}

static enum jp_status append(struct jp_lattice_path *path, const struct jp_path_piece *piece)
{
    if (path->count > 0U && goes_on(&path->pieces[path->count - 1U], piece)) {
        jp_piece_lengthen(&path->pieces[path->count - 1U], piece);
        return JP_OK;
    }
    if (path->count == path->places) {
        return JP_ERR_MEMORY;
    }
    path->pieces[path->count] = *piece;
    path->count++;
    return JP_OK;
}

/** Of the ground under the wheels of a side, 1: left, halfway on a primitive. */
static uint8_t class_beside(const struct jp_terrain *terrain, const struct jp_lattice *lattice,
                            const struct jp_lattice_pose *from, const struct jp_primitive *primitive, int32_t side)
{
    const struct jp_cell_offset left = lattice->sides[primitive->start];

    return jp_terrain_class(terrain, from->x + primitive->dx / 2 + side * left.dx,
                            from->y + primitive->dy / 2 + side * left.dy);
}

enum jp_status jp_lattice_path_add(struct jp_lattice_path *path, const struct jp_lattice *lattice,
                                   const struct jp_terrain *terrain, const struct jp_lattice_pose *from,
                                   const struct jp_primitive *primitive)
{
    if (path == NULL || lattice == NULL || terrain == NULL || from == NULL || primitive == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const int32_t x = from->x + primitive->dx;
    const int32_t y = from->y + primitive->dy;
    const jp_angle heading = lattice->heading[primitive->end];
    struct jp_path_piece piece = {
        .begin = centre_of(terrain, from->x, from->y),
        .heading = lattice->heading[from->heading],
        .rise = ((int32_t)jp_terrain_elevation(terrain, x, y) - jp_terrain_elevation(terrain, from->x, from->y)) *
                RISE_STEP,
        .ground_left = class_beside(terrain, lattice, from, primitive, 1),
        .ground_right = class_beside(terrain, lattice, from, primitive, -1)};

    if (!set_piece(&piece, primitive, terrain->config.resolution, heading)) {
        return JP_ERR_INFEASIBLE;
    }
    const enum jp_status status = append(path, &piece);

    if (status == JP_OK) {
        path->end = (struct jp_path_pose){centre_of(terrain, x, y), heading};
    }
    return status;
}

enum jp_status jp_lattice_path_of_plan(struct jp_lattice_path *path, const struct jp_planner *planner,
                                       struct jp_path_piece *pieces, uint16_t places)
{
    if (planner == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const struct jp_plan *plan = jp_planner_plan(planner);
    struct jp_lattice_pose pose = plan->start;
    enum jp_status status = jp_lattice_path_start(path, pieces, places);

    if (status == JP_OK && (plan->answer == JP_ANSWER_OUT_OF_BUDGET || plan->step_count == 0U)) {
        return JP_ERR_NO_PLAN;
    }
    for (unsigned i = 0; status == JP_OK && i < plan->step_count; i++) {
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *primitive = jp_planner_step(planner, i, &pose);

        status = jp_lattice_path_add(path, jp_planner_lattice(planner), jp_planner_terrain(planner), &from, primitive);
    }
    return status;
}

/** `sine` and `cosine` are of the origin's heading. */
static void move_into_frame(struct jp_point *point, jp_angle *heading, const struct jp_path_pose *origin, jp_q31 sine,
                            jp_q31 cosine)
{
    const int32_t dx = jp_sub(point->x, origin->position.x);
    const int32_t dy = jp_sub(point->y, origin->position.y);

    point->x = jp_add(jp_multiply_shift(dx, cosine, 31), jp_multiply_shift(dy, sine, 31));
    point->y = jp_sub(jp_multiply_shift(dy, cosine, 31), jp_multiply_shift(dx, sine, 31));
    *heading -= origin->heading;
}

void jp_lattice_path_in_frame(struct jp_lattice_path *path, const struct jp_path_pose *origin)
{
    const jp_q31 sine = jp_sin(origin->heading);
    const jp_q31 cosine = jp_cos(origin->heading);

    for (unsigned i = 0; i < path->count; i++) {
        move_into_frame(&path->pieces[i].begin, &path->pieces[i].heading, origin, sine, cosine);
    }
    move_into_frame(&path->end.position, &path->end.heading, origin, sine, cosine);
}
