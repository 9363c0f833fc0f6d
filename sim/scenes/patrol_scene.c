#include "sim/scenes/patrol_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/base/strict_math.h"
#include "sim/files/map_file.h"
#include "sim/scenes/patrol_draft.h"

#define GIVEN_LIMIT_S  600
#define RESOLUTION_MIN 0.02 /* m */
#define RESOLUTION_MAX 0.25

/* Degrees. */
enum { EAST = 0, NORTH = 90, TURN = 360 };

const char *const patrol_scene_names[PATROL_SCENES] = {
    [PATROL_BESIDE_OBSTACLE] = "beside-obstacle",
    [PATROL_L_PASSAGE] = "l-passage",
    [PATROL_CORRIDOR] = "corridor",
    [PATROL_DOORWAY] = "doorway",
    [PATROL_PEDESTRIAN] = "pedestrian",
    [PATROL_WAREHOUSE] = "warehouse",
    [PATROL_PEOPLE] = "people",
};

/* ---- Rooms ---- */

static void carve(struct patrol_draft *draft, const struct patrol_area *area)
{
    patrol_draft_fill(draft, PATROL_BOTH, area, JP_CELL_FREE);
}

static void build(struct patrol_draft *draft, int x, int y, int width, int height)
{
    patrol_draft_fill(draft, PATROL_BOTH, &(struct patrol_area){x, y, width, height}, JP_CELL_OCCUPIED);
}

static int draw_heading(struct patrol_draft *draft)
{
    return patrol_draft_between(draft, 0, TURN - 1);
}

/* Pillars of 0.2…0.5 m at the walls of a room, 1…3 m apart, and at most `standing` within it. */
static void add_pillars(struct patrol_draft *draft, const struct patrol_area *room, int standing)
{
    for (int x = room->x + patrol_draft_between(draft, 10, 50); x < room->x + room->width - 10;
         x += patrol_draft_between(draft, 20, 60)) {
        const int side = patrol_draft_between(draft, 4, 10);
        build(draft, x, patrol_draft_once_in(draft, 2) ? room->y : room->y + room->height - side, side, side);
    }
    for (int y = room->y + patrol_draft_between(draft, 10, 50); y < room->y + room->height - 10;
         y += patrol_draft_between(draft, 20, 60)) {
        const int side = patrol_draft_between(draft, 4, 10);
        build(draft, patrol_draft_once_in(draft, 2) ? room->x : room->x + room->width - side, y, side, side);
    }
    for (int i = patrol_draft_between(draft, 0, standing); i > 0; i--) {
        const int side = patrol_draft_between(draft, 5, 10);
        const int y = room->y + patrol_draft_between(draft, 0, room->height - side);
        const int x = room->x + patrol_draft_between(draft, 0, room->width - side);
        build(draft, x, y, side, side);
    }
}

/* A corridor with niches of 0.05…0.2 m in its walls, 0.3…0.8 m wide, 0.8…2 m apart. */
static void carve_corridor(struct patrol_draft *draft, const struct patrol_area *corridor)
{
    const bool lies_east = corridor->width > corridor->height;
    const int length = lies_east ? corridor->width : corridor->height;
    const int width = lies_east ? corridor->height : corridor->width;

    carve(draft, corridor);
    for (int at = patrol_draft_between(draft, 4, 16); at < length - 16; at += patrol_draft_between(draft, 16, 40)) {
        const int wide = patrol_draft_between(draft, 6, 16);
        const int depth = patrol_draft_between(draft, 1, 4);
        const int across = patrol_draft_once_in(draft, 2) ? -depth : width;
        const struct patrol_area niche =
            lies_east ? (struct patrol_area){corridor->x + at, corridor->y + across, wide, depth}
                      : (struct patrol_area){corridor->x + across, corridor->y + at, depth, wide};
        carve(draft, &niche);
    }
}

static struct jp_plane_pose draw_pose(struct patrol_draft *draft, const struct patrol_area *area, int heading)
{
    const double x = random_uniform(&draft->random, area->x, area->x + area->width);
    const double y = random_uniform(&draft->random, area->y, area->y + area->height);

    return patrol_draft_pose(draft, x, y, heading);
}

/* An area without its border. */
static struct patrol_area inner(const struct patrol_area *area, int border)
{
    return (struct patrol_area){area->x + border, area->y + border, area->width - 2 * border,
                                area->height - 2 * border};
}

static double distance(const struct jp_plane_pose *a, const struct jp_plane_pose *b)
{
    return strict_hypot((double)a->x - (double)b->x, (double)a->y - (double)b->y);
}

static int larger(int a, int b)
{
    return a > b ? a : b;
}

static int smaller(int a, int b)
{
    return a < b ? a : b;
}

/* Cells. */
enum {
    WALL = 6,          /* around every layout */
    START_BORDER = 13, /* from a wall to a start: the robot can turn */
    ASIDE = 24         /* of the mouth of a corridor */
};

/* ---- Goal beside an obstacle ---- */

/* From the robot's true shape at the goal, m. */
#define GAP_MIN 0.12
#define GAP_MAX 0.38

/* From the goal to what the map shows, m. */
#define ALONE_M 0.9

/* So soon that the robot is still far. */
#define APPEARS_MAX_S 1.0

static struct planar_shape draw_box(struct patrol_draft *draft)
{
    return (struct planar_shape){.kind = PLANAR_BOX,
                                 .half_length = random_uniform(&draft->random, 0.15, 0.4),
                                 .half_width = random_uniform(&draft->random, 0.15, 0.4)};
}

static struct planar_shape draw_disc(struct patrol_draft *draft)
{
    return (struct planar_shape){.kind = PLANAR_DISC, .radius = random_uniform(&draft->random, 0.12, 0.35)};
}

/* Ahead of the robot at the goal or beside it, its nearest face GAP_MIN…GAP_MAX away. */
static struct planar_pose place_beside(struct patrol_draft *draft, const struct planar_shape *shape)
{
    const bool is_disc = shape->kind == PLANAR_DISC;
    const double half_length = is_disc ? shape->radius : shape->half_length;
    const double half_width = is_disc ? shape->radius : shape->half_width;
    const double gap = random_uniform(&draft->random, GAP_MIN, GAP_MAX);
    const struct jp_plane_pose *goal = &draft->scene->goal;
    const struct planar_pose at = {(double)goal->x, (double)goal->y, (double)goal->heading};
    struct planar_pose offset = {0};

    if (patrol_draft_once_in(draft, 2)) {
        offset.x = PATROL_ROBOT_LENGTH_M / 2 + gap + half_length;
        offset.y = random_uniform(&draft->random, -0.3, 0.3);
    } else {
        offset.x = random_uniform(&draft->random, -0.2, 0.4);
        offset.y = patrol_draft_side(draft) * (PATROL_ROBOT_WIDTH_M / 2 + gap + half_width);
    }
    return planar_compose(&at, &offset);
}

static void put_beside_goal(struct patrol_draft *draft)
{
    const bool appears = patrol_draft_once_in(draft, 2);
    struct planar_shape shape = appears ? draw_disc(draft) : draw_box(draft);

    shape.pose = place_beside(draft, &shape);
    if (appears) {
        patrol_draft_add(draft, &(struct patrol_obstacle){.shape = shape,
                                                          .waypoints = {{shape.pose.x, shape.pose.y}},
                                                          .waypoint_count = 1,
                                                          .appears = random_uniform(&draft->random, 0, APPEARS_MAX_S)});
    } else {
        patrol_draft_hide(draft, &shape);
    }
}

static bool lay_out_beside_obstacle(struct patrol_draft *draft)
{
    const struct patrol_area room = {WALL, WALL, patrol_draft_between(draft, 150, 210),
                                     patrol_draft_between(draft, 120, 160)};
    const struct patrol_area middle = inner(&room, 20);

    patrol_draft_begin(draft, room.width + 2 * WALL, room.height + 2 * WALL);
    carve(draft, &room);
    add_pillars(draft, &room, 2);
    draft->scene->start = draw_pose(draft, &middle, draw_heading(draft));
    draft->scene->goal = draw_pose(draft, &middle, draw_heading(draft));
    const bool stands_alone = patrol_draft_has_room(draft, &draft->scene->goal, ALONE_M);
    put_beside_goal(draft);
    const double way = distance(&draft->scene->start, &draft->scene->goal);
    return stands_alone && way >= 3 && way <= 6;
}

/* ---- L-shaped passage ---- */

static bool lay_out_l_passage(struct patrol_draft *draft)
{
    const int width = patrol_draft_between(draft, 23, 30);
    const int first = patrol_draft_between(draft, 50, 100);
    const int second = patrol_draft_between(draft, 50, 100);
    const int bay = patrol_draft_between(draft, 34, 44);
    const int low = patrol_draft_between(draft, 0, bay - width);
    const bool opens = patrol_draft_once_in(draft, 2);
    const int far_bay = opens ? bay : 0;
    const struct patrol_area start = {WALL, WALL, bay, bay};
    const struct patrol_area east = {WALL + bay, WALL + low, first, width};
    const struct patrol_area north = {east.x + first - width, east.y, width, second};
    const struct patrol_area end = {north.x, north.y + second, far_bay, far_bay};
    const struct patrol_area start_middle = inner(&start, START_BORDER);
    const struct patrol_area end_middle = inner(&end, START_BORDER);
    const struct patrol_area last_part = {north.x + width / 2, end.y - 20, 1, 6};

    patrol_draft_begin(draft, north.x + (opens ? bay : width) + WALL, end.y + far_bay + WALL);
    carve_corridor(draft, &east);
    carve_corridor(draft, &north);
    carve(draft, &start);
    carve(draft, &end);
    draft->scene->start = draw_pose(draft, &start_middle, draw_heading(draft));
    draft->scene->goal = opens ? draw_pose(draft, &end_middle, draw_heading(draft))
                               : draw_pose(draft, &last_part, NORTH + patrol_draft_between(draft, -4, 4));
    return true;
}

/* ---- Narrow corridor ---- */

/* In the hall, to the side of the mouth where there is more room. */
static struct patrol_area across_from(const struct patrol_area *hall, const struct patrol_area *corridor)
{
    const int south = corridor->y - hall->y;
    const int north = hall->y + hall->height - corridor->y - corridor->height;
    const struct patrol_area side = {hall->x + START_BORDER,
                                     (south > north ? hall->y : corridor->y + corridor->height + ASIDE),
                                     hall->width - 2 * START_BORDER, (south > north ? south : north) - ASIDE};

    return south > north ? (struct patrol_area){side.x, side.y + START_BORDER, side.width, side.height - START_BORDER}
                         : (struct patrol_area){side.x, side.y, side.width, side.height - START_BORDER};
}

static bool lay_out_corridor(struct patrol_draft *draft)
{
    const struct patrol_area hall = {WALL, WALL, patrol_draft_between(draft, 60, 100),
                                     patrol_draft_between(draft, 110, 160)};
    const int width = patrol_draft_between(draft, 20, 26);
    const int at = patrol_draft_between(draft, 10, hall.height - width - 10);
    const struct patrol_area corridor = {hall.x + hall.width, hall.y + at, patrol_draft_between(draft, 60, 140), width};
    const bool opens = patrol_draft_once_in(draft, 2);
    const int side = opens ? patrol_draft_between(draft, 44, 70) : 0;
    const int lowest = larger(WALL, corridor.y + width - side);
    const struct patrol_area room = {corridor.x + corridor.width, patrol_draft_between(draft, lowest, corridor.y), side,
                                     side};
    const struct patrol_area start = across_from(&hall, &corridor);
    const struct patrol_area last_part = {room.x - 40, corridor.y + width / 2, 24, 1};
    const struct patrol_area room_middle = inner(&room, START_BORDER);

    patrol_draft_begin(draft, room.x + side + WALL, larger(room.y + side, hall.y + hall.height) + WALL);
    carve_corridor(draft, &corridor);
    carve(draft, &hall);
    add_pillars(draft, &hall, 1);
    carve(draft, &room);
    draft->scene->start = draw_pose(draft, &start, draw_heading(draft));
    draft->scene->goal =
        opens ? draw_pose(draft, &room_middle, draw_heading(draft)) : draw_pose(draft, &last_part, EAST);
    return true;
}

/* ---- Doorway ---- */

static bool lay_out_doorway(struct patrol_draft *draft)
{
    const struct patrol_area west = {WALL, WALL, patrol_draft_between(draft, 70, 110),
                                     patrol_draft_between(draft, 80, 120)};
    const int thickness = patrol_draft_between(draft, 3, 6);
    const struct patrol_area east = {west.x + west.width + thickness, WALL, patrol_draft_between(draft, 70, 110),
                                     patrol_draft_between(draft, 80, 120)};
    const int width = patrol_draft_between(draft, 18, 22);
    const int at = patrol_draft_between(draft, 8, smaller(west.height, east.height) - width - 8);
    const struct patrol_area door = {west.x + west.width, WALL + at, thickness, width};
    const struct patrol_area start = inner(&west, START_BORDER);
    const struct patrol_area goal = inner(&east, START_BORDER);

    patrol_draft_begin(draft, east.x + east.width + WALL, larger(west.height, east.height) + 2 * WALL);
    carve(draft, &west);
    carve(draft, &east);
    add_pillars(draft, &west, 2);
    add_pillars(draft, &east, 2);
    carve(draft, &door);
    draft->scene->start = draw_pose(draft, &start, draw_heading(draft));
    draft->scene->goal = draw_pose(draft, &goal, draw_heading(draft));
    return true;
}

/* ---- Crossing pedestrian ---- */

#define PEDESTRIAN_RADIUS 0.25 /* m */
#define PACE              0.8  /* of the robot towards the crossing, m/s */

/* Reaches the robot's path about when the robot does. */
static void add_pedestrian(struct patrol_draft *draft, const struct patrol_area *hall)
{
    const struct jp_plane_pose *start = &draft->scene->start;
    const double x = hall->x + random_uniform(&draft->random, 0.4, 0.6) * hall->width;
    const double slant = random_uniform(&draft->random, -20, 20);
    const struct jp_plane_pose from = patrol_draft_pose(draft, x - slant, hall->y + 16, NORTH);
    const struct jp_plane_pose to = patrol_draft_pose(draft, x + slant, hall->y + hall->height - 16, NORTH);
    const struct jp_plane_pose middle = patrol_draft_pose(draft, x, hall->y + hall->height / 2.0, NORTH);
    const double speed = random_uniform(&draft->random, 0.8, 1.3);
    const double late = random_uniform(&draft->random, -1.5, 1.5);
    const double starts = distance(start, &middle) / PACE - distance(&from, &middle) / speed + late;

    const struct walker person = {.from = {(double)from.x, (double)from.y},
                                  .to = {(double)to.x, (double)to.y},
                                  .radius = PEDESTRIAN_RADIUS,
                                  .speed = speed,
                                  .starts = fmax(starts, 0),
                                  .stays = !patrol_draft_once_in(draft, 3)};

    (void)patrol_draft_add_person(draft, &person);
}

static void lay_out_hall(struct patrol_draft *draft, struct patrol_area *hall)
{
    *hall =
        (struct patrol_area){WALL, WALL, patrol_draft_between(draft, 200, 250), patrol_draft_between(draft, 110, 150)};

    const struct patrol_area start = {hall->x + START_BORDER, hall->y + 30, 30, hall->height - 60};
    const struct patrol_area goal = {hall->x + hall->width - 30 - START_BORDER, start.y, 30, start.height};

    patrol_draft_begin(draft, hall->width + 2 * WALL, hall->height + 2 * WALL);
    carve(draft, hall);
    add_pillars(draft, hall, 3);
    draft->scene->start = draw_pose(draft, &start, draw_heading(draft));
    draft->scene->goal = draw_pose(draft, &goal, draw_heading(draft));
}

static bool lay_out_pedestrian(struct patrol_draft *draft)
{
    struct patrol_area hall;

    lay_out_hall(draft, &hall);
    add_pedestrian(draft, &hall);
    return true;
}

/* ---- People ---- */

enum { GROUPS_MAX = 4, GROUP_MAX = 3 };

#define ABREAST     0.6 /* m, of the middles of two who walk together */
#define BEHIND_MAX  0.3 /* by which one of them is behind the other, m */
#define WALK_MIN    3.0 /* m */
#define WALKER_SLOW 0.6 /* m/s */
#define WALKER_FAST 1.5
#define WALKING_MIN 1.5 /* between two stops, s */
#define WALKING_MAX 10.0
#define RESTING_MAX 5.0 /* s */

/* When somebody stops, for how long, and whether they go back then. */
static void draw_acts(struct patrol_draft *draft, struct walker *person)
{
    double time = person->starts;

    person->act_count = (size_t)patrol_draft_between(draft, 0, WALKER_ACTS_MAX);
    for (size_t i = 0; i < person->act_count; i++) {
        time += random_uniform(&draft->random, WALKING_MIN, WALKING_MAX);
        person->acts[i] = (struct walker_act){
            .time = time,
            .rest = patrol_draft_once_in(draft, 3) ? 0 : random_uniform(&draft->random, 0, RESTING_MAX),
            .turns = patrol_draft_once_in(draft, 2)};
        time += person->acts[i].rest;
    }
}

static struct planar_point draw_place(struct patrol_draft *draft, const struct patrol_area *area)
{
    const struct jp_plane_pose place = draw_pose(draft, area, 0);

    return (struct planar_point){(double)place.x, (double)place.y};
}

/* Those who walk together do the same, side by side. */
static void add_group(struct patrol_draft *draft, const struct walker *first, int size)
{
    const double length = strict_hypot(first->to.x - first->from.x, first->to.y - first->from.y);
    const struct planar_point along = {(first->to.x - first->from.x) / length, (first->to.y - first->from.y) / length};

    for (int i = 0; i < size; i++) {
        const double aside = ABREAST * i;
        const double behind = i > 0 ? random_uniform(&draft->random, 0, BEHIND_MAX) : 0;
        const struct planar_point shift = {-behind * along.x - aside * along.y, -behind * along.y + aside * along.x};
        struct walker person = *first;

        person.from = (struct planar_point){first->from.x + shift.x, first->from.y + shift.y};
        person.to = (struct planar_point){first->to.x + shift.x, first->to.y + shift.y};
        (void)patrol_draft_add_person(draft, &person);
    }
}

/* Between any two places of the hall. */
static bool draw_walk(struct patrol_draft *draft, const struct patrol_area *hall, struct walker *person)
{
    const struct patrol_area inside = inner(hall, 10);

    *person = (struct walker){.from = draw_place(draft, &inside),
                              .to = draw_place(draft, &inside),
                              .radius = PEDESTRIAN_RADIUS,
                              .speed = random_uniform(&draft->random, WALKER_SLOW, WALKER_FAST),
                              .stays = patrol_draft_once_in(draft, 4)};
    return strict_hypot(person->to.x - person->from.x, person->to.y - person->from.y) >= WALK_MIN;
}

static bool lay_out_people(struct patrol_draft *draft)
{
    struct patrol_area hall;

    lay_out_hall(draft, &hall);
    for (int i = patrol_draft_between(draft, 1, GROUPS_MAX); i > 0; i--) {
        struct walker person;

        while (!draw_walk(draft, &hall, &person)) {
        }
        draw_acts(draft, &person);
        add_group(draft, &person, patrol_draft_once_in(draft, 2) ? 1 : patrol_draft_between(draft, 2, GROUP_MAX));
    }
    return true;
}

/* ---- Warehouse ---- */

enum {
    HALL_WIDTH = 400,
    HALL_HEIGHT = 300,
    CROSS_AISLE = 48,
    AISLE_MIN = 38,
    AISLES_MAX = 8,
    PALLET = 24,     /* of 1.2 m */
    PASSAGE_MIN = 19 /* beside a pallet */
};

struct aisles {
    int count;
    int width;
    int x[AISLES_MAX]; /* of the western cells */
    int length;        /* of the racks in each of two parts */
    int y[2];          /* of their southern cells */
};

/* Racks that nobody has filled wholly: their faces are uneven. */
static void build_rack(struct patrol_draft *draft, const struct patrol_area *rack)
{
    build(draft, rack->x, rack->y, rack->width, rack->height);
    for (int y = rack->y + patrol_draft_between(draft, 5, 20); y < rack->y + rack->height - 20;
         y += patrol_draft_between(draft, 24, 50)) {
        const int depth = patrol_draft_between(draft, 2, 6);
        const struct patrol_area gap = {patrol_draft_once_in(draft, 2) ? rack->x : rack->x + rack->width - depth, y,
                                        depth, patrol_draft_between(draft, 8, 20)};
        carve(draft, &gap);
    }
}

static struct aisles build_racks(struct patrol_draft *draft)
{
    const int width = HALL_WIDTH - 2 * WALL;
    const int rack = patrol_draft_between(draft, 20, 26);
    const int pitch = rack + patrol_draft_between(draft, AISLE_MIN, AISLE_MIN + 8);
    const int middle = patrol_draft_once_in(draft, 2) ? CROSS_AISLE : 0;
    struct aisles aisles = {.count = (width + rack) / pitch,
                            .length = (HALL_HEIGHT - 2 * WALL - 2 * CROSS_AISLE - middle) / 2};

    aisles.width = (width + rack) / aisles.count - rack;
    aisles.y[0] = WALL + CROSS_AISLE;
    aisles.y[1] = aisles.y[0] + aisles.length + middle;
    for (int i = 0; i < aisles.count; i++) {
        aisles.x[i] = WALL + i * (aisles.width + rack);
        for (int part = 0; part < 2 && i > 0; part++) {
            build_rack(draft, &(struct patrol_area){aisles.x[i] - rack, aisles.y[part], rack, aisles.length});
        }
    }
    return aisles;
}

/* A pallet at one side of an aisle, or load across all of it. */
static void put_pallet(struct patrol_draft *draft, const struct aisles *aisles, int aisle, bool blocks)
{
    const int part = patrol_draft_between(draft, 0, 1);
    const int y = aisles->y[part] + patrol_draft_between(draft, 0, aisles->length - PALLET);
    const int passage = blocks ? 0 : patrol_draft_between(draft, PASSAGE_MIN, aisles->width / 2);
    const int x = aisles->x[aisle] + (patrol_draft_once_in(draft, 2) ? passage : 0);

    patrol_draft_fill(draft, PATROL_GROUND, &(struct patrol_area){x, y, aisles->width - passage, PALLET},
                      JP_CELL_OCCUPIED);
}

static bool lay_out_warehouse(struct patrol_draft *draft)
{
    patrol_draft_begin(draft, HALL_WIDTH, HALL_HEIGHT);
    carve(draft, &(struct patrol_area){WALL, WALL, HALL_WIDTH - 2 * WALL, HALL_HEIGHT - 2 * WALL});
    const struct aisles aisles = build_racks(draft);
    const int aisle = patrol_draft_between(draft, 0, aisles.count - 1);
    const int middle = aisles.x[aisle] + aisles.width / 2;
    const struct patrol_area start = {middle - 20, WALL + START_BORDER, 40, CROSS_AISLE - 2 * START_BORDER};
    const struct patrol_area goal = {middle - 4, HALL_HEIGHT - start.y - start.height, 8, start.height};

    put_pallet(draft, &aisles, aisle, patrol_draft_once_in(draft, 2));
    for (int other = 0; other < aisles.count; other++) {
        if (other != aisle && patrol_draft_once_in(draft, 3)) {
            put_pallet(draft, &aisles, other, patrol_draft_once_in(draft, 3));
        }
    }
    draft->scene->start = draw_pose(draft, &start, draw_heading(draft));
    draft->scene->goal = draw_pose(draft, &goal, draw_heading(draft));
    return true;
}

/* ---- Scenes ---- */

/* How each kind is laid out; false: not as wanted, to be done again. */
static const struct {
    bool (*lay_out)(struct patrol_draft *draft);
    double limit_s;
} kinds[PATROL_SCENES] = {
    [PATROL_BESIDE_OBSTACLE] = {lay_out_beside_obstacle, 90},
    [PATROL_L_PASSAGE] = {lay_out_l_passage, 90},
    [PATROL_CORRIDOR] = {lay_out_corridor, 120},
    [PATROL_DOORWAY] = {lay_out_doorway, 120},
    [PATROL_PEDESTRIAN] = {lay_out_pedestrian, 120},
    [PATROL_WAREHOUSE] = {lay_out_warehouse, 300},
    [PATROL_PEOPLE] = {lay_out_people, 300},
};

/* Of its own for each kind and seed. */
static uint64_t stream_of(enum patrol_scene_kind kind, uint64_t seed)
{
    return kind < PATROL_PEOPLE ? seed * PATROL_PEOPLE + kind : ~seed;
}

void patrol_scene_make(enum patrol_scene_kind kind, uint64_t seed, struct patrol_scene *scene)
{
    struct patrol_draft draft = {.scene = scene};

    *scene = (struct patrol_scene){.kind = kind, .seed = seed, .limit_s = kinds[kind].limit_s};
    (void)snprintf(scene->name, sizeof scene->name, "%s", patrol_scene_names[kind]);
    random_init(&draft.random, stream_of(kind, seed));
    while (!kinds[kind].lay_out(&draft) || !patrol_draft_is_sound(&draft)) {
    }
}

void patrol_scene_free(struct patrol_scene *scene)
{
    free(scene->block);
    free(scene->ground_block);
    scene->block = NULL;
    scene->ground_block = NULL;
}

bool patrol_scene_enter(const struct patrol_scene *scene, const struct four_wheel_file *robot,
                        struct patrol_world *world)
{
    const struct planar_pose start = {(double)scene->start.x, (double)scene->start.y, (double)scene->start.heading};

    if (!patrol_world_init(world, &scene->ground, robot->body.length_m, robot->body.width_m, &start)) {
        return false;
    }
    for (size_t i = 0; i < scene->mover_count; i++) {
        (void)patrol_world_add(world, &scene->movers[i]);
    }
    for (size_t i = 0; i < scene->people_count; i++) {
        (void)patrol_world_add_person(world, &scene->people[i]);
    }
    world->deceleration = robot->drive.acceleration_m_s2;
    return true;
}

/* ---- Maps of others ---- */

static bool has_fitting_cells(const char *path, const struct map_file *map)
{
    const double cell = (double)map->terrain.config.resolution / JP_Q16_ONE;

    if (cell >= RESOLUTION_MIN && cell <= RESOLUTION_MAX) {
        return true;
    }
    error_line("%s: cells of %.4g m are not in %.4g…%.4g m; import the map again with "
               "python -m tools.design.import_map … --resolution 0.05",
               path, cell, RESOLUTION_MIN, RESOLUTION_MAX);
    return false;
}

bool patrol_scene_part_ground(struct patrol_scene *scene)
{
    const struct jp_terrain_config *config = &scene->map.config;
    const size_t size = jp_terrain_size(config);
    const char *field;

    scene->ground_block = malloc(size);
    if (scene->ground_block == NULL ||
        jp_terrain_init(&scene->ground, config, scene->ground_block, size, &field) != JP_OK) {
        return false;
    }
    for (int32_t y = 0; y < config->height; y++) {
        for (int32_t x = 0; x < config->width; x++) {
            (void)jp_terrain_set_cell(&scene->ground, x, y, jp_terrain_cell(&scene->map, x, y));
        }
    }
    return true;
}

struct jp_plane_pose patrol_scene_place(const struct patrol_scene *scene, const struct planar_pose *place)
{
    const struct planar_pose pose = planar_between(&scene->corner, place);

    return (struct jp_plane_pose){(float)pose.x, (float)pose.y, (float)pose.heading};
}

bool patrol_scene_load(const char *path, const struct planar_pose *start, const struct planar_pose *goal,
                       struct patrol_scene *scene)
{
    struct map_file map;

    if (!map_file_load(path, &map)) {
        return false;
    }
    if (!has_fitting_cells(path, &map)) {
        map_file_free(&map);
        return false;
    }
    *scene = (struct patrol_scene){.kind = PATROL_SCENES,
                                   .map = map.terrain,
                                   .ground = map.terrain,
                                   .corner = {map.origin[0], map.origin[1], map.origin[2]},
                                   .limit_s = GIVEN_LIMIT_S,
                                   .block = map.block};
    scene->start = patrol_scene_place(scene, start);
    scene->goal = patrol_scene_place(scene, goal);
    (void)snprintf(scene->name, sizeof scene->name, "%s", map.name);
    return true;
}
