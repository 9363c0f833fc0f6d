#include <joulepath/skid_path_energy.h>

#include <stddef.h>

#include "src/base/integer.h"
#include "src/trajectory/path_piece.h"

/** Longest part that skid_energy.h takes, s. */
#define DURATION_MAX JP_Q16(256)

#define PRICE_MAX JP_Q16(16384)
#define GRADE_MAX JP_Q24_ONE

/** A path as far as it has been added up. */
struct drive_sum {
    const struct jp_skid_energy_model *model;
    struct jp_skid_drive *drive;
    jp_q16 duration; /* s */
};

/** A piece, and the one after it, or null. */
struct leg_of_path {
    const struct jp_path_piece *piece;
    const struct jp_path_piece *next;
    jp_q24 reached; /* the way after which it cruises: m, or rad */
};

/** Where the robot is on a piece, and how fast: m and m/s, or rad and rad/s. */
struct speed_mark {
    jp_q24 way;
    jp_q24 speed;
};

static struct jp_motion motion_at(const struct leg_of_path *on, const struct speed_mark *at)
{
    if (on->piece->kind == JP_PIECE_CURVE) {
        const jp_q24 bend = jp_piece_bend_at(on->piece, on->next, at->way).bend;

        return (struct jp_motion){at->speed, jp_q24_multiply(bend, at->speed)};
    }
    return (struct jp_motion){0, at->speed}; /* to the right it takes the same */
}

static jp_q24 grade_of(const struct jp_path_piece *piece)
{
    return piece->kind == JP_PIECE_CURVE ? jp_clamp32(jp_piece_grade(piece), -GRADE_MAX, GRADE_MAX) : 0;
}

/** From one place to the next, in which speed and curvature change evenly. A way so short that its speeds are 0 takes
 * nothing: the model refuses what does not last. */
static void add_part(struct drive_sum *sum, const struct leg_of_path *on, const struct speed_mark *from,
                     const struct speed_mark *to)
{
    const jp_q24 mean = from->speed / 2 + to->speed / 2;
    const jp_q16 lasts = mean > 0 ? jp_q16_divide(to->way - from->way, mean) : 0;
    const struct jp_skid_piece part = {
        .start = motion_at(on, from),
        .end = motion_at(on, to),
        .grade = grade_of(on->piece),
        .duration = jp_clamp32(lasts, 0, DURATION_MAX),
    };

    (void)jp_skid_energy_add(sum->model, sum->drive, &part);
    sum->duration = jp_add(sum->duration, part.duration);
}

/** Where the speed has changed so, from the begin of a change on. */
static jp_q24 way_of_change(const struct jp_piece_speed *speed, jp_q24 from, jp_q24 to)
{
    const int64_t squares = jp_absolute64((int64_t)to * to - (int64_t)from * from);

    return jp_saturate32(squares / speed->acceleration / 2);
}

/** The next of the places where the change of speed or of curvature is another, and the last one. */
static jp_q24 next_place(const struct leg_of_path *on, const struct speed_mark *from)
{
    const struct jp_path_piece *piece = on->piece;
    const jp_q24 places[] = {piece->speed.blend, on->reached, piece->speed.brake_from,
                             on->next == NULL ? piece->length : piece->length - on->next->speed.blend};
    jp_q24 nearest = piece->length;

    for (unsigned i = 0; i < sizeof places / sizeof places[0]; i++) {
        nearest = places[i] > from->way && places[i] < nearest ? places[i] : nearest;
    }
    if (from->speed > 0 && from->way >= on->reached) {
        const jp_q24 most = jp_multiply_shift(from->speed, DURATION_MAX, 16); /* at the cruise, or braking */

        nearest = nearest - from->way > most ? from->way + most : nearest;
    }
    return nearest;
}

void jp_skid_piece_energy(const struct jp_skid_energy_model *model, const struct jp_path_piece *piece,
                          const struct jp_path_piece *next, jp_q24 begin, struct jp_skid_drive *drive, jp_q16 *duration)
{
    const struct jp_piece_speed *speed = &piece->speed;
    const struct leg_of_path on = {piece, next, way_of_change(speed, begin, speed->cruise)};
    struct drive_sum sum = {model, drive, *duration};
    struct speed_mark from = {0, begin};

    while (from.way < piece->length) {
        const jp_q24 way = next_place(&on, &from);
        const bool is_end = way == piece->length;
        const struct speed_mark to = {way, is_end ? speed->end : jp_piece_speed_after(speed, begin, way)};

        add_part(&sum, &on, &from, &to);
        from = to;
    }
    *duration = sum.duration;
}

void jp_skid_path_energy(const struct jp_skid_energy_model *model, const struct jp_lattice_path *path,
                         struct jp_skid_drive *drive, jp_q16 *duration)
{
    jp_q24 speed = 0;

    for (unsigned i = 0; i < path->count; i++) {
        const struct jp_path_piece *next = i + 1U < path->count ? &path->pieces[i + 1U] : NULL;

        jp_skid_piece_energy(model, &path->pieces[i], next, speed, drive, duration);
        speed = path->pieces[i].speed.end;
    }
}

static jp_q16 power_of(const void *model, const struct jp_motion *motion, jp_q24 grade)
{
    jp_q16 power = 0;

    (void)jp_skid_energy_power(model, motion, grade, &power);
    return power;
}

/** Of the mass that moves along, J·s²/m²: i G/2, driven and braked. */
static jp_q16 by_square(const struct jp_skid_energy_model *model, jp_q24 share)
{
    const jp_q16 half = jp_multiply_shift(model->weight, model->inertia, 25);

    return jp_clamp32(jp_multiply_shift(half, share, 24), 0, PRICE_MAX);
}

struct jp_motion_price jp_skid_motion_price(const struct jp_skid_energy_model *model, jp_q16 time)
{
    return (struct jp_motion_price){.power = power_of,
                                    .model = model,
                                    .time = time,
                                    .gain = by_square(model, model->driving),
                                    .recovery = by_square(model, model->braking)};
}
