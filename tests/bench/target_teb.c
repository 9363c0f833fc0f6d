/** Instructions of one jp_teb_plan() of 50 poses among 20 obstacles with the patrol robot's settings, along an aisle of
 *  boxes, between walls of which each pose has four too near, with boxes all over the way, and at the worst input that
 * a search finds; and the memory for it.
 */
#include <joulepath/patrol.h>
#include <joulepath/tables.h>

#include "src/base/plane.h"
#include "tests/target/cycles.h"
#include "tests/target/figure.h"
#include "tests/target/random.h"

#define PERIOD  0.1f  /* of a cycle, s */
#define SPACING 0.22f /* of the path's points, m */

enum { PATH_POINTS = 60, WARM_CYCLES = 20, DRAWN = 24, CHANGED = 56 };

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

static void add_turned_box(struct jp_plane_point centre, float half_length, float half_width, float angle,
                           struct jp_plane_point velocity)
{
    const float c = jp_plane_cosine(angle);
    const float s = jp_plane_sine(angle);
    const struct jp_plane_point along = {c * half_length, s * half_length};
    const struct jp_plane_point across = {-s * half_width, c * half_width};
    const struct jp_obstacle box = {
        .vertices = {{centre.x - along.x - across.x, centre.y - along.y - across.y},
                     {centre.x + along.x - across.x, centre.y + along.y - across.y},
                     {centre.x + along.x + across.x, centre.y + along.y + across.y},
                     {centre.x - along.x + across.x, centre.y - along.y + across.y}},
        .vertex_count = 4,
        .velocity = velocity,
    };

    (void)jp_obstacles_add(&obstacles, &box);
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

/* ---- A search for the worst ---- */

/* Each 0…1. */
struct drawn_box {
    float along;
    float aside;
    float length;
    float width;
    float angle;
    float speed;
};

/* What is drawn: the bends of the path, the start and the boxes. */
struct input {
    float amplitude;
    float heading;
    float speed;
    float turn_rate;
    struct drawn_box boxes[JP_OBSTACLES_MAX];
};

enum { NUMBERS = sizeof(struct input) / sizeof(float) };

static uint32_t random_state = 1;

/* 0…1 */
static float draw(void)
{
    return (float)(target_random(&random_state) >> 8) * 0x1p-24f;
}

static uint32_t draw_below(uint32_t count)
{
    return target_random(&random_state) % count;
}

/* Every second one is a pile: all boxes have the same place beside the way. */
static void draw_input(struct input *input)
{
    float *const numbers = &input->amplitude;
    const bool is_pile = draw() < 0.5f;

    for (unsigned i = 0; i < NUMBERS; i++) {
        numbers[i] = draw();
    }
    for (unsigned i = 1; i < JP_OBSTACLES_MAX && is_pile; i++) {
        const float along = input->boxes[i].along;

        input->boxes[i] = input->boxes[0];
        input->boxes[i].along = along;
    }
}

/* Some numbers anew, and now and then a box where another one is. */
static void change_input(struct input *input)
{
    float *const numbers = &input->amplitude;

    for (uint32_t i = draw_below(6); i < 6U; i++) {
        numbers[draw_below(NUMBERS)] = draw();
    }
    if (draw_below(4) == 0U) {
        input->boxes[draw_below(JP_OBSTACLES_MAX)] = input->boxes[draw_below(JP_OBSTACLES_MAX)];
    }
}

static void build_input(const struct input *input)
{
    const float amplitude = 0.6f * input->amplitude;

    start_scene(amplitude);
    task.start.heading = 2.0f * input->heading - 1.0f;
    task.measured.heading = task.start.heading;
    task.speed = (struct jp_plane_speed){1.5f * input->speed, 2.0f * input->turn_rate - 1.0f};
    for (unsigned i = 0; i < JP_OBSTACLES_MAX; i++) {
        const struct drawn_box *const box = &input->boxes[i];
        const float x = 1.1f * task.goal.x * box->along;
        const float speed = box->speed > 0.7f ? 2.0f * (box->speed - 0.85f) : 0.0f;

        add_turned_box((struct jp_plane_point){x, path_height(x, amplitude) + 2.4f * (box->aside - 0.5f)},
                       0.02f + 4.0f * box->length * box->length, 0.02f + 0.5f * box->width, 3.0f * (box->angle - 0.5f),
                       (struct jp_plane_point){0.0f, speed});
    }
}

/* The worst of some that are drawn, and of changes to the worst so far. */
static uint32_t search_worst(void)
{
    static struct input worst_input;
    static struct input input;
    uint32_t worst = 0;

    for (unsigned i = 0; i < DRAWN + CHANGED; i++) {
        input = worst_input;
        if (i < DRAWN) {
            draw_input(&input);
        } else {
            change_input(&input);
        }
        build_input(&input);

        const uint32_t instructions = count_cold();

        if (instructions > worst) {
            worst = instructions;
            worst_input = input;
        }
    }
    return worst;
}

/* ---- Figures ---- */

static void print_work(const char *name, uint32_t instructions)
{
    target_print_figure(name, instructions, "instructions", "3000000");
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
    print_work("TEB cycle, 50 poses, 20 boxes, worst of 80 inputs of a search", search_worst());
    target_print_figure("TEB's working memory, 50 poses, 20 obstacles", (uint32_t)(sizeof teb + sizeof obstacles),
                        "bytes", "32768");
    target_print("\n]\n");
    return 0;
}
