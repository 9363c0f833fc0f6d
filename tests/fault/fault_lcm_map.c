/* Wrong packets of maps, cells and goals on a map: each is refused for what is wrong with it, and changes nothing. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "hal/storage/crc32.h"
#include "sim/base/random.h"
#include "sim/lcm/lcm_operator.h"
#include "tests/support/lcm_maps.h"

#define SEED       20261125u
#define JUNK       20000
#define PACKET_MAX 1024

enum { WIDTH = 7, HEIGHT = 4, CELLS = 3 };

/* Of the packets, in bytes. */
enum { TIME_PLACE = 8, ID_PLACE = 16, WIDTH_PLACE = 18, HEIGHT_PLACE = 20, COUNT_PLACE = 18 };

struct packet {
    uint8_t bytes[PACKET_MAX];
    size_t size;
};

static struct lcm_operator team;
static struct random noise;
static struct packet sound_map;
static struct packet sound_cells;
static struct packet sound_goal;

static struct packet short_packet_of(const jp_map_t *map)
{
    struct packet packet = {.size = (size_t)jp_map_t_encoded_size(map)};

    TEST_ASSERT_EQUAL_INT(packet.size, jp_map_t_encode(packet.bytes, 0, PACKET_MAX, map));
    return packet;
}

static struct packet cells_of(int16_t id, int16_t x, int16_t y, int8_t cell)
{
    jp_cell_t cells[CELLS] = {{1, 2, JP_CELL_OCCUPIED}, {0, 0, JP_CELL_UNKNOWN}, {x, y, cell}};
    const jp_cells_t message = {.utime = 5, .map_id = id, .count = CELLS, .cells = cells};
    struct packet packet;

    packet.size = (size_t)jp_cells_t_encode(packet.bytes, 0, PACKET_MAX, &message);
    return packet;
}

static struct packet goal_of(int16_t id, double x, double y, double heading)
{
    const jp_map_goal_t message = {.utime = 6, .map_id = id, .point = {x, y}, .has_heading = 1, .heading = heading};
    struct packet packet;

    packet.size = (size_t)jp_map_goal_t_encode(packet.bytes, 0, PACKET_MAX, &message);
    return packet;
}

static void make_packets(void)
{
    jp_map_t map = free_map(WIDTH, HEIGHT);

    map.cells[0][6] = JP_CELL_OCCUPIED;
    map.cells[3][0] = JP_CELL_UNKNOWN;
    sound_map = short_packet_of(&map);
    free_cells(&map);
    sound_cells = cells_of(1, 6, 3, JP_CELL_OCCUPIED);
    sound_goal = goal_of(1, 0.35, 0.15, 0);
}

static enum lcm_task_result take(lcm_operator_take *take_packet, const struct packet *packet)
{
    return take_packet(&team, packet->bytes, packet->size);
}

void setUp(void)
{
    memset(&team, 0, sizeof team);
    random_init(&noise, SEED);
    make_packets();
}

void tearDown(void)
{
    lcm_operator_free(&team);
}

static void take_map(void)
{
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_map, &sound_map));
}

static enum jp_cell cell_at(int x, int y)
{
    return jp_terrain_cell(&team.map.terrain, x, y);
}

static void check_map_is_as_it_was(void)
{
    TEST_ASSERT_EQUAL_UINT8(1, team.map.id);
    TEST_ASSERT_EQUAL_UINT16(WIDTH, team.map.terrain.config.width);
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            const enum jp_cell wanted = x == 6 && y == 0   ? JP_CELL_OCCUPIED
                                        : x == 0 && y == 3 ? JP_CELL_UNKNOWN
                                                           : JP_CELL_FREE;

            TEST_ASSERT_EQUAL_INT(wanted, cell_at(x, y));
        }
    }
}

/** A map, and a goal on it that waits for the robot. */
static void begin(void)
{
    take_map();
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_map_goal, &sound_goal));
}

/** It is refused for this, and nothing has changed. */
static void check_refused(lcm_operator_take *take_packet, const struct packet *packet, enum lcm_task_result why)
{
    const struct jp_navigation_operator before = team.navigator;

    TEST_ASSERT_EQUAL_INT_MESSAGE(why, take(take_packet, packet), lcm_task_text(why));
    TEST_ASSERT_EQUAL_MEMORY(&before, &team.navigator, sizeof before);
    TEST_ASSERT_TRUE(team.navigates && team.is_given);
    TEST_ASSERT_EQUAL_UINT(0, team.map.untold_count);
    check_map_is_as_it_was();
}

static void test_a_sound_map_is_what_was_sent(void)
{
    jp_map_t map = free_map(2, 3);

    map.map_id = 15;
    map.cells[2][1] = JP_CELL_OCCUPIED;
    map.resolution = 0.05;
    map.unknown_is_free = 1;
    map.origin = (jp_point_t){-3.5, 511.75};
    map.origin_heading = -M_PI / 2;

    const struct packet packet = short_packet_of(&map);

    free_cells(&map);
    take_map();
    check_map_is_as_it_was();
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_map, &packet));
    TEST_ASSERT_EQUAL_UINT8(15, team.map.id);
    TEST_ASSERT_EQUAL_UINT16(2, team.map.terrain.config.width);
    TEST_ASSERT_EQUAL_UINT16(3, team.map.terrain.config.height);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.05), team.map.terrain.config.resolution);
    TEST_ASSERT_TRUE(team.map.terrain.config.unknown_is_free);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(-3.5), team.map.origin.point.x);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(511.75), team.map.origin.point.y);
    TEST_ASSERT_EQUAL_HEX32(0xC0000000u, team.map.origin.heading);
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, cell_at(1, 2));
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell_at(0, 2));
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_IDLE, lcm_operator_phase(&team));
    TEST_ASSERT_FALSE(lcm_operator_is_commanding(&team));
}

static void test_a_sound_goal_becomes_the_navigators_task(void)
{
    const struct packet there = goal_of(1, 0.6999, 0.3999, M_PI);

    begin();
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, lcm_operator_phase(&team));
    TEST_ASSERT_TRUE(lcm_operator_is_commanding(&team));
    TEST_ASSERT_EQUAL_UINT16(3, team.navigator.goal.x);
    TEST_ASSERT_EQUAL_UINT16(1, team.navigator.goal.y);
    TEST_ASSERT_EQUAL_UINT8(1, team.navigator.goal.map);
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_map_goal, &there));
    TEST_ASSERT_EQUAL_UINT16(6, team.navigator.goal.x);
    TEST_ASSERT_EQUAL_UINT16(3, team.navigator.goal.y);
    TEST_ASSERT_TRUE(team.navigator.goal.has_heading);
    TEST_ASSERT_EQUAL_HEX32(0x80000000u, team.navigator.goal.heading);
}

static void test_sound_cells_change_the_map(void)
{
    begin();
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_cells, &sound_cells));
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, cell_at(1, 2));
    TEST_ASSERT_EQUAL_INT(JP_CELL_UNKNOWN, cell_at(0, 0));
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, cell_at(6, 3));
    TEST_ASSERT_EQUAL_UINT(3, team.map.untold_count);
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_cells, &sound_cells));
    TEST_ASSERT_EQUAL_UINT_MESSAGE(3, team.map.untold_count, "what is known is not told again");
}

static bool refuse(void *context, uint16_t x, uint16_t y, enum jp_cell cell)
{
    unsigned *left = context;

    (void)x;
    (void)y;
    (void)cell;
    return (*left)-- > 0;
}

static void test_cells_are_told_as_far_as_the_robot_takes_them(void)
{
    unsigned left = 2;

    begin();
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_cells, &sound_cells));
    lcm_map_tell_cells(&team.map, refuse, &left);
    TEST_ASSERT_EQUAL_UINT(1, team.map.untold_count);
    left = 9;
    lcm_map_tell_cells(&team.map, refuse, &left);
    TEST_ASSERT_EQUAL_UINT(8, left);
    lcm_map_tell_cells(&team.map, refuse, &left);
    TEST_ASSERT_EQUAL_UINT(8, left);
    /* Behind the place where it stopped. */
    left = 9;
    const struct packet first = cells_of(1, 0, 0, JP_CELL_FREE);

    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_cells, &first));
    lcm_map_tell_cells(&team.map, refuse, &left);
    TEST_ASSERT_EQUAL_UINT(0, team.map.untold_count);
}

static void check_truncations(lcm_operator_take *take_packet, const struct packet *sound)
{
    struct packet packet = *sound;

    for (packet.size = 0; packet.size < sound->size; packet.size++) {
        check_refused(take_packet, &packet, packet.size < 8 ? LCM_TASK_TYPE : LCM_TASK_LENGTH);
    }
    for (packet.size = sound->size + 1; packet.size <= sound->size + 40; packet.size++) {
        check_refused(take_packet, &packet, LCM_TASK_LENGTH);
    }
    for (unsigned below = 1; below < 20; below++) {
        packet.size = UINT32_MAX - below;
        check_refused(take_packet, &packet, LCM_TASK_LENGTH);
    }
}

static void test_a_cell_that_changes_twice_is_told_once(void)
{
    const struct packet other = cells_of(1, 6, 3, JP_CELL_UNKNOWN);
    unsigned left = 9;

    begin();
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_cells, &sound_cells));
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_cells, &other));
    TEST_ASSERT_EQUAL_UINT(3, team.map.untold_count);
    lcm_map_tell_cells(&team.map, refuse, &left);
    TEST_ASSERT_EQUAL_UINT(6, left);
    TEST_ASSERT_EQUAL_UINT(0, team.map.untold_count);
    TEST_ASSERT_EQUAL_INT(JP_CELL_UNKNOWN, cell_at(6, 3));
}

static void test_every_truncation_and_extension_is_refused(void)
{
    begin();
    check_truncations(lcm_operator_map, &sound_map);
    check_truncations(lcm_operator_cells, &sound_cells);
    check_truncations(lcm_operator_map_goal, &sound_goal);
}

static void test_packets_of_other_types(void)
{
    begin();
    check_refused(lcm_operator_map, &sound_cells, LCM_TASK_TYPE);
    check_refused(lcm_operator_map, &sound_goal, LCM_TASK_TYPE);
    check_refused(lcm_operator_cells, &sound_map, LCM_TASK_TYPE);
    check_refused(lcm_operator_map_goal, &sound_cells, LCM_TASK_TYPE);
    check_refused(lcm_operator_goal, &sound_goal, LCM_TASK_TYPE);
    check_refused(lcm_operator_route, &sound_map, LCM_TASK_TYPE);
}

static struct packet with_number(struct packet packet, size_t place, unsigned bytes, uint32_t number)
{
    for (unsigned i = 0; i < bytes; i++) {
        packet.bytes[place + i] = (uint8_t)(number >> (8 * (bytes - 1 - i)));
    }
    return packet;
}

static void test_sides_that_are_not_those_of_a_map(void)
{
    static const uint32_t wrong[] = {0, 4097, 0x7FFF, 0x8000, 0xFFFF};
    static const uint32_t other[] = {1, WIDTH + 1, 2048, 4096};

    begin();
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        const struct packet wide = with_number(sound_map, WIDTH_PLACE, 2, wrong[i]);
        const struct packet high = with_number(sound_map, HEIGHT_PLACE, 2, wrong[i]);

        check_refused(lcm_operator_map, &wide, LCM_TASK_SIDE);
        check_refused(lcm_operator_map, &high, LCM_TASK_SIDE);
    }
    for (size_t i = 0; i < sizeof other / sizeof other[0]; i++) {
        const struct packet wide = with_number(sound_map, WIDTH_PLACE, 2, other[i]);
        const struct packet high = with_number(sound_map, HEIGHT_PLACE, 2, other[i]);

        check_refused(lcm_operator_map, &wide, LCM_TASK_LENGTH);
        check_refused(lcm_operator_map, &high, LCM_TASK_LENGTH);
    }
}

static void test_counts_that_are_not_those_of_the_cells(void)
{
    static const uint32_t wrong[] = {0,          4097,       0x7FFFFFFF, 0x80000000, 0xFFFFFFFF,
                                     0x33333336, 0x66666669, 0x9999999C, 0xCCCCCCCF};

    begin();
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        const struct packet packet = with_number(sound_cells, COUNT_PLACE, 4, wrong[i]);

        check_refused(lcm_operator_cells, &packet, LCM_TASK_CELLS);
    }
    for (uint32_t count = 1; count <= 4096; count++) {
        const struct packet packet = with_number(sound_cells, COUNT_PLACE, 4, count);

        if (count != CELLS) {
            check_refused(lcm_operator_cells, &packet, LCM_TASK_LENGTH);
        }
    }
}

static void test_cells_that_are_none(void)
{
    begin();
    for (uint32_t cell = 3; cell < 256; cell++) {
        const struct packet map = with_number(sound_map, sound_map.size - 1 - cell % (WIDTH * HEIGHT), 1, cell);
        const struct packet cells = with_number(sound_cells, sound_cells.size - 1, 1, cell);

        check_refused(lcm_operator_map, &map, LCM_TASK_CELL);
        check_refused(lcm_operator_cells, &cells, LCM_TASK_CELL);
    }
}

static void test_places_that_are_not_on_the_map(void)
{
    static const int16_t outside[][2] = {{WIDTH, 0}, {0, HEIGHT}, {-1, 0}, {0, -1}, {INT16_MAX, 0}, {0, INT16_MIN}};
    static const double far[][2] = {{-0.0001, 0.1}, {0.1, -0.0001}, {0.701, 0.1},
                                    {0.1, 0.401},   {1e300, 0.1},   {0.1, -1e300}};

    begin();
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++) {
        const struct packet packet = cells_of(1, outside[i][0], outside[i][1], JP_CELL_FREE);

        check_refused(lcm_operator_cells, &packet, LCM_TASK_OUTSIDE);
    }
    for (size_t i = 0; i < sizeof far / sizeof far[0]; i++) {
        const struct packet packet = goal_of(1, far[i][0], far[i][1], 0);

        check_refused(lcm_operator_map_goal, &packet, LCM_TASK_OUTSIDE);
    }
}

static void test_ids_of_other_maps(void)
{
    static const int16_t wrong[] = {0, -1, 16, 257, INT16_MAX, INT16_MIN};
    const struct packet cells = cells_of(2, 1, 1, JP_CELL_OCCUPIED);
    const struct packet goal = goal_of(2, 0.1, 0.1, 0);

    begin();
    check_refused(lcm_operator_cells, &cells, LCM_TASK_OTHER_MAP);
    check_refused(lcm_operator_map_goal, &goal, LCM_TASK_OTHER_MAP);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        const struct packet map = with_number(sound_map, ID_PLACE, 2, (uint16_t)wrong[i]);
        const struct packet far_cells = with_number(sound_cells, ID_PLACE, 2, (uint16_t)wrong[i]);
        const struct packet far_goal = with_number(sound_goal, ID_PLACE, 2, (uint16_t)wrong[i]);

        check_refused(lcm_operator_map, &map, LCM_TASK_MAP_ID);
        check_refused(lcm_operator_cells, &far_cells, LCM_TASK_OTHER_MAP);
        check_refused(lcm_operator_map_goal, &far_goal, LCM_TASK_OTHER_MAP);
    }
}

static void test_without_a_map(void)
{
    TEST_ASSERT_EQUAL_INT(LCM_TASK_NO_MAP, take(lcm_operator_cells, &sound_cells));
    TEST_ASSERT_EQUAL_INT(LCM_TASK_NO_MAP, take(lcm_operator_map_goal, &sound_goal));
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_IDLE, lcm_operator_phase(&team));
    TEST_ASSERT_FALSE(lcm_operator_is_commanding(&team));
}

static void check_map_refused(const jp_map_t *map, enum lcm_task_result why)
{
    const struct packet packet = short_packet_of(map);

    check_refused(lcm_operator_map, &packet, why);
}

static void test_numbers_at_and_beyond_their_limits(void)
{
    static const double odd[] = {NAN, -NAN, INFINITY, -INFINITY};
    static const double far[] = {512, -512.0001, 1e6, -1e300};
    static const double sizes[] = {0, -0.1, 7e-6, 32768, 1e300, -1e300};

    begin();
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++) {
        const struct packet goals[] = {goal_of(1, odd[i], 0.1, 0), goal_of(1, 0.1, odd[i], 0),
                                       goal_of(1, 0.1, 0.1, odd[i])};
        jp_map_t maps[4];

        for (size_t k = 0; k < 4; k++) {
            maps[k] = free_map(WIDTH, HEIGHT);
        }
        maps[0].resolution = odd[i];
        maps[1].origin.x = odd[i];
        maps[2].origin.y = odd[i];
        maps[3].origin_heading = odd[i];
        for (size_t k = 0; k < 4; k++) {
            check_map_refused(&maps[k], LCM_TASK_NUMBER);
            free_cells(&maps[k]);
        }
        for (size_t k = 0; k < 3; k++) {
            check_refused(lcm_operator_map_goal, &goals[k], LCM_TASK_NUMBER);
        }
    }

    jp_map_t map = free_map(WIDTH, HEIGHT);

    for (size_t i = 0; i < sizeof far / sizeof far[0]; i++) {
        map.origin.x = far[i];
        check_map_refused(&map, LCM_TASK_FAR);
    }
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        map.resolution = sizes[i];
        check_map_refused(&map, LCM_TASK_RESOLUTION);
    }
    free_cells(&map);
}

static void test_a_heading_of_many_turns_is_sound(void)
{
    begin();
    for (int turns = -3; turns <= 3; turns++) {
        const struct packet packet = goal_of(1, 0.1, 0.1, M_PI / 4 + 2 * M_PI * turns);

        TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_map_goal, &packet));
        TEST_ASSERT_TRUE(labs((long)team.navigator.goal.heading - 0x20000000L) < 16);
    }
}

static enum lcm_task_result take_long(const jp_map_t *map)
{
    const struct long_packet packet = map_packet(map);
    const enum lcm_task_result result = lcm_operator_map(&team, packet.bytes, packet.size);

    free(packet.bytes);
    return result;
}

static void test_the_largest_maps(void)
{
    jp_map_t map = free_map(JP_TERRAIN_SIDE_MAX, JP_TERRAIN_SIDE_MAX);

    begin();
    map.cells[4095][4095] = JP_CELL_OCCUPIED;
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take_long(&map));
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, cell_at(4095, 4095));
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell_at(4094, 4095));
    free_cells(&map);
}

/** Cells of which every other one differs, so that nothing is saved: two bits each. */
static jp_map_t rough_map(int16_t side)
{
    jp_map_t map = free_map(side, side);

    for (int y = 0; y < side; y++) {
        for (int x = 0; x < side; x++) {
            map.cells[y][x] = (uint8_t)random_uniform(&noise, 0, 3);
        }
    }
    return map;
}

static void test_a_map_that_is_too_long_for_the_bus(void)
{
    jp_map_t map = rough_map(520);

    begin();
    TEST_ASSERT_EQUAL_INT(LCM_TASK_STREAM, take_long(&map));
    check_map_is_as_it_was();
    TEST_ASSERT_TRUE(team.is_given);
    free_cells(&map);
    map = rough_map(500);
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take_long(&map));
    free_cells(&map);
}

static void test_cells_that_make_the_map_too_long_for_the_bus(void)
{
    static jp_cell_t row[600];
    jp_map_t map = free_map(600, 600);
    const jp_cells_t message = {.map_id = 1, .count = 600, .cells = row};
    static uint8_t bytes[8192];

    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take_long(&map));
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_map_goal, &sound_goal));
    for (int16_t y = 0; y < 600; y++) {
        for (int16_t x = 0; x < 600; x++) {
            row[x] = (jp_cell_t){.x = x, .y = y, .cell = (int8_t)random_uniform(&noise, 0, 3)};
        }

        const int size = jp_cells_t_encode(bytes, 0, sizeof bytes, &message);

        TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, lcm_operator_cells(&team, bytes, (size_t)size));
    }

    const struct jp_navigation_operator before = team.navigator;
    const uint32_t crc = team.navigator.crc;
    const size_t untold = team.map.untold_count;

    TEST_ASSERT_EQUAL_INT(LCM_TASK_STREAM, take(lcm_operator_map_goal, &sound_goal));
    TEST_ASSERT_EQUAL_MEMORY(&before, &team.navigator, sizeof before);
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(crc, jp_crc32(0, team.navigator.stream.bytes, team.navigator.stream.length),
                                    "what is on its way to the robot stays");
    TEST_ASSERT_EQUAL_UINT(untold, team.map.untold_count);
    free_cells(&map);
}

static void test_the_same_map_at_another_time_is_no_other(void)
{
    const struct packet later = with_number(sound_map, TIME_PLACE, 4, 12345);
    const struct packet other = with_number(sound_map, ID_PLACE, 2, 2);

    begin();
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_cells, &sound_cells));
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_map, &later));
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, lcm_operator_phase(&team));
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, cell_at(1, 2));
    TEST_ASSERT_EQUAL_INT(LCM_TASK_OK, take(lcm_operator_map, &other));
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_IDLE, lcm_operator_phase(&team));
    TEST_ASSERT_FALSE(team.is_given);
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell_at(1, 2));
}

/** Every flipped bit is refused, or leaves a packet that some sender might have meant: then the map holds its sides. */
static void check_flips(lcm_operator_take *take_packet, const struct packet *sound)
{
    for (size_t bit = 0; bit < 8 * sound->size; bit++) {
        struct packet packet = *sound;

        packet.bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);

        const enum lcm_task_result result = take(take_packet, &packet);

        TEST_ASSERT_TRUE_MESSAGE(result != LCM_TASK_OK || bit >= 64, "the fingerprint");
        TEST_ASSERT_EQUAL_UINT16(WIDTH, team.map.terrain.config.width);
        TEST_ASSERT_EQUAL_UINT16(HEIGHT, team.map.terrain.config.height);
        TEST_ASSERT_TRUE(team.navigator.goal.x < WIDTH && team.navigator.goal.y < HEIGHT);
        take_map();
    }
}

static void test_every_flipped_bit_is_refused_or_leaves_a_sound_packet(void)
{
    begin();
    check_flips(lcm_operator_map, &sound_map);
    check_flips(lcm_operator_cells, &sound_cells);
    check_flips(lcm_operator_map_goal, &sound_goal);
}

static void test_junk_is_refused_or_sound(void)
{
    static lcm_operator_take *const takes[] = {lcm_operator_map, lcm_operator_cells, lcm_operator_map_goal};
    const struct packet *const sound[] = {&sound_map, &sound_cells, &sound_goal};
    unsigned refused = 0;

    begin();
    for (int i = 0; i < JUNK; i++) {
        struct packet packet = *sound[i % 3];
        /* Most of it with the right fingerprint and head. */
        const size_t from = (size_t)random_uniform(&noise, 0, 30);

        packet.size = (size_t)random_uniform(&noise, 0, 200);
        for (size_t at = from; at < packet.size; at++) {
            packet.bytes[at] = (uint8_t)random_uniform(&noise, 0, 256);
        }
        refused += take(takes[i % 3], &packet) != LCM_TASK_OK;
        TEST_ASSERT_TRUE(team.map.id >= 1 && team.map.id <= 15);
    }
    TEST_ASSERT_GREATER_THAN_UINT(JUNK / 2, refused);
}

static void test_each_refusal_is_one_line(void)
{
    for (int i = LCM_TASK_OK + 1; i < LCM_TASK_RESULTS; i++) {
        const char *text = lcm_task_text((enum lcm_task_result)i);

        TEST_ASSERT_TRUE(strlen(text) > 10);
        TEST_ASSERT_NULL(strchr(text, '\n'));
        for (int k = LCM_TASK_OK + 1; k < i; k++) {
            TEST_ASSERT_TRUE(strcmp(text, lcm_task_text((enum lcm_task_result)k)) != 0);
        }
    }
}

int main(void)
{
    printf("seed %u\n", SEED);
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
