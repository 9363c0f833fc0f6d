/* Speeds along random paths and their set-points, against limits and costs in double; and the plant driven along them
 * in closed loop, on level ground and on slopes. */
#include <joulepath/path_corner.h>
#include <joulepath/tables.h>

#include "tests/support/options.h"
#include "tests/support/path_rig.h"
#include "tests/support/random_path.h"

/* Bars of the tracking, m. */
#define LEVEL_ERROR 0.05
#define SLOPE_ERROR 0.10

/* A robot that scrubs as it turns slides down a slope meanwhile, whatever its sides do: up to half its wheelbase by the
 * radian, since it turns about the axle uphill. The law halves that; of the paths here, m. */
#define SKID_SLOPE_ERROR 0.30

/* In curves it leans against that: of the worst of each path, the mean, m. */
#define SKID_CURVES_ERROR 0.10

/* Of the limits, for what is rounded. */
#define SPARE 1.002

/* Of the sides' speed, before a jump of the curvature. */
#define SIDE_SPARE 1.05

enum { ROBOTS = 2, STEPS = 40, DRIVEN_STEPS = 16 };

static const struct options defaults = {.count = 12, .seed = 19};
static struct options options;
static struct random noise;
static struct jp_terrain terrain;
static struct random_path walk;
static struct path_rig rig;

static struct robot {
    const char *file;
    const struct jp_lattice *lattice;
    const struct jp_skid_steer_config *constants;
    const struct jp_path_limits *limits;
    const struct jp_path_drive_config *steering;
    struct skid_steer_model model;
    struct jp_motion_price price;
} robots[ROBOTS] = {
    {.file = "sim/robots/zhang2018.cfg",
     .lattice = &jp_lattice_zhang2018,
     .constants = &jp_skid_steer_zhang2018,
     .limits = &jp_path_limits_zhang2018,
     .steering = &jp_path_drive_zhang2018},
    {.file = "sim/robots/burger.cfg",
     .lattice = &jp_lattice_burger,
     .constants = &jp_skid_steer_burger,
     .limits = &jp_path_limits_burger,
     .steering = &jp_path_drive_burger},
};

void setUp(void)
{
    random_init(&noise, options.seed);
    for (int i = 0; i < ROBOTS; i++) {
        struct robot *robot = &robots[i];
        TEST_ASSERT_TRUE(skid_robot_load(robot->file, &robot->model));
        robot->price = path_rig_price(&robot->model, robot->constants);
    }
}

void tearDown(void)
{
}

static double q24(jp_q24 value)
{
    return value / PATH_RIG_Q24;
}

static double q16(jp_q16 value)
{
    return value / PATH_RIG_Q16;
}

static void plan(const struct robot *robot, double slope_x, double slope_y, unsigned steps, struct jp_path_cost *cost)
{
    random_path_slope(&terrain, q16(robot->lattice->resolution), slope_x, slope_y);
    random_path_walk(&walk, &noise, robot->lattice, &terrain, steps);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_plan_speeds(&walk.path, robot->limits, &robot->price, cost));
}

/* ---- Speeds ---- */

static double bend_at(const struct jp_path_piece *piece, double share)
{
    return q24(piece->bend) + q16(piece->bend_rate) * q24(piece->length) * share;
}

/* W of a steady motion on a piece; along a curve its mean, by ten middles. */
static double power(const struct robot *robot, const struct jp_path_piece *piece, double speed)
{
    double sum = 0;

    if (piece->kind != JP_PIECE_CURVE) {
        const struct skid_steer_motion turn = {0, speed, 0};
        return skid_steer_power(&robot->model, JP_COST_PHYSICAL, &turn);
    }
    for (int i = 0; i < 10; i++) {
        const struct skid_steer_motion motion = {speed, speed * bend_at(piece, (i + 0.5) / 10),
                                                 q16(piece->rise) / q24(piece->length)};
        sum += skid_steer_power(&robot->model, JP_COST_PHYSICAL, &motion) / 10;
    }
    return sum;
}

static double speed_limit(const struct robot *robot, const struct jp_path_piece *piece)
{
    const struct jp_path_limits *limits = robot->limits;
    const double bend = fmax(fabs(bend_at(piece, 0)), fabs(bend_at(piece, 1)));

    if (piece->kind != JP_PIECE_CURVE) {
        return fmin(q24(limits->turn_rate), 2 * q24(limits->side_speed) / q24(limits->width));
    }
    return fmin(fmin(q24(limits->speed), q24(limits->turn_rate) / bend),
                fmin(q24(limits->side_speed) / (1 + bend * q24(limits->width) / 2),
                     sqrt(q24(limits->turn_acceleration) / 4 / fabs(q16(piece->bend_rate)))));
}

/* Speeds of all pieces that are planned by the price alone, as the first pass finds them, in double. */
static double cheapest(const struct robot *robot, const struct jp_path_piece *piece, double limit)
{
    double best = limit;

    for (int step = JP_SPEED_STEPS; step > 0; step--) {
        const double speed = limit * step / JP_SPEED_STEPS;
        const double price = q16(robot->price.time);
        if ((power(robot, piece, speed) + price) / speed < (power(robot, piece, best) + price) / best - 1e-9) {
            best = speed;
        }
    }
    return best;
}

static double meeting(const struct robot *robot, const struct jp_path_piece *last, const struct jp_path_piece *next)
{
    const double room = fmin(q24(last->length), q24(next->length)) / 2;
    const double jump = fabs(bend_at(next, 0) - bend_at(last, 1));

    if (last->kind != JP_PIECE_CURVE || next->kind != JP_PIECE_CURVE) {
        return 0;
    }
    return sqrt(q24(robot->limits->turn_acceleration) * room / jump / 2);
}

static double acceleration(const struct robot *robot, const struct jp_path_piece *piece)
{
    const struct jp_path_piece *last = &walk.path.pieces[walk.path.count - 1];
    double bend = fmax(fabs(bend_at(piece, 0)), fabs(bend_at(piece, 1)));

    if (piece->kind != JP_PIECE_CURVE) {
        return q24(robot->limits->turn_acceleration);
    }
    if (piece > walk.path.pieces && piece[-1].kind == JP_PIECE_CURVE) {
        bend = fmax(bend, fabs(bend_at(piece, 0) - bend_at(&piece[-1], 1)));
    }
    if (piece < last && piece[1].kind == JP_PIECE_CURVE) {
        bend = fmax(bend, fabs(bend_at(&piece[1], 0) - bend_at(piece, 1)));
    }
    return fmin(q24(robot->limits->acceleration), q24(robot->limits->turn_acceleration) / 4 / bend);
}

/* The speeds at the pieces' ends are the greatest that all limits leave. */
static void check_speeds(const struct robot *robot)
{
    static double cruise[RANDOM_PATH_PIECES];
    static double ends[RANDOM_PATH_PIECES + 1];
    const struct jp_path_piece *pieces = walk.path.pieces;
    const unsigned count = walk.path.count;

    for (unsigned i = 0; i < count; i++) {
        cruise[i] = cheapest(robot, &pieces[i], speed_limit(robot, &pieces[i]));
    }
    ends[0] = ends[count] = 0;
    for (unsigned i = 1; i < count; i++) {
        const double highest =
            sqrt(ends[i - 1] * ends[i - 1] + 2 * acceleration(robot, &pieces[i - 1]) * q24(pieces[i - 1].length));
        ends[i] = fmin(fmin(highest, meeting(robot, &pieces[i - 1], &pieces[i])), fmin(cruise[i - 1], cruise[i]));
    }
    for (unsigned i = count; i-- > 0;) {
        ends[i] = fmin(ends[i],
                       sqrt(ends[i + 1] * ends[i + 1] + 2 * acceleration(robot, &pieces[i]) * q24(pieces[i].length)));
    }
    for (unsigned i = 0; i < count; i++) {
        const double way = acceleration(robot, &pieces[i]) * q24(pieces[i].length);
        const double highest = sqrt((ends[i] * ends[i] + ends[i + 1] * ends[i + 1]) / 2 + way);

        check_near(ends[i + 1], q24(pieces[i].speed.end), 2e-4, "m/s at a piece's end");
        check_near(fmin(cruise[i], highest), q24(pieces[i].speed.cruise), 2e-4, "m/s on a piece");
    }
}

static void test_speeds_are_those_that_cost_least_within_the_limits(void)
{
    for (unsigned long i = 0; i < 10 * options.count; i++) {
        struct robot *robot = &robots[i % ROBOTS];
        struct jp_path_cost cost;

        robot->price.time = path_rig_q16(i % 4 < 2 ? 0 : random_uniform(&noise, 0, 100));
        plan(robot, random_uniform(&noise, -0.2, 0.2), random_uniform(&noise, -0.2, 0.2), STEPS, &cost);
        check_speeds(robot);
    }
}

/* ---- Set-points ---- */

struct margins {
    double speed;
    double turn_rate;
    double side;
    double acceleration;
    double turn_acceleration;
    double pose; /* of the set-points' motion, integrated, from their poses, m */
    double duration;
};

static void raise(double *most, double value)
{
    *most = fmax(*most, value);
}

/* Shares of the limits. */
static void check_set_point(const struct robot *robot, const struct jp_path_set_point *at, struct margins *most)
{
    const struct jp_path_limits *limits = robot->limits;
    const double v = q24(at->motion.speed);
    const double w = q24(at->motion.turn_rate);

    TEST_ASSERT_TRUE(v >= 0);
    raise(&most->speed, v / q24(limits->speed));
    raise(&most->turn_rate, fabs(w) / q24(limits->turn_rate));
    raise(&most->side, (v + fabs(w) * q24(limits->width) / 2) / q24(limits->side_speed));
    raise(&most->acceleration, fabs(q24(at->acceleration)) / q24(limits->acceleration));
    raise(&most->turn_acceleration, fabs(q24(at->turn_acceleration)) / q24(limits->turn_acceleration));
}

static struct planar_pose planar(const struct jp_path_pose *pose)
{
    return (struct planar_pose){q16(pose->position.x), q16(pose->position.y), path_rig_radians(pose->heading)};
}

/* Each set-point is one step of its motion from the last, but for what a blend of the curvature leaves the path. */
static void check_step(const struct jp_path_set_point *last, const struct jp_path_set_point *at, struct margins *most)
{
    const double seconds = (double)JP_TICKS_PER_PATH_POINT / PATH_RIG_TICK_RATE;
    const double v = (q24(last->motion.speed) + q24(at->motion.speed)) / 2;
    const struct planar_pose from = planar(&last->pose);
    const struct planar_pose to = planar(&at->pose);
    const struct planar_pose moved = planar_between(&from, &to);

    raise(&most->pose, hypot(moved.x - v * seconds, moved.y));
}

static void drive_set_points(const struct robot *robot, const struct jp_path_cost *cost, struct margins *most)
{
    struct jp_path_drive_config config = *robot->steering;
    struct jp_path_set_point last = {.pose = {walk.path.pieces[0].begin, walk.path.pieces[0].heading}};
    struct jp_path_set_point at;
    struct jp_path_drive drive;
    const char *field = "";
    unsigned count = 0;

    config.tick_rate = PATH_RIG_TICK_RATE;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_drive_init(&drive, &config, &field));
    jp_path_drive_begin(&drive, &walk.path);
    for (; jp_path_drive_advance(&drive, &at); count++) {
        check_set_point(robot, &at, most);
        check_step(&last, &at, most);
        last = at;
    }
    const double seconds = (double)count * JP_TICKS_PER_PATH_POINT / PATH_RIG_TICK_RATE;
    raise(&most->duration, fabs(seconds - q16(cost->duration)) / walk.path.count);
    TEST_ASSERT_EQUAL_INT32(walk.path.end.position.x, last.pose.position.x);
    TEST_ASSERT_EQUAL_INT32(walk.path.end.position.y, last.pose.position.y);
    TEST_ASSERT_EQUAL_UINT32(walk.path.end.heading, last.pose.heading);
    TEST_ASSERT_EQUAL_INT32(0, last.motion.speed);
    TEST_ASSERT_EQUAL_INT32(0, last.motion.turn_rate);
}

static void test_set_points_keep_the_limits_and_the_path(void)
{
    for (int i = 0; i < ROBOTS; i++) {
        struct margins most = {0};

        for (unsigned long k = 0; k < options.count; k++) {
            struct jp_path_cost cost;
            plan(&robots[i], random_uniform(&noise, -0.2, 0.2), random_uniform(&noise, -0.2, 0.2), STEPS, &cost);
            drive_set_points(&robots[i], &cost, &most);
        }
        (void)printf("%s, most of the limits: speed %.4f, turn rate %.4f, sides %.4f, acceleration %.4f and turn "
                     "acceleration %.4f; %.2g m off a step, duration off by %.4f s a piece\n",
                     robots[i].model.name, most.speed, most.turn_rate, most.side, most.acceleration,
                     most.turn_acceleration, most.pose, most.duration);
        check_below(most.speed, SPARE, "speed");
        check_below(most.turn_rate, SPARE, "turn rate");
        check_below(most.side, SIDE_SPARE, "speed of a side");
        check_below(most.acceleration, SPARE, "acceleration");
        check_below(most.turn_acceleration, SPARE, "turn acceleration");
        check_below(most.pose, 1e-4, "m off a step");
        check_below(most.duration, 0.01, "s a piece of duration");
    }
}

/* ---- Corners ---- */

static double cost_of(const struct robot *robot)
{
    struct jp_path_cost cost;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_plan_speeds(&walk.path, robot->limits, &robot->price, &cost));
    return q16(cost.energy) + q16(robot->price.time) * q16(cost.duration);
}

/* The arc leads from the one line to the other, passes the corner no farther off and is no tighter than it may. */
static void check_arc(const struct jp_path_piece *arc, struct jp_point corner, const struct jp_corner_room *room)
{
    const double length = q24(arc->length);
    const double bend = q24(arc->bend);
    const struct planar_pose begin = {q16(arc->begin.x), q16(arc->begin.y), path_rig_radians(arc->heading)};
    const struct planar_pose along = {sin(bend * length) / bend, (1 - cos(bend * length)) / bend, bend * length};
    const struct planar_pose half = {sin(bend * length / 2) / bend, (1 - cos(bend * length / 2)) / bend, 0};
    const struct planar_pose end = planar_compose(&begin, &along);
    const struct planar_pose middle = planar_compose(&begin, &half);

    check_near(q16(arc[1].begin.x), end.x, 2e-4, "m, x of an arc's end");
    check_near(q16(arc[1].begin.y), end.y, 2e-4, "m, y of an arc's end");
    check_near(0, planar_wrap(end.heading - path_rig_radians(arc[1].heading)), 1e-4, "rad at an arc's end");
    check_below(hypot(middle.x - q16(corner.x), middle.y - q16(corner.y)), q24(room->clearance) + 1e-4,
                "m inside a corner");
    check_below(fabs(bend), 1 / q24(room->radius_min) * 1.001, "1/m, bend of an arc");
}

static unsigned round_corners(const struct robot *robot, const struct jp_corner_room *room)
{
    unsigned count = 0;

    for (uint16_t i = 0; i < walk.path.count; i++) {
        const struct jp_point corner = walk.pieces[i].begin;
        const double before = cost_of(robot);

        if (jp_path_round_corner(&walk.path, i, room, robot->limits, &robot->price)) {
            check_arc(&walk.pieces[i], corner, room);
            check_below(cost_of(robot), before + 0.01, "J with a corner more that is round");
            count++;
        }
    }
    return count;
}

static void test_round_corners_cost_less(void)
{
    unsigned count = 0;

    for (unsigned long i = 0; i < 10 * options.count; i++) {
        const struct robot *robot = &robots[i % ROBOTS];
        struct jp_path_cost cost;

        plan(robot, random_uniform(&noise, -0.1, 0.1), random_uniform(&noise, -0.1, 0.1), STEPS, &cost);
        const struct jp_corner_room room = {(jp_q24)(random_uniform(&noise, 0, 0.3) * PATH_RIG_Q24),
                                            (jp_q24)(random_uniform(&noise, 0.02, 0.6) * PATH_RIG_Q24)};

        count += round_corners(robot, &room);
    }
    (void)printf("%u corners are round\n", count);
    TEST_ASSERT_TRUE(count > 0);
}

/* ---- Closed loop ---- */

static bool has_turns_on_the_spot(void)
{
    bool has = false;

    for (unsigned i = 0; i < walk.path.count; i++) {
        has = has || walk.pieces[i].kind != JP_PIECE_CURVE;
    }
    return has;
}

static void drive_plant(const struct robot *robot, double degrees, bool may_turn, double *worst)
{
    const struct skid_slope slope = skid_slope_towards(degrees, random_uniform(&noise, -M_PI, M_PI));
    const struct skid_ground ground = skid_ground_slope(&slope);
    struct jp_path_cost cost;

    do {
        plan(robot, slope.slope_x, slope.slope_y, DRIVEN_STEPS, &cost);
    } while (!may_turn && has_turns_on_the_spot());
    TEST_ASSERT_TRUE(path_rig_start(&rig, &robot->model, robot->steering, &ground, &walk.path));
    path_rig_drive(&rig);
    TEST_ASSERT_FALSE(rig.robot.plant.tipped);
    raise(worst, rig.worst_distance);
    if (options.verbose) {
        (void)printf("%s, %4.1f degrees: %u pieces, %.1f m in %.1f s (planned %.1f s); worst %.1f mm ahead, %.1f mm "
                     "aside, %.3f rad; %.1f J, planned %.1f J\n",
                     robot->model.name, degrees, walk.path.count, rig.way, rig.seconds, q16(cost.duration),
                     1e3 * rig.worst.ahead, 1e3 * rig.worst.left, rig.worst.turned,
                     rig.robot.plant.state.ledger.battery, q16(cost.energy));
    }
}

/* The worst of paths on a share of the robot's steepest slope. */
static double worst_tracking(const struct robot *robot, double share_of_slope, const char *where)
{
    double worst = 0;

    for (unsigned long k = 0; k < options.count; k++) {
        drive_plant(robot, share_of_slope * robot->model.limits.slope_deg, true, &worst);
    }
    (void)printf("%s, %lu paths %s: at most %.1f mm from the set-point\n", robot->model.name, options.count, where,
                 1e3 * worst);
    return worst;
}

static void test_tracking_on_level_ground(void)
{
    for (int i = 0; i < ROBOTS; i++) {
        check_below(worst_tracking(&robots[i], 0, "on level ground"), LEVEL_ERROR, "m from the set-point");
    }
}

static void test_tracking_on_the_steepest_slope(void)
{
    for (int i = 0; i < ROBOTS; i++) {
        const double bar = robots[i].model.wheel.axles > 1 ? SKID_SLOPE_ERROR : SLOPE_ERROR;

        check_below(worst_tracking(&robots[i], 1, "on the steepest slope"), bar, "m from the set-point");
    }
}

static void test_curves_on_the_steepest_slope(void)
{
    for (int i = 0; i < ROBOTS; i++) {
        double sum = 0;

        for (unsigned long k = 0; k < options.count; k++) {
            double worst = 0;

            drive_plant(&robots[i], robots[i].model.limits.slope_deg, false, &worst);
            sum += worst;
        }
        (void)printf("%s, %lu paths of curves on the steepest slope: %.1f mm from the set-point, mean of the worst\n",
                     robots[i].model.name, options.count, 1e3 * sum / (double)options.count);
        check_below(sum / (double)options.count, SKID_CURVES_ERROR, "m from the set-point, mean of the worst");
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, defaults);
    return RUN_PROPERTY(options, NULL);
}
