#include "src/search/grid_queue.h"

enum { ROW_SHIFT = 16 };

static struct jp_grid_node *node_of(const struct jp_grid_planner_internal *planner, uint32_t cell)
{
    return jp_grid_node(planner, (int32_t)(cell & UINT16_MAX), (int32_t)(cell >> ROW_SHIFT));
}

/** Of two entries with equal keys the one with the greater cost is nearer to the target. */
static bool is_before(const struct jp_grid_planner_internal *planner, const struct jp_grid_entry *a,
                      const struct jp_grid_entry *b)
{
    if (a->key != b->key) {
        return a->key < b->key;
    }
    const uint32_t g_a = node_of(planner, a->cell)->g;
    const uint32_t g_b = node_of(planner, b->cell)->g;

    return g_a != g_b ? g_a > g_b : a->cell < b->cell;
}

static void place(struct jp_grid_planner_internal *planner, uint32_t index, struct jp_grid_entry entry)
{
    struct jp_grid_node *node = node_of(planner, entry.cell);

    planner->queue[index] = entry;
    node->place = (node->place & ~GRID_ENTRY_MASK) | (index + 1U);
}

static void lift(struct jp_grid_planner_internal *planner, uint32_t index, struct jp_grid_entry entry)
{
    while (index > 0U && is_before(planner, &entry, &planner->queue[(index - 1U) / 2U])) {
        place(planner, index, planner->queue[(index - 1U) / 2U]);
        index = (index - 1U) / 2U;
    }
    place(planner, index, entry);
}

/** The child of an entry that comes first; an entry without children has queue_count or more. */
static uint32_t first_child(const struct jp_grid_planner_internal *planner, uint32_t index)
{
    const uint32_t left = 2U * index + 1U;
    const uint32_t right = left + 1U;

    return right < planner->queue_count && is_before(planner, &planner->queue[right], &planner->queue[left]) ? right
                                                                                                             : left;
}

static void sink(struct jp_grid_planner_internal *planner, uint32_t index, struct jp_grid_entry entry)
{
    uint32_t child = first_child(planner, index);

    while (child < planner->queue_count && is_before(planner, &planner->queue[child], &entry)) {
        place(planner, index, planner->queue[child]);
        index = child;
        child = first_child(planner, index);
    }
    place(planner, index, entry);
}

bool jp_grid_queue_put(struct jp_grid_planner_internal *planner, int32_t x, int32_t y, uint32_t estimate)
{
    const struct jp_grid_node *node = jp_grid_node(planner, x, y);
    const struct jp_grid_entry entry = {node->g + estimate, ((uint32_t)y << ROW_SHIFT) | (uint32_t)x};
    uint32_t index = node->place & GRID_ENTRY_MASK;

    if (index == 0U) {
        if (planner->queue_count == planner->queue_max) {
            return false;
        }
        planner->queue_count++;
        index = planner->queue_count;
        if (planner->queue_count > planner->counts.queue_most) {
            planner->counts.queue_most = planner->queue_count;
        }
    }
    lift(planner, index - 1U, entry);
    return true;
}

bool jp_grid_queue_take(struct jp_grid_planner_internal *planner, int32_t *x, int32_t *y)
{
    if (planner->queue_count == 0U) {
        return false;
    }
    const uint32_t cell = planner->queue[0].cell;

    *x = (uint16_t)cell;
    *y = (uint16_t)(cell >> ROW_SHIFT);
    node_of(planner, cell)->place &= ~GRID_ENTRY_MASK;
    planner->queue_count--;
    if (planner->queue_count > 0U) {
        sink(planner, 0, planner->queue[planner->queue_count]);
    }
    return true;
}
