/* Waypoints from routes over random maps: what waypoints.h promises, each by a check of its own: the robot as a cloud
 * of points instead of a rectangle, motion and energy by the library's other calls. prop_waypoints [--count N] [--seed
 * S] */
#include <joulepath/tables.h>
#include <joulepath/waypoints.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/rig.h"
#include "sim/base/random.h"
#include "sim/missions/plan_search.h"
#include "src/map/clearance.h"
#include "tests/support/options.h"
#include "unity.h"

#define WIDTH      60
#define HEIGHT     40
#define CELL_M     ((double)JP_Q16(0.2) / JP_Q16_ONE)
#define LENGTH_M   0.30
#define WIDTH_M    0.35
#define MEMORY     ((size_t)512 * 1024)
#define CLOUD      13 /* points of the footprint in each direction */
#define STEP_M     0.01
#define STEP_RAD   0.02
#define CLIP_M     0.011 /* a corner may be clipped by this much between two poses that are looked at */
#define POSES_MAX  1024
#define Q16_ONE    65536.0
#define Q24_ONE    16777216.0
#define TURN       4294967296.0
#define TOLERANCE  1e-3 /* m */
#define ROUNDING_M 2e-6 /* of a box in cells */
#define MARGIN_MIN 2    /* steps, of every second map */

static struct options options = {.count = 50, .seed = 1};
static unsigned long long seed;
static struct random noise;
static struct map_file map;
static struct plan_task task;
static struct plan_search search;
static struct jp_lattice_pose route[POSES_MAX];
static size_t route_count;
static struct jp_waypoints_config config;
static struct jp_waypoints choice;
static struct jp_waypoint waypoints[POSES_MAX];
static size_t waypoint_count;

void setUp(void)
{
}

void tearDown(void)
{
}

static void check(bool holds, const char *what, double value)
{
    char message[120];

    if (!holds) {
        (void)snprintf(message, sizeof message, "seed %llu: %s: %g", seed, what, value);
        TEST_FAIL_MESSAGE(message);
    }
}

/* ---- Maps and routes ---- */

static void begin_map_of(bool has_elevation)
{
    const struct jp_terrain_config terrain = {
        .width = WIDTH, .height = HEIGHT, .resolution = JP_Q16(0.2), .has_elevation = has_elevation};
    const char *field;

    map = (struct map_file){.block = malloc(jp_terrain_size(&terrain)), .name = "random"};
    TEST_ASSERT_NOT_NULL(map.block);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map.terrain, &terrain, map.block, jp_terrain_size(&terrain), &field));
    for (int32_t y = 0; y < HEIGHT; y++) {
        for (int32_t x = 0; x < WIDTH; x++) {
            (void)jp_terrain_set_cell(&map.terrain, x, y, JP_CELL_FREE);
        }
    }
}

static void begin_map(void)
{
    begin_map_of(false);
}

static void block(int x, int y, int width, int height, enum jp_cell cell)
{
    for (int i = 0; i < width * height; i++) {
        (void)jp_terrain_set_cell(&map.terrain, x + i % width, y + i / width, cell);
    }
}

static int draw(int below)
{
    return (int)(random_uniform(&noise, 0, below));
}

static void scatter(void)
{
    const int blocks = draw(40);

    for (int i = 0; i < blocks; i++) {
        block(draw(WIDTH), draw(HEIGHT), 1 + draw(6), 1 + draw(6), draw(4) == 0 ? JP_CELL_UNKNOWN : JP_CELL_OCCUPIED);
    }
}

/* Plans from a random place to another; false when there is no route. */
static bool plan(void)
{
    const struct jp_lattice *lattice = &jp_lattice_gao2018;

    task = (struct plan_task){{(int16_t)draw(WIDTH), (int16_t)draw(HEIGHT), (uint8_t)draw(JP_HEADINGS)},
                              {(int16_t)draw(WIDTH), (int16_t)draw(HEIGHT), JP_ANY_HEADING},
                              false};
    if (!jp_lattice_can_stand(lattice, &map.terrain, task.start.x, task.start.y, task.start.heading) ||
        !jp_lattice_can_stand(lattice, &map.terrain, task.goal.x, task.goal.y, 0)) {
        return false;
    }
    TEST_ASSERT_TRUE(plan_search(&map, lattice, JP_COST_PHYSICAL, &task, MEMORY, &search));
    route_count = search.route.way_count;
    TEST_ASSERT_TRUE(route_count <= POSES_MAX);
    memcpy(route, search.route.way, route_count * sizeof *route);
    const bool arrives = plan_search_arrives(&search);
    plan_route_free(&search.route);
    return arrives && route_count > 1;
}

static void choose(void)
{
    const size_t size = jp_waypoints_size(route_count);
    void *block = malloc(size);
    const char *field;

    TEST_ASSERT_NOT_NULL(block);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_waypoints_init(&choice, &config, block, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_waypoints_start(&choice, route, route_count));
    while (jp_waypoints_work(&choice, 1000) == JP_WAYPOINTS_CHOOSING) {
    }
    waypoint_count = jp_waypoints_count(&choice);
    TEST_ASSERT_EQUAL_INT(waypoint_count > 0 ? JP_OK : JP_ERR_NO_PLAN,
                          jp_waypoints_read(&choice, waypoints, POSES_MAX));
    free(block);
}

static struct clearance_pose pose_of(const struct jp_waypoint *waypoint)
{
    const struct clearance_pose start = plan_grid_pose(&map, config.lattice, &route[0]);

    return (struct clearance_pose){start.x + waypoint->point.x / Q16_ONE, start.y + waypoint->point.y / Q16_ONE,
                                   waypoint->heading / TURN * 2 * M_PI};
}

/* ---- Oracles ---- */

static bool point_is_free(double x, double y)
{
    return jp_terrain_cell(&map.terrain, (int32_t)floor(x / CELL_M), (int32_t)floor(y / CELL_M)) == JP_CELL_FREE;
}

/* The footprint, smaller by `clip` on all sides, as a cloud of points. */
static bool cloud_is_free(double x, double y, double heading, double clip)
{
    for (int i = 0; i < CLOUD * CLOUD; i++) {
        const double u = (2.0 * (i % CLOUD) / (CLOUD - 1) - 1) * (LENGTH_M / 2 - clip);
        const double v = (2.0 * (i / CLOUD) / (CLOUD - 1) - 1) * (WIDTH_M / 2 - clip);
        if (!point_is_free(x + u * cos(heading) - v * sin(heading), y + u * sin(heading) + v * cos(heading))) {
            return false;
        }
    }
    return true;
}

/* Integrates a turn on the spot, then a motion of constant speed and turn rate, by small steps. Returns its end. */
static struct clearance_pose sweep(struct clearance_pose pose, double turn, double length, double angle, double margin)
{
    const double clip = CLIP_M - margin;
    const int turns = 1 + (int)(fabs(turn) / STEP_RAD);
    const int steps = 1 + (int)(length / STEP_M);

    for (int i = 0; i < turns; i++) {
        pose.heading += turn / turns;
        check(cloud_is_free(pose.x, pose.y, pose.heading, clip), "turn is clear at x", pose.x);
    }
    for (int i = 0; i < steps; i++) {
        const double middle = pose.heading + angle / steps / 2;
        pose.x += length / steps * cos(middle);
        pose.y += length / steps * sin(middle);
        pose.heading += angle / steps;
        check(cloud_is_free(pose.x, pose.y, pose.heading, clip), "path is clear at x", pose.x);
    }
    return pose;
}

static double distance(const struct clearance_pose *a, const struct clearance_pose *b)
{
    return hypot(b->x - a->x, b->y - a->y);
}

/* ---- Properties ---- */

/* On its pose of the route, or a cell beside it, across where the route leads there. */
static void check_place(const struct jp_waypoint *waypoint)
{
    const struct clearance_pose place = pose_of(waypoint);
    const struct clearance_pose pose = plan_grid_pose(&map, config.lattice, &route[waypoint->pose]);
    const double dx = place.x - pose.x;
    const double dy = place.y - pose.y;

    check(fabs(hypot(dx, dy) - abs(waypoint->side) * CELL_M) < TOLERANCE, "place beside its pose, m", hypot(dx, dy));
    if (waypoint->side != 0) {
        const struct jp_lattice_pose *before = &route[waypoint->pose - 1];
        const struct jp_lattice_pose *after = &route[waypoint->pose + 1];
        const double across = (after->x - before->x) * dy - (after->y - before->y) * dx;
        const double along = (after->x - before->x) * dx + (after->y - before->y) * dy;
        check(waypoint->side * across >= 0 && fabs(along) < TOLERANCE, "place to its side, along", along);
    }
}

static void check_order(void)
{
    check(waypoints[0].pose == 0, "first waypoint is the start", waypoints[0].pose);
    check(waypoints[0].heading == config.lattice->heading[route[0].heading], "heading of the start", 0);
    check(waypoints[waypoint_count - 1].pose + 1U == route_count, "last waypoint is the goal", (double)waypoint_count);
    check(waypoints[waypoint_count - 1].side == 0, "goal on the route", waypoints[waypoint_count - 1].side);
    for (size_t i = 0; i < waypoint_count; i++) {
        check(i == 0 || waypoints[i].pose >= waypoints[i - 1].pose, "waypoints in order", (double)i);
        check_place(&waypoints[i]);
    }
}

static void check_limits(const struct jp_segment *segment)
{
    const struct jp_segment_command *command = &segment->command;

    check(abs(command->turn) <= config.limits->turn, "turn", command->turn / Q24_ONE);
    check(command->motion.speed > 0 && command->motion.speed <= config.limits->speed, "speed",
          command->motion.speed / Q24_ONE);
    check(abs(command->motion.turn_rate) <= config.limits->turn_rate, "turn rate", command->motion.turn_rate / Q24_ONE);
    check(command->duration >= config.model->settling_time, "duration", command->duration / Q16_ONE);
}

/* The chord as a straight path, whose heading is its own; turning into it is the arc's matter. */
static void check_chord(const struct clearance_pose *from, const struct clearance_pose *to)
{
    struct clearance_pose pose = *from;

    pose.heading = atan2(to->y - from->y, to->x - from->x);
    (void)sweep(pose, 0, distance(from, to), 0, 0);
}

static void check_segment(const struct jp_waypoint *from, const struct jp_waypoint *to)
{
    const struct jp_segment *segment = &to->segment;
    const double time = segment->command.duration / Q16_ONE;
    const double margin = JP_WAYPOINTS_MARGIN_M * to->margin / JP_WAYPOINTS_MARGIN_STEPS;
    const struct clearance_pose pose = pose_of(to);
    const struct clearance_pose end =
        sweep(pose_of(from), segment->command.turn / Q24_ONE, segment->command.motion.speed / Q24_ONE * time,
              segment->command.motion.turn_rate / Q24_ONE * time, margin);
    jp_q16 energy;

    check(distance(&end, &pose) < TOLERANCE, "ends beside its waypoint, m", distance(&end, &pose));
    check(fabs(remainder(end.heading - pose.heading, 2 * M_PI)) < TOLERANCE, "heading at the end", end.heading);
    check(to->margin <= JP_WAYPOINTS_MARGIN_STEPS, "margin", to->margin);
    TEST_ASSERT_EQUAL_INT(JP_OK,
                          jp_energy_predict(config.model, &from->segment.command.motion, &segment->command, &energy));
    TEST_ASSERT_EQUAL_INT32(energy, segment->energy);
}

static void check_waypoints(void)
{
    check_order();
    for (size_t i = 1; i < waypoint_count; i++) {
        const struct clearance_pose from = pose_of(&waypoints[i - 1]);
        const struct clearance_pose to = pose_of(&waypoints[i]);

        check_limits(&waypoints[i].segment);
        check_chord(&from, &to);
        check_segment(&waypoints[i - 1], &waypoints[i]);
        check(i == 1 || i + 1 == waypoint_count || waypoints[i].margin >= choice.margin_min, "least margin",
              waypoints[i].margin);
    }
}

static void test_random_maps(void)
{
    unsigned long routes = 0;
    unsigned long choices = 0;
    unsigned long wide = 0;

    for (unsigned long i = 0; i < options.count; i++) {
        seed = options.seed + i;
        config.margin_min = seed % 2 == 0 ? 0 : MARGIN_MIN;
        random_init(&noise, seed);
        begin_map();
        scatter();
        if (plan()) {
            routes++;
            choose();
            if (waypoint_count > 0) {
                choices++;
                wide += choice.is_wide;
                check_waypoints();
            }
        }
        map_file_free(&map);
    }
    (void)printf("%lu maps from seed %llu: %lu routes, waypoints on %lu, beside %lu more\n", options.count,
                 options.seed, routes, choices - wide, wide);
    TEST_ASSERT_TRUE(routes >= options.count / 4);
    TEST_ASSERT_TRUE(choices >= routes * 3 / 4);
}

static struct jp_box box_at(const struct clearance_pose *pose, double clip)
{
    const double one = JP_CELLS_ONE;

    return (struct jp_box){(jp_cells_q20)lround(pose->x / CELL_M * one), (jp_cells_q20)lround(pose->y / CELL_M * one),
                           (jp_angle)(int64_t)llround(pose->heading / (2 * M_PI) * TURN),
                           (jp_cells_q20)lround((LENGTH_M / 2 - clip) / CELL_M * one),
                           (jp_cells_q20)lround((WIDTH_M / 2 - clip) / CELL_M * one)};
}

/* The rectangle touches a cell when a point of a fine cloud lies in it, but for corners finer than the cloud. */
static void test_clearance_at_a_pose(void)
{
    const struct clearance_robot exact = {LENGTH_M, WIDTH_M, 0};
    const struct clearance_robot smaller = {LENGTH_M, WIDTH_M, -0.02};
    unsigned clear = 0;

    random_init(&noise, 7);
    begin_map();
    for (int i = 0; i < 60; i++) {
        block(draw(WIDTH), draw(HEIGHT), 1 + draw(2), 1 + draw(2), JP_CELL_OCCUPIED);
    }
    for (int i = 0; i < 20000; i++) {
        const struct clearance_pose pose = {random_uniform(&noise, -1, WIDTH * CELL_M + 1),
                                            random_uniform(&noise, -1, HEIGHT * CELL_M + 1),
                                            random_uniform(&noise, -7, 7)};
        const bool cloud = cloud_is_free(pose.x, pose.y, pose.heading, 0);
        const struct jp_box tighter = box_at(&pose, ROUNDING_M);
        const struct jp_box wider = box_at(&pose, -ROUNDING_M);
        const bool box = clearance_at(&map.terrain, &exact, &pose);
        clear += box;
        check(!box || cloud, "clear, but a point is not, x", pose.x);
        check(!box || jp_box_is_clear(&map.terrain, &tighter), "clear, but not in integers, x", pose.x);
        check(box || !jp_box_is_clear(&map.terrain, &wider), "not clear, but in integers, x", pose.x);
        check(!cloud || clearance_at(&map.terrain, &smaller, &pose), "all points clear, but not a smaller box, x",
              pose.x);
    }
    check(clear > 5000 && clear < 18000, "poses that are clear", clear);
    map_file_free(&map);
}

static void lead(const struct jp_lattice_pose *cells, size_t cell_count)
{
    route_count = cell_count;
    memcpy(route, cells, cell_count * sizeof *cells);
}

static double predicted_energy(void)
{
    double sum = 0;

    for (size_t i = 1; i < waypoint_count; i++) {
        sum += waypoints[i].segment.energy / Q16_ONE;
    }
    return sum;
}

/* Few points are taken, and more than the ends only because speed in two steps takes less energy than in one. */
static void test_a_straight_run_takes_few_segments(void)
{
    struct jp_lattice_pose cells[40];

    begin_map();
    for (size_t i = 0; i < 40; i++) {
        cells[i] = (struct jp_lattice_pose){(int16_t)(5 + i), 20, 0};
    }
    lead((struct jp_lattice_pose[]){cells[0], cells[39]}, 2);
    choose();
    TEST_ASSERT_EQUAL_UINT(2, waypoint_count);
    const double direct = predicted_energy();
    lead(cells, 40);
    choose();
    TEST_ASSERT_TRUE(waypoint_count <= 4);
    TEST_ASSERT_TRUE(predicted_energy() < direct);
    check_waypoints();
    map_file_free(&map);
}

/* Round the end of a wall that both straight ways would cross. */
static void test_a_wall_takes_more_points(void)
{
    struct jp_lattice_pose cells[50];
    size_t n = 0;

    begin_map();
    block(20, 0, 2, 25, JP_CELL_OCCUPIED);
    for (int16_t i = 0; i < 15; i++) {
        cells[n++] = (struct jp_lattice_pose){(int16_t)(6 + i), (int16_t)(14 + i), 2};
    }
    for (int16_t i = 0; i < 15; i++) {
        cells[n++] = (struct jp_lattice_pose){(int16_t)(21 + i), (int16_t)(28 - i), 14};
    }
    lead(cells, n);
    choose();
    TEST_ASSERT_TRUE(waypoint_count >= 3);
    check_waypoints();
    map_file_free(&map);
}

/* On level ground the straight way is best; not so where it leads over a hill that the route goes round. */
static void test_no_short_cut_over_a_hill(void)
{
    static const double tops[] = {0, 2};
    double highest[2] = {0, 0};
    struct jp_lattice_pose cells[120];

    for (int run = 0; run < 2; run++) {
        size_t n = 0;
        begin_map_of(true);
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            const double square = pow(i % WIDTH - 30, 2) + pow(i / WIDTH - 10, 2);
            (void)jp_terrain_set_elevation(&map.terrain, i % WIDTH, i / WIDTH,
                                           (jp_elevation)lround(tops[run] * exp(-square / 70) * JP_ELEVATION_ONE));
        }
        for (int16_t i = 0; i <= 48; i++) {
            cells[n++] = (struct jp_lattice_pose){(int16_t)(6 + i), (int16_t)(10 + (i < 24 ? i : 48 - i)), 2};
        }
        lead(cells, n);
        choose();
        TEST_ASSERT_TRUE(waypoint_count > 1);
        for (size_t i = 1; i < waypoint_count; i++) {
            highest[run] = fmax(highest[run], pose_of(&waypoints[i]).y);
        }
        check_waypoints();
        map_file_free(&map);
    }
    check(highest[0] < 2.6, "level: straight, y", highest[0]);
    check(highest[1] > 4.0, "hill: round it, y", highest[1]);
}

/* Straight behind a robot that may turn by 80° at once: the rest must be an arc, for which the corridor is too narrow.
 */
static void test_no_room_to_turn_is_no_choice(void)
{
    const struct jp_lattice_pose cells[] = {{30, 20, 0}, {29, 20, 0}};

    begin_map();
    block(0, 0, WIDTH, 19, JP_CELL_OCCUPIED);
    block(0, 22, WIDTH, HEIGHT - 22, JP_CELL_OCCUPIED);
    lead(cells, 2);
    choose();
    TEST_ASSERT_EQUAL_UINT(0, waypoint_count);
    map_file_free(&map);
}

int main(int argc, char **argv)
{
    const struct robot_entry *entry = rig_find_robot("gao2018");

    if (entry == NULL) {
        return 2;
    }
    options = parse_options(argc, argv, options);
    config = (struct jp_waypoints_config){.terrain = &map.terrain,
                                          .lattice = &jp_lattice_gao2018,
                                          .model = entry->energy,
                                          .limits = &entry->config->limits,
                                          .length = JP_Q24(LENGTH_M),
                                          .width = JP_Q24(WIDTH_M),
                                          .reach = 96};
    return RUN_PROPERTY(options, NULL);
}
