#include "src/map/capsule.h"

#include "src/base/integer.h"

/* Lengths here are in 1/1024 of a cell. */
#define CELL ((int32_t)1024)
#define HALF (CELL / 2)

/** Cells of one look at a row. */
#define CELLS_A_LOOK 64

struct spot {
    int32_t x;
    int32_t y;
};

/** The line of the capsule, and what the distance from it needs. */
struct stroke {
    struct spot from;
    struct spot to;
    int64_t square; /**< of its length */
    int32_t length; /**< 2⁻¹⁰ of the unit, so that short ones are as exact */
    int32_t radius;
};

static int64_t in_cells(const struct jp_terrain *terrain, jp_q16 length)
{
    return (int64_t)length * CELL / terrain->config.resolution;
}

static bool is_along(int64_t place, uint16_t cells)
{
    return place >= 0 && place <= (int64_t)cells * CELL;
}

/** False: it is off the map. */
static bool find_place(const struct jp_terrain *terrain, const struct jp_point *point, struct spot *place)
{
    const int64_t x = in_cells(terrain, point->x);
    const int64_t y = in_cells(terrain, point->y);

    if (!is_along(x, terrain->config.width) || !is_along(y, terrain->config.height)) {
        return false;
    }
    *place = (struct spot){(int32_t)x, (int32_t)y};
    return true;
}

static int64_t dot(struct spot a, struct spot b)
{
    return (int64_t)a.x * b.x + (int64_t)a.y * b.y;
}

static struct spot difference(struct spot a, struct spot b)
{
    return (struct spot){a.x - b.x, a.y - b.y};
}

/** False: an end of it is off the map. */
static bool find_line(const struct jp_terrain *terrain, const struct jp_capsule *capsule, struct stroke *line)
{
    if (!find_place(terrain, &capsule->from, &line->from) || !find_place(terrain, &capsule->to, &line->to)) {
        return false;
    }
    const struct spot along = difference(line->to, line->from);

    line->square = dot(along, along);
    line->length = (int32_t)jp_square_root((uint64_t)line->square << 20);
    line->radius = (int32_t)in_cells(terrain, capsule->radius);
    return true;
}

/** Distance of a place from the line: to its nearer end, or across. */
static int32_t distance(const struct stroke *line, struct spot place)
{
    const struct spot along = difference(line->to, line->from);
    const struct spot off = difference(place, line->from);
    const struct spot beyond = difference(place, line->to);
    const int64_t share = dot(along, off);

    if (share <= 0) {
        return (int32_t)jp_square_root((uint64_t)dot(off, off));
    }
    if (share >= line->square) {
        return (int32_t)jp_square_root((uint64_t)dot(beyond, beyond));
    }
    const int64_t across = ((int64_t)along.x * off.y - (int64_t)along.y * off.x) * 1024 / line->length;

    return (int32_t)(across < 0 ? -across : across);
}

static int32_t outside(int32_t place, int32_t low)
{
    if (place < low) {
        return low - place;
    }
    return place > low + CELL ? place - low - CELL : 0;
}

/** True when an end of the line is nearer to a cell than the radius. */
static bool reaches(const struct stroke *line, struct spot end, struct spot corner)
{
    const struct spot off = {outside(end.x, corner.x), outside(end.y, corner.y)};

    return dot(off, off) < (int64_t)line->radius * line->radius;
}

/** The nearest points of a line and a cell are a corner of the cell or an end of the line, unless the line runs through
 *  the cell: then near its middle, or, with the radius at least a quarter of a cell, near a corner. */
static bool overlaps(const struct stroke *line, int32_t x, int32_t y)
{
    const struct spot corner = {x * CELL, y * CELL};

    if (reaches(line, line->from, corner) || reaches(line, line->to, corner) ||
        distance(line, (struct spot){corner.x + HALF, corner.y + HALF}) < HALF) {
        return true;
    }
    for (int32_t i = 0; i < 4; i++) {
        if (distance(line, (struct spot){corner.x + i % 2 * CELL, corner.y + i / 2 * CELL}) < line->radius) {
            return true;
        }
    }
    return false;
}

static int32_t lesser(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static int32_t greater(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

/** x where the line is at a height, which is within it. */
static int32_t x_at(const struct stroke *line, int32_t y)
{
    const struct spot along = difference(line->to, line->from);

    return line->from.x + (int32_t)((int64_t)along.x * (y - line->from.y) / along.y);
}

/** The columns that the capsule touches in a row, or a few more; the row is not beyond its ends. */
static void columns_of(const struct stroke *line, int32_t row, int32_t *first, int32_t *last)
{
    const int32_t low = greater(row * CELL - line->radius, lesser(line->from.y, line->to.y));
    const int32_t high = lesser((row + 1) * CELL + line->radius, greater(line->from.y, line->to.y));

    const bool is_level = line->from.y == line->to.y;
    const int32_t a = is_level ? line->from.x : x_at(line, low);
    const int32_t b = is_level ? line->to.x : x_at(line, high);

    *first = (lesser(a, b) - line->radius) >> 10;
    *last = (greater(a, b) + line->radius) >> 10;
}

static bool is_free(const struct jp_terrain *terrain, int32_t first, int32_t last, int32_t row)
{
    const struct jp_span span = {0, 0, (int8_t)(last - first)};

    return jp_terrain_is_clear(terrain, &span, 1, first, row);
}

static bool is_row_clear(const struct jp_terrain *terrain, const struct stroke *line, int32_t row)
{
    int32_t first;
    int32_t last;

    columns_of(line, row, &first, &last);
    for (int32_t x = first; x <= last; x += CELLS_A_LOOK) {
        const int32_t end = lesser(x + CELLS_A_LOOK - 1, last);

        if (is_free(terrain, x, end, row)) {
            continue;
        }
        for (int32_t column = x; column <= end; column++) {
            if (!is_free(terrain, column, column, row) && overlaps(line, column, row)) {
                return false;
            }
        }
    }
    return true;
}

bool jp_capsule_is_clear(const struct jp_terrain *terrain, const struct jp_capsule *capsule)
{
    struct stroke line;

    if (!find_line(terrain, capsule, &line)) {
        return false;
    }
    const int32_t last = (greater(line.from.y, line.to.y) + line.radius) >> 10;

    for (int32_t row = (lesser(line.from.y, line.to.y) - line.radius) >> 10; row <= last; row++) {
        if (!is_row_clear(terrain, &line, row)) {
            return false;
        }
    }
    return true;
}
