#include "sim/lcm/lcm_task.h"

#include <jp_goal_t.h>
#include <jp_route_t.h>
#include <math.h>
#include <string.h>

#include "hal/can/jp_can.h"

#define FINGERPRINT_SIZE 8U

/** liblcm gives a datagram that ends before its channel's name does a size below 0, as an unsigned number. */
#define DATAGRAM_MAX 65536U

/* Of a jp_route_t: the fingerprint, utime, and the count, big-endian, which the points follow. */
#define COUNT_PLACE 16U
#define HEAD_SIZE   20U
#define POINT_SIZE  16U

const char *lcm_task_text(enum lcm_task_result result)
{
    switch (result) {
    case LCM_TASK_TYPE:
        return "the fingerprint is that of another type: are both sides built from the same sim/lcm/*.lcm?";
    case LCM_TASK_COUNT:
        return "a route has 1 to 32 points";
    case LCM_TASK_LENGTH:
        return "the packet is cut off, or longer than its points";
    case LCM_TASK_NUMBER:
        return "a coordinate is not a finite number";
    case LCM_TASK_FAR:
        return "a point is not within 512 m";
    case LCM_TASK_OK:
    case LCM_TASK_RESULTS:
    default:
        return "";
    }
}

static double to_raw(double metres)
{
    return rint(metres * JP_Q16_ONE);
}

static enum lcm_task_result to_point(const jp_point_t *from, struct jp_point *point)
{
    const double limit = 1 << 25; /* a signal of 26 bits */
    const double x = to_raw(from->x);
    const double y = to_raw(from->y);

    if (!isfinite(from->x) || !isfinite(from->y)) {
        return LCM_TASK_NUMBER;
    }
    if (x < -limit || x >= limit || y < -limit || y >= limit) {
        return LCM_TASK_FAR;
    }
    *point = (struct jp_point){.x = (int32_t)x, .y = (int32_t)y};
    return LCM_TASK_OK;
}

static enum lcm_task_result to_route(const jp_point_t *points, size_t count, struct jp_route_message *route)
{
    enum lcm_task_result result = LCM_TASK_OK;

    route->length = (uint8_t)count;
    for (size_t i = 0; i < count && result == LCM_TASK_OK; i++) {
        result = to_point(&points[i], &route->points[i]);
    }
    return result;
}

static bool begins_alike(const void *packet, size_t size, const uint8_t *sample)
{
    return size >= FINGERPRINT_SIZE && memcmp(packet, sample, FINGERPRINT_SIZE) == 0;
}

enum lcm_task_result lcm_task_goal(const void *packet, size_t size, struct jp_route_message *route)
{
    const jp_goal_t none = {.utime = 0};
    jp_goal_t goal;
    uint8_t sample[HEAD_SIZE + POINT_SIZE];
    const int goal_size = jp_goal_t_encode(sample, 0, sizeof sample, &none);

    if (size > DATAGRAM_MAX) {
        return LCM_TASK_LENGTH;
    }
    if (!begins_alike(packet, size, sample)) {
        return LCM_TASK_TYPE;
    }
    if (size != (size_t)goal_size || jp_goal_t_decode(packet, 0, goal_size, &goal) < 0) {
        return LCM_TASK_LENGTH;
    }
    return to_route(&goal.point, 1, route);
}

static uint32_t point_count(const uint8_t *packet)
{
    const uint8_t *at = packet + COUNT_PLACE;

    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

/** The generated decoder believes the count that it reads, so the packet is judged before. */
static enum lcm_task_result judge_route(const void *packet, size_t size)
{
    const jp_route_t none = {.count = 0};
    uint8_t sample[HEAD_SIZE];

    if (size > DATAGRAM_MAX) {
        return LCM_TASK_LENGTH;
    }
    (void)jp_route_t_encode(sample, 0, sizeof sample, &none);
    if (!begins_alike(packet, size, sample)) {
        return LCM_TASK_TYPE;
    }
    if (size < HEAD_SIZE) {
        return LCM_TASK_LENGTH;
    }

    const uint32_t count = point_count(packet);

    if (count < 1U || count > JP_ROUTE_LENGTH_MAX) {
        return LCM_TASK_COUNT;
    }
    return size == HEAD_SIZE + count * POINT_SIZE ? LCM_TASK_OK : LCM_TASK_LENGTH;
}

enum lcm_task_result lcm_task_route(const void *packet, size_t size, struct jp_route_message *route)
{
    jp_route_t message;
    enum lcm_task_result result = judge_route(packet, size);

    if (result != LCM_TASK_OK) {
        return result;
    }
    (void)jp_route_t_decode(packet, 0, (int)size, &message);
    result = to_route(message.points, (size_t)message.count, route);
    (void)jp_route_t_decode_cleanup(&message);
    return result;
}
