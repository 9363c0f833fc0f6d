/* The planner in the memory that the firmware's image has for it, on the 20 scenes cut to the image's map: 192 × 192
 * cells of the robot's lattice, from corner to corner. Prints figures as JSON. */
#include <joulepath/planner.h>
#include <joulepath/tables.h>

#include "hal/app/navigation_memory.h"
#include "tests/bench/figures.h"
#include "tests/bench/statistics.h"
#include "tests/support/scene.h"

#define COMMAND "make bench-image"

#define AMPLE ((size_t)64 << 20)
#define SLICE 10000

enum { SIDE = JP_NAVIGATION_SIDE, CUTS = SCENE_BENCH_COUNT, SEEDS_MAX = 200 };

static const struct jp_lattice *const lattice = &jp_lattice_courier24;

static uint64_t scene_block[(SCENE_TERRAIN_SIZE + 7) / 8];
static uint64_t map_block[2 * ((SIDE + 31) / 32) * SIDE / 2 + 1];
static struct jp_terrain map;
static struct jp_planner planner;
static struct jp_navigation_block small;

/** The south-western cells of a scene, level. */
static void cut(uint32_t seed)
{
    const struct jp_terrain_config config = {
        .width = SIDE, .height = SIDE, .resolution = lattice->resolution, .unknown_is_free = true};
    struct jp_terrain scene;
    struct scene_task task;
    const char *field;

    (void)jp_terrain_init(&scene, &scene_terrain_config, scene_block, sizeof scene_block, &field);
    scene_generate(seed, &scene, &task);
    (void)jp_terrain_init(&map, &config, map_block, sizeof map_block, &field);
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        (void)jp_terrain_set_cell(&map, i % SIDE, i / SIDE, jp_terrain_cell(&scene, i % SIDE, i / SIDE));
    }
}

/** The cell on which the robot can stand that is nearest to a corner, along the diagonal and beside it. */
static bool find_place(bool is_far, int16_t *x, int16_t *y)
{
    for (int32_t sum = 0; sum < SIDE; sum++) {
        for (int32_t i = 0; i <= sum; i++) {
            const int32_t u = is_far ? SIDE - 1 - i : i;
            const int32_t v = is_far ? SIDE - 1 - (sum - i) : sum - i;

            if (jp_lattice_can_stand(lattice, &map, u, v, 0)) {
                *x = (int16_t)u;
                *y = (int16_t)v;
                return true;
            }
        }
    }
    return false;
}

/** Cost of the route that is there when the planner has done what it can; 0: there is none. */
static jp_cost plan(void *block, size_t size, const struct jp_lattice_pose *start, const struct jp_goal *goal)
{
    const struct jp_planner_config config = {lattice, JP_COST_PHYSICAL, JP_NAVIGATION_EPSILON};
    const char *field;
    enum jp_answer answer = JP_ANSWER_OUT_OF_BUDGET;

    if (jp_planner_init(&planner, &config, &map, block, size, &field) != JP_OK ||
        jp_planner_set_start(&planner, start) != JP_OK || jp_planner_set_goal(&planner, goal) != JP_OK) {
        return 0;
    }
    do {
        answer = jp_planner_work(&planner, SLICE);
    } while (!jp_planner_is_idle(&planner));
    return answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_WITHIN_BOUND ? jp_planner_plan(&planner)->cost : 0;
}

static void add(json_t *figures, const char *what, double value, const char *unit, struct figure_bar bar)
{
    figures_add(figures, COMMAND, value, unit, bar, "%d scenes cut to %d × %d cells, planner of %d KiB: %s", (int)CUTS,
                (int)SIDE, (int)SIDE, (int)(sizeof small / 1024), what);
}

int main(void)
{
    void *ample = aligned_alloc(8, AMPLE);
    json_t *figures = json_array();
    double ratios[CUTS];
    size_t cuts = 0;
    size_t found = 0;

    for (uint32_t seed = SCENE_BENCH_FIRST; ample != NULL && cuts < CUTS && seed < SEEDS_MAX; seed++) {
        struct jp_lattice_pose start = {.heading = 0};
        struct jp_goal goal = {.headings = JP_ANY_HEADING};

        cut(seed);
        if (!find_place(false, &start.x, &start.y) || !find_place(true, &goal.x, &goal.y)) {
            continue;
        }
        const jp_cost best = plan(ample, AMPLE, &start, &goal);
        const jp_cost cost = best > 0 ? plan(small.words, sizeof small, &start, &goal) : 0;

        cuts += best > 0;
        if (cost > 0) {
            ratios[found] = (double)cost / best;
            found++;
        }
    }
    free(ample);
    const double middle = median(ratios, found);

    add(figures, "routes", (double)found, "", equal_to(CUTS));
    add(figures, "cost over the optimum's, median", middle, "", at_most(1.1));
    add(figures, "cost over the optimum's, most", found > 0 ? ratios[found - 1] : 0, "", no_bar);
    figures_print(figures);
    return 0;
}
