#include <joulepath/four_wheel.h>

#include "src/base/config_check.h"
#include "src/base/integer.h"

#define TWIST_MAX       JP_Q24(16)
#define SPEED_LIMIT     JP_Q24(16)
#define STEERING_MAX    ((int32_t)JP_ANGLE_DEGREES(120))
#define STEERING_LEAST  ((int32_t)JP_ANGLE_DEGREES(0.05))
#define DRIVE_ERROR_MAX ((int32_t)JP_STEERING_DRIVE_ERROR)
#define QUARTER_TURN    ((int32_t)1 << 30)
#define HALF_TURN       ((jp_angle)1 << 31)

/** 2³²/2π: an angle times a speed in these units moves the contact by one unit of Q24. */
#define ANGLE_PER_RADIAN ((int64_t)683565276)

/** All of a transition; shares of it are in Q30. */
#define WHOLE ((int32_t)1 << 30)

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_four_wheel_config, member, low, high)

/** Steering angle of the wheels in a turn in place, 2⁻³² turn, less the error of the arctangent. */
static int32_t turning_in_place(const struct jp_four_wheel_config *config)
{
    return (int32_t)(jp_atan2(config->wheelbase, config->track) - (jp_angle)JP_ATAN2_ERROR);
}

enum jp_status jp_four_wheel_check(const struct jp_four_wheel_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(wheelbase, JP_Q24(0.05), JP_Q24(4)),   FIELD(track, JP_Q24(0.05), JP_Q24(4)),
        FIELD(steering_limit, 0, STEERING_MAX),      FIELD(steering_step, STEERING_LEAST, STEERING_MAX),
        FIELD(speed_max, JP_Q24(0.01), SPEED_LIMIT), FIELD(speed_step, JP_WHEEL_HOLD_SPEED, SPEED_LIMIT),
    };
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status == JP_OK && config->steering_limit < turning_in_place(config)) {
        return jp_config_refuse("steering_limit", field);
    }
    return status;
}

jp_q24 jp_four_wheel_radius_min(const struct jp_four_wheel_config *config)
{
    if (config->steering_limit >= QUARTER_TURN) {
        return 0;
    }
    /* The inner wheel: tan(limit) = (wheelbase/2)/(radius − track/2). */
    const int64_t reach = jp_multiply(config->wheelbase, jp_cos((jp_angle)config->steering_limit)); /* Q55 */
    const jp_q24 inside = jp_divide(reach, jp_sin((jp_angle)config->steering_limit));

    return (inside + config->track) / 2 + 1;
}

enum jp_status jp_four_wheel_twist(const struct jp_four_wheel_config *config, jp_q24 speed, int32_t angle,
                                   struct jp_twist *twist)
{
    if (config == NULL || twist == NULL || !jp_is_between(speed, -SPEED_LIMIT, SPEED_LIMIT) ||
        !jp_is_between(angle, 1 - QUARTER_TURN, QUARTER_TURN - 1)) {
        return JP_ERR_ARGUMENT;
    }
    const int64_t across = jp_multiply(speed, jp_sin((jp_angle)angle));                    /* Q55 */
    const int32_t arm = jp_multiply_shift(config->wheelbase, jp_cos((jp_angle)angle), 26); /* Q29 */

    *twist = (struct jp_twist){.x = speed, .turn_rate = jp_divide(across >> 1, arm)};
    return twist->turn_rate == INT32_MAX || twist->turn_rate == INT32_MIN ? JP_ERR_OVERFLOW : JP_OK;
}

/* Velocity of a contact, m/s. */
struct contact {
    jp_q24 x;
    jp_q24 y;
};

static void set_contacts(const struct jp_four_wheel_config *config, const struct jp_twist *twist,
                         struct contact contacts[JP_WHEELS])
{
    const jp_q24 across = jp_multiply_shift(twist->turn_rate, config->track, 25);
    const jp_q24 along = jp_multiply_shift(twist->turn_rate, config->wheelbase, 25);

    contacts[JP_FRONT_LEFT] = (struct contact){twist->x - across, twist->y + along};
    contacts[JP_FRONT_RIGHT] = (struct contact){twist->x + across, twist->y + along};
    contacts[JP_REAR_LEFT] = (struct contact){twist->x - across, twist->y - along};
    contacts[JP_REAR_RIGHT] = (struct contact){twist->x + across, twist->y - along};
}

/* Length of (x, y), to nearest, saturated. */
static int32_t length(int32_t x, int32_t y)
{
    const uint64_t sum = (uint64_t)jp_multiply(x, x) + (uint64_t)jp_multiply(y, y);
    const uint32_t root = jp_square_root(sum);
    const uint64_t remainder = sum - (uint64_t)root * root;

    return jp_saturate32((int64_t)root + (remainder > root ? 1 : 0));
}

/* Component of the contact's velocity along the direction. */
static jp_q24 component(const struct contact *contact, int32_t angle)
{
    const int64_t along = jp_multiply(contact->x, jp_cos((jp_angle)angle)); /* Q55 */

    return jp_round_shift(along + jp_multiply(contact->y, jp_sin((jp_angle)angle)), 31);
}

/* True within the limit, or beyond it by no more than the formats resolve at this speed. */
static bool within_limit(const struct jp_four_wheel_config *config, int32_t angle, jp_q24 speed)
{
    const int64_t excess = jp_absolute64(angle) - config->steering_limit;

    return excess * speed <= JP_SLIP_QUANTUM / 2 * ANGLE_PER_RADIAN;
}

/* Of the two angles at which the wheel rolls like its contact, half a turn apart, the nearer one. False: none is within
 * the limits. */
static bool set_wheel(const struct jp_four_wheel_config *config, const struct contact *contact, int32_t *angle,
                      jp_q24 *speed)
{
    const jp_q24 size = length(contact->x, contact->y);

    if (size < JP_WHEEL_HOLD_SPEED) {
        *speed = component(contact, *angle);
        return true;
    }
    const int32_t ahead = (int32_t)jp_atan2(contact->y, contact->x);
    const int32_t behind = (int32_t)((jp_angle)ahead + HALF_TURN);
    const bool may_ahead = within_limit(config, ahead, size);
    const bool may_behind = within_limit(config, behind, size);
    const bool is_behind_nearer = jp_absolute64((int64_t)behind - *angle) < jp_absolute64((int64_t)ahead - *angle);
    const bool reverses = may_behind && (is_behind_nearer || !may_ahead);

    if (size > config->speed_max || !(may_ahead || may_behind)) {
        return false;
    }
    *angle = jp_clamp32(reverses ? behind : ahead, -config->steering_limit, config->steering_limit);
    *speed = reverses ? -size : size;
    return true;
}

static bool is_twist(const struct jp_twist *twist)
{
    return jp_is_between(twist->x, -TWIST_MAX, TWIST_MAX) && jp_is_between(twist->y, -TWIST_MAX, TWIST_MAX) &&
           jp_is_between(twist->turn_rate, -TWIST_MAX, TWIST_MAX);
}

enum jp_status jp_four_wheel_inverse(const struct jp_four_wheel_config *config, const struct jp_twist *twist,
                                     struct jp_wheels *wheels)
{
    struct contact contacts[JP_WHEELS];
    if (config == NULL || twist == NULL || wheels == NULL || !is_twist(twist)) {
        return JP_ERR_ARGUMENT;
    }
    struct jp_wheels solution;
    solution = *wheels;
    set_contacts(config, twist, contacts);
    for (size_t i = 0; i < (size_t)JP_WHEELS; i++) {
        if (!set_wheel(config, &contacts[i], &solution.angle[i], &solution.speed[i])) {
            return JP_ERR_INFEASIBLE;
        }
    }
    *wheels = solution;
    return JP_OK;
}

/* Velocities of the contacts as the wheels roll, m/s in Q27, at most 2³¹. */
struct rolling {
    int64_t x[JP_WHEELS];
    int64_t y[JP_WHEELS];
};

/* Rigid motion in Q27 m/s, at most 2³¹: of the centre, and of a contact around it. */
struct motion {
    int64_t x;
    int64_t y;
    int64_t around;
};

/* Direction of a contact from the centre, Q31: cosine to the front, sine to the side. */
struct diagonal {
    jp_q31 front;
    jp_q31 side;
};

static struct diagonal diagonal_of(const struct jp_four_wheel_config *config)
{
    const jp_angle angle = jp_atan2(config->track, config->wheelbase);

    return (struct diagonal){jp_cos(angle), jp_sin(angle)};
}

static void set_rolling(const struct jp_wheels *wheels, struct rolling *rolling)
{
    for (size_t i = 0; i < (size_t)JP_WHEELS; i++) {
        const jp_q24 speed = jp_clamp32(wheels->speed[i], -SPEED_LIMIT, SPEED_LIMIT);
        const jp_angle angle = (jp_angle)wheels->angle[i];

        rolling->x[i] = jp_round_shift64(jp_multiply(speed, jp_cos(angle)), 28);
        rolling->y[i] = jp_round_shift64(jp_multiply(speed, jp_sin(angle)), 28);
    }
}

/* Least squares. The contacts stand symmetrically, so that the normal equations are diagonal. */
static struct motion fit(const struct rolling *rolling, const struct diagonal *diagonal)
{
    const int64_t *x = rolling->x;
    const int64_t *y = rolling->y;
    const int64_t to_front = y[JP_FRONT_LEFT] + y[JP_FRONT_RIGHT] - y[JP_REAR_LEFT] - y[JP_REAR_RIGHT];
    const int64_t to_right = x[JP_FRONT_RIGHT] + x[JP_REAR_RIGHT] - x[JP_FRONT_LEFT] - x[JP_REAR_LEFT];
    const int64_t around =
        jp_round_shift64(to_front, 2) * diagonal->front + jp_round_shift64(to_right, 2) * diagonal->side;

    return (struct motion){
        .x = jp_round_shift64(x[JP_FRONT_LEFT] + x[JP_FRONT_RIGHT] + x[JP_REAR_LEFT] + x[JP_REAR_RIGHT], 2),
        .y = jp_round_shift64(y[JP_FRONT_LEFT] + y[JP_FRONT_RIGHT] + y[JP_REAR_LEFT] + y[JP_REAR_RIGHT], 2),
        .around = jp_round_shift64(around, 31),
    };
}

/* Square of a velocity of at most 8 m/s, Q54. */
static uint64_t square(int64_t velocity)
{
    const int32_t limited = jp_saturate_bits(jp_saturate32(velocity), 31);

    return (uint64_t)jp_multiply(limited, limited);
}

static jp_q24 slip_of(const struct rolling *rolling, const struct motion *motion, const struct diagonal *diagonal)
{
    const int64_t along = jp_round_shift64(motion->around * diagonal->front, 31);
    const int64_t across = jp_round_shift64(motion->around * diagonal->side, 31);
    uint64_t sum = 0;

    for (size_t i = 0; i < (size_t)JP_WHEELS; i++) {
        const bool is_left = i == (size_t)JP_FRONT_LEFT || i == (size_t)JP_REAR_LEFT;
        const bool is_front = i == (size_t)JP_FRONT_LEFT || i == (size_t)JP_FRONT_RIGHT;

        sum += square(rolling->x[i] - (motion->x + (is_left ? -across : across)));
        sum += square(rolling->y[i] - (motion->y + (is_front ? along : -along)));
    }
    /* √(sum/4), and from Q27 to Q24 */
    const jp_q24 slip = (jp_q24)((jp_square_root(sum) + 8U) >> 4);

    return slip <= JP_SLIP_QUANTUM ? 0 : slip;
}

void jp_four_wheel_forward(const struct jp_four_wheel_config *config, const struct jp_wheels *wheels,
                           struct jp_twist *twist, jp_q24 *slip)
{
    const struct diagonal diagonal = diagonal_of(config);
    const int64_t length_q55 =
        jp_multiply(config->wheelbase, diagonal.front) + jp_multiply(config->track, diagonal.side);
    struct rolling rolling;

    set_rolling(wheels, &rolling);
    const struct motion motion = fit(&rolling, &diagonal);
    /* The contacts are half a diagonal from the centre. */
    *twist = (struct jp_twist){
        .x = jp_round_shift(motion.x, 3),
        .y = jp_round_shift(motion.y, 3),
        .turn_rate = jp_divide(motion.around * ((int64_t)1 << 26), jp_round_shift(length_q55, 27)),
    };
    *slip = slip_of(&rolling, &motion, &diagonal);
}

/* The velocity of one wheel's contact in a tick: from the present one to the goal's, both seen along the present
 * direction of rolling. The four contacts take the same share of their transitions. */
struct transition {
    jp_q24 from;   /* speed now, 0 or more */
    jp_q24 to;     /* speed of the goal; below 0: reversed */
    int32_t error; /* from the present angle to that of the goal */
    bool is_backward;
    bool is_held;     /* so slow that it may be steered where it stands */
    bool is_straight; /* the velocity of its contact keeps its direction */
};

static struct transition transition_of(const struct jp_wheels *wheels, const struct jp_wheels *goal, size_t wheel)
{
    const jp_q24 from = jp_clamp32(wheels->speed[wheel], -SPEED_LIMIT, SPEED_LIMIT);
    const jp_q24 to = jp_clamp32(goal->speed[wheel], -SPEED_LIMIT, SPEED_LIMIT);
    const int32_t error = jp_sub(goal->angle[wheel], wheels->angle[wheel]);
    const bool is_held = jp_is_between(from, 1 - JP_WHEEL_HOLD_SPEED, JP_WHEEL_HOLD_SPEED - 1);

    return (struct transition){
        .from = from < 0 ? -from : from,
        .to = from < 0 ? -to : to,
        .error = error,
        .is_backward = from < 0,
        .is_held = is_held,
        .is_straight = is_held || error == 0,
    };
}

static bool is_beyond(int32_t error, int32_t limit)
{
    return jp_absolute64(error) > limit;
}

/* True when a wheel cannot follow its transition while the wheels roll, so that all must stand first. */
static bool needs_stand(const struct transition transitions[JP_WHEELS])
{
    bool rolls = false;
    bool steers = false;
    bool is_far = false;
    bool reverses = false;

    for (size_t i = 0; i < (size_t)JP_WHEELS; i++) {
        rolls = rolls || transitions[i].from > 0;
        steers = steers || transitions[i].error != 0;
        is_far = is_far || is_beyond(transitions[i].error, DRIVE_ERROR_MAX);
        reverses = reverses || (!transitions[i].is_held && transitions[i].to <= -JP_WHEEL_HOLD_SPEED);
    }
    return rolls && (is_far || (reverses && steers));
}

/* part/whole in Q30, rounded down; part <= whole < 2⁵³, which counts in steps of 2¹⁹. */
static int32_t part_of(uint64_t part, uint64_t whole)
{
    return (int32_t)((part << 11) / ((whole >> 19) + 1U));
}

/* Share of the transition in which the direction turns by at most a step: by the law of sines,
 * (1 − share) from sin(step) = share · to · sin(error − step). */
static int32_t steering_share(const struct jp_four_wheel_config *config, const struct transition *transition)
{
    const int32_t step = config->steering_step;
    if (!is_beyond(transition->error, step)) {
        return WHOLE;
    }
    const int32_t remaining = (int32_t)jp_absolute64(transition->error) - step;
    const uint64_t near = (uint64_t)jp_multiply(transition->from, jp_sin((jp_angle)step) >> 7); /* Q48 */
    const uint64_t far = (uint64_t)jp_multiply(transition->to, jp_sin((jp_angle)remaining) >> 7);

    return part_of(near, near + far);
}

/* Share of the transition in which the speed changes by at most a step. The speed is a convex function of the share, so
 * it rises at most as its chord does and falls at most as it does at the beginning. */
static int32_t speed_share(const struct jp_four_wheel_config *config, const struct transition *transition)
{
    const jp_q24 rise = transition->to - transition->from;
    const jp_q24 along = transition->is_straight
                             ? transition->to
                             : jp_multiply_shift(transition->to, jp_cos((jp_angle)transition->error), 31);
    const jp_q24 fall = transition->from - along;
    const jp_q24 change = rise > fall ? rise : fall;

    return change > config->speed_step ? jp_divide((int64_t)config->speed_step * WHOLE, change) : WHOLE;
}

/* The share that one wheel allows; 0 while a wheel that stands is steered to its angle. */
static int32_t share_of(const struct jp_four_wheel_config *config, const struct transition *transition)
{
    if (transition->is_held && is_beyond(transition->error, config->steering_step)) {
        return 0;
    }
    const int32_t by_speed = speed_share(config, transition);
    const int32_t by_steering = transition->is_held ? WHOLE : steering_share(config, transition);

    return by_speed < by_steering ? by_speed : by_steering;
}

/* The change of a wheel's angle in a tick, and its speed after it. */
struct wheel_step {
    int32_t turn;
    jp_q24 speed;
};

static struct wheel_step step_along(const struct transition *transition, int32_t share)
{
    const jp_q24 ahead = jp_multiply_shift(transition->to, jp_cos((jp_angle)transition->error), 31) - transition->from;
    const jp_q24 aside = jp_multiply_shift(transition->to, jp_sin((jp_angle)transition->error), 31);
    const jp_q24 x = transition->from + jp_multiply_shift(ahead, share, 30);
    const jp_q24 y = jp_multiply_shift(aside, share, 30);

    return (struct wheel_step){(int32_t)jp_atan2(y, x), length(x, y)};
}

static struct wheel_step step_straight(const struct transition *transition, int32_t share)
{
    return (struct wheel_step){transition->error,
                               transition->from + jp_multiply_shift(transition->to - transition->from, share, 30)};
}

static struct wheel_step step_of(const struct transition *transition, int32_t share)
{
    struct wheel_step step = transition->is_straight ? step_straight(transition, share) : step_along(transition, share);

    step.speed = transition->is_backward ? -step.speed : step.speed;
    return step;
}

/* Moves a wheel by a step, within the limits of a tick and not past the goal. */
static void advance(const struct jp_four_wheel_config *config, const struct wheel_step *step,
                    const struct jp_wheels *goal, size_t wheel, struct jp_wheels *wheels)
{
    const int32_t angle = wheels->angle[wheel];
    const jp_q24 speed = wheels->speed[wheel];
    const int32_t wanted = jp_add(angle, step->turn);
    const int32_t to_goal = goal->angle[wheel] < angle ? jp_clamp32(wanted, goal->angle[wheel], angle)
                                                       : jp_clamp32(wanted, angle, goal->angle[wheel]);

    wheels->angle[wheel] =
        jp_clamp32(to_goal, jp_sub(angle, config->steering_step), jp_add(angle, config->steering_step));
    wheels->speed[wheel] =
        jp_clamp32(step->speed, jp_sub(speed, config->speed_step), jp_add(speed, config->speed_step));
}

static void set_transitions(const struct jp_wheels *wheels, const struct jp_wheels *goal,
                            struct transition transitions[JP_WHEELS])
{
    for (size_t i = 0; i < (size_t)JP_WHEELS; i++) {
        transitions[i] = transition_of(wheels, goal, i);
    }
}

static int32_t common_share(const struct jp_four_wheel_config *config, const struct transition transitions[JP_WHEELS])
{
    int32_t least = WHOLE;

    for (size_t i = 0; i < (size_t)JP_WHEELS; i++) {
        const int32_t own = share_of(config, &transitions[i]);
        least = own < least ? own : least;
    }
    return least;
}

/* The goal of wheels that stop where they stand. */
static void set_rest(const struct jp_wheels *wheels, struct jp_wheels *goal)
{
    *goal = *wheels;
    for (size_t i = 0; i < (size_t)JP_WHEELS; i++) {
        goal->speed[i] = 0;
    }
}

static enum jp_steering steering_of(const struct jp_wheels *wheels, const struct jp_wheels *goal)
{
    bool is_aligned = true;
    bool stands = true;

    for (size_t i = 0; i < (size_t)JP_WHEELS; i++) {
        is_aligned = is_aligned && wheels->angle[i] == goal->angle[i] && wheels->speed[i] == goal->speed[i];
        stands = stands && wheels->speed[i] == 0;
    }
    if (is_aligned) {
        return JP_STEERING_ALIGNED;
    }
    return stands ? JP_STEERING_STANDSTILL : JP_STEERING_LIMITED;
}

enum jp_status jp_four_wheel_tick(const struct jp_four_wheel_config *config, const struct jp_twist *twist,
                                  struct jp_wheels *wheels, enum jp_steering *steering)
{
    struct transition transitions[JP_WHEELS];
    if (config == NULL || twist == NULL || wheels == NULL || steering == NULL) {
        return JP_ERR_ARGUMENT;
    }
    struct jp_wheels goal;
    goal = *wheels;
    const enum jp_status status = jp_four_wheel_inverse(config, twist, &goal);
    set_transitions(wheels, &goal, transitions);
    const bool stops = status != JP_OK || needs_stand(transitions);
    if (stops) {
        set_rest(wheels, &goal);
        set_transitions(wheels, &goal, transitions);
    }
    const int32_t share = common_share(config, transitions);
    for (size_t i = 0; i < (size_t)JP_WHEELS; i++) {
        const struct wheel_step step =
            share == WHOLE ? (struct wheel_step){transitions[i].error, goal.speed[i]} : step_of(&transitions[i], share);
        advance(config, &step, &goal, i, wheels);
    }
    *steering = stops ? JP_STEERING_STANDSTILL : steering_of(wheels, &goal);
    return status;
}
