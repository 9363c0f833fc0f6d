/**
 * Moving objects around the robot: objects that stand free in successive scans are tracked, and their velocities are
 * given to the shapes of the obstacles (obstacles.h), so that the elastic band keeps off their predicted places.
 *
 * An object is a run of points without a gap, at most `extent` across, nearer than what the beams beside it see, with a
 * rim at least at one of its ends, beyond which its surface does not go on. A Kalman filter of constant velocity tracks
 * its middle: of one that is partly hidden by the free rim, less exactly; of one that is seen as one with others no
 * more than that it is among them. The uncertainty of the velocity is known from the first scans on: an object walks
 * when it is faster than that explains, and it is where nothing was before, or nothing is where it was: what is seen of
 * a thing that stands may shift, but not so. What the scanner saw a second or two ago says where nothing was. Who has
 * walked is remembered as somebody who may walk on, or back, along the same line; who stands and is seen as one with
 * them, in their stead, until it is seen alone and stands.
 *
 * Part of libjoulepath_float; nothing here is for ISRs.
 */
#ifndef JOULEPATH_MOVERS_H
#define JOULEPATH_MOVERS_H

#include <joulepath/obstacles.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_MOVERS_MAX 24

/** Points by which it is remembered where a mover was first seen. */
#define JP_MOVER_POINTS 3

struct jp_movers_config {
    float extent;    /**< largest diameter of an object that may move, m; above 0 */
    float range;     /**< objects farther away are not looked for, m; above 0, at most 1 000 */
    float speed_min; /**< slower objects stand: the centre of the visible part may shift so fast, m/s; above 0 */
    float speed_max; /**< nothing moves faster, m/s; speed_min…JP_OBSTACLE_SPEED_MAX */
    float margin;    /**< error of a predicted place after one second, m; 0…JP_OBSTACLE_MARGIN_MAX */
};

struct jp_mover {
    struct jp_plane_point centre;
    struct jp_plane_point velocity;              /**< m/s */
    float radius;                                /**< of what was seen of it, m */
    float own;                                   /**< radius without those who are seen with it as one, m */
    float largest;                               /**< radius so far, m */
    struct jp_plane_point origin;                /**< where it was first seen */
    struct jp_plane_point seen_from;             /**< where the sensor was then */
    struct jp_plane_point seen[JP_MOVER_POINTS]; /**< of its surface then, from right to left */
    float place_variance;                        /**< of the centre along an axis, m² */
    float covariance;                            /**< of centre and velocity along an axis, m²/s */
    float speed_variance;                        /**< of the velocity along an axis, m²/s² */
    struct jp_plane_point walk;                  /**< direction in which it last walked; (0, 0): it has not */
    float pace;                                  /**< fastest that it was seen to walk, m/s */
    float standing;                              /**< since it last walked, s */
    struct jp_plane_point stood;                 /**< where it was when it last did */
    uint8_t sightings;                           /**< since it was first seen; saturates */
    uint8_t misses;                              /**< in a row */
    uint8_t alone;                               /**< sightings in a row without others seen with it; saturates */
    bool is_companion;                           /**< taken to walk because somebody does who is, or was, with it */
    bool has_come;                               /**< was first seen where nothing had been: no thing that stands */
};

/** Private: directions in which it is remembered what a scan saw. */
#define JP_MOVERS_PAST_BEAMS 180U

/** Private: a scan of a while ago. */
struct jp_movers_past {
    struct jp_plane_pose first; /**< of direction 0, from the sensor */
    float step;                 /**< from one direction to the next, rad */
    uint16_t count;             /**< 0: none */
    float ranges[JP_MOVERS_PAST_BEAMS];
};

/** The members but `past` and `past_age` may be read. */
struct jp_movers {
    struct jp_mover movers[JP_MOVERS_MAX];
    uint8_t count;
    struct jp_movers_past past[2]; /**< the later one and the earlier one */
    float past_age;                /**< of the later one, s */
};

/** Forgets all movers. Constant time. */
void jp_movers_clear(struct jp_movers *movers);

/**
 * Takes the next scan, `period` s (0.001…10) after the last one, after more than 0.5 s without what was known, from a
 * sensor whose pose is in a fixed frame. Nothing changes when it fails: JP_ERR_ARGUMENT: a null pointer or a value out
 * of its range; JP_ERR_UNRELIABLE: as jp_obstacles_add_scan(). Work: beams + (runs + JP_MOVERS_MAX) × JP_MOVERS_MAX.
 */
enum jp_status jp_movers_update(struct jp_movers *movers, const struct jp_movers_config *config,
                                const struct jp_scan_config *scan_config, const struct jp_scan *scan,
                                const struct jp_plane_pose *sensor, float period);

/** Whether it is faster than `speed_min` and than what the scans may err by. Constant time. */
bool jp_mover_is_walking(const struct jp_mover *mover, const struct jp_movers_config *config);

/** Gives the shapes of tracked movers their velocity and the margin. Work: shapes × JP_MOVERS_MAX. */
void jp_movers_mark(const struct jp_movers *movers, const struct jp_movers_config *config,
                    struct jp_obstacles *obstacles);

#ifdef __cplusplus
}
#endif

#endif
