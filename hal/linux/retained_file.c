#include "hal/linux/retained_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/linux/error_text.h"

#define FILE_MODE 0644

struct place {
    const char *path;
    char *error;
    unsigned size;
};

static bool system_refused(const struct place *place, const char *what)
{
    return jp_error_text(place->error, place->size, "%s: cannot %s: %s; give another file for the retained record",
                         place->path, what, strerror(errno));
}

/** An empty file is a new one. Its blocks are allocated now: a full disk must not show in the control loop. */
static bool has_right_size(const struct place *place, int descriptor)
{
    struct stat status;
    int failure;

    if (fstat(descriptor, &status) != 0) {
        return system_refused(place, "examine this");
    }
    if (!S_ISREG(status.st_mode)) {
        return jp_error_text(place->error, place->size,
                             "%s: not a regular file; give another file for the retained record", place->path);
    }
    if (status.st_size != 0 && status.st_size != (off_t)sizeof(struct jp_retained)) {
        return jp_error_text(place->error, place->size,
                             "%s: %lld bytes, but the retained record has %zu; remove the file or give another one",
                             place->path, (long long)status.st_size, sizeof(struct jp_retained));
    }
    failure = posix_fallocate(descriptor, 0, sizeof(struct jp_retained));
    if (failure != 0) {
        errno = failure;
        return system_refused(place, "make room in this file");
    }
    return true;
}

static bool lock(const struct place *place, int descriptor)
{
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
        return true;
    }
    if (errno == EWOULDBLOCK) {
        return jp_error_text(place->error, place->size,
                             "%s: another process keeps its retained record there; end it or give another file",
                             place->path);
    }
    return system_refused(place, "lock this file");
}

static bool map(struct jp_retained_file *file, const struct place *place)
{
    void *memory = mmap(NULL, sizeof(struct jp_retained), PROT_READ | PROT_WRITE, MAP_SHARED, file->descriptor, 0);

    if (memory == MAP_FAILED) {
        return system_refused(place, "map this file");
    }
    file->retained = memory;
    return true;
}

bool jp_retained_file_open(struct jp_retained_file *file, const char *path, char *error, unsigned size)
{
    const struct place place = {.path = path, .error = error, .size = size};

    file->retained = NULL;
    file->descriptor = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOCTTY | O_NONBLOCK, FILE_MODE);
    if (file->descriptor < 0) {
        return system_refused(&place, "open this file");
    }
    if (lock(&place, file->descriptor) && has_right_size(&place, file->descriptor) && map(file, &place)) {
        return true;
    }
    (void)close(file->descriptor);
    file->descriptor = -1;
    return false;
}

void jp_retained_file_close(struct jp_retained_file *file)
{
    (void)munmap(file->retained, sizeof *file->retained);
    (void)close(file->descriptor);
    file->retained = NULL;
    file->descriptor = -1;
}
