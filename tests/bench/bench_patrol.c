/* The patrol robot on its scenes, on firm and on slippery ground: how often each method arrives, collides and drives
 * backwards, and whether that was cheaper and free, in what time, with what energy and how near to what stands there.
 * Prints figures as JSON; --rows FILE gets a row for each scene, ground and method. Bad drives of the improved band and
 * progress on stderr. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/parallel.h"
#include "sim/four_wheel/patrol_config.h"
#include "sim/missions/patrol_mission.h"
#include "src/base/plane.h"
#include "src/local/patrol_price.h"
#include "tests/bench/figures.h"

#define COMMAND    "make bench-patrol"
#define ROBOT_PATH "sim/robots/patrol.cfg"

/* What slip and the controller's noise at a stand explain, m; more is driving backwards. */
#define BACKWARDS_MIN 0.02

/* What a drive should keep off, m, and what two measurements of a clearance differ by without a motion. */
#define NEAR_M  0.1
#define NOISE_M 0.01

/* Slower than this it does not drive backwards, m/s. */
#define BACKWARDS_SPEED 0.03

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

/* What a robot does from when it begins to go backwards, or to step, until it does neither. */
struct backing {
    bool is_under_way;
    struct jp_plane_pose from;
    double metres; /* backwards */
    double clearance;
    double clearance_least;
    double energy; /* at its beginning, J */
    double time;   /* s */
};

/* Whether what a drive went backwards was free, and cheaper than to turn, go there forwards, and turn back. */
struct judge {
    const struct four_wheel_file *robot;
    struct jp_patrol_config config;
    struct backing backing;
    double before; /* time of the last cycle */
    unsigned not_free;
    unsigned not_cheaper;
};

/* All drives of a method at a place. */
struct group {
    const struct place *place;
    enum patrol_method method;
    struct patrol_result results[DRIVES_MAX];
    struct judge judges[DRIVES_MAX];
};

struct campaign {
    struct four_wheel_file robot;
    struct group groups[GROUPS];
};

/* ---- Backwards ---- */

/* By the prices of the robot, which its tests hold against the model: of the way there forwards, J. */
static double forwards_price(const struct jp_patrol_config *config, const struct jp_plane_pose *way)
{
    const float angle = jp_plane_magnitude(jp_plane_bearing(way->x, way->y));

    return (double)(jp_patrol_straight_price(config, angle, jp_plane_length(way->x, way->y)) +
                    jp_patrol_turn_price(config, angle));
}

static void end_backing(struct judge *judge, const struct patrol_view *view)
{
    const struct backing *const backing = &judge->backing;
    const struct jp_plane_pose way = jp_plane_relative(&backing->from, &view->true_pose);
    const double seconds = view->time - backing->time;
    const double spent = view->energy_j - backing->energy + judge->robot->turning.second_w * seconds;

    judge->backing.is_under_way = false;
    if (backing->metres > BACKWARDS_MIN) {
        judge->not_free += backing->clearance_least < fmin(NEAR_M, backing->clearance - NOISE_M);
        judge->not_cheaper += spent > forwards_price(&judge->config, &way);
    }
}

static void watch_backwards(void *context, const struct patrol_view *view)
{
    struct judge *const judge = context;
    struct backing *const backing = &judge->backing;
    const double speed = -(double)view->true_speed.forward;

    if (speed <= BACKWARDS_SPEED && view->state != JP_PATROL_STEPPING) {
        if (backing->is_under_way) {
            end_backing(judge, view);
        }
    } else if (!backing->is_under_way) {
        *backing =
            (struct backing){true, view->true_pose, 0, view->clearance, view->clearance, view->energy_j, view->time};
    } else {
        backing->clearance_least = fmin(backing->clearance_least, view->clearance);
        backing->metres += speed > BACKWARDS_SPEED ? speed * (view->time - judge->before) : 0;
    }
    judge->before = view->time;
}

/* ---- Driving ---- */

static void drive(const struct four_wheel_file *robot, const struct group *group, uint64_t seed, struct judge *judge,
                  struct patrol_result *result)
{
    struct patrol_scene scene;
    const struct patrol_task task = {.robot = robot,
                                     .scene = &scene,
                                     .method = group->method,
                                     .seed = seed,
                                     .faults = {.jump_at = -1, .slip = group->place->slip},
                                     .observe = watch_backwards,
                                     .context = judge};

    *judge = (struct judge){.robot = robot, .config = patrol_config(robot, group->method)};
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
    drive(&campaign->robot, group, FIRST_SEED + index, &group->judges[index], &group->results[index]);
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
    double needless;  /* of them, those in which that was not cheaper, or not free */
    double time;      /* s, mean */
    double energy;    /* J, mean */
    double clearance; /* m, least of all drives */
    double near;      /* drives that came nearer to something than NEAR_M */
};

static bool is_needless(const struct judge *judge)
{
    return judge->not_free + judge->not_cheaper > 0;
}

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
        summary.needless += is_needless(&group->judges[i]);
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
            (void)fprintf(stderr, "%s%s, seed %zu: %s %s, %.2f m backwards, %u times not free, %u times not cheaper\n",
                          patrol_scene_names[group->place->kind], group->place->slip ? ", slippery" : "",
                          FIRST_SEED + i, patrol_outcome_names[result->outcome], patrol_reason_names[result->reason],
                          result->reversed, group->judges[i].not_free, group->judges[i].not_cheaper);
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
    add(figures, group, "drove backwards", summary->backwards, "", no_bar);
    if (group->method == PATROL_IMPROVED) {
        add(figures, group, "drove backwards where that was not cheaper or not free", summary->needless, "", none);
    }
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
