#include "sim/scenes/patrol_draft.h"

#include <math.h>
#include <stdlib.h>

#include "sim/base/clearance.h"
#include "sim/base/strict_math.h"

#define CELL JP_Q16(0.05) /* side, m */

#define TURN_RADIUS_M 0.5 /* of the circle of the robot's corners */

#define SPARE_M       0.1  /* around the robot at start and goal, and on both sides of its path */
#define TURN_SPARE_M  0.05 /* around the circle that it turns in */
#define DOCKING_STEP  0.05 /* m */
#define DOCKING_STEPS 160  /* of the longest straight path into the goal */
#define WALKER_M      1.5  /* between start or goal and the path of a walker */
#define WALK_STEP     0.05 /* m */

#define SPANS_MAX 40 /* rows of the largest disc */
#define DEGREES   (180 / M_PI)

enum { MIRROR_X = 1, MIRROR_Y = 2, EXCHANGE = 4, SYMMETRIES = 8 };

/* ---- Random numbers ---- */

int patrol_draft_between(struct patrol_draft *draft, int low, int high)
{
    return low + (int)random_uniform(&draft->random, 0, high - low + 1);
}

bool patrol_draft_once_in(struct patrol_draft *draft, int times)
{
    return patrol_draft_between(draft, 1, times) == 1;
}

int patrol_draft_side(struct patrol_draft *draft)
{
    return patrol_draft_once_in(draft, 2) ? -1 : 1;
}

/* ---- Layout ---- */

static void init_terrain(struct jp_terrain *terrain, const struct jp_terrain_config *config, void *block, size_t size)
{
    const char *field;

    if (jp_terrain_init(terrain, config, block, size, &field) != JP_OK) {
        abort();
    }
}

void patrol_draft_begin(struct patrol_draft *draft, int width, int height)
{
    struct patrol_scene *scene = draft->scene;

    draft->width = width;
    draft->height = height;
    draft->symmetry = (unsigned)patrol_draft_between(draft, 0, SYMMETRIES - 1);
    const bool exchanged = (draft->symmetry & EXCHANGE) != 0;
    const struct jp_terrain_config config = {.width = (uint16_t)(exchanged ? height : width),
                                             .height = (uint16_t)(exchanged ? width : height),
                                             .resolution = CELL};
    const size_t size = (jp_terrain_size(&config) + 7) / 8 * 8;
    const struct patrol_area all = {0, 0, width, height};

    free(scene->block);
    scene->block = malloc(2 * size);
    if (scene->block == NULL) {
        abort();
    }
    init_terrain(&scene->map, &config, scene->block, size);
    init_terrain(&scene->ground, &config, (char *)scene->block + size, size);
    scene->mover_count = 0;
    scene->people_count = 0;
    patrol_draft_fill(draft, PATROL_BOTH, &all, JP_CELL_OCCUPIED);
}

static void set_cell(struct patrol_draft *draft, enum patrol_layer layer, int x, int y, enum jp_cell cell)
{
    const int u = (draft->symmetry & MIRROR_X) != 0 ? draft->width - 1 - x : x;
    const int v = (draft->symmetry & MIRROR_Y) != 0 ? draft->height - 1 - y : y;
    const bool exchanged = (draft->symmetry & EXCHANGE) != 0;

    (void)jp_terrain_set_cell(&draft->scene->ground, exchanged ? v : u, exchanged ? u : v, cell);
    if (layer == PATROL_BOTH) {
        (void)jp_terrain_set_cell(&draft->scene->map, exchanged ? v : u, exchanged ? u : v, cell);
    }
}

void patrol_draft_fill(struct patrol_draft *draft, enum patrol_layer layer, const struct patrol_area *area,
                       enum jp_cell cell)
{
    for (int y = area->y; y < area->y + area->height; y++) {
        for (int x = area->x; x < area->x + area->width; x++) {
            set_cell(draft, layer, x, y, cell);
        }
    }
}

static double cell_m(const struct jp_terrain *terrain)
{
    return (double)terrain->config.resolution / JP_Q16_ONE;
}

struct jp_plane_pose patrol_draft_pose(const struct patrol_draft *draft, double x, double y, int heading)
{
    const double cell = cell_m(&draft->scene->ground);

    if ((draft->symmetry & MIRROR_X) != 0) {
        x = draft->width - x;
        heading = 180 - heading;
    }
    if ((draft->symmetry & MIRROR_Y) != 0) {
        y = draft->height - y;
        heading = -heading;
    }
    if ((draft->symmetry & EXCHANGE) != 0) {
        const double former = x;
        x = y;
        y = former;
        heading = 90 - heading;
    }
    return (struct jp_plane_pose){(float)(x * cell), (float)(y * cell), (float)(planar_wrap(heading / DEGREES))};
}

/* ---- Shapes on the map ---- */

static double distance_from(const struct planar_shape *shape, double x, double y)
{
    const double dx = x - shape->pose.x;
    const double dy = y - shape->pose.y;

    if (shape->kind == PLANAR_DISC) {
        return fmax(strict_hypot(dx, dy) - shape->radius, 0);
    }
    const double cosine = strict_cos(shape->pose.heading);
    const double sine = strict_sin(shape->pose.heading);
    const double along = fabs(cosine * dx + sine * dy) - shape->half_length;
    const double across = fabs(cosine * dy - sine * dx) - shape->half_width;
    return strict_hypot(fmax(along, 0), fmax(across, 0));
}

void patrol_draft_hide(struct patrol_draft *draft, const struct planar_shape *shape)
{
    struct jp_terrain *ground = &draft->scene->ground;
    const double cell = cell_m(ground);
    const int reach = (int)(planar_reach(shape) / cell) + 1;
    const int column = (int)(shape->pose.x / cell);
    const int row = (int)(shape->pose.y / cell);

    for (int y = row - reach; y <= row + reach; y++) {
        for (int x = column - reach; x <= column + reach; x++) {
            if (distance_from(shape, (x + 0.5) * cell, (y + 0.5) * cell) <= 0) {
                (void)jp_terrain_set_cell(ground, x, y, JP_CELL_OCCUPIED); /* off the map it is solid anyway */
            }
        }
    }
}

void patrol_draft_add(struct patrol_draft *draft, const struct patrol_obstacle *mover)
{
    draft->scene->movers[draft->scene->mover_count++] = *mover;
}

/* ---- Promises ---- */

bool patrol_draft_add_person(struct patrol_draft *draft, const struct walker *person)
{
    struct patrol_scene *const scene = draft->scene;

    if (scene->people_count == PATROL_PEOPLE_MAX) {
        return false;
    }
    scene->people[scene->people_count++] = *person;
    return true;
}

static bool stands(const struct patrol_obstacle *mover)
{
    return mover->waypoint_count == 1;
}

static struct planar_shape standing_shape(const struct patrol_obstacle *mover)
{
    struct planar_shape shape = mover->shape;

    shape.pose = (struct planar_pose){mover->waypoints[0].x, mover->waypoints[0].y, 0};
    return shape;
}

/* What a disc touches that stands in the middle of a cell. */
struct disc {
    struct jp_span spans[SPANS_MAX];
    size_t count;
    double radius; /* m */
};

static struct disc make_disc(const struct jp_terrain *terrain, double radius)
{
    struct disc disc = {.radius = radius};
    const double cells = radius / cell_m(terrain);
    const int reach = (int)(cells + 0.5);

    for (int y = -reach; y <= reach; y++) {
        const double dy = y == 0 ? 0 : abs(y) - 0.5;
        if (dy < cells) {
            const int8_t half = (int8_t)(sqrt(cells * cells - dy * dy) + 0.5);
            disc.spans[disc.count++] = (struct jp_span){(int8_t)y, (int8_t)-half, half};
        }
    }
    return disc;
}

static bool disc_fits(const struct patrol_scene *scene, const struct disc *disc, int x, int y)
{
    const double cell = cell_m(&scene->ground);

    for (size_t i = 0; i < scene->mover_count; i++) {
        const struct planar_shape shape = standing_shape(&scene->movers[i]);
        if (stands(&scene->movers[i]) && distance_from(&shape, (x + 0.5) * cell, (y + 0.5) * cell) < disc->radius) {
            return false;
        }
    }
    return jp_terrain_is_clear(&scene->ground, disc->spans, disc->count, x, y);
}

static bool disc_fits_at(const struct patrol_scene *scene, const struct disc *disc, const struct planar_pose *pose)
{
    const double cell = cell_m(&scene->ground);

    return disc_fits(scene, disc, (int)floor(pose->x / cell), (int)floor(pose->y / cell));
}

static struct planar_pose planar_of(const struct jp_plane_pose *pose)
{
    return (struct planar_pose){(double)pose->x, (double)pose->y, (double)pose->heading};
}

static bool robot_fits(const struct patrol_scene *scene, const struct planar_pose *pose)
{
    static const struct clearance_robot robot = {PATROL_ROBOT_LENGTH_M, PATROL_ROBOT_WIDTH_M, SPARE_M};
    const struct planar_shape body = {.kind = PLANAR_BOX,
                                      .pose = *pose,
                                      .half_length = PATROL_ROBOT_LENGTH_M / 2,
                                      .half_width = PATROL_ROBOT_WIDTH_M / 2};

    for (size_t i = 0; i < scene->mover_count; i++) {
        const struct patrol_obstacle *mover = &scene->movers[i];
        if (stands(mover) && distance_from(&body, mover->waypoints[0].x, mover->waypoints[0].y) <
                                 planar_reach(&mover->shape) + SPARE_M) {
            return false;
        }
    }
    return clearance_at(&scene->ground, &robot, &(struct clearance_pose){pose->x, pose->y, pose->heading});
}

bool patrol_draft_has_room(const struct patrol_draft *draft, const struct jp_plane_pose *pose, double radius)
{
    const struct disc disc = make_disc(&draft->scene->ground, radius);
    const struct planar_pose centre = planar_of(pose);

    return disc_fits_at(draft->scene, &disc, &centre);
}

/* The robot can turn at the goal, or straight behind it where it fits from there on. */
static bool can_dock(const struct patrol_scene *scene, const struct disc *turning)
{
    const struct planar_pose goal = planar_of(&scene->goal);

    for (int i = 0; i <= DOCKING_STEPS; i++) {
        const struct planar_pose pose = planar_compose(&goal, &(struct planar_pose){-DOCKING_STEP * i, 0, 0});
        if (!robot_fits(scene, &pose)) {
            return false;
        }
        if (disc_fits_at(scene, turning, &pose)) {
            return true;
        }
    }
    return false;
}

struct flood {
    const struct patrol_scene *scene;
    const struct disc *disc;
    bool *seen;
    int *queue; /* cells, row by row */
    size_t tail;
};

static void visit(struct flood *flood, int x, int y)
{
    const struct jp_terrain *ground = &flood->scene->ground;
    const int cell = y * ground->config.width + x;

    if (jp_terrain_contains(ground, x, y) && !flood->seen[cell]) {
        flood->seen[cell] = true;
        if (disc_fits(flood->scene, flood->disc, x, y)) {
            flood->queue[flood->tail++] = cell;
        }
    }
}

static bool flood_reaches(struct flood *flood, int from, int to)
{
    const int width = flood->scene->ground.config.width;

    visit(flood, from % width, from / width);
    for (size_t head = 0; head < flood->tail; head++) {
        const int x = flood->queue[head] % width;
        const int y = flood->queue[head] / width;
        if (flood->queue[head] == to) {
            return true;
        }
        visit(flood, x + 1, y);
        visit(flood, x - 1, y);
        visit(flood, x, y + 1);
        visit(flood, x, y - 1);
    }
    return false;
}

static int cell_of(const struct patrol_scene *scene, const struct jp_plane_pose *pose)
{
    const double cell = cell_m(&scene->ground);

    return (int)((double)pose->y / cell) * scene->ground.config.width + (int)((double)pose->x / cell);
}

static bool is_reachable(const struct patrol_scene *scene)
{
    const struct disc disc = make_disc(&scene->ground, PATROL_ROBOT_WIDTH_M / 2 + SPARE_M);
    const size_t count = (size_t)scene->ground.config.width * scene->ground.config.height;
    struct flood flood = {.scene = scene,
                          .disc = &disc,
                          .seen = calloc(count, sizeof *flood.seen),
                          .queue = calloc(count, sizeof *flood.queue)};

    if (flood.seen == NULL || flood.queue == NULL) {
        abort();
    }
    const bool reached = flood_reaches(&flood, cell_of(scene, &scene->start), cell_of(scene, &scene->goal));
    free(flood.queue);
    free(flood.seen);
    return reached;
}

/* Nobody walks through a wall, or over the robot where it waits or where it must stop. */
static bool leg_is_free(const struct patrol_scene *scene, const struct disc *disc, const struct planar_point *from,
                        const struct planar_point *to)
{
    const int steps = (int)(strict_hypot(to->x - from->x, to->y - from->y) / WALK_STEP) + 1;

    for (int i = 0; i <= steps; i++) {
        const struct planar_pose at = {from->x + (to->x - from->x) * i / steps, from->y + (to->y - from->y) * i / steps,
                                       0};
        if (!disc_fits_at(scene, disc, &at) ||
            strict_hypot(at.x - (double)scene->start.x, at.y - (double)scene->start.y) < WALKER_M ||
            strict_hypot(at.x - (double)scene->goal.x, at.y - (double)scene->goal.y) < WALKER_M) {
            return false;
        }
    }
    return true;
}

static bool walks_are_free(const struct patrol_scene *scene)
{
    for (size_t i = 0; i < scene->people_count; i++) {
        const struct walker *person = &scene->people[i];
        const struct disc disc = make_disc(&scene->ground, person->radius);

        if (!leg_is_free(scene, &disc, &person->from, &person->to)) {
            return false;
        }
    }
    return true;
}

bool patrol_draft_is_sound(const struct patrol_draft *draft)
{
    const struct patrol_scene *scene = draft->scene;
    const struct disc turning = make_disc(&scene->ground, TURN_RADIUS_M + TURN_SPARE_M);
    const struct planar_pose goal = planar_of(&scene->goal);

    return patrol_draft_has_room(draft, &scene->start, TURN_RADIUS_M + SPARE_M) && robot_fits(scene, &goal) &&
           can_dock(scene, &turning) && walks_are_free(scene) && is_reachable(scene);
}
