/* Wrong packets on LCM at the gateway to CAN: each is counted and named, none is acted on; what is right becomes the
 * operator's task. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/captured.h"
#include "tests/support/lcm_rig.h"

#define COUNT_PLACE 16 /* of a jp_route_t, in bytes */
#define DATA_PLACE  20

static struct packet route_of(int32_t count, double x, double y)
{
    static jp_point_t points[64];
    const jp_route_t route = {.count = count, .points = points};
    struct packet packet;

    for (int32_t i = 0; i < count; i++) {
        points[i] = (jp_point_t){x, y};
    }
    packet.size = (size_t)jp_route_t_encode(packet.bytes, 0, PACKET_MAX, &route);
    return packet;
}

static struct packet with_count(struct packet packet, uint32_t count)
{
    for (unsigned i = 0; i < 4; i++) {
        packet.bytes[COUNT_PLACE + i] = (uint8_t)(count >> (24 - 8 * i));
    }
    return packet;
}

static void check_dropped(const char *channel, const struct packet *packet, enum lcm_task_result why)
{
    const uint64_t before = gateway.dropped[why];

    TEST_ASSERT_FALSE_MESSAGE(is_taken(channel, packet), lcm_task_text(why));
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(before + 1, gateway.dropped[why], lcm_task_text(why));
    drain();
}

static uint64_t all_dropped(void)
{
    uint64_t all = 0;

    for (int i = 0; i < LCM_TASK_RESULTS; i++) {
        all += gateway.dropped[i];
    }
    return all;
}

static void test_sound_packets_become_the_operators_task(void)
{
    TEST_ASSERT_TRUE(is_taken("JP_ROUTE", &sound_route));
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, gateway.operator.commander.phase);
    TEST_ASSERT_EQUAL_UINT(3, gateway.operator.commander.task.length);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(10), gateway.operator.commander.task.points[0].x);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(-511.5), gateway.operator.commander.task.points[1].x);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(-0.0625), gateway.operator.commander.task.points[2].y);
    TEST_ASSERT_TRUE(is_taken("JP_GOAL", &sound_goal));
    TEST_ASSERT_EQUAL_UINT(1, gateway.operator.commander.task.length);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(-3.5), gateway.operator.commander.task.points[0].x);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(4.75), gateway.operator.commander.task.points[0].y);
    TEST_ASSERT_EQUAL_UINT64(0, all_dropped());
}

static void check_truncations(const char *channel, const struct packet *sound)
{
    struct packet packet = *sound;

    for (packet.size = 0; packet.size < sound->size; packet.size++) {
        check_dropped(channel, &packet, packet.size < 8 ? LCM_TASK_TYPE : LCM_TASK_LENGTH);
    }
    for (packet.size = sound->size + 1; packet.size <= sound->size + 40; packet.size++) {
        check_dropped(channel, &packet, LCM_TASK_LENGTH);
    }
}

static void test_every_truncation_and_extension_is_dropped(void)
{
    check_truncations("JP_ROUTE", &sound_route);
    check_truncations("JP_GOAL", &sound_goal);
}

static double double_at(const uint8_t *bytes)
{
    uint64_t bits = 0;
    double value;

    for (int i = 0; i < 8; i++) {
        bits = bits << 8 | bytes[i];
    }
    memcpy(&value, &bits, sizeof value);
    return value;
}

static bool is_place(double metres)
{
    return isfinite(metres) && metres >= -512 - 0.49 / 65536 && metres < 512 - 0.5 / 65536;
}

/** LCM has no checksum: a coordinate that flips into another sound one cannot be told from it. */
static bool is_sound(const struct packet *packet, size_t data_place)
{
    for (size_t i = data_place; i < packet->size; i += 8) {
        if (!is_place(double_at(packet->bytes + i))) {
            return false;
        }
    }
    return true;
}

static void check_flips(const char *channel, const struct packet *sound, size_t data_place)
{
    for (size_t bit = 0; bit < 8 * sound->size; bit++) {
        struct packet packet = *sound;
        const size_t place = bit / 8;
        const bool in_time = place >= 8 && place < COUNT_PLACE;

        packet.bytes[place] ^= (uint8_t)(1u << bit % 8);

        const bool expected = in_time || (place >= data_place && is_sound(&packet, data_place));
        const uint64_t before = all_dropped();

        TEST_ASSERT_EQUAL_INT(expected, is_taken(channel, &packet));
        TEST_ASSERT_EQUAL_UINT64(before + !expected, all_dropped());
        drain();
    }
}

static void test_every_flipped_bit_is_dropped_or_leaves_a_sound_packet(void)
{
    check_flips("JP_ROUTE", &sound_route, DATA_PLACE);
    check_flips("JP_GOAL", &sound_goal, COUNT_PLACE);
}

static void test_counts_that_are_not_those_of_a_route(void)
{
    static const uint32_t wrong[] = {0,          33,         34,         255,        256,        0x7fffffff,
                                     0x80000000, 0xffffffff, 0xfffffffd, 0x10000003, 0x08000000, 0x40000000};
    const struct packet none = route_of(0, 0, 0);
    const struct packet many = route_of(33, 1, 1);
    const struct packet most = route_of(32, 1, 1);
    struct packet packet;

    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        packet = with_count(sound_route, wrong[i]);
        check_dropped("JP_ROUTE", &packet, LCM_TASK_COUNT);
    }
    for (uint32_t count = 1; count <= 32; count++) {
        packet = with_count(sound_route, count);
        if (count != 3) {
            check_dropped("JP_ROUTE", &packet, LCM_TASK_LENGTH);
        }
    }
    check_dropped("JP_ROUTE", &none, LCM_TASK_COUNT);
    check_dropped("JP_ROUTE", &many, LCM_TASK_COUNT);
    TEST_ASSERT_TRUE(is_taken("JP_ROUTE", &most));
    TEST_ASSERT_EQUAL_UINT(32, gateway.operator.commander.task.length);
}

static void test_coordinates_at_and_beyond_their_limits(void)
{
    static const double sound[] = {0, -0.0, 5e-324, -512, 511.9999, 512 - 1 / 65536.0};
    static const double far[] = {512, -512.0001, 512 - 0.4 / 65536, 1e6, -1e300, 32768, 65536, 1.7e308};
    static const double odd[] = {NAN, -NAN, INFINITY, -INFINITY};
    struct packet packet;

    for (size_t i = 0; i < sizeof sound / sizeof sound[0]; i++) {
        packet = route_of(2, 1, sound[i]);
        TEST_ASSERT_TRUE(is_taken("JP_ROUTE", &packet));
        TEST_ASSERT_EQUAL_INT32((int32_t)rint(sound[i] * 65536), gateway.operator.commander.task.points[1].y);
        drain();
    }
    for (size_t i = 0; i < sizeof far / sizeof far[0]; i++) {
        packet = route_of(2, far[i], 1);
        check_dropped("JP_ROUTE", &packet, LCM_TASK_FAR);
        packet = route_of(32, 1, far[i]);
        check_dropped("JP_ROUTE", &packet, LCM_TASK_FAR);
    }
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++) {
        packet = route_of(1, odd[i], 1);
        check_dropped("JP_ROUTE", &packet, LCM_TASK_NUMBER);
        packet = route_of(9, 1, odd[i]);
        check_dropped("JP_ROUTE", &packet, LCM_TASK_NUMBER);
    }
}

static void test_packets_of_other_types(void)
{
    struct packet packet;
    char nothing[] = "";
    const jp_state_t other = {.task_reason = nothing};

    check_dropped("JP_ROUTE", &sound_goal, LCM_TASK_TYPE);
    check_dropped("JP_GOAL", &sound_route, LCM_TASK_TYPE);
    packet.size = (size_t)jp_state_t_encode(packet.bytes, 0, PACKET_MAX, &other);
    check_dropped("JP_ROUTE", &packet, LCM_TASK_TYPE);
    check_dropped("JP_GOAL", &packet, LCM_TASK_TYPE);
}

static void test_junk_is_dropped(void)
{
    for (int i = 0; i < JUNK; i++) {
        struct packet packet = i % 2 == 0 ? sound_route : sound_goal;
        /* Half of it with the right fingerprint. */
        const size_t from = i % 4 < 2 ? 8 : 0;

        packet.size = (size_t)random_uniform(&noise, 0, 200);
        for (size_t at = from; at < packet.size; at++) {
            packet.bytes[at] = (uint8_t)random_uniform(&noise, 0, 256);
        }

        const uint64_t before = all_dropped();
        const bool taken = is_taken(i % 2 == 0 ? "JP_ROUTE" : "JP_GOAL", &packet);

        TEST_ASSERT_TRUE_MESSAGE(!taken || i % 4 == 1, "only a goal's fingerprint before 24 bytes may be sound");
        TEST_ASSERT_EQUAL_UINT64(before + !taken, all_dropped());
        drain();
    }
}

static void test_a_bad_packet_leaves_the_task_alone(void)
{
    struct packet bad = sound_route;

    TEST_ASSERT_TRUE(is_taken("JP_ROUTE", &sound_route));
    bad.size--;
    TEST_ASSERT_EQUAL_INT(0, lcm_publish(lcm, "JP_ROUTE", bad.bytes, (unsigned)bad.size));
    bad = route_of(2, 600, 0);
    TEST_ASSERT_EQUAL_INT(0, lcm_publish(lcm, "JP_ROUTE", bad.bytes, (unsigned)bad.size));
    lcm_gateway_pass(&gateway, now_us + MS);
    TEST_ASSERT_EQUAL_UINT64(2, all_dropped());
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_STANDING_UP, gateway.operator.commander.phase);
    TEST_ASSERT_EQUAL_UINT(3, gateway.operator.commander.task.length);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(10), gateway.operator.commander.task.points[0].x);
}

/** Keeps what the gateway says while `count` bad packets come within a millisecond each. */
static void say(const struct packet *packet, int count)
{
    capture_begin();
    for (int i = 0; i < count; i++) {
        (void)is_taken("JP_ROUTE", packet);
    }
    capture_end();
}

static unsigned count_lines(const char *text)
{
    unsigned lines = 0;

    for (; *text != '\0'; text++) {
        lines += *text == '\n';
    }
    return lines;
}

static void test_each_kind_is_named_at_most_once_a_second(void)
{
    const struct packet far = route_of(2, 600, 0);
    struct packet cut = sound_route;

    cut.size -= 3;
    say(&far, 1);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(1, count_lines(errors), errors);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(errors, "JP_ROUTE: a point is not within 512 m"), errors);
    say(&far, 900);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(0, count_lines(errors), errors);
    say(&cut, 1);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(1, count_lines(errors), errors);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(errors, "cut off"), errors);
    say(&far, 2000);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(2, count_lines(errors), errors);
    TEST_ASSERT_EQUAL_UINT64(2901, gateway.dropped[LCM_TASK_FAR]);
}

int main(void)
{
    printf("seed %u\n", SEED);
    make_packets();
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
