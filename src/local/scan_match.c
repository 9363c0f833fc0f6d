#include <joulepath/scan_match.h>

#include <string.h>

#include "src/base/block.h"
#include "src/base/plane.h"
#include "src/local/eigen.h"
#include "src/local/scan_runs.h"

/* A line is fitted to the neighbours of a point within this distance, m, and so many spacings of the beams. */
#define LINE_REACH       0.1f
#define LINE_REACH_BEAMS 4.0f
#define LINE_WINDOW      12 /* beams to either side */
#define LINE_POINTS_MIN  4.0f
#define LINE_ROUGHNESS   0.02f /* largest standard deviation across the line, m */

/* Pairs may be this far apart, m; then half as far after each iteration, or this many of its steps. */
#define PAIR_DISTANCE_FIRST 0.5f
#define PAIR_DISTANCE_LAST  0.1f
#define PAIR_DISTANCE_STEPS 4.0f

/* Share of the pairs that trimming keeps, to a bin of the histogram of their residuals, m. */
#define KEPT      0.9f
#define TRIM_BIN  0.002f
#define TRIM_BINS 256

/* Residual at which Cauchy's weight is one half, m: the noise of a range. After a guess that may be far off it begins
 * as a share of the allowed distance of a pair. */
#define HALF_WEIGHT       0.01f
#define HALF_WEIGHT_SHARE 0.1f

/* A pair with a larger residual is no inlier, m. */
#define RESIDUAL_INLIER 0.06f

/* With this share of inliers, or a fit this near to the guess, no other match is tried. */
#define INLIERS_GOOD       0.6f
#define CONFIRMED_DISTANCE 0.03f /* m */
#define CONFIRMED_TURN     0.02f /* rad */

#define ITERATIONS_MAX 25U
#define STEP_END       1.0e-4f /* m and rad */
#define STEP_DIVERGED  1.0e-2f /* m and rad: larger steps at the end are no fit */

#define NO_BEAM (-1)

/* Normal equations of the pairs: information · step = gradient, for x, y and the heading. */
struct match_equations {
    float information[3][3];
    float gradient[3];
};

/* The fit of the pairs at a pose. */
struct fit {
    int32_t pair_count;
    int32_t inliers;
    float residual;
    struct match_equations equations;
    struct jp_eigen eigen;
};

static float square(float a)
{
    return a * a;
}

/* ---- Scans ---- */

static bool has_hit(float range)
{
    return range > 0.0f && range <= JP_PLANE_MAX;
}

static struct jp_plane_point beam_point(const struct jp_scan *scan, int32_t beam)
{
    const struct jp_plane_point direction = jp_plane_direction(scan->first_angle + (float)beam * scan->angle_step);
    const float range = scan->ranges[beam];

    return (struct jp_plane_point){range * direction.x, range * direction.y};
}

static void collect(struct jp_scan_matcher_internal *self, const struct jp_scan *scan)
{
    self->cloud_count = 0;
    for (int32_t i = 0; i < (int32_t)scan->count; i++) {
        if (has_hit(scan->ranges[i])) {
            self->cloud[self->cloud_count] = beam_point(scan, i);
            self->cloud_count++;
        }
    }
}

/* ---- Lines of the key scan ---- */

struct match_sums {
    float count;
    float x;
    float y;
    float xx; /* about the first point */
    float xy;
    float yy;
};

static void add(struct match_sums *sums, float x, float y)
{
    sums->count += 1.0f;
    sums->x += x;
    sums->y += y;
    sums->xx += x * x;
    sums->xy += x * y;
    sums->yy += y * y;
}

static int32_t beside(const struct jp_scan_matcher_internal *self, int32_t beam, int32_t side)
{
    const int32_t next = beam + side;

    if (next >= 0 && next < self->beams) {
        return next;
    }
    return self->is_around ? (next + self->beams) % self->beams : NO_BEAM;
}

/* Adds the points of one side that lie on the same surface, without a gap. */
static void add_side(const struct jp_scan_matcher_internal *self, int32_t beam, int32_t side, float reach,
                     struct match_sums *sums)
{
    const struct jp_plane_point *const centre = &self->lines[beam].point;
    const struct jp_plane_point *last = centre;
    int32_t next = beside(self, beam, side);

    for (int i = 0; i < LINE_WINDOW && next != NO_BEAM; i++) {
        const struct jp_plane_point *const point = &self->lines[next].point;

        if (has_hit(self->ranges[next])) {
            if (jp_plane_square_between(*point, *last) > square(reach) ||
                jp_plane_square_between(*point, *centre) > square(reach)) {
                return;
            }
            add(sums, point->x - centre->x, point->y - centre->y);
            last = point;
        }
        next = beside(self, next, side);
    }
}

/* Total least squares. */
static void fit_line(struct jp_scan_matcher_internal *self, int32_t beam)
{
    struct jp_match_line *const line = &self->lines[beam];
    const float reach = LINE_REACH + LINE_REACH_BEAMS * self->ranges[beam] * self->step;
    struct match_sums sums = {.count = 0.0f};

    add(&sums, 0.0f, 0.0f);
    add_side(self, beam, 1, reach, &sums);
    add_side(self, beam, -1, reach, &sums);

    const float x = sums.x / sums.count;
    const float y = sums.y / sums.count;
    const float xx = sums.xx / sums.count - x * x;
    const float xy = sums.xy / sums.count - x * y;
    const float yy = sums.yy / sums.count - y * y;
    const struct jp_plane_point along = jp_plane_direction(0.5f * jp_plane_bearing(xx - yy, 2.0f * xy));
    const float across = 0.5f * (xx + yy - jp_plane_length(xx - yy, 2.0f * xy));

    line->centre = (struct jp_plane_point){line->point.x + x, line->point.y + y};
    line->normal = (struct jp_plane_point){-along.y, along.x};
    line->is_fitted = sums.count >= LINE_POINTS_MIN && across < square(LINE_ROUGHNESS);
}

static void set_key(struct jp_scan_matcher *matcher, const struct jp_scan *scan)
{
    struct jp_scan_matcher_internal *const self = &matcher->internal;

    self->has_key = true;
    self->key = matcher->pose;
    self->beams = (int32_t)scan->count;
    self->step = scan->angle_step;
    self->middle = scan->first_angle + 0.5f * (float)(self->beams - 1) * self->step;
    self->is_around = ((float)self->beams + 0.5f) * self->step > 2.0f * JP_PLANE_PI;
    (void)memcpy(self->ranges, scan->ranges, scan->count * sizeof scan->ranges[0]);
    for (int32_t i = 0; i < self->beams; i++) {
        const float angle = (float)i * self->step;

        self->lines[i] = (struct jp_match_line){.is_fitted = false};
        self->sines[i] = angle < 0.5f * JP_PLANE_PI ? jp_plane_sine(angle) : 1.0f;
        if (has_hit(scan->ranges[i])) {
            self->lines[i].point = beam_point(scan, i);
        }
    }
    for (int32_t i = 0; i < self->beams; i++) {
        if (has_hit(scan->ranges[i])) {
            fit_line(self, i);
        }
    }
}

/* ---- Pairs ---- */

/* Search for the nearest point of the key scan. */
struct match_search {
    const struct jp_scan_matcher_internal *self;
    struct jp_plane_point point;
    float range;
    float best;   /* squared distance */
    int32_t beam; /* of the nearest point */
};

static void compare(struct match_search *search, int32_t beam)
{
    const float distance = jp_plane_square_between(search->self->lines[beam].point, search->point);

    if (has_hit(search->self->ranges[beam]) && distance < search->best) {
        search->best = distance;
        search->beam = beam;
    }
}

/* Away from the bearing of the point, until every beam passes it farther than the best one. */
static void search_side(struct match_search *search, int32_t start, int32_t side)
{
    int32_t beam = start;

    for (int32_t away = 1; away < search->self->beams; away++) {
        beam = beside(search->self, beam, side);
        /* The first beam may be half a step off the bearing. */
        if (beam == NO_BEAM || square(search->range * search->self->sines[away - 1]) > search->best) {
            return;
        }
        compare(search, beam);
    }
}

/* The beam whose bearing is nearest. */
static int32_t beam_at(const struct jp_scan_matcher_internal *self, const struct jp_plane_point *point)
{
    const float last = (float)(self->beams - 1);
    const float off = jp_plane_wrap(jp_plane_bearing(point->x, point->y) - self->middle);

    return (int32_t)(jp_plane_clamp(0.5f * last + off / self->step, 0.0f, last) + 0.5f);
}

static int32_t nearest(const struct jp_scan_matcher_internal *self, const struct jp_plane_point *point, float distance)
{
    struct match_search search = {.self = self,
                                  .point = *point,
                                  .range = jp_plane_length(point->x, point->y),
                                  .best = square(distance),
                                  .beam = NO_BEAM};
    const int32_t start = beam_at(self, point);

    compare(&search, start);
    search_side(&search, start, 1);
    search_side(&search, start, -1);
    return search.beam;
}

static void find_pairs(struct jp_scan_matcher_internal *self, const struct jp_plane_pose *pose, float distance,
                       struct fit *fit)
{
    const struct jp_plane_point direction = jp_plane_direction(pose->heading);

    fit->pair_count = 0;
    for (int32_t i = 0; i < self->cloud_count; i++) {
        const struct jp_plane_point *const p = &self->cloud[i];
        const struct jp_plane_point arm = {direction.x * p->x - direction.y * p->y,
                                           direction.y * p->x + direction.x * p->y};
        const struct jp_plane_point point = {pose->x + arm.x, pose->y + arm.y};
        const int32_t beam = nearest(self, &point, distance);

        if (beam != NO_BEAM && self->lines[beam].is_fitted) {
            const struct jp_match_line *const line = &self->lines[beam];
            const float residual =
                line->normal.x * (point.x - line->centre.x) + line->normal.y * (point.y - line->centre.y);

            self->pairs[fit->pair_count] = (struct jp_match_pair){arm, line->normal, residual};
            fit->pair_count++;
        }
    }
}

static int32_t bin_of(const struct jp_match_pair *pair)
{
    return (int32_t)jp_plane_smaller(jp_plane_magnitude(pair->residual) / TRIM_BIN, (float)(TRIM_BINS - 1));
}

/* Drops the worst pairs, by a histogram of their residuals. */
static void trim(struct jp_scan_matcher_internal *self, struct fit *fit)
{
    const float kept_least = KEPT * (float)fit->pair_count;
    uint16_t bins[TRIM_BINS] = {0};
    uint32_t below;
    int32_t last = 0;
    int32_t kept = 0;

    for (int32_t i = 0; i < fit->pair_count; i++) {
        bins[bin_of(&self->pairs[i])]++;
    }
    below = bins[0];
    while ((float)below < kept_least) {
        last++;
        below += bins[last];
    }
    for (int32_t i = 0; i < fit->pair_count; i++) {
        if (bin_of(&self->pairs[i]) <= last) {
            self->pairs[kept] = self->pairs[i];
            kept++;
        }
    }
    fit->pair_count = kept;
}

/* ---- Gauss–Newton ---- */

static void add_pair(struct match_equations *equations, const struct jp_match_pair *pair, float weight)
{
    const float row[3] = {pair->normal.x, pair->normal.y, pair->normal.y * pair->arm.x - pair->normal.x * pair->arm.y};

    for (int j = 0; j < 3; j++) {
        equations->gradient[j] -= weight * row[j] * pair->residual;
        for (int k = 0; k < 3; k++) {
            equations->information[j][k] += weight * row[j] * row[k];
        }
    }
}

static void weigh(const struct jp_scan_matcher_internal *self, float half_weight, struct fit *fit)
{
    float squares = 0.0f;

    (void)memset(&fit->equations, 0, sizeof fit->equations);
    fit->inliers = 0;
    for (int32_t i = 0; i < fit->pair_count; i++) {
        const struct jp_match_pair *const pair = &self->pairs[i];

        add_pair(&fit->equations, pair, 1.0f / (1.0f + square(pair->residual / half_weight)));
        if (jp_plane_magnitude(pair->residual) < RESIDUAL_INLIER) {
            fit->inliers++;
            squares += square(pair->residual);
        }
    }
    fit->residual = jp_plane_square_root(squares / jp_plane_larger((float)fit->inliers, 1.0f));
}

/* Solves for the step only along the directions that the lines determine. */
static void solve(const struct fit *fit, float step[3])
{
    (void)memset(step, 0, 3U * sizeof step[0]);
    for (int i = 0; i < 3; i++) {
        const float *const vector = fit->eigen.vectors[i];
        const float *const gradient = fit->equations.gradient;

        if (fit->eigen.values[i] >= JP_SCAN_MATCH_WEAK * (float)fit->pair_count) {
            const float along = vector[0] * gradient[0] + vector[1] * gradient[1] + vector[2] * gradient[2];

            for (int j = 0; j < 3; j++) {
                step[j] += along / fit->eigen.values[i] * vector[j];
            }
        }
    }
}

/* Moves `pose`, in the key's frame, to where the scans fit; where `is_far`, that may be far off. */
static enum jp_match iterate(struct jp_scan_matcher_internal *self, bool is_far, struct jp_plane_pose *pose,
                             struct fit *fit, uint8_t *iterations)
{
    float distance = PAIR_DISTANCE_FIRST;
    float size = FLT_MAX;

    for (*iterations = 0; *iterations < ITERATIONS_MAX && size > STEP_END; (*iterations)++) {
        float step[3];

        find_pairs(self, pose, distance, fit);
        trim(self, fit);
        if (fit->pair_count < JP_SCAN_MATCH_POINTS_MIN) {
            return JP_MATCH_FEW_POINTS;
        }
        weigh(self, is_far ? HALF_WEIGHT_SHARE * distance : HALF_WEIGHT, fit);
        jp_eigen_find(fit->equations.information, &fit->eigen);
        solve(fit, step);
        pose->x += step[0];
        pose->y += step[1];
        pose->heading = jp_plane_wrap(pose->heading + step[2]);

        const float moved = jp_plane_larger(jp_plane_length(step[0], step[1]), jp_plane_magnitude(step[2]));

        size = distance > PAIR_DISTANCE_LAST ? FLT_MAX : moved;
        distance = jp_plane_larger(jp_plane_smaller(0.5f * distance, PAIR_DISTANCE_STEPS * moved), PAIR_DISTANCE_LAST);
    }

    /* The last step and the residual, of what they may be. */
    const float share = jp_plane_larger(size / STEP_DIVERGED, fit->residual / JP_SCAN_MATCH_RESIDUAL_MAX);
    const bool is_fit = share < 1.0f && (float)fit->inliers >= JP_SCAN_MATCH_INLIERS_MIN * (float)self->cloud_count;

    return is_fit ? JP_MATCH_FITS : JP_MATCH_DIVERGED;
}

/* ---- Odometry ---- */

/* A vector in pose.x, pose.y and the heading out of the key's axes. */
static void turn_vector(const struct jp_plane_pose *key, const float vector[3], float turned[3])
{
    const struct jp_plane_point direction = jp_plane_direction(key->heading);

    turned[0] = direction.x * vector[0] - direction.y * vector[1];
    turned[1] = direction.y * vector[0] + direction.x * vector[1];
    turned[2] = vector[2];
}

static void report_information(const struct jp_plane_pose *key, const struct fit *fit, struct jp_match_result *result)
{
    for (int i = 0; i < 3; i++) {
        float vector[3];

        turn_vector(key, fit->eigen.vectors[i], vector);
        for (int j = 0; j < 3; j++) {
            for (int k = 0; k < 3; k++) {
                result->information[j][k] += fit->eigen.values[i] * vector[j] * vector[k];
            }
        }
    }
    turn_vector(key, fit->eigen.vectors[0], result->weak);
    result->weakest = fit->eigen.values[0] / (float)fit->pair_count;
    result->is_degenerate = result->weakest < JP_SCAN_MATCH_WEAK;
}

static bool is_apart(const struct jp_plane_pose *a, const struct jp_plane_pose *b, float distance, float turn)
{
    const struct jp_plane_pose off = jp_plane_relative(a, b);

    return jp_plane_length(off.x, off.y) > distance || jp_plane_magnitude(off.heading) > turn;
}

static void match(struct jp_scan_matcher_internal *self, const struct jp_plane_pose *start, bool is_far,
                  struct jp_match_result *result)
{
    struct jp_plane_pose pose = jp_plane_relative(&self->key, start);
    struct fit fit;

    (void)memset(&fit, 0, sizeof fit);
    (void)memset(result, 0, sizeof *result);
    result->match = iterate(self, is_far, &pose, &fit, &result->iterations);
    if (result->match != JP_MATCH_FEW_POINTS) {
        result->residual = fit.residual;
        result->inlier_share = (float)fit.inliers / (float)self->cloud_count;
        report_information(&self->key, &fit, result);
    }
    result->pose = jp_plane_compose(&self->key, &pose);
}

static bool is_better(const struct jp_match_result *a, const struct jp_match_result *b)
{
    return a->match == JP_MATCH_FITS && (b->match != JP_MATCH_FITS || a->inlier_share > b->inlier_share);
}

static bool is_good(const struct jp_match_result *result, const struct jp_plane_pose *guess)
{
    return result->match == JP_MATCH_FITS &&
           (result->inlier_share > INLIERS_GOOD || !is_apart(guess, &result->pose, CONFIRMED_DISTANCE, CONFIRMED_TURN));
}

/* As from a start that may be far off. */
static void try_better(struct jp_scan_matcher_internal *self, const struct jp_plane_pose *start,
                       struct jp_match_result *result)
{
    struct jp_match_result other;

    match(self, start, true, &other);
    if (is_better(&other, result)) {
        *result = other;
    }
}

/* Matches from the guess with a narrow gate; unless that fits well, also with a wide gate, and from the motion before.
 * A wide gate is not tried first: where walls determine little, a person who walks beside the robot would pull the
 * pose. */
static void match_guess(struct jp_scan_matcher *matcher, const struct jp_plane_pose *guess,
                        struct jp_match_result *result)
{
    const struct jp_plane_pose as_before = jp_plane_compose(&matcher->pose, &matcher->motion);

    match(&matcher->internal, guess, false, result);
    if (!is_good(result, guess)) {
        try_better(&matcher->internal, guess, result);
        try_better(&matcher->internal, &as_before, result);
    }
    if (result->match != JP_MATCH_FITS) {
        result->pose = *guess;
    } else if (is_apart(guess, &result->pose, JP_SCAN_MATCH_JUMP_DISTANCE, JP_SCAN_MATCH_JUMP_TURN)) {
        result->match = JP_MATCH_JUMP;
    } else {
        /* It stays what it is. */
    }
}

/* Whether the scan, as matched, is to be the next key scan. */
static bool is_key(const struct jp_scan_matcher_internal *self, const struct jp_match_result *result)
{
    return is_apart(&self->key, &result->pose, JP_SCAN_MATCH_KEY_DISTANCE, JP_SCAN_MATCH_KEY_TURN) ||
           result->inlier_share < JP_SCAN_MATCH_KEY_INLIERS;
}

enum jp_status jp_scan_match(struct jp_scan_matcher *matcher, const struct jp_scan *scan,
                             const struct jp_plane_pose *motion, struct jp_match_result *result)
{
    static const struct jp_plane_pose none = {0.0f, 0.0f, 0.0f};

    if (matcher == NULL || scan == NULL || result == NULL || !jp_scan_is_sound(scan) ||
        (int32_t)scan->count > matcher->internal.beams_max || (motion != NULL && !jp_plane_is_pose(motion))) {
        return JP_ERR_ARGUMENT;
    }

    struct jp_scan_matcher_internal *const self = &matcher->internal;
    const struct jp_plane_pose *const moved = motion != NULL ? motion : &matcher->motion;
    const struct jp_plane_pose guess = jp_plane_compose(&matcher->pose, self->has_key ? moved : &none);

    collect(self, scan);

    const bool is_enough = self->cloud_count >= JP_SCAN_MATCH_POINTS_MIN;

    (void)memset(result, 0, sizeof *result);
    result->match = JP_MATCH_FEW_POINTS;
    result->pose = guess;
    if (is_enough && self->has_key) {
        match_guess(matcher, &guess, result);
    }
    matcher->motion = jp_plane_relative(&matcher->pose, &result->pose);
    matcher->pose = result->pose;
    result->is_new_key = is_enough && (!self->has_key || is_key(self, result));
    if (result->is_new_key) {
        result->match = self->has_key ? result->match : JP_MATCH_FITS;
        set_key(matcher, scan);
    }
    return JP_OK;
}

/* ---- Preparation ---- */

/* Where the parts of the block begin. */
struct match_layout {
    size_t sines;
    size_t lines;
    size_t cloud;
    size_t pairs;
    size_t end;
};

static struct match_layout lay_out(size_t beams)
{
    struct match_layout layout = {.sines = jp_block_align(beams * sizeof(float))};

    layout.lines = layout.sines + jp_block_align(beams * sizeof(float));
    layout.cloud = layout.lines + jp_block_align(beams * sizeof(struct jp_match_line));
    layout.pairs = layout.cloud + jp_block_align(beams * sizeof(struct jp_plane_point));
    layout.end = layout.pairs + jp_block_align(beams * sizeof(struct jp_match_pair));
    return layout;
}

size_t jp_scan_matcher_size(uint16_t beams_max)
{
    return beams_max >= 2U && beams_max <= JP_SCAN_MATCH_BEAMS_MAX ? lay_out(beams_max).end : 0U;
}

enum jp_status jp_scan_matcher_init(struct jp_scan_matcher *matcher, uint16_t beams_max, void *block, size_t size)
{
    const size_t least = jp_scan_matcher_size(beams_max);

    if (matcher == NULL || block == NULL || least == 0U) {
        return JP_ERR_ARGUMENT;
    }
    if (!jp_block_is_aligned(block)) {
        return JP_ERR_ALIGNMENT;
    }
    if (size < least) {
        return JP_ERR_MEMORY;
    }

    const struct match_layout layout = lay_out(beams_max);
    uint8_t *const bytes = block;

    (void)memset(matcher, 0, sizeof *matcher);
    matcher->internal.beams_max = (int32_t)beams_max;
    matcher->internal.ranges = block;
    matcher->internal.sines = (void *)&bytes[layout.sines];
    matcher->internal.lines = (void *)&bytes[layout.lines];
    matcher->internal.cloud = (void *)&bytes[layout.cloud];
    matcher->internal.pairs = (void *)&bytes[layout.pairs];
    return JP_OK;
}

enum jp_status jp_scan_matcher_start(struct jp_scan_matcher *matcher, const struct jp_plane_pose *pose)
{
    if (matcher == NULL || pose == NULL || !jp_plane_is_pose(pose)) {
        return JP_ERR_ARGUMENT;
    }
    matcher->pose = *pose;
    matcher->motion = (struct jp_plane_pose){0.0f, 0.0f, 0.0f};
    matcher->internal.has_key = false;
    return JP_OK;
}
