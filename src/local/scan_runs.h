/** What a scan saw, as runs of points side by side. Private to libjoulepath_float. */
#ifndef JOULEPATH_LOCAL_SCAN_RUNS_H
#define JOULEPATH_LOCAL_SCAN_RUNS_H

#include <joulepath/obstacles.h>

struct jp_scan_view {
    const struct jp_scan_config *config;
    const struct jp_scan *scan;
    struct jp_plane_pose first; /* of beam 0, from the sensor */
};

/** The points from a beam to another, both of which saw something, without a gap. */
struct jp_scan_run {
    unsigned first;
    unsigned last;
    unsigned points;
};

/** As jp_obstacles_add_scan(). */
enum jp_status jp_scan_open(struct jp_scan_view *view, const struct jp_scan_config *config, const struct jp_scan *scan,
                            const struct jp_plane_pose *sensor);

/** Whether there are ranges of two or more beams, and their angles are in range. */
bool jp_scan_is_sound(const struct jp_scan *scan);

/** Whether a beam saw something within range. */
bool jp_scan_is_point(const struct jp_scan_view *view, unsigned beam);

struct jp_plane_point jp_scan_point(const struct jp_scan_view *view, unsigned beam);

/** The first run from a beam on; false when there is none. */
bool jp_scan_next_run(const struct jp_scan_view *view, unsigned beam, struct jp_scan_run *run);

/** The beam towards a place; may be beyond those of the scan. */
uint32_t jp_scan_beam_towards(const struct jp_scan_view *view, struct jp_plane_point place);

/** Whether a beam, one of the scan, sees farther than a distance, m. One that saw nothing tells no more than that
 * nothing is within range. */
bool jp_scan_reaches(const struct jp_scan_view *view, uint32_t beam, float distance);

#endif
