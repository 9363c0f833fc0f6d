#include "sim/missions/patrol_round_report.h"

#include <math.h>

#include "sim/missions/patrol_report.h"

#define DEGREES (180 / M_PI)

#define PLACE_SIZE 12

/* Stops are numbered from 1 for people. */
static const char *place_name(const struct patrol_round_record *record, unsigned place, char name[PLACE_SIZE])
{
    (void)snprintf(name, PLACE_SIZE, place < record->stops ? "stop %u" : "charger", place + 1);
    return name;
}

static bool came_home(const struct patrol_round_record *record)
{
    return record->told.charges > 0;
}

/* ---- Table ---- */

static void print_task(const struct patrol_round_task *task)
{
    const struct patrol_round_file *file = task->file;

    (void)printf("%s, seed %llu: a round of %u stops for %.2f h; robot %s\n", task->scene->name,
                 (unsigned long long)task->seed, file->stop_count, task->hours, task->robot->name);
    (void)printf(
        "battery %.0f J, of which %.0f J shall be left at the charger, with %.3f deviations; charger %.0f W\n\n",
        file->full_j, file->reserve_j, file->deviations, file->charger_w);
}

static void print_journey(const struct patrol_round_record *record, const struct patrol_journey *journey)
{
    char from[PLACE_SIZE];
    char to[PLACE_SIZE];

    (void)printf("%-8s %-8s %-12s %9.1f %8.1f %9.2f %11.1f %8.1f %9.1f %9.1f\n",
                 place_name(record, journey->from, from), place_name(record, journey->to, to),
                 patrol_journey_ends[journey->end], journey->begin_s, journey->time_s, journey->length_m,
                 journey->foretold_j, journey->deviation_j, journey->taken_j, journey->left_j);
}

static void print_counts(const struct patrol_round_result *result)
{
    const struct patrol_round_record *record = &result->record;

    (void)printf("\n%s%s%s: %u visits, %u charges, %u stops left out; %.1f m and %.0f J in %.0f s\n",
                 patrol_round_outcomes[result->outcome], result->outcome == PATROL_ROUND_GAVE_UP ? ": " : "",
                 result->outcome == PATROL_ROUND_GAVE_UP ? patrol_round_reasons[record->told.reason] : "",
                 record->told.visits, record->told.charges, record->told.skipped, record->length_m, record->energy_j,
                 record->time_s);
    if (came_home(record)) {
        (void)printf("least energy at home %.0f J; %u times less than the reserve; the robot's account of it at most "
                     "%.1f J off\n",
                     record->told.least_left_j, record->below_reserve, record->account_error_j);
    }
    if (result->map_bytes > 0) {
        (void)printf("map over the bus %zu bytes; fingerprint %016llx\n", result->map_bytes,
                     (unsigned long long)result->fingerprint);
    }
}

void patrol_round_print(const struct patrol_round_task *task, const struct patrol_round_result *result)
{
    const struct patrol_round_record *record = &result->record;

    print_task(task);
    /* The deviation's sign takes two bytes. */
    (void)printf("%-8s %-8s %-12s %9s %8s %9s %11s %9s %9s %9s\n", "from", "to", "outcome", "start s", "time s",
                 "length m", "foretold J", "± J", "taken J", "left J");
    for (unsigned i = 0; i < record->journey_count; i++) {
        print_journey(record, &record->journeys[i]);
    }
    print_counts(result);
}

/* ---- Summary ---- */

static json_t *json_journeys(const struct patrol_round_record *record)
{
    json_t *array = json_array();

    for (unsigned i = 0; i < record->journey_count; i++) {
        const struct patrol_journey *journey = &record->journeys[i];

        (void)json_array_append_new(
            array,
            json_pack("{s:i, s:i, s:s, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "from", (int)journey->from, "to",
                      (int)journey->to, "outcome", patrol_journey_ends[journey->end], "start_s", journey->begin_s,
                      "time_s", journey->time_s, "length_m", journey->length_m, "foretold_j", journey->foretold_j,
                      "deviation_j", journey->deviation_j, "taken_j", journey->taken_j, "left_j", journey->left_j));
    }
    return array;
}

static json_t *json_pose(const struct jp_plane_pose *pose)
{
    return json_pack("[f, f, f]", (double)pose->x, (double)pose->y, (double)pose->heading * DEGREES);
}

static json_t *json_stops(const struct patrol_round_task *task)
{
    const struct jp_patrol_round_config config = patrol_round_config_of(task->file, task->scene);
    json_t *array = json_array();

    for (unsigned i = 0; i < config.stop_count; i++) {
        (void)json_array_append_new(array, json_pack("{s:o, s:f}", "pose", json_pose(&config.stops[i].pose), "dwell_s",
                                                     (double)config.stops[i].dwell));
    }
    return array;
}

static json_t *json_battery(const struct patrol_round_task *task, const struct patrol_round_result *result)
{
    const struct patrol_round_record *record = &result->record;
    json_t *least = came_home(record) ? json_real(record->told.least_left_j) : json_null();

    return json_pack("{s:f, s:f, s:f, s:f, s:o, s:i, s:f}", "full_j", task->file->full_j, "reserve_j",
                     task->file->reserve_j, "charger_w", task->file->charger_w, "deviations", task->file->deviations,
                     "least_left_j", least, "below_reserve", (int)record->below_reserve, "account_error_j",
                     record->account_error_j);
}

json_t *patrol_round_json(const struct patrol_round_task *task, const struct patrol_round_result *result,
                          const char *map_path)
{
    const struct patrol_round_record *record = &result->record;
    const bool gave_up = result->outcome == PATROL_ROUND_GAVE_UP;
    char fingerprint[20];

    (void)snprintf(fingerprint, sizeof fingerprint, "%016llx", (unsigned long long)result->fingerprint);
    return json_pack("{s:s, s:s, s:s, s:[f, f], s:I, s:f, s:s, s:s, s:i, s:i, s:i, s:f, s:f, s:f, s:o, s:o, s:o, s:o, "
                     "s:o, s:s, s:I, s:I, s:s}",
                     "kind", "round", "robot", task->robot->name, "scene", task->scene->name, "robot_size_m",
                     task->robot->body.length_m, task->robot->body.width_m, "seed", (json_int_t)task->seed, "hours",
                     task->hours, "outcome", patrol_round_outcomes[result->outcome], "reason",
                     gave_up ? patrol_round_reasons[record->told.reason] : "", "visits", (int)record->told.visits,
                     "charges", (int)record->told.charges, "skipped", (int)record->told.skipped, "time_s",
                     record->time_s, "length_m", record->length_m, "energy_j", record->energy_j, "map",
                     patrol_report_map(task->scene, map_path), "charger", json_pose(&task->scene->start), "stops",
                     json_stops(task), "battery", json_battery(task, result), "journeys", json_journeys(record), "log",
                     PATROL_ROUND_LOG, "map_bytes", (json_int_t)result->map_bytes, "commands_late",
                     (json_int_t)result->late, "fingerprint", fingerprint);
}
