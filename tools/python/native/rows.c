#include "tools/python/native/rows.h"

#include <stdlib.h>
#include <string.h>

#define ROOM_FIRST 1024

static bool make_room(struct rows *rows)
{
    const size_t room = rows->room > 0 ? 2 * rows->room : ROOM_FIRST;
    void *grown = reallocarray(rows->first, room, rows->size);

    if (grown == NULL) {
        return false;
    }
    rows->first = grown;
    rows->room = room;
    return true;
}

void rows_add(struct rows *rows, const void *row)
{
    if (rows->count == rows->room && !make_room(rows)) {
        rows->has_lost = true;
        return;
    }
    memcpy((char *)rows->first + rows->count * rows->size, row, rows->size);
    rows->count++;
}

void rows_free(struct rows *rows)
{
    free(rows->first);
    *rows = (struct rows){0};
}
