#include <joulepath/four_wheel_trip.h>
#include <stddef.h>

#include "src/base/config_check.h"
#include "src/base/integer.h"

#define SPEED_MAX  JP_Q24(8)
#define TRAVEL_MAX JP_Q16(256)
#define SECONDS    25U

#define TWO_PI_Q16 411775

#define FIELD(member, low, high)                                                                                       \
    JP_CONFIG_FIELD("four_wheel_trip.", struct jp_four_wheel_trip_config, member, low, high)

enum jp_status jp_four_wheel_trip_init(struct jp_four_wheel_trip *trip, const struct jp_four_wheel_trip_config *config,
                                       const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(tick_rate, 10, 10000),
        FIELD(piece_ticks, 1, 1000),
    };
    const enum jp_status status =
        trip == NULL ? JP_ERR_ARGUMENT : jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status != JP_OK) {
        return status;
    }
    if (config->piece_ticks > SECONDS * config->tick_rate) {
        return jp_config_refuse("four_wheel_trip.piece_ticks", field);
    }
    *trip = (struct jp_four_wheel_trip){.config = *config};
    return JP_OK;
}

static jp_q24 in_range(jp_q24 speed)
{
    return jp_clamp32(speed, -SPEED_MAX, SPEED_MAX);
}

static struct jp_twist twist_of(const struct jp_four_wheel_trip *trip, const struct jp_wheels *wheels)
{
    struct jp_twist twist;
    jp_q24 slip;

    jp_four_wheel_forward(&trip->config.wheels, wheels, &twist, &slip);
    return (struct jp_twist){in_range(twist.x), in_range(twist.y), in_range(twist.turn_rate)};
}

static uint64_t travel_of(const struct jp_wheels *from, const struct jp_wheels *to)
{
    uint64_t travel = 0;

    for (int i = 0; i < (int)JP_WHEELS; i++) {
        travel += (uint64_t)jp_absolute64((int64_t)to->angle[i] - from->angle[i]);
    }
    return travel;
}

/* rad in Q16 of 2⁻³² turn. */
static jp_q16 radians(uint64_t travel)
{
    const uint64_t angle = ((travel >> 16) * (uint64_t)TWO_PI_Q16) >> 16;

    return angle > (uint64_t)TRAVEL_MAX ? TRAVEL_MAX : (jp_q16)angle;
}

bool jp_four_wheel_trip_end(struct jp_four_wheel_trip *trip, struct jp_four_wheel_piece *piece)
{
    if (trip->ticks == 0U) {
        return false;
    }
    const int64_t ticks = trip->ticks;

    *piece = (struct jp_four_wheel_piece){
        .start = trip->start,
        .end = trip->now,
        .grade = (jp_q24)(trip->grade / ticks),
        .bank = (jp_q24)(trip->bank / ticks),
        .travel = radians(trip->travel),
        .duration = jp_divide(ticks * JP_Q16_ONE, (int32_t)trip->config.tick_rate),
    };
    trip->start = trip->now;
    trip->ticks = 0;
    trip->travel = 0;
    trip->grade = 0;
    trip->bank = 0;
    return true;
}

bool jp_four_wheel_trip_tick(struct jp_four_wheel_trip *trip, const struct jp_wheels *wheels, jp_q24 grade, jp_q24 bank,
                             struct jp_four_wheel_piece *piece)
{
    trip->now = twist_of(trip, wheels);
    if (!trip->is_begun) {
        trip->is_begun = true;
        trip->start = trip->now;
        trip->wheels = *wheels;
        return false;
    }
    trip->travel += travel_of(&trip->wheels, wheels);
    trip->wheels = *wheels;
    trip->grade += grade;
    trip->bank += bank;
    trip->ticks++;
    if (trip->ticks < trip->config.piece_ticks) {
        return false;
    }
    return jp_four_wheel_trip_end(trip, piece);
}
