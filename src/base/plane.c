#include "src/base/plane.h"

/* The copies that are called where the compiler does not write the function in line. */
extern inline float jp_plane_of_q32(int64_t value);
extern inline float jp_plane_wrap(float angle);
extern inline jp_angle jp_plane_angle(float angle);
extern inline float jp_plane_sine(float angle);
extern inline float jp_plane_cosine(float angle);
extern inline struct jp_plane_point jp_plane_direction(float angle);
extern inline float jp_plane_bearing(float x, float y);
extern inline struct jp_plane_pose jp_plane_compose(const struct jp_plane_pose *frame,
                                                    const struct jp_plane_pose *pose);
extern inline struct jp_plane_pose jp_plane_relative(const struct jp_plane_pose *frame,
                                                     const struct jp_plane_pose *pose);
extern inline float jp_plane_magnitude(float x);
