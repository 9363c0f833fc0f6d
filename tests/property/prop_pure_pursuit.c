/*
 * joulepath/pure_pursuit.h in closed loop over random smooth paths: a unicycle in double, and the four wheels of
 * joulepath/four_wheel.h, which need ticks to steer. Each tick is compared with the law in double.
 *
 * prop_pure_pursuit [--count N] [--seed S] [--json FILE]
 * --count is the number of paths of each kind; 2000 for the full check.
 */
#include <joulepath/pure_pursuit.h>

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

#define Q16    65536.0
#define Q24    16777216.0
#define TURN   4294967296.0
#define PI     3.14159265358979323846
#define PERIOD 0.02 /* s */

#define ERROR_BAR       0.05 /* m, at 1 m/s */
#define LAW_BAR         1e-3 /* of curvature_max: points stand on a grid of 15 µm */
#define SIDEWAYS_BAR    0.05 /* m/s, while the wheels go from one twist to another */
#define CURVATURE_SHARE 0.7  /* of curvature_max, at most, of the paths */

#define GRID        (1.4143 / Q16) /* m, from one place to the next, at most */
#define FORMATS_BAR (2 * GRID)     /* of the way between two places */

#define ROOM 4 /* radii of the tightest turn, enough to come round from any heading */

enum { POINTS = 4000, TICKS_MAX = 30000 };

struct pose {
    double x, y, heading;
};

/* Largest distance from the path at a speed, m. */
static struct {
    double speed;
    double unicycle;
    double wheels;
} speeds[] = {{.speed = 0.25}, {.speed = 0.5}, {.speed = 1}, {.speed = 1.5}, {.speed = 2}};

enum { REFERENCE = 2, SPEEDS = sizeof speeds / sizeof speeds[0] };

static struct options options = {.count = 40, .seed = 1};
static double worst_law;

void setUp(void)
{
}

void tearDown(void)
{
}

static jp_q24 q24(double x)
{
    return (jp_q24)lround(x * Q24);
}

/* A smooth path of `length` whose curvature is a sum of three waves, at most `curvature`. */
struct road {
    struct jp_point points[POINTS];
    double beyond[POINTS]; /* length of the chords after chord i, m */
    size_t count;
    struct pose start;
};

/* From point i to the next, m. */
static struct pose chord_of(const struct road *road, size_t i)
{
    const double dx = (road->points[i + 1].x - road->points[i].x) / Q16;
    const double dy = (road->points[i + 1].y - road->points[i].y) / Q16;

    return (struct pose){dx, dy, atan2(dy, dx)};
}

static void make_road(struct road *road, double length, double spacing, double curvature)
{
    const double waves[3] = {uniform(0.2, 1), uniform(0.2, 1), uniform(0.2, 1)};
    const double phases[3] = {uniform(0, 2 * PI), uniform(0, 2 * PI), uniform(0, 2 * PI)};
    const int steps = 20;
    struct pose pose = {uniform(-1000, 1000), uniform(-1000, 1000), uniform(-PI, PI)};

    road->start = pose;
    road->count = (size_t)fmax(2, fmin(POINTS, length / spacing + 1));
    for (size_t i = 0; i < road->count; i++) {
        road->points[i] = (struct jp_point){(jp_q16)lround(pose.x * Q16), (jp_q16)lround(pose.y * Q16)};
        for (int step = 0; step < steps; step++) {
            const double s = ((double)i + (double)step / steps) * spacing;
            double sum = 0;
            for (int wave = 0; wave < 3; wave++) {
                sum += sin(waves[wave] * s + phases[wave]) / 3;
            }
            pose.heading += curvature * sum * spacing / steps;
            pose.x += cos(pose.heading) * spacing / steps;
            pose.y += sin(pose.heading) * spacing / steps;
        }
    }
    road->beyond[road->count - 2] = 0;
    for (size_t i = road->count - 2; i > 0; i--) {
        const struct pose chord = chord_of(road, i);
        road->beyond[i - 1] = road->beyond[i] + hypot(chord.x, chord.y);
    }
}

/* Distance of a point from the path's chord i, m; *part of the chord to its foot. */
static double chord_distance(const struct road *road, size_t i, const struct pose *pose, double *part)
{
    const double x = road->points[i].x / Q16;
    const double y = road->points[i].y / Q16;
    const double dx = road->points[i + 1].x / Q16 - x;
    const double dy = road->points[i + 1].y / Q16 - y;
    const double t = ((pose->x - x) * dx + (pose->y - y) * dy) / (dx * dx + dy * dy);

    *part = fmax(0, fmin(1, t));
    return hypot(x + *part * dx - pose->x, y + *part * dy - pose->y);
}

/* Of the path from the foot of the perpendicular on the line through a chord, m. */
static double left_from(const struct road *road, size_t chord, const struct jp_point *position)
{
    const struct pose along = chord_of(road, chord);
    const double x = (road->points[chord + 1].x - position->x) / Q16;
    const double y = (road->points[chord + 1].y - position->y) / Q16;

    return road->beyond[chord] + fmax(0, x * cos(along.heading) + y * sin(along.heading));
}

/* To the nearest chord of those around a place on the road. */
static double distance_near(const struct road *road, size_t place, const struct pose *pose)
{
    double least = INFINITY;
    double part = 0;

    for (size_t i = place > 50 ? place - 50 : 0; i + 1 < road->count && i < place + 50; i++) {
        least = fmin(least, chord_distance(road, i, pose, &part));
    }
    return least;
}

/* A patrol robot of the paper's kind. */
static const struct jp_four_wheel_config patrol_wheels = {
    .wheelbase = JP_Q24(0.5),
    .track = JP_Q24(0.44),
    .steering_limit = (int32_t)JP_ANGLE_DEGREES(100),
    .steering_step = (int32_t)JP_ANGLE_DEGREES(3.4),
    .speed_max = JP_Q24(4),
    .speed_step = JP_Q24(0.04),
};

/* For paths of curvatures up to 0.7/m. */
static struct jp_pure_pursuit_config patrol_config(double speed)
{
    return (struct jp_pure_pursuit_config){
        .speed = q24(speed),
        .lookahead_time = q24(0.4),
        .lookahead_min = q24(0.25),
        .lookahead_max = q24(2),
        .curvature_max = q24(1),
        .lateral_acceleration = q24(1.5),
        .acceleration = q24(1),
        .tolerance = q24(0.02),
    };
}

static struct jp_pure_pursuit_config random_config(double speed)
{
    const double lookahead = log_uniform(0.15, 0.5);

    return (struct jp_pure_pursuit_config){
        .speed = q24(speed),
        .lookahead_time = q24(uniform(0.25, 0.5)),
        .lookahead_min = q24(lookahead),
        .lookahead_max = q24(lookahead + uniform(0.5, 2)),
        .curvature_max = q24(uniform(1, 4)),
        .lateral_acceleration = q24(uniform(0.5, 4)),
        .acceleration = q24(uniform(0.5, 2)),
        .tolerance = q24(uniform(0.01, 0.05)),
    };
}

/* The point at distance `lookahead` along the path from where the tracker is, in double: the curvature to it, 1/m, or
 * NAN where the stated law has another branch. */
static double law_curvature(const struct road *road, const struct jp_pure_pursuit *tracker, const struct pose *pose,
                            double lookahead)
{
    for (size_t i = tracker->passed; i + 1 < road->count && i < tracker->passed + JP_PURSUIT_AHEAD; i++) {
        const double x = road->points[i].x / Q16 - pose->x;
        const double y = road->points[i].y / Q16 - pose->y;
        const double dx = road->points[i + 1].x / Q16 - pose->x - x;
        const double dy = road->points[i + 1].y / Q16 - pose->y - y;
        const double a = dx * dx + dy * dy;
        const double b = x * dx + y * dy;
        const double c = x * x + y * y - lookahead * lookahead;
        const double t = (-b + sqrt(b * b - a * c)) / a;
        if (hypot(x + dx, y + dy) >= lookahead) {
            const double forward = (x + t * dx) * cos(pose->heading) + (y + t * dy) * sin(pose->heading);
            const double left = (y + t * dy) * cos(pose->heading) - (x + t * dx) * sin(pose->heading);
            return t >= 0 && forward >= 0 ? 2 * left / (lookahead * lookahead) : NAN;
        }
    }
    return NAN;
}

struct drive {
    struct road road;
    struct jp_pure_pursuit tracker;
    struct pose pose;
    double speed;  /* last asked for */
    double error;  /* largest distance from the path, m */
    size_t chord;  /* that the robot was on in the last tick */
    double left;   /* of the path from there, m */
    double cut;    /* of the path, m: what was passed since without being driven, and braking has not yet made up */
    double inside; /* what a robot inside the path's turns can have cut since then, m */
    int ticks;
};

static void start(struct drive *drive, const struct jp_pure_pursuit_config *config, double spacing)
{
    const char *field = "none";

    make_road(&drive->road, uniform(3, 30), spacing, CURVATURE_SHARE * config->curvature_max / Q24);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pure_pursuit_init(&drive->tracker, config, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pure_pursuit_follow(&drive->tracker, drive->road.points, drive->road.count));
    drive->pose = drive->road.start;
    drive->speed = 0;
    drive->error = 0;
    drive->chord = 0;
    drive->left = left_from(&drive->road, 0, &drive->road.points[0]);
    drive->cut = 0;
    drive->inside = 0;
    drive->ticks = 0;
}

/* Speed, acceleration and curvature within their limits; the curvature is that of the law. */
static void check_twist(const struct drive *drive, const struct pose *pose, const struct jp_twist *twist)
{
    const struct jp_pure_pursuit_config *config = &drive->tracker.config;
    const double v = twist->x / Q24;
    const double curvature = v > 0.01 ? twist->turn_rate / Q24 / v : 0;
    const double rate = config->acceleration / Q24 * PERIOD;
    const double most = config->lateral_acceleration / Q24;
    const double wanted = config->lookahead_time / Q24 * drive->speed;
    const double lookahead = fmax(config->lookahead_min / Q24, fmin(config->lookahead_max / Q24, wanted));
    const double law = law_curvature(&drive->road, &drive->tracker, pose, lookahead);

    TEST_ASSERT_EQUAL_INT32(0, twist->y);
    TEST_ASSERT_TRUE(v >= 0 && v <= config->speed / Q24);
    TEST_ASSERT_TRUE(fabs(v - drive->speed) <= rate + 1e-6);
    TEST_ASSERT_TRUE(fabs(curvature) <= config->curvature_max / Q24 + 1e-5);
    TEST_ASSERT_TRUE(v * v * fabs(curvature) <= most * (1 + 1e-5));
    if (!isnan(law) && v > 0.1 && v * v * fabs(law) < 0.999 * most) {
        const double limited = fmax(-config->curvature_max / Q24, fmin(config->curvature_max / Q24, law));
        worst_law = fmax(worst_law, fabs(curvature - limited) / (config->curvature_max / Q24));
    }
}

static struct jp_point position_of(const struct pose *pose)
{
    return (struct jp_point){(jp_q16)lround(pose->x * Q16), (jp_q16)lround(pose->y * Q16)};
}

static jp_angle heading_of(const struct pose *pose)
{
    return (jp_angle)llround(pose->heading / (2 * PI) * TURN);
}

/* The pose as the tracker sees it. */
static enum jp_status tick(struct drive *drive, struct jp_twist *twist)
{
    const struct jp_point position = position_of(&drive->pose);
    const struct pose seen = {position.x / Q16, position.y / Q16, drive->pose.heading};
    const enum jp_status status = jp_pure_pursuit_tick(&drive->tracker, &position, heading_of(&drive->pose),
                                                       q24(drive->speed), q24(PERIOD), twist);
    if (status == JP_OK) {
        check_twist(drive, &seen, twist);
    }
    drive->speed = twist->x / Q24;
    drive->ticks++;
    return status;
}

static void move(struct drive *drive, double v, double turn_rate)
{
    struct pose *pose = &drive->pose;

    pose->heading += turn_rate * PERIOD / 2;
    pose->x += v * cos(pose->heading) * PERIOD;
    pose->y += v * sin(pose->heading) * PERIOD;
    pose->heading += turn_rate * PERIOD / 2;
    drive->error = fmax(drive->error, distance_near(&drive->road, drive->tracker.passed, pose));
}

/* The chord on which the tracker was in this tick: when it has arrived, which it keeps to itself, the nearest. */
static size_t chord_now(const struct drive *drive)
{
    size_t nearest = drive->chord;
    double least = INFINITY;

    if (drive->tracker.passed < drive->road.count) {
        return drive->tracker.passed;
    }
    for (size_t i = drive->chord; i + 1 < drive->road.count; i++) {
        double part;
        const double distance = chord_distance(&drive->road, i, &drive->pose, &part);
        nearest = distance <= least ? i : nearest;
        least = fmin(least, distance);
    }
    return nearest;
}

/* How far beyond a point of the path the robot may be when it passes it: the next chord is as near as that point, but
 * for the grid. */
static double late_passing(double distance)
{
    return sqrt(GRID * (2 * distance + GRID));
}

/* Adds what was cut of the path since the last tick: passed, but not driven. Where the path turns by δ a robot at
 * distance d inside cuts 2 d tan(δ/2); between two ticks it is farther inside than in either by its way times δ at
 * most. */
static void measure_cut(struct drive *drive, double driven)
{
    const struct road *road = &drive->road;
    const struct jp_point position = position_of(&drive->pose);
    const size_t chord = chord_now(drive);
    const double left = left_from(road, chord, &position);

    for (size_t i = drive->chord; i < chord; i++) {
        const double turn = fabs(remainder(chord_of(road, i + 1).heading - chord_of(road, i).heading, 2 * PI));
        drive->inside += 2 * (drive->error + driven * turn) * tan(turn / 2);
    }
    drive->cut += drive->left - left - driven;
    drive->chord = chord;
    drive->left = left;
    TEST_ASSERT_TRUE(drive->cut <= drive->inside + late_passing(drive->error) + FORMATS_BAR);
}

/* The speed v is one that stops on the way left after one more tick: v² + 2 a v T <= 2 a left. Where that falls by a
 * cut the robot can do no more than brake: v² + 2 a v T falls by 2 a v T + (a T)², what it drives and a T²/2 more. */
static void check_braking(struct drive *drive)
{
    const double acceleration = drive->tracker.config.acceleration / Q24;
    const double v = drive->speed;

    drive->cut = fmax(0, drive->cut - acceleration * PERIOD * PERIOD / 2);
    drive->inside = drive->cut > 0 ? drive->inside : 0;
    TEST_ASSERT_TRUE(v * v / 2 + acceleration * v * PERIOD <= acceleration * (drive->left + drive->cut + FORMATS_BAR));
}

/* Arrived: the way left is the tolerance at most, and so the speed before was one that stops on it and on what was cut.
 */
static void check_arrival(const struct drive *drive, double speed)
{
    const struct jp_pure_pursuit_config *config = &drive->tracker.config;
    const struct jp_point *end = &drive->road.points[drive->road.count - 1];
    const double distance = hypot(end->x / Q16 - drive->pose.x, end->y / Q16 - drive->pose.y);
    const double tolerance = config->tolerance / Q24;

    TEST_ASSERT_TRUE(distance <= tolerance + drive->error + 0.001);
    TEST_ASSERT_TRUE(speed * speed / 2 <= config->acceleration / Q24 * (tolerance + drive->cut + FORMATS_BAR));
}

static void drive_unicycle(struct drive *drive)
{
    struct jp_twist twist;
    double speed = 0;
    enum jp_status status = tick(drive, &twist);

    while (status == JP_OK && drive->ticks < TICKS_MAX) {
        check_braking(drive);
        speed = drive->speed;
        move(drive, twist.x / Q24, twist.turn_rate / Q24);
        status = tick(drive, &twist);
        measure_cut(drive, speed * PERIOD);
    }
    TEST_ASSERT_EQUAL_INT(JP_ARRIVED, status);
    TEST_ASSERT_EQUAL_INT32(0, twist.x);
    TEST_ASSERT_EQUAL_INT32(0, twist.turn_rate);
    check_arrival(drive, speed);
    TEST_ASSERT_EQUAL_INT(JP_ARRIVED, tick(drive, &twist));
}

static void test_unicycle_follows(void)
{
    static struct drive drive;

    begin_random(options.seed, 0);
    for (int i = 0; i < SPEEDS; i++) {
        for (unsigned long path = 0; path < options.count; path++) {
            const struct jp_pure_pursuit_config config = patrol_config(speeds[i].speed);
            start(&drive, &config, log_uniform(0.02, 0.1));
            drive_unicycle(&drive);
            speeds[i].unicycle = fmax(speeds[i].unicycle, drive.error);
        }
        printf("unicycle at %.2f m/s: largest error %.4f m\n", speeds[i].speed, speeds[i].unicycle);
    }
    TEST_ASSERT_TRUE(speeds[REFERENCE].unicycle <= ERROR_BAR);
}

/* What the four wheels do of it in a tick. */
static void move_wheels(struct drive *drive, const struct jp_twist *twist, struct jp_wheels *wheels)
{
    enum jp_steering steering;
    struct jp_twist moved;
    jp_q24 slip;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_tick(&patrol_wheels, twist, wheels, &steering));
    jp_four_wheel_forward(&patrol_wheels, wheels, &moved, &slip);
    TEST_ASSERT_TRUE(slip <= JP_WHEEL_HOLD_SPEED);
    move(drive, moved.x / Q24, moved.turn_rate / Q24);
    TEST_ASSERT_TRUE(fabs(moved.y / Q24) <= SIDEWAYS_BAR);
}

static void test_four_wheels_follow(void)
{
    static struct drive drive;

    begin_random(options.seed, 1);
    for (int i = 0; i < SPEEDS; i++) {
        for (unsigned long path = 0; path < options.count; path++) {
            const struct jp_pure_pursuit_config config = patrol_config(speeds[i].speed);
            struct jp_wheels wheels = {{0}, {0}};
            struct jp_twist twist;
            enum jp_status status;

            start(&drive, &config, log_uniform(0.02, 0.1));
            while ((status = tick(&drive, &twist)) == JP_OK && drive.ticks < TICKS_MAX) {
                move_wheels(&drive, &twist, &wheels);
            }
            TEST_ASSERT_EQUAL_INT(JP_ARRIVED, status);
            speeds[i].wheels = fmax(speeds[i].wheels, drive.error);
        }
        printf("four wheels at %.2f m/s: largest error %.4f m\n", speeds[i].speed, speeds[i].wheels);
    }
    TEST_ASSERT_TRUE(speeds[REFERENCE].wheels <= ERROR_BAR);
}

/* From beside the path in any direction: the limits hold, and it arrives or says that it is too far off. With a
 * lookahead of ROOM turns' radii beyond where it begins it always arrives. */
static void test_from_beside_the_path(void)
{
    static struct drive drive;
    unsigned long arrived = 0;
    unsigned long certain = 0;

    begin_random(options.seed, 2);
    for (unsigned long path = 0; path < 4 * options.count; path++) {
        const struct jp_pure_pursuit_config config = random_config(log_uniform(0.1, 4));
        struct jp_twist twist;
        enum jp_status status;

        start(&drive, &config, log_uniform(0.005, 2));
        const double beside_x = uniform(-0.3, 0.3);
        const double beside_y = uniform(-0.3, 0.3);
        drive.pose.x += beside_x;
        drive.pose.y += beside_y;
        drive.pose.heading += uniform(-PI, PI);
        while ((status = tick(&drive, &twist)) == JP_OK && drive.ticks < TICKS_MAX) {
            move(&drive, twist.x / Q24, twist.turn_rate / Q24);
        }
        const double curvature = config.curvature_max / Q24;
        const double speed = config.speed / Q24;
        const double room = config.lookahead_max / Q24 - hypot(beside_x, beside_y);
        const bool must_arrive =
            room * curvature >= ROOM && speed * speed * curvature <= config.lateral_acceleration / Q24;
        TEST_ASSERT_TRUE(status == JP_ARRIVED || (status == JP_ERR_OUTSIDE && !must_arrive));
        certain += must_arrive ? 1 : 0;
        TEST_ASSERT_EQUAL_INT32(0, twist.x);
        TEST_ASSERT_EQUAL_INT32(0, twist.turn_rate);
        arrived += status == JP_ARRIVED ? 1 : 0;
    }
    printf("from beside the path, in any direction: %lu of %lu arrive, %lu of them must\n", arrived, 4 * options.count,
           certain);
    TEST_ASSERT_TRUE(10 * certain >= options.count);
}

static void test_law(void)
{
    printf("curvature: within %.2g of the largest to the law in double\n", worst_law);
    TEST_ASSERT_TRUE(worst_law > 0);
    TEST_ASSERT_TRUE(worst_law <= LAW_BAR);
}

static void add_figures(json_t *figures)
{
    for (int i = 0; i < SPEEDS; i++) {
        figures_add(figures, "make figures", speeds[i].wheels, "m", i == REFERENCE ? at_most(0.05) : no_bar,
                    "pure pursuit: largest error of four wheels on %lu random smooth paths at %g m/s", options.count,
                    speeds[i].speed);
    }
    figures_add(figures, "make figures", 100 * worst_law, "%", at_most(0.1),
                "pure pursuit: worst error of the curvature to the law in double, of the largest");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
