/** A skid-steered or differential-drive robot and its pilot, as the application of a controller on CAN drives it. */
#ifndef JOULEPATH_HAL_APP_ECU_SKID_H
#define JOULEPATH_HAL_APP_ECU_SKID_H

#include <joulepath/skid_pilot.h>

#include "hal/app/ecu_robot.h"
#include "hal/can/route_link.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Its tables. What they show must stay. */
struct jp_ecu_skid_config {
    const struct jp_skid_robot_config *robot;
    const struct jp_skid_energy_model *energy;
    const struct jp_skid_learning *learning;
    const struct jp_path_limits *limits;
    jp_q24 corner;                        /**< how far inside a corner of a route it may pass, m; 0…8 */
    jp_q24 goal_corner;                   /**< the same on the way to a goal on a map: the navigator's margin at most */
    enum jp_stored stored;                /**< what jp_parameters_start() found */
    const struct jp_learned_state *state; /**< taken with JP_STORED_TAKEN, else it may be null; copied */
    const struct jp_gyro_scale *scale;    /**< the same of its gyro */
};

/** The members but `internal` may be read: the robot as its accessors say, the others from the background. */
struct jp_ecu_skid {
    struct jp_skid_robot robot;
    struct jp_skid_pilot pilot;
    enum jp_stored stored; /**< what of the stored state is in use, or why not */
    struct {
        struct jp_path_piece pieces[JP_SKID_PILOT_PIECES(JP_ROUTE_LENGTH_MAX)];
        const struct jp_skid_energy_model *model; /* that the telemetry tells */
        struct jp_skid_energy_model models[2];    /* one of them, as learned when the last route began */
        jp_q24 corner;
        jp_q24 goal_corner;
        jp_q16 cruise;        /* power at the highest speed, W */
        uint8_t waking_ticks; /* after a reset in motion, in which it is to be enabled */
        uint16_t begun;       /* legs whose ends were noted */
        uint16_t ended;       /* legs whose results were handed over */
        uint32_t end_tick;    /* of the leg that is driven, as planned */
        struct jp_ecu_result_box result;
    } internal;
};

/** Prepares robot and pilot for jp_ecu_init(). JP_ERR_ARGUMENT, JP_ERR_CONFIG: as jp_skid_robot_init() and
 *  jp_skid_pilot_init(). Not for ISRs. */
enum jp_status jp_ecu_skid_init(struct jp_ecu_skid *skid, const struct jp_ecu_skid_config *config,
                                struct jp_ecu_robot *robot, const char **field);

/** What it knows of its gyro now, to be kept. Not for ISRs. */
struct jp_gyro_scale jp_ecu_skid_gyro_scale(const struct jp_ecu_skid *skid);

#ifdef __cplusplus
}
#endif

#endif
