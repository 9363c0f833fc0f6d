#include "hal/linux/serial_line.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

/** Carries a CAN bus at 60 % load as text, with answers. An adapter on USB ignores it. */
#define BAUD B1000000

bool jp_serial_make_raw(int descriptor)
{
    struct termios settings;

    if (tcgetattr(descriptor, &settings) != 0) {
        return false;
    }
    cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cflag &= ~(tcflag_t)(CSTOPB | CRTSCTS);
    return cfsetspeed(&settings, BAUD) == 0 && tcsetattr(descriptor, TCSANOW, &settings) == 0;
}

void jp_serial_line_start(struct jp_serial_line *line, int descriptor)
{
    line->descriptor = descriptor;
    line->gone = false;
    jp_serial_line_drop(line);
}

bool jp_serial_line_open(struct jp_serial_line *line, const char *path)
{
    const int descriptor = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    int reason;

    if (descriptor >= 0 && jp_serial_make_raw(descriptor)) {
        (void)tcflush(descriptor, TCIOFLUSH);
        jp_serial_line_start(line, descriptor);
        return true;
    }
    reason = errno;
    if (descriptor >= 0) {
        (void)close(descriptor);
    }
    errno = reason;
    return false;
}

void jp_serial_line_drop(struct jp_serial_line *line)
{
    line->in_next = 0;
    line->in_end = 0;
    line->out_length = 0;
}

void jp_serial_line_close(struct jp_serial_line *line)
{
    if (line->descriptor >= 0) {
        (void)close(line->descriptor);
    }
    line->descriptor = -1;
}

static bool can_be_tried_again(void)
{
    return errno == EAGAIN || errno == EINTR;
}

bool jp_serial_line_fill(struct jp_serial_line *line)
{
    ssize_t length;

    length = read(line->descriptor, line->in, sizeof line->in);
    /* A terminal that has hung up reads as ended or fails. */
    line->gone = length == 0 || (length < 0 && !can_be_tried_again());
    line->in_next = 0;
    line->in_end = length > 0 ? (size_t)length : 0;
    return length > 0;
}

bool jp_serial_line_take(struct jp_serial_line *line, uint8_t *byte)
{
    if (line->in_next == line->in_end) {
        return false;
    }
    *byte = line->in[line->in_next];
    line->in_next++;
    return true;
}

bool jp_serial_line_put(struct jp_serial_line *line, const char *bytes, size_t length)
{
    if (sizeof line->out - line->out_length < length) {
        jp_serial_line_flush(line);
    }
    if (sizeof line->out - line->out_length < length) {
        return false;
    }
    memcpy(&line->out[line->out_length], bytes, length);
    line->out_length += length;
    return true;
}

void jp_serial_line_flush(struct jp_serial_line *line)
{
    ssize_t written;

    if (line->out_length == 0) {
        return;
    }
    written = write(line->descriptor, line->out, line->out_length);
    if (written > 0) {
        line->out_length -= (size_t)written;
        memmove(line->out, &line->out[written], line->out_length);
    } else if (written < 0 && !can_be_tried_again()) {
        line->gone = true;
    }
}
