/** Where the scout may meet the head of the plan that it splices. */
#ifndef JOULEPATH_SEARCH_PLANNER_HEAD_H
#define JOULEPATH_SEARCH_PLANNER_HEAD_H

#include <joulepath/planner.h>

/** True when a state is the first one of the head or one of its last, which has its junction there then. Work: at most
 * 34 comparisons. */
static inline bool jp_planner_head_has(struct jp_planner_head *head, uint32_t id)
{
    head->junction_step = 0;
    if (id == head->start_id) {
        return true;
    }
    for (uint32_t step = head->first_step; step <= head->steps; step++) {
        if (head->ids[step - head->first_step] == id) {
            head->junction_step = step;
            return true;
        }
    }
    return false;
}

#endif
