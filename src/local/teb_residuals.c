/*
 * All residuals but those of a pose alone depend on lengths, turns and intervals of steps. So the sums of the products
 * of their derivatives are formed by those few variables.
 */
#include "src/local/teb_residuals.h"

#include "src/base/plane.h"
#include "src/local/teb_band.h"

/* The sum of the cost, and the terms of the equations that residuals are added to. */
struct sums {
    struct jp_teb *teb;
    struct jp_teb_terms *terms;
    struct jp_teb_terms *last; /* of the step before */
    float cost;
};

/* A length or a turn of a step. */
struct way {
    float value;
    float rate; /* over the interval */
};

/* From a pose to the next. */
struct step {
    struct way length;
    struct way turn;
    float interval;
    float inverse; /* of the interval */
};

/* Lengths of steps below it count as if they were driven to and fro, m: so that their absolute value is smooth. */
#define WAY_SMOOTHING 0.01f

static const struct jp_teb_pose_terms no_pull;

/* The pull of a residual on what it depends on, before its derivatives. */
static inline float pull_of(struct sums *sums, float weight, float residual)
{
    const float pull = weight * residual;

    sums->cost += 0.5f * pull * residual;
    return pull;
}

/* ---- A step ---- */

static inline void measure_step(const struct jp_teb_pose *from, const struct jp_teb_pose *to, float root,
                                struct step *step, struct jp_teb_step_terms *terms)
{
    static const struct jp_teb_way_terms no_way = {.way = 0.0f};
    const float dx = to->pose.x - from->pose.x;
    const float dy = to->pose.y - from->pose.y;
    const float c = 0.5f * (from->cosine + to->cosine);
    const float s = 0.5f * (from->sine + to->sine);
    const float inverse = 1.0f / from->interval;
    const float length = c * dx + s * dy;
    const float turn = jp_plane_wrap(to->pose.heading - from->pose.heading);

    *step = (struct step){{length, length * inverse}, {turn, turn * inverse}, from->interval, inverse};
    terms->along = (struct jp_plane_point){c, s};
    terms->length_by[0] = 0.5f * (from->cosine * dy - from->sine * dx);
    terms->length_by[1] = 0.5f * (to->cosine * dy - to->sine * dx);
    terms->side_along = (struct jp_plane_point){-2.0f * root * s, 2.0f * root * c};
    terms->side_by[0] = -root * (from->sine * dy + from->cosine * dx);
    terms->side_by[1] = -root * (to->sine * dy + to->cosine * dx);
    terms->side = 2.0f * root * (c * dy - s * dx);
    terms->length = no_way;
    terms->turn = no_way;
    terms->length_turn = 0.0f;
    terms->interval_interval = 0.0f;
    terms->interval = 0.0f;
}

/* Where sign × the way is above rate × the interval. */
static inline void add_limit(struct sums *sums, const struct step *step, float sign, float value, float rate,
                             float weight, struct jp_teb_way_terms *way)
{
    const float excess = sign * value - rate * step->interval;

    if (excess > 0.0f) {
        struct jp_teb_step_terms *const terms = &sums->terms->step;
        const float pull = pull_of(sums, weight, excess);

        way->way_way += weight;
        way->way_interval -= sign * weight * rate;
        way->way += sign * pull;
        terms->interval_interval += weight * rate * rate;
        terms->interval -= rate * pull;
    }
}

static inline void add_limits(struct sums *sums, const struct step *step)
{
    const struct jp_teb_config *const config = &sums->teb->config;
    const struct jp_teb_weights *const weights = &sums->teb->internal.weights;
    const float length = step->length.value;
    struct jp_teb_way_terms *const by_length = &sums->terms->step.length;

    add_limit(sums, step, 1.0f, length, config->speed_max, weights->speed, by_length);
    add_limit(sums, step, -1.0f, length, config->reverse_max, weights->speed, by_length);
    add_limit(sums, step, -1.0f, length, 0.0f, weights->no_reversing, by_length);
    add_limit(sums, step, step->turn.value < 0.0f ? -1.0f : 1.0f, step->turn.value, config->turn_rate_max,
              weights->turn_rate, &sums->terms->step.turn);
}

static inline void add_turn_radius(struct sums *sums, const struct step *step)
{
    const float radius = sums->teb->config.radius_min;
    const float by_turn = step->turn.value < 0.0f ? -radius : radius;
    const float by_length = step->length.value < 0.0f ? 1.0f : -1.0f;
    const float lack = by_turn * step->turn.value + by_length * step->length.value;

    if (lack > 0.0f) {
        struct jp_teb_step_terms *const terms = &sums->terms->step;
        const float weight = sums->teb->internal.weights.turn_radius;
        const float pull = pull_of(sums, weight, lack);

        terms->length.way_way += weight;
        terms->length_turn += weight * by_length * by_turn;
        terms->turn.way_way += weight * radius * radius;
        terms->length.way += by_length * pull;
        terms->turn.way += by_turn * pull;
    }
}

/* Time, and drag on the way. */
static inline void add_time(struct sums *sums, const struct step *step)
{
    const struct jp_teb_weights *const weights = &sums->teb->internal.weights;
    struct jp_teb_step_terms *const terms = &sums->terms->step;
    const float rate = step->length.rate;
    const float drag = weights->drag * rate;

    sums->cost += weights->second * step->interval + drag * step->length.value;
    terms->interval_interval += 0.5f * (weights->second + drag * rate) * step->inverse;
    terms->interval += weights->second - drag * rate;
    terms->length.way_way += 2.0f * weights->drag * step->inverse;
    terms->length.way_interval -= drag * step->inverse;
    terms->length.way += 2.0f * drag;
}

static inline void add_way(struct sums *sums, const struct step *step)
{
    const float weight = sums->teb->internal.weights.metre;
    struct jp_teb_way_terms *const way = &sums->terms->step.length;
    const float length = step->length.value;
    const float smooth = jp_plane_length(length, WAY_SMOOTHING);
    const float by_length = length / smooth;

    sums->cost += weight * smooth;
    way->way_way += 0.5f * weight * by_length * by_length / smooth;
    way->way += weight * by_length;
}

/* ---- Acceleration ---- */

/* A limit of a number by one step's way and interval. */
static inline void add_one(struct jp_teb_step_terms *terms, struct jp_teb_way_terms *way, float weight, float pull,
                           float by_way, float by_interval)
{
    way->way_way += weight * by_way * by_way;
    way->way_interval += weight * by_way * by_interval;
    way->way += pull * by_way;
    terms->interval_interval += weight * by_interval * by_interval;
    terms->interval += pull * by_interval;
}

/* How far beyond ±limit. */
static inline float beyond(float value, float limit)
{
    return value > limit ? value - limit : value < -limit ? value + limit : 0.0f;
}

/* Acceleration at an end of the band, beyond which the rate is `outside`. */
static void add_end_change(struct sums *sums, const struct step *step, const struct way *way, float outside,
                           float limit, float weight, struct jp_teb_way_terms *terms)
{
    const float change = (way->rate - outside) * step->inverse;
    const float excess = beyond(change, limit);

    if (excess != 0.0f) {
        add_one(&sums->terms->step, terms, weight, pull_of(sums, weight, excess), step->inverse * step->inverse,
                -(way->rate * step->inverse + change) * step->inverse);
    }
}

/* What two steps have of a change between them. */
struct ends {
    const struct way *way;
    float inverse; /* of the interval */
    struct jp_teb_step_terms *terms;
    struct jp_teb_way_terms *way_terms;
};

/* Acceleration between two steps, over the mean of both intervals. */
static inline void add_change(struct sums *sums, struct ends before, struct ends after, float inverse, float limit,
                              float weight, struct jp_teb_change_terms *terms,
                              struct jp_teb_way_change_terms *way_terms)
{
    const float change = (after.way->rate - before.way->rate) * inverse;
    const float excess = beyond(change, limit);

    if (excess != 0.0f) {
        const float pull = pull_of(sums, weight, excess);
        const float by_mean = -0.5f * change * inverse;
        const float by_before = -inverse * before.inverse;
        const float by_after = inverse * after.inverse;
        const float by_interval = by_mean - by_before * before.way->rate;
        const float by_next_interval = by_mean - by_after * after.way->rate;

        add_one(before.terms, before.way_terms, weight, pull, by_before, by_interval);
        add_one(after.terms, after.way_terms, weight, pull, by_after, by_next_interval);
        way_terms->way_way += weight * by_before * by_after;
        way_terms->way_interval += weight * by_before * by_next_interval;
        way_terms->interval_way += weight * by_interval * by_after;
        terms->interval_interval += weight * by_interval * by_next_interval;
    }
}

/* Between the last step and the one whose terms are summed up. */
static inline void add_acceleration(struct sums *sums, const struct step *before, const struct step *after)
{
    const struct jp_teb_config *const config = &sums->teb->config;
    const struct jp_teb_weights *const weights = &sums->teb->internal.weights;
    struct jp_teb_terms *const last = sums->last;
    struct jp_teb_step_terms *const next = &sums->terms->step;
    const float inverse = 2.0f / (before->interval + after->interval);
    const struct ends lengths[] = {{&before->length, before->inverse, &last->step, &last->step.length},
                                   {&after->length, after->inverse, next, &next->length}};
    const struct ends turns[] = {{&before->turn, before->inverse, &last->step, &last->step.turn},
                                 {&after->turn, after->inverse, next, &next->turn}};

    add_change(sums, lengths[0], lengths[1], inverse, config->acceleration, weights->acceleration, &last->change,
               &last->change.length);
    add_change(sums, turns[0], turns[1], inverse, config->turn_acceleration, weights->turn_acceleration, &last->change,
               &last->change.turn);
}

static void add_start(struct sums *sums, const struct step *step)
{
    const struct jp_teb *const teb = sums->teb;

    add_end_change(sums, step, &step->length, teb->internal.task.speed.forward, teb->config.acceleration,
                   teb->internal.weights.acceleration, &sums->terms->step.length);
    add_end_change(sums, step, &step->turn, teb->internal.task.speed.turn_rate, teb->config.turn_acceleration,
                   teb->internal.weights.turn_acceleration, &sums->terms->step.turn);
}

static void add_goal(struct sums *sums, const struct step *step)
{
    const struct jp_teb *const teb = sums->teb;

    add_end_change(sums, step, &step->length, teb->internal.task.goal_speed, teb->config.acceleration,
                   teb->internal.weights.acceleration, &sums->terms->step.length);
}

static void add_step(struct sums *sums, unsigned i, struct step *step)
{
    static const struct jp_teb_change_terms no_change = {.interval_interval = 0.0f};
    const struct jp_teb_pose *const poses = sums->teb->poses;

    measure_step(&poses[i], &poses[i + 1U], sums->teb->internal.root_nonholonomic, step, &sums->terms->step);
    sums->terms->change = no_change;
    sums->cost += 0.5f * sums->terms->step.side * sums->terms->step.side;
    add_limits(sums, step);
    add_turn_radius(sums, step);
    add_time(sums, step);
    add_way(sums, step);
}

/* ---- A pose ---- */

/* A residual by the place of the pose alone. */
static inline void add_pull(struct sums *sums, float weight, const struct jp_plane_pose *by, float residual)
{
    struct jp_teb_pose_terms *const terms = &sums->terms->pose;
    const float pull = pull_of(sums, weight, residual);
    const float x = weight * by->x;
    const float y = weight * by->y;
    const float heading = weight * by->heading;

    terms->xx += x * by->x;
    terms->yx += x * by->y;
    terms->yy += y * by->y;
    terms->heading_x += heading * by->x;
    terms->heading_y += heading * by->y;
    terms->heading_heading += heading * by->heading;
    terms->x += pull * by->x;
    terms->y += pull * by->y;
    terms->heading += pull * by->heading;
}

static void add_path(struct sums *sums, unsigned i)
{
    const struct jp_teb_foot *const foot = &sums->teb->internal.feet[i];
    const struct jp_plane_pose *const pose = &sums->teb->poses[i].pose;
    const struct jp_plane_pose by = {foot->normal.x, foot->normal.y, 0.0f};

    add_pull(sums, sums->teb->internal.weights.path, &by,
             by.x * (pose->x - foot->point.x) + by.y * (pose->y - foot->point.y));
}

/* Distances are computed anew where the pose has moved since the obstacles were found. */
static void add_obstacles(struct sums *sums, unsigned i)
{
    struct jp_teb *const teb = sums->teb;
    struct jp_teb_neighbours *const near = &teb->internal.near[i];
    const float clearance = teb->config.clearance;
    const float sweep =
        near->count > 0U ? jp_teb_sweep(&teb->config.footprint, &near->pose, &teb->poses[i].pose) : 0.0f;

    for (unsigned k = 0; k < near->count && near->distance[k] < clearance + sweep; k++) {
        float distance = near->distance[k];
        struct jp_plane_pose by = near->gradient[k];

        if (sweep > 0.0f) {
            distance = jp_teb_distance(teb, i, near->shape[k], near->time, &near->feature[k], &by);
        }
        if (distance < clearance) {
            add_pull(sums, teb->internal.weights.obstacle, &by, distance - clearance);
        }
    }
}

/* The first pose against where the robot was seen. */
static void add_sighting(struct sums *sums, const struct jp_plane_pose *seen, float weight)
{
    const struct jp_plane_pose *const pose = &sums->teb->poses[0].pose;
    struct jp_teb_pose_terms *const terms = &sums->terms->pose;

    terms->xx += weight;
    terms->yy += weight;
    terms->heading_heading += weight;
    terms->x += pull_of(sums, weight, pose->x - seen->x);
    terms->y += pull_of(sums, weight, pose->y - seen->y);
    terms->heading += pull_of(sums, weight, jp_plane_wrap(pose->heading - seen->heading));
}

bool jp_teb_has_odometry(const struct jp_teb *teb)
{
    return teb->internal.weights.laser_odometry > 0.0f && teb->internal.task.is_measured;
}

static void add_pose(struct sums *sums, unsigned i)
{
    const struct jp_teb *const teb = sums->teb;

    sums->terms->pose = no_pull;
    if (i > 0U) {
        add_path(sums, i);
        add_obstacles(sums, i);
    } else if (jp_teb_has_odometry(teb)) {
        add_sighting(sums, &teb->internal.task.start, teb->internal.weights.wheel_odometry);
        add_sighting(sums, &teb->internal.task.measured, teb->internal.weights.laser_odometry);
    } else {
        /* The wheels' pose is taken as it is. */
    }
}

/* ---- The band ---- */

float jp_teb_linearise(struct jp_teb *teb, float limit)
{
    struct jp_teb_terms *const terms = teb->internal.terms[1U - teb->internal.kept_terms];
    struct sums sums = {teb, terms, terms, 0.0f};
    const unsigned last = teb->count - 1U;
    struct step steps[2];

    terms[last].pose = no_pull;
    for (unsigned i = 0; i < last && sums.cost < limit; i++) {
        struct step *const step = &steps[i % 2U];

        sums.last = sums.terms;
        sums.terms = &terms[i];
        add_step(&sums, i, step);
        if (i > 0U) {
            add_acceleration(&sums, &steps[(i - 1U) % 2U], step);
        } else {
            add_start(&sums, step);
        }
        if (i + 1U == last) {
            add_goal(&sums, step);
        }
        add_pose(&sums, i);
    }
    return sums.cost;
}
