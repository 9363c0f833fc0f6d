#include <joulepath/return_map.h>

#include <stddef.h>

size_t jp_return_map_size(const struct jp_terrain_config *config)
{
    return 2U * jp_pose_field_size(config);
}

enum jp_status jp_return_map_init(struct jp_return_map *map, const struct jp_lattice *lattice,
                                  const struct jp_terrain *terrain, void *block, size_t size)
{
    if (map == NULL || terrain == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const size_t half = jp_pose_field_size(&terrain->config);
    const enum jp_status status = jp_pose_field_init(&map->out, lattice, JP_COST_PHYSICAL, terrain, block, size);

    if (status != JP_OK) {
        return status;
    }
    return jp_pose_field_init(&map->back, lattice, JP_COST_PHYSICAL, terrain, (uint8_t *)block + half, size - half);
}

enum jp_status jp_return_map_start(struct jp_return_map *map, const struct jp_lattice_pose *from, int32_t x, int32_t y,
                                   jp_cost limit)
{
    if (map == NULL || from == NULL || from->heading >= JP_HEADINGS) {
        return JP_ERR_ARGUMENT;
    }
    const enum jp_status status = jp_pose_field_start(&map->out, JP_POSE_FIELD_FROM_ROOT, from->x, from->y,
                                                      (uint16_t)(1U << from->heading), limit);

    return status == JP_OK ? jp_pose_field_start(&map->back, JP_POSE_FIELD_TO_ROOT, x, y, JP_ANY_HEADING, limit)
                           : status;
}

bool jp_return_map_work(struct jp_return_map *map, unsigned poses)
{
    return jp_pose_field_grow(&map->out, &poses) && jp_pose_field_grow(&map->back, &poses);
}

jp_cost jp_return_map_cost(const struct jp_return_map *map, int32_t x, int32_t y)
{
    jp_cost least = JP_COST_MAX;

    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const jp_cost cost =
            jp_cost_add(jp_pose_field_cost(&map->out, x, y, heading), jp_pose_field_cost(&map->back, x, y, heading));

        least = cost < least ? cost : least;
    }
    return least;
}
