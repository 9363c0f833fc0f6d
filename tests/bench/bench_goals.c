/* The patrol robot on maps of others, to random goals among boxes that the map does not show: how many of the goals
 * that can be reached it reaches, what it touches, and what it says of the others. Prints figures as JSON, drives that
 * do not end as they should on stderr; maps (tools/design/import_map.py) are the arguments.
 *
 * The rule, by the seed of a drive: boxes of 0.3 to 0.8 m at random places and headings, one for each 30 m² of free
 * ground. Start and goal are drawn from the places where the robot can turn with 5 cm to spare on the ground with its
 * boxes. A goal can be reached when a disc 0.2 m wider than the robot gets from the start to it.
 *
 * bench_goals [--seed FIRST] [--count N] MAP.json… */
#include <argp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/command_line.h"
#include "sim/base/parallel.h"
#include "sim/base/random.h"
#include "sim/missions/patrol_mission.h"
#include "tests/bench/figures.h"

#define COMMAND    "make bench-goals"
#define ROBOT_PATH "sim/robots/patrol.cfg"

#define BOX_MIN           0.3 /* m */
#define BOX_MAX           0.8
#define BOX_GROUND        30.0 /* m² */
#define TURN_SPARE        0.05 /* m */
#define WAY_SPARE         0.1
#define SECONDS_MIN       120.0 /* and so many for each metre between start and goal */
#define SECONDS_PER_METRE 10.0

enum { MAPS_MAX = 16, DRIVES_MAX = 1000, TRIES_MAX = 100000 };

static struct options {
    uint64_t seed;
    size_t count;
    const char *maps[MAPS_MAX];
    size_t map_count;
} options = {.seed = 1101, .count = 200};

struct run {
    bool is_reachable;
    struct patrol_result result;
};

struct campaign {
    struct four_wheel_file robot;
    char names[MAPS_MAX][PATROL_SCENE_NAME_SIZE];
    struct run runs[MAPS_MAX][DRIVES_MAX];
};

/* ---- The ground ---- */

struct ground {
    struct jp_terrain *terrain;
    int width;
    int height;
    double cell;
    float *away; /* of each cell's middle from what is solid, m */
    int *queue;
    bool *is_reached;
};

static bool is_solid(const struct ground *ground, int x, int y)
{
    return x < 0 || y < 0 || x >= ground->width || y >= ground->height ||
           jp_terrain_cell(ground->terrain, x, y) != JP_CELL_FREE;
}

static void hide_box(struct ground *ground, struct random *random)
{
    const double half_length = random_uniform(random, BOX_MIN, BOX_MAX) / 2;
    const double half_width = random_uniform(random, BOX_MIN, BOX_MAX) / 2;
    const double heading = random_uniform(random, -M_PI, M_PI);
    const double x = random_uniform(random, 0, ground->width * ground->cell);
    const double y = random_uniform(random, 0, ground->height * ground->cell);
    const int reach = (int)(BOX_MAX / ground->cell) + 1;

    for (int v = (int)(y / ground->cell) - reach; v <= (int)(y / ground->cell) + reach; v++) {
        for (int u = (int)(x / ground->cell) - reach; u <= (int)(x / ground->cell) + reach; u++) {
            const double dx = (u + 0.5) * ground->cell - x;
            const double dy = (v + 0.5) * ground->cell - y;

            if (fabs(cos(heading) * dx + sin(heading) * dy) <= half_length &&
                fabs(cos(heading) * dy - sin(heading) * dx) <= half_width) {
                (void)jp_terrain_set_cell(ground->terrain, u, v, JP_CELL_OCCUPIED); /* off the map nothing is set */
            }
        }
    }
}

static void hide_boxes(struct ground *ground, struct random *random)
{
    double free = 0;

    for (int i = 0; i < ground->width * ground->height; i++) {
        free += !is_solid(ground, i % ground->width, i / ground->width);
    }
    for (double left = free * ground->cell * ground->cell; left > BOX_GROUND; left -= BOX_GROUND) {
        hide_box(ground, random);
    }
}

/* Up to some cells; what is farther counts as that. */
static void measure(struct ground *ground, int most)
{
    for (int i = 0; i < ground->width * ground->height; i++) {
        const int x = i % ground->width;
        const int y = i / ground->width;
        double least = most;

        for (int dy = -most; dy <= most; dy++) {
            for (int dx = 0; dx <= most && hypot(fmax(dx - 0.5, 0), fmax(abs(dy) - 0.5, 0)) < least; dx++) {
                if (is_solid(ground, x + dx, y + dy) || is_solid(ground, x - dx, y + dy)) {
                    least = hypot(fmax(dx - 0.5, 0), fmax(abs(dy) - 0.5, 0));
                }
            }
        }
        ground->away[i] = (float)(least * ground->cell);
    }
}

/* All cells that a disc gets to from one, over their sides. */
static void flood(struct ground *ground, int from, double radius)
{
    static const int steps[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    int head = 0;
    int tail = 0;

    memset(ground->is_reached, 0, (size_t)ground->width * (size_t)ground->height * sizeof *ground->is_reached);
    ground->is_reached[from] = true;
    ground->queue[tail++] = from;
    while (head < tail) {
        const int at = ground->queue[head++];

        for (int i = 0; i < 4; i++) {
            const int x = at % ground->width + steps[i][0];
            const int y = at / ground->width + steps[i][1];
            const int next = y * ground->width + x;

            if (!is_solid(ground, x, y) && !ground->is_reached[next] && (double)ground->away[next] >= radius) {
                ground->is_reached[next] = true;
                ground->queue[tail++] = next;
            }
        }
    }
}

/* ---- A task ---- */

/* A cell where the robot can turn; −1: none was found. */
static int draw_place(const struct ground *ground, struct random *random, double radius)
{
    for (int i = 0; i < TRIES_MAX; i++) {
        const int cell = (int)random_uniform(random, 0, (double)ground->width * ground->height);

        if ((double)ground->away[cell] >= radius) {
            return cell;
        }
    }
    return -1;
}

static struct jp_plane_pose pose_in(const struct ground *ground, int cell, struct random *random)
{
    return (struct jp_plane_pose){(float)((cell % ground->width + 0.5) * ground->cell),
                                  (float)((cell / ground->width + 0.5) * ground->cell),
                                  (float)random_uniform(random, -M_PI, M_PI)};
}

static void *allocate(size_t size)
{
    void *const memory = malloc(size);

    if (memory == NULL) {
        abort();
    }
    return memory;
}

/* The ground becomes a copy of the map, with boxes. False: there is no room for start and goal. */
static bool make_task(const struct four_wheel_file *robot, struct patrol_scene *scene, void *copy, uint64_t seed,
                      bool *is_reachable)
{
    const size_t cells = (size_t)scene->map.config.width * scene->map.config.height;
    struct ground ground = {.terrain = &scene->ground,
                            .width = scene->map.config.width,
                            .height = scene->map.config.height,
                            .cell = (double)scene->map.config.resolution / JP_Q16_ONE,
                            .away = allocate(cells * sizeof(float)),
                            .queue = allocate(cells * sizeof(int)),
                            .is_reached = allocate(cells * sizeof(bool))};
    const double turn = hypot(robot->body.length_m, robot->body.width_m) / 2 + TURN_SPARE;
    const char *field;
    struct random random;

    random_init(&random, seed);
    if (jp_terrain_init(&scene->ground, &scene->map.config, copy, jp_terrain_size(&scene->map.config), &field) !=
        JP_OK) {
        abort();
    }
    for (size_t i = 0; i < cells; i++) {
        const int32_t x = (int32_t)i % ground.width;
        const int32_t y = (int32_t)i / ground.width;

        (void)jp_terrain_set_cell(&scene->ground, x, y, jp_terrain_cell(&scene->map, x, y));
    }
    hide_boxes(&ground, &random);
    measure(&ground, (int)(turn / ground.cell) + 2);

    const int start = draw_place(&ground, &random, turn);
    const int goal = draw_place(&ground, &random, turn);

    if (start >= 0 && goal >= 0) {
        flood(&ground, start, robot->body.width_m / 2 + WAY_SPARE);
        *is_reachable = ground.is_reached[goal];
        scene->start = pose_in(&ground, start, &random);
        scene->goal = pose_in(&ground, goal, &random);
    }
    free(ground.away);
    free(ground.queue);
    free(ground.is_reached);
    return start >= 0 && goal >= 0;
}

static void drive_index(void *context, size_t index)
{
    static const struct planar_pose nowhere;
    struct campaign *const campaign = context;
    const size_t map = index % options.map_count;
    const uint64_t seed = options.seed + index / options.map_count;
    struct run *const run = &campaign->runs[map][index / options.map_count];
    struct patrol_scene scene;

    if (!patrol_scene_load(options.maps[map], &nowhere, &nowhere, &scene)) {
        exit(ERROR_EXIT);
    }

    void *const copy = allocate(jp_terrain_size(&scene.map.config));
    const struct patrol_task task = {
        .robot = &campaign->robot, .scene = &scene, .method = PATROL_IMPROVED, .seed = seed, .faults = {.jump_at = -1}};

    memcpy(campaign->names[map], scene.name, sizeof scene.name);
    if (!make_task(&campaign->robot, &scene, copy, seed, &run->is_reachable)) {
        error_line("%s: no room for a start and a goal", options.maps[map]);
        exit(ERROR_EXIT);
    }
    scene.limit_s = SECONDS_MIN + SECONDS_PER_METRE * hypot((double)(scene.goal.x - scene.start.x),
                                                            (double)(scene.goal.y - scene.start.y));
    if (!patrol_mission_run(&task, &run->result)) {
        abort();
    }
    patrol_scene_free(&scene);
    free(copy);
}

/* ---- What came of them ---- */

static void print_bad(const char *map, uint64_t seed, const struct run *run)
{
    const struct patrol_result *const result = &run->result;

    if (result->outcome == PATROL_COLLIDED || (run->is_reachable && result->outcome != PATROL_ARRIVED)) {
        (void)fprintf(stderr, "%s, seed %lu%s: %s %s after %.1f s, %.1f m from the goal, %u replans\n", map,
                      (unsigned long)seed, run->is_reachable ? "" : ", out of reach",
                      patrol_outcome_names[result->outcome], patrol_reason_names[result->reason], result->time,
                      result->position_error, result->replans);
    }
}

static void add_map(json_t *figures, const struct campaign *campaign, size_t map)
{
    const char *const name = campaign->names[map];
    double reachable = 0;
    double missed = 0;
    double touched = 0;
    double position = 0;
    double heading = 0;

    for (size_t i = 0; i < options.count; i++) {
        const struct run *const run = &campaign->runs[map][i];
        const bool has_arrived = run->result.outcome == PATROL_ARRIVED;

        print_bad(name, options.seed + i, run);
        reachable += run->is_reachable;
        missed += run->is_reachable && !has_arrived;
        touched += run->result.outcome == PATROL_COLLIDED;
        position = has_arrived ? fmax(position, run->result.position_error) : position;
        heading = has_arrived ? fmax(heading, run->result.heading_error) : heading;
    }
    figures_add(figures, COMMAND, reachable, "", no_bar,
                "patrol robot, %s with hidden boxes, %zu goals: can be reached", name, options.count);
    figures_add(figures, COMMAND, missed, "", equal_to(0),
                "patrol robot, %s with hidden boxes, %zu goals: can be reached and were not", name, options.count);
    figures_add(figures, COMMAND, touched, "", equal_to(0),
                "patrol robot, %s with hidden boxes, %zu goals: touched something", name, options.count);
    figures_add(figures, COMMAND, position, "m", no_bar,
                "patrol robot, %s with hidden boxes, %zu goals: error at the goal, worst", name, options.count);
    figures_add(figures, COMMAND, heading * 180 / M_PI, "°", no_bar,
                "patrol robot, %s with hidden boxes, %zu goals: error of the heading at the goal, worst", name,
                options.count);
}

/* ---- Program ---- */

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    char *end;

    if (key == ARGP_KEY_ARG && options.map_count < MAPS_MAX) {
        options.maps[options.map_count++] = argument;
        return 0;
    }
    if (key == ARGP_KEY_END && options.map_count == 0) {
        argp_error(state, "no map is given");
    }
    if (key != 's' && key != 'n') {
        return ARGP_ERR_UNKNOWN;
    }
    const unsigned long value = strtoul(argument, &end, 10);

    if (*end != '\0' || (key == 'n' && (value < 1 || value > DRIVES_MAX))) {
        argp_error(state, "%s: no number of its range", argument);
    }
    if (key == 's') {
        options.seed = value;
    } else {
        options.count = value;
    }
    return 0;
}

int main(int argc, char **argv)
{
    static const struct argp_option known[] = {
        {"seed", 's', "FIRST", 0, "first seed", 0}, {"count", 'n', "N", 0, "goals a map, at most 1000", 0}, {0}};
    static const struct argp parser = {
        known, parse_option, "MAP.json...", "Drives the patrol robot to random goals on maps of others.",
        NULL,  NULL,         NULL};
    static struct campaign campaign;
    json_t *figures = json_array();

    argp_err_exit_status = ERROR_EXIT;
    (void)argp_parse(&parser, argc, argv, 0, NULL, NULL);
    if (!four_wheel_file_load(ROBOT_PATH, &campaign.robot)) {
        return ERROR_EXIT;
    }
    in_parallel("random goals", drive_index, &campaign, options.count * options.map_count);
    for (size_t map = 0; map < options.map_count; map++) {
        add_map(figures, &campaign, map);
    }
    figures_print(figures);
    return 0;
}
