#include "src/skid_steer/skid_follow.h"

void jp_skid_follow_begin(struct jp_skid_follow *follow, const struct jp_lattice_path *path)
{
    jp_path_drive_begin(&follow->drive, path);
    follow->path = path;
    follow->motion = (struct jp_motion){0, 0};
    follow->at.acceleration = 0;
    follow->at.turn_acceleration = 0;
    follow->is_new = false;
}

void jp_skid_follow_end(struct jp_skid_follow *follow)
{
    follow->path = NULL;
}

void jp_skid_follow_look_ahead(struct jp_skid_follow *follow, const struct jp_skid_odometry *odometry,
                               const struct jp_skid_odometry_config *config)
{
    if (follow->path == NULL) {
        return;
    }
    if (follow->is_new) {
        struct jp_path_pose pose;

        jp_skid_odometry_now(odometry, config, &pose.position, &pose.heading);
        jp_path_drive_track(&follow->drive, &follow->at, &pose, &follow->motion);
        follow->is_new = false;
    } else if (jp_path_drive_advance(&follow->drive, &follow->at)) {
        follow->is_new = true;
    } else {
        follow->path = NULL;
    }
}
