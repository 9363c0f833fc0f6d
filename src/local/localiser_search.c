#include "src/local/localiser_search.h"

#include <string.h>

#include "src/base/plane.h"
#include "src/local/localiser_match.h"
#include "src/local/patrol_marks.h"
#include "src/local/wall_field.h"

/* Levels of the tree; its smallest squares have sides of so many cells, its smallest sectors are so many to a turn. */
#define LEVELS   3
#define SIDE     2
#define SECTORS  512
#define CHILDREN 8

/* The cell of an end says its distance to half of the cell's diagonal, and ranges have noise, cells. */
#define BLUR 1.0f

/* Share of the ends that a place explains, at least, and by how much a second one must be worse. The map is searched
 * for places that explain nearly all at first, which few nodes may, then for lesser ones. */
#define SCORE_FIRST  0.9f
#define SCORE_STEP   0.15f
#define SCORE_MIN    0.6f
#define SCORE_MARGIN 0.1f

/* Likewise in a part of the map, where less may be mistaken for it. */
#define SCORE_MIN_NEAR 0.45f

/* A closer look at where a place may be is the work of so many nodes. */
#define CLOSER 100U

/* Places nearer to each other than this, m and rad, are one; a smallest node nearer to one leads to it. */
#define APART      0.5f
#define APART_TURN 0.35f
#define LEADS      0.3f
#define LEADS_TURN 0.1f

/* ---- Nodes ---- */

/* Sides of the smallest squares in a square of this level. */
static int32_t width_of(int32_t level)
{
    return 1 << (LEVELS - 1 - level);
}

/* The pose in the middle, and how far an end is from there at most: `still` and `turning` times its range. */
struct node_middle {
    struct jp_plane_pose pose;
    float still;
    float turning;
};

static void find_middle(const struct jp_wall_field *field, const struct jp_localiser_node *node,
                        struct node_middle *middle)
{
    const float half = 0.5f * (float)width_of(node->level);
    const float side = field->cell * (float)SIDE;
    const float step = 2.0f * JP_PLANE_PI / (float)SECTORS;

    middle->pose = (struct jp_plane_pose){side * ((float)node->x + half), side * ((float)node->y + half),
                                          step * ((float)node->heading + half) - JP_PLANE_PI};
    middle->still = 1.41421356f * side * half + BLUR * field->cell;
    middle->turning = step * half;
}

/* Whether at least `least` of the ends may be at walls. */
static bool may_explain(const struct jp_localiser_search *search, const struct jp_wall_field *field,
                        const struct node_middle *middle, int32_t least)
{
    const struct jp_plane_point direction = jp_plane_direction(middle->pose.heading);
    int32_t misses_left = search->cloud.count - least;

    for (int32_t i = 0; i < search->cloud.count && misses_left >= 0; i++) {
        const struct jp_plane_point point = search->cloud.points[i];
        const struct jp_plane_point end = {middle->pose.x + direction.x * point.x - direction.y * point.y,
                                           middle->pose.y + direction.y * point.x + direction.x * point.y};
        const float allowed = middle->still + middle->turning * search->ranges[i];

        if (jp_wall_field_near(field, end) > allowed) {
            misses_left--;
        }
    }
    return misses_left >= 0;
}

static bool has_free_cell(const struct jp_terrain *map, const struct jp_localiser_node *node)
{
    const int32_t cells = SIDE * width_of(node->level);

    for (int32_t y = SIDE * node->y; y < SIDE * node->y + cells; y++) {
        for (int32_t x = SIDE * node->x; x < SIDE * node->x + cells; x++) {
            if (jp_terrain_cell(map, x, y) == JP_CELL_FREE) {
                return true;
            }
        }
    }
    return false;
}

static void push(struct jp_localiser_search *search, const struct jp_localiser_node *node)
{
    search->nodes[search->node_count] = *node;
    search->node_count++;
}

static void push_children(struct jp_localiser_search *search, const struct jp_localiser_node *node)
{
    const int32_t width = width_of(node->level + 1);

    for (int32_t i = 0; i < CHILDREN; i++) {
        const struct jp_localiser_node child = {.x = (int16_t)(node->x + (i % 2) * width),
                                                .y = (int16_t)(node->y + (i / 2 % 2) * width),
                                                .heading = (int16_t)(node->heading + i / 4 * width),
                                                .level = (int16_t)(node->level + 1)};

        push(search, &child);
    }
}

/* ---- Places ---- */

static float score_of(const struct jp_wall_field *field, const struct jp_localiser_cloud *cloud,
                      const struct jp_plane_pose *pose, float noise)
{
    struct jp_localiser_view view;

    jp_localiser_compare(field, cloud, 1, pose, noise, &view);
    return ((float)view.explained - (float)view.behind - (float)view.beyond) / (float)view.beams;
}

static bool are_near(const struct jp_plane_pose *a, const struct jp_plane_pose *b, float distance, float turn)
{
    return jp_plane_length(a->x - b->x, a->y - b->y) < distance &&
           jp_plane_magnitude(jp_plane_wrap(a->heading - b->heading)) < turn;
}

/* Whether a node leads to a place that is kept. */
static bool is_known(const struct jp_localiser_search *search, const struct jp_plane_pose *pose)
{
    bool is_near = false;

    for (int i = 0; i < JP_LOCALISER_PLACES; i++) {
        is_near =
            is_near || (search->places[i].score > 0.0f && are_near(&search->places[i].pose, pose, LEADS, LEADS_TURN));
    }
    return is_near;
}

bool jp_localiser_search_is_same(const struct jp_plane_pose *a, const struct jp_plane_pose *b)
{
    return are_near(a, b, APART, APART_TURN);
}

void jp_localiser_search_keep(struct jp_localiser_search *search, const struct jp_localiser_place *place)
{
    struct jp_localiser_place *const places = search->places;
    const bool is_apart = !jp_localiser_search_is_same(&places[0].pose, &place->pose);

    if (place->score > places[0].score) {
        places[1] = is_apart ? places[0] : places[1];
        places[0] = *place;
    } else if (is_apart && place->score > places[1].score) {
        places[1] = *place;
    } else {
        /* It is no better than what is known. */
    }
}

static bool is_free(const struct jp_terrain *map, const struct jp_plane_pose *pose)
{
    return jp_terrain_cell(map, jp_patrol_cell_at(map, pose->x), jp_patrol_cell_at(map, pose->y)) == JP_CELL_FREE;
}

/* The place that fits best around a smallest node. */
static void look_closer(struct jp_localiser_search *search, const struct jp_wall_field *field,
                        const struct jp_terrain *map, const struct node_middle *middle, float noise)
{
    const struct jp_localiser_prior prior = {.start = middle->pose, .spread = middle->still, .noise = noise};
    struct jp_localiser_fit fit;
    struct jp_localiser_place place;

    jp_localiser_match(field, &search->cloud, &prior, &fit);
    if (fit.inliers < search->least - SCORE_MARGIN || !is_free(map, &fit.pose)) {
        return;
    }
    place.pose = fit.pose;
    place.score = score_of(field, &search->cloud, &fit.pose, noise);
    if (place.score >= search->least) {
        jp_localiser_search_keep(search, &place);
    }
}

/* ---- The search ---- */

void jp_localiser_search_begin(struct jp_localiser_search *search, const struct jp_localiser_cloud *cloud,
                               const struct jp_localiser_region *region)
{
    const int32_t count = cloud->count < JP_LOCALISER_SEARCH_POINTS ? cloud->count : JP_LOCALISER_SEARCH_POINTS;

    search->cloud =
        (struct jp_localiser_cloud){.points = search->points, .count = count, .stride = 1, .sensor = cloud->sensor};
    for (int32_t i = 0; i < count; i++) {
        const struct jp_plane_point point = cloud->points[i * cloud->count / count];

        search->points[i] = point;
        search->ranges[i] = jp_plane_length(point.x, point.y);
    }
    search->region = *region;
    search->least = SCORE_FIRST;
    search->top = (struct jp_localiser_node){0, 0, 0, 0};
    search->node_count = 0;
    (void)memset(search->places, 0, sizeof search->places);
    search->is_running = true;
}

/* Lesser places than this are no rivals of the best; below 0 without a place. */
static float rivals_from(const struct jp_localiser_search *search)
{
    return search->places[0].score - SCORE_MARGIN;
}

/* Ends that a place must explain to be of interest. */
static int32_t least_of(const struct jp_localiser_search *search)
{
    const float share = jp_plane_larger(rivals_from(search), search->least);

    return (int32_t)(share * (float)search->cloud.count);
}

/* Whether a square of the first level may hold a place. */
static bool is_square_open(const struct jp_localiser_search *search, const struct jp_wall_field *field,
                           const struct jp_terrain *map, const struct jp_localiser_node *square)
{
    const struct jp_localiser_region *const region = &search->region;
    struct node_middle middle;

    find_middle(field, square, &middle);
    return jp_plane_magnitude(middle.pose.x - region->centre.x) < region->distance + middle.still &&
           jp_plane_magnitude(middle.pose.y - region->centre.y) < region->distance + middle.still &&
           has_free_cell(map, square);
}

static bool is_sector_open(const struct jp_localiser_search *search, const struct jp_wall_field *field,
                           const struct jp_localiser_node *node)
{
    struct node_middle middle;

    find_middle(field, node, &middle);
    return jp_plane_magnitude(jp_plane_wrap(middle.pose.heading - search->region.centre.heading)) <
           search->region.turn + middle.turning;
}

/* To the next square of the first level; false: there is none. */
static bool advance(struct jp_localiser_search *search, const struct jp_wall_field *field)
{
    const int16_t width = (int16_t)width_of(0);
    struct jp_localiser_node *const top = &search->top;

    top->heading = 0;
    top->x = (int16_t)(top->x + width);
    if (SIDE * top->x >= field->width) {
        top->x = 0;
        top->y = (int16_t)(top->y + width);
    }
    return SIDE * top->y < field->height;
}

/* All headings of a square, then the next square; false: all was looked at. */
static bool push_top(struct jp_localiser_search *search, const struct jp_wall_field *field,
                     const struct jp_terrain *map)
{
    struct jp_localiser_node *const top = &search->top;

    if (top->heading == SECTORS || (top->heading == 0 && !is_square_open(search, field, map, top))) {
        return advance(search, field);
    }
    if (is_sector_open(search, field, top)) {
        push(search, top);
    }
    top->heading = (int16_t)(top->heading + width_of(0));
    return true;
}

/* How many nodes' work it took. */
static unsigned look_at(struct jp_localiser_search *search, const struct jp_wall_field *field,
                        const struct jp_terrain *map, float noise)
{
    struct node_middle middle;
    unsigned work = 1;

    search->node_count--;

    const struct jp_localiser_node node = search->nodes[search->node_count];

    find_middle(field, &node, &middle);
    if (may_explain(search, field, &middle, least_of(search))) {
        if (node.level + 1 < LEVELS) {
            push_children(search, &node);
        } else if (!is_known(search, &middle.pose)) {
            look_closer(search, field, map, &middle, noise);
            work = CLOSER;
        } else {
            /* Its neighbour has led there. */
        }
    }
    return work;
}

static bool is_whole_map(const struct jp_localiser_search *search)
{
    return search->region.turn >= JP_PLANE_PI;
}

/* All places from `least` on are known: goes on to lesser ones, unless these cannot be rivals of the best. */
static bool begin_lesser(struct jp_localiser_search *search)
{
    const float least = is_whole_map(search) ? SCORE_MIN : SCORE_MIN_NEAR;
    const bool is_done = search->least <= least || rivals_from(search) >= search->least;

    search->least = jp_plane_larger(search->least - SCORE_STEP, least);
    search->top = (struct jp_localiser_node){0, 0, 0, 0};
    return !is_done;
}

/* Of the whole map no place can be so much better than the second one that it is alone. */
static bool is_decided(const struct jp_localiser_search *search)
{
    return is_whole_map(search) && search->places[1].score > 1.0f - SCORE_MARGIN;
}

unsigned jp_localiser_search_work(struct jp_localiser_search *search, const struct jp_wall_field *field,
                                  const struct jp_terrain *map, float noise, unsigned nodes)
{
    unsigned looked = 0;

    while (search->is_running && looked < nodes) {
        if (search->node_count > 0) {
            looked += look_at(search, field, map, noise);
            search->is_running = !is_decided(search);
        } else {
            search->is_running = push_top(search, field, map) || begin_lesser(search);
            looked++;
        }
    }
    return looked;
}

enum jp_localiser_finding jp_localiser_search_finding(const struct jp_localiser_search *search)
{
    if (!(search->places[0].score > 0.0f)) {
        return JP_LOCALISER_NO_PLACE;
    }
    return search->places[1].score > rivals_from(search) ? JP_LOCALISER_MANY_PLACES : JP_LOCALISER_ONE_PLACE;
}
