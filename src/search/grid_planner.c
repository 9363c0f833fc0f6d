#include "src/search/grid_edges.h"

#include <string.h>

#include "src/base/block.h"
#include "src/base/config_check.h"

enum {
    CELLS_PER_ENTRY = 8, /* of the smallest queue */
    ENTRIES_MIN = 64,
    POINTS_PER_SIDE = 2, /* turning points of a path for each row and column of the map */
    POINTS_MIN = 16,
    NODES_PER_UNIT = 64 /* cleared for a unit of the budget */
};

/* ---- Configuration and memory ---- */

static bool is_side_valid(uint16_t cells, jp_q16 resolution)
{
    return cells != 0U && cells <= JP_GRID_CELLS_MAX && (int64_t)cells * resolution <= JP_GRID_SIDE_MAX;
}

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_grid_planner_config, member, low, high)

static enum jp_status check(const struct jp_grid_planner_config *config, const struct jp_terrain_config *map,
                            const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(method, JP_GRID_OCTILE, JP_GRID_ANY_ANGLE),
        FIELD(clearance, 0, INT32_MAX),
        FIELD(tube, 1, JP_GRID_TUBE_MAX),
    };

    if (map->resolution < JP_GRID_RESOLUTION_MIN || !is_side_valid(map->width, map->resolution) ||
        !is_side_valid(map->height, map->resolution)) {
        return jp_config_refuse("resolution", field);
    }

    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status == JP_OK && config->clearance > (int64_t)JP_GRID_CLEARANCE_MAX * map->resolution) {
        return jp_config_refuse("clearance", field);
    }
    return status == JP_OK && config->prices != NULL && config->method == JP_GRID_JUMP_POINTS
               ? jp_config_refuse("method", field)
               : status;
}

static size_t plane_size(uint16_t row_cells, uint16_t rows)
{
    return jp_block_align(jp_grid_words(row_cells) * ((size_t)rows + 2U) * sizeof(uint32_t));
}

static size_t path_points(const struct jp_terrain_config *map)
{
    return POINTS_PER_SIDE * ((size_t)map->width + map->height) + POINTS_MIN;
}

/** Bytes of all but the queue. */
static size_t fixed_size(const struct jp_terrain_config *map)
{
    return (size_t)map->width * map->height * sizeof(struct jp_grid_node) + plane_size(map->width, map->height) +
           plane_size(map->height, map->width) + 2U * path_points(map) * sizeof(struct jp_point);
}

size_t jp_grid_planner_size(const struct jp_grid_planner_config *config, const struct jp_terrain_config *terrain)
{
    const char *field;

    if (config == NULL || terrain == NULL || check(config, terrain, &field) != JP_OK) {
        return 0;
    }
    const size_t cells = (size_t)terrain->width * terrain->height;
    const size_t entries = cells / CELLS_PER_ENTRY + ENTRIES_MIN;

    return fixed_size(terrain) + (entries < cells ? entries : cells) * sizeof(struct jp_grid_entry);
}

static void lay_out(struct jp_grid_planner_internal *planner, uint8_t *block, size_t size)
{
    const struct jp_terrain_config *map = &planner->terrain->config;
    const size_t cells = (size_t)map->width * map->height;
    const size_t spare = (size - fixed_size(map)) / sizeof(struct jp_grid_entry);
    size_t used = 0;

    planner->points_max = (uint32_t)path_points(map);
    planner->queue_max = (uint32_t)(spare < cells ? spare : cells);
    planner->row_words = (uint16_t)jp_grid_words(map->width);
    planner->column_words = (uint16_t)jp_grid_words(map->height);
    planner->nodes = (struct jp_grid_node *)(void *)block;
    used += cells * sizeof(struct jp_grid_node);
    planner->rows = (uint32_t *)(void *)&block[used];
    used += plane_size(map->width, map->height);
    planner->columns = (uint32_t *)(void *)&block[used];
    used += plane_size(map->height, map->width);
    planner->path.points = (struct jp_point *)(void *)&block[used];
    used += planner->points_max * sizeof(struct jp_point);
    planner->candidate.points = (struct jp_point *)(void *)&block[used];
    used += planner->points_max * sizeof(struct jp_point);
    planner->queue = (struct jp_grid_entry *)(void *)&block[used];
    planner->counts.bytes = (uint32_t)(fixed_size(map) + planner->queue_max * sizeof(struct jp_grid_entry));
}

enum jp_status jp_grid_planner_init(struct jp_grid_planner *planner, const struct jp_grid_planner_config *config,
                                    const struct jp_terrain *terrain, void *block, size_t size, const char **field)
{
    if (planner == NULL || config == NULL || terrain == NULL || block == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const enum jp_status status = check(config, &terrain->config, field);
    if (status != JP_OK) {
        return status;
    }
    if (!jp_block_is_aligned(block)) {
        return JP_ERR_ALIGNMENT;
    }
    if (size < jp_grid_planner_size(config, &terrain->config)) {
        return JP_ERR_MEMORY;
    }
    struct jp_grid_planner_internal *inner = &planner->internal;

    (void)memset(inner, 0, sizeof *inner);
    inner->config = *config;
    inner->terrain = terrain;
    inner->answer = JP_GRID_NO_TASK;
    if (!jp_grid_take_prices(inner)) {
        return jp_config_refuse("prices", field);
    }
    jp_grid_make_disc(inner);
    lay_out(inner, block, size);
    return JP_OK;
}

/* ---- Phases ---- */

/** The one place that assigns the phase. */
static void enter(struct jp_grid_planner_internal *planner, enum jp_grid_phase phase)
{
    planner->phase = phase;
    planner->cursor = 0;
    planner->cursor_part = 0;
}

/** Ends the work at any phase. */
static void finish(struct jp_grid_planner_internal *planner, enum jp_grid_answer answer)
{
    planner->answer = answer;
}

/** But for their rings. */
static bool clear_nodes(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    const uint32_t cells = jp_grid_cell_count(planner);
    const uint32_t kept = planner->is_priced ? GRID_RING_MASK : 0U;

    for (; *budget > 0U && planner->cursor < cells; --*budget) {
        for (unsigned i = 0; i < (unsigned)NODES_PER_UNIT && planner->cursor < cells; i++, planner->cursor++) {
            struct jp_grid_node *const node = &planner->nodes[planner->cursor];
            *node = (struct jp_grid_node){GRID_COST_MAX, node->place & kept};
        }
    }
    return planner->cursor == cells;
}

static void start_search(struct jp_grid_planner_internal *planner)
{
    enter(planner, JP_GRID_SEARCH);
    jp_grid_search_start(planner);
}

static void start_trace(struct jp_grid_planner_internal *planner)
{
    enter(planner, JP_GRID_TRACE);
    planner->cursor = (uint32_t)planner->goal.y * planner->terrain->config.width + (uint32_t)planner->goal.x;
    planner->place_cost = jp_grid_node(planner, planner->goal.x, planner->goal.y)->g;
}

static void start_tightening(struct jp_grid_planner_internal *planner, enum jp_grid_phase phase)
{
    enter(planner, phase);
    planner->cursor = 1;
    planner->passes = 0;
    planner->has_changed = false;
}

static void start_propagation(struct jp_grid_planner_internal *planner)
{
    enter(planner, JP_GRID_PROPAGATE);
    jp_grid_edges_start(planner);
}

static void start_descent(struct jp_grid_planner_internal *planner)
{
    enter(planner, JP_GRID_DESCEND);
    planner->place = (struct jp_point){planner->start.x * JP_Q16_ONE, planner->start.y * JP_Q16_ONE};
    planner->place_cost = jp_grid_node(planner, planner->start.x, planner->start.y)->g;
}

static void search(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    switch (jp_grid_search_work(planner, budget)) {
    case GRID_DONE:
        start_trace(planner);
        break;
    case GRID_IMPOSSIBLE:
        finish(planner, JP_GRID_UNREACHABLE);
        break;
    case GRID_FULL:
        finish(planner, JP_GRID_OUT_OF_MEMORY);
        break;
    case GRID_WORKING:
    default:
        break;
    }
}

static void leave_trace(struct jp_grid_planner_internal *planner)
{
    jp_grid_path_reverse(&planner->path);
    if (planner->config.method == JP_GRID_ANY_ANGLE) {
        start_tightening(planner, JP_GRID_TIGHTEN);
    } else {
        finish(planner, JP_GRID_FOUND);
    }
}

static void trace(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    const enum jp_grid_progress progress = jp_grid_path_trace(planner, budget);

    if (progress == GRID_DONE) {
        leave_trace(planner);
    } else if (progress == GRID_FULL) {
        finish(planner, JP_GRID_OUT_OF_MEMORY);
    } else {
        /* goes on in the next slice */
    }
}

/** Where the tube does not lead to the start, the path by shortcuts is the answer. */
static void propagate(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    const enum jp_grid_progress progress = jp_grid_edges_propagate(planner, budget);

    if (progress == GRID_DONE) {
        start_descent(planner);
    } else if (progress != GRID_WORKING) {
        finish(planner, JP_GRID_FOUND);
    } else {
        /* goes on in the next slice */
    }
}

static void descend(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    const enum jp_grid_progress progress = jp_grid_edges_descend(planner, budget);

    if (progress == GRID_DONE) {
        start_tightening(planner, JP_GRID_TIGHTEN_CANDIDATE);
    } else if (progress != GRID_WORKING) {
        finish(planner, JP_GRID_FOUND);
    } else {
        /* goes on in the next slice */
    }
}

/** The cheaper path is the answer. */
static void choose(struct jp_grid_planner_internal *planner)
{
    if (jp_grid_path_price(planner, &planner->candidate) < jp_grid_path_price(planner, &planner->path)) {
        const struct jp_grid_path path = planner->path;
        planner->path = planner->candidate;
        planner->candidate = path;
    }
    finish(planner, JP_GRID_FOUND);
}

static void work(struct jp_grid_planner_internal *planner, unsigned *budget)
{
    switch (planner->phase) {
    case JP_GRID_FILL_PLANES:
        if (jp_grid_fill_planes(planner, budget)) {
            planner->has_planes = true;
            enter(planner, planner->is_priced ? JP_GRID_MEASURE : JP_GRID_CLEAR);
        }
        break;
    case JP_GRID_MEASURE:
        if (jp_grid_measure(planner, budget)) {
            enter(planner, JP_GRID_MEASURE_BACK);
        }
        break;
    case JP_GRID_MEASURE_BACK:
        if (jp_grid_measure_back(planner, budget)) {
            planner->has_rings = true;
            enter(planner, JP_GRID_CLEAR);
        }
        break;
    case JP_GRID_CLEAR:
        if (clear_nodes(planner, budget)) {
            start_search(planner);
        }
        break;
    case JP_GRID_SEARCH:
        search(planner, budget);
        break;
    case JP_GRID_TRACE:
        trace(planner, budget);
        break;
    case JP_GRID_TIGHTEN:
        if (jp_grid_path_tighten(planner, &planner->path, budget) == GRID_DONE) {
            enter(planner, JP_GRID_CLEAR_AGAIN);
        }
        break;
    case JP_GRID_CLEAR_AGAIN:
        if (clear_nodes(planner, budget)) {
            enter(planner, JP_GRID_MARK);
        }
        break;
    case JP_GRID_MARK:
        if (jp_grid_edges_mark(planner, budget) == GRID_DONE) {
            start_propagation(planner);
        }
        break;
    case JP_GRID_PROPAGATE:
        propagate(planner, budget);
        break;
    case JP_GRID_DESCEND:
        descend(planner, budget);
        break;
    case JP_GRID_TIGHTEN_CANDIDATE:
    default:
        if (jp_grid_path_tighten(planner, &planner->candidate, budget) == GRID_DONE) {
            choose(planner);
        }
        break;
    }
}

enum jp_grid_answer jp_grid_planner_work(struct jp_grid_planner *planner, unsigned expansions)
{
    struct jp_grid_planner_internal *inner = &planner->internal;
    unsigned budget = expansions;

    if (inner->answer == JP_GRID_SEARCHING && inner->version != inner->terrain->version) {
        finish(inner, JP_GRID_STALE);
    }
    while (budget > 0U && inner->answer == JP_GRID_SEARCHING) {
        work(inner, &budget);
    }
    return inner->answer;
}

/* ---- Task ---- */

static enum jp_status check_cell(const struct jp_grid_planner_internal *planner, const struct jp_grid_cell *cell)
{
    if (!jp_terrain_contains(planner->terrain, cell->x, cell->y)) {
        return JP_ERR_OUTSIDE;
    }
    return jp_terrain_is_clear(planner->terrain, planner->disc, planner->disc_rows, cell->x, cell->y) ? JP_OK
                                                                                                      : JP_ERR_BLOCKED;
}

/** Begins with the bit planes where they show an older map, or the rings are not whole. */
static void begin(struct jp_grid_planner_internal *planner)
{
    const bool has_rings = planner->has_rings || !planner->is_priced;

    planner->answer = JP_GRID_SEARCHING;
    if (planner->has_planes && has_rings && planner->version == planner->terrain->version) {
        enter(planner, JP_GRID_CLEAR);
    } else {
        planner->has_planes = false;
        planner->has_rings = false;
        planner->version = planner->terrain->version;
        enter(planner, JP_GRID_FILL_PLANES);
    }
}

enum jp_status jp_grid_planner_start(struct jp_grid_planner *planner, const struct jp_grid_cell *start,
                                     const struct jp_grid_cell *goal)
{
    if (planner == NULL || start == NULL || goal == NULL) {
        return JP_ERR_ARGUMENT;
    }
    struct jp_grid_planner_internal *inner = &planner->internal;
    const enum jp_status start_status = check_cell(inner, start);
    const enum jp_status status = start_status != JP_OK ? start_status : check_cell(inner, goal);

    if (status != JP_OK) {
        return status;
    }
    inner->start = *start;
    inner->goal = *goal;
    inner->counts = (struct jp_grid_counts){.bytes = inner->counts.bytes};
    inner->path.count = 0;
    inner->candidate.count = 0;
    begin(inner);
    return JP_OK;
}

/* ---- What is known ---- */

const struct jp_point *jp_grid_planner_path(const struct jp_grid_planner *planner, size_t *count)
{
    const struct jp_grid_planner_internal *inner = &planner->internal;
    const bool has_path = inner->answer == JP_GRID_FOUND;

    *count = has_path ? inner->path.count : 0U;
    return has_path ? inner->path.points : NULL;
}

/** Of the whole rise of a path, J in Q32. */
static int64_t price_of_rise(const struct jp_grid_planner_internal *planner, const struct jp_grid_path *path)
{
    const int64_t first = jp_terrain_height(planner->terrain, &path->points[0]);
    const int64_t last = jp_terrain_height(planner->terrain, &path->points[path->count - 1U]);

    return (last - first) * planner->rise;
}

jp_energy jp_grid_planner_price(const struct jp_grid_planner *planner)
{
    const struct jp_grid_planner_internal *inner = &planner->internal;

    if (inner->answer != JP_GRID_FOUND || !inner->is_priced) {
        return 0;
    }
    const uint64_t metres = jp_grid_path_price(inner, &inner->path) >> 8; /* level ones, Q16 */
    const uint64_t most = (uint64_t)INT64_MAX / 2U / (uint64_t)inner->metre;

    return (int64_t)(metres < most ? metres : most) * inner->metre + price_of_rise(inner, &inner->path);
}

const struct jp_grid_counts *jp_grid_planner_statistics(const struct jp_grid_planner *planner)
{
    return &planner->internal.counts;
}

jp_q16 jp_grid_planner_resolution(const struct jp_grid_planner *planner)
{
    return planner->internal.terrain->config.resolution;
}

bool jp_grid_planner_line_is_free(const struct jp_grid_planner *planner, const struct jp_point *from,
                                  const struct jp_point *to)
{
    return jp_grid_line_is_free(&planner->internal, from, to);
}
