/* Every way that a map file can be wrong: one clear line on stderr that names the file and the culprit, no crash. */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/random.h"
#include "sim/files/map_file.h"
#include "tests/support/bad_file.h"
#include "tests/support/mutation.h"
#include "unity.h"

#define SEED      20180900u
#define MUTATIONS 3000
#define TEXT_MAX  4096

/* Three rows of four cells; the northern one first. */
static const char sound[] = "{\"format\": \"joulepath-map-1\", \"name\": \"yard\", \"width\": 4, \"height\": 3,\n"
                            "\"resolution_m\": 0.2, \"origin_m\": [-1.5, 2, 0.25], \"note\": \"by hand\",\n"
                            "\"rows\": [\"..#?\",\n\"#...\",\n\"?..#\"],\n"
                            "\"elevation_m\": [[1, 2, 3, 4],\n[-1.5, 0, 0.25, 31.999],\n[0.001, -31.999, 5e-1, 0]]}\n";

static struct map_file map;
static struct random noise;

void setUp(void)
{
}

void tearDown(void)
{
}

/* A file that is refused leaves nothing behind. */
static bool load_map(const char *name)
{
    const bool loaded = map_file_load(name, &map);
    TEST_ASSERT_TRUE(loaded || map.block == NULL);
    return loaded;
}

/* The sound file with the first `from` replaced by `to`. */
static void write_with(const char *from, const char *to)
{
    const char *start = strstr(sound, from);
    TEST_ASSERT_NOT_NULL_MESSAGE(start, from);
    write_replaced(sound, start, start + strlen(from), to);
}

/* The sound file without a key. */
static void write_without(const char *key)
{
    json_t *root = json_loads(sound, 0, NULL);
    TEST_ASSERT_TRUE_MESSAGE(json_object_del(root, key) == 0, key);
    char *text = json_dumps(root, 0);
    write_file(text, strlen(text));
    free(text);
    json_decref(root);
}

static void check_with(const char *from, const char *to, const char *culprit)
{
    write_with(from, to);
    check_refused(path, culprit);
}

static void check_loads_with(const char *from, const char *to)
{
    write_with(from, to);
    TEST_ASSERT_TRUE_MESSAGE(load(path), errors);
    TEST_ASSERT_EQUAL_STRING("", errors);
}

/* ---- Sound files ---- */

static void test_a_sound_file_loads_with_its_southern_row_last(void)
{
    static const enum jp_cell cells[3][4] = {
        {JP_CELL_UNKNOWN, JP_CELL_FREE, JP_CELL_FREE, JP_CELL_OCCUPIED},
        {JP_CELL_OCCUPIED, JP_CELL_FREE, JP_CELL_FREE, JP_CELL_FREE},
        {JP_CELL_FREE, JP_CELL_FREE, JP_CELL_OCCUPIED, JP_CELL_UNKNOWN},
    };
    static const int elevations[3][4] = {{1, -32767, 512, 0}, {-1536, 0, 256, 32767}, {1024, 2048, 3072, 4096}};

    write_file(sound, strlen(sound));
    TEST_ASSERT_TRUE_MESSAGE(load(path), errors);
    TEST_ASSERT_EQUAL_STRING("", errors);
    TEST_ASSERT_EQUAL_STRING("yard", map.name);
    TEST_ASSERT_EQUAL_STRING("by hand", map.note);
    TEST_ASSERT_EQUAL_DOUBLE(-1.5, map.origin[0]);
    TEST_ASSERT_EQUAL_DOUBLE(2.0, map.origin[1]);
    TEST_ASSERT_EQUAL_DOUBLE(0.25, map.origin[2]);
    TEST_ASSERT_EQUAL_INT(4, map.terrain.config.width);
    TEST_ASSERT_EQUAL_INT(3, map.terrain.config.height);
    TEST_ASSERT_EQUAL_INT(JP_Q16(0.2), map.terrain.config.resolution);
    TEST_ASSERT_FALSE(map.terrain.config.unknown_is_free);
    for (int y = 0; y < 3; y++) {
        for (int x = 0; x < 4; x++) {
            TEST_ASSERT_EQUAL_INT(cells[y][x], jp_terrain_cell(&map.terrain, x, y));
            TEST_ASSERT_EQUAL_INT(elevations[y][x], jp_terrain_elevation(&map.terrain, x, y));
        }
    }
    map_file_free(&map);
    TEST_ASSERT_NULL(map.block);
    map_file_free(&map);
}

static void test_note_and_elevation_may_be_absent(void)
{
    char text[TEXT_MAX];
    check_loads_with(", \"note\": \"by hand\"", "");
    TEST_ASSERT_EQUAL_STRING("", map.note);
    map_file_free(&map);

    const int length = (int)(strstr(sound, ",\n\"elevation_m\"") - sound);
    (void)snprintf(text, sizeof text, "%.*s}", length, sound);
    write_file(text, strlen(text));
    TEST_ASSERT_TRUE_MESSAGE(load(path), errors);
    TEST_ASSERT_FALSE(map.terrain.config.has_elevation);
    TEST_ASSERT_EQUAL_INT(0, jp_terrain_elevation(&map.terrain, 0, 2));
    map_file_free(&map);
}

/* The sound file with costs; the northern row first. */
static void write_costs(const char *shift, const char *costs)
{
    char text[TEXT_MAX];
    (void)snprintf(text, sizeof text, "%.*s,\n\"cost_shift\": %s, \"cost\": %s}\n", (int)strlen(sound) - 2, sound,
                   shift, costs);
    write_file(text, strlen(text));
}

static void test_costs_of_cells(void)
{
    static const int costs[3][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 255}};

    write_costs("4", "[[8, 9, 10, 255], [4, 5, 6, 7], [0, 1, 2, 3]]");
    TEST_ASSERT_TRUE_MESSAGE(load(path), errors);
    TEST_ASSERT_TRUE(map.terrain.config.has_costs);
    TEST_ASSERT_EQUAL_INT(4, map.terrain.config.cost_shift);
    for (int i = 0; i < 12; i++) {
        TEST_ASSERT_EQUAL_INT(costs[i / 4][i % 4], jp_terrain_cost(&map.terrain, i % 4, i / 4));
    }
    TEST_ASSERT_EQUAL_INT(4096, jp_terrain_elevation(&map.terrain, 3, 2));
    map_file_free(&map);
}

static void test_wrong_costs(void)
{
    static const struct {
        const char *shift;
        const char *costs;
        const char *culprit;
    } wrong[] = {
        {"9", "[[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]", "cost_shift: 9 is not in 0…8"},
        {"-1", "[[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]", "cost_shift: -1"},
        {"0.5", "[[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]", "cost_shift: "},
        {"0", "[[0, 0, 0, 0], [0, 0, 0, 0]]", "cost: is no list of 3"},
        {"0", "7", "cost: is no list of 3"},
        {"0", "[[0, 0, 0, 0], [0, 0, 0], [0, 0, 0, 0]]", "cost: row 2 is no list of 4"},
        {"0", "[[0, 0, 0, 0], [0, 0, 256, 0], [0, 0, 0, 0]]", "cost: row 2, cell 3"},
        {"0", "[[0, 0, 0, 0], [0, 0, 0, 0], [0, -1, 0, 0]]", "cost: row 3, cell 2"},
        {"0", "[[0.5, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]", "cost: row 1, cell 1"},
    };

    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        write_costs(wrong[i].shift, wrong[i].costs);
        check_refused(path, wrong[i].culprit);
    }
    check_with("\"note\": \"by hand\"", "\"cost\": []", "cost_shift: the key is missing");
}

/* The sound file with classes of ground, and what they are like, or "" ; the northern row first. */
static void write_classes(const char *classes, const char *grounds)
{
    char text[TEXT_MAX];
    (void)snprintf(text, sizeof text, "%.*s,\n\"class\": %s%s%s}\n", (int)strlen(sound) - 2, sound, classes,
                   grounds[0] != '\0' ? ", \"grounds\": " : "", grounds);
    write_file(text, strlen(text));
}

static void test_classes_of_ground(void)
{
    static const int classes[3][4] = {{3, 2, 1, 0}, {0, 0, 0, 0}, {0, 1, 2, 3}};

    write_classes("[\"0123\", \"0000\", \"3210\"]", "[{\"name\": \"asphalt\", \"rolling\": 1, \"friction\": 1}, "
                                                    "{\"name\": \"mud\", \"rolling\": 2.5, \"friction\": 0.5}]");
    TEST_ASSERT_TRUE_MESSAGE(load(path), errors);
    for (int i = 0; i < 12; i++) {
        TEST_ASSERT_EQUAL_INT(classes[i / 4][i % 4], jp_terrain_class(&map.terrain, i % 4, i / 4));
    }
    TEST_ASSERT_EQUAL_STRING("mud", map.grounds[1].name);
    TEST_ASSERT_TRUE(map.grounds[1].rolling == 2.5 && map.grounds[1].friction == 0.5);
    TEST_ASSERT_TRUE(map.grounds[3].rolling == 1 && map.grounds[3].friction == 1);
    map_file_free(&map);
    write_classes("[\"0123\", \"0000\", \"3210\"]", "");
    TEST_ASSERT_TRUE_MESSAGE(load(path), errors);
    TEST_ASSERT_TRUE(map.grounds[1].rolling == 1 && map.grounds[1].name[0] == '\0');
    map_file_free(&map);
}

static void test_wrong_classes(void)
{
    static const struct {
        const char *classes;
        const char *grounds;
        const char *culprit;
    } wrong[] = {
        {"7", "", "class: is no list of 3"},
        {"[\"0000\", \"0000\"]", "", "class: is no list of 3"},
        {"[\"0000\", \"000\", \"0000\"]", "", "class: row 2"},
        {"[\"0000\", 0, \"0000\"]", "", "class: row 2"},
        {"[\"0000\", \"0000\", \"0004\"]", "", "class: row 3, cell 4"},
        {"[\"0000\", \"0000\", \"/000\"]", "", "class: row 3, cell 1"},
        {"[\"0000\", \"0000\", \"0000\"]", "7", "grounds: is no list of at most 4"},
        {"[\"0000\", \"0000\", \"0000\"]", "[{\"name\": \"mud\"}]", "grounds: "},
        {"[\"0000\", \"0000\", \"0000\"]", "[{\"name\": \"mud\", \"rolling\": 0, \"friction\": 1}]", "mud: rolling: 0"},
        {"[\"0000\", \"0000\", \"0000\"]", "[{\"name\": \"mud\", \"rolling\": 1, \"friction\": 1.5}]",
         "mud: friction: 1.5"},
    };

    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        write_classes(wrong[i].classes, wrong[i].grounds);
        check_refused(path, wrong[i].culprit);
    }
    check_with("\"note\": \"by hand\"", "\"grounds\": []", "grounds: is no list of at most 4");
}

static void test_resolution_at_its_limits(void)
{
    check_loads_with("0.2", "0.001");
    TEST_ASSERT_EQUAL_INT(66, map.terrain.config.resolution);
    map_file_free(&map);
    check_loads_with("0.2", "1000");
    TEST_ASSERT_EQUAL_INT(JP_Q16(1000), map.terrain.config.resolution);
    map_file_free(&map);
}

/* ---- Wrong files ---- */

static void test_files_that_cannot_be_read(void)
{
    check_refused("/tmp/no such map.json", "No such file");
    check_refused(folder, "Is a directory");
    write_file("", 0);
    check_refused(path, "empty");
}

static void test_files_that_are_no_json(void)
{
    static const char binary[] = "\x7f"
                                 "ELF\0\0\0\x01\xff\xfe{}";
    write_file(binary, sizeof binary);
    check_refused(path, "line 1");
    write_file("P5\n2 2\n255\nabcd", 15);
    check_refused(path, "line 1");
    write_file("[1, 2", 5);
    check_refused(path, "line 1");
    check_with("]]}\n", "]]} 1", "line");
    check_with("\"width\"", "\"width\": 4, \"width\"", "duplicate");
    check_with("yard", "ya\\u0000rd", "\\u0000");
    check_with("yard",
               "ya\xff"
               "rd",
               "line 1");
    check_with("0.25", "1e999", "line");
    check_with("0.25", "NaN", "line");
}

/* Nesting that would overflow the stack of a careless reader. */
static void test_deep_nesting(void)
{
    static char deep[100000];
    memset(deep, '[', sizeof deep);
    write_file(deep, sizeof deep);
    check_refused(path, "depth");
}

static void test_missing_and_surplus_keys(void)
{
    static const char *const keys[] = {"format", "name", "width", "height", "resolution_m", "origin_m", "rows"};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        char key[32];
        (void)snprintf(key, sizeof key, "\"%s\"", keys[i]);
        check_with(key, "\"other\"", "other: no such key");
    }
    check_with("\"note\"", "\"nota\"", "nota");
    check_with("\"elevation_m\"", "\"elevation\"", "elevation");
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        write_without(keys[i]);
        check_refused(path, "the key is missing");
        TEST_ASSERT_TRUE_MESSAGE(strstr(errors, keys[i]) != NULL, errors);
    }
    write_file("[]", 2);
    check_refused(path, "object");
}

static void test_values_of_the_wrong_kind(void)
{
    check_with("\"joulepath-map-1\"", "1", "format: ");
    check_with("joulepath-map-1", "joulepath-map-2", "joulepath-map-2");
    check_with("\"yard\"", "null", "name: ");
    check_with("4,", "\"4\",", "width: ");
    check_with("4,", "4.0,", "width: ");
    check_with("0.2", "true", "resolution_m: ");
    check_with("[-1.5, 2, 0.25]", "[-1.5, 2]", "origin_m: ");
    check_with("[-1.5, 2, 0.25]", "[-1.5, 2, 0.25, 1]", "origin_m: ");
    check_with("[-1.5, 2, 0.25]", "{}", "origin_m: ");
    check_with("[-1.5, 2, 0.25]", "[-1.5, 2, \"0\"]", "origin_m: ");
    check_with("\"by hand\"", "[]", "note: ");
    check_with("[\"..#?\",\n\"#...\",\n\"?..#\"]", "\"..#?\"", "rows");
    check_with("[[1, 2, 3, 4],\n[-1.5, 0, 0.25, 31.999],\n[0.001, -31.999, 5e-1, 0]]", "null", "elevation_m");
}

static void test_sizes_out_of_range(void)
{
    static const char *const sizes[] = {"0,", "-4,", "4097,", "4294967300,", "9223372036854775807,"};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        check_with("4,", sizes[i], "width: ");
        check_with("3,\n", sizes[i], "height: ");
    }
    check_with("4,", "99999999999999999999,", "line 1");
}

static void test_numbers_out_of_range(void)
{
    static const char *const resolutions[] = {"0", "-0.2", "0.0009", "1000.1", "1e300"};
    for (size_t i = 0; i < sizeof resolutions / sizeof resolutions[0]; i++) {
        check_with("0.2", resolutions[i], "resolution_m");
    }
    check_with("31.999", "32", "elevation_m: row 2, cell 4");
    check_with("-31.999", "-32", "elevation_m: row 3, cell 2");
    check_with("31.999", "1e300", "elevation_m: row 2, cell 4");
    check_with("31.999", "\"1\"", "elevation_m: row 2, cell 4");
    check_with("31.999", "null", "elevation_m: row 2, cell 4");
}

static void test_grids_that_do_not_fit_the_size(void)
{
    check_with("4,", "5,", "rows: row 1");
    check_with("3,\n", "4,\n", "rows");
    check_with("3,\n", "2,\n", "rows");
    check_with("#...", "#..", "rows: row 2");
    check_with("#...", "#....", "rows: row 2");
    check_with("\"#...\"", "7", "rows: row 2");
    check_with("[1, 2, 3, 4]", "[1, 2, 3]", "elevation_m: row 1");
    check_with("[1, 2, 3, 4]", "[1, 2, 3, 4, 5]", "elevation_m: row 1");
    check_with("[1, 2, 3, 4]", "5", "elevation_m: row 1");
    check_with("[1, 2, 3, 4],\n", "", "elevation_m: is no list");
}

static void test_wrong_cells(void)
{
    static const char *const rows[] = {"?. #", "?.@#", "?.\\n#", "?.\xc3\xa9"};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        check_with("?..#", rows[i], "rows: row 3, cell 3");
    }
}

static void test_names_and_notes_that_do_not_fit(void)
{
    char text[1024];
    check_with("yard", "", "name");
    memset(text, 'x', sizeof text);
    text[MAP_FILE_NAME_SIZE - 1] = '\0';
    check_loads_with("yard", text);
    TEST_ASSERT_EQUAL_STRING(text, map.name);
    map_file_free(&map);
    text[MAP_FILE_NAME_SIZE - 1] = 'x';
    text[MAP_FILE_NAME_SIZE] = '\0';
    check_with("yard", text, "name");
    memset(text, 'x', sizeof text);
    text[MAP_FILE_NOTE_SIZE] = '\0';
    check_with("by hand", text, "note");
    text[MAP_FILE_NOTE_SIZE - 1] = '\0';
    check_loads_with("by hand", text);
    map_file_free(&map);
}

/* ---- Mutations ---- */

static void test_mutations_load_or_are_refused(void)
{
    int loaded = 0;
    printf("seed %u\n", SEED);
    random_init(&noise, SEED);
    for (int i = 0; i < MUTATIONS; i++) {
        char text[TEXT_MAX];
        size_t size = strlen(sound);
        memcpy(text, sound, size);
        for (size_t left = 1 + draw(&noise, 3); left > 0; left--) {
            size = mutate(text, size, &noise);
        }
        write_file(text, size);
        if (load(path)) {
            TEST_ASSERT_EQUAL_STRING("", errors);
            TEST_ASSERT_TRUE(map.terrain.config.width == 4 && map.terrain.config.height == 3);
            map_file_free(&map);
            loaded++;
        } else {
            check_one_line(path);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(MUTATIONS / 50, loaded);
    TEST_ASSERT_LESS_THAN_INT(MUTATIONS / 2, loaded);
}

static void test_every_truncation_is_refused(void)
{
    for (size_t size = 0; size < strlen(sound) - 1; size++) {
        write_file(sound, size);
        TEST_ASSERT_FALSE(load(path));
        check_one_line(path);
    }
}

int main(void)
{
    bad_file_begin("map.json", load_map);
    UNITY_BEGIN();
    run_tests();
    bad_file_end();
    return UNITY_END();
}
