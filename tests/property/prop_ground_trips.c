/*
 * A robot that goes again and again over grounds that its map tells apart: what it learns against what they take by the
 * plant, and what it saves by going round what it knows to be dear. Maps and grounds at random.
 *
 * prop_ground_trips [--count N] [--seed S]
 * --count is the number of maps of each kind.
 */
#include <stdlib.h>

#include "sim/missions/ground_trips.h"
#include "sim/missions/plan_lattice.h"
#include "tests/support/options.h"
#include "tests/support/random.h"

enum { COLUMNS = 150, ROWS = 60, TRIPS = 6, MEMORY = 1 << 20, EDGE_CELLS = 5 };

/* Of what a class takes straight on, and of what its last trip was forecast to take. */
#define LEARNED_WITHIN  0.03
#define FORECAST_WITHIN 0.05

/* Of the joules of a robot that keeps nothing of the grounds, at most, where a way round is much cheaper. */
#define SAVED_TO 0.9

static struct lattice_robot robot;
static struct map_file map;
static struct ground_trips_task task;
static struct ground_trip trip;
static struct options options = {.count = 2, .seed = 1};

void setUp(void)
{
    map = (struct map_file){.name = "strip"};
    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        map.grounds[k] = (struct map_ground){.rolling = 1, .friction = 1};
    }
}

void tearDown(void)
{
    free(map.block);
}

static void make_map(void)
{
    const struct jp_terrain_config config = {
        .width = COLUMNS, .height = ROWS, .resolution = task.lattice->resolution, .has_classes = true};
    const size_t size = jp_terrain_size(&config);
    const char *field = "";

    map.block = aligned_alloc(8, (size + 7) / 8 * 8);
    TEST_ASSERT_NOT_NULL(map.block);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map.terrain, &config, map.block, size, &field));
    for (int32_t i = 0; i < COLUMNS * ROWS; i++) {
        (void)jp_terrain_set_cell(&map.terrain, i % COLUMNS, i / COLUMNS, JP_CELL_FREE);
    }
}

static void lay(uint8_t ground, int32_t first_x, int32_t last_x, int32_t first_y, int32_t last_y)
{
    for (int32_t y = first_y; y <= last_y; y++) {
        for (int32_t x = first_x; x <= last_x; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_class(&map.terrain, x, y, ground));
        }
    }
}

static void begin(int16_t y)
{
    task.map = &map;
    task.memory = MEMORY;
    task.places.start = (struct jp_lattice_pose){15, y, 0};
    task.places.goal = (struct jp_goal){COLUMNS - 16, y, JP_ANY_HEADING};
}

/* J of the last trip. */
static double go(bool keeps, uint64_t seed)
{
    struct ground_memory memory = {.is_there = false};

    task.keeps = keeps;
    for (uint64_t i = 0; i < TRIPS; i++) {
        task.seed = seed + i;
        TEST_ASSERT_TRUE(ground_trip_drive(&task, &memory, NULL, NULL, &trip));
        TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_ARRIVED, trip.result.state);
        TEST_ASSERT_FALSE(trip.result.is_touched);
    }
    return trip.result.joules;
}

/* Two bands from side to side: there is no way round. */
static void test_what_grounds_take_is_learned(void)
{
    begin_random(options.seed, 1);
    for (unsigned long i = 0; i < options.count; i++) {
        struct ground_take truth[JP_GROUND_CLASSES];

        tearDown();
        make_map();
        for (uint8_t k = 1; k <= 2; k++) {
            const int32_t first = 15 + 55 * (k - 1) + (int32_t)below(20);

            map.grounds[k] = (struct map_ground){.rolling = uniform(0.7, 3), .friction = uniform(0.7, 1)};
            lay(k, first, first + 25 + (int32_t)below(15), 0, ROWS - 1);
        }
        begin(ROWS / 2);
        ground_trips_truth(&robot, &map, truth);
        (void)go(true, options.seed + 100 * i);
        for (uint8_t k = 1; k <= 2; k++) {
            printf("rolling %.2f friction %.2f: %.1f J/m, learned %.1f\n", map.grounds[k].rolling,
                   map.grounds[k].friction, truth[k].straight, trip.known[k].take.straight);
            TEST_ASSERT_TRUE(trip.known[k].legs >= TRIPS - 1);
            TEST_ASSERT_DOUBLE_WITHIN(LEARNED_WITHIN * truth[k].straight, truth[k].straight,
                                      trip.known[k].take.straight);
        }
        TEST_ASSERT_DOUBLE_WITHIN(FORECAST_WITHIN * trip.result.joules, trip.result.joules,
                                  trip.result.forecast_joules);
    }
}

/* Mud up to a lane beside it; at first both sides of the robot are in it. */
static void test_a_way_round_saves_energy(void)
{
    begin_random(options.seed, 2);
    for (unsigned long i = 0; i < options.count; i++) {
        const int32_t edge = 25 + (int32_t)below(10);

        tearDown();
        make_map();
        map.grounds[1] = (struct map_ground){.rolling = uniform(2.5, 3.5), .friction = uniform(0.7, 1)};
        lay(1, 35, COLUMNS - 36, 0, edge);
        begin((int16_t)(edge - EDGE_CELLS - (int32_t)below(6)));

        const double without = go(false, options.seed + 100 * i);
        const double through = trip.metres_on[1];
        const double with = go(true, options.seed + 100 * i);

        printf("rolling %.2f: %.0f J, %.0f J by what was kept\n", map.grounds[1].rolling, without, with);
        TEST_ASSERT_TRUE(with < SAVED_TO * without);
        TEST_ASSERT_TRUE(trip.metres_on[1] < through / 2); /* it may cut a corner of the mud */
    }
}

/* Without classes the same is driven as before there were any. */
static void test_on_one_ground_nothing_is_kept_apart(void)
{
    struct ground_trip alike;

    make_map();
    begin(ROWS / 2);
    (void)go(false, options.seed);
    alike = trip;
    (void)go(true, options.seed);
    TEST_ASSERT_TRUE(alike.result.joules == trip.result.joules && alike.result.length_m == trip.result.length_m);
    TEST_ASSERT_TRUE(alike.result.forecast_joules == trip.result.forecast_joules);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    if (!lattice_robot_load("sim/robots/zhang2018.cfg", &robot)) {
        return EXIT_FAILURE;
    }
    task = (struct ground_trips_task){.robot = &robot, .lattice = plan_lattice_for_navigation("zhang2018")};
    return RUN_PROPERTY(options, NULL);
}
