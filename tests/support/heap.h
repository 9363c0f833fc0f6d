/** A binary heap that grows, least key first, for the searches that the planners are judged by. An entry that becomes
 *  cheaper is pushed again; the caller passes over the old one. Ends the program when there is no memory. */
#ifndef JOULEPATH_TESTS_SUPPORT_HEAP_H
#define JOULEPATH_TESTS_SUPPORT_HEAP_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

struct heap_entry {
    double key;
    uint32_t id;
};

/** Begins as {0}. */
struct heap {
    struct heap_entry *entries; /**< to be freed by the caller */
    size_t count;
    size_t capacity;
};

static inline void heap_push(struct heap *heap, double key, uint32_t id)
{
    if (heap->count == heap->capacity) {
        heap->capacity = heap->capacity == 0 ? 1024 : 2 * heap->capacity;
        heap->entries = realloc(heap->entries, heap->capacity * sizeof *heap->entries);
        if (heap->entries == NULL) {
            (void)fprintf(stderr, "heap: no memory\n");
            exit(1);
        }
    }
    size_t at = heap->count++;
    for (; at > 0 && heap->entries[(at - 1) / 2].key > key; at = (at - 1) / 2) {
        heap->entries[at] = heap->entries[(at - 1) / 2];
    }
    heap->entries[at] = (struct heap_entry){key, id};
}

/** The heap is not empty. */
static inline struct heap_entry heap_pop(struct heap *heap)
{
    const struct heap_entry top = heap->entries[0];
    const struct heap_entry last = heap->entries[--heap->count];
    size_t at = 0;

    for (size_t child = 1; child < heap->count; child = 2 * at + 1) {
        child += child + 1 < heap->count && heap->entries[child + 1].key < heap->entries[child].key;
        if (heap->entries[child].key >= last.key) {
            break;
        }
        heap->entries[at] = heap->entries[child];
        at = child;
    }
    heap->entries[at] = last;
    return top;
}

#endif
