/* How exactly pure pursuit keeps the patrol robot on smoothed paths, over its speed: on the planner's paths of the
 * scenes, between what the map shows, and around random turning points on open ground; from a stand along the path. The
 * pose is the plant's, or that of laser odometry. Prints figures as JSON; --rows FILE gets a row for each speed. */
#include <joulepath/path_spline.h>
#include <joulepath/patrol_mission.h>
#include <joulepath/scan_match.h>
#include <math.h>
#include <string.h>

#include "sim/base/parallel.h"
#include "sim/four_wheel/four_wheel_plant.h"
#include "sim/four_wheel/laser.h"
#include "sim/four_wheel/patrol_config.h"
#include "sim/scenes/patrol_scene.h"
#include "tests/bench/figures.h"

#define COMMAND    "make bench-patrol"
#define ROBOT_PATH "sim/robots/patrol.cfg"

#define TICK  (1.0 / FOUR_WHEEL_RATE_HZ)
#define TICKS (FOUR_WHEEL_RATE_HZ / PATROL_CYCLE_HZ)

#define TIME_LIMIT 300.0 /* s */

/* Of the largest error, m, at this speed, m/s. */
#define BAR          0.05
#define SPEED_OF_BAR 1.0

/* Open ground. */
#define OPEN_CELL    0.25 /* m */
#define LEG_MIN      3.0  /* m */
#define LEG_MAX      6.0
#define TURN_MAX     (M_PI / 3)
#define TUBE_CELLS   8
#define PATH_SPACING 0.1 /* m, as the planner's */

/* m/s; the wheels do 1.5. */
static const double speeds[] = {0.25, 0.5, 0.75, 1.0, 1.25};

enum {
    SPEEDS = sizeof speeds / sizeof speeds[0],
    SCENE_SEEDS = 20,
    SCENE_COURSES = PATROL_SCENES * SCENE_SEEDS,
    OPEN_COURSES = 40,
    COURSES = SCENE_COURSES + OPEN_COURSES,
    OPEN_SIDE = 400, /* cells */
    TURNING_POINTS = 8,
    NOISE_SEED = 1,
    POINTS_MAX = 4096, /* of a path */
    NEAR = 30,         /* segments of a path, on either side of the one that the robot was at */
};

/* What is driven, and by which pose. */
enum kind { OPEN_GROUND, SCENES, SCENES_BY_LASER, KINDS };

static const struct {
    const char *name;
    bool is_open;
    bool has_laser;
    size_t courses;
} kinds[KINDS] = {
    [OPEN_GROUND] = {"paths on open ground", true, false, OPEN_COURSES},
    [SCENES] = {"paths of scenes", false, false, SCENE_COURSES},
    [SCENES_BY_LASER] = {"paths of scenes, by laser odometry", false, true, SCENE_COURSES},
};

/* Distances of the robot's centre from its path, m. */
struct errors {
    double largest;
    double square_sum;
    double count;
    bool has_arrived;
};

struct path {
    struct jp_point points[POINTS_MAX];
    size_t count;
};

struct course {
    bool is_open;
    struct patrol_scene scene; /* of open ground only the map */
    struct path path;
    struct errors errors[SPEEDS][KINDS];
};

struct campaign {
    struct four_wheel_file robot;
    struct course courses[COURSES];
};

static void fail(const char *what)
{
    error_line("bench_pursuit: %s", what);
    exit(1);
}

/* ---- Paths of the scenes ---- */

static void plan_scene(struct course *course, const struct four_wheel_file *robot, enum patrol_scene_kind kind,
                       uint64_t seed)
{
    patrol_scene_make(kind, seed, &course->scene);

    const struct jp_patrol_mission_config config = {.patrol = patrol_config(robot, PATROL_PURSUIT),
                                                    .map = &course->scene.map,
                                                    .points_max = POINTS_MAX,
                                                    .turns_max = POINTS_MAX / 4};
    const size_t size = jp_patrol_mission_size(&config);
    void *block = malloc(size);
    struct jp_patrol_mission mission;
    const char *field;

    if (block == NULL || jp_patrol_mission_init(&mission, &config, block, size, &field) != JP_OK ||
        jp_patrol_set_pose(&mission.patrol, &course->scene.start) != JP_OK ||
        jp_patrol_mission_start(&mission, &course->scene.goal) != JP_OK) {
        fail("a scene that cannot be planned");
    }
    while (jp_patrol_mission_work(&mission, UINT16_MAX) == JP_MISSION_PLANNING) {
    }
    if (mission.state != JP_MISSION_UNDER_WAY) {
        fail("a scene without a path");
    }
    course->path.count = mission.path_count;
    memcpy(course->path.points, mission.path, mission.path_count * sizeof *mission.path);
    free(block);
}

/* ---- Paths around random turning points ---- */

static void make_open_ground(struct patrol_scene *scene)
{
    const struct jp_terrain_config config = {.width = OPEN_SIDE, .height = OPEN_SIDE, .resolution = JP_Q16(OPEN_CELL)};
    const size_t size = jp_terrain_size(&config);
    const char *field = "no memory";

    scene->block = malloc(size);
    if (jp_terrain_init(&scene->map, &config, scene->block, size, &field) != JP_OK) {
        fail(field);
    }
    for (int i = 0; i < OPEN_SIDE * OPEN_SIDE; i++) {
        (void)jp_terrain_set_cell(&scene->map, i % OPEN_SIDE, i / OPEN_SIDE, JP_CELL_FREE);
    }
}

/* From the middle of the ground, whose border they do not reach. */
static void draw_turning_points(struct random *random, struct jp_point way[TURNING_POINTS])
{
    struct planar_point point = {OPEN_SIDE * OPEN_CELL / 2, OPEN_SIDE * OPEN_CELL / 2};
    double bearing = random_uniform(random, -M_PI, M_PI);

    for (size_t i = 0; i < TURNING_POINTS; i++) {
        const double length = random_uniform(random, LEG_MIN, LEG_MAX);
        way[i] = (struct jp_point){(jp_q16)lround(point.x * JP_Q16_ONE), (jp_q16)lround(point.y * JP_Q16_ONE)};
        point.x += length * cos(bearing);
        point.y += length * sin(bearing);
        bearing += random_uniform(random, -TURN_MAX, TURN_MAX);
    }
}

static void smooth(struct path *path, const struct jp_grid_planner *planner, const struct jp_point way[TURNING_POINTS])
{
    const size_t size = jp_path_spline_size(TURNING_POINTS);
    void *scratch = malloc(size);

    if (scratch == NULL || jp_path_spline(planner, way, TURNING_POINTS, JP_Q16(PATH_SPACING), scratch, size,
                                          path->points, POINTS_MAX, &path->count) != JP_OK) {
        fail("no path around the turning points");
    }
    free(scratch);
}

static void plan_open(struct course *course, const struct four_wheel_file *robot, uint64_t seed)
{
    const struct jp_grid_planner_config config = {
        .method = JP_GRID_ANY_ANGLE, .clearance = (jp_q16)(robot->body.width_m / 2 * JP_Q16_ONE), .tube = TUBE_CELLS};
    struct jp_grid_planner planner;
    struct jp_point way[TURNING_POINTS];
    struct random random;
    const char *field = "no memory";

    make_open_ground(&course->scene);
    random_init(&random, seed);
    draw_turning_points(&random, way);

    const size_t size = jp_grid_planner_size(&config, &course->scene.map.config);
    void *block = malloc(size);
    if (jp_grid_planner_init(&planner, &config, &course->scene.map, block, size, &field) != JP_OK) {
        fail(field);
    }
    smooth(&course->path, &planner, way);
    free(block);
}

/* ---- A drive ---- */

struct drive {
    const struct course *course;
    struct four_wheel_plant plant;
    struct jp_four_wheel_config wheels_config;
    struct jp_wheels wheels;
    struct jp_twist twist;
    struct jp_pure_pursuit pursuit;
    struct laser_config laser;
    struct laser_scan scan;
    struct jp_scan_matcher matcher;
    uint64_t matcher_block[8 * LASER_BEAMS_MAX + 8];
    struct random random;
    struct planar_pose motion;   /* since the last scan, as the wheels say */
    struct jp_plane_speed speed; /* likewise */
    struct solid_map map;
    size_t near; /* segment of the path that the robot was nearest to */
    double time;
};

static struct planar_point point_at(const struct course *course, size_t index)
{
    const struct jp_point *point = &course->path.points[index];

    return (struct planar_point){(double)point->x / JP_Q16_ONE, (double)point->y / JP_Q16_ONE};
}

/* On the path's first point, along it. */
static struct planar_pose start_of(const struct course *course)
{
    const struct planar_point first = point_at(course, 0);
    const struct planar_point second = point_at(course, 1);

    return (struct planar_pose){first.x, first.y, atan2(second.y - first.y, second.x - first.x)};
}

static struct jp_plane_pose to_plane(const struct planar_pose *pose)
{
    return (struct jp_plane_pose){(float)pose->x, (float)pose->y, (float)pose->heading};
}

static void set_up(struct drive *drive, const struct campaign *campaign, const struct course *course, double speed)
{
    const struct four_wheel_file *robot = &campaign->robot;
    const struct planar_pose start = start_of(course);
    const struct jp_plane_pose first = to_plane(&start);
    struct jp_pure_pursuit_config config = patrol_pursuit_config(robot);
    const char *field = "no memory";

    config.speed = (jp_q24)lround(speed * JP_Q24_ONE);
    drive->course = course;
    four_wheel_plant_init(&drive->plant, robot, &start);
    drive->wheels_config = four_wheel_config(robot);
    drive->laser = laser_config_of(robot->laser.beams, robot->laser.field_deg * M_PI / 180, robot->laser.range_m,
                                   robot->laser.noise_m);
    random_init(&drive->random, NOISE_SEED);
    if (jp_scan_matcher_init(&drive->matcher, LASER_BEAMS_MAX, drive->matcher_block, sizeof drive->matcher_block) !=
            JP_OK ||
        jp_scan_matcher_start(&drive->matcher, &first) != JP_OK || !solid_map_init(&drive->map, &course->scene.map) ||
        jp_pure_pursuit_init(&drive->pursuit, &config, &field) != JP_OK ||
        jp_pure_pursuit_follow(&drive->pursuit, course->path.points, course->path.count) != JP_OK) {
        fail(field);
    }
}

/* The scanner is in the robot's centre. */
static struct planar_pose laser_pose(struct drive *drive)
{
    const struct jp_plane_pose motion = to_plane(&drive->motion);
    struct jp_match_result match;

    laser_take(&drive->laser, &drive->map, NULL, 0, &drive->plant.state.pose, &drive->random, &drive->scan);

    const struct jp_scan scan = {drive->scan.ranges, (uint16_t)drive->scan.beams, (float)drive->scan.first,
                                 (float)drive->scan.step};

    if (jp_scan_match(&drive->matcher, &scan, &motion, &match) != JP_OK) {
        fail("a scan that is none");
    }
    drive->motion = (struct planar_pose){0, 0, 0};
    return (struct planar_pose){(double)match.pose.x, (double)match.pose.y, (double)match.pose.heading};
}

static enum jp_status pursue(struct drive *drive, bool has_laser)
{
    const struct planar_pose pose = has_laser ? laser_pose(drive) : drive->plant.state.pose;

    return patrol_pursue(&drive->pursuit, drive->plant.robot, &pose, &drive->speed, &drive->twist);
}

static void measure_wheels(struct drive *drive)
{
    struct jp_twist twist;
    jp_q24 slip;

    jp_four_wheel_forward(&drive->wheels_config, &drive->plant.measured, &twist, &slip);
    const double seconds = TICK / JP_Q24_ONE;
    const struct planar_pose motion = {twist.x * seconds, twist.y * seconds, twist.turn_rate * seconds};

    drive->motion = planar_bend(&drive->motion, &motion);
    drive->speed =
        (struct jp_plane_speed){(float)twist.x / (float)JP_Q24_ONE, (float)twist.turn_rate / (float)JP_Q24_ONE};
}

static double segment_distance(const struct course *course, size_t index, const struct planar_point *point)
{
    const struct planar_point a = point_at(course, index);
    const struct planar_point b = point_at(course, index + 1);
    const struct planar_point way = {b.x - a.x, b.y - a.y};
    const double along = ((point->x - a.x) * way.x + (point->y - a.y) * way.y) / (way.x * way.x + way.y * way.y);
    const double share = fmin(fmax(along, 0), 1);

    return hypot(a.x + share * way.x - point->x, a.y + share * way.y - point->y);
}

/* Paths cross themselves: only what is near the last segment counts. */
static double path_distance(struct drive *drive, const struct planar_point *point)
{
    const size_t segments = drive->course->path.count - 1;
    const size_t first = drive->near > NEAR ? drive->near - NEAR : 0;
    double least = INFINITY;

    for (size_t i = first; i < segments && i <= first + 2 * NEAR; i++) {
        const double distance = segment_distance(drive->course, i, point);
        drive->near = distance < least ? i : drive->near;
        least = fmin(least, distance);
    }
    return least;
}

static void note(struct drive *drive, struct errors *errors)
{
    const double error =
        path_distance(drive, &(struct planar_point){drive->plant.state.pose.x, drive->plant.state.pose.y});

    errors->largest = fmax(errors->largest, error);
    errors->square_sum += error * error;
    errors->count++;
}

static void drive_tick(struct drive *drive)
{
    enum jp_steering steering;

    (void)jp_four_wheel_tick(&drive->wheels_config, &drive->twist, &drive->wheels, &steering);
    four_wheel_plant_tick(&drive->plant, &drive->wheels);
    measure_wheels(drive);
    drive->time += TICK;
}

static struct errors track(const struct campaign *campaign, const struct course *course, double speed, bool has_laser)
{
    struct errors errors = {0};
    enum jp_status status;
    struct drive *drive = calloc(1, sizeof *drive);

    if (drive == NULL) {
        fail("no memory");
    }
    set_up(drive, campaign, course, speed);
    for (status = pursue(drive, has_laser); status == JP_OK && drive->time < TIME_LIMIT;
         status = pursue(drive, has_laser)) {
        for (int i = 0; i < TICKS; i++) {
            drive_tick(drive);
            note(drive, &errors);
        }
    }
    errors.has_arrived = status == JP_ARRIVED;
    solid_map_free(&drive->map);
    free(drive);
    return errors;
}

/* ---- All drives ---- */

static void plan_course(struct course *course, const struct four_wheel_file *robot, size_t index)
{
    course->is_open = index >= SCENE_COURSES;
    if (course->is_open) {
        plan_open(course, robot, index);
    } else {
        plan_scene(course, robot, (enum patrol_scene_kind)(index / SCENE_SEEDS), index % SCENE_SEEDS + 1);
    }
}

static void drive_course(void *context, size_t index)
{
    struct campaign *campaign = context;
    struct course *course = &campaign->courses[index];

    plan_course(course, &campaign->robot, index);
    for (size_t speed = 0; speed < SPEEDS; speed++) {
        for (enum kind kind = 0; kind < KINDS; kind++) {
            if (kinds[kind].is_open == course->is_open) {
                course->errors[speed][kind] = track(campaign, course, speeds[speed], kinds[kind].has_laser);
            }
        }
    }
    patrol_scene_free(&course->scene);
}

/* ---- What came of them ---- */

struct summary {
    double largest; /* m */
    double rms;
    size_t arrived;
};

static struct summary summarise(const struct campaign *campaign, size_t speed, enum kind kind)
{
    struct summary summary = {0};
    double square_sum = 0;
    double count = 0;

    for (size_t i = 0; i < COURSES; i++) {
        const struct errors *errors = &campaign->courses[i].errors[speed][kind];
        summary.largest = fmax(summary.largest, errors->largest);
        summary.arrived += errors->has_arrived;
        square_sum += errors->square_sum;
        count += errors->count;
    }
    summary.rms = sqrt(square_sum / count);
    return summary;
}

static void add_figures(json_t *figures, double speed, enum kind kind, const struct summary *summary)
{
    figures_add(figures, COMMAND, summary->largest, "m", at_most(BAR),
                "pure pursuit at %.0f m/s, %zu %s: largest distance from the path", speed, kinds[kind].courses,
                kinds[kind].name);
    figures_add(figures, COMMAND, summary->rms, "m", no_bar,
                "pure pursuit at %.0f m/s, %zu %s: distance from the path, root mean square", speed,
                kinds[kind].courses, kinds[kind].name);
}

static json_t *json_row(double speed, enum kind kind, const struct summary *summary)
{
    return json_pack("{s:s, s:f, s:i, s:i, s:f, s:f}", "course", kinds[kind].name, "speed_m_s", speed, "drives",
                     (int)kinds[kind].courses, "arrived", (int)summary->arrived, "largest_m", summary->largest, "rms_m",
                     summary->rms);
}

int main(int argc, char **argv)
{
    static struct campaign campaign;
    const char *rows_path = figures_rows_path(argc, argv, "Measures how exactly pure pursuit keeps to paths.");
    json_t *figures = json_array();
    json_t *rows = json_array();

    if (!four_wheel_file_load(ROBOT_PATH, &campaign.robot)) {
        return ERROR_EXIT;
    }
    in_parallel("pure pursuit", drive_course, &campaign, COURSES);
    for (enum kind kind = 0; kind < KINDS; kind++) {
        for (size_t speed = 0; speed < SPEEDS; speed++) {
            const struct summary summary = summarise(&campaign, speed, kind);

            if (speeds[speed] == SPEED_OF_BAR) {
                add_figures(figures, speeds[speed], kind, &summary);
            }
            (void)json_array_append_new(rows, json_row(speeds[speed], kind, &summary));
        }
    }
    figures_write_rows(rows, rows_path);
    figures_print(figures);
    return 0;
}
