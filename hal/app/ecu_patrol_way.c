#include "hal/app/ecu_patrol_way.h"

#include "hal/app/float_signals.h"

static struct jp_plane_pose pose_of(const struct jp_place *place)
{
    return (struct jp_plane_pose){(float)place->point.x / (float)JP_Q16_ONE, (float)place->point.y / (float)JP_Q16_ONE,
                                  (float)(int32_t)place->heading * (1.0f / JP_TURNS_PER_RADIAN * 0x1p-32f)};
}

static enum jp_status prepare_way(void *self, struct jp_terrain *map, const struct jp_place *origin)
{
    struct jp_ecu_patrol *patrol = self;
    const struct jp_plane_pose pose = pose_of(origin);
    const char *field;

    return jp_patrol_pilot_take_map(&patrol->pilot, map, &pose, patrol->internal.block, patrol->internal.size, &field);
}

static void forget_way(void *self)
{
    struct jp_ecu_patrol *patrol = self;

    jp_patrol_pilot_forget_map(&patrol->pilot);
}

/** Not on a route of waypoints. */
static bool is_under_way(const void *self)
{
    const struct jp_ecu_patrol *patrol = self;

    return patrol->internal.is_to_goal && jp_patrol_pilot_is_under_way(&patrol->pilot);
}

/** Its own scanner sees what the map does not show. */
static void see(void *self, int32_t x, int32_t y, enum jp_cell cell)
{
    (void)self;
    (void)x;
    (void)y;
    (void)cell;
}

/** The middle of the goal's cell; without a heading as the robot looks now. */
static struct jp_plane_pose goal_pose(const struct jp_ecu_patrol *patrol, const struct jp_map_goal *goal)
{
    const float cell = (float)patrol->pilot.mission.config.map->config.resolution / (float)JP_Q16_ONE;
    const struct jp_place heading = {.heading = goal->heading};
    const struct jp_plane_pose turned = goal->has_heading ? pose_of(&heading) : jp_patrol_pilot_pose(&patrol->pilot);

    return (struct jp_plane_pose){((float)goal->x + 0.5f) * cell, ((float)goal->y + 0.5f) * cell, turned.heading};
}

static bool can_stand(const void *self, const struct jp_map_goal *goal)
{
    const struct jp_ecu_patrol *patrol = self;
    const struct jp_plane_pose pose = goal_pose(patrol, goal);

    return jp_patrol_pilot_can_stand(&patrol->pilot, &pose);
}

static enum jp_status go(void *self, const struct jp_map_goal *goal)
{
    struct jp_ecu_patrol *patrol = self;
    const struct jp_plane_pose pose = goal_pose(patrol, goal);

    patrol->internal.plan = jp_patrol_pilot_go(&patrol->pilot, &pose);
    patrol->internal.is_to_goal = patrol->internal.plan == JP_OK || patrol->internal.is_to_goal;
    return patrol->internal.plan;
}

/** True with each path. */
static bool work_on_way(void *self)
{
    struct jp_ecu_patrol *patrol = self;
    const struct jp_patrol_mission *mission = &patrol->pilot.mission;
    const bool was_planning = mission->state == JP_MISSION_PLANNING;

    jp_ecu_patrol_work(self);
    return was_planning && mission->state == JP_MISSION_UNDER_WAY;
}

static enum jp_navigator_state way_state(const struct jp_patrol_pilot *pilot)
{
    switch (pilot->mission.state) {
    case JP_MISSION_PLANNING:
        return JP_NAVIGATOR_PLANNING;
    case JP_MISSION_UNDER_WAY:
        return pilot->mission.patrol.state == JP_PATROL_TURNING ? JP_NAVIGATOR_TURNING : JP_NAVIGATOR_DRIVING;
    case JP_MISSION_ARRIVED:
        return JP_NAVIGATOR_ARRIVED;
    case JP_MISSION_GIVEN_UP:
        return JP_NAVIGATOR_FAILED;
    case JP_MISSION_IDLE:
    default:
        return JP_NAVIGATOR_IDLE;
    }
}

static enum jp_navigator_reason way_reason(const struct jp_patrol_pilot *pilot)
{
    switch (pilot->mission.patrol.reason) {
    case JP_PATROL_IN_COLLISION:
    case JP_PATROL_BLOCKED:
        return JP_NAVIGATOR_BLOCKED;
    case JP_PATROL_LOST:
    case JP_PATROL_OFF_PATH:
        return JP_NAVIGATOR_ASTRAY;
    case JP_PATROL_NO_SCAN:
    case JP_PATROL_STALLED:
    case JP_PATROL_INFEASIBLE:
        return JP_NAVIGATOR_VEHICLE;
    case JP_PATROL_NONE:
    default:
        return pilot->mission.state == JP_MISSION_GIVEN_UP ? JP_NAVIGATOR_HEMMED_IN : JP_NAVIGATOR_NO_REASON;
    }
}

static void tell_way(const void *self, struct jp_way_report *report)
{
    const struct jp_ecu_patrol *patrol = self;
    struct jp_patrol_leg_forecast left;
    float length;

    *report = (struct jp_way_report){.state = way_state(&patrol->pilot),
                                     .reason = way_reason(&patrol->pilot),
                                     .status = patrol->internal.plan,
                                     .replans = (uint16_t)patrol->pilot.mission.replans};
    if (jp_patrol_pilot_progress(&patrol->pilot, &length, &left) == JP_OK) {
        report->progress = (struct jp_progress){
            .length = jp_fixed_of(length, 0x1p16f),
            .duration = jp_fixed_of(left.duration, 0x1p16f),
            .energy = {.energy = jp_fixed_of(left.energy, 0x1p16f), .deviation = jp_fixed_of(left.deviation, 0x1p16f)}};
    }
}

static void stop(void *self)
{
    struct jp_ecu_patrol *patrol = self;

    jp_patrol_pilot_stop(&patrol->pilot);
}

struct jp_wayfinder jp_ecu_patrol_wayfinder(struct jp_ecu_patrol *patrol)
{
    return (struct jp_wayfinder){.self = patrol,
                                 .prepare = prepare_way,
                                 .forget = forget_way,
                                 .is_under_way = is_under_way,
                                 .see = see,
                                 .can_stand = can_stand,
                                 .go = go,
                                 .stop = stop,
                                 .work = work_on_way,
                                 .tell = tell_way};
}
