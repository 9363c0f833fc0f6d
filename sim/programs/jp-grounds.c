/* A robot goes again and again over a map of several grounds: what it learns of them, and what that saves. */
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/missions/ground_trips.h"
#include "sim/missions/plan_arguments.h"
#include "sim/missions/plan_lattice.h"
#include "sim/skid_steer/skid_robots.h"

/** Exit code when the outputs were written but a trip did not arrive, or touched something. */
#define NOT_ARRIVED_EXIT 1

#define MEMORY_KIB 1024
#define TRIPS      6
#define TRIPS_MAX  1000

/** Between two points of a track, s. */
#define TRACK_PERIOD 0.5

enum { OPTION_TRIPS = PLAN_OPTION_OWN };

enum { KEEPS, KEEPS_NOT, MEMORIES };
static const char *const memory_names[MEMORIES] = {"kept", "not_kept"};

struct arguments {
    struct plan_arguments plan; /* first: plan_arguments_take() looks at it */
    unsigned trips;
};

/* Where a robot was on a trip. */
struct track {
    const struct map_file *map;
    json_t *points;
    double next; /* s */
};

/* ---- Command line ---- */

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case OPTION_TRIPS:
        arguments->trips = (unsigned)command_line_whole(state, "--trips", argument, 1, TRIPS_MAX);
        return 0;
    default:
        return plan_arguments_take(key, argument, state);
    }
}

/* ---- Inputs ---- */

/* False after one line on stderr. */
static bool prepare(const struct arguments *arguments, const struct lattice_robot *robot, const struct map_file *map,
                    struct ground_trips_task *task)
{
    *task = (struct ground_trips_task){.robot = robot,
                                       .map = map,
                                       .lattice = plan_lattice_for_navigation(robot->name),
                                       .memory = arguments->plan.memory};
    if (robot->balancer.model != NULL || task->lattice == NULL || skid_robot_built_in(robot->name) == NULL) {
        error_line("%s: it is no robot of skid steer or differential drive with a lattice for finding its way; give "
                   "zhang2018 or burger",
                   robot->name);
        return false;
    }
    if (!map->terrain.config.has_classes) {
        error_line("%s: tells no grounds apart; give a map with a key class", arguments->plan.map_path);
        return false;
    }
    return plan_lattice_fits(arguments->plan.map_path, map, task->lattice) &&
           plan_arguments_task(&arguments->plan, map, task->lattice, &task->places);
}

/* ---- Outputs ---- */

static void keep_point(void *context, const struct navigation_frame *frame)
{
    struct track *track = context;

    if (frame->seconds >= track->next) {
        const struct plan_place place = plan_map_place(track->map, &frame->pose);

        (void)json_array_append_new(track->points, json_pack("[f, f]", place.x, place.y));
        track->next += TRACK_PERIOD;
    }
}

static json_t *json_known(const struct ground_known *known)
{
    return json_pack("{s:[f, f], s:[f, f], s:f, s:f, s:i}", "factor", known->factor[JP_GROUND_ROLLING],
                     known->factor[JP_GROUND_FRICTION], "deviation", known->deviation[JP_GROUND_ROLLING],
                     known->deviation[JP_GROUND_FRICTION], "straight_j_per_m", known->take.straight,
                     "turning_j_per_rad", known->take.turning, "legs", (int)known->legs);
}

static json_t *json_trip(const struct ground_trip *trip, json_t *track)
{
    json_t *metres = json_array();
    json_t *known = json_array();

    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        (void)json_array_append_new(metres, json_real(trip->metres_on[k]));
        (void)json_array_append_new(known, json_known(&trip->known[k]));
    }
    return json_pack("{s:s, s:b, s:f, s:f, s:f, s:f, s:o, s:o, s:o}", "state",
                     navigation_state_name(trip->result.state), "touched", trip->result.is_touched, "energy_j",
                     trip->result.joules, "forecast_j", trip->result.forecast_joules, "forecast_deviation_j",
                     trip->result.deviation_joules, "length_m", trip->result.length_m, "metres_on", metres, "known",
                     known, "track_m", track);
}

static json_t *json_grounds(const struct map_file *map, const struct ground_take truth[JP_GROUND_CLASSES])
{
    json_t *grounds = json_array();

    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        (void)json_array_append_new(grounds, json_pack("{s:s, s:f, s:f, s:f, s:f}", "name", map->grounds[k].name,
                                                       "rolling", map->grounds[k].rolling, "friction",
                                                       map->grounds[k].friction, "straight_j_per_m", truth[k].straight,
                                                       "turning_j_per_rad", truth[k].turning));
    }
    return grounds;
}

static void print_trip(unsigned number, const char *memory, const struct ground_trip *trip)
{
    (void)printf("%4u  %-9s  %-11s  %8.1f  %8.1f  %8.2f  %8.2f  %8.2f  %8.2f\n", number, memory,
                 navigation_state_name(trip->result.state), trip->result.joules, trip->result.forecast_joules,
                 trip->metres_on[0], trip->metres_on[1], trip->metres_on[2], trip->metres_on[3]);
}

/* ---- Trips ---- */

static bool is_right(const struct ground_trip *trip)
{
    return trip->result.state == JP_NAVIGATOR_ARRIVED && !trip->result.is_touched;
}

/* All trips of one robot. False after one line on stderr. */
static bool go(const struct arguments *arguments, const struct ground_trips_task *task, const char *name, json_t *trips,
               bool *all_right)
{
    struct ground_trips_task again = *task;
    struct ground_memory memory = {.is_there = false};

    for (unsigned i = 0; i < arguments->trips; i++) {
        struct track track = {.map = task->map, .points = json_array()};
        struct ground_trip trip;

        again.seed = arguments->plan.common.seed + i;
        if (!ground_trip_drive(&again, &memory, keep_point, &track, &trip)) {
            json_decref(track.points);
            return false;
        }
        print_trip(i + 1, name, &trip);
        *all_right = *all_right && is_right(&trip);
        (void)json_array_append_new(trips, json_trip(&trip, track.points));
    }
    return true;
}

/* Exit status. */
static int compare(const struct arguments *arguments, const struct ground_trips_task *task)
{
    struct ground_take truth[JP_GROUND_CLASSES];
    json_t *trips[MEMORIES];
    bool all_right = true;
    bool is_done = output_directory(arguments->plan.common.output);
    char *path = realpath(arguments->plan.map_path, NULL);

    ground_trips_truth(task->robot, task->map, truth);
    (void)printf("trip  classes    outcome       energy J  forecast   on 0, m   on 1, m   on 2, m   on 3, m\n");
    for (int i = 0; i < (int)MEMORIES; i++) {
        struct ground_trips_task own = *task;

        own.keeps = i == (int)KEEPS;
        trips[i] = json_array();
        is_done = is_done && go(arguments, &own, memory_names[i], trips[i], &all_right);
    }
    json_t *summary = json_pack("{s:s, s:s, s:I, s:o, s:o, s:o}", "robot", task->robot->name, "map",
                                path != NULL ? path : arguments->plan.map_path, "seed",
                                (json_int_t)arguments->plan.common.seed, "grounds", json_grounds(task->map, truth),
                                memory_names[KEEPS], trips[KEEPS], memory_names[KEEPS_NOT], trips[KEEPS_NOT]);

    free(path);
    if (!is_done) {
        json_decref(summary);
    }
    if (!is_done || !output_json(arguments->plan.common.output, "summary.json", summary) || !output_commit()) {
        output_discard();
        return ERROR_EXIT;
    }
    return all_right ? EXIT_SUCCESS : NOT_ARRIVED_EXIT;
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_ROBOT(""),
        PLAN_OPTION_PLACES,
        {"trips", OPTION_TRIPS, "N", 0, "from start to goal (6)", 0},
        PLAN_OPTION_BLOCK(" (default: 1024)"),
        OPTION_SEED("of the noise of the first trip; one more with each"),
        OPTION_OUTPUT("build/grounds"),
        {0},
    };
    static const struct argp argp = {
        options,
        parse_option,
        "MAP.json",
        "A robot goes again and again over a map whose classes of ground (tools.design.import_map) take more or less, "
        "and keeps what it has learned of them between its trips; and so does one whose map tells no grounds apart.\v"
        "Exit status: 0 all trips arrived and touched nothing; 1 not: the outputs say why; 2 bad input, nothing was "
        "written.",
        NULL,
        NULL,
        NULL};
    static struct lattice_robot robot;
    struct arguments arguments = {
        .plan = {.common = {.output = "build/grounds", .seed = 1}, .memory = (size_t)MEMORY_KIB * 1024},
        .trips = TRIPS,
    };
    struct ground_trips_task task;
    struct map_file map;

    command_line_parse(&argp, argc, argv, &arguments);
    if (!lattice_robot_load(arguments.plan.common.robot, &robot) || !map_file_load(arguments.plan.map_path, &map)) {
        return ERROR_EXIT;
    }
    const int status = prepare(&arguments, &robot, &map, &task) ? compare(&arguments, &task) : ERROR_EXIT;

    map_file_free(&map);
    return status;
}
