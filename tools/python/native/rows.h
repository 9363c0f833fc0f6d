/** What a drive leaves, row by row, in memory that grows. */
#ifndef JOULEPATH_PYTHON_ROWS_H
#define JOULEPATH_PYTHON_ROWS_H

#include <stdbool.h>
#include <stddef.h>

struct rows {
    size_t size; /**< of a row, bytes; set by the caller */
    void *first;
    size_t count;
    size_t room;
    bool has_lost; /**< there was no memory for one of them */
};

void rows_add(struct rows *rows, const void *row);

void rows_free(struct rows *rows);

#endif
