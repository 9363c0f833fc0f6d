#include <joulepath/localiser.h>

#include <joulepath/count.h>
#include <string.h>

#include "src/base/block.h"
#include "src/base/config_float_check.h"
#include "src/base/plane.h"
#include "src/local/localiser_match.h"
#include "src/local/localiser_matrix.h"
#include "src/local/localiser_search.h"
#include "src/local/scan_runs.h"
#include "src/local/wall_field.h"

/* A scan with fewer ends says nothing of a pose that is known about, or of one that is not. */
#define POINTS_MIN        12
#define SEARCH_POINTS_MIN 30

/* The cells of the map round its walls: a standard deviation, of a cell. */
#define ROUNDING 0.29f

/* A match needs this share of the ends at walls, and no more of the beams beyond walls. */
#define INLIERS_MIN 0.15f
#define BEYOND_MAX  0.15f
#define THROUGH_MAX 0.5f

/* A pose is sure where the ends of the beams spread over so many standard deviations of their noise. From there on the
 * score must be larger by this for each time that the spread is as large again, up to this, which is less after a
 * search. */
#define SURE_SPREAD 3.0f
#define SHARE_STEP  0.1f

/* Where the pose is not sure, less than this share of the beams cannot determine a direction. */
#define WEAK 0.05f

#define UNSEARCHED 0.7f
#define SEARCHED   0.45f

/* A place is a rival of another one that explains up to this share of the beams more. */
#define RIVAL 0.1f

/* Square of the standard deviations by which a match may be off the prediction. */
#define SURPRISE_MAX 25.0f

/* Every so many-th end is compared with the map. */
#define STRIDE 3

/* So many scans in a row against map or odometry, and it is lost. */
#define DOUBTS_MAX 5U

/* Likewise after so many scans, since the last that fitted, of which the map explains less than this share. */
#define UNEXPLAINED_MAX 50U
#define STRANGE         0.2f

/* A robot is in the open where so many of the beams see nothing and the map shows nothing there. */
#define OPEN 0.5f

/* After a search in vain another one begins after so many scans, or beyond this motion, m and rad. */
#define WAIT_SCANS 10U
#define WAIT_WAY   0.5f
#define WAIT_TURN  0.5f

/* Nothing is known better than this, m and rad, and a standstill is not either. */
#define DEVIATION_MIN 0.001f

/* A search around the last pose goes so many standard deviations far. */
#define REGION 3.0f

/* Of a place that a search found, m and rad. */
#define FOUND_DISTANCE 0.1f
#define FOUND_TURN     0.05f

static float square(float a)
{
    return a * a;
}

static void enter(struct jp_localiser *localiser, enum jp_localiser_state state, enum jp_localiser_reason reason)
{
    localiser->state = state;
    localiser->reason = reason;
}

/* ---- Covariance ---- */

/* Of the place that the robot is taken to be at. */
static float position_deviation(const struct jp_localiser *localiser)
{
    const float xx = localiser->covariance[0][0];
    const float xy = localiser->covariance[0][1];
    const float yy = localiser->covariance[1][1];

    return jp_plane_square_root(0.5f * (xx + yy + jp_plane_length(xx - yy, 2.0f * xy)));
}

static float heading_deviation(const struct jp_localiser *localiser)
{
    return jp_plane_square_root(localiser->covariance[2][2]);
}

static void report_deviations(struct jp_localiser *localiser)
{
    const struct jp_localiser_internal *const self = &localiser->internal;

    localiser->position_deviation = jp_plane_length(position_deviation(localiser), self->rival_distance);
    localiser->heading_deviation = jp_plane_length(heading_deviation(localiser), self->rival_turn);
}

static bool has_rivals(const struct jp_localiser *localiser)
{
    return localiser->internal.rival_distance > 0.0f;
}

static void set_pose(struct jp_localiser *localiser, const struct jp_plane_pose *pose, float distance, float turn)
{
    (void)memset(localiser->covariance, 0, sizeof localiser->covariance);
    localiser->covariance[0][0] = square(distance);
    localiser->covariance[1][1] = square(distance);
    localiser->covariance[2][2] = square(turn);
    localiser->pose = *pose;
    localiser->pose.heading = jp_plane_wrap(pose->heading);
    localiser->internal.rival_distance = 0.0f;
    localiser->internal.rival_turn = 0.0f;
    report_deviations(localiser);
}

/* The heading's error moves the position across the way. */
static void carry(float covariance[3][3], float dx, float dy)
{
    for (int i = 0; i < 3; i++) {
        covariance[0][i] -= dy * covariance[2][i];
        covariance[1][i] += dx * covariance[2][i];
    }
    for (int i = 0; i < 3; i++) {
        covariance[i][0] -= dy * covariance[i][2];
        covariance[i][1] += dx * covariance[i][2];
    }
}

/* Errors that keep their sign add up as standard deviations do, by `more` in every direction: P becomes
 * (√P + more I)². */
static void widen_position(float covariance[3][3], float more)
{
    const float xx = covariance[0][0];
    const float xy = covariance[0][1];
    const float yy = covariance[1][1];
    const float root = jp_plane_square_root(jp_plane_larger(xx * yy - xy * xy, 0.0f));
    const float share = 2.0f * more / jp_plane_square_root(xx + yy + 2.0f * root);

    covariance[0][0] += share * (xx + root) + square(more);
    covariance[0][1] += share * xy;
    covariance[1][0] += share * xy;
    covariance[1][1] += share * (yy + root) + square(more);
}

static void predict(struct jp_localiser *localiser, const struct jp_plane_pose *motion)
{
    const struct jp_localiser_drift *const drift = &localiser->config.wheels;
    const struct jp_plane_pose before = localiser->pose;
    const float way = jp_plane_length(motion->x, motion->y);
    const float turn = drift->turn * jp_plane_magnitude(motion->heading) + drift->deviation * way;

    localiser->pose = jp_plane_compose(&before, motion);
    carry(localiser->covariance, localiser->pose.x - before.x, localiser->pose.y - before.y);
    widen_position(localiser->covariance, drift->distance * way);
    localiser->covariance[2][2] = square(jp_plane_square_root(localiser->covariance[2][2]) + turn);
    for (int i = 0; i < 3; i++) {
        localiser->covariance[i][i] += square(DEVIATION_MIN);
    }
    report_deviations(localiser);
}

/* Nothing moves so far in a cycle: the robot may be anywhere on that way. */
static void distrust(struct jp_localiser *localiser, float way, float turn)
{
    widen_position(localiser->covariance, way);
    localiser->covariance[2][2] = square(jp_plane_square_root(localiser->covariance[2][2]) + turn);
    localiser->internal.has_jumped = true;
    report_deviations(localiser);
}

static void move(struct jp_localiser *localiser, const struct jp_plane_pose *motion)
{
    const float way = jp_plane_length(motion->x, motion->y);
    const float turn = jp_plane_magnitude(motion->heading);

    if (jp_plane_larger(way, turn) > JP_LOCALISER_MOTION_MAX) {
        distrust(localiser, way, turn);
    } else {
        predict(localiser, motion);
        localiser->internal.since = jp_plane_compose(&localiser->internal.since, motion);
    }
}

static void follow_wheels(struct jp_localiser *localiser, const struct jp_plane_pose *wheels)
{
    struct jp_localiser_internal *const self = &localiser->internal;

    if (self->has_wheels) {
        const struct jp_plane_pose motion = jp_plane_relative(&self->wheels, wheels);

        move(localiser, &motion);
    }
    self->wheels = *wheels;
    self->has_wheels = true;
}

/* ---- The map ---- */

static float noise_of(const struct jp_localiser *localiser)
{
    return jp_plane_length(localiser->config.noise, ROUNDING * localiser->internal.field.cell);
}

/* How far ends of beams may be off by the uncertainty of the pose, m. */
static float spread_of(const struct jp_localiser *localiser)
{
    return 2.0f * position_deviation(localiser) + localiser->internal.reach * heading_deviation(localiser);
}

/* The spread, in gates of a match. */
static float wideness_of(const struct jp_localiser *localiser)
{
    return spread_of(localiser) / (SURE_SPREAD * noise_of(localiser));
}

static bool is_wide(const struct jp_localiser *localiser)
{
    return wideness_of(localiser) > 1.0f;
}

/* Of the ends that are compared with the map: all where the pose is not sure. */
static int32_t stride_of(const struct jp_localiser *localiser)
{
    return is_wide(localiser) ? 1 : STRIDE;
}

/* A match, and how the scan agrees with the map there. */
struct attempt {
    struct jp_localiser_fit fit;
    struct jp_localiser_view view;
    bool is_searched; /* it is the best of the places where the robot may be */
    bool is_alone;    /* it is the only one that a search found */
};

static void attempt(const struct jp_localiser *localiser, const struct jp_localiser_prior *prior,
                    struct attempt *attempt)
{
    const struct jp_localiser_internal *const self = &localiser->internal;

    jp_localiser_match(&self->field, &self->cloud, prior, &attempt->fit);
    jp_localiser_compare(&self->field, &self->cloud, stride_of(localiser), &attempt->fit.pose, prior->noise,
                         &attempt->view);
}

/* Beams that the map explains over those that contradict it. */
static int32_t score_of(const struct attempt *attempt)
{
    const struct jp_localiser_view *const view = &attempt->view;

    return (int32_t)view->explained - (int32_t)view->behind - (int32_t)view->beyond;
}

/* From the prediction, and from a place that a search found, within the region that it was to search: where the
 * prediction is a rival of it, such as along a plain wall before which something stands, the prediction stays. */
static void match(struct jp_localiser *localiser, struct jp_localiser_prior *prior, struct attempt *best)
{
    struct jp_localiser_internal *const self = &localiser->internal;

    attempt(localiser, prior, best);
    best->is_searched = self->has_place;
    if (self->has_place) {
        struct attempt other;

        prior->start = jp_plane_compose(&self->search.places[0].pose, &self->since);
        attempt(localiser, prior, &other);
        if (other.fit.surprise < square(REGION) &&
            (float)score_of(&other) > (float)score_of(best) + RIVAL * (float)other.view.beams) {
            best->fit = other.fit;
            best->view = other.view;
        }
        best->is_alone = jp_localiser_search_is_same(&best->fit.pose, &prior->start);
        self->has_place = false;
    } else {
        best->is_alone = false;
    }
}

/* More uncertain than is allowed. */
static bool is_far(const struct jp_localiser *localiser, float distance, float turn)
{
    return distance > localiser->config.lost_distance || turn > localiser->config.lost_turn;
}

static bool is_beyond(const struct jp_localiser *localiser)
{
    return is_far(localiser, position_deviation(localiser), heading_deviation(localiser));
}

/* The more uncertain the pose, the more of the beams the map must explain. */
static bool is_enough(const struct jp_localiser *localiser, const struct attempt *attempt)
{
    const float most = attempt->is_searched ? SEARCHED : UNSEARCHED;
    const float share = jp_plane_clamp(SHARE_STEP * (wideness_of(localiser) - 1.0f), 0.0f, most);

    return attempt->fit.inliers >= INLIERS_MIN && (float)score_of(attempt) >= share * (float)attempt->view.beams;
}

/* What the last scan tells of the pose, and whether it may be believed. */
static enum jp_localiser_reason judge(struct jp_localiser *localiser, struct attempt *best)
{
    struct jp_localiser_internal *const self = &localiser->internal;
    struct jp_localiser_prior prior = {.pose = localiser->pose, .start = localiser->pose, .noise = noise_of(localiser)};

    (void)memset(&localiser->view, 0, sizeof localiser->view);
    if (self->cloud.count < POINTS_MIN) {
        return JP_LOCALISER_NO_SCAN;
    }
    (void)jp_localiser_invert(localiser->covariance, prior.information);
    prior.weak = is_wide(localiser) ? WEAK : 0.0f;
    match(localiser, &prior, best);
    localiser->view = best->view;

    const float beams = (float)best->view.beams;

    if ((float)best->view.beyond > BEYOND_MAX * beams ||
        (float)best->view.beyond + (float)best->view.behind > THROUGH_MAX * beams) {
        return JP_LOCALISER_CONTRADICTED;
    }
    if (!is_enough(localiser, best)) {
        return JP_LOCALISER_UNEXPLAINED;
    }
    return best->fit.surprise > SURPRISE_MAX ? JP_LOCALISER_JUMPED : JP_LOCALISER_NONE;
}

static void drop_search(struct jp_localiser *localiser)
{
    localiser->internal.has_drifted = false;
    localiser->internal.has_searched = false;
    localiser->internal.is_near = true;
    localiser->internal.unexplained = 0;
    localiser->internal.doubts = 0;
    localiser->internal.has_place = false;
    localiser->internal.search.is_running = false;
    localiser->internal.waited = WAIT_SCANS;
}

/* A scan that leads a robot which may be far off to a place may lead it to one of several: things that the map does not
 * show may look like another one's walls. The place that is found alone from there again is the one. */
static void judge_rivals(struct jp_localiser *localiser, const struct attempt *best, float distance, float turn)
{
    struct jp_localiser_internal *const self = &localiser->internal;

    if (is_far(localiser, distance, turn) && !is_beyond(localiser)) {
        self->rival_distance = jp_plane_length(distance, self->rival_distance);
        self->rival_turn = jp_plane_length(turn, self->rival_turn);
    } else if (best->is_alone) {
        self->rival_distance = 0.0f;
        self->rival_turn = 0.0f;
    } else {
        /* As it was. */
    }
    report_deviations(localiser);
}

static void correct(struct jp_localiser *localiser, struct attempt *best)
{
    struct jp_localiser_fit *const fit = &best->fit;
    const struct jp_plane_pose *const before = &localiser->pose;
    const float way = jp_plane_length(fit->pose.x - before->x, fit->pose.y - before->y);
    const float turn = jp_plane_magnitude(jp_plane_wrap(fit->pose.heading - before->heading));
    const float distance = position_deviation(localiser);
    const float heading = heading_deviation(localiser);

    localiser->is_new_place = localiser->state == JP_LOCALISER_LOST || localiser->internal.has_jumped ||
                              jp_plane_larger(way, turn) > JP_LOCALISER_NEW_PLACE;
    localiser->pose = fit->pose;
    (void)jp_localiser_invert(fit->information, localiser->covariance);
    judge_rivals(localiser, best, distance, heading);
    localiser->internal.has_searched = false;
    localiser->counts.fits++;
    localiser->internal.has_jumped = false;
    localiser->internal.doubts = 0;
    localiser->internal.unexplained = 0;
    enter(localiser, JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
}

static void lose(struct jp_localiser *localiser, enum jp_localiser_reason reason)
{
    localiser->counts.losses++;
    drop_search(localiser);
    enter(localiser, JP_LOCALISER_LOST, reason);
}

/* Nothing is to be seen around it, by the map and by most of the beams: standing still would not tell where it is. */
static bool is_in_the_open(const struct jp_localiser_view *view)
{
    return (float)view->open > OPEN * ((float)view->beams + (float)view->empty);
}

/* Where there are walls to find itself by, and it has not searched where it may be. */
static bool is_uncertain(const struct jp_localiser *localiser)
{
    const struct jp_localiser_internal *const self = &localiser->internal;

    return is_beyond(localiser) && !is_in_the_open(&localiser->view) &&
           !(self->has_searched && self->cloud.count >= SEARCH_POINTS_MIN);
}

/* Whether next to nothing of a scan is on the map: where nothing is to be seen, seeing nothing is. */
static bool is_strange(const struct jp_localiser_view *view)
{
    const float explained = (float)view->explained - (float)view->behind + (float)view->open;

    return explained < STRANGE * ((float)view->beams + (float)view->empty);
}

static void look_beside(struct jp_localiser *localiser, const struct jp_localiser_input *input)
{
    const struct jp_localiser_internal *const self = &localiser->internal;

    jp_localiser_compare_empty(&self->field, input, localiser->config.range_max,
                               stride_of(localiser) * self->cloud.stride, &localiser->pose, &localiser->view);
}

static void doubt(struct jp_localiser *localiser, enum jp_localiser_reason reason,
                  const struct jp_localiser_input *input)
{
    if (reason == JP_LOCALISER_CONTRADICTED || reason == JP_LOCALISER_JUMPED) {
        localiser->internal.doubts++;
    }
    if (input->scan.ranges != NULL) {
        look_beside(localiser, input);
    }
    if (is_strange(&localiser->view)) {
        localiser->internal.unexplained++;
    }
    if (localiser->internal.doubts >= DOUBTS_MAX || localiser->internal.unexplained >= UNEXPLAINED_MAX) {
        lose(localiser, reason);
    } else if (is_uncertain(localiser)) {
        lose(localiser, JP_LOCALISER_UNCERTAIN);
        localiser->internal.has_drifted = true;
    } else {
        enter(localiser, JP_LOCALISER_DEGRADED, reason);
    }
}

/* ---- Searches ---- */

static bool is_search_due(const struct jp_localiser *localiser)
{
    const struct jp_localiser_internal *const self = &localiser->internal;
    const bool is_elsewhere =
        jp_plane_length(self->since.x, self->since.y) > WAIT_WAY || jp_plane_magnitude(self->since.heading) > WAIT_TURN;

    return !self->search.is_running && self->cloud.count >= SEARCH_POINTS_MIN &&
           (self->waited >= WAIT_SCANS || is_elsewhere);
}

static void search(struct jp_localiser *localiser, const struct jp_localiser_region *region)
{
    jp_localiser_search_begin(&localiser->internal.search, &localiser->internal.cloud, region);
    localiser->internal.since = (struct jp_plane_pose){0.0f, 0.0f, 0.0f};
    localiser->internal.waited = 0;
    localiser->counts.searches++;
}

/* Where the robot may be. */
static void search_around(struct jp_localiser *localiser)
{
    const struct jp_localiser_region around = {.centre = localiser->pose,
                                               .distance = REGION * localiser->position_deviation,
                                               .turn = REGION * localiser->heading_deviation};

    search(localiser, &around);
}

/* At first where the robot was last, then the whole map. */
static void search_lost(struct jp_localiser *localiser)
{
    static const struct jp_localiser_region everywhere = {
        .centre = {0.0f, 0.0f, 0.0f}, .distance = JP_PLANE_MAX, .turn = JP_PLANE_PI};

    if (localiser->internal.is_near) {
        search_around(localiser);
        localiser->internal.waited = WAIT_SCANS;
    } else {
        search(localiser, &everywhere);
    }
    localiser->internal.is_near = !localiser->internal.is_near;
    enter(localiser, JP_LOCALISER_LOST, JP_LOCALISER_SEARCHING);
}

static void track(struct jp_localiser *localiser, const struct jp_localiser_input *input)
{
    struct attempt best;
    const enum jp_localiser_reason reason = judge(localiser, &best);

    if (reason == JP_LOCALISER_NONE) {
        correct(localiser, &best);
    } else {
        doubt(localiser, reason, input);
    }
    if (localiser->state != JP_LOCALISER_LOST && (is_wide(localiser) || has_rivals(localiser)) &&
        is_search_due(localiser)) {
        search_around(localiser);
    }
}

/* The place that was found, and the next scan must fit there. */
static void confirm(struct jp_localiser *localiser)
{
    const struct jp_plane_pose pose =
        jp_plane_compose(&localiser->internal.search.places[0].pose, &localiser->internal.since);
    struct attempt best;

    set_pose(localiser, &pose, FOUND_DISTANCE, FOUND_TURN);
    if (judge(localiser, &best) == JP_LOCALISER_NONE) {
        correct(localiser, &best);
    } else {
        enter(localiser, JP_LOCALISER_LOST, JP_LOCALISER_NOWHERE);
    }
}

static void look_for_place(struct jp_localiser *localiser)
{
    if (localiser->internal.has_place) {
        confirm(localiser);
    } else if (is_search_due(localiser)) {
        search_lost(localiser);
    } else {
        /* jp_localiser_work() goes on with it, or there is nothing to see. */
    }
}

static enum jp_localiser_reason reason_of(enum jp_localiser_finding finding)
{
    switch (finding) {
    case JP_LOCALISER_NO_PLACE:
        return JP_LOCALISER_NOWHERE;
    case JP_LOCALISER_MANY_PLACES:
        return JP_LOCALISER_AMBIGUOUS;
    case JP_LOCALISER_ONE_PLACE:
    default:
        return JP_LOCALISER_SEARCHING; /* the next scan may confirm it */
    }
}

/* Who has drifted goes on, with the place that was found where there is one. */
static void end_search(struct jp_localiser *localiser)
{
    struct jp_localiser_internal *const self = &localiser->internal;
    const enum jp_localiser_finding finding = jp_localiser_search_finding(&self->search);

    self->has_place = finding == JP_LOCALISER_ONE_PLACE;
    self->has_searched = true;
    if (localiser->state == JP_LOCALISER_LOST) {
        enter(localiser, self->has_drifted ? JP_LOCALISER_DEGRADED : JP_LOCALISER_LOST, reason_of(finding));
    }
}

bool jp_localiser_work(struct jp_localiser *localiser, unsigned nodes)
{
    struct jp_localiser_search *const running = &localiser->internal.search;

    if (!running->is_running) {
        return false;
    }
    localiser->counts.nodes += jp_localiser_search_work(running, &localiser->internal.field, localiser->config.map,
                                                        noise_of(localiser), nodes);
    if (!running->is_running) {
        end_search(localiser);
    }
    return running->is_running;
}

/* ---- A cycle ---- */

static bool is_input_sound(const struct jp_localiser_input *input)
{
    return jp_plane_is_pose(&input->wheels) && jp_plane_is_pose(&input->sensor) &&
           (input->scan.ranges == NULL || jp_scan_is_sound(&input->scan));
}

static void look(struct jp_localiser *localiser, const struct jp_localiser_input *input)
{
    struct jp_localiser_cloud *const cloud = &localiser->internal.cloud;
    float squares = 0.0f;

    cloud->count = 0;
    if (input->scan.ranges != NULL) {
        jp_localiser_collect(cloud, JP_LOCALISER_POINTS_MAX, &input->scan, &input->sensor, localiser->config.range_max);
        localiser->counts.scans++;
    }
    for (int32_t i = 0; i < cloud->count; i++) {
        squares += square(cloud->points[i].x) + square(cloud->points[i].y);
    }
    localiser->internal.reach = jp_plane_square_root(squares / jp_plane_larger((float)cloud->count, 1.0f));
}

enum jp_status jp_localiser_update(struct jp_localiser *localiser, const struct jp_localiser_input *input)
{
    if (localiser == NULL || input == NULL || !is_input_sound(input)) {
        return JP_ERR_ARGUMENT;
    }
    localiser->is_new_place = false;
    follow_wheels(localiser, &input->wheels);
    look(localiser, input);
    localiser->internal.waited = jp_one_more16(localiser->internal.waited);
    if (localiser->state == JP_LOCALISER_LOST) {
        look_for_place(localiser);
    } else {
        track(localiser, input);
    }
    return JP_OK;
}

enum jp_status jp_localiser_start(struct jp_localiser *localiser, const struct jp_plane_pose *pose)
{
    static const struct jp_plane_pose origin = {0.0f, 0.0f, 0.0f};

    if (localiser == NULL || (pose != NULL && !jp_plane_is_pose(pose))) {
        return JP_ERR_ARGUMENT;
    }
    set_pose(localiser, pose != NULL ? pose : &origin, localiser->config.start_distance, localiser->config.start_turn);
    drop_search(localiser);
    localiser->internal.is_near = pose != NULL;
    enter(localiser, pose != NULL ? JP_LOCALISER_DEGRADED : JP_LOCALISER_LOST, JP_LOCALISER_NO_SCAN);
    return JP_OK;
}

/* ---- Preparation ---- */

/* Where the parts of the block begin. */
struct localiser_layout {
    size_t field;
    size_t column;
    size_t end;
};

static bool is_map(const struct jp_terrain *map)
{
    return map != NULL && map->config.width > 0U && map->config.height > 0U && map->config.resolution > 0 &&
           map->config.width <= JP_TERRAIN_SIDE_MAX && map->config.height <= JP_TERRAIN_SIDE_MAX;
}

static struct localiser_layout lay_out(const struct jp_localiser_config *config)
{
    const struct jp_terrain_config *const map = &config->map->config;
    struct localiser_layout layout = {.field = jp_block_align(JP_LOCALISER_POINTS_MAX * sizeof(struct jp_plane_point))};

    layout.column = layout.field + (size_t)map->width * map->height;
    layout.end = layout.column + map->height;
    return layout;
}

size_t jp_localiser_size(const struct jp_localiser_config *config)
{
    return config != NULL && is_map(config->map) ? lay_out(config).end : 0U;
}

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_localiser_config, member, low, high)

static enum jp_status check(const struct jp_localiser_config *config, const char **field)
{
    static const struct jp_config_float_field fields[] = {
        FIELD(range_max, 0.001f, 1000.0f),     FIELD(noise, 0.001f, 1.0f),
        FIELD(wheels.distance, 0.001f, 1.0f),  FIELD(wheels.turn, 0.001f, 1.0f),
        FIELD(wheels.deviation, 0.001f, 1.0f), FIELD(start_distance, 0.001f, 10.0f),
        FIELD(start_turn, 0.001f, 1.0f),       FIELD(lost_distance, 0.01f, 10.0f),
        FIELD(lost_turn, 0.01f, 1.0f),
    };

    return is_map(config->map) ? jp_config_float_check(config, fields, JP_CONFIG_COUNT(fields), field)
                               : jp_config_refuse("map", field);
}

enum jp_status jp_localiser_init(struct jp_localiser *localiser, const struct jp_localiser_config *config, void *block,
                                 size_t size, const char **field)
{
    if (localiser == NULL || config == NULL || block == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = check(config, field);

    if (status != JP_OK) {
        return status;
    }
    if (!jp_block_is_aligned(block)) {
        return JP_ERR_ALIGNMENT;
    }

    const struct localiser_layout layout = lay_out(config);
    const struct jp_terrain_config *const map = &config->map->config;
    uint8_t *const bytes = block;

    if (size < layout.end) {
        return JP_ERR_MEMORY;
    }
    (void)memset(localiser, 0, sizeof *localiser);
    localiser->config = *config;
    localiser->internal.cloud.points = block;
    localiser->internal.field =
        (struct jp_wall_field){(int8_t *)&bytes[layout.field], (int32_t)map->width, (int32_t)map->height,
                               (float)map->resolution / (float)JP_Q16_ONE};
    jp_wall_field_make(&localiser->internal.field, config->map, (int8_t *)&bytes[layout.column]);
    return jp_localiser_start(localiser, NULL);
}
