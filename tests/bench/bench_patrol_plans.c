/* What planning by joules brings the patrol robot: the same drives, planned by joules and by length, on maps of others
 * to random goals among boxes that the map shows (random_goals.h). Both are driven in closed loop. Prints figures as
 * JSON, drives that do not end as they should on stderr; maps (tools/design/import_map.py) are the arguments.
 *
 * bench_patrol_plans [--seed FIRST] [--count N] MAP.json… */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/error.h"
#include "sim/base/parallel.h"
#include "sim/missions/patrol_mission.h"
#include "tests/bench/drive_options.h"
#include "tests/bench/figures.h"
#include "tests/bench/random_goals.h"

#define COMMAND    "make bench-patrol-plans"
#define ROBOT_PATH "sim/robots/patrol.cfg"

/* Ways whose planned lengths differ by more are other ways, m. */
#define OTHER_WAY 0.05

enum { DRIVES_MAX = 1000 };

static struct drive_options options = {
    .seed = 510001, .count = 40, .count_max = DRIVES_MAX, .maps_max = DRIVE_MAPS_MAX};

struct pair {
    bool is_reachable;
    struct patrol_result joules;
    struct patrol_result length;
};

struct campaign {
    struct four_wheel_file robot;
    char names[DRIVE_MAPS_MAX][PATROL_SCENE_NAME_SIZE];
    struct pair pairs[DRIVE_MAPS_MAX][DRIVES_MAX];
};

/* ---- Drives ---- */

static void run(const struct four_wheel_file *robot, const struct patrol_scene *scene, bool plans_by_length,
                uint64_t seed, struct patrol_result *result)
{
    const struct patrol_task task = {.robot = robot,
                                     .scene = scene,
                                     .method = PATROL_IMPROVED,
                                     .plans_by_length = plans_by_length,
                                     .seed = seed,
                                     .faults = {.jump_at = -1}};

    if (!patrol_mission_run(&task, result)) {
        abort();
    }
}

static void drive_index(void *context, size_t index)
{
    static const struct planar_pose nowhere;
    struct campaign *const campaign = context;
    const size_t map = index % options.map_count;
    const uint64_t seed = options.seed + index / options.map_count;
    struct pair *const pair = &campaign->pairs[map][index / options.map_count];
    struct patrol_scene scene;

    if (!patrol_scene_load(options.maps[map], &nowhere, &nowhere, &scene)) {
        exit(ERROR_EXIT);
    }

    void *const copy = allocate(jp_terrain_size(&scene.map.config));

    memcpy(campaign->names[map], scene.name, sizeof scene.name);
    if (!make_task(&campaign->robot, &scene, copy, seed, &pair->is_reachable)) {
        error_line("%s: no room for a start and a goal", options.maps[map]);
        exit(ERROR_EXIT);
    }

    struct patrol_scene shown = scene;

    shown.map = scene.ground;
    shown.limit_s = limit_of(&scene);
    run(&campaign->robot, &shown, false, seed, &pair->joules);
    run(&campaign->robot, &shown, true, seed, &pair->length);
    patrol_scene_free(&scene);
    free(copy);
}

/* ---- What came of them ---- */

struct sums {
    double reachable;
    double joules_missed; /* of them */
    double length_missed;
    double pairs;     /* in which both arrived */
    double other;     /* of them, by other ways */
    double joules[2]; /* by joules and by length */
    double seconds[2];
    double metres[2];
    double others_joules[2];
    double forecast_error; /* relative, of what joules planned, sum of magnitudes */
    double nearest[2];
};

static void print_bad(const char *map, uint64_t seed, const char *plan, const struct patrol_result *result)
{
    if (result->outcome != PATROL_ARRIVED) {
        (void)fprintf(stderr, "%s, seed %lu, by %s: %s %s after %.1f s, %.1f m from the goal, %u replans\n", map,
                      (unsigned long)seed, plan, patrol_outcome_names[result->outcome],
                      patrol_reason_names[result->reason], result->time, result->position_error, result->replans);
    }
}

static void add_pair(struct sums *sums, const struct pair *pair)
{
    const struct patrol_result *const results[2] = {&pair->joules, &pair->length};
    const bool has_joules = pair->joules.outcome == PATROL_ARRIVED;
    const bool has_length = pair->length.outcome == PATROL_ARRIVED;

    sums->reachable += pair->is_reachable;
    sums->joules_missed += pair->is_reachable && !has_joules;
    sums->length_missed += pair->is_reachable && !has_length;
    if (!pair->is_reachable || !has_joules || !has_length) {
        return;
    }
    const bool is_other = fabs(pair->joules.path_length - pair->length.path_length) > OTHER_WAY;

    sums->pairs++;
    sums->other += is_other;
    sums->forecast_error += fabs(pair->joules.leg.planned / pair->joules.leg.driven - 1);
    for (size_t i = 0; i < 2; i++) {
        sums->joules[i] += results[i]->energy_j;
        sums->seconds[i] += results[i]->time;
        sums->metres[i] += results[i]->length;
        sums->others_joules[i] += is_other ? results[i]->energy_j : 0;
        sums->nearest[i] += results[i]->clearance_min < 0.1;
    }
}

static void add_map(json_t *figures, const struct campaign *campaign, size_t map)
{
    const char *const name = campaign->names[map];
    struct sums sums = {0};

    for (size_t i = 0; i < options.count; i++) {
        const struct pair *const pair = &campaign->pairs[map][i];

        print_bad(name, options.seed + i, "joules", &pair->joules);
        print_bad(name, options.seed + i, "length", &pair->length);
        add_pair(&sums, pair);
    }
    (void)fprintf(stderr,
                  "%s: %.0f pairs, %.0f by other ways; J %.1f %.1f, of other ways %.1f %.1f, s %.2f %.2f, m %.2f %.2f; "
                  "nearer than 10 cm %.0f %.0f\n",
                  name, sums.pairs, sums.other, sums.joules[0] / sums.pairs, sums.joules[1] / sums.pairs,
                  sums.others_joules[0] / sums.other, sums.others_joules[1] / sums.other, sums.seconds[0] / sums.pairs,
                  sums.seconds[1] / sums.pairs, sums.metres[0] / sums.pairs, sums.metres[1] / sums.pairs,
                  sums.nearest[0], sums.nearest[1]);
    figures_add(figures, COMMAND, sums.joules_missed, "", no_bar,
                "patrol robot, plans by joules, %s with boxes, %zu goals: of %.0f that can be reached, not reached",
                name, options.count, sums.reachable);
    figures_add(figures, COMMAND, sums.length_missed, "", no_bar,
                "patrol robot, plans by length, %s with boxes, %zu goals: of %.0f that can be reached, not reached",
                name, options.count, sums.reachable);
    if (sums.pairs > 0) {
        figures_add(figures, COMMAND, 100 * sums.other / sums.pairs, "%", no_bar,
                    "patrol robot, plans by joules and by length, %s with boxes, %zu goals: other ways", name,
                    options.count);
        figures_add(figures, COMMAND, sums.joules[0] / sums.joules[1], "×", no_bar,
                    "patrol robot, plans by joules over those by length, %s with boxes, %zu goals: energy driven", name,
                    options.count);
        figures_add(figures, COMMAND, sums.seconds[0] / sums.seconds[1], "×", no_bar,
                    "patrol robot, plans by joules over those by length, %s with boxes, %zu goals: time", name,
                    options.count);
        figures_add(
            figures, COMMAND, 100 * sums.forecast_error / sums.pairs, "%", no_bar,
            "patrol robot, plans by joules, %s with boxes, %zu goals: energy as planned off what was driven, mean",
            name, options.count);
    }
}

/* ---- Program ---- */

int main(int argc, char **argv)
{
    static struct campaign campaign;
    json_t *figures = json_array();

    parse_drive_options(argc, argv, "Measures what planning by joules brings the patrol robot.", &options);
    if (!four_wheel_file_load(ROBOT_PATH, &campaign.robot)) {
        return ERROR_EXIT;
    }
    in_parallel("plans of the patrol", drive_index, &campaign, options.count * options.map_count);
    for (size_t map = 0; map < options.map_count; map++) {
        add_map(figures, &campaign, map);
    }
    figures_print(figures);
    return 0;
}
