#include "src/local/localiser_match.h"

#include <string.h>

#include "src/base/plane.h"
#include "src/local/eigen.h"
#include "src/local/localiser_matrix.h"
#include "src/local/wall_field.h"

/* Beams side by side see the same piece of a wall, whose error on the map is theirs: so many count as one. */
#define ALIKE 8.0f

/* A beam comes from the side of a wall to which it is open: the cosine of its angle with the normal is below this. */
#define FACING 0.2f

/* An end this many standard deviations from a wall has half of its influence; nearer, it is an inlier. */
#define INFLUENCE 3.0f

/* The influence begins as wide as the spread, and narrows by this factor in each iteration. */
#define NARROWER 0.6f

#define ITERATIONS_MAX 14
#define STEP_END       5.0e-4f /* m and rad */

/* An end this near to a wall, standard deviations of its noise, is explained by it; a beam that goes on so far behind
 * one, cells, passed through it. */
#define EXPLAINED 4.0f
#define BEHIND    3.0f

/* ---- Scans ---- */

static bool has_hit(float range, float range_max)
{
    return range > 0.0f && range <= range_max;
}

static int32_t hits_of(const struct jp_scan *scan, float range_max)
{
    int32_t hits = 0;

    for (uint16_t i = 0; i < scan->count; i++) {
        hits += has_hit(scan->ranges[i], range_max) ? 1 : 0;
    }
    return hits;
}

void jp_localiser_collect(struct jp_localiser_cloud *cloud, int32_t points_max, const struct jp_scan *scan,
                          const struct jp_plane_pose *sensor, float range_max)
{
    const int32_t seen = hits_of(scan, range_max);
    const int32_t stride = seen > 0 ? (seen + points_max - 1) / points_max : 1;
    int32_t hits = 0;

    cloud->count = 0;
    cloud->stride = stride;
    cloud->sensor = (struct jp_plane_point){sensor->x, sensor->y};
    for (uint16_t i = 0; i < scan->count; i++) {
        const float range = scan->ranges[i];

        if (has_hit(range, range_max)) {
            if (hits % stride == 0) {
                const float bearing = sensor->heading + (scan->first_angle + (float)i * scan->angle_step);
                const struct jp_plane_point along = jp_plane_direction(bearing);

                cloud->points[cloud->count] =
                    (struct jp_plane_point){sensor->x + range * along.x, sensor->y + range * along.y};
                cloud->count++;
            }
            hits++;
        }
    }
}

/* ---- Gauss–Newton ---- */

static struct jp_plane_point turned(struct jp_plane_point direction, struct jp_plane_point point)
{
    return (struct jp_plane_point){direction.x * point.x - direction.y * point.y,
                                   direction.y * point.x + direction.x * point.y};
}

/* Sums over the ends: information · step = gradient. */
struct localiser_sums {
    float information[3][3];
    float gradient[3];
    float inliers;
    float most; /* information that all of the ends would be in one direction */
};

static void add_end(struct localiser_sums *sums, const struct jp_wall_distance *wall, struct jp_plane_point arm,
                    float weight)
{
    const float row[3] = {wall->gradient.x, wall->gradient.y, wall->gradient.y * arm.x - wall->gradient.x * arm.y};

    for (int j = 0; j < 3; j++) {
        sums->gradient[j] -= weight * row[j] * wall->distance;
        for (int k = 0; k < 3; k++) {
            sums->information[j][k] += weight * row[j] * row[k];
        }
    }
}

/* Geman and McClure's weights, whose width is `scale`. */
static void sum_up(const struct jp_wall_field *field, const struct jp_localiser_cloud *cloud,
                   const struct jp_plane_pose *pose, float scale, float noise, struct localiser_sums *sums)
{
    const struct jp_plane_point direction = jp_plane_direction(pose->heading);
    const struct jp_plane_point sensor = turned(direction, cloud->sensor);
    const float unit = 1.0f / (ALIKE * noise * noise);

    (void)memset(sums, 0, sizeof *sums);
    for (int32_t i = 0; i < cloud->count; i++) {
        const struct jp_plane_point arm = turned(direction, cloud->points[i]);
        const struct jp_plane_point end = {pose->x + arm.x, pose->y + arm.y};
        const struct jp_plane_point beam = {arm.x - sensor.x, arm.y - sensor.y};
        struct jp_wall_distance wall;

        if (jp_wall_field_find(field, end, &wall) &&
            wall.gradient.x * beam.x + wall.gradient.y * beam.y < FACING * jp_plane_length(beam.x, beam.y)) {
            const float off = wall.distance / scale;
            const float share = 1.0f / (1.0f + off * off);

            add_end(sums, &wall, arm, unit * share * share);
            sums->most += unit * share * share;
            sums->inliers += jp_plane_magnitude(wall.distance) < INFLUENCE * noise ? 1.0f : 0.0f;
        }
    }
}

static void take_out(struct localiser_sums *sums, const float vector[3], float value)
{
    const float along = vector[0] * sums->gradient[0] + vector[1] * sums->gradient[1] + vector[2] * sums->gradient[2];

    for (int j = 0; j < 3; j++) {
        sums->gradient[j] -= along * vector[j];
        for (int k = 0; k < 3; k++) {
            sums->information[j][k] -= value * vector[j] * vector[k];
        }
    }
}

/* Takes out what the ends say in the directions that few of them determine. */
static void leave_weak(struct localiser_sums *sums, float weak)
{
    struct jp_eigen eigen;

    jp_eigen_find(sums->information, &eigen);
    for (int i = 0; i < 3; i++) {
        if (eigen.values[i] < weak * sums->most) {
            take_out(sums, eigen.vectors[i], eigen.values[i]);
        }
    }
}

static void away_from(const struct jp_plane_pose *prior, const struct jp_plane_pose *pose, float away[3])
{
    away[0] = pose->x - prior->x;
    away[1] = pose->y - prior->y;
    away[2] = jp_plane_wrap(pose->heading - prior->heading);
}

/* A step towards the most probable pose; its length, m or rad, or one that has no end without a solution. */
static float step(const struct jp_localiser_prior *prior, struct localiser_sums *sums, struct jp_localiser_fit *fit)
{
    struct jp_localiser_prior known = *prior;
    float covariance[3][3];
    float away[3];
    float pull[3];
    float way[3];

    away_from(&prior->pose, &fit->pose, away);
    jp_localiser_multiply(known.information, away, pull);
    for (int i = 0; i < 3; i++) {
        sums->gradient[i] -= pull[i];
        for (int j = 0; j < 3; j++) {
            fit->information[i][j] = sums->information[i][j] + prior->information[i][j];
        }
    }
    if (!jp_localiser_invert(fit->information, covariance)) {
        return FLT_MAX;
    }
    jp_localiser_multiply(covariance, sums->gradient, way);
    fit->pose.x += way[0];
    fit->pose.y += way[1];
    fit->pose.heading = jp_plane_wrap(fit->pose.heading + jp_plane_clamp(way[2], -1.0f, 1.0f));
    return jp_plane_larger(jp_plane_length(way[0], way[1]), jp_plane_magnitude(way[2]));
}

static float surprise_of(const struct jp_localiser_prior *prior, const struct jp_plane_pose *pose)
{
    struct jp_localiser_prior known = *prior;
    float away[3];
    float pull[3];

    away_from(&prior->pose, pose, away);
    jp_localiser_multiply(known.information, away, pull);
    return away[0] * pull[0] + away[1] * pull[1] + away[2] * pull[2];
}

void jp_localiser_match(const struct jp_wall_field *field, const struct jp_localiser_cloud *cloud,
                        const struct jp_localiser_prior *prior, struct jp_localiser_fit *fit)
{
    const float narrowest = INFLUENCE * prior->noise;
    float scale = jp_plane_larger(prior->spread, narrowest);
    float size = FLT_MAX;
    bool is_narrow = false;
    struct localiser_sums sums;

    (void)memset(fit, 0, sizeof *fit);
    fit->pose = prior->start;
    for (int i = 0; i < ITERATIONS_MAX && !(is_narrow && size < STEP_END); i++) {
        is_narrow = !(scale > narrowest);
        sum_up(field, cloud, &fit->pose, scale, prior->noise, &sums);
        if (prior->weak > 0.0f) {
            leave_weak(&sums, prior->weak);
        }
        size = step(prior, &sums, fit);
        scale = jp_plane_larger(NARROWER * scale, narrowest);
        if (size > JP_PLANE_MAX) {
            return;
        }
    }
    fit->inliers = sums.inliers / jp_plane_larger((float)cloud->count, 1.0f);
    fit->surprise = surprise_of(prior, &fit->pose);
}

/* ---- What the map says of the beams ---- */

static void compare_beam(const struct jp_wall_field *field, struct jp_plane_point from, struct jp_plane_point end,
                         float noise, struct jp_localiser_view *view)
{
    const struct jp_plane_point beam = {end.x - from.x, end.y - from.y};
    const float range = jp_plane_length(beam.x, beam.y);
    const float inverse = range > JP_PLANE_SHORT ? 1.0f / range : 0.0f;
    const struct jp_plane_point along = {beam.x * inverse, beam.y * inverse};

    const bool is_through = jp_wall_field_ray(field, from, along, range) < range - BEHIND * field->cell;

    struct jp_wall_distance wall;

    (void)jp_wall_field_find(field, end, &wall);

    const bool is_at_wall = jp_plane_magnitude(wall.distance) < EXPLAINED * noise;

    view->beams++;
    if (is_at_wall && !is_through) {
        view->explained++;
    } else if (is_at_wall) {
        view->behind++;
    } else if (is_through) {
        view->beyond++;
    } else {
        /* Something stands before the wall. */
    }
}

void jp_localiser_compare(const struct jp_wall_field *field, const struct jp_localiser_cloud *cloud, int32_t stride,
                          const struct jp_plane_pose *pose, float noise, struct jp_localiser_view *view)
{
    const struct jp_plane_point direction = jp_plane_direction(pose->heading);
    const struct jp_plane_point sensor = turned(direction, cloud->sensor);
    const struct jp_plane_point from = {pose->x + sensor.x, pose->y + sensor.y};

    (void)memset(view, 0, sizeof *view);
    for (int32_t i = 0; i < cloud->count; i += stride) {
        const struct jp_plane_point arm = turned(direction, cloud->points[i]);

        compare_beam(field, from, (struct jp_plane_point){pose->x + arm.x, pose->y + arm.y}, noise, view);
    }
}

static bool is_empty(float range, float range_max)
{
    return jp_plane_is_between(range, 0.0f, FLT_MAX) && !has_hit(range, range_max);
}

void jp_localiser_compare_empty(const struct jp_wall_field *field, const struct jp_localiser_input *input,
                                float range_max, int32_t stride, const struct jp_plane_pose *pose,
                                struct jp_localiser_view *view)
{
    const struct jp_plane_pose scanner = jp_plane_compose(pose, &input->sensor);
    const struct jp_plane_point from = {scanner.x, scanner.y};
    int32_t found = 0;

    for (uint16_t i = 0; i < input->scan.count; i++) {
        if (is_empty(input->scan.ranges[i], range_max)) {
            if (found % stride == 0) {
                const float bearing = scanner.heading + (input->scan.first_angle + (float)i * input->scan.angle_step);

                view->empty++;
                if (!(jp_wall_field_ray(field, from, jp_plane_direction(bearing), range_max) < range_max)) {
                    view->open++;
                }
            }
            found++;
        }
    }
}
