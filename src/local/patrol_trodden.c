#include "src/local/patrol_trodden.h"

#include "src/base/plane.h"
#include "src/local/patrol_marks.h"

/* Who walks to and fro comes back within this, s. */
#define REMEMBERED 40.0f

/* Between places that are noted, m: people step over as much. */
#define SPACING 0.3f

/* Who was seen walking within this walks, s. */
#define WALKING 0.15f

/* From the robot's middle, and from its goal's, beyond its reach: what counts as free for the way out and in, m. */
#define ROOM 0.7f

/* A person is at least so wide, m: beams miss the rims. */
#define RADIUS_MIN 0.25f

static bool is_remembered(const struct jp_patrol_trodden *place)
{
    return place->radius > 0.0f && place->age < REMEMBERED;
}

/* The note of a place near somebody, else the oldest. */
static struct jp_patrol_trodden *place_for(struct jp_patrol *patrol, struct jp_plane_point at)
{
    struct jp_patrol_trodden *oldest = &patrol->internal.trodden[0];

    for (unsigned i = 0; i < JP_PATROL_TRODDEN_MAX; i++) {
        struct jp_patrol_trodden *const place = &patrol->internal.trodden[i];

        if (is_remembered(place) && jp_plane_square_between(place->place, at) < SPACING * SPACING) {
            return place;
        }
        if (!is_remembered(place) || (is_remembered(oldest) && place->age > oldest->age)) {
            oldest = place;
        }
    }
    oldest->place = at;
    oldest->radius = 0.0f;
    return oldest;
}

void jp_patrol_note_steps(struct jp_patrol *patrol)
{
    for (unsigned i = 0; i < JP_PATROL_TRODDEN_MAX; i++) {
        patrol->internal.trodden[i].age += patrol->config.period;
    }
    for (unsigned i = 0; i < patrol->movers.count; i++) {
        const struct jp_mover *const mover = &patrol->movers.movers[i];

        if (mover->pace > 0.0f && mover->misses == 0U && mover->standing < WALKING) {
            struct jp_patrol_trodden *const place = place_for(patrol, mover->centre);

            place->age = 0.0f;
            place->radius = jp_plane_larger(place->radius, jp_plane_larger(mover->radius, RADIUS_MIN));
        }
    }
}

/* A disc of cells around a place gets what another map has there, or is occupied; but not within `reach` of two places.
 */
struct brush {
    const struct jp_terrain *given; /* null: occupied */
    const struct jp_plane_pose *kept[2];
    float reach;
    float clearance; /* around a place, m */
};

static bool is_kept(const struct brush *brush, float x, float y)
{
    for (unsigned i = 0; i < 2U && brush->given == NULL; i++) {
        if (jp_plane_length(x - brush->kept[i]->x, y - brush->kept[i]->y) < brush->reach) {
            return true;
        }
    }
    return false;
}

static void paint(const struct brush *brush, const struct jp_patrol_trodden *place, struct jp_terrain *marked)
{
    const float cell = jp_patrol_cell(marked);
    const float radius = place->radius + brush->clearance;
    const int32_t left = jp_patrol_cell_at(marked, place->place.x - radius);
    const int32_t right = jp_patrol_cell_at(marked, place->place.x + radius);
    const int32_t top = jp_patrol_cell_at(marked, place->place.y + radius);

    for (int32_t row = jp_patrol_cell_at(marked, place->place.y - radius); row <= top; row++) {
        for (int32_t column = left; column <= right; column++) {
            const float x = ((float)column + 0.5f) * cell;
            const float y = ((float)row + 0.5f) * cell;

            if (jp_plane_length(x - place->place.x, y - place->place.y) <= radius && !is_kept(brush, x, y)) {
                (void)jp_terrain_set_cell(marked, column, row,
                                          brush->given == NULL ? JP_CELL_OCCUPIED
                                                               : jp_terrain_cell(brush->given, column, row));
            }
        }
    }
}

static void paint_all(const struct jp_patrol *patrol, const struct brush *brush, struct jp_terrain *marked)
{
    for (unsigned i = 0; i < JP_PATROL_TRODDEN_MAX; i++) {
        if (patrol->internal.trodden[i].radius > 0.0f) {
            if (brush->given != NULL || is_remembered(&patrol->internal.trodden[i])) {
                paint(brush, &patrol->internal.trodden[i], marked);
            }
        }
    }
}

void jp_patrol_occupy_trodden(const struct jp_patrol *patrol, const struct jp_plane_pose *goal, float clearance,
                              struct jp_terrain *marked)
{
    const struct jp_footprint *const footprint = &patrol->config.teb.footprint;
    struct brush brush = {
        .reach = ROOM + jp_plane_length(jp_plane_larger(footprint->front, footprint->rear), footprint->half_width),
        .clearance = clearance};

    brush.kept[0] = &patrol->pose;
    brush.kept[1] = goal;
    paint_all(patrol, &brush, marked);
}

void jp_patrol_clear_trodden(const struct jp_patrol *patrol, const struct jp_terrain *given, float clearance,
                             struct jp_terrain *marked)
{
    const struct brush brush = {.given = given, .clearance = clearance};

    paint_all(patrol, &brush, marked);
}
