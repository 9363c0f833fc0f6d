#include "sim/missions/navigation_world.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/error.h"
#include "sim/base/random.h"
#include "sim/base/strict_math.h"

/** Of a box, and how far its middle is from the route at most, m. */
#define SIDE_MIN 0.2
#define SIDE_MAX 0.6
#define ASIDE    0.4

/** Round start and goal, m. */
#define KEPT_FREE 1.0

static double cells(const struct jp_terrain *terrain, double metres)
{
    return metres * JP_Q16_ONE / terrain->config.resolution;
}

static bool is_kept_free(const struct jp_terrain *terrain, const struct plan_task *task, int x, int y)
{
    const double least = cells(terrain, KEPT_FREE);

    return strict_hypot(x - task->start.x, y - task->start.y) < least ||
           strict_hypot(x - task->goal.x, y - task->goal.y) < least;
}

static void put_box(struct jp_terrain *terrain, const struct plan_task *task, double x, double y, double width,
                    double height)
{
    for (int v = (int)floor(y - height / 2); v < y + height / 2; v++) {
        for (int u = (int)floor(x - width / 2); u < x + width / 2; u++) {
            if (!is_kept_free(terrain, task, u, v)) {
                (void)jp_terrain_set_cell(terrain, u, v, JP_CELL_OCCUPIED);
            }
        }
    }
}

static void hide(struct jp_terrain *terrain, const struct plan_route *route, const struct plan_task *task,
                 unsigned boxes, uint64_t seed)
{
    struct random random;

    random_init(&random, seed);
    for (unsigned i = 0; i < boxes; i++) {
        const double share = (i + random_uniform(&random, 0, 1)) / boxes;
        const struct jp_lattice_pose *pose = &route->way[(size_t)(share * (double)(route->way_count - 1))];
        const double x = pose->x + cells(terrain, random_uniform(&random, -ASIDE, ASIDE));
        const double y = pose->y + cells(terrain, random_uniform(&random, -ASIDE, ASIDE));
        const double width = cells(terrain, random_uniform(&random, SIDE_MIN, SIDE_MAX));

        put_box(terrain, task, x, y, width, cells(terrain, random_uniform(&random, SIDE_MIN, SIDE_MAX)));
    }
}

static bool copy(struct jp_terrain *terrain, void **block, const struct map_file *map)
{
    const struct jp_terrain_config *config = &map->terrain.config;
    const size_t size = jp_terrain_size(config);
    const char *field;

    *block = aligned_alloc(8, (size + 7) / 8 * 8);
    if (*block == NULL || jp_terrain_init(terrain, config, *block, size, &field) != JP_OK) {
        error_line("no memory for a world of %u × %u cells; import a smaller window", config->width, config->height);
        return false;
    }
    (void)memcpy(*block, map->block, size);
    return true;
}

bool navigation_world_init(struct navigation_world *world, struct map_file *map, double steepest)
{
    *world = (struct navigation_world){.steepest = (jp_q24)lround(steepest * JP_Q24_ONE)};
    if (!copy(&world->solid, &world->blocks[0], map)) {
        navigation_world_free(world);
        return false;
    }
    world->steep_cells = jp_terrain_block_steep(&map->terrain, world->steepest);
    if (!copy(&world->terrain, &world->blocks[1], map)) {
        navigation_world_free(world);
        return false;
    }
    return true;
}

bool navigation_world_hide(struct navigation_world *world, struct map_file *map, const struct jp_lattice *lattice,
                           const struct plan_task *task, unsigned boxes, uint64_t seed, size_t memory)
{
    struct plan_search search;

    if (boxes == 0) {
        return true;
    }
    if (!plan_search(map, lattice, JP_COST_PHYSICAL, task, memory, &search)) {
        return false;
    }
    hide(&world->solid, &search.route, task, boxes, seed);
    hide(&world->terrain, &search.route, task, boxes, seed);
    plan_route_free(&search.route);
    return true;
}

void navigation_world_free(struct navigation_world *world)
{
    free(world->blocks[0]);
    free(world->blocks[1]);
}
