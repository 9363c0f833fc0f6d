#include "tools/python/native/drives.h"

#include "sim/base/error.h"
#include "sim/missions/mission_skid.h"

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
