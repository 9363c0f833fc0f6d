/**
 * What a leg of a patrol will take: from its path, by the energy model of four_wheel_energy.h.
 *
 * The plan of a leg is a robot alone on its path: it turns as the patrol would (patrol.h), speeds up, goes as fast as
 * the path's bends allow, stops, and turns to the goal's heading; where the path ends before the goal it drives
 * straight in from there. What is in the way makes legs longer than that; by how much is learned from legs that were
 * driven, of the whole patrol and of each of its legs.
 *
 * Single-precision floating point: part of libjoulepath_float. Not for ISRs.
 */
#ifndef JOULEPATH_PATROL_FORECAST_H
#define JOULEPATH_PATROL_FORECAST_H

#include <joulepath/four_wheel_energy.h>
#include <joulepath/patrol.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A leg that is planned. */
struct jp_patrol_plan {
    struct jp_plane_pose start;
    const struct jp_point *path; /**< 2 points or more */
    uint16_t path_count;
    struct jp_patrol_goal goal;
    uint32_t tick_rate;              /**< of the wheels' control, 1/s: jp_four_wheel_tick() */
    const struct jp_terrain *ground; /**< the map of the path, whose elevations make slopes; null: level */
};

/** Adds a leg to a drive on a model, and its duration, s, to *duration. The configuration must have passed
 *  jp_patrol_init(). JP_ERR_ARGUMENT: a null pointer, too few points, or no tick rate. Work: points of the path; with
 *  elevations two heights of the map for each. */
enum jp_status jp_patrol_plan_energy(const struct jp_patrol_config *config,
                                     const struct jp_four_wheel_energy_model *model, const struct jp_patrol_plan *plan,
                                     struct jp_four_wheel_drive *drive, float *duration);

/** How many times as much a plan takes when the robot's factors (four_wheel_learner.h) are others than those of the
 * model that it was planned on: by its changes, at least
 *  ¼. 1 for a plan that takes nothing. */
float jp_patrol_plan_ratio(const struct jp_four_wheel_drive *plan, const jp_q16 before[JP_FOUR_WHEEL_FACTORS],
                           const jp_q16 after[JP_FOUR_WHEEL_FACTORS]);

/** How much more legs take than they are planned to. All zero at first. */
struct jp_patrol_pace {
    float planned; /**< sums over legs, of which old ones are forgotten */
    float driven;
    float square; /**< of what forecasts missed, relative */
    uint32_t legs;
};

/** Takes a leg: energies as planned and as driven, above 0; planned by what was learned from this leg, too, or what it
 *  taught of the robot would count twice. `prior`: factor before anything is known, such as that of
 *  all legs for one of them; 1 for those. */
void jp_patrol_pace_learn(struct jp_patrol_pace *pace, float prior, float planned, float driven);

/** Factor of a leg's energy over what is planned. */
float jp_patrol_pace_factor(const struct jp_patrol_pace *pace, float prior);

/** Standard deviation of a leg about its forecast, as a share of it. */
float jp_patrol_pace_deviation(const struct jp_patrol_pace *pace);

#ifdef __cplusplus
}
#endif

#endif
