#include <joulepath/patrol_mission.h>

#include <joulepath/path_spline.h>
#include <string.h>

#include "src/base/block.h"
#include "src/base/config_check.h"
#include "src/base/plane.h"
#include "src/base/point.h"
#include "src/local/patrol_approach.h"
#include "src/local/patrol_glide.h"
#include "src/local/patrol_marking.h"
#include "src/local/patrol_marks.h"
#include "src/local/patrol_path.h"
#include "src/local/patrol_plan_prices.h"
#include "src/local/patrol_trodden.h"

/* Of a path's points, m. */
#define SPACING 0.1f

/* Half-width of the tube in which the any-angle planner improves its path, cells. */
#define TUBE_CELLS 8

/* A target nearer than this, m, or in the same cell is reached straight on, without the map. */
#define STRAIGHT_BELOW 0.15f
#define DIAGONAL       1.41421356f

/* The band can end a path in another heading than the path's last points by so much, rad. */
#define END_TURN   (JP_PLANE_PI / 9.0f)
#define END_POINTS 5U

/* Nearer to the goal than this, m, the approach is not changed any more; checked once in so many cycles. */
#define WATCH_DISTANCE 0.5f
#define WATCH_CYCLES   5U

/* A new path is looked for after so many blocked cycles, at most so often before the robot has got on by its horizon.
 */
#define REPLAN_WAIT   8U
#define LAST_LEG_WAIT 30U
#define TRIES_MAX     6U

/* What scans have marked may be off, or gone: where it leaves no path it is forgotten, so often. */
#define FORGETS_MAX 3U

/* A way around where people walk is looked for after so much standing for them, s, and again after so many times as
 * much as the last time. */
#define DETOUR_WAIT   3.0f
#define DETOUR_FACTOR 1.5f

/* Corners of the footprint with its margin are at most so far from its centre, cells. */
#define RADIUS_MAX 60.0f

/* Clearances beyond half the robot's width, m, from the widest on: the first that has a path is taken. */
static const float margins[] = {0.15f, 0.10f, 0.05f, 0.02f};
#define MARGINS (sizeof margins / sizeof margins[0])

/* The first of them where clearance has a price. */
#define FIRST_PRICED 1U

/* With the last of them a path is looked for from so many cells beside the robot at most. */
#define BESIDE_MAX 8U

/* All of them are first wider by so many standard deviations of the position, where that is more than so much, m. */
#define DEVIATIONS    2.0f
#define DEVIATION_MIN 0.01f

/* ---- Memory ---- */

/* Where the parts of the block begin. */
struct mission_layout {
    size_t map;
    size_t paths[2];
    size_t scratch;
    size_t grid;
    size_t end;
};

static struct jp_grid_planner_config grid_config(const struct jp_patrol_mission_config *config, float margin)
{
    const float clearance = (config->patrol.teb.footprint.half_width + margin) * (float)JP_Q16_ONE;

    return (struct jp_grid_planner_config){
        .method = JP_GRID_ANY_ANGLE, .clearance = (jp_q16)clearance, .tube = TUBE_CELLS};
}

static bool lay_out(const struct jp_patrol_mission_config *config, struct mission_layout *layout)
{
    const struct jp_grid_planner_config grid = grid_config(config, margins[0]);
    const size_t path = jp_block_align(config->points_max * sizeof(struct jp_point));
    const size_t grid_size = jp_grid_planner_size(&grid, &config->map->config);

    layout->map = 0;
    layout->paths[0] = jp_block_align(jp_terrain_size(&config->map->config));
    layout->paths[1] = layout->paths[0] + path;
    layout->scratch = layout->paths[1] + path;
    layout->grid = layout->scratch + jp_block_align(jp_path_spline_size(config->turns_max));
    layout->end = layout->grid + grid_size;
    return grid_size > 0U;
}

size_t jp_patrol_mission_size(const struct jp_patrol_mission_config *config)
{
    struct mission_layout layout;

    return lay_out(config, &layout) ? layout.end : 0U;
}

static bool is_footprint_in_range(const struct jp_patrol_mission_config *config)
{
    const struct jp_footprint *const footprint = &config->patrol.teb.footprint;
    const float length = 0.5f * (footprint->front + footprint->rear) + margins[0];
    const float width = footprint->half_width + margins[0];

    return jp_plane_length(length, width) <= RADIUS_MAX * jp_patrol_cell(config->map);
}

/* Or plans by length. */
static bool has_prices(const struct jp_patrol_mission_config *config)
{
    struct jp_grid_prices prices;
    const char *field;

    return config->energy == NULL || (jp_four_wheel_energy_check(config->energy, &field) == JP_OK &&
                                      jp_patrol_plan_prices(&config->patrol, config->energy, margins[FIRST_PRICED],
                                                            jp_patrol_cell(config->map), &prices) == JP_OK);
}

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_patrol_mission_config, member, low, high)

static enum jp_status check(const struct jp_patrol_mission_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(points_max, 2, UINT16_MAX),
        FIELD(turns_max, 2, UINT16_MAX),
    };

    if (config->map == NULL) {
        return jp_config_refuse("map", field);
    }

    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status != JP_OK) {
        return status;
    }
    if (!has_prices(config)) {
        return jp_config_refuse("energy", field);
    }
    return is_footprint_in_range(config) ? JP_OK : jp_config_refuse("teb.footprint", field);
}

static enum jp_status divide(struct jp_patrol_mission *mission, void *block, size_t size, const char **field)
{
    const struct jp_terrain_config *const map = &mission->config.map->config;
    uint8_t *const bytes = block;
    struct mission_layout layout;

    if (!lay_out(&mission->config, &layout)) {
        *field = "map";
        return JP_ERR_CONFIG;
    }
    if (size < layout.end) {
        return JP_ERR_MEMORY;
    }
    mission->internal.paths[0] = (void *)&bytes[layout.paths[0]];
    mission->internal.paths[1] = (void *)&bytes[layout.paths[1]];
    mission->internal.scratch = &bytes[layout.scratch];
    mission->internal.grid_block = &bytes[layout.grid];
    mission->internal.grid_size = size - layout.grid;
    return jp_terrain_init(&mission->internal.marked, map, block, layout.paths[0], field);
}

enum jp_status jp_patrol_mission_init(struct jp_patrol_mission *mission, const struct jp_patrol_mission_config *config,
                                      void *block, size_t size, const char **field)
{
    if (mission == NULL || config == NULL || block == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    (void)memset(mission, 0, sizeof *mission);

    enum jp_status status = jp_patrol_init(&mission->patrol, &config->patrol, field);

    if (status == JP_OK) {
        status = check(config, field);
    }
    if (status != JP_OK) {
        return status;
    }
    if (!jp_block_is_aligned(block)) {
        return JP_ERR_ALIGNMENT;
    }
    mission->config = *config;

    const enum jp_status divided = divide(mission, block, size, field);

    if (divided == JP_OK) {
        jp_patrol_marking_start(mission);
    }
    return divided;
}

enum jp_status jp_patrol_mission_forget_marks(struct jp_patrol_mission *mission)
{
    if (mission == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (mission->state == JP_MISSION_PLANNING) {
        return JP_ERR_STATE;
    }
    jp_patrol_marking_forget_now(mission);
    return JP_OK;
}

/* ---- Paths ---- */

static float distance_to(const struct jp_patrol_mission *mission, const struct jp_plane_pose *target)
{
    const struct jp_plane_pose *const from = &mission->patrol.pose;

    return jp_plane_length(target->x - from->x, target->y - from->y);
}

/* The path that is made becomes the one that is driven, if the patrol takes it. */
static bool follow(struct jp_patrol_mission *mission, const struct jp_plane_pose *target, uint16_t count)
{
    const struct jp_patrol_goal goal = {.pose = *target};
    struct jp_point *const path = mission->internal.paths[1];

    if (jp_patrol_follow(&mission->patrol, path, count, &goal) != JP_OK) {
        return false;
    }
    mission->internal.paths[1] = mission->internal.paths[0];
    mission->internal.paths[0] = path;
    mission->path = path;
    mission->path_count = count;
    return true;
}

static jp_q16 to_q16(float value)
{
    const float scaled = value * (float)JP_Q16_ONE;

    return (jp_q16)(scaled < 0.0f ? scaled - 0.5f : scaled + 0.5f);
}

/* A path straight on, or on the spot: it has at least two points. */
static bool follow_straight(struct jp_patrol_mission *mission, const struct jp_plane_pose *target)
{
    const struct jp_plane_pose *const from = &mission->patrol.pose;
    const float parts = distance_to(mission, target) / SPACING;

    if (parts > (float)(mission->config.points_max - 2U)) {
        return false;
    }

    const uint16_t whole = (uint16_t)parts;
    const uint16_t last = (uint16_t)((float)whole < parts || whole == 0U ? whole + 1U : whole);

    for (uint16_t i = 0; i <= last; i++) {
        const float share = (float)i / (float)last;

        mission->internal.paths[1][i] = (struct jp_point){to_q16(from->x + share * (target->x - from->x)),
                                                          to_q16(from->y + share * (target->y - from->y))};
    }
    return follow(mission, target, (uint16_t)(last + 1U));
}

static bool is_near(const struct jp_patrol_mission *mission)
{
    const float diagonal = DIAGONAL * jp_patrol_cell(mission->config.map);

    return distance_to(mission, &mission->internal.target) < (jp_plane_larger(diagonal, STRAIGHT_BELOW));
}

static struct jp_grid_cell cell_of(const struct jp_patrol_mission *mission, const struct jp_plane_pose *pose)
{
    return (struct jp_grid_cell){(int16_t)jp_patrol_cell_at(&mission->internal.marked, pose->x),
                                 (int16_t)jp_patrol_cell_at(&mission->internal.marked, pose->y)};
}

static float margin_of(const struct jp_patrol_mission *mission)
{
    const float more = mission->internal.trial < MARGINS ? DEVIATIONS * mission->patrol.internal.deviation : 0.0f;

    return margins[mission->internal.trial % MARGINS] + more;
}

/* Of the cells around one, those that no smaller ring has. */
static bool is_on_ring(int32_t x, int32_t y, int32_t ring)
{
    return x == -ring || x == ring || y == -ring || y == ring;
}

/* With the least clearance the path may begin beside the robot, no farther than it is long ahead: something that it
 * has come too near to must not keep it where it is. Where no path leads from the first such cell, one between things
 * that leave no room for the next, it may from another. */
static bool begin_beside(struct jp_patrol_mission *mission, const struct jp_grid_cell *start,
                         const struct jp_grid_cell *goal)
{
    const int32_t rings = (int32_t)(mission->config.patrol.teb.footprint.front / jp_patrol_cell(mission->config.map));
    uint8_t begun = 0;

    for (int32_t ring = 1; ring <= rings && begun <= mission->internal.beside; ring++) {
        const int32_t side = 2 * ring + 1;

        for (int32_t i = 0; i < side * side && begun <= mission->internal.beside; i++) {
            const int32_t x = i % side - ring;
            const int32_t y = i / side - ring;
            const struct jp_grid_cell cell = {(int16_t)(start->x + x), (int16_t)(start->y + y)};

            if (is_on_ring(x, y, ring) && jp_grid_planner_start(&mission->internal.grid, &cell, goal) == JP_OK) {
                begun++;
            }
        }
    }
    mission->internal.is_beside = begun > mission->internal.beside;
    return mission->internal.is_beside;
}

/* The clearance to try after another one. */
static uint8_t next_trial(const struct jp_patrol_mission *mission, uint8_t trial)
{
    const uint8_t next = (uint8_t)(trial + 1U);

    return mission->config.energy != NULL && next % MARGINS == 0U ? (uint8_t)(next + FIRST_PRICED) : next;
}

static bool begin_search(struct jp_patrol_mission *mission)
{
    const struct jp_patrol_mission_config *const config = &mission->config;
    struct jp_grid_planner_config grid = grid_config(config, margin_of(mission));
    struct jp_grid_prices prices;
    const struct jp_grid_cell start = cell_of(mission, &mission->patrol.pose);
    const struct jp_grid_cell goal = cell_of(mission, &mission->internal.target);
    const char *field;

    mission->internal.is_beside = false;
    if (config->energy != NULL) {
        if (jp_patrol_plan_prices(&config->patrol, config->energy, margin_of(mission), jp_patrol_cell(config->map),
                                  &prices) != JP_OK) {
            return false;
        }
        grid.prices = &prices;
    }
    return jp_grid_planner_init(&mission->internal.grid, &grid, &mission->internal.marked, mission->internal.grid_block,
                                mission->internal.grid_size, &field) == JP_OK &&
           (jp_grid_planner_start(&mission->internal.grid, &start, &goal) == JP_OK ||
            (mission->internal.trial + 1U == 2U * MARGINS && begin_beside(mission, &start, &goal)));
}

static bool smooth(struct jp_patrol_mission *mission, uint16_t *count)
{
    const struct jp_patrol_mission_config *const config = &mission->config;
    size_t turns;
    size_t smooth_count;
    const struct jp_point *const path = jp_grid_planner_path(&mission->internal.grid, &turns);

    if (path == NULL || turns > config->turns_max ||
        jp_path_spline(&mission->internal.grid, path, turns, to_q16(SPACING), mission->internal.scratch,
                       jp_path_spline_size(turns), mission->internal.paths[1], config->points_max,
                       &smooth_count) != JP_OK) {
        return false;
    }
    *count = (uint16_t)smooth_count;
    return true;
}

static float length_of(const struct jp_point *path, uint16_t first, uint16_t count)
{
    float length = 0.0f;

    for (uint16_t i = first; i + 1U < count; i++) {
        const struct jp_plane_point a = jp_patrol_path_point(&path[i]);
        const struct jp_plane_point b = jp_patrol_path_point(&path[i + 1U]);

        length += jp_plane_length(b.x - a.x, b.y - a.y);
    }
    return length;
}

/* Who has waited for a time will, as far as is known, wait for as long again: a way that takes no longer is better. */
static bool is_worth_its_way(const struct jp_patrol_mission *mission, uint16_t count)
{
    const struct jp_patrol *const patrol = &mission->patrol;
    const float saved = patrol->config.teb.speed_max * patrol->internal.yielded;

    return length_of(mission->internal.paths[1], 0, count) <
           length_of(patrol->internal.path, patrol->internal.path_next, patrol->internal.path_count) + saved;
}

enum finding { PENDING, FOUND, NOT_FOUND };

static enum finding as_finding(bool is_followed)
{
    return is_followed ? FOUND : NOT_FOUND;
}

/* Searches a path to the target, with ever smaller clearances. What scans show is seen from where the robot is, what
 * only the map shows is off by as much as its position. */
static enum finding find(struct jp_patrol_mission *mission, unsigned expansions)
{
    uint16_t count;

    if (is_near(mission)) {
        mission->price = 0.0f;
        return as_finding(follow_straight(mission, &mission->internal.target));
    }
    if (!mission->internal.is_searching) {
        mission->internal.is_searching = begin_search(mission);
    }
    if (mission->internal.is_searching) {
        if (jp_grid_planner_work(&mission->internal.grid, expansions) == JP_GRID_SEARCHING) {
            return PENDING;
        }
        mission->internal.is_searching = false;
        if (smooth(mission, &count)) {
            if (mission->internal.is_detour && !is_worth_its_way(mission, count)) {
                return NOT_FOUND;
            }
            mission->counts = *jp_grid_planner_statistics(&mission->internal.grid);
            mission->price = jp_plane_of_q32(jp_grid_planner_price(&mission->internal.grid));
            return as_finding(follow(mission, &mission->internal.target, count));
        }
    }
    if (mission->internal.is_beside && mission->internal.beside + 1U < BESIDE_MAX) {
        mission->internal.beside++;
        return PENDING;
    }
    mission->internal.trial = next_trial(mission, mission->internal.trial);
    return mission->internal.trial < 2U * MARGINS ? PENDING : NOT_FOUND;
}

const struct jp_point *jp_patrol_mission_grid_path(const struct jp_patrol_mission *mission, size_t *count)
{
    return jp_grid_planner_path(&mission->internal.grid, count);
}

/* ---- Planning ---- */

static uint8_t first_trial(const struct jp_patrol_mission *mission)
{
    const uint8_t first = mission->patrol.internal.deviation > DEVIATION_MIN ? 0U : (uint8_t)MARGINS;

    return mission->config.energy != NULL ? (uint8_t)(first + FIRST_PRICED) : first;
}

static void seek(struct jp_patrol_mission *mission, const struct jp_plane_pose *target)
{
    mission->internal.target = *target;
    mission->internal.trial = first_trial(mission);
    mission->internal.beside = 0;
    mission->internal.is_searching = false;
    mission->state = JP_MISSION_PLANNING;
}

static void end_detour(struct jp_patrol_mission *mission)
{
    if (mission->internal.is_detour) {
        jp_patrol_clear_trodden(&mission->patrol, mission->config.map, mission->internal.detour_clearance,
                                &mission->internal.marked);
        mission->internal.is_detour = false;
        mission->internal.detour_due = jp_plane_larger(DETOUR_FACTOR * mission->patrol.internal.yielded, DETOUR_WAIT);
    }
}

static void plan(struct jp_patrol_mission *mission)
{
    mission->internal.marks = JP_MARKS_NONE;
    end_detour(mission);
    mission->internal.leg = JP_LEG_GOAL;
    seek(mission, &mission->internal.goal);
}

/* With a clearance from where people walk. */
static void seek_detour(struct jp_patrol_mission *mission, float clearance)
{
    const struct jp_plane_pose target = mission->internal.target;

    jp_patrol_occupy_trodden(&mission->patrol, &target, clearance, &mission->internal.marked);
    seek(mission, &target);
    mission->internal.is_detour = true;
    mission->internal.detour_clearance = clearance;
}

/* Whether the path comes to its end in the heading that is asked for there; on the spot that is the robot's own. */
static bool ends_along(const struct jp_patrol_mission *mission)
{
    const uint16_t last = (uint16_t)(mission->path_count - 1U);
    const struct jp_point *const end = &mission->path[last];
    const struct jp_point *const before = &mission->path[last > END_POINTS ? last - END_POINTS : 0U];
    const bool is_spot = jp_is_same_point(end, before);
    const float direction = is_spot ? mission->patrol.pose.heading
                                    : jp_plane_bearing((float)(end->x - before->x), (float)(end->y - before->y));

    return jp_plane_magnitude(jp_plane_wrap(direction - mission->internal.goal.heading)) < END_TURN;
}

static bool choose_approach(const struct jp_patrol_mission *mission, struct jp_plane_pose *approach)
{
    return mission->config.turns_before_goal &&
           jp_patrol_choose_approach(&mission->internal.marked, &mission->config.patrol.teb.footprint,
                                     &mission->internal.goal, approach);
}

static bool needs_path(const struct jp_patrol_mission *mission)
{
    const enum jp_patrol_reason reason = mission->patrol.reason;
    const bool is_stuck = mission->patrol.state == JP_PATROL_WAITING || mission->patrol.state == JP_PATROL_STOPPED;

    return is_stuck && (reason == JP_PATROL_BLOCKED || reason == JP_PATROL_OFF_PATH || reason == JP_PATROL_STALLED) &&
           mission->internal.tries < TRIES_MAX;
}

/* What the patrol's state means when no path is looked for. */
static enum jp_patrol_mission_state state_of(const struct jp_patrol_mission *mission)
{
    switch (mission->patrol.state) {
    case JP_PATROL_ARRIVED:
        return JP_MISSION_ARRIVED;
    case JP_PATROL_HELD:
        return JP_MISSION_GIVEN_UP;
    case JP_PATROL_STOPPED:
        return needs_path(mission) ? JP_MISSION_UNDER_WAY : JP_MISSION_GIVEN_UP;
    case JP_PATROL_TURNING:
    case JP_PATROL_DRIVING:
    case JP_PATROL_STEPPING:
    case JP_PATROL_GLIDING:
    case JP_PATROL_WAITING:
    default:
        return JP_MISSION_UNDER_WAY;
    }
}

static bool is_at_rest(const struct jp_patrol_mission *mission)
{
    return mission->patrol.state == JP_PATROL_ARRIVED || mission->patrol.state == JP_PATROL_HELD;
}

static void end_planning(struct jp_patrol_mission *mission, enum finding finding)
{
    mission->internal.is_closed = finding == NOT_FOUND;
    if (finding == NOT_FOUND && is_at_rest(mission)) {
        jp_patrol_hold(&mission->patrol);
    }
    mission->state = state_of(mission);
}

/* Where the robot cannot turn at the goal, it turns before it and drives straight in. */
static void end_search(struct jp_patrol_mission *mission, enum finding finding)
{
    struct jp_plane_pose approach;

    if (mission->internal.is_detour && finding != FOUND) {
        end_detour(mission);
        if (mission->internal.detour_clearance > 0.0f) {
            seek_detour(mission, 0.0f);
        } else {
            mission->state = state_of(mission);
        }
        return;
    }
    end_detour(mission);
    if (mission->internal.leg == JP_LEG_GOAL && !(finding == FOUND && ends_along(mission)) &&
        (finding != FOUND || !jp_patrol_can_glide_in(&mission->patrol)) && choose_approach(mission, &approach)) {
        mission->internal.leg = JP_LEG_APPROACH;
        seek(mission, &approach);
    } else {
        end_planning(mission, finding);
    }
}

enum jp_status jp_patrol_mission_start(struct jp_patrol_mission *mission, const struct jp_plane_pose *goal)
{
    if (mission == NULL || goal == NULL || !jp_plane_is_pose(goal)) {
        return JP_ERR_ARGUMENT;
    }
    jp_patrol_hold(&mission->patrol);
    mission->internal.goal = *goal;
    mission->replans = 0;
    mission->internal.tries = 0;
    mission->internal.forgets = 0;
    mission->internal.is_closed = false;
    mission->internal.tried = mission->patrol.pose;
    mission->internal.waited = 0;
    mission->internal.detour_due = DETOUR_WAIT;
    plan(mission);
    return JP_OK;
}

void jp_patrol_mission_stop(struct jp_patrol_mission *mission)
{
    jp_patrol_hold(&mission->patrol);
    mission->internal.marks = JP_MARKS_NONE;
    mission->state = JP_MISSION_IDLE;
}

/* ---- A cycle ---- */

/* Stops for another approach when the laser shows that there is no room to turn at the goal. */
static void watch_goal(struct jp_patrol_mission *mission)
{
    struct jp_plane_pose approach;

    if (mission->patrol.state == JP_PATROL_DRIVING && mission->internal.leg == JP_LEG_GOAL &&
        distance_to(mission, &mission->internal.goal) > WATCH_DISTANCE && !ends_along(mission) &&
        !jp_patrol_can_glide_in(&mission->patrol) && choose_approach(mission, &approach)) {
        if (mission->config.patrol.strategy == (uint8_t)JP_PATROL_BY_COST) {
            mission->internal.leg = JP_LEG_APPROACH;
            seek(mission, &approach);
        } else {
            jp_patrol_pause(&mission->patrol);
            mission->internal.leg = JP_LEG_PAUSE;
        }
    }
}

static void end_marks(struct jp_patrol_mission *mission)
{
    const enum jp_patrol_marks marks = mission->internal.marks;

    mission->internal.marks = JP_MARKS_NONE;
    switch (marks) {
    case JP_MARKS_PLAN:
        plan(mission);
        break;
    case JP_MARKS_DETOUR:
        seek_detour(mission, mission->config.patrol.people.clearance);
        break;
    case JP_MARKS_WATCH:
    case JP_MARKS_NONE:
    default:
        watch_goal(mission);
        break;
    }
}

enum jp_patrol_mission_state jp_patrol_mission_work(struct jp_patrol_mission *mission, unsigned expansions)
{
    if (jp_patrol_marking_is_due(mission)) {
        if (jp_patrol_marking_work(mission, expansions)) {
            end_marks(mission);
        }
    } else if (mission->state == JP_MISSION_PLANNING) {
        const enum finding finding = find(mission, expansions);

        if (finding != PENDING) {
            end_search(mission, finding);
        }
    } else {
        /* There is nothing to do. */
    }
    return mission->state;
}

static void count_try(struct jp_patrol_mission *mission)
{
    if (distance_to(mission, &mission->internal.tried) > mission->config.patrol.horizon) {
        mission->internal.tried = mission->patrol.pose;
        mission->internal.tries = 0;
    }
    mission->internal.tries++;
}

static void forget_what_closes(struct jp_patrol_mission *mission)
{
    if (mission->internal.is_closed && mission->internal.forgets < FORGETS_MAX) {
        mission->internal.forgets++;
        jp_patrol_marking_forget(mission);
    }
}

static void wait(struct jp_patrol_mission *mission, const struct jp_patrol_input *input)
{
    mission->internal.waited++;
    if (mission->internal.waited > (mission->internal.leg == JP_LEG_LAST ? LAST_LEG_WAIT : REPLAN_WAIT)) {
        mission->internal.waited = 0;
        mission->replans++;
        count_try(mission);
        forget_what_closes(mission);
        jp_patrol_marking_begin(mission, input, JP_MARKS_PLAN);
    }
}

/* People walk to and fro across its way. */
static bool is_detour_due(struct jp_patrol_mission *mission)
{
    const float yielded = mission->patrol.internal.yielded;

    if (yielded <= 0.0f) {
        mission->internal.detour_due = DETOUR_WAIT;
    }
    return yielded > mission->internal.detour_due && mission->patrol.internal.is_yielding &&
           (mission->internal.leg == JP_LEG_GOAL || mission->internal.leg == JP_LEG_APPROACH) && !is_near(mission);
}

static void drive_in(struct jp_patrol_mission *mission)
{
    mission->internal.leg = JP_LEG_LAST;
    if (!follow_straight(mission, &mission->internal.goal)) {
        jp_patrol_hold(&mission->patrol);
    }
}

/* Replans, or begins the last leg, as the state of the drive requires. */
static void follow_up(struct jp_patrol_mission *mission, const struct jp_patrol_input *input)
{
    if (mission->internal.leg == JP_LEG_PAUSE && is_at_rest(mission)) {
        plan(mission);
    } else if (mission->internal.leg == JP_LEG_APPROACH && mission->patrol.state == JP_PATROL_ARRIVED) {
        drive_in(mission);
    } else if (needs_path(mission)) {
        wait(mission, input);
    } else if (is_detour_due(mission)) {
        jp_patrol_marking_begin(mission, input, JP_MARKS_DETOUR);
    } else {
        mission->internal.waited = 0;
    }
}

/* From where it has found itself to be, the path leads elsewhere, and what was marked from another place is not there.
 */
static void plan_from_new_place(struct jp_patrol_mission *mission)
{
    jp_patrol_marking_forget(mission);
    mission->internal.marks = JP_MARKS_NONE;
    if (mission->state == JP_MISSION_PLANNING || mission->state == JP_MISSION_UNDER_WAY) {
        jp_patrol_hold(&mission->patrol);
        plan(mission);
    }
}

enum jp_status jp_patrol_mission_cycle(struct jp_patrol_mission *mission, const struct jp_patrol_input *input,
                                       struct jp_twist *twist)
{
    if (mission == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = jp_patrol_cycle(&mission->patrol, input, twist);

    if (status != JP_OK || mission->state == JP_MISSION_IDLE) {
        return status;
    }
    if (input->is_new_place) {
        plan_from_new_place(mission);
    }
    mission->internal.is_watch_due =
        mission->internal.is_watch_due || mission->patrol.counts.cycles % WATCH_CYCLES == 0U;
    jp_patrol_marking_see(mission, input);
    if (mission->state != JP_MISSION_PLANNING) {
        follow_up(mission, input);
    }
    if (mission->state != JP_MISSION_PLANNING) {
        if (mission->internal.is_watch_due && mission->internal.marks == JP_MARKS_NONE) {
            jp_patrol_marking_begin(mission, input, JP_MARKS_WATCH);
            mission->internal.is_watch_due = false;
        }
        mission->state = state_of(mission);
    }
    return status;
}
