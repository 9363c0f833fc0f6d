/**
 * Laser odometry: each scan is laid over a key scan by point-to-line ICP (Censi, "An ICP variant using a point-to-line
 * metric", 2008; doi 10.1109/ROBOT.2008.4543181).
 *
 * Lines are fitted to the neighbourhood of each point of the key scan. Each point of the scan takes the line of the
 * nearest point of the key scan, found among the ordered bearings; the worst pairs are trimmed, and the others weighted
 * in Gauss–Newton steps. Where the guess leads to no fit, the motion before is tried. Where the walls do not tell a
 * direction, such as along a corridor, the guess stands. Poses are the scanner's, in the frame of the first one. No
 * map, no loop closing: the error grows with the way.
 */
#ifndef JOULEPATH_SIM_SCAN_MATCH_H
#define JOULEPATH_SIM_SCAN_MATCH_H

#include <stdbool.h>

#include "laser.h"
#include "planar.h"

/** A scan becomes the new key scan beyond these from the old one, or when fewer of its points fit than this share. */
#define SCAN_MATCH_KEY_DISTANCE 0.5               /* m */
#define SCAN_MATCH_KEY_TURN     (15 * M_PI / 180) /* rad */
#define SCAN_MATCH_KEY_INLIERS  0.5

/** Least points that a scan, and pairs that a match must have. */
#define SCAN_MATCH_POINTS_MIN 30

/** A match with a smaller share of inliers, or a larger residual, has gone wrong. */
#define SCAN_MATCH_INLIERS_MIN  0.4
#define SCAN_MATCH_RESIDUAL_MAX 0.025 /* m */

/** A match farther than this from the guess is a jump. */
#define SCAN_MATCH_JUMP_DISTANCE 0.3               /* m */
#define SCAN_MATCH_JUMP_TURN     (15 * M_PI / 180) /* rad */

/** A direction is weak when the mean square of the lines' normals along it is below this. */
#define SCAN_MATCH_WEAK 0.01

enum scan_match_status {
    SCAN_MATCH_OK,
    SCAN_MATCH_FEW_POINTS, /**< of the scan or the pairs; the pose is the guess */
    SCAN_MATCH_DIVERGED,   /**< no fit; the pose is the guess */
    SCAN_MATCH_JUMP        /**< the scans fit, but far from the guess: one is wrong; the pose is the fit */
};

struct scan_match_result {
    enum scan_match_status status;
    struct planar_pose pose; /**< of the scanner in the frame of the first one */
    double residual;         /**< root mean square of the inliers' distances from their lines, m */
    double inlier_share;     /**< of the scan's points */
    /** Normal equations of the fit in pose.x, pose.y and the heading, for residuals of a standard deviation of 1 m. */
    double information[3][3];
    double weakest;  /**< smallest eigenvalue over the pairs, with turns as arcs of 1 m radius; below SCAN_MATCH_WEAK:
                          degenerate */
    double weak[3];  /**< its eigenvector in pose.x, pose.y and the heading */
    bool degenerate; /**< the guess stands along `weak` */
    bool new_key;    /**< this scan is the key scan from now on */
    int iterations;
};

struct scan_match_line {
    struct planar_point point;  /**< of the key scan */
    struct planar_point centre; /**< of the points that the line is fitted to */
    struct planar_point normal;
    bool fitted; /**< false: a corner, an edge or alone */
};

struct scan_matcher {
    struct planar_pose pose;   /**< of the last scan */
    struct planar_pose motion; /**< to it, from the one before, in that one's frame */
    struct planar_pose key;    /**< pose of the key scan */
    bool has_key;
    int beams; /**< of the key scan */
    double first;
    double step;
    bool around;                   /**< the last beam is beside the first one */
    double sines[LASER_BEAMS_MAX]; /**< of multiples of the step, up to a quarter turn */
    float ranges[LASER_BEAMS_MAX];
    struct scan_match_line lines[LASER_BEAMS_MAX];
};

/** Before the first scan, which will be at `pose`. */
void scan_match_init(struct scan_matcher *matcher, const struct planar_pose *pose);

/**
 * Matches the next scan. `motion`: guess of the scanner's motion since the last one, in that one's frame, such as by
 * wheel odometry; NULL: as the motion before. Work: some ten times the beams, each with a short search.
 */
void scan_match_next(struct scan_matcher *matcher, const struct laser_scan *scan, const struct planar_pose *motion,
                     struct scan_match_result *result);

#endif
