#include <joulepath/path_spline.h>
#include <string.h>

#include "src/base/block.h"
#include "src/base/point.h"

enum {
    KNOTS_PER_TURN = 5,
    KNOTS_MORE = 8,
    RELIEF_CELLS = 8,   /* from a turning point to the knots beside it, at most */
    RELIEF_DIVISOR = 3, /* of the chord, at most */
    RELIEF_MIN = 16,    /* m, Q16 */
};

#define SPACING_MIN JP_Q16(1.0 / 256)

/** A knot, and the piece from it to the next one. */
struct knot {
    struct jp_point point;
    jp_q16 length;  /* of the chord, m */
    jp_q24 share;   /* coefficient of the next knot's slope after the forward elimination */
    jp_q24 slope_x; /* of the curve, m/m */
    jp_q24 slope_y;
    int32_t is_straight;
};

struct spline {
    const struct jp_grid_planner *planner;
    struct knot *knots;
    size_t count;
    size_t count_max;
    jp_q16 spacing;
};

size_t jp_path_spline_size(size_t count)
{
    return (KNOTS_PER_TURN * count + KNOTS_MORE) * sizeof(struct knot);
}

/* ---- Knots ---- */

static jp_q16 distance(const struct jp_point *a, const struct jp_point *b)
{
    const int64_t dx = (int64_t)a->x - b->x;
    const int64_t dy = (int64_t)a->y - b->y;

    return (jp_q16)jp_square_root((uint64_t)(dx * dx) + (uint64_t)(dy * dy));
}

static void measure(struct knot *knot)
{
    knot->length = distance(&knot->point, &knot[1].point);
}

/** A point of a chord, `part` of `whole` from its beginning. */
static struct jp_point point_along(const struct knot *knot, int32_t part, int32_t whole)
{
    const struct jp_point *a = &knot->point;
    const struct jp_point *b = &knot[1].point;

    return (struct jp_point){a->x + (jp_q16)((int64_t)(b->x - a->x) * part / whole),
                             a->y + (jp_q16)((int64_t)(b->y - a->y) * part / whole)};
}

/** The free place nearest to a part of a piece's chord: chords touch corners, and rounding must not push them across.
 *  False: there is none. */
static bool find_place(const struct spline *spline, const struct knot *knot, int32_t part, struct jp_point *place)
{
    static const int8_t offsets[][2] = {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}};
    const struct jp_point exact = point_along(knot, part, knot->length);

    for (unsigned i = 0; i < sizeof offsets / sizeof offsets[0]; i++) {
        *place = (struct jp_point){exact.x + offsets[i][0], exact.y + offsets[i][1]};
        if (jp_grid_planner_line_is_free(spline->planner, &knot->point, place) &&
            jp_grid_planner_line_is_free(spline->planner, place, &knot[1].point)) {
            return true;
        }
    }
    return false;
}

/** Puts a knot on the chord of a piece, `part` m from its beginning. False: there is no room or no place for it. */
static bool insert(struct spline *spline, size_t index, jp_q16 part)
{
    struct knot *knot = &spline->knots[index];
    struct jp_point place;

    if (spline->count == spline->count_max || !find_place(spline, knot, part, &place)) {
        return false;
    }
    (void)memmove(&knot[2], &knot[1], (spline->count - index - 1U) * sizeof *knot);
    knot[1] = (struct knot){.point = place};
    spline->count++;
    measure(knot);
    measure(&knot[1]);
    return true;
}

static enum jp_status take_path(struct spline *spline, const struct jp_point *path, size_t count)
{
    spline->knots[0] = (struct knot){.point = path[0]};
    spline->count = 1;
    for (size_t i = 1; i < count; i++) {
        struct knot *last = &spline->knots[spline->count - 1U];
        if (jp_is_same_point(&last->point, &path[i])) {
            continue;
        }
        if (!jp_grid_planner_line_is_free(spline->planner, &last->point, &path[i])) {
            return JP_ERR_BLOCKED;
        }
        last[1] = (struct knot){.point = path[i]};
        measure(last);
        spline->count++;
    }
    return spline->count < 2U ? JP_ERR_ZERO_LENGTH : JP_OK;
}

/** Knots beside the turning points, from the last piece to the first: so those before keep their places. */
static void relieve(struct spline *spline)
{
    const int32_t most = RELIEF_CELLS * jp_grid_planner_resolution(spline->planner);

    for (size_t i = spline->count - 1U; i > 0U; i--) {
        const jp_q16 length = spline->knots[i - 1U].length;
        const int32_t part = length / RELIEF_DIVISOR < most ? length / RELIEF_DIVISOR : most;
        if (part >= RELIEF_MIN && insert(spline, i - 1U, length - part)) {
            (void)insert(spline, i - 1U, part);
        }
    }
}

/* ---- Slopes ---- */

static jp_q24 chord_slope(jp_q16 from, jp_q16 to, jp_q16 length)
{
    return jp_divide(((int64_t)to - from) * JP_Q24_ONE, length);
}

static jp_q24 chord_x(const struct knot *knot)
{
    return chord_slope(knot->point.x, knot[1].point.x, knot->length);
}

static jp_q24 chord_y(const struct knot *knot)
{
    return chord_slope(knot->point.y, knot[1].point.y, knot->length);
}

/**
 * Slopes m that make the second derivative continuous: with the lengths h and h′ of the chords before and after a knot,
 * their slopes s and s′, w = h/(h + h′) and w′ = 1 − w,
 *
 *   w′ m₋ + 2 m + w m₊ = 3 (w′ s + w s′);   at the ends, where the second derivative is 0, m + m₊/2 = 3/2 s.
 *
 * The tridiagonal system is eliminated forward and solved backward (Thomas); each pivot is at least 3/4.
 */
static void find_slopes(const struct spline *spline)
{
    struct knot *knots = spline->knots;
    const size_t last = spline->count - 1U;

    knots[0].share = JP_Q24_ONE / 2;
    knots[0].slope_x = 3 * (chord_x(&knots[0]) / 2);
    knots[0].slope_y = 3 * (chord_y(&knots[0]) / 2);
    for (size_t i = 1; i < last; i++) {
        const struct knot *before = &knots[i - 1U];
        struct knot *knot = &knots[i];
        const jp_q24 weight_after = jp_divide((int64_t)before->length * JP_Q24_ONE, before->length + knot->length);
        const jp_q24 weight_before = JP_Q24_ONE - weight_after;
        const jp_q24 pivot = 2 * JP_Q24_ONE - jp_q24_multiply(weight_before, before->share);
        const jp_q24 x =
            3 * (jp_q24_multiply(weight_before, chord_x(before)) + jp_q24_multiply(weight_after, chord_x(knot)));
        const jp_q24 y =
            3 * (jp_q24_multiply(weight_before, chord_y(before)) + jp_q24_multiply(weight_after, chord_y(knot)));
        knot->share = jp_q24_divide(weight_after, pivot);
        knot->slope_x = jp_q24_divide(x - jp_q24_multiply(weight_before, before->slope_x), pivot);
        knot->slope_y = jp_q24_divide(y - jp_q24_multiply(weight_before, before->slope_y), pivot);
    }
    const struct knot *before = &knots[last - 1U];
    const jp_q24 pivot = JP_Q24_ONE - before->share / 2;
    knots[last].slope_x = jp_q24_divide(3 * (chord_x(before) / 2) - before->slope_x / 2, pivot);
    knots[last].slope_y = jp_q24_divide(3 * (chord_y(before) / 2) - before->slope_y / 2, pivot);
    for (size_t i = last; i > 0U; i--) {
        knots[i - 1U].slope_x -= jp_q24_multiply(knots[i - 1U].share, knots[i].slope_x);
        knots[i - 1U].slope_y -= jp_q24_multiply(knots[i - 1U].share, knots[i].slope_y);
    }
}

/* ---- Points ---- */

/** A cubic from `from` to `to` with slopes at its ends, at u of the chord. */
static jp_q16 cubic(jp_q16 from, jp_q16 to, jp_q16 length, jp_q24 slope, jp_q24 slope_end, jp_q24 u)
{
    const jp_q16 rise = to - from;
    const jp_q16 first = jp_q24_multiply(length, slope) - rise;      /* beyond the chord's, of the beginning */
    const jp_q16 second = jp_q24_multiply(length, slope_end) - rise; /* and of the end */
    const jp_q24 v = JP_Q24_ONE - u;
    const jp_q24 uv = jp_q24_multiply(u, v);

    return from + jp_q24_multiply(rise, u) +
           jp_q24_multiply(jp_q24_multiply(first, v) - jp_q24_multiply(second, u), uv);
}

static int32_t parts_of(const struct spline *spline, const struct knot *knot)
{
    return knot->is_straight != 0 ? 1 : (knot->length - 1) / spline->spacing + 1;
}

/** Point `part` of `parts` of a piece. */
static struct jp_point point_of(const struct knot *knot, int32_t part, int32_t parts)
{
    const jp_q24 u = jp_divide((int64_t)part * JP_Q24_ONE, parts);

    return (struct jp_point){cubic(knot->point.x, knot[1].point.x, knot->length, knot->slope_x, knot[1].slope_x, u),
                             cubic(knot->point.y, knot[1].point.y, knot->length, knot->slope_y, knot[1].slope_y, u)};
}

static bool is_free(const struct spline *spline, const struct knot *knot)
{
    const int32_t parts = parts_of(spline, knot);
    struct jp_point before = knot->point;

    for (int32_t part = 1; part <= parts; part++) {
        const struct jp_point point = point_of(knot, part, parts);
        if (!jp_grid_planner_line_is_free(spline->planner, &before, &point)) {
            return false;
        }
        before = point;
    }
    return true;
}

/** Gives each piece that is not free a knot, or makes it straight. True when all were free. It ends: chords are free,
 * and so are pieces no longer than the spacing. */
static bool mend(struct spline *spline)
{
    bool all_free = true;

    for (size_t i = spline->count - 1U; i > 0U; i--) {
        struct knot *knot = &spline->knots[i - 1U];
        if (is_free(spline, knot)) {
            continue;
        }
        all_free = false;
        if (!insert(spline, i - 1U, knot->length / 2)) {
            knot->is_straight = 1;
        }
    }
    return all_free;
}

static enum jp_status write_points(const struct spline *spline, struct jp_point *smooth, size_t smooth_max,
                                   size_t *smooth_count)
{
    size_t count = 0;

    for (const struct knot *knot = spline->knots; knot < &spline->knots[spline->count - 1U]; knot++) {
        const int32_t parts = parts_of(spline, knot);
        for (int32_t part = 0; part < parts; part++) {
            if (count + 1U >= smooth_max) {
                return JP_ERR_MEMORY;
            }
            smooth[count] = point_of(knot, part, parts);
            count++;
        }
    }
    smooth[count] = spline->knots[spline->count - 1U].point;
    *smooth_count = count + 1U;
    return JP_OK;
}

enum jp_status jp_path_spline(const struct jp_grid_planner *planner, const struct jp_point *path, size_t count,
                              jp_q16 spacing, void *scratch, size_t scratch_size, struct jp_point *smooth,
                              size_t smooth_max, size_t *smooth_count)
{
    if (planner == NULL || path == NULL || scratch == NULL || smooth == NULL || smooth_count == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *smooth_count = 0;
    if (count < 2U || spacing < SPACING_MIN) {
        return JP_ERR_ARGUMENT;
    }
    if (!jp_block_is_aligned(scratch)) {
        return JP_ERR_ALIGNMENT;
    }
    if (scratch_size < jp_path_spline_size(count)) {
        return JP_ERR_MEMORY;
    }
    struct spline spline = {
        .planner = planner, .knots = scratch, .count_max = scratch_size / sizeof(struct knot), .spacing = spacing};
    const enum jp_status status = take_path(&spline, path, count);

    if (status != JP_OK) {
        return status;
    }
    relieve(&spline);
    do {
        find_slopes(&spline);
    } while (!mend(&spline));
    return write_points(&spline, smooth, smooth_max, smooth_count);
}
