#include "patrol_path.h"

#include <joulepath/path_spline.h>
#include <stdlib.h>
#include <string.h>

#include "clearance.h"

#define EXPANSIONS 100000
#define TUBE_CELLS 8

/* Beyond half the robot's width, m: the widest way that exists is taken. */
static const double margins[] = {0.15, 0.10, 0.05, 0.02};
#define MARGINS (sizeof margins / sizeof margins[0])

struct patrol_planner {
    const struct four_wheel_file *robot;
    const struct jp_terrain *given;
    struct jp_terrain marked;
    void *marked_block;
    struct jp_grid_planner grid;
    void *grid_block;
    size_t grid_size;
};

static double cell_side(const struct jp_terrain *terrain)
{
    return (double)terrain->config.resolution / JP_Q16_ONE;
}

static struct jp_grid_planner_config grid_config(const struct four_wheel_file *robot, double margin)
{
    return (struct jp_grid_planner_config){
        .method = JP_GRID_ANY_ANGLE,
        .clearance = (jp_q16)((robot->body.width_m / 2 + margin) * JP_Q16_ONE),
        .tube = TUBE_CELLS,
    };
}

static void copy_map(struct patrol_planner *planner)
{
    for (int y = 0; y < planner->given->config.height; y++) {
        for (int x = 0; x < planner->given->config.width; x++) {
            (void)jp_terrain_set_cell(&planner->marked, x, y, jp_terrain_cell(planner->given, x, y));
        }
    }
}

struct patrol_planner *patrol_planner_new(const struct jp_terrain *map, const struct four_wheel_file *robot)
{
    const struct jp_grid_planner_config config = grid_config(robot, margins[0]);
    const size_t map_size = jp_terrain_size(&map->config);
    struct patrol_planner *const planner = calloc(1, sizeof *planner);
    const char *field;

    if (planner == NULL) {
        return NULL;
    }
    planner->robot = robot;
    planner->given = map;
    planner->grid_size = jp_grid_planner_size(&config, &map->config);
    planner->marked_block = malloc(map_size);
    planner->grid_block = malloc(planner->grid_size);
    if (planner->marked_block == NULL || planner->grid_block == NULL ||
        jp_terrain_init(&planner->marked, &map->config, planner->marked_block, map_size, &field) != JP_OK) {
        patrol_planner_free(planner);
        return NULL;
    }
    copy_map(planner);
    return planner;
}

void patrol_planner_free(struct patrol_planner *planner)
{
    if (planner != NULL) {
        free(planner->marked_block);
        free(planner->grid_block);
        free(planner);
    }
}

/* What the beam went through is as the map says. */
static void clear_along(struct patrol_planner *planner, const struct planar_pose *scanner, double bearing, double range)
{
    const double side = cell_side(&planner->marked);

    const int steps = (int)ceil((range - 1.5 * side) / (side / 2));

    for (int i = 0; i < steps; i++) {
        const double along = i * side / 2;
        const struct planar_point point =
            planar_place(scanner, (struct planar_point){along * cos(bearing), along * sin(bearing)});
        const int x = (int)floor(point.x / side);
        const int y = (int)floor(point.y / side);

        (void)jp_terrain_set_cell(&planner->marked, x, y, jp_terrain_cell(planner->given, x, y));
    }
}

static void mark_end(struct patrol_planner *planner, const struct planar_pose *scanner, double bearing, double range)
{
    const double side = cell_side(&planner->marked);
    const struct planar_point end =
        planar_place(scanner, (struct planar_point){range * cos(bearing), range * sin(bearing)});

    (void)jp_terrain_set_cell(&planner->marked, (int)floor(end.x / side), (int)floor(end.y / side), JP_CELL_OCCUPIED);
}

void patrol_planner_mark(struct patrol_planner *planner, const struct laser_scan *scan,
                         const struct planar_pose *scanner)
{
    for (int i = 0; i < scan->beams; i++) {
        if (scan->ranges[i] > 0) {
            clear_along(planner, scanner, scan->first + i * scan->step, (double)scan->ranges[i]);
        }
    }
    for (int i = 0; i < scan->beams; i++) {
        if (scan->ranges[i] > 0) {
            mark_end(planner, scanner, scan->first + i * scan->step, (double)scan->ranges[i]);
        }
    }
}

static struct jp_grid_cell cell_at(const struct jp_terrain *map, const struct planar_point *point)
{
    const double side = cell_side(map);

    return (struct jp_grid_cell){(int16_t)floor(point->x / side), (int16_t)floor(point->y / side)};
}

static double path_length(const struct patrol_path *path)
{
    double length = 0;

    for (size_t i = 1; i < path->count; i++) {
        length += hypot((double)path->points[i].x - path->points[i - 1].x,
                        (double)path->points[i].y - path->points[i - 1].y) /
                  JP_Q16_ONE;
    }
    return length;
}

static bool smooth(struct patrol_planner *planner, struct patrol_path *path)
{
    const size_t size = jp_path_spline_size(path->way_count);
    void *const scratch = malloc(size);
    const bool is_smooth =
        scratch != NULL && jp_path_spline(&planner->grid, path->way, path->way_count, JP_Q16(PATROL_PATH_SPACING),
                                          scratch, size, path->points, PATROL_PATH_POINTS_MAX, &path->count) == JP_OK;

    free(scratch);
    path->length = is_smooth ? path_length(path) : 0;
    return is_smooth && path->count >= 2;
}

static bool find_with(struct patrol_planner *planner, double margin, const struct planar_point *from,
                      const struct planar_point *to, struct patrol_path *path)
{
    const struct jp_grid_planner_config config = grid_config(planner->robot, margin);
    const struct jp_grid_cell start = cell_at(&planner->marked, from);
    const struct jp_grid_cell goal = cell_at(&planner->marked, to);
    const struct jp_path_point *way;
    enum jp_grid_answer answer = JP_GRID_SEARCHING;
    const char *field;

    if (jp_grid_planner_init(&planner->grid, &config, &planner->marked, planner->grid_block, planner->grid_size,
                             &field) != JP_OK ||
        jp_grid_planner_set_task(&planner->grid, &start, &goal) != JP_OK) {
        return false;
    }
    while (answer == JP_GRID_SEARCHING) {
        answer = jp_grid_planner_work(&planner->grid, EXPANSIONS);
    }
    path->counts = *jp_grid_planner_statistics(&planner->grid);
    path->clearance = planner->robot->body.width_m / 2 + margin;
    way = jp_grid_planner_path(&planner->grid, &path->way_count);
    if (answer != JP_GRID_FOUND || path->way_count < 2 || path->way_count > PATROL_PATH_POINTS_MAX) {
        return false;
    }
    (void)memcpy(path->way, way, path->way_count * sizeof path->way[0]);
    return smooth(planner, path);
}

bool patrol_planner_find(struct patrol_planner *planner, const struct planar_point *from, const struct planar_point *to,
                         struct patrol_path *path)
{
    for (size_t i = 0; i < MARGINS; i++) {
        if (find_with(planner, margins[i], from, to, path)) {
            return true;
        }
    }
    return false;
}

bool patrol_planner_fits(const struct patrol_planner *planner, const struct planar_pose *pose, double margin)
{
    const struct clearance_robot robot = {planner->robot->body.length_m, planner->robot->body.width_m, margin};
    const struct clearance_pose at = {pose->x, pose->y, pose->heading};

    return clearance_at(&planner->marked, &robot, &at);
}
