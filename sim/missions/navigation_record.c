#include "sim/missions/navigation_record.h"

#include <math.h>
#include <unistd.h>

#include "sim/missions/plan_task.h"

/** Between two lines of the log, s. */
#define PERIOD 0.1

#define Q16 65536.0

/** Where nobody knows how probably it comes home. */
#define UNKNOWN (-1.0)

void navigation_record_init(struct navigation_record *record, const struct map_file *map, FILE *log)
{
    *record = (struct navigation_record){
        .log = log, .map = map, .courses = json_array(), .seen = json_array(), .is_live = isatty(STDERR_FILENO) == 1};
    (void)fprintf(log, "t_s,x_m,y_m,heading_deg,energy_j,state,reason,left_m,left_s,home_percent\n");
}

void navigation_record_free(struct navigation_record *record)
{
    json_decref(record->courses);
    json_decref(record->seen);
}

static void write_line(struct navigation_record *record, const struct navigation_frame *frame)
{
    const struct plan_place place = plan_map_place(record->map, &frame->pose);

    (void)fprintf(record->log, "%.2f,%.4f,%.4f,%.2f,%.3f,%s,%s,%.3f,%.2f,", frame->seconds, place.x, place.y,
                  place.heading_deg, frame->joules, navigation_state_name(frame->state),
                  navigation_reason_name(frame->reason), frame->left_m, frame->left_s);
    (void)fprintf(record->log, "%.2f\n", isnan(frame->probability) ? UNKNOWN : 100 * frame->probability);
}

static void show_line(struct navigation_record *record, const struct navigation_frame *frame)
{
    if (record->is_live) {
        (void)fprintf(stderr, "\r%7.1f s  %6.2f, %6.2f m  %6.1f J  %-11s %-14s %5.1f m left, replans %u \033[K",
                      frame->seconds, frame->pose.x, frame->pose.y, frame->joules, navigation_state_name(frame->state),
                      navigation_reason_name(frame->reason), frame->left_m, frame->replans);
    }
}

static void add_point(struct navigation_record *record, json_t *points, double x, double y)
{
    const struct plan_place place = plan_map_place(record->map, &(struct clearance_pose){x, y, 0});

    (void)json_array_append_new(points, json_pack("[f, f]", place.x, place.y));
}

static void keep_course(struct navigation_record *record, const struct navigation_frame *frame)
{
    json_t *points = json_array();
    const struct navigation_course *course = frame->new_course;

    add_point(record, points, frame->pose.x, frame->pose.y);
    for (uint16_t i = 0; i < course->count; i++) {
        add_point(record, points, course->ends[i].x / Q16, course->ends[i].y / Q16);
    }
    (void)json_array_append_new(record->courses, json_pack("{s:f, s:s, s:o}", "time_s", frame->seconds, "reason",
                                                           navigation_reason_name(frame->reason), "points_m", points));
}

void navigation_record_watch(void *context, const struct navigation_frame *frame)
{
    struct navigation_record *record = context;
    const enum jp_navigator_state state = frame->state;

    if (frame->seconds >= record->next_line || state != record->state) {
        write_line(record, frame);
        show_line(record, frame);
        record->next_line = frame->seconds + PERIOD;
    }
    if (frame->new_course != NULL) {
        keep_course(record, frame);
    }
    record->state = state;
}

void navigation_record_see(void *context, const struct navigation_sight *sight)
{
    struct navigation_record *record = context;

    (void)json_array_append_new(record->seen, json_pack("[i, i, f]", sight->x, sight->y, sight->seconds));
}

void navigation_record_end(struct navigation_record *record)
{
    if (record->is_live) {
        (void)fprintf(stderr, "\r\033[K");
    }
}
