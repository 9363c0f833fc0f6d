/**
 * A path that is driven: set-points in time, and the law that steers the robot back to them.
 *
 * Every JP_TICKS_PER_SET_POINT ticks jp_path_drive_advance() gives pose, speed and turn rate of the next set-point with
 * their derivatives, and jp_path_drive_track() what a robot at a measured pose has to do (Kanayama, Kimura, Miyazaki
 * and Noguchi, A stable tracking control method, ICRA 1990, linearised). With the errors of the robot in the frame of
 * the set-point, ahead, to the left and turned to the left,
 *
 *   speed     = v − pace ahead
 *   turn rate = w − max(2 v/way, pace) (turned + left/(2 way))
 *
 * where the last term aims at the path, at most half a radian, and not on the spot. So an error to the side falls with
 * the way driven, at v above pace way/2 critically damped, by 1/e over about `way`, and the others with time. Both
 * corrections are bounded.
 *
 * Speeds follow the path, not the clock: where a set-point's time ends within a piece does not matter, so nothing adds
 * up but the rounding of a step, and each piece begins where the path says.
 */
#ifndef JOULEPATH_PATH_DRIVE_H
#define JOULEPATH_PATH_DRIVE_H

#include <joulepath/energy.h>
#include <joulepath/lattice_path.h>
#include <joulepath/trajectory.h>

#ifdef __cplusplus
extern "C" {
#endif

struct jp_path_drive_config {
    uint32_t tick_rate;               /**< of the robot, 1/s; 100…10 000 */
    jp_q24 way;                       /**< m; 0.01…8 */
    jp_q24 pace;                      /**< 1/s; 0…64 */
    jp_q24 speed_correction;          /**< most, either way, m/s; 0…8 */
    jp_radians_per_s turn_correction; /**< rad/s; 0…8 */
};

/** What the robot has to follow. */
struct jp_path_set_point {
    struct jp_path_pose pose; /**< m on the map */
    jp_q31 cosine;            /**< direction of travel in the middle of the last step */
    jp_q31 sine;
    struct jp_motion motion;  /**< v and w */
    jp_q24 acceleration;      /**< v̇, m/s² */
    jp_q24 turn_acceleration; /**< ẇ, rad/s² */
};

/** Private. */
struct jp_path_drive_internal {
    struct jp_path_drive_config config;
    const struct jp_lattice_path *path;
    int64_t x; /**< m in Q40 */
    int64_t y;
    int32_t period;    /**< of a set-point, s in Q32 */
    int32_t pace_rate; /**< set-points a second */
    jp_q24 per_way;    /**< 1/way, 1/m */
    jp_q24 speed;      /**< m/s, or rad/s of a turn on the spot */
    jp_q24 progress;   /**< on the piece, m or rad */
    uint16_t piece;
};

/** The members are private. */
struct jp_path_drive {
    struct jp_path_drive_internal internal;
};

/** Copies the configuration; there is no path yet. JP_ERR_CONFIG: *field names the first field out of range.
 *  JP_ERR_ARGUMENT: a pointer is null. Not for ISRs. */
enum jp_status jp_path_drive_init(struct jp_path_drive *drive, const struct jp_path_drive_config *config,
                                  const char **field);

/** Begins a path whose speeds are planned (path_speed.h), at its begin and at rest; path and pieces must stay until it
 *  is driven. Constant time; for the control ISR. */
void jp_path_drive_begin(struct jp_path_drive *drive, const struct jp_lattice_path *path);

/** The next set-point; false: the path is driven, or there is none, and *set_point is not written. The last one is at
 *  rest at the path's end. Constant time; for the control ISR. */
bool jp_path_drive_advance(struct jp_path_drive *drive, struct jp_path_set_point *set_point);

/** The motion that leads a robot at a measured pose to the set-point. Constant time; for the control ISR. */
void jp_path_drive_track(const struct jp_path_drive *drive, const struct jp_path_set_point *set_point,
                         const struct jp_path_pose *pose, struct jp_motion *motion);

/** The piece that is driven; the count of pieces when all are. */
static inline uint16_t jp_path_drive_piece(const struct jp_path_drive *drive)
{
    return drive->internal.piece;
}

#ifdef __cplusplus
}
#endif

#endif
