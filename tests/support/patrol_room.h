/** A robot with four steered wheels alone in a rectangular room, for tests on any core with single precision: drives
 * that do at once what they are told, and a laser that sees the walls without noise. */
#ifndef TESTS_SUPPORT_PATROL_ROOM_H
#define TESTS_SUPPORT_PATROL_ROOM_H

#include <joulepath/four_wheel_robot.h>
#include <joulepath/patrol_scanner.h>
#include <joulepath/terrain.h>

#include "src/base/plane.h"

#define ROOM_WIDTH  120 /* cells */
#define ROOM_HEIGHT 80
#define ROOM_CELL   0.05f
#define ROOM_BEAMS  360U
#define ROOM_RATE   100U

struct patrol_room {
    struct jp_plane_pose pose;
    struct jp_four_wheel_sensors sensors;
    struct jp_four_wheel_actuation actuation;
    int64_t rolled[JP_WHEELS]; /* 2⁻²⁴ of a count */
    float ranges[ROOM_BEAMS];
    bool is_stuck; /**< the wheels slip on the spot: nothing moves, the encoders count */
};

/** Walls of one cell around free ground. */
static inline void patrol_room_draw(struct jp_terrain *map)
{
    for (int32_t y = 0; y < ROOM_HEIGHT; y++) {
        for (int32_t x = 0; x < ROOM_WIDTH; x++) {
            const bool is_wall = x == 0 || y == 0 || x == ROOM_WIDTH - 1 || y == ROOM_HEIGHT - 1;

            (void)jp_terrain_set_cell(map, x, y, is_wall ? JP_CELL_OCCUPIED : JP_CELL_FREE);
        }
    }
}

static inline void patrol_room_start(struct patrol_room *room, const struct jp_plane_pose *pose)
{
    *room = (struct patrol_room){.pose = *pose, .sensors = {.bus_voltage = JP_Q16(24), .bus_current = JP_Q16(2)}};
}

/** A tick of the drives. */
static inline void patrol_room_tick(struct patrol_room *room, const struct jp_four_wheel_robot_config *config)
{
    struct jp_twist twist;
    jp_q24 slip;

    if (room->actuation.enabled == 0U) {
        return;
    }
    for (int i = 0; i < (int)JP_WHEELS; i++) {
        room->rolled[i] += (int64_t)room->actuation.wheels.speed[i] * ((int64_t)1 << 32) / config->count_speed;
        room->sensors.count[i] = (uint32_t)(uint64_t)(room->rolled[i] >> 24);
        room->sensors.angle[i] = room->actuation.wheels.angle[i];
    }
    jp_four_wheel_forward(&config->wheels, &room->actuation.wheels, &twist, &slip);
    if (!room->is_stuck) {
        const float tick = 1.0f / ((float)ROOM_RATE * (float)JP_Q24_ONE);
        const struct jp_plane_pose moved = {(float)twist.x * tick, (float)twist.y * tick,
                                            (float)twist.turn_rate * tick};

        room->pose = jp_plane_compose(&room->pose, &moved);
    }
}

static inline float patrol_room_wall(float from, float direction, float low, float high)
{
    if (direction > 1e-6f) {
        return (high - from) / direction;
    }
    return direction < -1e-6f ? (low - from) / direction : 1e9f;
}

static inline void patrol_room_scan(struct patrol_room *room, const struct jp_patrol_scanner *scanner)
{
    const float thick = ROOM_CELL;
    const float width = (float)ROOM_WIDTH * ROOM_CELL - thick;
    const float height = (float)ROOM_HEIGHT * ROOM_CELL - thick;

    for (uint16_t i = 0; i < scanner->beams; i++) {
        const struct jp_plane_point way =
            jp_plane_direction(room->pose.heading + scanner->first_angle + (float)i * scanner->angle_step);
        const float x = patrol_room_wall(room->pose.x, way.x, thick, width);
        const float y = patrol_room_wall(room->pose.y, way.y, thick, height);

        room->ranges[i] = x < y ? x : y;
    }
}

#endif
