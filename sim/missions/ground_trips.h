/** A skid-steered or differential-drive robot that goes again and again over a map of several grounds, and keeps
 * between its trips what it has learned of itself and of them. */
#ifndef JOULEPATH_SIM_MISSIONS_GROUND_TRIPS_H
#define JOULEPATH_SIM_MISSIONS_GROUND_TRIPS_H

#include <joulepath/ground_learner.h>
#include <joulepath/skid_odometry.h>

#include "sim/files/map_file.h"
#include "sim/lattice/lattice_robot.h"
#include "sim/missions/navigation.h"
#include "sim/missions/plan_task.h"

struct ground_trips_task {
    const struct lattice_robot *robot; /**< of skid steer or differential drive */
    const struct map_file *map;        /**< its classes and what they are like are those of the world */
    const struct jp_lattice *lattice;  /**< by which it finds its way */
    struct plan_task places;
    size_t memory; /**< of the planner, bytes */
    uint64_t seed; /**< of all noise */
    bool keeps;    /**< false: its map tells no grounds apart, and what it learns is of itself alone */
};

/** What a class takes on level ground: J/m straight on, J/rad on the spot, at the usual motion of the lattice. */
struct ground_take {
    double straight;
    double turning;
};

/** What is known of a class. */
struct ground_known {
    double factor[JP_GROUND_FACTORS];
    double deviation[JP_GROUND_FACTORS];
    struct ground_take take; /**< by the model as learned */
    unsigned legs;           /**< that taught it */
};

struct ground_trip {
    struct navigation_result result;
    double metres_on[JP_GROUND_CLASSES];          /**< driven on each class */
    struct ground_known known[JP_GROUND_CLASSES]; /**< after it */
};

/** Between the trips. */
struct ground_memory {
    struct jp_learned_state robot;
    struct jp_learned_state grounds[JP_GROUND_CLASSES];
    struct jp_gyro_scale scale; /**< all zero: nothing is known */
    bool is_there;              /**< there was a trip before */
};

/** What each class of a map takes truly, by the plant. */
void ground_trips_truth(const struct lattice_robot *robot, const struct map_file *map,
                        struct ground_take truth[JP_GROUND_CLASSES]);

/** A trip from start to goal, from what the memory holds, which is kept then. `watch` and its context as of struct
 *  navigation_task. False after one line on stderr. */
bool ground_trip_drive(const struct ground_trips_task *task, struct ground_memory *memory,
                       void (*watch)(void *context, const struct navigation_frame *frame), void *context,
                       struct ground_trip *trip);

#endif
