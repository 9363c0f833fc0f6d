#include "hal/linux/pseudo_terminal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/linux/error_text.h"
#include "hal/linux/serial_line.h"

/** Whether `path` is a link to this terminal: its own, or that of a dead process whose terminal had the same number. */
static bool leads_to_terminal(const struct jp_pseudo_terminal *terminal)
{
    char target[JP_PSEUDO_TERMINAL_PATH];
    const ssize_t length = readlink(terminal->path, target, sizeof target);

    return length > 0 && (size_t)length == strlen(terminal->far_end) &&
           memcmp(target, terminal->far_end, (size_t)length) == 0;
}

static bool leads_nowhere(const char *path)
{
    struct stat status;

    return lstat(path, &status) == 0 && S_ISLNK(status.st_mode) && stat(path, &status) != 0 && errno == ENOENT;
}

static bool make_link(const struct jp_pseudo_terminal *terminal)
{
    if (leads_to_terminal(terminal) || leads_nowhere(terminal->path)) {
        (void)unlink(terminal->path);
    }
    return symlink(terminal->far_end, terminal->path) == 0;
}

/** A close-on-exec terminal, not the controlling one. False: errno. */
static bool make_terminal(struct jp_pseudo_terminal *terminal)
{
    int reason;

    terminal->descriptor = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (terminal->descriptor < 0) {
        return false;
    }
    if (grantpt(terminal->descriptor) == 0 && unlockpt(terminal->descriptor) == 0 &&
        ptsname_r(terminal->descriptor, terminal->far_end, sizeof terminal->far_end) == 0 &&
        jp_serial_make_raw(terminal->descriptor)) {
        return true;
    }
    reason = errno;
    (void)close(terminal->descriptor);
    errno = reason;
    return false;
}

bool jp_pseudo_terminal_open(struct jp_pseudo_terminal *terminal, const char *path, char *error, unsigned size)
{
    const size_t length = strlen(path);
    int reason;

    if (length == 0 || length >= sizeof terminal->path) {
        return jp_error_text(error, size, "pty:%.40s: the path has 1 to %zu characters; give one, such as pty:/tmp/ecu",
                             path, sizeof terminal->path - 1);
    }
    memcpy(terminal->path, path, length + 1);
    if (!make_terminal(terminal)) {
        return jp_error_text(error, size, "pty:%s: cannot make a pseudo-terminal: %s", path, strerror(errno));
    }
    if (make_link(terminal)) {
        return true;
    }
    reason = errno;
    (void)close(terminal->descriptor);
    if (reason == EEXIST) {
        return jp_error_text(error, size, "pty:%s: there is something of that name; remove it or give another name",
                             path);
    }
    return jp_error_text(error, size, "pty:%s: cannot make this link to the pseudo-terminal: %s; give another name",
                         path, strerror(reason));
}

void jp_pseudo_terminal_unlink(const struct jp_pseudo_terminal *terminal)
{
    if (leads_to_terminal(terminal)) {
        (void)unlink(terminal->path);
    }
}
