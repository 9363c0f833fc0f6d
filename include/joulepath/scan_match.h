/**
 * Laser odometry: each scan is matched to a key scan by point-to-line ICP (Censi, "An ICP variant using a point-to-line
 * metric", 2008; doi 10.1109/ROBOT.2008.4543181).
 *
 * Lines are fitted to the neighbourhood of each point of the key scan. Each point of the scan takes the line of the
 * nearest point of the key scan, found among the ordered bearings; the worst pairs are trimmed, and the others weighted
 * in Gauss–Newton steps. Where the guess leads to no fit, the previous motion is tried. In a direction that the walls
 * do not determine, such as along a corridor, the pose stays that of the guess. Poses are the scanner's, in the frame
 * of the first one. There is no map and no loop closure: the error grows with the distance.
 *
 * Memory: one block of the caller, 64 B a beam. Single-precision floating point: part of libjoulepath_float. Nothing
 * here is for ISRs.
 */
#ifndef JOULEPATH_SCAN_MATCH_H
#define JOULEPATH_SCAN_MATCH_H

#include <joulepath/obstacles.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Beams of a scan. */
#define JP_SCAN_MATCH_BEAMS_MAX 4096U

/** A scan becomes the new key scan beyond these from the old one, m and rad, or when fewer of its points fit than this
 *  share. */
#define JP_SCAN_MATCH_KEY_DISTANCE 0.5f
#define JP_SCAN_MATCH_KEY_TURN     0.26179939f
#define JP_SCAN_MATCH_KEY_INLIERS  0.5f

/** Least points that a scan, and pairs that a match must have. */
#define JP_SCAN_MATCH_POINTS_MIN 30

/** A match with a smaller share of inliers, or a larger residual, m, has gone wrong. */
#define JP_SCAN_MATCH_INLIERS_MIN  0.4f
#define JP_SCAN_MATCH_RESIDUAL_MAX 0.025f

/** A match farther than this from the guess, m and rad, is a jump. */
#define JP_SCAN_MATCH_JUMP_DISTANCE 0.3f
#define JP_SCAN_MATCH_JUMP_TURN     0.26179939f

/** A direction is weak when the mean square of the lines' normals along it is below this. */
#define JP_SCAN_MATCH_WEAK 0.01f

enum jp_match {
    JP_MATCH_FITS,
    JP_MATCH_FEW_POINTS, /**< of the scan or the pairs; the pose is the guess */
    JP_MATCH_DIVERGED,   /**< no fit; the pose is the guess */
    JP_MATCH_JUMP        /**< the scans fit, but far from the guess: fit or guess is wrong; the pose is the fit */
};

struct jp_match_result {
    enum jp_match match;
    struct jp_plane_pose pose; /**< of the scanner in the frame of the first one */
    float residual;            /**< root mean square of the inliers' distances from their lines, m */
    float inlier_share;        /**< of the scan's points */
    /** Normal equations of the fit in pose.x, pose.y and the heading, for residuals of a standard deviation of 1 m. */
    float information[3][3];
    float weakest;      /**< smallest eigenvalue of the information per pair, with turns as arcs of 1 m radius */
    float weak[3];      /**< its eigenvector in pose.x, pose.y and the heading */
    bool is_degenerate; /**< `weakest` is below JP_SCAN_MATCH_WEAK: along `weak` the pose is that of the guess */
    bool is_new_key;    /**< this scan is the key scan from now on */
    uint8_t iterations;
};

/** A line of the key scan. Private. */
struct jp_match_line {
    struct jp_plane_point point;
    struct jp_plane_point centre; /**< of the points that the line is fitted to */
    struct jp_plane_point normal;
    bool is_fitted; /**< false: a corner, an edge or alone */
};

/** A point of the scan on a line of the key scan. Private. */
struct jp_match_pair {
    struct jp_plane_point arm; /**< of the point from the scanner, in the key's axes */
    struct jp_plane_point normal;
    float residual; /**< m */
};

/** Private. */
struct jp_scan_matcher_internal {
    struct jp_plane_pose key; /**< pose of the key scan */
    bool has_key;
    int32_t beams_max;
    int32_t beams; /**< of the key scan */
    float middle;  /**< bearing between its first beam and its last */
    float step;
    bool is_around;               /**< the last beam is beside the first one */
    float *ranges;                /**< of the key scan */
    float *sines;                 /**< of multiples of the step, up to a quarter turn */
    struct jp_match_line *lines;  /**< for each of its beams */
    struct jp_plane_point *cloud; /**< of the scan, in the scanner's frame */
    int32_t cloud_count;
    struct jp_match_pair *pairs;
};

/** The members but `internal` may be read. */
struct jp_scan_matcher {
    struct jp_plane_pose pose;   /**< of the last scan */
    struct jp_plane_pose motion; /**< to it, from the one before, in that one's frame */
    struct jp_scan_matcher_internal internal;
};

/** Bytes of the block for scans of up to so many beams; 0 when they are not 2…JP_SCAN_MATCH_BEAMS_MAX. */
size_t jp_scan_matcher_size(uint16_t beams_max);

/** Prepares in `size` bytes of the caller, to begin at the pose 0. JP_ERR_ARGUMENT: a null pointer or beams_max.
 *  JP_ERR_MEMORY: `size` is below jp_scan_matcher_size(). JP_ERR_ALIGNMENT: `block` is not aligned to 8 bytes. */
enum jp_status jp_scan_matcher_init(struct jp_scan_matcher *matcher, uint16_t beams_max, void *block, size_t size);

/** Begins anew: the next scan will be taken at `pose`. JP_ERR_ARGUMENT: a null pointer or a pose out of range. Constant
 *  time. */
enum jp_status jp_scan_matcher_start(struct jp_scan_matcher *matcher, const struct jp_plane_pose *pose);

/**
 * Matches the next scan. `motion`: guess of the scanner's motion since the last one, in that one's frame, such as by
 * wheel odometry; null: as the motion before. JP_ERR_ARGUMENT: another pointer is null, the scan has no ranges, more
 * beams than beams_max, or values out of the range of struct jp_scan, or the motion is no pose; then nothing changes.
 * Work: at most 75 times the beams, as a rule 10 times, each with a short search.
 */
enum jp_status jp_scan_match(struct jp_scan_matcher *matcher, const struct jp_scan *scan,
                             const struct jp_plane_pose *motion, struct jp_match_result *result);

#ifdef __cplusplus
}
#endif

#endif
