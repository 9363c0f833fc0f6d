/* Robots that their sides steer follow random paths of the lattice by their own odometry, in closed loop with noise: on
 * level ground and on slopes. Where they are, is the plant's truth. */
#include <joulepath/tables.h>

#include "tests/support/options.h"
#include <joulepath/skid_path_energy.h>

#include "sim/base/random.h"
#include "tests/support/random_path.h"
#include "tests/support/skid_drive.h"

/* Bars of the tracking, m. */
#define LEVEL_ERROR 0.05
#define SLOPE_ERROR 0.10
#define END_ERROR   0.02

/* What it may be from where it takes itself to be at the end, of the way: paths that turn all the time. A robot with
 * one axle climbs its steepest slope by nearly all that its tyres hold, and slips. */
#define LOST_SHARE          0.05
#define LOST_SHARE_ONE_AXLE 0.10

enum { ROBOTS = 2, STEPS = 16 };

static const struct options defaults = {.count = 3, .seed = 19};
static struct options options;
static struct random noise;
static struct jp_terrain terrain;
static struct random_path walk;
static struct skid_drive drive;

#define Q16       65536.0
#define HALF_TURN 2147483648.0

static const struct skid_ground level = {NULL, NULL};

static struct robot {
    const char *file;
    const struct jp_skid_robot_config *config;
    const struct jp_path_limits *limits;
    const struct jp_skid_energy_model *energy;
    const struct jp_lattice *lattice;
    struct skid_steer_model model;
} robots[ROBOTS] = {{.file = "sim/robots/zhang2018.cfg",
                     .config = &jp_skid_robot_zhang2018,
                     .limits = &jp_path_limits_zhang2018,
                     .energy = &jp_skid_energy_zhang2018,
                     .lattice = &jp_lattice_zhang2018},
                    {.file = "sim/robots/burger.cfg",
                     .config = &jp_skid_robot_burger,
                     .limits = &jp_path_limits_burger,
                     .energy = &jp_skid_energy_burger,
                     .lattice = &jp_lattice_burger}};

/* Greatest distances from the set-point, m. */
struct errors {
    double seen;       /* as the robot's odometry tells */
    double seen_end;   /* the same where it stands at the end */
    double true_place; /* where it is */
    double lost;       /* at the end from where it takes itself to be, share of the way */
    double turned;     /* by the path that turns most, rad */
};

void setUp(void)
{
    random_init(&noise, options.seed);
    for (int i = 0; i < ROBOTS; i++) {
        TEST_ASSERT_TRUE(skid_robot_load(robots[i].file, &robots[i].model));
    }
}

void tearDown(void)
{
}

static double radians(jp_angle angle)
{
    return (int32_t)angle * (M_PI / HALF_TURN);
}

static struct jp_path_pose begin_of_path(void)
{
    return (struct jp_path_pose){walk.pieces[0].begin, walk.pieces[0].heading};
}

/* A random path, on a plane, with its speeds. */
static void plan(const struct robot *robot, double slope_x, double slope_y)
{
    const struct jp_motion_price price = jp_skid_motion_price(robot->energy, 0);
    struct jp_path_cost cost;

    random_path_slope(&terrain, robot->lattice->resolution / Q16, slope_x, slope_y);
    random_path_walk(&walk, &noise, robot->lattice, &terrain, STEPS);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_plan_speeds(&walk.path, robot->limits, &price, &cost));
}

static void ticks(double seconds)
{
    for (int i = 0; i < (int)(seconds * drive.world.plant.model.control.rate_hz); i++) {
        skid_drive_tick(&drive);
    }
}

/* Switched on at the begin of the path, and standing long enough to know its gyro. */
static struct planar_pose stand(const struct robot *robot, const struct skid_ground *ground)
{
    const struct jp_path_pose begin = begin_of_path();
    const struct planar_pose pose = {begin.position.x / Q16, begin.position.y / Q16, radians(begin.heading)};

    skid_drive_start(&drive, &robot->model, robot->config, ground, &pose, options.seed);
    ticks(0.1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&drive.robot));
    ticks(3);
    return pose;
}

/* Where the robot is, as odometry counts from the start. */
static struct planar_pose place_from(const struct planar_pose *start)
{
    const struct planar_pose pose = skid_plant_pose(&drive.world.plant);

    return planar_between(start, &pose);
}

static double distance(const struct jp_point *at, double x, double y)
{
    return hypot(at->x / Q16 - x, at->y / Q16 - y);
}

static struct jp_point seen_place(void)
{
    const struct jp_skid_robot_internal *robot = &drive.robot.internal;
    struct jp_point seen;
    jp_angle heading;

    jp_skid_odometry_now(&robot->odometry, &robot->config->odometry, &seen, &heading);
    return seen;
}

static double seen_distance(const struct jp_point *at)
{
    const struct jp_point seen = seen_place();

    return distance(at, seen.x / Q16, seen.y / Q16);
}

static void measure(const struct planar_pose *start, struct errors *errors)
{
    const struct jp_point *at = &drive.robot.internal.follow.at.pose.position;
    const struct planar_pose place = place_from(start);

    errors->seen = fmax(errors->seen, seen_distance(at));
    errors->true_place = fmax(errors->true_place, distance(at, place.x, place.y));
}

static double way_of_path(void)
{
    double way = 0;

    for (unsigned i = 0; i < walk.path.count; i++) {
        way += walk.pieces[i].kind == JP_PIECE_CURVE ? walk.pieces[i].length / 16777216.0 : 0;
    }
    return way;
}

static double turn_of_path(void)
{
    double turned = 0;

    for (unsigned i = 0; i < walk.path.count; i++) {
        turned += fabs(jp_piece_turned(&walk.pieces[i], walk.pieces[i].length) / 16777216.0);
    }
    return turned;
}

/* Drives the path to its end. */
static void follow(const struct planar_pose *start, struct errors *errors)
{
    const struct jp_path_pose origin = begin_of_path();

    jp_lattice_path_in_frame(&walk.path, &origin);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_follow(&drive.robot, &walk.path));
    skid_drive_tick(&drive);
    while (jp_skid_robot_state_now(&drive.robot) == JP_SKID_ROBOT_DRIVING) {
        skid_drive_tick(&drive);
        if (drive.robot.internal.follow.path != NULL) {
            measure(start, errors);
        }
    }
    TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_STANDING, jp_skid_robot_state_now(&drive.robot));
    TEST_ASSERT_EQUAL_HEX16(0, drive.robot.internal.faults);
    errors->turned = fmax(errors->turned, turn_of_path());
    errors->seen_end = fmax(errors->seen_end, seen_distance(&walk.path.end.position));

    const struct jp_point seen = seen_place();
    const struct planar_pose place = place_from(start);

    errors->lost = fmax(errors->lost, distance(&seen, place.x, place.y) / way_of_path());
}

/* Of random drives on slopes of so many degrees. */
static struct errors worst_of(const struct robot *robot, double degrees)
{
    struct errors errors = {0, 0, 0, 0, 0};

    for (unsigned i = 0; i < (unsigned)options.count; i++) {
        const struct skid_slope slope = skid_slope_towards(degrees, random_uniform(&noise, -M_PI, M_PI));
        const struct skid_ground ground = degrees > 0 ? skid_ground_slope(&slope) : level;

        plan(robot, slope.slope_x, slope.slope_y);
        const struct planar_pose start = stand(robot, &ground);
        follow(&start, &errors);
    }
    printf("%s, %lu paths on %.0f°: at most %.1f mm from the set-point as it sees it, %.1f mm at the end, %.1f mm in "
           "truth; lost by %.2f %% of the way\n",
           robot->model.name, options.count, degrees, 1000 * errors.seen, 1000 * errors.seen_end,
           1000 * errors.true_place, 100 * errors.lost);
    return errors;
}

static void test_level_ground(void)
{
    for (int i = 0; i < ROBOTS; i++) {
        const struct errors errors = worst_of(&robots[i], 0);
        TEST_ASSERT_TRUE(errors.seen <= LEVEL_ERROR);
        TEST_ASSERT_TRUE(errors.seen_end <= END_ERROR);
        TEST_ASSERT_TRUE(errors.lost <= LOST_SHARE);
    }
}

/* A robot that scrubs as it turns slides down the slope meanwhile, by half its wheelbase a radian at most: it turns
 * about the axle uphill. */
static void test_slopes(void)
{
    for (int i = 0; i < ROBOTS; i++) {
        const struct errors errors = worst_of(&robots[i], robots[i].model.limits.slope_deg);
        const double slides = robots[i].model.body.wheelbase_m / 2 * errors.turned;
        TEST_ASSERT_TRUE(errors.seen <= SLOPE_ERROR + slides);
        TEST_ASSERT_TRUE(errors.lost <= (robots[i].model.wheel.axles > 1 ? LOST_SHARE : LOST_SHARE_ONE_AXLE));
    }
}

static void test_a_stop_on_the_way(void)
{
    for (int i = 0; i < ROBOTS; i++) {
        plan(&robots[i], 0, 0);
        (void)stand(&robots[i], &level);
        const struct jp_path_pose origin = begin_of_path();
        jp_lattice_path_in_frame(&walk.path, &origin);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_follow(&drive.robot, &walk.path));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_follow(&drive.robot, &walk.path));
        ticks(2);
        TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_DRIVING, jp_skid_robot_state_now(&drive.robot));
        TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_skid_robot_follow(&drive.robot, &walk.path));
        jp_skid_robot_stop(&drive.robot);
        ticks(4);
        TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_STANDING, jp_skid_robot_state_now(&drive.robot));
        TEST_ASSERT_NULL(drive.robot.internal.follow.path);
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, defaults);
    return RUN_PROPERTY(options, NULL);
}
