#include "src/local/patrol_marking.h"

#include <stddef.h>

#include "src/base/plane.h"
#include "src/local/patrol_marks.h"

/* Of a beam, expansions. */
#define BEAM_WORK 4U

/* That are copied in an expansion's time. */
#define CELLS_OF_EXPANSION 64U

static void copy_row(struct jp_patrol_mission *mission, int32_t y)
{
    const struct jp_terrain *const given = mission->config.map;

    for (int32_t x = 0; x < (int32_t)given->config.width; x++) {
        (void)jp_terrain_set_cell(&mission->internal.marked, x, y, jp_terrain_cell(given, x, y));
    }
}

void jp_patrol_marking_forget_now(struct jp_patrol_mission *mission)
{
    for (int32_t y = 0; y < (int32_t)mission->config.map->config.height; y++) {
        copy_row(mission, y);
    }
    mission->internal.rows_stale = 0;
}

/* Scans do not change them. */
static void copy_elevations(struct jp_patrol_mission *mission)
{
    const struct jp_terrain *const given = mission->config.map;

    for (int32_t y = 0; y < (int32_t)given->config.height; y++) {
        for (int32_t x = 0; x < (int32_t)given->config.width; x++) {
            (void)jp_terrain_set_elevation(&mission->internal.marked, x, y, jp_terrain_elevation(given, x, y));
        }
    }
}

void jp_patrol_marking_forget(struct jp_patrol_mission *mission)
{
    mission->internal.rows_stale = mission->config.map->config.height;
}

void jp_patrol_marking_start(struct jp_patrol_mission *mission)
{
    jp_patrol_marking_forget_now(mission);
    copy_elevations(mission);
}

static void go_on_forgetting(struct jp_patrol_mission *mission, unsigned expansions)
{
    const unsigned rows = expansions * CELLS_OF_EXPANSION / mission->config.map->config.width + 1U;

    for (unsigned i = 0; i < rows && mission->internal.rows_stale > 0U; i++) {
        mission->internal.rows_stale--;
        copy_row(mission, (int32_t)mission->internal.rows_stale);
    }
}

static void take_scan(struct jp_patrol_mission *mission, const struct jp_patrol_input *input)
{
    mission->internal.scan = input->scan;
    mission->internal.scanner = jp_plane_compose(&mission->patrol.pose, &input->sensor);
}

void jp_patrol_marking_begin(struct jp_patrol_mission *mission, const struct jp_patrol_input *input,
                             enum jp_patrol_marks marks)
{
    take_scan(mission, input);
    mission->internal.scan.ranges = input->is_lost ? NULL : input->scan.ranges;
    mission->internal.marks = marks;
    mission->internal.beam = 0;
    if (marks != JP_MARKS_WATCH) {
        mission->state = JP_MISSION_PLANNING;
    }
}

void jp_patrol_marking_see(struct jp_patrol_mission *mission, const struct jp_patrol_input *input)
{
    if (input->scan.ranges != NULL && !input->is_lost) {
        take_scan(mission, input);
    }
}

/* Of some beams; true: of all. */
static bool make_marks(struct jp_patrol_mission *mission, unsigned expansions)
{
    const struct jp_scan *const scan = &mission->internal.scan;
    const unsigned left = (unsigned)scan->count - mission->internal.beam;
    const unsigned beams = expansions / BEAM_WORK + 1U;
    const uint16_t end = (uint16_t)(mission->internal.beam + (beams < left ? beams : left));

    if (scan->ranges == NULL) {
        return true;
    }
    jp_patrol_clear_ways(mission->config.map, &mission->internal.marked, scan, &mission->internal.scanner,
                         mission->config.patrol.scan.tolerance, mission->internal.beam, end);
    mission->internal.beam = end;
    if (end < scan->count) {
        return false;
    }
    jp_patrol_mark_ends(mission->config.map, &mission->internal.marked, scan, &mission->internal.scanner,
                        mission->config.patrol.scan.tolerance);
    return true;
}

bool jp_patrol_marking_is_due(const struct jp_patrol_mission *mission)
{
    return mission->internal.rows_stale > 0U || mission->internal.marks != JP_MARKS_NONE;
}

bool jp_patrol_marking_work(struct jp_patrol_mission *mission, unsigned expansions)
{
    if (mission->internal.rows_stale > 0U) {
        go_on_forgetting(mission, expansions);
        return false;
    }
    return make_marks(mission, expansions);
}
