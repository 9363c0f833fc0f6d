/** Plans with their times, and the scenes that they are on, for the bench of the planner. */
#ifndef JOULEPATH_TESTS_BENCH_PLAN_RUNS_H
#define JOULEPATH_TESTS_BENCH_PLAN_RUNS_H

#include <joulepath/planner.h>
#include <joulepath/tables.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "sim/base/random.h"
#include "tests/support/scene.h"

static const struct jp_lattice *const lattice = &jp_lattice_zhang2018;

#define COMMAND "make bench-plan"
#define KIB     ((size_t)1024)

/* Costs of a route by the tables and in double precision agree but for the rounding of every edge. */
#define ROUNDING_TOLERANCE 0.01

/* The schedule of the example in src/search/README.md. */
#define SCHEDULE                                                                                                       \
    {                                                                                                                  \
        JP_EPSILON(1.35), JP_EPSILON(1.2), JP_EPSILON(1.1), JP_EPSILON_ONE                                             \
    }

enum {
    SLICE = 32,       /* expansions */
    SQUARE_SIDE = 3,  /* cells that change together */
    FULL_KIB = 24576, /* holds every search to the optimum */
};

struct task {
    const char *name;
    struct jp_terrain *terrain;
    struct jp_lattice_pose start;
    struct jp_goal goal;
};

/* One plan, from nothing until the planner is idle. */
struct outcome {
    struct jp_plan plan;
    enum jp_answer answer;
    struct jp_planner_counts statistics;
    double first_s; /* to the first route */
    double total_s;
};

static inline void fail(const char *what)
{
    (void)fprintf(stderr, "bench_plan: %s\n", what);
    exit(1);
}

static inline void *allocate(size_t size)
{
    void *block = malloc(size);
    if (block == NULL) {
        fail("no memory");
    }
    return block;
}

static inline double now_s(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- Planning ---- */

static inline void start_planner(struct jp_planner *planner, const struct jp_planner_config *config,
                                 const struct task *task, void *block, size_t size)
{
    const char *field = "";
    if (jp_planner_init(planner, config, task->terrain, block, size, &field) != JP_OK ||
        jp_planner_set_start(planner, &task->start) != JP_OK || jp_planner_set_goal(planner, &task->goal) != JP_OK) {
        fail(task->name);
    }
}

static inline double work_until_idle(struct jp_planner *planner)
{
    const double begin = now_s();
    while (!jp_planner_is_idle(planner)) {
        (void)jp_planner_work(planner, SLICE);
    }
    return now_s() - begin;
}

static inline struct outcome plan(const struct jp_planner_config *config, const struct task *task, size_t size)
{
    struct jp_planner planner;
    struct outcome outcome = {.first_s = NAN};
    void *block = allocate(size);
    memset(block, 0, size); /* pages are there before the clock runs */
    const double begin = now_s();

    start_planner(&planner, config, task, block, size);
    do {
        outcome.answer = jp_planner_work(&planner, SLICE);
        if (isnan(outcome.first_s) && outcome.answer != JP_ANSWER_OUT_OF_BUDGET) {
            outcome.first_s = now_s() - begin;
        }
    } while (!jp_planner_is_idle(&planner));
    outcome.total_s = now_s() - begin;
    outcome.first_s = isnan(outcome.first_s) ? outcome.total_s : outcome.first_s;
    outcome.plan = *jp_planner_plan(&planner);
    outcome.statistics = *jp_planner_statistics(&planner);
    free(block);
    return outcome;
}

/* ---- Poses and changes ---- */

/* A pose where the robot can stand. False when there seems to be none. */
static inline bool random_pose(struct random *random, const struct jp_lattice *of, const struct jp_terrain *terrain,
                               struct jp_lattice_pose *pose)
{
    enum { POSES = 100000 };

    for (unsigned i = 0; i < POSES; i++) {
        pose->x = (int16_t)random_uniform(random, 0, terrain->config.width);
        pose->y = (int16_t)random_uniform(random, 0, terrain->config.height);
        pose->heading = (uint8_t)random_uniform(random, 0, JP_HEADINGS);
        if (jp_lattice_can_stand(of, terrain, pose->x, pose->y, pose->heading)) {
            return true;
        }
    }
    return false;
}

static inline struct jp_lattice_pose pose_after(const struct jp_planner *planner, unsigned steps)
{
    struct jp_lattice_pose pose = jp_planner_plan(planner)->start;
    for (unsigned i = 0; i < steps; i++) {
        (void)jp_planner_step(planner, i, &pose);
    }
    return pose;
}

/* A square of cells becomes occupied, or free where it was not. */
static inline void toggle_square(struct jp_planner *planner, const struct jp_terrain *terrain,
                                 struct jp_lattice_pose place)
{
    const bool was_free = jp_terrain_cell(terrain, place.x, place.y) == JP_CELL_FREE;

    for (int32_t i = 0; i < SQUARE_SIDE * SQUARE_SIDE; i++) {
        (void)jp_planner_set_cell(planner, place.x + i % SQUARE_SIDE, place.y + i / SQUARE_SIDE,
                                  was_free ? JP_CELL_OCCUPIED : JP_CELL_FREE);
    }
}

/* ---- Scenes ---- */

struct scene {
    struct task task;
    char name[16];
    struct jp_terrain terrain;
    void *block;
    double optimum; /* cost units */
    double dijkstra_s;
};

static inline void make_scene(struct scene *scene, uint32_t seed)
{
    struct scene_task task;
    const char *field = "";

    scene->block = allocate(SCENE_TERRAIN_SIZE);
    if (jp_terrain_init(&scene->terrain, &scene_terrain_config, scene->block, SCENE_TERRAIN_SIZE, &field) != JP_OK) {
        fail(field);
    }
    scene_generate(seed, &scene->terrain, &task);
    (void)snprintf(scene->name, sizeof scene->name, "scene %u", seed);
    scene->task = (struct task){
        .name = scene->name,
        .terrain = &scene->terrain,
        .start = {(int16_t)task.start.x, (int16_t)task.start.y, task.start.heading},
        .goal = {(int16_t)task.goal.x, (int16_t)task.goal.y, (uint16_t)(1U << task.goal.heading)},
    };
}

#endif
