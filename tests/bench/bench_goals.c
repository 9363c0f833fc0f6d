/* The patrol robot on maps of others, to random goals among boxes that the map does not show: how many of the goals
 * that can be reached it reaches, what it touches, and what it says of the others. Prints figures as JSON, drives that
 * do not end as they should on stderr; maps (tools/design/import_map.py) are the arguments. The rule of boxes and goals
 * stands in random_goals.h.
 *
 * bench_goals [--seed FIRST] [--count N] MAP.json… */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/error.h"
#include "sim/base/parallel.h"
#include "sim/missions/patrol_mission.h"
#include "tests/bench/drive_options.h"
#include "tests/bench/figures.h"
#include "tests/bench/random_goals.h"

#define COMMAND    "make bench-goals"
#define ROBOT_PATH "sim/robots/patrol.cfg"

enum { DRIVES_MAX = 1000 };

static struct drive_options options = {.seed = 1101, .count = 200, .count_max = DRIVES_MAX, .maps_max = DRIVE_MAPS_MAX};

struct run {
    bool is_reachable;
    struct patrol_result result;
};

struct campaign {
    struct four_wheel_file robot;
    char names[DRIVE_MAPS_MAX][PATROL_SCENE_NAME_SIZE];
    struct run runs[DRIVE_MAPS_MAX][DRIVES_MAX];
};

/* ---- Drives ---- */

static void drive_index(void *context, size_t index)
{
    static const struct planar_pose nowhere;
    struct campaign *const campaign = context;
    const size_t map = index % options.map_count;
    const uint64_t seed = options.seed + index / options.map_count;
    struct run *const run = &campaign->runs[map][index / options.map_count];
    struct patrol_scene scene;

    if (!patrol_scene_load(options.maps[map], &nowhere, &nowhere, &scene)) {
        exit(ERROR_EXIT);
    }

    void *const copy = allocate(jp_terrain_size(&scene.map.config));
    const struct patrol_task task = {
        .robot = &campaign->robot, .scene = &scene, .method = PATROL_IMPROVED, .seed = seed, .faults = {.jump_at = -1}};

    memcpy(campaign->names[map], scene.name, sizeof scene.name);
    if (!make_task(&campaign->robot, &scene, copy, seed, &run->is_reachable)) {
        error_line("%s: no room for a start and a goal", options.maps[map]);
        exit(ERROR_EXIT);
    }
    scene.limit_s = limit_of(&scene);
    if (!patrol_mission_run(&task, &run->result)) {
        abort();
    }
    patrol_scene_free(&scene);
    free(copy);
}

/* ---- What came of them ---- */

static void print_bad(const char *map, uint64_t seed, const struct run *run)
{
    const struct patrol_result *const result = &run->result;

    if (result->outcome == PATROL_COLLIDED || (run->is_reachable && result->outcome != PATROL_ARRIVED)) {
        (void)fprintf(stderr, "%s, seed %lu%s: %s %s after %.1f s, %.1f m from the goal, %u replans\n", map,
                      (unsigned long)seed, run->is_reachable ? "" : ", out of reach",
                      patrol_outcome_names[result->outcome], patrol_reason_names[result->reason], result->time,
                      result->position_error, result->replans);
    }
}

static void add_map(json_t *figures, const struct campaign *campaign, size_t map)
{
    const char *const name = campaign->names[map];
    double reachable = 0;
    double missed = 0;
    double touched = 0;
    double position = 0;
    double heading = 0;

    for (size_t i = 0; i < options.count; i++) {
        const struct run *const run = &campaign->runs[map][i];
        const bool has_arrived = run->result.outcome == PATROL_ARRIVED;

        print_bad(name, options.seed + i, run);
        reachable += run->is_reachable;
        missed += run->is_reachable && !has_arrived;
        touched += run->result.outcome == PATROL_COLLIDED;
        position = has_arrived ? fmax(position, run->result.position_error) : position;
        heading = has_arrived ? fmax(heading, run->result.heading_error) : heading;
    }
    figures_add(figures, COMMAND, reachable, "", no_bar,
                "patrol robot, %s with hidden boxes, %zu goals: can be reached", name, options.count);
    figures_add(figures, COMMAND, missed, "", equal_to(0),
                "patrol robot, %s with hidden boxes, %zu goals: can be reached and were not", name, options.count);
    figures_add(figures, COMMAND, touched, "", equal_to(0),
                "patrol robot, %s with hidden boxes, %zu goals: touched something", name, options.count);
    figures_add(figures, COMMAND, position, "m", no_bar,
                "patrol robot, %s with hidden boxes, %zu goals: error at the goal, worst", name, options.count);
    figures_add(figures, COMMAND, heading * 180 / M_PI, "°", no_bar,
                "patrol robot, %s with hidden boxes, %zu goals: error of the heading at the goal, worst", name,
                options.count);
}

/* ---- Program ---- */

int main(int argc, char **argv)
{
    static struct campaign campaign;
    json_t *figures = json_array();

    parse_drive_options(argc, argv, "Drives the patrol robot to random goals on maps of others.", &options);
    if (!four_wheel_file_load(ROBOT_PATH, &campaign.robot)) {
        return ERROR_EXIT;
    }
    in_parallel("random goals", drive_index, &campaign, options.count * options.map_count);
    for (size_t map = 0; map < options.map_count; map++) {
        add_map(figures, &campaign, map);
    }
    figures_print(figures);
    return 0;
}
