#include "src/search/planner_rehearsal.h"

#include "src/search/planner_layout.h"

/** The largest power of two below a size. */
static size_t part_of(size_t size)
{
    size_t part = 1;

    while (part < size - part) {
        part *= 2U;
    }
    return part;
}

static size_t next_size(const struct jp_planner_internal *planner)
{
    return part_of(jp_rehearsal_is_on(planner) ? planner->rehearsal.size : planner->block_size);
}

void jp_rehearsal_end(struct jp_planner_internal *planner)
{
    if (jp_rehearsal_is_on(planner)) {
        planner->rehearsal.size = 0;
        planner->is_field_rooted = false;
        planner->has_turn_field = false;
        planner->search.direction = JP_PLANNER_FROM_GOAL;
        jp_layout_divide(planner, planner->block_size);
    }
}

static void begin(struct jp_planner_internal *planner, size_t size)
{
    planner->lent = JP_PLANNER_LENT_TO_REHEARSALS;
    planner->rehearsal = (struct jp_planner_rehearsal){.size = size};
    planner->has_turn_field = false;
    jp_layout_divide(planner, size);
    planner->search.level = 0;
    planner->search.epsilon = planner->config.epsilon[0];
}

bool jp_rehearsal_next(struct jp_planner_internal *planner)
{
    const size_t size = next_size(planner);

    if (size < jp_planner_size(&planner->terrain->config)) {
        jp_rehearsal_end(planner);
        return false;
    }
    begin(planner, size);
    return true;
}
