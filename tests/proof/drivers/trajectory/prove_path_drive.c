// eva: -eva-slevel-function main:20
/** Any configuration that passes, any path, any pose and slide, for ever; another path at any time. */
#include <joulepath/path_drive.h>

#include "tests/proof/any_path.h"

static void any_slide(struct jp_path_slide *slide)
{
    slide->ahead = any_between(-JP_Q24_ONE, JP_Q24_ONE);
    slide->left = any_between(-JP_Q24_ONE, JP_Q24_ONE);
    slide->by_turn = any_between(0, JP_Q24(64));
    slide->by_left = any_between(0, JP_Q24(8));
    slide->most = any_between(0, JP_Q24(4));
    slide->by_way = any_between(0, JP_Q24_ONE);
    slide->per_most = any_int();
}

static void step(struct jp_path_drive *drive)
{
    static struct jp_path_set_point set_point;
    struct jp_path_slide slide;
    struct jp_path_pose pose;
    struct jp_motion motion;

    (void)jp_path_drive_advance(drive, &set_point);
    any_slide(&slide);
    jp_path_drive_look_ahead(drive, &slide);
    ANY(pose);
    jp_path_drive_track(drive, &set_point, &pose, &motion);
    (void)jp_path_drive_piece(drive);
}

int main(void)
{
    static struct jp_path_drive drive;
    struct jp_path_drive_config config;
    struct jp_lattice_path path;
    const char *field;

    ANY(config);
    if (jp_path_drive_init(&drive, &config, &field) != JP_OK) {
        return 0;
    }
    any_path(&path);
    jp_path_drive_begin(&drive, &path);
    ANY_TIMES
    {
        if (any_bool()) {
            jp_path_drive_begin(&drive, &path);
        }
        step(&drive);
    }
    ARRIVED();
    return 0;
}
