#include "sim/lattice/lattice_moves.h"

#include <math.h>
#include <stdlib.h>

#include "sim/base/strict_math.h"

/* A step costs its length times 1 + this × the square of its distance from the path in cells: a detour of a tenth is as
 * bad as two thirds of a cell beside the path. */
#define DEVIATION_WEIGHT 0.25

/* Among equals, fewer steps. */
#define STEP_WEIGHT 1e-3

/* Relaxation of the cells round the path. */
struct search {
    double cost[LATTICE_SIDE][LATTICE_SIDE];
    uint8_t direction[LATTICE_SIDE][LATTICE_SIDE];     /* of the last step */
    double beside[2 * LATTICE_SIDE][2 * LATTICE_SIDE]; /* square of the distance from the path, at half cells */
    int low_x, high_x, low_y, high_y;                  /* cells looked at */
};

double lattice_direction_angle(unsigned direction)
{
    return strict_atan2(jp_move_offsets[direction].dy, jp_move_offsets[direction].dx);
}

double lattice_move_length(enum jp_move_kind kind)
{
    static const double lengths[JP_MOVE_KINDS] = {1, 2.23606797749978970, 1.41421356237309505};
    return lengths[kind];
}

static double square(double x)
{
    return x * x;
}

/* Square of the distance from (x, y) to the nearest pose. */
static double distance2(const struct lattice_path *path, double x, double y)
{
    double least = INFINITY;

    for (size_t i = 0; i < path->count; i++) {
        least = fmin(least, square(path->poses[i].x - x) + square(path->poses[i].y - y));
    }
    return least;
}

static double step_cost(const struct search *search, int x, int y, unsigned direction)
{
    const struct jp_cell_offset offset = jp_move_offsets[direction];
    const int twice_x = 2 * (x + LATTICE_REACH);
    const int twice_y = 2 * (y + LATTICE_REACH);
    const double middle = search->beside[twice_y + offset.dy][twice_x + offset.dx];
    const double end = search->beside[twice_y + 2 * offset.dy][twice_x + 2 * offset.dx];

    return lattice_move_length(jp_move_kind_of(direction)) * (1 + DEVIATION_WEIGHT * (middle + end) / 2) + STEP_WEIGHT;
}

static bool is_inside(const struct search *search, int x, int y)
{
    return x >= search->low_x && x <= search->high_x && y >= search->low_y && y <= search->high_y;
}

/* Tries the steps from a cell; true when one improves the cell it leads to. */
static bool relax_cell(struct search *search, int x, int y)
{
    const double cost = search->cost[y + LATTICE_REACH][x + LATTICE_REACH];
    bool improved = false;

    for (unsigned d = 0; d < JP_MOVE_DIRECTIONS && cost < INFINITY; d++) {
        const int to_x = x + jp_move_offsets[d].dx;
        const int to_y = y + jp_move_offsets[d].dy;
        if (!is_inside(search, to_x, to_y)) {
            continue;
        }
        double *to = &search->cost[to_y + LATTICE_REACH][to_x + LATTICE_REACH];
        const double through = cost + step_cost(search, x, y, d);
        if (through < *to - 1e-12) {
            *to = through;
            search->direction[to_y + LATTICE_REACH][to_x + LATTICE_REACH] = (uint8_t)d;
            improved = true;
        }
    }
    return improved;
}

/* One pass over all cells; true while a cell improves. */
static bool relax(struct search *search)
{
    bool improved = false;

    for (int y = search->low_y; y <= search->high_y; y++) {
        for (int x = search->low_x; x <= search->high_x; x++) {
            improved = relax_cell(search, x, y) || improved;
        }
    }
    return improved;
}

/* The cells at most a knight's move beside the path. */
static void set_bounds(struct search *search, const struct lattice_path *path)
{
    double low_x = 0, high_x = 0, low_y = 0, high_y = 0;

    for (size_t i = 0; i < path->count; i++) {
        low_x = fmin(low_x, path->poses[i].x);
        high_x = fmax(high_x, path->poses[i].x);
        low_y = fmin(low_y, path->poses[i].y);
        high_y = fmax(high_y, path->poses[i].y);
    }
    search->low_x = (int)fmax(floor(low_x) - 2, -LATTICE_REACH);
    search->high_x = (int)fmin(ceil(high_x) + 2, LATTICE_REACH);
    search->low_y = (int)fmax(floor(low_y) - 2, -LATTICE_REACH);
    search->high_y = (int)fmin(ceil(high_y) + 2, LATTICE_REACH);
}

static void start(struct search *search, const struct lattice_path *path)
{
    set_bounds(search, path);
    for (int y = search->low_y; y <= search->high_y; y++) {
        for (int x = search->low_x; x <= search->high_x; x++) {
            search->cost[y + LATTICE_REACH][x + LATTICE_REACH] = INFINITY;
        }
    }
    for (int y = 2 * search->low_y; y <= 2 * search->high_y; y++) {
        for (int x = 2 * search->low_x; x <= 2 * search->high_x; x++) {
            search->beside[y + 2 * LATTICE_REACH][x + 2 * LATTICE_REACH] = distance2(path, x / 2.0, y / 2.0);
        }
    }
    search->cost[LATTICE_REACH][LATTICE_REACH] = 0;
}

static bool trace(const struct search *search, struct lattice_primitive *primitive)
{
    uint8_t backwards[LATTICE_MOVES_MAX];
    size_t count = 0;

    for (int x = primitive->dx, y = primitive->dy; x != 0 || y != 0; count++) {
        if (count == LATTICE_MOVES_MAX) {
            return false;
        }
        backwards[count] = search->direction[y + LATTICE_REACH][x + LATTICE_REACH];
        x -= jp_move_offsets[backwards[count]].dx;
        y -= jp_move_offsets[backwards[count]].dy;
    }
    for (size_t i = 0; i < count; i++) {
        primitive->moves[i] = backwards[count - 1 - i];
    }
    primitive->move_count = count;
    return true;
}

bool lattice_find_moves(struct lattice_primitive *primitive)
{
    struct search *search = malloc(sizeof *search);
    if (search == NULL) {
        return false;
    }
    start(search, &primitive->path);
    while (relax(search)) {
    }
    const bool found = is_inside(search, primitive->dx, primitive->dy) && trace(search, primitive);
    free(search);
    return found;
}
