/* Whether the patrol robot touches a box or a disc, beside libccd and beside the axes that part them. */
#include <ccd/ccd.h>
#include <math.h>
#include <stdio.h>

#include "sim/base/planar.h"
#include "sim/base/random.h"
#include "sim/scenes/patrol_world.h"
#include "tests/support/office_map.h"
#include "tests/support/options.h"
#include "unity.h"

/* Nearer than this, m, rounding may decide. */
#define TIE 1e-9

/* libccd ends its search within so much of a face, m. */
#define TOLERANCE 2e-4

/* Shapes that a robot meets. They stand, along the map's axes. */
#define MET 10

static const struct planar_point middle = {12, 7}; /* of the map, m */

static struct options options = {.count = 200000, .seed = 22};
static struct office office;
static struct patrol_world world;
static struct random noise;

struct prism {
    struct planar_shape shape;
    double half_height;
};

static void support(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const struct prism *prism = object;
    const struct planar_shape *shape = &prism->shape;
    const double cosine = cos(shape->pose.heading);
    const double sine = sin(shape->pose.heading);
    const double z = copysign(prism->half_height, direction->v[2]);

    if (shape->kind == PLANAR_DISC) {
        const double size = hypot(direction->v[0], direction->v[1]);
        const double scale = size > 0 ? shape->radius / size : 0;
        ccdVec3Set(point, shape->pose.x + scale * direction->v[0], shape->pose.y + scale * direction->v[1], z);
        return;
    }
    const double u = copysign(shape->half_length, cosine * direction->v[0] + sine * direction->v[1]);
    const double v = copysign(shape->half_width, cosine * direction->v[1] - sine * direction->v[0]);
    ccdVec3Set(point, shape->pose.x + cosine * u - sine * v, shape->pose.y + sine * u + cosine * v, z);
}

static void centre(const void *object, ccd_vec3_t *point)
{
    const struct prism *prism = object;

    ccdVec3Set(point, prism->shape.pose.x, prism->shape.pose.y, 0);
}

static ccd_t question(void)
{
    ccd_t ccd;

    CCD_INIT(&ccd);
    ccd.support1 = support;
    ccd.support2 = support;
    ccd.center1 = centre;
    ccd.center2 = centre;
    return ccd;
}

/* How far a box's face along an axis is from the other shape: below 0 where they overlap on it. */
static double gap_along(const struct planar_shape *box, const struct planar_shape *other, double axis, double half)
{
    const double dx = other->pose.x - box->pose.x;
    const double dy = other->pose.y - box->pose.y;
    const double turned = other->pose.heading - axis;
    const double reach = other->kind == PLANAR_DISC
                             ? other->radius
                             : other->half_length * fabs(cos(turned)) + other->half_width * fabs(sin(turned));

    return fabs(dx * cos(axis) + dy * sin(axis)) - half - reach;
}

static double gap_of_faces(const struct planar_shape *box, const struct planar_shape *other)
{
    return fmax(gap_along(box, other, box->pose.heading, box->half_length),
                gap_along(box, other, box->pose.heading + M_PI / 2, box->half_width));
}

/* Above 0: they are apart. */
static double gap(const struct planar_shape *box, const struct planar_shape *other)
{
    if (other->kind == PLANAR_BOX) {
        return fmax(gap_of_faces(box, other), gap_of_faces(other, box));
    }
    const struct planar_pose there = planar_between(&box->pose, &other->pose);

    return hypot(fmax(fabs(there.x) - box->half_length, 0), fmax(fabs(there.y) - box->half_width, 0)) - other->radius;
}

/* Within reach of each other, mostly. */
static struct planar_shape draw(bool is_box)
{
    struct planar_shape shape = {.kind = is_box ? PLANAR_BOX : PLANAR_DISC};

    shape.pose.x = middle.x + random_uniform(&noise, -1.5, 1.5);
    shape.pose.y = middle.y + random_uniform(&noise, -1.5, 1.5);
    shape.pose.heading = random_uniform(&noise, -4, 4);
    shape.radius = random_uniform(&noise, 0.05, 0.8);
    shape.half_length = random_uniform(&noise, 0.025, 1);
    shape.half_width = random_uniform(&noise, 0.025, 0.6);
    return shape;
}

/* Whether the robot says that it touches the shape, which is alone with it. */
static bool says_touch(const struct planar_shape *shape)
{
    const struct patrol_obstacle obstacle = {
        .shape = *shape, .waypoints = {{shape->pose.x, shape->pose.y}}, .waypoint_count = 1};

    world.obstacle_count = 0;
    TEST_ASSERT_TRUE(patrol_world_add(&world, &obstacle));
    return patrol_world_touch(&world) == PATROL_TOUCH_OBSTACLE;
}

void setUp(void)
{
    random_init(&noise, options.seed);
    TEST_ASSERT_TRUE(office_empty(&office));
    TEST_ASSERT_TRUE(patrol_world_init(&world, &office.terrain, 1, 1, &(struct planar_pose){middle.x, middle.y, 0}));
}

void tearDown(void)
{
    patrol_world_free(&world);
}

static void test_shapes_touch_where_libccd_and_an_axis_say_so(void)
{
    const ccd_t ccd = question();
    unsigned long touching = 0;

    for (unsigned long i = 0; i < options.count; i += MET) {
        const struct prism robot = {draw(true), 1};
        world.robot = robot.shape;
        for (int k = 0; k < MET; k++) {
            struct prism other = {draw(k % 2 == 0), 0.75};
            other.shape.pose.heading = 0;
            const double apart = gap(&robot.shape, &other.shape);
            const bool touches = says_touch(&other.shape);

            TEST_ASSERT_TRUE(fabs(apart) < TIE || touches == (apart < 0));
            TEST_ASSERT_TRUE(fabs(apart) < TOLERANCE || touches == (ccdMPRIntersect(&robot, &other, &ccd) != 0));
            touching += touches;
        }
    }
    TEST_ASSERT_TRUE(touching > options.count / 5 && touching < options.count * 4 / 5);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
