/**
 * The any-angle planner and the spline on small maps that the input draws and changes: paths and splines lead from
 * start to goal over lines that are free, and all methods agree on whether there is a way.
 */
#include <joulepath/grid_planner.h>
#include <joulepath/path_spline.h>
#include <joulepath/pure_pursuit.h>
#include <joulepath/tables.h>

#include "tests/fuzz/fuzz_input.h"

#define SIDE_MAX 32U
#define ROOM     (96U * 1024U)
#define POINTS   512U

static struct jp_terrain terrain;
static struct jp_grid_planner planner;
static struct jp_grid_planner_config config;
static struct jp_grid_prices prices;
static uint64_t map_block[2048];
static uint64_t block[ROOM / sizeof(uint64_t)];
static uint64_t scratch[8192];
static struct jp_point smooth[POINTS];

static void draw_map(struct fuzz_input *input)
{
    const struct jp_terrain_config map = {.width = (uint16_t)(1U + fuzz_below(input, SIDE_MAX)),
                                          .height = (uint16_t)(1U + fuzz_below(input, SIDE_MAX)),
                                          .resolution =
                                              fuzz_bool(input) ? JP_Q16(0.05) : fuzz_range(input, 1, JP_Q16(2)),
                                          .has_elevation = fuzz_below(input, 4) == 0U,
                                          .unknown_is_free = fuzz_below(input, 8) != 0U};
    const char *field = NULL;

    fuzz_require(jp_terrain_init(&terrain, &map, map_block, sizeof map_block, &field) == JP_OK, "a small map");
}

static void edit(struct fuzz_input *input)
{
    const int32_t x = (int32_t)fuzz_below(input, SIDE_MAX);
    const int32_t y = (int32_t)fuzz_below(input, SIDE_MAX);

    (void)jp_terrain_set_cell(&terrain, x, y, fuzz_below(input, 4) == 0U ? JP_CELL_FREE : JP_CELL_OCCUPIED);
    if (terrain.config.has_elevation) {
        (void)jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)fuzz_u32(input));
    }
}

/* Of a model that passes its check, or anything. */
static void choose_prices(struct fuzz_input *input)
{
    struct jp_four_wheel_energy_model model = jp_four_wheel_energy_patrol;
    const char *field = NULL;

    FUZZ_CHANGE(input, model);
    prices = (struct jp_grid_prices){.metre = 0};
    if (jp_four_wheel_energy_check(&model, &field) == JP_OK) {
        const enum jp_status status =
            jp_grid_prices_set(&model, fuzz_range(input, -1, JP_Q24(9)), fuzz_range(input, -1, JP_Q16(1025)), &prices);

        fuzz_require((status == JP_OK) == (prices.ring != 0), "prices that were not set");
    }
    for (unsigned i = 0; i < JP_GRID_RINGS; i++) {
        prices.near[i] = fuzz_range(input, 0, INT32_MAX);
    }
    prices.ring = fuzz_range(input, 1, JP_Q16(4));
    if (fuzz_below(input, 8) == 0U) {
        FUZZ_CHANGE(input, prices);
    }
    config.prices = &prices;
}

static bool start(struct fuzz_input *input)
{
    const char *field = NULL;
    const size_t least = jp_grid_planner_size(&config, &terrain.config);
    const enum jp_status status = jp_grid_planner_init(
        &planner, &config, &terrain, block, fuzz_bool(input) || least > sizeof block ? sizeof block : least, &field);

    fuzz_require(status == JP_ERR_CONFIG || least != 0U, "a size of what is out of range");
    fuzz_require(status != JP_ERR_CONFIG || least == 0U || config.prices != NULL, "a size of what is in range");
    fuzz_require(status == JP_OK || status == JP_ERR_MEMORY ||
                     (status == JP_ERR_CONFIG && field != NULL && field[0] != '\0'),
                 "a status of the planner");
    return status == JP_OK;
}

static struct jp_point middle(const struct jp_grid_cell *cell)
{
    const jp_q16 side = jp_grid_planner_resolution(&planner);

    return (struct jp_point){cell->x * side + side / 2, cell->y * side + side / 2};
}

static void check_line(const struct jp_point *points, size_t count)
{
    for (size_t i = 1; i < count; i++) {
        fuzz_require(jp_grid_planner_line_is_free(&planner, &points[i - 1U], &points[i]), "a line that is not free");
    }
}

static void follow(struct fuzz_input *input, const struct jp_point *points, size_t count)
{
    struct jp_pure_pursuit_config tracking = jp_pure_pursuit_config_patrol;
    struct jp_pure_pursuit tracker;
    const char *field = NULL;

    FUZZ_CHANGE(input, tracking);
    if (jp_pure_pursuit_init(&tracker, &tracking, &field) != JP_OK ||
        jp_pure_pursuit_follow(&tracker, points, count) != JP_OK) {
        return;
    }
    for (unsigned left = 64; left > 0U && fuzz_more(input); left--) {
        const struct jp_point position = fuzz_bool(input)
                                             ? (struct jp_point){(int32_t)fuzz_u32(input), (int32_t)fuzz_u32(input)}
                                             : points[fuzz_below(input, (uint32_t)count)];
        struct jp_twist twist;
        const enum jp_status status =
            jp_pure_pursuit_tick(&tracker, &position, fuzz_u32(input), fuzz_range(input, -JP_Q24(16), JP_Q24(16)),
                                 fuzz_range(input, 1, JP_Q24_ONE), &twist);

        fuzz_require(status == JP_OK || (twist.x == 0 && twist.y == 0 && twist.turn_rate == 0),
                     "a twist without a way");
        fuzz_require(twist.x >= -JP_Q24(17) && twist.x <= JP_Q24(17), "a speed beyond the limits");
    }
}

static void smoothen(struct fuzz_input *input, const struct jp_point *path, size_t count)
{
    size_t found = 0;
    const size_t room = fuzz_bool(input) ? sizeof scratch : fuzz_below(input, sizeof scratch);
    const enum jp_status status =
        jp_path_spline(&planner, path, count, fuzz_range(input, 256, JP_Q16(1)), scratch, room, smooth, POINTS, &found);

    fuzz_require((status == JP_OK) == (found != 0U) && found <= POINTS, "points of a spline");
    if (status == JP_OK) {
        fuzz_require(smooth[0].x == path[0].x && smooth[0].y == path[0].y &&
                         smooth[found - 1U].x == path[count - 1U].x && smooth[found - 1U].y == path[count - 1U].y,
                     "a spline that begins or ends elsewhere");
        check_line(smooth, found);
        follow(input, smooth, found);
    }
}

static enum jp_grid_answer search(struct fuzz_input *input)
{
    enum jp_grid_answer answer = JP_GRID_SEARCHING;

    for (unsigned left = 20000; left > 0U && answer == JP_GRID_SEARCHING; left--) {
        answer = jp_grid_planner_work(&planner, 1U + fuzz_below(input, 64));
        if (answer == JP_GRID_SEARCHING && fuzz_below(input, 256) == 255U) {
            edit(input);
        }
    }
    fuzz_require(answer != JP_GRID_SEARCHING, "a search without an end");
    return answer;
}

static void find(struct fuzz_input *input)
{
    const struct jp_grid_cell from = {(int16_t)fuzz_below(input, SIDE_MAX), (int16_t)fuzz_below(input, SIDE_MAX)};
    const struct jp_grid_cell to = {(int16_t)fuzz_below(input, SIDE_MAX), (int16_t)fuzz_below(input, SIDE_MAX)};
    size_t count = 0;

    if (jp_grid_planner_start(&planner, &from, &to) != JP_OK || search(input) != JP_GRID_FOUND) {
        return;
    }

    const struct jp_point *path = jp_grid_planner_path(&planner, &count);
    const struct jp_point first = middle(&from);
    const struct jp_point last = middle(&to);

    fuzz_require(path != NULL && count >= 1U, "a path without points");
    fuzz_require(jp_grid_planner_statistics(&planner)->bytes <= sizeof block, "more memory than there is");
    fuzz_require(config.prices != NULL || jp_grid_planner_price(&planner) == 0, "a price without prices");
    fuzz_require(config.prices == NULL || terrain.config.has_elevation || count == 1U ||
                     jp_grid_planner_price(&planner) > 0,
                 "a way that costs nothing");
    fuzz_require(path[0].x - first.x <= 2 && first.x - path[0].x <= 2 && path[count - 1U].y - last.y <= 2 &&
                     last.y - path[count - 1U].y <= 2,
                 "a path that begins or ends elsewhere");
    check_line(path, count);
    if (count >= 2U) {
        smoothen(input, path, count);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};

    draw_map(&input);
    config =
        (struct jp_grid_planner_config){.method = (enum jp_grid_method)fuzz_below(&input, JP_GRID_ANY_ANGLE + 1U),
                                        .clearance = (jp_q16)fuzz_below(&input, 256) * (terrain.config.resolution / 64),
                                        .tube = (uint8_t)(1U + fuzz_below(&input, 4))};
    if (fuzz_below(&input, 8) == 7U) {
        config.clearance = fuzz_hostile(&input);
        config.tube = fuzz_u8(&input);
    }
    for (unsigned left = fuzz_u8(&input); left > 0U; left--) {
        edit(&input);
    }
    if (fuzz_bool(&input)) {
        choose_prices(&input);
    }
    if (!start(&input)) {
        return 0;
    }
    for (unsigned left = 6; left > 0U && fuzz_more(&input); left--) {
        find(&input);
    }
    return 0;
}
