#include "sim/lcm/lcm_map.h"

#include <jp_cells_t.h>
#include <jp_map_goal_t.h>
#include <jp_map_t.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/can/jp_can.h"
#include "hal/storage/crc32.h"

#define MAP_ID_MAX 15
#define HEAD_MAX   64U
#define TURN       4294967296.0

/** What follows the fingerprint and utime. */
#define CONTENT_PLACE 16U

/* Of a jp_map_t and a jp_cells_t, in bytes, big-endian. */
#define WIDTH_PLACE  18U
#define HEIGHT_PLACE 20U
#define COUNT_PLACE  18U
#define CELL_SIZE    5U

static uint32_t number_at(const uint8_t *at, unsigned bytes)
{
    uint32_t number = 0;

    for (unsigned i = 0; i < bytes; i++) {
        number = number << 8 | at[i];
    }
    return number;
}

static bool is_map_id(int16_t id)
{
    return id >= 1 && id <= MAP_ID_MAX;
}

static bool is_cell(uint8_t cell)
{
    return cell <= JP_CELL_UNKNOWN;
}

/** Of any number of turns. */
static jp_angle to_angle(double radians)
{
    return (jp_angle)(int64_t)rint(remainder(radians, 2 * M_PI) / (2 * M_PI) * TURN);
}

/* Maps. */

/** The generated decoder believes the sides that it reads, so the packet is judged before. */
static enum lcm_task_result judge_map(const uint8_t *packet, size_t size)
{
    const jp_map_t none = {.utime = 0};
    uint8_t sample[HEAD_MAX];
    const size_t head = (size_t)jp_map_t_encode(sample, 0, sizeof sample, &none);
    const enum lcm_task_result begins = lcm_task_begins(packet, size, sample, head);

    if (begins != LCM_TASK_OK) {
        return begins;
    }

    const uint32_t width = number_at(packet + WIDTH_PLACE, 2);
    const uint32_t height = number_at(packet + HEIGHT_PLACE, 2);

    if (width < 1U || width > JP_TERRAIN_SIDE_MAX || height < 1U || height > JP_TERRAIN_SIDE_MAX) {
        return LCM_TASK_SIDE;
    }
    if (size != head + (size_t)width * height) {
        return LCM_TASK_LENGTH;
    }
    for (size_t i = head; i < size; i++) {
        if (!is_cell(packet[i])) {
            return LCM_TASK_CELL;
        }
    }
    return LCM_TASK_OK;
}

static enum lcm_task_result to_head(const jp_map_t *message, struct jp_terrain_config *config, struct jp_place *origin)
{
    const double resolution = rint(message->resolution * JP_Q16_ONE);

    if (!is_map_id(message->map_id)) {
        return LCM_TASK_MAP_ID;
    }
    if (!isfinite(message->resolution) || !isfinite(message->origin_heading)) {
        return LCM_TASK_NUMBER;
    }
    if (resolution < 1 || resolution > INT32_MAX) {
        return LCM_TASK_RESOLUTION;
    }
    *config = (struct jp_terrain_config){.width = (uint16_t)message->width,
                                         .height = (uint16_t)message->height,
                                         .resolution = (jp_q16)resolution,
                                         .unknown_is_free = message->unknown_is_free != 0};
    origin->heading = to_angle(message->origin_heading);
    return lcm_task_point(&message->origin, &origin->point);
}

static void put_cells(const jp_map_t *message, struct jp_terrain *terrain)
{
    for (int16_t y = 0; y < message->height; y++) {
        for (int16_t x = 0; x < message->width; x++) {
            (void)jp_terrain_set_cell(terrain, x, y, (enum jp_cell)message->cells[y][x]);
        }
    }
}

/** The map over the bus has its length in 16 bits. */
static bool fits_bus(struct lcm_map *map)
{
    static uint8_t bytes[UINT16_MAX];

    return lcm_map_encode(map, bytes, sizeof bytes) > 0;
}

static enum lcm_task_result make(const jp_map_t *message, struct lcm_map *made)
{
    const size_t cells = (size_t)message->width * (size_t)message->height;
    struct jp_terrain_config config;
    const char *field;
    const enum lcm_task_result result = to_head(message, &config, &made->origin);

    if (result != LCM_TASK_OK) {
        return result;
    }
    made->id = (uint8_t)message->map_id;
    made->block = malloc(jp_terrain_size(&config));
    made->untold = calloc(cells, 1);
    if (made->block == NULL || made->untold == NULL) {
        return LCM_TASK_MEMORY;
    }
    (void)jp_terrain_init(&made->terrain, &config, made->block, jp_terrain_size(&config), &field);
    put_cells(message, &made->terrain);
    return fits_bus(made) ? LCM_TASK_OK : LCM_TASK_STREAM;
}

enum lcm_task_result lcm_map_read(struct lcm_map *map, const void *packet, size_t size, bool *is_new)
{
    struct lcm_map made = {.id = 0};
    jp_map_t message;
    enum lcm_task_result result = judge_map(packet, size);

    if (result != LCM_TASK_OK) {
        return result;
    }
    made.crc = jp_crc32(0, (const uint8_t *)packet + CONTENT_PLACE, size - CONTENT_PLACE);
    *is_new = map->id == 0U || made.crc != map->crc;
    if (!*is_new) {
        return LCM_TASK_OK;
    }
    if (jp_map_t_decode(packet, 0, (int)size, &message) < 0) {
        return LCM_TASK_MEMORY;
    }
    result = make(&message, &made);
    (void)jp_map_t_decode_cleanup(&message);
    if (result == LCM_TASK_OK) {
        lcm_map_free(map);
        *map = made;
    } else {
        lcm_map_free(&made);
    }
    return result;
}

void lcm_map_free(struct lcm_map *map)
{
    free(map->block);
    free(map->untold);
    *map = (struct lcm_map){.id = 0};
}

size_t lcm_map_encode(struct lcm_map *map, uint8_t *bytes, size_t size)
{
    const struct jp_terrain_config *config = &map->terrain.config;
    const size_t length = jp_map_encode(&map->terrain, &map->origin, bytes, size);

    if (length > 0) {
        memset(map->untold, 0, (size_t)config->width * config->height);
        map->untold_count = 0;
    }
    return length;
}

/** Whether a message with this id is of the map. */
static enum lcm_task_result judge_id(const struct lcm_map *map, int16_t id)
{
    if (map->id == 0U) {
        return LCM_TASK_NO_MAP;
    }
    return id == map->id ? LCM_TASK_OK : LCM_TASK_OTHER_MAP;
}

/* Cells. */

static enum lcm_task_result judge_cells(const uint8_t *packet, size_t size)
{
    const jp_cells_t none = {.utime = 0};
    uint8_t sample[HEAD_MAX];
    const size_t head = (size_t)jp_cells_t_encode(sample, 0, sizeof sample, &none);
    const enum lcm_task_result begins = lcm_task_begins(packet, size, sample, head);

    if (begins != LCM_TASK_OK) {
        return begins;
    }

    const uint32_t count = number_at(packet + COUNT_PLACE, 4);

    if (count < 1U || count > LCM_CELLS_MAX) {
        return LCM_TASK_CELLS;
    }
    return size == head + count * CELL_SIZE ? LCM_TASK_OK : LCM_TASK_LENGTH;
}

static enum lcm_task_result judge_each(const struct lcm_map *map, const jp_cells_t *message)
{
    enum lcm_task_result result = judge_id(map, message->map_id);

    for (int32_t i = 0; i < message->count && result == LCM_TASK_OK; i++) {
        const jp_cell_t *cell = &message->cells[i];

        if (!is_cell((uint8_t)cell->cell)) {
            result = LCM_TASK_CELL;
        } else if (!jp_terrain_contains(&map->terrain, cell->x, cell->y)) {
            result = LCM_TASK_OUTSIDE;
        } else {
            /* It is sound. */
        }
    }
    return result;
}

static void take_cell(struct lcm_map *map, const jp_cell_t *seen)
{
    const size_t place = (size_t)seen->y * map->terrain.config.width + (size_t)seen->x;
    const enum jp_cell cell = (enum jp_cell)seen->cell;

    if (jp_terrain_cell(&map->terrain, seen->x, seen->y) == cell) {
        return;
    }
    (void)jp_terrain_set_cell(&map->terrain, seen->x, seen->y, cell);
    map->untold_count += map->untold[place] == 0U;
    map->untold[place] = 1;
}

enum lcm_task_result lcm_map_read_cells(struct lcm_map *map, const void *packet, size_t size)
{
    jp_cells_t message;
    enum lcm_task_result result = judge_cells(packet, size);

    if (result != LCM_TASK_OK) {
        return result;
    }
    if (jp_cells_t_decode(packet, 0, (int)size, &message) < 0) {
        return LCM_TASK_MEMORY;
    }
    result = judge_each(map, &message);
    for (int32_t i = 0; i < message.count && result == LCM_TASK_OK; i++) {
        take_cell(map, &message.cells[i]);
    }
    (void)jp_cells_t_decode_cleanup(&message);
    return result;
}

void lcm_map_tell_cells(struct lcm_map *map, lcm_map_tell *tell, void *context)
{
    const uint16_t width = map->terrain.config.width;
    const uint8_t *const end = map->untold + (size_t)width * map->terrain.config.height;
    uint8_t *at = map->untold;

    while (map->untold_count > 0) {
        at = memchr(at, 1, (size_t)(end - at));

        const size_t place = (size_t)(at - map->untold);
        const uint16_t x = (uint16_t)(place % width);
        const uint16_t y = (uint16_t)(place / width);

        if (!tell(context, x, y, jp_terrain_cell(&map->terrain, x, y))) {
            return;
        }
        *at = 0;
        map->untold_count--;
    }
}

/* Goals. */

enum lcm_task_result lcm_map_read_goal(const struct lcm_map *map, const void *packet, size_t size,
                                       struct jp_map_goal *goal)
{
    const jp_map_goal_t none = {.utime = 0};
    jp_map_goal_t message;
    uint8_t sample[HEAD_MAX];
    const size_t whole = (size_t)jp_map_goal_t_encode(sample, 0, sizeof sample, &none);
    enum lcm_task_result result = lcm_task_begins(packet, size, sample, whole);

    if (result == LCM_TASK_OK && size != whole) {
        result = LCM_TASK_LENGTH;
    }
    if (result != LCM_TASK_OK) {
        return result;
    }
    (void)jp_map_goal_t_decode(packet, 0, (int)size, &message);
    result = judge_id(map, message.map_id);
    if (result != LCM_TASK_OK) {
        return result;
    }
    if (!isfinite(message.point.x) || !isfinite(message.point.y) || !isfinite(message.heading)) {
        return LCM_TASK_NUMBER;
    }

    const double resolution = map->terrain.config.resolution / (double)JP_Q16_ONE;
    const double x = floor(message.point.x / resolution);
    const double y = floor(message.point.y / resolution);

    if (x < 0 || y < 0 || x >= map->terrain.config.width || y >= map->terrain.config.height) {
        return LCM_TASK_OUTSIDE;
    }
    *goal = (struct jp_map_goal){.map = map->id,
                                 .x = (uint16_t)x,
                                 .y = (uint16_t)y,
                                 .has_heading = message.has_heading != 0,
                                 .heading = to_angle(message.heading)};
    return LCM_TASK_OK;
}
