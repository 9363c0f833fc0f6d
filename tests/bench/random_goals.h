/** Random goals for the patrol robot on maps of others, among boxes that stand there besides, by the seed of a drive:
 *  boxes of 0.3 to 0.8 m at random places and headings, one for each 30 m² of free ground. Start and goal are drawn
 * from the places where the robot can turn with 5 cm to spare on the ground with its boxes. A goal can be reached when
 * a disc 0.2 m wider than the robot gets from the start to it. */
#ifndef JOULEPATH_TESTS_BENCH_RANDOM_GOALS_H
#define JOULEPATH_TESTS_BENCH_RANDOM_GOALS_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/error.h"
#include "sim/base/random.h"
#include "sim/four_wheel/four_wheel_file.h"
#include "sim/scenes/patrol_scene.h"

#define BOX_MIN           0.3 /* m */
#define BOX_MAX           0.8
#define BOX_GROUND        30.0 /* m² */
#define TURN_SPARE        0.05 /* m */
#define WAY_SPARE         0.1
#define SECONDS_MIN       120.0 /* and so many for each metre between start and goal */
#define SECONDS_PER_METRE 10.0

enum { GOAL_TRIES_MAX = 100000 };

/* ---- The ground ---- */

struct ground {
    struct jp_terrain *terrain;
    int width;
    int height;
    double cell;
    float *away; /* of each cell's middle from what is solid, m */
    int *queue;
    bool *is_reached;
};

static inline bool is_solid(const struct ground *ground, int x, int y)
{
    return x < 0 || y < 0 || x >= ground->width || y >= ground->height ||
           jp_terrain_cell(ground->terrain, x, y) != JP_CELL_FREE;
}

static inline void hide_box(struct ground *ground, struct random *random)
{
    const double half_length = random_uniform(random, BOX_MIN, BOX_MAX) / 2;
    const double half_width = random_uniform(random, BOX_MIN, BOX_MAX) / 2;
    const double heading = random_uniform(random, -M_PI, M_PI);
    const double x = random_uniform(random, 0, ground->width * ground->cell);
    const double y = random_uniform(random, 0, ground->height * ground->cell);
    const int reach = (int)(BOX_MAX / ground->cell) + 1;

    for (int v = (int)(y / ground->cell) - reach; v <= (int)(y / ground->cell) + reach; v++) {
        for (int u = (int)(x / ground->cell) - reach; u <= (int)(x / ground->cell) + reach; u++) {
            const double dx = (u + 0.5) * ground->cell - x;
            const double dy = (v + 0.5) * ground->cell - y;

            if (fabs(cos(heading) * dx + sin(heading) * dy) <= half_length &&
                fabs(cos(heading) * dy - sin(heading) * dx) <= half_width) {
                (void)jp_terrain_set_cell(ground->terrain, u, v, JP_CELL_OCCUPIED); /* off the map nothing is set */
            }
        }
    }
}

static inline void hide_boxes(struct ground *ground, struct random *random)
{
    double free = 0;

    for (int i = 0; i < ground->width * ground->height; i++) {
        free += !is_solid(ground, i % ground->width, i / ground->width);
    }
    for (double left = free * ground->cell * ground->cell; left > BOX_GROUND; left -= BOX_GROUND) {
        hide_box(ground, random);
    }
}

/* Up to some cells; what is farther counts as that. */
static inline void measure(struct ground *ground, int most)
{
    for (int i = 0; i < ground->width * ground->height; i++) {
        const int x = i % ground->width;
        const int y = i / ground->width;
        double least = most;

        for (int dy = -most; dy <= most; dy++) {
            for (int dx = 0; dx <= most && hypot(fmax(dx - 0.5, 0), fmax(abs(dy) - 0.5, 0)) < least; dx++) {
                if (is_solid(ground, x + dx, y + dy) || is_solid(ground, x - dx, y + dy)) {
                    least = hypot(fmax(dx - 0.5, 0), fmax(abs(dy) - 0.5, 0));
                }
            }
        }
        ground->away[i] = (float)(least * ground->cell);
    }
}

/* All cells that a disc gets to from one, over their sides. */
static inline void flood(struct ground *ground, int from, double radius)
{
    static const int steps[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    int head = 0;
    int tail = 0;

    memset(ground->is_reached, 0, (size_t)ground->width * (size_t)ground->height * sizeof *ground->is_reached);
    ground->is_reached[from] = true;
    ground->queue[tail++] = from;
    while (head < tail) {
        const int at = ground->queue[head++];

        for (int i = 0; i < 4; i++) {
            const int x = at % ground->width + steps[i][0];
            const int y = at / ground->width + steps[i][1];
            const int next = y * ground->width + x;

            if (!is_solid(ground, x, y) && !ground->is_reached[next] && (double)ground->away[next] >= radius) {
                ground->is_reached[next] = true;
                ground->queue[tail++] = next;
            }
        }
    }
}

/* ---- A task ---- */

/* A cell where the robot can turn; −1: none was found. */
static inline int draw_place(const struct ground *ground, struct random *random, double radius)
{
    for (int i = 0; i < GOAL_TRIES_MAX; i++) {
        const int cell = (int)random_uniform(random, 0, (double)ground->width * ground->height);

        if ((double)ground->away[cell] >= radius) {
            return cell;
        }
    }
    return -1;
}

static inline struct jp_plane_pose pose_in(const struct ground *ground, int cell, struct random *random)
{
    return (struct jp_plane_pose){(float)((cell % ground->width + 0.5) * ground->cell),
                                  (float)((cell / ground->width + 0.5) * ground->cell),
                                  (float)random_uniform(random, -M_PI, M_PI)};
}

static inline void *allocate(size_t size)
{
    void *const memory = malloc(size);

    if (memory == NULL) {
        abort();
    }
    return memory;
}

/* The ground becomes a copy of the map, with boxes. False: there is no room for start and goal. */
static inline bool make_task(const struct four_wheel_file *robot, struct patrol_scene *scene, void *copy, uint64_t seed,
                             bool *is_reachable)
{
    const size_t cells = (size_t)scene->map.config.width * scene->map.config.height;
    struct ground ground = {.terrain = &scene->ground,
                            .width = scene->map.config.width,
                            .height = scene->map.config.height,
                            .cell = (double)scene->map.config.resolution / JP_Q16_ONE,
                            .away = allocate(cells * sizeof(float)),
                            .queue = allocate(cells * sizeof(int)),
                            .is_reached = allocate(cells * sizeof(bool))};
    const double turn = hypot(robot->body.length_m, robot->body.width_m) / 2 + TURN_SPARE;
    const char *field;
    struct random random;

    random_init(&random, seed);
    if (jp_terrain_init(&scene->ground, &scene->map.config, copy, jp_terrain_size(&scene->map.config), &field) !=
        JP_OK) {
        abort();
    }
    for (size_t i = 0; i < cells; i++) {
        const int32_t x = (int32_t)i % ground.width;
        const int32_t y = (int32_t)i / ground.width;

        (void)jp_terrain_set_cell(&scene->ground, x, y, jp_terrain_cell(&scene->map, x, y));
    }
    hide_boxes(&ground, &random);
    measure(&ground, (int)(turn / ground.cell) + 2);

    const int start = draw_place(&ground, &random, turn);
    const int goal = draw_place(&ground, &random, turn);

    if (start >= 0 && goal >= 0) {
        flood(&ground, start, robot->body.width_m / 2 + WAY_SPARE);
        *is_reachable = ground.is_reached[goal];
        scene->start = pose_in(&ground, start, &random);
        scene->goal = pose_in(&ground, goal, &random);
    }
    free(ground.away);
    free(ground.queue);
    free(ground.is_reached);
    return start >= 0 && goal >= 0;
}

/* s */
static inline double limit_of(const struct patrol_scene *scene)
{
    return SECONDS_MIN + SECONDS_PER_METRE *
                             hypot((double)(scene->goal.x - scene->start.x), (double)(scene->goal.y - scene->start.y));
}

#endif
