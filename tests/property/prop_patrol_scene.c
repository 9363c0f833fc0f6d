/* Scenes for the patrol robot: what their header promises, over many seeds, by the distances of patrol_world.h and a
 * flood fill of its own. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/scenes/patrol_scene.h"
#include "tests/support/options.h"
#include "unity.h"

#define SIDE_MAX 512
#define CELLS    (SIDE_MAX * SIDE_MAX)

/* The robot of sim/robots/patrol.cfg, m. */
#define LENGTH 0.8
#define WIDTH  0.6
#define CIRCLE 0.5

#define SPARE      0.1
#define TURN_SPARE 0.05
#define CLEAR_MAX  0.9  /* distances are told up to this */
#define CELL_ERROR 0.04 /* what painting on cells may add to or take from a shape */
#define NONE       (-1)

static struct options options = {.count = 16, .seed = 1};
static enum patrol_scene_kind kind;
static unsigned long long seed;
static struct patrol_scene *scenes; /* by kind and seed, each made when it is first looked at */
static struct patrol_scene scene;
static bool begun;
static double cell;

void setUp(void)
{
    seed = options.seed - 1;
    begun = false;
}

void tearDown(void)
{
}

/* Goes on to the next seed of `kind`. */
static bool next_seed(void)
{
    if (seed == options.seed - 1 + options.count) {
        return false;
    }

    struct patrol_scene *const next = &scenes[kind * options.count + (seed - (options.seed - 1))];

    seed++;
    if (next->name[0] == '\0') {
        patrol_scene_make(kind, seed, next);
    }
    scene = *next;
    begun = true;
    cell = scene.ground.config.resolution / (double)JP_Q16_ONE;
    return true;
}

static bool next_kind_and_seed(void)
{
    if (!begun) {
        kind = 0;
    }
    if (next_seed()) {
        return true;
    }
    seed = options.seed - 1;
    kind++;
    return kind < PATROL_SCENES && next_seed();
}

static void check(bool holds, const char *what, double value)
{
    if (!holds) {
        char message[160];
        (void)snprintf(message, sizeof message, "%s, seed %llu: %s: %g", patrol_scene_names[kind], seed, what, value);
        TEST_FAIL_MESSAGE(message);
    }
}

static struct planar_pose planar(const struct jp_plane_pose *pose)
{
    return (struct planar_pose){(double)pose->x, (double)pose->y, (double)pose->heading};
}

static double start_to_goal(void)
{
    return hypot((double)(scene.goal.x - scene.start.x), (double)(scene.goal.y - scene.start.y));
}

/* ---- Distances ---- */

static bool stands(const struct patrol_obstacle *mover)
{
    return mover->waypoint_count == 1;
}

/* The robot among the cells of a map and what stands there. */
static struct patrol_world world;

static void enter(const struct jp_terrain *terrain, bool with_standing)
{
    const struct planar_pose start = planar(&scene.start);

    TEST_ASSERT_TRUE(patrol_world_init(&world, terrain, LENGTH, WIDTH, &start));
    for (size_t i = 0; i < scene.mover_count && with_standing; i++) {
        struct patrol_obstacle mover = scene.movers[i];
        mover.appears = 0;
        if (stands(&mover)) {
            TEST_ASSERT_TRUE(patrol_world_add(&world, &mover));
        }
    }
}

/* From the robot's true shape to all that, m; up to `limit`. */
static double room_at(const struct planar_pose *pose, double limit)
{
    world.robot.pose = *pose;
    return patrol_world_distance(&world, limit);
}

/* From the centre of each cell to the nearest solid one's edge, m; up to CLEAR_MAX. */
static double clear_from[SIDE_MAX][SIDE_MAX];

static bool is_solid(const struct jp_terrain *terrain, int x, int y)
{
    return jp_terrain_cell(terrain, x, y) != JP_CELL_FREE;
}

/* Cells from the centre of each cell of a row to the nearest solid one in it; the ends of the row are solid. */
static void measure_row(const struct jp_terrain *terrain, int y, double *gaps)
{
    const int width = terrain->config.width;

    for (int x = 0; x < width; x++) {
        const double before = x == 0 || gaps[x - 1] == 0 ? 0.5 : gaps[x - 1] + 1;
        gaps[x] = is_solid(terrain, x, y) ? 0 : before;
    }
    for (int x = width - 2; x >= 0; x--) {
        gaps[x] = fmin(gaps[x], gaps[x + 1] == 0 ? 0.5 : gaps[x + 1] + 1);
        gaps[x] = is_solid(terrain, x, y) ? 0 : gaps[x];
    }
}

static void measure(const struct jp_terrain *terrain)
{
    static double gaps[SIDE_MAX][SIDE_MAX];
    const int width = terrain->config.width;
    const int height = terrain->config.height;
    const int reach = (int)(CLEAR_MAX / cell);

    TEST_ASSERT_TRUE(width <= SIDE_MAX && height <= SIDE_MAX);
    for (int y = 0; y < height; y++) {
        measure_row(terrain, y, gaps[y]);
    }
    for (int i = 0; i < width * height; i++) {
        const int x = i % width;
        const int y = i / width;
        double square = CLEAR_MAX * CLEAR_MAX / (cell * cell);
        for (int dy = -reach; dy <= reach; dy++) {
            const double gap = y + dy >= 0 && y + dy < height ? gaps[y + dy][x] : 0;
            const double rows = dy == 0 ? 0 : abs(dy) - 0.5;
            const double sum = gap * gap + rows * rows;
            square = sum < square ? sum : square;
        }
        clear_from[y][x] = cell * sqrt(square);
    }
}

static void measure_standing(void)
{
    const int width = scene.ground.config.width;

    for (size_t i = 0; i < scene.mover_count; i++) {
        const struct patrol_obstacle *mover = &scene.movers[i];
        for (int j = 0; j < width * scene.ground.config.height && stands(mover); j++) {
            double *clear = &clear_from[j / width][j % width];
            const double dx = (j % width + 0.5) * cell - mover->waypoints[0].x;
            const double dy = (j / width + 0.5) * cell - mover->waypoints[0].y;
            *clear = fmin(*clear, sqrt(dx * dx + dy * dy) - mover->shape.radius);
        }
    }
}

static void measure_ground(void)
{
    measure(&scene.ground);
    measure_standing();
}

static double clear_at(const struct planar_pose *pose)
{
    return clear_from[(int)(pose->y / cell)][(int)(pose->x / cell)];
}

/* ---- The way ---- */

/* Steps from start to goal of a disc's centre, from cell to cell through edges; NONE: it does not get there. */
static int steps_to_goal(double radius)
{
    static int steps[CELLS];
    static int queue[CELLS];
    static const int moves[][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    const int width = scene.ground.config.width;
    const int start = (int)((double)scene.start.y / cell) * width + (int)((double)scene.start.x / cell);
    const int goal = (int)((double)scene.goal.y / cell) * width + (int)((double)scene.goal.x / cell);
    size_t tail = 0;

    memset(steps, 0, sizeof steps);
    steps[start] = 1;
    queue[tail++] = start;
    for (size_t head = 0; head < tail && steps[goal] == 0; head++) {
        for (int i = 0; i < 4; i++) {
            const int x = queue[head] % width + moves[i][0];
            const int y = queue[head] / width + moves[i][1];
            if (clear_from[y][x] >= radius && steps[y * width + x] == 0) {
                steps[y * width + x] = steps[queue[head]] + 1;
                queue[tail++] = y * width + x;
            }
        }
    }
    return steps[goal] - 1;
}

/* ---- Promises to every kind ---- */

static void test_start_and_goal_have_room(void)
{
    while (next_kind_and_seed()) {
        const struct planar_pose start = planar(&scene.start);
        const struct planar_pose goal = planar(&scene.goal);
        enter(&scene.ground, true);
        const double at_start = room_at(&start, 2 * SPARE);
        const double at_goal = room_at(&goal, 2 * SPARE);
        patrol_world_free(&world);
        check(at_start >= SPARE, "room at the start, m", at_start);
        check(at_goal >= SPARE, "room at the goal, m", at_goal);
        check(scene.limit_s > 2 * start_to_goal(), "limit, s", scene.limit_s);
    }
}

static bool can_turn(const struct planar_pose *pose)
{
    return clear_at(pose) >= CIRCLE + TURN_SPARE;
}

static bool can_dock(const struct planar_pose *goal)
{
    for (double back = 0; back < 10; back += 0.025) {
        const struct planar_pose pose = planar_compose(goal, &(struct planar_pose){-back, 0, 0});
        if (can_turn(&pose)) {
            return true;
        }
        if (room_at(&pose, SPARE) < SPARE - CELL_ERROR) {
            return false;
        }
    }
    return false;
}

static void test_the_robot_can_set_out_and_dock(void)
{
    while (next_kind_and_seed()) {
        const struct planar_pose start = planar(&scene.start);
        const struct planar_pose goal = planar(&scene.goal);
        measure_ground();
        enter(&scene.ground, true);
        check(can_turn(&start), "clear at the start, m", clear_at(&start));
        check(can_dock(&goal), "no straight way into the goal; clear, m", clear_at(&goal));
        patrol_world_free(&world);
    }
}

static void test_a_way_leads_to_the_goal(void)
{
    while (next_kind_and_seed()) {
        measure_ground();
        check(steps_to_goal(WIDTH / 2 + SPARE) != NONE, "no way for a disc of a radius of, m", WIDTH / 2 + SPARE);
    }
}

/* The planner's map shows nothing that is not there, and its frame is shut. */
static void test_the_map_shows_what_is_there(void)
{
    while (next_kind_and_seed()) {
        const int width = scene.map.config.width;
        const int height = scene.map.config.height;
        TEST_ASSERT_EQUAL_INT(scene.ground.config.width, width);
        TEST_ASSERT_EQUAL_INT(scene.ground.config.height, height);
        for (int i = 0; i < width * height; i++) {
            const bool border = i % width == 0 || i % width == width - 1 || i / width == 0 || i / width == height - 1;
            check(!is_solid(&scene.map, i % width, i / width) || is_solid(&scene.ground, i % width, i / width),
                  "shown but not there, cell", i);
            check(!border || is_solid(&scene.map, i % width, i / width), "open at the edge, cell", i);
        }
    }
}

/* ---- Promises to one kind ---- */

static int hidden_cells(void)
{
    const int width = scene.map.config.width;
    int count = 0;

    for (int i = 0; i < width * scene.map.config.height; i++) {
        count +=
            jp_terrain_cell(&scene.map, i % width, i / width) != jp_terrain_cell(&scene.ground, i % width, i / width);
    }
    return count;
}

static void test_an_obstacle_is_beside_the_goal_and_not_on_the_map(void)
{
    unsigned long late = 0;
    unsigned long ahead = 0;

    kind = PATROL_BESIDE_OBSTACLE;
    while (next_seed()) {
        const struct planar_pose goal = planar(&scene.goal);
        const struct planar_pose nearer = planar_compose(&goal, &(struct planar_pose){0.05, 0, 0});
        enter(&scene.map, false);
        const double shown = room_at(&goal, 0.5);
        patrol_world_free(&world);
        enter(&scene.ground, true);
        const double room = room_at(&goal, 0.5);
        ahead += room_at(&nearer, 0.5) < room - 0.04;
        patrol_world_free(&world);
        check(room <= 0.4 + CELL_ERROR, "from the obstacle to the robot at the goal, m", room);
        check(room < shown, "the map shows something as near, m", shown);
        check(scene.mover_count == 0 || scene.movers[0].shape.kind == PLANAR_DISC, "kind", scene.movers[0].shape.kind);
        check((hidden_cells() > 0) != (scene.mover_count > 0), "hidden obstacles", hidden_cells());
        check(start_to_goal() >= 3 && start_to_goal() <= 6, "from start to goal, m", start_to_goal());
        check(scene.mover_count == 0 || scene.movers[0].appears <= 1, "appears, s", scene.movers[0].appears);
        late += scene.mover_count;
    }
    TEST_ASSERT_GREATER_THAN(options.count / 5, late);
    TEST_ASSERT_LESS_THAN(options.count * 4 / 5, late);
    TEST_ASSERT_GREATER_THAN(options.count / 5, ahead);
    TEST_ASSERT_LESS_THAN(options.count * 4 / 5, ahead);
}

/* The narrow part is the only way, and so wide to the accuracy of cells. */
static void check_narrowest(enum patrol_scene_kind of, double low, double high)
{
    kind = of;
    while (next_seed()) {
        measure_ground();
        check(steps_to_goal(low / 2 - cell) != NONE, "no way as wide as, m", low);
        check(steps_to_goal(high / 2 + cell) == NONE, "a way wider than, m", high);
        check(hidden_cells() == 0 && scene.mover_count == 0, "hidden cells", hidden_cells());
    }
}

static void test_passages_corridors_and_doors_are_narrow(void)
{
    check_narrowest(PATROL_L_PASSAGE, 1.15, 1.5);
    check_narrowest(PATROL_CORRIDOR, 1.0, 1.3);
    check_narrowest(PATROL_DOORWAY, 0.9, 1.1);
}

/* True when the walls hide the goal from the start. */
static bool is_round_a_corner(void)
{
    const int steps = (int)(start_to_goal() / cell * 4);

    for (int i = 0; i <= steps; i++) {
        const double share = (double)i / steps;
        const double x = (double)scene.start.x + share * (double)(scene.goal.x - scene.start.x);
        const double y = (double)scene.start.y + share * (double)(scene.goal.y - scene.start.y);
        if (is_solid(&scene.ground, (int)(x / cell), (int)(y / cell))) {
            return true;
        }
    }
    return false;
}

static void test_the_passage_turns_a_corner(void)
{
    kind = PATROL_L_PASSAGE;
    while (next_seed()) {
        check(is_round_a_corner(), "goal in sight, m", start_to_goal());
        measure_ground();
        const double way = cell * steps_to_goal(CIRCLE);
        check(way >= 3.5 && way <= 16, "way along the axes, m", way);
    }
}

/* Turns about the start to get from the start's to the goal's side of the crossing, as a sign. */
static double side_of(const struct planar_point *from, const struct planar_point *to, const struct jp_plane_pose *pose)
{
    return (to->x - from->x) * ((double)pose->y - from->y) - (to->y - from->y) * ((double)pose->x - from->x);
}

static double distance_from_walk(const struct walker *walker, const struct jp_plane_pose *pose)
{
    double nearest = INFINITY;

    for (int i = 0; i <= 1000; i++) {
        const struct planar_point *a = &walker->from;
        const struct planar_point *b = &walker->to;
        nearest = fmin(nearest, hypot(a->x + (b->x - a->x) * i / 1000 - (double)pose->x,
                                      a->y + (b->y - a->y) * i / 1000 - (double)pose->y));
    }
    return nearest;
}

static void check_walk(const struct walker *walker)
{
    check(walker->radius == 0.25, "radius, m", walker->radius);
    check(distance_from_walk(walker, &scene.start) >= 1.49, "from the start, m",
          distance_from_walk(walker, &scene.start));
    check(distance_from_walk(walker, &scene.goal) >= 1.49, "from the goal, m", distance_from_walk(walker, &scene.goal));
}

static void test_a_pedestrian_crosses_the_way(void)
{
    unsigned long returning = 0;

    kind = PATROL_PEDESTRIAN;
    while (next_seed()) {
        const struct walker *walker = &scene.people[0];
        check(scene.people_count == 1 && scene.mover_count == 0, "people", (double)scene.people_count);
        check_walk(walker);
        check(walker->speed >= 0.8 && walker->speed <= 1.3, "speed, m/s", walker->speed);
        check(walker->starts >= 0 && walker->starts < 20, "starts, s", walker->starts);
        check(side_of(&walker->from, &walker->to, &scene.start) * side_of(&walker->from, &walker->to, &scene.goal) < 0,
              "does not cross; from start to goal, m", start_to_goal());
        returning += !walker->stays;
    }
    TEST_ASSERT_GREATER_THAN(options.count / 10, returning);
    TEST_ASSERT_LESS_THAN(options.count * 2 / 3, returning);
}

/* Those of a group do the same side by side. */
static void check_companion(const struct walker *walker, const struct walker *first)
{
    check(walker->speed == first->speed && walker->starts == first->starts && walker->act_count == first->act_count &&
              memcmp(walker->acts, first->acts, sizeof walker->acts) == 0,
          "does something else than the first of the group, at m/s", walker->speed);
    check(hypot(walker->from.x - first->from.x, walker->from.y - first->from.y) < 1.3, "from the first, m",
          hypot(walker->from.x - first->from.x, walker->from.y - first->from.y));
}

static void test_people_walk_stop_and_turn_alone_and_in_groups(void)
{
    unsigned long people = 0;
    unsigned long companions = 0;
    unsigned long stops = 0;
    unsigned long turns = 0;

    kind = PATROL_PEOPLE;
    while (next_seed()) {
        check(scene.people_count >= 1 && scene.people_count <= PATROL_PEOPLE_MAX, "people", (double)scene.people_count);
        for (size_t i = 0; i < scene.people_count; i++) {
            const struct walker *walker = &scene.people[i];
            const bool is_companion = i > 0 && walker->speed == scene.people[i - 1].speed;

            check_walk(walker);
            check(walker->speed >= 0.6 && walker->speed <= 1.5, "speed, m/s", walker->speed);
            check(hypot(walker->to.x - walker->from.x, walker->to.y - walker->from.y) >= 2.999, "walk, m",
                  hypot(walker->to.x - walker->from.x, walker->to.y - walker->from.y));
            for (size_t k = 0; k < walker->act_count; k++) {
                check(walker->acts[k].time > (k > 0 ? walker->acts[k - 1].time : walker->starts), "acts at s",
                      walker->acts[k].time);
                stops += !walker->acts[k].turns;
                turns += walker->acts[k].turns;
            }
            if (is_companion) {
                check_companion(walker, &scene.people[i - 1]);
            }
            people++;
            companions += is_companion;
        }
    }
    TEST_ASSERT_GREATER_THAN(options.count * 2, people);
    TEST_ASSERT_GREATER_THAN(people / 10, companions);
    TEST_ASSERT_GREATER_THAN(people, stops);
    TEST_ASSERT_GREATER_THAN(people, turns);
}

/* Pallets bar the shortest way of the map in some scenes and leave a passage in others. */
static void test_pallets_bar_some_aisles(void)
{
    unsigned long detours = 0;

    kind = PATROL_WAREHOUSE;
    while (next_seed()) {
        measure(&scene.map);
        const int shown = steps_to_goal(WIDTH / 2 + SPARE);
        measure_ground();
        const int true_steps = steps_to_goal(WIDTH / 2 + SPARE);
        check(hidden_cells() > 0, "hidden cells", hidden_cells());
        check(scene.map.config.width * scene.map.config.height == 400 * 300, "cells",
              scene.map.config.width * scene.map.config.height);
        detours += (true_steps - shown) * cell > 1;
    }
    TEST_ASSERT_GREATER_THAN(options.count / 5, detours);
    TEST_ASSERT_LESS_THAN(options.count * 4 / 5, detours);
}

/* ---- Seeds ---- */

/* Every kind comes in all directions. */
static void test_seeds_vary_the_task(void)
{
    for (kind = 0; kind < PATROL_SCENES; kind++) {
        unsigned long quadrants[4] = {0};
        unsigned long headings[4] = {0};
        setUp();
        while (next_seed()) {
            quadrants[2 * (scene.goal.x > scene.start.x) + (scene.goal.y > scene.start.y)]++;
            headings[(int)floor((double)scene.start.heading / (M_PI / 2) + 2) & 3]++;
        }
        for (int i = 0; i < 4; i++) {
            check(quadrants[i] > options.count / 20, "goals in a quadrant", (double)quadrants[i]);
            check(headings[i] > options.count / 20, "headings in a quadrant", (double)headings[i]);
        }
    }
}

/* FNV-1a. */
static uint64_t hash_bytes(uint64_t hash, const void *data, size_t size)
{
    const unsigned char *bytes = data;

    for (size_t i = 0; i < size; i++) {
        hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
    }
    return hash;
}

static uint64_t hash_of(const struct patrol_scene *of)
{
    const int width = of->map.config.width;
    uint64_t hash = 0;

    for (int i = 0; i < width * of->map.config.height; i++) {
        const unsigned char cells[] = {(unsigned char)jp_terrain_cell(&of->map, i % width, i / width),
                                       (unsigned char)jp_terrain_cell(&of->ground, i % width, i / width)};
        hash = hash_bytes(hash, cells, sizeof cells);
    }
    hash = hash_bytes(hash, &of->start, sizeof of->start);
    hash = hash_bytes(hash, &of->goal, sizeof of->goal);
    for (size_t i = 0; i < of->mover_count; i++) {
        hash = hash_bytes(hash, of->movers[i].waypoints, sizeof of->movers[i].waypoints);
        hash = hash_bytes(hash, &of->movers[i].starts, sizeof of->movers[i].starts);
    }
    for (size_t i = 0; i < of->people_count; i++) {
        hash = hash_bytes(hash, &of->people[i].from, sizeof of->people[i].from);
        hash = hash_bytes(hash, &of->people[i].to, sizeof of->people[i].to);
        hash = hash_bytes(hash, of->people[i].acts, of->people[i].act_count * sizeof of->people[i].acts[0]);
    }
    return hash;
}

static void test_a_seed_gives_one_scene_whatever_was_in_memory(void)
{
    static struct patrol_scene again;
    uint64_t former = 0;

    while (next_kind_and_seed()) {
        const uint64_t hash = hash_of(&scene);

        memset(&again, 0xC3, sizeof again);
        patrol_scene_make(kind, seed, &again);
        check(hash_of(&again) == hash, "another scene, of cells", again.map.config.width);
        patrol_scene_free(&again);
        check(hash != former, "the same scene as the seed before, of cells", scene.map.config.width);
        former = hash;
    }
}

static void test_every_kind_of_seed_ends(void)
{
    static const uint64_t seeds[] = {0, UINT64_C(0x7fffffffffffffff), UINT64_C(0x8000000000000000), UINT64_MAX};

    for (kind = 0; kind < PATROL_SCENES; kind++) {
        for (size_t i = 0; i < sizeof seeds / sizeof seeds[0]; i++) {
            struct patrol_scene last;

            patrol_scene_make(kind, seeds[i], &last);
            TEST_ASSERT_TRUE(last.kind == kind && last.seed == seeds[i]);
            patrol_scene_free(&last);
        }
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    scenes = calloc(PATROL_SCENES * options.count, sizeof *scenes);
    if (scenes == NULL) {
        return 2;
    }

    const int status = RUN_PROPERTY(options, NULL);

    for (size_t i = 0; i < PATROL_SCENES * options.count; i++) {
        patrol_scene_free(&scenes[i]);
    }
    free(scenes);
    return status;
}
