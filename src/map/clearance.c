#include "src/map/clearance.h"

#include "src/base/integer.h"

#define HALF (JP_CELLS_ONE / 2)

/** A box, and the quantities that the test of each cell needs. */
struct probe {
    const struct jp_box *box;
    int32_t cosine; /**< Q30 */
    int32_t sine;
    jp_cells_q20 reach_x; /**< of a cell and the box along the map's axes: nearer centres may overlap */
    jp_cells_q20 reach_y;
    jp_cells_q20 reach_along; /**< and along the box's */
    jp_cells_q20 reach_across;
};

static jp_cells_q20 scaled_length(jp_cells_q20 length, int32_t factor)
{
    return jp_multiply_shift(length, factor, 30);
}

static struct probe probe_of(const struct jp_box *box)
{
    const int32_t cosine = jp_cos(box->heading) >> 1;
    const int32_t sine = jp_sin(box->heading) >> 1;
    const int32_t c = jp_absolute32(cosine);
    const int32_t s = jp_absolute32(sine);
    const jp_cells_q20 cell_reach = scaled_length(HALF, c) + scaled_length(HALF, s);

    return (struct probe){.box = box,
                          .cosine = cosine,
                          .sine = sine,
                          .reach_x = HALF + scaled_length(box->half_length, c) + scaled_length(box->half_width, s),
                          .reach_y = HALF + scaled_length(box->half_length, s) + scaled_length(box->half_width, c),
                          .reach_along = box->half_length + cell_reach,
                          .reach_across = box->half_width + cell_reach};
}

/* Separating axes of two rectangles: those of the box. On those of the map the cells around it overlap. */
static bool overlaps(const struct probe *probe, int32_t x, int32_t y)
{
    const jp_cells_q20 dx = x * JP_CELLS_ONE + HALF - probe->box->x;
    const jp_cells_q20 dy = y * JP_CELLS_ONE + HALF - probe->box->y;
    const jp_cells_q20 along = scaled_length(dx, probe->cosine) + scaled_length(dy, probe->sine);
    const jp_cells_q20 across = scaled_length(dy, probe->cosine) - scaled_length(dx, probe->sine);

    return jp_absolute32(along) < probe->reach_along && jp_absolute32(across) < probe->reach_across;
}

static bool is_free(const struct jp_terrain *terrain, int32_t left, int32_t right, int32_t y)
{
    const struct jp_span row = {0, 0, (int8_t)(right - left)};

    return jp_terrain_is_clear(terrain, &row, 1, left, y);
}

static bool is_row_clear(const struct jp_terrain *terrain, const struct probe *probe, int32_t left, int32_t right,
                         int32_t y)
{
    if (is_free(terrain, left, right, y)) {
        return true;
    }
    for (int32_t x = left; x <= right; x++) {
        if (overlaps(probe, x, y) && !is_free(terrain, x, x, y)) {
            return false;
        }
    }
    return true;
}

static int32_t cell_of(jp_cells_q20 place)
{
    return place >> 20;
}

bool jp_box_is_clear(const struct jp_terrain *terrain, const struct jp_box *box)
{
    const struct probe probe = probe_of(box);
    /* A cell that begins where the box ends only touches it. */
    const int32_t left = cell_of(box->x - probe.reach_x + HALF);
    const int32_t right = cell_of(box->x + probe.reach_x - HALF - 1);
    const int32_t top = cell_of(box->y + probe.reach_y - HALF - 1);

    for (int32_t y = cell_of(box->y - probe.reach_y + HALF); y <= top; y++) {
        if (!is_row_clear(terrain, &probe, left, right, y)) {
            return false;
        }
    }
    return true;
}
