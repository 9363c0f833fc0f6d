#include "src/skid_steer/skid_arithmetic.h"

#define QUOTIENT_MAX ((int64_t)1 << 24)

int64_t jp_skid_over(int32_t x, unsigned bits, int32_t divisor)
{
    const int64_t quotient = (int64_t)x * ((int64_t)1 << bits) / divisor;

    return quotient > QUOTIENT_MAX ? QUOTIENT_MAX : quotient;
}
