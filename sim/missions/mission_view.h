/** Who looks on while a mission is driven. */
#ifndef JOULEPATH_SIM_MISSIONS_MISSION_VIEW_H
#define JOULEPATH_SIM_MISSIONS_MISSION_VIEW_H

#include "sim/missions/mission_log.h"

/** Members that are NULL do not look. */
struct mission_view {
    FILE *log;            /**< takes a row every 1/MISSION_LOG_RATE s */
    const char *progress; /**< name of the bar */
    /** Called as often as the log takes a row. */
    void (*record)(void *context, const struct mission_row *row);
    /** Called every tick with where the robot is, m and rad. */
    void (*watch)(void *context, struct bezier_point position, double heading);
    void *context;
};

/** Whether anybody wants rows; hands one to those who do. */
bool mission_view_wants_rows(const struct mission_view *view);
void mission_view_row(const struct mission_view *view, const struct scenario *scenario, const struct mission_row *row);

#endif
