/**
 * Whose doing it is that the robot and a person touch.
 *
 * A robot that has stood for a second when it is touched has done nothing. Of one that has moved by more than
 * CONTACT_MOVED within the last second the touch is a collision when one of these holds:
 * - it moved into the person: the point of it that is touched has moved towards the person by more than CONTACT_MOVED
 *   within that second;
 * - it could have avoided it: had it braked at its limit on its way, from some instant since the person began to walk,
 *   to stop or to turn round as at the touch, and at most CONTACT_HISTORY before it, then nobody would have touched it
 *   before it had stood for a second. The person does what it did, and goes on as at the touch.
 *
 * An instant at which the robot is told to brake counts as the one at which it begins to.
 */
#ifndef JOULEPATH_SIM_SCENES_CONTACT_H
#define JOULEPATH_SIM_SCENES_CONTACT_H

#include <stdbool.h>
#include <stddef.h>

#include "sim/base/planar.h"

#define CONTACT_HISTORY 3.0  /* s */
#define CONTACT_MOVED   0.02 /* m; what slip and noise explain at a stand */
#define CONTACT_NEAR    0.02 /* m; nearer than this counts as a touch when it is driven again */
#define CONTACT_MOMENTS 320  /* kept: those of the history, a hundredth of a second apart */
#define CONTACT_PEOPLE  12

/** What there was at an instant. */
struct contact_moment {
    double time; /**< s */
    struct planar_pose robot;
    struct planar_point people[CONTACT_PEOPLE];
};

struct contact_history {
    struct contact_moment moments[CONTACT_MOMENTS]; /**< a ring */
    size_t next;
    size_t count;
};

/** Of a touch. */
struct contact_person {
    size_t index;                 /**< among the people of the moments */
    double radius;                /**< m */
    struct planar_point velocity; /**< at which the person goes on, m/s */
    double since;                 /**< when the person began to walk, to stop or to turn round so, s */
};

struct contact_robot {
    double half_length;  /**< m */
    double half_width;   /**< m */
    double deceleration; /**< at its limit, m/s²; of the corners in a turn */
};

struct contact_verdict {
    bool has_moved; /**< within the last second */
    bool moved_into;
    bool avoidable;
};

void contact_keep(struct contact_history *history, const struct contact_moment *moment);

/** Of a touch at the moment that was kept last. */
struct contact_verdict contact_judge(const struct contact_history *history, const struct contact_robot *robot,
                                     const struct contact_person *person);

static inline bool contact_is_collision(const struct contact_verdict *verdict)
{
    return verdict->has_moved && (verdict->moved_into || verdict->avoidable);
}

#endif
