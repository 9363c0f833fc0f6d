/**
 * Moving objects around the robot: small objects that stand free in successive scans are tracked, and their velocities
 * are given to the shapes of the obstacles (obstacles.h), so that the elastic band keeps off their predicted places.
 *
 * An object is a run of points without a gap, at most `extent` across, nearer than what the beams beside it see.
 * Alpha-beta filters track its centre and both of its ends. What the robot passes shows another side: then one end
 * moves along it and the other stays, while both ends of an object that moves go its way. Part of libjoulepath_float;
 * nothing here is for ISRs.
 */
#ifndef JOULEPATH_MOVERS_H
#define JOULEPATH_MOVERS_H

#include <joulepath/obstacles.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_MOVERS_MAX 8

struct jp_movers_config {
    float extent;    /**< largest diameter of an object that may move, m; above 0 */
    float speed_min; /**< slower objects stand: the centre of the visible part may shift so fast, m/s; above 0 */
    float speed_max; /**< nothing moves faster, m/s; speed_min…JP_OBSTACLE_SPEED_MAX */
    float margin;    /**< error of a predicted place after one second, m; 0…JP_OBSTACLE_MARGIN_MAX */
};

/** A point that is tracked. */
struct jp_mover_point {
    struct jp_plane_point place;
    struct jp_plane_point velocity; /**< m/s */
};

struct jp_mover {
    struct jp_plane_point centre;
    struct jp_plane_point velocity; /**< m/s */
    struct jp_mover_point ends[2];  /**< of what is seen of it, counter-clockwise from the scanner */
    float radius;                   /**< of what was seen of it, m */
    uint8_t sightings;              /**< since it was first seen; saturates */
    uint8_t misses;                 /**< in a row */
};

/** The members may be read. */
struct jp_movers {
    struct jp_mover movers[JP_MOVERS_MAX];
    uint8_t count;
};

/** Forgets all movers. Constant time. */
void jp_movers_clear(struct jp_movers *movers);

/**
 * Takes the next scan, `period` s (0.001…10) after the last one, from a sensor whose pose is in a fixed frame. Nothing
 * changes when it fails: JP_ERR_ARGUMENT: a null pointer or a value out of its range; JP_ERR_UNRELIABLE: as
 * jp_obstacles_add_scan(). Work: beams + runs × JP_MOVERS_MAX.
 */
enum jp_status jp_movers_update(struct jp_movers *movers, const struct jp_movers_config *config,
                                const struct jp_scan_config *scan_config, const struct jp_scan *scan,
                                const struct jp_plane_pose *sensor, float period);

/** Gives the shapes of tracked movers their velocity and the margin. Work: shapes × JP_MOVERS_MAX. */
void jp_movers_mark(const struct jp_movers *movers, const struct jp_movers_config *config,
                    struct jp_obstacles *obstacles);

#ifdef __cplusplus
}
#endif

#endif
