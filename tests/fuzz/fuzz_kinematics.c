/**
 * Four steered wheels and two sides, with any configuration that passes its check and any motion: wheels are asked for
 * angles and speeds within their limits and change by no more than a tick allows, and powers stay in their formats.
 */
#include <joulepath/four_wheel.h>
#include <joulepath/four_wheel_robot.h>
#include <joulepath/skid_steer.h>
#include <joulepath/skid_tariff.h>
#include <joulepath/tables.h>
#include <joulepath/tariff.h>

#include "tests/fuzz/fuzz_config.h"
#include "tests/fuzz/fuzz_input.h"

static struct jp_four_wheel_config config;
static struct jp_skid_steer_config skid;

static void check_wheels(const struct jp_wheels *wheels)
{
    for (unsigned i = 0; i < (unsigned)JP_WHEELS; i++) {
        fuzz_require(wheels->angle[i] <= config.steering_limit && wheels->angle[i] >= -config.steering_limit,
                     "an angle beyond the limit");
        fuzz_require(wheels->speed[i] <= config.speed_max && wheels->speed[i] >= -config.speed_max, "a wheel too fast");
    }
}

static void check_change(const struct jp_wheels *before, const struct jp_wheels *after)
{
    for (unsigned i = 0; i < (unsigned)JP_WHEELS; i++) {
        const int64_t turned = (int64_t)after->angle[i] - before->angle[i];

        fuzz_require(turned <= config.steering_step && turned >= -config.steering_step, "steered too far in a tick");
    }
}

static struct jp_twist draw_twist(struct fuzz_input *input)
{
    struct jp_twist twist = {.x = fuzz_range(input, -JP_Q24(2), JP_Q24(2)),
                             .y = fuzz_range(input, -JP_Q24(2), JP_Q24(2)),
                             .turn_rate = fuzz_range(input, -JP_Q24(2), JP_Q24(2))};

    if (fuzz_below(input, 8) == 7U) {
        FUZZ_CHANGE(input, twist);
    }
    return twist;
}

static void drive(struct fuzz_input *input)
{
    struct jp_wheels wheels = {.angle = {0}};
    struct jp_twist twist;
    jp_q24 slip = 0;

    fuzz_require(jp_four_wheel_radius_min(&config) >= 0, "a radius below 0");
    (void)jp_four_wheel_twist(&config, (jp_q24)fuzz_u32(input), (int32_t)fuzz_u32(input), &twist);
    for (unsigned left = 32; left > 0U && fuzz_more(input); left--) {
        const struct jp_twist asked = draw_twist(input);
        const struct jp_wheels present = wheels;
        struct jp_wheels found = wheels;

        if (jp_four_wheel_inverse(&config, &asked, &found) == JP_OK) {
            check_wheels(&found);
        } else {
            fuzz_require(memcmp(&found, &present, sizeof found) == 0, "wheels changed by a twist that is refused");
        }
        for (unsigned ticks = 1U + fuzz_below(input, 16); ticks > 0U; ticks--) {
            const struct jp_wheels before = wheels;
            enum jp_steering steering = JP_STEERING_ALIGNED;

            (void)jp_four_wheel_tick(&config, &asked, &wheels, &steering);
            check_wheels(&wheels);
            check_change(&before, &wheels);
            fuzz_require(steering <= JP_STEERING_STANDSTILL, "no way to steer");
        }
        jp_four_wheel_forward(&config, &wheels, &twist, &slip);
        fuzz_require(slip >= 0, "a slip below 0");
    }
}

static void forward_of_any(struct fuzz_input *input)
{
    struct jp_wheels wheels;
    struct jp_twist twist;
    jp_q24 slip = 0;

    fuzz_fill(input, &wheels, sizeof wheels);
    jp_four_wheel_forward(&config, &wheels, &twist, &slip);
    fuzz_require(slip >= 0, "a slip below 0");
}

static void charge(struct fuzz_input *input)
{
    const struct jp_motion motion = {fuzz_range(input, -JP_Q24(9), JP_Q24(9)),
                                     fuzz_range(input, -JP_Q24(9), JP_Q24(9))};
    const jp_q24 grade = fuzz_range(input, -JP_Q24(1.1), JP_Q24(1.1));
    const enum jp_cost_kind kind = (enum jp_cost_kind)fuzz_below(input, JP_COST_KINDS);
    struct jp_skid_steer_sides sides;
    struct jp_tariff_factors factors;
    jp_q16 result = 0;

    (void)jp_skid_steer_wheel_speeds(&skid, &motion, &sides);
    (void)jp_skid_steer_torques(&skid, &motion, grade, &sides);
    (void)jp_skid_steer_power(&skid, kind, &motion, grade, &result);
    (void)jp_skid_steer_power_of(&skid, &motion, grade);
    (void)jp_skid_steer_energy(&skid, kind, &motion, fuzz_range(input, -JP_Q24(9), JP_Q24(9)),
                               fuzz_range(input, -1, JP_Q16(300)), &result);
    (void)jp_skid_tariff_factors(&skid, &jp_skid_energy_zhang2018, &motion, 1, &factors);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    const char *field = NULL;

    config = jp_four_wheel_robot_patrol.wheels;
    skid = fuzz_bool(&input) ? jp_skid_steer_zhang2018 : jp_skid_steer_burger;
    FUZZ_CHANGE(&input, config);
    FUZZ_CHANGE(&input, skid);
    if (fuzz_accepted(jp_skid_steer_check(&skid, &field), field)) {
        for (unsigned left = 1U + fuzz_below(&input, 8); left > 0U; left--) {
            charge(&input);
        }
    }
    if (fuzz_accepted(jp_four_wheel_check(&config, &field), field)) {
        forward_of_any(&input);
        drive(&input);
    }
    return 0;
}
