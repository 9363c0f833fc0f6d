#include "src/search/planner_repair.h"

#include <string.h>

#include "src/search/planner_search.h"

enum {
    WINDOW = 64, /* cells, wide and high: a word a row */
    CHANGES_EXTENT =
        WINDOW - 2 * JP_SWEEP_REACH, /* of the changed cells, so that the window holds all that they touch */
};

/** Cells where a state of one heading has lost or gained a primitive. */
struct window {
    int32_t x; /* of its lower left cell */
    int32_t y;
    uint64_t rows[WINDOW];
};

static struct jp_cell_box box_of_changes(const struct jp_planner_internal *planner)
{
    struct jp_cell_box box = {planner->changes.cells[0].x, planner->changes.cells[0].x, planner->changes.cells[0].y,
                              planner->changes.cells[0].y};

    for (unsigned i = 1; i < planner->changes.count; i++) {
        const int32_t x = planner->changes.cells[i].x;
        const int32_t y = planner->changes.cells[i].y;
        box.first_x = x < box.first_x ? x : box.first_x;
        box.last_x = x > box.last_x ? x : box.last_x;
        box.first_y = y < box.first_y ? y : box.first_y;
        box.last_y = y > box.last_y ? y : box.last_y;
    }
    return box;
}

static bool is_near(int32_t a, int32_t first, int32_t last)
{
    return a > last - CHANGES_EXTENT && a < first + CHANGES_EXTENT;
}

bool jp_repair_fits(const struct jp_planner_internal *planner, int32_t x, int32_t y)
{
    if (planner->changes.count == 0U) {
        return true;
    }
    const struct jp_cell_box box = box_of_changes(planner);

    return planner->changes.count < JP_PLANNER_CHANGES && is_near(x, box.first_x, box.last_x) &&
           is_near(y, box.first_y, box.last_y);
}

/** Marks the cells from which a state of a heading sweeps the change: change − swept cell, the heading's reach
 * mirrored. */
static void mark(struct window *window, const struct jp_lattice *lattice, struct jp_cells reach,
                 const struct jp_cell_change *change)
{
    for (unsigned i = 0; i < reach.span_count; i++) {
        const struct jp_span span = lattice->spans[reach.first_span + i];
        const int32_t first = change->x - span.last - window->x;
        const uint64_t bits = (UINT64_C(1) << (span.last - span.first + 1)) - 1;

        window->rows[change->y - span.y - window->y] |= bits << first;
    }
}

static void fill_window(struct window *window, const struct jp_planner_internal *planner, unsigned heading)
{
    const struct jp_lattice *lattice = planner->config.lattice;
    const struct jp_cell_box box = box_of_changes(planner);

    (void)memset(window, 0, sizeof *window);
    window->x = box.first_x - JP_SWEEP_REACH;
    window->y = box.first_y - JP_SWEEP_REACH;
    for (unsigned i = 0; i < planner->changes.count; i++) {
        mark(window, lattice, lattice->reach[heading], &planner->changes.cells[i]);
    }
}

/** The cursor counts heading, row and column of the window. */
static bool repair_cell(struct jp_planner_internal *planner, const struct window *window, unsigned heading,
                        uint32_t cell)
{
    const int32_t x = window->x + (int32_t)(cell % WINDOW);
    const int32_t y = window->y + (int32_t)(cell / WINDOW);

    return !jp_terrain_contains(planner->terrain, x, y) ||
           jp_search_repair(planner, jp_search_id(planner, x, y, heading), planner->changes.may_be_cheaper);
}

/** Repairs within one heading. */
static enum repair_result repair_heading(struct jp_planner_internal *planner, unsigned heading, unsigned *states)
{
    const uint32_t first = heading * WINDOW * WINDOW;
    struct window window;

    fill_window(&window, planner, heading);
    while (planner->changes.cursor < first + WINDOW * WINDOW) {
        const uint32_t cell = planner->changes.cursor - first;
        const uint64_t rest = window.rows[cell / WINDOW] >> (cell % WINDOW);

        if (rest == 0U) {
            planner->changes.cursor += WINDOW - cell % WINDOW;
            continue;
        }
        if (*states == 0) {
            return REPAIR_WORKING;
        }
        if ((rest & 1U) != 0U) {
            --*states;
            if (!repair_cell(planner, &window, heading, cell)) {
                return REPAIR_FULL;
            }
        }
        planner->changes.cursor++;
    }
    return REPAIR_DONE;
}

enum repair_result jp_repair_work(struct jp_planner_internal *planner, unsigned *states)
{
    while (planner->changes.cursor < JP_HEADINGS * WINDOW * WINDOW) {
        const enum repair_result result = repair_heading(planner, planner->changes.cursor / (WINDOW * WINDOW), states);

        if (result != REPAIR_DONE) {
            return result;
        }
    }
    return REPAIR_DONE;
}
