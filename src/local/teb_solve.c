/*
 * Residuals depend on the lengths, turns and intervals of the steps, and only neighbouring steps share one. So the
 * equations of the poses are put together, pose by pose, from small ones of the steps, and factored at once.
 *
 * `first`, `second` and `third` are the terms of the steps from two poses before a pose, from the one before it, and
 * from the pose itself; steps that do not exist have no terms.
 */
#include "src/local/teb_solve.h"

#include "src/base/plane.h"
#include "src/local/teb_residuals.h"

/* Keeps a variable that nothing acts on where it is. */
#define DIAGONAL_MIN 1.0e-4f

static const struct jp_teb_factor no_factor;

/* ---- Assembly ---- */

static inline struct jp_teb_row times(float factor, const struct jp_teb_row *row)
{
    return (struct jp_teb_row){factor * row->x, factor * row->y, factor * row->heading, factor * row->interval};
}

/* By the pose before a step: what the change after it has of the next step's length and turn. */
struct carried {
    struct jp_teb_row length;
    float heading_turn;
    float interval_turn;
};

static inline struct carried carry(const struct jp_teb_terms *terms)
{
    const struct jp_teb_step_terms *const step = &terms->step;
    const struct jp_teb_way_change_terms *const length = &terms->change.length;

    return (struct carried){
        {-length->way_way * step->along.x, -length->way_way * step->along.y, length->way_way * step->length_by[0],
         length->interval_way},
        -terms->change.turn.way_way,
        terms->change.turn.interval_way,
    };
}

static inline void assemble_far(const struct jp_teb_terms *first, const struct jp_teb_step_terms *second,
                                struct jp_teb_row *far)
{
    const struct carried carried = carry(first);

    far[0] = times(second->along.x, &carried.length);
    far[1] = times(second->along.y, &carried.length);
    far[2] = times(second->length_by[1], &carried.length);
    far[2].heading += carried.heading_turn;
    far[2].interval += carried.interval_turn;
}

/* What the second step has of its length, by the pose before it. */
static inline struct jp_teb_row length_row(const struct jp_teb_terms *first, const struct jp_teb_step_terms *second)
{
    const float own = second->length.way_way;
    const float tie = first->change.length.way_way;

    return (struct jp_teb_row){
        tie * first->step.along.x - own * second->along.x, tie * first->step.along.y - own * second->along.y,
        tie * first->step.length_by[1] + own * second->length_by[0] - second->length_turn, second->length.way_interval};
}

static inline struct jp_teb_row turn_row(const struct jp_teb_terms *first, const struct jp_teb_step_terms *second)
{
    const float mixed = second->length_turn;

    return (struct jp_teb_row){-mixed * second->along.x, -mixed * second->along.y,
                               mixed * second->length_by[0] - second->turn.way_way + first->change.turn.way_way,
                               second->turn.way_interval};
}

/* What the change between the second and the third step has of the third's interval, by the pose before the second. */
static inline struct jp_teb_row interval_row(const struct jp_teb_terms *second)
{
    const struct jp_teb_change_terms *const change = &second->change;
    const float tie = change->length.way_interval;

    return (struct jp_teb_row){-tie * second->step.along.x, -tie * second->step.along.y,
                               tie * second->step.length_by[0] - change->turn.way_interval, change->interval_interval};
}

/* By a variable of the pose: `by` and `by_next` are derivatives of the lengths of the steps before and after it. */
static inline struct jp_teb_row row_by(float by, const struct jp_teb_row *length, float by_next,
                                       const struct jp_teb_row *carried, float side_by,
                                       const struct jp_teb_step_terms *step)
{
    return (struct jp_teb_row){by * length->x + by_next * carried->x - side_by * step->side_along.x,
                               by * length->y + by_next * carried->y - side_by * step->side_along.y,
                               by * length->heading + by_next * carried->heading + side_by * step->side_by[0],
                               by * length->interval + by_next * carried->interval};
}

static inline void assemble_near(const struct jp_teb_terms *first, const struct jp_teb_terms *second,
                                 const struct jp_teb_step_terms *third, struct jp_teb_row *near)
{
    const struct jp_teb_step_terms *const step = &second->step;
    const struct carried next = carry(second);
    const struct jp_teb_row length = length_row(first, step);
    const struct jp_teb_row turn = turn_row(first, step);
    const struct jp_teb_row heading =
        row_by(step->length_by[1], &length, third->length_by[0], &next.length, step->side_by[1], step);

    near[0] = row_by(step->along.x, &length, -third->along.x, &next.length, step->side_along.x, step);
    near[1] = row_by(step->along.y, &length, -third->along.y, &next.length, step->side_along.y, step);
    near[2] =
        (struct jp_teb_row){heading.x + turn.x, heading.y + turn.y, heading.heading + turn.heading - next.heading_turn,
                            heading.interval + turn.interval - next.interval_turn};
    near[3] = interval_row(second);
}

/* Of one step, by the pose at its end (sign 1) or its beginning (−1). */
static inline void add_step(const struct jp_teb_step_terms *step, float sign, struct jp_teb_triangle *own)
{
    const float by = step->length_by[sign > 0.0f ? 1 : 0];
    const float side_by = step->side_by[sign > 0.0f ? 1 : 0];
    const float x = step->length.way_way * step->along.x;
    const float y = step->length.way_way * step->along.y;
    const float mixed = sign * step->length_turn;
    const float heading = step->length.way_way * by + mixed;
    const float along = sign * heading;
    const float side = sign * side_by;

    own->xx += x * step->along.x + step->side_along.x * step->side_along.x;
    own->yx += x * step->along.y + step->side_along.x * step->side_along.y;
    own->yy += y * step->along.y + step->side_along.y * step->side_along.y;
    own->heading_x += along * step->along.x + side * step->side_along.x;
    own->heading_y += along * step->along.y + side * step->side_along.y;
    own->heading_heading += (heading + mixed) * by + step->turn.way_way + side_by * side_by;
}

static inline void add_interval(const struct jp_teb_step_terms *step, struct jp_teb_triangle *own)
{
    own->interval_x = -step->length.way_interval * step->along.x;
    own->interval_y = -step->length.way_interval * step->along.y;
    own->interval_heading = step->length.way_interval * step->length_by[0] - step->turn.way_interval;
    own->interval_interval = step->interval_interval;
}

/* Of the change at the pose. */
static inline void add_change(const struct jp_teb_terms *second, const struct jp_teb_step_terms *third,
                              struct jp_teb_triangle *own)
{
    const struct jp_teb_step_terms *const step = &second->step;
    const struct jp_teb_change_terms *const change = &second->change;
    const float x = change->length.way_way * third->along.x;
    const float y = change->length.way_way * third->along.y;
    const float heading = change->length.way_way * third->length_by[0];

    own->xx -= 2.0f * x * step->along.x;
    own->yx -= x * step->along.y + y * step->along.x;
    own->yy -= 2.0f * y * step->along.y;
    own->heading_x += heading * step->along.x - x * step->length_by[1];
    own->heading_y += heading * step->along.y - y * step->length_by[1];
    own->heading_heading += 2.0f * (heading * step->length_by[1] - change->turn.way_way);
    own->interval_x += change->length.way_interval * step->along.x;
    own->interval_y += change->length.way_interval * step->along.y;
    own->interval_heading += change->length.way_interval * step->length_by[1] + change->turn.way_interval;
}

static inline void assemble_own(const struct jp_teb_pose_terms *pose, const struct jp_teb_terms *second,
                                const struct jp_teb_step_terms *third, struct jp_teb_triangle *own)
{
    *own = (struct jp_teb_triangle){.xx = pose->xx,
                                    .yx = pose->yx,
                                    .yy = pose->yy,
                                    .heading_x = pose->heading_x,
                                    .heading_y = pose->heading_y,
                                    .heading_heading = pose->heading_heading};
    add_interval(third, own);
    add_step(&second->step, 1.0f, own);
    add_step(third, -1.0f, own);
    add_change(second, third, own);
}

/* Minus the gradient. */
static inline void assemble_step(const struct jp_teb_pose_terms *pose, const struct jp_teb_step_terms *second,
                                 const struct jp_teb_step_terms *third, struct jp_teb_row *step)
{
    step->x = third->along.x * third->length.way + third->side_along.x * third->side -
              second->along.x * second->length.way - second->side_along.x * second->side - pose->x;
    step->y = third->along.y * third->length.way + third->side_along.y * third->side -
              second->along.y * second->length.way - second->side_along.y * second->side - pose->y;
    step->heading = third->turn.way - third->length_by[0] * third->length.way - third->side_by[0] * third->side -
                    second->turn.way - second->length_by[1] * second->length.way - second->side_by[1] * second->side -
                    pose->heading;
    step->interval = -third->interval;
}

/* ---- What may not move ---- */

static void clear_position(struct jp_teb_row *row, bool has_heading)
{
    row->x = 0.0f;
    row->y = 0.0f;
    row->heading = has_heading ? 0.0f : row->heading;
}

/* The pose keeps its place, and its heading. */
static void fix(struct jp_teb_factor *rows, bool has_heading)
{
    struct jp_teb_triangle *const own = &rows->own;
    const unsigned count = has_heading ? 3U : 2U;

    for (unsigned i = 0; i < count; i++) {
        rows->far[i] = no_factor.far[i];
        rows->near[i] = no_factor.near[i];
    }
    own->xx = 1.0f;
    own->yx = 0.0f;
    own->yy = 1.0f;
    own->heading_x = 0.0f;
    own->heading_y = 0.0f;
    own->heading_heading = has_heading ? 1.0f : own->heading_heading;
    own->interval_x = 0.0f;
    own->interval_y = 0.0f;
    own->interval_heading = has_heading ? 0.0f : own->interval_heading;
    clear_position(&rows->step, has_heading);
}

static void fix_ends(const struct jp_teb *teb, unsigned pose, struct jp_teb_factor *rows)
{
    if (pose + 1U == teb->count) {
        fix(rows, !teb->internal.task.is_heading_free);
    }
    if (jp_teb_has_odometry(teb)) {
        return;
    }
    if (pose == 0U) {
        fix(rows, true);
    }
    for (unsigned i = 0; pose == 1U && i < JP_TEB_BLOCK; i++) {
        clear_position(&rows->near[i], true);
    }
    for (unsigned i = 0; pose == 2U && i + 1U < JP_TEB_BLOCK; i++) {
        clear_position(&rows->far[i], true);
    }
}

void jp_teb_assemble(const struct jp_teb *teb, unsigned pose, struct jp_teb_factor *rows)
{
    static const struct jp_teb_terms no_terms;
    const struct jp_teb_terms *const terms = teb->internal.terms[teb->internal.kept_terms];
    const struct jp_teb_terms *const first = pose > 1U ? &terms[pose - 2U] : &no_terms;
    const struct jp_teb_terms *const second = pose > 0U ? &terms[pose - 1U] : &no_terms;
    const struct jp_teb_step_terms *const third = pose + 1U < teb->count ? &terms[pose].step : &no_terms.step;

    assemble_far(first, &second->step, rows->far);
    assemble_near(first, second, third, rows->near);
    assemble_own(&terms[pose].pose, second, third, &rows->own);
    assemble_step(&terms[pose].pose, &second->step, third, &rows->step);
    fix_ends(teb, pose, rows);
}

/* ---- Cholesky ---- */

static inline float dot(const struct jp_teb_row *a, const struct jp_teb_row *b)
{
    return a->x * b->x + a->y * b->y + a->heading * b->heading + a->interval * b->interval;
}

/* row × inverse of factorᵀ */
static inline void divide(struct jp_teb_row *row, const struct jp_teb_triangle *factor)
{
    const float x = row->x * factor->xx;
    const float y = (row->y - x * factor->yx) * factor->yy;
    const float heading = (row->heading - x * factor->heading_x - y * factor->heading_y) * factor->heading_heading;

    row->interval =
        (row->interval - x * factor->interval_x - y * factor->interval_y - heading * factor->interval_heading) *
        factor->interval_interval;
    row->x = x;
    row->y = y;
    row->heading = heading;
}

static inline void divide_rows(struct jp_teb_row *rows, unsigned count, const struct jp_teb_triangle *factor)
{
    struct jp_teb_triangle own;

    own = *factor;
    for (unsigned i = 0; i < count; i++) {
        divide(&rows[i], &own);
    }
}

/* rows −= block × othersᵀ */
static inline void subtract_product(struct jp_teb_row *rows, const struct jp_teb_row *block,
                                    const struct jp_teb_row *others)
{
    const struct jp_teb_row x = others[0];
    const struct jp_teb_row y = others[1];
    const struct jp_teb_row heading = others[2];
    const struct jp_teb_row interval = others[3];

    for (unsigned i = 0; i + 1U < JP_TEB_BLOCK; i++) {
        rows[i].x -= dot(&block[i], &x);
        rows[i].y -= dot(&block[i], &y);
        rows[i].heading -= dot(&block[i], &heading);
        rows[i].interval -= dot(&block[i], &interval);
    }
}

static inline void subtract_squares(struct jp_teb_triangle *own, const struct jp_teb_row *far,
                                    const struct jp_teb_row *near)
{
    own->xx -= dot(&far[0], &far[0]) + dot(&near[0], &near[0]);
    own->yx -= dot(&far[1], &far[0]) + dot(&near[1], &near[0]);
    own->yy -= dot(&far[1], &far[1]) + dot(&near[1], &near[1]);
    own->heading_x -= dot(&far[2], &far[0]) + dot(&near[2], &near[0]);
    own->heading_y -= dot(&far[2], &far[1]) + dot(&near[2], &near[1]);
    own->heading_heading -= dot(&far[2], &far[2]) + dot(&near[2], &near[2]);
    own->interval_x -= dot(&near[3], &near[0]);
    own->interval_y -= dot(&near[3], &near[1]);
    own->interval_heading -= dot(&near[3], &near[2]);
    own->interval_interval -= dot(&near[3], &near[3]);
}

static inline float inverse_root(float pivot, bool *is_definite)
{
    *is_definite = *is_definite && pivot > 0.0f;
    return 1.0f / jp_plane_square_root(pivot);
}

/* The triangle becomes its Cholesky factor; false: it has none. */
static inline bool factor_own(struct jp_teb_triangle *own)
{
    bool is_definite = true;

    own->xx = inverse_root(own->xx, &is_definite);
    own->yx *= own->xx;
    own->heading_x *= own->xx;
    own->interval_x *= own->xx;
    own->yy = inverse_root(own->yy - own->yx * own->yx, &is_definite);
    own->heading_y = (own->heading_y - own->heading_x * own->yx) * own->yy;
    own->interval_y = (own->interval_y - own->interval_x * own->yx) * own->yy;
    own->heading_heading = inverse_root(
        own->heading_heading - own->heading_x * own->heading_x - own->heading_y * own->heading_y, &is_definite);
    own->interval_heading =
        (own->interval_heading - own->interval_x * own->heading_x - own->interval_y * own->heading_y) *
        own->heading_heading;
    own->interval_interval =
        inverse_root(own->interval_interval - own->interval_x * own->interval_x - own->interval_y * own->interval_y -
                         own->interval_heading * own->interval_heading,
                     &is_definite);
    return is_definite;
}

static inline void damp(struct jp_teb_triangle *own, float damping)
{
    own->xx += damping * own->xx + DIAGONAL_MIN;
    own->yy += damping * own->yy + DIAGONAL_MIN;
    own->heading_heading += damping * own->heading_heading + DIAGONAL_MIN;
    own->interval_interval += damping * own->interval_interval + DIAGONAL_MIN;
}

/* As another row of the factor: what becomes of it is L⁻¹ times minus the gradient. */
static inline void substitute_forward(struct jp_teb_factor *rows, const struct jp_teb_row *far_step,
                                      const struct jp_teb_row *near_step)
{
    rows->step.x -= dot(&rows->far[0], far_step) + dot(&rows->near[0], near_step);
    rows->step.y -= dot(&rows->far[1], far_step) + dot(&rows->near[1], near_step);
    rows->step.heading -= dot(&rows->far[2], far_step) + dot(&rows->near[2], near_step);
    rows->step.interval -= dot(&rows->near[3], near_step);
    divide(&rows->step, &rows->own);
}

/* The rows of a pose, after those of the poses before it. */
static bool factor_rows(struct jp_teb *teb, unsigned pose)
{
    struct jp_teb_factor *const rows = &teb->internal.factor[pose];
    const struct jp_teb_factor *const far = pose > 1U ? &teb->internal.factor[pose - 2U] : &no_factor;
    const struct jp_teb_factor *const near = pose > 0U ? &teb->internal.factor[pose - 1U] : &no_factor;

    jp_teb_assemble(teb, pose, rows);
    damp(&rows->own, teb->internal.damping);
    divide_rows(rows->far, JP_TEB_BLOCK - 1U, &far->own);
    subtract_product(rows->near, rows->far, near->near);
    divide_rows(rows->near, JP_TEB_BLOCK, &near->own);
    subtract_squares(&rows->own, rows->far, rows->near);
    if (!factor_own(&rows->own)) {
        return false;
    }
    substitute_forward(rows, &far->step, &near->step);
    return true;
}

/* row × inverse of the factor */
static inline void divide_transposed(struct jp_teb_row *row, const struct jp_teb_triangle *factor)
{
    row->interval *= factor->interval_interval;
    row->heading = (row->heading - row->interval * factor->interval_heading) * factor->heading_heading;
    row->y = (row->y - row->interval * factor->interval_y - row->heading * factor->heading_y) * factor->yy;
    row->x = (row->x - row->interval * factor->interval_x - row->heading * factor->heading_x - row->y * factor->yx) *
             factor->xx;
}

/* to −= factor × row */
static inline void subtract(struct jp_teb_row *to, float factor, const struct jp_teb_row *row)
{
    to->x -= factor * row->x;
    to->y -= factor * row->y;
    to->heading -= factor * row->heading;
    to->interval -= factor * row->interval;
}

static void substitute_backward(struct jp_teb *teb, unsigned pose)
{
    struct jp_teb_factor *const rows = &teb->internal.factor[pose];

    divide_transposed(&rows->step, &rows->own);
    if (pose > 0U) {
        struct jp_teb_row *const step = &teb->internal.factor[pose - 1U].step;

        subtract(step, rows->step.x, &rows->near[0]);
        subtract(step, rows->step.y, &rows->near[1]);
        subtract(step, rows->step.heading, &rows->near[2]);
        subtract(step, rows->step.interval, &rows->near[3]);
    }
    if (pose > 1U) {
        struct jp_teb_row *const step = &teb->internal.factor[pose - 2U].step;

        subtract(step, rows->step.x, &rows->far[0]);
        subtract(step, rows->step.y, &rows->far[1]);
        subtract(step, rows->step.heading, &rows->far[2]);
    }
}

bool jp_teb_solve(struct jp_teb *teb)
{
    for (unsigned pose = 0; pose < teb->count; pose++) {
        if (!factor_rows(teb, pose)) {
            return false;
        }
    }
    for (unsigned pose = teb->count; pose > 0U; pose--) {
        substitute_backward(teb, pose - 1U);
    }
    return true;
}
