#include "sim/missions/navigation_sight.h"

#include <math.h>

#include "sim/base/strict_math.h"

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
    const double c = strict_cos(start->heading);
    const double s = strict_sin(start->heading);

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

    return strict_hypot(pose->x - (task->goal.x + 0.5) * cell, pose->y - (task->goal.y + 0.5) * cell);
}

/** Of a cell's side, to either side of its middle: a blocked cell is free when nothing is there, so that it does not
 * come and go with every millimetre. */
#define CLEARLY 0.25

/** Where the cells of the robot's map truly are: it takes itself to be elsewhere than it is. */
struct shift {
    const struct clearance_pose *from; /**< where it truly is */
    struct clearance_pose believed;
    double c, s; /**< of the angle from believed to true */
    double cell;
};

static struct shift shift_of(const struct navigation_task *task, const struct clearance_pose *from,
                             const struct jp_place *believed)
{
    const double heading = (int32_t)believed->heading * RADIANS;
    const double turn = from->heading - heading;

    return (struct shift){.from = from,
                          .believed = {believed->point.x / Q16, believed->point.y / Q16, heading},
                          .c = strict_cos(turn),
                          .s = strict_sin(turn),
                          .cell = cell_of(task)};
}

/** The true place of a point of the map, in cells. */
static void true_place(const struct shift *shift, double x, double y, double place[2])
{
    const double dx = x * shift->cell - shift->believed.x;
    const double dy = y * shift->cell - shift->believed.y;

    place[0] = (shift->from->x + dx * shift->c - dy * shift->s) / shift->cell;
    place[1] = (shift->from->y + dx * shift->s + dy * shift->c) / shift->cell;
}

static enum jp_cell cell_at(const struct navigation_task *task, const struct shift *shift, double x, double y)
{
    double place[2];

    true_place(shift, x, y, place);
    return jp_terrain_cell(task->world, (int)floor(place[0]), (int)floor(place[1]));
}

static bool is_clearly_free(const struct navigation_task *task, const struct shift *shift, int x, int y)
{
    for (int i = 0; i < 4; i++) {
        const double u = x + 0.5 + (i % 2 == 0 ? CLEARLY : -CLEARLY);
        const double v = y + 0.5 + (i / 2 == 0 ? CLEARLY : -CLEARLY);

        if (cell_at(task, shift, u, v) == JP_CELL_OCCUPIED) {
            return false;
        }
    }
    return true;
}

/** What the robot takes a cell of its map to be, if it sees it. */
static enum jp_cell cell_seen(const struct navigation_task *task, const struct shift *shift, int x, int y)
{
    const enum jp_cell was = jp_terrain_cell(task->map, x, y);
    const enum jp_cell is = cell_at(task, shift, x + 0.5, y + 0.5);

    return was != JP_CELL_OCCUPIED || is == JP_CELL_OCCUPIED || is_clearly_free(task, shift, x, y) ? is : was;
}

/** Nothing stands before it. */
static bool is_in_view(const struct navigation_task *task, const struct shift *shift, int x, int y)
{
    double to[2];

    true_place(shift, x + 0.5, y + 0.5, to);

    const double from[2] = {shift->from->x / shift->cell, shift->from->y / shift->cell};
    const double distance = strict_hypot(to[0] - from[0], to[1] - from[1]);
    const int steps = (int)ceil(2 * distance);

    for (int i = 1; i < steps; i++) {
        const int u = (int)floor(from[0] + (to[0] - from[0]) * i / steps);
        const int v = (int)floor(from[1] + (to[1] - from[1]) * i / steps);
        const bool is_its_own = fabs(u + 0.5 - to[0]) < 1 && fabs(v + 0.5 - to[1]) < 1;

        if (!is_its_own && jp_terrain_cell(task->solid, u, v) == JP_CELL_OCCUPIED) {
            return false;
        }
    }
    return distance * shift->cell <= task->view_m;
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
                     const struct jp_place *believed, struct navigation_result *result,
                     bool (*tell)(void *context, int x, int y, enum jp_cell cell), void *context)
{
    const struct shift shift = shift_of(task, from, believed);
    const int reach = (int)ceil(task->view_m / shift.cell);
    const int x = (int)floor(shift.believed.x / shift.cell);
    const int y = (int)floor(shift.believed.y / shift.cell);

    for (int v = y - reach; v <= y + reach; v++) {
        for (int u = x - reach; u <= x + reach; u++) {
            const enum jp_cell is = cell_seen(task, &shift, u, v);

            if (is != jp_terrain_cell(task->map, u, v) && is_in_view(task, &shift, u, v) && tell(context, u, v, is)) {
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
