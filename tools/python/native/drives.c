#include "tools/python/native/drives.h"

#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/missions/mission_skid.h"
#include "sim/missions/navigation.h"
#include "sim/missions/navigation_balancer.h"
#include "sim/missions/navigation_sight.h"
#include "sim/missions/navigation_skid.h"
#include "sim/missions/navigation_world.h"

/** Simulated s after which a navigator's drive is given up; as jp-navigate. */
#define PATIENCE 3600

static bool is_whole(const struct rows *rows, const char *name)
{
    if (rows->has_lost) {
        error_line("%s: no memory for its rows", name);
    }
    return !rows->has_lost;
}

/* ---- Missions ---- */

static void keep_row(void *context, const struct mission_row *row)
{
    rows_add(context, row);
}

bool drive_mission(struct rows *rows, struct mission *mission, enum mission_strategy strategy,
                   const struct scenario *scenario)
{
    const struct mission_view view = {.record = keep_row, .context = rows};

    *rows = (struct rows){.size = sizeof(struct mission_row)};
    const bool done = scenario->kind == SCENARIO_SKID ? mission_skid_run(mission, strategy, scenario, NULL, &view)
                                                      : mission_run(mission, strategy, scenario, NULL, &view);
    if (!done) {
        mission_complain(mission, scenario);
        return false;
    }
    return is_whole(rows, scenario->name);
}

/* ---- Patrol ---- */

static void keep_view(void *context, const struct patrol_view *view)
{
    const struct patrol_row row = {
        .time = view->time,
        .x = view->true_pose.x,
        .y = view->true_pose.y,
        .heading = view->true_pose.heading,
        .believed_x = view->believed.x,
        .believed_y = view->believed.y,
        .believed_heading = view->believed.heading,
        .speed = view->true_speed.forward,
        .turn_rate = view->true_speed.turn_rate,
        .clearance = view->clearance,
        .energy = view->energy_j,
        .state = view->state,
    };

    rows_add(context, &row);
}

bool drive_patrol(struct rows *rows, struct patrol_result *result, const struct four_wheel_file *robot,
                  enum patrol_scene_kind kind, enum patrol_method method, uint64_t seed)
{
    struct patrol_scene scene;

    *rows = (struct rows){.size = sizeof(struct patrol_row)};
    patrol_scene_make(kind, seed, &scene);
    const struct patrol_task task = {
        .robot = robot, .scene = &scene, .method = method, .seed = seed, .observe = keep_view, .context = rows};
    const bool done = patrol_mission_run(&task, result) && is_whole(rows, scene.name);
    patrol_scene_free(&scene);
    return done;
}

/* ---- Navigator ---- */

/** A robot of one kind or the other. */
struct driven {
    struct navigation_balancer balancer;
    struct navigation_skid skid;
    struct skid_classes classes;
    struct navigation_robot robot;
};

static bool switch_on(struct driven *driven, const struct lattice_robot *robot, const struct navigation_task *task)
{
    const struct clearance_pose start = navigation_start(task);

    if (robot->balancer.model != NULL) {
        return navigation_balancer_init(&driven->balancer, rig_find_robot(robot->name), &robot->balancer.file, &start,
                                        task->seed, JP_PILOT_MOTORS, &driven->robot);
    }
    const struct skid_robot_entry *entry = skid_robot_find(robot->name);
    const struct skid_surface surface = navigation_skid_surface(task->world, task->grounds, &driven->classes);

    return entry != NULL &&
           navigation_skid_init(&driven->skid, entry, &robot->skid_steer, task->world,
                                task->world->config.has_classes ? &surface : NULL, &start, task->seed, &driven->robot);
}

static void keep_frame(void *context, const struct navigation_frame *frame)
{
    const struct navigator_row row = {
        .time = frame->seconds,
        .x = frame->pose.x,
        .y = frame->pose.y,
        .heading = frame->pose.heading,
        .energy = frame->joules,
        .left = frame->left_m,
        .state = (int)frame->state,
        .replans = (int)frame->replans,
    };

    rows_add(context, &row);
}

static bool drive_in(const struct navigation_world *world, struct rows *rows, struct navigation_result *result,
                     const struct navigator_drive *drive)
{
    struct navigation_task task = {.lattice = drive->lattice,
                                   .map = &drive->map->terrain,
                                   .world = &world->terrain,
                                   .solid = &world->solid,
                                   .grounds = drive->map->grounds,
                                   .start = drive->places.start,
                                   .goal = drive->places.goal,
                                   .view_m = drive->view_m,
                                   .memory = drive->memory,
                                   .patience = PATIENCE,
                                   .seed = drive->seed,
                                   .watch = keep_frame,
                                   .context = rows};
    struct driven *driven = calloc(1, sizeof *driven);
    const bool is_done = driven != NULL && switch_on(driven, drive->robot, &task) &&
                         navigation_run(&task, &driven->robot, result) && is_whole(rows, drive->robot->name);

    free(driven);
    return is_done;
}

bool drive_navigator(struct rows *rows, struct navigation_result *result, const struct navigator_drive *drive)
{
    struct navigation_world world;

    *rows = (struct rows){.size = sizeof(struct navigator_row)};
    if (!navigation_world_init(&world, drive->map, drive->robot->grade_max)) {
        return false;
    }
    const bool is_done = navigation_world_hide(&world, drive->map, drive->lattice, &drive->places, drive->hidden,
                                               drive->seed, drive->memory) &&
                         drive_in(&world, rows, result, drive);
    navigation_world_free(&world);
    return is_done;
}
