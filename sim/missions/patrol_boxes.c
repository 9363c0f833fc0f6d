#include "sim/missions/patrol_boxes.h"

#include <joulepath/patrol_mission.h>
#include <math.h>
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/base/random.h"
#include "sim/base/strict_math.h"
#include "sim/four_wheel/patrol_config.h"
#include "sim/four_wheel/patrol_robots.h"
#include "sim/scenes/patrol_scene.h"

/* Of a box, and how far its middle is from the path at most, m. */
#define SIDE_MIN 0.2
#define SIDE_MAX 0.6
#define ASIDE    0.4

/* Round start and goal, m. */
#define KEPT_FREE 1.0

#define POINTS_MAX 4096
#define TURNS_MAX  1024
#define SLICE      100000

static double cell_of(const struct patrol_scene *scene)
{
    return (double)scene->ground.config.resolution / JP_Q16_ONE;
}

static bool is_kept_free(const struct patrol_scene *scene, double x, double y)
{
    return strict_hypot(x - (double)scene->start.x, y - (double)scene->start.y) < KEPT_FREE ||
           strict_hypot(x - (double)scene->goal.x, y - (double)scene->goal.y) < KEPT_FREE;
}

/* A box about a point, m. */
static void put(struct patrol_scene *scene, double x, double y, double width, double height)
{
    const double cell = cell_of(scene);

    for (int v = (int)floor((y - height / 2) / cell); v * cell < y + height / 2; v++) {
        for (int u = (int)floor((x - width / 2) / cell); u * cell < x + width / 2; u++) {
            if (!is_kept_free(scene, (u + 0.5) * cell, (v + 0.5) * cell)) {
                (void)jp_terrain_set_cell(&scene->ground, u, v, JP_CELL_OCCUPIED);
            }
        }
    }
}

static void put_along(struct patrol_scene *scene, const struct jp_patrol_mission *mission, unsigned boxes,
                      uint64_t seed)
{
    struct random random;

    random_init(&random, seed);
    for (unsigned i = 0; i < boxes; i++) {
        const double share = (i + random_uniform(&random, 0, 1)) / boxes;
        const struct jp_point *point = &mission->path[(size_t)(share * (mission->path_count - 1))];
        const double x = (double)point->x / JP_Q16_ONE + random_uniform(&random, -ASIDE, ASIDE);
        const double y = (double)point->y / JP_Q16_ONE + random_uniform(&random, -ASIDE, ASIDE);
        const double width = random_uniform(&random, SIDE_MIN, SIDE_MAX);

        put(scene, x, y, width, random_uniform(&random, SIDE_MIN, SIDE_MAX));
    }
}

static bool plan(struct jp_patrol_mission *mission, const struct patrol_scene *scene)
{
    enum jp_patrol_mission_state state = JP_MISSION_PLANNING;

    if (jp_patrol_set_pose(&mission->patrol, &scene->start) != JP_OK ||
        jp_patrol_mission_start(mission, &scene->goal) != JP_OK) {
        return false;
    }
    while (state == JP_MISSION_PLANNING) {
        state = jp_patrol_mission_work(mission, SLICE);
    }
    return state == JP_MISSION_UNDER_WAY;
}

bool patrol_boxes_hide(struct patrol_scene *scene, const struct four_wheel_file *robot, unsigned boxes, uint64_t seed)
{
    const struct patrol_robot_entry *const entry = patrol_robot_built_in(robot->name);
    const struct jp_patrol_mission_config config = {.patrol = patrol_config(robot, PATROL_IMPROVED),
                                                    .map = &scene->map,
                                                    .energy = entry != NULL ? entry->energy : NULL,
                                                    .turns_before_goal = true,
                                                    .points_max = POINTS_MAX,
                                                    .turns_max = TURNS_MAX};
    const size_t size = jp_patrol_mission_size(&config);
    struct jp_patrol_mission *mission = malloc(sizeof *mission);
    void *block = malloc(size);
    const char *field;
    bool is_done = false;

    if (mission == NULL || block == NULL || size == 0 || !patrol_scene_part_ground(scene) ||
        jp_patrol_mission_init(mission, &config, block, size, &field) != JP_OK) {
        error_line("%s: no memory to plan over it; give a smaller map", scene->name);
    } else if (!plan(mission, scene)) {
        error_line("%s: by the map no way leads from --start to --goal; give other places", scene->name);
    } else {
        put_along(scene, mission, boxes, seed);
        is_done = true;
    }
    free(block);
    free(mission);
    return is_done;
}
