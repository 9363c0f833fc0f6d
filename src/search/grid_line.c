/* Whether a line enters blocked cells: exact, for a cell's borders are multiples of its side, and so are integers. */
#include "src/search/grid_line.h"

/** A line seen so that it runs east, north or both: mirrored where it does not. */
struct line {
    const struct jp_grid_planner_internal *planner;
    int32_t side;
    bool mirror_x;
    bool mirror_y;
    bool use_planes;
    int32_t x0, y0, x1, y1;
};

static bool is_blocked(const struct line *line, int32_t i, int32_t j)
{
    const struct jp_grid_planner_internal *planner = line->planner;
    const struct jp_terrain_config *map = &planner->terrain->config;
    const int32_t x = line->mirror_x ? (int32_t)map->width - 1 - i : i;
    const int32_t y = line->mirror_y ? (int32_t)map->height - 1 - j : j;

    return line->use_planes ? jp_grid_is_blocked(planner, x, y)
                            : !jp_terrain_is_clear(planner->terrain, planner->disc, planner->disc_rows, x, y);
}

/** True when two blocked cells meet corner to corner at the south-west corner of a cell. */
static bool is_pinched(const struct line *line, int32_t i, int32_t j)
{
    return (is_blocked(line, i - 1, j - 1) && is_blocked(line, i, j)) ||
           (is_blocked(line, i, j - 1) && is_blocked(line, i - 1, j));
}

static bool is_pinched_point(const struct line *line, int32_t x, int32_t y)
{
    return x % line->side == 0 && y % line->side == 0 && is_pinched(line, x / line->side, y / line->side);
}

/** Of what is entered from the south or west: the last cell before x. */
static int32_t cell_before(const struct line *line, int32_t x)
{
    return (x + line->side - 1) / line->side - 1;
}

/** Along the border on the west of column `border`: never between two blocked cells. */
static bool is_free_northward(const struct line *line, int32_t border)
{
    const int32_t last = cell_before(line, line->y1);

    for (int32_t j = line->y0 / line->side; j <= last; j++) {
        if (is_blocked(line, border - 1, j) && is_blocked(line, border, j)) {
            return false;
        }
        if (j < last && is_pinched(line, border, j + 1)) {
            return false;
        }
    }
    return true;
}

static bool is_free_eastward(const struct line *line, int32_t border)
{
    const int32_t last = cell_before(line, line->x1);

    for (int32_t i = line->x0 / line->side; i <= last; i++) {
        if (is_blocked(line, i, border - 1) && is_blocked(line, i, border)) {
            return false;
        }
        if (i < last && is_pinched(line, i + 1, border)) {
            return false;
        }
    }
    return true;
}

/** Cell by cell. `lead` is above 0 when the line meets the next row before the next column, and 0 at a corner. */
static bool is_free_inside(const struct line *line)
{
    const int64_t dx = line->x1 - line->x0;
    const int64_t dy = line->y1 - line->y0;
    const int32_t last_i = cell_before(line, line->x1);
    const int32_t last_j = cell_before(line, line->y1);
    int32_t i = line->x0 / line->side;
    int32_t j = line->y0 / line->side;
    int64_t lead = ((int64_t)(i + 1) * line->side - line->x0) * dy - ((int64_t)(j + 1) * line->side - line->y0) * dx;

    while (!is_blocked(line, i, j)) {
        if (i == last_i && j == last_j) {
            return true;
        }
        if (lead == 0 && is_pinched(line, i + 1, j + 1)) {
            return false;
        }
        const int64_t before = lead;
        if (before <= 0) {
            i++;
            lead += line->side * dy;
        }
        if (before >= 0) {
            j++;
            lead -= line->side * dx;
        }
    }
    return false;
}

static bool is_on_map(const struct jp_grid_planner_internal *planner, const struct jp_point *point)
{
    const struct jp_terrain_config *map = &planner->terrain->config;

    return point->x >= 0 && point->x <= (int32_t)map->width * map->resolution && point->y >= 0 &&
           point->y <= (int32_t)map->height * map->resolution;
}

bool jp_grid_line_is_free(const struct jp_grid_planner_internal *planner, const struct jp_point *from,
                          const struct jp_point *to)
{
    const struct jp_terrain_config *map = &planner->terrain->config;
    struct line line = {.planner = planner,
                        .side = map->resolution,
                        .mirror_x = to->x < from->x,
                        .mirror_y = to->y < from->y,
                        .x0 = from->x,
                        .y0 = from->y,
                        .x1 = to->x,
                        .y1 = to->y};

    if (!is_on_map(planner, from) || !is_on_map(planner, to)) {
        return false;
    }
    line.use_planes = planner->has_planes && planner->version == planner->terrain->version;
    if (line.mirror_x) {
        line.x0 = (int32_t)map->width * line.side - from->x;
        line.x1 = (int32_t)map->width * line.side - to->x;
    }
    if (line.mirror_y) {
        line.y0 = (int32_t)map->height * line.side - from->y;
        line.y1 = (int32_t)map->height * line.side - to->y;
    }
    if (is_pinched_point(&line, line.x0, line.y0) || is_pinched_point(&line, line.x1, line.y1)) {
        return false;
    }
    if (line.x0 == line.x1 && line.x0 % line.side == 0) {
        return is_free_northward(&line, line.x0 / line.side);
    }
    if (line.y0 == line.y1 && line.y0 % line.side == 0) {
        return is_free_eastward(&line, line.y0 / line.side);
    }
    return is_free_inside(&line);
}
