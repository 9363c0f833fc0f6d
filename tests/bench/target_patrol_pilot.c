/** Instructions of one jp_patrol_pilot_work(), the worst over drives in a room of 10 m × 8 m in cells of 5 cm: to goals
 * by prices, among people who walk, round boxes that the map does not show, and lost; of slices with a cycle of the
 * patrol, and of those without. */
#include <joulepath/patrol_pilot.h>
#include <joulepath/tables.h>

#include "tests/bench/target_room.h"
#include "tests/support/patrol_room.h"
#include "tests/target/cycles.h"
#include "tests/target/target.h"

#define CELL          0.05f  /* m */
#define STEP          0.05f  /* of a ray, m */
#define RANGE         8.0f   /* m */
#define PERSON_RADIUS 0.25f  /* m */
#define PERSON_SPEED  0.008f /* m in a tick */

enum { BLOCK = 500 * 1024, SCAN_TICKS = 10, PEOPLE = 2, GOALS = 3, SETTLING_TICKS = 30, TICKS = 2500 };

static uint64_t block[BLOCK / 8];
static struct patrol_room room; /* of it the robot's pose and drives alone */
static struct jp_four_wheel_robot robot;
static struct jp_patrol_pilot pilot;
static struct jp_plane_point people[PEOPLE];
static bool has_people;
static bool has_boxes;
static uint32_t ticks;

static const struct jp_plane_pose places[GOALS + 1] = {
    {1.0f, 1.0f, 0.0f}, {9.0f, 7.0f, 1.57f}, {4.8f, 1.2f, 3.14f}, {1.2f, 7.0f, -1.57f}};

/** Of jp_patrol_pilot_work(). */
struct slices {
    uint32_t count;
    uint32_t worst;
};

static struct slices with_cycle;
static struct slices between;

/* ---- The room ---- */

/* Beside and in the way of where the map says that it leads. */
static bool is_in_box(float x, float y)
{
    return has_boxes &&
           ((x > 2.8f && x < 3.3f && y > 1.6f && y < 4.2f) || (x > 6.0f && x < 6.9f && y > 1.4f && y < 1.9f));
}

static bool is_solid(float x, float y)
{
    return jp_terrain_cell(&target_map, (int32_t)(x * (1.0f / CELL)), (int32_t)(y * (1.0f / CELL))) ==
               JP_CELL_OCCUPIED ||
           is_in_box(x, y);
}

static bool is_in_person(float x, float y)
{
    bool is_in = false;

    for (int i = 0; i < (int)PEOPLE && has_people; i++) {
        const float dx = x - people[i].x;
        const float dy = y - people[i].y;

        is_in = is_in || dx * dx + dy * dy < PERSON_RADIUS * PERSON_RADIUS;
    }
    return is_in;
}

static float ray(struct jp_plane_point along)
{
    float way = 0.3f;

    while (way < RANGE) {
        const float x = room.pose.x + way * along.x;
        const float y = room.pose.y + way * along.y;

        if (is_solid(x, y) || is_in_person(x, y)) {
            return way;
        }
        way += STEP;
    }
    return 0.0f;
}

static void scan(void)
{
    const struct jp_patrol_scanner *const scanner = &jp_patrol_scanner_patrol;

    for (uint16_t i = 0; i < scanner->beams; i++) {
        room.ranges[i] =
            ray(jp_plane_direction(room.pose.heading + scanner->first_angle + (float)i * scanner->angle_step));
    }
}

/* To and fro across the room, each on a line. */
static void walk(void)
{
    for (int i = 0; i < (int)PEOPLE; i++) {
        const uint32_t phase = (ticks + 300U * (uint32_t)i) % 1200U;
        const uint32_t way = phase < 600U ? phase : 1200U - phase;

        people[i] = (struct jp_plane_point){2.5f + 4.5f * (float)i, 1.5f + PERSON_SPEED * (float)way};
    }
}

/* ---- Ticks ---- */

static void work(void *unused)
{
    (void)unused;
    jp_patrol_pilot_work(&pilot);
}

static void note(struct slices *slices, uint32_t instructions)
{
    slices->count++;
    slices->worst = instructions > slices->worst ? instructions : slices->worst;
}

static void tick(void)
{
    const uint32_t cycles = pilot.mission.patrol.counts.cycles;

    jp_four_wheel_robot_control(&robot, JP_OK, &room.sensors, &room.actuation);
    jp_four_wheel_robot_account(&robot);
    walk();
    if (ticks % SCAN_TICKS == 0U) {
        scan();
        jp_patrol_pilot_see(&pilot, room.ranges, &jp_four_wheel_robot_shown(&robot)->odometry);
    }

    const uint32_t instructions = target_count_once(work, NULL);

    note(pilot.mission.patrol.counts.cycles != cycles ? &with_cycle : &between, instructions);
    patrol_room_tick(&room, &jp_four_wheel_robot_patrol);
    ticks++;
}

/* ---- Drives ---- */

/* At a place, which it takes for another one. */
static bool start(const struct jp_plane_pose *at, const struct jp_plane_pose *believed)
{
    static const struct jp_patrol_pilot_config config = {.patrol = &jp_patrol_config_patrol,
                                                         .localiser = &jp_localiser_config_patrol,
                                                         .scanner = &jp_patrol_scanner_patrol,
                                                         .energy = &jp_four_wheel_energy_patrol,
                                                         .learning = &jp_four_wheel_learning_patrol,
                                                         .points_max = 1024,
                                                         .turns_max = 128};
    const char *field;
    bool is_ready;

    patrol_room_start(&room, at);
    is_ready = jp_four_wheel_robot_init(&robot, &jp_four_wheel_robot_patrol, &field) == JP_OK &&
               jp_patrol_pilot_init(&pilot, &config, &robot, &field) == JP_OK &&
               jp_patrol_pilot_take_map(&pilot, &target_map, believed, block, sizeof block, &field) == JP_OK;
    if (is_ready) {
        tick();
        is_ready = jp_four_wheel_robot_enable(&robot) == JP_OK;
    }
    for (unsigned i = 0; i < (unsigned)SETTLING_TICKS && is_ready; i++) {
        tick();
    }
    return is_ready;
}

static bool go(const struct jp_plane_pose *goal)
{
    const uint32_t end = ticks + TICKS;
    bool has_goal = jp_patrol_pilot_go(&pilot, goal) == JP_OK;

    while (has_goal && jp_patrol_pilot_is_under_way(&pilot) && ticks < end) {
        tick();
    }
    return has_goal;
}

static bool drive_round(void)
{
    bool has_gone = start(&places[0], &places[0]);

    for (int i = 1; i <= (int)GOALS && has_gone; i++) {
        has_gone = go(&places[i]);
    }
    return has_gone;
}

static void print_figure(const char *name, const struct slices *slices)
{
    target_print("{\"name\": \"" TARGET_CORE ": ");
    target_print(name);
    target_print(", worst of ");
    target_print_number(slices->count);
    target_print("\", \"value\": ");
    target_print_number(slices->worst);
    target_print(", \"unit\": \"instructions\", \"bound\": {\"op\": \"<=\", \"value\": 3000000}, \"command\": \"make "
                 "figures\"}");
}

int main(void)
{
    static const struct jp_plane_pose elsewhere = {5.0f, 5.0f, 1.0f};
    bool is_done = target_room_make(50) == JP_OK && drive_round();

    has_people = true;
    has_boxes = true;
    is_done = is_done && drive_round() && start(&places[0], &elsewhere) && go(&places[1]);
    if (!is_done) {
        target_print("a drive of the bench does not begin\n");
        return 1;
    }
    target_print("[\n");
    print_figure("patrol pilot, slice with a cycle", &with_cycle);
    target_print(",\n");
    print_figure("patrol pilot, slice between cycles", &between);
    target_print("\n]\n");
    return 0;
}
