/**
 * A path that is driven: set-points in time, and the law that steers the robot back to them.
 *
 * Every JP_TICKS_PER_PATH_POINT ticks jp_path_drive_advance() gives pose, speed and turn rate of the next set-point
 * with their derivatives, and jp_path_drive_track() what a robot at a measured pose has to do (Kanayama, Kimura,
 * Miyazaki and Noguchi, A stable tracking control method, ICRA 1990, linearised). With the errors of the robot in the
 * frame of the set-point, ahead, to the left and turned to the left,
 *
 *   speed     = v − pace (ahead − move)
 *   turn rate = w − max(2 v/way, pace) (turned + (left + lead)/(2 way) − lean)
 *
 * where the last two terms aim at the path, at most half a radian: on the spot the more the less is left to turn up to
 * one radian, and in a last turn not at all. So an error to the side falls with the way driven, at v above pace way/2
 * critically damped, by 1/e over about `way`, and the others with time. Both corrections are bounded.
 *
 * Tyres that scrub hold a robot on a slope only while their slip points uphill, so where it turns it slides aside, up
 * to a = half its wheelbase a radian, whatever its sides do (skid_odometry.h). `lead` is what is made up for before of
 * what it will slide to the left on the next two ways: half of it, and half after. A turn on the spot by γ needs less:
 * while the robot is `move` ahead of its place, on the side where that turns it back to it, it comes back by move a
 * radian. With e as the most that it is away, before, within and after,
 *
 *   lead = e = slide/(2 + 0.65 γ),  |move| = 0.87 min(e, 2 (e − |left|)): |(left, move)| <= e, and 0.65 e in the mean
 *
 * e is that of what is left to turn and to slide from where it is. The least that any motion of its sides leaves is,
 * within 3 % up to half a turn, slide/(2 + π/4 γ): then it is e away all the time. A slope that is steadily aside is
 * met with a heading that is as steadily off, and a turn on the spot ends in the heading that the way after it wants,
 * because each turn more would slide, too.
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

/** Ticks of a set-point: one each for the next one, for what is ahead, and for the way back to it. */
#define JP_TICKS_PER_PATH_POINT 3

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

/** How the robot slides where the ground slopes, what its wheels do not show. By a grade of 1 to the left, m to the
 *  right; by_left by a grade of 1 ahead, to the left. */
struct jp_path_slide {
    jp_q24 ahead;    /**< grade, uphill above 0; ±1 */
    jp_q24 left;     /**< the same to the left */
    jp_q24 by_turn;  /**< by the radian that it turns, either way, m; 0…64 */
    jp_q24 by_left;  /**< by the radian that it turns to the left, m; 0…8 */
    jp_q24 most;     /**< of what a radian makes it slide, m: it turns between its axles; 0…4 */
    jp_q24 by_way;   /**< by the metre, either way; 0…1 */
    jp_q24 per_most; /**< 1/most, 1/m; any where most is 0 */
};

/** What is driven from a place on; private. */
struct jp_path_stretch {
    jp_q24 turn; /**< to the left, rad */
    jp_q24 way;  /**< m */
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
    uint16_t looked_at; /**< pieces that look_ahead() has been over, from that of its begin on */
    uint16_t looked_from;
    struct jp_path_stretch seen; /**< of them */
    jp_q24 leads;                /**< what is made up for before, of what it slides in turns to the left, m */
    jp_q24 lead;                 /**< when it was last at its end */
    jp_q24 lean;                 /**< how far it shall be turned to the left of the path, against what it slides, rad */
    bool is_to_lean;             /**< next time, instead of looking ahead */
    jp_q24 turn_slides;          /**< on what is left of a turn on the spot, to the left, m; 0: it is on none */
    jp_q24 turn_share;           /**< of the most that this takes it from its place */
    jp_q24 move;                 /**< ahead of the set-point, m */
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

/** Looks at one more of the next three pieces, within twice `way`, for what the robot will slide there, and then at
 *  what it leans; once for each set-point. Constant time; for the control ISR. */
void jp_path_drive_look_ahead(struct jp_path_drive *drive, const struct jp_path_slide *slide);

/** The motion that leads a robot at a measured pose to the set-point; once for each. Constant time; for the control
 *  ISR. */
void jp_path_drive_track(struct jp_path_drive *drive, const struct jp_path_set_point *set_point,
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
