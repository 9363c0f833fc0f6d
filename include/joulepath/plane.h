/**
 * Points and poses on the plane, in single precision.
 */
#ifndef JOULEPATH_PLANE_H
#define JOULEPATH_PLANE_H

#ifdef __cplusplus
extern "C" {
#endif

/** A point, m; ±32 767. Also a velocity, m/s, or a direction, where its user says so. */
struct jp_plane_point {
    float x;
    float y;
};

/** A position, ±32 767 m, and a heading, rad, counterclockwise from the x axis; it wraps: any value of −1 000…1 000. */
struct jp_plane_pose {
    float x;
    float y;
    float heading;
};

#ifdef __cplusplus
}
#endif

#endif
