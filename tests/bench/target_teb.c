/** Instructions of one jp_teb_plan() of 50 poses among 20 obstacles with the patrol robot's settings, along an aisle of
 *  boxes, between walls of which each pose has four too near, and with boxes all over the way; and the memory for it.
 */
#include <joulepath/patrol.h>
#include <joulepath/tables.h>

#include "src/base/plane.h"
#include "tests/target/cycles.h"
#include "tests/target/figure.h"

#define PERIOD  0.1f  /* of a cycle, s */
#define SPACING 0.22f /* of the path's points, m */

enum { PATH_POINTS = 60, WARM_CYCLES = 20 };

static struct jp_teb teb;
static struct jp_obstacles obstacles;

static struct jp_point path[PATH_POINTS];
static struct jp_teb_task task;
static struct jp_teb_result result;
static enum jp_status status;

/* ---- Scenes ---- */

static jp_q16 q16(float x)
{
    return (jp_q16)(x * (float)JP_Q16_ONE);
}

/* The path bends to both sides by `amplitude`, every 6 m; 0: it is straight. */
static float path_height(float x, float amplitude)
{
    return amplitude * jp_plane_sine(x * (JP_PLANE_PI / 3.0f));
}

static void lay_path(float amplitude)
{
    const float slope = amplitude * (JP_PLANE_PI / 3.0f);
    const float end = SPACING * (float)(PATH_POINTS - 1);

    for (unsigned i = 0; i < PATH_POINTS; i++) {
        const float x = SPACING * (float)i;

        path[i] = (struct jp_point){q16(x), q16(path_height(x, amplitude))};
    }
    task = (struct jp_teb_task){
        .start = {0.0f, 0.0f, jp_plane_bearing(1.0f, slope)},
        .measured = {0.02f, 0.01f, jp_plane_bearing(1.0f, slope)},
        .is_measured = true,
        .goal = {end, path_height(end, amplitude), 0.0f},
        .is_heading_free = true,
        .path = path,
        .path_count = PATH_POINTS,
    };
}

static void add_box(float x, float y, float half_length, float half_width)
{
    const struct jp_obstacle box = {
        .vertices = {{x - half_length, y - half_width},
                     {x + half_length, y - half_width},
                     {x + half_length, y + half_width},
                     {x - half_length, y + half_width}},
        .vertex_count = 4,
    };

    (void)jp_obstacles_add(&obstacles, &box);
}

static void start_scene(float amplitude)
{
    const struct jp_plane_point centre = {0.0f, 0.0f};

    jp_obstacles_clear(&obstacles, &centre);
    lay_path(amplitude);
}

/* Boxes alternate between the sides. */
static void build_aisle(void)
{
    start_scene(0.3f);
    for (unsigned i = 0; i < JP_OBSTACLES_MAX; i++) {
        const float x = 0.65f * (float)i;

        add_box(x, path_height(x, 0.3f) + (i % 2U == 0U ? 0.65f : -0.65f), 0.2f, 0.2f);
    }
}

/* On each side two walls, one behind the other, in five parts. */
static void build_walls(void)
{
    start_scene(0.0f);
    for (unsigned i = 0; i < JP_OBSTACLES_MAX / 4; i++) {
        const float x = 1.0f + 2.6f * (float)i;

        add_box(x, 0.48f, 1.3f, 0.1f);
        add_box(x, 0.49f, 1.3f, 0.1f);
        add_box(x, -0.48f, 1.3f, 0.1f);
        add_box(x, -0.49f, 1.3f, 0.1f);
    }
}

static void build_blocked_way(void)
{
    start_scene(0.0f);
    for (unsigned i = 0; i < JP_OBSTACLES_MAX; i++) {
        add_box(1.0f + 0.6f * (float)i, 0.05f, 0.2f, 0.2f);
    }
}

/* ---- Cycles ---- */

static void plan(void *argument)
{
    (void)argument;
    status = jp_teb_plan(&teb, &task, &obstacles, &result);
}

static uint32_t count_cold(void)
{
    jp_teb_clear(&teb);
    return target_count_once(plan, NULL);
}

/* To where the speed of the last cycle brings the robot until the next. */
static void drive(void)
{
    const struct jp_plane_pose way = {result.speed.forward * PERIOD, 0.0f, result.speed.turn_rate * PERIOD};

    task.start = jp_plane_compose(&result.start, &way);
    task.measured = task.start;
    task.speed = result.speed;
}

static uint32_t count_warm(void)
{
    uint32_t worst = 0;

    for (unsigned i = 0; i < WARM_CYCLES && status == JP_OK; i++) {
        drive();

        const uint32_t instructions = target_count_once(plan, NULL);

        worst = instructions > worst ? instructions : worst;
    }
    return worst;
}

/* ---- Figures ---- */

static void print_work(const char *name, uint32_t instructions)
{
    target_print_figure(name, instructions, "instructions", "5000000");
    target_print(",\n");
}

int main(void)
{
    const char *field = NULL;

    (void)jp_teb_init(&teb, &jp_patrol_config_patrol.teb, &field);
    target_print("[\n");
    build_aisle();
    print_work("TEB cycle, 50 poses, 20 boxes along an aisle, new band", count_cold());
    print_work("TEB cycle, 50 poses, 20 boxes along an aisle, worst of 20 with the last band", count_warm());
    build_walls();
    print_work("TEB cycle, 50 poses between 20 walls, new band", count_cold());
    print_work("TEB cycle, 50 poses between 20 walls, worst of 20 with the last band", count_warm());
    build_blocked_way();
    print_work("TEB cycle, 50 poses, 20 boxes on the way", count_cold());
    target_print_figure("TEB's working memory, 50 poses, 20 obstacles", (uint32_t)(sizeof teb + sizeof obstacles),
                        "bytes", "32768");
    target_print("\n]\n");
    return 0;
}
