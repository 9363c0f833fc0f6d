#include <joulepath/trajectory.h>

#include "src/base/integer.h"
#include "src/trajectory/trajectory_blend.h"

/** Parts of a blend, in each of which heading and speed are those of its middle. */
#define PARTS 16

/** Half of a part, as a share of the blend, Q30. */
#define HALF_PART ((int32_t)((1 << 30) / (2 * PARTS)))

/** Of seconds here; a middle longer than 2 047 s counts as that long. */
#define TIME_BITS 20U

/** Along a leg. */
struct walk {
    const struct jp_trajectory_config *config;
    jp_angle chord;
    jp_angle heading;
    int64_t aside;    /**< to the left of the chord, 2⁻²⁰ m */
    int64_t ahead;    /**< along it */
    int64_t largest;  /**< aside, on either side */
    int64_t farthest; /**< ahead */
};

static void roll(struct walk *walk, jp_q24 wheel_rate, int32_t time)
{
    const int64_t way = (int64_t)wheel_rate * time / walk->config->turns_per_metre;

    walk->aside += (way * jp_sin(walk->heading - walk->chord)) >> 31;
    walk->ahead += (way * jp_cos(walk->heading - walk->chord)) >> 31;
    if (jp_absolute64(walk->aside) > walk->largest) {
        walk->largest = jp_absolute64(walk->aside);
    }
    if (walk->ahead > walk->farthest) {
        walk->farthest = walk->ahead;
    }
}

static void turn(struct walk *walk, jp_turns_per_s rate, int32_t time)
{
    walk->heading += (jp_angle)(((int64_t)rate * time) >> (24U + TIME_BITS - 32U));
}

static void walk_blend(struct walk *walk, const struct jp_blend *blend)
{
    const int32_t time = jp_seconds(walk->config, blend->set_points, TIME_BITS);

    for (int32_t i = 0; i < PARTS; i++) {
        struct jp_set_point at;

        jp_blend_at(blend, (2 * i + 1) * HALF_PART, &at);
        turn(walk, at.yaw_rate, time / (2 * PARTS));
        roll(walk, at.wheel_rate, time / PARTS);
        turn(walk, at.yaw_rate, time / (2 * PARTS));
    }
}

/** Rounded up. */
static jp_q16 metres(int64_t length)
{
    return jp_saturate32((length + (1 << (TIME_BITS - 16U)) - 1) >> (TIME_BITS - 16U));
}

struct jp_leg_extent jp_trajectory_leg_extent(const struct jp_trajectory_config *config,
                                              const struct jp_trajectory_leg *leg, jp_angle heading)
{
    struct walk walk = {.config = config, .chord = leg->chord, .heading = heading};

    walk_blend(&walk, &leg->begin);
    walk.heading = leg->heading;
    roll(&walk, leg->middle.wheel_rate, jp_seconds(config, leg->middle.set_points, TIME_BITS));
    walk_blend(&walk, &leg->end);
    return (struct jp_leg_extent){.aside = metres(walk.largest), .beyond = metres(walk.farthest - walk.ahead)};
}
