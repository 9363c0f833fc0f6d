#include "src/local/patrol_sense.h"

#include <joulepath/count.h>
#include <stddef.h>

#include "src/base/plane.h"
#include "src/local/patrol_trodden.h"

bool jp_patrol_uses_laser(const struct jp_patrol *patrol)
{
    return patrol->config.teb.weights.laser_odometry > 0.0f;
}

static bool is_jump(const struct jp_patrol *patrol, const struct jp_plane_pose *laser)
{
    const struct jp_plane_pose away = jp_plane_relative(&patrol->pose, laser);

    return jp_plane_length(away.x, away.y) > patrol->config.jump ||
           jp_plane_magnitude(away.heading) > patrol->config.jump;
}

static void judge_laser(struct jp_patrol *patrol, const struct jp_patrol_input *input)
{
    patrol->internal.is_measured = false;
    if (!input->has_laser) {
        patrol->counts.laser_missing++;
    } else if (input->is_new_place) {
        (void)jp_patrol_set_pose(patrol, &input->laser);
        jp_movers_clear(&patrol->movers);
    } else if (is_jump(patrol, &input->laser)) {
        patrol->counts.laser_rejected++;
        patrol->internal.jumps = jp_one_more16(patrol->internal.jumps);
    } else {
        patrol->internal.is_measured = true;
        patrol->internal.laser = input->laser;
        patrol->internal.jumps = 0;
        patrol->internal.blind = 0.0f;
    }
}

void jp_patrol_predict_pose(struct jp_patrol *patrol, const struct jp_patrol_input *input)
{
    if (patrol->internal.has_wheels) {
        const struct jp_plane_pose motion = jp_plane_relative(&patrol->internal.wheels, &input->wheels);

        patrol->pose = jp_plane_compose(&patrol->pose, &motion);
        patrol->internal.blind += jp_plane_length(motion.x, motion.y);
    }
    patrol->internal.wheels = input->wheels;
    patrol->internal.has_wheels = true;
    patrol->internal.deviation = input->deviation;
    if (jp_patrol_uses_laser(patrol)) {
        judge_laser(patrol, input);
    }
}

void jp_patrol_correct_pose(struct jp_patrol *patrol)
{
    const struct jp_teb_weights *const weights = &patrol->config.teb.weights;

    if (patrol->internal.is_measured) {
        const float share = weights->laser_odometry / (weights->laser_odometry + weights->wheel_odometry);
        const struct jp_plane_pose *const seen = &patrol->internal.laser;

        patrol->pose.x += share * (seen->x - patrol->pose.x);
        patrol->pose.y += share * (seen->y - patrol->pose.y);
        patrol->pose.heading =
            jp_plane_wrap(patrol->pose.heading + share * jp_plane_wrap(seen->heading - patrol->pose.heading));
    }
}

void jp_patrol_look(struct jp_patrol *patrol, const struct jp_patrol_input *input)
{
    const struct jp_plane_pose sensor = jp_plane_compose(&patrol->pose, &input->sensor);
    const struct jp_plane_point centre = {patrol->pose.x, patrol->pose.y};
    const float period = patrol->config.period * (float)(patrol->internal.scan_gap + 1U);
    struct jp_obstacles seen;

    jp_obstacles_clear(&seen, &centre);
    if (input->scan.ranges == NULL ||
        jp_obstacles_add_scan(&seen, &patrol->config.scan, &input->scan, &sensor) != JP_OK) {
        patrol->counts.scans_missing++;
        patrol->internal.scan_gap = jp_one_more16(patrol->internal.scan_gap);
        return;
    }
    (void)jp_movers_update(&patrol->movers, &patrol->config.movers, &patrol->config.scan, &input->scan, &sensor,
                           period);
    jp_patrol_note_steps(patrol);
    jp_movers_mark(&patrol->movers, &patrol->config.movers, &seen);
    patrol->internal.scan_gap = 0;
    patrol->obstacles = seen;
    patrol->counts.shapes_dropped += seen.dropped;
}
