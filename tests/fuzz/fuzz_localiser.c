/**
 * The localiser on small maps that the input draws, with any configuration that it accepts, on scans and odometry of
 * any numbers: poses and deviations stay finite, and the search of a lost robot ends.
 */
#include <joulepath/localiser.h>
#include <joulepath/tables.h>
#include <math.h>

#include "tests/fuzz/fuzz_plane.h"

#define SIDE  32U
#define BEAMS 90U

static struct jp_localiser localiser;
static struct jp_localiser_config config;
static struct jp_terrain map;
static uint64_t map_block[1024];
static uint64_t block[65536 / sizeof(uint64_t)];
static float ranges[BEAMS];

static bool start(struct fuzz_input *input)
{
    const struct jp_terrain_config terrain = {.width = (uint16_t)(1U + fuzz_below(input, SIDE)),
                                              .height = (uint16_t)(1U + fuzz_below(input, SIDE)),
                                              .resolution =
                                                  fuzz_bool(input) ? JP_Q16(0.2) : fuzz_range(input, 1, JP_Q16(8))};
    const struct jp_plane_pose pose = fuzz_pose(input, 4.0f);
    const char *field = NULL;

    fuzz_require(jp_terrain_init(&map, &terrain, map_block, sizeof map_block, &field) == JP_OK, "a small map");
    for (unsigned left = fuzz_u8(input); left > 0U; left--) {
        (void)jp_terrain_set_cell(&map, (int32_t)fuzz_below(input, terrain.width),
                                  (int32_t)fuzz_below(input, terrain.height), (enum jp_cell)fuzz_below(input, 3));
    }
    config = jp_localiser_config_patrol;
    config.map = &map;
    FUZZ_CHANGE_FROM(input, config, beams_max);

    const enum jp_status status = jp_localiser_init(&localiser, &config, block, sizeof block, &field);

    fuzz_require(status == JP_OK || status == JP_ERR_MEMORY ||
                     (status == JP_ERR_CONFIG && field != NULL && field[0] != '\0'),
                 "a status of the localiser");
    if (status != JP_OK) {
        return false;
    }
    (void)jp_localiser_start(&localiser, fuzz_bool(input) ? &pose : NULL);
    return true;
}

static void draw_scan(struct fuzz_input *input, struct jp_scan *scan)
{
    const float everywhere = fuzz_float(input, 8.0f);

    for (unsigned i = 0; i < BEAMS; i++) {
        ranges[i] = everywhere;
    }
    for (unsigned left = fuzz_below(input, 12); left > 0U; left--) {
        const float range = fuzz_float(input, 6.0f);
        const uint32_t from = fuzz_below(input, BEAMS);
        const uint32_t count = fuzz_below(input, 24);

        for (uint32_t i = from; i < from + count && i < BEAMS; i++) {
            ranges[i] = range;
        }
    }
    *scan = (struct jp_scan){.ranges = fuzz_below(input, 8) == 7U ? NULL : ranges,
                             .count = (uint16_t)(fuzz_below(input, 16) == 15U ? fuzz_below(input, BEAMS + 1U) : BEAMS),
                             .first_angle = -3.1f,
                             .angle_step = 0.068f};
    if (fuzz_below(input, 16) == 15U) {
        scan->first_angle = fuzz_float(input, 7.0f);
        scan->angle_step = fuzz_float(input, 0.1f);
    }
}

static void check_localiser(void)
{
    fuzz_require(isfinite(localiser.pose.x) && isfinite(localiser.pose.y) && isfinite(localiser.pose.heading),
                 "a pose that is none");
    fuzz_require(localiser.position_deviation >= 0.0f && localiser.heading_deviation >= 0.0f,
                 "a deviation that is none");
    for (unsigned i = 0; i < 3U; i++) {
        fuzz_require(localiser.covariance[i][i] >= 0.0f, "a variance that is none");
    }
    fuzz_require(localiser.reason <= JP_LOCALISER_NOWHERE, "a reason that is none");
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct jp_localiser_input seen = {.wheels = {0.0f, 0.0f, 0.0f}};

    if (!start(&input)) {
        return 0;
    }
    draw_scan(&input, &seen.scan);
    for (unsigned left = 24; left > 0U && fuzz_more(&input); left--) {
        seen.wheels.x += fuzz_float(&input, 0.1f);
        seen.wheels.heading += fuzz_float(&input, 0.1f);
        if (fuzz_below(&input, 16) == 15U) {
            seen.wheels = fuzz_pose(&input, 8.0f);
            seen.sensor = fuzz_pose(&input, 0.5f);
        }
        if (fuzz_bool(&input)) {
            draw_scan(&input, &seen.scan);
        }
        (void)jp_localiser_update(&localiser, &seen);
        check_localiser();
        for (unsigned slices = 64; slices > 0U && jp_localiser_work(&localiser, 16); slices--) {
            check_localiser();
        }
    }
    return 0;
}
