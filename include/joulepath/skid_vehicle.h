/**
 * A skid-steered or differential-drive robot as the navigator drives it: each run becomes a path of straight lines,
 * turns on the spot and, where that costs less, arcs round its corners (path_corner.h), at the speeds of least energy
 * and time by its price. What each run takes is measured and learned from (skid_learner.h).
 *
 * What lines rise by is part of what they take, as far as the pieces of a run tell it. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_SKID_VEHICLE_H
#define JOULEPATH_SKID_VEHICLE_H

#include <joulepath/line_path.h>
#include <joulepath/path_corner.h>
#include <joulepath/skid_learner.h>
#include <joulepath/skid_path_energy.h>
#include <joulepath/skid_robot.h>
#include <joulepath/vehicle.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Targets of a run at most. */
#define JP_SKID_RUN_MAX 16U

/** Pieces of its path: those of level ground, and as many again for what the lines rise by. */
#define JP_SKID_RUN_PIECES (2U * JP_LINE_PATH_PIECES(JP_SKID_RUN_MAX))

struct jp_skid_vehicle_config {
    struct jp_skid_robot *robot;     /**< prepared */
    struct jp_path_limits limits;    /**< of what it drives by itself */
    struct jp_skid_learner *learner; /**< started; its model prices the motions */
    jp_q16 time;                     /**< what a second less is worth, W; 0…16 384 */
    jp_q24 corner;                   /**< how far inside a corner it may pass, m; 0…8; 0: it turns on the spot */
};

/** Private: a run as a path. */
struct jp_skid_run {
    struct jp_path_piece pieces[JP_SKID_RUN_PIECES];
    struct jp_lattice_path path;
    uint16_t first[JP_SKID_RUN_MAX]; /**< piece of each line */
    uint16_t count;                  /**< lines */
    struct jp_skid_drive drive; /**< by the model that the learner had then */
    jp_q16 duration;            /**< s */
};

/** Private: what runs take. */
struct jp_skid_sum {
    struct jp_forecast_sum energy;
    jp_q16 duration; /**< s */
};

/** Private. */
struct jp_skid_vehicle {
    struct jp_skid_vehicle_config config;
    struct jp_skid_run driven;
    struct jp_skid_run surveyed;
    uint16_t survey_count; /**< targets of the run that is surveyed */
    uint16_t survey_done;
    struct jp_point survey_start;
    struct jp_skid_sum before; /**< of the runs before it */
    struct jp_skid_sum sum;    /**< with it, once it is surveyed */
    jp_energy energy_before;       /**< of the meter when the driven run began */
    bool is_learning;              /**< from the run that is driven */
};

/** What the navigator drives by. *config is copied; what it shows must stay. JP_ERR_CONFIG: *field names the first
 *  member out of range. JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_skid_vehicle_init(struct jp_skid_vehicle *skid, const struct jp_skid_vehicle_config *config,
                                    struct jp_vehicle *vehicle, const char **field);

#ifdef __cplusplus
}
#endif

#endif
