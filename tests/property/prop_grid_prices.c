/*
 * The grid planner by prices against searches in double precision on random grids with hills: what lines and ways cost,
 * the optimum to the eight neighbours, any-angle ways that cost no more, and how much more than the cheapest way over a
 * finer grid in 32 directions they cost; after changes of the map the same way as a new planner's.
 *
 * prop_grid_prices [--count N] [--seed S] [--json FILE]
 * --count is the number of maps.
 */
#include <joulepath/grid_planner.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/grid_oracle.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

enum {
    SIDE_MIN = 3,
    SIDE_MAX = 22,
    CELLS_MAX = SIDE_MAX * SIDE_MAX,
    TASKS = 3,
    LINES = 20,
    FINE_EVERY = 8, /* maps */
    PARTS = 3,      /* of a cell's side in the finer grid */
    CHANGES = 5,
    WORK_MAX = 1 << 20,
    GRADES_PER_ONE = 32,
    LEVEL = 16,
};

/* Of a price: steps of 2⁻¹² level cells; slopes of 2⁻⁸ of a level metre, of both of two ways that are compared. */
#define TOLERANCE       5e-4
#define TOLERANCE_SLOPE 1e-2

/* Heights are in steps of 2⁻¹⁶ m: in level cells, of a short line over small ones. */
#define HEIGHTS 0.05

/* What any-angle ways may cost, over the finer grid. */
#define FINE_MAX      1.25
#define FINE_MEAN_MAX 1.02

struct trial {
    struct jp_terrain_config map;
    struct jp_terrain terrain;
    struct jp_grid_planner_config config;
    struct jp_grid_prices prices;
    struct jp_grid_planner planner;
    struct grid_oracle oracle;
    bool blocked[CELLS_MAX];
    double distance[CELLS_MAX]; /* from what is blocked, cells */
    uint64_t terrain_block[CELLS_MAX];
    uint64_t block[CELLS_MAX * 4];
};

struct counts {
    unsigned long tasks;
    unsigned long lines;
    unsigned long wrong;
    unsigned long unreachable;
    unsigned long full;
    unsigned long fine;
    double fine_most; /* any angle over the finer grid */
    double fine_sum;
};

static struct options options = {.count = 300, .seed = 1};
static struct trial trial;
static struct counts counts;
static char problem[200]; /* the first that was found */

void setUp(void)
{
    problem[0] = '\0';
}

void tearDown(void)
{
}

static void report(unsigned long number, const char *what, double found, double expected)
{
    counts.wrong++;
    if (problem[0] == '\0') {
        (void)snprintf(problem, sizeof problem, "map %lu (%d x %d, %s): %s: %.9g, expected %.9g", number,
                       trial.map.width, trial.map.height, trial.map.has_elevation ? "hills" : "level", what, found,
                       expected);
    }
}

/* ---- Maps and prices ---- */

static void put_block(enum jp_cell cell)
{
    const int x = (int)below(trial.map.width);
    const int y = (int)below(trial.map.height);
    const int width = 1 + (int)below(5);
    const int height = 1 + (int)below(5);

    for (int i = 0; i < width * height; i++) {
        (void)jp_terrain_set_cell(&trial.terrain, x + i % width, y + i / width, cell);
    }
}

/* Waves of up to a grade of 0.4. */
static void raise_hills(void)
{
    const double cell = trial.map.resolution / 65536.0;
    const double along = 2 + below(8);
    const double across = 2 + below(8);
    const double height = cell * below(400) / 1000.0;

    for (int y = 0; y < trial.map.height; y++) {
        for (int x = 0; x < trial.map.width; x++) {
            const double z = height * (along * sin(x / along) + across * cos(y / across));

            (void)jp_terrain_set_elevation(&trial.terrain, x, y, (jp_elevation)lround(z * JP_ELEVATION_ONE));
        }
    }
}

static void make_map(void)
{
    const char *field = "";

    trial.map = (struct jp_terrain_config){.width = (uint16_t)(SIDE_MIN + below(SIDE_MAX - SIDE_MIN + 1)),
                                           .height = (uint16_t)(SIDE_MIN + below(SIDE_MAX - SIDE_MIN + 1)),
                                           .resolution = JP_Q16(0.05) + (jp_q16)below(JP_Q16(0.4)),
                                           .has_elevation = below(2) == 0,
                                           .unknown_is_free = true};
    TEST_ASSERT_EQUAL_INT(
        JP_OK, jp_terrain_init(&trial.terrain, &trial.map, trial.terrain_block, sizeof trial.terrain_block, &field));
    for (uint32_t blocks = below(12); blocks > 0; blocks--) {
        put_block(JP_CELL_OCCUPIED);
    }
    raise_hills();
}

/* In steps of 1/256 of a metre's price, as the planner has them; the slopes convex. */
static void make_prices(void)
{
    const jp_q16 step = (jp_q16)(100 + below(100000));
    const uint32_t near = below(8) == 0 ? 0 : below(6 * 256);
    const int64_t square = below(300);
    const int64_t lost = below(2000);

    trial.prices = (struct jp_grid_prices){.metre = 256 * step, .rise = (jp_q16)below(JP_Q16(500))};
    /* No ring ends where cells begin. */
    trial.prices.ring = (jp_q16)(trial.map.resolution * (0.2 * (1 + below(9)) + 0.0713));
    for (unsigned i = 0; i < JP_GRID_RINGS; i++) {
        trial.prices.near[i] = step * (jp_q16)(near >> i);
    }
    for (int i = 0; i < (int)JP_GRID_GRADES; i++) {
        const int64_t downhill = i < LEVEL ? lost * (LEVEL - i) / LEVEL : 0;

        trial.prices.slope[i] = step * (jp_q16)((i - LEVEL) * (i - LEVEL) * square / 64 + downhill);
    }
}

/* ---- Oracle ---- */

static double distance_at(int x, int y)
{
    return grid_oracle_is_blocked(&trial.oracle, x, y) ? 0 : trial.distance[y * trial.map.width + x];
}

static bool shorten(int x, int y)
{
    double *const distance = &trial.distance[y * trial.map.width + x];
    const double before = *distance;

    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            *distance = fmin(*distance, distance_at(x + dx, y + dy) + (dx != 0 && dy != 0 ? 1.4 : 1));
        }
    }
    return *distance < before;
}

static void make_oracle(void)
{
    bool has_changed = true;

    trial.oracle = (struct grid_oracle){trial.map.width, trial.map.height, trial.blocked};
    for (int i = 0; i < trial.map.width * trial.map.height; i++) {
        trial.blocked[i] =
            jp_terrain_cell(&trial.terrain, i % trial.map.width, i / trial.map.width) == JP_CELL_OCCUPIED;
        trial.distance[i] = trial.blocked[i] ? 0 : 1000;
    }
    while (has_changed) {
        has_changed = false;
        for (int i = 0; i < trial.map.width * trial.map.height; i++) {
            has_changed = shorten(i % trial.map.width, i / trial.map.width) || has_changed;
        }
    }
}

/* Of a metre in a cell, in level ones. */
static double level_price(int x, int y)
{
    const double ring = ceil(distance_at(x, y) * trial.map.resolution / trial.prices.ring);

    return ring > JP_GRID_RINGS ? 1 : 1 + trial.prices.near[(int)fmax(ring, 1) - 1] / (double)trial.prices.metre;
}

static double slope_price(double grade)
{
    const double at = LEVEL + GRADES_PER_ONE * fmin(0.5, fmax(-0.5, grade));
    const int index = (int)fmin(JP_GRID_GRADES - 2, floor(at));
    const double part = at - index;

    return ((1 - part) * trial.prices.slope[index] + part * trial.prices.slope[index + 1]) / trial.prices.metre;
}

static double elevation(int x, int y)
{
    const int column = x < 0 ? 0 : x >= trial.map.width ? trial.map.width - 1 : x;
    const int row = y < 0 ? 0 : y >= trial.map.height ? trial.map.height - 1 : y;

    return jp_terrain_elevation(&trial.terrain, column, row) / (double)JP_ELEVATION_ONE;
}

/* At a place in cells, m. */
static double height(double x, double y)
{
    const int column = (int)floor(x - 0.5);
    const int row = (int)floor(y - 0.5);
    const double u = x - 0.5 - column;
    const double v = y - 0.5 - row;

    return (1 - v) * ((1 - u) * elevation(column, row) + u * elevation(column + 1, row)) +
           v * ((1 - u) * elevation(column, row + 1) + u * elevation(column + 1, row + 1));
}

/* Where a line from a to b enters the next cell after `at` of 0 to 1. */
static double next_border(double a, double b, double at)
{
    const double place = a + at * (b - a);
    const double border = b > a ? floor(place + 1e-9) + 1 : ceil(place - 1e-9) - 1;

    return fabs(b - a) < 1e-12 ? 2 : (border - a) / (b - a);
}

/* Of a line between places in cells, in level cells; along a border the cell north or east of it counts. */
static double line_price(double x0, double y0, double x1, double y1)
{
    const double length = hypot(x1 - x0, y1 - y0);
    const double cell = trial.map.resolution / 65536.0;
    double price = 0;
    double at = 0;

    while (at < 1) {
        const double next = fmin(1, fmin(next_border(x0, x1, at), next_border(y0, y1, at)));
        const double middle = (at + next) / 2;
        const double rise =
            height(x0 + next * (x1 - x0), y0 + next * (y1 - y0)) - height(x0 + at * (x1 - x0), y0 + at * (y1 - y0));
        const double part = (next - at) * length;
        const double slope = trial.map.has_elevation && part > 1e-9 ? slope_price(rise / (part * cell)) : 0;

        price += part * (level_price((int)floor(x0 + middle * (x1 - x0)), (int)floor(y0 + middle * (y1 - y0))) + slope);
        at = next;
    }
    return price;
}

/* To the eight neighbours, or in 32 directions over a grid that is finer; in level cells. */
struct search {
    int parts; /* of a cell's side */
    int reach; /* of a step */
    int width;
    int height;
    double *costs;
    struct heap heap;
};

static double place_of(const struct search *search, int index)
{
    return (index + 0.5) / search->parts;
}

static int divisor(int a, int b)
{
    return b == 0 ? a : divisor(b, a % b);
}

static bool can_step(const struct search *search, int x, int y, int dx, int dy)
{
    if (x + dx < 0 || y + dy < 0 || x + dx >= search->width || y + dy >= search->height ||
        divisor(abs(dx), abs(dy)) != 1) {
        return false;
    }
    if (search->parts == 1) {
        return !grid_oracle_is_blocked(&trial.oracle, x + dx, y + dy) &&
               !grid_oracle_is_blocked(&trial.oracle, x + dx, y) && !grid_oracle_is_blocked(&trial.oracle, x, y + dy);
    }
    return grid_oracle_is_line_free(&trial.oracle, place_of(search, x), place_of(search, y), place_of(search, x + dx),
                                    place_of(search, y + dy));
}

static void expand(struct search *search, int node)
{
    const int x = node % search->width;
    const int y = node / search->width;

    for (int dy = -search->reach; dy <= search->reach; dy++) {
        for (int dx = -search->reach; dx <= search->reach; dx++) {
            if (can_step(search, x, y, dx, dy)) {
                oracle_relax(&search->heap, search->costs, node + dy * search->width + dx,
                             search->costs[node] + line_price(place_of(search, x), place_of(search, y),
                                                              place_of(search, x + dx), place_of(search, y + dy)));
            }
        }
    }
}

static double cheapest(int parts, int reach, struct jp_grid_cell start, struct jp_grid_cell goal)
{
    struct search search = {parts, reach, parts * trial.map.width, parts * trial.map.height, NULL, {0}};
    const int from = (start.y * parts + parts / 2) * search.width + start.x * parts + parts / 2;
    const int target = (goal.y * parts + parts / 2) * search.width + goal.x * parts + parts / 2;

    search.costs = unknown_costs((size_t)search.width * (size_t)search.height);
    oracle_relax(&search.heap, search.costs, from, 0);
    while (search.heap.count > 0) {
        const struct heap_entry top = heap_pop(&search.heap);

        if ((int)top.id == target) {
            break;
        }
        if (top.key <= search.costs[top.id]) {
            expand(&search, (int)top.id);
        }
    }
    const double cost = search.costs[target];

    free(search.heap.entries);
    free(search.costs);
    return cost;
}

/* ---- Checks ---- */

static double tolerance(void)
{
    return trial.map.has_elevation ? TOLERANCE_SLOPE : TOLERANCE;
}

static bool is_near(double found, double expected)
{
    return fabs(found - expected) <= tolerance() * expected + (trial.map.has_elevation ? HEIGHTS : 1e-3);
}

static void start_planner(enum jp_grid_method method, size_t more)
{
    const char *field = "";

    trial.config =
        (struct jp_grid_planner_config){.method = method, .tube = (uint8_t)(1 + below(8)), .prices = &trial.prices};
    const size_t size = jp_grid_planner_size(&trial.config, &trial.map);

    TEST_ASSERT_TRUE(size > 0 && size + more <= sizeof trial.block);
    TEST_ASSERT_EQUAL_INT(
        JP_OK, jp_grid_planner_init(&trial.planner, &trial.config, &trial.terrain, trial.block, size + more, &field));
}

static enum jp_grid_answer find(struct jp_grid_cell start, struct jp_grid_cell goal)
{
    const unsigned slice = 1 + below(300);
    enum jp_grid_answer answer = JP_GRID_SEARCHING;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_planner_start(&trial.planner, &start, &goal));
    for (int i = 0; answer == JP_GRID_SEARCHING; i++) {
        TEST_ASSERT_TRUE(i < WORK_MAX);
        answer = jp_grid_planner_work(&trial.planner, slice);
    }
    return answer;
}

static bool draw_cell(struct jp_grid_cell *cell)
{
    for (int tries = 0; tries < 100; tries++) {
        *cell = (struct jp_grid_cell){(int16_t)below(trial.map.width), (int16_t)below(trial.map.height)};
        if (!grid_oracle_is_blocked(&trial.oracle, cell->x, cell->y)) {
            return true;
        }
    }
    return false;
}

/* What the planner says that its way costs, in level cells. */
static double planned_price(struct jp_grid_cell start, struct jp_grid_cell goal)
{
    const double rise = elevation(goal.x, goal.y) - elevation(start.x, start.y);
    const double joules = (double)jp_grid_planner_price(&trial.planner) / 4294967296.0;

    return (joules - rise * trial.prices.rise / 65536) / (trial.prices.metre / 65536.0) /
           (trial.map.resolution / 65536.0);
}

/* Of the way that was found; every line of it is free. */
static double price_of_way(unsigned long number)
{
    const double side = trial.map.resolution;
    size_t points = 0;
    const struct jp_point *way = jp_grid_planner_path(&trial.planner, &points);
    double price = 0;

    for (size_t i = 1; i < points; i++) {
        const double x0 = way[i - 1].x / side;
        const double y0 = way[i - 1].y / side;
        const double x1 = way[i].x / side;
        const double y1 = way[i].y / side;

        price += line_price(x0, y0, x1, y1);
        if (!grid_oracle_is_line_free(&trial.oracle, x0, y0, x1, y1)) {
            report(number, "a line is not free", (double)i, 0);
        }
    }
    return price;
}

static void compare_with_finer(struct jp_grid_cell start, struct jp_grid_cell goal, double price)
{
    const double fine = cheapest(PARTS, 3, start, goal);

    if (fine > 0) {
        counts.fine++;
        counts.fine_sum += price / fine;
        counts.fine_most = fmax(counts.fine_most, price / fine);
    }
}

static void check_task(unsigned long number, bool is_fine)
{
    struct jp_grid_cell start;
    struct jp_grid_cell goal;

    if (!draw_cell(&start) || !draw_cell(&goal)) {
        return;
    }
    const double optimum = cheapest(1, 1, start, goal);

    for (int i = 0; i < 2; i++) {
        start_planner(i == 0 ? JP_GRID_OCTILE : JP_GRID_ANY_ANGLE,
                      sizeof(uint64_t) * below((uint32_t)trial.map.width * trial.map.height));
        const enum jp_grid_answer answer = find(start, goal);

        counts.tasks++;
        counts.full += answer == JP_GRID_OUT_OF_MEMORY;
        counts.unreachable += answer == JP_GRID_UNREACHABLE;
        if (answer != JP_GRID_OUT_OF_MEMORY && (answer == JP_GRID_FOUND) != (bool)isfinite(optimum)) {
            report(number, "answer", answer, isfinite(optimum) ? JP_GRID_FOUND : JP_GRID_UNREACHABLE);
        }
        if (answer != JP_GRID_FOUND) {
            continue;
        }
        const double price = price_of_way(number);
        const double octile = jp_grid_planner_statistics(&trial.planner)->octile_length / 65536.0;

        if (!is_near(octile, optimum)) {
            report(number, "octile optimum", octile, optimum);
        }
        if (!is_near(planned_price(start, goal), price)) {
            report(number, "price of a way", planned_price(start, goal), price);
        }
        if (price > optimum && !is_near(price, optimum)) {
            report(number, "a way costs more than to the eight neighbours", price, optimum);
        }
        /* On hills a line over several cells has fewer grades than its steps. */
        if (i == 0 && !trial.map.has_elevation && !is_near(price, optimum)) {
            report(number, "price of the octile way", price, optimum);
        }
        if (i == 1 && is_fine) {
            compare_with_finer(start, goal, price);
        }
    }
}

static void check_lines(unsigned long number)
{
    const double side = trial.map.resolution;

    for (int i = 0; i < LINES; i++) {
        const struct jp_point a = {(jp_q16)below((uint32_t)(trial.map.width * trial.map.resolution)),
                                   (jp_q16)below((uint32_t)(trial.map.height * trial.map.resolution))};
        const struct jp_point b = {(jp_q16)below((uint32_t)(trial.map.width * trial.map.resolution)),
                                   (jp_q16)below((uint32_t)(trial.map.height * trial.map.resolution))};

        trial.planner.internal.path.points[0] = a;
        trial.planner.internal.path.points[1] = b;
        trial.planner.internal.path.count = 2;
        const double rise = height(b.x / side, b.y / side) - height(a.x / side, a.y / side);
        const double joules =
            (double)jp_grid_planner_price(&trial.planner) / 4294967296.0 - rise * trial.prices.rise / 65536;
        const double found = joules / (trial.prices.metre / 65536.0) / (side / 65536);
        const double expected = line_price(a.x / side, a.y / side, b.x / side, b.y / side);

        counts.lines++;
        if (!is_near(found, expected)) {
            report(number, "price of a line", found, expected);
        }
    }
}

static void test_random_maps(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        begin_random(options.seed, i);
        make_map();
        make_prices();
        make_oracle();
        trial.planner.internal.answer = JP_GRID_NO_TASK;
        for (int k = 0; k < TASKS; k++) {
            check_task(i, i % FINE_EVERY == 0 && k == 0);
        }
        if (trial.planner.internal.answer == JP_GRID_FOUND) {
            check_lines(i);
        }
    }
    if (counts.wrong > 0) {
        TEST_FAIL_MESSAGE(problem);
    }
    TEST_ASSERT_TRUE(counts.unreachable * 2 < counts.tasks);
    TEST_ASSERT_TRUE(counts.full * 50 < counts.tasks);
    TEST_ASSERT_TRUE(counts.fine > options.count / FINE_EVERY / 2);
    TEST_ASSERT_TRUE(counts.fine_most < FINE_MAX);
    TEST_ASSERT_TRUE(counts.fine_sum < FINE_MEAN_MAX * (double)counts.fine);
}

/* After changes of the map, and tasks that are given up, what a new planner finds. */
static void test_changes_of_the_map(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        static uint64_t other_block[CELLS_MAX * 4];
        struct jp_grid_planner other;
        struct jp_grid_cell start;
        struct jp_grid_cell goal;
        const char *field = "";

        begin_random(options.seed, options.count + i);
        make_map();
        make_prices();
        start_planner(JP_GRID_ANY_ANGLE, 0);
        for (int k = 0; k < CHANGES; k++) {
            make_oracle();
            if (!draw_cell(&start) || !draw_cell(&goal)) {
                break;
            }
            (void)jp_grid_planner_start(&trial.planner, &start, &goal);
            (void)jp_grid_planner_work(&trial.planner, below(200));
            const enum jp_grid_answer answer = find(start, goal);

            TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_planner_init(&other, &trial.config, &trial.terrain, other_block,
                                                              jp_grid_planner_size(&trial.config, &trial.map), &field));
            const struct jp_grid_planner first = trial.planner;

            trial.planner = other;
            TEST_ASSERT_EQUAL_INT(answer, find(start, goal));
            TEST_ASSERT_EQUAL_INT32((int32_t)(jp_grid_planner_price(&first) >> 16),
                                    (int32_t)(jp_grid_planner_price(&trial.planner) >> 16));
            trial.planner = first;
            put_block(below(2) == 0 ? JP_CELL_OCCUPIED : JP_CELL_FREE);
        }
    }
}

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", (double)counts.wrong, "", equal_to(0),
                "grid planner by prices: wrong ways, prices or proofs on random grids, of %lu tasks and %lu lines",
                counts.tasks, counts.lines);
    figures_add(figures, "make figures", 100 * (counts.fine_sum / (double)counts.fine - 1), "%", no_bar,
                "grid planner by prices: any-angle ways dearer than over a finer grid in 32 directions, mean of %lu",
                counts.fine);
    figures_add(figures, "make figures", 100 * (counts.fine_most - 1), "%", no_bar,
                "grid planner by prices: any-angle ways dearer than over a finer grid in 32 directions, worst of %lu",
                counts.fine);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);

    const int failures = RUN_PROPERTY(options, add_figures);

    (void)printf(
        "%lu tasks, %lu unreachable, %lu out of memory; over a finer grid %.4f on average, %.4f at most, of %lu\n",
        counts.tasks, counts.unreachable, counts.full, counts.fine_sum / (double)counts.fine, counts.fine_most,
        counts.fine);
    return failures;
}
