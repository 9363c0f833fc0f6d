/**
 * Packets from anybody over LCM: maps, cells, goals and routes, of any bytes or with a fingerprint and numbers of the
 * input's choice. What is taken is in range, and what is refused changes nothing of the map.
 */
#include <math.h>

#include "sim/lcm/lcm_operator.h"
#include "tests/fuzz/fuzz_input.h"

#include "jp_cells_t.h"
#include "jp_goal_t.h"
#include "jp_map_goal_t.h"
#include "jp_map_t.h"
#include "jp_route_t.h"

#define PACKET 4096
#define SIDE   12
#define POINTS 40

static uint8_t packet[PACKET];
static struct lcm_operator operator;

static double draw_number(struct fuzz_input *input, double most)
{
    double value;

    if (fuzz_below(input, 32) == 31U) {
        fuzz_fill(input, &value, sizeof value);
        return value;
    }
    return most * fuzz_range(input, -32768, 32767) / 32768.0;
}

static jp_point_t draw_point(struct fuzz_input *input)
{
    return (jp_point_t){draw_number(input, 20), draw_number(input, 20)};
}

static int goal(struct fuzz_input *input)
{
    const jp_goal_t message = {.utime = 1, .point = draw_point(input)};

    return jp_goal_t_encode(packet, 0, PACKET, &message);
}

static int route(struct fuzz_input *input)
{
    static jp_point_t points[POINTS];
    const jp_route_t message = {.count = (int32_t)fuzz_below(input, POINTS + 1U), .points = points};

    for (unsigned i = 0; i < POINTS; i++) {
        points[i] = draw_point(input);
    }
    return jp_route_t_encode(packet, 0, PACKET, &message);
}

static int map(struct fuzz_input *input)
{
    static uint8_t cells[SIDE][SIDE];
    static uint8_t *rows[SIDE];
    const jp_map_t message = {.map_id = (int16_t)fuzz_below(input, 17),
                              .width = (int16_t)fuzz_below(input, SIDE + 1U),
                              .height = (int16_t)fuzz_below(input, SIDE + 1U),
                              .resolution = fuzz_bool(input) ? 0.2 : draw_number(input, 1),
                              .unknown_is_free = (int8_t)fuzz_below(input, 3),
                              .origin = draw_point(input),
                              .origin_heading = draw_number(input, 4),
                              .cells = rows};

    for (unsigned y = 0; y < SIDE; y++) {
        rows[y] = cells[y];
        for (unsigned x = 0; x < SIDE; x++) {
            cells[y][x] = (uint8_t)(fuzz_below(input, 64) == 63U ? fuzz_u8(input) : fuzz_below(input, 3));
        }
    }
    return jp_map_t_encode(packet, 0, PACKET, &message);
}

static int cells(struct fuzz_input *input)
{
    static jp_cell_t some[POINTS];
    const jp_cells_t message = {
        .map_id = (int16_t)fuzz_below(input, 17), .count = (int32_t)fuzz_below(input, POINTS + 1U), .cells = some};

    for (unsigned i = 0; i < POINTS; i++) {
        some[i] = (jp_cell_t){(int16_t)fuzz_below(input, SIDE + 1U), (int16_t)fuzz_below(input, SIDE + 1U),
                              (int8_t)fuzz_below(input, 4)};
    }
    return jp_cells_t_encode(packet, 0, PACKET, &message);
}

static int map_goal(struct fuzz_input *input)
{
    const jp_map_goal_t message = {.map_id = (int16_t)fuzz_below(input, 17),
                                   .point = draw_point(input),
                                   .has_heading = (int8_t)fuzz_below(input, 3),
                                   .heading = draw_number(input, 4)};

    return jp_map_goal_t_encode(packet, 0, PACKET, &message);
}

static int (*const make[])(struct fuzz_input *input) = {goal, route, map, cells, map_goal};
static lcm_operator_take *const takes[] = {lcm_operator_goal, lcm_operator_route, lcm_operator_map, lcm_operator_cells,
                                           lcm_operator_map_goal};
#define KINDS (sizeof takes / sizeof takes[0])

/** A packet of the kind, as it is or cut, or of any bytes. */
static size_t draw_packet(struct fuzz_input *input, unsigned kind)
{
    size_t size = 0;

    if (fuzz_below(input, 8) == 7U) {
        size = fuzz_below(input, 256);
        fuzz_fill(input, packet, size);
        return size;
    }
    const int length = make[kind](input);

    fuzz_require(length > 0, "a message that cannot be encoded");
    size = (size_t)length;
    switch (fuzz_below(input, 16)) {
    case 0:
        return fuzz_below(input, (uint32_t)size);
    case 1:
        packet[fuzz_below(input, (uint32_t)size)] = fuzz_u8(input);
        return size;
    case 2:
        return size + 1U;
    default:
        return size;
    }
}

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    fuzz_require(frame->length <= JP_CAN_LENGTH_MAX, "a frame that is none");
    return JP_OK;
}

static enum jp_can_state state(void *context)
{
    (void)context;
    return JP_CAN_ON;
}

static void check_map(const struct lcm_map *known)
{
    fuzz_require(known->id <= 15U, "the id of a map");
    if (known->id != 0U) {
        const int32_t x = known->terrain.config.width - 1;
        const int32_t y = known->terrain.config.height - 1;

        fuzz_require(known->terrain.config.width <= JP_TERRAIN_SIDE_MAX && known->terrain.config.resolution > 0 &&
                         jp_terrain_cell(&known->terrain, x, y) <= JP_CELL_UNKNOWN,
                     "a map out of range");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static const struct jp_can_port port = {.send = send, .state = state};
    struct fuzz_input input = {.next = bytes, .left = size};
    uint32_t time = 0;

    memset(&operator, 0, sizeof operator);
    for (unsigned left = 40; left > 0U && fuzz_more(&input); left--) {
        const unsigned kind = fuzz_below(&input, KINDS);
        const size_t length = draw_packet(&input, kind);
        const unsigned reader = fuzz_below(&input, 16) == 15U ? fuzz_below(&input, KINDS) : kind;
        const enum lcm_task_result result = takes[reader](&operator, packet, length);

        fuzz_require(result >= LCM_TASK_OK && result < LCM_TASK_RESULTS && lcm_task_text(result) != NULL, "no result");
        check_map(&operator.map);
        if (fuzz_below(&input, 16) == 15U) {
            lcm_operator_stop(&operator);
        }
        for (unsigned ticks = fuzz_below(&input, 8); ticks > 0U; ticks--) {
            struct jp_can_frame frame = {.id = 0x180U + fuzz_below(&input, 32), .length = 8};

            fuzz_fill(&input, frame.data, sizeof frame.data);
            lcm_operator_accept(&operator, & frame);
            time += fuzz_below(&input, 200);
            lcm_operator_tick(&operator, time, &port);
        }
        (void)lcm_operator_phase(&operator);
        (void)lcm_operator_failure_text(&operator);
    }
    lcm_operator_free(&operator);
    return 0;
}
