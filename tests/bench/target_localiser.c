/** Instructions of an update of the localiser by a scan of 360 beams, the worst over random poses, odometry and people:
 * of a robot that knows its place, and of one that does not; and of a thousand nodes of its search. In a room of
 * 10 m × 8 m in cells of 5 cm. */
#include <joulepath/localiser.h>

#include "src/base/plane.h"
#include "tests/bench/target_room.h"
#include "tests/target/cycles.h"
#include "tests/target/figure.h"
#include "tests/target/random.h"

#define CELL  0.05f /* m */
#define RANGE 8.0f  /* m */

enum { BEAMS = 360, POSES = 40, SEARCHES = 8, NODES = 1000 };

static struct jp_localiser_config config;
static struct jp_localiser localiser;
static uint64_t block[(WIDTH * HEIGHT + HEIGHT + 8 * JP_LOCALISER_POINTS_MAX) / 8 + 2];
static struct jp_localiser_input input;
static float ranges[BEAMS];
static struct jp_plane_pose robot; /* true */
static enum jp_status status;
static uint32_t random_state = 1;

/* −1…1 */
static float draw(void)
{
    return (float)(target_random(&random_state) >> 8) * 0x1p-23f - 1.0f;
}

/* ---- The room ---- */

static float ray(struct jp_plane_point along)
{
    float way = 0.0f;

    while (way < RANGE) {
        const int32_t x = (int32_t)((robot.x + way * along.x) * (1.0f / CELL));
        const int32_t y = (int32_t)((robot.y + way * along.y) * (1.0f / CELL));

        if (jp_terrain_cell(&target_map, x, y) == JP_CELL_OCCUPIED) {
            return way;
        }
        way += 0.4f * CELL;
    }
    return 0.0f;
}

/* Up to a third of the beams end at people. */
static void take_scan(void)
{
    const int hidden = (int)(60.0f * (1.0f + draw()));

    input.scan = (struct jp_scan){ranges, BEAMS, -JP_PLANE_PI, 2.0f * JP_PLANE_PI / BEAMS};
    for (int i = 0; i < BEAMS; i++) {
        const struct jp_plane_point along =
            jp_plane_direction(robot.heading + input.scan.first_angle + (float)i * input.scan.angle_step);
        const float range = ray(along);

        ranges[i] = i < hidden && range > 0.6f ? 0.6f : range;
    }
}

/* ---- What is counted ---- */

static void update(void *unused)
{
    (void)unused;
    status = jp_localiser_update(&localiser, &input);
}

static void search(void *unused)
{
    (void)unused;
    (void)jp_localiser_work(&localiser, NODES);
}

static void draw_pose(void)
{
    do {
        robot = (struct jp_plane_pose){5.0f + 4.5f * draw(), 4.0f + 3.5f * draw(), JP_PLANE_PI * draw()};
    } while (jp_terrain_cell(&target_map, (int32_t)(robot.x / CELL), (int32_t)(robot.y / CELL)) == JP_CELL_OCCUPIED);
    take_scan();
}

/* One that believes to be off by so much, with such standard deviations. */
static uint32_t worst_update(float off, float turned)
{
    uint32_t worst = 0;

    localiser.config.start_distance = off;
    localiser.config.start_turn = turned;
    for (unsigned i = 0; i < POSES && status == JP_OK; i++) {
        draw_pose();

        const struct jp_plane_pose start = {robot.x + off * draw(), robot.y + off * draw(),
                                            robot.heading + turned * draw()};

        (void)jp_localiser_start(&localiser, &start);

        const uint32_t instructions = target_count_once(update, NULL);

        worst = instructions > worst ? instructions : worst;
    }
    return worst;
}

static uint32_t worst_search(void)
{
    uint32_t worst = 0;

    for (unsigned i = 0; i < SEARCHES && status == JP_OK; i++) {
        draw_pose();
        (void)jp_localiser_start(&localiser, NULL);
        update(NULL);

        const uint32_t instructions = target_count_once(search, NULL);

        worst = instructions > worst ? instructions : worst;
    }
    return worst;
}

int main(void)
{
    const char *field;

    config = (struct jp_localiser_config){.map = &target_map,
                                          .range_max = RANGE,
                                          .noise = 0.01f,
                                          .wheels = {0.1f, 0.1f, 0.02f},
                                          .start_distance = 0.1f,
                                          .start_turn = 0.05f,
                                          .lost_distance = 1.0f,
                                          .lost_turn = 0.4f};
    status = target_room_make(80);
    if (status != JP_OK || jp_localiser_init(&localiser, &config, block, sizeof block, &field) != JP_OK) {
        target_print("the room of the bench is no map\n");
        return 1;
    }

    const uint32_t tracking = worst_update(0.03f, 0.02f);
    const uint32_t uncertain = worst_update(0.5f, 0.2f);
    const uint32_t nodes = worst_search();

    if (status != JP_OK) {
        target_print("a scan of the bench cannot be taken\n");
        return 1;
    }
    target_print("[\n");
    target_print_figure("localiser, scan of 360 beams, worst of 40 near the true pose", tracking, "instructions", NULL);
    target_print(",\n");
    target_print_figure("localiser, scan of 360 beams, worst of 40 up to 0.5 m and 11° off", uncertain, "instructions",
                        NULL);
    target_print(",\n");
    target_print_figure("localiser, 1000 nodes of a search, worst of 8", nodes, "instructions", NULL);
    target_print("\n]\n");
    return 0;
}
