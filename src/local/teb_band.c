#include "src/local/teb_band.h"

#include "src/base/plane.h"
#include "src/local/obstacle_distance.h"

/* How far beyond the clearance an obstacle may be to act within a round, m. */
#define REACH 0.3f

/* The band of the last cycle is dropped when the task has moved farther than this from it, m and rad. */
#define BAND_JUMP      0.5f
#define GOAL_JUMP      1.0f
#define GOAL_TURN_JUMP 1.0f

/* Beyond this time the uncertainty of a moving obstacle grows no further, s. */
#define MARGIN_TIME 1.0f

/* Poses that may have been passed since the last cycle. */
#define PASSED_MAX 10U

/* Of the first step that is left or added when it begins somewhere else. */
#define LENGTH_SHARE_MIN 0.1f
#define LENGTH_SHARE_MAX 2.0f

/* Of a distance whose nearest feature must be searched for, and of an overlap: times that of one where it stays. */
#define SEARCH_WORK  2U
#define OVERLAP_WORK 3U

/* Changes of one interval in a pass. */
#define SPLITS_MAX 3U

static struct jp_plane_point path_point(const struct jp_teb *teb, unsigned i)
{
    const struct jp_point *const point = &teb->internal.task.path[i];

    return (struct jp_plane_point){(float)point->x * (1.0f / (float)JP_Q16_ONE),
                                   (float)point->y * (1.0f / (float)JP_Q16_ONE)};
}

static float pose_distance(const struct jp_plane_pose *a, const struct jp_plane_pose *b)
{
    return jp_plane_length(b->x - a->x, b->y - a->y);
}

void jp_teb_set_pose(struct jp_teb_pose *pose, const struct jp_plane_pose *to)
{
    pose->pose = *to;
    pose->cosine = jp_plane_cosine(to->heading);
    pose->sine = jp_plane_sine(to->heading);
}

/* ---- From the path ---- */

/* Where on the path something is: on the chord after `point`, `along` of it, 0…1. */
struct chord_place {
    unsigned point;
    float along;
};

/* Nearest point of the chord after `i` to a position. */
static float chord_distance(const struct jp_teb *teb, unsigned i, const struct jp_plane_pose *pose, float *along)
{
    const struct jp_plane_point a = path_point(teb, i);
    const struct jp_plane_point b = path_point(teb, i + 1U);
    const float dx = b.x - a.x;
    const float dy = b.y - a.y;
    const float square = dx * dx + dy * dy;
    const float share = square > 0.0f ? ((pose->x - a.x) * dx + (pose->y - a.y) * dy) / square : 0.0f;

    *along = jp_plane_clamp(share, 0.0f, 1.0f);
    return jp_plane_length(a.x + *along * dx - pose->x, a.y + *along * dy - pose->y);
}

/* The nearest place from `from` on, as far as the path gets nearer. */
static struct chord_place nearest_place(const struct jp_teb *teb, unsigned from, const struct jp_plane_pose *pose)
{
    struct chord_place place = {from, 0.0f};
    float best = chord_distance(teb, from, pose, &place.along);

    for (unsigned i = from + 1U; i + 1U < teb->internal.task.path_count; i++) {
        float along;
        const float next = chord_distance(teb, i, pose, &along);

        if (next > best) {
            break;
        }
        best = next;
        place = (struct chord_place){i, along};
    }
    return place;
}

static float chord_length(const struct jp_teb *teb, unsigned i)
{
    const struct jp_plane_point a = path_point(teb, i);
    const struct jp_plane_point b = path_point(teb, i + 1U);

    return jp_plane_length(b.x - a.x, b.y - a.y);
}

/* Advances along the path, at most to its end. */
static void advance(const struct jp_teb *teb, struct chord_place *place, float length)
{
    float rest = length;

    for (;;) {
        const float chord = chord_length(teb, place->point);
        const float left = (1.0f - place->along) * chord;

        if (rest <= left && chord > 0.0f) {
            place->along += rest / chord;
            return;
        }
        if (place->point + 2U >= teb->internal.task.path_count) {
            place->along = 1.0f;
            return;
        }
        rest -= left;
        place->point++;
        place->along = 0.0f;
    }
}

static float rest_length(const struct jp_teb *teb, const struct chord_place *place)
{
    float length = (1.0f - place->along) * chord_length(teb, place->point);

    for (unsigned i = place->point + 1U; i + 1U < teb->internal.task.path_count; i++) {
        length += chord_length(teb, i);
    }
    return length;
}

static struct jp_plane_pose pose_at(const struct jp_teb *teb, const struct chord_place *place)
{
    const struct jp_plane_point a = path_point(teb, place->point);
    const struct jp_plane_point b = path_point(teb, place->point + 1U);

    return (struct jp_plane_pose){a.x + place->along * (b.x - a.x), a.y + place->along * (b.y - a.y),
                                  jp_plane_bearing(b.x - a.x, b.y - a.y)};
}

/* Time that the robot needs at least from one pose to the next. */
static float least_interval(const struct jp_teb_config *config, const struct jp_plane_pose *from,
                            const struct jp_plane_pose *to)
{
    const float translation = pose_distance(from, to) / config->speed_max;
    const float angle = jp_plane_wrap(to->heading - from->heading);
    const float turn = jp_plane_magnitude(angle) / config->turn_rate_max;
    const float longer = translation > turn ? translation : turn;
    const float least = config->interval - config->hysteresis;

    return longer > least ? longer : least;
}

/* The goal, along the path there if any heading will do. */
static struct jp_plane_pose goal_of(const struct jp_teb *teb, const struct chord_place *end)
{
    struct jp_plane_pose goal = teb->internal.task.goal;

    if (teb->internal.task.is_heading_free) {
        goal.heading = pose_at(teb, end).heading;
    }
    return goal;
}

static void lay_along_path(struct jp_teb *teb)
{
    const struct jp_teb_config *const config = &teb->config;
    struct chord_place place = nearest_place(teb, 0, &teb->internal.task.start);
    const float length = rest_length(teb, &place);
    const float steps = length / (config->speed_max * config->interval) + 1.0f;
    const unsigned count = steps < (float)JP_TEB_POSES_MIN         ? (unsigned)JP_TEB_POSES_MIN
                           : steps < (float)(JP_TEB_POSES_MAX - 1) ? (unsigned)steps + 1U
                                                                   : (unsigned)JP_TEB_POSES_MAX;
    const float spacing = length / (float)(count - 1U);

    teb->count = (uint8_t)count;
    jp_teb_set_pose(&teb->poses[0], &teb->internal.task.start);
    for (unsigned i = 1; i < count; i++) {
        advance(teb, &place, spacing);

        const struct jp_plane_pose pose = i + 1U < count ? pose_at(teb, &place) : goal_of(teb, &place);

        jp_teb_set_pose(&teb->poses[i], &pose);
        teb->poses[i - 1U].interval = least_interval(config, &teb->poses[i - 1U].pose, &pose);
    }
}

/* ---- From the last cycle ---- */

static void remove_poses(struct jp_teb *teb, unsigned first, unsigned count)
{
    for (unsigned i = first; i + count < teb->count; i++) {
        teb->poses[i] = teb->poses[i + count];
    }
    teb->count = (uint8_t)(teb->count - count);
}

/* Number of poses that the robot has passed: those before the nearest one. */
static unsigned passed_poses(const struct jp_teb *teb)
{
    unsigned nearest = 0;

    for (unsigned i = 1; i < PASSED_MAX && i + JP_TEB_POSES_MIN <= teb->count; i++) {
        if (pose_distance(&teb->poses[i].pose, &teb->internal.task.start) <=
            pose_distance(&teb->poses[nearest].pose, &teb->internal.task.start)) {
            nearest = i;
        }
    }
    return nearest;
}

static bool fits_task(const struct jp_teb *teb)
{
    const struct jp_plane_pose *const last = &teb->poses[teb->count - 1U].pose;
    const float turn = jp_plane_wrap(teb->internal.task.goal.heading - last->heading);

    return pose_distance(last, &teb->internal.task.goal) < GOAL_JUMP &&
           (teb->internal.task.is_heading_free || jp_plane_magnitude(turn) < GOAL_TURN_JUMP) &&
           pose_distance(&teb->poses[passed_poses(teb)].pose, &teb->internal.task.start) < BAND_JUMP;
}

/* Moves the first pose to the start. The speed to the second stays as it was. */
static void start_from_task(struct jp_teb *teb)
{
    const struct jp_footprint *const footprint = &teb->config.footprint;
    const struct jp_plane_pose *const second = &teb->poses[1].pose;
    const float before = jp_teb_sweep(footprint, &teb->poses[0].pose, second);
    const float now = jp_teb_sweep(footprint, &teb->internal.task.start, second);

    if (before > 0.0f) {
        teb->poses[0].interval *= jp_plane_clamp(now / before, LENGTH_SHARE_MIN, LENGTH_SHARE_MAX);
    }
    jp_teb_set_pose(&teb->poses[0], &teb->internal.task.start);
}

static void cut_to_task(struct jp_teb *teb)
{
    const unsigned last = teb->count - 1U;
    struct jp_plane_pose goal = teb->internal.task.goal;
    const float more = pose_distance(&teb->poses[last].pose, &goal) / teb->config.speed_max;

    if (teb->internal.task.is_heading_free) {
        goal.heading = teb->poses[last].pose.heading;
    }
    teb->poses[last - 1U].interval += more;
    jp_teb_set_pose(&teb->poses[last], &goal);

    remove_poses(teb, 0, passed_poses(teb));
    start_from_task(teb);
}

void jp_teb_fit_band(struct jp_teb *teb)
{
    if (teb->count > 0U && fits_task(teb)) {
        cut_to_task(teb);
    } else {
        lay_along_path(teb);
    }
}

/* ---- More or fewer poses ---- */

static void insert_pose(struct jp_teb *teb, unsigned after)
{
    for (unsigned i = teb->count; i > after + 1U; i--) {
        teb->poses[i] = teb->poses[i - 1U];
    }
    teb->count++;

    struct jp_teb_pose *const from = &teb->poses[after];
    const struct jp_plane_pose *const a = &from->pose;
    const struct jp_plane_pose *const b = &teb->poses[after + 2U].pose;
    const struct jp_plane_pose middle = {0.5f * (a->x + b->x), 0.5f * (a->y + b->y),
                                         jp_plane_wrap(a->heading + 0.5f * jp_plane_wrap(b->heading - a->heading))};

    jp_teb_set_pose(&teb->poses[after + 1U], &middle);
    from->interval *= 0.5f;
    teb->poses[after + 1U].interval = from->interval;
}

static void split(struct jp_teb *teb, unsigned i)
{
    const float longest = teb->config.interval + teb->config.hysteresis;

    for (unsigned k = 0; k < SPLITS_MAX && teb->poses[i].interval > longest && teb->count < JP_TEB_POSES_MAX; k++) {
        insert_pose(teb, i);
    }
}

static void join(struct jp_teb *teb, unsigned i)
{
    const float shortest = teb->config.interval - teb->config.hysteresis;

    while (teb->poses[i].interval < shortest && teb->count > JP_TEB_POSES_MIN && i + 2U < teb->count) {
        teb->poses[i].interval += teb->poses[i + 1U].interval;
        remove_poses(teb, i + 1U, 1U);
    }
}

void jp_teb_resize(struct jp_teb *teb)
{
    for (unsigned i = 0; i + 1U < teb->count; i++) {
        join(teb, i);
        split(teb, i);
    }
}

/* ---- What is near ---- */

float jp_teb_sweep(const struct jp_footprint *footprint, const struct jp_plane_pose *a, const struct jp_plane_pose *b)
{
    const float longer = jp_plane_larger(footprint->front, footprint->rear);
    const float corner = jp_plane_length(longer, footprint->half_width);

    return pose_distance(a, b) + corner * jp_plane_magnitude(jp_plane_wrap(b->heading - a->heading));
}

float jp_teb_distance(struct jp_teb *teb, unsigned i, unsigned shape, float time, uint8_t *feature,
                      struct jp_plane_pose *gradient)
{
    const struct jp_teb_pose *const pose = &teb->poses[i];
    const struct jp_obstacle *const obstacle = &teb->internal.obstacles->shapes[shape];
    const struct jp_plane_pose meeting = {pose->pose.x - obstacle->velocity.x * time,
                                          pose->pose.y - obstacle->velocity.y * time, pose->pose.heading};
    const float margin = obstacle->margin * jp_plane_clamp(time, 0.0f, MARGIN_TIME);
    const uint8_t last = *feature;
    const float distance =
        jp_obstacle_distance_along(&teb->config.footprint, &meeting, (struct jp_plane_point){pose->cosine, pose->sine},
                                   obstacle, feature, gradient);

    teb->internal.work += *feature == JP_FEATURE_UNKNOWN ? OVERLAP_WORK : *feature == last ? 1U : SEARCH_WORK;
    return distance - margin;
}

/* A shape with its distance from a pose. */
struct neighbour {
    float distance;
    struct jp_plane_pose gradient;
    uint8_t shape;
    uint8_t feature;
};

/* In order; only the nearest few are kept. */
static void add_neighbour(struct jp_teb_neighbours *near, const struct neighbour *neighbour)
{
    unsigned k = near->count;

    if (k < JP_TEB_NEAR_MAX) {
        near->count++;
    } else if (neighbour->distance < near->distance[k - 1U]) {
        k--;
    } else {
        return;
    }
    for (; k > 0U && near->distance[k - 1U] > neighbour->distance; k--) {
        near->distance[k] = near->distance[k - 1U];
        near->gradient[k] = near->gradient[k - 1U];
        near->shape[k] = near->shape[k - 1U];
        near->feature[k] = near->feature[k - 1U];
    }
    near->distance[k] = neighbour->distance;
    near->gradient[k] = neighbour->gradient;
    near->shape[k] = neighbour->shape;
    near->feature[k] = neighbour->feature;
}

/* What is known of a shape from the last pose. */
struct outlook {
    float least;     /* m; no nearer than this: the exact distance of far shapes need not be computed */
    float speed;     /* at which it may come nearer while the robot stands, m/s */
    uint8_t feature; /* nearest */
};

static void find_obstacles(struct jp_teb *teb, unsigned i, struct outlook *outlooks)
{
    const float reach = teb->config.clearance + REACH;
    struct jp_teb_neighbours *const near = &teb->internal.near[i];

    near->count = 0;
    near->pose = teb->poses[i].pose;
    for (uint8_t shape = 0; shape < teb->internal.obstacles->count; shape++) {
        struct outlook *const outlook = &outlooks[shape];

        if (outlook->least < reach) {
            struct neighbour neighbour = {.shape = shape};

            outlook->least = jp_teb_distance(teb, i, shape, near->time, &outlook->feature, &neighbour.gradient);
            if (outlook->least < reach) {
                neighbour.distance = outlook->least;
                neighbour.feature = outlook->feature;
                add_neighbour(near, &neighbour);
            }
        }
    }
}

/* By the distance that the footprint moves, and by the way of the shapes. */
static void come_nearer(struct outlook *outlooks, unsigned count, float distance, float time)
{
    for (unsigned shape = 0; shape < count; shape++) {
        outlooks[shape].least -= distance + outlooks[shape].speed * time;
    }
}

static void start_outlooks(const struct jp_obstacles *obstacles, struct outlook *outlooks)
{
    for (unsigned i = 0; i < obstacles->count; i++) {
        const struct jp_obstacle *const shape = &obstacles->shapes[i];

        outlooks[i] = (struct outlook){0.0f, jp_plane_length(shape->velocity.x, shape->velocity.y) + shape->margin,
                                       JP_FEATURE_UNKNOWN};
    }
}

static void set_foot(struct jp_teb *teb, unsigned i, const struct chord_place *place)
{
    const struct jp_plane_point a = path_point(teb, place->point);
    const struct jp_plane_point b = path_point(teb, place->point + 1U);
    const float dx = b.x - a.x;
    const float dy = b.y - a.y;
    const float length = jp_plane_length(dx, dy);
    const float inverse = length > 0.0f ? 1.0f / length : 0.0f;

    teb->internal.feet[i].point = (struct jp_plane_point){a.x + place->along * dx, a.y + place->along * dy};
    teb->internal.feet[i].normal = (struct jp_plane_point){-dy * inverse, dx * inverse};
}

void jp_teb_find_feet(struct jp_teb *teb)
{
    unsigned point = 0;

    for (unsigned i = 0; i < teb->count; i++) {
        const struct chord_place place = nearest_place(teb, point, &teb->poses[i].pose);

        point = place.point;
        set_foot(teb, i, &place);
    }
}

void jp_teb_find_obstacles(struct jp_teb *teb)
{
    struct outlook outlooks[JP_OBSTACLES_MAX];
    float time = 0.0f;

    start_outlooks(teb->internal.obstacles, outlooks);
    for (unsigned i = 0; i < teb->count && teb->internal.work < JP_TEB_WORK_MAX; i++) {
        teb->internal.near[i].time = time;
        find_obstacles(teb, i, outlooks);
        if (i + 1U < teb->count) {
            const float interval = teb->poses[i].interval;

            time += interval;
            come_nearer(outlooks, teb->internal.obstacles->count,
                        jp_teb_sweep(&teb->config.footprint, &teb->poses[i].pose, &teb->poses[i + 1U].pose), interval);
        }
    }
}
