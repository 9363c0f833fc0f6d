/* The patrol robot's world: its touches and distances against other ways of reckoning, and the shortcuts of
 * its steps against measuring at every step; random poses, maps and obstacles. */
#include <math.h>
#include <stdio.h>

#include "sim/base/random.h"
#include "sim/scenes/patrol_world.h"
#include "tests/support/check.h"
#include "tests/support/office_map.h"
#include "tests/support/options.h"
#include "unity.h"

#define LENGTH 0.8 /* of the robot, m */
#define WIDTH  0.6
#define TICK   0.01 /* s */
#define SLOT   2e-3 /* so near to touching either verdict is right, m */

static struct random noise;

static struct options options = {.count = 100, .seed = 50};
static struct office office;
static struct patrol_world world;
static const struct planar_pose centre = {12, 7, 0};

void setUp(void)
{
    random_init(&noise, options.seed);
    TEST_ASSERT_TRUE(office_make(&office, &noise));
    TEST_ASSERT_TRUE(patrol_world_init(&world, &office.terrain, LENGTH, WIDTH, &centre));
}

void tearDown(void)
{
    patrol_world_free(&world);
}

static void restart(void)
{
    patrol_world_free(&world);
    TEST_ASSERT_TRUE(patrol_world_init(&world, &office.terrain, LENGTH, WIDTH, &centre));
}

static struct planar_pose random_pose(void)
{
    return (struct planar_pose){random_uniform(&noise, 0, OFFICE_WIDTH * OFFICE_CELL),
                                random_uniform(&noise, 0, OFFICE_HEIGHT * OFFICE_CELL),
                                random_uniform(&noise, -M_PI, M_PI)};
}

static struct patrol_obstacle standing(enum planar_kind kind, double x, double y)
{
    return (struct patrol_obstacle){
        .shape = {.kind = kind, .radius = 0.3, .half_length = 0.4, .half_width = 0.2},
        .waypoints = {{x, y}},
        .waypoint_count = 1,
    };
}

/* ---- Oracle: distances of points that lie close together on the robot's border ---- */

static double to_cell(double x, double y, int column, int row)
{
    const double cell = world.map.cell;
    const double dx = fmax(fmax(column * cell - x, x - (column + 1) * cell), 0);
    const double dy = fmax(fmax(row * cell - y, y - (row + 1) * cell), 0);
    return hypot(dx, dy);
}

static double to_map(double x, double y, int reach)
{
    const int column = (int)floor(x / world.map.cell);
    const int row = (int)floor(y / world.map.cell);
    double least = INFINITY;
    for (int j = row - reach; j <= row + reach; j++) {
        for (int i = column - reach; i <= column + reach; i++) {
            if (jp_terrain_cell(&office.terrain, i, j) == JP_CELL_OCCUPIED) {
                least = fmin(least, to_cell(x, y, i, j));
            }
        }
    }
    return least;
}

static double to_shape(double x, double y, const struct planar_shape *shape)
{
    const double dx = x - shape->pose.x;
    const double dy = y - shape->pose.y;
    if (shape->kind == PLANAR_DISC) {
        return fmax(hypot(dx, dy) - shape->radius, 0);
    }
    const double u = fabs(dx * cos(shape->pose.heading) + dy * sin(shape->pose.heading)) - shape->half_length;
    const double v = fabs(dy * cos(shape->pose.heading) - dx * sin(shape->pose.heading)) - shape->half_width;
    return hypot(fmax(u, 0), fmax(v, 0));
}

/* Points all over the robot; `fine` of them along its length. Up to 0.5 m from the map. */
static double distance_by_points(int fine)
{
    double least = INFINITY;
    for (int i = 0; i <= fine; i++) {
        for (int j = 0; j <= fine; j++) {
            const struct planar_point point = {LENGTH * ((double)i / fine - 0.5), WIDTH * ((double)j / fine - 0.5)};
            const struct planar_point at = planar_place(&world.robot.pose, point);
            if (i % fine != 0 && j % fine != 0 && (i % 4 != 0 || j % 4 != 0)) {
                continue; /* fewer within than on the border */
            }
            least = fmin(least, to_map(at.x, at.y, 10));
            for (size_t k = 0; k < world.shape_count; k++) {
                least = fmin(least, to_shape(at.x, at.y, &world.shapes[k]));
            }
        }
    }
    return least;
}

static void place_at(struct planar_pose pose)
{
    patrol_world_step(&world, &pose, 0);
}

static void test_distances_and_touches_at_random_poses(void)
{
    int touches = 0;
    int clear = 0;
    for (unsigned long run = 0; run < options.count; run++) {
        restart();
        place_at(random_pose());
        const struct planar_pose *pose = &world.robot.pose;
        const struct patrol_obstacle obstacle =
            standing(run % 2 == 0 ? PLANAR_DISC : PLANAR_BOX, pose->x + random_uniform(&noise, -1.2, 1.2),
                     pose->y + random_uniform(&noise, -1.2, 1.2));
        TEST_ASSERT_TRUE(patrol_world_add(&world, &obstacle));
        const double expected = fmin(distance_by_points(48), 0.45);
        const double distance = patrol_world_distance(&world, 0.45);
        check_near(expected, distance, 0.01, "distance, m");
        TEST_ASSERT_TRUE_MESSAGE(distance <= expected + 1e-9, "points are never nearer than the shapes");
        const enum patrol_touch touch = patrol_world_touch(&world);
        if (distance > SLOT) {
            TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_NONE, touch);
            clear++;
        }
        if (expected == 0) {
            TEST_ASSERT_TRUE(touch != PATROL_TOUCH_NONE);
            touches++;
        }
    }
    TEST_ASSERT_TRUE((unsigned long)touches > options.count / 20 && (unsigned long)clear > options.count / 20);
}

/* Pushed towards a wall or an obstacle in small steps: the verdict turns where the distance becomes 0. */
static void test_touch_begins_where_the_distance_ends(void)
{
    for (int run = 0; run < 40; run++) {
        restart();
        const double heading = random_uniform(&noise, -M_PI, M_PI);
        if (run % 2 == 0) {
            const struct patrol_obstacle obstacle = standing(run % 4 == 0 ? PLANAR_DISC : PLANAR_BOX, 14.5, 7);
            TEST_ASSERT_TRUE(patrol_world_add(&world, &obstacle));
        }
        struct planar_pose pose = {12, 7, heading};
        place_at(pose);
        double distance = patrol_world_distance(&world, 5);
        while (patrol_world_touch(&world) == PATROL_TOUCH_NONE) {
            TEST_ASSERT_TRUE_MESSAGE(distance > 0, "it touches when the distance is 0");
            pose.x += run % 2 == 0 ? 0.001 : 0;
            pose.y += run % 2 == 0 ? 0 : 0.001;
            place_at(pose);
            distance = patrol_world_distance(&world, 5);
        }
        check_near(0, distance, SLOT, "distance at the first touch, m");
    }
}

static void test_kind_of_touch(void)
{
    place_at((struct planar_pose){12, 7, 0});
    TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_NONE, patrol_world_touch(&world));
    place_at((struct planar_pose){12, 6.1, 0});
    TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_MAP, patrol_world_touch(&world));
    place_at((struct planar_pose){-5, 7, 0});
    TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_MAP, patrol_world_touch(&world));
    place_at((struct planar_pose){12, 7, 0});
    const struct patrol_obstacle obstacle = standing(PLANAR_DISC, 12.6, 7);
    TEST_ASSERT_TRUE(patrol_world_add(&world, &obstacle));
    TEST_ASSERT_EQUAL_INT(PATROL_TOUCH_OBSTACLE, patrol_world_touch(&world));
}

/* ---- Steps ---- */

/* Walks of people, carts and one that comes out of nowhere. */
static void add_random_obstacles(int number)
{
    for (int i = 0; i < number; i++) {
        struct patrol_obstacle obstacle = standing(i % 2 == 0 ? PLANAR_DISC : PLANAR_BOX, 0, 0);
        obstacle.waypoint_count = 3;
        for (int k = 0; k < 3; k++) {
            obstacle.waypoints[k] = (struct planar_point){random_uniform(&noise, 6, 18), random_uniform(&noise, 6, 8)};
        }
        obstacle.speed = random_uniform(&noise, 0, 1.5);
        obstacle.appears = i == 0 ? random_uniform(&noise, 0, 8) : 0;
        obstacle.starts = random_uniform(&noise, 0, 4);
        obstacle.end = (enum patrol_end)(i % 3);
        TEST_ASSERT_TRUE(patrol_world_add(&world, &obstacle));
    }
}

/* Measured at every step, without the shortcuts. */
static void test_steps_find_the_least_distance_and_the_first_touch(void)
{
    int touched = 0;
    for (int run = 0; run < 24; run++) {
        restart();
        add_random_obstacles(run % 3);
        struct planar_pose pose = {random_uniform(&noise, 8, 16), 7, random_uniform(&noise, -M_PI, M_PI)};
        const struct planar_pose motion = {random_uniform(&noise, -0.012, 0.012), 0,
                                           random_uniform(&noise, -0.01, 0.01)};
        double least = PATROL_DISTANCE_MAX;
        double first = INFINITY;
        for (int tick = 0; tick < 500; tick++) {
            pose = planar_compose(&pose, &motion);
            patrol_world_step(&world, &pose, TICK);
            least = fmin(least, patrol_world_distance(&world, PATROL_DISTANCE_MAX));
            const enum patrol_touch touch = patrol_world_touch(&world);
            if (touch != PATROL_TOUCH_NONE) {
                first = fmin(first, world.time);
                least = 0;
            }
            TEST_ASSERT_TRUE_MESSAGE(touch == world.touch, "touch now");
            check_near(least, world.distance_min, 0.001 + 1e-9, "least distance so far, m");
        }
        TEST_ASSERT_TRUE((world.first_touch != PATROL_TOUCH_NONE) == isfinite(first));
        if (isfinite(first)) {
            check_near(first, world.first_touch_time, 1e-9, "time of the first touch, s");
            touched++;
        }
    }
    TEST_ASSERT_TRUE_MESSAGE(touched > 2 && touched < 22, "some touch and some do not");
}

/* ---- Obstacles ---- */

static struct patrol_obstacle walker(enum patrol_end end)
{
    return (struct patrol_obstacle){
        .shape = {.kind = PLANAR_BOX, .half_length = 0.3, .half_width = 0.1},
        .waypoints = {{2, 1}, {4, 1}, {4, 2}},
        .waypoint_count = 3,
        .speed = 0.5,
        .appears = 1,
        .starts = 2,
        .end = end,
    };
}

static void check_walker(double time, double x, double y, double heading, double speed)
{
    struct planar_pose away = {20, 7, 0};
    patrol_world_step(&world, &away, time - world.time);
    TEST_ASSERT_EQUAL_INT(1, (int)world.shape_count);
    const struct planar_shape *shape = &world.shapes[0];
    check_near(x, shape->pose.x, 1e-9, "x, m");
    check_near(y, shape->pose.y, 1e-9, "y, m");
    check_near(0, planar_wrap(heading - shape->pose.heading), 1e-9, "heading, rad");
    check_near(speed * cos(heading), world.velocities[0].x, 1e-9, "velocity in x, m/s");
    check_near(speed * sin(heading), world.velocities[0].y, 1e-9, "velocity in y, m/s");
}

static void test_an_obstacle_that_stops(void)
{
    const struct patrol_obstacle obstacle = walker(PATROL_STOPS);
    TEST_ASSERT_TRUE(patrol_world_add(&world, &obstacle));
    TEST_ASSERT_EQUAL_INT(0, (int)world.shape_count);
    check_walker(1, 2, 1, 0, 0);
    check_walker(4, 3, 1, 0, 0.5);
    check_walker(7, 4, 1.5, M_PI / 2, 0.5);
    check_walker(8, 4, 2, M_PI / 2, 0);
    check_walker(30, 4, 2, M_PI / 2, 0);
}

static void test_an_obstacle_that_returns(void)
{
    const struct patrol_obstacle obstacle = walker(PATROL_RETURNS);
    TEST_ASSERT_TRUE(patrol_world_add(&world, &obstacle));
    check_walker(7, 4, 1.5, M_PI / 2, 0.5);
    check_walker(9, 4, 1.5, -M_PI / 2, 0.5);
    check_walker(12, 3, 1, M_PI, 0.5);
    check_walker(16, 3, 1, 0, 0.5);
}

static void test_an_obstacle_that_loops(void)
{
    const struct patrol_obstacle obstacle = walker(PATROL_LOOPS);
    const double back = atan2(-1, -2);
    const double round = 3 + sqrt(5);
    TEST_ASSERT_TRUE(patrol_world_add(&world, &obstacle));
    check_walker(9, 4 + 0.5 * cos(back), 2 + 0.5 * sin(back), back, 0.5);
    check_walker(4 + round / 0.5, 3, 1, 0, 0.5);
    check_walker(7 + 10 * round / 0.5, 4, 1.5, M_PI / 2, 0.5);
}

static void test_obstacles_that_stand(void)
{
    struct patrol_obstacle alone = standing(PLANAR_DISC, 3, 4);
    struct patrol_obstacle still = walker(PATROL_LOOPS);
    alone.speed = 1;
    still.speed = 0;
    still.appears = 0;
    TEST_ASSERT_TRUE(patrol_world_add(&world, &alone));
    TEST_ASSERT_TRUE(patrol_world_add(&world, &still));
    struct planar_pose away = {20, 7, 0};
    patrol_world_step(&world, &away, 100);
    check_near(3, world.shapes[0].pose.x, 0, "x of the one without a way, m");
    check_near(4, world.shapes[0].pose.y, 0, "y of the one without a way, m");
    check_near(2, world.shapes[1].pose.x, 0, "x of the one without speed, m");
}

/* The velocity is what the place changes by. */
static void test_velocities(void)
{
    add_random_obstacles(6);
    struct planar_pose away = {20, 7, 0};
    patrol_world_step(&world, &away, 10);
    for (int tick = 0; tick < 1000; tick++) {
        struct planar_pose before[PATROL_OBSTACLES_MAX];
        struct planar_point velocity[PATROL_OBSTACLES_MAX];
        for (size_t i = 0; i < world.shape_count; i++) {
            before[i] = world.shapes[i].pose;
            velocity[i] = world.velocities[i];
        }
        patrol_world_step(&world, &away, 1e-4);
        for (size_t i = 0; i < world.shape_count; i++) {
            const bool turned = velocity[i].x != world.velocities[i].x || velocity[i].y != world.velocities[i].y;
            const double dx = world.shapes[i].pose.x - before[i].x - 1e-4 * velocity[i].x;
            const double dy = world.shapes[i].pose.y - before[i].y - 1e-4 * velocity[i].y;
            check_near(0, hypot(dx, dy), turned ? 1e-3 : 1e-9, "way beside the velocity, m");
        }
    }
}

static void test_obstacles_are_bounded(void)
{
    const struct patrol_obstacle obstacle = standing(PLANAR_DISC, 3, 3);
    for (int i = 0; i < PATROL_OBSTACLES_MAX; i++) {
        TEST_ASSERT_TRUE(patrol_world_add(&world, &obstacle));
    }
    TEST_ASSERT_FALSE(patrol_world_add(&world, &obstacle));
    TEST_ASSERT_EQUAL_INT(PATROL_OBSTACLES_MAX, (int)world.shape_count);
}

/* One that appears on the robot is noticed at once. */
static void test_an_obstacle_that_appears(void)
{
    struct patrol_obstacle obstacle = standing(PLANAR_DISC, 12.1, 7);
    obstacle.appears = 1;
    TEST_ASSERT_TRUE(patrol_world_add(&world, &obstacle));
    for (int tick = 0; tick < 200; tick++) {
        patrol_world_step(&world, &centre, TICK);
        const bool there = world.time >= 1;
        TEST_ASSERT_EQUAL_INT(there ? PATROL_TOUCH_OBSTACLE : PATROL_TOUCH_NONE, world.touch);
    }
    check_near(1, world.first_touch_time, TICK + 1e-9, "s");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
