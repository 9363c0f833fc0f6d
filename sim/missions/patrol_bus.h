/** A scene driven over a bus: the controller is a node of its own, which gets map and goal from an operator, and sees
 *  and moves in frames. The result is judged as that of patrol_mission.h. */
#ifndef JOULEPATH_SIM_MISSIONS_PATROL_BUS_H
#define JOULEPATH_SIM_MISSIONS_PATROL_BUS_H

#include "sim/bus/bus_drive.h"
#include "sim/missions/patrol_mission.h"

struct patrol_bus {
    struct patrol_result result;
    struct bus_drive drive;
    struct patrol_body body;
    struct jp_navigation_operator commander;
    size_t stream_bytes; /**< of the map */
    double upload_s;
    double forecast_j; /**< of the leg, by the ECU; 0: it told none */
    double deviation_j;
    double metered_j;     /**< of the leg, by the ECU; 0: it told none */
    uint64_t fingerprint; /**< of the plant's states of all ticks and the ECU's energies: equal for equal runs */
};

/** Bytes of the scene's map as it goes over the bus, with where the robot starts; the caller frees them. NULL after one
 *  line on stderr: it is too large. */
uint8_t *patrol_bus_encode(const struct patrol_scene *scene, struct jp_map_stream *stream);

/** Drives the scene to its end. The link stays open. The goal is that of the scene to the middle of its cell. False
 * after one line on stderr: no memory, the map does not go over the bus, or the ECU does not answer, refuses it or has
 * a fault. */
bool patrol_bus_run(struct patrol_bus *bus, const struct four_wheel_file *robot, const struct patrol_scene *scene,
                    uint64_t seed, const struct jp_can_link *link, unsigned patience);

#endif
