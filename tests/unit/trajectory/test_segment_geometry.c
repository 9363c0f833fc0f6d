/* Where a target lies, how long a segment takes at least, and what it becomes, against integers and double precision.
 */
#include "src/trajectory/segment_geometry.h"

#include "src/base/integer.h"
#include "src/trajectory/segment_arc.h"
#include "tests/target/random.h"
#include "unity.h"

static uint32_t state;
static struct jp_segment_limits limits;

void setUp(void)
{
    state = 17;
    limits = (struct jp_segment_limits){JP_Q24(1), JP_Q24(0.8), JP_Q24(0.9), JP_Q16(600)};
}

void tearDown(void)
{
}

static int32_t between(int32_t low, int32_t high)
{
    return (int32_t)((uint32_t)low + target_random(&state) % ((uint32_t)high - (uint32_t)low + 1U));
}

/* ---- Polar coordinates ---- */

static const struct jp_point origin = {0, 0};

/* The square is exact in 64 bits: the distance, in 2⁻²² m, is within some units of its root. */
static void expect_polar(const struct jp_point *from, int32_t dx, int32_t dy)
{
    const struct jp_point to = {from->x + dx, from->y + dy};
    const uint64_t square = (uint64_t)((int64_t)dx * dx + (int64_t)dy * dy);
    uint32_t distance = 0;
    jp_angle direction = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_segment_polar(from, &to, &distance, &direction));

    const uint64_t slack = 64U + distance / 100000000U;
    const uint64_t low = (uint64_t)distance - slack;
    const uint64_t high = (uint64_t)distance + slack;

    TEST_ASSERT_TRUE((low >> 6) * (low >> 6) <= square);
    TEST_ASSERT_TRUE(((high >> 6) + 1U) * ((high >> 6) + 1U) >= square);
    /* Across the direction it is off by nothing, along it by all of it. */
    TEST_ASSERT_INT32_WITHIN(4, 0,
                             (int32_t)(((int64_t)dy * jp_cos(direction) - (int64_t)dx * jp_sin(direction)) >> 31));
    TEST_ASSERT_TRUE((int64_t)dx * jp_cos(direction) + (int64_t)dy * jp_sin(direction) > 0);
}

static void test_distance_and_direction_of_a_target(void)
{
    for (int i = 0; i < 300; i++) {
        const int32_t reach = (int32_t)(1U << (7U + target_random(&state) % 18U));
        const struct jp_point from = {between(-JP_Q16(1000), JP_Q16(1000)), between(-JP_Q16(1000), JP_Q16(1000))};

        expect_polar(&from, between(-reach, reach), 66 + between(0, reach / 2));
        expect_polar(&from, -66 - between(0, reach / 2), between(-reach, reach));
    }
}

static void test_targets_that_are_too_far_or_too_near(void)
{
    static const int32_t far = JP_SEGMENT_LENGTH_MAX;
    static const int32_t near = JP_SEGMENT_LENGTH_MIN;
    static const struct {
        struct jp_point to;
        enum jp_status status;
    } cases[] = {{{JP_SEGMENT_LENGTH_MAX, 0}, JP_OK},
                 {{0, -JP_SEGMENT_LENGTH_MAX}, JP_OK},
                 {{JP_SEGMENT_LENGTH_MAX + 1, 0}, JP_ERR_ARGUMENT},
                 {{0, JP_SEGMENT_LENGTH_MAX + 1}, JP_ERR_ARGUMENT},
                 {{-JP_SEGMENT_LENGTH_MAX - 1, 0}, JP_ERR_ARGUMENT},
                 {{JP_SEGMENT_LENGTH_MAX, 100}, JP_ERR_ARGUMENT},
                 {{JP_SEGMENT_LENGTH_MIN, 0}, JP_OK},
                 {{0, -JP_SEGMENT_LENGTH_MIN}, JP_OK},
                 {{JP_SEGMENT_LENGTH_MIN - 1, 0}, JP_ERR_ZERO_LENGTH},
                 {{0, 0}, JP_ERR_ZERO_LENGTH}};
    uint32_t distance;
    jp_angle direction;

    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        TEST_ASSERT_EQUAL_INT(cases[i].status, jp_segment_polar(&origin, &cases[i].to, &distance, &direction));
    }
    TEST_ASSERT_EQUAL_INT(
        JP_OK, jp_segment_polar(&origin, &(struct jp_point){far * 3 / 5, far * 4 / 5}, &distance, &direction));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_segment_polar(&origin, &(struct jp_point){near, near}, &distance, &direction));
}

/* ---- Durations ---- */

/* Of all durations in Q16 the first that is long enough, in exact products: Q16 s times Q24 m/s. */
static void expect_shortest(jp_q16 least, uint32_t distance)
{
    const jp_q16 found = jp_segment_shortest(least, &limits, distance);
    const jp_q16 first = least < JP_SEGMENT_DURATION_MIN ? JP_SEGMENT_DURATION_MIN : least;
    const uint64_t travel = (uint64_t)distance << 18;

    TEST_ASSERT_GREATER_OR_EQUAL_INT32(first, found);
    TEST_ASSERT_TRUE(found == INT32_MAX || (uint64_t)(uint32_t)found * (uint32_t)limits.speed >= travel);
    TEST_ASSERT_TRUE(found == first || ((uint64_t)(uint32_t)found - 1U) * (uint32_t)limits.speed < travel);
}

static void test_the_shortest_duration_is_the_first_that_is_long_enough(void)
{
    for (int i = 0; i < 300; i++) {
        limits.speed = between(1, (int32_t)(1U << (2U + target_random(&state) % 26U)));
        expect_shortest(between(0, JP_Q16(10)), (uint32_t)between(1, 1 << 30));
        expect_shortest(0, (uint32_t)between(4194, 1 << 20));
    }
    limits.speed = JP_Q24(1);
    TEST_ASSERT_EQUAL_INT32(JP_SEGMENT_DURATION_MIN, jp_segment_shortest(0, &limits, 4194));
    TEST_ASSERT_EQUAL_INT32(JP_SEGMENT_DURATION_MIN + 1, jp_segment_shortest(JP_SEGMENT_DURATION_MIN + 1, &limits, 1));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(3), jp_segment_shortest(0, &limits, 3U << 22));
    limits.speed = 1;
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_segment_shortest(0, &limits, 512U << 22));
}

/* ---- Segments ---- */

static double in_metres(uint32_t distance)
{
    return (double)distance * 0x1p-22;
}

static struct jp_segment store(uint32_t distance, jp_angle bearing, jp_q16 time_min, int32_t x, int32_t xi)
{
    struct jp_segment segment;

    jp_segment_store(&limits, distance, bearing, time_min, x, xi, &segment);
    return segment;
}

/* Its length is that of the chord over sinc, and its angle 2πx; what it is told leads along it, within the limits. */
static void expect_segment(uint32_t distance, int32_t x, int32_t xi, jp_q16 time_min)
{
    const jp_angle bearing = (uint32_t)x + (uint32_t)between(-400000000, 400000000);
    const struct jp_segment found = store(distance, bearing, time_min, x, xi);
    const struct jp_segment_command *const command = &found.command;
    struct jp_arc arc;

    jp_arc_at(x, &arc);

    const double length = in_metres(distance) / ((double)arc.sinc * 0x1p-29);
    const double angle = 6.283185307179586 * (double)x * 0x1p-31;
    const double seconds = (double)command->duration * 0x1p-16;
    const double wanted = (double)time_min * 0x1p-16 / ((double)xi * 0x1p-30);
    const double by_speed = length / ((double)limits.speed * 0x1p-24);
    const double by_turn = (angle < 0.0 ? -angle : angle) / ((double)limits.turn_rate * 0x1p-24);
    double longest = wanted > by_speed ? wanted : by_speed;

    longest = longest > by_turn ? longest : by_turn;
    longest = longest < (double)limits.duration * 0x1p-16 ? longest : (double)limits.duration * 0x1p-16;
    TEST_ASSERT_INT32_WITHIN(2, (int32_t)(length * 0x1p16), found.length);
    TEST_ASSERT_INT32_WITHIN(1, (int32_t)(angle * 0x1p24), found.arc);
    TEST_ASSERT_INT32_WITHIN(2 + command->duration / 100000000, (int32_t)(longest * 0x1p16), command->duration);
    if (length / seconds < (double)limits.speed * 0x1p-24) {
        /* The length is rounded down to 2⁻²² m. */
        TEST_ASSERT_INT32_WITHIN(3 + (int32_t)(4.0 / seconds), (int32_t)(length / seconds * 0x1p24),
                                 command->motion.speed);
    }
    TEST_ASSERT_LESS_OR_EQUAL_INT32(limits.speed, command->motion.speed);
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, command->motion.speed);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(limits.turn_rate, (int32_t)jp_magnitude32(command->motion.turn_rate));
    if ((angle < 0.0 ? -angle : angle) / seconds < (double)limits.turn_rate * 0x1p-24) {
        TEST_ASSERT_INT32_WITHIN(3, (int32_t)(angle / seconds * 0x1p24), command->motion.turn_rate);
    }
    TEST_ASSERT_INT32_WITHIN(1, jp_clamp32(jp_angle_to_radians(bearing - (uint32_t)x), -limits.turn, limits.turn),
                             command->turn);
}

static void test_a_segment_leads_along_its_arc_within_the_limits(void)
{
    for (int i = 0; i < 400; i++) {
        const uint32_t distance = (uint32_t)between(4194, (int32_t)(1U << (13U + target_random(&state) % 18U)));
        const int32_t x = between(-JP_HALF_ARC_MAX, JP_HALF_ARC_MAX) / (i % 3 == 0 ? 1 : 4);
        const int32_t xi = (int32_t)((1U << 30) >> (target_random(&state) % 5U)) - between(0, 1 << 20);

        limits.turn_rate = i % 2 == 0 ? JP_Q24(8) : JP_Q24(0.05);
        limits.speed = i % 5 == 0 ? JP_Q24(0.3) : JP_Q24(1.5);
        limits.duration = i % 7 == 0 ? JP_Q16(40) : JP_Q16(16384);

        const jp_q16 time_min = jp_segment_shortest(JP_Q16(0.5), &limits, distance);

        if (time_min <= limits.duration) {
            expect_segment(distance, x, xi, time_min);
        }
    }
}

/* The longest one of all, of which the length does not fit 31 bits. */
static void test_a_segment_of_the_greatest_length(void)
{
    limits = (struct jp_segment_limits){JP_Q24(8), JP_Q24(8), JP_Q24(3), JP_Q16(16384)};
    for (int i = 0; i <= 20; i++) {
        expect_segment(511U << 22, (JP_HALF_ARC_MAX / 20) * i, (1 << 30) - 1, JP_Q16(400));
    }
}
