#include "scan_match.h"

#include <string.h>

/* Neighbours within this of a point, and this many beams' spacing, make its line, m. */
#define LINE_REACH       0.1
#define LINE_REACH_BEAMS 4
#define LINE_WINDOW      12 /* beams to either side */
#define LINE_POINTS_MIN  4
#define LINE_ROUGHNESS   0.02 /* largest standard deviation across the line, m */

/* Pairs may be this far apart, m; then half as far after each iteration, or this many of its steps. */
#define PAIR_DISTANCE_FIRST 0.5
#define PAIR_DISTANCE_LAST  0.1
#define PAIR_DISTANCE_STEPS 4

/* Share of the pairs that is kept, the best; as exactly as the bins of their residuals, m. */
#define KEPT      0.9
#define TRIM_BIN  0.002
#define TRIM_BINS 256

/* Residual at which a pair counts half (Cauchy's weight), m: the noise of a range; from far away first a share of the
 * distance allowed. */
#define HALF_WEIGHT       0.01
#define HALF_WEIGHT_SHARE 0.1

/* A pair with a larger residual is no inlier, m. */
#define RESIDUAL_INLIER 0.06

/* With this share of inliers, or this near the guess, no better match is looked for. */
#define INLIERS_GOOD       0.6
#define CONFIRMED_DISTANCE 0.03 /* m */
#define CONFIRMED_TURN     0.02 /* rad */

#define ITERATIONS_MAX 25
#define STEP_END       1e-4 /* m and rad */
#define STEP_DIVERGED  1e-2 /* m and rad: larger steps at the end are no fit */

#define JACOBI_SWEEPS 6

/* A point of the scan on a line of the key scan. */
struct pair {
    struct planar_point arm; /* of the point from the scanner, in the key's axes */
    struct planar_point normal;
    double residual; /* m */
};

struct cloud {
    int count;
    struct planar_point points[LASER_BEAMS_MAX]; /* in the scanner's frame */
};

/* Normal equations of the pairs: information · step = gradient, for x, y and the heading. */
struct equations {
    double information[3][3];
    double gradient[3];
};

struct eigen {
    double values[3];
    double vectors[3][3]; /* vectors[i] belongs to values[i] */
};

/* How the pairs lie at a pose. */
struct fit {
    struct pair pairs[LASER_BEAMS_MAX];
    int pair_count;
    int inliers;
    double residual;
    struct equations equations;
    struct eigen eigen;
};

static double square(double a)
{
    return a * a;
}

static double squared_distance(struct planar_point a, struct planar_point b)
{
    return square(a.x - b.x) + square(a.y - b.y);
}

static struct planar_point beam_point(const struct laser_scan *scan, int beam)
{
    const double bearing = scan->first + beam * scan->step;

    return (struct planar_point){scan->ranges[beam] * cos(bearing), scan->ranges[beam] * sin(bearing)};
}

static void collect(const struct laser_scan *scan, struct cloud *cloud)
{
    cloud->count = 0;
    for (int i = 0; i < scan->beams; i++) {
        if (scan->ranges[i] > 0) {
            cloud->points[cloud->count++] = beam_point(scan, i);
        }
    }
}

/* ---- Lines of the key scan ------------------------------------------------------------------------------------- */

struct sums {
    double count;
    double x, y;
    double xx, xy, yy; /* about the first point */
};

static void add(struct sums *sums, double x, double y)
{
    sums->count += 1;
    sums->x += x;
    sums->y += y;
    sums->xx += x * x;
    sums->xy += x * y;
    sums->yy += y * y;
}

/* The beam beside another, −1: none. */
static int beside(const struct scan_matcher *matcher, int beam, int side)
{
    const int next = beam + side;

    if (next >= 0 && next < matcher->beams) {
        return next;
    }
    return matcher->around ? (next + matcher->beams) % matcher->beams : -1;
}

/* Adds the points of one side that lie on the same surface, without a gap. */
static void add_side(const struct scan_matcher *matcher, int beam, int side, double reach, struct sums *sums)
{
    const struct planar_point centre = matcher->lines[beam].point;
    struct planar_point last = centre;
    int next = beam;

    for (int i = 0; i < LINE_WINDOW; i++) {
        next = beside(matcher, next, side);
        if (next < 0) {
            return;
        }
        const struct planar_point point = matcher->lines[next].point;
        if (matcher->ranges[next] <= 0) {
            continue;
        }
        if (squared_distance(point, last) > square(reach) || squared_distance(point, centre) > square(reach)) {
            return;
        }
        add(sums, point.x - centre.x, point.y - centre.y);
        last = point;
    }
}

/* Total least squares. */
static void fit_line(struct scan_matcher *matcher, int beam)
{
    struct scan_match_line *line = &matcher->lines[beam];
    const double reach = LINE_REACH + LINE_REACH_BEAMS * (double)matcher->ranges[beam] * matcher->step;
    struct sums sums = {0};

    add(&sums, 0, 0);
    add_side(matcher, beam, 1, reach, &sums);
    add_side(matcher, beam, -1, reach, &sums);
    const double x = sums.x / sums.count;
    const double y = sums.y / sums.count;
    const double xx = sums.xx / sums.count - x * x;
    const double xy = sums.xy / sums.count - x * y;
    const double yy = sums.yy / sums.count - y * y;
    const double along = atan2(2 * xy, xx - yy) / 2;
    const double across = (xx + yy - hypot(xx - yy, 2 * xy)) / 2;

    line->centre = (struct planar_point){line->point.x + x, line->point.y + y};
    line->normal = (struct planar_point){-sin(along), cos(along)};
    line->fitted = sums.count >= LINE_POINTS_MIN && across < square(LINE_ROUGHNESS);
}

static void set_key(struct scan_matcher *matcher, const struct laser_scan *scan)
{
    matcher->has_key = true;
    matcher->key = matcher->pose;
    matcher->beams = scan->beams;
    matcher->first = scan->first;
    matcher->step = scan->step;
    matcher->around = scan->beams * scan->step > 2 * M_PI - scan->step / 2;
    memcpy(matcher->ranges, scan->ranges, sizeof matcher->ranges);
    for (int i = 0; i < scan->beams; i++) {
        matcher->lines[i].point = beam_point(scan, i);
        matcher->sines[i] = i * scan->step < M_PI / 2 ? sin(i * scan->step) : 1;
    }
    for (int i = 0; i < scan->beams; i++) {
        matcher->lines[i].fitted = false;
        if (scan->ranges[i] > 0) {
            fit_line(matcher, i);
        }
    }
}

/* ---- Pairs ----------------------------------------------------------------------------------------------------- */

/* Search for the nearest point of the key scan. */
struct search {
    const struct scan_matcher *matcher;
    struct planar_point point;
    double range;
    double best; /* squared distance */
    int beam;    /* of the nearest point; -1: none */
};

static void compare(struct search *search, int beam)
{
    const struct planar_point other = search->matcher->lines[beam].point;
    const double distance = squared_distance(other, search->point);

    if (search->matcher->ranges[beam] > 0 && distance < search->best) {
        search->best = distance;
        search->beam = beam;
    }
}

/* Away from the bearing of the point, until every beam passes it farther than the best one. */
static void search_side(struct search *search, int beam, int side)
{
    for (int away = 1; away < search->matcher->beams; away++) {
        beam = beside(search->matcher, beam, side);
        /* The first beam may be half a step off the bearing. */
        if (beam < 0 || square(search->range * search->matcher->sines[away - 1]) > search->best) {
            return;
        }
        compare(search, beam);
    }
}

static int nearest(const struct scan_matcher *matcher, struct planar_point point, double distance)
{
    struct search search = {matcher, point, sqrt(square(point.x) + square(point.y)), square(distance), -1};
    const double turn = matcher->around ? 2 * M_PI : 0;
    const double bearing = atan2(point.y, point.x) - matcher->first;
    const long beam = lround((bearing < 0 ? bearing + turn : bearing) / matcher->step);
    const int start =
        matcher->around ? (int)(beam % matcher->beams) : (int)fmin(fmax((double)beam, 0), matcher->beams - 1);

    compare(&search, start);
    search_side(&search, start, 1);
    search_side(&search, start, -1);
    return search.beam;
}

static void find_pairs(const struct scan_matcher *matcher, const struct cloud *cloud, const struct planar_pose *pose,
                       double distance, struct fit *fit)
{
    const double cosine = cos(pose->heading);
    const double sine = sin(pose->heading);

    fit->pair_count = 0;
    for (int i = 0; i < cloud->count; i++) {
        const struct planar_point p = cloud->points[i];
        const struct planar_point arm = {cosine * p.x - sine * p.y, sine * p.x + cosine * p.y};
        const struct planar_point point = {pose->x + arm.x, pose->y + arm.y};
        const int beam = nearest(matcher, point, distance);
        if (beam >= 0 && matcher->lines[beam].fitted) {
            const struct scan_match_line *line = &matcher->lines[beam];
            const double residual =
                line->normal.x * (point.x - line->centre.x) + line->normal.y * (point.y - line->centre.y);
            fit->pairs[fit->pair_count++] = (struct pair){arm, line->normal, residual};
        }
    }
}

static int bin_of(const struct pair *pair)
{
    return (int)fmin(fabs(pair->residual) / TRIM_BIN, TRIM_BINS - 1);
}

/* Drops the worst pairs, by a histogram of their residuals. */
static void trim(struct fit *fit)
{
    int bins[TRIM_BINS] = {0};
    int bin = 0;
    int kept = 0;

    for (int i = 0; i < fit->pair_count; i++) {
        bins[bin_of(&fit->pairs[i])]++;
    }
    for (int below = bins[0]; below < KEPT * fit->pair_count; below += bins[bin]) {
        bin++;
    }
    for (int i = 0; i < fit->pair_count; i++) {
        if (bin_of(&fit->pairs[i]) <= bin) {
            fit->pairs[kept++] = fit->pairs[i];
        }
    }
    fit->pair_count = kept;
}

/* ---- Gauss–Newton ---------------------------------------------------------------------------------------------- */

static void weigh(double half_weight, struct fit *fit)
{
    struct equations *equations = &fit->equations;
    double squares = 0;

    *equations = (struct equations){0};
    fit->inliers = 0;
    for (int i = 0; i < fit->pair_count; i++) {
        const struct pair *pair = &fit->pairs[i];
        const double weight = 1 / (1 + square(pair->residual / half_weight));
        const double row[3] = {pair->normal.x, pair->normal.y,
                               pair->normal.y * pair->arm.x - pair->normal.x * pair->arm.y};
        for (int j = 0; j < 3; j++) {
            equations->gradient[j] -= weight * row[j] * pair->residual;
            for (int k = 0; k < 3; k++) {
                equations->information[j][k] += weight * row[j] * row[k];
            }
        }
        if (fabs(pair->residual) < RESIDUAL_INLIER) {
            fit->inliers++;
            squares += square(pair->residual);
        }
    }
    fit->residual = fit->inliers > 0 ? sqrt(squares / fit->inliers) : 0;
}

/* Turns the axes p and q so that a[p][q] vanishes. */
static void rotate(double a[3][3], double vectors[3][3], int p, int q)
{
    if (a[p][q] == 0) {
        return;
    }
    const double angle = atan2(2 * a[p][q], a[q][q] - a[p][p]) / 2;
    const double c = cos(angle);
    const double s = sin(angle);
    for (int i = 0; i < 3; i++) {
        const double ip = a[i][p];
        const double iq = a[i][q];
        a[i][p] = c * ip - s * iq;
        a[i][q] = s * ip + c * iq;
    }
    for (int i = 0; i < 3; i++) {
        const double pi = a[p][i];
        const double qi = a[q][i];
        const double vp = vectors[p][i];
        const double vq = vectors[q][i];
        a[p][i] = c * pi - s * qi;
        a[q][i] = s * pi + c * qi;
        vectors[p][i] = c * vp - s * vq;
        vectors[q][i] = s * vp + c * vq;
    }
}

/* Jacobi's method. */
static struct eigen eigen_of(const double matrix[3][3])
{
    struct eigen eigen = {.vectors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    double a[3][3];

    memcpy(a, matrix, sizeof a);
    for (int sweep = 0; sweep < JACOBI_SWEEPS; sweep++) {
        rotate(a, eigen.vectors, 0, 1);
        rotate(a, eigen.vectors, 0, 2);
        rotate(a, eigen.vectors, 1, 2);
    }
    for (int i = 0; i < 3; i++) {
        eigen.values[i] = a[i][i];
    }
    return eigen;
}

/* Only along the directions that the lines tell. */
static void solve(const struct fit *fit, double step[3])
{
    memset(step, 0, 3 * sizeof step[0]);
    for (int i = 0; i < 3; i++) {
        const double *vector = fit->eigen.vectors[i];
        const double *gradient = fit->equations.gradient;
        if (fit->eigen.values[i] >= SCAN_MATCH_WEAK * fit->pair_count) {
            const double along = vector[0] * gradient[0] + vector[1] * gradient[1] + vector[2] * gradient[2];
            for (int j = 0; j < 3; j++) {
                step[j] += along / fit->eigen.values[i] * vector[j];
            }
        }
    }
}

/* Where a match starts, and whether that may be far off. */
struct start {
    struct planar_pose pose;
    bool far;
};

/* Moves `pose`, in the key's frame, to where the scans fit. */
static enum scan_match_status iterate(const struct scan_matcher *matcher, const struct cloud *cloud, bool far,
                                      struct planar_pose *pose, struct fit *fit, int *iterations)
{
    double distance = PAIR_DISTANCE_FIRST;
    double size = INFINITY;

    for (*iterations = 0; *iterations < ITERATIONS_MAX && size > STEP_END; (*iterations)++) {
        double step[3];
        find_pairs(matcher, cloud, pose, distance, fit);
        trim(fit);
        if (fit->pair_count < SCAN_MATCH_POINTS_MIN) {
            return SCAN_MATCH_FEW_POINTS;
        }
        weigh(far ? HALF_WEIGHT_SHARE * distance : HALF_WEIGHT, fit);
        fit->eigen = eigen_of(fit->equations.information);
        solve(fit, step);
        pose->x += step[0];
        pose->y += step[1];
        pose->heading = planar_wrap(pose->heading + step[2]);
        const double moved = fmax(hypot(step[0], step[1]), fabs(step[2]));
        size = distance > PAIR_DISTANCE_LAST ? INFINITY : moved;
        distance = fmax(fmin(distance / 2, PAIR_DISTANCE_STEPS * moved), PAIR_DISTANCE_LAST);
    }
    const bool fits = size < STEP_DIVERGED && fit->residual < SCAN_MATCH_RESIDUAL_MAX &&
                      fit->inliers >= SCAN_MATCH_INLIERS_MIN * cloud->count;
    return fits ? SCAN_MATCH_OK : SCAN_MATCH_DIVERGED;
}

/* ---- Odometry -------------------------------------------------------------------------------------------------- */

/* A vector in pose.x, pose.y and the heading out of the key's axes. */
static void turn_vector(const struct planar_pose *key, const double vector[3], double turned[3])
{
    turned[0] = cos(key->heading) * vector[0] - sin(key->heading) * vector[1];
    turned[1] = sin(key->heading) * vector[0] + cos(key->heading) * vector[1];
    turned[2] = vector[2];
}

static void report_information(const struct planar_pose *key, const struct fit *fit, struct scan_match_result *result)
{
    int weakest = 0;

    for (int i = 0; i < 3; i++) {
        double vector[3];
        turn_vector(key, fit->eigen.vectors[i], vector);
        for (int j = 0; j < 3; j++) {
            for (int k = 0; k < 3; k++) {
                result->information[j][k] += fit->eigen.values[i] * vector[j] * vector[k];
            }
        }
        weakest = fit->eigen.values[i] < fit->eigen.values[weakest] ? i : weakest;
    }
    turn_vector(key, fit->eigen.vectors[weakest], result->weak);
    result->weakest = fit->eigen.values[weakest] / fit->pair_count;
    result->degenerate = result->weakest < SCAN_MATCH_WEAK;
}

static bool is_apart(const struct planar_pose *a, const struct planar_pose *b, double distance, double turn)
{
    const struct planar_pose off = planar_between(a, b);

    return hypot(off.x, off.y) > distance || fabs(off.heading) > turn;
}

static void match(const struct scan_matcher *matcher, const struct cloud *cloud, const struct start *start,
                  struct scan_match_result *result)
{
    struct planar_pose pose = planar_between(&matcher->key, &start->pose);
    struct fit fit = {0};

    *result = (struct scan_match_result){0};
    result->status = iterate(matcher, cloud, start->far, &pose, &fit, &result->iterations);
    if (result->status != SCAN_MATCH_FEW_POINTS) {
        result->residual = fit.residual;
        result->inlier_share = (double)fit.inliers / cloud->count;
        report_information(&matcher->key, &fit, result);
    }
    result->pose = planar_compose(&matcher->key, &pose);
}

static bool is_better(const struct scan_match_result *a, const struct scan_match_result *b)
{
    return a->status == SCAN_MATCH_OK && (b->status != SCAN_MATCH_OK || a->inlier_share > b->inlier_share);
}

/* From the guess as a good one; unless that fits well, also as one that is far off, and from the motion before. Not
 * from far off at once: where walls tell little, someone who walks along with the robot would pull the pose. */
static void match_guess(const struct scan_matcher *matcher, const struct cloud *cloud, const struct planar_pose *guess,
                        struct scan_match_result *result)
{
    const struct start starts[] = {
        {*guess, false}, {*guess, true}, {planar_compose(&matcher->pose, &matcher->motion), true}};

    match(matcher, cloud, &starts[0], result);
    const bool good =
        result->status == SCAN_MATCH_OK &&
        (result->inlier_share > INLIERS_GOOD || !is_apart(guess, &result->pose, CONFIRMED_DISTANCE, CONFIRMED_TURN));
    for (int i = 1; i < 3 && !good; i++) {
        struct scan_match_result other;
        match(matcher, cloud, &starts[i], &other);
        *result = is_better(&other, result) ? other : *result;
    }
    if (result->status != SCAN_MATCH_OK) {
        result->pose = *guess;
    } else if (is_apart(guess, &result->pose, SCAN_MATCH_JUMP_DISTANCE, SCAN_MATCH_JUMP_TURN)) {
        result->status = SCAN_MATCH_JUMP;
    }
}

/* Whether the scan, as matched, is to be the next key scan. */
static bool is_key(const struct scan_matcher *matcher, const struct scan_match_result *result)
{
    const struct planar_pose way = planar_between(&matcher->key, &result->pose);

    return hypot(way.x, way.y) > SCAN_MATCH_KEY_DISTANCE || fabs(way.heading) > SCAN_MATCH_KEY_TURN ||
           result->inlier_share < SCAN_MATCH_KEY_INLIERS;
}

void scan_match_init(struct scan_matcher *matcher, const struct planar_pose *pose)
{
    *matcher = (struct scan_matcher){.pose = *pose};
}

void scan_match_next(struct scan_matcher *matcher, const struct laser_scan *scan, const struct planar_pose *motion,
                     struct scan_match_result *result)
{
    static const struct planar_pose none = {0, 0, 0};
    const struct planar_pose *guessed = matcher->has_key ? (motion == NULL ? &matcher->motion : motion) : &none;
    struct cloud cloud;

    *result = (struct scan_match_result){.status = SCAN_MATCH_FEW_POINTS};
    result->pose = planar_compose(&matcher->pose, guessed);
    collect(scan, &cloud);
    const bool enough = cloud.count >= SCAN_MATCH_POINTS_MIN;
    if (enough && matcher->has_key) {
        const struct planar_pose guess = result->pose;
        match_guess(matcher, &cloud, &guess, result);
    }
    matcher->motion = planar_between(&matcher->pose, &result->pose);
    matcher->pose = result->pose;
    result->new_key = enough && (!matcher->has_key || is_key(matcher, result));
    if (result->new_key) {
        result->status = matcher->has_key ? result->status : SCAN_MATCH_OK;
        set_key(matcher, scan);
    }
}
