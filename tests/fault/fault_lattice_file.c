/* Lattices from files: the built-in ones written and read are the same, bit for bit; every way that a file can be wrong
 * gives one clear line on stderr that names the file and the culprit, no crash. */
#include <joulepath/tables.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/random.h"
#include "sim/files/lattice_file.h"
#include "tests/support/bad_file.h"
#include "tests/support/mutation.h"
#include "unity.h"

#define SEED      20261124u
#define MUTATIONS 1500
#define TEXT_MAX  65536

static const struct jp_lattice *const built_in[] = {&jp_lattice_gao2018, &jp_lattice_zhang2018};

static char sound[TEXT_MAX];
static struct lattice_file file;
static struct random noise;

/* A file that is refused leaves nothing behind. */
static bool load_lattice(const char *name)
{
    const bool loaded = lattice_file_load(name, &file);

    TEST_ASSERT_TRUE(loaded || (file.primitives == NULL && file.spans == NULL));
    return loaded;
}

/* ---- A built-in lattice as text ---- */

static void add(const char *format, ...) __attribute__((format(printf, 1, 2)));
static void add(const char *format, ...)
{
    const size_t length = strlen(sound);
    va_list arguments;

    va_start(arguments, format);
    TEST_ASSERT_TRUE(vsnprintf(sound + length, TEXT_MAX - length, format, arguments) < (int)(TEXT_MAX - length));
    va_end(arguments);
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

static size_t span_count(const struct jp_lattice *lattice)
{
    size_t count = (size_t)lattice->core.first_span + lattice->core.span_count;

    for (unsigned i = 0; i < lattice->first_from[JP_HEADINGS]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];
        count = larger(count, (size_t)primitive->first_span + primitive->span_count);
    }
    for (unsigned i = 0; i < JP_HEADINGS; i++) {
        count = larger(count, (size_t)lattice->footprint[i].first_span + lattice->footprint[i].span_count);
        count = larger(count, (size_t)lattice->reach[i].first_span + lattice->reach[i].span_count);
    }
    return count;
}

static void add_primitives(const struct jp_lattice *lattice)
{
    size_t moves = 0;

    add("\"primitives\": [");
    for (unsigned i = 0; i < lattice->first_from[JP_HEADINGS]; i++) {
        const struct jp_primitive *p = &lattice->primitives[i];
        add("%s[%d, %d, %u, %u, %u, %u, %u, %u, %u, %u, %u, %u, %u]", i > 0 ? ", " : "", p->dx, p->dy, p->start, p->end,
            p->base[0], p->base[1], p->base[2], p->length, p->duration, p->first_move, p->first_span, p->move_count,
            p->span_count);
        moves = larger(moves, (size_t)p->first_move + p->move_count);
    }
    add("],\n\"moves\": [");
    for (size_t i = 0; i < moves; i++) {
        add("%s%u", i > 0 ? ", " : "", lattice->moves[i]);
    }
    add("],\n\"spans\": [");
    for (size_t i = 0; i < span_count(lattice); i++) {
        const struct jp_span *span = &lattice->spans[i];
        add("%s[%d, %d, %d]", i > 0 ? ", " : "", span->y, span->first, span->last);
    }
    add("],\n");
}

static void add_cells(const char *key, const struct jp_cells *cells, size_t count)
{
    add("\"%s\": [", key);
    for (size_t i = 0; i < count; i++) {
        add("%s[%u, %u]", i > 0 ? ", " : "", cells[i].first_span, cells[i].span_count);
    }
    add("],\n");
}

static void write_sound(const struct jp_lattice *lattice)
{
    sound[0] = '\0';
    add("{\"format\": \"joulepath-lattice-1\", \"robot\": \"%s\",\n\"resolution\": [%d],\n\"heading\": [0",
        lattice->name, (int)lattice->resolution);
    for (unsigned i = 1; i < JP_HEADINGS; i++) {
        add(", %lu", (unsigned long)lattice->heading[i]);
    }
    add("],\n");
    add_primitives(lattice);
    add_cells("footprint", lattice->footprint, JP_HEADINGS);
    add_cells("reach", lattice->reach, JP_HEADINGS);
    add_cells("core", &lattice->core, 1);
    add("\"move_costs\": [");
    for (unsigned i = 0; i < JP_COST_KINDS * JP_MOVE_KINDS; i++) {
        const struct jp_slope_cost *cost = &lattice->move_costs[i / JP_MOVE_KINDS][i % JP_MOVE_KINDS];
        add("%s[%d, %d, %d, %d, %d, %d, %d, %d, %u]", i > 0 ? ",\n" : "", (int)cost->climb.constant,
            (int)cost->climb.linear, (int)cost->climb.quadratic, (int)cost->descend.constant, (int)cost->descend.linear,
            (int)cost->descend.quadratic, cost->bend, cost->rise_max, cost->floor);
    }
    add("]}\n");
    write_file(sound, strlen(sound));
}

void setUp(void)
{
    write_sound(&jp_lattice_gao2018);
}

void tearDown(void)
{
}

/* The sound file with the first `from` after `key` replaced by `to`. */
static void write_with(const char *key, const char *from, const char *to)
{
    static char text[TEXT_MAX + 256];
    const char *start = strstr(sound, key);
    TEST_ASSERT_NOT_NULL_MESSAGE(start, key);
    start = strstr(start, from);
    TEST_ASSERT_NOT_NULL_MESSAGE(start, from);
    (void)snprintf(text, sizeof text, "%.*s%s%s", (int)(start - sound), sound, to, start + strlen(from));
    write_file(text, strlen(text));
}

static void check_with(const char *key, const char *from, const char *to, const char *culprit)
{
    write_with(key, from, to);
    check_refused(path, culprit);
}

/* ---- Sound files ---- */

static void expect_lattice(const struct jp_lattice *expected, const struct jp_lattice *lattice)
{
    const size_t count = expected->first_from[JP_HEADINGS];

    TEST_ASSERT_EQUAL_STRING(expected->name, lattice->name);
    TEST_ASSERT_EQUAL_INT32(expected->resolution, lattice->resolution);
    TEST_ASSERT_EQUAL_MEMORY(expected->heading, lattice->heading, sizeof expected->heading);
    TEST_ASSERT_EQUAL_MEMORY(expected->first_from, lattice->first_from, sizeof expected->first_from);
    TEST_ASSERT_EQUAL_MEMORY(expected->first_to, lattice->first_to, sizeof expected->first_to);
    TEST_ASSERT_EQUAL_MEMORY(expected->footprint, lattice->footprint, sizeof expected->footprint);
    TEST_ASSERT_EQUAL_MEMORY(expected->reach, lattice->reach, sizeof expected->reach);
    TEST_ASSERT_EQUAL_MEMORY(&expected->core, &lattice->core, sizeof expected->core);
    TEST_ASSERT_EQUAL_MEMORY(expected->by_end, lattice->by_end, count * sizeof *expected->by_end);
    TEST_ASSERT_EQUAL_MEMORY(expected->primitives, lattice->primitives, count * sizeof *expected->primitives);
    TEST_ASSERT_EQUAL_MEMORY(expected->spans, lattice->spans, span_count(expected) * sizeof *expected->spans);
    for (unsigned i = 0; i < JP_COST_KINDS * JP_MOVE_KINDS; i++) {
        const struct jp_slope_cost *a = &expected->move_costs[i / JP_MOVE_KINDS][i % JP_MOVE_KINDS];
        const struct jp_slope_cost *b = &lattice->move_costs[i / JP_MOVE_KINDS][i % JP_MOVE_KINDS];
        for (int32_t rise = -a->rise_max - 1; rise <= a->rise_max + 1; rise++) {
            TEST_ASSERT_EQUAL_UINT32(jp_move_cost(a, rise), jp_move_cost(b, rise));
        }
        TEST_ASSERT_EQUAL_MEMORY(a, b, sizeof *a - 2 * sizeof a->floor); /* behind it is padding */
    }
    TEST_ASSERT_EQUAL_UINT32(0, lattice->version);
}

static void test_built_in_lattices_come_back_bit_for_bit(void)
{
    for (size_t i = 0; i < sizeof built_in / sizeof built_in[0]; i++) {
        write_sound(built_in[i]);
        TEST_ASSERT_TRUE_MESSAGE(load(path), errors);
        TEST_ASSERT_EQUAL_STRING("", errors);
        expect_lattice(built_in[i], &file.lattice);
        lattice_file_free(&file);
        TEST_ASSERT_NULL(file.primitives);
        lattice_file_free(&file);
    }
}

/* ---- Wrong files ---- */

static void test_files_that_are_no_lattice(void)
{
    check_refused("/tmp/no such lattice.json", "No such file");
    check_refused(folder, "line 1");
    write_file("", 0);
    check_refused(path, "--json");
    write_file("resolution_m: 0.025\n", 20);
    check_refused(path, "tools.design.lattice");
    write_file("{}", 2);
    check_refused(path, "is no joulepath-lattice-1");
    write_file("[]", 2);
    check_refused(path, "is no joulepath-lattice-1");
    check_with("format", "lattice-1", "lattice-2", "is no joulepath-lattice-1");
    check_with("robot", "\"gao2018\"", "\"\"", "robot: ");
    check_with("robot", "\"gao2018\"", "7", "robot: ");
    check_with("robot", "gao2018", "ROBOT_678901234567890123456789012345678901234567890123456789012345678", "robot: ");
    check_with("\"robot\"", "\"robot\"", "\"format\"", "duplicate");
}

static void test_members_that_are_missing(void)
{
    static const char *const keys[] = {"resolution", "heading", "primitives", "moves",     "spans",
                                       "footprint",  "reach",   "core",       "move_costs"};

    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        char key[32];
        char culprit[32];
        (void)snprintf(key, sizeof key, "\"%s\"", keys[i]);
        (void)snprintf(culprit, sizeof culprit, "%s: must be a list", keys[i]);
        check_with(key, key, "\"other\"", culprit);
    }
}

static void test_numbers_out_of_range(void)
{
    check_with("resolution", "[13107]", "[0]", "resolution: row 0");
    check_with("resolution", "[13107]", "[13107.5]", "resolution: row 0");
    check_with("resolution", "[13107]", "[1, 2]", "resolution: must be a list");
    check_with("resolution", "[13107]", "13107", "resolution: must be a list");
    check_with("heading", "[0,", "[4294967296,", "heading: row 0");
    check_with("heading", "[0,", "[", "heading: must be a list");
    check_with("primitives", "[[1,", "[[-128,", "number 1 from -127 to 127");
    check_with("primitives", "[[1, 0, 0,", "[[1, 0, 16,", "primitives: row 0");
    check_with("primitives", "[[1, 0, 0,", "[[1, 0,", "primitives: row 0: needs 13");
    check_with("primitives", "[[1, 0, 0,", "[7, [1, 0, 0,", "primitives: row 0: needs 13");
    check_with("moves", "[0,", "[16,", "moves: row 0");
    check_with("spans", "[[", "[[0, 128, 0], [", "spans: row 0");
    check_with("move_costs", "]]}", ", 1]]}", "move_costs: row 8");
}

/* What jp_lattice_check() cannot know, or finds. */
static void test_members_that_do_not_fit_together(void)
{
    check_with("\"heading\"", "[0,", "[1,", "heading: does not fit");
    check_with("primitives", "[1, 0, 0, 0,", "[2, 0, 0, 0,", "primitives: does not fit");
    check_with("primitives", "[1, 0, 0, 0,", "[1, 0, 3, 0,", "primitives: does not fit");
    check_with("footprint", "[[", "[[65535, 1], [", "footprint: must be a list");
    check_with("reach", "[[", "[[6", "does not fit");
    check_with("spans", "[[", "[[1, 5, 2], [", "spans: does not fit");
}

static void test_a_core_that_is_not_swept(void)
{
    char before[64];
    char after[64];
    const struct jp_cells core = jp_lattice_gao2018.core;
    const struct jp_cells *reach = &jp_lattice_gao2018.reach[0];

    (void)snprintf(before, sizeof before, "\"core\": [[%u, %u]]", core.first_span, core.span_count);
    (void)snprintf(after, sizeof after, "\"core\": [[%u, %u]]", reach->first_span, reach->span_count);
    check_with("\"core\"", before, after, "core: does not fit");
    (void)snprintf(after, sizeof after, "\"core\": [[%u, 0]]", core.first_span);
    check_with("\"core\"", before, after, "spans: does not fit");
}

static void test_parts_out_of_the_pools(void)
{
    const struct jp_primitive *first = &jp_lattice_gao2018.primitives[0];
    const struct jp_cells *footprint = &jp_lattice_gao2018.footprint[0];
    char before[64];
    char after[64];

    (void)snprintf(before, sizeof before, "%u, %u, %u, %u]", first->first_move, first->first_span, first->move_count,
                   first->span_count);
    (void)snprintf(after, sizeof after, "65535, %u, %u, %u]", first->first_span, first->move_count, first->span_count);
    check_with("primitives", before, after, "first_move");
    (void)snprintf(after, sizeof after, "%u, 65535, %u, %u]", first->first_move, first->move_count, first->span_count);
    check_with("primitives", before, after, "first_span");
    (void)snprintf(before, sizeof before, "[[%u, %u]", footprint->first_span, footprint->span_count);
    check_with("footprint", before, "[[65535, 9]", "first_span");
}

/* ---- Mutations ---- */

/* What is loaded is sound in all that a planner relies on. */
static void test_mutations_load_or_are_refused(void)
{
    int loaded = 0;

    printf("seed %u\n", SEED);
    random_init(&noise, SEED);
    for (int i = 0; i < MUTATIONS; i++) {
        static char text[TEXT_MAX + 64];
        size_t size = strlen(sound);
        memcpy(text, sound, size);
        for (size_t left = 1 + draw(&noise, 2); left > 0; left--) {
            size = mutate(text, size, &noise);
        }
        write_file(text, size);
        if (load(path)) {
            const char *field = "";
            TEST_ASSERT_EQUAL_STRING("", errors);
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_check(&file.lattice, &field));
            lattice_file_free(&file);
            loaded++;
        } else {
            check_one_line(path);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(0, loaded);
    TEST_ASSERT_LESS_THAN_INT(MUTATIONS / 2, loaded);
}

static void test_truncations_are_refused(void)
{
    for (size_t size = 0; size < strlen(sound) - 2; size += 1 + draw(&noise, 50)) {
        write_file(sound, size);
        TEST_ASSERT_FALSE(load(path));
        check_one_line(path);
    }
}

int main(void)
{
    bad_file_begin("lattice.json", load_lattice);
    UNITY_BEGIN();
    run_tests();
    bad_file_end();
    return UNITY_END();
}
