/* The generator of rough scenes: what its header promises, over many seeds, each by a check of its own in doubles. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/scene.h"
#include "unity.h"

#define SEEDS       40
#define CELLS       (SCENE_SIDE * SCENE_SIDE)
#define CELL_M      0.2
#define WAY_M       1.4
#define CLEARING_M  2.0
#define SLOPE_MAX   15.0 /* degrees */
#define ROBOT_STEPS 2    /* cells that a unit step of the lattice leads along an axis, at most */

/* Of the scenes of the bench: its figures can only be compared while they stay as they are. */
#define BENCH_HASH UINT64_C(0xF13EEBF05E1ADF7D)

struct scene {
    struct jp_terrain terrain;
    struct scene_task task;
    _Alignas(8) uint64_t block[(SCENE_TERRAIN_SIZE + 7) / 8];
};

static struct scene scenes[SEEDS];
static struct scene other;

/* The one looked at. */
static uint32_t seed;
static struct jp_terrain terrain;
static struct scene_task task;

void setUp(void)
{
    seed = 0;
}

void tearDown(void)
{
}

static void generate(struct scene *scene, bool unknown_is_free)
{
    struct jp_terrain_config config = scene_terrain_config;
    const char *field = NULL;
    config.unknown_is_free = unknown_is_free;
    TEST_ASSERT_EQUAL_UINT64(SCENE_TERRAIN_SIZE, jp_terrain_size(&config));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&scene->terrain, &config, scene->block, SCENE_TERRAIN_SIZE, &field));
    scene_generate(seed, &scene->terrain, &scene->task);
}

static void look_at(const struct scene *scene)
{
    terrain = scene->terrain;
    task = scene->task;
}

/* Goes on to the next of the seeds 1…SEEDS, whose scenes are made once. */
static bool next_seed(void)
{
    if (seed == SEEDS) {
        return false;
    }
    struct scene *scene = &scenes[seed];
    seed++;
    if (scene->terrain.blocked == NULL) {
        generate(scene, false);
    }
    look_at(scene);
    return true;
}

static void check(bool holds, const char *what, double value)
{
    char message[120];
    (void)snprintf(message, sizeof message, "seed %u: %s: %g", seed, what, value);
    TEST_ASSERT_TRUE_MESSAGE(holds, message);
}

static enum jp_cell cell_at(int x, int y)
{
    return jp_terrain_cell(&terrain, x, y);
}

static double height_at(int x, int y)
{
    return jp_terrain_elevation(&terrain, x, y) / (double)JP_ELEVATION_ONE;
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

static uint64_t hash_pose(uint64_t hash, const struct scene_pose *pose)
{
    const uint16_t values[] = {pose->x, pose->y, pose->heading};
    return hash_bytes(hash, values, sizeof values);
}

/* Of all cells, heights and the task. */
static uint64_t hash_scene(uint64_t hash, const struct jp_terrain *map, const struct scene_task *its_task)
{
    for (int y = 0; y < SCENE_SIDE; y++) {
        for (int x = 0; x < SCENE_SIDE; x++) {
            const int16_t values[] = {(int16_t)jp_terrain_cell(map, x, y), jp_terrain_elevation(map, x, y)};
            hash = hash_bytes(hash, values, sizeof values);
        }
    }
    return hash_pose(hash_pose(hash, &its_task->start), &its_task->goal);
}

/* ---- Ground ---- */

/* Of the steps of one cell or two from a cell: the steepest one's tangent. */
static double steepest(int x, int y)
{
    const double height = height_at(x, y);
    double worst = 0.0;
    for (int dy = -ROBOT_STEPS; dy <= ROBOT_STEPS; dy++) {
        for (int dx = -ROBOT_STEPS; dx <= ROBOT_STEPS; dx++) {
            if (dx % 2 != 0 || dy % 2 != 0) {
                worst = fmax(worst, fabs(height_at(x + dx, y + dy) - height) / sqrt(dx * dx + dy * dy));
            }
        }
    }
    return worst / CELL_M;
}

static double degrees(double tangent_of)
{
    return atan(tangent_of) * 180.0 / M_PI;
}

/* From free ground no step of one cell or two leads steeply up or down, whatever is at its end. */
static void test_free_ground_is_never_steep(void)
{
    while (next_seed()) {
        double worst = 0.0;
        for (int y = ROBOT_STEPS; y < SCENE_SIDE - ROBOT_STEPS; y++) {
            for (int x = ROBOT_STEPS; x < SCENE_SIDE - ROBOT_STEPS; x++) {
                if (cell_at(x, y) == JP_CELL_FREE) {
                    worst = fmax(worst, steepest(x, y));
                }
            }
        }
        check(degrees(worst) <= SLOPE_MAX, "steepest free step, degrees", degrees(worst));
        check(degrees(worst) > SLOPE_MAX - 1.0, "steepest free step, degrees", degrees(worst));
    }
}

static double gradient_degrees(int x, int y)
{
    const double across = height_at(x + 1, y) - height_at(x - 1, y);
    const double along = height_at(x, y + 1) - height_at(x, y - 1);
    return degrees(hypot(across, along) / (2.0 * CELL_M));
}

static void test_ground_is_hilly(void)
{
    while (next_seed()) {
        int sloped = 0;
        double low = 100.0;
        double high = -100.0;
        for (int y = 1; y < SCENE_SIDE - 1; y++) {
            for (int x = 1; x < SCENE_SIDE - 1; x++) {
                const double slope = gradient_degrees(x, y);
                sloped += slope >= 5.0 && slope <= 12.0;
                low = fmin(low, height_at(x, y));
                high = fmax(high, height_at(x, y));
            }
        }
        check(sloped > 0.4 * CELLS, "share sloped by 5…12 degrees", (double)sloped / CELLS);
        check(high - low > 2.0 && high - low < 8.0, "relief, m", high - low);
    }
}

/* No edge in the hills: neighbouring steps in a line rise alike. */
static void test_ground_is_smooth(void)
{
    while (next_seed()) {
        double worst = 0.0;
        for (int y = 1; y < SCENE_SIDE - 1; y++) {
            for (int x = 1; x < SCENE_SIDE - 1; x++) {
                worst = fmax(worst, fabs(height_at(x + 1, y) - 2 * height_at(x, y) + height_at(x - 1, y)));
                worst = fmax(worst, fabs(height_at(x, y + 1) - 2 * height_at(x, y) + height_at(x, y - 1)));
            }
        }
        check(worst < 0.03, "largest bend, m", worst);
    }
}

/* ---- Obstacles ---- */

static int count_cells(enum jp_cell kind)
{
    int count = 0;
    for (int i = 0; i < CELLS; i++) {
        count += cell_at(i % SCENE_SIDE, i / SCENE_SIDE) == kind;
    }
    return count;
}

static void test_obstacles_take_up_the_stated_share(void)
{
    int scenes_with_unknown = 0;
    while (next_seed()) {
        const int unknown = count_cells(JP_CELL_UNKNOWN);
        const double share = (double)(count_cells(JP_CELL_OCCUPIED) + unknown) / CELLS;
        check(share >= 0.08 && share <= 0.15, "share occupied or unknown", share);
        check(unknown < 0.02 * CELLS, "unknown cells", unknown);
        scenes_with_unknown += unknown > 0;
    }
    TEST_ASSERT_GREATER_THAN_INT(SEEDS / 5, scenes_with_unknown);
    TEST_ASSERT_LESS_THAN_INT(SEEDS / 2, scenes_with_unknown);
}

/* ---- Task ---- */

/* Distance from a cell to the nearest that is not free, or the map's end, m; up to `limit`. */
static double clearance(int x, int y, double limit)
{
    const int reach = (int)(limit / CELL_M) + 1;
    double nearest = limit;
    for (int dy = -reach; dy <= reach; dy++) {
        for (int dx = -reach; dx <= reach; dx++) {
            const double distance = CELL_M * hypot(dx, dy);
            if (distance < nearest && cell_at(x + dx, y + dy) != JP_CELL_FREE) {
                nearest = distance;
            }
        }
    }
    return nearest;
}

static void test_start_and_goal_are_far_apart_in_the_open(void)
{
    int headings[SCENE_HEADINGS] = {0};
    while (next_seed()) {
        const struct scene_pose *poses[] = {&task.start, &task.goal};
        for (int i = 0; i < 2; i++) {
            TEST_ASSERT_LESS_THAN_INT(SCENE_HEADINGS, poses[i]->heading);
            headings[poses[i]->heading]++;
            const double open = clearance(poses[i]->x, poses[i]->y, CLEARING_M);
            check(open >= CLEARING_M, "clearance of start or goal, m", open);
        }
        const double distance = CELL_M * hypot(task.start.x - task.goal.x, task.start.y - task.goal.y);
        check(distance >= 35.0 && distance <= 65.0, "from start to goal, m", distance);
    }
    for (int i = 0; i < SCENE_HEADINGS; i++) {
        TEST_ASSERT_GREATER_THAN_INT(0, headings[i]);
    }
}

/* A breadth-first search over the cells whose centre is at least half the way's width off every obstacle. */
static bool is_reached(void)
{
    static bool seen[SCENE_SIDE][SCENE_SIDE];
    static struct scene_pose queue[CELLS];
    static const int steps[][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    size_t tail = 0;
    memset(seen, 0, sizeof seen);
    queue[tail++] = task.start;
    seen[task.start.y][task.start.x] = true;
    for (size_t head = 0; head < tail; head++) {
        for (int i = 0; i < 4; i++) {
            const int x = queue[head].x + steps[i][0];
            const int y = queue[head].y + steps[i][1];
            if (jp_terrain_contains(&terrain, x, y) && !seen[y][x] && clearance(x, y, WAY_M / 2) >= WAY_M / 2) {
                seen[y][x] = true;
                queue[tail++] = (struct scene_pose){.x = (uint16_t)x, .y = (uint16_t)y};
            }
        }
    }
    return seen[task.goal.y][task.goal.x];
}

static void test_a_wide_way_leads_to_the_goal(void)
{
    while (next_seed()) {
        if (seed % 4 == 0) {
            check(is_reached(), "no way of the stated width", WAY_M);
        }
    }
}

/* ---- Same bits ---- */

static uint64_t hash_of(const struct scene *scene)
{
    return hash_scene(0, &scene->terrain, &scene->task);
}

static void test_a_seed_gives_one_scene_whatever_was_in_memory(void)
{
    uint64_t former = 0;
    while (next_seed()) {
        if (seed % 5 == 0) {
            const uint64_t hash = hash_of(&scenes[seed - 1]);
            memset(&other, 0xC3, sizeof other);
            generate(&other, true);
            TEST_ASSERT_EQUAL_HEX64(hash, hash_of(&other));
            TEST_ASSERT_TRUE(hash != former);
            former = hash;
        }
    }
}

static void test_every_kind_of_seed_ends(void)
{
    static const uint32_t seeds[] = {0, UINT32_C(0x7fffffff), UINT32_C(0x80000000), UINT32_MAX};
    for (size_t i = 0; i < sizeof seeds / sizeof seeds[0]; i++) {
        seed = seeds[i];
        generate(&other, false);
        look_at(&other);
        check(count_cells(JP_CELL_FREE) > CELLS / 2, "free cells", count_cells(JP_CELL_FREE));
    }
}

static void test_the_bench_keeps_its_scenes(void)
{
    uint64_t hash = 0;
    while (next_seed()) {
        if (seed >= SCENE_BENCH_FIRST && seed < SCENE_BENCH_FIRST + SCENE_BENCH_COUNT) {
            hash = hash_scene(hash, &terrain, &task);
        }
    }
    TEST_ASSERT_EQUAL_HEX64(BENCH_HASH, hash);
}

int main(void)
{
    printf("seeds 1…%d\n", SEEDS);
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
