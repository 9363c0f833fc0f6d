#include "sim/lcm/lcm_task.h"

#include <jp_goal_t.h>
#include <jp_route_t.h>
#include <math.h>
#include <string.h>

#include "hal/can/jp_can.h"

#define FINGERPRINT_SIZE 8U

/** liblcm gives a datagram that ends before its channel's name does a size below 0, as an unsigned number. No message
 * is as long as that: the largest is a map of JP_TERRAIN_SIDE_MAX cells a side. */
#define MESSAGE_MAX 0x1000100U

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
        return "the packet is cut off, or longer than it says";
    case LCM_TASK_NUMBER:
        return "a coordinate is not a finite number";
    case LCM_TASK_FAR:
        return "a point is not within 512 m";
    case LCM_TASK_SIDE:
        return "a map has 1 to 4096 cells a side";
    case LCM_TASK_CELL:
        return "a cell is not 0 (free), 1 (occupied) or 2 (unknown)";
    case LCM_TASK_MAP_ID:
        return "the id of a map is 1 to 15";
    case LCM_TASK_RESOLUTION:
        return "the side of a cell is not above 0 and below 32768 m";
    case LCM_TASK_STREAM:
        return "the map takes more than the 65535 bytes that go over the bus: send a smaller window of it";
    case LCM_TASK_MEMORY:
        return "there is not enough memory for the map: send a smaller window of it";
    case LCM_TASK_CELLS:
        return "a message has 1 to 4096 cells";
    case LCM_TASK_NO_MAP:
        return "there is no map yet: send JP_MAP before";
    case LCM_TASK_OTHER_MAP:
        return "its map_id is not that of the last JP_MAP";
    case LCM_TASK_OUTSIDE:
        return "a place is not on the map";
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

enum lcm_task_result lcm_task_point(const jp_point_t *from, struct jp_point *point)
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
        result = lcm_task_point(&points[i], &route->points[i]);
    }
    return result;
}

enum lcm_task_result lcm_task_begins(const void *packet, size_t size, const uint8_t *sample, size_t sample_size)
{
    if (size > MESSAGE_MAX) {
        return LCM_TASK_LENGTH;
    }
    if (size < FINGERPRINT_SIZE || memcmp(packet, sample, FINGERPRINT_SIZE) != 0) {
        return LCM_TASK_TYPE;
    }
    return size < sample_size ? LCM_TASK_LENGTH : LCM_TASK_OK;
}

enum lcm_task_result lcm_task_goal(const void *packet, size_t size, struct jp_route_message *route)
{
    const jp_goal_t none = {.utime = 0};
    jp_goal_t goal;
    uint8_t sample[HEAD_SIZE + POINT_SIZE];
    const int goal_size = jp_goal_t_encode(sample, 0, sizeof sample, &none);
    const enum lcm_task_result result = lcm_task_begins(packet, size, sample, (size_t)goal_size);

    if (result != LCM_TASK_OK) {
        return result;
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

    (void)jp_route_t_encode(sample, 0, sizeof sample, &none);

    const enum lcm_task_result begins = lcm_task_begins(packet, size, sample, HEAD_SIZE);

    if (begins != LCM_TASK_OK) {
        return begins;
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
