/* Robots that their sides steer follow random paths of the lattice by their own odometry, in closed loop with noise: on
 * level ground and on slopes. Where they are, is the plant's truth. */
#include <joulepath/tables.h>

#include "tests/support/options.h"
#include "tests/support/path_rig.h"
#include "tests/support/random_path.h"
#include "tests/support/skid_drive.h"
#include "tests/support/skid_robot_design.h"

/* Bars of the tracking, m. */
#define LEVEL_ERROR 0.05
#define SLOPE_ERROR 0.10

enum { ROBOTS = 2, STEPS = 16 };

static const struct options defaults = {.count = 3, .seed = 19};
static struct options options;
static struct random noise;
static struct jp_terrain terrain;
static struct random_path walk;
static struct skid_drive drive;

static struct robot {
    const char *file;
    const struct jp_skid_robot_config *config;
    double cell;
    struct skid_steer_model model;
    struct jp_skid_steer_config constants;
} robots[ROBOTS] = {{.file = "sim/robots/zhang2018.cfg", .config = &jp_skid_robot_zhang2018, .cell = 0.2},
                    {.file = "sim/robots/burger.cfg", .config = &jp_skid_robot_burger, .cell = 0.05}};

void setUp(void)
{
    random_init(&noise, options.seed);
    for (int i = 0; i < ROBOTS; i++) {
        TEST_ASSERT_TRUE(skid_robot_load(robots[i].file, &robots[i].model));
        robots[i].constants = path_rig_constants(&robots[i].model);
    }
}

void tearDown(void)
{
}

/* What the robot can do, by its controller. */
static struct jp_path_limits limits_of(const struct robot *robot)
{
    const struct jp_skid_limits *limits = &robot->config->limits;

    return (struct jp_path_limits){.speed = path_rig_q24(robot->model.lattice.speed_m_s),
                                   .turn_rate = path_rig_q24(robot->model.lattice.turn_rate_rad_s),
                                   .side_speed = limits->speed,
                                   .width = path_rig_q24(robot->model.body.width_m),
                                   .acceleration = limits->acceleration,
                                   .turn_acceleration = limits->turn_acceleration};
}

static struct jp_path_pose begin_of_path(void)
{
    return (struct jp_path_pose){walk.pieces[0].begin, walk.pieces[0].heading};
}

/* A random path, on a plane, with its speeds. */
static void plan(const struct robot *robot, double slope_x, double slope_y)
{
    const struct jp_path_limits limits = limits_of(robot);
    const struct jp_motion_price price = path_rig_price(&robot->model, &robot->constants);
    struct jp_path_cost cost;

    random_path_slope(&terrain, robot->cell, slope_x, slope_y);
    random_path_walk(&walk, &noise, &jp_lattice_zhang2018, &terrain, STEPS);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_plan_speeds(&walk.path, &limits, &price, &cost));
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
    const struct planar_pose pose = {begin.position.x / PATH_RIG_Q16, begin.position.y / PATH_RIG_Q16,
                                     path_rig_radians(begin.heading)};

    skid_drive_start(&drive, &robot->model, robot->config, ground, &pose, options.seed);
    ticks(0.1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&drive.robot));
    ticks(3);
    return pose;
}

/* Of the robot from the set-point, which odometry counts from the start. */
static double distance_from(const struct planar_pose *start)
{
    const struct jp_path_pose *at = &drive.robot.internal.follow.at.pose;
    const struct planar_pose pose = skid_plant_pose(&drive.world.plant);
    const double x = at->position.x / PATH_RIG_Q16;
    const double y = at->position.y / PATH_RIG_Q16;
    const double c = cos(start->heading);
    const double s = sin(start->heading);

    return hypot(start->x + x * c - y * s - pose.x, start->y + x * s + y * c - pose.y);
}

/* Drives the path to its end. Returns the greatest distance from the set-point, m. */
static double follow(const struct planar_pose *start)
{
    const struct jp_path_pose origin = begin_of_path();
    double worst = 0;

    jp_lattice_path_in_frame(&walk.path, &origin);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_follow(&drive.robot, &walk.path));
    skid_drive_tick(&drive);
    while (jp_skid_robot_state_now(&drive.robot) == JP_SKID_ROBOT_DRIVING) {
        skid_drive_tick(&drive);
        if (drive.robot.internal.follow.path != NULL) {
            worst = fmax(worst, distance_from(start));
        }
    }
    TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_STANDING, jp_skid_robot_state_now(&drive.robot));
    TEST_ASSERT_EQUAL_HEX16(0, drive.robot.internal.faults);
    return worst;
}

/* The greatest distance from the path of random drives on slopes of so many degrees. */
static double worst_of(const struct robot *robot, double degrees)
{
    double worst = 0;

    for (unsigned i = 0; i < (unsigned)options.count; i++) {
        const struct skid_slope slope = skid_slope_towards(degrees, random_uniform(&noise, -M_PI, M_PI));
        const struct skid_ground ground = degrees > 0 ? skid_ground_slope(&slope) : skid_level;

        plan(robot, slope.slope_x, slope.slope_y);
        const struct planar_pose start = stand(robot, &ground);
        worst = fmax(worst, follow(&start));
    }
    return worst;
}

static void test_level_ground(void)
{
    for (int i = 0; i < ROBOTS; i++) {
        const double worst = worst_of(&robots[i], 0);
        printf("%s: within %.1f mm of its path on level ground\n", robots[i].model.name, 1000 * worst);
        TEST_ASSERT_TRUE(worst <= LEVEL_ERROR);
    }
}

static void test_slopes(void)
{
    for (int i = 0; i < ROBOTS; i++) {
        const double degrees = robots[i].model.limits.slope_deg;
        const double worst = worst_of(&robots[i], degrees);
        printf("%s: within %.1f mm of its path on %.0f°\n", robots[i].model.name, 1000 * worst, degrees);
        TEST_ASSERT_TRUE(worst <= SLOPE_ERROR);
    }
}

static void test_a_stop_on_the_way(void)
{
    for (int i = 0; i < ROBOTS; i++) {
        plan(&robots[i], 0, 0);
        (void)stand(&robots[i], &skid_level);
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
