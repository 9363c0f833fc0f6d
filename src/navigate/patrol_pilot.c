#include <joulepath/patrol_pilot.h>

#include "src/base/block.h"
#include "src/base/config_check.h"
#include "src/base/plane.h"
#include "src/local/patrol_marks.h"

/** Scans come this much apart at least, of a cycle; and one that is this much late is not waited for. */
#define EARLIEST 0.5f
#define LATEST   1.25f

#define BEAMS_ANGLE_MAX 7.0f

/* Start. */

static enum jp_status check_scanner(const struct jp_patrol_scanner *scanner, const char **field)
{
    if (scanner->beams < 2U) {
        return jp_config_refuse("scanner.beams", field);
    }
    if (!jp_plane_is_within(scanner->first_angle, BEAMS_ANGLE_MAX)) {
        return jp_config_refuse("scanner.first_angle", field);
    }
    if (!(scanner->angle_step > 0.0f && scanner->angle_step * (float)scanner->beams <= BEAMS_ANGLE_MAX)) {
        return jp_config_refuse("scanner.angle_step", field);
    }
    return jp_plane_is_pose(&scanner->place) ? JP_OK : jp_config_refuse("scanner.place", field);
}

/** The mission checks the patrol again, with a map. */
static enum jp_status check(struct jp_patrol_pilot *pilot, const struct jp_patrol_pilot_config *config,
                            const char **field)
{
    enum jp_status status = jp_patrol_init(&pilot->mission.patrol, config->patrol, field);

    if (status == JP_OK) {
        status = jp_four_wheel_energy_check(config->energy, field);
    }
    if (status == JP_OK) {
        status = jp_factor_learning_check(config->learning, field);
    }
    return status == JP_OK ? check_scanner(config->scanner, field) : status;
}

static uint32_t ticks_of(const struct jp_patrol_pilot *pilot, float share)
{
    const float rate = (float)jp_four_wheel_robot_configuration(pilot->internal.robot)->tick_rate;
    const float ticks = share * pilot->internal.config.patrol->period * rate + 0.5f;

    return (uint32_t)ticks;
}

enum jp_status jp_patrol_pilot_init(struct jp_patrol_pilot *pilot, const struct jp_patrol_pilot_config *config,
                                    struct jp_four_wheel_robot *robot, const char **field)
{
    if (pilot == NULL || config == NULL || robot == NULL || field == NULL || config->patrol == NULL ||
        config->localiser == NULL || config->scanner == NULL || config->energy == NULL || config->learning == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *pilot = (struct jp_patrol_pilot){.internal = {.config = *config, .robot = robot}};

    const enum jp_status status = check(pilot, config, field);

    if (status == JP_OK) {
        jp_patrol_ledger_start(&pilot->ledger, config->learning, config->energy);
        pilot->internal.survey_status = JP_ERR_NO_PLAN;
        pilot->internal.cycle_ticks = ticks_of(pilot, LATEST);
    }
    return status;
}

/* The map. */

static struct jp_patrol_mission_config mission_config(const struct jp_patrol_pilot *pilot, const struct jp_terrain *map)
{
    const struct jp_patrol_pilot_config *config = &pilot->internal.config;

    return (struct jp_patrol_mission_config){.patrol = *config->patrol,
                                             .map = map,
                                             .energy = &pilot->ledger.learner.model,
                                             .turns_before_goal = config->patrol->turns_in_place,
                                             .points_max = config->points_max,
                                             .turns_max = config->turns_max};
}

static struct jp_localiser_config localiser_config(const struct jp_patrol_pilot *pilot, const struct jp_terrain *map)
{
    struct jp_localiser_config config = *pilot->internal.config.localiser;

    config.map = map;
    return config;
}

static size_t mission_size(const struct jp_patrol_pilot *pilot, const struct jp_terrain *map)
{
    const struct jp_patrol_mission_config config = mission_config(pilot, map);

    return jp_block_align(jp_patrol_mission_size(&config));
}

size_t jp_patrol_pilot_size(const struct jp_patrol_pilot *pilot, const struct jp_terrain *map)
{
    const struct jp_localiser_config config = localiser_config(pilot, map);
    const size_t mission = mission_size(pilot, map);
    const size_t localiser = jp_localiser_size(&config);

    return mission == 0U ? 0U : mission + localiser;
}

static struct jp_plane_pose plane_pose(const struct jp_four_wheel_odometry *odometry)
{
    const int32_t heading = (int32_t)jp_phase_angle(odometry->heading);

    return (struct jp_plane_pose){jp_plane_of_q32(odometry->x), jp_plane_of_q32(odometry->y),
                                  (float)heading * (JP_PLANE_PI * 0x1p-31f)};
}

static enum jp_status prepare(struct jp_patrol_pilot *pilot, const struct jp_terrain *map, void *block, size_t size,
                              const char **field)
{
    const struct jp_patrol_mission_config mission = mission_config(pilot, map);
    const struct jp_localiser_config localiser = localiser_config(pilot, map);
    const size_t first = mission_size(pilot, map);
    const enum jp_status status =
        first > size ? JP_ERR_MEMORY : jp_patrol_mission_init(&pilot->mission, &mission, block, first, field);

    return status != JP_OK
               ? status
               : jp_localiser_init(&pilot->localiser, &localiser, (uint8_t *)block + first, size - first, field);
}

/** Where the robot has come to since. */
static enum jp_status place(struct jp_patrol_pilot *pilot)
{
    const struct jp_plane_pose wheels = plane_pose(&pilot->internal.odometry);
    const struct jp_plane_pose now = jp_plane_compose(&pilot->internal.origin, &wheels);

    (void)jp_patrol_set_pose(&pilot->mission.patrol, &now);
    return jp_localiser_start(&pilot->localiser, &now);
}

enum jp_status jp_patrol_pilot_take_map(struct jp_patrol_pilot *pilot, const struct jp_terrain *map,
                                        const struct jp_plane_pose *origin, void *block, size_t size,
                                        const char **field)
{
    if (pilot == NULL || map == NULL || origin == NULL || block == NULL || field == NULL || !jp_plane_is_pose(origin)) {
        return JP_ERR_ARGUMENT;
    }
    *field = NULL;
    jp_patrol_pilot_forget_map(pilot);
    pilot->internal.origin = *origin;

    enum jp_status status = prepare(pilot, map, block, size, field);

    if (status == JP_OK) {
        status = place(pilot);
    }
    pilot->has_map = status == JP_OK;
    return status;
}

void jp_patrol_pilot_forget_map(struct jp_patrol_pilot *pilot)
{
    jp_patrol_pilot_stop(pilot);
    pilot->has_map = false;
    pilot->internal.ranges = NULL;
}

/* Goals. */

static bool is_on_map(const struct jp_patrol_pilot *pilot, const struct jp_plane_pose *pose)
{
    const struct jp_terrain_config *map = &pilot->mission.config.map->config;
    const float cell = (float)map->resolution / (float)JP_Q16_ONE;

    return pose->x >= 0.0f && pose->y >= 0.0f && pose->x < cell * (float)map->width &&
           pose->y < cell * (float)map->height;
}

bool jp_patrol_pilot_can_stand(const struct jp_patrol_pilot *pilot, const struct jp_plane_pose *pose)
{
    return pilot->has_map && is_on_map(pilot, pose) &&
           jp_patrol_fits(pilot->mission.config.map, &pilot->mission.config.patrol.teb.footprint, pose, 0.0f);
}

static bool has_drives(const struct jp_patrol_pilot *pilot)
{
    const enum jp_four_wheel_robot_state state = jp_four_wheel_robot_state_now(pilot->internal.robot);

    return state == JP_FOUR_WHEEL_ROBOT_STANDING || state == JP_FOUR_WHEEL_ROBOT_DRIVING;
}

static enum jp_status judge(const struct jp_patrol_pilot *pilot, const struct jp_plane_pose *goal)
{
    if (!jp_plane_is_pose(goal)) {
        return JP_ERR_ARGUMENT;
    }
    if (!is_on_map(pilot, goal)) {
        return JP_ERR_OUTSIDE;
    }
    return jp_patrol_pilot_can_stand(pilot, goal) ? JP_OK : JP_ERR_BLOCKED;
}

static void end_leg(struct jp_patrol_pilot *pilot)
{
    if (pilot->internal.is_ended) {
        pilot->internal.is_ended = false;
        jp_patrol_ledger_end(&pilot->ledger);
    }
}

static void start_next(struct jp_patrol_pilot *pilot)
{
    end_leg(pilot);
    pilot->internal.is_planned = false;
    (void)jp_patrol_mission_start(&pilot->mission, &pilot->internal.goals[pilot->internal.goal_next]);
}

/** The robot is where it was. */
static void end_survey(struct jp_patrol_pilot *pilot, enum jp_status status)
{
    pilot->internal.survey_status = status;
    jp_patrol_mission_stop(&pilot->mission);
    (void)jp_patrol_set_pose(&pilot->mission.patrol, &pilot->localiser.pose);
}

static void forget_survey(struct jp_patrol_pilot *pilot)
{
    if (pilot->internal.survey_status == JP_WORKING) {
        end_survey(pilot, JP_ERR_NO_PLAN);
    }
}

/** To goals that were judged. */
static void set_out(struct jp_patrol_pilot *pilot, const struct jp_plane_pose *goals, uint16_t count)
{
    forget_survey(pilot);
    for (uint16_t i = 0; i < count; i++) {
        pilot->internal.goals[i] = goals[i];
    }
    pilot->internal.goal_count = count;
    pilot->internal.goal_next = 0;
    start_next(pilot);
}

enum jp_status jp_patrol_pilot_go(struct jp_patrol_pilot *pilot, const struct jp_plane_pose *goal)
{
    enum jp_status status;

    if (pilot == NULL || goal == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (!pilot->has_map) {
        return JP_ERR_NO_PLAN;
    }
    if (!has_drives(pilot)) {
        return JP_ERR_STATE;
    }
    status = judge(pilot, goal);
    if (status == JP_OK) {
        set_out(pilot, goal, 1);
    }
    return status;
}

/** The pose on the map at a point of odometry, looking there from another. */
static struct jp_plane_pose goal_at(const struct jp_patrol_pilot *pilot, const struct jp_plane_pose *from,
                                    const struct jp_point *point)
{
    const struct jp_plane_pose at = {(float)point->x / (float)JP_Q16_ONE, (float)point->y / (float)JP_Q16_ONE, 0.0f};
    struct jp_plane_pose goal = jp_plane_compose(&pilot->internal.origin, &at);

    goal.heading = jp_plane_bearing(goal.x - from->x, goal.y - from->y);
    return goal;
}

static enum jp_status goals_of(const struct jp_patrol_pilot *pilot, const struct jp_point *points, uint16_t count,
                               struct jp_plane_pose *goals)
{
    struct jp_plane_pose from = jp_patrol_pilot_pose(pilot);

    for (uint16_t i = 0; i < count; i++) {
        goals[i] = goal_at(pilot, &from, &points[i]);
        from = goals[i];

        const enum jp_status status = judge(pilot, &goals[i]);

        if (status != JP_OK) {
            return status;
        }
    }
    return JP_OK;
}

enum jp_status jp_patrol_pilot_follow(struct jp_patrol_pilot *pilot, const struct jp_point *points, uint16_t count)
{
    struct jp_plane_pose goals[JP_PATROL_PILOT_GOALS];
    enum jp_status status;

    if (pilot == NULL || points == NULL || count == 0U || count > JP_PATROL_PILOT_GOALS) {
        return JP_ERR_ARGUMENT;
    }
    if (!pilot->has_map) {
        return JP_ERR_NO_PLAN;
    }
    if (!has_drives(pilot)) {
        return JP_ERR_STATE;
    }
    status = goals_of(pilot, points, count, goals);
    if (status == JP_OK) {
        set_out(pilot, goals, count);
    }
    return status;
}

enum jp_status jp_patrol_pilot_forget_marks(struct jp_patrol_pilot *pilot)
{
    if (pilot == NULL) {
        return JP_ERR_ARGUMENT;
    }
    return pilot->has_map ? jp_patrol_mission_forget_marks(&pilot->mission) : JP_ERR_NO_PLAN;
}

/* Surveys. */

enum jp_status jp_patrol_pilot_survey(struct jp_patrol_pilot *pilot, const struct jp_plane_pose *from,
                                      const struct jp_plane_pose *to)
{
    enum jp_status status;

    if (pilot == NULL || from == NULL || to == NULL || !jp_plane_is_pose(from)) {
        return JP_ERR_ARGUMENT;
    }
    if (!pilot->has_map) {
        return JP_ERR_NO_PLAN;
    }
    if (jp_patrol_pilot_is_under_way(pilot)) {
        return JP_ERR_STATE;
    }
    status = judge(pilot, to);
    if (status == JP_OK) {
        pilot->internal.survey_start = *from;
        pilot->internal.goals[0] = *to;
        pilot->internal.goal_next = 0;
        pilot->internal.goal_count = 0;
        pilot->internal.survey_status = JP_WORKING;
        (void)jp_patrol_set_pose(&pilot->mission.patrol, from);
        (void)jp_patrol_mission_start(&pilot->mission, to);
    }
    return status;
}

enum jp_status jp_patrol_pilot_surveyed(const struct jp_patrol_pilot *pilot, struct jp_patrol_leg_forecast *forecast)
{
    if (pilot->internal.survey_status == JP_OK) {
        *forecast = pilot->internal.survey;
    }
    return pilot->internal.survey_status;
}

/* Commands. */

static void tell(struct jp_patrol_pilot *pilot, const struct jp_twist *twist)
{
    /* Of a robot whose drives have just been switched off nothing is asked any more. */
    (void)jp_four_wheel_robot_drive(pilot->internal.robot, twist);
}

void jp_patrol_pilot_stop(struct jp_patrol_pilot *pilot)
{
    static const struct jp_twist rest = {0, 0, 0};

    end_leg(pilot);
    jp_patrol_ledger_forget(&pilot->ledger);
    pilot->internal.goal_count = 0;
    pilot->internal.goal_next = 0;
    if (pilot->has_map) {
        forget_survey(pilot);
        jp_patrol_mission_stop(&pilot->mission);
    }
    tell(pilot, &rest);
}

void jp_patrol_pilot_see(struct jp_patrol_pilot *pilot, const float *ranges,
                         const struct jp_four_wheel_odometry *odometry)
{
    pilot->internal.ranges = ranges;
    pilot->internal.wheels = plane_pose(odometry);
}

/* What legs take. */

static void take_stretches(struct jp_patrol_pilot *pilot)
{
    struct jp_four_wheel_stretch stretch;

    while (jp_four_wheel_robot_take_stretch(pilot->internal.robot, &stretch)) {
        jp_patrol_ledger_add(&pilot->ledger, &stretch);
        end_leg(pilot);
    }
}

static struct jp_patrol_plan plan_of(const struct jp_patrol_pilot *pilot)
{
    return (struct jp_patrol_plan){
        .start = pilot->mission.patrol.pose,
        .path = pilot->mission.path,
        .path_count = pilot->mission.path_count,
        .goal = {.pose = pilot->internal.goals[pilot->internal.goal_next], .is_heading_free = false},
        .tick_rate = jp_four_wheel_robot_configuration(pilot->internal.robot)->tick_rate,
        .ground = pilot->mission.config.map};
}

/** The way to the goal was found for the first time. */
static void note_plan(struct jp_patrol_pilot *pilot)
{
    if (!pilot->internal.is_planned && pilot->mission.state == JP_MISSION_UNDER_WAY) {
        const struct jp_patrol_plan plan = plan_of(pilot);

        pilot->internal.is_planned = true;
        (void)jp_patrol_ledger_begin(&pilot->ledger, pilot->internal.config.patrol, &plan);
    }
}

static void note_end(struct jp_patrol_pilot *pilot)
{
    if (pilot->internal.goal_next >= pilot->internal.goal_count) {
        return;
    }
    if (pilot->mission.state == JP_MISSION_ARRIVED) {
        pilot->internal.is_ended = pilot->internal.is_planned;
        pilot->internal.goal_next++;
        if (pilot->internal.goal_next < pilot->internal.goal_count) {
            start_next(pilot);
        }
    } else if (pilot->mission.state == JP_MISSION_GIVEN_UP) {
        jp_patrol_ledger_forget(&pilot->ledger);
        pilot->internal.goal_count = pilot->internal.goal_next;
    } else {
        /* It is on its way. */
    }
}

/* A cycle. */

static float metres_per_second(jp_q24 speed)
{
    return (float)speed / (float)JP_Q24_ONE;
}

/** On the robot as it stands now: where the scanner was when it began the scan. */
static struct jp_plane_pose scanner_of(const struct jp_patrol_pilot *pilot, const struct jp_plane_pose *wheels)
{
    const struct jp_plane_pose before = jp_plane_relative(wheels, &pilot->internal.wheels);

    return jp_plane_compose(&before, &pilot->internal.config.scanner->place);
}

static struct jp_patrol_input input_of(const struct jp_patrol_pilot *pilot,
                                       const struct jp_four_wheel_telemetry *telemetry)
{
    const struct jp_patrol_scanner *scanner = pilot->internal.config.scanner;
    const struct jp_twist *twist = &telemetry->odometry.twist;
    struct jp_patrol_input input = {
        .wheels = plane_pose(&telemetry->odometry),
        .speed = {metres_per_second(twist->x), metres_per_second(twist->turn_rate)},
        .scan = {.ranges = pilot->internal.ranges,
                 .count = scanner->beams,
                 .first_angle = scanner->first_angle,
                 .angle_step = scanner->angle_step},
        .sensor = scanner->place,
    };

    if (input.scan.ranges != NULL) {
        input.sensor = scanner_of(pilot, &input.wheels);
    }
    return input;
}

static void cycle(struct jp_patrol_pilot *pilot, const struct jp_four_wheel_telemetry *telemetry)
{
    struct jp_patrol_input input = input_of(pilot, telemetry);
    struct jp_twist twist = {0, 0, 0};

    pilot->internal.cycle_tick = telemetry->tick;
    pilot->internal.ranges = NULL;
    (void)jp_patrol_locate(&pilot->localiser, &input);
    (void)jp_patrol_mission_cycle(&pilot->mission, &input, &twist);
    tell(pilot, &twist);
}

static bool is_due(const struct jp_patrol_pilot *pilot, const struct jp_four_wheel_telemetry *telemetry)
{
    const uint32_t passed = telemetry->tick - pilot->internal.cycle_tick;

    return passed >= (pilot->internal.ranges != NULL ? ticks_of(pilot, EARLIEST) : pilot->internal.cycle_ticks);
}

/** A slice of it; the robot stands. */
static void survey(struct jp_patrol_pilot *pilot)
{
    const enum jp_patrol_mission_state state = jp_patrol_mission_work(&pilot->mission, JP_PATROL_PILOT_EXPANSIONS);
    struct jp_patrol_plan plan;
    enum jp_status status;

    if (state == JP_MISSION_PLANNING) {
        return;
    }
    plan = plan_of(pilot);
    plan.start = pilot->internal.survey_start;
    status = state == JP_MISSION_UNDER_WAY ? jp_patrol_ledger_foretell(&pilot->ledger, pilot->internal.config.patrol,
                                                                       &plan, &pilot->internal.survey)
                                           : JP_ERR_NO_PLAN;
    end_survey(pilot, status);
}

/** Whether there was something to search for. */
static bool search(struct jp_patrol_pilot *pilot)
{
    const uint32_t before = pilot->localiser.counts.nodes;

    (void)jp_localiser_work(&pilot->localiser, JP_PATROL_PILOT_NODES);
    return pilot->localiser.counts.nodes != before;
}

/* In turns: a robot among places that are alike searches for as long as it drives. */
static void work_between(struct jp_patrol_pilot *pilot)
{
    pilot->internal.is_search_due = !pilot->internal.is_search_due;
    if (!pilot->internal.is_search_due || !search(pilot)) {
        (void)jp_patrol_mission_work(&pilot->mission, JP_PATROL_PILOT_EXPANSIONS);
    }
}

void jp_patrol_pilot_work(struct jp_patrol_pilot *pilot)
{
    struct jp_four_wheel_telemetry telemetry;

    take_stretches(pilot);
    if (!jp_four_wheel_robot_telemetry(pilot->internal.robot, &telemetry)) {
        return;
    }
    pilot->internal.odometry = telemetry.odometry;
    if (!pilot->has_map) {
        return;
    }
    if (pilot->internal.survey_status == JP_WORKING) {
        survey(pilot);
        return;
    }
    if (!has_drives(pilot) && jp_patrol_pilot_is_under_way(pilot)) {
        jp_patrol_pilot_stop(pilot);
    }
    if (is_due(pilot, &telemetry)) {
        cycle(pilot, &telemetry);
    } else {
        work_between(pilot);
    }
    note_plan(pilot);
    note_end(pilot);
}

/* Questions. */

bool jp_patrol_pilot_is_under_way(const struct jp_patrol_pilot *pilot)
{
    return pilot->has_map && pilot->internal.goal_next < pilot->internal.goal_count;
}

uint16_t jp_patrol_pilot_reached(const struct jp_patrol_pilot *pilot, uint16_t *of)
{
    *of = pilot->internal.goal_count;
    return pilot->internal.goal_next;
}

struct jp_plane_pose jp_patrol_pilot_pose(const struct jp_patrol_pilot *pilot)
{
    return pilot->mission.patrol.pose;
}

static struct jp_plane_point point_of(const struct jp_point *point)
{
    return (struct jp_plane_point){(float)point->x / (float)JP_Q16_ONE, (float)point->y / (float)JP_Q16_ONE};
}

static uint16_t nearest(const struct jp_patrol_mission *mission)
{
    const struct jp_plane_point here = {mission->patrol.pose.x, mission->patrol.pose.y};
    float least = FLT_MAX;
    uint16_t found = 0;

    for (uint16_t i = 0; i < mission->path_count; i++) {
        const float square = jp_plane_square_between(here, point_of(&mission->path[i]));

        if (square < least) {
            least = square;
            found = i;
        }
    }
    return found;
}

static float length_from(const struct jp_patrol_mission *mission, uint16_t first)
{
    float length = 0.0f;

    for (uint16_t i = (uint16_t)(first + 1U); i < mission->path_count; i++) {
        length += jp_plane_square_root(
            jp_plane_square_between(point_of(&mission->path[i - 1U]), point_of(&mission->path[i])));
    }
    return length;
}

enum jp_status jp_patrol_pilot_progress(const struct jp_patrol_pilot *pilot, float *length,
                                        struct jp_patrol_leg_forecast *left)
{
    const struct jp_patrol_mission *mission = &pilot->mission;
    float whole;
    float share;

    if (!jp_patrol_pilot_is_under_way(pilot) || !pilot->internal.is_planned) {
        return JP_ERR_NO_PLAN;
    }
    whole = length_from(mission, 0);
    *length = length_from(mission, nearest(mission));
    share = whole > 0.0f ? *length / whole : 0.0f;
    *left = (struct jp_patrol_leg_forecast){.energy = share * pilot->ledger.forecast.energy,
                                            .deviation = share * pilot->ledger.forecast.deviation,
                                            .duration = share * pilot->ledger.forecast.duration};
    return JP_OK;
}
