#include "sim/missions/navigation_sight.h"

#include <math.h>

#define Q16     65536.0
#define TURN    4294967296.0
#define PI      3.14159265358979323846
#define RADIANS (2 * PI / TURN)

#define CLEARANCE_STEP 0.005 /* m */

static double cell_of(const struct navigation_task *task)
{
    return task->map->config.resolution / Q16;
}

struct clearance_pose navigation_start(const struct navigation_task *task)
{
    const double cell = cell_of(task);

    return (struct clearance_pose){(task->start.x + 0.5) * cell, (task->start.y + 0.5) * cell,
                                   task->lattice->heading[task->start.heading] * RADIANS};
}

struct jp_place navigation_place(const struct clearance_pose *pose)
{
    return (struct jp_place){{(jp_q16)lround(pose->x * Q16), (jp_q16)lround(pose->y * Q16)},
                             (jp_angle)(int64_t)llround(pose->heading / RADIANS)};
}

struct clearance_pose navigation_pose(const struct clearance_pose *start, const struct plant *plant)
{
    const double c = cos(start->heading);
    const double s = sin(start->heading);

    return (struct clearance_pose){start->x + plant->x * c - plant->y * s, start->y + plant->x * s + plant->y * c,
                                   start->heading + plant->state.yaw};
}

struct clearance_robot navigation_body(const struct robot_file *robot)
{
    return (struct clearance_robot){fmax(2 * robot->wheel.radius_m, robot->body.depth_m), robot->body.width_m, 0};
}

double navigation_goal_error(const struct navigation_task *task, const struct clearance_pose *pose)
{
    const double cell = cell_of(task);

    return hypot(pose->x - (task->goal.x + 0.5) * cell, pose->y - (task->goal.y + 0.5) * cell);
}

static bool is_seen(const struct navigation_task *task, const struct clearance_pose *from, int x, int y)
{
    const double cell = cell_of(task);
    const double dx = (x + 0.5) * cell - from->x;
    const double dy = (y + 0.5) * cell - from->y;
    const int steps = (int)ceil(2 * hypot(dx, dy) / cell);

    for (int i = 1; i < steps; i++) {
        const int u = (int)floor((from->x + dx * i / steps) / cell);
        const int v = (int)floor((from->y + dy * i / steps) / cell);

        if ((u != x || v != y) && jp_terrain_cell(task->solid, u, v) == JP_CELL_OCCUPIED) {
            return false;
        }
    }
    return true;
}

static void note_sight(const struct navigation_task *task, struct navigation_result *result, int x, int y)
{
    const struct navigation_sight sight = {x, y, result->seconds};

    result->seen++;
    if (task->see != NULL) {
        task->see(task->context, &sight);
    }
}

void navigation_look(const struct navigation_task *task, const struct clearance_pose *from,
                     struct navigation_result *result, bool (*tell)(void *context, int x, int y, enum jp_cell cell),
                     void *context)
{
    const double cell = cell_of(task);
    const int reach = (int)ceil(task->view_m / cell);
    const int x = (int)floor(from->x / cell);
    const int y = (int)floor(from->y / cell);

    for (int v = y - reach; v <= y + reach; v++) {
        for (int u = x - reach; u <= x + reach; u++) {
            const enum jp_cell is = jp_terrain_cell(task->world, u, v);
            const double distance = hypot((u + 0.5) * cell - from->x, (v + 0.5) * cell - from->y);

            if (is != jp_terrain_cell(task->map, u, v) && distance <= task->view_m && is_seen(task, from, u, v) &&
                tell(context, u, v, is)) {
                note_sight(task, result, u, v);
            }
        }
    }
}

void navigation_measure(const struct navigation_task *task, const struct clearance_robot *body,
                        const struct clearance_pose *pose, struct navigation_result *result)
{
    struct clearance_robot grown = *body;

    if (!result->is_touched && !clearance_at(task->solid, &grown, pose)) {
        result->is_touched = true;
        result->touched_at = *pose;
        result->clearance_m = 0;
    }
    grown.margin_m = result->clearance_m;
    while (result->clearance_m > 0 && !clearance_at(task->solid, &grown, pose)) {
        result->clearance_m = fmax(0, result->clearance_m - CLEARANCE_STEP);
        grown.margin_m = result->clearance_m;
    }
}
