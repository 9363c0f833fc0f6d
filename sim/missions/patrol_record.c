#include "sim/missions/patrol_record.h"

#include <math.h>

#define DEGREES         (180 / M_PI)
#define SNAPSHOT_PERIOD 1.0 /* s */

void patrol_record_init(struct patrol_record *record, FILE *log)
{
    *record = (struct patrol_record){.log = log, .plans = json_array(), .snapshots = json_array()};
    (void)fprintf(log, "t_s,x_m,y_m,heading_deg,believed_x_m,believed_y_m,believed_heading_deg,speed_m_s,"
                       "turn_rate_rad_s,angle_front_left_deg,angle_front_right_deg,angle_rear_left_deg,"
                       "angle_rear_right_deg,clearance_m,energy_j,state,reason\n");
}

void patrol_record_free(struct patrol_record *record)
{
    json_decref(record->plans);
    json_decref(record->snapshots);
}

/* ---- Log ---- */

static double angle_deg(int32_t angle)
{
    return angle * (360 / 4294967296.0);
}

static void write_line(FILE *log, const struct patrol_view *view)
{
    (void)fprintf(log, "%.2f,%.4f,%.4f,%.2f,%.4f,%.4f,%.2f,%.4f,%.4f", view->time, (double)view->true_pose.x,
                  (double)view->true_pose.y, (double)view->true_pose.heading * DEGREES, (double)view->believed.x,
                  (double)view->believed.y, (double)view->believed.heading * DEGREES, (double)view->true_speed.forward,
                  (double)view->true_speed.turn_rate);
    for (int i = 0; i < JP_WHEELS; i++) {
        (void)fprintf(log, ",%.2f", angle_deg(view->wheels->angle[i]));
    }
    (void)fprintf(log, ",%.4f,%.2f,%d,%d\n", view->clearance, view->energy_j, (int)view->state, (int)view->reason);
}

/* ---- Plans ---- */

static json_t *json_points(const struct jp_point *points, size_t count)
{
    json_t *array = json_array();

    for (size_t i = 0; i < count; i++) {
        (void)json_array_append_new(
            array, json_pack("[f, f]", (double)points[i].x / JP_Q16_ONE, (double)points[i].y / JP_Q16_ONE));
    }
    return array;
}

static void keep_plan(struct patrol_record *record, const struct patrol_view *view)
{
    (void)json_array_append_new(record->plans, json_pack("{s:f, s:o, s:o}", "time_s", view->time, "way_m",
                                                         json_points(view->grid_path, view->grid_path_count), "path_m",
                                                         json_points(view->path, view->path_count)));
    record->replans = view->replans;
}

/* ---- Snapshots ---- */

static json_t *json_band(const struct jp_patrol *patrol)
{
    json_t *band = json_array();

    for (int i = 0; patrol != NULL && patrol->state == JP_PATROL_DRIVING && i < patrol->teb.count; i++) {
        const struct jp_plane_pose *pose = &patrol->teb.poses[i].pose;
        (void)json_array_append_new(band, json_pack("[f, f]", (double)pose->x, (double)pose->y));
    }
    return band;
}

static json_t *json_shape(const struct planar_shape *shape)
{
    const bool is_disc = shape->kind == PLANAR_DISC;

    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "x_m", shape->pose.x, "y_m", shape->pose.y, "heading_deg",
                     shape->pose.heading * DEGREES, "radius_m", is_disc ? shape->radius : 0, "length_m",
                     is_disc ? 0 : 2 * shape->half_length, "width_m", is_disc ? 0 : 2 * shape->half_width);
}

static void keep_snapshot(struct patrol_record *record, const struct patrol_view *view)
{
    json_t *shapes = json_array();

    for (size_t i = 0; i < view->world->shape_count; i++) {
        (void)json_array_append_new(shapes, json_shape(&view->world->shapes[i]));
    }
    (void)json_array_append_new(
        record->snapshots, json_pack("{s:f, s:o, s:o, s:[f, f, f]}", "time_s", view->time, "band_m",
                                     json_band(view->patrol), "obstacles", shapes, "pose", (double)view->true_pose.x,
                                     (double)view->true_pose.y, (double)view->true_pose.heading * DEGREES));
    record->next_snapshot += SNAPSHOT_PERIOD;
}

void patrol_record_observe(void *context, const struct patrol_view *view)
{
    struct patrol_record *record = context;

    write_line(record->log, view);
    if (json_array_size(record->plans) == 0 || view->replans > record->replans) {
        keep_plan(record, view);
    }
    if (view->time >= record->next_snapshot) {
        keep_snapshot(record, view);
    }
}
