/** A serial line in raw mode that never blocks, with a buffer of bounded size each way. */
#ifndef JOULEPATH_HAL_LINUX_SERIAL_LINE_H
#define JOULEPATH_HAL_LINUX_SERIAL_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Some 150 frames of SLCAN, bytes. */
#define JP_SERIAL_BUFFER 4096U

struct jp_serial_line {
    int descriptor; /**< negative: not open */
    bool gone;      /**< at the last read or write there was nobody at the far end */
    uint8_t in[JP_SERIAL_BUFFER];
    size_t in_next;
    size_t in_end;
    uint8_t out[JP_SERIAL_BUFFER];
    size_t out_length;
};

/** Puts a terminal into raw mode, 8 bits, no handshake, 1 Mbaud. False: errno. */
bool jp_serial_make_raw(int descriptor);

/** Begins on an open descriptor in raw mode, with empty buffers. */
void jp_serial_line_start(struct jp_serial_line *line, int descriptor);

/** Opens a serial line. False: errno; ENOTTY if it is something else. */
bool jp_serial_line_open(struct jp_serial_line *line, const char *path);

/** Empties both buffers. */
void jp_serial_line_drop(struct jp_serial_line *line);

/** Closes it, if it is open. */
void jp_serial_line_close(struct jp_serial_line *line);

/** Reads what has arrived, at most a buffer full, when all that came before was taken. False: nothing. */
bool jp_serial_line_fill(struct jp_serial_line *line);

/** Takes the next byte that was read. False: there is none. */
bool jp_serial_line_take(struct jp_serial_line *line, uint8_t *byte);

/** Sends all or nothing. False: no room. */
bool jp_serial_line_put(struct jp_serial_line *line, const char *bytes, size_t length);

/** Writes as much as the system takes. */
void jp_serial_line_flush(struct jp_serial_line *line);

#endif
