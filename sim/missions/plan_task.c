#include "sim/missions/plan_task.h"

#include <math.h>
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/base/strict_math.h"

#define DEGREES (180 / M_PI)

#define NOT_REACHED INT32_MAX

/* ---- Frames ---- */

static double resolution_of(const struct map_file *map)
{
    return (double)map->terrain.config.resolution / JP_Q16_ONE;
}

static double heading_of(const struct jp_lattice *lattice, unsigned heading)
{
    return (double)lattice->heading[heading] * (2 * M_PI / 4294967296.0);
}

struct clearance_pose plan_grid_pose(const struct map_file *map, const struct jp_lattice *lattice,
                                     const struct jp_lattice_pose *pose)
{
    const double cell = resolution_of(map);

    return (struct clearance_pose){(pose->x + 0.5) * cell, (pose->y + 0.5) * cell, heading_of(lattice, pose->heading)};
}

struct plan_place plan_map_place(const struct map_file *map, const struct clearance_pose *pose)
{
    const double yaw = map->origin[2];

    return (struct plan_place){map->origin[0] + pose->x * strict_cos(yaw) - pose->y * strict_sin(yaw),
                               map->origin[1] + pose->x * strict_sin(yaw) + pose->y * strict_cos(yaw),
                               (pose->heading + yaw) * DEGREES, true};
}

/* ---- Given places ---- */

bool plan_place_parse(const char *text, struct plan_place *place)
{
    double value[3] = {0};
    unsigned count = 0;
    char *end = (char *)text;

    do {
        const char *begin = end + (count > 0 ? 1 : 0);
        value[count] = strtod(begin, &end);
        if (end == begin || !isfinite(value[count])) {
            return false;
        }
        count++;
    } while (*end == ',' && count < 3);
    *place = (struct plan_place){value[0], value[1], value[2], count == 3};
    return *end == '\0' && count >= 2;
}

static bool find_cell(const struct map_file *map, const char *what, const struct plan_place *place, int16_t *x,
                      int16_t *y)
{
    const double cell = resolution_of(map);
    const double yaw = map->origin[2];
    const double dx = place->x - map->origin[0];
    const double dy = place->y - map->origin[1];
    const double column = floor((dx * strict_cos(yaw) + dy * strict_sin(yaw)) / cell);
    const double row = floor((dy * strict_cos(yaw) - dx * strict_sin(yaw)) / cell);
    const struct jp_terrain_config *config = &map->terrain.config;

    if (!(column >= 0 && column < config->width && row >= 0 && row < config->height)) {
        error_line("%s %g,%g: outside the map, whose south-west corner is %.1f,%.1f m and which is %.1f m × %.1f m; "
                   "give a place inside",
                   what, place->x, place->y, map->origin[0], map->origin[1], config->width * cell,
                   config->height * cell);
        return false;
    }
    *x = (int16_t)column;
    *y = (int16_t)row;
    return true;
}

static unsigned nearest_heading(const struct jp_lattice *lattice, double heading)
{
    unsigned nearest = 0;

    for (unsigned i = 1; i < JP_HEADINGS; i++) {
        if (fabs(remainder(heading_of(lattice, i) - heading, 2 * M_PI)) <
            fabs(remainder(heading_of(lattice, nearest) - heading, 2 * M_PI))) {
            nearest = i;
        }
    }
    return nearest;
}

static unsigned heading_at(const struct map_file *map, const struct jp_lattice *lattice, const struct plan_place *place)
{
    return nearest_heading(lattice, place->heading_deg / DEGREES - map->origin[2]);
}

static uint16_t headings_of(const struct map_file *map, const struct jp_lattice *lattice, const struct plan_place *goal)
{
    if (!goal->has_heading) {
        return JP_ANY_HEADING;
    }
    return (uint16_t)(1U << heading_at(map, lattice, goal));
}

bool plan_task_set(const struct map_file *map, const struct jp_lattice *lattice, const struct plan_place *start,
                   const struct plan_place *goal, struct plan_task *task)
{
    *task = (struct plan_task){.start.heading = (uint8_t)heading_at(map, lattice, start),
                               .goal.headings = headings_of(map, lattice, goal)};
    return find_cell(map, "--start", start, &task->start.x, &task->start.y) &&
           find_cell(map, "--goal", goal, &task->goal.x, &task->goal.y);
}

/* ---- Chosen places ---- */

/** Steps from a cell to all others over cells on which the robot can turn round. */
struct flood {
    const struct jp_terrain *terrain;
    bool *is_open;
    int32_t *steps;
    int32_t *queue;
};

static int32_t cell_count(const struct jp_terrain *terrain)
{
    return (int32_t)terrain->config.width * terrain->config.height;
}

static bool can_turn_round(const struct jp_terrain *terrain, const struct jp_lattice *lattice, int32_t cell)
{
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        if (!jp_lattice_can_stand(lattice, terrain, cell % terrain->config.width, cell / terrain->config.width,
                                  heading)) {
            return false;
        }
    }
    return true;
}

static void reach(struct flood *flood, int32_t x, int32_t y, int32_t steps, int32_t *tail)
{
    const int32_t cell = y * flood->terrain->config.width + x;

    if (jp_terrain_contains(flood->terrain, x, y) && flood->is_open[cell] && flood->steps[cell] == NOT_REACHED) {
        flood->steps[cell] = steps;
        flood->queue[(*tail)++] = cell;
    }
}

/* Floods from a cell; the queue then holds what was reached, the farthest last. Returns how many cells that are. */
static int32_t spread(struct flood *flood, int32_t from)
{
    const int32_t width = flood->terrain->config.width;
    int32_t tail = 0;

    reach(flood, from % width, from / width, 0, &tail);
    for (int32_t head = 0; head < tail; head++) {
        const int32_t x = flood->queue[head] % width;
        const int32_t y = flood->queue[head] / width;
        const int32_t steps = flood->steps[flood->queue[head]] + 1;
        reach(flood, x + 1, y, steps, &tail);
        reach(flood, x - 1, y, steps, &tail);
        reach(flood, x, y + 1, steps, &tail);
        reach(flood, x, y - 1, steps, &tail);
    }
    return tail;
}

static void forget(struct flood *flood)
{
    for (int32_t i = 0; i < cell_count(flood->terrain); i++) {
        flood->steps[i] = NOT_REACHED;
    }
}

/* The cell of the largest part that is farthest from its first one; −1 when nothing is open. */
static int32_t end_of_largest_part(struct flood *flood)
{
    int32_t largest = 0;
    int32_t end = -1;

    forget(flood);
    for (int32_t i = 0; i < cell_count(flood->terrain); i++) {
        const int32_t size = spread(flood, i);
        if (size > largest) {
            largest = size;
            end = flood->queue[size - 1];
        }
    }
    return end;
}

/* Two cells far apart: the second is the farthest from the first. False when nothing is open. */
static bool find_ends(struct flood *flood, int32_t *first, int32_t *second)
{
    *first = end_of_largest_part(flood);
    if (*first < 0) {
        return false;
    }
    forget(flood);
    *second = flood->queue[spread(flood, *first) - 1];
    return *second != *first;
}

static bool choose(struct flood *flood, const struct jp_lattice *lattice, struct plan_task *task)
{
    const int32_t width = flood->terrain->config.width;
    int32_t start;
    int32_t goal;

    for (int32_t i = 0; i < cell_count(flood->terrain); i++) {
        flood->is_open[i] = can_turn_round(flood->terrain, lattice, i);
    }
    if (!find_ends(flood, &start, &goal)) {
        return false;
    }
    const struct jp_lattice_pose from = {(int16_t)(start % width), (int16_t)(start / width), 0};
    const struct jp_lattice_pose to = {(int16_t)(goal % width), (int16_t)(goal / width), 0};
    const unsigned heading = nearest_heading(lattice, strict_atan2(to.y - from.y, to.x - from.x));
    *task = (struct plan_task){
        .start = {from.x, from.y, (uint8_t)heading}, .goal = {to.x, to.y, JP_ANY_HEADING}, .is_chosen = true};
    return true;
}

bool plan_task_choose(const struct map_file *map, const struct jp_lattice *lattice, struct plan_task *task)
{
    const size_t count = (size_t)cell_count(&map->terrain);
    struct flood flood = {.terrain = &map->terrain,
                          .is_open = calloc(count, sizeof *flood.is_open),
                          .steps = calloc(count, sizeof *flood.steps),
                          .queue = calloc(count, sizeof *flood.queue)};
    bool chosen = false;

    if (flood.is_open == NULL || flood.steps == NULL || flood.queue == NULL) {
        error_line("%s: no memory for its %zu cells", map->name, count);
    } else {
        chosen = choose(&flood, lattice, task);
        if (!chosen) {
            error_line("%s: %s can turn round nowhere and drive on; give --start and --goal, or a finer map", map->name,
                       lattice->name);
        }
    }
    free(flood.is_open);
    free(flood.steps);
    free(flood.queue);
    return chosen;
}
