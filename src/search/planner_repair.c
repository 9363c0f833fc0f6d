#include "src/search/planner_repair.h"

#include <string.h>

#include "src/search/planner_search.h"

enum {
    WINDOW = 64, /* cells, wide and high: a word a row */
    WINDOW_CELLS = WINDOW * WINDOW,
    CHANGES_EXTENT = 16,                                           /* of the changed cells */
    TILES = (2 * INT8_MAX + CHANGES_EXTENT + WINDOW - 1) / WINDOW, /* windows side by side hold all that they touch */
    HEADING_CELLS = TILES * TILES * WINDOW_CELLS,
};

/** Cells where a state of one heading has lost or gained a primitive. */
struct window {
    int32_t x; /* of its lower left cell */
    int32_t y;
    uint64_t rows[WINDOW];
};

static int32_t smaller(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static int32_t larger(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

static struct jp_cell_box box_of_changes(const struct jp_planner_internal *planner)
{
    struct jp_cell_box box = {planner->changes.cells[0].x, planner->changes.cells[0].x, planner->changes.cells[0].y,
                              planner->changes.cells[0].y};

    for (unsigned i = 1; i < planner->changes.count; i++) {
        const int32_t x = planner->changes.cells[i].x;
        const int32_t y = planner->changes.cells[i].y;
        box.first_x = smaller(box.first_x, x);
        box.last_x = larger(box.last_x, x);
        box.first_y = smaller(box.first_y, y);
        box.last_y = larger(box.last_y, y);
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

/** The cells from which a state of a heading may sweep a change: change − swept cell, the heading's reach mirrored. */
static struct jp_cell_box box_of_states(const struct jp_planner_internal *planner, struct jp_cells reach)
{
    const struct jp_cell_box changes = box_of_changes(planner);
    struct jp_cell_box box = changes;

    for (unsigned i = 0; i < reach.span_count; i++) {
        const struct jp_span *span = &planner->config.lattice->spans[reach.first_span + i];
        box.first_x = smaller(box.first_x, changes.first_x - span->last);
        box.last_x = larger(box.last_x, changes.last_x - span->first);
        box.first_y = smaller(box.first_y, changes.first_y - span->y);
        box.last_y = larger(box.last_y, changes.last_y - span->y);
    }
    return box;
}

/** Marks those of the window that sweep one change. */
static void mark(struct window *window, const struct jp_lattice *lattice, struct jp_cells reach,
                 const struct jp_cell_change *change)
{
    for (unsigned i = 0; i < reach.span_count; i++) {
        const struct jp_span *span = &lattice->spans[reach.first_span + i];
        const int32_t row = change->y - span->y - window->y;
        const int32_t first = larger(change->x - span->last - window->x, 0);
        const int32_t last = smaller(change->x - span->first - window->x, WINDOW - 1);

        if (row >= 0 && row < WINDOW && first <= last) {
            window->rows[row] |= (UINT64_MAX >> (WINDOW - 1 - (last - first))) << first;
        }
    }
}

static void fill_window(struct window *window, const struct jp_planner_internal *planner, struct jp_cells reach)
{
    (void)memset(window->rows, 0, sizeof window->rows);
    for (unsigned i = 0; i < planner->changes.count; i++) {
        mark(window, planner->config.lattice, reach, &planner->changes.cells[i]);
    }
}

static bool repair_cell(struct jp_planner_internal *planner, const struct window *window, unsigned heading,
                        uint32_t cell)
{
    const int32_t x = window->x + (int32_t)(cell % WINDOW);
    const int32_t y = window->y + (int32_t)(cell / WINDOW);

    return !jp_terrain_contains(planner->terrain, x, y) ||
           jp_search_repair(planner, jp_search_id(planner, x, y, heading), planner->changes.may_be_cheaper);
}

/** Repairs the window that the cursor is in. */
static enum repair_result repair_window(struct jp_planner_internal *planner, const struct window *window,
                                        unsigned heading, unsigned *states)
{
    const uint32_t first = planner->changes.cursor - planner->changes.cursor % WINDOW_CELLS;

    while (planner->changes.cursor < first + WINDOW_CELLS) {
        const uint32_t cell = planner->changes.cursor - first;
        const uint64_t rest = window->rows[cell / WINDOW] >> (cell % WINDOW);

        if (rest == 0U) {
            planner->changes.cursor += WINDOW - cell % WINDOW;
            continue;
        }
        if (*states == 0) {
            return REPAIR_WORKING;
        }
        if ((rest & 1U) != 0U) {
            --*states;
            if (!repair_cell(planner, window, heading, cell)) {
                return REPAIR_FULL;
            }
        }
        planner->changes.cursor++;
    }
    return REPAIR_DONE;
}

/** Repairs within one heading. */
static enum repair_result repair_heading(struct jp_planner_internal *planner, unsigned heading, unsigned *states)
{
    const struct jp_cells reach = planner->config.lattice->reach[heading];
    const struct jp_cell_box box = box_of_states(planner, reach);
    struct window window;

    while (planner->changes.cursor / HEADING_CELLS == heading) {
        const uint32_t tile = planner->changes.cursor / WINDOW_CELLS % (TILES * TILES);
        window.x = box.first_x + (int32_t)(tile % TILES) * WINDOW;
        window.y = box.first_y + (int32_t)(tile / TILES) * WINDOW;
        if (window.y > box.last_y) {
            planner->changes.cursor = (heading + 1U) * HEADING_CELLS;
        } else if (window.x > box.last_x) {
            planner->changes.cursor += (TILES - tile % TILES) * WINDOW_CELLS;
        } else {
            fill_window(&window, planner, reach);
            const enum repair_result result = repair_window(planner, &window, heading, states);
            if (result != REPAIR_DONE) {
                return result;
            }
        }
    }
    return REPAIR_DONE;
}

/** The cursor counts heading, window, row and column. */
enum repair_result jp_repair_work(struct jp_planner_internal *planner, unsigned *states)
{
    while (planner->changes.cursor < JP_HEADINGS * HEADING_CELLS) {
        const enum repair_result result = repair_heading(planner, planner->changes.cursor / HEADING_CELLS, states);

        if (result != REPAIR_DONE) {
            return result;
        }
    }
    return REPAIR_DONE;
}
