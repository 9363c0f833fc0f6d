/** A balancing robot with its pilot, as the navigator drives it. */
#ifndef JOULEPATH_BALANCER_VEHICLE_H
#define JOULEPATH_BALANCER_VEHICLE_H

#include <joulepath/pilot.h>
#include <joulepath/vehicle.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Private: what runs take. */
struct jp_balancer_sum {
    struct jp_forecast_sum energy;
    jp_q16 duration; /**< s */
};

/** Private: the run that is surveyed. */
struct jp_balancer_survey {
    struct jp_trajectory_task task;
    struct jp_trajectory_plan plan;
    struct jp_trajectory trajectory;
    struct jp_trajectory_leg leg;
    jp_q24 modes[JP_TRAVEL_MODES];
    jp_angle heading; /**< at the begin of the next leg */
    struct jp_energy_model model;
    struct jp_balancer_sum before_last; /**< of the runs before */
    struct jp_balancer_sum before;      /**< of those that were surveyed to their ends */
    struct jp_balancer_sum sum;         /**< with what was surveyed of this one */
};

/** Private. */
struct jp_balancer_vehicle {
    struct jp_pilot *pilot;
    struct jp_balancer_survey survey;
};

/** What the navigator drives by: of a pilot, and the robot that it was prepared for; both must stay. JP_ERR_ARGUMENT: a
 *  pointer is null. */
enum jp_status jp_balancer_vehicle_init(struct jp_balancer_vehicle *balancer, struct jp_pilot *pilot,
                                        struct jp_vehicle *vehicle);

#ifdef __cplusplus
}
#endif

#endif
