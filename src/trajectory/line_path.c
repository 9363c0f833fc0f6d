#include <joulepath/line_path.h>

#include <stddef.h>

#include "src/base/integer.h"
#include "src/base/point.h"
#include "src/trajectory/path_piece.h"

/** Shortest line, m. */
#define LINE_MIN JP_Q16(0.001)

#define LINE_MAX ((jp_q16)(JP_PIECE_LENGTH_MAX >> 8))

static enum jp_status append(struct jp_lattice_path *path, const struct jp_path_piece *piece)
{
    if (path->count == path->places) {
        return JP_ERR_MEMORY;
    }
    path->pieces[path->count] = *piece;
    path->count++;
    return JP_OK;
}

/** Halfway between two points. */
static struct jp_point middle_of(const struct jp_point *a, const struct jp_point *b)
{
    return (struct jp_point){(jp_q16)(((int64_t)a->x + b->x) / 2), (jp_q16)(((int64_t)a->y + b->y) / 2)};
}

/** Of the ground under wheels that are so far to the left of a place of the robot. */
static uint8_t class_beside(const struct jp_ground *ground, const struct jp_point *place, jp_angle heading, jp_q16 left)
{
    const struct jp_point wheels = {jp_sub(place->x, jp_multiply_shift(left, jp_sin(heading), 31)),
                                    jp_add(place->y, jp_multiply_shift(left, jp_cos(heading), 31))};

    return ground->class_at(ground->context, &wheels);
}

/** Another class is within the margin of wheels. */
static bool is_edge_beside(const struct jp_ground *ground, const struct jp_point *place, jp_angle heading, jp_q16 left)
{
    const uint8_t here = class_beside(ground, place, heading, left);

    return class_beside(ground, place, heading, left - ground->margin) != here ||
           class_beside(ground, place, heading, left + ground->margin) != here;
}

static void set_ground(struct jp_path_piece *piece, const struct jp_line_route *route, const struct jp_point *place)
{
    const struct jp_ground *ground = route->ground;
    const jp_q16 left = route->half_track;

    if (ground != NULL && ground->class_at != NULL) {
        piece->ground_left = class_beside(ground, place, piece->heading, left);
        piece->ground_right = class_beside(ground, place, piece->heading, -left);
        piece->is_at_edge =
            is_edge_beside(ground, place, piece->heading, left) || is_edge_beside(ground, place, piece->heading, -left);
    }
}

/** Where the path has come to; none where it has that heading. */
static enum jp_status append_turn(struct jp_lattice_path *path, jp_angle heading, const struct jp_line_route *route)
{
    const jp_q24 turn = jp_angle_to_radians(heading - path->end.heading);
    struct jp_path_piece piece = {.begin = path->end.position,
                                  .heading = path->end.heading,
                                  .length = jp_absolute32(turn),
                                  .kind = turn < 0 ? JP_PIECE_TURN_RIGHT : JP_PIECE_TURN_LEFT};

    set_ground(&piece, route, &path->end.position);
    path->end.heading = heading;
    return turn == 0 ? JP_OK : append(path, &piece);
}

/** A line that is to be appended. */
struct line_sections {
    struct jp_point begin;
    struct jp_point end;
    jp_q16 length;
    int32_t count;  /* of even length */
    int32_t pieces; /* at most */
};

/** Pieces of a line, with so many lines left, it included: at most its share of the places. */
static int32_t pieces_max(const struct jp_lattice_path *path, int32_t lines)
{
    const int32_t left = (int32_t)path->places - (int32_t)path->count;
    const int32_t spare = left - 1 - 2 * (lines - 1); /* two for each line after it */

    return spare > 0 ? 1 + spare / lines : 1;
}

/** As many as tell its ground; where there are classes, also more than there are pieces. */
static int32_t sections_of(const struct jp_ground *ground, jp_q16 length, int32_t pieces)
{
    const int32_t needed = ground == NULL ? 1 : 1 + (length - 1) / ground->spacing;

    return needed < pieces || (ground != NULL && ground->class_at != NULL) ? needed : pieces;
}

static int32_t share_of(int32_t whole, int32_t section, const struct line_sections *line)
{
    return (int32_t)((int64_t)whole * section / line->count);
}

static jp_q16 elevation_at(const struct jp_ground *ground, const struct jp_point *point)
{
    return ground == NULL ? 0 : ground->elevation(ground->context, point);
}

static enum jp_status append_sections(struct jp_lattice_path *path, const struct line_sections *line,
                                      const struct jp_line_route *route)
{
    const struct jp_ground *ground = route->ground;
    const unsigned first = path->count;
    jp_q16 elevation = elevation_at(ground, &line->begin);
    enum jp_status status = JP_OK;

    for (int32_t i = 1; status == JP_OK && i <= line->count; i++) {
        const struct jp_point end = {line->begin.x + share_of(line->end.x - line->begin.x, i, line),
                                     line->begin.y + share_of(line->end.y - line->begin.y, i, line)};
        const struct jp_point middle = middle_of(&path->end.position, &end);
        const jp_q16 before = elevation;
        const jp_q24 length = line->length * (1 << 8);

        elevation = elevation_at(ground, &end);
        struct jp_path_piece piece = {.begin = path->end.position,
                                      .heading = path->end.heading,
                                      .length = share_of(length, i, line) - share_of(length, i - 1, line),
                                      .rise = elevation - before,
                                      .kind = JP_PIECE_CURVE,
                                      .is_joined = path->count > first};

        set_ground(&piece, route, &middle);
        path->end.position = end;
        if (piece.is_joined && (jp_piece_lies_alike(&path->pieces[path->count - 1U], &piece) ||
                                (int32_t)path->count - (int32_t)first == line->pieces)) {
            jp_piece_lengthen(&path->pieces[path->count - 1U], &piece);
        } else {
            status = append(path, &piece);
        }
    }
    return status;
}

static enum jp_status append_line(struct jp_lattice_path *path, const struct jp_point *end,
                                  const struct jp_line_route *route, int32_t lines)
{
    const jp_q16 length = jp_distance(&path->end.position, end);

    if (length < LINE_MIN) {
        return JP_ERR_ZERO_LENGTH;
    }
    if (length > LINE_MAX) {
        return JP_ERR_INFEASIBLE;
    }
    const int32_t pieces = pieces_max(path, lines);
    const struct line_sections line = {.begin = path->end.position,
                                       .end = *end,
                                       .length = length,
                                       .count = sections_of(route->ground, length, pieces),
                                       .pieces = pieces};

    return append_sections(path, &line, route);
}

enum jp_status jp_line_path(struct jp_lattice_path *path, struct jp_path_piece *pieces, uint16_t places,
                            const struct jp_line_route *route)
{
    if (route == NULL || route->targets == NULL || route->count == 0U) {
        return JP_ERR_ARGUMENT;
    }

    enum jp_status status = jp_lattice_path_start(path, pieces, places);

    if (status == JP_OK) {
        path->end = (struct jp_path_pose){route->start, route->heading};
    }
    for (unsigned line = 0; status == JP_OK && line < route->count; line++) {
        const struct jp_point *target = &route->targets[line];
        const struct jp_point *begin = &path->end.position;

        status = append_turn(path, jp_atan2(jp_sub(target->y, begin->y), jp_sub(target->x, begin->x)), route);
        if (status == JP_OK) {
            status = append_line(path, target, route, (int32_t)route->count - (int32_t)line);
        }
    }
    return status;
}

enum jp_status jp_turn_path(struct jp_lattice_path *path, struct jp_path_piece *pieces, uint16_t places,
                            const struct jp_line_route *route, jp_angle heading)
{
    if (route == NULL) {
        return JP_ERR_ARGUMENT;
    }

    enum jp_status status = jp_lattice_path_start(path, pieces, places);

    if (status == JP_OK) {
        path->end = (struct jp_path_pose){route->start, route->heading};
        status = append_turn(path, heading, route);
    }
    if (status == JP_OK && path->count == 0U) {
        status = JP_ERR_ZERO_LENGTH;
    }
    return status;
}
