#include "src/local/teb_residuals.h"

#include "src/base/plane.h"
#include "src/local/teb_band.h"
#include "src/local/teb_solve.h"

/* Variables of one pose, of a step between two and of a change between two steps. */
enum { X, Y, HEADING, INTERVAL, NEXT_X, NEXT_Y, NEXT_HEADING, STEP_WIDTH, CHANGE_WIDTH = STEP_WIDTH + JP_TEB_BLOCK };

/* A value of a step and its derivatives by the step's variables. */
struct valued {
    float value;
    float derivatives[STEP_WIDTH];
};

/* From a pose to the next. */
struct step {
    struct valued length;
    struct valued turn;
    float interval;
};

/* The sum of the cost and the normal equations that residuals are added to. */
struct sums {
    struct jp_teb *teb;
    float cost;
    float limit;
};

/* A cost that reaches the limit is of no use. */
static bool is_useful(const struct sums *sums)
{
    return sums->cost < sums->limit;
}

static void add(struct sums *sums, unsigned first, unsigned width, const float *derivatives, float residual)
{
    sums->cost += 0.5f * residual * residual;
    jp_teb_add_residual(sums->teb, first, width, derivatives, residual);
}

/* root × (sign × value + offset) where that is above 0; derivatives by the interval are given apart. */
static void add_excess(struct sums *sums, unsigned first, const struct valued *valued, float sign, float limit,
                       float limit_by_interval, float root)
{
    const float excess = sign * valued->value - limit;

    if (excess > 0.0f && root > 0.0f) {
        float derivatives[STEP_WIDTH];

        for (unsigned i = 0; i < STEP_WIDTH; i++) {
            derivatives[i] = root * sign * valued->derivatives[i];
        }
        derivatives[INTERVAL] -= root * limit_by_interval;
        add(sums, first, STEP_WIDTH, derivatives, root * excess);
    }
}

/* ---- A step ---- */

static void measure_step(const struct jp_teb_pose *from, const struct jp_teb_pose *to, struct step *step)
{
    const float dx = to->pose.x - from->pose.x;
    const float dy = to->pose.y - from->pose.y;
    const float c = 0.5f * (from->cosine + to->cosine);
    const float s = 0.5f * (from->sine + to->sine);

    step->interval = from->interval;
    step->length = (struct valued){
        c * dx + s * dy,
        {-c, -s, 0.5f * (from->cosine * dy - from->sine * dx), 0.0f, c, s, 0.5f * (to->cosine * dy - to->sine * dx)}};
    step->turn = (struct valued){jp_plane_wrap(to->pose.heading - from->pose.heading),
                                 {0.0f, 0.0f, -1.0f, 0.0f, 0.0f, 0.0f, 1.0f}};
}

static void add_nonholonomic(struct sums *sums, unsigned i)
{
    const struct jp_teb_pose *const from = &sums->teb->poses[i];
    const struct jp_teb_pose *const to = &sums->teb->poses[i + 1U];
    const float root = sums->teb->internal.roots.nonholonomic;
    const float dx = root * (to->pose.x - from->pose.x);
    const float dy = root * (to->pose.y - from->pose.y);
    const float c = from->cosine + to->cosine;
    const float s = from->sine + to->sine;
    const float derivatives[STEP_WIDTH] = {root * s,  -root * c, -from->sine * dy - from->cosine * dx, 0.0f,
                                           -root * s, root * c,  -to->sine * dy - to->cosine * dx};

    add(sums, i, STEP_WIDTH, derivatives, c * dy - s * dx);
}

static void add_limits(struct sums *sums, unsigned i, const struct step *step)
{
    const struct jp_teb_config *const config = &sums->teb->config;
    const struct jp_teb_weights *const roots = &sums->teb->internal.roots;
    const float turn_sign = step->turn.value < 0.0f ? -1.0f : 1.0f;

    add_excess(sums, i, &step->length, 1.0f, config->speed_max * step->interval, config->speed_max, roots->speed);
    add_excess(sums, i, &step->length, -1.0f, config->reverse_max * step->interval, config->reverse_max, roots->speed);
    add_excess(sums, i, &step->length, -1.0f, 0.0f, 0.0f, roots->no_reversing);
    add_excess(sums, i, &step->length, -1.0f, -config->speed_max * step->interval, -config->speed_max, roots->slowness);
    add_excess(sums, i, &step->turn, turn_sign, config->turn_rate_max * step->interval, config->turn_rate_max,
               roots->turn_rate);
}

static void add_turn_radius(struct sums *sums, unsigned i, const struct step *step)
{
    const float radius = sums->teb->config.radius_min;
    const float turn_factor = step->turn.value < 0.0f ? -radius : radius;
    const float length_sign = step->length.value < 0.0f ? -1.0f : 1.0f;
    struct valued lack = {.value = turn_factor * step->turn.value - length_sign * step->length.value};

    if (lack.value > 0.0f) {
        for (unsigned k = 0; k < STEP_WIDTH; k++) {
            lack.derivatives[k] = turn_factor * step->turn.derivatives[k] - length_sign * step->length.derivatives[k];
        }
        add_excess(sums, i, &lack, 1.0f, 0.0f, 0.0f, sums->teb->internal.roots.turn_radius);
    }
}

static void add_time(struct sums *sums, unsigned i)
{
    const float derivatives[JP_TEB_BLOCK] = {[INTERVAL] = sums->teb->internal.roots.time};

    add(sums, i, JP_TEB_BLOCK, derivatives, sums->teb->internal.roots.time * sums->teb->poses[i].interval);
}

/* ---- Acceleration ---- */

static void over_interval(const struct valued *way, float interval, struct valued *rate)
{
    const float inverse = 1.0f / interval;

    rate->value = way->value * inverse;
    for (unsigned i = 0; i < STEP_WIDTH; i++) {
        rate->derivatives[i] = way->derivatives[i] * inverse;
    }
    rate->derivatives[INTERVAL] = -rate->value * inverse;
}

/* Acceleration at an end of the band, beyond which the rate is `outside`. */
static void add_end_change(struct sums *sums, unsigned i, const struct valued *way, float interval, float outside,
                           float limit, float root)
{
    const float inverse = 1.0f / interval;
    struct valued change;

    over_interval(way, interval, &change);
    change.value = (change.value - outside) * inverse;
    for (unsigned k = 0; k < STEP_WIDTH; k++) {
        change.derivatives[k] *= inverse;
    }
    change.derivatives[INTERVAL] -= change.value * inverse;
    add_excess(sums, i, &change, change.value < 0.0f ? -1.0f : 1.0f, limit, 0.0f, root);
}

/* Acceleration between two steps, `way` being their lengths or turns, over the mean of both intervals. */
static void add_change(struct sums *sums, unsigned i, const struct valued *way, float interval,
                       const struct valued *next_way, float next_interval, float limit, float root)
{
    const float inverse = 2.0f / (interval + next_interval);
    const float change = (next_way->value / next_interval - way->value / interval) * inverse;
    const float sign = change < 0.0f ? -1.0f : 1.0f;
    const float excess = sign * change - limit;

    if (excess > 0.0f && root > 0.0f) {
        const float factor = root * sign * inverse;
        float derivatives[CHANGE_WIDTH] = {0};
        struct valued before;
        struct valued after;

        over_interval(way, interval, &before);
        over_interval(next_way, next_interval, &after);
        for (unsigned k = 0; k < STEP_WIDTH; k++) {
            derivatives[k] -= factor * before.derivatives[k];
            derivatives[k + JP_TEB_BLOCK] += factor * after.derivatives[k];
        }
        derivatives[INTERVAL] -= 0.5f * factor * change;
        derivatives[INTERVAL + JP_TEB_BLOCK] -= 0.5f * factor * change;
        add(sums, i, CHANGE_WIDTH, derivatives, root * excess);
    }
}

static void add_start(struct sums *sums, const struct step *step)
{
    const struct jp_teb *const teb = sums->teb;

    add_end_change(sums, 0, &step->length, step->interval, teb->internal.task.speed.forward, teb->config.acceleration,
                   teb->internal.roots.acceleration);
    add_end_change(sums, 0, &step->turn, step->interval, teb->internal.task.speed.turn_rate,
                   teb->config.turn_acceleration, teb->internal.roots.turn_acceleration);
}

static void add_goal(struct sums *sums, unsigned i, const struct step *step)
{
    const struct jp_teb *const teb = sums->teb;

    add_end_change(sums, i, &step->length, step->interval, teb->internal.task.goal_speed, teb->config.acceleration,
                   teb->internal.roots.acceleration);
}

static void add_acceleration(struct sums *sums, unsigned i, const struct step *before, const struct step *after)
{
    const struct jp_teb *const teb = sums->teb;

    add_change(sums, i, &before->length, before->interval, &after->length, after->interval, teb->config.acceleration,
               teb->internal.roots.acceleration);
    add_change(sums, i, &before->turn, before->interval, &after->turn, after->interval, teb->config.turn_acceleration,
               teb->internal.roots.turn_acceleration);
}

static void add_steps(struct sums *sums)
{
    const struct jp_teb *const teb = sums->teb;
    const unsigned last = teb->count - 2U;
    struct step steps[2];

    for (unsigned i = 0; i <= last && is_useful(sums); i++) {
        struct step *const step = &steps[i % 2U];

        measure_step(&teb->poses[i], &teb->poses[i + 1U], step);
        add_nonholonomic(sums, i);
        add_limits(sums, i, step);
        add_turn_radius(sums, i, step);
        add_time(sums, i);
        if (i > 0U) {
            add_acceleration(sums, i - 1U, &steps[(i - 1U) % 2U], step);
        } else {
            add_start(sums, step);
        }
    }
    if (is_useful(sums)) {
        add_goal(sums, last, &steps[last % 2U]);
    }
}

/* ---- A pose ---- */

static void add_path(struct sums *sums, unsigned i)
{
    const struct jp_teb_foot *const foot = &sums->teb->internal.feet[i];
    const struct jp_plane_pose *const pose = &sums->teb->poses[i].pose;
    const float root = sums->teb->internal.roots.path;
    const float derivatives[JP_TEB_BLOCK] = {root * foot->normal.x, root * foot->normal.y, 0.0f, 0.0f};

    add(sums, i, JP_TEB_BLOCK, derivatives,
        derivatives[X] * (pose->x - foot->point.x) + derivatives[Y] * (pose->y - foot->point.y));
}

static void add_obstacles(struct sums *sums, unsigned i)
{
    const struct jp_teb *const teb = sums->teb;
    const struct jp_teb_neighbours *const near = &teb->internal.near[i];
    const float reach = teb->config.clearance + jp_teb_sweep(&teb->config.footprint, &near->pose, &teb->poses[i].pose);
    const float root = teb->internal.roots.obstacle;

    for (unsigned k = 0; k < near->count && near->distance[k] < reach; k++) {
        struct jp_plane_pose gradient;
        const float distance = jp_teb_distance(teb, i, near->shape[k], near->time, &gradient);

        if (distance < teb->config.clearance) {
            const float derivatives[JP_TEB_BLOCK] = {-root * gradient.x, -root * gradient.y, -root * gradient.heading,
                                                     0.0f};

            add(sums, i, JP_TEB_BLOCK, derivatives, root * (teb->config.clearance - distance));
        }
    }
}

/* The first pose against where the robot was seen. */
static void add_sighting(struct sums *sums, const struct jp_plane_pose *seen, float root)
{
    const struct jp_plane_pose *const pose = &sums->teb->poses[0].pose;
    const float by_x[JP_TEB_BLOCK] = {[X] = root};
    const float by_y[JP_TEB_BLOCK] = {[Y] = root};
    const float by_heading[JP_TEB_BLOCK] = {[HEADING] = root};

    add(sums, 0, JP_TEB_BLOCK, by_x, root * (pose->x - seen->x));
    add(sums, 0, JP_TEB_BLOCK, by_y, root * (pose->y - seen->y));
    add(sums, 0, JP_TEB_BLOCK, by_heading, root * jp_plane_wrap(pose->heading - seen->heading));
}

static bool has_odometry(const struct jp_teb *teb)
{
    return teb->internal.roots.laser_odometry > 0.0f && teb->internal.task.is_measured;
}

static float sum_up(struct jp_teb *teb, float limit)
{
    struct sums sums = {teb, 0.0f, limit};

    add_steps(&sums);
    for (unsigned i = 1; i + 1U < teb->count && is_useful(&sums); i++) {
        add_path(&sums, i);
        add_obstacles(&sums, i);
    }
    if (has_odometry(teb)) {
        add_sighting(&sums, &teb->internal.task.start, teb->internal.roots.wheel_odometry);
        add_sighting(&sums, &teb->internal.task.measured, teb->internal.roots.laser_odometry);
    }
    return sums.cost;
}

static void fix_pose(struct jp_teb *teb, unsigned i, bool is_heading_free)
{
    jp_teb_fix(teb, i * JP_TEB_BLOCK + X);
    jp_teb_fix(teb, i * JP_TEB_BLOCK + Y);
    if (!is_heading_free) {
        jp_teb_fix(teb, i * JP_TEB_BLOCK + HEADING);
    }
}

float jp_teb_linearise(struct jp_teb *teb, float limit)
{
    const unsigned last = teb->count - 1U;

    jp_teb_clear_equations(teb);

    const float cost = sum_up(teb, limit);

    if (!has_odometry(teb)) {
        fix_pose(teb, 0, false);
    }
    fix_pose(teb, last, teb->internal.task.is_heading_free);
    jp_teb_fix(teb, last * JP_TEB_BLOCK + INTERVAL);
    return cost;
}
