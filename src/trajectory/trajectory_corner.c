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

/** The largest turn rate and acceleration of a blend, by the turn and its duration. A corner takes half the turn in
 * each of its two blends. */
struct effort {
    jp_q24 rate;
    jp_q24 acceleration;
};

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
    return task->config->voltage - jp_multiply_shift(task->config->volts[0], task->cruise, 24);
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
    const jp_q16 root = jp_q16_divide(demand->a + (int32_t)jp_square_root(square), 2 * voltage) + 1;

    const jp_q16 turned = jp_q16_divide(demand->c, demand->turn_rate);

    return root > turned ? root : turned;
}

/** |from one direction to another|, turn. */
static jp_q24 turn_between(jp_angle from, jp_angle to)
{
    return (jp_q24)(jp_magnitude32((int32_t)(to - from)) >> 8);
}

static enum jp_status measure(const struct jp_trajectory_task *task, uint16_t index, struct jp_chord *chord)
{
    const struct jp_point *from = index == 0U ? &task->start : &task->targets[index - 1U];

    return jp_segment_polar(from, &task->targets[index], &chord->distance, &chord->direction);
}

/** What the turns at both ends of a leg ask for. */
static enum jp_status demands_of(const struct jp_trajectory_task *task, uint16_t index, jp_angle before,
                                 const struct jp_chord *chord, struct demand demands[2])
{
    static const struct effort at_start = {JP_Q24(1.5), JP_Q24(6)};
    static const struct effort at_corner = {JP_Q24(0.75), JP_Q24(1.5)};
    enum jp_status status = JP_OK;

    demands[0] = demand_of(task->config, index == 0U ? &at_start : &at_corner, turn_between(before, chord->direction));
    demands[1] = demands[0];
    if (index + 1U < task->count) {
        struct jp_chord other = {.direction = chord->direction};

        status = measure(task, (uint16_t)(index + 1U), &other);
        demands[1] = demand_of(task->config, &at_corner, turn_between(chord->direction, other.direction));
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

/** Whether the voltage is enough to stop from that speed in that time, s: the quintic's largest derivatives
 * are 1.875, 5.8 and 60 by its duration. */
static bool can_stop(const struct jp_trajectory_config *config, jp_q24 speed, jp_q16 h)
{
    const jp_q16 first = jp_q16_divide(jp_multiply_shift(speed, JP_Q16(1.875), 24), h);
    const jp_q16 second = jp_q16_divide(jp_multiply_shift(first, JP_Q16(5.8 / 1.875), 16), h);
    const jp_q16 third = jp_q16_divide(jp_multiply_shift(second, JP_Q16(60 / 5.8), 16), h);
    const int64_t volts =
        jp_absolute64(jp_multiply(config->volts[0], speed) >> 8) + jp_absolute64(jp_multiply(config->volts[1], first)) +
        jp_absolute64(jp_multiply(config->volts[2], second)) + jp_absolute64(jp_multiply(config->volts[3], third));

    return volts >> 16 <= config->voltage;
}

/** The time of the last leg's blends, s, at a speed from which the robot can stop in it. */
static jp_q16 slow_to_stop(const struct jp_trajectory_config *config, uint64_t way, jp_q16 blend,
                           struct jp_chord *chord)
{
    jp_q16 longer = blend;

    while (chord->speed >= SPEED_MIN && !can_stop(config, chord->speed, longer)) {
        const jp_q16 possible = jp_divide((int64_t)(way << 18), chord->speed - chord->speed / 4);

        chord->speed -= chord->speed / 4;
        longer = possible < config->blend ? possible : config->blend;
        longer = longer > blend ? longer : blend;
    }
    return longer;
}

enum jp_status jp_chord_to(const struct jp_trajectory_task *task, uint16_t index, jp_angle before,
                           struct jp_chord *chord)
{
    const struct jp_trajectory_config *config = task->config;
    const jp_q16 voltage = voltage_for_turns(task);
    struct demand demands[2];
    enum jp_status status = measure(task, index, chord);

    if (status == JP_OK) {
        status = demands_of(task, index, before, chord, demands);
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
    if (task->to_stand && index + 1U == task->count) {
        blend = slow_to_stop(config, way, blend, chord);
    }
    chord->blend = (uint32_t)(((uint64_t)(uint32_t)blend * config->tick_rate / JP_TICKS_PER_SET_POINT) >> 16) + 1U;
    return chord->speed < SPEED_MIN ? JP_ERR_INFEASIBLE : JP_OK;
}

struct jp_waypoint_motion jp_corner_between(const struct jp_trajectory_task *task, const struct jp_chord *before,
                                            const struct jp_chord *after)
{
    static const struct effort at_pace = {JP_Q24(1.5), JP_Q24(3)};
    const struct jp_trajectory_config *config = task->config;
    const int32_t turn = (int32_t)(after->direction - before->direction);
    const uint32_t set_points = before->blend < after->blend ? before->blend : after->blend;
    const jp_q16 blend = jp_seconds(config, set_points, 16);
    const struct demand demand = demand_of(config, &at_pace, turn_between(before->direction, after->direction));
    const jp_q24 smooth = jp_divide((int64_t)SMOOTH_Q40, blend);
    const bool is_pace = config->turn_pace > smooth && is_enough(voltage_for_turns(task), &demand, blend);

    return (struct jp_waypoint_motion){
        .heading = before->direction + (jp_angle)(turn / 2),
        .turn_rate = jp_multiply_shift(turn, is_pace ? config->turn_pace : smooth, 32),
        .speed = before->speed < after->speed ? before->speed : after->speed,
    };
}
