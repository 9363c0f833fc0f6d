/** Single-precision arithmetic of the plane. Private to libjoulepath_float. */
#ifndef JOULEPATH_BASE_PLANE_H
#define JOULEPATH_BASE_PLANE_H

#include <float.h>
#include <joulepath/fixed.h>
#include <joulepath/plane.h>
#include <stdbool.h>

#include "src/base/compiler.h"

#define JP_PLANE_PI 3.14159265f

/** What coordinates, m, and headings, rad, may be. */
#define JP_PLANE_MAX         32767.0f
#define JP_PLANE_HEADING_MAX 1000.0f

/* A turn in two parts: the first has so few bits that its small multiples are exact. */
#define JP_PLANE_TURN_HIGH 6.28125f
#define JP_PLANE_TURN_LOW  1.93530718e-3f

/** Of 64 bits in Q32, without the compiler's helper for it: what is below 2⁻³² and whole together. */
inline float jp_plane_of_q32(int64_t value)
{
    return (float)(int32_t)(value >> 32) + (float)(uint32_t)value * 0x1p-32f;
}

/** An angle of −1 000…1 000 rad within −π…π, to 2⁻²². */
inline float jp_plane_wrap(float angle)
{
    if (angle >= -JP_PLANE_PI && angle <= JP_PLANE_PI) {
        return angle;
    }

    const float turns = angle * (0.5f / JP_PLANE_PI);
    const float rounded_up = turns + (turns < 0.0f ? -0.5f : 0.5f);
    const float whole = (float)(int32_t)rounded_up;

    return (angle - whole * JP_PLANE_TURN_HIGH) - whole * JP_PLANE_TURN_LOW;
}

/** The binary angle of −1 000…1 000 rad. */
inline jp_angle jp_plane_angle(float angle)
{
    /* Half of it, which fits 32 bits when rounding makes π a little too large. */
    const float half = jp_plane_wrap(angle) * (0x1p30f / JP_PLANE_PI);

    return (jp_angle)(int32_t)half * 2U;
}

/** Sine and cosine of −1 000…1 000 rad, to 2⁻²¹. */
inline float jp_plane_sine(float angle)
{
    return (float)jp_sin(jp_plane_angle(angle)) * 0x1p-31f;
}

inline float jp_plane_cosine(float angle)
{
    return (float)jp_cos(jp_plane_angle(angle)) * 0x1p-31f;
}

/** (cos, sin) of −1 000…1 000 rad. */
inline struct jp_plane_point jp_plane_direction(float angle)
{
    return (struct jp_plane_point){jp_plane_cosine(angle), jp_plane_sine(angle)};
}

/** √x of x >= 0; one instruction. */
static inline float jp_plane_square_root(float x)
{
    return JP_SQUARE_ROOT(x);
}

static inline float jp_plane_length(float x, float y)
{
    return jp_plane_square_root(x * x + y * y);
}

inline float jp_plane_magnitude(float x)
{
    return x < 0.0f ? -x : x;
}

static inline float jp_plane_square_between(struct jp_plane_point a, struct jp_plane_point b)
{
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

static inline float jp_plane_larger(float a, float b)
{
    return a > b ? a : b;
}

static inline float jp_plane_smaller(float a, float b)
{
    return a < b ? a : b;
}

/** x limited to [low, high]; low <= high. */
static inline float jp_plane_clamp(float x, float low, float high)
{
    return x < low ? low : x > high ? high : x;
}

/** Shorter vectors have no direction: 2³⁰ over them would be no number. */
#define JP_PLANE_SHORT 0x1p-96f

/** Angle of (x, y), to 2⁻²²; 0 for (0, 0) and what is as short as JP_PLANE_SHORT. */
inline float jp_plane_bearing(float x, float y)
{
    const float longest = jp_plane_magnitude(x) > jp_plane_magnitude(y) ? jp_plane_magnitude(x) : jp_plane_magnitude(y);

    if (!(longest > JP_PLANE_SHORT)) {
        return 0.0f;
    }

    const float scale = 0x1p30f / longest;
    const float scaled_x = x * scale;
    const float scaled_y = y * scale;
    const jp_angle angle = jp_atan2((int32_t)scaled_y, (int32_t)scaled_x);

    return (float)(int32_t)angle * (JP_PLANE_PI * 0x1p-31f);
}

/** A pose given in the frame of another, in the frame of that one. */
inline struct jp_plane_pose jp_plane_compose(const struct jp_plane_pose *frame, const struct jp_plane_pose *pose)
{
    const float c = jp_plane_cosine(frame->heading);
    const float s = jp_plane_sine(frame->heading);

    return (struct jp_plane_pose){frame->x + c * pose->x - s * pose->y, frame->y + s * pose->x + c * pose->y,
                                  jp_plane_wrap(frame->heading + pose->heading)};
}

/** A pose in the frame of another. */
inline struct jp_plane_pose jp_plane_relative(const struct jp_plane_pose *frame, const struct jp_plane_pose *pose)
{
    const float c = jp_plane_cosine(frame->heading);
    const float s = jp_plane_sine(frame->heading);
    const float dx = pose->x - frame->x;
    const float dy = pose->y - frame->y;

    return (struct jp_plane_pose){c * dx + s * dy, c * dy - s * dx, jp_plane_wrap(pose->heading - frame->heading)};
}

/** Whether x is within ±limit; what is not a number is not. */
static inline bool jp_plane_is_within(float x, float limit)
{
    return x >= -limit && x <= limit;
}

/** Neither an infinity nor not a number. */
static inline bool jp_plane_is_finite(float x)
{
    return jp_plane_is_within(x, FLT_MAX);
}

static inline bool jp_plane_is_between(float x, float low, float high)
{
    return x >= low && x <= high;
}

/** Within the ranges of struct jp_plane_pose. */
static inline bool jp_plane_is_pose(const struct jp_plane_pose *pose)
{
    return jp_plane_is_within(pose->x, JP_PLANE_MAX) && jp_plane_is_within(pose->y, JP_PLANE_MAX) &&
           jp_plane_is_within(pose->heading, JP_PLANE_HEADING_MAX);
}

#endif
