/* The planner's scene: a map that is drawn by hand, a robot that finds its way over it by the library's navigator, and
 * what that plans, repairs and takes. Driven as jp-navigate drives it, tick by tick: it knows the map, and what it sees
 * around it is on its map where its odometry puts it; but what is drawn while it drives is told at once. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/app/navigation.h"
#include "sim/base/fingerprint.h"
#include "sim/base/strict_math.h"
#include "sim/missions/navigation_balancer.h"
#include "sim/missions/navigation_sight.h"
#include "sim/missions/navigation_skid.h"
#include "sim/missions/plan_lattice.h"
#include "sim/page/page_export.h"
#include "sim/page/page_robots.h"

#define Q16_ONE 65536.0

#define ALIGNMENT 8

/* As jp-navigate: expansions of a slice, slices and looks a second. */
#define SLICE       32
#define WORK_RATE   500
#define SENSOR_RATE 20

/* m, as of jp-navigate. */
#define VIEW_M 2.5

#define CELLS_MAX 65536
#define LEGS_MAX  96
#define STEPS_MAX 8192

/* What is not known yet. */
#define UNKNOWN ((double)NAN)

#define VIEW(X)                                                                                                        \
    X(time_s)                                                                                                          \
    X(x_m)                                                                                                             \
    X(y_m)                                                                                                             \
    X(heading_rad)                                                                                                     \
    X(state)                                                                                                           \
    X(reason)                                                                                                          \
    X(replans)                                                                                                         \
    X(is_touched)                                                                                                      \
    X(answer)                                                                                                          \
    X(plan_j)                                                                                                          \
    X(plan_bound)                                                                                                      \
    X(plan_steps)                                                                                                      \
    X(expansions)                                                                                                      \
    X(first_expansions)                                                                                                \
    X(repair_expansions)                                                                                               \
    X(restarts)                                                                                                        \
    X(states)                                                                                                          \
    X(states_max)                                                                                                      \
    X(guide_bytes)                                                                                                     \
    X(field_bytes)                                                                                                     \
    X(search_bytes)                                                                                                    \
    X(is_idle)                                                                                                         \
    X(forecast_j)                                                                                                      \
    X(deviation_j)                                                                                                     \
    X(left_m)                                                                                                          \
    X(driven_j)                                                                                                        \
    X(driven_m)                                                                                                        \
    X(drawn_j)                                                                                                         \
    X(capacity_j)                                                                                                      \
    X(bus_voltage_v)                                                                                                   \
    X(length_m)                                                                                                        \
    X(width_m)                                                                                                         \
    X(radius_m)                                                                                                        \
    X(digest_low)                                                                                                      \
    X(digest_high)

enum { VIEW(PAGE_INDEX) VIEW_COUNT };

enum kind { SKID, BALANCER };

/* What a cell is, for the page. */
enum mark { MARK_FREE, MARK_WALL, MARK_STEEP };

/* What the search has made of a cell, of the headings there the one that is furthest. */
enum searched { SEARCHED_NOT, SEARCHED_OPEN, SEARCHED_EXPANDED };

static struct {
    enum kind kind;
    unsigned number; /* of the robot's kind */
    const struct jp_lattice *lattice;
    unsigned width;
    unsigned height;
    uint8_t marks[CELLS_MAX];
    uint8_t searched[CELLS_MAX];
    jp_elevation elevations[CELLS_MAX];
    struct jp_terrain map;   /* that the robot has */
    struct jp_terrain world; /* as it is, with what is too steep */
    struct jp_terrain solid; /* what can be touched of it */
    struct navigation_task task;
    struct navigation_result result;
    struct navigation_robot robot;
    struct navigation_skid skid;
    struct navigation_balancer balancer;
    struct jp_planner planner;
    struct jp_navigator navigator;
    struct jp_course_leg legs[LEGS_MAX];
    void *blocks[6]; /* map, solid, planner, way, world, seen */
    bool is_ready;
    uint64_t tick;
    double joules_before;
    struct clearance_pose before;
    struct jp_progress progress; /* of the last course, when it began */
    bool has_progress;
    bool had_joined;
    uint32_t first_expansions;  /* when the first search came to rest */
    uint32_t change_expansions; /* at the last change of the map */
    bool has_changed;
    double points[STEPS_MAX][2];
    double view[VIEW_COUNT];
} page;

/* ---- Robots ---- */

static bool is_navigating(unsigned balancer)
{
    return !isnan(page_balancers[balancer]->navigation.margin_m);
}

/** Robots that find their way: those that their sides steer, then the balancers. */
PAGE_EXPORT(planner_robots) unsigned planner_robots(void)
{
    unsigned count = (unsigned)page_skid_robot_count;

    for (unsigned i = 0; i < page_balancer_count; i++) {
        count += is_navigating(i);
    }
    return count;
}

static void choose_robot(unsigned robot, enum kind *kind, unsigned *number)
{
    *kind = robot < page_skid_robot_count ? SKID : BALANCER;
    *number = robot;
    if (*kind == BALANCER) {
        unsigned left = robot - (unsigned)page_skid_robot_count;

        for (*number = 0; !is_navigating(*number) || left > 0; (*number)++) {
            left -= is_navigating(*number);
        }
    }
}

static const char *name_of(enum kind kind, unsigned number)
{
    return kind == SKID ? page_skid_robots[number]->name : page_balancers[number]->name;
}

PAGE_EXPORT(planner_robot_name) const char *planner_robot_name(unsigned robot)
{
    enum kind kind;
    unsigned number;

    choose_robot(robot, &kind, &number);
    return name_of(kind, number);
}

/* ---- The map ---- */

static void release(void)
{
    for (size_t i = 0; i < sizeof page.blocks / sizeof page.blocks[0]; i++) {
        free(page.blocks[i]);
        page.blocks[i] = NULL;
    }
    page.is_ready = false;
}

/** An empty level map of a robot's cells. The side of a cell, m; 0: there is no such map. */
PAGE_EXPORT(planner_new) double planner_new(unsigned robot, unsigned width, unsigned height)
{
    release();
    choose_robot(robot, &page.kind, &page.number);
    page.lattice = plan_lattice_for_navigation(name_of(page.kind, page.number));
    page.width = width;
    page.height = height;
    memset(page.marks, MARK_FREE, sizeof page.marks);
    memset(page.elevations, 0, sizeof page.elevations);
    memset(page.searched, SEARCHED_NOT, sizeof page.searched);
    return page.lattice == NULL || width * height > CELLS_MAX ? 0 : page.lattice->resolution / Q16_ONE;
}

/** A row of cells each, south first: 0 free, 1 wall, 2 too steep for the robot. */
PAGE_EXPORT(planner_marks) const uint8_t *planner_marks(void)
{
    return page.marks;
}

/** 2⁻¹⁰ m; to be written before planner_begin(). */
PAGE_EXPORT(planner_elevations) jp_elevation *planner_elevations(void)
{
    return page.elevations;
}

static void mark_terrain(struct jp_terrain *terrain)
{
    for (unsigned i = 0; i < page.width * page.height; i++) {
        const int32_t x = (int32_t)(i % page.width);
        const int32_t y = (int32_t)(i / page.width);

        (void)jp_terrain_set_cell(terrain, x, y, page.marks[i] == MARK_WALL ? JP_CELL_OCCUPIED : JP_CELL_FREE);
        if (terrain->config.has_elevation) {
            (void)jp_terrain_set_elevation(terrain, x, y, page.elevations[i]);
        }
    }
}

static bool has_hills(void)
{
    for (unsigned i = 0; i < page.width * page.height; i++) {
        if (page.elevations[i] != 0) {
            return true;
        }
    }
    return false;
}

static bool make_terrain(struct jp_terrain *terrain, void **block)
{
    const struct jp_terrain_config config = {.width = (uint16_t)page.width,
                                             .height = (uint16_t)page.height,
                                             .resolution = page.lattice->resolution,
                                             .has_elevation = has_hills()};
    const size_t size = jp_terrain_size(&config);
    const char *field;

    *block = aligned_alloc(ALIGNMENT, (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT);
    if (*block == NULL || jp_terrain_init(terrain, &config, *block, size, &field) != JP_OK) {
        return false;
    }
    mark_terrain(terrain);
    return true;
}

static void block_steep(double steepest)
{
    (void)jp_terrain_block_steep(&page.map, (jp_q24)lround(steepest * JP_Q24_ONE));
    (void)jp_terrain_block_steep(&page.world, (jp_q24)lround(steepest * JP_Q24_ONE));
    for (unsigned i = 0; i < page.width * page.height; i++) {
        const bool is_blocked =
            jp_terrain_cell(&page.map, (int32_t)(i % page.width), (int32_t)(i / page.width)) == JP_CELL_OCCUPIED;

        if (page.marks[i] != MARK_WALL) {
            page.marks[i] = is_blocked ? MARK_STEEP : MARK_FREE;
        }
    }
}

static double steepest(void)
{
    return page.kind == SKID ? page_skid_robot_grades[page.number] : page_balancer_grades[page.number];
}

/* ---- A drive ---- */

static bool switch_on(const struct clearance_pose *start)
{
    const char *name = name_of(page.kind, page.number);

    if (page.kind == BALANCER) {
        return navigation_balancer_init(&page.balancer, rig_find_robot(name), page_balancers[page.number], start,
                                        page.task.seed, JP_PILOT_MOTORS, &page.robot);
    }
    const struct skid_robot_entry *entry = skid_robot_find(name);

    return entry != NULL && navigation_skid_init(&page.skid, entry, page_skid_robots[page.number], &page.world, NULL,
                                                 start, page.task.seed, &page.robot);
}

static enum jp_status prepare(const struct clearance_pose *start)
{
    const struct jp_planner_config planner = {page.lattice, JP_COST_PHYSICAL, JP_NAVIGATION_EPSILON};
    const struct jp_place origin = navigation_place(start);
    const double radius = strict_hypot(page.robot.body.length_m, page.robot.body.width_m) / 2;
    const size_t way_size = jp_navigator_way_size(&page.map.config);
    const size_t seen_size = jp_navigator_seen_size(&page.map.config);
    const char *field;

    page.blocks[2] = aligned_alloc(ALIGNMENT, (page.task.memory + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT);
    page.blocks[3] = malloc(way_size);
    page.blocks[5] = malloc(seen_size);
    if (page.blocks[2] == NULL || page.blocks[3] == NULL || page.blocks[5] == NULL) {
        return JP_ERR_MEMORY;
    }
    const struct jp_navigator_config config = {.planner = &page.planner,
                                               .vehicle = &page.robot.vehicle,
                                               .radius = (jp_q16)lround(radius * Q16_ONE),
                                               .margin = (jp_q16)lround(page.robot.margin_m * Q16_ONE),
                                               .legs = page.legs,
                                               .legs_max = LEGS_MAX,
                                               .slice = SLICE,
                                               .patience = JP_NAVIGATION_PATIENCE,
                                               .way_block = page.blocks[3],
                                               .way_size = way_size,
                                               .seen = page.blocks[5],
                                               .seen_size = seen_size};
    const enum jp_status status =
        jp_planner_init(&page.planner, &planner, &page.map, page.blocks[2], page.task.memory, &field);

    return status == JP_OK ? jp_navigator_init(&page.navigator, &config, &origin, &field) : status;
}

static double joules_now(void)
{
    return page.robot.joules(page.robot.self);
}

/** Least KiB of the planner's block for this map. */
PAGE_EXPORT(planner_memory_min) unsigned planner_memory_min(void)
{
    const struct jp_terrain_config config = {.width = (uint16_t)page.width,
                                             .height = (uint16_t)page.height,
                                             .resolution = page.lattice->resolution,
                                             .has_elevation = has_hills()};

    return (unsigned)((jp_planner_size(&config) + 1023) / 1024);
}

static void forget(void)
{
    page.tick = 0;
    page.has_progress = page.had_joined = page.has_changed = false;
    page.first_expansions = page.change_expansions = 0;
    page.result = (struct navigation_result){.clearance_m = NAVIGATION_CLEARANCE_MAX};
}

/** Walls are 1 among the marks, the rest free. Puts the robot on a cell, with the heading of the lattice, and sends it
 *  to another, in a block of so many KiB. A status of the library. */
PAGE_EXPORT(planner_begin)
int planner_begin(int x, int y, unsigned heading, int goal_x, int goal_y, unsigned kib, double seed)
{
    release();
    if (!make_terrain(&page.map, &page.blocks[0]) || !make_terrain(&page.solid, &page.blocks[1]) ||
        !make_terrain(&page.world, &page.blocks[4])) {
        return JP_ERR_MEMORY;
    }
    block_steep(steepest());
    page.task = (struct navigation_task){.lattice = page.lattice,
                                         .map = &page.map,
                                         .world = &page.world,
                                         .solid = &page.solid,
                                         .start = {(int16_t)x, (int16_t)y, (uint8_t)heading},
                                         .goal = {(int16_t)goal_x, (int16_t)goal_y, JP_ANY_HEADING},
                                         .view_m = VIEW_M,
                                         .memory = (size_t)kib * 1024,
                                         .seed = (uint64_t)seed};
    forget();
    const struct clearance_pose start = navigation_start(&page.task);

    if (!switch_on(&start)) {
        return JP_ERR_STATE;
    }
    enum jp_status status = prepare(&start);

    page.joules_before = joules_now();
    page.before = start;
    if (status == JP_OK) {
        status = jp_navigator_go(&page.navigator, &page.task.goal);
    }
    page.is_ready = status == JP_OK;
    return (int)status;
}

/** Another goal, on the way. */
PAGE_EXPORT(planner_goal) int planner_goal(int x, int y)
{
    const struct jp_goal goal = {(int16_t)x, (int16_t)y, JP_ANY_HEADING};
    const enum jp_status status = page.is_ready ? jp_navigator_go(&page.navigator, &goal) : JP_ERR_STATE;

    if (status == JP_OK) {
        page.task.goal = goal;
        page.has_progress = false;
        page.has_changed = false;
        page.first_expansions = 0;
        page.change_expansions = jp_planner_statistics(&page.planner)->expansions;
    }
    return (int)status;
}

static void note_change(void)
{
    if (!page.has_changed && page.first_expansions == 0) {
        page.first_expansions = jp_planner_statistics(&page.planner)->expansions - page.change_expansions;
    }
    page.has_changed = true;
    page.change_expansions = jp_planner_statistics(&page.planner)->expansions;
}

/** A wall comes or goes, also while the robot drives: the navigator looks whether its way is still clear, the planner
 *  repairs. Ground that is too steep stays so. */
PAGE_EXPORT(planner_wall) void planner_wall(int x, int y, unsigned is_wall)
{
    uint8_t *mark = &page.marks[(unsigned)y * page.width + (unsigned)x];

    if (x < 0 || y < 0 || x >= (int)page.width || y >= (int)page.height || *mark == MARK_STEEP ||
        (*mark == MARK_WALL) == (is_wall != 0)) {
        return;
    }
    *mark = is_wall != 0 ? MARK_WALL : MARK_FREE;
    if (page.is_ready) {
        const enum jp_cell cell = is_wall != 0 ? JP_CELL_OCCUPIED : JP_CELL_FREE;

        note_change();
        (void)jp_terrain_set_cell(&page.solid, x, y, cell);
        (void)jp_terrain_set_cell(&page.world, x, y, cell);
        (void)jp_navigator_set_cell(&page.navigator, x, y, cell);
    }
}

/* ---- Time ---- */

static bool tell(void *context, int x, int y, enum jp_cell cell)
{
    (void)context;
    (void)jp_navigator_set_cell(&page.navigator, x, y, cell);
    return true;
}

static void look(void)
{
    const struct clearance_pose pose = page.robot.pose(page.robot.self);
    const struct jp_place believed = jp_navigator_place(&page.navigator);

    navigation_look(&page.task, &pose, &believed, &page.result, tell, NULL);
    navigation_measure(&page.task, &page.robot.body, &pose, &page.result);
    page.result.length_m += strict_hypot(pose.x - page.before.x, pose.y - page.before.y);
    page.before = pose;
}

static void note_forecast(void)
{
    const bool has_joined =
        page.navigator.state == JP_NAVIGATOR_TURNING || page.navigator.state == JP_NAVIGATOR_DRIVING;

    if (has_joined && !page.had_joined && jp_navigator_progress(&page.navigator, &page.progress) == JP_OK) {
        page.has_progress = true;
    }
    page.had_joined = has_joined;
}

static void work(void)
{
    (void)jp_navigator_work(&page.navigator);
    note_forecast();
    if (page.first_expansions == 0 && page.has_progress && !page.has_changed) {
        page.first_expansions = jp_planner_statistics(&page.planner)->expansions - page.change_expansions;
    }
}

PAGE_EXPORT(planner_is_over) unsigned planner_is_over(void)
{
    return !page.is_ready || page.navigator.state >= JP_NAVIGATOR_ARRIVED;
}

/** So many ticks; fewer when the drive comes to its end. */
PAGE_EXPORT(planner_run) unsigned planner_run(unsigned ticks)
{
    const uint64_t rate = page.is_ready ? (uint64_t)page.robot.rate_hz : 1;
    unsigned done = 0;

    for (; done < ticks && !planner_is_over(); done++, page.tick++) {
        page.robot.tick(page.robot.self);
        if (page.tick % (rate / SENSOR_RATE) == 0) {
            look();
        }
        if (rate <= WORK_RATE || page.tick % (rate / WORK_RATE) == 0) {
            work();
        }
        page.result.seconds = (double)page.tick / page.robot.rate_hz;
    }
    return done;
}

PAGE_EXPORT(planner_ticks_a_second) unsigned planner_ticks_a_second(void)
{
    return (unsigned)page.robot.rate_hz;
}

/* ---- The search ---- */

static void mark_searched(const struct jp_lattice_pose *pose, bool is_open)
{
    uint8_t *mark = &page.searched[(unsigned)pose->y * page.width + (unsigned)pose->x];
    const uint8_t is = is_open ? SEARCHED_OPEN : SEARCHED_EXPANDED;

    *mark = *mark > is ? *mark : is;
}

/** A row of cells each, south first: 0 the search has not met it, 1 it waits at the frontier, 2 it is expanded. When
 * the search has given its memory away they are as they were last. */
PAGE_EXPORT(planner_searched) const uint8_t *planner_searched(void)
{
    struct jp_lattice_pose pose;
    uint32_t slot = 0;
    bool is_open;
    bool is_first = true;

    while (page.is_ready && jp_planner_next_state(&page.planner, &slot, &pose, &is_open)) {
        if (is_first) {
            memset(page.searched, SEARCHED_NOT, sizeof page.searched);
            is_first = false;
        }
        mark_searched(&pose, is_open);
    }
    return page.searched;
}

/* ---- Lines ---- */

static unsigned add_point(unsigned count, double x, double y)
{
    if (count < STEPS_MAX) {
        page.points[count][0] = x;
        page.points[count][1] = y;
        count++;
    }
    return count;
}

static unsigned add_cell(unsigned count, int x, int y)
{
    const double cell = page.lattice->resolution / Q16_ONE;

    return add_point(count, (x + 0.5) * cell, (y + 0.5) * cell);
}

/** The planner's route, over the cells that its steps lead over: so many points. */
PAGE_EXPORT(planner_route) unsigned planner_route(void)
{
    const struct jp_plan *plan = page.is_ready ? jp_planner_plan(&page.planner) : NULL;

    if (plan == NULL || plan->answer == JP_ANSWER_OUT_OF_BUDGET) {
        return 0;
    }
    struct jp_lattice_pose pose = plan->start;
    unsigned count = add_cell(0, pose.x, pose.y);

    for (unsigned i = 0; i < plan->step_count; i++) {
        int x = pose.x;
        int y = pose.y;
        const struct jp_primitive *primitive = jp_planner_step(&page.planner, i, &pose);

        for (unsigned k = 0; k < primitive->move_count; k++) {
            const unsigned direction = page.lattice->moves[primitive->first_move + k];

            x += jp_move_offsets[direction].dx;
            y += jp_move_offsets[direction].dy;
            count = add_cell(count, x, y);
        }
    }
    return count;
}

/** What is left of the navigator's course, straight lines from the robot on: so many points. */
PAGE_EXPORT(planner_course) unsigned planner_course(void)
{
    uint16_t legs = 0;
    const struct jp_course_leg *leg = page.is_ready ? jp_navigator_legs(&page.navigator, &legs) : NULL;
    const struct jp_place place = page.is_ready ? jp_navigator_place(&page.navigator) : (struct jp_place){.heading = 0};
    unsigned count = legs > 0 ? add_point(0, place.point.x / Q16_ONE, place.point.y / Q16_ONE) : 0;

    for (uint16_t i = 0; i < legs; i++) {
        count = add_point(count, leg[i].end.x / Q16_ONE, leg[i].end.y / Q16_ONE);
    }
    return count;
}

/** x and y, m, of each point of the last line. */
PAGE_EXPORT(planner_points) const double *planner_points(void)
{
    return &page.points[0][0];
}

/** Directions of the lattice's headings, rad. */
PAGE_EXPORT(planner_heading) double planner_heading(unsigned heading)
{
    return page.lattice->heading[heading] / 4294967296.0 * 2 * M_PI;
}

/* ---- The view ---- */

static void view_robot(void)
{
    const struct clearance_pose pose = page.robot.pose(page.robot.self);
    const bool is_skid = page.kind == SKID;

    page.view[VIEW_time_s] = (double)page.tick / page.robot.rate_hz;
    page.view[VIEW_x_m] = pose.x;
    page.view[VIEW_y_m] = pose.y;
    page.view[VIEW_heading_rad] = pose.heading;
    page.view[VIEW_is_touched] = page.result.is_touched;
    page.view[VIEW_driven_j] = joules_now() - page.joules_before;
    page.view[VIEW_driven_m] = page.result.length_m;
    page.view[VIEW_drawn_j] = joules_now();
    page.view[VIEW_capacity_j] = is_skid ? UNKNOWN : page_balancers[page.number]->supply.capacity_wh * 3600;
    page.view[VIEW_bus_voltage_v] =
        is_skid ? page.skid.world.plant.attitude.bus_voltage : page.balancer.rig.world.bus_voltage;
    page.view[VIEW_length_m] = page.robot.body.length_m;
    page.view[VIEW_width_m] = page.robot.body.width_m;
    page.view[VIEW_radius_m] = strict_hypot(page.robot.body.length_m, page.robot.body.width_m) / 2;
}

static double vehicle_joules(jp_q16 energy)
{
    return ldexp(energy, page.robot.unit_exponent - 16);
}

static void view_navigator(void)
{
    struct jp_progress left;
    const bool is_on_course = jp_navigator_progress(&page.navigator, &left) == JP_OK;

    page.view[VIEW_state] = page.navigator.state;
    page.view[VIEW_reason] = page.navigator.reason;
    page.view[VIEW_replans] = page.navigator.replans;
    page.view[VIEW_forecast_j] = page.has_progress ? vehicle_joules(page.progress.energy.energy) : UNKNOWN;
    page.view[VIEW_deviation_j] = page.has_progress ? vehicle_joules(page.progress.energy.deviation) : UNKNOWN;
    page.view[VIEW_left_m] = is_on_course ? left.length / Q16_ONE : UNKNOWN;
}

static void view_planner(void)
{
    const struct jp_plan *plan = jp_planner_plan(&page.planner);
    const struct jp_planner_counts *counts = jp_planner_statistics(&page.planner);
    const bool has_route = plan->answer == JP_ANSWER_OPTIMAL || plan->answer == JP_ANSWER_WITHIN_BOUND;

    page.view[VIEW_answer] = plan->answer;
    page.view[VIEW_plan_j] = has_route ? (double)plan->cost / JP_COST_PER_JOULE : UNKNOWN;
    page.view[VIEW_plan_bound] = has_route && plan->bound != JP_BOUND_NONE ? plan->bound / 256.0 : UNKNOWN;
    page.view[VIEW_plan_steps] = plan->step_count;
    page.view[VIEW_expansions] = counts->expansions;
    page.view[VIEW_first_expansions] = page.first_expansions > 0 ? page.first_expansions : UNKNOWN;
    page.view[VIEW_repair_expansions] = page.has_changed ? counts->expansions - page.change_expansions : UNKNOWN;
    page.view[VIEW_restarts] = counts->restarts;
    page.view[VIEW_states] = counts->states;
    page.view[VIEW_states_max] = counts->states_max;
    page.view[VIEW_guide_bytes] = counts->guide_bytes;
    page.view[VIEW_field_bytes] = counts->field_bytes;
    page.view[VIEW_search_bytes] = counts->search_bytes;
    page.view[VIEW_is_idle] = jp_planner_is_idle(&page.planner);
}

/* Of the robot's pose and of what it has spent. */
static void view_digest(void)
{
    const struct clearance_pose pose = page.robot.pose(page.robot.self);
    const double joules = joules_now();
    uint64_t fingerprint = FINGERPRINT_START;

    fingerprint_add(&fingerprint, &pose, sizeof pose);
    fingerprint_add(&fingerprint, &joules, sizeof joules);
    page.view[VIEW_digest_low] = (double)(fingerprint & 0xFFFFFFFFU);
    page.view[VIEW_digest_high] = (double)(fingerprint >> 32);
}

PAGE_EXPORT(planner_view_names) const char *planner_view_names(void)
{
    return VIEW(PAGE_NAME);
}

/** Not a number everywhere until a drive has begun. */
PAGE_EXPORT(planner_view) const double *planner_view(void)
{
    for (size_t i = 0; i < VIEW_COUNT; i++) {
        page.view[i] = UNKNOWN;
    }
    if (page.is_ready) {
        view_robot();
        view_navigator();
        view_planner();
        view_digest();
    }
    return page.view;
}

/** What the navigator does, and why, for people. */
PAGE_EXPORT(planner_state_name) const char *planner_state_name(void)
{
    return navigation_state_name(page.is_ready ? page.navigator.state : JP_NAVIGATOR_IDLE);
}

PAGE_EXPORT(planner_reason_name) const char *planner_reason_name(void)
{
    return navigation_reason_name(page.is_ready ? page.navigator.reason : JP_NAVIGATOR_NO_REASON);
}
