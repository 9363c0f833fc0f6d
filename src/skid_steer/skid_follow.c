#include "src/skid_steer/skid_follow.h"

#include "src/base/integer.h"

void jp_skid_follow_begin(struct jp_skid_follow *follow, const struct jp_lattice_path *path)
{
    jp_path_drive_begin(&follow->drive, path);
    follow->path = path;
    follow->motion = (struct jp_motion){0, 0};
    follow->acceleration = 0;
    follow->at.acceleration = 0;
    follow->at.turn_acceleration = 0;
    follow->next = JP_SKID_FOLLOW_ADVANCE;
}

void jp_skid_follow_end(struct jp_skid_follow *follow)
{
    follow->path = NULL;
}

static void advance(struct jp_skid_follow *follow)
{
    if (jp_path_drive_advance(&follow->drive, &follow->at)) {
        follow->next = JP_SKID_FOLLOW_LOOK_AHEAD;
    } else {
        follow->path = NULL;
    }
}

static void look_ahead(struct jp_skid_follow *follow, const struct jp_skid_odometry *odometry,
                       const struct jp_skid_odometry_config *config)
{
    struct jp_path_slide slide;

    jp_skid_odometry_slide(odometry, config, &slide);
    jp_path_drive_look_ahead(&follow->drive, &slide);
    follow->next = JP_SKID_FOLLOW_TRACK;
}

static void track(struct jp_skid_follow *follow, const struct jp_skid_odometry *odometry,
                  const struct jp_skid_odometry_config *config)
{
    const jp_q24 before = follow->motion.speed;
    struct jp_path_pose pose;

    jp_skid_odometry_now(odometry, config, &pose.position, &pose.heading);
    jp_path_drive_track(&follow->drive, &follow->at, &pose, &follow->motion);
    follow->acceleration =
        jp_saturate32(jp_multiply(follow->motion.speed - before, (int32_t)config->tick_rate / JP_TICKS_PER_PATH_POINT));
    follow->next = JP_SKID_FOLLOW_ADVANCE;
}

void jp_skid_follow_work(struct jp_skid_follow *follow, const struct jp_skid_odometry *odometry,
                         const struct jp_skid_odometry_config *config)
{
    if (follow->path == NULL) {
        return;
    }
    switch (follow->next) {
    case JP_SKID_FOLLOW_LOOK_AHEAD:
        look_ahead(follow, odometry, config);
        break;
    case JP_SKID_FOLLOW_TRACK:
        track(follow, odometry, config);
        break;
    case JP_SKID_FOLLOW_ADVANCE:
    default:
        advance(follow);
        break;
    }
}
