#include <joulepath/line_path.h>

#include <stddef.h>

#include "src/base/integer.h"
#include "src/base/point.h"

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

/** Where the path has come to; none where it has that heading. */
static enum jp_status append_turn(struct jp_lattice_path *path, jp_angle heading)
{
    const jp_q24 turn = jp_angle_to_radians(heading - path->end.heading);
    const struct jp_path_piece piece = {.begin = path->end.position,
                                        .heading = path->end.heading,
                                        .length = jp_absolute32(turn),
                                        .kind = turn < 0 ? JP_PIECE_TURN_RIGHT : JP_PIECE_TURN_LEFT};

    path->end.heading = heading;
    return turn == 0 ? JP_OK : append(path, &piece);
}

static enum jp_status append_line(struct jp_lattice_path *path, const struct jp_point *end)
{
    const jp_q16 length = jp_distance(&path->end.position, end);

    if (length < LINE_MIN) {
        return JP_ERR_ZERO_LENGTH;
    }
    if (length > LINE_MAX) {
        return JP_ERR_INFEASIBLE;
    }
    const struct jp_path_piece piece = {
        .begin = path->end.position, .heading = path->end.heading, .length = length * (1 << 8), .kind = JP_PIECE_CURVE};

    path->end.position = *end;
    return append(path, &piece);
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

        status = append_turn(path, jp_atan2(jp_sub(target->y, begin->y), jp_sub(target->x, begin->x)));
        if (status == JP_OK) {
            status = append_line(path, target);
        }
    }
    return status;
}

enum jp_status jp_turn_path(struct jp_lattice_path *path, struct jp_path_piece *pieces, uint16_t places,
                            const struct jp_path_pose *start, jp_angle heading)
{
    if (start == NULL) {
        return JP_ERR_ARGUMENT;
    }

    enum jp_status status = jp_lattice_path_start(path, pieces, places);

    if (status == JP_OK) {
        path->end = *start;
        status = append_turn(path, heading);
    }
    if (status == JP_OK && path->count == 0U) {
        status = JP_ERR_ZERO_LENGTH;
    }
    return status;
}
