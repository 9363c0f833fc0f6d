/* The patrol robot among people whom one sends about: a drive of patrol_mission.h, cycle by cycle, as jp-patrol does it
 * by the improved elastic band. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/fingerprint.h"
#include "sim/base/strict_math.h"
#include "sim/missions/patrol_mission.h"
#include "sim/page/page_export.h"
#include "sim/page/page_robots.h"

#define Q16_ONE 65536.0

/* Of people that the page adds, m and m/s. */
#define PERSON_RADIUS 0.25
#define PERSON_SPEED  1.2

/* Round start and goal nobody is put, m. */
#define KEPT_FREE 1.2

#define CELLS_MAX  1048576
#define POINTS_MAX 4096

#define UNKNOWN ((double)NAN)

#define VIEW(X)                                                                                                        \
    X(time_s)                                                                                                          \
    X(x_m)                                                                                                             \
    X(y_m)                                                                                                             \
    X(heading_rad)                                                                                                     \
    X(believed_x_m)                                                                                                    \
    X(believed_y_m)                                                                                                    \
    X(believed_heading_rad)                                                                                            \
    X(speed_m_s)                                                                                                       \
    X(turn_rate_rad_s)                                                                                                 \
    X(state)                                                                                                           \
    X(reason)                                                                                                          \
    X(outcome)                                                                                                         \
    X(is_over)                                                                                                         \
    X(replans)                                                                                                         \
    X(clearance_m)                                                                                                     \
    X(clearance_min_m)                                                                                                 \
    X(planned_j)                                                                                                       \
    X(forecast_j)                                                                                                      \
    X(deviation_j)                                                                                                     \
    X(driven_j)                                                                                                        \
    X(driven_m)                                                                                                        \
    X(bus_voltage_v)                                                                                                   \
    X(goal_x_m)                                                                                                        \
    X(goal_y_m)                                                                                                        \
    X(goal_heading_rad)                                                                                                \
    X(position_error_m)                                                                                                \
    X(width)                                                                                                           \
    X(height)                                                                                                          \
    X(cell_m)                                                                                                          \
    X(length_m)                                                                                                        \
    X(width_m)                                                                                                         \
    X(wheelbase_m)                                                                                                     \
    X(track_m)                                                                                                         \
    X(wheel_angle_front_left_rad)                                                                                      \
    X(wheel_angle_front_right_rad)                                                                                     \
    X(wheel_angle_rear_left_rad)                                                                                       \
    X(wheel_angle_rear_right_rad)                                                                                      \
    X(digest_low)                                                                                                      \
    X(digest_high)

enum { VIEW(PAGE_INDEX) VIEW_COUNT };

static struct {
    struct patrol_scene scene;
    struct patrol_task task;
    struct patrol_result result;
    struct patrol_mission *mission;
    bool is_over;
    uint8_t cells[CELLS_MAX];
    double points[POINTS_MAX][2];
    double shapes[PATROL_OBSTACLES_MAX][4];
    /* Of the last cycle's view. */
    struct jp_plane_pose pose;
    struct jp_plane_pose believed;
    struct jp_plane_speed speed;
    struct jp_wheels wheels;
    enum jp_patrol_state state;
    enum jp_patrol_reason reason;
    unsigned replans;
    double clearance;
    double joules;
    struct patrol_leg leg;
    double band[JP_TEB_POSES_MAX][2];
    unsigned band_count;
    double scan[LASER_BEAMS_MAX][2];
    unsigned scan_count;
    struct jp_point path[POINTS_MAX];
    unsigned path_count;
    double view[VIEW_COUNT];
} page;

static const struct four_wheel_file *robot(void)
{
    return page_patrol_robots[0];
}

/* ---- What a cycle shows ---- */

static void keep_band(const struct jp_patrol *patrol)
{
    page.band_count = 0;
    for (int i = 0; patrol != NULL && patrol->state == JP_PATROL_DRIVING && i < patrol->teb.count; i++) {
        page.band[i][0] = (double)patrol->teb.poses[i].pose.x;
        page.band[i][1] = (double)patrol->teb.poses[i].pose.y;
        page.band_count++;
    }
}

static void keep_scan(const struct patrol_view *view)
{
    const struct planar_pose true_pose = {(double)view->true_pose.x, (double)view->true_pose.y,
                                          (double)view->true_pose.heading};
    const struct planar_pose mount = {robot()->laser.x_m, robot()->laser.y_m, 0};
    const struct planar_pose scanner = planar_compose(&true_pose, &mount);

    page.scan_count = 0;
    for (int i = 0; i < view->scan->beams; i++) {
        const double range = (double)view->scan->ranges[i];

        if (range > 0) {
            const double bearing = scanner.heading + view->scan->first + i * view->scan->step;

            page.scan[page.scan_count][0] = scanner.x + range * strict_cos(bearing);
            page.scan[page.scan_count][1] = scanner.y + range * strict_sin(bearing);
            page.scan_count++;
        }
    }
}

static void keep_path(const struct patrol_view *view)
{
    page.path_count = (unsigned)(view->path_count < POINTS_MAX ? view->path_count : POINTS_MAX);
    memcpy(page.path, view->path, page.path_count * sizeof page.path[0]);
}

static void observe(void *context, const struct patrol_view *view)
{
    (void)context;
    page.pose = view->true_pose;
    page.believed = view->believed;
    page.speed = view->true_speed;
    page.wheels = *view->wheels;
    page.state = view->state;
    page.reason = view->reason;
    page.replans = view->replans;
    page.clearance = view->clearance;
    page.joules = view->energy_j;
    page.leg = *view->leg;
    keep_band(view->patrol);
    keep_scan(view);
    keep_path(view);
}

/* ---- Set up ---- */

PAGE_EXPORT(patrol_scenes) unsigned patrol_scenes(void)
{
    return PATROL_SCENES;
}

PAGE_EXPORT(patrol_scene_name) const char *patrol_scene_name(unsigned kind)
{
    return patrol_scene_names[kind];
}

static void release(void)
{
    patrol_mission_free(page.mission);
    page.mission = NULL;
    if (page.scene.block != NULL) {
        patrol_scene_free(&page.scene);
        page.scene.block = NULL;
    }
}

/** A scene from a seed, without the people of the page. */
PAGE_EXPORT(patrol_new) void patrol_new(unsigned kind, double seed)
{
    release();
    memset(&page, 0, sizeof page);
    patrol_scene_make((enum patrol_scene_kind)kind, (uint64_t)seed, &page.scene);
    page.pose = page.believed = page.scene.start;
}

static bool is_kept_free(double x, double y)
{
    const struct jp_plane_pose *start = &page.scene.start;
    const struct jp_plane_pose *goal = &page.scene.goal;

    return strict_hypot(x - (double)start->x, y - (double)start->y) < KEPT_FREE ||
           strict_hypot(x - (double)goal->x, y - (double)goal->y) < KEPT_FREE;
}

/** Somebody who stands there; before patrol_begin(). False: there is no room for more, or it is too near to start or
 *  goal. */
PAGE_EXPORT(patrol_add_person) unsigned patrol_add_person(double x, double y)
{
    if (page.scene.mover_count >= PATROL_OBSTACLES_MAX || is_kept_free(x, y)) {
        return 0;
    }
    page.scene.movers[page.scene.mover_count++] =
        (struct patrol_obstacle){.shape = {.kind = PLANAR_DISC, .radius = PERSON_RADIUS},
                                 .waypoints = {{x, y}},
                                 .waypoint_count = 1,
                                 .speed = PERSON_SPEED};
    return 1;
}

/** Begins the drive; the noise is of the seed. False: no memory. */
PAGE_EXPORT(patrol_begin) unsigned patrol_begin(double seed)
{
    page.task = (struct patrol_task){.robot = robot(),
                                     .scene = &page.scene,
                                     .method = PATROL_IMPROVED,
                                     .seed = (uint64_t)seed,
                                     .faults = {.jump_at = -1},
                                     .observe = observe};
    page.mission = patrol_mission_begin(&page.task, &page.result);
    page.is_over = page.mission == NULL;
    return page.mission != NULL;
}

/* ---- People ---- */

static struct patrol_world *world(void)
{
    return patrol_mission_world(page.mission);
}

/** Who moves, or may be sent: the first of the shapes. */
PAGE_EXPORT(patrol_people) unsigned patrol_people(void)
{
    return page.mission == NULL ? 0 : (unsigned)world()->obstacle_count;
}

/** Somebody goes from where they are straight to a place, and stands there. */
PAGE_EXPORT(patrol_send) void patrol_send(unsigned person, double x, double y)
{
    if (person < patrol_people() && person < world()->shape_count) {
        struct patrol_obstacle *obstacle = &world()->obstacles[person];
        const struct planar_pose *at = &world()->shapes[person].pose;

        obstacle->waypoints[0] = (struct planar_point){at->x, at->y};
        obstacle->waypoints[1] = (struct planar_point){x, y};
        obstacle->waypoint_count = 2;
        obstacle->speed = PERSON_SPEED;
        obstacle->starts = world()->time;
        obstacle->end = PATROL_STOPS;
    }
}

/* ---- Time ---- */

/** So many cycles; fewer when the drive comes to its end. */
PAGE_EXPORT(patrol_run) unsigned patrol_run(unsigned cycles)
{
    unsigned done = 0;

    while (done < cycles && !page.is_over) {
        page.is_over = !patrol_mission_step(page.mission);
        done += !page.is_over;
    }
    return done;
}

PAGE_EXPORT(patrol_cycles_a_second) unsigned patrol_cycles_a_second(void)
{
    return PATROL_CYCLE_HZ;
}

/* ---- Pictures ---- */

/** A row of cells each, south first: 0 free, 1 on the map, 2 there but not on the map. */
PAGE_EXPORT(patrol_cells) const uint8_t *patrol_cells(void)
{
    const struct jp_terrain_config *config = &page.scene.map.config;

    for (int32_t y = 0; y < config->height; y++) {
        for (int32_t x = 0; x < config->width; x++) {
            const bool is_known = jp_terrain_cell(&page.scene.map, x, y) == JP_CELL_OCCUPIED;
            const bool is_there = jp_terrain_cell(&page.scene.ground, x, y) == JP_CELL_OCCUPIED;

            page.cells[y * config->width + x] = is_known ? 1 : is_there ? 2 : 0;
        }
    }
    return page.cells;
}

/** x, y, m, heading, rad, and radius, m, of who and what moves; a box has radius 0. So many. */
PAGE_EXPORT(patrol_shapes) unsigned patrol_shapes(void)
{
    const unsigned count =
        page.mission == NULL ? 0 : (unsigned)fmin(PATROL_OBSTACLES_MAX, (double)world()->shape_count);

    for (unsigned i = 0; i < count; i++) {
        const struct planar_shape *shape = &world()->shapes[i];

        page.shapes[i][0] = shape->pose.x;
        page.shapes[i][1] = shape->pose.y;
        page.shapes[i][2] = shape->pose.heading;
        page.shapes[i][3] = shape->kind == PLANAR_DISC ? shape->radius : 0;
    }
    return count;
}

PAGE_EXPORT(patrol_shape_numbers) const double *patrol_shape_numbers(void)
{
    return &page.shapes[0][0];
}

/** The path that is driven: so many points. */
PAGE_EXPORT(patrol_path) unsigned patrol_path(void)
{
    for (unsigned i = 0; i < page.path_count; i++) {
        page.points[i][0] = page.path[i].x / Q16_ONE;
        page.points[i][1] = page.path[i].y / Q16_ONE;
    }
    return page.path_count;
}

PAGE_EXPORT(patrol_points) const double *patrol_points(void)
{
    return &page.points[0][0];
}

/** The elastic band: so many points. */
PAGE_EXPORT(patrol_band) unsigned patrol_band(void)
{
    return page.band_count;
}

PAGE_EXPORT(patrol_band_points) const double *patrol_band_points(void)
{
    return &page.band[0][0];
}

/** Where the laser's beams end: so many points. */
PAGE_EXPORT(patrol_scan) unsigned patrol_scan(void)
{
    return page.scan_count;
}

PAGE_EXPORT(patrol_scan_points) const double *patrol_scan_points(void)
{
    return &page.scan[0][0];
}

/* ---- The view ---- */

static void view_motion(void)
{
    page.view[VIEW_time_s] = page.mission == NULL ? 0 : world()->time;
    page.view[VIEW_x_m] = (double)page.pose.x;
    page.view[VIEW_y_m] = (double)page.pose.y;
    page.view[VIEW_heading_rad] = (double)page.pose.heading;
    page.view[VIEW_believed_x_m] = (double)page.believed.x;
    page.view[VIEW_believed_y_m] = (double)page.believed.y;
    page.view[VIEW_believed_heading_rad] = (double)page.believed.heading;
    page.view[VIEW_speed_m_s] = (double)page.speed.forward;
    page.view[VIEW_turn_rate_rad_s] = (double)page.speed.turn_rate;
    for (int i = 0; i < JP_WHEELS; i++) {
        page.view[VIEW_wheel_angle_front_left_rad + i] = page.wheels.angle[i] / 4294967296.0 * 2 * M_PI;
    }
}

static void view_drive(void)
{
    page.view[VIEW_state] = page.state;
    page.view[VIEW_reason] = page.reason;
    page.view[VIEW_is_over] = page.is_over;
    page.view[VIEW_outcome] = page.is_over ? (double)page.result.outcome : UNKNOWN;
    page.view[VIEW_position_error_m] = page.is_over ? page.result.position_error : UNKNOWN;
    page.view[VIEW_replans] = page.replans;
    page.view[VIEW_clearance_m] = page.clearance;
    page.view[VIEW_clearance_min_m] = page.mission == NULL ? UNKNOWN : world()->distance_min;
    page.view[VIEW_planned_j] = page.leg.planned > 0 ? page.leg.planned : UNKNOWN;
    page.view[VIEW_forecast_j] = page.leg.planned > 0 ? page.leg.forecast : UNKNOWN;
    page.view[VIEW_deviation_j] = page.leg.planned > 0 ? page.leg.deviation : UNKNOWN;
    page.view[VIEW_driven_j] = page.is_over && page.result.energy_j > 0 ? page.result.energy_j : page.joules;
    page.view[VIEW_driven_m] = page.result.length;
    page.view[VIEW_bus_voltage_v] = robot()->electronics.voltage_v;
}

static void view_scene(void)
{
    const struct jp_terrain_config *config = &page.scene.map.config;

    page.view[VIEW_goal_x_m] = (double)page.scene.goal.x;
    page.view[VIEW_goal_y_m] = (double)page.scene.goal.y;
    page.view[VIEW_goal_heading_rad] = (double)page.scene.goal.heading;
    page.view[VIEW_width] = config->width;
    page.view[VIEW_height] = config->height;
    page.view[VIEW_cell_m] = config->resolution / Q16_ONE;
    page.view[VIEW_length_m] = robot()->body.length_m;
    page.view[VIEW_width_m] = robot()->body.width_m;
    page.view[VIEW_wheelbase_m] = robot()->body.wheelbase_m;
    page.view[VIEW_track_m] = robot()->body.track_m;
}

static void view_digest(void)
{
    uint64_t fingerprint = FINGERPRINT_START;

    fingerprint_add(&fingerprint, &page.pose, sizeof page.pose);
    fingerprint_add(&fingerprint, &page.joules, sizeof page.joules);
    page.view[VIEW_digest_low] = (double)(fingerprint & 0xFFFFFFFFU);
    page.view[VIEW_digest_high] = (double)(fingerprint >> 32);
}

PAGE_EXPORT(patrol_view_names) const char *patrol_view_names(void)
{
    return VIEW(PAGE_NAME);
}

PAGE_EXPORT(patrol_view) const double *patrol_view(void)
{
    view_motion();
    view_drive();
    view_scene();
    view_digest();
    return page.view;
}

PAGE_EXPORT(patrol_state_name) const char *patrol_state_name(void)
{
    return patrol_state_names[page.state];
}

PAGE_EXPORT(patrol_reason_name) const char *patrol_reason_name(void)
{
    return patrol_reason_names[page.reason];
}

PAGE_EXPORT(patrol_outcome_name) const char *patrol_outcome_name(void)
{
    return patrol_outcome_names[page.result.outcome];
}
