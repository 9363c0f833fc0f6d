#include "sim/four_wheel/laser.h"

#include <stdbool.h>

#include "sim/base/strict_math.h"

/* A beam's origin and unit direction. */
struct ray {
    struct planar_point from;
    struct planar_point along;
    struct planar_point inverse; /* of the direction's components */
};

struct laser_config laser_config_of(int beams, double field, double range_max, double noise)
{
    const bool around = field >= 2 * M_PI * (1 - 1e-9);
    const double step = around ? 2 * M_PI / beams : field / (beams - 1);

    return (struct laser_config){
        .beams = beams, .first = around ? -M_PI : -field / 2, .step = step, .range_max = range_max, .noise = noise};
}

static struct ray ray_of(struct planar_point from, double bearing)
{
    const struct strict_turn turn = strict_sin_cos(bearing);
    const struct planar_point along = {turn.cosine, turn.sine};

    return (struct ray){from, along, {1 / along.x, 1 / along.y}};
}

/* How far a coordinate runs until it leaves [low, high); infinity when it does not. */
static double way_out(double place, double along, double inverse, double low, double high)
{
    if (along == 0) {
        return INFINITY;
    }
    return ((along > 0 ? high : low) - place) * inverse;
}

/* The cell along one axis after a step, never back from `cell`: rounding at a corner must not send the ray to and fro.
 */
static int cell_after(int cell, double place, double along)
{
    const int next = (int)floor(place);

    return along > 0 ? (next > cell ? next : cell) : (next < cell ? next : cell);
}

/* Distance to the first solid cell in cells. Around a free cell the square that holds no solid one is crossed at once:
 * what is left of it is where the next solid cell may be. */
static double map_distance(const struct solid_map *map, const struct ray *ray, double limit)
{
    const double start_x = ray->from.x / map->cell;
    const double start_y = ray->from.y / map->cell;
    int x = (int)floor(start_x);
    int y = (int)floor(start_y);
    double distance = 0;

    for (int reach = solid_map_distance(map, x, y); reach > 0; reach = solid_map_distance(map, x, y)) {
        const double out_x = way_out(start_x, ray->along.x, ray->inverse.x, x - reach + 1, x + reach);
        const double out_y = way_out(start_y, ray->along.y, ray->inverse.y, y - reach + 1, y + reach);
        distance = out_x < out_y ? out_x : out_y;
        if (distance > limit) {
            return INFINITY;
        }
        const int next_x = cell_after(x, start_x + distance * ray->along.x, ray->along.x);
        const int next_y = cell_after(y, start_y + distance * ray->along.y, ray->along.y);
        x = out_x > out_y ? next_x : ray->along.x > 0 ? x + reach : x - reach;
        y = out_y > out_x ? next_y : ray->along.y > 0 ? y + reach : y - reach;
    }
    return distance;
}

/* Infinity: the ray passes the disc, or starts within it. */
static double disc_distance(const struct planar_shape *disc, const struct ray *ray)
{
    const double dx = disc->pose.x - ray->from.x;
    const double dy = disc->pose.y - ray->from.y;
    const double along = dx * ray->along.x + dy * ray->along.y;
    const double across = dx * ray->along.y - dy * ray->along.x;
    const double half_chord = sqrt(fmax(disc->radius * disc->radius - across * across, 0));
    const bool hit = fabs(across) <= disc->radius && along >= half_chord;

    return hit ? along - half_chord : INFINITY;
}

/* Cuts the part of a ray between two parallel sides of a box out of [*enters, *leaves]. */
static void cut(double place, double along, double half, double *enters, double *leaves)
{
    if (along == 0) {
        if (fabs(place) > half) {
            *leaves = -INFINITY;
        }
        return;
    }
    const double low = (-half - place) / along;
    const double high = (half - place) / along;
    *enters = fmax(*enters, fmin(low, high));
    *leaves = fmin(*leaves, fmax(low, high));
}

static double box_distance(const struct planar_shape *box, const struct ray *ray)
{
    const struct strict_turn turn = strict_sin_cos(box->pose.heading);
    const double cosine = turn.cosine;
    const double sine = turn.sine;
    const double dx = ray->from.x - box->pose.x;
    const double dy = ray->from.y - box->pose.y;
    double enters = -INFINITY;
    double leaves = INFINITY;

    cut(cosine * dx + sine * dy, cosine * ray->along.x + sine * ray->along.y, box->half_length, &enters, &leaves);
    cut(cosine * dy - sine * dx, cosine * ray->along.y - sine * ray->along.x, box->half_width, &enters, &leaves);
    return enters <= leaves && enters >= 0 ? enters : INFINITY;
}

static double shape_distance(const struct planar_shape *shape, const struct ray *ray)
{
    return shape->kind == PLANAR_DISC ? disc_distance(shape, ray) : box_distance(shape, ray);
}

/* In m; infinity beyond `limit`. */
static double solid_distance(const struct solid_map *map, const struct ray *ray, double limit)
{
    return map_distance(map, ray, limit / map->cell) * map->cell;
}

double laser_ray(const struct solid_map *map, const struct planar_shape *shapes, size_t count,
                 const struct planar_point *from, double bearing, double range_max)
{
    const struct ray ray = ray_of(*from, bearing);
    double distance = solid_distance(map, &ray, range_max);

    for (size_t i = 0; i < count; i++) {
        distance = fmin(distance, shape_distance(&shapes[i], &ray));
    }
    return distance <= range_max ? distance : INFINITY;
}

/* The shapes that a scan can see, each with the bearings that it spans. */
struct sector {
    const struct planar_shape *shape;
    double bearing;
    double half_width;
};

static bool sector_of(const struct planar_shape *shape, const struct planar_pose *scanner, double range_max,
                      struct sector *sector)
{
    const double dx = shape->pose.x - scanner->x;
    const double dy = shape->pose.y - scanner->y;
    const double distance = strict_hypot(dx, dy);
    const double reach = planar_reach(shape);

    sector->shape = shape;
    sector->bearing = strict_atan2(dy, dx);
    sector->half_width = distance > reach ? strict_asin(reach / distance) : M_PI;
    return distance - reach <= range_max;
}

/* Draws the shape's front into the ranges. */
static void draw(const struct laser_config *config, const struct planar_pose *scanner, const struct sector *sector,
                 double *ranges)
{
    const struct planar_point from = {scanner->x, scanner->y};

    for (int i = 0; i < config->beams; i++) {
        const double bearing = scanner->heading + config->first + i * config->step;
        if (fabs(planar_wrap(bearing - sector->bearing)) <= sector->half_width + 1e-9) {
            const struct ray ray = ray_of(from, bearing);
            ranges[i] = fmin(ranges[i], shape_distance(sector->shape, &ray));
        }
    }
}

/* What the scanner tells of a true distance. */
static float measured(const struct laser_config *config, double distance, struct random *random)
{
    const double range = distance + (config->noise > 0 ? random_gaussian(random, config->noise) : 0);
    const bool dropped = config->dropout > 0 && random_uniform(random, 0, 1) < config->dropout;

    const bool seen = distance > 0 && range > 0 && range <= config->range_max;
    return dropped ? LASER_DROPPED : seen ? (float)range : 0;
}

void laser_take(const struct laser_config *config, const struct solid_map *map, const struct planar_shape *shapes,
                size_t count, const struct planar_pose *scanner, struct random *random, struct laser_scan *scan)
{
    const struct planar_point from = {scanner->x, scanner->y};
    double ranges[LASER_BEAMS_MAX];

    for (int i = 0; i < config->beams; i++) {
        const struct ray ray = ray_of(from, scanner->heading + config->first + i * config->step);
        ranges[i] = solid_distance(map, &ray, config->range_max);
    }
    for (size_t i = 0; i < count; i++) {
        struct sector sector;
        if (sector_of(&shapes[i], scanner, config->range_max, &sector)) {
            draw(config, scanner, &sector, ranges);
        }
    }
    scan->beams = config->beams;
    scan->first = config->first;
    scan->step = config->step;
    for (int i = 0; i < config->beams; i++) {
        scan->ranges[i] = measured(config, ranges[i], random);
    }
}
