/** The states of a planner: an open-addressed hash table, and the open list as doubly linked bucket lists within it. */
#ifndef JOULEPATH_SEARCH_PLANNER_STATES_H
#define JOULEPATH_SEARCH_PLANNER_STATES_H

#include <joulepath/planner.h>

/** No slot, in links and results. */
#define NO_SLOT ((uint32_t)0xFFFFF)

/** A state of the search: 16 bytes. A slot that is not used is all zero. */
struct jp_planner_state {
    uint64_t id : 28; /**< cell · JP_HEADINGS + heading */
    uint64_t queued : 1;
    uint64_t closed : 1; /**< expanded under this ε; not again before the next */
    uint64_t bucket : 10;
    uint64_t g : 24; /**< cost at its last expansion, as in D* Lite */
    uint64_t previous : 20;
    uint64_t next : 20;
    uint64_t rhs : 24; /**< one-step lookahead cost over its neighbours; consistent: g = rhs */
};

/** True for a slot that holds a state: in a list, or out of it, its links are not both zero. */
static inline bool jp_planner_state_is_used(const struct jp_planner_state *state)
{
    return state->next != 0U || state->previous != 0U;
}

/** Lays out at most `size` bytes as slots and buckets of a search on a map; returns how many it takes. */
size_t jp_planner_states_init(struct jp_planner_search *search, const struct jp_terrain_config *map, void *block,
                              size_t size);

/** Bytes that `count` states need, everything counted. */
size_t jp_planner_states_size(uint32_t count);

/** Forgets the states of the next *slots slots, from clear_slot on; *slots counts down. True when none is left. */
bool jp_planner_states_clear(struct jp_planner_search *search, unsigned *slots);

/** Slot of a state, or NO_SLOT. */
uint32_t jp_planner_states_find(const struct jp_planner_search *search, uint32_t id);

/** Slot of a state, which is added with infinite costs if it is absent; NO_SLOT when the table is full. */
uint32_t jp_planner_states_add(struct jp_planner_search *search, uint32_t id);

/** Empties the queue, for keys of 0…range. jp_search_rekey_work() puts the states into it again. */
void jp_planner_queue_restart(struct jp_planner_search *search, uint32_t range);

/** Puts a state into the queue, or moves it to its new bucket. */
void jp_planner_queue_put(struct jp_planner_search *search, uint32_t slot, uint32_t key);

/** Takes a state out of the queue if it is in. */
void jp_planner_queue_remove(struct jp_planner_search *search, uint32_t slot);

/** Slot of a state in the lowest bucket; NO_SLOT when the queue is empty. */
uint32_t jp_planner_queue_top(struct jp_planner_search *search);

/** No key in the queue is below it; valid after jp_planner_queue_top(). */
uint32_t jp_planner_queue_lowest_key(const struct jp_planner_search *search);

/** True when only the last bucket is left, which holds all keys beyond the range: the queue needs a wider range. */
bool jp_planner_queue_is_beyond_range(const struct jp_planner_search *search);

#endif
