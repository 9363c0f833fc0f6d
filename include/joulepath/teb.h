/**
 * Timed elastic band (Rösmann et al., ROBOTIK 2012) for a robot that drives forward and turns in place: n poses and the
 * n − 1 intervals between them, optimised together.
 *
 * Residuals, each times the root of its weight; c and s are the sums of the cosines and sines of two neighbouring
 * headings, d the step between the poses, l = (c dx + s dy)/2 the signed length of the step, ΔT_ref the reference
 * interval:
 * - non-holonomic: c dy − s dx
 * - speed: (l − speed_max ΔT)/ΔT_ref and (−l − reverse_max ΔT)/ΔT_ref, where above 0
 * - turn rate: (|Δθ| − turn_rate_max ΔT)/ΔT_ref, where above 0
 * - turn radius: (radius_min |Δθ| − |l|)/ΔT_ref, where above 0
 * - acceleration: |Δv|/ΔT − acceleration and |Δω|/ΔT − turn_acceleration, where above 0, from the start's to the goal's
 * - obstacles: clearance − distance of the footprint, where above 0
 * - path: distance from the path to be followed
 * - time: √(2 ΔT), so that each second costs the same
 * - way: √(2 √(l² + δ²)) with δ = 1 cm, so that each metre does
 * - drag: l √(2/ΔT): what a metre costs more the faster it is driven, in proportion
 * - no reversing: −l/ΔT_ref, where above 0
 * - odometry: first pose against the wheels' prediction and against the laser's measurement
 *
 * The derivatives are analytic, by the lengths, turns and intervals of the steps; from their few products the normal
 * equations of the poses are put together, which are banded, three blocks of 4 × 4 wide. A fixed number of
 * Levenberg–Marquardt steps, each in O(n), solves them in the object's own memory. A cycle whose distances to obstacles
 * would take too long ends with fewer steps: with 3 rounds of 4 steps and a path of 60 points, none takes more than
 * 3 million instructions on a Cortex-M7.
 *
 * Single-precision floating point without fused operations: part of libjoulepath_float, for cores with an FPU. The
 * sines are those of fixed.h, cached for each pose. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_TEB_H
#define JOULEPATH_TEB_H

#include <joulepath/obstacles.h>
#include <joulepath/point.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_TEB_POSES_MAX 50
#define JP_TEB_POSES_MIN 3
#define JP_TEB_NEAR_MAX  4 /**< obstacles that act on one pose: the nearest */

/** Footprint and obstacle may overlap by so much and count as separate, m: scans enlarge obstacles. */
#define JP_TEB_OVERLAP_MAX 0.02f

/** Weights of the squared residuals; 0 or more. Half of each square counts, so second, metre and drag are what a
 * second, a metre, and a metre at 1 m/s cost: in proportion to the joules that they take, the price of time included,
 * the band is one of least energy, at the speed √(second/drag) where nothing limits it. `obstacle` is the price of
 * clearance. */
struct jp_teb_weights {
    float nonholonomic;
    float speed;
    float turn_rate;
    float turn_radius;
    float acceleration;
    float turn_acceleration;
    float obstacle;
    float path;
    float second;
    float metre;
    float drag;
    float no_reversing;   /**< 0: reversing is allowed */
    float wheel_odometry; /**< of the first pose; if this and laser_odometry are 0, it is the wheels' pose */
    float laser_odometry;
};

struct jp_teb_config {
    float speed_max;         /**< m/s; above 0 */
    float reverse_max;       /**< m/s; above 0 */
    float turn_rate_max;     /**< rad/s; above 0 */
    float acceleration;      /**< m/s²; above 0 */
    float turn_acceleration; /**< rad/s²; above 0 */
    float radius_min;        /**< m; 0 or more */
    struct jp_footprint footprint;
    float clearance;  /**< wanted between footprint and obstacles, m; 0 or more */
    float interval;   /**< ΔT_ref, s; above 0 */
    float hysteresis; /**< ΔT_hyst, s; above 0, below the interval */
    uint8_t rounds;   /**< of association of obstacles; 1…8 */
    uint8_t steps;    /**< of Levenberg and Marquardt in a round; 1…16 */
    struct jp_teb_weights weights;
};

/** Forward speed, m/s, and turn rate, rad/s. */
struct jp_plane_speed {
    float forward;
    float turn_rate;
};

/** Start, goal and path of a plan. */
struct jp_teb_task {
    struct jp_plane_pose start;    /**< by the wheels */
    struct jp_plane_pose measured; /**< by the laser */
    bool is_measured;              /**< false: dropped out or not to be trusted; the residual is left out */
    struct jp_plane_speed speed;   /**< now */
    struct jp_plane_pose goal;
    bool is_heading_free;        /**< of the goal: any heading will do */
    float goal_speed;            /**< m/s; 0…speed_max */
    const struct jp_point *path; /**< to be followed, from near the start to the goal */
    uint16_t path_count;         /**< 2 or more */
};

/** A pose of the band. */
struct jp_teb_pose {
    struct jp_plane_pose pose;
    float cosine;
    float sine;
    float interval; /**< to the next pose, s */
};

/** Result of an optimisation. */
struct jp_teb_result {
    struct jp_plane_pose start;  /**< the first pose: wheels and laser together */
    struct jp_plane_speed speed; /**< to drive at until the next cycle; 0 unless JP_OK */
    struct jp_plane_speed first; /**< the same by the first step alone: nearer to the band, with more noise */
    float clearance;             /**< least distance of the band's footprints from obstacles that stand, m */
    float duration;              /**< s */
    float cost;
    uint16_t steps; /**< taken */
    uint16_t steps_rejected;
};

/** Of a pose: x, y, heading and interval. */
#define JP_TEB_BLOCK 4

/** Derivatives of one number by the variables of a pose, or a row of a block of the normal equations. */
struct jp_teb_row {
    float x;
    float y;
    float heading;
    float interval;
};

/** Private. */
struct jp_teb_internal {
    struct jp_teb_weights weights; /**< of lengths and turns, where the residual is over the reference interval */
    float root_nonholonomic;
    struct jp_teb_task task;
    const struct jp_obstacles *obstacles;
    struct jp_teb_neighbours {
        struct jp_plane_pose pose;       /**< where they were found */
        float time;                      /**< after which the robot will be there, s */
        float distance[JP_TEB_NEAR_MAX]; /**< from there, ascending */
        struct jp_plane_pose gradient[JP_TEB_NEAR_MAX];
        uint8_t shape[JP_TEB_NEAR_MAX];
        uint8_t feature[JP_TEB_NEAR_MAX]; /**< of the shape, nearest when it was last asked */
        uint8_t count;
    } near[JP_TEB_POSES_MAX];
    struct jp_teb_foot {
        struct jp_plane_point point;  /**< of the path, nearest to the pose */
        struct jp_plane_point normal; /**< of the path there */
    } feet[JP_TEB_POSES_MAX];
    struct jp_teb_terms {
        struct jp_teb_pose_terms {
            float xx, yx, yy, heading_x, heading_y, heading_heading;
            float x, y, heading; /**< gradient */
        } pose;
        struct jp_teb_step_terms {
            struct jp_plane_point along;      /**< derivatives of the length by the step's end */
            float length_by[2];               /**< and by the headings before and after */
            struct jp_plane_point side_along; /**< the same of the residual of the non-holonomic motion */
            float side_by[2];
            float side;
            struct jp_teb_way_terms {
                float way_way, way_interval;
                float way; /**< gradient */
            } length, turn;
            float length_turn, interval_interval;
            float interval; /**< gradient */
        } step;
        struct jp_teb_change_terms {
            struct jp_teb_way_change_terms {
                float way_way, way_interval, interval_way; /**< of this step, and of the next */
            } length, turn;
            float interval_interval;
        } change;
    } terms[2][JP_TEB_POSES_MAX]; /**< of the normal equations, by poses, steps and changes between two steps */
    uint8_t kept_terms;           /**< which of the two belong to the band before the last step */
    struct jp_teb_pose kept[JP_TEB_POSES_MAX]; /**< that band */
    /** The Cholesky factor, whose diagonal is kept as its inverse, and the step. */
    struct jp_teb_factor {
        struct jp_teb_row far[JP_TEB_BLOCK - 1]; /**< by the pose two before; nothing ties the interval to it */
        struct jp_teb_row near[JP_TEB_BLOCK];    /**< by the pose before */
        struct jp_teb_triangle {
            float xx;
            float yx, yy;
            float heading_x, heading_y, heading_heading;
            float interval_x, interval_y, interval_heading, interval_interval;
        } own;
        struct jp_teb_row step;
    } factor[JP_TEB_POSES_MAX];
    float damping;
    uint32_t work; /**< distances of obstacles that were computed in this cycle; overlaps count twice */
};

/** The members but `internal` may be read. About 29 KiB. */
struct jp_teb {
    struct jp_teb_config config;
    struct jp_teb_pose poses[JP_TEB_POSES_MAX];
    uint8_t count; /**< 0: no band yet */
    struct jp_teb_internal internal;
};

/** Prepares a band without poses. JP_ERR_CONFIG: *field names the first field out of range. JP_ERR_ARGUMENT: a null
 *  pointer. */
enum jp_status jp_teb_init(struct jp_teb *teb, const struct jp_teb_config *config, const char **field);

/** Forgets the band: the next plan begins from the path. Constant time. */
void jp_teb_clear(struct jp_teb *teb);

/**
 * One cycle: the band of the last cycle, or the path where there is none, is cut to the task and optimised.
 * JP_ERR_ARGUMENT: a null pointer, a value that is not finite, a path too short or a goal speed out of its range.
 * JP_ERR_ZERO_LENGTH: start and goal are less than 1 mm apart.
 * JP_ERR_BLOCKED: the start's footprint overlaps an obstacle by more than JP_TEB_OVERLAP_MAX. JP_ERR_INFEASIBLE: the
 * band's does within the next 1.5 s, with one that stands, or the optimisation gave something that is not finite. After
 * these two the band is forgotten. Work: rounds × steps × poses; counted in tests/bench/FIGURES.md.
 */
enum jp_status jp_teb_plan(struct jp_teb *teb, const struct jp_teb_task *task, const struct jp_obstacles *obstacles,
                           struct jp_teb_result *result);

#ifdef __cplusplus
}
#endif

#endif
