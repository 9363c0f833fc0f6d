#include "grid_edges.h"

#include <string.h>

enum {
    ALIGNMENT = 8,
    CELLS_PER_ENTRY = 8, /* of the smallest queue */
    ENTRIES_MIN = 64,
    POINTS_PER_SIDE = 2, /* of a way, for each row and column */
    POINTS_MIN = 16,
    NODES_PER_UNIT = 64 /* cleared */
};

enum grid_phase {
    NO_TASK,
    PLANES,
    CLEAR,
    SEARCH,
    TRACE,
    TIGHTEN,
    CLEAR_AGAIN,
    MARK,
    SPREAD,
    DESCEND,
    TIGHTEN_OTHER,
    FOUND,
    UNREACHABLE,
    OUT_OF_MEMORY,
    STALE
};

/* ---- Configuration and memory ---- */

static bool is_side_valid(uint16_t cells, jp_q16 resolution)
{
    return cells != 0U && cells <= JP_TERRAIN_SIDE_MAX && (int64_t)cells * resolution <= JP_GRID_SIDE_MAX;
}

static const char *field_out_of_range(const struct jp_grid_planner_config *config, const struct jp_terrain_config *map)
{
    if (map->resolution < JP_GRID_RESOLUTION_MIN || !is_side_valid(map->width, map->resolution) ||
        !is_side_valid(map->height, map->resolution)) {
        return "resolution";
    }
    if (config->method != JP_GRID_OCTILE && config->method != JP_GRID_JUMP_POINTS &&
        config->method != JP_GRID_ANY_ANGLE) {
        return "method";
    }
    if (config->clearance < 0 || config->clearance > (int64_t)JP_GRID_CLEARANCE_MAX * map->resolution) {
        return "clearance";
    }
    return config->tube == 0U || (int32_t)config->tube > JP_GRID_TUBE_MAX ? "tube" : NULL;
}

static size_t align(size_t size)
{
    return (size + ALIGNMENT - 1U) / ALIGNMENT * ALIGNMENT;
}

static size_t plane_size(uint16_t row_cells, uint16_t rows)
{
    return align(jp_grid_words(row_cells) * ((size_t)rows + 2U) * sizeof(uint32_t));
}

static size_t way_points(const struct jp_terrain_config *map)
{
    return POINTS_PER_SIDE * ((size_t)map->width + map->height) + POINTS_MIN;
}

/** Bytes of all but the queue. */
static size_t fixed_size(const struct jp_terrain_config *map)
{
    return (size_t)map->width * map->height * sizeof(struct jp_grid_node) + plane_size(map->width, map->height) +
           plane_size(map->height, map->width) + 2U * way_points(map) * sizeof(struct jp_path_point);
}

size_t jp_grid_planner_size(const struct jp_grid_planner_config *config, const struct jp_terrain_config *terrain)
{
    if (config == NULL || terrain == NULL || field_out_of_range(config, terrain) != NULL) {
        return 0;
    }
    const size_t cells = (size_t)terrain->width * terrain->height;
    const size_t entries = cells / CELLS_PER_ENTRY + ENTRIES_MIN;

    return fixed_size(terrain) + (entries < cells ? entries : cells) * sizeof(struct jp_grid_entry);
}

static void lay_out(struct jp_grid_planner *planner, uint8_t *block, size_t size)
{
    const struct jp_terrain_config *map = &planner->terrain->config;
    const size_t cells = (size_t)map->width * map->height;
    const size_t spare = (size - fixed_size(map)) / sizeof(struct jp_grid_entry);
    size_t used = 0;

    planner->points_max = (uint32_t)way_points(map);
    planner->queue_max = (uint32_t)(spare < cells ? spare : cells);
    planner->row_words = (uint16_t)jp_grid_words(map->width);
    planner->column_words = (uint16_t)jp_grid_words(map->height);
    planner->nodes = (struct jp_grid_node *)(void *)block;
    used += cells * sizeof(struct jp_grid_node);
    planner->rows = (uint32_t *)(void *)&block[used];
    used += plane_size(map->width, map->height);
    planner->columns = (uint32_t *)(void *)&block[used];
    used += plane_size(map->height, map->width);
    planner->way.points = (struct jp_path_point *)(void *)&block[used];
    used += planner->points_max * sizeof(struct jp_path_point);
    planner->other.points = (struct jp_path_point *)(void *)&block[used];
    used += planner->points_max * sizeof(struct jp_path_point);
    planner->queue = (struct jp_grid_entry *)(void *)&block[used];
    planner->counts.bytes = (uint32_t)(fixed_size(map) + planner->queue_max * sizeof(struct jp_grid_entry));
}

enum jp_status jp_grid_planner_init(struct jp_grid_planner *planner, const struct jp_grid_planner_config *config,
                                    const struct jp_terrain *terrain, void *block, size_t size, const char **field)
{
    if (planner == NULL || config == NULL || terrain == NULL || block == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *field = field_out_of_range(config, &terrain->config);
    if (*field != NULL) {
        return JP_ERR_CONFIG;
    }
    if ((uintptr_t)block % ALIGNMENT != 0U) {
        return JP_ERR_ALIGNMENT;
    }
    if (size < jp_grid_planner_size(config, &terrain->config)) {
        return JP_ERR_MEMORY;
    }
    (void)memset(planner, 0, sizeof *planner);
    planner->config = *config;
    planner->terrain = terrain;
    planner->length_max = (uint32_t)JP_GRID_LENGTH_MAX * GRID_STRAIGHT;
    jp_grid_make_disc(planner);
    lay_out(planner, block, size);
    return JP_OK;
}

/* ---- Task ---- */

static enum jp_status check_cell(const struct jp_grid_planner *planner, const struct jp_grid_cell *cell)
{
    if (!jp_terrain_contains(planner->terrain, cell->x, cell->y)) {
        return JP_ERR_OUTSIDE;
    }
    return jp_terrain_is_clear(planner->terrain, planner->disc, planner->disc_rows, cell->x, cell->y) ? JP_OK
                                                                                                      : JP_ERR_BLOCKED;
}

static void enter(struct jp_grid_planner *planner, enum grid_phase phase)
{
    planner->phase = (uint8_t)phase;
    planner->cursor = 0;
    planner->cursor_part = 0;
}

enum jp_status jp_grid_planner_set_task(struct jp_grid_planner *planner, const struct jp_grid_cell *start,
                                        const struct jp_grid_cell *goal)
{
    if (planner == NULL || start == NULL || goal == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const enum jp_status start_status = check_cell(planner, start);
    const enum jp_status status = start_status != JP_OK ? start_status : check_cell(planner, goal);

    if (status != JP_OK) {
        return status;
    }
    const uint32_t bytes = planner->counts.bytes;

    planner->start = *start;
    planner->goal = *goal;
    planner->counts = (struct jp_grid_counts){.bytes = bytes};
    planner->way.count = 0;
    planner->other.count = 0;
    if (planner->has_planes && planner->version == planner->terrain->version) {
        enter(planner, CLEAR);
    } else {
        planner->has_planes = false;
        planner->version = planner->terrain->version;
        enter(planner, PLANES);
    }
    return JP_OK;
}

/* ---- Phases ---- */

static bool clear_nodes(struct jp_grid_planner *planner, unsigned *budget)
{
    const uint32_t cells = jp_grid_cell_count(planner);

    for (; *budget > 0U && planner->cursor < cells; --*budget) {
        for (unsigned i = 0; i < (unsigned)NODES_PER_UNIT && planner->cursor < cells; i++, planner->cursor++) {
            planner->nodes[planner->cursor] = (struct jp_grid_node){GRID_COST_MAX, 0};
        }
    }
    return planner->cursor == cells;
}

static void start_search(struct jp_grid_planner *planner)
{
    enter(planner, SEARCH);
    jp_grid_search_start(planner);
}

static void start_trace(struct jp_grid_planner *planner)
{
    enter(planner, TRACE);
    planner->cursor = (uint32_t)planner->goal.y * planner->terrain->config.width + (uint32_t)planner->goal.x;
    planner->place_cost = jp_grid_node(planner, planner->goal.x, planner->goal.y)->g;
}

static void start_tightening(struct jp_grid_planner *planner, enum grid_phase phase)
{
    enter(planner, phase);
    planner->cursor = 1;
    planner->passes = 0;
    planner->has_changed = false;
}

static void finish_trace(struct jp_grid_planner *planner)
{
    jp_grid_way_reverse(&planner->way);
    if (planner->config.method == JP_GRID_ANY_ANGLE) {
        start_tightening(planner, TIGHTEN);
    } else {
        enter(planner, FOUND);
    }
}

static void start_spread(struct jp_grid_planner *planner)
{
    enter(planner, SPREAD);
    jp_grid_edges_start(planner);
}

static void start_descent(struct jp_grid_planner *planner)
{
    enter(planner, DESCEND);
    planner->place = (struct jp_path_point){planner->start.x * JP_Q16_ONE, planner->start.y * JP_Q16_ONE};
    planner->place_cost = jp_grid_node(planner, planner->start.x, planner->start.y)->g;
}

/** The shorter way is the answer. */
static void choose(struct jp_grid_planner *planner)
{
    if (jp_grid_way_length(&planner->other) < jp_grid_way_length(&planner->way)) {
        const struct jp_grid_way way = planner->way;
        planner->way = planner->other;
        planner->other = way;
    }
    enter(planner, FOUND);
}

static void search(struct jp_grid_planner *planner, unsigned *budget)
{
    const enum jp_grid_progress progress = jp_grid_search_work(planner, budget);

    if (progress == GRID_DONE) {
        start_trace(planner);
    } else if (progress == GRID_IMPOSSIBLE) {
        enter(planner, UNREACHABLE);
    } else if (progress == GRID_FULL) {
        enter(planner, OUT_OF_MEMORY);
    } else {
        /* goes on in the next slice */
    }
}

/** The phases of the edges. Where they lead to nothing, the way by shortcuts is the answer. */
static enum jp_grid_progress work_on_edges(struct jp_grid_planner *planner, unsigned *budget)
{
    switch (planner->phase) {
    case MARK:
        return jp_grid_edges_mark(planner, budget);
    case SPREAD:
        return jp_grid_edges_spread(planner, budget);
    case DESCEND:
        return jp_grid_edges_descend(planner, budget);
    default:
        return jp_grid_way_tighten(planner, &planner->other, budget);
    }
}

static void improve(struct jp_grid_planner *planner, unsigned *budget)
{
    const enum jp_grid_progress progress = work_on_edges(planner, budget);

    if (progress == GRID_WORKING) {
        return;
    }
    if (progress != GRID_DONE) {
        enter(planner, FOUND);
    } else if (planner->phase == (uint8_t)MARK) {
        start_spread(planner);
    } else if (planner->phase == (uint8_t)SPREAD) {
        start_descent(planner);
    } else if (planner->phase == (uint8_t)DESCEND) {
        start_tightening(planner, TIGHTEN_OTHER);
    } else {
        choose(planner);
    }
}

static void trace(struct jp_grid_planner *planner, unsigned *budget)
{
    const enum jp_grid_progress progress = jp_grid_way_trace(planner, budget);

    if (progress == GRID_DONE) {
        finish_trace(planner);
    } else if (progress == GRID_FULL) {
        enter(planner, OUT_OF_MEMORY);
    } else {
        /* goes on in the next slice */
    }
}

static void work_on_phase(struct jp_grid_planner *planner, unsigned *budget)
{
    switch (planner->phase) {
    case PLANES:
        if (jp_grid_fill_planes(planner, budget)) {
            planner->has_planes = true;
            enter(planner, CLEAR);
        }
        break;
    case CLEAR:
        if (clear_nodes(planner, budget)) {
            start_search(planner);
        }
        break;
    case SEARCH:
        search(planner, budget);
        break;
    case TRACE:
        trace(planner, budget);
        break;
    case TIGHTEN:
        if (jp_grid_way_tighten(planner, &planner->way, budget) == GRID_DONE) {
            enter(planner, CLEAR_AGAIN);
        }
        break;
    case CLEAR_AGAIN:
        if (clear_nodes(planner, budget)) {
            enter(planner, MARK);
        }
        break;
    default:
        improve(planner, budget);
        break;
    }
}

static enum jp_grid_answer answer(const struct jp_grid_planner *planner)
{
    switch (planner->phase) {
    case NO_TASK:
        return JP_GRID_NO_TASK;
    case FOUND:
        return JP_GRID_FOUND;
    case UNREACHABLE:
        return JP_GRID_UNREACHABLE;
    case OUT_OF_MEMORY:
        return JP_GRID_OUT_OF_MEMORY;
    case STALE:
        return JP_GRID_STALE;
    default:
        return JP_GRID_SEARCHING;
    }
}

enum jp_grid_answer jp_grid_planner_work(struct jp_grid_planner *planner, unsigned expansions)
{
    unsigned budget = expansions;

    if (answer(planner) == JP_GRID_SEARCHING && planner->version != planner->terrain->version) {
        enter(planner, STALE);
    }
    while (budget > 0U && answer(planner) == JP_GRID_SEARCHING) {
        work_on_phase(planner, &budget);
    }
    return answer(planner);
}

const struct jp_path_point *jp_grid_planner_path(const struct jp_grid_planner *planner, size_t *count)
{
    const bool has_way = planner->phase == (uint8_t)FOUND;

    *count = has_way ? planner->way.count : 0U;
    return has_way ? planner->way.points : NULL;
}

const struct jp_grid_counts *jp_grid_planner_statistics(const struct jp_grid_planner *planner)
{
    return &planner->counts;
}
