#include "src/search/planner_states.h"

#include <string.h>

enum {
    BUCKETS_MIN = 64,
    BUCKETS_MAX = 1024,
    STATES_PER_BUCKET = 16,
    LOAD_NUMERATOR = 11, /* largest load factor: above it a look-up of an absent state takes too many probes */
    LOAD_DENOMINATOR = 12,
    ID_MASK = 0xFFFFFFF
};

static bool is_prime(uint32_t n)
{
    for (uint32_t divisor = 2; divisor <= n / divisor; divisor++) {
        if (n % divisor == 0U) {
            return false;
        }
    }
    return n > 1U;
}

static uint32_t bucket_count_for(uint32_t slots)
{
    uint32_t count = BUCKETS_MIN;

    while (count < BUCKETS_MAX && count * STATES_PER_BUCKET < slots) {
        count *= 2;
    }
    return count;
}

/** Slots that hold `count` states. */
static uint32_t slots_for(uint32_t count)
{
    uint32_t slots = count * LOAD_DENOMINATOR / LOAD_NUMERATOR + 1;

    while (!is_prime(slots)) {
        slots++;
    }
    return slots;
}

size_t jp_planner_states_size(uint32_t count)
{
    const uint32_t slots = slots_for(count);

    return slots * sizeof(struct jp_planner_state) + bucket_count_for(slots) * sizeof(uint32_t);
}

/** Most states that a search can meet: work over the table grows with the map, not with the block. */
static uint32_t states_of(const struct jp_terrain_config *map)
{
    const uint32_t states = (uint32_t)map->width * map->height * JP_HEADINGS;

    return states < JP_PLANNER_STATES_MAX ? states : JP_PLANNER_STATES_MAX;
}

size_t jp_planner_states_init(struct jp_planner_search *search, const struct jp_terrain_config *map, void *block,
                              size_t size)
{
    const size_t most = slots_for(states_of(map));
    size_t slots = size / sizeof(struct jp_planner_state);

    if (slots > most) {
        slots = most;
    }
    search->bucket_count = bucket_count_for((uint32_t)slots);
    const size_t bucket_bytes = search->bucket_count * sizeof(uint32_t);
    if (slots * sizeof(struct jp_planner_state) + bucket_bytes > size) {
        slots = (size - bucket_bytes) / sizeof(struct jp_planner_state);
    }
    search->states = block;
    search->slot_count = (uint32_t)slots;
    while (!is_prime(search->slot_count)) {
        search->slot_count--;
    }
    search->buckets = (uint32_t *)(void *)&search->states[search->slot_count];
    search->state_count_max = search->slot_count * LOAD_NUMERATOR / LOAD_DENOMINATOR;
    return search->slot_count * sizeof(struct jp_planner_state) + bucket_bytes;
}

bool jp_planner_states_clear(struct jp_planner_search *search, unsigned *slots)
{
    const uint32_t left = search->slot_count - search->clear_slot;
    const uint32_t count = *slots < left ? *slots : left;

    (void)memset(&search->states[search->clear_slot], 0, count * sizeof *search->states);
    search->state_count = 0;
    search->clear_slot += count;
    *slots -= count;
    return search->clear_slot == search->slot_count;
}

/** Hash that spreads all bits of the id over 32 bits. */
static uint32_t hash(uint32_t id)
{
    uint32_t bits = id * 0x9E3779B1U;

    bits ^= bits >> 15;
    return bits * 0x85EBCA77U;
}

/** Slot of the state or the free slot where it belongs. */
static uint32_t probe(const struct jp_planner_search *search, uint32_t id)
{
    const uint32_t bits = hash(id);
    const uint32_t count = search->slot_count;
    const uint32_t step = 1U + (bits & 0x3FFU) % (count - 1U);
    uint32_t slot = (uint32_t)(((uint64_t)bits * count) >> 32);

    while (jp_planner_state_is_used(&search->states[slot]) && search->states[slot].id != id) {
        slot += step;
        if (slot >= count) {
            slot -= count;
        }
    }
    return slot;
}

uint32_t jp_planner_states_find(const struct jp_planner_search *search, uint32_t id)
{
    const uint32_t slot = probe(search, id);

    return jp_planner_state_is_used(&search->states[slot]) ? slot : NO_SLOT;
}

uint32_t jp_planner_states_add(struct jp_planner_search *search, uint32_t id)
{
    const uint32_t slot = probe(search, id);
    struct jp_planner_state *state = &search->states[slot];

    if (jp_planner_state_is_used(state)) {
        return slot;
    }
    if (search->state_count == search->state_count_max) {
        return NO_SLOT;
    }
    search->state_count++;
    state->id = id & ID_MASK;
    state->previous = NO_SLOT;
    state->next = NO_SLOT;
    state->g = JP_COST_MAX;
    state->rhs = JP_COST_MAX;
    return slot;
}

void jp_planner_queue_restart(struct jp_planner_search *search, uint32_t range)
{
    for (uint32_t i = 0; i < search->bucket_count; i++) {
        search->buckets[i] = NO_SLOT;
    }
    search->lowest_bucket = search->bucket_count;
    search->bucket_shift = 0;
    while (range >> search->bucket_shift >= search->bucket_count - 1U) {
        search->bucket_shift++;
    }
}

static void take_out(struct jp_planner_search *search, struct jp_planner_state *state)
{
    if (state->previous == NO_SLOT) {
        search->buckets[state->bucket] = (uint32_t)state->next;
    } else {
        search->states[state->previous].next = state->next;
    }
    if (state->next != NO_SLOT) {
        search->states[state->next].previous = state->previous;
    }
    state->queued = 0;
}

void jp_planner_queue_remove(struct jp_planner_search *search, uint32_t slot)
{
    if (search->states[slot].queued) {
        take_out(search, &search->states[slot]);
    }
}

void jp_planner_queue_put(struct jp_planner_search *search, uint32_t slot, uint32_t key)
{
    struct jp_planner_state *state = &search->states[slot];
    const uint32_t last = search->bucket_count - 1U;
    uint32_t bucket = key >> search->bucket_shift;

    if (bucket > last) {
        bucket = last;
    }
    if (state->queued) {
        if (state->bucket == bucket) {
            return;
        }
        take_out(search, state);
    }
    const uint32_t head = search->buckets[bucket];
    state->queued = 1;
    state->bucket = bucket & (BUCKETS_MAX - 1);
    state->previous = NO_SLOT;
    state->next = head & NO_SLOT;
    if (head != NO_SLOT) {
        search->states[head].previous = slot & NO_SLOT;
    }
    search->buckets[bucket] = slot;
    if (bucket < search->lowest_bucket) {
        search->lowest_bucket = bucket;
    }
}

uint32_t jp_planner_queue_top(struct jp_planner_search *search)
{
    while (search->lowest_bucket < search->bucket_count && search->buckets[search->lowest_bucket] == NO_SLOT) {
        search->lowest_bucket++;
    }
    return search->lowest_bucket < search->bucket_count ? search->buckets[search->lowest_bucket] : NO_SLOT;
}

uint32_t jp_planner_queue_lowest_key(const struct jp_planner_search *search)
{
    return search->lowest_bucket << search->bucket_shift;
}

bool jp_planner_queue_is_beyond_range(const struct jp_planner_search *search)
{
    return search->lowest_bucket == search->bucket_count - 1U;
}
