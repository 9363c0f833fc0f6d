/**
 * A robot with four steered wheels, a laser scanner and a map, and its pilot, as the application of a controller on CAN
 * drives it. Wheels and scanner are on the bus (wheel_link.h, scan_link.h), or the board's own.
 */
#ifndef JOULEPATH_HAL_APP_ECU_PATROL_H
#define JOULEPATH_HAL_APP_ECU_PATROL_H

#include <joulepath/patrol_pilot.h>

#include "hal/app/ecu_robot.h"
#include "hal/can/scan_link.h"
#include "hal/can/wheel_link.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Its tables, and the memory for what is made of a map. What they show must stay, but for *pilot and *state. */
struct jp_ecu_patrol_config {
    const struct jp_four_wheel_robot_config *robot;
    const struct jp_patrol_pilot_config *pilot;
    void *block; /**< aligned to 8; jp_patrol_pilot_size() bytes of the largest map */
    size_t size;
    enum jp_stored stored;                /**< what jp_parameters_start() found */
    const struct jp_learned_state *state; /**< taken with JP_STORED_TAKEN, else it may be null; copied */
};

/** What the background last knew, for the tick to tell. */
struct jp_ecu_patrol_view {
    struct jp_plane_pose pose;
    float position_deviation;
    float heading_deviation;
    uint8_t patrol_state;
    uint8_t patrol_reason;
    uint8_t localiser_state;
    uint8_t localiser_reason;
};

/** The members but `internal` may be read: the robot as its accessors say, the others from the background. */
struct jp_ecu_patrol {
    struct jp_four_wheel_robot robot;
    struct jp_patrol_pilot pilot;
    enum jp_stored stored; /**< what of the stored state is in use, or why not */
    struct {
        struct jp_patrol_pilot_config tables;
        void *block;
        size_t size;
        struct jp_four_wheel_hal hal;
        bool has_board;
        struct jp_ecu_bus bus;
        struct jp_wheel_link wheels;
        uint8_t target_counter;
        struct jp_scan_link scans;
        bool scan_begins;
        struct jp_four_wheel_odometry scan_begun; /* where the wheels were */
        struct jp_four_wheel_odometry scan_whole; /* of the scan that waits */
        struct jp_four_wheel_odometry scan_used;
        float ranges[JP_SCAN_LINK_BEAMS];
        enum jp_status plan;
        bool is_to_goal; /* what it drives to is a goal on the map, else a route */
        uint16_t ended;  /* legs whose results were handed over */
        struct jp_ecu_result_box result;
        struct jp_ecu_patrol_view views[2];
        uint8_t view; /* 1 + that which may be told; 0: there is no map */
    } internal;
};

/** Prepares robot and pilot for jp_ecu_init(). JP_ERR_ARGUMENT, JP_ERR_CONFIG: as jp_four_wheel_robot_init() and
 *  jp_patrol_pilot_init(); *field may also be "scanner.beams": beyond JP_SCAN_LINK_BEAMS. Not for ISRs. */
enum jp_status jp_ecu_patrol_init(struct jp_ecu_patrol *patrol, const struct jp_ecu_patrol_config *config,
                                  struct jp_ecu_robot *robot, const char **field);

/** Wheels, supply and scanner are the board's own. Right after jp_ecu_init(), like jp_ecu_use_board(), which is not for
 *  this kind; what hal->context shows must stay. */
void jp_ecu_patrol_use_board(struct jp_ecu_patrol *patrol, const struct jp_four_wheel_hal *hal);

/** The board's scanner begins a scan: the wheels are where the last tick saw them. At the priority of the tick. */
void jp_ecu_patrol_begin_scan(struct jp_ecu_patrol *patrol);

/** A slice of its work in the background, with the scan that waits. */
void jp_ecu_patrol_work(struct jp_ecu_patrol *patrol);

#ifdef __cplusplus
}
#endif

#endif
