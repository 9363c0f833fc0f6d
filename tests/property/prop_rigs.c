/* Robots in one process do not disturb each other: interleaved and in threads they do bit for bit what each does
 * alone. */
#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "sim/balancer/rig.h"
#include "sim/missions/segment_route.h"
#include "unity.h"

#define RIGS  3
#define TICKS 20000

static const struct jp_point routes[RIGS][2] = {
    {{JP_Q16(4), JP_Q16(3)}, {JP_Q16(7), JP_Q16(-1)}},
    {{JP_Q16(3), JP_Q16(-3)}, {JP_Q16(1), JP_Q16(-6)}},
    {{JP_Q16(6), JP_Q16(0.5)}, {JP_Q16(9), JP_Q16(4)}},
};

/* A rig, what its robot drives and what it did. */
struct course {
    const char *name;
    uint64_t seed;
    struct rig rig;
    struct segment_route segments;
    uint64_t hash;
};

static struct course alone[RIGS];
static struct course together[RIGS];

void setUp(void)
{
}

void tearDown(void)
{
}

/* FNV-1a. */
static void add_bytes(uint64_t *hash, const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        *hash = (*hash ^ ((const unsigned char *)bytes)[i]) * 1099511628211u;
    }
}

static void add_tick(struct course *course)
{
    const struct plant *plant = &course->rig.world.plant;
    struct jp_telemetry telemetry;

    jp_robot_telemetry(&course->rig.robot, &telemetry);
    add_bytes(&course->hash, &plant->state, sizeof plant->state);
    add_bytes(&course->hash, &plant->x, sizeof plant->x);
    add_bytes(&course->hash, &plant->y, sizeof plant->y);
    add_bytes(&course->hash, &telemetry.voltages.left, sizeof telemetry.voltages.left);
    add_bytes(&course->hash, &telemetry.voltages.right, sizeof telemetry.voltages.right);
    add_bytes(&course->hash, &telemetry.energy_model, sizeof telemetry.energy_model);
    add_bytes(&course->hash, &telemetry.position, sizeof telemetry.position);
}

static bool start(struct course *course, size_t index)
{
    const struct robot_entry *entry;
    struct robot_file file;
    char path[64];

    course->name = index == 1 ? "gao2018" : "courier24";
    course->seed = index + 1;
    course->hash = 14695981039346656037u;
    entry = rig_find_robot(course->name);
    (void)snprintf(path, sizeof path, "sim/robots/%s.cfg", course->name);
    if (entry == NULL || !robot_file_load(path, &file) || !rig_init(&course->rig, entry, &file, course->seed)) {
        return false;
    }
    rig_release(&course->rig, 0.05);
    course->segments = (struct segment_route){
        .robot = &course->rig.robot, .model = entry->energy, .targets = routes[index], .count = 2};
    return true;
}

static void advance(struct course *course)
{
    (void)segment_route_work(&course->segments);
    rig_tick(&course->rig);
    add_tick(course);
}

static void drive_each_alone(void)
{
    for (size_t i = 0; i < RIGS; i++) {
        TEST_ASSERT_TRUE(start(&alone[i], i));
        for (int tick = 0; tick < TICKS; tick++) {
            advance(&alone[i]);
        }
        TEST_ASSERT_TRUE(jp_robot_last_tick(&alone[i].rig.robot)->segment > 0);
        TEST_ASSERT_TRUE(alone[i].rig.world.plant.x > 1);
    }
}

static void check_equal(void)
{
    for (size_t i = 0; i < RIGS; i++) {
        TEST_ASSERT_EQUAL_HEX64(alone[i].hash, together[i].hash);
        TEST_ASSERT_EQUAL_MEMORY(&alone[i].rig.world.plant.state, &together[i].rig.world.plant.state,
                                 sizeof(struct plant_state));
    }
}

/* The comparison can fail: other noise gives another trajectory. */
static void test_trajectories_depend_on_the_seed(void)
{
    drive_each_alone();
    TEST_ASSERT_TRUE(alone[0].hash != alone[2].hash);
    TEST_ASSERT_TRUE(start(&together[0], 0));
    random_init(&together[0].rig.world.random, 99);
    for (int tick = 0; tick < TICKS; tick++) {
        advance(&together[0]);
    }
    TEST_ASSERT_TRUE(alone[0].hash != together[0].hash);
}

static void test_interleaved_rigs_drive_as_alone(void)
{
    drive_each_alone();
    for (size_t i = 0; i < RIGS; i++) {
        TEST_ASSERT_TRUE(start(&together[i], i));
    }
    for (int tick = 0; tick < TICKS; tick++) {
        for (size_t i = 0; i < RIGS; i++) {
            advance(&together[i]);
        }
    }
    check_equal();
}

static void *drive_in_thread(void *argument)
{
    for (int tick = 0; tick < TICKS; tick++) {
        advance(argument);
    }
    return NULL;
}

static void test_rigs_in_threads_drive_as_alone(void)
{
    pthread_t threads[RIGS];

    drive_each_alone();
    for (size_t i = 0; i < RIGS; i++) {
        TEST_ASSERT_TRUE(start(&together[i], i));
        TEST_ASSERT_EQUAL_INT(0, pthread_create(&threads[i], NULL, drive_in_thread, &together[i]));
    }
    for (size_t i = 0; i < RIGS; i++) {
        TEST_ASSERT_EQUAL_INT(0, pthread_join(threads[i], NULL));
    }
    check_equal();
}
