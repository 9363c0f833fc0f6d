/* The patrol robot on its scenes, on firm and on slippery ground: how often each method arrives, collides and drives
 * backwards, in what time, with what energy and how near to what stands there. Prints figures as JSON; --rows FILE gets
 * a row for each scene, ground and method. Bad drives of the improved band and progress on stderr. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/parallel.h"
#include "sim/missions/patrol_mission.h"
#include "tests/bench/figures.h"

#define COMMAND    "make bench-patrol"
#define ROBOT_PATH "sim/robots/patrol.cfg"

/* What slip and the controller's noise at a stand explain, m; more is driving backwards. */
#define BACKWARDS_MIN 0.02

/* What a drive should keep off, m. */
#define NEAR_M 0.1

enum { FIRST_SEED = 1, DRIVES_MAX = 100 };

/* Where the drives of a group are. */
static const struct place {
    enum patrol_scene_kind kind;
    bool slip;
    size_t drives;
    bool has_bars;
} places[] = {
    {PATROL_BESIDE_OBSTACLE, false, 100, true}, {PATROL_L_PASSAGE, false, 100, true},
    {PATROL_CORRIDOR, false, 100, true},        {PATROL_DOORWAY, false, 50, false},
    {PATROL_PEDESTRIAN, false, 50, false},      {PATROL_WAREHOUSE, false, 50, false},
    {PATROL_BESIDE_OBSTACLE, true, 30, false},  {PATROL_L_PASSAGE, true, 30, false},
    {PATROL_CORRIDOR, true, 30, false},
};
enum { PLACES = sizeof places / sizeof places[0], GROUPS = PLACES * PATROL_METHODS };

/* All drives of a method at a place. */
struct group {
    const struct place *place;
    enum patrol_method method;
    struct patrol_result results[DRIVES_MAX];
};

struct campaign {
    struct four_wheel_file robot;
    struct group groups[GROUPS];
};

/* ---- Driving ---- */

static void drive(const struct four_wheel_file *robot, const struct group *group, uint64_t seed,
                  struct patrol_result *result)
{
    struct patrol_scene scene;
    const struct patrol_task task = {.robot = robot,
                                     .scene = &scene,
                                     .method = group->method,
                                     .seed = seed,
                                     .faults = {.jump_at = -1, .slip = group->place->slip}};

    patrol_scene_make(group->place->kind, seed, &scene);
    if (!patrol_mission_run(&task, result)) {
        abort();
    }
    patrol_scene_free(&scene);
}

/* The index counts the drives of all groups. */
static void drive_index(void *context, size_t index)
{
    struct campaign *campaign = context;
    struct group *group = campaign->groups;

    while (index >= group->place->drives) {
        index -= group->place->drives;
        group++;
    }
    drive(&campaign->robot, group, FIRST_SEED + index, &group->results[index]);
}

static size_t lay_out(struct campaign *campaign)
{
    size_t drives = 0;

    for (size_t i = 0; i < GROUPS; i++) {
        campaign->groups[i].place = &places[i / PATROL_METHODS];
        campaign->groups[i].method = (enum patrol_method)(i % PATROL_METHODS);
        drives += campaign->groups[i].place->drives;
    }
    return drives;
}

/* ---- What came of them ---- */

/* Means are of those that arrived, NaN when none did. */
struct summary {
    double arrived;
    double cleanly; /* of them, without driving backwards */
    double collided;
    double backwards; /* drives in which the robot drove backwards */
    double time;      /* s, mean */
    double energy;    /* J, mean */
    double clearance; /* m, least of all drives */
    double near;      /* drives that came nearer to something than NEAR_M */
};

static bool is_backwards(const struct patrol_result *result)
{
    return result->reversed > BACKWARDS_MIN;
}

static struct summary summarise(const struct group *group)
{
    struct summary summary = {.clearance = INFINITY};

    for (size_t i = 0; i < group->place->drives; i++) {
        const struct patrol_result *result = &group->results[i];
        const bool has_arrived = result->outcome == PATROL_ARRIVED;

        summary.arrived += has_arrived;
        summary.cleanly += has_arrived && !is_backwards(result);
        summary.collided += result->outcome == PATROL_COLLIDED;
        summary.backwards += is_backwards(result);
        summary.time += has_arrived ? result->time : 0;
        summary.energy += has_arrived ? result->energy_j : 0;
        summary.clearance = fmin(summary.clearance, result->clearance_min);
        summary.near += result->clearance_min < NEAR_M;
    }
    summary.time /= summary.arrived;
    summary.energy /= summary.arrived;
    return summary;
}

static void print_bad(const struct group *group)
{
    for (size_t i = 0; i < group->place->drives; i++) {
        const struct patrol_result *result = &group->results[i];

        if (group->method == PATROL_IMPROVED && (result->outcome != PATROL_ARRIVED || is_backwards(result))) {
            (void)fprintf(stderr, "%s%s, seed %zu: %s %s, %.2f m backwards\n", patrol_scene_names[group->place->kind],
                          group->place->slip ? ", slippery" : "", FIRST_SEED + i, patrol_outcome_names[result->outcome],
                          patrol_reason_names[result->reason], result->reversed);
        }
    }
}

/* ---- Figures ---- */

/* One that is NaN has nothing to tell of. */
static void add(json_t *figures, const struct group *group, const char *what, double value, const char *unit,
                struct figure_bar bar)
{
    if (!isnan(value)) {
        figures_add(figures, COMMAND, value, unit, bar, "patrol robot, %s%s, %zu drives, %s band: %s",
                    patrol_scene_names[group->place->kind], group->place->slip ? " on slippery ground" : "",
                    group->place->drives, patrol_method_names[group->method], what);
    }
}

static void add_means(json_t *figures, const struct group *group, const struct summary *summary)
{
    add(figures, group, "time, mean", summary->time, "s", no_bar);
    add(figures, group, "energy, mean", summary->energy, "J", no_bar);
    add(figures, group, "least clearance", summary->clearance, "m", no_bar);
    add(figures, group, "came nearer than 10 cm to something", summary->near, "", no_bar);
}

static void add_figures(json_t *figures, const struct group *group, const struct summary *summary)
{
    const bool has_bars = group->place->has_bars && group->method == PATROL_IMPROVED;
    const struct figure_bar none = has_bars ? equal_to(0) : no_bar;

    add(figures, group, "arrived", summary->arrived, "", has_bars ? equal_to((double)group->place->drives) : no_bar);
    if (group->method == PATROL_PLAIN) {
        add(figures, group, "arrived without driving backwards", summary->cleanly, "", no_bar);
    }
    add(figures, group, "collided", summary->collided, "", none);
    add(figures, group, "drove backwards", summary->backwards, "", none);
    if (group->place->has_bars) {
        add_means(figures, group, summary);
    }
}

/* ---- Rows ---- */

static json_t *json_known(double value)
{
    return isnan(value) ? json_null() : json_real(value);
}

static json_t *json_row(const struct group *group, const struct summary *summary)
{
    return json_pack("{s:s, s:b, s:s, s:i, s:i, s:i, s:i, s:i, s:o, s:o, s:f}", "scene",
                     patrol_scene_names[group->place->kind], "slip", group->place->slip, "method",
                     patrol_method_names[group->method], "drives", (int)group->place->drives, "arrived",
                     (int)summary->arrived, "cleanly", (int)summary->cleanly, "collided", (int)summary->collided,
                     "backwards", (int)summary->backwards, "time_s", json_known(summary->time), "energy_j",
                     json_known(summary->energy), "clearance_min_m", summary->clearance);
}

/* ---- Program ---- */

int main(int argc, char **argv)
{
    static struct campaign campaign;
    const char *rows_path = figures_rows_path(argc, argv, "Measures the patrol robot on its scenes.");
    json_t *figures = json_array();
    json_t *rows = json_array();

    if (!four_wheel_file_load(ROBOT_PATH, &campaign.robot)) {
        return ERROR_EXIT;
    }
    in_parallel("patrol robot", drive_index, &campaign, lay_out(&campaign));
    for (size_t i = 0; i < GROUPS; i++) {
        const struct group *group = &campaign.groups[i];
        const struct summary summary = summarise(group);

        print_bad(group);
        if (group->method != PATROL_PURSUIT) {
            add_figures(figures, group, &summary);
        }
        (void)json_array_append_new(rows, json_row(group, &summary));
    }
    figures_write_rows(rows, rows_path);
    figures_print(figures);
    return 0;
}
