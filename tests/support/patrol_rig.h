/** A robot that does at once what it is told, among walls that its scanner sees, for the tests of the patrol. */
#ifndef JOULEPATH_TESTS_SUPPORT_PATROL_RIG_H
#define JOULEPATH_TESTS_SUPPORT_PATROL_RIG_H

#include <joulepath/patrol.h>
#include <string.h>

#include "src/base/plane.h"
#include "tests/support/band_rig.h"
#include "tests/support/near.h"

enum { RIG_WALLS_MAX = 64, RIG_POINTS_MAX = 128, RIG_BEAMS = 180 };

#define RIG_PERIOD 0.1f /* of a cycle, s */
#define RIG_RANGE  8.0f /* of the scanner, m */
#define RIG_LONG   400U /* cycles within which a drive of some metres ends */

struct rig_wall {
    struct jp_plane_point from;
    struct jp_plane_point to;
};

static struct jp_patrol patrol;
static struct jp_patrol_config config;
static struct jp_patrol_input input;
static struct jp_twist twist;
static struct jp_point path[RIG_POINTS_MAX];
static uint16_t path_count;
static struct rig_wall walls[RIG_WALLS_MAX];
static unsigned wall_count;
static struct jp_plane_pose robot; /* true, in the map's frame */
static float ranges[RIG_BEAMS];

/* What the world does to it. */
static bool is_blind;     /* no scans */
static bool is_stuck;     /* the wheels turn nothing */
static bool is_lost;      /* no poses of the laser */
static float laser_shift; /* of its poses, m */
static float laser_turn;  /* rad */

/** A robot of 0.8 m × 0.6 m that drives 0.8 m/s; a band of little work. */
static inline struct jp_patrol_config rig_config(void)
{
    struct jp_teb_config band = rig_band();

    band.speed_max = 0.8f;
    band.interval = 0.3f;
    band.rounds = 2;
    band.steps = 3;
    return (struct jp_patrol_config){
        .wheels = {.wheelbase = JP_Q24(0.5),
                   .track = JP_Q24(0.44),
                   .steering_limit = JP_ANGLE_DEGREES(100),
                   .steering_step = JP_ANGLE_DEGREES(2),
                   .speed_max = JP_Q24(1.5),
                   .speed_step = JP_Q24(0.01)},
        .teb = band,
        .scan = {.range_max = 5.0f, .gap = 0.4f, .tolerance = 0.04f, .beams_min = 2},
        .movers = {.extent = 0.9f, .range = 8.0f, .speed_min = 0.3f, .speed_max = 2.0f, .margin = 0.2f},
        .people = {.clearance = 0.3f, .braking = 1.0f, .acceleration = 2.0f, .rest = 1.0f, .stays = 6.0f},
        .turns_in_place = true,
        .price = {.second = 35.0f, .worth = 10.0f, .turning = 3.0f, .steering = 9.0f},
        .glide_clearance = 0.1f,
        .turn_first = 0.5f,
        .turn_rate = 1.0f,
        .turn_acceleration = 1.5f,
        .steering_rate = 3.0f,
        .turn_clearance = 0.0f,
        .step_speed = 0.2f,
        .horizon = 2.0f,
        .position_tolerance = 0.08f,
        .heading_tolerance = 0.08f,
        .period = RIG_PERIOD,
        .latency = 0.0f,
        .jump = 0.3f,
        .waits_max = 40,
        .dropouts_max = 3,
        .blind_max = 1.0f,
    };
}

static inline void rig_init(void)
{
    const char *field = NULL;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_init(&patrol, &config, &field));
    TEST_ASSERT_NULL(field);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_set_pose(&patrol, &robot));
}

/** The robot at the origin, facing east, nothing around it but what stops the beams at 6 m. */
static inline void rig_reset(void)
{
    config = rig_config();
    robot = (struct jp_plane_pose){0.0f, 0.0f, 0.0f};
    memset(&input, 0, sizeof input);
    wall_count = 0;
    path_count = 0;
    is_blind = false;
    is_stuck = false;
    is_lost = false;
    laser_shift = 0.0f;
    laser_turn = 0.0f;
    rig_init();
}

/* ---- World ---- */

static inline void rig_wall(float x1, float y1, float x2, float y2)
{
    TEST_ASSERT_TRUE(wall_count < RIG_WALLS_MAX);
    walls[wall_count++] = (struct rig_wall){{x1, y1}, {x2, y2}};
}

static inline void rig_wall_ahead(void)
{
    rig_wall(2.0f, -3.0f, 2.0f, 3.0f);
}

static inline void rig_box(float left, float bottom, float right, float top)
{
    rig_wall(left, bottom, right, bottom);
    rig_wall(right, bottom, right, top);
    rig_wall(right, top, left, top);
    rig_wall(left, top, left, bottom);
}

/** From a point along a unit direction to a wall, m; a large number beside it. */
static inline float rig_ray(const struct jp_plane_point *from, const struct jp_plane_point *along,
                            const struct rig_wall *wall)
{
    const struct jp_plane_point to_wall = {wall->from.x - from->x, wall->from.y - from->y};
    const struct jp_plane_point way = {wall->to.x - wall->from.x, wall->to.y - wall->from.y};
    const float cross = along->x * way.y - along->y * way.x;

    if (jp_plane_magnitude(cross) < 1.0e-6f) {
        return JP_OBSTACLE_NONE;
    }

    const float distance = (to_wall.x * way.y - to_wall.y * way.x) / cross;
    const float share = (to_wall.x * along->y - to_wall.y * along->x) / cross;

    return distance > 0.0f && share >= 0.0f && share <= 1.0f ? distance : JP_OBSTACLE_NONE;
}

static inline void rig_scan(void)
{
    const struct jp_plane_point from = {robot.x, robot.y};

    input.scan = (struct jp_scan){.ranges = ranges,
                                  .count = RIG_BEAMS,
                                  .first_angle = -JP_PLANE_PI,
                                  .angle_step = 2.0f * JP_PLANE_PI / RIG_BEAMS};
    for (unsigned i = 0; i < RIG_BEAMS; i++) {
        const float bearing = robot.heading + input.scan.first_angle + (float)i * input.scan.angle_step;
        const struct jp_plane_point along = jp_plane_direction(bearing);
        float nearest = RIG_RANGE;

        for (unsigned k = 0; k < wall_count; k++) {
            const float distance = rig_ray(&from, &along, &walls[k]);

            nearest = distance < nearest ? distance : nearest;
        }
        ranges[i] = nearest < RIG_RANGE ? nearest : 0.0f;
    }
}

/* ---- Paths ---- */

static inline void rig_point(float x, float y)
{
    TEST_ASSERT_TRUE(path_count < RIG_POINTS_MAX);
    path[path_count++] = rig_path_point(x, y);
}

/** Points every 0.1 m or so from one place to another. */
static inline void rig_straight(float x1, float y1, float x2, float y2)
{
    const unsigned count = (unsigned)(jp_plane_length(x2 - x1, y2 - y1) * 10.0f + 0.5f) + 1U;

    for (unsigned i = 0; i <= count; i++) {
        const float share = (float)i / (float)count;

        rig_point(x1 + share * (x2 - x1), y1 + share * (y2 - y1));
    }
}

static inline enum jp_status rig_follow(float x, float y, float heading, bool is_heading_free)
{
    const struct jp_patrol_goal goal = {{x, y, heading}, is_heading_free};

    return jp_patrol_follow(&patrol, path, path_count, &goal);
}

/** Straight from where the robot is to a place, any heading there. */
static inline void rig_go(float x, float y)
{
    path_count = 0;
    rig_straight(robot.x, robot.y, x, y);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(x, y, 0.0f, true));
}

static inline void rig_go_to_heading(float x, float y, float heading)
{
    path_count = 0;
    rig_straight(robot.x, robot.y, x, y);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(x, y, heading, false));
}

/* ---- Cycles ---- */

static inline float rig_from_q24(jp_q24 value)
{
    return (float)value / (float)JP_Q24_ONE;
}

/** The robot moves for a period as it was told, and the wheels tell of it. */
static inline void rig_move(void)
{
    const float turn = rig_from_q24(twist.turn_rate);
    const struct jp_plane_pose half = {0.0f, 0.0f, 0.5f * turn * RIG_PERIOD};
    const struct jp_plane_pose way = {rig_from_q24(twist.x) * RIG_PERIOD, rig_from_q24(twist.y) * RIG_PERIOD,
                                      half.heading};

    input.speed = (struct jp_plane_speed){0.0f, 0.0f};
    if (!is_stuck) {
        const struct jp_plane_pose middle = jp_plane_compose(&robot, &half);
        const struct jp_plane_pose middle_of_wheels = jp_plane_compose(&input.wheels, &half);

        robot = jp_plane_compose(&middle, &way);
        input.wheels = jp_plane_compose(&middle_of_wheels, &way);
        input.speed = (struct jp_plane_speed){rig_from_q24(twist.x), turn};
    }
}

static inline void rig_sense(void)
{
    rig_scan();
    input.scan.ranges = is_blind ? NULL : ranges;
    input.has_laser = !is_lost;
    input.laser = robot;
    input.laser.x += laser_shift;
    input.laser.heading += laser_turn;
}

static inline void rig_cycle(void)
{
    rig_sense();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    rig_move();
}

static inline void rig_cycles(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        rig_cycle();
    }
}

/** Until a state; how many cycles it took. */
static inline unsigned rig_until(enum jp_patrol_state state, unsigned most)
{
    unsigned cycles = 0;

    while (patrol.state != state && cycles < most) {
        rig_cycle();
        cycles++;
    }
    TEST_ASSERT_EQUAL_INT(state, patrol.state);
    return cycles;
}

static inline void rig_expect(enum jp_patrol_state state, enum jp_patrol_reason reason)
{
    TEST_ASSERT_EQUAL_INT(state, patrol.state);
    TEST_ASSERT_EQUAL_INT(reason, patrol.reason);
}

static inline void rig_expect_stand(void)
{
    TEST_ASSERT_EQUAL_INT32(0, twist.x);
    TEST_ASSERT_EQUAL_INT32(0, twist.y);
    TEST_ASSERT_EQUAL_INT32(0, twist.turn_rate);
}

#endif
