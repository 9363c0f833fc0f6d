/** Any numbers within the ranges of fixed.h and of the core's own arithmetic. */
#include <joulepath/fixed.h>

#include "src/base/duty.h"
#include "src/base/integer.h"
#include "src/base/multiply_q32.h"
#include "src/base/point.h"
#include "src/base/power_of_half.h"
#include "src/base/reciprocal.h"
#include "tests/proof/any.h"

static void sums(int32_t a, int32_t b, int64_t x)
{
    (void)jp_saturate32(x);
    (void)jp_saturate_bits(a, 31);
    (void)jp_add(a, b);
    (void)jp_sub(a, b);
    (void)jp_round_shift(x, any_unsigned(61) + 1U);
    (void)jp_magnitude32(a);
    (void)jp_is_beyond(a, any_between(0, INT32_MAX));
}

static void products(int32_t a, int32_t b, int64_t x)
{
    (void)jp_multiply(a, b);
    (void)jp_multiply_shift(a, b, any_unsigned(61) + 1U);
    (void)jp_q16_multiply(a, b);
    (void)jp_q24_multiply(a, b);
    (void)jp_q31_multiply(a, b);
    (void)jp_multiply_accumulate(x, a, b);
}

static void quotients(int32_t a, int32_t b, int64_t x)
{
    (void)jp_divide(x, b);
    (void)jp_q16_divide(a, b);
    (void)jp_q24_divide(a, b);
    (void)jp_q31_divide(a, b);
    (void)jp_phase_per_rate(any_unsigned(0x7FFFFFFEU) + 2U);
}

static void functions(int32_t a, int32_t b, uint32_t angle)
{
    uint64_t square;

    ANY(square);
    (void)jp_square_root(square);
    (void)jp_q16_square_root(a);
    (void)jp_sin(angle);
    (void)jp_cos(angle);
    (void)jp_atan2(a, b);
    (void)jp_angle_from_radians(a);
    (void)jp_angle_to_radians(angle);
    (void)jp_phase_difference(square, (uint64_t)angle);
    (void)jp_phase_step(a, b);
    (void)jp_power_of_half(square);
}

static void duties(void)
{
    const jp_q16 bus_voltage = any_between(1, JP_Q16(1000));
    const struct jp_bus bus = jp_bus_of(bus_voltage);

    (void)jp_duty(any_between(-bus_voltage, bus_voltage), &bus);
}

static void shares(void)
{
    const struct jp_reciprocal reciprocal = jp_reciprocal_of(any_long(INT64_C(1) << 16, (INT64_C(1) << 48) - 1));

    (void)jp_share_of(any_long(-(INT64_C(1) << 46) + 1, (INT64_C(1) << 46) - 1), &reciprocal);
}

static void points(void)
{
    struct jp_point a;
    struct jp_point b;

    ANY(a);
    ANY(b);
    (void)jp_distance(&a, &b);
}

int main(void)
{
    const int32_t a = any_int();
    const int32_t b = any_int();
    const int64_t x = any_long(INT64_MIN, INT64_MAX);

    sums(a, b, x);
    products(a, b, x);
    quotients(a, b, x);
    functions(a, b, any_unsigned(UINT32_MAX));
    duties();
    shares();
    points();
    ARRIVED();
    return 0;
}
