#include "sim/scenes/patrol_world.h"

#include "sim/base/strict_math.h"

/* Nearer than this each shape is asked whether the robot touches it, m. */
#define NEAR 0.02

/* The distance so far is kept this exactly, m. */
#define DISTANCE_STEP 0.001

/* Shapes are looked for up to this much beyond the least distance so far, m: until the robot and they have moved by as
 * much, none of the others can be nearer. */
#define FORESIGHT 0.2

/* Of the robot's motion that brings it nearer to a person, m/s. */
#define NEARING 0.02

#define DECELERATION 1.0 /* m/s² */

/* ---- Obstacles ------------------------------------------------------------------------------------------------- */

static struct planar_point corner(const struct patrol_obstacle *obstacle, size_t index)
{
    return obstacle->waypoints[index % obstacle->waypoint_count];
}

static double leg_length(const struct patrol_obstacle *obstacle, size_t leg)
{
    const struct planar_point from = corner(obstacle, leg);
    const struct planar_point to = corner(obstacle, leg + 1);

    return strict_hypot(to.x - from.x, to.y - from.y);
}

static double way_length(const struct patrol_obstacle *obstacle, size_t legs)
{
    double length = 0;

    for (size_t leg = 0; leg < legs; leg++) {
        length += leg_length(obstacle, leg);
    }
    return length;
}

/* Where along its waypoints an obstacle is, m, and in which direction it goes: 1, −1 or 0. */
static double progress(const struct patrol_obstacle *obstacle, double length, double time, int *direction)
{
    const double way = obstacle->speed * fmax(time - obstacle->starts, 0);

    *direction = way > 0;
    switch (obstacle->end) {
    case PATROL_LOOPS:
        return fmod(way, length);
    case PATROL_RETURNS: {
        const double there_and_back = fmod(way, 2 * length);
        *direction = there_and_back <= length ? *direction : -1;
        return fmin(there_and_back, 2 * length - there_and_back);
    }
    default:
        *direction = way < length ? *direction : 0;
        return fmin(way, length);
    }
}

static void move(const struct patrol_obstacle *obstacle, double time, struct planar_shape *shape,
                 struct planar_point *velocity)
{
    const size_t legs = obstacle->waypoint_count - (obstacle->end == PATROL_LOOPS ? 0 : 1);
    const double length = way_length(obstacle, legs);

    *shape = obstacle->shape;
    *velocity = (struct planar_point){0, 0};
    shape->pose = (struct planar_pose){obstacle->waypoints[0].x, obstacle->waypoints[0].y, 0};
    if (length == 0) {
        return;
    }
    int direction;
    double left = progress(obstacle, length, time, &direction);
    size_t leg = 0;
    while (leg + 1 < legs && left > leg_length(obstacle, leg)) {
        left -= leg_length(obstacle, leg);
        leg++;
    }
    const struct planar_point from = corner(obstacle, leg);
    const struct planar_point to = corner(obstacle, leg + 1);
    const double bearing = strict_atan2(to.y - from.y, to.x - from.x);
    const double speed = direction * obstacle->speed;
    shape->pose = (struct planar_pose){from.x + left * strict_cos(bearing), from.y + left * strict_sin(bearing),
                                       planar_wrap(bearing + (direction < 0 ? M_PI : 0))};
    velocity->x = speed * strict_cos(bearing);
    velocity->y = speed * strict_sin(bearing);
}

/* How far any point of a shape has moved at most, m, since it was at a pose. */
static double way_between(const struct planar_pose *from, const struct planar_shape *shape)
{
    const struct planar_pose moved = planar_between(from, &shape->pose);

    return strict_hypot(moved.x, moved.y) + planar_reach(shape) * fabs(moved.heading);
}

static struct planar_shape person_shape(const struct walker *person, const struct walker_state *walk)
{
    const struct planar_point at = walker_place(person, walk);

    return (struct planar_shape){.kind = PLANAR_DISC, .pose = {at.x, at.y, 0}, .radius = person->radius};
}

static void place_people(struct patrol_world *world)
{
    for (size_t i = 0; i < world->people_count; i++) {
        world->shapes[world->shape_count] = person_shape(&world->people[i], &world->walks[i]);
        world->velocities[world->shape_count] = walker_velocity(&world->people[i], &world->walks[i]);
        world->shape_count++;
    }
}

/* Sets the shapes that are there now. How far any point of one has moved at most, m; infinity when one appeared. */
static double place_obstacles(struct patrol_world *world)
{
    const size_t before = world->thing_count;
    double way = 0;

    world->shape_count = 0;
    for (size_t i = 0; i < world->obstacle_count; i++) {
        if (world->time >= world->obstacles[i].appears) {
            struct planar_shape *shape = &world->shapes[world->shape_count];
            const struct planar_pose from = shape->pose;
            move(&world->obstacles[i], world->time, shape, &world->velocities[world->shape_count]);
            way = fmax(way, way_between(&from, shape));
            world->shape_count++;
        }
    }
    world->thing_count = world->shape_count;
    place_people(world);
    return world->thing_count == before ? way : INFINITY;
}

/* ---- Solid cells near the robot, run by run -------------------------------------------------------------------- */

/* Cells (x, y)…(last, y), and what is left of the rectangle of cells after them. */
struct runs {
    const struct solid_map *map;
    int left, right; /* cells, inclusive */
    int top;
    int x, y;
    int last;
};

static struct runs runs_around(const struct solid_map *map, const struct planar_shape *robot, double margin)
{
    const double cosine = fabs(strict_cos(robot->pose.heading));
    const double sine = fabs(strict_sin(robot->pose.heading));
    const double reach_x = robot->half_length * cosine + robot->half_width * sine + margin;
    const double reach_y = robot->half_length * sine + robot->half_width * cosine + margin;
    const int left = (int)floor((robot->pose.x - reach_x) / map->cell);

    return (struct runs){.map = map,
                         .left = left,
                         .right = (int)floor((robot->pose.x + reach_x) / map->cell),
                         .top = (int)floor((robot->pose.y + reach_y) / map->cell),
                         .y = (int)floor((robot->pose.y - reach_y) / map->cell),
                         .last = left - 1};
}

/* The next run of solid cells in a row; false: there is none. */
static bool next_run(struct runs *runs)
{
    for (; runs->y <= runs->top; runs->y++) {
        int x = runs->last + 1;
        while (x <= runs->right && solid_map_distance(runs->map, x, runs->y) > 0) {
            x += solid_map_distance(runs->map, x, runs->y);
        }
        if (x <= runs->right) {
            runs->x = x;
            while (x <= runs->right && solid_map_distance(runs->map, x, runs->y) == 0) {
                x++;
            }
            runs->last = x - 1;
            return true;
        }
        runs->last = runs->left - 1;
    }
    return false;
}

static struct planar_shape run_shape(const struct runs *runs)
{
    const double cell = runs->map->cell;

    return (struct planar_shape){.kind = PLANAR_BOX,
                                 .pose = {(runs->x + runs->last + 1) / 2.0 * cell, (runs->y + 0.5) * cell, 0},
                                 .half_length = (runs->last + 1 - runs->x) / 2.0 * cell,
                                 .half_width = cell / 2};
}

/* ---- Distances ------------------------------------------------------------------------------------------------- */

/* A box with what is needed of it again and again. */
struct box {
    struct planar_pose pose;
    double cosine;
    double sine;
    double half_length;
    double half_width;
};

static struct box box_of(const struct planar_shape *shape)
{
    return (struct box){shape->pose, strict_cos(shape->pose.heading), strict_sin(shape->pose.heading),
                        shape->half_length, shape->half_width};
}

/* Of a point from a box; 0 within. */
static double point_distance(const struct box *box, double x, double y)
{
    const double dx = x - box->pose.x;
    const double dy = y - box->pose.y;
    const double out_x = fabs(box->cosine * dx + box->sine * dy) - box->half_length;
    const double out_y = fabs(box->cosine * dy - box->sine * dx) - box->half_width;

    return strict_hypot(fmax(out_x, 0), fmax(out_y, 0));
}

/* Least distance of the corners of `a` from `b`. */
static double corners_distance(const struct box *a, const struct box *b)
{
    double least = INFINITY;

    for (int i = 0; i < 4; i++) {
        const double u = (i & 1 ? 1 : -1) * a->half_length;
        const double v = (i & 2 ? 1 : -1) * a->half_width;
        least = fmin(
            least, point_distance(b, a->pose.x + a->cosine * u - a->sine * v, a->pose.y + a->sine * u + a->cosine * v));
    }
    return least;
}

/* Whether an axis of `a` parts the boxes. */
static bool parts(const struct box *a, const struct box *b)
{
    const double dx = b->pose.x - a->pose.x;
    const double dy = b->pose.y - a->pose.y;
    const double cosine = fabs(a->cosine * b->cosine + a->sine * b->sine);
    const double sine = fabs(a->cosine * b->sine - a->sine * b->cosine);

    return fabs(a->cosine * dx + a->sine * dy) > a->half_length + b->half_length * cosine + b->half_width * sine ||
           fabs(a->cosine * dy - a->sine * dx) > a->half_width + b->half_length * sine + b->half_width * cosine;
}

/* The least distance of parted boxes is at a corner of one of them. */
static double box_distance(const struct box *robot, const struct planar_shape *shape)
{
    const struct box box = box_of(shape);

    return parts(robot, &box) || parts(&box, robot) ? fmin(corners_distance(robot, &box), corners_distance(&box, robot))
                                                    : 0;
}

static double shape_distance(const struct box *robot, const struct planar_shape *shape)
{
    if (shape->kind == PLANAR_BOX) {
        return box_distance(robot, shape);
    }
    return fmax(point_distance(robot, shape->pose.x, shape->pose.y) - shape->radius, 0);
}

static bool touches(const struct box *robot, const struct planar_shape *shape)
{
    return shape_distance(robot, shape) <= 0;
}

/* No solid cell is near enough to touch the circle around the robot, grown by a margin. */
static bool is_open(const struct patrol_world *world, double margin)
{
    const struct solid_map *map = &world->map;
    const int x = (int)floor(world->robot.pose.x / map->cell);
    const int y = (int)floor(world->robot.pose.y / map->cell);

    return (solid_map_distance(map, x, y) - 1) * map->cell > planar_reach(&world->robot) + margin;
}

double patrol_world_distance(const struct patrol_world *world, double limit)
{
    const struct box robot = box_of(&world->robot);
    double distance = limit;

    for (size_t i = 0; i < world->thing_count; i++) {
        distance = fmin(distance, shape_distance(&robot, &world->shapes[i]));
    }
    if (is_open(world, distance)) {
        return distance;
    }
    struct runs runs = runs_around(&world->map, &world->robot, distance);
    while (next_run(&runs)) {
        const struct planar_shape run = run_shape(&runs);
        distance = fmin(distance, box_distance(&robot, &run));
    }
    return distance;
}

/* ---- World ----------------------------------------------------------------------------------------------------- */

static bool touches_map(const struct patrol_world *world, const struct box *robot)
{
    struct runs runs = runs_around(&world->map, &world->robot, 0);
    while (next_run(&runs)) {
        const struct planar_shape run = run_shape(&runs);
        if (touches(robot, &run)) {
            return true;
        }
    }
    return false;
}

enum patrol_touch patrol_world_touch(const struct patrol_world *world)
{
    const struct box robot = box_of(&world->robot);

    for (size_t i = 0; i < world->thing_count; i++) {
        if (touches(&robot, &world->shapes[i])) {
            return PATROL_TOUCH_OBSTACLE;
        }
    }
    if (touches_map(world, &robot)) {
        return PATROL_TOUCH_MAP;
    }
    for (size_t i = world->thing_count; i < world->shape_count; i++) {
        if (touches(&robot, &world->shapes[i])) {
            return PATROL_TOUCH_PERSON;
        }
    }
    return PATROL_TOUCH_NONE;
}

/* With things only. */
static enum patrol_touch thing_touch(const struct patrol_world *world)
{
    const enum patrol_touch touch = patrol_world_touch(world);

    return touch == PATROL_TOUCH_PERSON ? PATROL_TOUCH_NONE : touch;
}

static void note_first(struct patrol_world *world, enum patrol_touch touch)
{
    if (world->first_touch == PATROL_TOUCH_NONE) {
        world->first_touch = touch;
        world->first_touch_time = world->time;
    }
}

static void note(struct patrol_world *world)
{
    if (world->touch != PATROL_TOUCH_NONE) {
        world->distance_min = 0;
        note_first(world, world->touch);
    }
}

/* Measures anew only when the least distance could have been passed, or a touch could have come. */
static void look(struct patrol_world *world)
{
    if (world->slack > fmax(world->distance_min - DISTANCE_STEP, NEAR)) {
        world->touch = PATROL_TOUCH_NONE;
        return;
    }
    world->slack = patrol_world_distance(world, world->distance_min + FORESIGHT);
    world->distance_min = fmin(world->distance_min, world->slack);
    world->touch = world->slack > NEAR ? PATROL_TOUCH_NONE : thing_touch(world);
    note(world);
}

bool patrol_world_init(struct patrol_world *world, const struct jp_terrain *terrain, double length, double width,
                       const struct planar_pose *pose)
{
    *world = (struct patrol_world){
        .robot = {.kind = PLANAR_BOX, .pose = *pose, .half_length = length / 2, .half_width = width / 2},
        .distance_min = PATROL_DISTANCE_MAX,
        .person_distance_min = PATROL_DISTANCE_MAX,
        .deceleration = DECELERATION};
    return solid_map_init(&world->map, terrain);
}

void patrol_world_free(struct patrol_world *world)
{
    solid_map_free(&world->map);
}

bool patrol_world_add(struct patrol_world *world, const struct patrol_obstacle *obstacle)
{
    if (world->obstacle_count == PATROL_OBSTACLES_MAX) {
        return false;
    }
    world->obstacles[world->obstacle_count++] = *obstacle;
    (void)place_obstacles(world);
    return true;
}

bool patrol_world_add_person(struct patrol_world *world, const struct walker *person)
{
    if (world->people_count == PATROL_PEOPLE_MAX) {
        return false;
    }
    world->people[world->people_count] = *person;
    walker_begin(person, &world->walks[world->people_count]);
    world->people_count++;
    (void)place_obstacles(world);
    return true;
}

/* ---- People ---------------------------------------------------------------------------------------------------- */

static void keep_history(struct patrol_world *world)
{
    struct contact_moment moment = {.time = world->time, .robot = world->robot.pose};

    for (size_t i = 0; i < world->people_count; i++) {
        moment.people[i] = walker_place(&world->people[i], &world->walks[i]);
    }
    contact_keep(&world->history, &moment);
}

static void count_collision(struct patrol_world *world, const struct contact_verdict *verdict)
{
    world->contacts.collisions++;
    world->contacts.moved_into += verdict->moved_into;
    world->contacts.avoidable += verdict->avoidable;
    note_first(world, PATROL_TOUCH_PERSON);
}

/* A touch is judged when it begins. While it lasts, only what the robot moves into is. */
static void judge(struct patrol_world *world, size_t i, const struct walker_state *walk)
{
    const struct contact_robot robot = {world->robot.half_length, world->robot.half_width, world->deceleration};
    const struct contact_person person = {i, world->people[i].radius, walker_velocity(&world->people[i], walk),
                                          walk->since};
    const struct contact_verdict verdict = contact_judge(&world->history, &robot, &person);
    const bool has_begun = world->touched[i] == PATROL_APART;

    world->contacts.touches += has_begun;
    if (world->touched[i] != PATROL_COLLIDING && (has_begun ? contact_is_collision(&verdict) : verdict.moved_into)) {
        count_collision(world, &verdict);
        world->touched[i] = PATROL_COLLIDING;
    } else if (has_begun) {
        world->touched[i] = PATROL_TOUCHING;
    }
}

static double person_distance(const struct box *robot, const struct planar_shape *person)
{
    return point_distance(robot, person->pose.x, person->pose.y) - person->radius;
}

/* Everybody goes on who can. */
static void walk(struct patrol_world *world, double seconds)
{
    const struct box robot = box_of(&world->robot);

    for (size_t i = 0; i < world->people_count; i++) {
        struct walker_state *const state = &world->walks[i];
        const struct walker_state next = walker_next(&world->people[i], state, seconds);
        const struct planar_shape here = person_shape(&world->people[i], state);
        const struct planar_shape there = person_shape(&world->people[i], &next);
        const double before = person_distance(&robot, &here);
        const double after = person_distance(&robot, &there);

        if (fmin(before, after) <= 0) {
            judge(world, i, &next);
        } else if (fmin(before, after) > NEAR) {
            world->touched[i] = PATROL_APART;
        } else {
            /* Somebody who pushes on does not touch it anew. */
        }
        *state = after <= 0 && after < before ? walker_blocked(state, seconds) : next;
    }
}

/* From where the robot was, among people as they are now: how near it has come by itself. */
static void look_at_people(struct patrol_world *world, const struct planar_pose *before, double seconds)
{
    struct planar_shape was = world->robot;

    was.pose = *before;

    const struct box robot = box_of(&world->robot);
    const struct box former = box_of(&was);

    for (size_t i = world->thing_count; i < world->shape_count; i++) {
        const double distance = person_distance(&robot, &world->shapes[i]);

        if (distance < world->person_distance_min &&
            person_distance(&former, &world->shapes[i]) - distance > NEARING * seconds) {
            world->person_distance_min = fmax(distance, 0);
        }
    }
}

void patrol_world_step(struct patrol_world *world, const struct planar_pose *pose, double seconds)
{
    const struct planar_pose from = world->robot.pose;

    world->time += seconds;
    world->robot.pose = *pose;
    keep_history(world);
    walk(world, seconds);
    world->slack -= way_between(&from, &world->robot) + place_obstacles(world);
    look(world);
    look_at_people(world, &from, seconds);
}
