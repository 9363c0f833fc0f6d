/** A trip (trip.h) of a robot that its sides steer, on level ground that differs from its file's. */
#ifndef JOULEPATH_SIM_MISSIONS_TRIP_SKID_H
#define JOULEPATH_SIM_MISSIONS_TRIP_SKID_H

#include "sim/missions/trip.h"
#include "sim/skid_steer/skid_robots.h"
#include "sim/skid_steer/skid_route.h"

struct trip_skid {
    struct trip trip; /**< without variation, ground, payload and model */
    struct skid_variation variation;
    double factor[JP_SKID_FACTORS]; /**< as learned, relative to the robot file */
};

/** Runs the trip of a seed. False after one line on stderr. */
bool trip_skid_run(struct trip_skid *skid, const struct skid_robot_entry *entry, const struct skid_steer_model *model,
                   uint64_t seed);

#endif
