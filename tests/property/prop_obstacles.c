/*
 * joulepath/obstacles.h against geometry in double: the distance and its gradient against the hull of all differences
 * of the two shapes' corners (Minkowski), the nearest of many shapes against sorting, and scans of random rooms.
 *
 * prop_obstacles [--count N] [--seed S]
 * --count is the number of random pairs of footprint and shape.
 */
#include <joulepath/obstacles.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

#define PI 3.14159265358979323846

#define DISTANCE_BAR 1e-5 /* m; coordinates are within 30 m */
#define GRADIENT_BAR 5e-4
#define STEP         1e-6 /* m or rad, of the differences that stand for derivatives */
#define SMOOTH       1e-4 /* one-sided derivatives that differ by more are on two sides of an edge */
#define UNDECIDED    1e-5 /* m; which ways out are allowed may depend on rounding */

enum { CORNERS = 4, DIFFERENCES = CORNERS * JP_OBSTACLE_VERTICES_MAX, SETS = 2000, CROWD = 60, ROOMS = 300 };

struct vector {
    double x, y;
};

/* The distance of a footprint from a shape and how sure it is. */
struct answer {
    double distance;
    bool is_decided;
};

static struct options options = {.count = 20000, .seed = 6};
void setUp(void)
{
    begin_random(options.seed, 0);
}

void tearDown(void)
{
}

static unsigned one_of(unsigned count)
{
    return (unsigned)uniform(0, count);
}

/* ---- The oracle ---- */

static double cross(struct vector o, struct vector a, struct vector b)
{
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

static int by_place(const void *a, const void *b)
{
    const struct vector *const first = a;
    const struct vector *const second = b;

    if (first->x != second->x) {
        return first->x < second->x ? -1 : 1;
    }
    return (first->y > second->y) - (first->y < second->y);
}

/* Andrew's monotone chain: the corners counterclockwise. */
static unsigned convex_hull(struct vector *points, unsigned count, struct vector *hull)
{
    unsigned size = 0;

    qsort(points, count, sizeof points[0], by_place);
    for (int pass = 0; pass < 2; pass++) {
        const unsigned start = size;

        for (unsigned i = 0; i < count; i++) {
            const struct vector point = points[pass == 0 ? i : count - 1 - i];

            while (size >= start + 2 && cross(hull[size - 2], hull[size - 1], point) <= 0) {
                size--;
            }
            hull[size++] = point;
        }
        size--; /* the other pass begins with it */
    }
    return size;
}

static double from_segment(struct vector a, struct vector b)
{
    const double square = (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
    const double t = square > 0 ? fmin(1, fmax(0, -(a.x * (b.x - a.x) + a.y * (b.y - a.y)) / square)) : 0;

    return hypot(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y));
}

/* How far the pose is beyond the shape's hull along a direction. */
static double pose_beyond(const struct vector *vertices, unsigned count, struct vector normal)
{
    double farthest = -INFINITY;

    for (unsigned i = 0; i < count; i++) {
        farthest = fmax(farthest, vertices[i].x * normal.x + vertices[i].y * normal.y);
    }
    return -farthest;
}

/* Of the origin from the hull of all (corner − vertex): apart, or the least way out that is allowed. */
static struct answer from_differences(const struct vector *hull, unsigned size, const struct vector *vertices,
                                      unsigned count)
{
    double apart = INFINITY;
    double allowed = -INFINITY;
    double any = -INFINITY;
    double undecided = -INFINITY;
    bool is_inside = true;

    for (unsigned i = 0; i < size; i++) {
        const struct vector a = hull[i];
        const struct vector b = hull[(i + 1) % size];
        const double length = hypot(b.x - a.x, b.y - a.y);
        const struct vector normal = {(b.y - a.y) / length, -(b.x - a.x) / length};
        const double depth = a.x * normal.x + a.y * normal.y; /* above 0: the origin is inside */
        const double beyond = pose_beyond(vertices, count, (struct vector){-normal.x, -normal.y});

        apart = fmin(apart, from_segment(a, b));
        is_inside = is_inside && depth > 0;
        any = fmax(any, -depth);
        if (fabs(beyond) < UNDECIDED) {
            undecided = fmax(undecided, -depth);
        } else if (beyond > 0) {
            allowed = fmax(allowed, -depth);
        }
    }
    if (!is_inside) {
        return (struct answer){apart, true};
    }
    return (struct answer){isinf(allowed) ? any : allowed, undecided <= allowed || isinf(undecided)};
}

struct pose {
    double x, y, heading;
};

static struct answer oracle(const struct jp_footprint *footprint, const struct pose *pose,
                            const struct jp_obstacle *shape)
{
    const double cosine = cos(pose->heading);
    const double sine = sin(pose->heading);
    const struct vector corners[CORNERS] = {{footprint->front, footprint->half_width},
                                            {-footprint->rear, footprint->half_width},
                                            {-footprint->rear, -footprint->half_width},
                                            {footprint->front, -footprint->half_width}};
    struct vector vertices[JP_OBSTACLE_VERTICES_MAX];
    struct vector differences[DIFFERENCES];
    struct vector hull[2 * DIFFERENCES];
    unsigned count = 0;

    for (unsigned i = 0; i < shape->vertex_count; i++) {
        const struct vector way = {(double)shape->vertices[i].x - pose->x, (double)shape->vertices[i].y - pose->y};

        vertices[i] = (struct vector){cosine * way.x + sine * way.y, cosine * way.y - sine * way.x};
        for (unsigned k = 0; k < CORNERS; k++) {
            differences[count++] = (struct vector){corners[k].x - vertices[i].x, corners[k].y - vertices[i].y};
        }
    }

    struct answer answer = from_differences(hull, convex_hull(differences, count, hull), vertices, shape->vertex_count);
    answer.distance -= (double)shape->radius;
    return answer;
}

static struct pose in_double(const struct jp_plane_pose *pose)
{
    return (struct pose){(double)pose->x, (double)pose->y, (double)pose->heading};
}

/* ---- Random footprints and shapes ---- */

static struct jp_footprint random_footprint(void)
{
    return (struct jp_footprint){(float)uniform(0, 1), (float)uniform(0, 1), (float)uniform(0.01, 0.5)};
}

static struct jp_plane_pose random_pose(double heading_max)
{
    return (struct jp_plane_pose){(float)uniform(-20, 20), (float)uniform(-20, 20),
                                  (float)uniform(-heading_max, heading_max)};
}

/* Corners on an ellipse, counterclockwise; each in a sector of its own. */
static struct jp_obstacle random_shape(const struct jp_plane_pose *near)
{
    struct jp_obstacle shape = {.vertex_count = (uint8_t)(1 + one_of(JP_OBSTACLE_VERTICES_MAX)),
                                .radius = (float)(one_of(2) * uniform(0, 0.5))};
    const double reach = one_of(2) ? 1.0 : 3.0;
    const struct vector centre = {(double)near->x + uniform(-reach, reach), (double)near->y + uniform(-reach, reach)};
    const struct vector axes = {uniform(0.05, 3), uniform(0.05, 3)};
    const double turn = uniform(0, 2 * PI);

    for (unsigned i = 0; i < shape.vertex_count; i++) {
        const double angle = turn + 2 * PI * (i + uniform(0, 0.8)) / shape.vertex_count;

        shape.vertices[i].x = (float)(centre.x + axes.x * cos(angle));
        shape.vertices[i].y = (float)(centre.y + axes.y * sin(angle));
    }
    return shape;
}

/* ---- The distance ---- */

static void test_distance_is_that_of_the_oracle(void)
{
    double worst = 0;
    unsigned long compared = 0;
    unsigned long overlapping = 0;

    for (unsigned long i = 0; i < options.count; i++) {
        const struct jp_footprint footprint = random_footprint();
        const struct jp_plane_pose pose = random_pose(i % 2 ? 4 : 1000);
        const struct jp_obstacle shape = random_shape(&pose);
        const struct pose exact = in_double(&pose);
        const struct answer answer = oracle(&footprint, &exact, &shape);
        const double distance = (double)jp_obstacle_distance(&footprint, &pose, &shape, NULL);

        if (answer.is_decided) {
            compared++;
            overlapping += answer.distance < -(double)shape.radius;
            if (fabs(distance - answer.distance) > DISTANCE_BAR) {
                printf("case %lu: %.7f instead of %.7f, %u vertices\n", i, distance, answer.distance,
                       (unsigned)shape.vertex_count);
            }
            worst = fmax(worst, fabs(distance - answer.distance));
        }
    }
    printf("distance: %lu pairs, %lu of them overlapping, worst error %.2g m\n", compared, overlapping, worst);
    TEST_ASSERT_TRUE(compared > options.count * 9 / 10);
    TEST_ASSERT_TRUE(overlapping > options.count / 10);
    TEST_ASSERT_TRUE(worst <= DISTANCE_BAR);
}

/* By one of the pose's members; false: not smooth here. */
static bool derivative(const struct jp_footprint *footprint, const struct pose *pose, unsigned member,
                       const struct jp_obstacle *shape, double *slope)
{
    const double steps[3][3] = {{STEP, 0, 0}, {0, STEP, 0}, {0, 0, STEP}};
    const double *const step = steps[member];
    const struct pose after = {pose->x + step[0], pose->y + step[1], pose->heading + step[2]};
    const struct pose before = {pose->x - step[0], pose->y - step[1], pose->heading - step[2]};
    const struct answer here = oracle(footprint, pose, shape);
    const struct answer there = oracle(footprint, &after, shape);
    const struct answer other = oracle(footprint, &before, shape);

    *slope = (there.distance - other.distance) / (2 * STEP);
    return here.is_decided && there.is_decided && other.is_decided &&
           fabs(there.distance + other.distance - 2 * here.distance) < SMOOTH * STEP;
}

static void test_gradient_is_that_of_the_oracle(void)
{
    double worst = 0;
    unsigned long compared = 0;

    for (unsigned long i = 0; i < options.count; i++) {
        const struct jp_footprint footprint = random_footprint();
        const struct jp_plane_pose pose = random_pose(4);
        const struct jp_obstacle shape = random_shape(&pose);
        const struct pose exact = in_double(&pose);
        struct jp_plane_pose gradient;
        const double distance = (double)jp_obstacle_distance(&footprint, &pose, &shape, &gradient);
        const double core_distance = distance + (double)shape.radius;
        const double members[3] = {(double)gradient.x, (double)gradient.y, (double)gradient.heading};

        /* Of points nearer to each other than this the direction is known less well. */
        if (fabs(core_distance) < 0.05) {
            continue;
        }
        for (unsigned member = 0; member < 3; member++) {
            double slope = 0;

            if (derivative(&footprint, &exact, member, &shape, &slope)) {
                compared++;
                if (fabs(members[member] - slope) > GRADIENT_BAR) {
                    printf("case %lu, %u: %.6f instead of %.6f, distance %.4f, %u vertices\n", i, member,
                           members[member], slope, distance, (unsigned)shape.vertex_count);
                }
                worst = fmax(worst, fabs(members[member] - slope));
            }
        }
    }
    printf("gradient: %lu derivatives, worst error %.2g\n", compared, worst);
    TEST_ASSERT_TRUE(compared > options.count * 2);
    TEST_ASSERT_TRUE(worst <= GRADIENT_BAR);
}

static void test_moved_out_by_the_distance_they_are_apart(void)
{
    double worst = 0;
    unsigned long moved = 0;

    for (unsigned long i = 0; i < options.count; i++) {
        const struct jp_footprint footprint = random_footprint();
        const struct jp_plane_pose pose = random_pose(4);
        const struct jp_obstacle shape = random_shape(&pose);
        struct jp_plane_pose gradient;
        const double depth = (double)jp_obstacle_distance(&footprint, &pose, &shape, &gradient) + (double)shape.radius;

        TEST_ASSERT_TRUE(fabs(hypot((double)gradient.x, (double)gradient.y) - 1) < 1e-6);
        if (depth < 0) {
            const struct pose out = {(double)pose.x - depth * (double)gradient.x,
                                     (double)pose.y - depth * (double)gradient.y, (double)pose.heading};

            worst = fmax(worst, -(oracle(&footprint, &out, &shape).distance + (double)shape.radius));
            moved++;
        }
    }
    printf("way out: %lu overlapping pairs, worst overlap after it %.2g m\n", moved, worst);
    TEST_ASSERT_TRUE(moved > options.count / 10);
    TEST_ASSERT_TRUE(worst <= DISTANCE_BAR);
}

/* ---- The nearest of many ---- */

static int by_value(const void *a, const void *b)
{
    const double first = *(const double *)a;
    const double second = *(const double *)b;

    return (first > second) - (first < second);
}

static void test_the_nearest_are_kept(void)
{
    const struct jp_footprint point = {0.0f, 0.0f, 0.0f};

    for (unsigned set = 0; set < SETS; set++) {
        const struct jp_plane_pose here = random_pose(0);
        const struct jp_plane_point centre = {here.x, here.y};
        const struct pose exact = {(double)here.x, (double)here.y, 0};
        const unsigned count = one_of(CROWD);
        double distances[CROWD];
        struct jp_obstacles obstacles;

        jp_obstacles_clear(&obstacles, &centre);
        for (unsigned i = 0; i < count; i++) {
            const struct jp_plane_pose near = random_pose(0);
            const struct jp_obstacle shape = random_shape(&near);

            TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&obstacles, &shape));
            distances[i] = oracle(&point, &exact, &shape).distance;
        }
        qsort(distances, count, sizeof distances[0], by_value);

        const unsigned kept = count < JP_OBSTACLES_MAX ? count : JP_OBSTACLES_MAX;

        TEST_ASSERT_EQUAL_UINT(kept, obstacles.count);
        TEST_ASSERT_EQUAL_UINT32(count - kept, obstacles.dropped);
        for (unsigned i = 0; i < kept; i++) {
            TEST_ASSERT_TRUE(fabs((double)obstacles.distance[i] - distances[i]) < DISTANCE_BAR);
            TEST_ASSERT_TRUE(fabs(oracle(&point, &exact, &obstacles.shapes[i]).distance - distances[i]) < DISTANCE_BAR);
        }
    }
}

static void test_nearest_of_all_is_the_least_distance(void)
{
    for (unsigned set = 0; set < SETS; set++) {
        const struct jp_plane_pose pose = random_pose(4);
        const struct jp_plane_point centre = {pose.x + (float)uniform(-5, 5), pose.y + (float)uniform(-5, 5)};
        const struct jp_footprint footprint = random_footprint();
        const unsigned count = one_of(JP_OBSTACLES_MAX + 1);
        float least = JP_OBSTACLE_NONE;
        struct jp_obstacles obstacles;

        jp_obstacles_clear(&obstacles, &centre);
        for (unsigned i = 0; i < count; i++) {
            const struct jp_plane_pose near = {pose.x + (float)uniform(-6, 6), pose.y + (float)uniform(-6, 6), 0};
            const struct jp_obstacle shape = random_shape(&near);

            TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&obstacles, &shape));
            least = fminf(least, jp_obstacle_distance(&footprint, &pose, &shape, NULL));
        }
        TEST_ASSERT_TRUE(jp_obstacles_distance(&obstacles, &footprint, &pose) == least);
    }
}

/* ---- Scans ---- */

enum { WALLS_MAX = 40, BEAMS_MAX = 1081 };

struct wall {
    struct vector a, b;
};

struct room {
    struct wall walls[WALLS_MAX];
    unsigned count;
};

static void add_box(struct room *room, struct vector centre, double half_length, double half_width, double heading)
{
    const double x[4] = {half_length, -half_length, -half_length, half_length};
    const double y[4] = {half_width, half_width, -half_width, -half_width};
    struct vector corners[4];

    for (unsigned i = 0; i < 4; i++) {
        corners[i] = (struct vector){centre.x + x[i] * cos(heading) - y[i] * sin(heading),
                                     centre.y + x[i] * sin(heading) + y[i] * cos(heading)};
    }
    for (unsigned i = 0; i < 4; i++) {
        room->walls[room->count++] = (struct wall){corners[i], corners[(i + 1) % 4]};
    }
}

/* The sensor is in the middle, which is free. */
static struct room random_room(struct vector middle)
{
    const unsigned boxes = one_of(9);
    struct room room = {.count = 0};

    add_box(&room, middle, uniform(3, 12), uniform(3, 12), uniform(0, PI));
    for (unsigned i = 0; i < boxes; i++) {
        const double bearing = uniform(0, 2 * PI);
        const double way = uniform(1.5, 8);
        const struct vector centre = {middle.x + way * cos(bearing), middle.y + way * sin(bearing)};

        add_box(&room, centre, uniform(0.05, 0.7), uniform(0.05, 0.7), uniform(0, PI));
    }
    return room;
}

/* Along a beam to the nearest wall; 0 without any. */
static double cast(const struct room *room, struct vector from, double angle)
{
    const struct vector beam = {cos(angle), sin(angle)};
    double nearest = INFINITY;

    for (unsigned i = 0; i < room->count; i++) {
        const struct wall *const wall = &room->walls[i];
        const struct vector along = {wall->b.x - wall->a.x, wall->b.y - wall->a.y};
        const struct vector way = {wall->a.x - from.x, wall->a.y - from.y};
        const double sine = beam.x * along.y - beam.y * along.x;
        const double range = (way.x * along.y - way.y * along.x) / sine;
        const double share = (way.x * beam.y - way.y * beam.x) / sine;

        if (range > 0 && share >= 0 && share <= 1) {
            nearest = fmin(nearest, range);
        }
    }
    return isinf(nearest) ? 0 : nearest;
}

struct seen_room {
    struct jp_scan scan;
    struct jp_scan_config config;
    struct jp_plane_pose sensor;
    float ranges[BEAMS_MAX];
    struct vector points[BEAMS_MAX]; /* of the beams that saw something near enough */
    unsigned count;
};

static void look_around(struct seen_room *seen)
{
    const struct room room = random_room((struct vector){(double)seen->sensor.x, (double)seen->sensor.y});
    const double noise = uniform(0, 0.02);

    seen->count = 0;
    for (unsigned i = 0; i < seen->scan.count; i++) {
        const double angle =
            (double)seen->sensor.heading + (double)seen->scan.first_angle + i * (double)seen->scan.angle_step;
        const struct vector from = {(double)seen->sensor.x, (double)seen->sensor.y};

        seen->ranges[i] = (float)(cast(&room, from, angle) + uniform(-noise, noise));
        if (one_of(20) == 0) {
            seen->ranges[i] = one_of(2) ? NAN : 0.0f;
        }
        if (seen->ranges[i] > 0.0f && seen->ranges[i] <= seen->config.range_max) {
            const double range = (double)seen->ranges[i];

            seen->points[seen->count++] = (struct vector){from.x + range * cos(angle), from.y + range * sin(angle)};
        }
    }
}

static void random_view(struct seen_room *seen)
{
    seen->sensor = random_pose(4);
    seen->scan = (struct jp_scan){.ranges = seen->ranges, .count = (uint16_t)(90 + one_of(BEAMS_MAX - 90))};
    seen->scan.first_angle = (float)uniform(-PI, 0);
    seen->scan.angle_step = (float)(uniform(PI, 2 * PI) / seen->scan.count);
    seen->config = (struct jp_scan_config){.range_max = (float)uniform(3, 20),
                                           .gap = (float)uniform(0.05, 1),
                                           .tolerance = (float)uniform(0.02, 0.1),
                                           .beams_min = 1};
    look_around(seen);
}

static double from_shapes(const struct jp_obstacles *obstacles, struct vector place)
{
    const struct jp_footprint point = {0.0f, 0.0f, 0.0f};
    const struct pose pose = {place.x, place.y, 0};
    double nearest = INFINITY;

    for (unsigned i = 0; i < obstacles->count; i++) {
        nearest = fmin(nearest, oracle(&point, &pose, &obstacles->shapes[i]).distance);
    }
    return nearest;
}

static double from_points(const struct seen_room *seen, struct vector place)
{
    double nearest = INFINITY;

    for (unsigned i = 0; i < seen->count; i++) {
        nearest = fmin(nearest, hypot(seen->points[i].x - place.x, seen->points[i].y - place.y));
    }
    return nearest;
}

/* A shape that was dropped is as far away as the farthest that was kept, and so are its points. */
static void test_every_point_of_a_scan_is_in_a_shape(void)
{
    unsigned long points = 0;
    unsigned full = 0;

    for (unsigned i = 0; i < ROOMS; i++) {
        struct seen_room seen;
        struct jp_obstacles obstacles;

        random_view(&seen);
        jp_obstacles_clear(&obstacles, &(struct jp_plane_point){seen.sensor.x, seen.sensor.y});
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add_scan(&obstacles, &seen.config, &seen.scan, &seen.sensor));

        const double kept = obstacles.dropped > 0 ? (double)obstacles.distance[JP_OBSTACLES_MAX - 1] : INFINITY;

        for (unsigned k = 0; k < seen.count; k++) {
            const double range =
                hypot(seen.points[k].x - (double)seen.sensor.x, seen.points[k].y - (double)seen.sensor.y);

            if (range < kept - DISTANCE_BAR) {
                TEST_ASSERT_TRUE(from_shapes(&obstacles, seen.points[k]) < DISTANCE_BAR);
                points++;
            }
        }
        full += obstacles.dropped > 0;
    }
    printf("scans: %d rooms, %u with too many shapes, %lu points in shapes\n", ROOMS, full, points);
    TEST_ASSERT_TRUE(full > ROOMS / 20 && full < ROOMS);
}

/* Whether a shape is just as wide as its points need: one of them is outside of a shape of 1/√2 of its radius. */
static bool has_point_near_rim(const struct seen_room *seen, const struct jp_obstacle *shape)
{
    const struct jp_footprint point = {0.0f, 0.0f, 0.0f};
    const double radius = (double)shape->radius;

    for (unsigned i = 0; i < seen->count; i++) {
        const struct pose pose = {seen->points[i].x, seen->points[i].y, 0};
        const double from_chord = oracle(&point, &pose, shape).distance + radius;

        if (from_chord > radius / sqrt(2) - DISTANCE_BAR && from_chord < radius + DISTANCE_BAR) {
            return true;
        }
    }
    return false;
}

/*
 * The chord through two points is moved to the mean of the points that it stands for: by no more than the tolerance of
 * a chord that was split enough, and by no more than its radius, which covers them. Its radius is no larger than two
 * such points need, one beside it and one beyond its end.
 */
static void test_shapes_of_a_scan_are_chords_through_the_middle_of_points(void)
{
    unsigned long chords = 0;
    unsigned long thin = 0;

    for (unsigned i = 0; i < ROOMS; i++) {
        struct seen_room seen;
        struct jp_obstacles obstacles;

        random_view(&seen);
        jp_obstacles_clear(&obstacles, &(struct jp_plane_point){seen.sensor.x, seen.sensor.y});
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add_scan(&obstacles, &seen.config, &seen.scan, &seen.sensor));
        for (unsigned k = 0; k < obstacles.count; k++) {
            const struct jp_obstacle *const shape = &obstacles.shapes[k];
            const double tolerance = (double)seen.config.tolerance;
            const double radius = (double)shape->radius;

            TEST_ASSERT_TRUE(shape->vertex_count == 1 || shape->vertex_count == 2);
            TEST_ASSERT_TRUE(shape->vertex_count == 2 || shape->radius == seen.config.tolerance);
            TEST_ASSERT_TRUE(radius < sqrt(5) * tolerance + DISTANCE_BAR);
            for (unsigned v = 0; v < shape->vertex_count; v++) {
                const struct vector vertex = {(double)shape->vertices[v].x, (double)shape->vertices[v].y};
                const double shift = shape->vertex_count == 2 ? fmin(radius, tolerance) : 0;

                TEST_ASSERT_TRUE(from_points(&seen, vertex) < shift + DISTANCE_BAR);
            }
            if (shape->vertex_count == 2) {
                TEST_ASSERT_TRUE(has_point_near_rim(&seen, shape));
                chords++;
                thin += radius < tolerance / 2;
            }
        }
    }
    printf("chords: %lu, %lu of them with less than half of the tolerance as radius\n", chords, thin);
    TEST_ASSERT_TRUE(chords > ROOMS && thin > chords / 10);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
