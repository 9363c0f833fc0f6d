#include <joulepath/trajectory_rule.h>

#include <stddef.h>

#include "src/base/integer.h"
#include "src/trajectory/segment_math.h"
#include "src/trajectory/trajectory_blend.h"
#include "src/trajectory/trajectory_corner.h"
#include "src/trajectory/trajectory_outline.h"

/** 2⁻³² turn. */
#define RADIAN 683565276

/** Corrections of a middle's heading, and of its time. */
#define SECANTS 8U
#define ROUNDS  4U
#define PASSES  8U

/** The last step is taken from a line that passes the waypoint at less than this, 2⁻²⁰ m: 4 mm. */
#define ASIDE_MAX 4096U

/** Of the middle's heading from its chord: an eighth of a turn. */
#define ASTRAY_MAX ((uint32_t)1 << 29)

/** A blend that turns less is integrated by few nodes: a fifth of a turn, and where its speed changes a fiftieth. */
#define TURN_EVEN          (UINT32_MAX / 5U)
#define TURN_EVEN_CHANGING (UINT32_MAX / 50U)

#define SPEED_MAX      JP_Q24(8)
#define CRUISE_MIN     JP_Q24(0.01)
#define PITCH_MAX      JP_Q24(0.125)
#define TURN_RATE_MAX  JP_Q24(2)
#define PITCH_RATE_MAX JP_Q24(2)

/** A leg in the making. */
struct leg_search {
    struct jp_trajectory_leg result;
    struct jp_way way;             /**< to the waypoint */
    jp_q24 modes[JP_TRAVEL_MODES]; /**< at the begin of the second blend */
    struct jp_way left;            /**< of the way, for the middle */
    int32_t along;                 /**< of that, in its direction, 2⁻²⁰ m */
    int32_t aside;                 /**< to the left of it */
    int32_t covered;               /**< in the set_points of the middle */
    jp_q24 begin;                  /**< its blends, s */
    jp_q24 end;
    int32_t distance;         /**< of its ends, 2⁻²⁰ m */
    struct jp_rolling fading; /**< what the modes add in its blends */
    struct jp_rolling faded;
    bool ends_straight; /**< in the middle's heading */
    bool begins_even;   /**< few nodes do for its blends */
    bool ends_even;
};

static void copy_modes(jp_q24 *to, const jp_q24 *from)
{
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        to[i] = from[i];
    }
}

/** Of a way in 2⁻²⁰ m by m/s in Q24, in set-points. */
static int64_t way_scale(const struct jp_trajectory_config *config)
{
    return 16 * (int64_t)config->tick_rate / (int64_t)JP_TICKS_PER_SET_POINT;
}

/** What the middle covers without modes, 2⁻²⁰ m. */
static int32_t cruised(const struct jp_trajectory_plan_internal *plan, const struct leg_search *leg,
                       uint32_t set_points)
{
    return jp_saturate32((int64_t)leg->result.speed * (int64_t)set_points / way_scale(plan->task.config));
}

/** What a middle with this heading has to cover. */
static void try_heading(const struct jp_trajectory_plan_internal *plan, struct leg_search *leg, jp_angle heading)
{
    const struct jp_trajectory_config *config = plan->task.config;
    const struct jp_waypoint_motion middle = {.heading = heading, .speed = leg->result.speed};

    leg->result.heading = heading;
    if (leg->ends_straight) {
        leg->result.next.heading = heading;
    }

    const struct jp_way begin =
        jp_blend_way(config, &plan->motion, &middle, jp_turn_by(plan->motion.heading, leg->result.chord, heading),
                     leg->begin, &leg->fading);
    const struct jp_way end =
        jp_blend_way(config, &middle, &leg->result.next,
                     jp_turn_by(heading, leg->result.chord, leg->result.next.heading), leg->end, &leg->faded);
    const int32_t x = jp_sub(jp_sub(leg->way.x, begin.x), end.x);
    const int32_t y = jp_sub(jp_sub(leg->way.y, begin.y), end.y);
    const int32_t cosine = jp_cos(heading);
    const int32_t sine = jp_sin(heading);

    leg->left = (struct jp_way){x, y};
    leg->along = jp_round_shift(jp_multiply(x, cosine) + jp_multiply(y, sine), 31);
    leg->aside = jp_round_shift(jp_multiply(y, cosine) - jp_multiply(x, sine), 31);
}

/** value · part / whole, where |part| is at most |whole|, or taken to be. */
static int32_t share_of(int32_t value, int32_t part, int32_t whole)
{
    const uint32_t size = jp_magnitude32(part);
    const uint32_t most = jp_magnitude32(whole);
    const int32_t share = size < most ? jp_fraction30(size, most) : Q30_ONE;

    return jp_multiply_shift(value, (part < 0) == (whole < 0) ? share : -share, 30);
}

/** The last step, which is so small that the blends need not be integrated anew. */
static void turn_by(struct leg_search *leg, int32_t step)
{
    const jp_angle heading = leg->result.heading + (jp_angle)step;

    leg->result.heading = heading;
    leg->result.next.heading += leg->ends_straight ? (jp_angle)step : 0U;
    leg->left = (struct jp_way){jp_multiply_shift(leg->along, jp_cos(heading), 31),
                                jp_multiply_shift(leg->along, jp_sin(heading), 31)};
}

/** The heading of the middle whose line leads to the waypoint, by secants. The first takes the blends to follow the
 *  middle by half. */
static void find_heading(const struct jp_trajectory_plan_internal *plan, struct leg_search *leg)
{
    const int32_t lever = leg->distance - jp_multiply_shift(leg->result.speed, leg->begin / 2 + leg->end / 2, 28);
    int32_t step; /* 2⁻³² turn */

    try_heading(plan, leg, leg->result.heading);
    step = share_of(RADIAN, leg->aside, lever);
    for (unsigned i = 0; i < SECANTS && jp_magnitude32(leg->aside) > ASIDE_MAX; i++) {
        const int32_t before = leg->aside;

        try_heading(plan, leg, leg->result.heading + (jp_angle)step);
        step = share_of(step, leg->aside, jp_sub(before, leg->aside));
    }
    turn_by(leg, step);
}

/** The speed in it after so many set_points, but at least an eighth of the cruise, m/s. */
static jp_q24 speed_after(const struct jp_trajectory_plan_internal *plan, const struct leg_search *leg,
                          uint32_t set_points)
{
    int64_t speed = leg->result.speed;

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        speed += jp_mode_after(plan->task.config, i, leg->modes[i], set_points, Q30_ONE);
    }
    return jp_clamp32(jp_saturate32(speed), (leg->result.speed + 7) / 8, INT32_MAX);
}

/** Its set_points, that this and what is left of the modes cover the way: Newton's steps from where the modes have
 * gone. */
static uint32_t find_set_points(const struct jp_trajectory_plan_internal *plan, const struct leg_search *leg)
{
    const struct jp_trajectory_config *config = plan->task.config;
    const int64_t scale = way_scale(config);
    const int64_t way = leg->along - (int64_t)jp_modes_way(config, leg->modes, UINT32_MAX);
    int64_t set_points = way * scale / leg->result.speed;

    set_points = set_points < 1 ? 1 : set_points;
    for (unsigned i = 0; i < ROUNDS && !jp_modes_are_gone(leg->modes); i++) {
        const uint32_t now = (uint32_t)set_points;
        const int64_t left = leg->along - (int64_t)jp_modes_way(config, leg->modes, now) - cruised(plan, leg, now);

        set_points += jp_divide(left * scale, speed_after(plan, leg, now));
        set_points = set_points < 1 ? 1 : set_points;
    }
    return (uint32_t)set_points;
}

/** The line between the blends leads more aside than its turns were made for: back to a waypoint behind, or round. */
static bool leads_astray(const struct leg_search *leg)
{
    return jp_magnitude32((int32_t)(leg->result.heading - leg->result.chord)) > ASTRAY_MAX;
}

/** Heading and set_points of the middle. What is left of the modes after it moves the second blend, so that both are
 *  found until they agree. JP_ERR_INFEASIBLE: there is no room for one, or the limits do not allow its blends. */
static enum jp_status find_middle(const struct jp_trajectory_plan_internal *plan, struct leg_search *leg)
{
    const struct jp_trajectory_config *config = plan->task.config;
    const bool is_plain = jp_modes_are_gone(plan->modes);
    unsigned passes = 0;
    uint32_t before;

    if (!jp_chord_can_meet(config, &plan->chord, &plan->motion, leg->result.begin.set_points) ||
        !jp_chord_can_meet(config, &plan->chord, &leg->result.next, leg->result.end.set_points)) {
        return JP_ERR_INFEASIBLE;
    }
    jp_modes_roll(config, plan->modes, leg->result.begin.set_points, leg->begins_even, &leg->fading);
    do {
        before = leg->result.middle.set_points;
        jp_modes_roll(config, leg->modes, leg->result.end.set_points, leg->ends_even, &leg->faded);
        find_heading(plan, leg);
        if (leg->along <= 0 || jp_magnitude32(leg->aside) > ASIDE_MAX || leads_astray(leg)) {
            return JP_ERR_INFEASIBLE;
        }
        copy_modes(leg->modes, plan->modes);
        jp_modes_decay(config, leg->modes, leg->result.begin.set_points);
        leg->result.middle.set_points = find_set_points(plan, leg);
        leg->covered = jp_add(cruised(plan, leg, leg->result.middle.set_points),
                              jp_modes_way(config, leg->modes, leg->result.middle.set_points));
        jp_modes_decay(config, leg->modes, leg->result.middle.set_points);
        passes++;
    } while (!is_plain && leg->result.middle.set_points != before && passes < PASSES);
    return JP_OK;
}

/** To the end of the leg: what it is beyond the waypoint is for the next leg to make good. */
static void pass(struct jp_trajectory_plan_internal *plan, struct leg_search *leg)
{
    const jp_angle heading = leg->result.heading;

    if (!jp_modes_are_gone(plan->modes)) {
        jp_modes_roll(plan->task.config, leg->modes, leg->result.end.set_points, leg->ends_even, &leg->faded);
        try_heading(plan, leg, heading);
    }
    plan->ahead = (struct jp_way){jp_sub(jp_multiply_shift(leg->covered, jp_cos(heading), 31), leg->left.x),
                                  jp_sub(jp_multiply_shift(leg->covered, jp_sin(heading), 31), leg->left.y)};
    jp_leg_shape(plan->task.config, &plan->motion, &leg->result);
    plan->motion = leg->result.next;
    copy_modes(plan->modes, leg->modes);
    jp_modes_decay(plan->task.config, plan->modes, leg->result.end.set_points);
}

/** From a target, or the start, to the next, in Q12.20 m. */
static struct jp_way way_between(const struct jp_trajectory_task *task, uint16_t index)
{
    const struct jp_point *from = index == 0U ? &task->start : &task->targets[index - 1U];
    const struct jp_point *to = &task->targets[index];

    return (struct jp_way){(to->x - from->x) * 16, (to->y - from->y) * 16};
}

/** Whether a blend between a leg's middle and that motion turns little. */
static bool is_even(const struct jp_chord *chord, const struct jp_waypoint_motion *motion)
{
    const uint32_t turn = jp_magnitude32((int32_t)(motion->heading - chord->direction));

    return turn < (motion->speed == chord->speed ? TURN_EVEN : TURN_EVEN_CHANGING);
}

/** The end of the last leg, which has no blend where nothing changes in it. */
static void end_last(const struct jp_trajectory_task *task, const struct jp_chord *chord,
                     struct jp_leg_outline *outline)
{
    const struct jp_passage *passage = jp_passage_at(task, (uint16_t)(task->count - 1U));

    outline->next = jp_last_motion(task, chord);
    outline->ends_straight = (passage->given & (uint8_t)JP_GIVEN_HEADING) == 0U;
    outline->end = task->to_stand || passage->given != 0U ? chord->blend : 1U;
}

/** The search for the leg with that outline. */
static struct leg_search begin_leg(const struct jp_trajectory_plan *plan, const struct jp_leg_outline *outline)
{
    const struct jp_trajectory_plan_internal *internal = &plan->internal;
    const struct jp_chord *chord = &internal->chord;
    const struct jp_way way = way_between(&internal->task, plan->planned);

    return (struct leg_search){
        .result = {.chord = chord->direction,
                   .heading = chord->direction,
                   .speed = chord->speed,
                   .begin = {.set_points = outline->begin},
                   .end = {.set_points = outline->end},
                   .next = outline->next},
        .way = {jp_sub(way.x, internal->ahead.x), jp_sub(way.y, internal->ahead.y)},
        .begin = jp_seconds(internal->task.config, outline->begin, 24),
        .end = jp_seconds(internal->task.config, outline->end, 24),
        .distance = (int32_t)(chord->distance >> 2),
        .ends_straight = outline->ends_straight,
        .begins_even = is_even(chord, &internal->motion),
        .ends_even = is_even(chord, &outline->next),
    };
}

/** The difference between the robot's motion and the first leg's, in modes. */
static void begin_modes(struct jp_trajectory_plan_internal *plan)
{
    const struct jp_trajectory_config *config = plan->task.config;
    const struct jp_travel_state *motion = &plan->task.motion;
    const jp_q24 cruise = plan->chord.speed;
    const jp_q24 speed = motion->speed - cruise;
    const jp_q24 pitch = jp_sub(motion->pitch, jp_q24_multiply(config->lean[0], cruise));

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        const jp_q16 *share = &config->modes.share[JP_TRAVEL_MODES * i];

        plan->modes[i] = jp_round_shift(jp_multiply(share[0], speed) + jp_multiply(share[1], pitch) +
                                            jp_multiply(share[2], motion->pitch_rate),
                                        16);
    }
}

static bool motion_is_valid(const struct jp_travel_state *motion)
{
    return jp_is_between(motion->speed, -SPEED_MAX, SPEED_MAX) && jp_is_between(motion->pitch, -PITCH_MAX, PITCH_MAX) &&
           jp_is_between(motion->pitch_rate, -PITCH_RATE_MAX, PITCH_RATE_MAX) &&
           jp_is_between(motion->turn_rate, -TURN_RATE_MAX, TURN_RATE_MAX);
}

static bool is_valid(const struct jp_trajectory_task *task)
{
    return task->config != NULL && task->targets != NULL && task->count > 0U &&
           jp_is_between(task->cruise, CRUISE_MIN, SPEED_MAX) && motion_is_valid(&task->motion);
}

/** The chord after the one to target `index`, if there is one; both at speeds that meet. */
static enum jp_status chord_after(const struct jp_trajectory_task *task, uint16_t index, struct jp_chord *chord,
                                  struct jp_chord *after)
{
    if (index + 1U >= task->count) {
        return JP_OK;
    }

    const struct jp_leg_begin begin = jp_begin_after(task, index, chord);
    const enum jp_status status = jp_chord_to(task, (uint16_t)(index + 1U), &begin, after);

    if (status == JP_OK) {
        jp_chords_meet(task, index, chord, after);
    }
    return status;
}

/** Those of the first two legs. */
static enum jp_status first_chords(struct jp_trajectory_plan_internal *plan, jp_q24 speed)
{
    const struct jp_trajectory_task *task = &plan->task;
    const struct jp_leg_begin begin = {.heading = task->heading, .speed = speed};
    const enum jp_status status = jp_chord_to(task, 0, &begin, &plan->chord);

    return status == JP_OK ? chord_after(task, 0, &plan->chord, &plan->next) : status;
}

enum jp_status jp_plan_begin(struct jp_trajectory_plan *plan, const struct jp_trajectory_task *task)
{
    if (!is_valid(task)) {
        return JP_ERR_ARGUMENT;
    }
    *plan = (struct jp_trajectory_plan){.internal = {.task = *task, .waypoint = task->start}};

    struct jp_trajectory_plan_internal *internal = &plan->internal;
    const enum jp_status status = first_chords(internal, JP_SPEED_FREE);

    if (status == JP_OK) {
        internal->motion = (struct jp_waypoint_motion){task->heading, task->motion.turn_rate, internal->chord.speed};
        internal->blend = internal->chord.blend;
        begin_modes(internal);
    }
    return status;
}

enum jp_status jp_trajectory_plan_start(struct jp_trajectory_plan *plan, const struct jp_trajectory_task *task,
                                        struct jp_trajectory_leg *legs, uint16_t places,
                                        struct jp_trajectory *trajectory)
{
    if (plan == NULL || task == NULL || legs == NULL || places == 0U || trajectory == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = jp_plan_begin(plan, task);

    if (status == JP_OK) {
        *trajectory = (struct jp_trajectory){.legs = legs, .places = places, .start = plan->internal.motion};
        for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
            trajectory->transient[i] = jp_saturate32((int64_t)plan->internal.modes[i] * 16);
        }
    }
    return status;
}

enum jp_status jp_trajectory_plan_redirect(struct jp_trajectory_plan *plan, const struct jp_trajectory_task *task)
{
    if (plan == NULL || task == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const struct jp_trajectory_plan_internal *before = &plan->internal;

    if (before->task.to_stand && plan->planned == before->task.count) {
        return JP_ERR_STATE;
    }

    struct jp_trajectory_plan redirected = {.internal = *before};
    struct jp_trajectory_task *onward = &redirected.internal.task;

    *onward = *task;
    onward->config = before->task.config;
    onward->start = before->waypoint;
    onward->heading = before->motion.heading;
    onward->motion = (struct jp_travel_state){.turn_rate = before->motion.turn_rate};
    if (!is_valid(onward)) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = first_chords(&redirected.internal, before->motion.speed);

    if (status == JP_OK) {
        redirected.internal.blend = redirected.internal.chord.blend;
        *plan = redirected;
    }
    return status;
}

enum jp_status jp_leg_outline(const struct jp_trajectory_plan *plan, struct jp_leg_outline *outline)
{
    const struct jp_trajectory_plan_internal *internal = &plan->internal;
    const struct jp_trajectory_task *task = &internal->task;
    const struct jp_chord *chord = &internal->chord;
    const uint16_t after = (uint16_t)(plan->planned + 1U);

    if (plan->planned >= task->count) {
        return JP_ERR_STATE;
    }
    *outline =
        (struct jp_leg_outline){.begin = jp_blend_beside(chord->blend, internal->blend), .following = internal->next};

    const enum jp_status status = chord_after(task, after, &outline->following, &outline->later);

    if (status != JP_OK) {
        return status;
    }
    if (after < task->count) {
        outline->next = jp_corner_between(task, plan->planned, chord, &outline->following);
        outline->end = jp_blend_beside(chord->blend, outline->following.blend);
    } else {
        end_last(task, chord, outline);
    }
    return JP_OK;
}

void jp_leg_pass(struct jp_trajectory_plan *plan, const struct jp_leg_outline *outline)
{
    struct jp_trajectory_plan_internal *internal = &plan->internal;

    internal->chord = outline->following;
    internal->next = outline->later;
    internal->waypoint = internal->task.targets[plan->planned];
    internal->blend = outline->end;
    plan->planned++;
}

enum jp_status jp_trajectory_plan_leg(struct jp_trajectory_plan *plan, struct jp_trajectory_leg *leg)
{
    if (plan == NULL || leg == NULL) {
        return JP_ERR_ARGUMENT;
    }

    struct jp_leg_outline outline;
    enum jp_status status = jp_leg_outline(plan, &outline);

    if (status != JP_OK) {
        return status;
    }

    struct leg_search search = begin_leg(plan, &outline);

    status = find_middle(&plan->internal, &search);
    if (status == JP_OK) {
        pass(&plan->internal, &search);
        jp_leg_pass(plan, &outline);
        *leg = search.result;
    }
    return status;
}

enum jp_status jp_trajectory_by_rule(const struct jp_trajectory_task *task, struct jp_trajectory_leg *legs,
                                     struct jp_trajectory *trajectory)
{
    struct jp_trajectory_plan plan;
    enum jp_status status =
        jp_trajectory_plan_start(&plan, task, legs, task == NULL || task->count == 0U ? 1U : task->count, trajectory);

    while (status == JP_OK && plan.planned < plan.internal.task.count) {
        status = jp_trajectory_plan_leg(&plan, &legs[plan.planned]);
    }
    if (status == JP_OK) {
        trajectory->count = plan.planned;
    }
    return status;
}
