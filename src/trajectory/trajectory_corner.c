#include "src/trajectory/trajectory_corner.h"

#include "src/base/integer.h"
#include "src/trajectory/segment_geometry.h"
#include "src/trajectory/trajectory_blend.h"

/** Of a leg's time, the most that a blend takes: 10/21. */
#define SHARE 31208U

/** Turn rate of a corner by its turn and the duration of its blend: the acceleration is then 0 in it. */
#define SMOOTH_Q40 ((int64_t)3 << 38)

/** Slower legs are not driven, m/s. */
#define SPEED_MIN JP_Q24(0.001)

/** A slower speed is found to that part of a quarter. */
#define HALVINGS 4U

/** What may be given, m/s. */
#define GIVEN_MIN JP_Q24(0.01)
#define GIVEN_MAX JP_Q24(8)

/** Of a turn. */
#define QUARTER 0x3FFFFFFF

/** The largest turn rate and acceleration of a blend, by the turn and its duration. A corner takes half the turn in
 * each of its two blends. */
struct effort {
    jp_q24 rate;
    jp_q24 acceleration;
};

static const struct effort whole_turn = {JP_Q24(1.5), JP_Q24(6)};

/** What a turn in a blend of duration h asks for: A/h + B/h² volts, and a turn rate of C/h. */
struct demand {
    int32_t a;                /**< V·s in Q16 */
    int32_t b;                /**< V·s² in Q16 */
    jp_q24 c;                 /**< turn */
    jp_turns_per_s turn_rate; /**< the most */
};

static int32_t volts_of(jp_q16 volts, jp_q24 factor, jp_q24 turn)
{
    return jp_multiply_shift(volts, jp_q24_multiply(factor, turn), 24);
}

static struct demand demand_of(const struct jp_trajectory_config *config, const struct effort *effort, jp_q24 turn)
{
    return (struct demand){.a = volts_of(config->turning[0], effort->rate, turn),
                           .b = volts_of(config->turning[1], effort->acceleration, turn),
                           .c = jp_q24_multiply(effort->rate, turn),
                           .turn_rate = config->turn_rate};
}

/** What turns may take of the voltage, beside the cruise. */
static jp_q16 voltage_for_turns(const struct jp_trajectory_task *task)
{
    return jp_sub(task->config->voltage, jp_multiply_shift(task->config->volts[0], task->cruise, 24));
}

/** Whether it is enough for that turn in a blend of h s. */
static bool is_enough(jp_q16 voltage, const struct demand *demand, jp_q16 h)
{
    return voltage > 0 && jp_multiply(demand->turn_rate, h) >= (int64_t)demand->c * 65536 &&
           jp_q16_multiply(jp_q16_multiply(voltage, h), h) >= jp_add(jp_q16_multiply(demand->a, h), demand->b);
}

/** The shortest blend for which it is, s: the root of V h² = A h + B. */
static jp_q16 shortest_blend(jp_q16 voltage, const struct demand *demand)
{
    if (voltage <= 0) {
        return INT32_MAX;
    }

    const uint64_t square =
        (uint64_t)jp_multiply(demand->a, demand->a) + 4U * (uint64_t)jp_multiply(voltage, demand->b);
    const int64_t twice = (int64_t)demand->a + (int32_t)jp_square_root(square); /* V h */
    const jp_q16 root = jp_add(jp_divide(twice * (JP_Q16_ONE / 2), voltage), 1);

    const jp_q16 turned = jp_q16_divide(demand->c, demand->turn_rate);

    return root > turned ? root : turned;
}

/** |from one direction to another|, turn. */
static jp_q24 turn_between(jp_angle from, jp_angle to)
{
    return (jp_q24)(jp_magnitude32((int32_t)(to - from)) >> 8);
}

static bool has_heading(const struct jp_passage *passage)
{
    return (passage->given & (uint8_t)JP_GIVEN_HEADING) != 0U;
}

static bool has_speed(const struct jp_passage *passage)
{
    return (passage->given & (uint8_t)JP_GIVEN_SPEED) != 0U;
}

static bool can_be_given(const struct jp_passage *passage)
{
    return passage->given <= ((uint8_t)JP_GIVEN_HEADING | (uint8_t)JP_GIVEN_SPEED) &&
           (!has_speed(passage) || jp_is_between(passage->speed, GIVEN_MIN, GIVEN_MAX));
}

static enum jp_status measure(const struct jp_trajectory_task *task, uint16_t index, struct jp_chord *chord)
{
    const struct jp_point *from = index == 0U ? &task->start : &task->targets[index - 1U];

    return jp_segment_polar(from, &task->targets[index], &chord->distance, &chord->direction);
}

/** What the turns at both ends of a leg ask for. */
static enum jp_status demands_of(const struct jp_trajectory_task *task, uint16_t index,
                                 const struct jp_leg_begin *begin, const struct jp_chord *chord,
                                 struct demand demands[2])
{
    static const struct effort half_turn = {JP_Q24(0.75), JP_Q24(1.5)};
    const struct jp_passage *passage = jp_passage_at(task, index);
    enum jp_status status = JP_OK;

    demands[0] = demand_of(task->config, begin->is_corner ? &half_turn : &whole_turn,
                           turn_between(begin->heading, chord->direction));
    demands[1] = (struct demand){.turn_rate = task->config->turn_rate};
    if (has_heading(passage)) {
        demands[1] = demand_of(task->config, &whole_turn, turn_between(chord->direction, passage->heading));
    }
    if (!has_heading(passage) && index + 1U < task->count) {
        struct jp_chord other = {.direction = chord->direction};

        status = measure(task, (uint16_t)(index + 1U), &other);
        demands[1] = demand_of(task->config, &half_turn, turn_between(chord->direction, other.direction));
    }
    return status;
}

/** The time of a blend, s, where turns ask for more than a leg's length allows at cruising speed: the leg is slower. */
static jp_q16 slow_down(const struct jp_trajectory_task *task, const struct demand demands[2], uint64_t way,
                        struct jp_chord *chord)
{
    const jp_q16 voltage = voltage_for_turns(task);
    const jp_q16 first = shortest_blend(voltage, &demands[0]);
    const jp_q16 second = shortest_blend(voltage, &demands[1]);
    const jp_q16 blend = first > second ? first : second;
    const jp_q24 slowest = jp_divide((int64_t)(way << 18), blend);

    chord->speed = slowest < task->cruise ? slowest : task->cruise;
    return blend;
}

/** A change of speed at one end of a leg, beside a turn. */
struct change {
    jp_q24 speed; /**< at that end, m/s; or JP_SPEED_FREE */
    struct demand turn;
};

/** 1/h in Q20; h > 0. */
static int32_t inverse_of(jp_q16 h)
{
    return jp_divide((int64_t)1 << 36, h);
}

/** Whether voltage and lean are enough for it from a speed in a blend of 1/h in Q20: the quintic's largest derivatives
 * are 1.875, 5.8 and 60 by its duration. */
static bool can_change(const struct jp_trajectory_config *config, const struct change *change, jp_q24 speed,
                       int32_t inverse)
{
    if (change->speed < 0) {
        return true;
    }

    const jp_q24 fastest = speed > change->speed ? speed : change->speed;
    const jp_q16 rise = jp_multiply_shift(speed - change->speed, JP_Q16(1.875), 24);
    const jp_q16 first = jp_multiply_shift(rise, inverse, 20);
    const jp_q16 second = jp_multiply_shift(jp_multiply_shift(first, inverse, 20), JP_Q16(5.8 / 1.875), 16);
    const jp_q16 third = jp_multiply_shift(jp_multiply_shift(second, inverse, 20), JP_Q16(60 / 5.8), 16);
    const jp_q16 turning =
        jp_multiply_shift(jp_add(change->turn.a, jp_multiply_shift(change->turn.b, inverse, 20)), inverse, 20);
    const int64_t volts = jp_absolute64(jp_multiply(config->volts[0], fastest) >> 8) +
                          jp_absolute64(jp_multiply(config->volts[1], first)) +
                          jp_absolute64(jp_multiply(config->volts[2], second)) +
                          jp_absolute64(jp_multiply(config->volts[3], third));
    const int64_t lean =
        jp_absolute64(jp_multiply(config->lean[0], fastest) >> 8) + jp_absolute64(jp_multiply(config->lean[1], first));

    return (volts >> 16) + turning <= config->voltage && lean >> 16 <= config->pitch;
}

/** The time of a leg's blends at a speed, s: as long as its share of the way allows, but at least `least`. */
static jp_q16 blend_at(const struct jp_trajectory_config *config, jp_q24 speed, uint64_t way, jp_q16 least)
{
    const jp_q16 possible = jp_divide((int64_t)(way << 18), speed);
    const jp_q16 longer = possible < config->blend ? possible : config->blend;

    return longer > least ? longer : least;
}

/** A leg whose speed is to be found. */
struct pace {
    const struct jp_trajectory_config *config;
    struct change changes[2]; /**< at its ends */
    uint64_t way;             /**< of a blend, 2⁻²² m */
    jp_q16 blend;             /**< shortest that its turns allow, s */
};

static bool can_go_at(const struct pace *pace, jp_q24 speed)
{
    const int32_t inverse = inverse_of(blend_at(pace->config, speed, pace->way, pace->blend));

    return can_change(pace->config, &pace->changes[0], speed, inverse) &&
           can_change(pace->config, &pace->changes[1], speed, inverse);
}

/** The greatest speed that allows the changes at both ends, to a part in 2^HALVINGS; below SPEED_MIN: none does. */
static jp_q24 speed_for_changes(const struct pace *pace, jp_q24 greatest)
{
    jp_q24 speed = greatest;
    jp_q24 step = greatest / 4;

    while (speed >= SPEED_MIN && !can_go_at(pace, speed)) {
        step = speed / 4;
        speed -= step;
    }
    for (unsigned i = 0; i < HALVINGS && speed >= SPEED_MIN; i++) {
        step /= 2;
        speed += can_go_at(pace, speed + step) ? step : 0;
    }
    return speed;
}

/** The time of the blends, s. */
static jp_q16 slow_for_changes(const struct pace *pace, struct jp_chord *chord)
{
    if (can_go_at(pace, chord->speed)) {
        return pace->blend;
    }
    chord->speed = speed_for_changes(pace, chord->speed);
    return blend_at(pace->config, chord->speed, pace->way, pace->blend);
}

struct jp_leg_begin jp_begin_after(const struct jp_trajectory_task *task, uint16_t index, const struct jp_chord *before)
{
    const struct jp_passage *passage = jp_passage_at(task, index);

    return (struct jp_leg_begin){
        .heading = has_heading(passage) ? passage->heading : before->direction,
        .speed = has_speed(passage) ? passage->speed : JP_SPEED_FREE,
        .is_corner = !has_heading(passage),
    };
}

static jp_q24 speed_at_end(const struct jp_trajectory_task *task, uint16_t index)
{
    const struct jp_passage *passage = jp_passage_at(task, index);

    if (task->to_stand && index + 1U == task->count) {
        return 0;
    }
    return has_speed(passage) ? passage->speed : JP_SPEED_FREE;
}

enum jp_status jp_chord_to(const struct jp_trajectory_task *task, uint16_t index, const struct jp_leg_begin *begin,
                           struct jp_chord *chord)
{
    const struct jp_trajectory_config *config = task->config;
    const struct jp_passage *passage = jp_passage_at(task, index);
    const jp_q16 voltage = voltage_for_turns(task);
    struct demand demands[2];
    enum jp_status status = can_be_given(passage) ? measure(task, index, chord) : JP_ERR_ARGUMENT;

    if (status == JP_OK) {
        status = demands_of(task, index, begin, chord, demands);
    }
    if (status != JP_OK) {
        return status;
    }

    const uint64_t way = (uint64_t)chord->distance * SHARE >> 16; /* of a blend, 2⁻²² m */
    const jp_q16 possible = jp_divide((int64_t)(way << 18), task->cruise);
    jp_q16 blend = possible < config->blend ? possible : config->blend;

    chord->speed = task->cruise;
    if (!is_enough(voltage, &demands[0], blend) || !is_enough(voltage, &demands[1], blend)) {
        blend = slow_down(task, demands, way, chord);
    }

    const jp_q24 end_speed = speed_at_end(task, index);

    if (begin->speed >= 0 || end_speed >= 0) {
        const struct pace pace = {config, {{begin->speed, demands[0]}, {end_speed, demands[1]}}, way, blend};

        blend = slow_for_changes(&pace, chord);
    }
    chord->blend = (uint32_t)(((uint64_t)(uint32_t)blend * config->tick_rate / JP_TICKS_PER_SET_POINT) >> 16) + 1U;
    return chord->speed < SPEED_MIN ? JP_ERR_INFEASIBLE : JP_OK;
}

/** What a leg's turn to or from a heading asks for, of which a corner makes twice as much. */
static struct demand turn_of(const struct jp_trajectory_config *config, const struct jp_chord *chord, jp_angle heading,
                             bool is_corner)
{
    static const struct effort half_of_corner = {JP_Q24(1.5), JP_Q24(3)};

    return demand_of(config, is_corner ? &half_of_corner : &whole_turn, turn_between(heading, chord->direction));
}

void jp_chords_meet(const struct jp_trajectory_task *task, uint16_t index, struct jp_chord *before,
                    struct jp_chord *after)
{
    const struct jp_passage *passage = jp_passage_at(task, index);
    struct jp_chord *faster = before->speed > after->speed ? before : after;
    const struct jp_chord *slower = before->speed > after->speed ? after : before;

    if (faster->speed == slower->speed || has_speed(passage)) {
        return;
    }

    const jp_angle mean = slower->direction + (faster->direction - slower->direction) / 2U;
    const struct change change = {slower->speed, has_heading(passage)
                                                     ? turn_of(task->config, faster, passage->heading, false)
                                                     : turn_of(task->config, faster, mean, true)};
    const int32_t inverse = inverse_of(jp_seconds(task->config, jp_blend_beside(faster->blend, slower->blend), 16));

    if (!can_change(task->config, &change, faster->speed, inverse)) {
        jp_q24 step = faster->speed - slower->speed;

        faster->speed = slower->speed;
        for (unsigned i = 0; i < 2U * HALVINGS; i++) {
            step /= 2;
            faster->speed += can_change(task->config, &change, faster->speed + step, inverse) ? step : 0;
        }
    }
}

bool jp_chord_can_meet(const struct jp_trajectory_config *config, const struct jp_chord *chord,
                       const struct jp_waypoint_motion *motion, uint32_t set_points)
{
    if (chord->speed == motion->speed) {
        return true;
    }

    const struct change change = {motion->speed, turn_of(config, chord, motion->heading, motion->turn_rate != 0)};

    return can_change(config, &change, chord->speed, inverse_of(jp_seconds(config, set_points, 16)));
}

/** How a waypoint is rounded. */
struct corner {
    jp_angle heading;
    int32_t turn;         /**< of which each of the two blends makes half, 2⁻³² turn */
    struct demand demand; /**< at the robot's own pace */
};

/** The mean of the two lines. */
static struct corner corner_as_costs_least(const struct jp_trajectory_config *config, jp_angle before, jp_angle after)
{
    static const struct effort at_pace = {JP_Q24(1.5), JP_Q24(3)};
    const int32_t turn = (int32_t)(after - before);

    return (struct corner){.heading = before + (jp_angle)(turn / 2),
                           .turn = turn,
                           .demand = demand_of(config, &at_pace, turn_between(before, after))};
}

/** With a heading that is given, the blends make unlike parts of the turn: the turn rate is that of the whole turn,
 * but a quarter more than that of the lesser part at most, and none if they are to both sides. */
static struct corner corner_with_heading(const struct jp_trajectory_config *config, jp_angle before, jp_angle heading,
                                         jp_angle after)
{
    static const struct effort at_pace = {JP_Q24(3), JP_Q24(6)};
    const int32_t first = (int32_t)(heading - before);
    const int32_t second = (int32_t)(after - heading);
    const bool is_first_less = jp_magnitude32(first) < jp_magnitude32(second);
    const int32_t lesser = (first < 0) != (second < 0) ? 0 : (is_first_less ? first : second);
    const int64_t most = (int64_t)lesser * 5 / 2;
    const int64_t whole = (int64_t)first + second;
    const int64_t turn = jp_absolute64(whole) < jp_absolute64(most) ? whole : most;

    return (struct corner){
        .heading = heading,
        .turn = jp_clamp32(jp_saturate32(turn), -2 * QUARTER, 2 * QUARTER),
        .demand =
            demand_of(config, &at_pace, is_first_less ? turn_between(heading, after) : turn_between(before, heading))};
}

struct jp_waypoint_motion jp_corner_between(const struct jp_trajectory_task *task, uint16_t index,
                                            const struct jp_chord *before, const struct jp_chord *after)
{
    const struct jp_trajectory_config *config = task->config;
    const struct jp_passage *passage = jp_passage_at(task, index);
    const struct corner corner =
        has_heading(passage) ? corner_with_heading(config, before->direction, passage->heading, after->direction)
                             : corner_as_costs_least(config, before->direction, after->direction);
    const uint32_t set_points = before->blend < after->blend ? before->blend : after->blend;
    const jp_q16 blend = jp_seconds(config, set_points, 16);
    const jp_q24 smooth = jp_divide((int64_t)SMOOTH_Q40, blend);
    const bool is_pace = config->turn_pace > smooth && is_enough(voltage_for_turns(task), &corner.demand, blend);
    const jp_q24 slower = before->speed < after->speed ? before->speed : after->speed;

    return (struct jp_waypoint_motion){
        .heading = corner.heading,
        .turn_rate = jp_multiply_shift(corner.turn, is_pace ? config->turn_pace : smooth, 32),
        .speed = has_speed(passage) ? passage->speed : slower,
    };
}

struct jp_waypoint_motion jp_last_motion(const struct jp_trajectory_task *task, const struct jp_chord *chord)
{
    const struct jp_passage *passage = jp_passage_at(task, (uint16_t)(task->count - 1U));
    const jp_q24 onward = has_speed(passage) ? passage->speed : chord->speed;

    return (struct jp_waypoint_motion){
        .heading = has_heading(passage) ? passage->heading : chord->direction,
        .speed = task->to_stand ? 0 : onward,
    };
}
