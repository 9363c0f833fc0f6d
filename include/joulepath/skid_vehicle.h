/** A skid-steered or differential-drive robot with its pilot, as the navigator drives it. */
#ifndef JOULEPATH_SKID_VEHICLE_H
#define JOULEPATH_SKID_VEHICLE_H

#include <joulepath/skid_pilot.h>
#include <joulepath/vehicle.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Targets of a run that is surveyed at most. */
#define JP_SKID_RUN_MAX 16U

/** Pieces of its path: those of level ground, and as many again for what the lines rise by. */
#define JP_SKID_RUN_PIECES_MAX (2U * JP_SKID_PILOT_PIECES(JP_SKID_RUN_MAX))

/** Private: what runs take. */
struct jp_skid_sum {
    struct jp_skid_ground_sum energy;
    jp_q16 duration; /**< s */
};

/** Private: the run that is surveyed. */
struct jp_skid_survey {
    struct jp_path_piece pieces[JP_SKID_RUN_PIECES_MAX];
    struct jp_point start;
    struct jp_skid_run run;
    struct jp_skid_leg leg;         /**< the last one that was surveyed */
    struct jp_skid_sum before_last; /**< of the runs before */
    struct jp_skid_sum before;      /**< of those that were surveyed to their ends */
    struct jp_skid_sum sum;         /**< with what was surveyed of this one */
};

/** Private. */
struct jp_skid_vehicle {
    struct jp_skid_pilot *pilot;
    struct jp_skid_survey survey;
};

/** What the navigator drives by: of a pilot with memory for JP_SKID_RUN_MAX targets, and the robot that it was prepared
 *  for; both must stay. JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_skid_vehicle_init(struct jp_skid_vehicle *skid, struct jp_skid_pilot *pilot,
                                    struct jp_vehicle *vehicle);

#ifdef __cplusplus
}
#endif

#endif
