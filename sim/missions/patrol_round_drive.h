/** Hours of patrol of a robot on a map: by the library itself, or by a controller on a bus, which gets map and round
 * from an operator. The robot begins at its charger, with a full battery. */
#ifndef JOULEPATH_SIM_MISSIONS_PATROL_ROUND_DRIVE_H
#define JOULEPATH_SIM_MISSIONS_PATROL_ROUND_DRIVE_H

#include "hal/linux/can_link.h"
#include "sim/four_wheel/four_wheel_file.h"
#include "sim/missions/patrol_round_file.h"
#include "sim/missions/patrol_round_record.h"

enum patrol_round_outcome {
    PATROL_ROUND_WENT_ON,  /**< until the time was over */
    PATROL_ROUND_GAVE_UP,  /**< the reason says why */
    PATROL_ROUND_COLLIDED, /**< touched something */
    PATROL_ROUND_STRANDED, /**< the battery was empty */
    PATROL_ROUND_OUTCOMES
};

extern const char *const patrol_round_outcomes[PATROL_ROUND_OUTCOMES];
extern const char *const patrol_round_reasons[JP_ROUND_REASON_MAP_GONE + 1];

struct patrol_round_task {
    const struct four_wheel_file *robot;
    const struct patrol_scene *scene; /**< it starts at the charger */
    const struct patrol_round_file *file;
    uint64_t seed;
    double hours; /**< from when the robot has its task */
    FILE *log;
};

struct patrol_round_result {
    enum patrol_round_outcome outcome;
    struct patrol_round_record record;
    size_t map_bytes;     /**< over the bus; 0: there was none */
    uint64_t late;        /**< ticks whose command did not come in time */
    uint64_t fingerprint; /**< of the plant's states of all ticks; over a bus also of the ECU's energies */
};

/** False after one line on stderr: no memory, or no tables of the robot are built in. */
bool patrol_round_drive(const struct patrol_round_task *task, struct patrol_round_result *result);

/** The same over a bus; the link stays open. False also when the map does not go over the bus, or the ECU does not
 *  answer, or refuses it. */
bool patrol_round_drive_on_bus(const struct patrol_round_task *task, const struct jp_can_link *link, unsigned patience,
                               struct patrol_round_result *result);

#endif
