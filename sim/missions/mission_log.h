/** The log of a mission as CSV: what the robot did, row by row. */
#ifndef JOULEPATH_SIM_MISSIONS_MISSION_LOG_H
#define JOULEPATH_SIM_MISSIONS_MISSION_LOG_H

#include <stdio.h>

#include "sim/missions/scenario.h"

/** Log rows a second. */
#define MISSION_LOG_RATE 50

/** One row of the log. */
struct mission_row {
    double time; /**< since the start, s */
    struct bezier_point position;
    struct bezier_point reference;
    double heading;   /**< rad */
    double speed;     /**< m/s */
    double turn_rate; /**< rad/s */
    double reference_speed;
    double reference_turn_rate;
    double pitch_deg;
    double voltage_left; /**< V */
    double voltage_right;
    double current_left; /**< A */
    double current_right;
    double energy; /**< since the start, of the scenario's kind, J */
    size_t leg;    /**< from 0 */
};

void mission_log_header(FILE *log);
void mission_log_row(FILE *log, const struct scenario *scenario, const struct mission_row *row);

#endif
