#include "src/local/wall_field.h"

#include "src/base/plane.h"

/* Cells from which on a distance is not told apart, and the units of a cell. */
#define CAP   16
#define UNITS 8.0f
#define MOST  127

/* Off the map, beside its edge. */
#define OUTSIDE (-4)

/* A ray is in a wall from this depth on, cells, and does not take smaller steps. */
#define DEPTH    (-0.2f)
#define STEP_MIN 0.5f

/* A cell's distance is that of its middle: a corner of a wall may be nearer by so much, cells. */
#define CORNER 0.5f

static int8_t *cell_of(const struct jp_wall_field *field, int32_t x, int32_t y)
{
    return &field->cells[y * field->width + x];
}

/* ---- Making it ---- */

/* Cells along the row to the nearest one of the other kind among those that are behind; negative in walls. */
static void sweep(const struct jp_wall_field *field, const struct jp_terrain *map, int32_t y, bool is_back)
{
    const int32_t step = is_back ? -1 : 1;
    int32_t x = is_back ? field->width - 1 : 0;
    bool was_wall = true;
    int32_t away = CAP;

    for (int32_t i = 0; i < field->width; i++) {
        const bool is_wall = jp_terrain_cell(map, x, y) == JP_CELL_OCCUPIED;
        int8_t *const cell = cell_of(field, x, y);
        const int32_t known = is_back ? (*cell < 0 ? -*cell : *cell) : CAP;

        away = is_wall != was_wall ? 1 : away + 1;
        was_wall = is_wall;

        const int32_t least = away < known ? away : known;

        *cell = (int8_t)(is_wall ? -least : least);
        x += step;
    }
}

/* Square of the distance to the nearest cell of the other kind in a row that is `away` rows from the cell's own. */
static int32_t square_in_row(int8_t own, int8_t other, int32_t away)
{
    const bool are_alike = (own < 0) == (other < 0);

    return away * away + (are_alike ? (int32_t)other * other : 0);
}

static int8_t distance_in_column(const int8_t *column, int32_t height, int32_t y)
{
    const int8_t own = column[y];
    int32_t best = (int32_t)own * own;

    for (int32_t away = 1; away * away < best; away++) {
        for (int32_t side = -away; side <= away; side += 2 * away) {
            const bool is_inside = y + side >= 0 && y + side < height;
            const int32_t square = square_in_row(own, is_inside ? column[y + side] : (int8_t)-CAP, away);

            best = square < best ? square : best;
        }
    }

    const float units = UNITS * (jp_plane_square_root((float)best) - 0.5f);
    const int32_t rounded = best >= CAP * CAP ? MOST : (int32_t)(units + 0.5f);

    return (int8_t)(own < 0 ? -rounded : rounded);
}

void jp_wall_field_make(struct jp_wall_field *field, const struct jp_terrain *map, int8_t *column)
{
    for (int32_t y = 0; y < field->height; y++) {
        sweep(field, map, y, false);
        sweep(field, map, y, true);
    }
    for (int32_t x = 0; x < field->width; x++) {
        for (int32_t y = 0; y < field->height; y++) {
            column[y] = *cell_of(field, x, y);
        }
        for (int32_t y = 0; y < field->height; y++) {
            *cell_of(field, x, y) = distance_in_column(column, field->height, y);
        }
    }
}

/* ---- Reading it ---- */

/* Rounded down; what no map holds is off every map. */
static int32_t floor_of(float cells)
{
    const float limited = jp_plane_clamp(cells, -2.0f, (float)JP_TERRAIN_SIDE_MAX + 2.0f);
    const int32_t whole = (int32_t)limited;

    return (float)whole > limited ? whole - 1 : whole;
}

static float read(const struct jp_wall_field *field, int32_t x, int32_t y)
{
    const bool is_inside = x >= 0 && y >= 0 && x < field->width && y < field->height;

    return (float)(is_inside ? *cell_of(field, x, y) : OUTSIDE);
}

bool jp_wall_field_find(const struct jp_wall_field *field, struct jp_plane_point point,
                        struct jp_wall_distance *distance)
{
    const float u = point.x / field->cell - 0.5f;
    const float v = point.y / field->cell - 0.5f;
    const int32_t x = floor_of(u);
    const int32_t y = floor_of(v);
    const float s = u - (float)x;
    const float t = v - (float)y;

    *distance = (struct jp_wall_distance){.distance = field->cell * ((float)OUTSIDE / UNITS)};
    if (x < -1 || y < -1 || x >= field->width || y >= field->height) {
        return false;
    }

    const float low = read(field, x, y);
    const float east = read(field, x + 1, y);
    const float north = read(field, x, y + 1);
    const float high = read(field, x + 1, y + 1);
    const float south_edge = low + s * (east - low);
    const float north_edge = north + s * (high - north);
    const float units = south_edge + t * (north_edge - south_edge);

    distance->distance = units * (field->cell / UNITS);
    distance->gradient.x = ((1.0f - t) * (east - low) + t * (high - north)) * (1.0f / UNITS);
    distance->gradient.y = (north_edge - south_edge) * (1.0f / UNITS);
    return jp_plane_magnitude(units) < JP_WALL_FIELD_REACH * UNITS;
}

static float cell_at(const struct jp_wall_field *field, struct jp_plane_point point)
{
    return read(field, floor_of(point.x / field->cell), floor_of(point.y / field->cell)) * (1.0f / UNITS);
}

float jp_wall_field_near(const struct jp_wall_field *field, struct jp_plane_point point)
{
    return jp_plane_magnitude(cell_at(field, point)) * field->cell;
}

/** A step along a ray. False: it has come to a wall or to its end. */
static bool step_along(const struct jp_wall_field *field, struct jp_plane_point from, struct jp_plane_point along,
                       float range_max, float *way)
{
    const struct jp_plane_point point = {from.x + *way * along.x, from.y + *way * along.y};
    struct jp_wall_distance wall;

    (void)jp_wall_field_find(field, point, &wall);

    const float depth = wall.distance / field->cell;

    if (depth < DEPTH) {
        return false;
    }
    *way += field->cell * jp_plane_larger(depth - CORNER, STEP_MIN);
    return *way < range_max;
}

float jp_wall_field_ray(const struct jp_wall_field *field, struct jp_plane_point from, struct jp_plane_point along,
                        float range_max)
{
    float way = 0.0f;

    while (step_along(field, from, along, range_max, &way)) {
    }
    return way < range_max ? way : range_max;
}
